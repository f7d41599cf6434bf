//! The wheel pressed on the rail: static equilibrium under a wanted load.

use super::far_field::Solids;
use super::fine::{
    FineContact, cell_for, first_forces, rim_gap, too_coarse, touches_border, widened, widths,
};
use crate::contact::{
    BodyCompliance, ComplianceOperator, ContactPoint, FreeDirection, HalfSpace, Lattice, PairingLimits,
    PenaltySprings, Problem, Side, Solution, Surface, gaps, nodal_forces, pair, resultant, solve, total,
};
use crate::error::{Error, InputError, NumericsError, Result, StopReason};
use crate::field::InputField;
use crate::solid::Material;
use crate::superelement::times;
use faer::Mat;
use nalgebra::{Vector2, Vector3};
use std::sync::OnceLock;

/// How the contact conditions are enforced.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Enforcement {
    /// No penetration at all.
    Exact,
    /// A spring at every contact node, N/m (published: 1e9).
    Penalty(f64),
}

impl Enforcement {
    /// Compliance at `points` of both bodies, given at their contact nodes, and of the penalty springs if there are any.
    pub(crate) fn compliance(
        self,
        rail: &Mat<f64>,
        wheel: &Mat<f64>,
        points: &[ContactPoint],
        directions: usize,
    ) -> Mat<f64> {
        let rail = BodyCompliance { compliance: rail, side: Side::Base };
        let wheel = BodyCompliance { compliance: wheel, side: Side::Opposing };
        match self {
            Self::Exact => total(&[&rail, &wheel], points, directions),
            Self::Penalty(stiffness) => {
                total(&[&rail, &wheel, &PenaltySprings { stiffness }], points, directions)
            }
        }
    }
}

/// Where the contact lives, and what is elastic in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ContactField {
    /// On a fine grid of about 0.65 by 0.5 mm that follows the patch: half-spaces between its points, and the bodies beyond
    /// their half-spaces interpolated from the nodes of the meshes.
    Hybrid,
    /// On the contact nodes of the meshes, the elements alone.
    #[default]
    Elements,
}

/// A wheel above a rail, both condensed.
pub struct WheelOnRail<'a> {
    /// Compliance of the rail's contact nodes (`3·node + axis`), m/N: against its supports, or against its own section
    /// ([`crate::superelement::SectionMotion::relative`]).
    pub rail: &'a Mat<f64>,
    /// Compliance of the wheel's contact nodes against its hub, m/N.
    pub wheel: &'a Mat<f64>,
    /// Contact surface of the rail, at rest.
    pub rail_surface: Surface<'a>,
    /// Contact surface of the wheel; its origin is the just-touching position.
    pub wheel_surface: Surface<'a>,
    /// Coulomb friction coefficient; 0 leaves friction out.
    pub friction: f64,
    /// How the contact conditions are enforced.
    pub enforcement: Enforcement,
    /// Where the contact lives.
    pub field: ContactField,
    /// Materials of rail and wheel.
    pub materials: [Material; 2],
}

/// Equilibrium under one load.
pub struct Pressed {
    /// Vertical load, N.
    pub load: f64,
    /// Displacement of the wheel's hub from just touching (y, z), m.
    pub hub: Vector2<f64>,
    /// Contact points at the final position.
    pub points: Vec<ContactPoint>,
    /// Gaps and slips without contact forces.
    pub free: Vec<f64>,
    /// Forces and modes.
    pub solution: Solution,
    elasticity: Elasticity,
    /// Displacements of the contact nodes of rail and wheel relative to the bodies' supports, m, once they are asked for.
    displacement: OnceLock<[Vec<f64>; 2]>,
}

/// Compliance of the contact points.
enum Elasticity {
    Elements(Mat<f64>),
    Hybrid(Box<FineContact>),
}

impl Elasticity {
    fn operator(&self) -> &dyn ComplianceOperator {
        match self {
            Self::Elements(matrix) => matrix,
            Self::Hybrid(fine) => fine.operator(),
        }
    }
}

/// Points between which contact is sought, their compliance, and forces to start from.
struct Candidates {
    points: Vec<ContactPoint>,
    elasticity: Elasticity,
    start: Vec<f64>,
}

/// Grid and reach of a fine contact while a load settles.
#[derive(Default)]
struct FinePlan {
    chosen: Option<(Lattice, Vec<bool>)>,
    changes: usize,
}

