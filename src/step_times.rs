//! How long a step of the moving solver takes: the published load case, a bridge that other programs were timed on, and rails of more and
//! more elements.
//!
//! The cases take turns on one thread, and of each the run with the least CPU time counts: what else the machine does lengthens a run and never
//! shortens it.

use std::time::Instant;

use railspring_calibrate::beam::{BeamSection, End, RailBeam};
use railspring_calibrate::error::{InputError, Result};
use railspring_calibrate::law::StiffnessLaw;
use railspring_calibrate::monitor::{Monitor, Silent};
use railspring_calibrate::scenario::{HarmonicForce, Kelvin, Scenario};
use railspring_calibrate::step_control::InnerSteps;
use railspring_simulate::moving::{MovingModel, MovingRun, WheelSprings};

use crate::measure::{machine, now_utc, thread_seconds};
use crate::records::{PeerTime, StepTime, StepTimesRecord};
use crate::stages::{self, Geometry};
use crate::study::Study;

/// Names of the cases.
pub const LOAD_CASE: &str = "load case 4.1";
/// The span that other programs were timed on.
pub const BRIDGE: &str = "bridge of 25 m";
/// Rails of elements of a decimetre.
pub const RAIL: &str = "rail";

/// Beam elements of the bridge and of the rails.
const BRIDGES: [usize; 4] = [20, 40, 80, 200];
const RAILS: [usize; 4] = [20, 100, 1000, 10_000];

/// The publication's wheel, kg; it prints no horizontal stiffness, N/m.
const WHEEL_MASS: f64 = 283.0;
const HORIZONTAL: f64 = 6e8;
const GRAVITY: f64 = 9.81;

/// The load case of the study that is section 4.1 of the publication.
const CONSTANT: &str = "constant";

/// A contact element, and how it runs a case.
struct Element {
    name: &'static str,
    run: fn(&MovingModel, &Scenario) -> Result<MovingRun>,
}

const ELEMENTS: [Element; 1] =
    [Element { name: "published", run: |model, scenario| model.run(scenario, &Silent) }];

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
    model: MovingModel,
    scenario: Scenario,
}

/// Times the cases on the profiles of `study`, whose load case `constant` is that of the publication, `repeats` runs each, rails of `most` elements at most.
///
/// # Errors
/// Those of the runs, a study without the load case, and an interruption.
pub fn step_times(
    study: &Study,
    most: usize,
    repeats: usize,
    monitor: &dyn Monitor,
) -> Result<StepTimesRecord> {
    let cases = cases(study, most)?;
    let mut record = StepTimesRecord {
        begun_utc: now_utc(),
        machine: machine(),
        clock: if thread_seconds().is_some() { "CPU time" } else { "wall clock" }.into(),
        repeats,
        times: Vec::new(),
        peers: peers(),
    };
    let mut seconds = vec![vec![Vec::new(); cases.len()]; ELEMENTS.len()];
    let total = repeats * cases.len() * ELEMENTS.len();
    for repeat in 0..repeats {
        for (of_case, case) in cases.iter().enumerate() {
            for (of_element, element) in ELEMENTS.iter().enumerate() {
                let done = (repeat * cases.len() + of_case) * ELEMENTS.len() + of_element;
                monitor.progress("runs", done, total)?;
                let (begun, computed) = (Instant::now(), thread_seconds());
                let run = (element.run)(&case.model, &case.scenario)?;
                let computed = thread_seconds().zip(computed).map(|(after, before)| after - before);
                let of_run = computed.unwrap_or_else(|| begun.elapsed().as_secs_f64());
                let taken = &mut seconds[of_element][of_case];
                taken.push(of_run * 1e6 / case.scenario.steps as f64);
                if repeat + 1 == repeats {
                    record.times.push(time(case, element, &run, taken));
                }
            }
        }
    }
    monitor.progress("runs", total, total)?;
    Ok(record)
}

