//! Newmark's scheme: N.M. Newmark, "A method of computation for structural dynamics", J. Eng. Mech. Div. ASCE 85 (1959).
//!
//! A step solves for the displacement at its end. What the last state carries over stands on the right-hand side.

/// Coefficients of Newmark's scheme for one step length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Newmark {
    step: f64,
    gamma: f64,
    /// Acceleration a metre of displacement, 1/(β·Δt²).
    pub acceleration: f64,
    /// Velocity a metre of displacement, γ/(β·Δt).
    pub velocity: f64,
    beta: f64,
}

/// Displacement, velocity and acceleration of one coordinate.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Motion {
    /// Displacement.
    pub u: f64,
    /// Velocity.
    pub v: f64,
    /// Acceleration.
    pub a: f64,
}

impl Motion {
    /// Whether all three are numbers.
    pub fn is_finite(&self) -> bool {
        self.u.is_finite() && self.v.is_finite() && self.a.is_finite()
    }
}

impl Newmark {
    /// Average acceleration (γ = 1/2, β = 1/4) for `dissipation` = 0; with a dissipation δ, γ = 1/2 + δ and
    /// β = (1 + δ)²/4, which damps what the step cannot resolve and costs one order of accuracy.
    pub fn new(step: f64, dissipation: f64) -> Self {
        let gamma = 0.5 + dissipation;
        let beta = 0.25 * (1.0 + dissipation).powi(2);
        Self { step, gamma, beta, acceleration: 1.0 / (beta * step * step), velocity: gamma / (beta * step) }
    }

    /// Length of the step, s.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// What a unit mass carries over from the last state: the acceleration is `self.acceleration`·u − this.
    pub fn inertia(&self, m: &Motion) -> f64 {
        self.acceleration * m.u + m.v / (self.beta * self.step) + (0.5 / self.beta - 1.0) * m.a
    }

    /// What a unit damper carries over: the velocity is `self.velocity`·u − this.
    pub fn damping(&self, m: &Motion) -> f64 {
        self.velocity * m.u
            + (self.gamma / self.beta - 1.0) * m.v
            + self.step * (0.5 * self.gamma / self.beta - 1.0) * m.a
    }

    /// Displacement and velocity at the end of the step without acceleration there. Of an acceleration there the displacement gains
    /// 1/`self.acceleration`, the velocity `self.velocity` of that.
    #[inline]
    pub fn predicted(&self, m: &Motion) -> [f64; 2] {
        let v = m.v + self.step * (1.0 - self.gamma) * m.a;
        [m.u + self.step * (m.v + self.step * (0.5 - self.beta) * m.a), v]
    }

    /// State at the end of the step, from the displacement there.
    pub fn advance(&self, m: &Motion, u: f64) -> Motion {
        let a = self.acceleration * u - self.inertia(m);
        Motion { u, v: m.v + self.step * ((1.0 - self.gamma) * m.a + self.gamma * a), a }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: displacement and velocity without an acceleration at the end, and what one adds, are those of the step. Accuracy: ROUNDOFF of an
    /// acceleration, a difference of displacements over the square of the step.
    #[test]
    fn the_prediction_is_the_step_without_acceleration() {
        const ROUNDOFF: f64 = 1e-10;
        let m = Motion { u: 0.3, v: -2.0, a: 7.0 };
        for dissipation in [0.0, 0.1] {
            let scheme = Newmark::new(0.01, dissipation);
            let [u, v] = scheme.predicted(&m);
            let a = -4.0;
            let end = scheme.advance(&m, u + a / scheme.acceleration);
            assert!((end.a - a).abs() < ROUNDOFF, "{end:?}");
            assert!((end.v - (v + a * scheme.velocity / scheme.acceleration)).abs() < ROUNDOFF, "{end:?}");
        }
    }

    /// Goal: the scheme is exact for constant acceleration, with and without dissipation.
    #[test]
    fn constant_acceleration_is_exact() {
        const ROUNDOFF: f64 = 1e-12;
        for dissipation in [0.0, 0.1] {
            let scheme = Newmark::new(0.01, dissipation);
            let mut m = Motion { u: 0.0, v: 1.0, a: 3.0 };
            for step in 1..=50 {
                let t = 0.01 * f64::from(step);
                // m·a = 3 with m = 1.
                let u = (3.0 + scheme.inertia(&m)) / scheme.acceleration;
                assert!(
                    (scheme.velocity * u - scheme.damping(&m) - (1.0 + 3.0 * t)).abs() < 100.0 * ROUNDOFF
                );
                m = scheme.advance(&m, u);
                assert!((m.u - (t + 1.5 * t * t)).abs() < ROUNDOFF);
            }
        }
    }
}
