//! Random load cases: every run ends in a result.

use std::collections::BTreeMap;

use nalgebra::Point2;
use rayon::prelude::*;

use crate::time::function::HarmonicForce;
use crate::time::history::Ending;
use crate::time::scenario::{Kelvin, Scenario};
use crate::time::steps::InnerSteps;
use railspring_calibrate::pair::Pair;
use railspring_profiles::error::Error;
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};

use railspring_element::law::{StripPlace, StripStiffness};
use railspring_element::modulus::StripModulus;
use railspring_element::relief::Influence;

use railspring_testing::Random;

use super::{elastic, published};
use crate::element::condensed::CondensedModel;
use crate::element::published::{InitialMotion, RailSupport};

/// Steps of a run: those of a study, and equal ones.
const KINDS: [InnerSteps; 4] =
    [CondensedModel::STEPS, InnerSteps::Equal(1), InnerSteps::Equal(4), InnerSteps::Equal(16)];

/// A random load case on one of the models.
fn case(random: &mut Random, models: &[CondensedModel]) -> (CondensedModel, Scenario) {
    let mut model = models[(random.bits() % models.len() as u64) as usize].clone();
    // strips alone, or stiffer ones that harden and relieve each other
    let relieving = random.one_of(&[false, true]);
    let normal = 10_f64.powf(if relieving { random.between(11.0, 12.0) } else { random.between(9.5, 11.0) });
    let modulus = StripModulus {
        normal,
        hardening: if relieving { random.between(-0.5, 2.0) } else { 0.0 },
        tangential: normal * random.between(0.2, 1.5),
        relief: random.between(0.6, 1.3),
    };
    let influence = Influence { flexibility: if relieving { 2.8e-12 } else { 0.0 } };
    model.element.strips = StripStiffness::new(vec![StripPlace { rail_s: 0.0, modulus }], influence, 0.0);
    let softer = 10_f64.powf(random.between(-2.0, 0.5));
    model.element.wheel.rest *= softer;
    model.element.head *= random.one_of(&[0.0, 1.0, softer]);
    if random.between(0.0, 1.0) < 0.3 {
        model.element.wheel.modes.clear();
    }
    if random.between(0.0, 1.0) < 0.3 {
        model.support = RailSupport::Rigid;
    }
    model.axle = 10_f64.powf(random.between(4.0, 7.0));
    model.initial = InitialMotion {
        displacement: [random.between(-0.012, 0.006), random.one_of(&[0.0, -1e-4, -5e-3])],
        velocity: [random.between(-0.5, 0.5), random.between(-0.2, 0.5)],
        carried: 0.0,
    };
    let force = |random: &mut Random, low: f64, high: f64| HarmonicForce {
        constant: random.between(low, high),
        amplitude: random.one_of(&[0.0, 1.0]) * random.between(0.0, high),
        frequency: random.between(1.0, 40.0),
        phase: random.between(0.0, 6.3),
    };
    let scenario = Scenario {
        steps: 60,
        friction: random.one_of(&[0.0, 0.1, 0.3, 0.5, 0.8]),
        gravity: random.one_of(&[0.0, 9.81]),
        suspended_mass: random.one_of(&[0.0, 6250.0]),
        vertical_suspension: Kelvin { stiffness: 1.2e6, damping: random.one_of(&[0.0, 4e4]) },
        vertical_force: force(random, -120e3, 120e3).into(),
        lateral_force: force(random, -60e3, 60e3).into(),
        inner_steps: if random.between(0.0, 1.0) < 0.5 { KINDS[0] } else { random.one_of(&KINDS) },
        speed: random.one_of(&[0.0, 1.0, 5.0]),
        rotations_held: random.one_of(&[true, false]),
        ..published()
    };
    (model, scenario)
}

