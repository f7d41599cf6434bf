//! Built-in bodies with materials of their own: `[rail.material]` and `[wheel.material]` beside `[material]`.

use serde_json::Value;

use super::{cache, displacements, has, mass};

/// Both elements in a load case that turns the wheel against its axle.
const STUDY: &str = include_str!("../studies/coarse.toml");
const CASE: &str = "[scenario.push]\nsteps = 24\nvertical_force = { mean_kn = 40 }\nlateral_force = { mean_kn = 10 }\nrotations_held = false\nsolid = false\n";
const CAST_IRON: &str = "[wheel.material]\nyoung_gpa = 110\npoisson = 0.26\ndensity_kg_per_m3 = 7200\n";

/// A folder with a store of its own.
fn place() -> railspring_testing::Place {
    railspring_testing::Place::new(env!("CARGO_BIN_EXE_railspring"), cache())
}

/// What the list of an output folder has in it, without files that have times and without the keys of the study: name and content.
fn contents(place: &railspring_testing::Place, folder: &str) -> Vec<(String, String)> {
    let list: Value = serde_json::from_str(&place.read(&format!("{folder}/results.json"))).unwrap();
    let files = list["files"].as_object().unwrap().iter().filter(|(_, entry)| !entry["blake3"].is_null());
    let made = files.filter(|(name, _)| *name != "inputs.json");
    made.map(|(name, _)| (name.clone(), place.read(&format!("{folder}/{name}")))).collect()
}

/// The files of a calibration and of the runs of both elements.
fn simulated(more: &str) -> Vec<(String, String)> {
    let place = place();
    let study = STUDY.replace("shifts_mm = []", "shifts_mm = [0]") + CASE + more;
    place.finish_study(&["calibrate", "-o", "out"], &study);
    place.finish_study(&["simulate", "-o", "out"], &study);
    contents(&place, "out")
}

fn calibrated(study: &str) -> Value {
    let place = place();
    place.finish_study(&["calibrate", "-o", "out"], study);
    serde_json::from_str(&place.read("out/stiffness.json")).unwrap()
}

/// Goal: `[wheel.material]` equal to `[material]` changes no byte of springs, laws by contact angle and histories, and the modulus of both bodies doubled by two tables is that
/// of `[material]` doubled; stores are empty, so that all of it is made.
#[test]
#[ignore = "a quarter of a minute: cargo long wheel_materials"]
fn which_table_gives_a_material_changes_nothing() {
    let same = |one: &[(String, String)], other: &[(String, String)]| {
        let names =
            |files: &[(String, String)]| files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
        assert_eq!(names(one), names(other));
        assert!(one.iter().any(|(name, _)| name.ends_with("history.csv")), "{:?}", names(one));
        for ((name, one), (_, other)) in one.iter().zip(other) {
            assert!(one == other, "{name}");
        }
    };
    let plain = simulated("");
    same(&plain, &simulated("[wheel.material]\nyoung_gpa = 210\npoisson = 0.3\ndensity_kg_per_m3 = 7850\n"));
    let doubled = simulated("[material]\nyoung_gpa = 420\n");
    assert!(doubled != plain);
    same(&doubled, &simulated("[rail.material]\nyoung_gpa = 420\n[wheel.material]\nyoung_gpa = 420\n"));
}

