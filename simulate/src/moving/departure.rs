//! Whether the wheel has left the rail.

use nalgebra::{Point2, Rotation2, Vector2};

use railspring_calibrate::error::{Result, StopReason};
use railspring_calibrate::history::Departure;
use railspring_calibrate::placement::{departure, lateral_extent};

use super::element::to_plane;
use super::model::MovingModel;
use super::solve::Solution;
use super::surface::ActiveNode;

/// Points of both running surfaces on their masters, and where the profiles end.
pub(super) struct Outline {
    /// Relative to the wheel centre and to the rail's master, directions 1 and 2 at rest, m.
    wheel: Vec<Vector2<f64>>,
    rail: Vec<Vector2<f64>>,
    /// From the rail's master to the wheel centre at rest, m.
    centre: Vector2<f64>,
    /// Arc length of the wheel's spline, m, and number of rail nodes.
    wheel_length: f64,
    nodes: usize,
}

impl Outline {
    /// `master` is the world point of the rail's master at rest, `nodes` the number of rail nodes.
    pub fn new(model: &MovingModel, master: Point2<f64>, nodes: usize) -> Self {
        let to_axle = Vector2::new(0.0, model.wheel_radius);
        Self {
            wheel: model.wheel.knot_points().map(|p| to_plane(p.coords + to_axle)).collect(),
            rail: model.rail.curve.knot_points().map(|p| to_plane(p - master)).collect(),
            centre: to_plane(model.tape - to_axle - master),
            wheel_length: model.wheel.length(),
            nodes,
        }
    }

    /// Where the wheel has gone, if it has left the rail: no point of its running surface is over the rail's any more,
    /// or a contact that carries load has passed the end of a profile.
    ///
    /// # Errors
    /// Load on an end of the rail's profile while the wheel still stands over it: the profile is too short.
    pub fn departure(&self, solution: &Solution) -> Result<Option<Departure>> {
        let pose = &solution.pose;
        let extent = |points: &[Vector2<f64>], turn: f64, at: f64| {
            let turn = Rotation2::new(turn);
            lateral_extent(points.iter().map(|p| Point2::from(turn * p))).map(|y| y + at)
        };
        let rail = extent(&self.rail, pose[4], pose[2]);
        let wheel = extent(&self.wheel, pose[5], self.centre.x + pose[0]);
        if let Some(departure) = departure(rail, wheel) {
            return Ok(Some(departure));
        }
        let end = solution.active.iter().find_map(|active| self.at_end(active, pose[0] - pose[2]));
        end.map(|found| found.ok_or_else(|| solution.failure(StopReason::EdgeOfCandidates))).transpose()
    }

    /// What load on the end of a profile means with the wheel moved `aside` against the rail (m, to the field side);
    /// the inner `None` is no departure.
    fn at_end(&self, active: &ActiveNode, aside: f64) -> Option<Option<Departure>> {
        // The wheel's spline runs from the flange back to the tread's end, the rail's nodes from the gauge face to the field face.
        if active.place < 0.0 {
            Some(Some(Departure::FieldSide))
        } else if active.place > self.wheel_length {
            Some(Some(Departure::GaugeSide))
        } else if active.node == 0 {
            Some((aside < 0.0).then_some(Departure::GaugeSide))
        } else if active.node + 1 == self.nodes {
            Some((aside > 0.0).then_some(Departure::FieldSide))
        } else {
            None
        }
    }
}
