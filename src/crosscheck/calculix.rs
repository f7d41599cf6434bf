//! Running CalculiX on an exported deck and reading its reactions back.

use std::path::Path;
use std::process::{Command, Stdio};

use railspring_calibrate::error::{InputError, Result};

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

/// Runs the deck `name.inp` in `folder` and returns its steps.
///
/// # Errors
/// [`InputError`] with the solver's last words if it fails.
pub fn run(program: &str, folder: &Path, name: &str) -> Result<Steps> {
    let threads = rayon::current_num_threads().to_string();
    let output = Command::new(program)
        .args(["-i", name])
        .current_dir(folder)
        .env("OMP_NUM_THREADS", &threads)
        .env("CCX_NPROC_EQUATION_SOLVER", &threads)
        .stdin(Stdio::null())
        .output()
        .map_err(|cause| InputError::new("--with calculix", cause, "CalculiX CrunchiX", REMEDY))?;
    let said = String::from_utf8_lossy(&output.stdout);
    let _ = std::fs::write(folder.join(format!("{name}.log")), said.as_bytes());
    let dat = std::fs::read_to_string(folder.join(format!("{name}.dat"))).unwrap_or_default();
    let steps = parse(&dat);
    if !output.status.success() || said.contains("*ERROR") || steps.is_empty() {
        let words = said.lines().find(|l| l.contains("*ERROR")).unwrap_or("no results were written");
        return Err(InputError::new(
            "CalculiX",
            words.trim(),
            "a run that ends",
            format!("see {}", folder.join(format!("{name}.log")).display()),
        )
        .into());
    }
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
