//! The runs as samples, where the motion of the solid model is no longer determined: no run follows another one there, but all of them have
//! the same distributions of forces, the same rate of separations and the same share of the contact modes.
//!
//! How far two such runs of the solid differ by chance is measured on the solid's run and its disturbed run: the time is cut into blocks, and
//! the difference of the two is taken without each block in turn (jackknife).

use std::ops::Range;

use railspring_simulate::time::history::{ContactMode, History};

use super::change::{FORCES, least_contact};
use super::limits::Limits;
use super::series::rms;
use super::signals::{mode, separations};

/// Fewest blocks that the time is cut into, each as long as the window of the averaged Q/P at least.
pub(super) const LEAST_BLOCKS: usize = 3;
/// Most blocks.
pub(super) const MOST_BLOCKS: usize = 20;
/// What is compared of each force: mean, RMS and these quantiles.
const QUANTILES: [f64; 3] = [0.05, 0.50, 0.95];
/// Numbers of a force.
pub(super) const OF_FORCE: usize = 2 + QUANTILES.len();
/// Numbers of a sample: those of P and Q, separations a second, and the fractions of three modes.
pub(super) const NUMBERS: usize = 2 * OF_FORCE + 4;

/// A row of a run, as a member of a sample.
#[derive(Clone, Copy)]
pub(super) struct Member {
    forces: [f64; 2],
    mode: ContactMode,
    /// Whether a separation begins here.
    separates: bool,
}

/// The rows of a run from some time on.
pub(super) fn sample(run: &History, rows: Range<usize>, limits: &Limits, least: f64) -> Vec<Member> {
    let all = separations(run, limits.separation_shortest_s, least);
    let begins: Vec<f64> = all.iter().map(|s| s.begin_s).collect();
    run.rows[rows]
        .iter()
        .map(|row| Member {
            forces: FORCES.map(|force| force(row)),
            mode: mode(row, least),
            separates: begins.binary_search_by(|begin| begin.total_cmp(&row.time)).is_ok(),
        })
        .collect()
}

/// The numbers of a sample without some of its rows, which are `step` (s) apart; of forces in N.
pub(super) fn numbers(sample: &[Member], without: Range<usize>, step: f64) -> [f64; NUMBERS] {
    let members = || sample[..without.start].iter().chain(&sample[without.end..]);
    let count = (sample.len() - without.len()) as f64;
    let mut found = [0.0; NUMBERS];
    for k in [0, 1] {
        let mut forces: Vec<f64> = members().map(|member| member.forces[k]).collect();
        let of = &mut found[OF_FORCE * k..];
        of[0] = forces.iter().sum::<f64>() / count;
        of[1] = rms(&forces);
        forces.sort_by(f64::total_cmp);
        for (n, share) in QUANTILES.into_iter().enumerate() {
            of[2 + n] = quantile(&forces, share).unwrap_or(f64::NAN);
        }
    }
    found[2 * OF_FORCE] = members().filter(|member| member.separates).count() as f64 / (count * step);
    for (n, mode) in [ContactMode::Stick, ContactMode::Slip, ContactMode::Separated].into_iter().enumerate() {
        found[2 * OF_FORCE + 1 + n] = members().filter(|member| member.mode == mode).count() as f64 / count;
    }
    found
}

/// Sizes of the differences of the numbers of two runs over some rows.
pub(super) fn differences([a, b]: [&History; 2], rows: Range<usize>, limits: &Limits) -> [f64; NUMBERS] {
    let (least, step) = (least_contact(a), step(a));
    let [a, b] = [a, b].map(|run| numbers(&sample(run, rows.clone(), limits, least), 0..0, step));
    std::array::from_fn(|n| (a[n] - b[n]).abs())
}

/// The value below which a share of the ascending values lies, on straight lines between them (type 7 of Hyndman and Fan, 1996); none of no values.
pub(crate) fn quantile(ascending: &[f64], share: f64) -> Option<f64> {
    let place = share.clamp(0.0, 1.0) * ascending.len().checked_sub(1)? as f64;
    let (below, above) = (ascending[place.floor() as usize], ascending[place.ceil() as usize]);
    Some(below + place.fract() * (above - below))
}

