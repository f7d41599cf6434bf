//! The contact at the end of a time step: between the nodes of the meshes, or on a fine grid that follows the patch.
//!
//! The contact nodes have no mass, so what is elastic around a patch follows at once: the near field of the fine grid is
//! that of the statics. What the bodies are beyond their half-spaces is that of the step, inertia and hub included.

use super::TransientModel;
use super::body::Interface;
use crate::calibration::{
    ContactField, Displaced, FineContact, Solids, carry_over, cell_for, edge_reached, too_coarse,
    touches_border, widened, widths,
};
use crate::contact::{
    ContactPoint, HalfSpace, Lattice, PairingLimits, Problem, Side, Solution, nodal_forces, pair, solve,
};
use crate::error::{Error, NumericsError, Result, StopReason};
use crate::mesh::SurfaceGrid;
use crate::newmark::Newmark;
use crate::scenario::Scenario;
use nalgebra::Vector2;
use std::sync::Arc;

/// Points whose gap without contact forces in this step exceeds this cannot come to carry load, m.
const CANDIDATE_MARGIN: f64 = 5e-6;
/// Gap within which points are paired at all, m.
const PAIRING_GAP: f64 = 0.25e-3;
/// The geometry is paired again until the hub has moved by less, m: the gap changes by the relative
/// curvature (below 1/m·10²) times its square, which is below a picometre.
const HUB_TOLERANCE: f64 = 1e-7;
const PAIRING_LIMIT: usize = 12;
/// On a fine grid, where what the bodies move beyond the hub's place stands in the gaps as well, half the square of this over
/// a radius of a centimetre is left of a gap, a millionth of the approach of a loaded wheel; m.
const PLACE_TOLERANCE: f64 = 1e-6;
/// The wheel slides past the rail by as much before its far field is made again, m: it changes by some tenths of a
/// per cent over that.
const FAR_SLIDE: f64 = 1e-3;
/// The hub moves by as much before the nodes in reach are sought again, m. The gaps without contact forces do not depend
/// on it but for its square over a radius.
const REGION_SLIDE: f64 = 0.1e-3;
/// Of a second difference over a node, what the surface between nodes may lie nearer than the mean over the node's hat: an eighth
/// in the middle of a cell, and a twelfth for the mean.
const BETWEEN_NODES: f64 = 1.0 / 8.0 + 1.0 / 12.0;
/// Smallest cell over the largest one. Patches that it does not resolve carry less than a per cent of a wheel's load; a grid
/// for them would have thousands of points in a cell of the mesh.
const FINEST_CELL: f64 = 0.25;
/// A grid is finer than it needs to be from this ratio on.
const TOO_FINE: f64 = 1.3;
/// Points that the free motion of a step makes overlap, of which half carry load in Hertz' contact; with more of them the grid is
/// made coarser by √2.
const MOST_OVERLAPPING: usize = 1000;
/// Changes of the fine grid and its reach at most, in a step.
const GRID_CHANGES: usize = 6;

/// Contact of the step before, as a start for the next.
#[derive(Clone)]
pub(super) struct LastContact {
    pub points: Vec<ContactPoint>,
    pub solution: Solution,
    /// The fine grid, if it is one: that of the last contact while the wheel is in the air.
    fine: Option<Fine>,
    /// What the hub was beyond its prediction, m.
    missed: Vector2<f64>,
}

/// A fine grid at the end of a step.
#[derive(Clone)]
struct Fine {
    contact: Arc<FineContact>,
    /// Position of the hub for which its far field was made, m.
    made_at: Vector2<f64>,
    /// Displacements of the wheel against the rail at the points, by direction and point, at the end of the step, m.
    displacement: Vec<f64>,
    /// What of them was beyond those of the contact nodes at the beginning of the step, m.
    beyond_before: Vec<f64>,
}

impl Default for LastContact {
    fn default() -> Self {
        Self::open(None)
    }
}

impl LastContact {
    /// Without contact, after the fine grid `fine`.
    fn open(fine: Option<&Fine>) -> Self {
        let solution = Solution {
            forces: Vec::new(),
            separation: Vec::new(),
            modes: Vec::new(),
            hub: Vec::new(),
            iterations: 0,
        };
        let fine =
            fine.map(|fine| Fine { displacement: Vec::new(), beyond_before: Vec::new(), ..fine.clone() });
        Self { points: Vec::new(), solution, fine, missed: Vector2::zeros() }
    }

