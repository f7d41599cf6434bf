//! How long a step of the moving solver takes: the published load case, a bridge, and rails of more and more elements; and how long other programs take for the same.
//!
//! The cases take turns on one thread, with the other programs between them, and of each the run with the least CPU time counts: what else the machine does lengthens a run and never
//! shortens it.

mod clock;
mod record;
mod peers;
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
use record::{BRIDGE, HOSTED, HOSTED_STEPS, PeerTime, StepTime};

pub use peers::{Peer, Peers, prepared};
pub use record::StepTimesRecord;

/// Names of the cases.
const LOAD_CASE: &str = "load case 4.1";
/// The same with the steps of the integration that a study has.
const AS_IN_STUDIES: &str = "4.1 as in a study";
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

/// A model with what happens to it.
struct Case {
    name: &'static str,
    elements: usize,
    model: Model,
    scenario: Scenario,
    /// Steps whose time is taken.
    steps: usize,
}

/// Times the cases on the profiles of `study`, whose load case `constant` is that of the publication, `repeats` runs each, rails of `most` elements at most: with the published
/// element, and with a condensed one where that is given; `others` run as many times.
///
/// # Errors
/// Those of the runs, a study without the load case, and an interruption.
pub fn step_times(
    study: &Study,
    element: Option<&PairElement>,
    others: &[Peer],
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
        peers: Vec::new(),
    };
    let others: Vec<&Peer> = others.iter().filter(|peer| peer.elements <= most).collect();
    let mut seconds = vec![Vec::new(); cases.len()];
    let mut of_others = vec![Vec::new(); others.len()];
    let (round, mut done) = (cases.len() + others.len(), 0..);
    let mut next = || monitor.progress("runs", done.next().unwrap_or(0), repeats * round);
    for repeat in 0..repeats {
        for (n, case) in cases.iter().enumerate() {
            next()?;
            let (begun, computed) = (Instant::now(), thread_seconds());
            let run = case.model.run(&case.scenario)?;
            let computed = thread_seconds().zip(computed).map(|(after, before)| after - before);
            let of_run = computed.unwrap_or_else(|| begun.elapsed().as_secs_f64());
            seconds[n].push(of_run * 1e6 / case.steps as f64);
            if repeat + 1 == repeats {
                record.times.push(time(case, &run, &mut seconds[n]));
            }
        }
        for (times, peer) in of_others.iter_mut().zip(&others) {
            next()?;
            times.push(peer.microseconds()?);
        }
    }
    next()?;
    record.peers.extend(others.into_iter().zip(&mut of_others).map(|(peer, times)| {
        let [microseconds, median_microseconds, longest_microseconds] = spread(times);
        PeerTime {
            case: peer.case.into(),
            program: peer.program.into(),
            elements: peer.elements,
            microseconds,
            median_microseconds,
            longest_microseconds,
        }
    }));
    Ok(record)
}

/// Shortest, median and longest of times.
fn spread(times: &mut [f64]) -> [f64; 3] {
    times.sort_by(f64::total_cmp);
    [0, times.len() / 2, times.len() - 1].map(|n| times[n])
}

/// What came of the runs of a case; `microseconds` are those a step of each run.
fn time(case: &Case, run: &MovingRun, microseconds: &mut [f64]) -> StepTime {
    let [microseconds, median_microseconds, longest_microseconds] = spread(microseconds);
    StepTime {
        case: case.name.into(),
        element: case.model.element().name().into(),
        elements: case.elements,
        steps: case.steps,
        degrees_of_freedom: run.history.degrees_of_freedom,
        inner_steps: run.statistics.steps as f64 / case.steps as f64,
        iterations: run.statistics.iterations as f64 / run.statistics.steps as f64,
        microseconds,
        median_microseconds,
        longest_microseconds,
    }
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
    for name in [LOAD_CASE, AS_IN_STUDIES, HOSTED] {
        // a host has the condensed element alone
        let models = models(study, &geometry, &beam, element).into_iter();
        for model in models.filter(|model| name != HOSTED || matches!(model, Model::Condensed(_))) {
            let (inner_steps, of_each) = match name {
                AS_IN_STUDIES => (study.simulation.steps(model.element()), 1),
                HOSTED => (InnerSteps::Equal(HOSTED_STEPS), HOSTED_STEPS),
                _ => (InnerSteps::Equal(1), 1),
            };
            let scenario =
                Scenario { inner_steps, wheel_mass: Some(WHEEL_MASS), ..constant.scenario.clone() };
            let steps = of_each * scenario.steps;
            cases.push(Case { name, elements: beam.elements(), model, scenario, steps });
        }
    }
    let mut add = |name, elements, beam: &RailBeam, scenario: Scenario| -> Result<()> {
        for mut model in models(study, &geometry, beam, element) {
            model.settle(&scenario)?;
            let scenario = Scenario { wheel_mass: Some(WHEEL_MASS), ..scenario.clone() };
            let steps = scenario.steps;
            cases.push(Case { name, elements, model, scenario, steps });
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
