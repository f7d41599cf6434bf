//! Time of the steps of a calibration: `cargo bench -p railspring-calibrate`.
//!
//! S1002 on 60E1, contact elements of 6 mm, coarse enough for each step to take well below a second. Steps
//! are assembly, factor and condensation of the rail, pairing of the surfaces, and pressing without and with
//! friction, between elements and on the fine grid. There a load grows from the one before it as in a
//! calibration, tangent included. The steps are to be compared with each other, and with themselves before a
//! change. A load on the fine grid is to be compared with the convolution of the same group. It needs some
//! tens of these without friction and some hundreds with it.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::Vector2;
use railspring_calibrate::calibration::{ContactField, Enforcement, Reference, load_points};
use railspring_calibrate::contact::{ComplianceOperator, HalfSpace, NearField, flat_grid};
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::pair::{ContactConditions, Pair, PairBody, PairMeshes};
use railspring_calibrate::solid::{Formulation, Material, Supports, System};
use railspring_calibrate::superelement::Factor;
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};

/// Load of the benchmark, N.
const LOAD: f64 = 25e3;

const ELEMENT: Formulation = Formulation::IncompatibleModes;

fn pair() -> (Pair, PairMeshes) {
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.860).unwrap());
    let pair = Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap();
    let options =
        MeshOptions { contact_element: 6e-3, contact_element_along: 6e-3, ..MeshOptions::default() };
    let meshes = pair.mesh(0.555, &options).unwrap();
    (pair, meshes)
}

fn body(criterion: &mut Criterion) {
    let (_, meshes) = pair();
    let supports = Supports { held: meshes.rail.foot.clone(), ..Supports::default() };
    let rail = System::new(&meshes.rail, Material::STEEL, ELEMENT, &supports).unwrap();
    let interior = rail.numbering.interior;
    let matrix = rail.matrix(1.0, 0.0, &[]).unwrap();
    let factor = Factor::new(matrix.as_ref(), interior).unwrap();
    let mut group = criterion.benchmark_group(format!("rail of {} equations", rail.numbering.equations));
    group.sample_size(10);
    group.bench_function("assembly", |b| b.iter(|| rail.matrix(1.0, 0.0, &[]).unwrap()));
    group.bench_function("factor", |b| b.iter(|| Factor::new(black_box(matrix.as_ref()), interior).unwrap()));
    group.bench_function("condensation", |b| b.iter(|| black_box(&factor).retained_compliance()));
    group.finish();
}

fn contact(criterion: &mut Criterion) {
    let (pair, meshes) = pair();
    let bodies = meshes.condense(&pair, PairBody::of_pair(false), Material::STEEL, ELEMENT, &Silent).unwrap();
    let wheel_on_rail = |friction, field| {
        let contact = ContactConditions { friction, enforcement: Enforcement::Exact, field };
        let rail = pair.contact_body(PairBody::RailOnEnds, &bodies.rail_on_ends).unwrap();
        pair.wheel_on_rail(rail, pair.contact_body(PairBody::Wheel, &bodies.wheel).unwrap(), contact)
    };
    let (smooth, rough) =
        (wheel_on_rail(0.0, ContactField::Elements), wheel_on_rail(0.3, ContactField::Elements));
    let mut group = criterion.benchmark_group("contact");
    group.sample_size(10);
    let (lowering, largest_gap) = (Vector2::new(0.0, 50e-6), 100e-6);
    group.bench_function("pair", |b| b.iter(|| smooth.points_at(&lowering, largest_gap)));
    group.bench_function("press", |b| b.iter(|| smooth.press(LOAD, None).unwrap()));
    group.bench_function("press with friction", |b| b.iter(|| rough.press(LOAD, None).unwrap()));
    group.finish();
    let mut group = criterion.benchmark_group("contact on the fine grid");
    group.sample_size(10);
    let points = flat_grid((48, 48), 0.5e-3, |_, _| 0.0);
    let half_spaces = NearField::new(&HalfSpace::both(&Material::STEEL), &points, 3);
    let forces = vec![1.0; 3 * points.len()];
    let mut motion = forces.clone();
    group.bench_function("convolution", |b| b.iter(|| half_spaces.add_product(&forces, &mut motion)));
    for (name, friction) in [("load", 0.0), ("load with friction", 0.5)] {
        let fine = wheel_on_rail(friction, ContactField::Hybrid);
        let before = fine.press(LOAD, None).unwrap();
        group.bench_function(name, |b| {
            b.iter(|| {
                let state = fine.press(1.2 * LOAD, Some(&before)).unwrap();
                load_points(&fine, &[state], Reference::Foot).unwrap()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, body, contact);
criterion_main!(benches);
