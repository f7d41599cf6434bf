//! The condensed contact element, in `stiffness_by_angle.json`: what the simple model knows of the solids.

use nalgebra::{Matrix3, Vector3};
use railspring_calibrate::element::{ElasticWheel, PairElement, RimMode, StripPlace, StripStiffness};
use railspring_calibrate::units::MILLIMETRE;
use serde::{Deserialize, Serialize};

/// One GPa in Pa.
const GIGAPASCAL: f64 = 1e9;

/// The condensed contact element. Motions are displacements y and z (m) and the rotation about x (rad), forces those in y and z (N) and the
/// torque about x (N·m); of the wheel about the origin of its profile, of the rail's head about the line of shear centres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ElementRecord {
    /// The wheel.
    pub wheel: ElasticWheelRecord,
    /// Flexibility of the rail's head against its section: motions under unit forces.
    pub head: [[f64; 3]; 3],
    /// Stiffness of the contact's strips along the rail.
    pub strips: Vec<StripRecord>,
    /// Largest deviation of a contact force from that of the solid at the same approach, relative.
    pub strips_max_rel_error: f64,
    /// The hub's displacement along the contact normal against the solid's, where it is farthest from it; none where no place and load has both.
    pub displacement: Option<HubDeviationRecord>,
    /// What of the motions of rim and head a section that moves without distortion does not have, relative.
    pub section_misfit: [f64; 2],
}

/// Where the hub of the condensed element is farthest from that of the solid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HubDeviationRecord {
    /// Difference of the displacements over the solid's under the largest load of the place.
    pub max_rel_error: f64,
    /// Lateral shift of the wheelset, mm.
    pub shift_mm: f64,
    /// Load along the contact normal, kN.
    pub force_kn: f64,
}

/// The wheel as hub, modes and static rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ElasticWheelRecord {
    /// Mass between the motions of the hub, as of a rigid body about its centre; kg, kg·m, kg·m².
    pub mass: [[f64; 3]; 3],
    /// From the origin of the profile to the hub's centre (y, z), m.
    pub hub_m: [f64; 2],
    /// Modes of mass 1 kg with the hub held.
    pub modes: Vec<RimModeRecord>,
    /// Flexibility of the rim beyond the modes.
    pub rest: [[f64; 3]; 3],
}

/// A mode of the wheel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RimModeRecord {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Square of the angular frequency, 1/s².
    pub square_per_s2: f64,
    /// Motion of the rim.
    pub rim: [f64; 3],
    /// Mass between the mode and the motions of the hub.
    pub coupling: [f64; 3],
}

/// The strips at one place of the rail.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StripRecord {
    /// Arc length on the rail's running surface, mm.
    pub rail_s_mm: f64,
    /// Force per length and penetration, GPa.
    pub modulus_gpa: f64,
    /// Tangential stiffness of a contact over its normal one.
    pub tangential_ratio: f64,
}

fn rows(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| matrix[(i, j)]))
}

fn matrix(rows: &[[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

impl From<&PairElement> for ElementRecord {
    fn from(element: &PairElement) -> Self {
        let PairElement { wheel, head, strips, misfit } = element;
        let mode = |mode: &RimMode| RimModeRecord {
            frequency_hz: mode.square.sqrt() / std::f64::consts::TAU,
            square_per_s2: mode.square,
            rim: mode.rim.into(),
            coupling: mode.coupling.into(),
        };
        let strip = |place: &StripPlace| StripRecord {
            rail_s_mm: place.rail_s / MILLIMETRE,
            modulus_gpa: place.modulus / GIGAPASCAL,
            tangential_ratio: place.tangential,
        };
        Self {
            wheel: ElasticWheelRecord {
                mass: rows(&wheel.mass),
                hub_m: wheel.hub,
                modes: wheel.modes.iter().map(mode).collect(),
                rest: rows(&wheel.rest),
            },
            head: rows(head),
            strips: strips.places.iter().map(strip).collect(),
            strips_max_rel_error: strips.misfit,
            displacement: None,
            section_misfit: *misfit,
        }
    }
}

impl From<&ElementRecord> for PairElement {
    fn from(record: &ElementRecord) -> Self {
        let ElementRecord { wheel, head, strips, .. } = record;
        let mode = |mode: &RimModeRecord| RimMode {
            square: mode.square_per_s2,
            rim: Vector3::from(mode.rim),
            coupling: Vector3::from(mode.coupling),
        };
        let place = |strip: &StripRecord| StripPlace {
            rail_s: strip.rail_s_mm * MILLIMETRE,
            modulus: strip.modulus_gpa * GIGAPASCAL,
            tangential: strip.tangential_ratio,
        };
        Self {
            wheel: ElasticWheel {
                mass: matrix(&wheel.mass),
                hub: wheel.hub_m,
                modes: wheel.modes.iter().map(mode).collect(),
                rest: matrix(&wheel.rest),
            },
            head: matrix(head),
            strips: StripStiffness {
                places: strips.iter().map(place).collect(),
                misfit: record.strips_max_rel_error,
            },
            misfit: record.section_misfit,
        }
    }
}
