//! Own sections of rail and wheel from files, through the whole path.

use std::fmt::Write;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use nalgebra::Point2;
use railspring_profiles::profile::rails::{RailOutline, rail_outline};
use railspring_profiles::profile::{ProfileKind, Segment, lines_and_arcs, polyline};
use railspring_profiles::profile_file::parse_rail_section;
use railspring_profiles::section::{rail_section, rail_section_on, wheel_section};
use railspring_testing::dxf::{self, Entity};
use serde_json::Value;

/// The coarse study with these keys of the rail, of the wheel, or of both, in the place of the standards'.
fn study(keys: &str) -> String {
    if let Some((wheel, rail)) = keys.split_once("\n[rail] ") {
        return study(wheel).replace("profile = \"60E1\"", rail);
    }
    let study = include_str!("studies/coarse.toml");
    match keys.strip_prefix("[wheel] ") {
        Some(wheel) => study.replace("profile = \"S1002\"", wheel),
        None => study.replace("profile = \"60E1\"", keys),
    }
}

/// DISCRETISATION: the nodes of the surface are the same, but rounding decides which steps the smoothing of the section takes, so that inner
/// nodes lie up to 0.1 mm elsewhere, 1/60 of an element. The mesh's error, 1 % here, changes by the square of that: 3e-6 of displacement and
/// tangent, threefold.
const SMOOTHING: f64 = 1e-5;
/// DISCRETISATION: splines lie up to 20 nm beside the arcs at the contact, which lets a contact point at the edge of the patch carry load or not,
/// and its twin across the middle of the window. With 16 cells across, 200 in a patch, the two are 1 % of its area.
const A_POINT: f64 = 1e-2;

/// DISCRETISATION: where the curvature jumps, splines through points 0.2 mm apart lie up to 20 nm beside the curve, to one side and the other, of
/// which a contact sees a tenth as its mean: 2 nm of the least displacement, 11 µm.
const SPLINES: f64 = 2e-4;

/// Runs a command on the study with these keys; the results lie in `out`.
fn railspring(root: &Path, command: &str, rail: &str) -> Output {
    std::fs::write(root.join("study.toml"), study(rail)).unwrap();
    Command::cargo_bin("railspring")
        .unwrap()
        .current_dir(root)
        .env("RAILSPRING_CACHE", root.join("cache"))
        .args([command, "study.toml", "-o", "out"])
        .output()
        .unwrap()
}

fn done(root: &Path, command: &str, rail: &str) -> Value {
    let output = railspring(root, command, rail);
    // A head that is drawn as far as the test needs it is short, which is left to look at.
    assert!(matches!(output.status.code(), Some(0 | 1)), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_str(&std::fs::read_to_string(root.join("out/stiffness.json")).unwrap()).unwrap()
}

/// Displacement and tangents of the load curve, all references.
fn load_curve(root: &Path) -> Vec<f64> {
    let text = std::fs::read_to_string(root.join("out/load_curve.csv")).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let heading: Vec<&str> = lines.next().unwrap().split(',').collect();
    let wanted = ["displacement_mm", "solid_tangent_kn_per_m", "law_tangent_kn_per_m"];
    let columns = wanted.map(|name| heading.iter().position(|head| *head == name).unwrap());
    lines
        .flat_map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            columns.map(|column| fields[column].parse::<f64>().unwrap())
        })
        .collect()
}

fn drawing<'a>(outline: impl Iterator<Item = &'a Segment>) -> String {
    let at = |p: Point2<f64>| [1e3 * p.x, -1e3 * p.y];
    dxf::drawing(outline.map(|segment| {
        let ends = [at(segment.start()), at(segment.end())];
        match *segment {
            Segment::Line { .. } => Entity::Line(ends),
            Segment::Arc { centre, .. } => Entity::Arc { ends, centre: at(centre) },
        }
    }))
}

fn columns(outline: &RailOutline) -> String {
    let mut points = polyline(&outline.running, 0.2e-3);
    points.extend(polyline(&outline.rest, 2e-3).into_iter().skip(1));
    points.iter().fold(String::from("y_mm,z_mm\n"), |mut text, p| {
        let _ = writeln!(text, "{:.6},{:.6}", 1e3 * p.x, 1e3 * p.y);
        text
    })
}

fn around(outline: &RailOutline) -> impl Iterator<Item = &Segment> {
    outline.running.iter().chain(&outline.rest)
}

