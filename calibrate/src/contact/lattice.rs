//! A fine grid on the base surface, and the gaps of its points.

use super::pairing::profile_intervals;
use super::point::ContactPoint;
use super::surface::Surface;
use crate::mesh::SurfaceGrid;
use nalgebra::{Point2, Vector2};
use railspring_profiles::quadrature::gauss_2_on;

/// A uniform grid on the base surface: lines at multiples of the cell from the beginning of the profile and from x = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice {
    /// Spacing along the profile and along the track, m.
    pub cell: Vector2<f64>,
    /// Number of the line x = 0.
    pub middle: usize,
}

impl Lattice {
    /// ROUNDOFF: how near a place on a line is to it, in lines.
    pub const ON_LINE: f64 = 1e-6;

    /// A grid as long as the contact window of a mesh.
    pub fn over(grid: &SurfaceGrid, cell: Vector2<f64>) -> Self {
        let x = &grid.along_track;
        Self::new(cell, x[0].abs().max(x[x.len() - 1].abs()))
    }

    /// A grid that reaches as far as `half_length` (m) on both sides of x = 0.
    pub fn new(cell: Vector2<f64>, half_length: f64) -> Self {
        // a line more on either side for the means of the last
        Self { cell, middle: (half_length / cell.y).ceil() as usize + 2 }
    }

    /// Arc length and x of a node, m.
    pub fn position(&self, (i, k): (usize, usize)) -> Point2<f64> {
        Point2::new(i as f64 * self.cell.x, (k as f64 - self.middle as f64) * self.cell.y)
    }

    /// Place in lines of a coordinate along the profile (`axis` 0) or along the track (1), m.
    pub fn coordinate(&self, axis: usize, at: f64) -> f64 {
        at / self.cell[axis] + if axis == 0 { 0.0 } else { self.middle as f64 }
    }

    /// The lines of nodes within `from..to`, m, along the profile (`axis` 0) or along the track (1).
    pub fn lines_within(&self, axis: usize, from: f64, to: f64) -> std::ops::Range<usize> {
        let line = |at: f64| self.coordinate(axis, at).ceil().max(0.0) as usize;
        line(from)..line(to)
    }

    /// The lines across the track from one place to another along it, m, with both ends but for rounding: those before the middle are those behind it.
    pub fn columns_within(&self, from: f64, to: f64) -> std::ops::Range<usize> {
        let [first, last] = [from, to].map(|at| self.coordinate(1, at));
        let end = (last + Self::ON_LINE).floor() + 1.0;
        (first - Self::ON_LINE).ceil().max(0.0) as usize..end.max(0.0) as usize
    }

    /// The points at `nodes` (in ascending order) between two smooth surfaces; their gaps are means over the hats. Nodes that
    /// the opposing surface does not face are left out. Across the profile the mean is by Gauss points between jumps of
    /// curvature; along the track, where both surfaces are smooth, by `(1, 10, 1)/12` of the values on the lines, which is exact
    /// for cubic gaps.
    pub fn points(&self, base: &Surface, opposing: &Surface, nodes: &[(usize, usize)]) -> Vec<ContactPoint> {
        let area = self.cell.x * self.cell.y;
        let mut points: Vec<ContactPoint> = nodes
            .iter()
            .map(|&index| ContactPoint {
                index,
                position: self.position(index),
                opposing_position: Point2::origin(),
                widths: self.cell,
                gap: 0.0,
                area,
                normal: Vector2::zeros(),
                at_edge: false,
                base: Vec::new(),
                opposing: Vec::new(),
            })
            .collect();
        let mut faced = vec![true; points.len()];
        let line = |i: usize| {
            let start = points.partition_point(|point| point.index.0 < i);
            start..points.partition_point(|point| point.index.0 <= i)
        };
        let (first, last) = match (nodes.first(), nodes.last()) {
            (Some(first), Some(last)) => (first.0, last.0),
            _ => return points,
        };
        let lines: Vec<_> = (first..=last).map(line).collect();
        let none = 0..0;
        let line = |i: usize| lines.get(i.wrapping_sub(first)).unwrap_or(&none).clone();
        // where the last end of a cell faces the opposing surface, with its number
        let mut faced_before: Option<(usize, f64)> = None;
        // the cell e lies between the lines e - 1 and e
        for e in first..=last + 1 {
            let below = if e == 0 { 0..0 } else { line(e - 1) };
            let above = line(e);
            if below.is_empty() && above.is_empty() {
                continue;
            }
            let ends = ((e as f64 - 1.0) * self.cell.x, e as f64 * self.cell.x);
            if ends.0 < 0.0 || ends.1 > base.curve.length() {
                below.chain(above).for_each(|j| faced[j] = false);
                continue;
            }
            let columns = || below.clone().chain(above.clone()).map(|j| points[j].index.1);
            let columns = columns().min().unwrap_or(0).saturating_sub(1)..=columns().max().unwrap_or(0) + 1;
            let facing = match faced_before {
                Some((before, at)) if before + 1 == e => at,
                _ => opposing.nearest(&base.world(ends.0)),
            };
            let facing = (facing, opposing.nearest_from(&base.world(ends.1), facing));
            faced_before = Some((e, facing.1));
            for part in profile_intervals(base, opposing, ends.0, ends.1, facing) {
                let (arcs, half) = gauss_2_on(part.0, part.1);
                for s in arcs {
                    let along = self.gaps_along(base, opposing, s, columns.clone(), facing.0);
                    let normal = base.normal(s);
                    let u = (s - ends.0) / self.cell.x;
                    for (line, weight) in [(below.clone(), 1.0 - u), (above.clone(), u)] {
                        let weight = weight * half / self.cell.x;
                        for j in line {
                            let k = points[j].index.1 - columns.start();
                            let around = (along[k - 1], along[k], along[k + 1]);
                            let (Some(a), Some(b), Some(c)) = around else {
                                faced[j] = false;
                                continue;
                            };
                            let point = &mut points[j];
                            point.gap += weight * (a.y + 10.0 * b.y + c.y) / 12.0;
                            point.normal += normal * weight;
                            point.opposing_position += opposing.curve.point(b.x).coords * weight;
                        }
                    }
                }
            }
        }
        let mut faced = faced.into_iter();
        points.retain(|_| faced.next().unwrap_or(false));
        points.iter_mut().for_each(|point| point.normal = point.normal.normalize());
        points
    }

