//! Two power laws, one below a force and one above it, with a step of the stiffness between: a contact that begins to bear
//! in a wider or in a second region as the load grows.
//!
//! `k(f) = b·(f/f0)^c · (1 + t)^((e - c)/p) · (1 + d·t/(1 + t))` with `t = (f/f1)^p`: the exponent is `c` far below `f1` and `e` far above
//! it, the stiffness steps up by the factor `1 + d`, and both within a factor of about `9^(1/p)` of `f1` either way. Every factor
//! rises with the force, so that the law does, whatever its constants. `e = c` leaves one power with a step, `d = 0` a bend.

use super::inverse::force_at;
use super::power::REFERENCE_FORCE;
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::quadrature::GAUSS_12;

/// Beyond so many units of `p·ln(f/f1)` from the step the law is one of its powers, to rounding.
const FAR: f64 = 37.0;

/// The six constants of a [`StepLaw`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepConstants {
    /// Factor of the power below the step, N/m at [`REFERENCE_FORCE`].
    pub b: f64,
    /// Exponent below the step.
    pub c: f64,
    /// Force of the step, `f1`, N.
    pub step_force: f64,
    /// Sharpness of the step, `p`.
    pub sharpness: f64,
    /// Rise of the stiffness across the step, `d`, relative.
    pub rise: f64,
    /// Exponent above the step, `e`.
    pub exponent_above: f64,
}

/// Logarithm of the stiffness and what it is made of, at a logarithm of the force.
pub(super) struct Local {
    /// ln k.
    pub stiffness: f64,
    /// ln(f/f0).
    pub x: f64,
    /// ln(f/f1).
    pub beyond: f64,
    /// ln(1 + t).
    pub bend: f64,
    /// t/(1 + t), from 0 below the step to 1 above.
    pub part: f64,
}

impl StepConstants {
    /// At ln(f/f0).
    pub(super) fn local(&self, x: f64) -> Local {
        let beyond = x - (self.step_force / REFERENCE_FORCE).ln();
        let z = self.sharpness * beyond;
        // ln(1 + e^z) and 1/(1 + e^-z) without overflow
        let bend = z.max(0.0) + (-z.abs()).exp().ln_1p();
        let part = (z - bend).exp();
        let stiffness = self.b.ln()
            + self.c * x
            + (self.exponent_above - self.c) / self.sharpness * bend
            + (self.rise * part).ln_1p();
        Local { stiffness, x, beyond, bend, part }
    }
}

/// A node of the integrals.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Node {
    /// ln(f/f0).
    x: f64,
    /// Displacement, m.
    displacement: f64,
    /// Energy, J.
    energy: f64,
}

/// Tangent stiffness of two power laws with a step between.
#[derive(Debug, Clone, PartialEq)]
pub struct StepLaw {
    constants: StepConstants,
    /// The integrals at equal distances through the step, so that either side of it is a power.
    nodes: Vec<Node>,
}

impl StepLaw {
    /// A law from its constants.
    ///
    /// # Errors
    /// [`InputError`] with key `law` unless b > 0, 0 ≤ c < 1, 0 ≤ e < 1, d ≥ 0, f1 > 0 and 0.5 ≤ p ≤ 20, all finite.
    pub fn new(constants: StepConstants) -> Result<Self> {
        let StepConstants { b, c, step_force, sharpness, rise, exponent_above } = constants;
        let positive = |value: f64| value > 0.0 && value.is_finite();
        let exponent = |value| (0.0..1.0).contains(&value);
        let good = positive(b)
            && positive(step_force)
            && exponent(c)
            && exponent(exponent_above)
            && (0.5..=20.0).contains(&sharpness)
            && rise >= 0.0
            && rise.is_finite();
        if !good {
            return InputError::refuse(
                "law",
                format!(
                    "b = {b} N/m, c = {c}, f1 = {step_force} N, p = {sharpness}, d = {rise}, e = {exponent_above}"
                ),
                "b > 0, 0 ≤ c < 1, f1 > 0, 0.5 ≤ p ≤ 20, d ≥ 0 and 0 ≤ e < 1",
                "fit the law to stiffness that is positive and does not fall with the force",
            );
        }
        // the nearest poles lie π/p off the real axis: 12 Gauss points on such panels leave 1e-16
        let panel = 0.5 / sharpness.max(1.0);
        let middle = (step_force / REFERENCE_FORCE).ln();
        let half = (FAR / sharpness / panel).ceil();
        let first = middle - half * panel;
        let mut law = Self { constants, nodes: Vec::with_capacity(2 * half as usize + 1) };
        let [mut displacement, mut energy] = law.power_from_zero(first);
        law.nodes.push(Node { x: first, displacement, energy });
        for i in 1..=2 * half as usize {
            let x = first + i as f64 * panel;
            let [further, more] = law.between(x - panel, x);
            displacement += further;
            energy += more;
            law.nodes.push(Node { x, displacement, energy });
        }
        Ok(law)
    }

