//! A block on a plane with Coulomb friction.

/// A block pressed on a plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// Mass, kg.
    pub mass: f64,
    /// Friction force while sliding, μ·N, in N.
    pub friction_force: f64,
}

impl Block {
    /// Displacement (m) at `time` (s) of a block that starts at `speed` (m/s) and is braked by friction until it sticks.
    pub fn coast(&self, speed: f64, time: f64) -> f64 {
        let t = time.clamp(0.0, self.stopping_time(speed));
        speed * t - speed.signum() * 0.5 * self.friction_force / self.mass * t * t
    }

    /// Time (s) at which a block that starts at `speed` (m/s) comes to rest.
    pub fn stopping_time(&self, speed: f64) -> f64 {
        speed.abs() * self.mass / self.friction_force
    }

    /// Displacement (m) at `time` (s) under a force that grows from zero by
    /// `force_rate` (N/s): the block sticks until the force passes the friction.
    pub fn pulled(&self, force_rate: f64, time: f64) -> f64 {
        let sliding = (time - self.breakaway_time(force_rate)).max(0.0);
        force_rate * sliding.powi(3) / (6.0 * self.mass)
    }

    /// Time (s) at which a force that grows by `force_rate` (N/s) passes the friction.
    pub fn breakaway_time(&self, force_rate: f64) -> f64 {
        self.friction_force / force_rate.abs()
    }

    /// Displacement (m) at `time` (s) of a block on a spring (`stiffness`, N/m), released at
    /// `start` (m) at rest: half swings about ±μN/k, each smaller by 2μN/k, until it sticks.
    pub fn released(&self, stiffness: f64, start: f64, time: f64) -> f64 {
        let offset = self.friction_force / stiffness;
        let half_period = std::f64::consts::PI * (self.mass / stiffness).sqrt();
        let (mut amplitude, mut side, mut rest) = (start.abs(), start.signum(), time.max(0.0));
        while amplitude > offset {
            if rest < half_period {
                let angle = std::f64::consts::PI * rest / half_period;
                return side * (offset + (amplitude - offset) * angle.cos());
            }
            amplitude -= 2.0 * offset;
            side = -side;
            rest -= half_period;
        }
        side * amplitude
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Central second differences with h = 1e-4 s: h²/12·x'''' and 1e-16/h² are both below 1e-6 m/s².
    const DISCRETISATION: f64 = 1e-5;
    const BLOCK: Block = Block { mass: 2.0, friction_force: 10.0 };

    fn acceleration(x: impl Fn(f64) -> f64, t: f64) -> f64 {
        let h = 1e-4;
        (x(t + h) - 2.0 * x(t) + x(t - h)) / (h * h)
    }

    #[test]
    fn solutions_obey_newtons_law() {
        assert!((acceleration(|t| BLOCK.coast(3.0, t), 0.2) + 5.0).abs() < DISCRETISATION);
        assert!((acceleration(|t| BLOCK.coast(-3.0, t), 0.2) - 5.0).abs() < DISCRETISATION);
        assert!((BLOCK.coast(3.0, 10.0) - 0.9).abs() < DISCRETISATION);
        // 20 N/s: breaks away at 0.5 s; at 0.8 s the net force is 16 − 10 N.
        assert!((acceleration(|t| BLOCK.pulled(20.0, t), 0.8) - 3.0).abs() < DISCRETISATION);
        assert_eq!(BLOCK.pulled(20.0, 0.49), 0.0);
        // Moving towards negative x, the friction pulls towards positive x.
        let (stiffness, start, t) = (200.0, 0.5, 0.1);
        let x = BLOCK.released(stiffness, start, t);
        let exact = (-stiffness * x + BLOCK.friction_force) / BLOCK.mass;
        assert!(
            (acceleration(|t| BLOCK.released(stiffness, start, t), t) - exact).abs() < 10.0 * DISCRETISATION
        );
    }

    #[test]
    fn released_block_loses_two_offsets_a_half_swing_and_sticks() {
        let half_period = std::f64::consts::PI * (2.0f64 / 200.0).sqrt();
        const ROUNDOFF: f64 = 1e-12;
        // Offset 0.05 m: 0.27 → −0.17 → 0.07 → +0.03 on the other side, where it sticks.
        for (swings, x) in [(1.0, -0.17), (2.0, 0.07), (3.0, 0.03), (9.0, 0.03)] {
            let value = BLOCK.released(200.0, 0.27, swings * half_period * (1.0 + 1e-15));
            assert!((value.abs() - f64::abs(x)).abs() < ROUNDOFF, "{swings}: {value}");
        }
    }
}
