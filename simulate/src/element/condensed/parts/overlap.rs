//! Where two profiles overlap.
//!
//! At every place of the rail's profile the bodies, undeformed, overlap by a penetration along the rail's normal. Stations along the rail find the
//! places where there is one; Newton's method finds its ends, and what is opposite on the wheel.

mod extent;

use self::extent::{Bends, POINTS, gauss, joints};
use super::relief::{Influence, Relief, ReliefPlaces};
use nalgebra::{Point2, Rotation2, Vector2, Vector3};
use railspring_profiles::profile::ProfileCurve;
use std::ops::Range;

/// Distance of the stations at which contacts are looked for, m, and the least one, where a measured profile that is not smoothed has short waves.
const STATION: f64 = 1e-3;
const LEAST_STATION: f64 = 0.1e-3;

/// Curvatures that differ by more than this make a wave, 1/m: within a millimetre they move a penetration by 25 µm. Standards have none.
const WAVE: f64 = 200.0;

/// Least cosine of the angle between both profiles where they can touch.
const LEAST_COSINE: f64 = 0.3;

/// Stations nearer to an overlap than this are looked at whenever the bodies are, m; the farther ones when the bodies have moved by what they were away.
const NEAR: f64 = 20e-6;

/// Stations farther than this from an overlap are looked at together, once the bodies have moved so far, m.
const FAR: f64 = 200e-6;

/// The sharpest relative curvature that is looked for, 1/m: measured profiles have peaks of millimetres in radius.
const SHARPEST: f64 = 1000.0;

/// Newton steps along a profile: most of them, the longest, and the one after which the place is found, m: the steps halve their digits, and what a place
/// is off by changes the penetration by less than its slope times that.
const MOST_STEPS: usize = 40;
const LONGEST_STEP: f64 = 5e-3;
const SETTLED: f64 = 1e-7;

/// The last such step to what is opposite on the wheel, m: the parabola along it is off by less than a picometre where the curvature changes by 1000/m in a millimetre.
const FOOT: f64 = 1e-6;

/// Where both bodies are: displacements y and z (m) of their reference points and rotations about x (rad).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// The wheel, about the origin of its profile.
    pub wheel: Vector3<f64>,
    /// The rail, about its reference point.
    pub rail: Vector3<f64>,
}

/// A station on the rail.
#[derive(Debug, Clone, Copy)]
struct Station {
    s: f64,
    point: Point2<f64>,
    normal: Vector2<f64>,
    /// Arc length on the wheel opposite, m.
    wheel_s: f64,
    /// Penetration and its slope where the station was looked at last, m.
    depth: f64,
    slope: f64,
    /// Whether these are those of the last look.
    seen: bool,
    /// No penetration is larger than this and what the bodies have moved since they set out together, m.
    bound: f64,
}

/// Both running surfaces in place.
#[derive(Debug, Clone)]
pub struct Profiles<'a> {
    rail: &'a ProfileCurve,
    wheel: &'a ProfileCurve,
    /// World position of the wheel profile's origin at rest, m.
    origin: Point2<f64>,
    /// World position of the rail's reference point at rest, m.
    rail_origin: Point2<f64>,
    stations: Vec<Station>,
    /// What of a relief takes part at each station.
    weights: Vec<f64>,
    /// Where loads relieve others, if they do, and the relief under which the bodies are looked at.
    pub(super) places: Option<ReliefPlaces>,
    relief: Relief,
    /// A contact whose overlap is between two stations can be so much deeper than they are, m: an eighth of the sharpest relative curvature times the square of
    /// their distance.
    between: f64,
    /// Arc lengths at which the curvature of the rail and of the wheel jumps, m.
    joints: [Vec<f64>; 2],
    /// Middle of the rail's profile, and the largest distance of a station from there, m.
    middle: Point2<f64>,
    reach: f64,
    /// Place of the rail's profile in the wheel's frame at the last look.
    looked: Option<Turned>,
    /// What the profiles have moved against each other since the bounds set out, m.
    travel: f64,
    /// The bodies can move against each other by this, m, before they may overlap in another place or part in the middle of one.
    pub(super) gap: f64,
    /// The stations near an overlap, the first and the last, and the highest bound of all others.
    window: [usize; 2],
    outside: f64,
    /// Where the bodies may overlap.
    spans: Vec<Span>,
    /// Where they overlap the least between two deeper places: all, and those of the contact that is looked at, the deepest ones first.
    dips: Vec<Dip>,
    inside: Vec<Dip>,
    /// Places of the rail between which a contact is smooth, m.
    panels: Vec<f64>,
    /// Places and weights of the rule of integration on the interval from -1 to 1.
    rule: Vec<(f64, f64)>,
}