fn table<'a>(kind: ProfileKind, outline: impl Iterator<Item = &'a Segment>) -> String {
    lines_and_arcs::write(kind, &outline.copied().collect::<Vec<_>>())
}

/// Source: the built-in 60E1. Goal: the same rail as a DXF of lines and arcs and as columns of points has its load curves and laws (mm,
/// kN/m), its file stands in the results with what was done to it, and the store tells the files apart. Accuracy: DXF `SMOOTHING`; columns what area
/// and second moments of the polygon differ from the arcs', for that is the share of bending and shear that changes, and tangents `A_POINT`.
#[test]
fn the_standard_from_a_file_has_its_law() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let outline = rail_outline("60E1").unwrap();
    let files = [("rail.dxf", drawing(around(&outline)), "DXF"), ("rail.csv", columns(&outline), "CSV")];
    let own = done(root, "calibrate", "profile = \"60E1\"");
    assert!(own.get("profiles").is_none_or(|p| p.as_array().unwrap().is_empty()), "{}", own["profiles"]);
    let expected = load_curve(root);
    let standard = rail_section("60E1").unwrap().area;
    let mut hashes = vec![own["input_hash"].clone()];
    for (name, text, format) in files {
        std::fs::write(root.join(name), &text).unwrap();
        let record = done(root, "calibrate", &format!("section_file = \"{name}\""));
        let read = parse_rail_section(name, text.as_bytes()).unwrap();
        let area = rail_section_on(name, read.running, read.rest).area;
        let polygon = [(area.area, standard.area), (area.ixx, standard.ixx), (area.iyy, standard.iyy)]
            .map(|(found, exact)| (found / exact - 1.0).abs());
        let tolerance = polygon.into_iter().fold(SMOOTHING, f64::max);
        assert!(tolerance < 2e-3, "{name}: {tolerance}");
        let found = load_curve(root);
        assert_eq!(found.len(), expected.len());
        let tangents = if format == "CSV" { tolerance.max(A_POINT) } else { tolerance };
        for (i, (a, b)) in found.iter().zip(&expected).enumerate() {
            let (difference, most) = (a / b - 1.0, if i % 3 == 0 { tolerance } else { tangents });
            assert!(difference.abs() < most, "{name}, value {i}: {difference:e} of {most:e}");
        }
        let profile = &record["profiles"][0];
        assert_eq!((&profile["body"], &profile["file"]), (&"rail section".into(), &name.into()));
        assert_eq!(profile["format"], format);
        let findings = profile["findings"].to_string();
        assert!(findings.contains("the nearest standards are 60E1 (0.000 mm off"), "{findings}");
        assert!(!hashes.contains(&record["input_hash"]), "the content of the file does not count");
        hashes.push(record["input_hash"].clone());
    }
}

/// Source: the numbers of 49E1 as a user's table. Goal: a rail of lines and arcs runs to a report that names its file; a measured head is
/// joined to it; wrong keys and files are refused by file, line and key.
#[test]
fn a_users_rail_runs_to_a_report() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let outline = rail_outline("49E1").unwrap();
    std::fs::write(root.join("mine.csv"), table(ProfileKind::Rail, around(&outline))).unwrap();
    let record = done(root, "run", "section_file = \"mine.csv\"");
    assert_eq!(record["profiles"][0]["format"], "lines and arcs");
    let report = std::fs::read_to_string(root.join("out/report.html")).unwrap();
    assert!(report.contains("rail section: <code>mine.csv</code>"), "the report does not name the section");

    let mut head = String::from("y_mm,z_mm\n");
    for p in polyline(&outline.running, 0.2e-3).iter().filter(|p| p.y < 20e-3) {
        let _ = writeln!(head, "{:.6},{:.6}", 1e3 * p.x, 1e3 * p.y);
    }
    std::fs::write(root.join("head.csv"), head).unwrap();
    let joined = done(root, "calibrate", "section_file = \"mine.csv\"\nprofile_file = \"head.csv\"");
    assert_eq!(joined["profiles"][1]["standard"], "mine.csv");
    assert!(joined["profiles"][1]["findings"].as_array().unwrap().iter().any(|f| f["kind"] == "joined"));

    let refused = |rail: &str, parts: &[&str]| {
        let output = railspring(root, "calibrate", rail);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            !output.status.success() && parts.iter().all(|part| said.contains(part)),
            "{parts:?}: {said}"
        );
    };
    refused(
        "section_file = \"mine.csv\"\nprofile = \"60E1\"",
        &["study.toml:6: rail.profile = \"60E1\"", "either rail.profile or rail.section_file"],
    );
    refused(
        "section_file = \"mine.csv\"\nprofile_file = \"head.csv\"\nstandard = \"60E1\"",
        &["study.toml:7: rail.standard = \"60E1\"", "either rail.standard or rail.section_file"],
    );
    refused(
        "section_file = \"no.csv\"",
        &["study.toml:5: rail.section_file = \"no.csv\"", "a readable file"],
    );
    refused("section_file = \"head.csv\"", &["head.csv:", "an open outline", "mm away", "close the outline"]);
}

