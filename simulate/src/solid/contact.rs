//! The contact at the end of a time step: between the nodes of the meshes, or on a fine grid that follows the patch.
//!
//! The contact nodes have no mass, so what is elastic around a patch follows at once: the near field of the fine grid is
//! that of the statics. What the bodies are beyond their half-spaces is that of the step, inertia and hub included.
//!
//! The profiles are paired where rim and railhead are at the end of the step ([`Places`]); gaps and slips are those of the
//! displacements of the bodies' own nodes, so that pairing anew makes no slip.

use super::at_place::AtPlace;
use super::body::Interface;
use super::last_contact::{BeyondNodes, Fine, LastContact, Settled};
use super::model::TransientModel;
use crate::time::newmark::Newmark;
use crate::time::scenario::Scenario;
use nalgebra::{Point2, Vector2};
use railspring_calibrate::calibration::{
    Displaced, FineContact, Placed, Places, SolidBody, Solids, Zone, carry_over, cell_for, distance,
    too_coarse, touches_border, widths,
};
use railspring_calibrate::contact::{
    BeyondHalfSpace, ContactPoint, Factors, HalfSpace, Lattice, Problem, Side, Surface, solve, solve_with,
    widened,
};
use railspring_profiles::error::{Error, NumericsError, Result, StopReason};
use std::cell::{OnceCell, RefCell};
use std::sync::Arc;

/// Points whose gap without contact forces in this step exceeds this cannot come to carry load, m.
const CANDIDATE_MARGIN: f64 = 5e-6;
/// Gap within which points are paired at all, m.
const PAIRING_GAP: f64 = 0.25e-3;
/// The geometry is paired again until the places of the bodies have moved by less, m: the gap changes by the relative
/// curvature (below 1/m·10²) times its square, which is below a picometre.
const NODE_TOLERANCE: f64 = 1e-7;
const PAIRING_LIMIT: usize = 12;
/// Pairings of a step after which the zone whose motion places the bodies stays as it is: what it changes then is below any
/// tolerance, but where load comes and goes between two regions it might follow them for ever.
const ZONE_LIMIT: usize = 4;
/// On a fine grid, where what the bodies move beyond their places stands in the gaps along the normals, half the square of this over
/// a radius of a centimetre is left of a gap, a millionth of the approach of a loaded wheel; m.
const PLACE_TOLERANCE: f64 = 1e-6;
/// Spacing of the fine grid in time over that of the statics. Pressures of a run in time are not shown. Cells
/// along the profile do not become larger than the largest ones of the statics. A patch that moves from crown
/// to flange narrows over a jump in curvature. On cells of twice that size the next finer ones changed the
/// force by a tenth, which rang on from step to step. Against cells half as long in both directions P and Q
/// of the published load case 4.1 change by 0.2 and 0.1 % of their peaks, the averaged Q/P by 0.004 (RMS of
/// 60 ms, steps of 1/64 of the longest).
const WIDER: f64 = 2.0;
/// The wheel slides past the rail by as much before its far field is made again, m: it changes by some tenths of a
/// per cent over that.
const FAR_SLIDE: f64 = 1e-3;
/// The wheel moves along the rail by as much before the same, m. What the rail's flexibility has changed by since then counts at once, under the forces that the solution starts with.
const FAR_TRAVEL: f64 = 1e-3;
/// The places move by as much before the nodes in reach are sought again, m. The gaps without contact forces do not depend
/// on them but for its square over a radius.
const REGION_SLIDE: f64 = 0.1e-3;
/// Of a second difference over a node, what the surface in the middle of a cell may lie nearer than the node.
const BETWEEN_NODES: f64 = 1.0 / 8.0;
/// Smallest cell over the largest one of a grid that is as much wider than that of the statics. Patches that it does not resolve carry less than a per cent of a wheel's load; a grid
/// for them would have thousands of points in a cell of the mesh.
const FINEST_CELL: f64 = 0.25;
/// A grid is finer than it needs to be from this ratio on.
const TOO_FINE: f64 = 1.3;
/// Points that the free motion of a step makes overlap, of which half carry load in Hertz' contact; with more of them the grid is
/// made coarser by √2.
const MOST_OVERLAPPING: usize = 1000;
/// Times that the reach of the fine grid is widened at most, in a step; each time by twice as many lines of the mesh as before, so that
/// meshes with cells smaller than those of the grid hold the patch as well. The cells themselves only become finer, down to
/// [`FINEST_CELL`], or coarser.
const WIDENINGS: usize = 6;
/// Solutions that changes of the grid and of its reach may take in a step, beside those that pair again.
const GRID_CHANGES: usize = 2 * WIDENINGS;

