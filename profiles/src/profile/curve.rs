//! The smooth profile curve, parametrised by its arc length.

use nalgebra::{Point2, Rotation2, Vector2};

use super::curve_parts::CurveParts;
use super::spline::{Cubic, Piece, fit};
use crate::error::{InputError, Result};
use crate::quadrature::GAUSS_5_UNIT;
use crate::root::bracketed_newton;
use crate::units::MILLIMETRE;

/// Points closer than this count as the same point, m.
const SAME_POINT: f64 = 1e-7;
/// A turn between two neighbouring chords above this is a step back, rad.
const STEP_BACK: f64 = 150.0 * std::f64::consts::PI / 180.0;
/// Turn of the tangent from which a breakpoint counts as a kink, rad (0.06°).
const KINK: f64 = 1e-3;
/// The largest deviation of |dp/ds| from one that parts of a curve may have.
const LARGEST_SPEED_ERROR: f64 = 1e-4;
/// Knot intervals in one block of the closest-point search.
const BLOCK: usize = 32;

/// A profile as a smooth curve in the plane (y lateral, z down), parametrised by its arc length s in m.
///
/// An interpolating cubic spline runs through the points; at breakpoints (kinks, and joints of a definition
/// where the curvature jumps) separate splines join. |dp/ds| differs from one by less than 1e-6. Outside
/// `0..=length()` the curve runs on straight along its end tangents.
///
/// ```
/// use nalgebra::Point2;
/// use railspring_profiles::profile::ProfileCurve;
///
/// // A quarter circle of radius 0.3 m about the origin, from the top to the right.
/// let points: Vec<_> = (0..=90).map(|degree| {
///     let angle = f64::from(degree).to_radians();
///     Point2::new(0.3 * angle.sin(), -0.3 * angle.cos())
/// }).collect();
/// let curve = ProfileCurve::from_points(&points, &[])?;
/// assert!((curve.length() - 0.15 * std::f64::consts::PI).abs() < 1e-9);
/// assert!((curve.curvature(0.2) - 1.0 / 0.3).abs() < 1e-3);
/// let (s, distance) = curve.closest(&Point2::new(0.0, -0.31));
/// assert!(s < 1e-7 && (distance - 0.01).abs() < 1e-9);
/// # Ok::<(), railspring_profiles::error::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ProfileCurve {
    /// Arc length at the knots, one more than `cubics`.
    knots: Vec<f64>,
    cubics: Vec<Cubic>,
    /// Indices of the inner knots at which separate splines join.
    breaks: Vec<usize>,
    /// Interval in which each of the equally long buckets begins.
    buckets: Vec<u32>,
    buckets_per_metre: f64,
    /// A disc around each `BLOCK` intervals: centre and radius.
    discs: Vec<(Point2<f64>, f64)>,
    /// Whether y increases from knot to knot.
    increasing_y: bool,
}

impl ProfileCurve {
    /// Interpolates `points` (m, in order along the profile). `kinks` are the indices of points at which the
    /// profile has a real corner, in increasing order; everywhere else the curve is twice continuously
    /// differentiable.
    ///
    /// # Errors
    /// [`InputError`] for fewer than four points, for a point that is not finite, coincides with its
    /// predecessor or steps back, for a kink that is not an inner point, and for points so uneven that the
    /// spline's length does not settle.
    pub fn from_points(points: &[Point2<f64>], kinks: &[usize]) -> Result<Self> {
        check_points(points)?;
        check_kinks(points.len(), kinks)?;
        let mut pieces = Vec::with_capacity(kinks.len() + 1);
        let mut start = 0;
        for end in kinks.iter().copied().chain([points.len() - 1]) {
            pieces.push(Piece { points: points[start..=end].to_vec(), end_tangents: None });
            start = end;
        }
        let (knots, cubics, breaks) = Self::joined(pieces);
        if !knots[knots.len() - 1].is_finite() {
            return InputError::refuse(
                "profile",
                format!("{} points", points.len()),
                "points that a smooth curve of finite length runs through",
                "the spacing is too uneven where the line bends: smooth or thin the points",
            );
        }
        Ok(Self::assemble(knots, cubics, breaks))
    }

    /// From its parts, as [`ProfileCurve::parts`] has them.
    ///
    /// # Errors
    /// [`InputError`] for parts that are not those of a smooth curve: numbers that are none, knots that do not ascend from 0, polynomials that do not
    /// meet, an arc length that is not that of the curve.
    pub fn from_parts(parts: &CurveParts) -> Result<Self> {
        parts.check()?;
        let CurveParts { knots, cubics, breaks } = parts;
        let curve = Self::assemble(knots.clone(), cubics.iter().map(Cubic::of_row).collect(), breaks.clone());
        if curve.speed_error() > LARGEST_SPEED_ERROR {
            return Err(CurveParts::refusal("a parameter that is not the arc length").into());
        }
        Ok(curve)
    }

