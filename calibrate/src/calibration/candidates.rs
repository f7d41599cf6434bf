//! Where contact is sought while a load settles: the nodes of the rail's mesh, or the points of a fine grid.

use super::far_field::{SolidBody, Solids};
use super::fine::{Displaced, FineContact, points_around};
use super::grid::{cell_for, first_forces, rim_gap, too_coarse, touches_border, widths};
use super::pressed::{Bodies, Elasticity, Pressed, WheelOnRail, carry_over};
use crate::contact::{ContactPoint, Lattice, widened};
use nalgebra::Vector2;

/// Rigid gap within which points are candidates while nothing is known of the elastic displacements, m.
const FIRST_GAP: f64 = 0.15e-3;
/// Rigid gap within which points are paired at all, m: bodies that roll under the load close less of it.
const PAIRING_GAP: f64 = 0.5e-3;
/// Points farther apart than this under the forces of the last pairing are no candidates, m: what the forces
/// may still change, and the bulging beside a patch.
const CANDIDATE_MARGIN: f64 = 20e-6;
/// Changes of the fine grid and its reach at most, while a load settles.
const GRID_CHANGES: usize = 8;
/// Of the gap at the rim of a patch, what its neighbourhood must have at most to be in reach.
const REACH: f64 = 2.0;
/// Of that gap, what it may be at most under a load from which the next one is reached.
const FARTHEST_REACH: f64 = 4.0;
/// The same of the gaps of rigid bodies, which are half a wheel's way down wider at the rim.
const FIRST_REACH: f64 = 4.0;

/// Points between which contact is sought, their compliance, and forces to start from.
pub(super) struct Candidates {
    pub points: Vec<ContactPoint>,
    pub elasticity: Elasticity,
    pub start: Vec<f64>,
}

/// Grid and reach of a fine contact while a load settles.
#[derive(Default)]
pub(super) struct FinePlan<'a> {
    chosen: Option<(Lattice, Vec<bool>)>,
    changes: usize,
    first_far: FirstFar<'a>,
}

/// From which state the far field of a first pairing may be.
#[derive(Default)]
enum FirstFar<'a> {
    /// From the one that the iteration starts at.
    #[default]
    Start,
    /// From another one or from none, as the start is one of another pair.
    Other(Option<&'a Pressed>),
}

impl<'a> FinePlan<'a> {
    /// That of an iteration from a state of another pair; `of_this` is a state of this one.
    pub fn beside(of_this: Option<&'a Pressed>) -> Self {
        Self { first_far: FirstFar::Other(of_this), ..Self::default() }
    }

    /// Whether the iteration starts from a state of the same pair.
    pub fn is_from_start(&self) -> bool {
        matches!(self.first_far, FirstFar::Start)
    }
}

