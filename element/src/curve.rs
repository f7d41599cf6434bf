//! Values along a rail, with their slopes.

/// Values at places, between them by cubic polynomials that meet with one slope; constant beyond the last, where they have none.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve<const N: usize> {
    places: Vec<(f64, [f64; N])>,
    slopes: Vec<[f64; N]>,
}

impl<const N: usize> Curve<N> {
    /// From two places at least, ascending.
    pub fn new(places: Vec<(f64, [f64; N])>) -> Self {
        let last = places.len() - 1;
        let chord = |n: usize, i: usize| {
            let [(a, from), (b, to)] = [&places[n], &places[n + 1]];
            ((to[i] - from[i]) / (b - a), b - a)
        };
        // of the parabola through a place and its neighbours
        let slope = |n: usize, i: usize| {
            if n == last {
                return 0.0;
            }
            let (after, next) = chord(n, i);
            match n.checked_sub(1) {
                None => after,
                Some(n) => {
                    let (before, previous) = chord(n, i);
                    (before * next + after * previous) / (next + previous)
                }
            }
        };
        let slopes = (0..=last).map(|n| std::array::from_fn(|i| slope(n, i))).collect();
        Self { places, slopes }
    }

    /// The places with their values.
    pub fn places(&self) -> &[(f64, [f64; N])] {
        &self.places
    }

    /// At a place; beyond the first and the last as there.
    pub fn at(&self, x: f64) -> [f64; N] {
        let (first, last) = (&self.places[0], &self.places[self.places.len() - 1]);
        if x <= first.0 || x >= last.0 {
            return if x <= first.0 { first.1 } else { last.1 };
        }
        let upper = self.places.partition_point(|(place, _)| *place <= x);
        let [(a, from), (b, to)] = [&self.places[upper - 1], &self.places[upper]];
        let [out, into] = [&self.slopes[upper - 1], &self.slopes[upper]];
        let (length, t) = (b - a, (x - a) / (b - a));
        let step = t * t * (3.0 - 2.0 * t);
        let [leaving, arriving] = [t * (1.0 - t) * (1.0 - t) * length, t * t * (t - 1.0) * length];
        std::array::from_fn(|i| from[i] + step * (to[i] - from[i]) + leaving * out[i] + arriving * into[i])
    }
}
