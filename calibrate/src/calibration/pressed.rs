//! A wheel above a rail, and its equilibrium under a load.

use super::fine::FineContact;
use super::nodal_motion::NodalMotion;
use crate::contact::{
    BeyondHalfSpace, BodyCompliance, Compliance, ComplianceOperator, ContactPoint, HalfSpace, PairingLimits,
    PenaltySprings, Problem, Side, Solution, Surface, nodal_forces, nodes_near, pair, resultant, total,
};
use crate::solid::Material;
use faer::Mat;
use nalgebra::{Unit, Vector2, Vector3};
use railspring_profiles::error::{InputError, Result, StopReason};
use railspring_profiles::field::InputField;
use std::f64::consts::SQRT_2;
use std::sync::{Arc, OnceLock};

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
    pub fn compliance(
        self,
        rail: &Mat<f64>,
        wheel: &Mat<f64>,
        points: &[ContactPoint],
        directions: usize,
    ) -> Mat<f64> {
        let rail = BodyCompliance { compliance: rail, side: Side::Base };
        let wheel = BodyCompliance { compliance: wheel, side: Side::Opposing };
        self.with([&rail, &wheel], points, directions)
    }

    /// Compliance at `points` of both `bodies` and of the penalty springs if there are any.
    fn with(
        self,
        [rail, wheel]: [&dyn Compliance; 2],
        points: &[ContactPoint],
        directions: usize,
    ) -> Mat<f64> {
        match self {
            Self::Exact => total(&[rail, wheel], points, directions),
            Self::Penalty(stiffness) => {
                total(&[rail, wheel, &PenaltySprings { stiffness }], points, directions)
            }
        }
    }
}

/// Where the contact lives, and what is elastic in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ContactField {
    /// On a fine grid that follows the patch, of 0.65 by 1 mm at most: half-spaces between its points, and the bodies beyond
    /// their half-spaces interpolated from the nodes of the meshes.
    Hybrid,
    /// As [`ContactField::Hybrid`] on a grid of half the spacing in both directions: what it changes is the error of that grid.
    HybridHalved,
    /// As [`ContactField::Hybrid`] on a grid of √2 times the spacing, for thousands of pairs: in half of them it changes displacement and tangent by less than 0.05 % and 0.12 %.
    HybridWider,
    /// On the contact nodes of the meshes, the elements alone.
    #[default]
    Elements,
}

/// Vertically down, world (y, z): how a wheel is pressed whose hub is held laterally.
pub const DOWNWARDS: Unit<Vector2<f64>> = Unit::new_unchecked(Vector2::new(0.0, 1.0));

impl ContactField {
    /// Spacing of the fine grid over the one that the patch asks for.
    pub fn spacing(self) -> f64 {
        match self {
            Self::HybridHalved => 0.5,
            Self::Hybrid | Self::Elements => 1.0,
            Self::HybridWider => SQRT_2,
        }
    }

    /// Whether it is a fine grid.
    pub fn is_fine(self) -> bool {
        self != Self::Elements
    }

    /// SOLVER: how nearly forces are found while the hub is held, for the size of a patch and for its rim: what a step of a point alone changes, over
    /// the largest force. On the wider grid, 146 wheels in five places, tangents differ by 2e-4 at most from those to 1e-6, pressures by 1e-4 and areas by
    /// 1.4e-3, and half of them by less than 5e-6.
    pub(super) fn held_to(self) -> f64 {
        if self == Self::HybridWider { 1e-4 } else { 1e-6 }
    }

    /// # Errors
    /// [`InputError`] for penalty springs on a fine grid.
    pub fn check(self, enforcement: Enforcement) -> Result<()> {
        if let (true, Enforcement::Penalty(stiffness)) = (self.is_fine(), enforcement) {
            return InputError::refuse(
                InputField::Enforcement,
                format!("penalty springs of {:e} kN/m", stiffness * 1e-3),
                "exact contact conditions on a fine grid",
                "penalty springs stand at the nodes of a mesh: choose exact conditions, or contact between elements",
            );
        }
        Ok(())
    }
}

