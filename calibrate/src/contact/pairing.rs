//! Contact points: gaps and consistent nodal weights by integration over the
//! intersections of the cells of both surfaces.

use super::point::{ContactPoint, NodeWeight};
use super::surface::{Projection, Surface, corners, widened};
use nalgebra::{Point2, Vector2};
use railspring_profiles::quadrature::gauss_2_on;
use railspring_profiles::root::regula_falsi;

/// Which points are worth an unknown.
#[derive(Debug, Clone, Copy)]
pub struct PairingLimits {
    /// Points whose rigid gap exceeds this are left out, m.
    pub largest_gap: f64,
}

/// Pairs the base surface (rail) with the opposing one (wheel) at their present positions: the nodes of the base
/// that are near the other surface, in the order of its grid.
pub fn pair(base: &Surface, opposing: &Surface, limits: PairingLimits) -> Vec<ContactPoint> {
    let nearby = |pairing: &Pairing, line: &Line, (i, k): (usize, usize)| {
        let facing = pairing.project(line, base.grid.along_track[k], pairing.facing[i]);
        facing.is_some_and(|p| p.gap < limits.largest_gap)
    };
    Pairing::of(base, opposing, nearby)
}

/// Pairs the `wanted` nodes of the base surface, by their numbers on its grid, however far they are from the opposing
/// one, as [`nodes_near`]. Those whose hats reach beyond the grid of that, or beyond their own, are at the edge; those beyond it face the nearest place on it, and are left out where no
/// neighbour is on it.
pub fn pair_nodes(base: &Surface, opposing: &Surface, wanted: &[bool]) -> Vec<ContactPoint> {
    let columns = base.grid.along_track.len();
    let rows = wanted.len() / columns;
    let beside = |i: usize, k: usize| {
        let lines = i.saturating_sub(1)..(i + 2).min(rows);
        lines.flat_map(move |i| (k.saturating_sub(1)..(k + 2).min(columns)).map(move |k| i * columns + k))
    };
    let sought = widened(wanted, columns, 1);
    let mut on_grid = vec![false; wanted.len()];
    let mut points = at_nodes(base, opposing, |pairing, line, (i, k)| {
        let node = i * columns + k;
        let (hit, is_on_grid) = if sought[node] { pairing.nearest_hit(line, (i, k))? } else { return None };
        on_grid[node] = is_on_grid;
        Some(hit)
    });
    points.retain_mut(|point| {
        let (i, k) = point.index;
        point.at_edge |= !beside(i, k).all(|node| on_grid[node]);
        wanted[i * columns + k] && beside(i, k).any(|node| on_grid[node])
    });
    points
}

/// The nodes of the base surface that are nearer to the opposing one than the `limits`. Gap, normal and
/// weights are those at the nodes, where [`pair`] takes means over their hats. That is enough to find nearby
/// surfaces, for a tenth of the work.
pub fn nodes_near(base: &Surface, opposing: &Surface, limits: PairingLimits) -> Vec<ContactPoint> {
    // no ray is shorter than the way to the nearest point, which at x = 0 is that of the line
    let mut far: Option<(usize, bool)> = None;
    let mut beyond = |pairing: &Pairing, line: &Line, i: usize| match far {
        Some((known, beyond)) if known == i => beyond,
        _ => {
            let facing = pairing.facing[i];
            let beyond =
                opposing.normal(facing).dot(&(opposing.world(facing) - line.point)) > limits.largest_gap;
            far = Some((i, beyond));
            beyond
        }
    };
    at_nodes(base, opposing, |pairing, line, node| {
        if beyond(pairing, line, node.0) {
            return None;
        }
        pairing.hit_from(line, node).filter(|hit| hit.projection.gap < limits.largest_gap)
    })
}

