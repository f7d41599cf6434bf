//! The lumped contact element, in `stiffness_by_angle.json`: bodies, bushings and strips that a program of vehicle dynamics can enter.

use railspring_element::law::{StripPlace, StripStiffness};
use railspring_element::modulus::StripModulus;
use railspring_element::relief::Influence;
use railspring_profiles::error::InputError;
use railspring_profiles::units::{GIGAPASCAL, KILONEWTON_PER_METRE, MILLIMETRE};
use railspring_simulate::element::condensed::parts::{Bushing, Hub, LumpedElement, LumpedSet, Oscillator};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::results::by_angle::element::{
    HeldEndRecord, HubDeviationRecord, evenly_apart, mass_in_all_directions,
};

/// One kN·m/rad in N·m/rad.
const KILONEWTON_METRE: f64 = 1e3;

/// The lumped contact element: hub, oscillators, a bushing between the head and the section of the rail, and the strips of the contact. y goes to the field side, z down, the rotation is
/// that about x along the track. The wheel is described about the origin of its profile, the rail about the line of its shear centres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LumpedRecord {
    /// What of the wheel moves as a rigid body.
    pub hub: HubRecord,
    /// Masses of 1 kg on springs that the hub holds. The rim's motion is the hub's and, for each, its displacement times `rim_lateral` (y), times `rim_offset_mm` and `rim_turn_per_m` (z), and times `rim_turn_per_m` (rotation).
    pub oscillators: Vec<OscillatorRecord>,
    /// Distance of the profile's origin to the field side from the point of the rim that does not rise where it turns, mm.
    pub rim_offset_mm: f64,
    /// Between the head and the beam's section: the flexibility of the head, and what the oscillators leave of that of the rim. On a rail that moves as a beam, far from its ends.
    pub bushing: BushingRecord,
    /// The same against a section that is held, as the solids are pressed.
    pub bushing_on_section: BushingRecord,
    /// What becomes of the bushing near a held end of the rail; left out of an element that knows the middle of its rail alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub held_end: Option<HeldEndRecord>,
    /// Strips along the rail, each with forces in proportion to its penetration and to its tangential displacement, whatever the others have.
    pub strips: Vec<LinearStripRecord>,
    /// Largest deviation of a contact force from that of the solid at the same approach, relative.
    pub strips_max_rel_error: f64,
    /// The hub's displacement along the contact normal against the solid's, where it is farthest from it; none where no place and load has both.
    pub displacement: Option<HubDeviationRecord>,
    /// What of the motions of rim and head a section that moves without distortion does not have, relative.
    pub section_misfit: [f64; 2],
    /// Error band of the constants; left out where the study wants no error bands.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_band: Option<LumpedBandRecord>,
}

/// How far the constants of hub, oscillators and bushing change on bodies of elements twice as large. The strips have the error bands of the laws by contact angle that they are fitted to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LumpedBandRecord {
    /// Edge of the contact elements of the coarser meshes, mm; none where there are none.
    pub coarser_element_mm: Option<f64>,
    /// Why there is no band, if so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub missing: Option<String>,
    /// Half the width of the band of each constant, in its own unit: the size of its change.
    pub constants: Option<LumpedConstantsRecord>,
}

/// The constants of hub, oscillators and bushing, as in the lumped element.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LumpedConstantsRecord {
    /// The hub.
    pub hub: HubRecord,
    /// The oscillators.
    pub oscillators: Vec<OscillatorRecord>,
    /// See `rim_offset_mm` there.
    pub rim_offset_mm: f64,
    /// The bushing.
    pub bushing: BushingRecord,
    /// The bushing on a section that is held.
    pub bushing_on_section: BushingRecord,
}

/// The hub.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HubRecord {
    /// Mass of the whole wheel, kg.
    pub mass_kg: f64,
    /// Inertia of the whole wheel about x through the hub's centre, kg·m²; it, the centre of gravity and the couplings with the rotation count where a load case frees the rotation of the hub alone.
    pub inertia_kg_m2: f64,
    /// From the hub's centre to the centre of gravity of the whole wheel (y, z), mm.
    pub gravity_centre_mm: [f64; 2],
    /// From the origin of the profile to the hub's centre (y, z), mm.
    pub centre_mm: [f64; 2],
}

