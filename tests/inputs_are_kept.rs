//! No command writes, replaces or removes what it reads, under whatever name; a folder keeps what a user has put there.
//!
//! Goal: exit code 2, a message with both names, and the same bytes afterwards. No tolerance.

use railspring_testing::{Place, message, said};

const COARSE: &str = include_str!("studies/coarse.toml");
const RAIL: &str = include_str!("../data/profiles/worn-60e1.prr");
const WHEEL: &str = include_str!("../data/profiles/worn-s1002.whl");
const BRIDGE: &str = include_str!("../data/studies/vbi-2d.toml");
/// Keys that make a pair coarse, as `COARSE`.
const COARSELY: [&str; 12] = [
    "--set",
    "mesh.contact_element_mm=6",
    "--set",
    "mesh.contact_element_along_mm=6",
    "--set",
    "calibration.load_count=4",
    "--set",
    "calibration.load_min_kn=5",
    "--set",
    "calibration.shifts_mm=[]",
    "--set",
    "calibration.error_band=false",
];

/// A folder with a study and two profiles; its tests have one store.
fn place() -> Place {
    let place =
        Place::new(env!("CARGO_BIN_EXE_railspring"), concat!(env!("CARGO_TARGET_TMPDIR"), "/everyday"));
    place.write("coarse.toml", COARSE);
    place.write("r.prr", RAIL);
    place.write("w.whl", WHEEL);
    place
}

/// Runs a command that has to be refused because its output `output` is its input `input`, which stays as it is.
fn refused(place: &Place, arguments: &[&str], input: &str, output: &str) {
    let before = place.read(input);
    let answer = place.run(arguments);
    let said = message(&answer);
    assert_eq!(answer.status.code(), Some(2), "{arguments:?}: {said}");
    assert!(said.contains(&format!("the same file as the input {input}")), "{arguments:?}: {said}");
    assert!(said.contains(output), "{arguments:?}: {said}");
    assert_eq!(place.read(input), before, "{arguments:?}");
}

/// Source: the commands on profiles. Goal: each refuses its own input as output, also through a link, a folder above, and a second name.
#[cfg(unix)]
#[test]
fn profile_commands_keep_their_input() {
    let place = place();
    let root = place.root();
    std::os::unix::fs::symlink("r.prr", root.join("link.prr")).unwrap();
    std::fs::create_dir(root.join("inner")).unwrap();
    std::fs::hard_link(root.join("r.prr"), root.join("twin.prr")).unwrap();
    for output in ["r.prr", "link.prr", "inner/../r.prr", "twin.prr", "./r.prr"] {
        refused(&place, &["profile", "convert", "r.prr", output], "r.prr", output);
        refused(&place, &["profile", "plot", "60E1", "r.prr", "-o", output], "r.prr", output);
        refused(&place, &["profile", "check", "r.prr", "--figure", output], "r.prr", output);
    }
    refused(
        &place,
        &["profile", "check", "r.prr", "--section", "--kind", "rail", "--figure", "r.prr"],
        "r.prr",
        "r.prr",
    );
    place.write("a-placed.csv", &place.read("r.prr"));
    place.write("c.csv", &place.read("r.prr"));
    std::os::unix::fs::symlink("c.csv", root.join("c-placed.csv")).unwrap();
    refused(&place, &["profile", "place", "c.csv", "--kind", "rail"], "c.csv", "c-placed.csv");
    refused(&place, &["profile", "contact", "S1002", "c.csv", "-o", "c"], "c.csv", "c.csv");
    // another name is written
    assert_eq!(place.run(&["profile", "convert", "r.prr", "new.prr"]).status.code(), Some(0));
}

/// Goal: a study's files are kept where they lie in the output folder under a name that the command writes, and are refused before any work;
/// where they lie there under another name, the command runs. A text of any key that is the path of a file counts.
#[test]
fn study_commands_keep_their_input() {
    let place = place();
    std::fs::create_dir_all(place.root().join("out/figures")).unwrap();
    let profile = "profile_file = \"out/load_curve.csv\"\nstandard = \"60E1\"";
    place.write("measured.toml", &COARSE.replace("profile = \"60E1\"", profile));
    let converted = place.run(&["profile", "convert", "r.prr", "out/load_curve.csv"]);
    assert_eq!(converted.status.code(), Some(0), "{}", message(&converted));
    refused(&place, &["run", "measured.toml", "-o", "out"], "out/load_curve.csv", "out/load_curve.csv");
    // another study would replace it, too
    std::fs::remove_file(place.path("out/load_curve.csv")).unwrap();
    for name in ["stiffness.json", "contact.vtu", "figures/law.svg", "notes.json"] {
        let file = format!("out/{name}");
        place.write(&file, RAIL);
        place.write("s.toml", &format!("description = \"{file}\"\n{COARSE}"));
        if name == "notes.json" {
            let answer = place.run(&["calibrate", "s.toml", "-o", "out", "-q"]);
            assert_eq!(answer.status.code(), Some(0), "{}", message(&answer));
        } else {
            refused(&place, &["run", "s.toml", "-o", "out"], &file, &file);
        }
        assert_eq!(place.read(&file), RAIL);
        std::fs::remove_file(place.path(&file)).unwrap();
    }
    refused(&place, &["element", "coarse.toml", "-o", "coarse.toml"], "coarse.toml", "coarse.toml");
    refused(&place, &["element", "coarse.toml", "--fmu", "coarse.toml"], "coarse.toml", "coarse.toml");
    place.write(
        "t.toml",
        "name = \"t\"\nbase = \"table.json\"\nstiffness_at_kn = [20]\n[[wheel]]\nprofile = \"S1002\"\n[[rail]]\nprofile = \"60E1\"\n",
    );
    place.write("table.json", COARSE);
    refused(&place, &["table", "t.toml", "-o", "."], "table.json", "table.json");
}

