//! The virtual environment with the locked packages.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use railspring_profiles::error::{InputError, Result};
use railspring_profiles::monitor::Monitor;

use super::command::{PROBE_LIMITS, answer, isolated};
use super::package::Package;
use crate::child::Limits;
use crate::plain_file;

/// Limits of making the environment and of loading packages over a slow line.
const LIMITS: Limits = Limits { time: Duration::from_secs(1800), output: 64 << 20, memory: None };
/// Shown while that goes on.
const STAGE: &str = "making the Python environment";
/// Settings of pip that say where packages come from and how to get there. With hashes the source of the
/// packages does not matter. All other settings could install something else or elsewhere, so they are not passed on.
const NETWORK: [&str; 16] = [
    "CACHE_DIR",
    "CERT",
    "CLIENT_CERT",
    "CONFIG_FILE",
    "DEFAULT_TIMEOUT",
    "EXTRA_INDEX_URL",
    "FIND_LINKS",
    "INDEX_URL",
    "KEYRING_PROVIDER",
    "NO_CACHE_DIR",
    "NO_INDEX",
    "NO_INPUT",
    "PROXY",
    "RETRIES",
    "TIMEOUT",
    "TRUSTED_HOST",
];

/// Default folder of the virtual environment: `RAILSPRING_CACHE`, else the user's cache folder. It is never one in the working folder that was not named: what
/// others have put there would be run.
///
/// # Errors
/// [`InputError`] with key `cache folder` where no variable names an absolute path.
pub fn cache_folder() -> Result<PathBuf> {
    cache_folder_of(&|name| std::env::var_os(name))
}