/// What gives way below the two surfaces.
#[derive(Clone, Copy)]
pub enum Bodies<'a> {
    /// Both bodies, condensed to their contact nodes.
    Condensed {
        /// Compliance of the rail's contact nodes (`3·node + axis`), m/N: against its supports, or against its own section
        /// ([`crate::superelement::SectionMotion::relative`]).
        rail: &'a Mat<f64>,
        /// Compliance of the wheel's contact nodes against its hub, m/N.
        wheel: &'a Mat<f64>,
        /// Whether both are their own mirror images along the track.
        mirrored: bool,
    },
    /// Half-spaces of the two materials alone, as half-space programs have them: rim and head neither roll nor bend.
    HalfSpaces,
}

/// A wheel above a rail.
pub struct WheelOnRail<'a> {
    /// What gives way below the two surfaces.
    pub bodies: Bodies<'a>,
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
    /// Direction in world (y, z) along which the wheel is pressed and its hub is free; across it, the hub is held.
    pub along: Unit<Vector2<f64>>,
    /// What rail and wheel are beyond their half-spaces. Left empty, it is that of bodies with these surfaces.
    pub beyond: OnceLock<[Arc<BeyondHalfSpace>; 2]>,
}

/// Equilibrium under one load.
pub struct Pressed {
    /// Load along the direction in which the wheel is pressed, N.
    pub load: f64,
    /// Displacement of the wheel's hub from just touching (y, z), m.
    pub hub: Vector2<f64>,
    /// Contact points at the final position.
    pub points: Vec<ContactPoint>,
    /// Gaps and slips without contact forces.
    pub free: Vec<f64>,
    /// Forces and modes.
    pub solution: Solution,
    /// Answer of the linearised contact to a motion of the hub along the direction in which the wheel is pressed; none where it has none.
    pub(super) answer: Option<Answer>,
    pub(super) elasticity: Elasticity,
    /// Displacements of the contact nodes of rail and wheel relative to the bodies' supports, once they are asked for.
    pub(super) motions: OnceLock<[NodalMotion; 2]>,
    /// Nodes of the rail's grid near the wheel, with their gaps under the load, m, once they are asked for.
    pub(super) node_gaps: OnceLock<Vec<((usize, usize), f64)>>,
}

/// Answer of the linearised contact to a motion of the hub along the direction in which the wheel is pressed.
pub(super) struct Answer {
    /// N/m.
    pub stiffness: f64,
    /// Change of the contact forces (rows as in the compliance), N/m.
    pub forces: Vec<f64>,
    /// Change of the gaps of the points, m/m.
    pub rates: Vec<f64>,
}

/// Compliance of the contact points.
pub(super) enum Elasticity {
    Elements(Mat<f64>),
    Hybrid(Box<FineContact>),
}

impl Elasticity {
    pub fn operator(&self) -> &dyn ComplianceOperator {
        match self {
            Self::Elements(matrix) => matrix,
            Self::Hybrid(fine) => fine.operator(),
        }
    }
}

