//! Sums over a uniform grid by transforms: what the hats of a grid under forces do to each other, by the kernels of half-spaces.

use super::half_space::{Factors, HatTable, Kernels};
use super::mirrored_transform::MirroredTransform;
use super::point::ALONG;
use nalgebra::Vector2;
use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftPlanner};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// The kernels of a grid over a rectangle of its lines, in twice the rectangle so that it does not repeat itself.
pub(super) struct Convolution {
    /// Means between the hats of the grid, by their offset; it reaches over the rectangle.
    pub table: HatTable,
    /// Lines of twice the rectangle along the profile and the track.
    padded: (usize, usize),
    rows: Arc<dyn RealToComplex<f64>>,
    rows_back: Arc<dyn ComplexToReal<f64>>,
    columns: Arc<dyn Fft<f64>>,
    columns_back: Arc<dyn Fft<f64>>,
    spectra: Spectra<f64>,
    /// The inverse and the across kernel as of a grid that repeats itself, made when they are wanted: where the others have no values, halfway round, these go
    /// on, so that they are positive.
    repeated: OnceLock<[Vec<f64>; 2]>,
    /// Transforms of mirror images, made when they are wanted.
    mirrored: OnceLock<MirroredTransform>,
}

/// A transform, by the frequency along the track and then that along the profile.
pub(super) type Spectrum = Vec<Complex<f64>>;

/// Transforms of the kernels, with the factor of both ways. Those that are even in both directions, and that odd in both, are real; those odd in
/// one are imaginary, and have their imaginary part here. Between strips that are apart they are complex.
struct Spectra<T> {
    inverse: Vec<T>,
    across: Vec<T>,
    shear: Vec<T>,
    gradient: [Vec<T>; 2],
}

/// The transform of a kernel: the sum of others with their factors.
type Terms<'a, T> = [(f64, &'a [T]); 2];

/// The transform of a kernel that is real, or times i where it is imaginary.
struct Kernel<'a> {
    terms: Terms<'a, f64>,
    is_imaginary: bool,
}

impl<T> Spectra<T> {
    /// What forces in the direction `from` move in the direction `to`.
    fn terms(&self, factors: &Factors, (to, from): (usize, usize)) -> Terms<'_, T> {
        let Factors { inverse, tangential, coupling } = *factors;
        let Self { inverse: kernel, across, shear, gradient } = self;
        match (to, from) {
            (0, 0) => [(inverse, kernel), (0.0, kernel)],
            (1, 1) => [(inverse, kernel), (tangential, across)],
            (2, 2) => [(inverse + tangential, kernel), (-tangential, across)],
            (1, 2) | (2, 1) => [(tangential, shear), (0.0, shear)],
            (0, other) | (other, _) => {
                let factor = if to == 0 { -coupling } else { coupling };
                let gradient = &gradient[other - 1];
                [(factor, gradient), (0.0, gradient)]
            }
        }
    }
}

impl Spectra<f64> {
    fn of(&self, factors: &Factors, (to, from): (usize, usize)) -> Kernel<'_> {
        Kernel { terms: self.terms(factors, (to, from)), is_imaginary: (to == 0) != (from == 0) }
    }
}

impl Spectra<Complex<f64>> {
    /// Adds to `sum` the product of the kernel with part of a `spectrum`, for which it begins at `first`, times i so many times.
    fn add(
        &self,
        factors: &Factors,
        directions: (usize, usize),
        (first, turns): (usize, u32),
        spectrum: &[Complex<f64>],
        sum: &mut [Complex<f64>],
    ) {
        let [(a, one), (b, other)] = self.terms(factors, directions).map(|(f, kernel)| (f, &kernel[first..]));
        let turn = Complex::i().powu(turns);
        let (a, b) = (turn * a, turn * b);
        let all = sum.iter_mut().zip(spectrum).zip(one.iter().zip(other));
        if b == Complex::ZERO {
            all.for_each(|((sum, s), (one, _))| *sum += s * (a * one));
        } else {
            all.for_each(|((sum, s), (one, other))| *sum += s * (a * one + b * other));
        }
    }
}

impl Kernel<'_> {
    /// Times i so many times.
    fn turned(self, times: u32) -> Self {
        let turns = times + u32::from(self.is_imaginary);
        let sign = if turns % 4 < 2 { 1.0 } else { -1.0 };
        let terms = self.terms.map(|(factor, kernel)| (sign * factor, kernel));
        Self { terms, is_imaginary: turns % 2 == 1 }
    }

    /// Adds the product with part of a `spectrum`, for which the kernel begins at `first`.
    fn add(&self, first: usize, spectrum: &[Complex<f64>], sum: &mut [Complex<f64>]) {
        let [(a, one), (b, other)] = self.terms.map(|(factor, kernel)| (factor, &kernel[first..]));
        let kernel = one.iter().zip(other).map(|(one, other)| a * one + b * other);
        let all = sum.iter_mut().zip(spectrum).zip(kernel);
        if self.is_imaginary {
            all.for_each(|((sum, s), k)| *sum += Complex::new(-s.im * k, s.re * k));
        } else {
            all.for_each(|((sum, s), k)| *sum += s * k);
        }
    }
}

