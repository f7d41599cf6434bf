//! What a calibration says of the contact itself: patches, on the fine grid and between elements.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use assert_cmd::Command;
use serde_json::Value;

/// Folder of the study with the contact in a field, calibrated once for all tests.
fn calibrated(field: &'static str) -> &'static Path {
    static HYBRID: OnceLock<PathBuf> = OnceLock::new();
    static ELEMENTS: OnceLock<PathBuf> = OnceLock::new();
    let run = || {
        // kept in the build folder: a value that lives as long as the program is never dropped
        let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("calibration-fields-{field}"));
        let _ = std::fs::remove_dir_all(&root);
        std::fs::create_dir_all(&root).unwrap();
        let study = include_str!("studies/coarse.toml")
            .replace("[contact]", &format!("[contact]\nfield = \"{field}\""));
        std::fs::write(root.join("study.toml"), study).unwrap();
        let output = Command::cargo_bin("railspring")
            .unwrap()
            .current_dir(&root)
            .env("RAILSPRING_CACHE", root.join("cache"))
            .args(["calibrate", "study.toml", "-o", "out"])
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        root.join("out")
    };
    match field {
        "hybrid" => HYBRID.get_or_init(run),
        _ => ELEMENTS.get_or_init(run),
    }
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

/// Half the distance between the neighbours of every line, mm.
fn shares(lines: &[f64]) -> Vec<f64> {
    let at = |n: usize| lines[n.min(lines.len() - 1)];
    (0..lines.len()).map(|n| 0.5 * (at(n + 1) - lines[n.saturating_sub(1)])).collect()
}

/// Source: equilibrium; a pressure that is bilinear between the points of a grid has the force of its nodal values times the shares of the
/// points. Goal: the pressures of `contact_patches.json` carry the loads of the study, kN, the smallest, the middle and the largest; a point
/// has pressure where it is not open, and the first and the last line have none. Accuracy: MODEL, the vertical part of forces whose normals are
/// inclined by up to 0.15 rad at the gauge corner, and the friction that goes with them.
#[test]
fn patches_carry_the_loads() {
    const MODEL: f64 = 0.02;
    for field in ["hybrid", "elements"] {
        let record = json(&calibrated(field).join("contact_patches.json"));
        assert_eq!(record["field"], field);
        let patches = record["patches"].as_array().unwrap();
        let loads: Vec<f64> = patches.iter().map(|patch| patch["force_kn"].as_f64().unwrap()).collect();
        assert_eq!(loads.len(), 3);
        assert!((loads[0] - 5.0).abs() < 1e-9 && (loads[2] - 85.0).abs() < 1e-9, "{loads:?}");
        for patch in patches {
            let (across, along) = (numbers(&patch["across_mm"]), numbers(&patch["along_mm"]));
            assert!(across.windows(2).chain(along.windows(2)).all(|w| w[0] < w[1]));
            let (rows, columns) = (shares(&across), shares(&along));
            let mut force = 0.0;
            for (i, line) in patch["pressure_mpa"].as_array().unwrap().iter().enumerate() {
                for (k, pressure) in numbers(line).into_iter().enumerate() {
                    force += 1e-3 * pressure * rows[i] * columns[k];
                    let open = patch["state"][i][k] == "open";
                    assert_eq!(open, pressure == 0.0, "{field}: {i} {k}");
                    let first_or_last = i == 0 || k == 0 || i + 1 == across.len() || k + 1 == along.len();
                    assert!(open || !first_or_last, "{field}: load at the end of the grid");
                }
            }
            let load = patch["force_kn"].as_f64().unwrap();
            println!("{field}: {load} kN, {force} kN");
            assert!((force / load - 1.0).abs() < MODEL, "{field}: {load} kN, {force} kN");
        }
    }
}
