//! Roots inside a bracket: by Newton steps where the slope is known, by secants where the function is expensive and almost
//! linear, by halving where only its sign is known.

/// Root of `f` in `[lo, hi]` by Newton steps, each replaced by a bisection when it leaves the bracket.
///
/// `f` returns value and slope, and must not be positive at `lo` nor negative at `hi`. Ends when the bracket or
/// the step is a few units in the last place wide, so the result is as good as `f` itself.
pub fn bracketed_newton(mut f: impl FnMut(f64) -> (f64, f64), mut lo: f64, mut hi: f64) -> f64 {
    const MAX_ITERATIONS: usize = 200;
    let resolution = 2.0 * f64::EPSILON * lo.abs().max(hi.abs());
    let mut x = 0.5 * (lo + hi);
    let mut last_width = hi - lo;
    for _ in 0..MAX_ITERATIONS {
        let (value, slope) = f(x);
        if value == 0.0 {
            return x;
        }
        if value < 0.0 {
            lo = x;
        } else {
            hi = x;
        }
        let newton = x - value / slope;
        let step = (newton - x).abs();
        if step <= resolution {
            return x;
        }
        // A step that does not halve the last one is replaced: this bounds the work by that of bisection.
        let next =
            if newton > lo && newton < hi && step < 0.5 * last_width { newton } else { 0.5 * (lo + hi) };
        last_width = (next - x).abs();
        x = next;
        if last_width <= resolution || hi - lo <= resolution {
            break;
        }
    }
    x
}

/// Root of a smooth, almost linear function between two points of opposite sign, by regula falsi with halving
/// (M. Dowell, P. Jarratt, "A modified regula falsi method", BIT 11 (1971)); `None` if it cannot be evaluated. Points are pairs of
/// place and value; ends at a value of 1e-13 or a bracket of 1e-14.
pub fn regula_falsi(
    mut left: (f64, f64),
    mut right: (f64, f64),
    f: impl Fn(f64) -> Option<f64>,
) -> Option<f64> {
    for _ in 0..60 {
        let s = (left.0 * right.1 - right.0 * left.1) / (right.1 - left.1);
        let value = f(s)?;
        if value.abs() < 1e-13 || (right.0 - left.0).abs() < 1e-14 {
            return Some(s);
        }
        if value * right.1 < 0.0 {
            left = right;
        } else {
            left.1 *= 0.5;
        }
        right = (s, value);
    }
    Some(right.0)
}

/// Where `beyond` changes in `lo`..`hi` from false to true, to the last bit, by halving; it must be monotone. An end of
/// the range, to its last bit, where it does not change.
pub fn bisection(mut lo: f64, mut hi: f64, beyond: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = 0.5 * (lo + hi);
        if middle <= lo || middle >= hi {
            return middle;
        }
        if beyond(middle) { hi = middle } else { lo = middle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ROUNDOFF: two units in the last place of a root near one.
    const ROUNDOFF: f64 = 4.0 * f64::EPSILON;

    #[test]
    fn finds_the_cube_root_of_two() {
        let root = bracketed_newton(|x| (x * x * x - 2.0, 3.0 * x * x), 0.0, 2.0);
        assert!((root - 2f64.cbrt()).abs() < ROUNDOFF);
    }

    /// Goal: halving and secants find the cube root of two, too; a function that cannot be evaluated has no root, and a
    /// range without a change ends at its end. Accuracy: ROUNDOFF, and the 1e-13 at which the secants end.
    #[test]
    fn the_other_ways_find_the_same_root() {
        let f = |x: f64| x * x * x - 2.0;
        assert!((bisection(0.0, 2.0, |x| f(x) > 0.0) - 2f64.cbrt()).abs() < ROUNDOFF);
        let root = regula_falsi((1.0, f(1.0)), (2.0, f(2.0)), |x| Some(f(x))).unwrap();
        assert!((root - 2f64.cbrt()).abs() < 1e-13, "{root}");
        assert_eq!(regula_falsi((1.0, -1.0), (2.0, 6.0), |_| None), None);
        assert_eq!((bisection(1.0, 2.0, |_| false), bisection(1.0, 2.0, |_| true)), (2.0, 1.0));
    }

    /// Goal: where Newton's steps settle, nothing is halved after them, whatever the last digits of the root. Each step takes its digits twice as
    /// far, so that six are enough for all; halving takes some fifty.
    #[test]
    fn settled_steps_end_the_search() {
        for square in (0..500).map(|i| 0.05 + 7e-5 * f64::from(i)) {
            let mut calls = 0;
            let over = |x: f64| {
                calls += 1;
                (x * x - square, 2.0 * x)
            };
            let root = bracketed_newton(over, 0.2, 0.3);
            assert!((root - square.sqrt()).abs() < ROUNDOFF && calls <= 6, "{square}: {root} after {calls}");
        }
    }

    #[test]
    fn survives_a_flat_start() {
        let root = bracketed_newton(|x| (x * x * x, 3.0 * x * x), -1.0, 3.0);
        assert!(root.abs() < 1e-5, "a triple root is only known to the cube root of the round-off: {root}");
    }
}
