//! OpenSees as a Python package, in a virtual environment of its own.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use super::{Need, needs, python};

/// Exact versions and hashes of its packages.
const LOCK: &str = include_str!("../requirements-opensees.lock");

/// A Python that has OpenSees, made in `cache` from the lock; `None`, and the test is counted as skipped, where there is no Python,
/// no package for this system, no way to the index, or not the libraries that it needs.
pub fn opensees(cache: &Path) -> Option<PathBuf> {
    static MADE: OnceLock<Option<PathBuf>> = OnceLock::new();
    if !python() {
        return None;
    }
    let made = MADE.get_or_init(|| made(&cache.join("venv-opensees"))).clone();
    needs(Need::OpenSees, "OpenSees (openseespy, with the system's BLAS)", made.is_some());
    made
}

fn made(folder: &Path) -> Option<PathBuf> {
    let interpreter = folder.join("bin/python");
    let has_it = || succeeds(&interpreter, &["-I", "-c", "import openseespy.opensees"].map(OsStr::new));
    if !has_it() {
        let lock = folder.with_extension("txt");
        std::fs::write(&lock, LOCK).ok()?;
        let venv = ["-I", "-m", "venv", "--clear"].map(OsStr::new);
        let base = ["python3", "python"].into_iter().map(Path::new);
        base.into_iter().find(|base| succeeds(base, &[&venv[..], &[folder.as_os_str()]].concat()))?;
        let install =
            "-I -m pip install --quiet --disable-pip-version-check --require-hashes --only-binary=:all: -r";
        let mut arguments: Vec<&OsStr> = install.split(' ').map(OsStr::new).collect();
        arguments.push(lock.as_os_str());
        succeeds(&interpreter, &arguments);
    }
    has_it().then_some(interpreter)
}

fn succeeds(program: &Path, arguments: &[&OsStr]) -> bool {
    let output = Command::new(program).args(arguments).stdin(Stdio::null()).output();
    output.is_ok_and(|output| output.status.success())
}
