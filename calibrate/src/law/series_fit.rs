//! Fit of a power law with a linear spring in series.

use super::exponent::best_exponent;
use super::points::{Solid, check_solid};
use super::power::REFERENCE_FORCE;
use super::series::SeriesLaw;
use railspring_profiles::error::Result;

/// Fits the law to tangents and displacements of the solid, both relative at each load, by least squares: the search of [`fit_law`](crate::law::fit_law) over c,
/// with both compliances linear inside and not below zero.
///
/// # Errors
/// [`InputError`](railspring_profiles::error::InputError) for lists of different length, fewer than four points, values that are not
/// positive and finite; [`NumericsError`](railspring_profiles::error::NumericsError) if the search fails.
pub fn fit_series(solid: &[Solid]) -> Result<SeriesLaw> {
    check_solid(solid)?;
    let c = best_exponent(|c| best(solid, c).2, solid.len())?;
    let (power, spring, _) = best(solid, c);
    match power > 0.0 {
        true => SeriesLaw::new(1.0 / power, c, (spring > 0.0).then(|| 1.0 / spring)),
        // the linear spring alone, a power of exponent 0
        false => SeriesLaw::new(1.0 / spring, 0.0, None),
    }
}

/// Compliance of the power at its reference force and that of the spring (m/N) that fit best at exponent `c`, neither below zero, with the sum of
/// squares.
fn best(solid: &[Solid], c: f64) -> (f64, f64, f64) {
    // the compliance over that of the solid, and the displacement over that of the solid, are linear in both
    let rows = solid.iter().flat_map(|at| {
        let x = at.force / REFERENCE_FORCE;
        let power = x.powf(-c);
        [
            [at.tangent * power, at.tangent],
            [at.force * power / (1.0 - c) / at.displacement, at.force / at.displacement],
        ]
    });
    let rows: Vec<[f64; 2]> = rows.collect();
    let dot = |i: usize, j: usize| rows.iter().map(|row| row[i] * row[j]).sum::<f64>();
    let sum = |i: usize| rows.iter().map(|row| row[i]).sum::<f64>();
    let squares =
        |a: f64, b: f64| rows.iter().map(|row| (a * row[0] + b * row[1] - 1.0).powi(2)).sum::<f64>();
    let projection = dot(0, 1) / dot(0, 0);
    // the second column made orthogonal to the first: the two are parallel at c = 0
    let (across, length) = rows.iter().fold((0.0, 0.0), |(across, length), row| {
        let rest = row[1] - projection * row[0];
        (across + rest, length + rest * rest)
    });
    if length > 1e-12 * dot(1, 1) {
        let b = across / length;
        let a = sum(0) / dot(0, 0) - projection * b;
        if a >= 0.0 && b >= 0.0 {
            return (a, b, squares(a, b));
        }
    }
    let (a, b) = (sum(0) / dot(0, 0), sum(1) / dot(1, 1));
    let (of_a, of_b) = (squares(a, 0.0), squares(0.0, b));
    if of_a <= of_b { (a, 0.0, of_a) } else { (0.0, b, of_b) }
}
