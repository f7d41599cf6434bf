//! How long the steps of the integration are within a time step of the history: all the same, or short where forces change fast.
//!
//! Average acceleration is of second order: a force that swings with ω over steps of h is off by `(ωh)²/12` a radian, and an impact that
//! begins within a step by `(ωh)²/8` of its impulse. The step at hand says what `(ωh)²` is: the force at its end differs by
//! that share of the swing from the straight line through the last two. So a step is taken again with half the length, or less, where the
//! force is farther from that line than a share of the largest force, and the next one is twice as long where it could be.
//! Lengths are halves of halves of the time step, so that few of them occur and the bodies are prepared for each once.
//! A tolerance of the largest force says little while forces are small: the phase of a vibration then is off by as much as the longest steps make it.

use railspring_profiles::error::InputError;
use railspring_profiles::field::InputField;
use serde::Serialize;

/// Steps of the integration within each time step of the history.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum InnerSteps {
    /// So many, of the same length.
    Equal(usize),
    /// As many as the contact force asks for.
    Adaptive(StepControl),
}

/// How short steps become.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StepControl {
    /// Longest steps within a time step: a power of two.
    pub least: usize,
    /// Shortest steps within a time step: a power of two.
    pub most: usize,
    /// Largest deviation of the contact force from the straight line through its last two values, of the largest force.
    pub tolerance: f64,
}

impl StepControl {
    /// In the published load case 4.1, with its impacts, P and Q are then off by less than a per cent of their peaks (RMS).
    pub const DEFAULT: Self = Self { least: 1, most: 16, tolerance: 0.03 };

    /// Steps twice as long: their errors are four times as large.
    pub fn doubled(self) -> Self {
        let [least, most] = [self.least, self.most].map(|count| (count / 2).max(1));
        Self { least, most, tolerance: 4.0 * self.tolerance }
    }

    /// Steps half as long: their errors are a quarter.
    pub fn halved(self) -> Self {
        Self { least: 2 * self.least, most: 2 * self.most, tolerance: 0.25 * self.tolerance }
    }
}

impl InnerSteps {
    /// The longest and the shortest of them within a `time_step` (s), s.
    pub fn lengths(self, time_step: f64) -> [f64; 2] {
        let shortest = time_step / self.most() as f64;
        match self {
            Self::Equal(_) => [shortest; 2],
            Self::Adaptive(control) => [time_step / control.least as f64, shortest],
        }
    }

    /// As many as there can be within a time step.
    pub fn most(self) -> usize {
        match self {
            Self::Equal(count) => count,
            Self::Adaptive(control) => control.most,
        }
    }

    /// Steps of twice the length; of equal steps half as many, rounded up.
    pub fn doubled(self) -> Self {
        match self {
            Self::Equal(count) => Self::Equal(count.div_ceil(2)),
            Self::Adaptive(control) => Self::Adaptive(control.doubled()),
        }
    }

    /// Steps of half the length.
    pub fn halved(self) -> Self {
        match self {
            Self::Equal(count) => Self::Equal(2 * count),
            Self::Adaptive(control) => Self::Adaptive(control.halved()),
        }
    }

    /// Checks that there are steps.
    ///
    /// # Errors
    /// [`InputError`] for none, for numbers of adaptive steps that are no powers of two or leave none, and for a tolerance that is not positive.
    pub fn check(self) -> Result<(), InputError> {
        let refuse = |value: String, expected: &str, remedy: &str| {
            Err(InputError::new(InputField::InnerSteps, value, expected, remedy))
        };
        match self {
            Self::Equal(0) => refuse(
                "0".into(),
                "at least one step of the integration in each of the history",
                "set it to 1, or to more for impacts",
            ),
            Self::Adaptive(StepControl { most, .. }) if !most.is_power_of_two() => refuse(
                most.to_string(),
                "a power of two where the length of the steps is adapted",
                "take 8, 16 or 32",
            ),
            Self::Adaptive(StepControl { least, most, .. }) if !least.is_power_of_two() || least > most => {
                refuse(
                    least.to_string(),
                    "longest steps that are a power of two and no shorter than the shortest",
                    "take 1, or as many as there can be",
                )
            }
            Self::Adaptive(StepControl { tolerance, .. }) if !(tolerance > 0.0 && tolerance.is_finite()) => {
                refuse(
                    tolerance.to_string(),
                    "a positive tolerance of adaptive steps",
                    "take 0.01, or give the number of equal steps",
                )
            }
            _ => Ok(()),
        }
    }
}

