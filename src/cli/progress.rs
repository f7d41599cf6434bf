//! Progress on the terminal, or as plain lines where there is none; and the
//! interruption with Ctrl-C.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use indicatif::{ProgressBar, ProgressStyle};
use railspring_calibrate::error::{Error, Result, printable};
use railspring_calibrate::monitor::Monitor;

use super::output::remark;

/// Set by the first Ctrl-C.
static STOP: AtomicBool = AtomicBool::new(false);

/// Most characters of a line.
const LONGEST: usize = 2000;

/// Shows how far the stages are.
pub(super) struct Progress {
    style: Style,
    state: Mutex<State>,
}

#[derive(PartialEq)]
enum Style {
    Quiet,
    Lines,
    Bar,
}

#[derive(Default)]
struct State {
    stage: String,
    /// Tenths of the stage that were reported.
    tenths: usize,
    bar: Option<ProgressBar>,
}

impl Progress {
    /// Listens to Ctrl-C and shows progress unless `quiet`.
    pub(super) fn new(quiet: bool) -> Self {
        // A handler can be set only once in a process; a second attempt changes nothing.
        let _ = ctrlc::set_handler(|| {
            if STOP.swap(true, Ordering::SeqCst) {
                std::process::exit(130);
            }
            remark("stopping after this step; press Ctrl-C again to stop at once");
        });
        let style = match quiet {
            true => Style::Quiet,
            false if std::io::stderr().is_terminal() => Style::Bar,
            false => Style::Lines,
        };
        Self { style, state: Mutex::new(State::default()) }
    }

    /// Clears the bar.
    pub(super) fn finish(&self) {
        if let Some(bar) = self.state.lock().expect("no thread panics while it reports").bar.take() {
            bar.finish_and_clear();
        }
    }
}

impl Monitor for Progress {
    fn progress(&self, stage: &str, done: usize, total: usize) -> Result<()> {
        if STOP.load(Ordering::SeqCst) {
            return Err(Error::Interrupted);
        }
        if self.style == Style::Quiet {
            return Ok(());
        }
        let mut state = self.state.lock().expect("no thread panics while it reports");
        let new_stage = state.stage != stage;
        if new_stage {
            state.stage = stage.to_string();
            state.tenths = 0;
        }
        let tenths = (10 * done).checked_div(total).unwrap_or(10);
        match self.style {
            Style::Bar => {
                if new_stage && let Some(old) = state.bar.take() {
                    old.finish_and_clear();
                }
                let bar = state.bar.get_or_insert_with(|| bar(stage));
                bar.set_length(total as u64);
                bar.set_position(done as u64);
            }
            Style::Lines if new_stage || tenths > state.tenths => {
                remark(&format!("{stage}: {done} of {total}"));
            }
            _ => {}
        }
        state.tenths = tenths;
        Ok(())
    }

    fn notice(&self, text: &str) {
        let say = || remark(text);
        let state = self.state.lock().expect("no thread panics while it reports");
        match (&self.style, &state.bar) {
            (Style::Quiet, _) => {}
            (_, Some(bar)) => bar.suspend(say),
            (_, None) => say(),
        }
    }
}

fn bar(stage: &str) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg:32} {wide_bar} {pos}/{len} {elapsed}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(0).with_style(style).with_message(printable(stage.into(), LONGEST))
}
