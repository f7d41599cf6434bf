//! The far field of a condensed body at the nodes of its contact grid: its compliance less that of a half-space.
//!
//! The means of its compliance over the hats of two nodes, less those of its half-space, are smooth. They are interpolated between nodes, and belong to the body: whatever lies
//! on it, and where, they stay the same. They are made by pairs of lines of the grid, when these are asked for, and kept.

use super::compliance::Terms;
use super::half_space::HalfSpace;
use super::point::NodeWeight;
use super::surface::Surface;
use crate::mesh::SurfaceGrid;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par, Scale};
use nalgebra::{Matrix3, Point3, Vector2};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::OnceLock;

/// Lines of the grid, in either direction, over which an element mesh does not resolve a half-space: the difference of
/// both is an error there.
const UNRESOLVED: usize = 2;

/// The far field of a body. Where its compliance changes by a factor, it serves on, as long as that of the half-space does.
#[derive(Debug)]
pub struct BeyondHalfSpace {
    half_space: HalfSpace,
    lines: Vec<Line>,
    columns: Vec<Column>,
    /// Between the nodes in the middle, where they have the same distance and a half-space has few values, and between all.
    blocks: [Blocks; 2],
}

/// The values between nodes of pairs of lines.
#[derive(Debug)]
struct Blocks {
    /// The nodes of a line that are wanted, and with those that stand for them.
    wanted: Range<usize>,
    whole: Range<usize>,
    /// By two lines, of which the second is not before the first, and then by `3·(node of the line that is wanted) + axis`, m/N.
    of_lines: Vec<OnceLock<Mat<f64>>>,
}

impl Blocks {
    fn new(wanted: Range<usize>, lines: usize, columns: usize) -> Self {
        let whole = wanted.start.saturating_sub(UNRESOLVED)..(wanted.end + UNRESOLVED).min(columns);
        Self { wanted, whole, of_lines: vec![OnceLock::new(); lines * lines] }
    }
}

/// A line of the grid along the track.
#[derive(Debug, Clone)]
struct Line {
    /// Arc length on the profile, m.
    s: f64,
    /// Half the distance of the lines on either side, m.
    width: f64,
    /// Parts of the lines before, at and behind it in the mean over a hat.
    parts: [f64; 3],
    /// Metres along the track over the coordinate of the grid there: the radius of what is revolved.
    over: f64,
    /// Normal out of the rail, (y, z).
    normal: Vector2<f64>,
}

/// Nodes across the track.
#[derive(Debug, Clone)]
struct Column {
    /// Coordinate of the grid, and the width in it.
    at: f64,
    width: f64,
    parts: [f64; 3],
}

/// A run of neighbouring nodes of a line, by the first of them, and where they stand in a list.
struct Run {
    line: usize,
    first: usize,
    count: usize,
    place: usize,
}

impl BeyondHalfSpace {
    /// That of a body with contact nodes on a `grid` in these `places` (m, in the order of the grid). It is turned about an axle if it is the wheel's.
    pub fn of_nodes(
        grid: &SurfaceGrid,
        places: &[Point3<f64>],
        is_wheel: bool,
        half_space: HalfSpace,
    ) -> Self {
        let columns = grid.along_track.len();
        let middle = |line: usize| places[line * columns + columns / 2].yz();
        let last = grid.along_profile.len() - 1;
        let of_line = |line: usize| {
            let tangent = middle((line + 1).min(last)) - middle(line.saturating_sub(1));
            let end = columns - 1;
            let (x, angle) = (places[line * columns + end].x, grid.along_track[end]);
            (if is_wheel { x / angle.sin() } else { 1.0 }, Vector2::new(tangent.y, -tangent.x).normalize())
        };
        Self::new(grid, of_line, half_space)
    }

    /// That of a body with the nodes of a `surface`.
    pub fn of_surface(surface: &Surface<'_>, half_space: HalfSpace) -> Self {
        let s = &surface.grid.along_profile;
        Self::new(surface.grid, |line| (surface.lines_over(s[line]), surface.normal(s[line])), half_space)
    }

