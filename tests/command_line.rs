//! The program from outside: what it says about wrong input, where, with
//! which exit code, and that it leaves nothing behind.

use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::Command;
use nalgebra::Point2;
use railspring_profiles::profile::wheels::wheel_profile;
use railspring_profiles::section::rail_section;

const GOOD: &str = "name = \"x\"\n[rail]\nprofile = \"60E1\"\n[wheel]\nprofile = \"S1002\"\n";

/// A folder with a study, removed at the end.
struct Place {
    root: tempfile::TempDir,
    /// Beside the folder, so that what is left in that can be counted.
    cache: tempfile::TempDir,
}

impl Place {
    fn with_study(text: &str) -> Self {
        let root = tempfile::tempdir().unwrap();
        std::fs::write(root.path().join("study.toml"), text).unwrap();
        Self { root, cache: tempfile::tempdir().unwrap() }
    }

    fn out(&self) -> PathBuf {
        self.root.path().join("deep/out")
    }

    fn run(&self, arguments: &[&str]) -> Output {
        Command::cargo_bin("railspring")
            .unwrap()
            .current_dir(self.root.path())
            .env("RAILSPRING_CACHE", self.cache.path())
            .args(arguments)
            .output()
            .unwrap()
    }
}

fn message(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Runs `command` on a study and expects one line of error that has all `parts`, and no output folder.
fn refused(command: &str, study: &str, parts: &[&str]) {
    let place = Place::with_study(study);
    let out = place.out();
    let output = place.run(&[command, "study.toml", "--quiet", "-o", out.to_str().unwrap()]);
    let text = message(&output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert_eq!(text.trim_end().lines().count(), 1, "one message: {text}");
    for part in parts {
        assert!(text.contains(part), "{part:?} in {text}");
    }
    assert!(output.stdout.is_empty());
    assert!(!place.root.path().join("deep").exists(), "nothing is left behind");
}

#[test]
fn a_missing_key() {
    let study = GOOD.replace("profile = \"60E1\"\n", "");
    refused("run", &study, &["study.toml:2: rail.profile = (missing)", "add this key to [rail]"]);
}

#[test]
fn a_wrong_unit() {
    let study = format!("{GOOD}[track]\ngauge_m = 1.435\n");
    refused("run", &study, &["study.toml:7: track.gauge_m = 1.435", "did you mean `track.gauge_mm`?"]);
    let value = format!("{GOOD}[track]\ngauge_mm = 1.435\n");
    refused("run", &value, &["study.toml:7: track.gauge_mm = 1.435", "expected a number from 500 to 2000"]);
}

#[test]
fn unknown_profiles() {
    refused("run", &GOOD.replace("60E1", "61E1"), &["study.toml:3: rail.profile = ", "61E1"]);
    refused("run", &GOOD.replace("S1002", "S1003"), &["study.toml:5: wheel.profile = ", "S1003"]);
}

/// Every mistake has its line; one message each, in the order of the file, and nothing is left behind.
#[test]
fn all_mistakes_at_once() {
    let exchanged = GOOD.replace("60E1", "?").replace("S1002", "60E1").replace('?', "S1002");
    let place = Place::with_study(&format!("{exchanged}[track]\ngauge_m = 1.4\n"));
    let output = place.run(&["run", "study.toml"]);
    assert_eq!(output.status.code(), Some(2));
    let text = message(&output);
    let lines: Vec<&str> = text.lines().collect();
    let starts = [
        "study.toml:3: rail.profile = \"S1002\"",
        "study.toml:5: wheel.profile = \"60E1\"",
        "study.toml:7: track.gauge_m = 1.4",
    ];
    assert_eq!(lines.len(), 3, "{text}");
    for (line, start) in lines.iter().zip(starts) {
        assert!(line.strip_prefix("error: ").is_some_and(|line| line.starts_with(start)), "{line}");
    }
    assert_eq!(std::fs::read_dir(place.root.path()).unwrap().count(), 1);
}

#[test]
fn a_wheel_that_misses_the_rail() {
    let study = format!("{GOOD}[track]\nlateral_shift_mm = -100\n");
    for command in ["run", "calibrate", "mesh"] {
        refused(command, &study, &["study.toml:7: track.lateral_shift_mm = "]);
    }
}

/// The wheel touches, but where no mesh is fine enough for a contact: the shift is to blame and not the load.
#[test]
fn a_shift_beyond_the_contact_zone_speaks_of_the_shift() {
    for shift in ["60", "40", "20", "-60"] {
        let study = format!("{GOOD}[track]\nlateral_shift_mm = {shift}\n");
        let start = format!("study.toml:7: track.lateral_shift_mm = {shift} mm, at which the ");
        refused(
            "calibrate",
            &study,
            &[&start, "in the contact zone of the mesh", "`track.lateral_shift_mm`"],
        );
    }
}

/// A step in which the wheel swings several times on its contact gives no history.
#[test]
fn a_time_step_that_resolves_nothing() {
    let study =
        format!("{GOOD}[scenario.s]\nlateral_force = {{}}\nvertical_force = {{}}\ntime_step_s = 0.1\n");
    refused(
        "run",
        &study,
        &["study.toml:9: scenario.s.time_step_s = 0.1: expected a number from", "to 0.01; "],
    );
}

/// What is no file of its own neither hangs nor fills the memory.
#[cfg(unix)]
#[test]
fn devices_pipes_and_folders_are_refused() {
    let place = Place::with_study(GOOD);
    let made = std::process::Command::new("mkfifo").arg(place.root.path().join("pipe")).status();
    assert!(made.unwrap().success());
    std::fs::create_dir(place.root.path().join("folder")).unwrap();
    for (input, said) in [
        ("/dev/zero", "a device, a pipe or a socket"),
        ("pipe", "a device, a pipe or a socket"),
        ("folder", "it is a folder"),
    ] {
        for study in [
            GOOD.replace("profile = \"60E1\"", &format!("profile_file = \"{input}\"\nstandard = \"60E1\"")),
            GOOD.replace(
                "profile = \"60E1\"",
                &format!(
                    "profile = \"60E1\"\nmesh_file = \"{input}\"\ncontact_surface = \"a\"\nheld_nodes = \"b\""
                ),
            ),
        ] {
            std::fs::write(place.root.path().join("study.toml"), study).unwrap();
            let output = place.run(&["run", "study.toml"]);
            assert_eq!(output.status.code(), Some(2));
            assert!(message(&output).contains(said), "{input}: {}", message(&output));
        }
        std::fs::write(place.root.path().join("study.toml"), GOOD).unwrap();
        for arguments in [
            &["run", input][..],
            &["profile", "check", input],
            &["simulate", "study.toml", "-o", "o", "--law", input],
        ] {
            let output = place.run(arguments);
            assert_eq!(output.status.code(), Some(2), "{arguments:?}");
            assert!(message(&output).contains(said), "{arguments:?}: {}", message(&output));
        }
    }
}

/// Points of a profile as columns, mm.
fn columns(points: impl Iterator<Item = (f64, f64)>) -> String {
    let mut text = String::from("y_mm,z_mm\n");
    points.for_each(|(y, z)| text.push_str(&format!("{:.6},{:.6}\n", 1e3 * y, 1e3 * z)));
    text
}

/// A head measured as it lies in the track, canted by 1:20 or 1:40, is not in the frame of its section: it is placed there and laid as it was, which is said;
/// `profile_aligned = false` takes it as it stands.
#[test]
fn a_canted_head_is_turned_and_laid_as_it_was() {
    let head = rail_section("60E1").unwrap().running.sample(0.5e-3);
    for cant in [0.05_f64, 0.025] {
        let (sin, cos) = cant.atan().sin_cos();
        // the top leans towards the track centre
        let canted = head.iter().map(|p| (cos * p.x + sin * p.y, -sin * p.x + cos * p.y));
        let study = GOOD.replace("profile = \"60E1\"", "profile_file = \"head.csv\"\nstandard = \"60E1\"");
        let place = Place::with_study(&study);
        std::fs::write(place.root.path().join("head.csv"), columns(canted)).unwrap();
        let placed = place.run(&["mesh", "study.toml", "-o", "o"]);
        assert_eq!(placed.status.code(), Some(0), "{cant}: {}", message(&placed));
        let ratio = format!("1:{:.0},", 1.0 / cant);
        for part in ["which lies off 60E1", ratio.as_str(), "`rail.profile_aligned` = false"] {
            assert!(message(&placed).contains(part), "{part} in {}", message(&placed));
        }
        let kept = study.replace("standard =", "profile_aligned = false\nstandard =");
        std::fs::write(place.root.path().join("study.toml"), kept).unwrap();
        let kept = place.run(&["mesh", "study.toml", "-o", "o"]);
        assert_eq!(kept.status.code(), Some(0), "{}", message(&kept));
        assert!(message(&kept).contains("taken as it stands, as requested"), "{}", message(&kept));
    }
}

/// Left profiles given as right ones: a wheel is refused, a worn head is said; `profile_mirrored` turns both over.
#[test]
fn left_profiles_are_named() {
    let place = Place::with_study(GOOD);
    let write = |name: &str, text: String| std::fs::write(place.root.path().join(name), text).unwrap();
    let wheel = wheel_profile("S1002").unwrap().sample(0.5e-3);
    let header =
        "header.begin\nversion = 1\ntype = 0\nheader.end\nspline.begin\nunits.len.f = 1000.0\npoint.begin\n";
    let rows: String = wheel.iter().map(|p| format!("{:.6} {:.6}\n", -1e3 * p.x, 1e3 * p.y)).collect();
    write("left.prw", format!("{header}{rows}point.end\nspline.end\n"));
    let study = GOOD.replace("profile = \"S1002\"", "profile_file = \"left.prw\"\nstandard = \"S1002\"");
    write("study.toml", study.clone());
    let refused = place.run(&["mesh", "study.toml", "-o", "o"]);
    assert_eq!(refused.status.code(), Some(2), "{}", message(&refused));
    for part in ["wheel.profile_file = ", "flange at the field side", "set `wheel.profile_mirrored` = true"] {
        assert!(message(&refused).contains(part), "{part} in {}", message(&refused));
    }
    for key in ["profile_mirrored = true", "profile_aligned = true"] {
        write("study.toml", study.replace("standard =", &format!("{key}\nstandard =")));
        let taken = place.run(&["mesh", "study.toml", "-o", "o"]);
        assert_eq!(taken.status.code(), Some(0), "{key}: {}", message(&taken));
    }

    // A head whose corner at y > 0, of a right rail the field side, is worn by up to 1 mm.
    let worn = |p: &Point2<f64>| (p.x, p.y + 1e-3 * ((p.x - 0.015) / 0.015).clamp(0.0, 1.0));
    let head = rail_section("60E1").unwrap().running.sample(0.5e-3);
    let upper = head.iter().filter(|p| p.x.abs() < 0.0355);
    write("head.csv", columns(upper.map(worn)));
    let study = GOOD.replace("profile = \"60E1\"", "profile_file = \"head.csv\"\nstandard = \"60E1\"");
    write("study.toml", study.clone());
    let refused = place.run(&["mesh", "study.toml", "-o", "o"]);
    assert_eq!(refused.status.code(), Some(2), "{}", message(&refused));
    let parts = [
        "rail.profile_file = ",
        "worn deeper at the field side",
        "`rail.profile_mirrored`",
        "`rail.profile_aligned`",
    ];
    for part in parts {
        assert!(message(&refused).contains(part), "{part} in {}", message(&refused));
    }
    for (key, turned) in [
        ("profile_mirrored = false", false),
        ("profile_mirrored = true", false),
        ("profile_aligned = true", true),
    ] {
        write("study.toml", study.replace("standard =", &format!("{key}\nstandard =")));
        let output = place.run(&["mesh", "study.toml", "-o", "o"]);
        assert_eq!(output.status.code(), Some(0), "{key}: {}", message(&output));
        assert_eq!(
            message(&output).contains("that of the gauge, turned over"),
            turned,
            "{key}: {}",
            message(&output)
        );
    }
}

/// Files that are not what the study says are refused with what they are: the other body, another place, another size.
/// What evidently lies elsewhere is placed, with `profile_aligned` or without, and it is said by how much.
#[test]
fn misplaced_profiles_are_named() {
    let place = Place::with_study(GOOD);
    let write = |name: &str, text: String| std::fs::write(place.root.path().join(name), text).unwrap();
    let wheel = wheel_profile("S1002").unwrap().sample(0.25e-3);
    let rail = rail_section("60E1").unwrap().running.sample(0.25e-3);
    let (sin, cos) = 2f64.to_radians().sin_cos();
    let elsewhere = wheel.iter().map(|p| (cos * p.x - sin * p.y + 0.013, sin * p.x + cos * p.y - 0.2));
    write("moved.csv", columns(elsewhere));
    write("wheel.csv", columns(wheel.iter().map(|p| (p.x, p.y))));
    write("rail.csv", columns(rail.iter().map(|p| (p.x, p.y))));
    // A file in centimetres that is taken for one in inches.
    write("large.csv", columns(wheel.iter().map(|p| (2.54 * p.x, 2.54 * p.y))));
    let with = |body: &str, file: &str, more: &str| {
        let standard = if body == "rail" { "60E1" } else { "S1002" };
        let (old, new) = (
            format!("profile = \"{standard}\""),
            format!("profile_file = \"{file}\"\nstandard = \"{standard}\"\n{more}"),
        );
        write("study.toml", GOOD.replace(&old, &new));
        place.run(&["mesh", "study.toml", "-o", "o"])
    };
    for (body, file, parts) in [
        ("rail", "wheel.csv", &["the shape of a wheel", "the file is that of the other body"][..]),
        ("wheel", "rail.csv", &["the shape of a rail", "the file is that of the other body"]),
        ("wheel", "large.csv", &["no known standard", "its unit"]),
    ] {
        let refused = with(body, file, "");
        assert_eq!(refused.status.code(), Some(2), "{file}: {}", message(&refused));
        let key = format!("{body}.profile_file = ");
        for part in parts.iter().chain(&[key.as_str()]) {
            assert!(message(&refused).contains(part), "{part} in {}", message(&refused));
        }
    }
    for key in ["", "profile_aligned = true"] {
        let placed = with("wheel", "moved.csv", key);
        assert_eq!(placed.status.code(), Some(0), "{}", message(&placed));
        for part in ["turned by -2.00", "uncertain by", "onto S1002"] {
            assert!(message(&placed).contains(part), "{part} in {}", message(&placed));
        }
    }
    let still = with("wheel", "rail.csv", "profile_aligned = true");
    assert_eq!(still.status.code(), Some(2), "{}", message(&still));
}

/// What was done to a measured profile is said in the terminal, unless it is to be quiet.
#[test]
fn repairs_are_said() {
    let head = rail_section("60E1").unwrap().running.sample(0.5e-3);
    let middle = head.len() / 2;
    let spiked = head.iter().enumerate().map(|(i, p)| (p.x, if i == middle { p.y - 2e-3 } else { p.y }));
    let place = Place::with_study(
        &GOOD.replace("profile = \"60E1\"", "profile_file = \"head.csv\"\nstandard = \"60E1\""),
    );
    std::fs::write(place.root.path().join("head.csv"), columns(spiked)).unwrap();
    let output = place.run(&["mesh", "study.toml", "-o", "o"]);
    assert_eq!(output.status.code(), Some(0), "{}", message(&output));
    assert!(
        message(&output).lines().any(|line| line.starts_with(&format!("head.csv:{}: spike", middle + 2))
            && line.contains("(repaired)")),
        "{}",
        message(&output)
    );
    let quiet = place.run(&["mesh", "study.toml", "-o", "o", "--quiet"]);
    assert_eq!(message(&quiet), "");
    // A study that is given as a profile is named, too.
    let study = place.run(&["profile", "check", "study.toml"]);
    assert!(
        message(&study).starts_with("error: study.toml:2:1 = \"[rail]\": expected the rows of a profile"),
        "{}",
        message(&study)
    );
    assert!(message(&study).contains("this is a TOML file such as a study"));
}

#[test]
#[ignore = "a quarter of a minute: cargo long command_line"]
fn a_load_that_cannot_be_carried() {
    let long = format!("{GOOD}[calibration]\nload_max_kn = 400\n[mesh]\nwindow_half_length_mm = 6\n");
    refused("run", &long, &["study.toml:7: calibration.load_max_kn = 400.0 kN", "lower the load"]);
    // Found by the contact solver, after some loads: the bodies conform, and the patch grows over the window. The laws end before, which is
    // no success.
    let wide = format!(
        "{GOOD}[calibration]\nload_max_kn = 1000\n[mesh]\nwindow_half_length_mm = 12\ncontact_element_mm = 6\n\
         contact_element_along_mm = 6\nelement = \"full-integration\"\n"
    );
    let place = Place::with_study(&wide);
    let output = place.run(&["calibrate", "study.toml"]);
    let said = message(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    for part in ["the laws end at ", " kN instead of 1000 kN", "the end of the contact window"] {
        assert!(said.contains(part), "{part:?} in {said}");
    }
}

#[test]
fn a_study_that_is_not_there() {
    let place = Place::with_study(GOOD);
    let output = place.run(&["run", "other.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(message(&output).starts_with("error: other.toml: study file = "), "{}", message(&output));
    assert!(!place.root.path().join("out").exists());
}

#[test]
fn a_folder_that_cannot_be_written() {
    // A path below a regular file cannot be written by anybody, the superuser included.
    let place = Place::with_study(GOOD);
    let output = place.run(&["run", "study.toml", "-o", "study.toml/out"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(message(&output).starts_with("error: output folder = study.toml/out"), "{}", message(&output));
    assert_eq!(std::fs::read_to_string(place.root.path().join("study.toml")).unwrap(), GOOD);
}

#[test]
fn unknown_commands_and_missing_arguments() {
    let place = Place::with_study(GOOD);
    for arguments in [
        &["calibrat", "study.toml"][..],
        &["fit", "S1002"],
        &["run"],
        &[],
        &["run", "study.toml", "--threads", "0"],
    ] {
        let output = place.run(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(
            message(&output).contains("Usage") || message(&output).contains("--help"),
            "{}",
            message(&output)
        );
    }
    assert_eq!(std::fs::read_dir(place.root.path()).unwrap().count(), 1, "only the study");
}

#[test]
fn later_stages_need_the_earlier_ones() {
    let place = Place::with_study(GOOD);
    std::fs::create_dir(place.root.path().join("empty")).unwrap();
    for command in ["simulate", "verify", "report"] {
        let absent = place.run(&[command, "study.toml", "-o", "nowhere"]);
        assert_eq!(absent.status.code(), Some(2));
        assert!(
            message(&absent).contains("run `railspring calibrate` with -o nowhere first"),
            "{}",
            message(&absent)
        );
        let empty = place.run(&[command, "study.toml", "-o", "empty"]);
        assert_eq!(empty.status.code(), Some(2));
        assert!(message(&empty).contains("empty/stiffness.json"), "{}", message(&empty));
        assert!(message(&empty).contains("run `railspring calibrate`"), "{}", message(&empty));
    }
    let output = place.run(&["simulate", "study.toml", "--law", "study.toml", "-o", "new"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(message(&output).contains("error: study.toml = "), "{}", message(&output));
    assert!(!place.root.path().join("new").exists());
}

/// Goal: published springs with a horizontal stiffness run in an empty folder and say what they go without; the later stages still ask for the calibration.
#[test]
fn published_springs_simulate_without_a_calibration() {
    let case = "[scenario.s]\nsteps = 10\nvertical_force = { mean_kn = 50 }\nlateral_force = {}\n";
    let springs = "[simulation]\nlaw = \"published\"\nhorizontal_kn_per_m = 4e5\n";
    let place = Place::with_study(&format!("{GOOD}{springs}{case}"));
    let simulated = place.run(&["simulate", "study.toml", "-o", "o"]);
    assert_eq!(simulated.status.code(), Some(0), "{}", message(&simulated));
    let said = String::from_utf8_lossy(&simulated.stdout);
    assert!(said.contains("nothing is calibrated"), "{said}");
    let history = std::fs::read_to_string(place.root.path().join("o/history.csv")).unwrap();
    assert_eq!(history.lines().count(), 1 + 11);
    let verified = place.run(&["verify", "study.toml", "-o", "o"]);
    assert_eq!(verified.status.code(), Some(2));
    assert!(message(&verified).contains("run `railspring calibrate`"), "{}", message(&verified));
}

#[test]
fn the_schema_is_json_and_accepts_the_shipped_keys() {
    let place = Place::with_study(GOOD);
    let output = place.run(&["schema"]);
    assert_eq!(output.status.code(), Some(0));
    let schema: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for section in ["rail", "wheel", "track", "mesh", "contact", "calibration", "simulation", "verification"]
    {
        assert!(schema["properties"][section].is_object(), "{section}");
    }
}

#[test]
fn help_and_version_need_no_study() {
    let place = Place::with_study(GOOD);
    let help = place.run(&["--help"]);
    assert_eq!(help.status.code(), Some(0));
    let text = String::from_utf8(help.stdout).unwrap();
    for word in ["run", "calibrate", "simulate", "verify", "mesh", "report", "schema", "Exit codes"] {
        assert!(text.contains(word), "{word}");
    }
    assert_eq!(place.run(&["--version"]).status.code(), Some(0));
}

#[test]
fn the_shipped_studies_are_readable() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/studies");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            // A folder that cannot be written stops the program right after the study was accepted.
            let below_a_file = path.join("out");
            let place = Place::with_study(GOOD);
            let output = place.run(&["run", path.to_str().unwrap(), "-o", below_a_file.to_str().unwrap()]);
            assert!(message(&output).starts_with("error: output folder = "), "{}", message(&output));
        }
    }
}

/// Checking and converting a profile: findings on standard output, exit code 1 where something is left.
#[test]
fn profiles_are_checked_and_converted() {
    let worn = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/profiles/worn-s1002.whl");
    let worn = worn.to_str().unwrap();
    let place = Place::with_study(GOOD);
    let checked = place.run(&["profile", "check", worn, "--smooth-mm", "3"]);
    let text = String::from_utf8(checked.stdout).unwrap();
    assert_eq!(checked.status.code(), Some(0), "{text}");
    assert!(text.contains("MiniProf, wheel, 589 points") && text.contains("smoothed"), "{text}");

    let converted = place.run(&["profile", "convert", worn, "wheel.prw", "--raw"]);
    assert_eq!(converted.status.code(), Some(0), "{}", message(&converted));
    let again = place.run(&["profile", "check", "wheel.prw"]);
    assert!(String::from_utf8(again.stdout).unwrap().contains("Simpack, wheel, 589 points"));

    let ending = place.run(&["profile", "convert", worn, "wheel.prr"]);
    assert_eq!(ending.status.code(), Some(2));
    assert!(message(&ending).contains("wheel.prr = the extension of a rail"), "{}", message(&ending));

    std::fs::write(place.root.path().join("bad.csv"), "y_mm,z_mm\n1,2\n1,x\n").unwrap();
    let bad = place.run(&["profile", "check", "bad.csv"]);
    assert_eq!(bad.status.code(), Some(2));
    assert!(message(&bad).starts_with("error: bad.csv:3:3 = \"x\""), "{}", message(&bad));
}
