//! The shared library of the contact element, which the program hands out; and the commit that the program is built from, for `railspring --version` and the report: of the repository that these files are the root of, or of the
//! package that they were taken from; where there is neither, that is said in its place.

use std::path::Path;
use std::process::Command;

/// What the program is made of; a change of one of these may make the files other than those of the commit.
const SOURCES: [&str; 19] = [
    "src",
    "profiles/src",
    "element/src",
    "element/c/src",
    "element/c/include",
    "calibrate/src",
    "simulate/src",
    "profiles/Cargo.toml",
    "element/Cargo.toml",
    "element/c/Cargo.toml",
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
    c_library();
    let commit = of_repository()
        .or_else(of_package)
        .map_or_else(|| UNKNOWN.into(), |commit| format!("commit {commit}"));
    println!("cargo::rustc-env=RAILSPRING_COMMIT={commit}");
}

/// Builds the shared library of the contact element for the program's own platform. It gets a folder of its own below the target folder, as cargo holds the lock of that one, and its
/// dependencies are some of the program's, which are there already. A package that was unpacked without the library's sources hands out none.
fn c_library() {
    println!("cargo::rustc-check-cfg=cfg(c_library)");
    let (here, out) = (variable("CARGO_MANIFEST_DIR"), variable("OUT_DIR"));
    let manifest = Path::new(&here).join("element/c/Cargo.toml");
    if !manifest.exists() {
        return;
    }
    let target = variable("TARGET");
    // target/PROFILE/build/PACKAGE/out
    let folder = Path::new(&out).ancestors().nth(4).unwrap_or(Path::new(&out)).join("c-library");
    let mut cargo = Command::new(variable("CARGO"));
    cargo.args(["rustc", "--release", "--locked", "--offline", "--quiet", "--crate-type", "cdylib"]);
    cargo.arg("--manifest-path").arg(&manifest).arg("--target-dir").arg(&folder);
    cargo.args(["--target", &target]);
    // what checks the program is not to check its parts instead of building them
    for name in ["RUSTC_WORKSPACE_WRAPPER", "CLIPPY_ARGS", "CARGO_ENCODED_RUSTFLAGS", "CARGO_MAKEFLAGS"] {
        cargo.env_remove(name);
    }
    let built = cargo.output().is_ok_and(|output| {
        if !output.status.success() {
            eprintln!("{}", String::from_utf8_lossy(&output.stderr));
        }
        output.status.success()
    });
    assert!(
        built,
        "the shared library of the contact element was not built: the messages of cargo are above"
    );
    let of = |suffix: &str| format!("{}railspring_c{suffix}", if suffix == ".dll" { "" } else { "lib" });
    let library = [".so", ".dylib", ".dll"].into_iter().find_map(|suffix| {
        let path = folder.join(&target).join("release").join(of(suffix));
        path.exists().then_some((path, suffix))
    });
    let (path, suffix) = library.expect("a shared library of this platform");
    println!("cargo::rustc-cfg=c_library");
    println!("cargo::rustc-env=RAILSPRING_C_LIBRARY={}", path.display());
    println!("cargo::rustc-env=RAILSPRING_C_SUFFIX={suffix}");
    let header = manifest.with_file_name("include").join("railspring.h");
    println!("cargo::rustc-env=RAILSPRING_C_HEADER={}", header.display());
}

/// A variable that cargo sets.
fn variable(name: &str) -> String {
    std::env::var(name).unwrap_or_else(|_| panic!("{name}, which cargo sets"))
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
