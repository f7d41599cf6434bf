//! Study files: the shipped ones, defaults, and what is said about wrong ones.

mod load_cases;
mod materials;

use std::path::Path;

use railspring_profiles::profile_file::Smoothing;

use super::*;
use crate::hash::key;

const SHORT: &str = "name = \"x\"\n[rail]\nprofile = \"60E1\"\n[wheel]\nprofile = \"S1002\"\n";

fn parse(text: &str) -> Result<Study, Mistakes> {
    Study::parse(Path::new("x.toml"), text)
}

/// The message for the short study with more lines; these begin on line 6.
fn message(more: &str) -> String {
    parse(&format!("{SHORT}{more}")).expect_err(more).to_string()
}

#[test]
fn a_short_study_gets_the_published_setup() {
    let study = parse(SHORT).unwrap();
    assert_eq!(study.rail.inclination, 1.0 / 40.0);
    assert_eq!(study.rail.length, 0.555);
    assert_eq!(study.wheel.tape_diameter, 0.858);
    assert_eq!(study.rail.material.young, 210e9);
    assert_eq!(study.calibration.loads.len(), 24);
    assert_eq!((study.calibration.loads[0], study.calibration.loads[23]), (1e3, 150e3));
    assert!(study.calibration.loads.windows(2).all(|pair| pair[0] < pair[1]));
    assert_eq!(study.contact.penalty, 1e9);
    assert_eq!(study.main_scenario, None);
    let given: Vec<&str> = study.resolved.iter().filter(|k| k.given).map(|k| k.key.as_str()).collect();
    assert_eq!(given, ["profile", "profile"]);
}

#[test]
fn the_shipped_studies_are_the_published_load_cases() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/studies");
    let constant = Study::read(&folder.join("uic60-s1002.toml")).unwrap();
    let scenario = &constant.scenarios["constant"].scenario;
    assert_eq!(constant.main_scenario.as_deref(), Some("constant"));
    assert_eq!((scenario.steps, scenario.time_step, scenario.gravity), (550, 0.0005, 0.0));
    assert_eq!(scenario.suspended_mass, 6250.0);
    assert_eq!(scenario.vertical_suspension, scenario.lateral_suspension);
    assert_eq!((scenario.vertical_suspension.stiffness, scenario.vertical_suspension.damping), (1.2e6, 4e4));
    assert_eq!((scenario.lateral_force.at(0.0), scenario.lateral_force.at(0.123)), (20e3, 20e3));
    // ROUNDOFF: one multiplication and one sine.
    const ROUNDOFF: f64 = 1e-9;
    assert!((scenario.vertical_force.at(0.025) - 71.25e3).abs() < ROUNDOFF, "first pushes down");

    let sine = Study::read(&folder.join("uic60-s1002-sine.toml")).unwrap();
    assert_eq!(sine.main_scenario.as_deref(), Some("sine"));
    assert!((sine.scenarios["sine"].scenario.lateral_force.at(0.025) - 10.4125e3).abs() < ROUNDOFF);
    let torsion = &sine.scenarios["torsion"];
    assert!((torsion.scenario.rail_torsion.as_ref().unwrap().at(0.05) - 183.25e3).abs() < ROUNDOFF);
    assert_eq!((torsion.solid, torsion.scenario.start_x, torsion.scenario.speed), (false, Some(0.0), 0.5));
    assert_eq!(sine.rail, constant.rail, "both studies calibrate the same pair");
    assert_eq!(sine.calibration, constant.calibration);

    let large = Study::read(&folder.join("paper-scale.toml")).unwrap();
    assert_eq!((&large.rail, &large.wheel), (&constant.rail, &constant.wheel));
    for (name, of) in [("constant", &constant), ("sine", &sine)] {
        assert_eq!(large.scenarios[name].scenario, of.scenarios[name].scenario, "{name}");
        assert!(large.scenarios[name].solid);
    }
    let short_steps = SolidKeys { inner_steps: Some(16), ..SolidKeys::default() };
    assert_eq!((large.calibration.loads.len(), large.solid), (30, short_steps));
}

