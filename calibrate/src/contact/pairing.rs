//! Contact points: gaps and consistent nodal weights by integration over the
//! intersections of the cells of both surfaces.

use super::surface::{Projection, Surface, corners};
use nalgebra::{Point2, Vector2, Vector3};

/// Which points are worth an unknown.
#[derive(Debug, Clone, Copy)]
pub struct PairingLimits {
    /// Points whose rigid gap exceeds this are left out, m.
    pub largest_gap: f64,
}

/// Weight of one grid node in the mean over a contact point's patch.
#[derive(Debug, Clone, Copy)]
pub struct NodeWeight {
    /// Index in the body's contact grid.
    pub node: usize,
    /// Weight times the unit normal (y, z).
    pub normal: Vector2<f64>,
    /// Weight.
    pub scalar: f64,
}

/// The candidate contact points, one for each node of the base surface that is near the other one.
#[derive(Debug, Clone, Default)]
pub struct ContactPoints {
    /// Grid indices on the base surface: along the profile, along the track.
    pub index: Vec<(usize, usize)>,
    /// Arc length along the base profile and x, m.
    pub position: Vec<Point2<f64>>,
    /// Mean position on the opposing curve (its own frame y, z), m.
    pub opposing_position: Vec<Point2<f64>>,
    /// Widths of the point's share of the surface along the profile and x, m.
    pub widths: Vec<Vector2<f64>>,
    /// Mean gap of the undeformed surfaces, m.
    pub gap: Vec<f64>,
    /// Area that carries a unit nodal pressure, m².
    pub area: Vec<f64>,
    /// Mean normal of the base surface, out of the base, world (y, z).
    pub normal: Vec<Vector2<f64>>,
    /// Whether the patch is cut by the edge of either grid.
    pub at_edge: Vec<bool>,
    /// Weights of the base nodes.
    pub base: Vec<Vec<NodeWeight>>,
    /// Weights of the opposing nodes.
    pub opposing: Vec<Vec<NodeWeight>>,
}

impl ContactPoints {
    /// Number of points.
    pub fn len(&self) -> usize {
        self.index.len()
    }

    /// Whether there is no candidate.
    pub fn is_empty(&self) -> bool {
        self.index.is_empty()
    }

    /// Points of a flat rectangular grid with spacing `h` and the given gap function of (s, x):
    /// for analytic compliances that know no mesh.
    pub fn flat_grid(count: (usize, usize), h: f64, gap: impl Fn(f64, f64) -> f64) -> Self {
        let mut points = Self::default();
        for i in 0..count.0 {
            for k in 0..count.1 {
                let centre = |n: usize, of: usize| (n as f64 - 0.5 * (of as f64 - 1.0)) * h;
                let (s, x) = (centre(i, count.0), centre(k, count.1));
                points.index.push((i, k));
                points.position.push(Point2::new(s, x));
                points.opposing_position.push(Point2::new(s, 0.0));
                points.widths.push(Vector2::new(h, h));
                points.gap.push(gap(s, x));
                points.area.push(h * h);
                points.normal.push(Vector2::new(0.0, -1.0));
                points.at_edge.push(i == 0 || k == 0 || i + 1 == count.0 || k + 1 == count.1);
                points.base.push(Vec::new());
                points.opposing.push(Vec::new());
            }
        }
        points
    }

    /// Keeps the points whose flag is set.
    pub fn retain(&mut self, keep: &[bool]) {
        fn filter<T>(list: &mut Vec<T>, keep: &[bool]) {
            let mut flags = keep.iter();
            list.retain(|_| *flags.next().expect("one flag a point"));
        }
        filter(&mut self.index, keep);
        filter(&mut self.position, keep);
        filter(&mut self.opposing_position, keep);
        filter(&mut self.widths, keep);
        filter(&mut self.gap, keep);
        filter(&mut self.area, keep);
        filter(&mut self.normal, keep);
        filter(&mut self.at_edge, keep);
        filter(&mut self.base, keep);
        filter(&mut self.opposing, keep);
    }

    /// Rows of displacement weights of point `j` in direction 0 (normal), 1 (lateral tangent),
    /// 2 (along the track): `(3·node + axis, weight)`.
    pub fn row(weights: &[NodeWeight], direction: usize) -> impl Iterator<Item = (usize, f64)> {
        weights.iter().flat_map(move |w| {
            let vector = match direction {
                0 => Vector3::new(0.0, w.normal.x, w.normal.y),
                1 => Vector3::new(0.0, -w.normal.y, w.normal.x),
                _ => Vector3::new(w.scalar, 0.0, 0.0),
            };
            (0..3).map(move |axis| (3 * w.node + axis, vector[axis]))
        })
    }

