//! Finding or making the Python environment, and running the package of `reference/` in it: the independent solution,
//! and the reader of mesh files.

use std::ffi::OsString;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use railspring_calibrate::error::{InputError, Result};
use railspring_calibrate::monitor::Monitor;

/// Exact versions of all packages.
const LOCK: &str = include_str!("../reference/requirements.lock");
/// What elements of second order need besides.
const SECOND_ORDER_LOCK: &str = include_str!("../reference/requirements-second-order.lock");
/// The reference package itself, so that the installed program needs no source tree.
const PACKAGE: [(&str, &str); 10] = [
    ("__init__.py", include_str!("../reference/src/railspring_reference/__init__.py")),
    ("__main__.py", include_str!("../reference/src/railspring_reference/__main__.py")),
    ("ordering.py", include_str!("../reference/src/railspring_reference/ordering.py")),
    ("factor.py", include_str!("../reference/src/railspring_reference/factor.py")),
    ("body.py", include_str!("../reference/src/railspring_reference/body.py")),
    ("exchange.py", include_str!("../reference/src/railspring_reference/exchange.py")),
    ("surface.py", include_str!("../reference/src/railspring_reference/surface.py")),
    ("contact.py", include_str!("../reference/src/railspring_reference/contact.py")),
    ("run.py", include_str!("../reference/src/railspring_reference/run.py")),
    ("mesh_in.py", include_str!("../reference/src/railspring_reference/mesh_in.py")),
];
/// What to do where Python is missing.
const REMEDY: &str = "install Python 3.11 or newer with the module venv (Debian: apt install python3-venv), or name an \
                      interpreter that has scikit-fem, meshio and scipy with --python PATH; only `crosscheck` and studies \
                      with a mesh_file need it";

/// What an environment is made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Meshes, and elements of first order.
    FirstOrder,
    /// Elements of second order too, which need a faster factorisation.
    SecondOrder,
}

/// An interpreter that can run the reference.
#[derive(Debug, Clone)]
pub struct Python {
    interpreter: PathBuf,
    package: PathBuf,
}

impl Python {
    /// Takes the given interpreter, or makes a virtual environment in `cache` with the locked
    /// packages if none is there yet.
    ///
    /// # Errors
    /// [`InputError`] with key `--python` that says what is missing and how to get it.
    pub fn prepare(
        given: Option<&Path>,
        cache: &Path,
        purpose: Purpose,
        monitor: &dyn Monitor,
    ) -> Result<Self> {
        let package = cache.join(format!("reference-{}", &package_hash()[..12]));
        write_package(&package).map_err(|cause| cache_error(cache, &cause))?;
        let interpreter = match given {
            Some(path) => path.to_path_buf(),
            None => environment(cache, purpose, monitor)?,
        };
        let python = Self { interpreter, package };
        python.probe()?;
        Ok(python)
    }

    /// The interpreter.
    pub fn interpreter(&self) -> &Path {
        &self.interpreter
    }

    /// Fails if the packages cannot be imported.
    fn probe(&self) -> Result<()> {
        let output = Command::new(&self.interpreter)
            .args(["-c", "import skfem, meshio, scipy, numpy"])
            .stdin(Stdio::null())
            .output()
            .map_err(|cause| missing(&self.interpreter, &cause.to_string()))?;
        if output.status.success() {
            return Ok(());
        }
        let text = String::from_utf8_lossy(&output.stderr);
        Err(missing(&self.interpreter, text.lines().last().unwrap_or("it cannot import the packages")).into())
    }

    /// A module of the package, to be run.
    fn module(&self, name: &str) -> Command {
        let mut command = Command::new(&self.interpreter);
        command
            .args(["-m", name])
            .env("PYTHONPATH", &self.package)
            .env("PYTHONDONTWRITEBYTECODE", "1")
            .stdin(Stdio::null());
        command
    }

    /// What the reader of mesh files says about a file and the names of its contact surface and held nodes: a line of
    /// JSON and raw data, as `mesh_in.py` describes them.
    ///
    /// # Errors
    /// [`InputError`] with key `--python` if the reader does not run. A file that it refuses is no such error.
    pub fn read_mesh(&self, file: &Path, contact: &str, held: &str) -> Result<Vec<u8>> {
        // with = a name may begin with a dash
        let output = self
            .module("railspring_reference.mesh_in")
            .args([format!("--contact={contact}"), format!("--held={held}"), "--".into()])
            .arg(file)
            .output()
            .map_err(|cause| missing(&self.interpreter, &cause.to_string()))?;
        if output.stdout.is_empty() {
            let said = String::from_utf8_lossy(&output.stderr);
            let last = said.lines().rev().find(|line| !line.trim().is_empty());
            return Err(missing(&self.interpreter, last.unwrap_or("it said nothing").trim()).into());
        }
        Ok(output.stdout)
    }

    /// Runs the reference on an exchange folder, handing its progress on.
    ///
    /// # Errors
    /// [`InputError`] with what the reference said when it failed; the user's wish to stop.
    pub fn run(&self, folder: &Path, monitor: &dyn Monitor) -> Result<()> {
        let mut child = self
            .module("railspring_reference")
            .arg(folder)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|cause| missing(&self.interpreter, &cause.to_string()))?;
        let mut errors = child.stderr.take().expect("stderr is piped");
        // a full pipe would block the reference, so its messages are read at the same time
        let reader = std::thread::spawn(move || {
            let mut text = String::new();
            let _ = errors.read_to_string(&mut text);
            text
        });
        let output = BufReader::new(child.stdout.take().expect("stdout is piped"));
        for line in output.lines().map_while(std::result::Result::ok) {
            let parts: Vec<&str> = line.split('\t').collect();
            if let ["PROGRESS", stage, done, total] = parts[..]
                && let Err(stop) = monitor.progress(
                    &format!("reference: {stage}"),
                    done.parse().unwrap_or(0),
                    total.parse().unwrap_or(1),
                )
            {
                let _ = child.kill();
                let _ = child.wait();
                return Err(stop);
            }
        }
        let status = child.wait().map_err(|cause| missing(&self.interpreter, &cause.to_string()))?;
        let said = reader.join().unwrap_or_default();
        if status.success() {
            return Ok(());
        }
        Err(InputError::new(
            "reference",
            said.lines().rev().find(|l| !l.trim().is_empty()).unwrap_or("no message").trim(),
            "a reference run that ends",
            format!(
                "see the exchange folder {}; run `python -m railspring_reference` on it",
                folder.display()
            ),
        )
        .into())
    }
}

