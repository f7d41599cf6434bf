//! Laws by contact angle: `cargo run --release -p railspring-calibrate --example law_by_angle`.
//!
//! The bodies are condensed once. The wheel is then pressed along the contact normal at several places across the
//! track, from the tread to the flange.

use railspring_calibrate::pair::ShiftLaw;
use railspring_calibrate::prelude::*;

/// Lateral shifts of the wheel, m, positive to the field side.
const SHIFTS: [f64; 3] = [-3e-3, 0.0, 7e-3];

/// The laws of S1002 on 60E1 at the [`SHIFTS`].
pub fn laws(options: &FitOptions) -> Result<Vec<ShiftLaw>, Error> {
    let pair = Pair::new(rail_section("60E1")?, wheel_section("S1002", 0.858)?, &TrackGeometry::standard())?;
    let FitOptions { material, element, contact, .. } = *options;
    let meshes = pair.mesh(options.rail_length, &options.mesh)?;
    let bodies = meshes.condense(&pair, PairBody::of_pair(false), material, element, &Silent)?;
    let settings = AngleSettings {
        contact,
        direction: PressDirection::Normal,
        loads: &[10e3, 20e3, 40e3, 60e3],
        fixed_loads: &[40e3],
        stresses: false,
    };
    law_by_shift(&pair, &bodies, &settings, &SHIFTS.map(|shift| pair.tape_y + shift), &Silent)
}

fn main() -> Result<(), Error> {
    for (shift, place) in SHIFTS.iter().zip(laws(&FitOptions::default())?) {
        let angle = place.touch.map_or(f64::NAN, |touch| touch.touch.contact_angle.to_degrees());
        match place.law {
            Ok(law) => {
                let at = law.laws.local.fit.law.tangent(40e3);
                println!("shift {:4.1} mm, {angle:5.1}°: {at:.4e} N/m at 40 kN", 1e3 * shift);
            }
            Err(reason) => println!("shift {:4.1} mm: no law: {reason}", 1e3 * shift),
        }
    }
    Ok(())
}
