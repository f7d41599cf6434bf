//! Fits the springs between a wheel and a rail, and prints them: `cargo run --release --example fit_pair`.

use railspring_calibrate::calibration::{ContactField, Enforcement, Reference};
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::pair::{ContactConditions, Pair, PairBody};
use railspring_calibrate::solid::{Formulation, Material};
use railspring_profiles::error::Result;
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};

fn main() -> Result<()> {
    let pair = Pair::new(rail_section("60E1")?, wheel_section("S1002", 0.858)?, &TrackGeometry::standard())?;
    let options =
        MeshOptions { contact_element: 3e-3, contact_element_along: 2.5e-3, ..MeshOptions::default() };
    let meshes = pair.mesh(0.555, &options)?;
    let bodies =
        meshes.condense(&pair, &PairBody::ALL, Material::STEEL, Formulation::IncompatibleModes, &Silent)?;
    let contact =
        ContactConditions { friction: 0.5, enforcement: Enforcement::Exact, field: ContactField::Elements };
    let pressed = bodies.press(&pair, contact, &[10e3, 25e3, 45e3, 65e3, 85e3, 120e3], &Silent)?;
    for reference in [Reference::Foot, Reference::Beam, Reference::Local] {
        let law = pressed.fit(reference)?.fit.law;
        println!("{reference:?}: k(f) = {:.4e} + {:.4e}·(f/kN)^{:.3} N/m", law.a, law.b, law.c);
    }
    let horizontal = pressed.horizontal(Reference::Beam, &[20e3, 60e3, 85e3], &Silent)?;
    println!("horizontal: {:.4e} N/m, {:.1} % apart", horizontal.stiffness, 100.0 * horizontal.spread);
    Ok(())
}
