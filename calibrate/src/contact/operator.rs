//! What the solver needs of the elasticity in a contact.

use faer::Mat;

/// A symmetric compliance, m/N, between the rows `direction·points + point` of a list of contact points. The solver
/// multiplies with it, and has its values only where points carry load.
pub trait ComplianceOperator: Send + Sync {
    /// Number of rows.
    fn rows(&self) -> usize;

    /// Compliance of one row alone.
    fn diagonal(&self, row: usize) -> f64;

    /// Adds the displacements under `forces` to `motion`.
    fn add_product(&self, forces: &[f64], motion: &mut [f64]);

    /// Adds the displacements under a `force` on one row to `motion`.
    fn add_column(&self, row: usize, force: f64, motion: &mut [f64]);

    /// The matrix between `rows`.
    fn block(&self, rows: &[usize]) -> Mat<f64>;

    /// The compliance between the points `ahead` and in the middle of a list that is its own mirror image along the track, each with its mirror image: a force is what both
    /// carry together, and a displacement that of the point. What a point in the middle has along the track moves nothing but itself. None where the
    /// compliance is not its own mirror image.
    fn half(&self, _ahead: &[usize]) -> Option<Box<dyn ComplianceOperator + '_>> {
        None
    }

    /// The compliance between some of the points alone (rows `direction·(number of these) + place in the list`), where its products
    /// take much less time than the square of the number of rows.
    fn among(&self, _points: &[usize]) -> Option<Box<dyn ComplianceOperator + '_>> {
        None
    }

    /// The compliance of the normal rows alone, where its products take less time than those of all rows.
    fn normal(&self) -> Option<Box<dyn ComplianceOperator + '_>> {
        None
    }

    /// Forces on all points in one direction that lead to nearly the displacements `motion` in that direction; none where that takes as long as a
    /// factor of the matrix.
    fn nearly_inverse(&self, _direction: usize, _motion: &[f64]) -> Option<Vec<f64>> {
        None
    }
}

impl ComplianceOperator for Mat<f64> {
    fn rows(&self) -> usize {
        self.nrows()
    }

    fn diagonal(&self, row: usize) -> f64 {
        self[(row, row)]
    }

    fn add_product(&self, forces: &[f64], motion: &mut [f64]) {
        for (row, &force) in forces.iter().enumerate().filter(|(_, force)| **force != 0.0) {
            self.add_column(row, force, motion);
        }
    }

    fn add_column(&self, row: usize, force: f64, motion: &mut [f64]) {
        motion.iter_mut().zip(self.col_as_slice(row)).for_each(|(m, c)| *m += c * force);
    }

    fn block(&self, rows: &[usize]) -> Mat<f64> {
        Mat::from_fn(rows.len(), rows.len(), |r, c| self[(rows[r], rows[c])])
    }
}
