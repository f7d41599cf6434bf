//! Semismooth Newton iteration on the projections of Signorini and Coulomb.
//!
//! P. Alart, A. Curnier, "A mixed formulation for frictional contact problems prone to Newton like solution
//! methods", Comput. Methods Appl. Mech. Eng. 92 (1991). There are two safeguards. A point that slips to and
//! fro sticks in between. After [`PLAIN`] steps a line search on the residual shortens the steps. Its memory
//! is that of L. Grippo, F. Lampariello, S. Lucidi, "A nonmonotone line search technique for Newton's
//! method", SIAM J. Numer. Anal. 23 (1986).

use super::dense::{DenseFactor, is_affordable};
use super::iterative::{Cone, Factors, Linearised};
use super::state::{PointMode, Residual, State};
use faer::Mat;
use nalgebra::Vector3;
use railspring_profiles::error::StopReason;
use std::collections::VecDeque;

/// Steps of full length before steps are shortened; what converges at all mostly needs fewer than ten.
const PLAIN: usize = 20;
/// Shortest step of the line search.
const SHORTEST: f64 = 1.0 / 64.0;
/// Residuals that the line search remembers.
const MEMORY: usize = 4;
/// SOLVER: residual of a solution over the largest force.
pub const TOLERANCE: f64 = 1e-10;
/// Part of the residual to which the equations of a step are solved where that is done by iteration (R.S. Dembo, S.C. Eisenstat,
/// T. Steihaug, "Inexact Newton methods", SIAM J. Numer. Anal. 19 (1982)), as long as the points change their modes: then the residual of
/// the step is that of these.
const FORCING_TERM: f64 = 1e-2;
/// The same that is accepted where the iteration is at its end.
const ACCEPTED_FORCING_TERM: f64 = 0.1;
/// Residual over the largest force from which on the modes mostly stay as they are.
const ACTIVE_SET_SETTLED: f64 = 1e-5;
/// ROUNDOFF: where forces are tiny beside gap times stiffness, rounding may leave as much of them; a hub that
/// runs away would otherwise pass for rounding.
const COARSEST: f64 = 1e-8;

/// When an iteration ends.
#[derive(Clone, Copy)]
pub(super) struct Goal {
    /// SOLVER: residual over the largest force.
    pub residual: f64,
    /// Steps at most.
    pub steps: usize,
}

/// Iterates until the conditions of contact hold, `limit` steps at most, and adds the steps to `spent`. The separation of the `state` is that
/// of its forces. The `factors` are of problems before, and for those that follow.
///
/// # Errors
/// Why the iteration stopped without an answer.
pub(super) fn newton(
    state: &mut State,
    Goal { residual: wanted, steps: limit }: Goal,
    spent: &mut usize,
    factors: &mut Factors,
) -> Result<(), StopReason> {
    let mut previous: Vec<PointMode> = Vec::new();
    let mut remembered = VecDeque::new();
    let mut residual = state.residual();
    for iteration in 0..=limit {
        if residual.relative <= wanted.max(residual.roundoff.min(COARSEST)) {
            return Ok(());
        }
        if !residual.relative.is_finite() {
            return Err(StopReason::NotFinite);
        }
        if iteration == limit {
            break;
        }
        *spent += 1;
        let mut modes = state.modes();
        stick_between_slips(state, &previous, &mut modes);
        // near the solution, or with the modes of the step before, the step may be the last
        let last = f64::min(FORCING_TERM, 0.1 * wanted / residual.relative);
        let is_settled = residual.relative < ACTIVE_SET_SETTLED || modes == previous;
        let tolerance = if is_settled { last } else { FORCING_TERM };
        let step = direction(state, &modes, tolerance, factors).ok_or(StopReason::Singular)?;
        remembered.push_back(residual.squared());
        if remembered.len() > MEMORY {
            remembered.pop_front();
        }
        if iteration < PLAIN {
            advance(state, &step, 1.0);
            residual = state.residual();
        } else {
            let bound = remembered.iter().copied().fold(0.0, f64::max);
            residual = search(state, &step, bound);
        }
        previous = modes;
    }
    Err(StopReason::IterationLimit)
}

/// A point that slipped one way and would now slip the other way has passed through sticking: full steps would
/// throw it to and fro between the two sides of its friction cone.
fn stick_between_slips(state: &State, previous: &[PointMode], modes: &mut [PointMode]) {
    let n = modes.len();
    for j in 0..previous.len() {
        if previous[j] == PointMode::Slip && modes[j] == PointMode::Slip && state.problem.friction > 0.0 {
            let (_, trial) = state.trial(j);
            if trial.x * state.forces[n + j] + trial.y * state.forces[2 * n + j] < 0.0 {
                modes[j] = PointMode::Stick;
            }
        }
    }
}

/// Change of forces and hub.
struct Step {
    forces: Vec<f64>,
    hub: Vec<f64>,
}

fn advance(state: &mut State, step: &Step, length: f64) {
    let add = |values: &mut [f64], change: &[f64]| {
        values.iter_mut().zip(change).for_each(|(v, c)| *v += length * c);
    };
    add(&mut state.forces, &step.forces);
    add(&mut state.hub, &step.hub);
    // anew from the forces, so that rounding does not add up
    state.update_separation();
}