impl WheelOnRail<'_> {
    /// The contact nodes of the rail's mesh near the wheel.
    pub(super) fn element_candidates(
        &self,
        hub: &Vector2<f64>,
        previous: Option<&Pressed>,
        near: Option<&Pressed>,
    ) -> Candidates {
        let points = match previous {
            None => self.first_near(|gap| self.points_at(hub, gap)),
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

    /// The contact nodes of the rail's mesh that are near the wheel before anything is known of the displacements; `within` has those whose gap is smaller than one, m.
    fn first_near(&self, within: impl Fn(f64) -> Vec<ContactPoint>) -> Vec<ContactPoint> {
        // long elements on a sharp curve lie farther from the first touch
        [FIRST_GAP, PAIRING_GAP].map(within).into_iter().find(|points| !points.is_empty()).unwrap_or_default()
    }

    /// Both bodies, the hub displaced by `hub`.
    pub(super) fn solids(&self, hub: &Vector2<f64>) -> Solids<'_> {
        Solids {
            bodies: match self.bodies {
                Bodies::Condensed { rail, wheel, .. } => {
                    let [beyond_rail, beyond_wheel] = self.beyond();
                    Some([
                        SolidBody { compliance: rail, beyond: beyond_rail },
                        SolidBody { compliance: wheel, beyond: beyond_wheel },
                    ])
                }
                Bodies::HalfSpaces => None,
            },
            mirrored: matches!(self.bodies, Bodies::Condensed { mirrored: true, .. }),
            rail_surface: self.rail_surface.clone(),
            wheel_surface: self.wheel_surface.moved(hub),
            half_spaces: self.half_spaces(),
        }
    }

    /// The points of a fine grid where `plan` wants them; where it has no plan yet, by the state `last`.
    pub(super) fn fine_candidates(
        &self,
        hub: &Vector2<f64>,
        load: f64,
        last: Option<&Pressed>,
        plan: &mut FinePlan<'_>,
    ) -> Candidates {
        let solids = self.solids(hub);
        let directions = self.directions();
        let known = last.and_then(|last| Some((last, last.fine()?)));
        // what share of its state the bodies give way by, and how near points must then be
        let (share, margin) = match known {
            Some((last, fine)) => {
                // patch and approach grow as on Hertz' ellipses, and the bodies give way as the hub does
                let growth = (load / last.load).cbrt();
                let higher = growth.max(1.0).powi(2);
                if plan.chosen.is_none() {
                    let across = widths(&fine.lattice, &last.points, &last.solution.forces);
                    let region = match plan.first_far {
                        FirstFar::Start => self.region(last, higher),
                        // the cached gaps are those of the other pair
                        FirstFar::Other(_) => self.region_of(last, &self.node_gaps(last), higher),
                    };
                    plan.chosen = Some((self.lattice(across.map(|w| w * growth)), region));
                }
                let [way, before] = [hub, &last.hub].map(|hub| hub.dot(&self.along));
                (if before == 0.0 { 1.0 } else { way / before }, higher * self.reach(last))
            }
            None => {
                let (lattice, region, margin) = self.first_plan(hub, load, &solids);
                plan.chosen = Some((lattice, region));
                (0.0, margin)
            }
        };
        let opening = |point: &ContactPoint, direction: usize| {
            known.map_or(0.0, |(last, _)| share * last.opening(self, point, direction))
        };
        let displaced = Displaced { opening: &opening, margin };
        let (lattice, region) = plan.chosen.as_ref().expect("chosen above");
        let known_fine = match std::mem::take(&mut plan.first_far) {
            FirstFar::Start => known.map(|(_, fine)| fine),
            FirstFar::Other(of_this) => of_this.and_then(Pressed::fine),
        };
        let known_fine = known_fine.filter(|fine| fine.is_near(&solids));
        let (points, fine) = FineContact::new(&solids, *lattice, region, known_fine, &displaced, directions);
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

    /// Grid and reach, and the gap within which points are sought, m, where nothing is known but the gaps with the hub displaced by
    /// `hub`: those of the forces to start from on the coarsest grid.
    fn first_plan(&self, hub: &Vector2<f64>, load: f64, solids: &Solids) -> (Lattice, Vec<bool>, f64) {
        let nodes = self.first_near(|gap| self.nodes_near(hub, gap));
        let all = self.marked(nodes.iter().map(|point| point.index));
        let coarsest = self.lattice([f64::INFINITY; 2]);
        let points = points_around(&all, &coarsest, solids);
        let forces = first_forces(&solids.half_spaces, &points, load);
        let carrying = points.iter().zip(&forces).filter(|(_, force)| **force > 0.0);
        let rim = carrying.map(|(point, _)| point.gap).fold(0.0, f64::max);
        let margin = FIRST_REACH * rim;
        let near = nodes.iter().filter(|point| point.gap < margin).map(|point| point.index);
        let mut region = self.marked(near);
        self.mark_patch(&points, &forces, &mut region);
        (self.lattice(widths(&coarsest, &points, &forces)), region, margin)
    }

    /// Changes the `plan` of a fine contact where the `state` shows that grid or reach do not suit it; whether it did.
    pub(super) fn revise(&self, plan: &mut FinePlan<'_>, state: &Pressed, settled: bool) -> bool {
        let Some((lattice, region)) = &mut plan.chosen else { return false };
        if plan.changes == GRID_CHANGES {
            return false;
        }
        let columns = self.rail_surface.grid.along_track.len();
        let forces = &state.solution.forces[..state.points.len()];
        let across = widths(lattice, &state.points, forces);
        let wanted = self.lattice(across);
        let spreads = touches_border(&state.points, forces);
        if spreads
            || (plan.changes == 0 && wanted != *lattice)
            || too_coarse(lattice, across, self.field.spacing())
        {
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

    /// The grid for a patch of the widths `across`, m.
    fn lattice(&self, across: [f64; 2]) -> Lattice {
        Lattice::over(self.rail_surface.grid, cell_for(across, self.field.spacing()))
    }

    /// Marks among the nodes of the rail's grid.
    fn marked(&self, nodes: impl Iterator<Item = (usize, usize)>) -> Vec<bool> {
        let grid = self.rail_surface.grid;
        let mut marks = vec![false; grid.along_profile.len() * grid.along_track.len()];
        nodes.for_each(|(i, k)| marks[i * grid.along_track.len() + k] = true);
        marks
    }

    /// Points farther apart than this with the displacements of a state are out of the reach of its contact, m.
    fn reach(&self, state: &Pressed) -> f64 {
        let carrying = state.points.iter().zip(&state.solution.forces).filter(|(_, force)| **force > 0.0);
        let area: f64 = carrying.map(|(point, _)| point.area).sum();
        (REACH * rim_gap(&self.half_spaces(), state.load, area)).min(CANDIDATE_MARGIN)
    }

    /// The nodes of the rail's grid that are near the wheel with the displacements of a state: as near as the contact of its
    /// load may reach, times `part`; with 0, those where the surfaces overlap.
    fn region(&self, state: &Pressed, part: f64) -> Vec<bool> {
        self.region_of(state, state.node_gaps.get_or_init(|| self.node_gaps(state)), part)
    }

    /// The nodes of the rail's grid near the wheel, with their gaps with the displacements of a state, m. Elastic bodies close less of a gap beside the patch than the hub's way.
    fn node_gaps(&self, state: &Pressed) -> Vec<((usize, usize), f64)> {
        let way = state.hub.dot(&self.along).abs();
        let points = self.nodes_near(&state.hub, (FARTHEST_REACH * self.reach(state) + way).min(PAIRING_GAP));
        let gaps = state.gaps_at(self, &points);
        points.iter().zip(gaps).map(|(point, gap)| (point.index, gap)).collect()
    }

    /// As [`Self::region`], with the gaps of nodes near the wheel.
    fn region_of(&self, state: &Pressed, gaps: &[((usize, usize), f64)], part: f64) -> Vec<bool> {
        let forces = &state.solution.forces[..state.points.len()];
        let margin = part * self.reach(state);
        let near = gaps.iter().filter(|(_, gap)| *gap < margin).map(|(index, _)| *index);
        let mut marks = self.marked(near);
        if part > 0.0 {
            self.mark_patch(&state.points, forces, &mut marks);
        }
        marks
    }

    /// Marks the nodes around points that carry load, which may lie between nodes.
    fn mark_patch(&self, points: &[ContactPoint], forces: &[f64], marks: &mut [bool]) {
        let grid = self.rail_surface.grid;
        let columns = grid.along_track.len();
        let line = |axis: &[f64], at: f64| axis.partition_point(|a| *a <= at).clamp(1, axis.len() - 1) - 1;
        for (point, _) in points.iter().zip(forces).filter(|(_, force)| **force > 0.0) {
            let (i, k) =
                (line(&grid.along_profile, point.position.x), line(&grid.along_track, point.position.y));
            for node in [i * columns + k, (i + 1) * columns + k] {
                marks[node] = true;
                marks[node + 1] = true;
            }
        }
    }
}
