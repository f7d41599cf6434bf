//! `cargo xtask long`: the tests that are ignored otherwise, one after another, with a table of them.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use clap::Args;
use railspring::cli::output::say;
use railspring::cli::progress::Progress;
use railspring_profiles::error::{Error, InputError, Result};
use railspring_profiles::monitor::Monitor;

use crate::ignored::{IgnoredTest, ignored_tests};
use crate::workspace::{TestProgram, Workspace, test_programs, workspace};

/// The table, in the target folder.
const TABLE: &str = "long.md";
/// What a test says on a line that goes without what it needs (`railspring_testing::needs`).
const SKIPPED: &str = "SKIPPED (";
/// The same where only a part of the test is left out.
const IN_PART: &str = "SKIPPED (in part)";

/// Which tests, and whether they run.
#[derive(Debug, Args)]
pub struct LongArgs {
    /// Part of the names of the tests that are wanted, module included; left out, all
    #[arg(value_name = "NAME", default_value = "", hide_default_value = true)]
    name: String,
    /// List the tests and run none
    #[arg(long)]
    list: bool,
}

/// An ignored test and where it runs.
#[derive(Debug, Clone, PartialEq)]
struct LongTest {
    program: TestProgram,
    /// Its name in the program, modules first.
    name: String,
    /// What it proves.
    proves: String,
}

impl LongTest {
    /// Its name with that of its package.
    fn full_name(&self) -> String {
        format!("{} {}", self.program.name, self.name)
    }
}

/// What became of a test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    Passed,
    Failed,
    /// It went without what it needs.
    Skipped,
    /// It was interrupted.
    Stopped,
}

impl Outcome {
    fn word(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Failed => "failed",
            Self::Skipped => "skipped",
            Self::Stopped => "stopped",
        }
    }
}

/// Runs or lists the wanted tests; whether none failed.
///
/// # Errors
/// What cargo cannot do, a name that no test has, and an interruption.
pub fn run(args: &LongArgs) -> Result<bool> {
    let workspace = workspace()?;
    let tests = wanted(&workspace, &args.name)?;
    if args.list {
        for test in &tests {
            say(&format!("{}: {}", test.full_name(), test.proves))?;
        }
        return Ok(true);
    }
    let file = workspace.target.join(TABLE);
    let progress = Progress::new(true);
    let mut done: Vec<(&LongTest, f64, Outcome)> = Vec::new();
    for test in &tests {
        say(&format!("\n== {}: {}", test.full_name(), test.proves))?;
        let begun = Instant::now();
        let found = run_one(test)?;
        let interrupted = progress.progress("tests", done.len(), tests.len()).is_err();
        let outcome = if interrupted && found != Outcome::Passed { Outcome::Stopped } else { found };
        done.push((test, begun.elapsed().as_secs_f64(), outcome));
        write(&file, &table(&done))?;
        if interrupted {
            break;
        }
    }
    say(&format!("\n{}{}", table(&done), file.display()))?;
    progress.progress("tests", done.len(), tests.len())?;
    if done.len() < tests.len() {
        return Err(Error::Interrupted);
    }
    Ok(done.iter().all(|(_, _, outcome)| *outcome != Outcome::Failed))
}

/// The tests whose names have `part` in them.
fn wanted(workspace: &Workspace, part: &str) -> Result<Vec<LongTest>> {
    let described = ignored_tests(workspace)?;
    let mut tests = Vec::new();
    for program in test_programs()? {
        let output = command(&program, &["--ignored", "--list"])
            .output()
            .map_err(|cause| not_run(&program.executable, &cause))?;
        for name in listed(&String::from_utf8_lossy(&output.stdout)) {
            let proves = proves(&described, &program.package, &name);
            tests.push(LongTest { program: program.clone(), name, proves });
        }
    }
    tests.retain(|test| test.full_name().contains(part));
    if tests.is_empty() {
        return Err(InputError::new(
            "NAME",
            part,
            "a part of the name of an ignored test",
            "see `cargo long --list`",
        )
        .into());
    }
    Ok(tests)
}

/// The names in the list of a test program.
fn listed(text: &str) -> Vec<String> {
    text.lines().filter_map(|line| Some(line.strip_suffix(": test")?.to_string())).collect()
}

/// What the source says of a test.
fn proves(described: &[IgnoredTest], package: &Path, name: &str) -> String {
    let function = name.rsplit("::").next().unwrap_or(name);
    let of_test = |test: &&IgnoredTest| test.package == package && test.function == function;
    described.iter().find(of_test).map(|test| test.proves.clone()).unwrap_or_default()
}

