//! Wheels of the tool in files of all kinds, and outlines that are at fault.

use std::fmt::Write;

use super::super::parse_wheel_section;
use super::super::tests::drawing;
use super::*;
use crate::profile::lines_and_arcs::{Overrides, parse, write};
use crate::profile::polyline;
use crate::profile::wheels::wheel_profile;
use crate::section::{
    WebShape, WheelBody, WheelSection, body_of_revolution, wheel_section_of, wheel_section_on,
};

const DIAMETER: f64 = 0.92;
/// ROUNDOFF: 1e-6 mm, the digits of the files, of a wheel of half a metre: of its lengths, and threefold of its mass.
const DIGITS: f64 = 1e-8;

/// Wheel LMA, which is lines and arcs throughout: its section, and its outline from the flange back on.
fn lma(web: WebShape) -> (WheelSection, Vec<Segment>) {
    let table = parse("LMA", include_str!("../../../profile/wheels/LMA.csv"), &Overrides::default()).unwrap();
    let body = WheelBody { web, ..WheelBody::default() };
    let section = wheel_section_on(table.curve(), "LMA", DIAMETER, &body).unwrap();
    let outline = table.running.iter().chain(&section.body_outline).copied().collect();
    (section, outline)
}

fn table(outline: &[Segment]) -> String {
    write(ProfileKind::Wheel, outline)
}

/// Points around a section, mm: on the running surface and on arcs 0.2 mm apart.
fn points(section: &WheelSection) -> Vec<Point2<f64>> {
    let count = (section.running.length() / (0.2 * MILLIMETRE)).ceil();
    let on = |i: usize| section.running.point(section.running.length() * i as f64 / count);
    let mut points: Vec<_> = (0..=count as usize).map(on).collect();
    points.extend(polyline(&section.body_outline, 0.2 * MILLIMETRE).into_iter().skip(1));
    points.iter().map(|p| p / MILLIMETRE).collect()
}

fn columns(points: &[Point2<f64>]) -> String {
    points.iter().fold(String::from("y_mm,z_mm\n"), |mut text, p| {
        let _ = writeln!(text, "{:.6},{:.6}", p.x, p.y);
        text
    })
}

fn read(name: &str, text: &str) -> (WheelSection, String) {
    let read = parse_wheel_section(name, text.as_bytes(), None).unwrap();
    let findings: Vec<String> = read.findings.iter().map(ToString::to_string).collect();
    (wheel_section_of(name, read.running, read.rest, DIAMETER).unwrap(), findings.join("\n"))
}

/// Largest relative difference of mass and moments of inertia, and that of the centre of mass over the tape diameter.
fn difference(a: &WheelSection, b: &WheelSection) -> f64 {
    let [a, b] = [a, b].map(|section| body_of_revolution(section, 7850.0));
    let ratios =
        [(a.mass, b.mass), (a.axle_inertia, b.axle_inertia), (a.diameter_inertia, b.diameter_inertia)];
    let ratio = ratios.into_iter().map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
    ratio.max((a.centre_y - b.centre_y).abs() / DIAMETER)
}

/// Source: wheel LMA on the generic webs. Goal: a drawing of its lines and arcs, turned over both ways, elsewhere and in another order, and
/// their table, are that wheel: mass, centre and inertia, running surface and bore; what was done is said. Accuracy: the digits of the files.
#[test]
fn lines_and_arcs_are_the_wheel() {
    for web in [WebShape::Straight, WebShape::S] {
        let (standard, outline) = lma(web);
        let turned = drawing(&outline, |p| Point2::new(0.3 - p.x, 0.1 - p.y));
        let (drawn, said) = read("wheel.dxf", &turned);
        for part in ["turned over, so that the flange is below", "at the gauge side", "moved by"] {
            assert!(said.contains(part), "{part}: {said}");
        }
        let (from_table, _) = read("wheel.csv", &table(&outline));
        for found in [drawn, from_table] {
            assert!(
                difference(&found, &standard) < 5.0 * DIGITS,
                "{web:?}: {:e}",
                difference(&found, &standard)
            );
            assert!((found.bore_radius - standard.bore_radius).abs() < 5e-9, "{}", found.bore_radius);
            assert!((found.running.length() - standard.running.length()).abs() < 5e-9);
            assert!((found.running.point(0.0) - standard.running.point(0.0)).norm() < 5e-9);
        }
    }
}

/// Source: wheel LMA, whose drawing lies with its tape circle at the origin. Goal: another distance of the tape circle from the flange back moves the origin by
/// the difference, down to the tread there; a distance beyond the tread is refused by the name of its field. Accuracy: the digits of the files.
#[test]
fn the_tape_circle_may_be_elsewhere() {
    let (standard, outline) = lma(WebShape::Straight);
    let drawn = drawing(&outline, |p| p);
    let read = |distance: f64| parse_wheel_section("wheel.dxf", drawn.as_bytes(), Some(distance));
    let moved = read(72.231 * MILLIMETRE).unwrap().running;
    let aside = 2.231 * MILLIMETRE;
    let tread = standard.running.point(standard.running.s_at_y(aside).unwrap());
    let expected = standard.running.point(0.0) - tread.coords;
    assert!((moved.point(0.0) - expected).norm() < 5e-9, "{} {expected}", moved.point(0.0));
    let beyond = read(200.0 * MILLIMETRE).unwrap_err().to_string();
    assert!(beyond.contains("tape"), "{beyond}");
}

