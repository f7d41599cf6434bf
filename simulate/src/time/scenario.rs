//! What happens to the wheel: the suspension, the forces and the time steps
//! (publication, section 4). The solid model and the moving solver run the
//! very same [`Scenario`].

use serde::Serialize;
use std::f64::consts::TAU;

use crate::time::function::{HarmonicForce, LEAST_STEPS_PER_PERIOD, TimeFunction, interpolated};
use crate::time::steps::InnerSteps;
use railspring_profiles::error::InputError;
use railspring_profiles::field::InputField;
use railspring_profiles::units::TONNE;

/// Spring and damper in parallel (Kelvin element).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Kelvin {
    /// Stiffness, N/m.
    pub stiffness: f64,
    /// Damping, N·s/m.
    pub damping: f64,
}

impl Kelvin {
    /// Lengthening (m) at time `t` (s) under a `force` that it transmits, unloaded at t = 0: the solution of
    /// `damping·de/dt + stiffness·e = force`. Without stiffness and damping it is a rigid link.
    ///
    /// ```
    /// use railspring_simulate::time::function::TimeFunction;
    /// use railspring_simulate::time::scenario::Kelvin;
    /// let suspension = Kelvin { stiffness: 1.2e6, damping: 40e3 };
    /// // After many relaxation times of 1/30 s only the spring is left.
    /// let lengthening = suspension.lengthening(&TimeFunction::constant(20e3), 1.0);
    /// assert!((lengthening - 20e3 / 1.2e6).abs() < 1e-12);
    /// ```
    pub fn lengthening(&self, force: &TimeFunction, t: f64) -> f64 {
        let (k, c) = (self.stiffness, self.damping);
        if c == 0.0 {
            return if k == 0.0 { 0.0 } else { force.at(t) / k };
        }
        let of_sines: f64 = force.harmonics.iter().map(|sine| self.under_sine(sine, t)).sum();
        of_sines + self.under_table(&force.table, t)
    }

    /// The lengthening of a link with a damper under one sine.
    fn under_sine(&self, force: &HarmonicForce, t: f64) -> f64 {
        let (k, c) = (self.stiffness, self.damping);
        let omega = TAU * force.frequency;
        let decay = (-k / c * t).exp();
        let constant = if k == 0.0 { t / c } else { -(-k / c * t).exp_m1() / k };
        let harmonic = if omega == 0.0 {
            force.phase.sin() * constant
        } else {
            let lag = force.phase - (omega * c).atan2(k);
            ((omega * t + lag).sin() - lag.sin() * decay) / k.hypot(omega * c)
        };
        force.constant * constant + force.amplitude * harmonic
    }

    /// The same under a table: the exact solution from row to row, between which the force is linear.
    fn under_table(&self, table: &[(f64, f64)], t: f64) -> f64 {
        /// Relaxation times after which nothing is left of a lengthening, to the last digit.
        const FORGOTTEN: f64 = 45.0;
        if table.is_empty() {
            return 0.0;
        }
        let rate = self.stiffness / self.damping;
        let begin = if rate > 0.0 { (t - FORGOTTEN / rate).max(0.0) } else { 0.0 };
        let rows = &table[table.partition_point(|(time, _)| *time <= begin)..];
        let within = rows.iter().copied().take_while(|(time, _)| *time < t);
        let mut lengthening = 0.0;
        let mut before = (begin, interpolated(table, begin));
        for row in within.chain([(t, interpolated(table, t))]) {
            let length = row.0 - before.0;
            let x = rate * length;
            let share = before.1 * relaxed(x) + (row.1 - before.1) * relaxed_ramp(x);
            lengthening = lengthening * (-x).exp() + length / self.damping * share;
            before = row;
        }
        lengthening
    }
}

/// (1 − e⁻ˣ)/x: what is left of a constant rate over a time of x relaxation times.
fn relaxed(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { -(-x).exp_m1() / x }
}