/// BLAKE3 of the reference package's source files.
pub fn package_hash() -> String {
    blake3::hash(&package_bytes()).to_hex().to_string()
}

/// Default folder of the virtual environment: `RAILSPRING_CACHE`, else the user's cache folder.
pub fn cache_folder() -> PathBuf {
    let user = |name: &str, below: &[&str]| -> Option<PathBuf> {
        let root = std::env::var_os(name).filter(|v: &OsString| !v.is_empty())?;
        Some(below.iter().fold(PathBuf::from(root), |path, part| path.join(part)))
    };
    user("RAILSPRING_CACHE", &[])
        .or_else(|| user("XDG_CACHE_HOME", &["railspring"]))
        .or_else(|| user("LOCALAPPDATA", &["railspring"]))
        .or_else(|| user("HOME", &[".cache", "railspring"]))
        .unwrap_or_else(|| PathBuf::from(".railspring-cache"))
}

/// The interpreter of the virtual environment in `cache`; made if its mark of completion is absent.
fn environment(cache: &Path, purpose: Purpose, monitor: &dyn Monitor) -> Result<PathBuf> {
    let packages = match purpose {
        Purpose::FirstOrder => LOCK.to_owned(),
        Purpose::SecondOrder => [LOCK, SECOND_ORDER_LOCK].concat(),
    };
    let name = format!("venv-{}", &blake3::hash(packages.as_bytes()).to_hex()[..12]);
    // of two commands at the same time one makes the environment and the other waits for it
    let _one = std::fs::File::create(cache.join(format!("{name}.lock")))
        .and_then(|file| file.lock().map(|()| file))
        .map_err(|cause| cache_error(cache, &cause))?;
    let folder = cache.join(&name);
    let interpreter =
        if cfg!(windows) { folder.join("Scripts/python.exe") } else { folder.join("bin/python") };
    let complete = folder.join("complete");
    if complete.exists() && interpreter.exists() {
        return Ok(interpreter);
    }
    let base = ["python3", "python"]
        .into_iter()
        .find(|name| {
            Command::new(name)
                .args(["-c", "import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))"])
                .stdin(Stdio::null())
                .output()
                .is_ok_and(|output| output.status.success())
        })
        .ok_or_else(|| {
            missing(Path::new("python3"), "no Python 3.11 or newer with venv was found on the path")
        })?;
    monitor.progress("making the Python environment", 0, 2)?;
    let lock = cache.join(format!("{name}.txt"));
    std::fs::write(&lock, packages).map_err(|cause| cache_error(cache, &cause))?;
    let made = |arguments: &[&std::ffi::OsStr], program: &Path| -> Result<()> {
        let output = Command::new(program)
            .args(arguments)
            .stdin(Stdio::null())
            .output()
            .map_err(|cause| missing(program, &cause.to_string()))?;
        if output.status.success() {
            return Ok(());
        }
        let said = [output.stderr, output.stdout].concat();
        let text = String::from_utf8_lossy(&said);
        Err(missing(
            program,
            text.lines().find(|l| l.contains("ERROR")).or(text.lines().last()).unwrap_or("failed"),
        )
        .into())
    };
    made(&["-m".as_ref(), "venv".as_ref(), "--clear".as_ref(), folder.as_os_str()], Path::new(base))?;
    monitor.progress("making the Python environment", 1, 2)?;
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r"];
    let mut arguments: Vec<&std::ffi::OsStr> = install.iter().map(|a| a.as_ref()).collect();
    arguments.push(lock.as_os_str());
    made(&arguments, &interpreter)?;
    std::fs::write(&complete, "").map_err(|cause| cache_error(cache, &cause))?;
    monitor.progress("making the Python environment", 2, 2)?;
    Ok(interpreter)
}

fn package_bytes() -> Vec<u8> {
    PACKAGE.iter().flat_map(|(name, text)| [name.as_bytes(), text.as_bytes()].concat()).collect()
}

fn write_package(folder: &Path) -> std::io::Result<()> {
    let package = folder.join("railspring_reference");
    std::fs::create_dir_all(&package)?;
    for (name, text) in PACKAGE {
        let file = package.join(name);
        if std::fs::read(&file).ok().as_deref() != Some(text.as_bytes()) {
            // commands that run at the same time must not see half a file
            let mut whole = tempfile::NamedTempFile::new_in(&package)?;
            whole.write_all(text.as_bytes())?;
            whole.persist(file)?;
        }
    }
    Ok(())
}

fn missing(interpreter: &Path, cause: &str) -> InputError {
    InputError::new(
        "--python",
        format!("{} ({cause})", interpreter.display()),
        "a Python that runs the reference (scikit-fem, meshio, numpy, scipy)",
        REMEDY,
    )
}

fn cache_error(cache: &Path, cause: &std::io::Error) -> InputError {
    InputError::new(
        "cache folder",
        format!("{} ({cause})", cache.display()),
        "a folder that can be created and written",
        "set RAILSPRING_CACHE to another one",
    )
}
