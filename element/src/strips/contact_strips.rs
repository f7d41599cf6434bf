//! Two profiles with the strips between them, as they are found at a pose.

use super::strip::{End, Strip};
use super::taken_up::TakenUp;
use crate::modulus::StripLaw;
use crate::overlap::{Pose, Profiles, Turned};
use crate::relief::{Loading, Relief};
use nalgebra::Vector3;
use std::ops::Range;

/// A penetration at the end of a contact that is larger, m, ends with the profile.
const CLOSED: f64 = 1e-8;

/// The strips of a contact.
#[derive(Debug, Clone)]
pub(super) struct Patch {
    pub extent: [f64; 2],
    pub strips: Range<usize>,
    pub ends: Range<usize>,
    /// The numbers of what its forces change by with the relief.
    pub gradients: [usize; 2],
    /// Its deepest strip, and the penetration there, m.
    pub deepest: usize,
    pub depth: f64,
}

/// Two profiles with the strips between them.
#[derive(Debug, Clone)]
pub struct ContactStrips {
    pub(super) profiles: Profiles,
    pub(super) loading: Loading,
    /// The relief that the loads made where the contacts were looked at last.
    pub(super) made: Relief,
    pub(super) strips: Vec<Strip>,
    pub(super) ends: Vec<End>,
    pub(super) patches: Vec<Patch>,
    /// Where they were found, with the rail in the wheel's frame there.
    pub(super) found: Option<(Pose, Turned)>,
    /// Where they were looked at last, and the motion of the wheel against the rail from the one to the other, in the wheel's frame.
    pub(super) looked: Pose,
    pub(super) motion: Vector3<f64>,
    /// Whether the next look finds them anew.
    pub(super) anew: bool,
    pub(super) taken_up: TakenUp,
}

impl ContactStrips {
    /// Strips of a law between two profiles.
    pub fn new(profiles: Profiles, law: &impl StripLaw) -> Self {
        let profiles = profiles.relieved(law.influence(), |s| law.modulus(s).relief);
        Self {
            taken_up: TakenUp::nothing(profiles.rail_length()),
            profiles,
            loading: Loading::default(),
            made: Relief::default(),
            strips: Vec::new(),
            ends: Vec::new(),
            patches: Vec::new(),
            found: None,
            looked: Pose::default(),
            motion: Vector3::zeros(),
            anew: false,
        }
    }

    /// Takes over the state of others between the same profiles, in the memory that there is.
    pub fn copy_from(&mut self, other: &Self) {
        let Self { profiles, loading, made, strips, ends, patches, found, looked, motion, anew, taken_up } =
            other;
        self.profiles.copy_from(profiles);
        self.loading.copy_from(loading);
        self.made.copy_from(made);
        self.strips.clone_from(strips);
        self.ends.clone_from(ends);
        self.patches.clone_from(patches);
        self.taken_up.copy_from(taken_up);
        (self.found, self.looked, self.motion, self.anew) = (*found, *looked, *motion, *anew);
    }

    /// Motion of the wheel against the rail from where the strips were found to a pose, in the wheel's frame.
    pub(super) fn motion_to(&self, pose: &Pose) -> Vector3<f64> {
        let Some((found, place)) = &self.found else { return Vector3::zeros() };
        let moved = self.profiles.motion_between(found, pose);
        let way = place.wheel.inverse() * moved.xy();
        Vector3::new(way.x, way.y, moved.z)
    }

    /// Finds the strips at a pose.
    pub(super) fn find(&mut self, pose: &Pose, law: &impl StripLaw, coefficient: f64) {
        let Self { profiles, strips, ends, patches, .. } = self;
        let (place, count) = profiles.at(pose, &self.made);
        strips.clear();
        ends.clear();
        patches.clear();
        for number in 0..count {
            let Some(overlap) = profiles.overlap(&place, number) else { continue };
            let (first, first_end) = (strips.len(), ends.len());
            profiles.integrate(&overlap, |profiles, s, width| {
                let here = profiles.over(&place, &overlap, s).filter(|here| here.penetration > 0.0);
                strips.extend(here.map(|here| Strip::new(profiles, &here, [s, width], law)));
            });
            let all = first..strips.len();
            let Some(deepest) = all.clone().max_by(|a, b| strips[*a].depth.total_cmp(&strips[*b].depth))
            else {
                continue;
            };
            for s in overlap.extent {
                let Some(here) = profiles.over(&place, &overlap, s) else { continue };
                if here.penetration.abs() > CLOSED || here.slope == 0.0 {
                    continue;
                }
                let strip = Strip::new(profiles, &here, [s, 0.0], law);
                let apart = |i: &usize| (strips[*i].rail_s - s).abs();
                let nearest = all.clone().min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or(first);
                ends.push(End { strip: Strip { depth: 0.0, ..strip }, slope: here.slope.abs(), nearest });
            }
            let (depth, ends) = (strips[deepest].depth, first_end..ends.len());
            let (extent, gradients) = (overlap.extent, [0; 2]);
            patches.push(Patch { extent, strips: all, ends, gradients, deepest, depth });
        }
        self.found = Some((*pose, place));
        (self.looked, self.motion) = (*pose, Vector3::zeros());
        if coefficient > 0.0 {
            for strip in &mut self.strips {
                strip.before = self.taken_up.at(strip.rail_s);
            }
        }
    }
}
