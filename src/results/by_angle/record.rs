//! `stiffness_by_angle.json` and `stiffness_by_angle.csv`: the laws of the pair with the wheel in several places across the track.

use railspring_calibrate::law::Form;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::engine::seal::Sealed;
use crate::results::by_angle::element::ElementRecord;
use crate::results::by_angle::lumped::LumpedRecord;
use crate::results::springs::band_record::{BandPointRecord, ErrorBandRecord};
use crate::results::springs::form::FormRecord;
use crate::results::springs::record::LawRecord;
use crate::study::PairRecord;

/// Name of the file with the laws by contact angle.
pub const BY_ANGLE: &str = "stiffness_by_angle.json";

/// `stiffness_by_angle.json`: the law by contact angle. Loads, displacements and tangents are those along the contact normal at the
/// first touch of each shift, the hub held across it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StiffnessByAngleRecord {
    /// Name of the study.
    pub study: String,
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// The shifts, ascending.
    pub shifts: Vec<ShiftRecord>,
    /// What the condensed contact element runs with; none where no run asks for it, or there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub element: Option<ElementRecord>,
    /// The lumped element that follows from it; none where there is no condensed one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lumped: Option<LumpedRecord>,
    /// Why there is no condensed element, and no lumped one, although a run asks for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub element_missing: Option<String>,
    /// The pair.
    pub pair: PairRecord,
    /// Hash of what the laws depend on, the program included.
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

impl Sealed for StiffnessByAngleRecord {
    fn seal(&mut self) -> &mut String {
        &mut self.content_blake3
    }
}

/// The wheel at one shift.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ShiftRecord {
    /// Lateral shift of the wheelset, mm, as `track.lateral_shift_mm`.
    pub shift_mm: f64,
    /// Where the wheel first touches; none where it misses the rail.
    pub touch: Option<ShiftTouchRecord>,
    /// The laws, against `foot` where the study wants it, `beam` and `local`; none where there is no law.
    pub laws: Vec<AngleLawRecord>,
    /// The smallest load, kN, that two contacts with different normals share, each at least one per cent: from there on the laws are those of the pair, along the normal
    /// of the first touch. None where one contact carries every load.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shared_from_kn: Option<f64>,
    /// The solid at fixed loads within the range of the laws: the constants of a law do not interpolate between shifts, these values do.
    pub loads: Vec<FixedLoadRecord>,
    /// Secant stiffness of the solid against the held foot from 20 to 120 kN over that of the published law; none without laws against the foot,
    /// or where a load is missing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub published_secant_ratio: Option<f64>,
    /// Error band of displacement and tangent at the fixed loads; none where the study does not ask, or no fixed load lies in the range.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_band: Option<ErrorBandRecord>,
    /// Why there is no law, or why it ends before the largest load.
    pub reason: Option<String>,
}

/// The first touch of a shift.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ShiftTouchRecord {
    /// Contact angle, degrees.
    pub contact_angle_deg: f64,
    /// Touching point on the rail, rail profile frame, mm.
    pub rail_y_mm: f64,
    /// See `rail_y_mm`.
    pub rail_z_mm: f64,
    /// Touching point on the wheel, wheel profile frame, mm.
    pub wheel_y_mm: f64,
    /// See `wheel_y_mm`.
    pub wheel_z_mm: f64,
}

/// The law of a shift with one reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AngleLawRecord {
    /// `foot`, `beam` or `local`.
    pub reference: String,
    /// The law.
    pub law: LawRecord,
    /// Laws of all forms for the same loads, that one first.
    pub forms: Vec<FormRecord>,
}

impl AngleLawRecord {
    /// Its law of a form.
    pub fn form(&self, form: Form) -> Option<&FormRecord> {
        self.forms.iter().find(|found| found.law.form() == form)
    }
}