/// The rail's profile in the wheel's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Turned {
    turn: Rotation2<f64>,
    by: Vector2<f64>,
    /// The wheel in the world.
    pub wheel: Rotation2<f64>,
}

/// A part of the rail's profile on which the bodies may overlap once.
#[derive(Debug, Clone, Copy)]
struct Span {
    /// The stations before and behind it.
    stations: (usize, usize),
    /// Arc lengths at which they do not overlap any more, or where the profile ends, m.
    ends: [f64; 2],
}

/// A place of an overlap between two deeper ones.
#[derive(Debug, Clone, Copy)]
struct Dip {
    /// Arc length, m.
    s: f64,
    /// Share with which the overlap counts as two, from 1 where the bodies just touch there to 0 where they are hardly deeper beside it.
    share: f64,
}

/// A part of the rail's profile on which the bodies overlap.
#[derive(Debug, Clone, Copy)]
pub(super) struct Overlap {
    /// The arc lengths between which it is, m.
    pub extent: [f64; 2],
    /// The stations before and behind it.
    stations: (usize, usize),
}

/// One place of the rail against the wheel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Facing {
    /// Arc length on the wheel, m.
    pub wheel_s: f64,
    /// How far the bodies overlap along the rail's normal, m.
    pub penetration: f64,
    /// Change of the penetration along the rail, but for the curvature times the overlap.
    pub slope: f64,
    /// Weight of a relief and of the loads that make it.
    pub weight: f64,
    /// Cosine of the angle between the profiles.
    pub cosine: f64,
    /// Outward normal of the wheel, in the wheel's frame, and the change of its tangent along it, 1/m.
    pub outward: Vector2<f64>,
    /// See `outward`.
    pub bend: Vector2<f64>,
    /// Tangent of the rail, in the wheel's frame.
    pub along: Vector2<f64>,
    /// The rail's point in the wheel's frame.
    pub point: Point2<f64>,
}

