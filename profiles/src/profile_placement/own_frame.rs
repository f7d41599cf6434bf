//! The place of a profile of which no standard is known: from its own shape, or as it stands in its file.
//!
//! A wheel lies as its file says, with its flange back, if that was measured, in the distance of the tape circle. A rail has its highest point
//! at z = 0. Whether it is inclined in its file is seen from the sides of its head, which a rail that is not has at equal angles; a head of
//! which one side was not measured, or is worn to another angle, is taken as it stands.

use nalgebra::{Point2, Rotation2, Vector2};

use super::placed::Motion;
use crate::error::Result;
use crate::profile::ProfileCurve;
use crate::profile_file::{Action, Finding, FindingKind, MeasuredProfile, repaired};
use crate::units::MILLIMETRE;

/// Depth at which the width of a head is measured, m.
pub const WIDTH_DEPTH: f64 = 14.0 * MILLIMETRE;
/// Half of the least inclination in use, 1:40, rad: a head that is turned by less is taken as it stands.
pub const TURNED: f64 = 0.0125;
/// Roll of a head by which its place is unsure where its shape does not tell, rad: 1:40.
pub const UNSURE_ROLL: f64 = 0.025;

/// Lateral place of a wheel by which it is unsure where its flange back was not measured, m: tape circles lie 62 to 73 mm from it, most of them
/// within this about 70 mm.
pub const UNSURE_SHIFT: f64 = 3.0 * MILLIMETRE;

/// By how much a place is unsure, to either side.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Unsure {
    /// The roll of a rail's head, rad.
    pub roll: f64,
    /// The lateral place of a wheel, m. That of a rail follows from its gauge point.
    pub shift: f64,
}

/// A profile placed by its own shape.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnFrame {
    /// The profile there, with findings that say how it got there.
    pub profile: MeasuredProfile,
    /// How it was moved.
    pub motion: Motion,
    /// By how much the place is unsure.
    pub unsure: Unsure,
}

/// y at which a head crosses the level `depth` (m) below its highest point on the gauge side (first) and on the field side, m; `None` for a side that the
/// profile does not reach.
pub fn sides_of_head(points: &[Point2<f64>], depth: f64) -> [Option<f64>; 2] {
    let Some(top) = (0..points.len()).min_by(|&a, &b| points[a].y.total_cmp(&points[b].y)) else {
        return [None; 2];
    };
    let level = points[top].y + depth;
    let crossing = |a: &Point2<f64>, b: &Point2<f64>| {
        ((a.y - level) * (b.y - level) <= 0.0 && a.y != b.y)
            .then(|| a.x + (level - a.y) / (b.y - a.y) * (b.x - a.x))
    };
    let field = points[top..].windows(2).find_map(|pair| crossing(&pair[0], &pair[1]));
    let gauge = points[..=top].windows(2).rev().find_map(|pair| crossing(&pair[0], &pair[1]));
    [gauge, field]
}

/// How far a side of a head leans outwards on its way down, rad: the mean direction of its steep part; `None` where that is shorter than
/// 5 mm. `outwards` is -1 for the gauge side and 1 for the field side.
fn lean(points: &[Point2<f64>], outwards: f64) -> Option<f64> {
    /// Steepness from which a surface is the side, degrees from the horizontal, and to which it is not yet the underside.
    const STEEP: [f64; 2] = [78.0, 100.0];
    const SHORTEST: f64 = 5.0 * MILLIMETRE;
    let curve = ProfileCurve::from_points(points, &[]).ok()?;
    let top = (0..points.len()).min_by(|&a, &b| points[a].y.total_cmp(&points[b].y))?;
    let side = curve.followed(curve.closest(&points[top]).0, outwards);
    let steep = side.iter().filter(|place| (STEEP[0]..=STEEP[1]).contains(&place.descent));
    let steep: Vec<Point2<f64>> = steep.map(|place| place.point).collect();
    let [first, last] = [steep.first()?, steep.last()?];
    if last.y - first.y < SHORTEST {
        return None;
    }
    // least squares of y over z
    let mean = steep.iter().fold(Vector2::zeros(), |sum, p| sum + p.coords) / steep.len() as f64;
    let [cross, square] = steep.iter().fold([0.0; 2], |[cross, square], p| {
        let d = p.coords - mean;
        [cross + d.x * d.y, square + d.y * d.y]
    });
    Some((outwards * cross / square).atan())
}

/// By how much a head is turned towards the track centre in its file, rad, if its two sides tell.
fn turned(points: &[Point2<f64>]) -> Option<f64> {
    /// Inclination of the sides of heads of rails, rad: vertical to 1:16, with 0.5° of form and scatter.
    const SIDES: [f64; 2] = [-0.009, 0.071];
    let [gauge, field] = [-1.0, 1.0].map(|side| lean(points, side));
    let (gauge, field) = (gauge?, field?);
    let own = 0.5 * (gauge + field);
    (SIDES[0]..=SIDES[1]).contains(&own).then_some(0.5 * (field - gauge))
}

