//! Systems of equations by products with their matrix and an approximate inverse of it.
//!
//! Y. Saad, M.H. Schultz, "GMRES: a generalized minimal residual algorithm for solving nonsymmetric linear systems",
//! SIAM J. Sci. Stat. Comput. 7 (1986), preconditioned from the right.

/// Residual of a solution over its right-hand side.
#[derive(Clone, Copy)]
pub(super) struct Wanted {
    /// At which the iteration ends.
    pub tolerance: f64,
    /// That is accepted after so many products as there may be.
    pub enough: f64,
    /// Products at most.
    pub products: usize,
}

/// Solution of `product(x) = side` to the residual `wanted`, with the approximate `inverse`; `None` where it does not settle.
pub(super) fn gmres(
    side: &[f64],
    wanted: Wanted,
    product: impl Fn(&[f64]) -> Vec<f64>,
    inverse: impl Fn(&[f64]) -> Vec<f64>,
) -> Option<Vec<f64>> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let size = dot(side, side).sqrt();
    if size == 0.0 {
        return Some(vec![0.0; side.len()]);
    }
    let mut basis: Vec<Vec<f64>> = vec![side.iter().map(|v| v / size).collect()];
    let mut searched: Vec<Vec<f64>> = Vec::new();
    // columns of the triangle, rotations, and the rotated right-hand side
    let (mut triangle, mut rotations, mut rotated) =
        (Vec::<Vec<f64>>::new(), Vec::<(f64, f64)>::new(), vec![size]);
    for step in 0..wanted.products {
        let direction = inverse(&basis[step]);
        let mut next = product(&direction);
        searched.push(direction);
        let mut column = Vec::with_capacity(step + 2);
        for known in &basis {
            let part = dot(known, &next);
            next.iter_mut().zip(known).for_each(|(n, k)| *n -= part * k);
            column.push(part);
        }
        let rest = dot(&next, &next).sqrt();
        for (i, (c, s)) in rotations.iter().enumerate() {
            (column[i], column[i + 1]) =
                (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
        }
        let length = column[step].hypot(rest);
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        let (c, s) = (column[step] / length, rest / length);
        rotations.push((c, s));
        column[step] = length;
        triangle.push(column);
        rotated.push(-s * rotated[step]);
        rotated[step] *= c;
        let bound = if step + 1 < wanted.products { wanted.tolerance } else { wanted.enough };
        if rotated[step + 1].abs() <= bound * size {
            let mut weights = rotated[..=step].to_vec();
            for i in (0..=step).rev() {
                weights[i] /= triangle[i][i];
                for k in 0..i {
                    weights[k] -= triangle[i][k] * weights[i];
                }
            }
            let mut x = vec![0.0; side.len()];
            for (direction, weight) in searched.iter().zip(weights) {
                x.iter_mut().zip(direction).for_each(|(x, d)| *x += weight * d);
            }
            return x.iter().all(|v| v.is_finite()).then_some(x);
        }
        basis.push(next.iter().map(|v| v / rest).collect());
    }
    None
}
