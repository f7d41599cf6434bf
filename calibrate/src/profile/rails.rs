//! Standard rails, built from the generating dimensions of their drawings.
//!
//! Source: EN 13674-1 for 60E1 (toe corner at y = 75 mm), 60E2 and 54E1; for the UIC60 head the arcs of the Manchester
//! benchmark's rail, which are those of rail A of EN 15302. Everything that a drawing leaves to tangency is
//! solved for here. `data/profiles/README.md` tells how the numbers were checked.

use nalgebra::{Point2, Vector2};

use super::curve::ProfileCurve;
use super::segment::{EndlessLine, Segment, fillet};
use crate::error::{InputError, Result};
use crate::field::InputField;
use crate::units::MILLIMETRE;

/// Names that [`rail_outline`] knows.
pub const RAIL_NAMES: [&str; 4] = ["60E1", "UIC60", "60E2", "54E1"];

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

/// What the drawing of a flat-bottom rail gives, mm; depths count from the top of the rail.
struct Drawing {
    head: Head,
    /// Apex of the slopes of the underside of the head, on the axis.
    head_apex: f64,
    web: Web,
    foot: Foot,
}

struct Head {
    /// Radii of the arcs from the crown to the side.
    radii: &'static [f64],
    /// Half-widths at which each radius gives way to the next.
    joints: &'static [f64],
    /// Radius of the lower corner, between the straight side and the underside.
    lower_corner: f64,
}

struct Web {
    /// Half of the least thickness.
    half_thickness: f64,
    /// Radius of the sides of the web, concave.
    radius: f64,
    /// Depths of the centres of that radius: the side is straight between them.
    centres: [f64; 2],
    /// From the underside of the head into the web.
    upper: Neck,
    /// From the web into the foot.
    lower: Neck,
}

/// Concave arcs between a sloping line and the side of the web.
#[derive(Clone, Copy)]
enum Neck {
    /// A fillet alone.
    Single(f64),
    /// A fillet, then a middle arc whose centre lies `rise` beyond that of the web's side.
    Double { fillet: f64, middle: f64, rise: f64 },
}

struct Foot {
    /// Apex of the inner slopes of the top, on the axis.
    apex: f64,
    /// Radius between inner and outer slope.
    bend: f64,
    /// Inclination of the outer slope.
    outer_slope: f64,
    /// Point on which outer slope and toe would meet in a sharp corner.
    corner: [f64; 2],
    /// Radii of the upper and lower rounding of the toe.
    toe: [f64; 2],
    /// Height of the rail.
    bottom: f64,
}

const WEB_60: Web = Web {
    half_thickness: 8.25,
    radius: 120.0,
    centres: [79.75, 111.75],
    upper: Neck::Double { fillet: 7.0, middle: 35.0, rise: 19.5 },
    lower: Neck::Double { fillet: 7.0, middle: 35.0, rise: 19.5 },
};
const FOOT_60: Foot = Foot {
    apex: 140.5,
    bend: 40.0,
    outer_slope: 1.0 / 14.0,
    corner: [75.0, 160.5],
    toe: [4.0, 2.0],
    bottom: 172.0,
};

/// A rail of the 60 family with the given arcs of the head.
const fn family_60(radii: &'static [f64], joints: &'static [f64]) -> Drawing {
    Drawing { head: Head { radii, joints, lower_corner: 3.0 }, head_apex: 51.0, web: WEB_60, foot: FOOT_60 }
}

fn drawing(name: &str) -> Option<Drawing> {
    Some(match name {
        "60E1" => family_60(&[300.0, 80.0, 13.0], &[10.228, 26.0265]),
        "UIC60" => family_60(&[300.0, 80.0, 13.0], &[10.5, 25.98804]),
        "60E2" => family_60(&[200.0, 70.0, 16.0, 8.0], &[11.889, 24.4565, 35.387]),
        "54E1" => Drawing {
            head: Head { radii: &[300.0, 80.0, 13.0], joints: &[10.012, 24.8635], lower_corner: 3.0 },
            head_apex: 49.4,
            web: Web {
                half_thickness: 8.0,
                radius: 508.0,
                centres: [82.8; 2],
                upper: Neck::Double { fillet: 8.0, middle: 22.0, rise: 25.4 },
                lower: Neck::Single(16.0),
            },
            foot: Foot {
                apex: 128.8,
                bend: 20.0,
                outer_slope: 1.0 / 10.0,
                corner: [70.0, 148.0],
                toe: [3.0, 2.0],
                bottom: 159.0,
            },
        },
        _ => return None,
    })
}

