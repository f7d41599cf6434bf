//! Contact forces in, change of gap and slip out.

use super::point::{ALONG, ContactPoint, Side};
use crate::superelement::add_columns;
use faer::Mat;

/// Linear elasticity as the contact sees it.
pub trait Compliance {
    /// Adds this share to the symmetric matrix, m/N, of relative displacements under contact
    /// forces at `points`. Row and column `direction·points + point`; one direction (normal) or three
    /// (normal, lateral tangent, along the track), as the matrix has room for.
    fn add_to(&self, points: &[ContactPoint], matrix: &mut Mat<f64>);
}

/// Sum of the compliances with `directions` (1 or 3) unknowns a point.
pub fn total(parts: &[&dyn Compliance], points: &[ContactPoint], directions: usize) -> Mat<f64> {
    let n = directions * points.len();
    let mut matrix = Mat::zeros(n, n);
    parts.iter().for_each(|part| part.add_to(points, &mut matrix));
    matrix
}

/// The compliance of a body's contact nodes, `3·node + axis` in the order of its grid, m/N; it may have more coordinates.
pub trait NodalCompliance: Sync {
    /// How many coordinates it has.
    fn coordinates(&self) -> usize;

    /// The terms of its values between contact nodes.
    fn terms(&self) -> Terms<'_>;
}

/// A compliance as a sum, so that a few values of it do not take all of them.
pub struct Terms<'a> {
    /// A symmetric matrix between the contact nodes, m/N,
    pub matrix: &'a Mat<f64>,
    /// times this.
    pub factor: f64,
    /// The first of these, by coordinate, times the transpose of the second; together symmetric.
    pub product: Option<[&'a Mat<f64>; 2]>,
}

impl NodalCompliance for Mat<f64> {
    fn coordinates(&self) -> usize {
        self.nrows()
    }

    fn terms(&self) -> Terms<'_> {
        Terms { matrix: self, factor: 1.0, product: None }
    }
}

/// A condensed body.
pub struct BodyCompliance<'a> {
    /// The compliance of its contact nodes, `3·node + axis`, m/N.
    pub compliance: &'a Mat<f64>,
    /// Which body it is.
    pub side: Side,
}

/// Weights of the nodal coordinates in rows.
struct Rows {
    /// Where the weights of each row begin, and where the last ones end.
    starts: Vec<usize>,
    /// Coordinates with their weights.
    weights: Vec<(usize, f64)>,
}

impl Rows {
    /// Of the `rows` of points, by the places of the nodes.
    fn of(
        points: &[ContactPoint],
        side: Side,
        rows: impl Iterator<Item = usize>,
        place: impl Fn(usize) -> usize,
    ) -> Self {
        let (mut starts, mut weights) = (vec![0], Vec::new());
        for r in rows {
            let row = points[r % points.len()].row(side, r / points.len()).filter(|&(_, w)| w != 0.0);
            weights.extend(row.map(|(dof, w)| (3 * place(dof / 3) + dof % 3, w)));
            starts.push(weights.len());
        }
        Self { starts, weights }
    }

    fn len(&self) -> usize {
        self.starts.len() - 1
    }

    fn row(&self, r: usize) -> &[(usize, f64)] {
        &self.weights[self.starts[r]..self.starts[r + 1]]
    }

    /// The coordinates, of so many, that the first rows touch, ascending.
    fn touched(&self, coordinates: usize, first: usize) -> Vec<usize> {
        let mut touched = vec![false; coordinates];
        self.weights[..self.starts[first]].iter().for_each(|&(dof, _)| touched[dof] = true);
        (0..coordinates).filter(|&dof| touched[dof]).collect()
    }

