//! Load cases of a wheelset across the track, by the command line.

use std::path::Path;

use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::profile::wheels::wheel_profile;
use railspring_profiles::section::rail_section;
use serde_json::Value;

use super::track::{Place, Ran, csv_of, near};

/// The balance of a step, 1e-8 of the forces, and that of the start.
const SOLVER: f64 = 1e-6;

/// A wheelset on two rails on sleepers.
const WHEELSET: &str = r#"kind = "track"
name = "wheelset"
[rail]
length_m = 12.0
elements = 60
profile = "60E1"
[rail.sleepers]
spacing_m = 0.6
pad_stiffness_kn_per_m = 100e3
pad_damping_kn_s_per_m = 30.0
mass_kg = 150.0
ballast_stiffness_kn_per_m = 50e3
ballast_damping_kn_s_per_m = 50.0
[wheel]
kind = "wheelset"
mass_t = 1.8
roll_inertia_t_m2 = 1.0
suspended_mass_t = 10.0
suspended_roll_inertia_t_m2 = 6.0
suspension = { stiffness_kn_per_m = 1200.0, damping_kn_s_per_m = 40.0 }
[lateral]
wheel_profile = "S1002"
suspension = { stiffness_kn_per_m = 3000.0, damping_kn_s_per_m = 30.0 }
suspended_height_m = 1.0
[lateral.sleepers]
pad_stiffness_kn_per_m = 50e3
pad_damping_kn_s_per_m = 20.0
twist_kn_m_per_rad = 250.0
ballast_stiffness_kn_per_m = 20e3
ballast_damping_kn_s_per_m = 30.0
[run]
steps = 300
time_step_s = 1e-3
inner_steps = 4
start_x_m = 2.0
speed_m_per_s = 20.0
[[probe]]
name = "here"
x_m = 5.0
[[probe]]
name = "there"
x_m = 5.0
side = "left"
"#;

fn record(place: &Place) -> Value {
    serde_json::from_str(&place.file("track.json")).unwrap()
}

fn done(ran: &Ran, code: i32) {
    assert_eq!(ran.code, code, "{}", ran.said);
}

/// Goal: the shipped earthquake ends as a derailment: exit code 1; record, page and message say when, where, which wheel and how; the history has the steps before, and nothing of it was verified.
/// The same bytes come again.
#[test]
fn the_shipped_earthquake_derails_a_wheelset() {
    let studies = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/studies");
    let read = |name: &str| std::fs::read_to_string(studies.join(name)).unwrap();
    let place = Place::new();
    place.write("wheelset-earthquake.csv", &read("wheelset-earthquake.csv"));
    let study = read("wheelset-earthquake.toml");
    let ran = place.run(&study);
    done(&ran, 1);
    let made = record(&place);
    assert_eq!(made["ending"], "derailed");
    assert_eq!(made["verification"]["verified"], false);
    let (time, x) = (made["ended_at_s"].as_f64().unwrap(), made["derailment"]["x_m"].as_f64().unwrap());
    assert!((x - (6.0 + 20.0 * time)).abs() < 1e-6 && (5.0..9.0).contains(&time), "{made}");
    assert!(["right", "left"].contains(&made["derailment"]["wheel"].as_str().unwrap()), "{made}");
    assert!(["climbed", "lifted"].contains(&made["derailment"]["how"].as_str().unwrap()), "{made}");
    let note = made["notes"][0].as_str().unwrap();
    assert!(note.contains("derailed at") && note.contains("x = "), "{note}");
    let times = place.column("time_s");
    assert!(times.len() == (time / 2e-3).ceil() as usize && times[times.len() - 1] < time, "{time}");
    // it rocked before: wheels were lifted higher than their flanges
    assert!(place.largest("right_flange_tip_mm") > 0.0 && place.largest("left_flange_tip_mm") > 0.0);
    let page = place.file("report.html");
    for said in ["derailed at", "Q/P", "flange tip, mm", "roll, mrad", "othing was verified"] {
        assert!(page.contains(said), "{said}");
    }
    let files = ["history.csv", "track.json", "report.html"];
    let before = files.map(|name| place.file(name));
    done(&place.run(&study), 1);
    assert!(before == files.map(|name| place.file(name)));
}

