//! How long a step of the moving solver takes: the published load case, a bridge that other programs were timed on, and rails of more and
//! more elements.
//!
//! The cases take turns on one thread, and of each the run with the least CPU time counts: what else the machine does lengthens a run and never
//! shortens it.

mod clock;
mod record;
pub mod figure;

use std::time::Instant;

use clock::thread_seconds;
use nalgebra::Vector2;
use railspring::engine::measure::{machine, now_utc};
use railspring::results::bodies::geometry::{self, Geometry};
use railspring::study::{ContactElementKey, Study};
use railspring_calibrate::beam::RailBeam;
use railspring_calibrate::law::StiffnessLaw;
use railspring_element::pair_element::PairElement;
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::monitor::{Monitor, Silent};
use railspring_simulate::cases::{self, GRAVITY};
use railspring_simulate::element::condensed::CondensedModel;
use railspring_simulate::element::published::{MovingModel, MovingRun, WheelSprings};
use railspring_simulate::time::scenario::Scenario;
use railspring_simulate::time::steps::InnerSteps;
use record::{PeerTime, StepTime};

pub use record::StepTimesRecord;

/// Names of the cases.
const LOAD_CASE: &str = "load case 4.1";
/// The same with the steps of the integration that a study has.
const AS_IN_STUDIES: &str = "4.1 as in a study";
/// The span that other programs were timed on.
const BRIDGE: &str = "bridge of 25 m";
/// Rails of elements of a decimetre.
const RAIL: &str = "rail";

/// Beam elements of the bridge and of the rails.
const BRIDGES: [usize; 4] = [20, 40, 80, 200];
const RAILS: [usize; 4] = [20, 100, 1000, 10_000];

/// The publication's wheel, kg; it prints no horizontal stiffness, N/m.
const WHEEL_MASS: f64 = 283.0;
const HORIZONTAL: f64 = 6e8;

/// The load case of the study that is section 4.1 of the publication.
const CONSTANT: &str = "constant";

/// The wheel with one of the contact elements.
enum Model {
    Published(Box<MovingModel>),
    Condensed(Box<CondensedModel>),
}

impl Model {
    fn element(&self) -> ContactElementKey {
        match self {
            Self::Published(_) => ContactElementKey::Published,
            Self::Condensed(_) => ContactElementKey::Condensed,
        }
    }

    fn run(&self, scenario: &Scenario) -> Result<MovingRun> {
        match self {
            Self::Published(model) => model.run(scenario, &Silent),
            Self::Condensed(model) => model.run(scenario, &Silent),
        }
    }

    /// The wheel starts in balance, where its weight and what it carries have pressed it.
    fn settle(&mut self, scenario: &Scenario) -> Result<()> {
        let carried = (WHEEL_MASS + scenario.suspended_mass) * GRAVITY;
        let (initial, pressed) = match self {
            Self::Published(model) => {
                let pressed = model.springs.normal.displacement(carried);
                (&mut model.initial, pressed)
            }
            Self::Condensed(model) => {
                let pressed = model.pressed(Vector2::y(), carried, scenario.friction)?;
                (&mut model.initial, pressed.displacement)
            }
        };
        (initial.displacement[1], initial.carried) = (pressed, carried);
        Ok(())
    }
}

/// Times of other programs: OpenSees, CPU time a step on two cores with other work beside.
const PEERS: [(&str, usize, [f64; 2]); 6] = [
    ("OpenSees WheelRail, 2D, no friction", 20, [302.0, 329.0]),
    ("OpenSees WheelRail, 2D, no friction", 40, [854.0, 1106.0]),
    ("OpenSees WheelRail, 2D, no friction", 80, [3666.0, 4385.0]),
    ("OpenSees 3D beams, contact spring, lumped mass", 20, [360.0, 360.0]),
    ("OpenSees 3D beams, contact spring", 20, [1228.0, 1255.0]),
    ("OpenSees 3D beams, contact spring", 200, [13_200.0, 13_200.0]),
];

/// How the times of other programs were made.
pub const PEERS_MADE: &str =
    "OpenSees: measured earlier on two shared cores, CPU time a step, not in this run";

/// A model with what happens to it.
struct Case {
    name: &'static str,
    elements: usize,
    model: Model,
    scenario: Scenario,
}

