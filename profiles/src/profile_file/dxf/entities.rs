//! The entities of a DXF file, and what else of it is read.

use std::collections::BTreeMap;

use nalgebra::Point2;

use super::blocks::{Blocks, Insert};
use super::curves::{Nurbs, Path, Piece};
use super::groups::{Groups, groups};
use super::placement::Placement;
use crate::error::Result;
use crate::profile::ProfileCurve;
use crate::profile_file::text::error_on;

/// An entity that can be part of a profile.
#[derive(Clone)]
pub(super) struct Entity {
    pub layer: String,
    pub line: usize,
    pub shape: Shape,
}

/// What an entity is.
#[derive(Clone)]
pub(super) enum Shape {
    /// A curve in the plane of the drawing.
    Path(Path),
    /// A block at a place, until its entities are put there.
    Insert(Insert),
    /// A curve that leaves the plane of the drawing, or is of a kind that is not read.
    Unread(String),
    /// A point, which is one of a measured profile where the drawing has no curves.
    Point(Point2<f64>),
    /// No curve: a text, a dimension.
    Other(String),
}

/// What is read of a drawing.
pub(super) struct Drawing<'a> {
    pub entities: Vec<Entity>,
    pub blocks: Blocks<'a>,
    /// Length of the unit, m, and the line that says so.
    pub unit: Option<(f64, usize)>,
    /// The last line of a file that ends among its entities.
    pub cut_off: Option<usize>,
}

/// Reads the entities of the drawing itself, and the blocks that it may insert; those of paper layouts are no part of it.
pub(super) fn read<'a>(name: &'a str, text: &'a str) -> Result<Drawing<'a>> {
    let mut drawing = Drawing { entities: Vec::new(), blocks: Blocks::default(), unit: None, cut_off: None };
    let mut section = "";
    let mut named = false;
    let mut variable = "";
    let mut entity: Option<Groups> = None;
    let mut polyline: Option<Polyline> = None;
    let mut last_line = 1;
    for group in groups(name, text) {
        let group = group?;
        last_line = group.line;
        if group.code != 0 {
            match (section, &mut entity) {
                ("", _) if named && group.code == 2 => section = group.value.trim(),
                ("HEADER", _) if group.code == 9 => variable = group.value.trim(),
                ("HEADER", _) if group.code == 70 && variable == "$INSUNITS" => {
                    drawing.unit = unit(group.value).map(|unit| (unit, group.line));
                }
                (_, Some(entity)) => entity.of.push(group),
                _ => {}
            }
            continue;
        }
        match entity.take() {
            Some(groups) if section == "BLOCKS" => drawing.blocks.add(groups),
            Some(groups) => finish(&groups, &mut polyline, &mut drawing.entities)?,
            None => {}
        }
        let word = group.value.trim();
        match word {
            "SECTION" => (section, named) = ("", true),
            "ENDSEC" | "EOF" => (section, named) = ("", false),
            _ if ["ENTITIES", "BLOCKS"].contains(&section) => {
                entity = Some(Groups { file: name, name: word, line: group.line, of: Vec::new() });
            }
            _ => {}
        }
    }
    if let Some(groups) = entity.take().filter(|_| section == "ENTITIES") {
        finish(&groups, &mut polyline, &mut drawing.entities)?;
    }
    if let Some(polyline) = polyline {
        drawing.entities.push(polyline.finish()?);
    }
    drawing.cut_off = (section == "ENTITIES").then_some(last_line);
    Ok(drawing)
}

/// The entities of a block.
pub(super) fn entities_of(groups: &[Groups]) -> Result<Vec<Entity>> {
    let (mut entities, mut polyline) = (Vec::new(), None);
    groups.iter().try_for_each(|groups| finish(groups, &mut polyline, &mut entities))?;
    entities.extend(polyline.map(Polyline::finish).transpose()?);
    Ok(entities)
}

/// Length of the unit of `$INSUNITS`, m.
fn unit(value: &str) -> Option<f64> {
    Some(match value.trim() {
        "1" => 0.0254,
        "2" => 0.3048,
        "4" => 1e-3,
        "5" => 1e-2,
        "6" => 1.0,
        "13" => 1e-6,
        "14" => 0.1,
        _ => return None,
    })
}

