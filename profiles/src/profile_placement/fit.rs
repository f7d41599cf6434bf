//! The robust fit: reweighted Gauss-Newton steps on the distances from the outline.
//!
//! Material that is missing is wear: its cost has a bound (Geman and McClure). A worn body has no more material than the
//! standard, so that points outside of the running surface cost without bound, though slowly (Cauchy), as a lip or a grain
//! of dirt must not decide.

use nalgebra::{Matrix4, Point2, Rotation2, SymmetricEigen, Vector2, Vector4};

use super::reference::Reference;
use crate::units::MILLIMETRE;

/// Weight of the surface that wears against that which does not.
const WEARS: f64 = 0.2;
/// Distances beyond this count as this, m.
const FAR: f64 = 20.0 * MILLIMETRE;
/// Lengths along the profile whose errors may depend on each other, m.
const BLOCK: f64 = 2.0 * MILLIMETRE;
/// Where the damping of a step begins, as a part of the diagonal.
const DAMPING: f64 = 1e-9;

/// A point of the measurement about the middle of all, and the length of profile that it stands for, m.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub at: Vector2<f64>,
    pub length: f64,
}

/// p' = scale · R(angle) · p + middle, for points about their middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pose {
    pub middle: Point2<f64>,
    pub angle: f64,
    pub scale: f64,
}

impl Pose {
    pub fn apply(&self, at: &Vector2<f64>) -> Point2<f64> {
        self.middle + self.scale * (Rotation2::new(self.angle) * at)
    }

    fn moved(&self, step: &Vector4<f64>) -> Self {
        Self {
            middle: self.middle + step.xy(),
            angle: self.angle + step.z,
            scale: self.scale * (1.0 + step.w),
        }
    }
}

/// Foot of a placed point on the outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Foot {
    /// Arc length, m.
    pub s: f64,
    /// Material missing at the point, m: negative outside of the standard.
    pub missing: f64,
    /// Unit vector out of the material along which it is measured.
    pub outward: Vector2<f64>,
}

/// Foot of `p`, near the arc length `guess` if there is one.
pub(super) fn foot(reference: &Reference, p: &Point2<f64>, guess: Option<f64>) -> Foot {
    /// Distance below which the direction from the foot is that of the normal, m.
    const ON_CURVE: f64 = 1e-9;
    let (s, distance) = match guess {
        Some(s) => reference.curve.closest_near(p, s),
        None => reference.curve.closest(p),
    };
    let normal = reference.outward(s);
    if distance < ON_CURVE {
        return Foot { s, missing: 0.0, outward: normal };
    }
    let direction = (p - reference.curve.point(s)) / distance;
    if direction.dot(&normal) < 0.0 {
        Foot { s, missing: distance, outward: -direction }
    } else {
        Foot { s, missing: -distance, outward: direction }
    }
}

/// Arc length of the place of the standard's outline that is nearest to a point, and the material missing at the point, both m.
pub fn missing(reference: &Reference, p: &Point2<f64>) -> (f64, f64) {
    let foot = foot(reference, p, None);
    (foot.s, foot.missing)
}

/// Cost of a point, and its slope over the square of the distance in units of the scale.
fn loss(reference: &Reference, foot: &Foot, scale: f64) -> (f64, f64) {
    if reference.ends(foot.s) {
        return (1.0, 0.0);
    }
    let square = (foot.missing.abs().min(FAR) / scale).powi(2);
    if foot.missing < 0.0 && reference.runs(foot.s) {
        (square.ln_1p(), 1.0 / (1.0 + square))
    } else {
        (square / (1.0 + square), 1.0 / (1.0 + square).powi(2))
    }
}

/// Second derivative of half the cost over the distance in units of the scale.
fn curvature(reference: &Reference, foot: &Foot, scale: f64) -> f64 {
    if reference.ends(foot.s) {
        return 0.0;
    }
    let square = (foot.missing.abs().min(FAR) / scale).powi(2);
    if foot.missing < 0.0 && reference.runs(foot.s) {
        (1.0 - square) / (1.0 + square).powi(2)
    } else {
        (1.0 - 3.0 * square) / (1.0 + square).powi(3)
    }
}

/// Share of a point that counts as kept: half at half the scale.
pub(super) fn kept(reference: &Reference, foot: &Foot, scale: f64) -> f64 {
    loss(reference, foot, scale).1
}

fn weight(reference: &Reference, s: f64) -> f64 {
    if reference.keeps(s) { 1.0 } else { WEARS }
}

