//! `cargo xtask bench fleet`: a table of many synthetic measured wheels, timed as a user runs it, and once more with some new files.

mod files;
mod record;
mod wheels;

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use railspring::cli::output::say;
use railspring::engine::measure::{machine, now_utc, peak_in};
use railspring::engine::output::OutputFolder;
use railspring_profiles::error::{Error, InputError, Result};

use crate::workspace::{clear, workspace};

use files::{size, unwritable};
use record::{FleetRecord, FleetRun, Rows};

/// Most wheels of a run.
pub const WHEELS_MOST: i64 = 1_000_000;

/// Folders and files in the output folder.
const WHEELS: &str = "wheels";
const TABLE: &str = "fleet.toml";
const STORE: &str = "store";
const RESULTS: &str = "results";
/// The measured numbers.
const RECORD: &str = "fleet.json";
/// The table: five shifts and six loads for each wheel.
const TEXT: &str = r#"name = "fleet"
shifts_mm = [-4, -2, 0, 2, 4]
stiffness_at_kn = [20, 60, 100]

[study.calibration]
loads_kn = [10, 20, 40, 60, 80, 100]
error_band = false

[[wheel]]
folder = "wheels"
standard = "S1002"
name_pattern = "{vehicle}_{axle}"

[[rail]]
profile = "60E1"
"#;
/// Pause between two looks at the memory of the program.
const PAUSE: Duration = Duration::from_millis(50);
/// Exit code of an interrupted run.
const INTERRUPTED: i32 = 130;
/// Clock ticks in a second, as Linux states them to programs.
const TICKS: f64 = 100.0;

/// What is to be measured.
pub struct Fleet<'a> {
    /// Wheels of the first run, and further ones of the second.
    pub wheels: [usize; 2],
    /// The build of railspring; none: that beside this program.
    pub program: Option<&'a Path>,
    /// Further arguments of `railspring table`.
    pub arguments: &'a [String],
    /// Where everything goes.
    pub folder: &'a OutputFolder,
}

impl Fleet<'_> {
    /// Writes the wheels, makes their table, adds the further ones, and makes it again. The store is a fresh one.
    ///
    /// # Errors
    /// A program that is not there or ends with 2, folders that cannot be written, and an interruption.
    pub fn measured(&self) -> Result<FleetRecord> {
        let [first, further] = self.wheels;
        let path = self.folder.path();
        for old in [WHEELS, STORE, RESULTS] {
            clear(&path.join(old))?;
        }
        let folder = path.join(WHEELS);
        std::fs::create_dir_all(&folder).map_err(|cause| unwritable(&folder, &cause))?;
        let write = |numbers: std::ops::Range<usize>| {
            numbers.into_iter().try_for_each(|number| wheels::write(&folder, number))
        };
        self.folder.write(TABLE, TEXT.as_bytes())?;
        let mut record = FleetRecord {
            begun_utc: now_utc(),
            machine: machine(),
            arguments: self.arguments.to_vec(),
            runs: Vec::new(),
        };
        for (from, to) in [(0, first), (first, first + further)] {
            if from < to {
                write(from..to)?;
                let run = self.run(to)?;
                say(&run.line())?;
                record.runs.push(run);
                self.folder.write_json(RECORD, &record)?;
            }
        }
        Ok(record)
    }

    /// One run of the table.
    fn run(&self, wheels: usize) -> Result<FleetRun> {
        let path = self.folder.path();
        let program = match self.program {
            Some(program) => program.to_path_buf(),
            None => workspace()?
                .target
                .join("release")
                .join(format!("railspring{}", std::env::consts::EXE_SUFFIX)),
        };
        let wrong =
            |cause: String| InputError::new("--program", program.display(), "a build of railspring", cause);
        let mut command = Command::new(&program);
        command.arg("table").arg(path.join(TABLE)).arg("--quiet");
        command.arg("-o").arg(path.join(RESULTS)).arg("--cache").arg(path.join(STORE));
        let begun = Instant::now();
        let child = command.args(self.arguments).stdin(Stdio::null()).spawn();
        let mut child =
            child.map_err(|cause| wrong(format!("{cause}; build it with cargo build --release")))?;
        let (code, used) = watched(&mut child).map_err(|cause| wrong(cause.to_string()))?;
        let seconds = begun.elapsed().as_secs_f64();
        match code {
            // a broken file is reported in its rows
            Some(0 | 1) => {}
            None | Some(INTERRUPTED) => return Err(Error::Interrupted),
            Some(code) => return Err(wrong(format!("it ends with {code}")).into()),
        }
        Ok(FleetRun {
            wheels,
            seconds: rounded(seconds, 10.0),
            computing_seconds: used.seconds.map(|seconds| rounded(seconds, 10.0)),
            peak_memory_mib: used.memory_mib.map(|mib| rounded(mib, 1.0)),
            store_mb: rounded(size(&path.join(STORE)) as f64 * 1e-6, 1.0),
            results_mb: rounded(size(&path.join(RESULTS)) as f64 * 1e-6, 1.0),
            rows: Rows::read(&path.join(RESULTS).join("table.csv"))?,
        })
    }
}

/// What a process has used, where the system tells it.
#[derive(Default)]
struct Used {
    /// Time of its processors, s.
    seconds: Option<f64>,
    /// Largest resident memory, MiB.
    memory_mib: Option<f64>,
}

/// Waits for a process; its exit code and what it has used up to the last look.
fn watched(child: &mut Child) -> std::io::Result<(Option<i32>, Used)> {
    let mut used = Used::default();
    let folder = PathBuf::from(format!("/proc/{}", child.id()));
    loop {
        let read = |file: &str| std::fs::read_to_string(folder.join(file)).unwrap_or_default();
        used.memory_mib = peak_in(&read("status")).or(used.memory_mib);
        used.seconds = processor_time(&read("stat")).or(used.seconds);
        if let Some(status) = child.try_wait()? {
            return Ok((status.code(), used));
        }
        std::thread::sleep(PAUSE);
    }
}

/// User and system time by `/proc/PID/stat`, s: fields 14 and 15, of which the second stands in brackets.
fn processor_time(stat: &str) -> Option<f64> {
    let (_, fields) = stat.rsplit_once(')')?;
    let mut times = fields.split_whitespace().skip(11).map_while(|field| field.parse::<f64>().ok());
    Some((times.next()? + times.next()?) / TICKS)
}

fn rounded(value: f64, parts: f64) -> f64 {
    (value * parts).round() / parts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: proc(5). Goal: the fields are those of user and system time, also where the name has brackets and blanks.
    #[test]
    fn processor_time_is_user_and_system_time() {
        let stat = "42 (a) b (c) S 1 42 42 0 -1 4194304 100 0 0 0 250 50 7 8 20 0 3 0 1000 1 1";
        assert_eq!(processor_time(stat), Some(3.0));
        assert_eq!(processor_time(""), None);
        assert_eq!(peak_in("VmPeak:\t 9 kB\nVmHWM:\t 2048 kB\n"), Some(2.0));
    }
}
