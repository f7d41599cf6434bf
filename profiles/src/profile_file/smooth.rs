//! The smoothing spline.
//!
//! Minimises Σ w |p - g|² Δs + ∫ μ |g''|² ds over the curves g (Reinsch 1967): waves of the length λ are halved for
//! μ = (λ/2π)⁴, longer ones are kept, shorter ones removed. On an arc of the radius R it moves the line by μ/R³:
//! with λ = 2 mm and R = 13 mm by 0.005 µm. The wavelength may change along the line.
//!
//! The spline has no curvature at its ends, which would move the end of an arc by κ·(λ/2π)²: with λ = 6 mm and R = 13 mm by 0.07 mm. So
//! the line is carried on beyond its ends, corners included, by the parabola through the last points over the length λ.

use nalgebra::{Point2, Vector2};

use super::measured::MeasuredPoint;
use crate::error::{InputError, Result};
use crate::parabola::Parabola;
use crate::units::MILLIMETRE;

/// Weight of a point that holds its place, against one of an ordinary point.
const HELD: f64 = 1e9;

/// Smoothed points, and how far the measured ones lie from them.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed {
    /// The points on the smoothing spline, one for each measured one.
    pub points: Vec<MeasuredPoint>,
    /// Largest distance of a point from its measured place, m.
    pub largest: f64,
    /// Line of that point.
    pub largest_line: usize,
    /// Root mean square of the distances, m.
    pub rms: f64,
}

/// Smooths a profile; waves of the length that `wavelengths` (m) has at each point are halved there. The points of `kinks` keep their places, so
/// that corners stay sharp.
///
/// # Errors
/// [`InputError`] for a wavelength that is not positive or above 20 mm, and points on top of each other.
pub fn smooth(points: &[MeasuredPoint], kinks: &[usize], wavelengths: &[f64]) -> Result<Smoothed> {
    const LONGEST: f64 = 20.0 * MILLIMETRE;
    let suits = |wavelength: f64| wavelength > 0.0 && wavelength <= LONGEST;
    if let Some(wavelength) = wavelengths.iter().find(|&&wavelength| !suits(wavelength)) {
        return InputError::refuse(
            "smoothing",
            format!("{} mm", wavelength / MILLIMETRE),
            format!("a wavelength above 0 and up to {} mm", LONGEST / MILLIMETRE),
            "2 mm suit most measurements; 0 switches smoothing off, and without a value the scatter decides",
        );
    }
    let stiffness = |wavelength: &f64| (wavelength / MILLIMETRE / std::f64::consts::TAU).powi(4);
    let mut smoothed = points.to_vec();
    let mut start = 0;
    for end in kinks.iter().copied().chain([points.len().saturating_sub(1)]) {
        if end > start + 1 {
            let held = [start != 0, end + 1 != points.len()];
            let piece = &mut smoothed[start..=end];
            let reversed: Vec<MeasuredPoint> = piece.iter().rev().copied().collect();
            let mut line = carried_on(piece, wavelengths[start], held[0]);
            line.reverse();
            let first = line.len();
            line.extend_from_slice(piece);
            let last = line.len() - 1;
            line.extend(carried_on(&reversed, wavelengths[end], held[1]));
            let fixed = [held[0].then_some(first), held[1].then_some(last)];
            let own = (0..line.len()).map(|i| (start + i).saturating_sub(first).clamp(start, end));
            let stiffness: Vec<f64> = own.map(|i| stiffness(&wavelengths[i])).collect();
            smooth_piece(&mut line, &stiffness, fixed)?;
            piece.copy_from_slice(&line[first..=last]);
        }
        start = end;
    }
    let distances: Vec<f64> = points.iter().zip(&smoothed).map(|(p, q)| (p.point - q.point).norm()).collect();
    let farthest = (0..points.len()).max_by(|&i, &j| distances[i].total_cmp(&distances[j])).unwrap_or(0);
    Ok(Smoothed {
        largest: distances.get(farthest).copied().unwrap_or(0.0),
        largest_line: points.get(farthest).map_or(0, |p| p.line),
        rms: (distances.iter().map(|d| d * d).sum::<f64>() / distances.len().max(1) as f64).sqrt(),
        points: smoothed,
    })
}

