//! The condensed contact element, in `stiffness_by_angle.json`: what the simple model knows of the solids.

use nalgebra::{Matrix3, Vector3};
use railspring_element::held_end::{EndPlace, HeldEnd};
use railspring_element::law::{StripPlace, StripStiffness};
use railspring_element::modulus::StripModulus;
use railspring_element::pair_element::PairElement;
use railspring_element::relief::Influence;
use railspring_element::wheel::{ElasticWheel, RimMode};
use railspring_profiles::error::InputError;
use railspring_profiles::units::{GIGAPASCAL, MILLIMETRE};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One µm·mm/kN in m²/N.
const MICROMETRE_MILLIMETRE_PER_KILONEWTON: f64 = 1e-12;

/// The condensed contact element. Motions are displacements y and z (m) and the rotation about x (rad), forces those in y and z (N) and the
/// torque about x (N·m); of the wheel about the origin of its profile, of the rail's head about the line of shear centres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ElementRecord {
    /// The wheel.
    pub wheel: ElasticWheelRecord,
    /// Flexibility of the rail's head against its section: motions under unit forces.
    pub head: [[f64; 3]; 3],
    /// What becomes of it near a held end of the rail; left out of an element that knows the middle of its rail alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub held_end: Option<HeldEndRecord>,
    /// Stiffness of the contact's strips along the rail.
    pub strips: Vec<StripRecord>,
    /// Displacement of a surface at a distance from a load, times that: what contacts relieve each other, µm·mm/kN.
    pub relief_um_mm_per_kn: f64,
    /// Largest deviation of a contact force from that of the solid at the same approach, relative.
    pub strips_max_rel_error: f64,
    /// The hub's displacement along the contact normal against the solid's, where it is farthest from it; none where no place and load has both.
    pub displacement: Option<HubDeviationRecord>,
    /// What of the motions of rim and head a section that moves without distortion does not have, relative.
    pub section_misfit: [f64; 2],
}

/// Where the hub of the condensed element is farthest from that of the solid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HubDeviationRecord {
    /// Difference of the displacements over the solid's under the largest load of the place.
    pub max_rel_error: f64,
    /// Lateral shift of the wheelset, mm.
    pub shift_mm: f64,
    /// Load along the contact normal, kN.
    pub force_kn: f64,
}

/// The head of a rail near an end that is held.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HeldEndRecord {
    /// Length of the rail at either end that has no shear flexibility, mm; its torsion is Vlasov's.
    pub shear_inset_mm: f64,
    /// The head against such a rail, by its distance from the nearer end.
    pub places: Vec<EndPlaceRecord>,
}

/// The head at a distance from a held end.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EndPlaceRecord {
    /// The distance, mm.
    pub distance_mm: f64,
    /// Its flexibility against the rail: motions under unit forces.
    pub flexibility: [[f64; 3]; 3],
    /// Its motion beyond the rail's rotation under a torque of 1 N·m at the middle of the rail.
    pub twist: [f64; 3],
}

/// The wheel as hub, modes and static rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StripRecord {
    /// Arc length on the rail's running surface, mm.
    pub rail_s_mm: f64,
    /// Force per length and penetration, GPa, where that is small.
    pub modulus_gpa: f64,
    /// Share by which it grows where the penetration is large.
    pub hardening: f64,
    /// Force per length and tangential displacement, GPa.
    pub tangential_gpa: f64,
    /// Share of what a contact's loads take off the penetrations.
    pub relief: f64,
}

fn rows(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| matrix[(i, j)]))
}

