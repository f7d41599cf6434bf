//! The contact as statics.

use super::{contact, element, pressed};
use crate::contact::{Forces, Motions, StaticContact};
use nalgebra::{Matrix3, Vector3};
use railspring_testing::Random;
use std::sync::Arc;

/// What a force of [`StaticContact::evaluate`] may be off, N: strips near where they were found by 3 N at each end of a contact, and the relief to the first order.
const FORCE: f64 = 30.0;

fn bits(forces: &Forces) -> Vec<u64> {
    forces.rim.iter().chain(&forces.section).chain(forces.tangent.iter()).map(|v| v.to_bits()).collect()
}

/// Goal: forces depend on the end of the last step and the motions alone. After other evaluations, in a clone and in a contact that takes the state over they are the same to the last bit, through a random walk with
/// committed steps. The walk begun anew is the same. Exact.
#[test]
fn what_was_tried_does_not_matter() {
    let walk = |tries: usize| {
        let (mut random, mut trials) = (Random::new(3), Random::new(17));
        let (mut contact, mut other) = (contact(), contact());
        let mut all = Vec::new();
        contact.start(&Motions { place: 0.3, ..Motions::default() }).unwrap();
        for _ in 0..60 {
            let motions = pressed(&mut random);
            for _ in 0..tries {
                let _ = contact.evaluate(&pressed(&mut trials));
            }
            other.restore(&contact);
            let mut clone = contact.clone();
            let forces = contact.evaluate(&motions).unwrap();
            all.extend(bits(&forces));
            if tries > 0 {
                assert_eq!(bits(&clone.evaluate(&motions).unwrap()), bits(&forces));
                assert_eq!(bits(&other.evaluate(&motions).unwrap()), bits(&forces));
            }
            contact.commit();
        }
        all
    };
    assert_eq!(walk(0), walk(3));
}

/// Source: central differences. Goal: the tangent is the derivative of the forces (N/m, N, N·m) by motions of rim and section, sticking and sliding. Accuracy: FORCE over the step of the difference, and SECOND of the stiffness for what changes to the second
/// order: of Hertz's contact under 20 kN the square of a share of 2 µm in 30 µm, and strips that begin to slide.
#[test]
fn the_tangent_is_the_derivative() {
    const SECOND: f64 = 0.05;
    let mut random = Random::new(5);
    let mut tried = 0;
    while tried < 20 {
        let mut contact = contact();
        let from = pressed(&mut random);
        if contact.start(&from).is_err() {
            continue;
        }
        let mut at = from;
        at.rim += Vector3::new(2e-6, 1e-6, 0.0);
        let forces = contact.evaluate(&at).unwrap();
        if forces.rim.norm() < 20e3 {
            continue;
        }
        tried += 1;
        for k in 0..6 {
            let step = if k % 3 == 2 { 2e-5 } else { 2e-6 };
            let mut moved = |way: f64| {
                let mut at = at;
                if k < 3 {
                    at.rim[k] += way
                } else {
                    at.section[k - 3] += way
                }
                contact.evaluate(&at).unwrap()
            };
            let (after, before) = (moved(step), moved(-step));
            let column = forces.tangent.column(k);
            for i in 0..6 {
                let of = |forces: &Forces| if i < 3 { forces.rim[i] } else { forces.section[i - 3] };
                let found = (of(&after) - of(&before)) / (2.0 * step);
                // torques are compared at their lever
                let lever = if i % 3 == 2 { 0.1 } else { 1.0 };
                let scale = forces.tangent.column(k).rows(0, 2).norm();
                let allowed = lever * (FORCE / step + SECOND * scale);
                assert!((found - column[i]).abs() < allowed, "{tried} {i} {k}: {found:e} {:e}", column[i]);
            }
        }
    }
}

