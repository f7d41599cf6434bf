//! Rolling-radius difference over the lateral shift, and equivalent conicity by EN 15302.

use std::f64::consts::PI;

use super::wheelset::{Roll, Wheelset, WheelsetPosition};
use crate::error::{InputError, Result};
use crate::root::bisection;
use crate::units::MILLIMETRE;

/// Rolling radii at one lateral shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunningPoint {
    /// Lateral shift, m, positive to the right.
    pub shift: f64,
    /// Rolling radius of the right wheel less that of the left one, m.
    pub difference: f64,
}

/// Rolling-radius difference as a function of the lateral shift, straight between its points.
#[derive(Debug, Clone, PartialEq)]
pub struct RunningFunction {
    points: Vec<RunningPoint>,
    /// ∫ difference from the first point, m².
    potential: Vec<f64>,
}

impl RunningFunction {
    /// Rolling-radius difference of `wheelset` without yaw at the shifts from `from` to `to` (m), `step` apart.
    ///
    /// # Errors
    /// As [`Wheelset::contacts`], and [`InputError`] for a range that is empty or longer than 100 000 steps.
    pub fn of(wheelset: &Wheelset, range: [f64; 2], step: f64, roll: Roll) -> Result<Self> {
        let points = Self::shifts(range, step)?
            .into_iter()
            .map(|shift| {
                let position = WheelsetPosition { lateral_shift: shift, yaw: 0.0, roll };
                let both = wheelset.contacts(&position, 0.0)?;
                let difference = both.right.points[0].rolling_radius - both.left.points[0].rolling_radius;
                Ok(RunningPoint { shift, difference })
            })
            .collect::<Result<Vec<_>>>()?;
        Self::from_points(points)
    }

    /// The shifts from `from` to `to` (m), `step` apart.
    pub(super) fn shifts([from, to]: [f64; 2], step: f64) -> Result<Vec<f64>> {
        let parts = ((to - from) / step).round();
        if !(1.0..=1e5).contains(&parts) {
            return InputError::refuse(
                "shift range",
                format!("{} to {} mm, step {} mm", from / MILLIMETRE, to / MILLIMETRE, step / MILLIMETRE),
                "1 to 100000 steps",
                "give a range from left to right and a step that fits",
            );
        }
        Ok((0..=parts as usize).map(|i| from + (to - from) * i as f64 / parts).collect())
    }

    /// From given points, in increasing order of the shift.
    ///
    /// # Errors
    /// [`InputError`] for fewer than two points, or shifts out of order.
    pub fn from_points(points: Vec<RunningPoint>) -> Result<Self> {
        if points.len() < 2
            || points
                .windows(2)
                .any(|p| p[0].shift.partial_cmp(&p[1].shift) != Some(std::cmp::Ordering::Less))
        {
            return InputError::refuse(
                "rolling-radius difference",
                format!("{} points", points.len()),
                "at least two points in increasing order of the shift",
                "sort the points and remove repeated ones",
            );
        }
        let mut potential = vec![0.0];
        for p in points.windows(2) {
            let last = potential[potential.len() - 1];
            potential.push(last + 0.5 * (p[1].shift - p[0].shift) * (p[0].difference + p[1].difference));
        }
        Ok(Self { points, potential })
    }

    /// The points.
    pub fn points(&self) -> &[RunningPoint] {
        &self.points
    }

    /// Interval of a shift (clamped), and the distance from its start.
    fn locate(&self, shift: f64) -> (usize, f64) {
        let i = self.points.partition_point(|p| p.shift <= shift).clamp(1, self.points.len() - 1) - 1;
        (i, shift - self.points[i].shift)
    }

    /// Rolling-radius difference at a shift, m.
    pub fn difference(&self, shift: f64) -> f64 {
        let (i, u) = self.locate(shift);
        let (a, b) = (&self.points[i], &self.points[i + 1]);
        a.difference + (b.difference - a.difference) * u / (b.shift - a.shift)
    }

    fn potential(&self, shift: f64) -> f64 {
        let (i, u) = self.locate(shift);
        self.potential[i] + 0.5 * u * (self.points[i].difference + self.difference(shift))
    }

    /// Equivalent conicity tan γ for the `amplitude` (m): that of the cone whose kinematic oscillation has the same
    /// wavelength, by integration of the equation of motion (EN 15302), roll neglected.
    ///
    /// It is 0 where the difference is 0 all the way. `None` where the wheelset does not swing about a shift within the range: the difference
    /// is not restoring, or the points do not reach that far.
    pub fn equivalent_conicity(&self, amplitude: f64) -> Option<f64> {
        // ROUNDOFF: of the potential, as conicity; below it there is no restoring difference, nor a wave.
        const ROUNDOFF: f64 = 1e-9;
        let middle = self.middle(amplitude)?;
        let top = self.potential(middle - amplitude);
        if (top - self.potential(middle)).abs() < ROUNDOFF * amplitude * amplitude {
            return Some(0.0);
        }
        // With y = middle + amplitude sin θ the integrand is finite at the turning points.
        const PARTS: usize = 4000;
        let mut integral = 0.0;
        for i in 0..PARTS {
            let angle = ((i as f64 + 0.5) / PARTS as f64 - 0.5) * PI;
            let depth = top - self.potential(middle + amplitude * angle.sin());
            if depth.is_nan() || depth <= 0.0 {
                return None;
            }
            integral += amplitude * angle.cos() / depth.sqrt() * PI / PARTS as f64;
        }
        Some((PI / integral).powi(2))
    }

