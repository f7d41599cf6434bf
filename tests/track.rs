//! Load cases on a track by the command line.

use std::collections::BTreeMap;
use std::path::Path;

use assert_cmd::Command;
use railspring_calibrate::analytic::beam::{Bending, Span};
use serde_json::Value;
use tempfile::TempDir;

/// What the benchmarks ask for, relative.
const DISCRETISATION: f64 = 1e-3;

/// A folder with studies and their tables.
pub struct Place(TempDir);

/// What a command has left.
pub struct Ran {
    pub code: i32,
    pub said: String,
}

impl Place {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.path().join(name), text).unwrap();
    }

    pub fn command(&self, arguments: &[&str]) -> Ran {
        let mut command = Command::cargo_bin("railspring").unwrap();
        command.current_dir(self.0.path()).args(arguments);
        let output = command.output().unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        Ran { code: output.status.code().unwrap(), said: text(&output.stdout) + &text(&output.stderr) }
    }

    pub fn run(&self, study: &str) -> Ran {
        self.write("study.toml", study);
        self.command(&["run", "study.toml", "-o", "out", "-q"])
    }

    pub fn file(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.path().join("out").join(name)).unwrap()
    }

    /// A column of the history.
    pub fn column(&self, name: &str) -> Vec<f64> {
        let text = self.file("history.csv");
        let mut reader = csv_of(&text);
        let column = reader.remove(name);
        column.unwrap_or_else(|| panic!("{name} is none of {:?}", reader.keys()))
    }

    pub fn largest(&self, name: &str) -> f64 {
        self.column(name).into_iter().fold(f64::NEG_INFINITY, f64::max)
    }
}

/// The columns of a CSV file; an empty cell is no number.
pub fn csv_of(text: &str) -> BTreeMap<String, Vec<f64>> {
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut columns = vec![Vec::new(); names.len()];
    for line in lines {
        for (column, cell) in columns.iter_mut().zip(line.split(',')) {
            column.push(cell.parse().unwrap_or(f64::NAN));
        }
    }
    names.into_iter().map(String::from).zip(columns).collect()
}

pub fn near(found: f64, expected: f64, within: f64, what: &str) {
    assert!((found / expected - 1.0).abs() < within, "{what}: {found} for {expected}");
}

/// Whether the deflection of midspan (mm) is as expected at quarters of the time.
fn quarters(place: &Place, expected: [f64; 3], name: &str) {
    let deflections = place.column("midspan_deflection_mm");
    for (row, expected) in [500, 1000, 1500].into_iter().zip(expected) {
        near(deflections[row], expected, DISCRETISATION, name);
    }
}

fn shipped() -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("data/studies/vbi-2d.toml")).unwrap()
}

/// Source: program VBI-2D, case A. Goal: the shipped study has the printed deflections (mm) at midspan, the largest and those at quarters of the time, says that nothing was verified, has the same bytes again, and a page without
/// anything from elsewhere. Accuracy: DISCRETISATION.
#[test]
fn the_shipped_bridge_deflects_as_printed() {
    let place = Place::new();
    let ran = place.run(&shipped());
    assert_eq!((ran.code, ran.said.as_str()), (0, ""));
    near(place.largest("midspan_deflection_mm"), 0.418545, DISCRETISATION, "A");
    quarters(&place, [0.25643, 0.36733, 0.24006], "A");
    let record: Value = serde_json::from_str(&place.file("track.json")).unwrap();
    assert_eq!(record["ending"], "completed");
    assert_eq!(record["verification"]["verified"], false);
    let figures = record["figures"].as_array().unwrap();
    let midspan = figures.iter().find(|figure| figure["column"] == "midspan_deflection_mm").unwrap();
    let x = midspan["largest"]["x_m"].as_f64().unwrap();
    assert!((x - 10.90).abs() < 0.25, "{x}");
    let page = place.file("report.html");
    assert!(
        page.contains("othing was verified")
            && page.contains("<svg")
            && !["src=\"http", "href=\"http", "url(http"].iter().any(|from| page.contains(from)),
        "{page}"
    );
    let files = ["history.csv", "track.json", "report.html"];
    let before = files.map(|name| place.file(name));
    place.run(&shipped());
    assert!(before == files.map(|name| place.file(name)));
}

