//! The content of the result files: the values that the stages return to the
//! report and to later commands, in the units that the files name.

use railspring_calibrate::beam::BeamCorrection;
use railspring_calibrate::law::Form;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::assumed_record::AssumedRecord;
use super::band_record::{ErrorBandRecord, HorizontalBandRecord};
use super::form::{FormRecord, best_of_forms};
use super::law::LawConstants;
use super::uncertainty_record::InputUncertaintyRecord;
use crate::engine::seal::Sealed;
use crate::results::bodies::record::{BodyMeshRecord, ProfileRecord};
use crate::results::bodies::touch::TouchRecord;
use crate::rounding::significant;
use crate::study::PairRecord;

/// `stiffness.json`: the springs and what made them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StiffnessRecord {
    /// Name of the study.
    pub study: String,
    /// What the displacement of `law` is measured against: `foot`, `beam` or `local`.
    pub reference: String,
    /// The normal law in use.
    pub law: LawRecord,
    /// Why the laws end before the largest load that the study wants, if they do.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law_end: Option<LoadEndRecord>,
    /// Horizontal stiffness, kN/m; none where its calibration did not converge.
    pub horizontal_kn_per_m: Option<f64>,
    /// How constant the horizontal stiffness is.
    pub horizontal: Option<HorizontalRecord>,
    /// Why the horizontal stiffness has not all preloads that the study wants, if so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub horizontal_end: Option<LoadEndRecord>,
    /// Why there is no horizontal stiffness.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub horizontal_missing: Option<String>,
    /// The rail as a beam, which stands in series with a law against `beam`.
    pub beam: BeamRecord,
    /// The laws with each reference, the one in use included.
    pub references: Vec<ReferenceRecord>,
    /// Error bands of the laws; none where the study does not ask.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_band: Option<ErrorBandRecord>,
    /// What was assumed of measured profiles, and how far the springs may be off for it; none where all is known, or the study asks for no bands.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub assumed: Option<AssumedRecord>,
    /// Uncertainty of the springs by inputs that are not known exactly; none where the study asks for no bands.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub input_uncertainty: Option<InputUncertaintyRecord>,
    /// Where the compliance sits, at some loads.
    pub compliance_split: Vec<ComplianceRecord>,
    /// The largest stresses below the patch, load by load, with the reference in use; none for a contact between elements, which do not
    /// resolve them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub subsurface: Vec<SubsurfaceRecord>,
    /// The published penalty criterion.
    pub penalty: PenaltyRecord,
    /// Size and quality of the solid meshes.
    pub mesh: Vec<BodyMeshRecord>,
    /// The measured profiles, and what was found and done to them.
    #[serde(default)]
    pub profiles: Vec<ProfileRecord>,
    /// Where wheel and rail first touch.
    pub touch: TouchRecord,
    /// The pair.
    pub pair: PairRecord,
    /// Hash of what the calibration depends on, the program included.
    pub input_hash: String,
    /// Version of the program that made this.
    pub version: String,
    /// The commit that this program was built from.
    #[serde(default)]
    pub commit: String,
    /// Hash of all that stands above.
    #[serde(default)]
    pub content_blake3: String,
}

impl Sealed for StiffnessRecord {
    fn seal(&mut self) -> &mut String {
        &mut self.content_blake3
    }
}

/// Why laws, or the horizontal stiffness, end before the largest load that a study wants.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LoadEndRecord {
    /// Loads of the study that they do not have.
    pub loads_left_out: usize,
    /// The largest load that the study wants, kN.
    pub largest_wanted_kn: f64,
    /// Why the first of these is not carried.
    pub reason: String,
}

impl StiffnessRecord {
    /// The ends of the laws and of the horizontal stiffness before the largest load that the study wants, a sentence each.
    pub fn shortened(&self) -> Vec<String> {
        let sentence = |what: &str, last_kn: f64, left_out: &str, end: &LoadEndRecord| {
            let LoadEndRecord { loads_left_out, largest_wanted_kn, reason } = end;
            format!(
                "{what} at {} kN instead of {largest_wanted_kn} kN, without {loads_left_out} of the {left_out}: {reason}",
                (10.0 * last_kn).round() / 10.0
            )
        };
        let laws = self.law_end.as_ref();
        let laws = laws.map(|end| sentence("the laws end", self.law.range_kn[1], "loads", end));
        let last = self.horizontal.as_ref().and_then(|horizontal| horizontal.points.last());
        let last = last.map_or(f64::NAN, |point| point.preload_kn);
        let horizontal = self.horizontal_end.as_ref();
        let horizontal =
            horizontal.map(|end| sentence("the horizontal stiffness ends", last, "preloads", end));
        laws.into_iter().chain(horizontal).collect()
    }

