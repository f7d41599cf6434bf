//! What is in a profile file is read as what it is: several profiles in one table, rows without a return, drawings of
//! closed lines, holes and points that are off.
//!
//! The files are written here from the curve of a standard section, so that what has to be read is known.

use nalgebra::Point2;
use railspring_profiles::error::Error;
use railspring_profiles::profile::wheels::wheel_profile;
use railspring_profiles::profile_file::{
    Action, FindingKind, MeasuredProfile, PrepareOptions, ProfileKind, ReadOptions, parse,
    parse_rail_section, prepare,
};
use railspring_profiles::section::rail_section;

/// ROUNDOFF: numbers are written with four decimals of a millimetre.
const ROUNDOFF: f64 = 1e-7;

/// Points of the 60E1 head, mm, z down.
fn head(step_mm: f64) -> Vec<[f64; 2]> {
    points_of(rail_section("60E1").unwrap().running.sample(1e-3 * step_mm))
}

/// Points of the S1002 wheel, mm, z down.
fn wheel(step_mm: f64) -> Vec<[f64; 2]> {
    points_of(wheel_profile("S1002").unwrap().sample(1e-3 * step_mm))
}

fn points_of(points: Vec<Point2<f64>>) -> Vec<[f64; 2]> {
    points.into_iter().map(|p| [1e3 * p.x, 1e3 * p.y]).collect()
}

fn table(names: &str, rows: &[[f64; 2]]) -> String {
    let rows = rows.iter().map(|[y, z]| format!("{y:.4},{z:.4}\n"));
    format!("{names}\n{}", rows.collect::<String>())
}

fn read_as(name: &str, text: &str, part: Option<&str>) -> Result<MeasuredProfile, Error> {
    let options = ReadOptions { part: part.map(str::to_owned), ..ReadOptions::default() };
    parse(name, text.as_bytes(), &options)
}

