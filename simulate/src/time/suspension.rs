//! The vertical spring and damper between the wheel's centre and the suspended mass, in one time step of Newmark's scheme.
//!
//! The suspended mass is eliminated: the centre feels a stiffness and forces. Both models of a wheel on a rail use
//! this, whichever way their coordinate points.

use crate::time::energy::PartEnergy;
use crate::time::newmark::{Motion, Newmark};
use crate::time::scenario::Scenario;

/// A suspension over time steps of one length.
#[derive(Debug, Clone, Copy)]
pub struct Suspension {
    damping: f64,
    mass: f64,
    scheme: Newmark,
    /// Effective stiffness of spring and damper, N/m.
    coupling: f64,
    /// Effective stiffness of the suspended mass, N/m.
    inertia: f64,
}

/// The forces of a suspension in one step, N, in the direction of its coordinate.
#[derive(Debug, Clone, Copy)]
pub struct SuspensionStep {
    /// What the damper carries over to the centre from the last state.
    pub damper: f64,
    /// What reaches the centre of the load on the suspended mass and of its inertia.
    pub transmitted: f64,
    /// Right-hand side of the suspended mass.
    load: f64,
}

impl Suspension {
    /// The vertical suspension of a scenario.
    pub fn new(scenario: &Scenario, scheme: &Newmark) -> Self {
        let (spring, mass) = (scenario.vertical_suspension, scenario.suspended_mass);
        let coupling = scheme.velocity * spring.damping + spring.stiffness;
        let (damping, inertia) = (spring.damping, mass * scheme.acceleration);
        Self { damping, mass, scheme: *scheme, coupling, inertia }
    }

    /// Share of a force on the suspended mass that reaches the centre. Without mass and suspension the force acts on the
    /// centre.
    fn share(&self) -> f64 {
        let sum = self.inertia + self.coupling;
        if sum > 0.0 { self.coupling / sum } else { 1.0 }
    }

    /// Stiffness against displacement of the centre, N/m: suspension and mass in series.
    pub fn stiffness(&self) -> f64 {
        let sum = self.inertia + self.coupling;
        if sum > 0.0 { self.coupling * self.inertia / sum } else { 0.0 }
    }

    /// Force on the centre and acceleration of the suspended mass at t = 0 under a `load` (N) on that mass. Without a mass
    /// spring and damper transmit the load from the first moment.
    pub fn start(scenario: &Scenario, centre: &Motion, suspended: &Motion, load: f64) -> (f64, f64) {
        let (spring, mass) = (scenario.vertical_suspension, scenario.suspended_mass);
        if mass > 0.0 {
            let force =
                spring.stiffness * (suspended.u - centre.u) + spring.damping * (suspended.v - centre.v);
            (force, (load - force) / mass)
        } else {
            (load, 0.0)
        }
    }

    /// The forces of a step from the states at its start and the `load` (N) on the suspended mass at its end.
    pub fn step(&self, centre: &Motion, suspended: &Motion, load: f64) -> SuspensionStep {
        let damper = self.damping * (self.scheme.damping(centre) - self.scheme.damping(suspended));
        let load = load + self.mass * self.scheme.inertia(suspended) - damper;
        SuspensionStep { damper, transmitted: self.share() * load, load }
    }

    /// Energy of spring and suspended mass after a step from the state `before` to `after` (centre and suspended mass), with the mean `load` (N) on the mass over the step; without
    /// a mass the load acts on the centre, and the spring transmits it. Friction apart, J.
    pub fn energy(
        scenario: &Scenario,
        before: [&Motion; 2],
        after: [&Motion; 2],
        load: f64,
        step: f64,
    ) -> PartEnergy {
        let (spring, mass) = (scenario.vertical_suspension, scenario.suspended_mass);
        if mass == 0.0 {
            return PartEnergy { work: load * (after[0].u - before[0].u), ..PartEnergy::default() };
        }
        let stroke = |[centre, suspended]: [&Motion; 2]| suspended.u - centre.u;
        let moved = stroke(after) - stroke(before);
        PartEnergy {
            kinetic: 0.5 * mass * after[1].v * after[1].v,
            elastic: 0.5 * spring.stiffness * stroke(after).powi(2),
            work: load * (after[1].u - before[1].u),
            damped: if step > 0.0 { spring.damping * moved * moved / step } else { 0.0 },
            friction: 0.0,
        }
    }

