//! Materials of the bodies: what they are, what their keys mean, and what is refused.

use railspring_calibrate::solid::Material;

use super::super::Study;
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
    // the damping, which the statics do not have, is that of both
    let undamped = Material { damping: 0.0, ..Material::STEEL };
    let of_rail = Material { young: 200e9, density: 7900.0, ..undamped };
    let of_wheel = Material { young: 110e9, poisson: 0.26, ..undamped };
    assert_eq!(own.statics().materials(), [&of_rail, &of_wheel]);
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

/// Goal: what a body's material cannot be is refused with line, key, value, expectation and remedy.
#[test]
fn wrong_materials_of_bodies_are_refused() {
    for body in ["rail", "wheel"] {
        let refused = |key: &str| message(&format!("[{body}.material]\n{key}\n"));
        for (key, expected) in [
            ("young_gpa = -210", "a number from 20 to 1000"),
            ("young_gpa = 0", "a number from 20 to 1000"),
            ("poisson = 0.5", "a number from 0 to 0.49"),
            ("density_kg_per_m3 = -1", "a number from 100 to 30000"),
            ("young_gpa = \"210 GPa\"", "a number from 20 to 1000"),
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

/// Goal: a group of a mesh whose section has no keys has the material of the body that it belongs to, not that of `[material]` (Pa, kg/m³).
#[test]
fn a_group_without_keys_has_the_material_of_its_body() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("wheel.msh"), "1").unwrap();
    let text = "name = \"x\"\n[rail]\nprofile = \"60E1\"\n[wheel]\nprofile = \"S1002\"\nmesh_file = \"wheel.msh\"\n\
        contact_surface = \"tread\"\nheld_nodes = \"bore\"\n[wheel.material]\nyoung_gpa = 110\npoisson = 0.26\n\
        [wheel.materials.tyre]\n[wheel.materials.centre]\nyoung_gpa = 70\npoisson = 0.33\ndensity_kg_per_m3 = 2700\n";
    let study = Study::parse(&folder.path().join("x.toml"), text).unwrap_or_else(|m| panic!("{m}"));
    let groups = &study.wheel.mesh.as_ref().unwrap().groups;
    let of = |name: &str| {
        let at = groups.iter().position(|group| group == name).unwrap();
        study.wheel.materials.of_groups()[at]
    };
    let own = study.wheel.material;
    assert_eq!((own.young, own.poisson, own.density), (110e9, 0.26, 7850.0));
    assert_eq!(of("tyre"), own);
    assert_eq!(of("centre"), Material { young: 70e9, poisson: 0.33, density: 2700.0, damping: 0.0 });
}
