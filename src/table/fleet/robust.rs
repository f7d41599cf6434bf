//! Statistics that a few wrong values do not change: quantiles, median deviations, lines by medians of slopes.

use std::ops::Range;

use crate::verify::quantile;

/// Quantile of the normal distribution for a two-sided interval of 95 %.
const TWO_SIDED_95: f64 = 1.959_964;
/// Standard deviation of a normal distribution over its median absolute deviation.
const NORMAL: f64 = 1.482_602;
/// The same over its mean absolute deviation.
const NORMAL_OF_MEAN: f64 = 1.253_314;
/// Most points of a group of a line; the pairs grow with their square.
const POINTS: usize = 1000;

/// The finite values in ascending order.
pub fn sorted(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.into_iter().filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The quantiles of 5, 50 and 95 % of some values.
pub fn band(values: impl IntoIterator<Item = f64>) -> Option<[f64; 3]> {
    let values = sorted(values);
    Some([quantile(&values, 0.05)?, quantile(&values, 0.5)?, quantile(&values, 0.95)?])
}

/// Median and spread of some values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// The median.
    pub median: f64,
    /// The median absolute deviation, as the standard deviation of a normal distribution that has it; the mean one where half of the
    /// values are equal, as measures of wear that begin at zero (Iglewicz and Hoaglin 1993).
    pub deviation: f64,
}

impl Spread {
    /// Of the finite values; none without any.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let values = sorted(values);
        let median = quantile(&values, 0.5)?;
        let off = sorted(values.iter().map(|value| (value - median).abs()));
        let of_median = NORMAL * quantile(&off, 0.5)?;
        // what rounding leaves of equal values is no spread
        let least = 1e-12 * median.abs();
        let deviation = match of_median > least {
            true => of_median,
            false => NORMAL_OF_MEAN * off.iter().sum::<f64>() / off.len() as f64,
        };
        Some(Self { median, deviation: if deviation > least { deviation } else { 0.0 } })
    }

    /// How many deviations a value is from the median; none where all values are equal.
    pub fn score(&self, value: f64) -> Option<f64> {
        (self.deviation > 0.0).then(|| (value - self.median) / self.deviation)
    }
}

/// Slope of a line by the median of the slopes of pairs (Theil 1950, Sen 1968).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slope {
    /// The slope.
    pub slope: f64,
    /// Its interval of 95 %; none where the points are too few for one.
    pub interval: Option<[f64; 2]>,
    /// Points that it is of.
    pub points: usize,
}

impl Slope {
    /// The common slope of groups of points (x, y), each with a level of its own: pairs are taken within groups (Hirsch, Slack and Smith 1982).
    /// None without two different x in a group.
    pub fn of(groups: &[Vec<(f64, f64)>]) -> Option<Self> {
        let (mut slopes, mut variance, mut points) = (Vec::new(), 0.0, 0);
        for group in groups {
            let every = group.len().div_ceil(POINTS).max(1);
            let group: Vec<(f64, f64)> = group.iter().copied().step_by(every).collect();
            let count = slopes.len();
            for (index, a) in group.iter().enumerate() {
                let others = group[index + 1..].iter().filter(|b| b.0 != a.0);
                slopes.extend(others.map(|b| (b.1 - a.1) / (b.0 - a.0)));
            }
            if slopes.len() > count {
                points += group.len();
                variance += variance_of_signs(&group);
            }
        }
        let slopes = sorted(slopes);
        let slope = quantile(&slopes, 0.5)?;
        // ranks of the ends, counted from 1: Gilbert 1987, section 16.5
        let (pairs, half) = (slopes.len() as f64, TWO_SIDED_95 * variance.sqrt());
        let (low, high) = ((0.5 * (pairs - half)).floor(), (0.5 * (pairs + half)).ceil() + 1.0);
        let known = low >= 1.0 && high <= pairs;
        let interval = known.then(|| [slopes[low as usize - 1], slopes[high as usize - 1]]);
        Some(Self { slope, interval, points })
    }

    /// Whether the interval lies on one side of zero.
    pub fn is_sure(&self) -> bool {
        self.interval.is_some_and(|[low, high]| low > 0.0 || high < 0.0)
    }
}

/// Variance of Kendall's sum of signs, with ties in either coordinate.
fn variance_of_signs(points: &[(f64, f64)]) -> f64 {
    let term = |count: f64| count * (count - 1.0) * (2.0 * count + 5.0) / 18.0;
    let ties = |values: Vec<f64>| -> f64 {
        values.chunk_by(|a, b| a == b).map(|equal| term(equal.len() as f64)).sum()
    };
    let [x, y] = [sorted(points.iter().map(|p| p.0)), sorted(points.iter().map(|p| p.1))].map(ties);
    (term(points.len() as f64) - x - y).max(0.0)
}

