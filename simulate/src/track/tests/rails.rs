//! Both rails of a track against the linear parts of one plane.

use nalgebra::{Point2, Vector3};

use super::super::rails::{RailsDynamics, RailsLoad, RailsState};
use super::*;
use crate::element::published::{RailLoad, RailSupport};
use crate::time::linear_part::{LinearPart, LinearStep};
use crate::time::newmark::Newmark;
use railspring_calibrate::beam::{End, RailBeam};

/// ROUNDOFF of other orders of sums over 30 steps, of the largest displacement: accelerations are differences of displacements over the square of the step.
const ROUNDOFF: f64 = 1e-8;

fn moving(step: usize) -> ([Vector3<f64>; 2], f64) {
    let t = step as f64;
    let right = Vector3::new(9e3 * (0.3 * t).sin(), -60e3 - 2e3 * t, 300.0 * (0.2 * t).cos());
    let left = Vector3::new(-4e3, -20e3 * (0.1 * t).cos(), -90.0 * t);
    ([right, left], 0.9 + 0.013 * t)
}

fn two(rail: Track, angle: f64) -> TwoRails {
    TwoRails {
        rail,
        angle,
        bed: None,
        bed_below_line: 0.0,
        twist_bed: None,
        held: Vec::new(),
        layers: Vec::new(),
    }
}

/// Source: the rail of one plane. Goal: displacement (m) of both rails at the wheel and without its forces, vertically, on sleepers and a bed with dampers under a moving ground. Accuracy: ROUNDOFF.
#[test]
fn vertically_they_are_the_rail_of_one_plane() {
    let mut track = on_sleepers(20, 0.3);
    track.bed = Some(kelvin(3e6, 2e3));
    track.rail.mass_damping = 2.0;
    let held = Some(kelvin(1e8, 0.0));
    let rails = TwoRails { bed: held, twist_bed: held, ..two(track.clone(), 0.0) };
    let dynamics = RailsDynamics::new(&rails);
    let plain = TrackDynamics::<2>::new(&track);
    let scheme = Newmark::new(2e-4, 0.0);
    let (steps, plain_steps) = (dynamics.over(scheme).unwrap(), plain.over(scheme).unwrap());
    let mut both = dynamics.unloaded();
    let mut single = [plain.at_rest(1.0, 0.0).unwrap(), plain.at_rest(1.0, 0.0).unwrap()];
    let mut largest = 0.0_f64;
    for step in 0..30 {
        let (forces, x) = moving(step);
        let load = RailsLoad { x, ground: [0.0, 1.5], twisting: &[] };
        let mut next = RailsState::default();
        let of_both = dynamics.predict(&steps, &both, &load, &mut next);
        for (side, single) in single.iter_mut().enumerate() {
            let mut after = TrackState::default();
            let of_one = plain_steps.predict(single, &TrackLoad { x, ground: 1.5 }, &mut after);
            let (free, flexibility) = (of_one.free()[0], of_one.flexibility()[(0, 0)]);
            largest = largest.max(free.abs());
            assert!((free + of_both.free[side].y).abs() <= ROUNDOFF * largest, "{step}: {free}");
            assert!((flexibility / of_both.flexibility[(1, 1)] - 1.0).abs() < ROUNDOFF);
            of_one.finish(&[-forces[side].y]);
            *single = after;
        }
        dynamics.finish(&steps, &of_both, &mut next, &forces);
        both = next;
        for (side, single) in single.iter().enumerate() {
            let (expected, found) = (plain.deflection(single, 1.3), -dynamics.at_wheels(&both, 1.3)[side].y);
            largest = largest.max(expected.abs());
            assert!((expected - found).abs() < ROUNDOFF * largest, "{step} {side}: {found} {expected}");
        }
    }
    assert!(largest > 1e-4, "{largest}");
    let rested = dynamics.at_rest(1.3, &[Vector3::new(0.0, -5e4, 0.0), Vector3::zeros()], &[]).unwrap();
    let expected = plain.deflection(&plain.at_rest(1.3, 5e4).unwrap(), 1.3);
    assert!((expected + dynamics.at_wheels(&rested, 1.3)[0].y).abs() < ROUNDOFF * expected);
}

