//! Holes of measured profiles count: in the verdict, in the exit code and in the error band.
//!
//! Goal: springs of a profile with a hole end with exit code 1, without a band, and with the hole named, in a study and in the rows of a table; those of
//! the whole profile hold.

use railspring_testing::{Place, message, said};
use serde_json::Value;

const COARSE: &str = include_str!("studies/coarse.toml");
const RAIL: &str = include_str!("../data/profiles/worn-60e1.prr");

/// Source: `data/profiles/worn-60e1.prr`, whole and without its points from -5 to 5 mm. Goal: as the head says; the hole is 10 mm long within the
/// distance of two points, 0.5 mm.
#[test]
fn a_hole_enters_verdict_exit_code_and_band() {
    let place =
        Place::new(env!("CARGO_BIN_EXE_railspring"), concat!(env!("CARGO_TARGET_TMPDIR"), "/everyday"));
    write_rails(&place);
    for name in ["holed", "whole"] {
        let keys = format!("profile_file = \"{name}.prr\"\nstandard = \"60E1\"");
        let study = COARSE.replace("profile = \"60E1\"", &keys).replace("error_band = false", "");
        place.write("s.toml", &study);
        let answer = place.run(&["calibrate", "s.toml", "-o", name]);
        let (text, code) = (said(&answer), answer.status.code());
        let record: Value = serde_json::from_str(&place.read(&format!("{name}/stiffness.json"))).unwrap();
        let missing = &record["error_band"]["missing"];
        let bands: Vec<&Value> =
            record["error_band"]["references"].as_array().unwrap().iter().map(|of| &of["tangent"]).collect();
        if name == "whole" {
            assert_eq!(code, Some(0), "{text}{}", message(&answer));
            assert!(missing.is_null() && bands.iter().all(|band| band.is_f64()), "{missing} {bands:?}");
            continue;
        }
        assert_eq!(code, Some(1), "{text}{}", message(&answer));
        assert!(bands.iter().all(|band| band.is_null()), "{bands:?}");
        let named = missing[0].as_str().unwrap();
        assert!(named.starts_with("rail holed.prr: lines ") && named.contains("gap 10."), "{named}");
        assert!(text.contains("missing: no error band: rail holed.prr: lines "), "{text}");
    }
}

/// Source: the same rails in a table, on the bodies of the standard. Goal: the row of the hole has the finding and no band, that of the whole profile a
/// band and no finding. CSV and JSON say the same, and so does a second run from the store. The exit code is 1 for both rails and 0 for the whole one.
#[test]
fn a_hole_enters_the_rows_of_a_table() {
    let place =
        Place::new(env!("CARGO_BIN_EXE_railspring"), concat!(env!("CARGO_TARGET_TMPDIR"), "/everyday"));
    write_rails(&place);
    place.write("base.toml", &COARSE.replace("error_band = false", ""));
    let rail = |name: &str| {
        format!("[[rail]]\nname = \"{name}\"\nprofile_file = \"{name}.prr\"\nstandard = \"60E1\"\n")
    };
    let head = "base = \"base.toml\"\nbodies = \"nominal\"\nstiffness_at_kn = [60]\n[[wheel]]\nprofile = \"S1002\"\n";
    place.write("both.toml", &format!("name = \"both\"\n{head}{}{}", rail("whole"), rail("holed")));
    place.write("one.toml", &format!("name = \"one\"\n{head}{}", rail("whole")));
    for run in ["first", "again"] {
        let answer = place.run(&["table", "both.toml", "-o", run]);
        let text = said(&answer);
        assert_eq!(answer.status.code(), Some(1), "{text}{}", message(&answer));
        assert!(text.contains("places with unresolved findings in their profiles: 1;"), "{text}");
        let mut reader = csv::Reader::from_path(place.path(&format!("{run}/table.csv"))).unwrap();
        let names = reader.headers().unwrap().clone();
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        let cell = |row: usize, name: &str| &rows[row][names.iter().position(|own| own == name).unwrap()];
        let band = "stiffness_rel_error_band_at_60kn";
        assert!(
            cell(0, "findings_left").is_empty() && cell(0, band).parse::<f64>().unwrap() > 0.0,
            "{rows:?}"
        );
        let found = cell(1, "findings_left");
        assert!(found.starts_with("rail holed.prr: lines ") && found.contains("gap 10."), "{found}");
        assert!(cell(1, band).is_empty() && cell(1, "status") == "complete", "{rows:?}");
        let record: Value = serde_json::from_str(&place.read(&format!("{run}/table.json"))).unwrap();
        let places = |case: usize| &record["cases"][case]["places"][0];
        assert_eq!(places(1)["findings_left"][0], found, "{record}");
        assert!(places(0)["findings_left"].is_null());
    }
    let answer = place.run(&["table", "one.toml", "-o", "one"]);
    assert_eq!(answer.status.code(), Some(0), "{}{}", said(&answer), message(&answer));
}

/// The rail with a hole from -5 to 5 mm, and the whole one.
fn write_rails(place: &Place) {
    let y = |row: &str| row.split_whitespace().next().and_then(|y| y.parse::<f64>().ok());
    let holed = RAIL.lines().filter(|row| row.contains('=') || y(row).is_none_or(|y| y.abs() > 5.0));
    place.write("holed.prr", &holed.map(|row| format!("{row}\n")).collect::<String>());
    place.write("whole.prr", RAIL);
}
