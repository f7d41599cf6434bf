//! Overlaps that change their number.

use super::super::strips::tests::{Uniform, at_origin, found, profile};
use super::*;

/// Goal: two contacts that join leave no jump in the normal force: from one of 2000 depths to the next it changes as it did before, where a wheel with a hollow of 80 µm between two
/// crowns goes down by 100 µm into a flat rail. Accuracy: second differences over the largest force; that of two crowns under few loads, which goes with
/// the power 1.5 of the depth, is 5e-6, and that of a rule of integration that is of two contacts and then of one 1.5e-5.
#[test]
fn the_force_does_not_jump_where_contacts_join() {
    const SMOOTH: f64 = 8e-6;
    const PLACES: u32 = 2000;
    let hollow = |y: f64| -1.5 * y * y - 60e-6 * (std::f64::consts::TAU * y / 12e-3).cos();
    let (rail, wheel) = (profile(|_| 0.0), profile(hollow));
    let at = |i: u32| {
        let mut bodies = at_origin(&rail, &wheel, &Uniform(4e10));
        let depth = 100e-6 * f64::from(i) / f64::from(PLACES);
        let pose = Pose { wheel: Vector3::new(0.0, depth, 1e-3), ..Pose::default() };
        let contacts = found(&mut bodies, &pose, &Uniform(4e10));
        (contacts.len(), contacts.iter().map(|contact| contact.force.y.abs()).sum::<f64>())
    };
    let forces: Vec<(usize, f64)> = (0..=PLACES).map(at).collect();
    let [first, last] = [forces[0], forces[PLACES as usize]];
    let bends = forces.windows(3).map(|w| (w[2].1 - 2.0 * w[1].1 + w[0].1).abs() / last.1);
    let jump = bends.fold(0.0, f64::max);
    println!("{jump:e}");
    assert_eq!([first.0, last.0], [2, 1]);
    assert!(jump < SMOOTH, "{jump:e}");
}
