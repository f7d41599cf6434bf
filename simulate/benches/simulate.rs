//! Time of one moving step: `cargo bench -p railspring-simulate`.
//!
//! S1002 on 60E1, with the published element and its law, and with a condensed element of round numbers. Load
//! cases are the published 4.1, a bridge of 25 m that the wheel crosses at 300 km/h, and a loaded wheel that
//! rolls on a rigid rail and on rails of 20 to 10,000 elements of a decimetre. The cost of the beam is the
//! ratio to the rigid rail. A batch of load cases runs on one thread and on more. A wheelset rolls on two
//! rails on sleepers, by a law without profiles and with profiles, across the track as well.

use criterion::{
    BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime,
};
use nalgebra::{Matrix3, Vector2, Vector3};
use railspring_calibrate::beam::{BeamSection, RailBeam, Torsion};
use railspring_calibrate::law::StiffnessLaw;
use railspring_calibrate::pair::Pair;
use railspring_calibrate::section_analysis::rail_properties;
use railspring_calibrate::solid::Material;
use railspring_element::law::{StripPlace, StripStiffness};
use railspring_element::modulus::StripModulus;
use railspring_element::pair_element::PairElement;
use railspring_element::relief::Influence;
use railspring_element::wheel::{ElasticWheel, RimMode};
use railspring_profiles::error::Result;
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};
use railspring_simulate::cases::{GRAVITY, bridge, constant_lateral_force, crossing, rolling};
use railspring_simulate::element::condensed::CondensedModel;
use railspring_simulate::element::published::{
    MovingModel, MovingRun, RailSupport, WheelSprings, WheelsetContact, WheelsetSide,
};
use railspring_simulate::time::function::TimeFunction;
use railspring_simulate::time::scenario::{Kelvin, Scenario};
use railspring_simulate::track::{
    Across, AcrossCase, Carrier, Direction, Layers, LayersAcross, LineBeam, Onto, Running, Start,
    StartAcross, SwayingWheelset, Track, TrackCase, TwoRails, UnevenRail, Unevenness, Way, Wheels, Wheelset,
};
use rayon::prelude::*;

/// Mass of the wheel, kg.
const MASS: f64 = 283.0;

fn steel() -> Material {
    Material { damping: 6e-6, ..Material::STEEL }
}

fn pair() -> Pair {
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.858).unwrap());
    Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap()
}

/// Both contact elements on a rail.
struct Models {
    published: MovingModel,
    condensed: CondensedModel,
}

impl Models {
    fn new(pair: &Pair, beam: RailBeam) -> Self {
        let springs =
            WheelSprings { horizontal: 6e8, normal: StiffnessLaw::published().into(), longitudinal: 6e8 };
        Self {
            published: MovingModel::of_pair(pair, beam.clone(), [&steel(); 2], springs, MASS),
            condensed: CondensedModel::of_pair(pair, beam, [&steel(); 2], element(pair)),
        }
    }

    fn on_rigid_ground(mut self) -> Self {
        self.published.support = RailSupport::Rigid;
        self.condensed.support = RailSupport::Rigid;
        self
    }

    /// Starts where the weight of a load case has pressed the wheel.
    fn settled(mut self, scenario: &Scenario) -> Self {
        let weight = (MASS + scenario.suspended_mass) * GRAVITY;
        self.published.initial.displacement[1] = StiffnessLaw::published().displacement(weight);
        let pressed = self.condensed.pressed(Vector2::y(), weight, scenario.friction).unwrap();
        self.condensed.initial.displacement[1] = pressed.displacement;
        self
    }
}

/// A condensed element with as many modes as a solid wheel has, and round numbers of its size.
fn element(pair: &Pair) -> PairElement {
    let mode = |n: u32| {
        let (hertz, sign) = (160.0 * f64::from(n), if n.is_multiple_of(2) { 1.0 } else { -1.0 });
        RimMode {
            square: (std::f64::consts::TAU * hertz).powi(2),
            rim: Vector3::new(0.06 * sign, 0.01, -0.5 * sign),
            coupling: Vector3::new(2.0, 2.0 * sign, -0.3),
        }
    };
    let modulus = StripModulus { normal: 2.5e11, hardening: 0.0, tangential: 1e11, relief: 1.0 };
    let relieving = Influence { flexibility: 2.8e-12 };
    PairElement {
        wheel: ElasticWheel {
            mass: Matrix3::from_diagonal(&Vector3::new(MASS, MASS, 19.0)),
            hub: [0.0, -pair.wheel.radius],
            modes: (1..=12).map(mode).collect(),
            rest: Matrix3::from_diagonal(&Vector3::new(1.5e-10, 1e-10, 5e-8)),
        },
        head: Matrix3::from_diagonal(&Vector3::new(6e-9, 6e-11, 6e-7)),
        held_end: None,
        strips: StripStiffness::new(vec![StripPlace { rail_s: 0.0, modulus }], relieving, 0.0),
        misfit: [0.0; 2],
    }
}

