//! Standard rails, built from the generating dimensions of their drawings.
//!
//! Source: EN 13674-1 for 60E1 (toe corner at y = 75 mm); for the UIC60 head the arcs of the Manchester
//! benchmark's rail, which are those of rail A of EN 15302. Everything that a drawing leaves to tangency is
//! solved for here. `data/profiles/README.md` tells how the numbers were checked.

use nalgebra::{Point2, Vector2};

use super::curve::ProfileCurve;
use super::segment::{EndlessLine, Segment, fillet};
use crate::error::{InputError, Result};
use crate::units::MILLIMETRE;

/// Names that [`rail_outline`] knows.
pub const RAIL_NAMES: [&str; 2] = ["60E1", "UIC60"];

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

/// What the drawing of a flat-bottom rail of the 60 family gives for its head, mm.
struct Head {
    /// Radii of the crown, the shoulder and the gauge corner.
    radii: [f64; 3],
    /// Half-widths at which the first radius gives way to the second, and the second to the third.
    joints: [f64; 2],
    /// Radius of the lower corner, between the straight side and the underside.
    lower_corner: f64,
}

const HEAD_60E1: Head = Head { radii: [300.0, 80.0, 13.0], joints: [10.228, 26.0265], lower_corner: 3.0 };
const HEAD_UIC60: Head = Head { radii: [300.0, 80.0, 13.0], joints: [10.5, 25.98804], lower_corner: 3.0 };

/// Inclination of the sides of the head.
const SIDE_SLOPE: f64 = 1.0 / 20.0;
/// Inclination of the underside of the head and of the inner top of the foot.
const FISHING_SLOPE: f64 = 1.0 / 2.75;
/// Inclination of the outer top of the foot.
const FOOT_SLOPE: f64 = 1.0 / 14.0;

/// Outline of the standard rail `name`, one of [`RAIL_NAMES`].
///
/// "UIC60" is the head of UIC 861-3 on the web and foot of 60E1: the old drawing of web and foot is not public.
///
/// # Errors
/// [`InputError`] for an unknown name.
///
/// ```
/// let outline = railspring_calibrate::profile::rails::rail_outline("60E1")?;
/// let side_end = outline.running[outline.running.len() - 1].end();
/// assert!((side_end.x - 37.04858e-3).abs() < 1e-8);
/// # Ok::<(), railspring_calibrate::error::Error>(())
/// ```
pub fn rail_outline(name: &str) -> Result<RailOutline> {
    let head = match name {
        "60E1" => HEAD_60E1,
        "UIC60" => HEAD_UIC60,
        _ => {
            return Err(InputError::new(
                "rail.profile",
                format!("{name:?}"),
                format!("one of {}", RAIL_NAMES.join(", ")),
                "choose a known section",
            )
            .into());
        }
    };
    let (right_head, right_rest) = right_half(&head);
    let scale = |segments: Vec<Segment>| segments.iter().map(|s| s.scaled(MILLIMETRE)).collect();
    Ok(RailOutline { running: scale(whole_head(&right_head)), rest: scale(whole_rest(&right_rest)) })
}