/// Goal: the mirrored study has the columns of right and left exchanged and those across the track turned over, in the same characters; profiles, irregularities, forces, moments and ground are not symmetric.
#[test]
fn the_mirrored_key_gives_the_mirrored_bytes() {
    let place = Place::new();
    place.write("way.csv", "x_m,y_mm\n0,0\n3,1\n5,-1\n7,2\n12,0\n");
    let excitation = r#"
[excitation]
lateral_force = { mean_kn = 5.0, harmonics = [{ amplitude_kn = 12.0, frequency_hz = 6.0 }] }
roll_moment = { mean_kn_m = 3.0 }
vertical_force = { mean_kn = 4.0 }
lateral_ground_acceleration = { harmonics = [{ amplitude_m_per_s2 = 1.0, frequency_hz = 3.0 }] }
ground_acceleration = { harmonics = [{ amplitude_m_per_s2 = 0.5, frequency_hz = 7.0 }] }
rail_torsion = [{ at_m = 5.2, side = "left", mean_kn_m = 0.2, harmonics = [{ amplitude_kn_m = 0.3, frequency_hz = 9.0 }] }]
[[excitation.irregularity]]
kind = "table"
direction = "lateral"
table = { file = "way.csv", column = "y_mm", between = "corners" }
[[excitation.irregularity]]
kind = "dipped-joint"
side = "left"
at_m = 4.0
depth_mm = 1.0
length_mm = 600.0
"#;
    let study = WHEELSET.replace(
        "wheel_profile = \"S1002\"",
        "wheel_profile = \"S1002\"\nleft_wheel_profile = \"EN13715-1in40\"\nlateral_shift_mm = 1.0",
    );
    let study = study + excitation;
    done(&place.run(&study), 0);
    let plain = place.file("history.csv");
    let with_key = study.replace("kind = \"wheelset\"", "kind = \"wheelset\"\nmirrored = true");
    done(&place.run(&with_key), 0);
    let mirrored = place.file("history.csv");
    let cells = |text: &str| -> Vec<Vec<String>> {
        text.lines().map(|line| line.split(',').map(String::from).collect()).collect()
    };
    let (plain, mirrored) = (cells(&plain), cells(&mirrored));
    assert_eq!(plain.len(), 302);
    let turned = [
        "wheelset_y_mm",
        "wheelset_roll_mrad",
        "suspended_y_mm",
        "suspended_roll_mrad",
        "suspended_lateral_acceleration_m_per_s2",
    ];
    let mut negated = 0;
    for (at, name) in plain[0].iter().enumerate() {
        let other = match name.split_once('_') {
            Some(("right", rest)) => format!("left_{rest}"),
            Some(("left", rest)) => format!("right_{rest}"),
            _ => name.clone(),
        };
        let turn = turned.contains(&name.as_str()) || name.ends_with("suspension_y_kn");
        negated += usize::from(turn);
        let there = mirrored[0].iter().position(|known| *known == other).unwrap();
        for (row, image) in plain.iter().zip(&mirrored).skip(1) {
            let (cell, image) = (&row[at], &image[there]);
            let expected = match (turn, cell.strip_prefix('-')) {
                (true, Some(positive)) => positive.to_string(),
                (true, None) => format!("-{cell}"),
                (false, _) => cell.clone(),
            };
            // zero has a sign
            let zero = |text: &str| text.trim_start_matches('-') == "0";
            assert!(expected == *image || zero(&expected) && zero(image), "{name}: {cell} {image}");
        }
    }
    assert_eq!(negated, 7);
    // and it is no symmetric case
    let columns = csv_of(&place.file("history.csv"));
    assert!(columns["right_p_kn"] != columns["left_p_kn"]);
    assert!(place.largest("here_torsion_kn_m") > 1e-3);
}

