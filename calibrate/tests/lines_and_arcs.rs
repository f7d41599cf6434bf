//! Tables of lines and arcs: a user's own standard.

use std::fmt::Write;

use nalgebra::Point2;
use railspring_calibrate::mesh::{MeshOptions, mesh_rail, quality};
use railspring_calibrate::section_analysis::rail_properties;
use railspring_profiles::placement::{TrackGeometry, place_rail};
use railspring_profiles::profile::lines_and_arcs::{LinesAndArcs, Overrides, parse, recognises};
use railspring_profiles::profile::rails::{RAIL_NAMES, rail_outline};
use railspring_profiles::profile::wheels::wheel_profile;
use railspring_profiles::profile::{ProfileKind, Segment};
use railspring_profiles::profile_file::{
    Action, FindingKind, PrepareOptions, ProfileFormat, ReadOptions, Smoothing, format_of,
    parse as read_file, prepare,
};
use railspring_profiles::section::{rail_section, rail_section_of};

/// How a table is written.
#[derive(Debug, Clone, Copy)]
struct Style {
    /// Unit and its length in m.
    unit: (&'static str, f64),
    y: &'static str,
    z: &'static str,
    separator: char,
    reversed: bool,
}

const PLAIN: Style = Style { unit: ("mm", 1e-3), y: "field", z: "down", separator: ',', reversed: false };

/// A table of segments in m, coordinates in ten digits; `more` are further lines of the heading.
fn table(kind: &str, segments: &[Segment], style: Style, more: &str) -> String {
    let mut text = format!("# made by a test\n# profile: {kind}\n# y: {}\n# z: {}\n{more}", style.y, style.z);
    let heads: Vec<String> = ["y0", "z0", "y1", "z1", "radius", "yc", "zc"]
        .iter()
        .map(|n| format!("{n}_{}", style.unit.0))
        .collect();
    writeln!(text, "index,kind,{}", heads.join(",")).unwrap();
    let all: Vec<Segment> = if style.reversed {
        segments.iter().rev().map(Segment::reversed).collect()
    } else {
        segments.to_vec()
    };
    for (i, segment) in all.iter().enumerate() {
        let place = |p: Point2<f64>| {
            let y = if style.y == "track" { -p.x } else { p.x };
            let z = if style.z == "up" { -p.y } else { p.y };
            [y, z].map(|v| format!("{:.9}", v / style.unit.1))
        };
        let ends = [place(segment.start()), place(segment.end())].concat().join(",");
        match *segment {
            Segment::Line { .. } => writeln!(text, "{},line,{ends},,,", i + 1),
            Segment::Arc { centre, radius, .. } => {
                let centre = place(centre).join(",");
                writeln!(text, "{},arc,{ends},{:.9},{centre}", i + 1, radius / style.unit.1)
            }
        }
        .unwrap();
    }
    let columns = text.find("index,kind").unwrap();
    if style.separator == ';' {
        let rows = text.split_off(columns).replace(',', ";").replace('.', ",");
        text += &rows;
    }
    text
}

fn read(text: &str) -> LinesAndArcs {
    parse("mine.csv", text, &Overrides::default()).unwrap()
}

/// Goal: every standard rail written as a table of its whole outline, in every frame, unit and order, is the same section. Accuracy:
/// ROUNDED, the file's 1e-9 of its unit (a metre at most: 1 nm), on areas times the perimeter of 0.7 m.
#[test]
fn a_whole_section_is_read_in_every_frame() {
    let styles = [
        PLAIN,
        Style { y: "track", ..PLAIN },
        Style { z: "up", reversed: true, ..PLAIN },
        Style { unit: ("in", 25.4e-3), y: "track", z: "up", ..PLAIN },
        Style { unit: ("m", 1.0), separator: ';', reversed: true, ..PLAIN },
    ];
    for &name in RAIL_NAMES.iter() {
        let outline = rail_outline(name).unwrap();
        let standard = rail_section(name).unwrap();
        let mut all: Vec<Segment> = outline.running.iter().chain(&outline.rest).copied().collect();
        for (i, style) in styles.into_iter().enumerate() {
            // wherever the table begins
            all.rotate_left(5 * i);
            let text = table("rail", &all, style, "");
            assert!(recognises(&text), "{text}");
            let found = read(&text);
            assert_eq!(found.kind, ProfileKind::Rail);
            let rounded = 1e-9 * style.unit.1;
            let same = |a: &[Segment], b: &[Segment]| {
                assert_eq!(a.len(), b.len(), "{name} {style:?}");
                a.iter().zip(b).all(|(a, b)| {
                    [0.0, 0.5, 1.0].iter().all(|&t| (a.point(t) - b.point(t)).norm() < 10.0 * rounded)
                })
            };
            assert!(same(&found.running, &outline.running), "{name} {style:?}");
            assert!(same(&found.rest, &outline.rest), "{name} {style:?}");
            let section = rail_section_of(name, found.rail_outline().unwrap());
            assert!(
                (section.area.area - standard.area.area).abs() < 0.7 * 10.0 * rounded,
                "{name} {style:?}"
            );
            assert!((section.height - standard.height).abs() < 2.0 * rounded);
        }
    }
}

/// Goal: the tables of halves that the facts have, with what they lack in the heading, are the standard rails: area, torsion, and a mesh.
/// Accuracy: their digits (1e-6 mm on 0.7 m of perimeter); the mesh beside the same nodes.
#[test]
fn half_a_section_is_unfolded() {
    for name in ["54E2", "49E1", "30E1"] {
        let Some(half) =
            railspring_testing::facts_text(&format!("geometry/more-rails/rail_{name}_half_segments.csv"))
        else {
            return;
        };
        let text = format!("# profile: rail\n# y: field\n# z: down\n# symmetric: yes\n{half}");
        let found = read(&text);
        let (section, standard) =
            (rail_section_of(name, found.rail_outline().unwrap()), rail_section(name).unwrap());
        assert!((section.area.area - standard.area.area).abs() < 1e-9 * 0.7, "{name}");
        let [ours, theirs] = [&section, &standard].map(|s| rail_properties(s).unwrap().torsion_constant);
        assert!((ours / theirs - 1.0).abs() < 1e-4, "{name}: {ours} {theirs}");
        let placed = place_rail(&section, &TrackGeometry::standard()).unwrap();
        let mesh = mesh_rail(&section, &placed, 0.1, &MeshOptions::default()).unwrap();
        assert!(quality(&mesh).unwrap().min_scaled_jacobian > 0.2, "{name}");
    }
    // a head alone, which is symmetric too, is no section
    let head = read(
        "# profile: rail\n# y: field\n# z: down\n# symmetric: yes\nkind,y0_mm,z0_mm,y1_mm,z1_mm,yc_mm,zc_mm\n\
         arc,0,0,10,0.166713,0,300\nline,10,0.166713,35,14,,\n",
    );
    assert!(head.rail_outline().is_none() && head.running.len() == 3);
    // a semicolon in another column of a table with commas separates nothing
    let more = read(
        "# profile: rail\n# y: field\n# z: down\nkind,y0_mm,z0_mm,y1_mm,z1_mm,yc_mm,zc_mm,coefficients\n\
         arc,-10,0.166713,10,0.166713,0,300,\nline,10,0.166713,35,14,,,-0.5;0.0125\n",
    );
    assert_eq!(more.running.len(), 2);
    // a roof's ridge on the axis stays one
    let roof = read(
        "# profile: rail\n# y: field\n# z: down\n# symmetric: yes\nkind,y0_mm,z0_mm,y1_mm,z1_mm,yc_mm,zc_mm\n\
         line,0,0,30,3,,\nline,30,3,35,14,,\n",
    );
    assert_eq!(roof.curve().kinks().len(), 3);
}

/// Goal: a wheel's table is a profile file: its curve is that of the standard, gaps that were closed and corners are found where they are.
/// Accuracy: equal bits, for the table is the one that the standard is made from.
#[test]
fn a_table_is_a_profile_file() {
    for (name, gaps, corners) in [("LMA", 0, 1), ("APTA120", 0, 2), ("APTA220", 0, 1)] {
        let path = format!("{}/../profiles/src/profile/wheels/{name}.csv", env!("CARGO_MANIFEST_DIR"));
        let bytes = std::fs::read(path).unwrap();
        assert_eq!(format_of("wheel.csv", &bytes), Some(ProfileFormat::LinesAndArcs));
        let profile = read_file("wheel.csv", &bytes, &ReadOptions::default()).unwrap();
        assert_eq!((profile.format, profile.kind), (ProfileFormat::LinesAndArcs, ProfileKind::Wheel));
        let prepared = prepare(&profile, &PrepareOptions::default()).unwrap();
        assert_eq!(prepared.curve, wheel_profile(name).unwrap());
        assert_eq!(prepared.kinks.len(), corners, "{name}: {:?}", prepared.findings);
        let count = |kind| prepared.findings.iter().filter(|f| f.kind == kind).count();
        assert_eq!(
            (count(FindingKind::Gap), count(FindingKind::Kink)),
            (gaps, corners),
            "{name}: {:?}",
            prepared.findings
        );
        assert!(prepared.findings.iter().all(|f| f.action != Action::Left && f.lines.is_some()), "{name}");
        let smoothed = prepare(&profile, &PrepareOptions { smoothing: Smoothing::Halves(5e-3) }).unwrap();
        assert_eq!(smoothed.curve, prepared.curve);
        assert!(smoothed.findings.iter().any(|f| f.text.contains("not smoothed")));
        // The other side of the track, and what the caller knows of the kind.
        let mirrored = ReadOptions { mirror_y: Some(true), ..ReadOptions::default() };
        let refused = read_file("wheel.csv", &bytes, &mirrored).unwrap_err().to_string();
        assert!(refused.contains("# y:"), "{refused}");
        let part = ReadOptions { part: Some("2".into()), ..ReadOptions::default() };
        let refused = read_file("wheel.csv", &bytes, &part).unwrap_err().to_string();
        assert!(refused.contains("is one profile"), "{refused}");
        let rail = ReadOptions { kind: Some(ProfileKind::Rail), ..ReadOptions::default() };
        let refused = read_file("wheel.csv", &bytes, &rail).unwrap_err().to_string();
        assert!(refused.contains("# profile:"), "{refused}");
    }
}

/// Goal: every mistake is refused with file, line, value and remedy. The heading is on lines 1 to 5 of the files, or on one line less.
#[test]
fn mistakes_are_refused_where_they_are() {
    let head = "# profile: rail\n# y: field\n# z: down\nkind,y0_mm,z0_mm,y1_mm,z1_mm,radius_mm,yc_mm,zc_mm\n";
    let rows =
        "line,-35,14,-25,1,,,\nline,-25,1,0,0,,,\narc,0,0,25,1.043479,300,0,300\nline,25,1.043479,35,14,,,\n";
    assert_eq!(read(&format!("{head}{rows}")).running.len(), 4);
    let file = |from: &str, to: &str| {
        let text = format!("{head}{rows}");
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    };
    // A circle whose first arc goes from shortly before the top to far below it.
    let place = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        format!("{:.9},{:.9}", 50.0 * sin, 50.0 - 50.0 * cos)
    };
    let round: String = [(-20.0, 145.0), (145.0, 260.0), (260.0, 340.0)]
        .map(|(from, to)| format!("arc,{},{},50,0,50\n", place(from), place(to)))
        .concat();
    let cases: &[(String, &[&str])] = &[
        (file("# profile: rail\n", ""), &["mine.csv = no line `# profile: ...`", "`# profile: wheel`"]),
        (file("rail", "track"), &["mine.csv:1 = \"track\"", "`# profile: rail`"]),
        (file("# z: down\n", ""), &["no line `# z: ...`"]),
        (file("zc_mm", "cz_mm"), &["mine.csv:4", "no column \"zc\"", "complete the heading"]),
        (file("z1_mm", "z1_m"), &["mine.csv:4", "one unit"]),
        (head.replace("_mm", "_ft") + rows, &["mine.csv:4", "\"ft\"", "mm, m or in"]),
        (head.to_owned(), &["mine.csv:4", "no rows"]),
        (
            file("-25,1,0,0", "-25,1.02,0,0"),
            &["mine.csv:6", "a gap of 0.0200 mm", "line 5 ends at (-25.0000, 1.0000)", "in the order"],
        ),
        (file("line,-25,1,0,0,,,\n", ""), &["mine.csv:6", "a gap of 25.0"]),
        (file("-25,1,0,0", "-25,1,0,zero"), &["mine.csv:6", "z1 = \"zero\""]),
        (file("-25,1,0,0", "-25,1,0,NaN"), &["mine.csv:6", "z1 = \"NaN\""]),
        (file("-25,1,0,0", "-25,1,0,1e300"), &["mine.csv:6", "z1 = \"1e300\""]),
        (file("line,-25,1,0,0,,,\n", "line,-25,1\n"), &["mine.csv:6", "y1 = \"\""]),
        (file("line,-25,1,0,0", "line,-25,1,-25,1"), &["mine.csv:6", "two different ends"]),
        (file("line,-25", "spline,-25"), &["mine.csv:6", "kind = \"spline\"", "line or arc"]),
        (file("300,0,300", "299,0,300"), &["mine.csv:7", "radius 299.0000 mm", "300.0000"]),
        (file("300,0,300", ",0,290"), &["mine.csv:7", "ends 290.0000 and"]),
        (file("300,0,300", ",,"), &["mine.csv:7", "yc = \"\""]),
        (file("# z: down", "# z: up"), &["mine.csv:", "the highest point at z = -14.0000 mm", "`# z:`"]),
        (
            file("arc,0,0,25,1.043479,300,0,300\nline,25,1.043479", "arc,0,0,25,0,12.5,12.5,0\nline,25,0"),
            &["mine.csv:7", "an arc of 180.0°", "divide the arc"],
        ),
        (
            head.to_owned() + &round,
            &["mine.csv:5", "a closed outline without a head", "sides turn under a head"],
        ),
        (
            file("# z: down\n", "# z: down\n# symmetric: yes\n"),
            &["mine.csv:6", "y = -35.0000 mm", "`# symmetric: yes`"],
        ),
        (file("# z: down\n", "# z: down\n# symmetric: maybe\n"), &["mine.csv:4", "\"maybe\""]),
    ];
    for (text, parts) in cases {
        let message = parse("mine.csv", text, &Overrides::default()).unwrap_err().to_string();
        for part in *parts {
            assert!(message.contains(part), "{part:?} in {message}\n{text}");
        }
    }
    let wheel = std::fs::read_to_string(format!(
        "{}/../profiles/src/profile/wheels/LMA.csv",
        env!("CARGO_MANIFEST_DIR")
    ))
    .unwrap();
    let refused = |text: &str| parse("wheel.csv", text, &Overrides::default()).unwrap_err().to_string();
    let track = refused(&wheel.replace("# y: field", "# y: track"));
    assert!(track.contains("correct `# y:` or `# z:`"), "{track}");
    let up = refused(&wheel.replace("# z: down", "# z: up"));
    assert!(up.contains("correct `# y:` or `# z:`"), "{up}");
    let closed = refused(&(wheel.clone() + "line,60.000000,-2.770127,-70.000000,6.619168,,,\n"));
    assert!(closed.contains("the body") || closed.contains("rim, web and hub"), "{closed}");
}

