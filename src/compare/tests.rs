//! Made-up results side by side.

use std::path::Path;

use railspring_simulate::time::history::History;

use super::*;
use crate::engine::list::{NewFile, Results};
use crate::engine::output::{OutputFolder, to_json};
use crate::results::by_angle::record::FixedLoadRecord;
use crate::results::inputs::InputsRecord;
use crate::results::run::history_csv;
use crate::results::run::record::{RUN_NOTE, RunRecord};
use crate::results::samples;
use crate::results::springs::record::StiffnessRecord;
use crate::results::verdict::record::VerificationRecord;
use crate::study::ResolvedKey;

/// ROUNDOFF: a product and a quotient of numbers of order one.
const ROUNDOFF: f64 = 1e-12;

fn side(name: &str) -> Side {
    let mut side = Side::of(Path::new(name), samples::stiffness());
    side.load_curve = samples::load_curve();
    side.by_angle = Some(samples::by_angle());
    side.inputs = Some(InputsRecord {
        study: side.stiffness.study.clone(),
        description: String::new(),
        keys: samples::inputs(),
        calibration: side.stiffness.input_hash.clone(),
        version: side.stiffness.version.clone(),
        commit: "commit 0123456789ab".into(),
    });
    side
}

/// The same springs, all tangents times `factor` and all displacements over it, with bands of this relative width.
fn softer(mut stiffness: StiffnessRecord, factor: f64, band: f64) -> StiffnessRecord {
    for reference in &mut stiffness.references {
        for point in &mut reference.points {
            point.tangent_kn_per_m *= factor;
            point.displacement_mm /= factor;
        }
    }
    for reference in stiffness.error_band.iter_mut().flat_map(|band| &mut band.references) {
        reference.tangent = Some(band);
        reference.displacement = Some(band);
        for point in &mut reference.points {
            point.tangent = Some(band);
            point.displacement = Some(band);
        }
    }
    stiffness
}

fn group<'c>(found: &'c Comparison, name: &str) -> &'c Group {
    found.groups.iter().find(|group| group.name.starts_with(name)).unwrap_or_else(|| panic!("{name}"))
}

fn line(quantity: &str, value: f64, limit: f64) -> serde_json::Value {
    serde_json::json!({
        "quantity": quantity, "meaning": format!("line {quantity}"), "kind": "verification", "unit": "1",
        "value": value, "limit": limit, "holds": value <= limit
    })
}

fn verdict(lines: &[serde_json::Value]) -> VerificationRecord {
    serde_json::from_value(serde_json::json!({
        "study": "s", "holds": false, "calibration": lines, "scenarios": [], "inputs": {}, "input_hash": "", "version": "0.1.0"
    }))
    .unwrap()
}

/// Goal: a result beside itself has no change, nothing beyond its bands, and no input that differs.
#[test]
fn a_result_is_its_own() {
    let found = compare(&side("a"), &side("b")).unwrap();
    assert!(found.inputs.is_empty() && found.not_compared.len() == 2, "{found:?}");
    for row in found.groups.iter().flat_map(|group| &group.rows) {
        assert!(row.change.is_none_or(|change| change == 0.0) && row.beyond != Some(true), "{row:?}");
    }
    assert!(found.summary.iter().any(|sentence| sentence == "Tangent stiffness of the solid: the same."));
    assert!(found.summary.iter().any(|sentence| sentence == "No input that is known differs."));
}

/// Goal: tangents that are 20 % larger differ beyond bands of 1 %, and not beyond bands of 12 %, at every load; the change has its sign. Without a
/// band on one side there is no answer, and that is said. Accuracy: ROUNDOFF.
#[test]
fn changes_are_held_against_both_bands() {
    let with = |band: f64| {
        let [mut a, mut b] = [side("a"), side("b")];
        a.stiffness = softer(a.stiffness, 1.0, band);
        b.stiffness = softer(b.stiffness, 1.2, band);
        (a, b)
    };
    for (band, beyond) in [(0.01, true), (0.12, false)] {
        let (a, b) = with(band);
        let found = compare(&a, &b).unwrap();
        let rows = &group(&found, "Tangent").rows;
        assert!(rows.len() > 3);
        for row in rows {
            assert!((row.change.unwrap() - 0.2).abs() < ROUNDOFF && row.beyond == Some(beyond), "{row:?}");
            assert!((row.b_error.unwrap() - band * row.b.unwrap()).abs() < ROUNDOFF * row.b.unwrap());
        }
        let softer = &group(&found, "Displacement").rows[0];
        assert!((softer.change.unwrap() - (1.0 / 1.2 - 1.0)).abs() < ROUNDOFF, "{softer:?}");
        let word = if beyond { "beyond the error bands at" } else { "within the error bands at all" };
        assert!(found.summary[0].contains(word) && found.summary[0].contains("+20 %"), "{:?}", found.summary);
        // constants trade against each other
        assert!(group(&found, "Normal law").rows.iter().all(|row| row.beyond.is_none()));
    }
    let (a, mut b) = with(0.01);
    b.stiffness.error_band = None;
    let found = compare(&a, &b).unwrap();
    assert!(group(&found, "Tangent").rows.iter().all(|row| row.beyond.is_none()));
    assert!(
        found.not_compared.iter().any(|sentence| sentence.starts_with("B has no error band")),
        "{found:?}"
    );
}

