//! From the points of a measurement to their place.

use nalgebra::{Matrix4, Point2, Rotation2, Vector2, Vector4};

use super::fit::{Foot, Pose, Sample, covariance, feet_of, kept, settle};
use super::reference::Reference;
use super::side::{Side, side_of, worn_sides};
use super::starts::{Candidate, mirrored, starts, thinned};
use crate::error::{InputError, Result};
use crate::profile_file::{MeasuredProfile, scatter};
use crate::units::MILLIMETRE;

/// Points of the last fit.
const MOST_POINTS: usize = 3000;
/// Scale of the loss in standard deviations of the scatter: kept points have nearly their whole weight.
const SCALE_TO_NOISE: f64 = 3.0;
/// Least scale, m: rounding of files, and what the form of a surface departs from its drawing at best.
const LEAST_SCALE: f64 = 12e-6;
/// Greatest scale, m: the tolerance of rolled and turned profiles.
const GREATEST_SCALE: f64 = 0.3 * MILLIMETRE;
/// Share of the kept parts that has to lie on the standard; of the sides of a head one may be worn.
const ACCEPTED: f64 = 0.3;
/// Greatest uncertainty (two standard deviations) of a place that counts as determined, m.
pub(super) const GREATEST_SHIFT: f64 = 0.05 * MILLIMETRE;
/// The same of its rotation, rad.
pub(super) const GREATEST_TURN: f64 = 0.05 * std::f64::consts::PI / 180.0;
/// A worn place is not deeper than this, m.
const DEEPEST: f64 = 12.0 * MILLIMETRE;
/// Material beyond the standard that a lip or the tolerance of the form explains, m.
const BEYOND: f64 = 0.5 * MILLIMETRE;
/// Share of the profile that may be neither kept nor worn: the files of the other body have 0.17 and more.
const MOST_UNEXPLAINED: f64 = 0.1;

/// What the caller knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PlaceOptions {
    /// The side is known: the profile is not turned over for where a head is worn.
    pub side_known: bool,
}

impl PlaceOptions {
    /// The same for a profile whose side a groove may tell.
    #[must_use]
    pub fn of(self, profile: &MeasuredProfile) -> Self {
        Self { side_known: self.side_known || profile.side_by_groove }
    }
}

/// p' = R(angle) · (±y, z) + translation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Whether the mirror image is taken (y to -y) before the turn.
    pub mirrored: bool,
    /// Rotation, rad, from y towards z.
    pub angle: f64,
    /// Translation, m.
    pub translation: Vector2<f64>,
}

impl Motion {
    /// Where a point goes.
    pub fn apply(&self, p: &Point2<f64>) -> Point2<f64> {
        let y = if self.mirrored { -p.x } else { p.x };
        Rotation2::new(self.angle) * Point2::new(y, p.y) + self.translation
    }
}

/// Standard uncertainties of a place; infinite where the kept parts leave a motion free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Of the origin, lateral, m.
    pub y: f64,
    /// Of the origin, vertical, m.
    pub z: f64,
    /// Of the rotation, rad.
    pub angle: f64,
}

/// How large the standard is against the measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    /// Factor that fits best.
    pub factor: f64,
    /// Its standard uncertainty; infinite where the kept parts do not tell.
    pub uncertainty: f64,
}

impl Size {
    /// Whether nothing speaks against the measured size: half a percent is more than tolerances of form explain.
    pub fn is_one(&self) -> bool {
        const TOLERANCE: f64 = 0.005;
        (self.factor - 1.0).abs() <= TOLERANCE.max(4.0 * self.uncertainty) || self.uncertainty > TOLERANCE
    }
}

/// A point in its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedPoint {
    /// Position in the frame of the standard, m.
    pub point: Point2<f64>,
    /// Arc length of the nearest point of the standard's outline, m.
    pub s: f64,
    /// Material missing against the standard, m: the wear; negative where there is more.
    pub missing: f64,
    /// Weight in the fit, 0 to 1: whether the surface is as it was.
    pub kept: f64,
}