fn read(name: &str, text: &str) -> MeasuredProfile {
    read_as(name, text, None).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(name: &str, text: &str, part: Option<&str>, says: &[&str]) {
    let error = read_as(name, text, part).map(|profile| profile.findings).unwrap_err().to_string();
    says.iter().for_each(|part| assert!(error.contains(part), "{part:?} in {error}"));
}

fn is_line(profile: &MeasuredProfile, points: &[[f64; 2]]) {
    assert_eq!(profile.points.len(), points.len());
    for (p, [y, z]) in profile.points.iter().zip(points) {
        assert!((p.point - Point2::new(1e-3 * y, 1e-3 * z)).norm() < ROUNDOFF, "{p:?}");
    }
}

fn said(profile: &MeasuredProfile) -> Vec<String> {
    let prepared = prepare(profile, &PrepareOptions::default()).unwrap();
    prepared.findings.iter().map(ToString::to_string).collect()
}

/// Source: three heads of 60E1, each lowered by another height. Goal: sections in one cloud are listed and one is chosen,
/// in whatever order their rows stand; halves of one scan at two places are one profile.
#[test]
fn several_sections_in_one_cloud_are_never_merged() {
    let head = head(0.5);
    let row = |k: usize, [y, z]: [f64; 2]| format!("{},{y:.4},{:.4}\n", 500 * k, z + 0.2 * k as f64);
    let one_by_one: String = (0..3).flat_map(|k| head.iter().map(move |p| row(k, *p))).collect();
    let in_turn: String = head.iter().flat_map(|p| (0..3).map(move |k| row(k, *p))).collect();
    for rows in [one_by_one, in_turn] {
        for names in ["x,y,z\n", "station,y,z\n", ""] {
            let text = format!("{names}{rows}");
            refused("a.csv", &text, None, &["3 profiles", "= 0", "= 500", "= 1000", "profile_part"]);
            let second: Vec<[f64; 2]> = head.iter().map(|[y, z]| [*y, z + 0.2]).collect();
            is_line(&read_as("a.csv", &text, Some("2")).unwrap(), &second);
            refused("a.csv", &text, Some("4"), &["= 1000"]);
        }
        let named = read_as("a.csv", &format!("x,y,z\n{rows}"), Some("x=1000")).unwrap();
        assert!((named.points[0].point.y - 1e-3 * (head[0][1] + 0.4)).abs() < ROUNDOFF);
        // The track runs along y.
        let turned = rows.lines().map(|row| row.split(',').collect::<Vec<_>>());
        let turned: String = turned.map(|f| format!("{},{},{}\n", f[1], f[0], f[2])).collect();
        refused("a.csv", &format!("x,y,z\n{turned}"), None, &["3 profiles", "y = 500"]);
    }
    let half = head.len() / 2;
    let halves = head.iter().enumerate().map(|(i, [y, z])| format!("{},{y:.4},{z:.4}\n", i / half.max(1)));
    is_line(&read("a.csv", &format!("scan,y,z\n{}", halves.collect::<String>())), &head);
}

/// Source: S1002 on the left side, mirrored, and on the right. Goal: both are named, and each can be chosen.
#[test]
fn left_and_right_side_by_side_are_refused_and_chosen() {
    let wheel = wheel(0.5);
    let rows = |names: &str| {
        let rows = wheel.iter().map(|[y, z]| format!("{:.4},{z:.4},{y:.4},{:.4}\n", -y, z + 0.3));
        format!("{names}\n{}", rows.collect::<String>())
    };
    for names in ["y_left,z_left,y_right,z_right", "left y [mm],left z [mm],right y [mm],right z [mm]"] {
        let text = rows(names);
        refused(
            "lr.csv",
            &text,
            None,
            &["2 profiles", "1 \"left\" (columns 1 and 2)", "2 \"right\"", "profile_part"],
        );
        refused("lr.csv", &text, Some("middle"), &["left", "right"]);
        let higher: Vec<[f64; 2]> = wheel.iter().map(|[y, z]| [*y, z + 0.3]).collect();
        is_line(&read_as("lr.csv", &text, Some("Right")).unwrap(), &higher);
        let left = read_as("lr.csv", &text, Some("1")).unwrap();
        is_line(&left, &wheel);
    }
    // A reference beside the measured columns is none of several.
    let text = rows("y_measured,z_measured,y_nominal,z_nominal");
    assert_eq!(read("lr.csv", &text).points.len(), wheel.len());
}

/// Goal: a file of an instrument without a row of numbers is refused as such, not as one of several profiles. Exact: words.
#[test]
fn a_file_of_an_instrument_without_points_says_so() {
    for text in ["", "Date=2026-01-02\nXYPoints=0\n", "<html>\n"] {
        for name in ["w.whl", "r.ban", "r.prr"] {
            let error = read_as(name, text, None).unwrap_err().to_string();
            assert!(!error.contains("single profile") && !error.contains("0 profiles"), "{name}: {error}");
        }
        refused("w.whl", text, None, &["w.whl:1", "no points", "rows of numbers"]);
    }
}

/// Goal: two blocks of MiniProf that XYPoints heads are two profiles, whatever their numbers of points.
#[test]
fn two_miniprof_blocks_are_refused() {
    let head = head(0.5);
    let block = |points: &[[f64; 2]], z: f64| {
        let rows = points.iter().map(|[y, h]| format!("{:.4} {:.4}\n", -y, z - h));
        format!("XYPoints={}\n\n{}", points.len(), rows.collect::<String>())
    };
    let text = format!("{}{}", block(&head, 0.0), block(&head[1..], -0.3));
    refused("a.ban", &text, None, &["2 profiles", "profile_part"]);
    is_line(&read_as("a.ban", &text, Some("1")).unwrap(), &head);
}

/// Source: 60E1 with values for "no return" in five rows. Goal: these are listed and dropped before unit, kind and order
/// are told; a symmetric table of few points and a flat tread repeat values without being off.
#[test]
fn rows_without_a_return_are_dropped() {
    let head = head(1.0);
    let lost = [3, 4, 5, 60, head.len() - 4];
    let left: Vec<[f64; 2]> = (0..head.len()).filter(|i| !lost.contains(i)).map(|i| head[i]).collect();
    let spoilt = |of: &dyn Fn([f64; 2]) -> [f64; 2], by: f64| -> String {
        let row = |(i, p): (usize, &[f64; 2])| if lost.contains(&i) { of(*p) } else { [p[0], p[1] + by] };
        table("Y[mm],Z[mm]", &head.iter().enumerate().map(row).collect::<Vec<_>>())
    };
    for (text, by) in [
        (spoilt(&|[y, _]| [y, -99.9999], 0.0), 0.0),
        (spoilt(&|_| [999.999, 999.999], 0.0), 0.0),
        (spoilt(&|[y, _]| [y, 0.0], 180.0), 180.0),
        (spoilt(&|_| [0.0, 0.0], 180.0), 180.0),
    ] {
        let profile = read("a.csv", &text);
        let moved: Vec<[f64; 2]> = left.iter().map(|[y, z]| [*y, z + by]).collect();
        is_line(&profile, &moved);
        let dropped = profile.findings.iter().filter(|f| f.kind == FindingKind::Spike).count();
        assert_eq!((dropped, profile.kind), (3, ProfileKind::Rail), "{:?}", profile.findings);
        let text = said(&profile).join("\n");
        assert!(!text.contains("out of order"), "{text}");
    }
    let few = [[-36.0, 14.3], [-26.0, 2.3], [-10.2, 0.2], [0.0, 0.0], [10.2, 0.2], [26.0, 2.3], [36.0, 14.3]];
    is_line(&read("few.csv", &table("y_mm,z_mm", &few)), &few);
}

/// A drawing with the entities.
fn drawing(header: &str, entities: &str) -> String {
    format!(
        "0\nSECTION\n2\nHEADER\n{header}0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n"
    )
}

/// Source: a section of 60E1 by points. Goal: one closed polyline alone is read, from any first vertex, in either direction.
#[test]
fn a_closed_polyline_alone_is_a_section() {
    let section = rail_section("60E1").unwrap();
    let running = section.running.sample(2e-4);
    let body = section.body[1..section.body.len() - 1].iter().copied();
    let outline = points_of(running.into_iter().chain(body).collect());
    for (first, back) in [(0, false), (5, false), (40, true)] {
        let mut points = outline.clone();
        points.rotate_left(first);
        if back {
            points.reverse();
        }
        let vertices = points.iter().map(|[y, z]| format!("10\n{y:.6}\n20\n{:.6}\n", -z));
        let entity =
            format!("0\nLWPOLYLINE\n8\n0\n90\n{}\n70\n1\n{}", points.len(), vertices.collect::<String>());
        let read = parse_rail_section("a.dxf", drawing("9\n$INSUNITS\n70\n4\n", &entity).as_bytes());
        read.unwrap_or_else(|error| panic!("{first} {back}: {error}"));
        // Inches fit nothing: mm is the only unit that does.
        let read = parse_rail_section("a.dxf", drawing("9\n$INSUNITS\n70\n1\n", &entity).as_bytes()).unwrap();
        assert!(read.findings.iter().any(|f| f.kind == FindingKind::Unit && f.text.contains("$INSUNITS")));
    }
}

/// Source: 60E1. Goal: a spline by its fit points alone, points alone and a drawing in mm that says inches give the head.
#[test]
fn drawings_by_points_and_with_another_unit() {
    let head = head(1.0);
    let exact = rail_section("60E1").unwrap().running;
    let fit: String = head.iter().map(|[y, z]| format!("11\n{y:.6}\n21\n{:.6}\n31\n0.0\n", -z)).collect();
    let spline = format!("0\nSPLINE\n8\n0\n70\n8\n71\n3\n74\n{}\n{fit}", head.len());
    let points: String =
        head.iter().map(|[y, z]| format!("0\nPOINT\n8\n0\n10\n{y:.6}\n20\n{:.6}\n", -z)).collect();
    let imperial = "9\n$INSUNITS\n70\n1\n";
    // MODEL: a spline through points 1 mm apart on arcs of 13 mm, whose curvature jumps at their ends.
    const MODEL: f64 = 5e-6;
    for (header, entities) in [("", &spline), ("", &points), (imperial, &points)] {
        let profile = read("a.dxf", &drawing(header, entities));
        assert_eq!(profile.kind, ProfileKind::Rail);
        let off = profile.points.iter().map(|p| (exact.point(exact.closest(&p.point).0) - p.point).norm());
        let off = off.fold(0.0, f64::max);
        assert!(off < MODEL, "{off:e}");
        let unit = profile.findings.iter().any(|f| f.text.contains("$INSUNITS") && f.text.contains("inches"));
        assert_eq!(unit, !header.is_empty());
    }
}

/// Source: S1002 with y to the track centre and the corner of its field face. Goal: the flange decides which way y counts.
#[test]
fn the_field_face_of_a_wheel_is_no_flange() {
    let wheel = wheel(0.75);
    let mut mirrored: Vec<[f64; 2]> = wheel.iter().rev().map(|[y, z]| [-y, *z]).collect();
    let end = mirrored[0];
    mirrored.insert(0, [end[0], end[1] - 13.0]);
    let profile = read("a.txt", &table("y_mm,z_mm", &mirrored));
    assert_eq!(profile.kind, ProfileKind::Wheel);
    assert!(profile.points[0].point.x < -0.05, "{:?}", profile.points[0]);
    let tip = profile.points.iter().max_by(|a, b| a.point.y.total_cmp(&b.point.y)).unwrap();
    assert!((-0.07..-0.04).contains(&tip.point.x), "{tip:?}");
}

/// Goal: what is no whole profile of one body is refused in words that fit it: a short scan, two heads, a wheel is neither.
#[test]
fn short_scans_and_two_heads_are_said_to_be_such() {
    let short: Vec<[f64; 2]> = head(0.25).into_iter().filter(|[y, _]| y.abs() < 6.8).collect();
    refused("a.csv", &table("y_mm,z_mm", &short), None, &["the profile is 13.", "at least 20 mm are needed"]);
    let one = head(0.5);
    let both = |second: f64, lower: f64, part: std::ops::Range<f64>| -> Vec<[f64; 2]> {
        let other = one.iter().filter(|[y, _]| part.contains(y)).map(|[y, z]| [y + second, z + lower]);
        one.iter().copied().chain(other).collect()
    };
    // A crossing, and a rail with a check rail that stands 5 mm lower; z counts upwards in one of them.
    for (second, lower, up) in [(112.0, 0.0, -1.0), (115.0, 5.0, 1.0)] {
        let rows: Vec<[f64; 2]> =
            both(second, lower, -40.0..40.0).iter().map(|[y, z]| [*y, up * z]).collect();
        refused("a.csv", &table("y_mm,z_mm", &rows), None, &["two heads with a groove", "one by one"]);
    }
    for (points, kind) in [(head(0.5), ProfileKind::Rail), (wheel(0.5), ProfileKind::Wheel)] {
        for up in [1.0, -1.0] {
            let rows: Vec<[f64; 2]> = points.iter().map(|[y, z]| [*y, up * z]).collect();
            assert_eq!(read("a.csv", &table("y_mm,z_mm", &rows)).kind, kind);
        }
    }
}

/// Source: 60E1. Goal: holes are found at any step, and steps along a straight flank are none.
#[test]
fn holes_are_found_and_straight_flanks_are_none() {
    let gaps = |points: &[[f64; 2]]| {
        let found = said(&read("a.csv", &table("y_mm,z_mm", points)));
        found.into_iter().filter(|finding| finding.contains("gap")).collect::<Vec<_>>()
    };
    for step in [0.25, 1.0] {
        let whole = head(step);
        assert_eq!(gaps(&whole), [] as [String; 0], "{step}");
        let corner: Vec<[f64; 2]> =
            whole.iter().copied().filter(|[y, z]| !(*y < 0.0 && (2.4..13.5).contains(z))).collect();
        assert_eq!(gaps(&corner).len(), 1, "{step}");
        let top: Vec<[f64; 2]> = whole.iter().copied().filter(|[y, _]| y.abs() > 10.0).collect();
        assert_eq!(gaps(&top).len(), 1, "{step}");
    }
    // A wheel in equal steps of y, whose flange back is steep at its first rows.
    let s1002 = wheel_profile("S1002").unwrap().sample(1e-5);
    let at = |y: f64| s1002.iter().find(|p| p.x >= 1e-3 * y).map(|p| [y, 1e3 * p.y]);
    let steps: Vec<[f64; 2]> = (0..178).filter_map(|i| at(0.75 * f64::from(i) - 69.99)).collect();
    assert_eq!(gaps(&steps), [] as [String; 0]);
    // Equal steps of y: 2 mm apart along the flank of 1:20, which the arc of 13 mm radius meets.
    let side = |y: f64| {
        let corner = (y.abs() - 23.0).max(0.0);
        y * y / 600.0 + 1.5 * (13.0 - (169.0 - corner * corner).max(0.0).sqrt())
    };
    let inner = (-355..=355).map(|i| [0.1 * f64::from(i), side(0.1 * f64::from(i))]);
    let [flank, rise] = [12, 2];
    let down = |k: i32| f64::from(rise * k) + side(35.5);
    let left = (1..=flank).rev().map(|k| [-35.5 - 0.1 * f64::from(k), down(k)]);
    let right = (1..=flank).map(|k| [35.5 + 0.1 * f64::from(k), down(k)]);
    let points: Vec<[f64; 2]> = left.chain(inner).chain(right).collect();
    assert_eq!(gaps(&points), [] as [String; 0]);
}

/// Goal: a lost point moves neither the origin of a wheel, nor does the point beside it go in its place.
#[test]
fn points_that_are_off_change_nothing_else() {
    let wheel = wheel(0.25);
    let mut rows: Vec<[f64; 2]> = wheel.iter().map(|[y, z]| [y + 70.0, *z]).collect();
    let at = rows.iter().position(|[y, _]| *y > 70.0).unwrap();
    for lost in [at - 1, at] {
        let mut spoilt = rows.clone();
        spoilt[lost][1] -= 40.0;
        let text = format!("XYPoints={}\n\n{}", rows.len(), table("", &spoilt));
        let prepared = prepare(&read("a.whl", &text), &PrepareOptions::default()).unwrap();
        let height = prepared.curve.point(prepared.curve.closest(&Point2::new(0.0, 0.0)).0).y;
        assert!(height.abs() < 1e-5, "{height:e} {:?}", prepared.findings);
    }
    rows = head(0.25);
    let off = rows.len() - 2;
    rows[off][1] += 24.0;
    let prepared = prepare(&read("a.csv", &table("y_mm,z_mm", &rows)), &PrepareOptions::default()).unwrap();
    assert_eq!(prepared.points.len(), rows.len() - 1, "{:?}", prepared.findings);
    assert_eq!(prepared.points[off].line, rows.len() + 1);
    assert!(
        prepared.findings.iter().all(|finding| finding.action != Action::Left),
        "{:?}",
        prepared.findings
    );
}