/// Source: 49E1 and LMA on the generic body. Goal: rail and wheel of one study run to a report that names
/// both files, with the same load curve (mm, kN/m). They are DXF drawings, and tables of lines and arcs. A
/// measured profile, worn by 0.5 mm throughout, is joined to the user's wheel, which touches the rail on it.
/// Accuracy: `SMOOTHING`.
#[test]
#[ignore = "a quarter of a minute: cargo long user_sections"]
fn a_users_rail_and_wheel_run_to_a_report() {
    /// Depth of the wear, mm.
    const WORN: f64 = 0.5;
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let rail = rail_outline("49E1").unwrap();
    let lines = lines_and_arcs::parse(
        "LMA",
        include_str!("../profiles/src/profile/wheels/LMA.csv"),
        &lines_and_arcs::Overrides::default(),
    )
    .unwrap();
    let section = wheel_section("LMA", 0.858).unwrap();
    let wheel = || lines.running.iter().chain(&section.body_outline);
    for (name, text) in [
        ("rail.dxf", drawing(around(&rail))),
        ("wheel.dxf", drawing(wheel())),
        ("rail.csv", table(ProfileKind::Rail, around(&rail))),
        ("wheel.csv", table(ProfileKind::Wheel, wheel())),
    ] {
        std::fs::write(root.join(name), text).unwrap();
    }
    let both = |wheel: &str, ending: &str| {
        format!("[wheel] section_file = \"wheel.{ending}\"{wheel}\n[rail] section_file = \"rail.{ending}\"")
    };
    let mut curves = Vec::new();
    for ending in ["dxf", "csv"] {
        done(root, "run", &both("", ending));
        curves.push(load_curve(root));
        let report = std::fs::read_to_string(root.join("out/report.html")).unwrap();
        for body in ["rail", "wheel"] {
            assert!(
                report.contains(&format!("{body} section: <code>{body}.{ending}</code>")),
                "{body}, {ending}"
            );
        }
    }
    assert!(curves[0].len() > 9 && curves[0].len() == curves[1].len());
    for (a, b) in curves[0].iter().zip(&curves[1]) {
        assert!((a / b - 1.0).abs() < SMOOTHING, "{a} {b}");
    }
    let mut worn = String::from("y_mm,z_mm\n");
    for p in section.running.sample(0.2e-3) {
        let _ = writeln!(worn, "{:.6},{:.6}", 1e3 * p.x, 1e3 * p.y - WORN);
    }
    std::fs::write(root.join("worn.csv"), worn).unwrap();
    let record = done(root, "run", &both("\nprofile_file = \"worn.csv\"", "csv"));
    let joined = record["profiles"].as_array().unwrap().iter().find(|p| p["file"] == "worn.csv").unwrap();
    assert_eq!((&joined["body"], &joined["standard"]), (&"wheel".into(), &"wheel.csv".into()));
    // The wheel touches the rail on the worn profile. ROUNDOFF: the rows have six digits behind the point, and splines through them lie within 20 nm.
    const ROUNDOFF: f64 = 1e-4;
    let [y, z] = ["wheel_y_mm", "wheel_z_mm"].map(|key| record["touch"][key].as_f64().unwrap());
    let new = section.running.point(section.running.s_at_y(1e-3 * y).unwrap()).y;
    assert!((z - (1e3 * new - WORN)).abs() < ROUNDOFF, "({y}, {z}) mm, new {new} m");
    let report = std::fs::read_to_string(root.join("out/report.html")).unwrap();
    assert!(report.contains("worn.csv on wheel.csv, in the frame of the standard"), "the figure is missing");
}