impl<'a> Profiles<'a> {
    /// `rail` is in world coordinates, `wheel` in its profile frame, whose origin stands at the world point `origin`; motions of the
    /// rail are about `rail_origin`.
    pub fn new(
        rail: &'a ProfileCurve,
        wheel: &'a ProfileCurve,
        origin: Point2<f64>,
        rail_origin: Point2<f64>,
    ) -> Self {
        let [of_rail, of_wheel] = [rail, wheel].map(Bends::of);
        let curvature = of_rail.sharpest + of_wheel.sharpest;
        let waves = of_rail.shortest_wave.min(of_wheel.shortest_wave);
        let station = (0.25 * waves).clamp(LEAST_STATION, STATION);
        // the rule of integration sees two waves at a time
        let part = 8.0 * station;
        let parts = if waves.is_finite() { (rail.length() / part) as usize } else { 0 };
        let on_rail = joints(rail).into_iter().chain((1..=parts).map(|i| part * i as f64)).collect();
        let count = (rail.length() / station).ceil().max(2.0);
        let stations: Vec<Station> = (0..=count as usize)
            .map(|i| rail.length() * i as f64 / count)
            .map(|s| Station {
                s,
                point: rail.point(s),
                normal: rail.upward_normal(s),
                wheel_s: 0.0,
                depth: 0.0,
                slope: 0.0,
                seen: false,
                bound: f64::INFINITY,
            })
            .collect();
        let middle = rail.point(0.5 * rail.length());
        let between = 0.125 * curvature.min(SHARPEST) * station * station;
        let reach = stations.iter().map(|station| (station.point - middle).norm()).fold(0.0, f64::max);
        let mut profiles = Self {
            rail,
            wheel,
            origin,
            rail_origin,
            between,
            joints: [on_rail, joints(wheel)],
            panels: Vec::with_capacity(16),
            rule: gauss(POINTS),
            middle,
            reach,
            looked: None,
            travel: 0.0,
            gap: 0.0,
            window: [0, stations.len() - 1],
            outside: f64::INFINITY,
            spans: Vec::with_capacity(stations.len()),
            dips: Vec::with_capacity(stations.len()),
            inside: Vec::with_capacity(stations.len()),
            weights: vec![0.0; stations.len()],
            places: None,
            relief: Relief::default(),
            stations,
        };
        let rest = profiles.turned(&Pose::default());
        for i in 0..profiles.stations.len() {
            profiles.stations[i].wheel_s = profiles.opposite(&rest, i);
        }
        profiles
    }

    /// With loads that relieve others, by the weights along the rail.
    pub(super) fn relieved(mut self, influence: Influence, weight: impl Fn(f64) -> f64) -> Self {
        self.weights = self.stations.iter().map(|station| weight(station.s)).collect();
        self.places = ReliefPlaces::new(self.rail, influence);
        self
    }

    /// The weight of a relief and of the loads that make it at an arc length of the rail, and its slope, 1/m.
    fn weight(&self, s: f64) -> (f64, f64) {
        let last = self.weights.len() - 1;
        let density = last as f64 / self.stations[last].s;
        let at = (s * density).clamp(0.0, last as f64);
        let i = (at as usize).min(last - 1);
        let rise = self.weights[i + 1] - self.weights[i];
        (self.weights[i] + (at - i as f64) * rise, rise * density)
    }

    /// What the loads take off the penetration at an arc length of the rail, m, and its slope, with the weight there.
    fn relief_at(&self, s: f64) -> (f64, f64, f64) {
        let Some(places) = &self.places else { return (0.0, 0.0, 0.0) };
        let ((weight, rise), (relief, slope)) = (self.weight(s), places.at(&self.relief, s));
        (weight * relief, weight * slope + rise * relief, weight)
    }

    fn turned(&self, pose: &Pose) -> Turned {
        let (wheel, rail) = (Rotation2::new(pose.wheel.z).inverse(), Rotation2::new(pose.rail.z));
        // p = R(-w)·(C + R(r)·(x - C) + u - O - v)
        let centre = self.rail_origin.coords;
        let by = wheel * (centre + pose.rail.xy() - rail * centre - self.origin.coords - pose.wheel.xy());
        Turned { turn: wheel * rail, by, wheel: wheel.inverse() }
    }

    /// Largest motion of a place of the rail between two places of its profile, m.
    fn motion(&self, a: &Turned, b: &Turned) -> f64 {
        // a turn moves a point by the chord times its distance
        let chord = (a.turn.matrix().column(0) - b.turn.matrix().column(0)).norm();
        (a.at(&self.middle) - b.at(&self.middle)).norm() + self.reach * chord
    }

    /// Arc length on the wheel nearest to a station.
    fn opposite(&self, place: &Turned, station: usize) -> f64 {
        self.wheel.closest(&place.at(&self.stations[station].point)).0
    }

