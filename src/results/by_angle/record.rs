//! `stiffness_by_angle.json` and `stiffness_by_angle.csv`: the laws of the pair with the wheel in several places across the track.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::study::PairRecord;

use crate::engine::seal::Sealed;
use crate::results::by_angle::element::ElementRecord;
use crate::results::springs::band_record::{BandPointRecord, ErrorBandRecord};
use crate::results::springs::record::{DisplacementRecord, LawRecord};

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
    /// Why there is no condensed element although a run asks for it.
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
    /// The solid at fixed loads within the range of the laws: the constants of a law do not interpolate between shifts, these values do.
    pub loads: Vec<FixedLoadRecord>,
    /// Secant stiffness of the solid against the held foot from 20 to 120 kN over that of the published law; none without laws against the foot,
    /// or where a load is missing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub published_secant_ratio: Option<f64>,
    /// What displacement and tangent at the fixed loads are worth; none where the study does not ask, or no fixed load lies in the range.
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
    /// The law, integrated, against the displacement of the solid.
    pub displacement: DisplacementRecord,
}

/// The solid under a fixed load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FixedLoadRecord {
    /// Load along the contact normal, kN.
    pub force_kn: f64,
    /// Displacement and tangent with each reference.
    pub references: Vec<FixedReferenceRecord>,
    /// Flexibility of the hub against the rail's section, everything sticking: lateral, lateral with vertical, and vertical, µm/kN.
    #[serde(default)]
    pub hub_um_per_kn: [f64; 3],
    /// The same of the condensed contact element, if there is one and it carries the load.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub condensed_hub_um_per_kn: Option<[f64; 3]>,
    /// Displacement of its hub along the contact normal against the rail's section, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub condensed_displacement_mm: Option<f64>,
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
    /// Part of the lateral compliance, `1 / horizontal_kn_per_m`, that lies in the contact itself, µm/kN; none in files of before.
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
    /// Largest von Mises stress below the patch, MPa, of a half-space; none for a contact between elements, which do not resolve it.
    pub max_von_mises_mpa: Option<f64>,
    /// Its depth, mm; a quarter of a cell of the fine grid where friction has it at the surface.
    pub von_mises_depth_mm: Option<f64>,
    /// Largest shear stress below the patch, MPa.
    pub max_shear_mpa: Option<f64>,
    /// Its depth, mm.
    pub shear_depth_mm: Option<f64>,
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
    /// Part of the friction of points that slide, µm/kN; none in `local`. The parts make up the tangent compliance.
    pub sliding_um_per_kn: Option<f64>,
}

/// One row of `stiffness_by_angle.csv`: a shift, a fixed load and a reference; a shift without a law has one row with its reason.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[allow(missing_docs)] // the columns are fields of the records above
pub struct ByAngleRow {
    pub shift_mm: f64,
    pub contact_angle_deg: Option<f64>,
    pub rail_y_mm: Option<f64>,
    pub rail_z_mm: Option<f64>,
    pub wheel_y_mm: Option<f64>,
    pub wheel_z_mm: Option<f64>,
    pub reference: String,
    pub force_kn: Option<f64>,
    pub displacement_mm: Option<f64>,
    pub tangent_kn_per_m: Option<f64>,
    pub displacement_rel_error_band: Option<f64>,
    pub tangent_rel_error_band: Option<f64>,
    pub grid_displacement_rel_change: Option<f64>,
    pub grid_tangent_rel_change: Option<f64>,
    pub mesh_displacement_rel_change: Option<f64>,
    pub mesh_tangent_rel_change: Option<f64>,
    pub scatter_displacement_rel_uncertainty: Option<f64>,
    pub scatter_tangent_rel_uncertainty: Option<f64>,
    pub horizontal_kn_per_m: Option<f64>,
    pub tangential_kn_per_m: Option<f64>,
    pub lateral_contact_um_per_kn: Option<f64>,
    pub contact_area_mm2: Option<f64>,
    pub max_pressure_mpa: Option<f64>,
    pub semi_axis_along_mm: Option<f64>,
    pub semi_axis_across_mm: Option<f64>,
    pub max_von_mises_mpa: Option<f64>,
    pub von_mises_depth_mm: Option<f64>,
    pub max_shear_mpa: Option<f64>,
    pub shear_depth_mm: Option<f64>,
    pub local_um_per_kn: Option<f64>,
    pub wheel_um_per_kn: Option<f64>,
    pub rail_um_per_kn: Option<f64>,
    pub sliding_um_per_kn: Option<f64>,
    pub law_a_kn_per_m: Option<f64>,
    pub law_b_kn_per_m: Option<f64>,
    pub law_c: Option<f64>,
    pub law_from_kn: Option<f64>,
    pub law_to_kn: Option<f64>,
    pub law_max_rel_error: Option<f64>,
    pub published_secant_ratio: Option<f64>,
    pub error_band_missing: String,
    pub reason: String,
}

