//! Both running surfaces in place, with the stations along the rail.

use super::bends::{Bends, LEAST_STATION, joints};
use super::facing::{Facing, LEAST_COSINE, Turned};
use super::rule::{POINTS, gauss};
use crate::relief::{Influence, Relief, ReliefPlaces};
use nalgebra::{Point2, Rotation2, Vector2, Vector3};
use railspring_profiles::profile::ProfileCurve;
use std::sync::Arc;

/// Distance of the stations at which contacts are looked for, m.
const STATION: f64 = 1e-3;

/// The sharpest relative curvature that is looked for, 1/m: measured profiles have peaks of millimetres in radius.
const SHARPEST: f64 = 1000.0;

/// Newton steps along a profile: most of them, the longest, and the one after which the place is found, m: the steps halve their digits, and what a place
/// is off by changes the penetration by less than its slope times that.
pub(super) const MOST_STEPS: usize = 40;
const LONGEST_STEP: f64 = 5e-3;
pub(super) const SETTLED: f64 = 1e-7;

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
pub(super) struct Station {
    pub s: f64,
    pub point: Point2<f64>,
    pub normal: Vector2<f64>,
    /// Arc length on the wheel opposite, m.
    pub wheel_s: f64,
    /// Penetration and its slope where the station was looked at last, m.
    pub depth: f64,
    pub slope: f64,
    /// Whether these are those of the last look.
    pub seen: bool,
    /// No penetration is larger than this and what the bodies have moved since they set out together, m.
    pub bound: f64,
}

/// Both running surfaces in place.
#[derive(Debug, Clone)]
pub struct Profiles {
    pub(super) rail: Arc<ProfileCurve>,
    pub(super) wheel: Arc<ProfileCurve>,
    /// World position of the wheel profile's origin at rest, m.
    origin: Point2<f64>,
    /// World position of the rail's reference point at rest, m.
    rail_origin: Point2<f64>,
    pub(super) stations: Vec<Station>,
    /// What of a relief takes part at each station.
    pub(super) weights: Vec<f64>,
    /// Where loads relieve others, if they do, and the relief under which the bodies are looked at.
    pub(crate) places: Option<ReliefPlaces>,
    pub(super) relief: Relief,
    /// A contact whose overlap is between two stations can be so much deeper than they are, m: an eighth of the sharpest relative curvature times the square of
    /// their distance.
    pub(super) between: f64,
    /// Arc lengths at which the curvature of the rail and of the wheel jumps, m.
    pub(super) joints: [Vec<f64>; 2],
    /// Middle of the rail's profile, and the largest distance of a station from there, m.
    middle: Point2<f64>,
    reach: f64,
    /// Place of the rail's profile in the wheel's frame at the last look.
    pub(super) looked: Option<Turned>,
    /// What the profiles have moved against each other since the bounds set out, m.
    pub(super) travel: f64,
    /// The bodies can move against each other by this, m, before they may overlap in another place or part in the middle of one.
    pub(crate) gap: f64,
    /// The stations near an overlap, the first and the last, and the highest bound of all others.
    pub(super) window: [usize; 2],
    pub(super) outside: f64,
    /// Where the bodies may overlap.
    pub(super) spans: Vec<Span>,
    /// Where they overlap the least between two deeper places: all, and those of the contact that is looked at, the deepest ones first.
    pub(super) dips: Vec<Dip>,
    pub(super) inside: Vec<Dip>,
    /// Places of the rail between which a contact is smooth, m.
    pub(super) panels: Vec<f64>,
    /// Places and weights of the rule of integration on the interval from -1 to 1.
    pub(super) rule: Vec<(f64, f64)>,
}

/// A part of the rail's profile on which the bodies may overlap once.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    /// The stations before and behind it.
    pub stations: (usize, usize),
    /// Arc lengths at which they do not overlap any more, or where the profile ends, m.
    pub ends: [f64; 2],
}

/// A place of an overlap between two deeper ones.
#[derive(Debug, Clone, Copy)]
pub(super) struct Dip {
    /// Arc length, m.
    pub s: f64,
    /// Share with which the overlap counts as two, from 1 where the bodies just touch there to 0 where they are hardly deeper beside it.
    pub share: f64,
}

/// A part of the rail's profile on which the bodies overlap.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Overlap {
    /// The arc lengths between which it is, m.
    pub extent: [f64; 2],
    /// The stations before and behind it.
    pub(super) stations: (usize, usize),
}

