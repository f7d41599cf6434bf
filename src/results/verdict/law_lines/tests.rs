use std::path::Path;

use super::*;
use crate::results::samples;
use crate::study::Study;

fn study(law: &str) -> Study {
    let text = format!(
        "name = \"x\"\n[rail]\nprofile = \"60E1\"\n[wheel]\nprofile = \"S1002\"\n[simulation]\nlaw = {law:?}\n\
         [scenario.s]\nvertical_force = {{}}\nlateral_force = {{}}\n"
    );
    Study::parse(Path::new("x.toml"), &text).unwrap_or_else(|e| panic!("{e}"))
}

/// A calibration whose law in use is 20 % off the tangent and 30 % off the displacement at its first load, half a percent beyond.
fn off_at_the_first_load(law: &str) -> StiffnessRecord {
    let mut stiffness = samples::stiffness();
    let reference = stiffness.reference.clone();
    let in_use = stiffness.references.iter_mut().find(|r| r.reference == reference).unwrap();
    let form = in_use.forms.iter_mut().find(|of| of.law.form().name() == law).unwrap();
    for (n, at) in form.off.iter_mut().enumerate() {
        (at.tangent, at.displacement) = if n == 0 { (Some(0.2), -0.3) } else { (Some(-0.005), 0.004) };
    }
    form.tangent = farthest(form.off.iter(), |at| at.tangent);
    form.displacement = farthest(form.off.iter(), |at| Some(at.displacement)).unwrap();
    stiffness
}

/// Goal: the loads that the load cases use decide. A law that is off at 1 kN fails over its whole range and
/// where a run comes down to it. It holds from 20 to 90 kN, where its line still gives its error elsewhere.
/// Between two loads those beside count.
#[test]
fn the_loads_used_decide() {
    for (key, form) in [("calibrated", "power"), ("steps", "steps")] {
        let (study, stiffness) = (study(key), off_at_the_first_load(form));
        let input = VerdictInput::of(&study);
        for used in [None, Some([0.0, 90.0]), Some([1.05, 90.0])] {
            let [tangent, displacement] = law_lines(&input, &stiffness, used);
            assert!((tangent.value, tangent.holds) == (Some(0.2), false), "{used:?} {tangent:?}");
            assert!(
                (displacement.value, displacement.holds) == (Some(0.3), false),
                "{used:?} {displacement:?}"
            );
        }
        let [tangent, displacement] = law_lines(&input, &stiffness, Some([20.0, 90.0]));
        assert!((tangent.value, tangent.holds) == (Some(0.005), true), "{tangent:?}");
        assert!((displacement.value, displacement.holds) == (Some(0.004), true), "{displacement:?}");
        let note = displacement.note.unwrap();
        for part in [
            &format!("form `{form}`")[..],
            "run from 20.0 to 90.0 kN",
            "fitted from 1.00 to 150 kN, 30 % off at 1.00 kN",
            "within 3.0 % from 1.24 kN on",
        ] {
            assert!(note.contains(part), "{part:?} in {note}");
        }
    }
}

/// Goal: the form is that which the load cases run with, and the table without any; beside the published constants it is the power. A table's line is that of the others at each load.
#[test]
fn the_form_is_that_in_use() {
    for (key, form) in [("series", Form::Series), ("calibrated", Form::Power), ("published", Form::Power)] {
        let mut study = study(key);
        assert_eq!(form_in_use(&VerdictInput::of(&study)), form);
        study.scenarios.clear();
        let input = VerdictInput::of(&study);
        assert_eq!(form_in_use(&input), Form::Table);
        let [tangent, _] = law_lines(&input, &off_at_the_first_load("power"), None);
        assert!(tangent.holds && tangent.note.unwrap().starts_with("form `table` at "));
    }
}

/// Goal: a form that the calibration does not have is a line without a value, which fails.
#[test]
fn a_form_that_is_missing_fails() {
    let mut stiffness = samples::stiffness();
    stiffness.references.iter_mut().for_each(|r| r.forms.retain(|of| of.law.form().name() != "steps"));
    let study = study("steps");
    for line in law_lines(&VerdictInput::of(&study), &stiffness, None) {
        assert!(line.value.is_none() && !line.holds, "{line:?}");
    }
}