/// Source: the same program, cases A2 to A4 (A3 and A4 also by twenty modes: 0.461899 and 0.468352 mm), and Yang and Yau's example (case B). Goal: the largest deflection (mm) and forces (kN) by keys and tables alone.
/// Accuracy: DISCRETISATION; MODEL 0.2 % for the printed A3 and A4, which differ by 0.15 and 0.16 % from the solution of the equations.
#[test]
fn variants_of_the_bridge_deflect_as_printed() {
    const MODEL: f64 = 2e-3;
    let place = Place::new();
    let rows = format!("x_m,height_mm\n0,0\n{},0\n12.5,10\n25,10\n", 25.0 / 3.0);
    place.write("ramp.csv", &rows);
    let ramp = "[[excitation.irregularity]]\nkind = \"table\"\ntable = { file = \"ramp.csv\", column = \"height_mm\", between = \"corners\" }\n";
    let damped = "stiffness_kn_per_m = 1595.0\ndamping_kn_s_per_m = 400.0";
    let with = |from: &str, to: &str| shipped().replace(from, to) + ramp;
    let finer = |study: String| study.replace("steps = 2000", "steps = 2000\ninner_steps = 10");
    let a3 = finer(with("stiffness_kn_per_m = 1595.0", damped));
    let end = (1125.0_f64.sqrt() - 25.0) / 10.0;
    let a4 = a3
        .replace("speed_m_per_s = 25.0", "speed_m_per_s = 25.0\nacceleration_m_per_s2 = 10.0")
        .replace("time_step_s = 0.0005", &format!("time_step_s = {}", end / 2000.0));
    for (name, study, printed, solved) in [
        ("A2", finer(with("", "")), 0.46721, None),
        ("A3", a3, 0.46260, Some(0.461_899)),
        ("A4", a4, 0.46912, Some(0.468_352)),
    ] {
        let ran = place.run(&study);
        assert_eq!(ran.code, 0, "{name}: {}", ran.said);
        let largest = place.largest("midspan_deflection_mm");
        near(largest, printed, if solved.is_some() { MODEL } else { DISCRETISATION }, name);
        near(largest, solved.unwrap_or(printed), DISCRETISATION, name);
    }
    let b = shipped()
        .replace(
            "young_gpa = 35.0, inertia_m4 = 1.3901, mass_kg_per_m = 18358.0",
            "young_gpa = 2.87, inertia_m4 = 2.90, mass_kg_per_m = 2303.0",
        )
        .replace("speed_m_per_s = 25.0", &format!("speed_m_per_s = {}", 100.0 / 3.6))
        .replace("time_step_s = 0.0005", "time_step_s = 0.00045");
    assert_eq!(place.run(&b).code, 0);
    near(place.largest("midspan_deflection_mm"), 2.4073, DISCRETISATION, "B");
    near(place.largest("p_kn"), 57.258, DISCRETISATION, "B");
    let least = place.column("p_kn").into_iter().fold(f64::INFINITY, f64::min);
    near(least, 55.590, DISCRETISATION, "B");
    quarters(&place, [1.3985, 2.0133, 1.3132], "B");
}

