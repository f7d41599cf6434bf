//! The examples of this package, so that they run with every test.

use railspring_calibrate::law::StiffnessLaw;
use railspring_simulate::prelude::*;

#[expect(dead_code, reason = "what an example prints is not tested")]
#[path = "../examples/load_case.rs"]
mod load_case;
#[expect(dead_code, reason = "what an example prints is not tested")]
#[path = "../examples/own_linear_part.rs"]
mod own_linear_part;

use own_linear_part::Oscillator;

/// Source: the vertical force on the suspended mass in closed form, 60 kN and a sine of 30 kN with 10 Hz; the
/// lateral force of 10 kN. Goal: an element that is condensed from two profiles on a coarse mesh carries both
/// forces over one period. Units N. Accuracy: INERTIA, as the wheel begins unloaded and swings about the forces
/// with its own frequency, and over one period its mean motion is not zero.
#[test]
fn the_element_carries_the_forces_of_the_load_case() {
    const INERTIA: f64 = 0.03;
    let FitOptions { mesh, .. } = FitOptions::default();
    let mesh = MeshOptions { contact_element: 6e-3, contact_element_along: 6e-3, ..mesh };
    let material = Material { damping: 6.4e-6, ..Material::STEEL };
    let options = FitOptions { mesh, material, ..FitOptions::default() };
    let history = load_case::history(&options).unwrap();
    assert_eq!(history.rows.len(), 201, "{}", history.ending);
    let mean = |force: fn(&railspring_simulate::time::history::HistoryRow) -> f64| {
        history.rows[1..].iter().map(force).sum::<f64>() / 200.0
    };
    let [p, q] = [mean(|row| row.vertical_force), mean(|row| row.lateral_force)];
    assert!((p / 60e3 - 1.0).abs() < INERTIA && (q / 10e3 - 1.0).abs() < INERTIA, "{p}, {q}");
}

/// Source: free fall; the balance of momentum; statics. Goal: a wheel that falls by a millimetre strikes after
/// `√(2·h/g)`, and comes to rest under its weight. Units s, N. Accuracy: STEP, one step before and after the
/// contact; REST, of what is left of the bounces after four seconds.
#[test]
fn a_wheel_falls_and_comes_to_rest() {
    const STEP: f64 = 1e-4;
    const REST: f64 = 1e-3;
    let wheel = Oscillator { mass: 600.0, stiffness: 0.0, damping: 0.0 };
    let seat = Oscillator { mass: 100.0, stiffness: 1e8, damping: 1e5 };
    let law = StiffnessLaw::hertz(1.154e11, 0.3);
    let forces = own_linear_part::forces(&wheel, &seat, &law, STEP, 40_000);
    let strike = STEP * forces.iter().position(|force| *force > 0.0).unwrap() as f64;
    assert!((strike - (2e-3_f64 / 9.81).sqrt()).abs() < 1.5 * STEP, "{strike} s");
    let weight = 9.81 * 600.0;
    let late = &forces[39_000..];
    assert!(late.iter().all(|force| (force / weight - 1.0).abs() < REST), "{:?}", &late[..10]);
}
