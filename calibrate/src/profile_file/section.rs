//! The closed outline of a rail or a wheel in a file: lines and arcs, a drawing, or columns of points.
//!
//! Lines and arcs say how they lie; an outline of the other kinds is turned upright and moved into the frame of its profile, and every such step
//! is a finding.

mod rail;
mod wheel;

use std::ops::RangeInclusive;

use nalgebra::{Point2, Vector2};

use super::dxf::ClosedShape;
use super::finding::{Action, Finding, FindingKind};
use super::kinks::find_kinks;
use super::loops::first_crossing;
use super::{
    MeasuredPoint, Part, ProfileFormat, ProfileKind, ReadOptions, columns, drawn, dxf, recognised, text,
};
use crate::error::{Error, InputError, Result};
use crate::profile::lines_and_arcs::LinesAndArcs;
use crate::profile::{Piece, ProfileCurve, Segment, polyline};
use crate::units::MILLIMETRE;

pub use rail::parse_rail_section;
pub use wheel::parse_wheel_section;

/// Points nearer to each other are one, m.
const SAME_POINT: f64 = 1e-3 * MILLIMETRE;
/// Longest step that closes an outline of points without being said to be open, m.
const LONGEST_CLOSURE: f64 = 5.0 * MILLIMETRE;
/// A turn from here on goes back, degrees.
const CUSP: f64 = 150.0;
/// A shift below this is none, m.
const IN_PLACE: f64 = 1e-6 * MILLIMETRE;
/// Step on arcs where an outline is looked at by points, m.
const STEP: f64 = 0.2 * MILLIMETRE;
/// A chord this many times as long as a typical one on the running surface, and at least `LEAST_LONG`, is a straight side.
const LONG: f64 = 5.0;
/// m.
const LEAST_LONG: f64 = 1.0 * MILLIMETRE;
/// Fewest points of an outline.
const FEWEST: usize = 12;

/// The closed section of a rail or a wheel from a file, in the profile frame, m.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedSection {
    /// Format of the file.
    pub format: ProfileFormat,
    /// Points, or lines and arcs, that the file gives.
    pub count: usize,
    /// The running surface, towards the field side.
    pub running: ProfileCurve,
    /// The rest of the outline, from the end of `running` back to its start.
    pub rest: Vec<Segment>,
    /// What was found and done.
    pub findings: Vec<Finding>,
}

/// An outline as it is drawn in its file, and the places at which it is at fault, in the axes of the file, m.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sketch {
    /// Points around it; empty where the file has no outline.
    pub points: Vec<Point2<f64>>,
    /// Places at which it is open, turns back or crosses itself, and which of these it is.
    pub faults: Vec<(Point2<f64>, String)>,
}

impl Sketch {
    /// An outline that is open between its ends.
    fn open(&mut self, points: &[MeasuredPoint]) {
        self.points = points.iter().map(|p| p.point).collect();
        let ends = [(points.first(), "begins here, open"), (points.last(), "ends here, open")];
        self.faults = ends.into_iter().filter_map(|(p, text)| Some((p?.point, text.to_owned()))).collect();
    }
}

/// The outline of the file of a section as it is drawn, with the section itself or what is wrong with it. `name` is used in messages, and its
/// ending tells the format where the content does not.
pub fn sketch_section(name: &str, bytes: &[u8], kind: ProfileKind) -> (Sketch, Result<ClosedSection>) {
    let mut sketch = Sketch::default();
    let outline = Outline::sketched(name, bytes, kind, &mut sketch);
    let section = outline.and_then(|_| match kind {
        ProfileKind::Rail => parse_rail_section(name, bytes),
        ProfileKind::Wheel => parse_wheel_section(name, bytes, None),
    });
    (sketch, section)
}

/// An outline that is closed and sound, in the axes of its file, m.
struct Outline {
    format: ProfileFormat,
    /// Points, or lines and arcs, that the file gives.
    count: usize,
    shape: Shape,
    /// Points around it; the last one is the first.
    ring: Vec<MeasuredPoint>,
    findings: Vec<Finding>,
}

enum Shape {
    /// A table of lines and arcs, which lies as it says.
    Table(LinesAndArcs),
    /// The lines and arcs of a drawing, each with its line of the file.
    Drawn(Vec<(Segment, usize)>),
    /// The points of the ring.
    Points,
}

/// Widths and heights of sections, m: from mine rails to crane rails; of a wheel from the bore to the tip of its flange.
fn size_of(kind: ProfileKind) -> RangeInclusive<f64> {
    match kind {
        ProfileKind::Rail => 0.04..=0.3,
        ProfileKind::Wheel => 0.1..=0.8,
    }
}

