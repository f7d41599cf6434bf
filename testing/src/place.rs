//! A folder in which a test runs the program.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

/// Copies a folder with all that is in it into another one, which is made if need be.
///
/// # Panics
/// If that cannot be read or written.
pub fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("a folder to copy to");
    for entry in std::fs::read_dir(from).expect("a folder to copy") {
        let path = entry.expect("a file to copy").path();
        let target = to.join(path.file_name().expect("a file has a name"));
        if path.is_dir() {
            copy(&path, &target);
        } else {
            std::fs::copy(&path, &target).expect("room for a copy");
        }
    }
}

/// An empty folder for one test, removed at the end, and the program that runs in it.
pub struct Place {
    folder: TempDir,
    program: PathBuf,
    cache: PathBuf,
}

impl Place {
    /// An empty folder; `program` is the file of the program, `cache` its cache folder.
    ///
    /// # Panics
    /// If there is no room for a folder.
    pub fn new(program: impl Into<PathBuf>, cache: impl Into<PathBuf>) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        Self { folder, program: program.into(), cache: cache.into() }
    }

    /// The folder.
    pub fn root(&self) -> &Path {
        self.folder.path()
    }

    /// The path of a file in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.root().join(name)
    }

    /// The text of a file in the folder.
    ///
    /// # Panics
    /// If it cannot be read.
    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap_or_else(|cause| panic!("{name}: {cause}"))
    }

    /// Writes a file of the folder.
    ///
    /// # Panics
    /// If it cannot be written.
    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap_or_else(|cause| panic!("{name}: {cause}"));
    }

    /// A command in the folder, without input.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(&self.program);
        command.current_dir(self.root()).env("RAILSPRING_CACHE", &self.cache).args(arguments);
        command.stdin(Stdio::null());
        command
    }

    /// What becomes of a command in the folder.
    ///
    /// # Panics
    /// If the program cannot be started.
    pub fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().expect("the program of this project")
    }

    /// What becomes of a command on a study of this text, `study.toml`, with a store in the folder.
    ///
    /// # Panics
    /// As [`Self::write`] and [`Self::run`].
    pub fn run_study(&self, arguments: &[&str], study: &str) -> Output {
        self.write("study.toml", study);
        self.run(&[arguments, &["study.toml", "--quiet", "--cache", "store"]].concat())
    }

    /// The same of a command that gives results, whether all limits hold or not.
    ///
    /// # Panics
    /// As [`Self::run_study`], and if it ends otherwise.
    pub fn finish_study(&self, arguments: &[&str], study: &str) {
        let output = self.run_study(arguments, study);
        let text = String::from_utf8_lossy(&output.stderr);
        // 1: a coarse study does not keep all limits
        assert!(matches!(output.status.code(), Some(0 | 1)), "{arguments:?}: {text}");
    }
}

/// What a program has written on standard output.
///
/// # Panics
/// If that is no text.
pub fn said(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("text")
}

/// What a program has written on standard error.
///
/// # Panics
/// If that is no text.
pub fn message(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("text")
}
