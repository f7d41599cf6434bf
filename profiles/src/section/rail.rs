//! The rail's cross-section.

use nalgebra::Point2;

use super::join::{Joined, join};
use super::properties::{AreaProperties, area_moments};
use super::vertices::{FILLET_STEP, close, thinned};
use crate::error::Result;
use crate::field::InputField;
use crate::profile::rails::{RailOutline, rail_outline, running_curve};
use crate::profile::{ProfileCurve, Segment, polyline};
use crate::profile_file::Finding;

/// Cross-section of a rail in its profile frame: y to the field side, z down, origin at the top on the axis.
#[derive(Debug, Clone, PartialEq)]
pub struct RailSection {
    /// Name of the section.
    pub name: String,
    /// From the lower end of the straight gauge side over the crown to the lower end of the field side.
    pub running: ProfileCurve,
    /// The rest of the closed outline as vertices, m: from the end of `running` under the head, along web and
    /// foot, back to its start. The ends are those of `running`, bit for bit; vertices on arcs are at most 2 mm
    /// apart, straight parts have their ends only.
    pub body: Vec<Point2<f64>>,
    /// The lines and arcs of which `body` holds the vertices.
    pub body_outline: Vec<Segment>,
    /// Height of the rail, m.
    pub height: f64,
    /// Area, centroid and second moments; torsion and shear are the finite elements' of `railspring_calibrate::section_analysis`.
    pub area: AreaProperties,
    /// Of a measured surface the arc lengths of `running` (m) at which the standard surface ends, the measured one begins and ends, and the
    /// standard one goes on; between are the transitions.
    pub seams: Option<[f64; 4]>,
}

/// The standard section `name`, one of [`crate::profile::rails::RAIL_NAMES`]; "UIC60" is the UIC60 head on the web
/// and foot of 60E1.
///
/// Area, centroid and second moments are integrated over the outline.
///
/// # Errors
/// [`crate::error::InputError`] for an unknown name.
///
/// ```
/// let rail = railspring_profiles::section::rail_section("60E1")?;
/// assert!((rail.area.area - 76.70e-4).abs() < 1e-7);
/// assert_eq!(rail.body[0], rail.running.point(rail.running.length()));
/// # Ok::<(), railspring_profiles::error::Error>(())
/// ```
pub fn rail_section(name: &str) -> Result<RailSection> {
    Ok(rail_section_of(name, rail_outline(name)?))
}

/// The section of any outline of lines and arcs, called `name`: as [`rail_section`].
pub fn rail_section_of(name: &str, outline: RailOutline) -> RailSection {
    rail_section_on(name, running_curve(&outline), outline.rest)
}

/// The section of a running surface and the `rest` of its outline, which goes on from the end of `running` back to its start.
///
/// The vertices of the body are those of `rest` at least 1 mm apart, as shorter edges would make flat elements; the integrals take all
/// of `rest`.
pub fn rail_section_on(name: &str, running: ProfileCurve, rest: Vec<Segment>) -> RailSection {
    let mut body = thinned(polyline(&rest, FILLET_STEP));
    close(&mut body, &running);
    let height = rest.iter().map(|s| s.end().y).fold(0.0, f64::max);
    let moments = area_moments(&running, &rest);
    let area = AreaProperties {
        area: moments.area,
        centroid_height: height - moments.centroid.y,
        ixx: moments.zz,
        iyy: moments.yy,
    };
    RailSection { name: name.to_owned(), running, body, body_outline: rest, height, area, seams: None }
}

/// The section of a measured head on the section `standard`: the running surface is the measured one, joined
/// to the standard's with continuous tangents; web, foot and the underside of the head are the standard's. The
/// head has to be in the frame of the section (origin at the unworn top, on the axis).
///
/// What was done is added to `findings`.
///
/// # Errors
/// [`crate::error::InputError`] with the field `rail_profile` for a head whose ends do not lie near the standard surface.
pub fn rail_section_with_head(
    standard: RailSection,
    head: &ProfileCurve,
    findings: &mut Vec<Finding>,
) -> Result<RailSection> {
    let Joined { curve: running, seams } = join(&standard.running, head, InputField::RailProfile, findings)?;
    let name = format!("measured head on {}", standard.name);
    Ok(RailSection { seams: Some(seams), ..rail_section_on(&name, running, standard.body_outline) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// MODEL: the published values are rounded to four or five digits, and the drawing's to 0.001 mm.
    const MODEL: f64 = 1e-3;

    fn near(value: f64, published: f64) {
        assert!((value / published - 1.0).abs() < MODEL, "{value:.6e} against the published {published:.6e}");
    }

    /// Source: EN 13674-1 (60E1): A 76.70 cm², centroid 80.92 mm, Ixx 3038.3 cm⁴, Iyy 512.3 cm⁴. Goal: the
    /// built outline. Accuracy: 0.1 %.
    #[test]
    fn properties_of_60e1_are_the_published_ones() {
        let p = rail_section("60E1").unwrap().area;
        near(p.area, 76.70e-4);
        near(p.centroid_height, 80.92e-3);
        near(p.ixx, 3038.3e-8);
        near(p.iyy, 512.3e-8);
    }

    /// The UIC60 variant differs from 60E1 by its head alone: 0.0161 cm² more (own sum over the arcs).
    #[test]
    fn uic60_head_on_60e1_differs_a_little() {
        let (uic, en) = (rail_section("UIC60").unwrap().area, rail_section("60E1").unwrap().area);
        let difference = uic.area - en.area;
        assert!((1.0e-6..2.5e-6).contains(&difference), "{difference:e}");
    }

    #[test]
    fn body_closes_the_outline() {
        for &name in crate::profile::rails::RAIL_NAMES.iter() {
            let rail = rail_section(name).unwrap();
            assert_eq!(rail.body[0], rail.running.point(rail.running.length()));
            assert_eq!(rail.body[rail.body.len() - 1], rail.running.point(0.0));
            let shortest = rail.body.windows(2).map(|w| (w[1] - w[0]).norm()).fold(f64::INFINITY, f64::min);
            assert!(shortest > 1e-3, "a body edge of {shortest} m would make a sliver element");
        }
    }

    #[test]
    fn unknown_rail_is_refused() {
        let message = rail_section("60E9").unwrap_err().to_string();
        assert!(message.contains("rail_name") && message.contains("60E1, UIC60"), "{message}");
    }
}
