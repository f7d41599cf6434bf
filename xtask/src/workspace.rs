//! The workspace as cargo knows it: its packages, its target folder and the programs of its tests.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use railspring_profiles::error::{InputError, Result};
use serde_json::Value;

/// The workspace's folders.
#[derive(Debug, Clone, PartialEq)]
pub struct Workspace {
    /// Folder of the root package.
    pub root: PathBuf,
    /// Folder of what cargo builds.
    pub target: PathBuf,
    /// Folders of all packages.
    pub packages: Vec<PathBuf>,
}

/// A program of tests.
#[derive(Debug, Clone, PartialEq)]
pub struct TestProgram {
    /// Folder of its package, in which its tests run.
    pub package: PathBuf,
    /// Name of its package.
    pub name: String,
    /// Its file.
    pub executable: PathBuf,
}

/// The root of the workspace in which this program was built.
pub fn root() -> PathBuf {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    own.parent().unwrap_or(own).to_path_buf()
}

/// Asks cargo for the workspace.
///
/// # Errors
/// What cargo cannot do.
pub fn workspace() -> Result<Workspace> {
    let text = cargo(&["metadata", "--no-deps", "--format-version", "1"])?;
    let value: Value = serde_json::from_str(&text).unwrap_or_default();
    let packages = value["packages"].as_array().into_iter().flatten();
    Ok(Workspace {
        root: path(&value["workspace_root"]),
        target: path(&value["target_directory"]),
        packages: packages.map(|package| folder(&package["manifest_path"])).collect(),
    })
}

/// Takes a folder of results away, if it is there.
///
/// # Errors
/// [`InputError`] for one that cannot be removed.
pub fn clear(folder: &Path) -> Result<()> {
    match std::fs::remove_dir_all(folder) {
        Err(cause) if cause.kind() != std::io::ErrorKind::NotFound => {
            let remedy = "take it away by hand";
            let expected = format!("a folder that can be removed: {cause}");
            Err(InputError::new("results", folder.display(), expected, remedy).into())
        }
        _ => Ok(()),
    }
}

/// The files of a folder and of those in it, in their order.
///
/// # Errors
/// Folders that cannot be read.
pub fn files_below(folder: &Path) -> Result<Vec<PathBuf>> {
    let unreadable = |cause: std::io::Error| {
        InputError::new("folder", folder.display(), "a folder that can be read", cause.to_string())
    };
    let entries = std::fs::read_dir(folder).and_then(Iterator::collect::<std::io::Result<Vec<_>>>);
    let mut paths: Vec<PathBuf> = entries.map_err(unreadable)?.iter().map(std::fs::DirEntry::path).collect();
    paths.sort();
    let mut found = Vec::new();
    for path in paths {
        if path.is_dir() {
            found.extend(files_below(&path)?);
        } else {
            found.push(path);
        }
    }
    Ok(found)
}

/// Builds the programs of all tests.
///
/// # Errors
/// What cargo cannot do.
pub fn test_programs() -> Result<Vec<TestProgram>> {
    let text = cargo(&[
        "test",
        "--release",
        "--workspace",
        "--no-run",
        "--message-format",
        "json-render-diagnostics",
    ])?;
    Ok(programs(&text))
}

/// The programs of tests in the messages of cargo, a JSON object in each line.
fn programs(messages: &str) -> Vec<TestProgram> {
    let program = |line: &str| {
        let message: Value = serde_json::from_str(line).ok()?;
        let executable = message["executable"].as_str()?;
        message["profile"]["test"].as_bool().filter(|test| *test)?;
        let package = folder(&message["manifest_path"]);
        let id = message["package_id"].as_str().unwrap_or_default();
        // `path+file:///folder/name#0.1.0`, or `…#name@0.1.0` where the folder has another name
        let (before, after) = id.rsplit_once('#').unwrap_or((id, ""));
        let name = match after.split_once('@') {
            Some((name, _)) => name,
            None => before.rsplit('/').next().unwrap_or(before),
        };
        Some(TestProgram { package, name: name.into(), executable: executable.into() })
    };
    messages.lines().filter_map(program).collect()
}

fn path(value: &Value) -> PathBuf {
    value.as_str().unwrap_or_default().into()
}

/// The folder of a file.
fn folder(file: &Value) -> PathBuf {
    path(file).parent().unwrap_or(Path::new("")).to_path_buf()
}

/// Standard output of cargo in the root of the workspace; what it says besides goes to the terminal.
///
/// # Errors
/// What cargo cannot do.
pub fn cargo(arguments: &[&str]) -> Result<String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let refused =
        |cause: String| InputError::new("cargo", arguments.join(" "), "a command that cargo can do", cause);
    let output = Command::new(cargo)
        .args(arguments)
        .current_dir(root())
        .stderr(Stdio::inherit())
        .output()
        .map_err(|cause| refused(format!("make cargo available: {cause}")))?;
    if !output.status.success() {
        return Err(refused("repair what cargo says above".into()).into());
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: of cargo's messages those of programs of tests are taken, each with the name of its package.
    #[test]
    fn programs_of_tests_are_found() {
        let message = |id: &str, folder: &str, executable: &str, test: bool| {
            format!(
                r#"{{"reason":"compiler-artifact","package_id":"{id}","manifest_path":"{folder}/Cargo.toml","profile":{{"test":{test}}},"executable":{executable}}}"#
            )
        };
        let messages = [
            message("path+file:///a/one#0.1.0", "/a/one", r#""/t/suite-1""#, true),
            message("path+file:///a/two#other@0.1.0", "/a/two", r#""/t/suite-2""#, true),
            message("path+file:///a/two#other@0.1.0", "/a/two", r#""/t/other""#, false),
            message("path+file:///a/two#other@0.1.0", "/a/two", "null", true),
            r#"{"reason":"build-finished","success":true}"#.into(),
            "no message".into(),
        ];
        let program = |package: &str, name: &str, executable: &str| TestProgram {
            package: package.into(),
            name: name.into(),
            executable: executable.into(),
        };
        let expected = [program("/a/one", "one", "/t/suite-1"), program("/a/two", "other", "/t/suite-2")];
        assert_eq!(programs(&messages.join("\n")), expected);
    }
}
