//! The unit with the wheel's modes inside.

use super::{element, pressed};
use crate::contact::{Motions, StaticContact};
use crate::unit::{Host, HostForces, Motion, Unit};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use railspring_testing::Random;
use std::sync::Arc;

fn unit(gravity: f64) -> Unit {
    Unit::new(Arc::new(element()), 0.4, gravity).unwrap()
}

fn host(hub: [f64; 3], velocity: [f64; 3]) -> Host {
    let hub = Motion { displacement: hub.into(), velocity: velocity.into() };
    Host { hub, section: Motion::default(), place: 0.3 }
}

/// Source: a damped oscillator whose support has moved at t = 0 and stands still. Goal: with the wheel lifted off, the modes swing about the hub as `e^(-δt)(cos ωt + δ/ω·sin ωt)`, whatever the steps, and the force on the hub is
/// theirs. Accuracy: ROUNDOFF of some hundred steps.
#[test]
fn a_lifted_wheel_rings_down_exactly() {
    const ROUNDOFF: f64 = 1e-9;
    let element = element();
    for step in [1e-3, 1e-4] {
        let mut unit = unit(0.0);
        let at = host([0.0, -5e-3, 0.0], [0.0; 3]);
        unit.start(&at, false).unwrap();
        // the modes are where a hub 1 mm aside had them
        let away = Vector3::new(1e-3, 0.0, 2e-3);
        let begun: Vec<[f64; 2]> = unit
            .modal_state()
            .iter()
            .zip(&element.wheel.modes)
            .map(|([p, v], mode)| [p + mode.coupling.dot(&away), *v])
            .collect();
        unit.set_modal_state(&begun).unwrap();
        let steps = (0.02 / step) as usize;
        let mut forces = HostForces::default();
        for _ in 0..steps {
            forces = unit.advance(step, &at).unwrap();
            unit.commit();
        }
        let time = step * steps as f64;
        let mut expected = Vector3::zeros();
        for mode in &element.wheel.modes {
            let decay = 0.5 * element.damping * mode.square;
            let omega = (mode.square - decay * decay).sqrt();
            let swing = mode.coupling.dot(&away) * (-decay * time).exp();
            let q = swing * ((omega * time).cos() + decay / omega * (omega * time).sin());
            let v = -swing * mode.square / omega * (omega * time).sin();
            expected += mode.coupling * (mode.square * (q + element.damping * v));
        }
        let scale = expected.norm();
        assert!((forces.hub - expected).norm() < ROUNDOFF * scale, "{step}: {} {expected}", forces.hub);
        assert!(forces.section == Vector3::zeros() && forces.rim == Vector3::zeros());
    }
}

/// Source: statics. Goal: a unit that begins bent by contact and weight stays so on a hub that stands still: the forces (N) after 1 ms are those at the start, and those of a contact whose rim has the wheel's flexibility. Accuracy: FORCE, of
/// two balances, of which each is off by 30 N.
#[test]
fn a_wheel_that_begins_bent_stays_bent() {
    const FORCE: f64 = 60.0;
    for gravity in [0.0, 9.81] {
        let mut unit = unit(gravity);
        let at = host([1e-3, 60e-6, 0.0], [0.0; 3]);
        let first = unit.start(&at, true).unwrap();
        assert!(first.section.y > 20e3, "{first:?}");
        let mut last = first;
        for _ in 0..20 {
            last = unit.advance(5e-5, &at).unwrap();
            unit.commit();
        }
        assert!((last.section - first.section).norm() < FORCE, "{first:?} {last:?}");
        // what the wheel hangs on its hub with: contact and weight of what moves in the modes
        let weight: f64 =
            element().wheel.modes.iter().map(|mode| mode.coupling.y * mode.coupling.y * gravity).sum();
        assert!((last.hub.y + last.section.y - weight).abs() < FORCE, "{last:?} {weight}");
    }
}

