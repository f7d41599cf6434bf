//! Stresses in a half-space below the pressure of a contact patch.
//!
//! The patch is a list of bilinear hats; its regions may have grids of their own. Friction is left out: while a wheel is pressed, its
//! tractions depend on the loads that were put on before and jump where slip has changed its direction, so that the stress at the surface has no
//! limit on finer grids.

use super::point::ContactPoint;
use super::point_force::{PatchStress, below_unit_force};
use crate::solid::{largest_shear, von_mises};
use nalgebra::{Point2, Vector2};

/// Where below the patch a stress is largest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Its value, Pa.
    pub stress: f64,
    /// Its depth, m.
    pub depth: f64,
    /// The place above it: arc length along the profile and x, m.
    pub place: Point2<f64>,
}

/// The largest stresses below a patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Subsurface {
    /// Largest shear stress.
    pub shear: Peak,
    /// Von Mises stress.
    pub mises: Peak,
}

/// The normal force of a point of the patch, spread as the bilinear hat of its grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hat {
    /// Its place: arc length along the profile and x, m.
    pub place: Point2<f64>,
    /// Spacings of its grid along the profile and along the track, m.
    pub widths: Vector2<f64>,
    /// N.
    pub force: f64,
}

/// The hats of the `points` that carry normal `forces` (N), in the same order.
pub fn hats(points: &[ContactPoint], forces: &[f64]) -> Vec<Hat> {
    let carrying = points.iter().zip(forces).filter(|(_, force)| **force > 0.0);
    carrying.map(|(point, &force)| Hat { place: point.position, widths: point.widths, force }).collect()
}

/// Distance from a hat, in its widths in a direction, from which on it is one force in that direction, and from which on it is two.
const AFAR: f64 = 8.0;
const NEARER: f64 = 3.0;
/// Nearer by a hat is many forces, as many times farther from the place than from each other.
const NEAR: f64 = 3.0;
/// Parts of a hat in one direction, half of them, at most.
const MOST_PARTS: f64 = 32.0;
/// Ratio of the depths that are looked at.
const DEEPER: f64 = 1.5;
/// Lines across a region that are looked at, beside those whose pressure is larger than that of both neighbours.
const LINES: usize = 12;
/// Of the largest stress, what a place must have to be followed.
const NEAR_LARGEST: f64 = 0.9;
/// Rounds in which a place is followed, and the ratio of their steps.
const ROUNDS: usize = 4;
const NARROWER: f64 = 0.4;
/// The smallest depth, in the smaller spacing of the grid.
const LEAST_DEPTH: f64 = 0.25;

/// Stress of the body below at a `place` (arc length, x; m) and `depth` (m, above 0) under the `hats`.
pub fn stress_below(hats: &[Hat], poisson: f64, place: &Point2<f64>, depth: f64) -> PatchStress {
    Forces::seen_from(hats, place, 0.0, depth).stress_below(poisson, place, depth)
}

/// Forces that stand for hats.
struct Forces(Vec<(Point2<f64>, f64)>);

impl Forces {
    /// Those of `hats` as they are seen from a `place`, up to so far `across` from it, and from a `depth`, or deeper.
    fn seen_from(hats: &[Hat], place: &Point2<f64>, across: f64, depth: f64) -> Self {
        let mut forces = Vec::with_capacity(4 * hats.len());
        for hat in hats {
            // from where the hat ends
            let offset = (place - hat.place).abs() - Vector2::new(across, 0.0);
            let beside = offset.zip_map(&hat.widths, |offset, width| (offset - width).max(0.0));
            let distance = (beside.norm_squared() + depth * depth).sqrt();
            let [across, along] = [0, 1].map(|axis| Parts::seen_from(distance, hat.widths[axis]));
            for (a, of_a) in across.iter() {
                for (b, of_b) in along.iter() {
                    forces.push((hat.place + Vector2::new(a, b), of_a * of_b * hat.force));
                }
            }
        }
        Self(forces)
    }

    fn stress_below(&self, poisson: f64, place: &Point2<f64>, depth: f64) -> PatchStress {
        let mut sum = [0.0; 6];
        for (at, force) in &self.0 {
            let stress = below_unit_force(place - at, depth, poisson);
            sum.iter_mut().zip(stress).for_each(|(s, v)| *s += force * v);
        }
        sum
    }
}