/// The nodes of the base surface for which there is a `hit` on the opposing one.
fn at_nodes(
    base: &Surface,
    opposing: &Surface,
    mut hit: impl FnMut(&Pairing, &Line, (usize, usize)) -> Option<Hit>,
) -> Vec<ContactPoint> {
    let columns = base.grid.along_track.len();
    let mut found = Vec::new();
    let pairing = Pairing::candidates(base, opposing, |pairing, line, node| {
        let hit = hit(pairing, line, node);
        let is_hit = hit.is_some();
        found.extend(hit.map(|hit| (hit, line.normal)));
        is_hit
    });
    let mut points = pairing.points;
    for (point, (hit, normal)) in points.iter_mut().zip(found) {
        let (i, k) = point.index;
        let weight = |node: usize, weight: f64| NodeWeight { node, normal: normal * weight, scalar: weight };
        point.gap = hit.projection.gap;
        point.normal = normal;
        point.area = point.widths.x * point.widths.y;
        point.opposing_position = opposing.curve.point(hit.projection.along_profile);
        point.base = vec![weight(i * columns + k, 1.0)];
        point.opposing = corners(hit.local.0, hit.local.1)
            .map(|(a, b, part)| {
                let node = (hit.cell.0 + a) * opposing.grid.along_track.len() + hit.cell.1 + b;
                weight(node, part)
            })
            .to_vec();
    }
    points
}

/// Two surfaces, and the sums over the cells of the base that are integrated so far.
struct Pairing<'a> {
    base: &'a Surface<'a>,
    opposing: &'a Surface<'a>,
    /// Arc lengths on the opposing curve that face the lines of the base grid, m.
    facing: Vec<f64>,
    /// Which of `points` stands at each node of the base grid.
    slot: Vec<Option<usize>>,
    points: Vec<ContactPoint>,
}

/// A line along the track on the base surface.
struct Line {
    /// Arc length on the profile, m.
    s: f64,
    /// World coordinates (y, z).
    point: Point2<f64>,
    /// Normal out of the base, world (y, z).
    normal: Vector2<f64>,
}

impl Line {
    fn new(base: &Surface, s: f64) -> Self {
        Self { s, point: base.world(s), normal: base.normal(s) }
    }
}

/// Where an integration point of the base meets the opposing surface.
struct Hit {
    projection: Projection,
    /// First node of the cell of the opposing grid, along the profile and along the track.
    cell: (usize, usize),
    /// Local coordinates in that cell, 0 to 1.
    local: (f64, f64),
}

impl<'a> Pairing<'a> {
    /// The points of the `wanted` nodes of the base.
    fn of(
        base: &'a Surface,
        opposing: &'a Surface,
        wanted: impl Fn(&Self, &Line, (usize, usize)) -> bool,
    ) -> Vec<ContactPoint> {
        let mut pairing = Self::candidates(base, opposing, wanted);
        for point in &mut pairing.points {
            (point.base, point.opposing) = (Vec::with_capacity(9), Vec::with_capacity(25));
        }
        for i in 0..base.grid.along_profile.len() - 1 {
            pairing.integrate_row(i);
        }
        pairing.means()
    }

    /// The `wanted` nodes of the base, without any sums yet.
    fn candidates(
        base: &'a Surface,
        opposing: &'a Surface,
        mut wanted: impl FnMut(&Self, &Line, (usize, usize)) -> bool,
    ) -> Self {
        let (s, x) = (&base.grid.along_profile, &base.grid.along_track);
        let (rows, columns) = (s.len(), x.len());
        let facing = s.iter().map(|&si| opposing.nearest(&base.world(si))).collect();
        let slot = vec![None; rows * columns];
        let mut pairing = Self { base, opposing, facing, slot, points: Vec::new() };
        let width = |lines: &[f64], i: usize| {
            0.5 * (lines[(i + 1).min(lines.len() - 1)] - lines[i.saturating_sub(1)])
        };
        for i in 0..rows {
            let line = Line::new(base, s[i]);
            for k in 0..columns {
                if wanted(&pairing, &line, (i, k)) {
                    pairing.slot[i * columns + k] = Some(pairing.points.len());
                    pairing.points.push(ContactPoint {
                        index: (i, k),
                        position: Point2::new(s[i], x[k]),
                        opposing_position: Point2::origin(),
                        widths: Vector2::new(width(s, i), width(x, k)),
                        gap: 0.0,
                        area: 0.0,
                        normal: Vector2::zeros(),
                        at_edge: i == 0 || k == 0 || i + 1 == rows || k + 1 == columns,
                        base: Vec::new(),
                        opposing: Vec::new(),
                    });
                }
            }
        }
        pairing
    }

