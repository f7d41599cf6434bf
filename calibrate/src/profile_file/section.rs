//! The closed outline of a rail in a file: lines and arcs, a drawing, or columns of points.
//!
//! Lines and arcs say how they lie; an outline of the other kinds is turned upright and moved into the frame of a rail, top at z = 0 and the
//! middle of the foot at y = 0, and every such step is a finding.

use nalgebra::{Point2, Vector2};

use super::dxf::ClosedShape;
use super::finding::{Action, Finding, FindingKind};
use super::kinks::find_kinks;
use super::loops::first_crossing;
use super::{
    MeasuredPoint, Part, ProfileFormat, ProfileKind, ReadOptions, columns, drawn, dxf, recognised, text,
};
use crate::error::{Error, InputError, Result};
use crate::profile::lines_and_arcs::{self, split_rail};
use crate::profile::rails::{RailOutline, running_curve};
use crate::profile::{Piece, ProfileCurve, Segment, polyline};
use crate::units::MILLIMETRE;

/// Heights and widths of rails, m: from mine rails to crane rails.
const SIZE: std::ops::RangeInclusive<f64> = 0.04..=0.3;
/// Points nearer to each other are one, m.
const SAME_POINT: f64 = 1e-3 * MILLIMETRE;
/// Longest step that closes an outline of points without being said to be open, m.
const LONGEST_CLOSURE: f64 = 5.0 * MILLIMETRE;
/// A turn from here on goes back, degrees.
const CUSP: f64 = 150.0;
/// Parts of the height at the top and at the bottom of which the widths are compared.
const PART: f64 = 0.15;
/// Ratio of the widths from which it is certain which of them is the foot's.
const WIDER: f64 = 1.05;
/// A shift below this is none, m.
const IN_PLACE: f64 = 1e-6 * MILLIMETRE;
/// Departure from symmetry that is said, m.
const ASYMMETRIC: f64 = 0.1 * MILLIMETRE;
/// Step on arcs where an outline is looked at by points, m.
const STEP: f64 = 0.2 * MILLIMETRE;
/// A chord this many times as long as a typical one on the head, and at least `LEAST_LONG`, is a straight side.
const LONG: f64 = 5.0;
/// m.
const LEAST_LONG: f64 = 1.0 * MILLIMETRE;

const OUTLINE: &str = "the closed outline of one rail section";

/// The closed section of a rail from a file, in the profile frame, m.
#[derive(Debug, Clone, PartialEq)]
pub struct RailSectionFile {
    /// Format of the file.
    pub format: ProfileFormat,
    /// Points, or lines and arcs, that the file gives.
    pub count: usize,
    /// The running surface, from the gauge side to the field side.
    pub running: ProfileCurve,
    /// The rest of the outline, from the end of `running` back to its start.
    pub rest: Vec<Segment>,
    /// What was found and done.
    pub findings: Vec<Finding>,
}

/// Reads the closed section of a rail from the content of a file; `name` is used in messages, and its ending tells the format where the
/// content does not.
///
/// # Errors
/// [`crate::error::InputError`] with the line of the file for an outline that is open, crosses itself or steps back, that has no head or
/// not the size of a rail, or of which it is not certain which side is up.
pub fn parse_rail_section(name: &str, bytes: &[u8]) -> Result<RailSectionFile> {
    dxf::refuse_binary(name, bytes)?;
    let text = text::decode(name, bytes)?;
    let ending = std::path::Path::new(name).extension();
    let ending = ending.map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    match recognised(&text, &ending) {
        Some(ProfileFormat::LinesAndArcs) => table(name, &text),
        Some(ProfileFormat::Dxf) => {
            let remedy = "leave the outline of the section alone in the drawing, one closed line";
            let dxf::Closed { shape, unit, findings } = dxf::closed_line(name, &text, remedy)?;
            match shape {
                ClosedShape::Segments(segments) => drawing(name, segments, unit, findings),
                ClosedShape::Points(points) => vertices(name, ProfileFormat::Dxf, points, unit, findings),
            }
        }
        Some(format @ (ProfileFormat::Simpack | ProfileFormat::MiniProf)) => {
            let value = format!("a {format} file, which holds a running surface");
            let remedy = "give a running surface as `profile_file` on a standard section";
            Err(InputError::new(name, value, OUTLINE, remedy).into())
        }
        Some(ProfileFormat::Text | ProfileFormat::Csv) | None => {
            let part = Part { name: None, field: "the part".into() };
            let raw = columns::parse(name, &text, &ending, &part)?;
            vertices(name, raw.format, raw.points, raw.unit, raw.findings)
        }
    }
}