/// A placed measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed {
    /// How it was moved.
    pub motion: Motion,
    /// How sure that is.
    pub spread: Spread,
    /// Its size, which is not applied.
    pub size: Size,
    /// Scatter of the points, m.
    pub noise: f64,
    /// Root mean square of the distances of the kept points from the standard, m.
    pub rms: f64,
    /// Length of profile on kept parts that lies on the standard, m.
    pub kept_length: f64,
    /// Length of the profile, m.
    pub length: f64,
    /// Share of the profile that is neither on the standard nor worn.
    pub unexplained: f64,
    /// What left and right were distinguished by.
    pub side: Side,
    /// The points, in the order in which they were given.
    pub points: Vec<PlacedPoint>,
}

impl Placed {
    /// Whether the kept parts determine origin and rotation within 0.05 mm and 0.05° (two standard uncertainties).
    pub fn determined(&self) -> bool {
        let Spread { y, z, angle } = self.spread;
        2.0 * y <= GREATEST_SHIFT && 2.0 * z <= GREATEST_SHIFT && 2.0 * angle <= GREATEST_TURN
    }

    /// Whether the shape is that of the standard, worn or not.
    pub fn resembles(&self) -> bool {
        self.unexplained <= MOST_UNEXPLAINED
    }

    /// Whether it is, and something that wear leaves alone lies on the standard.
    pub fn fits(&self) -> bool {
        self.resembles() && self.kept_length > 0.0
    }
}

/// Lays the points of a measurement (m, in order along the profile, any origin, rotation within some degrees or upside
/// down, either side) onto the standard. `None` where nothing that is turned by up to 15° resembles it.
///
/// # Errors
/// [`InputError`] for fewer than ten points or points without extent.
pub fn place(points: &[Point2<f64>], reference: &Reference, options: PlaceOptions) -> Result<Option<Placed>> {
    let (samples, centre) = samples(points)?;
    let noise = scatter(&[points.to_vec()]).deviation;
    let mirrors: &[bool] = if reference.symmetric { &[false] } else { &[false, true] };
    let mut scale = (SCALE_TO_NOISE * noise).clamp(LEAST_SCALE, GREATEST_SCALE);
    let starts = starts(reference, &samples, mirrors);
    loop {
        let found = starts.candidates(reference, scale);
        let Some(&best) = found.first() else { return Ok(None) };
        let placed = finish(points, &samples, centre, reference, best, scale, noise, options);
        if placed.1 >= ACCEPTED || scale >= GREATEST_SCALE {
            return Ok(Some(placed.0));
        }
        scale = (3.0 * scale).min(GREATEST_SCALE);
    }
}

/// The points about their middle, each with the length of profile that it stands for.
fn samples(points: &[Point2<f64>]) -> Result<(Vec<Sample>, Point2<f64>)> {
    const FEWEST: usize = 10;
    /// A point stands for no more than this many times the usual step: a gap has no points.
    const LONGEST: f64 = 3.0;
    let refuse = |value: String| {
        let expected = format!("at least {FEWEST} points along a profile");
        InputError::refuse("profile", value, expected, "give the whole profile")
    };
    if points.len() < FEWEST {
        return refuse(format!("{} points", points.len()));
    }
    let steps: Vec<f64> = points.windows(2).map(|w| (w[1] - w[0]).norm()).collect();
    let mut sorted = steps.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let most = LONGEST * sorted[sorted.len() / 2];
    if most.is_nan() || most <= 0.0 || most.is_infinite() {
        return refuse("points without extent".into());
    }
    let centre = Point2::from(points.iter().map(|p| p.coords).sum::<Vector2<f64>>() / points.len() as f64);
    let step = |i: usize| steps.get(i).map_or(0.0, |step| step.min(most));
    let samples = points
        .iter()
        .enumerate()
        .map(|(i, p)| {
            let before = if i > 0 { step(i - 1) } else { 0.0 };
            Sample { at: p - centre, length: 0.5 * (before + step(i)) }
        })
        .collect();
    Ok((samples, centre))
}