    /// The numbers that the curve consists of.
    pub fn parts(&self) -> CurveParts {
        CurveParts {
            knots: self.knots.clone(),
            cubics: self.cubics.iter().map(Cubic::row).collect(),
            breaks: self.breaks.clone(),
        }
    }

    /// Joins pieces that follow each other; each starts where the one before it ends, whatever its first point.
    pub(crate) fn from_pieces(pieces: Vec<Piece>) -> Self {
        let (knots, cubics, breaks) = Self::joined(pieces);
        Self::assemble(knots, cubics, breaks)
    }

    /// Knots, cubics and breakpoints of pieces that follow each other.
    fn joined(mut pieces: Vec<Piece>) -> (Vec<f64>, Vec<Cubic>, Vec<usize>) {
        for i in 1..pieces.len() {
            pieces[i].points[0] = pieces[i - 1].points[pieces[i - 1].points.len() - 1];
        }
        let mut knots = vec![0.0];
        let mut cubics = Vec::new();
        let mut breaks = Vec::new();
        for piece in &pieces {
            if !cubics.is_empty() {
                breaks.push(cubics.len());
            }
            let fitted = fit(piece);
            for h in fitted.lengths {
                knots.push(knots[knots.len() - 1] + h);
            }
            cubics.extend(fitted.cubics);
        }
        (knots, cubics, breaks)
    }

    fn assemble(knots: Vec<f64>, cubics: Vec<Cubic>, breaks: Vec<usize>) -> Self {
        let length = knots[knots.len() - 1];
        let count = 4 * cubics.len();
        let buckets_per_metre = count as f64 / length;
        let mut buckets = Vec::with_capacity(count);
        let mut interval = 0;
        for bucket in 0..count {
            let start = bucket as f64 / buckets_per_metre;
            while interval + 1 < cubics.len() && knots[interval + 1] <= start {
                interval += 1;
            }
            buckets.push(interval as u32);
        }
        let mut curve = Self {
            knots,
            cubics,
            breaks,
            buckets,
            buckets_per_metre,
            discs: Vec::new(),
            increasing_y: false,
        };
        curve.discs = curve.bounding_discs();
        let y = |i: usize| curve.point(curve.knots[i]).x;
        curve.increasing_y = (1..curve.knots.len()).all(|i| y(i - 1) < y(i));
        curve
    }

    /// Discs that contain the blocks: every point of a curve is within half its length of the middle.
    fn bounding_discs(&self) -> Vec<(Point2<f64>, f64)> {
        (0..self.cubics.len())
            .step_by(BLOCK)
            .map(|first| {
                let last = (first + BLOCK).min(self.cubics.len());
                let (s0, s1) = (self.knots[first], self.knots[last]);
                (self.point(0.5 * (s0 + s1)), 0.5 * (s1 - s0) * (1.0 + 1e-3))
            })
            .collect()
    }

    /// Length of the curve, m.
    pub fn length(&self) -> f64 {
        self.knots[self.knots.len() - 1]
    }

    /// Interval of `s` (clamped to the curve) and the distance from its start.
    #[inline]
    fn locate(&self, s: f64) -> (usize, f64) {
        let bucket = ((s * self.buckets_per_metre).max(0.0) as usize).min(self.buckets.len() - 1);
        let mut interval = self.buckets[bucket] as usize;
        while interval + 1 < self.cubics.len() && self.knots[interval + 1] <= s {
            interval += 1;
        }
        // The bucket's start is rounded: the interval before may be the right one.
        while interval > 0 && self.knots[interval] > s {
            interval -= 1;
        }
        (interval, s - self.knots[interval])
    }

    /// Point and derivative dp/ds at `s` in one go; at a breakpoint the derivative after it.
    pub fn evaluate(&self, s: f64) -> (Point2<f64>, Vector2<f64>) {
        let inside = s.clamp(0.0, self.length());
        let (interval, u) = self.locate(inside);
        let cubic = &self.cubics[interval];
        let (point, derivative) = (cubic.point(u), cubic.derivative(u));
        if inside == s { (point, derivative) } else { (point + (s - inside) * derivative, derivative) }
    }

