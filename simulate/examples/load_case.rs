//! A wheel on a rail in time, with the contact element that is condensed from its solids:
//! `cargo run --release -p railspring-simulate --example load_case`.

use railspring_profiles::error::Result;
use railspring_simulate::prelude::*;
use railspring_simulate::time::history::History;

/// A wheel under a vertical force with a sine and a constant lateral force, for 0.1 s.
pub fn history(options: &FitOptions) -> Result<History> {
    let pair = Pair::new(rail_section("60E1")?, wheel_section("S1002", 0.858)?, &TrackGeometry::standard())?;
    let at = ElementFit {
        shifts: &[-3e-3, 0.0, 3e-3, 5e-3, 7e-3],
        loads: &[10e3, 20e3, 40e3, 60e3, 90e3],
        rail_elements: 20,
    };
    let model = CondensedModel::fit(&pair, &at, options, &Silent)?;
    let scenario = Scenario {
        vertical_force: HarmonicForce { amplitude: 30e3, frequency: 10.0, ..HarmonicForce::constant(60e3) }
            .into(),
        lateral_force: TimeFunction::constant(10e3),
        inner_steps: CondensedModel::STEPS,
        ..Scenario::new(200, 5e-4, options.contact.friction)
    };
    Ok(model.run(&scenario, &Silent)?.history)
}

fn main() -> Result<()> {
    // 2 % of damping at 1 kHz
    let damping = 2.0 * 0.02 / (std::f64::consts::TAU * 1000.0);
    let material = Material { damping, ..Material::STEEL };
    let history = history(&FitOptions { material, ..FitOptions::default() })?;
    println!("{} unknowns, {}", history.degrees_of_freedom, history.ending);
    println!("time, s   P, kN   Q, kN   y, mm");
    for row in history.rows.iter().step_by(20) {
        let (p, q) = (row.vertical_force * 1e-3, row.lateral_force * 1e-3);
        println!("{:.3}   {p:7.2} {q:7.2} {:7.3}", row.time, row.wheel_y * 1e3);
    }
    Ok(())
}