/// The last fit with all points, and what follows from it; with the share of the kept parts that lies on the standard.
#[expect(clippy::too_many_arguments, reason = "what a fit has found so far")]
fn finish(
    points: &[Point2<f64>],
    samples: &[Sample],
    centre: Point2<f64>,
    reference: &Reference,
    best: Candidate,
    scale: f64,
    noise: f64,
    options: PlaceOptions,
) -> (Placed, f64) {
    const STEPS: usize = 60;
    let mut image = if best.mirrored { mirrored(samples) } else { samples.to_vec() };
    let fitted = if image.len() > MOST_POINTS { thinned(&image, MOST_POINTS) } else { image.clone() };
    let (mut pose, _) = settle(reference, &fitted, best.pose, scale, STEPS, false);
    let mut turned = best.mirrored;
    let mut feet = feet_of(reference, &image, &pose);
    let found = covariance(reference, &image, &feet, &pose, scale, false);
    let lengths: Vec<f64> = samples.iter().map(|sample| sample.length).collect();
    let shares: Vec<f64> = feet.iter().map(|foot| kept(reference, foot, scale)).collect();
    let inner = without_edges(&image, &shares);
    let (again, _) = settle(reference, &inner, pose, scale, STEPS, false);
    let spread = spread(found.as_ref(), &pose, &again, noise);
    let across = spread.y.max(spread.z);
    let (side, over) = side_of(reference, worn_sides(reference, &feet, &lengths), across);
    if over && !options.side_known {
        pose = Pose { middle: Point2::new(-pose.middle.x, pose.middle.y), angle: -pose.angle, ..pose };
        image = mirrored(&image);
        turned = !turned;
        feet = feet_of(reference, &image, &pose);
    }
    let size = size(reference, &image, pose, scale);
    let sum = |of: &dyn Fn(usize) -> f64| (0..samples.len()).map(|i| lengths[i] * of(i)).sum::<f64>();
    let keeps = |i: usize| f64::from(reference.keeps(feet[i].s));
    let length = sum(&|_| 1.0);
    let kept_length = sum(&|i| keeps(i) * shares[i]);
    let rms = (sum(&|i| shares[i] * feet[i].missing.powi(2)) / sum(&|i| shares[i])).sqrt();
    let unexplained = sum(&|i| f64::from(!explained(reference, &feet[i]))) / length;
    let centre = if turned { Point2::new(-centre.x, centre.y) } else { centre };
    let translation = pose.middle - Rotation2::new(pose.angle) * centre;
    let motion = Motion { mirrored: turned, angle: wrapped(pose.angle), translation };
    let placed = Placed {
        motion,
        spread,
        size,
        noise,
        rms,
        kept_length,
        length,
        unexplained,
        side,
        points: (0..samples.len())
            .map(|i| PlacedPoint {
                point: motion.apply(&points[i]),
                s: feet[i].s,
                missing: feet[i].missing,
                kept: shares[i],
            })
            .collect(),
    };
    (placed, kept_length / sum(&keeps))
}

/// Whether a point lies on the standard or where it may be worn.
fn explained(reference: &Reference, foot: &Foot) -> bool {
    !reference.ends(foot.s)
        && (foot.missing.abs() < BEYOND || (reference.runs(foot.s) && (0.0..DEEPEST).contains(&foot.missing)))
}

/// The angle within half a turn.
fn wrapped(angle: f64) -> f64 {
    let (sin, cos) = angle.sin_cos();
    sin.atan2(cos)
}

