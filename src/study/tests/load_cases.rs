//! What a load case says of itself: where it ends, and what was not given.

use super::*;

/// Goal: a load case says which parts of its suspension are the publication's because the study gives none, with keys, values and units; one
/// that gives them, or has no suspended mass, says nothing of them.
#[test]
fn a_suspension_that_is_not_given_is_said_to_be_the_publications() {
    let notes = |keys: &str| {
        let text = format!("{SHORT}[scenario.s]\nvertical_force = {{}}\nlateral_force = {{}}\n{keys}");
        parse(&text).unwrap().scenarios["s"].notes.clone()
    };
    let all = notes("");
    assert_eq!(all.len(), 1, "{all:?}");
    assert!(
        all[0].starts_with(
            "`scenario.s.suspended_mass_t` is 6.25 t, `scenario.s.vertical_suspension` is 1200 kN/m and 40 kN\u{b7}s/m, \
             `scenario.s.lateral_suspension` is 1200 kN/m and 40 kN\u{b7}s/m: not given, and taken from the publication (Ju, 2016)"
        ),
        "{}",
        all[0]
    );
    const SPRING: &str = "= { stiffness_kn_per_m = 1200, damping_kn_s_per_m = 40 }\n";
    let mass = notes(&format!("vertical_suspension {SPRING}lateral_suspension {SPRING}"));
    assert!(mass[0].starts_with("`scenario.s.suspended_mass_t` is 6.25 t: not given"), "{}", mass[0]);
    let given = format!("suspended_mass_t = 6.25\nvertical_suspension {SPRING}lateral_suspension {SPRING}");
    assert_eq!(notes(&given), [""; 0], "the same values, given");
    assert_eq!(notes(&format!("suspended_mass_t = 0\nlateral_suspension {SPRING}")), [""; 0]);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/studies");
    for study in ["uic60-s1002.toml", "uic60-s1002-sine.toml"] {
        let study = Study::read(&folder.join(study)).unwrap();
        for (name, case) in study.scenarios {
            let suspension = case.notes.iter().filter(|note| note.contains("not given")).count();
            assert_eq!(suspension, 0, "{name}: {:?}", case.notes);
        }
    }
}

/// Goal: a load case that runs to the rail's end says when and where that is, and with which keys it would go on; the rail that the note asks for is long
/// enough. Forces beyond the calibrated loads are said with both keys.
#[test]
fn a_load_case_says_its_rail_end_and_its_loads_beyond_the_calibration() {
    const GIVEN: &str = "suspended_mass_t = 0\nsolid = false\nlateral_suspension = { stiffness_kn_per_m = 0, damping_kn_s_per_m = 0 }\n";
    let of = |rail: &str, forces: &str| {
        let text =
            format!("{}[scenario.s]\n{GIVEN}{forces}", SHORT.replace("[wheel]", &format!("{rail}[wheel]")));
        parse(&text).unwrap().scenarios["s"].notes.clone()
    };
    let run = "vertical_force = { mean_kn = 50 }\nlateral_force = {}\nsteps = 200\nstart_x_m = 0.5\nspeed_m_per_s = 2\n";
    let end = of("", run);
    assert_eq!(end.len(), 1, "{end:?}");
    assert!(
        end[0].starts_with("at 0.02750 of 0.1000 s the wheel is at the end of the rail (x = 0.555 m)"),
        "{}",
        end[0]
    );
    for key in [
        "`rail.length_m` = 0.7",
        "`scenario.s.steps`",
        "`scenario.s.speed_m_per_s`",
        "`scenario.s.start_x_m`",
    ] {
        assert!(end[0].contains(key), "{key}: {}", end[0]);
    }
    assert_eq!(of("length_m = 0.7\n", run), [""; 0], "on the rail that it asks for");

    let heavy =
        |mean: f64| of("", &format!("vertical_force = {{ mean_kn = {mean} }}\nlateral_force = {{}}\n"));
    assert_eq!(heavy(150.0), [""; 0], "the largest load of the calibration");
    let beyond = heavy(400.0).remove(0);
    assert!(
        beyond.starts_with("`scenario.s.vertical_force`: forces and weights are 400.0 kN together"),
        "{beyond}"
    );
    assert!(beyond.contains("up to 150.0 kN: calibrate up to it (`calibration.load_max_kn`)"), "{beyond}");
    assert_eq!(heavy(-400.0), [""; 0], "it lifts the wheel");
    let absurd = heavy(10_000.0).remove(0);
    assert!(
        absurd.ends_with("lower the force (`calibration.load_max_kn` goes up to 1000 at most)"),
        "{absurd}"
    );
}