/// Running surface of a rail as a smooth curve: joints of the drawing are breakpoints, met tangentially.
pub fn running_curve(outline: &RailOutline) -> ProfileCurve {
    ProfileCurve::from_pieces(outline.running.iter().map(|s| s.piece(STEP)).collect())
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
fn right_half(head: &Head) -> (Vec<Segment>, Vec<Segment>) {
    // Crown, shoulder and corner: each centre lies on the line from the previous centre through the joint.
    let mut arcs = Vec::new();
    let mut centre = Point2::new(0.0, head.radii[0]);
    let mut start = Point2::origin();
    for i in 0..2 {
        let radius = head.radii[i];
        let reach: f64 = head.joints[i] - centre.x;
        let joint = Point2::new(head.joints[i], centre.y - (radius * radius - reach * reach).sqrt());
        arcs.push(Segment::arc(centre, start, joint));
        centre += (1.0 - head.radii[i + 1] / radius) * (joint - centre);
        start = joint;
    }
    let side_outward = Vector2::new(1.0, -SIDE_SLOPE).normalize();
    let corner_end = centre + head.radii[2] * side_outward;
    arcs.push(Segment::arc(centre, start, corner_end));

    let side = EndlessLine::new(corner_end, Vector2::new(SIDE_SLOPE, 1.0));
    let under_head = EndlessLine::new(Point2::new(0.0, 51.0), Vector2::new(-1.0, FISHING_SLOPE));
    let lower_corner = fillet(&side, &under_head, head.lower_corner);
    arcs.push(Segment::line(corner_end, lower_corner.start()));

    let mut rest = vec![lower_corner];
    // Web: R120 about a centre beyond the half thickness of 8.25, R35 with its centre 19.5 above that, then R7
    // to the underside of the head; the lower half is the same, downwards.
    let upper = neck(&under_head, 79.75, -1.0);
    let lower: Vec<Segment> = {
        let foot_slope = EndlessLine::new(Point2::new(0.0, 140.5), Vector2::new(-1.0, -FISHING_SLOPE));
        neck(&foot_slope, 111.75, 1.0).iter().rev().map(Segment::reversed).collect()
    };
    rest.push(Segment::line(rest[0].end(), upper[0].start()));
    rest.extend_from_slice(&upper);
    rest.push(Segment::line(upper[2].end(), lower[0].start()));
    rest.extend_from_slice(&lower);

    let inner_top = EndlessLine::new(Point2::new(0.0, 140.5), Vector2::new(1.0, FISHING_SLOPE));
    let outer_top = EndlessLine::new(Point2::new(75.0, 160.5), Vector2::new(1.0, FOOT_SLOPE));
    let toe = EndlessLine::new(Point2::new(75.0, 172.0), Vector2::new(0.0, 1.0));
    let bottom = EndlessLine::new(Point2::new(0.0, 172.0), Vector2::new(-1.0, 0.0));
    for arc in
        [fillet(&inner_top, &outer_top, 40.0), fillet(&outer_top, &toe, 4.0), fillet(&toe, &bottom, 2.0)]
    {
        rest.push(Segment::line(rest[rest.len() - 1].end(), arc.start()));
        rest.push(arc);
    }
    rest.push(Segment::line(rest[rest.len() - 1].end(), Point2::new(0.0, 172.0)));
    (arcs, rest)
}

/// The three arcs R7, R35, R120 from a sloping line (travelled inwards) to the straight web at the height
/// `web_end`; `outwards` is -1 for the upper neck (towards the head) and 1 for the lower one.
fn neck(slope: &EndlessLine, web_end: f64, outwards: f64) -> [Segment; 3] {
    const HALF_WEB: f64 = 8.25;
    let [r_fillet, r_middle, r_web] = [7.0, 35.0, 120.0];
    let web_centre = Point2::new(HALF_WEB + r_web, web_end);
    // Internal tangency: the centres of R35 and R120 are 85 apart.
    let (gap, rise) = (r_web - r_middle, 19.5f64);
    let middle_centre =
        Point2::new(web_centre.x - (gap * gap - rise * rise).sqrt(), web_centre.y + outwards * rise);
    // R7 lies on the web's side of the slope, 28 from the centre of R35; of the two such centres the one
    // further in is meant.
    let centre_line = slope.parallel(outwards * r_fillet);
    let foot = centre_line.foot(middle_centre);
    let half_chord = ((r_middle - r_fillet).powi(2) - (foot - middle_centre).norm_squared()).sqrt();
    let fillet_centre = foot + half_chord * centre_line.direction;
    let middle_start = fillet_centre + r_fillet * (fillet_centre - middle_centre).normalize();
    let middle_end = middle_centre + r_middle * (middle_centre - web_centre).normalize();
    [
        Segment::arc(fillet_centre, slope.foot(fillet_centre), middle_start),
        Segment::arc(middle_centre, middle_start, middle_end),
        Segment::arc(web_centre, middle_end, Point2::new(HALF_WEB, web_end)),
    ]
}