#[test]
fn unknown_keys_name_the_line_and_the_nearest_known_key() {
    let unit = message("[track]\ngauge_m = 1.435\n");
    assert!(unit.starts_with("x.toml:7: track.gauge_m = 1.435: expected a key of [track] ("), "{unit}");
    assert!(unit.ends_with("did you mean `track.gauge_mm`?"), "{unit}");
    let section = message("[tracks]\n");
    assert!(
        section.starts_with("x.toml:6: tracks") && section.ends_with("did you mean `track`?"),
        "{section}"
    );
    let nested = message("[scenario.s]\nlateral_force = { means_kn = 1 }\nvertical_force = {}\n");
    assert!(nested.starts_with("x.toml:7: scenario.s.lateral_force.means_kn = 1"), "{nested}");
    assert!(nested.ends_with("did you mean `scenario.s.lateral_force.mean_kn`?"), "{nested}");
    let elsewhere = message("[contact]\nyoung_gpa = 200\n");
    assert!(elsewhere.ends_with("it belongs to `material.young_gpa`"), "{elsewhere}");
}

#[test]
fn missing_keys_name_their_section() {
    let missing = parse("name = \"x\"\n\n[rail]\n[wheel]\nprofile = \"S1002\"\n").unwrap_err().to_string();
    assert!(
        missing.starts_with("x.toml:3: rail.profile = (missing): expected a text in quotes"),
        "{missing}"
    );
    assert!(missing.contains("add this key to [rail]: Name of the standard section"), "{missing}");
    let section = parse("name = \"x\"\n[rail]\nprofile = \"60E1\"\n").unwrap_err().to_string();
    assert!(section.starts_with("x.toml: wheel = (missing): expected a section"), "{section}");
    let force = message("[scenario.s]\nvertical_force = {}\n");
    assert!(force.starts_with("x.toml:6: scenario.s.lateral_force = (missing)"), "{force}");
}

#[test]
fn wrong_types_and_ranges_say_what_was_expected() {
    let text = message("[track]\n\ngauge_mm = \"1435 mm\"\n");
    assert!(
        text.starts_with("x.toml:8: track.gauge_mm = \"1435 mm\": expected a number from 500 to 2000"),
        "{text}"
    );
    let range = message("[material]\npoisson = 0.5\n");
    assert!(
        range.starts_with("x.toml:7: material.poisson = 0.5: expected a number from 0 to 0.49"),
        "{range}"
    );
    let nan = message("[material]\npoisson = nan\n");
    assert!(nan.contains("poisson = nan: expected"), "{nan}");
    let choice = message("[contact]\nenforcement = \"hard\"\n");
    assert!(choice.contains("= \"hard\": expected one of \"exact\", \"penalty\""), "{choice}");
    let list = message("[calibration]\nloads_kn = [1, 2, 3, -4]\n");
    assert!(
        list.starts_with("x.toml:7: calibration.loads_kn[3] = -4: expected a number from 0.01"),
        "{list}"
    );
    let few = message("[calibration]\nloads_kn = [1, 2, 3]\n");
    assert!(few.contains("= [1, 2, 3]: expected a list of at least 4 entries"), "{few}");
    let whole = message("[simulation]\nrail_elements = 20.5\n");
    assert!(whole.contains("= 20.5: expected a whole number from 2 to 10000"), "{whole}");
    let flag = message("[scenario.s]\nlateral_force = {}\nvertical_force = {}\nsolid = 1\n");
    assert!(flag.contains("solid = 1: expected true or false"), "{flag}");
}

