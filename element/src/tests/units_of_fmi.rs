//! The description of a functional mock-up unit.

use super::element;
use crate::variables::{Variable, model_description};

/// Goal: every reference of the description belongs to one variable, which has that reference, and every variable that is listed in the structure is described. That the whole suits the standard is FMPy's to say.
#[test]
fn references_are_those_of_the_variables() {
    let element = element();
    let text = model_description(&element, "0.1.0");
    let modes = element.wheel.modes.len();
    let references = |line: &str| -> u32 {
        let (_, rest) = line.split_once("valueReference=\"").unwrap();
        rest.split_once('"').unwrap().0.parse().unwrap()
    };
    let described: Vec<u32> = text
        .lines()
        .filter(|line| line.contains(" name=") && line.contains("valueReference"))
        .map(references)
        .collect();
    assert!(described.len() > 40);
    for (i, reference) in described.iter().enumerate() {
        assert!(!described[..i].contains(reference), "{reference} twice");
        assert_eq!(Variable::of(*reference, modes).unwrap().reference(), *reference);
    }
    let structure = text.lines().filter(|line| line.contains("<Output") || line.contains("<Initial"));
    for line in structure {
        assert!(described.contains(&references(line)), "{line}");
    }
    for unused in [34, 39, 55, 999, 1006, 2006, 5000] {
        assert!(Variable::of(unused, modes).is_none(), "{unused}");
    }
    // a name of a study is somebody's text
    let mut element = element;
    element.about.study = "a <b> & \"c\"".into();
    assert!(model_description(&element, "0").contains("modelName=\"a &lt;b> &amp; &quot;c&quot;\""));
}
