//! What happens to the wheel: the suspension, the forces and the time steps
//! (publication, section 4). The solid model and the moving solver run the
//! very same [`Scenario`].

use serde::Serialize;
use std::f64::consts::TAU;

use crate::time::steps::InnerSteps;
use railspring_profiles::error::InputError;
use railspring_profiles::field::InputField;
use railspring_profiles::units::TONNE;

/// Time steps that a period of a force must have at least.
///
/// Average acceleration replaces the frequency ω of a motion by 2/Δt·tan(ωΔt/2), so that a force moves a free
/// mass by the share (x/tan x)² of the right amplitude, x = ωΔt/2 = π/n with n steps per period. Twenty steps leave 0.984,
/// and the sampled force misses its peak by no more than 1 − cos x = 0.012; with ten it would be 0.934 and 0.049,
/// and with one step per period the force vanishes.
pub const LEAST_STEPS_PER_PERIOD: f64 = 20.0;

/// A force `constant + amplitude·sin(2π·frequency·t + phase)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HarmonicForce {
    /// Mean value, N (or N·m).
    pub constant: f64,
    /// Amplitude, N (or N·m).
    pub amplitude: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Phase, rad.
    pub phase: f64,
}

impl HarmonicForce {
    /// Value at time `t` in seconds.
    ///
    /// ```
    /// use railspring_simulate::time::scenario::HarmonicForce;
    /// let force = HarmonicForce { constant: 10.0, amplitude: 5.0, frequency: 10.0, phase: 0.0 };
    /// assert!((force.at(0.025) - 15.0).abs() < 1e-12);
    /// ```
    pub fn at(&self, t: f64) -> f64 {
        self.constant + self.amplitude * (TAU * self.frequency * t + self.phase).sin()
    }

    /// Whether steps of `time_step` (s) follow the force: [`LEAST_STEPS_PER_PERIOD`] a period.
    fn is_resolved(&self, time_step: f64) -> bool {
        // A product of three factors may round up.
        self.amplitude == 0.0 || LEAST_STEPS_PER_PERIOD * self.frequency * time_step <= 1.0 + 1e-12
    }
}

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
    /// use railspring_simulate::time::scenario::{HarmonicForce, Kelvin};
    /// let force = HarmonicForce { constant: 20e3, amplitude: 0.0, frequency: 0.0, phase: 0.0 };
    /// let suspension = Kelvin { stiffness: 1.2e6, damping: 40e3 };
    /// // After many relaxation times of 1/30 s only the spring is left.
    /// assert!((suspension.lengthening(&force, 1.0) - 20e3 / 1.2e6).abs() < 1e-12);
    /// ```
    pub fn lengthening(&self, force: &HarmonicForce, t: f64) -> f64 {
        let (k, c) = (self.stiffness, self.damping);
        if c == 0.0 {
            return if k == 0.0 { 0.0 } else { force.at(t) / k };
        }
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
    pub vertical_force: HarmonicForce,
    /// Lateral spring and damper between the wheel centre and the point where the lateral force acts. That point has
    /// no mass (publication, figure 3), so that the wheel receives the force unchanged, and only the motion of the
    /// point depends on them: [`Scenario::load_travel`].
    pub lateral_suspension: Kelvin,
    /// Lateral force, N, positive towards the field side: it pushes the flange towards the rail.
    pub lateral_force: HarmonicForce,
    /// Torsion about x at the middle of the rail, N·m; only the moving solver can apply it.
    pub rail_torsion: Option<HarmonicForce>,
    /// Mass of the wheel, kg; `None` takes the mass of the solid wheel.
    pub wheel_mass: Option<f64>,
    /// Position of the wheel along the rail at t = 0, m from the rail's first end; `None` is midspan.
    pub start_x: Option<f64>,
    /// Speed along the rail, m/s; only the moving solver can move.
    pub speed: f64,
    /// Whether the rotations of the wheel's master node are held.
    pub rotations_held: bool,
}

impl HarmonicForce {
    /// No force.
    pub const NONE: Self = Self { constant: 0.0, amplitude: 0.0, frequency: 0.0, phase: 0.0 };

    /// A constant force, N.
    pub fn constant(force: f64) -> Self {
        Self { constant: force, ..Self::NONE }
    }
}