/// Convolutions that were made, those used last at the end, at most so many.
static MADE: Mutex<Vec<Arc<Convolution>>> = Mutex::new(Vec::new());
const KEPT: usize = 128;

/// Kernels between strips that were made, by the spacings of the grid, m, the lines of twice a strip's rectangle and the lines from one strip to the other; at most so
/// many, of some hundred kilobytes each.
static APART: Mutex<Vec<(Apart, KernelsApart)>> = Mutex::new(Vec::new());
const KEPT_APART: usize = 64;

/// What kernels between strips depend on.
type Apart = (Vector2<f64>, (usize, usize), isize);

/// Transforms of the kernels between strips.
type KernelsApart = Arc<Spectra<Complex<f64>>>;

impl Convolution {
    /// That of a grid with spacings `cell` (m) over at least `extent` lines along the profile and the track. Grids of one spacing share it:
    /// spacings and sizes are few, and it knows nothing of materials.
    pub fn shared(cell: Vector2<f64>, extent: (usize, usize)) -> Arc<Self> {
        let padded = (smooth(2 * extent.0), smooth(2 * extent.1));
        let made = || MADE.lock().unwrap_or_else(PoisonError::into_inner);
        let found = |made: &mut Vec<Arc<Self>>| {
            let place = made.iter().position(|known| known.table.cell == cell && known.padded == padded)?;
            let known = made.remove(place);
            made.push(known.clone());
            Some(known)
        };
        if let Some(known) = found(&mut made()) {
            return known;
        }
        let new = Arc::new(Self::new(cell, padded));
        let mut made = made();
        if made.len() == KEPT {
            made.remove(0);
        }
        made.push(new.clone());
        new
    }

    fn new(cell: Vector2<f64>, padded: (usize, usize)) -> Self {
        let mut real = RealFftPlanner::new();
        let mut complex = FftPlanner::new();
        let none = || Vec::new();
        let mut made = Self {
            table: HatTable::shared(cell, (padded.0 / 2, padded.1 / 2)),
            padded,
            rows: real.plan_fft_forward(padded.1),
            rows_back: real.plan_fft_inverse(padded.1),
            columns: complex.plan_fft_forward(padded.0),
            columns_back: complex.plan_fft_inverse(padded.0),
            spectra: Spectra { inverse: none(), across: none(), shear: none(), gradient: [none(), none()] },
            repeated: OnceLock::new(),
            mirrored: OnceLock::new(),
        };
        made.spectra = Spectra {
            inverse: made.kernel(|means| means.inverse).iter().map(|z| z.re).collect(),
            across: made.kernel(|means| means.across).iter().map(|z| z.re).collect(),
            shear: made.kernel(|means| means.shear).iter().map(|z| z.re).collect(),
            gradient: [0, 1]
                .map(|axis| made.kernel(|means| means.gradient[axis]).iter().map(|z| z.im).collect()),
        };
        made
    }

    /// Transform of a kernel over the signed offsets.
    fn kernel(&self, of: impl Fn(&Kernels) -> f64) -> Spectrum {
        self.kernel_over((0, &self.table), 0, of)
    }

    /// The kernels between places in two strips of lines, so many lines `apart`; `table` reaches over both.
    fn kernels_apart(&self, apart: isize, table: &HatTable) -> KernelsApart {
        let known = || APART.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (self.table.cell, self.padded, apart);
        if let Some((_, spectra)) = known().iter().find(|(of, _)| *of == key) {
            return spectra.clone();
        }
        let kernel = |of: fn(&Kernels) -> f64| self.kernel_over((apart, table), 0, of);
        let new = Arc::new(Spectra {
            inverse: kernel(|means| means.inverse),
            across: kernel(|means| means.across),
            shear: kernel(|means| means.shear),
            gradient: [kernel(|means| means.gradient[0]), kernel(|means| means.gradient[1])],
        });
        let mut known = known();
        if known.len() == KEPT_APART {
            known.remove(0);
        }
        known.push((key, new.clone()));
        new
    }