/// Source: Frýba's series with the shear branch (`analytic::beam`). Goal: deflection (mm) of the middle of a rail of 4 m with shear and rotary inertia under a force of
/// 100 kN at 60 m/s, at each tenth of the time, from keys alone. Accuracy: DISCRETISATION of the largest.
#[test]
fn a_force_over_a_timoshenko_beam_is_frybas_series() {
    let [length, force, speed, mass, rotary] = [4.0, 1e5, 60.0, 60.2, 0.2385];
    let (young, inertia, area, poisson) = (210e9, 3.038e-5, 3.0e-3, 0.3);
    let study = format!(
        "kind = \"track\"\nname = \"fryba\"\n[rail]\nlength_m = {length}\nelements = 40\nends = [\"pinned\", \"pinned\"]\n\
         section = {{ young_gpa = {}, inertia_m4 = {inertia}, mass_kg_per_m = {mass}, shear_area_m2 = {area}, poisson = {poisson}, rotary_kg_m = {rotary} }}\n\
         [wheel]\nkind = \"force\"\n[excitation.vertical_force]\nmean_kn = {}\n\
         [run]\nsteps = 1000\ninner_steps = 4\ntime_step_s = {}\nspeed_m_per_s = {speed}\nstart = \"above\"\n\
         [[probe]]\nname = \"midspan\"\nx_m = {}\n",
        1e-9 * young,
        1e-3 * force,
        1e-3 * length / speed,
        0.5 * length,
    );
    let place = Place::new();
    let ran = place.run(&study);
    assert_eq!(ran.code, 0, "{}", ran.said);
    let shear_stiffness = 0.5 * young / (1.0 + poisson) * area;
    let bending = Bending { length, bending_stiffness: young * inertia, shear_stiffness };
    let span = Span { bending, mass_per_length: mass, rotary_inertia: rotary };
    let (times, deflections) = (place.column("time_s"), place.column("midspan_deflection_mm"));
    let exact = |row: usize| 1e3 * span.moving_force_deflection(force, speed, 0.5 * length, times[row], 200);
    let largest = (1..=10).map(|tenth| exact(100 * tenth)).fold(0.0, f64::max);
    for row in (1..=10).map(|tenth| 100 * tenth) {
        let off = (deflections[row] - exact(row)).abs();
        assert!(off < DISCRETISATION * largest, "{row}: {off} of {largest}");
    }
}

/// Source: energy of a falling mass, gravity during the contact left out. Goal: the largest force (kN) and approach (mm) of 283 kg and 1000 kg that fall on Hertz's contact and on the published law. Accuracy: DISCRETISATION.
#[test]
fn wheels_fall_with_the_force_of_their_energy() {
    let place = Place::new();
    for (law, mass, height, force, approach) in [
        ("law = \"hertz\"\nhertz_gn_per_m15 = 92.39", 0.283, 0.010, 309.8, 0.2240),
        ("law = \"hertz\"\nhertz_gn_per_m15 = 92.39", 1.0, 0.001, 165.96, 0.1478),
        ("law = \"hertz\"\nhertz_gn_per_m15 = 92.39", 1.0, 0.010, 660.7, 0.3712),
        ("law = \"published\"", 0.283, 0.010, 235.0, 0.2716),
        ("law = \"published\"", 1.0, 0.001, 130.45, 0.1728),
        ("law = \"published\"", 1.0, 0.010, 480.4, 0.4701),
    ] {
        let velocity = f64::sqrt(2.0 * 9.81 * height);
        let study = format!(
            "kind = \"track\"\nname = \"drop\"\n[rail]\nrigid = true\n[wheel]\nmass_t = {mass}\n[contact]\n{law}\n\
             [run]\nsteps = 3000\ntime_step_s = 1e-6\ngravity_m_per_s2 = 0.0\nstart = \"above\"\nvelocity_m_per_s = {velocity}\n"
        );
        let ran = place.run(&study);
        assert_eq!(ran.code, 0, "{}", ran.said);
        near(place.largest("p_kn"), force, DISCRETISATION, law);
        near(place.largest("approach_mm"), approach, DISCRETISATION, law);
    }
}

/// A rail on sleepers with a wheel on a suspension.
const SLEEPERS: &str = r#"kind = "track"
name = "sleepers"
[rail]
length_m = 12.0
elements = 120
profile = "60E1"
[rail.sleepers]
spacing_m = 0.6
pad_stiffness_kn_per_m = 100e3
pad_damping_kn_s_per_m = 30.0
mass_kg = 150.0
ballast_stiffness_kn_per_m = 50e3
ballast_damping_kn_s_per_m = 50.0
[wheel]
mass_t = 0.9
suspended_mass_t = 5.0
suspension = { stiffness_kn_per_m = 1200.0, damping_kn_s_per_m = 40.0 }
[run]
steps = 400
time_step_s = 1e-4
start_x_m = 3.0
speed_m_per_s = 50.0
[[probe]]
name = "middle"
x_m = 6.0
"#;

