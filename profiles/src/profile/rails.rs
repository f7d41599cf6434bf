//! Standard rails, built from the generating dimensions of their drawings.
//!
//! Source: EN 13674-1 (60E1: toe corner at y = 75 mm) and, for the light rails, EN 13674-4. The UIC60 head has the arcs
//! of the Manchester benchmark's rail, which are those of rail A of EN 15302. The 60N head has its published points, which are
//! arcs to 2e-7 mm. Everything that a drawing leaves to tangency is solved for here. `data/profiles/README.md` tells how the
//! numbers were checked.

use nalgebra::{Point2, Vector2};

use super::curve::ProfileCurve;
use super::rail_drawings::{Drawing, Neck};
use super::segment::{EndlessLine, Segment, fillet};
use crate::error::{InputError, Result};
use crate::field::InputField;
use crate::units::MILLIMETRE;

pub use super::rail_drawings::{RAIL_NAMES, STANDARD_RAILS, StandardRail};

/// A straight part of the web shorter than this is none, mm: sides whose arcs meet at the waist.
const LEAST_STRAIGHT: f64 = 1e-6;
/// Largest step of the samples of an arc, m.
const STEP: f64 = 0.2 * MILLIMETRE;

/// The exact outline of a rail in its profile frame, m.
#[derive(Debug, Clone, PartialEq)]
pub struct RailOutline {
    /// From the lower end of the straight gauge side over the crown to the lower end of the field side.
    pub running: Vec<Segment>,
    /// From there under the head, along web and foot, and back to the start.
    pub rest: Vec<Segment>,
}

/// Outline of the standard rail `name`, one of [`RAIL_NAMES`].
///
/// "UIC60" is the head of UIC 861-3 on the web and foot of 60E1: the old drawing of web and foot is not public.
/// "60N-on-60E1" is the head of the Chinese 60N on the same.
///
/// # Errors
/// [`InputError`] for an unknown name.
///
/// ```
/// let outline = railspring_profiles::profile::rails::rail_outline("60E1")?;
/// let side_end = outline.running[outline.running.len() - 1].end();
/// assert!((side_end.x - 37.04858e-3).abs() < 1e-8);
/// # Ok::<(), railspring_profiles::error::Error>(())
/// ```
pub fn rail_outline(name: &str) -> Result<RailOutline> {
    let rail = STANDARD_RAILS.iter().find(|rail| rail.name == name).ok_or_else(|| {
        InputError::new(
            InputField::RailName,
            format!("{name:?}"),
            format!("one of {}", RAIL_NAMES.join(", ")),
            "choose a known section",
        )
    })?;
    let outline = outline_of(&rail.drawing()?);
    let segments = || outline.running.iter().chain(&outline.rest);
    // arcs that do not reach each other have no number for their ends
    if segments().flat_map(|s| [s.start(), s.end()]).all(|p| p.x.is_finite() && p.y.is_finite()) {
        Ok(outline)
    } else {
        Err(rail.refuse_arcs())
    }
}

/// Outline of a drawing.
pub(super) fn outline_of(drawing: &Drawing) -> RailOutline {
    let (right_head, right_rest) = right_half(drawing);
    let scale = |segments: Vec<Segment>| segments.iter().map(|s| s.scaled(MILLIMETRE)).collect();
    RailOutline { running: scale(whole_head(&right_head)), rest: scale(whole_rest(&right_rest)) }
}

/// Running surface of a rail as a smooth curve: joints of the drawing are breakpoints, met tangentially.
pub fn running_curve(outline: &RailOutline) -> ProfileCurve {
    ProfileCurve::from_segments(&outline.running, STEP)
}

fn mirrored(half: &[Segment]) -> Vec<Segment> {
    half.iter().rev().map(|s| s.mirrored().reversed()).collect()
}

/// The whole head from its right half; the two halves of the crown become one arc.
fn whole_head(half: &[Segment]) -> Vec<Segment> {
    let mut whole = mirrored(&half[1..]);
    whole.push(through_axis(&half[0].mirrored().reversed(), &half[0]));
    whole.extend_from_slice(&half[1..]);
    whole
}

/// The rest of the outline from its right half, whose last segment ends on the axis.
fn whole_rest(half: &[Segment]) -> Vec<Segment> {
    let last = half.len() - 1;
    let mut whole = half[..last].to_vec();
    whole.push(through_axis(&half[last], &half[last].mirrored().reversed()));
    whole.extend(mirrored(&half[..last]));
    whole
}

/// One segment from two that are mirror images and meet on the axis.
fn through_axis(before: &Segment, after: &Segment) -> Segment {
    match *before {
        Segment::Line { start, .. } => Segment::line(start, after.end()),
        Segment::Arc { centre, radius, start_angle, sweep } => {
            Segment::Arc { centre, radius, start_angle, sweep: 2.0 * sweep }
        }
    }
}

