//! The contacts of two wheels on one axle, each with its element on its own rail.
//!
//! Each side is treated as a right one: direction 1 is towards its own field side, so that both sides are the same element, and the mirror image of a step has
//! the same numbers with the sides exchanged, to the last bit. The axle is rigid; it moves across the track, up and down, and rolls.

use std::cell::Cell;

use nalgebra::{Point2, Rotation2, SVector, Vector2, Vector3};

use crate::time::history::{ContactState, Ending};
use railspring_profiles::error::Result;
use railspring_profiles::placement::{Departure, PlacedRail};
use railspring_profiles::profile::ProfileCurve;

use super::departure::Outline;
use super::element::to_plane;
use super::interface::Interface;
use super::run::{contacts_of, rail_nodes, surface_of};
use super::solve::{Mount, OWN, Solution, Solved, StepSystem, Surroundings};
use super::surface::{ActiveNode, ContactLaw, ContactSurface, SlidingMatrix};
use super::wheel::WheelSprings;

/// Unknowns of a step: those of both wheels, and the axle's rotation and displacements.
const UNKNOWNS: usize = 2 * OWN + 3;

/// Evaluations of the contacts that a step may take before it is done in shorter ones.
const EVALUATIONS_A_TRY: usize = 400;
/// And with the friction limits of its start, which always settles.
const EVALUATIONS_IN_THE_END: usize = 4000;

/// A step moves the wheels no farther beyond their predicted motion before the rail nodes are listed again, m: most steps do not.
const SPARE: f64 = 4e-6;

/// A wheel of a wheelset on its rail, as on the right side of the track: y to the field side, z down.
#[derive(Debug, Clone)]
pub struct WheelsetSide {
    /// The rail in the track.
    pub rail: PlacedRail,
    /// Where the node line of its beam passes the plane of the profile, m.
    pub node_line: Point2<f64>,
    /// Running surface of the wheel, profile frame.
    pub wheel: ProfileCurve,
    /// Rolling radius at the tape circle, m.
    pub wheel_radius: f64,
    /// Place (y, z) of the wheel profile's origin where the wheel just touches, m.
    pub tape: Point2<f64>,
    /// From the middle of the axle to the wheel's tape circle, m.
    pub arm: f64,
    /// Springs between wheel and contact.
    pub springs: WheelSprings,
}

/// The contacts of a wheelset with two rails.
#[derive(Debug, Clone)]
pub struct WheelsetContact {
    /// The right side, then the left one.
    pub sides: [WheelsetSide; 2],
    /// Coulomb's coefficient.
    pub friction: f64,
    /// Penalty constant of each contact node, N/m.
    pub penalty: f64,
    /// Distance of the rail nodes along the profile, m.
    pub node_spacing: f64,
}

/// What a wheel does on its rail at the end of a step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WheelContact {
    /// Vertical force on the rail, N, positive down.
    pub vertical_force: f64,
    /// Lateral force on the rail, N, positive towards the field side.
    pub lateral_force: f64,
    /// How far the flange's tip is above the rail's highest point, m; negative for a flange that guides.
    pub tip_height: f64,
    /// The contacts, from the gauge side to the field side.
    pub contacts: Vec<ContactState>,
}

/// How a wheel came off its rail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Derailment {
    /// Its flange has gone over the rail's top; the wheel carried load when it had risen by half of the flange.
    Climbed,
    /// Its flange has gone over the rail's top; the wheel was in the air when it had risen by half of the flange.
    Lifted,
    /// Its tread has slid off the rail's head into the track.
    Dropped,
    /// The wheelset has turned over on the other rail.
    Overturned,
}

/// Wheels on their rails, with what they remember of the last step.
pub(crate) struct AxleContacts<'a> {
    model: &'a WheelsetContact,
    law: ContactLaw,
    nodes: [Vec<(f64, Point2<f64>)>; 2],
    surfaces: [ContactSurface<'a>; 2],
    outlines: [Outline; 2],
    tips: [Tip; 2],
    mounts: [Mount; 2],
    x: SVector<f64, UNKNOWNS>,
    forces: [f64; 2],
    limits: [Vec<f64>; 2],
    /// Of wheels that have risen by half of their flange: how.
    risen: [Option<Derailment>; 2],
}

/// The lowest point of a flange and the highest of a rail, from wheel centre and rail's master at rest, in directions 1 and 2, m.
struct Tip {
    flange: Vector2<f64>,
    top: Vector2<f64>,
    /// From the rail's master to the wheel centre at rest.
    centre: Vector2<f64>,
}

/// A solved step of a wheelset.
pub(crate) struct AxleStep {
    solved: Solved<2, UNKNOWNS>,
    /// On the sections of the rails, each in directions 1, 2 and moment 3 of its side.
    pub on_rails: [Vector3<f64>; 2],
    /// On the axle, in directions 1, 2 and moment 3 of the right side.
    pub on_axle: Vector3<f64>,
}