fn matrix(rows: &[[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

impl ElementRecord {
    /// Whether a file can have this element: strips whose places are equally far apart, and what is stiff or heavy is so.
    ///
    /// # Errors
    /// [`InputError`] with the `file` and the key in it.
    pub fn check(&self, file: &str) -> Result<(), InputError> {
        let remedy = "calibrate again, or take simulation.element = \"published\"";
        let wrong = |key: String, value: String, expected: &str| {
            Err(InputError::new(format!("{file}: element.{key}"), value, expected, remedy))
        };
        evenly_apart(&self.strips.iter().map(|strip| strip.rail_s_mm).collect::<Vec<_>>(), &wrong)?;
        for (i, strip) in self.strips.iter().enumerate() {
            let key = |name: &str| format!("strips[{i}].{name}");
            for (name, value, least) in [
                ("modulus_gpa", strip.modulus_gpa, f64::MIN_POSITIVE),
                ("tangential_gpa", strip.tangential_gpa, f64::MIN_POSITIVE),
                ("relief", strip.relief, 0.0),
            ] {
                if value < least {
                    let expected = if least > 0.0 { "more than 0" } else { "0 or more" };
                    return wrong(key(name), value.to_string(), expected);
                }
            }
            if strip.hardening <= -1.0 {
                return wrong(
                    key("hardening"),
                    strip.hardening.to_string(),
                    "more than -1: a strip that resists",
                );
            }
        }
        if let Some(end) = &self.held_end {
            end.check(&wrong)?;
        }
        if self.relief_um_mm_per_kn < 0.0 {
            return wrong("relief_um_mm_per_kn".into(), self.relief_um_mm_per_kn.to_string(), "0 or more");
        }
        for (i, mode) in self.wheel.modes.iter().enumerate() {
            if mode.square_per_s2 <= 0.0 {
                let key = format!("wheel.modes[{i}].square_per_s2");
                return wrong(key, mode.square_per_s2.to_string(), "more than 0: a mode that swings");
            }
        }
        mass_in_all_directions("wheel.mass", &matrix(&self.wheel.mass), &wrong)
    }
}

/// Refuses the value of a key of an element, of which it says what was expected.
type Wrong<'a> = &'a dyn Fn(String, String, &str) -> Result<(), InputError>;

/// That strips are at one place at least, and at places (mm) that are equally far apart.
pub(super) fn evenly_apart(places: &[f64], wrong: Wrong<'_>) -> Result<(), InputError> {
    let Some((first, last)) = places.first().zip(places.last()) else {
        return wrong("strips".into(), "[]".into(), "the strips at one place of the rail at least");
    };
    let apart = (last - first) / (places.len() - 1).max(1) as f64;
    for (i, place) in places.iter().enumerate() {
        let key = || format!("strips[{i}].rail_s_mm");
        let expected = first + apart * i as f64;
        if let Some(before) = places[..i].last().filter(|before| place <= before) {
            return wrong(key(), place.to_string(), &format!("more than {before} mm, the place before"));
        }
        if (place - expected).abs() > 1e-6 * apart.abs() {
            let expected = format!("places that are equally far apart, here {expected} mm");
            return wrong(key(), place.to_string(), &expected);
        }
    }
    Ok(())
}

/// That a hub has a mass in all directions.
pub(super) fn mass_in_all_directions(
    key: &str,
    mass: &Matrix3<f64>,
    wrong: Wrong<'_>,
) -> Result<(), InputError> {
    match mass.cholesky() {
        Some(_) => Ok(()),
        None => wrong(
            key.into(),
            format!("{:?}", rows(mass)),
            "a mass in all directions (a positive definite matrix)",
        ),
    }
}

impl HeldEndRecord {
    /// Whether there is a place at least, and each is farther from the end than the one before.
    pub(super) fn check(&self, wrong: Wrong<'_>) -> Result<(), InputError> {
        if self.shear_inset_mm < 0.0 {
            return wrong("held_end.shear_inset_mm".into(), self.shear_inset_mm.to_string(), "0 or more");
        }
        if self.places.is_empty() {
            return wrong(
                "held_end.places".into(),
                "[]".into(),
                "the head at one distance from the end at least",
            );
        }
        let mut before = 0.0;
        for (i, place) in self.places.iter().enumerate() {
            if place.distance_mm <= before {
                let key = format!("held_end.places[{i}].distance_mm");
                let expected = format!("more than {before} mm, the place before");
                return wrong(key, place.distance_mm.to_string(), &expected);
            }
            before = place.distance_mm;
        }
        Ok(())
    }
}

impl From<&HeldEnd> for HeldEndRecord {
    fn from(HeldEnd { inset, places }: &HeldEnd) -> Self {
        let place = |EndPlace { distance, flexibility, twist }: &EndPlace| EndPlaceRecord {
            distance_mm: distance / MILLIMETRE,
            flexibility: rows(flexibility),
            twist: (*twist).into(),
        };
        Self { shear_inset_mm: inset / MILLIMETRE, places: places.iter().map(place).collect() }
    }
}

impl From<&HeldEndRecord> for HeldEnd {
    fn from(HeldEndRecord { shear_inset_mm, places }: &HeldEndRecord) -> Self {
        let place = |EndPlaceRecord { distance_mm, flexibility, twist }: &EndPlaceRecord| EndPlace {
            distance: distance_mm * MILLIMETRE,
            flexibility: matrix(flexibility),
            twist: Vector3::from(*twist),
        };
        Self { inset: shear_inset_mm * MILLIMETRE, places: places.iter().map(place).collect() }
    }
}

impl From<&PairElement> for ElementRecord {
    fn from(element: &PairElement) -> Self {
        let PairElement { wheel, head, held_end, strips, misfit } = element;
        let mode = |mode: &RimMode| RimModeRecord {
            frequency_hz: mode.square.sqrt() / std::f64::consts::TAU,
            square_per_s2: mode.square,
            rim: mode.rim.into(),
            coupling: mode.coupling.into(),
        };
        let strip = |place: &StripPlace| StripRecord {
            rail_s_mm: place.rail_s / MILLIMETRE,
            modulus_gpa: place.modulus.normal / GIGAPASCAL,
            hardening: place.modulus.hardening,
            tangential_gpa: place.modulus.tangential / GIGAPASCAL,
            relief: place.modulus.relief,
        };
        Self {
            wheel: ElasticWheelRecord {
                mass: rows(&wheel.mass),
                hub_m: wheel.hub,
                modes: wheel.modes.iter().map(mode).collect(),
                rest: rows(&wheel.rest),
            },
            head: rows(head),
            held_end: held_end.as_ref().map(HeldEndRecord::from),
            strips: strips.places().iter().map(strip).collect(),
            relief_um_mm_per_kn: strips.influence.flexibility / MICROMETRE_MILLIMETRE_PER_KILONEWTON,
            strips_max_rel_error: strips.misfit,
            displacement: None,
            section_misfit: *misfit,
        }
    }
}

impl From<&ElementRecord> for PairElement {
    fn from(record: &ElementRecord) -> Self {
        let ElementRecord { wheel, head, held_end, strips, .. } = record;
        let mode = |mode: &RimModeRecord| RimMode {
            square: mode.square_per_s2,
            rim: Vector3::from(mode.rim),
            coupling: Vector3::from(mode.coupling),
        };
        let place = |strip: &StripRecord| StripPlace {
            rail_s: strip.rail_s_mm * MILLIMETRE,
            modulus: StripModulus {
                normal: strip.modulus_gpa * GIGAPASCAL,
                hardening: strip.hardening,
                tangential: strip.tangential_gpa * GIGAPASCAL,
                relief: strip.relief,
            },
        };
        Self {
            wheel: ElasticWheel {
                mass: matrix(&wheel.mass),
                hub: wheel.hub_m,
                modes: wheel.modes.iter().map(mode).collect(),
                rest: matrix(&wheel.rest),
            },
            head: matrix(head),
            held_end: held_end.as_ref().map(HeldEnd::from),
            strips: StripStiffness::new(
                strips.iter().map(place).collect(),
                Influence { flexibility: record.relief_um_mm_per_kn * MICROMETRE_MILLIMETRE_PER_KILONEWTON },
                record.strips_max_rel_error,
            ),
            misfit: record.section_misfit,
        }
    }
}