/// Forces that stand for a hat in one direction. Two or more have its second moment, so that some (width/distance)⁴ of the stress is missing.
struct Parts {
    /// Half of them, the middle one included; 0 where there are two and none is in the middle.
    half: i32,
    /// Distance between them, m.
    apart: f64,
}

impl Parts {
    /// Those of a hat of a `width` as it is seen from a `distance`, m.
    fn seen_from(distance: f64, width: f64) -> Self {
        if distance >= AFAR * width {
            return Self { half: 1, apart: 0.0 };
        }
        if distance >= NEARER * width {
            return Self { half: 0, apart: width / 6.0_f64.sqrt() };
        }
        let half = (NEAR * width / distance).ceil().clamp(2.0, MOST_PARTS);
        // forces that fall off in a line on both sides have the second moment of a hat, w²/6, but for 1/half²
        Self { half: half as i32, apart: width / (half * half - 1.0).sqrt() }
    }

    /// The place of each, m, and its share.
    fn iter(&self) -> impl Iterator<Item = (f64, f64)> {
        let Self { half, apart } = *self;
        let share =
            move |n: i32| if half == 0 { 0.5 } else { f64::from(half - n.abs()) / f64::from(half * half) };
        let (first, step) = if half == 0 { (-1, 2) } else { (1 - half, 1) };
        (first..=-first).step_by(step).map(move |n| (f64::from(n) * apart, share(n)))
    }
}

/// The largest shear and von Mises stresses below `hats` and below those of a finer grid, `finer`; `None` without any. They are sought from
/// the first ones.
///
/// Some lines along the track of every region are looked at over the depth, those whose pressure is larger than their neighbours' among
/// them. Where a stress is nearly the largest it is followed across and over the depth, above both. Along the track the pressure is symmetric.
pub fn subsurface(hats: &[Hat], finer: &[Hat], poisson: f64) -> Option<[Subsurface; 2]> {
    let first = hats.first()?;
    let extent = |axis: usize| {
        let ends = hats.iter().map(|hat| hat.place[axis]);
        let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        high - low + first.widths[axis]
    };
    let deepest = extent(0).min(extent(1));
    let looked_at: Vec<[(f64, Start); 2]> =
        lines(hats).iter().map(|line| largest_on(line, hats, poisson, deepest)).collect();
    let [mises, shear] = [0, 1].map(|which| {
        let value = |line: usize| looked_at.get(line).map_or(0.0, |found| found[which].0);
        let largest = (0..looked_at.len()).map(value).fold(0.0, f64::max);
        let is_candidate = |line: &usize| {
            let beside = value(line.wrapping_sub(1)).max(value(line + 1));
            value(*line) >= beside && value(*line) >= NEAR_LARGEST * largest
        };
        let starts: Vec<&Start> =
            (0..looked_at.len()).filter(is_candidate).map(|line| &looked_at[line][which].1).collect();
        [hats, finer].map(|hats| {
            let followed = starts.iter().map(|start| follow(hats, poisson, MEASURES[which], start));
            followed.max_by(|a, b| a.stress.total_cmp(&b.stress))
        })
    });
    let both = |which: usize| Some(Subsurface { shear: shear[which]?, mises: mises[which]? });
    Some([both(0)?, both(1)?])
}

/// Von Mises stress, and the largest shear stress.
const MEASURES: [fn(PatchStress) -> f64; 2] = [von_mises, largest_shear];

/// Where a stress may be largest.
#[derive(Clone, Copy)]
struct Start {
    place: Point2<f64>,
    depth: f64,
    /// How far it may be off across, m.
    across: f64,
    /// Spacings of the grid there, m.
    widths: Vector2<f64>,
}

/// The largest von Mises stress and the largest shear stress of the depths that are looked at below a line, Pa, with their depths.
fn largest_on(line: &Start, hats: &[Hat], poisson: f64, deepest: f64) -> [(f64, Start); 2] {
    let mut found = [(0.0, *line); 2];
    let mut depth = line.depth;
    loop {
        let stress = stress_below(hats, poisson, &line.place, depth);
        for (found, measure) in found.iter_mut().zip(MEASURES) {
            let value = measure(stress);
            if value > found.0 {
                *found = (value, Start { depth, ..*line });
            }
        }
        depth *= DEEPER;
        if depth > deepest {
            return found;
        }
    }
}