/// Mass of a body's mesh, kg.
fn mass(record: &Value, body: &str) -> f64 {
    let meshes = record["mesh"].as_array().unwrap();
    meshes.iter().find(|mesh| mesh["body"] == body).unwrap()["mass_kg"].as_f64().unwrap()
}

/// Source: wheel LMA, which is lines and arcs throughout, and S1002, on the generic body of the coarse study.
/// Goal: the same wheel from a DXF, from a table and from columns runs to the results of the standard by its
/// name. Compared are load curve and laws (mm, kN/m), mass of the mesh (kg) and elements. The report names
/// the file. Keys of the generic body are refused beside it. Accuracy: lines and arcs `SMOOTHING`; columns,
/// whose web, hub and rim have vertices 2 mm apart as the standard's have, `SPLINES` for displacements and
/// `A_POINT` for tangents.
#[test]
#[ignore = "a quarter of a minute: cargo long user_sections"]
fn a_wheel_from_a_file_has_the_law_of_its_standard() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let lines = lines_and_arcs::parse(
        "LMA",
        include_str!("../profiles/src/profile/wheels/LMA.csv"),
        &lines_and_arcs::Overrides::default(),
    )
    .unwrap();
    let body = wheel_section("LMA", 0.858).unwrap().body_outline;
    let outline = || lines.running.iter().chain(&body);
    std::fs::write(root.join("wheel.dxf"), drawing(outline())).unwrap();
    std::fs::write(root.join("wheel.csv"), table(ProfileKind::Wheel, outline())).unwrap();
    let s1002 = wheel_section("S1002", 0.858).unwrap();
    let count = (s1002.running.length() / 0.2e-3).ceil() as usize;
    let mut points: Vec<_> =
        (0..=count).map(|i| s1002.running.point(s1002.running.length() * i as f64 / count as f64)).collect();
    points.extend(polyline(&s1002.body_outline, 2e-3).into_iter().skip(1));
    let text = points.iter().fold(String::from("y_mm,z_mm\n"), |mut text, p| {
        let _ = writeln!(text, "{:.6},{:.6}", 1e3 * p.x, 1e3 * p.y);
        text
    });
    std::fs::write(root.join("points.csv"), text).unwrap();

    let cases =
        [("LMA", "wheel.dxf", "DXF"), ("LMA", "wheel.csv", "lines and arcs"), ("S1002", "points.csv", "CSV")];
    for (standard, file, format) in cases {
        let named = done(root, "calibrate", &format!("[wheel] profile = \"{standard}\""));
        let expected = load_curve(root);
        let command = if file == "wheel.dxf" { "run" } else { "calibrate" };
        let record = done(root, command, &format!("[wheel] section_file = \"{file}\""));
        let found = load_curve(root);
        assert_eq!(found.len(), expected.len());
        for (i, (a, b)) in found.iter().zip(&expected).enumerate() {
            let most = match (format, i % 3) {
                ("CSV", 0) => SPLINES,
                ("CSV", _) => A_POINT,
                _ => SMOOTHING,
            };
            assert!((a / b - 1.0).abs() < most, "{file}, value {i}: {:e}", a / b - 1.0);
        }
        let meshes = record["mesh"].as_array().unwrap();
        let own = meshes.iter().find(|mesh| mesh["body"] == "wheel").unwrap();
        let ratio = mass(&record, "wheel") / mass(&named, "wheel");
        assert!((ratio - 1.0).abs() < SMOOTHING, "{file}: {ratio}");
        assert!(own["min_scaled_jacobian"].as_f64().unwrap() > 0.2, "{own}");
        let profile = &record["profiles"][0];
        assert_eq!((&profile["body"], &profile["file"]), (&"wheel section".into(), &file.into()));
        assert_eq!(profile["format"], format);
        assert_ne!(record["input_hash"], named["input_hash"]);
        if command == "run" {
            let report = std::fs::read_to_string(root.join("out/report.html")).unwrap();
            assert!(
                report.contains("wheel section: <code>wheel.dxf</code>"),
                "the report does not name the section"
            );
        }
    }
    let output = railspring(root, "calibrate", "[wheel] section_file = \"wheel.dxf\"\nbore_mm = 180");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success(), "{said}");
    for part in ["study.toml:10: wheel.bore_mm", "no key of a generic wheel beside wheel.section_file"] {
        assert!(said.contains(part), "{part}: {said}");
    }
}
