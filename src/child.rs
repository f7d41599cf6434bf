//! Running a program with a limit to its time and to what it says.

use std::collections::VecDeque;
use std::io::{self, Read};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use railspring_profiles::error::{Error, Result};

/// Bytes that are kept of messages: the last ones.
const MESSAGES: usize = 64 << 10;
/// Pause between two looks at a running program.
const PAUSE: Duration = Duration::from_millis(50);

/// What a program may take.
pub(crate) struct Limits {
    /// Wall-clock time.
    pub time: Duration,
    /// Bytes on its standard output.
    pub output: u64,
    /// Bytes of memory, where the system says what a program has; none: whatever it takes.
    pub memory: Option<f64>,
}

/// What a program that ended has left.
#[derive(Debug)]
pub(crate) struct Ended {
    pub status: ExitStatus,
    pub output: Vec<u8>,
    /// The last part of its standard error.
    pub messages: String,
}

/// Why there is no answer.
#[derive(Debug)]
pub(crate) enum Stop {
    /// It could not be run or read.
    Failed(io::Error),
    /// It took longer than allowed.
    Time,
    /// It wrote more than allowed.
    Output,
    /// It took more memory than allowed.
    Memory,
    /// The user wants to stop.
    Asked(Error),
}

/// Runs a program to its end. It is killed when it exceeds a limit or when `go_on` fails, which is called while it runs.
pub(crate) fn run(
    command: &mut Command,
    limits: &Limits,
    go_on: &dyn Fn() -> Result<()>,
) -> std::result::Result<Ended, Stop> {
    let deadline = Instant::now() + limits.time;
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(Stop::Failed)?;
    let output = child.stdout.take().expect("stdout is piped");
    let bytes = limits.output;
    // both pipes are read at the same time, for a full one would block the program
    let output = in_thread(move || {
        let mut read = Vec::new();
        output.take(bytes + 1).read_to_end(&mut read).map(|_| read)
    });
    let messages = messages_of(&mut child);
    let id = child.id();
    let look = || match limits.memory.zip(resident(id)) {
        Some((most, taken)) if taken > most => Err(Stop::Memory),
        _ => go_on().map_err(Stop::Asked),
    };
    let result = wait(&mut child, (&output, &messages), limits, deadline, &look);
    if result.is_err() {
        let _ = child.kill();
        let _ = child.wait();
    }
    result
}

fn wait(
    child: &mut Child,
    (output, messages): (&Receiver<io::Result<Vec<u8>>>, &Receiver<String>),
    limits: &Limits,
    deadline: Instant,
    look: &dyn Fn() -> std::result::Result<(), Stop>,
) -> std::result::Result<Ended, Stop> {
    let output = within(output, deadline, look)?.map_err(Stop::Failed)?;
    if output.len() as u64 > limits.output {
        return Err(Stop::Output);
    }
    let messages = within(messages, deadline, look)?;
    loop {
        if let Some(status) = child.try_wait().map_err(Stop::Failed)? {
            return Ok(Ended { status, output, messages });
        }
        if Instant::now() > deadline {
            return Err(Stop::Time);
        }
        look()?;
        std::thread::sleep(PAUSE);
    }
}

/// Bytes of memory that a process has, where the system says it.
fn resident(id: u32) -> Option<f64> {
    let status = std::fs::read_to_string(format!("/proc/{id}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    Some(1024.0 * line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok()?)
}

/// What a thread sends, before the deadline.
fn within<T>(
    from: &Receiver<T>,
    deadline: Instant,
    look: &dyn Fn() -> std::result::Result<(), Stop>,
) -> std::result::Result<T, Stop> {
    loop {
        match from.recv_timeout(PAUSE) {
            Ok(sent) => return Ok(sent),
            Err(RecvTimeoutError::Timeout) if Instant::now() > deadline => return Err(Stop::Time),
            Err(RecvTimeoutError::Timeout) => look()?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(Stop::Failed(io::Error::other("its output could not be read")));
            }
        }
    }
}

/// The last part of what a program writes to its standard error, once that is closed.
pub(crate) fn messages_of(child: &mut Child) -> Receiver<String> {
    let mut errors = child.stderr.take().expect("stderr is piped");
    in_thread(move || {
        let mut last = VecDeque::new();
        let mut piece = [0; 4096];
        while let Ok(read @ 1..) = errors.read(&mut piece) {
            last.extend(&piece[..read]);
            last.drain(..last.len().saturating_sub(MESSAGES));
        }
        String::from_utf8_lossy(last.make_contiguous()).into_owned()
    })
}

fn in_thread<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Receiver<T> {
    let (send, receive) = channel();
    std::thread::spawn(move || send.send(work()));
    receive
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits { time: Duration::from_secs(60), output: 1000, memory: None };

    fn shell(script: &str) -> Command {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        command
    }

    /// Goal: output, status and the end of long messages come back; a full pipe of messages blocks nothing.
    #[test]
    fn what_a_program_says_comes_back() {
        let script = "printf answer; yes filler | head -c 300000 >&2; printf '\\nlast' >&2; exit 3";
        let ended = run(&mut shell(script), &LIMITS, &|| Ok(())).unwrap();
        assert_eq!((ended.status.code(), ended.output.as_slice()), (Some(3), &b"answer"[..]));
        assert!(ended.messages.ends_with("\nlast") && ended.messages.len() == MESSAGES);
    }

    /// Goal: a program that waits, one that never stops writing and one whose user has enough are killed at once.
    #[test]
    fn a_program_beyond_its_limits_is_killed() {
        let begun = Instant::now();
        let short = Limits { time: Duration::from_millis(200), ..LIMITS };
        // the shell's own process, so that killing it kills what waits
        assert!(matches!(run(&mut shell("exec sleep 600"), &short, &|| Ok(())), Err(Stop::Time)));
        // closed pipes do not hide that it goes on
        let silent = "exec >&- 2>&-; exec sleep 600";
        assert!(matches!(run(&mut shell(silent), &short, &|| Ok(())), Err(Stop::Time)));
        assert!(matches!(run(&mut shell("exec yes"), &LIMITS, &|| Ok(())), Err(Stop::Output)));
        let stop = || Err(Error::Interrupted);
        if cfg!(target_os = "linux") {
            // a shell has some hundred kB
            let small = Limits { memory: Some(1e4), ..LIMITS };
            assert!(matches!(run(&mut shell("exec sleep 600"), &small, &|| Ok(())), Err(Stop::Memory)));
            let ample = Limits { memory: Some(1e9), ..LIMITS };
            assert!(run(&mut shell("sleep 0.2"), &ample, &|| Ok(())).unwrap().status.success());
        }
        let asked = run(&mut shell("exec sleep 600"), &LIMITS, &stop);
        assert!(matches!(asked, Err(Stop::Asked(Error::Interrupted))));
        let absent = run(&mut Command::new("/no/such/program"), &LIMITS, &|| Ok(()));
        assert!(matches!(absent, Err(Stop::Failed(_))));
        assert!(begun.elapsed() < Duration::from_secs(30));
    }
}
