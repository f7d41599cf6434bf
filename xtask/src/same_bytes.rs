//! `cargo xtask same-bytes`: two builds of the program on the same studies, and their files compared byte for byte.
//!
//! Each build has fresh folders and a fresh store. What says the program or the time is masked ([`mask`]).

mod mask;
mod folders;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use clap::Args;
use folders::{Difference, Side, compare};
use railspring::cli::output::say;
use railspring_profiles::error::{Error, InputError, Result};

use crate::workspace::{Workspace, clear, workspace};

/// The study that takes longest, left out unless it is named.
const LARGE: &str = "paper-scale";
/// Folder of the results, in the target folder.
const FOLDER: &str = "same-bytes";
/// Exit code of an interrupted run.
const INTERRUPTED: i32 = 130;

/// Two builds and the studies.
#[derive(Debug, Args)]
pub struct SameBytesArgs {
    /// The executable of one build of railspring
    #[arg(value_name = "OLD")]
    old: PathBuf,
    /// The executable of the other build
    #[arg(value_name = "NEW")]
    new: PathBuf,
    /// Names of studies in data/studies; left out, all but paper-scale
    #[arg(value_name = "STUDY")]
    studies: Vec<String>,
}

/// Runs and compares; whether no file differs. The results stay in `same-bytes` in the target folder.
///
/// # Errors
/// Programs that do not run or refuse a study, studies that do not exist, folders that cannot be written, and an interruption.
pub fn run(args: &SameBytesArgs) -> Result<bool> {
    let workspace = workspace()?;
    let studies = studies(&workspace, &args.studies)?;
    let folder = workspace.target.join(FOLDER);
    let builds = [("old", program(&args.old)?), ("new", program(&args.new)?)];
    let mut rows = Vec::new();
    for (name, file) in &studies {
        let mut sides = Vec::new();
        for (which, (path, version)) in &builds {
            say(&format!("{name}: {which}, {version}"))?;
            let out = folder.join(which).join(name);
            solve(path, file, &out)?;
            sides.push(Side { folder: out, program: version.clone() });
        }
        let found = compare(&sides[0], &sides[1])?;
        rows.extend(found.into_iter().map(|(file, difference)| (name.clone(), file, difference)));
    }
    say(&format!("\n{}{}", table(&rows), folder.display()))?;
    Ok(rows.iter().all(|(_, _, difference)| !matches!(difference, Difference::Differs(_))))
}

/// The path of a program wherever it is called from, and what it says of itself.
fn program(path: &Path) -> Result<(PathBuf, String)> {
    let wrong = |cause: String| InputError::new("program", path.display(), "an executable railspring", cause);
    let path = path.canonicalize().map_err(|cause| wrong(cause.to_string()))?;
    let output = Command::new(&path).arg("--version").stdin(Stdio::null()).output();
    let output = output.map_err(|cause| wrong(cause.to_string()))?;
    let version = String::from_utf8_lossy(&output.stdout).trim().to_string();
    if !version.starts_with("railspring ") {
        return Err(wrong("name a build of railspring".into()).into());
    }
    Ok((path, version))
}

/// The wanted studies with their files, in the order of their names.
fn studies(workspace: &Workspace, wanted: &[String]) -> Result<Vec<(String, PathBuf)>> {
    let folder = workspace.root.join("data/studies");
    let unreadable = |cause: std::io::Error| {
        InputError::new("studies", folder.display(), "a folder that can be read", cause.to_string())
    };
    let entries = std::fs::read_dir(&folder).and_then(Iterator::collect::<std::io::Result<Vec<_>>>);
    let paths = entries.map_err(unreadable)?.into_iter().map(|entry| entry.path());
    let studies = paths.filter(|path| path.extension().is_some_and(|ending| ending == "toml"));
    let named = |path: PathBuf| (path.file_stem().unwrap_or_default().to_string_lossy().into_owned(), path);
    let mut known: Vec<(String, PathBuf)> = studies.map(named).collect();
    known.sort();
    if let Some(other) = wanted.iter().find(|name| known.iter().all(|(known, _)| known != *name)) {
        let names: Vec<&str> = known.iter().map(|(name, _)| name.as_str()).collect();
        return Err(InputError::new("STUDY", other, names.join(", "), "name one of these").into());
    }
    known.retain(|(name, _)| if wanted.is_empty() { name != LARGE } else { wanted.contains(name) });
    Ok(known)
}