/// What the contact of every step of a run has in common.
pub(super) struct StepContact<'m> {
    model: &'m TransientModel<'m>,
    /// Contact nodes of rail and wheel at rest, m.
    nodes: [Vec<Point2<f64>>; 2],
    friction: f64,
    time_step: f64,
    /// Half-spaces of both bodies in a step: stiffer than at rest by what the damping adds.
    half_spaces: [HalfSpace; 2],
    /// What the matrices of the flexibilities of both bodies are beyond half-spaces; all steps of one length have the same.
    beyond: OnceCell<[BeyondHalfSpace; 2]>,
    /// What a damped near field keeps of its displacement and of its velocity (s).
    kept: [f64; 2],
    /// The fine grid of the last contact, and where its far field was made.
    made: RefCell<Option<(Arc<FineContact>, MadeAt)>>,
    /// Those of the last contact on a fine grid.
    factors: RefCell<Factors>,
}

impl<'m> StepContact<'m> {
    pub fn new(model: &'m TransientModel<'m>, scenario: &Scenario, scheme: &Newmark) -> Self {
        let damping = model.damping();
        let stiffening = 1.0 + damping * scheme.velocity;
        let [rail, wheel] = &model.materials;
        let half_spaces = [HalfSpace::new(rail, Side::Base), HalfSpace::new(wheel, Side::Opposing)]
            .map(|body| HalfSpace { shear_modulus: stiffening * body.shear_modulus, ..body });
        let kept = [damping * scheme.velocity / stiffening, damping / stiffening];
        let nodes = [&model.rail_surface, &model.wheel_surface]
            .map(|surface| (0..surface.grid.nodes.len()).map(|node| surface.node(node)).collect());
        Self {
            model,
            nodes,
            friction: scenario.friction,
            time_step: scheme.step(),
            half_spaces,
            beyond: OnceCell::new(),
            kept,
            made: RefCell::default(),
            factors: RefCell::default(),
        }
    }

    fn directions(&self) -> usize {
        if self.friction > 0.0 { 3 } else { 1 }
    }

    /// Solves the contact at the end of a step, pairing again until the bodies stay where they were paired. The hub is expected
    /// to come to `predicted`.
    pub fn solve(
        &self,
        bodies: [&Interface; 2],
        predicted: &Vector2<f64>,
        last: &LastContact,
    ) -> Result<LastContact> {
        let (settled, step) = (last.settled.as_ref(), self.time_step);
        let expected =
            settled.map_or(Places::of_hub(predicted), |settled| settled.expected(*predicted, step));
        let first = settled.map_or(expected, |settled| settled.corrected(&expected, step));
        let (solved, end) = match self.model.field.is_fine() {
            true => self.on_fine_grid(bodies, first, last),
            false => self.between_nodes(bodies, first, last),
        }?;
        let settled = Settled::new(&end.places, &expected, &end.hub, step, settled);
        Ok(LastContact { settled: Some(settled), earlier: last.carried(), ..solved })
    }

    /// Spacing of the fine grid over the one that a patch at rest asks for.
    fn spacing(&self) -> f64 {
        WIDER * self.model.field.spacing()
    }

    fn surfaces_at_rest(&self) -> [&Surface<'m>; 2] {
        [&self.model.rail_surface, &self.model.wheel_surface]
    }

    /// Where the bodies are at the end of the step under the forces of `contact`, around its patch or the last there was; before any
    /// contact the wheel is where its hub is.
    fn end_under(&self, [rail, wheel]: [&Interface; 2], contact: &LastContact) -> End {
        let loaded = |side, body: &Interface| -> Vec<(usize, f64)> {
            let forces = contact.nodal_forces(side, body.free.len()).into_iter().enumerate();
            forces.filter(|(_, force)| *force != 0.0).collect()
        };
        let (on_rail, on_wheel) = (loaded(Side::Base, rail), loaded(Side::Opposing, wheel));
        let hub = wheel.hub(&on_wheel);
        let places = contact.zone.as_ref().map_or(Places::of_hub(&hub), |zone| {
            let of_rail = zone.motion(Side::Base, |nodes| rail.displacements(nodes, &on_rail));
            Places([
                self.model.rail_axis.map_or(of_rail, |axis| of_rail.about(axis)),
                zone.motion(Side::Opposing, |nodes| wheel.displacements(nodes, &on_wheel)),
            ])
        });
        End { places, hub }
    }

