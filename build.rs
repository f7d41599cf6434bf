//! The commit that the program is built from, for `railspring --version` and the report: of the repository that these files are the root of, or of the
//! package that they were taken from; where there is neither, that is said in its place.

use std::path::Path;
use std::process::Command;

/// What the program is made of; a change of one of these may make the files other than those of the commit.
const SOURCES: [&str; 14] = [
    "src",
    "profiles/src",
    "calibrate/src",
    "simulate/src",
    "profiles/Cargo.toml",
    "calibrate/Cargo.toml",
    "simulate/Cargo.toml",
    "data/templates",
    "docs/verdict.md",
    "reference",
    "cluster",
    "build.rs",
    "Cargo.toml",
    "Cargo.lock",
];
/// Digits of a commit.
const DIGITS: usize = 12;
/// What is said where there is no commit.
const UNKNOWN: &str = "built outside of its repository, commit not known";

fn main() {
    for source in SOURCES.into_iter().filter(|source| Path::new(source).exists()) {
        println!("cargo::rerun-if-changed={source}");
    }
    let commit = of_repository()
        .or_else(of_package)
        .map_or_else(|| UNKNOWN.into(), |commit| format!("commit {commit}"));
    println!("cargo::rustc-env=RAILSPRING_COMMIT={commit}");
}

/// The commit of the repository, with what is said where the sources are not its own.
fn of_repository() -> Option<String> {
    let here = std::env::var("CARGO_MANIFEST_DIR").ok()?;
    // a repository around a package that was unpacked somewhere in it is another one
    let root = git(&["rev-parse", "--show-toplevel"])?;
    if Path::new(&root).canonicalize().ok()? != Path::new(&here).canonicalize().ok()? {
        return None;
    }
    // a commit writes there, whatever branch it is on
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]).filter(|log| Path::new(log).exists()) {
        println!("cargo::rerun-if-changed={log}");
    }
    let commit = git(&["rev-parse", "HEAD"])?;
    let status = git(&[&["status", "--porcelain", "--"][..], &SOURCES].concat())?;
    let changed = if status.is_empty() { "" } else { " and changes" };
    Some(format!("{}{changed}", commit.get(..DIGITS)?))
}

/// The commit that `cargo package` notes in a package.
fn of_package() -> Option<String> {
    let text = std::fs::read_to_string(".cargo_vcs_info.json").ok()?;
    let (_, rest) = text.split_once("\"sha1\"")?;
    let commit: String =
        rest.chars().skip_while(|c| !c.is_ascii_hexdigit()).take_while(char::is_ascii_hexdigit).collect();
    Some(commit.get(..DIGITS)?.to_string())
}

/// What git answers; none where it cannot.
fn git(arguments: &[&str]) -> Option<String> {
    let output =
        Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_string())
}
