//! `railspring compare` on results of the program.
//!
//! Goal: what is said of two folders, of springs alone, and of what cannot be compared; exactly, no tolerance.

use railspring_testing::{Place, message, said};
use serde_json::Value;

const COARSE: &str = include_str!("studies/coarse.toml");

/// An empty folder for this file's tests, which have one store.
fn empty() -> Place {
    Place::new(env!("CARGO_BIN_EXE_railspring"), concat!(env!("CARGO_TARGET_TMPDIR"), "/compare"))
}

/// What a refused command says.
fn refused(place: &Place, arguments: &[&str]) -> String {
    let output = place.run(arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", message(&output));
    assert!(output.stdout.is_empty(), "{}", said(&output));
    message(&output)
}

/// Two results of one study, the second with another friction, more beam elements and the wheel elsewhere.
fn place() -> Place {
    let place = empty();
    place.write("study.toml", COARSE);
    let output = place.run(&["run", "study.toml", "-o", "a", "--quiet"]);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{}", message(&output));
    let output =
        place.run(&["calibrate", "study.toml", "-o", "b", "--quiet", "--set", "track.lateral_shift_mm=-4"]);
    assert_eq!(output.status.code(), Some(0), "{}", message(&output));
    place
}

#[test]
fn two_results_stand_side_by_side() {
    let place = place();
    // two folders
    let output = place.run(&["compare", "a", "b", "-o", "pages/ab.html"]);
    assert_eq!(output.status.code(), Some(0), "{}", message(&output));
    let text = said(&output);
    for part in [
        "A: a: ",
        "B: b: ",
        "Normal law",
        "Tangent stiffness of the solid, kN/m",
        "Horizontal stiffness, kN/m",
        "input  track.lateral_shift_mm: A 0 (default); B -4",
        "note   B has no verdict.",
        "Inputs that differ: track.lateral_shift_mm.",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert_eq!(text.lines().last(), Some("pages/ab.html"));
    let html = std::fs::read_to_string(place.path("pages/ab.html")).unwrap();
    assert!(
        html.contains("<code>track.lateral_shift_mm</code>")
            && html.contains("Tangent stiffness over load of A and B")
    );

    // the same for a program: values are those of the files
    let found: Value = serde_json::from_slice(&place.run(&["compare", "a", "b", "--json"]).stdout).unwrap();
    assert_eq!(
        (&found["command"], &found["exit_code"], &found["path"]),
        (&"compare".into(), &0.into(), &"compare.html".into())
    );
    let stiffness: Value =
        serde_json::from_slice(&std::fs::read(place.path("b/stiffness.json")).unwrap()).unwrap();
    let groups = found["more"]["groups"].as_array().unwrap();
    let horizontal = groups.iter().find(|group| group["name"] == "Horizontal stiffness").unwrap();
    assert_eq!(horizontal["rows"][0]["b"], stiffness["horizontal_kn_per_m"]);

    // springs alone, and a result beside itself
    let output = place.run(&["compare", "a/stiffness.json", "a"]);
    assert!(
        said(&output).contains("A has no verdict.")
            && said(&output).contains("No input that is known differs."),
        "{}",
        said(&output)
    );

    // what cannot be compared
    let missing = refused(&place, &["compare", "a", "nowhere"]);
    assert!(
        missing.contains("nowhere = (does not exist)") && missing.contains("an output folder"),
        "{missing}"
    );
    std::fs::create_dir(place.path("empty")).unwrap();
    let empty = refused(&place, &["compare", "empty", "a"]);
    assert!(empty.contains("empty/stiffness.json") && empty.contains("railspring calibrate"), "{empty}");
    let page = refused(&place, &["compare", "a", "b", "-o", "pages"]);
    assert!(page.contains("-o = pages") && page.contains("name a file"), "{page}");
    let curve = std::fs::read_to_string(place.path("b/load_curve.csv")).unwrap();
    std::fs::write(place.path("b/load_curve.csv"), curve.replacen("beam", "foot", 1)).unwrap();
    let edited = refused(&place, &["compare", "a", "b"]);
    assert!(
        edited.contains("b/load_curve.csv = another content") && edited.contains("as it was written"),
        "{edited}"
    );
    let json = place.run(&["compare", "a", "b", "--json"]);
    let errors: Value = serde_json::from_slice(&json.stdout).unwrap();
    assert!(
        errors["errors"][0].as_str().unwrap().contains("another content") && errors["exit_code"] == 2,
        "{errors}"
    );
}

/// Goal: `--pdf` without a browser says so before anything is done; with a command that has no page it is refused.
#[test]
fn a_pdf_needs_a_browser_and_a_page() {
    let place = empty();
    place.write("study.toml", COARSE);
    let run = |arguments: &[&str]| place.command(arguments).env("PATH", place.root()).output().unwrap();
    let missing = run(&["run", "study.toml", "--pdf"]);
    assert_eq!(missing.status.code(), Some(2));
    let said = message(&missing);
    assert!(said.contains("--pdf = none of chromium") && said.contains("apt install chromium"), "{said}");
    // something that has the name of a browser, and is not asked
    std::fs::write(place.path("chromium"), "").unwrap();
    let wrong = run(&["calibrate", "study.toml", "--pdf"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(message(&wrong).contains("`compare`, which write a page"), "{}", message(&wrong));
    assert!(!place.path("out").exists());
}
