//! How far running surfaces reach to either side.

use nalgebra::{Point2, Rotation2};
use railspring_profiles::placement::lateral_extent;

/// Points of a running surface from its reference point, m.
#[derive(Debug, Clone)]
pub struct Outline {
    points: Vec<Point2<f64>>,
    /// Its ends to either side as it is.
    level: [f64; 2],
    /// Distance of the farthest point.
    reach: f64,
}

impl Outline {
    /// Of points from a reference point, m.
    pub fn new(points: Vec<Point2<f64>>) -> Self {
        let reach = points.iter().map(|p| p.coords.norm()).fold(0.0, f64::max);
        Self { level: lateral_extent(points.iter().copied()), reach, points }
    }

    /// Its ends to either side where it is turned (rad) and at a place (m).
    pub fn extent(&self, turn: f64, place: f64) -> [f64; 2] {
        let turn = Rotation2::new(turn);
        lateral_extent(self.points.iter().map(|p| turn * p)).map(|y| y + place)
    }

    /// Whether both are over each other however their turns (rad) have moved their ends; a turn moves a point by no more than its angle times its distance.
    pub fn is_over(&self, other: &Self, turns: [f64; 2], places: [f64; 2]) -> bool {
        let slack = turns[0].abs() * self.reach + turns[1].abs() * other.reach;
        let aside = places[0] - places[1];
        self.level[0] + aside + slack < other.level[1] && self.level[1] + aside - slack > other.level[0]
    }
}
