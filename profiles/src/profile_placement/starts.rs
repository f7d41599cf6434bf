//! Where the fit begins: the measurement in all its mirror images, turned and laid onto the standard's extremes.

use nalgebra::{Point2, Rotation2, Vector2};

use super::fit::{Pose, Sample, cost_below, cost_near, feet_of, settle, sharpen};
use super::reference::Reference;
use crate::profile_file::ProfileKind;
use crate::units::MILLIMETRE;

/// Turns that are tried, degrees.
const TURNS: [f64; 5] = [-6.0, -3.0, 0.0, 3.0, 6.0];
/// Points with which starts are compared.
const COARSE: usize = 70;
/// Points with which poses are refined.
const FINE: usize = 150;
/// Starts of which the fit goes on.
const FOLLOWED: usize = 8;
/// Coarse poses that are refined from several places about them.
const REFINED: usize = 2;
/// How deep below its top the sides of a head are looked for, m.
const HEAD: f64 = 35.0 * MILLIMETRE;
/// Scale at which starts are compared, m, and that at which coarse poses are.
const FIRST_SCALE: f64 = 3.0 * MILLIMETRE;
const COARSE_SCALE: f64 = 0.4 * MILLIMETRE;
/// Greatest rotation of a measurement, whichever side is up, rad.
const MOST_TURNED: f64 = 15.0 * std::f64::consts::PI / 180.0;
/// Places about a coarse pose from which it is refined.
const PLACES: usize = 6;
/// How far off a coarse pose may be that has followed worn surface, mm and degrees: a head whose gauge side is evenly worn lies as
/// well on that side, until it is seen that more of the other fits.
const ACROSS: (i32, f64) = (7, 0.5);
const DOWN: (i32, f64) = (3, 0.5);
const TURNED: (i32, f64) = (1, 1.0);

/// A pose of the measurement, or of its mirror image (y to -y).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Candidate {
    pub mirrored: bool,
    pub pose: Pose,
    pub cost: f64,
}

/// Mirror image of samples.
pub(super) fn mirrored(samples: &[Sample]) -> Vec<Sample> {
    samples.iter().map(|s| Sample { at: Vector2::new(-s.at.x, s.at.y), ..*s }).collect()
}

/// About `count` samples at equal distances along the profile.
pub(super) fn thinned(samples: &[Sample], count: usize) -> Vec<Sample> {
    let whole: f64 = samples.iter().map(|s| s.length).sum();
    let step = whole / count as f64;
    let (mut thinned, mut gathered) = (Vec::with_capacity(count), 0.0);
    for sample in samples {
        gathered += sample.length;
        if gathered >= step {
            thinned.push(Sample { length: gathered, ..*sample });
            gathered = 0.0;
        }
    }
    thinned
}

/// Places from which poses are refined, on the thinned measurement and on its mirror image.
pub(super) struct Starts {
    images: [Vec<Sample>; 2],
    starts: Vec<Candidate>,
}

/// Where the fit begins. `mirrors` are the mirror images that are tried.
pub(super) fn starts(reference: &Reference, samples: &[Sample], mirrors: &[bool]) -> Starts {
    let standard: Vec<Vector2<f64>> =
        reference.curve.sample(MILLIMETRE).into_iter().map(|p: Point2<f64>| p.coords).collect();
    // the best ones, ascending
    let mut begun: Vec<Candidate> = Vec::with_capacity(FOLLOWED + 1);
    for &mirror in mirrors {
        let all = if mirror { mirrored(samples) } else { samples.to_vec() };
        let coarse = thinned(&all, COARSE);
        for half_turn in [0.0, 180.0] {
            for turn in TURNS {
                let angle = (half_turn + turn).to_radians();
                for pose in laid_on(reference.kind, &standard, &all, angle) {
                    let most = begun.get(FOLLOWED - 1).map_or(f64::INFINITY, |last| last.cost);
                    let Some(cost) = cost_below(reference, &coarse, &pose, FIRST_SCALE, most) else {
                        continue;
                    };
                    let at = begun.partition_point(|better| better.cost <= cost);
                    begun.insert(at, Candidate { mirrored: mirror, pose, cost });
                    begun.truncate(FOLLOWED);
                }
            }
        }
    }
    let images = [thinned(samples, FINE), thinned(&mirrored(samples), FINE)];
    let image = |candidate: &Candidate| images[usize::from(candidate.mirrored)].as_slice();
    let coarse = begun
        .iter()
        .map(|candidate| {
            let (pose, _) = settle(reference, image(candidate), candidate.pose, FIRST_SCALE, 12, false);
            let (pose, cost) =
                sharpen(reference, image(candidate), pose, [0.5 * FIRST_SCALE, COARSE_SCALE], 4);
            Candidate { pose, cost, ..*candidate }
        })
        .filter(|candidate| candidate.pose.angle.sin().abs() < MOST_TURNED.sin())
        .collect();
    let coarse = distinct(coarse, MILLIMETRE);
    let near = coarse.iter().take(REFINED);
    let starts = near.flat_map(|candidate| places_about(reference, image(candidate), candidate)).collect();
    Starts { images, starts }
}