/// Halves the step until the residual falls below `bound`; takes the best of them if none does.
fn search(state: &mut State, step: &Step, bound: f64) -> Residual {
    /// Part of the decrease of the linearised residual that is asked for.
    const DECREASE: f64 = 1e-4;
    let at = |length: f64| {
        let mut moved = state.clone();
        advance(&mut moved, step, length);
        let residual = moved.residual();
        (moved, residual)
    };
    let mut length = 1.0;
    let mut best = at(length);
    while best.1.squared() > (1.0 - DECREASE * length) * bound && length > SHORTEST {
        length *= 0.5;
        let next = at(length);
        if !(next.1.squared() >= best.1.squared()) {
            best = next;
        }
    }
    *state = best.0;
    best.1
}

/// The Newton step with every point in its mode; open points lose their force. An iteration solves its equations to `tolerance`, with
/// the `factors` of steps before where they serve.
fn direction(state: &State, modes: &[PointMode], tolerance: f64, factors: &mut Factors) -> Option<Step> {
    let problem = state.problem;
    let n = problem.points.len();
    let active: Vec<usize> = (0..n).filter(|&j| modes[j] != PointMode::Open).collect();
    let rows: Vec<usize> =
        (0..state.directions).flat_map(|d| active.iter().map(move |&j| d * n + j)).collect();
    let (m, k) = (rows.len(), state.hub.len());
    if m == 0 && k > 0 {
        return None;
    }
    let mut forces = vec![0.0; state.forces.len()];
    for j in (0..n).filter(|&j| modes[j] == PointMode::Open) {
        (0..state.directions).for_each(|d| forces[d * n + j] = -state.forces[d * n + j]);
    }
    if m == 0 {
        // the surfaces part: nothing to solve
        return Some(Step { forces, hub: Vec::new() });
    }
    // what the separations change by as the open points lose their forces
    let lost = if forces.iter().any(|force| *force != 0.0) {
        state.motion(&forces, &vec![0.0; k])
    } else {
        vec![0.0; forces.len()]
    };
    // gap (and slip while sticking) closes; in newtons, so that all rows have one scale
    let mut rhs = vec![0.0; m + k];
    for (r, &row) in rows.iter().enumerate() {
        rhs[r] = -state.scale[row] * (state.separation[row] + lost[row]);
    }
    for (h, free) in problem.hub.iter().enumerate() {
        rhs[m + h] = free.force
            - rows.iter().map(|&row| state.hub_weight(row, &free.along) * state.forces[row]).sum::<f64>();
    }
    if state.directions == 3 {
        for (local, &j) in active.iter().enumerate().filter(|(_, j)| modes[**j] == PointMode::Slip) {
            let cone = Cone::new(state, j);
            rhs[active.len() + local] = cone.limit * cone.unit.x - state.forces[n + j];
            rhs[2 * active.len() + local] = cone.limit * cone.unit.y - state.forces[2 * n + j];
        }
    }
    // the hub's displacement in the columns is multiplied by this, m/N, to keep the matrix well scaled
    let hub_unit = m as f64 / rows.iter().map(|&row| state.scale[row]).sum::<f64>();
    let along: Vec<Vector3<f64>> = problem.hub.iter().map(|free| free.along.into_inner()).collect();
    let linearised = Linearised { state, modes, active: &active, rows: &rows, along: &along, hub_unit };
    let change = match linearised.solve(std::slice::from_ref(&rhs), tolerance, ACCEPTED_FORCING_TERM, factors)
    {
        Some(mut solutions) => solutions.remove(0),
        None if !is_affordable(m, problem.has_products()) => return None,
        None => {
            let mut matrix = state.linearised(&rows, &along, k);
            for (h, free) in along.iter().enumerate() {
                matrix.col_as_slice_mut(m + h).iter_mut().for_each(|value| *value *= hub_unit);
                (0..m).for_each(|c| matrix[(m + h, c)] = state.hub_weight(rows[c], free));
            }
            if state.directions == 3 {
                slip_rows(state, modes, &active, &mut matrix);
            }
            DenseFactor::new(matrix).solve(&mut rhs);
            rhs.iter().all(|value| value.is_finite()).then_some(rhs)?
        }
    };
    for (r, &row) in rows.iter().enumerate() {
        forces[row] = change[r];
    }
    let hub: Vec<f64> = (0..k).map(|h| change[m + h] * hub_unit).collect();
    Some(Step { forces, hub })
}

/// Replaces the tangential rows of slipping points, which hold the scaled change of their slip, by the linearised
/// cone condition `τ = μ·p·v/|v|`, `v = τ - scale·slip`. `active` are the points of the rows, in their order.
pub(super) fn slip_rows(state: &State, modes: &[PointMode], active: &[usize], matrix: &mut Mat<f64>) {
    let a = active.len();
    for (local, &j) in active.iter().enumerate().filter(|(_, j)| modes[**j] == PointMode::Slip) {
        let cone = Cone::new(state, j);
        let (row1, row2) = (a + local, 2 * a + local);
        for c in 0..matrix.ncols() {
            // these rows hold scale·d(slip); v changes by -d(slip)·scale and +dτ
            let (s1, s2) = cone.across(matrix[(row1, c)], matrix[(row2, c)]);
            matrix[(row1, c)] = s1;
            matrix[(row2, c)] = s2;
        }
        let (e11, e21) = cone.across(1.0, 0.0);
        let (e12, e22) = cone.across(0.0, 1.0);
        matrix[(row1, row1)] += 1.0 - e11;
        matrix[(row2, row1)] -= e21;
        matrix[(row1, row2)] -= e12;
        matrix[(row2, row2)] += 1.0 - e22;
        matrix[(row1, local)] -= cone.friction * cone.unit.x;
        matrix[(row2, local)] -= cone.friction * cone.unit.y;
    }
}
