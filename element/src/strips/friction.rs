//! What friction takes up in a step, and how it is kept.

use super::contact_strips::ContactStrips;
use super::strip::Strip;
use super::taken_up::TakenUp;
use crate::overlap::Pose;

/// Way by which that of the wheel may be longer than the straight one, m, before what friction takes up is kept.
const DETOUR: f64 = 0.1e-6;

impl ContactStrips {
    /// Friction begins where the contacts have been looked at last, with no way behind it.
    pub fn begin_friction(&mut self) {
        (self.taken_up.committed, self.taken_up.kept) = (self.looked, self.looked);
    }

    /// A step ends where the contacts have been looked at last: what friction has taken up there stays with the places of the rail.
    pub fn commit(&mut self, coefficient: f64) {
        if coefficient == 0.0 {
            self.taken_up.committed = self.looked;
            return;
        }
        let way = |from: &Pose| self.profiles.motion_between(from, &self.looked).xy().norm();
        let (step, straight) = (way(&self.taken_up.committed), way(&self.taken_up.kept));
        // strips that slide to and fro take up something else than the way from start to end says: what they had before they turned is kept
        if self.taken_up.way + step > straight + DETOUR {
            self.keep(coefficient);
        }
        for strip in &mut self.strips {
            strip.before = strip.now;
        }
        let taken_up = &mut self.taken_up;
        (taken_up.committed, taken_up.stepped) = (self.looked, true);
        taken_up.way += step;
    }

    /// Keeps what the strips have taken up at the end of the last step.
    pub(super) fn keep(&mut self, coefficient: f64) {
        if !self.taken_up.stepped {
            return;
        }
        let [then, now] = [self.taken_up.kept, self.taken_up.committed].map(|pose| self.motion_to(&pose));
        let Self { profiles, strips, ends, patches, loading, made, motion, taken_up, .. } = self;
        let TakenUp { values, next, filled, density, places, .. } = taken_up;
        loading.guess(made, profiles.relief(), &(now - *motion));
        next[filled[1].clone()].fill(0.0);
        filled[1] = next.len()..0;
        for patch in patches.iter() {
            let place = |strip: &Strip| {
                let pressed = strip.pressed(&now, loading.shift(&strip.bells));
                [
                    strip.rail_s,
                    strip.limit(coefficient, pressed.normal.max(0.0)),
                    strip.aside.dot(&(now - then)),
                ]
            };
            places.clear();
            places.extend(strips[patch.strips.clone()].iter().map(place));
            places.extend(ends[patch.ends.clone()].iter().map(|end| place(&end.strip)));
            places.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
            // between two strips the limit is that of a parabola over the contact
            let most = places.iter().map(|place| place[1]).fold(0.0, f64::max);
            let bulge = 4.0 * most / (patch.extent[1] - patch.extent[0]).powi(2);
            for pair in places.windows(2) {
                let [[from, limit, way], [to, other_limit, other_way]] = [pair[0], pair[1]];
                let [first, last] =
                    [from, to].map(|s| ((s.max(0.0) * *density).ceil() as usize).min(next.len()));
                filled[1] = filled[1].start.min(first)..filled[1].end.max(last);
                for i in first..last {
                    let [before, behind] = [i as f64 / *density - from, to - i as f64 / *density];
                    let share = before / (to - from);
                    let limit = limit + share * (other_limit - limit) + bulge * before * behind;
                    let way = way + share * (other_way - way);
                    next[i] = (values[i] + way).clamp(-limit, limit);
                }
            }
        }
        filled[1].start = filled[1].start.min(filled[1].end);
        std::mem::swap(values, next);
        filled.swap(0, 1);
        (taken_up.kept, taken_up.way, taken_up.stepped) = (taken_up.committed, 0.0, false);
    }
}
