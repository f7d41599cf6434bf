//! Springs from the rows of a table.

use std::sync::OnceLock;

use serde_json::Value;

use super::{export_of, railspring, rows, said, text};
use crate::tables::Place;

/// A wheel at three shifts, of which it is off the rail at the last.
const TABLE: &str = "name = \"fleet\"\nbase = \"base.toml\"\nshifts_mm = [0, 2, 29]\nstiffness_at_kn = [20, 40, 60]\n\
    [[wheel]]\nprofile = \"S1002\"\n[[rail]]\nprofile = \"60E1\"\n";

/// The table with its results in `out`, that along the normal in `normal`, and the calibration of the pair at 2 mm in `one`; made once.
fn made() -> &'static Place {
    static MADE: OnceLock<Place> = OnceLock::new();
    MADE.get_or_init(|| {
        let place = Place::new(TABLE);
        let normal =
            TABLE.replace("shifts_mm", "direction = \"normal\"\nsides = [\"right\", \"left\"]\nshifts_mm");
        place.write("normal.toml", &normal.replace("[0, 2, 29]", "[-2, 0, 2]"));
        let base = std::fs::read_to_string(place.path("base.toml")).unwrap();
        place.write("one.toml", &format!("{base}[track]\nlateral_shift_mm = 2\n"));
        for (arguments, code) in [
            (["table", "table.toml", "-o", "out"], 1),
            (["table", "normal.toml", "-o", "normal"], 0),
            (["calibrate", "one.toml", "-o", "one"], 0),
        ] {
            let output = railspring(place.0.path(), &[&arguments[..], &["--cache", "store", "-q"]].concat());
            assert_eq!(output.status.code(), Some(code), "{}", said(&output));
        }
        place
    })
}

const SECOND: [&str; 4] = ["--where", "shift_mm=2", "--where", "wheel=S1002"];

/// Lines behind the comment.
fn content(text: &str, sign: char) -> Vec<&str> {
    text.lines().filter(|line| !line.starts_with(sign)).collect()
}

/// Source: the calibration of the same pair at the same shift. Goal: a row has its law, its points and its
/// comment, except for the source that it names. Profiles and cases for CONTACT are those of the study, with
/// the solid at the loads of the columns in the place of all loads. Every reference of the table can be had.
/// Accuracy: ROUNDOFF, the same numbers through other sums; profiles are equal to the digit.
#[test]
fn a_row_is_the_spring_of_its_study() {
    const ROUNDOFF: f64 = 1e-9;
    let root = made().0.path();
    let export = |file: &str, format: &str, more: &[&str]| {
        let arguments =
            ["export", file, "--to", format, "-o", &format!("{format}-{}", file.split('/').next().unwrap())];
        export_of(root, &[&arguments[..], more].concat())
    };
    for reference in ["beam", "local"] {
        let of_row = [&SECOND[..], &["--law", "power", "--reference", reference]].concat();
        let row: Value =
            serde_json::from_str(&text(&export("out/table.json", "json", &of_row), "wheel_rail_spring.json"))
                .unwrap();
        let one = export("one/stiffness.json", "json", &["--law", "power", "--reference", reference]);
        let one: Value = serde_json::from_str(&text(&one, "wheel_rail_spring.json")).unwrap();
        let same = |a: &Value, b: &Value| {
            let [a, b] = [a, b].map(|value| value.as_f64().unwrap());
            assert!((a - b).abs() <= ROUNDOFF * b.abs(), "{a} {b}");
        };
        for key in ["a_n_per_m", "b_n_per_m", "c", "f0_n"] {
            same(&row["law"][key], &one["law"][key]);
        }
        assert_eq!((&row["law"]["range_n"], &row["table"]), (&one["law"]["range_n"], &Value::from("fleet")));
        let [ours, theirs] = [&row, &one].map(|json| json["points"]["displacement_m"].as_array().unwrap());
        assert!(ours.len() > 10 && ours.len() == theirs.len());
        ours.iter().zip(theirs).for_each(|(a, b)| same(a, b));
        // the solid at the loads of the columns
        let [forces, tangents] =
            ["force_n", "tangent_n_per_m"].map(|key| one["solid"][key].as_array().unwrap());
        for (at, load) in [20e3, 40e3, 60e3].into_iter().enumerate() {
            let of_one =
                forces.iter().position(|force| (force.as_f64().unwrap() - load).abs() < 1.0).unwrap();
            same(&row["solid"]["force_n"][at], &load.into());
            same(&row["solid"]["tangent_n_per_m"][at], &tangents[of_one]);
        }
        let comment = row["comment"].to_string();
        for part in [
            "table fleet, wheel S1002, rail 60E1, right side, shift 2 mm; wheel ",
            "first touch: contact angle 4.",
            "range: fitted from 5 to 85 kN",
        ] {
            assert!(comment.contains(part), "{part} in {comment}");
        }
    }

    let with = |file: &str| ["--study".to_string(), file.to_string()];
    let row = export(
        "out/table.json",
        "contact",
        &[&SECOND[..], &with("table.toml").each_ref().map(String::as_str)].concat(),
    );
    let one = export("one/stiffness.json", "contact", &with("one.toml").each_ref().map(String::as_str));
    for profile in ["rail.prr", "wheel.prw"] {
        let [row, one] = [&row, &one].map(|folder| text(folder, profile));
        let lines = |text: &str| -> Vec<String> {
            content(text, '!')
                .into_iter()
                .filter(|line| !line.contains("comment ="))
                .map(String::from)
                .collect()
        };
        assert!(lines(&row).len() > 200);
        assert!(lines(&row) == lines(&one), "{profile}");
    }
    let [row, one] = [row, one].map(|folder| text(&folder, "contact.inp"));
    let of_load = |text: &str, load: &str| -> Vec<f64> {
        let is_it = |case: &&str| case.contains(&format!("0.0 2.000000 {load}"));
        let case = text.split("% case").find(is_it).unwrap_or_else(|| panic!("{load} in {text}"));
        let line = case.lines().find(|line| line.contains("KYRAIL")).unwrap();
        line.split_whitespace().map_while(|word| word.parse().ok()).collect()
    };
    // the study's own loads are 5, 20, 40, 60 and 85 kN: both have the solid at 40 kN; the horizontal stiffness is the mean of other loads
    let ([k_y, _, k_z, _], [study_k_y, _, study_k_z, _]) =
        (of_load(&row, "40000")[..].try_into().unwrap(), of_load(&one, "40000")[..].try_into().unwrap());
    let (k_y, k_z, study_k_y, study_k_z): (f64, f64, f64, f64) = (k_y, k_z, study_k_y, study_k_z);
    assert!((k_z / study_k_z - 1.0).abs() < 1e-6 && (k_y / study_k_y - 1.0).abs() < 0.05, "{row} {one}");
}

