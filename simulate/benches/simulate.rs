//! Time of one moving step: `cargo bench -p railspring-simulate`.
//!
//! S1002 on 60E1 with the published law: the published load case 4.1, a bridge of 25 m that the wheel crosses at 300 km/h, and a loaded wheel
//! that rolls on a rigid rail and on rails of 20 to 10,000 elements of a decimetre. What the beam costs is the ratio to the rigid rail.

use criterion::{
    BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime,
};
use railspring_calibrate::beam::{BeamSection, End, RailBeam};
use railspring_calibrate::law::StiffnessLaw;
use railspring_calibrate::monitor::Silent;
use railspring_calibrate::pair::Pair;
use railspring_calibrate::placement::TrackGeometry;
use railspring_calibrate::scenario::{HarmonicForce, Kelvin, Scenario};
use railspring_calibrate::section::{rail_section, wheel_section};
use railspring_calibrate::solid::Material;
use railspring_simulate::moving::{MovingModel, RailSupport, WheelSprings};

const GRAVITY: f64 = 9.81;

fn steel() -> Material {
    Material { damping: 6e-6, ..Material::STEEL }
}

fn pair() -> Pair {
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.858).unwrap());
    Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap()
}

fn model(pair: &Pair, beam: RailBeam) -> MovingModel {
    let springs =
        WheelSprings { horizontal: 6e8, normal: StiffnessLaw::published().into(), longitudinal: 6e8 };
    MovingModel::of_pair(pair, beam, &steel(), springs, 283.0)
}

/// The published load case 4.1.
fn published() -> Scenario {
    let suspension = Kelvin { stiffness: 1.2e6, damping: 4e4 };
    Scenario {
        suspended_mass: 6250.0,
        vertical_suspension: suspension,
        vertical_force: HarmonicForce { constant: 10e3, amplitude: 61.25e3, frequency: 10.0, phase: 0.0 },
        lateral_suspension: suspension,
        lateral_force: HarmonicForce::constant(20e3),
        ..Scenario::new(550, 5e-4, 0.5)
    }
}

/// A loaded wheel at `speed` (m/s), and where its weight has pressed it.
fn rolling(mut model: MovingModel, speed: f64, start_x: Option<f64>) -> (MovingModel, Scenario) {
    let scenario = Scenario {
        gravity: GRAVITY,
        suspended_mass: 6250.0,
        vertical_suspension: Kelvin { stiffness: 1.2e6, damping: 4e4 },
        speed,
        start_x,
        ..Scenario::new(600, 2.5e-4, 0.5)
    };
    model.initial.displacement[1] = StiffnessLaw::published().displacement((283.0 + 6250.0) * GRAVITY);
    (model, scenario)
}

fn bridge() -> RailBeam {
    let (bending, mass) = (3.5e10 * 1.3901, 18_358.0);
    let section = BeamSection {
        axial: 1e12,
        bending_y: bending,
        bending_z: bending,
        shear_y: f64::INFINITY,
        shear_z: f64::INFINITY,
        torsion: 1e12,
        mass,
        rotary_y: 0.0,
        rotary_z: 0.0,
        polar: mass,
        centroid: [0.0; 2],
    };
    RailBeam::new(section, 25.0, 20, 0.0, [End::Pinned; 2]).unwrap()
}

fn timed(group: &mut BenchmarkGroup<WallTime>, name: &str, (model, scenario): (MovingModel, Scenario)) {
    group.throughput(Throughput::Elements(scenario.steps as u64));
    group.bench_function(name, |b| b.iter(|| model.run(&scenario, &Silent).unwrap()));
}

fn moving(criterion: &mut Criterion) {
    let pair = pair();
    let mut group = criterion.benchmark_group("moving step");
    group.sample_size(10);
    let stub = pair.beam(&steel(), 0.555, 20).unwrap();
    timed(&mut group, "load case 4.1", (model(&pair, stub.clone()), published()));
    timed(&mut group, "bridge", rolling(model(&pair, bridge()), 300.0 / 3.6, Some(0.0)));
    let mut rigid = model(&pair, stub);
    rigid.support = RailSupport::Rigid;
    timed(&mut group, "rigid rail", rolling(rigid, 5.0, None));
    for elements in [20, 100, 1000, 10_000] {
        let beam = pair.beam(&steel(), 0.1 * elements as f64, elements).unwrap();
        let name = format!("rail of {elements} elements");
        timed(&mut group, &name, rolling(model(&pair, beam), 5.0, None));
    }
    group.finish();
}

criterion_group!(benches, moving);
criterion_main!(benches);