impl Profiles {
    /// `rail` is in world coordinates, `wheel` in its profile frame, whose origin stands at the world point `origin`; motions of the
    /// rail are about `rail_origin`.
    pub fn new(
        rail: &ProfileCurve,
        wheel: &ProfileCurve,
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
            rail: Arc::new(rail.clone()),
            wheel: Arc::new(wheel.clone()),
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

    /// Takes over what has been looked at on the same profiles in the same places, in the memory that there is.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        let Self {
            stations, relief, looked, travel, gap, window, outside, spans, dips, inside, panels, ..
        } = other;
        (self.looked, self.travel, self.gap) = (*looked, *travel, *gap);
        (self.window, self.outside) = (*window, *outside);
        self.stations.clone_from(stations);
        self.relief.copy_from(relief);
        self.spans.clone_from(spans);
        self.dips.clone_from(dips);
        self.inside.clone_from(inside);
        self.panels.clone_from(panels);
    }

    /// With loads that relieve others, by the weights along the rail.
    pub(crate) fn relieved(mut self, influence: Influence, weight: impl Fn(f64) -> f64) -> Self {
        self.weights = self.stations.iter().map(|station| weight(station.s)).collect();
        self.places = ReliefPlaces::new(&self.rail, influence);
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
    pub(super) fn relief_at(&self, s: f64) -> (f64, f64, f64) {
        let Some(places) = &self.places else { return (0.0, 0.0, 0.0) };
        let ((weight, rise), (relief, slope)) = (self.weight(s), places.at(&self.relief, s));
        (weight * relief, weight * slope + rise * relief, weight)
    }

    pub(super) fn turned(&self, pose: &Pose) -> Turned {
        let (wheel, rail) = (Rotation2::new(pose.wheel.z).inverse(), Rotation2::new(pose.rail.z));
        // p = R(-w)·(C + R(r)·(x - C) + u - O - v)
        let centre = self.rail_origin.coords;
        let by = wheel * (centre + pose.rail.xy() - rail * centre - self.origin.coords - pose.wheel.xy());
        Turned { turn: wheel * rail, by, wheel: wheel.inverse() }
    }

    /// Largest motion of a place of the rail between two places of its profile, m.
    pub(super) fn motion(&self, a: &Turned, b: &Turned) -> f64 {
        // a turn moves a point by the chord times its distance
        let chord = (a.turn.matrix().column(0) - b.turn.matrix().column(0)).norm();
        (a.at(&self.middle) - b.at(&self.middle)).norm() + self.reach * chord
    }

    /// Arc length on the wheel nearest to a station.
    pub(super) fn opposite(&self, place: &Turned, station: usize) -> f64 {
        self.wheel.closest(&place.at(&self.stations[station].point)).0
    }

    /// The wheel over a place of the rail with its normal; none where it does not face it.
    pub(super) fn facing(
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

    pub(super) fn facing_at(&self, place: &Turned, s: f64, guess: f64) -> Option<Facing> {
        let (point, tangent) = self.rail.evaluate(s);
        let normal = Vector2::new(tangent.y, -tangent.x);
        let mut facing = self.facing(place, &point, normal, guess)?;
        let (relief, slope, weight) = self.relief_at(s);
        facing.penetration -= relief;
        facing.slope -= slope;
        facing.weight = weight;
        Some(facing)
    }

    /// World position of the wheel's reference point at rest, m.
    pub(crate) fn wheel_origin(&self) -> Point2<f64> {
        self.origin
    }

    /// Motion of the wheel against the rail from one pose to another, about the wheel's reference point where that is then.
    pub(crate) fn motion_between(&self, from: &Pose, to: &Pose) -> Vector3<f64> {
        let rail = to.rail - from.rail;
        let arm = self.origin + to.wheel.xy() - self.rail_origin - to.rail.xy();
        to.wheel - from.wheel - Vector3::new(rail.x - arm.y * rail.z, rail.y + arm.x * rail.z, rail.z)
    }

    /// Length of the rail's profile, m.
    pub fn rail_length(&self) -> f64 {
        self.rail.length()
    }

    /// Arc length on the wheel near that opposite to a place of the rail.
    pub(super) fn guess(&self, s: f64, (low, high): (usize, usize)) -> f64 {
        let step = self.stations[1].s - self.stations[0].s;
        let i = ((s / step) as usize).clamp(low, high - 1);
        let (a, b) = (&self.stations[i], &self.stations[i + 1]);
        a.wheel_s + (s - a.s) / (b.s - a.s) * (b.wheel_s - a.wheel_s)
    }
}