/// Goal: where B has other loads than A, its displacement and its tangent are those between its own. Accuracy: MODEL, a smooth curve between every
/// second of the sample's loads, 1 % of the displacement and 3 % of the tangent.
#[test]
fn other_loads_are_met_in_between() {
    const MODEL: [f64; 2] = [0.03, 0.01];
    let [a, mut b] = [side("a"), side("b")];
    for reference in &mut b.stiffness.references {
        // displacements that belong to the tangents: d = ∫ df/k by the trapezoidal rule of a fine grid would do; the sample's are powers
        let law = reference.law.constants;
        for point in &mut reference.points {
            point.tangent_kn_per_m = law.tangent(point.force_kn);
        }
    }
    let mut whole = a.clone();
    whole.stiffness = b.stiffness.clone();
    for reference in whole.stiffness.references.iter_mut().chain(&mut b.stiffness.references) {
        let law = railspring_calibrate::law::StiffnessLaw::try_from(reference.law.constants).unwrap();
        for point in &mut reference.points {
            point.displacement_mm = 1e3 * law.displacement(1e3 * point.force_kn);
        }
    }
    for reference in &mut b.stiffness.references {
        let last = reference.points.len() - 1;
        let kept = reference.points.iter().enumerate().filter(|(n, _)| n % 2 == 0 || *n == last);
        reference.points = kept.map(|(_, point)| *point).collect();
    }
    let found = compare(&whole, &b).unwrap();
    for (name, accuracy) in ["Tangent", "Displacement"].into_iter().zip(MODEL) {
        let rows = &group(&found, name).rows;
        assert!(rows.len() > 3, "{rows:?}");
        assert!(rows.iter().all(|row| row.change.unwrap().abs() < accuracy), "{rows:?}");
    }
}

/// Goal: keys, profile files and program that differ are named with both values; a default that is given is no difference.
#[test]
fn inputs_that_differ_are_named() {
    let [a, mut b] = [side("a"), side("b")];
    let inputs = b.inputs.as_mut().unwrap();
    inputs.commit = "commit ba9876543210".into();
    let key = |section: &str, key: &str, value: &str, given: bool| ResolvedKey {
        section: section.into(),
        key: key.into(),
        value: value.into(),
        given,
    };
    let first = inputs.keys[0].clone();
    inputs.keys[0].given = !first.given;
    inputs.keys[1].value = "other".into();
    inputs.keys.push(key("wheel", "new_key", "3", true));
    b.stiffness.profiles[0].content_hash = Some("ef01".repeat(16));
    let found = compare(&a, &b).unwrap();
    let names: Vec<&str> = found.inputs.iter().map(|input| input.key.as_str()).collect();
    let second = &samples::inputs()[1];
    let second = if second.section.is_empty() {
        second.key.clone()
    } else {
        format!("{}.{}", second.section, second.key)
    };
    assert_eq!(names.len(), 4, "{names:?}");
    for name in ["program", "content of the wheel file", "wheel.new_key", &second] {
        assert!(names.contains(&name), "{name}: {names:?}");
    }
    assert_eq!(found.inputs.iter().find(|input| input.key == "wheel.new_key").unwrap().a, "\u{2013}");
}

