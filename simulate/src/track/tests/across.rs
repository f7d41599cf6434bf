//! A wheelset across the track.

use nalgebra::Point2;

use super::*;
use crate::element::published::{Derailment, WheelSprings, WheelsetContact, WheelsetSide};
use crate::time::function::HarmonicForce;
use railspring_calibrate::beam::Torsion;
use railspring_calibrate::section_analysis::rail_properties;
use railspring_calibrate::solid::Material;
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::{TrackGeometry, place_rail, touch};
use railspring_profiles::section::{rail_section, wheel_section};

const GRAVITY: f64 = 9.81;

/// A wheel of a profile on 60E1, shifted to its field side (m).
fn side(wheel: &str, shift: f64) -> WheelsetSide {
    let geometry = TrackGeometry::standard();
    let section = rail_section("60E1").unwrap();
    let rail = place_rail(&section, &geometry).unwrap();
    let wheel = wheel_section(wheel, 0.86).unwrap();
    let arm = geometry.tape_y(&wheel.running);
    let touch = touch(&rail, &wheel.running, arm + shift).unwrap();
    let properties = rail_properties(&section).unwrap();
    let node_line = rail.to_world(&Point2::new(0.0, section.height - properties.shear_centre_height));
    WheelsetSide {
        rail,
        node_line,
        wheel: wheel.running,
        wheel_radius: wheel.radius,
        tape: Point2::new(arm + shift, touch.tape_z),
        arm,
        springs: WheelSprings {
            horizontal: 6e8,
            normal: StiffnessLaw::published().into(),
            longitudinal: 6e8,
        },
    }
}

fn contact(sides: [WheelsetSide; 2]) -> WheelsetContact {
    WheelsetContact { sides, friction: 0.3, penalty: 1e12, node_spacing: 0.25e-3 }
}

fn wheelset() -> SwayingWheelset {
    SwayingWheelset {
        mass: 1800.0,
        inertia: 1000.0,
        above: 10_000.0,
        above_inertia: 6000.0,
        height: 1.2,
        vertical: kelvin(1.2e6, 4e4),
        lateral: kelvin(3e6, 3e4),
        half_base: 1.0,
    }
}

/// 60E1 on sleepers at every `every`th node.
fn rails(elements: usize, pitch: f64, every: usize) -> TwoRails {
    let section = rail_section("60E1").unwrap();
    let properties = rail_properties(&section).unwrap();
    let beam = railspring_calibrate::beam::BeamSection::rail(
        &properties,
        &Material::STEEL,
        1.0,
        Torsion::SaintVenant,
    )
    .unwrap();
    let places = (0..=elements).step_by(every).map(|node| node as f64 * pitch);
    let sleeper = |x: f64| Layers {
        of: Carrier::Rail,
        x,
        direction: Direction::Vertical,
        upper: kelvin(1e8, 3e4),
        below: Some((150.0, kelvin(5e7, 5e4))),
        onto: Onto::Ground,
    };
    let across = |x: f64| {
        let foot = properties.shear_centre_height;
        let upper = kelvin(5e7, 2e4);
        let below = Some((150.0, kelvin(2e7, 3e4)));
        [
            LayersAcross { x, direction: Across::Lateral, below_line: foot, upper, below },
            LayersAcross {
                x,
                direction: Across::Twist,
                below_line: 0.0,
                upper: kelvin(2e5, 60.0),
                below: None,
            },
        ]
    };
    TwoRails {
        rail: Track {
            length: elements as f64 * pitch,
            elements,
            rail: LineBeam { section: beam, damping: 1e-6, mass_damping: 0.0 },
            bridge: None,
            bed: None,
            held: Vec::new(),
            layers: places.clone().map(sleeper).collect(),
        },
        angle: -0.025,
        bed: None,
        bed_below_line: 0.0,
        twist_bed: None,
        held: Vec::new(),
        layers: places.flat_map(across).collect(),
    }
}

