//! The law as points for programs that interpolate in a straight line: as many as the error needs.

use railspring_calibrate::law::NormalLaw;

use super::spring::Spring;

/// Largest deviation of the straight lines from the law: half of the 0.1 % that is promised, so that the reading program may
/// round as much again.
const TOLERANCE: f64 = 5e-4;

/// Forces at which a straight line is compared with the law.
const SAMPLES: usize = 64;

/// Points of the law from no load to the end of its range.
pub(super) struct Points {
    /// Displacement, m, and force, N, ascending from (0, 0).
    pub points: Vec<[f64; 2]>,
    /// Largest deviation in force between the points over the force, below the law's range over the range's begin.
    pub error: f64,
}

impl Points {
    /// From the largest load down, each point as far from the last as the tolerance allows.
    pub fn of(spring: &Spring) -> Self {
        let [low, high] = spring.range;
        let deviation = |from: f64, to: f64| deviation(&spring.law, from, to, low);
        let mut forces = vec![high];
        let mut error: f64 = 0.0;
        let mut upper = high;
        while upper > 0.0 {
            let lower = next_below(upper, |lower| deviation(lower, upper) <= TOLERANCE);
            error = error.max(deviation(lower, upper));
            forces.push(lower);
            upper = lower;
        }
        let points = forces.into_iter().rev().map(|force| [spring.law.displacement(force), force]).collect();
        Self { points, error }
    }

    /// What the heading says about them.
    pub fn sentence(&self, low: f64) -> String {
        format!(
            "{} points from (0, 0) on; straight lines between them are within {:.4} % of the law's force, below {} N within as \
             much of {} N",
            self.points.len(),
            1e2 * self.error,
            low,
            low
        )
    }

    /// Displacement and force with their signs turned for programs in which compression is negative, ascending; the last
    /// two points are the branch without tension.
    pub fn compression_negative(&self) -> Vec<[f64; 2]> {
        let largest = self.points.last().map_or(0.0, |last| last[0]);
        // 0.0 - x, so that no load is 0 and not -0
        let turned = self.points.iter().rev().map(|[displacement, force]| [0.0 - displacement, 0.0 - force]);
        turned.chain([[largest, 0.0]]).collect()
    }
}

/// The lowest force from which a line up to `upper` is `good`: 0, or found by bisection.
fn next_below(upper: f64, good: impl Fn(f64) -> bool) -> f64 {
    if good(0.0) {
        return 0.0;
    }
    let (mut bad, mut fine) = (0.0, upper);
    for _ in 0..40 {
        let middle = 0.5 * (bad + fine);
        if good(middle) { fine = middle } else { bad = middle }
    }
    fine
}

/// Largest deviation in force of the straight line between the law's points at two forces, over the force, at least over
/// `floor`: near no load no straight line keeps to a share of the force.
fn deviation(law: &NormalLaw, from: f64, to: f64, floor: f64) -> f64 {
    let [begin, end] = [from, to].map(|force| law.displacement(force));
    (1..SAMPLES)
        .map(|i| {
            let force = from + (to - from) * i as f64 / SAMPLES as f64;
            let line = from + (to - from) * (law.displacement(force) - begin) / (end - begin);
            (line - force).abs() / force.max(floor)
        })
        .fold(0.0, f64::max)
}