#[test]
fn values_that_contradict_each_other_are_refused() {
    let fine = "[contact]\nfield = \"hybrid\"\nenforcement = \"penalty\"\n[material]\npoisson = 7\n";
    let fine = parse(&format!("{SHORT}{fine}")).unwrap_err().to_string();
    assert!(fine.contains("contact.enforcement = \"penalty\": expected \"exact\""), "{fine}");
    assert!(fine.contains("material.poisson = 7") && !fine.contains("1000000"), "{fine}");
    let order = message("[calibration]\nloads_kn = [1, 3, 2, 4]\n");
    assert!(order.starts_with("x.toml:7: calibration.loads_kn = 3, 2: expected ascending loads"), "{order}");
    let order = message("[calibration]\nhorizontal_preloads_kn = [20, 60, 50]\n");
    assert!(
        order.starts_with("x.toml:7: calibration.horizontal_preloads_kn = 60, 50: expected ascending"),
        "{order}"
    );
    let published = "[verification]\npublished_stiffness = 0.25\n";
    let unasked = message(published);
    assert!(unasked.starts_with("x.toml:7: verification.published_stiffness = 0.25: expected"), "{unasked}");
    assert!(unasked.contains("set `calibration.foot_held = true`"), "{unasked}");
    for asked in ["reference = \"foot\"", "foot_held = true"] {
        let study = parse(&format!("{SHORT}[calibration]\n{asked}\n{published}")).unwrap();
        assert!(study.calibration.foot_held, "{asked}");
    }
    let range = message("[calibration]\nload_max_kn = 0.5\n");
    assert!(range.starts_with("x.toml:7: calibration.load_max_kn = 0.5: expected more than"), "{range}");
    let ratio = parse(&SHORT.replace("\"60E1\"", "\"60E1\"\ninclination = \"40\"")).unwrap_err().to_string();
    assert!(ratio.starts_with("x.toml:4: rail.inclination = \"40\": expected a ratio such as"), "{ratio}");
    let name = parse(&SHORT.replace("\"x\"", "\"a/b\"")).unwrap_err().to_string();
    assert!(name.starts_with("x.toml:1: name = \"a/b\""), "{name}");
    let forces = "lateral_force = {}\nvertical_force = {}\n";
    let moving = message(&format!("[scenario.s]\n{forces}speed_m_per_s = 1\n"));
    let beyond = "scenario.s.speed_m_per_s = 1 m/s, which brings the wheel from 0.2775 to 0.5525 m: expected 0.0397 to 0.5153 m";
    assert!(moving.contains(beyond), "{moving}");
    assert!(
        moving.contains("take fewer steps (`scenario.s.steps`), start elsewhere (`scenario.s.start_x_m`)"),
        "{moving}"
    );
    let end = message(&format!("[scenario.s]\n{forces}start_x_m = 0\n"));
    assert!(end.starts_with("x.toml:9: scenario.s.start_x_m = 0 m: expected 0.0397 to 0.5153 m"), "{end}");
    assert!(end.contains("lengthen the rail (`rail.length_m`), or set `scenario.s.solid` = false"), "{end}");
    let full =
        message(&format!("[solid]\ntransient = \"full\"\n[scenario.s]\n{forces}speed_m_per_s = 0.1\n"));
    assert!(
        full.contains("scenario.s.solid = true (default): expected false, because bodies at full order"),
        "{full}"
    );
    assert!(parse(&format!("{SHORT}[scenario.s]\n{forces}speed_m_per_s = 0.1\n")).is_ok());
    let off = message(&format!("[scenario.s]\n{forces}solid = false\nstart_x_m = 1\n"));
    assert!(off.contains("start_x_m = 1: expected a place on the rail"), "{off}");
    let fast = "lateral_force = { amplitude_kn = 1, frequency_hz = 1000 }\nvertical_force = {}\n";
    let missed = message(&format!("[scenario.s]\n{fast}time_step_s = 1e-3\n"));
    assert!(missed.contains("scenario.s.lateral_force = 1000 Hz at time steps of 0.001 s"), "{missed}");
    assert!(missed.contains("lower `scenario.s.time_step_s` to 5.000e-5 s or less"), "{missed}");
    let unknown = message(&format!("[simulation]\nscenario = \"t\"\n[scenario.s]\n{forces}"));
    assert!(unknown.starts_with("x.toml:7: simulation.scenario = \"t\": expected one of"), "{unknown}");
}

#[test]
fn broken_toml_names_its_line() {
    let broken = message("[track\n");
    assert!(broken.starts_with("x.toml:6: study file = "), "{broken}");
    let twice = message("[track]\n[track]\n");
    assert!(twice.starts_with("x.toml:7: study file = "), "{twice}");
}

#[test]
fn an_error_of_a_later_stage_finds_its_line() {
    let study = parse(&format!("{SHORT}[track]\nlateral_shift_mm = 80\n")).unwrap();
    let error = InputError::new("track.lateral_shift_mm", "80 mm", "e", "r");
    assert_eq!(
        study.source.locate(error).to_string(),
        "x.toml:7: track.lateral_shift_mm = 80 mm: expected e; r"
    );
    let default = InputError::new("track.gauge_mm", "1435 mm", "e", "r");
    assert!(
        study.source.locate(default).to_string().starts_with("x.toml:6: track.gauge_mm = 1435 mm (default)")
    );
    assert!(study.owns("mesh.growth") && !study.owns("output folder"));
}