/// A table of lines and arcs, which lies as it says.
fn table(name: &str, text: &str) -> Result<RailSectionFile> {
    let options = ReadOptions { kind: Some(ProfileKind::Rail), ..ReadOptions::default() };
    let read = drawn::read(name, text, &options)?;
    let mut findings = read.findings;
    let lines = read.drawn.as_ref();
    let Some(outline) = lines.and_then(lines_and_arcs::LinesAndArcs::rail_outline) else {
        let [first, last] = [&read.points[0], &read.points[read.points.len() - 1]];
        return Err(open(name, last, first));
    };
    let ring: Vec<MeasuredPoint> = polyline(&outline.running, STEP)
        .into_iter()
        .chain(polyline(&outline.rest, STEP))
        .map(|point| MeasuredPoint { point, line: read.points[0].line, weight: 1.0 })
        .collect();
    let ring = without_duplicates(ring);
    check_ring(name, &ring)?;
    check_size(name, &ring, "correct the unit in the names of the columns")?;
    if foot_is_up(name, &ring)? {
        let value = "an outline with its foot at the top";
        let remedy = "it is upside down: correct `# z:`";
        return Err(at_line(name, ring[0].line, value, "the head at the top, z as stated", remedy));
    }
    say_asymmetry(&ring, &mut findings);
    let count = outline.running.len() + outline.rest.len();
    let running = running_curve(&outline);
    check_head(name, &running, &ring)?;
    Ok(RailSectionFile { format: ProfileFormat::LinesAndArcs, count, running, rest: outline.rest, findings })
}

/// Lines and arcs of a drawing.
fn drawing(
    name: &str,
    mut drawn: Vec<(Segment, usize)>,
    unit: Option<(f64, usize)>,
    mut findings: Vec<Finding>,
) -> Result<RailSectionFile> {
    let count = drawn.len();
    let sampled = |drawn: &[(Segment, usize)], step: f64| -> Vec<MeasuredPoint> {
        let of = |(segment, line): &(Segment, usize)| {
            let line = *line;
            let parts = at_its_top(segment);
            let points = polyline(&parts, step);
            points.into_iter().map(move |point| MeasuredPoint { point, line, weight: 1.0 })
        };
        drawn.iter().flat_map(of).collect()
    };
    // Ends and middles of arcs show the size before the unit is known.
    let scale = unit_of(name, &sampled(&drawn, f64::INFINITY), unit, &mut findings)?;
    drawn.iter_mut().for_each(|(segment, _)| *segment = segment.scaled(scale));
    let ring = without_duplicates(sampled(&drawn, STEP));
    check_ring(name, &ring)?;
    let frame = Frame::of(name, &ring, &mut findings)?;
    drawn.iter_mut().for_each(|(segment, _)| *segment = frame.segment(segment));
    let ring: Vec<MeasuredPoint> =
        ring.iter().map(|p| MeasuredPoint { point: frame.point(&p.point), ..*p }).collect();
    if !runs_to_the_field_side(&ring) {
        drawn.reverse();
        drawn.iter_mut().for_each(|(segment, _)| *segment = segment.reversed());
    }
    say_asymmetry(&ring, &mut findings);
    let segments: Vec<Segment> = drawn.iter().map(|(segment, _)| *segment).collect();
    let (running, rest) = split_rail(name, &segments, drawn[0].1)?;
    let part = |range: std::ops::Range<usize>| range.map(|i| segments[i % segments.len()]).collect();
    let outline = RailOutline { running: part(running), rest: part(rest) };
    let running = running_curve(&outline);
    check_head(name, &running, &ring)?;
    Ok(RailSectionFile { format: ProfileFormat::Dxf, count, running, rest: outline.rest, findings })
}