/// Source: half-spaces with next to no friction, whose approach under loads in the ratio of the contact moduli is the same, whatever the shape of the gap; Hertz, whose tangent under one load is as the modulus to two
/// thirds. Goal: the approach (m) of `local` of a wheel on a rail a thousand times as stiff, beside two bodies of steel, and the tangent of `touch` (kN/m). Accuracy: MODEL, the
/// bodies beyond their half-spaces, which turn and curve the surfaces otherwise; ROUNDOFF of powers.
#[test]
#[ignore = "a quarter of a minute: cargo long wheel_materials"]
fn a_stiff_rail_leaves_the_wheel_its_modulus() {
    const MODEL: f64 = 0.01;
    const ROUNDOFF: f64 = 1e-9;
    let plane = |young: f64| young / (1.0 - 0.3 * 0.3);
    let ratio = 1.0 / (1.0 / plane(1000.0) + 1.0 / plane(1.0)) / (0.5 * plane(210.0));
    let loads = [5.0, 20.0, 50.0, 85.0];
    let study = |loads: [f64; 4], more: &str| {
        let range = "load_min_kn = 5\nload_max_kn = 85\nload_count = 5\n";
        STUDY.replace(range, &format!("loads_kn = {loads:?}\n")).replace("friction = 0.5", "friction = 0.01")
            + more
    };
    let steel = calibrated(&study(loads, ""));
    let hard = "[rail.material]\nyoung_gpa = 1000\n[wheel.material]\nyoung_gpa = 1\n";
    let hard = calibrated(&study(loads.map(|load| ratio * load), hard));
    let hertz = |record: &Value| record["touch"]["hertz_kn_per_m"].as_f64().unwrap();
    assert!((hertz(&hard) / hertz(&steel) / ratio.powf(2.0 / 3.0) - 1.0).abs() < ROUNDOFF);
    let [steel, hard] = [steel, hard].map(|record| displacements(&record, "local"));
    assert_eq!(steel.len(), 4);
    for ([load, of_steel], [less, of_hard]) in steel.into_iter().zip(hard) {
        assert!((less / load / ratio - 1.0).abs() < ROUNDOFF, "{less} N");
        println!("{load} N: {:.4}", of_hard / of_steel);
        assert!((of_hard / of_steel - 1.0).abs() < MODEL, "{load} N: {of_steel} {of_hard}");
    }
}

/// Goal: a wheel of cast iron on a rail of steel has its own mass (kg), goes to the deck for CalculiX with its own constants (MPa, t/mm³) and to CONTACT with both (G in MPa).
/// Accuracy: ROUNDOFF of sums over elements.
#[test]
fn the_materials_of_both_bodies_reach_other_programs() {
    const ROUNDOFF: f64 = 1e-12;
    let place = place();
    let study = STUDY.to_owned() + CAST_IRON;
    let steel = calibrated(STUDY);
    place.finish_study(&["calibrate", "-o", "out"], &study);
    let iron: Value = serde_json::from_str(&place.read("out/stiffness.json")).unwrap();
    assert!((mass(&iron) / mass(&steel) / (7200.0 / 7850.0) - 1.0).abs() < ROUNDOFF);
    place.finish_study(&["deck", "--format", "calculix", "-o", "deck"], &study);
    has(
        &place.read("deck/calculix.inp"),
        &[
            "*MATERIAL, NAME=RAIL\n*ELASTIC\n2.100000000000e5, 0.3\n*DENSITY\n7.85",
            "*MATERIAL, NAME=WHEEL\n*ELASTIC\n1.100000000000e5, 0.26\n*DENSITY\n7.2",
        ],
    );
    let output = place.run(&[
        "export",
        "out/stiffness.json",
        "--to",
        "contact",
        "--study",
        "study.toml",
        "-o",
        "contact",
    ]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    has(&place.read("contact/contact.inp"), &["0.3 0.26 80769.231 43650.794   POISS 1,2, GG 1,2"]);
}

/// Source: the reference solver, which shares no code with the tool. Goal: a wheel of cast iron on a rail of steel, with friction and without, displacements and forces on the same mesh.
#[test]
#[ignore = "a minute: cargo long wheel_materials"]
fn the_reference_solver_agrees_on_two_materials() {
    if !railspring_testing::python() {
        return;
    }
    let place = place();
    place.finish_study(&["crosscheck", "-o", "out"], &(STUDY.to_owned() + CAST_IRON));
    let record: Value = serde_json::from_str(&place.read("out/crosscheck.json")).unwrap();
    let checks = record["checks"].as_array().unwrap();
    let same: Vec<&Value> =
        checks.iter().filter(|check| check["problem"].as_str().unwrap().contains("same mesh")).collect();
    let failing: Vec<_> = same.iter().filter(|check| check["holds"] != true).collect();
    assert!(same.len() > 10 && failing.is_empty(), "{failing:?}");
}