#[test]
fn the_schema_describes_every_key() {
    fn undescribed(schema: &serde_json::Value, path: &str, found: &mut Vec<String>) {
        for (key, value) in schema.get("properties").and_then(|p| p.as_object()).into_iter().flatten() {
            if value.get("description").is_none() {
                found.push(format!("{path}.{key}"));
            }
        }
    }
    let schema = schema();
    let mut found = Vec::new();
    undescribed(&schema, "", &mut found);
    for (name, definition) in schema["$defs"].as_object().unwrap() {
        undescribed(definition, name, &mut found);
    }
    assert!(found.is_empty(), "{found:?}");
    assert!(schema["properties"].as_object().unwrap().len() >= 10);
}

#[test]
fn measured_profiles_are_named_by_file_and_body() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.toml");
    let head = folder.path().join("head.csv");
    std::fs::write(&head, "0,0\n").unwrap();
    let study = |rail: &str| {
        Study::parse(&path, &format!("name = \"x\"\n[rail]\n{rail}\n[wheel]\nprofile = \"S1002\"\n"))
    };
    let given = "profile_file = \"head.csv\"\nstandard = \"60E1\"\nprofile_smoothing_mm = 2";
    let read = study(given).unwrap();
    let measured = read.rail.measured.as_ref().unwrap();
    assert_eq!(
        (read.rail.profile.as_deref(), measured.smoothing, measured.aligned),
        (Some("60E1"), Smoothing::Halves(2e-3), None)
    );
    assert_eq!(&*measured.content.bytes(&measured.path).unwrap(), b"0,0\n");

    // The hash follows the content, not the place.
    std::fs::copy(&head, folder.path().join("other.csv")).unwrap();
    assert_eq!(key(&study(&given.replace("head", "other")).unwrap().statics()), key(&read.statics()));
    std::fs::write(&head, "0,1\n").unwrap();
    assert_ne!(key(&study(given).unwrap().statics()), key(&read.statics()));

    let refused = |rail: &str| study(rail).unwrap_err().to_string();
    // Without a standard the body is found when the profile is read.
    let open = study("profile_file = \"head.csv\"").unwrap();
    assert_eq!((open.rail.profile, open.rail.body), (None, None));
    let body = study("profile_file = \"head.csv\"\nbody = \"136RE\"").unwrap().rail.body;
    assert!(matches!(body, Some(super::RailBody::Drawn(name, _)) if name == "136RE"));
    let dimensions = "body = { height_mm = 160, foot_mm = 140, head_mm = 70, web_mm = 15 }";
    assert!(study(&format!("profile_file = \"head.csv\"\n{dimensions}")).unwrap().rail.body.is_some());
    for (keys, part) in [
        ("profile_file = \"head.csv\"\nbody = \"136RF\"", ":4: rail.body = \"136RF\": expected one of"),
        ("profile_file = \"head.csv\"\nbody = \"136RF\"", "did you mean \"136RE\"?"),
        (
            "profile_file = \"head.csv\"\nstandard = \"60E1\"\nbody = \"136RE\"",
            "either rail.body or rail.standard",
        ),
        ("profile = \"60E1\"\nbody = \"136RE\"", "either rail.body or rail.profile"),
    ] {
        let refused = refused(keys);
        assert!(refused.contains(part), "{part}: {refused}");
    }
    // A head of 60E1, without wear: it lies on its standard within its rounding to 0.0001 mm.
    let section = railspring_profiles::section::rail_section("60E1").unwrap();
    let rows = section.running.sample(0.5e-3).into_iter();
    let rows: String = rows.map(|p| format!("{:.4},{:.4}\n", 1e3 * p.x, 1e3 * p.y)).collect();
    std::fs::write(folder.path().join("new.csv"), rows).unwrap();
    let near = refused("profile_file = \"new.csv\"\nstandard = \"61E1\"");
    let nearest = "nearest to \"new.csv\" are 60E1 (0.000 mm off what wear leaves alone, 0 % worn or unlike)";
    assert!(near.contains(nearest), "{near}");
    let both = refused("profile = \"60E1\"\nprofile_file = \"head.csv\"");
    assert!(both.contains(":3: rail.profile = \"60E1\": expected either"), "{both}");
    let absent = refused("profile_file = \"no.csv\"\nstandard = \"60E1\"");
    assert!(absent.contains(":3: rail.profile_file = \"no.csv\": expected a readable file"), "{absent}");
    let alone = refused("profile = \"60E1\"\nprofile_smoothing_mm = 2");
    assert!(alone.contains(":4: rail.profile_smoothing_mm = 2: expected rail.profile_file"), "{alone}");
}

