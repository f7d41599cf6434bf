//! A law by knots, the alternative to the power law where one power does not follow the contact.
//!
//! The tangent stiffness is a monotone cubic between the knots, its logarithm over that of the force (F.N. Fritsch,
//! R.E. Carlson, "Monotone piecewise cubic interpolation", SIAM J. Numer. Anal. 17 (1980); derivatives at the knots by
//! F.N. Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984)). So it is positive, rises where the knots rise and nowhere
//! else, and a power law is met exactly. Displacement and energy are integrals of it from no load, as with
//! [`StiffnessLaw`](super::StiffnessLaw).

use super::inverse::INVERSE_TOLERANCE;
use super::points::{Solid, ascending, check_points, check_solid};
use super::power::LARGEST_EXPONENT;
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::quadrature::GAUSS_12;

/// Tangent stiffness by knots.
#[derive(Debug, Clone, PartialEq)]
pub struct TableLaw {
    knots: Vec<Knot>,
    /// Exponent of the power law below the first knot.
    below: f64,
}

/// A knot with what belongs to the law up to it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Knot {
    /// ln of the force over 1 N.
    x: f64,
    /// ln of the stiffness over 1 N/m.
    y: f64,
    /// dy/dx, the exponent of the power law that touches the law here.
    slope: f64,
    /// Displacement, m.
    displacement: f64,
    /// Energy, J.
    energy: f64,
}

impl TableLaw {
    /// The law through `tangents` (N/m) at `forces` (N), four at least, the forces ascending.
    ///
    /// Below the first knot the law is the power law that touches it, its exponent kept between 0 and 0.95; above the last
    /// knot the stiffness stays what it is there.
    ///
    /// ```
    /// use railspring_calibrate::law::{StiffnessLaw, TableLaw};
    /// let hertz = StiffnessLaw::hertz(115e9, 0.4);
    /// let forces = [2e3, 10e3, 40e3, 90e3, 150e3];
    /// let table = TableLaw::new(&forces, &forces.map(|f| hertz.tangent(f))).unwrap();
    /// assert!((table.displacement(60e3) / hertz.displacement(60e3) - 1.0).abs() < 1e-12);
    /// ```
    ///
    /// # Errors
    /// [`InputError`] for lists of different length, fewer than four knots, values that are not positive and finite, and
    /// forces that do not ascend.
    pub fn new(forces: &[f64], tangents: &[f64]) -> Result<Self> {
        Self::with_exponent_below(forces, tangents, None)
    }

