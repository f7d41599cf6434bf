//! How long the waves are that smoothing halves at each point of a measurement: as long as the scatter asks for, and shorter where the points show a shape that
//! such smoothing would move.
//!
//! The intersection of confidence intervals (Goldenshluger and Nemirovski, *On spatially adaptive estimation of nonparametric regression*, Mathematical Methods
//! of Statistics 6, 1997; Katkovnik, *A new method for varying adaptive bandwidth selection*, IEEE Transactions on Signal Processing 47, 1999): the points are
//! smoothed by a ladder of wavelengths, λ and its parts by powers of √2. At each point the curve of the wavelength λ has the standard deviation
//!
//! √(σ²·h/π · 2π/λ · ∫ dx/(1 + x⁴)²) = 1.291·√(σ²·h/λ)
//!
//! where σ²·h is the density of the scatter and the integral over x > 0 is 3π√2/16. The longest wavelength counts whose interval of three
//! of these about the curve has a part in common with all shorter ones. Along the profile the wavelength changes by half of the way at most, since the spline
//! of a point reaches as far as it is long.
//!
//! On a worn gauge corner that ends in a curvature of 1/3 mm, with scatter of 10 µm at 0.2 mm, one wavelength of 6.4 mm moves the curve by up to 83 µm; this
//! way it is 25 µm, at the end of the file. On the crown nothing changes.

use std::f64::consts::SQRT_2;

use nalgebra::Vector2;

use super::MeasuredPoint;
use super::scatter::Scatter;
use super::smooth::smooth;
use crate::error::Result;

/// Half width of an interval, in standard deviations.
const SURE: f64 = 3.0;
/// Standard deviation of a smoothed point, over √(density/λ).
const DEVIATION: f64 = 1.291;
/// Shortest wavelength, in steps of the points: shorter waves are no shape.
const SHORTEST: f64 = 3.0;
/// Change of the wavelength along the profile, over the way.
const SLOPE: f64 = 0.5;

/// The wavelength (m) at each of the `points`, `longest` and less, where they have the `scatter` and the corners `kinks`.
///
/// # Errors
/// As [`smooth`].
pub(super) fn local_wavelengths(
    points: &[MeasuredPoint],
    kinks: &[usize],
    scatter: &Scatter,
    longest: f64,
) -> Result<Vec<f64>> {
    let ladder: Vec<f64> = std::iter::successors(Some(longest), |wavelength| Some(wavelength / SQRT_2))
        .take_while(|&wavelength| wavelength == longest || wavelength > SHORTEST * scatter.step)
        .collect();
    let curve = |wavelength: f64| -> Result<Vec<MeasuredPoint>> {
        Ok(smooth(points, kinks, &vec![wavelength; points.len()])?.points)
    };
    let curves = ladder.iter().rev().map(|&wavelength| curve(wavelength)).collect::<Result<Vec<_>>>()?;
    let mut chosen: Vec<f64> = (0..points.len())
        .map(|i| {
            let normal = normal(&curves[0], i);
            let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
            let shapes = |(curve, wavelength): (&Vec<MeasuredPoint>, f64)| {
                let place = (curve[i].point - curves[0][i].point).dot(&normal);
                let unsure = SURE * DEVIATION * (scatter.density / wavelength).sqrt();
                (low, high) = (low.max(place - unsure), high.min(place + unsure));
                (low <= high).then_some(wavelength)
            };
            let longest_common = curves.iter().zip(ladder.iter().rev().copied()).map_while(shapes).last();
            longest_common.unwrap_or(ladder[ladder.len() - 1])
        })
        .collect();
    let limit = |chosen: &mut [f64], from: usize, to: usize| {
        let way = (points[to].point - points[from].point).norm();
        chosen[to] = chosen[to].min(chosen[from] + SLOPE * way);
    };
    (1..chosen.len()).for_each(|i| limit(&mut chosen, i - 1, i));
    (1..chosen.len()).rev().for_each(|i| limit(&mut chosen, i, i - 1));
    Ok(chosen)
}

