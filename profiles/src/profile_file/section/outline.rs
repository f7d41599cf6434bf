//! The outline of a file, closed and sound, in the axes of the file.

use nalgebra::Point2;

use super::expected::{outline_of, said_size, size_of};
use super::ring::{SAME_POINT, check_ring, extent, without_duplicates};
use crate::error::{Error, InputError, Result, on_line};
use crate::profile::lines_and_arcs::LinesAndArcs;
use crate::profile::{OF_THE_FILE, OF_THE_PROFILE, ProfileKind, Segment, Sketch, polyline};
use crate::profile_file::dxf::ClosedShape;
use crate::profile_file::finding::{Action, Finding, FindingKind};
use crate::profile_file::format::ProfileFormat;
use crate::profile_file::measured::MeasuredPoint;
use crate::profile_file::options::ReadOptions;
use crate::profile_file::part::Part;
use crate::profile_file::recognition::recognised;
use crate::profile_file::{columns, drawn, dxf, text};
use crate::units::MILLIMETRE;

/// Step on arcs where an outline is looked at by points, m.
pub(super) const STEP: f64 = 0.2 * MILLIMETRE;
/// Longest step that closes an outline of points without being said to be open, m.
const LONGEST_CLOSURE: f64 = 5.0 * MILLIMETRE;
/// Fewest points of an outline.
const FEWEST: usize = 12;

/// An outline that is closed and sound, in the axes of its file, m.
pub(super) struct Outline {
    pub format: ProfileFormat,
    /// Points, or lines and arcs, that the file gives.
    pub count: usize,
    pub shape: Shape,
    /// Points around it; the last one is the first.
    pub ring: Vec<MeasuredPoint>,
    pub findings: Vec<Finding>,
}

/// What an outline consists of.
pub(super) enum Shape {
    /// A table of lines and arcs, which lies as it says.
    Table(LinesAndArcs),
    /// The lines and arcs of a drawing, each with its line of the file.
    Drawn(Vec<(Segment, usize)>),
    /// The points of the ring.
    Points,
}

impl Outline {
    /// Reads the outline of a file; its size, and that it is closed and neither steps back nor crosses itself, is checked. What is drawn,
    /// and where it is at fault, is put into `sketch`.
    pub fn read(name: &str, bytes: &[u8], kind: ProfileKind, sketch: &mut Sketch) -> Result<Self> {
        dxf::refuse_binary(name, bytes)?;
        let text = text::decode(name, bytes)?;
        let ending = std::path::Path::new(name).extension();
        let ending = ending.map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        match recognised(&text, &ending) {
            Some(ProfileFormat::LinesAndArcs) => Self::table(name, &text, kind, sketch),
            Some(ProfileFormat::Dxf) => {
                let remedy = "leave the outline of the section alone in the drawing, one closed line";
                let dxf::Closed { shape, unit, findings } = dxf::closed_line(name, &text, remedy, sketch)?;
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
                InputError::refuse(name, value, outline_of(kind), remedy)
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
        let read = drawn::read(name, text, &options, sketch)?;
        let [first, last] = [read.points[0], read.points[read.points.len() - 1]];
        let Some(lines) = read.drawn.filter(|lines| !lines.rest.is_empty()) else {
            draw_open(sketch, &read.points, OF_THE_PROFILE);
            return Err(open(name, kind, &last, &first));
        };
        let ring: Vec<MeasuredPoint> = polyline(&lines.running, STEP)
            .into_iter()
            .chain(polyline(&lines.rest, STEP))
            .map(|point| MeasuredPoint { point, line: first.line, weight: 1.0 })
            .collect();
        let ring = without_duplicates(ring);
        check_ring(name, kind, &ring, OF_THE_PROFILE, sketch)?;
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
        let scale = unit_of(name, kind, &sampled(&drawn, f64::INFINITY), (unit, true), &mut findings)?;
        drawn.iter_mut().for_each(|(segment, _)| *segment = segment.scaled(scale));
        let ring = without_duplicates(sampled(&drawn, STEP));
        check_ring(name, kind, &ring, OF_THE_FILE, sketch)?;
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
            on_line(name, line, &value, expected, "give the whole outline")
        };
        if count < FEWEST {
            return Err(few());
        }
        let scale = unit_of(name, kind, &points, (unit, format == ProfileFormat::Dxf), &mut findings)?;
        points.iter_mut().for_each(|p| p.point *= scale);
        close(name, kind, &mut points, &mut findings)
            .inspect_err(|_| draw_open(sketch, &points, OF_THE_FILE))?;
        let ring = without_duplicates(points);
        if ring.len() < FEWEST {
            return Err(few());
        }
        check_ring(name, kind, &ring, OF_THE_FILE, sketch)?;
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

/// Length of the unit, m; `stated` is what the file says, and whether that is a drawing's, which has the unit of its program's template.
fn unit_of(
    name: &str,
    kind: ProfileKind,
    points: &[MeasuredPoint],
    (stated, drawing): (Option<(f64, usize)>, bool),
    findings: &mut Vec<Finding>,
) -> Result<f64> {
    let extent = extent(points).max();
    let wrong = |line: usize, remedy: &str| {
        let expected = said_size(kind);
        on_line(name, line, format!("an outline {extent:.4} units across"), expected, remedy)
    };
    let fits = |unit: f64| size_of(kind).contains(&(unit * extent));
    let only = [(MILLIMETRE, "mm"), (1.0, "m")].into_iter().find(|(unit, _)| fits(*unit));
    if let Some((unit, line)) = stated {
        let line = if line == 0 { points[0].line } else { line };
        return match only.filter(|_| drawing) {
            _ if fits(unit) => Ok(unit),
            Some((other, name)) => {
                let text = format!(
                    "$INSUNITS of the drawing says a unit of {unit} m, in which it is {:.3} m across: taken as {name}, the only unit that fits",
                    unit * extent
                );
                let finding = Finding::new(FindingKind::Unit, Action::Repaired, text);
                findings.push(finding.on_lines(line, line).with_value(extent, name));
                Ok(other)
            }
            None => {
                let remedy = "the unit of the file does not fit its numbers: correct it, or its scale";
                Err(wrong(line, remedy))
            }
        };
    }
    let Some((unit, unit_name)) = only else {
        let remedy = "the unit is neither mm nor m: say it in the heading, such as y_in, z_in, or by $INSUNITS of a drawing";
        return Err(wrong(points[0].line, remedy));
    };
    let text = format!("the outline is {extent:.3} {unit_name} across, so the unit is {unit_name}");
    findings.push(Finding::new(FindingKind::Unit, Action::Noted, text).with_value(extent, unit_name));
    Ok(unit)
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

/// Draws an outline that is open between its ends.
fn draw_open(sketch: &mut Sketch, points: &[MeasuredPoint], axes: &'static str) {
    sketch.draw(vec![points.iter().map(|p| p.point).collect()], axes);
    if let (Some(first), Some(last)) = (points.first(), points.last()) {
        sketch.mark_ends(first.point, last.point);
    }
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
    on_line(name, end.line, &value, outline_of(kind), remedy)
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
    Err(on_line(name, ring[0].line, &value, expected, remedy))
}