/// What came of the runs of a case; `microseconds` are those a step of each run.
fn time(case: &Case, element: &Element, run: &MovingRun, microseconds: &mut [f64]) -> StepTime {
    microseconds.sort_by(f64::total_cmp);
    StepTime {
        case: case.name.into(),
        element: element.name.into(),
        elements: case.elements,
        degrees_of_freedom: run.history.degrees_of_freedom,
        steps: case.scenario.steps,
        iterations: run.statistics.iterations as f64 / case.scenario.steps as f64,
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

fn cases(study: &Study, most: usize) -> Result<Vec<Case>> {
    let geometry = stages::geometry(study)?;
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
    let scenario = Scenario { inner_steps: InnerSteps::Equal(1), ..constant.scenario.clone() };
    let beam = geometry.beam.clone();
    let mut cases = vec![Case {
        name: LOAD_CASE,
        elements: beam.elements(),
        model: model(study, &geometry, beam),
        scenario: Scenario { wheel_mass: Some(WHEEL_MASS), ..scenario },
    }];
    for elements in BRIDGES.into_iter().filter(|elements| *elements <= most) {
        let scenario = Scenario {
            speed: 300.0 / 3.6,
            start_x: Some(0.0),
            suspended_mass: 5750.0,
            vertical_suspension: Kelvin { stiffness: 1.595e6, damping: 0.0 },
            ..rolling(1200)
        };
        let mut model = model(study, &geometry, bridge(elements)?);
        settle(&mut model, &scenario);
        cases.push(Case { name: BRIDGE, elements, model, scenario });
    }
    for elements in RAILS.into_iter().filter(|elements| *elements <= most) {
        let beam = geometry.pair.beam(&study.material, 0.1 * elements as f64, elements)?;
        let scenario = Scenario {
            speed: 5.0,
            suspended_mass: 6250.0,
            vertical_suspension: Kelvin { stiffness: 1.2e6, damping: 40e3 },
            ..rolling(600)
        };
        let mut model = model(study, &geometry, beam);
        settle(&mut model, &scenario);
        cases.push(Case { name: RAIL, elements, model, scenario });
    }
    Ok(cases)
}

/// The wheel of the study with the springs of the publication.
fn model(study: &Study, geometry: &Geometry, beam: RailBeam) -> MovingModel {
    let normal = StiffnessLaw::published().into();
    let springs = WheelSprings { horizontal: HORIZONTAL, normal, longitudinal: HORIZONTAL };
    MovingModel::of_pair(&geometry.pair, beam, &study.material, springs, WHEEL_MASS)
}

/// A wheel under its load, in steps of 0.25 ms.
fn rolling(steps: usize) -> Scenario {
    Scenario { gravity: GRAVITY, lateral_force: HarmonicForce::NONE, ..Scenario::new(steps, 2.5e-4, 0.5) }
}

/// The wheel starts where its weight has pressed it.
fn settle(model: &mut MovingModel, scenario: &Scenario) {
    let weight = (model.wheel_mass + scenario.suspended_mass) * GRAVITY;
    model.initial.displacement[1] = model.springs.normal.displacement(weight);
}

/// The bridge of the program VBI-2D: E 3.5e10 Pa, I 1.3901 m⁴, 18358 kg/m, on two supports, stiff against torsion.
fn bridge(elements: usize) -> Result<RailBeam> {
    let (bending, mass) = (3.5e10 * 1.3901, 18_358.0);
    let section = BeamSection {
        axial: 1e12,
        bending_y: bending,
        bending_z: bending,
        shear_y: f64::INFINITY,
        shear_z: f64::INFINITY,
        torsion: 1e12,
        mass,
        rotary_y: 0.0,
        rotary_z: 0.0,
        polar: mass,
        centroid: [0.0; 2],
    };
    RailBeam::new(section, 25.0, elements, 0.0, [End::Pinned; 2])
}