    /// Point with first and second derivative at `s`.
    pub fn evaluate_twice(&self, s: f64) -> (Point2<f64>, Vector2<f64>, Vector2<f64>) {
        let inside = s.clamp(0.0, self.length());
        let (interval, u) = self.locate(inside);
        let cubic = &self.cubics[interval];
        let (point, derivative) = (cubic.point(u), cubic.derivative(u));
        if inside == s {
            (point, derivative, cubic.second_derivative(u))
        } else {
            (point + (s - inside) * derivative, derivative, Vector2::zeros())
        }
    }

    /// Point at `s`, m.
    pub fn point(&self, s: f64) -> Point2<f64> {
        self.evaluate(s).0
    }

    /// Unit tangent at `s`; at a breakpoint the one after it.
    pub fn tangent(&self, s: f64) -> Vector2<f64> {
        self.evaluate(s).1.normalize()
    }

    /// Unit normal (tz, -ty) at `s`: it points up where the curve runs to the field side.
    pub fn upward_normal(&self, s: f64) -> Vector2<f64> {
        let tangent = self.tangent(s);
        Vector2::new(tangent.y, -tangent.x)
    }

    /// Curvature at `s`, 1/m, positive where the tangent turns from y towards z: positive on the crown of a
    /// rail, negative at the tip of a flange. Zero outside the curve.
    pub fn curvature(&self, s: f64) -> f64 {
        if !(0.0..=self.length()).contains(&s) {
            return 0.0;
        }
        let (interval, u) = self.locate(s);
        let first = self.cubics[interval].derivative(u);
        let second = self.cubics[interval].second_derivative(u);
        first.perp(&second) / first.norm().powi(3)
    }

    /// Arc lengths at which separate splines join: kinks, and joints of the definition with a jump in curvature.
    pub fn breakpoints(&self) -> Vec<f64> {
        self.breaks.iter().map(|&i| self.knots[i]).collect()
    }

    /// Arc lengths of the real corners: breakpoints at which the tangent turns by more than 0.06°.
    pub fn kinks(&self) -> Vec<f64> {
        let turn = |i: usize| {
            let before = self.cubics[i - 1].derivative(self.knots[i] - self.knots[i - 1]);
            before.angle(&self.cubics[i].b)
        };
        self.breaks.iter().filter(|&&i| turn(i) > KINK).map(|&i| self.knots[i]).collect()
    }

    /// Largest deviation of |dp/ds| from one, sampled nine times an interval.
    pub fn speed_error(&self) -> f64 {
        self.cubics
            .iter()
            .zip(self.knots.windows(2))
            .map(|(cubic, s)| cubic.speed_error(s[1] - s[0]))
            .fold(0.0, f64::max)
    }

    /// Arc length of the point of the curve nearest to `point`, and its distance, m.
    ///
    /// The global minimum over the whole curve, to round-off; the smaller s of two that are equally near.
    pub fn closest(&self, point: &Point2<f64>) -> (f64, f64) {
        let bound = |(centre, radius): &(Point2<f64>, f64)| (point - centre).norm() - radius;
        let mut nearest = (f64::INFINITY, 0);
        for (block, disc) in self.discs.iter().enumerate() {
            let lower_bound = bound(disc);
            if lower_bound < nearest.0 {
                nearest = (lower_bound, block);
            }
        }
        let mut best = (0.0, f64::INFINITY);
        // The most promising block first, so that its distance rules out most of the others.
        for block in
            std::iter::once(nearest.1).chain((0..self.discs.len()).filter(|&block| block != nearest.1))
        {
            if bound(&self.discs[block]) > best.1 {
                continue;
            }
            let first = block * BLOCK;
            let intervals = first..(first + BLOCK).min(self.cubics.len());
            // No point of an interval is further from its middle than half its length.
            let mut bounds = [f64::INFINITY; BLOCK];
            let mut promising = first;
            for i in intervals.clone() {
                let h = self.knots[i + 1] - self.knots[i];
                bounds[i - first] = (point - self.cubics[i].point(0.5 * h)).norm() - 0.5005 * h;
                if bounds[i - first] < bounds[promising - first] {
                    promising = i;
                }
            }
            // The most promising interval first, in the same way.
            for interval in std::iter::once(promising).chain(intervals) {
                if bounds[interval - first] > best.1 {
                    continue;
                }
                let u = self.closest_in_interval(interval, point);
                let found = (self.knots[interval] + u, (point - self.cubics[interval].point(u)).norm());
                if found.1 < best.1 || (found.1 == best.1 && found.0 < best.0) {
                    best = found;
                }
            }
        }
        best
    }

