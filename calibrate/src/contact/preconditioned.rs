//! The normal problem with the hub held, for many points: conjugate gradients with the inverse of the half-spaces on an endless grid.
//!
//! E.A.H. Vollebregt, "A new solver for the elastic normal contact problem using conjugate gradients, deflation, and an FFT-based
//! preconditioner", J. Comput. Phys. 257 (2014). The steps are those of [`super::conjugate_gradients`], of which a fine grid takes several
//! hundred: points that carry load or overlap move together, and those that would pull are dropped after each step. As these points change,
//! the directions are those of Polak and Ribière, which forget what no longer holds.

use super::state::State;

/// Steps at most; what converges takes some tens.
const LIMIT: usize = 200;

/// Normal forces of a `state` with one direction a point and the hub held, whose separation is that of its forces, until a step of each point
/// alone changes no force by more than `tolerance` of the largest. Returns the number of steps; `None`, and the state as it was, where the compliance has no
/// such inverse or the iteration does not settle.
pub(super) fn preconditioned(state: &mut State, tolerance: f64) -> Option<usize> {
    let n = state.problem.points.len();
    let compliance = state.problem.compliance;
    let gaps_under = |forces: &[f64]| {
        let mut gaps = state.problem.free.to_vec();
        compliance.add_product(forces, &mut gaps);
        gaps
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut forces: Vec<f64> = state.forces.iter().map(|force| force.max(0.0)).collect();
    let mut gaps = gaps_under(&forces);
    let mut direction = vec![0.0; n];
    // residual of the points in contact in the step before, and its product with its nearly inverse
    let (mut before, mut square) = (vec![0.0; n], 0.0);
    for count in 0..=LIMIT {
        let largest = forces.iter().fold(0.0_f64, |m, f| m.max(*f));
        let change = |j: usize| forces[j] - (forces[j] - state.scale[j] * gaps[j]).max(0.0);
        if (0..n).all(|j| change(j).abs() <= tolerance * largest) {
            state.forces = forces;
            return Some(count);
        }
        let touches: Vec<bool> = (0..n).map(|j| forces[j] > 0.0 || gaps[j] < 0.0).collect();
        let within = |values: &mut [f64]| {
            values.iter_mut().zip(&touches).filter(|(_, touches)| !**touches).for_each(|(v, _)| *v = 0.0);
        };
        let mut residual = gaps.clone();
        within(&mut residual);
        let mut wanted = compliance.nearly_inverse(0, &residual)?;
        within(&mut wanted);
        let product = dot(&wanted, &residual);
        let turn = if square > 0.0 { ((product - dot(&wanted, &before)) / square).max(0.0) } else { 0.0 };
        direction.iter_mut().zip(&wanted).for_each(|(d, w)| *d = w + turn * *d);
        within(&mut direction);
        if !(dot(&direction, &residual) > 0.0) {
            direction.copy_from_slice(&wanted);
        }
        let mut motion = vec![0.0; n];
        compliance.add_product(&direction, &mut motion);
        let length = dot(&direction, &residual) / dot(&direction, &motion);
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        let mut dropped = false;
        for (force, d) in forces.iter_mut().zip(&direction) {
            *force -= length * d;
            if *force < 0.0 {
                (*force, dropped) = (0.0, true);
            }
        }
        if dropped {
            gaps = gaps_under(&forces);
        } else {
            gaps.iter_mut().zip(&motion).for_each(|(gap, m)| *gap -= length * m);
        }
        (before, square) = (residual, product);
    }
    None
}
