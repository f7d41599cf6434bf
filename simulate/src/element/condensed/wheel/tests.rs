//! The elastic wheel against closed solutions.

use super::*;
use crate::time::function::TimeFunction;
use crate::time::scenario::Kelvin;
use railspring_element::wheel::RimMode;

const HUB: f64 = 283.0;
const SUSPENDED: f64 = 1000.0;
/// A point mass on a spring at the hub: mass 80 kg, alone 400 Hz; in modes of mass 1 kg it moves by 1/√80.
const RIM: f64 = 80.0;

fn square() -> f64 {
    (std::f64::consts::TAU * 400.0).powi(2)
}

/// A hub with a mass on a vertical spring, which the contact touches.
fn two_masses() -> ElasticWheel {
    let total = HUB + RIM;
    let share = 1.0 / RIM.sqrt();
    ElasticWheel {
        mass: Matrix3::from_diagonal(&Vector3::new(total, total, 30.0)),
        hub: [0.0; 2],
        modes: vec![RimMode {
            square: square(),
            rim: Vector3::new(0.0, share, 0.0),
            coupling: Vector3::new(0.0, RIM * share, 0.0),
        }],
        rest: Matrix3::from_diagonal(&Vector3::new(1e-9, 2e-10, 1e-6)),
    }
}

fn relative(value: f64, exact: f64) -> f64 {
    (value / exact - 1.0).abs()
}

/// `count` steps of a wheel from rest under a constant force on its rim.
fn steps(wheel: &Wheel, count: usize, step: f64, force: &Vector3<f64>) -> Vec<WheelState> {
    let prepared = wheel.prepare(step);
    let mut states = vec![wheel.start(&InitialMotion::default())];
    wheel.accelerate(&mut states[0], force);
    for number in 0..count {
        let times = [number as f64 * step, (number + 1) as f64 * step];
        let mut next = states[number].clone();
        let free = wheel.free(&prepared, &states[number], times);
        wheel.finish(&prepared, &states[number], &free, force, &mut next);
        // what a step says of the rim at its end is where it is
        let said = free.rim + prepared.flexibility * force;
        assert!((said - wheel.rim(&next)).norm() < 1e-12 * (1.0 + said.norm()));
        states.push(next);
    }
    states
}

/// Source: two masses on a spring: the square of their angular frequency is that with one held times (m + M)/M. Goal: the natural frequency of the wheel whose
/// hub is free (1/s), the one mode that is not rigid. Accuracy: ROUNDOFF.
#[test]
fn a_free_wheel_swings_as_two_masses() {
    const ROUNDOFF: f64 = 1e-12;
    let scenario = Scenario::new(1, 1e-4, 0.3);
    for rotations_held in [true, false] {
        let scenario = Scenario { rotations_held, ..scenario.clone() };
        let wheel = Wheel::new(&two_masses(), &scenario, 0.0, 0.0).unwrap();
        let elastic: Vec<f64> = wheel.modes.iter().map(|m| m.square).filter(|s| *s > 0.0).collect();
        assert_eq!((elastic.len(), wheel.count()), (1, if rotations_held { 3 } else { 4 }));
        assert!(relative(elastic[0], square() * (HUB + RIM) / HUB) < ROUNDOFF, "{elastic:?}");
    }
}