fn said_size(kind: ProfileKind) -> String {
    let size = size_of(kind);
    format!("a section of {} to {} mm", 1e3 * size.start(), 1e3 * size.end())
}

fn outline_of(kind: ProfileKind) -> &'static str {
    match kind {
        ProfileKind::Rail => "the closed outline of one rail section",
        ProfileKind::Wheel => "the closed outline of one wheel section, on one side of the axle",
    }
}

impl Outline {
    /// Reads the outline of a file; its size, and that it is closed and neither steps back nor crosses itself, is checked.
    fn read(name: &str, bytes: &[u8], kind: ProfileKind) -> Result<Self> {
        Self::sketched(name, bytes, kind, &mut Sketch::default())
    }

    /// The same; what is drawn, and where it is at fault, is put into `sketch`.
    fn sketched(name: &str, bytes: &[u8], kind: ProfileKind, sketch: &mut Sketch) -> Result<Self> {
        dxf::refuse_binary(name, bytes)?;
        let text = text::decode(name, bytes)?;
        let ending = std::path::Path::new(name).extension();
        let ending = ending.map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        match recognised(&text, &ending) {
            Some(ProfileFormat::LinesAndArcs) => Self::table(name, &text, kind, sketch),
            Some(ProfileFormat::Dxf) => {
                let remedy = "leave the outline of the section alone in the drawing, one closed line";
                let dxf::Closed { shape, unit, findings } = dxf::closed_line(name, &text, remedy)?;
                match shape {
                    ClosedShape::Segments(drawn) => Self::drawn(name, kind, drawn, unit, (findings, sketch)),
                    ClosedShape::Points(points) => {
                        Self::vertices(name, kind, ProfileFormat::Dxf, points, unit, (findings, sketch))
                    }
                }
            }
            Some(format @ (ProfileFormat::Simpack | ProfileFormat::MiniProf)) => {
                let value = format!("a {format} file, which holds a running surface");
                let remedy = "give a running surface as `profile_file` on a standard section";
                Err(InputError::new(name, value, outline_of(kind), remedy).into())
            }
            Some(ProfileFormat::Text | ProfileFormat::Csv) | None => {
                let part = Part { name: None, field: "the part".into() };
                let raw = columns::parse(name, &text, &ending, &part)?;
                Self::vertices(name, kind, raw.format, raw.points, raw.unit, (raw.findings, sketch))
            }
        }
    }

    fn table(name: &str, text: &str, kind: ProfileKind, sketch: &mut Sketch) -> Result<Self> {
        let options = ReadOptions { kind: Some(kind), ..ReadOptions::default() };
        let read = drawn::read(name, text, &options)?;
        let [first, last] = [read.points[0], read.points[read.points.len() - 1]];
        let Some(lines) = read.drawn.filter(|lines| !lines.rest.is_empty()) else {
            sketch.open(&read.points);
            return Err(open(name, kind, &last, &first));
        };
        let ring: Vec<MeasuredPoint> = polyline(&lines.running, STEP)
            .into_iter()
            .chain(polyline(&lines.rest, STEP))
            .map(|point| MeasuredPoint { point, line: first.line, weight: 1.0 })
            .collect();
        let ring = without_duplicates(ring);
        check_ring(name, kind, &ring, sketch)?;
        check_size(name, kind, &ring, "correct the unit in the names of the columns")?;
        let count = lines.running.len() + lines.rest.len();
        let format = ProfileFormat::LinesAndArcs;
        Ok(Self { format, count, shape: Shape::Table(lines), ring, findings: read.findings })
    }

    fn drawn(
        name: &str,
        kind: ProfileKind,
        mut drawn: Vec<(Segment, usize)>,
        unit: Option<(f64, usize)>,
        (mut findings, sketch): (Vec<Finding>, &mut Sketch),
    ) -> Result<Self> {
        let sampled = |drawn: &[(Segment, usize)], step: f64| -> Vec<MeasuredPoint> {
            let of = |(segment, line): &(Segment, usize)| {
                let line = *line;
                let points = polyline(&at_its_top(segment), step);
                points.into_iter().map(move |point| MeasuredPoint { point, line, weight: 1.0 })
            };
            drawn.iter().flat_map(of).collect()
        };
        // Ends and middles of arcs show the size before the unit is known.
        let scale = unit_of(name, kind, &sampled(&drawn, f64::INFINITY), unit, &mut findings)?;
        drawn.iter_mut().for_each(|(segment, _)| *segment = segment.scaled(scale));
        let ring = without_duplicates(sampled(&drawn, STEP));
        check_ring(name, kind, &ring, sketch)?;
        check_size(name, kind, &ring, "correct the unit of the file, or its scale")?;
        let (format, count) = (ProfileFormat::Dxf, drawn.len());
        Ok(Self { format, count, shape: Shape::Drawn(drawn), ring, findings })
    }

