//! Unilateral contact with Coulomb friction on a linear compliance.
//!
//! Unknown are the forces at the contact points and the free motions of the
//! wheel's hub. A semismooth Newton iteration finds them. Where it does not
//! settle from the start it is given, it gets better ones, in this order and a
//! bounded number of times: the solution without friction, with the friction
//! raised from there; then projected Gauss-Seidel sweeps. Whatever the way, the
//! answer satisfies the conditions of the problem as it is posed, to the same
//! tolerance.

use super::dense::DenseFactor;
use super::iterative::Linearised;
use super::newton::{newton, slip_rows};
use super::start::approach;
use super::state::State;
use super::sweeps::sweep;
use crate::error::{NumericsError, Result};
use faer::Mat;
use nalgebra::{DMatrix, Unit, Vector3};

pub use super::state::{FreeDirection, PointMode, Problem, Solution};

/// Levels of friction tried on the way from none to that of the problem.
const FRICTION_LEVELS: usize = 16;
/// Smallest rise of friction, of the whole.
const SMALLEST_RISE: f64 = 1.0 / 64.0;
/// Sweeps before each further Newton iteration: relative change at which they end, and their relaxation. After
/// the last of them the forces are exact enough to be the solution without another step.
const SWEEPS: [(f64, f64); 3] = [(1e-5, 1.0), (1e-8, 1.0), (1e-12, 0.5)];

/// Solves `problem` from the forces `start` (same layout; zero if nothing is known).
///
/// # Errors
/// [`crate::error::NumericsError`] with the residual (over the largest force) and the number of load-carrying
/// points if no way leads to a solution, or if a wanted hub force cannot be carried.
pub fn solve(problem: &Problem, start: &[f64]) -> Result<Solution> {
    let mut spent = 0;
    let mut state = State::new(problem, start);
    approach(&mut state, &mut spent);
    let Err(mut stopped) = newton(&mut state, &mut spent) else { return Ok(state.solution(spent)) };
    if let Some(solution) = raise_friction(problem, start, &mut spent) {
        return Ok(solution);
    }
    let mut swept = State::new(problem, start);
    for (tolerance, relaxation) in SWEEPS {
        spent += sweep(&mut swept, tolerance, relaxation);
        let mut state = swept.clone();
        match newton(&mut state, &mut spent) {
            Ok(()) => return Ok(state.solution(spent)),
            Err(reason) => stopped = reason,
        }
    }
    let active = swept.modes().iter().filter(|m| **m != PointMode::Open).count();
    let residual = swept.residual().relative;
    let stage = "contact".into();
    Err(NumericsError { stage, step: None, iteration: spent, residual, active, reason: stopped }.into())
}

/// The solution without friction as a start, and friction raised from there as far as Newton's iteration follows:
/// a rise that fails is halved, the next one doubled. `None` if it does not arrive.
fn raise_friction(problem: &Problem, start: &[f64], spent: &mut usize) -> Option<Solution> {
    if !(problem.friction > 0.0) || problem.free.len() == problem.points.len() {
        return None;
    }
    let n = problem.points.len();
    let mut normal = start.to_vec();
    normal[n..].fill(0.0);
    let smooth = Problem { friction: 0.0, ..*problem };
    let mut state = State::new(&smooth, &normal);
    if newton(&mut state, spent).is_err() {
        state = State::new(&smooth, &normal);
        *spent += sweep(&mut state, SWEEPS[0].0, SWEEPS[0].1);
        newton(&mut state, spent).ok()?;
    }
    let (mut forces, mut hub) = (state.forces, state.hub);
    let (mut reached, mut rise) = (0.0, 1.0);
    for _ in 0..FRICTION_LEVELS {
        let part = f64::min(reached + rise, 1.0);
        let level = Problem { friction: part * problem.friction, ..*problem };
        let mut state = State::new(&level, &forces);
        state.hub.copy_from_slice(&hub);
        if newton(&mut state, spent).is_ok() {
            if part == 1.0 {
                return Some(state.solution(*spent));
            }
            (forces, hub) = (state.forces, state.hub);
            reached = part;
            rise *= 2.0;
        } else {
            rise *= 0.5;
            if rise < SMALLEST_RISE {
                return None;
            }
        }
    }
    None
}

/// SOLVER: residual of the linearised contact over its right-hand side where it is solved by iteration.
const LINEAR: f64 = 1e-10;

/// How the contact answers small motions of the hub at a converged state.
pub struct HubResponse {
    /// Force the hub must apply against its displacement, by direction, N/m.
    pub stiffness: DMatrix<f64>,
    /// Change of the contact forces (rows as in the compliance) for a unit displacement along each direction, N/m.
    pub forces: Mat<f64>,
}

/// Linearises the contact at a converged state for hub motions along the world `directions`: all
/// load-carrying points move as their modes say; `sticking` holds the slipping ones too. No differences of load
/// steps are involved. `None` if no point carries load.
pub fn hub_response(
    problem: &Problem,
    solution: &Solution,
    directions: &[Unit<Vector3<f64>>],
    sticking: bool,
) -> Option<HubResponse> {
    let held = Problem { hub: &[], ..*problem };
    let mut state = State::new(&held, &solution.forces);
    state.separation.copy_from_slice(&solution.separation);
    let modes: Vec<PointMode> = solution
        .modes
        .iter()
        .map(|m| if sticking && *m == PointMode::Slip { PointMode::Stick } else { *m })
        .collect();
    let n = problem.points.len();
    let active: Vec<usize> = (0..n).filter(|&j| modes[j] != PointMode::Open).collect();
    let rows: Vec<usize> =
        (0..state.directions).flat_map(|d| active.iter().map(move |&j| d * n + j)).collect();
    let (m, k) = (rows.len(), directions.len());
    let along: Vec<Vector3<f64>> = directions.iter().map(|d| d.into_inner()).collect();
    let linearised =
        Linearised { state: &state, modes: &modes, active: &active, rows: &rows, along: &[], hub_unit: 0.0 };
    let response = linearised.solve(&linearised.motions(&along), LINEAR).or_else(|| {
        let mut system = state.linearised(&rows, &[], 0);
        if state.directions == 3 {
            slip_rows(&state, &modes, &active, &mut system);
        }
        let factor = DenseFactor::new(system);
        let mut sides = linearised.motions(&along);
        sides.iter_mut().for_each(|side| factor.solve(side));
        sides.iter().flatten().all(|value| value.is_finite()).then_some(sides)
    })?;
    let stiffness = DMatrix::from_fn(k, k, |a, h| {
        (0..m).map(|r| state.hub_weight(rows[r], &directions[a]) * response[h][r]).sum()
    });
    let mut forces = Mat::zeros(problem.free.len(), k);
    for (r, &row) in rows.iter().enumerate() {
        for h in 0..k {
            forces[(row, h)] = -response[h][r];
        }
    }
    Some(HubResponse { stiffness, forces })
}