impl StiffnessByAngleRecord {
    /// The rows of the CSV file.
    pub fn rows(&self) -> Vec<ByAngleRow> {
        self.shifts.iter().flat_map(ShiftRecord::rows).collect()
    }
}

impl ShiftRecord {
    /// Contact angle at the first touch, degrees.
    pub fn angle(&self) -> Option<f64> {
        self.touch.map(|touch| touch.contact_angle_deg)
    }

    /// What the solid is worth against a reference at a fixed load, kN.
    pub fn band(&self, reference: &str, force_kn: f64) -> Option<&BandPointRecord> {
        let band = self.error_band.as_ref()?.of(reference)?;
        band.points.iter().find(|point| point.force_kn == force_kn)
    }

    fn rows(&self) -> Vec<ByAngleRow> {
        let shift = ByAngleRow {
            shift_mm: self.shift_mm,
            contact_angle_deg: self.angle(),
            rail_y_mm: self.touch.map(|touch| touch.rail_y_mm),
            rail_z_mm: self.touch.map(|touch| touch.rail_z_mm),
            wheel_y_mm: self.touch.map(|touch| touch.wheel_y_mm),
            wheel_z_mm: self.touch.map(|touch| touch.wheel_z_mm),
            published_secant_ratio: self.published_secant_ratio,
            error_band_missing: self
                .error_band
                .as_ref()
                .map(|band| band.missing.join("; "))
                .unwrap_or_default(),
            reason: self.reason.clone().unwrap_or_default(),
            ..ByAngleRow::default()
        };
        if self.laws.is_empty() {
            return vec![shift];
        }
        let mut rows = Vec::new();
        for law in &self.laws {
            let reference = ByAngleRow {
                reference: law.reference.clone(),
                law_a_kn_per_m: Some(law.law.constants.a_kn_per_m),
                law_b_kn_per_m: Some(law.law.constants.b_kn_per_m),
                law_c: Some(law.law.constants.c),
                law_from_kn: Some(law.law.range_kn[0]),
                law_to_kn: Some(law.law.range_kn[1]),
                law_max_rel_error: Some(law.law.max_rel_error),
                ..shift.clone()
            };
            let before = rows.len();
            for load in &self.loads {
                let Some(point) = load.references.iter().find(|p| p.reference == law.reference) else {
                    continue;
                };
                let band = self.band(&law.reference, load.force_kn);
                rows.push(ByAngleRow {
                    force_kn: Some(load.force_kn),
                    displacement_mm: Some(point.displacement_mm),
                    tangent_kn_per_m: Some(point.tangent_kn_per_m),
                    displacement_rel_error_band: band.and_then(|b| b.displacement),
                    tangent_rel_error_band: band.and_then(|b| b.tangent),
                    grid_displacement_rel_change: band.and_then(|b| b.grid_displacement),
                    grid_tangent_rel_change: band.and_then(|b| b.grid_tangent),
                    mesh_displacement_rel_change: band.and_then(|b| b.mesh_displacement),
                    mesh_tangent_rel_change: band.and_then(|b| b.mesh_tangent),
                    scatter_displacement_rel_uncertainty: band.and_then(|b| b.scatter_displacement),
                    scatter_tangent_rel_uncertainty: band.and_then(|b| b.scatter_tangent),
                    horizontal_kn_per_m: Some(load.horizontal_kn_per_m),
                    tangential_kn_per_m: Some(load.tangential_kn_per_m),
                    lateral_contact_um_per_kn: load.lateral_contact_um_per_kn,
                    contact_area_mm2: Some(load.contact_area_mm2),
                    max_pressure_mpa: Some(load.max_pressure_mpa),
                    semi_axis_along_mm: Some(load.semi_axis_along_mm),
                    semi_axis_across_mm: Some(load.semi_axis_across_mm),
                    max_von_mises_mpa: load.max_von_mises_mpa,
                    von_mises_depth_mm: load.von_mises_depth_mm,
                    max_shear_mpa: load.max_shear_mpa,
                    shear_depth_mm: load.shear_depth_mm,
                    local_um_per_kn: Some(point.local_um_per_kn),
                    wheel_um_per_kn: point.wheel_um_per_kn,
                    rail_um_per_kn: point.rail_um_per_kn,
                    sliding_um_per_kn: point.sliding_um_per_kn,
                    ..reference.clone()
                });
            }
            // a law that no fixed load lies in has its constants all the same
            if rows.len() == before {
                rows.push(reference);
            }
        }
        rows
    }
}