/// Rigid gap within which points are candidates while nothing is known of the elastic displacements, m.
const FIRST_GAP: f64 = 0.15e-3;
/// Rigid gap within which points are paired at all, m: bodies that roll under the load close less of it.
const PAIRING_GAP: f64 = 0.5e-3;
/// Points farther apart than this under the forces of the last pairing are no candidates, m: what the forces
/// may still change, and the bulging beside a patch.
const CANDIDATE_MARGIN: f64 = 20e-6;
/// The hub is found when pairing it again moves it by less, m.
const HUB_TOLERANCE: f64 = 1e-10;
const PAIRING_LIMIT: usize = 40;
/// Changes of the fine grid and its reach at most, while a load settles.
const GRID_CHANGES: usize = 8;
/// Of the gap at the rim of a patch, what its neighbourhood must have at most to be in reach.
const REACH: f64 = 6.0;
/// Smallest factor on the step of the hub where pairings make it oscillate, and largest where they creep.
const LEAST_SHARE: f64 = 1.0 / 16.0;
const LARGEST_SHARE: f64 = 2.0;
/// Intermediate loads tried, and the least step between them, of the whole.
const LOAD_LEVELS: usize = 12;
const LEAST_RISE: f64 = 1.0 / 32.0;

/// Why the points that carry load are not all there are: the patch of `forces` reaches the end of the contact
/// window along the track (of the grid with `columns` lines; the window of the wheel, equal in angle, may end within its
/// last cells), or the end of the contact zone on a profile.
pub(crate) fn edge_reached(points: &[ContactPoint], forces: &[f64], columns: usize) -> Option<StopReason> {
    let mut reached = None;
    for (point, _) in points.iter().zip(forces).filter(|(point, force)| point.at_edge && **force > 0.0) {
        let line = point.index.1;
        if line > 1 && line + 2 < columns {
            return Some(StopReason::EdgeOfCandidates);
        }
        reached = Some(StopReason::EndOfWindow);
    }
    reached
}