    fn project(&self, line: &Line, x: f64, guess: f64) -> Option<Projection> {
        self.opposing.project(&line.point, x, &line.normal, guess)
    }

    /// Candidates at the corners of the cell of the base whose first node is `(i, k)`.
    fn candidates_of(&self, (i, k): (usize, usize)) -> impl Iterator<Item = usize> {
        let columns = self.base.grid.along_track.len();
        [(i, k), (i, k + 1), (i + 1, k), (i + 1, k + 1)]
            .into_iter()
            .filter_map(move |(a, b)| self.slot[a * columns + b])
    }

    /// Integrates over the cells between the lines `i` and `i + 1` of the base.
    fn integrate_row(&mut self, i: usize) {
        let (s, x) = (&self.base.grid.along_profile, &self.base.grid.along_track);
        let wanted = |&k: &usize| self.candidates_of((i, k)).next().is_some();
        let cells: Vec<(usize, usize)> = (0..x.len() - 1).filter(wanted).map(|k| (i, k)).collect();
        if cells.is_empty() {
            return;
        }
        let facing = (self.facing[i], self.facing[i + 1]);
        for ends in profile_intervals(self.base, self.opposing, s[i], s[i + 1], facing) {
            let middle = Line::new(self.base, 0.5 * (ends.0 + ends.1));
            let middle = self.project(&middle, 0.0, 0.5 * (facing.0 + facing.1));
            for &cell in &cells {
                match middle {
                    Some(middle) => self.integrate_strip(cell, ends, middle.along_profile),
                    None => self.mark_edge(cell),
                }
            }
        }
    }

    /// Integrates over the part of a cell between the arc lengths `ends`, which face one row of cells of the opposing
    /// surface; `guess` is an arc length there.
    fn integrate_strip(&mut self, cell: (usize, usize), ends: (f64, f64), guess: f64) {
        let (x, opposing) = (&self.base.grid.along_track, self.opposing);
        let lines = opposing.grid.along_track.iter().map(|&t| opposing.x(guess, t));
        let (profile_points, half_s) = gauss_2_on(ends.0, ends.1);
        let profile_lines = profile_points.map(|s| Line::new(self.base, s));
        for part in breakpoints(x[cell.1], x[cell.1 + 1], lines).windows(2) {
            let (track_points, half_x) = gauss_2_on(part[0], part[1]);
            for line in &profile_lines {
                for x in track_points {
                    match self.hit(line, x, guess) {
                        Some(hit) => self.add(cell, (line, x), (half_s, half_x), &hit),
                        None => self.mark_edge(cell),
                    }
                }
            }
        }
    }

    /// Where the point at `x` on `line` meets the opposing grid; `None` beyond its ends.
    fn hit(&self, line: &Line, x: f64, guess: f64) -> Option<Hit> {
        let projection = self.project(line, x, guess)?;
        let (a, u) = locate(&self.opposing.grid.along_profile, projection.along_profile)?;
        let (b, v) = locate(&self.opposing.grid.along_track, projection.along_track)?;
        Some(Hit { projection, cell: (a, b), local: (u, v) })
    }

    /// Where a node of the base, on its `line`, meets the opposing grid.
    fn hit_from(&self, line: &Line, (i, k): (usize, usize)) -> Option<Hit> {
        self.hit(line, self.base.grid.along_track[k], self.facing[i])
    }

