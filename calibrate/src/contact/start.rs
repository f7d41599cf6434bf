//! Where Newton's iteration starts: first the normal conditions alone, then friction within the bounds that the normal forces give it.
//!
//! Both are convex, settle from anywhere, and see little of each other (nothing on half-spaces of one material), as in P.D.
//! Panagiotopoulos, "A nonlinear programming approach to the unilateral contact- and friction-boundary value problem in the theory of
//! elasticity", Ingenieur-Archiv 44 (1975). What they come to is near the solution of the coupled problem and no more: the
//! residual of that decides.

use super::conjugate_gradients::conjugate_gradients;
use super::preconditioned::preconditioned;
use super::state::{FreeDirection, Problem, State};

/// How near to the solution, and by how much work.
#[derive(Clone, Copy)]
pub(super) struct Effort {
    /// SOLVER: change of a force by a step of its point alone, over the largest force.
    pub tolerance: f64,
    /// Rounds at most of the normal conditions and friction in turn.
    pub rounds: usize,
    /// Steps at most with the inverse of the half-spaces.
    pub with_inverse: usize,
    /// Steps at most without it.
    pub without: usize,
    /// Whether the steps without it follow where those with it do not settle.
    pub goes_on: bool,
    /// Products at most for the friction of a round.
    pub products: usize,
}

/// So near that the points that carry load, and those that slide, are the right ones but for a few. Where sliding bodies roll under
/// friction, or two regions share the load, more of it takes longer than the steps of Newton's iteration that it saves.
pub(super) const NEAR: Effort =
    Effort { tolerance: 5e-4, rounds: 2, with_inverse: 25, without: 200, goes_on: false, products: 20 };

/// As near where Newton's iteration does not settle from there: a region that has just come into contact overlaps by tenths of a millimetre, and more steps than those
/// bring its points to their share of the load.
pub(super) const NEARER: Effort =
    Effort { rounds: 10, with_inverse: 200, without: 500, goes_on: true, products: 50, ..NEAR };

/// The solution.
pub(super) const ALL_THE_WAY: Effort =
    Effort { tolerance: 5e-11, rounds: 60, with_inverse: 200, without: 2000, goes_on: true, products: 1000 };

/// Whether these are the problems that products alone solve: the hub is free in one direction or held.
pub(super) fn suits(problem: &Problem) -> bool {
    problem.hub.len() <= 1 && problem.has_products()
}

/// Gives a `state` the normal forces that its tangential ones ask for, these the friction that goes with them, and so on until it
/// is near the solution. Adds the steps to `spent`.
pub(super) fn approach(state: &mut State, effort: Effort, spent: &mut usize) {
    for _ in 0..effort.rounds {
        if !(state.residual().relative > effort.tolerance) {
            return;
        }
        *spent += press(state, effort);
        if state.directions == 3 && state.problem.friction > 0.0 {
            rub(state, effort);
        }
        state.update_separation();
    }
}

/// The normal forces and the hub with the tangential forces as they are; returns the number of steps.
fn press(state: &mut State, effort: Effort) -> usize {
    if state.directions == 1 {
        return normal_forces(state, effort);
    }
    let problem = state.problem;
    let n = problem.points.len();
    let Some(compliance) = problem.compliance.normal() else { return 0 };
    // the gaps less what the normal forces and the hub move
    let mut moved = vec![0.0; n];
    compliance.add_product(&state.forces[..n], &mut moved);
    moved.iter_mut().enumerate().for_each(|(row, m)| *m += state.moved_by_hub(row, &state.hub));
    let free: Vec<f64> = state.separation[..n].iter().zip(moved).map(|(gap, moved)| gap - moved).collect();
    let rest = |free: &FreeDirection| {
        let carried: f64 = (n..3 * n).map(|row| state.hub_weight(row, &free.along) * state.forces[row]).sum();
        FreeDirection { force: free.force - carried, ..*free }
    };
    let hub: Vec<FreeDirection> = problem.hub.iter().map(rest).collect();
    let normal =
        Problem { points: problem.points, compliance: &*compliance, free: &free, friction: 0.0, hub: &hub };
    let start = &state.forces[..n];
    let mut pressed = if normal.hub.is_empty() {
        State::with_separation(&normal, start, state.separation[..n].to_vec())
    } else {
        State::new(&normal, start)
    };
    let steps = normal_forces(&mut pressed, effort);
    state.forces[..n].copy_from_slice(&pressed.forces);
    state.hub.copy_from_slice(&pressed.hub);
    steps
}