impl WheelOnRail<'_> {
    /// Directions a point: 1 without friction, else 3.
    pub fn directions(&self) -> usize {
        if self.friction > 0.0 { 3 } else { 1 }
    }

    /// Compliance of both bodies and the penalty springs at `points`.
    pub fn compliance(&self, points: &[ContactPoint], directions: usize) -> Mat<f64> {
        self.enforcement.compliance(self.rail, self.wheel, points, directions)
    }

    /// Contact points with the hub displaced by `hub` from just touching.
    pub fn points_at(&self, hub: &Vector2<f64>, largest_gap: f64) -> Vec<ContactPoint> {
        let mut wheel = self.wheel_surface.clone();
        wheel.origin += hub;
        pair(&self.rail_surface, &wheel, PairingLimits { largest_gap })
    }

    /// Presses the wheel with the vertical `load` (N, > 0), the hub held laterally; `before` is the state
    /// the load grew from, for friction and as a start. Where the iteration does not settle from there, it
    /// gets starts from loads in between; slips count from `before` all the same.
    ///
    /// # Errors
    /// [`InputError`] for a load that is not positive; [`NumericsError`] if the contact reaches the end of the meshed
    /// contact zone ([`StopReason::EdgeOfCandidates`] on a profile, [`StopReason::EndOfWindow`] along the track),
    /// or if the iteration does not settle.
    pub fn press(&self, load: f64, before: Option<&Pressed>) -> Result<Pressed> {
        if !(load > 0.0 && load.is_finite()) {
            return Err(InputError::new(
                InputField::Loads,
                format!("{:.4} kN", load * 1e-3),
                "a positive load",
                "leave it out, or correct it",
            )
            .into());
        }
        if let (ContactField::Hybrid, Enforcement::Penalty(stiffness)) = (self.field, self.enforcement) {
            return Err(InputError::new(
                InputField::Enforcement,
                format!("penalty springs of {:.4} kN/m", stiffness * 1e-3),
                "exact contact conditions on a fine grid",
                "penalty springs stand at the nodes of a mesh: choose exact conditions, or contact between elements",
            )
            .into());
        }
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

    /// Equilibrium under `load`, iterated from the state `near`; slips count from `before`.
    fn settle(&self, load: f64, before: Option<&Pressed>, near: Option<&Pressed>) -> Result<Pressed> {
        let failure = |iteration, residual, active, reason| {
            let stage = format!("contact of wheel and rail at {:.3} kN", load * 1e-3);
            Error::from(NumericsError { stage, step: None, iteration, residual, active, reason })
        };
        let directions = self.directions();
        let mut hub =
            near.map_or(Vector2::zeros(), |b| Vector2::new(b.hub.x, b.hub.y * (load / b.load).powf(0.75)));
        let (mut share, mut moved, mut active) = (1.0, 0.0_f64, 0);
        let mut previous: Option<Pressed> = None;
        let mut plan = FinePlan::default();
        for iteration in 0..PAIRING_LIMIT {
            let last = previous.as_ref().or(near);
            let candidates = match self.field {
                ContactField::Elements => self.element_candidates(&hub, previous.as_ref(), near),
                ContactField::Hybrid => self.fine_candidates(&hub, load, last, &mut plan),
            };
            let Candidates { points, elasticity, start } = candidates;
            if points.is_empty() {
                return Err(failure(iteration, f64::NAN, 0, StopReason::EdgeOfCandidates));
            }
            let mut free = gaps(&points);
            free.resize(directions * points.len(), 0.0);
            if directions == 3 {
                self.add_slip_since(before, &points, &elasticity, &hub, &mut free);
            }
            let wanted = [FreeDirection { along: Vector3::z_axis(), force: -load }];
            let problem = Problem {
                points: &points,
                compliance: elasticity.operator(),
                free: &free,
                friction: self.friction,
                hub: &wanted,
            };
            let solution = solve(&problem, &start).map_err(|e| at_load(e, load))?;
            let way = solution.hub[0];
            if moved != 0.0 && way != moved {
                // of the last two ways and the part of the first that was gone: where the next one would be zero
                share = (share * moved / (moved - way)).clamp(LEAST_SHARE, LARGEST_SHARE);
            }
            moved = way;
            hub.y += if way.abs() < HUB_TOLERANCE { way } else { share * way };
            active = solution.active();
            let state =
                Pressed { load, hub, points, free, solution, elasticity, displacement: OnceLock::new() };
            let settled = moved.abs() < HUB_TOLERANCE && previous.is_some();
            if self.revise(&mut plan, &state, settled) {
                previous = Some(state);
                continue;
            }
            if settled {
                let (points, forces) = (&state.points, &state.solution.forces);
                let grid = self.rail_surface.grid;
                let reached = match &state.elasticity {
                    Elasticity::Elements(_) => edge_reached(points, forces, grid.along_track.len()),
                    Elasticity::Hybrid(fine) => fine.edge_reached(points, forces, grid),
                };
                return match reached {
                    Some(reason) => Err(failure(iteration, 0.0, active, reason)),
                    None => Ok(state),
                };
            }
            previous = Some(state);
        }
        Err(failure(PAIRING_LIMIT, moved.abs(), active, StopReason::IterationLimit))
    }

    /// The contact nodes of the rail's mesh near the wheel.
    fn element_candidates(
        &self,
        hub: &Vector2<f64>,
        previous: Option<&Pressed>,
        near: Option<&Pressed>,
    ) -> Candidates {
        let points = match previous {
            None => self.first_points(hub),
            Some(last) => {
                let mut points = self.points_at(hub, PAIRING_GAP);
                let keep: Vec<bool> =
                    last.gaps_at(self, &points).iter().map(|gap| *gap < CANDIDATE_MARGIN).collect();
                // after a large displacement of the hub on a slope the last displacements say nothing of the new place
                if keep.contains(&true) {
                    let mut keep = keep.into_iter();
                    points.retain(|_| keep.next().unwrap_or(false));
                }
                points
            }
        };
        let directions = self.directions();
        let start = match previous.or(near) {
            Some(p) => carry_over(&p.points, &p.solution.forces, &points, directions),
            None => vec![0.0; directions * points.len()],
        };
        let elasticity = Elasticity::Elements(self.compliance(&points, directions));
        Candidates { points, elasticity, start }
    }

    /// The contact nodes of the rail's mesh that are near the wheel before anything is known of the displacements.
    fn first_points(&self, hub: &Vector2<f64>) -> Vec<ContactPoint> {
        // long elements on a sharp curve lie farther from the first touch
        [FIRST_GAP, PAIRING_GAP]
            .map(|gap| self.points_at(hub, gap))
            .into_iter()
            .find(|points| !points.is_empty())
            .unwrap_or_default()
    }

    /// Both bodies, the hub displaced by `hub`.
    fn solids(&self, hub: &Vector2<f64>) -> Solids<'_> {
        let mut wheel_surface = self.wheel_surface.clone();
        wheel_surface.origin += hub;
        let [rail, wheel] = &self.materials;
        let half_spaces = [HalfSpace::new(rail, Side::Base), HalfSpace::new(wheel, Side::Opposing)];
        Solids {
            rail: self.rail,
            wheel: self.wheel,
            rail_surface: &self.rail_surface,
            wheel_surface,
            half_spaces,
        }
    }

    /// The points of a fine grid where `plan` wants them; where it has no plan yet, by the state `last`.
    fn fine_candidates(
        &self,
        hub: &Vector2<f64>,
        load: f64,
        last: Option<&Pressed>,
        plan: &mut FinePlan,
    ) -> Candidates {
        let solids = self.solids(hub);
        let directions = self.directions();
        let known = last.and_then(|last| Some((last, last.fine()?)));
        let (lattice, region) = plan.chosen.get_or_insert_with(|| match known {
            Some((last, fine)) => {
                // patch and approach grow as on Hertz' ellipses
                let growth = (load / last.load).cbrt();
                let across = widths(&fine.lattice, &last.points, &last.solution.forces).map(|w| w * growth);
                (self.lattice(cell_for(across)), self.region(last, growth.max(1.0).powi(2)))
            }
            None => {
                let points = self.first_points(hub);
                let nodes = points.iter().map(|point| point.index);
                (self.lattice(cell_for([f64::INFINITY; 2])), self.marked(nodes))
            }
        });
        let (points, fine) =
            FineContact::new(&solids, *lattice, region, known.map(|(_, fine)| fine), directions);
        let start = match known {
            Some((last, of)) => {
                let growth = (load / last.load).cbrt();
                of.carry_over(&last.points, &last.solution.forces, lattice, &points, growth)
            }
            None => {
                let mut start = first_forces(&solids.half_spaces, &points, load);
                start.resize(directions * points.len(), 0.0);
                start
            }
        };
        Candidates { points, elasticity: Elasticity::Hybrid(Box::new(fine)), start }
    }

    /// Changes the `plan` of a fine contact where the `state` shows that grid or reach do not suit it; whether it did.
    fn revise(&self, plan: &mut FinePlan, state: &Pressed, settled: bool) -> bool {
        let Some((lattice, region)) = &mut plan.chosen else { return false };
        if plan.changes == GRID_CHANGES {
            return false;
        }
        let columns = self.rail_surface.grid.along_track.len();
        let forces = &state.solution.forces[..state.points.len()];
        let across = widths(lattice, &state.points, forces);
        let wanted = self.lattice(cell_for(across));
        let spreads = touches_border(&state.points, forces);
        if spreads || (plan.changes == 0 && wanted != *lattice) || too_coarse(lattice, across) {
            let mut reach = self.region(state, 1.0);
            if spreads {
                reach.iter_mut().zip(region.iter()).for_each(|(reach, sought)| *reach |= sought);
                reach = widened(&reach, columns, 1);
            }
            plan.chosen = Some((wanted, reach));
        } else {
            // contact far from where it was sought
            let closed = if settled { self.region(state, 0.0) } else { Vec::new() };
            if closed.iter().zip(region.iter()).all(|(closed, sought)| !closed || *sought) {
                return false;
            }
            region.iter_mut().zip(closed).for_each(|(sought, closed)| *sought |= closed);
        }
        plan.changes += 1;
        true
    }

    /// A fine grid as long as the rail's contact window.
    fn lattice(&self, cell: Vector2<f64>) -> Lattice {
        let x = &self.rail_surface.grid.along_track;
        Lattice::new(cell, x[0].abs().max(x[x.len() - 1].abs()))
    }

    /// Marks among the nodes of the rail's grid.
    fn marked(&self, nodes: impl Iterator<Item = (usize, usize)>) -> Vec<bool> {
        let grid = self.rail_surface.grid;
        let mut marks = vec![false; grid.along_profile.len() * grid.along_track.len()];
        nodes.for_each(|(i, k)| marks[i * grid.along_track.len() + k] = true);
        marks
    }

    /// The nodes of the rail's grid that are near the wheel with the displacements of a state: as near as the contact of its
    /// load may reach, times `part`; with 0, those where the surfaces overlap.
    fn region(&self, state: &Pressed, part: f64) -> Vec<bool> {
        let points = self.points_at(&state.hub, PAIRING_GAP);
        let forces = &state.solution.forces[..state.points.len()];
        let area: f64 =
            state.points.iter().zip(forces).filter(|(_, force)| **force > 0.0).map(|(p, _)| p.area).sum();
        let rim = rim_gap(&self.solids(&state.hub).half_spaces, state.load, area);
        let margin = part * (REACH * rim).min(CANDIDATE_MARGIN);
        let gaps = state.gaps_at(self, &points);
        let near = points.iter().zip(gaps).filter(|(_, gap)| *gap < margin).map(|(point, _)| point.index);
        let mut marks = self.marked(near);
        if part > 0.0 {
            // the patch itself, which may lie between nodes
            let grid = self.rail_surface.grid;
            let columns = grid.along_track.len();
            for (point, _) in state.points.iter().zip(forces).filter(|(_, force)| **force > 0.0) {
                let line =
                    |axis: &[f64], at: f64| axis.partition_point(|a| *a <= at).clamp(1, axis.len() - 1) - 1;
                let (i, k) =
                    (line(&grid.along_profile, point.position.x), line(&grid.along_track, point.position.y));
                for node in [i * columns + k, (i + 1) * columns + k] {
                    marks[node] = true;
                    marks[node + 1] = true;
                }
            }
        }
        marks
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
                let [rail, wheel] = before.displacement(self);
                free[row] -= points[j].displacement(Side::Opposing, d, wheel);
                free[row] += points[j].displacement(Side::Base, d, rail);
            }
        }
    }
}

