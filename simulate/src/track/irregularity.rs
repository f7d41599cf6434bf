//! Heights of the running surface along the rail, and of the wheel around its circumference.

use std::f64::consts::TAU;

use crate::time::function::interpolated;

/// One cause of unevenness; heights are positive upwards.
#[derive(Debug, Clone, PartialEq)]
pub enum Irregularity {
    /// Straight lines between places (m, ascending) with their heights (m).
    Corners(Vec<(f64, f64)>),
    /// A natural cubic spline through samples: places (m, ascending), heights (m), second derivatives (1/m).
    Samples(Vec<[f64; 3]>),
    /// Cosines: wave number (rad/m), amplitude (m) and phase (rad) of each.
    Waves(Vec<[f64; 3]>),
    /// A dipped joint: two parabolas that meet in a corner.
    Dip {
        /// Place of the joint, m.
        at: f64,
        /// Depth there, m.
        depth: f64,
        /// Length on either side, m.
        half_length: f64,
    },
    /// A flat of the wheel that comes round with every revolution, its ends worn round: half a period of a cosine each side of its middle.
    Flat {
        /// Circumference, m.
        circumference: f64,
        /// Place of the wheel at which the middle of the flat first touches, m.
        first: f64,
        /// Length along the circumference, m.
        length: f64,
        /// Depth, m.
        depth: f64,
    },
}

/// A power spectral density `amplitude·cutoff²/((Ω² + rolloff²)·(Ω² + cutoff²))` over the wave number Ω, one-sided, m²/(rad/m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spectrum {
    /// Amplitude, m²·rad/m.
    pub amplitude: f64,
    /// Wave number of the cut-off, rad/m.
    pub cutoff: f64,
    /// Wave number below which it stays, rad/m.
    pub rolloff: f64,
    /// Shortest and longest wave, m.
    pub waves: [f64; 2],
    /// Number of cosines.
    pub components: usize,
    /// Seed of the phases.
    pub seed: u64,
}

impl Spectrum {
    /// The density at a wave number, m²/(rad/m).
    pub fn density(&self, wave_number: f64) -> f64 {
        let square = wave_number * wave_number;
        self.amplitude * self.cutoff.powi(2)
            / ((square + self.rolloff.powi(2)) * (square + self.cutoff.powi(2)))
    }

    /// Cosines at the middles of equal intervals of the wave number, each with the density's share of the variance and a random phase. The same seed gives the
    /// same waves.
    pub fn waves(&self) -> Irregularity {
        let [longest, shortest] = [self.waves[1], self.waves[0]].map(|wave| TAU / wave);
        let width = (shortest - longest) / self.components as f64;
        let mut state = self.seed;
        let of = |index: usize| {
            let wave_number = longest + (index as f64 + 0.5) * width;
            let phase = TAU * uniform(&mut state);
            [wave_number, (2.0 * self.density(wave_number) * width).sqrt(), phase]
        };
        Irregularity::Waves((0..self.components).map(of).collect())
    }
}

/// A number from 0 to 1 (SplitMix64: G. Steele, D. Lea, C. Flood, OOPSLA 2014).
fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^= z >> 31;
    // the upper 53 bits
    (z >> 11) as f64 / (1u64 << 53) as f64
}

impl Irregularity {
    /// The spline through samples: places (m, ascending) with heights (m).
    pub fn through(samples: &[(f64, f64)]) -> Self {
        let count = samples.len();
        let mut second = vec![0.0; count];
        // Thomas' algorithm on the continuity of the slopes
        let mut upper = vec![0.0; count];
        for i in 1..count.saturating_sub(1) {
            let [(a, low), (b, here), (c, high)] = [samples[i - 1], samples[i], samples[i + 1]];
            let (before, after) = (b - a, c - b);
            let turned = 6.0 * ((high - here) / after - (here - low) / before);
            let pivot = 2.0 * (before + after) - before * upper[i - 1];
            upper[i] = after / pivot;
            second[i] = (turned - before * second[i - 1]) / pivot;
        }
        for i in (1..count.saturating_sub(1)).rev() {
            second[i] -= upper[i] * second[i + 1];
        }
        Self::Samples(samples.iter().zip(second).map(|(&(x, height), second)| [x, height, second]).collect())
    }

    /// The same with the opposite heights.
    #[must_use]
    pub fn negated(mut self) -> Self {
        match &mut self {
            Self::Corners(table) => table.iter_mut().for_each(|(_, height)| *height = -*height),
            Self::Samples(samples) => samples.iter_mut().for_each(|[_, height, bent]| {
                (*height, *bent) = (-*height, -*bent);
            }),
            Self::Waves(waves) => waves.iter_mut().for_each(|[_, amplitude, _]| *amplitude = -*amplitude),
            Self::Dip { depth, .. } | Self::Flat { depth, .. } => *depth = -*depth,
        }
        self
    }

    /// The height (m) at `x` (m).
    pub fn height(&self, x: f64) -> f64 {
        match self {
            Self::Corners(table) => interpolated(table, x),
            Self::Samples(samples) => spline(samples, x),
            Self::Waves(waves) => waves.iter().map(|[k, a, phase]| a * (k * x + phase).cos()).sum(),
            Self::Dip { at, depth, half_length } => {
                let inside = 1.0 - (x - at).abs() / half_length;
                if inside > 0.0 { -depth * inside * inside } else { 0.0 }
            }
            Self::Flat { circumference, first, length, depth } => {
                let round = (x - first).rem_euclid(*circumference);
                let off = round.min(circumference - round);
                if off < 0.5 * length { 0.5 * depth * (1.0 + (TAU * off / length).cos()) } else { 0.0 }
            }
        }
    }
}

/// A spline at `x`, constant beyond its ends.
fn spline(samples: &[[f64; 3]], x: f64) -> f64 {
    let after = samples.partition_point(|[at, ..]| *at <= x);
    match (after.checked_sub(1).map(|i| samples[i]), samples.get(after)) {
        (None, None) => 0.0,
        (None, Some(&[_, height, _])) | (Some([_, height, _]), None) => height,
        (Some([from, low, bent]), Some(&[to, high, bent_there])) => {
            let width = to - from;
            let (a, b) = ((to - x) / width, (x - from) / width);
            let bend = (a * a * a - a) * bent + (b * b * b - b) * bent_there;
            a * low + b * high + bend * width * width / 6.0
        }
    }
}

/// All that is uneven under one wheel.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Unevenness {
    /// Of the rail; heights are positive upwards.
    pub rail: Vec<Irregularity>,
    /// Of the wheel: what is missing of its radius.
    pub wheel: Vec<Irregularity>,
}

impl Unevenness {
    /// How much lower the running surface is at `x` (m) than the straight one on a round wheel, m.
    pub fn drop(&self, x: f64) -> f64 {
        let sum = |all: &[Irregularity]| all.iter().map(|one| one.height(x)).sum::<f64>();
        sum(&self.wheel) - sum(&self.rail)
    }
}
