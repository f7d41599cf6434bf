//! Stresses in a half-space below a force on its surface (J. Boussinesq 1885; formulas in K.L. Johnson, Contact Mechanics, 1985, (3.20)).

use nalgebra::Vector2;
use std::f64::consts::PI;

/// Stress (Pa) in the axes of the patch: 1 along the profile, 2 along the track, 3 into the body; 11, 22, 33, 12, 23, 31.
pub type PatchStress = [f64; 6];

/// Stress at an `offset` and `depth` from a unit force into the body, 1/m²: Johnson (3.20). It is asked for millions of times, and a division
/// takes as long as ten products.
pub(super) fn below_unit_force(offset: Vector2<f64>, z: f64, poisson: f64) -> PatchStress {
    let (x, y) = (offset.x, offset.y);
    let rho = (offset.norm_squared() + z * z).sqrt();
    let (first, sum) = (1.0 / rho, 1.0 / (rho + z));
    let third = first * first * first;
    let fifth = third * first * first;
    let compressible = 1.0 - 2.0 * poisson;
    // (1 - z/ρ)/r² = 1/(ρ·(ρ + z)), which has its value below the force, too
    let g = first * sum;
    // {(1 - z/ρ)(x² - y²)/r² + z·y²/ρ³}/r², where 1/r² goes out: y²·(z/ρ³ - 2g)/r² + g, and z/ρ³ - 2g = -r²·h
    let h = (2.0 * rho + z) * third * sum * sum;
    let normal =
        |along: f64, across: f64| compressible * (g - across * across * h) - 3.0 * z * along * along * fifth;
    let shear = 3.0 * z * z * fifth;
    [
        normal(x, y),
        normal(y, x),
        -shear * z,
        compressible * x * y * h - 3.0 * x * y * z * fifth,
        -shear * y,
        -shear * x,
    ]
    .map(|s| s * (0.5 / PI))
}

#[cfg(test)]
mod tests {
    use super::*;

    const POISSON: f64 = 0.3;

    /// Source: the equations of equilibrium, and a surface without stress around the force (Johnson, 3.2). Goal: the stresses below a
    /// force satisfy both, 1/m³ and 1/m². Accuracy: DISCRETISATION of central differences over 1e-4 of the distance.
    #[test]
    fn a_force_is_in_equilibrium() {
        const DISCRETISATION: f64 = 1e-6;
        for (x, y, z) in [(0.7, -0.4, 0.5), (0.2, 0.3, 1.0), (-1.0, 0.1, 0.2)] {
            let at = |x: f64, y: f64, z: f64| below_unit_force(Vector2::new(x, y), z, POISSON);
            let e = 1e-4;
            let [dx, dy, dz] = [
                (at(x + e, y, z), at(x - e, y, z)),
                (at(x, y + e, z), at(x, y - e, z)),
                (at(x, y, z + e), at(x, y, z - e)),
            ]
            .map(|(a, b)| -> [f64; 6] { std::array::from_fn(|i| (a[i] - b[i]) / (2.0 * e)) });
            // 11 12 13, 12 22 23, 13 23 33
            for (i, k, l) in [(0, 3, 5), (3, 1, 4), (5, 4, 2)] {
                let rest = dx[i] + dy[k] + dz[l];
                let size = dx[i].abs() + dy[k].abs() + dz[l].abs();
                assert!(rest.abs() < DISCRETISATION * (1.0 + size), "{x} {y} {z}: {rest}");
            }
            let surface = at(x, y, 1e-9);
            assert!([2, 4, 5].iter().all(|&i| surface[i].abs() < 1e-6), "{surface:?}");
        }
    }

    /// Source: the resultant over a plane. Goal: the stresses on a plane 1 m below a unit force carry it. Accuracy: DISCRETISATION, the
    /// plane ends at 60 m, where (1/60)³ of the force is missing.
    #[test]
    fn a_plane_below_carries_the_force() {
        const DISCRETISATION: f64 = 1e-4;
        let (half, count) = (60.0, 1200);
        let h = 2.0 * half / f64::from(count);
        let mut carried = [0.0; 3];
        for i in 0..count {
            for k in 0..count {
                let centre = |n: i32| (f64::from(n) + 0.5) * h - half;
                let s = below_unit_force(Vector2::new(centre(i), centre(k)), 1.0, POISSON);
                for (c, value) in carried.iter_mut().zip([-s[2], s[5], s[4]]) {
                    *c += value * h * h;
                }
            }
        }
        for (found, force) in carried.iter().zip([1.0, 0.0, 0.0]) {
            assert!((found - force).abs() < DISCRETISATION, "{carried:?}");
        }
    }
}
