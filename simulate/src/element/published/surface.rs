//! Rail nodes on the cubic-spline wheel: pairing, forces and their tangent.

use nalgebra::{Matrix2, Point2, Rotation2, SMatrix, SVector, Vector2};

use crate::time::energy::PartEnergy;
use crate::time::history::ContactMode;
use railspring_profiles::profile::ProfileCurve;

use super::element::{
    contact_stiffness, master_slave, master_stiffness, mode_check, normal_displacement, plane_stiffness,
    rotation, sticking_force, symmetric_sliding_stiffness, tangential_increment, two_node_stiffness,
};

mod underside;

use underside::Underside;

pub(super) type Vector6 = SVector<f64, 6>;
pub(super) type Matrix6 = SMatrix<f64, 6, 6>;

/// Displacements of the masters: B1, B2, C1, C2, rotation C, rotation B.
pub(super) type Pose = Vector6;

/// Iteration matrix of sliding contacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SlidingMatrix {
    /// Equation (3), which belongs to the forces: Newton's method.
    #[default]
    Consistent,
    /// Equation (4): symmetric, an approximation of the iteration matrix; the forces are the same.
    ///
    /// Its iteration converges linearly near the solution (spectral radius below 0.53 in the published cases), but only
    /// there: it takes a tangential correction t for a normal force µ·penalty·t, so that the real normal displacement is
    /// missed by µ·t. Once that exceeds the penetration, force/penalty, the contact opens or several nodes dig in, and the
    /// iteration goes round in a circle. With 1e12 N/m and 50 kN that is 0.1 µm of sliding an iteration, where a step of 0.5 ms at
    /// 0.1 m/s slides 50 µm: of the 550 steps of the published cases 4.1 and 4.2 it ends some 430 and 100. With the publication's
    /// 1e9 N/m it ends 528 and 529, but there the penetration is 0.15 of the springs' deformation. A step that does not
    /// converge with it is therefore done with equation (3).
    Symmetric,
}

/// Friction and penalty of a run.
#[derive(Debug, Clone, Copy)]
pub(super) struct ContactLaw {
    pub penalty: f64,
    pub friction: f64,
    /// Arc lengths of the wheel between which friction is left out.
    pub frictionless: Option<(f64, f64)>,
    pub sliding: SlidingMatrix,
}

/// What limits the friction of a node during an iteration.
#[derive(Clone, Copy)]
pub(super) enum FrictionLimit<'a> {
    /// Coulomb: μ times the normal force of the present iteration; with the touching nodes of the iteration before.
    ///
    /// Between sliding one way and the other lies sticking, in a range far narrower than a Newton step: a node
    /// that would go from one to the other is taken to stick beyond its limit for one iteration, which leads to the middle.
    Coulomb(&'a [ActiveNode]),
    /// Given limits, one a rail node, N: the problem has a potential, which a line search can descend.
    Given(&'a [f64]),
}

/// One rail node: a slave of C.
#[derive(Debug, Clone)]
struct RailNode {
    /// From C to the node at rest, directions 1 and 2.
    arm: Vector2<f64>,
    /// Arc length of its foot on the wheel at the last converged state.
    place: f64,
    /// Tangential force and tangent at the last converged state.
    force: f64,
    tangent: Vector2<f64>,
}

/// A rail node that touches.
#[derive(Debug, Clone, Copy)]
pub(super) struct ActiveNode {
    pub node: usize,
    pub mode: ContactMode,
    pub place: f64,
    pub penetration: f64,
    pub normal_force: f64,
    pub tangential_force: f64,
    pub tangent: Vector2<f64>,
}

/// Forces of all contacts at a pose.
pub(super) struct ContactForces {
    /// Internal forces at the masters.
    pub force: Vector6,
    /// Their derivative.
    pub stiffness: Matrix6,
    pub active: Vec<ActiveNode>,
    /// A node is taken to stick beyond its friction limit: not a state to end with.
    pub provisional: bool,
}

/// Foot of a rail node on the wheel.
struct Foot {
    /// Its arc length, and the derivative of the spline there.
    place: f64,
    slope: Vector2<f64>,
    /// From the wheel to the node, m; negative is penetration.
    gap: f64,
}

/// The rail's nodes and the wheel's spline.
pub(super) struct ContactSurface<'a> {
    wheel: &'a ProfileCurve,
    underside: Underside,
    wheel_radius: f64,
    /// From C to the wheel centre at rest.
    centre: Vector2<f64>,
    nodes: Vec<RailNode>,
    /// Nodes that can touch while the pose stays within `reach` of `listed_at`.
    listed: Vec<usize>,
    listed_at: Pose,
    reach: f64,
    /// Lower bound of each node's gap at the pose where it was last measured.
    bounds: Vec<f64>,
    /// Largest distance of a slave from its master.
    arm: f64,
    /// Beyond its predicted motion a step may move this far before the nodes are listed again, m.
    spare: f64,
}

