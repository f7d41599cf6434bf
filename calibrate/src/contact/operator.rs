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

    /// The compliance between some of the points alone (rows `direction·(number of these) + place in the list`), where its products
    /// take much less time than the square of the number of rows.
    fn among(&self, _points: &[usize]) -> Option<Box<dyn ComplianceOperator + '_>> {
        None
    }
}

/// The normal rows of a compliance with three directions.
pub(super) struct NormalRows<C> {
    pub compliance: C,
    /// Number of points.
    pub points: usize,
}

impl<C: std::ops::Deref<Target: ComplianceOperator> + Send + Sync> NormalRows<C> {
    fn extended(&self, values: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; 3 * self.points];
        all[..self.points].copy_from_slice(values);
        all
    }
}

impl<C: std::ops::Deref<Target: ComplianceOperator> + Send + Sync> ComplianceOperator for NormalRows<C> {
    fn rows(&self) -> usize {
        self.points
    }

    fn diagonal(&self, row: usize) -> f64 {
        self.compliance.diagonal(row)
    }

    fn add_product(&self, forces: &[f64], motion: &mut [f64]) {
        let mut all = self.extended(motion);
        self.compliance.add_product(&self.extended(forces), &mut all);
        motion.copy_from_slice(&all[..self.points]);
    }

    fn add_column(&self, row: usize, force: f64, motion: &mut [f64]) {
        let mut all = self.extended(motion);
        self.compliance.add_column(row, force, &mut all);
        motion.copy_from_slice(&all[..self.points]);
    }

    fn block(&self, rows: &[usize]) -> Mat<f64> {
        self.compliance.block(rows)
    }

    fn among(&self, points: &[usize]) -> Option<Box<dyn ComplianceOperator + '_>> {
        let compliance = self.compliance.among(points)?;
        Some(Box::new(NormalRows { compliance, points: points.len() }))
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