    /// The same, or the nearest place on the opposing grid, and whether it is on it.
    fn nearest_hit(&self, line: &Line, (i, k): (usize, usize)) -> Option<(Hit, bool)> {
        let projection = self.project(line, self.base.grid.along_track[k], self.facing[i])?;
        let grid = self.opposing.grid;
        let on = |axis: &[f64], at: f64| {
            let within = at.clamp(axis[0], axis[axis.len() - 1]);
            locate(axis, within).map(|place| (place, locate(axis, at).is_some()))
        };
        let ((a, u), along_profile) = on(&grid.along_profile, projection.along_profile)?;
        let ((b, v), along_track) = on(&grid.along_track, projection.along_track)?;
        Some((Hit { projection, cell: (a, b), local: (u, v) }, along_profile && along_track))
    }

    /// Adds what an integration point of the cell `(i, k)` gives to the candidates at its corners. Its weight is the
    /// product of `halves`, m.
    fn add(&mut self, (i, k): (usize, usize), (line, x): (&Line, f64), halves: (f64, f64), hit: &Hit) {
        let (base, opposing) = (self.base, self.opposing);
        let (lines, columns) = (&base.grid.along_profile, &base.grid.along_track);
        let u = (line.s - lines[i]) / (lines[i + 1] - lines[i]);
        let v = (x - columns[k]) / (columns[k + 1] - columns[k]);
        let gap =
            hit.projection.gap + base.recession((i, k), (u, v)) + opposing.recession(hit.cell, hit.local);
        let on_opposing = opposing.curve.point(hit.projection.along_profile);
        for (di, dk, phi) in corners(u, v) {
            let Some(j) = self.slot[(i + di) * columns.len() + k + dk] else { continue };
            let point = &mut self.points[j];
            let w = phi * halves.0 * halves.1;
            point.area += w;
            point.gap += w * gap;
            point.normal += line.normal * w;
            point.opposing_position += on_opposing.coords * w;
            for (ei, ek, n) in corners(u, v) {
                add_weight(&mut point.base, (i + ei) * columns.len() + k + ek, w * n, &line.normal);
            }
            for (ea, eb, n) in corners(hit.local.0, hit.local.1) {
                let node = (hit.cell.0 + ea) * opposing.grid.along_track.len() + hit.cell.1 + eb;
                add_weight(&mut point.opposing, node, w * n, &line.normal);
            }
        }
    }

    /// Notes of the candidates of a cell that their patch is cut.
    fn mark_edge(&mut self, cell: (usize, usize)) {
        let candidates: Vec<usize> = self.candidates_of(cell).collect();
        candidates.into_iter().for_each(|j| self.points[j].at_edge = true);
    }

    /// Divides the sums by the areas; drops points that face nothing.
    fn means(self) -> Vec<ContactPoint> {
        let mut points = self.points;
        points.retain(|point| point.area > 0.0);
        for point in &mut points {
            point.gap /= point.area;
            point.opposing_position /= point.area;
            point.normal = point.normal.normalize();
            for w in point.base.iter_mut().chain(point.opposing.iter_mut()) {
                w.normal /= point.area;
                w.scalar /= point.area;
            }
        }
        points
    }
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

/// Cell of a grid axis that holds `t`, with the local coordinate in 0..1; `None` outside, but for rounding.
pub fn locate(axis: &[f64], t: f64) -> Option<(usize, f64)> {
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

/// Parts of a base cell [s0, s1] between the lines of the opposing grid that face it, and between the jumps in curvature
/// of either profile: across one, a rule that is exact for parabolas is off by a share of the jump.
pub(super) fn profile_intervals(
    base: &Surface,
    opposing: &Surface,
    s0: f64,
    s1: f64,
    seeds: (f64, f64),
) -> Vec<(f64, f64)> {
    let facing = |s: f64, guess: f64| opposing.project(&base.world(s), 0.0, &base.normal(s), guess);
    let mut cuts = base.curve.breakpoints();
    if let (Some(a), Some(b)) = (facing(s0, seeds.0), facing(s1, seeds.1)) {
        let (a, b) = (a.along_profile, b.along_profile);
        let (low, high) = (a.min(b), a.max(b));
        let lines = opposing.grid.along_profile.iter().copied().chain(opposing.curve.breakpoints());
        for line in lines.filter(|&l| l > low && l < high) {
            let root =
                regula_falsi((s0, a - line), (s1, b - line), |s| Some(facing(s, line)?.along_profile - line));
            cuts.extend(root);
        }
    }
    breakpoints(s0, s1, cuts.into_iter()).windows(2).map(|w| (w[0], w[1])).collect()
}

#[cfg(test)]
mod tests {
    use super::super::point::Side;
    use super::*;
    use crate::mesh::SurfaceGrid;
    use railspring_profiles::profile::ProfileCurve;

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
            for point in &points {
                let (i, k) = point.index;
                if k == 1 && (3..=6).contains(&i) {
                    let (error, exact) = (point.gap - exact(i), exact(i));
                    assert!(error.abs() < ALONG_CURVE * exact + ROUNDOFF, "line {i}: {error:e} of {exact:e}");
                    seen += 1;
                }
            }
            assert_eq!(seen, 4, "two lines before the joint and two behind it");
        }
    }

