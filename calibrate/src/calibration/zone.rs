//! Where rail and wheel are paired: the rigid part of what both bodies move around the patch.
//!
//! Rim and railhead move by more than a millimetre as the disc bends, and turn; the contact then is at another place of both
//! profiles, with another normal. What both move around the patch as a rigid body, the hub's motion included, places their
//! profiles; the rest, some tens of micrometres, stands in the gaps along the normals. The choice of that part is free but for the
//! product of the rest across the normal and the curvature, so that the size of the zone matters little.
//!
//! The calibration pairs where the hub is, as the reference solvers do: there the hub is held across the load, and its laws change by less
//! than their error bands.

use crate::contact::{ContactPoint, PairingLimits, RigidMotion, Side, Surface, nodes_near, pair};
use nalgebra::{Point2, Vector2};

/// Half length along profile and track of the zone around every loaded point whose motion counts, m: some half widths of a patch, so
/// that what the load presses in there has a small part in it, and a fraction of a railhead.
const ZONE: f64 = 10e-3;
/// Lines of a coarse grid that it reaches over at least, for a turn to be seen.
const ZONE_LINES: f64 = 2.0;
/// Turn that counts as much as a displacement, by this length, m: a normal force changes its direction by a hundred-thousandth
/// where the profiles move by a micrometre.
const TURN_LENGTH: f64 = 0.1;

/// Contact nodes around the loaded points of both bodies, with weights that fall with the distance from the load.
#[derive(Clone)]
pub struct Zone([Vec<ZoneNode>; 2]);

#[derive(Clone)]
struct ZoneNode {
    node: usize,
    place: Point2<f64>,
    weight: f64,
}

impl Zone {
    /// Around the `points` with normal `forces` (N) between the surfaces of rail and wheel at rest; `None` without load.
    pub fn around([rail, wheel]: [&Surface; 2], points: &[ContactPoint], forces: &[f64]) -> Option<Self> {
        let loaded = || points.iter().zip(forces).filter(|(_, force)| **force > 0.0);
        let on_rail: Vec<_> = loaded().map(|(point, force)| (point.position, *force)).collect();
        let mut before: Option<(usize, f64)> = None;
        let on_wheel: Vec<_> = loaded()
            .map(|(point, force)| {
                let (line, at) = (point.index.0, &point.opposing_position);
                let s = match before {
                    // beside the one before
                    Some((last, guess)) if line <= last + 1 => wheel.curve.closest_near(at, guess).0,
                    _ => wheel.curve.closest(at).0,
                };
                before = Some((line, s));
                (Point2::new(s, point.position.y), *force)
            })
            .collect();
        (!on_rail.is_empty()).then(|| Self([nodes_around(rail, &on_rail), nodes_around(wheel, &on_wheel)]))
    }

    /// The rigid part of the displacements (y, z; m) that `of` some contact nodes of one body are given.
    pub fn motion(&self, side: Side, of: impl FnOnce(&[usize]) -> Vec<Vector2<f64>>) -> RigidMotion {
        let zone = &self.0[usize::from(side == Side::Opposing)];
        let nodes: Vec<usize> = zone.iter().map(|n| n.node).collect();
        let moved: Vec<_> =
            zone.iter().zip(of(&nodes)).map(|(n, moved)| (n.place, moved, n.weight)).collect();
        RigidMotion::fit(&moved).unwrap_or(RigidMotion::translation(Vector2::zeros()))
    }
}

/// The nodes of a surface around `loads`: (arc length and x, force).
fn nodes_around(surface: &Surface, loads: &[(Point2<f64>, f64)]) -> Vec<ZoneNode> {
    let grid = surface.grid;
    let columns = grid.along_track.len();
    let mut weights = vec![0.0; grid.along_profile.len() * columns];
    let half = half_length(&grid.along_profile);
    let lines = surface.unit_lines();
    let mut track = lines.clone();
    for (at, force) in loads {
        let over = surface.lines_over(at.x);
        track.iter_mut().zip(&lines).for_each(|(x, line)| *x = over * line);
        let along: Vec<(usize, f64)> = hats(&track, at.y, half_length(&track)).collect();
        for (i, u) in hats(&grid.along_profile, at.x, half) {
            for &(k, v) in &along {
                weights[i * columns + k] += force * u * v;
            }
        }
    }
    let inside = weights.into_iter().enumerate().filter(|(_, weight)| *weight > 0.0);
    inside.map(|(node, weight)| ZoneNode { node, place: surface.node(node), weight }).collect()
}

