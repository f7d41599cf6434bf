//! A load case on the lumped element, in SI units.

use railspring_calibrate::beam::RailBeam;
use railspring_profiles::error::{InputError, Result};
use railspring_simulate::element::condensed::RailAtWheel;
use railspring_simulate::element::condensed::parts::{Bushing, Oscillator};
use railspring_simulate::time::function::{HarmonicForce, TimeFunction};
use railspring_simulate::time::scenario::{Kelvin, Scenario};

use super::constants::Constants;
use super::pair::LumpedPair;
use super::surfaces::{LumpedContact, LumpedSurfaces};
use crate::results::run::input::SimpleRunInput;
use crate::results::run::make::model_of_solids;
use crate::results::springs::record::StiffnessRecord;
use crate::study::{Study, StudyScenario};

/// Modes of the rail's beam up to this frequency (Hz) move; the others follow forces at once. With modes up to 3 or 40 kHz the forces of load case 4.1 are as far from those on the beam, by 0.03 % of their peaks.
pub const HIGHEST: f64 = 6e3;

/// Time steps in a row of the history, for rows of half a millisecond: with half of their length the forces of load case 4.1 change by 0.1 % of their peaks (RMS) in Exudyn and by 0.2 % in OpenSees.
const STEPS: f64 = 16.0;
const OF_ROW: f64 = 0.5e-3;

/// What a model of another program is made from.
pub(in crate::export) struct LumpedCase<'a> {
    /// Wheel and head.
    pub pair: LumpedPair<'a>,
    /// The load case.
    pub scenario: &'a Scenario,
    /// Its vertical and lateral force.
    forces: [HarmonicForce; 2],
    /// The rail by its modes.
    pub rail: RailAtWheel,
    /// The rail as a beam.
    pub beam: BeamAtWheel,
    /// Strips and running surfaces.
    pub surfaces: LumpedSurfaces,
    /// What lies between them.
    pub contact: LumpedContact,
    heading: String,
}

/// The rail as a beam with a wheel on it.
pub(in crate::export) struct BeamAtWheel {
    /// Of an even number of elements.
    pub beam: RailBeam,
    /// Place of the wheel, m from the first end.
    pub place: f64,
    /// Between the beam's section there and the head.
    pub bushing: Bushing,
}

impl<'a> LumpedCase<'a> {
    /// The load case with a name, or the only one, of the study of a `pair`, with a `contact`.
    ///
    /// # Errors
    /// [`InputError`] without the load case, and for load cases that these models do not have.
    pub fn of(
        pair: LumpedPair<'a>,
        name: Option<&str>,
        contact: LumpedContact,
        record: &StiffnessRecord,
    ) -> Result<Self> {
        let (study, geometry) = (pair.surfaces.study, &pair.surfaces.geometry);
        let (name, case) = chosen(study, name)?;
        let forces = check(name, case)?;
        let input = SimpleRunInput::of(study, case);
        // with a node in the middle
        let elements = study.simulation.rail_elements.next_multiple_of(2);
        let beam = geometry.pair.beam(&study.rail.material, study.rail.length, elements)?;
        let correction = record.beam.factors.into();
        let model = model_of_solids(&input, &geometry.pair, &beam, &correction, (&pair.element).into())?;
        let beam = beam.corrected(&correction)?;
        let place = case.scenario.start_x.unwrap_or(0.5 * beam.length());
        Ok(Self {
            scenario: &case.scenario,
            forces,
            rail: model.rail_at(place, HIGHEST)?,
            beam: BeamAtWheel { beam, place, bushing: model.bushing_on_beam(place)? },
            surfaces: LumpedSurfaces::of(&geometry.pair, &pair.element.strips),
            contact,
            heading: format!("load case {name}: {}", case.description),
            pair,
        })
    }

    /// The constants of the history.
    pub(super) fn write_history(&self, c: &mut Constants) {
        let scenario = self.scenario;
        c.about("History");
        c.count("ROWS", scenario.steps, "rows of the history after the first");
        c.number("ROW", scenario.time_step, "s, time between two rows");
        let steps = (STEPS * scenario.time_step / OF_ROW).ceil().max(1.0);
        c.count("STEPS", steps as usize, "time steps in a row");
    }