impl AxleStep {
    /// Displacement of the axle in directions 1, 2 and rotation 3 of the right side.
    pub fn axle(&self) -> Vector3<f64> {
        let x = &self.solved.x;
        Vector3::new(x[2 * OWN + 1], x[2 * OWN + 2], x[2 * OWN])
    }

    /// Displacement of the section of a rail in directions 1, 2 and rotation 3 of its side, with what lies between section and running surface.
    pub fn rail(&self, side: usize) -> Vector3<f64> {
        self.solved.wheels[side].pose.fixed_rows::<3>(2).into_owned()
    }

    /// Iterations.
    pub fn iterations(&self) -> usize {
        self.solved.wheels[0].iterations
    }
}

/// How a step is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Friction {
    /// With Coulomb friction of the normal forces at its end.
    Coulomb,
    /// With those of its start, for a step that is short.
    OfTheStart,
    /// Without friction.
    None,
}

impl WheelsetContact {
    /// The wheels where they just touch.
    pub(crate) fn contacts(&self) -> AxleContacts<'_> {
        let law = ContactLaw {
            penalty: self.penalty,
            friction: self.friction,
            frictionless: None,
            sliding: SlidingMatrix::Consistent,
        };
        let nodes = self.sides.each_ref().map(|side| rail_nodes(&side.rail, self.node_spacing));
        let surfaces = std::array::from_fn(|i| {
            let WheelsetSide { rail, node_line, wheel, wheel_radius, tape, .. } = &self.sides[i];
            surface_of(rail, &nodes[i], *node_line, (wheel, *wheel_radius, *tape)).sparing(SPARE)
        });
        let outlines = std::array::from_fn(|i| {
            let WheelsetSide { rail, node_line, wheel, wheel_radius, tape, .. } = &self.sides[i];
            Outline::new(rail, (wheel, *wheel_radius, *tape), *node_line, &nodes[i])
        });
        let mounts = [(1.0, &self.sides[0]), (-1.0, &self.sides[1])];
        let limits = nodes.each_ref().map(|nodes| vec![0.0; nodes.len()]);
        AxleContacts {
            model: self,
            law,
            surfaces,
            outlines,
            tips: self.sides.each_ref().map(Tip::new),
            mounts: mounts.map(|(side, of)| Mount { side, arm: of.arm }),
            x: SVector::zeros(),
            forces: [0.0; 2],
            limits,
            nodes,
            risen: [None; 2],
        }
    }
}

impl Tip {
    fn new(side: &WheelsetSide) -> Self {
        let lower = |a: &Point2<f64>, b: &Point2<f64>| a.y.total_cmp(&b.y);
        // a curve has knots
        let flange = side.wheel.knot_points().max_by(lower).unwrap_or_default();
        let top = side.rail.curve.knot_points().min_by(lower).unwrap_or_default();
        let to_axle = Vector2::new(0.0, side.wheel_radius);
        Self {
            flange: to_plane(flange.coords + to_axle),
            top: to_plane(top - side.node_line),
            centre: to_plane(side.tape - to_axle - side.node_line),
        }
    }

    /// From the rail's highest point to the flange's lowest.
    fn over(&self, Solution { pose, centre, .. }: &Solution) -> Vector2<f64> {
        let flange = self.centre + centre + Rotation2::new(pose[5]) * self.flange;
        flange - (pose.fixed_rows::<2>(2) + Rotation2::new(pose[4]) * self.top)
    }
}