    /// World direction of point `j`: 0 normal (out of the base), 1 lateral tangent, 2 along the track.
    pub fn direction(&self, j: usize, direction: usize) -> Vector3<f64> {
        let n = self.normal[j];
        match direction {
            0 => Vector3::new(0.0, n.x, n.y),
            1 => Vector3::new(0.0, -n.y, n.x),
            _ => Vector3::new(1.0, 0.0, 0.0),
        }
    }

    /// Forces on the grid nodes of one body (`3·node + axis`) from contact forces by direction and point.
    pub fn nodal_forces(&self, side: super::Side, forces: &[f64], nodes: usize) -> Vec<f64> {
        let (weights, sign) = match side {
            super::Side::Base => (&self.base, -1.0),
            super::Side::Opposing => (&self.opposing, 1.0),
        };
        let mut nodal = vec![0.0; nodes];
        for (f, force) in forces.iter().enumerate().filter(|(_, v)| **v != 0.0) {
            for (dof, w) in Self::row(&weights[f % self.len()], f / self.len()) {
                nodal[dof] += sign * w * force;
            }
        }
        nodal
    }

    /// Resultant of contact forces by direction and point: force on the opposing body in world axes.
    pub fn resultant(&self, forces: &[f64]) -> Vector3<f64> {
        forces
            .iter()
            .enumerate()
            .map(|(f, force)| self.direction(f % self.len(), f / self.len()) * *force)
            .sum()
    }
}

/// Two-point Gauss rule on an interval: points and weight.
fn gauss(a: f64, b: f64) -> ([f64; 2], f64) {
    let (mid, half) = (0.5 * (a + b), 0.5 * (b - a));
    let off = half / 3.0_f64.sqrt();
    ([mid - off, mid + off], half)
}

/// Sorted breakpoints within [a, b], ends included, without slivers.
fn breakpoints(a: f64, b: f64, inner: impl Iterator<Item = f64>) -> Vec<f64> {
    let sliver = 1e-9 * (b - a);
    let mut cuts: Vec<f64> = inner.filter(|c| *c > a + sliver && *c < b - sliver).collect();
    cuts.push(a);
    cuts.push(b);
    cuts.sort_by(f64::total_cmp);
    cuts.dedup_by(|x, y| (*x - *y).abs() <= sliver);
    cuts
}

/// Cell of a grid axis that holds `t`, with the local coordinate in 0..1; `None` outside.
fn locate(axis: &[f64], t: f64) -> Option<(usize, f64)> {
    let last = axis.len() - 1;
    let slack = 1e-9 * (axis[last] - axis[0]);
    if t < axis[0] - slack || t > axis[last] + slack {
        return None;
    }
    let cell = axis.partition_point(|&a| a <= t).clamp(1, last) - 1;
    Some((cell, ((t - axis[cell]) / (axis[cell + 1] - axis[cell])).clamp(0.0, 1.0)))
}

fn add_weight(list: &mut Vec<NodeWeight>, node: usize, weight: f64, normal: &Vector2<f64>) {
    match list.iter_mut().find(|w| w.node == node) {
        Some(w) => {
            w.normal += normal * weight;
            w.scalar += weight;
        }
        None => list.push(NodeWeight { node, normal: normal * weight, scalar: weight }),
    }
}

