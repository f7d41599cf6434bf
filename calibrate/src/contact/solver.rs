//! Unilateral contact with Coulomb friction on a linear compliance.
//!
//! Unknown are the forces at the contact points and the free motions of the wheel's hub. A semismooth Newton
//! iteration finds them. Where the compliance comes as products, conjugate gradients give its start. Where
//! the iteration does not converge, other methods follow in this order, each a bounded number of times. First
//! conjugate gradients go on to the solution. Then friction is raised from the solution without friction.
//! Where the compliance is a matrix, projected Gauss-Seidel sweeps are last. With any method, the answer
//! satisfies the conditions of the problem as it is posed, to the same tolerance.

use super::conjugate_gradients::conjugate_gradients;
use super::dense::{DenseFactor, is_affordable};
use super::iterative::{Factors, Linearised};
use super::mirrored::Halves;
use super::newton::{Goal, TOLERANCE, newton, slip_rows};
use super::preconditioned::preconditioned;
use super::start::{ALL_THE_WAY, NEAR, NEARER, approach, suits};
use super::state::State;
use super::sweeps::sweep;
use faer::Mat;
use nalgebra::{DMatrix, Unit, Vector3};
use railspring_profiles::error::{Error, NumericsError, Result, StopReason};

pub use super::state::{FreeDirection, PointMode, Problem, Solution};

/// Steps of a Newton iteration at most.
const NEWTON_STEPS: usize = 60;
/// Where the iteration ends for an answer.
const EXACT: Goal = Goal { residual: TOLERANCE, steps: NEWTON_STEPS };
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
/// [`railspring_profiles::error::NumericsError`] with the residual (over the largest force) and the number of load-carrying
/// points if no way leads to a solution, or if a wanted hub force cannot be carried.
pub fn solve(problem: &Problem, start: &[f64]) -> Result<Solution> {
    solve_with(problem, start, &mut Factors::default())
}

/// As [`solve`], one of a sequence of problems of which each is little different from the one before: its `factors` serve the next.
pub fn solve_with(problem: &Problem, start: &[f64], factors: &mut Factors) -> Result<Solution> {
    solve_within(problem, start, EXACT, factors)
}

/// As [`solve_with`], to a `residual` over the largest force: for a problem of which the solution is no more than a start for the next.
pub fn solve_to(problem: &Problem, start: &[f64], residual: f64, factors: &mut Factors) -> Result<Solution> {
    solve_within(problem, start, Goal { residual, ..EXACT }, factors)
}

/// Steps at most of [`solve_held`] with the inverse of the half-spaces, and without it.
const HELD_STEPS: usize = 200;
const HELD_STEPS_WITHOUT: usize = 2000;

/// The forces of a `problem` without friction and with the hub held, by products alone from the forces `start`: for many points, of which
/// no more is wanted than their forces. It ends where a step of each point alone changes no force by more than the `tolerance` of the largest.
///
/// # Errors
/// [`railspring_profiles::error::NumericsError`] as [`solve`].
pub fn solve_held(problem: &Problem, start: &[f64], tolerance: f64) -> Result<Vec<f64>> {
    let Some(halves) = Halves::of(problem) else { return solve_whole_held(problem, start, tolerance) };
    let forces = solve_whole_held(&halves.problem(problem), &halves.carried(start), tolerance)?;
    Ok(halves.whole(&forces, true))
}

fn solve_whole_held(problem: &Problem, start: &[f64], tolerance: f64) -> Result<Vec<f64>> {
    let mut state = State::new(problem, start);
    let steps = match preconditioned(&mut state, tolerance, HELD_STEPS) {
        Some((steps, true)) => steps,
        _ => conjugate_gradients(&mut state, tolerance, HELD_STEPS_WITHOUT),
    };
    state.update_separation();
    let residual = state.residual().relative;
    // a number that is none is no small residual
    if residual < 10.0 * tolerance {
        return Ok(state.forces);
    }
    Err(unsolved(&state, residual, steps, StopReason::IterationLimit))
}