/// An arc in two at its least and greatest z, so that its points have them; any other segment alone.
fn at_its_top(segment: &Segment) -> Vec<Segment> {
    use std::f64::consts::{PI, TAU};
    let Segment::Arc { centre, radius, start_angle, sweep } = *segment else { return vec![*segment] };
    let arc = |start_angle: f64, sweep: f64| Segment::Arc { centre, radius, start_angle, sweep };
    // How far the arc travels to the first and to the second of the two.
    let first = (sweep.signum() * (0.5 * PI - start_angle)).rem_euclid(PI);
    let mut stations = vec![0.0];
    stations.extend([first, first + PI].into_iter().filter(|&to| to > 0.0 && to < sweep.abs().min(TAU)));
    stations.push(sweep.abs());
    let part =
        |pair: &[f64]| arc(start_angle + sweep.signum() * pair[0], sweep.signum() * (pair[1] - pair[0]));
    stations.windows(2).map(part).collect()
}

/// Points: a spline on the head, straight lines between the others.
fn vertices(
    name: &str,
    format: ProfileFormat,
    mut points: Vec<MeasuredPoint>,
    unit: Option<(f64, usize)>,
    mut findings: Vec<Finding>,
) -> Result<RailSectionFile> {
    let count = points.len();
    let line = points.last().map_or(1, |p| p.line);
    let few = || {
        let value = format!("{count} points");
        at_line(name, line, &value, "at least 12 points around a section", "give the whole outline")
    };
    if count < 12 {
        return Err(few());
    }
    let scale = unit_of(name, &points, unit, &mut findings)?;
    points.iter_mut().for_each(|p| p.point *= scale);
    close(name, &mut points, &mut findings)?;
    let mut ring = without_duplicates(points);
    if ring.len() < 12 {
        return Err(few());
    }
    check_ring(name, &ring)?;
    let frame = Frame::of(name, &ring, &mut findings)?;
    ring.iter_mut().for_each(|p| p.point = frame.point(&p.point));
    if !runs_to_the_field_side(&ring) {
        ring.reverse();
    }
    say_asymmetry(&ring, &mut findings);
    ring.pop();
    let n = ring.len();
    let top = (0..n).min_by(|&a, &b| ring[a].point.y.total_cmp(&ring[b].point.y)).unwrap_or(0);
    let at = |i: usize| ring[(top + i) % n];
    let (first, last) = head(name, n, at)?;
    let surface: Vec<MeasuredPoint> = (first..=last).map(at).collect();
    let around: Vec<Point2<f64>> = (last..=first + n).map(|i| at(i).point).collect();
    let rest = around.windows(2).map(|pair| Segment::line(pair[0], pair[1])).collect();
    let running = through(&surface, &mut findings);
    check_head(name, &running, &ring)?;
    Ok(RailSectionFile { format, count, running, rest, findings })
}

/// First and last vertex of the head, counted from `n` after the top: where its sides turn under it.
fn head(name: &str, n: usize, at: impl Fn(usize) -> MeasuredPoint) -> Result<(usize, usize)> {
    /// Length over which the direction of a side is taken, m.
    const OVER: f64 = 1.0 * MILLIMETRE;
    /// Lateral part of the direction from which a side has turned: sides of heads lean inwards by less.
    const TURNED: f64 = -0.1;
    let direction = |i: usize, forward: bool| -> Vector2<f64> {
        let here = at(i).point;
        let other = |k: usize| at(if forward { i + k } else { i + n - k }).point;
        let far = (1..n).map(other).find(|p| (p - here).norm() >= OVER).unwrap_or(here);
        (if forward { far - here } else { here - far }).try_normalize(0.0).unwrap_or_default()
    };
    // The gauge side comes before the top, which is met again after `n` vertices.
    let end = (n + 1..2 * n).find(|&i| direction(i, true).x < TURNED);
    let start = (1..n).rev().find(|&i| direction(i, false).x < TURNED);
    match (start, end) {
        (Some(start), Some(end)) if end - n < start && end > n + 2 => Ok((start, end)),
        _ => Err(no_head(name, at(0).line)),
    }
}