/// Cost of a pose, m: the length of profile that is not explained. None from `most` on, which is seen by the first points.
pub(super) fn cost_below(
    reference: &Reference,
    samples: &[Sample],
    pose: &Pose,
    scale: f64,
    most: f64,
) -> Option<f64> {
    let mut cost = 0.0;
    for sample in samples {
        let foot = foot(reference, &pose.apply(&sample.at), None);
        cost += sample.length * weight(reference, foot.s) * loss(reference, &foot, scale).0;
        if cost >= most {
            return None;
        }
    }
    Some(cost)
}

/// The whole cost, with feet near the given ones.
pub(super) fn cost_near(
    reference: &Reference,
    samples: &[Sample],
    pose: &Pose,
    scale: f64,
    near: &[Foot],
) -> f64 {
    let feet = feet_near(reference, samples, pose, near);
    samples
        .iter()
        .zip(&feet)
        .map(|(sample, foot)| sample.length * weight(reference, foot.s) * loss(reference, foot, scale).0)
        .sum()
}

/// What the points say about a step of the pose.
struct Normal {
    cost: f64,
    matrix: Matrix4<f64>,
    gradient: Vector4<f64>,
}

fn row(pose: &Pose, p: &Point2<f64>, outward: &Vector2<f64>) -> Vector4<f64> {
    let arm = p - pose.middle;
    Vector4::new(outward.x, outward.y, arm.perp(outward), arm.dot(outward))
}

fn normal(reference: &Reference, samples: &[Sample], feet: &[Foot], pose: &Pose, scale: f64) -> Normal {
    let mut sum = Normal { cost: 0.0, matrix: Matrix4::zeros(), gradient: Vector4::zeros() };
    for (sample, foot) in samples.iter().zip(feet) {
        let (cost, slope) = loss(reference, foot, scale);
        let share = sample.length * weight(reference, foot.s);
        sum.cost += share * cost;
        let row = row(pose, &pose.apply(&sample.at), &foot.outward);
        sum.matrix += (share * slope) * row * row.transpose();
        // The point lies `-missing` out of the material.
        sum.gradient -= (share * slope * foot.missing) * row;
    }
    sum
}

fn feet_near(reference: &Reference, samples: &[Sample], pose: &Pose, near: &[Foot]) -> Vec<Foot> {
    let places = samples.iter().zip(near);
    places.map(|(sample, near)| foot(reference, &pose.apply(&sample.at), Some(near.s))).collect()
}

/// Gauss-Newton steps at one scale, damped where the cost does not fall. Returns pose and cost.
pub(super) fn settle(
    reference: &Reference,
    samples: &[Sample],
    start: Pose,
    scale: f64,
    most_steps: usize,
    free_scale: bool,
) -> (Pose, f64) {
    let at = feet_of(reference, samples, &start);
    let (pose, cost, _) = settle_from(reference, samples, (start, at), scale, most_steps, free_scale);
    (pose, cost)
}

/// As [`settle`], from known feet, which are looked for near those of the step before.
fn settle_from(
    reference: &Reference,
    samples: &[Sample],
    (start, mut at): (Pose, Vec<Foot>),
    scale: f64,
    most_steps: usize,
    free_scale: bool,
) -> (Pose, f64, Vec<Foot>) {
    /// Step at which the iteration ends, m; angles and sizes count with an arm of 30 mm.
    const SETTLED: f64 = 1e-9;
    const ARM: f64 = 30.0 * MILLIMETRE;
    const GREATEST_DAMPING: f64 = 1e3;
    let mut pose = start;
    let mut here = normal(reference, samples, &at, &pose, scale);
    let mut damping = DAMPING;
    for _ in 0..most_steps {
        let mut matrix = here.matrix;
        for i in 0..4 {
            matrix[(i, i)] += damping * matrix[(i, i)] + f64::MIN_POSITIVE;
        }
        if !free_scale {
            matrix.set_row(3, &Vector4::w().transpose());
            matrix.set_column(3, &Vector4::w());
        }
        let mut right = -here.gradient;
        if !free_scale {
            right.w = 0.0;
        }
        let Some(step) = matrix.cholesky().map(|factor| factor.solve(&right)) else { break };
        let next = pose.moved(&step);
        let next_at = feet_near(reference, samples, &next, &at);
        let there = normal(reference, samples, &next_at, &next, scale);
        if there.cost > here.cost {
            damping = (damping * 100.0).max(1e-3);
            if damping > GREATEST_DAMPING {
                break;
            }
            continue;
        }
        damping = (damping * 0.1).max(DAMPING);
        let size = step.xy().norm() + ARM * (step.z.abs() + step.w.abs());
        (pose, at, here) = (next, next_at, there);
        if size < SETTLED {
            break;
        }
    }
    (pose, here.cost, at)
}

