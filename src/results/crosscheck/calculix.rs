//! Running CalculiX on an exported deck and reading its reactions back.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::ErrorKind;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use nalgebra::Vector3;
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::monitor::Monitor;
use railspring_profiles::units::MILLIMETRE;

/// Names under which distributions install the solver.
const PROGRAMS: [&str; 2] = ["ccx", "ccx_2.22"];
/// What to do where it is missing.
const REMEDY: &str = "install CalculiX (Debian: apt install calculix-ccx), or leave out --with calculix";

/// Hub displacement (m) and reaction (N) after each step.
pub type Steps = Vec<(f64, f64)>;

/// The solver's name and version, if it is installed.
///
/// # Errors
/// [`InputError`] with key `--with calculix` that says how to get it.
pub fn version() -> Result<(&'static str, String)> {
    PROGRAMS
        .into_iter()
        .find_map(|program| {
            let output = Command::new(program).arg("-v").stdin(Stdio::null()).output().ok()?;
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            let number = text.split_whitespace().last()?.to_string();
            Some((program, format!("CalculiX {number}")))
        })
        .ok_or_else(|| {
            InputError::new("--with calculix", "no program ccx on the path", "CalculiX CrunchiX", REMEDY)
                .into()
        })
}

/// Runs the deck `name.inp` of `count` steps in `folder` and returns its steps; what the solver says goes to `name.log`.
///
/// # Errors
/// [`InputError`] with the solver's last words if it fails; an interruption by the user.
pub fn run(program: &str, folder: &Path, name: &str, count: usize, monitor: &dyn Monitor) -> Result<Steps> {
    Ok(parse(&solve(program, folder, name, (count, &|dat| parse(dat).len()), monitor)?))
}

/// Runs the deck `name.inp` of one step in `folder` and returns the displacement (m) of every node whose displacements it prints, by its
/// number in the deck.
///
/// # Errors
/// As [`run`].
pub fn displacements(
    program: &str,
    folder: &Path,
    name: &str,
    monitor: &dyn Monitor,
) -> Result<BTreeMap<usize, Vector3<f64>>> {
    let printed = |dat: &str| usize::from(!nodes(dat).is_empty());
    Ok(nodes(&solve(program, folder, name, (1, &printed), monitor)?))
}

/// Runs a deck until it ends; what it has printed. `done` counts the steps in what it has printed so far.
fn solve(
    program: &str,
    folder: &Path,
    name: &str,
    (count, done): (usize, &dyn Fn(&str) -> usize),
    monitor: &dyn Monitor,
) -> Result<String> {
    const PAUSE: Duration = Duration::from_millis(200);
    let [log, results] = ["log", "dat"].map(|ending| folder.join(format!("{name}.{ending}")));
    let failed = |cause: std::io::Error| {
        InputError::new("--with calculix", cause, "CalculiX CrunchiX in a folder that can be written", REMEDY)
    };
    let output = File::create(&log).map_err(failed)?;
    // what an earlier run has left must not pass for results of this one
    match std::fs::remove_file(&results) {
        Err(cause) if cause.kind() != ErrorKind::NotFound => return Err(failed(cause).into()),
        _ => {}
    }
    let threads = rayon::current_num_threads().to_string();
    let mut child = Command::new(program)
        .args(["-i", name])
        .current_dir(folder)
        .env("OMP_NUM_THREADS", &threads)
        .stdin(Stdio::null())
        .stdout(output.try_clone().map_err(failed)?)
        .stderr(output)
        .spawn()
        .map_err(failed)?;
    let so_far = || std::fs::read_to_string(&results).unwrap_or_default();
    let status = loop {
        if let Err(stop) = monitor.progress("CalculiX", done(&so_far()).min(count), count) {
            let _ = child.kill();
            let _ = child.wait();
            return Err(stop);
        }
        if let Some(status) = child.try_wait().map_err(failed)? {
            break status;
        }
        std::thread::sleep(PAUSE);
    };
    let printed = so_far();
    let steps = done(&printed);
    let said = std::fs::read_to_string(&log).unwrap_or_default();
    let words = said.lines().find(|line| line.contains("*ERROR"));
    if !status.success() || words.is_some() || steps != count {
        let reached = format!("{steps} of {count} steps");
        return Err(InputError::new(
            "CalculiX",
            words.map_or(reached.as_str(), str::trim),
            "a run that ends",
            format!("see {}", log.display()),
        )
        .into());
    }
    monitor.progress("CalculiX", count, count)?;
    Ok(printed)
}