/// Goal: what a user has put into an output folder stays when results change, also under the name of a page; an export and a comparison
/// keep what they read.
#[test]
fn a_folder_keeps_what_is_not_of_the_program() {
    let place = place();
    let calibrate = |more: &[&str]| {
        let answer = place.run(&[&["calibrate", "coarse.toml", "-o", "out", "-q"], more].concat());
        assert_eq!(answer.status.code(), Some(0), "{}", message(&answer));
    };
    std::fs::create_dir(place.root().join("out")).unwrap();
    let own = ["report.pdf", "report.html", "figures/own.svg", "notes.txt"];
    std::fs::create_dir(place.root().join("out/figures")).unwrap();
    own.iter().for_each(|name| place.write(&format!("out/{name}"), "a user's"));
    calibrate(&[]);
    calibrate(&["--set", "contact.friction=0.4"]);
    for name in own {
        assert_eq!(place.read(&format!("out/{name}")), "a user's", "{name}");
    }
    let springs = "out/stiffness.json";
    refused(&place, &["export", springs, "--to", "json", "-o", springs], springs, springs);
    refused(&place, &["compare", springs, springs, "-o", springs], springs, springs);
    refused(
        &place,
        &["compare", "out", "out", "-o", "out/load_curve.csv"],
        "out/load_curve.csv",
        "out/load_curve.csv",
    );
    // the lists of rows: a user's one is not replaced
    assert!(said(&place.run(&["export", springs, "--to", "json", "-o", "x"])).contains("x/"));
}

/// Runs a command that has to be refused before any work because `file` in its output folder is a user's; all files of the folder stay as they are.
fn kept(place: &Place, arguments: &[&str], file: &str) {
    let before = place.read(file);
    let answer = place.run(arguments);
    let said = message(&answer);
    assert_eq!(answer.status.code(), Some(2), "{arguments:?}: {said}");
    assert!(said.contains("a file that this program has not written") && said.contains(file), "{said}");
    assert_eq!(place.read(file), before, "{arguments:?}");
}

/// Source: a file that a user has put into an output folder under the name of a result. Goal: no command replaces it or writes anything beside it. A study that was edited
/// after `fit` wrote it is the user's; the untouched one is written again.
#[test]
fn no_command_replaces_what_a_user_has_put_into_its_folder() {
    let place = place();
    let alone = |arguments: &[&str], name: &str| {
        let out = place.path("out");
        std::fs::create_dir_all(out.join("figures")).unwrap();
        place.write(&format!("out/{name}"), "a user's");
        kept(&place, &[arguments, &["-o", "out"]].concat(), &format!("out/{name}"));
        let left = std::fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name());
        let left: Vec<_> = left.filter(|entry| entry != "figures").collect();
        assert_eq!(left, [name], "{arguments:?}");
        std::fs::remove_dir_all(&out).unwrap();
    };
    for (command, name) in [
        ("run", "report.html"),
        ("run", "results.json"),
        ("calibrate", "stiffness.json"),
        ("calibrate", "measured.json"),
        ("mesh", "rail.vtu"),
        ("crosscheck", "crosscheck.html"),
    ] {
        alone(&[command, "coarse.toml"], name);
    }
    alone(&["fit", "S1002", "60E1"], "study.toml");
    alone(&["fit", "S1002", "60E1"], "report.html");
    let pair = "[[wheel]]\nprofile = \"S1002\"\n[[rail]]\nprofile = \"60E1\"\n";
    place.write("t.toml", &format!("name = \"t\"\nbase = \"coarse.toml\"\nstiffness_at_kn = [20]\n{pair}"));
    for name in ["table.csv", "table.json", "table.html", "table.parquet"] {
        alone(&["table", "t.toml"], name);
    }
    place.write("bridge.toml", BRIDGE);
    for name in ["history.csv", "track.json", "report.html"] {
        alone(&["run", "bridge.toml"], name);
    }
    for _ in 0..2 {
        let answer = place.run(&["run", "bridge.toml", "-o", "out"]);
        assert_eq!(answer.status.code(), Some(0), "{}", message(&answer));
    }
}

/// Source: the study that `fit` leaves in its folder. Goal: as it was written it is written again; with an own key in it, it is the user's and stays.
#[test]
fn a_study_that_was_edited_is_the_users() {
    let place = place();
    let fit =
        |more: &[&str]| place.run(&[&["fit", "S1002", "60E1", "-o", "out"], &COARSELY[..], more].concat());
    for more in [&[][..], &["--set", "contact.friction=0.4"]] {
        let answer = fit(more);
        assert!(matches!(answer.status.code(), Some(0 | 1)), "{}", message(&answer));
    }
    let written = place.read("out/study.toml");
    assert!(written.contains("friction = 0.4"), "{written}");
    place.write("out/study.toml", &format!("{written}\n[review]\nauthor = \"me\"\n"));
    let arguments = [&["fit", "S1002", "60E1", "-o", "out"], &COARSELY[..]].concat();
    kept(&place, &arguments, "out/study.toml");
}
