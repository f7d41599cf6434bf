//! Finding or making the Python environment of a package of this project, and running the package in it: that of `reference/`, which is the
//! independent solution and the reader of mesh files, or that of `cluster/`, which has tables made by a Dask cluster.
//!
//! Python runs isolated: it imports what is installed beside the interpreter and the package of this program, whatever
//! lies in the working folder, beside a study or on `PYTHONPATH`.

mod package;
mod command;
mod environment;

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf, absolute};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

use command::{PROBE_LIMITS, answer, isolated};
use environment::cache_error;
use package::{CLUSTER, Package, REFERENCE};
use railspring_profiles::error::{InputError, NumericsError, Result, StopReason};
use railspring_profiles::monitor::Monitor;
use tempfile::TempDir;

use crate::child::{self, Limits, Stop};
use crate::study::MeshFile;

pub(crate) use crate::child::messages_of;
pub use environment::cache_folder;

/// Loads the package from its own folder (first argument) and runs one of its modules (second argument). The folder is
/// not put on the path of modules: what else lies there is never imported.
const BOOTSTRAP: &str = "\
import importlib.util, os, runpy, sys
folder, module = sys.argv[1:3]
del sys.argv[1:3]
name = module.partition('.')[0]
spec = importlib.util.spec_from_file_location(
    name, os.path.join(folder, '__init__.py'), submodule_search_locations=[folder])
sys.modules[name] = importlib.util.module_from_spec(spec)
spec.loader.exec_module(sys.modules[name])
runpy.run_module(module, run_name='__main__', alter_sys=True)
";
/// Fails where the interpreter is too old or lacks one of the packages in the argument; says its version and those of the packages.
const PROBE: &str = "\
import importlib, sys
if sys.version_info < (3, 11):
    sys.exit('Python ' + sys.version.split()[0] + ' is older than 3.11')
for name in sys.argv[1].split():
    importlib.import_module(name)
from importlib.metadata import distributions
print(sys.version, sorted({(str(d.metadata['Name']), str(d.version)) for d in distributions()}))
";
/// Time for the reader of mesh files to start, for files of any size.
const READER_START: Duration = Duration::from_secs(60);
/// Time for every million bytes of a mesh file; meshio takes a tenth of a second for text.
const READER_PER_MEGABYTE: Duration = Duration::from_secs(10);
/// Largest answer of the reader: ten million nodes and hexahedra.
const LARGEST_ANSWER: u64 = 1 << 30;
/// Exit code of the reference where its numerics do not converge.
const NO_ANSWER: i32 = 3;

/// What an environment is made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Meshes, and elements of first order.
    FirstOrder,
    /// Elements of second order too, which need a faster factorisation.
    SecondOrder,
}

/// An interpreter that can run one of the packages.
#[derive(Debug, Clone)]
pub struct Python {
    of: &'static Package,
    interpreter: PathBuf,
    /// Folder of the package's modules.
    package: PathBuf,
    versions: String,
    /// An empty working folder.
    place: Arc<TempDir>,
}

impl Python {
    /// Takes the given interpreter, or makes a virtual environment in `cache` with the locked
    /// packages if none is there yet: for the package of `reference/`.
    ///
    /// # Errors
    /// [`InputError`] with key `--python` that says what is missing and how to get it; an interruption by the user.
    pub fn prepare(
        given: Option<&Path>,
        cache: &Path,
        purpose: Purpose,
        monitor: &dyn Monitor,
    ) -> Result<Self> {
        let lock = match purpose {
            Purpose::FirstOrder => package::LOCK,
            Purpose::SecondOrder => package::SECOND_ORDER_LOCK,
        };
        Self::of(&REFERENCE, lock, given, cache, monitor)
    }

    /// The same for the package of `cluster/`.
    ///
    /// # Errors
    /// As [`Python::prepare`].
    pub fn for_cluster(given: Option<&Path>, cache: &Path, monitor: &dyn Monitor) -> Result<Self> {
        Self::of(&CLUSTER, package::CLUSTER_LOCK, given, cache, monitor)
    }