/// A node with a smaller gap (m) that moved less keeps its foot in the neighbourhood: every radius of a wheel is larger.
const NEAR: f64 = 2e-3;

/// The iteration for a foot ends with a shorter step, m.
const SETTLED: f64 = 1e-9;

/// How far a step may move beyond its predicted motion before the nodes are listed again, if no other length is given, m.
const LEAST_REACH: f64 = 50e-6;

/// A vector of the wheel's profile frame in directions 1 and 2.
fn in_plane(vector: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(vector.x, -vector.y)
}

/// Equation (13) in the wheel's profile frame: how far a node is behind its foot, m, where the spline has this derivative.
fn penetration(from_foot: &Vector2<f64>, slope: &Vector2<f64>) -> f64 {
    normal_displacement(in_plane(from_foot), in_plane(slope).normalize())
}

impl<'a> ContactSurface<'a> {
    /// `points` are the rail nodes relative to C, `centre` the wheel centre relative to C, both at rest in directions 1 and 2.
    pub fn new(
        points: &[Vector2<f64>],
        wheel: &'a ProfileCurve,
        wheel_radius: f64,
        centre: Vector2<f64>,
    ) -> Self {
        let arm = points.iter().map(|p| p.norm().max((p - centre).norm())).fold(0.0, f64::max);
        let nodes = points
            .iter()
            .map(|&arm| RailNode { arm, place: 0.0, force: 0.0, tangent: Vector2::x() })
            .collect();
        Self {
            wheel,
            underside: Underside::of(wheel),
            wheel_radius,
            centre,
            nodes,
            listed: Vec::new(),
            listed_at: Pose::repeat(f64::NAN),
            reach: 0.0,
            bounds: vec![0.0; points.len()],
            arm,
            spare: LEAST_REACH,
        }
    }

    /// The same with another way that a step may move beyond its predicted motion before the nodes are listed again, m: a short one makes short lists.
    pub fn sparing(self, spare: f64) -> Self {
        Self { spare, ..self }
    }

    /// Largest displacement of a rail node against the wheel between two poses.
    fn motion(&self, from: &Pose, to: &Pose) -> f64 {
        let d = to - from;
        (d[0] - d[2]).hypot(d[1] - d[3]) + self.arm * (d[4].abs() + d[5].abs())
    }

    /// The node in the profile frame of the wheel.
    fn in_wheel(&self, node: &RailNode, pose: &Pose) -> Point2<f64> {
        let place = Vector2::new(pose[2], pose[3]) + Rotation2::new(pose[4]) * node.arm;
        let arm = Rotation2::new(-pose[5]) * (place - self.centre - Vector2::new(pose[0], pose[1]));
        Point2::new(arm.x, -arm.y - self.wheel_radius)
    }

    /// Foot of a point on the spline by Newton's iteration from the arc length `near`; the gap is known to be `least` (m) or more. None where the iteration leads elsewhere:
    /// further away than the radius of curvature, on the tangents beyond the ends as well.
    fn foot_near(&self, point: &Point2<f64>, near: f64, least: f64) -> Option<Foot> {
        let mut s = near;
        let (mut foot, mut slope) = self.wheel.evaluate(s);
        let mut step = f64::INFINITY;
        // The gap is small against the radius of curvature: the simplified Newton converges in a few iterations.
        for _ in 0..12 {
            step = (point - foot).dot(&slope) / slope.norm_squared();
            s += step;
            (foot, slope) = self.wheel.evaluate(s);
            if step.abs() < 1e-16 {
                break;
            }
        }
        let gap = -penetration(&(point - foot), &slope);
        (step.abs() < SETTLED && gap > least - SETTLED).then_some(Foot { place: s, slope, gap })
    }

    /// Foot of a point on the whole spline, found anew.
    fn foot_anywhere(&self, point: &Point2<f64>) -> Foot {
        let (place, distance) = self.wheel.closest(point);
        let (foot, slope) = self.wheel.evaluate(place);
        let inside = penetration(&(point - foot), &slope) > 0.0 && place > 0.0 && place < self.wheel.length();
        Foot { place, slope, gap: if inside { -distance } else { distance } }
    }

    /// The foot of [`Self::foot_near`], or the one on the whole spline.
    fn foot(&self, point: &Point2<f64>, near: f64, least: f64) -> Foot {
        self.foot_near(point, near, least).unwrap_or_else(|| self.foot_anywhere(point))
    }

