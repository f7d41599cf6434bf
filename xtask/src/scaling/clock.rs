//! When the pieces of a stage begin.

use std::sync::Mutex;
use std::time::Instant;

use railspring_profiles::error::Result;
use railspring_profiles::monitor::Monitor;

/// Hears the progress of one stage and keeps how long its pieces take.
pub(super) struct Clock<'a> {
    stage: &'a str,
    /// Its name to the monitor.
    name: &'a str,
    monitor: &'a dyn Monitor,
    heard: Mutex<Heard>,
}

#[derive(Default)]
struct Heard {
    last: Option<(usize, Instant)>,
    seconds: Vec<f64>,
}

impl<'a> Clock<'a> {
    /// Listens to `stage`; `monitor` learns by `name` that it goes on.
    pub fn new(stage: &'a str, name: &'a str, monitor: &'a dyn Monitor) -> Self {
        Self { stage, name, monitor, heard: Mutex::default() }
    }

    /// The median of the pieces, s; none if there was no whole one.
    pub fn median(self) -> Option<f64> {
        let mut seconds = self.heard.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner).seconds;
        seconds.sort_by(f64::total_cmp);
        seconds.get(seconds.len() / 2).copied()
    }
}

impl Monitor for Clock<'_> {
    fn progress(&self, stage: &str, done: usize, _: usize) -> Result<()> {
        if stage == self.stage {
            let now = Instant::now();
            let mut heard = self.heard.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            // a piece is finished when the next one begins; a stage that begins anew is none
            if let Some((last, begun)) = heard.last
                && done == last + 1
            {
                heard.seconds.push((now - begun).as_secs_f64());
            }
            heard.last = Some((done, now));
        }
        self.monitor.progress(self.name, 0, 1)
    }

    fn notice(&self, text: &str) {
        self.monitor.notice(text);
    }
}

#[cfg(test)]
mod tests {
    use railspring_profiles::monitor::Silent;

    use super::*;

    /// Goal: a piece counts from its own beginning to that of the next one, and neither other stages nor a beginning from scratch do.
    #[test]
    fn pieces_of_one_stage_are_timed() {
        let clock = Clock::new("steps", "a", &Silent);
        for (stage, done) in
            [("steps", 0), ("other", 1), ("steps", 1), ("steps", 2), ("steps", 0), ("steps", 1)]
        {
            clock.progress(stage, done, 3).unwrap();
        }
        assert_eq!(clock.heard.lock().unwrap().seconds.len(), 3);
        assert!(clock.median().unwrap() >= 0.0);
        assert!(Clock::new("steps", "a", &Silent).median().is_none());
    }
}
