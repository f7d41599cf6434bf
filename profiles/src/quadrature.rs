//! Gauss-Legendre rules (M. Abramowitz, I.A. Stegun, Handbook of Mathematical Functions, table 25.4).
//!
//! A rule of n points is exact for polynomials up to the degree 2n - 1. Abscissa and weight of every point, on -1..1 or
//! on 0..1 as its name says.

/// Coordinate of the two points on -1..1, 1/√3; both weights are 1.
pub const GAUSS_2: f64 = 0.577_350_269_189_625_8;

/// Three points on -1..1.
pub const GAUSS_3: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Five points on -1..1.
pub const GAUSS_5: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// [`GAUSS_5`] on 0..1.
pub const GAUSS_5_UNIT: [(f64, f64); 5] = [
    (0.046_910_077_030_668_004, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// Twelve points on -1..1: those on the positive side first, from the middle outwards, then their mirror images.
pub const GAUSS_12: [(f64, f64); 12] = mirrored([
    (0.125_233_408_511_468_9, 0.249_147_045_813_402_8),
    (0.367_831_498_998_180_2, 0.233_492_536_538_354_8),
    (0.587_317_954_286_617_5, 0.203_167_426_723_065_9),
    (0.769_902_674_194_304_7, 0.160_078_328_543_346_2),
    (0.904_117_256_370_474_9, 0.106_939_325_995_318_4),
    (0.981_560_634_246_719_3, 0.047_175_336_386_511_8),
]);

const fn mirrored(half: [(f64, f64); 6]) -> [(f64, f64); 12] {
    let mut rule = [(0.0, 0.0); 12];
    let mut i = 0;
    while i < 6 {
        rule[i] = half[i];
        rule[i + 6] = (-half[i].0, half[i].1);
        i += 1;
    }
    rule
}

/// Four points on 0..1, from their closed form.
pub fn gauss_4_unit() -> [(f64, f64); 4] {
    let root = (6.0f64 / 5.0).sqrt();
    let outer = ((3.0 + 2.0 * root) / 7.0).sqrt();
    let inner = ((3.0 - 2.0 * root) / 7.0).sqrt();
    let weight = 30.0f64.sqrt() / 72.0;
    [
        (0.5 * (1.0 - outer), 0.25 - weight),
        (0.5 * (1.0 - inner), 0.25 + weight),
        (0.5 * (1.0 + inner), 0.25 + weight),
        (0.5 * (1.0 + outer), 0.25 - weight),
    ]
}

/// The two points on `a`..`b`, and the weight of each.
pub fn gauss_2_on(a: f64, b: f64) -> ([f64; 2], f64) {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let off = half / 3.0_f64.sqrt();
    ([middle - off, middle + off], half)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: every rule integrates all powers up to the degree 2n - 1, whose integral over -1..1 is 0 or 2/(p + 1) and
    /// over 0..1 is 1/(p + 1), and not the next even one. Accuracy: ROUNDOFF of twelve terms of order one.
    #[test]
    fn rules_are_exact_to_their_degree() {
        const ROUNDOFF: f64 = 4e-15;
        let on_pair = |rule: &[(f64, f64)], p: i32| -> f64 { rule.iter().map(|(x, w)| w * x.powi(p)).sum() };
        let two = {
            let (points, weight) = gauss_2_on(-1.0, 1.0);
            assert!((points[1] - GAUSS_2).abs() < ROUNDOFF);
            points.map(|x| (x, weight))
        };
        let symmetric: [&[(f64, f64)]; 4] = [&two, &GAUSS_3, &GAUSS_5, &GAUSS_12];
        for rule in symmetric {
            let degree = 2 * rule.len() as i32 - 1;
            let exact = |p: i32| if p % 2 == 0 { 2.0 / f64::from(p + 1) } else { 0.0 };
            for p in 0..=degree {
                assert!((on_pair(rule, p) - exact(p)).abs() < ROUNDOFF, "{} points, power {p}", rule.len());
            }
            let next = degree + 1;
            assert!((on_pair(rule, next) - exact(next)).abs() > 1e-9, "{} points, power {next}", rule.len());
        }
        let unit: [&[(f64, f64)]; 2] = [&gauss_4_unit(), &GAUSS_5_UNIT];
        for rule in unit {
            for p in 0..2 * rule.len() as i32 {
                let exact = 1.0 / f64::from(p + 1);
                assert!((on_pair(rule, p) - exact).abs() < ROUNDOFF, "{} points, power {p}", rule.len());
            }
        }
    }
}