    /// Forces on the retained `equations` of one body, N.
    pub fn nodal_forces(&self, side: Side, equations: usize) -> Vec<f64> {
        let forces = &self.solution.forces;
        match &self.fine {
            Some(fine) if !self.points.is_empty() => fine.contact.nodal_forces(side, forces, equations),
            _ => nodal_forces(&self.points, side, forces, equations),
        }
    }

    /// An error if a point at the edge of either grid carries load: the surface goes on beyond it. `grid` is the rail's.
    pub fn refuse_edge(&self, grid: &SurfaceGrid) -> Result<()> {
        let forces = &self.solution.forces;
        let reached = match &self.fine {
            Some(fine) => fine.contact.edge_reached(&self.points, forces, grid),
            None => edge_reached(&self.points, forces, grid.along_track.len()),
        };
        match reached {
            Some(reason) => Err(failure(0.0, self.solution.active(), reason)),
            None => Ok(()),
        }
    }

    /// What the points of a fine grid have moved beyond the contact nodes of the bodies at the beginning of the next step, which are
    /// displaced by `rail` and `wheel` (m) there; `None` if there are none.
    fn beyond_nodes(&self, rail: &[f64], wheel: &[f64], time_step: f64) -> Option<BeyondNodes<'_>> {
        let fine = self.fine.as_ref().filter(|_| !self.points.is_empty())?;
        let nodes = fine.contact.motion_of_nodes(rail, wheel);
        let displacement: Vec<f64> =
            fine.displacement.iter().zip(nodes).map(|(all, node)| all - node).collect();
        let moved = displacement.iter().zip(&fine.beyond_before);
        let velocity = moved.map(|(now, before)| (now - before) / time_step).collect();
        Some(BeyondNodes { contact: &fine.contact, points: &self.points, displacement, velocity })
    }
}

/// Displacements (m) of the points of a fine grid beyond the contact nodes, and their velocities (m/s).
struct BeyondNodes<'c> {
    contact: &'c FineContact,
    points: &'c [ContactPoint],
    displacement: Vec<f64>,
    velocity: Vec<f64>,
}

impl BeyondNodes<'_> {
    /// Displacements and velocities at other points. Far from the patch there are none: both function spaces have the
    /// same half-space there.
    fn at(&self, points: &[ContactPoint]) -> [Vec<f64>; 2] {
        [&self.displacement, &self.velocity].map(|values| self.contact.values_at(self.points, values, points))
    }
}

/// What the contact of every step of a run has in common.
pub(super) struct StepContact<'m> {
    model: &'m TransientModel<'m>,
    friction: f64,
    time_step: f64,
    /// Half-spaces of both bodies in a step: stiffer than at rest by what the damping adds.
    half_spaces: [HalfSpace; 2],
    /// What a damped near field keeps of its displacement and of its velocity (s).
    kept: [f64; 2],
}

impl<'m> StepContact<'m> {
    pub fn new(model: &'m TransientModel<'m>, scenario: &Scenario, scheme: &Newmark) -> Self {
        let damping = model.material.damping;
        let stiffening = 1.0 + damping * scheme.velocity;
        let half_spaces = HalfSpace::both(&model.material)
            .map(|body| HalfSpace { shear_modulus: stiffening * body.shear_modulus, ..body });
        let kept = [damping * scheme.velocity / stiffening, damping / stiffening];
        Self { model, friction: scenario.friction, time_step: scheme.step(), half_spaces, kept }
    }

    fn directions(&self) -> usize {
        if self.friction > 0.0 { 3 } else { 1 }
    }

    /// Solves the contact at the end of a step, pairing again until the hub stays where it was paired.
    pub fn solve(
        &self,
        bodies: [&Interface; 2],
        predicted: &Vector2<f64>,
        last: &LastContact,
    ) -> Result<LastContact> {
        match self.model.field {
            ContactField::Elements => self.between_nodes(bodies, predicted, last),
            ContactField::Hybrid | ContactField::HybridHalved => self.on_fine_grid(bodies, predicted, last),
        }
    }