/// Half length of a zone on the lines of a grid, m.
fn half_length(lines: &[f64]) -> f64 {
    let widest = lines.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    f64::max(ZONE, ZONE_LINES * widest)
}

/// Lines of a grid nearer to a place than `half` (m), with weights that fall in proportion to the distance.
fn hats(lines: &[f64], at: f64, half: f64) -> impl Iterator<Item = (usize, f64)> {
    let [first, end] = [at - half, at + half].map(|end| lines.partition_point(|line| *line < end));
    let weights = (first..end).map(move |n| (n, 1.0 - (lines[n] - at).abs() / half));
    weights.filter(|(_, weight)| *weight > 0.0)
}

/// Rigid motions of rail and wheel by which their profiles are placed for pairing.
#[derive(Debug, Clone, Copy)]
pub struct Places(pub [RigidMotion; 2]);

/// What the places of rail and wheel differ by from others, at their centres: displacement (m) and turn (rad).
pub type Change = [(Vector2<f64>, f64); 2];

impl Places {
    /// Rail and wheel as they are meshed, the wheel displaced by that of its hub (y, z; m).
    pub fn of_hub(hub: &Vector2<f64>) -> Self {
        Self([RigidMotion::translation(Vector2::zeros()), RigidMotion::translation(*hub)])
    }

    /// Displacement of the wheel's surface against the rail's at the patch, m.
    pub fn slide(&self) -> Vector2<f64> {
        let [rail, wheel] = &self.0;
        wheel.shift - rail.shift
    }

    /// From the places `before` to these, at the centres of these.
    pub fn since(&self, before: &Self) -> Change {
        [0, 1].map(|body| {
            let (now, before) = (&self.0[body], &before.0[body]);
            (now.shift - before.displacement(&now.centre), now.angle - before.angle)
        })
    }

    /// These places and a change.
    pub fn and(&self, change: &Change) -> Self {
        let mut places = *self;
        for (motion, (shift, angle)) in places.0.iter_mut().zip(change) {
            motion.shift += shift;
            motion.angle += angle;
        }
        places
    }

    /// With the wheel displaced by (y, z) in addition, m.
    pub fn with_wheel(&self, by: Vector2<f64>) -> Self {
        self.and(&[(Vector2::zeros(), 0.0), (by, 0.0)])
    }
}

/// Rail and wheel where they are paired.
pub struct Placed<'s> {
    /// Where they are against their places at rest.
    pub places: Places,
    /// Their surfaces.
    pub surfaces: [Surface<'s>; 2],
    /// Displacements of their contact nodes (`3·node + axis`) beyond their places, m.
    pub rest: [Vec<f64>; 2],
}

impl<'s> Placed<'s> {
    /// The surfaces of rail and wheel at rest, in `places`, with the displacements of their contact nodes (`3·node + axis`, m). `nodes` are
    /// where these are at rest ([`Surface::node`]).
    pub fn new(
        places: Places,
        at_rest: [&Surface<'s>; 2],
        nodes: [&[Point2<f64>]; 2],
        displacement: [&[f64]; 2],
    ) -> Self {
        let rest = |body: usize| {
            let motion = &places.0[body];
            let mut rest = displacement[body].to_vec();
            for (node, nodal) in nodes[body].iter().zip(rest.chunks_exact_mut(3)) {
                let moved = motion.displacement(node);
                nodal[1] -= moved.x;
                nodal[2] -= moved.y;
            }
            rest
        };
        let surfaces = [0, 1].map(|body| at_rest[body].placed(&places.0[body]));
        Self { places, surfaces, rest: [rest(0), rest(1)] }
    }

    /// The nodes of the rail within `largest_gap` (m) of the wheel in these places.
    pub fn pair(&self, largest_gap: f64) -> Vec<ContactPoint> {
        pair(&self.surfaces[0], &self.surfaces[1], PairingLimits { largest_gap })
    }

    /// As [`Self::pair`], with the gaps at the nodes themselves.
    pub fn nodes_near(&self, largest_gap: f64) -> Vec<ContactPoint> {
        nodes_near(&self.surfaces[0], &self.surfaces[1], PairingLimits { largest_gap })
    }

    /// Normal gaps of nodes with the displacements, m.
    pub fn gaps(&self, points: &[ContactPoint]) -> Vec<f64> {
        let [rail, wheel] = &self.rest;
        points.iter().map(|point| point.gap + point.opening(0, [rail, wheel])).collect()
    }
}

/// How far from each other places are, at the patch, m.
pub fn distance(change: &Change) -> f64 {
    change.iter().map(|(shift, angle)| shift.norm() + TURN_LENGTH * angle.abs()).fold(0.0, f64::max)
}
