//! Standard output and standard error may close at any time, or be full.
//!
//! Goal: a reader that has gone away is no error, a device that is full is exit code 2 with what could not be written,
//! and nothing panics (exit code 101).
#![cfg(unix)]

use std::fs::OpenOptions;
use std::process::{Command, Output, Stdio};

const STUDY: &str = include_str!("studies/coarse.toml");

fn railspring(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_railspring"));
    command
        .env("RAILSPRING_CACHE", concat!(env!("CARGO_TARGET_TMPDIR"), "/streams"))
        .args(arguments)
        .stdin(Stdio::null());
    command
}

/// A device that refuses every byte.
fn full() -> Stdio {
    OpenOptions::new().write(true).open("/dev/full").unwrap().into()
}

/// A pipe that nobody reads any more.
fn closed() -> Stdio {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    writer.into()
}

fn code(output: &Output) -> Option<i32> {
    output.status.code()
}

#[test]
fn a_full_device_is_exit_code_2() {
    for arguments in
        [&["schema"][..], &["--help"], &["--version"], &["profile", "list"], &["profile", "show", "60E1"]]
    {
        let output = railspring(arguments).stdout(full()).stderr(Stdio::piped()).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(code(&output), Some(2), "{arguments:?}: {said}");
        assert!(
            said.starts_with("error: standard output = ") && said.lines().count() == 1,
            "{arguments:?}: {said}"
        );
    }
}

#[test]
fn a_closed_pipe_is_no_error() {
    for arguments in [&["schema"][..], &["--help"], &["profile", "list"]] {
        let output = railspring(arguments).stdout(closed()).stderr(Stdio::piped()).output().unwrap();
        assert_eq!((code(&output), output.stderr.len()), (Some(0), 0), "{arguments:?}");
    }
}

#[test]
fn a_lost_standard_error_keeps_the_exit_code() {
    for arguments in [&["run", "nowhere.toml"][..], &["fit"], &["profile", "show", "61E1"]] {
        for lost in [full, closed] {
            let output = railspring(arguments).stderr(lost()).stdout(Stdio::piped()).output().unwrap();
            assert_eq!(code(&output), Some(2), "{arguments:?}");
        }
    }
}

#[test]
fn progress_goes_on_without_a_reader() {
    let root = tempfile::tempdir().unwrap();
    let study = root.path().join("study.toml");
    std::fs::write(&study, STUDY).unwrap();
    let out = root.path().join("out");
    let arguments = ["mesh", study.to_str().unwrap(), "-o", out.to_str().unwrap()];
    let output = railspring(&arguments).stderr(closed()).stdout(closed()).output().unwrap();
    assert_eq!(code(&output), Some(0));
    let arguments = ["calibrate", study.to_str().unwrap(), "-o", out.to_str().unwrap(), "--fresh"];
    for lost in [closed, full] {
        let output = railspring(&arguments).stderr(lost()).stdout(closed()).output().unwrap();
        assert_eq!(code(&output), Some(0), "many lines of progress");
    }
    let output = railspring(&arguments).stderr(full()).stdout(full()).output().unwrap();
    assert_eq!(code(&output), Some(2), "the path of the results cannot be printed");
    assert!(out.join("stiffness.json").exists());
}