/// A polyline whose vertices are entities as well.
struct Polyline {
    layer: String,
    line: usize,
    flags: i64,
    mirrored: Option<bool>,
    vertices: Vec<Vertex>,
}

struct Vertex {
    at: Point2<f64>,
    z: f64,
    bulge: f64,
    line: usize,
}

/// Turns the groups of an entity into one, or adds them to the polyline that is open.
fn finish(groups: &Groups, polyline: &mut Option<Polyline>, entities: &mut Vec<Entity>) -> Result<()> {
    if let Some(open) = polyline {
        match groups.name {
            "VERTEX" => {
                // Bit 4: a control point of a curve that the other vertices follow.
                if groups.flags(70)? & 16 == 0 {
                    let (at, z, line) = *groups.points(10)?.first().ok_or_else(|| groups.missing(10))?;
                    open.vertices.push(Vertex { at, z, bulge: groups.last(42)?.unwrap_or(0.0), line });
                }
                return Ok(());
            }
            name => {
                entities.extend(polyline.take().map(Polyline::finish).transpose()?);
                if name == "SEQEND" {
                    return Ok(());
                }
            }
        }
    }
    let paper = groups.flags(67)? == 1;
    let (layer, line) = (groups.layer(), groups.line);
    let mut add = |shape: Shape| entities.push(Entity { layer: layer.clone(), line, shape });
    let in_plane = |mirrored: Option<bool>, path: &dyn Fn() -> Result<Option<Path>>| -> Result<Shape> {
        let unread = || Shape::Unread(format!("{} in another plane", groups.name));
        let Some(mirrored) = mirrored else { return Ok(unread()) };
        let Some(mut path) = path()? else { return Ok(unread()) };
        if mirrored {
            path = path.placed(&Placement::mirror());
        }
        Ok(Shape::Path(path))
    };
    match groups.name {
        _ if paper => {}
        "POLYLINE" => {
            let (flags, mirrored) = (groups.flags(70)?, groups.mirrored()?);
            *polyline = Some(Polyline { layer, line, flags, mirrored, vertices: Vec::new() });
        }
        "LINE" => {
            let ends = [groups.points(10)?, groups.points(11)?];
            let [Some(a), Some(b)] = ends.each_ref().map(|points| points.first()) else {
                return Err(groups.missing(if ends[0].is_empty() { 10 } else { 11 }));
            };
            let flat = a.1 == b.1;
            let path = Path::of(Piece::Line(a.0, b.0), line);
            add(if flat { Shape::Path(path) } else { Shape::Unread("LINE in another plane".into()) });
        }
        "ARC" => {
            let (centre, _, _) = *groups.points(10)?.first().ok_or_else(|| groups.missing(10))?;
            let radius = groups.required(40)?;
            let [start, end] = [groups.required(50)?, groups.required(51)?].map(f64::to_radians);
            let sweep = (end - start).rem_euclid(std::f64::consts::TAU);
            let sweep = if sweep == 0.0 { std::f64::consts::TAU } else { sweep };
            let arc = Piece::Arc { centre, radius, start, sweep };
            add(in_plane(groups.mirrored()?, &|| Ok(Some(Path::of(arc.clone(), line))))?);
        }
        "LWPOLYLINE" => {
            let vertices = lightweight(groups)?;
            let closed = groups.flags(70)? & 1 == 1;
            add(in_plane(groups.mirrored()?, &|| Ok(Some(path_of(&vertices, closed))))?);
        }
        "SPLINE" => add(match spline(groups)? {
            Some(curve) => Shape::Path(Path::of(Piece::Spline(curve), line)),
            None => fitted(groups)?
                .map_or_else(|| Shape::Unread("SPLINE in space or without points".into()), Shape::Path),
        }),
        "POINT" => {
            let (at, _, _) = *groups.points(10)?.first().ok_or_else(|| groups.missing(10))?;
            add(Shape::Point(at));
        }
        "INSERT" => add(match Insert::of(groups)? {
            Some(insert) => Shape::Insert(insert),
            None => Shape::Unread("INSERT in another plane".into()),
        }),
        // The end of the attributes of an insertion.
        "SEQEND" => {}
        "CIRCLE" | "ELLIPSE" | "MLINE" | "HELIX" | "3DFACE" | "REGION" | "3DSOLID" | "BODY" | "TRACE" => {
            add(Shape::Unread(groups.name.into()));
        }
        other => add(Shape::Other(other.into())),
    }
    Ok(())
}

