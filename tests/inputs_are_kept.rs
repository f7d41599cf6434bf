//! No command writes, replaces or removes what it reads, under whatever name; a folder keeps what a user has put there.
//!
//! Goal: exit code 2, a message with both names, and the same bytes afterwards. No tolerance.

use railspring_testing::{Place, message, said};

const COARSE: &str = include_str!("studies/coarse.toml");
const RAIL: &str = include_str!("../data/profiles/worn-60e1.prr");
const WHEEL: &str = include_str!("../data/profiles/worn-s1002.whl");

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
