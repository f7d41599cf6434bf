//! The load case that a reference solver repeats.

use railspring_profiles::error::{InputError, Result};
use railspring_profiles::field::InputField;
use railspring_simulate::time::function::{HarmonicForce, TimeFunction};
use railspring_simulate::time::scenario::Scenario;
use serde::Serialize;

use crate::engine::store::{Address, Kind};
use crate::hash::key;
use crate::python::Purpose;
use crate::results::bodies::estimate::Work;
use crate::results::bodies::input::{PairInput, SolidsInput};
use crate::results::crosscheck::input::CrosscheckInput;
use crate::study::{Statics, Study};

/// The first load case of a study on both bodies at full order, with a contact between the elements of the meshes.
#[derive(Debug, Clone)]
pub struct InTimeInput<'a> {
    pair: CrosscheckInput<'a>,
    /// Name of the load case.
    pub name: &'a str,
    /// The load case.
    pub case: &'a Scenario,
    /// Its vertical and lateral force.
    pub forces: [HarmonicForce; 2],
    /// Steps of the bodies in each of its time steps; half as many are tried, too.
    pub inner_steps: usize,
    /// Damping of both bodies, s.
    pub damping: f64,
}

impl<'a> InTimeInput<'a> {
    /// That of a study.
    ///
    /// # Errors
    /// [`InputError`] for a study without a load case, without an even number of steps, and for what the reference does
    /// not have: a wheel that rolls, turns or has a mass of its own, and a torsion of the rail.
    pub fn of(study: &'a Study) -> Result<Self> {
        let first = study.main_scenario.as_ref().and_then(|name| study.scenarios.get_key_value(name));
        let Some((name, own)) = first else {
            return InputError::refuse(
                "scenario",
                "none",
                "a load case for --in-time",
                "add one to the study",
            );
        };
        let case = &own.scenario;
        let inner_steps = match study.solid.inner_steps {
            Some(count) if count % 2 == 0 => count,
            given => {
                return InputError::refuse(
                    "solid.inner_steps",
                    given.map_or("none".into(), |count| count.to_string()),
                    "an even number for --in-time, of which half are tried as well",
                    "give 8, for instance",
                );
            }
        };
        let forces = check(name, case).map_err(|error| study.source.in_scenario(name, error.into()))?;
        Ok(Self { pair: CrosscheckInput::of(study), name, case, forces, inner_steps, damping: study.damping })
    }

    /// The pair with a contact between the elements of its meshes.
    pub fn statics(&self) -> Statics<'_> {
        self.pair.statics()
    }

    /// The same for what is said of their size.
    pub fn solids(&self) -> SolidsInput<'_> {
        self.pair.solids()
    }

    /// Name of the study.
    pub fn study(&self) -> &'a str {
        self.pair.name()
    }

    /// What it takes.
    pub fn work(&self) -> Work {
        let steps = self.case.steps * self.inner_steps;
        Work {
            solids: vec![(self.name.into(), steps)],
            reference: Some(Purpose::FirstOrder),
            ..Work::default()
        }
    }

    /// Hash of all that the question and the tool's answer depend on.
    pub fn key(&self) -> String {
        key(&self.question())
    }

    /// Address of the answer of some versions of the programs.
    pub fn address(&self, versions: (String, &str)) -> Address {
        Address::of(Kind::Crosscheck, &("in time", self.question(), versions))
    }

    fn question(&self) -> Question<'_> {
        let Self { case, inner_steps, damping, .. } = *self;
        Question { pair: PairInput::of(self.statics()), case, inner_steps, damping }
    }
}

/// What question and answer depend on.
#[derive(Serialize)]
struct Question<'a> {
    pair: PairInput<'a>,
    case: &'a Scenario,
    inner_steps: usize,
    damping: f64,
}

/// The vertical and the lateral force of the load case `name`, if it is one that the reference can have.
fn check(name: &str, case: &Scenario) -> std::result::Result<[HarmonicForce; 2], InputError> {
    let refuse = |field: InputField, value: String, expected: &str| {
        Err(InputError::new(field, value, expected, "leave it out, or ask without --in-time"))
    };
    if case.suspended_mass <= 0.0 {
        return Err(InputError::new(
            InputField::SuspendedMass,
            "0",
            "more than 0: the reference has the vertical force on a suspended mass",
            "give one, or ask without --in-time",
        ));
    }
    if case.speed != 0.0 {
        return refuse(
            InputField::Speed,
            format!("{} m/s", case.speed),
            "0: the reference's wheel does not roll",
        );
    }
    if case.rail_torsion.is_some() {
        return refuse(
            InputField::RailTorsion,
            "given".into(),
            "none: the reference has no torsion of the rail",
        );
    }
    if !case.rotations_held {
        return Err(InputError::new(
            format!("scenario.{}.rotations_held", name),
            "false",
            "true: the reference's hub does not turn",
            "hold them, or ask without --in-time",
        ));
    }
    if case.start_x.is_some() {
        return refuse(InputField::StartX, "given".into(), "none: the reference has the wheel at midspan");
    }
    let of = |field: InputField, force: &TimeFunction| match force.as_harmonic() {
        Some(harmonic) => Ok(harmonic),
        None => Err(InputError::new(
            field,
            "a sum or a table",
            "a mean and one sine, which the reference has",
            "take another load case (`simulation.scenario`), or ask without --in-time",
        )),
    };
    Ok([
        of(InputField::VerticalForce, &case.vertical_force)?,
        of(InputField::LateralForce, &case.lateral_force)?,
    ])
}
