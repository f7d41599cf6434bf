//! Dense factors.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt;
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::lu::partial_pivoting::solve::{solve_in_place, solve_in_place_scratch};
use faer::perm::Perm;
use faer::{Mat, MatMut, Par};

/// Rows of a factor at most where there is another way: twice its square are 1.6 GB.
const ROWS: usize = 10_000;

/// Whether a dense factor of so many rows is worth its memory and its time, where products with the matrix are another way.
pub(super) fn is_affordable(rows: usize, by_products: bool) -> bool {
    rows <= ROWS || !by_products
}

/// LU factor of a square matrix, on one thread, so that the number of threads changes nothing. That of a singular matrix gives
/// solutions that are not finite.
pub(super) struct DenseFactor {
    factor: Mat<f64>,
    order: Perm<usize>,
}

impl DenseFactor {
    pub fn new(mut matrix: Mat<f64>) -> Self {
        let n = matrix.nrows();
        let (mut order, mut inverse) = (vec![0; n], vec![0; n]);
        let mut memory =
            MemBuffer::new(lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Default::default()));
        let stack = MemStack::new(&mut memory);
        lu_in_place(matrix.as_mut(), &mut order, &mut inverse, Par::Seq, stack, Default::default());
        let order = Perm::new_checked(order.into_boxed_slice(), inverse.into_boxed_slice(), n);
        Self { factor: matrix, order }
    }

    /// Replaces a right-hand side by its solution.
    pub fn solve(&self, side: &mut [f64]) {
        let n = side.len();
        let request: StackReq = solve_in_place_scratch::<usize, f64>(n, 1, Par::Seq);
        let mut memory = MemBuffer::new(request);
        let right = MatMut::from_column_major_slice_mut(side, n, 1);
        let stack = MemStack::new(&mut memory);
        let (factor, order) = (self.factor.as_ref(), self.order.as_ref());
        solve_in_place(factor, factor, order, right, Par::Seq, stack);
    }
}

/// Factor of a symmetric matrix that is positive but for what an interpolation may do to it, for solutions that are nearly right: that of
/// Cholesky with single precision, which takes half of the memory and of the time, or LU.
pub(super) enum SymmetricFactor {
    Cholesky(Mat<f32>),
    General(DenseFactor),
}

impl SymmetricFactor {
    /// That of the `matrix`, which is made again where it is not positive.
    pub fn new(matrix: impl Fn() -> Mat<f64>) -> Self {
        let single =
            |matrix: Mat<f64>| Mat::from_fn(matrix.nrows(), matrix.ncols(), |r, c| matrix[(r, c)] as f32);
        let mut lower = single(matrix());
        let n = lower.nrows();
        let request = llt::factor::cholesky_in_place_scratch::<f32>(n, Par::Seq, Default::default());
        let mut memory = MemBuffer::new(request);
        let stack = MemStack::new(&mut memory);
        let done = llt::factor::cholesky_in_place(
            lower.as_mut(),
            Default::default(),
            Par::Seq,
            stack,
            Default::default(),
        );
        if done.is_ok() {
            return Self::Cholesky(lower);
        }
        drop(lower);
        Self::General(DenseFactor::new(matrix()))
    }

    /// Replaces a right-hand side by its solution.
    pub fn solve(&self, side: &mut [f64]) {
        match self {
            Self::Cholesky(lower) => {
                let n = side.len();
                // numbers of one size, whatever their unit
                let largest = side.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
                if !(largest > 0.0) {
                    return;
                }
                let mut single: Vec<f32> = side.iter().map(|value| (value / largest) as f32).collect();
                let mut memory = MemBuffer::new(llt::solve::solve_in_place_scratch::<f32>(n, 1, Par::Seq));
                let right = MatMut::from_column_major_slice_mut(&mut single, n, 1);
                llt::solve::solve_in_place(lower.as_ref(), right, Par::Seq, MemStack::new(&mut memory));
                side.iter_mut().zip(single).for_each(|(value, found)| *value = largest * f64::from(found));
            }
            Self::General(factor) => factor.solve(side),
        }
    }
}
