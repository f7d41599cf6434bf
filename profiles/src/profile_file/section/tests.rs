//! The outline of 60E1 in files of all kinds, and outlines that are at fault.

use std::fmt::Write;

use nalgebra::Point2;
use railspring_testing::dxf::{self, Entity};

use super::*;
use crate::profile::Segment;
use crate::profile::lines_and_arcs;
use crate::profile::polyline;
use crate::profile::rails::rail_outline;
use crate::section::{RailSection, rail_section, rail_section_on};
use crate::units::MILLIMETRE;

/// Step of the points on the arcs of the head and of the rest, m; the latter is that of the body's vertices.
const STEPS: [f64; 2] = [0.2 * MILLIMETRE, 2.0 * MILLIMETRE];
/// ROUNDOFF: the digits of the files, 1e-6 mm, on 0.7 m of perimeter, m².
const DIGITS: f64 = 1e-9 * 0.7;

/// The points of 60E1 around the section, the first one again at the end, mm.
fn points() -> Vec<Point2<f64>> {
    let outline = rail_outline("60E1").unwrap();
    let mut points = polyline(&outline.running, STEPS[0]);
    points.extend(polyline(&outline.rest, STEPS[1]).into_iter().skip(1));
    points.iter().map(|p| p / MILLIMETRE).collect()
}

fn columns_of(points: &[Point2<f64>]) -> String {
    points.iter().fold(String::from("y,z\n"), |mut text, p| {
        let _ = writeln!(text, "{:.6},{:.6}", p.x, p.y);
        text
    })
}

/// Lines and arcs as a drawing, each where `place` puts it, in no order.
pub(super) fn drawing(outline: &[Segment], place: impl Fn(Point2<f64>) -> Point2<f64>) -> String {
    let at = |p: Point2<f64>| <[f64; 2]>::from(place(p) / MILLIMETRE);
    dxf::drawing(outline.iter().rev().map(|segment| {
        let ends = [at(segment.start()), at(segment.end())];
        match *segment {
            Segment::Line { .. } => Entity::Line(ends),
            Segment::Arc { centre, .. } => Entity::Arc { ends, centre: at(centre) },
        }
    }))
}

/// Lines and arcs of 60E1 as a drawing with y up, moved to the right and up.
fn drawing_of(segments: &[Segment]) -> String {
    drawing(segments, |p| Point2::new(p.x + 0.2, 0.3 - p.y))
}

fn section(name: &str, text: &str) -> (RailSection, Vec<String>) {
    let read = parse_rail_section(name, text.as_bytes()).unwrap();
    let findings = read.findings.iter().map(ToString::to_string).collect();
    (rail_section_on(name, read.running, read.rest), findings)
}

fn refused(name: &str, text: &str) -> String {
    parse_rail_section(name, text.as_bytes()).unwrap_err().to_string()
}

/// Source: 60E1 from its drawing. Goal: a DXF of its lines and arcs, elsewhere in the drawing, with y up and in another order, is that
/// section: area, second moments, height, the vertices of the body, and what was done is said. Accuracy: the digits of the file.
#[test]
fn a_drawing_of_lines_and_arcs_is_the_section() {
    let outline = rail_outline("60E1").unwrap();
    let all: Vec<Segment> = outline.running.iter().chain(&outline.rest).copied().collect();
    let (found, findings) = section("rail.dxf", &drawing_of(&all));
    let standard = rail_section("60E1").unwrap();
    assert!((found.area.area - standard.area.area).abs() < DIGITS, "{:?}", found.area);
    assert!((found.area.ixx / standard.area.ixx - 1.0).abs() < 1e-6, "{:?}", found.area);
    assert!((found.area.iyy / standard.area.iyy - 1.0).abs() < 1e-6, "{:?}", found.area);
    assert_eq!(found.body.len(), standard.body.len());
    assert!(found.body.iter().zip(&standard.body).all(|(a, b)| (a - b).norm() < 1e-9));
    assert!((found.running.length() - standard.running.length()).abs() < 1e-9);
    let said = findings.join("\n");
    for part in ["unit", "turned over", "moved by (-200.0000, 300.0000) mm"] {
        assert!(said.contains(part), "{part}: {said}");
    }
}

