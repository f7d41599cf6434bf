//! Sums over a grid of values that are their own mirror image along the track, or the opposite of it.
//!
//! The transform along the track of such values is real, or imaginary. Two lines of the grid then share a transform, and the transforms along the profile are those of
//! real values: half of the work. The spectra here have the frequencies along the track from the middle line outwards, and along the profile, half of each. That of
//! opposite values is multiplied by i.

use super::super::operator::ALONG;
use super::{Convolution, Factors, Spectrum};
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealToComplex};
use rustfft::{Fft, FftPlanner};
use std::sync::Arc;

/// Transforms along the track, of two lines each, and along the profile.
pub(super) struct Plans {
    along: Arc<dyn Fft<f64>>,
    along_back: Arc<dyn Fft<f64>>,
    across: Arc<dyn RealToComplex<f64>>,
    across_back: Arc<dyn ComplexToReal<f64>>,
}

impl Plans {
    pub fn new((lines, columns): (usize, usize)) -> Self {
        let (mut real, mut complex) = (RealFftPlanner::new(), FftPlanner::new());
        Self {
            along: complex.plan_fft_forward(columns),
            along_back: complex.plan_fft_inverse(columns),
            across: real.plan_fft_forward(lines),
            across_back: real.plan_fft_inverse(lines),
        }
    }
}

impl Convolution {
    /// Transform of values in a `direction`. Places are lines along the profile and columns from the middle on; a value is the sum of those
    /// there and at the mirror image.
    pub fn transform_mirrored(
        &self,
        direction: usize,
        values: impl Iterator<Item = ((usize, usize), f64)>,
    ) -> Spectrum {
        let (lines, columns) = self.padded;
        let half = columns / 2 + 1;
        let is_odd = direction == ALONG;
        // two lines as the real and the imaginary part
        let mut pairs = vec![Complex::default(); lines.div_ceil(2) * columns];
        let mut count = 0;
        for ((line, column), value) in values {
            let pair = &mut pairs[line / 2 * columns..(line / 2 + 1) * columns];
            count = count.max(line / 2 + 1);
            let mut enter = |place: usize, value: f64| {
                let at = &mut pair[place];
                if line % 2 == 0 { at.re = value } else { at.im = value }
            };
            match (column, is_odd) {
                (0, true) => {}
                (0, false) => enter(0, value),
                _ => {
                    enter(column, 0.5 * value);
                    enter(columns - column, if is_odd { -0.5 * value } else { 0.5 * value });
                }
            }
        }
        let plans = self.mirrored();
        let mut by_frequency = vec![0.0; half * lines];
        let mut scratch = vec![Complex::default(); plans.along.get_inplace_scratch_len()];
        let pairs = &mut pairs[..count * columns];
        plans.along.process_with_scratch(pairs, &mut scratch);
        for (pair, values) in pairs.chunks_exact(columns).enumerate() {
            for (line, z) in by_frequency.chunks_exact_mut(lines).zip(values) {
                // of opposite values the transform is -i times this
                let both = if is_odd { [-z.im, z.re] } else { [z.re, z.im] };
                line[2 * pair..2 * pair + 2].copy_from_slice(&both);
            }
        }
        let mut spectrum = self.zero_mirrored();
        let mut scratch = plans.across.make_scratch_vec();
        let count = lines / 2 + 1;
        for (input, output) in by_frequency.chunks_exact_mut(lines).zip(spectrum.chunks_exact_mut(count)) {
            plans.across.process_with_scratch(input, output, &mut scratch).expect("lengths of the plan");
        }
        spectrum
    }

    /// As [`Self::add`], of spectra of mirror images.
    pub fn add_mirrored(
        &self,
        factors: &Factors,
        (to, from): (usize, usize),
        spectrum: &[Complex<f64>],
        sum: &mut [Complex<f64>],
    ) {
        let turns = if from == ALONG { 3 } else { 0 } + if to == ALONG { 1 } else { 0 };
        let kernel = self.spectra.of(factors, (to, from)).turned(turns);
        let (lines, count) = (self.padded.0, self.padded.0 / 2 + 1);
        let all = spectrum.chunks_exact(count).zip(sum.chunks_exact_mut(count));
        all.enumerate().for_each(|(k, (spectrum, sum))| kernel.add(k * lines, spectrum, sum));
    }

    /// As [`Self::divide`], of a spectrum of mirror images.
    pub fn divide_mirrored(&self, factors: &Factors, direction: usize, spectrum: &mut [Complex<f64>]) {
        let (lines, count) = (self.padded.0, self.padded.0 / 2 + 1);
        let inverse: Vec<f64> = self.inverse(factors, direction).collect();
        for (spectrum, inverse) in spectrum.chunks_exact_mut(count).zip(inverse.chunks_exact(lines)) {
            spectrum.iter_mut().zip(inverse).for_each(|(s, inverse)| *s *= inverse);
        }
    }

    /// The values in a `direction` whose `spectrum` it is at `places`, in their order, within the first `lines` along the profile; places as in
    /// [`Self::transform_mirrored`].
    pub fn back_mirrored(
        &self,
        direction: usize,
        mut spectrum: Spectrum,
        lines: usize,
        places: &[(usize, usize)],
        mut each: impl FnMut(usize, f64),
    ) {
        let (padded, columns) = self.padded;
        let (count, half) = (padded / 2 + 1, columns / 2 + 1);
        let is_odd = direction == ALONG;
        let plans = self.mirrored();
        let pairs = lines.div_ceil(2);
        let mut values = vec![Complex::default(); pairs * columns];
        let mut line = vec![0.0; padded];
        let mut scratch = plans.across_back.make_scratch_vec();
        for (k, spectrum) in spectrum.chunks_exact_mut(count).enumerate() {
            // those of a real line are real; what is left is rounding. The number of lines is even
            (spectrum[0].im, spectrum[count - 1].im) = (0.0, 0.0);
            plans
                .across_back
                .process_with_scratch(spectrum, &mut line, &mut scratch)
                .expect("lengths of the plan");
            for pair in 0..pairs {
                let both = Complex::new(line[2 * pair], line[2 * pair + 1]);
                let values = &mut values[pair * columns..(pair + 1) * columns];
                if k == 0 || k == half - 1 {
                    values[k] = if is_odd { Complex::default() } else { both };
                } else {
                    // -i times these for opposite values
                    values[k] = if is_odd { Complex::new(both.im, -both.re) } else { both };
                    values[columns - k] = if is_odd { -values[k] } else { values[k] };
                }
            }
        }
        let mut scratch = vec![Complex::default(); plans.along_back.get_inplace_scratch_len()];
        plans.along_back.process_with_scratch(&mut values, &mut scratch);
        for (j, &(line, column)) in places.iter().enumerate() {
            let both = values[line / 2 * columns + column];
            each(j, if line % 2 == 0 { both.re } else { both.im });
        }
    }

    /// A spectrum of zeros of mirror images.
    pub fn zero_mirrored(&self) -> Spectrum {
        vec![Complex::default(); (self.padded.0 / 2 + 1) * (self.padded.1 / 2 + 1)]
    }

    fn mirrored(&self) -> &Plans {
        self.mirrored.get_or_init(|| Plans::new(self.padded))
    }
}
