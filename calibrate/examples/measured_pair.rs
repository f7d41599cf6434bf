//! The springs of a measured wheel and rail that no standard is like:
//! `cargo run --release -p railspring-calibrate --example measured_pair -- data/profiles`.
//!
//! The profiles are read, checked, repaired and smoothed. Each is placed by its own shape and joined to a body like
//! that of a standard.

use std::path::Path;

use railspring_calibrate::prelude::*;
use railspring_profiles::profile_file::{PrepareOptions, ReadOptions, prepare, read};
use railspring_profiles::profile_placement::{rail_in_own_frame, wheel_in_own_frame};
use railspring_profiles::section::{WheelBody, rail_section_for_head, wheel_section_for_profile};

/// Width of the head of 60E1 14 mm below its top, m.
const HEAD: f64 = 72e-3;
/// Distance of the tape circle from the flange back, m.
const TAPE_CIRCLE: f64 = 70e-3;
/// Diameter at the tape circle, m.
const DIAMETER: f64 = 0.92;

/// The pair of the files `freight-rail.csv` and `freight.whl` in a `folder`.
pub fn measured(folder: &Path) -> Result<Pair, Error> {
    let mut findings = Vec::new();
    let rail = read(&folder.join("freight-rail.csv"), &ReadOptions::default())?;
    let head = prepare(&rail_in_own_frame(&rail, HEAD)?.profile, &PrepareOptions::default())?;
    let rail = rail_section_for_head(rail_section("60E1")?, &head.curve, &mut findings)?;

    let wheel = read(&folder.join("freight.whl"), &ReadOptions::default())?;
    let running = prepare(&wheel_in_own_frame(&wheel, TAPE_CIRCLE)?.profile, &PrepareOptions::default())?;
    let like = wheel_section("S1002", DIAMETER)?;
    let wheel = wheel_section_for_profile(&like, &running.curve, &WheelBody::default(), &mut findings)?;
    for finding in head.findings.iter().chain(&running.findings).chain(&findings) {
        println!("{}", finding.text);
    }
    Pair::new(rail, wheel, &TrackGeometry::standard())
}

fn main() -> Result<(), Error> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "data/profiles".into());
    let springs = measured(Path::new(&folder))?.fit(&[10e3, 25e3, 45e3, 65e3, 85e3])?;
    let law = springs.laws.beam.fit.law;
    println!("k(f) = {:.4e} + {:.4e}·(f/kN)^{:.3} N/m against the rail's section", law.a, law.b, law.c);
    Ok(())
}
