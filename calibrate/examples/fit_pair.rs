//! The springs of a wheel and a rail: `cargo run --release -p railspring-calibrate --example fit_pair`.

use railspring_calibrate::prelude::*;

/// The springs of S1002 on 60E1 under loads from 10 to 120 kN.
pub fn springs(options: &FitOptions) -> Result<PairSprings, Error> {
    let pair = Pair::new(rail_section("60E1")?, wheel_section("S1002", 0.858)?, &TrackGeometry::standard())?;
    pair.fit_with(&[10e3, 25e3, 45e3, 65e3, 85e3, 120e3], options, &Silent)
}

fn main() -> Result<(), Error> {
    let springs = springs(&FitOptions::default())?;
    for (reference, calibration) in springs.laws.iter() {
        let law = calibration.fit.law;
        println!("{reference:?}: k(f) = {:.4e} + {:.4e}·(f/kN)^{:.3} N/m", law.a, law.b, law.c);
    }
    let horizontal = springs.horizontal;
    println!(
        "horizontal: {:.4e} N/m, preloads {:.1} % apart",
        horizontal.stiffness,
        100.0 * horizontal.spread
    );
    Ok(())
}
