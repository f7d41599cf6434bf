//! The element alone, as a foreign program has it: its file, its contact as statics, its unit with modes.

mod contact;
mod file;
mod unit;
mod units_of_fmi;

use crate::contact::{Motions, StaticContact};
use crate::element::{About, Element, RailMode, RailModes};
use crate::head::{Head, HeadAt};
use crate::law::{StripPlace, StripStiffness};
use crate::modulus::StripModulus;
use crate::relief::Influence;
use crate::wheel::{ElasticWheel, RimMode};
use nalgebra::{Matrix3, Point2, Vector3};
use railspring_calibrate::pair::Pair;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};
use railspring_testing::Random;
use std::sync::Arc;

/// Length of the rail, m.
const LENGTH: f64 = 0.6;

/// S1002 on 60E1 with strips, modes and a head of round numbers of the size that those of solids have, on a rail with held ends.
fn element() -> Element {
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.858).unwrap());
    let pair = Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap();
    let place = |i: i32| StripPlace {
        rail_s: 1e-3 * f64::from(i),
        modulus: StripModulus {
            normal: 2.2e11 + 1e9 * f64::from(i % 7),
            hardening: 0.2,
            tangential: 1e11,
            relief: 0.9,
        },
    };
    let mode = |hertz: f64, rim: [f64; 3], coupling: [f64; 3]| RimMode {
        square: (std::f64::consts::TAU * hertz).powi(2),
        rim: rim.into(),
        coupling: coupling.into(),
    };
    let flexible = |share: f64| HeadAt {
        share: Matrix3::from_diagonal(&Vector3::new(0.9 + 0.1 * share, 1.0, 0.8 + 0.2 * share)),
        flexibility: Matrix3::new(8e-9, 0.0, -6e-8, 0.0, 1e-10, 0.0, -6e-8, 0.0, 6e-7) * share,
        twist: Vector3::zeros(),
    };
    Element {
        about: About {
            study: "numbers".into(),
            pair: "S1002 on 60E1".into(),
            strips_max_rel_error: 0.01,
            ..About::default()
        },
        rail: pair.placed.clone(),
        wheel_profile: pair.wheel.running.clone(),
        tape: Point2::from(pair.tape()),
        node_line: pair.node_line(),
        wheel: ElasticWheel {
            mass: Matrix3::new(380.0, 0.0, 8.0, 0.0, 380.0, 0.0, 8.0, 0.0, 24.0),
            hub: [0.0, -0.429],
            modes: vec![
                mode(188.0, [0.105, 0.001, -0.31], [0.0, 0.3, 0.1]),
                mode(265.0, [-0.069, 0.002, 0.105], [-6.0, 0.0, 2.0]),
                mode(429.0, [0.11, 0.001, -0.547], [0.2, 0.1, 0.0]),
            ],
            rest: Matrix3::new(2e-9, 0.0, -1e-9, 0.0, 1.5e-10, 0.0, -1e-9, 0.0, 2e-8),
        },
        damping: 6.4e-6,
        head: Head::by_distance(LENGTH, &[(0.0, flexible(0.1)), (0.1, flexible(0.7)), (0.3, flexible(1.0))]),
        head_on_section: flexible(1.0).flexibility,
        strips: StripStiffness::new((0..150).map(place).collect(), Influence { flexibility: 2.76e-12 }, 0.01),
        friction: 0.4,
        rail_at_wheel: Some(RailModes {
            place: 0.3,
            damping: 6e-6,
            modes: vec![RailMode { square: 9e6, section: Vector3::new(0.2, 0.3, 1.0) }],
            rest: Matrix3::from_diagonal(&Vector3::new(1e-10, 5e-11, 1e-9)),
        }),
    }
}

fn contact() -> StaticContact {
    StaticContact::new(Arc::new(element()), 0.4).unwrap()
}

/// Motions of a wheel that is pressed by up to 100 µm, moved aside by up to 4 mm or against the flange, and turned a little.
fn pressed(random: &mut Random) -> Motions {
    let mut within = |low: f64, high: f64| random.between(low, high);
    let rim = Vector3::new(within(-4e-3, 4e-3), within(0.0, 1e-4), within(-2e-3, 2e-3));
    let section = Vector3::new(within(-1e-4, 1e-4), within(-2e-5, 2e-5), within(-1e-3, 1e-3));
    Motions { rim, section, place: within(0.05, 0.55) }
}