impl Scenario {
    /// A load case without forces, gravity, suspension and speed, the wheel's rotations held: so many steps of
    /// `time_step` (s) with Coulomb friction. The load is added with the update of a structure.
    ///
    /// ```
    /// use railspring_simulate::time::scenario::{HarmonicForce, Scenario};
    /// let pushed = Scenario {
    ///     vertical_force: HarmonicForce::constant(60e3),
    ///     lateral_force: HarmonicForce::constant(20e3),
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
            vertical_force: HarmonicForce::NONE,
            lateral_suspension: rigid,
            lateral_force: HarmonicForce::NONE,
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
        let of = |force: &HarmonicForce| force.constant.abs() + force.amplitude.abs();
        let weight = (self.suspended_mass + self.wheel_mass.unwrap_or(0.0)) * self.gravity;
        (of(&self.vertical_force) + weight.abs()).hypot(of(&self.lateral_force))
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
            (InputField::VerticalForce, Some(self.vertical_force)),
            (InputField::LateralForce, Some(self.lateral_force)),
            (InputField::RailTorsion, self.rail_torsion),
        ];
        for (field, force) in forces.into_iter().filter_map(|(field, force)| Some((field, force?))) {
            let values = [force.constant, force.amplitude, force.frequency, force.phase];
            if let Some(value) = values.iter().find(|v| !v.is_finite()) {
                return Err(InputError::new(field, value, "finite values", "correct the force"));
            }
            if !force.is_resolved(self.time_step) {
                let longest = 1.0 / (LEAST_STEPS_PER_PERIOD * force.frequency);
                return Err(InputError::new(
                    field,
                    format!("{} Hz at time steps of {} s", force.frequency, self.time_step),
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
                assert!(kelvin.lengthening(&force, 0.0).abs() < ROUNDOFF);
            }
            for t in [1e-3, 0.0123, 0.07, 0.5] {
                let h = 1e-5;
                let e = |t| kelvin.lengthening(&force, t);
                let carried = damping * (e(t + h) - e(t - h)) / (2.0 * h) + stiffness * e(t);
                assert!((carried - force.at(t)).abs() < DISCRETISATION * 30e3, "{stiffness} {damping} {t}");
            }
        }
        let rigid = Kelvin { stiffness: 0.0, damping: 0.0 };
        assert_eq!(rigid.lengthening(&force, 0.1), 0.0);
        let still = HarmonicForce { frequency: 0.0, ..force };
        let spring = Kelvin { stiffness: 1.2e6, damping: 40e3 };
        assert!((spring.lengthening(&still, 3.0) - still.at(3.0) / 1.2e6).abs() < ROUNDOFF);
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
            lateral_force: fast,
            ..Scenario::new(10, 1e-3, 0.3)
        };
        let message = scenario.check().unwrap_err().to_string();
        assert!(message.starts_with("lateral_force = 1000 Hz"), "{message}");
        assert!(message.contains("`time_step` to 5.000e-5 s"), "{message}");
        for (frequency, time_step) in [(50.0, 1e-3), (1e5, 5e-7), (3.0, 1.0 / 60.0)] {
            let lateral_force = HarmonicForce { frequency, ..fast };
            Scenario { lateral_force, time_step, ..scenario.clone() }.check().unwrap();
        }
        let lateral_force = HarmonicForce { amplitude: 0.0, ..fast };
        Scenario { lateral_force, ..scenario.clone() }.check().unwrap();
        let lateral_force = HarmonicForce { constant: f64::NAN, ..HarmonicForce::NONE };
        assert!(Scenario { lateral_force, ..scenario.clone() }.check().is_err());
        let loose = Kelvin { stiffness: 0.0, damping: 0.0 };
        let slow = Scenario { lateral_force: HarmonicForce::NONE, vertical_suspension: loose, ..scenario };
        let message = slow.check().unwrap_err().to_string();
        assert!(message.contains("vertical_suspension") && message.contains("mass of 6.25 t"), "{message}");
        Scenario { suspended_mass: 0.0, ..slow.clone() }.check().unwrap();
        let none = Scenario { inner_steps: InnerSteps::Equal(0), suspended_mass: 0.0, ..slow };
        assert!(none.check().unwrap_err().to_string().starts_with("inner_steps = 0"));
    }
}
