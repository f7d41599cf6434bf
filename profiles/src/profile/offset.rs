//! A curve whose points are moved along its normals.

use nalgebra::Vector2;

use super::curve::ProfileCurve;
use super::spline::Piece;

impl ProfileCurve {
    /// The curve whose point at the arc length s is moved along its upward normal by `offset(s)`: the way in m and its derivative. Points
    /// are at most `step` (m) apart; breakpoints stay. At a corner the piece after it begins where the one before it ends.
    ///
    /// ```
    /// use nalgebra::Point2;
    /// use railspring_profiles::profile::{ProfileCurve, Segment};
    ///
    /// // The parallel curve of a crown of 300 mm, 1 mm above it, is an arc of 301 mm.
    /// let crown = Segment::arc(Point2::new(0.0, 0.3), Point2::new(-0.03, 0.001504), Point2::new(0.03, 0.001504));
    /// let parallel = ProfileCurve::from_segments(&[crown], 1e-3).offset(1e-3, |_| [1e-3, 0.0]);
    /// assert!((1.0 / parallel.curvature(0.5 * parallel.length()) - 0.301).abs() < 1e-6);
    /// ```
    pub fn offset(&self, step: f64, offset: impl Fn(f64) -> [f64; 2]) -> Self {
        // A breakpoint has the tangent after it; this far before it there is that of the piece that ends, m.
        const BEFORE: f64 = 1e-9;
        let point = |s: f64| self.point(s) + offset(s)[0] * self.upward_normal(s);
        let tangent = |s: f64, at: f64| {
            let [way, slope] = offset(s);
            // The normal's own derivative is the curvature times the tangent.
            let along = (1.0 + way * self.curvature(at)) * self.tangent(at);
            (along + slope * self.upward_normal(at)).normalize()
        };
        let mut ends = vec![0.0];
        ends.extend(self.breakpoints());
        ends.push(self.length());
        let pieces = ends.windows(2).map(|pair| {
            let (from, to) = (pair[0], pair[1]);
            let last = (to - BEFORE).max(0.5 * (from + to));
            let parts = ((to - from) / step).ceil().max(1.0) as usize;
            let mut points: Vec<_> =
                (0..parts).map(|i| point(from + (to - from) * i as f64 / parts as f64)).collect();
            points.push(self.point(to) + offset(to)[0] * self.upward_normal(last));
            let tangents: [Vector2<f64>; 2] = [tangent(from, from), tangent(to, last)];
            Piece { points, end_tangents: Some(tangents) }
        });
        Self::from_pieces(pieces.collect())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;
    use crate::profile::wheels::wheel_profile;

    /// Goal: without a way the curve is the same one, at joints with jumps of curvature too.
    #[test]
    fn no_way_changes_nothing() {
        // DISCRETISATION: cubics of 0.25 mm on the arcs of 12 mm of a flange are off by h⁴/(384 R³) = 6e-12 m, ten times that at joints; curvatures by 1 %.
        const DISCRETISATION: [f64; 2] = [1e-10, 0.01];
        let wheel = wheel_profile("S1002").unwrap();
        let same = wheel.offset(0.25e-3, |_| [0.0, 0.0]);
        assert!((same.length() - wheel.length()).abs() < 1e-9);
        for i in 0..2000 {
            let s = wheel.length() * f64::from(i) / 2000.0;
            let away = same.closest(&wheel.point(s)).1;
            assert!(away < DISCRETISATION[0], "{s}: {away:e}");
            let off = (same.curvature(s) - wheel.curvature(s)).abs();
            assert!(off < DISCRETISATION[1] * (1.0 + wheel.curvature(s).abs()), "{s}: {off}");
        }
    }

    /// Source: the parallel of an arc is an arc about the same centre; with a way that grows with the arc length its
    /// distance grows alike. Goal: radius from the centre, m. Accuracy (DISCRETISATION, as above): 1e-9 m.
    #[test]
    fn an_arc_keeps_its_centre() {
        const DISCRETISATION: f64 = 1e-9;
        let centre = Point2::new(0.0, 0.08);
        let start = centre + 0.08 * Vector2::new(-0.6, -0.8);
        let arc = crate::profile::Segment::arc(centre, start, centre + 0.08 * Vector2::new(0.6, -0.8));
        let moved = ProfileCurve::from_segments(&[arc], 1e-3).offset(0.5e-3, |s| [0.01 * s, 0.01]);
        for i in 0..=100 {
            let s = moved.length() * f64::from(i) / 100.0;
            let radius = (moved.point(s) - centre).norm();
            // the angle about the centre tells the arc length on the first curve
            let angle = (moved.point(s) - centre).x.atan2(centre.y - moved.point(s).y) + 0.6f64.asin();
            assert!((radius - 0.08 - 0.01 * 0.08 * angle).abs() < DISCRETISATION, "{s}: {radius}");
        }
    }
}