    /// What was found in the measured profiles and could not be repaired, a sentence each: the surface is unsure there.
    pub fn findings_left(&self) -> Vec<String> {
        self.profiles.iter().flat_map(ProfileRecord::left).collect()
    }

    /// How many loads and preloads of the study the springs do not have.
    pub fn loads_left_out(&self) -> usize {
        [&self.law_end, &self.horizontal_end].into_iter().flatten().map(|end| end.loads_left_out).sum()
    }

    /// What the approach of the surfaces and that of the profiles on half-spaces differ by, in a sentence; none without both.
    pub fn roll(&self) -> Option<String> {
        let of = |name: &str| self.references.iter().find(|found| found.reference == name);
        let (local, half_spaces) = (of("local")?, of("half-spaces")?);
        let both = || local.points.iter().zip(&half_spaces.points);
        let largest = |value: fn(&TangentRecord) -> f64| {
            let off = both().map(|(local, half)| (value(local) / value(half) - 1.0, local.force_kn));
            off.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
        };
        let (displacement, tangent) = (largest(|p| p.displacement_mm)?, largest(|p| p.tangent_kn_per_m)?);
        let part = |(off, force): (f64, f64)| format!("{:+.1} % at {} kN", 1e2 * off, significant(force, 3));
        Some(format!(
            "Against half-spaces the approach of the surfaces (local) differs by the roll of rim and head: displacement {}, tangent {} at most",
            part(displacement),
            part(tangent)
        ))
    }

    /// Mass of the solid wheel, kg.
    pub fn wheel_mass(&self) -> f64 {
        self.mesh.iter().find(|mesh| mesh.body == "wheel").map_or(f64::NAN, |mesh| mesh.mass_kg)
    }

    /// Error bands of the law in use, as far as they were asked for, a line each.
    pub fn law_errors(&self) -> Vec<String> {
        let Some(band) = &self.error_band else { return Vec::new() };
        let mut lines: Vec<String> =
            band.missing.iter().map(|part| format!("error band of the law: none, {part}")).collect();
        if let Some((displacement, tangent)) =
            band.of(&self.reference).and_then(|band| Some((band.displacement?, band.tangent?)))
        {
            let [smallest, largest] = self.law.range_kn;
            lines.push(format!(
                "error band of the law ({}): displacement \u{b1}{:.2} %, tangent \u{b1}{:.2} % from {smallest} to {largest} kN",
                self.reference,
                1e2 * displacement,
                1e2 * tangent
            ));
        }
        if let Some(target) = &band.target {
            let reached = target.not_reached.as_ref().map_or_else(
                || format!("reached with contact elements of {:.2} mm", band.contact_element_mm),
                |reason| format!("not reached: {reason}"),
            );
            lines.push(format!("wanted error band of {:.2} %: {reached}", 1e2 * target.wanted));
        }
        let horizontal = self.horizontal.as_ref().and_then(|horizontal| horizontal.error_band.as_ref());
        lines.extend(horizontal.map(HorizontalBandRecord::sentence));
        if let Some(assumed) = &self.assumed {
            lines.extend([assumed.sentence(), assumed.range(&self.reference)]);
            lines.extend(assumed.missing.iter().map(|part| format!("no result with another body: {part}")));
        }
        lines
    }

    /// The law of a form against the reference in use.
    pub fn form(&self, form: Form) -> Option<&FormRecord> {
        let in_use = self.references.iter().find(|found| found.reference == self.reference)?;
        in_use.form(form)
    }

    /// Errors of the published form, and which form holds best, in a line.
    pub fn forms_in_a_line(&self) -> Option<String> {
        let in_use = self.references.iter().find(|found| found.reference == self.reference)?;
        best_of_forms(&in_use.forms)
    }
}

/// A fitted law `k(f) = a + b·(f/f0)^c`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LawRecord {
    /// Its constants.
    #[serde(flatten)]
    pub constants: LawConstants,
    /// Smallest and largest load of the fit, kN.
    pub range_kn: [f64; 2],
    /// RMS relative deviation of the law from the solid.
    pub rms_rel_error: f64,
    /// Largest relative deviation of the law from the solid.
    pub max_rel_error: f64,
    /// Which parameters lie on a bound of the fit; their standard error is 0, and those of the others hold given
    /// that bound.
    #[serde(default)]
    pub at_bound: BoundRecord,
    /// Standard error of a, kN/m.
    pub a_standard_error_kn_per_m: f64,
    /// Standard error of b, kN/m.
    pub b_standard_error_kn_per_m: f64,
    /// Standard error of c.
    pub c_standard_error: f64,
}