/// Goal: without a choice every row has its folder with the very files that it has alone. A list gives the
/// outcome of each, and for one without a law the reason. The exit code says that not all is there. The list
/// of an earlier export does not outlive a later one. The table does not change.
#[test]
fn all_rows_go_into_a_folder() {
    let place = made();
    let root = place.0.path();
    let before = place.files("out");
    let list = |folder: &str| -> Vec<Vec<String>> {
        let mut reader = csv::Reader::from_path(place.path(folder).join("rows.csv")).unwrap();
        reader.records().map(|row| row.unwrap().iter().map(String::from).collect()).collect()
    };
    let output = railspring(root, &["export", "out/table.json", "--to", "opensees", "-o", "all"]);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(said(&output).contains("1 of 3 rows have no files; rows.csv says why"), "{}", said(&output));
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "all/rows.csv");
    let rows = list("all");
    let folders: Vec<&str> = rows.iter().map(|row| row[1].as_str()).collect();
    assert_eq!(folders, ["1-S1002-60E1-right-0mm", "2-S1002-60E1-right-2mm", ""]);
    assert!(rows[2].last().unwrap().contains("leave this shift out"), "{rows:?}");
    let alone = export_of(
        root,
        &[&["export", "out/table.json", "--to", "opensees", "-o", "alone"], &SECOND[..]].concat(),
    );
    for file in ["wheel_rail_spring.py", "wheel_rail_spring.tcl"] {
        assert_eq!(text(&alone, file), text(&place.path("all/2-S1002-60E1-right-2mm"), file));
        assert!(place.path("all/1-S1002-60E1-right-0mm").join(file).is_file());
    }
    // the rows that have a value, whichever way the number is written
    let some = ["export", "normal/table.json", "--to", "stem", "-o", "all", "--where", "side=left"];
    let more = ["--where", "rail_inclination=0.025"];
    let output = railspring(root, &[&some[..], &more].concat());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let rows = list("all");
    assert_eq!(rows.iter().map(|row| row[0].as_str()).collect::<Vec<_>>(), ["4", "5", "6"]);
    assert!(rows.iter().all(|row| place.path("all").join(&row[1]).join("stem_contact.py").is_file()));
    assert!(place.files("out") == before);
}