/// Source: statics. Goal: at the start the wheels carry the weight and the lateral force (kN), the suspensions the mass above; Q/P and the unloading are their ratios; without friction at the start nothing
/// sticks. A force beyond every flange, or a roll that lifts a wheel, has no equilibrium. Accuracy: SOLVER.
#[test]
fn a_pushed_wheelset_starts_in_balance() {
    let place = Place::new();
    let pushed = format!("{WHEELSET}[excitation]\nlateral_force = {{ mean_kn = 15.0 }}\n")
        .replace("steps = 300", "steps = 3");
    done(&place.run(&pushed), 0);
    let at_start = |name: &str| place.column(name)[0];
    let [p, q] =
        ["p_kn", "q_kn"].map(|name| ["right", "left"].map(|side| at_start(&format!("{side}_{name}"))));
    near(p[0] + p[1], 11.8 * 9.81, SOLVER, "weight");
    near(q[0] - q[1], 15.0, SOLVER, "lateral force");
    assert!(p[0] > 1.2 * p[1] && at_start("right_contacts") == 2.0, "{p:?}");
    near(at_start("right_q_over_p"), q[0] / p[0], SOLVER, "Q/P");
    assert_eq!(at_start("right_unloading"), 0.0);
    near(at_start("right_suspension_z_kn") + at_start("left_suspension_z_kn"), 98.1, SOLVER, "suspended");
    let lean = at_start("wheelset_roll_mrad") * 1e-3 * 98.1;
    near(2.0 * at_start("right_suspension_y_kn") - lean, 15.0, SOLVER, "suspended across");
    for (excitation, said) in [
        ("lateral_force = { mean_kn = 600.0 }", "both wheels"),
        ("roll_moment = { mean_kn_m = 100.0 }", "both wheels"),
    ] {
        let ran = place.run(&format!("{WHEELSET}[excitation]\n{excitation}\n"));
        done(&ran, 2);
        assert!(ran.said.contains("run.start = ") && ran.said.contains(said), "{}", ran.said);
    }
}

/// Source: EN 14363. Goal: Q/P over 2 m is empty in the first 2 m and has a value in every later row; without speed it has none.
#[test]
fn the_mean_ratio_begins_after_two_metres() {
    let place = Place::new();
    done(&place.run(WHEELSET), 0);
    let (x, mean) = (place.column("x_m"), place.column("right_q_over_p_2m"));
    for (x, mean) in x.iter().zip(&mean) {
        assert_eq!(mean.is_nan(), *x < 4.0 - 1e-9, "{x} {mean}");
    }
    done(&place.run(&WHEELSET.replace("speed_m_per_s = 20.0", "speed_m_per_s = 0.0")), 0);
    assert!(place.column("right_q_over_p_2m").iter().all(|mean| mean.is_nan()));
    assert!(record(&place)["figures"].as_array().unwrap().iter().all(|f| f["column"] != "right_q_over_p_2m"));
}

