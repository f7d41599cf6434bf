//! Groups of shapes, each around the shape that is nearest to all others of it: k-medoids.
//!
//! Few shapes are grouped as they are (Kaufman and Rousseeuw 1990, PAM, with the swaps of Schubert and Rousseeuw 2019). Of many, samples are grouped, and the
//! medoids are kept to which all shapes are nearest (CLARA). Starts, samples and ties are always the same.

use std::ops::RangeInclusive;

use super::robust::sorted;
use super::shape::Shape;
use crate::verify::quantile;

/// Shapes of a sample.
const SAMPLE: usize = 600;
/// Samples of many shapes.
const SAMPLES: usize = 4;
/// Seed of the samples.
const SEED: u64 = 20_240_229;
/// Neighbour whose distance says how much a shape stands alone.
const NEIGHBOUR: usize = 5;
/// Distance over that of 95 % of the shapes beyond which a shape stands alone: a wide group of one in twenty sets the measure for itself.
const ALONE: f64 = 3.0;

/// Groups of shapes.
#[derive(Debug, Clone, PartialEq)]
pub struct Groups {
    /// The shape in the middle of each group, by its number; the largest group first.
    pub medoids: Vec<usize>,
    /// The group of each shape; none of one that is far from all others.
    pub group: Vec<Option<usize>>,
    /// Mean silhouette of the grouped shapes, -1 to 1 (Rousseeuw 1987).
    pub silhouette: f64,
    /// Mean silhouette for each number of groups that was tried.
    pub tried: Vec<(usize, f64)>,
}

impl Groups {
    /// Groups shapes on the same coordinates; how many groups, the mean silhouette says. None of fewer than ten shapes.
    pub fn of(shapes: &[&Shape], counts: RangeInclusive<usize>) -> Option<Self> {
        /// Shapes that are worth groups.
        const LEAST: usize = 10;
        if shapes.len() < LEAST {
            return None;
        }
        let samples: Vec<Sample> = samples(shapes.len()).map(|members| Sample::of(shapes, members)).collect();
        let mut tried = Vec::new();
        let mut best: Option<(f64, Vec<usize>)> = None;
        for count in counts {
            let found = samples.iter().filter(|sample| sample.members.len() > 2 * count).map(|sample| {
                let medoids = sample.medoids(count);
                let silhouette = sample.silhouette(&medoids);
                let medoids: Vec<usize> = medoids.into_iter().map(|at| sample.members[at]).collect();
                (cost(shapes, &medoids), silhouette, medoids)
            });
            let Some((_, silhouette, medoids)) = found.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
            tried.push((count, silhouette));
            if best.as_ref().is_none_or(|(other, _)| silhouette > *other) {
                best = Some((silhouette, medoids));
            }
        }
        let (silhouette, medoids) = best?;
        Some(Self::around(shapes, medoids, silhouette, tried))
    }

    /// Gives every shape to its nearest medoid.
    fn around(shapes: &[&Shape], medoids: Vec<usize>, silhouette: f64, tried: Vec<(usize, f64)>) -> Self {
        let near: Vec<(usize, f64)> = shapes.iter().map(|shape| nearest(shapes, &medoids, shape)).collect();
        let limits: Vec<f64> = (0..medoids.len())
            .map(|medoid| limit(near.iter().filter(|(of, _)| *of == medoid).map(|(_, distance)| *distance)))
            .collect();
        let mut group: Vec<Option<usize>> =
            near.into_iter().map(|(group, distance)| (distance <= limits[group]).then_some(group)).collect();
        let size = |wanted: usize| group.iter().filter(|group| **group == Some(wanted)).count();
        let sizes: Vec<usize> = (0..medoids.len()).map(size).collect();
        let mut order: Vec<usize> = (0..medoids.len()).collect();
        order.sort_by_key(|at| (std::cmp::Reverse(sizes[*at]), medoids[*at]));
        for group in group.iter_mut().flatten() {
            *group = order.iter().position(|at| at == group).unwrap_or_default();
        }
        Self { medoids: order.iter().map(|at| medoids[*at]).collect(), group, silhouette, tried }
    }