    /// As [`Self::closest`], but by Newton steps from `guess`: several times faster, and for a point off the
    /// curve by less than its radius of curvature the foot on the same stretch of the curve as the guess. Falls
    /// back to the search over the whole curve where the steps do not settle.
    pub fn closest_near(&self, point: &Point2<f64>, guess: f64) -> (f64, f64) {
        const MAX_STEPS: usize = 12;
        // SOLVER: the last step is quadratically smaller than this, thus below round-off.
        const SETTLED: f64 = 1e-10;
        let mut s = guess.clamp(0.0, self.length());
        for _ in 0..MAX_STEPS {
            let (interval, u) = self.locate(s);
            let cubic = &self.cubics[interval];
            let (offset, tangent) = (cubic.point(u) - point, cubic.derivative(u));
            let slope = tangent.norm_squared() + offset.dot(&cubic.second_derivative(u));
            if slope.is_nan() || slope <= 0.0 {
                break;
            }
            let next = (s - offset.dot(&tangent) / slope).clamp(0.0, self.length());
            let settled = (next - s).abs() < SETTLED;
            s = next;
            if settled {
                return (s, (point - self.point(s)).norm());
            }
        }
        self.closest(point)
    }

    fn closest_in_interval(&self, interval: usize, point: &Point2<f64>) -> f64 {
        let cubic = &self.cubics[interval];
        let h = self.knots[interval + 1] - self.knots[interval];
        // Half the derivative of the squared distance, and its slope.
        let condition = |u: f64| {
            let (offset, tangent) = (cubic.point(u) - point, cubic.derivative(u));
            (offset.dot(&tangent), tangent.norm_squared() + offset.dot(&cubic.second_derivative(u)))
        };
        let (at_start, at_end) = (condition(0.0).0, condition(h).0);
        if at_start < 0.0 && at_end > 0.0 {
            // in arc lengths of the curve, whose last digit the steps can settle
            let start = self.knots[interval];
            bracketed_newton(|s| condition(s - start), start, start + h) - start
        } else if (point - cubic.a).norm_squared() <= (point - cubic.point(h)).norm_squared() {
            0.0
        } else {
            h
        }
    }

    /// Smallest arc length at which the curve crosses `y` (m), if it does.
    pub fn s_at_y(&self, y: f64) -> Option<f64> {
        // On a curve that only runs to the field side, all knots before the crossing lie on the gauge side of it.
        let first =
            if self.increasing_y { self.cubics.partition_point(|c| c.a.x <= y).max(1) - 1 } else { 0 };
        let intervals = if self.increasing_y { first..first + 1 } else { 0..self.cubics.len() };
        let mut before = self.cubics[first].a.x - y;
        for interval in intervals {
            let cubic = &self.cubics[interval];
            let h = self.knots[interval + 1] - self.knots[interval];
            let after = cubic.point(h).x - y;
            if before == 0.0 {
                return Some(self.knots[interval]);
            }
            if after == 0.0 {
                return Some(self.knots[interval + 1]);
            }
            if before * after < 0.0 {
                let (sign, start) = (after.signum(), self.knots[interval]);
                let condition = |s: f64| {
                    let u = s - start;
                    (sign * (cubic.point(u).x - y), sign * cubic.derivative(u).x)
                };
                return Some(bracketed_newton(condition, start, start + h));
            }
            before = after;
        }
        None
    }

    /// Arc lengths from 0 to the end, at most `max_step` (m) apart, with every breakpoint among them.
    pub fn sample_parameters(&self, max_step: f64) -> Vec<f64> {
        self.sample_with(|_, _| max_step)
    }

    /// Points of the curve from its start to its end, at most `max_step` (m) apart, breakpoints included.
    pub fn sample(&self, max_step: f64) -> Vec<Point2<f64>> {
        self.sample_parameters(max_step).into_iter().map(|s| self.point(s)).collect()
    }

    /// Arc lengths as [`Self::sample_parameters`], closer where the curve bends: a chord stays within
    /// `chord_tolerance` (m) of the curve.
    pub fn sample_adaptive(&self, max_step: f64, chord_tolerance: f64) -> Vec<f64> {
        self.sample_with(|s0, s1| {
            let curvature = (self.first_interval(s0)..self.cubics.len())
                .take_while(|&i| self.knots[i] < s1)
                .map(|i| self.curvature(0.5 * (self.knots[i] + self.knots[i + 1])).abs())
                .fold(0.0, f64::max);
            // The sagitta of an arc of length h is κ h²/8.
            if curvature > 0.0 { max_step.min((8.0 * chord_tolerance / curvature).sqrt()) } else { max_step }
        })
    }

    fn first_interval(&self, s: f64) -> usize {
        self.locate(s).0
    }

