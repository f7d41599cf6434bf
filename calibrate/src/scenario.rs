//! What happens to the wheel: the suspension, the forces and the time steps
//! (publication, section 4). The solid model and the moving solver run the
//! very same [`Scenario`].

use std::f64::consts::TAU;

/// A force `constant + amplitude·sin(2π·frequency·t + phase)`.
#[derive(Debug, Clone, Copy, PartialEq)]
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
    /// use railspring_calibrate::scenario::HarmonicForce;
    /// let force = HarmonicForce { constant: 10.0, amplitude: 5.0, frequency: 10.0, phase: 0.0 };
    /// assert!((force.at(0.025) - 15.0).abs() < 1e-12);
    /// ```
    pub fn at(&self, t: f64) -> f64 {
        self.constant + self.amplitude * (TAU * self.frequency * t + self.phase).sin()
    }
}

/// Spring and damper in parallel (Kelvin element).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kelvin {
    /// Stiffness, N/m.
    pub stiffness: f64,
    /// Damping, N·s/m.
    pub damping: f64,
}

/// A dynamic load case on one wheel.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// Number of time steps after the initial state.
    pub steps: usize,
    /// Time step, s.
    pub time_step: f64,
    /// Coulomb friction coefficient of wheel on rail.
    pub friction: f64,
    /// Gravity, m/s², acting on the wheel and the suspended mass; 0 leaves it out.
    pub gravity: f64,
    /// Suspended mass on the vertical spring and damper, kg.
    pub suspended_mass: f64,
    /// Vertical spring and damper between the wheel centre and the suspended mass.
    pub vertical_suspension: Kelvin,
    /// Force on the suspended mass, N, positive down.
    pub vertical_force: HarmonicForce,
    /// Lateral spring and damper between the wheel centre and the (massless) point
    /// where the lateral force acts; it hands the force on unchanged.
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