/// The largest stress by a `measure` near a start, by parabolas over the depth and across. The forces that stand for the hats stay the same
/// in a round: with others at every depth the stress, which is level there, would be largest where they change.
fn follow(hats: &[Hat], poisson: f64, measure: fn(PatchStress) -> f64, start: &Start) -> Peak {
    let least = LEAST_DEPTH * start.widths.min();
    let mut best = Peak { stress: 0.0, depth: start.depth, place: start.place };
    let mut size = 1.0;
    for _ in 0..ROUNDS {
        let highest = best.depth * DEEPER.powf(-size);
        let forces = Forces::seen_from(hats, &best.place, size * start.across, highest);
        let peak = |place: Point2<f64>, depth: f64| {
            let stress = measure(forces.stress_below(poisson, &place, depth));
            Peak { stress, depth, place }
        };
        best = peak(best.place, best.depth);
        for over_depth in [true, false] {
            let centre = best;
            let at = |steps: f64| {
                let by = steps * size;
                if over_depth {
                    peak(centre.place, (centre.depth * DEEPER.powf(by)).max(least))
                } else {
                    peak(centre.place + Vector2::new(by * start.across, 0.0), centre.depth)
                }
            };
            let (below, above) = (at(-1.0), at(1.0));
            let bend = below.stress + above.stress - 2.0 * centre.stress;
            let vertex = 0.5 * (below.stress - above.stress) / bend;
            let vertex = (bend < 0.0 && vertex.abs() < 1.0).then(|| at(vertex));
            for found in [Some(below), Some(above), vertex].into_iter().flatten() {
                if found.stress > best.stress {
                    best = found;
                }
            }
        }
        size *= NARROWER;
    }
    best
}