    fn between_nodes(
        &self,
        [rail, wheel]: [&Interface; 2],
        predicted: &Vector2<f64>,
        last: &LastContact,
    ) -> Result<LastContact> {
        let directions = self.directions();
        let mut hub = *predicted;
        let mut start = last.clone();
        let mut moved = f64::NAN;
        for _ in 0..PAIRING_LIMIT {
            let limits = PairingLimits { largest_gap: PAIRING_GAP };
            let mut points = pair(&self.model.rail_surface, &self.model.wheel_surface.moved(&hub), limits);
            let gaps = free_gaps(&points, &hub, rail.free, wheel.free);
            let mut near = gaps.iter().map(|g| *g < CANDIDATE_MARGIN);
            points.retain(|_| near.next().unwrap_or(false));
            let mut free: Vec<f64> = gaps.into_iter().filter(|g| *g < CANDIDATE_MARGIN).collect();
            if directions == 3 {
                add_slips(&points, rail, wheel, &mut free);
            }
            let compliance =
                self.model.enforcement.compliance(rail.flexibility, wheel.flexibility, &points, directions);
            let first = carry_over(&start.points, &start.solution.forces, &points, directions);
            let problem = Problem {
                points: &points,
                compliance: &compliance,
                free: &free,
                friction: self.friction,
                hub: &[],
            };
            let solution = solve(&problem, &first)?;
            let solved = LastContact { points, solution, fine: None, missed: Vector2::zeros() };
            let position = wheel.hub(&solved.nodal_forces(Side::Opposing, wheel.free.len()));
            moved = (position - hub).norm();
            if moved < HUB_TOLERANCE {
                return Ok(solved);
            }
            hub = position;
            start = solved;
        }
        Err(failure(moved, start.solution.active(), StopReason::IterationLimit))
    }

    fn on_fine_grid(
        &self,
        bodies: [&Interface; 2],
        predicted: &Vector2<f64>,
        last: &LastContact,
    ) -> Result<LastContact> {
        let [rail, wheel] = bodies;
        let grid = self.model.rail_surface.grid;
        let before = last.beyond_nodes(rail.before, wheel.before, self.time_step);
        // a load that grows or falls evenly makes the same error of the prediction in every step
        let mut hub = predicted + last.missed;
        let mut moved = f64::NAN;
        let mut previous: Option<LastContact> = None;
        let mut lattice = self.lattice_after(last);
        let mut region: Option<(Vector2<f64>, Vec<bool>)> = None;
        let mut changes = 0;
        let mut coarsened = false;
        for _ in 0..PAIRING_LIMIT + 2 * GRID_CHANGES {
            let start = previous.as_ref().unwrap_or(last);
            let (sought_at, near) = match region.take() {
                Some(sought) if (sought.0 - hub).norm() < REGION_SLIDE => sought,
                _ => (hub, self.near_nodes(&hub, bodies)),
            };
            let Some(solved) = self.solve_at(&hub, bodies, (lattice, &near), start, before.as_ref())? else {
                coarsened = true;
                lattice = self.coarser(&lattice);
                region = Some((sought_at, near));
                continue;
            };
            let (points, forces) = (&solved.points, &solved.solution.forces);
            let spreads = touches_border(points, forces);
            let finer = if coarsened { None } else { self.finer(&lattice, &solved) };
            if spreads || finer.is_some() {
                if changes == GRID_CHANGES {
                    return Err(failure(moved, solved.solution.active(), StopReason::EdgeOfCandidates));
                }
                changes += 1;
                lattice = finer.unwrap_or(lattice);
                let near = if spreads { widened(&near, grid.along_track.len(), 1) } else { near };
                region = Some((sought_at, near));
                previous = Some(solved);
                continue;
            }
            let position = wheel.hub(&solved.nodal_forces(Side::Opposing, wheel.free.len()));
            moved = (position - hub).norm();
            if moved < PLACE_TOLERANCE {
                return Ok(LastContact { missed: position - predicted, ..solved });
            }
            hub = position;
            region = Some((sought_at, near));
            previous = Some(solved);
        }
        let active = previous.as_ref().map_or(0, |previous| previous.solution.active());
        Err(failure(moved, active, StopReason::IterationLimit))
    }