/// The steps of a run, one after another. Times are counted in ticks, the shortest steps; all steps begin at a multiple of their length.
#[derive(Debug, Clone)]
pub struct StepSequence {
    steps: InnerSteps,
    /// Halvings of the longest steps that the next step has.
    level: u32,
    /// Ticks since the start.
    ticks: usize,
    /// Contact force and elastic state (N) at the end of the last step, and their change a tick over it.
    values: Vec<f64>,
    rates: Vec<f64>,
    /// The same at the end of the step at hand.
    reached: Vec<f64>,
    /// The largest so far, N.
    largest: f64,
}

impl StepSequence {
    /// From the start on; `largest` is the largest force that is expected, N.
    pub fn new(steps: InnerSteps, largest: f64) -> Self {
        let [values, rates, reached] = [const { Vec::new() }; 3];
        Self { steps, level: 0, ticks: 0, values, rates, reached, largest }
    }

    /// Begins with a contact force and a state `elastic` (N) that are not zero.
    pub fn begin(&mut self, force: &[f64], elastic: &[f64]) {
        self.values.extend(force.iter().chain(elastic));
        self.largest = self.largest.max(size(force.iter().copied()));
    }

    /// Most halvings of the longest steps; steps of equal length have none.
    pub fn levels(steps: InnerSteps) -> u32 {
        match steps {
            InnerSteps::Equal(_) => 0,
            InnerSteps::Adaptive(control) => (control.most / control.least).ilog2(),
        }
    }

    /// Halvings of the next step.
    pub fn level(&self) -> usize {
        self.level as usize
    }

    fn length(&self) -> usize {
        match self.steps {
            InnerSteps::Equal(_) => 1,
            InnerSteps::Adaptive(control) => (control.most / control.least) >> self.level,
        }
    }

    /// Ticks from the start to the end of the last step.
    pub fn ticks(&self) -> usize {
        self.ticks
    }

    /// Ticks from the start to the end of the next step.
    pub fn end(&self) -> usize {
        self.ticks + self.length()
    }

    /// Whether the next step can be made shorter, and if so makes it so.
    pub fn shorten(&mut self) -> bool {
        let can = self.level < Self::levels(self.steps);
        self.level += u32::from(can);
        can
    }

    /// Whether a step that ends with the contact force `force` and the state `elastic` of the bodies (N) is short enough, where something else is `share` of what it
    /// may be and falls with the square of the length. If it is, the next one begins at its end; if not, it is to be taken again with the new length.
    pub fn accept(&mut self, force: &[f64], elastic: &[f64], share: f64) -> bool {
        let InnerSteps::Adaptive(control) = self.steps else {
            self.ticks += 1;
            return true;
        };
        let (length, finest) = (self.length(), Self::levels(self.steps));
        let ticks = length as f64;
        let Self { values, rates, reached, largest, level, .. } = self;
        reached.clear();
        reached.extend(force.iter().chain(elastic));
        values.resize(reached.len(), 0.0);
        rates.resize(reached.len(), 0.0);
        let line = values.iter().zip(&*rates).map(|(value, rate)| value + ticks * rate);
        let off = size(reached.iter().zip(line).map(|(reached, line)| reached - line));
        let most = largest.max(size(force.iter().copied()));
        let share = if off == 0.0 { share } else { share.max(off / (control.tolerance * most)) };
        if share > 1.0 && *level < finest {
            // the share falls with the square of the length
            let halvings = (0.5 * share.log2()).ceil().clamp(1.0, f64::from(finest - *level));
            *level += halvings as u32;
            return false;
        }
        for ((rate, before), now) in rates.iter_mut().zip(&*values).zip(&*reached) {
            *rate = (now - before) / ticks;
        }
        std::mem::swap(values, reached);
        *largest = most;
        self.ticks += length;
        // twice the length has four times the share, and the force does not swing evenly
        let twice = 2 * length;
        if self.level > 0 && 4.0 * MARGIN * share < 1.0 && self.ticks.is_multiple_of(twice) {
            self.level -= 1;
        }
        true
    }
}

