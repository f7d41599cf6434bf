//! The head of a rail between held ends: its flexibility everywhere, and the energy of a wheel that rolls over it.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::time::function::{HarmonicForce, TimeFunction};
use crate::time::scenario::Scenario;
use crate::time::steps::InnerSteps;
use railspring_calibrate::beam::{BeamCorrection, HeldRail, RailBeam};
use railspring_calibrate::pair::Pair;
use railspring_calibrate::solid::Material;
use railspring_element::held_end::{EndPlace, HeldEnd, in_world};
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};

use super::super::CondensedModel;
use super::super::head::between_held_ends;
use super::elastic;
use railspring_element::head::HeadAt;

const LENGTH: f64 = 0.555;

/// The head of 60E1 near an end, in round numbers of its size.
fn end() -> HeldEnd {
    let place = |(distance, part): (f64, f64)| EndPlace {
        distance,
        flexibility: Matrix3::new(5.8e-9, -1e-10, -5.3e-8, -1e-10, 2e-11, 9e-10, -5.3e-8, 9e-10, 5.1e-7)
            * part,
        twist: Vector3::new(5e-9, -1e-10, -2e-8) * part,
    };
    let places = [(0.04, 0.4), (0.06, 0.55), (0.09, 0.7), (0.12, 0.85), (0.18, 0.97), (0.25, 1.0)];
    HeldEnd { inset: 0.035, places: places.map(place).to_vec() }
}

fn beam(length: f64) -> (Pair, RailBeam) {
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.858).unwrap());
    let pair = Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap();
    let correction = BeamCorrection { shear_y: 1.12, shear_z: 1.32, torsion: 1.06 };
    let beam = pair.beam(&Material::STEEL, length, 20).unwrap().corrected(&correction).unwrap();
    (pair, beam)
}

/// Source: its parts, a rail with held ends and the head at a distance from them. Goal: the head on its beam
/// is as flexible (m/N and rad/(N·m)) as a held rail with the head on it. Rails are 0.3, 0.555 and 30 m long,
/// places in the middle and 40 mm from the end. It stores no negative energy, ROUNDOFF of the largest apart.
/// A place and its mirror image are the same, and nothing moves at the ends. Its slope does not jump: from
/// one tenth of a millimetre to the next it changes by less than 1e-4 of the largest value. Accuracy:
/// INTERPOLATION over places 2.5 mm apart, a hundredth of the largest.
#[test]
fn the_head_is_that_of_a_held_rail_near_the_ends() {
    const INTERPOLATION: f64 = 1e-2;
    const ROUNDOFF: f64 = 1e-12;
    const LEVER: f64 = 0.1;
    let scale = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, LEVER));
    for length in [0.3, LENGTH, 30.0] {
        let (pair, beam) = beam(length);
        let rail = HeldRail::new(&pair.properties, &Material::STEEL, length, end().inset);
        let head = between_held_ends(&beam, &rail, &end());
        let of_beam = |x: f64| in_world(beam.angle(), beam.at_place(x));
        let whole = |x: f64| {
            let HeadAt { share, flexibility, .. } = head.at(x);
            share * of_beam(x) * share.transpose() + flexibility
        };
        let half = 0.5 * length;
        let held = |x: f64| in_world(beam.angle(), rail.flexibility(x));
        let [first, last] = [&end().places[0], end().places.last().unwrap()].map(|place| place.flexibility);
        let largest = (scale * (last + held(half)) * scale).amax();
        let off =
            |found: Matrix3<f64>, exact: Matrix3<f64>| (scale * (found - exact) * scale).amax() / largest;
        if half > end().places.last().unwrap().distance {
            let [middle, near] = [off(whole(half), held(half) + last), off(whole(0.04), held(0.04) + first)];
            assert!(middle.max(near) < INTERPOLATION, "{length}: {middle} {near}");
        }
        for step in 0..=2000 {
            let x = length * f64::from(step) / 2000.0;
            let at = head.at(x);
            let least = SymmetricEigen::new(scale * at.flexibility * scale).eigenvalues.min();
            assert!(least > -ROUNDOFF * largest, "{length} {x}: {least:e} of {largest:e}");
            let mirrored = head.at(length - x);
            assert!((at.flexibility - mirrored.flexibility).amax() < 1e-9 * at.flexibility.amax().max(1e-12));
            assert!((0.0..=1.0 + 1e-3).contains(&at.share[(2, 2)]), "{length} {x}: {}", at.share);
        }
        assert_eq!(
            (head.at(0.0).flexibility, head.at(length).flexibility),
            (Matrix3::zeros(), Matrix3::zeros())
        );
        let step = 1e-4;
        for n in 1..1000 {
            let x = half * f64::from(n) / 1000.0;
            let [a, b, c] = [x - step, x, x + step].map(|x| scale * head.at(x).flexibility * scale);
            let kink = (a - b * 2.0 + c).amax();
            assert!(kink < 1e-4 * largest, "{length} {x}: {kink:e} of {largest:e}");
        }
    }
}

/// Source: the law of energy. Goal: a wheel without damping and friction that rolls over half a metre of rail with held ends at 20 m/s, under a load and under a torsion of the rail at its middle, neither gains
/// nor loses energy (J). Accuracy: DRIFT over what is stored, that of the contact's average acceleration in sixteenths of a step, 0.1 %.
#[test]
fn a_wheel_that_rolls_over_held_ends_keeps_its_energy() {
    const DRIFT: f64 = 1e-3;
    let (pair, beam) = beam(LENGTH);
    let mut element = elastic().element;
    element.held_end = Some(end());
    let mut model = CondensedModel::of_pair(&pair, beam, [&Material::STEEL; 2], element);
    model.damping = 0.0;
    let scenario = Scenario {
        friction: 0.0,
        start_x: Some(0.03),
        speed: 20.0,
        inner_steps: InnerSteps::Equal(16),
        vertical_force: TimeFunction::constant(60e3),
        rail_torsion: Some(
            HarmonicForce { constant: 0.0, amplitude: 20e3, frequency: 40.0, phase: 0.0 }.into(),
        ),
        ..Scenario::new(98, 2.5e-4, 0.0)
    };
    model.initial.displacement[1] =
        model.pressed_at(0.03, nalgebra::Vector2::y(), 60e3, 0.0).unwrap().displacement;
    model.initial.carried = 60e3;
    let run = model.run(&scenario, &Silent).unwrap();
    assert_eq!(run.history.rows.len(), 99);
    let stored = run.history.rows.iter().map(|row| row.energy.unwrap().elastic).fold(0.0, f64::max);
    let drift = run.history.rows.iter().map(|row| row.energy.unwrap().drift.abs()).fold(0.0, f64::max);
    println!("{drift:e} of {stored:e}");
    assert!(drift < DRIFT * stored, "{drift:e} of {stored:e}");
}
