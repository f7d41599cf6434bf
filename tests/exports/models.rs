//! The lumped element under a load case as models of other programs.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use tempfile::TempDir;

use super::{export_of, railspring, said, text};

/// Rows of the load case: through the first impacts on the flange.
const ROWS: usize = 120;

/// Load case 4.1 of the publication to 60 ms, without the solid.
const CASE: &str = r#"
[scenario.pushed]
description = "Constant lateral force, vertical force with a sine on the suspended mass."
steps = 120
time_step_s = 0.0005
gravity_m_per_s2 = 0
suspended_mass_t = 6.25
vertical_suspension = { stiffness_kn_per_m = 1200, damping_kn_s_per_m = 40 }
lateral_suspension = { stiffness_kn_per_m = 1200, damping_kn_s_per_m = 40 }
vertical_force = { mean_kn = 10, amplitude_kn = 61.25, frequency_hz = 10, phase_deg = 0 }
lateral_force = { mean_kn = 20 }
rotations_held = true
solid = false

[scenario.rolling]
description = "A wheel that rolls."
steps = 10
time_step_s = 0.0005
gravity_m_per_s2 = 0
speed_m_per_s = 1
start_x_m = 0.2
suspended_mass_t = 6.25
vertical_suspension = { stiffness_kn_per_m = 1200, damping_kn_s_per_m = 40 }
lateral_suspension = { stiffness_kn_per_m = 1200, damping_kn_s_per_m = 40 }
vertical_force = { mean_kn = 60 }
lateral_force = { mean_kn = 5 }
rotations_held = true
solid = false
"#;

/// The study with its laws by contact angle, run once with the lumped element.
fn run() -> &'static Path {
    static MADE: OnceLock<TempDir> = OnceLock::new();
    MADE.get_or_init(|| {
        let root = tempfile::tempdir().unwrap();
        // full integration locks the disc of this mesh, whose modes then couple with the hub as no wheel's do
        let coarse = include_str!("../studies/coarse.toml")
            .replace("shifts_mm = []", "shifts_mm = [0, 4, 6.5, 7]")
            .replace("full-integration", "incompatible-modes");
        assert!(coarse.contains("6.5, 7]") && coarse.contains("incompatible-modes"));
        let study = format!("{coarse}{CASE}");
        std::fs::write(root.path().join("study.toml"), study).unwrap();
        for command in ["calibrate", "simulate"] {
            let output = railspring(
                root.path(),
                &[
                    command,
                    "study.toml",
                    "-o",
                    "out",
                    "--cache",
                    "store",
                    "-q",
                    "--set",
                    "simulation.element=lumped",
                ],
            );
            assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        }
        root
    })
    .path()
}

fn exported(format: &str) -> PathBuf {
    let arguments = [
        "export",
        "out/stiffness.json",
        "--to",
        format,
        "--study",
        "study.toml",
        "--case",
        "pushed",
        "-o",
        format,
    ];
    export_of(run(), &arguments)
}

/// Columns P and Q of a history, kN.
fn forces(history: &str) -> [Vec<f64>; 2] {
    let mut lines = history.lines();
    let heading: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| heading.iter().position(|found| *found == name).unwrap();
    let columns = ["p_kn", "q_kn"].map(column);
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|value| value.parse().unwrap_or(f64::NAN)).collect()).collect();
    columns.map(|column| rows.iter().map(|row| row[column]).collect())
}

/// Runs the exported model in a Python that has the program, and compares P and Q with those of the project's own run: RMS of the difference over the largest value.
fn differences(format: &str, stem: &str, interpreter: &Path) -> [f64; 2] {
    let folder = exported(format);
    let output = Command::new(interpreter).current_dir(&folder).arg(format!("{stem}.py")).output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    let own = forces(&text(&run().join("out"), "history.csv"));
    let found = forces(&text(&folder, "history.csv"));
    [0, 1].map(|i| {
        assert_eq!((found[i].len(), own[i].len()), (ROWS + 1, ROWS + 1));
        let square: f64 = found[i].iter().zip(&own[i]).map(|(a, b)| (a - b).powi(2)).sum();
        let largest = own[i].iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        (square / found[i].len() as f64).sqrt() / largest
    })
}