/// A mass of 1 kg on a spring that the hub holds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OscillatorRecord {
    /// Frequency with the hub held, Hz.
    pub frequency_hz: f64,
    /// Displacement of the rim along y per displacement.
    pub rim_lateral: f64,
    /// Rotation of the rim per displacement, 1/m.
    pub rim_turn_per_m: f64,
    /// Mass between the oscillator and the hub's motions along y and z, kg; one of both at most is not zero.
    pub coupling_kg: [f64; 2],
    /// The same with the hub's rotation, kg·m.
    pub coupling_turn_kg_m: f64,
}

/// Springs between head and section that meet at the elastic centre.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BushingRecord {
    /// Along y, kN/m.
    pub lateral_kn_per_m: f64,
    /// Along z, kN/m.
    pub vertical_kn_per_m: f64,
    /// About x, kN·m/rad.
    pub turn_knm_per_rad: f64,
    /// Height of the elastic centre above the line of shear centres, mm.
    pub height_mm: f64,
}

/// The strips at one place of the rail.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LinearStripRecord {
    /// Arc length on the rail's running surface, mm.
    pub rail_s_mm: f64,
    /// Force per length and penetration, GPa.
    pub modulus_gpa: f64,
    /// Force per length and tangential displacement, GPa.
    pub tangential_gpa: f64,
}

impl LumpedRecord {
    /// Whether a file can have this element: strips whose places are equally far apart, and what is stiff or heavy is so.
    ///
    /// # Errors
    /// [`InputError`] with the `file` and the key in it.
    pub fn check(&self, file: &str) -> Result<(), InputError> {
        let remedy = "calibrate again, or take simulation.element = \"published\"";
        let wrong = |key: String, value: String, expected: &str| {
            Err(InputError::new(format!("{file}: lumped.{key}"), value, expected, remedy))
        };
        evenly_apart(&self.strips.iter().map(|strip| strip.rail_s_mm).collect::<Vec<_>>(), &wrong)?;
        let positive = |key: String, value: f64| match value > 0.0 {
            true => Ok(()),
            false => wrong(key, value.to_string(), "more than 0"),
        };
        for (i, strip) in self.strips.iter().enumerate() {
            positive(format!("strips[{i}].modulus_gpa"), strip.modulus_gpa)?;
            positive(format!("strips[{i}].tangential_gpa"), strip.tangential_gpa)?;
        }
        for (i, oscillator) in self.oscillators.iter().enumerate() {
            positive(format!("oscillators[{i}].frequency_hz"), oscillator.frequency_hz)?;
        }
        for (name, of) in [("bushing", &self.bushing), ("bushing_on_section", &self.bushing_on_section)] {
            positive(format!("{name}.lateral_kn_per_m"), of.lateral_kn_per_m)?;
            positive(format!("{name}.vertical_kn_per_m"), of.vertical_kn_per_m)?;
            positive(format!("{name}.turn_knm_per_rad"), of.turn_knm_per_rad)?;
        }
        if let Some(end) = &self.held_end {
            end.check(&wrong)?;
        }
        let mass = LumpedElement::from(self).set.wheel().mass;
        mass_in_all_directions("hub", &mass, &wrong)
    }
}

impl From<&Bushing> for BushingRecord {
    fn from(bushing: &Bushing) -> Self {
        Self {
            lateral_kn_per_m: bushing.lateral / KILONEWTON_PER_METRE,
            vertical_kn_per_m: bushing.vertical / KILONEWTON_PER_METRE,
            turn_knm_per_rad: bushing.turn / KILONEWTON_METRE,
            height_mm: bushing.height / MILLIMETRE,
        }
    }
}

impl From<&BushingRecord> for Bushing {
    fn from(record: &BushingRecord) -> Self {
        Self {
            lateral: record.lateral_kn_per_m * KILONEWTON_PER_METRE,
            vertical: record.vertical_kn_per_m * KILONEWTON_PER_METRE,
            turn: record.turn_knm_per_rad * KILONEWTON_METRE,
            height: record.height_mm * MILLIMETRE,
        }
    }
}

