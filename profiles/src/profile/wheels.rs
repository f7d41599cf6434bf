//! Standard wheel profiles: from their zone formulas, or from tables of lines and arcs (folder `wheels`, each with its source).
//!
//! Source: S1002 and the 1/40 profile of EN 13715 (UIC 510-2). The published zones of S1002 meet with steps of up
//! to 0.12 µm; half of each step (in value and slope) is taken up on either side of the joint within 2 mm, so that
//! the curve and its tangent are continuous. The flange of S1002 can be higher than the 28 mm of its formulas, and
//! thinner than their 32.5 mm, but not thicker.

use nalgebra::{Point2, Vector2};

use super::curve::ProfileCurve;
use super::flange::{NOMINAL_THICKNESS, THROAT_RADIUS};
use super::lines_and_arcs::{self, Overrides};
use super::segment::{EndlessLine, Segment};
use super::spline::Piece;
use crate::error::{InputError, Result};
use crate::field::InputField;
use crate::units::MILLIMETRE;

pub use super::flange::Flange;

/// A standard wheel profile.
pub struct StandardWheel {
    /// Name, spelled as the standard does.
    pub name: &'static str,
    /// What it is and, where that is not sure, what was assumed.
    pub description: &'static str,
    definition: Definition,
}

/// How a profile is defined.
enum Definition {
    /// S1002, by formulas for zones.
    S1002,
    /// The cone 1:40 of EN 13715.
    Cone1In40,
    /// A table of lines and arcs.
    Table(&'static str),
}

/// A profile of a table in the folder `wheels`.
macro_rules! table {
    ($name:literal, $description:expr) => {
        StandardWheel {
            name: $name,
            description: $description,
            definition: Definition::Table(include_str!(concat!("wheels/", $name, ".csv"))),
        }
    };
}

/// The standard wheel profiles. Sources and checks: `data/profiles/README.md`.
pub const STANDARD_WHEELS: [StandardWheel; 8] = [
    StandardWheel {
        name: "S1002",
        description: "wheel, EN 13715; flange height 28, 30 or 32 mm, thickness 28.5 to 32.5 mm",
        definition: Definition::S1002,
    },
    StandardWheel {
        name: "EN13715-1in40",
        description: "wheel, EN 13715 cone 1:40; flange height 28, 30 or 32 mm, thickness 28.5 to 33 mm",
        definition: Definition::Cone1In40,
    },
    table!("LMA", "wheel of Chinese high-speed trains, flange 28 mm, 1:40"),
    table!(
        "APTA120",
        "wheel, APTA PR-M-S-015-06 legacy, narrow flange, 1:20; tape circle assumed 72.231 mm from the flange back"
    ),
    table!(
        "APTA140",
        "wheel, APTA PR-M-S-015-06 legacy, narrow flange, 1:40; tape circle assumed 72.231 mm from the flange back"
    ),
    table!(
        "APTA140M",
        "wheel, APTA PR-M-S-015-06, narrow flange, 1:40; tape circle assumed 72.231 mm from the flange back"
    ),
    table!(
        "APTA220",
        "wheel, APTA PR-M-S-015-06, narrow flange, 1:20; tape circle assumed 72.231 mm from the flange back"
    ),
    table!(
        "APTA240",
        "wheel, APTA PR-M-S-015-06, narrow flange, 1:40; tape circle assumed 72.231 mm from the flange back"
    ),
];

/// Their names.
pub const WHEEL_NAMES: [&str; STANDARD_WHEELS.len()] = {
    let mut names = [""; STANDARD_WHEELS.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = STANDARD_WHEELS[i].name;
        i += 1;
    }
    names
};

/// Largest step of the samples, mm.
const STEP: f64 = 0.1;
/// Length over which a step between published zones is taken up, mm.
const BLEND: f64 = 2.0;

/// Zone limits of S1002, y in mm from the tape circle.
mod limit {
    pub const FLANGE_BACK: f64 = -70.0;
    pub const H_G: f64 = -62.764_705_882;
    pub const G_F: f64 = -49.662_510_381;
    pub const F_E: f64 = -39.764_473_993;
    pub const E_D: f64 = -38.426_669_071;
    pub const D_C: f64 = -35.0;
    pub const C_B: f64 = -26.0;
    /// End T1 of what a thinner flange moves with it.
    pub const MOVED_END: f64 = -0.5;
    pub const B_A: f64 = 32.157_96;
    pub const CHAMFER: f64 = 60.0;
}

/// Coefficients of the zones B and C, z in mm = Σ c_k y^k.
const ZONE_B: [f64; 9] = [
    0.0,
    -3.358_537_058e-2,
    1.565_681_624e-3,
    -2.810_427_944e-5,
    5.844_240_864e-8,
    -1.562_379_023e-8,
    5.309_217_349e-15,
    -5.957_839_843e-12,
    2.646_656_573e-13,
];
const ZONE_C: [f64; 8] = [
    -4.320_221_063e3,
    -1.038_384_026e3,
    -1.065_501_873e2,
    -6.051_367_875,
    -2.054_332_446e-1,
    -4.169_739_389e-3,
    -4.687_195_829e-5,
    -2.252_755_540e-7,
];

/// Running surface of the standard wheel profile `name`, one of [`WHEEL_NAMES`], from the flange back over the
/// flange tip, the throat and the tread to the start of the chamfer.
///
/// # Errors
/// [`InputError`] for an unknown name.
///
/// ```
/// let s1002 = railspring_profiles::profile::wheels::wheel_profile("S1002")?;
/// let s = s1002.s_at_y(0.0).unwrap();
/// // At the tape circle the tread lies at the origin and is inclined by 1:29.8.
/// assert!(s1002.point(s).coords.norm() < 1e-9);
/// assert!((s1002.tangent(s).y / s1002.tangent(s).x + 0.033585).abs() < 1e-6);
/// # Ok::<(), railspring_profiles::error::Error>(())
/// ```
pub fn wheel_profile(name: &str) -> Result<ProfileCurve> {
    wheel_profile_with_flange(name, &Flange::default())
}

/// As [`wheel_profile`] with a flange of another size of the standard.
///
/// S1002 with a thinner flange: the standard moves flange, throat and the tread up to 0.5 mm before the tape circle
/// (its table C.1, D1 to T1) towards the flange back, and joins T1 to the tape circle by a straight line.
///
/// With a thickness below 32.5 mm the two halves of the flange tip cross in a ridge on its top, up to 0.17 mm below
/// the nominal height, as the standard's shift of the construction points has it.
///
/// # Errors
/// [`InputError`] for an unknown name, a flange that the standard does not have, or S1002 with a thickness above
/// 32.5 mm.
///
/// ```
/// use railspring_profiles::profile::wheels::{Flange, wheel_profile_with_flange};
/// let thin = Flange { height: 0.030, thickness: 0.030 };
/// let wheel = wheel_profile_with_flange("EN13715-1in40", &thin)?;
/// // The face lies 30 mm from the flange back, 10 mm below the tape circle.
/// let face = wheel.closest(&nalgebra::Point2::new(-0.040, 0.010));
/// assert!(face.1 < 1e-6);
/// # Ok::<(), railspring_profiles::error::Error>(())
/// ```
pub fn wheel_profile_with_flange(name: &str, flange: &Flange) -> Result<ProfileCurve> {
    let wheel = STANDARD_WHEELS.iter().find(|wheel| wheel.name == name).ok_or_else(|| {
        InputError::new(
            InputField::WheelName,
            format!("{name:?}"),
            format!("one of {}", WHEEL_NAMES.join(", ")),
            "choose a known profile",
        )
    })?;
    match wheel.definition {
        Definition::S1002 => Ok(ProfileCurve::from_pieces(s1002(flange)?)),
        Definition::Cone1In40 => Ok(ProfileCurve::from_pieces(cone_1_in_40(flange)?)),
        Definition::Table(table) => {
            refuse_other_flanges(name, flange)?;
            Ok(lines_and_arcs::parse(name, table, &Overrides::default())?.curve())
        }
    }
}

/// A profile of lines and arcs has one flange: that of its table.
fn refuse_other_flanges(name: &str, flange: &Flange) -> Result<()> {
    let nominal = Flange::default();
    let (field, given) = if flange.height != nominal.height {
        (InputField::FlangeHeight, flange.height)
    } else if flange.thickness != nominal.thickness {
        (InputField::FlangeThickness, flange.thickness)
    } else {
        return Ok(());
    };
    InputError::refuse(
        field,
        format!("{} mm", given / MILLIMETRE),
        format!("no other flange than that of {name}"),
        "leave it out: S1002 and EN13715-1in40 have flanges of other sizes",
    )
}

/// Value and slope of a zone at y, mm.
type Zone = fn(f64) -> (f64, f64);

fn polynomial(coefficients: &[f64], y: f64) -> (f64, f64) {
    coefficients.iter().rev().fold((0.0, 0.0), |(value, slope), c| (value * y + c, slope * y + value))
}

fn zone_d(y: f64) -> (f64, f64) {
    let reach = y + 26.210_665;
    let height = (13.0f64 * 13.0 - reach * reach).sqrt();
    (16.446 - height, reach / height)
}

fn zone_c(y: f64) -> (f64, f64) {
    polynomial(&ZONE_C, y)
}

fn zone_b(y: f64) -> (f64, f64) {
    polynomial(&ZONE_B, y)
}

fn zone_a(y: f64) -> (f64, f64) {
    polynomial(&[1.364_323_640, -6.666_666_7e-2], y)
}

/// An arc of the flange between two zone limits, on the side of the greater z.
fn flange_arc(centre: (f64, f64), radius: f64, y: [f64; 2]) -> Segment {
    let centre = Point2::new(centre.0, centre.1);
    let [start, end] = y.map(|y| {
        let reach = y - centre.x;
        Point2::new(y, centre.y + (radius * radius - reach * reach).max(0.0).sqrt())
    });
    Segment::arc(centre, start, end)
}

/// What has to be added near a joint to make value and slope continuous there.
struct Joint {
    y: f64,
    jump: (f64, f64),
}

impl Joint {
    fn new(y: f64, left: Zone, right: Zone) -> Self {
        let (before, after) = (left(y), right(y));
        Self { y, jump: (after.0 - before.0, after.1 - before.1) }
    }

