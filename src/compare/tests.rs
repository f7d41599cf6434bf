//! Made-up results side by side.

use std::path::Path;

use super::*;
use crate::records::{InputsRecord, ResolvedKey, StiffnessRecord, VerificationRecord};
use crate::report::samples;

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
    let found = compare(&a, &b).unwrap();
    let html = page(&a, &b, &found);
    assert!(!html.contains("could not be written"), "{html}");
    assert_eq!(html.matches("<figure id=").count(), 6);
    assert_eq!(html.matches("<svg role=\"img\" aria-label=").count(), 6);
    for name in found.groups.iter().map(|group| group.name.as_str()).chain(["Load case constant", "fails"]) {
        assert!(html.contains(name), "{name}");
    }
    for figure in html.split("<figure ").skip(1) {
        assert!(figure.contains("A: ") && figure.contains("B: "), "{}", &figure[..200]);
    }
}
