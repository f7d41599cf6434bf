//! Projected Gauss-Seidel sweeps: slow, but they come near a solution from any start.
//!
//! M. Jean, "The non-smooth contact dynamics method", Comput. Methods Appl. Mech. Eng. 177 (1999). A free hub is
//! a multiplier of its wanted force: within a sweep it gives way like a spring, after the sweep it moves by
//! what the spring carried too much (M.R. Hestenes, "Multiplier and gradient methods", J. Optim. Theory Appl. 4 (1969)).

use super::state::State;

/// Sweeps at most.
const LIMIT: usize = 2000;

/// Sweeps until forces and hub forces change by less than `tolerance` of the largest force, or [`LIMIT`] is
/// reached; a `relaxation` below 1 shortens every correction. Returns the number of sweeps.
pub(super) fn sweep(state: &mut State, tolerance: f64, relaxation: f64) -> usize {
    let count = sweeps(state, tolerance, relaxation);
    // anew from the forces, without the rounding that has added up
    state.update_separation();
    count
}

fn sweeps(state: &mut State, tolerance: f64, relaxation: f64) -> usize {
    let n = state.problem.points.len();
    let (compliance, friction) = (state.problem.compliance, state.problem.friction);
    let hub = state.problem.hub;
    let weights: Vec<Vec<f64>> = hub
        .iter()
        .map(|free| (0..state.forces.len()).map(|row| state.hub_weight(row, &free.along)).collect())
        .collect();
    // as compliant as a point, the hub neither stiffens the sweeps nor lags behind them
    let give = (0..n).map(|j| compliance.diagonal(j)).sum::<f64>() / n.max(1) as f64;
    let diagonal: Vec<f64> = (0..state.forces.len())
        .map(|row| compliance.diagonal(row) + give * weights.iter().map(|w| w[row] * w[row]).sum::<f64>())
        .collect();
    for count in 1..=LIMIT {
        let mut change = 0.0_f64;
        for j in 0..n {
            let wanted = (state.forces[j] - relaxation * state.separation[j] / diagonal[j]).max(0.0);
            change = change.max(apply(state, &weights, give, j, wanted));
            if state.directions == 3 {
                let (row1, row2) = (n + j, 2 * n + j);
                let softer = diagonal[row1].max(diagonal[row2]);
                let trial = |row: usize| state.forces[row] - relaxation * state.separation[row] / softer;
                let (x, y) = (trial(row1), trial(row2));
                let (limit, length) = (friction * wanted, x.hypot(y));
                let shrink = if length > limit { limit / length } else { 1.0 };
                change = change.max(apply(state, &weights, give, row1, shrink * x));
                change = change.max(apply(state, &weights, give, row2, shrink * y));
            }
        }
        for (h, weight) in weights.iter().enumerate() {
            let excess = state.carried(&hub[h].along) - hub[h].force;
            state.hub[h] += give * excess;
            state.separation.iter_mut().zip(weight).for_each(|(s, w)| *s += w * give * excess);
            change = change.max(excess.abs());
        }
        let size = state.forces.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        if !(change > tolerance * size) {
            return count;
        }
    }
    LIMIT
}

/// Gives a row the `wanted` force and moves the separations and the hub with it; returns the change, N.
fn apply(state: &mut State, weights: &[Vec<f64>], give: f64, row: usize, wanted: f64) -> f64 {
    let delta = wanted - state.forces[row];
    if delta == 0.0 {
        return 0.0;
    }
    state.forces[row] = wanted;
    state.problem.compliance.add_column(row, delta, &mut state.separation);
    for (h, weight) in weights.iter().enumerate() {
        let moved = give * weight[row] * delta;
        state.hub[h] += moved;
        state.separation.iter_mut().zip(weight).for_each(|(s, w)| *s += w * moved);
    }
    delta.abs()
}
