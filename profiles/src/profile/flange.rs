//! The flange of EN 13715, common to its wheel profiles: arcs, the straight face and the throat.
//!
//! The back of the flange stays where it is; a thinner or thicker flange moves the face, the throat and the outer
//! half of the tip. Source: the construction points of EN 13715:2020 for the heights 28, 30 and 32 mm. Everything
//! that follows from tangency is solved for; the standard rounds these points to 0.001 mm.

use nalgebra::{Point2, Vector2};
use serde::Serialize;

use super::segment::{EndlessLine, Segment};
use crate::error::{InputError, Result};
use crate::field::InputField;
use crate::units::MILLIMETRE;

/// Thickness for which the standard gives its construction points, m.
pub const NOMINAL_THICKNESS: f64 = 32.5 * MILLIMETRE;

/// Size of a wheel's flange.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Flange {
    /// Height of the tip below the tape circle's level, m: 28, 30 or 32 mm.
    pub height: f64,
    /// Thickness 10 mm below the tape circle's level, m: 28.5 to 33 mm.
    pub thickness: f64,
}

impl Default for Flange {
    fn default() -> Self {
        Self { height: 28.0 * MILLIMETRE, thickness: NOMINAL_THICKNESS }
    }
}

/// A flange by its construction points, mm.
pub(super) struct FlangeShape {
    /// From the flange back over the tip and the face to the throat.
    pub segments: Vec<Segment>,
    /// Centre of the throat's arc.
    pub throat_centre: Point2<f64>,
}

/// Radius of the throat.
pub(super) const THROAT_RADIUS: f64 = 13.0;
/// Centre of the throat's arc for the nominal thickness.
const THROAT_CENTRE: [f64; 2] = [-26.210_665, 16.446];
/// Inclination of the flange face.
const FACE_ANGLE: f64 = 70.0;
const FLANGE_BACK: f64 = -70.0;
/// Radius of both halves of the tip.
const TIP_RADIUS: f64 = 12.0;
const TIP_Y: f64 = -55.0;
const BACK_RADIUS: f64 = 20.5;
const BACK_CENTRE_Y: f64 = -49.5;

impl Flange {
    /// Whether this is the flange for which the formulas of the profiles are published.
    pub(super) fn is_nominal(&self) -> bool {
        *self == Self::default()
    }

    /// Radius between tip and face for the flange's height, mm.
    ///
    /// # Errors
    /// [`InputError`] for a height or thickness that the standard does not have.
    pub(super) fn shoulder_radius(&self) -> Result<f64> {
        if !(28.5..=33.0).contains(&(self.thickness / MILLIMETRE)) {
            return InputError::refuse(
                InputField::FlangeThickness,
                format!("{} mm", self.thickness / MILLIMETRE),
                "28.5 to 33 mm",
                "take a thickness of the standard; a flange worn further is a measured profile",
            );
        }
        // ROUNDOFF: a height given in mm and converted.
        const ROUNDOFF: f64 = 1e-12;
        [(28.0, 20.0), (30.0, 21.5), (32.0, 23.0)]
            .into_iter()
            .find(|(height, _)| (self.height - height * MILLIMETRE).abs() < ROUNDOFF)
            .map(|(_, radius)| radius)
            .ok_or_else(|| {
                InputError::new(
                    InputField::FlangeHeight,
                    format!("{} mm", self.height / MILLIMETRE),
                    "28, 30 or 32 mm",
                    "take a height of the standard; a higher flange of a worn wheel is a measured profile",
                )
                .into()
            })
    }

    /// The segments from the flange back to the end of the face, in mm.
    ///
    /// # Errors
    /// As [`Self::shoulder_radius`].
    pub(super) fn shape(&self) -> Result<FlangeShape> {
        let shoulder = self.shoulder_radius()?;
        let shift = (self.thickness - NOMINAL_THICKNESS) / MILLIMETRE;
        let tip_z = self.height / MILLIMETRE - TIP_RADIUS;
        let (sin, cos) = FACE_ANGLE.to_radians().sin_cos();
        let throat_centre = Point2::new(THROAT_CENTRE[0] + shift, THROAT_CENTRE[1]);
        let face_end = throat_centre - THROAT_RADIUS * Vector2::new(sin, cos);

        let inner_tip = Point2::new(TIP_Y, tip_z);
        let outer_tip = Point2::new(TIP_Y + shift, tip_z);
        // The back's arc begins on the back face in the direction of the wheel's radius and touches the tip's.
        let reach = BACK_CENTRE_Y - TIP_Y;
        let rise = ((BACK_RADIUS - TIP_RADIUS).powi(2) - reach * reach).sqrt();
        let back_centre = Point2::new(BACK_CENTRE_Y, tip_z - rise);
        let back_start = Point2::new(FLANGE_BACK, back_centre.y);
        let back_end = inner_tip + TIP_RADIUS * (inner_tip - back_centre).normalize();

        // The shoulder touches the outer half of the tip from outside and the face.
        let face = EndlessLine::new(face_end, Vector2::new(cos, -sin));
        let centre_line = face.parallel(-shoulder);
        let foot = centre_line.foot(outer_tip);
        let half_chord = ((shoulder - TIP_RADIUS).powi(2) - (foot - outer_tip).norm_squared()).sqrt();
        let shoulder_centre = foot + half_chord * centre_line.direction;
        let shoulder_start = outer_tip + TIP_RADIUS * (outer_tip - shoulder_centre).normalize();
        let face_start = face.foot(shoulder_centre);

        let mut segments = vec![Segment::arc(back_centre, back_start, back_end)];
        if shift > 0.0 {
            // The two halves of the tip are joined by a flat.
            let apexes = [inner_tip, outer_tip].map(|c| c + Vector2::new(0.0, TIP_RADIUS));
            segments.push(Segment::arc(inner_tip, back_end, apexes[0]));
            segments.push(Segment::line(apexes[0], apexes[1]));
            segments.push(Segment::arc(outer_tip, apexes[1], shoulder_start));
        } else if shift < 0.0 {
            // They cross in a ridge.
            let half = 0.5 * shift;
            let ridge = Point2::new(TIP_Y + half, tip_z + (TIP_RADIUS * TIP_RADIUS - half * half).sqrt());
            segments.push(Segment::arc(inner_tip, back_end, ridge));
            segments.push(Segment::arc(outer_tip, ridge, shoulder_start));
        } else {
            segments.push(Segment::arc(inner_tip, back_end, shoulder_start));
        }
        segments.push(Segment::arc(shoulder_centre, shoulder_start, face_start));
        segments.push(Segment::line(face_start, face_end));
        Ok(FlangeShape { segments, throat_centre })
    }
}