/// The rail in the frame of a body with a head of the given width at 14 mm below its top (m): highest point at z = 0, axis at y = 0.
///
/// # Errors
/// [`crate::error::InputError`] for a profile that cannot be repaired.
pub fn rail_in_own_frame(profile: &MeasuredProfile, width: f64) -> Result<OwnFrame> {
    let points: Vec<Point2<f64>> = repaired(profile, &mut Vec::new())?.iter().map(|p| p.point).collect();
    let seen = turned(&points);
    let angle = seen.filter(|angle| angle.abs() > TURNED).unwrap_or(0.0);
    let turn = Rotation2::new(angle);
    let upright: Vec<Point2<f64>> = points.iter().map(|p| turn * p).collect();
    let top = upright.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let across = match sides_of_head(&upright, WIDTH_DEPTH) {
        // the field side is the one that wear leaves alone; a head wider than the body's keeps its middle
        [Some(gauge), Some(field)] if field - gauge < width => field - 0.5 * width,
        [Some(gauge), Some(field)] => 0.5 * (gauge + field),
        [None, Some(field)] => field - 0.5 * width,
        [Some(gauge), None] => gauge + 0.5 * width,
        [None, None] => {
            let ends = upright
                .iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| [low.min(p.x), high.max(p.x)]);
            0.5 * (ends[0] + ends[1])
        }
    };
    let motion = Motion { mirrored: false, angle, translation: Vector2::new(-across, -top) };
    let unsure = Unsure { roll: if seen.is_some() { 0.5 * TURNED } else { UNSURE_ROLL }, shift: 0.0 };
    let mut placed = moved(profile, &motion);
    let how = match seen {
        Some(_) if angle != 0.0 => format!(
            "its sides show that the head is inclined by 1:{:.1} in its file: turned upright",
            1.0 / angle.tan()
        ),
        Some(_) => "its sides show that the head is upright in its file".to_owned(),
        None => "its sides do not show whether the head is inclined in its file: taken as upright".to_owned(),
    };
    let text = format!(
        "{how}; moved by ({:.3}, {:.3}) mm to the top and the axis of the body that is assumed; the roll is unsure by \u{b1}{:.1} degrees",
        motion.translation.x / MILLIMETRE,
        motion.translation.y / MILLIMETRE,
        unsure.roll.to_degrees()
    );
    placed.findings.push(Finding::new(FindingKind::Aligned, Action::Noted, text));
    Ok(OwnFrame { profile: placed, motion, unsure })
}

/// The wheel with its tape circle, which is `tape_circle` (m) from the flange back, at y = 0: where the back was measured, from there, and else as
/// it stands.
///
/// # Errors
/// [`crate::error::InputError`] for a profile that cannot be repaired.
pub fn wheel_in_own_frame(profile: &MeasuredProfile, tape_circle: f64) -> Result<OwnFrame> {
    let points: Vec<Point2<f64>> = repaired(profile, &mut Vec::new())?.iter().map(|p| p.point).collect();
    let off = flange_back(&points).map(|back| -tape_circle - back);
    let across = off.filter(|off| off.abs() > UNSURE_SHIFT).unwrap_or(0.0);
    let shifted: Vec<Point2<f64>> = points.iter().map(|p| Point2::new(p.x + across, p.y)).collect();
    // a tread that lies elsewhere only because y did
    let down = if across == 0.0 { 0.0 } else { -height_at_tape_circle(&shifted).unwrap_or(0.0) };
    let motion = Motion { mirrored: false, angle: 0.0, translation: Vector2::new(across, down) };
    let mut placed = moved(profile, &motion);
    let text = match off {
        Some(off) if across != 0.0 => format!(
            "the flange back is {:.2} mm from where a tape circle {:.2} mm off it has it: moved there",
            off / MILLIMETRE,
            tape_circle / MILLIMETRE
        ),
        Some(_) => "the flange back lies where the origin of the file says".to_owned(),
        None => {
            "the flange back was not measured: the origin of the file is taken for the tape circle".to_owned()
        }
    };
    let shift = if off.is_none() { UNSURE_SHIFT } else { 0.0 };
    placed.findings.push(Finding::new(FindingKind::Aligned, Action::Noted, text));
    Ok(OwnFrame { profile: placed, motion, unsure: Unsure { roll: 0.0, shift } })
}

/// y of the back of a flange: the median over its vertical part behind the tip; `None` where less than 3 mm of it were measured.
fn flange_back(points: &[Point2<f64>]) -> Option<f64> {
    const SHORTEST: f64 = 3.0 * MILLIMETRE;
    /// Across this much the points of a vertical face lie, m.
    const FLAT: f64 = 0.3 * MILLIMETRE;
    let tip = (0..points.len()).max_by(|&a, &b| points[a].y.total_cmp(&points[b].y))?;
    let behind = &points[..tip];
    let least = behind.iter().map(|p| p.x).fold(f64::INFINITY, f64::min);
    let face: Vec<&Point2<f64>> = behind.iter().filter(|p| p.x < least + FLAT).collect();
    let [low, high] =
        face.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| [low.min(p.y), high.max(p.y)]);
    if high - low < SHORTEST {
        return None;
    }
    let mut across: Vec<f64> = face.iter().map(|p| p.x).collect();
    across.sort_unstable_by(f64::total_cmp);
    Some(across[across.len() / 2])
}

fn height_at_tape_circle(points: &[Point2<f64>]) -> Option<f64> {
    let pair = points.windows(2).find(|pair| pair[0].x <= 0.0 && pair[1].x > 0.0)?;
    Some(pair[0].y - pair[0].x / (pair[1].x - pair[0].x) * (pair[1].y - pair[0].y))
}

/// A profile moved; findings about its origin that the reader left are answered by its place.
fn moved(profile: &MeasuredProfile, motion: &Motion) -> MeasuredProfile {
    let mut moved = profile.clone();
    moved.points.iter_mut().for_each(|p| p.point = motion.apply(&p.point));
    moved.findings.retain(|f| f.action != Action::Left || f.kind != FindingKind::Origin);
    moved
}
