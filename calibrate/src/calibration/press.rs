//! The wheel pressed on the rail: static equilibrium under a wanted load.

use super::candidates::{Candidates, FinePlan};
use super::grid::touches_border;
use super::pressed::{Answer, Elasticity, Pressed, WheelOnRail, edge_reached};
use crate::contact::{
    ContactPoint, Factors, FreeDirection, Problem, Solution, TOLERANCE, gaps, response_to, solve_to,
};
use nalgebra::Vector2;
use railspring_profiles::error::{Error, InputError, NumericsError, Result, StopReason};
use railspring_profiles::field::InputField;
use std::sync::OnceLock;

/// The hub is found when pairing it again moves it by less, m: between elements, whose nodes slide past each other.
const HUB_TOLERANCE: f64 = 1e-10;
/// The same on a fine grid, whose gaps follow the hub along the normals of the rail. Across a patch those of the wheel differ from
/// them by a tenth of a radian at most, so that pairing again would move the hub by less than [`HUB_TOLERANCE`].
const FINE_HUB_TOLERANCE: f64 = 1e-9;
/// Largest way of the hub, m, after which it may turn out that the gaps are as they were: they are curved over the radii of profiles.
const SHORT_WAY: f64 = 2e-6;
/// SOLVER: residual over the largest force of the solution before the points are paired again. It places the hub to 1e-10 m, within
/// [`FINE_HUB_TOLERANCE`].
const UNPAIRED: f64 = 1e-6;
/// The same where nothing is known before: the solution shows which grid the patch needs.
const UNGRIDDED: f64 = 1e-3;
const PAIRING_LIMIT: usize = 40;
/// Smallest factor on the step of the hub where pairings make it oscillate, and largest where they creep.
const LEAST_SHARE: f64 = 1.0 / 16.0;
const LARGEST_SHARE: f64 = 2.0;
/// Largest ratio of a load to the one before from which the iteration starts near enough. On a flange at 7 mm the way from 10 to 120 kN takes products for 26 s
/// with a ratio of 4 or more, and 0.3 s by steps of 2.5 at most, as the calibrations' own loads are apart.
const NEAR_LOADS: f64 = 2.5;
/// Intermediate loads tried, and the least step between them, of the whole.
const LOAD_LEVELS: usize = 12;
const LEAST_RISE: f64 = 1.0 / 32.0;
/// How far against the load the iteration may place a hub, m: by the gaps that pairing changes. Elastic bodies give way to a load.
const AGAINST_THE_LOAD: f64 = 1e-4;
/// Step of the hub over which the change of the gaps is taken, m: they are curved over the radii of profiles, and exact to 1e-15 m.
const GAP_STEP: f64 = 1e-7;
/// Parts of the hub's way within which points may come to carry load, where the load changes by a quarter ([`super::rim`]).
const REACHED: f64 = 0.5;