/// Goal: a sine as keys and the same sine as a table give the same history within the table's straight lines, for a force and for the ground: (ω·h)²/8 of the amplitude.
#[test]
fn a_table_is_what_it_samples() {
    let place = Place::new();
    let mut rows = String::from("# made\ntime_s;up;down\n");
    for i in 0..=200 {
        let t = f64::from(i) * 2e-4;
        rows += &format!("{t};{};{}\n", -2.0 * (300.0 * t).sin(), 2.0 * (300.0 * t).sin());
    }
    place.write("sine.csv", &rows);
    let frequency = 300.0 / std::f64::consts::TAU;
    for (key, sine) in [
        ("vertical_force", format!("amplitude_kn = 2.0, frequency_hz = {frequency}")),
        ("ground_acceleration", format!("amplitude_m_per_s2 = 2.0, frequency_hz = {frequency}")),
    ] {
        let run = |what: String| {
            let ran = place.run(&format!("{SLEEPERS}[excitation.{key}]\n{what}\n"));
            assert_eq!(ran.code, 0, "{}", ran.said);
            place.column("middle_deflection_mm")
        };
        let by_keys = run(format!("harmonics = [{{ {sine} }}]"));
        let by_table = run("table = { file = \"sine.csv\", column = \"up\", factor = -1.0 }".into());
        let still = run(String::new());
        let scale = by_keys.iter().zip(&still).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(scale > 1e-4, "{key}: {scale}");
        for (a, b) in by_keys.iter().zip(&by_table) {
            assert!((a - b).abs() < 1e-3 * scale, "{key}: {a} {b}");
        }
    }
}

/// Goal: the end of the rail ends a run as a result: exit code 1, the rows before, when and why.
#[test]
fn the_end_of_the_rail_is_a_result() {
    let place = Place::new();
    let ran = place.run(&SLEEPERS.replace("start_x_m = 3.0", "start_x_m = 11.0"));
    assert_eq!(ran.code, 1, "{}", ran.said);
    let record: Value = serde_json::from_str(&place.file("track.json")).unwrap();
    assert_eq!(record["ending"], "rail-end");
    assert!((record["ended_at_s"].as_f64().unwrap() - 0.0201).abs() < 1e-9, "{record}");
    assert_eq!(place.column("time_s").len(), 201);
    assert!(record["notes"][0].as_str().unwrap().contains("end of the rail"), "{record}");
}

