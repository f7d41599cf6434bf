//! The force at a displacement, for laws whose displacement is an integral.

/// Relative accuracy of an inverse.
pub(super) const INVERSE_TOLERANCE: f64 = 1e-13;

/// Force, N, at which `under(force)`, a pair of displacement (m) and tangent (N/m), has `displacement`, to 1e-13 relative, by Newton from a
/// positive `guess` (N); 0 for a displacement of zero or below. The displacement has to be concave in the force.
pub(super) fn force_at(displacement: f64, guess: f64, under: impl Fn(f64) -> (f64, f64)) -> f64 {
    if displacement.is_nan() {
        return f64::NAN;
    }
    if displacement <= 0.0 {
        return 0.0;
    }
    let mut force = guess;
    for _ in 0..100 {
        let (reached, tangent) = under(force);
        // From above a tangent may undershoot to below zero: halve instead.
        let next = (force + tangent * (displacement - reached)).max(0.5 * force);
        let change = (next - force).abs();
        force = next;
        if change <= INVERSE_TOLERANCE * force {
            break;
        }
    }
    force
}
