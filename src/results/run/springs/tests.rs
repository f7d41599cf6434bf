//! Laws from files against the study's own: units, range, pair and reference.

use std::path::PathBuf;

use railspring_calibrate::law::{Form, NormalLaw, StiffnessLaw};
use railspring_profiles::error::Result;
use railspring_simulate::time::history::{ContactMode, ContactState, Ending, HistoryRow};

use super::of_study::revolved_mass;
use super::*;
use crate::engine::output::to_json;
use crate::engine::seal::Sealed;
use crate::results::bodies::geometry;
use crate::results::by_angle::element::{ElasticWheelRecord, ElementRecord, StripRecord};
use crate::results::by_angle::lumped::LumpedRecord;
use crate::results::by_angle::record::{BY_ANGLE, StiffnessByAngleRecord};
use crate::results::run::input::SpringsInput;
use crate::results::run::record::{SolidElementRecord, SpringsSource};
use crate::results::samples;
use crate::results::springs::form::NormalLawRecord;
use crate::results::springs::record::{BeamRecord, StiffnessRecord, SubsurfaceRecord};
use crate::study::{ContactElementKey, Study};

/// ROUNDOFF: a power and some products of numbers of order one.
const ROUNDOFF: f64 = 1e-13;
const STUDY: &str = "name = \"x\"\n[rail]\nprofile = \"60E1\"\n[wheel]\nprofile = \"S1002\"\n[scenario.s]\nvertical_force = {}\nlateral_force = {}\n";
const LAW: &str = r#"{"a_kn_per_m": 30000, "b_kn_per_m": 294000, "c": 0.241104, "f0_kn": 1, "horizontal_kn_per_m": 4e5, "reference": "beam", "range_kn": [1, 150]}"#;

fn study(more: &str) -> Study {
    Study::parse(&PathBuf::from("x.toml"), &format!("{STUDY}{more}")).unwrap_or_else(|e| panic!("{e}"))
}

fn read(study: &Study, text: &str) -> Result<SpringsRecord> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("law.json");
    std::fs::write(&path, text).unwrap();
    from_file(&SpringsInput::of(study), &geometry::geometry(study.statics()).unwrap(), &path)
}

fn refusal(study: &Study, text: &str) -> String {
    read(study, text).unwrap_err().to_string()
}

/// Source: `k = a + b·(f/f0)^c`. Goal: a law says the same whatever its f0, kN: with 10 kN for 1 kN, b grows by 10^c.
#[test]
fn the_reference_force_scales_the_power() {
    let study = study("");
    let own = springs(&read(&study, LAW).unwrap()).unwrap().normal;
    let published = StiffnessLaw::published();
    assert!((own.tangent(85e3) / published.tangent(85e3) - 1.0).abs() < ROUNDOFF);
    let b = 294_000.0 * 10f64.powf(0.241104);
    let other = LAW.replace("\"f0_kn\": 1", "\"f0_kn\": 10").replace("294000", &b.to_string());
    let other = springs(&read(&study, &other).unwrap()).unwrap().normal;
    for force in [1.0, 1e3, 85e3] {
        assert!((other.tangent(force) / published.tangent(force) - 1.0).abs() < ROUNDOFF, "{force} N");
    }
    let unscaled = springs(&read(&study, &LAW.replace("\"f0_kn\": 1", "\"f0_kn\": 10")).unwrap()).unwrap();
    let expected = 3e7 + 2.94e8 * 8.5f64.powf(0.241104);
    assert!((unscaled.normal.tangent(85e3) / expected - 1.0).abs() < ROUNDOFF);
}