    fn vertices(
        name: &str,
        kind: ProfileKind,
        format: ProfileFormat,
        mut points: Vec<MeasuredPoint>,
        unit: Option<(f64, usize)>,
        (mut findings, sketch): (Vec<Finding>, &mut Sketch),
    ) -> Result<Self> {
        let count = points.len();
        let line = points.last().map_or(1, |p| p.line);
        let few = || {
            let value = format!("{count} points");
            let expected = format!("at least {FEWEST} points around a section");
            at_line(name, line, &value, expected, "give the whole outline")
        };
        if count < FEWEST {
            return Err(few());
        }
        let scale = unit_of(name, kind, &points, unit, &mut findings)?;
        points.iter_mut().for_each(|p| p.point *= scale);
        close(name, kind, &mut points, &mut findings).inspect_err(|_| sketch.open(&points))?;
        let ring = without_duplicates(points);
        if ring.len() < FEWEST {
            return Err(few());
        }
        check_ring(name, kind, &ring, sketch)?;
        check_size(name, kind, &ring, "correct the unit of the file, or its scale")?;
        Ok(Self { format, count, shape: Shape::Points, ring, findings })
    }
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

/// The curve through the points of a running surface: splines, with straight lines where the points are far apart, and corners.
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
        // A straight side is a separate piece.
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
    kind: ProfileKind,
    points: &[MeasuredPoint],
    stated: Option<(f64, usize)>,
    findings: &mut Vec<Finding>,
) -> Result<f64> {
    let extent = extent(points).max();
    let wrong = |line: usize, remedy: &str| {
        let expected = said_size(kind);
        at_line(name, line, &format!("an outline {extent:.4} units across"), expected, remedy)
    };
    if let Some((unit, line)) = stated {
        let line = if line == 0 { points[0].line } else { line };
        let remedy = "the unit of the file does not fit its numbers: correct it, or its scale";
        return if size_of(kind).contains(&(unit * extent)) { Ok(unit) } else { Err(wrong(line, remedy)) };
    }
    let fits: Vec<(f64, &str)> = [(MILLIMETRE, "mm"), (1.0, "m")]
        .into_iter()
        .filter(|(unit, _)| size_of(kind).contains(&(unit * extent)))
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
fn close(
    name: &str,
    kind: ProfileKind,
    points: &mut Vec<MeasuredPoint>,
    findings: &mut Vec<Finding>,
) -> Result<()> {
    let n = points.len();
    let step = |i: usize| (points[i + 1].point - points[i].point).norm();
    let gap = (points[n - 1].point - points[0].point).norm();
    let usual = step(0).max(step(n - 2));
    if gap > SAME_POINT && (gap > 2.0 * usual || gap > LONGEST_CLOSURE) {
        return Err(open(name, kind, &points[n - 1], &points[0]));
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

fn open(name: &str, kind: ProfileKind, end: &MeasuredPoint, start: &MeasuredPoint) -> Error {
    let place = |p: &Point2<f64>| format!("({:.3}, {:.3}) mm", p.x / MILLIMETRE, p.y / MILLIMETRE);
    let value = format!(
        "an open outline: it ends at {} and began at {} on line {}, {:.3} mm away",
        place(&end.point),
        place(&start.point),
        start.line,
        (end.point - start.point).norm() / MILLIMETRE
    );
    let remedy = "close the outline, its last point the first again; a running surface alone is a `profile_file` on a standard section";
    at_line(name, end.line, &value, outline_of(kind), remedy)
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

/// Refuses a ring that steps back or crosses itself, and puts the place into `sketch`.
fn check_ring(name: &str, kind: ProfileKind, ring: &[MeasuredPoint], sketch: &mut Sketch) -> Result<()> {
    sketch.points = ring.iter().map(|p| p.point).collect();
    let n = ring.len() - 1;
    let place = |p: &Point2<f64>| format!("({:.3}, {:.3}) mm", p.x / MILLIMETRE, p.y / MILLIMETRE);
    for i in 0..n {
        let (before, here, after) = (&ring[(i + n - 1) % n], &ring[i], &ring[(i + 1) % n]);
        let turn = (here.point - before.point).angle(&(after.point - here.point)).to_degrees();
        if turn > CUSP {
            let value =
                format!("a cusp at {} in the axes of the file, a turn of {turn:.0}°", place(&here.point));
            let remedy = "remove the point, or what is drawn twice there";
            sketch.faults.push((here.point, "cusp".into()));
            return Err(at_line(name, here.line, &value, outline_of(kind), remedy));
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
        sketch.faults.push((at, "crossing".into()));
        return Err(at_line(name, ring[j].line, &value, outline_of(kind), remedy));
    }
    Ok(())
}

fn bounds(points: &[MeasuredPoint]) -> (Point2<f64>, Point2<f64>) {
    let first = points[0].point;
    points.iter().fold((first, first), |(low, high), p| (low.inf(&p.point), high.sup(&p.point)))
}

fn extent(points: &[MeasuredPoint]) -> Vector2<f64> {
    let (low, high) = bounds(points);
    high - low
}

fn check_size(name: &str, kind: ProfileKind, ring: &[MeasuredPoint], remedy: &str) -> Result<()> {
    let size = extent(ring);
    let sizes = size_of(kind);
    if sizes.contains(&size.x) && sizes.contains(&size.y) {
        return Ok(());
    }
    let value =
        format!("an outline {:.3} mm wide and {:.3} mm high", size.x / MILLIMETRE, size.y / MILLIMETRE);
    let expected = said_size(kind);
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

/// How an outline comes into the frame of its profile: turned over or not, then shifted.
#[derive(Clone, Copy)]
struct Frame {
    mirrored: bool,
    upside_down: bool,
    shift: Vector2<f64>,
}

impl Frame {
    fn point(&self, p: &Point2<f64>) -> Point2<f64> {
        let sense = |turned: bool| if turned { -1.0 } else { 1.0 };
        Point2::new(sense(self.mirrored) * p.x, sense(self.upside_down) * p.y) + self.shift
    }

    fn ring(&self, ring: &[MeasuredPoint]) -> Vec<MeasuredPoint> {
        ring.iter().map(|p| MeasuredPoint { point: self.point(&p.point), ..*p }).collect()
    }

    fn segment(&self, segment: &Segment) -> Segment {
        let segment = if self.mirrored { segment.mirrored() } else { *segment };
        let placed =
            |p: Point2<f64>| Point2::new(p.x, if self.upside_down { -p.y } else { p.y }) + self.shift;
        match segment {
            Segment::Line { start, end } => Segment::line(placed(start), placed(end)),
            Segment::Arc { centre, radius, start_angle, sweep } => {
                let sense = if self.upside_down { -1.0 } else { 1.0 };
                let (start_angle, sweep) = (sense * start_angle, sense * sweep);
                Segment::Arc { centre: placed(centre), radius, start_angle, sweep }
            }
        }
    }

    /// The shift as a finding; none if there is none.
    fn say_shift(&self, what: &str, findings: &mut Vec<Finding>) {
        if self.shift.amax() >= IN_PLACE {
            let [y, z] = [self.shift.x, self.shift.y].map(|v| v / MILLIMETRE);
            let text = format!("moved by ({y:.4}, {z:.4}) mm: {what}");
            let length = self.shift.norm() / MILLIMETRE;
            findings.push(Finding::new(FindingKind::Origin, Action::Repaired, text).with_value(length, "mm"));
        }
    }
}

/// Whether a ring runs along its running surface to the field side; a rail's body lies below that, a wheel's above.
fn runs_to_the_field_side(kind: ProfileKind, ring: &[MeasuredPoint]) -> bool {
    let turns: f64 = ring.windows(2).map(|pair| pair[0].point.coords.perp(&pair[1].point.coords)).sum();
    (turns > 0.0) == (kind == ProfileKind::Rail)
}

/// Direction of a ring of `n` points at the point `i`, taken over a length (m) after it or before it.
fn direction(
    n: usize,
    at: &impl Fn(usize) -> MeasuredPoint,
    i: usize,
    forward: bool,
    over: f64,
) -> Vector2<f64> {
    let here = at(i).point;
    let other = |k: usize| at(if forward { i + k } else { i + n - k }).point;
    let far = (1..n).map(other).find(|p| (p - here).norm() >= over).unwrap_or(here);
    (if forward { far - here } else { here - far }).try_normalize(0.0).unwrap_or_default()
}

#[cfg(test)]
mod tests;