/// Goal: a limit that fails in B alone, one that holds in B alone, and lines of one verdict only are distinguished.
#[test]
fn verdicts_are_matched_line_by_line() {
    let [mut a, mut b] = [side("a"), side("b")];
    a.verdict = Some(verdict(&[
        line("law_max", 0.1, 0.15),
        line("law_rms", 0.2, 0.15),
        line("beam_missing", 0.0, 0.02),
    ]));
    b.verdict =
        Some(verdict(&[line("law_rms", 0.1, 0.15), line("law_max", 0.3, 0.15), line("touches", 0.0, 0.0)]));
    let found = compare(&a, &b).unwrap();
    let changes: Vec<(&str, String)> =
        found.lines.iter().map(|line| (line.meaning.as_str(), line.texts()[2].clone())).collect();
    let expected = [
        ("line law_max", "fails now"),
        ("line law_rms", "holds now"),
        ("line beam_missing", "in A only"),
        ("line touches", "in B only"),
    ];
    assert_eq!(changes, expected.map(|(line, change)| (line, change.to_string())));
    assert!(
        found.summary.iter().any(|s| s == "Limits that hold in A and fail in B: springs: line law_max."),
        "{:?}",
        found.summary
    );
}

/// Goal: lines of one quantity belong together within a load case alone, and the limit stands beside the value; where no state changes, that is said.
#[test]
fn lines_belong_to_their_load_case() {
    let with = |first: f64, second: f64| -> VerificationRecord {
        let of = |name: &str, value: f64| {
            let simple = serde_json::json!({ "degrees_of_freedom": 1, "ending": "completed" });
            serde_json::json!({ "scenario": name, "simple": simple, "lines": [line("touches", value, 0.5)] })
        };
        let mut record = verdict(&[line("touches", 0.25, 0.5)]);
        let of = |name, value| serde_json::from_value(of(name, value)).unwrap();
        record.scenarios = vec![of("one", first), of("two", second)];
        record
    };
    let [mut a, mut b] = [side("a"), side("b")];
    (a.verdict, b.verdict) = (Some(with(0.1, 0.2)), Some(with(0.3, 0.4)));
    b.verdict.as_mut().unwrap().scenarios.reverse();
    let found = compare(&a, &b).unwrap();
    let texts: Vec<(&str, [String; 3])> =
        found.lines.iter().map(|line| (line.subject.as_str(), line.texts())).collect();
    let expected = [("springs", ["0.25", "0.25"]), ("one", ["0.1", "0.3"]), ("two", ["0.2", "0.4"])];
    let expected = expected.map(|(subject, values)| {
        let [a, b] = values.map(|value| format!("{value} (limit 0.5), holds"));
        (subject, [a, b, String::new()])
    });
    assert_eq!(texts, expected);
    assert!(found.summary.iter().any(|s| s == "No limit of both verdicts changes its state."));
}

/// Goal: the summary has the largest change of a group, whether it is beyond, and how many inputs differ beside the first six; a horizontal stiffness is held
/// against its band, and a group of one unit says so once.
#[test]
fn the_summary_has_the_largest_change() {
    let [a, mut b] = [side("a"), side("b")];
    for reference in &mut b.stiffness.references {
        reference.points[0].tangent_kn_per_m *= 1.001;
        let last = reference.points.len() - 1;
        reference.points[last].tangent_kn_per_m *= 0.5;
    }
    b.stiffness.horizontal_kn_per_m = b.stiffness.horizontal_kn_per_m.map(|value| 1.1 * value);
    let keys = &mut b.inputs.as_mut().unwrap().keys;
    keys.extend((0..9).map(|n| ResolvedKey {
        section: "mesh".into(),
        key: format!("key_{n}"),
        value: "1".into(),
        given: true,
    }));
    let found = compare(&a, &b).unwrap();
    let tangent = &found.summary[0];
    assert!(
        tangent.starts_with("Tangent stiffness of the solid: beyond the error bands at 1 of 8")
            && tangent.contains("\u{2212}50 % (at 150 kN: "),
        "{tangent}"
    );
    let displacement = &found.summary[1];
    assert_eq!(displacement, "Displacement of the solid: the same.");
    let horizontal = &found.summary[2];
    assert!(
        horizontal.starts_with("Horizontal stiffness: beyond the error bands; +10 % (k_h: "),
        "{horizontal}"
    );
    assert!(found.summary.last().unwrap().ends_with("mesh.key_5 and 3 more."), "{:?}", found.summary);
    assert_eq!(group(&found, "Tangent stiffness of").unit(), Some("kN/m"));
    assert_eq!(group(&found, "Normal law").unit(), None);

    let [a, mut b] = [side("a"), side("b")];
    b.stiffness = softer(b.stiffness, 1.05, 0.2);
    let found = compare(&a, &b).unwrap();
    assert!(
        found.summary[0].contains("within the error bands at all 8; largest change +5.0 %"),
        "{:?}",
        found.summary
    );
}