impl Polyline {
    fn finish(self) -> Result<Entity> {
        /// Bits of meshes: a mesh of points, one of faces.
        const MESHES: i64 = 16 | 64;
        let Self { layer, line, flags, mirrored, vertices, .. } = self;
        let flat = vertices.windows(2).all(|pair| pair[0].z == pair[1].z);
        let shape = match mirrored.filter(|_| flags & MESHES == 0 && flat) {
            None => Shape::Unread("POLYLINE in another plane".into()),
            Some(mirrored) => {
                let mut path = path_of(&vertices, flags & 1 == 1);
                // A polyline in space (bit 3) has the axes of the drawing.
                if mirrored && flags & 8 == 0 {
                    path = path.placed(&Placement::mirror());
                }
                Shape::Path(path)
            }
        };
        Ok(Entity { layer, line, shape })
    }
}

/// The vertices of a polyline that holds them itself.
fn lightweight(groups: &Groups) -> Result<Vec<Vertex>> {
    let mut vertices: Vec<Vertex> =
        groups.points(10)?.into_iter().map(|(at, z, line)| Vertex { at, z, bulge: 0.0, line }).collect();
    let mut index = 0;
    for group in &groups.of {
        match group.code {
            10 => index += 1,
            42 if index > 0 => vertices[index - 1].bulge = groups.number_of(group)?,
            _ => {}
        }
    }
    Ok(vertices)
}

fn path_of(vertices: &[Vertex], closed: bool) -> Path {
    let mut path = Path::default();
    let count = vertices.len();
    let last = if closed && count > 2 { count } else { count.saturating_sub(1) };
    for i in 0..last {
        let (from, to) = (&vertices[i], &vertices[(i + 1) % count]);
        if from.at != to.at {
            path.add(Piece::with_bulge(from.at, to.at, from.bulge), from.line);
        }
    }
    path
}

/// The curve of a spline, if it lies in the plane of the drawing and has control points.
fn spline(groups: &Groups) -> Result<Option<Nurbs>> {
    let points = groups.points(10)?;
    let Some(first) = points.first() else { return Ok(None) };
    if points.iter().any(|point| point.1 != first.1) {
        return Ok(None);
    }
    let weights = groups.all(41)?;
    let weights = if weights.is_empty() { vec![1.0; points.len()] } else { weights };
    let curve = Nurbs {
        degree: groups.required(71)? as usize,
        knots: groups.all(40)?,
        points: points.iter().map(|point| point.0).collect(),
        weights,
    };
    if curve.is_sound() {
        return Ok(Some(curve));
    }
    let expected = "a spline with as many weights as control points and rising knots for its degree";
    Err(error_on(
        groups.file,
        groups.line,
        "SPLINE",
        expected,
        "export the drawing again, with arcs or polylines",
    ))
}

/// The curve through the fit points of a spline that has no control points, by chords short enough for a measured line; none without such points in
/// the plane of the drawing.
fn fitted(groups: &Groups) -> Result<Option<Path>> {
    /// Chords along the curve, for each of its fit points.
    const CHORDS: f64 = 16.0;
    let fit = groups.points(11)?;
    let in_space = fit.iter().any(|point| point.1 != fit[0].1);
    let mut points: Vec<Point2<f64>> = fit.iter().map(|point| point.0).collect();
    points.dedup();
    if in_space || points.len() < 4 || !groups.points(10)?.is_empty() {
        return Ok(None);
    }
    let Ok(curve) = ProfileCurve::from_points(&points, &[]) else { return Ok(None) };
    let chords = curve.sample(curve.length() / (CHORDS * points.len() as f64));
    let mut path = Path::default();
    chords.windows(2).for_each(|pair| path.add(Piece::Line(pair[0], pair[1]), groups.line));
    Ok(Some(path))
}

/// How many entities there are of each name.
pub(super) fn count(names: impl Iterator<Item = String>) -> String {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    names.for_each(|name| *counts.entry(name).or_default() += 1);
    counts.iter().map(|(name, count)| format!("{count} {name}")).collect::<Vec<_>>().join(", ")
}
