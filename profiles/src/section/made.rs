//! Bodies for measured surfaces whose own body is not known: a known section, moved so that its running surface goes through the ends of
//! what was measured.
//!
//! At either end of the measurement the place of the known surface is found that has the same direction: side belongs to side and corner to
//! corner, whatever the width of the head or the thickness of the flange. The way from there to the measured end is the displacement of the
//! known surface at that place; between such places it changes in proportion to the length along the surface. Where the measurement ends
//! before the corner of a head, nothing is known about the side: there the known surface is moved down or up alone. The measured surface is
//! then joined to the moved one as to any standard.
//!
//! What such a body does to the stiffness is found by pressing others in its place; it is no part of this module.

use nalgebra::{Point2, Vector2};

use super::join::trimmed;
use super::rail::{RailSection, rail_section_on, rail_section_with_head};
use super::vertices::FILLET_STEP;
use super::wheel::{WheelSection, wheel_section_on, wheel_section_with_profile};
use super::wheel_body::WheelBody;
use crate::error::{InputError, Result};
use crate::field::InputField;
use crate::profile::{Followed, ProfileCurve, Segment, polyline};
use crate::profile_file::Finding;
use crate::units::MILLIMETRE;

/// Step at which surfaces are followed, m.
const STEP: f64 = 0.25 * MILLIMETRE;
/// Directions that count as the same, degrees: with scatter, on a side that may be inclined by 1:20 or not.
const SAME_DIRECTION: f64 = 3.0;
/// Descent from which the side of a head, or its corner, is seen, degrees.
const SIDE_SEEN: f64 = 45.0;
/// Direction beyond the vertical at which the side of a head ends, degrees: more than any side leans, less than the underside of a head or of a lip.
const UNDERCUT: f64 = 20.0;
/// Slope at which the tread of a wheel ends, degrees: chamfers have 45, treads up to 16.
const CHAMFER: f64 = 25.0;
/// Place across the wheel from which a chamfer is looked for, m from the tape circle.
const FIELD_SIDE: f64 = 15.0 * MILLIMETRE;
/// Ascent behind the tip at which a flange has come to its back, degrees.
const BACK: f64 = 85.0;
/// Height above the tip up to which the back of a flange is part of the running surface, m.
const BACK_HEIGHT: f64 = 20.0 * MILLIMETRE;

/// A displacement at an arc length.
type Displaced = (f64, Vector2<f64>);

/// Arc length of the highest point, of several in a row the middle one.
fn top(curve: &ProfileCurve) -> f64 {
    let heights: Vec<(f64, f64)> =
        curve.sample_parameters(STEP).into_iter().map(|s| (s, curve.point(s).y)).collect();
    let highest = heights.iter().map(|(_, z)| *z).fold(f64::INFINITY, f64::min);
    /// Heights that differ by less are the same, m.
    const SAME: f64 = 1e-6;
    let level: Vec<f64> = heights.iter().filter(|(_, z)| *z < highest + SAME).map(|(s, _)| *s).collect();
    level[level.len() / 2]
}

/// The place among `places` that corresponds to `end`: of those with its direction the nearest in height.
fn counterpart(places: &[Followed], end: &Followed) -> Followed {
    let turn = |place: &Followed| (place.descent - end.descent).abs();
    let least = places.iter().map(turn).fold(f64::INFINITY, f64::min);
    let near = places.iter().filter(|place| turn(place) <= least.max(SAME_DIRECTION));
    let height = |place: &&Followed| (place.point.y - end.point.y).abs();
    *near.min_by(|a, b| height(a).total_cmp(&height(b))).expect("one has the least turn")
}

/// A curve moved by displacements at ascending arc lengths, in proportion between them and as at the first and last beyond.
fn moved(curve: &ProfileCurve, displaced: &[Displaced]) -> Result<ProfileCurve> {
    let mut at: Vec<f64> = curve.sample_parameters(STEP);
    at.extend(displaced.iter().map(|(s, _)| *s));
    at.sort_by(f64::total_cmp);
    at.dedup_by(|a, b| (*a - *b).abs() < 0.2 * STEP);
    let kinks = curve.kinks();
    let points: Vec<Point2<f64>> = at.iter().map(|&s| curve.point(s) + displacement(displaced, s)).collect();
    let inner = 1..at.len() - 1;
    let corners: Vec<usize> =
        inner.filter(|&i| kinks.iter().any(|kink| (at[i] - kink).abs() < 0.5 * STEP)).collect();
    ProfileCurve::from_points(&points, &corners)
}

