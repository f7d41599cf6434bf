//! The contact at the end of a step, from which the next one starts.

use crate::time::energy::PartEnergy;
use nalgebra::Vector2;
use railspring_calibrate::calibration::{Change, FineContact, Places, Zone, edge_reached};
use railspring_calibrate::contact::{ContactPoint, Lattice, PointMode, Side, Solution, nodal_forces};
use railspring_calibrate::mesh::SurfaceGrid;
use railspring_profiles::error::StopReason;
use std::sync::Arc;

/// Contact of the step before, as a start for the next.
#[derive(Clone)]
pub(super) struct LastContact {
    pub points: Vec<ContactPoint>,
    pub solution: Solution,
    /// The fine grid, if it is one: that of the last contact while the wheel is in the air.
    pub fine: Option<Fine>,
    /// Nodes around the patch: those of the last contact while the wheel is in the air, none before the first.
    pub zone: Option<Zone>,
    /// Where the bodies were, once there was a step.
    pub settled: Option<Settled>,
    /// The forces a step earlier, on a fine grid.
    pub earlier: Option<Carried>,
}

/// Forces on a fine grid.
#[derive(Clone)]
pub(super) struct Carried {
    contact: Arc<FineContact>,
    points: Vec<ContactPoint>,
    forces: Vec<f64>,
}

impl Carried {
    /// Those at the places of other `points` of a `lattice`.
    fn at(&self, lattice: &Lattice, points: &[ContactPoint]) -> Vec<f64> {
        self.contact.carry_over(&self.points, &self.forces, lattice, points, 1.0)
    }
}

/// Where the bodies were at the end of a step.
#[derive(Clone, Copy)]
pub(super) struct Settled {
    /// Their places, the wheel's against its hub.
    places: Places,
    /// What these changed by in the step.
    change: Change,
    /// What the places were beyond those that were expected.
    missed: Change,
    /// Length of the step, s.
    step: f64,
}

impl Settled {
    /// After a step of the length `step` (s) in `places`, where `expected` ones were; the hub is displaced by `hub` (m), and the step
    /// `before` ended elsewhere.
    pub fn new(
        places: &Places,
        expected: &Places,
        hub: &Vector2<f64>,
        step: f64,
        before: Option<&Self>,
    ) -> Self {
        let against_hub = places.with_wheel(-hub);
        let change = before.map_or(Change::default(), |before| against_hub.since(&before.places));
        Self { places: against_hub, change, missed: places.since(expected), step }
    }

    /// Where they were, with the hub displaced by `hub` (m).
    pub fn places(&self, hub: Vector2<f64>) -> Places {
        self.places.with_wheel(hub)
    }

    /// Where they are at the end of a `step` (s) in which the hub comes to `hub` (m), and their motion against it goes on.
    pub fn expected(&self, hub: Vector2<f64>, step: f64) -> Places {
        self.places.and(&times(&self.change, step / self.step)).with_wheel(hub)
    }

    /// The `expected` places with what they missed the last time: a load that grows or falls evenly makes the same error in every step of
    /// a length, and its square counts.
    pub fn corrected(&self, expected: &Places, step: f64) -> Places {
        expected.and(&times(&self.missed, (step / self.step).powi(2)))
    }
}

fn times(change: &Change, factor: f64) -> Change {
    change.map(|(shift, angle)| (shift * factor, angle * factor))
}

/// A fine grid at the end of a step.
#[derive(Clone)]
pub(super) struct Fine {
    pub contact: Arc<FineContact>,
    /// Length of the step, s.
    pub step: f64,
    /// Displacements of the wheel against the rail at the points, by direction and point, at the end of the step, m.
    pub displacement: Vec<f64>,
    /// What of them was beyond those of the contact nodes at the beginning of the step, m.
    pub beyond_before: Vec<f64>,
}

impl Fine {
    /// What the points have moved beyond the contact nodes of the bodies, which are displaced by `rail` and `wheel` (m).
    fn beyond_nodes(&self, rail: &[f64], wheel: &[f64]) -> Vec<f64> {
        let nodes = self.contact.motion_of_nodes(rail, wheel);
        self.displacement.iter().zip(nodes).map(|(all, node)| all - node).collect()
    }
}

impl Default for LastContact {
    fn default() -> Self {
        Self::open(None)
    }
}

impl LastContact {
    /// Without contact, after the fine grid `fine`.
    pub fn open(fine: Option<&Fine>) -> Self {
        let solution = Solution {
            forces: Vec::new(),
            separation: Vec::new(),
            modes: Vec::new(),
            hub: Vec::new(),
            iterations: 0,
        };
        let fine =
            fine.map(|fine| Fine { displacement: Vec::new(), beyond_before: Vec::new(), ..fine.clone() });
        Self { points: Vec::new(), solution, fine, zone: None, settled: None, earlier: None }
    }