    fn of(
        of: &'static Package,
        lock: &str,
        given: Option<&Path>,
        cache: &Path,
        monitor: &dyn Monitor,
    ) -> Result<Self> {
        // Python works in another folder, so that paths have to be whole
        let cache = absolute(cache).map_err(|cause| cache_error(cache, &cause))?;
        let package = cache.join(format!("{}-{}", of.short, &of.hash()[..12])).join(of.name);
        of.write(&package).map_err(|cause| cache_error(&cache, &cause))?;
        let place = tempfile::tempdir().map_err(|cause| {
            InputError::new(
                "temporary folder",
                format!("{} ({cause})", std::env::temp_dir().display()),
                "a folder that can be written",
                "set TMPDIR to another one",
            )
        })?;
        let interpreter = match given {
            Some(path) => whole(path),
            None => environment::interpreter(&cache, (of, lock), place.path(), monitor)?,
        };
        let versions = probe(of, &interpreter, place.path(), monitor)?;
        Ok(Self { of, interpreter, package, versions, place: Arc::new(place) })
    }

    /// The interpreter.
    pub fn interpreter(&self) -> &Path {
        &self.interpreter
    }

    /// Version of the interpreter and of every package that it finds.
    pub fn versions(&self) -> &str {
        &self.versions
    }

    /// The error of an interpreter that does not run the package.
    pub(crate) fn missing(&self, cause: &str) -> InputError {
        self.of.missing(&self.interpreter, cause)
    }

    /// A module of the package, to be run.
    pub(crate) fn module(&self, name: &str) -> Command {
        let mut command = isolated(&self.interpreter, self.place.path());
        command.args(["-c", BOOTSTRAP]).arg(&self.package).arg(format!("{}.{name}", self.of.name));
        command
    }

    /// What the reader of mesh files says about a file and the names of its contact surface, held nodes and groups: a line of
    /// JSON and raw data, as `mesh_in.py` describes them. `key` is that of the file in the study, and `memory` the most
    /// bytes that the reader may take.
    ///
    /// # Errors
    /// [`InputError`] with key `--python` if the reader does not start, and with `key` if the file takes it too long,
    /// holds too much or ends it; an interruption by the user. A file that it refuses is no such error.
    pub fn read_mesh(
        &self,
        key: &str,
        file: &MeshFile,
        memory: Option<f64>,
        monitor: &dyn Monitor,
    ) -> Result<Vec<u8>> {
        let bytes = std::fs::metadata(&file.path).map_or(0, |data| data.len());
        #[allow(clippy::cast_precision_loss)] // seconds for a file
        let time = READER_START + READER_PER_MEGABYTE.mul_f64(bytes as f64 / 1e6);
        self.read_mesh_within(&Limits { time, output: LARGEST_ANSWER, memory }, key, file, monitor)
    }

    fn read_mesh_within(
        &self,
        limits: &Limits,
        key: &str,
        MeshFile { path: file, contact, held, groups, .. }: &MeshFile,
        monitor: &dyn Monitor,
    ) -> Result<Vec<u8>> {
        let mut command = self.module("mesh_in");
        // with = a name may begin with a dash
        command
            .args([format!("--contact={contact}"), format!("--held={held}")])
            .args(groups.iter().map(|group| format!("--material={group}")))
            .arg("--")
            .arg(whole(file));
        let go_on = || monitor.progress(&format!("reading {key}"), 0, 1);
        let ended = match child::run(&mut command, limits, &go_on) {
            Ok(ended) => ended,
            Err(Stop::Asked(stop)) => return Err(stop),
            Err(Stop::Failed(cause)) => return Err(self.missing(&cause.to_string()).into()),
            Err(Stop::Time) => {
                let seconds = limits.time.as_secs_f64();
                return Err(InputError::new(
                    key,
                    format!("\"{}\" (still being read after {seconds:.0} s)", file.display()),
                    format!("a mesh that is read within {seconds:.0} s, which is ample for a file of its size"),
                    "check that the file is whole and what its ending says, or write it in another format (VTU is read \
                     fastest)",
                )
                .into());
            }
            Err(Stop::Memory) => {
                let gib = limits.memory.unwrap_or_default() / (1u64 << 30) as f64;
                return Err(InputError::new(
                    key,
                    format!("\"{}\" (its reader took more than {gib:.2} GiB of memory)", file.display()),
                    format!("a mesh that is read within {gib:.2} GiB"),
                    "check the file, take a coarser mesh, or allow more with --memory-limit",
                )
                .into());
            }
            Err(Stop::Output) => {
                return Err(InputError::new(
                    key,
                    format!(
                        "\"{}\" (more than {} MiB of nodes and elements)",
                        file.display(),
                        limits.output >> 20
                    ),
                    "a mesh of at most some million hexahedra",
                    "take a coarser mesh",
                )
                .into());
            }
        };
        if ended.output.is_empty() {
            // the interpreter has been tried: the file has stopped it
            return Err(InputError::new(
                key,
                format!(
                    "\"{}\" (the reader ended without a mesh: {}, {})",
                    file.display(),
                    last_line(&ended.messages).unwrap_or("no message"),
                    ended.status
                ),
                "a mesh that fits into the memory and is whole",
                "check the file, take a coarser mesh, or write it in another format",
            )
            .into());
        }
        Ok(ended.output)
    }