/// Times the cases on the profiles of `study`, whose load case `constant` is that of the publication, `repeats` runs each, rails of `most` elements at most: with the published
/// element, and with a condensed one where that is given.
///
/// # Errors
/// Those of the runs, a study without the load case, and an interruption.
pub fn step_times(
    study: &Study,
    element: Option<&PairElement>,
    most: usize,
    repeats: usize,
    monitor: &dyn Monitor,
) -> Result<StepTimesRecord> {
    let cases = cases(study, element, most)?;
    let mut record = StepTimesRecord {
        begun_utc: now_utc(),
        machine: machine(),
        clock: if thread_seconds().is_some() { "CPU time" } else { "wall clock" }.into(),
        repeats,
        times: Vec::new(),
        peers: peers(),
    };
    let mut seconds = vec![Vec::new(); cases.len()];
    let total = repeats * cases.len();
    for repeat in 0..repeats {
        for (n, case) in cases.iter().enumerate() {
            monitor.progress("runs", repeat * cases.len() + n, total)?;
            let (begun, computed) = (Instant::now(), thread_seconds());
            let run = case.model.run(&case.scenario)?;
            let computed = thread_seconds().zip(computed).map(|(after, before)| after - before);
            let of_run = computed.unwrap_or_else(|| begun.elapsed().as_secs_f64());
            seconds[n].push(of_run * 1e6 / case.scenario.steps as f64);
            if repeat + 1 == repeats {
                record.times.push(time(case, &run, &mut seconds[n]));
            }
        }
    }
    monitor.progress("runs", total, total)?;
    Ok(record)
}

/// What came of the runs of a case; `microseconds` are those a step of each run.
fn time(case: &Case, run: &MovingRun, microseconds: &mut [f64]) -> StepTime {
    microseconds.sort_by(f64::total_cmp);
    StepTime {
        case: case.name.into(),
        element: case.model.element().name().into(),
        elements: case.elements,
        steps: case.scenario.steps,
        degrees_of_freedom: run.history.degrees_of_freedom,
        inner_steps: run.statistics.steps as f64 / case.scenario.steps as f64,
        iterations: run.statistics.iterations as f64 / run.statistics.steps as f64,
        microseconds: microseconds[0],
        median_microseconds: microseconds[microseconds.len() / 2],
        longest_microseconds: microseconds[microseconds.len() - 1],
    }
}

fn peers() -> Vec<PeerTime> {
    let of =
        |&(program, elements, [least_microseconds, most_microseconds]): &(&str, usize, [f64; 2])| PeerTime {
            case: BRIDGE.into(),
            program: program.into(),
            elements,
            least_microseconds,
            most_microseconds,
        };
    PEERS.iter().map(of).collect()
}

fn cases(study: &Study, element: Option<&PairElement>, most: usize) -> Result<Vec<Case>> {
    let geometry = geometry::geometry(study.statics())?;
    let Some(constant) = study.scenarios.get(CONSTANT) else {
        let remedy = "name another study, or none, with --study";
        return Err(InputError::new(
            "--study",
            &study.name,
            format!("a load case [scenario.{CONSTANT}]"),
            remedy,
        )
        .into());
    };
    let beam = geometry.beam.clone();
    let mut cases = Vec::new();
    for name in [LOAD_CASE, AS_IN_STUDIES] {
        for model in models(study, &geometry, &beam, element) {
            let inner_steps = match name {
                AS_IN_STUDIES => study.simulation.steps(model.element()),
                _ => InnerSteps::Equal(1),
            };
            let scenario =
                Scenario { inner_steps, wheel_mass: Some(WHEEL_MASS), ..constant.scenario.clone() };
            cases.push(Case { name, elements: beam.elements(), model, scenario });
        }
    }
    let mut add = |name, elements, beam: &RailBeam, scenario: Scenario| -> Result<()> {
        for mut model in models(study, &geometry, beam, element) {
            model.settle(&scenario)?;
            let scenario = Scenario { wheel_mass: Some(WHEEL_MASS), ..scenario.clone() };
            cases.push(Case { name, elements, model, scenario });
        }
        Ok(())
    };
    for elements in BRIDGES.into_iter().filter(|elements| *elements <= most) {
        add(BRIDGE, elements, &cases::bridge(elements)?, cases::crossing())?;
    }
    for elements in RAILS.into_iter().filter(|elements| *elements <= most) {
        let beam = geometry.pair.beam(&study.rail.material, 0.1 * elements as f64, elements)?;
        add(RAIL, elements, &beam, cases::rolling())?;
    }
    Ok(cases)
}

/// The wheel of the study on a rail: with the springs of the publication, and with a condensed element if there is one.
fn models(study: &Study, geometry: &Geometry, beam: &RailBeam, element: Option<&PairElement>) -> Vec<Model> {
    let normal = StiffnessLaw::published().into();
    let springs = WheelSprings { horizontal: HORIZONTAL, normal, longitudinal: HORIZONTAL };
    let damped = study.statics().materials().map(|own| own.damped(study.damping));
    let (pair, materials) = (&geometry.pair, damped.each_ref());
    let published = MovingModel::of_pair(pair, beam.clone(), materials, springs, WHEEL_MASS);
    let condensed = element.map(|element| {
        let model = CondensedModel::of_pair(pair, beam.clone(), materials, element.clone());
        Model::Condensed(Box::new(model))
    });
    [Model::Published(Box::new(published))].into_iter().chain(condensed).collect()
}
