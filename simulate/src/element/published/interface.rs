//! A linear part as the iteration of a step sees it: stiffness against the displacement of its interface.

use nalgebra::{Cholesky, Matrix3, SMatrix, SVector, Vector3};

use crate::time::linear_part::LinearStep;
use railspring_profiles::error::{NumericsError, Result, StopReason};

/// A coordinate that is less flexible counts as held, m/N or rad/(N·m): 10⁵ N move it by the rounding of a millimetre.
const RIGID: f64 = 1e-24;

/// Stiffness with which held coordinates enter the system, N/m; any value of the system's order does.
const HELD: f64 = 1e9;

/// Interface of a part in directions 1, 2 and rotation 3 over one step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Interface {
    /// Displacement without forces; where a held coordinate stays.
    free: Vector3<f64>,
    /// Force per displacement from there; zeros in the rows and columns of held coordinates.
    stiffness: Matrix3<f64>,
    held: [bool; 3],
}

impl Interface {
    /// The interface of a part that stays where it is.
    pub fn held(at: Vector3<f64>) -> Self {
        Self { free: at, stiffness: Matrix3::zeros(), held: [true; 3] }
    }

    /// The interface of a part with `name` in a step.
    ///
    /// # Errors
    /// [`NumericsError`] if the flexibility is not positive definite in the coordinates that are not held.
    pub fn of(step: &impl LinearStep, name: &str) -> Result<Self> {
        let flexibility = step.flexibility();
        let flexibility = Matrix3::from_fn(|i, j| flexibility[(i, j)]);
        Self::of_flexibility(Vector3::from_column_slice(step.free()), &flexibility, name)
    }

