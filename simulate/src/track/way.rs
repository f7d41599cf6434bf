//! Where the wheel is over time.

/// A place at t = 0 and speeds over time, linear between their times and constant beyond the last.
#[derive(Debug, Clone, PartialEq)]
pub struct Way {
    start: f64,
    /// Time, s, speed there, m/s, and way until then, m.
    knots: Vec<[f64; 3]>,
}

impl Way {
    /// From `start` (m from the rail's first end) with `speeds`: times, s, the first of them 0 and ascending, and speeds, m/s; none stand still.
    pub fn new(start: f64, speeds: &[(f64, f64)]) -> Self {
        let mut knots: Vec<[f64; 3]> = Vec::with_capacity(speeds.len());
        for &(time, speed) in speeds {
            let way =
                knots.last().map_or(0.0, |[was, before, way]| way + 0.5 * (before + speed) * (time - was));
            knots.push([time, speed, way]);
        }
        Self { start, knots }
    }

    /// From `start` (m) with a `speed` (m/s) that grows by `acceleration` (m/s²) until `duration` (s).
    pub fn uniform(start: f64, speed: f64, acceleration: f64, duration: f64) -> Self {
        Self::new(start, &[(0.0, speed), (duration, speed + acceleration * duration)])
    }

    /// The place at `time` (s), m.
    pub fn x(&self, time: f64) -> f64 {
        let after = self.knots.partition_point(|[at, ..]| *at <= time);
        let Some([from, speed, way]) = after.checked_sub(1).map(|i| self.knots[i]) else { return self.start };
        let within = time - from;
        let gained = self.knots.get(after).map_or(0.0, |[to, next, _]| (next - speed) / (to - from));
        self.start + way + within * (speed + 0.5 * gained * within)
    }

    /// The largest speed, m/s.
    pub fn fastest(&self) -> f64 {
        self.knots.iter().map(|[_, speed, _]| speed.abs()).fold(0.0, f64::max)
    }
}
