//! What a calibration says of the contact itself: patches and the stresses below them, on the fine grid and between elements.

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

/// Source: Hertz' contacts from the circle to the line have their largest von Mises stress at 0.55 to 0.63 times the largest pressure and
/// their largest shear at 0.30 to 0.33 (K.L. Johnson, Contact Mechanics, 1985, sections 3.4 and 4.1 to 4.3), below the surface. Goal: the
/// columns of `load_curve.csv` and the values of `stiffness.json`, MPa and mm, for patches on the fine grid; the stresses grow with the load, and the curve over the depth reaches
/// them. Between elements there are none. Accuracy: MODEL, a pressure on crown and gauge corner that is no ellipse's and friction change the
/// ratios by a tenth; DISCRETISATION, the curve has depths a twelfth of that of the peak apart.
#[test]
fn stresses_below_the_patch_are_those_of_its_pressure() {
    const MODEL: f64 = 0.15;
    const DISCRETISATION: f64 = 0.01;
    let column = |field: &'static str, name: &str| -> Vec<Option<f64>> {
        let mut reader = csv_rows(&calibrated(field).join("load_curve.csv"));
        let heading = reader.remove(0);
        let at = heading.iter().position(|found| found == name).unwrap();
        reader.iter().map(|row| row[at].parse().ok()).collect()
    };
    let whole = |name: &str| column("hybrid", name).into_iter().map(Option::unwrap).collect::<Vec<f64>>();
    let (mises, shear) = (whole("max_von_mises_mpa"), whole("max_shear_mpa"));
    let (pressure, depth) = (whole("max_pressure_mpa"), whole("von_mises_depth_mm"));
    let semi_axes = [whole("semi_axis_along_mm"), whole("semi_axis_across_mm")];
    for i in 0..mises.len() {
        let least = semi_axes[0][i].min(semi_axes[1][i]);
        println!(
            "{:.1} MPa: {:.3}, {:.3}, {:.3}",
            pressure[i],
            mises[i] / pressure[i],
            shear[i] / pressure[i],
            depth[i] / least
        );
        let within = |value: f64, (low, high): (f64, f64)| {
            assert!((low * (1.0 - MODEL)..high * (1.0 + MODEL)).contains(&value), "{value}: {low} to {high}");
        };
        within(mises[i] / pressure[i], (0.55, 0.63));
        within(shear[i] / pressure[i], (0.30, 0.33));
        assert!((0.1..1.0).contains(&(depth[i] / least)), "{} mm", depth[i]);
    }
    assert!(mises.windows(2).chain(shear.windows(2)).all(|w| w[0] < w[1]), "{mises:?} {shear:?}");
    let record = json(&calibrated("hybrid").join("contact_patches.json"));
    for (patch, row) in
        record["patches"].as_array().unwrap().iter().zip([0, mises.len() / 2, mises.len() - 1])
    {
        let largest = numbers(&patch["below"]["von_mises_mpa"]).into_iter().fold(0.0, f64::max);
        assert!((largest / mises[row] - 1.0).abs() < DISCRETISATION, "{largest} {}", mises[row]);
    }
    // `stiffness.json` has the same, load by load
    let stiffness = json(&calibrated("hybrid").join("stiffness.json"));
    let records = stiffness["subsurface"].as_array().unwrap();
    for name in ["force_kn", "max_von_mises_mpa", "von_mises_depth_mm", "max_shear_mpa", "shear_depth_mm"] {
        let found: Vec<f64> = records.iter().map(|record| record[name].as_f64().unwrap()).collect();
        assert_eq!(found, whole(name), "{name}");
    }
    assert!(json(&calibrated("elements").join("stiffness.json"))["subsurface"].is_null());
    assert!(column("elements", "max_von_mises_mpa").iter().all(Option::is_none));
    let coarse = json(&calibrated("elements").join("contact_patches.json"));
    assert!(coarse["patches"].as_array().unwrap().iter().all(|patch| patch["below"].is_null()));
}

fn csv_rows(path: &Path) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(path).unwrap();
    text.lines().map(|line| line.split(',').map(String::from).collect()).collect()
}