fn across(rails: Option<TwoRails>, way: Way, [steps, duration]: [f64; 2]) -> AcrossCase {
    AcrossCase {
        rails,
        wheelset: wheelset(),
        contact: contact([side("S1002", 0.0), side("S1002", 0.0)]),
        uneven: [UnevenRail::default(), UnevenRail::default()],
        steps: steps as usize,
        time_step: duration / steps,
        inner_steps: 1,
        gravity: GRAVITY,
        lateral_force: TimeFunction::default(),
        vertical_force: TimeFunction::default(),
        roll: TimeFunction::default(),
        torsion: Vec::new(),
        ground: [TimeFunction::default(), TimeFunction::default()],
        way,
        start: StartAcross::Equilibrium,
        probes: Vec::new(),
    }
}

fn ran(case: &AcrossCase) -> AcrossRun {
    case.run(&Silent).unwrap()
}

fn sine(amplitude: f64, frequency: f64) -> TimeFunction {
    let harmonics = vec![HarmonicForce { amplitude, frequency, ..HarmonicForce::NONE }];
    TimeFunction { harmonics, table: Vec::new() }
}

/// The row of a mirror image.
fn reflected(row: &AcrossRow) -> AcrossRow {
    let turned = |[y, z, roll]: [f64; 3]| [-y, z, -roll];
    let [right, left] = row.suspension;
    let mut wheels = row.wheels.clone();
    wheels.reverse();
    AcrossRow {
        axle: turned(row.axle),
        above: row.above.map(turned),
        above_acceleration: [-row.above_acceleration[0], row.above_acceleration[1]],
        suspension: [left, right].map(|[y, z]| [-y, z]),
        wheels,
        ..row.clone()
    }
}

/// Two cases are the mirror images of each other, to the last bit.
fn assert_mirrored(case: &AcrossCase) -> AcrossRun {
    let run = ran(case);
    let image = ran(&case.clone().mirrored());
    assert_eq!(run.rows.len(), image.rows.len());
    for (row, image) in run.rows.iter().zip(&image.rows) {
        // -0 is 0
        assert!(*row == reflected(image), "{row:?} {image:?}");
    }
    run
}

/// Goal: right and left wheels and rails of other profiles, heights and places, with forces, moments and ground that move, give the mirrored numbers when
/// they are exchanged; the wheels slide and stick.
#[test]
fn the_mirror_image_has_the_mirrored_numbers() {
    let mut case = across(Some(rails(60, 0.1, 6)), Way::uniform(1.0, 20.0, 0.0, 1.0), [300.0, 0.15]);
    case.contact.sides = [side("S1002", 1e-3), side("S1002", -1e-3)];
    case.contact.sides[1].springs.horizontal = 5e8;
    case.lateral_force = sine(25e3, 9.0);
    case.roll = sine(9e3, 4.0);
    case.ground = [sine(1.5, 7.0), sine(0.7, 11.0)];
    case.torsion = vec![RailTorsion { rail: 0, x: 2.2, moment: sine(700.0, 13.0) }];
    case.probes = vec![ProbeAcross { name: "here".into(), rail: 1, x: 2.0 }];
    let wave = |height: f64| Irregularity::Waves(vec![[9.0, height, 0.3]]);
    case.uneven[0].vertical.rail.push(wave(5e-4));
    case.uneven[1].lateral.push(wave(8e-4));
    let run = assert_mirrored(&case);
    assert_eq!(run.ending, AcrossEnding::Completed);
    let modes = |mode| {
        let of =
            |row: &AcrossRow| row.wheels.iter().any(|w| w.contact.contacts.iter().any(|c| c.mode == mode));
        run.rows.iter().filter(|row| of(row)).count()
    };
    use crate::time::history::ContactMode;
    assert!(modes(ContactMode::Stick) > 20 && modes(ContactMode::Slip) > 20, "{run:?}");
    assert!(run.rows.iter().any(|row| row.probes[0].torsion.abs() > 1.0));
}