/// Source: `u = u₀·cos ωt`; T.J.R. Hughes, "The Finite Element Method" (1987), chapter 9: with β = 1/12 a period is off by (ωh)⁴/480, with 1/4 by (ωh)²/12. Goal: a wheel whose rim is let go
/// swings so for ten periods, with 1/5 of a radian a step (m, over the first deflection), and keeps its energies (J); longer steps take a larger β, so that nothing grows. Accuracy: 20π parts of (ωh)⁴/480 are 2.1e-4, those of
/// (ωh)²/12 would be 0.21; ROUNDOFF of 314 steps.
#[test]
fn periods_are_right_to_the_fourth_order() {
    const PHASE: f64 = 2.2e-4;
    const ROUNDOFF: f64 = 1e-12;
    let scenario = Scenario::new(1, 1e-4, 0.3);
    let wheel = Wheel::new(&two_masses(), &scenario, 0.0, 0.0).unwrap();
    let omega = (square() * (HUB + RIM) / HUB).sqrt();
    let step = 0.2 / omega;
    let prepared = wheel.prepare(step);
    let mut state = wheel.start(&InitialMotion { carried: 10e3, ..InitialMotion::default() });
    wheel.accelerate(&mut state, &Vector3::zeros());
    let apart = |state: &WheelState| wheel.rim(state).y - wheel.hub(state)[1];
    let energy = |state: &WheelState| {
        let stored = wheel.stored(state);
        stored.kinetic + stored.elastic
    };
    let first = apart(&state);
    // the rail has pushed the rim up, against the hub that is carried
    assert!(relative(first, -10e3 / (RIM * square())) < 1e-9, "{first}");
    let mut next = state.clone();
    let (mut off, mut whole) = (0.0_f64, None);
    for number in 1..=314 {
        let times = [f64::from(number - 1) * step, f64::from(number) * step];
        let free = wheel.free(&prepared, &state, times);
        wheel.finish(&prepared, &state, &free, &Vector3::zeros(), &mut next);
        std::mem::swap(&mut state, &mut next);
        off = off.max((apart(&state) / first - (omega * times[1]).cos()).abs());
        let now = energy(&state);
        assert!(relative(now, *whole.get_or_insert(now)) < ROUNDOFF, "{number}");
    }
    println!("{off:e}");
    assert!(off < PHASE, "{off}");
    let beta = |step: f64| {
        wheel.prepare(step).modes.iter().map(|mode| mode.of_end / (step * step)).fold(1.0, f64::min)
    };
    assert!(beta(1e-5) == 1.0 / 12.0 && beta(1e-3) > 0.2 && beta(1e-3) < 0.25, "{}", beta(1e-3));
}

/// Source: a free vibration keeps its energy, whatever the length of the steps. Goal: a wheel whose rim is
/// let go swings for 2000 steps of 1/5 or of 1/10 of a radian, the shorter ones where it moves fast. Such
/// steps drive or damp a vibration whose velocities are taken over unchanged. Where the steps are long again
/// it has its first energy (J). Accuracy: a change of length leaves the fourth power of (ωh) over 72, a few
/// hundred times, at random phases of either sign. Without the difference of the velocities the energy
/// changes by 5 %.
#[test]
fn steps_of_other_lengths_drive_no_vibration() {
    const LEFT: f64 = 1e-2;
    let scenario = Scenario::new(1, 1e-4, 0.3);
    let wheel = Wheel::new(&two_masses(), &scenario, 0.0, 0.0).unwrap();
    let omega = (square() * (HUB + RIM) / HUB).sqrt();
    let lengths = [0.2, 0.1].map(|part| wheel.prepare(part / omega));
    let mut state = wheel.start(&InitialMotion { carried: 10e3, ..InitialMotion::default() });
    wheel.accelerate(&mut state, &Vector3::zeros());
    let mut next = state.clone();
    let mut energies = [f64::INFINITY, 0.0];
    let (mut time, mut changes, mut last) = (0.0, 0, 0);
    for _ in 0..2000 {
        let elastic = wheel.stored(&state).elastic;
        let short = usize::from(wheel.stored(&state).kinetic > elastic);
        changes += usize::from(short != last);
        last = short;
        let prepared = &lengths[short];
        let times = [time, time + prepared.step];
        let free = wheel.free(prepared, &state, times);
        wheel.finish(prepared, &state, &free, &Vector3::zeros(), &mut next);
        std::mem::swap(&mut state, &mut next);
        time = times[1];
        if short == 0 {
            let stored = wheel.stored(&state);
            let whole = stored.kinetic + stored.elastic;
            energies = [energies[0].min(whole), energies[1].max(whole)];
        }
    }
    println!("{energies:?} {changes}");
    assert!(changes > 100 && relative(energies[1], energies[0]) < LEFT, "{energies:?} {changes}");
}

/// Source: statics. Goal: with a hub too heavy to move, and time for the swing to die, the rim is where its flexibility has it (m/N): that of the mode, exactly;
/// the rest comes on top. Accuracy: against a hub of 10¹¹ kg the rim weighs 10⁻⁹, the swing is damped to 10⁻⁹.
#[test]
fn a_wheel_on_a_held_hub_has_its_flexibility() {
    const MODEL: f64 = 1e-8;
    let scenario = Scenario { wheel_mass: Some(1e11), ..Scenario::new(1, 1e-4, 0.3) };
    let wheel = Wheel::new(&two_masses(), &scenario, 0.0, 2e-4).unwrap();
    let force = Vector3::new(0.0, -40e3, 0.0);
    let states = steps(&wheel, 1000, 1e-4, &force);
    let rim = wheel.rim(&states[1000]).y - wheel.hub(&states[1000])[1];
    assert!(relative(rim, -40e3 / (RIM * square())) < MODEL, "{rim}");
    assert_eq!(wheel.rest, two_masses().rest);
}