    /// Transform of a kernel of a `table` over the signed offsets between two strips of lines `apart`, with so many lines more, 0 or 1, in either direction, which
    /// have the values before them.
    fn kernel_over(
        &self,
        (apart, table): (isize, &HatTable),
        more: isize,
        of: impl Fn(&Kernels) -> f64,
    ) -> Spectrum {
        let (lines, columns) = self.padded;
        let reach = ((lines / 2) as isize, (columns / 2) as isize);
        let scale = 1.0 / (lines * columns) as f64;
        let wrap = |offset: isize, size: usize| offset.rem_euclid(size as isize) as usize;
        let offsets =
            (1 - reach.0..reach.0 + more).flat_map(|i| (1 - reach.1..reach.1 + more).map(move |k| (i, k)));
        self.transform(offsets.map(|(i, k)| {
            let known = (apart + i.min(reach.0 - 1), k.min(reach.1 - 1));
            ((wrap(i, lines), wrap(k, columns)), scale * of(&table.at(known)))
        }))
    }

    /// Transform of values at places, zero elsewhere.
    pub fn transform(&self, values: impl Iterator<Item = ((usize, usize), f64)>) -> Spectrum {
        let (lines, columns) = self.padded;
        let half = columns / 2 + 1;
        let mut real = vec![0.0; lines * columns];
        let mut used = vec![false; lines];
        for ((i, k), value) in values {
            real[i * columns + k] = value;
            used[i] = true;
        }
        let mut spectrum = vec![Complex::default(); lines * half];
        let (mut row, mut scratch) = (self.rows.make_output_vec(), self.rows.make_scratch_vec());
        for i in (0..lines).filter(|&i| used[i]) {
            let input = &mut real[i * columns..(i + 1) * columns];
            self.rows.process_with_scratch(input, &mut row, &mut scratch).expect("lengths of the plan");
            row.iter().enumerate().for_each(|(k, z)| spectrum[k * lines + i] = *z);
        }
        self.columns.process(&mut spectrum);
        spectrum
    }

    /// Adds to `sum` what the forces with a `spectrum` in the direction `from` (0 normal, 1 lateral, 2 along the track) move in the
    /// direction `to`; what the kernels are multiplied by is that of [`Factors::entry`].
    pub fn add(
        &self,
        factors: &Factors,
        (to, from): (usize, usize),
        spectrum: &[Complex<f64>],
        sum: &mut [Complex<f64>],
    ) {
        self.spectra.of(factors, (to, from)).add(0, spectrum, sum);
    }

    /// As [`Self::add`], between strips of lines so many lines `apart`, from that of the spectrum to that of the sum; `table` reaches over both.
    pub fn add_apart(
        &self,
        (apart, table): (isize, &HatTable),
        factors: &Factors,
        directions: (usize, usize),
        spectrum: &[Complex<f64>],
        sum: &mut [Complex<f64>],
    ) {
        self.kernels_apart(apart, table).add(factors, directions, (0, 0), spectrum, sum);
    }

    /// As [`Self::add_apart`], of spectra of mirror images.
    pub fn add_apart_mirrored(
        &self,
        (apart, table): (isize, &HatTable),
        factors: &Factors,
        directions: (usize, usize),
        spectrum: &[Complex<f64>],
        sum: &mut [Complex<f64>],
    ) {
        let kernels = self.kernels_apart(apart, table);
        for (first, spectrum, sum) in self.by_frequency(spectrum, sum) {
            kernels.add(factors, directions, (first, turns(directions)), spectrum, sum);
        }
    }

    /// Transforms of values that are their own mirror image along the track, or the opposite of it.
    pub fn mirrored(&self) -> &MirroredTransform {
        self.mirrored.get_or_init(|| MirroredTransform::new(self.padded))
    }

    /// As [`Self::add`], of spectra of mirror images.
    pub fn add_mirrored(
        &self,
        factors: &Factors,
        (to, from): (usize, usize),
        spectrum: &[Complex<f64>],
        sum: &mut [Complex<f64>],
    ) {
        let kernel = self.spectra.of(factors, (to, from)).turned(turns((to, from)));
        self.by_frequency(spectrum, sum).for_each(|(first, spectrum, sum)| kernel.add(first, spectrum, sum));
    }

