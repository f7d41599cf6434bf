//! A linear part of one's own under a contact: `cargo run --release -p railspring-simulate --example own_linear_part`.
//!
//! A wheel falls on a rail seat: a mass on a pad with a damper. The seat implements [`LinearPart`]: it predicts its
//! motion without a contact force, gives its flexibility, and takes the force back. The wheel is a mass under its
//! weight. The contact is one equation a step, for which Hertz's law gives the force.

use faer::{Mat, MatRef};
use railspring_calibrate::law::StiffnessLaw;
use railspring_profiles::root::bracketed_newton;
use railspring_simulate::time::linear_part::{LinearPart, LinearStep};
use railspring_simulate::time::newmark::{Motion, Newmark};

/// A mass on a spring and a damper; displacements are downwards.
pub struct Oscillator {
    /// Mass, kg.
    pub mass: f64,
    /// Stiffness, N/m.
    pub stiffness: f64,
    /// Damping, N·s/m.
    pub damping: f64,
}

/// An oscillator prepared for steps of one length.
struct Prepared<'a> {
    own: &'a Oscillator,
    scheme: Newmark,
    flexibility: Mat<f64>,
}

impl<'a> Prepared<'a> {
    fn new(own: &'a Oscillator, scheme: Newmark) -> Self {
        let dynamic = own.mass * scheme.acceleration + own.damping * scheme.velocity + own.stiffness;
        Self { own, scheme, flexibility: Mat::from_fn(1, 1, |_, _| 1.0 / dynamic) }
    }
}

/// A step of an oscillator.
struct Step<'s> {
    part: &'s Prepared<'s>,
    state: &'s Motion,
    next: &'s mut Motion,
    free: [f64; 1],
}

impl<'a> LinearPart for Prepared<'a> {
    type State = Motion;
    /// Force besides that of the contact, N.
    type Load = f64;
    type Step<'s>
        = Step<'s>
    where
        Self: 's;

    fn predict<'s>(&'s self, state: &'s Motion, load: &f64, next: &'s mut Motion) -> Step<'s> {
        let carried =
            self.own.mass * self.scheme.inertia(state) + self.own.damping * self.scheme.damping(state);
        Step { part: self, state, next, free: [self.flexibility[(0, 0)] * (load + carried)] }
    }
}

impl LinearStep for Step<'_> {
    fn free(&self) -> &[f64] {
        &self.free
    }

    fn flexibility(&self) -> MatRef<'_, f64> {
        self.part.flexibility.as_ref()
    }

    fn finish(self, forces: &[f64]) {
        let u = self.free[0] + self.part.flexibility[(0, 0)] * forces[0];
        *self.next = self.part.scheme.advance(self.state, u);
    }
}

/// Force (N) in the contact of a `law` for which the approach is `free` less `flexibility` times the force.
fn contact_force(law: &StiffnessLaw, free: f64, flexibility: f64) -> f64 {
    if free <= 0.0 {
        return 0.0;
    }
    let approach = |force: f64| {
        let excess = law.displacement(force) + flexibility * force - free;
        (excess, 1.0 / law.tangent(force) + flexibility)
    };
    bracketed_newton(approach, 0.0, free / flexibility)
}

/// Contact force (N) at the end of every step of `step` (s) of a `wheel` that begins a millimetre above the `seat`.
pub fn forces(
    wheel: &Oscillator,
    seat: &Oscillator,
    law: &StiffnessLaw,
    step: f64,
    steps: usize,
) -> Vec<f64> {
    const GAP: f64 = 1e-3;
    let scheme = Newmark::new(step, 0.0);
    let parts = [wheel, seat].map(|part| Prepared::new(part, scheme));
    let weight = 9.81 * wheel.mass;
    let mut states = [Motion { a: 9.81, ..Motion::default() }, Motion::default()];
    let mut found = Vec::new();
    for _ in 0..steps {
        let mut next = [Motion::default(); 2];
        let [on_wheel, on_seat] = &mut next;
        let wheel = parts[0].predict(&states[0], &weight, on_wheel);
        let seat = parts[1].predict(&states[1], &0.0, on_seat);
        let flexibility = wheel.flexibility()[(0, 0)] + seat.flexibility()[(0, 0)];
        let force = contact_force(law, wheel.free()[0] - GAP - seat.free()[0], flexibility);
        wheel.finish(&[-force]);
        seat.finish(&[force]);
        states = next;
        found.push(force);
    }
    found
}

fn main() {
    let wheel = Oscillator { mass: 600.0, stiffness: 0.0, damping: 0.0 };
    let seat = Oscillator { mass: 100.0, stiffness: 1e8, damping: 1e5 };
    // steel on steel, a radius of 0.3 m
    let law = StiffnessLaw::hertz(1.154e11, 0.3);
    let forces = forces(&wheel, &seat, &law, 1e-4, 2000);
    for (n, force) in forces.iter().enumerate().step_by(100) {
        println!("{:.3} s  {:8.3} kN", 1e-4 * (n + 1) as f64, 1e-3 * force);
    }
}
