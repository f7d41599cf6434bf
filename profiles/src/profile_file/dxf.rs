//! Drawings as ASCII DXF: lines, arcs, polylines and splines of the drawing's plane and of its blocks, joined to one line.
//!
//! x of the drawing is y of the profile, y of the drawing is z. Measured polylines are taken by their vertices, drawn
//! lines and arcs by points close enough for the curve.

mod placement;
mod curves;
mod chain;
mod groups;
mod blocks;
mod entities;
mod inserts;

use std::fmt::Write;

use nalgebra::Point2;

use self::chain::{Chain, join};
use self::curves::{Path, Piece};
use self::entities::{Entity, Shape, count};
use super::finding::{Action, Finding, FindingKind};
use super::format::ProfileFormat;
use super::measured::{MeasuredPoint, push};
use super::part::Part;
use super::raw::{Convention, Raw};
use super::text::{error_on, lines, shown};
use crate::error::{Error, InputError, Result, on_line};
use crate::profile::{OF_THE_FILE, Segment, Sketch};
use crate::units::MILLIMETRE;

/// Points along the extent of the profile: 0.2 mm apart on a head or wheel.
const STEPS: f64 = 600.0;
/// From this number of straight pieces alone on a line is a measured one.
const MEASURED: usize = 20;
/// Longest line, in extents; a head is 2 long.
const LONGEST: f64 = 20.0;
/// Joined ends further apart than this part of the extent are said.
const EXACT: f64 = 1e-6;
/// Chains that a message lists.
const LISTED: usize = 8;

pub(super) fn recognises(text: &str, ending: &str) -> bool {
    let mut filled = lines(text).map(|(_, line)| line.trim());
    let mut group = || (filled.next(), filled.next());
    let mut first = group();
    while first.0 == Some("999") {
        first = group();
    }
    ending == "dxf" || first == (Some("0"), Some("SECTION"))
}

/// Refuses the binary form of the format.
pub(super) fn refuse_binary(name: &str, bytes: &[u8]) -> Result<()> {
    if !bytes.starts_with(b"AutoCAD Binary DXF") {
        return Ok(());
    }
    Err(error_on(name, 1, "binary DXF", "DXF as text", "export the drawing as ASCII DXF"))
}

/// The lines of a drawing, joined where they meet.
struct Joined {
    chains: Vec<Chain>,
    /// Length of the unit, m, and the line that says so.
    unit: Option<(f64, usize)>,
    findings: Vec<Finding>,
}

impl Joined {
    /// What the chains are, for messages.
    fn list(&self) -> String {
        let described = self.chains.iter().enumerate().take(LISTED);
        let mut list: Vec<String> = described.map(|(i, chain)| describe(i, chain)).collect();
        if self.chains.len() > LISTED {
            list.push(format!("and {} more", self.chains.len() - LISTED));
        }
        list.join("; ")
    }
}