/// Ranges of ascending values with equal counts, `count` at most; equal values share a range.
pub fn bins(sorted: &[f64], count: usize) -> Vec<Range<usize>> {
    let mut bins = Vec::new();
    let mut begin = 0;
    for bin in 1..=count {
        let mut end = (sorted.len() * bin / count.max(1)).max(begin);
        while end > begin && end < sorted.len() && sorted[end] == sorted[end - 1] {
            end += 1;
        }
        if end > begin {
            bins.push(begin..end);
            begin = end;
        }
    }
    bins
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of a few operations on numbers of the size of 1 to 100.
    const ROUNDOFF: f64 = 1e-12;

    /// Numbers from 0 to 1 that look random, the same each time.
    fn noise() -> impl Iterator<Item = f64> {
        let mut state = 0x2545_f491_4f6c_dd1d_u64;
        std::iter::from_fn(move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            Some((state >> 11) as f64 / (1_u64 << 53) as f64)
        })
    }

    /// Source: by hand. Goal: quantiles of 0, 10, ... 100, between neighbours in proportion. Accuracy: ROUNDOFF.
    #[test]
    fn quantiles_of_a_ladder() {
        let [low, middle, high] = band((0..=10).rev().map(|n| 10.0 * f64::from(n))).unwrap();
        assert!((low - 5.0).abs() + (middle - 50.0).abs() + (high - 95.0).abs() < ROUNDOFF);
        assert_eq!(quantile(&[], 0.5), None);
        assert_eq!(quantile(&[7.0], 0.95), Some(7.0));
        assert_eq!(quantile(&sorted([4.0, f64::NAN, 1.0]), 0.5), Some(2.5));
    }

    /// Source: by hand: 1, 2, 3, 4, 100 have the median 3 and the deviations 0, 1, 1, 2, 97. Goal: one wild value changes neither. Accuracy: ROUNDOFF.
    #[test]
    fn a_wild_value_does_not_move_the_spread() {
        let spread = Spread::of([1.0, 2.0, 100.0, 3.0, 4.0]).unwrap();
        assert_eq!(spread.median, 3.0);
        assert!((spread.deviation - NORMAL).abs() < ROUNDOFF);
        assert!((spread.score(100.0).unwrap() - 97.0 / NORMAL).abs() < ROUNDOFF);
        // half are equal: the mean deviation is a quarter
        let score = Spread::of([5.0, 5.0, 5.0, 6.0]).unwrap().score(6.0).unwrap();
        assert!((score - 4.0 / NORMAL_OF_MEAN).abs() < ROUNDOFF);
        assert_eq!(Spread::of([5.0, 5.0, 5.0 + 1e-15]).unwrap().score(6.0), None);
    }

    /// Source: closed: the slopes of (0, 0), (1, 1), (2, 3) are 1, 2 and 1.5. Goal: their median; a line with a wild point; groups of different levels. Exact.
    #[test]
    fn slopes_of_pairs() {
        let slope = Slope::of(&[vec![(0.0, 0.0), (1.0, 1.0), (2.0, 3.0)]]).unwrap();
        assert_eq!((slope.slope, slope.interval, slope.points), (1.5, None, 3));
        let line = |level: f64| (0..12).map(move |x| (f64::from(x), level + 2.0 * f64::from(x)));
        let mut wild: Vec<(f64, f64)> = line(0.0).collect();
        wild[5].1 = 1e3;
        assert_eq!(Slope::of(&[wild]).unwrap().slope, 2.0);
        let levels = Slope::of(&[line(0.0).collect(), line(-70.0).collect()]).unwrap();
        assert_eq!((levels.slope, levels.interval), (2.0, Some([2.0, 2.0])));
        assert!(levels.is_sure());
        assert_eq!(Slope::of(&[vec![(1.0, 0.0), (1.0, 5.0)]]), None);
    }

    /// Source: lines of slope 3 with even noise, 2000 times. Goal: the interval of 95 % has the slope in 93 to 97 % of them: 95 % and four
    /// standard errors of the count.
    #[test]
    fn intervals_hold_what_they_say() {
        let mut noise = noise();
        let mut inside = 0;
        for _ in 0..2000 {
            let points = (0..20).map(|x| (f64::from(x), 3.0 * f64::from(x) + 10.0 * noise.next().unwrap()));
            let [low, high] = Slope::of(&[points.collect()]).unwrap().interval.unwrap();
            inside += usize::from(low <= 3.0 && 3.0 <= high);
        }
        assert!((1860..=1940).contains(&inside), "{inside} of 2000");
    }

    /// Source: by hand. Goal: bins of equal counts that do not part equal values.
    #[test]
    fn bins_have_equal_counts() {
        let values: Vec<f64> = (0..10).map(f64::from).collect();
        assert_eq!(bins(&values, 3), [0..3, 3..6, 6..10]);
        assert_eq!(bins(&[1.0, 1.0, 1.0, 1.0, 2.0, 3.0], 3), [0..4, 4..6]);
        assert_eq!(bins(&[1.0, 1.0], 2), vec![0..2]);
        assert!(bins(&[], 3).is_empty() && bins(&values, 0).is_empty());
    }
}