/// Source: Newmark's scheme with average acceleration on the superelement, with the contact as statics, in short steps. Goal: a hub that is dropped at 0.2 m/s and held there by its own inertia alone has the forces (N) of that on its way
/// through the contact, as a host that integrates hub and rail. Accuracy: STEPS of both, over the largest force.
#[test]
fn both_interfaces_have_the_same_forces() {
    const STEPS: f64 = 0.01;
    let (h, count) = (5e-6, 400);
    let of_unit = {
        let mut unit = unit(0.0);
        let inverse = unit.hub_mass().try_inverse().unwrap();
        let mut hub = Motion { velocity: Vector3::new(0.0, 0.2, 0.0), ..Motion::default() };
        let at = |hub: Motion| Host { hub, section: Motion::default(), place: 0.3 };
        let mut a = inverse * unit.start(&at(hub), false).unwrap().hub;
        (0..count)
            .map(|_| {
                hub.displacement += hub.velocity * h + a * (0.5 * h * h);
                let expected = Motion { velocity: hub.velocity + a * h, ..hub };
                let forces = unit.advance(h, &at(expected)).unwrap();
                unit.commit();
                let after = inverse * forces.hub;
                hub.velocity += (a + after) * (0.5 * h);
                a = after;
                forces.section
            })
            .collect::<Vec<_>>()
    };
    let element = Arc::new(element());
    let wheel = element.superelement();
    let mut contact = StaticContact::new(element.clone(), 0.4).unwrap();
    let size = wheel.mass.nrows();
    let motions = |x: &DVector<f64>| Motions {
        rim: (&wheel.rim * x).fixed_rows::<3>(0).into(),
        section: Vector3::zeros(),
        place: 0.3,
    };
    let (mut x, mut v, mut a) = (DVector::zeros(size), DVector::zeros(size), DVector::zeros(size));
    v[1] = 0.2;
    let mut largest = (0.0_f64, 0.0_f64);
    for expected in of_unit {
        let (free_x, free_v) = (&x + &v * h + &a * (0.25 * h * h), &v + &a * (0.5 * h));
        let mut end = &x + &v * h + &a * (0.5 * h * h);
        let mut forces = contact.evaluate(&motions(&end)).unwrap();
        for _ in 0..50 {
            let acceleration = (&end - &free_x) * (4.0 / (h * h));
            let velocity = &free_v + &acceleration * (0.5 * h);
            let off = wheel.rim.tr_mul(&DVector::from_column_slice(forces.rim.as_slice()))
                - (&wheel.mass * acceleration + &wheel.damping * velocity + &wheel.stiffness * &end);
            let tangent = DMatrix::from_fn(3, 3, |i, k| forces.tangent[(i, k)]);
            let system = &wheel.mass * (4.0 / (h * h)) + &wheel.damping * (2.0 / h) + &wheel.stiffness
                - wheel.rim.transpose() * tangent * &wheel.rim;
            let change = system.lu().solve(&off).unwrap();
            end += &change;
            forces = contact.evaluate(&motions(&end)).unwrap();
            if change.amax() < 1e-9 {
                break;
            }
        }
        a = (&end - &free_x) * (4.0 / (h * h));
        (v, x) = (&free_v + &a * (0.5 * h), end);
        contact.commit();
        largest =
            (largest.0.max((forces.section - expected).xy().norm()), largest.1.max(forces.section.norm()));
    }
    println!("{largest:?}");
    assert!(largest.1 > 20e3 && largest.0 < STEPS * largest.1, "{largest:?}");
}