fn displacement(displaced: &[Displaced], s: f64) -> Vector2<f64> {
    let after = displaced.partition_point(|(at, _)| *at < s);
    match (after.checked_sub(1).map(|before| displaced[before]), displaced.get(after)) {
        (Some((a, from)), Some(&(b, to))) => from + (s - a) / (b - a) * (to - from),
        (Some((_, end)), None) => end,
        (None, Some(&(_, start))) => start,
        (None, None) => Vector2::zeros(),
    }
}

/// One side of a head: where the measured surface ends, and how far the known one is from there.
struct HeadSide {
    /// Arc length of the end of what is used of the measured head.
    measured: f64,
    /// Where the known surface is displaced, and by how much.
    at: Displaced,
    /// Displacement of the lower end of the known side, across.
    below: f64,
}

fn head_side(base: &ProfileCurve, head: &ProfileCurve, sign: f64) -> HeadSide {
    let own = base.followed(top(base), sign);
    let lowest = own[own.len() - 1].point.y;
    let seen = head.followed(top(head), sign);
    let ends =
        |place: &Followed| place.descent > 90.0 + UNDERCUT || place.descent < -90.0 || place.point.y > lowest;
    let used = seen.iter().position(ends).unwrap_or(seen.len()).max(1);
    let end = seen[used - 1];
    if end.descent < SIDE_SEEN {
        let level = own
            .iter()
            .min_by(|a, b| (a.point.x - end.point.x).abs().total_cmp(&(b.point.x - end.point.x).abs()));
        let level = level.copied().unwrap_or(own[0]);
        let down = Vector2::new(0.0, end.point.y - level.point.y);
        return HeadSide { measured: end.s, at: (level.s, down), below: 0.0 };
    }
    let like = counterpart(&own, &end);
    let by = end.point - like.point;
    HeadSide { measured: end.s, at: (like.s, by), below: by.x }
}

/// The section of a measured head of which no standard is known, on a body like `base`. The head has its top at z = 0 and its middle at
/// y = 0. Web, foot and height are those of `base`; its head is as wide as the measured one.
///
/// What was done is added to `findings`.
///
/// # Errors
/// [`crate::error::InputError`] with the field `rail_profile` for a head that cannot be joined to such a body.
pub fn rail_section_for_head(
    base: RailSection,
    head: &ProfileCurve,
    findings: &mut Vec<Finding>,
) -> Result<RailSection> {
    let sides = [-1.0, 1.0].map(|sign| head_side(&base.running, head, sign));
    let [gauge, field] = &sides;
    let length = base.running.length();
    let across = |side: &HeadSide| Vector2::new(side.below, 0.0);
    let mut displaced: Vec<Displaced> =
        vec![(0.0, across(gauge)), gauge.at, field.at, (length, across(field))];
    // an end that corresponds to the end of the known side has its displacement
    displaced.dedup_by(|b, a| (b.0 - a.0).abs() < STEP);
    let running = moved(&base.running, &displaced)?;
    let rest = widened(&base, [displacement(&displaced, 0.0).x, displacement(&displaced, length).x]);
    let name = format!("a body like {}", base.name);
    let body = rail_section_on(&name, running, rest);
    let head = trimmed(head, gauge.measured, field.measured);
    rail_section_with_head(body, &head, findings)
}

/// The outline below the head with the lower ends of its sides moved across, gauge side first: the underside of the head is stretched from the web on.
fn widened(base: &RailSection, [gauge, field]: [f64; 2]) -> Vec<Segment> {
    let middle = 0.5 * base.height;
    let under = |p: &Point2<f64>| p.y < middle;
    // half the web's least thickness
    let web = base
        .body_outline
        .iter()
        .flat_map(|segment| (0..=20).map(|i| segment.point(f64::from(i) / 20.0)))
        .filter(|p| (p.y - middle).abs() < 0.1 * base.height)
        .map(|p| p.x.abs())
        .fold(f64::INFINITY, f64::min);
    let (first, last) = (base.body_outline[0].start(), base.body_outline[base.body_outline.len() - 1].end());
    let shift = |p: &Point2<f64>| {
        let (end, by) = if p.x < 0.0 { (last.x, gauge) } else { (first.x, field) };
        let reach = ((p.x.abs() - web) / (end.abs() - web).max(MILLIMETRE)).clamp(0.0, 1.0);
        if under(p) { Point2::new(p.x + reach * by, p.y) } else { *p }
    };
    let moves =
        |segment: &Segment| [0.0, 0.5, 1.0].iter().any(|t| shift(&segment.point(*t)) != segment.point(*t));
    base.body_outline
        .iter()
        .flat_map(|segment| match moves(segment) {
            false => vec![*segment],
            true => {
                let line = polyline(std::slice::from_ref(segment), FILLET_STEP);
                line.windows(2).map(|pair| Segment::line(shift(&pair[0]), shift(&pair[1]))).collect()
            }
        })
        .collect()
}

