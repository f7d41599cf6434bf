//! Wheel and rail of different materials.

use nalgebra::Vector3;
use railspring_calibrate::analytic::hertz::point_contact;
use railspring_calibrate::calibration::{ContactField, Enforcement, LoadPoint, Reference};
use railspring_calibrate::contact::{
    FreeDirection, HalfSpace, NearField, Problem, Side, flat_grid, gaps, solve,
};
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::pair::{
    CondensedPair, ContactConditions, Orders, Pair, PairBody, PairSolids, condense_all,
};
use railspring_calibrate::solid::{Formulation, Material, Materials};
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};

/// So stiff that the other body alone gives way, to a thousandth.
const HARD: Material = Material { young: 1000.0 * Material::STEEL.young, ..Material::STEEL };
const CAST_IRON: Material = Material { young: 110e9, poisson: 0.26, ..Material::STEEL };

/// The `local` law of a cone of 1:40 with the `materials` of rail and wheel on the crown of 60E1, and Hertz's radii there along and across the track, m.
fn local(materials: [Material; 2], loads: &[f64]) -> ([f64; 2], Vec<LoadPoint>) {
    let (rail, wheel) = (rail_section("60E1"), wheel_section("EN13715-1in40", 0.92));
    let pair = Pair::new(rail.unwrap(), wheel.unwrap(), &TrackGeometry::standard()).unwrap();
    let meshes = pair.mesh(0.555, &MeshOptions::default()).unwrap();
    let (of_groups, orders) = (materials.map(Materials::from), Orders::default());
    let solids = PairSolids {
        pair: &pair,
        rail: &meshes.rail,
        wheel: &meshes.wheel,
        materials: of_groups.each_ref(),
        element: Formulation::IncompatibleModes,
        orders: &orders,
    };
    let condense = |body| solids.condense(body, solids.key(body));
    let bodies = condense_all(("bodies", &Silent), PairBody::of_pair(false), false, condense);
    let bodies = CondensedPair::new(bodies.unwrap()).unwrap();
    let contact =
        ContactConditions { friction: 0.0, enforcement: Enforcement::Exact, field: ContactField::Hybrid };
    let pressed = bodies.press(&pair, contact, loads, &Silent).unwrap();
    (pair.relative_radii(), pressed.fit(Reference::Local).unwrap().points)
}

/// Source: Hertz with `1/E* = (1-ν₁²)/E₁ + (1-ν₂²)/E₂`. Goal: approach (m) and tangent (N/m) of the `local`
/// law of a steel wheel on a rail a thousand times as stiff, and of a wheel of cast iron on a steel rail. A
/// cone stands on the crown of 300 mm, so that curvatures are constant over the patch. Accuracy as in
/// `hybrid::a_crowned_wheel_on_an_irregular_mesh_is_hertz`: DISCRETISATION of the fine grid and of the field
/// of the meshes, 1 % of the approach, 2 % of the tangent. The modulus of two steel bodies in the place of
/// that of a hard rail would be off by 37 %.
#[test]
fn the_local_law_has_the_contact_modulus_of_both_materials() {
    const DISCRETISATION: [f64; 2] = [0.01, 0.02];
    for materials in [[HARD, Material::STEEL], [Material::STEEL, CAST_IRON]] {
        let [rail, wheel] = &materials;
        let ([along, across], points) = local(materials, &[5e3, 10e3, 20e3, 40e3]);
        for p in points {
            let exact = point_contact(p.force, along, across, rail.contact_modulus(wheel)).unwrap();
            let ratios = [p.displacement / exact.approach, p.solid_tangent / exact.tangent_stiffness];
            println!(
                "{:.0} kN: approach, tangent {ratios:.4?}, axes {:.4}",
                1e-3 * p.force,
                exact.semi_axis_y
            );
            for (ratio, limit) in ratios.iter().zip(DISCRETISATION) {
                assert!((ratio - 1.0).abs() < limit, "{} N: {ratios:?}", p.force);
            }
        }
    }
}

/// Approach of a sphere of 0.3 m to a plane under 85 kN, both half-spaces, of the materials of base and opposing body, m.
fn sphere_approach([base, opposing]: [&Material; 2], friction: f64) -> f64 {
    const CELLS: f64 = 5.0;
    let (radius, load) = (0.3, 85e3);
    let patch = (0.75 * load * radius / base.contact_modulus(opposing)).cbrt();
    let (h, count) = (patch / CELLS, 2 * (1.2 * CELLS) as usize + 1);
    let points = flat_grid((count, count), h, |s, x| (s * s + x * x) / (2.0 * radius));
    let bodies = [HalfSpace::new(base, Side::Base), HalfSpace::new(opposing, Side::Opposing)];
    let compliance = NearField::new(&bodies, &points, 3);
    let mut free = gaps(&points);
    free.resize(3 * points.len(), 0.0);
    let hub = [
        FreeDirection { along: Vector3::z_axis(), force: -load },
        FreeDirection { along: Vector3::y_axis(), force: 0.0 },
    ];
    let problem = Problem { points: &points, compliance: &compliance, free: &free, friction, hub: &hub };
    solve(&problem, &vec![0.0; 3 * points.len()]).unwrap().hub[0]
}

/// Source: K.L. Johnson, Contact Mechanics, 1985, sections 5.1 and 5.4: which body is which changes nothing, and what a pressure draws the surfaces aside by is measured by
/// Dundurs' β, for a rigid punch that sticks `ln((1+β)/(1-β))/(2β)` of stiffness (N.I. Mossakovskii 1954), 2.9 % for steel on a rigid body and 0.5 % on cast iron. Goal: with the
/// materials swapped the approach (m) is the same; friction makes it smaller, by that at most, and bodies of one material do not know it. Accuracy: SOLVER.
#[test]
fn swapped_materials_approach_as_much_and_friction_stiffens_little() {
    const SOLVER: f64 = 1e-8;
    let steel = &Material::STEEL;
    let near = |a: f64, b: f64| (a / b - 1.0).abs() < SOLVER;
    assert!(near(sphere_approach([steel; 2], 0.5), sphere_approach([steel; 2], 0.0)));
    for other in [&HARD, &CAST_IRON] {
        let (g, nu) = ([steel, other].map(Material::shear_modulus), [steel.poisson, other.poisson]);
        let beta = (0.5 * (g[0] * (1.0 - 2.0 * nu[1]) - g[1] * (1.0 - 2.0 * nu[0]))
            / (g[0] * (1.0 - nu[1]) + g[1] * (1.0 - nu[0])))
            .abs();
        let bound = ((1.0 + beta) / (1.0 - beta)).ln() / (2.0 * beta) - 1.0;
        for friction in [0.0, 0.5] {
            let [one, swapped] =
                [[steel, other], [other, steel]].map(|bodies| sphere_approach(bodies, friction));
            assert!(near(one, swapped), "friction {friction}: {one} {swapped}");
        }
        let [without, with] = [0.0, 0.5].map(|friction| sphere_approach([steel, other], friction));
        let stiffer = without / with - 1.0;
        println!("β {beta:.4}: {:.3} % stiffer with friction, bound {:.3} %", 100.0 * stiffer, 100.0 * bound);
        assert!(stiffer > SOLVER && stiffer < bound, "{stiffer} {bound}");
    }
}