/// Goal: GENSYS gets a field over the contact angles of all shifts of the pair of a row, each angle once, with the tangents of the table. Source:
/// `table.csv`. Accuracy: DIGITS, seven of the file.
#[test]
fn gensys_gets_the_field_of_a_pair() {
    const DIGITS: f64 = 1e-6;
    let place = made();
    let chosen = ["--where", "side=left", "--where", "shift_mm=-2", "--study", "normal.toml"];
    let arguments = ["export", "normal/table.json", "--to", "gensys", "-o", "gensys"];
    let folder = export_of(place.0.path(), &[&arguments[..], &chosen].concat());
    let field = text(&folder, "stiffness_over_angle_60kn.dat");
    assert!(field.contains("along the contact normal, the hub held across it"), "{field}");
    let mut reader = csv::Reader::from_path(place.path("normal/table.csv")).unwrap();
    let mut expected: Vec<[f64; 2]> = reader
        .deserialize()
        .map(|row| {
            let row: std::collections::BTreeMap<String, String> = row.unwrap();
            ["contact_angle_deg", "stiffness_kn_per_m_at_60kn"].map(|column| row[column].parse().unwrap())
        })
        .collect();
    expected.sort_by(|a, b| a[0].total_cmp(&b[0]));
    expected.dedup();
    let found = rows(&field);
    assert_eq!((found.len(), expected.len()), (3, 3), "{field}");
    for ([angle, stiffness], [of_csv, tangent]) in found.into_iter().zip(expected) {
        assert!((angle - of_csv.to_radians()).abs() < 1e-8);
        assert!((stiffness / (1e3 * tangent) - 1.0).abs() < DIGITS, "{stiffness} {tangent}");
    }
}

/// Goal: what cannot be exported of a table is refused with what to do, and nothing is written.
#[test]
fn rows_that_cannot_be_exported_are_refused() {
    let place = made();
    let refused = |arguments: &[&str], parts: &[&str]| {
        let arguments = [&["export"], arguments, &["-o", "refused"]].concat();
        let output = railspring(place.0.path(), &arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        for part in parts {
            assert!(said(&output).contains(part), "{part:?} in {}", said(&output));
        }
        assert!(!place.path("refused").exists(), "{arguments:?}");
    };
    let table = ["out/table.json", "--to", "json"];
    let with = |more: &[&'static str]| -> Vec<&'static str> { [&table[..], more].concat() };
    refused(&with(&["--where", "wheel=S1003"]), &["--where wheel = S1003", "has: S1002", "name one of them"]);
    refused(&with(&["--where", "colour=red"]), &["--where = colour", "wheel, rail, tape_diameter_m"]);
    refused(&with(&["--where", "wheel"]), &["COLUMN=VALUE"]);
    refused(&with(&["--where", "shift_mm=29"]), &["row 3 = no law:", "choose another place"]);
    refused(&with(&["--reference", "foot"]), &["--reference = \"foot\"", "\"beam\", \"local\"", "foot_held"]);
    refused(
        &with(&["--set", "track.gauge_mm=1432"]),
        &["--set track.gauge_mm", "the keys as they are in the table"],
    );
    refused(
        &["one/stiffness.json", "--to", "json", "--where", "wheel=S1002"],
        &["--where = given", "table.json"],
    );
    refused(&["out/table.json", "--to", "contact"], &["--study = (missing)", "--study"]);
    let other = std::fs::read_to_string(place.path("table.toml")).unwrap().replace("60E1", "54E1");
    place.write("other.toml", &other);
    refused(
        &["out/table.json", "--to", "contact", "--study", "other.toml"],
        &[
            "--study = table fleet",
            "the table that out/table.json was made from, with wheel S1002, rail 60E1",
        ],
    );
    refused(
        &["out/table.json", "--to", "gensys", "--study", "table.toml"],
        &["direction = \"vertical\"", "along the contact normal"],
    );
    refused(
        &["normal/table.json", "--to", "contact", "--study", "normal.toml"],
        &["direction = \"normal\"", "direction = \"vertical\""],
    );
    let broken =
        std::fs::read_to_string(place.path("out/table.json")).unwrap().replacen("\"places\"", "\"place\"", 1);
    place.write("broken.json", &broken);
    refused(&["broken.json", "--to", "json"], &["broken.json", "`railspring table`"]);
    let output = railspring(place.0.path(), &["export", "out/table.json", "--to", "json"]);
    assert!(said(&output).contains("-o = (missing): expected a folder for 3 rows"), "{}", said(&output));
}