/// Points that carry a line on beyond its first point, from there on; through that point if it is `held`. None for a line that is
/// shorter than the wavelength or has few points over it.
fn carried_on(points: &[MeasuredPoint], wavelength: f64, held: bool) -> Vec<MeasuredPoint> {
    /// Fewest points of the parabola.
    const FEWEST: usize = 6;
    /// Length by which the line is carried on, in wavelengths: the end of the spline moves the line by e^(-2π/√2) there.
    const BEYOND: f64 = 1.0;
    let mut along = vec![0.0];
    for w in points.windows(2) {
        let next = along[along.len() - 1] + (w[1].point - w[0].point).norm();
        if next > wavelength {
            break;
        }
        along.push(next);
    }
    let n = along.len();
    if n < FEWEST || n == points.len() {
        return Vec::new();
    }
    let samples = along.iter().zip(points).enumerate().map(|(i, (t, p))| {
        let weight = if i == 0 && held { HELD } else { 1.0 };
        (t / wavelength, weight, p.point - points[0].point)
    });
    let Some(found) = Parabola::through(samples) else { return Vec::new() };
    let step = along[n - 1] / (n - 1) as f64;
    let count = (BEYOND * wavelength / step).ceil() as usize;
    let beyond = (1..=count).map(|k| {
        let point = points[0].point + found.at(-step * k as f64 / wavelength);
        MeasuredPoint { point, ..points[0] }
    });
    beyond.collect()
}

/// Lower band of a symmetric matrix with two sub-diagonals.
struct Band {
    diagonal: Vec<f64>,
    first: Vec<f64>,
    second: Vec<f64>,
}

/// Smooths one piece in place with the `stiffness` μ at its points; lengths in mm.
fn smooth_piece(points: &mut [MeasuredPoint], stiffness: &[f64], held: [Option<usize>; 2]) -> Result<()> {
    let n = points.len();
    let p: Vec<Vector2<f64>> = points.iter().map(|p| p.point.coords / MILLIMETRE).collect();
    let h: Vec<f64> = p.windows(2).map(|w| (w[1] - w[0]).norm()).collect();
    if let Some(i) = h.iter().position(|&h| h.is_nan() || h <= 0.0) {
        return InputError::refuse(
            "smoothing",
            format!("line {}", points[i + 1].line),
            "points apart from each other",
            "remove the repeated point",
        );
    }
    let stretch = |i: usize| 0.5 * (if i > 0 { h[i - 1] } else { 0.0 } + h.get(i).copied().unwrap_or(0.0));
    let heaviest = points.iter().map(|p| p.weight).fold(0.0, f64::max);
    let inverse_weight: Vec<f64> = (0..n)
        .map(|i| {
            // All points without weight means that weights are not in use.
            let own = if heaviest > 0.0 { (points[i].weight / heaviest).max(1e-6) } else { 1.0 };
            let hold = if held.contains(&Some(i)) { HELD } else { 1.0 };
            1.0 / (own * hold * stretch(i))
        })
        .collect();
    // Row k of Qᵀ takes the second difference about the inner point k + 1.
    let q = |k: usize| [1.0 / h[k], -1.0 / h[k] - 1.0 / h[k + 1], 1.0 / h[k + 1]];
    let m = n - 2;
    // The unknowns are μ·g'' at the inner points.
    let soft = |k: usize| 1.0 / stiffness[k + 1];
    let mut band = Band { diagonal: vec![0.0; m], first: vec![0.0; m], second: vec![0.0; m] };
    let mut rhs = vec![Vector2::zeros(); m];
    for k in 0..m {
        let own = q(k);
        rhs[k] = own[0] * p[k] + own[1] * p[k + 1] + own[2] * p[k + 2];
        let penalty: f64 = (0..3).map(|i| own[i] * own[i] * inverse_weight[k + i]).sum();
        band.diagonal[k] = (h[k] + h[k + 1]) / 3.0 * soft(k) + penalty;
        if k + 1 < m {
            let next = q(k + 1);
            let shared = own[1] * next[0] * inverse_weight[k + 1] + own[2] * next[1] * inverse_weight[k + 2];
            band.first[k] = h[k + 1] / 6.0 * (soft(k) * soft(k + 1)).sqrt() + shared;
        }
        if k + 2 < m {
            band.second[k] = own[2] * q(k + 2)[0] * inverse_weight[k + 2];
        }
    }
    solve(&mut band, &mut rhs);
    for i in 0..n {
        let mut pull = Vector2::zeros();
        for (row, place) in [(i, 0), (i.wrapping_sub(1), 1), (i.wrapping_sub(2), 2)] {
            if row < m {
                pull += q(row)[place] * rhs[row];
            }
        }
        let smooth = p[i] - inverse_weight[i] * pull;
        points[i].point = Point2::from(smooth * MILLIMETRE);
    }
    Ok(())
}

