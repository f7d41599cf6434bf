//! What friction has taken up along the rail.

use crate::overlap::Pose;
use std::ops::Range;

/// Distance of the places of the rail at which it is kept, m: an eighth of a narrow contact's half-width. A contact that rolls takes in new places, which have taken up
/// nothing yet; at 0.25 mm the forces of the published load case 4.1 are half a per cent of their largest off, at this a thirtieth of that.
const KEPT_EVERY: f64 = 0.1e-3;

/// Tangential displacements that friction has taken up along the rail, and where the wheel was when they were kept.
#[derive(Debug, Clone)]
pub(super) struct TakenUp {
    /// At places that are equally far apart, m; the second list is room for the next one.
    pub values: Vec<f64>,
    pub next: Vec<f64>,
    /// Beyond these of `values` and of `next` nothing is taken up.
    pub filled: [Range<usize>; 2],
    /// The strips of a contact: arc length, m, the most that they can take up, and the way that the wheel has slid over them, m.
    pub places: Vec<[f64; 3]>,
    /// Places per metre.
    pub density: f64,
    /// Where the wheel was when they were kept, and at the end of the last step.
    pub kept: Pose,
    pub committed: Pose,
    /// The way from the one to the other, m, and whether there was a step.
    pub way: f64,
    pub stepped: bool,
}

impl TakenUp {
    /// Nothing, on a rail profile of a length (m).
    pub fn nothing(length: f64) -> Self {
        let count = (length / KEPT_EVERY).ceil().max(1.0);
        let values = vec![0.0; count as usize + 1];
        Self {
            next: values.clone(),
            filled: [0..0, 0..0],
            places: Vec::new(),
            values,
            density: count / length,
            kept: Pose::default(),
            committed: Pose::default(),
            way: 0.0,
            stepped: false,
        }
    }

    /// Takes over another on the same rail, in the memory that there is.
    pub fn copy_from(&mut self, other: &Self) {
        let Self { values, next, filled, places, density, kept, committed, way, stepped } = other;
        self.values.clone_from(values);
        self.next.clone_from(next);
        self.places.clone_from(places);
        self.filled.clone_from(filled);
        (self.density, self.kept, self.committed) = (*density, *kept, *committed);
        (self.way, self.stepped) = (*way, *stepped);
    }

    /// Where the wheel was at the end of the last step.
    pub fn committed(&self) -> &Pose {
        &self.committed
    }

    /// At an arc length of the rail, m.
    pub fn at(&self, rail_s: f64) -> f64 {
        let at = (rail_s * self.density).max(0.0);
        let i = at as usize;
        match (self.values.get(i), self.values.get(i + 1)) {
            (Some(a), Some(b)) => a + (at - i as f64) * (b - a),
            _ => 0.0,
        }
    }
}
