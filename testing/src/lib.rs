//! What tests need that is not part of the project (tables of other programs, Python, CalculiX, OpenSees, STEM), and counting the tests
//! that are skipped without it; besides, random numbers, drawings, a folder in which the program runs, and waiting for what a process writes.
//!
//! A test cannot tell cargo at run time that it was skipped: it counts as passed. So it says so on a line of its own that
//! cargo does not hold back, and leaves a mark in the target folder, which it takes away when it finds what it needs.
//! The test target `skipped` of this package and `.ci/run` count them.

pub mod dxf;
pub mod fuzz;
mod place;
mod programs;
mod random;
pub mod shapes;
pub mod measured;

use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

pub use place::{Place, copy, message, said};
pub use programs::{exudyn, fmpy, locked, opensees, stem, stem_with_kratos};
pub use random::Random;

/// What a test can go without.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// A file of the shared facts, which are not part of the project.
    Facts,
    /// Python 3.11 or newer.
    Python,
    /// CalculiX.
    Calculix,
    /// OpenSees as a Python package.
    OpenSees,
    /// The vehicle models of STEM.
    Stem,
    /// Python packages from the index.
    Packages,
    /// A C compiler.
    Compiler,
    /// A Fortran compiler, for some of its tests; the others are done.
    Fortran,
    /// A file system of a given size, which fills up.
    SmallDisk,
    /// The faster solver of the reference, for some of its tests; the others are done.
    Solver,
}

impl Need {
    /// Word on the line of a skipped test.
    fn word(self) -> &'static str {
        match self {
            Self::Facts => "facts",
            Self::Python => "python",
            Self::Calculix => "calculix",
            Self::OpenSees => "opensees",
            Self::Stem => "stem",
            Self::Packages => "packages",
            Self::Compiler => "compiler",
            Self::SmallDisk => "small disk",
            Self::Solver | Self::Fortran => "in part",
        }
    }
}

/// Waits until the `state` of what a process writes has changed so many times, or the process has ended.
///
/// # Panics
/// If the process cannot be asked.
pub fn await_changes<T: PartialEq>(child: &mut Child, changes: u64, state: impl Fn() -> T) {
    let (mut last, mut seen) = (state(), 0);
    while seen < changes && child.try_wait().expect("a process that was begun").is_none() {
        let now = state();
        seen += u64::from(now != last);
        last = now;
        std::thread::sleep(Duration::from_micros(200));
    }
}

/// The file `below` of the shared facts (`RAILSPRING_FACTS`, else `../shared/facts` beside the project); `None`, and the
/// test is counted as skipped, where it is not there.
pub fn facts(below: &str) -> Option<PathBuf> {
    let root = std::env::var_os("RAILSPRING_FACTS")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/facts"), PathBuf::from);
    let file = root.join(below);
    needs(Need::Facts, below, file.exists()).then_some(file)
}

/// The text of a file of [`facts`].
///
/// # Panics
/// When the file is there and cannot be read.
pub fn facts_text(below: &str) -> Option<String> {
    facts(below).map(|file| {
        std::fs::read_to_string(&file).unwrap_or_else(|cause| panic!("{}: {cause}", file.display()))
    })
}

/// Whether there is a Python from which the tool makes its environment; where there is none the test is counted as
/// skipped. That the environment cannot be made is a failure, though.
pub fn python() -> bool {
    let suitable = "import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))";
    let there = ["python3", "python"].into_iter().any(|name| {
        let output = Command::new(name).args(["-I", "-c", suitable]).stdin(Stdio::null()).output();
        output.is_ok_and(|output| output.status.success())
    });
    needs(Need::Python, "Python 3.11 or newer with venv", there)
}

/// Notes whether the running test has the `item` that it needs, and returns the answer.
pub fn needs(need: Need, item: &str, there: bool) -> bool {
    let thread = std::thread::current();
    let name = format!("{}: {}", program(), thread.name().unwrap_or("unnamed"));
    let mark = folder().join(file_name(&format!("{name}, {item}")));
    if there {
        let _ = std::fs::remove_file(mark);
    } else {
        // written at once and past the capture of the test's output
        let line = format!("SKIPPED ({}): {name}: {item} is not there\n", need.word());
        let _ = std::io::stderr().write_all(line.as_bytes());
        let _ = std::fs::create_dir_all(folder()).and_then(|()| std::fs::write(mark, line));
    }
    there
}

/// Names of the tests that were skipped when they last ran, with what they went without.
pub fn skipped() -> BTreeSet<String> {
    std::fs::read_dir(folder())
        .into_iter()
        .flatten()
        .filter_map(|entry| std::fs::read_to_string(entry.ok()?.path()).ok())
        .map(|line| line.trim_end().to_owned())
        .collect()
}

/// Folder of the marks, beside the programs of the tests.
fn folder() -> PathBuf {
    let program = std::env::current_exe().unwrap_or_default();
    // target/release/deps/name-hash
    program.ancestors().nth(2).unwrap_or(Path::new(".")).join("skipped")
}

/// Name of the test target, without its hash.
fn program() -> String {
    let path = std::env::current_exe().unwrap_or_default();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    stem.rsplit_once('-').map_or(stem.clone(), |(name, _)| name.to_owned())
}

fn file_name(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: a skipped test is counted until it has what it needs.
    #[test]
    fn a_skipped_test_is_counted_until_it_runs() {
        let here =
            |lines: BTreeSet<String>| lines.iter().filter(|line| line.contains("a made-up need")).count();
        assert!(!needs(Need::Calculix, "a made-up need", false));
        assert_eq!(here(skipped()), 1);
        let line = skipped().into_iter().find(|line| line.contains("a made-up need")).unwrap();
        assert!(line.starts_with("SKIPPED (calculix): railspring_testing: tests::a_skipped_test"), "{line}");
        assert!(needs(Need::Calculix, "a made-up need", true));
        assert_eq!(here(skipped()), 0);
    }
}