#[test]
fn all_mistakes_are_reported_together_in_the_order_of_the_file() {
    let text = "name = \"a/b\"\n[rail]\nprofile = \"60E3\"\ninclination = \"40\"\nlength_m = 900\n[wheel]\nprofile = \"S1002\"\n\
                bore_mm = 300\n[track]\ngauge_m = 1.4\n[calibration]\nloads_kn = [1, 3, 2, 4]\n[simulation]\n\
                scenario = \"x\"\n[scenario.s]\nlateral_force = {}\nvertical_force = {}\nspeed_m_per_s = 1\n\
                time_step_s = 0.1\n";
    let mistakes = parse(text).unwrap_err();
    let line = |place: &Option<Place>| match place {
        Some(Place::Line(line)) => *line,
        other => panic!("{other:?}"),
    };
    let found: Vec<(usize, &str)> =
        mistakes.all().iter().map(|m| (line(&m.place), m.error.key.as_str())).collect();
    let expected = [
        (1, "name"),
        (3, "rail.profile"),
        (4, "rail.inclination"),
        (5, "rail.length_m"),
        (6, "wheel.hub_diameter_mm"),
        (10, "track.gauge_m"),
        (12, "calibration.loads_kn"),
        (14, "simulation.scenario"),
        (19, "scenario.s.time_step_s"),
    ];
    assert_eq!(found, expected, "{mistakes}");
    // Each with line, value, expectation and remedy.
    for message in mistakes.messages() {
        assert!(
            message.starts_with("x.toml:") && message.contains(": expected ") && message.contains("; "),
            "{message}"
        );
    }
    // Several of one load case, and nothing that only follows from a wrong value: with the length the places are wrong.
    let of = |rail: &str| {
        let forces = "lateral_force = {}\nvertical_force = {}\n";
        let full = "[solid]\ntransient = \"full\"\n";
        let text = format!("{SHORT}{full}[scenario.s]\n{forces}speed_m_per_s = 1\nstart_x_m = 5\n");
        parse(&text.replace("\"60E1\"", &format!("\"60E1\"\n{rail}"))).unwrap_err().all().len()
    };
    assert_eq!(of(""), 2, "a solid at full order that moves, and not on the rail");
    assert_eq!(of("length_m = 900"), 1);
}

#[test]
fn a_misspelled_key_is_one_mistake() {
    let mistakes =
        parse("name = \"x\"\n[rail]\nprofiel = \"60E1\"\n[wheel]\nprofile = \"S1002\"\n").unwrap_err();
    assert_eq!(mistakes.all().len(), 1, "not missing as well: {mistakes}");
    let lines = "[[[\nname = \"x\"\nrail = = 3\n";
    let syntax = parse(lines).unwrap_err();
    assert!(syntax.all().len() > 1, "each line that is no TOML: {syntax}");
    let twice = parse(&format!("name = \"{}\"\n", "\u{1b}a".repeat(1000))).unwrap_err();
    assert_eq!(twice.all().len(), 1, "a line with a thousand of the same: {twice}");
}

/// Goal: a key that studies had before is named with what is there instead, and no other key is suggested.
#[test]
fn a_key_that_is_gone_says_what_is_there_instead() {
    let gone = message("[verification]\nratio_floor = 0.05\n");
    assert!(gone.starts_with("x.toml:7: verification.ratio_floor = 0.05: expected a key of"), "{gone}");
    assert!(
        gone.contains("the key is gone: Q/P is compared where") && gone.ends_with("; remove it"),
        "{gone}"
    );
    assert!(!gone.contains("did you mean"), "{gone}");
}