/// A test program in the folder and with the variables that cargo gives it.
fn command(program: &TestProgram, arguments: &[&str]) -> Command {
    let mut command = Command::new(&program.executable);
    command.args(arguments).current_dir(&program.package).stdin(Stdio::null());
    command.env("CARGO_MANIFEST_DIR", &program.package).env("CARGO_PKG_NAME", &program.name);
    command
}

/// Runs a test and lets its output through.
fn run_one(test: &LongTest) -> Result<Outcome> {
    let mut command = command(&test.program, &["--ignored", "--exact", &test.name, "--nocapture"]);
    let failed = |cause: std::io::Error| not_run(&test.program.executable, &cause);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().map_err(failed)?;
    let (out, err) = (child.stdout.take(), child.stderr.take());
    let skipped = std::thread::scope(|scope| {
        let other = scope.spawn(move || err.is_some_and(|err| let_through(err, &mut std::io::stderr())));
        let own = out.is_some_and(|out| let_through(out, &mut std::io::stdout()));
        other.join().unwrap_or(false) || own
    });
    let status = child.wait().map_err(failed)?;
    Ok(match (status.success(), skipped) {
        (false, _) => Outcome::Failed,
        (true, true) => Outcome::Skipped,
        (true, false) => Outcome::Passed,
    })
}

/// Copies what a test writes; whether it says that it was skipped.
fn let_through(from: impl Read, to: &mut impl Write) -> bool {
    let (mut from, mut line, mut skipped) = (BufReader::new(from), Vec::new(), false);
    while from.read_until(b'\n', &mut line).is_ok_and(|count| count > 0) {
        skipped |= says_skipped(&String::from_utf8_lossy(&line));
        // nobody may hear it
        let _ = to.write_all(&line).and_then(|()| to.flush());
        line.clear();
    }
    skipped
}

fn says_skipped(line: &str) -> bool {
    line.contains(SKIPPED) && !line.contains(IN_PART)
}

/// The table of the tests so far, in Markdown.
fn table(done: &[(&LongTest, f64, Outcome)]) -> String {
    let mut text = "| test | what it proves | seconds | outcome |\n|---|---|---|---|\n".to_string();
    for (test, seconds, outcome) in done {
        let (name, proves) = (test.full_name(), test.proves.replace('|', "\\|"));
        text += &format!("| {name} | {proves} | {seconds:.1} | {} |\n", outcome.word());
    }
    let count = |wanted: Outcome| done.iter().filter(|(_, _, outcome)| *outcome == wanted).count();
    let counts = [Outcome::Passed, Outcome::Failed, Outcome::Skipped, Outcome::Stopped]
        .map(|outcome| format!("{} {}", count(outcome), outcome.word()));
    text + &format!("\n{}\n", counts.join(", "))
}

fn write(file: &Path, text: &str) -> Result<()> {
    std::fs::write(file, text).map_err(|cause| {
        InputError::new("table", file.display(), "a file that can be written", cause.to_string()).into()
    })
}

fn not_run(program: &Path, cause: &std::io::Error) -> Error {
    InputError::new("test program", program.display(), "a program that runs", cause.to_string()).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: names are taken from the list of a test program, which has other lines too.
    #[test]
    fn names_are_taken_from_the_list() {
        let text =
            "a::b: test\nc: benchmark\nd: test\n\n2 tests, 1 benchmark\nSKIPPED (x): y: z is not there\n";
        assert_eq!(listed(text), ["a::b", "d"]);
    }

    /// Goal: what is let through stays as it is, and a test counts as skipped only where it ran in no part.
    #[test]
    fn a_skipped_test_is_heard() {
        let said = |text: &str| {
            let mut through = Vec::new();
            let skipped = let_through(text.as_bytes(), &mut through);
            assert_eq!(through, text.as_bytes());
            skipped
        };
        assert!(said("one\nSKIPPED (python): suite: a: Python is not there\nend"));
        assert!(!said("one\nSKIPPED (in part): suite: a: b is not there\n"));
    }

    /// Goal: a row for each test, a count of each outcome, and no bar that begins another column.
    #[test]
    fn the_table_has_every_test() {
        let program =
            TestProgram { package: "/p".into(), name: "railspring".into(), executable: "/t/suite".into() };
        let test = LongTest { program, name: "a::b".into(), proves: "x | y".into() };
        let text = table(&[(&test, 1.5, Outcome::Passed), (&test, 0.0, Outcome::Failed)]);
        assert!(text.contains("| railspring a::b | x \\| y | 1.5 | passed |"), "{text}");
        assert!(text.ends_with("\n1 passed, 1 failed, 0 skipped, 0 stopped\n"), "{text}");
    }
}
