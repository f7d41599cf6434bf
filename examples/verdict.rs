//! From two profiles to a verdict, on a coarse mesh and a short load case: condenses the contact element, runs the
//! simple and the solid model, and prints how far the two are apart. `cargo run --release --example verdict`.

use railspring::verify::{Limits, Line, ModelRun, compare};
use railspring_profiles::error::Result;
use railspring_simulate::prelude::*;
use railspring_simulate::solid::START_MODES;

/// The lines of the verdict on S1002 on 60E1 under 60 kN and 10 kN of lateral force, over 10 ms.
pub fn lines() -> Result<Vec<Line>> {
    // 2 % of damping at 1 kHz, as both models have it
    let material = Material { damping: 2.0 * 0.02 / (std::f64::consts::TAU * 1000.0), ..Material::STEEL };
    let mesh = MeshOptions { contact_element: 4e-3, contact_element_along: 4e-3, ..MeshOptions::default() };
    let options = FitOptions { material, mesh, ..FitOptions::default() };
    let FitOptions { rail_length, element, contact, .. } = options;

    let pair = Pair::new(rail_section("60E1")?, wheel_section("S1002", 0.858)?, &TrackGeometry::standard())?;
    let wanted = PairBody::of_pair(false);
    let meshes = pair.mesh(rail_length, &options.mesh)?;
    let bodies = meshes.condense_in_time(&pair, wanted, material, element, START_MODES, &Silent)?;
    let at =
        ElementFit { shifts: &[-3e-3, 0.0, 3e-3], loads: &[10e3, 25e3, 45e3, 65e3, 85e3], rail_elements: 20 };
    let simple = CondensedModel::fit_on(&pair, &bodies, &at, &options, &Silent)?;
    let solids = [&bodies.rail_on_ends, &bodies.wheel];
    let meets = (contact.enforcement, contact.field);
    let solid = TransientModel::reduced(&pair, solids, ModeCount::Estimated, material.damping, meets)?;

    let scenario = Scenario {
        vertical_force: TimeFunction::constant(60e3),
        lateral_force: TimeFunction::constant(10e3),
        inner_steps: CondensedModel::STEPS,
        ..Scenario::new(20, 5e-4, contact.friction)
    };
    let simple = simple.run(&scenario, &Silent)?.history;
    let solid = solid.run(&scenario, &Silent)?.history;
    Ok(compare(&ModelRun::alone(&simple), &ModelRun::alone(&solid), &Limits::default())?.lines)
}

fn main() -> Result<()> {
    for line in lines()? {
        let value = line.value.map_or_else(|| "none".into(), |value| format!("{value:.3}"));
        println!(
            "{} {}: {value} (limit {})",
            if line.holds { "holds" } else { "FAILS" },
            line.meaning,
            line.limit
        );
    }
    Ok(())
}