/// Pairs the base surface (rail) with the opposing one (wheel) at their present positions.
pub fn pair(base: &Surface, opposing: &Surface, limits: PairingLimits) -> ContactPoints {
    let (s, x) = (&base.grid.along_profile, &base.grid.along_track);
    let (rows, columns) = (s.len(), x.len());
    // arc lengths on the opposing curve facing each base line, followed from line to line
    let seeds: Vec<f64> = s.iter().map(|&si| opposing.nearest(&base.world(si))).collect();
    let project = |si: f64, xk: f64, guess: f64| -> Option<Projection> {
        opposing.project(&base.world(si), xk, &base.curve.upward_normal(si), guess)
    };
    let mut slot = vec![usize::MAX; rows * columns];
    let mut points = ContactPoints::default();
    let track_width = |k: usize| 0.5 * (x[(k + 1).min(columns - 1)] - x[k.saturating_sub(1)]);
    for i in 0..rows {
        for k in 0..columns {
            let near = project(s[i], x[k], seeds[i]).is_some_and(|p| p.gap < limits.largest_gap);
            if near {
                slot[i * columns + k] = points.len();
                points.index.push((i, k));
                points.position.push(Point2::new(s[i], x[k]));
                points.widths.push(Vector2::new(
                    0.5 * (s[(i + 1).min(rows - 1)] - s[i.saturating_sub(1)]),
                    track_width(k),
                ));
                points.at_edge.push(i == 0 || k == 0 || i + 1 == rows || k + 1 == columns);
            }
        }
    }
    let count = points.len();
    points.gap = vec![0.0; count];
    points.area = vec![0.0; count];
    points.normal = vec![Vector2::zeros(); count];
    points.opposing_position = vec![Point2::origin(); count];
    points.base = vec![Vec::with_capacity(9); count];
    points.opposing = vec![Vec::with_capacity(25); count];

    for i in 0..rows - 1 {
        let wanted = |k: usize| {
            [(i, k), (i, k + 1), (i + 1, k), (i + 1, k + 1)]
                .iter()
                .any(|&(a, b)| slot[a * columns + b] != usize::MAX)
        };
        if !(0..columns - 1).any(wanted) {
            continue;
        }
        for (s0, s1) in profile_intervals(base, opposing, s[i], s[i + 1], (seeds[i], seeds[i + 1])) {
            let (profile_points, half_s) = gauss(s0, s1);
            let middle = project(0.5 * (s0 + s1), 0.0, 0.5 * (seeds[i] + seeds[i + 1]));
            for k in (0..columns - 1).filter(|&k| wanted(k)) {
                let Some(middle) = middle else {
                    mark_edge(&mut points, &slot, columns, i, k);
                    continue;
                };
                let lines = opposing.grid.along_track.iter().map(|&t| opposing.x(middle.along_profile, t));
                let cuts = breakpoints(x[k], x[k + 1], lines);
                for (x0, x1) in cuts.windows(2).map(|w| (w[0], w[1])) {
                    let (track_points, half_x) = gauss(x0, x1);
                    for sq in profile_points {
                        let normal = base.curve.upward_normal(sq);
                        for xq in track_points {
                            let hit = project(sq, xq, middle.along_profile).and_then(|p| {
                                let a = locate(&opposing.grid.along_profile, p.along_profile)?;
                                let b = locate(&opposing.grid.along_track, p.along_track)?;
                                Some((p, a, b))
                            });
                            let Some((p, (a, ua), (b, vb))) = hit else {
                                mark_edge(&mut points, &slot, columns, i, k);
                                continue;
                            };
                            let u = (sq - s[i]) / (s[i + 1] - s[i]);
                            let v = (xq - x[k]) / (x[k + 1] - x[k]);
                            let gap =
                                p.gap + base.recession((i, k), (u, v)) + opposing.recession((a, b), (ua, vb));
                            let on_opposing = opposing.curve.point(p.along_profile);
                            for (di, dk, phi) in corners(u, v) {
                                let j = slot[(i + di) * columns + k + dk];
                                if j == usize::MAX {
                                    continue;
                                }
                                let w = phi * half_s * half_x;
                                points.area[j] += w;
                                points.gap[j] += w * gap;
                                points.normal[j] += normal * w;
                                points.opposing_position[j] += on_opposing.coords * w;
                                for (ei, ek, n) in corners(u, v) {
                                    add_weight(
                                        &mut points.base[j],
                                        (i + ei) * columns + k + ek,
                                        w * n,
                                        &normal,
                                    );
                                }
                                for (ea, eb, n) in corners(ua, vb) {
                                    let node = (a + ea) * opposing.grid.along_track.len() + b + eb;
                                    add_weight(&mut points.opposing[j], node, w * n, &normal);
                                }
                            }
                        }
                    }
                }
            }
        }
    }
    normalise(points)
}

fn mark_edge(points: &mut ContactPoints, slot: &[usize], columns: usize, i: usize, k: usize) {
    for (di, dk, _) in corners(0.5, 0.5) {
        if let Some(flag) = points.at_edge.get_mut(slot[(i + di) * columns + k + dk]) {
            *flag = true;
        }
    }
}

/// Divides the sums by the areas; drops points that face nothing.
fn normalise(mut points: ContactPoints) -> ContactPoints {
    let keep: Vec<bool> = points.area.iter().map(|&a| a > 0.0).collect();
    points.retain(&keep);
    for j in 0..points.len() {
        let area = points.area[j];
        points.gap[j] /= area;
        points.opposing_position[j] /= area;
        points.normal[j] = points.normal[j].normalize();
        for w in points.base[j].iter_mut().chain(points.opposing[j].iter_mut()) {
            w.normal /= area;
            w.scalar /= area;
        }
    }
    points
}

