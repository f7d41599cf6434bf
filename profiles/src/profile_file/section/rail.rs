//! The closed section of a rail: head, web and foot.

use nalgebra::Vector2;

use super::closed::ClosedSection;
use super::divide::{divided, upright};
use super::frame::Frame;
use super::outline::{Outline, Shape};
use super::ring::{bounds, direction, width};
use crate::error::{Error, Result, on_line};
use crate::profile::rails::{RailOutline, running_curve};
use crate::profile::{ProfileCurve, ProfileKind, of_ring, split_rail};
use crate::profile_file::finding::{Action, Finding, FindingKind};
use crate::profile_file::measured::MeasuredPoint;
use crate::units::MILLIMETRE;

/// Parts of the height at the top and at the bottom of which the widths are compared.
const END_SHARE: f64 = 0.15;
/// Ratio of the widths from which it is certain which of them is the foot's.
const WIDER: f64 = 1.05;
/// Departure from symmetry that is said, m.
const ASYMMETRIC: f64 = 0.1 * MILLIMETRE;

/// The closed section of a rail from its outline.
pub(super) fn section(name: &str, outline: Outline) -> Result<ClosedSection> {
    const KIND: ProfileKind = ProfileKind::Rail;
    let Outline { format, count, shape, mut ring, mut findings } = outline;
    let (running, rest) = match shape {
        Shape::Table(lines) => {
            if foot_is_up(name, &ring)? {
                let value = "an outline with its foot at the top";
                let remedy = "it is upside down: correct `# z:`";
                return Err(on_line(name, ring[0].line, value, "the head at the top, z as stated", remedy));
            }
            say_asymmetry(&ring, &mut findings);
            let outline = RailOutline { running: lines.running, rest: lines.rest };
            (running_curve(&outline), outline.rest)
        }
        Shape::Drawn(drawn) => {
            let frame = frame_of(name, &ring, &mut findings)?;
            let segments = upright(KIND, &drawn, &frame, &mut ring);
            say_asymmetry(&ring, &mut findings);
            let (running, rest) = split_rail(name, &segments, drawn[0].1)?;
            let outline =
                RailOutline { running: of_ring(&segments, running), rest: of_ring(&segments, rest) };
            (running_curve(&outline), outline.rest)
        }
        Shape::Points => {
            ring = frame_of(name, &ring, &mut findings)?.ring(&ring);
            say_asymmetry(&ring, &mut findings);
            divided(KIND, &mut ring, |n, at| head(name, n, at), &mut findings)?
        }
    };
    check_head(name, &running, &ring)?;
    Ok(ClosedSection { kind: KIND, format, count, running, rest, findings })
}

/// First and last vertex of the head, counted from `n` after the top: where its sides turn under it.
fn head(name: &str, n: usize, at: &dyn Fn(usize) -> MeasuredPoint) -> Result<(usize, usize)> {
    /// Length over which the direction of a side is taken, m.
    const OVER: f64 = 1.0 * MILLIMETRE;
    /// Lateral part of the direction from which a side has turned: sides of heads lean inwards by less.
    const TURNED: f64 = -0.1;
    // The gauge side comes before the top, which is met again after `n` vertices.
    let end = (n + 1..2 * n).find(|&i| direction(n, at, i, true, OVER).x < TURNED);
    let start = (1..n).rev().find(|&i| direction(n, at, i, false, OVER).x < TURNED);
    match (start, end) {
        (Some(start), Some(end)) if end - n < start && end > n + 2 => Ok((start, end)),
        _ => Err(no_head(name, at(0).line)),
    }
}

fn no_head(name: &str, line: usize) -> Error {
    let value = "a closed outline without a head";
    let remedy = "give the outline of the whole section, in order";
    on_line(name, line, value, "sides that turn under a head above its web", remedy)
}

/// Refuses an outline whose sides turn under it in its lower half only: at the foot, not under a head.
fn check_head(name: &str, running: &ProfileCurve, ring: &[MeasuredPoint]) -> Result<()> {
    let (low, high) = bounds(ring);
    let middle = 0.5 * (low.y + high.y);
    let ends = [0.0, running.length()].map(|s| running.point(s).y);
    if ends.iter().all(|z| *z < middle) { Ok(()) } else { Err(no_head(name, ring[0].line)) }
}

/// Whether the foot, the wider end, is at small z.
fn foot_is_up(name: &str, ring: &[MeasuredPoint]) -> Result<bool> {
    let (low, high) = bounds(ring);
    let depth = END_SHARE * (high.y - low.y);
    let wide = |z| {
        let (least, most) = width(ring, z);
        most - least
    };
    let (up, down) = (wide(low.y..=low.y + depth), wide(high.y - depth..=high.y));
    if up.max(down) < WIDER * up.min(down) {
        let value = format!(
            "an outline {:.2} mm wide at the top and {:.2} mm at the bottom",
            up / MILLIMETRE,
            down / MILLIMETRE
        );
        let remedy = "give it as lines and arcs, which say by `# z:` how they lie";
        return Err(on_line(name, ring[0].line, &value, "a foot wider than the head", remedy));
    }
    Ok(up > down)
}

/// How the outline comes into the frame of a rail.
fn frame_of(name: &str, ring: &[MeasuredPoint], findings: &mut Vec<Finding>) -> Result<Frame> {
    let upside_down = foot_is_up(name, ring)?;
    if upside_down {
        let text = "z counts upwards: turned over, so that the foot is below";
        findings.push(Finding::new(FindingKind::UpsideDown, Action::Repaired, text));
    }
    let mut frame = Frame { mirrored: false, upside_down, shift: Vector2::zeros() };
    let ring = frame.ring(ring);
    let (low, high) = bounds(&ring);
    let foot = width(&ring, high.y - END_SHARE * (high.y - low.y)..=high.y);
    frame.shift = Vector2::new(-0.5 * (foot.0 + foot.1), -low.y);
    frame.say_shift("the middle of the foot to y = 0, the top to z = 0", findings);
    Ok(frame)
}

/// Says how far a section is from being its own mirror image, and how it lies then.
fn say_asymmetry(ring: &[MeasuredPoint], findings: &mut Vec<Finding>) {
    /// Levels at which the two sides are compared.
    const LEVELS: u32 = 100;
    let (low, high) = bounds(ring);
    let departure = |k: u32| {
        let z = low.y + (high.y - low.y) * (f64::from(k) + 0.5) / f64::from(LEVELS);
        let (least, most) = width(ring, z..=z);
        0.5 * (least + most).abs()
    };
    let most = (0..LEVELS).map(departure).fold(0.0, f64::max);
    if most > ASYMMETRIC {
        let text = "the middle between the sides leaves y = 0: taken as the section of a right rail, y to the field side";
        findings
            .push(Finding::new(FindingKind::Shape, Action::Left, text).with_value(most / MILLIMETRE, "mm"));
    }
}