    /// What the `used` coordinates move under the forces of the rows, a column for each of them: neighbours together, as they are in the `nodal`
    /// matrix, and not so many that what they have of it does not stay in the cache.
    fn moved(&self, nodal: &Mat<f64>, used: &[usize]) -> Mat<f64> {
        let size = self.len();
        let mut moved = Mat::zeros(size, used.len());
        let mut together = vec![0.0; TOGETHER * size];
        let mut place = 0;
        for some in used.chunk_by(|a, b| *b == a + 1).flat_map(|run| run.chunks(TOGETHER)) {
            let (dofs, values) = (some[0]..some[0] + some.len(), &mut together[..some.len() * size]);
            values.fill(0.0);
            let of_rows = values.chunks_exact_mut(some.len()).enumerate();
            of_rows.for_each(|(r, values)| add_columns(nodal, dofs.clone(), self.row(r), values));
            for of_one in 0..some.len() {
                let values = values[of_one..].iter().step_by(some.len());
                let column = moved.col_as_slice_mut(place + of_one).iter_mut();
                column.zip(values).for_each(|(moved, value)| *moved = *value);
            }
            place += some.len();
        }
        moved
    }
}

/// Where each of so many coordinates, or nodes, stands among those that are `used`.
fn places(used: &[usize], coordinates: usize) -> Vec<usize> {
    let mut places = vec![0; coordinates];
    used.iter().enumerate().for_each(|(place, &dof)| places[dof] = place);
    places
}

impl Compliance for BodyCompliance<'_> {
    fn add_to(&self, points: &[ContactPoint], matrix: &mut Mat<f64>) {
        let rows = Rows::of(points, self.side, 0..matrix.nrows(), |node| node);
        add_values(self.compliance, &rows, matrix);
    }
}

/// Adds what the rows have of a symmetric `nodal` matrix.
fn add_values(nodal: &Mat<f64>, rows: &Rows, matrix: &mut Mat<f64>) {
    let (size, coordinates) = (matrix.nrows(), nodal.nrows());
    let used = rows.touched(coordinates, size);
    let moved = rows.moved(nodal, &used);
    let places = places(&used, coordinates);
    for column in 0..size {
        let by_place: Vec<(usize, f64)> = rows.row(column).iter().map(|&(dof, w)| (places[dof], w)).collect();
        let upper = &mut matrix.col_as_slice_mut(column)[..=column];
        add_columns(&moved, 0..column + 1, &by_place, upper);
    }
    copy_upper(matrix);
}

/// What `points` have of a symmetric nodal matrix in `directions` (1 or 3), `direction·points + point`. Its coordinates are `3·place + axis`, with the places of the `nodes` of a body
/// that it has. Where it is its own mirror image along the track, half of the values are enough: `twins` are the mirror images of the points.
pub fn at_points(
    (nodal, nodes): (&Mat<f64>, &[usize]),
    points: &[ContactPoint],
    side: Side,
    directions: usize,
    twins: Option<&[usize]>,
) -> Mat<f64> {
    let n = points.len();
    let of_nodes = places(nodes, nodes.iter().max().map_or(0, |last| last + 1));
    let place = |node: usize| of_nodes[node];
    let mut matrix = Mat::zeros(directions * n, directions * n);
    let Some(twins) = twins else {
        add_values(nodal, &Rows::of(points, side, 0..directions * n, place), &mut matrix);
        return matrix;
    };
    let ahead: Vec<usize> = (0..n).filter(|&j| twins[j] <= j).collect();
    let half = directions * ahead.len();
    let row = |r: usize, of: &dyn Fn(usize) -> usize| r / ahead.len() * n + of(ahead[r % ahead.len()]);
    let (of_ahead, of_twins): (Vec<usize>, Vec<usize>) =
        (0..half).map(|r| (row(r, &|j| j), row(r, &|j| twins[j]))).unzip();
    // those ahead, then their mirror images
    let rows = Rows::of(points, side, of_ahead.iter().chain(&of_twins).copied(), place);
    let used = rows.touched(nodal.nrows(), half);
    let moved = rows.moved(nodal, &used);
    let places = places(&used, nodal.nrows());
    let mut values = vec![0.0; 2 * half];
    for a in 0..half {
        let by_place: Vec<(usize, f64)> = rows.row(a).iter().map(|&(dof, w)| (places[dof], w)).collect();
        let (with, across) = values.split_at_mut(half);
        let (with, across) = (&mut with[..=a], &mut across[..=a]);
        with.fill(0.0);
        across.fill(0.0);
        add_columns(&moved, 0..a + 1, &by_place, with);
        add_columns(&moved, half..half + a + 1, &by_place, across);
        let (column, image) = (of_ahead[a], of_twins[a]);
        for b in 0..=a {
            let sign = if (column / n == ALONG) == (of_ahead[b] / n == ALONG) { 1.0 } else { -1.0 };
            let entries = [
                (of_ahead[b], column, with[b]),
                (of_twins[b], column, across[b]),
                (of_twins[b], image, sign * with[b]),
                (of_ahead[b], image, sign * across[b]),
            ];
            for (r, c, value) in entries {
                (matrix[(r, c)], matrix[(c, r)]) = (value, value);
            }
        }
    }
    matrix
}