    /// The wheel over a place of the rail with its normal; none where it does not face it.
    fn facing(
        &self,
        place: &Turned,
        point: &Point2<f64>,
        normal: Vector2<f64>,
        guess: f64,
    ) -> Option<Facing> {
        let point = place.at(point);
        let normal = place.turn * normal;
        let along = Vector2::new(-normal.y, normal.x);
        let mut wheel_s = guess;
        for _ in 0..MOST_STEPS {
            let (foot, tangent, bend) = self.wheel.evaluate_twice(wheel_s);
            let advance = along.dot(&tangent);
            if advance < 0.5 * LEAST_COSINE {
                return None;
            }
            let step = along.dot(&(point - foot)) / advance;
            if step.abs() < FOOT {
                // the parabola there is the curve to the cube of the step
                let step = step - 0.5 * along.dot(&bend) * step * step / advance;
                let (foot, tangent) = (foot + step * (tangent + 0.5 * step * bend), tangent + step * bend);
                return Facing::new(point, normal, along, (wheel_s + step, foot, tangent, bend));
            }
            wheel_s += step.clamp(-LONGEST_STEP, LONGEST_STEP);
        }
        let (foot, tangent, bend) = self.wheel.evaluate_twice(wheel_s);
        Facing::new(point, normal, along, (wheel_s, foot, tangent, bend))
    }

    fn facing_at(&self, place: &Turned, s: f64, guess: f64) -> Option<Facing> {
        let (point, tangent) = self.rail.evaluate(s);
        let normal = Vector2::new(tangent.y, -tangent.x);
        let mut facing = self.facing(place, &point, normal, guess)?;
        let (relief, slope, weight) = self.relief_at(s);
        facing.penetration -= relief;
        facing.slope -= slope;
        facing.weight = weight;
        Some(facing)
    }

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

    /// World position of the wheel's reference point at rest, m.
    pub(super) fn wheel_origin(&self) -> Point2<f64> {
        self.origin
    }

    /// Motion of the wheel against the rail from one pose to another, about the wheel's reference point where that is then.
    pub(super) fn motion_between(&self, from: &Pose, to: &Pose) -> Vector3<f64> {
        let rail = to.rail - from.rail;
        let arm = self.origin + to.wheel.xy() - self.rail_origin - to.rail.xy();
        to.wheel - from.wheel - Vector3::new(rail.x - arm.y * rail.z, rail.y + arm.x * rail.z, rail.z)
    }

    /// Length of the rail's profile, m.
    pub fn rail_length(&self) -> f64 {
        self.rail.length()
    }

    /// Arc length on the wheel near that opposite to a place of the rail.
    fn guess(&self, s: f64, (low, high): (usize, usize)) -> f64 {
        let step = self.stations[1].s - self.stations[0].s;
        let i = ((s / step) as usize).clamp(low, high - 1);
        let (a, b) = (&self.stations[i], &self.stations[i + 1]);
        a.wheel_s + (s - a.s) / (b.s - a.s) * (b.wheel_s - a.wheel_s)
    }
}

impl Facing {
    /// From the place of the rail in the wheel's frame with its normal and the tangent across it, and the `foot` on the wheel: its arc length, point, tangent and the
    /// change of that.
    fn new(
        point: Point2<f64>,
        normal: Vector2<f64>,
        along: Vector2<f64>,
        (wheel_s, foot, tangent, bend): (f64, Point2<f64>, Vector2<f64>, Vector2<f64>),
    ) -> Option<Self> {
        let cosine = along.dot(&tangent);
        if cosine < LEAST_COSINE {
            return None;
        }
        // the wheel's outward normal, towards the rail
        let outward = Vector2::new(-tangent.y, tangent.x);
        Some(Self {
            wheel_s,
            penetration: (point - foot).dot(&normal),
            slope: -normal.dot(&tangent) / cosine,
            weight: 0.0,
            cosine,
            outward,
            bend,
            along,
            point,
        })
    }
}

impl Turned {
    fn at(&self, point: &Point2<f64>) -> Point2<f64> {
        Point2::from(self.turn * point.coords + self.by)
    }
}

#[cfg(test)]
mod tests;
