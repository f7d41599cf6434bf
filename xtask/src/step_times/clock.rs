//! The time that a thread computes.

/// Seconds that this thread has computed, where the system says: what other threads take away is not in them.
pub fn thread_seconds() -> Option<f64> {
    // the system books the time of a thread when it makes way for another
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(nanoseconds * 1e-9)
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;

    /// Goal: the time of a thread that computes grows by no more than the wall clock, s, and that of a thread that waits stands. Accuracy: MODEL, what a step of
    /// the system's own takes, 2 ms.
    #[test]
    fn the_time_of_a_thread_is_what_it_computes() {
        const MODEL: f64 = 2e-3;
        let Some(first) = thread_seconds() else { return };
        std::thread::sleep(std::time::Duration::from_millis(50));
        let waited = thread_seconds().unwrap() - first;
        assert!((0.0..MODEL).contains(&waited), "{waited}");
        let (begun, before) = (Instant::now(), thread_seconds().unwrap());
        let mut sum = 0.0_f64;
        while thread_seconds().unwrap() - before < 0.02 {
            sum = std::hint::black_box(sum + 1.0);
        }
        let computed = thread_seconds().unwrap() - before;
        assert!(computed <= begun.elapsed().as_secs_f64() + MODEL, "{computed}");
    }
}