impl Starts {
    /// Poses by their cost at the scale `finest` (m), the best first, those that are the same left out.
    pub fn candidates(&self, reference: &Reference, finest: f64) -> Vec<Candidate> {
        let refined = self.starts.iter().map(|start| {
            let image = &self.images[usize::from(start.mirrored)];
            let (pose, cost) = sharpen(reference, image, start.pose, [COARSE_SCALE, finest], 4);
            Candidate { pose, cost, ..*start }
        });
        let upright = refined.filter(|candidate| candidate.pose.angle.sin().abs() < MOST_TURNED.sin());
        distinct(upright.collect(), 0.02 * MILLIMETRE)
    }
}

/// The best poses of a grid about a coarse one, and the coarse one itself.
fn places_about(reference: &Reference, samples: &[Sample], coarse: &Candidate) -> Vec<Candidate> {
    /// Scale at which they are compared, m: half the step of the grid and what a turn of half its step moves.
    const SCALE: f64 = 0.3 * MILLIMETRE;
    let steps = |(count, step): (i32, f64)| (-count..=count).map(move |i| f64::from(i) * step);
    let samples = &thinned(samples, COARSE);
    let feet = feet_of(reference, samples, &coarse.pose);
    let mut places = Vec::new();
    for turn in steps(TURNED) {
        for y in steps(ACROSS) {
            for z in steps(DOWN) {
                let pose = Pose {
                    middle: coarse.pose.middle + Vector2::new(y, z) * MILLIMETRE,
                    angle: coarse.pose.angle + turn.to_radians(),
                    ..coarse.pose
                };
                let cost = cost_near(reference, samples, &pose, SCALE, &feet);
                places.push(Candidate { pose, cost, ..*coarse });
            }
        }
    }
    let mut places = distinct(places, 1.2 * MILLIMETRE);
    places.truncate(PLACES);
    places.push(*coarse);
    places
}

/// The candidates by their cost, without those within `same` (m) of a better one.
fn distinct(mut candidates: Vec<Candidate>, same: f64) -> Vec<Candidate> {
    const ARM: f64 = 30.0 * MILLIMETRE;
    candidates.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut kept: Vec<Candidate> = Vec::new();
    for candidate in candidates {
        let near = |other: &Candidate| {
            other.mirrored == candidate.mirrored
                && (other.pose.middle - candidate.pose.middle).norm()
                    + ARM * (other.pose.angle - candidate.pose.angle).abs()
                    < same
        };
        if !kept.iter().any(near) {
            kept.push(candidate);
        }
    }
    kept
}

/// Poses at an angle that lay the lowest or highest place, and one side after the other, onto those of a `standard` by its points.
fn laid_on(kind: ProfileKind, standard: &[Vector2<f64>], samples: &[Sample], angle: f64) -> Vec<Pose> {
    let turn = Rotation2::new(angle);
    let turned: Vec<Vector2<f64>> = samples.iter().map(|s| turn * s.at).collect();
    let shifts = match kind {
        ProfileKind::Rail => {
            let (ours, theirs) = (head(&turned), head(standard));
            let middle = |sides: [f64; 2]| 0.5 * (sides[0] + sides[1]);
            let z = theirs.top - ours.top;
            vec![
                Vector2::new(theirs.sides[0] - ours.sides[0], z),
                Vector2::new(theirs.sides[1] - ours.sides[1], z),
                Vector2::new(middle(theirs.sides) - middle(ours.sides), z),
            ]
        }
        ProfileKind::Wheel => {
            let tip = |points: &[Vector2<f64>]| {
                points.iter().copied().max_by(|a, b| a.y.total_cmp(&b.y)).unwrap_or_default()
            };
            let end = |points: &[Vector2<f64>], sign: f64| {
                points.iter().map(|p| sign * p.x).fold(f64::NEG_INFINITY, f64::max) * sign
            };
            let by_tip = tip(standard) - tip(&turned);
            vec![
                by_tip,
                Vector2::new(end(standard, -1.0) - end(&turned, -1.0), by_tip.y),
                Vector2::new(end(standard, 1.0) - end(&turned, 1.0), by_tip.y),
            ]
        }
    };
    shifts.into_iter().map(|shift| Pose { middle: Point2::from(shift), angle, scale: 1.0 }).collect()
}

/// Top and sides of a head.
struct Head {
    top: f64,
    sides: [f64; 2],
}

fn head(points: &[Vector2<f64>]) -> Head {
    let top = points.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let near = points.iter().filter(|p| p.y < top + HEAD);
    let sides = near.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], p| [a.min(p.x), b.max(p.x)]);
    Head { top, sides }
}