    /// Value and slope to add at y to the zone on the left (`side` = 1) or on the right (-1) of the joint;
    /// Hermite functions of the distance from it.
    fn correction(&self, y: f64, side: f64) -> (f64, f64) {
        let t = side * (self.y - y) / BLEND;
        if t >= 1.0 {
            return (0.0, 0.0);
        }
        // The left takes half of the step up, the right half of it down; for a change of slope both take the
        // same bump.
        let value = 0.5 * (1.0 - t) * (1.0 - t) * (1.0 + 2.0 * t);
        let value_slope = 3.0 * t * (t - 1.0);
        let bump = 0.5 * BLEND * t * (1.0 - t) * (1.0 - t);
        let bump_slope = 0.5 * (1.0 - t) * (1.0 - 3.0 * t);
        (
            side * self.jump.0 * value - self.jump.1 * bump,
            -self.jump.0 * value_slope / BLEND + side * self.jump.1 * bump_slope,
        )
    }
}

fn graph_piece(zone: impl Fn(f64) -> (f64, f64), from: f64, to: f64) -> Piece {
    // The steepest graph falls by 2.75: a third of the step keeps the points close enough along the curve.
    let step = if zone(from).1.abs() > 1.0 { STEP / 3.0 } else { STEP };
    let parts = ((to - from) / step).ceil() as usize;
    let tangent = |y: f64| Vector2::new(1.0, zone(y).1).normalize();
    let points = (0..=parts)
        .map(|i| from + (to - from) * i as f64 / parts as f64)
        .map(|y| Point2::new(y, zone(y).0) * MILLIMETRE)
        .collect();
    Piece { points, end_tangents: Some([tangent(from), tangent(to)]) }
}

/// Flange of S1002 in mm, up to the end of its face: the published numbers where there are, else solved for.
fn s1002_flange(flange: &Flange) -> Result<Vec<Segment>> {
    flange.shoulder_radius()?;
    let face_end = Point2::new(limit::E_D + throat_shift(flange)?, zone_d(limit::E_D).0);
    if !flange.is_nominal() {
        let mut segments = flange.shape()?.segments;
        let last = segments.len() - 1;
        segments[last] = Segment::line(segments[last].start(), face_end);
        return Ok(segments);
    }
    let arcs = [
        flange_arc((-49.5, 9.519_259_302), 20.5, [limit::FLANGE_BACK, limit::H_G]),
        flange_arc((-55.0, 16.0), 12.0, [limit::H_G, limit::G_F]),
        flange_arc((-58.558_326_413, 8.834_924_13), 20.0, [limit::G_F, limit::F_E]),
    ];
    // Zone E is the straight flange face: it joins the neighbouring zones' ends.
    let face = Segment::line(arcs[2].end(), face_end);
    Ok(arcs.into_iter().chain([face]).collect())
}

fn pieces_of(segments: &[Segment]) -> Vec<Piece> {
    segments.iter().map(|s| s.scaled(MILLIMETRE).piece(STEP * MILLIMETRE)).collect()
}

/// The 1/40 profile: R13 and R36 from the flange face to the cone 1:40 through the tape circle, and from y = 35 mm
/// the outer slope 1:15, the least of the standard's 6.7 to 15 %.
fn cone_1_in_40(flange: &Flange) -> Result<Vec<Piece>> {
    const CONE: f64 = 1.0 / 40.0;
    const OUTER: f64 = 1.0 / 15.0;
    const CONE_END: f64 = 35.0;
    const HOLLOW_RADIUS: f64 = 36.0;
    let shape = flange.shape()?;
    let throat = shape.throat_centre;
    let cone = EndlessLine::new(Point2::origin(), Vector2::new(1.0, -CONE));
    // R36 touches R13 from outside and the cone from above.
    let centre_line = cone.parallel(HOLLOW_RADIUS);
    let foot = centre_line.foot(throat);
    let half_chord = ((HOLLOW_RADIUS - THROAT_RADIUS).powi(2) - (foot - throat).norm_squared()).sqrt();
    let hollow = foot + half_chord * centre_line.direction;
    let joint = throat + THROAT_RADIUS * (throat - hollow).normalize();
    let mut segments = shape.segments;
    let face_end = segments[segments.len() - 1].end();
    let cone_start = cone.foot(hollow);
    let cone_end = Point2::new(CONE_END, -CONE * CONE_END);
    segments.push(Segment::arc(throat, face_end, joint));
    segments.push(Segment::arc(hollow, joint, cone_start));
    segments.push(Segment::line(cone_start, cone_end));
    let outer = Vector2::new(1.0, -OUTER) * (limit::CHAMFER - CONE_END);
    segments.push(Segment::line(cone_end, cone_end + outer));
    Ok(pieces_of(&segments))
}

fn s1002(flange: &Flange) -> Result<Vec<Piece>> {
    let shift = throat_shift(flange)?;
    let d_c = Joint::new(limit::D_C, zone_d, zone_c);
    let c_b = Joint::new(limit::C_B, zone_c, zone_b);
    let plus = |a: (f64, f64), b: (f64, f64)| (a.0 + b.0, a.1 + b.1);
    let mut pieces = pieces_of(&s1002_flange(flange)?);
    pieces.push(graph_piece(
        |y| plus(zone_d(y - shift), d_c.correction(y - shift, 1.0)),
        limit::E_D + shift,
        limit::D_C + shift,
    ));
    pieces.push(graph_piece(
        |y| plus(plus(zone_c(y - shift), d_c.correction(y - shift, -1.0)), c_b.correction(y - shift, 1.0)),
        limit::D_C + shift,
        limit::C_B + shift,
    ));
    let tread = |y: f64| plus(zone_b(y), c_b.correction(y, -1.0));
    if shift == 0.0 {
        pieces.push(graph_piece(tread, limit::C_B, limit::B_A));
    } else {
        let moved_end = limit::MOVED_END + shift;
        let slope = tread(limit::MOVED_END).0 / moved_end;
        pieces.push(graph_piece(|y| tread(y - shift), limit::C_B + shift, moved_end));
        pieces.push(graph_piece(|y| (slope * y, slope), moved_end, 0.0));
        pieces.push(graph_piece(tread, 0.0, limit::B_A));
    }
    pieces.push(graph_piece(zone_a, limit::B_A, limit::CHAMFER));
    Ok(pieces)
}

/// How far the throat of S1002 lies from that of the nominal thickness, mm: zero, or negative for a thinner flange.
fn throat_shift(flange: &Flange) -> Result<f64> {
    let shift = (flange.thickness - NOMINAL_THICKNESS) / MILLIMETRE;
    // ROUNDOFF: a thickness given in mm and converted.
    if shift.abs() < 1e-9 {
        return Ok(0.0);
    }
    if shift > 0.0 {
        return InputError::refuse(
            InputField::FlangeThickness,
            format!("{} mm", flange.thickness / MILLIMETRE),
            "28.5 to 32.5 mm with S1002, whose moved part would overlap the tread beyond",
            "take a thinner flange",
        );
    }
    Ok(shift)
}