/// Below which 95 % of the sizes of Student's t lie with so many degrees of freedom, two at least: the expansion for many (Abramowitz and
/// Stegun, 26.7.5), which is 0.8 % below the truth for two.
fn student_95(freedom: usize) -> f64 {
    let (z, n) = (1.959_964_f64, freedom as f64);
    let terms = [
        (z.powi(3) + z) / 4.0,
        (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0,
        (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0,
        (79.0 * z.powi(9) + 776.0 * z.powi(7) + 1482.0 * z.powi(5) - 1920.0 * z.powi(3) - 945.0 * z)
            / 92160.0,
    ];
    terms.iter().rev().fold(0.0, |sum, term| (sum + term) / n) + z
}

/// How far the numbers of two runs of one model differ by chance, in 95 of 100 cases: the jackknife of their difference over `blocks`.
pub(super) fn chance(samples: [&[Member]; 2], step: f64, blocks: usize) -> [f64; NUMBERS] {
    let rows = samples[0].len();
    let differences: Vec<[f64; NUMBERS]> = (0..blocks)
        .map(|block| {
            let without = block * rows / blocks..(block + 1) * rows / blocks;
            let [a, b] = samples.map(|sample| numbers(sample, without.clone(), step));
            std::array::from_fn(|n| a[n] - b[n])
        })
        .collect();
    let count = blocks as f64;
    std::array::from_fn(|n| {
        let mean = differences.iter().map(|d| d[n]).sum::<f64>() / count;
        let squares: f64 = differences.iter().map(|d| (d[n] - mean).powi(2)).sum();
        student_95(blocks - 1) * (squares * (count - 1.0) / count).sqrt()
    })
}

/// Time between the rows of a run, s.
pub(super) fn step(run: &History) -> f64 {
    let last = run.rows.len() - 1;
    (run.rows[last].time - run.rows[0].time) / last as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ROUNDOFF: sums of a few numbers.
    const ROUNDOFF: f64 = 1e-9;

    fn of_forces(forces: &[f64]) -> Vec<Member> {
        let member = |&p: &f64| Member { forces: [p, -p], mode: ContactMode::Slip, separates: p > 4.0 };
        forces.iter().map(member).collect()
    }

    /// Source: tables of Student's t. Goal: the two-sided 95 % value. Accuracy: MODEL, the expansion is 0.8 % off for two degrees of freedom and less for more.
    #[test]
    fn the_factor_is_that_of_student() {
        const MODEL: f64 = 0.009;
        for (freedom, table) in [(2, 4.3027), (3, 3.1824), (5, 2.5706), (8, 2.3060), (19, 2.0930)] {
            let found = student_95(freedom);
            assert!((found / table - 1.0).abs() < MODEL, "{freedom}: {found} {table}");
        }
        assert!((student_95(1000) - 1.9623).abs() < 1e-4);
    }

    /// Source: the jackknife of a mean is its standard error, the deviation of the blocks' means over √blocks. Goal: blocks of two rows whose differences have the means 1, 2, 3 and 6 N: deviation
    /// √(14/3), error √(14/3)/2, times Student's factor with three degrees of freedom; the same of both forces. Accuracy: ROUNDOFF.
    #[test]
    fn the_chance_of_a_mean_is_its_standard_error() {
        let a = of_forces(&[1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 6.0, 6.0]);
        let b = of_forces(&[0.0; 8]);
        let found = chance([&a, &b], 5e-4, 4);
        let expected = student_95(3) * (14.0f64 / 3.0).sqrt() / 2.0;
        assert!((found[0] - expected).abs() < ROUNDOFF, "{} {expected}", found[0]);
        assert!((found[OF_FORCE] - expected).abs() < ROUNDOFF);
        assert_eq!(chance([&a, &a], 5e-4, 4), [0.0; NUMBERS]);
    }

    /// Goal: mean, RMS, quantiles, rate (1/s) and fractions of a sample without some rows. Accuracy: ROUNDOFF.
    #[test]
    fn numbers_of_a_sample() {
        let mut sample = of_forces(&[3.0, 100.0, 1.0, 5.0, 2.0, 4.0]);
        sample[0].mode = ContactMode::Separated;
        let found = numbers(&sample, 1..2, 0.01);
        // 1 to 5 N; a twentieth is at 0.2 of the way from the first to the second
        let expected = [3.0, 11f64.sqrt(), 1.2, 3.0, 4.8, -3.0, 11f64.sqrt(), -4.8, -3.0, -1.2];
        for (n, expected) in expected.into_iter().chain([20.0, 0.0, 0.8, 0.2]).enumerate() {
            assert!((found[n] - expected).abs() < ROUNDOFF, "{n}: {} {expected}", found[n]);
        }
    }
}
