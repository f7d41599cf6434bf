//! Made-up results for the tests of the report: smooth stand-ins of the right
//! size and shape, no physics.

use std::f64::consts::{PI, TAU};

use nalgebra::Point2;
use railspring_simulate::time::history::{ContactMode, ContactState, Ending, History, HistoryRow};

use crate::engine::measured::{MachineRecord, Measured, StageMeasure};
use crate::results::bodies::outline_figure::ProfilePair;
use crate::self_test::Check;
use crate::study::ResolvedKey;

mod springs;
mod patches;
mod crosscheck;
mod measured;
mod uncertain;

pub(crate) use crate::results::samples::crosscheck::{crosscheck, crosscheck_in_time, sections};
pub(crate) use crate::results::samples::measured::{bodies, surface};
pub(crate) use crate::results::samples::patches::patches;
pub(crate) use crate::results::samples::springs::{by_angle, load_curve, lumped, stiffness};
pub(crate) use crate::results::samples::uncertain::uncertain_run;

/// A run with sliding, a flange contact from 0.01 s on and one separation.
pub(crate) fn history(shift: f64) -> History {
    let rows = (0..=550)
        .map(|n| {
            let time = n as f64 * 0.0005;
            let apart = (0.146 + shift..0.171 + shift).contains(&time);
            let vertical_force =
                if apart { 0.0 } else { (12e3 + 61e3 * (TAU * 10.0 * (time - shift)).sin()).max(2e3) };
            let lateral_force = if apart {
                0.0
            } else {
                20e3 * (1.0 - (-time / 0.01).exp()) + 1e3 * (TAU * 60.0 * time).sin()
            };
            let wheel_y = 0.0067 * (1.0 - (-time / 0.006).exp());
            let contact = |mode, rail, wheel, share: f64| ContactState {
                mode,
                rail,
                wheel,
                normal_force: share * vertical_force,
                tangential_force: 0.2 * share * vertical_force,
            };
            let on_flange = time > 0.01;
            let mut contacts = Vec::new();
            if on_flange {
                let mode = if time > 0.03 { ContactMode::Stick } else { ContactMode::Slip };
                contacts.push(contact(mode, Point2::new(-0.0335, 0.0087), Point2::new(-0.0380, 0.0080), 0.6));
            }
            contacts.push(contact(
                ContactMode::Slip,
                Point2::new(-0.011, 0.0003),
                Point2::new(-0.015 - wheel_y, 0.0006),
                1.0,
            ));
            if apart {
                contacts.clear();
            }
            HistoryRow {
                time,
                vertical_force,
                lateral_force,
                wheel_y,
                wheel_z: -0.0004 * (PI * time * 20.0).sin(),
                load_y: 0.0,
                energy: None,
                contacts,
            }
        })
        .collect();
    History { rows, degrees_of_freedom: 116, ending: Ending::Completed }
}

/// Rough outlines of a rail head and a wheel.
pub(crate) fn profiles() -> ProfilePair {
    let mm = |points: &[(f64, f64)]| points.iter().map(|(y, z)| Point2::new(y * 1e-3, z * 1e-3)).collect();
    ProfilePair {
        rail: mm(&[
            (-8.0, 60.0),
            (-12.0, 45.0),
            (-36.0, 37.0),
            (-36.0, 14.0),
            (-33.0, 7.0),
            (-26.0, 2.2),
            (-10.0, 0.2),
            (0.0, 0.0),
            (10.0, 0.2),
            (26.0, 2.2),
            (33.0, 7.0),
            (36.0, 14.0),
            (36.0, 37.0),
            (12.0, 45.0),
            (8.0, 60.0),
        ]),
        rail_angle: -0.025,
        rail_origin: Point2::new(0.7535, 0.0002),
        wheel: mm(&[
            (-70.0, -80.0),
            (-70.0, 18.0),
            (-63.0, 27.0),
            (-55.0, 28.0),
            (-48.0, 22.0),
            (-44.0, 14.0),
            (-38.5, 6.0),
            (-30.0, 1.8),
            (-20.0, 0.7),
            (0.0, 0.0),
            (30.0, -1.0),
            (60.0, -3.0),
            (65.0, -8.0),
            (65.0, -80.0),
        ]),
        wheel_origin: Point2::new(0.75, -0.0003),
        touch: Point2::new(0.742, 0.0004),
    }
}

/// Some keys.
/// Checks of the program's own test, all of which hold.
pub(crate) fn checks() -> Vec<Check> {
    let check = |name: &str, source: &str, found: f64, expected: f64, tolerance: f64| Check {
        name: name.into(),
        source: source.into(),
        found,
        expected,
        tolerance,
    };
    vec![
        check("shortening of a column of bricks, m", "F L / (E A)", 2.380_95e-5, 2.380_95e-5, 1e-10),
        check("observed order of bricks' displacement", "manufactured", 1.98, 2.0, 0.05),
        check("approach of S1002 on UIC60, 3 mm, 94.6 kN, m", "CONTACT 25.2", 1.1074e-4, 1.1076e-4, 0.01),
    ]
}

pub(crate) fn inputs() -> Vec<ResolvedKey> {
    [
        ("rail", "profile", "60E1", true),
        ("rail", "length_m", "0.555", false),
        ("track", "gauge_mm", "1435", false),
    ]
    .map(|(section, key, value, given)| ResolvedKey {
        section: section.into(),
        key: key.into(),
        value: value.into(),
        given,
    })
    .to_vec()
}

/// Some measures.
pub(crate) fn measured() -> Measured {
    let stage = |name: &str, seconds| StageMeasure {
        stage: name.into(),
        key: String::new(),
        seconds,
        peak_memory_mib: Some(812.0),
        taken: false,
    };
    Measured {
        begun_utc: "2016-01-31T12:00:00Z".into(),
        host: "host".into(),
        machine: MachineRecord { processor: Some("processor".into()), cores: 2, memory_gib: Some(16.0) },
        threads: 2,
        stages: vec![stage("superelements", 41.2), stage("solid model, sample", 102.7)],
    }
}
