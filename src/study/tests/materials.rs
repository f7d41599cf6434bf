//! Materials of the bodies: what they are, what their keys are worth, and what is refused.

use railspring_calibrate::solid::Material;

use super::{SHORT, message, parse};

/// Goal: each key of a body's material is that of `[material]` unless the body has its own (Pa, kg/m³); damping (s) is one. Groups of a mesh without keys are tested with
/// their meshes.
#[test]
fn a_body_has_its_own_material_or_that_of_both() {
    let study = |more: &str| parse(&format!("{SHORT}{more}")).unwrap();
    let both = study("[material]\nyoung_gpa = 200\ndamping_ratio = 0.05\n");
    assert_eq!(both.rail.material, both.wheel.material);
    assert_eq!((both.rail.material.young, both.rail.material.poisson), (200e9, 0.3));
    let own = study(
        "[material]\nyoung_gpa = 200\n[wheel.material]\nyoung_gpa = 110\npoisson = 0.26\n[rail.material]\ndensity_kg_per_m3 = 7900\n",
    );
    let damping = own.damping();
    let of_rail = Material { young: 200e9, poisson: 0.3, density: 7900.0, damping };
    let of_wheel = Material { young: 110e9, poisson: 0.26, density: 7850.0, damping };
    assert_eq!(own.materials(), [&of_rail, &of_wheel]);
    assert_eq!(own.rail.materials, of_rail.into());
    assert_eq!(own.wheel.materials, of_wheel.into());
    let echoed: Vec<_> = own.resolved.iter().filter(|key| key.section.ends_with(".material")).collect();
    let echoed: Vec<_> =
        echoed.iter().map(|k| (k.section.as_str(), k.key.as_str(), k.value.as_str())).collect();
    let expected = [
        ("rail.material", "density_kg_per_m3", "7900"),
        ("wheel.material", "poisson", "0.26"),
        ("wheel.material", "young_gpa", "110"),
    ];
    assert_eq!(echoed, expected);
}

/// Goal: equal materials have equal keys, whichever table gives them; one body's material makes stale what hangs on it, and a table names that body as the cause.
#[test]
fn equal_materials_have_equal_keys() {
    const CASE: &str = "[scenario.one]\nvertical_force = {}\nlateral_force = {}\n";
    let keys = |more: &str| parse(&format!("{SHORT}{CASE}{more}")).unwrap().keys;
    let plain = keys("");
    for same in [
        "[wheel.material]\n",
        "[wheel.material]\nyoung_gpa = 210\npoisson = 0.3\ndensity_kg_per_m3 = 7850\n",
        "[rail.material]\nyoung_gpa = 210\n",
    ] {
        assert_eq!(keys(same), plain, "{same}");
    }
    let doubled = keys("[material]\nyoung_gpa = 420\n");
    let by_tables = keys("[wheel.material]\nyoung_gpa = 420\n[rail.material]\nyoung_gpa = 420\n");
    assert_eq!((&by_tables.springs, &by_tables.pair), (&doubled.springs, &doubled.pair));
    assert_eq!(by_tables.crosscheck, doubled.crosscheck);
    assert_eq!(by_tables.simple("one", &1), doubled.simple("one", &1));
    assert_eq!(by_tables.solid("one"), doubled.solid("one"));
    assert_eq!(
        keys("[material]\nyoung_gpa = 200\n[wheel.material]\nyoung_gpa = 210\n").pair,
        keys("[rail.material]\nyoung_gpa = 200\n").pair
    );
    for (more, part) in [
        ("[wheel.material]\nyoung_gpa = 200\n", 0),
        ("[rail.material]\nyoung_gpa = 200\n", 1),
        ("[material]\nyoung_gpa = 200\n", 2),
    ] {
        let found = keys(more);
        assert_ne!(found.springs, plain.springs, "{more}");
        assert_ne!(found.pair, plain.pair, "{more}");
        assert_ne!(found.crosscheck, plain.crosscheck, "{more}");
        assert_ne!(found.simple("one", &1), plain.simple("one", &1), "{more}");
        assert_ne!(found.solid("one"), plain.solid("one"), "{more}");
        let changed: Vec<usize> = (0..3).filter(|&i| found.parts[i] != plain.parts[i]).collect();
        assert_eq!(changed, [part], "{more}");
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
        assert_ne!(heavier.simple("one", &1), plain.simple("one", &1), "{body}");
    }
}

/// Goal: what a body's material cannot be is refused with line, key, value, expectation and remedy.
#[test]
fn wrong_materials_of_bodies_are_refused() {
    for body in ["rail", "wheel"] {
        let refused = |key: &str| message(&format!("[{body}.material]\n{key}\n"));
        for (key, expected) in [
            ("young_gpa = -210", "a number from 1 to 1000"),
            ("young_gpa = 0", "a number from 1 to 1000"),
            ("poisson = 0.5", "a number from 0 to 0.49"),
            ("density_kg_per_m3 = -1", "a number from 100 to 30000"),
            ("young_gpa = \"210 GPa\"", "a number from 1 to 1000"),
        ] {
            let text = refused(key);
            assert!(
                text.starts_with(&format!("x.toml:7: {body}.material.{key}: expected {expected}")),
                "{text}"
            );
            assert!(text.contains("this key is: "), "{text}");
        }
        let misspelt = refused("yuong_gpa = 200");
        assert!(misspelt.contains(&format!("expected a key of [{body}.material] (")), "{misspelt}");
        assert!(misspelt.ends_with(&format!("did you mean `{body}.material.young_gpa`?")), "{misspelt}");
        // the contact between the bodies has one damping
        let damping = refused("damping_ratio = 0.03");
        assert!(damping.ends_with("it belongs to `material.damping_ratio`"), "{damping}");
    }
}