/// Goal: 10,000 random runs (loads, friction up to 0.8, initial motions, stiffnesses, profiles) each end in a
/// result: complete, or off the rail or the profile. There is no error and no value that is not finite. No
/// energy (J) comes of nothing: beyond a hundredth of the largest that is stored with the steps of a study,
/// and beyond the limit of the verdict, 5 %, with sixteenths of 0.5 ms. Accuracy: DISCRETISATION. An impact
/// has an energy error of `(ωh)²/12` of its energy, which the tolerance of the steps keeps below 0.03/12.
#[test]
#[ignore = "half a minute of the processor's time: cargo long random_runs"]
fn random_runs_end_in_a_result() {
    const DRIFT: [f64; 4] = [0.01, f64::INFINITY, f64::INFINITY, 0.05];
    const RUNS: usize = 10_000;
    const CHUNK: usize = 250;
    let mut random = Random::new(41);
    let models: Vec<CondensedModel> = [("60E1", "S1002"), ("54E1", "S1002")]
        .map(|(rail, wheel)| {
            let pair = Pair::new(
                rail_section(rail).unwrap(),
                wheel_section(wheel, 0.920).unwrap(),
                &TrackGeometry::standard(),
            )
            .unwrap();
            let mut model = elastic();
            (model.rail, model.wheel) = (pair.placed.clone(), pair.wheel.running.clone());
            model.tape = Point2::from(pair.tape());
            if let RailSupport::Beam { node_line, .. } = &mut model.support {
                *node_line = pair.node_line();
            }
            model
        })
        .into();
    let mut classes: BTreeMap<String, usize> = BTreeMap::new();
    let mut wrong = Vec::new();
    let (mut halved, mut worst) = (0, [0.0_f64; 4]);
    for chunk in 0..RUNS / CHUNK {
        // drawn one after the other, run on all threads, and counted in their order
        let cases: Vec<_> = (0..CHUNK).map(|_| case(&mut random, &models)).collect();
        let runs: Vec<_> = cases.par_iter().map(|(model, scenario)| model.run(scenario, &Silent)).collect();
        for (n, (run, (_, scenario))) in runs.into_iter().zip(&cases).enumerate() {
            let number = chunk * CHUNK + n;
            let kind = KINDS.iter().position(|steps| *steps == scenario.inner_steps).unwrap();
            let class = match run {
                Ok(run) => {
                    halved += usize::from(run.statistics.halved_steps > 0);
                    let rows = &run.history.rows;
                    let balances: Vec<_> = rows.iter().map(|row| row.energy.unwrap()).collect();
                    let stored = balances.iter().map(|b| b.stored()).fold(0.0, f64::max);
                    let gained = balances.iter().map(|b| b.drift).fold(0.0, f64::max) / stored.max(1.0);
                    let finite = rows.iter().all(|row| {
                        [row.vertical_force, row.lateral_force, row.wheel_y, row.wheel_z]
                            .iter()
                            .all(|v| v.is_finite())
                    });
                    worst[kind] = worst[kind].max(gained);
                    match run.history.ending {
                        _ if !finite => "not finite".to_owned(),
                        _ if gained > DRIFT[kind] => {
                            wrong.push(format!("run {number} gains {gained}"));
                            "energy".to_owned()
                        }
                        Ending::Completed => "completed".to_owned(),
                        Ending::Departed { departure, .. } => format!("{departure:?}"),
                        Ending::EndOfSurface { end, .. } => format!("{end:?}"),
                    }
                }
                Err(Error::Numerics(error)) => {
                    wrong.push(format!("run {number}: {error}"));
                    format!("{:?}", error.reason)
                }
                Err(error) => error.to_string(),
            };
            *classes.entry(class).or_default() += 1;
        }
    }
    println!("{classes:?}, {halved} with halved steps, largest gain of energy {worst:?}");
    println!("{:#?}", &wrong[..wrong.len().min(40)]);
    let results: usize = ["completed", "FieldSide", "GaugeSide", "RailEnd", "RailProfile"]
        .iter()
        .filter_map(|class| classes.get(*class))
        .sum();
    assert_eq!(results, RUNS, "{classes:?}");
}