    /// The law through the tangents of the solid, with the displacement of the first load: the power law below it has the exponent that makes this
    /// displacement, kept between 0 and 0.95.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn of_solid(solid: &[Solid]) -> Result<Self> {
        check_solid(solid)?;
        let (forces, tangents): (Vec<f64>, Vec<f64>) = solid.iter().map(|at| (at.force, at.tangent)).unzip();
        // F/k over 1 - c is the displacement of a power law
        let exponent = solid.first().map(|at| 1.0 - at.force / (at.tangent * at.displacement));
        Self::with_exponent_below(&forces, &tangents, exponent.map(|c| c.clamp(0.0, LARGEST_EXPONENT)))
    }

    /// As [`Self::new`], with the exponent below the first knot; without one, that of the power law that touches the law there.
    ///
    /// # Errors
    /// Those of [`Self::new`], and an exponent below 0 or of at least 1.
    pub fn with_exponent_below(forces: &[f64], tangents: &[f64], exponent: Option<f64>) -> Result<Self> {
        check_points(forces, tangents)?;
        if let Some(exponent) = exponent.filter(|exponent| !(0.0..1.0).contains(exponent)) {
            return InputError::refuse(
                "law.exponent_below",
                exponent,
                "a number from 0 to below 1",
                "leave it out: the law then goes on as it begins",
            );
        }
        ascending(forces)?;
        let place = |values: &[f64]| values.iter().map(|v| v.ln()).collect::<Vec<_>>();
        let (x, y) = (place(forces), place(tangents));
        let slopes = monotone_slopes(&x, &y);
        let below = exponent.unwrap_or_else(|| slopes[0].clamp(0.0, LARGEST_EXPONENT));
        let mut law = Self { knots: Vec::with_capacity(x.len()), below };
        for i in 0..x.len() {
            let knot = Knot { x: x[i], y: y[i], slope: slopes[i], displacement: 0.0, energy: 0.0 };
            law.knots.push(knot);
        }
        let first = &mut law.knots[0];
        first.displacement = forces[0] / tangents[0] / (1.0 - below);
        first.energy = forces[0] * forces[0] / tangents[0] / (2.0 - below);
        for i in 1..x.len() {
            let [displacement, energy] = law.between(i - 1, x[i - 1], x[i]);
            let before = law.knots[i - 1];
            law.knots[i].displacement = before.displacement + displacement;
            law.knots[i].energy = before.energy + energy;
        }
        Ok(law)
    }

    /// Forces (N) and tangents (N/m) of the knots.
    pub fn knots(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.knots.iter().map(|knot| (knot.x.exp(), knot.y.exp()))
    }

    /// Exponent of the power law below the first knot.
    pub fn exponent_below(&self) -> f64 {
        self.below
    }

    /// Tangent stiffness, N/m, at `force` (N); a force below zero counts as zero.
    pub fn tangent(&self, force: f64) -> f64 {
        if force.is_nan() {
            return f64::NAN;
        }
        let (first, last) = self.ends();
        let x = force.max(0.0).ln();
        if x <= first.x {
            // 0 at no load, but for a constant
            return first.y.exp() * (x - first.x).exp().powf(self.below);
        }
        if x >= last.x { last.y.exp() } else { self.logarithm(self.segment(x), x).exp() }
    }

    /// Displacement, m, under `force` (N), `∫ df/k` from 0; 0 for a force below zero.
    pub fn displacement(&self, force: f64) -> f64 {
        self.moments(force)[0]
    }

    /// Energy stored under `force` (N), J: `∫ f df/k`.
    pub fn energy(&self, force: f64) -> f64 {
        self.moments(force)[1]
    }

    /// Force, N, at `displacement` (m): the inverse of [`Self::displacement`] to 1e-13 relative; 0 for a displacement of
    /// zero or below.
    pub fn force(&self, displacement: f64) -> f64 {
        if displacement.is_nan() {
            return f64::NAN;
        }
        if displacement <= 0.0 {
            return 0.0;
        }
        let (first, last) = self.ends();
        if displacement <= first.displacement {
            return first.x.exp() * (displacement / first.displacement).powf(1.0 / (1.0 - self.below));
        }
        if displacement >= last.displacement {
            return last.x.exp() + last.y.exp() * (displacement - last.displacement);
        }
        let after = self.knots.partition_point(|knot| knot.displacement <= displacement);
        let (mut low, mut high) = (self.knots[after - 1].x.exp(), self.knots[after].x.exp());
        let part = (displacement - self.knots[after - 1].displacement)
            / (self.knots[after].displacement - self.knots[after - 1].displacement);
        let mut force = low + part * (high - low);
        for _ in 0..100 {
            let off = displacement - self.displacement(force);
            if off > 0.0 {
                low = force
            } else {
                high = force
            }
            let newton = force + self.tangent(force) * off;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let change = (next - force).abs();
            force = next;
            if change <= INVERSE_TOLERANCE * force {
                break;
            }
        }
        force
    }

    /// How far the law is off between its knots, estimated by leaving out each inner knot in turn: the relative deviation of the tangent of
    /// the others there. Empty for four knots, which leave too few.
    pub fn left_out(&self) -> Vec<f64> {
        let without = |out: usize| {
            let rest = self.knots().enumerate().filter(|(i, _)| *i != out).map(|(_, knot)| knot);
            let (forces, tangents): (Vec<f64>, Vec<f64>) = rest.unzip();
            let Knot { x, y, .. } = self.knots[out];
            Some(
                Self::with_exponent_below(&forces, &tangents, Some(self.below)).ok()?.tangent(x.exp())
                    / y.exp()
                    - 1.0,
            )
        };
        (1..self.knots.len() - 1).filter_map(without).collect()
    }

    fn ends(&self) -> (&Knot, &Knot) {
        (&self.knots[0], &self.knots[self.knots.len() - 1])
    }

    /// Displacement and energy under `force`.
    fn moments(&self, force: f64) -> [f64; 2] {
        if force.is_nan() {
            return [f64::NAN; 2];
        }
        if force <= 0.0 {
            return [0.0; 2];
        }
        let (first, last) = self.ends();
        let x = force.ln();
        if x <= first.x {
            let flexible = force / self.tangent(force);
            return [flexible / (1.0 - self.below), force * flexible / (2.0 - self.below)];
        }
        if x >= last.x {
            let (from, stiffness) = (last.x.exp(), last.y.exp());
            let further = 0.5 * (force - from) * (force + from) / stiffness;
            return [last.displacement + (force - from) / stiffness, last.energy + further];
        }
        let i = self.segment(x);
        let [displacement, energy] = self.between(i, self.knots[i].x, x);
        [self.knots[i].displacement + displacement, self.knots[i].energy + energy]
    }

    /// The segment that holds `x`, between the first knot and the last.
    fn segment(&self, x: f64) -> usize {
        self.knots.partition_point(|knot| knot.x <= x).clamp(1, self.knots.len() - 1) - 1
    }

    /// ln k in segment `i` (Hermite).
    fn logarithm(&self, i: usize, x: f64) -> f64 {
        let (a, b) = (&self.knots[i], &self.knots[i + 1]);
        let h = b.x - a.x;
        let t = (x - a.x) / h;
        let s = 1.0 - t;
        s * s * (1.0 + 2.0 * t) * a.y
            + t * t * (1.0 + 2.0 * s) * b.y
            + h * s * t * (s * a.slope - t * b.slope)
    }

    /// `∫ df/k` and `∫ f df/k` between the logarithms `from` and `to` of forces in segment `i`, by panels of at most 1/2: the
    /// integrand is the exponential of a cubic.
    fn between(&self, i: usize, from: f64, to: f64) -> [f64; 2] {
        const PANEL: f64 = 0.5;
        let panels = ((to - from) / PANEL).ceil().max(1.0);
        let half = 0.5 * (to - from) / panels;
        let mut sums = [0.0; 2];
        let mut middle = from + half;
        while middle < to {
            for (t, weight) in GAUSS_12 {
                let x = middle + half * t;
                let value = half * weight * (x - self.logarithm(i, x)).exp();
                sums[0] += value;
                sums[1] += value * x.exp();
            }
            middle += 2.0 * half;
        }
        sums
    }
}

