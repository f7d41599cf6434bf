//! Differences of two runs in when and how the wheel touches the rail.

use railspring_simulate::time::history::History;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::change::together;
use super::limits::Limits;
use super::signals::{ModeFractions, Separation, fractions_of, separations};

/// Differences of separations and contact modes of two runs.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct ContactDifference {
    /// Largest difference of the times at which paired separations begin, s; none where none do.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub begin_s: Option<f64>,
    /// The same of the times at which they end, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end_s: Option<f64>,
    /// Separations that only one of the runs has.
    pub unmatched: usize,
    /// Difference of the fractions of the time sticking, sliding and separated.
    pub modes: [f64; 3],
}

impl ContactDifference {
    /// Of the first `rows` of two runs, without contact under `least` (N); times of separations up to that of the last of them.
    pub(super) fn between([a, b]: [&History; 2], rows: usize, least: f64, limits: &Limits) -> Self {
        let until = rows.checked_sub(1).map_or(f64::NEG_INFINITY, |last| b.rows[last].time);
        let all = [a, b].map(|run| separations(run, 0.0, least));
        let (pairs, alone) = pair_separations(
            all.each_ref().map(Vec::as_slice),
            limits.separation_shortest_s,
            limits.ratio_window_s,
        );
        let [begin_s, end_s] = [|s: &Separation| s.begin_s, |s: &Separation| s.end_s].map(|time| {
            let both = pairs.iter().map(|pair| pair.each_ref().map(time));
            let before = both.filter(|pair| pair.iter().all(|time| *time <= until));
            before.map(|[a, b]| (a - b).abs()).max_by(f64::total_cmp)
        });
        // the initial state does not count
        let modes = [a, b].map(|run| fractions_of(run.rows.get(1..rows).unwrap_or_default(), least));
        let fraction = |of: fn(&ModeFractions) -> f64| (of(&modes[0]) - of(&modes[1])).abs();
        Self {
            begin_s,
            end_s,
            unmatched: alone.iter().filter(|s| s.begin_s <= until).count(),
            modes: [fraction(|m| m.stick), fraction(|m| m.slip), fraction(|m| m.separated)],
        }
    }

    /// Times at which separations begin and end, s.
    pub(super) fn times(&self) -> [Option<f64>; 2] {
        [self.begin_s, self.end_s]
    }

    /// Two causes that have nothing to do with each other, both together: differences add as the root of their squares, separations are counted.
    pub(super) fn with(&self, other: &Self) -> Self {
        Self {
            begin_s: together(self.begin_s, other.begin_s),
            end_s: together(self.end_s, other.end_s),
            unmatched: self.unmatched + other.unmatched,
            modes: [0, 1, 2].map(|n| self.modes[n].hypot(other.modes[n])),
        }
    }
}

/// Pairs separations of two runs that last at least `shortest` seconds, each used once. Those that overlap
/// come first, in order. Then one that is left over is paired with a shorter one of the other run that it
/// overlaps, as it is not that run alone which separates there. Last are those that lie no more than `reach`
/// apart, without another pair between them. Also those that stay alone.
fn pair_separations(
    all: [&[Separation]; 2],
    shortest: f64,
    reach: f64,
) -> (Vec<[Separation; 2]>, Vec<Separation>) {
    let long = all.map(|of| of.iter().filter(|s| s.length() >= shortest).copied().collect::<Vec<_>>());
    let mut pairs = Vec::new();
    let mut alone = in_order(long.each_ref().map(Vec::as_slice), 0.0, |_| true, &mut pairs);
    for (of, other) in [(0, 1), (1, 0)] {
        alone[of].retain(|one| {
            let meets =
                |s: &&Separation| s.length() < shortest && s.begin_s <= one.end_s && one.begin_s <= s.end_s;
            let met = all[other].iter().find(meets);
            pairs.extend(met.map(|met| if of == 0 { [*one, *met] } else { [*met, *one] }));
            met.is_none()
        });
    }
    let known = pairs.clone();
    let nothing_between = |[a, b]: [&Separation; 2]| {
        let (first, second) = if a.begin_s < b.begin_s { (a, b) } else { (b, a) };
        !known.iter().flatten().any(|s| s.begin_s > first.end_s && s.end_s < second.begin_s)
    };
    let alone = in_order(alone.each_ref().map(Vec::as_slice), reach, nothing_between, &mut pairs);
    (pairs, alone.concat())
}