    /// Its constants.
    pub fn constants(&self) -> StepConstants {
        self.constants
    }

    /// Tangent stiffness, N/m, at `force` (N); a force below zero counts as zero.
    pub fn tangent(&self, force: f64) -> f64 {
        if force.is_nan() {
            return f64::NAN;
        }
        if force <= 0.0 {
            return if self.constants.c == 0.0 { self.constants.b } else { 0.0 };
        }
        self.constants.local((force / REFERENCE_FORCE).ln()).stiffness.exp()
    }

    /// Displacement, m, under `force` (N), `∫ df/k` from 0; 0 for a force below zero.
    pub fn displacement(&self, force: f64) -> f64 {
        self.moments(force)[0]
    }

    /// Energy stored under `force` (N), `∫ f df/k`, J; 0 for a force below zero.
    pub fn energy(&self, force: f64) -> f64 {
        self.moments(force)[1]
    }

    /// Force, N, at `displacement` (m), with a `guess` (N) of it: the inverse of [`Self::displacement`] to 1e-13 relative; 0 for a
    /// displacement of zero or below.
    pub fn force_from(&self, displacement: f64, guess: f64) -> f64 {
        let start = if guess > 0.0 { guess } else { self.tangent(REFERENCE_FORCE) * displacement };
        force_at(displacement, start, |force| (self.displacement(force), self.tangent(force)))
    }

    /// Displacement and energy under `force`.
    fn moments(&self, force: f64) -> [f64; 2] {
        if force.is_nan() {
            return [f64::NAN; 2];
        }
        if force <= 0.0 {
            return [0.0; 2];
        }
        let x = (force / REFERENCE_FORCE).ln();
        let (first, last) = (self.nodes[0], self.nodes[self.nodes.len() - 1]);
        if x <= first.x {
            return self.power_from_zero(x);
        }
        let (from, further) = if x >= last.x {
            (last, self.power_between(last.x, x))
        } else {
            let from = self.nodes[self.nodes.partition_point(|node| node.x <= x) - 1];
            (from, self.between(from.x, x))
        };
        [from.displacement + further[0], from.energy + further[1]]
    }

    /// Force and compliance at ln(f/f0).
    fn at(&self, x: f64) -> [f64; 2] {
        [REFERENCE_FORCE * x.exp(), (-self.constants.local(x).stiffness).exp()]
    }

    /// Both integrals from no load to `x`, far below the step.
    fn power_from_zero(&self, x: f64) -> [f64; 2] {
        let [force, compliance] = self.at(x);
        let c = self.constants.c;
        [force * compliance / (1.0 - c), force * force * compliance / (2.0 - c)]
    }

    /// Both integrals between two places far above the step.
    fn power_between(&self, from: f64, to: f64) -> [f64; 2] {
        let ([low, soft], [high, stiff]) = (self.at(from), self.at(to));
        let e = self.constants.exponent_above;
        [(high * stiff - low * soft) / (1.0 - e), (high * high * stiff - low * low * soft) / (2.0 - e)]
    }

    /// Both integrals over one panel through the step, `∫ f/k dx` and `∫ f²/k dx`.
    fn between(&self, from: f64, to: f64) -> [f64; 2] {
        let half = 0.5 * (to - from);
        let mut sums = [0.0; 2];
        for (t, weight) in GAUSS_12 {
            let [force, compliance] = self.at(from + half * (1.0 + t));
            let value = half * weight * force * compliance;
            sums[0] += value;
            sums[1] += value * force;
        }
        sums
    }
}
