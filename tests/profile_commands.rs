//! The commands on profiles from outside: what they print, which files they write, with which exit code.

use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use serde_json::Value;

fn railspring(folder: &Path, arguments: &[&str]) -> Output {
    Command::cargo_bin("railspring")
        .unwrap()
        .current_dir(folder)
        .arg("profile")
        .args(arguments)
        .output()
        .unwrap()
}

/// Standard output of a command that must succeed.
fn output_of(folder: &Path, arguments: &[&str]) -> String {
    let output = railspring(folder, arguments);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {error}");
    String::from_utf8(output.stdout).unwrap()
}

/// Expects exit code 2, an error with all `parts`, and an empty folder.
fn refused(arguments: &[&str], parts: &[&str]) {
    let place = tempfile::tempdir().unwrap();
    let output = railspring(place.path(), arguments);
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
    for part in parts {
        assert!(text.contains(part), "{part:?} in {text}");
    }
    assert_eq!(std::fs::read_dir(place.path()).unwrap().count(), 0, "{arguments:?} leaves nothing behind");
}

fn worn(name: &str) -> String {
    format!("{}/data/profiles/{name}", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn list_names_every_standard() {
    let place = tempfile::tempdir().unwrap();
    let text = output_of(place.path(), &["list"]);
    for name in ["60E1", "UIC60", "60E2", "54E1", "S1002", "EN13715-1in40", "straight-web", "s-web"] {
        assert!(text.contains(name), "{name} in {text}");
    }
    // What is not sure is said beside the name.
    for (name, doubt) in [
        ("54E3", "weakly checked"),
        ("50E5", "weakly checked"),
        ("60N-on-60E1", "not known"),
        ("APTA120", "assumed"),
    ] {
        let line = text.lines().find(|line| line.starts_with(name)).unwrap();
        assert!(line.contains(doubt), "{line}");
    }
    let same = output_of(place.path(), &["list", "--figure", "all.svg"]);
    assert_eq!(same, text);
    let figure = std::fs::read_to_string(place.path().join("all.svg")).unwrap();
    let bodies = |line: &&str| line.starts_with("wheel bodies") || line.starts_with("rail bodies");
    let known = text.lines().filter(|line| !bodies(line));
    for name in known.map(|line| line.split_whitespace().next().unwrap()) {
        let named = |line: &str| line.trim() == name || line.trim() == format!("{name} *");
        assert_eq!(figure.lines().filter(|line| named(line)).count(), 1, "{name}");
    }
}

/// A user's own standard: half of a section as lines and arcs has its numbers, and its head is a profile like any other.
#[test]
fn a_table_of_lines_and_arcs_is_a_profile() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("mine.csv");
    // a plain T: head 60 by 40 mm with corners of 10 mm, web 16 mm, foot 120 by 20 mm, 150 mm high
    let table = "# profile: rail\n# y: field\n# z: down\n# symmetric: yes\n\
                 kind,y0_mm,z0_mm,y1_mm,z1_mm,yc_mm,zc_mm\n\
                 line,0,0,20,0,,\narc,20,0,30,10,20,10\nline,30,10,30,40,,\nline,30,40,8,40,,\n\
                 line,8,40,8,130,,\nline,8,130,60,130,,\nline,60,130,60,150,,\nline,60,150,0,150,,\n";
    std::fs::write(&path, table).unwrap();
    let text = output_of(place.path(), &["show", "mine.csv"]);
    let line = text.lines().find(|line| line.starts_with("area")).unwrap();
    let area: f64 = line.split_whitespace().nth(1).unwrap().parse().unwrap();
    // cm²; two corners of the head are rounded. Accuracy: the digits printed.
    let exact = 60.0 * 40.0 - (2.0 - std::f64::consts::FRAC_PI_2) * 100.0 + 16.0 * 90.0 + 120.0 * 20.0;
    assert!((area - exact / 100.0).abs() < 6e-5, "{line} {exact}");
    let check = output_of(place.path(), &["check", "mine.csv"]);
    assert!(check.contains("lines and arcs, rail") && check.contains("kink"), "{check}");
    output_of(place.path(), &["plot", "mine.csv", "49E1", "-o", "both.svg"]);
    std::fs::write(&path, table.replace("line,8,40,8,130", "line,8,41,8,130")).unwrap();
    let output = railspring(place.path(), &["check", "mine.csv"]);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(error.contains("mine.csv:10") && error.contains("a gap of 1.0000 mm"), "{error}");
}

/// Goal: the section of a file that crosses itself, turns back or is open is refused with the place, mm, and drawn with a mark there; a sound one is
/// drawn without. Source: a rail of straight lines, 100 by 120 mm, with a point of the web beyond its other side, one that turns back, or the last side left out.
#[test]
fn faults_of_a_section_are_drawn() {
    let place = tempfile::tempdir().unwrap();
    let sound = [
        (-30, 0),
        (-10, 0),
        (10, 0),
        (30, 0),
        (30, 30),
        (8, 40),
        (8, 100),
        (50, 110),
        (50, 120),
        (-50, 120),
        (-50, 110),
        (-8, 100),
        (-8, 40),
        (-30, 30),
        (-30, 0),
    ];
    let mut crossing = sound;
    crossing[11] = (20, 70);
    let mut cusp = sound;
    (cusp[1], cusp[2]) = ((15, 0), (10, -1));
    let cases = [
        ("sound", &sound[..], None),
        ("crossing", &crossing[..], Some("crosses itself at (")),
        ("cusp", &cusp[..], Some("a cusp at (15.000, 0.000) mm")),
        (
            "open",
            &sound[..13],
            Some("an open outline: it ends at (-8.000, 40.000) mm and began at (-30.000, 0.000)"),
        ),
    ];
    for (name, points, fault) in cases {
        let rows: String = points.iter().map(|(y, z)| format!("{y},{z}\n")).collect();
        std::fs::write(place.path().join(format!("{name}.csv")), format!("y_mm,z_mm\n{rows}")).unwrap();
        let (file, figure) = (format!("{name}.csv"), format!("{name}.svg"));
        let output =
            railspring(place.path(), &["check", &file, "--kind", "rail", "--section", "--figure", &figure]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let drawn = std::fs::read_to_string(place.path().join(&figure)).unwrap();
        assert!(
            drawn.starts_with("<svg") && drawn.contains("first coordinate (mm), in the axes of the file"),
            "{name}"
        );
        assert_eq!(drawn.contains("[1] "), fault.is_some(), "{name}");
        match fault {
            None => assert!(output.status.success(), "{said}"),
            Some(fault) => {
                assert_eq!(output.status.code(), Some(2), "{said}");
                assert!(said.contains(fault), "{name}: {said}");
            }
        }
    }
    refused(&["check", "sound.csv", "--section"], &["--kind", "rail or wheel"]);
}

/// Source: a rail of straight lines, 60 by 40 mm head, as a table of its half with the web moved by 1 mm, as its head alone with the same step, and as a DXF
/// with a gap of 2 mm. Goal: each is refused with the place, and drawn with the parts that do not meet and a mark where they step.
#[test]
fn steps_are_drawn_where_they_are() {
    let place = tempfile::tempdir().unwrap();
    let heading = "# profile: rail\n# y: field\n# z: down\n# symmetric: yes\nkind,y0_mm,z0_mm,y1_mm,z1_mm,yc_mm,zc_mm\n";
    let head = "line,0,0,20,0,,\narc,20,0,30,10,20,10\nline,30,10,30,40,,\nline,31,40,8,40,,\n";
    let body = "line,8,40,8,130,,\nline,8,130,60,130,,\nline,60,130,60,150,,\nline,60,150,0,150,,\n";
    let line = |[a, b, c, d]: [i32; 4]| format!("0\nLINE\n8\n0\n10\n{a}\n20\n{b}\n11\n{c}\n21\n{d}\n");
    let half = [
        [0, 150, 30, 150],
        [30, 150, 30, 110],
        [30, 110, 8, 110],
        [8, 110, 8, 20],
        [8, 20, 60, 20],
        [60, 20, 60, 0],
    ];
    let other = half.map(|[a, b, c, d]| line([-a, b, -c, d]));
    let mut drawing = half.map(line).concat() + &other.concat() + &line([60, 0, -58, 0]);
    drawing = format!("0\nSECTION\n2\nENTITIES\n{drawing}0\nENDSEC\n0\nEOF\n");
    let files = [
        (
            "whole.csv",
            format!("{heading}{head}{body}"),
            true,
            "a gap of 1.0000 mm",
            "a step of 1.000 mm from line 8 to line 9, at (30.500, 40.000) mm y to the field side, z down",
        ),
        (
            "head.csv",
            format!("{heading}{head}"),
            false,
            "a gap of 1.0000 mm",
            "a step of 1.000 mm from line 8 to line 9, at (30.500, 40.000)",
        ),
        (
            "whole.dxf",
            drawing.clone(),
            true,
            "a gap of 2.0000",
            "here, open, at (−58.000, 0.000) mm in the axes of the file",
        ),
        (
            "head.dxf",
            drawing.replace(&line([30, 150, 30, 110]), &line([32, 150, 30, 110])),
            false,
            "2 lines that do not meet",
            "nearest ends of lines",
        ),
    ];
    for (file, text, section, fault, mark) in files {
        std::fs::write(place.path().join(file), text).unwrap();
        let figure = format!("{file}.svg");
        let mut arguments = vec!["check", file, "--kind", "rail", "--figure", &figure];
        arguments.extend(section.then_some("--section"));
        let output = railspring(place.path(), &arguments);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{file}: {said}");
        assert!(said.contains(fault), "{file}: {said}");
        let drawn = std::fs::read_to_string(place.path().join(&figure)).unwrap();
        assert!(drawn.contains(mark), "{file}: {mark}: {drawn}");
    }
}

/// Source: the numbers of 54E1 as a table, whole and its head alone, and a rail of straight lines. Goal: the nearest standards are said with their misfit,
/// mm: 54E1 itself for its section, and for its head alone in the message that refuses it; for the plain rail that no standard has its shape.
#[test]
fn the_nearest_standards_of_a_section_are_said() {
    use railspring_profiles::profile::{ProfileKind, lines_and_arcs, rails::rail_outline};
    let place = tempfile::tempdir().unwrap();
    let outline = rail_outline("54E1").unwrap();
    let whole: Vec<_> = outline.running.iter().chain(&outline.rest).copied().collect();
    let write = |name: &str, text: &str| std::fs::write(place.path().join(name), text).unwrap();
    write("whole.csv", &lines_and_arcs::write(ProfileKind::Rail, &whole));
    write("head.csv", &lines_and_arcs::write(ProfileKind::Rail, &outline.running));
    write(
        "plain.csv",
        "y_mm,z_mm\n-30,0\n-10,0\n10,0\n30,0\n30,30\n8,40\n8,100\n50,110\n50,120\n-50,120\n-50,110\n-8,100\n-8,40\n-30,30\n-30,0\n",
    );
    let check = |name: &str| railspring(place.path(), &["check", name, "--section", "--kind", "rail"]);
    let said = output_of(place.path(), &["check", "whole.csv", "--section", "--kind", "rail"]);
    assert!(
        said.contains(
            "the nearest standards are 54E1 (0.000 mm off what wear leaves alone, 0 % worn or unlike), "
        ),
        "{said}"
    );
    let refused = check("head.csv");
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(
        said.contains("open outline") && said.contains("nearest to what is drawn are 54E1 (0.00"),
        "{said}"
    );
    let said = String::from_utf8(check("plain.csv").stdout).unwrap();
    assert!(
        said.contains("no standard has this shape; the nearest are ") && said.contains("% unlike"),
        "{said}"
    );
}

/// Source: EN 13674-1, area and second moments as published (`data/profiles/README.md`). Goal: what is printed.
/// Accuracy: 0.1 %.
#[test]
fn show_prints_the_published_properties() {
    let place = tempfile::tempdir().unwrap();
    let published =
        [("60E1", 76.70, 3038.3, 512.3), ("60E2", 76.48, 3022.0, 510.5), ("54E1", 69.77, 2338.0, 419.2)];
    for (name, area, ixx, iyy) in published {
        let text = output_of(place.path(), &["show", name]);
        for (key, value) in [("area", area), ("Ixx", ixx), ("Iyy", iyy)] {
            let line = text.lines().find(|line| line.starts_with(key)).unwrap();
            let shown: f64 = line.split_whitespace().nth(1).unwrap().parse().unwrap();
            assert!((shown / value - 1.0).abs() < 1e-3, "{name}: {line} against {value}");
        }
    }
    let cone = output_of(place.path(), &["show", "EN13715-1in40"]);
    assert!(cone.contains("kink") && cone.contains("R 36.00"), "{cone}");
    assert!(output_of(place.path(), &["show", &worn("worn-s1002.whl")]).contains("profile file"));
}

#[test]
fn plot_draws_standards_over_each_other() {
    let place = tempfile::tempdir().unwrap();
    output_of(place.path(), &["plot", "60E1", "60E2", "-o", "rails.svg"]);
    let figure = std::fs::read_to_string(place.path().join("rails.svg")).unwrap();
    assert!(figure.starts_with("<svg") && figure.trim_end().ends_with("</svg>"));
    assert!(figure.contains("60E1") && figure.contains("60E2") && figure.contains("curvature"));
    assert!(!figure.contains("finding"));
}

/// A spike and a doubled point in a measured wheel are marked, numbered and listed with their lines.
#[test]
fn plot_marks_the_findings_of_a_file() {
    let place = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(worn("worn-s1002.whl")).unwrap();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let columns: Vec<f64> = lines[300].split_whitespace().map(|c| c.parse().unwrap()).collect();
    let spiked: Vec<String> =
        columns.iter().enumerate().map(|(i, c)| if i == 1 { c + 1.5 } else { *c }.to_string()).collect();
    lines[300] = spiked.join("\t");
    let twice = lines[400].clone();
    lines.insert(400, twice);
    std::fs::write(place.path().join("spoiled.whl"), lines.join("\n") + "\n").unwrap();

    output_of(place.path(), &["plot", "spoiled.whl", "-o", "found.svg"]);
    let figure = std::fs::read_to_string(place.path().join("found.svg")).unwrap();
    for part in [
        "finding, repaired",
        "line 301: spike",
        "lines 401 to 402: duplicate",
        "spoiled.whl (MiniProf, wheel",
    ] {
        assert!(figure.contains(part), "{part:?} in the figure");
    }
    // What the list says is what `check` says.
    let check = output_of(place.path(), &["check", "spoiled.whl"]);
    let listed = figure.lines().filter(|line| line.trim_start().starts_with('[')).count();
    assert_eq!(listed, check.lines().count() - 1, "{check}");
}

/// A worn rail on its standard: its place, its wear and the two files. Source: 1.5 mm of crown wear in `make_worn.py`. Accuracy:
/// the scatter of 2 micrometres and the place's own uncertainty.
#[test]
fn place_writes_points_and_figure() {
    let place = tempfile::tempdir().unwrap();
    let text = output_of(place.path(), &["place", &worn("worn-60e1.prr"), "--standard", "60E1", "-o", "out"]);
    assert!(text.contains("uncertain by"), "{text}");
    let line = text.lines().find(|line| line.starts_with("vertical wear")).unwrap();
    let wear: f64 = line.split_whitespace().rev().nth(1).unwrap().parse().unwrap();
    assert!((wear - 1.5).abs() < 0.015, "{line}");
    let out = place.path().join("out");
    assert!(std::fs::read_to_string(out.join("worn-60e1-placed.svg")).unwrap().starts_with("<svg"));
    let check = output_of(&out, &["check", "--kind", "rail", "worn-60e1-placed.csv"]);
    assert!(check.contains("rail"), "{check}");
}

/// Files without a profile, or with that of the other body, are refused with the file and a remedy.
#[test]
fn place_refuses_what_is_no_such_profile() {
    let place = tempfile::tempdir().unwrap();
    let path = |name: &str, text: &str| {
        std::fs::write(place.path().join(name), text).unwrap();
        place.path().join(name).display().to_string()
    };
    let (empty, words) = (path("empty.csv", ""), path("words.txt", "no profile\n"));
    for standard in [&["--standard", "60E1"][..], &[]] {
        let with = |file| [&["place", file][..], standard].concat();
        refused(&with(&empty), &["empty.csv:1", "rows of numbers", "give y and z"]);
        refused(&with(&words), &["words.txt:1", "rows of numbers"]);
        refused(&with("nowhere.prr"), &["nowhere.prr", "check the path"]);
    }
    refused(
        &["place", &worn("worn-s1002.whl"), "--standard", "60E1"],
        &["worn-s1002.whl", "the shape of a wheel", "the file is that of the other body", "S1002"],
    );
    refused(
        &["place", &worn("worn-60e1.prr"), "--standard", "61E1"],
        &["61E1", "60E1", "profile list", "nearest to the profile are ", " 60E1 (0.03", "UIC60 (0.03"],
    );
}

#[test]
fn contact_writes_table_and_figure() {
    let place = tempfile::tempdir().unwrap();
    let arguments = ["contact", "S1002", "60E1", "--shift-mm", "4", "--step-mm", "0.5", "-o", "pair"];
    let text = output_of(place.path(), &arguments);
    assert!(text.contains("equivalent conicity at 3 mm"), "{text}");
    let table = std::fs::read_to_string(place.path().join("pair.csv")).unwrap();
    assert!(table.starts_with("shift_mm,side,point,"), "{table}");
    // 17 shifts, both wheels.
    assert_eq!(table.lines().count(), 1 + 34);
    let columns = table.lines().next().unwrap().split(',').count();
    assert!(table.lines().all(|line| line.split(',').count() == columns));
    assert!(std::fs::read_to_string(place.path().join("pair.svg")).unwrap().starts_with("<svg"));
    // the parameters at every half millimetre up to 4 mm, as table and record
    let table = std::fs::read_to_string(place.path().join("pair-conicity.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|line| line.split(',').collect()).collect();
    assert!(!rows.is_empty() && rows.iter().all(|row| row.len() == 7 && row[2].is_empty()), "{table}");
    let record: Value =
        serde_json::from_slice(&std::fs::read(place.path().join("pair.json")).unwrap()).unwrap();
    let amplitudes = record["amplitudes"].as_array().unwrap();
    assert_eq!(amplitudes.len(), rows.len());
    for (row, of) in rows.iter().zip(amplitudes) {
        let value = of["equivalent_conicity"]["value"].as_f64().unwrap();
        assert!((value - row[1].parse::<f64>().unwrap()).abs() < 1e-6, "{row:?} {of}");
    }
    assert_eq!(record["shifts"].as_array().unwrap().len(), 17);
    assert_eq!(record["uncertainty_of_profiles"], Value::Null);
}

/// Source: S1002 on 60E1 has 5 mm to either side; a curve of 500 m has the rolling radii coefficient 500 m over the tightest curve without slip. Goal: what is
/// printed and recorded beside the conicity, and their uncertainty: it is there, is the same every time, and grows with that of the profiles.
#[test]
fn contact_has_parameters_with_their_uncertainty() {
    let place = tempfile::tempdir().unwrap();
    let common =
        ["contact", "S1002", "60E1", "--no-roll", "--shift-mm", "6", "--step-mm", "1", "--curve-m", "500"];
    let record = |options: &[&str]| -> (String, Value) {
        let text = output_of(place.path(), &[&common[..], options].concat());
        (text, serde_json::from_slice(&std::fs::read(place.path().join("contact.json")).unwrap()).unwrap())
    };
    let (text, of) = record(&[]);
    for part in
        ["amplitude mm", "flange clearance: 5.00 mm to the left, 5.00 mm to the right", "curve of 500 m"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    let [radius, coefficient] = ["curve_radius_without_slip_m", "rolling_radii_coefficient"]
        .map(|name| of[name]["value"].as_f64().unwrap());
    assert!((coefficient * radius - 500.0).abs() < 1e-9, "{coefficient} {radius}");
    let uncertainty = |um: &str| {
        let options = ["--profile-uncertainty-um", um, "--roll-uncertainty-deg", "0.05"];
        let (text, of) = record(&options);
        let three = of["amplitudes"]
            .as_array()
            .unwrap()
            .iter()
            .find(|row| row["amplitude_mm"] == 3.0)
            .unwrap()
            .clone();
        (text, three["equivalent_conicity"]["standard_uncertainty"].as_f64().unwrap())
    };
    let (text, small) = uncertainty("2");
    assert!(text.contains(" ± ") && text.contains("k = 2"), "{text}");
    assert_eq!(uncertainty("2").1, small);
    assert!(small > 0.0 && uncertainty("20").1 > 2.0 * small, "{small}");
    for (options, said) in [
        (&["--curve-m", "1"][..], "10 to 100000 m"),
        (&["--profile-uncertainty-um=-1"], "--profile-uncertainty-um"),
        (&["--roll-uncertainty-deg", "5"], "0 to 2"),
        (&["--roll-uncertainty-deg", "0.1", "--correlation-mm", "0"], "--correlation-mm"),
    ] {
        refused(&[&["contact", "S1002", "60E1", "--step-mm", "1"], options].concat(), &[said]);
    }
}

/// Goal: files stand where names do, what is taken for granted and was repaired is said, keys of a study are taken, and the left side may be another one: its
/// rows then are not those of the right side at the opposite shift.
#[test]
#[ignore = "a minute: cargo long profile_commands"]
fn contact_takes_files_and_another_left_side() {
    let place = tempfile::tempdir().unwrap();
    let (wheel, rail) = (worn("worn-s1002.whl"), worn("worn-60e1.prr"));
    let common = ["--shift-mm", "2", "--step-mm", "1", "--radius-mm", "429"];
    let run = |arguments: &[&str]| {
        let mut command = Command::cargo_bin("railspring").unwrap();
        let output =
            command.arg("profile").args(arguments).args(common).current_dir(place.path()).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{said}");
        (said, std::fs::read_to_string(place.path().join("contact.csv")).unwrap())
    };
    let (said, both) = run(&["contact", &wheel, &rail, "--set", "wheel.profile_smoothing_mm=3"]);
    for part in ["taken as measured on S1002", "y counts from the flange back"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    // contact angle on the rail of a side at a shift
    let angle = |table: &str, side: &str, shift: f64| -> f64 {
        let row = table.lines().find(|line| line.starts_with(&format!("{shift:.6},{side},1,"))).unwrap();
        row.split(',').nth(10).unwrap().parse().unwrap()
    };
    assert_eq!(angle(&both, "left", 2.0), angle(&both, "right", -2.0));
    let (_, other) =
        run(&["contact", &wheel, &rail, "--set", "wheel.profile_smoothing_mm=3", "--left", "S1002", "60E1"]);
    let [symmetric, new] = [&both, &other].map(|table| angle(table, "left", 2.0));
    assert!((symmetric - new).abs() > 1e-3, "{symmetric} {new}");
    // canted rails: the angle of a wheel on a crown follows the inclination
    let (_, level) = run(&["contact", "S1002", "60E1", "--inclination", "0"]);
    let (_, canted) = run(&["contact", "S1002", "60E1", "--inclination", "0.05"]);
    assert!((angle(&level, "right", 0.0) - angle(&canted, "right", 0.0)).abs() > 1e-3);
}

/// Goal: where the shifts are too few for the equivalent conicity, the line says up to which it needs, and with that there is one. The left side has
/// keys of its own, another radius included.
#[test]
#[ignore = "a minute: cargo long profile_commands"]
fn contact_says_which_shift_it_needs_and_takes_keys_of_the_left_side() {
    let place = tempfile::tempdir().unwrap();
    let pair = ["contact", "S1002", "60E1", "--step-mm", "0.5"];
    let text = output_of(place.path(), &[&pair[..], &["--shift-mm", "3"]].concat());
    let needed = text.split("give --shift-mm ").nth(1).and_then(|rest| rest.split_whitespace().next());
    let needed = needed.unwrap_or_else(|| panic!("no shift in {text}"));
    let text = output_of(place.path(), &[&pair[..], &["--shift-mm", needed]].concat());
    assert!(text.contains("equivalent conicity at 3 mm: 0.17"), "{text}");
    let left = ["--left", "S1002", "60E1", "--set-left", "wheel.tape_diameter_m=0.916"];
    output_of(place.path(), &[&pair[..], &["--shift-mm", "2"], &left].concat());
    let table = std::fs::read_to_string(place.path().join("contact.csv")).unwrap();
    // MODEL: the contact lies within 0.2 mm of the radius at the tape circle in the middle.
    const MODEL: f64 = 0.2;
    for (side, radius) in [("left", 458.0), ("right", 460.0)] {
        let row = table.lines().find(|line| line.starts_with(&format!("0.000000,{side},1,"))).unwrap();
        let found: f64 = row.split(',').nth(11).unwrap().parse().unwrap();
        assert!((found - radius).abs() < MODEL, "{row}");
    }
    refused(
        &["contact", "S1002", "60E1", "--left", "S1002", "60E1", "--set-left", "track.gauge_mm=1435"],
        &["--set-left", "a key of [wheel] or [rail]"],
    );
}

/// Goal: what is wrong with a profile file is said with the options of the command.
#[test]
fn messages_about_a_file_name_the_options_of_the_command() {
    let place = tempfile::tempdir().unwrap();
    let rows: String =
        (0..60).map(|i| format!("{}.5;{}.5;-{}.5;{}.5\n", i, i * i / 60, i, i * i / 60)).collect();
    std::fs::write(place.path().join("lr.csv"), format!("y_left;z_left;y_right;z_right\n{rows}")).unwrap();
    let output = railspring(place.path(), &["check", "lr.csv", "--kind", "rail"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("give `--part`") && said.contains("right"), "{said}");
    let short: String = (0..60).map(|i| format!("{i}e3;{i}\n")).collect();
    std::fs::write(place.path().join("far.csv"), short).unwrap();
    let output = railspring(place.path(), &["check", "far.csv"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("give `--unit`"), "{said}");
}

/// Goal: what was repaired in a file is said wherever it is looked at.
#[test]
fn repairs_are_said_where_a_file_is_used() {
    let place = tempfile::tempdir().unwrap();
    let wheel = worn("worn-s1002.whl");
    for arguments in [&["show", &wheel][..], &["plot", &wheel]] {
        let output = railspring(place.path(), arguments);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(
            output.status.success() && said.contains("y counts from the flange back"),
            "{arguments:?}: {said}"
        );
    }
}

#[test]
fn unknown_names_are_refused() {
    refused(&["show", "61E1"], &["61E1", "60E1", "railspring profile list"]);
    refused(&["plot", "60E1", "nowhere.prr"], &["nowhere.prr", "profile file"]);
    refused(&["contact", "S1003", "60E1"], &["S1003", "S1002"]);
    refused(&["show", "49e1"], &["did you mean \"49E1\"?"]);
    refused(&["contact", "S1002", "61E1"], &["61E1", "54E1"]);
    refused(&["contact", "S1002", "60E1", "--step-mm", "0"], &["--step-mm"]);
}