/// Goal: mistakes are reported with file, line and key, what was expected and a remedy; exit code 2, and nothing is written.
#[test]
fn mistakes_are_named() {
    let place = Place::new();
    place.write("falls.csv", "t,f\n0,1\n0.02,2\n0.01,3\n0.05,4\n");
    place.write("gap.csv", "t,f\n0,1\n0.01,2\n0.02,3\n0.05,4\n0.06,4\n");
    place.write("hole.csv", "t,f\n0,1\n0.02,\n0.05,4\n");
    place.write("short.csv", "t,f\n0,1\n0.01,2\n0.02,3\n");
    place.write("coarse.csv", "x,h\n0,0\n5,1\n10,0\n15,1\n");
    place.write("ends.csv", "x,h\n0,0\n0.05,0.1\n0.1,0.1\n");
    let force = |table: &str| format!("{SLEEPERS}[excitation.vertical_force]\n{table}\n");
    let table = |file: &str| force(&format!("table = {{ file = \"{file}\", column = \"f\" }}"));
    let height = |file: &str| {
        format!(
            "{SLEEPERS}[[excitation.irregularity]]\nkind = \"table\"\ntable = {{ file = \"{file}\", column = \"h\" }}\n"
        )
    };
    let with = |from: &str, to: &str| SLEEPERS.replace(from, to);
    let support = |keys: &str| format!("{SLEEPERS}[[rail.support]]\n{keys}\n");
    for (study, key, said) in [
        (table("falls.csv"), "excitation.vertical_force.table.file", "falls.csv:4: 0.01 s after 0.02 s"),
        (table("gap.csv"), "excitation.vertical_force.table.file", "nothing between 0.02 and 0.05 s"),
        (table("hole.csv"), "excitation.vertical_force.table.file", "hole.csv:3"),
        (table("short.csv"), "excitation.vertical_force.table.file", "times from 0 to 0.02 s"),
        (table("none.csv"), "excitation.vertical_force.table.file", "readable"),
        (
            table("gap.csv").replace("column = \"f\"", "column = \"g\""),
            "excitation.vertical_force.table.column",
            "(t, f)",
        ),
        (
            force("harmonics = [{ amplitude_kn = 1, frequency_hz = 1000 }]"),
            "excitation.vertical_force.harmonics",
            "20 steps",
        ),
        (height("coarse.csv"), "excitation.irregularity[0].table.file", "4 samples"),
        (height("ends.csv"), "excitation.irregularity[0].table.file", "places from 0 to 0.1 m"),
        (support("x_m = 13.0\nkind = \"pinned\""), "rail.support[0].x_m", "0 to 12 m"),
        (support("x_m = 3.05\nkind = \"pinned\""), "rail.support[0].x_m", "`rail.elements = 240`"),
        (
            support("x_m = 3.0\nkind = \"pinned\"\nstiffness_kn_per_m = 1"),
            "rail.support[0].stiffness_kn_per_m",
            "spring",
        ),
        (with("spacing_m = 0.6", "spacing_m = 0.6\nlast_m = 14.0"), "rail.sleepers.last_m", "0 to 12 m"),
        (with("mass_kg = 150.0\n", ""), "rail.sleepers.ballast_stiffness_kn_per_m", "without a sleeper"),
        (with("start_x_m = 3.0", "start_x_m = 13.0"), "run.start_x_m", "0 to 12 m"),
        (
            with("stiffness_kn_per_m = 1200.0", "stiffness_kn_per_m = 0.0"),
            "run.start",
            "spring under the mass above",
        ),
        (
            with("pad_stiffness_kn_per_m = 100e3", "pad_stiffness_kn_per_m = 100e3\nfirst_m = 0.0")
                .replace("ballast_stiffness_kn_per_m = 50e3", "ballast_stiffness_kn_per_m = 0.0"),
            "run.start",
            "supports hold vertically",
        ),
        (with("mass_t = 0.9", ""), "wheel.mass_t", "(missing)"),
        (with("profile = \"60E1\"", "profile = \"61E1\""), "rail.profile", "profile list"),
        (with("time_step_s = 1e-4", "time_step_s = 1e-3"), "run.inner_steps", "20 in a period"),
        (with("x_m = 6.0", "x_m = 12.5"), "probe[0].x_m", "0 to 12 m"),
        (with("kind = \"track\"", "kind = \"bridge\""), "kind", "expected \"track\""),
        (with("length_m = 12.0", "lenght_m = 12.0"), "rail.lenght_m", "length_m"),
        (with("length_m = 12.0", "length_m = nan"), "rail.length_m", "nan"),
    ] {
        let ran = place.run(&study);
        assert_eq!(ran.code, 2, "{key}: {}", ran.said);
        assert!(
            ran.said.contains("study.toml:") && ran.said.contains(&format!("{key} = ")),
            "{key}: {}",
            ran.said
        );
        assert!(ran.said.contains(said), "{said}: {}", ran.said);
        assert!(!place.0.path().join("out/history.csv").exists(), "{key}");
    }
}