    /// Its forces on a fine grid, if there are any.
    pub fn carried(&self) -> Option<Carried> {
        let Fine { contact, .. } = self.fine.as_ref().filter(|_| self.solution.active() > 0)?;
        let (points, forces) = (self.points.clone(), self.solution.forces.clone());
        Some(Carried { contact: contact.clone(), points, forces })
    }

    /// Forces from which the contact of a `step` (s) starts on the `points` of a `lattice`: those of a contact in which they go on as they
    /// went in its own step, or as they are.
    pub fn first_forces(
        &self,
        step: Option<f64>,
        lattice: &Lattice,
        points: &[ContactPoint],
        directions: usize,
    ) -> Vec<f64> {
        let Some(fine) = self.fine.as_ref().filter(|_| self.solution.active() > 0) else {
            return vec![0.0; directions * points.len()];
        };
        let mut forces = fine.contact.carry_over(&self.points, &self.solution.forces, lattice, points, 1.0);
        if let (Some(step), Some(earlier)) = (step, &self.earlier) {
            let ratio = step / fine.step;
            let earlier = earlier.at(lattice, points);
            forces.iter_mut().zip(earlier).for_each(|(now, before)| *now += ratio * (*now - before));
            // none pulls
            forces.iter_mut().take(points.len()).for_each(|force| *force = force.max(0.0));
        }
        forces
    }

    /// Forces on the retained `equations` of one body, N.
    pub fn nodal_forces(&self, side: Side, equations: usize) -> Vec<f64> {
        let forces = &self.solution.forces;
        match &self.fine {
            Some(fine) if !self.points.is_empty() => fine.contact.nodal_forces(side, forces, equations),
            _ => nodal_forces(&self.points, side, forces, equations),
        }
    }

    /// Why the points that carry load are not all there are: the surface goes on beyond the edge of either grid, where there is
    /// load. `grid` is the rail's.
    pub fn edge_reached(&self, grid: &SurfaceGrid) -> Option<StopReason> {
        let forces = &self.solution.forces;
        match &self.fine {
            Some(fine) => fine.contact.edge_reached(&self.points, forces, grid),
            None => edge_reached(&self.points, forces, grid.along_track.len()),
        }
    }

    /// Energy of the near field of a fine grid, with the contact nodes displaced by `rail` and `wheel` (m), and what friction took in
    /// the step, J.
    pub fn energy(&self, rail: &[f64], wheel: &[f64]) -> PartEnergy {
        let Solution { forces, separation, modes, .. } = &self.solution;
        let n = self.points.len();
        let slides = |j: &usize| modes[j % n] == PointMode::Slip;
        let work: f64 = (n..forces.len()).filter(slides).map(|row| forces[row] * separation[row]).sum();
        let near = self.fine.as_ref().filter(|_| n > 0).map_or(0.0, |fine| {
            let beyond = fine.beyond_nodes(rail, wheel);
            0.5 * beyond.iter().zip(forces).map(|(u, f)| u * f).sum::<f64>()
        });
        PartEnergy { elastic: near, friction: work.abs(), ..PartEnergy::default() }
    }

    /// What the points of a fine grid have moved beyond the contact nodes of the bodies at the beginning of the next step, which are
    /// displaced by `rail` and `wheel` (m) there; `None` if there are none.
    pub fn beyond_nodes(&self, rail: &[f64], wheel: &[f64]) -> Option<BeyondNodes<'_>> {
        let fine = self.fine.as_ref().filter(|_| !self.points.is_empty())?;
        let displacement = fine.beyond_nodes(rail, wheel);
        let moved = displacement.iter().zip(&fine.beyond_before);
        let velocity = moved.map(|(now, before)| (now - before) / fine.step).collect();
        Some(BeyondNodes { contact: &fine.contact, points: &self.points, displacement, velocity })
    }
}

/// Displacements (m) of the points of a fine grid beyond the contact nodes, and their velocities (m/s).
pub(super) struct BeyondNodes<'c> {
    contact: &'c FineContact,
    points: &'c [ContactPoint],
    displacement: Vec<f64>,
    velocity: Vec<f64>,
}

impl BeyondNodes<'_> {
    /// Displacements and velocities at other points. Far from the patch there are none: both function spaces have the
    /// same half-space there.
    pub fn at(&self, points: &[ContactPoint]) -> [Vec<f64>; 2] {
        [&self.displacement, &self.velocity].map(|values| self.contact.values_at(self.points, values, points))
    }
}
