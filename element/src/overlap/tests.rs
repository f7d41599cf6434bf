//! Overlaps that change their number.

use super::*;
use crate::strips::tests::{Uniform, at_origin, found, profile};
use nalgebra::{Point2, Vector3};
use railspring_calibrate::pair::Pair;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};
use railspring_testing::Random;

/// Goal: two contacts that join leave no jump in the normal force. From one of 2000 depths to the next it changes as it did before. A wheel with a hollow of 80 µm between two
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

/// Goal: within the stated gap (m) no contact comes or parts. Cases: S1002 on 60E1, and the wheel with two crowns on a flat rail, 1000 places and depths each. One pair of profiles finds them again and again, and
/// is moved by nine tenths of the gap any way. It is compared with bodies that are looked at for the first time. A gap is of use: a quarter of them are longer than a micrometre.
#[test]
fn no_contact_comes_within_the_gap() {
    let rail = rail_section("60E1").unwrap();
    let pair = Pair::new(rail, wheel_section("S1002", 0.92).unwrap(), &TrackGeometry::standard()).unwrap();
    let hollow = |y: f64| -1.5 * y * y - 60e-6 * (std::f64::consts::TAU * y / 12e-3).cos();
    let (flat, crowns) = (profile(|_| 0.0), profile(hollow));
    let standards = (&pair.placed.curve, &pair.wheel.running, Point2::from(pair.tape()), 8e-3);
    let mut random = Random::new(7);
    let (mut useful, mut kinds) = (0, [0; 4]);
    for (rail, wheel, tape, aside) in [standards, (&flat, &crowns, Point2::origin(), 1e-3)] {
        let fresh = || Profiles::new(rail, wheel, tape, Point2::origin());
        let counted = |profiles: &mut Profiles, pose: &Pose| {
            let (place, spans) = profiles.at(pose, &Relief::default());
            (0..spans).filter(|number| profiles.overlap(&place, *number).is_some()).count()
        };
        let mut followed = fresh();
        let mut pose = Pose::default();
        for i in 0..1000 {
            // a walk, which from time to time begins elsewhere
            let [across, down, turn] = [(); 3].map(|()| random.between(-1.0, 1.0));
            if i % 25 == 0 {
                pose.wheel = Vector3::new(aside * across, 50e-6 * (1.0 + down), 1e-3 * turn);
            } else {
                pose.wheel += Vector3::new(5e-6 * across, 5e-6 * down, 1e-5 * turn);
            }
            let count = counted(&mut followed, &pose);
            assert_eq!(count, counted(&mut fresh(), &pose), "{pose:?}");
            kinds[count.min(3)] += 1;
            let gap = followed.gap;
            useful += usize::from(gap > 1e-6);
            let angle = random.between(0.0, std::f64::consts::TAU);
            let mut moved = pose;
            moved.wheel += Vector3::new(angle.cos(), angle.sin(), 0.0) * (0.9 * gap.clamp(0.0, 1e-3));
            // those that there are may end
            assert!(counted(&mut fresh(), &moved) <= count, "{pose:?} {gap} {angle}");
        }
    }
    println!("{kinds:?} {useful}");
    assert!(kinds[1] > 100 && kinds[2] > 100 && useful > 500, "{kinds:?} {useful}");
}
