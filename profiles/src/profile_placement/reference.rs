//! What a measurement is laid against: the running surface of a standard, and the sides of its body beside it.

use nalgebra::{Point2, Vector2};

use crate::error::{InputError, Result};
use crate::profile::rails::RAIL_NAMES;
use crate::profile::wheels::WHEEL_NAMES;
use crate::profile::{ProfileCurve, Segment};
use crate::profile_file::ProfileKind;
use crate::section::{RailSection, WheelSection, rail_section, wheel_section};
use crate::units::MILLIMETRE;

/// Largest step of the samples of an arc, m.
const STEP: f64 = 0.2 * MILLIMETRE;
/// The surface of a rail that is steeper than this is side or corner, of which one half keeps its shape, rad.
const STEEP: f64 = 20.0 * std::f64::consts::PI / 180.0;
/// Length of the tread before the chamfer that rails do not reach, m.
const FIELD_END: f64 = 18.0 * MILLIMETRE;
/// Length of the table of places that wear, m for each entry.
const CELL: f64 = 0.25 * MILLIMETRE;
/// Diameter of the body of a standard wheel that is given by its name alone, m; the sides of the rim do not depend on it.
const ANY_DIAMETER: f64 = 0.92;

/// The outline of a standard as far as instruments see it, and which of its parts wear.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Name of the standard.
    pub name: String,
    /// Rail or wheel.
    pub kind: ProfileKind,
    /// The outline. A rail's is closed, from the lower end of the gauge side over the crown; a wheel's runs from the rim's
    /// back over flange, tread and chamfer down its field face.
    pub curve: ProfileCurve,
    /// Arc lengths between which it is the running surface, m.
    pub running: [f64; 2],
    /// Whether its mirror image is the same.
    pub symmetric: bool,
    /// Whether the surface keeps its shape, in cells along the outline.
    kept: Vec<bool>,
}

impl Reference {
    /// The whole outline of a rail.
    pub fn rail(section: &RailSection) -> Self {
        let rest = ProfileCurve::from_segments(&section.body_outline, STEP);
        let curve = ProfileCurve::chained(&[&section.running, &rest]);
        let steep = |s: f64| curve.tangent(s).y.abs() > STEEP.sin();
        let running = [0.0, section.running.length()];
        let kept = kept_cells(&curve, |s| s > running[1] || steep(s));
        let symmetric = curve.sample(5.0 * MILLIMETRE).iter().all(|p| {
            const SAME: f64 = 1e-8;
            curve.closest(&Point2::new(-p.x, p.y)).1 < SAME
        });
        Self { name: section.name.clone(), kind: ProfileKind::Rail, curve, running, symmetric, kept }
    }

    /// Flange back, running surface, chamfer and field face of a wheel.
    pub fn wheel(section: &WheelSection) -> Self {
        let outline = &section.body_outline;
        let sides = |segments: &[Segment]| ProfileCurve::from_segments(segments, STEP);
        let back = sides(&outline[outline.len() - 1..]);
        let field = sides(&outline[..outline.len().min(2)]);
        let curve = ProfileCurve::chained(&[&back, &section.running, &field]);
        let running = [back.length(), back.length() + section.running.length()];
        let tip = curve
            .sample_parameters(STEP)
            .into_iter()
            .max_by(|a, b| curve.point(*a).y.total_cmp(&curve.point(*b).y))
            .unwrap_or(running[0]);
        let kept = kept_cells(&curve, |s| s < tip || s > running[1] - FIELD_END);
        let name = section.name.clone();
        Self { name, kind: ProfileKind::Wheel, curve, running, symmetric: false, kept }
    }

    /// The standard rail or wheel `name`.
    ///
    /// # Errors
    /// [`InputError`] for a name that is not one of [`RAIL_NAMES`] or [`WHEEL_NAMES`].
    pub fn standard(name: &str) -> Result<Self> {
        if RAIL_NAMES.contains(&name) {
            return Ok(Self::rail(&rail_section(name)?));
        }
        if WHEEL_NAMES.contains(&name) {
            return Ok(Self::wheel(&wheel_section(name, ANY_DIAMETER)?));
        }
        let names: Vec<&str> = RAIL_NAMES.iter().chain(&WHEEL_NAMES).copied().collect();
        let expected = format!("one of {}", names.join(", "));
        InputError::refuse("standard", format!("{name:?}"), expected, "see `railspring profile list`")
    }

    /// Whether wear leaves the surface at `s` as it is: the sides, and what the other body does not reach. Of the two
    /// sides of a rail's head only one may be worn.
    pub fn keeps(&self, s: f64) -> bool {
        self.kept[((s / CELL) as usize).min(self.kept.len() - 1)]
    }

    /// Whether `s` lies on the running surface, where a worn body has less material than the standard, never more.
    pub fn runs(&self, s: f64) -> bool {
        (self.running[0]..=self.running[1]).contains(&s)
    }

    /// Unit normal out of the material.
    pub fn outward(&self, s: f64) -> Vector2<f64> {
        match self.kind {
            ProfileKind::Rail => self.curve.upward_normal(s),
            ProfileKind::Wheel => -self.curve.upward_normal(s),
        }
    }

    /// Whether `s` is an end of an open outline: what lies there lies beyond it.
    pub(super) fn ends(&self, s: f64) -> bool {
        self.kind == ProfileKind::Wheel && (s <= 0.0 || s >= self.curve.length())
    }
}

fn kept_cells(curve: &ProfileCurve, keeps: impl Fn(f64) -> bool) -> Vec<bool> {
    let count = (curve.length() / CELL).ceil().max(1.0) as usize;
    (0..count).map(|i| keeps((i as f64 + 0.5) * CELL)).collect()
}