    /// Shapes of a group.
    pub fn size(&self, group: usize) -> usize {
        self.group.iter().filter(|of| **of == Some(group)).count()
    }
}

/// The distance beyond which a shape stands alone among others with these distances; none where most are equal.
fn limit(distances: impl Iterator<Item = f64>) -> f64 {
    let most = quantile(&sorted(distances), 0.95).filter(|most| *most > 0.0);
    most.map_or(f64::INFINITY, |most| ALONE * most)
}

/// The nearest medoid and its distance, µm.
fn nearest(shapes: &[&Shape], medoids: &[usize], shape: &Shape) -> (usize, f64) {
    let distances = medoids.iter().map(|medoid| shapes[*medoid].distance(shape));
    distances.enumerate().fold(
        (0, f64::INFINITY),
        |best, (at, distance)| {
            if distance < best.1 { (at, distance) } else { best }
        },
    )
}

/// Sum of the distances to the nearest medoid.
fn cost(shapes: &[&Shape], medoids: &[usize]) -> f64 {
    shapes.iter().map(|shape| nearest(shapes, medoids, shape).1).sum()
}

/// Members of the samples, ascending: all shapes once where they are few.
fn samples(count: usize) -> impl Iterator<Item = Vec<usize>> {
    let mut state = SEED;
    let mut random = move || {
        // splitmix64
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    };
    let few = count <= SAMPLE;
    (0..if few { 1 } else { SAMPLES }).map(move |_| {
        if few {
            return (0..count).collect();
        }
        let mut all: Vec<usize> = (0..count).collect();
        for at in 0..SAMPLE {
            let other = at + (random() % (count - at) as u64) as usize;
            all.swap(at, other);
        }
        all.truncate(SAMPLE);
        all.sort_unstable();
        all
    })
}

/// Shapes with all their distances.
struct Sample {
    /// Their numbers among all.
    members: Vec<usize>,
    /// Distances of the members, row by row, µm.
    distance: Vec<f64>,
}

impl Sample {
    /// Without those that stand alone: each would be a group by itself.
    fn of(shapes: &[&Shape], members: Vec<usize>) -> Self {
        let whole = Self::all(shapes, members);
        let far: Vec<f64> = (0..whole.members.len())
            .map(|at| {
                let mut row = whole.row(at).to_vec();
                row.sort_by(f64::total_cmp);
                row[NEIGHBOUR.min(row.len() - 1)]
            })
            .collect();
        let limit = limit(far.iter().copied());
        let members =
            whole.members.iter().zip(far).filter(|(_, far)| *far <= limit).map(|(member, _)| *member);
        Self::all(shapes, members.collect())
    }

    fn all(shapes: &[&Shape], members: Vec<usize>) -> Self {
        let count = members.len();
        let mut distance = vec![0.0; count * count];
        for a in 0..count {
            for b in a + 1..count {
                let between = shapes[members[a]].distance(shapes[members[b]]);
                distance[a * count + b] = between;
                distance[b * count + a] = between;
            }
        }
        Self { members, distance }
    }

    /// Distances of a member to all.
    fn row(&self, at: usize) -> &[f64] {
        let count = self.members.len();
        &self.distance[at * count..(at + 1) * count]
    }

    /// Medoids by the best swaps from a start of shapes that are far from each other; fewer where there are not so many different shapes.
    fn medoids(&self, count: usize) -> Vec<usize> {
        /// Swaps at most; some tens are usual.
        const SWAPS: usize = 300;
        let mut medoids = self.start(count);
        for _ in 0..SWAPS {
            let Some((medoid, other)) = self.best_swap(&medoids) else { break };
            medoids[medoid] = other;
        }
        medoids
    }

    /// The middle of all, and in turn what is farthest from those before.
    fn start(&self, count: usize) -> Vec<usize> {
        let all = 0..self.members.len();
        let total = |at: &usize| self.row(*at).iter().sum::<f64>();
        let middle = all.clone().min_by(|a, b| total(a).total_cmp(&total(b))).unwrap_or_default();
        let mut medoids = vec![middle];
        while medoids.len() < count {
            let near = |at: &usize| medoids.iter().map(|m| self.row(*at)[*m]).fold(f64::INFINITY, f64::min);
            let farthest = all.clone().rev().max_by(|a, b| near(a).total_cmp(&near(b)));
            // no others than these are left
            let Some(farthest) = farthest.filter(|at| near(at) > 0.0) else { break };
            medoids.push(farthest);
        }
        medoids
    }

