//! Measured surfaces on the bodies of others: a contact lives on a fine grid of its own, and of its bodies it takes a smooth far field, which a
//! millimetre of wear changes by per cents. The wheel of a diameter stands between those of two others.

use super::bodies::CondensedPair;
use super::geometry::{OffBodies, Pair};
use super::solids::PairBody;
use crate::mesh::SurfaceGrid;
use crate::superelement::CondensedBody;
use faer::Scale;
use nalgebra::{Point2, Vector3};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::section::{RailSection, WheelSection};
use railspring_profiles::units::MILLIMETRE;
use std::sync::Arc;

/// Farthest that a surface may lie off the nodes of bodies that carry it, m. Up to 3 mm of wear the displacement is within 1.6 %.
pub const FARTHEST_SURFACE: f64 = 4.0 * MILLIMETRE;
/// Turn of a rail against the one whose body it is on, rad: rounding.
const SAME_TURN: f64 = 1e-9;
/// Distance of corresponding nodes of two wheels, as a part of the element beside them: elements beyond the finest are stretched to fill the circumference.
const SAME_PLACE: f64 = 0.1;

impl Pair {
    /// Other surfaces in a `track` on the condensed `bodies` of this pair: the nodes of the bodies' grids go to the nearest places of these
    /// surfaces, along the profiles and, where the wheel has another radius, along the circumference. Nothing is meshed; the rail as a beam stays what it is.
    ///
    /// # Errors
    /// [`InputError`] for a surface that is farther than [`FARTHEST_SURFACE`] off the nodes or folds over them, a rail that leans
    /// otherwise, and a wheel that misses the rail.
    pub fn carry(
        &self,
        bodies: &CondensedPair,
        rail: RailSection,
        wheel: WheelSection,
        track: &TrackGeometry,
    ) -> Result<(Self, CondensedPair)> {
        let pair = self.with_surfaces(rail, wheel, track)?;
        if (pair.placed.angle - self.placed.angle).abs() > SAME_TURN {
            let lean = |pair: &Self| format!("{:.3}°", pair.placed.angle.to_degrees().abs());
            return InputError::refuse(
                PairBody::RailOnEnds.name(),
                format!("a rail that leans by {}", lean(&pair)),
                format!("{}, as the rail of the bodies does", lean(self)),
                "condense bodies for this inclination",
            );
        }
        let moved = pair.node_line() - self.node_line();
        let moved = Vector3::new(0.0, moved.x, moved.y);
        let mut off_rail: f64 = 0.0;
        let mut on_rail = |body: &CondensedBody, what: PairBody| -> Result<CondensedBody> {
            let (grid, away) = remapped(&body.grid, [&self.rail.running, &pair.rail.running], 1.0, what)?;
            off_rail = off_rail.max(away);
            let nodes = body.nodes.iter().map(|node| node + moved).collect();
            let section = body.section.as_ref().map(|section| section.moved_by(moved.yz()));
            Ok(CondensedBody { grid, nodes, section, ..body.clone() })
        };
        let rail_on_ends = on_rail(&bodies.rail_on_ends, PairBody::RailOnEnds)?;
        let rail_on_foot =
            bodies.rail_on_foot.as_ref().map(|body| on_rail(body, PairBody::RailOnFoot)).transpose()?;
        let radii = self.wheel.radius / pair.wheel.radius;
        let curves = [&self.wheel.running, &pair.wheel.running];
        let (grid, away) = remapped(&bodies.wheel.grid, curves, radii, PairBody::Wheel)?;
        let wheel = CondensedBody { grid, ..bodies.wheel.clone() };
        let off_wheel = away.max((self.wheel.radius - pair.wheel.radius).abs());
        let off_bodies = OffBodies { rail: off_rail, wheel: off_wheel };
        Ok((Self { off_bodies, ..pair }, bodies.with_bodies(wheel, rail_on_ends, rail_on_foot)))
    }
}