/// The lines of the drawing, or of the layer that `part` names; whether it names one.
fn joined(name: &str, text: &str, part: &Part) -> Result<(Joined, bool)> {
    let drawing = entities::read(name, text)?;
    let mut findings = Vec::new();
    if let Some(line) = drawing.cut_off {
        let text = "the file ends among its entities, without ENDSEC: it may be cut off";
        findings.push(Finding::new(FindingKind::Header, Action::Left, text).on_lines(line, line));
    }
    let on_layer =
        |entity: &Entity| part.name.is_some_and(|wanted| entity.layer.eq_ignore_ascii_case(wanted.trim()));
    let (entities, inserted) = inserts::in_place(&drawing.blocks, name, drawing.entities)?;
    let without_blocks = inserted.is_none();
    findings.extend(inserted);
    let by_layer = entities.iter().any(on_layer);
    let (wanted, others): (Vec<Entity>, Vec<Entity>) =
        entities.into_iter().partition(|entity| !by_layer || on_layer(entity));
    pass_over(&others, Action::Noted, "on other layers", &mut findings);
    let mut paths = Vec::new();
    let (mut unread, mut texts, mut points) = (Vec::new(), Vec::new(), Vec::new());
    for entity in wanted {
        match entity.shape {
            Shape::Path(mut path) if path.pieces.iter().all(|(piece, _)| is_finite(piece)) => {
                if !path.pieces.is_empty() {
                    path.layer = entity.layer;
                    paths.push(path);
                }
            }
            Shape::Path(_) => {
                return Err(error_on(
                    name,
                    entity.line,
                    "",
                    "finite coordinates",
                    "export the drawing again",
                ));
            }
            Shape::Point(at) if at.iter().all(|v| v.is_finite()) => points.push((at, entity)),
            Shape::Point(_) => texts.push(entity),
            Shape::Unread(_) | Shape::Insert(_) => unread.push(entity),
            Shape::Other(_) => texts.push(entity),
        }
    }
    // Points alone are a measured profile in their order; beside curves they mark something.
    if paths.is_empty() && points.len() >= MEASURED {
        let mut path = Path { layer: points[0].1.layer.clone(), ..Path::default() };
        for pair in points.windows(2) {
            path.add(Piece::Line(pair[0].0, pair[1].0), pair[0].1.line);
        }
        paths.push(path);
        let text = format!("{} POINT entities: taken in their order as the profile", points.len());
        findings.push(Finding::new(FindingKind::Columns, Action::Noted, text));
    } else {
        texts.extend(points.into_iter().map(|(_, entity)| entity));
    }
    pass_over(
        &unread,
        Action::Left,
        "not read: turn them into lines, arcs or polylines if they are part of the profile",
        &mut findings,
    );
    pass_over(&texts, Action::Noted, "no lines of the profile", &mut findings);
    let nothing = paths.is_empty();
    let (chains, left_out) = join(name, paths)?;
    if chains.is_empty() {
        let expected = "lines, arcs, polylines or splines among the entities of the drawing";
        let idle = drawing.blocks.list();
        let remedy = if without_blocks && !idle.is_empty() {
            format!("insert the block that has the profile, the drawing inserts none of {idle}")
        } else {
            "draw the profile with these, and export the drawing as ASCII DXF".to_owned()
        };
        let found = if nothing {
            count(unread.iter().chain(&texts).map(kind_of))
        } else {
            "lines without length".into()
        };
        return Err(error_on(name, 1, &found, expected, remedy));
    }
    if let (Some(first), Some(last)) = (left_out.iter().min(), left_out.iter().max()) {
        let count = if left_out.len() == 1 { "1 line".into() } else { format!("{} lines", left_out.len()) };
        let text = format!("{count} on top of another, or shorter than a gap: left out");
        findings.push(Finding::new(FindingKind::PassedOver, Action::Noted, text).on_lines(*first, *last));
    }
    Ok((Joined { chains, unit: drawing.unit, findings }, by_layer))
}

/// The points of the open line of a drawing that is the profile; of lines that are refused because they do not meet, all are put into `sketch`.
pub(super) fn parse(name: &str, text: &str, part: &Part, sketch: &mut Sketch) -> Result<Raw> {
    let (mut joined, by_layer) = joined(name, text, part)?;
    let chains = &joined.chains;
    let list = || joined.list();
    let number = part.name.filter(|_| !by_layer).map(|wanted| wanted.trim().parse::<usize>());
    let chosen = match number {
        None if chains.len() == 1 => 0,
        Some(Ok(number)) if (1..=chains.len()).contains(&number) => number - 1,
        None => {
            draw(&joined, sketch);
            mark_step(&joined, sketch);
            let value = format!("{} lines that do not meet", chains.len());
            let expected = format!("one line, the running surface; the drawing has {}", list());
            let remedy =
                format!("give {} as the layer or the number of one of them, or close the gaps", part.field);
            return Err(error_on(name, first_line(&chains[1]), &value, expected, remedy));
        }
        Some(_) => {
            let expected = format!("the name of a layer or the number of a line: {}", list());
            let remedy = format!("correct {}", part.field);
            return Err(error_on(
                name,
                first_line(&chains[0]),
                part.name.unwrap_or_default(),
                expected,
                remedy,
            ));
        }
    };
    let said = describe(chosen, &chains[chosen]);
    let left = chains.len() - 1;
    let chain = joined.chains.swap_remove(chosen);
    let mut findings = joined.findings;
    if chain.closed {
        return Err(closed(name, &chain, part));
    }
    let others = if left > 0 { format!("; {left} other lines are not used") } else { String::new() };
    let text = format!("x of the drawing is y, y is z; the profile is line {said}{others}");
    findings.push(Finding::new(FindingKind::Columns, Action::Noted, text));
    let points = sample(name, &chain, &mut findings)?;
    Ok(Raw {
        format: ProfileFormat::Dxf,
        kind: None,
        convention: Convention::Free,
        unit: joined.unit,
        points,
        findings,
    })
}