    /// The interface of a part that moves by `flexibility` times the forces on it from where it is `free`.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn of_flexibility(free: Vector3<f64>, flexibility: &Matrix3<f64>, name: &str) -> Result<Self> {
        let held = [0, 1, 2].map(|i| flexibility[(i, i)] <= RIGID);
        // metres and radians are made comparable; a held coordinate is cut off from the others
        let scale = Vector3::from_fn(|i, _| if held[i] { 0.0 } else { 1.0 / flexibility[(i, i)].sqrt() });
        let scaled =
            Matrix3::from_fn(|i, j| if i == j { 1.0 } else { scale[i] * flexibility[(i, j)] * scale[j] });
        let factor = Cholesky::new(scaled).ok_or_else(|| {
            NumericsError::new(format!("moving solver, {name}"), StopReason::Singular, f64::NAN, 0)
        })?;
        let inverse = factor.inverse();
        let stiffness = Matrix3::from_fn(|i, j| scale[i] * inverse[(i, j)] * scale[j]);
        Ok(Self { free, stiffness, held })
    }

    /// The interface of a part that resists its displacement from `free` with a `stiffness`, which may be zero.
    pub fn of_stiffness(free: Vector3<f64>, stiffness: Matrix3<f64>) -> Self {
        Self { free, stiffness, held: [false; 3] }
    }

    /// Largest stiffness against a displacement, N/m; zero where both are held.
    pub fn largest_stiffness(&self) -> f64 {
        self.stiffness[(0, 0)].max(self.stiffness[(1, 1)])
    }

    /// Forces that move the part to `x`, directions 1, 2 and moment 3; zero at held coordinates.
    pub fn forces(&self, x: Vector3<f64>) -> Vector3<f64> {
        self.stiffness * (x - self.free)
    }

    /// Adds the part, whose coordinates are the unknowns `at`, to the balance of forces at `x`. The row of a held
    /// coordinate is replaced, whatever else stands there.
    pub fn add_to<const N: usize>(
        &self,
        at: [usize; 3],
        x: &SVector<f64, N>,
        residual: &mut SVector<f64, N>,
        matrix: &mut SMatrix<f64, N, N>,
    ) {
        let own = Vector3::from_fn(|i, _| x[at[i]]);
        let force = self.forces(own);
        for i in 0..3 {
            if self.held[i] {
                matrix.row_mut(at[i]).fill(0.0);
                matrix[(at[i], at[i])] = HELD;
                residual[at[i]] = HELD * (own[i] - self.free[i]);
            } else {
                residual[at[i]] += force[i];
                for j in 0..3 {
                    matrix[(at[i], at[j])] += self.stiffness[(i, j)];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::{Mat, MatRef};
    use nalgebra::{Matrix4, Vector4};

    /// A step with a given flexibility.
    struct Given {
        free: [f64; 3],
        flexibility: Mat<f64>,
    }

    impl LinearStep for Given {
        fn free(&self) -> &[f64] {
            &self.free
        }
        fn flexibility(&self) -> MatRef<'_, f64> {
            self.flexibility.as_ref()
        }
        fn finish(self, _: &[f64]) {}
    }

    fn given(flexibility: [[f64; 3]; 3]) -> Given {
        Given { free: [1e-4, -2e-4, 3e-4], flexibility: Mat::from_fn(3, 3, |i, j| flexibility[i][j]) }
    }

    /// Goal: the balance of a part under forces (N, N·m) has the displacement `free + flexibility·forces`, whatever the
    /// order of its unknowns and though metres and radians differ by 10⁶. A coordinate without flexibility, or with less than
    /// any force shows, stays; the others do not see it. Accuracy: ROUNDOFF of a 3x3 solution, relative.
    #[test]
    fn the_balance_gives_the_displacement_of_the_flexibility() {
        const ROUNDOFF: f64 = 1e-13;
        let (a, b, c) = (2e-9, 5e-10, 3e-3);
        let full = [[a, 0.4 * a, 1e-6], [0.4 * a, 2.0 * b, -4e-7], [1e-6, -4e-7, c]];
        let held = [[a, 0.0, 1e-6], [0.0, 0.0, 0.0], [1e-6, 0.0, c]];
        let tiny = [[1e-26, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]];
        let forces = Vector3::new(7e3, -90e3, 2.0);
        for matrix in [full, held, tiny, [[0.0; 3]; 3]] {
            let step = given(matrix);
            let part = Interface::of(&step, "test").unwrap();
            let at = [3, 0, 1];
            let (mut residual, mut system) = (Vector4::new(0.0, 0.0, 5.0, 0.0), Matrix4::zeros());
            system[(2, 2)] = 1.0;
            // what else stands in the rows
            (0..3).for_each(|i| residual[at[i]] = -forces[i]);
            part.add_to(at, &Vector4::zeros(), &mut residual, &mut system);
            let x = -system.lu().solve(&residual).unwrap();
            for i in 0..3 {
                let terms = [0, 1, 2].map(|j| step.flexibility[(i, j)] * forces[j]);
                let expected = step.free[i] + terms.iter().sum::<f64>();
                let scale = step.free[i].abs() + terms.iter().map(|t| t.abs()).sum::<f64>();
                assert!(
                    (x[at[i]] - expected).abs() < ROUNDOFF * scale,
                    "{matrix:?} {i}: {} {expected}",
                    x[at[i]]
                );
            }
            assert_eq!(x[2], -5.0);
        }
    }

    /// Goal: a flexibility that no linear part has is an error with the part's name: indefinite, or not a number.
    #[test]
    fn an_impossible_flexibility_is_an_error() {
        let indefinite = [[1e-9, 2e-9, 0.0], [2e-9, 1e-9, 0.0], [0.0, 0.0, 1e-6]];
        let unknown = [[f64::NAN, 0.0, 0.0], [0.0, 1e-9, 0.0], [0.0, 0.0, 1e-6]];
        for matrix in [indefinite, unknown] {
            let error = Interface::of(&given(matrix), "rail").unwrap_err();
            assert!(error.to_string().contains("moving solver, rail"), "{error}");
        }
    }
}
