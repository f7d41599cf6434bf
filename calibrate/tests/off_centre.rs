//! The wheel pressed on the rail away from the middle, with little and much friction, on coarse meshes.

use railspring_calibrate::calibration::{ContactField, Enforcement, press_loads};
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::pair::{ContactConditions, Orders, Pair, PairBody, PairMeshes, PairSolids};
use railspring_calibrate::solid::{Formulation, Material, Materials};
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};

/// SOLVER: the wanted force is met to 1e-10 of the largest.
const SOLVER: f64 = 1e-8;

/// Goal: tread, gauge corner and flange reach their answer on both standard wheels with friction from 0.05 to 0.6: the
/// wanted vertical load is carried, the hub goes down with the load, and friction stays in its cone. The shifts are
/// those at which full Newton steps oscillated (1 kN in the middle, 5 mm on the conical wheel) or that
/// lie on the gauge corner (6 mm) and on the flange (7 mm). Lengths in m, forces in N.
#[test]
fn tread_corner_and_flange_reach_their_answer() {
    let options = MeshOptions {
        contact_element: 3e-3,
        contact_element_along: 2.5e-3,
        rail_section_element: 16e-3,
        wheel_section_element: 24e-3,
        growth: 2.0,
        ..MeshOptions::default()
    };
    let loads = [1e3, 10e3, 25e3];
    for (name, shifts) in
        [("S1002", [0.0, 1e-3, 2e-3, 6e-3, 7e-3]), ("EN13715-1in40", [0.0, 1e-3, 5e-3, 6e-3, 7e-3])]
    {
        let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section(name, 0.858).unwrap());
        let centred = Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap();
        let PairMeshes { rail, wheel } = centred.mesh(0.3, &options).unwrap();
        // a shift moves neither mesh
        let steel = Materials::from(Material::STEEL);
        let solids = PairSolids {
            pair: &centred,
            rail: &rail,
            wheel: &wheel,
            materials: [&steel; 2],
            element: Formulation::FullIntegration,
            orders: &Orders::default(),
        };
        let [on_hub, on_foot] = [PairBody::Wheel, PairBody::RailOnFoot]
            .map(|body| solids.condense(body, solids.key(body)).unwrap());
        for lateral_shift in shifts {
            let track = TrackGeometry { lateral_shift, ..TrackGeometry::standard() };
            let shifted = Pair::new(centred.rail.clone(), centred.wheel.clone(), &track).unwrap();
            for friction in [0.05, 0.3, 0.6] {
                let (enforcement, field) = (Enforcement::Exact, ContactField::Elements);
                let contact = ContactConditions { friction, enforcement, field };
                let rail = shifted.contact_body(PairBody::RailOnFoot, &on_foot).unwrap();
                let wheel = shifted.contact_body(PairBody::Wheel, &on_hub).unwrap();
                let pair = shifted.wheel_on_rail(rail, wheel, contact);
                let case = format!("{name}, shift {lateral_shift} m, friction {friction}");
                let states = press_loads(&pair, &loads, "press", &Silent)
                    .unwrap_or_else(|error| panic!("{case}: {error}"));
                for state in &states {
                    let f = &state.solution.forces;
                    let force = state.force_on_wheel();
                    assert!((force.z / state.load + 1.0).abs() < SOLVER, "{case}: {force}");
                    let n = state.points.len();
                    for j in 0..n {
                        let cone = friction * f[j] - f[n + j].hypot(f[2 * n + j]);
                        assert!(cone > -SOLVER * state.load, "{case}: {cone}");
                    }
                }
                assert!(states.windows(2).all(|w| w[1].hub.y > w[0].hub.y), "{case}");
            }
        }
    }
}
