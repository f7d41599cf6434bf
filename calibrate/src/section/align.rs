//! Turning and moving a measured rail head onto its standard section.

use nalgebra::{Matrix3, Point2, Rotation2, Vector2, Vector3};

use crate::error::{Error, NumericsError, Result, StopReason};
use crate::profile::ProfileCurve;
use crate::units::MILLIMETRE;

/// Distance of the points that are compared, m.
const STEP: f64 = 0.3 * MILLIMETRE;
/// Points further off than this many times the median distance do not count: wear must not pull.
const TRIM: f64 = 3.0;
/// Distances below this always count, m.
const ALWAYS: f64 = 0.01 * MILLIMETRE;
/// Change at which the iteration ends, m (and rad · 50 mm).
const SETTLED: f64 = 1e-10;

/// A rigid motion: point' = R(angle) · point + translation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alignment {
    /// Rotation, rad, from y towards z.
    pub angle: f64,
    /// Translation, m.
    pub translation: Vector2<f64>,
    /// RMS distance of the points that count, m.
    pub rms: f64,
    /// Share of the points that count.
    pub share: f64,
}

/// The motion that lays `measured` onto `standard`, both rail heads: least squares of the distances, from which
/// points that lie far off (worn places) are left out.
///
/// # Errors
/// [`NumericsError`] when the motion does not settle.
pub fn align_rail(measured: &ProfileCurve, standard: &ProfileCurve) -> Result<Alignment> {
    const MOST_ITERATIONS: usize = 200;
    let points = measured.sample(STEP);
    let mut motion =
        Alignment { angle: 0.0, translation: first_guess(&points, standard), rms: 0.0, share: 1.0 };
    let mut change = f64::INFINITY;
    for _ in 0..MOST_ITERATIONS {
        let turn = Rotation2::new(motion.angle);
        let feet: Vec<(Point2<f64>, Vector2<f64>, f64)> = points
            .iter()
            .filter_map(|p| {
                let moved = turn * p + motion.translation;
                let (s, _) = standard.closest(&moved);
                // A foot at an end belongs to a point beyond it.
                let inside = s > 0.0 && s < standard.length();
                let normal = standard.upward_normal(s);
                inside.then(|| (moved, normal, (moved - standard.point(s)).dot(&normal)))
            })
            .collect();
        let mut distances: Vec<f64> = feet.iter().map(|foot| foot.2.abs()).collect();
        distances.sort_unstable_by(f64::total_cmp);
        let Some(median) = distances.get(distances.len() / 2) else { break };
        let limit = ALWAYS.max(TRIM * median);
        let (mut matrix, mut rhs) = (Matrix3::zeros(), Vector3::zeros());
        let (mut sum, mut count) = (0.0, 0usize);
        for (p, normal, distance) in feet.iter().filter(|foot| foot.2.abs() <= limit) {
            // A turn about the origin moves the point by (-z, y).
            let row = Vector3::new(normal.x, normal.y, normal.y * p.x - normal.x * p.y);
            matrix += row * row.transpose();
            rhs -= row * *distance;
            sum += distance * distance;
            count += 1;
        }
        let Some(step) = matrix.cholesky().map(|factor| factor.solve(&rhs)) else { break };
        let turn = Rotation2::new(step.z);
        motion.angle += step.z;
        motion.translation = turn * motion.translation + step.xy();
        motion.rms = (sum / count.max(1) as f64).sqrt();
        motion.share = count as f64 / points.len() as f64;
        change = step.xy().norm() + 50.0 * MILLIMETRE * step.z.abs();
        if change < SETTLED {
            return Ok(motion);
        }
    }
    Err(Error::Numerics(NumericsError {
        stage: "alignment of the rail head".into(),
        step: None,
        iteration: MOST_ITERATIONS,
        residual: change,
        active: points.len(),
        reason: StopReason::IterationLimit,
    }))
}

/// Brings the tops to the same height, and the middle between the two sides onto the axis.
fn first_guess(points: &[Point2<f64>], standard: &ProfileCurve) -> Vector2<f64> {
    const DEPTH: f64 = 12.0 * MILLIMETRE;
    let top = points.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let standard_top = standard.sample(STEP).iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let crossing = |pair: &[Point2<f64>]| (pair[0].y - top - DEPTH) * (pair[1].y - top - DEPTH) <= 0.0;
    let gauge = points.windows(2).find(|pair| crossing(pair)).map(|pair| pair[0].x);
    let field = points.windows(2).rev().find(|pair| crossing(pair)).map(|pair| pair[1].x);
    let middle = match (gauge, field) {
        (Some(gauge), Some(field)) if field > gauge => 0.5 * (gauge + field),
        _ => points.iter().map(|p| p.x).sum::<f64>() / points.len() as f64,
    };
    Vector2::new(-middle, standard_top - top)
}