/// Source: Exudyn's integration of the equations of motion, with its own time steps. Goal: the exported model has the forces of the project's own run, kN, from the tread through the impacts on the flange.
/// Accuracy: STEPS, over the largest force: half of its steps change 4.1 by 0.1 %, through impacts that follow each other.
#[test]
fn exudyn_runs_the_load_case() {
    const STEPS: f64 = 0.01;
    let Some(interpreter) = railspring_testing::exudyn(Path::new(env!("CARGO_TARGET_TMPDIR"))) else {
        return;
    };
    let [p, q] = differences("lumped-exudyn", "wheel_rail_exudyn", &interpreter);
    println!("P {p:.4}, Q {q:.4}");
    assert!(p < STEPS && q < STEPS, "{p} {q}");
}

/// Source: OpenSees' beams, masses and integration. Goal and accuracy as for Exudyn; the contact is of first order in the step here, and half of the steps change 4.1 by 0.2 %.
#[test]
fn opensees_runs_the_load_case() {
    const STEPS: f64 = 0.015;
    let Some(interpreter) = railspring_testing::opensees(Path::new(env!("CARGO_TARGET_TMPDIR"))) else {
        return;
    };
    let [p, q] = differences("lumped-opensees", "wheel_rail_opensees", &interpreter);
    println!("P {p:.4}, Q {q:.4}");
    assert!(p < STEPS && q < STEPS, "{p} {q}");
}

/// Goal: a model says what it is of, and has each constant with its meaning, the mass of a load case too; what it cannot be is refused with the option or key, and what to do.
#[test]
fn models_say_what_they_need() {
    for (format, stem) in [("lumped-exudyn", "wheel_rail_exudyn"), ("lumped-opensees", "wheel_rail_opensees")]
    {
        let model = text(&exported(format), &format!("{stem}.py"));
        assert!(model.starts_with("# Lumped wheel on its rail for "), "{model}");
        for said in ["# load case pushed: ", "\nHUB_MASS = ", "# kg, of the whole wheel", "\nROWS = 120  # "]
        {
            assert!(model.contains(said), "{format}: {said}");
        }
        assert!(!model.contains("CONSTANTS"));
    }
    // what the load case's wheel weighs more sits at the hub
    let heavier = "export out/stiffness.json --to lumped-exudyn --study study.toml --case pushed --set scenario.pushed.wheel_mass_t=0.4 -o heavier";
    let heavier = export_of(run(), &heavier.split(' ').collect::<Vec<_>>());
    assert!(text(&heavier, "wheel_rail_exudyn.py").contains("\nHUB_MASS = 400.0  # "));
    let springs = ["export", "out/stiffness.json", "--to", "lumped-exudyn", "-o", "none"];
    let study = ["--study", "study.toml"];
    for (more, parts) in [
        (&[][..], &["--study = (missing)", "a model wants its load case"][..]),
        (&study, &["--case = (missing)", "a load case of the study: pushed, rolling"]),
        (&[study[0], study[1], "--case", "braked"], &["--case = braked", "pushed, rolling"]),
        (&[study[0], study[1], "--case", "rolling"], &["scenario.rolling.speed_m_per_s = 1", "--case"]),
        (&[study[0], study[1], "--case", "pushed", "--law", "power"], &["--law = power", "leave it out"]),
        (&["--reference", "foot"], &["--reference = \"foot\"", "leave it out"]),
    ] {
        let output = railspring(run(), &[&springs[..], more].concat());
        assert_eq!(output.status.code(), Some(2), "{more:?}");
        let message = said(&output);
        parts.iter().for_each(|part| assert!(message.contains(part), "{more:?}: {message}"));
    }
    let output = railspring(
        run(),
        &["export", "out/stiffness.json", "--to", "opensees", "--case", "pushed", "-o", "none"],
    );
    assert!(said(&output).contains("--case = \"pushed\""), "{}", said(&output));
    assert!(!run().join("none").exists());
}