/// Both elements on a load case.
fn timed(group: &mut BenchmarkGroup<WallTime>, name: &str, models: &Models, scenario: &Scenario) {
    group.throughput(Throughput::Elements(scenario.steps as u64));
    let mut of = |element: &str, run: &dyn Fn() -> Result<MovingRun>| {
        group.bench_function(format!("{name}, {element}"), |b| b.iter(|| run().unwrap()));
    };
    of("published", &|| models.published.run(scenario, &Silent));
    of("condensed", &|| models.condensed.run(scenario, &Silent));
}

fn moving(criterion: &mut Criterion) {
    let pair = pair();
    let mut group = criterion.benchmark_group("moving step");
    group.sample_size(10);
    let stub = || Models::new(&pair, pair.beam(&steel(), 0.555, 20).unwrap());
    timed(&mut group, "load case 4.1", &stub(), &constant_lateral_force());
    let on_bridge = Models::new(&pair, bridge(20).unwrap()).settled(&crossing());
    timed(&mut group, "bridge", &on_bridge, &crossing());
    timed(&mut group, "rigid rail", &stub().on_rigid_ground().settled(&rolling()), &rolling());
    for elements in [20, 100, 1000, 10_000] {
        let beam = pair.beam(&steel(), 0.1 * elements as f64, elements).unwrap();
        let name = format!("rail of {elements} elements");
        timed(&mut group, &name, &Models::new(&pair, beam).settled(&rolling()), &rolling());
    }
    group.finish();
}

/// Two hundred load cases of 30 ms, each with another lateral force, on more and more threads.
fn batch(criterion: &mut Criterion) {
    const CASES: u64 = 200;
    let pair = pair();
    let models = Models::new(&pair, pair.beam(&steel(), 0.555, 20).unwrap());
    let case = |n: u64| Scenario {
        steps: 60,
        lateral_force: TimeFunction::constant(20e3 * n as f64 / CASES as f64),
        ..constant_lateral_force()
    };
    let mut group = criterion.benchmark_group("batch of 200 load cases");
    group.sample_size(10).throughput(Throughput::Elements(CASES));
    let most = std::thread::available_parallelism().map_or(1, usize::from);
    for threads in (0..).map(|n| 1 << n).take_while(|threads| *threads <= most) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut of = |element: &str, run: &(dyn Fn(&Scenario) -> Result<MovingRun> + Sync)| {
            let all = || {
                (0..CASES).into_par_iter().map(|n| run(&case(n)).unwrap().history.rows.len()).sum::<usize>()
            };
            group.bench_function(format!("{element}, {threads} threads"), |b| b.iter(|| pool.install(all)));
        };
        of("published", &|scenario| models.published.run(scenario, &Silent));
        of("condensed", &|scenario| models.condensed.run(scenario, &Silent));
    }
    group.finish();
}

/// A wheelset on two rails with sleepers at every sixth node, with masses on ballast; a step is that of both rails.
fn on_sleepers(elements: usize) -> TrackCase {
    let pitch = 0.1;
    let properties = rail_properties(&rail_section("60E1").unwrap()).unwrap();
    let section = BeamSection::rail(&properties, &steel(), 1.0, Torsion::SaintVenant).unwrap();
    let layer = |stiffness: f64, damping: f64| Kelvin { stiffness, damping };
    let sleeper = |node: usize| Layers {
        of: Carrier::Rail,
        x: node as f64 * pitch,
        direction: Direction::Vertical,
        upper: layer(1e8, 3e4),
        below: Some((150.0, layer(5e7, 5e4))),
        onto: Onto::Ground,
    };
    let length = elements as f64 * pitch;
    let wheelset = Wheelset {
        mass: 1800.0,
        inertia: 1000.0,
        above: 10_000.0,
        above_inertia: 5000.0,
        suspension: layer(1.2e6, 4e4),
        half_track: 0.75,
        half_base: 1.0,
    };
    TrackCase {
        track: Some(Track {
            length,
            elements,
            rail: LineBeam { section, damping: 6e-6, mass_damping: 0.0 },
            bridge: None,
            bed: None,
            held: Vec::new(),
            layers: (0..=elements).step_by(6).map(sleeper).collect(),
        }),
        running: Running::Wheelset(wheelset),
        wheels: Wheels {
            law: StiffnessLaw::published().into(),
            damping: 0.0,
            unevenness: vec![Unevenness::default(); 2],
        },
        steps: 600,
        time_step: 2.5e-4,
        inner_steps: 1,
        gravity: GRAVITY,
        force: TimeFunction::default(),
        roll: TimeFunction::constant(5e3),
        ground: TimeFunction::default(),
        way: Way::uniform(0.4 * length, 5.0, 0.0, 1.0),
        start: Start::Equilibrium,
        probes: Vec::new(),
    }
}