    /// The same body with another half-space.
    #[must_use]
    pub fn with(&self, half_space: HalfSpace) -> Self {
        let (lines, columns) = (self.lines.clone(), self.columns.clone());
        let blocks =
            self.blocks.each_ref().map(|of| Blocks::new(of.wanted.clone(), lines.len(), columns.len()));
        Self { half_space, lines, columns, blocks }
    }

    /// `of_line` has metres along the track over the coordinate of the grid, and the normal.
    fn new(
        grid: &SurfaceGrid,
        of_line: impl Fn(usize) -> (f64, Vector2<f64>),
        half_space: HalfSpace,
    ) -> Self {
        let (s, t) = (&grid.along_profile, &grid.along_track);
        let line = |i: usize| {
            let (over, normal) = of_line(i);
            Line { s: s[i], width: width(s, i), parts: hat(s, i), over, normal }
        };
        let column = |k: usize| Column { at: t[k], width: width(t, k), parts: hat(t, k) };
        Self {
            half_space,
            lines: (0..s.len()).map(line).collect(),
            columns: (0..t.len()).map(column).collect(),
            blocks: [evenly(t), 0..t.len()].map(|wanted| Blocks::new(wanted, s.len(), t.len())),
        }
    }

    /// Between some `nodes` of the grid (ascending), by `3·place + axis` with the places in this list, m/N; the body has the compliance `terms` of its nodes. The half-space is softer by
    /// the factor of these.
    pub fn between(&self, terms: &Terms<'_>, nodes: &[usize]) -> Mat<f64> {
        let runs = self.runs(nodes);
        let is_inside = |of: &&Blocks| {
            runs.iter().all(|run| run.first >= of.wanted.start && run.first + run.count <= of.wanted.end)
        };
        let of = self.blocks.iter().find(is_inside).unwrap_or(&self.blocks[1]);
        let first = |run: &Run| 3 * (run.first - of.wanted.start);
        let products = terms.product.map(|factors| self.products(factors, of, &runs));
        let mut found = Mat::zeros(3 * nodes.len(), 3 * nodes.len());
        for (n, from) in runs.iter().enumerate() {
            for to in &runs[..=n] {
                let mut block = Cow::Borrowed(self.block(terms.matrix, of, to.line, from.line));
                if terms.factor != 1.0 {
                    let scaled = block.as_ref() * Scale(terms.factor);
                    block = Cow::Owned(scaled);
                }
                if let Some(products) = &products {
                    block = Cow::Owned(block.as_ref() + self.product(products, of, to.line, from.line));
                }
                for c in 0..3 * from.count {
                    let values = &block.col_as_slice(first(from) + c)[first(to)..][..3 * to.count];
                    found.col_as_slice_mut(3 * from.place + c)[3 * to.place..][..values.len()]
                        .copy_from_slice(values);
                }
                // the other half, column by column of what is written
                for r in (0..3 * to.count).filter(|_| to.place != from.place) {
                    let column = &mut found.col_as_slice_mut(3 * to.place + r)[3 * from.place..];
                    let row = (0..3 * from.count).map(|c| block[(first(to) + r, first(from) + c)]);
                    column.iter_mut().zip(row).for_each(|(found, value)| *found = value);
                }
            }
        }
        found
    }

    /// The means of both factors of a product over the hats of the nodes of the lines of `runs`, by line.
    fn products(&self, factors: [&Mat<f64>; 2], of: &Blocks, runs: &[Run]) -> BTreeMap<usize, [Mat<f64>; 2]> {
        let mean = |factor: &Mat<f64>, line: usize| {
            let mut means = Mat::zeros(3 * of.whole.len(), factor.ncols());
            for (place, k) in of.whole.clone().enumerate() {
                for (i, of_line) in around(line, &self.lines[line].parts) {
                    for (j, of_column) in around(k, &self.columns[k].parts) {
                        let node = i * self.columns.len() + j;
                        for (axis, c) in (0..3).flat_map(|axis| (0..factor.ncols()).map(move |c| (axis, c))) {
                            means[(3 * place + axis, c)] +=
                                of_line * of_column * factor[(3 * node + axis, c)];
                        }
                    }
                }
            }
            means
        };
        let lines = runs.iter().map(|run| inside(run.line, self.lines.len()));
        lines.map(|line| (line, factors.map(|factor| mean(factor, line)))).collect()
    }