/// Right half in mm: the head from the axis to the lower end of the side, and the rest down to the axis.
fn right_half(drawing: &Drawing) -> (Vec<Segment>, Vec<Segment>) {
    let Drawing { head, fishing_slope, web, foot } = drawing;
    // Each centre of the head lies on the line from the previous centre through the joint.
    let mut arcs = Vec::new();
    let mut centre = Point2::new(0.0, head.radii[0]);
    let mut start = Point2::origin();
    for (i, &joint) in head.joints.iter().enumerate() {
        let radius = head.radii[i];
        let reach = joint - centre.x;
        let joint = Point2::new(joint, centre.y - (radius * radius - reach * reach).sqrt());
        arcs.push(Segment::arc(centre, start, joint));
        centre += (1.0 - head.radii[i + 1] / radius) * (joint - centre);
        start = joint;
    }
    let side_outward = Vector2::new(1.0, -head.side_slope).normalize();
    let corner_end = centre + head.radii[head.joints.len()] * side_outward;
    arcs.push(Segment::arc(centre, start, corner_end));

    let side = EndlessLine::new(corner_end, Vector2::new(head.side_slope, 1.0));
    let under_head = EndlessLine::new(Point2::new(0.0, head.apex), Vector2::new(-1.0, *fishing_slope));
    let lower_corner = fillet(&side, &under_head, head.lower_corner);
    arcs.push(Segment::line(corner_end, lower_corner.start()));

    let mut rest = vec![lower_corner];
    let upper = neck(&under_head, web.half_thickness, &web.upper, -1.0);
    let foot_slope = EndlessLine::new(Point2::new(0.0, foot.apex), Vector2::new(-1.0, -fishing_slope));
    let lower: Vec<Segment> =
        neck(&foot_slope, web.half_thickness, &web.lower, 1.0).iter().rev().map(Segment::reversed).collect();
    rest.push(Segment::line(rest[0].end(), upper[0].start()));
    let upper_end = upper[upper.len() - 1].end();
    rest.extend(upper);
    if lower[0].start().y - upper_end.y > LEAST_STRAIGHT {
        rest.push(Segment::line(upper_end, lower[0].start()));
    }
    rest.extend(lower);

    let inner_top = EndlessLine::new(Point2::new(0.0, foot.apex), Vector2::new(1.0, *fishing_slope));
    let edge = |depth: f64| {
        let corner = Point2::new(foot.half_width, depth);
        (corner, EndlessLine::new(corner, Vector2::new(0.0, 1.0)))
    };
    let bottom = EndlessLine::new(Point2::new(0.0, foot.bottom), Vector2::new(-1.0, 0.0));
    let mut corners = Vec::new();
    let toe = match &foot.outer {
        Some(outer) => {
            let (corner, toe) = edge(outer.corner_depth);
            let outer_top = EndlessLine::new(corner, Vector2::new(1.0, outer.slope));
            corners.push(fillet(&inner_top, &outer_top, outer.bend));
            corners.push(fillet(&outer_top, &toe, foot.toe[0]));
            toe
        }
        None => {
            let (_, toe) = edge(foot.bottom);
            corners.push(fillet(&inner_top, &toe, foot.toe[0]));
            toe
        }
    };
    corners.push(fillet(&toe, &bottom, foot.toe[1]));
    for arc in corners {
        rest.push(Segment::line(rest[rest.len() - 1].end(), arc.start()));
        rest.push(arc);
    }
    rest.push(Segment::line(rest[rest.len() - 1].end(), bottom.point));
    (arcs, rest)
}

/// The arcs from a sloping line (travelled inwards) to the thinnest place of the web; `outwards` is -1 for the
/// upper neck (towards the head) and 1 for the lower one.
fn neck(slope: &EndlessLine, half_thickness: f64, shape: &Neck, outwards: f64) -> Vec<Segment> {
    let Some(side) = &shape.side else {
        let side = EndlessLine::new(Point2::new(half_thickness, 0.0), Vector2::new(0.0, -outwards));
        return vec![fillet(slope, &side, shape.fillet)];
    };
    let web_centre = Point2::new(half_thickness + side.radius, side.depth);
    let waist = Point2::new(half_thickness, side.depth);
    // An arc of radius `r` inside one of `radius` about `centre`, touching both it and the slope: its centre lies
    // on the slope's parallel, the difference of the radii from `centre`; of the two the one further in is meant.
    let touching = |r: f64, centre: Point2<f64>, radius: f64| {
        let centre_line = slope.parallel(outwards * r);
        let foot = centre_line.foot(centre);
        let half_chord = ((radius - r).powi(2) - (foot - centre).norm_squared()).sqrt();
        foot + half_chord * centre_line.direction
    };
    // Where an arc about `inner` touches the larger one about `outer` from inside.
    let joint = |inner: Point2<f64>, r: f64, outer: Point2<f64>| inner + r * (inner - outer).normalize();
    let Some(middle) = &shape.middle else {
        let centre = touching(shape.fillet, web_centre, side.radius);
        let end = joint(centre, shape.fillet, web_centre);
        return vec![Segment::arc(centre, slope.foot(centre), end), Segment::arc(web_centre, end, waist)];
    };
    let gap = side.radius - middle.radius;
    let middle_centre = Point2::new(
        web_centre.x - (gap * gap - middle.rise * middle.rise).sqrt(),
        web_centre.y + outwards * middle.rise,
    );
    let centre = touching(shape.fillet, middle_centre, middle.radius);
    let middle_start = joint(centre, shape.fillet, middle_centre);
    let middle_end = joint(middle_centre, middle.radius, web_centre);
    vec![
        Segment::arc(centre, slope.foot(centre), middle_start),
        Segment::arc(middle_centre, middle_start, middle_end),
        Segment::arc(web_centre, middle_end, waist),
    ]
}
