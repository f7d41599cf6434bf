//! `nan`, `inf` and dates in a table.
//!
//! Goal: exit code 2 with file, line and key wherever they stand: never a panic, never a number in their place. No tolerance.

use railspring_testing::{Place, message};

const COARSE: &str = include_str!("studies/coarse.toml");

/// A table with `text` in one of its places, and the key there.
const PLACES: [(&str, &str); 9] = [
    ("shifts_mm = [X]", "shifts_mm"),
    ("stiffness_at_kn = [10, X]", "stiffness_at_kn"),
    ("[study.calibration]\nload_max_kn = X", "study.calibration.load_max_kn"),
    ("[study.calibration]\nloads_kn = [5, X]", "study.calibration.loads_kn[1]"),
    ("[study.wheel.material]\nyoung_gpa = X", "study.wheel.material.young_gpa"),
    ("[[wheel]]\nname = \"v\"\nprofile = \"S1002\"\ntape_diameter_m = X", "tape_diameter_m"),
    ("[[wheel]]\nname = \"v\"\nprofile = \"S1002\"\ntape_diameter_m = [0.9, X]", "tape_diameter_m[1]"),
    ("[sweep]\n\"contact.friction\" = [0.2, X]", "sweep.contact.friction[1]"),
    ("[sweep]\n\"wheel.material\" = [{ young_gpa = X }]", "sweep.wheel.material[0].young_gpa"),
];

#[test]
fn numbers_that_are_none_are_named() {
    let place =
        Place::new(env!("CARGO_BIN_EXE_railspring"), concat!(env!("CARGO_TARGET_TMPDIR"), "/everyday"));
    place.write("coarse.toml", COARSE);
    for (text, key) in PLACES {
        for value in ["nan", "inf", "-inf", "2020-01-01", "12:00:00"] {
            let (top, section) = if text.starts_with('[') { ("", text) } else { (text, "") };
            let table = format!(
                "name = \"t\"\nbase = \"coarse.toml\"\n{top}\n[[wheel]]\nprofile = \"S1002\"\n[[rail]]\nprofile = \"60E1\"\n{section}\n"
            );
            let table = table.replace('X', value);
            place.write("t.toml", &table);
            let line = 1 + table[..table.find(value).unwrap()].matches('\n').count();
            let answer = place.run(&["table", "t.toml", "-o", "t", "--dry-run"]);
            let said = message(&answer);
            assert_eq!(answer.status.code(), Some(2), "{table}: {said}");
            assert!(
                said.contains(&format!("t.toml:{line}: ")) && said.contains(key),
                "{key} = {value}: {said}"
            );
        }
    }
}
