//! Where two profiles overlap.
//!
//! At every place of the rail's profile the bodies, undeformed, overlap by a penetration along the rail's normal. Stations along the rail find the
//! places where there is one; Newton's method finds its ends, and what is opposite on the wheel.

mod bends;
mod rule;
mod facing;
mod profiles;
mod extent;

use self::profiles::{Dip, Span, Station};
use crate::relief::Relief;
use nalgebra::Vector2;
use std::ops::Range;

pub(super) use self::facing::{Facing, Turned};
pub(super) use self::profiles::Overlap;
pub use self::profiles::{Pose, Profiles};

/// Stations nearer to an overlap than this are looked at whenever the bodies are, m; the farther ones when the bodies have moved by what they were away.
const NEAR: f64 = 20e-6;

/// Stations farther than this from an overlap are looked at together, once the bodies have moved so far, m.
const FAR: f64 = 200e-6;

impl Profiles {
    /// Looks at a station; none of its penetrations is larger than the `bound` and what the bodies move.
    fn look_at(&mut self, place: &Turned, i: usize) {
        let Station { point, normal, wheel_s, .. } = self.stations[i];
        let mut found = self.facing(place, &point, normal, wheel_s);
        let mut apart = 0.0;
        if found.is_none() {
            let nearest = self.opposite(place, i);
            found = self.facing(place, &point, normal, nearest);
            if found.is_none() {
                let (foot, tangent) = self.wheel.evaluate(nearest);
                let outward = Vector2::new(-tangent.y, tangent.x);
                apart = (place.at(&point) - foot).dot(&outward).max(0.0);
            }
        }
        let travel = self.travel;
        let station = &mut self.stations[i];
        match found {
            Some(found) => {
                (station.wheel_s, station.depth, station.slope) =
                    (found.wheel_s, found.penetration, found.slope);
                // along the rail's normal the wheel is farther than where it is nearest
                let distance = found.penetration.min(0.0) * found.cosine * found.cosine;
                (station.seen, station.bound) = (true, found.penetration.max(distance) - travel);
            }
            // until it faces the wheel it does not count
            None => {
                (station.depth, station.seen) = (f64::NEG_INFINITY, false);
                station.bound = -apart - travel;
            }
        }
    }

    /// Looks at the stations where the bodies can overlap, and lists where they may.
    fn look(&mut self, place: &Turned) {
        self.spans.clear();
        self.dips.clear();
        self.travel += self.looked.map_or(f64::INFINITY, |looked| self.motion(&looked, place));
        self.looked = Some(*place);
        if !self.travel.is_finite() || self.travel > 1.0 {
            self.travel = 0.0;
            self.outside = f64::INFINITY;
            self.stations.iter_mut().for_each(|station| station.bound = f64::INFINITY);
        }
        let travel = self.travel;
        let whole = self.outside + travel > -self.between;
        let last = self.stations.len() - 1;
        let [first, end] = if whole { [0, last] } else { self.window };
        for i in first..=end {
            let bound = self.stations[i].bound + travel;
            if bound > if whole { -FAR } else { -self.between - NEAR } {
                self.look_at(place, i);
            } else {
                (self.stations[i].depth, self.stations[i].seen) = (bound, false);
            }
        }
        if whole {
            let close = |station: &Station| station.bound + travel > -FAR;
            let first = self.stations.iter().position(close).unwrap_or(last);
            let end = self.stations.iter().rposition(close).unwrap_or(last);
            // with a neighbour on either side
            self.window = [first.saturating_sub(1), (end + 1).min(last)];
            let [first, end] = self.window;
            let others = self.stations[..first].iter().chain(&self.stations[end + 1..]);
            self.outside = others.map(|station| station.bound).fold(f64::NEG_INFINITY, f64::max);
        }
        let [first, end] = self.window;
        if self.places.is_some() {
            // the others do not overlap anyway
            for i in first..=end {
                if self.stations[i].depth <= -self.between {
                    continue;
                }
                let (relief, slope, _) = self.relief_at(self.stations[i].s);
                self.stations[i].depth -= relief;
                self.stations[i].slope -= slope;
            }
        }
        self.gap = -(self.outside + travel);
        let depth = |i: usize| self.stations[i].depth;
        let mut i = first;
        while i <= end {
            if depth(i) > 0.0 {
                let from = i;
                while i <= end && depth(i) > 0.0 {
                    i += 1;
                }
                let mut rest = self.span(from.saturating_sub(1), i.min(last));
                for j in from..i.saturating_sub(1) {
                    let dip = self.dip(place, j);
                    self.gap = dip.map_or(self.gap, |(_, least)| self.gap.min(least.abs()));
                    match dip {
                        Some((gap, least)) if least <= 0.0 => {
                            let ends = [rest.ends[0], gap];
                            self.spans.push(Span { stations: (rest.stations.0, j + 1), ends });
                            rest = Span { stations: (j, rest.stations.1), ends: [gap, rest.ends[1]] };
                        }
                        Some((s, least)) => {
                            let beside = self.deepest(from..j + 1).min(self.deepest(j + 1..i));
                            self.dips.push(Dip { s, share: Dip::share(least / beside) });
                        }
                        None => {}
                    }
                }
                self.spans.push(rest);
                continue;
            }
            // a contact may be narrower than the distance of two stations
            let peak = i > first && i < end && depth(i) >= depth(i - 1) && depth(i) > depth(i + 1);
            let above = self.above(i);
            if peak && depth(i) > -above && depth(i - 1) <= 0.0 && depth(i + 1) <= 0.0 {
                self.spans.push(self.span(i - 1, i + 1));
            } else if depth(i) >= depth(i.max(first + 1) - 1) && depth(i) >= depth((i + 1).min(end)) {
                self.gap = self.gap.min(-above - depth(i));
            }
            i += 1;
        }
    }

    /// The largest penetration at these stations, m.
    fn deepest(&self, stations: Range<usize>) -> f64 {
        self.stations[stations].iter().map(|station| station.depth).fold(0.0, f64::max)
    }

    fn span(&self, low: usize, high: usize) -> Span {
        Span { stations: (low, high), ends: [self.stations[low].s, self.stations[high].s] }
    }

    /// Looks at the bodies at a pose under a relief: where the rail is in the wheel's frame, and in how many places they may overlap.
    pub(super) fn at(&mut self, pose: &Pose, relief: &Relief) -> (Turned, usize) {
        let place = self.turned(pose);
        self.relief.copy_from(relief);
        self.look(&place);
        (place, self.spans.len())
    }

    /// One of these places, in the order of the rail's profile, if the bodies overlap there.
    pub(super) fn overlap(&mut self, place: &Turned, number: usize) -> Option<Overlap> {
        let span = self.spans[number];
        match self.extent(place, span) {
            Ok(extent) => Some(Overlap { extent, stations: span.stations }),
            Err(apart) => {
                self.gap = self.gap.min(apart);
                None
            }
        }
    }

    /// The wheel over a place of the rail in an overlap.
    pub(super) fn over(&self, place: &Turned, overlap: &Overlap, s: f64) -> Option<Facing> {
        self.facing_at(place, s, self.guess(s, overlap.stations))
    }

    /// The relief at the last look.
    pub(super) fn relief(&self) -> &Relief {
        &self.relief
    }
}

#[cfg(test)]
mod tests;
