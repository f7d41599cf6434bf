//! Transforms of values on a grid that are their own mirror image along the track, or the opposite of it.
//!
//! The transform along the track of such values is real, or imaginary. Two lines of the grid then share a transform, and the transforms along the profile are those of
//! real values: half of the work. The spectra here have the frequencies along the track from the middle line outwards, and along the profile, half of each. That of
//! opposite values is multiplied by i.

use super::point::ALONG;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealToComplex};
use rustfft::{Fft, FftPlanner};
use std::cell::Cell;
use std::sync::Arc;

/// Memory of a thread between its transforms, of which a solution takes some hundred.
struct Room {
    complex: Vec<Complex<f64>>,
    real: Vec<f64>,
    scratch: Vec<Complex<f64>>,
}

thread_local! {
    static ROOM: Cell<Room> = const { Cell::new(Room::NONE) };
}

impl Room {
    const NONE: Self = Self { complex: Vec::new(), real: Vec::new(), scratch: Vec::new() };

    /// That of the thread, with so many zeros each, and scratch.
    fn of_thread(complex: usize, real: usize, scratch: usize) -> Self {
        let mut room = ROOM.replace(Self::NONE);
        room.complex.clear();
        room.complex.resize(complex, Complex::default());
        room.real.clear();
        room.real.resize(real, 0.0);
        if room.scratch.len() < scratch {
            room.scratch.resize(scratch, Complex::default());
        }
        room
    }

    /// Leaves it to the next transform.
    fn leave(self) {
        ROOM.set(self);
    }
}

/// Transforms along the track, of two lines each, and along the profile, of a grid with an even number of lines in both directions.
pub(super) struct MirroredTransform {
    /// Lines along the profile and the track.
    size: (usize, usize),
    along: Arc<dyn Fft<f64>>,
    along_back: Arc<dyn Fft<f64>>,
    across: Arc<dyn RealToComplex<f64>>,
    across_back: Arc<dyn ComplexToReal<f64>>,
}

impl MirroredTransform {
    /// That of a grid with so many lines along the profile and the track.
    pub fn new(size: (usize, usize)) -> Self {
        let (mut real, mut complex) = (RealFftPlanner::new(), FftPlanner::new());
        Self {
            size,
            along: complex.plan_fft_forward(size.1),
            along_back: complex.plan_fft_inverse(size.1),
            across: real.plan_fft_forward(size.0),
            across_back: real.plan_fft_inverse(size.0),
        }
    }

    /// How many frequencies along the profile a spectrum has, one after the other.
    pub fn frequencies(&self) -> usize {
        self.size.0 / 2 + 1
    }

    /// A spectrum of zeros.
    pub fn zero(&self) -> Vec<Complex<f64>> {
        vec![Complex::default(); self.frequencies() * (self.size.1 / 2 + 1)]
    }

    /// Transform of values in a `direction`. Places are lines along the profile and columns from the middle on; a value is the sum of those
    /// there and at the mirror image.
    pub fn transform(
        &self,
        direction: usize,
        values: impl Iterator<Item = ((usize, usize), f64)>,
    ) -> Vec<Complex<f64>> {
        let (lines, columns) = self.size;
        let half = columns / 2 + 1;
        let is_odd = direction == ALONG;
        // two lines as the real and the imaginary part
        let mut room = self.room(lines.div_ceil(2) * columns, half * lines);
        let Room { complex: pairs, real: by_frequency, scratch } = &mut room;
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
        let pairs = &mut pairs[..count * columns];
        self.along.process_with_scratch(pairs, scratch);
        for (pair, values) in pairs.chunks_exact(columns).enumerate() {
            for (line, z) in by_frequency.chunks_exact_mut(lines).zip(values) {
                // of opposite values the transform is -i times this
                let both = if is_odd { [-z.im, z.re] } else { [z.re, z.im] };
                line[2 * pair..2 * pair + 2].copy_from_slice(&both);
            }
        }
        let mut spectrum = self.zero();
        let count = lines / 2 + 1;
        for (input, output) in by_frequency.chunks_exact_mut(lines).zip(spectrum.chunks_exact_mut(count)) {
            self.across.process_with_scratch(input, output, scratch).expect("lengths of the plan");
        }
        room.leave();
        spectrum
    }

    /// The values in a `direction` whose `spectrum` it is at numbered `places`, within the first `lines` along the profile; places as in
    /// [`Self::transform`].
    pub fn back(
        &self,
        direction: usize,
        mut spectrum: Vec<Complex<f64>>,
        lines: usize,
        places: impl Iterator<Item = (usize, (usize, usize))>,
        mut each: impl FnMut(usize, f64),
    ) {
        let (padded, columns) = self.size;
        let (count, half) = (padded / 2 + 1, columns / 2 + 1);
        let is_odd = direction == ALONG;
        let pairs = lines.div_ceil(2);
        let mut room = self.room(pairs * columns, padded);
        let Room { complex: values, real: line, scratch } = &mut room;
        for (k, spectrum) in spectrum.chunks_exact_mut(count).enumerate() {
            // those of a real line are real; what is left is rounding. The number of lines is even
            (spectrum[0].im, spectrum[count - 1].im) = (0.0, 0.0);
            self.across_back.process_with_scratch(spectrum, line, scratch).expect("lengths of the plan");
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
        self.along_back.process_with_scratch(values, scratch);
        for (j, (line, column)) in places {
            let both = values[line / 2 * columns + column];
            each(j, if line % 2 == 0 { both.re } else { both.im });
        }
        room.leave();
    }

    /// Room for a transform, with as much scratch as any part of it takes.
    fn room(&self, complex: usize, real: usize) -> Room {
        let along = self.along.get_inplace_scratch_len().max(self.along_back.get_inplace_scratch_len());
        let across = self.across.get_scratch_len().max(self.across_back.get_scratch_len());
        Room::of_thread(complex, real, along.max(across))
    }
}