    /// Lists the nodes that can touch within `reach` (m) of `start`, the last converged pose, and finds the feet of those that are
    /// new to the list.
    pub fn list(&mut self, start: &Pose, reach: f64) {
        let reach = reach + self.spare;
        let moved =
            if self.listed_at[0].is_nan() { f64::INFINITY } else { self.motion(&self.listed_at, start) };
        let before = std::mem::take(&mut self.listed);
        let mut known = before.iter().peekable();
        for i in 0..self.nodes.len() {
            let was_listed = known.next_if_eq(&&i).is_some();
            self.bounds[i] -= moved;
            if self.bounds[i] > reach {
                continue;
            }
            let point = self.in_wheel(&self.nodes[i], start);
            // A listed node has its foot from the last converged pose; one that was near finds it near the last.
            let near = was_listed || (self.bounds[i] + moved < NEAR && moved < NEAR);
            let place = if near { self.nodes[i].place } else { self.wheel.closest(&point).0 };
            let Foot { place, slope, gap } = self.foot(&point, place, self.bounds[i]);
            if !was_listed {
                let node = &mut self.nodes[i];
                node.place = place;
                node.force = 0.0;
                node.tangent = Rotation2::new(start[5]) * in_plane(&slope).normalize();
            }
            self.bounds[i] = gap;
            if gap <= reach {
                self.listed.push(i);
            }
        }
        self.listed_at = *start;
        self.reach = reach;
    }

    /// Whether the list of nodes holds at `pose`; otherwise it has to be made anew with the motion returned.
    pub fn beyond_reach(&self, pose: &Pose) -> Option<f64> {
        let motion = self.motion(&self.listed_at, pose);
        (motion > self.reach).then_some(motion)
    }

    /// Forces, tangent and touching nodes at `pose`.
    pub fn evaluate(&self, law: &ContactLaw, pose: &Pose, limit: FrictionLimit) -> ContactForces {
        let mut result = ContactForces {
            force: Vector6::zeros(),
            stiffness: Matrix6::zeros(),
            active: Vec::new(),
            provisional: false,
        };
        let turn = Rotation2::new(pose[5]);
        let motion = self.motion(&self.listed_at, pose);
        for &i in &self.listed {
            // The gap cannot have closed.
            if self.bounds[i] > motion {
                continue;
            }
            let node = &self.nodes[i];
            let point = self.in_wheel(node, pose);
            // With given limits friction does not need pressure: else a node that opens would let go of a finite
            // force, and the potential would jump.
            let held = matches!(limit, FrictionLimit::Given(limits) if limits[i] > 0.0);
            let foot = match self.foot_near(&point, node.place, self.bounds[i] - motion) {
                Some(foot) => foot,
                None if !held && self.underside.is_above(&point) => continue,
                None => self.foot_anywhere(&point),
            };
            let Foot { place, slope, gap } = foot;
            let (local_tangent, penetration) = (in_plane(&slope).normalize(), -gap);
            if penetration <= 0.0 && !held {
                continue;
            }
            let tangent = turn * local_tangent;
            let free = law.frictionless.is_some_and(|(from, to)| (from..=to).contains(&place));
            let friction = if free { 0.0 } else { law.friction };
            let normal_force = law.penalty * penetration.max(0.0);
            let trial = sticking_force(
                law.penalty,
                tangential_increment(place, node.place),
                tangent,
                node.tangent,
                node.force,
            );
            let (mode, tangential_force) = match limit {
                FrictionLimit::Coulomb(previous) => {
                    let turned = |last: &ActiveNode| {
                        last.node == i
                            && last.mode == ContactMode::Slip
                            && last.tangential_force * trial < 0.0
                    };
                    let checked = mode_check(penetration, normal_force, trial, friction);
                    if checked.0 == ContactMode::Slip && friction > 0.0 && previous.iter().any(turned) {
                        result.provisional = true;
                        (ContactMode::Stick, trial)
                    } else {
                        checked
                    }
                }
                FrictionLimit::Given(limits) if friction > 0.0 => {
                    mode_check(f64::MIN_POSITIVE, limits[i], trial, 1.0)
                }
                FrictionLimit::Given(_) => (ContactMode::Slip, 0.0),
            };
            let active =
                ActiveNode { node: i, mode, place, penetration, normal_force, tangential_force, tangent };
            let signed_friction = match limit {
                FrictionLimit::Coulomb(_) => friction.copysign(tangential_force),
                FrictionLimit::Given(_) => 0.0,
            };
            // In directions 1 and 2 the curve turns the other way than in (y, z).
            let curvature = -self.wheel.curvature(place);
            self.add(&mut result, law, &active, signed_friction, curvature, pose);
            result.active.push(active);
        }
        result
    }

