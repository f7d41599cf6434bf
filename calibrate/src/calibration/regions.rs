//! The regions of contact of a settled load.

use super::grid::{FINE_APART, parted};
use super::pressed::Pressed;
use nalgebra::Vector2;

/// Contact between lines along the track that carry nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// Normal force, N.
    pub force: f64,
    /// Mean normal out of the rail, world (y, z).
    pub normal: Vector2<f64>,
}

/// The regions of contact beside each other across the track.
pub fn regions(state: &Pressed) -> Vec<Region> {
    let of = |region: Vec<usize>| {
        let forces = region.iter().map(|&j| (state.solution.forces[j], state.points[j].normal));
        let (force, normal) =
            forces.fold((0.0, Vector2::zeros()), |(force, normal), (f, n)| (force + f, normal + n * f));
        Region { force, normal: normal.normalize() }
    };
    regions_of(state).into_iter().map(of).collect()
}

/// Numbers of the points of each region, ascending.
pub(super) fn regions_of(state: &Pressed) -> Vec<Vec<usize>> {
    // between points of a fine grid, lines beside a patch may stay without load
    let apart = if state.fine().is_some() { FINE_APART } else { 1 };
    parted(&state.points, &state.solution.forces, apart)
}
