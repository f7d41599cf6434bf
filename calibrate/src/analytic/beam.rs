//! Straight Timoshenko beams: statics, torsion with restrained warping, and
//! moving loads on simply supported spans.

use std::f64::consts::PI;

use nalgebra::{Matrix4, Vector4};

/// Stiffness of a beam against bending in one plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bending {
    /// Length, m.
    pub length: f64,
    /// Bending stiffness E·I, N·m².
    pub bending_stiffness: f64,
    /// Shear stiffness κ·G·A, N; infinite for an Euler-Bernoulli beam.
    pub shear_stiffness: f64,
}

impl Bending {
    /// Tip deflection of a cantilever a newton: `L³/(3EI) + L/(κGA)`, m/N.
    pub fn cantilever_deflection(&self) -> f64 {
        self.length.powi(3) / (3.0 * self.bending_stiffness) + self.length / self.shear_stiffness
    }

    /// Midspan deflection with both ends fixed: `L³/(192EI) + L/(4κGA)`, m/N.
    pub fn fixed_midspan_deflection(&self) -> f64 {
        self.length.powi(3) / (192.0 * self.bending_stiffness) + self.length / (4.0 * self.shear_stiffness)
    }

    /// Midspan deflection of a simply supported beam: `L³/(48EI) + L/(4κGA)`, m/N.
    pub fn pinned_midspan_deflection(&self) -> f64 {
        self.length.powi(3) / (48.0 * self.bending_stiffness) + self.length / (4.0 * self.shear_stiffness)
    }
}

/// Midspan rotation a newton metre of a bar with both ends fixed, with St-Venant torsion only: `L/(4GJ)`, rad/(N·m).
pub fn fixed_midspan_twist(length: f64, torsion_stiffness: f64) -> f64 {
    length / (4.0 * torsion_stiffness)
}

/// Factor by which restrained warping reduces [`fixed_midspan_twist`] (Vlasov).
///
/// Each half, of length l = L/2, cannot warp at the fixed end nor, by symmetry,
/// at midspan. From `G·J·θ' − E·Iw·θ''' = T/2` follows `1 − tanh(κl/2)/(κl/2)`
/// with `κ = √(GJ/(E·Iw))`. `torsion_stiffness` is G·J (N·m²), `warping_stiffness` E·Iw (N·m⁴).
pub fn restrained_warping_factor(length: f64, torsion_stiffness: f64, warping_stiffness: f64) -> f64 {
    let x = 0.25 * length * (torsion_stiffness / warping_stiffness).sqrt();
    // 1 − tanh(x)/x cancels for small x; its series starts with x²/3.
    if x < 1e-3 { x * x / 3.0 * (1.0 - 0.4 * x * x) } else { 1.0 - x.tanh() / x }
}

/// Rotation a newton metre (rad/(N·m)) at `at` of a bar whose ends neither turn nor warp, twisted at `load`; both in m from its first end (Vlasov).
///
/// In a bar without ends `G·J·θ″ − E·Iw·θ⁗ = −δ(x)` has the solution `−(|x| + e^(−κ|x|)/κ)/(2GJ)`; a linear function and what fades from the ends with `e^(−κx)` make
/// rotation and warping zero there. Stiffnesses as of [`restrained_warping_factor`].
pub fn restrained_twist(
    length: f64,
    torsion_stiffness: f64,
    warping_stiffness: f64,
    load: f64,
    at: f64,
) -> f64 {
    let kappa = (torsion_stiffness / warping_stiffness).sqrt();
    // in units of 1/(2GJ), with its slope towards larger x
    let free = |x: f64| {
        let away = x - load;
        let fading = (-kappa * away.abs()).exp();
        [-(away.abs() + fading / kappa), -away.signum() * (1.0 - fading)]
    };
    let fades = (-kappa * length).exp();
    // at both ends: rotation and slope of 1, x, e^(-κx)/κ and e^(-κ(L-x))/κ
    let ends = Matrix4::new(
        1.0,
        0.0,
        1.0 / kappa,
        fades / kappa, //
        0.0,
        1.0,
        -1.0,
        fades, //
        1.0,
        length,
        fades / kappa,
        1.0 / kappa, //
        0.0,
        1.0,
        -fades,
        1.0,
    );
    let [[turned, slope], [turned_there, slope_there]] = [free(0.0), free(length)];
    let right = -Vector4::new(turned, slope, turned_there, slope_there);
    // a bar of a length has four independent functions
    let factors = ends.lu().solve(&right).unwrap_or_else(|| Vector4::repeat(f64::NAN));
    let functions =
        Vector4::new(1.0, at, (-kappa * at).exp() / kappa, (-kappa * (length - at)).exp() / kappa);
    (free(at)[0] + factors.dot(&functions)) / (2.0 * torsion_stiffness)
}

/// A simply supported span for moving loads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Stiffness and length.
    pub bending: Bending,
    /// Mass a metre, kg/m.
    pub mass_per_length: f64,
    /// Rotary inertia a metre ρ·I, kg·m; 0 for an Euler-Bernoulli beam.
    pub rotary_inertia: f64,
}

