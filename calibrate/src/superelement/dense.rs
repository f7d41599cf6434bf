//! What the machine can do at best: the dense product, with which the speed of a factorisation is compared.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};
use std::time::Instant;

/// Multiplications a second of dense products on one thread, as a factorisation has it: the fastest of several products of square matrices
/// of `size` rows, which go on for a quarter of a second.
///
/// ```
/// assert!(railspring_calibrate::superelement::product_speed(64) > 0.0);
/// ```
pub fn product_speed(size: usize) -> f64 {
    const SECONDS: f64 = 0.25;
    let size = size.max(1);
    let factors = [0.7, 0.3].map(|by| Mat::from_fn(size, size, |i, j| (by * (i + 2 * j) as f64).sin()));
    let mut product = Mat::<f64>::zeros(size, size);
    let begun = Instant::now();
    let mut fastest = f64::INFINITY;
    while begun.elapsed().as_secs_f64() < SECONDS {
        let one = Instant::now();
        let [a, b] = factors.each_ref().map(Mat::as_ref);
        matmul(product.as_mut(), Accum::Replace, a, b, 1.0, Par::Seq);
        fastest = fastest.min(one.elapsed().as_secs_f64());
    }
    // so that no product is left out
    std::hint::black_box(&product);
    (size as f64).powi(3) / fastest
}
