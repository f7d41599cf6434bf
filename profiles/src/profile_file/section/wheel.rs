//! The closed section of a wheel on one side of its axle: flange, tread, rim, web, hub and bore.

use std::ops::RangeInclusive;

use nalgebra::{Point2, Vector2};

use super::closed::ClosedSection;
use super::divide::{divided, upright};
use super::expected::outline_of;
use super::frame::Frame;
use super::outline::{Outline, Shape};
use super::ring::{bounds, direction, width};
use crate::error::{Error, Result, on_line};
use crate::field::InputField;
use crate::profile::{
    ProfileCurve, ProfileKind, Segment, TAPE_CIRCLE_FROM_FLANGE_BACK, Tape, of_ring, split_wheel,
};
use crate::profile_file::finding::{Action, Finding, FindingKind};
use crate::profile_file::format::ProfileFormat;
use crate::profile_file::measured::MeasuredPoint;
use crate::units::{MILLIMETRE, in_millimetres};

/// Depth from either end of the outline at which the widths of hub and flange are compared, m.
const END: f64 = 5.0 * MILLIMETRE;
/// Ratio of the widths from which it is certain which of them is the hub's.
const WIDER: f64 = 1.5;
/// Height of the rim from the tip of the flange, in which the flange is at one side, m.
const RIM: f64 = 45.0 * MILLIMETRE;
/// How far the tip of a flange lies below the tape circle, m.
const FLANGE: RangeInclusive<f64> = 0.010..=0.060;
/// Vertices this near to the innermost one are on the bore, m.
const ON_BORE: f64 = 0.01 * MILLIMETRE;
/// Least length of a bore along the axle, m.
const BORE: f64 = 20.0 * MILLIMETRE;
/// Step of the samples of the running surface, m: that of tables of lines and arcs.
const STEP: f64 = 0.1 * MILLIMETRE;

/// The closed section of a wheel from its outline; `tape_circle` is its distance from the flange back, m, 70 mm if there is none.
pub(super) fn section(name: &str, outline: Outline, tape_circle: Option<f64>) -> Result<ClosedSection> {
    const KIND: ProfileKind = ProfileKind::Wheel;
    let tape_circle = tape_circle.unwrap_or(TAPE_CIRCLE_FROM_FLANGE_BACK);
    let Outline { format, count, shape, mut ring, mut findings } = outline;
    let (running, mut rest) = match shape {
        Shape::Table(lines) => (lines.curve(), lines.rest),
        Shape::Drawn(drawn) => {
            let frame = frame_of(name, &ring, &mut findings)?;
            let segments = upright(KIND, &drawn, &frame, &mut ring);
            let (running, rest) = split_wheel(name, &segments, Tape::FromBack(tape_circle), drawn[0].1)?;
            (ProfileCurve::from_segments(&of_ring(&segments, running), STEP), of_ring(&segments, rest))
        }
        Shape::Points => {
            ring = frame_of(name, &ring, &mut findings)?.ring(&ring);
            divided(KIND, &mut ring, |n, at| surface(name, n, tape_circle, at), &mut findings)?
        }
    };
    let line = ring[0].line;
    let shift = match format {
        // A table says where its tape circle is.
        ProfileFormat::LinesAndArcs => Vector2::zeros(),
        _ => to_the_tape_circle(name, line, tape_circle, &running)?,
    };
    let frame = Frame { mirrored: false, upside_down: false, shift };
    let distance = in_millimetres(tape_circle);
    let what = format!("the tape circle, {distance} mm from the flange back, to y = 0 and z = 0");
    frame.say_shift(&what, &mut findings);
    let running = running.transformed(0.0, shift);
    rest.iter_mut().for_each(|segment| *segment = frame.segment(segment));
    let ring = frame.ring(&ring);
    check_flange(name, &ring)?;
    straighten_bore(name, &ring, &mut rest)?;
    Ok(ClosedSection { kind: KIND, format, count, running, rest, findings })
}

/// How the outline comes upright: the bore above, the flange at small y.
fn frame_of(name: &str, ring: &[MeasuredPoint], findings: &mut Vec<Finding>) -> Result<Frame> {
    let (low, high) = bounds(ring);
    let wide = |z| {
        let (least, most) = width(ring, z);
        most - least
    };
    let (above, below) = (wide(low.y..=low.y + END), wide(high.y - END..=high.y));
    if above.max(below) < WIDER * above.min(below) {
        let [above, below] = [above, below].map(|v| v / MILLIMETRE);
        let value = format!("an outline {above:.2} mm wide at one end and {below:.2} mm at the other");
        let expected = "a hub wider than the flange, the axle along the first coordinate";
        let remedy =
            "give the section on one side of the axle alone, or as lines and arcs, which say how they lie";
        return Err(on_line(name, ring[0].line, &value, expected, remedy));
    }
    let upside_down = below > above;
    if upside_down {
        let text = "z counts upwards: turned over, so that the flange is below";
        findings.push(Finding::new(FindingKind::UpsideDown, Action::Repaired, text));
    }
    let mut frame = Frame { mirrored: false, upside_down, shift: Vector2::zeros() };
    let turned = frame.ring(ring);
    let (_, high) = bounds(&turned);
    let flange = width(&turned, high.y - END..=high.y);
    let rim = width(&turned, high.y - RIM..=high.y);
    frame.mirrored = flange.0 + flange.1 > rim.0 + rim.1;
    if frame.mirrored {
        let text = "y counts towards the track centre: turned over, so that the flange is at the gauge side";
        findings.push(Finding::new(FindingKind::Mirrored, Action::Repaired, text));
    }
    Ok(frame)
}