/// Adds pairs of two lists in order that lie no more than `reach` apart and `may` be pairs; what is left of each.
fn in_order(
    [a, b]: [&[Separation]; 2],
    reach: f64,
    may: impl Fn([&Separation; 2]) -> bool,
    pairs: &mut Vec<[Separation; 2]>,
) -> [Vec<Separation>; 2] {
    let mut alone = [Vec::new(), Vec::new()];
    let (mut i, mut j) = (0, 0);
    while let (Some(first), Some(second)) = (a.get(i), b.get(j)) {
        let near = first.end_s + reach >= second.begin_s && second.end_s + reach >= first.begin_s;
        if near && may([first, second]) {
            pairs.push([*first, *second]);
            (i, j) = (i + 1, j + 1);
        } else if first.end_s < second.end_s {
            alone[0].push(*first);
            i += 1;
        } else {
            alone[1].push(*second);
            j += 1;
        }
    }
    alone[0].extend(&a[i..]);
    alone[1].extend(&b[j..]);
    alone
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(times: &[(f64, f64)]) -> Vec<Separation> {
        times.iter().map(|(begin, length)| Separation { begin_s: *begin, end_s: begin + length }).collect()
    }

    fn paired(a: &[(f64, f64)], b: &[(f64, f64)]) -> (Vec<[f64; 2]>, Vec<f64>) {
        let [a, b] = [a, b].map(list);
        let (pairs, alone) = pair_separations([&a, &b], 0.002, 0.024);
        let mut pairs: Vec<[f64; 2]> = pairs.iter().map(|pair| pair.map(|s| s.begin_s)).collect();
        pairs.sort_by(|a, b| a[0].total_cmp(&b[0]));
        (pairs, alone.iter().map(|s| s.begin_s).collect())
    }

    /// Goal: separations (s) that overlap are pairs whatever stands before them alone. That one is paired
    /// with a shorter one that it overlaps. Those that do not overlap are pairs within a window of 24 ms
    /// where no other pair lies between them. The rest is alone.
    #[test]
    fn separations_that_overlap_are_pairs() {
        let a = [(0.0635, 0.002), (0.069, 0.0035), (0.075, 0.0045)];
        let b = [(0.0645, 0.0005), (0.069, 0.0025), (0.0745, 0.0045)];
        let all = vec![[0.0635, 0.0645], [0.069, 0.069], [0.075, 0.0745]];
        assert_eq!(paired(&a, &b), (all.clone(), vec![]));
        let swapped: Vec<[f64; 2]> = all.iter().map(|[a, b]| [*b, *a]).collect();
        assert_eq!(paired(&b, &a), (swapped, vec![]));
        // without the short one it is alone, and shifts nothing
        assert_eq!(paired(&a, &b[1..]), (all[1..].to_vec(), vec![0.0635]));
        assert_eq!(paired(&[(0.1, 0.003)], &[(0.11, 0.003)]), (vec![[0.1, 0.11]], vec![]));
        assert_eq!(paired(&[(0.1, 0.003)], &[(0.13, 0.003)]), (vec![], vec![0.1, 0.13]));
        let between = paired(&[(0.1, 0.003), (0.105, 0.003)], &[(0.106, 0.003), (0.11, 0.003)]);
        assert_eq!(between, (vec![[0.105, 0.106]], vec![0.1, 0.11]));
    }
}