/// Goal: commands that need two profiles say so, and neither kind of study writes over the other's results.
#[test]
fn a_track_has_nothing_to_calibrate() {
    let place = Place::new();
    place.write("study.toml", SLEEPERS);
    for command in ["calibrate", "verify", "mesh", "report", "crosscheck"] {
        let ran = place.command(&[command, "study.toml"]);
        assert_eq!(ran.code, 2, "{}", ran.said);
        assert!(ran.said.contains("kind = \"track\"") && ran.said.contains("railspring run"), "{}", ran.said);
    }
    std::fs::create_dir(place.0.path().join("out")).unwrap();
    place.write("out/stiffness.json", "{}");
    let ran = place.run(SLEEPERS);
    assert_eq!(ran.code, 2, "{}", ran.said);
    assert!(ran.said.contains("output folder") && place.file("stiffness.json") == "{}", "{}", ran.said);
    // a table that the history would replace
    place.write("history.csv", "t,f\n0,1\n0.02,2\n0.04,1\n");
    let table = "[excitation.vertical_force]\ntable = { file = \"history.csv\", column = \"f\" }\n";
    place.write("own.toml", &format!("{SLEEPERS}{table}"));
    let ran = place.command(&["run", "own.toml", "-o", "."]);
    assert_eq!(ran.code, 2, "{}", ran.said);
    assert!(
        ran.said.contains("history.csv") && ran.said.contains("the same file as the input"),
        "{}",
        ran.said
    );
    assert!(!place.0.path().join("track.json").exists());
    // simulate and a dry run are the same study
    assert_eq!(place.command(&["simulate", "study.toml", "-o", "other"]).code, 0);
    let ran = place.command(&["run", "study.toml", "--dry-run", "-o", "none"]);
    assert!(ran.code == 0 && ran.said.contains("400 time steps"), "{}", ran.said);
    assert!(!place.0.path().join("none").exists());
}

/// Source: OpenSees with its WheelRail element (`tests/tracks/sleepers.py`): Euler beams on pads, sleepers and ballast, which a wheel with a suspended mass crosses, Hertz's law with a fixed coefficient. Goal: the deflection (mm) of the middle
/// of the rail and the contact force (kN) of every step. Accuracy: OTHER, 1 % of the largest deflection, and of the largest force.
#[test]
#[ignore = "half a minute and OpenSees from the package index: cargo long opensees"]
fn a_rail_on_sleepers_is_that_of_opensees() {
    const OTHER: f64 = 0.01;
    let lock = include_str!("../testing/requirements-peers.lock");
    let cache = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let Some(python) = railspring_testing::locked(cache, "peers", lock) else { return };
    let place = Place::new();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/tracks/sleepers.py");
    let theirs = place.0.path().join("theirs.csv");
    let ran = std::process::Command::new(python).arg(script).arg(&theirs).output().unwrap();
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let theirs = csv_of(&std::fs::read_to_string(theirs).unwrap());
    // C = G^-1.5 of G = 4.57e-8·R^-0.149
    let hertz = (4.57e-8 * 0.46_f64.powf(-0.149)).powf(-1.5) * 1e-9;
    let study = SLEEPERS
        .replace("elements = 120", "elements = 80")
        .replace(
            "profile = \"60E1\"",
            "section = { young_gpa = 210.0, inertia_m4 = 3.04e-5, mass_kg_per_m = 60.2 }",
        )
        .replace("steps = 400", "steps = 1200")
        + &format!("[contact]\nlaw = \"hertz\"\nhertz_gn_per_m15 = {hertz}\n");
    let ran = place.run(&study);
    assert_eq!(ran.code, 0, "{}", ran.said);
    for (ours, unit, other) in [("middle_deflection_mm", 1e3, "middle_m"), ("p_kn", 1e-3, "p_n")] {
        let ours = place.column(ours);
        let other = &theirs[other];
        assert_eq!(ours.len(), other.len());
        let largest = ours.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let off = ours.iter().zip(other).map(|(a, b)| (a - unit * b).abs()).fold(0.0, f64::max);
        assert!(off < OTHER * largest, "{unit}: {off} of {largest}");
    }
}