/// The normal forces and the hub of a `state` with one direction a point; returns the number of steps.
fn normal_forces(state: &mut State, effort: Effort) -> usize {
    let Effort { tolerance, with_inverse, without, goes_on, .. } = effort;
    match preconditioned(state, tolerance, with_inverse) {
        None => conjugate_gradients(state, tolerance, without),
        Some((steps, settled)) if settled || !goes_on => steps,
        Some((steps, _)) => steps + conjugate_gradients(state, tolerance, without),
    }
}

/// The friction of the normal forces as they are, the hub held: the forces within the cones whose energy is least, by projected
/// gradients with the steps of J. Barzilai, J.M. Borwein, IMA J. Numer. Anal. 8 (1988), exact along each direction (E.G. Birgin,
/// J.M. Martínez, M. Raydan, SIAM J. Optim. 10 (2000)).
fn rub(state: &mut State, effort: Effort) {
    let n = state.problem.points.len();
    let active: Vec<usize> = (0..n).filter(|&j| state.forces[j] > 0.0).collect();
    for j in 0..n {
        if !(state.forces[j] > 0.0) {
            (state.forces[n + j], state.forces[2 * n + j]) = (0.0, 0.0);
        }
    }
    let Some(compliance) = state.problem.compliance.among(&active) else { return };
    let a = active.len();
    let bounds: Vec<f64> = active.iter().map(|&j| state.problem.friction * state.forces[j]).collect();
    let within = |x: &mut Vec<f64>| {
        for (local, bound) in bounds.iter().enumerate() {
            let length = x[local].hypot(x[a + local]);
            if length > *bound {
                x[local] *= bound / length;
                x[a + local] *= bound / length;
            }
        }
    };
    let row = |r: usize| (1 + r / a) * n + active[r % a];
    let mut forces: Vec<f64> = (0..2 * a).map(|r| state.forces[row(r)]).collect();
    within(&mut forces);
    // of the points that carry load, which are all that do
    let carried: Vec<f64> = active.iter().map(|&j| state.forces[j]).chain(forces.iter().copied()).collect();
    let mut moved = vec![0.0; 3 * a];
    compliance.add_product(&carried, &mut moved);
    let slip_of =
        |r: usize| moved[a + r] + state.moved_by_hub(row(r), &state.hub) + state.problem.free[row(r)];
    let mut slip: Vec<f64> = (0..2 * a).map(slip_of).collect();
    let scale: Vec<f64> = (0..2 * a).map(|r| state.scale[row(r)]).collect();
    let largest = bounds.iter().fold(0.0_f64, |m, b| m.max(*b));
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    // in units of the step of a point alone
    let mut length = 1.0;
    for product in 0..effort.products {
        let step = |length: f64| {
            let mut moved: Vec<f64> = (0..2 * a).map(|r| forces[r] - length * scale[r] * slip[r]).collect();
            within(&mut moved);
            moved.iter_mut().zip(&forces).for_each(|(m, f)| *m -= f);
            moved
        };
        let change = step(1.0).iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        if !(change > effort.tolerance * largest) {
            break;
        }
        let direction = step(length);
        let mut all = vec![0.0; 3 * a];
        all[a..].copy_from_slice(&direction);
        let mut motion = vec![0.0; 3 * a];
        compliance.add_product(&all, &mut motion);
        let motion = &motion[a..];
        let stored = dot(&direction, motion);
        if !(stored > 0.0) {
            break;
        }
        let part = (-dot(&slip, &direction) / stored).clamp(0.0, 1.0);
        forces.iter_mut().zip(&direction).for_each(|(f, d)| *f += part * d);
        slip.iter_mut().zip(motion).for_each(|(s, m)| *s += part * m);
        // the inverse of the curvature along the direction, from below and from above in turn
        let scaled: f64 = direction.iter().zip(&scale).map(|(d, s)| d * d / s).sum();
        length = if product % 2 == 0 {
            scaled / stored
        } else {
            stored / motion.iter().zip(&scale).map(|(m, s)| m * m * s).sum::<f64>()
        };
    }
    (0..2 * a).for_each(|r| state.forces[row(r)] = forces[r]);
}
