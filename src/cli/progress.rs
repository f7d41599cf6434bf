//! Progress on the terminal, or as plain lines where there is none; and the
//! interruption with Ctrl-C.

use std::fmt::Write;
use std::io::IsTerminal;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use indicatif::{MultiProgress, ProgressBar, ProgressState, ProgressStyle};
use railspring_profiles::error::{Error, Result, printable};
use railspring_profiles::monitor::Monitor;

use super::output::remark;

/// Set by the first Ctrl-C.
static STOP: AtomicBool = AtomicBool::new(false);

/// Steps from which on they are taken to be alike, so that the rest takes as long for each as those before: a tenth of them has to be done.
const STEPS_ALIKE: u64 = 30;
/// How often the time of a bar goes on.
const TICK: Duration = Duration::from_millis(250);

/// Most characters of a line.
const LONGEST: usize = 2000;

/// Shows how far the stages are: a bar for each that is under way, or lines.
pub struct Progress {
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
    /// The stages that are under way: several may be at the same time.
    stages: Vec<Stage>,
    bars: MultiProgress,
}

/// A stage that is under way.
struct Stage {
    name: String,
    /// Tenths that were reported.
    tenths: usize,
    bar: Option<ProgressBar>,
}

impl State {
    /// The place of a stage that is not `done` with anything, or is, and whether it begins now: anew if more was reported of it.
    fn place(&mut self, name: &str, done: usize) -> (usize, bool) {
        if let Some(known) = self.stages.iter().position(|stage| stage.name == name) {
            let begins = done == 0 && self.stages[known].tenths > 0;
            if begins {
                self.stages[known].tenths = 0;
            }
            return (known, begins);
        }
        self.stages.push(Stage { name: name.into(), tenths: 0, bar: None });
        (self.stages.len() - 1, true)
    }

    fn clear(&mut self) {
        for bar in self.stages.drain(..).filter_map(|stage| stage.bar) {
            bar.finish_and_clear();
        }
    }
}

impl Progress {
    /// Listens to Ctrl-C and shows progress unless `quiet`.
    pub fn new(quiet: bool) -> Self {
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

    /// Clears the bars.
    pub fn finish(&self) {
        self.state.lock().expect("no thread panics while it reports").clear();
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
        let (place, begins) = state.place(stage, done);
        let State { stages, bars } = &mut *state;
        let tenths = (10 * done).checked_div(total).unwrap_or(10);
        let under_way = &mut stages[place];
        match self.style {
            Style::Bar => {
                let bar = under_way.bar.get_or_insert_with(|| bars.add(bar(stage, total)));
                bar.set_length(total as u64);
                bar.set_position(done as u64);
            }
            Style::Lines if begins || tenths > under_way.tenths => {
                remark(&format!("{stage}: {done} of {total}"));
            }
            _ => {}
        }
        under_way.tenths = under_way.tenths.max(tenths);
        if done >= total
            && let Some(bar) = stages.remove(place).bar
        {
            bar.finish_and_clear();
        }
        Ok(())
    }

    fn notice(&self, text: &str) {
        let state = self.state.lock().expect("no thread panics while it reports");
        match self.style {
            Style::Quiet => {}
            Style::Bar => state.bars.suspend(|| remark(text)),
            Style::Lines => remark(text),
        }
    }
}

/// A bar whose time goes on while a single step takes long, as a factorisation does.
fn bar(stage: &str, total: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg:40} {wide_bar} {pos}/{len} {elapsed}{left}")
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .with_key("left", |state: &ProgressState, text: &mut dyn Write| {
            let done = state.pos();
            if let Some(all) = state.len().filter(|all| *all >= STEPS_ALIKE && done >= STEPS_ALIKE / 10) {
                let seconds = state.elapsed().as_secs_f64() * (all.saturating_sub(done)) as f64 / done as f64;
                // a text that takes no more of it is none of ours
                let _ = write!(text, ", about {seconds:.0} s left");
            }
        });
    let bar = ProgressBar::new(total as u64).with_style(style).with_message(printable(stage.into(), LONGEST));
    bar.enable_steady_tick(TICK);
    bar
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: of two stages under way at the same time each is new once, and again when it begins anew after more was reported of it.
    #[test]
    fn stages_at_the_same_time_are_each_new_once() {
        let mut state = State::default();
        assert_eq!(state.place("run", 0), (0, true));
        assert_eq!(state.place("law", 0), (1, true));
        assert_eq!(
            [state.place("run", 0), state.place("run", 1), state.place("law", 1)],
            [(0, false), (0, false), (1, false)]
        );
        state.stages[0].tenths = 3;
        assert_eq!(
            [state.place("run", 4), state.place("run", 0), state.place("law", 0)],
            [(0, false), (0, true), (1, false)]
        );
    }
}