impl AxleContacts<'_> {
    /// Puts the axle at a displacement (directions 1, 2 and rotation 3 of the right side) from where it just touches, the contacts along with it.
    pub fn place(&mut self, axle: Vector3<f64>) {
        self.x.fixed_rows_mut::<3>(2 * OWN).copy_from(&Vector3::new(axle.z, axle.x, axle.y));
        for (wheel, mount) in self.mounts.into_iter().enumerate() {
            let moved = mount.moved(&Vector3::new(axle.z, axle.x, axle.y));
            self.x.fixed_rows_mut::<2>(OWN * wheel).copy_from(&moved.fixed_rows::<2>(1));
        }
    }

    /// A step on `rails`, each in the directions of its side, with the axle as `body`. No wheel moves farther than `reach` (m); `load` (N) is the size of the
    /// forces at work.
    ///
    /// # Errors
    /// [`NumericsError`](railspring_profiles::error::NumericsError) for a step that does not settle.
    pub fn step(
        &mut self,
        rails: [Interface; 2],
        body: Interface,
        (reach, load): (f64, f64),
        friction: Friction,
    ) -> Result<AxleStep> {
        let law = match friction {
            Friction::None => ContactLaw { friction: 0.0, ..self.law },
            _ => self.law,
        };
        let evaluations = Cell::new(match friction {
            Friction::Coulomb => EVALUATIONS_A_TRY,
            _ => EVALUATIONS_IN_THE_END,
        });
        let start_limits = match friction {
            Friction::None => self.limits.each_ref().map(|limits| vec![0.0; limits.len()]),
            _ => self.limits.clone(),
        };
        let system = StepSystem {
            springs: self.model.sides.each_ref().map(|side| &side.springs),
            law: &law,
            surroundings: Surroundings { rails, body },
            mounts: self.mounts,
            load,
            start: self.x,
            start_force: self.forces,
            start_limits,
            evaluations_left: &evaluations,
        };
        for (wheel, surface) in self.surfaces.iter_mut().enumerate() {
            surface.list(&system.pose(&self.x, wheel), reach);
        }
        let solved = match friction {
            Friction::OfTheStart => system.solve_with_last_limits(&mut self.surfaces)?,
            _ => system.solve(&mut self.surfaces)?,
        };
        let (on_rails, on_axle) = system.surroundings.forces(&solved.x);
        Ok(AxleStep { solved, on_rails, on_axle })
    }

    /// Makes a step the last one.
    pub fn commit(&mut self, step: &AxleStep) {
        self.x = step.solved.x;
        for (wheel, solution) in step.solved.wheels.iter().enumerate() {
            self.surfaces[wheel].commit(&solution.pose, &solution.active);
            self.risen[wheel] = self.risen(wheel, solution);
            self.forces[wheel] = solution.spring_force.y;
            self.limits[wheel].fill(0.0);
            for ActiveNode { node, normal_force, .. } in &solution.active {
                self.limits[wheel][*node] = self.law.friction * normal_force;
            }
        }
    }

    /// How a wheel has risen by half of its flange, if it has.
    fn risen(&self, wheel: usize, solution: &Solution) -> Option<Derailment> {
        let now = if solution.active.is_empty() { Derailment::Lifted } else { Derailment::Climbed };
        let tip = &self.tips[wheel];
        let at_rest = tip.centre + tip.flange - tip.top;
        (tip.over(solution).y > 0.5 * at_rest.y).then(|| self.risen[wheel].unwrap_or(now))
    }

    /// What the wheels do at the end of a step.
    pub fn seen(&self, step: &AxleStep) -> [WheelContact; 2] {
        std::array::from_fn(|wheel| {
            let solution = &step.solved.wheels[wheel];
            let on_rail = to_plane(solution.on_rail().xy());
            WheelContact {
                vertical_force: on_rail.y,
                lateral_force: on_rail.x,
                tip_height: self.tips[wheel].over(solution).y,
                contacts: contacts_of(&self.nodes[wheel], &self.model.sides[wheel].wheel, &solution.active),
            }
        })
    }

    /// The wheel that is off its rail at the end of a step (0 the right one), and how it came there; an end of a profile that is too short.
    pub fn derailed(
        &self,
        step: &AxleStep,
        time: f64,
    ) -> Option<(usize, std::result::Result<Derailment, Ending>)> {
        let wheels = &step.solved.wheels;
        let carried = |wheel: usize| self.risen(wheel, &wheels[wheel]).unwrap_or(Derailment::Climbed);
        let over = |wheel: usize| {
            let off = self.tips[wheel].over(&wheels[wheel]);
            (off.x >= 0.0 && off.y > -SUNK).then(|| (wheel, Ok(carried(wheel))))
        };
        let beside = |wheel: usize| {
            let ending = self.outlines[wheel].ending_beyond(NEAR, &wheels[wheel], time)?;
            let Ending::Departed { departure, .. } = ending else { return Some((wheel, Err(ending))) };
            // where one wheel goes into the track, the other one's flange goes over its rail
            let other = 1 - wheel;
            let raised = self.tips[other].over(&wheels[other]).y > -SUNK;
            Some(match departure {
                Departure::FieldSide => (wheel, Ok(carried(wheel))),
                _ if raised => (other, Ok(carried(other))),
                _ => (wheel, Ok(Derailment::Dropped)),
            })
        };
        let roll = step.axle().z;
        // direction 3 raises the right side
        let turned = (roll.abs() > OVERTURNED).then(|| (usize::from(roll < 0.0), Ok(Derailment::Overturned)));
        turned.or_else(|| (0..2).find_map(over)).or_else(|| (0..2).find_map(beside))
    }
}

/// A wheel that has moved less against its rail is still over it, m; no profile is so narrow.
const NEAR: f64 = 10e-3;

/// A wheelset that rolls farther does not come back, rad: it stands on one wheel with the other one half a metre up.
const OVERTURNED: f64 = 0.35;

/// A flange on the top of a rail is pressed into it by less, m.
const SUNK: f64 = 5e-3;
