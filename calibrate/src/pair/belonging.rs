//! Whether a condensed body is one of a pair: a compliance says nothing of the surface that it is of.

use super::bodies::ContactBody;
use super::geometry::Pair;
use super::solids::PairBody;
use crate::superelement::CondensedBody;
use nalgebra::{Point2, Point3};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::units::MILLIMETRE;

/// Largest distance of a contact node from the pair's running surface, m: 0.1 mm of a mesh from a file, and some micrometres of surfaces that
/// are smoothed otherwise ([`Pair::with_surfaces`]).
const OFF_SURFACE: f64 = 0.12e-3;
/// Largest distance of the rail's shear centre from the pair's, m: the same, as the surface places the rail.
const OFF_AXIS: f64 = 0.12e-3;

impl Pair {
    /// A condensed body as the contact of this pair sees it, with all values of its compliance.
    ///
    /// # Errors
    /// As [`Pair::check_body`].
    pub fn contact_body<'a>(&self, body: PairBody, condensed: &'a CondensedBody) -> Result<ContactBody<'a>> {
        self.check_body(body, condensed)?;
        let CondensedBody { compliance, grid, surface, .. } = condensed;
        Ok(ContactBody { compliance, grid, material: *surface, mirrored: false, beyond: None })
    }

    /// Checks that a condensed body is one of this pair: its contact nodes lie on the running surface, a rail's shear centre is where this
    /// rail has it. Webs and discs are not seen, so that a surface may have other bodies.
    ///
    /// # Errors
    /// [`InputError`] with the file of the body, what it is of, and how far it is off.
    pub fn check_body(&self, body: PairBody, condensed: &CondensedBody) -> Result<()> {
        let columns = condensed.grid.along_track.len();
        let nodes = condensed.nodes.iter().step_by(columns.max(1));
        let off = nodes.map(|node| self.off_surface(body, node)).fold(0.0, f64::max);
        let centre = condensed.section.as_ref().map(|section| section.shear_centre);
        let off_axis = centre.map_or(0.0, |centre| (centre - self.node_line()).norm());
        let allowed = match body {
            PairBody::Wheel => self.off_bodies.wheel,
            PairBody::RailOnFoot | PairBody::RailOnEnds => self.off_bodies.rail,
        };
        if off <= OFF_SURFACE + allowed && off_axis <= OFF_AXIS + allowed {
            return Ok(());
        }
        let what = match (&condensed.file, &*condensed.of) {
            (Some(file), of) => format!("{} ({of})", file.display()),
            (None, "") => format!("a body of no pair, key {}", condensed.key),
            (None, of) => of.into(),
        };
        let where_it_is = if off > OFF_SURFACE + allowed {
            format!("contact nodes up to {:.2} mm off its running surface", off / MILLIMETRE)
        } else {
            format!("its shear centre {:.2} mm off", off_axis / MILLIMETRE)
        };
        InputError::refuse(
            body.name(),
            format!("{what}: {where_it_is}"),
            format!("a body of this pair, {}", self.named(body)),
            "condense the bodies of this pair (`PairMeshes::condense`), or press it on the pair that it is of",
        )
    }

    /// A body of this pair in words.
    pub(super) fn named(&self, body: PairBody) -> String {
        match body {
            PairBody::Wheel => {
                format!("wheel {} of {:.1} mm", self.wheel.name, 2.0 * self.wheel.radius / MILLIMETRE)
            }
            PairBody::RailOnFoot | PairBody::RailOnEnds => {
                format!(
                    "{}, {} inclined by {:.2}°",
                    body.name(),
                    self.rail.name,
                    self.placed.angle.abs().to_degrees()
                )
            }
        }
    }

    /// Distance of a contact node of the mesh from the running surface, m.
    fn off_surface(&self, body: PairBody, node: &Point3<f64>) -> f64 {
        match body {
            PairBody::Wheel => {
                let radius = node.x.hypot(node.z);
                self.wheel.running.closest(&Point2::new(node.y, radius - self.wheel.radius)).1
            }
            PairBody::RailOnFoot | PairBody::RailOnEnds => {
                self.placed.curve.closest(&Point2::new(node.y, node.z)).1
            }
        }
    }
}