    /// Source: the parabola y²/2R. Goal: gaps at the nodes of a plane under it, m, those of all nodes nearer than the limit and of no others,
    /// and displacements of the parabola's nodes that are linear over it, m, at these nodes. Exact but for ROUNDOFF, and for CURVE, the spline
    /// through points of the parabola every 0.25 mm, whose ends have no curvature.
    #[test]
    fn nodes_see_the_surface_above_them() {
        const RADIUS: f64 = 0.3;
        const ROUNDOFF: f64 = 1e-15;
        const CURVE: f64 = 1e-9;
        let profile = |radius: f64| {
            let point = |y: f64| Point2::new(y, -y * y / (2.0 * radius));
            let points: Vec<_> = (-40..=40).map(|i| point(f64::from(i) * 2.5e-4)).collect();
            ProfileCurve::from_points(&points, &[]).unwrap()
        };
        let (plane, parabola) = (profile(f64::INFINITY), profile(RADIUS));
        let grid = |lines: Vec<f64>| {
            let count = lines.len() * 3;
            let along_track = vec![-1e-3, 0.0, 1e-3];
            SurfaceGrid { along_profile: lines, along_track, nodes: (0..count).collect() }
        };
        let (lower, upper) = (
            grid((0..=9).map(|i| 1e-3 + f64::from(i) * 2e-3).collect()),
            grid(vec![0.0, 7e-3, parabola.length()]),
        );
        let limit = 30e-6;
        let found = nodes_near(
            &Surface::extruded(&plane, &lower),
            &Surface::extruded(&parabola, &upper),
            PairingLimits { largest_gap: limit },
        );
        let place = |i: usize| lower.along_profile[i] - 10e-3;
        let exact = |i: usize| place(i).powi(2) / (2.0 * RADIUS);
        let expected: Vec<_> =
            (0..=9).filter(|&i| exact(i) < limit).flat_map(|i| (0..3).map(move |k| (i, k))).collect();
        assert_eq!(found.iter().map(|point| point.index).collect::<Vec<_>>(), expected);
        // of the wheel's nodes, down by a part of their arc length
        let nodal: Vec<f64> =
            upper.along_profile.iter().flat_map(|s| (0..3).flat_map(move |_| [0.0, 0.0, 1e-3 * s])).collect();
        for point in &found {
            let (i, _) = point.index;
            assert!((point.gap - exact(i)).abs() < CURVE, "{i}: {} {}", point.gap, exact(i));
            let facing = parabola.closest(&point.opposing_position).0;
            let moved = point.displacement(Side::Opposing, 0, &nodal);
            assert!((moved + 1e-3 * facing).abs() < CURVE, "{i}: {moved} {facing}");
            assert!((point.displacement(Side::Base, 1, &[0.0, 1.0, 0.0].repeat(30)) - 1.0).abs() < ROUNDOFF);
        }
    }
}