fn no_head(name: &str, line: usize) -> Error {
    let value = "a closed outline without a head";
    let remedy = "give the outline of the whole section, in order";
    at_line(name, line, value, "sides that turn under a head above its web", remedy)
}

/// Refuses an outline whose sides turn under it in its lower half only: at the foot, not under a head.
fn check_head(name: &str, running: &ProfileCurve, ring: &[MeasuredPoint]) -> Result<()> {
    let (low, high) = bounds(ring);
    let middle = 0.5 * (low.y + high.y);
    let ends = [0.0, running.length()].map(|s| running.point(s).y);
    if ends.iter().all(|z| *z < middle) { Ok(()) } else { Err(no_head(name, ring[0].line)) }
}

/// The curve through the points of a head: splines, with straight lines where the points are far apart, and corners.
fn through(points: &[MeasuredPoint], findings: &mut Vec<Finding>) -> ProfileCurve {
    let chord = |i: usize| (points[i + 1].point - points[i].point).norm();
    let chords = points.len() - 1;
    let mut sorted: Vec<f64> = (0..chords).map(chord).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let long = LEAST_LONG.max(LONG * sorted[chords / 2]);
    let kinks = find_kinks(points, findings);
    let mut pieces = Vec::new();
    let mut from = 0;
    for i in 1..=chords {
        // A straight side is a piece of its own.
        let ends = i == chords || kinks.contains(&i) || chord(i) > long || chord(i - 1) > long;
        if !ends {
            continue;
        }
        if i - from < 3 {
            let pairs = points[from..=i].windows(2);
            pieces.extend(pairs.map(|pair| Segment::line(pair[0].point, pair[1].point).piece(STEP)));
        } else {
            let points = points[from..=i].iter().map(|p| p.point).collect();
            pieces.push(Piece { points, end_tangents: None });
        }
        from = i;
    }
    ProfileCurve::from_pieces(pieces)
}

/// Length of the unit, m.
fn unit_of(
    name: &str,
    points: &[MeasuredPoint],
    stated: Option<(f64, usize)>,
    findings: &mut Vec<Finding>,
) -> Result<f64> {
    let extent = size(points).max();
    let wrong = |line: usize, remedy: &str| {
        let expected = format!("a section of {} to {} mm", 1e3 * SIZE.start(), 1e3 * SIZE.end());
        at_line(name, line, &format!("an outline {extent:.4} units across"), expected, remedy)
    };
    if let Some((unit, line)) = stated {
        let line = if line == 0 { points[0].line } else { line };
        let remedy = "the unit of the file does not fit its numbers: correct it, or its scale";
        return if SIZE.contains(&(unit * extent)) { Ok(unit) } else { Err(wrong(line, remedy)) };
    }
    let fits: Vec<(f64, &str)> = [(MILLIMETRE, "mm"), (1.0, "m")]
        .into_iter()
        .filter(|(unit, _)| SIZE.contains(&(unit * extent)))
        .collect();
    let [(unit, unit_name)] = fits[..] else {
        let remedy = "the unit is neither mm nor m: say it in the heading, such as y_in, z_in, or by $INSUNITS of a drawing";
        return Err(wrong(points[0].line, remedy));
    };
    let text = format!("the outline is {extent:.3} {unit_name} across, so the unit is {unit_name}");
    findings.push(Finding::new(FindingKind::Unit, Action::Noted, text).with_value(extent, unit_name));
    Ok(unit)
}

fn at_line(name: &str, line: usize, value: &str, expected: impl Into<String>, remedy: &str) -> Error {
    InputError::new(format!("{name}:{line}"), value, expected, remedy).into()
}