impl WheelOnRail<'_> {
    /// Presses the wheel with the `load` (N, > 0) along its direction, the hub held across it; `before` is the state
    /// the load grew from, for friction and as a start. Where the iteration does not settle from there, it
    /// gets starts from loads in between; slips count from `before` all the same.
    ///
    /// # Errors
    /// [`InputError`] for a load that is not positive; [`NumericsError`] if the contact reaches the end of the meshed
    /// contact zone ([`StopReason::EdgeOfCandidates`] on a profile, [`StopReason::EndOfWindow`] along the track),
    /// or if the iteration does not settle.
    pub fn press(&self, load: f64, before: Option<&Pressed>) -> Result<Pressed> {
        if !(load > 0.0 && load.is_finite()) {
            return InputError::refuse(
                InputField::Loads,
                format!("{:.4} kN", load * 1e-3),
                "a positive load",
                "leave it out, or correct it",
            );
        }
        self.field.check(self.enforcement)?;
        let mut error = match self.settle(load, before, before) {
            Err(error) if unsettled(&error) => error,
            done => return done,
        };
        let floor = before.map_or(0.0, |b| b.load);
        let mut near: Option<Pressed> = None;
        let (mut reached, mut rise) = (0.0, 0.5);
        for _ in 0..LOAD_LEVELS {
            let part = f64::min(reached + rise, 1.0);
            let level = if part == 1.0 { load } else { floor + part * (load - floor) };
            match self.settle(level, before, near.as_ref().or(before)) {
                Ok(state) if part == 1.0 => return Ok(state),
                Ok(state) => {
                    near = Some(state);
                    reached = part;
                    rise *= 2.0;
                }
                Err(failed) if unsettled(&failed) => {
                    rise *= 0.5;
                    if rise < LEAST_RISE {
                        break;
                    }
                }
                Err(failed) => {
                    // at a smaller load the patch is inside its zone; what is wrong is reported for the wanted load
                    error = failed;
                    break;
                }
            }
        }
        Err(error)
    }

    /// As [`Self::press`], by way of loads in between where `before` is far away. They only give starts: slips count from `before`.
    ///
    /// # Errors
    /// Those of [`Self::press`].
    pub fn press_from_afar(&self, load: f64, before: Option<&Pressed>) -> Result<Pressed> {
        let near = before.and_then(|before| self.near(load, before));
        self.press_from(load, before, near.as_ref())
    }

    /// As [`Self::press`], iterated from the state `near` if there is one.
    ///
    /// # Errors
    /// Those of [`Self::press`].
    pub(super) fn press_from(
        &self,
        load: f64,
        before: Option<&Pressed>,
        near: Option<&Pressed>,
    ) -> Result<Pressed> {
        match near.filter(|_| load > 0.0).map(|near| self.settle(load, before, Some(near))) {
            None => self.press(load, before),
            Some(Err(error)) if unsettled(&error) => self.press(load, before),
            Some(done) => done,
        }
    }

    /// Presses a wheel without friction, iterated from the state `near` of another pair under the same load, whose bodies are the same; `of_this` is a
    /// state of this pair under another load, whose far field serves again.
    ///
    /// # Errors
    /// Those of [`Self::press`].
    pub(crate) fn press_beside(
        &self,
        load: f64,
        near: &Pressed,
        of_this: Option<&Pressed>,
    ) -> Result<Pressed> {
        match self.settle_by(load, None, Some(near), FinePlan::beside(of_this)) {
            Err(error) if unsettled(&error) => self.press(load, None),
            done => done,
        }
    }

    /// A state under a smaller load, near to `load`; none where `before` is near itself, or where there is no such state.
    fn near(&self, load: f64, before: &Pressed) -> Option<Pressed> {
        let times = load / before.load;
        let steps = (times.ln() / NEAR_LOADS.ln()).ceil() as i32;
        let mut near: Option<Pressed> = None;
        for step in 1..steps {
            let part = before.load * times.powf(f64::from(step) / f64::from(steps));
            near = Some(self.settle(part, Some(before), near.as_ref().or(Some(before))).ok()?);
        }
        near
    }

    /// Equilibrium under `load`, iterated from the state `near`; slips count from `before`.
    fn settle(&self, load: f64, before: Option<&Pressed>, near: Option<&Pressed>) -> Result<Pressed> {
        self.settle_by(load, before, near, FinePlan::default())
    }

    /// The same by a `plan` of the fine grid.
    fn settle_by(
        &self,
        load: f64,
        before: Option<&Pressed>,
        near: Option<&Pressed>,
        mut plan: FinePlan<'_>,
    ) -> Result<Pressed> {
        let failure = |iteration, residual, active, reason| {
            let stage = format!("contact of wheel and rail at {:.3} kN", load * 1e-3);
            Error::from(NumericsError::new(stage, reason, residual, active).after(iteration))
        };
        let directions = self.directions();
        let along = self.along.into_inner();
        let mut hub = near
            .map_or(Vector2::zeros(), |b| b.hub + along * (b.way_under(load, &along) - b.hub.dot(&along)));
        let (mut share, mut moved, mut active) = (1.0, 0.0_f64, 0);
        let mut previous: Option<Pressed> = None;
        // how the hub has moved since the previous state, where that has the grid for the next one
        let mut step: Option<Vector2<f64>> = None;
        // from a state of the same pair the hub is found so well that the first solution may be the last
        let from_own = near.is_some_and(|near| near.answer.is_some()) && plan.is_from_start();
        let mut factors = Factors::default();
        let tolerance = if self.field.is_fine() { FINE_HUB_TOLERANCE } else { HUB_TOLERANCE };
        for iteration in 0..PAIRING_LIMIT {
            let paired_before = previous.is_some();
            let again = step.take().and_then(|step| self.paired_again(&mut previous, &hub, &step));
            let (Candidates { mut points, elasticity, start }, mut free) = match again {
                Some(again) => again,
                None => {
                    let last = previous.as_ref().or(near);
                    let candidates = if self.field.is_fine() {
                        self.fine_candidates(&hub, load, last, &mut plan)
                    } else {
                        self.element_candidates(&hub, previous.as_ref(), near)
                    };
                    let Candidates { points, elasticity, .. } = &candidates;
                    if points.is_empty() {
                        return Err(failure(iteration, f64::NAN, 0, StopReason::EdgeOfCandidates));
                    }
                    let mut free = gaps(points);
                    free.resize(directions * points.len(), 0.0);
                    if directions == 3 {
                        self.add_slip_since(before, points, elasticity, &hub, &mut free);
                    }
                    (candidates, free)
                }
            };
            let wanted = [FreeDirection { along: self.world_direction(), force: -load }];
            let problem = Problem {
                points: &points,
                compliance: elasticity.operator(),
                free: &free,
                friction: self.friction,
                hub: &wanted,
            };
            // the points are paired again after the first solution
            let residual = match (iteration, near) {
                (0, None) => UNGRIDDED,
                (0, Some(_)) if !from_own => UNPAIRED,
                _ => TOLERANCE,
            };
            let solution =
                solve_to(&problem, &start, residual, &mut factors).map_err(|e| at_load(e, load))?;
            let way = solution.hub[0];
            if moved != 0.0 && way != moved {
                // of the last two ways and the part of the first that was gone: where the next one would be zero
                share = (share * moved / (moved - way)).clamp(LEAST_SHARE, LARGEST_SHARE);
            }
            moved = way;
            active = solution.active();
            if hub.dot(&along) + way < -AGAINST_THE_LOAD {
                return Err(failure(iteration, way, active, StopReason::Indefinite));
            }
            let settled = (way.abs() < tolerance && paired_before)
                || (residual == TOLERANCE
                    && way.abs() < SHORT_WAY
                    && self.gaps_stay(&points, &solution, &elasticity, &hub, way));
            if settled {
                hub += along * way;
                points.iter_mut().for_each(|point| point.gap += point.normal.dot(&along) * way);
                add_motion(&points, &(along * way), &mut free);
            } else {
                hub += along * share * way;
                step = Some(along * share * way);
            }
            let (answer, motions, node_gaps) = (None, OnceLock::new(), OnceLock::new());
            let mut state =
                Pressed { load, hub, points, free, solution, answer, elasticity, motions, node_gaps };
            if self.revise(&mut plan, &state, settled) {
                (previous, step) = (Some(state), None);
                continue;
            }
            if settled {
                let (points, forces) = (&state.points, &state.solution.forces);
                let grid = self.rail_surface.grid;
                let reached = match &state.elasticity {
                    Elasticity::Elements(_) => edge_reached(points, forces, grid.along_track.len()),
                    Elasticity::Hybrid(fine) => fine
                        .edge_reached(points, forces, grid)
                        .or_else(|| touches_border(points, forces).then_some(StopReason::GridUnsettled)),
                };
                if let Some(reason) = reached {
                    return Err(failure(iteration, 0.0, active, reason));
                }
                state.answer = self.answer(&state, &mut factors);
                return Ok(state);
            }
            previous = Some(state);
        }
        Err(failure(PAIRING_LIMIT, moved.abs(), active, StopReason::IterationLimit))
    }

    /// The points of a `state` on a fine grid with the hub at `hub`, `step` from where their gaps are, with its elasticity and its forces, and their gaps and slips: points stay
    /// where they are on the rail. None, and the state as it was, where the wheel no longer faces them, or has slid too far for its far field.
    fn paired_again(
        &self,
        state: &mut Option<Pressed>,
        hub: &Vector2<f64>,
        step: &Vector2<f64>,
    ) -> Option<(Candidates, Vec<f64>)> {
        let Pressed { points, elasticity: Elasticity::Hybrid(fine), .. } = state.as_ref()? else {
            return None;
        };
        let nodes: Vec<_> = points.iter().map(|point| point.index).collect();
        let solids = self.solids(hub);
        let paired = fine.lattice.points(&solids.rail_surface, &solids.wheel_surface, &nodes);
        if !fine.is_near(&solids) || paired.len() < points.len() {
            return None;
        }
        let Pressed { mut points, mut free, elasticity, solution, .. } = state.take()?;
        add_motion(&points, step, &mut free);
        for ((point, now), gap) in points.iter_mut().zip(paired).zip(&mut free) {
            (point.gap, point.opposing_position) = (now.gap, now.opposing_position);
            *gap = now.gap;
        }
        Some((Candidates { points, elasticity, start: solution.forces }, free))
    }

    /// Whether the gaps of the points that carry load change with the `way` of the hub, m, as the normals of the rail have it: then pairing them again would move the
    /// hub by less than [`HUB_TOLERANCE`].
    fn gaps_stay(
        &self,
        points: &[ContactPoint],
        solution: &Solution,
        elasticity: &Elasticity,
        hub: &Vector2<f64>,
        way: f64,
    ) -> bool {
        let Elasticity::Hybrid(fine) = elasticity else { return false };
        let along = self.along.into_inner();
        let carrying: Vec<usize> = (0..points.len()).filter(|&j| solution.forces[j] > 0.0).collect();
        let nodes: Vec<_> = carrying.iter().map(|&j| points[j].index).collect();
        let wheel = self.wheel_surface.moved(&(hub + along * way));
        let now = fine.lattice.points(&self.rail_surface, &wheel, &nodes);
        let (mut off, mut sum) = (0.0, 0.0);
        for (&j, now) in carrying.iter().zip(&now) {
            let expected = points[j].gap + points[j].normal.dot(&along) * way;
            off += solution.forces[j] * (now.gap - expected).abs();
            sum += solution.forces[j];
        }
        now.len() == nodes.len() && off < HUB_TOLERANCE * sum
    }

    /// The answer to a motion of the hub along its direction. The wheel faces the rail elsewhere then, so that its gaps follow the normals of the
    /// wheel and not those of the rail: on a flange that is pressed downwards, the tangent is off by a tenth and more without it.
    fn answer(&self, state: &Pressed, factors: &mut Factors) -> Option<Answer> {
        let along = self.world_direction();
        let n = state.points.len();
        let weights: Vec<f64> =
            (0..state.free.len()).map(|row| state.points[row % n].direction(row / n).dot(&along)).collect();
        let mut rates = weights.clone();
        if let Some(fine) = state.fine() {
            // that of the others counts where they come to carry load
            let way = state.hub.dot(&self.along).abs();
            let near = |j: &usize| state.solution.separation[*j] < REACHED * way;
            let near: Vec<usize> = (0..n).filter(near).collect();
            let nodes: Vec<_> = near.iter().map(|&j| state.points[j].index).collect();
            let [before, after] = [-GAP_STEP, GAP_STEP].map(|step| {
                let hub = state.hub + self.along.into_inner() * step;
                fine.lattice.points(&self.rail_surface, &self.wheel_surface.moved(&hub), &nodes)
            });
            let gap = |points: &[ContactPoint], index| {
                points.binary_search_by_key(&index, |point| point.index).ok().map(|at| points[at].gap)
            };
            for (&j, &index) in near.iter().zip(&nodes) {
                if let (Some(before), Some(after)) = (gap(&before, index), gap(&after, index)) {
                    rates[j] = (after - before) / (2.0 * GAP_STEP);
                }
            }
        }
        let problem = state.problem(self.friction);
        let forces = response_to(&problem, &state.solution, std::slice::from_ref(&rates), false, factors)?;
        let forces = forces.col_as_slice(0).to_vec();
        let stiffness = forces.iter().zip(&weights).map(|(force, weight)| -force * weight).sum();
        rates.truncate(n);
        Some(Answer { stiffness, forces, rates })
    }

    /// Adds the tangential motion with the hub at `hub` since the state `before`, or since just touching; the contact
    /// forces add theirs.
    fn add_slip_since(
        &self,
        before: Option<&Pressed>,
        points: &[ContactPoint],
        elasticity: &Elasticity,
        hub: &Vector2<f64>,
        free: &mut [f64],
    ) {
        let n = points.len();
        let fine = before.and_then(|before| match (&before.elasticity, elasticity) {
            (Elasticity::Hybrid(from), Elasticity::Hybrid(to)) => {
                let forces = &before.solution.forces;
                Some(from.tangential_at(&before.points, forces, &self.solids(hub), to, points))
            }
            _ => None,
        });
        let moved = hub - before.map_or(Vector2::zeros(), |b| b.hub);
        for row in n..3 * n {
            let (j, d) = (row % n, row / n);
            let direction = points[j].direction(d);
            free[row] += direction.y * moved.x + direction.z * moved.y;
            if let Some(fine) = &fine {
                free[row] -= fine[j][d - 1];
            } else if let Some(before) = before {
                free[row] -= before.opening(self, &points[j], d);
            }
        }
    }
}

/// Adds what the gaps and slips change by as the wheel moves by `way`, world (y, z) in m.
fn add_motion(points: &[ContactPoint], way: &Vector2<f64>, free: &mut [f64]) {
    for (row, value) in free.iter_mut().enumerate() {
        *value += points[row % points.len()].direction(row / points.len()).yz().dot(way);
    }
}

/// Whether an iteration did not settle, which another start may cure.
fn unsettled(error: &Error) -> bool {
    use StopReason::{GridUnsettled, IterationLimit, NotFinite, Singular};
    matches!(error, Error::Numerics(e) if matches!(e.reason, GridUnsettled | IterationLimit | NotFinite | Singular))
}

fn at_load(error: Error, load: f64) -> Error {
    match error {
        Error::Numerics(mut e) => {
            e.stage = format!("{} at {:.3} kN", e.stage, load * 1e-3);
            e.into()
        }
        other => other,
    }
}

#[cfg(test)]
mod tests;
