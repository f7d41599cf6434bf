//! What the calibration says its laws are worth, against a finer computation.

use railspring_calibrate::calibration::{ContactField, Enforcement};
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::monitor::Silent;
use railspring_calibrate::pair::{
    COARSER, CondensedPair, ContactConditions, Laws, Pair, error_bands, mesh_changes,
};
use railspring_calibrate::placement::TrackGeometry;
use railspring_calibrate::section::{rail_section, wheel_section};
use railspring_calibrate::solid::{Formulation, Material};
use std::time::Instant;

const LOADS: [f64; 6] = [5e3, 10e3, 20e3, 40e3, 70e3, 100e3];

fn pair() -> Pair {
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.858).unwrap());
    Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap()
}

fn condensed(pair: &Pair, options: &MeshOptions) -> CondensedPair {
    let meshes = pair.mesh(0.555, options).unwrap();
    meshes.condense(pair, Material::STEEL, Formulation::IncompatibleModes, &Silent).unwrap()
}

fn contact(field: ContactField) -> ContactConditions {
    ContactConditions { friction: 0.5, enforcement: Enforcement::Exact, field }
}

fn laws(pair: &Pair, bodies: &CondensedPair, field: ContactField) -> Laws {
    bodies.press(pair, contact(field), &LOADS, &Silent).unwrap().laws().unwrap()
}

#[test]
fn probe() {
    let pair = pair();
    for field in [ContactField::Hybrid, ContactField::Elements] {
        let base_options = MeshOptions { window_half_length: 14e-3, ..MeshOptions::default().refined(0.5) };
        let bodies = condensed(&pair, &base_options);
        let base = laws(&pair, &bodies, field);
        let grid = bodies.grid_changes(&pair, contact(field), &base, &Silent).unwrap();
        let coarse = condensed(&pair, &base_options.refined(1.0 / COARSER));
        let mesh = mesh_changes(&base, &laws(&pair, &coarse, field));
        let fine_bodies = condensed(&pair, &MeshOptions::default());
        let fine = laws(&pair, &fine_bodies, field);
        let fine_grid = fine_bodies.grid_changes(&pair, contact(field), &fine, &Silent).unwrap();
        let fine = mesh_changes(&base, &fine);
        for (i, (band, law)) in error_bands(&base, grid.as_ref(), Some(&mesh)).iter().zip(&base).enumerate() {
            println!("{field:?} {:?} {:?}", band.reference, band.largest());
            for (j, (p, q)) in band.points.iter().zip(&law.points).enumerate() {
                let f = |c: Option<railspring_calibrate::pair::Change>| {
                    c.map_or([0.0; 2], |c| [100.0 * c.displacement, 100.0 * c.tangent])
                };
                println!(
                    "  {:5.0} grid {:6.3?} mesh {:6.3?} band {:6.3?} to fine {:6.3?} its grid {:6.3?} d {:.4} um k {:.5} ",
                    p.force * 1e-3,
                    f(p.grid),
                    f(p.mesh),
                    f(Some(p.band())),
                    f(Some(fine[i][j])),
                    f(fine_grid.as_ref().map(|g| g[i][j])),
                    q.displacement * 1e6,
                    q.solid_tangent * 1e-9
                );
            }
        }
    }
}
