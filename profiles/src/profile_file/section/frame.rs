//! How an outline comes into the frame of its profile.

use nalgebra::{Point2, Vector2};

use crate::profile::Segment;
use crate::profile_file::finding::{Action, Finding, FindingKind};
use crate::profile_file::measured::MeasuredPoint;
use crate::units::MILLIMETRE;

/// A shift below this is none, m.
const IN_PLACE: f64 = 1e-6 * MILLIMETRE;

/// How an outline comes into the frame of its profile: turned over or not, then shifted.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub mirrored: bool,
    pub upside_down: bool,
    pub shift: Vector2<f64>,
}

impl Frame {
    fn point(&self, p: &Point2<f64>) -> Point2<f64> {
        let sense = |turned: bool| if turned { -1.0 } else { 1.0 };
        Point2::new(sense(self.mirrored) * p.x, sense(self.upside_down) * p.y) + self.shift
    }

    pub fn ring(&self, ring: &[MeasuredPoint]) -> Vec<MeasuredPoint> {
        ring.iter().map(|p| MeasuredPoint { point: self.point(&p.point), ..*p }).collect()
    }

    pub fn segment(&self, segment: &Segment) -> Segment {
        let segment = if self.mirrored { segment.mirrored() } else { *segment };
        let placed =
            |p: Point2<f64>| Point2::new(p.x, if self.upside_down { -p.y } else { p.y }) + self.shift;
        match segment {
            Segment::Line { start, end } => Segment::line(placed(start), placed(end)),
            Segment::Arc { centre, radius, start_angle, sweep } => {
                let sense = if self.upside_down { -1.0 } else { 1.0 };
                let (start_angle, sweep) = (sense * start_angle, sense * sweep);
                Segment::Arc { centre: placed(centre), radius, start_angle, sweep }
            }
        }
    }

    /// The shift as a finding; none if there is none.
    pub fn say_shift(&self, what: &str, findings: &mut Vec<Finding>) {
        if self.shift.amax() >= IN_PLACE {
            let [y, z] = [self.shift.x, self.shift.y].map(|v| v / MILLIMETRE);
            let text = format!("moved by ({y:.4}, {z:.4}) mm: {what}");
            let length = self.shift.norm() / MILLIMETRE;
            findings.push(Finding::new(FindingKind::Origin, Action::Repaired, text).with_value(length, "mm"));
        }
    }
}
