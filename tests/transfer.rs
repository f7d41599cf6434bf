//! One set of constants under other loads, at another place, with other wheels and rails: what each form of it is off the solid.

use assert_cmd::Command;
use railspring::rounding::with_minus_signs;
use serde_json::Value;

/// Studies with the keys that are set, in load cases with an end that is determined.
const CASES: [(&str, &str, &[&str]); 12] = [
    ("4.1", "uic60-s1002", &[]),
    ("mean of 15 kN", "uic60-s1002", &["scenario.constant.vertical_force.mean_kn=15"]),
    ("mean of 25 kN", "uic60-s1002", &["scenario.constant.vertical_force.mean_kn=25"]),
    ("15 Hz", "uic60-s1002", &["scenario.constant.vertical_force.frequency_hz=15"]),
    ("amplitude of 40 kN", "uic60-s1002", &["scenario.constant.vertical_force.amplitude_kn=40"]),
    ("free rotations", "uic60-s1002", &["scenario.constant.rotations_held=false"]),
    ("54E1", "uic60-s1002", &["rail.profile=54E1"]),
    ("1:40 cone", "uic60-s1002", &["wheel.profile=EN13715-1in40"]),
    ("S-shaped web", "uic60-s1002", &["wheel.body=s-web"]),
    ("conical web", "uic60-s1002", &["wheel.body=conical-web"]),
    ("rail of 1 m", "uic60-s1002", &["rail.length_m=1"]),
    ("worn pair", "worn", &[]),
];

/// The case in which the lumped element does not hold: between crown and corner its strips let the contact spread too far.
const SPREADS: (&str, &str, &[&str]) = ("3 mm aside", "uic60-s1002", &["track.lateral_shift_mm=3"]);

/// Source: the transient solid of each study. Goal: the constants of the lumped element hold wherever the
/// calibration goes. P and Q are within a limit (RMS over the solid's peak), averaged Q/P within another
/// (RMS), up to the time to which the solid's own run is determined. One case, which is known, is not.
/// Accuracy: FORCES and RATIO, three times the differences in 4.1; the table is printed.
#[test]
#[ignore = "a quarter of an hour: cargo long transfer"]
fn the_lumped_element_transfers() {
    const FORCES: f64 = 0.05;
    const RATIO: f64 = 0.03;
    let root = tempfile::tempdir().unwrap();
    let mut beyond = Vec::new();
    for (name, study, set) in CASES.into_iter().chain([SPREADS]) {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("data/studies")
            .join(format!("{study}.toml"));
        let mut command = Command::cargo_bin("railspring").unwrap();
        command.current_dir(root.path()).env("RAILSPRING_CACHE", root.path().join("cache"));
        command.args(["run", "-q", "-o", "out"]).arg(path);
        set.iter().for_each(|key| {
            command.args(["--set", key]);
        });
        let output = command.output().unwrap();
        // 1: one of the elements does not keep the study's limits
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(matches!(output.status.code(), Some(0 | 1)), "{name}: {said}");
        let verdict = std::fs::read_to_string(root.path().join("out/verification.json")).unwrap();
        let verdict: Value = serde_json::from_str(&verdict).unwrap();
        let mut row = format!("{name:20}");
        for element in verdict["scenarios"][0]["elements"].as_array().unwrap() {
            let of = |key: &str| element["differences"][key].as_f64();
            let [p, q] = ["vertical_rms", "lateral_rms"].map(|key| of(key).unwrap_or(f64::NAN));
            let [ratio, largest] = ["ratio_rms", "ratio_max"].map(|key| of(key).unwrap_or_default());
            let is = element["element"].as_str().unwrap();
            row += &format!(" | {is} P {:.1}, Q {:.1} %, Q/P {ratio:.3}, {largest:.2}", 1e2 * p, 1e2 * q);
            if is == "lumped" && !(p < FORCES && q < FORCES && ratio < RATIO) {
                beyond.push(name);
            }
        }
        println!("{}", with_minus_signs(&row));
        std::fs::remove_dir_all(root.path().join("out")).unwrap();
    }
    assert_eq!(beyond, [SPREADS.0]);
}