/// Source: statics; energy of a falling mass. Goal: a wheelset that falls with a sideways speed on both rails goes against one flange, its mirror image against the other one with the
/// same numbers. Falling straight, each wheel has the largest force (N) of half of its mass. DISCRETISATION: (ω·Δt)²/8 of the peak, with the penalty's thousandth.
#[test]
fn wheelsets_fall_on_two_rails_as_mirror_images() {
    const DISCRETISATION: f64 = 4e-3;
    let mut case = across(Some(rails(40, 0.1, 6)), Way::uniform(2.0, 0.0, 0.0, 1.0), [400.0, 0.04]);
    case.start = StartAcross::Above { height: 2e-3, velocity: [0.4, 0.1] };
    let run = assert_mirrored(&case);
    let flange = run.rows.iter().map(|row| row.wheels[0].contact.lateral_force).fold(0.0, f64::max);
    assert!(flange > 30e3, "{flange}");
    let speed = 0.2;
    let mut straight = across(None, Way::uniform(2.0, 0.0, 0.0, 1.0), [800.0, 8e-3]);
    straight.wheelset.above = 0.0;
    straight.gravity = 0.0;
    straight.contact.friction = 0.0;
    straight.start = StartAcross::Above { height: 1e-9, velocity: [0.0, speed] };
    let run = assert_mirrored(&straight);
    let exact = railspring_calibrate::analytic::drop::drop(&StiffnessLaw::published(), 900.0, speed);
    for wheel in 0..2 {
        let peak = run.rows.iter().map(|row| row.wheels[wheel].contact.vertical_force).fold(0.0, f64::max);
        assert!((peak / exact.peak_force - 1.0).abs() < DISCRETISATION, "{peak} {}", exact.peak_force);
    }
}

/// Source: statics. Goal: a wheelset pushed by 0 to 30 kN at the centre of the mass above stands in balance. The wheels carry the weight and the lateral force (N). On the axle the moments (N·m) of the contact
/// forces at their places, of the suspensions and of the weight that has gone aside are in balance, and so are those on the mass above. It stays there when the run goes on.
/// SOLVER: the balance of a step, 1e-8 of the forces, and that of the start, 1e-9; DISCRETISATION: the direction of a contact's force is that at its middle, a contact being no wider than 2 mm on radii of 13 mm and more.
#[test]
fn a_pushed_wheelset_is_in_balance() {
    const SOLVER: f64 = 1e-7;
    const DISCRETISATION: f64 = 2e-3;
    for (force, on) in [(0.0, None), (6e3, None), (20e3, None), (30e3, Some(rails(60, 0.1, 6)))] {
        let mut case = across(on, Way::uniform(3.0, 0.0, 0.0, 1.0), [50.0, 0.05]);
        case.lateral_force = TimeFunction::constant(force);
        let set = case.wheelset;
        let run = ran(&case);
        let row = &run.rows[0];
        let size = set.weight(GRAVITY);
        let [right, left] = row.wheels.each_ref().map(|wheel| &wheel.contact);
        let down = right.vertical_force + left.vertical_force;
        let aside = right.lateral_force - left.lateral_force;
        assert!((down - size).abs() < SOLVER * size, "{force}: {down} {size}");
        assert!((aside - force).abs() < SOLVER * size, "{force}: {aside}");
        // on the axle, about its centre
        let mut moment = 0.0;
        for (index, wheel) in [right, left].into_iter().enumerate() {
            let side = &case.contact.sides[index];
            let toward = [1.0, -1.0][index];
            let roll = nalgebra::Rotation2::new(toward * row.axle[2]);
            for contact in &wheel.contacts {
                let s = side.wheel.closest(&contact.wheel).0;
                let slope = side.wheel.evaluate(s).1.normalize();
                // up, into the wheel
                let normal = roll * nalgebra::Vector2::new(slope.y, -slope.x);
                let normal = if normal.y > 0.0 { -normal } else { normal };
                let along =
                    nalgebra::Vector2::new(contact.wheel.x + side.arm, contact.wheel.y + side.wheel_radius);
                let place = roll * along;
                let force = normal * contact.normal_force;
                moment += toward * (place.x * force.y - place.y * force.x);
            }
        }
        let above = row.above.unwrap();
        let stroke = above[0] - row.axle[0] - set.height * above[2];
        let weight = set.above * GRAVITY;
        let [of_right, of_left] = row.suspension;
        moment += set.half_base * (of_right[1] - of_left[1]) + weight * stroke;
        let scale = size * case.contact.sides[0].arm;
        assert!(moment.abs() < DISCRETISATION * scale, "{force}: {moment} of {scale}");
        // on the mass above, about its centre: the springs hold it from below, with its weight along the axle's vertical
        let held = of_right[0] + of_left[0] - weight * row.axle[2];
        assert!((held - force).abs() < SOLVER * size, "{force}: {held}");
        let on_mass = -set.half_base * (of_right[1] - of_left[1])
            + set.height * (of_right[0] + of_left[0])
            + weight * set.height * (above[2] - row.axle[2]);
        assert!(on_mass.abs() < SOLVER * scale, "{force}: {on_mass}");
        assert!(force == 0.0 || moment.abs() < 0.1 * force * set.height);
        let last = run.rows.last().unwrap();
        assert!((last.axle[0] - row.axle[0]).abs() < 1e-5, "{force}: {:?} {:?}", row.axle, last.axle);
    }
}