/// A closed line of a drawing, in its axes and unit.
pub(super) struct Closed {
    pub shape: ClosedShape,
    /// Length of the unit, m, and the line that says so.
    pub unit: Option<(f64, usize)>,
    pub findings: Vec<Finding>,
}

/// What a closed line consists of; the lines are those of the file.
pub(super) enum ClosedShape {
    /// Lines and arcs, each where the one before it ended.
    Segments(Vec<(Segment, usize)>),
    /// Vertices of a line that was measured or is no circle somewhere.
    Points(Vec<MeasuredPoint>),
}

/// The one closed line of a drawing.
///
/// # Errors
/// As [`parse`]; no closed line, with the gap, which is put into `sketch`, or several.
pub(super) fn closed_line(name: &str, text: &str, remedy: &str, sketch: &mut Sketch) -> Result<Closed> {
    let whole = Part { name: None, field: String::new() };
    let (mut joined, _) = joined(name, text, &whole)?;
    let closed: Vec<usize> = (0..joined.chains.len()).filter(|&i| joined.chains[i].closed).collect();
    let expected = "one closed line, the outline of the section";
    let [chosen] = closed[..] else {
        if closed.is_empty() {
            let longest = joined.chains.iter().max_by(|a, b| a.path.length().total_cmp(&b.path.length()));
            let Some((chain, [end, start])) = longest.and_then(|c| Some((c, c.path.ends()?))) else {
                return InputError::refuse(name, "no line with ends", expected, remedy);
            };
            draw(&joined, sketch);
            let scale = scale(&joined);
            sketch.mark_ends(start * scale, end * scale);
            let value = format!(
                "an open outline: a gap of {:.4} from ({:.4}, {:.4}) to ({:.4}, {:.4}), in units of the drawing",
                (end - start).norm(),
                start.x,
                start.y,
                end.x,
                end.y
            );
            let remedy = "close the outline at this place, its ends within 1e-4 of the drawing's extent";
            return Err(on_line(name, first_line(chain), value, expected, remedy));
        }
        let value = format!("{} closed lines: {}", closed.len(), joined.list());
        let line = first_line(&joined.chains[closed[1]]);
        return Err(on_line(name, line, value, expected, remedy));
    };
    let said = describe(chosen, &joined.chains[chosen]);
    let left = joined.chains.len() - 1;
    let chain = joined.chains.swap_remove(chosen);
    let mut findings = joined.findings;
    let others = if left > 0 { format!("; {left} open lines are not used") } else { String::new() };
    let text = format!("x of the drawing is y, y is z; the outline is line {said}{others}");
    findings.push(Finding::new(FindingKind::Columns, Action::Noted, text));
    let pieces = &chain.path.pieces;
    let measured = is_measured(pieces);
    let drawn = !pieces.iter().any(|(piece, _)| matches!(piece, Piece::Spline(_)));
    let segment = |piece: &Piece| match *piece {
        Piece::Arc { centre, radius, start, sweep } => {
            Segment::Arc { centre, radius, start_angle: start, sweep }
        }
        _ => Segment::line(piece.ends()[0], piece.ends()[1]),
    };
    let shape = if drawn && !measured {
        ClosedShape::Segments(pieces.iter().map(|(piece, line)| (segment(piece), *line)).collect())
    } else {
        ClosedShape::Points(sample(name, &chain, &mut findings)?)
    };
    Ok(Closed { shape, unit: joined.unit, findings })
}