    /// The constants of load case and contact.
    pub(super) fn write_load_case(&self, c: &mut Constants) {
        let scenario = self.scenario;
        c.about("Load case");
        c.number("FRICTION", scenario.friction, "coefficient of friction");
        c.number("GRAVITY", scenario.gravity, "m/s^2, on hub and suspended mass");
        c.number("SUSPENDED_MASS", scenario.suspended_mass, "kg");
        let Kelvin { stiffness, damping } = scenario.vertical_suspension;
        c.number("SUSPENSION_STIFFNESS", stiffness, "N/m, vertical, between hub and suspended mass");
        c.number("SUSPENSION_DAMPING", damping, "N s/m");
        for (name, force, on) in [
            ("VERTICAL", self.forces[0], "suspended mass, down"),
            ("LATERAL", self.forces[1], "hub, to the field side"),
        ] {
            let HarmonicForce { mut constant, mut amplitude, mut frequency, mut phase } = force;
            if frequency == 0.0 || amplitude == 0.0 {
                constant += amplitude * phase.sin();
                (amplitude, frequency, phase) = (0.0, 1.0, 0.0);
            }
            c.number(&format!("{name}_MEAN"), constant, &format!("N, on the {on}"));
            c.number(&format!("{name}_AMPLITUDE"), amplitude, "N, of the sine");
            c.number(&format!("{name}_FREQUENCY"), frequency, "Hz");
            c.number(&format!("{name}_PHASE"), phase, "rad");
        }
    }

    /// Mass of the wheel, kg; what that of a load case weighs more sits at the hub.
    pub fn hub_mass(&self) -> f64 {
        self.scenario.wheel_mass.unwrap_or(self.pair.element.set.hub.mass)
    }

    /// The constants of the wheel.
    pub(super) fn write_wheel(&self, c: &mut Constants) {
        let set = &self.pair.element.set;
        c.about("Wheel: a hub, and oscillators of 1 kg that it holds");
        c.numbers(
            "WHEEL_ORIGIN",
            self.pair.wheel_origin(),
            "m, origin (y, z) of the wheel's profile from the line of shear centres, where the wheel just touches",
        );
        c.number("HUB_MASS", self.hub_mass(), "kg, of the whole wheel");
        let of = |value: fn(&Oscillator) -> f64| set.oscillators.iter().map(value);
        c.numbers("OSCILLATOR_FREQUENCY", of(|o| o.frequency), "Hz, with the hub held");
        c.numbers("RIM_LATERAL", of(|o| o.lateral), "r_y, motion of the rim along y");
        c.numbers("RIM_TURN", of(|o| o.turn), "1/m, r_phi, rotation of the rim");
        c.number("RIM_OFFSET", set.offset, "m, motion of the rim along z over its rotation");
        c.numbers(
            "COUPLING_LATERAL",
            of(|o| o.coupling[0]),
            "kg, c, mass between oscillator and hub along y",
        );
        c.numbers("COUPLING_VERTICAL", of(|o| o.coupling[1]), "kg, the same along z");
        c.number("WHEEL_DAMPING", self.pair.damping[1], "s, beta, damping over stiffness");
    }

    /// What a file says first.
    pub fn heading(&self, program: &str) -> Vec<String> {
        let left_out =
            "left out: motion along the rail, torsion of the rail by a torque, and rotation of the hub";
        self.pair.heading(program, &[&self.heading, left_out])
    }
}

/// The load case with a name, or the only one.
fn chosen<'a>(study: &'a Study, name: Option<&str>) -> Result<(&'a str, &'a StudyScenario)> {
    let mut cases = study.scenarios.iter();
    let found = match name {
        Some(name) => cases.find(|(known, _)| *known == name),
        None => cases.next().filter(|_| study.scenarios.len() == 1),
    };
    found.map(|(name, case)| (name.as_str(), case)).ok_or_else(|| {
        let names: Vec<&str> = study.scenarios.keys().map(String::as_str).collect();
        let (expected, remedy) = match names.is_empty() {
            true => ("a study with a load case".into(), "give the study a [scenario.NAME]"),
            false => (format!("a load case of the study: {}", names.join(", ")), "name one of them"),
        };
        InputError::new("--case", name.unwrap_or("(missing)"), expected, remedy).into()
    })
}

/// The vertical and the lateral force of a load case that a model which stays in its place can have.
fn check(name: &str, StudyScenario { scenario, .. }: &StudyScenario) -> Result<[HarmonicForce; 2]> {
    let refuse = |key: &str, value: String, expected: &str| {
        InputError::refuse(
            format!("scenario.{name}.{key}"),
            value,
            expected,
            "name another load case with --case, or change this one with --set",
        )
    };
    if scenario.speed != 0.0 {
        return refuse("speed_m_per_s", scenario.speed.to_string(), "0: the model stays in its place");
    }
    if scenario.rail_torsion.is_some() {
        return refuse("rail_torsion", "given".into(), "none: the model has no torque on the rail");
    }
    if !scenario.rotations_held {
        return refuse("rotations_held", "false".into(), "true: the hub of the model does not turn");
    }
    let of_key = |key| refuse(key, "a sum or a table".into(), "a mean and one sine, which the model has");
    match [&scenario.vertical_force, &scenario.lateral_force].map(TimeFunction::as_harmonic) {
        [Some(vertical), Some(lateral)] => Ok([vertical, lateral]),
        [None, _] => of_key("vertical_force"),
        [_, None] => of_key("lateral_force"),
    }
}