/// Source: the rail of the profile contacts, fixed at both ends, inclined, its centroid above the node line. Goal: displacement (m) and twist (rad) at the wheel, without and with its forces, and the flexibility, in all three directions of
/// both rails; at rest as well. Accuracy: ROUNDOFF.
#[test]
fn across_they_are_the_rail_of_the_profile_contacts() {
    let mut section = slender(6.38e6, 60.2);
    (section.bending_y, section.torsion, section.polar) = (1.07e6, 1.76e5, 0.279);
    (section.shear_y, section.shear_z, section.rotary_y, section.rotary_z) = (3.3e8, 2.43e8, 0.04, 0.2385);
    section.centroid = [0.0, -0.034];
    let (length, elements, angle, damping) = (3.0, 12, -0.025, 3e-6);
    let beam = RailBeam::new(section, length, elements, angle, [End::Fixed; 2]).unwrap();
    let flexibility = beam.section_flexibility(1.1);
    let support = RailSupport::Beam { beam, node_line: Point2::origin(), damping };
    let mut track = on_two_supports(section, length, elements);
    track.rail.damping = damping;
    let both_ends = [0, elements];
    track.held.extend(both_ends.map(|node| Held { of: Carrier::Rail, node, direction: Direction::Rotation }));
    let all = [Across::Lateral, Across::Turn, Across::Twist];
    let held = both_ends.iter().flat_map(|node| all.map(|which| (*node, which))).collect();
    let rails = TwoRails { held, ..two(track, angle) };
    let dynamics = RailsDynamics::new(&rails);
    let plain = support.dynamics().unwrap();
    let scheme = Newmark::new(1e-4, 0.0);
    let (steps, plain_steps) = (dynamics.over(scheme).unwrap(), plain.over(&scheme).unwrap());
    let mut both = dynamics.unloaded();
    let rest = || plain.start(&RailLoad { x: 1.0, torsion: 0.0 }, Vector3::zeros()).unwrap();
    let mut single = [rest(), rest()];
    let mut largest = Vector3::<f64>::zeros();
    for step in 0..30 {
        let (forces, x) = moving(step);
        let mut next = RailsState::default();
        let of_both =
            dynamics.predict(&steps, &both, &RailsLoad { x, ground: [0.0; 2], twisting: &[] }, &mut next);
        for (side, single) in single.iter_mut().enumerate() {
            let mut after = Default::default();
            let of_one = plain_steps.predict(single, &RailLoad { x, torsion: 0.0 }, &mut after);
            for i in 0..3 {
                let free = of_one.free()[i];
                largest[i] = largest[i].max(free.abs());
                assert!((free - of_both.free[side][i]).abs() <= ROUNDOFF * largest[i], "{step} {i}: {free}");
                for j in 0..3 {
                    let scale = (of_one.flexibility()[(i, i)] * of_one.flexibility()[(j, j)]).sqrt();
                    let off = of_one.flexibility()[(i, j)] - of_both.flexibility[(i, j)];
                    assert!(off.abs() < ROUNDOFF * scale, "{step} {i} {j}");
                }
            }
            of_one.finish(forces[side].as_slice());
            *single = after;
        }
        dynamics.finish(&steps, &of_both, &mut next, &forces);
        both = next;
    }
    assert!(largest.iter().all(|largest| *largest > 1e-5), "{largest}");
    // at rest; direction 2 is up and direction 3 turns back
    let found = dynamics.flexibility(1.1).unwrap();
    let signs = [1.0, -1.0, -1.0];
    for i in 0..3 {
        for j in 0..3 {
            let expected = signs[i] * signs[j] * flexibility[(i, j)];
            let scale = (flexibility[(i, i)] * flexibility[(j, j)]).sqrt();
            assert!((found[(i, j)] - expected).abs() < 1e-6 * scale, "{i} {j}: {found} {flexibility}");
        }
    }
}

/// Source: statics of a rail on springs alone that hold it laterally and against twist, far apart from each other against the bending length: sums of forces. Goal: a lateral force (N) at a height above the foot is carried by the lateral springs, its moment (N·m) about
/// their height by those against twist; the ground's acceleration presses a mass times itself into them. SOLVER: a stiff short rail.
#[test]
fn supports_across_carry_forces_and_moments() {
    const SOLVER: f64 = 1e-3;
    let mut section = slender(1e10, 60.0);
    section.torsion = 1e10;
    let mut track = on_two_supports(section, 1.0, 4);
    track.held.clear();
    track.bed = Some(kelvin(1e8, 0.0));
    let (lateral, twist, below) = (2e7, 3e5, 0.08);
    let at = |x: f64| {
        [
            LayersAcross {
                x,
                direction: Across::Lateral,
                below_line: below,
                upper: kelvin(lateral, 0.0),
                below: None,
            },
            LayersAcross {
                x,
                direction: Across::Twist,
                below_line: 0.0,
                upper: kelvin(twist, 0.0),
                below: None,
            },
        ]
    };
    let rails = TwoRails { layers: [at(0.25), at(0.75)].concat(), ..two(track, 0.0) };
    let dynamics = RailsDynamics::new(&rails);
    let (force, moment) = (10e3, 500.0);
    // direction 3 turns the head to the gauge side
    let forces = [Vector3::new(force, 0.0, -moment), Vector3::zeros()];
    let state = dynamics.at_rest(0.5, &forces, &[]).unwrap();
    let seen = dynamics.seen(&state, 0, 0.5);
    // the foot has the force, and the node line that of the foot with the moment of its lever
    let turned = (moment + force * below) / (2.0 * twist);
    let aside = force / (2.0 * lateral) + below * turned;
    assert!((seen.displacement[2] / turned - 1.0).abs() < SOLVER, "{seen:?} {turned}");
    assert!((seen.displacement[0] / aside - 1.0).abs() < SOLVER, "{seen:?} {aside}");
    assert_eq!(dynamics.seen(&state, 1, 0.5).displacement, [0.0; 3]);
    // a ground that is accelerated to the right presses the right rail to its gauge side, and the left one to its field side
    let mut still = dynamics.unloaded();
    dynamics
        .accelerate(
            &mut still,
            &RailsLoad { x: 0.5, ground: [2.0, 0.0], twisting: &[] },
            &[Vector3::zeros(); 2],
        )
        .unwrap();
    for (side, sign) in [(0, -1.0), (1, 1.0)] {
        let seen = dynamics.seen(&still, side, 0.5);
        assert!((seen.acceleration[0] - sign * 2.0).abs() < 1e-9, "{seen:?}");
    }
    let none = TwoRails { layers: Vec::new(), ..rails.clone() };
    assert!(RailsDynamics::new(&none).flexibility(0.5).is_none());
}