/// First and last vertex of the running surface, counted from `n` after the tip of the flange: where the flange back leaves the vertical, and where the
/// tread turns into its chamfer.
fn surface(
    name: &str,
    n: usize,
    tape_circle: f64,
    at: &dyn Fn(usize) -> MeasuredPoint,
) -> Result<(usize, usize)> {
    /// Length over which the direction of the flange back is taken, m, and its greatest lateral part: 20 µm.
    const BACK: (f64, f64) = (2.0 * MILLIMETRE, 0.01);
    /// The same for the tread, which turns by 20° into a chamfer or a face.
    const TREAD: (f64, f64) = (1.0 * MILLIMETRE, 0.94);
    /// Vertices this near to the plane of the flange back are on it, m.
    const ON_BACK: f64 = 0.5e-3 * MILLIMETRE;
    let no = |what: &str, remedy: &str| {
        on_line(
            name,
            at(0).line,
            format!("a closed outline without a {what}"),
            outline_of(ProfileKind::Wheel),
            remedy,
        )
    };
    let reach = |from: usize, forward: bool, over: f64| {
        let far = (1..n).find(|k| {
            (at(if forward { from + k } else { from + n - k }).point - at(from).point).norm() >= over
        });
        far.unwrap_or(0)
    };
    let back = (2..=n).rev().find(|&i| direction(n, at, i, false, BACK.0).x < BACK.1);
    let back = back.filter(|&i| (at(i).point - at(n).point).norm() < RIM);
    let Some(back) = back else {
        return Err(no(
            "flange back",
            "check that it is a wheel's section, with its axle along the first coordinate",
        ));
    };
    let furthest = back.saturating_sub(reach(back, false, BACK.0)).max(1);
    let plane = (furthest..=back).map(|i| at(i).point.x).fold(f64::INFINITY, f64::min);
    let first = (furthest..=back).rev().find(|&i| at(i).point.x <= plane + ON_BACK).unwrap_or(back);
    let tape = (n..first + n).find(|&i| at(i).point.x >= plane + tape_circle);
    let turned = |i: &usize| direction(n, at, *i, true, TREAD.0).x < TREAD.1;
    let end = tape.filter(|i| !turned(i)).and_then(|tape| (tape..first + n).find(turned));
    let Some(end) = end else {
        return Err(no(
            &format!("tread {} mm from its flange back", in_millimetres(tape_circle)),
            "give the section of the whole wheel, its flange back upright",
        ));
    };
    // The corner itself is the sharpest turn on the length over which the direction was taken.
    let turn = |i: &usize| {
        let [before, here, after] = [i - 1, *i, i + 1].map(|i| at(i).point);
        (here - before).angle(&(after - here))
    };
    let last =
        (end..end + reach(end, true, TREAD.0)).max_by(|a, b| turn(a).total_cmp(&turn(b))).unwrap_or(end);
    Ok((first, last))
}

/// The shift that brings the tape circle to the origin.
fn to_the_tape_circle(
    name: &str,
    line: usize,
    tape_circle: f64,
    running: &ProfileCurve,
) -> Result<Vector2<f64>> {
    let tape = running.point(0.0).x + tape_circle;
    let tread = running.s_at_y(tape).map(|s| running.point(s)).ok_or_else(|| {
        let distance = in_millimetres(tape_circle);
        let expected =
            format!("a running surface that passes the tape circle, {distance} mm from the flange back");
        let remedy = format!("give the section of the whole wheel, or its `{}`", InputField::TapeCircle);
        on_line(name, line, "a tread that ends before it", &expected, &remedy)
    })?;
    Ok(Vector2::new(-tape, -tread.y))
}

fn check_flange(name: &str, ring: &[MeasuredPoint]) -> Result<()> {
    let (_, tip) = bounds(ring);
    if FLANGE.contains(&tip.y) {
        return Ok(());
    }
    let value = format!("a flange that ends {:.3} mm below the tape circle", tip.y / MILLIMETRE);
    let expected = format!("a height of {} to {} mm", 1e3 * FLANGE.start(), 1e3 * FLANGE.end());
    Err(on_line(
        name,
        ring[0].line,
        &value,
        expected,
        "check the unit, and that the outline is a wheel's section",
    ))
}

/// Checks that the innermost part of the outline is a bore, and brings its vertices to one radius.
fn straighten_bore(name: &str, ring: &[MeasuredPoint], rest: &mut [Segment]) -> Result<()> {
    let (least, _) = bounds(ring);
    let on_bore = |p: &Point2<f64>| p.y - least.y < ON_BORE;
    let length: f64 = ring
        .windows(2)
        .filter(|pair| pair.iter().all(|p| on_bore(&p.point)))
        .map(|pair| (pair[1].point.x - pair[0].point.x).abs())
        .sum();
    if length < BORE {
        let innermost = ring.iter().find(|p| on_bore(&p.point)).unwrap_or(&ring[0]);
        return Err(no_bore(name, innermost, length));
    }
    for segment in rest {
        if let Segment::Line { start, end } = segment {
            for p in [start, end].into_iter().filter(|p| on_bore(p)) {
                p.y = least.y;
            }
        }
    }
    Ok(())
}

fn no_bore(name: &str, innermost: &MeasuredPoint, length: f64) -> Error {
    let [y, z, length] = [innermost.point.x, innermost.point.y, length].map(|v| v / MILLIMETRE);
    let value = format!(
        "no bore: innermost is ({y:.3}, {z:.3}) mm from the tape circle, and level over {length:.3} mm"
    );
    let expected = "a bore, a straight line of at least 20 mm along the axle";
    on_line(
        name,
        innermost.line,
        &value,
        expected,
        "draw the bore parallel to the axle; a wheel in one piece with its axle is given as a mesh",
    )
}

#[cfg(test)]
mod tests;