    /// Shift about which the wheelset swings with the `amplitude` (m): that between two turning points with the same potential, m.
    ///
    /// `None` where there are no such points within the range.
    pub fn middle(&self, amplitude: f64) -> Option<f64> {
        let [first, last] = [self.points[0].shift, self.points[self.points.len() - 1].shift];
        if !(amplitude > 0.0 && first + 2.0 * amplitude <= last) {
            return None;
        }
        // The turning point on the left, by bisection.
        let (low, high) = (first, last - 2.0 * amplitude);
        let climbs = |left: f64| self.potential(left + 2.0 * amplitude) - self.potential(left);
        if climbs(low) > 0.0 || climbs(high) < 0.0 {
            return None;
        }
        Some(bisection(low, high, |left| climbs(left) > 0.0) + amplitude)
    }

    /// Nonlinearity parameter, 1/m (publications: 1/mm): the slope of the equivalent conicity from 2 to 4 mm of amplitude
    /// (O. Polach, "Characteristic parameters of nonlinear wheel/rail contact geometry", Vehicle System Dynamics 48 (2010), supplement).
    ///
    /// `None` where one of both amplitudes has no conicity.
    pub fn nonlinearity(&self) -> Option<f64> {
        const FROM: f64 = 2.0 * MILLIMETRE;
        const TO: f64 = 4.0 * MILLIMETRE;
        let [small, large] = [FROM, TO].map(|amplitude| self.equivalent_conicity(amplitude));
        Some((large? - small?) / (TO - FROM))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn function(f: impl Fn(f64) -> f64) -> RunningFunction {
        let points = (-1000..=1000)
            .map(|i| f64::from(i) * 1e-5)
            .map(|shift| RunningPoint { shift, difference: f(shift) })
            .collect();
        RunningFunction::from_points(points).unwrap()
    }

    /// Source: a cone has the difference 2 y tan γ at every amplitude; a constant difference d towards the middle
    /// has, by its parabola, the wavelength of a cone of tan γ = π² d / (16 a).
    #[test]
    fn cone_and_step() {
        // DISCRETISATION: the root's integrand over 4000 parts, and turning points between the points.
        const DISCRETISATION: f64 = 3e-6;
        let cone = function(|y| 2.0 * 0.05 * (y - 1e-3));
        for amplitude in [1e-3, 3e-3, 8e-3] {
            let found = cone.equivalent_conicity(amplitude).unwrap();
            assert!((found / 0.05 - 1.0).abs() < DISCRETISATION, "{found}");
        }
        // The step is smeared over one interval of 0.01 mm.
        let step = function(|y| 1e-3 * y.signum() * f64::from(y.abs() > 1e-9));
        // by the same formula at 2 and 4 mm
        let expected = PI.powi(2) / 16.0 * 0.001 * (1.0 / 4e-3 - 1.0 / 2e-3) / 2e-3;
        assert!((step.nonlinearity().unwrap() / expected - 1.0).abs() < 0.01, "{:?}", step.nonlinearity());
        let found = step.equivalent_conicity(3e-3).unwrap();
        assert!((found / (PI * PI * 1e-3 / (16.0 * 3e-3)) - 1.0).abs() < 2e-3, "{found}");
    }

    /// Source: EN 15302:2021 has the conicity 0 for wheels I, whose rolling-radius difference is 0 up to ±1.7 mm.
    #[test]
    fn no_difference_is_no_conicity() {
        let flat_inside = function(|y| if y.abs() < 1.7e-3 { 0.0 } else { 2e-3 * y.signum() });
        assert_eq!(flat_inside.equivalent_conicity(1e-3), Some(0.0));
        assert!(flat_inside.equivalent_conicity(2e-3).unwrap() > 0.1);
    }

    #[test]
    fn runaway_and_short_ranges_have_no_conicity() {
        assert_eq!(function(|y| -0.1 * y).equivalent_conicity(3e-3), None);
        assert_eq!(function(|y| 0.1 * y).equivalent_conicity(11e-3), None);
        assert_eq!(function(|y| 0.1 * y).equivalent_conicity(f64::NAN), None);
        assert!(RunningFunction::from_points(vec![]).is_err());
    }
}