    /// Where the nodes of `columns` on the line at the arc length `s` see the opposing surface: arc length on it and gap, m.
    fn gaps_along(
        &self,
        base: &Surface,
        opposing: &Surface,
        s: f64,
        columns: std::ops::RangeInclusive<usize>,
        facing: f64,
    ) -> Vec<Option<Vector2<f64>>> {
        let (point, normal) = (base.world(s), base.normal(s));
        let from_middle = |k: usize| k.abs_diff(self.middle);
        let nearest = if columns.contains(&self.middle) {
            0
        } else {
            from_middle(*columns.start()).min(from_middle(*columns.end()))
        };
        let farthest = from_middle(*columns.start()).max(from_middle(*columns.end()));
        // places and gaps of the last three that were found, from which the next one is near on a parabola
        let mut near: [Option<Vector2<f64>>; 3] = [None; 3];
        let outwards: Vec<Option<Vector2<f64>>> = (nearest..=farthest)
            .map(|lines| {
                let start = match near {
                    [Some(a), Some(b), Some(c)] => a + 3.0 * (c - b),
                    [_, _, last] => last.unwrap_or(Vector2::new(facing, 0.0)),
                };
                let x = lines as f64 * self.cell.y;
                let found = opposing.project_from(&point, x, &normal, (start.x, start.y))?;
                let found = Vector2::new(found.along_profile, found.gap);
                near = [near[1], near[2], Some(found)];
                Some(found)
            })
            .collect();
        // both surfaces are the same before and behind x = 0
        columns.map(|k| outwards[from_middle(k) - nearest]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{PairingLimits, pair};
    use crate::mesh::SurfaceGrid;
    use railspring_profiles::profile::ProfileCurve;

    /// Source: `pair` with a surface grid of the same lines, which integrates over whole cells. Goal: gaps, m, normals and
    /// opposing positions of the points of a crowned wheel on a crowned rail, its crown with a jump in curvature beside the middle.
    /// Accuracy: DISCRETISATION, the rest of the means along the track, h⁴/80 times the fourth derivative 3/R³ of
    /// the gap, is below 1e-15 m, the two-point rule over parabolas with arc lengths 1e-12 m; 1e-10 of a unit normal.
    #[test]
    fn points_are_those_of_the_pairing() {
        const DISCRETISATION: f64 = 2e-12;
        let crown = |sign: f64, radii: [f64; 2]| {
            let point = |y: f64| Point2::new(y, sign * y * y / (2.0 * radii[usize::from(y > 0.0)]));
            let points: Vec<_> = (-48..=48).map(|i| point(f64::from(i) * 2.5e-4)).collect();
            ProfileCurve::from_points(&points, &[48]).unwrap()
        };
        let (rail, wheel) = (crown(1.0, [0.3, 0.08]), crown(-1.0, [0.5, 0.4]));
        let cell = Vector2::new(0.65e-3, 0.5e-3);
        let lattice = Lattice::new(cell, 5e-3);
        let (rows, columns) = (34, 2 * lattice.middle + 1);
        let lines = SurfaceGrid {
            along_profile: (0..rows).map(|i| lattice.position((i, 0)).x).collect(),
            along_track: (0..columns).map(|k| lattice.position((0, k)).y).collect(),
            nodes: (0..rows * columns).collect(),
        };
        let ends = SurfaceGrid {
            along_profile: vec![0.0, wheel.length()],
            along_track: vec![-0.05, 0.05],
            nodes: (0..4).collect(),
        };
        let base = Surface::extruded(&rail, &lines);
        let opposing = Surface::revolved(&wheel, &ends, 0.46, Vector2::new(0.4e-3, 0.0));
        let exact = pair(&base, &opposing, PairingLimits { largest_gap: 30e-6 });
        let inner: Vec<&ContactPoint> = exact.iter().filter(|point| !point.at_edge).collect();
        assert!(inner.len() > 50, "{}", inner.len());
        let nodes: Vec<(usize, usize)> = inner.iter().map(|point| point.index).collect();
        let found = lattice.points(&base, &opposing, &nodes);
        assert_eq!(found.len(), nodes.len());
        for (a, b) in found.iter().zip(inner) {
            assert!((a.gap - b.gap).abs() < DISCRETISATION, "{:?}: {:e} {:e}", a.index, a.gap, b.gap);
            assert!((a.normal - b.normal).norm() < 1e-10, "{:?}", a.index);
            assert!((a.area / b.area - 1.0).abs() < 1e-9 && (a.position - b.position).norm() < 1e-12);
            assert!((a.opposing_position - b.opposing_position).norm() < 1e-6, "{:?}", a.index);
        }
    }
}