impl From<&LumpedSet> for LumpedConstantsRecord {
    fn from(set: &LumpedSet) -> Self {
        let Hub { mass, inertia, gravity_centre, centre } = set.hub;
        let oscillator = |of: &Oscillator| OscillatorRecord {
            frequency_hz: of.frequency,
            rim_lateral: of.lateral,
            rim_turn_per_m: of.turn,
            coupling_kg: of.coupling,
            coupling_turn_kg_m: of.turn_coupling,
        };
        Self {
            hub: HubRecord {
                mass_kg: mass,
                inertia_kg_m2: inertia,
                gravity_centre_mm: gravity_centre.map(|m| m / MILLIMETRE),
                centre_mm: centre.map(|m| m / MILLIMETRE),
            },
            oscillators: set.oscillators.iter().map(oscillator).collect(),
            rim_offset_mm: set.offset / MILLIMETRE,
            bushing: BushingRecord::from(&set.bushing),
            bushing_on_section: BushingRecord::from(&set.on_section),
        }
    }
}

impl From<&LumpedElement> for LumpedRecord {
    fn from(LumpedElement { set, strips, misfit }: &LumpedElement) -> Self {
        let LumpedConstantsRecord { hub, oscillators, rim_offset_mm, bushing, bushing_on_section } =
            set.into();
        let strip = |place: &StripPlace| LinearStripRecord {
            rail_s_mm: place.rail_s / MILLIMETRE,
            modulus_gpa: place.modulus.normal / GIGAPASCAL,
            tangential_gpa: place.modulus.tangential / GIGAPASCAL,
        };
        Self {
            hub,
            oscillators,
            rim_offset_mm,
            bushing,
            bushing_on_section,
            held_end: set.held_end.as_ref().map(HeldEndRecord::from),
            strips: strips.places().iter().map(strip).collect(),
            strips_max_rel_error: strips.misfit,
            displacement: None,
            section_misfit: *misfit,
            error_band: None,
        }
    }
}

impl From<&LumpedRecord> for LumpedElement {
    fn from(record: &LumpedRecord) -> Self {
        let HubRecord { mass_kg, inertia_kg_m2, gravity_centre_mm, centre_mm } = record.hub;
        let oscillator = |of: &OscillatorRecord| Oscillator {
            frequency: of.frequency_hz,
            lateral: of.rim_lateral,
            turn: of.rim_turn_per_m,
            coupling: of.coupling_kg,
            turn_coupling: of.coupling_turn_kg_m,
        };
        let place = |strip: &LinearStripRecord| StripPlace {
            rail_s: strip.rail_s_mm * MILLIMETRE,
            modulus: StripModulus {
                normal: strip.modulus_gpa * GIGAPASCAL,
                hardening: 0.0,
                tangential: strip.tangential_gpa * GIGAPASCAL,
                relief: 0.0,
            },
        };
        let set = LumpedSet {
            hub: Hub {
                mass: mass_kg,
                inertia: inertia_kg_m2,
                gravity_centre: gravity_centre_mm.map(|mm| mm * MILLIMETRE),
                centre: centre_mm.map(|mm| mm * MILLIMETRE),
            },
            oscillators: record.oscillators.iter().map(oscillator).collect(),
            offset: record.rim_offset_mm * MILLIMETRE,
            bushing: Bushing::from(&record.bushing),
            on_section: Bushing::from(&record.bushing_on_section),
            held_end: record.held_end.as_ref().map(From::from),
        };
        let places = record.strips.iter().map(place).collect();
        let strips = StripStiffness::new(places, Influence::default(), record.strips_max_rel_error);
        Self { set, strips, misfit: record.section_misfit }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::samples;

    /// Goal: an element of a file has the file's constants, whatever their units: written again they are the same. Accuracy: ROUNDOFF, two products of numbers with sixteen digits.
    #[test]
    fn a_file_has_the_constants_that_run() {
        const ROUNDOFF: f64 = 1e-15;
        let record = samples::lumped();
        let again = LumpedRecord::from(&LumpedElement::from(&record));
        let [given, again] = [&record, &again].map(|of| serde_json::to_value(of).unwrap());
        let numbers = |of: &serde_json::Value| -> Vec<f64> {
            let mut all = Vec::new();
            let mut open = vec![of.clone()];
            while let Some(value) = open.pop() {
                match value {
                    serde_json::Value::Array(values) => open.extend(values),
                    serde_json::Value::Object(values) => {
                        open.extend(values.into_iter().map(|(_, value)| value))
                    }
                    value => all.extend(value.as_f64()),
                }
            }
            all
        };
        let (given, again) = (numbers(&given), numbers(&again));
        assert!(given.len() > 25 && given.len() == again.len());
        for (given, again) in given.iter().zip(&again) {
            assert!((given - again).abs() <= ROUNDOFF * given.abs(), "{given} {again}");
        }
    }
}
