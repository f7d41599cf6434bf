//! Running CalculiX on an exported deck and reading its reactions back.

use std::fs::File;
use std::io::ErrorKind;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use railspring_profiles::error::{InputError, Result};
use railspring_profiles::monitor::Monitor;

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
    let so_far = || parse(&std::fs::read_to_string(&results).unwrap_or_default());
    let status = loop {
        if let Err(stop) = monitor.progress("CalculiX", so_far().len().min(count), count) {
            let _ = child.kill();
            let _ = child.wait();
            return Err(stop);
        }
        if let Some(status) = child.try_wait().map_err(failed)? {
            break status;
        }
        std::thread::sleep(PAUSE);
    };
    let steps = so_far();
    let said = std::fs::read_to_string(&log).unwrap_or_default();
    let words = said.lines().find(|line| line.contains("*ERROR"));
    if !status.success() || words.is_some() || steps.len() != count {
        let reached = format!("{} of {count} steps", steps.len());
        return Err(InputError::new(
            "CalculiX",
            words.map_or(reached.as_str(), str::trim),
            "a run that ends",
            format!("see {}", log.display()),
        )
        .into());
    }
    monitor.progress("CalculiX", count, count)?;
    Ok(steps)
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