/// Goal: stiffness along the contact normal is that of the same shift, load and reference; loads of one side alone have no partner.
#[test]
fn shifts_and_loads_have_their_partners() {
    let [a, mut b] = [side("a"), side("b")];
    let shifts = &mut b.by_angle.as_mut().unwrap().shifts;
    for (n, shift) in shifts.iter_mut().enumerate() {
        for (m, load) in shift.loads.iter_mut().enumerate() {
            for point in &mut load.references {
                point.tangent_kn_per_m *= 1.0 + 0.1 * n as f64 + 0.01 * m as f64;
            }
        }
    }
    shifts[2].loads.remove(1);
    shifts[3].shift_mm = 6.5;
    let found = compare(&a, &b).unwrap();
    let rows = &group(&found, "Tangent stiffness along").rows;
    let changes: Vec<(String, Option<f64>)> =
        rows.iter().map(|row| (row.quantity.clone(), row.change.map(|c| (1e3 * c).round() / 1e3))).collect();
    let expected = [
        ("shift 0 mm (1.4\u{b0} and 1.4\u{b0}) at 20 kN", Some(0.1)),
        ("shift 0 mm (1.4\u{b0} and 1.4\u{b0}) at 40 kN", Some(0.11)),
        ("shift 0 mm (1.4\u{b0} and 1.4\u{b0}) at 80 kN", Some(0.12)),
        ("shift 4 mm (5.8\u{b0} and 5.8\u{b0}) at 20 kN", Some(0.2)),
        ("shift 4 mm (5.8\u{b0} and 5.8\u{b0}) at 40 kN", None),
        ("shift 4 mm (5.8\u{b0} and 5.8\u{b0}) at 80 kN", Some(0.22)),
    ];
    assert_eq!(changes, expected.map(|(name, change)| (name.to_string(), change)));
}

/// Goal: the figure over the contact angle has the smallest, the largest and a middle one of the loads that both have, and a bar is the band to either side.
#[test]
fn figures_have_common_loads_and_bars() {
    let [a, b] = [side("a"), side("b")];
    let mut shifts = b.by_angle.clone().unwrap().shifts;
    let mut others = a.by_angle.clone().unwrap().shifts;
    let more =
        [30.0, 60.0, 70.0, 90.0].map(|force_kn| FixedLoadRecord { force_kn, ..shifts[1].loads[0].clone() });
    others[1].loads.extend(more[..3].iter().cloned());
    shifts[1].loads.extend(more[1..].iter().cloned());
    let pairs: Vec<_> = others.iter().zip(&shifts).map(|(a, b)| [a, b]).collect();
    assert_eq!(page::panel_loads(&pairs), [20.0, 60.0, 80.0]);
    assert!(page::panel_loads(&[]).is_empty());
    let ends = page::ends_of(200.0, 0.1);
    assert!((ends[0] - 180.0).abs() < 1e-9 && (ends[1] - 220.0).abs() < 1e-9, "{ends:?}");
}

/// Goal: a folder is read with the runs of its own load cases, and with its inputs only where they are those of its springs.
#[test]
fn a_folder_is_read_as_it_was_written() {
    let place = tempfile::tempdir().unwrap();
    let folder =
        OutputFolder::create(&place.path().join("out"), &crate::engine::inputs::Inputs::none()).unwrap();
    let read = |calibration: &str| {
        let made = side("a");
        let inputs = InputsRecord { calibration: calibration.into(), ..made.inputs.unwrap() };
        let mut verdict = verdict(&[]);
        let of = |name: &str| {
            let simple = serde_json::json!({ "degrees_of_freedom": 1, "ending": "completed" });
            serde_json::from_value(serde_json::json!({ "scenario": name, "simple": simple, "lines": [] }))
                .unwrap()
        };
        verdict.scenarios = vec![of("one"), of("two")];
        let history = |name: &str, shift: f64| {
            let history = samples::history(shift);
            let rows = history_csv::write(&history);
            NewFile::new(name, rows, "").noted(RUN_NOTE, &RunRecord::bare(&history))
        };
        let files = vec![
            NewFile::new("stiffness.json", to_json(&made.stiffness), ""),
            NewFile::new("inputs.json", to_json(&inputs), ""),
            NewFile::new("verification.json", to_json(&verdict), ""),
            history("history.csv", 0.0),
            history("history-two.csv", 0.01),
        ];
        Results::new(&folder).write(files, &[]).unwrap();
        Side::read(folder.path()).unwrap()
    };
    let found = read(&samples::stiffness().input_hash);
    let names: Vec<&str> = found.runs.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["one", "two"]);
    for ((_, found), shift) in found.runs.iter().zip([0.0, 0.01]) {
        let peak = |history: &History| history.rows.iter().map(|row| row.vertical_force).fold(0.0, f64::max);
        let first = |history: &History| {
            let peak = peak(history);
            history.rows.iter().position(|row| row.vertical_force > 0.99 * peak)
        };
        assert_eq!(first(found), first(&samples::history(shift)), "{shift}");
    }
    assert!(found.keys().is_some());
    assert!(read("another").keys().is_none());
}