    /// The product of factors between the nodes of two lines, as a compliance has it.
    fn product(
        &self,
        means: &BTreeMap<usize, [Mat<f64>; 2]>,
        of: &Blocks,
        to: usize,
        from: usize,
    ) -> Mat<f64> {
        let [to, from] = [to, from].map(|line| inside(line, self.lines.len()));
        let [one, other] = [&means[&to][0], &means[&from][1]];
        let mut block = Mat::zeros(one.nrows(), other.nrows());
        // on one thread, so that their number changes nothing
        matmul(block.as_mut(), Accum::Replace, one.as_ref(), other.transpose(), 1.0, Par::Seq);
        self.smoothed(block, of, to, from)
    }

    /// The nodes in whose means over hats there are shares with these `weights`: the nodes that forces on the former reach, and that these move with.
    pub fn spread(&self, weights: &[NodeWeight]) -> Vec<NodeWeight> {
        let columns = self.columns.len();
        let mut spread: Vec<NodeWeight> = Vec::with_capacity(16);
        for NodeWeight { node, normal, scalar } in weights {
            let line = inside(node / columns, self.lines.len());
            let column = inside(node % columns, columns);
            for (i, of_line) in around(line, &self.lines[line].parts) {
                for (k, of_column) in around(column, &self.columns[column].parts) {
                    let (node, part) = (i * columns + k, of_line * of_column);
                    let at = spread.iter().position(|other| other.node == node).unwrap_or_else(|| {
                        spread.push(NodeWeight { node, normal: Vector2::zeros(), scalar: 0.0 });
                        spread.len() - 1
                    });
                    spread[at].normal += normal * part;
                    spread[at].scalar += scalar * part;
                }
            }
        }
        spread
    }

    fn runs(&self, nodes: &[usize]) -> Vec<Run> {
        let columns = self.columns.len();
        let follows = |a: &usize, b: &usize| *b == a + 1 && !b.is_multiple_of(columns);
        let mut place = 0;
        let run = |run: &[usize]| {
            place += run.len();
            Run {
                line: run[0] / columns,
                first: run[0] % columns,
                count: run.len(),
                place: place - run.len(),
            }
        };
        nodes.chunk_by(follows).map(run).collect()
    }