/// Source: the publication's constants, kN. Goal: the published law with a horizontal stiffness of the study needs no calibration and says what it goes without; anything
/// else does. The wheel's mass is that of a body of revolution, kg. Accuracy: ROUNDOFF.
#[test]
fn published_springs_need_no_calibration() {
    let published = "[simulation]\nlaw = \"published\"\n";
    let own = study(&format!("{published}horizontal_kn_per_m = 65000\n"));
    assert!(need_no_calibration(&SpringsInput::of(&own)));
    let geometry = geometry::geometry(own.statics()).unwrap();
    let springs = without_calibration(&SpringsInput::of(&own), &geometry).unwrap();
    assert_eq!(springs.law, NormalLawRecord::Power(StiffnessLaw::published().into()));
    assert!((springs.horizontal_kn_per_m / 65_000.0 - 1.0).abs() < ROUNDOFF);
    assert_eq!(springs.wheel_mass_kg, revolved_mass(&SpringsInput::of(&own), &geometry));
    assert!(springs.notes.iter().any(|note| note.contains("nothing is calibrated")), "{:?}", springs.notes);
    let others = [published, "[simulation]\nhorizontal_kn_per_m = 65000\n"];
    for other in others.map(study) {
        assert!(
            !need_no_calibration(&SpringsInput::of(&other))
                && without_calibration(&SpringsInput::of(&other), &geometry).is_none()
        );
    }
}