/// Goal: mistakes are reported with file, line and key, what was expected and a remedy; exit code 2, and nothing is written.
#[test]
fn mistakes_are_named() {
    let place = Place::new();
    let with = |from: &str, to: &str| {
        assert!(WHEELSET.contains(from), "{from}");
        WHEELSET.replace(from, to)
    };
    let and = |text: &str| format!("{WHEELSET}{text}");
    let in_plane = WHEELSET.split("[lateral]").next().unwrap().to_string()
        + WHEELSET.split_once("[run]").map(|(_, run)| "[run]".to_string() + run).unwrap().as_str();
    let rigid = with("length_m = 12.0\nelements = 60\nprofile = \"60E1\"\n", "rigid = true\n");
    let rigid = rigid.split("[rail.sleepers]").next().unwrap().to_string()
        + "[wheel]"
        + rigid.split_once("[wheel]").unwrap().1;
    let rigid = rigid.split("[lateral.sleepers]").next().unwrap().to_string()
        + "[run]"
        + rigid.split_once("[run]").unwrap().1;
    let rigid = rigid.split("[[probe]]").next().unwrap().to_string();
    let single = with("kind = \"wheelset\"", "kind = \"wheel\"")
        .replace("roll_inertia_t_m2 = 1.0\n", "")
        .replace("suspended_roll_inertia_t_m2 = 6.0\n", "")
        .replace("side = \"left\"\n", "");
    for (study, key, said) in [
        (single, "wheel.kind", "a single wheel or a force does not move across the track"),
        (with("S1002", "S1003"), "lateral.wheel_profile", "profile list"),
        (
            with("wheel_profile = \"S1002\"", "wheel_profile = \"S1002\"\nrail_profile = \"61E1\""),
            "lateral.rail_profile",
            "profile list",
        ),
        (
            with("wheel_profile = \"S1002\"", "wheel_profile = \"S1002\"\nlateral_shift_mm = 99.0"),
            "lateral.lateral_shift_mm",
            "touch",
        ),
        (with("suspended_height_m = 1.0", "friction = -0.1"), "lateral.friction", "0"),
        (
            with("suspension = { stiffness_kn_per_m = 3000.0, damping_kn_s_per_m = 30.0 }\n", ""),
            "lateral.suspension",
            "(missing)",
        ),
        (
            with("\nballast_stiffness_kn_per_m = 20e3", ""),
            "lateral.sleepers.ballast_stiffness_kn_per_m",
            "(missing)",
        ),
        (
            WHEELSET.split("[lateral.sleepers]").next().unwrap().to_string()
                + "[run]"
                + WHEELSET.split_once("[run]").unwrap().1,
            "lateral.sleepers",
            "(missing)",
        ),
        (rigid, "lateral.rail_profile", "(missing)"),
        (and("[contact]\ndamping_kn_s_per_m = 1.0\n"), "contact.damping_kn_s_per_m", "leave it out"),
        (
            with(
                "profile = \"60E1\"",
                "section = { young_gpa = 210.0, inertia_m4 = 3e-5, mass_kg_per_m = 60.0 }",
            ),
            "rail.section",
            "rail.profile",
        ),
        (
            and(
                "[bridge]\nfrom_m = 0.0\nto_m = 12.0\nsection = { young_gpa = 35.0, inertia_m4 = 1.0, mass_kg_per_m = 1000.0 }\n",
            ),
            "bridge",
            "[bridge]",
        ),
        (
            and("[excitation]\nrail_torsion = [{ at_m = 13.0 }]\n"),
            "excitation.rail_torsion[0].at_m",
            "0 to 12 m",
        ),
        (
            and(
                "[[excitation.irregularity]]\nkind = \"dipped-joint\"\ndirection = \"lateral\"\nat_m = 4.0\ndepth_mm = 1.0\nlength_mm = 600.0\n",
            ),
            "excitation.irregularity[0].direction",
            "spectrum",
        ),
        (
            in_plane.clone() + "[excitation]\nlateral_force = { mean_kn = 1.0 }\n",
            "excitation.lateral_force",
            "`[lateral]`",
        ),
        (
            in_plane.clone() + "[excitation]\nlateral_ground_acceleration = {}\n",
            "excitation.lateral_ground_acceleration",
            "`[lateral]`",
        ),
        (
            in_plane.replace(
                "start_x_m = 2.0",
                "start_x_m = 2.0\nstart = \"above\"\nlateral_velocity_m_per_s = 1.0",
            ),
            "run.lateral_velocity_m_per_s",
            "`[lateral]`",
        ),
        (
            with("start_x_m = 2.0", "start_x_m = 2.0\nlateral_velocity_m_per_s = 1.0"),
            "run.lateral_velocity_m_per_s",
            "above",
        ),
    ] {
        let ran = place.run(&study);
        assert_eq!(ran.code, 2, "{key}: {}", ran.said);
        assert!(
            ran.said.contains("study.toml:") && ran.said.contains(&format!("{key} = ")),
            "{key}: {}",
            ran.said
        );
        assert!(ran.said.contains(said), "{said}: {}", ran.said);
    }
}

/// Goal: the example of the page of the documents runs.
#[test]
fn the_example_of_the_documents_runs() {
    let page =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/lateral-load-cases.md"))
            .unwrap();
    let example = page.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    let place = Place::new();
    done(&place.run(example), 0);
    assert!(place.largest("right_q_kn") > 10.0, "{}", place.largest("right_q_kn"));
}