/// Goal: what either side lacks is said of it, and so is that no load is in both ranges.
#[test]
fn what_is_missing_is_said() {
    let [mut a, mut b] = [side("a"), side("b")];
    (a.by_angle, b.inputs) = (None, None);
    for reference in &mut a.stiffness.references {
        reference.points.retain(|point| point.force_kn < 30.0);
    }
    for reference in &mut b.stiffness.references {
        reference.points.retain(|point| point.force_kn > 60.0);
    }
    let found = compare(&a, &b).unwrap();
    let expected = [
        "A has no laws by contact angle.",
        "A has no verdict.",
        "B has no verdict.",
        "B has no list of its inputs (inputs.json) that is of these springs.",
    ];
    assert_eq!(found.not_compared[..4], expected.map(String::from));
    assert!(found.not_compared[4].starts_with("No load is in both ranges: A has 1 to "), "{found:?}");
    assert!(found.inputs.is_empty(), "{:?}", found.inputs);
    assert!(found.groups.iter().all(|group| !group.name.starts_with("Tangent stiffness of")));
}

/// Goal: the reference in use of A is compared where B has it, else one that both have; none is an error that names both.
#[test]
fn a_common_reference_is_taken() {
    let [mut a, mut b] = [side("a"), side("b")];
    a.stiffness.reference = "foot".into();
    b.stiffness.references.retain(|found| found.reference != "foot");
    let found = compare(&a, &b).unwrap();
    assert_eq!(found.reference, "beam");
    assert!(found.not_compared.iter().any(|sentence| sentence.starts_with("A uses its law against foot")));
    b.stiffness.references.retain(|found| found.reference == "local");
    a.stiffness.references.retain(|found| found.reference == "foot");
    let said = compare(&a, &b).unwrap_err().to_string();
    assert!(
        said.contains("local") && said.contains("foot") && said.contains("calibration.reference"),
        "{said}"
    );
}

/// Goal: the page has every group, figure and sentence, each figure a text, and both sides in every figure.
#[test]
fn the_page_has_all_of_it() {
    let [mut a, mut b] = [side("a"), side("b")];
    a.runs = vec![("constant".into(), samples::history(0.0))];
    b.runs = vec![("constant".into(), samples::history(0.001))];
    b.stiffness = softer(b.stiffness, 1.2, 0.01);
    a.verdict = Some(verdict(&[line("law_max", 0.1, 0.15), line("law_rms", 0.2, 0.15)]));
    b.verdict = Some(verdict(&[line("law_max", 0.3, 0.15), line("law_rms", 0.2, 0.15)]));
    let found = compare(&a, &b).unwrap();
    let html = page(&a, &b, &found);
    assert!(!html.contains("could not be written"), "{html}");
    assert_eq!(html.matches("<figure id=").count(), 6);
    assert_eq!(html.matches("<svg role=\"img\" aria-label=").count(), 6);
    for name in found.groups.iter().map(|group| group.name.as_str()).chain(["Load case constant", "fails"]) {
        assert!(html.contains(name), "{name}");
    }
    // rows beyond their bands, and limits that fail now, stand out
    let beyond =
        found.groups.iter().flat_map(|group| &group.rows).filter(|row| row.beyond == Some(true)).count();
    assert!(beyond > 8, "{beyond}");
    assert_eq!(html.matches("<tr class=\"fails\">").count(), beyond + 1);
    for figure in html.split("<figure ").skip(1) {
        assert!(figure.contains("A: ") && figure.contains("B: "), "{}", &figure[..200]);
    }
}