/// Pairs of displacement and reaction along z from a `.dat` file in mm and N.
fn parse(dat: &str) -> Steps {
    let mut steps = Vec::new();
    let mut displacement = None;
    let mut wanted = None;
    for line in dat.lines() {
        if line.contains("displacements") {
            wanted = Some(false);
        } else if line.contains("forces") {
            wanted = Some(true);
        } else if let Some(force) = wanted {
            let numbers: Vec<f64> = line.split_whitespace().filter_map(|w| w.parse().ok()).collect();
            if let [_, _, _, z] = numbers[..] {
                match (force, displacement) {
                    (false, _) => displacement = Some(z * 1e-3),
                    (true, Some(u)) => steps.push((u, z)),
                    (true, None) => {}
                }
                wanted = None;
            }
        }
    }
    steps
}

/// Displacements of nodes from a `.dat` file of one step in mm.
fn nodes(dat: &str) -> BTreeMap<usize, Vector3<f64>> {
    let rows = dat.lines().skip_while(|line| !line.contains("displacements")).skip(1);
    let of_row = |line: &str| {
        let mut words = line.split_whitespace();
        let node = words.next()?.parse().ok()?;
        let values: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
        let [x, y, z] = values[..] else { return None };
        Some((node, Vector3::new(x, y, z) * MILLIMETRE))
    };
    rows.filter_map(of_row).collect()
}

/// Displacement at `load` from the steps: a power law between neighbouring ones (beyond them, of the last two).
pub fn displacement_at(steps: &[(f64, f64)], load: f64) -> Option<f64> {
    let usable: Vec<(f64, f64)> = steps.iter().copied().filter(|(u, f)| *u > 0.0 && *f > 0.0).collect();
    if usable.len() < 2 {
        return None;
    }
    let at = usable.iter().position(|(_, f)| *f >= load).unwrap_or(usable.len() - 1).max(1);
    let ((u0, f0), (u1, f1)) = (usable[at - 1], usable[at]);
    Some(u0 * (u1 / u0).powf((load / f0).ln() / (f1 / f0).ln()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reactions_are_read_in_pairs() {
        let dat = "\n displacements (vx,vy,vz) for set HUB and time  0.1000000E+01\n\n    27628  0.000000E+00  0.000000E+00  1.469000E-02\n\n forces (fx,fy,fz) for set HUB and time  0.1000000E+01\n\n    27628  0.000000E+00 -3.000000E+00  5.000000E+03\n";
        assert_eq!(parse(dat), vec![(1.469e-5, 5e3)]);
    }

    /// Every node of a list has its displacement, m; lines of other numbers are none.
    #[test]
    fn displacements_are_read_by_node() {
        let dat = "\n displacements (vx,vy,vz) for set LOADED and time  0.1000000E+01\n\n       12  1.000000E+00 -2.000000E-03  0.000000E+00\n    27628  0.000000E+00  1.500000E+00  4.000000E+00\n";
        let found = nodes(dat);
        assert_eq!(found.keys().copied().collect::<Vec<_>>(), [12, 27628]);
        assert!((found[&12] - Vector3::new(1e-3, -2e-6, 0.0)).norm() < 1e-18);
        assert!(nodes("\n forces for set HUB\n\n 12 1.0 2.0 3.0\n").is_empty());
    }

    /// A power law is reproduced exactly, also beyond the last step.
    #[test]
    fn interpolation_is_exact_for_a_power_law() {
        let steps: Vec<(f64, f64)> = [1e-5_f64, 2e-5, 5e-5].map(|u| (u, 1e12 * u.powf(1.5))).to_vec();
        for u in [1.1e-5_f64, 3e-5, 6e-5] {
            let found = displacement_at(&steps, 1e12 * u.powf(1.5)).unwrap();
            assert!((found / u - 1.0).abs() < 1e-12);
        }
    }
}