/// As [`solve_with`], by Newton iterations that end as the `goal` says; by halves where the problem is its own mirror image.
fn solve_within(problem: &Problem, start: &[f64], goal: Goal, factors: &mut Factors) -> Result<Solution> {
    let Some(halves) = Halves::of(problem) else { return solve_whole(problem, start, goal, factors) };
    solve_whole(&halves.problem(problem), &halves.carried(start), goal, factors)
        .map(|half| halves.solution(half))
}

fn solve_whole(problem: &Problem, start: &[f64], goal: Goal, factors: &mut Factors) -> Result<Solution> {
    let mut spent = 0;
    let mut state = State::new(problem, start);
    let by_products = suits(problem);
    if by_products {
        approach(&mut state, NEAR, &mut spent);
    }
    let near = by_products.then(|| state.clone());
    let Err(mut stopped) = newton(&mut state, goal, &mut spent, factors) else {
        return Ok(state.solution(spent));
    };
    if let Some(near) = near {
        for (mut state, effort) in [(near, NEARER), (State::new(problem, start), ALL_THE_WAY)] {
            approach(&mut state, effort, &mut spent);
            match newton(&mut state, goal, &mut spent, factors) {
                Ok(()) => return Ok(state.solution(spent)),
                Err(reason) => stopped = reason,
            }
        }
    }
    if let Some(solution) = raise_friction(problem, start, goal, &mut spent, factors) {
        return Ok(solution);
    }
    if by_products {
        let residual = state.residual().relative;
        return Err(unsolved(&state, residual, spent, stopped));
    }
    let mut swept = State::new(problem, start);
    for (tolerance, relaxation) in SWEEPS {
        spent += sweep(&mut swept, tolerance, relaxation);
        let mut state = swept.clone();
        match newton(&mut state, goal, &mut spent, factors) {
            Ok(()) => return Ok(state.solution(spent)),
            Err(reason) => stopped = reason,
        }
    }
    let residual = swept.residual().relative;
    Err(unsolved(&swept, residual, spent, stopped))
}

fn unsolved(state: &State, residual: f64, iteration: usize, reason: StopReason) -> Error {
    let active = state.modes().iter().filter(|m| **m != PointMode::Open).count();
    NumericsError::new("contact", reason, residual, active).after(iteration).into()
}

