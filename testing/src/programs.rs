//! Programs that exports are tried in, as Python packages in a virtual environment of their own.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use super::{Need, needs, python};

/// Exact versions and hashes of their packages.
const LOCK: &str = include_str!("../requirements-programs.lock");

/// A Python that has OpenSees, in an environment in `cache`; `None`, and the test is counted as skipped, where there is no Python, no
/// package for this system, no way to the index, or not the libraries that it needs.
pub fn opensees(cache: &Path) -> Option<PathBuf> {
    let item = "OpenSees (openseespy, with the system's BLAS)";
    with(cache, "import openseespy.opensees", Need::OpenSees, item)
}

/// As [`opensees`], with Exudyn.
pub fn exudyn(cache: &Path) -> Option<PathBuf> {
    with(cache, "import exudyn", Need::Packages, "Exudyn")
}

/// As [`opensees`], with the vehicle models of STEM.
pub fn stem(cache: &Path) -> Option<PathBuf> {
    with(cache, "import UVEC", Need::Stem, "the vehicle models of STEM (UVEC)")
}

/// A Python that has STEM itself, with the parts of Kratos that it needs: 750 MB. As [`opensees`] where it cannot be installed.
pub fn stem_with_kratos(cache: &Path) -> Option<PathBuf> {
    let interpreter = locked(cache, "stem", include_str!("../requirements-stem.lock"))?;
    let there = succeeds(&interpreter, &["-I", "-c", "import stem.stem"].map(OsStr::new));
    needs(Need::Stem, "STEM (stem-vibrations)", there).then_some(interpreter)
}

/// A Python with the packages of a `lock` with hashes, in an environment `venv-NAME` in `cache`; `None`, and the test is counted as skipped, where
/// there is no Python, no package for this system, or no way to the index.
pub fn locked(cache: &Path, name: &str, lock: &str) -> Option<PathBuf> {
    if !python() {
        return None;
    }
    let interpreter = environment(&cache.join(format!("venv-{name}")), lock);
    needs(Need::Packages, name, interpreter.is_some()).then_some(interpreter).flatten()
}

/// As [`opensees`], with FMPy, in an environment of its own.
pub fn fmpy(cache: &Path) -> Option<PathBuf> {
    locked(cache, "fmpy", include_str!("../requirements-fmpy.lock"))
}

fn with(cache: &Path, probe: &str, need: Need, item: &str) -> Option<PathBuf> {
    static MADE: OnceLock<Option<PathBuf>> = OnceLock::new();
    if !python() {
        return None;
    }
    let interpreter = MADE.get_or_init(|| environment(&cache.join("venv-programs"), LOCK)).as_ref();
    let there = interpreter.is_some_and(|python| succeeds(python, &["-I", "-c", probe].map(OsStr::new)));
    needs(need, item, there).then(|| interpreter.cloned()).flatten()
}

/// The interpreter of the environment, made unless its lock is there, which is written last.
fn environment(folder: &Path, wanted_lock: &str) -> Option<PathBuf> {
    let (interpreter, lock) = (folder.join("bin/python"), folder.join("installed.lock"));
    if std::fs::read_to_string(&lock).is_ok_and(|installed| installed == wanted_lock) {
        return Some(interpreter);
    }
    let wanted = folder.with_extension("lock");
    std::fs::write(&wanted, wanted_lock).ok()?;
    let venv = ["-I", "-m", "venv", "--clear"].map(OsStr::new);
    let mut bases = ["python3", "python"].into_iter().map(Path::new);
    bases.find(|base| succeeds(base, &[&venv[..], &[folder.as_os_str()]].concat()))?;
    let install = "-I -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes --only-binary=:all: -r";
    let mut arguments: Vec<&OsStr> = install.split(' ').map(OsStr::new).collect();
    arguments.push(wanted.as_os_str());
    let made = succeeds(&interpreter, &arguments) && std::fs::rename(wanted, lock).is_ok();
    made.then_some(interpreter)
}

fn succeeds(program: &Path, arguments: &[&OsStr]) -> bool {
    let output = Command::new(program).args(arguments).stdin(Stdio::null()).output();
    output.is_ok_and(|output| output.status.success())
}