/// Inclination of the sides of the head.
const SIDE_SLOPE: f64 = 1.0 / 20.0;
/// Inclination of the underside of the head and of the inner top of the foot.
const FISHING_SLOPE: f64 = 1.0 / 2.75;

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
    let drawing = drawing(name).ok_or_else(|| {
        InputError::new(
            InputField::RailName,
            format!("{name:?}"),
            format!("one of {}", RAIL_NAMES.join(", ")),
            "choose a known section",
        )
    })?;
    let (right_head, right_rest) = right_half(&drawing);
    let scale = |segments: Vec<Segment>| segments.iter().map(|s| s.scaled(MILLIMETRE)).collect();
    Ok(RailOutline { running: scale(whole_head(&right_head)), rest: scale(whole_rest(&right_rest)) })
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
    let Drawing { head, web, foot, .. } = drawing;
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
    let side_outward = Vector2::new(1.0, -SIDE_SLOPE).normalize();
    let corner_end = centre + head.radii[head.joints.len()] * side_outward;
    arcs.push(Segment::arc(centre, start, corner_end));

    let side = EndlessLine::new(corner_end, Vector2::new(SIDE_SLOPE, 1.0));
    let under_head = EndlessLine::new(Point2::new(0.0, drawing.head_apex), Vector2::new(-1.0, FISHING_SLOPE));
    let lower_corner = fillet(&side, &under_head, head.lower_corner);
    arcs.push(Segment::line(corner_end, lower_corner.start()));

    let mut rest = vec![lower_corner];
    let upper = neck(&under_head, web, web.upper, -1.0);
    let foot_slope = EndlessLine::new(Point2::new(0.0, foot.apex), Vector2::new(-1.0, -FISHING_SLOPE));
    let lower: Vec<Segment> =
        neck(&foot_slope, web, web.lower, 1.0).iter().rev().map(Segment::reversed).collect();
    rest.push(Segment::line(rest[0].end(), upper[0].start()));
    let upper_end = upper[upper.len() - 1].end();
    rest.extend(upper);
    if web.centres[0] < web.centres[1] {
        rest.push(Segment::line(upper_end, lower[0].start()));
    }
    rest.extend(lower);

    let inner_top = EndlessLine::new(Point2::new(0.0, foot.apex), Vector2::new(1.0, FISHING_SLOPE));
    let corner = Point2::new(foot.corner[0], foot.corner[1]);
    let outer_top = EndlessLine::new(corner, Vector2::new(1.0, foot.outer_slope));
    let toe = EndlessLine::new(corner, Vector2::new(0.0, 1.0));
    let bottom = EndlessLine::new(Point2::new(0.0, foot.bottom), Vector2::new(-1.0, 0.0));
    for arc in [
        fillet(&inner_top, &outer_top, foot.bend),
        fillet(&outer_top, &toe, foot.toe[0]),
        fillet(&toe, &bottom, foot.toe[1]),
    ] {
        rest.push(Segment::line(rest[rest.len() - 1].end(), arc.start()));
        rest.push(arc);
    }
    rest.push(Segment::line(rest[rest.len() - 1].end(), bottom.point));
    (arcs, rest)
}

/// The arcs from a sloping line (travelled inwards) to the thinnest place of the web; `outwards` is -1 for the
/// upper neck (towards the head) and 1 for the lower one.
fn neck(slope: &EndlessLine, web: &Web, shape: Neck, outwards: f64) -> Vec<Segment> {
    let centre_depth = web.centres[usize::from(outwards > 0.0)];
    let web_centre = Point2::new(web.half_thickness + web.radius, centre_depth);
    let waist = Point2::new(web.half_thickness, centre_depth);
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
    match shape {
        Neck::Single(r) => {
            let centre = touching(r, web_centre, web.radius);
            let end = joint(centre, r, web_centre);
            vec![Segment::arc(centre, slope.foot(centre), end), Segment::arc(web_centre, end, waist)]
        }
        Neck::Double { fillet, middle, rise } => {
            let gap = web.radius - middle;
            let middle_centre =
                Point2::new(web_centre.x - (gap * gap - rise * rise).sqrt(), web_centre.y + outwards * rise);
            let centre = touching(fillet, middle_centre, middle);
            let middle_start = joint(centre, fillet, middle_centre);
            let middle_end = joint(middle_centre, middle, web_centre);
            vec![
                Segment::arc(centre, slope.foot(centre), middle_start),
                Segment::arc(middle_centre, middle_start, middle_end),
                Segment::arc(web_centre, middle_end, waist),
            ]
        }
    }
}