impl Span {
    /// Deflection (m) at `x` (m) and `time` (s) under a constant `force` (N) that moves with `speed` (m/s).
    /// The force entered the span at x = 0 and t = 0 and is still on it. The series has `terms` terms.
    /// Source: Frýba, Vibration of Solids and Structures under Moving Loads, chapter 1, extended to the two
    /// branches of the Timoshenko beam.
    pub fn moving_force_deflection(&self, force: f64, speed: f64, x: f64, time: f64, terms: usize) -> f64 {
        (1..=terms)
            .map(|n| {
                let wave_number = n as f64 * PI / self.bending.length;
                let load = 2.0 * force / self.bending.length;
                let driving = wave_number * speed;
                let amplitude: f64 = self
                    .branches(wave_number)
                    .iter()
                    .map(|&(frequency, weight)| {
                        load * weight / (frequency * frequency - driving * driving)
                            * ((driving * time).sin() - driving / frequency * (frequency * time).sin())
                    })
                    .sum();
                amplitude * (wave_number * x).sin()
            })
            .sum()
    }

    /// Circular frequencies (rad/s) of the bending and the shear branch at a wave number, each with
    /// the square of its mass-normalised deflection (1/(kg/m)). An Euler-Bernoulli beam has one branch.
    pub fn branches(&self, wave_number: f64) -> Vec<(f64, f64)> {
        let (mass, inertia) = (self.mass_per_length, self.rotary_inertia);
        let bending = self.bending.bending_stiffness * wave_number.powi(2);
        let shear = self.bending.shear_stiffness;
        if shear.is_infinite() {
            let stiffness = bending * wave_number.powi(2);
            return vec![((stiffness / mass).sqrt(), 1.0 / mass)];
        }
        // K = [[Sq², −Sq], [−Sq, S + EIq²]] on the amplitudes of deflection and rotation.
        let (k11, k12, k22) = (shear * wave_number.powi(2), -shear * wave_number, shear + bending);
        if inertia == 0.0 {
            return vec![(((k11 - k12 * k12 / k22) / mass).sqrt(), 1.0 / mass)];
        }
        let half_trace = 0.5 * (k11 / mass + k22 / inertia);
        let determinant = shear * wave_number.powi(2) * bending / (mass * inertia);
        let root = (half_trace * half_trace - determinant).sqrt();
        // The small root from the product of the roots: no cancellation.
        [determinant / (half_trace + root), half_trace + root]
            .iter()
            .map(|&square| {
                // Second row: −Sq·w + (k22 − ρI·ω²)·φ = 0.
                let deflection = k22 - inertia * square;
                let weight = deflection.powi(2) / (mass * deflection.powi(2) + inertia * k12.powi(2));
                (square.sqrt(), weight)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUNDOFF: f64 = 1e-12;
    const BENDING: Bending = Bending { length: 2.0, bending_stiffness: 5e6, shear_stiffness: 3e7 };

    /// Integrates EI·φ' = M, w' = φ + V/κGA of half a beam by the unit-load theorem with Simpson's rule (exact for cubics).
    fn unit_load(moment: impl Fn(f64) -> f64, shear: f64, length: f64) -> f64 {
        let square = |x: f64| moment(x).powi(2) / BENDING.bending_stiffness;
        length / 6.0 * (square(0.0) + 4.0 * square(0.5 * length) + square(length))
            + shear * shear * length / BENDING.shear_stiffness
    }

    #[test]
    fn statics_agree_with_the_unit_load_theorem() {
        let l = BENDING.length;
        let cantilever = unit_load(|x| l - x, 1.0, l);
        assert!((BENDING.cantilever_deflection() / cantilever - 1.0).abs() < ROUNDOFF);
        let fixed = 2.0 * unit_load(|x| 0.5 * x - l / 8.0, 0.5, 0.5 * l);
        assert!((BENDING.fixed_midspan_deflection() / fixed - 1.0).abs() < ROUNDOFF);
        let pinned = 2.0 * unit_load(|x| 0.5 * x, 0.5, 0.5 * l);
        assert!((BENDING.pinned_midspan_deflection() / pinned - 1.0).abs() < ROUNDOFF);
    }

    /// Source: independent estimates for the published 0.555 m stub of 60E1, E 210 GPa (N/m).
    #[test]
    fn stub_has_printed_stiffness() {
        let stub = |shear: f64| Bending {
            length: 0.555,
            bending_stiffness: 210e9 * 3038.3e-8,
            shear_stiffness: shear,
        };
        let euler = 1.0 / stub(f64::INFINITY).fixed_midspan_deflection();
        assert!((euler - 7.17e9).abs() < 0.005e9);
        for (coefficient, stiffness) in [(0.34, 1.25e9), (0.40, 1.43e9)] {
            let shear = coefficient * 210e9 / 2.6 * 76.7e-4;
            assert!((1.0 / stub(shear).fixed_midspan_deflection() - stiffness).abs() < 0.005e9);
        }
    }

    /// Goal: Vlasov's factor solves the boundary value problem. Shooting with 4000
    /// midpoint steps leaves about 1e-7.
    #[test]
    fn warping_factor_solves_the_boundary_value_problem() {
        const DISCRETISATION: f64 = 1e-6;
        let (length, torsion, warping) = (0.555, 1.78e5, 3.36e3);
        let half = 0.5 * length;
        // Unknown u = θ': EIw·u'' = GJ·u − T/2, u(0) = u(l) = 0; linear, so two shots suffice.
        let shoot = |slope: f64, torque: f64| {
            let (steps, mut u, mut v, mut angle) = (4000, 0.0, slope, 0.0);
            let h = half / f64::from(steps);
            for _ in 0..steps {
                let curvature = |u: f64| (torsion * u - 0.5 * torque) / warping;
                let (um, vm) = (u + 0.5 * h * v, v + 0.5 * h * curvature(u));
                u += h * vm;
                v += h * curvature(um);
                angle += h * um;
            }
            (u, angle)
        };
        let (particular, free) = (shoot(0.0, 1.0), shoot(1.0, 0.0));
        let twist = particular.1 - particular.0 / free.0 * free.1;
        let exact =
            fixed_midspan_twist(length, torsion) * restrained_warping_factor(length, torsion, warping);
        assert!((twist / exact - 1.0).abs() < DISCRETISATION, "{twist:e} {exact:e}");
        // Limits: no warping stiffness, and a series for very large.
        assert!((restrained_warping_factor(1.0, 1.0, 1e-12) - 1.0).abs() < 1e-5);
        let below = restrained_warping_factor(0.0039, 1.0, 1.0);
        let above = restrained_warping_factor(0.0041, 1.0, 1.0);
        assert!((above / below / (0.0041f64 / 0.0039).powi(2) - 1.0).abs() < 1e-6);
    }

    /// Source: [`restrained_warping_factor`] at midspan; Betti's theorem; without warping stiffness Saint-Venant's bar, `ab/(L·GJ)`, and without torsion stiffness the beam that its equation is that
    /// of, fixed at both ends, `a³b³/(3L³·EI)`. Goal: rotation (rad/(N·m)) of a bar of 0.5 m. Accuracy: ROUNDOFF times what cancels, κL = 0.05 to the fourth power; MODEL, the square of the stiffness that
    /// the limit leaves out.
    #[test]
    fn a_bar_that_cannot_warp_at_its_ends_turns_everywhere() {
        const ROUNDOFF: f64 = 1e-8;
        const MODEL: f64 = 1e-3;
        let length = 0.5;
        let off = |a: f64, b: f64| (a / b - 1.0).abs();
        for (torsion, warping) in [(1.8e5, 3.3e3), (1.8e5, 33.0), (4.0, 400.0)] {
            let twist = |load, at| restrained_twist(length, torsion, warping, load, at);
            let middle =
                fixed_midspan_twist(length, torsion) * restrained_warping_factor(length, torsion, warping);
            assert!(off(twist(0.25, 0.25), middle) < ROUNDOFF, "{} {middle}", twist(0.25, 0.25));
            assert!(off(twist(0.1, 0.3), twist(0.3, 0.1)) < ROUNDOFF);
            assert!(off(twist(0.1, 0.3), twist(0.4, 0.2)) < ROUNDOFF, "mirror image");
            assert!(
                twist(0.1, 0.0).abs() < ROUNDOFF * middle && twist(0.1, length).abs() < ROUNDOFF * middle
            );
        }
        let (a, b) = (0.2, 0.3);
        assert!(off(restrained_twist(length, 1e5, 1e5 * 1e-9, a, a), a * b / (length * 1e5)) < MODEL);
        let beam = (a * b / length).powi(3) / (3.0 * 400.0);
        assert!(off(restrained_twist(length, 4.0, 400.0, a, a), beam) < MODEL);
        // a long bar: both parts that fade are far from each other
        let long = restrained_twist(1000.0, 1.8e5, 3.3e3, 500.0, 500.0);
        assert!(off(long, 1000.0 / (4.0 * 1.8e5)) < MODEL, "{long}");
    }

    /// Limit: a load that creeps over gives the static deflection. Over 100 s the dynamic part is below 1e-4; 200 terms leave 1e-4 of the shear part.
    #[test]
    fn creeping_force_gives_statics() {
        const MODEL: f64 = 1e-3;
        let mut span = Span { bending: BENDING, mass_per_length: 60.0, rotary_inertia: 0.3 };
        for shear in [3e7, f64::INFINITY] {
            span.bending.shear_stiffness = shear;
            let midspan = span.moving_force_deflection(1.0, 0.02, 1.0, 50.0, 400);
            assert!((midspan / span.bending.pinned_midspan_deflection() - 1.0).abs() < MODEL);
        }
        // The Timoshenko branches approach the Euler frequency when shear and rotary inertia vanish.
        span.bending.shear_stiffness = 1e16;
        span.rotary_inertia = 1e-6;
        let euler = (5e6 * (PI / 2.0).powi(4) / 60.0f64).sqrt();
        assert!((span.branches(PI / 2.0)[0].0 / euler - 1.0).abs() < 1e-6);
    }
}
