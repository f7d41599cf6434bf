//! Loads in turn.

use super::super::{ContactField, Enforcement, Reference, load_point};
use crate::mesh::MeshOptions;
use crate::pair::{ContactConditions, Pair, PairBody};
use crate::solid::{Formulation, Material};
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};

/// Source: the load pressed from the one before at once. Goal: by way of loads in between the displacement and the tangent of the hub are the same,
/// with friction, whose slips count from the load before; a near load has none in between. Accuracy: SOLVER, the hub's last step of 1 nm on its way of 0.1 mm
/// and less after it; 1e-9 was seen.
#[test]
fn loads_in_between_only_give_starts() {
    const SOLVER: f64 = 1e-6;
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.858).unwrap());
    let pair = Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap();
    let options = MeshOptions { window_half_length: 14e-3, ..MeshOptions::default().refined(0.5) };
    let bodies = [PairBody::Wheel, PairBody::RailOnEnds];
    let meshes = pair.mesh(0.555, &options).unwrap();
    let bodies =
        meshes.condense(&pair, &bodies, Material::STEEL, Formulation::IncompatibleModes, &Silent).unwrap();
    let field = ContactField::Hybrid;
    let contact = ContactConditions { friction: 0.5, enforcement: Enforcement::Exact, field };
    let placed = bodies.wheel_on_rail(&pair, Reference::Beam, contact).unwrap();
    let first = placed.press(10e3, None).unwrap();
    assert!(placed.near(20e3, &first).is_none());
    let near = placed.near(80e3, &first).unwrap();
    assert!((near.load / 40e3 - 1.0).abs() < 1e-12, "10, 20, 40, 80 kN: {}", near.load);
    let [at_once, from_afar] = [placed.press(80e3, Some(&first)), placed.press_from_afar(80e3, Some(&first))]
        .map(|state| load_point(&placed, &state.unwrap()).unwrap());
    assert_eq!(from_afar.force, 80e3);
    for (a, b) in
        [(at_once.displacement, from_afar.displacement), (at_once.solid_tangent, from_afar.solid_tangent)]
    {
        assert!((b / a - 1.0).abs() < SOLVER, "{a} {b}");
    }
}
