//! What was edited after it was written goes no further: exports and comparisons take results as they were written.
//!
//! Goal: exit code 2 with the file and the command that makes it again; the same file in another layout is taken. No tolerance.

use railspring_testing::{Place, message, said};
use serde_json::Value;

const COARSE: &str = include_str!("studies/coarse.toml");
const TABLE: &str = "name = \"t\"\nbase = \"coarse.toml\"\nstiffness_at_kn = [10, 60]\n[[wheel]]\nprofile = \"S1002\"\n\
    [[rail]]\nname = \"=1+1\"\nprofile = \"60E1\"\n";

fn place() -> Place {
    let place =
        Place::new(env!("CARGO_BIN_EXE_railspring"), concat!(env!("CARGO_TARGET_TMPDIR"), "/everyday"));
    place.write("coarse.toml", COARSE);
    place.write("t.toml", TABLE);
    place
}

fn refused(place: &Place, arguments: &[&str], file: &str) {
    let answer = place.run(arguments);
    let said = message(&answer);
    assert_eq!(answer.status.code(), Some(2), "{arguments:?}: {said}");
    assert!(said.contains(file) && said.contains("make it again") || said.contains("has written"), "{said}");
}

fn done(place: &Place, arguments: &[&str]) -> String {
    let answer = place.run(arguments);
    assert_eq!(answer.status.code(), Some(0), "{arguments:?}: {}", message(&answer));
    said(&answer)
}

/// Source: `stiffness.json` of a calibration, with its constant b ten times as large everywhere. Goal: neither exported nor compared.
#[test]
fn an_edited_calibration_goes_no_further() {
    let place = place();
    done(&place, &["calibrate", "coarse.toml", "-o", "o", "-q"]);
    let written = place.read("o/stiffness.json");
    let mut value: Value = serde_json::from_str(&written).unwrap();
    // another layout of the same values
    place.write("o/stiffness.json", &serde_json::to_string(&value).unwrap());
    done(&place, &["export", "o/stiffness.json", "--to", "stem", "-o", "x"]);
    let b = value["law"]["b_kn_per_m"].as_f64().unwrap();
    value["law"]["b_kn_per_m"] = (10.0 * b).into();
    place.write("o/stiffness.json", &serde_json::to_string_pretty(&value).unwrap());
    refused(&place, &["export", "o/stiffness.json", "--to", "stem", "-o", "y"], "o/stiffness.json");
    place.write("whole.json", &written);
    refused(&place, &["compare", "whole.json", "o/stiffness.json"], "o/stiffness.json");
    assert!(!place.path("y").exists() && !place.path("compare.html").exists());
}

/// Source: a table of one place, and the same with a stiffness or a row edited. Goal: neither exported nor compared with; a table without its
/// record is not compared with; a name that a spreadsheet would run stands behind a quote, and is the same name for exports and comparisons.
#[test]
fn an_edited_table_goes_no_further() {
    let place = place();
    done(&place, &["table", "t.toml", "-o", "o", "-q"]);
    let rows = place.read("o/table.csv");
    assert!(rows.contains(",'=1+1,"), "{rows}");
    done(&place, &["export", "o/table.json", "--to", "json", "--where", "rail==1+1", "-o", "x"]);
    let again = done(&place, &["table", "t.toml", "-o", "p", "--diff", "o/table.csv"]);
    assert!(again.contains("0 places with other values, 0 new, 0 gone"), "{again}");
    let record = place.read("o/table.json");
    let edited = record.replacen("\"shift_mm\": 0.0", "\"shift_mm\": 0.5", 1);
    assert_ne!(edited, record);
    place.write("o/table.json", &edited);
    refused(&place, &["export", "o/table.json", "--to", "json", "-o", "y"], "o/table.json");
    refused(&place, &["table", "t.toml", "-o", "p", "--diff", "o/table.csv"], "o/table.json");
    place.write("o/table.json", &record);
    place.write("o/table.csv", &rows.replacen("complete", "failed", 1));
    refused(&place, &["table", "t.toml", "-o", "p", "--diff", "o/table.csv"], "o/table.csv");
    place.write("alone.csv", &rows);
    refused(&place, &["table", "t.toml", "-o", "p", "--diff", "alone.csv"], "alone.csv");
}
