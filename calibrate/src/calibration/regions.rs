//! The regions of contact of a settled load.

use super::pressed::Pressed;
use crate::contact::ContactPoint;
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

/// Lines of a fine grid from one that carries load to the next one of the same region, at most.
const FINE_APART: usize = 2;

/// How many regions there are on a fine grid with some `forces` on its points.
pub(super) fn regions_on_grid(points: &[ContactPoint], forces: &[f64]) -> usize {
    parted(points, forces, FINE_APART).len()
}

/// Numbers of the points that carry load, parted where more lines than `apart` lie between them.
fn parted(points: &[ContactPoint], forces: &[f64], apart: usize) -> Vec<Vec<usize>> {
    let mut regions: Vec<Vec<usize>> = Vec::new();
    for j in (0..points.len()).filter(|&j| forces[j] > 0.0) {
        let line = points[j].index.0;
        match regions.last_mut() {
            Some(region) if line <= points[region[region.len() - 1]].index.0 + apart => region.push(j),
            _ => regions.push(vec![j]),
        }
    }
    regions
}
