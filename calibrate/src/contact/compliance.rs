//! Contact forces in, change of gap and slip out.

use super::point::{ContactPoint, Side};
use crate::superelement::add_columns;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};

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
    /// Its contact nodes.
    pub compliance: &'a dyn NodalCompliance,
    /// Which body it is.
    pub side: Side,
}

impl Compliance for BodyCompliance<'_> {
    fn add_to(&self, points: &[ContactPoint], matrix: &mut Mat<f64>) {
        let (count, size) = (points.len(), matrix.nrows());
        let Terms { matrix: nodal, factor, product } = self.compliance.terms();
        // the degrees of freedom that some point touches; the weights of a row are those from its start to the next one
        let mut touched = vec![false; self.compliance.coordinates()];
        let (mut starts, mut weights) = (vec![0], Vec::new());
        for r in 0..size {
            weights.extend(points[r % count].row(self.side, r / count).filter(|&(_, w)| w != 0.0));
            weights[starts[r]..].iter().for_each(|&(dof, _)| touched[dof] = true);
            starts.push(weights.len());
        }
        let row = |r: usize| &weights[starts[r]..starts[r + 1]];
        let used: Vec<usize> = (0..touched.len()).filter(|&dof| touched[dof]).collect();
        // what they move under the forces of the rows, a column for each of them: neighbours together, as they are in the matrix, and not so
        // many that what they have of it does not stay in the cache
        let mut moved = Mat::zeros(size, used.len());
        let mut together = vec![0.0; TOGETHER * size];
        let mut place = 0;
        for some in used.chunk_by(|a, b| *b == a + 1).flat_map(|run| run.chunks(TOGETHER)) {
            let (dofs, values) = (some[0]..some[0] + some.len(), &mut together[..some.len() * size]);
            values.fill(0.0);
            let of_rows = values.chunks_exact_mut(some.len()).enumerate();
            of_rows.for_each(|(r, values)| add_columns(nodal, dofs.clone(), row(r), values));
            for of_one in 0..some.len() {
                let values = values[of_one..].iter().step_by(some.len());
                let column = moved.col_as_slice_mut(place + of_one).iter_mut();
                column.zip(values).for_each(|(moved, value)| *moved = factor * value);
            }
            place += some.len();
        }
        let mut places = vec![0; touched.len()];
        used.iter().enumerate().for_each(|(place, &dof)| places[dof] = place);
        if let Some(factors) = product {
            let [a, b] = factors.map(|all| {
                let mut of_rows = Mat::<f64>::zeros(size, all.ncols());
                for c in 0..all.ncols() {
                    let (values, of_rows) = (all.col_as_slice(c), of_rows.col_as_slice_mut(c));
                    let of_row = |r: usize| row(r).iter().map(|&(dof, w)| w * values[dof]).sum::<f64>();
                    of_rows.iter_mut().enumerate().for_each(|(r, value)| *value = of_row(r));
                }
                of_rows
            });
            matmul(matrix.as_mut(), Accum::Add, a.as_ref(), b.transpose(), 1.0, Par::Seq);
        }
        for column in 0..size {
            let by_place: Vec<(usize, f64)> = row(column).iter().map(|&(dof, w)| (places[dof], w)).collect();
            let upper = &mut matrix.col_as_slice_mut(column)[..=column];
            add_columns(&moved, 0..column + 1, &by_place, upper);
        }
        copy_upper(matrix);
    }
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

    struct Body {
        matrix: Mat<f64>,
        factors: [Mat<f64>; 2],
    }

    impl NodalCompliance for Body {
        fn coordinates(&self) -> usize {
            self.factors[0].nrows()
        }

        fn terms(&self) -> Terms<'_> {
            let [a, b] = &self.factors;
            Terms { matrix: &self.matrix, factor: 0.8, product: Some([a, b]) }
        }
    }

    /// Source: sums over all nodes and axes as they stand in the definition, W·(0.8·C + A·Bᵀ)·Wᵀ. Goal: the compliance of points in one and
    /// in three directions, m/N, whose nodes leave gaps between each other, on either side, added to what is there already. Accuracy over the
    /// largest value: ROUNDOFF of sums of a few thousand terms in another order.
    #[test]
    fn points_see_the_compliance_of_their_nodes() {
        const ROUNDOFF: f64 = 1e-13;
        let wave = |n: usize| (1.7 * n as f64 + 0.3).sin();
        let (contact, coordinates) = (3 * NODES, 3 * NODES + 2);
        let shapes = Mat::from_fn(coordinates, 5, |r, c| wave(3 * r + 7 * c));
        let between = Mat::<f64>::from_fn(5, 5, |r, c| wave(r + c + r * c));
        let body = Body {
            matrix: Mat::from_fn(contact, contact, |r, c| wave(r + c) + wave(r * c)),
            factors: [&shapes * &between, shapes],
        };
        let whole = &body.factors[0] * body.factors[1].transpose();
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
                let value = |i: usize, k: usize| 0.8 * body.matrix[(i, k)] + whole[(i, k)];
                let sums =
                    to.iter().map(|(i, u)| from.iter().map(|(k, v)| u * v * value(*i, *k)).sum::<f64>());
                2.0 + sums.sum::<f64>()
            });
            let mut found = Mat::from_fn(size, size, |_, _| 2.0);
            BodyCompliance { compliance: &body, side }.add_to(&points, &mut found);
            let largest = exact.col_iter().flat_map(|c| c.iter()).fold(0.0_f64, |m, v| m.max(v.abs()));
            for (r, c) in (0..size).flat_map(|r| (0..size).map(move |c| (r, c))) {
                let off = (found[(r, c)] - exact[(r, c)]).abs();
                assert!(off < ROUNDOFF * largest, "{side:?} {directions} {r} {c}: {off:e} of {largest:e}");
            }
        }
    }
}