/// Lines along the track that are looked at, with the place of the largest pressure on each.
fn lines(hats: &[Hat]) -> Vec<Start> {
    let mut highest: Vec<&Hat> = Vec::new();
    for hat in hats {
        match highest.last_mut() {
            Some(last) if last.place.x == hat.place.x => {
                if hat.force > last.force {
                    *last = hat;
                }
            }
            _ => highest.push(hat),
        }
    }
    let together = |a: &&Hat, b: &&Hat| a.widths == b.widths && b.place.x - a.place.x < 2.5 * a.widths.x;
    let mut found = Vec::new();
    for region in highest.chunk_by(together) {
        let stride = region.len().div_ceil(LINES);
        let force = |i: usize| region.get(i).map_or(0.0, |hat| hat.force);
        let is_looked_at = |i: &usize| {
            i % stride == stride / 2 || (force(*i) > force(i + 1) && force(*i) >= force(i.wrapping_sub(1)))
        };
        found.extend((0..region.len()).filter(is_looked_at).map(|i| {
            let Hat { place, widths, .. } = *region[i];
            Start { place, depth: widths.min(), across: 0.5 * stride as f64 * widths.x, widths }
        }));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::point::flat_grid;
    use super::*;

    const POISSON: f64 = 0.3;

    /// Source: Hertz' circular contact (Johnson, 3.4): below the middle the largest shear stress is 0.310·p0 at a depth of 0.481·a, and
    /// the von Mises stress, which is twice the shear on the axis, 0.620·p0 there, for ν = 0.3. Goal: both on grids of 16 and 32 points across.
    /// Accuracy: DISCRETISATION of a sphere's pressure by hats, of second order in their width, and of the tabled digits, 0.2 %; the depth, about
    /// which the stress is level, changes by as much as the stress has of its slope, 2 %.
    #[test]
    fn the_largest_shear_lies_below_a_hertz_contact() {
        const DISCRETISATION: f64 = 0.005;
        const DEPTH: f64 = 0.02;
        let (radius, peak) = (4e-3, 1e9);
        let on_grid = |count: usize| {
            let h = 2.0 * radius / count as f64;
            let points = flat_grid((count + 1, count + 1), h, |_, _| 0.0);
            let pressure =
                |p: &ContactPoint| (1.0 - p.position.coords.norm_squared() / radius.powi(2)).max(0.0);
            let forces: Vec<f64> = points.iter().map(|p| peak * pressure(p).sqrt() * p.area).collect();
            hats(&points, &forces)
        };
        let (coarse, fine) = (on_grid(16), on_grid(32));
        for Subsurface { shear, mises } in subsurface(&coarse, &fine, POISSON).unwrap() {
            println!("{shear:?} {mises:?}");
            assert!((shear.stress / (0.310 * peak) - 1.0).abs() < DISCRETISATION, "{shear:?}");
            assert!((mises.stress / (0.620 * peak) - 1.0).abs() < DISCRETISATION, "{mises:?}");
            for found in [shear, mises] {
                assert!((found.depth / (0.481 * radius) - 1.0).abs() < DEPTH, "{found:?}");
                assert!(found.place.coords.norm() < 0.05 * radius, "{found:?}");
            }
        }
        assert_eq!(subsurface(&[], &[], POISSON), None);
    }

    /// Source: every place and depth looked at. Goal: on two patches side by side the search finds the largest shear and von Mises stress of
    /// all points and of depths a tenth of a width apart, Pa. Accuracy: DISCRETISATION, a place half a width off and a depth a twentieth off,
    /// where the field is level.
    #[test]
    fn the_search_finds_what_is_largest() {
        const DISCRETISATION: f64 = 0.005;
        const DEPTH: f64 = 0.1;
        let h = 0.5e-3;
        let points = flat_grid((30, 14), h, |_, _| 0.0);
        let pressure = |p: &ContactPoint| {
            let ellipse = |centre: f64, a: f64, b: f64| {
                let (s, x) = ((p.position.x - centre) / a, p.position.y / b);
                (1.0 - s * s - x * x).max(0.0).sqrt()
            };
            900e6 * ellipse(-5e-3, 1.6e-3, 3.2e-3) + 700e6 * ellipse(2.5e-3, 4e-3, 2.5e-3)
        };
        let forces: Vec<f64> = points.iter().map(|p| pressure(p) * p.area).collect();
        let carried = hats(&points, &forces);
        let [found, _] = subsurface(&carried, &carried, POISSON).unwrap();
        let none = Peak { stress: 0.0, depth: 0.0, place: points[0].position };
        let mut all = [none; 2];
        for (point, _) in points.iter().zip(&forces).filter(|(_, force)| **force > 0.0) {
            for i in 0..60 {
                let depth = h * (0.25 + 0.1 * f64::from(i));
                let stress = stress_below(&carried, POISSON, &point.position, depth);
                for (peak, measure) in all.iter_mut().zip(MEASURES) {
                    if measure(stress) > peak.stress {
                        *peak = Peak { stress: measure(stress), depth, place: point.position };
                    }
                }
            }
        }
        for (found, all) in [(found.mises, all[0]), (found.shear, all[1])] {
            assert!((found.stress / all.stress - 1.0).abs() < DISCRETISATION, "{found:?} {all:?}");
            assert!((found.depth / all.depth - 1.0).abs() < DEPTH, "{found:?} {all:?}");
        }
    }

    /// Source: the hat in thirty-two equal parts in either direction. Goal: its stress from a tenth of a width below it to five beside it, Pa, without
    /// a jump where it has fewer parts. Accuracy: DISCRETISATION, of the largest stress at that depth, what parts with the same second moment leave.
    #[test]
    fn a_hat_is_as_its_parts() {
        const DISCRETISATION: f64 = 0.01;
        let hat = Hat { place: Point2::origin(), widths: Vector2::new(0.3e-3, 1e-3), force: 1e3 };
        let parts: Vec<(f64, f64)> = (0..32)
            .map(|n| (2.0 * f64::from(n) + 1.0) / 32.0 - 1.0)
            .map(|at: f64| (at, (1.0 - at.abs()) / 16.0))
            .collect();
        for depth in [0.2e-3, 0.5e-3, 1.1e-3, 3e-3] {
            let mut largest = 0.0_f64;
            for offset in [0.0, 0.35e-3, 0.9e-3, 1.21e-3, 3.9e-3, 4.1e-3] {
                for place in [Point2::new(offset, 0.0), Point2::new(0.0, offset)] {
                    let found = stress_below(&[hat], POISSON, &place, depth);
                    let mut exact = [0.0; 6];
                    for (a, of_a) in &parts {
                        for (b, of_b) in &parts {
                            let by = Vector2::new(a * hat.widths.x, b * hat.widths.y);
                            let stress = below_unit_force(place.coords - by, depth, POISSON);
                            exact.iter_mut().zip(stress).for_each(|(e, s)| *e += of_a * of_b * hat.force * s);
                        }
                    }
                    largest = largest.max(von_mises(exact));
                    let apart = von_mises(std::array::from_fn(|i| found[i] - exact[i]));
                    assert!(apart < DISCRETISATION * largest, "{depth} {place}: {apart} of {largest}");
                }
            }
        }
    }
}
