//! Other programs that run a case as this one does: OpenSees on the bridge, and hosts that call the contact element.
//!
//! Each is a process that says how long one of its steps took, in a line with `N us a step`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use railspring_profiles::error::{InputError, Result};
use railspring_profiles::monitor::Monitor;

use super::record::{BRIDGE, HOSTED, HOSTED_STEPS};
use crate::workspace::{cargo, root, workspace};

/// OpenSees, the hosts in Python and what they need: exact versions and hashes.
const LOCK: &str = include_str!("../../../testing/requirements-peers.lock");

/// The study of the load case.
const STUDY: &str = "data/studies/uic60-s1002.toml";

/// Beam elements of the bridges that OpenSees runs; the time of its step grows with their square.
const BRIDGES: [usize; 3] = [20, 40, 80];

/// What a process says of a step.
const A_STEP: &str = " us a step";

/// A program with a case that it runs.
#[derive(Debug)]
pub struct Peer {
    /// Name of the case.
    pub case: &'static str,
    /// Name of the program and of what it uses.
    pub program: &'static str,
    /// Beam elements of the rail; of a host those of the study, whose modes it has.
    pub elements: usize,
    command: Vec<OsString>,
    folder: PathBuf,
    library: PathBuf,
}

/// The programs, and the laws by contact angle with the element that they use.
#[derive(Debug)]
pub struct Peers {
    /// Each with its case.
    pub list: Vec<Peer>,
    /// `stiffness_by_angle.json` of the study.
    pub element: PathBuf,
}

impl Peer {
    /// Runs the case; the time of a step, µs.
    ///
    /// # Errors
    /// A process that fails or says no time, with what it said.
    pub fn microseconds(&self) -> Result<f64> {
        let mut process = Command::new(&self.command[0]);
        process.args(&self.command[1..]).current_dir(&self.folder).env("RAILSPRING_LIBRARY", &self.library);
        // cargo's, where an older library may be
        process.env_remove("LD_LIBRARY_PATH");
        for threads in ["OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"] {
            process.env(threads, "1");
        }
        let said = said(&mut process)?;
        time(&said).ok_or_else(|| {
            let expected = format!("a line with `N{A_STEP}`");
            InputError::new(self.program, said, expected, "repair the program").into()
        })
    }
}

/// The last time of a step in what a process said, µs.
fn time(said: &str) -> Option<f64> {
    let before = &said[..said.rfind(A_STEP)?];
    before.rsplit(char::is_whitespace).next()?.parse().ok()
}