/// The solid under a fixed load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FixedLoadRecord {
    /// Load, kN: along the contact normal; in a table with `direction = "vertical"` the vertical one.
    pub force_kn: f64,
    /// Displacement and tangent with each reference.
    pub references: Vec<FixedReferenceRecord>,
    /// The contacts that carry the load, along the rail's profile: one, or two where the pair shares it.
    pub contacts: Vec<ContactRecord>,
    /// Flexibility of the hub against the rail's section, everything sticking: lateral, lateral with vertical, and vertical, µm/kN.
    #[serde(default)]
    pub hub_um_per_kn: [f64; 3],
    /// The same of the condensed contact element, if there is one and it carries the load.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub condensed_hub_um_per_kn: Option<[f64; 3]>,
    /// Displacement of its hub along the contact normal against the rail's section, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub condensed_displacement_mm: Option<f64>,
    /// The same flexibility of the lumped contact element, if there is one and it carries the load.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lumped_hub_um_per_kn: Option<[f64; 3]>,
    /// Displacement of its hub along the contact normal against the rail's section, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lumped_displacement_mm: Option<f64>,
    /// The same flexibility of the published contact element with the calibrated law against the rail's section and the calibrated horizontal stiffness, if it has
    /// both and carries the load.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub published_hub_um_per_kn: Option<[f64; 3]>,
    /// Displacement of its hub along the contact normal against the rail's section, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub published_displacement_mm: Option<f64>,
    /// Lateral stiffness of the sticking wheel against the rail's section, the vertical force constant, kN/m.
    pub horizontal_kn_per_m: f64,
    /// The same across the contact normal, the force along it constant, kN/m.
    pub tangential_kn_per_m: f64,
    /// Part of the lateral compliance, `1 / horizontal_kn_per_m`, that lies in the contact itself, µm/kN; none in files written by older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lateral_contact_um_per_kn: Option<f64>,
    /// Contact area, mm².
    pub contact_area_mm2: f64,
    /// Largest pressure, MPa.
    pub max_pressure_mpa: f64,
    /// Semi-axis of the patch along the track, mm.
    pub semi_axis_along_mm: f64,
    /// Semi-axis of the patch across, mm.
    pub semi_axis_across_mm: f64,
    /// Largest von Mises stress below the patch, MPa, of a half-space; none in a table without `bodies = "own"`, and for a contact between elements, which do not resolve it.
    pub max_von_mises_mpa: Option<f64>,
    /// Its depth, mm.
    pub von_mises_depth_mm: Option<f64>,
    /// Largest shear stress below the patch, MPa.
    pub max_shear_mpa: Option<f64>,
    /// Its depth, mm.
    pub shear_depth_mm: Option<f64>,
    /// Error bands of the values of the patch; none in a table without `bodies = "own"`, and for a contact between elements.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub patch_error_band: Option<PatchBandRecord>,
}

/// Half widths of the error bands of the values of a patch, relative: their changes from cells twice as large.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PatchBandRecord {
    /// Of the contact area.
    pub contact_area: f64,
    /// Of the largest pressure.
    pub max_pressure: f64,
    /// Of the largest von Mises stress.
    pub von_mises: f64,
    /// Of its depth.
    pub von_mises_depth: f64,
    /// Of the largest shear stress.
    pub shear: f64,
    /// Of its depth.
    pub shear_depth: f64,
}

impl FixedLoadRecord {
    /// Displacement and tangent with a reference; none where its law does not have the load.
    pub fn reference(&self, name: &str) -> Option<&FixedReferenceRecord> {
        self.references.iter().find(|at| at.reference == name)
    }

    /// Part of the lateral flexibility that lies in the contact itself.
    pub fn horizontal_contact_share(&self) -> Option<f64> {
        Some(self.lateral_contact_um_per_kn? * 1e-6 * self.horizontal_kn_per_m)
    }
}

/// A contact that carries a part of a load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ContactRecord {
    /// Its normal force, kN.
    pub force_kn: f64,
    /// Contact angle of its mean normal, degrees.
    pub contact_angle_deg: f64,
}

/// The solid under a fixed load with one reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FixedReferenceRecord {
    /// `foot`, `beam` or `local`.
    pub reference: String,
    /// Displacement, mm.
    pub displacement_mm: f64,
    /// Tangent stiffness, kN/m.
    pub tangent_kn_per_m: f64,
    /// Part of the tangent compliance in the contact itself, µm/kN.
    pub local_um_per_kn: f64,
    /// Part of the wheel body, µm/kN; none in `local`.
    pub wheel_um_per_kn: Option<f64>,
    /// Part of the rail body, µm/kN; none in `local`.
    pub rail_um_per_kn: Option<f64>,
    /// Part of surfaces that move past each other, by friction or to other places on the profiles, µm/kN; none in `local`. The parts make up the tangent compliance.
    pub sliding_um_per_kn: Option<f64>,
}

impl ShiftRecord {
    /// Contact angle at the first touch, degrees.
    pub fn angle(&self) -> Option<f64> {
        self.touch.map(|touch| touch.contact_angle_deg)
    }

    /// Error band of the solid against a reference at a fixed load, kN.
    pub fn band(&self, reference: &str, force_kn: f64) -> Option<&BandPointRecord> {
        let band = self.error_band.as_ref()?.of(reference)?;
        band.points.iter().find(|point| point.force_kn == force_kn)
    }
}