/// Source: Newton. Goal: weights, vertical load and lateral load accelerate the total mass (m/s²), whichever way they act: on the hub, the suspended mass or the
/// rim. Accuracy: ROUNDOFF of a second difference over the mean of all masses, which average acceleration has exactly.
#[test]
fn loads_accelerate_the_total_mass() {
    const ROUNDOFF: f64 = 1e-9;
    let (gravity, vertical, lateral, on_rim) = (9.81, 20e3, 5e3, -7e3);
    for suspended_mass in [0.0, SUSPENDED] {
        let scenario = Scenario {
            gravity,
            suspended_mass,
            vertical_suspension: Kelvin { stiffness: 1.2e6, damping: 4e4 },
            vertical_force: TimeFunction::constant(vertical),
            lateral_force: TimeFunction::constant(lateral),
            ..Scenario::new(1, 1e-4, 0.3)
        };
        let wheel = Wheel::new(&two_masses(), &scenario, 0.0, 1e-5).unwrap();
        let states = steps(&wheel, 200, 1e-4, &Vector3::new(0.0, on_rim, 0.0));
        // momentum of hub and mass: the mass moves by the hub's motion and what it has against it
        let momentum = |state: &WheelState| {
            let speed = |of: &dyn Fn(&Mode) -> f64| -> f64 {
                wheel.modes.iter().zip(&state.modes).map(|(mode, [_, v, _])| of(mode) * v).sum()
            };
            let (hub, rim) = (speed(&|m| m.hub[1]), speed(&|m| m.rim.y));
            (HUB * hub + RIM * rim + suspended_mass * state.suspended[1], (HUB + RIM) * speed(&|m| m.hub[0]))
        };
        let time = 200.0 * 1e-4;
        let (down, aside) = momentum(&states[200]);
        let total = HUB + RIM + suspended_mass;
        assert!(relative(down, (total * gravity + vertical + on_rim) * time) < ROUNDOFF, "{down}");
        assert!(relative(aside, lateral * time) < ROUNDOFF, "{aside}");
    }
}

/// Source: a mass on a spring. Goal: a wheel that may turn about x, pushed by a moment on its rim, comes to rest at the moment over the stiffness of the axle (rad).
/// Accuracy: the swing is damped to 10⁻⁹.
#[test]
fn the_axle_holds_the_roll() {
    const MODEL: f64 = 1e-8;
    let scenario = Scenario { rotations_held: false, ..Scenario::new(1, 1e-3, 0.3) };
    let (roll, moment) = (1.1e6, 500.0);
    let wheel = Wheel::new(&two_masses(), &scenario, roll, 2e-3).unwrap();
    let states = steps(&wheel, 4000, 1e-3, &Vector3::new(0.0, 0.0, moment));
    let rim = wheel.rim(&states[4000]);
    assert!(relative(rim.z, moment / roll) < MODEL, "{rim}");
}

/// Goal: a wheel of which more moves in its modes than its whole mass is refused with the key of the mass.
#[test]
fn a_wheel_lighter_than_its_modes_is_named() {
    let scenario = Scenario { wheel_mass: Some(RIM - 1.0), ..Scenario::new(1, 1e-4, 0.3) };
    let message = Wheel::new(&two_masses(), &scenario, 0.0, 0.0).unwrap_err().to_string();
    assert!(message.contains("wheel_mass"), "{message}");
}

/// Goal: a wheel that a load case makes lighter than what moves in its modes, 80 kg, is refused with mass and least mass in tonnes.
#[test]
fn a_wheel_lighter_than_its_modes_is_refused_in_tonnes() {
    let of = |mass: f64| {
        let scenario = Scenario { wheel_mass: Some(mass), ..Scenario::new(1, 1e-4, 0.3) };
        Wheel::new(&two_masses(), &scenario, 0.0, 0.0).map(drop)
    };
    let said = of(1.0).unwrap_err().to_string();
    assert!(said.starts_with("wheel_mass = 0.001 t: expected a mass above"), "{said}");
    assert!(said.contains("modes, 0.080 t;"), "{said}");
    of(81.0).unwrap();
}