/// Solves the positive definite band system in place by LDLᵀ.
fn solve(band: &mut Band, rhs: &mut [Vector2<f64>]) {
    let n = rhs.len();
    let Band { diagonal, first, second } = band;
    for k in 0..n {
        let (l1, l2) = (first[k] / diagonal[k], second[k] / diagonal[k]);
        if k + 1 < n {
            diagonal[k + 1] -= l1 * first[k];
            first[k + 1] -= l1 * second[k];
            let v = rhs[k];
            rhs[k + 1] -= l1 * v;
        }
        if k + 2 < n {
            diagonal[k + 2] -= l2 * second[k];
            let v = rhs[k];
            rhs[k + 2] -= l2 * v;
        }
        first[k] = l1;
        second[k] = l2;
    }
    for k in (0..n).rev() {
        let mut value = rhs[k] / diagonal[k];
        if k + 1 < n {
            value -= first[k] * rhs[k + 1];
        }
        if k + 2 < n {
            value -= second[k] * rhs[k + 2];
        }
        rhs[k] = value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(length: f64, amplitude: f64) -> Vec<MeasuredPoint> {
        (0..=4000)
            .map(|i| {
                let y = f64::from(i) * 0.02 * MILLIMETRE;
                let z = amplitude * (std::f64::consts::TAU * y / length).sin();
                MeasuredPoint { point: Point2::new(y, z), line: i as usize + 1, weight: 1.0 }
            })
            .collect()
    }

    /// Source: the spline's response 1/(1 + (λ/L)⁴) to a wave of the length L. Goal: amplitudes far from the ends.
    /// Accuracy: MODEL, arc length for y, (2π·1e-3/2)² /4 = 2e-6 relative; DISCRETISATION, hundred points a wave,
    /// (2π/100)²/12 = 3e-4.
    #[test]
    fn a_wave_is_damped_by_its_length() {
        const DISCRETISATION: f64 = 5e-4;
        let amplitude = 1e-3 * MILLIMETRE;
        for (ratio, left) in [(1.0f64, 0.5), (2.0, 16.0 / 17.0), (0.5, 1.0 / 17.0)] {
            let wavelength = 2.0 * MILLIMETRE;
            let smoothed = smooth(&wave(ratio * wavelength, amplitude), &[], &[wavelength; 4001]).unwrap();
            let middle = &smoothed.points[1500..2500];
            let seen = middle.iter().map(|p| p.point.y).fold(0.0, f64::max);
            assert!(
                (seen / amplitude - left).abs() < DISCRETISATION * left.max(0.1) * 3.0,
                "{ratio}: {}",
                seen / amplitude
            );
        }
    }

    /// A corner that is held stays where it was; a straight line stays straight.
    #[test]
    fn corners_and_straight_lines_stay() {
        let points: Vec<MeasuredPoint> = (0..=80)
            .map(|i: usize| {
                let y = i as f64 * 0.1 * MILLIMETRE;
                let z = (i as f64 - 40.0).max(0.0) * 0.1 * MILLIMETRE;
                MeasuredPoint { point: Point2::new(y, z), line: i + 1, weight: 1.0 }
            })
            .collect();
        let kept = smooth(&points, &[40], &[2.0 * MILLIMETRE; 81]).unwrap();
        assert!(kept.largest < 1e-12, "{}", kept.largest);
        let rounded = smooth(&points, &[], &[2.0 * MILLIMETRE; 81]).unwrap();
        assert!(rounded.largest > 0.05 * MILLIMETRE && rounded.largest_line == 41, "{rounded:?}");
    }
}