    /// Between the nodes of two lines, the second not before the first. The hats of the last lines and of the last nodes of a line are cut: those beside stand for them.
    fn block<'b>(&self, compliance: &Mat<f64>, of: &'b Blocks, to: usize, from: usize) -> &'b Mat<f64> {
        let [to, from] = [to, from].map(|line| inside(line, self.lines.len()));
        of.of_lines[to * self.lines.len() + from].get_or_init(|| {
            let mut block = self.means(compliance, &of.whole, to, from);
            self.subtract_half_space(&mut block, &of.whole, to, from);
            self.smoothed(block, of, to, from)
        })
    }

    /// The values that are wanted of a block of two lines, without errors between neighbours.
    fn smoothed(&self, mut block: Mat<f64>, of: &Blocks, to: usize, from: usize) -> Mat<f64> {
        if to.abs_diff(from) <= UNRESOLVED {
            self.smooth(&mut block, &of.whole);
        }
        let place = |row: usize| {
            let column = inside(of.wanted.start + row / 3, self.columns.len());
            3 * (column - of.whole.start) + row % 3
        };
        let size = 3 * of.wanted.len();
        Mat::from_fn(size, size, |row, column| block[(place(row), place(column))])
    }

    /// The means of the compliance over the hats of nodes.
    fn means(&self, compliance: &Mat<f64>, nodes: &Range<usize>, to: usize, from: usize) -> Mat<f64> {
        let columns = self.columns.len();
        // with their neighbours
        let around_nodes = nodes.start.saturating_sub(1)..(nodes.end + 1).min(columns);
        let (first, size) = (3 * around_nodes.start, 3 * around_nodes.len());
        let mut sum = Mat::<f64>::zeros(size, size);
        for (m, of_from) in around(from, &self.lines[from].parts) {
            for (i, of_to) in around(to, &self.lines[to].parts) {
                for c in 0..size {
                    let values = &compliance.col_as_slice(3 * columns * m + first + c)
                        [3 * columns * i + first..][..size];
                    let sum = sum.col_as_slice_mut(c).iter_mut();
                    sum.zip(values).for_each(|(sum, value)| *sum += of_to * of_from * value);
                }
            }
        }
        let place = |column: usize| column - around_nodes.start;
        let mut rows = Mat::<f64>::zeros(3 * nodes.len(), size);
        for c in 0..size {
            let (values, rows) = (sum.col_as_slice(c), rows.col_as_slice_mut(c));
            for (row, k) in nodes.clone().enumerate() {
                for (j, part) in around(k, &self.columns[k].parts) {
                    (0..3).for_each(|axis| rows[3 * row + axis] += part * values[3 * place(j) + axis]);
                }
            }
        }
        let mut means = Mat::<f64>::zeros(3 * nodes.len(), 3 * nodes.len());
        for (column, k) in nodes.clone().enumerate() {
            for (j, part) in around(k, &self.columns[k].parts) {
                for axis in 0..3 {
                    let means = means.col_as_slice_mut(3 * column + axis).iter_mut();
                    let rows = rows.col_as_slice(3 * place(j) + axis);
                    means.zip(rows).for_each(|(mean, row)| *mean += part * row);
                }
            }
        }
        means
    }

    /// Takes the means of the half-space from a block, but for those between nodes so near that others stand for them.
    fn subtract_half_space(&self, block: &mut Mat<f64>, nodes: &Range<usize>, to: usize, from: usize) {
        let [to_line, from_line] = [to, from].map(|line| &self.lines[line]);
        let [turned, back] = [to_line, from_line].map(|Line { normal: n, .. }| {
            // rows: normal, lateral tangent, along the track
            Matrix3::new(0.0, n.x, n.y, 0.0, -n.y, n.x, 1.0, 0.0, 0.0)
        });
        let overs = beside(0.5 * (to_line.over + from_line.over));
        for (column, l) in nodes.clone().enumerate() {
            for (row, k) in nodes.clone().enumerate() {
                if self.stand_in(to.abs_diff(from), k, l).is_some() {
                    continue;
                }
                let (of_to, of_from) = (&self.columns[k], &self.columns[l]);
                let mut means = Matrix3::zeros();
                for (over, part) in overs.iter().filter(|(_, part)| *part != 0.0) {
                    let apart = Vector2::new(to_line.s - from_line.s, over * (of_to.at - of_from.at));
                    let widths = [(to_line, of_to), (from_line, of_from)]
                        .map(|(line, column)| Vector2::new(line.width, over * column.width));
                    means += self.half_space.means(&apart, &widths) * *part;
                }
                let means = turned.tr_mul(&means) * back;
                for (a, b) in AXES {
                    block[(3 * row + a, 3 * column + b)] -= means[(a, b)];
                }
            }
        }
    }

    /// Which pairs of nodes of two lines, so many lines `apart`, stand for the nodes `k` and `l` of these, that are so near each other that the elements do not resolve what lies
    /// between them: farther apart along the track, with the same middle. With it, the part of what is odd in the distance. `None` if they are far enough apart, or where the
    /// grid ends.
    fn stand_in(&self, apart: usize, k: usize, l: usize) -> Option<([(usize, usize); 2], f64)> {
        let along = k.abs_diff(l);
        if apart > UNRESOLVED || along > UNRESOLVED {
            return None;
        }
        // as many lines outwards on both sides
        let outwards = (UNRESOLVED + 2 - along) / 2;
        let (low, high) = (k.min(l).checked_sub(outwards)?, k.max(l) + outwards);
        let (one, other) = if k <= l { (low, high) } else { (high, low) };
        (high < self.columns.len())
            .then(|| ([(one, other), (other, one)], along as f64 / (high - low) as f64))
    }

    /// Replaces the values between nodes that have a stand-in: the part that is even in the distance as it is, the
    /// odd part in proportion. Stand-ins have none themselves.
    fn smooth(&self, block: &mut Mat<f64>, nodes: &Range<usize>) {
        for (k, l) in nodes.clone().flat_map(|k| nodes.clone().map(move |l| (k, l))) {
            let Some((pairs, odd)) = self.stand_in(0, k, l) else { continue };
            if !pairs.iter().all(|(a, b)| nodes.contains(a) && nodes.contains(b)) {
                continue;
            }
            let place = |column: usize| 3 * (column - nodes.start);
            let [(a, b), (c, d), (k, l)] = [pairs[0], pairs[1], (k, l)].map(|(a, b)| (place(a), place(b)));
            for (row, column) in AXES {
                let (same, turned) = (block[(a + row, b + column)], block[(c + row, d + column)]);
                block[(k + row, l + column)] = 0.5 * (same + turned) + 0.5 * odd * (same - turned);
            }
        }
    }
}