/// Parts of a base cell [s0, s1] between the lines of the opposing grid that face it, and between the jumps in curvature
/// of either profile: across one, a rule that is exact for parabolas is off by a share of the jump.
fn profile_intervals(
    base: &Surface,
    opposing: &Surface,
    s0: f64,
    s1: f64,
    seeds: (f64, f64),
) -> Vec<(f64, f64)> {
    let facing =
        |s: f64, guess: f64| opposing.project(&base.world(s), 0.0, &base.curve.upward_normal(s), guess);
    let mut cuts = base.curve.breakpoints();
    if let (Some(a), Some(b)) = (facing(s0, seeds.0), facing(s1, seeds.1)) {
        let (a, b) = (a.along_profile, b.along_profile);
        let (low, high) = (a.min(b), a.max(b));
        let lines = opposing.grid.along_profile.iter().copied().chain(opposing.curve.breakpoints());
        for line in lines.filter(|&l| l > low && l < high) {
            let root =
                crossing((s0, a - line), (s1, b - line), |s| Some(facing(s, line)?.along_profile - line));
            cuts.extend(root);
        }
    }
    breakpoints(s0, s1, cuts.into_iter()).windows(2).map(|w| (w[0], w[1])).collect()
}

/// Root of a smooth, almost linear function between two points of opposite sign, by regula falsi with halving
/// (M. Dowell, P. Jarratt, "A modified regula falsi method", BIT 11 (1971)); `None` if it cannot be evaluated.
fn crossing(mut left: (f64, f64), mut right: (f64, f64), f: impl Fn(f64) -> Option<f64>) -> Option<f64> {
    for _ in 0..60 {
        let s = (left.0 * right.1 - right.0 * left.1) / (right.1 - left.1);
        let value = f(s)?;
        if value.abs() < 1e-13 || (right.0 - left.0).abs() < 1e-14 {
            return Some(s);
        }
        if value * right.1 < 0.0 {
            left = right;
        } else {
            left.1 *= 0.5;
        }
        right = (s, value);
    }
    Some(right.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::SurfaceGrid;
    use crate::profile::ProfileCurve;

    /// Source: integrals of the hat functions times y²/2R. Goal: mean gaps of the nodes, m, where a plane runs into a
    /// parabola of 0.3 m radius in the middle of a cell, on either surface. Accuracy: along the curve instead of
    /// along y, relative (h/R)² of gaps of some micrometres; a rule across the joint is off by 0.1 µm.
    #[test]
    fn a_jump_in_curvature_is_integrated_exactly() {
        const RADIUS: f64 = 0.3;
        const H: f64 = 2e-3;
        const ALONG_CURVE: f64 = (H / RADIUS) * (H / RADIUS);
        const ROUNDOFF: f64 = 1e-13;
        // rail: crown up (-z); wheel: the same parabola down (+z)
        let profile = |sign: f64, joints: &[usize]| {
            let point = |y: f64| Point2::new(y, sign * y.max(0.0).powi(2) / (2.0 * RADIUS));
            let points: Vec<_> = (-40..=40).map(|i| point(f64::from(i) * 2.5e-4)).collect();
            ProfileCurve::from_points(&points, joints).unwrap()
        };
        let straight = profile(0.0, &[]);
        let grid = |lines: Vec<f64>| {
            let count = lines.len() * 3;
            SurfaceGrid {
                along_profile: lines,
                along_track: vec![-1e-3, 0.0, 1e-3],
                nodes: (0..count).collect(),
            }
        };
        // the joint, at an arc length of 10 mm, lies in the middle of a cell
        let lines = grid((0..=9).map(|i| 1e-3 + f64::from(i) * H).collect());
        let ends = grid(vec![0.0, straight.length()]);
        let exact = |i: usize| {
            let middle = lines.along_profile[i] - 10e-3;
            let steps = 20_000;
            let part = |k: i32| {
                let y = middle + H * (f64::from(k) + 0.5) / f64::from(steps);
                (1.0 - (y - middle).abs() / H) * y.max(0.0).powi(2) / (2.0 * RADIUS) / f64::from(steps)
            };
            (-steps..steps).map(part).sum::<f64>()
        };
        let (rail, wheel) = (profile(1.0, &[40]), profile(-1.0, &[40]));
        for (base, opposing) in [(&rail, &straight), (&straight, &wheel)] {
            let points = pair(
                &Surface::extruded(base, &lines),
                &Surface::extruded(opposing, &ends),
                PairingLimits { largest_gap: 1e-3 },
            );
            let mut seen = 0;
            for (j, &(i, k)) in points.index.iter().enumerate() {
                if k == 1 && (3..=6).contains(&i) {
                    let (error, exact) = (points.gap[j] - exact(i), exact(i));
                    assert!(error.abs() < ALONG_CURVE * exact + ROUNDOFF, "line {i}: {error:e} of {exact:e}");
                    seen += 1;
                }
            }
            assert_eq!(seen, 4, "two lines before the joint and two behind it");
        }
    }
}
