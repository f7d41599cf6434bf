//! Time of one moving step: `cargo bench -p railspring-simulate`.
//!
//! S1002 on 60E1 with the published law, 10 kN down and 2 kN towards the flange, steps of 0.1 ms on a beam of ten
//! elements and on a rigid rail. What the beam costs is the ratio of the two.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use railspring_calibrate::law::StiffnessLaw;
use railspring_calibrate::monitor::Silent;
use railspring_calibrate::pair::Pair;
use railspring_calibrate::placement::TrackGeometry;
use railspring_calibrate::scenario::{HarmonicForce, Scenario};
use railspring_calibrate::section::{rail_section, wheel_section};
use railspring_calibrate::solid::Material;
use railspring_simulate::moving::{MovingModel, RailSupport, WheelSprings};

const STEPS: usize = 200;

fn model(rigid: bool) -> MovingModel {
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.860).unwrap());
    let pair = Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap();
    let steel = Material { damping: 6e-6, ..Material::STEEL };
    let beam = pair.beam(&steel, 0.555, 10).unwrap();
    let springs =
        WheelSprings { horizontal: 9e8, normal: StiffnessLaw::published().into(), longitudinal: 9e8 };
    let mut model = MovingModel::of_pair(&pair, beam, &steel, springs, 300.0);
    if rigid {
        model.support = RailSupport::Rigid;
    }
    model
}

fn scenario() -> Scenario {
    Scenario {
        vertical_force: HarmonicForce::constant(10e3),
        lateral_force: HarmonicForce::constant(2e3),
        ..Scenario::new(STEPS, 1e-4, 0.3)
    }
}

fn moving(criterion: &mut Criterion) {
    let scenario = scenario();
    let mut group = criterion.benchmark_group("moving step");
    group.throughput(Throughput::Elements(STEPS as u64)).sample_size(10);
    for (name, rigid) in [("rigid rail", true), ("beam of ten elements", false)] {
        let model = model(rigid);
        group.bench_function(name, |b| b.iter(|| model.run(&scenario, &Silent).unwrap()));
    }
    group.finish();
}

criterion_group!(benches, moving);
criterion_main!(benches);