/// Pairs of axes.
const AXES: [(usize, usize); 9] = [(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1), (0, 2), (1, 2), (2, 2)];

/// The nodes around the middle that have the same distance.
fn evenly(nodes: &[f64]) -> Range<usize> {
    let middle = nodes.len() / 2;
    let distance = |k: usize| nodes[k + 1] - nodes[k];
    let is_same = |k: &usize| (distance(*k) / distance(middle.saturating_sub(1)) - 1.0).abs() < SAME_DISTANCE;
    let before = (0..middle).rev().take_while(is_same).count();
    let behind = (middle..nodes.len().saturating_sub(1)).take_while(is_same).count();
    middle - before..middle + behind + 1
}

/// ROUNDOFF of distances that are the same.
const SAME_DISTANCE: f64 = 1e-9;

/// Ratio of two radii between which the half-space of what is revolved is interpolated, as a logarithm: all lines of a wheel have few of them, and an eighth of the square of
/// this is the error, 3e-6.
const RADII: f64 = 0.005;

/// The radii on either side of one, with their parts in it.
fn beside(over: f64) -> [(f64, f64); 2] {
    let step = over.ln() / RADII;
    let (below, part) = (step.floor(), step - step.floor());
    [((RADII * below).exp(), 1.0 - part), ((RADII * (below + 1.0)).exp(), part)]
}

/// Half the distance of the lines on either side of one, or of the one beside the first and the last.
fn width(lines: &[f64], i: usize) -> f64 {
    0.5 * (lines[(i + 1).min(lines.len() - 1)] - lines[i.saturating_sub(1)])
}

/// Parts of the lines before, at and behind one in the mean of a piecewise linear function over its hat.
fn hat(lines: &[f64], i: usize) -> [f64; 3] {
    let before = if i > 0 { lines[i] - lines[i - 1] } else { 0.0 };
    let behind = if i + 1 < lines.len() { lines[i + 1] - lines[i] } else { 0.0 };
    [before, 2.0 * (before + behind), behind].map(|part| part / (3.0 * (before + behind)))
}

/// A line, or the one beside it where it is the first or the last of so many.
fn inside(line: usize, count: usize) -> usize {
    if count < 3 { line } else { line.clamp(1, count - 2) }
}

/// The lines around one with their parts.
fn around(line: usize, parts: &[f64; 3]) -> impl Iterator<Item = (usize, f64)> {
    let parts = *parts;
    (0..3).filter(move |&n| parts[n] != 0.0).map(move |n| (line + n - 1, parts[n]))
}

#[cfg(test)]
mod tests;