    /// Two spectra of mirror images by their frequencies along the track, each with where its kernels begin.
    fn by_frequency<'s>(
        &self,
        spectrum: &'s [Complex<f64>],
        sum: &'s mut [Complex<f64>],
    ) -> impl Iterator<Item = (usize, &'s [Complex<f64>], &'s mut [Complex<f64>])> {
        let (count, lines) = (self.mirrored().frequencies(), self.padded.0);
        let all = spectrum.chunks_exact(count).zip(sum.chunks_exact_mut(count));
        all.enumerate().map(move |(k, (spectrum, sum))| (k * lines, spectrum, sum))
    }

    /// As [`Self::divide`], of a spectrum of mirror images.
    pub fn divide_mirrored(&self, factors: &Factors, direction: usize, spectrum: &mut [Complex<f64>]) {
        let inverse: Vec<f64> = self.inverse(factors, direction).collect();
        let of_frequencies = inverse.chunks_exact(self.padded.0);
        for (spectrum, inverse) in
            spectrum.chunks_exact_mut(self.mirrored().frequencies()).zip(of_frequencies)
        {
            spectrum.iter_mut().zip(inverse).for_each(|(s, inverse)| *s *= inverse);
        }
    }

    /// Divides the `spectrum` of displacements in a direction (as in [`Self::add`]) by the kernel of that direction on a grid that repeats itself: what is left is that of
    /// the forces there.
    pub fn divide(&self, factors: &Factors, direction: usize, spectrum: &mut [Complex<f64>]) {
        spectrum.iter_mut().zip(self.inverse(factors, direction)).for_each(|(s, inverse)| *s *= inverse);
    }

    /// What the spectrum of displacements in a direction is multiplied by for that of forces on a grid that repeats itself, with the factor of both ways.
    fn inverse(&self, factors: &Factors, direction: usize) -> impl Iterator<Item = f64> {
        /// Part of the largest value of a kernel that its smallest has at least; rounding may leave less.
        const LEAST: f64 = 1e-7;
        let [kernel, across] = self.repeated.get_or_init(|| {
            let real = |kernel: Spectrum| kernel.iter().map(|z| z.re).collect();
            [
                real(self.kernel_over((0, &self.table), 1, |means| means.inverse)),
                real(self.kernel_over((0, &self.table), 1, |means| means.across)),
            ]
        });
        let Factors { inverse, tangential, .. } = *factors;
        let value = move |(k, a): (&f64, &f64)| match direction {
            0 => inverse * k,
            1 => inverse * k + tangential * a,
            _ => inverse * k + tangential * (k - a),
        };
        let values = move || kernel.iter().zip(across).map(value);
        let least = LEAST * values().fold(0.0, f64::max);
        // the kernel has the factor of both ways already, which stands below here
        let count = (self.padded.0 * self.padded.1) as f64;
        let both_ways = 1.0 / (count * count);
        values().map(move |value| both_ways / value.max(least))
    }

    /// The values whose `spectrum` it is at numbered `places` within the first `lines` along the profile.
    pub fn back(
        &self,
        mut spectrum: Spectrum,
        lines: usize,
        places: impl Iterator<Item = (usize, (usize, usize))>,
        mut each: impl FnMut(usize, f64),
    ) {
        let (padded, columns) = self.padded;
        self.columns_back.process(&mut spectrum);
        let mut real = vec![0.0; lines * columns];
        let (mut row, mut scratch) = (self.rows_back.make_input_vec(), self.rows_back.make_scratch_vec());
        let last = row.len() - 1;
        for i in 0..lines {
            row.iter_mut().enumerate().for_each(|(k, z)| *z = spectrum[k * padded + i]);
            // those of a real row are real; what is left is rounding. The number of columns is even
            (row[0].im, row[last].im) = (0.0, 0.0);
            let output = &mut real[i * columns..(i + 1) * columns];
            self.rows_back.process_with_scratch(&mut row, output, &mut scratch).expect("lengths of the plan");
        }
        places.for_each(|(j, place)| each(j, real[place.0 * columns + place.1]));
    }

    /// Lines along the profile that it reaches over.
    pub fn lines(&self) -> usize {
        self.padded.0 / 2
    }

    /// Lines along the track that it reaches over.
    pub fn columns(&self) -> usize {
        self.padded.1 / 2
    }

    /// A spectrum of zeros.
    pub fn zero(&self) -> Spectrum {
        vec![Complex::default(); self.padded.0 * (self.padded.1 / 2 + 1)]
    }
}

/// How often a kernel is multiplied by i between spectra of mirror images: those of opposite values are.
fn turns((to, from): (usize, usize)) -> u32 {
    let of = |direction, turns| if direction == ALONG { turns } else { 0 };
    of(from, 3) + of(to, 1)
}

/// Smallest number from `least` on that is even and has no other primes than 2, 3 and 5.
fn smooth(least: usize) -> usize {
    let is_smooth = |mut n: usize| {
        for prime in [2, 3, 5] {
            while n.is_multiple_of(prime) {
                n /= prime;
            }
        }
        n == 1
    };
    (least.max(2)..).find(|&n| n.is_multiple_of(2) && is_smooth(n)).unwrap_or(least)
}
