//! Forces of load cases as sums of sines and as tables over time, on both models: `cargo long forces_over_time`.

use std::f64::consts::TAU;

use railspring::results::run::history_csv;
use railspring::study::Study;
use railspring_simulate::time::history::{Ending, History, HistoryRow};
use railspring_testing::Place;
use serde_json::Value;

/// A pair, coarse but for its contact, and what its load cases have alike.
const PAIR: &str = include_str!("studies/coarse.toml");
const PULSE: &str = include_str!("studies/pulse.csv");

fn place() -> Place {
    Place::new(env!("CARGO_BIN_EXE_railspring"), concat!(env!("CARGO_TARGET_TMPDIR"), "/everyday"))
}

/// A load case of 60 ms on both models, without a suspended mass: forces act on the wheel as they are.
fn case(name: &str, vertical: &str, lateral: &str) -> String {
    format!(
        "[scenario.{name}]\nsteps = 120\nsuspended_mass_t = 0\nsnapshots_s = [0.01]\n\
         vertical_force = {{ {vertical} }}\nlateral_force = {{ {lateral} }}\n"
    )
}

/// The pair with load cases, the contact elements of the solids among its springs.
fn study(cases: &[String]) -> String {
    let pair = PAIR.replace("contact_element_mm = 6", "contact_element_mm = 3");
    let pair = pair.replace("contact_element_along_mm = 6", "contact_element_along_mm = 3");
    pair.replace("shifts_mm = []\n", "") + &cases.concat()
}

fn table(column: &str) -> String {
    format!("table = {{ file = \"pulse.csv\", column = \"{column}\" }}")
}

fn json(place: &Place, file: &str) -> Value {
    serde_json::from_str(&place.read(file)).unwrap()
}

fn history(place: &Place, name: &str) -> History {
    let path = place.path(name);
    history_csv::read(&path, &place.read(name), 0, Ending::Completed).unwrap()
}

const FORCES: [fn(&HistoryRow) -> f64; 2] = [|row| row.vertical_force, |row| row.lateral_force];

/// Largest differences of P and Q of two histories over the largest P of the first.
fn off(a: &History, b: &History) -> [f64; 2] {
    let peak = a.rows.iter().map(|row| row.vertical_force).fold(0.0, f64::max);
    assert_eq!(a.rows.len(), b.rows.len());
    FORCES.map(|force| {
        let off = a.rows.iter().zip(&b.rows).map(|(a, b)| (force(a) - force(b)).abs() / peak);
        off.fold(0.0, f64::max)
    })
}

/// Source: the solid model, and a sine in the place of its samples. Goal: a pulse with a ramp from a file runs on both models, and the forces of the element are within the limits of
/// the verdict: P and Q (RMS, largest) over the solid's peak, and the energy of both. The record of the run has the file with its hash. A table of samples of a sine gives P and Q of the sine on both
/// models. Accuracy of the latter: DISCRETISATION, the chord of a sine is (ω·Δt)²/8 of its amplitude of a quarter of the peak off, three times as much in resonance.
#[test]
#[ignore = "minutes: cargo long forces_over_time"]
fn tables_of_forces_run_on_both_models() {
    const FREQUENCY: f64 = 40.0;
    const DISCRETISATION: f64 = 3.0 * 0.25 * 0.002;
    let sine = |amplitude: f64| format!("amplitude_kn = {amplitude}, frequency_hz = {FREQUENCY}");
    let mut sampled = String::from("t;f;q\n");
    for i in 0..=120 {
        let (time, swing) = (f64::from(i) * 5e-4, (TAU * FREQUENCY * f64::from(i) * 5e-4).sin());
        sampled += &format!("{time};{};{}\n", 20e3 * swing, 4e3 * swing);
    }
    let place = place();
    place.write("pulse.csv", PULSE);
    place.write("sampled.csv", &sampled);
    let samples =
        |column: &str| format!("table = {{ file = \"sampled.csv\", column = \"{column}\", factor = 1e-3 }}");
    let cases = [
        case("pulse", &table("vertical_kn"), &table("lateral_kn")),
        case(
            "sampled",
            &format!("mean_kn = 60, {}", samples("f")),
            &format!("mean_kn = 8, {}", samples("q")),
        ),
        case("sine", &format!("mean_kn = 60, {}", sine(20.0)), &format!("mean_kn = 8, {}", sine(4.0))),
    ];
    place.finish_study(&["run", "-o", "out"], &study(&cases));
    let verdict = json(&place, "out/verification.json");
    let judged = verdict["scenarios"].as_array().unwrap();
    let pulse = judged.iter().find(|of| of["scenario"] == "pulse").unwrap();
    for quantity in ["vertical_rms", "vertical_max", "lateral_rms", "lateral_max", "energy_drift"] {
        let lines = pulse["lines"].as_array().unwrap().iter().filter(|line| line["quantity"] == quantity);
        let lines: Vec<&Value> = lines.collect();
        assert!(!lines.is_empty(), "{quantity}: {pulse}");
        lines.iter().for_each(|line| assert_eq!(line["holds"], true, "{line}"));
    }
    for model in ["simple", "solid"] {
        let read = &pulse[model]["tables"];
        assert_eq!(read[0]["key"], "scenario.pulse.vertical_force.table", "{read}");
        assert_eq!(read[0]["blake3"], blake3::hash(PULSE.as_bytes()).to_hex().as_str(), "{read}");
        assert_eq!(read[1]["key"], "scenario.pulse.lateral_force.table", "{read}");
    }
    for model in ["history", "solid_history"] {
        let of = |case: &str| match case {
            "pulse" => history(&place, &format!("out/{model}.csv")),
            case => history(&place, &format!("out/{model}-{case}.csv")),
        };
        let off = off(&of("sine"), &of("sampled"));
        assert!(off.iter().all(|off| (1e-9..DISCRETISATION).contains(off)), "{model}: {off:?}");
    }
}