/// From a coarse scale to a fine one, each stage beginning where the one before it ended.
pub(super) fn sharpen(
    reference: &Reference,
    samples: &[Sample],
    start: Pose,
    scales: [f64; 2],
    steps: usize,
) -> (Pose, f64) {
    const RATIO: f64 = 0.55;
    let mut scale = scales[0].max(scales[1]);
    let mut from = (start, feet_of(reference, samples, &start));
    loop {
        let (pose, cost, at) = settle_from(reference, samples, from, scale, steps, false);
        from = (pose, at);
        if scale <= scales[1] {
            return (pose, cost);
        }
        scale = (RATIO * scale).max(scales[1]);
    }
}

/// Covariance of the four parameters about the pose: what neighbouring points have in common counts once (sums over
/// blocks). `None` where the points leave a motion free. Surface that wears says where the profile lies only if half of it at
/// least is as it was: less may be evenly worn.
pub(super) fn covariance(
    reference: &Reference,
    samples: &[Sample],
    feet: &[Foot],
    pose: &Pose,
    scale: f64,
    free_scale: bool,
) -> Option<Matrix4<f64>> {
    /// Ratio of the eigenvalues, in units of length, from which a motion is free.
    const FREE: f64 = 1e-9;
    const ARM: f64 = 30.0 * MILLIMETRE;
    let size = if free_scale { 4 } else { 3 };
    let (mut hessian, mut sums) = (Matrix4::zeros(), Matrix4::zeros());
    let (mut block, mut length, mut said, mut blocks) = (Vector4::zeros(), 0.0, false, 0usize);
    let unworn = unworn(reference, samples, feet, scale);
    for (i, (sample, foot)) in samples.iter().zip(feet).enumerate() {
        length += sample.length;
        if unworn || reference.keeps(foot.s) {
            let (slope, bend) = (loss(reference, foot, scale).1, curvature(reference, foot, scale));
            let mut row = row(pose, &pose.apply(&sample.at), &foot.outward);
            row.z /= ARM;
            row.w = if free_scale { row.w / ARM } else { 0.0 };
            let share = sample.length * weight(reference, foot.s);
            hessian += (share * bend) * row * row.transpose();
            block -= (share * slope * foot.missing) * row;
            said |= slope > 0.5;
        }
        if length > BLOCK || i + 1 == samples.len() {
            sums += block * block.transpose();
            blocks += usize::from(said);
            (block, length, said) = (Vector4::zeros(), 0.0, false);
        }
    }
    if blocks <= size {
        return None;
    }
    if !free_scale {
        hessian[(3, 3)] = 1.0;
    }
    let eigen = SymmetricEigen::new(hessian);
    let used = eigen.eigenvalues.as_slice();
    let (low, high) = used.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(*v), b.max(*v)));
    if low.is_nan() || low <= FREE * high {
        return None;
    }
    let inverse = hessian.try_inverse()?;
    let few = blocks as f64 / (blocks - size) as f64;
    let mut found = few * inverse * sums * inverse;
    for i in 0..4 {
        for j in 0..4 {
            found[(i, j)] /= if i > 1 { ARM } else { 1.0 } * if j > 1 { ARM } else { 1.0 };
        }
    }
    Some(found)
}

/// Whether at least half of the measured surface that wears lies on the standard, and enough of that which does not.
fn unworn(reference: &Reference, samples: &[Sample], feet: &[Foot], scale: f64) -> bool {
    /// Least length of the surface that does not wear, m: both arcs of a flange's tip.
    const LEAST: f64 = 10.0 * MILLIMETRE;
    let lies = |keeps: bool| {
        let there = samples.iter().zip(feet).filter(|(_, foot)| reference.keeps(foot.s) == keeps);
        there.fold([0.0, 0.0], |[whole, lies], (sample, foot)| {
            [whole + sample.length, lies + sample.length * kept(reference, foot, scale)]
        })
    };
    let ([whole, wears], [_, stays]) = (lies(false), lies(true));
    wears >= 0.5 * whole && stays >= LEAST
}

/// Feet of all points at a pose.
pub(super) fn feet_of(reference: &Reference, samples: &[Sample], pose: &Pose) -> Vec<Foot> {
    samples.iter().map(|sample| foot(reference, &pose.apply(&sample.at), None)).collect()
}