/// Lets the points end where they begin.
fn close(name: &str, points: &mut Vec<MeasuredPoint>, findings: &mut Vec<Finding>) -> Result<()> {
    let n = points.len();
    let step = |i: usize| (points[i + 1].point - points[i].point).norm();
    let gap = (points[n - 1].point - points[0].point).norm();
    let usual = step(0).max(step(n - 2));
    if gap > SAME_POINT && (gap > 2.0 * usual || gap > LONGEST_CLOSURE) {
        return Err(open(name, &points[n - 1], &points[0]));
    }
    if gap > SAME_POINT {
        let text = "step from the last point to the first: closed by a straight line";
        let (first, last) = (points[0].line, points[n - 1].line);
        findings.push(
            Finding::new(FindingKind::Gap, Action::Repaired, text)
                .on_lines(first, last)
                .with_value(gap / MILLIMETRE, "mm"),
        );
    }
    points.push(points[0]);
    Ok(())
}

fn open(name: &str, end: &MeasuredPoint, start: &MeasuredPoint) -> Error {
    let place = |p: &Point2<f64>| format!("({:.3}, {:.3}) mm", p.x / MILLIMETRE, p.y / MILLIMETRE);
    let value = format!(
        "an open outline: it ends at {} and began at {} on line {}, {:.3} mm away",
        place(&end.point),
        place(&start.point),
        start.line,
        (end.point - start.point).norm() / MILLIMETRE
    );
    let remedy = "close the outline, its last point the first again; a running surface alone is a `profile_file` on a standard section";
    at_line(name, end.line, &value, OUTLINE, remedy)
}

/// A ring without points on top of the one before them; it ends where it begins, to the last bit.
fn without_duplicates(mut ring: Vec<MeasuredPoint>) -> Vec<MeasuredPoint> {
    ring.dedup_by(|later, first| (later.point - first.point).norm() < SAME_POINT);
    while ring.len() > 1 && (ring[ring.len() - 1].point - ring[0].point).norm() < SAME_POINT {
        ring.pop();
    }
    ring.push(ring[0]);
    ring
}

/// Refuses a ring that steps back or crosses itself.
fn check_ring(name: &str, ring: &[MeasuredPoint]) -> Result<()> {
    let n = ring.len() - 1;
    let place = |p: &Point2<f64>| format!("({:.3}, {:.3}) mm", p.x / MILLIMETRE, p.y / MILLIMETRE);
    for i in 0..n {
        let (before, here, after) = (&ring[(i + n - 1) % n], &ring[i], &ring[(i + 1) % n]);
        let turn = (here.point - before.point).angle(&(after.point - here.point)).to_degrees();
        if turn > CUSP {
            let value =
                format!("a cusp at {} in the axes of the file, a turn of {turn:.0}°", place(&here.point));
            let remedy = "remove the point, or what is drawn twice there";
            return Err(at_line(name, here.line, &value, OUTLINE, remedy));
        }
    }
    if let Some((i, j, at)) = first_crossing(name, ring)? {
        let value = format!(
            "an outline that crosses itself at {} in the axes of the file, lines {} and {}",
            place(&at),
            ring[i].line,
            ring[j].line
        );
        let remedy = "put the points in the order of the outline, or remove the loop";
        return Err(at_line(name, ring[j].line, &value, OUTLINE, remedy));
    }
    Ok(())
}

fn bounds(points: &[MeasuredPoint]) -> (Point2<f64>, Point2<f64>) {
    let first = points[0].point;
    points.iter().fold((first, first), |(low, high), p| (low.inf(&p.point), high.sup(&p.point)))
}

fn size(points: &[MeasuredPoint]) -> Vector2<f64> {
    let (low, high) = bounds(points);
    high - low
}