fn track(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step of a wheelset on sleepers");
    group.sample_size(10);
    for elements in [100, 1000, 10_000] {
        let case = on_sleepers(elements);
        group.throughput(Throughput::Elements(case.steps as u64));
        group.bench_function(format!("{elements} elements a rail"), |bencher| {
            bencher.iter(|| case.run(&Silent).unwrap().rows.len());
        });
    }
}

/// A wheelset with profiles on the same sleepers, which hold the rails laterally and against twist as well.
fn across_sleepers(elements: usize) -> AcrossCase {
    let in_plane = on_sleepers(elements);
    let pair = pair();
    let side = || WheelsetSide {
        rail: pair.placed.clone(),
        node_line: pair.node_line(),
        wheel: pair.wheel.running.clone(),
        wheel_radius: pair.wheel.radius,
        tape: nalgebra::Point2::new(pair.tape_y, pair.touch.tape_z),
        arm: pair.tape_y,
        springs: WheelSprings {
            horizontal: 6e8,
            normal: StiffnessLaw::published().into(),
            longitudinal: 6e8,
        },
    };
    let layer = |stiffness: f64, damping: f64| Kelvin { stiffness, damping };
    let rail = in_plane.track.unwrap();
    let at = |x: f64| {
        let below = Some((150.0, layer(2e7, 3e4)));
        let lateral = Across::Lateral;
        [
            LayersAcross { x, direction: lateral, below_line: 0.05, upper: layer(5e7, 2e4), below },
            LayersAcross {
                x,
                direction: Across::Twist,
                below_line: 0.0,
                upper: layer(2e5, 60.0),
                below: None,
            },
        ]
    };
    let layers = rail.layers.iter().flat_map(|layers| at(layers.x)).collect();
    AcrossCase {
        rails: Some(TwoRails {
            rail,
            angle: pair.placed.angle,
            bed: None,
            bed_below_line: 0.0,
            twist_bed: None,
            held: Vec::new(),
            layers,
        }),
        wheelset: SwayingWheelset {
            mass: 1800.0,
            inertia: 1000.0,
            above: 10_000.0,
            above_inertia: 5000.0,
            height: 1.0,
            vertical: layer(1.2e6, 4e4),
            lateral: layer(3e6, 3e4),
            half_base: 1.0,
        },
        contact: WheelsetContact {
            sides: [side(), side()],
            friction: 0.3,
            penalty: MovingModel::DEFAULT_PENALTY,
            node_spacing: MovingModel::DEFAULT_NODE_SPACING,
        },
        uneven: [UnevenRail::default(), UnevenRail::default()],
        steps: in_plane.steps,
        time_step: in_plane.time_step,
        inner_steps: 1,
        gravity: GRAVITY,
        lateral_force: TimeFunction::constant(3e3),
        vertical_force: TimeFunction::default(),
        roll: TimeFunction::default(),
        torsion: Vec::new(),
        ground: [TimeFunction::default(), TimeFunction::default()],
        way: in_plane.way,
        start: StartAcross::Equilibrium,
        probes: Vec::new(),
    }
}

fn across(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step of a wheelset across the track");
    group.sample_size(10);
    for elements in [100, 1000, 2000] {
        let case = across_sleepers(elements);
        group.throughput(Throughput::Elements(case.steps as u64));
        group.bench_function(format!("{elements} elements a rail"), |bencher| {
            bencher.iter(|| case.run(&Silent).unwrap().rows.len());
        });
    }
}

criterion_group!(benches, moving, batch, track, across);
criterion_main!(benches);