/// The reason why the points that carry load are not the whole patch. The patch of `forces` reaches the end
/// of the contact window along the track, or the end of the contact zone on a profile. The grid has `columns`
/// lines along the track. The window of the wheel, equal in angle, may end within its last cells.
pub fn edge_reached(points: &[ContactPoint], forces: &[f64], columns: usize) -> Option<StopReason> {
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

    /// The direction in which the wheel is pressed, in world axes.
    pub fn world_direction(&self) -> Unit<Vector3<f64>> {
        Unit::new_unchecked(Vector3::new(0.0, self.along.x, self.along.y))
    }

    /// Compliance of both bodies and the penalty springs at `points`.
    pub fn compliance(&self, points: &[ContactPoint], directions: usize) -> Mat<f64> {
        match self.bodies {
            Bodies::Condensed { rail, wheel, .. } => {
                self.enforcement.compliance(rail, wheel, points, directions)
            }
            Bodies::HalfSpaces => {
                let [rail, wheel] = self.half_spaces();
                self.enforcement.with([&rail, &wheel], points, directions)
            }
        }
    }

    /// Half-spaces of the materials of rail and wheel.
    pub fn half_spaces(&self) -> [HalfSpace; 2] {
        let [rail, wheel] = &self.materials;
        [HalfSpace::new(rail, Side::Base), HalfSpace::new(wheel, Side::Opposing)]
    }

    /// What rail and wheel are beyond their half-spaces.
    pub(super) fn beyond(&self) -> [&BeyondHalfSpace; 2] {
        let [rail, wheel] = self.beyond.get_or_init(|| {
            let [rail, wheel] = self.half_spaces();
            [(&self.rail_surface, rail), (&self.wheel_surface, wheel)]
                .map(|(surface, half_space)| Arc::new(BeyondHalfSpace::of_surface(surface, half_space)))
        });
        [rail, wheel]
    }

    /// Contact points with the hub displaced by `hub` from just touching.
    pub fn points_at(&self, hub: &Vector2<f64>, largest_gap: f64) -> Vec<ContactPoint> {
        pair(&self.rail_surface, &self.wheel_surface.moved(hub), PairingLimits { largest_gap })
    }

    /// As [`Self::points_at`], with the gaps at the nodes themselves.
    pub(super) fn nodes_near(&self, hub: &Vector2<f64>, largest_gap: f64) -> Vec<ContactPoint> {
        nodes_near(&self.rail_surface, &self.wheel_surface.moved(hub), PairingLimits { largest_gap })
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

    /// Displacement in a direction of the wheel's surface against the rail's at a point of the contact grid, m. That of half-spaces is left out: pressure only widens the
    /// gap, so that points sought without it are more than needed.
    pub(super) fn opening(&self, placed: &WheelOnRail, point: &ContactPoint, direction: usize) -> f64 {
        let Bodies::Condensed { rail, wheel, mirrored } = placed.bodies else { return 0.0 };
        let [of_rail, of_wheel] = self.motions.get_or_init(|| {
            let of = |body: &Mat<f64>, side, surface: &Surface| {
                let columns = surface.grid.along_track.len();
                NodalMotion::new(self.body_forces(side, body.nrows()), columns, mirrored)
            };
            [of(rail, Side::Base, &placed.rail_surface), of(wheel, Side::Opposing, &placed.wheel_surface)]
        });
        of_wheel.at(wheel, point, Side::Opposing, direction) - of_rail.at(rail, point, Side::Base, direction)
    }

    /// Gaps at `points` of the rail's contact nodes, m, with the elastic displacements of this state.
    pub(super) fn gaps_at(&self, bodies: &WheelOnRail, points: &[ContactPoint]) -> Vec<f64> {
        points.iter().map(|point| point.gap + self.opening(bodies, point, 0)).collect()
    }

    /// How far the hub would be pressed along its direction under another `load`, N, m: a power of the load, with the slope that the linearised contact has here.
    pub(super) fn way_under(&self, load: f64, along: &Vector2<f64>) -> f64 {
        /// Of the approach between Hertz' exponent and that of a linear spring, where the contact has no slope.
        const BETWEEN: f64 = 0.75;
        let way = self.hub.dot(along);
        let slope = self.answer.as_ref().map(|answer| self.load / (way * answer.stiffness));
        let exponent = slope.filter(|slope| (0.5..=1.0).contains(slope)).unwrap_or(BETWEEN);
        way * (load / self.load).powf(exponent)
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
pub fn carry_over(from: &[ContactPoint], forces: &[f64], to: &[ContactPoint], directions: usize) -> Vec<f64> {
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