/// Makes a matrix symmetric by the values above its diagonal, block by block, so that what is written stays in the cache.
fn copy_upper(matrix: &mut Mat<f64>) {
    const BLOCK: usize = 32;
    let size = matrix.nrows();
    for first in (0..size).step_by(BLOCK) {
        for column in first..size {
            for r in first..(first + BLOCK).min(column) {
                matrix[(column, r)] = matrix[(r, column)];
            }
        }
    }
}

/// Neighbouring degrees of freedom at a time: their rows of a thousand columns are half a megabyte.
const TOGETHER: usize = 64;

/// The published penalty springs: one of constant stiffness for every contact node and direction.
pub struct PenaltySprings {
    /// Stiffness a node, N/m (published: 1e9).
    pub stiffness: f64,
}

impl Compliance for PenaltySprings {
    fn add_to(&self, _points: &[ContactPoint], matrix: &mut Mat<f64>) {
        for i in 0..matrix.nrows() {
            matrix[(i, i)] += 1.0 / self.stiffness;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::point::{NodeWeight, flat_grid};
    use super::*;
    use nalgebra::Vector2;

    /// Nodes of the body.
    const NODES: usize = 60;

    /// Source: sums over all nodes and axes as they stand in the definition, W·C·Wᵀ. Goal: the compliance of points in one and
    /// in three directions, m/N, whose nodes leave gaps between each other, on either side, added to what is there already; the same of a matrix whose nodes stand in another order. Accuracy over the
    /// largest value: ROUNDOFF of sums of a few thousand terms in another order.
    #[test]
    fn points_see_the_compliance_of_their_nodes() {
        const ROUNDOFF: f64 = 1e-13;
        let wave = |n: usize| (1.7 * n as f64 + 0.3).sin();
        let contact = 3 * NODES;
        let body = Mat::<f64>::from_fn(contact, contact, |r, c| wave(r + c) + wave(r * c));
        let backwards = |row: usize| 3 * (NODES - 1 - row / 3) + row % 3;
        let reversed: Vec<usize> = (0..NODES).rev().collect();
        let other = Mat::from_fn(contact, contact, |r, c| body[(backwards(r), backwards(c))]);
        let mut points = flat_grid((3, 4), 1e-3, |_, _| 0.0);
        let node = |n: usize| NodeWeight {
            node: n % NODES,
            normal: Vector2::new(wave(n), wave(n + 1)),
            scalar: wave(n + 2),
        };
        for (j, point) in points.iter_mut().enumerate() {
            point.base = (0..5).map(|k| node(7 * j + 2 * k)).collect();
            point.opposing = (0..7).map(|k| node(3 * j + 5 * k)).collect();
        }
        for (side, directions) in [(Side::Base, 3), (Side::Opposing, 3), (Side::Opposing, 1)] {
            let size = directions * points.len();
            let row = |r: usize| -> Vec<(usize, f64)> {
                let weights = points[r % points.len()].weights(side).iter();
                let of_axes = |w: &NodeWeight| match r / points.len() {
                    0 => [0.0, w.normal.x, w.normal.y],
                    1 => [0.0, -w.normal.y, w.normal.x],
                    _ => [w.scalar, 0.0, 0.0],
                };
                weights.flat_map(|w| (0..3).map(move |axis| (3 * w.node + axis, of_axes(w)[axis]))).collect()
            };
            let exact = Mat::from_fn(size, size, |r, c| {
                let (to, from) = (row(r), row(c));
                let sums =
                    to.iter().map(|(i, u)| from.iter().map(|(k, v)| u * v * body[(*i, *k)]).sum::<f64>());
                2.0 + sums.sum::<f64>()
            });
            let mut found = Mat::from_fn(size, size, |_, _| 2.0);
            BodyCompliance { compliance: &body, side }.add_to(&points, &mut found);
            let again = at_points((&other, &reversed), &points, side, directions, None);
            let largest = exact.col_iter().flat_map(|c| c.iter()).fold(0.0_f64, |m, v| m.max(v.abs()));
            for (r, c) in (0..size).flat_map(|r| (0..size).map(move |c| (r, c))) {
                let off = (found[(r, c)] - exact[(r, c)]).abs();
                assert!(off < ROUNDOFF * largest, "{side:?} {directions} {r} {c}: {off:e} of {largest:e}");
                let off = (2.0 + again[(r, c)] - found[(r, c)]).abs();
                assert!(off < ROUNDOFF * largest, "{side:?} {directions} {r} {c}: {off:e} of {largest:e}");
            }
        }
    }

    /// Source: the compliance of the same points by all values. Goal: points of a body that is its own mirror image along the track, some of them in the middle, have the same by half of
    /// the values, m/N, in one direction and in three. Accuracy over the largest value: ROUNDOFF of sums of some hundred terms in another order.
    #[test]
    fn half_of_a_mirror_image_is_enough() {
        const ROUNDOFF: f64 = 1e-13;
        let (lines, columns) = (4, 7);
        let image = |node: usize| node / columns * columns + columns - 1 - node % columns;
        let wave = |n: usize| (1.7 * n as f64 + 0.3).sin();
        let any = |r: usize, c: usize| wave(r + c) + wave(r * c);
        let body = Mat::<f64>::from_fn(3 * lines * columns, 3 * lines * columns, |r, c| {
            let sign = if r.is_multiple_of(3) == c.is_multiple_of(3) { 1.0 } else { -1.0 };
            any(r, c) + sign * any(3 * image(r / 3) + r % 3, 3 * image(c / 3) + c % 3)
        });
        let mut points = flat_grid((3, 5), 1e-3, |_, _| 0.0);
        let twins: Vec<usize> = (0..points.len()).map(|j| j / 5 * 5 + 4 - j % 5).collect();
        for j in 0..points.len() {
            let own = |k: usize| NodeWeight {
                node: (5 * j + 3 * k) % (lines * columns),
                normal: Vector2::new(wave(j + k), wave(2 * j + k)),
                scalar: wave(3 * j + k),
            };
            let own: Vec<NodeWeight> = (0..4).map(own).collect();
            let images: Vec<NodeWeight> =
                own.iter().map(|w| NodeWeight { node: image(w.node), ..*w }).collect();
            match twins[j].cmp(&j) {
                std::cmp::Ordering::Equal => points[j].base = [own, images].concat(),
                std::cmp::Ordering::Less => (points[j].base, points[twins[j]].base) = (own, images),
                std::cmp::Ordering::Greater => {}
            }
        }
        for directions in [1, 3] {
            let nodes: Vec<usize> = (0..lines * columns).collect();
            let of = |twins| at_points((&body, &nodes), &points, Side::Base, directions, twins);
            let (exact, found) = (of(None), of(Some(&*twins)));
            assert!((&found - &exact).norm_max() < ROUNDOFF * exact.norm_max(), "{directions}");
        }
    }
}