/// The section of a measured wheel profile of which no standard is known, on a body of the `form` whose flange and chamfer are like those of the
/// wheel `like`, with its diameter. Both profiles have their origin on the tape circle. The rim is as wide as it was measured; a profile that
/// ends on its tread goes on to the width of `form`.
///
/// What was done is added to `findings`.
///
/// # Errors
/// [`InputError`] with the field `wheel_profile` for a profile without a tread, or that cannot be joined to such a wheel.
pub fn wheel_section_for_profile(
    like: &WheelSection,
    profile: &ProfileCurve,
    form: &WheelBody,
    findings: &mut Vec<Finding>,
) -> Result<WheelSection> {
    let (name, tape_diameter, like) = (&like.name, 2.0 * like.radius, &like.running);
    let middle = |curve: &ProfileCurve| curve.s_at_y(0.0);
    let (Some(own_middle), Some(seen_middle)) = (middle(like), middle(profile)) else {
        let ends = [0.0, profile.length()].map(|s| profile.point(s).x / MILLIMETRE);
        return InputError::refuse(
            InputField::WheelProfile,
            format!("a profile from y = {:.1} to {:.1} mm", ends[0], ends[1]),
            "one that goes over the tape circle, y = 0",
            "measure the tread, or correct the origin of y",
        );
    };
    // towards the flange
    let own = like.followed(own_middle, -1.0);
    let seen = profile.followed(seen_middle, -1.0);
    let tip = (0..seen.len()).max_by(|&a, &b| seen[a].point.y.total_cmp(&seen[b].point.y)).unwrap_or(0);
    let back = |i: usize| {
        let place = &seen[i];
        let up = seen[tip].point.y - place.point.y;
        i > tip && (up > BACK_HEIGHT || (place.descent < -BACK && up > 0.25 * BACK_HEIGHT))
    };
    let used = (tip..seen.len()).find(|&i| back(i)).unwrap_or(seen.len() - 1);
    let flange = seen[used];
    let at_flange = counterpart(&own, &flange);
    let by_flange = flange.point - at_flange.point;
    // the back is where the origin says, unless it was measured
    let back_at = if flange.descent < -BACK { by_flange.x } else { 0.0 };
    // towards the field side
    let out = profile.followed(seen_middle, 1.0);
    let at_chamfer = |p: &Followed| p.point.x > FIELD_SIDE && p.descent.abs() > CHAMFER;
    let chamfer = out.iter().position(at_chamfer);
    let tread = out[chamfer.map_or(out.len() - 1, |at| at.max(1) - 1)];
    let own_out = like.followed(own_middle, 1.0);
    let own_chamfer = own_out.iter().position(at_chamfer);
    let own_out = &own_out[..own_chamfer.unwrap_or(own_out.len()).max(1)];
    let own_end = own_out[own_out.len() - 1];
    let across = |place: &Followed| (place.point.x - tread.point.x).abs();
    let at_tread = match chamfer.is_some() || tread.point.x > own_end.point.x {
        true => own_end,
        false => *own_out.iter().min_by(|a, b| across(a).total_cmp(&across(b))).unwrap_or(&own_end),
    };
    let mut displaced: Vec<Displaced> =
        vec![(0.0, Vector2::new(back_at, by_flange.y * f64::from(back_at != 0.0)))];
    displaced.push((at_flange.s, by_flange));
    displaced.push((at_tread.s, tread.point - at_tread.point));
    displaced.dedup_by(|b, a| (b.0 - a.0).abs() < STEP);
    let running = moved(like, &displaced)?;
    let widest = out.iter().map(|p| p.point.x).fold(f64::NEG_INFINITY, f64::max);
    let field_face = match chamfer {
        Some(_) => widest.max(tread.point.x),
        None => form.field_face.max(widest),
    };
    let form = WheelBody { field_face, ..*form };
    let body = wheel_section_on(running, &format!("a wheel like {name}"), tape_diameter, &form)?;
    let profile = trimmed(profile, flange.s, tread.s);
    wheel_section_with_profile(body, &profile, findings)
}
