//! How long the waves are that smoothing halves at each point of a measurement: as long as the scatter asks for, and shorter where the curvature jumps.
//!
//! The wavelength of the scatter suits the crown of a rail, whose curvature jumps by 9/m. Where the crown meets a worn corner it jumps by 100/m, and the wave
//! with which scatter and smoothing change the pressure least together is 0.4 times as long ([`balanced`]). The jump is seen in the
//! smoothed line itself. Its curvature has a standard deviation of √(σ²·h/π · q₀⁵ · π√2/16), 1.4/m with the wavelength of the scatter. It is a pilot estimate, as the
//! plug-in bandwidths of Ruppert, Sheather and Wand (*An effective bandwidth selector for local least squares regression*, Journal of the American Statistical
//! Association 90, 1995) have one. The first pilot has waves of one length, the others those that the one before found. Along the profile the wavelength changes
//! by half of the way at most, since the spline of a point reaches as far as it is long.

use super::measured::MeasuredPoint;
use super::scatter::Scatter;
use super::smooth::smooth;
use super::wavelength::balanced;
use crate::error::Result;

/// Pilots. The first rounds a jump and sees half of it where it is sharpest; the third changes the wavelengths by some per cent.
const PILOTS: usize = 3;
/// Shortest wavelength, in steps of the points: shorter waves are no shape.
const SHORTEST: f64 = 3.0;
/// Way on either side of a point (wavelengths) over which curvature jumps: what smoothing a jump does to the pressure is a tenth there.
const REACH: f64 = 0.5;
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
    let shortest = (SHORTEST * scatter.step).min(longest);
    let mut wavelengths = vec![longest; points.len()];
    for _ in 0..PILOTS {
        let pilot = smooth(points, kinks, &wavelengths)?.points;
        let jumps = jumps_of_curvature(&pilot, kinks, &wavelengths);
        wavelengths = jumps.iter().map(|&jump| balanced(scatter, jump).clamp(shortest, longest)).collect();
        let mut limit = |from: usize, to: usize| {
            let way = (points[to].point - points[from].point).norm();
            wavelengths[to] = wavelengths[to].min(wavelengths[from] + SLOPE * way);
        };
        (1..points.len()).for_each(|i| limit(i - 1, i));
        (1..points.len()).rev().for_each(|i| limit(i, i - 1));
    }
    Ok(wavelengths)
}

/// How much the curvature (1/m) of a line changes within [`REACH`] of each of its points; a corner is none of its curvature and ends its reach.
fn jumps_of_curvature(line: &[MeasuredPoint], kinks: &[usize], wavelengths: &[f64]) -> Vec<f64> {
    let curvature = |i: usize| {
        let [before, after] = [line[i].point - line[i - 1].point, line[i + 1].point - line[i].point];
        let turn = before.perp(&after).atan2(before.dot(&after));
        turn / (0.5 * (before.norm() + after.norm()))
    };
    let is_inner = |i: usize| i > 0 && i + 1 < line.len() && !kinks.contains(&i);
    let curvatures: Vec<Option<f64>> = (0..line.len()).map(|i| is_inner(i).then(|| curvature(i))).collect();
    let range = |i: usize| {
        let reach = REACH * wavelengths[i];
        let near = |j: &usize| (line[*j].point - line[i].point).norm() <= reach;
        let before = (0..i).rev().take_while(near).map_while(|j| curvatures[j]);
        let after = (i + 1..line.len()).take_while(near).map_while(|j| curvatures[j]);
        let all = before.chain(after).chain(curvatures[i]);
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), k| (low.min(k), high.max(k)))
    };
    (0..line.len()).map(range).map(|(low, high)| (high - low).max(0.0)).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::{Point2, Vector2};
    use railspring_testing::Random;

    use super::*;
    use crate::units::MILLIMETRE;

    /// Points 0.2 mm apart on a parabola of `crown` (m) that joins an arc of `radius` (m), scattered by `deviation` (m).
    fn joined(
        crown: f64,
        radius: f64,
        deviation: f64,
        random: &mut Random,
    ) -> (Vec<MeasuredPoint>, Scatter, usize) {
        let step = 0.2 * MILLIMETRE;
        let (mut place, mut angle) = (Point2::new(0.0, 0.0), 0.0_f64);
        let (mut points, joint) = (Vec::new(), 150);
        let at_joint = joint as f64 * step / crown;
        for i in 0..300 {
            let across = Vector2::new(-angle.sin(), angle.cos());
            let point = place + across * (deviation * random.normal());
            points.push(MeasuredPoint { point, line: i + 1, weight: 1.0 });
            // the arc turns by a right angle, then the line goes straight on
            let curvature = if i < joint { 1.0 / crown } else { 1.0 / radius };
            let turned = angle - at_joint;
            angle += if i >= joint && turned > std::f64::consts::FRAC_PI_2 { 0.0 } else { curvature * step };
            place += Vector2::new(angle.cos(), angle.sin()) * step;
        }
        (points, Scatter { deviation, density: deviation * deviation * step, step, together: 1 }, joint)
    }

    /// A unit vector across the line at one of its points.
    fn normal(points: &[MeasuredPoint], i: usize) -> Vector2<f64> {
        let along = points[(i + 1).min(points.len() - 1)].point - points[i.saturating_sub(1)].point;
        Vector2::new(-along.y, along.x).normalize()
    }

    /// Goal: where the line has a radius of 3 mm the wavelength is at most half of that of the scatter. 15 mm away from the joint it is that of the scatter,
    /// and the largest error of the curve is a quarter of that with one wavelength at most. STATISTICS: the error that is left is scatter, of 20 independent
    /// places three standard deviations at most; twenty samples.
    #[test]
    fn sharp_arcs_are_smoothed_less() {
        let (longest, radius) = (6.4 * MILLIMETRE, 3.0 * MILLIMETRE);
        for seed in 0..20 {
            let truth = joined(0.3, radius, 0.0, &mut Random::new(seed)).0;
            let (points, scatter, joint) = joined(0.3, radius, 10e-6, &mut Random::new(seed));
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
            assert!(own < 0.25 * one, "{seed}: {own} {one}");
        }
    }

    /// Source: [`balanced`] with the jump of the curvature that is drawn. Goal: at the joint of a crown of 118 mm with a corner of 11 mm, with scatter of 5 µm,
    /// the wavelength is that. Accuracy: scatter leaves curvatures a standard deviation of 0.15 of the jump to which the wavelength is balanced, of whose range about
    /// the joint two ends are seen, hence 0.5 with confidence; the wavelength goes with the power -0.4.
    #[test]
    fn a_joint_has_the_wavelength_of_its_jump() {
        let jump = 1.0 / 0.011 - 1.0 / 0.118;
        for seed in 0..20 {
            let (points, scatter, joint) = joined(0.118, 0.011, 5e-6, &mut Random::new(seed));
            let longest = super::super::wavelength::wavelength(&scatter).unwrap();
            let found = local_wavelengths(&points, &[], &scatter, longest).unwrap()[joint];
            let ratio = found / balanced(&scatter, jump);
            assert!((1.5_f64.powf(-0.4)..0.5_f64.powf(-0.4)).contains(&ratio), "{seed}: {ratio}");
        }
    }
}