/// Parameters of a law on a bound of their range.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct BoundRecord {
    /// The constant part, at 0.
    pub a: bool,
    /// The factor of the power, at 0: the stiffness does not grow with the force.
    #[serde(default)]
    pub b: bool,
    /// The exponent, at the largest that is searched, or at 0 with the factor.
    pub c: bool,
}

/// The law with one reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReferenceRecord {
    /// `foot`, `beam`, `local`, or `half-spaces`: the profiles alone, as half-space programs have them.
    pub reference: String,
    /// The law.
    pub law: LawRecord,
    /// Laws of all forms for the same points, that one first: `power`, `series`, `steps` (from eight loads on) and `table`.
    pub forms: Vec<FormRecord>,
    /// The solid's own values, load by load.
    pub points: Vec<TangentRecord>,
}

impl ReferenceRecord {
    /// Its law of a form.
    pub fn form(&self, form: Form) -> Option<&FormRecord> {
        self.forms.iter().find(|found| found.law.form() == form)
    }
}

/// The rail as the beam of the moving solver, at midspan at the point of the first touch; flexibilities in µm/kN.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BeamRecord {
    /// Length between the held ends, m.
    pub length_m: f64,
    /// What makes the beam as flexible as the solid rail.
    #[serde(flatten)]
    pub factors: BeamFactors,
    /// Lateral and vertical flexibility of the solid rail, other than that against its own section.
    pub solid_um_per_kn: [f64; 2],
    /// The same of the beam before the correction.
    pub uncorrected_um_per_kn: [f64; 2],
    /// The same of the corrected beam.
    pub corrected_um_per_kn: [f64; 2],
    /// What the corrected beam misses, over the flexibility of the solid from hub to held ends; the larger of
    /// the lateral and the vertical.
    pub missing: f64,
}

/// Factors on the stiffness of the rail beam.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BeamFactors {
    /// On the lateral shear stiffness.
    pub shear_lateral_factor: f64,
    /// On the vertical shear stiffness.
    pub shear_vertical_factor: f64,
    /// On the torsion stiffness.
    pub torsion_factor: f64,
}

impl Default for BeamFactors {
    /// No correction.
    fn default() -> Self {
        BeamCorrection::NONE.into()
    }
}

impl From<BeamCorrection> for BeamFactors {
    fn from(BeamCorrection { shear_y, shear_z, torsion }: BeamCorrection) -> Self {
        Self { shear_lateral_factor: shear_y, shear_vertical_factor: shear_z, torsion_factor: torsion }
    }
}

impl From<BeamFactors> for BeamCorrection {
    fn from(factors: BeamFactors) -> Self {
        Self {
            shear_y: factors.shear_lateral_factor,
            shear_z: factors.shear_vertical_factor,
            torsion: factors.torsion_factor,
        }
    }
}

/// The solid at one load, with one reference.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TangentRecord {
    /// Load, kN.
    pub force_kn: f64,
    /// Displacement, mm.
    pub displacement_mm: f64,
    /// Tangent stiffness, kN/m.
    pub tangent_kn_per_m: f64,
}

/// The horizontal stiffness at each preload.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HorizontalRecord {
    /// Largest less smallest stiffness over their mean.
    pub relative_spread: f64,
    /// The points.
    pub points: Vec<HorizontalPointRecord>,
    /// Error band of the stiffness; none where the study does not ask.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_band: Option<HorizontalBandRecord>,
}

/// The horizontal stiffness at one preload.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HorizontalPointRecord {
    /// Vertical preload, kN.
    pub preload_kn: f64,
    /// Horizontal stiffness, kN/m.
    pub stiffness_kn_per_m: f64,
    /// Difference from the stiffness in use, relative.
    pub deviation: f64,
}

/// Parts of the tangent compliance at one load, µm/kN. They add up to the compliance of the solid between the hub and
/// what holds the rail; `local`, `wheel` and `rail` together are that of the law.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComplianceRecord {
    /// Load, kN.
    pub force_kn: f64,
    /// Local contact deformation.
    pub local_um_per_kn: f64,
    /// Wheel body.
    pub wheel_um_per_kn: f64,
    /// Rail body: against its own section where the reference is `beam` or `local`, else against the held foot.
    pub rail_um_per_kn: f64,
    /// Rail as the corrected beam; 0 with the foot held.
    pub beam_um_per_kn: f64,
    /// What the beam misses of the solid rail.
    pub beam_missing_um_per_kn: f64,
}