/// A unit vector across the line at one of its points.
fn normal(points: &[MeasuredPoint], i: usize) -> Vector2<f64> {
    let along = points[(i + 1).min(points.len() - 1)].point - points[i.saturating_sub(1)].point;
    Vector2::new(-along.y, along.x).normalize()
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;
    use railspring_testing::Random;

    use super::*;
    use crate::units::MILLIMETRE;

    /// Points 0.2 mm apart on a parabola of 300 mm radius that joins an arc of `radius` (m), scattered by `deviation` (m).
    fn joined(radius: f64, deviation: f64, random: &mut Random) -> (Vec<MeasuredPoint>, Scatter, usize) {
        let step = 0.2 * MILLIMETRE;
        let (mut place, mut angle) = (Point2::new(0.0, 0.0), 0.0_f64);
        let (mut points, joint) = (Vec::new(), 150);
        for i in 0..300 {
            let across = Vector2::new(-angle.sin(), angle.cos());
            let point = place + across * (deviation * random.normal());
            points.push(MeasuredPoint { point, line: i + 1, weight: 1.0 });
            // the arc turns by a right angle, then the line goes straight on
            let curvature = if i < joint { 1.0 / 0.3 } else { 1.0 / radius };
            let turned = angle - 0.1;
            angle += if i >= joint && turned > std::f64::consts::FRAC_PI_2 { 0.0 } else { curvature * step };
            place += Vector2::new(angle.cos(), angle.sin()) * step;
        }
        (points, Scatter { deviation, density: deviation * deviation * step, step, together: 1 }, joint)
    }

    /// Goal: where the line has a radius of 3 mm the wavelength is at most half of that of the scatter, 15 mm away from the joint it is that of the scatter,
    /// and the largest error of the curve is less than half of that with one wavelength. STATISTICS: intervals of three standard deviations of some 20 independent
    /// places; twenty samples.
    #[test]
    fn sharp_arcs_are_smoothed_less() {
        let (longest, radius) = (6.4 * MILLIMETRE, 3.0 * MILLIMETRE);
        for seed in 0..20 {
            let truth = joined(radius, 0.0, &mut Random::new(seed)).0;
            let (points, scatter, joint) = joined(radius, 10e-6, &mut Random::new(seed));
            let found = local_wavelengths(&points, &[], &scatter, longest).unwrap();
            let least = found[joint..joint + 25].iter().copied().fold(f64::INFINITY, f64::min);
            assert!(least < 0.51 * longest, "{seed}: {least}");
            assert!(
                found[10..joint - 75].iter().all(|&wavelength| wavelength == longest),
                "{seed}: {found:?}"
            );
            let off = |wavelengths: &[f64]| {
                let smoothed = smooth(&points, &[], wavelengths).unwrap().points;
                let both = smoothed.iter().zip(&truth).enumerate();
                let off = both.map(|(i, (p, q))| (p.point - q.point).dot(&normal(&truth, i)).abs());
                off.skip(10).take(280).fold(0.0, f64::max)
            };
            let (own, one) = (off(&found), off(&vec![longest; points.len()]));
            assert!(own < 0.5 * one, "{seed}: {own} {one}");
        }
    }

    /// Source: the variance σ²·h/π·∫ dq/(1 + (q/q₀)⁴)² of a smoothed point. Goal: the spread of 400 samples in the middle of a line. STATISTICS: 1/√800 of the
    /// spread, 3.5 %; three times that.
    #[test]
    fn a_smoothed_point_has_its_deviation() {
        let mut random = Random::new(3);
        let (wavelength, step) = (4.0 * MILLIMETRE, 0.2 * MILLIMETRE);
        let samples = 400;
        let mut squares = 0.0;
        for _ in 0..samples {
            let points: Vec<MeasuredPoint> = (0..200_usize)
                .map(|i| {
                    let point = Point2::new(i as f64 * step, 1e-6 * random.normal());
                    MeasuredPoint { point, line: i, weight: 1.0 }
                })
                .collect();
            let smoothed = smooth(&points, &[], &vec![wavelength; points.len()]).unwrap();
            squares += smoothed.points[100].point.y.powi(2);
        }
        let expected = DEVIATION * (1e-12 * step / wavelength).sqrt();
        let found = (squares / f64::from(samples)).sqrt();
        assert!((found / expected - 1.0).abs() < 0.105, "{found} {expected}");
    }
}