fn size(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|value| value * value).sum::<f64>().sqrt()
}

/// A step is made longer only if its share stays below the tolerance by as much.
const MARGIN: f64 = 1.5;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::newmark::{Motion, Newmark};

    /// Speed at the end (m/s), largest force (N), steps taken and tried of a mass of 1 kg on a spring without
    /// tension of `stiffness` (N/m). The mass meets the spring with 1 m/s at 0.3 of the first time step. The
    /// run has `rows` time steps of `dt` (s).
    fn strike(stiffness: f64, steps: InnerSteps, (rows, dt): (usize, f64)) -> (f64, f64, usize, usize) {
        let mut sequence = StepSequence::new(steps, 0.0);
        let [_, shortest] = steps.lengths(dt);
        let mut m = Motion { u: -0.3 * dt, v: 1.0, a: 0.0 };
        let (mut peak, mut taken, mut tried): (f64, usize, usize) = (0.0, 0, 0);
        while sequence.ticks() < rows * steps.most() {
            let scheme = Newmark::new((sequence.end() - sequence.ticks()) as f64 * shortest, 0.0);
            let free = scheme.inertia(&m) / scheme.acceleration;
            let u = if free > 0.0 { scheme.inertia(&m) / (scheme.acceleration + stiffness) } else { free };
            let force = stiffness * u.max(0.0);
            tried += 1;
            if sequence.accept(&[force], &[], 0.0) {
                m = scheme.advance(&m, u);
                peak = peak.max(force);
                taken += 1;
            }
        }
        (m.v, peak, taken, tried)
    }

    /// Source: a mass that strikes a spring, F = v·√(k·m)·sin(ωt) for half a period, and flies back with its speed. Goal: largest force
    /// (N) and speed of the rebound (m/s) with adapted steps, of a contact that lasts 2.5 time steps; equal steps of that length miss
    /// both by ten per cent and more. Accuracy: DISCRETISATION, with (ωh)² no more than the tolerance: an eighth of it at both ends of
    /// the contact; the peak between two steps is missed by the same at most.
    #[test]
    fn a_struck_spring_gives_the_speed_back() {
        const TOLERANCE: f64 = 0.02;
        const DISCRETISATION: f64 = 2.0 * TOLERANCE / 8.0;
        let dt = 1e-3;
        let omega = std::f64::consts::PI / (2.5 * dt);
        let control = StepControl { least: 1, most: 64, tolerance: TOLERANCE };
        let (speed, peak, taken, tried) = strike(omega * omega, InnerSteps::Adaptive(control), (8, dt));
        assert!((speed + 1.0).abs() < DISCRETISATION, "{speed}");
        assert!((peak / omega - 1.0).abs() < DISCRETISATION, "{peak}");
        // a contact of 2.5 time steps in steps of √0.02/ω or half of that
        assert!((30..110).contains(&taken) && tried < taken + taken / 4, "{taken} {tried}");
        let (speed, peak, ..) = strike(omega * omega, InnerSteps::Equal(1), (8, dt));
        assert!((speed + 1.0).abs() > 0.1 || (peak / omega - 1.0).abs() > 0.1, "{speed} {peak}");
    }

    /// Goal: the error of speed and force falls with the tolerance, which is the square of the length: within the window 0.5 to 2 in the power over
    /// sixteen times the tolerance, below its cap at the finest.
    #[test]
    fn a_smaller_tolerance_is_a_smaller_error() {
        let dt = 1e-3;
        let omega = std::f64::consts::PI / (2.5 * dt);
        let error = |tolerance| {
            let steps = InnerSteps::Adaptive(StepControl { least: 1, most: 1024, tolerance });
            let (speed, peak, ..) = strike(omega * omega, steps, (8, dt));
            (speed + 1.0).abs().max((peak / omega - 1.0).abs())
        };
        let errors = [0.08, 0.005].map(error);
        let power = (errors[0] / errors[1]).log2() / 4.0;
        assert!((0.5..2.0).contains(&power), "{power} {errors:?}");
        assert!(errors[1] < 0.005 / 4.0, "{errors:?}");
    }

    /// Goal: forces that stay on a straight line are followed with the longest steps, and steps end where time steps end; every step begins at a
    /// multiple of its length; equal steps are one tick each.
    #[test]
    fn steps_are_long_where_they_can_be() {
        let mut sequence =
            StepSequence::new(InnerSteps::Adaptive(StepControl { least: 1, most: 8, tolerance: 0.01 }), 1.0);
        let mut lengths = Vec::new();
        // at rest, a jump of the force within the third time step, and rest again
        while sequence.ticks() < 64 {
            let (begin, end) = (sequence.ticks(), sequence.end());
            assert!(begin.is_multiple_of(end - begin));
            if sequence.accept(&[if end > 19 { 1.0 } else { 0.0 }], &[0.0], 0.0) {
                lengths.push(end - begin);
            }
        }
        assert_eq!(lengths[..6], [8, 8, 1, 1, 1, 1]);
        assert_eq!(lengths[lengths.len() - 3..], [8; 3]);
        assert_eq!(lengths.iter().sum::<usize>(), 64);
        // none longer than a quarter of the time step, though nothing changes
        let control = StepControl { least: 4, most: 8, tolerance: 0.01 };
        let mut short = StepSequence::new(InnerSteps::Adaptive(control), 1.0);
        for quarter in 1..=8 {
            assert!(short.accept(&[0.0], &[0.0], 0.0));
            assert_eq!(short.ticks(), 2 * quarter);
        }
        let mut equal = StepSequence::new(InnerSteps::Equal(3), 1.0);
        for tick in 1..=9 {
            assert!(equal.accept(&[if tick == 5 { 1e9 } else { 0.0 }], &[], 0.0) && !equal.shorten());
            assert_eq!(equal.ticks(), tick);
        }
    }

    /// Goal: numbers and tolerances that mean nothing are refused by their field.
    #[test]
    fn impossible_steps_are_refused() {
        let adaptive = |most, tolerance| InnerSteps::Adaptive(StepControl { least: 1, most, tolerance });
        let longest = |least, most| InnerSteps::Adaptive(StepControl { least, most, tolerance: 0.1 });
        for steps in [
            InnerSteps::Equal(0),
            adaptive(0, 0.1),
            adaptive(12, 0.1),
            adaptive(8, 0.0),
            adaptive(8, f64::NAN),
            longest(3, 8),
            longest(16, 8),
        ] {
            assert!(steps.check().unwrap_err().to_string().starts_with("inner_steps = "), "{steps:?}");
        }
        assert!(InnerSteps::Equal(3).check().is_ok() && adaptive(1, 0.1).check().is_ok());
        assert_eq!(InnerSteps::Equal(5).doubled(), InnerSteps::Equal(3));
        assert_eq!(adaptive(8, 0.1).doubled(), adaptive(4, 0.4));
        assert_eq!(longest(4, 8).doubled().halved(), longest(4, 8));
        assert_eq!(longest(4, 8).halved().lengths(8.0), [1.0, 0.5]);
        assert_eq!(InnerSteps::Equal(5).halved(), InnerSteps::Equal(10));
    }
}
