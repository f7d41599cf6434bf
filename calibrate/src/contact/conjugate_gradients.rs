//! The normal problem by products alone: slower than Newton's iteration near the solution, but it comes there from any start, and
//! without a factor.
//!
//! I.A. Polonsky, L.M. Keer, "A numerical method for solving rough contact problems based on the multi-level
//! multi-summation and conjugate gradient techniques", Wear 231 (1999). The conjugate gradients act on the
//! points that carry load. After each step points that would pull are dropped, and points that overlap are
//! added. Scaling meets the force of the hub.

use super::state::State;

/// Normal forces and hub of a `state` with one direction a point and at most one free direction of the hub, until a step of each point
/// alone changes no force by more than `tolerance` of the largest, `limit` steps at most. Returns the number of steps; the separation is that of the start.
pub(super) fn conjugate_gradients(state: &mut State, tolerance: f64, limit: usize) -> usize {
    let n = state.problem.points.len();
    let wanted = state.problem.hub.first().map(|free| {
        let weights: Vec<f64> = (0..n).map(|row| state.hub_weight(row, &free.along)).collect();
        (weights, free.force)
    });
    let mut forces: Vec<f64> = state.forces.iter().map(|force| force.max(0.0)).collect();
    if let (Some((weights, force)), false) = (&wanted, forces.iter().any(|force| *force > 0.0)) {
        let square: f64 = weights.iter().map(|weight| weight * weight).sum();
        forces.iter_mut().zip(weights).for_each(|(f, weight)| *f = (weight * force / square).max(0.0));
    }
    scale_to(&wanted, &mut forces);
    let known = wanted.is_none() && forces == state.forces;
    let mut gaps = if known { state.separation.clone() } else { gaps_under(state, &forces) };
    let mut direction = vec![0.0; n];
    let (mut before, mut restart) = (0.0, true);
    let mut count = 0;
    let mut hub = hub_for(&wanted, &forces, &gaps);
    while count < limit {
        let residual: Vec<f64> = match &wanted {
            Some((weights, _)) => gaps.iter().zip(weights).map(|(gap, weight)| gap + weight * hub).collect(),
            None => gaps.clone(),
        };
        let largest = forces.iter().fold(0.0_f64, |m, f| m.max(*f));
        let change = |j: usize| forces[j] - (forces[j] - state.scale[j] * residual[j]).max(0.0);
        let far = (0..n).map(|j| change(j).abs()).fold(0.0, f64::max);
        if !(far > tolerance * largest) {
            break;
        }
        count += 1;
        let square: f64 = (0..n).filter(|&j| forces[j] > 0.0).map(|j| residual[j] * residual[j]).sum();
        let turn = if restart { 0.0 } else { square / before };
        for j in 0..n {
            direction[j] = if forces[j] > 0.0 { residual[j] + turn * direction[j] } else { 0.0 };
        }
        let mut motion = vec![0.0; n];
        state.problem.compliance.add_product(&direction, &mut motion);
        // along the direction the hub keeps its force
        let way = hub_for(&wanted, &forces, &motion);
        let weight = |j: usize| wanted.as_ref().map_or(0.0, |(weights, _)| weights[j]);
        let stored: f64 = (0..n).map(|j| direction[j] * (motion[j] + way * weight(j))).sum();
        let slope: f64 = (0..n).map(|j| direction[j] * residual[j]).sum();
        // where nothing carries load, each point by its own stiffness
        let length = if stored > 0.0 { slope / stored } else { state.scale.iter().sum::<f64>() / n as f64 };
        let mut changed = false;
        restart = !(slope > 0.0);
        for j in 0..n {
            if forces[j] > 0.0 {
                forces[j] -= length * direction[j];
                if forces[j] < 0.0 {
                    forces[j] = 0.0;
                    changed = true;
                }
            }
        }
        for j in 0..n {
            if forces[j] == 0.0 && residual[j] < 0.0 {
                forces[j] = -length.abs() * residual[j];
                (changed, restart) = (true, true);
            }
        }
        changed |= scale_to(&wanted, &mut forces);
        if changed {
            gaps = gaps_under(state, &forces);
        } else {
            gaps.iter_mut().zip(&motion).for_each(|(gap, m)| *gap -= length * m);
        }
        before = square;
        hub = hub_for(&wanted, &forces, &gaps);
    }
    state.forces = forces;
    if wanted.is_some() {
        state.hub[0] = hub;
    }
    count
}

/// Gaps under forces, the hub at rest, m.
fn gaps_under(state: &State, forces: &[f64]) -> Vec<f64> {
    let mut gaps = state.problem.free.to_vec();
    state.problem.compliance.add_product(forces, &mut gaps);
    gaps
}

/// Motion of the hub, m, with which the points that carry load close their `gaps` in the mean.
fn hub_for(wanted: &Option<(Vec<f64>, f64)>, forces: &[f64], gaps: &[f64]) -> f64 {
    let Some((weights, _)) = wanted else { return 0.0 };
    let (mut sum, mut square) = (0.0, 0.0);
    for ((weight, gap), _) in weights.iter().zip(gaps).zip(forces).filter(|(_, force)| **force > 0.0) {
        sum += weight * gap;
        square += weight * weight;
    }
    if square > 0.0 { -sum / square } else { 0.0 }
}

/// Scales forces so that the hub carries what is wanted; whether they changed.
fn scale_to(wanted: &Option<(Vec<f64>, f64)>, forces: &mut [f64]) -> bool {
    /// Of the sum of some thousand forces.
    const ROUNDOFF: f64 = 1e-14;
    let Some((weights, force)) = wanted else { return false };
    let carried: f64 = weights.iter().zip(forces.iter()).map(|(weight, f)| weight * f).sum();
    let factor = force / carried;
    let changes = factor > 0.0 && factor.is_finite() && (factor - 1.0).abs() > ROUNDOFF;
    if changes {
        forces.iter_mut().for_each(|f| *f *= factor);
    }
    changes
}