    /// Runs the reference on an exchange folder, handing its progress on.
    ///
    /// # Errors
    /// [`NumericsError`] where an iteration of the reference does not converge; [`InputError`] with what the
    /// reference said when it failed otherwise; an interruption by the user.
    pub fn run(&self, folder: &Path, monitor: &dyn Monitor) -> Result<()> {
        self.answers("__main__", folder, monitor)
    }

    /// The same for the load case in time of an exchange folder.
    ///
    /// # Errors
    /// As [`Python::run`].
    pub fn run_in_time(&self, folder: &Path, monitor: &dyn Monitor) -> Result<()> {
        self.answers("load_case", folder, monitor)
    }

    fn answers(&self, module: &str, folder: &Path, monitor: &dyn Monitor) -> Result<()> {
        let failed = |cause: std::io::Error| self.missing(&cause.to_string());
        let mut child = self
            .module(module)
            .arg(whole(folder))
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(failed)?;
        let messages = child::messages_of(&mut child);
        let output = BufReader::new(child.stdout.take().expect("stdout is piped"));
        let mut stopped = None;
        for line in output.lines().map_while(std::result::Result::ok) {
            let parts: Vec<&str> = line.split('\t').collect();
            match parts[..] {
                ["PROGRESS", stage, done, total] => {
                    let (done, total) = (done.parse().unwrap_or(0), total.parse().unwrap_or(1));
                    if let Err(stop) = monitor.progress(&format!("reference: {stage}"), done, total) {
                        let _ = child.kill();
                        let _ = child.wait();
                        return Err(stop);
                    }
                }
                ["STOPPED", what, iterations, residual, points] => {
                    stopped = Some(NumericsError {
                        stage: format!("reference: {what}"),
                        step: None,
                        iteration: iterations.parse().unwrap_or(0),
                        residual: residual.parse().unwrap_or(f64::NAN),
                        active: points.parse().unwrap_or(0),
                        reason: StopReason::IterationLimit,
                    });
                }
                _ => {}
            }
        }
        let status = child.wait().map_err(failed)?;
        let said = messages.recv().unwrap_or_default();
        match (status.code(), stopped) {
            (Some(0), None) => Ok(()),
            (Some(NO_ANSWER), Some(stopped)) => Err(stopped.into()),
            (code, _) => Err(InputError::new(
                "reference",
                format!(
                    "{} ({})",
                    last_line(&said).unwrap_or("no message"),
                    code.map_or_else(|| status.to_string(), |code| format!("exit code {code}"))
                ),
                "a reference run that ends",
                format!("the questions that it was asked are in {}", folder.display()),
            )
            .into()),
        }
    }
}

/// A path that means the same in every working folder; a bare name is one to be looked up.
fn whole(path: &Path) -> PathBuf {
    let bare = path.parent() == Some(Path::new("")) && !path.exists();
    if bare { path.to_path_buf() } else { absolute(path).unwrap_or_else(|_| path.to_path_buf()) }
}

