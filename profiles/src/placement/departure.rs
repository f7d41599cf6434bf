//! Where a wheel has gone that no longer stands over the rail.

use nalgebra::Point2;

use crate::profile::ProfileCurve;

/// Where the wheel went when it left the rail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Departure {
    /// Over the rail to the field side: the flange has climbed the gauge face, or jumped over the head.
    FieldSide,
    /// Into the track: the field-side end of the tread has slid off the head.
    GaugeSide,
    /// Past an end of the rail along the track.
    RailEnd,
}

impl Departure {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::FieldSide, Self::GaugeSide, Self::RailEnd];
}

/// Where the wheel has gone, if no point of its running surface is over the rail's any more. Both are given by the
/// lateral positions (m, world frame) of their gauge-side and field-side ends.
///
/// That cannot be undone: flange and tread are both on one side of the head, and no force of the contact leads
/// the wheel back. A flange that climbs, or runs on the head with its tip, is still over the rail.
///
/// ```
/// use railspring_profiles::placement::{Departure, departure};
/// let rail = [0.714, 0.790];
/// assert_eq!(departure(rail, [0.680, 0.810]), None);
/// assert_eq!(departure(rail, [0.791, 0.921]), Some(Departure::FieldSide));
/// assert_eq!(departure(rail, [0.583, 0.713]), Some(Departure::GaugeSide));
/// ```
pub fn departure(rail: [f64; 2], wheel: [f64; 2]) -> Option<Departure> {
    if wheel[0] > rail[1] {
        Some(Departure::FieldSide)
    } else if wheel[1] < rail[0] {
        Some(Departure::GaugeSide)
    } else {
        None
    }
}

/// Gauge-side and field-side end of points, m.
pub fn lateral_extent(points: impl Iterator<Item = Point2<f64>>) -> [f64; 2] {
    points.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| [low.min(p.x), high.max(p.x)])
}

impl ProfileCurve {
    /// Its knots as points, which hold its extent to the rise of the curve between two of them.
    pub fn knot_points(&self) -> impl Iterator<Item = Point2<f64>> + '_ {
        self.knots().iter().map(|&s| self.point(s))
    }
}
