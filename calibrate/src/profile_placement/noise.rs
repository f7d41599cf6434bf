//! How much the points scatter.

use nalgebra::Point2;

/// Standard deviation (m) of the points across the profile, from the distance of each from the chord of its neighbours: a
/// smooth profile leaves h²/8R, less than a micrometre between points 0.2 mm apart on a corner of 13 mm.
pub(super) fn scatter(points: &[Point2<f64>]) -> f64 {
    /// The median of the absolute value of a normal variable of unit variance.
    const MEDIAN: f64 = 0.674_49;
    let mut distances: Vec<f64> = points
        .windows(3)
        .filter_map(|w| {
            let chord = w[2] - w[0];
            let length = chord.norm();
            if length <= 0.0 {
                return None;
            }
            let along = (w[1] - w[0]).dot(&chord) / (length * length);
            let across = chord.perp(&(w[1] - w[0])) / length;
            // The chord has part of its ends' errors.
            let factor = (1.0 + along * along + (1.0 - along) * (1.0 - along)).sqrt();
            (0.0..=1.0).contains(&along).then_some(across.abs() / factor)
        })
        .collect();
    if distances.is_empty() {
        return 0.0;
    }
    distances.sort_unstable_by(f64::total_cmp);
    distances[distances.len() / 2] / MEDIAN
}
