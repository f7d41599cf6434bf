//! What the scatter of a measurement leaves in its curve, by the grouped jackknife (Tukey 1958; Efron, *The jackknife, the bootstrap and
//! other resampling plans*, 1982, chapter 3).
//!
//! A quarter of the points is left out, another one each time, and the rest is smoothed as all of them are. What follows from such a curve has the
//! variance (3/4)·Σ (θᵢ − mean)² from the scatter of the points. Nothing is assumed of how the points scatter. Neighbours whose errors are alike are left out
//! together.

use nalgebra::Point2;

use super::measured::MeasuredPoint;
use super::smooth::smooth;
use crate::error::Result;
use crate::profile::ProfileCurve;

/// Parts of the points, of which one at a time is left out.
pub const REPLICATES: usize = 4;
/// Fewest points that tell anything with a quarter left out.
const FEWEST: usize = 40;

/// The curves without a part of the `points` each. Both ends and the corners, `kinks`, stay. Points that are left out together are `together` neighbours;
/// waves of the length that `wavelengths` (m) has at each point are halved. Empty where there are too few points, or where those that stay make no curve,
/// as beside a spike.
///
/// # Errors
/// As [`smooth`].
pub(super) fn replicates(
    points: &[MeasuredPoint],
    kinks: &[usize],
    together: usize,
    wavelengths: &[f64],
) -> Result<Vec<ProfileCurve>> {
    if points.len() < FEWEST * together {
        return Ok(Vec::new());
    }
    let stays = |i: usize| i == 0 || i + 1 == points.len() || kinks.contains(&i);
    let without = |part: usize| -> Result<Option<ProfileCurve>> {
        let (mut kept, mut corners) = (Vec::with_capacity(points.len()), Vec::with_capacity(kinks.len()));
        let mut waves = Vec::with_capacity(points.len());
        for (i, point) in points.iter().enumerate() {
            if kinks.contains(&i) {
                corners.push(kept.len());
            }
            if stays(i) || i / together % REPLICATES != part {
                kept.push(*point);
                waves.push(wavelengths[i]);
            }
        }
        let smoothed = smooth(&kept, &corners, &waves)?;
        let places: Vec<Point2<f64>> = smoothed.points.iter().map(|p| p.point).collect();
        Ok(ProfileCurve::from_points(&places, &corners).ok())
    };
    let curves: Result<Option<Vec<_>>> = (0..REPLICATES).map(without).collect();
    curves.map(Option::unwrap_or_default)
}

/// Standard uncertainty of what comes out as `values` with the replicates.
pub fn standard_uncertainty(values: [f64; REPLICATES]) -> f64 {
    let count = REPLICATES as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    ((count - 1.0) / count * squares).sqrt()
}

#[cfg(test)]
mod tests {
    use railspring_testing::Random;

    use super::*;
    use crate::units::MILLIMETRE;

    /// Source: the variance of the mean, σ²/n, of which the jackknife is an unbiased estimate with 3 degrees of freedom. Goal: over 4000 samples of 64 normal
    /// numbers of unit variance the mean of the squares is 1/64. Accuracy: the estimates scatter by √(2/3), their mean by 1.3 %; three times that.
    #[test]
    fn the_mean_has_its_variance() {
        const STATISTICS: f64 = 0.04;
        let mut random = Random::new(1);
        let samples = 4000;
        let mut sum = 0.0;
        for _ in 0..samples {
            let numbers: Vec<f64> = (0..64).map(|_| random.normal()).collect();
            let without = |part: usize| {
                let kept = numbers.iter().enumerate().filter(|(i, _)| i % REPLICATES != part);
                kept.map(|(_, value)| value).sum::<f64>() / 48.0
            };
            sum += standard_uncertainty(std::array::from_fn(without)).powi(2);
        }
        let found = 64.0 * sum / f64::from(samples);
        assert!((found - 1.0).abs() < STATISTICS, "{found}");
    }

    /// Goal: corners and ends are those of all points; points without scatter have four times the same line. Accuracy: ROUNDOFF of coordinates in m.
    #[test]
    fn corners_and_ends_stay() {
        const ROUNDOFF: f64 = 1e-13;
        let points: Vec<MeasuredPoint> = (0..=160)
            .map(|i: usize| {
                let y = i as f64 * 0.25 * MILLIMETRE;
                let z = (i as f64 - 81.0).max(0.0) * 0.1 * MILLIMETRE;
                MeasuredPoint { point: Point2::new(y, z), line: i + 1, weight: 1.0 }
            })
            .collect();
        for together in [1, 2] {
            let curves = replicates(&points, &[81], together, &[2.0 * MILLIMETRE; 161]).unwrap();
            assert_eq!(curves.len(), REPLICATES);
            for curve in curves {
                let off = points.iter().map(|p| curve.closest(&p.point).1).fold(0.0, f64::max);
                assert!(off < ROUNDOFF && curve.kinks().len() == 1, "{off}");
                assert!((curve.point(0.0) - points[0].point).norm() < ROUNDOFF);
            }
        }
        assert!(replicates(&points, &[], 8, &[2.0 * MILLIMETRE; 161]).unwrap().is_empty());
    }

    /// Goal: points of which two lie in one place when the spike between them is left out have no replicates, and that is no error of the file.
    #[test]
    fn a_spike_that_is_left_out_is_no_error() {
        let mut points: Vec<MeasuredPoint> = (0..=160)
            .map(|i: usize| {
                let y = i as f64 * 0.25 * MILLIMETRE;
                MeasuredPoint { point: Point2::new(y, 0.0), line: i + 1, weight: 1.0 }
            })
            .collect();
        points[42].point.y = -MILLIMETRE;
        points[43].point = points[41].point;
        assert!(replicates(&points, &[41, 43], 1, &[2.0 * MILLIMETRE; 161]).unwrap().is_empty());
    }
}