    /// The bodies in their `places`, with what they move beyond these without contact forces.
    fn placed(&self, places: Places, [rail, wheel]: [&Interface; 2]) -> Placed<'m> {
        let nodes = self.nodes.each_ref().map(Vec::as_slice);
        Placed::new(places, self.surfaces_at_rest(), nodes, [rail.free, wheel.free])
    }

    /// A `solved` contact with the nodes around its patch, those of the last one where it has none or after [`ZONE_LIMIT`] pairings.
    fn with_zone(&self, solved: LastContact, last: &LastContact, pairings: usize) -> LastContact {
        let forces = &solved.solution.forces[..solved.points.len()];
        let zone = match &last.zone {
            Some(zone) if pairings > ZONE_LIMIT => Some(zone.clone()),
            zone => Zone::around(self.surfaces_at_rest(), &solved.points, forces).or_else(|| zone.clone()),
        };
        LastContact { zone, ..solved }
    }

    fn between_nodes(
        &self,
        bodies: [&Interface; 2],
        mut places: Places,
        last: &LastContact,
    ) -> Result<(LastContact, End)> {
        let [rail, wheel] = bodies;
        let directions = self.directions();
        let mut start = last.clone();
        let mut moved = f64::NAN;
        for pairing in 1..=PAIRING_LIMIT {
            let placed = self.placed(places, bodies);
            let mut points = placed.pair(PAIRING_GAP);
            let gaps = placed.gaps(&points);
            let mut near = gaps.iter().map(|g| *g < CANDIDATE_MARGIN);
            points.retain(|_| near.next().unwrap_or(false));
            let mut free: Vec<f64> = gaps.into_iter().filter(|g| *g < CANDIDATE_MARGIN).collect();
            if directions == 3 {
                add_slips(&points, rail, wheel, &mut free);
            }
            let [of_rail, of_wheel] = [rail, wheel].map(|body| body.flexibility.kept());
            let compliance = self.model.enforcement.compliance(of_rail, of_wheel, &points, directions);
            let first = carry_over(&start.points, &start.solution.forces, &points, directions);
            let problem = Problem {
                points: &points,
                compliance: &compliance,
                free: &free,
                friction: self.friction,
                hub: &[],
            };
            let solution = solve(&problem, &first)?;
            let solved = LastContact { points, solution, ..LastContact::default() };
            let solved = self.with_zone(solved, &start, pairing);
            let end = self.end_under(bodies, &solved);
            moved = distance(&end.places.since(&places));
            if moved < NODE_TOLERANCE {
                return Ok((solved, end));
            }
            places = end.places;
            start = solved;
        }
        Err(failure(moved, start.solution.active(), StopReason::IterationLimit))
    }

    fn on_fine_grid(
        &self,
        bodies: [&Interface; 2],
        mut places: Places,
        last: &LastContact,
    ) -> Result<(LastContact, End)> {
        let [rail, wheel] = bodies;
        let grid = self.model.rail_surface.grid;
        let before = last.beyond_nodes(rail.before, wheel.before);
        let mut moved = f64::NAN;
        let mut previous: Option<LastContact> = None;
        let mut lattice = self.lattice_after(last);
        let mut region: Option<(Places, Vec<bool>)> = None;
        let mut widenings = 0;
        let mut coarsened = false;
        for pairing in 1..=PAIRING_LIMIT + GRID_CHANGES {
            let start = previous.as_ref().unwrap_or(last);
            let placed = self.placed(places, bodies);
            let (sought_at, near) = match region.take() {
                Some(sought) if distance(&places.since(&sought.0)) < REGION_SLIDE => sought,
                _ => (places, self.near_nodes(&placed)),
            };
            let Some(solved) = self.solve_at(&placed, bodies, (lattice, &near), start, before.as_ref())?
            else {
                coarsened = true;
                lattice = self.coarser(&lattice);
                region = Some((sought_at, near));
                continue;
            };
            let solved = self.with_zone(solved, start, pairing);
            let (points, forces) = (&solved.points, &solved.solution.forces);
            let spreads = touches_border(points, forces);
            let finer = if coarsened { None } else { self.finer(&lattice, &solved) };
            if spreads && widenings == WIDENINGS {
                if solved.edge_reached(grid).is_none() {
                    return Err(failure(moved, solved.solution.active(), StopReason::GridUnsettled));
                }
                // where the surfaces end no reach holds the patch, and the run ends there
                let end = self.end_under(bodies, &solved);
                return Ok((solved, end));
            }
            if spreads || finer.is_some() {
                lattice = finer.unwrap_or(lattice);
                let near = if spreads {
                    widenings += 1;
                    widened(&near, grid.along_track.len(), 1 << (widenings - 1))
                } else {
                    near
                };
                region = Some((sought_at, near));
                previous = Some(solved);
                continue;
            }
            let end = self.end_under(bodies, &solved);
            moved = distance(&end.places.since(&places));
            if moved < PLACE_TOLERANCE {
                return Ok((solved, end));
            }
            places = end.places;
            region = Some((sought_at, near));
            previous = Some(solved);
        }
        let active = previous.as_ref().map_or(0, |previous| previous.solution.active());
        Err(failure(moved, active, StopReason::IterationLimit))
    }

    /// What the matrices of both flexibilities are beyond half-spaces: softer by their factors, these are those of the step.
    fn beyond(&self, bodies: [&Interface; 2]) -> &[BeyondHalfSpace; 2] {
        self.beyond.get_or_init(|| {
            std::array::from_fn(|n| {
                let half_space = self.half_spaces[n];
                let shear_modulus = half_space.shear_modulus * bodies[n].flexibility.terms().factor;
                let half_space = HalfSpace { shear_modulus, ..half_space };
                BeyondHalfSpace::of_surface(self.surfaces_at_rest()[n], half_space)
            })
        })
    }

    /// The contact of the bodies in their places, on a fine grid around the nodes `near` of the rail's; `None` where a coarser
    /// grid is enough.
    fn solve_at(
        &self,
        placed: &Placed,
        [rail, wheel]: [&Interface; 2],
        (lattice, near): (Lattice, &[bool]),
        start: &LastContact,
        before: Option<&BeyondNodes>,
    ) -> Result<Option<LastContact>> {
        let known = start.fine.as_ref();
        // a start from the last step, not from the pairing before
        let going_on = start.settled.map(|_| self.time_step);
        if !near.contains(&true) {
            return Ok(Some(LastContact::open(known)));
        }
        let directions = self.directions();
        let [of_rail, of_wheel] = self.beyond([rail, wheel]);
        let solids = Solids {
            bodies: Some([
                SolidBody { compliance: rail.flexibility, beyond: of_rail },
                SolidBody { compliance: wheel.flexibility, beyond: of_wheel },
            ]),
            rail_surface: placed.surfaces[0].clone(),
            wheel_surface: placed.surfaces[1].clone(),
            half_spaces: self.half_spaces,
            mirrored: false,
        };
        let opening = |point: &ContactPoint, direction| {
            let [rail, wheel] = &placed.rest;
            point.opening(direction, [rail, wheel])
        };
        let displaced = Displaced { opening: &opening, margin: CANDIDATE_MARGIN };
        let at = MadeAt { slide: placed.places.slide(), place: rail.flexibility.place().cloned() };
        // a far field is that of steps of one length
        let made = self.made.borrow().clone();
        let serving = made.filter(|(_, made_at)| at.is_near(made_at));
        let (points, contact) = FineContact::new(
            &solids,
            lattice,
            near,
            serving.as_ref().map(|(contact, _)| &**contact),
            &displaced,
            directions,
        );
        let made_at = match &serving {
            Some((known, made_at)) if known.shares_far_field(&contact) => made_at.clone(),
            _ => at,
        };
        let contact = Arc::new(contact);
        let elsewhere = self.moved_elsewhere(rail, &made_at, (&contact, directions * points.len()), start);
        *self.made.borrow_mut() = Some((contact.clone(), made_at));
        let n = points.len();
        // in the directions of the points, which turn with the rail: what is pressed in turns with it
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
        // gaps in the places, with what the bodies move beyond them; slips since the last step
        let of_nodes = contact.motion_of_nodes(rail.free, wheel.free);
        let beyond_places = contact.motion_of_nodes(&placed.rest[0], &placed.rest[1]);
        let since_last = contact
            .motion_of_nodes(&difference(rail.free, rail.before), &difference(wheel.free, wheel.before));
        let free: Vec<f64> = (0..directions * n)
            .map(|row| match points.get(row) {
                Some(point) => point.gap + beyond_places[row] + kept[row] + elsewhere[row],
                None => since_last[row] + kept[row] - beyond_before[row] + elsewhere[row],
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
        let solution = solve_with(
            &problem,
            &start.first_forces(going_on, &lattice, &points, directions),
            &mut self.factors.borrow_mut(),
        )?;
        let displacement = (0..directions * n)
            .map(|row| of_nodes[row] + kept[row] + elsewhere[row] + solution.separation[row] - free[row])
            .collect();
        let fine = Some(Fine { contact, step: self.time_step, displacement, beyond_before });
        Ok(Some(LastContact { points, solution, fine, ..LastContact::default() }))
    }

    /// What the points open by because the rail is not where the far field was made, under the forces of `start`, m.
    fn moved_elsewhere(
        &self,
        rail: &Interface,
        made_at: &MadeAt,
        (contact, rows): (&FineContact, usize),
        start: &LastContact,
    ) -> Vec<f64> {
        let (Some(here), Some(there)) = (rail.flexibility.place(), &made_at.place) else {
            return vec![0.0; rows];
        };
        if Arc::ptr_eq(here, there) {
            return vec![0.0; rows];
        }
        let forces = start.nodal_forces(Side::Base, rail.free.len()).into_iter().enumerate();
        let forces: Vec<(usize, f64)> = forces.filter(|(_, force)| *force != 0.0).collect();
        let moved = rail.flexibility.beyond(there, &forces);
        contact.motion_of_nodes(&moved, &vec![0.0; 3 * self.nodes[1].len()])
    }

    /// The nodes of the rail's grid near which the surfaces may touch in this step.
    fn near_nodes(&self, placed: &Placed) -> Vec<bool> {
        let grid = self.model.rail_surface.grid;
        let (rows, columns) = (grid.along_profile.len(), grid.along_track.len());
        let points = placed.nodes_near(PAIRING_GAP);
        let mut gaps = vec![PAIRING_GAP; rows * columns];
        for (point, gap) in points.iter().zip(placed.gaps(&points)) {
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
            return self.lattice(self.largest());
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
        // in neither direction coarser: else two grids would want each other
        let wanted = self.lattice(self.wanted(lattice, contact).cell.inf(&lattice.cell));
        (too_coarse(lattice, across, self.spacing()) && wanted != *lattice).then_some(wanted)
    }

    /// A grid with larger cells, if there are any.
    fn coarser(&self, lattice: &Lattice) -> Lattice {
        self.lattice((lattice.cell * std::f64::consts::SQRT_2).inf(&self.largest()))
    }

    /// The grid for the patch of a `contact` on `lattice`.
    fn wanted(&self, lattice: &Lattice, contact: &LastContact) -> Lattice {
        let forces = &contact.solution.forces[..contact.points.len()];
        let finest = cell_for([f64::INFINITY; 2], self.spacing()) * FINEST_CELL;
        let cell = cell_for(widths(lattice, &contact.points, forces), self.spacing());
        self.lattice(cell.inf(&self.largest()).sup(&finest))
    }

    /// The largest cells.
    fn largest(&self) -> Vector2<f64> {
        let [at_rest, in_time] = [1.0, self.spacing()].map(|spacing| cell_for([f64::INFINITY; 2], spacing));
        Vector2::new(at_rest.x.min(in_time.x), in_time.y)
    }

    fn lattice(&self, cell: Vector2<f64>) -> Lattice {
        Lattice::over(self.model.rail_surface.grid, cell)
    }
}

/// Where a far field was made.
#[derive(Clone)]
struct MadeAt {
    /// Displacement of the wheel's surface against the rail's, m.
    slide: Vector2<f64>,
    /// Of a rail that has places.
    place: Option<Arc<AtPlace>>,
}

impl MadeAt {
    /// Whether a far field made at the other serves here.
    fn is_near(&self, other: &Self) -> bool {
        let travelled = match (&self.place, &other.place) {
            (Some(here), Some(there)) => (here.x - there.x).abs(),
            _ => 0.0,
        };
        (self.slide - other.slide).norm() < FAR_SLIDE && travelled < FAR_TRAVEL
    }
}

/// Where the bodies are at the end of a step.
struct End {
    places: Places,
    /// Displacement of the hub, m.
    hub: Vector2<f64>,
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
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
    NumericsError::new("contact of the transient solid model", reason, residual, active)
        .after(PAIRING_LIMIT)
        .into()
}