/// Source: S1002 on the generic webs. Goal: its points, from another one on and the other way round, z up, are that wheel. Accuracy: a polygon with
/// steps of 0.2 mm lies h²/12R, 0.1 µm, beside arcs of R30 on the mean, over 0.2 m of a section of 0.02 m²: 1e-6, and up to 10 times that in the inertia about
/// a diameter and the first moments.
#[test]
fn points_are_the_wheel() {
    for web in [WebShape::Straight, WebShape::S] {
        let body = WheelBody { web, ..WheelBody::default() };
        let standard = wheel_section_on(wheel_profile("S1002").unwrap(), "S1002", DIAMETER, &body).unwrap();
        let mut turned = points(&standard);
        turned.pop();
        turned.rotate_left(500);
        turned.reverse();
        turned.iter_mut().for_each(|p| *p = Point2::new(p.x + 12.0, 400.0 - p.y));
        turned.push(turned[0]);
        let (found, said) = read("wheel.csv", &columns(&turned));
        assert!(
            said.contains("turned over, so that the flange is below") && !said.contains("gauge side"),
            "{said}"
        );
        assert!(difference(&found, &standard) < 1e-5, "{web:?}: {:e}", difference(&found, &standard));
        assert!((found.bore_radius - standard.bore_radius).abs() < 0.2e-6, "{}", found.bore_radius);
        let [start, end] =
            [&found, &standard].map(|s| [s.running.point(0.0), s.running.point(s.running.length())]);
        assert!((0..2).all(|i| (start[i] - end[i]).norm() < 1e-6), "{start:?} {end:?}");
    }
}

/// Goal: outlines that cannot be wheels are refused with place and remedy: a rail, no bore, a cusp, a crossing, open, a running surface closed by a
/// line, a diameter for which there is no bore.
#[test]
fn faulty_wheels_are_refused_with_their_place() {
    let said = |name: &str, text: &str, parts: &[&str]| {
        let message = parse_wheel_section(name, text.as_bytes(), None).unwrap_err().to_string();
        assert!(parts.iter().all(|part| message.contains(part)), "{parts:?}: {message}");
    };
    let (standard, outline) = lma(WebShape::Straight);
    let whole = points(&standard);
    // The bore of a wheel that is pointed there.
    let least = whole.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let at = whole.iter().position(|p| p.y == least).unwrap();
    let mut pointed = whole.clone();
    pointed.insert(at + 1, Point2::new(0.0, least - 20.0));
    said("wheel.csv", &columns(&pointed), &["wheel.csv:", "no bore", "at least 20 mm"]);

    let mut cusp = whole.clone();
    cusp[300].y -= 8.0;
    said("wheel.csv", &columns(&cusp), &["wheel.csv:302", "a cusp at ("]);
    let mut crossing = whole.clone();
    let through = [(10.0, least), (40.0, 10.0), (45.0, 10.0), (-60.0, least)].map(|(y, z)| Point2::new(y, z));
    crossing.splice(at + 1..at + 1, through);
    said("wheel.csv", &columns(&crossing), &["crosses itself at ("]);
    said("wheel.csv", &columns(&whole[..whole.len() - 200]), &["open outline", "close the outline"]);
    said("wheel.dxf", &drawing(&outline[1..], |p| p), &["an open outline: a gap of"]);
    let running = outline.len() - standard.body_outline.len();
    said("wheel.csv", &table(&outline[..running]), &["open outline"]);
    let mirrored: Vec<Point2<f64>> = whole.iter().map(|p| Point2::new(p.y, p.x)).collect();
    said("wheel.csv", &columns(&mirrored), &["wheel.csv:"]);
    let inches = columns(&whole.iter().map(|p| p / 25.4).collect::<Vec<_>>());
    said("wheel.csv", &inches, &["wheel.csv:", "mm"]);
    let rail = crate::profile::rails::rail_outline("60E1").unwrap();
    let rail: Vec<Segment> = rail.running.iter().chain(&rail.rest).copied().collect();
    said("rail.dxf", &drawing(&rail, |p| p), &["rail.dxf:"]);

    let read = parse_wheel_section("wheel.csv", columns(&whole).as_bytes(), None).unwrap();
    let small = wheel_section_of("wheel.csv", read.running, read.rest, 0.7).unwrap_err().to_string();
    assert!(small.contains("tape_diameter") && small.contains("makes the bore"), "{small}");
}