/// Length of the unit of a drawing, m: as it says, or mm or m as its size shows.
fn scale(joined: &Joined) -> f64 {
    /// Greatest extent of a drawing in m.
    const METRES: f64 = 2.0;
    let ends = joined.chains.iter().filter_map(|chain| chain.path.ends()).flatten();
    let largest = ends.map(|p| p.coords.amax()).fold(0.0, f64::max);
    joined.unit.map_or(if largest < METRES { 1.0 } else { MILLIMETRE }, |(unit, _)| unit)
}

/// Draws all lines of a drawing.
fn draw(joined: &Joined, sketch: &mut Sketch) {
    /// Parts of an arc or a spline.
    const PARTS: u32 = 40;
    let scale = scale(joined);
    let points = |piece: &Piece| -> Vec<Point2<f64>> {
        let parts = if matches!(piece, Piece::Line(..)) { 1 } else { PARTS };
        (0..=parts).map(|i| piece.point(f64::from(i) / f64::from(parts)) * scale).collect()
    };
    let stroke = |chain: &Chain| chain.path.pieces.iter().flat_map(|(piece, _)| points(piece)).collect();
    sketch.draw(joined.chains.iter().map(stroke).collect(), OF_THE_FILE);
}

/// Marks the nearest ends of different lines.
fn mark_step(joined: &Joined, sketch: &mut Sketch) {
    let ends: Vec<(usize, Point2<f64>)> = (joined.chains.iter().enumerate())
        .filter(|(_, chain)| !chain.closed)
        .flat_map(|(i, chain)| chain.path.ends().into_iter().flatten().map(move |end| (i, end)))
        .take(LISTED * LISTED)
        .collect();
    let pairs = ends.iter().enumerate().flat_map(|(k, a)| ends[k + 1..].iter().map(move |b| (a, b)));
    let step = pairs
        .filter(|(a, b)| a.0 != b.0)
        .min_by(|(a, b), (c, d)| (a.1 - b.1).norm_squared().total_cmp(&(c.1 - d.1).norm_squared()));
    let Some(((one, a), (other, b))) = step else { return };
    let fault = format!(
        "nearest ends of lines {} and {}, {:.4} apart in units of the drawing",
        one + 1,
        other + 1,
        (a - b).norm()
    );
    sketch.mark(nalgebra::center(a, b) * scale(joined), fault);
}

fn is_finite(piece: &Piece) -> bool {
    let sound = !matches!(piece, Piece::Arc { radius, .. } if !(*radius > 0.0));
    sound && [0.0, 0.5, 1.0].into_iter().all(|t| piece.point(t).iter().all(|v| v.is_finite()))
}

fn kind_of(entity: &Entity) -> String {
    match &entity.shape {
        Shape::Unread(kind) | Shape::Other(kind) => kind.clone(),
        Shape::Point(_) => "POINT".into(),
        Shape::Insert(_) => "INSERT".into(),
        Shape::Path(_) => "curves".into(),
    }
}

fn pass_over(entities: &[Entity], action: Action, why: &str, findings: &mut Vec<Finding>) {
    let lines = entities.iter().map(|entity| entity.line);
    let Some((first, last)) = lines.clone().min().zip(lines.max()) else { return };
    let text = format!("{}: {why}", shown_long(&count(entities.iter().map(kind_of))));
    findings.push(Finding::new(FindingKind::PassedOver, action, text).on_lines(first, last));
}

/// A list of kinds, of bounded length.
fn shown_long(list: &str) -> String {
    const MOST: usize = 12;
    let all: Vec<String> = list.split(", ").map(shown).collect();
    let more = if all.len() > MOST { ", \u{2026}" } else { "" };
    format!("{}{more}", all[..all.len().min(MOST)].join(", "))
}