/// (x − 1 + e⁻ˣ)/x², the same of a rate that grows from 0 to 1.
fn relaxed_ramp(x: f64) -> f64 {
    if x > 0.5 {
        return (1.0 - relaxed(x)) / x;
    }
    // the series of the exponential: the first form loses digits near 0
    let mut term = 0.5;
    (3..20).fold(0.5, |sum, n| {
        term *= -x / f64::from(n);
        sum + term
    })
}

/// A dynamic load case on one wheel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scenario {
    /// Number of time steps after the initial state.
    pub steps: usize,
    /// Time step of the history, s.
    pub time_step: f64,
    /// Steps of the integration within each of these.
    pub inner_steps: InnerSteps,
    /// Coulomb friction coefficient of wheel on rail.
    pub friction: f64,
    /// Gravity, m/s², acting on the wheel and the suspended mass; 0 leaves it out.
    pub gravity: f64,
    /// Suspended mass on the vertical spring and damper, kg. Without one the vertical force acts at the massless
    /// end of spring and damper, which transmit it to the wheel centre unchanged.
    pub suspended_mass: f64,
    /// Vertical spring and damper between the wheel centre and the suspended mass.
    pub vertical_suspension: Kelvin,
    /// Force on the suspended mass, N, positive down.
    pub vertical_force: TimeFunction,
    /// Lateral spring and damper between the wheel centre and the point where the lateral force acts. That point has
    /// no mass (publication, figure 3), so that the wheel receives the force unchanged, and only the motion of the
    /// point depends on them: [`Scenario::load_travel`].
    pub lateral_suspension: Kelvin,
    /// Lateral force, N, positive towards the field side: it pushes the flange towards the rail.
    pub lateral_force: TimeFunction,
    /// Torsion about x at the middle of the rail, N·m; only the moving solver can apply it.
    pub rail_torsion: Option<TimeFunction>,
    /// Mass of the wheel, kg; `None` takes the mass of the solid wheel.
    pub wheel_mass: Option<f64>,
    /// Position of the wheel along the rail at t = 0, m from the rail's first end; `None` is midspan.
    pub start_x: Option<f64>,
    /// Speed along the rail, m/s; only the moving solver can move.
    pub speed: f64,
    /// Whether the rotations of the wheel's master node are held.
    pub rotations_held: bool,
}

impl Scenario {
    /// A load case without forces, gravity, suspension and speed, the wheel's rotations held: so many steps of
    /// `time_step` (s) with Coulomb friction. The load is added with the update of a structure.
    ///
    /// ```
    /// use railspring_simulate::time::function::TimeFunction;
    /// use railspring_simulate::time::scenario::Scenario;
    /// let pushed = Scenario {
    ///     vertical_force: TimeFunction::constant(60e3),
    ///     lateral_force: TimeFunction::constant(20e3),
    ///     ..Scenario::new(100, 5e-4, 0.5)
    /// };
    /// assert_eq!(pushed.lateral_force.at(0.01), 20e3);
    /// ```
    pub fn new(steps: usize, time_step: f64, friction: f64) -> Self {
        let rigid = Kelvin { stiffness: 0.0, damping: 0.0 };
        Self {
            steps,
            time_step,
            inner_steps: InnerSteps::Equal(1),
            friction,
            gravity: 0.0,
            suspended_mass: 0.0,
            vertical_suspension: rigid,
            vertical_force: TimeFunction::default(),
            lateral_suspension: rigid,
            lateral_force: TimeFunction::default(),
            rail_torsion: None,
            wheel_mass: None,
            start_x: None,
            speed: 0.0,
            rotations_held: true,
        }
    }

    /// Length of the shortest steps of the integration, s.
    pub fn shortest_step(&self) -> f64 {
        self.time_step / self.inner_steps.most() as f64
    }

    /// The largest that forces and weights can be at the same time, N.
    pub fn largest_load(&self) -> f64 {
        let weight = (self.suspended_mass + self.wheel_mass.unwrap_or(0.0)) * self.gravity;
        (self.vertical_force.largest() + weight.abs()).hypot(self.lateral_force.largest())
    }

    /// Displacement (m) since t = 0 of the point where the lateral force acts, positive towards the field side, from that of
    /// the wheel centre.
    pub fn load_travel(&self, time: f64, wheel_y: f64) -> f64 {
        wheel_y + self.lateral_suspension.lengthening(&self.lateral_force, time)
    }