fn last_line(text: &str) -> Option<&str> {
    text.lines().rev().map(str::trim).find(|line| !line.is_empty())
}

/// BLAKE3 of those source files of the reference package that answer the static questions of a cross-check; the readers of mesh files are no part of it.
pub fn package_hash() -> String {
    REFERENCE.hash_of_answers()
}

/// The same with those that run load cases in time.
pub fn package_hash_in_time() -> String {
    REFERENCE.hash_in_time()
}

/// Version of an interpreter and of its packages; fails if those that the package needs cannot be imported.
fn probe(of: &Package, interpreter: &Path, place: &Path, monitor: &dyn Monitor) -> Result<String> {
    let mut command = isolated(interpreter, place);
    command.args(["-c", PROBE, of.imports]);
    let ended = answer(of, &mut command, &PROBE_LIMITS, monitor, "looking for Python")?;
    if ended.status.success() {
        return Ok(String::from_utf8_lossy(&ended.output).trim().into());
    }
    let cause = last_line(&ended.messages).unwrap_or("it cannot import the packages");
    Err(of.missing(interpreter, cause).into())
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::PermissionsExt;

    use railspring_profiles::error::Error;
    use railspring_profiles::monitor::Silent;

    use super::*;

    /// An interpreter that knows no Python: it reads for ever, and its reference does as `reference` says.
    fn planted(reference: &str) -> (Python, TempDir) {
        let root = tempfile::tempdir().unwrap();
        let file = root.path().join("python");
        let script = format!(
            "#!/bin/sh\ncase \"$*\" in\n*.mesh_in*) exec sleep 600;;\n*.__main__*) {reference};;\nesac\n"
        );
        std::fs::write(&file, script).unwrap();
        std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o755)).unwrap();
        let python = Python::prepare(Some(&file), root.path(), Purpose::FirstOrder, &Silent);
        (python.unwrap_or_else(|e| panic!("{e}")), root)
    }

    /// Goal: a reader that does not end is killed; the message has the key, the file, the seconds and what to do.
    #[test]
    fn a_reader_that_does_not_end_is_refused() {
        let (python, root) = planted("exit 1");
        let limits = Limits { time: Duration::from_millis(300), output: 1000, memory: None };
        let begun = std::time::Instant::now();
        let file = MeshFile {
            file: "rail.inp".into(),
            path: root.path().join("rail.inp"),
            hash: String::new(),
            unit: 1.0,
            contact: "top".into(),
            held: "foot".into(),
            groups: Vec::new(),
        };
        let said =
            python.read_mesh_within(&limits, "rail.mesh_file", &file, &Silent).unwrap_err().to_string();
        assert!(begun.elapsed() < Duration::from_secs(30));
        assert!(said.starts_with("rail.mesh_file = ") && said.contains("rail.inp"), "{said}");
        assert!(said.contains("still being read after") && said.contains("check that the file"), "{said}");
    }

    /// Goal: an iteration of the reference without an answer is an error of the numerics with its place, its steps and
    /// its residual; any other failure has its words and its exit code.
    #[test]
    fn a_reference_without_an_answer_says_why() {
        let stop = r"printf 'PROGRESS\ta\t1\t2\nSTOPPED\tfriction under 1e+04 N\t200\t0.25\t9\n'; exit 3";
        let (python, root) = planted(stop);
        match python.run(root.path(), &Silent) {
            Err(Error::Numerics(stop)) => {
                assert_eq!(stop.stage, "reference: friction under 1e+04 N");
                assert_eq!((stop.iteration, stop.residual, stop.active), (200, 0.25, 9));
                assert_eq!(stop.reason, StopReason::IterationLimit);
            }
            other => panic!("{other:?}"),
        }
        let (python, root) = planted("echo 'MemoryError: 9 GB' >&2; exit 3");
        let said = python.run(root.path(), &Silent).unwrap_err().to_string();
        assert!(
            said.starts_with("reference = MemoryError: 9 GB (exit code 3): expected a reference run"),
            "{said}"
        );
        // an answer beside a stop is none
        let (python, root) = planted(&stop.replace("exit 3", "exit 0"));
        assert!(python.run(root.path(), &Silent).is_err());
    }
}
