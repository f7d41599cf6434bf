//! The normal problem for many points: conjugate gradients with the inverse of the half-spaces on an endless grid.
//!
//! E.A.H. Vollebregt, "A new solver for the elastic normal contact problem using conjugate gradients, deflation, and an FFT-based
//! preconditioner", J. Comput. Phys. 257 (2014). The steps are those of [`super::conjugate_gradients`], of which a fine grid takes several
//! hundred, and thousands where two regions share the load: points that carry load or overlap move together, and those that would pull are dropped after each
//! step. As these points change, the directions are those of Polak and Ribière, which forget what no longer holds, and a step that
//! raises the energy is halved. Where the hub is free, it moves so that no direction changes its force.

use super::state::State;

/// Halvings of a step at most.
const SHORTENED: usize = 4;

/// Normal forces and hub of a `state` with one direction a point and at most one free direction of the hub, until a step of each point alone changes no force
/// by more than `tolerance` of the largest, `limit` steps at most. Returns the number of steps and whether they came to that; the separation is that of the
/// start. `None`, and the state as it was, where the compliance has no such inverse, nothing carries load, or a step leads nowhere.
pub(super) fn preconditioned(state: &mut State, tolerance: f64, limit: usize) -> Option<(usize, bool)> {
    let n = state.problem.points.len();
    let compliance = state.problem.compliance;
    let gaps_under = |forces: &[f64]| {
        let mut gaps = state.problem.free.to_vec();
        compliance.add_product(forces, &mut gaps);
        gaps
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let hub = state.problem.hub.first();
    let weights: Option<Vec<f64>> =
        hub.map(|free| (0..n).map(|row| state.hub_weight(row, &free.along)).collect());
    // scales forces to what the hub carries; whether there are such forces
    let scaled = |forces: &mut [f64]| {
        let (Some(weights), Some(free)) = (&weights, hub) else { return true };
        let factor = free.force / dot(weights, forces);
        forces.iter_mut().for_each(|force| *force *= factor);
        factor > 0.0 && factor.is_finite()
    };
    let mut forces: Vec<f64> = state.forces.iter().map(|force| force.max(0.0)).collect();
    if !scaled(&mut forces) {
        return None;
    }
    let mut gaps = gaps_under(&forces);
    let mut way = match &weights {
        // closes the gaps of the points that carry load in the mean
        Some(weights) => {
            let carrying = || (0..n).filter(|&j| forces[j] > 0.0);
            let sum = carrying().map(|j| weights[j] * gaps[j]).sum::<f64>();
            -sum / carrying().map(|j| weights[j] * weights[j]).sum::<f64>()
        }
        None => 0.0,
    };
    let mut direction = vec![0.0; n];
    // residual of the points in contact in the step before, and its product with its nearly inverse
    let (mut before, mut square) = (vec![0.0; n], 0.0);
    // the points in contact in the step before, and what the nearly inverse makes of a motion of the hub there
    let (mut touched, mut of_hub): (Vec<bool>, Vec<f64>) = (Vec::new(), Vec::new());
    for count in 0..=limit {
        let over = |way: f64| -> Vec<f64> {
            match &weights {
                Some(weights) => gaps.iter().zip(weights).map(|(gap, weight)| gap + weight * way).collect(),
                None => gaps.clone(),
            }
        };
        let mut residual = over(way);
        let touches: Vec<bool> = (0..n).map(|j| forces[j] > 0.0 || residual[j] < 0.0).collect();
        let within = |values: &mut [f64]| {
            values.iter_mut().zip(&touches).filter(|(_, touches)| !**touches).for_each(|(v, _)| *v = 0.0);
        };
        let inverse = |values: &[f64]| -> Option<Vec<f64>> {
            let mut values = values.to_vec();
            within(&mut values);
            let mut forces = compliance.nearly_inverse(0, &values)?;
            within(&mut forces);
            Some(forces)
        };
        let mut wanted = inverse(&residual)?;
        if let Some(weights) = &weights {
            if touched != touches {
                of_hub = inverse(weights)?;
                touched.clone_from(&touches);
            }
            let moved = dot(weights, &wanted) / dot(weights, &of_hub);
            way -= moved;
            residual = over(way);
            wanted.iter_mut().zip(&of_hub).for_each(|(w, hub)| *w -= moved * hub);
        }
        let largest = forces.iter().fold(0.0_f64, |m, f| m.max(*f));
        let change = |j: usize| forces[j] - (forces[j] - state.scale[j] * residual[j]).max(0.0);
        let settled = (0..n).all(|j| change(j).abs() <= tolerance * largest);
        if settled || count == limit {
            state.forces = forces;
            if weights.is_some() {
                state.hub[0] = way;
            }
            return Some((count, settled));
        }
        within(&mut residual);
        let product = dot(&wanted, &residual);
        let turn = if square > 0.0 { ((product - dot(&wanted, &before)) / square).max(0.0) } else { 0.0 };
        direction.iter_mut().zip(&wanted).for_each(|(d, w)| *d = w + turn * *d);
        within(&mut direction);
        if let Some(weights) = &weights {
            let moved = dot(weights, &direction) / dot(weights, &of_hub);
            direction.iter_mut().zip(&of_hub).for_each(|(d, hub)| *d -= moved * hub);
        }
        if !(dot(&direction, &residual) > 0.0) {
            direction.copy_from_slice(&wanted);
        }
        let mut motion = vec![0.0; n];
        compliance.add_product(&direction, &mut motion);
        let length = dot(&direction, &residual) / dot(&direction, &motion);
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        let trial = |length: f64| -> Option<(Vec<f64>, Vec<f64>, bool)> {
            let mut moved: Vec<f64> = forces.iter().zip(&direction).map(|(f, d)| f - length * d).collect();
            if moved.iter().all(|force| *force >= 0.0) {
                let gaps = gaps.iter().zip(&motion).map(|(gap, m)| gap - length * m).collect();
                return Some((moved, gaps, false));
            }
            moved.iter_mut().for_each(|force| *force = force.max(0.0));
            if !scaled(&mut moved) {
                return None;
            }
            let gaps = gaps_under(&moved);
            Some((moved, gaps, true))
        };
        // where points are dropped, the energy may rise: then the step was too long
        let energy =
            |forces: &[f64], gaps: &[f64]| 0.5 * (dot(forces, gaps) + dot(forces, state.problem.free));
        let stored = energy(&forces, &gaps);
        let (mut length, mut next) = (length, trial(length)?);
        let mut shortened = false;
        for _ in 0..SHORTENED {
            if !next.2 || energy(&next.0, &next.1) <= stored {
                break;
            }
            shortened = true;
            length *= 0.5;
            next = trial(length)?;
        }
        (forces, gaps) = (next.0, next.1);
        (before, square) = (residual, if shortened { 0.0 } else { product });
    }
    None
}