#[test]
fn unknown_standards_list_the_known_ones_and_the_nearest() {
    let wrong = |rail: &str, wheel: &str| {
        parse(&SHORT.replace("60E1", rail).replace("S1002", wheel)).unwrap_err().messages()
    };
    let [rail, wheel] = &wrong("60e1", "EN13715")[..] else { panic!() };
    assert_eq!(
        rail,
        &format!(
            "x.toml:3: rail.profile = \"60e1\": expected one of {}; did you mean \"60E1\"? `railspring profile list` describes them",
            railspring_profiles::profile::rails::RAIL_NAMES.join(", ")
        )
    );
    let light = &wrong("49e1", "S1002")[0];
    assert!(light.contains("did you mean \"49E1\"?"), "{light}");
    assert!(
        wheel.contains("one of S1002, EN13715-1in40") && wheel.contains("did you mean \"EN13715-1in40\"?"),
        "{wheel}"
    );
    let far = &wrong("kerb", "S1002")[0];
    assert!(far.contains("choose a standard") && far.contains("`rail.profile_file`"), "{far}");
}

#[test]
fn what_is_no_study_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.toml");
    let read = |content: &[u8]| {
        std::fs::write(&path, content).unwrap();
        Study::read(&path).unwrap_err().to_string()
    };
    let said = |text: &str, parts: &[&str]| {
        parts.iter().for_each(|part| assert!(text.contains(part), "{part} in {text}"))
    };
    said(&read(b"\x7fELF\x02\x01\0\0"), &["study file = a binary file: a zero byte at position 6"]);
    said(&read(b"name = \"caf\xe9\"\n"), &["a byte on line 1 that is not UTF-8"]);
    said(&read(b"\xff\xfen\0"), &["text in UTF-16", "save the study in UTF-8"]);
    let profiles = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/profiles");
    let simpack = read(&std::fs::read(profiles.join("worn-60e1.prr")).unwrap());
    said(&simpack, &["x.toml: study file = a profile file (Simpack)", "`rail.profile_file`"]);
    let miniprof = read(&std::fs::read(profiles.join("worn-s1002.whl")).unwrap());
    said(&miniprof, &["a profile file (MiniProf)"]);
    said(&read(b"y_mm,z_mm\n-1,0\n0,0\n1,0\n2,0\n3,0\n4,0\n5,0\n"), &["a profile file (CSV)"]);
    assert!(!read(b"name = \n[rail]\n").contains("profile file"), "broken TOML stays TOML");
    for (name, content) in [("rail.msh", &b"$MeshFormat\n4.1 0 8\n"[..]), ("wheel.VTU", b"<VTKFile>\0")] {
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        said(&Study::read(&path).unwrap_err().to_string(), &["a mesh file (.", "`wheel.mesh_file`"]);
    }
    std::fs::write(&path, format!("\u{feff}{SHORT}")).unwrap();
    assert!(Study::read(&path).is_ok(), "a byte-order mark is no mistake");
}

#[test]
fn messages_are_short_and_have_no_control_characters() {
    let long = "\u{1b}[2J\u{7}\u{202e}".repeat(200_000);
    let text =
        format!("{SHORT}[contact]\nenforcement = {}\n[{}]\n", serde_json::json!(long), "k".repeat(500_000));
    let text = text.replace('\u{7f}', "");
    let mistakes = parse(&text).unwrap_err();
    assert!(!mistakes.all().is_empty());
    for message in mistakes.messages() {
        assert!(message.len() < 20_000, "{} bytes", message.len());
        assert!(!message.contains(|c: char| c.is_control() || c == '\u{202e}'), "{message:?}");
    }
    let located = LocatedError {
        path: "a\u{1b}[31m.toml".into(),
        place: None,
        error: InputError::new("k\n", "v\r", "e", "r"),
    };
    assert_eq!(located.to_string(), "a\\u{1b}[31m.toml: k\\n = v\\r: expected e; r");
}

#[test]
fn long_lists_of_mistakes_are_cut() {
    let many: String = (0..3000).map(|i| format!("[unknown{i}]\n")).collect();
    let mistakes = parse(&format!("{SHORT}{many}")).unwrap_err();
    assert_eq!(mistakes.all().len(), 3000);
    let messages = mistakes.messages();
    assert_eq!((messages.len(), messages[50].as_str()), (51, "x.toml: 2950 more mistakes"));
}