/// Whether a line is one that was measured, straight between its vertices.
fn is_measured(pieces: &[(Piece, usize)]) -> bool {
    pieces.len() >= MEASURED && pieces.iter().all(|(piece, _)| matches!(piece, Piece::Line(..)))
}

fn first_line(chain: &Chain) -> usize {
    chain.path.pieces[0].1
}

fn describe(index: usize, chain: &Chain) -> String {
    let pieces = chain.path.pieces.len();
    let place = |p: Point2<f64>| format!("({:.3}, {:.3})", p.x, p.y);
    let course = match chain.path.ends() {
        Some([a, b]) if !chain.closed => format!("from {} to {}", place(a), place(b)),
        Some([a, _]) => format!("closed, through {}", place(a)),
        None => String::new(),
    };
    let pieces = if pieces == 1 { "1 piece".into() } else { format!("{pieces} pieces") };
    format!("{} (layer \"{}\", {pieces}, {course})", index + 1, shown(&chain.path.layer))
}

fn closed(name: &str, chain: &Chain, part: &Part) -> Error {
    let value = format!("a closed line of {} pieces", chain.path.pieces.len());
    let remedy = format!(
        "leave the running surface alone on a layer, open at its ends, and give that layer as {}",
        part.field
    );
    error_on(name, first_line(chain), &value, "an open line, the running surface", remedy)
}

/// Points on the chain: the vertices of a measured line, or points close enough for the curve.
fn sample(name: &str, chain: &Chain, findings: &mut Vec<Finding>) -> Result<Vec<MeasuredPoint>> {
    let pieces = &chain.path.pieces;
    let (low, high) = pieces
        .iter()
        .flat_map(|(piece, _)| {
            [piece.point(0.0), piece.point(0.25), piece.point(0.5), piece.point(0.75), piece.point(1.0)]
        })
        .fold(
            (Point2::new(f64::INFINITY, f64::INFINITY), Point2::new(f64::NEG_INFINITY, f64::NEG_INFINITY)),
            |(low, high), p| (low.inf(&p), high.sup(&p)),
        );
    let extent = (high - low).norm();
    let length = chain.path.length();
    if !(length <= LONGEST * extent) || extent == 0.0 {
        let value = format!("a line {length:.3} long within {extent:.3}");
        return Err(error_on(
            name,
            first_line(chain),
            &value,
            "a single running surface",
            "delete all other lines",
        ));
    }
    if chain.largest_gap > EXACT * extent {
        let text =
            format!("greatest gap of joined ends {:.6}, in units of the drawing: bridged", chain.largest_gap);
        findings.push(Finding::new(FindingKind::Gap, Action::Repaired, text));
    }
    let measured = is_measured(pieces);
    let step = extent / STEPS;
    let mut points = Vec::new();
    for (piece, line) in pieces {
        let parts = if measured { 1 } else { piece.parts(step) };
        for i in 0..parts {
            let p = piece.point(i as f64 / parts as f64);
            push(name, &mut points, p.x, p.y, *line, 1.0)?;
        }
    }
    if let Some(([_, end], (_, line))) = chain.path.ends().zip(pieces.last()) {
        push(name, &mut points, end.x, end.y, *line, 1.0)?;
    }
    if !measured {
        let text = format!("{} lines and curves taken by {} points", pieces.len(), points.len());
        findings.push(Finding::new(FindingKind::Columns, Action::Noted, text));
    }
    Ok(points)
}

/// A drawing in mm with the profile as a polyline, y of the drawing being z.
pub(super) fn write(points: &[MeasuredPoint], comment: &str) -> String {
    let mut out = format!(
        "999\n{comment}\n0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n\
         0\nPOLYLINE\n8\nprofile\n66\n1\n70\n0\n"
    );
    for p in points {
        // Writing to a string cannot fail.
        let _ = write!(
            out,
            "0\nVERTEX\n8\nprofile\n10\n{}\n20\n{}\n",
            p.point.x / MILLIMETRE,
            p.point.y / MILLIMETRE
        );
    }
    out.push_str("0\nSEQEND\n8\nprofile\n0\nENDSEC\n0\nEOF\n");
    out
}