/// The samples that are kept, without those beside worn ones: where wear begins it is too small to be seen, and pulls.
fn without_edges(image: &[Sample], shares: &[f64]) -> Vec<Sample> {
    /// Length beside worn surface that is left out, m.
    const EDGE: f64 = 3.0 * MILLIMETRE;
    /// Length over which points are worn on the average, m: a single one may be dirt.
    const WORN: f64 = 1.0 * MILLIMETRE;
    let mut ends = vec![0.0];
    ends.extend(image.iter().scan(0.0, |sum, sample| {
        *sum += sample.length;
        Some(*sum)
    }));
    let mut weighted = vec![0.0];
    weighted.extend(image.iter().zip(shares).scan(0.0, |sum, (sample, share)| {
        *sum += sample.length * share;
        Some(*sum)
    }));
    let whole = ends[image.len()];
    let mean = |middle: f64, half: f64| {
        let from = ends.partition_point(|end| *end < middle - half).min(image.len() - 1);
        let to = ends.partition_point(|end| *end <= middle + half).max(from + 2).min(image.len() + 1) - 1;
        (weighted[to] - weighted[from]) / (ends[to] - ends[from]).max(f64::MIN_POSITIVE)
    };
    let worn: Vec<bool> =
        (0..image.len()).map(|i| mean(0.5 * (ends[i] + ends[i + 1]), 0.5 * WORN) < 0.5).collect();
    let mut counts = vec![0usize];
    counts.extend(worn.iter().scan(0, |sum, worn| {
        *sum += usize::from(*worn);
        Some(*sum)
    }));
    (0..image.len())
        .filter(|&i| {
            let middle = 0.5 * (ends[i] + ends[i + 1]);
            let from = ends.partition_point(|end| *end < (middle - EDGE).max(0.0)).min(image.len());
            let to = ends.partition_point(|end| *end <= (middle + EDGE).min(whole)).min(image.len());
            counts[to] == counts[from]
        })
        .map(|i| image[i])
        .collect()
}

/// Uncertainty of the origin of the standard's frame: from the scatter, from where the profile lies `again` when the
/// neighbourhood of worn surface is left out, and from wear that is too small to be seen in a scatter of `noise` (m).
fn spread(found: Option<&Matrix4<f64>>, pose: &Pose, again: &Pose, noise: f64) -> Spread {
    /// How far such wear moves the profile, in standard deviations of the scatter; over the arm it turns it.
    const UNSEEN: f64 = 0.1;
    const ARM: f64 = 30.0 * MILLIMETRE;
    let Some(covariance) = found else {
        return Spread { y: f64::INFINITY, z: f64::INFINITY, angle: f64::INFINITY };
    };
    // A turn about the middle moves the origin by (-arm.z, arm.y).
    let arm = -pose.middle.coords;
    let rows = [Vector4::new(1.0, 0.0, -arm.y, 0.0), Vector4::new(0.0, 1.0, arm.x, 0.0), Vector4::z()];
    let moved = again.middle - pose.middle;
    let step = Vector4::new(moved.x, moved.y, again.angle - pose.angle, 0.0);
    let [y, z, angle] = rows.map(|row| row.dot(&(covariance * row)).max(0.0).sqrt().hypot(row.dot(&step)));
    let unseen = UNSEEN * noise;
    Spread { y: y.hypot(unseen), z: z.hypot(unseen), angle: angle.hypot(unseen / ARM) }
}

fn size(reference: &Reference, image: &[Sample], pose: Pose, scale: f64) -> Size {
    const STEPS: usize = 30;
    let (freed, _) = settle(reference, image, pose, scale, STEPS, true);
    let feet = feet_of(reference, image, &freed);
    let variance = covariance(reference, image, &feet, &freed, scale, true).map(|found| found[(3, 3)]);
    let uncertainty = variance.map_or(f64::INFINITY, |v| v.max(0.0).sqrt() * freed.scale);
    Size { factor: freed.scale, uncertainty }
}