    /// The swap of a medoid with another member that makes the sum of distances least, if one makes it less.
    fn best_swap(&self, medoids: &[usize]) -> Option<(usize, usize)> {
        let count = self.members.len();
        // of each member its nearest medoid, and the distances to that and to the second
        let near: Vec<(usize, f64, f64)> = (0..count)
            .map(|at| {
                medoids.iter().enumerate().fold(
                    (0, f64::INFINITY, f64::INFINITY),
                    |near, (number, medoid)| match self.row(at)[*medoid] {
                        distance if distance < near.1 => (number, distance, near.1),
                        distance => (near.0, near.1, near.2.min(distance)),
                    },
                )
            })
            .collect();
        let mut without = vec![0.0; medoids.len()];
        near.iter().for_each(|(medoid, first, second)| without[*medoid] += second - first);
        // what rounding makes of no change
        let least = 1e-12 * near.iter().map(|near| near.1).sum::<f64>();
        let mut best = (-least, None);
        for other in (0..count).filter(|other| !medoids.contains(other)) {
            let (mut shared, mut change) = (0.0, without.clone());
            for (distance, (medoid, first, second)) in self.row(other).iter().zip(&near) {
                if distance < first {
                    shared += distance - first;
                    change[*medoid] += first - second;
                } else if distance < second {
                    change[*medoid] += distance - second;
                }
            }
            for (medoid, change) in change.into_iter().enumerate() {
                if shared + change < best.0 {
                    best = (shared + change, Some((medoid, other)));
                }
            }
        }
        best.1
    }