/// Source: the equation of a mass on a spring on a ground with the acceleration A·sin(ωt), from rest: u = −A/(ω0² − ω²)·(sin ωt − ω/ω0·sin ω0·t). Goal: the lateral force (N) in the
/// suspensions of a mass at the height of the axle, whose wheels stick, for frequencies from a fifth to three times its own. MODEL: the axle gives way by a thousandth of the springs, which costs
/// half of that in the frequency, over three periods; with damping the closed solution of the particular motion.
#[test]
fn a_mass_on_a_wheelset_follows_a_sine_of_the_ground() {
    use std::f64::consts::TAU;
    const MODEL: f64 = 5e-3;
    let (stiffness, amplitude) = (1e5, 0.4);
    let own = (2.0 * stiffness / wheelset().above).sqrt();
    for ratio in [0.2, 0.5, 0.9, 1.1, 1.7, 3.0] {
        let omega = ratio * own;
        let duration = 3.0 * TAU / own.min(omega);
        let steps = (duration * own.max(omega) / TAU * 400.0).ceil();
        let mut case = across(None, Way::uniform(0.0, 0.0, 0.0, 1.0), [steps, duration]);
        case.wheelset.height = 0.0;
        case.wheelset.lateral = kelvin(stiffness, 0.0);
        case.contact.friction = 2.0;
        case.ground[0] = sine(amplitude, omega / TAU);
        let run = ran(&case);
        let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
        for row in &run.rows {
            let t = row.time;
            let u = -amplitude / (own * own - omega * omega)
                * ((omega * t).sin() - omega / own * (own * t).sin());
            let [right, left] = row.suspension;
            worst = worst.max((right[0] + left[0] - 2.0 * stiffness * u).abs());
            largest = largest.max((2.0 * stiffness * u).abs());
        }
        assert!(largest > 1e3, "{ratio}: {largest}");
        assert!(worst < MODEL * largest, "{ratio}: {worst} of {largest}");
    }
}