/// Runs a study into a fresh folder, with a fresh store that does not stay.
fn solve(program: &Path, study: &Path, out: &Path) -> Result<()> {
    let store = out.with_extension("store");
    for folder in [out, &store] {
        clear(folder)?;
    }
    let mut command = Command::new(program);
    command.arg("run").arg(study).arg("-o").arg(out).arg("--cache").arg(&store).arg("--quiet");
    let status = command.stdin(Stdio::null()).status();
    clear(&store)?;
    let wrong = |cause: String| InputError::new("study", study.display(), "a study that can be run", cause);
    match status.map_err(|cause| wrong(cause.to_string()))?.code() {
        // the verdict is compared as a file
        Some(0 | 1) => Ok(()),
        None | Some(INTERRUPTED) => Err(Error::Interrupted),
        Some(code) => Err(wrong(format!("{} ends with {code}", program.display())).into()),
    }
}

/// All files with what they are in both folders, in Markdown.
fn table(rows: &[(String, String, Difference)]) -> String {
    let mut text = "| study | file | old and new |\n|---|---|---|\n".to_string();
    let mut counts = [0; 4];
    for (study, file, difference) in rows {
        let (kind, said) = match difference {
            Difference::Same => (0, "the same".to_string()),
            Difference::Masked => (1, "the same but for what was masked".into()),
            Difference::Differs(said) => (2, format!("**differs**: {}", said.replace('|', "\\|"))),
            Difference::LeftOut => (3, "left out: times, memory and host differ by nature".into()),
        };
        counts[kind] += 1;
        text += &format!("| {study} | {file} | {said} |\n");
    }
    let [same, masked, differ, left] = counts;
    text += &format!(
        "\n{same} the same, {masked} the same but for what was masked, {differ} differ, {left} left out.\n"
    );
    text + "Masked are version, commit and hashes that depend on them, and times and memory in the report.\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: the large study runs only when it is named, and a name that is none is refused with those that are.
    #[test]
    fn studies_are_chosen_by_name() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("data/studies");
        std::fs::create_dir_all(&folder).unwrap();
        for name in ["b.toml", "a.toml", "paper-scale.toml", "README.md"] {
            std::fs::write(folder.join(name), "").unwrap();
        }
        let root = place.path().to_path_buf();
        let workspace = Workspace { root, target: PathBuf::new(), packages: Vec::new() };
        let names = |wanted: &[&str]| -> Result<Vec<String>> {
            let wanted: Vec<String> = wanted.iter().map(|name| (*name).to_string()).collect();
            Ok(studies(&workspace, &wanted)?.into_iter().map(|(name, _)| name).collect())
        };
        assert_eq!(names(&[]).unwrap(), ["a", "b"]);
        assert_eq!(names(&["paper-scale", "a"]).unwrap(), ["a", "paper-scale"]);
        let message = names(&["c"]).unwrap_err().to_string();
        assert!(message.contains("a, b, paper-scale"), "{message}");
    }

    /// Goal: every file has its row, and the counts say how many differ.
    #[test]
    fn the_table_counts_what_differs() {
        let row = |file: &str, difference| ("s".to_string(), file.to_string(), difference);
        let differs = Difference::Differs("line 1: `a|b` and `c`".into());
        let text = table(&[row("a", Difference::Same), row("b", differs), row("c", Difference::LeftOut)]);
        assert!(text.contains("| s | b | **differs**: line 1: `a\\|b` and `c` |"), "{text}");
        assert!(
            text.contains("1 the same, 0 the same but for what was masked, 1 differ, 1 left out."),
            "{text}"
        );
    }
}
