//! Where nothing of a wheel is: a bound that rules out contact without a foot on its spline.

use nalgebra::Point2;

use railspring_profiles::profile::ProfileCurve;

/// Distance of the points that the bound is made from, m.
const SAMPLED: f64 = 0.25e-3;

/// Strips across the profile.
const STRIPS: usize = 256;

/// How far the wheel reaches down in strips across its profile.
pub(super) struct Underside {
    /// Where the profile begins and ends, m.
    from: f64,
    to: f64,
    /// At least the largest z of the spline in each strip, m.
    deepest: Vec<f64>,
}

impl Underside {
    pub fn of(wheel: &ProfileCurve) -> Self {
        let points = wheel.sample(SAMPLED);
        let extent = points
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), p| (from.min(p.x), to.max(p.x)));
        let mut underside = Self { from: extent.0, to: extent.1, deepest: vec![f64::NEG_INFINITY; STRIPS] };
        for pair in points.windows(2) {
            // No point of a curve is further from the nearer end than half its length.
            let [z, y0, y1] = [pair[0].y.max(pair[1].y), pair[0].x.min(pair[1].x), pair[0].x.max(pair[1].x)];
            let strips = underside.strip(y0 - SAMPLED)..=underside.strip(y1 + SAMPLED);
            for deepest in &mut underside.deepest[strips] {
                *deepest = deepest.max(z + SAMPLED);
            }
        }
        underside
    }

    /// The strip of `y`, m, the first and the last beyond the profile.
    fn strip(&self, y: f64) -> usize {
        ((STRIPS as f64 * (y - self.from) / (self.to - self.from)) as usize).min(STRIPS - 1)
    }

    /// Whether the whole wheel is above `point` (profile frame, m), which then is not in the wheel.
    pub fn is_above(&self, point: &Point2<f64>) -> bool {
        point.x < self.from || point.x > self.to || point.y > self.deepest[self.strip(point.x)]
    }
}