/// Goal: the condensed element is that of the laws by contact angle beside the law; without them a law runs as springs and says so, unless the study asks
/// for the condensed element, and so it does with laws of another pair. What a study gives for springs alone asks for the published element.
#[test]
fn the_condensed_element_is_that_beside_the_law() {
    let strip = |rail_s_mm: f64| StripRecord {
        rail_s_mm,
        modulus_gpa: 200.0,
        hardening: 0.2,
        tangential_gpa: 100.0,
        relief: 0.9,
    };
    let element = || ElementRecord {
        wheel: ElasticWheelRecord {
            mass: [[300.0, 0.0, 0.0], [0.0, 300.0, 0.0], [0.0, 0.0, 9.0]],
            hub_m: [0.0, -0.43],
            modes: Vec::new(),
            rest: [[1e-8, 0.0, 0.0], [0.0, 2e-10, 0.0], [0.0, 0.0, 2e-7]],
        },
        head: [[5e-9, 0.0, 0.0], [0.0, 7e-11, 0.0], [0.0, 0.0, 5e-7]],
        held_end: None,
        strips: vec![strip(0.0), strip(2.0)],
        relief_um_mm_per_kn: 2.8,
        strips_max_rel_error: 0.1,
        displacement: None,
        section_misfit: [0.0, 0.1],
    };
    let (default, asking) = (study(""), study("[simulation]\nelement = \"condensed\"\n"));
    let laws = StiffnessByAngleRecord {
        element: Some(element()),
        pair: default.statics().pair(),
        ..samples::by_angle()
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("law.json");
    std::fs::write(&path, LAW).unwrap();
    let read = |study: &Study| {
        from_file(&SpringsInput::of(study), &geometry::geometry(study.statics()).unwrap(), &path)
    };
    assert_eq!(read(&default).unwrap().element_blake3, None);
    let missing = read(&asking).unwrap_err().to_string();
    assert!(missing.contains(BY_ANGLE), "{missing}");
    let beside = folder.path().join(BY_ANGLE);
    std::fs::write(&beside, to_json(&laws.clone().sealed())).unwrap();
    for study in [&default, &asking] {
        let springs = read(study).unwrap();
        assert_eq!(springs.element.as_deref(), Some(&SolidElementRecord::Condensed(element())));
        assert_eq!(springs.element_blake3.map(|hash| hash.len()), Some(64));
    }
    // what no calibration writes is refused with its key
    type Change = fn(&mut ElementRecord);
    let changes: [(&str, Change); 6] = [
        ("element.strips", |element| element.strips.clear()),
        ("element.strips[1].rail_s_mm", |element| element.strips[1].rail_s_mm = -2.0),
        ("element.strips[0].modulus_gpa", |element| element.strips[0].modulus_gpa = 0.0),
        ("element.strips[1].hardening", |element| element.strips[1].hardening = -1.0),
        ("element.relief_um_mm_per_kn", |element| element.relief_um_mm_per_kn = -1.0),
        ("element.wheel.mass", |element| element.wheel.mass[1][1] = 0.0),
    ];
    for (key, change) in changes {
        let mut wrong = element();
        change(&mut wrong);
        std::fs::write(&beside, to_json(&StiffnessByAngleRecord { element: Some(wrong), ..laws.clone() }))
            .unwrap();
        for study in [&default, &asking] {
            let said = read(study).unwrap_err().to_string();
            assert!(
                said.contains(key) && said.contains(BY_ANGLE) && said.contains("calibrate again"),
                "{said}"
            );
        }
    }
    std::fs::write(&beside, to_json(&laws.clone().sealed())).unwrap();
    for keys in ["element = \"published\"", "horizontal_kn_per_m = 4e5"] {
        let springs = read(&study(&format!("[simulation]\n{keys}\n"))).unwrap();
        assert_eq!(springs.element_blake3, None, "{keys}");
    }
    // nor is what was edited elsewhere
    std::fs::write(
        &beside,
        to_json(&StiffnessByAngleRecord { pair: samples::by_angle().pair, ..laws.clone().sealed() }),
    )
    .unwrap();
    for study in [&default, &asking] {
        assert!(read(study).unwrap_err().to_string().contains("edited after it was written"));
    }
    let other = StiffnessByAngleRecord { pair: samples::by_angle().pair, ..laws };
    std::fs::write(&beside, to_json(&other.sealed())).unwrap();
    assert_eq!(read(&default).unwrap().element_blake3, None);
    let another = read(&asking).unwrap_err().to_string();
    assert!(another.contains("another-pair"), "{another}");
}

/// Goal: a study that asks for the lumped element has that of the laws by contact angle beside the law. Its
/// hash differs from that of the condensed one. In SI units it has the constants of the file. Laws without
/// it, and constants that no calibration writes, are refused with their key. Springs go from one element to
/// another and back, and the published one needs no laws.
#[test]
fn the_lumped_element_is_that_beside_the_law() {
    let asking = study("[simulation]\nelement = \"lumped\"\n");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("law.json");
    std::fs::write(&path, LAW).unwrap();
    let read = |lumped: Option<LumpedRecord>| {
        let pair = asking.statics().pair();
        let laws = StiffnessByAngleRecord { lumped, pair, ..samples::by_angle() }.sealed();
        std::fs::write(folder.path().join(BY_ANGLE), to_json(&laws)).unwrap();
        from_file(&SpringsInput::of(&asking), &geometry::geometry(asking.statics()).unwrap(), &path)
            .map(|springs| (springs, laws))
    };
    let (record, laws) = read(Some(samples::lumped())).unwrap();
    assert_eq!(element(&record), ContactElementKey::Lumped);
    assert_eq!(record.element.as_deref(), Some(&SolidElementRecord::Lumped(samples::lumped())));
    let (key, parts) = springs(&record).unwrap().element.unwrap();
    assert_eq!((key, parts.wheel.mass[(1, 1)]), (ContactElementKey::Lumped, 307.8));
    assert_eq!(parts.wheel.modes.len(), 2);
    assert_eq!(parts.wheel.rest.amax(), 0.0);
    // k_φ of the bushing against a held section, N·m/rad
    assert!((parts.head[(2, 2)] * 1.6e6 - 1.0).abs() < ROUNDOFF, "{}", parts.head);
    let published = in_element(&record, None, ContactElementKey::Published).unwrap();
    assert_eq!(
        (element(&published), published.element_blake3.as_ref()),
        (ContactElementKey::Published, None)
    );
    assert_eq!(in_element(&published, Some(&laws), ContactElementKey::Lumped).unwrap(), record);
    let without = in_element(&record, Some(&laws), ContactElementKey::Condensed).unwrap_err();
    assert_eq!(without, "there is no condensed element: the laws by contact angle have no condensed element");
    type Change = fn(&mut LumpedRecord);
    let changes: [(&str, Change); 6] = [
        ("lumped.strips", |lumped| lumped.strips.clear()),
        ("lumped.strips[1].rail_s_mm", |lumped| lumped.strips[1].rail_s_mm = -2.0),
        ("lumped.strips[0].tangential_gpa", |lumped| lumped.strips[0].tangential_gpa = 0.0),
        ("lumped.oscillators[1].frequency_hz", |lumped| lumped.oscillators[1].frequency_hz = -1.0),
        ("lumped.bushing.turn_knm_per_rad", |lumped| lumped.bushing.turn_knm_per_rad = 0.0),
        ("lumped.hub", |lumped| lumped.hub.mass_kg = 0.0),
    ];
    for (key, change) in changes {
        let mut wrong = samples::lumped();
        change(&mut wrong);
        let said = read(Some(wrong)).unwrap_err().to_string();
        assert!(said.contains(key) && said.contains(BY_ANGLE) && said.contains("calibrate again"), "{said}");
    }
}

/// Source: the points of the calibration. Goal: `law = "table"` runs with the tangents (N/m) of the reference in use at its
/// loads, the constants without it; a file of another calibration is refused beside it. Accuracy: ROUNDOFF.
#[test]
fn a_table_has_the_tangents_of_the_calibration() {
    let with = study("[simulation]\nlaw = \"table\"\n");
    let record = samples::stiffness();
    let normal = springs(&springs_of_study(&SpringsInput::of(&with), &record, None).unwrap()).unwrap().normal;
    let points = &record.references.iter().find(|r| r.reference == record.reference).unwrap().points;
    assert!(points.len() > 4);
    for point in points {
        let k = normal.tangent(1e3 * point.force_kn) / (1e3 * point.tangent_kn_per_m);
        assert!((k - 1.0).abs() < ROUNDOFF, "{} kN: {k}", point.force_kn);
    }
    assert!(
        springs_of_study(&SpringsInput::of(&study("[simulation]\nelement = \"published\"\n")), &record, None)
            .unwrap()
            .law
            == NormalLawRecord::Power(record.law.constants)
    );
    let said = refusal(&with, LAW);
    assert!(said.contains("simulation.law = \"table\""), "{said}");
    let accepting = study("[simulation]\nlaw = \"table\"\nlaw_accepted = [\"another-pair\"]\n");
    let of_file = read(&accepting, &serde_json::to_string(&record.clone().sealed()).unwrap()).unwrap();
    let table = record.form(Form::Table).unwrap();
    assert_eq!(of_file.law, table.law, "a file of another calibration has its table as well");
}

/// Goal: a law written by hand is taken, and the result says what is unknown about it; wrong ones name the key and what it needs.
#[test]
fn a_law_written_by_hand_is_checked() {
    let study = study("");
    let minimal = LAW.replace(", \"reference\": \"beam\", \"range_kn\": [1, 150]", "");
    let record = read(&study, &minimal).unwrap();
    assert_eq!(
        record.notes.len(),
        5,
        "reference, pair and range are unknown, the beam is plain, there is no condensed element: {:?}",
        record.notes
    );
    assert!(matches!(&record.source, SpringsSource::File { name, .. } if name.ends_with("law.json")));
    // Mass of the generic wheel, kg: that of its section, and the file's if it says one.
    assert!((200.0..400.0).contains(&record.wheel_mass_kg), "{}", record.wheel_mass_kg);
    let heavy = LAW.replace("{\"a", "{\"wheel_mass_kg\": 512, \"a");
    assert_eq!(read(&study, &heavy).unwrap().wheel_mass_kg, 512.0);
    for (from, to, part) in [
        ("30000", "-30000", "a_kn_per_m = -30000: expected a number from 0 to 1e12"),
        ("294000", "NaN", "law.json = expected value at line 1 column 37"),
        ("294000", "1e999", "law.json = number out of range"),
        ("294000", "\"294000\"", "invalid type: string"),
        ("0.241104", "1", "c = 1: expected a number from 0 to below 1"),
        ("\"c\": 0.241104, ", "", "c = (missing): expected a number"),
        ("\"f0_kn\": 1", "\"f0_kn\": 0", "f0_kn = 0: expected a number above 0"),
        ("\"horizontal_kn_per_m\": 4e5, ", "", "horizontal_kn_per_m = (missing)"),
        ("4e5", "-4e5", "horizontal_kn_per_m = -400000"),
        ("[1, 150]", "[150, 1]", "range_kn = [150, 1]: expected two ascending loads"),
        ("\"c\":", "\"g\": 1, \"c\":", "unknown field `g`"),
        ("\"c\":", "\"d\": 1, \"c\":", "d = (given): expected the keys of a law of the form \"power\""),
        ("\"c\":", "\"c\": 0.3, \"c\":", "duplicate field `c`"),
        (
            "\"beam\"",
            "\"hub\"",
            "reference = \"hub\": expected \"foot\", \"beam\", \"local\" or \"half-spaces\"",
        ),
    ] {
        let text = refusal(&study, &LAW.replace(from, to));
        assert!(text.contains(part), "{part:?} in {text}");
    }
    let without = study_with_horizontal();
    let law = LAW.replace("\"horizontal_kn_per_m\": 4e5, ", "");
    assert_eq!(read(&without, &law).unwrap().horizontal_kn_per_m, 7e4);
}

/// Source: the forms of docs/laws.md, kN and m. Goal: a law of each form is taken from a file written by hand, with its tangent; one without a key of its form, or with one
/// of another, is refused with the key. Accuracy: ROUNDOFF.
#[test]
fn a_law_of_each_form_is_written_by_hand() {
    let study = study("");
    let law = |keys: &str| format!("{{{keys}, \"horizontal_kn_per_m\": 4e5, \"reference\": \"beam\"}}");
    let tangent = |keys: &str, force: f64| {
        springs(&read(&study, &law(keys)).unwrap_or_else(|e| panic!("{e}"))).unwrap().normal.tangent(force)
    };
    let near = |value: f64, exact: f64| assert!((value / exact - 1.0).abs() < ROUNDOFF, "{value} {exact}");
    let series = r#""form": "series", "b_kn_per_m": 4e5, "c": 0.25, "f0_kn": 2, "s_kn_per_m": 2e6"#;
    // b·(32/2)^(1/4) is 2·4e5 kN/m
    near(tangent(series, 32e3), 1e3 / (1.0 / 8e5 + 1.0 / 2e6));
    near(tangent(&series.replace(", \"s_kn_per_m\": 2e6", ""), 32e3), 8e8);
    let steps = r#""form": "steps", "b_kn_per_m": 4e5, "c": 0.25, "f0_kn": 1, "f1_kn": 16, "p": 2, "d": 0.5, "e": 0.75"#;
    // at the step t is 1: b·16^(1/4)·2^(0.5/2)·(1 + 0.5/2)
    near(tangent(steps, 16e3), 8e8 * 2f64.powf(0.25) * 1.25);
    let table = r#""form": "table", "table_kn_and_kn_per_m": [[1, 4e5], [8, 8e5], [27, 12e5], [125, 20e5]]"#;
    near(tangent(table, 64e3), 16e8);
    for (keys, from, to, part) in [
        (series, "4e5", "0", "b_kn_per_m = 0: expected a number above 0"),
        (series, "2e6", "-1", "s_kn_per_m = -1: expected a number above 0"),
        (steps, "\"p\": 2, ", "", "p = (missing)"),
        (steps, "\"p\": 2", "\"p\": 100", "0.5 ≤ p ≤ 20"),
        (steps, "\"e\": 0.75", "\"e\": 1", "e = 1: expected a number from 0 to below 1"),
        (
            steps,
            "\"form\": \"steps\", ",
            "",
            "f1_kn = (given): expected the keys of a law of the form \"power\"",
        ),
        (table, "[8, 8e5]", "[1, 8e5]", "law.points[1].force"),
        (table, "\"table_kn_and", "\"c\": 1, \"table_kn_and", "c = (given)"),
        (table, "\"table\"", "\"curve\"", "unknown variant `curve`"),
    ] {
        let text = refusal(&study, &law(&keys.replace(from, to)));
        assert!(text.contains(part), "{part:?} in {text}");
    }
}

/// Goal: each form of a calibration drives the model, and the springs say which: its tangent at 40 kN is that of its record. Accuracy: ROUNDOFF.
#[test]
fn each_form_of_the_calibration_drives_the_model() {
    let record = samples::stiffness();
    for (key, form) in [("calibrated", Form::Power), ("series", Form::Series), ("steps", Form::Steps)] {
        let with = study(&format!("[simulation]\nelement = \"published\"\nlaw = {key:?}\n"));
        let found = springs_of_study(&SpringsInput::of(&with), &record, None).unwrap();
        let expected = NormalLaw::try_from(&record.form(form).unwrap().law).unwrap().tangent(40e3);
        let tangent = springs(&found).unwrap().normal.tangent(40e3);
        assert!((tangent / expected - 1.0).abs() < ROUNDOFF, "{key}: {tangent}");
        assert_eq!(
            found.notes.iter().any(|note| note.contains(&format!("the form `{key}`"))),
            key != "calibrated"
        );
    }
}

fn study_with_horizontal() -> Study {
    study("[simulation]\nhorizontal_kn_per_m = 70000\n")
}

/// Goal: a law of another reference or of another pair is refused with the reason, and taken and said where the study
/// accepts it; so is the study's own law of another reference, before anything is computed.
#[test]
fn another_reference_and_another_pair_need_the_studys_word() {
    let plain = study("[simulation]\nelement = \"published\"\n");
    let accepting = study(
        "[simulation]\nelement = \"published\"\nlaw_accepted = [\"another-pair\", \"another-reference\"]\n",
    );
    for (reference, reason) in
        [("foot", "a second time"), ("local", "leaves out"), ("half-spaces", "leaves out")]
    {
        let law = LAW.replace("\"beam\"", &format!("{reference:?}"));
        let text = refusal(&plain, &law);
        assert!(text.contains(reason) && text.contains("law_accepted = [\"another-reference\"]"), "{text}");
        assert!(read(&accepting, &law).unwrap().notes.iter().any(|note| note.contains(reason)));

        if reference == "half-spaces" {
            // only a file has such a law: it is none that a study can ask for
            continue;
        }
        let keys = format!("[calibration]\nreference = {reference:?}\n");
        let own = check_reference(&SpringsInput::of(&study(&keys))).unwrap_err().to_string();
        assert!(own.starts_with("calibration.reference = ") && own.contains(reason), "{own}");
        let known = format!("{keys}[simulation]\nlaw_accepted = [\"another-reference\"]\n");
        check_reference(&SpringsInput::of(&study(&known))).unwrap();
        let published = format!("{keys}[simulation]\nlaw = \"published\"\n");
        check_reference(&SpringsInput::of(&study(&published))).unwrap();
    }
    let mut record = samples::stiffness();
    let json = |record: &StiffnessRecord| serde_json::to_string(&record.clone().sealed()).unwrap();
    let text = refusal(&plain, &json(&record));
    assert!(text.contains("pair = 60E1 and S1002") && text.contains("[\"another-pair\"]"), "{text}");
    assert!(read(&accepting, &json(&record)).unwrap().notes[0].contains("another pair"));
    record.pair = plain.statics().pair();
    // one of the same pair with other settings comes with its wheel and its beam
    record.beam.length_m = plain.rail.length;
    let own_pair = read(&plain, &json(&record)).unwrap();
    assert!(own_pair.notes.len() == 1 && own_pair.notes[0].contains("with other settings"), "{own_pair:?}");
    assert_eq!((own_pair.wheel_mass_kg, own_pair.beam), (record.wheel_mass(), record.beam.factors));
    let longer = StiffnessRecord { beam: BeamRecord { length_m: 2.0, ..record.beam }, ..record.clone() };
    let longer = read(&plain, &json(&longer)).unwrap().notes;
    assert!(longer[1].contains("of a rail of 2 m"), "{longer:?}");
    // no wheel of steel has this pressure
    let mut soft = record.clone();
    soft.subsurface = vec![SubsurfaceRecord {
        force_kn: 60.0,
        max_von_mises_mpa: 0.5,
        von_mises_depth_mm: 3.0,
        max_shear_mpa: 0.3,
        shear_depth_mm: 3.0,
        error_band: None,
    }];
    let said = read(&plain, &json(&soft)).unwrap().notes;
    assert!(said.len() == 2 && said[1].contains("MPa; steel wheels have 200 to 6000 MPa"), "{said:?}");
    // The study's own calibration under another name is no other law; an edited one is none.
    record.input_hash = SpringsInput::of(&plain).calibration().key().into();
    let sealed = record.clone().sealed();
    assert_eq!(
        read(&plain, &json(&sealed)).unwrap(),
        springs_of_study(&SpringsInput::of(&plain), &sealed, None).unwrap()
    );
    let mut edited = sealed;
    edited.law.constants.b_kn_per_m *= 1.001;
    let said = refusal(&plain, &serde_json::to_string(&edited).unwrap());
    assert!(said.contains("edited after it was written") && said.contains("railspring calibrate"), "{said}");
    // nor is one that lost a key with its hash
    let mut cut = serde_json::to_value(&edited).unwrap();
    cut.as_object_mut().unwrap().remove("content_blake3");
    assert!(refusal(&plain, &cut.to_string()).contains("edited after it was written"));
    cut.as_object_mut().unwrap().remove("beam");
    assert!(refusal(&plain, &cut.to_string()).contains("`beam`"));
    let published = study("[simulation]\nlaw = \"published\"\n");
    assert!(refusal(&published, LAW).starts_with("simulation.law = "));
}

/// Source: a law as it is common, and the same in N/m under kN/m keys, with a force of 1 N for 1 kN, and with a mass in tonnes. Goal: the
/// common one has no such note, of each other one what is outside is said; constants that no wheel has at all are refused with the file and the key.
#[test]
fn other_units_are_noticed() {
    let plain = study("");
    let notes = |text: &str| read(&plain, text).unwrap().notes;
    let common = r#"{"a_kn_per_m": 30000, "b_kn_per_m": 294000, "c": 0.241104, "f0_kn": 1, "horizontal_kn_per_m": 80000,
        "reference": "beam", "range_kn": [1, 150], "wheel_mass_kg": 320}"#;
    let said = |text: &str| -> Vec<String> {
        notes(text).into_iter().filter(|note| note.contains("steel wheels have")).collect()
    };
    assert_eq!(said(common), Vec::<String>::new());
    let in_newtons =
        common.replace("30000", "30000000").replace("294000", "294000000").replace("80000", "80000000");
    let of_newtons = said(&in_newtons);
    assert!(
        of_newtons[0].contains("tangent stiffness at 60 kN is 819000000 kN")
            && of_newtons[0].contains("in kN/m"),
        "{of_newtons:?}"
    );
    assert!(of_newtons[1].contains("horizontal stiffness is 8") && of_newtons.len() == 2, "{of_newtons:?}");
    let of_force = said(&common.replace("\"f0_kn\": 1", "\"f0_kn\": 0.001"));
    assert!(of_force.len() == 1 && of_force[0].contains("tangent"), "{of_force:?}");
    let of_mass = said(&common.replace("320", "0.32"));
    assert!(of_mass.len() == 1 && of_mass[0].contains("mass of the wheel is 0.320 kg"), "{of_mass:?}");
    for (from, to, key) in [
        ("294000", "1e308", "b_kn_per_m"),
        ("30000", "1e30", "a_kn_per_m"),
        ("80000", "1e30", "horizontal_kn_per_m"),
        ("320", "1e-320", "wheel_mass_kg"),
    ] {
        let refused = refusal(&plain, &common.replace(from, to));
        assert!(
            refused.contains(&format!(": {key} = ")) && refused.contains("correct the file"),
            "{refused}"
        );
    }
}