/// Source: 60E1 from its drawing. Goal: its points as columns, from another point on, the other way round, z up and in metres, are that
/// section. Accuracy: the highest point lies up to h²/8R = 17 nm below the
/// top of the crown. The head is a spline within 50 nm over its 0.2 m. Of the rest the polygon lacks R²/2 (φ - sin φ) under every chord
/// of angle φ, and has as much too much where the arc is hollow.
#[test]
fn columns_of_points_are_the_section() {
    let outline = rail_outline("60E1").unwrap();
    let lacking: f64 = outline.rest.iter().fold(0.0, |sum, segment| match *segment {
        Segment::Line { .. } => sum,
        Segment::Arc { radius, sweep, .. } => {
            let chords = (segment.length() / STEPS[1]).ceil();
            let angle = sweep / chords;
            sum + chords * 0.5 * radius * radius * (angle - angle.sin())
        }
    });
    let standard = rail_section("60E1").unwrap();
    let spline = 50e-9 * 0.2;
    let plain = points();
    let mut turned: Vec<Point2<f64>> =
        plain[1..].iter().map(|p| Point2::new(p.x / 1e3, (90.0 - p.y) / 1e3)).collect();
    turned.rotate_left(400);
    turned.reverse();
    turned.push(turned[0]);
    let metres = turned.iter().fold(String::from("y_m;z_m\n"), |mut text, p| {
        let _ = writeln!(text, "{:.9};{:.9}", p.x, p.y);
        text
    });
    for text in [columns_of(&plain), metres] {
        let (found, findings) = section("rail.csv", &text);
        let difference = standard.area.area - found.area.area;
        assert!((difference - lacking).abs() < DIGITS + spline, "{difference:e} {lacking:e} {findings:?}");
        assert_eq!(found.body.len(), standard.body.len(), "{findings:?}");
        assert!(found.body.iter().zip(&standard.body).all(|(a, b)| (a - b).norm() < 20e-9));
        assert!(found.running.kinks().is_empty(), "{:?}", found.running.kinks());
    }
}

/// Goal: outlines that cannot be sections are refused with the place and a remedy: open, crossing, a cusp, in other units, no foot, no
/// head, two outlines, a table that is upside down.
#[test]
fn faulty_outlines_are_refused_with_their_place() {
    let said = |name: &str, text: &str, parts: &[&str]| {
        let message = refused(name, text);
        assert!(parts.iter().all(|part| message.contains(part)), "{parts:?}: {message}");
    };
    let whole = points();
    let head: Vec<_> = whole.iter().copied().filter(|p| p.y < 30.0).collect();
    said(
        "rail.csv",
        &columns_of(&head),
        &["rail.csv:", "open outline", "mm away", "close the outline", "profile_file"],
    );

    let mut crossing = whole.clone();
    let web = crossing.iter().position(|p| p.y > 80.0).unwrap();
    crossing.swap(web, web + 8);
    said("rail.csv", &columns_of(&crossing), &["rail.csv:", "outline"]);
    crossing = whole.clone();
    crossing[200].y += 60.0;
    crossing[201].y += 60.0;
    crossing[201].x -= 1.0;
    said("rail.csv", &columns_of(&crossing), &["crosses itself at (", "remove the loop"]);

    let mut cusp = whole.clone();
    cusp[150].y -= 8.0;
    said("rail.csv", &columns_of(&cusp), &["a cusp at (", "a turn of"]);

    let inches: Vec<_> = whole.iter().map(|p| p / 25.4).collect();
    said("rail.csv", &columns_of(&inches), &["units across", "neither mm nor m"]);
    let wrong = columns_of(&whole).replace("y,z", "y_m,z_m");
    said("rail.csv", &wrong, &["rail.csv:1", "units across", "does not fit"]);

    let circle: Vec<_> = (0..=90)
        .map(|i| (4.0 * f64::from(i)).to_radians().sin_cos())
        .map(|(sin, cos)| Point2::new(80.0 * sin, 80.0 * cos))
        .collect();
    said("rail.csv", &columns_of(&circle), &["wide at the top", "a foot wider than the head"]);
    let wedge: Vec<_> = (0..=40)
        .map(|i| Point2::new(-20.0 + f64::from(i), 0.0))
        .chain((0..=40).map(|i| Point2::new(60.0 - 3.0 * f64::from(i), 120.0)))
        .chain([Point2::new(-20.0, 0.0)])
        .collect();
    said("rail.csv", &columns_of(&wedge), &["without a head"]);

    said("rail.prr", "header.begin\n", &["a Simpack file, which holds a running surface", "`profile_file`"]);

    let outline = rail_outline("60E1").unwrap();
    let all: Vec<Segment> = outline.running.iter().chain(&outline.rest).copied().collect();
    said(
        "rail.dxf",
        &drawing_of(&all[1..]),
        &["an open outline: a gap of", "in units of the drawing", "close"],
    );
    let small: Vec<Segment> = all.iter().map(|s| s.scaled(0.5)).collect();
    let two = drawing_of(&all).replace("0\nENDSEC\n0\nEOF\n", "")
        + &drawing_of(&small).replace("0\nSECTION\n2\nENTITIES\n", "");
    said("rail.dxf", &two, &["2 closed lines", "alone in the drawing"]);

    let table = |segments: &[Segment]| lines_and_arcs::write(ProfileKind::Rail, segments);
    assert_eq!(section("rail.csv", &table(&all)).0.body.len(), rail_section("60E1").unwrap().body.len());
    said("rail.csv", &table(&outline.running), &["open outline", "profile_file"]);
    let overturned = table(&all).replace("z: down", "z: up");
    said("rail.csv", &overturned, &["rail.csv:", "top of the rail at z = 0", "`# z:`"]);
}
