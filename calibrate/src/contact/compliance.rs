//! Contact forces in, change of gap and slip out.

use super::point::{ContactPoint, Side};
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

    /// The compliance between some of the coordinates.
    fn between(&self, coordinates: &[usize]) -> Mat<f64>;
}

impl NodalCompliance for Mat<f64> {
    fn coordinates(&self) -> usize {
        self.nrows()
    }

    fn between(&self, coordinates: &[usize]) -> Mat<f64> {
        let mut part = Mat::zeros(coordinates.len(), coordinates.len());
        for (c, &column) in coordinates.iter().enumerate() {
            let all = self.col_as_slice(column);
            part.col_as_slice_mut(c).iter_mut().zip(coordinates).for_each(|(value, &row)| *value = all[row]);
        }
        part
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
        // only the degrees of freedom that some point touches; the weights of a row are those from its start to the next one
        let mut local = vec![usize::MAX; self.compliance.coordinates()];
        let (mut used, mut starts, mut weights) = (Vec::new(), vec![0], Vec::new());
        for r in 0..size {
            for (dof, w) in points[r % count].row(self.side, r / count).filter(|&(_, w)| w != 0.0) {
                if local[dof] == usize::MAX {
                    local[dof] = used.len();
                    used.push(dof);
                }
                weights.push((local[dof], w));
            }
            starts.push(weights.len());
        }
        let row = |r: usize| &weights[starts[r]..starts[r + 1]];
        let compliance = self.compliance.between(&used);
        let mut response = vec![0.0; used.len()];
        for column in 0..size {
            response.fill(0.0);
            add_columns(&compliance, row(column), &mut response);
            let value = |r: usize| row(r).iter().map(|&(dof, w)| w * response[dof]).sum::<f64>();
            let upper = &mut matrix.col_as_slice_mut(column)[..=column];
            upper.iter_mut().enumerate().for_each(|(r, v)| *v += value(r));
        }
        for column in 1..size {
            for r in 0..column {
                matrix[(column, r)] = matrix[(r, column)];
            }
        }
    }
}

/// Adds columns of a matrix with their weights to a sum, several at a time.
fn add_columns(matrix: &Mat<f64>, weights: &[(usize, f64)], sum: &mut [f64]) {
    let (fours, rest) = weights.as_chunks::<4>();
    for four in fours {
        let [a, b, c, d] = four.map(|(column, _)| &matrix.col_as_slice(column)[..sum.len()]);
        let [wa, wb, wc, wd] = four.map(|(_, weight)| weight);
        for (r, value) in sum.iter_mut().enumerate() {
            *value += (wa * a[r] + wb * b[r]) + (wc * c[r] + wd * d[r]);
        }
    }
    for &(column, weight) in rest {
        sum.iter_mut().zip(matrix.col_as_slice(column)).for_each(|(value, c)| *value += weight * c);
    }
}

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