/// The largest stresses below the patch at one load, of a half-space.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SubsurfaceRecord {
    /// Load, kN.
    pub force_kn: f64,
    /// Largest von Mises stress, MPa.
    pub max_von_mises_mpa: f64,
    /// Its depth, mm.
    pub von_mises_depth_mm: f64,
    /// Largest shear stress, MPa.
    pub max_shear_mpa: f64,
    /// Its depth, mm.
    pub shear_depth_mm: f64,
    /// How far these are from those on cells twice as large, relative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_band: Option<SubsurfaceBandRecord>,
}

/// Half widths of the error bands of the largest stresses below the patch and of their depths, relative.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SubsurfaceBandRecord {
    /// Of the largest von Mises stress.
    pub von_mises: f64,
    /// Of its depth.
    pub von_mises_depth: f64,
    /// Of the largest shear stress.
    pub shear: f64,
    /// Of its depth.
    pub shear_depth: f64,
}

/// The published penalty criterion: the penetration below 1/1000 of the displacement at the wheel centre.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PenaltyRecord {
    /// `exact` or `penalty`.
    pub enforcement: String,
    /// Penalty stiffness, kN/m.
    pub penalty_kn_per_m: f64,
    /// Largest penetration over the displacement at the wheel centre, if it was measured.
    pub penetration_over_displacement: Option<f64>,
}

/// One row of `load_curve.csv`: one load, with the reference in use.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LoadCurveRow {
    /// What the displacement is measured against: `foot`, `beam` or `local`.
    pub reference: String,
    /// Load, kN.
    pub force_kn: f64,
    /// Displacement, mm.
    pub displacement_mm: f64,
    /// Displacement of the law, integrated from no load, mm.
    pub law_displacement_mm: f64,
    /// Secant stiffness of the solid, force over displacement, kN/m.
    pub solid_secant_kn_per_m: f64,
    /// Tangent stiffness of the solid, kN/m.
    pub solid_tangent_kn_per_m: f64,
    /// Tangent stiffness of the law, kN/m.
    pub law_tangent_kn_per_m: f64,
    /// Contact area, mm².
    pub contact_area_mm2: f64,
    /// Largest pressure, MPa.
    pub max_pressure_mpa: f64,
    /// Semi-axis of the patch along the track, mm.
    pub semi_axis_along_mm: f64,
    /// Semi-axis of the patch across, mm.
    pub semi_axis_across_mm: f64,
    /// Largest von Mises stress below the patch, MPa, of a half-space; none for a contact between elements, which do not resolve it.
    pub max_von_mises_mpa: Option<f64>,
    /// Its depth, mm.
    pub von_mises_depth_mm: Option<f64>,
    /// Largest shear stress below the patch, MPa.
    pub max_shear_mpa: Option<f64>,
    /// Its depth, mm.
    pub shear_depth_mm: Option<f64>,
    /// Half width of the error band of the contact area, relative: its change from cells twice as large; none for a contact between elements.
    #[serde(default)]
    pub contact_area_rel_error_band: Option<f64>,
    /// The same of the largest pressure.
    #[serde(default)]
    pub max_pressure_rel_error_band: Option<f64>,
    /// The same of the largest von Mises stress.
    #[serde(default)]
    pub von_mises_rel_error_band: Option<f64>,
    /// The same of its depth.
    #[serde(default)]
    pub von_mises_depth_rel_error_band: Option<f64>,
    /// The same of the largest shear stress.
    #[serde(default)]
    pub shear_rel_error_band: Option<f64>,
    /// The same of its depth.
    #[serde(default)]
    pub shear_depth_rel_error_band: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::significant;
    use crate::results::samples;

    /// Goal: the difference of `local` and `half-spaces` is the largest over the loads, with its sign and load, each by itself; without both laws there
    /// is none. Source: the sample's own points, times known factors.
    #[test]
    fn the_roll_is_the_largest_difference() {
        let mut stiffness = samples::stiffness();
        assert_eq!(stiffness.roll(), None);
        let local = stiffness.references.iter().find(|found| found.reference == "local").unwrap();
        let mut half_spaces = local.clone();
        half_spaces.reference = "half-spaces".into();
        let [first, second] = [half_spaces.points[0].force_kn, half_spaces.points[1].force_kn];
        half_spaces.points[0].displacement_mm /= 1.05;
        half_spaces.points[1].displacement_mm /= 0.99;
        half_spaces.points[0].tangent_kn_per_m /= 1.01;
        half_spaces.points[1].tangent_kn_per_m /= 0.8;
        stiffness.references.push(half_spaces);
        let said = stiffness.roll().unwrap();
        let [first, second] = [first, second].map(|force| significant(force, 3));
        let (displacement, tangent) = (format!("+5.0 % at {first} kN"), format!("-20.0 % at {second} kN"));
        assert!(said.contains(&displacement) && said.contains(&tangent), "{said}");
    }
}