/// Goal: steps with contact outside the fitted range are counted, kN; steps without contact and the initial state are not.
#[test]
fn leaving_the_fitted_range_is_said() {
    let row = |n: usize, load: f64| HistoryRow {
        time: n as f64,
        vertical_force: load * KILONEWTON,
        lateral_force: 0.0,
        wheel_y: 0.0,
        wheel_z: 0.0,
        load_y: 0.0,
        energy: None,
        contacts: (load > 0.0)
            .then(|| ContactState {
                mode: ContactMode::Stick,
                rail: nalgebra::Point2::origin(),
                wheel: nalgebra::Point2::origin(),
                normal_force: load * KILONEWTON,
                tangential_force: 0.0,
            })
            .into_iter()
            .collect(),
    };
    let history = |loads: &[f64]| History {
        rows: loads.iter().enumerate().map(|(n, load)| row(n, *load)).collect(),
        degrees_of_freedom: 1,
        ending: Ending::Completed,
    };
    let record = read(&study(""), LAW).unwrap();
    assert_eq!(range_note(&record, &history(&[0.0, 1.0, 0.0, 150.0])), None);
    let note = range_note(&record, &history(&[0.0, 0.5, 20.0, 0.0, 160.0, 151.0])).unwrap();
    assert!(note.contains("from 0.5 kN to 160 kN"), "{note}");
    assert!(note.contains("of 4 steps with contact 1 lie below it and 2 above"), "{note}");
    assert_eq!(range_note(&SpringsRecord { range_kn: None, ..record }, &history(&[0.0, 1e3])), None);
}