    /// The contact with the hub displaced by `hub`, on a fine grid around the nodes `near` of the rail's; `None` where a coarser
    /// grid is enough.
    fn solve_at(
        &self,
        hub: &Vector2<f64>,
        [rail, wheel]: [&Interface; 2],
        (lattice, near): (Lattice, &[bool]),
        start: &LastContact,
        before: Option<&BeyondNodes>,
    ) -> Result<Option<LastContact>> {
        let known = start.fine.as_ref();
        if !near.contains(&true) {
            return Ok(Some(LastContact::open(known)));
        }
        let directions = self.directions();
        let solids = Solids {
            rail: rail.flexibility,
            wheel: wheel.flexibility,
            rail_surface: &self.model.rail_surface,
            wheel_surface: self.model.wheel_surface.moved(hub),
            half_spaces: self.half_spaces,
        };
        let of_hub: Vec<f64> = (0..wheel.free.len()).map(|dof| [0.0, hub.x, hub.y][dof % 3]).collect();
        let wheel_beyond_hub = difference(wheel.free, &of_hub);
        let displaced = Displaced { rail: rail.free, wheel: &wheel_beyond_hub, margin: CANDIDATE_MARGIN };
        let serving = known.filter(|known| (known.made_at - hub).norm() < FAR_SLIDE);
        let (points, contact) = FineContact::new(
            &solids,
            lattice,
            near,
            serving.map(|known| &*known.contact),
            Some(&displaced),
            directions,
        );
        let made_at = match serving {
            Some(known) if known.contact.shares_far_field(&contact) => known.made_at,
            _ => *hub,
        };
        let n = points.len();
        let (beyond_before, kept) = match before {
            Some(before) => {
                let [displacement, velocity] = before.at(&points);
                let [of_displacement, of_velocity] = self.kept;
                let kept: Vec<f64> = displacement
                    .iter()
                    .zip(velocity)
                    .map(|(u, v)| of_displacement * u + of_velocity * v)
                    .collect();
                (displacement, kept)
            }
            None => (vec![0.0; directions * n], vec![0.0; directions * n]),
        };
        // gaps at the hub's place, with what the bodies move beyond it; slips since the last step
        let of_nodes = contact.motion_of_nodes(rail.free, wheel.free);
        let beyond_hub = contact.motion_of_nodes(rail.free, &wheel_beyond_hub);
        let since_last = contact
            .motion_of_nodes(&difference(rail.free, rail.before), &difference(wheel.free, wheel.before));
        let free: Vec<f64> = (0..directions * n)
            .map(|row| match points.get(row) {
                Some(point) => point.gap + beyond_hub[row] + kept[row],
                None => since_last[row] + kept[row] - beyond_before[row],
            })
            .collect();
        let overlapping = free[..n].iter().filter(|gap| **gap < 0.0).count();
        if overlapping > MOST_OVERLAPPING && self.coarser(&lattice) != lattice {
            return Ok(None);
        }
        let problem = Problem {
            points: &points,
            compliance: contact.operator(),
            free: &free,
            friction: self.friction,
            hub: &[],
        };
        let solution = solve(&problem, &first_forces(start, &lattice, &points, directions))?;
        let displacement = (0..directions * n)
            .map(|row| of_nodes[row] + kept[row] + solution.separation[row] - free[row])
            .collect();
        let fine = Some(Fine { contact: Arc::new(contact), made_at, displacement, beyond_before });
        Ok(Some(LastContact { points, solution, fine, missed: Vector2::zeros() }))
    }

    /// The nodes of the rail's grid near which the surfaces may touch in this step.
    fn near_nodes(&self, hub: &Vector2<f64>, [rail, wheel]: [&Interface; 2]) -> Vec<bool> {
        let grid = self.model.rail_surface.grid;
        let (rows, columns) = (grid.along_profile.len(), grid.along_track.len());
        let limits = PairingLimits { largest_gap: PAIRING_GAP };
        let points = pair(&self.model.rail_surface, &self.model.wheel_surface.moved(hub), limits);
        let mut gaps = vec![PAIRING_GAP; rows * columns];
        for (point, gap) in points.iter().zip(free_gaps(&points, hub, rail.free, wheel.free)) {
            gaps[point.index.0 * columns + point.index.1] = gap;
        }
        let mut near = vec![false; rows * columns];
        for point in &points {
            let (i, k) = point.index;
            let gap = gaps[i * columns + k];
            let bend = |line: usize, lines: usize, step: usize| {
                let node = i * columns + k;
                if line == 0 || line + 1 == lines {
                    return 0.0;
                }
                (gaps[node - step] - 2.0 * gap + gaps[node + step]).max(0.0)
            };
            let nearer = BETWEEN_NODES * (bend(i, rows, columns) + bend(k, columns, 1));
            near[i * columns + k] = gap - nearer < CANDIDATE_MARGIN;
        }
        near
    }

