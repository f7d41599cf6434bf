//! Wheel and rail where they are not meshed for contact: a wheel that has left the rail may come down there.
//!
//! The contact of a step is found between the contact nodes of the meshes. The profiles go on beyond these, and the bodies with them: where the
//! profiles come nearest to each other outside of the nodes and overlap, the wheel stands on a place that the meshes do not have. A patch
//! that grows out of the zone is another matter: its least gap lies inside, and its points at the edge carry load.
//!
//! Beyond its nodes a body moves as the places of the step do, with what its nearest node moves beyond them. A turn of the wheel about y or z
//! has its least gap before or behind the middle of the window.

use super::load_case::hub_motions;
use super::model::TransientModel;
use super::run::{Reached, Step};
use crate::time::history::SurfaceEnd;
use crate::time::scenario::Scenario;
use nalgebra::Vector2;
use railspring_calibrate::calibration::{Change, Places};
use railspring_calibrate::contact::{Shape, Surface};

/// Distance of the places on the rail at which the gap is looked at, m. Between them it is taken as a parabola: on the smallest radius of
/// profiles, 13 mm, the third derivative of a gap leaves less than a micrometre of it.
const SPACING: f64 = 0.5e-3;
/// A gap that is smaller than this is none between surfaces that face each other, m: no wheel comes as deep within a step.
const DEEPEST: f64 = -2e-3;
/// Of what the bodies move, what a gap may change by that the places do not say, m: nodes move some tens of micrometres beyond them.
const BEYOND_PLACES: f64 = 0.1e-3;
/// The surfaces are looked at again once they have moved by as much at the latest, m: other places face each other then.
const FARTHEST: f64 = 2e-3;
/// No part of a profile is farther from the patch, m.
const ARM: f64 = 0.15;

/// A place of the rail with the wheel's above it.
#[derive(Clone, Copy)]
struct Facing {
    /// Arc lengths on rail and wheel, m.
    rail: f64,
    wheel: f64,
    /// Rigid gap in the places of the step, m.
    gap: f64,
    /// Whether the contact nodes of both bodies reach over it.
    meshed: bool,
}

/// Looks for such places step by step.
pub(super) struct Beyond<'m> {
    model: &'m TransientModel<'m>,
    /// Whether the wheel turns about y and z.
    turns: bool,
    /// Where the bodies were when they were last looked at, and the least gap outside of the meshed zone there, m.
    seen: Option<(Places, f64)>,
}

impl<'m> Beyond<'m> {
    pub fn new(model: &'m TransientModel<'m>, scenario: &Scenario) -> Self {
        Self { model, turns: hub_motions(scenario).len() > 2, seen: None }
    }

    /// The end of the meshed surfaces at which or beyond which wheel and rail touch at the end of a step, if they do.
    pub fn reached(&mut self, step: &Step) -> Option<Reached> {
        let at_the_end = step.contact.edge_reached(self.model.rail_surface.grid).and_then(SurfaceEnd::of);
        if let Some(end) = at_the_end {
            return Some(Reached { end, rail: self.model.loaded_edge(step.contact) });
        }
        let places = step.contact.settled.as_ref()?.places(step.hub.position());
        if let (Some((seen, gap)), false) = (&self.seen, self.turns)
            && way(&places.since(seen)) + BEYOND_PLACES < *gap
        {
            return None;
        }
        let [rail, wheel] = self.placed(&places);
        let facing = facing(&rail, &wheel);
        let outside = facing.iter().flatten().filter(|place| !place.meshed);
        self.seen = Some((places, outside.map(|place| place.gap).fold(FARTHEST, f64::min)));
        let touches = |minimum: &Facing| self.touched(minimum, &places, step);
        let (at, end) = minima(&facing).iter().find_map(touches)?;
        Some(Reached { end, rail: self.model.placed_rail.to_profile(&self.model.rail_surface.world(at)) })
    }

    fn placed(&self, places: &Places) -> [Surface<'m>; 2] {
        let Places([rail, wheel]) = places;
        [self.model.rail_surface.placed(rail), self.model.wheel_surface.placed(wheel)]
    }