/// The first of two condensed pairs, which differ in the diameter of their wheels alone, with a wheel of a `radius` (m) between theirs: its
/// compliance is that of both, in proportion.
///
/// # Errors
/// [`InputError`] for wheels whose grids have other nodes, and for a radius that is not between theirs.
pub fn wheel_between(pairs: [(&Pair, &CondensedPair); 2], radius: f64) -> Result<(Pair, CondensedPair)> {
    let [(smaller, of_smaller), (larger, of_larger)] = pairs;
    let radii = [smaller, larger].map(|pair| pair.wheel.radius);
    let share = (radius - radii[0]) / (radii[1] - radii[0]);
    let refused = |value: String, expected: String| {
        InputError::refuse(PairBody::Wheel.name(), value, expected, "condense a wheel of this diameter")
    };
    if !(0.0..=1.0).contains(&share) {
        let expected = format!("from {:.1} to {:.1} mm", radii[0] / MILLIMETRE, radii[1] / MILLIMETRE);
        return refused(format!("a radius of {:.1} mm", radius / MILLIMETRE), expected);
    }
    let [one, other] = [&of_smaller.wheel, &of_larger.wheel];
    if !are_alike([&one.grid, &other.grid], radii) {
        return refused("two wheels with other contact nodes".into(), "the same nodes on both".into());
    }
    let mix = |a: f64, b: f64| a + share * (b - a);
    let compliance = &*one.compliance * Scale(1.0 - share) + &*other.compliance * Scale(share);
    let nodes = one.grid.along_track.iter().zip(&other.grid.along_track);
    let along_track = nodes.map(|(a, b)| mix(a * radii[0], b * radii[1]) / radius).collect();
    let wheel = CondensedBody {
        key: format!("{share} between {} and {}", one.key, other.key),
        compliance: Arc::new(compliance),
        grid: SurfaceGrid { along_track, ..one.grid.clone() },
        nodes: one.nodes.iter().zip(&other.nodes).map(|(a, b)| a + share * (b - a)).collect(),
        mass: mix(one.mass, other.mass),
        modes: None,
        file: None,
        ..one.clone()
    };
    let mut pair = smaller.clone();
    pair.wheel.radius = radius;
    let CondensedPair { rail_on_ends, rail_on_foot, .. } = of_smaller;
    let between = of_smaller.with_bodies(wheel, rail_on_ends.clone(), rail_on_foot.clone());
    Ok((pair, between.with_part_of(of_larger)))
}

/// Whether the nodes of two grids on wheels of these radii (m) are as many, and have nearly the same places along the profile and arc lengths.
fn are_alike(grids: [&SurfaceGrid; 2], radii: [f64; 2]) -> bool {
    let alike = |a: &[f64], b: &[f64], radii: [f64; 2]| {
        let element = |k: usize| (a[if k == 0 { 1 } else { k - 1 }] - a[k]).abs() * radii[0];
        let near = |k: usize| (a[k] * radii[0] - b[k] * radii[1]).abs() < SAME_PLACE * element(k);
        a.len() == b.len() && (0..a.len()).all(near)
    };
    let [one, other] = grids;
    alike(&one.along_profile, &other.along_profile, [1.0; 2])
        && alike(&one.along_track, &other.along_track, radii)
}

/// The grid of a body with its lines at the nearest places of another surface, and with other angles in proportion; and how far the farthest line is off it, m.
/// The surfaces are those of the body and the other one, in the profile's frame.
fn remapped(
    grid: &SurfaceGrid,
    [from, to]: [&ProfileCurve; 2],
    angles: f64,
    body: PairBody,
) -> Result<(SurfaceGrid, f64)> {
    let mut off: f64 = 0.0;
    let mut along_profile: Vec<f64> = Vec::with_capacity(grid.along_profile.len());
    let mut folded: Option<Point2<f64>> = None;
    for (line, &s) in grid.along_profile.iter().enumerate() {
        let point = from.point(s);
        let (place, away) = match along_profile.last() {
            Some(before) => to.closest_near(&point, before + s - grid.along_profile[line - 1]),
            None => to.closest(&point),
        };
        off = off.max(away);
        if along_profile.last().is_some_and(|before| place <= *before) {
            folded.get_or_insert(point);
        }
        along_profile.push(place);
    }
    let refused = |value: String, expected: String| {
        InputError::refuse(body.name(), value, expected, "condense bodies of these surfaces")
    };
    if off > FARTHEST_SURFACE {
        let value = format!("a surface up to {:.2} mm off the nodes", off / MILLIMETRE);
        return refused(value, format!("{:.0} mm at most", FARTHEST_SURFACE / MILLIMETRE));
    }
    if let Some(point) = folded {
        let at = format!("at y = {:.1}, z = {:.1} mm", point.x / MILLIMETRE, point.y / MILLIMETRE);
        return refused(format!("a surface that folds {at}"), "one that runs along the nodes".into());
    }
    let along_track = grid.along_track.iter().map(|angle| angle * angles).collect();
    Ok((SurfaceGrid { along_profile, along_track, nodes: grid.nodes.clone() }, off))
}
