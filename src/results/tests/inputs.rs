//! Each result depends on its own inputs and on nothing else.

use std::path::Path;

use crate::hash::key;
use crate::results::bodies::input::SolidsInput;
use crate::results::bodies::reach::Reach;
use crate::results::crosscheck::input::CrosscheckInput;
use crate::results::run::input::{SimpleRunInput, SpringsInput};
use crate::results::run::record::SpringsRecord;
use crate::results::run::springs;
use crate::results::samples;
use crate::study::{Study, parts};

const SHORT: &str = "name = \"x\"\n[rail]\nprofile = \"60E1\"\n[wheel]\nprofile = \"S1002\"\n";

fn study(text: &str) -> Study {
    Study::parse(Path::new("x.toml"), text).unwrap_or_else(|mistakes| panic!("{mistakes}"))
}

/// The keys of the results of a study.
struct Keys {
    springs: String,
    pair: String,
    crosscheck: String,
    parts: [String; 3],
    study: Study,
}

impl Keys {
    fn of(text: &str) -> Self {
        let study = study(text);
        let statics = study.statics();
        let (springs, pair, parts) = (key(&statics), statics.pair_key(), parts(&statics));
        let crosscheck = CrosscheckInput::of(&study).key();
        Self { springs, pair, crosscheck, parts, study }
    }

    /// That of a load case on the simple model with springs of a mass of the wheel, kg.
    fn simple(&self, case: &str, wheel_mass_kg: f64) -> String {
        let published = study(&format!("{SHORT}[simulation]\nelement = \"published\"\n"));
        let springs = springs::springs_of_study(&SpringsInput::of(&published), &samples::stiffness(), None);
        let springs = SpringsRecord { wheel_mass_kg, ..springs.unwrap() };
        let input = SimpleRunInput::of(&self.study, &self.study.scenarios[case]);
        input.address(&springs).key().into()
    }

    /// That of a load case on the solids, which begins with zones that reach as the study says.
    fn solid(&self, case: &str) -> String {
        let input = SolidsInput::of(&self.study);
        let run = input.run(&self.study.scenarios[case]);
        run.address(Reach::of(&Default::default(), 0)).key().into()
    }
}

#[test]
fn the_hash_sees_what_the_numbers_depend_on_and_nothing_else() {
    let hash = |more: &str| Keys::of(&format!("{SHORT}{more}")).crosscheck;
    let plain = hash("");
    assert_eq!(plain, hash("# a comment\n"));
    assert_eq!(plain, hash("[track]\ngauge_mm = 1435.0\n"), "a default that is written out");
    assert_eq!(plain, hash("[verification]\nvertical_rms = 0.5\n"));
    assert_eq!(plain, hash("[contact]\nfield = \"elements\"\n"), "a cross-check has elements");
    assert_eq!(plain, hash("[output]\nvertical = \"up\"\n"));
    assert_eq!(plain, hash("[solid]\ntransient = \"full\"\n"), "a cross-check is static");
    assert_ne!(plain, hash("[track]\ngauge_mm = 1436\n"));
    assert_ne!(plain, hash("[mesh]\nelement = \"full-integration\"\n"));
    // layers that are given keep their depth on finer meshes, those that follow from the elements do not
    let mesh = |keys: &str| hash(&format!("[mesh]\n{keys}"));
    assert_ne!(plain, mesh("layers = 2\nfirst_layer_mm = 2\n"));
    assert_ne!(plain, mesh("layers = 4\n"));
    assert_ne!(plain, mesh("first_layer_mm = 1.8\n"));
}