    /// Mean over the members of (b - a)/max(a, b): a the mean distance to the own group, b that to the next.
    fn silhouette(&self, medoids: &[usize]) -> f64 {
        let count = self.members.len();
        let group: Vec<usize> = (0..count)
            .map(|at| {
                let row = self.row(at);
                (0..medoids.len())
                    .min_by(|a, b| row[medoids[*a]].total_cmp(&row[medoids[*b]]))
                    .unwrap_or_default()
            })
            .collect();
        let mut sizes = vec![0.0; medoids.len()];
        group.iter().for_each(|group| sizes[*group] += 1.0);
        let of = |at: usize| {
            let mut sums = vec![0.0; medoids.len()];
            self.row(at).iter().zip(&group).for_each(|(distance, group)| sums[*group] += distance);
            let own = group[at];
            if sizes[own] < 2.0 {
                return 0.0;
            }
            let a = sums[own] / (sizes[own] - 1.0);
            let others = (0..medoids.len()).filter(|other| *other != own && sizes[*other] > 0.0);
            let b = others.map(|other| sums[other] / sizes[other]).fold(f64::INFINITY, f64::min);
            if b.is_finite() && a.max(b) > 0.0 { (b - a) / a.max(b) } else { 0.0 }
        };
        (0..count).map(of).sum::<f64>() / count.max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shapes of one coordinate pair at these levels.
    fn levels(levels: &[f64]) -> Vec<Shape> {
        levels.iter().map(|level| Shape { y_mm: vec![0.0, 1.0], off_um: vec![*level, *level] }).collect()
    }

    /// Source: by hand. Two groups, 0 to 4 and 100 to 105, around 2 and 102 or 103. Goal: they are found with their medoids, the larger first; the silhouette is near 1.
    #[test]
    fn two_groups_on_a_line() {
        let shapes = levels(&[0.0, 100.0, 1.0, 101.0, 2.0, 102.0, 3.0, 103.0, 4.0, 104.0, 105.0]);
        let shapes: Vec<&Shape> = shapes.iter().collect();
        let groups = Groups::of(&shapes, 2..=4).unwrap();
        assert_eq!(groups.medoids.len(), 2, "{groups:?}");
        assert!([5, 7].contains(&groups.medoids[0]) && groups.medoids[1] == 4, "{groups:?}");
        assert_eq!([groups.size(0), groups.size(1)], [6, 5]);
        assert!(groups.silhouette > 0.95 && groups.tried.len() == 3, "{groups:?}");
        assert_eq!(Groups::of(&shapes[..9], 2..=4), None);
    }

    /// Source: by hand, exhaustively: every pair of medoids of 12 members. Goal: no pair is better than the one found. Exact.
    #[test]
    fn swaps_end_at_the_best_pair() {
        let shapes = levels(&[0.0, 1.0, 5.0, 6.0, 7.0, 13.0, 20.0, 21.0, 22.0, 24.0, 30.0, 31.0]);
        let shapes: Vec<&Shape> = shapes.iter().collect();
        let sample = Sample::all(&shapes, (0..12).collect());
        let found = cost(&shapes, &sample.medoids(2));
        let pairs = (0..12).flat_map(|a| (0..a).map(move |b| [a, b]));
        let best = pairs.map(|pair| cost(&shapes, &pair)).fold(f64::INFINITY, f64::min);
        assert_eq!(found, best);
    }

    /// Source: by hand: of 0, 1, 10 and 11 each has a = 1; b is 10.5 outside and 9.5 inside. Accuracy: ROUNDOFF.
    #[test]
    fn a_silhouette_by_hand() {
        const ROUNDOFF: f64 = 1e-14;
        let shapes = levels(&[0.0, 1.0, 10.0, 11.0]);
        let shapes: Vec<&Shape> = shapes.iter().collect();
        let silhouette = Sample::all(&shapes, (0..4).collect()).silhouette(&[0, 2]);
        let expected = 0.5 * (9.5 / 10.5 + 8.5 / 9.5);
        assert!((silhouette - expected).abs() < ROUNDOFF, "{silhouette} {expected}");
    }

    /// Goal: equal shapes are one group; of two different ones there are two.
    #[test]
    fn equal_shapes_are_one_group() {
        let equal = levels(&[3.0; 30]);
        let groups = Groups::of(&equal.iter().collect::<Vec<&Shape>>(), 2..=8).unwrap();
        assert_eq!((groups.medoids.len(), groups.size(0)), (1, 30));
        let two = levels(&[[3.0; 20], [4.0; 20]].concat());
        let groups = Groups::of(&two.iter().collect::<Vec<&Shape>>(), 2..=8).unwrap();
        assert_eq!((groups.medoids.len(), groups.size(1)), (2, 20));
    }

    /// Goal: a wide group of one shape in ten stays a group beside a narrow one.
    #[test]
    fn a_wide_group_is_a_group() {
        let level = |n: usize| {
            let part = (n as f64 * 0.618_034).fract();
            if n.is_multiple_of(10) { 200.0 + 100.0 * part } else { part }
        };
        let shapes = levels(&(0..400).map(level).collect::<Vec<f64>>());
        let groups = Groups::of(&shapes.iter().collect::<Vec<&Shape>>(), 2..=8).unwrap();
        assert_eq!(groups.medoids.len(), 2, "{:?}", groups.tried);
        assert_eq!([groups.size(0), groups.size(1)], [360, 40]);
    }

    /// Goal: a shape that stands alone is no group and belongs to none; samples of many shapes find the same groups.
    #[test]
    fn what_stands_alone_is_no_group() {
        let level = |n: usize| 50.0 * (n % 3) as f64 + (n as f64 * 0.618_034).fract();
        let mut wild: Vec<f64> = (0..3000).map(level).collect();
        wild[1000] = 5000.0;
        let shapes = levels(&wild);
        let shapes: Vec<&Shape> = shapes.iter().collect();
        for count in [500, 3000] {
            let groups = Groups::of(&shapes[3000 - count..], 2..=8).unwrap();
            assert_eq!(groups.medoids.len(), 3, "{:?}", groups.tried);
            assert_eq!(
                groups.group.iter().filter(|group| group.is_none()).count(),
                usize::from(count == 3000)
            );
        }
    }
}