    /// Checks what both models need of a load case.
    ///
    /// # Errors
    /// [`InputError`] with the key of the first value that is not finite, of a force that the time step does not
    /// resolve, or of a suspended mass that nothing carries.
    pub fn check(&self) -> Result<(), InputError> {
        let forces = [
            (InputField::VerticalForce, Some(&self.vertical_force)),
            (InputField::LateralForce, Some(&self.lateral_force)),
            (InputField::RailTorsion, self.rail_torsion.as_ref()),
        ];
        for (field, force) in forces.into_iter().filter_map(|(field, force)| Some((field, force?))) {
            if let Some(value) = force.mistake() {
                let expected = "finite values, and times of a table that ascend";
                return Err(InputError::new(field, value, expected, "correct the force"));
            }
            if let Some(frequency) = force.unresolved(self.time_step) {
                let longest = 1.0 / (LEAST_STEPS_PER_PERIOD * frequency);
                return Err(InputError::new(
                    field,
                    format!("{frequency} Hz at time steps of {} s", self.time_step),
                    format!("a period of at least {LEAST_STEPS_PER_PERIOD} time steps"),
                    format!("lower `{}` to {longest:.3e} s or less, or the frequency", InputField::TimeStep),
                ));
            }
        }
        self.inner_steps.check()?;
        let spring = self.vertical_suspension;
        if self.suspended_mass > 0.0 && spring.stiffness == 0.0 && spring.damping == 0.0 {
            return Err(InputError::new(
                InputField::VerticalStiffness,
                "0, with no damping either",
                format!(
                    "a spring or a damper that carries the suspended mass of {} t",
                    self.suspended_mass / TONNE
                ),
                format!(
                    "give the suspension a stiffness, or set `{}` to 0 and the force acts on the wheel",
                    InputField::SuspendedMass
                ),
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: the differential equation itself. Goal: damping·de/dt + stiffness·e is the force (N), from e = 0 on, for a
    /// suspension with both, without spring and without damper. Central differences with h = 1e-5 s: (ωh)²/6 = 7e-8 of the
    /// damper's force.
    #[test]
    fn lengthening_carries_the_force() {
        const DISCRETISATION: f64 = 2e-7;
        const ROUNDOFF: f64 = 1e-15;
        let force = HarmonicForce { constant: 20e3, amplitude: 10e3, frequency: 10.0, phase: 0.4 };
        for (stiffness, damping) in [(1.2e6, 40e3), (0.0, 40e3), (1e-3, 40e3), (1.2e6, 0.0)] {
            let kelvin = Kelvin { stiffness, damping };
            if damping > 0.0 {
                assert!(kelvin.lengthening(&force.into(), 0.0).abs() < ROUNDOFF);
            }
            for t in [1e-3, 0.0123, 0.07, 0.5] {
                let h = 1e-5;
                let e = |t| kelvin.lengthening(&force.into(), t);
                let carried = damping * (e(t + h) - e(t - h)) / (2.0 * h) + stiffness * e(t);
                assert!((carried - force.at(t)).abs() < DISCRETISATION * 30e3, "{stiffness} {damping} {t}");
            }
        }
        let rigid = Kelvin { stiffness: 0.0, damping: 0.0 };
        assert_eq!(rigid.lengthening(&force.into(), 0.1), 0.0);
        let still = HarmonicForce { frequency: 0.0, ..force };
        let spring = Kelvin { stiffness: 1.2e6, damping: 40e3 };
        assert!((spring.lengthening(&still.into(), 3.0) - still.at(3.0) / 1.2e6).abs() < ROUNDOFF);
    }

    /// Source: the differential equation itself. Goal: as above for two sines with a table of corners in the middle of the run, and the steady state
    /// of its last value. The formula of the ramp meets its series where they part. Central differences as above; ROUNDOFF, of the steady state.
    #[test]
    fn lengthening_under_a_sum_and_a_table() {
        const DISCRETISATION: f64 = 2e-7;
        const ROUNDOFF: f64 = 1e-15;
        let sine = |amplitude, frequency| HarmonicForce { amplitude, frequency, ..HarmonicForce::NONE };
        let table = vec![(-0.01, 3e3), (0.02, 30e3), (0.03, -10e3), (0.3, 12e3)];
        let force = TimeFunction { harmonics: vec![sine(10e3, 10.0), sine(4e3, 3.0)], table: table.clone() };
        for (stiffness, damping) in [(1.2e6, 40e3), (0.0, 40e3), (1e-3, 40e3), (1e9, 40e3)] {
            let kelvin = Kelvin { stiffness, damping };
            let e = |t| kelvin.lengthening(&force, t);
            assert_eq!(e(0.0), 0.0);
            for t in [1e-3, 0.0123, 0.0205, 0.07, 0.5] {
                let h = if stiffness > 1e8 { 1e-7 } else { 1e-5 };
                let carried = damping * (e(t + h) - e(t - h)) / (2.0 * h) + stiffness * e(t);
                assert!((carried - force.at(t)).abs() < DISCRETISATION * 60e3, "{stiffness} {damping} {t}");
            }
        }
        let of_table = TimeFunction { harmonics: Vec::new(), table };
        let spring = Kelvin { stiffness: 1.2e6, damping: 40e3 };
        assert!((spring.lengthening(&of_table, 5.0) - 12e3 / 1.2e6).abs() < ROUNDOFF);
        assert!((relaxed_ramp(0.5) - (1.0 - relaxed(0.5)) / 0.5).abs() < ROUNDOFF);
    }

    /// Goal: a force of 1000 Hz at steps of 1 ms, which all its samples miss, is refused with its key and the step that
    /// would do; twenty steps per period pass, with their rounding; no amplitude, no limit.
    #[test]
    fn a_force_must_be_resolved() {
        let fast = HarmonicForce { amplitude: 1e3, frequency: 1000.0, ..HarmonicForce::NONE };
        let spring = Kelvin { stiffness: 1.2e6, damping: 40e3 };
        let scenario = Scenario {
            suspended_mass: 6250.0,
            vertical_suspension: spring,
            lateral_suspension: spring,
            lateral_force: fast.into(),
            ..Scenario::new(10, 1e-3, 0.3)
        };
        let message = scenario.check().unwrap_err().to_string();
        assert!(message.starts_with("lateral_force = 1000 Hz"), "{message}");
        assert!(message.contains("`time_step` to 5.000e-5 s"), "{message}");
        for (frequency, time_step) in [(50.0, 1e-3), (1e5, 5e-7), (3.0, 1.0 / 60.0)] {
            let lateral_force = HarmonicForce { frequency, ..fast }.into();
            Scenario { lateral_force, time_step, ..scenario.clone() }.check().unwrap();
        }
        let lateral_force = HarmonicForce { amplitude: 0.0, ..fast }.into();
        Scenario { lateral_force, ..scenario.clone() }.check().unwrap();
        let lateral_force = TimeFunction::constant(f64::NAN);
        assert!(Scenario { lateral_force, ..scenario.clone() }.check().is_err());
        let table = vec![(0.0, 1.0), (0.0, 2.0)];
        let twice = TimeFunction { harmonics: Vec::new(), table };
        let message = Scenario { vertical_force: twice, ..scenario.clone() }.check().unwrap_err().to_string();
        assert!(message.starts_with("vertical_force = 0 s after 0 s"), "{message}");
        let loose = Kelvin { stiffness: 0.0, damping: 0.0 };
        let slow =
            Scenario { lateral_force: TimeFunction::default(), vertical_suspension: loose, ..scenario };
        let message = slow.check().unwrap_err().to_string();
        assert!(message.contains("vertical_suspension") && message.contains("mass of 6.25 t"), "{message}");
        Scenario { suspended_mass: 0.0, ..slow.clone() }.check().unwrap();
        let none = Scenario { inner_steps: InnerSteps::Equal(0), suspended_mass: 0.0, ..slow };
        assert!(none.check().unwrap_err().to_string().starts_with("inner_steps = 0"));
    }
}
