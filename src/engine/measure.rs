//! Wall clock, memory, date and host of a run: the part of the results that
//! differs from run to run.

use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use crate::engine::measured::{MachineRecord, Measured, StageMeasure};

/// Measures one stage; several may run at the same time. The memory is that of the program, whichever stage holds it.
#[derive(Debug)]
pub struct Stopwatch {
    begun: Instant,
    /// The largest memory before the peak was forgotten for a later stopwatch, MiB.
    earlier: Arc<Mutex<f64>>,
    /// What it was stopped at.
    held: Option<(f64, Option<f64>)>,
}

/// The largest memory that each stopwatch has seen before.
static RUNNING: Mutex<Vec<Weak<Mutex<f64>>>> = Mutex::new(Vec::new());

impl Stopwatch {
    /// Starts the clock and forgets the peak of the memory so far, where the system allows it.
    pub fn start() -> Self {
        let mut running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
        let peak = peak_memory_mib().unwrap_or(0.0);
        running.retain(|other| {
            let Some(other) = other.upgrade() else { return false };
            let mut earlier = other.lock().unwrap_or_else(PoisonError::into_inner);
            *earlier = earlier.max(peak);
            true
        });
        // Linux resets the peak when 5 is written here; elsewhere the peak is that since the start.
        let _ = std::fs::write("/proc/self/clear_refs", "5");
        let earlier = Arc::default();
        running.push(Arc::downgrade(&earlier));
        Self { begun: Instant::now(), earlier, held: None }
    }

    /// Seconds since the start, and the largest resident memory since then, MiB, where the system says.
    pub fn read(&self) -> (f64, Option<f64>) {
        let now = || {
            let earlier = *self.earlier.lock().unwrap_or_else(PoisonError::into_inner);
            (self.begun.elapsed().as_secs_f64(), peak_memory_mib().map(|peak| peak.max(earlier)))
        };
        self.held.unwrap_or_else(now)
    }

    /// Stays as it is now.
    #[must_use]
    pub fn held(self) -> Self {
        Self { held: Some(self.read()), ..self }
    }

    /// The measure of the stage; `key` is the hash of what its result was made from, `taken` whether the store had it.
    pub fn stop(self, stage: &str, key: &str, taken: bool) -> StageMeasure {
        let (seconds, peak) = self.read();
        StageMeasure {
            stage: stage.into(),
            key: key.into(),
            seconds: (seconds * 1e3).round() / 1e3,
            peak_memory_mib: peak.map(|mib| (mib * 10.0).round() / 10.0),
            taken,
        }
    }
}

/// Date, machine and threads; no stages yet.
pub fn begin() -> Measured {
    Measured {
        begun_utc: now_utc(),
        host: std::fs::read_to_string("/proc/sys/kernel/hostname")
            .map(|name| name.trim().to_string())
            .or_else(|_| std::env::var("COMPUTERNAME"))
            .unwrap_or_else(|_| "unknown".into()),
        machine: machine(),
        threads: rayon::current_num_threads(),
        stages: Vec::new(),
    }
}

/// The time, UTC.
pub fn now_utc() -> String {
    utc(SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs()))
}

/// What the program runs on, as far as the system says.
pub fn machine() -> MachineRecord {
    let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
    MachineRecord {
        processor: processor(&read("/proc/cpuinfo")),
        cores: std::thread::available_parallelism().map_or(1, usize::from),
        memory_gib: memory_gib(&read("/proc/meminfo")),
    }
}

/// Model of the first processor of `/proc/cpuinfo`.
fn processor(text: &str) -> Option<String> {
    let named = text.lines().filter_map(|line| line.split_once(':'));
    let model = named.map(|(key, value)| (key.trim(), value.trim())).find(|(key, _)| *key == "model name");
    model.map(|(_, name)| name.to_string())
}

/// Memory of the machine by `/proc/meminfo`, GiB, to a tenth.
fn memory_gib(text: &str) -> Option<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some((kib / 1024.0 / 1024.0 * 10.0).round() / 10.0)
}

/// Largest resident memory since the last reset, MiB.
fn peak_memory_mib() -> Option<f64> {
    peak_in(&std::fs::read_to_string("/proc/self/status").ok()?)
}

/// Largest resident memory by the `/proc/PID/status` of a process, MiB.
pub fn peak_in(status: &str) -> Option<f64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib / 1024.0)
}

/// Seconds since 1970 as `2016-01-31T12:00:00Z` (proleptic Gregorian calendar).
fn utc(seconds: u64) -> String {
    let (days, rest) = (seconds / 86_400, seconds % 86_400);
    let mut year = 1970;
    let mut left = days;
    let leap = |year: u64| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    while left >= 365 + u64::from(leap(year)) {
        left -= 365 + u64::from(leap(year));
        year += 1;
    }
    let lengths = [31, 28 + u64::from(leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut month = 0;
    while left >= lengths[month] {
        left -= lengths[month];
        month += 1;
    }
    let (hour, minute, second) = (rest / 3600, rest % 3600 / 60, rest % 60);
    format!("{year:04}-{:02}-{:02}T{hour:02}:{minute:02}:{second:02}Z", month + 1, left + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_machine_is_read_from_the_texts_of_the_system() {
        let cpu = "processor\t: 0\nvendor_id\t: x\nmodel name\t: Fast 9000: Pro\nprocessor\t: 1\nmodel name\t: other\n";
        assert_eq!(processor(cpu).as_deref(), Some("Fast 9000: Pro"));
        assert_eq!(memory_gib("MemTotal:  25165824 kB\nMemFree: 1 kB\n"), Some(24.0));
        assert_eq!((processor(""), memory_gib("MemTotal: many\n")), (None, None));
        assert!(machine().cores > 0);
    }

    /// Goal: a stopwatch that runs beside a later one still knows the peak of before, MiB, and one that is held stays as it was. Exact: the block alone is
    /// larger than what is asked for.
    #[test]
    fn a_later_stopwatch_takes_no_peak_from_an_earlier_one() {
        const BLOCK: usize = 256;
        let first = Stopwatch::start();
        if first.read().1.is_none() {
            return;
        }
        drop(std::hint::black_box(vec![1_u8; BLOCK << 20]));
        let second = Stopwatch::start();
        assert!(first.read().1.unwrap() > BLOCK as f64, "{:?} {:?}", first.read(), second.read());
        let second = second.held();
        let read = second.read();
        drop(std::hint::black_box(vec![1_u8; BLOCK << 20]));
        assert_eq!(second.read(), read);
    }

    #[test]
    fn dates_are_those_of_the_calendar() {
        assert_eq!(utc(0), "1970-01-01T00:00:00Z");
        assert_eq!(utc(951_782_400), "2000-02-29T00:00:00Z");
        assert_eq!(utc(1_483_228_799), "2016-12-31T23:59:59Z");
    }
}