/// Derivatives at the points of a monotone cubic: the weighted harmonic mean of the slopes on either side, 0 where these
/// differ in sign; at the ends from a parabola, kept to the sign and to three times the slope of the end.
fn monotone_slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let n = x.len();
    let h: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
    let chord: Vec<f64> = y.windows(2).zip(&h).map(|(w, h)| (w[1] - w[0]) / h).collect();
    let end = |h0: f64, h1: f64, d0: f64, d1: f64| {
        let slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
        if slope * d0 <= 0.0 {
            0.0
        } else if d0 * d1 <= 0.0 && slope.abs() > 3.0 * d0.abs() {
            3.0 * d0
        } else {
            slope
        }
    };
    let mut slopes = vec![0.0; n];
    slopes[0] = end(h[0], h[1], chord[0], chord[1]);
    slopes[n - 1] = end(h[n - 2], h[n - 3], chord[n - 2], chord[n - 3]);
    for i in 1..n - 1 {
        if chord[i - 1] * chord[i] > 0.0 {
            let (a, b) = (2.0 * h[i] + h[i - 1], h[i] + 2.0 * h[i - 1]);
            slopes[i] = (a + b) / (a / chord[i - 1] + b / chord[i]);
        }
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::super::StiffnessLaw;
    use super::*;

    /// ROUNDOFF of sums over some panels of powers with exponents of about ten.
    const ROUNDOFF: f64 = 1e-13;
    const FORCES: [f64; 6] = [1e3, 4e3, 15e3, 40e3, 85e3, 150e3];

    /// Source: the power law in closed form. Goal: tangent (N/m), displacement (m), energy (J) and force (N) of a table through
    /// a power law are that law's from no load to the last knot. Accuracy: ROUNDOFF.
    #[test]
    fn a_table_through_a_power_law_is_that_law() {
        for c in [0.0, 0.24, 1.0 / 3.0, 0.9] {
            let law = StiffnessLaw { a: 0.0, b: 2.94e8, c };
            let table = TableLaw::new(&FORCES, &FORCES.map(|f| law.tangent(f))).unwrap();
            for force in [10.0, 1e3, 3e3, 20e3, 84e3, 150e3] {
                let way = law.displacement(force);
                let pairs = [
                    (table.tangent(force), law.tangent(force)),
                    (table.displacement(force), way),
                    (table.energy(force), law.energy(way)),
                    (table.force(way), force),
                ];
                for (found, exact) in pairs {
                    assert!((found / exact - 1.0).abs() < 10.0 * ROUNDOFF, "{c} {force}: {found} {exact}");
                }
            }
            assert!((table.tangent(300e3) / law.tangent(150e3) - 1.0).abs() < ROUNDOFF, "constant beyond");
        }
    }

    /// Source: `d(displacement)/df = 1/k` and `d(energy)/df = f/k` by central differences. Goal: the integrals belong to the
    /// tangent, and the inverse to the displacement, through knots of a contact that stiffens in two stages. Accuracy:
    /// DISCRETISATION of the differences, second order in a step of 1e-4.
    #[test]
    fn the_integrals_belong_to_the_tangent() {
        const DISCRETISATION: f64 = 1e-7;
        let table = TableLaw::new(&FORCES, &[3e8, 5e8, 5.1e8, 9e8, 9.2e8, 1.3e9]).unwrap();
        for force in [200.0, 2e3, 9e3, 39e3, 60e3, 149e3, 400e3] {
            let step = 1e-4 * force;
            let slope = |of: &dyn Fn(f64) -> f64| (of(force + step) - of(force - step)) / (2.0 * step);
            let k = table.tangent(force);
            assert!((slope(&|f| table.displacement(f)) * k - 1.0).abs() < DISCRETISATION, "{force}");
            assert!((slope(&|f| table.energy(f)) * k / force - 1.0).abs() < DISCRETISATION, "{force}");
            let back = table.force(table.displacement(force));
            assert!((back / force - 1.0).abs() < 10.0 * ROUNDOFF, "{force}: {back}");
        }
    }

    /// Goal: between rising knots the stiffness rises, between falling ones it falls, and it stays between theirs, whatever
    /// steps they make; a knot of a power law that is left out is found again.
    #[test]
    fn the_table_is_monotone_where_its_knots_are() {
        let tangents = [3e8, 3e8, 2.9e9, 3e9, 1e9, 1e9];
        let table = TableLaw::new(&FORCES, &tangents).unwrap();
        for i in 0..FORCES.len() - 1 {
            let at = |part: f64| table.tangent(FORCES[i] * (FORCES[i + 1] / FORCES[i]).powf(part));
            let sign = (tangents[i + 1] - tangents[i]).signum();
            let values: Vec<f64> = (0..=50).map(|n| at(f64::from(n) / 50.0)).collect();
            let slack = ROUNDOFF * tangents[i];
            assert!(values.windows(2).all(|w| sign * (w[1] - w[0]) >= -slack), "segment {i}");
        }
        let power = StiffnessLaw { a: 0.0, b: 1e8, c: 0.3 };
        let exact = TableLaw::new(&FORCES, &FORCES.map(|f| power.tangent(f))).unwrap();
        let left_out = exact.left_out();
        assert!(
            left_out.len() == 4 && left_out.iter().all(|off| off.abs() < 10.0 * ROUNDOFF),
            "{left_out:?}"
        );
        assert!(table.left_out().iter().any(|off| off.abs() > 0.01));
        assert!(TableLaw::new(&FORCES[..4], &tangents[..4]).unwrap().left_out().is_empty());
    }

    #[test]
    fn what_is_no_table_is_refused() {
        let good = [1e8; 4];
        for (forces, tangents) in [
            (&[1e3, 2e3, 2e3, 3e3][..], &good[..]),
            (&[1e3, 2e3, 3e3], &good[..3]),
            (&[0.0, 1e3, 2e3, 3e3], &good),
            (&[1e3, 2e3, 3e3, 4e3], &[1e8, -1e8, 1e8, 1e8]),
            (&[1e3, 2e3, 3e3, 4e3], &good[..3]),
        ] {
            let said = TableLaw::new(forces, tangents).unwrap_err().to_string();
            assert!(said.starts_with("law.points"), "{said}");
        }
        let table = TableLaw::new(&FORCES, &[1e8; 6]).unwrap();
        assert_eq!((table.force(-1.0), table.displacement(-1.0)), (0.0, 0.0));
        assert!(table.tangent(f64::NAN).is_nan() && table.displacement(f64::NAN).is_nan());
        assert!(
            (table.tangent(0.0) / 1e8 - 1.0).abs() < ROUNDOFF,
            "a constant law has its stiffness at no load"
        );
    }
}