#[test]
fn lines_are_found_in_one_pass() {
    let text = "a\n\nbc\r\nd";
    let lines = Lines::of(text);
    for offset in 0..text.len() {
        let counted = text.as_bytes()[..offset].iter().filter(|byte| **byte == b'\n').count() + 1;
        assert_eq!(lines.place(offset), Place::Line(counted), "{offset}");
    }
    let scenarios: String = (0..4000)
        .map(|i| {
            format!("[scenario.s{i}]\nlateral_force = {{}}\nvertical_force = {{}}\nsolid = {}\n", i == 3999)
        })
        .collect();
    let text = format!("{SHORT}{}", scenarios.replace("solid = true", "solid = 1"));
    let message = parse(&text).unwrap_err().to_string();
    assert!(message.starts_with("x.toml:16005: scenario.s3999.solid = 1"), "{message}");
    let choice =
        parse(&format!("{SHORT}[simulation]\nscenario = \"s\"\n{scenarios}")).unwrap_err().to_string();
    assert!(choice.len() < 400 && choice.contains("4000 in all"), "{choice}");
}

#[test]
fn unit_and_side_of_a_profile_file_are_keys() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.toml");
    std::fs::write(folder.path().join("head.csv"), "0,0\n").unwrap();
    let study = |more: &str| {
        let rail = format!("profile_file = \"head.csv\"\nstandard = \"60E1\"\n{more}");
        Study::parse(&path, &format!("name = \"x\"\n[rail]\n{rail}\n[wheel]\nprofile = \"S1002\"\n"))
    };
    let of = |more: &str| {
        let study = study(more).unwrap();
        let measured = study.rail.measured.as_ref().unwrap();
        (measured.unit, measured.mirrored, key(&study.statics()))
    };
    let plain = of("");
    assert_eq!((plain.0, plain.1), (None, None));
    let inch = of("profile_unit = \"in\"\nprofile_mirrored = true");
    assert_eq!((inch.0, inch.1), (Some(0.0254), Some(true)));
    assert_ne!(plain.2, inch.2);
    assert_ne!(inch.2, of("profile_unit = \"in\"\nprofile_mirrored = false").2);
    assert_ne!(inch.2, of("profile_unit = \"mm\"\nprofile_mirrored = true").2);
    assert_ne!(plain.2, of("profile_part = \"2\"").2);
    let wrong = study("profile_unit = \"ft\"").unwrap_err().to_string();
    assert!(
        wrong.contains(":5: rail.profile_unit = \"ft\": expected one of \"mm\", \"m\", \"in\""),
        "{wrong}"
    );
    // A slice is chosen where the study is read, and counts by its content.
    std::fs::write(folder.path().join("b.csv"), "1,1\n").unwrap();
    std::fs::write(folder.path().join("a.slcs"), "0 1\n2\n0 0 0\n1\n 0 'head.csv'\n 9 'b.csv'\n").unwrap();
    let slices = |more: &str| {
        let rail = format!("profile_file = \"a.slcs\"\nstandard = \"60E1\"\n{more}");
        Study::parse(&path, &format!("name = \"x\"\n[rail]\n{rail}\n[wheel]\nprofile = \"S1002\"\n"))
    };
    let slice = slices("profile_part = \"head\"").unwrap();
    let measured = slice.rail.measured.as_ref().unwrap();
    assert_eq!((&measured.path, &measured.part), (&folder.path().join("head.csv"), &None));
    assert!(measured.findings[0].text.starts_with("slice 1 of 2"), "{:?}", measured.findings);
    assert_eq!(key(&slice.statics()), plain.2);
    assert_ne!(key(&slices("profile_part = \"2\"").unwrap().statics()), plain.2);
    let open = slices("").unwrap_err().to_string();
    assert!(open.contains(":3: rail.profile_file = \"a.slcs\": expected a single profile"), "{open}");
    assert!(open.contains("2 \"b.csv\" at 9 mm") && open.contains("give `rail.profile_part`"), "{open}");
    let none = slices("profile_part = \"c\"").unwrap_err().to_string();
    assert!(
        none.contains(":5: rail.profile_part = \"c\": expected the name or the number of a slice"),
        "{none}"
    );
    let alone = SHORT.replace("\"60E1\"", "\"60E1\"\nprofile_unit = \"m\"\nprofile_mirrored = true");
    let keys: Vec<String> = parse(&alone).unwrap_err().all().iter().map(|m| m.error.key.clone()).collect();
    assert_eq!(keys, ["rail.profile_unit", "rail.profile_mirrored"], "both belong to a file");
}
