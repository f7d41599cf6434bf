//! Roots inside a bracket.

/// Root of `f` in `[lo, hi]` by Newton steps, each replaced by a bisection when it leaves the bracket.
///
/// `f` returns value and slope, and must not be positive at `lo` nor negative at `hi`. Ends when the bracket or
/// the step is a few units in the last place wide, so the result is as good as `f` itself.
pub(crate) fn bracketed_newton(mut f: impl FnMut(f64) -> (f64, f64), mut lo: f64, mut hi: f64) -> f64 {
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

    #[test]
    fn survives_a_flat_start() {
        let root = bracketed_newton(|x| (x * x * x, 3.0 * x * x), -1.0, 3.0);
        assert!(root.abs() < 1e-5, "a triple root is only known to the cube root of the round-off: {root}");
    }
}
