//! The running surfaces of a study, for programs that want profiles beside the springs.

use nalgebra::{Point2, Vector2};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::root::bisection;
use railspring_profiles::units::MILLIMETRE;

use crate::results::bodies::geometry::{self, Geometry};
use crate::study::Study;

/// Points are at most this far apart, and a straight line between them stays as close to the surface, m.
const STEP: f64 = 0.5e-3;
const CHORD: f64 = 1e-7;

/// The study whose springs are exported, its pair in place.
pub(super) struct Surfaces<'a> {
    pub study: &'a Study,
    pub geometry: Geometry,
}

impl<'a> Surfaces<'a> {
    /// The study's surfaces; `purpose` says in the message what the study is needed for.
    ///
    /// # Errors
    /// [`InputError`] without a study; those of the geometry.
    pub fn of(study: Option<&'a Study>, purpose: &str) -> Result<Self> {
        let study = study.ok_or_else(|| {
            InputError::new(
                "--study",
                "(missing)",
                format!("the study of the springs: {purpose}, too"),
                "name it with --study STUDY.toml",
            )
        })?;
        Ok(Self { study, geometry: geometry::geometry(study.statics())? })
    }

    /// The rail in the track as its program has it: y to the field side, z down from the highest point, `y_origin` (m, from the
    /// track centre) at y = 0.
    pub fn rail(&self, y_origin: f64) -> Vec<Point2<f64>> {
        points(&self.geometry.pair.placed.curve, Vector2::new(-y_origin, 0.0))
    }

    /// The wheel: y to the field side and z down from its tape circle.
    pub fn wheel(&self) -> Vec<Point2<f64>> {
        points(&self.geometry.pair.wheel.running, Vector2::zeros())
    }

    /// Lateral place of the highest point of the rail, m from the track centre.
    pub fn top_y(&self) -> f64 {
        let curve = &self.geometry.pair.placed.curve;
        let sampled = curve.sample_adaptive(STEP, CHORD);
        let height = |i: &usize| curve.point(sampled[*i]).y;
        let Some(highest) = (0..sampled.len()).min_by(|a, b| height(a).total_cmp(&height(b))) else {
            return 0.0;
        };
        // the surface rises before it, and falls beyond it
        let [before, after] =
            [highest.saturating_sub(1), (highest + 1).min(sampled.len() - 1)].map(|i| sampled[i]);
        curve.point(bisection(before, after, |s| curve.tangent(s).y > 0.0)).x
    }

    /// What a heading says about the points.
    pub fn sentence() -> String {
        format!(
            "the lines between the points stay within {:.0e} mm of the surface, which ends with the first and the last one",
            CHORD / MILLIMETRE
        )
    }
}

fn points(curve: &ProfileCurve, shift: Vector2<f64>) -> Vec<Point2<f64>> {
    curve.sample_adaptive(STEP, CHORD).into_iter().map(|s| curve.point(s) + shift).collect()
}