/// Goal: each result depends on its own inputs and on nothing else; a change makes exactly those stale that it concerns.
#[test]
fn every_result_has_a_key_of_its_own_inputs() {
    const LOADS: &str = "vertical_force = {}\nlateral_force = {}\n";
    let keys = |more: &str| {
        let (one, rest) = more.split_once('|').unwrap_or(("", more));
        let text = format!("{SHORT}{rest}\n[scenario.one]\n{LOADS}{one}\n[scenario.two]\n{LOADS}");
        Keys::of(&text)
    };
    let names = ["springs", "pair", "simple one", "solid one", "simple two"];
    let all = |more: &str| {
        let k = keys(more);
        [k.springs.clone(), k.pair.clone(), k.simple("one", 1.0), k.solid("one"), k.simple("two", 1.0)]
    };
    let plain = all("");
    for (more, changed) in [
        ("# a comment\n", &[][..]),
        ("description = \"other\"\nsnapshots_s = [0.1]\nsolid = false\nratio_limit = 0.8\n|", &[]),
        ("[simulation]\nscenario = \"two\"\n", &[]),
        ("[verification]\nvertical_rms = 0.5\n", &[]),
        ("steps = 20\n|", &["simple one", "solid one"]),
        ("[calibration]\nload_max_kn = 140\n", &["springs"]),
        ("[calibration]\nfoot_held = true\n", &["springs"]),
        ("[simulation]\nrail_elements = 10\n", &["springs", "simple one", "simple two"]),
        ("[simulation]\nlaw = \"published\"\n", &["simple one", "simple two"]),
        ("[solid]\ntransient = \"full\"\n", &["solid one"]),
        ("[solid]\nmodes = 40\n", &["solid one"]),
        ("[output]\nvertical = \"up\"\n", &[]),
        ("[mesh]\ngrowth = 1.5\n", &["springs", "solid one"]),
        ("[contact]\nfield = \"elements\"\n", &["springs", "solid one"]),
        ("[material]\ndamping_ratio = 0\n", &["simple one", "solid one", "simple two"]),
        ("[track]\nlateral_shift_mm = 1\n", &["springs", "pair", "simple one", "solid one", "simple two"]),
    ] {
        let found: Vec<&str> = names
            .iter()
            .zip(plain.iter().zip(all(more)))
            .filter(|(_, (a, b))| *a != b)
            .map(|(n, _)| *n)
            .collect();
        assert_eq!(found, changed, "{more}");
    }
    assert_ne!(keys("").simple("one", 1.0), keys("").simple("one", 2.0), "other springs");
    assert_ne!(keys("").simple("one", 1.0), keys("").solid("one"));
}

/// Goal: equal materials have equal keys, whichever table gives them; a body's material makes stale what hangs on it, and a table names that body as the cause.
#[test]
fn equal_materials_have_equal_keys() {
    const CASE: &str = "[scenario.one]\nvertical_force = {}\nlateral_force = {}\n";
    let keys = |more: &str| Keys::of(&format!("{SHORT}{CASE}{more}"));
    let plain = keys("");
    for same in [
        "[wheel.material]\n",
        "[wheel.material]\nyoung_gpa = 210\npoisson = 0.3\ndensity_kg_per_m3 = 7850\n",
        "[rail.material]\nyoung_gpa = 210\n",
    ] {
        assert_eq!(keys(same).study.statics(), plain.study.statics(), "{same}");
    }
    let doubled = keys("[material]\nyoung_gpa = 420\n");
    let by_tables = keys("[wheel.material]\nyoung_gpa = 420\n[rail.material]\nyoung_gpa = 420\n");
    assert_eq!((&by_tables.springs, &by_tables.pair), (&doubled.springs, &doubled.pair));
    assert_eq!(by_tables.crosscheck, doubled.crosscheck);
    assert_eq!(by_tables.simple("one", 1.0), doubled.simple("one", 1.0));
    assert_eq!(by_tables.solid("one"), doubled.solid("one"));
    assert_eq!(
        keys("[material]\nyoung_gpa = 200\n[wheel.material]\nyoung_gpa = 210\n").pair,
        keys("[rail.material]\nyoung_gpa = 200\n").pair
    );
    for (more, part) in [
        ("[wheel.material]\nyoung_gpa = 200\n", &[0][..]),
        ("[rail.material]\nyoung_gpa = 200\n", &[1]),
        ("[material]\nyoung_gpa = 200\n", &[0, 1]),
    ] {
        let found = keys(more);
        assert_ne!(found.springs, plain.springs, "{more}");
        assert_ne!(found.pair, plain.pair, "{more}");
        assert_ne!(found.crosscheck, plain.crosscheck, "{more}");
        assert_ne!(found.simple("one", 1.0), plain.simple("one", 1.0), "{more}");
        assert_ne!(found.solid("one"), plain.solid("one"), "{more}");
        let changed: Vec<usize> = (0..3).filter(|&i| found.parts[i] != plain.parts[i]).collect();
        assert_eq!(changed, part, "{more}");
    }
    assert_ne!(
        keys("[wheel.material]\nyoung_gpa = 200\n").springs,
        keys("[rail.material]\nyoung_gpa = 200\n").springs
    );
    // a law does not depend on masses
    for body in ["wheel", "rail"] {
        let heavier = keys(&format!("[{body}.material]\ndensity_kg_per_m3 = 8000\n"));
        assert_eq!(heavier.pair, plain.pair, "{body}");
        assert_ne!(heavier.springs, plain.springs, "{body}");
        assert_ne!(heavier.simple("one", 1.0), plain.simple("one", 1.0), "{body}");
    }
}