/// Points of a profile every quarter millimetre, as a file has them.
fn points(curve: &ProfileCurve) -> String {
    let rows = curve.sample(0.25e-3).into_iter();
    rows.fold("y_mm;z_mm\n".into(), |text, at| text + &format!("{:.6};{:.6}\n", 1e3 * at.x, 1e3 * at.y))
}

/// Source: the same wheelset on standard profiles. Goal: points of these profiles from files give its P and Q (kN) while a lateral force presses it on a flange. The record has the files with
/// keys and hashes, and a note says which standard each was taken for. A worn wheel on the left changes the forces there. Accuracy: DISCRETISATION, points are joined and smoothed to 0.1 µm, which moves
/// contacts where curvatures change: a hundredth of the largest force.
#[test]
fn measured_profiles_are_read_from_files() {
    const DISCRETISATION: f64 = 1e-2;
    let place = Place::new();
    let wheel = points(&wheel_profile("S1002").unwrap());
    place.write("wheel.csv", &wheel);
    place.write("rail.csv", &points(&rail_section("60E1").unwrap().running));
    place.write("worn.whl", include_str!("../data/profiles/worn-s1002.whl"));
    let pushed = format!("{WHEELSET}[excitation]\nlateral_force = {{ mean_kn = 15.0 }}\n");
    let with = |keys: &str| pushed.replace("wheel_profile = \"S1002\"", keys);
    let forces = ["right_p_kn", "left_p_kn", "right_q_kn", "left_q_kn"];
    done(&place.run(&pushed), 0);
    let standard = forces.map(|name| place.column(name));
    let largest = standard[0].iter().copied().fold(0.0, f64::max);
    let off = |of: &[Vec<f64>; 4], column: usize| {
        let off = of[column].iter().zip(&standard[column]).map(|(a, b)| (a - b).abs() / largest);
        off.fold(0.0, f64::max)
    };
    done(&place.run(&with("wheel_profile = \"wheel.csv\"\nrail_profile = \"rail.csv\"")), 0);
    let measured = forces.map(|name| place.column(name));
    for (column, name) in forces.iter().enumerate() {
        assert!(off(&measured, column) < DISCRETISATION, "{name}: {}", off(&measured, column));
    }
    let made = record(&place);
    let file = |key: &str| {
        let files = made["files"].as_array().unwrap();
        files.iter().find(|file| file["key"] == key).unwrap_or_else(|| panic!("{key}: {made}")).clone()
    };
    assert_eq!(file("lateral.wheel_profile")["blake3"], blake3::hash(wheel.as_bytes()).to_hex().as_str());
    assert_eq!(file("lateral.rail_profile")["file"], "rail.csv");
    let notes = made["notes"].to_string();
    assert!(notes.contains("wheel.csv") && notes.contains("S1002") && notes.contains("60E1"), "{notes}");
    done(&place.run(&with("wheel_profile = \"S1002\"\nleft_wheel_profile = \"worn.whl\"")), 0);
    let worn = forces.map(|name| place.column(name));
    assert!(off(&worn, 3) > DISCRETISATION, "{}", off(&worn, 3));
    place.write("broken.csv", "y_mm;z_mm\n1;x\n");
    for (keys, key, said) in [
        ("wheel_profile = \"rail.csv\"", "lateral.wheel_profile", "profile of a wheel"),
        (
            "wheel_profile = \"S1002\"\nrail_profile = \"wheel.csv\"",
            "lateral.rail_profile",
            "profile of a rail",
        ),
        (
            "wheel_profile = \"S1002\"\nleft_wheel_profile = \"broken.csv\"",
            "lateral.left_wheel_profile",
            "broken.csv",
        ),
        ("wheel_profile = \"none.csv\"", "lateral.wheel_profile", "profile list"),
    ] {
        let ran = place.run(&with(keys));
        assert_eq!(ran.code, 2, "{keys}: {}", ran.said);
        let named = ran.said.contains("study.toml:") && ran.said.contains(&format!("{key} = "));
        assert!(named && ran.said.contains(said), "{keys}: {}", ran.said);
    }
}