fn check_size(name: &str, ring: &[MeasuredPoint], remedy: &str) -> Result<()> {
    let size = size(ring);
    if SIZE.contains(&size.x) && SIZE.contains(&size.y) {
        return Ok(());
    }
    let value =
        format!("an outline {:.3} mm wide and {:.3} mm high", size.x / MILLIMETRE, size.y / MILLIMETRE);
    let expected = format!("a section of {} to {} mm", 1e3 * SIZE.start(), 1e3 * SIZE.end());
    Err(at_line(name, ring[0].line, &value, expected, remedy))
}

/// Least and greatest y among the chords of a ring that pass through a range of z.
fn width(ring: &[MeasuredPoint], z: std::ops::RangeInclusive<f64>) -> (f64, f64) {
    let mut range = (f64::INFINITY, f64::NEG_INFINITY);
    let mut take = |y: f64| range = (range.0.min(y), range.1.max(y));
    for pair in ring.windows(2) {
        let [a, b] = [pair[0].point, pair[1].point];
        for p in [a, b].iter().filter(|p| z.contains(&p.y)) {
            take(p.x);
        }
        for level in [*z.start(), *z.end()] {
            if (a.y - level) * (b.y - level) < 0.0 {
                take(a.x + (b.x - a.x) * (level - a.y) / (b.y - a.y));
            }
        }
    }
    range
}

/// Whether the foot, the wider end, is at small z.
fn foot_is_up(name: &str, ring: &[MeasuredPoint]) -> Result<bool> {
    let (low, high) = bounds(ring);
    let depth = PART * (high.y - low.y);
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
        return Err(at_line(name, ring[0].line, &value, "a foot wider than the head", remedy));
    }
    Ok(up > down)
}

/// How an outline comes into the frame of a rail: z turned over or not, then a shift.
struct Frame {
    upside_down: bool,
    shift: Vector2<f64>,
}

impl Frame {
    fn of(name: &str, ring: &[MeasuredPoint], findings: &mut Vec<Finding>) -> Result<Self> {
        check_size(name, ring, "correct the unit of the file, or its scale")?;
        let upside_down = foot_is_up(name, ring)?;
        if upside_down {
            let text = "z counts upwards: turned over, so that the foot is below";
            findings.push(Finding::new(FindingKind::UpsideDown, Action::Repaired, text));
        }
        let turned = Self { upside_down, shift: Vector2::zeros() };
        let ring: Vec<MeasuredPoint> =
            ring.iter().map(|p| MeasuredPoint { point: turned.point(&p.point), ..*p }).collect();
        let (low, high) = bounds(&ring);
        let foot = width(&ring, high.y - PART * (high.y - low.y)..=high.y);
        let shift = Vector2::new(-0.5 * (foot.0 + foot.1), -low.y);
        if shift.amax() < IN_PLACE {
            return Ok(turned);
        }
        let text = format!(
            "moved by ({:.4}, {:.4}) mm: the middle of the foot to y = 0, the top to z = 0",
            shift.x / MILLIMETRE,
            shift.y / MILLIMETRE
        );
        findings.push(
            Finding::new(FindingKind::Origin, Action::Repaired, text)
                .with_value(shift.norm() / MILLIMETRE, "mm"),
        );
        Ok(Self { upside_down, shift })
    }

    fn point(&self, p: &Point2<f64>) -> Point2<f64> {
        Point2::new(p.x, if self.upside_down { -p.y } else { p.y }) + self.shift
    }

    fn segment(&self, segment: &Segment) -> Segment {
        match *segment {
            Segment::Line { start, end } => Segment::line(self.point(&start), self.point(&end)),
            Segment::Arc { centre, radius, start_angle, sweep } => {
                let sense = if self.upside_down { -1.0 } else { 1.0 };
                let (start_angle, sweep) = (sense * start_angle, sense * sweep);
                Segment::Arc { centre: self.point(&centre), radius, start_angle, sweep }
            }
        }
    }
}

/// Whether a ring runs over its top to the field side.
fn runs_to_the_field_side(ring: &[MeasuredPoint]) -> bool {
    ring.windows(2).map(|pair| pair[0].point.coords.perp(&pair[1].point.coords)).sum::<f64>() > 0.0
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

#[cfg(test)]
mod tests;