/// Runs a process; what it said on both streams.
fn said(process: &mut Command) -> Result<String> {
    let name = format!("{process:?}");
    let failed = |cause: String, remedy: &str| {
        InputError::new("--peers", &name, "a program that runs", format!("{remedy}: {cause}"))
    };
    let output = process.output().map_err(|cause| failed(cause.to_string(), "install it"))?;
    let said =
        [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
    match output.status.success() {
        true => Ok(said),
        false => Err(failed(said, "see what it says").into()),
    }
}

/// Makes the element of the study, builds the hosts and installs the programs, below `folder`.
///
/// # Errors
/// What cannot be made, with the messages of cargo, the C compiler or Python.
pub fn prepared(folder: &Path, monitor: &dyn Monitor) -> Result<Peers> {
    let unusable = |cause: std::io::Error| {
        InputError::new("--output", folder.display(), "a folder that can be written", cause.to_string())
    };
    // cargo runs in the root
    let folder = &std::fs::create_dir_all(folder).and_then(|()| folder.canonicalize()).map_err(unusable)?;
    let parts = 4;
    let at = |name: &str| folder.join(name);
    let text = |path: &Path| path.display().to_string();
    monitor.progress("programs", 0, parts)?;
    let [file, unit, c, springs] = ["pair.rse", "pair.fmu", "c", "springs"].map(at);
    let element =
        ["run", "--release", "--quiet", "--package", "railspring", "--", "element", STUDY, "--quiet"];
    let files = [("-o", &file), ("--fmu", &unit), ("--c", &c), ("--results", &springs)];
    let files: Vec<String> =
        files.into_iter().flat_map(|(option, path)| [option.into(), text(path)]).collect();
    cargo(&element.into_iter().chain(files.iter().map(String::as_str)).collect::<Vec<_>>())?;
    monitor.progress("programs", 1, parts)?;
    cargo(&["build", "--release", "--quiet", "--package", "railspring-element", "--example", "host"])?;
    let host = workspace()?.target.join("release/examples/host");
    monitor.progress("programs", 2, parts)?;
    let newmark = at("newmark");
    let mut compiler = Command::new("cc");
    compiler
        .current_dir(root().join("element/c/examples"))
        .args(["-std=c99", "-O2", "newmark.c", "-I"])
        .arg(&c);
    compiler.arg("-L").arg(&c).arg(format!("-Wl,-rpath,{}", c.display())).args([
        "-lrailspring_c",
        "-lm",
        "-o",
    ]);
    said(compiler.arg(&newmark))?;
    monitor.progress("programs", 3, parts)?;
    let Some(python) = railspring_testing::locked(folder, "peers", LOCK) else {
        let expected = "Python 3.11 to 3.13 on Linux (x86-64), and the packages of testing/requirements-peers.lock for it";
        return InputError::refuse(
            "--peers",
            "none of them",
            expected,
            "leave --peers out, or install Python",
        );
    };
    monitor.progress("programs", parts, parts)?;
    let library = ["so", "dylib"].map(|end| c.join(format!("librailspring_c.{end}")));
    let library = library.into_iter().find(|path| path.exists()).unwrap_or_default();
    let script = |name: &str| [python.clone(), root().join(name)].map(OsString::from).to_vec();
    let peer = |case, program, elements, mut command: Vec<OsString>, arguments: &[&str]| {
        command.extend(arguments.iter().map(OsString::from));
        Peer { case, program, elements, command, folder: folder.into(), library: library.clone() }
    };
    let steps = HOSTED_STEPS.to_string();
    let (file, unit) = (text(&file), text(&unit));
    let [contact, whole] = ["contact", "unit"].map(|kind| [file.as_str(), kind, steps.as_str()]);
    let hosts = [
        ("host in Rust, contact", vec![host.clone().into()], &contact[..]),
        ("host in C, contact", vec![newmark.into()], &[file.as_str(), steps.as_str()]),
        ("Exudyn, contact", script("examples/element/exudyn_live.py"), &contact),
        ("host in Rust, unit", vec![host.into()], &whole),
        (
            "FMPy, unit of FMI 3.0",
            script("examples/element/fmpy_master.py"),
            &[file.as_str(), unit.as_str(), steps.as_str()],
        ),
        ("Exudyn, unit", script("examples/element/exudyn_live.py"), &whole),
    ];
    let bridges = BRIDGES.into_iter().map(|elements| {
        let script = script("xtask/peers/wheel_rail.py");
        peer(BRIDGE, "OpenSees WheelRail, 2D, no friction", elements, script, &[&elements.to_string()])
    });
    let hosts =
        hosts.into_iter().map(|(program, command, arguments)| peer(HOSTED, program, 20, command, arguments));
    let list = bridges.chain(hosts).collect();
    Ok(Peers { list, element: springs.join("stiffness_by_angle.json") })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: of what a process says the last time of a step is taken, µs; a process that says none, fails or is not there is an error with its words.
    #[test]
    fn a_process_says_the_time_of_a_step() {
        assert_eq!(
            time("5 us a step\n1.02 evaluations and 12.5 us a step, 8.0 us of it in the library\n"),
            Some(12.5)
        );
        assert_eq!(time("12.5 microseconds"), None);
        let peer = |command: &[&str]| Peer {
            case: HOSTED,
            program: "one",
            elements: 20,
            command: command.iter().map(OsString::from).collect(),
            folder: ".".into(),
            library: PathBuf::new(),
        };
        let refused = |command: &[&str]| peer(command).microseconds().unwrap_err().to_string();
        assert!(refused(&["cargo", "--version"]).contains("us a step"));
        assert!(refused(&["cargo", "no-such-command"]).contains("no-such-command"));
        assert!(refused(&["/nowhere/program"]).contains("install it"));
    }
}