/// Goal: ends 8 µm apart are moved together, both half of it, without a corner or a ripple, and said with their lines. Accuracy: ROUNDED, the
/// digits of the table (1e-9 mm); the turn is the shift over the length of the line and of the arc.
#[test]
fn small_gaps_are_closed_and_said() {
    let text = "# profile: rail\n# y: field\n# z: down\nkind,y0_mm,z0_mm,y1_mm,z1_mm,yc_mm,zc_mm\n\
                arc,-25,1.043478733,25,1.043478733,0,300\nline,25,1.051478733,26,1.135169200,,\n";
    let found = read(text);
    let joint = found.joints[0];
    assert!((joint.gap - 8e-6).abs() < 1e-11 && joint.lines == (5, 6), "{joint:?}");
    assert!((joint.point.y - 1.047478733e-3).abs() < 1e-12, "{joint:?}");
    assert!(joint.turn.abs() < 4.1e-3, "{joint:?}");
    let curve = found.curve();
    let bend = |s: f64| curve.curvature(s);
    assert!((0..500).all(|i| (bend(0.05 * f64::from(i) / 500.0) * 0.3 - 1.0).abs() < 1e-3));
    let profile = read_file("mine.csv", text.as_bytes(), &ReadOptions::default()).unwrap();
    let gap = profile.findings.iter().find(|f| f.kind == FindingKind::Gap).unwrap();
    assert_eq!((gap.lines, gap.action), (Some((5, 6)), Action::Repaired), "{gap}");
    assert!(gap.to_string().contains("gap 8 \u{b5}m"), "{gap}");
}