fn cache_folder_of(variable: &dyn Fn(&str) -> Option<OsString>) -> Result<PathBuf> {
    let given = |name: &str| variable(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let user = |name: &str, below: &[&str]| -> Option<PathBuf> {
        let root = given(name).filter(|root| root.is_absolute())?;
        Some(below.iter().fold(root, |path, part| path.join(part)))
    };
    given("RAILSPRING_CACHE")
        .or_else(|| user("XDG_CACHE_HOME", &["railspring"]))
        .or_else(|| user("LOCALAPPDATA", &["railspring"]))
        .or_else(|| user("HOME", &[".cache", "railspring"]))
        .ok_or_else(|| {
            InputError::new(
                "cache folder",
                "(none: neither RAILSPRING_CACHE, XDG_CACHE_HOME nor HOME names one)",
                "the folder of the user's caches",
                "set HOME, or RAILSPRING_CACHE to a folder of your own",
            )
            .into()
        })
}

pub(super) fn cache_error(cache: &Path, cause: &std::io::Error) -> InputError {
    InputError::new(
        "cache folder",
        format!("{} ({cause})", cache.display()),
        "a folder that can be created and written",
        "set RAILSPRING_CACHE to another one",
    )
}

/// The interpreter of the virtual environment in `cache` with the `packages` of a lock, an absolute path; made if its mark of completion is
/// absent. Programs work in the folder `place`.
pub(super) fn interpreter(
    cache: &Path,
    (of, packages): (&Package, &str),
    place: &Path,
    monitor: &dyn Monitor,
) -> Result<PathBuf> {
    let name = format!("venv-{}", &blake3::hash(packages.as_bytes()).to_hex()[..12]);
    // of two commands at the same time one makes the environment and the other waits for it
    let _one =
        plain_file::lock(&cache.join(format!("{name}.lock"))).map_err(|cause| cache_error(cache, &cause))?;
    let folder = cache.join(&name);
    let interpreter =
        if cfg!(windows) { folder.join("Scripts/python.exe") } else { folder.join("bin/python") };
    let complete = folder.join("complete");
    if complete.exists() && interpreter.exists() {
        return Ok(interpreter);
    }
    const SUITABLE: &str = "import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))";
    let base = ["python3", "python"]
        .map(Path::new)
        .into_iter()
        .find(|name| {
            let mut command = isolated(name, place);
            command.args(["-c", SUITABLE]);
            answer(of, &mut command, &PROBE_LIMITS, monitor, STAGE).is_ok_and(|ended| ended.status.success())
        })
        .ok_or_else(|| {
            of.missing(Path::new("python3"), "no Python 3.11 or newer with venv was found on the path")
        })?;
    monitor.progress(STAGE, 0, 2)?;
    let lock = cache.join(format!("{name}.txt"));
    plain_file::write(&lock, packages.as_bytes()).map_err(|cause| cache_error(cache, &cause))?;
    let made = |program: &Path, arguments: &[&OsStr]| -> Result<()> {
        let mut command = isolated(program, place);
        keep_network_settings(&mut command);
        command.args(arguments);
        let ended = answer(of, &mut command, &LIMITS, monitor, STAGE)?;
        if ended.status.success() {
            return Ok(());
        }
        let said = format!("{}\n{}", ended.messages, String::from_utf8_lossy(&ended.output));
        let cause = said.lines().find(|line| line.contains("ERROR")).or(said.trim_end().lines().last());
        Err(of.missing(program, cause.unwrap_or("failed")).into())
    };
    made(base, &["-m".as_ref(), "venv".as_ref(), "--clear".as_ref(), folder.as_os_str()])?;
    monitor.progress(STAGE, 1, 2)?;
    // wheels alone: a source package would run its own code here
    let install =
        "-m pip install --quiet --disable-pip-version-check --require-hashes --only-binary=:all: -r";
    let mut arguments: Vec<&OsStr> = install.split(' ').map(OsStr::new).collect();
    arguments.push(lock.as_os_str());
    made(&interpreter, &arguments)?;
    plain_file::write(&complete, b"").map_err(|cause| cache_error(cache, &cause))?;
    monitor.progress(STAGE, 2, 2)?;
    Ok(interpreter)
}

/// Takes all of pip's variables away but those of the network and the index.
fn keep_network_settings(command: &mut Command) {
    for (name, _) in std::env::vars_os() {
        if changes_the_installation(&name.to_string_lossy()) {
            command.env_remove(name);
        }
    }
}

/// Whether a variable is one of pip's that says what is installed, or where.
fn changes_the_installation(name: &str) -> bool {
    name.to_uppercase().strip_prefix("PIP_").is_some_and(|setting| !NETWORK.contains(&setting))
}

#[cfg(test)]
mod tests {
    use super::super::package::{CLUSTER_LOCK, LOCK, SECOND_ORDER_LOCK};
    use super::*;

    /// Goal: the way to the index stays, another target does not.
    #[test]
    fn pip_keeps_its_network_and_nothing_else() {
        for name in ["PIP_INDEX_URL", "pip_cert", "PIP_PROXY", "PATH", "SSL_CERT_FILE", "PIPX_HOME"] {
            assert!(!changes_the_installation(name), "{name}");
        }
        for name in ["PIP_TARGET", "PIP_USER", "PIP_PYTHON", "PIP_NO_BINARY", "PIP_PRE", "pip_constraint"] {
            assert!(changes_the_installation(name), "{name}");
        }
    }

    /// Goal: every package of the locks has a version and at least one hash, and the locks name no host.
    #[test]
    fn the_locks_have_hashes_for_every_package() {
        for (lock, names) in [
            (LOCK, &["meshio", "numpy", "scikit-fem", "scipy", "pytest"][..]),
            (SECOND_ORDER_LOCK, &["meshio", "numpy", "scikit-fem", "scipy", "pytest", "pypardiso"]),
            (CLUSTER_LOCK, &["dask", "distributed", "tornado"]),
        ] {
            assert!(!lock.contains("://") && !lock.contains("--index"), "a host in a lock");
            let whole = lock.replace("\\\n", " ");
            let packages: Vec<&str> =
                whole.lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty()).collect();
            assert!(packages.len() > 10);
            for package in &packages {
                assert!(package.contains("==") && package.contains("--hash=sha256:"), "{package}");
            }
            for name in names {
                assert!(packages.iter().any(|package| package.starts_with(&format!("{name}=="))), "{name}");
            }
        }
        for line in LOCK.lines().filter(|line| line.contains("==")) {
            assert!(SECOND_ORDER_LOCK.contains(line), "{line}: not the same in both locks");
        }
    }
}