    /// Adds the force and the stiffness of one node, by equations (1) to (8), and the geometric stiffness.
    fn add(
        &self,
        result: &mut ContactForces,
        law: &ContactLaw,
        active: &ActiveNode,
        signed_friction: f64,
        curvature: f64,
        pose: &Pose,
    ) {
        let arm_c = Rotation2::new(pose[4]) * self.nodes[active.node].arm;
        let arm_b = arm_c + Vector2::new(pose[2] - pose[0], pose[3] - pose[1]) - self.centre;
        let turn = rotation(active.tangent);
        let force = turn.transpose() * Vector2::new(active.tangential_force, active.normal_force);
        let transformation = master_slave(arm_b, arm_c);
        let pair = SVector::<f64, 4>::from([-force.x, -force.y, force.x, force.y]);
        result.force += transformation.transpose() * pair;

        let symmetric = law.sliding == SlidingMatrix::Symmetric && active.mode == ContactMode::Slip;
        let mut local = if symmetric {
            symmetric_sliding_stiffness(law.penalty, signed_friction)
        } else {
            contact_stiffness(active.mode, law.penalty, signed_friction)
        };
        if active.penetration <= 0.0 {
            local.fill_column(1, 0.0);
        }
        if !symmetric {
            // Tangent and normal turn as the foot moves along the curved spline; the foot moves faster than the
            // node on the inside of the curve. Not in the publication: it makes the iteration quadratic.
            let last = &self.nodes[active.node];
            let carried = match active.mode {
                ContactMode::Stick => {
                    let normal = Vector2::new(-active.tangent.y, active.tangent.x);
                    curvature * last.tangent.dot(&normal) * last.force
                }
                _ => 0.0,
            };
            local += Matrix2::new(
                carried - curvature * active.normal_force,
                0.0,
                curvature * active.tangential_force,
                0.0,
            );
            let stretch = 1.0 / (1.0 - curvature * active.penetration);
            local.column_mut(0).scale_mut(stretch);
        }
        result.stiffness +=
            master_stiffness(&two_node_stiffness(&plane_stiffness(&local, &turn)), &transformation);
        if symmetric {
            return;
        }
        // The arms and, with the wheel, the local axes turn too.
        result.stiffness[(4, 4)] -= arm_c.dot(&force);
        let mut relative = Vector2::new(-force.y, force.x);
        if active.mode == ContactMode::Stick {
            // The last force is carried to a tangent that turns with the wheel.
            let last = &self.nodes[active.node];
            let normal = Vector2::new(-active.tangent.y, active.tangent.x);
            relative += active.tangent * (last.tangent.dot(&normal) * last.force);
        }
        let column = transformation.transpose()
            * SVector::<f64, 4>::from([-relative.x, -relative.y, relative.x, relative.y]);
        for i in 0..6 {
            result.stiffness[(i, 5)] += column[i];
        }
        // d(arm_b) = d(rail node) − d(B): the moment of −force about B.
        let node_motion = transformation.fixed_view::<2, 6>(2, 0);
        let mut arm_motion: SMatrix<f64, 2, 6> = node_motion.into_owned();
        arm_motion[(0, 0)] -= 1.0;
        arm_motion[(1, 1)] -= 1.0;
        for j in 0..6 {
            result.stiffness[(5, j)] += arm_motion[(0, j)] * -force.y + arm_motion[(1, j)] * force.x;
        }
    }

    /// Energy of the penalty springs of the touching nodes, and what friction took since the last state, J.
    pub fn energy(&self, penalty: f64, active: &[ActiveNode]) -> PartEnergy {
        let mut energy = PartEnergy::default();
        for touching in active {
            let last = &self.nodes[touching.node];
            let ActiveNode { normal_force, tangential_force, .. } = *touching;
            energy.elastic +=
                0.5 * (normal_force * normal_force + tangential_force * tangential_force) / penalty;
            if touching.mode == ContactMode::Slip {
                let slip = touching.place - last.place - (tangential_force - last.force) / penalty;
                energy.friction += (tangential_force * slip).abs();
            }
        }
        energy
    }

    /// Makes the converged pose and its touching nodes the last state.
    pub fn commit(&mut self, pose: &Pose, active: &[ActiveNode]) {
        let motion = self.motion(&self.listed_at, pose);
        for &i in &self.listed {
            let point = self.in_wheel(&self.nodes[i], pose);
            let Foot { place, slope, .. } = self.foot(&point, self.nodes[i].place, self.bounds[i] - motion);
            let node = &mut self.nodes[i];
            node.place = place;
            node.force = 0.0;
            node.tangent = Rotation2::new(pose[5]) * in_plane(&slope).normalize();
        }
        for touching in active {
            let node = &mut self.nodes[touching.node];
            node.force = touching.tangential_force;
            node.tangent = touching.tangent;
        }
    }
}

#[cfg(test)]
mod tests;
