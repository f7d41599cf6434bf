//! The track as a linear part.

use super::*;
use crate::time::linear_part::conformance::Trial;
use crate::time::newmark::Newmark;

/// Condition of the equations times rounding: stiffness and inertia of a step differ by up to 1e4.
const ROUNDOFF: f64 = 1e-10;

fn trial<const N: usize>(track: &Track, x: f64) {
    let dynamics = TrackDynamics::<N>::new(track);
    let steps = dynamics.over(Newmark::new(1e-4, 0.0)).unwrap();
    let load = |ground: f64| TrackLoad { x, ground };
    let trial = Trial {
        part: &steps,
        rest: dynamics.at_rest(x, 0.0).unwrap(),
        loads: [load(2.0), load(-0.5), load(1.5)],
        force: 5e4,
        displacement: &|state| vec![dynamics.deflection(state, x)],
        numbers: &|state| state.numbers(),
    };
    let found = trial.deviations();
    assert!(found.largest() < ROUNDOFF, "{x}: {found:?}");
}

/// Goal: the rules of a linear part, under an accelerated ground. Rails are one on sleepers and a bed, one
/// held at a node in the middle and at both ends, and one on a bridge. The wheel is at nodes, inside of
/// elements, over a support and at the last end.
#[test]
fn a_track_keeps_the_rules_of_a_linear_part() {
    let mut sleepers = on_sleepers(12, 0.3);
    sleepers.bed = Some(kelvin(4e6, 1e3));
    sleepers.rail.mass_damping = 3.0;
    let mut held = on_two_supports(slender(6.38e6, 60.2), 3.6, 12);
    held.held.push(Held { of: Carrier::Rail, node: 6, direction: Direction::Vertical });
    held.held.push(Held { of: Carrier::Rail, node: 12, direction: Direction::Rotation });
    for x in [0.0, 0.1, 1.8, 1.9, 3.3, 3.6] {
        trial::<2>(&sleepers, x);
        trial::<2>(&held, x);
        trial::<4>(&bridge::on_a_bridge(12, 0.3, 1e8), x);
    }
}

/// Source: dense equations of a rail with a sleeper in the middle of an element, its mass not eliminated. Goal: the static deflection (m) under a force, and the
/// frequency of free motion by the energy of a mode is not needed: a step of the dense equations gives the same acceleration (m/s²). Accuracy: ROUNDOFF.
#[test]
fn a_sleeper_between_nodes_is_a_mass_on_two_layers() {
    use nalgebra::{DMatrix, DVector};
    let mut track = on_two_supports(slender(1e6, 60.0), 1.0, 1);
    let (pad, ballast, mass) = (kelvin(3e7, 2e3), kelvin(1e7, 4e3), 120.0);
    track.layers.push(Layers {
        of: Carrier::Rail,
        x: 0.4,
        direction: Direction::Vertical,
        upper: pad,
        below: Some((mass, ballast)),
        onto: Onto::Ground,
    });
    let dynamics = TrackDynamics::<2>::new(&track);
    // both rotations and the sleeper
    let section = track.rail.section;
    let row = super::super::structure::deflection(&section, 1.0, 0.4);
    let row = DVector::from_vec(vec![row[1], row[3], 0.0]);
    let sleeper = DVector::from_vec(vec![0.0, 0.0, 1.0]);
    let stretched = &row - &sleeper;
    let of = |pad: f64, ballast: f64| {
        &stretched * stretched.transpose() * pad + &sleeper * sleeper.transpose() * ballast
    };
    let [k, m] = super::super::structure::matrices(&section, 1.0);
    let dense = |matrix: [[f64; 4]; 4]| {
        DMatrix::from_fn(3, 3, |i, j| if i < 2 && j < 2 { matrix[[1, 3][i]][[1, 3][j]] } else { 0.0 })
    };
    let stiffness = dense(k) + of(pad.stiffness, ballast.stiffness);
    let damping = of(pad.damping, ballast.damping);
    let mut inertia = dense(m);
    inertia[(2, 2)] = mass;
    let under = super::super::structure::deflection(&section, 1.0, 0.7);
    let force = DVector::from_vec(vec![under[1], under[3], 0.0]) * 1e4;
    let still = stiffness.clone().lu().solve(&force).unwrap();
    let rest = dynamics.at_rest(0.7, 1e4).unwrap();
    let found = dynamics.deflection(&rest, 0.4);
    let expected = row.dot(&still);
    assert!((found - expected).abs() < ROUNDOFF * expected.abs(), "{found} {expected}");
    // a step under half the force
    let scheme = Newmark::new(1e-3, 0.0);
    let gains = [1.0 / scheme.acceleration, scheme.velocity / scheme.acceleration];
    let mut start = rest.clone();
    dynamics.accelerate(&mut start, &TrackLoad { x: 0.7, ground: 0.0 }, 5e3).unwrap();
    let dense_start = inertia.clone().lu().solve(&(&force * 0.5 - &stiffness * &still)).unwrap();
    let predicted = |a: &DVector<f64>| {
        let u = &still + a * (0.25 * 1e-6);
        let v = a * 0.5e-3;
        (u, v)
    };
    let (u, v) = predicted(&dense_start);
    let matrix = &inertia + &stiffness * gains[0] + &damping * gains[1];
    let a = matrix.lu().solve(&(&force * 0.5 - &stiffness * &u - &damping * &v)).unwrap();
    let expected = row.dot(&(&u + &a * gains[0]));
    use crate::time::linear_part::LinearPart;
    let steps = dynamics.over(scheme).unwrap();
    let next = steps.advance(&start, &TrackLoad { x: 0.7, ground: 0.0 }, &[5e3]);
    let found = dynamics.deflection(&next, 0.4);
    assert!((found - expected).abs() < ROUNDOFF * expected.abs(), "{found} {expected}");
}