/// Goal: a wheelset on two rails over a bridge has columns of both wheels and the probes of all beams. It has
/// a flat, a dip on one side, random heights and a roll moment. The same seed gives the same bytes, and
/// another one does not. `--set` gives keys.
#[test]
fn a_wheelset_on_a_bridge_has_all_columns() {
    let place = Place::new();
    let study = SLEEPERS
        .replace("mass_t = 0.9", "kind = \"wheelset\"\nmass_t = 1.8\nroll_inertia_t_m2 = 1.0")
        .replace("suspended_mass_t = 5.0", "suspended_mass_t = 10.0\nsuspended_roll_inertia_t_m2 = 5.0")
        + r#"
[[probe]]
name = "bridge"
x_m = 6.0
on = "bridge"
side = "left"
[bridge]
from_m = 3.6
to_m = 8.4
section = { young_gpa = 35.0, inertia_m4 = 0.02, mass_kg_per_m = 2000.0 }
[excitation.roll_moment]
mean_kn_m = 5.0
[[excitation.irregularity]]
kind = "dipped-joint"
side = "left"
at_m = 4.5
depth_mm = 1.0
length_mm = 600.0
[[excitation.irregularity]]
kind = "wheel-flat"
side = "right"
at_m = 4.0
depth_mm = 0.2
length_mm = 110.0
diameter_m = 0.9
[[excitation.irregularity]]
kind = "spectrum"
amplitude_m2_rad_per_m = 1e-7
cutoff_rad_per_m = 0.8
waves_m = [0.5, 20.0]
seed = 3
"#;
    let ran = place.run(&study);
    assert_eq!(ran.code, 0, "{}", ran.said);
    let [right, left] = ["right_p_kn", "left_p_kn"].map(|name| place.column(name));
    let weight = 11.8 * 9.81;
    near(right[0] + left[0], weight, 1e-6, "weight");
    near(right[0] - left[0], 2.0 * 5.0 / 1.5, 1e-6, "moment");
    assert!(place.largest("bridge_deflection_mm") > 0.01);
    assert!(place.largest("suspended_z_mm").is_finite());
    let history = place.file("history.csv");
    place.run(&study);
    assert_eq!(place.file("history.csv"), history);
    let ran = place.command(&["run", "study.toml", "-o", "out", "-q", "--set", "wheel.mass_t=1.9"]);
    assert_eq!(ran.code, 0, "{}", ran.said);
    assert_ne!(place.file("history.csv"), history);
    // the mirror image has the columns of the wheels exchanged, to the last bit, and the probes on the other rail
    let ran = place.run(&study);
    assert_eq!(ran.code, 0, "{}", ran.said);
    let columns = csv_of(&place.file("history.csv"));
    assert_eq!(
        place.run(&study.replace("kind = \"wheelset\"", "kind = \"wheelset\"\nmirrored = true")).code,
        0
    );
    let mirrored = csv_of(&place.file("history.csv"));
    for (name, values) in &columns {
        let other = match name.split_once('_') {
            Some(("right", rest)) => format!("left_{rest}"),
            Some(("left", rest)) => format!("right_{rest}"),
            _ => name.clone(),
        };
        assert!(mirrored[&other] == *values, "{name}");
    }
    place.run(&study.replace("seed = 3", "seed = 4"));
    assert_ne!(place.file("history.csv"), history);
}

/// Goal: the page of the documents names every key of the schema, and its example runs.
#[test]
fn the_documents_have_every_key() {
    fn keys(schema: &Value, found: &mut Vec<String>) {
        match schema {
            Value::Object(map) => {
                if let Some(properties) = map.get("properties").and_then(Value::as_object) {
                    found.extend(properties.keys().cloned());
                }
                map.values().for_each(|inner| keys(inner, found));
            }
            Value::Array(items) => items.iter().for_each(|inner| keys(inner, found)),
            _ => {}
        }
    }
    let read = |name: &str| {
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(name)).unwrap()
    };
    // the first example is the one in the vertical plane
    let page = read("load-cases.md") + &read("lateral-load-cases.md");
    let schema =
        serde_json::to_value(schemars::schema_for!(railspring::track::document::TrackDocument)).unwrap();
    let mut found = Vec::new();
    keys(&schema, &mut found);
    assert!(found.len() > 60, "{found:?}");
    let missing: Vec<_> = found
        .iter()
        .filter(|key| !page.contains(&format!("`{key}`")) && !page.contains(&format!("{key}]")))
        .collect();
    assert!(missing.is_empty(), "{missing:?}");
    let example = page.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    let place = Place::new();
    let ran = place.run(example);
    assert_eq!(ran.code, 0, "{}", ran.said);
    assert!(place.largest("p_kn") > 1.2 * 5.9 * 9.81, "{}", place.largest("p_kn"));
}