/// Goal: what is wrong with a table or a sine of a force is named with key, line and remedy. Times fall, there is a gap, a cell is no number, a table ends before the run, samples are closer than time steps,
/// a column or a file is not there, one sine of several is fast. A sum of what is right has no mistake. No tolerance.
#[test]
fn mistakes_of_forces_are_named() {
    let place = place();
    place.write("pulse.csv", PULSE);
    place.write("falls.csv", "t,f\n0,1\n0.02,2\n0.01,3\n");
    place.write("gap.csv", "t,f\n0,1\n0.01,2\n0.02,3\n0.05,4\n0.06,4\n");
    place.write("hole.csv", "t,f\n0,1\n0.02,\n0.06,4\n");
    place.write("short.csv", "t,f\n0,1\n0.01,2\n");
    let fine: String = (0..=600).map(|i| format!("{},1\n", f64::from(i) * 1e-4)).collect();
    place.write("fine.csv", &format!("t,f\n{fine}"));
    let message_of = |vertical: &str| {
        let text = format!("{PAIR}{}", case("s", vertical, ""));
        place.write("study.toml", &text);
        let mistakes = Study::read(&place.path("study.toml")).err()?;
        assert_eq!(mistakes.all().len(), 1, "{:?}", mistakes.messages());
        Some(mistakes.messages()[0].clone())
    };
    let table = |file: &str| format!("table = {{ file = \"{file}\", column = \"f\" }}");
    let several =
        "harmonics = [{ amplitude_kn = 1, frequency_hz = 10 }, { amplitude_kn = 1, frequency_hz = 200 }]";
    for (vertical, key, said) in [
        (table("falls.csv"), "scenario.s.vertical_force.table.file", "falls.csv:4: 0.01 s after 0.02 s"),
        (table("gap.csv"), "scenario.s.vertical_force.table.file", "nothing between 0.02 and 0.05 s"),
        (table("hole.csv"), "scenario.s.vertical_force.table.file", "hole.csv:3"),
        (
            table("short.csv"),
            "scenario.s.vertical_force.table.file",
            "end the run earlier (`scenario.s.steps`)",
        ),
        (
            table("fine.csv"),
            "scenario.s.vertical_force.table.file",
            "lower `scenario.s.time_step_s` to 1.000e-4 s",
        ),
        (table("none.csv"), "scenario.s.vertical_force.table.file", "readable"),
        (
            table("pulse.csv"),
            "scenario.s.vertical_force.table.column",
            "time_s, slow_s, vertical_kn, lateral_kn",
        ),
        (several.into(), "scenario.s.vertical_force", "200 Hz at time steps of 0.0005 s"),
    ] {
        let message = message_of(&vertical).unwrap_or_else(|| panic!("{vertical} is taken"));
        assert!(message.contains(&format!(": {key} = ")) && message.contains(said), "{vertical}: {message}");
        assert!(message.contains("study.toml:"), "{message}");
    }
    let right = "harmonics = [{ amplitude_kn = 1, frequency_hz = 10 }], table = { file = \"pulse.csv\", column = \"vertical_kn\", over_column = \"slow_s\" }";
    assert_eq!(message_of(right), None);
}