/// The solution without friction as a start, and friction raised from there as far as Newton's iteration follows:
/// a rise that fails is halved, the next one doubled. `None` if it does not arrive.
fn raise_friction(
    problem: &Problem,
    start: &[f64],
    goal: Goal,
    spent: &mut usize,
    factors: &mut Factors,
) -> Option<Solution> {
    if !(problem.friction > 0.0) || problem.free.len() == problem.points.len() {
        return None;
    }
    let n = problem.points.len();
    let mut normal = start.to_vec();
    normal[n..].fill(0.0);
    let smooth = Problem { friction: 0.0, ..*problem };
    let mut state = State::new(&smooth, &normal);
    if newton(&mut state, goal, spent, factors).is_err() {
        state = State::new(&smooth, &normal);
        if suits(&smooth) {
            approach(&mut state, ALL_THE_WAY, spent);
        } else {
            *spent += sweep(&mut state, SWEEPS[0].0, SWEEPS[0].1);
        }
        newton(&mut state, goal, spent, factors).ok()?;
    }
    let (mut forces, mut hub) = (state.forces, state.hub);
    let (mut reached, mut rise) = (0.0, 1.0);
    for _ in 0..FRICTION_LEVELS {
        let part = f64::min(reached + rise, 1.0);
        let level = Problem { friction: part * problem.friction, ..*problem };
        let mut state = State::new(&level, &forces);
        state.hub.copy_from_slice(&hub);
        state.update_separation();
        if newton(&mut state, goal, spent, factors).is_ok() {
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
const LINEAR: f64 = 1e-7;

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
    hub_response_with(problem, solution, directions, sticking, &mut Factors::default())
}

/// As [`hub_response`], with the `factors` of the solution.
pub fn hub_response_with(
    problem: &Problem,
    solution: &Solution,
    directions: &[Unit<Vector3<f64>>],
    sticking: bool,
    factors: &mut Factors,
) -> Option<HubResponse> {
    let weight = |row: usize, along: &Vector3<f64>| {
        problem.points[row % problem.points.len()].direction(row / problem.points.len()).dot(along)
    };
    let rates: Vec<Vec<f64>> = directions
        .iter()
        .map(|along| (0..problem.free.len()).map(|row| weight(row, along)).collect())
        .collect();
    let forces = response_to(problem, solution, &rates, sticking, factors)?;
    let k = directions.len();
    let stiffness = DMatrix::from_fn(k, k, |a, h| {
        -forces.col_as_slice(h).iter().zip(&rates[a]).map(|(force, weight)| force * weight).sum::<f64>()
    });
    Some(HubResponse { stiffness, forces })
}

/// Change of the contact forces (rows as in the compliance, a column for each motion) where motions change the separations by `rates` per unit; the
/// points as in [`hub_response`]. `None` if no point carries load.
pub fn response_to(
    problem: &Problem,
    solution: &Solution,
    rates: &[Vec<f64>],
    sticking: bool,
    factors: &mut Factors,
) -> Option<Mat<f64>> {
    // a hub that moves along the track, or turns, leaves the mirror image
    let mirrored = Halves::of(problem).filter(|halves| rates.iter().all(|rates| halves.are_of(rates)));
    let Some(halves) = mirrored else {
        return response_of_all(problem, solution, rates, sticking, factors);
    };
    let half = halves.problem(problem);
    let rates: Vec<Vec<f64>> = rates.iter().map(|rates| halves.half(rates)).collect();
    let forces = response_of_all(&half, &halves.half_of(solution), &rates, sticking, factors)?;
    let mut whole = Mat::zeros(problem.free.len(), rates.len());
    for c in 0..rates.len() {
        whole.col_as_slice_mut(c).copy_from_slice(&halves.whole(forces.col_as_slice(c), true));
    }
    Some(whole)
}

fn response_of_all(
    problem: &Problem,
    solution: &Solution,
    rates: &[Vec<f64>],
    sticking: bool,
    factors: &mut Factors,
) -> Option<Mat<f64>> {
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
    let m = rows.len();
    let linearised =
        Linearised { state: &state, modes: &modes, active: &active, rows: &rows, along: &[], hub_unit: 0.0 };
    let motions = || rates.iter().map(|rates| linearised.motion(|row| rates[row])).collect::<Vec<_>>();
    let response = linearised.solve(&motions(), LINEAR, LINEAR, factors);
    let response = response.or_else(|| {
        if !is_affordable(m, problem.has_products()) {
            return None;
        }
        let mut system = state.linearised(&rows, &[], 0);
        if state.directions == 3 {
            slip_rows(&state, &modes, &active, &mut system);
        }
        let factor = DenseFactor::new(system);
        let mut sides = motions();
        sides.iter_mut().for_each(|side| factor.solve(side));
        sides.iter().flatten().all(|value| value.is_finite()).then_some(sides)
    })?;
    let mut forces = Mat::zeros(problem.free.len(), rates.len());
    for (r, &row) in rows.iter().enumerate() {
        for (h, response) in response.iter().enumerate() {
            forces[(row, h)] = -response[r];
        }
    }
    Some(forces)
}

#[cfg(test)]
mod tests {
    use super::super::conjugate_gradients::conjugate_gradients;
    use super::super::{ContactPoint, HalfSpace, NearField, flat_grid, gaps};
    use super::*;
    use crate::analytic::hertz::point_contact;
    use crate::solid::Material;
    use nalgebra::{Vector2, Vector3};

    const LOAD: f64 = 30e3;
    const RADIUS: f64 = 0.3;
    /// SOLVER: residual of 1e-10 of the largest force by a step of each point alone; the forces of a patch of thirty cells answer a
    /// hundred times as much to what all its points have in common.
    const SOLVER: f64 = 1e-8;

    fn round_contact() -> Vec<ContactPoint> {
        // the mean of the gap over a hat of width h is h²/6 of its curvature above its middle, in both directions
        let h = 0.26e-3;
        flat_grid((39, 39), h, |s, x| (s * s + x * x + h * h / 3.0) / (2.0 * RADIUS))
    }

    fn pressed() -> [FreeDirection; 1] {
        [FreeDirection { along: Vector3::z_axis(), force: -LOAD }]
    }

    fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
        let size = b.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size
    }

    /// Source: Hertz (K.L. Johnson, Contact Mechanics, 1985, section 4.2); Newton's iteration. Goal:
    /// conjugate gradients come to the forces, N, and the approach, m, of a round contact from nothing, from
    /// a force on one point, and from a uniform one, with the hub free and held. They take fewer steps with
    /// the inverse of the half-spaces. Accuracy: SOLVER against Newton; DISCRETISATION of the approach on
    /// fifteen cells to the radius, 0.3 %.
    #[test]
    fn conjugate_gradients_are_newton_and_hertz() {
        const DISCRETISATION: f64 = 0.003;
        let points = round_contact();
        let n = points.len();
        let compliance = NearField::new(&HalfSpace::both(&Material::STEEL), &points, 1);
        let (free, hub) = (gaps(&points), pressed());
        let problem =
            Problem { points: &points, compliance: &compliance, free: &free, friction: 0.0, hub: &hub };
        let mut exact = State::new(&problem, &vec![0.0; n]);
        newton(&mut exact, EXACT, &mut 0, &mut Factors::default()).unwrap();
        let hertz =
            point_contact(LOAD, RADIUS, RADIUS, Material::STEEL.contact_modulus(&Material::STEEL)).unwrap();
        assert!((exact.hub[0] / hertz.approach - 1.0).abs() < DISCRETISATION, "{:?} {hertz:?}", exact.hub);
        let mut corner = vec![0.0; n];
        corner[0] = LOAD;
        for start in [vec![0.0; n], corner, vec![1.0; n]] {
            let mut state = State::new(&problem, &start);
            let steps_free = conjugate_gradients(&mut state, 1e-11, HELD_STEPS_WITHOUT);
            assert!(steps_free < 200, "{steps_free} steps");
            assert!(largest_difference(&state.forces, &exact.forces) < SOLVER, "{steps_free} steps");
            assert!((state.hub[0] / exact.hub[0] - 1.0).abs() < SOLVER);
            let carried: f64 = state.forces.iter().sum();
            assert!((carried / LOAD - 1.0).abs() < 1e-12);
            let lowered: Vec<f64> = free.iter().map(|gap| gap - exact.hub[0]).collect();
            let held = Problem { free: &lowered, hub: &[], ..problem };
            let mut state = State::new(&held, &start);
            let steps = conjugate_gradients(&mut state, 1e-11, HELD_STEPS_WITHOUT);
            assert!(largest_difference(&state.forces, &exact.forces) < SOLVER);
            for (problem, plain) in [(&held, steps), (&problem, steps_free)] {
                let mut state = State::new(problem, &start);
                let Some((fewer, true)) = preconditioned(&mut state, 1e-11, HELD_STEPS) else {
                    // nothing tells how much to press where nothing carries load
                    assert!(start.iter().all(|force| *force == 0.0) && !problem.hub.is_empty());
                    continue;
                };
                assert!(largest_difference(&state.forces, &exact.forces) < SOLVER);
                assert!(fewer < plain, "{fewer} {plain}");
                if !problem.hub.is_empty() {
                    assert!((state.hub[0] / exact.hub[0] - 1.0).abs() < SOLVER);
                }
            }
        }
    }

    /// Source: Newton's iteration on the same problem. Goal: two round contacts share the load of one hub. The second is farther away by half of the approach, and on a
    /// slope. Conjugate gradients with the inverse of the half-spaces come to the forces, N, and the way of the hub, m. The first carries everything at the
    /// start. Accuracy: SOLVER.
    #[test]
    fn two_regions_share_a_load() {
        let (h, radius, apart) = (0.3e-3, 0.05, 6e-3);
        let mut points = flat_grid((61, 25), h, |s, x| {
            let [one, other] = [s + apart, s - apart].map(|s| (s * s + x * x) / (2.0 * radius));
            one.min(other + 20e-6)
        });
        // the second region is turned by 0.5 rad, so that the hub's way closes less of its gaps
        let (sine, cosine) = 0.5_f64.sin_cos();
        let normal = points[0].normal;
        for point in points.iter_mut().filter(|point| point.position.x > 0.0) {
            point.normal =
                Vector2::new(cosine * normal.x - sine * normal.y, sine * normal.x + cosine * normal.y);
        }
        let n = points.len();
        let compliance = NearField::new(&HalfSpace::both(&Material::STEEL), &points, 1);
        let (free, hub) = (gaps(&points), pressed());
        let problem =
            Problem { points: &points, compliance: &compliance, free: &free, friction: 0.0, hub: &hub };
        let start: Vec<f64> = points.iter().map(|point| f64::from(point.position.x < 0.0)).collect();
        let mut exact = State::new(&problem, &vec![1.0; n]);
        newton(&mut exact, EXACT, &mut 0, &mut Factors::default()).unwrap();
        let of = |forces: &[f64], first: bool| -> f64 {
            points.iter().zip(forces).filter(|(p, _)| (p.position.x < 0.0) == first).map(|(_, f)| f).sum()
        };
        assert!(of(&exact.forces, true) > 0.1 * LOAD && of(&exact.forces, false) > 0.1 * LOAD);
        let mut state = State::new(&problem, &start);
        let (steps, settled) = preconditioned(&mut state, 1e-11, HELD_STEPS).unwrap();
        assert!(settled, "{steps} steps");
        assert!(largest_difference(&state.forces, &exact.forces) < SOLVER, "{steps} steps");
        assert!((state.hub[0] / exact.hub[0] - 1.0).abs() < SOLVER);
    }

    /// Source: the same problem with all steps of Newton's iteration. Goal: where that ends early, the products alone come to the
    /// forces, N, without friction and with it, in contact of which some points stick and some slide, and where all slide. Accuracy: SOLVER;
    /// the friction of a point that slides by a thousandth of what its bound would move it by alone turns with the direction of that
    /// small slip, by a thousand times the residual and some.
    #[test]
    fn the_way_by_products_is_taken_where_newton_ends_early() {
        const SLIDING: f64 = 1e-6;
        let points = round_contact();
        let n = points.len();
        let hub = pressed();
        for (directions, friction, slip) in [(1, 0.0, 0.0), (3, 0.3, 4e-6), (3, 0.3, 40e-6), (3, 0.0, 4e-6)] {
            let compliance = NearField::new(&HalfSpace::both(&Material::STEEL), &points, directions);
            let mut free = gaps(&points);
            free.resize(directions * n, 0.0);
            free.iter_mut().skip(n).take(n).for_each(|value| *value = slip);
            let problem =
                Problem { points: &points, compliance: &compliance, free: &free, friction, hub: &hub };
            let start = vec![0.0; directions * n];
            let exact = solve(&problem, &start).unwrap();
            let found =
                solve_within(&problem, &start, Goal { steps: 0, ..EXACT }, &mut Factors::default()).unwrap();
            let sliding = exact.modes.iter().filter(|mode| **mode == PointMode::Slip).count();
            println!("{directions} {friction} {slip}: {sliding} of {} slide", exact.active());
            let difference = largest_difference(&found.forces, &exact.forces);
            let tolerance = if friction > 0.0 { SLIDING } else { SOLVER };
            assert!(difference < tolerance, "{directions} {friction} {slip}: {difference}");
            assert!((found.hub[0] / exact.hub[0] - 1.0).abs() < SOLVER);
            assert_eq!(found.modes, exact.modes);
            // nothing but the products leads there
            let mut alone = State::new(&problem, &start);
            assert!(newton(&mut alone, Goal { steps: 0, ..EXACT }, &mut 0, &mut Factors::default()).is_err());
        }
    }
}
