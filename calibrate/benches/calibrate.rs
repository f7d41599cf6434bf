//! Time of the steps of a calibration: `cargo bench -p railspring-calibrate`.
//!
//! S1002 on 60E1, contact elements of 6 mm, coarse enough for each step to take well below a second: assembly, factor and
//! condensation of the rail, pairing of the surfaces, pressing without and with friction. What counts is how the
//! steps compare with each other, and with themselves before a change.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::Vector2;
use railspring_calibrate::calibration::{Enforcement, WheelOnRail};
use railspring_calibrate::contact::Surface;
use railspring_calibrate::mesh::{HexMesh, MeshOptions, mesh_rail, mesh_wheel};
use railspring_calibrate::placement::{PlacedRail, TrackGeometry, place_rail, touch};
use railspring_calibrate::section::{WheelSection, rail_section, wheel_section};
use railspring_calibrate::solid::{Formulation, Material, Supports, System};
use railspring_calibrate::superelement::{Factor, Superelement};

/// Load of the benchmark, N.
const LOAD: f64 = 25e3;

struct Bodies {
    placed: PlacedRail,
    wheel: WheelSection,
    tape: Vector2<f64>,
    rail_mesh: HexMesh,
    wheel_mesh: HexMesh,
}

impl Bodies {
    fn new() -> Self {
        let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.860).unwrap());
        let track = TrackGeometry::standard();
        let placed = place_rail(&rail, &track).unwrap();
        let first = touch(&placed, &wheel.running, track.tape_y()).unwrap();
        let options =
            MeshOptions { contact_element: 6e-3, contact_element_along: 6e-3, ..MeshOptions::default() };
        let rail_mesh = mesh_rail(&rail, &placed, 0.555, &options).unwrap();
        let wheel_mesh = mesh_wheel(&wheel, &options).unwrap();
        Self { placed, wheel, tape: Vector2::new(track.tape_y(), first.tape_z), rail_mesh, wheel_mesh }
    }

    fn rail(&self) -> System<'_> {
        let held = self.rail_mesh.foot.clone();
        system(&self.rail_mesh, &Supports { held, ..Supports::default() })
    }

    fn wheel(&self) -> System<'_> {
        let followers = self.wheel_mesh.bore.clone();
        system(&self.wheel_mesh, &Supports { followers, ..Supports::default() })
    }
}

fn system<'a>(mesh: &'a HexMesh, supports: &Supports) -> System<'a> {
    System::new(mesh, Material::STEEL, Formulation::IncompatibleModes, supports).unwrap()
}

fn body(criterion: &mut Criterion) {
    let bodies = Bodies::new();
    let rail = bodies.rail();
    let interior = rail.numbering.interior;
    let matrix = rail.matrix(1.0, 0.0, &[]).unwrap();
    let factor = Factor::new(&matrix, interior).unwrap();
    let mut group = criterion.benchmark_group(format!("rail of {} equations", rail.numbering.equations));
    group.sample_size(10);
    group.bench_function("assembly", |b| b.iter(|| rail.matrix(1.0, 0.0, &[]).unwrap()));
    group.bench_function("factor", |b| b.iter(|| Factor::new(black_box(&matrix), interior).unwrap()));
    group.bench_function("condensation", |b| b.iter(|| black_box(&factor).retained_compliance()));
    group.finish();
}

fn contact(criterion: &mut Criterion) {
    let bodies = Bodies::new();
    let rail = Superelement::new(bodies.rail()).unwrap();
    let wheel = Superelement::new(bodies.wheel()).unwrap();
    let with_friction = |friction| WheelOnRail {
        rail: &rail.compliance,
        wheel: &wheel.compliance,
        rail_surface: Surface::extruded(&bodies.placed.curve, &bodies.rail_mesh.contact),
        wheel_surface: Surface::revolved(
            &bodies.wheel.running,
            &bodies.wheel_mesh.contact,
            bodies.wheel.radius,
            bodies.tape,
        ),
        friction,
        enforcement: Enforcement::Exact,
    };
    let (smooth, rough) = (with_friction(0.0), with_friction(0.3));
    let mut group = criterion.benchmark_group("contact");
    group.sample_size(10);
    let (lowering, largest_gap) = (Vector2::new(0.0, 50e-6), 100e-6);
    group.bench_function("pair", |b| b.iter(|| smooth.points_at(&lowering, largest_gap)));
    group.bench_function("press", |b| b.iter(|| smooth.press(LOAD, None).unwrap()));
    group.bench_function("press with friction", |b| b.iter(|| rough.press(LOAD, None).unwrap()));
    group.finish();
}

criterion_group!(benches, body, contact);
criterion_main!(benches);