/// Source: equilibrium. Goal: the force on the section, carried to the rim, is against that on the rim, and the torque about the track of both vanishes. Accuracy: ROUNDOFF of a torque over the arm of 0.13 m.
#[test]
fn forces_balance() {
    const ROUNDOFF: f64 = 1e-6;
    let mut random = Random::new(7);
    let (mut contact, element) = (contact(), element());
    for _ in 0..200 {
        let motions = pressed(&mut random);
        let Ok(forces) = contact.evaluate(&motions) else { continue };
        let share = element.head.at(motions.place).share;
        // the share of the head in the motion of its section is that of the section in the head's force
        let on_head = share.try_inverse().unwrap().transpose() * forces.section;
        assert!((on_head.xy() + forces.rim.xy()).norm() < ROUNDOFF * (1.0 + forces.rim.norm()));
    }
}

/// Goal: 10,000 random states, of which most are senseless, give forces or an error, never a panic or numbers that are none; the state stays usable.
#[test]
fn random_states_end_well() {
    let mut random = Random::new(11);
    let mut contact = contact();
    let (mut found, mut refused) = (0, 0);
    for n in 0..10_000 {
        let mut motions = pressed(&mut random);
        for value in motions.rim.iter_mut().chain(motions.section.iter_mut()) {
            if random.chance(0.3) {
                *value *= 10.0_f64.powf(random.between(-3.0, 3.0));
            }
        }
        if n % 50 == 0 {
            motions.rim[n % 3] = random.one_of(&[f64::NAN, f64::INFINITY, 1e300]);
        }
        if n % 77 == 0 {
            motions.place = random.one_of(&[-0.1, 7.0, f64::NAN]);
        }
        match contact.evaluate(&motions) {
            Ok(forces) => {
                assert!(
                    forces.tangent.iter().chain(&forces.rim).chain(&forces.section).all(|v| v.is_finite())
                );
                found += 1;
                if random.chance(0.1) {
                    contact.commit();
                }
            }
            Err(_) => refused += 1,
        }
    }
    println!("{found} found, {refused} refused");
    assert!(found > 3000 && refused > 300);
}

/// Goal: what cannot be used is refused with its value and what was expected.
#[test]
fn senseless_input_is_refused() {
    let mut contact = contact();
    let nan = Motions { rim: Vector3::new(f64::NAN, 0.0, 0.0), ..Motions::default() };
    assert!(contact.evaluate(&nan).unwrap_err().to_string().starts_with("motion = NaN"));
    let far = Motions { rim: Vector3::new(30.0, 0.0, 0.0), ..Motions::default() };
    assert!(contact.evaluate(&far).unwrap_err().to_string().contains("metres"));
    let beyond = Motions { place: 0.7, ..Motions::default() };
    assert!(contact.evaluate(&beyond).unwrap_err().to_string().starts_with("place = 0.7"));
    let off = Motions { rim: Vector3::new(-160e-3, 2e-3, 0.0), place: 0.3, ..Motions::default() };
    assert!(contact.evaluate(&off).unwrap_err().to_string().contains("left the rail"));
    let element = Arc::new(element());
    assert!(StaticContact::new(element, -0.1).unwrap_err().to_string().starts_with("friction = -0.1"));
    let negative = -Matrix3::identity();
    assert!(contact.set_section_rest(negative).unwrap_err().to_string().starts_with("section_rest"));
}

/// Goal: after some evaluations have made the memory that they need, none takes more: 200 evaluations with commits of states like those before. Exact.
#[test]
fn evaluations_take_no_memory() {
    let mut contact = contact();
    let walk = |contact: &mut StaticContact, seed: u64| {
        let mut random = Random::new(seed);
        for _ in 0..200 {
            if contact.evaluate(&pressed(&mut random)).is_ok() {
                contact.commit();
            }
        }
    };
    walk(&mut contact, 1);
    let info = allocation_counter::measure(|| walk(&mut contact, 1));
    assert_eq!(info.count_total, 0, "{info:?}");
}