    /// The grid to begin a step with: that of the last one, unless its patch has outgrown it.
    fn lattice_after(&self, last: &LastContact) -> Lattice {
        let Some(fine) = &last.fine else {
            return self.lattice(cell_for([f64::INFINITY; 2], self.model.field.spacing()));
        };
        let lattice = fine.contact.lattice;
        if last.solution.active() == 0 {
            return lattice;
        }
        let wanted = self.wanted(&lattice, last);
        if (0..2).any(|axis| wanted.cell[axis] > TOO_FINE * lattice.cell[axis]) { wanted } else { lattice }
    }

    /// A finer grid, if the patch needs it.
    fn finer(&self, lattice: &Lattice, contact: &LastContact) -> Option<Lattice> {
        if contact.solution.active() == 0 {
            return None;
        }
        let across = widths(lattice, &contact.points, &contact.solution.forces[..contact.points.len()]);
        let wanted = self.wanted(lattice, contact);
        (too_coarse(lattice, across, self.model.field.spacing()) && wanted != *lattice).then_some(wanted)
    }

    /// A grid with larger cells, if there are any.
    fn coarser(&self, lattice: &Lattice) -> Lattice {
        let largest = cell_for([f64::INFINITY; 2], self.model.field.spacing());
        self.lattice((lattice.cell * std::f64::consts::SQRT_2).inf(&largest))
    }

    /// The grid for the patch of a `contact` on `lattice`.
    fn wanted(&self, lattice: &Lattice, contact: &LastContact) -> Lattice {
        let forces = &contact.solution.forces[..contact.points.len()];
        let largest = cell_for([f64::INFINITY; 2], self.model.field.spacing());
        self.lattice(
            cell_for(widths(lattice, &contact.points, forces), self.model.field.spacing())
                .sup(&(largest * FINEST_CELL)),
        )
    }

    fn lattice(&self, cell: Vector2<f64>) -> Lattice {
        Lattice::over(self.model.rail_surface.grid, cell)
    }
}

/// Forces of a contact on the `points` of a lattice.
fn first_forces(
    start: &LastContact,
    lattice: &Lattice,
    points: &[ContactPoint],
    directions: usize,
) -> Vec<f64> {
    match &start.fine {
        Some(fine) if start.solution.active() > 0 => {
            fine.contact.carry_over(&start.points, &start.solution.forces, lattice, points, 1.0)
        }
        _ => vec![0.0; directions * points.len()],
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Normal gaps at the end of the step without contact forces: the rigid gap at `hub` plus what the
/// bodies move beyond it.
fn free_gaps(points: &[ContactPoint], hub: &Vector2<f64>, rail: &[f64], wheel: &[f64]) -> Vec<f64> {
    points
        .iter()
        .map(|point| {
            let beyond: f64 = point
                .row(Side::Opposing, 0)
                .map(|(dof, w)| w * (wheel[dof] - [0.0, hub.x, hub.y][dof % 3]))
                .sum();
            point.gap + beyond - point.displacement(Side::Base, 0, rail)
        })
        .collect()
}

/// Appends the slips (lateral, then along the track) of the step without contact forces.
fn add_slips(points: &[ContactPoint], rail: &Interface, wheel: &Interface, free: &mut Vec<f64>) {
    let (rail_free, wheel_free) = (rail.free, wheel.free);
    let (rail_before, wheel_before) = (rail.before, wheel.before);
    for direction in 1..3 {
        for point in points {
            let wheel: f64 = point
                .row(Side::Opposing, direction)
                .map(|(dof, w)| w * (wheel_free[dof] - wheel_before[dof]))
                .sum();
            let rail: f64 = point
                .row(Side::Base, direction)
                .map(|(dof, w)| w * (rail_free[dof] - rail_before[dof]))
                .sum();
            free.push(wheel - rail);
        }
    }
}

pub(super) fn failure(residual: f64, active: usize, reason: StopReason) -> Error {
    NumericsError {
        stage: "contact of the transient solid model".into(),
        step: None,
        iteration: PAIRING_LIMIT,
        residual,
        active,
        reason,
    }
    .into()
}
