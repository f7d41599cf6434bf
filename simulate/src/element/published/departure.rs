//! Whether the wheel has left the rail, or the contact its profile.

use nalgebra::{Point2, Rotation2, Vector2};

use crate::time::history::{Ending, SurfaceEnd};
use railspring_profiles::placement::{Departure, PlacedRail, departure, lateral_extent};
use railspring_profiles::profile::ProfileCurve;

use super::element::to_plane;
use super::solve::Solution;

/// What load on the end of a profile means at `time` (s) with the wheel moved `aside` against the rail (m, to the field side). It is
/// at an arc length `on_wheel` of the wheel's `length` (m) and perhaps on one of the ends of the rail's profile, which `rail_end` has.
pub(crate) fn at_end(
    [on_wheel, length]: [f64; 2],
    on_rail_end: [bool; 2],
    aside: f64,
    time: f64,
    rail_end: impl Fn(usize) -> Point2<f64>,
) -> Option<Ending> {
    let too_short = |side| Ending::EndOfSurface { time, end: SurfaceEnd::RailProfile, rail: rail_end(side) };
    let departed = |departure| Ending::Departed { time, departure };
    // The wheel's profile runs from the flange back to the tread's end, the rail's from the gauge face to the field face.
    if on_wheel < 0.0 {
        Some(departed(Departure::FieldSide))
    } else if on_wheel > length {
        Some(departed(Departure::GaugeSide))
    } else if on_rail_end[0] {
        Some(if aside < 0.0 { departed(Departure::GaugeSide) } else { too_short(0) })
    } else if on_rail_end[1] {
        Some(if aside > 0.0 { departed(Departure::FieldSide) } else { too_short(1) })
    } else {
        None
    }
}

/// Points of both running surfaces on their masters, and where the profiles end.
pub(super) struct Outline {
    /// Relative to the wheel centre and to the rail's master, directions 1 and 2 at rest, m.
    wheel: Vec<Vector2<f64>>,
    rail: Vec<Vector2<f64>>,
    /// From the rail's master to the wheel centre at rest, m.
    centre: Vector2<f64>,
    /// Arc length of the wheel's spline, m.
    wheel_length: f64,
    /// The first and the last rail node in the rail's profile frame, m, and the number of the last.
    ends: [Point2<f64>; 2],
    last: usize,
}

impl Outline {
    /// A wheel with its radius and the place of its profile's origin where it just touches; `master` is the world point of the rail's master at rest, `nodes`
    /// are the rail nodes in the rail's profile frame, m.
    pub fn new(
        rail: &PlacedRail,
        (wheel, radius, tape): (&ProfileCurve, f64, Point2<f64>),
        master: Point2<f64>,
        nodes: &[(f64, Point2<f64>)],
    ) -> Self {
        let to_axle = Vector2::new(0.0, radius);
        Self {
            wheel: wheel.knot_points().map(|p| to_plane(p.coords + to_axle)).collect(),
            rail: rail.curve.knot_points().map(|p| to_plane(p - master)).collect(),
            centre: to_plane(tape - to_axle - master),
            wheel_length: wheel.length(),
            ends: [nodes[0].1, nodes[nodes.len() - 1].1],
            last: nodes.len() - 1,
        }
    }

    /// How a run ends whose step to `time` (s) has this solution, or `None`. The wheel has left the rail
    /// where no point of its running surface is over the rail's any more, or a contact that carries load has
    /// passed the end of a profile. The profile is too short where load stands on an end of the rail's
    /// profile while the wheel is still over it.
    pub fn ending(&self, solution: &Solution, time: f64) -> Option<Ending> {
        self.ending_beyond(0.0, solution, time)
    }

    /// The same of a wheel that is over its rail as long as it has moved less than `near` (m) against it.
    pub fn ending_beyond(&self, near: f64, solution: &Solution, time: f64) -> Option<Ending> {
        let pose = &solution.pose;
        let turned = self.centre.norm() * (pose[4].abs() + pose[5].abs());
        if (pose[0] - pose[2]).abs() + turned < near {
            return self.at_an_end(solution, time);
        }
        let extent = |points: &[Vector2<f64>], turn: f64, at: f64| {
            let turn = Rotation2::new(turn);
            lateral_extent(points.iter().map(|p| Point2::from(turn * p))).map(|y| y + at)
        };
        let rail = extent(&self.rail, pose[4], pose[2]);
        let wheel = extent(&self.wheel, pose[5], self.centre.x + pose[0]);
        if let Some(departure) = departure(rail, wheel) {
            return Some(Ending::Departed { time, departure });
        }
        self.at_an_end(solution, time)
    }

    /// How a run ends of whose contacts one that carries load is at an end of a profile.
    fn at_an_end(&self, solution: &Solution, time: f64) -> Option<Ending> {
        let pose = &solution.pose;
        solution.active.iter().find_map(|active| {
            let on_rail_end = [active.node == 0, active.node == self.last];
            let place = [active.place, self.wheel_length];
            at_end(place, on_rail_end, pose[0] - pose[2], time, |side| self.ends[side])
        })
    }
}
