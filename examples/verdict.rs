//! From two profiles to a verdict, on a coarse mesh and a short load case: fits the springs, runs the simple and the solid model
//! with them, and prints how far the two are apart. `cargo run --release --example verdict`.

use railspring::verify::{Limits, ModelRun, compare};
use railspring_calibrate::calibration::{ContactField, Enforcement, Reference};
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::pair::{ContactConditions, Pair, PairBody, SeriesBeam};
use railspring_calibrate::solid::{Formulation, Material};
use railspring_profiles::error::Result;
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};
use railspring_simulate::element::published::{MovingModel, WheelSprings};
use railspring_simulate::solid::{ModeCount, START_MODES, TransientModel};
use railspring_simulate::time::scenario::{HarmonicForce, Scenario};

fn main() -> Result<()> {
    // 2 % of damping at 1 kHz, as both models have it
    let steel = Material { damping: 2.0 * 0.02 / (std::f64::consts::TAU * 1000.0), ..Material::STEEL };
    let element = Formulation::IncompatibleModes;
    let contact =
        ContactConditions { friction: 0.5, enforcement: Enforcement::Exact, field: ContactField::Elements };

    let pair = Pair::new(rail_section("60E1")?, wheel_section("S1002", 0.858)?, &TrackGeometry::standard())?;
    let options =
        MeshOptions { contact_element: 4e-3, contact_element_along: 4e-3, ..MeshOptions::default() };
    let meshes = pair.mesh(0.555, &options)?;
    let bodies =
        meshes.condense_in_time(&pair, PairBody::of_pair(false), steel, element, START_MODES, &Silent)?;
    let pressed = bodies.press(&pair, contact, &[10e3, 25e3, 45e3, 65e3, 85e3], &Silent)?;
    let normal = pressed.fit(Reference::Beam)?.fit.law;
    let horizontal = pressed.horizontal(Reference::Beam, &[60e3], &Silent)?.stiffness;
    println!(
        "k(f) = {:.3e} + {:.3e}·(f/kN)^{:.3} N/m, horizontal {horizontal:.3e} N/m",
        normal.a, normal.b, normal.c
    );

    let scenario = Scenario {
        vertical_force: HarmonicForce::constant(60e3),
        lateral_force: HarmonicForce::constant(10e3),
        ..Scenario::new(20, 5e-4, contact.friction)
    };
    let beam = pair.beam(&steel, 0.555, 20)?;
    let beam = beam.corrected(&SeriesBeam::new(&pair, &bodies, &beam)?.correction)?;
    let springs = WheelSprings { horizontal, normal: normal.into(), longitudinal: horizontal };
    let simple = MovingModel::of_pair(&pair, beam, [&steel; 2], springs, bodies.wheel.mass);
    let simple = simple.run(&scenario, &Silent)?.history;
    let solids = [&bodies.rail_on_ends, &bodies.wheel];
    let contact = (contact.enforcement, contact.field);
    let solid = TransientModel::reduced(&pair, solids, ModeCount::Estimated, steel.damping, contact)?;
    let solid = solid.run(&scenario, &Silent)?.history;
    for line in compare(&ModelRun::alone(&simple), &ModelRun::alone(&solid), &Limits::default())?.lines {
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