impl Pressed {
    /// The contact problem at this state, for linearisation.
    pub fn problem<'b>(&'b self, friction: f64) -> Problem<'b> {
        let compliance = self.elasticity.operator();
        Problem { points: &self.points, compliance, free: &self.free, friction, hub: &[] }
    }

    /// The fine contact, if it is one.
    pub(super) fn fine(&self) -> Option<&FineContact> {
        match &self.elasticity {
            Elasticity::Elements(_) => None,
            Elasticity::Hybrid(fine) => Some(fine),
        }
    }

    /// Displacements of the contact nodes of rail and wheel, m.
    fn displacement(&self, bodies: &WheelOnRail) -> &[Vec<f64>; 2] {
        self.displacement.get_or_init(|| {
            let of = |body: &Mat<f64>, side| times(body, &self.body_forces(side, body.nrows()));
            [of(bodies.rail, Side::Base), of(bodies.wheel, Side::Opposing)]
        })
    }

    /// Gaps at `points` of the rail's contact nodes, m, with the elastic displacements of this state.
    fn gaps_at(&self, bodies: &WheelOnRail, points: &[ContactPoint]) -> Vec<f64> {
        let [rail, wheel] = self.displacement(bodies);
        points
            .iter()
            .map(|point| {
                point.gap + point.displacement(Side::Opposing, 0, wheel)
                    - point.displacement(Side::Base, 0, rail)
            })
            .collect()
    }

    /// Resultant of the contact forces on the wheel in world axes, N.
    pub fn force_on_wheel(&self) -> Vector3<f64> {
        resultant(&self.points, &self.solution.forces)
    }

    /// Forces on the retained `equations` of one body, N.
    pub fn body_forces(&self, side: Side, equations: usize) -> Vec<f64> {
        let forces = &self.solution.forces;
        match &self.elasticity {
            Elasticity::Elements(_) => nodal_forces(&self.points, side, forces, equations),
            Elasticity::Hybrid(fine) => fine.nodal_forces(side, forces, equations),
        }
    }
}

/// Forces of the points that both sets share, zero for the others.
pub(crate) fn carry_over(
    from: &[ContactPoint],
    forces: &[f64],
    to: &[ContactPoint],
    directions: usize,
) -> Vec<f64> {
    let mut start = vec![0.0; directions * to.len()];
    // both sets are sorted by grid index
    let mut i = 0;
    for (j, point) in to.iter().enumerate() {
        while i < from.len() && from[i].index < point.index {
            i += 1;
        }
        if i < from.len() && from[i].index == point.index {
            for d in 0..directions {
                start[d * to.len() + j] = forces[d * from.len() + i];
            }
        }
    }
    start
}

/// Whether an iteration did not settle, which another start may cure.
fn unsettled(error: &Error) -> bool {
    use StopReason::{IterationLimit, NotFinite, Singular};
    matches!(error, Error::Numerics(e) if matches!(e.reason, IterationLimit | NotFinite | Singular))
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