    /// State of the suspended mass at the end of a step, with the displacement `centre` (m) there.
    pub fn finish(&self, step: &SuspensionStep, suspended: &Motion, centre: f64) -> Motion {
        let sum = self.inertia + self.coupling;
        let u = if sum > 0.0 { (step.load + self.coupling * centre) / sum } else { centre };
        self.scheme.advance(suspended, u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::function::TimeFunction;
    use crate::time::scenario::Kelvin;
    use crate::time::steps::InnerSteps;

    fn scenario(suspended_mass: f64, vertical_suspension: Kelvin) -> Scenario {
        Scenario {
            steps: 1,
            time_step: 5e-4,
            inner_steps: InnerSteps::Equal(1),
            friction: 0.3,
            gravity: 9.81,
            suspended_mass,
            vertical_suspension,
            vertical_force: TimeFunction::default(),
            lateral_suspension: vertical_suspension,
            lateral_force: TimeFunction::default(),
            rail_torsion: None,
            wheel_mass: None,
            start_x: None,
            speed: 0.0,
            rotations_held: true,
        }
    }

    /// Source: Newmark's equations of both masses, solved as two equations in two unknowns. Goal: centre (900 kg, on a spring
    /// of 1e7 N/m) and suspended mass after one step of the condensed system, m, with and without dissipation, with
    /// spring and damper, spring alone and damper alone. Accuracy: ROUNDOFF of a 2x2 solution, relative.
    #[test]
    fn the_condensed_step_is_that_of_both_masses() {
        const ROUNDOFF: f64 = 1e-12;
        let (own, ground, load) = (900.0, 1e7, 61e3);
        let centre = Motion { u: 1e-4, v: -0.02, a: 3.0 };
        let suspended = Motion { u: 3e-4, v: 0.05, a: -1.0 };
        for dissipation in [0.0, 0.1] {
            for (stiffness, damping) in [(1.2e6, 40e3), (1.2e6, 0.0), (0.0, 40e3)] {
                let scenario = scenario(6250.0, Kelvin { stiffness, damping });
                let scheme = Newmark::new(scenario.time_step, dissipation);
                let suspension = Suspension::new(&scenario, &scheme);
                let step = suspension.step(&centre, &suspended, load);
                let effective = own * scheme.acceleration + ground + suspension.stiffness();
                let force = own * scheme.inertia(&centre) + step.damper + step.transmitted;
                let u = force / effective;
                let w = suspension.finish(&step, &suspended, u).u;
                // the accelerations and velocities of the scheme, put into both equations of motion
                let (now, above) = (scheme.advance(&centre, u), scheme.advance(&suspended, w));
                let carried = stiffness * (above.u - now.u) + damping * (above.v - now.v);
                let scale = load + 6250.0 * above.a.abs();
                let wheel = own * now.a + ground * now.u - carried;
                let mass = 6250.0 * above.a + carried - load;
                assert!(wheel.abs() < ROUNDOFF * scale * 100.0, "{dissipation} {stiffness}: {wheel:e}");
                assert!(mass.abs() < ROUNDOFF * scale * 100.0, "{dissipation} {stiffness}: {mass:e}");
            }
        }
    }

    /// Goal: without a suspended mass the load reaches the centre unchanged, with and without a suspension, at the start and
    /// in a step, and the suspension has no stiffness.
    #[test]
    fn without_a_mass_the_load_acts_on_the_centre() {
        let still = Motion::default();
        for spring in [Kelvin { stiffness: 1.2e6, damping: 40e3 }, Kelvin { stiffness: 0.0, damping: 0.0 }] {
            let scenario = scenario(0.0, spring);
            let suspension = Suspension::new(&scenario, &Newmark::new(5e-4, 0.0));
            let step = suspension.step(&still, &still, 85e3);
            assert_eq!((suspension.stiffness(), step.damper + step.transmitted), (0.0, 85e3));
            assert_eq!(Suspension::start(&scenario, &still, &still, 85e3), (85e3, 0.0));
        }
    }
}