/// Source: central differences. Goal: derivatives of the forces on hub and section and of the modes' accelerations by motions and modes. Accuracy: FORCE of a balance over the step, and 5 % for the second order.
#[test]
fn the_jacobian_is_the_derivative() {
    const FORCE: f64 = 30.0;
    const SECOND: f64 = 0.05;
    let mut unit = unit(0.0);
    let at = host([1e-3, 120e-6, 1e-4], [0.01, -0.02, 0.1]);
    unit.start(&at, true).unwrap();
    let state = unit.modal_state().to_vec();
    let count = state.len();
    unit.instant(&at).unwrap();
    let jacobian = unit.jacobian();
    let mut values = |k: usize, way: f64| {
        let (mut at, mut state) = (at, state.clone());
        match k {
            0..3 => at.hub.displacement[k] += way,
            3..6 => at.hub.velocity[k - 3] += way,
            6..9 => at.section.displacement[k - 6] += way,
            _ => state[(k - 9) % count][(k - 9) / count] += way,
        }
        unit.set_modal_state(&state).unwrap();
        let forces = unit.instant(&at).unwrap();
        let mut accelerations = vec![0.0; count];
        unit.accelerations(&at, &mut accelerations);
        let all = forces.hub.iter().chain(&forces.section).copied().chain(accelerations);
        all.collect::<Vec<f64>>()
    };
    for k in 0..9 + 2 * count {
        let step = if (3..6).contains(&k) || k >= 9 + count { 1e-2 } else { 2e-6 };
        let (after, before) = (values(k, step), values(k, -step));
        for i in 0..6 + count {
            let found = (after[i] - before[i]) / (2.0 * step);
            let allowed = FORCE / step + SECOND * jacobian.column(k).amax();
            assert!((found - jacobian[(i, k)]).abs() < allowed, "{i} {k}: {found:e} {:e}", jacobian[(i, k)]);
        }
    }
}

/// Source: central differences. Goal: the tangent of a step of one inner step is the derivative of its forces (N/m, N, N·m) by the displacements of hub and section at its end. Accuracy: FORCE over the step of the difference, and 5 % of the
/// largest of a column for the second order.
#[test]
fn the_tangent_of_a_step_is_its_derivative() {
    const FORCE: f64 = 30.0;
    const SECOND: f64 = 0.05;
    const STEP: f64 = 3e-6;
    let mut unit = unit(0.0);
    let at = host([1e-3, 60e-6, 0.0], [0.0; 3]);
    unit.start(&at, true).unwrap();
    unit.advance(STEP, &at).unwrap();
    let tangent = unit.tangent();
    assert!(tangent[(1, 1)] < -5e8, "{tangent}");
    for k in 0..6 {
        let way = if k % 3 == 2 { 2e-5 } else { 2e-6 };
        let mut moved = |way: f64| {
            let mut at = at;
            if k < 3 {
                at.hub.displacement[k] += way
            } else {
                at.section.displacement[k - 3] += way
            }
            let forces = unit.advance(STEP, &at).unwrap();
            [forces.hub, forces.section]
        };
        let (after, before) = (moved(way), moved(-way));
        for i in 0..6 {
            let found = (after[i / 3][i % 3] - before[i / 3][i % 3]) / (2.0 * way);
            let allowed = FORCE / way + SECOND * tangent.column(k).amax();
            assert!((found - tangent[(i, k)]).abs() < allowed, "{i} {k}: {found:e} {:e}", tangent[(i, k)]);
        }
    }
}

/// Goal: a unit's forces depend on the end of its last step and the motions alone; a step of the same end taken over by another unit is the same to the last bit. Exact.
#[test]
fn a_unit_goes_back_to_its_last_step() {
    let mut random = Random::new(23);
    let (mut one, mut other) = (unit(0.0), unit(0.0));
    let first = host([0.0, 50e-6, 0.0], [0.0; 3]);
    one.start(&first, false).unwrap();
    let at = |random: &mut Random| {
        let Motions { rim, .. } = pressed(random);
        host([1e-4 * rim.x / 4e-3, rim.y, 0.0], [0.0; 3])
    };
    for _ in 0..40 {
        let end = at(&mut random);
        let _ = one.advance(3e-5, &at(&mut random));
        let _ = one.advance(2e-4, &at(&mut random));
        other.restore(&one);
        let [a, b] = [&mut one, &mut other].map(|unit| unit.advance(1e-4, &end).unwrap());
        assert_eq!(a, b);
        one.commit();
    }
    assert!(one.advance(0.0, &first).unwrap_err().to_string().starts_with("step = 0"));
    assert!(one.advance(f64::NAN, &first).is_err());
    assert!(one.set_section_rest(Matrix3::identity() * f64::NAN).is_err());
    assert!(Unit::new(Arc::new(element()), 0.4, f64::NAN).is_err());
}