    /// Divides each stretch between breakpoints evenly, by the step that `step_of` gives for its ends.
    fn sample_with(&self, step_of: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let mut ends = vec![0.0];
        ends.extend(self.breakpoints());
        ends.push(self.length());
        let mut parameters = vec![0.0];
        for pair in ends.windows(2) {
            let (s0, s1) = (pair[0], pair[1]);
            let step = step_of(s0, s1).max(SAME_POINT);
            // A ratio that is whole up to round-off must not give an extra point.
            let parts = ((s1 - s0) / step - 1e-9).ceil().max(1.0) as usize;
            parameters.extend((1..parts).map(|i| s0 + (s1 - s0) * i as f64 / parts as f64));
            parameters.push(s1);
        }
        parameters
    }

    /// The curve turned by `angle` (rad, from y towards z) about the origin and then moved by `translation` (m).
    pub fn transformed(&self, angle: f64, translation: Vector2<f64>) -> Self {
        let turn = Rotation2::new(angle);
        let cubics = self
            .cubics
            .iter()
            .map(|q| Cubic { a: turn * q.a + translation, b: turn * q.b, c: turn * q.c, d: turn * q.d })
            .collect();
        Self::assemble(self.knots.clone(), cubics, self.breaks.clone())
    }

    /// The curves one after the other, each beginning where the one before it ends; the joints are breakpoints.
    ///
    /// # Panics
    /// Without any curve.
    pub(crate) fn chained(parts: &[&Self]) -> Self {
        assert!(!parts.is_empty(), "a chain needs a curve");
        let (mut knots, mut cubics, mut breaks) = (vec![0.0], Vec::new(), Vec::new());
        for part in parts {
            let (before, count) = (knots[knots.len() - 1], cubics.len());
            if count > 0 {
                breaks.push(count);
            }
            breaks.extend(part.breaks.iter().map(|i| i + count));
            knots.extend(part.knots[1..].iter().map(|s| before + s));
            cubics.extend_from_slice(&part.cubics);
        }
        Self::assemble(knots, cubics, breaks)
    }

    /// Arc lengths of the knots of the spline; between them the curve is one cubic.
    pub(crate) fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// ∫ f(p, dp/ds) ds over the curve, five Gauss points a knot interval.
    pub(crate) fn integrate<const N: usize>(
        &self,
        f: impl Fn(&Point2<f64>, &Vector2<f64>) -> [f64; N],
    ) -> [f64; N] {
        let mut sum = [0.0; N];
        for (cubic, s) in self.cubics.iter().zip(self.knots.windows(2)) {
            let h = s[1] - s[0];
            for (x, w) in GAUSS_5_UNIT {
                let value = f(&cubic.point(x * h), &cubic.derivative(x * h));
                for (total, v) in sum.iter_mut().zip(value) {
                    *total += w * h * v;
                }
            }
        }
        sum
    }
}

fn describe(p: &Point2<f64>) -> String {
    format!("(y {:.6} mm, z {:.6} mm)", p.x / MILLIMETRE, p.y / MILLIMETRE)
}

fn check_points(points: &[Point2<f64>]) -> Result<()> {
    if points.len() < 4 {
        return InputError::refuse(
            "profile",
            format!("{} points", points.len()),
            "at least 4 points",
            "measure or sample the profile more densely",
        );
    }
    for (i, p) in points.iter().enumerate() {
        if !(p.x.is_finite() && p.y.is_finite()) {
            return InputError::refuse(
                format!("profile.points[{i}]"),
                describe(p),
                "finite coordinates",
                "correct or remove this point",
            );
        }
    }
    for i in 1..points.len() {
        let step = points[i] - points[i - 1];
        if step.norm() < SAME_POINT {
            return InputError::refuse(
                format!("profile.points[{i}]"),
                describe(&points[i]),
                "a point at least 0.0001 mm from the one before it",
                "profile out of order: remove the repeated point",
            );
        }
        if i >= 2 && (points[i - 1] - points[i - 2]).angle(&step) > STEP_BACK {
            return InputError::refuse(
                format!("profile.points[{i}]"),
                describe(&points[i]),
                format!("a point that goes on from {}, not back", describe(&points[i - 1])),
                "profile out of order: sort the points along the profile, or remove the stray one",
            );
        }
    }
    Ok(())
}

fn check_kinks(points: usize, kinks: &[usize]) -> Result<()> {
    let mut least = 1;
    for (i, &kink) in kinks.iter().enumerate() {
        if kink < least || kink + 1 >= points {
            return InputError::refuse(
                format!("profile.kinks[{i}]"),
                kink,
                format!("the index of an inner point ({least} to {})", points.saturating_sub(2)),
                "give the kinks in increasing order, each once",
            );
        }
        least = kink + 1;
    }
    Ok(())
}