    /// The end beyond which the surfaces overlap at a minimum of their gap, with the arc length on the rail.
    fn touched(&self, minimum: &Facing, places: &Places, step: &Step) -> Option<(f64, SurfaceEnd)> {
        let [rail, wheel] = self.placed(places);
        let normal = rail.normal(minimum.rail);
        let sides = [(&self.model.rail_surface, minimum.rail), (&self.model.wheel_surface, minimum.wheel)];
        // of the nodes at both ends of the window and in its middle, along the normal: beyond the places
        let [of_rail, of_wheel] = [0, 1].map(|body| {
            let (surface, s) = sides[body];
            let columns = surface.grid.along_track.len();
            [0, columns / 2, columns - 1].map(|column| {
                let node = nearest(&surface.grid.along_profile, s) * columns + column;
                let moved = &step.displacements[body][3 * node + 1..3 * node + 3];
                let placed = places.0[body].displacement(&surface.node(node));
                let x = surface.x(s, surface.grid.along_track[column]);
                (x, normal.dot(&(Vector2::new(moved[0], moved[1]) - placed)))
            })
        });
        let gap = minimum.gap + of_wheel[1].1 - of_rail[1].1;
        let slope = |of: [(f64, f64); 3]| (of[2].1 - of[0].1) / (of[2].0 - of[0].0);
        let slope = if self.turns { slope(of_wheel) - slope(of_rail) } else { 0.0 };
        // the wheel rises from the middle with its curvature in the plane of the normal
        let curvature = curvature_along(&wheel, minimum.wheel, &normal);
        let ahead = if curvature > 0.0 { -slope / curvature } else { 0.0 };
        let least = gap + 0.5 * slope * ahead;
        if least >= 0.0 {
            return None;
        }
        let in_window = [of_rail, of_wheel].iter().all(|of| of[0].0 < ahead && ahead < of[2].0);
        match (minimum.meshed, in_window) {
            (false, _) => Some((minimum.rail, SurfaceEnd::ContactZone)),
            (true, false) => Some((minimum.rail, SurfaceEnd::ContactWindow)),
            (true, true) => None,
        }
    }
}

/// What a gap may have changed by, m.
fn way(change: &Change) -> f64 {
    change.iter().map(|(shift, angle)| shift.norm() + ARM * angle.abs()).sum()
}

/// Curvature of a wheel along the track in the plane of a normal, 1/m.
fn curvature_along(wheel: &Surface, s: f64, normal: &Vector2<f64>) -> f64 {
    match wheel.shape {
        Shape::Extruded => 0.0,
        Shape::Revolved { radius } => normal.y.abs() / (radius + wheel.curve.point(s).y),
    }
}

/// The places along the rail's profile with the wheel above them.
fn facing(rail: &Surface, wheel: &Surface) -> Vec<Option<Facing>> {
    let length = rail.curve.length();
    let parts = (length / SPACING).ceil();
    let place = |i: usize| {
        let s = length * i as f64 / parts;
        let point = rail.world(s);
        let on_wheel = wheel.nearest(&point);
        let apart = wheel.world(on_wheel) - point;
        // the wheel's material lies above its curve
        let up = wheel.normal(on_wheel);
        let gap = up.dot(&apart);
        // beyond an end of the wheel's profile, and behind it
        let faces = up.dot(&rail.normal(s)) > 0.5 && up.perp(&apart).abs() < SPACING && gap > DEEPEST;
        let within = |lines: &[f64], s: f64| lines[0] <= s && s <= lines[lines.len() - 1];
        let meshed = within(&rail.grid.along_profile, s) && within(&wheel.grid.along_profile, on_wheel);
        faces.then_some(Facing { rail: s, wheel: on_wheel, gap, meshed })
    };
    (0..=parts as usize).map(place).collect()
}

/// The least of the gaps among their neighbours, on the parabola through them.
fn minima(facing: &[Option<Facing>]) -> Vec<Facing> {
    let gap = |i: Option<usize>| i.and_then(|i| facing.get(i)?.as_ref()).map(|place| place.gap);
    let least = |i: usize| {
        let place = facing[i]?;
        let [before, after] = [gap(i.checked_sub(1)), gap(Some(i + 1))];
        if before.is_some_and(|before| before < place.gap) || after.is_some_and(|after| after <= place.gap) {
            return None;
        }
        let (Some(before), Some(after)) = (before, after) else { return Some(place) };
        let bend = before - 2.0 * place.gap + after;
        let below = if bend > 0.0 { (after - before).powi(2) / (8.0 * bend) } else { 0.0 };
        Some(Facing { gap: place.gap - below, ..place })
    };
    (0..facing.len()).filter_map(least).collect()
}

/// The line of a grid nearest to a place.
fn nearest(lines: &[f64], at: f64) -> usize {
    let after = lines.partition_point(|line| *line < at).min(lines.len() - 1);
    let before = after.saturating_sub(1);
    if (at - lines[before]).abs() < (lines[after] - at).abs() { before } else { after }
}