/// Source: statics of a flange of angle δ without creep, up which a wheel slides against friction: Q/P = (tan δ + µ)/(1 − µ·tan δ). Goal: a force at the height of the rails that grows sideways turns a wheelset over its flange. The run
/// ends as a derailment of the right wheel, which climbs while it carries load, at that Q/P; mirrored, the left one does. MODEL: the steepest place of 70° is short, and the force grows by a hundredth while the wheel passes it.
#[test]
fn a_wheelset_beyond_its_flange_climbs_out() {
    const MODEL: f64 = 0.04;
    for friction in [0.0, 0.1] {
        let mut case = across(Some(rails(40, 0.1, 6)), Way::uniform(1.0, 0.0, 0.0, 1.0), [1000.0, 1.0]);
        case.inner_steps = 2;
        case.wheelset.above = 0.0;
        (case.wheelset.mass, case.wheelset.inertia) = (11_800.0, 7000.0);
        case.contact.friction = friction;
        let growing =
            |most: f64| TimeFunction { harmonics: Vec::new(), table: vec![(0.0, 0.0), (1.0, most)] };
        case.lateral_force = growing(400e3);
        case.roll = growing(-400e3 * 0.43);
        let run = if friction > 0.0 { assert_mirrored(&case) } else { ran(&case) };
        let AcrossEnding::Derailed { time, wheel: 0, how: Derailment::Climbed } = run.ending else {
            panic!("{:?}", run.ending)
        };
        let flange = 70.0_f64.to_radians().tan();
        let limit = (flange + friction) / (1.0 - friction * flange);
        let ratio =
            |row: &AcrossRow| row.wheels[0].contact.lateral_force / row.wheels[0].contact.vertical_force;
        let at_rest = run.rows[0].wheels[0].contact.tip_height;
        let slow = run.rows.iter().take_while(|row| row.wheels[0].contact.tip_height < at_rest + 10e-3);
        let largest = slow.map(ratio).fold(0.0, f64::max);
        assert!((largest / limit - 1.0).abs() < MODEL, "{friction}: {largest} {limit} at {time}");
        if friction > 0.0 {
            let image = ran(&case.clone().mirrored());
            assert_eq!(image.ending, AcrossEnding::Derailed { time, wheel: 1, how: Derailment::Climbed });
        }
    }
}

/// Goal: a wheelset on a ground that shakes sideways harder and harder stays, lifts its wheels and comes back, and at last is off the rails; each of it is a result, whatever the friction, and no run ends as an
/// error.
#[test]
fn a_wheelset_that_is_shaken_off_is_a_result() {
    let mut endings = Vec::new();
    for friction in [0.1, 0.5] {
        for amplitude in [1.0, 4.0, 7.0] {
            let mut case = across(Some(rails(20, 0.1, 6)), Way::uniform(1.0, 0.0, 0.0, 1.0), [2500.0, 2.5]);
            case.contact.friction = friction;
            case.ground[0] = sine(amplitude, 0.8);
            let run = ran(&case);
            let lifted = |row: &AcrossRow| row.wheels.iter().any(|wheel| wheel.contact.contacts.is_empty());
            assert_eq!(run.rows.iter().any(lifted), amplitude > 1.0, "{friction} {amplitude}");
            endings.push((amplitude, run.ending));
        }
    }
    for (amplitude, ending) in &endings {
        match ending {
            AcrossEnding::Completed => assert!(*amplitude < 7.0, "{endings:?}"),
            AcrossEnding::Derailed { .. } => assert!(*amplitude > 1.0, "{endings:?}"),
            other => panic!("{other:?}"),
        }
    }
}

/// Goal: a start without an equilibrium is an error with the key `start` that says what is lacking: a force that no flange holds, no weight, rails that nothing holds, a mass that falls over.
#[test]
fn starts_without_an_equilibrium_are_named() {
    let base = || across(None, Way::uniform(0.0, 0.0, 0.0, 1.0), [1.0, 1e-3]);
    let mut pushed = base();
    pushed.lateral_force = TimeFunction::constant(400e3);
    let mut light = base();
    light.gravity = 0.0;
    let mut loose = across(Some(rails(20, 0.1, 6)), Way::uniform(1.0, 0.0, 0.0, 1.0), [1.0, 1e-3]);
    loose.rails.as_mut().unwrap().layers.clear();
    let mut hanging = base();
    hanging.wheelset.lateral = kelvin(0.0, 1e3);
    for (case, said) in [
        (pushed, "both wheels"),
        (light, "both wheels"),
        (loose, "against twist"),
        (hanging, "carry the mass"),
    ] {
        let error = case.run(&Silent).unwrap_err().to_string();
        assert!(error.contains("start = ") && error.contains(said), "{error}");
    }
}
