//! Holes of measured profiles count: in the verdict, in the exit code and in the error band.
//!
//! Goal: springs of a profile with a hole end with exit code 1, without a band, and with the hole named; those of the whole profile hold.

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
    let y = |row: &str| row.split_whitespace().next().and_then(|y| y.parse::<f64>().ok());
    let holed = RAIL.lines().filter(|row| row.contains('=') || y(row).is_none_or(|y| y.abs() > 5.0));
    place.write("holed.prr", &holed.map(|row| format!("{row}\n")).collect::<String>());
    place.write("whole.prr", RAIL);
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
