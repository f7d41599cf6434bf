//! The contact of two profiles as strips across the track.
//!
//! At every place of the rail's profile the bodies, undeformed, overlap by a penetration along the rail's normal. A strip of
//! the contact there carries a normal force per length that grows with it; the force of a contact is the sum over
//! its width, along the normals of the wheel. So a contact is as wide as the profiles make it, two contacts that
//! grow together become one, and nothing jumps: the forces have a potential. J. Piotrowski, H. Chollet, "Wheel–rail contact
//! models for vehicle system dynamics including multi-point contact", Vehicle Syst. Dyn. 43 (2005), call such a method one of virtual
//! penetration; here its stiffness is that of the solids.

use crate::profile::ProfileCurve;
use nalgebra::{Matrix3, Point2, Rotation2, Vector2, Vector3};

/// Distance of the stations at which contacts are looked for, m.
const STATION: f64 = 1e-3;

/// Least cosine of the angle between both profiles where they can touch.
const LEAST_COSINE: f64 = 0.3;

/// Stations farther than this from an overlap are looked at together, once the bodies have moved so far, m.
const FAR: f64 = 200e-6;

/// A contact whose overlap is between two stations can be so much deeper than they are, m: an eighth of a relative curvature of
/// 80/m (a gauge corner without its counterpart) times the square of their distance.
const BETWEEN: f64 = 10e-6;

/// A contact that is narrower than this does not count, m: with the curvature of a gauge corner its overlap is a picometre.
const NARROWEST: f64 = 1e-6;

/// Newton steps along a profile: most of them, the longest, and the one after which the place is found, m: the steps halve their digits, and what a place
/// is off by changes the penetration by less than its slope times that.
const MOST_STEPS: usize = 40;
const LONGEST_STEP: f64 = 5e-3;
const SETTLED: f64 = 1e-7;

/// The end of a contact that is narrower is bisected to this, m.
const LEAST_BRACKET: f64 = 1e-12;

/// Points of Gauss's rule on a smooth part of a contact. With strips whose stiffness bends every millimetre, the forces of the published load case 4.1 are off
/// by 3e-4 of their largest (RMS).
const POINTS: usize = 8;

/// Where both bodies are: displacements y and z (m) of their reference points and rotations about x (rad).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// The wheel, about the origin of its profile.
    pub wheel: Vector3<f64>,
    /// The rail, about its reference point.
    pub rail: Vector3<f64>,
}

/// A contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Arc lengths on the rail between which the bodies overlap, m.
    pub extent: [f64; 2],
    /// Force on the wheel (y, z; N) and its moment about the wheel's reference point where that is now, N·m; without friction.
    pub force: Vector3<f64>,
    /// Potential, J.
    pub energy: f64,
    /// Stiffness against motions of the wheel, as `force`.
    pub stiffness: Matrix3<f64>,
    /// Normal force, N, and its stiffness against a motion along itself, N/m.
    pub normal_force: f64,
    /// See `normal_force`.
    pub normal_stiffness: f64,
    /// Where the normal force acts: world (y, z), m.
    pub point: Point2<f64>,
    /// Arc length of that on the rail, m, and on the wheel.
    pub rail_s: f64,
    /// See `rail_s`.
    pub wheel_s: f64,
}

/// Force per length of a strip by its place on the rail.
pub trait StripLaw {
    /// Stiffness of a strip at an arc length (m) of the rail, Pa.
    fn modulus(&self, rail_s: f64) -> f64;
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
    /// Arc lengths at which the curvature of the rail and of the wheel jumps, m.
    joints: [Vec<f64>; 2],
    /// Middle of the rail's profile, and the largest distance of a station from there, m.
    middle: Point2<f64>,
    reach: f64,
    /// Place of the rail's profile in the wheel's frame at the last look.
    looked: Option<Turned>,
    /// What the profiles have moved against each other since the bounds set out, m.
    travel: f64,
    /// The stations near an overlap, the first and the last, and the highest bound of all others.
    window: [usize; 2],
    outside: f64,
    /// Stations before and behind each place where the bodies may overlap.
    near: Vec<(usize, usize)>,
    /// Places of the rail between which a contact is smooth, m.
    panels: Vec<f64>,
    /// Places and weights of the rule of integration on the interval from -1 to 1.
    rule: Vec<(f64, f64)>,
}

/// The rail's profile in the wheel's frame.
#[derive(Debug, Clone, Copy)]
struct Turned {
    turn: Rotation2<f64>,
    by: Vector2<f64>,
    /// The wheel in the world.
    wheel: Rotation2<f64>,
}

/// One place of the rail against the wheel.
#[derive(Debug, Clone, Copy)]
struct Facing {
    wheel_s: f64,
    penetration: f64,
    /// Change of the penetration along the rail, but for the curvature times the penetration.
    slope: f64,
    /// Cosine of the angle between the profiles.
    cosine: f64,
    /// Outward normal of the wheel over its cosine to the rail's, in the wheel's frame: the change of the penetration with the wheel's motion.
    direction: Vector2<f64>,
    /// The rail's point in the wheel's frame.
    point: Point2<f64>,
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
        let count = (rail.length() / STATION).ceil().max(2.0);
        let stations: Vec<Station> = (0..=count as usize)
            .map(|i| rail.length() * i as f64 / count)
            .map(|s| Station {
                s,
                point: rail.point(s),
                normal: rail.upward_normal(s),
                wheel_s: 0.0,
                depth: 0.0,
                slope: 0.0,
                bound: f64::INFINITY,
            })
            .collect();
        let middle = rail.point(0.5 * rail.length());
        let reach = stations.iter().map(|station| (station.point - middle).norm()).fold(0.0, f64::max);
        let mut profiles = Self {
            rail,
            wheel,
            origin,
            rail_origin,
            joints: [rail.breakpoints(), wheel.breakpoints()],
            panels: Vec::with_capacity(16),
            rule: gauss(POINTS),
            middle,
            reach,
            looked: None,
            travel: 0.0,
            window: [0, stations.len() - 1],
            outside: f64::INFINITY,
            near: Vec::with_capacity(stations.len()),
            stations,
        };
        let rest = profiles.turned(&Pose::default());
        for i in 0..profiles.stations.len() {
            profiles.stations[i].wheel_s = profiles.opposite(&rest, i);
        }
        profiles
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
            if step.abs() < SETTLED {
                // the parabola there is the curve to the cube of the step
                let step = step - 0.5 * along.dot(&bend) * step * step / advance;
                let (foot, tangent) = (foot + step * (tangent + 0.5 * step * bend), tangent + step * bend);
                return Facing::new(point, normal, along, (wheel_s + step, foot, tangent));
            }
            wheel_s += step.clamp(-LONGEST_STEP, LONGEST_STEP);
        }
        let (foot, tangent) = self.wheel.evaluate(wheel_s);
        Facing::new(point, normal, along, (wheel_s, foot, tangent))
    }

    fn facing_at(&self, place: &Turned, s: f64, guess: f64) -> Option<Facing> {
        let (point, tangent) = self.rail.evaluate(s);
        self.facing(place, &point, Vector2::new(tangent.y, -tangent.x), guess)
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
                station.bound = found.penetration.max(distance) - travel;
            }
            // until it faces the wheel it does not count
            None => (station.depth, station.bound) = (f64::NEG_INFINITY, -apart - travel),
        }
    }

    /// Looks at the stations where the bodies can overlap, and lists where they may.
    fn look(&mut self, place: &Turned) {
        self.near.clear();
        self.travel += self.looked.map_or(f64::INFINITY, |looked| self.motion(&looked, place));
        self.looked = Some(*place);
        if !self.travel.is_finite() || self.travel > 1.0 {
            self.travel = 0.0;
            self.outside = f64::INFINITY;
            self.stations.iter_mut().for_each(|station| station.bound = f64::INFINITY);
        }
        let travel = self.travel;
        let whole = self.outside + travel > -BETWEEN;
        let last = self.stations.len() - 1;
        let [first, end] = if whole { [0, last] } else { self.window };
        for i in first..=end {
            let bound = self.stations[i].bound + travel;
            if bound > if whole { -FAR } else { -BETWEEN } {
                self.look_at(place, i);
            } else {
                self.stations[i].depth = bound;
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
        let depth = |i: usize| self.stations[i].depth;
        let mut i = first;
        while i <= end {
            if depth(i) > 0.0 {
                let from = i;
                while i <= end && depth(i) > 0.0 {
                    i += 1;
                }
                self.near.push((from.saturating_sub(1), i.min(last)));
                continue;
            }
            // a contact may be narrower than the distance of two stations
            let peak = i > first && i < end && depth(i) >= depth(i - 1) && depth(i) > depth(i + 1);
            if peak && depth(i) > -BETWEEN && depth(i - 1) <= 0.0 && depth(i + 1) <= 0.0 {
                self.near.push((i - 1, i + 1));
            }
            i += 1;
        }
    }

    /// The contacts at a pose, in the order of the rail's profile.
    pub fn contacts(&mut self, pose: &Pose, law: &impl StripLaw, contacts: &mut Vec<Contact>) {
        let place = self.turned(pose);
        self.look(&place);
        contacts.clear();
        for n in 0..self.near.len() {
            let stations = self.near[n];
            if let Some(extent) = self.extent(&place, stations) {
                contacts.push(self.contact(&place, pose, extent, stations, law));
            }
        }
    }

    /// Arc length on the wheel near that opposite to a place of the rail.
    fn guess(&self, s: f64, (low, high): (usize, usize)) -> f64 {
        let step = self.stations[1].s - self.stations[0].s;
        let i = ((s / step) as usize).clamp(low, high - 1);
        let (a, b) = (&self.stations[i], &self.stations[i + 1]);
        a.wheel_s + (s - a.s) / (b.s - a.s) * (b.wheel_s - a.wheel_s)
    }

    /// The arc lengths between which the bodies overlap.
    fn extent(&self, place: &Turned, (low, high): (usize, usize)) -> Option<[f64; 2]> {
        let depth = |s: f64| self.facing_at(place, s, self.guess(s, (low, high)));
        let inside = |station: &Station| station.depth > 0.0;
        let stations = &self.stations[low..=high];
        let (first, last) = match (stations.iter().position(inside), stations.iter().rposition(inside)) {
            (Some(first), Some(last)) => (stations[first].s, stations[last].s),
            _ => {
                let (mut a, mut b) = (stations[0].s, stations[stations.len() - 1].s);
                loop {
                    let s = 0.5 * (a + b);
                    let here = depth(s)?;
                    if here.penetration > 0.0 {
                        break (s, s);
                    }
                    if b - a < NARROWEST {
                        return None;
                    }
                    // deeper on the side to which the penetration grows
                    if here.slope > 0.0 { a = s } else { b = s }
                }
            }
        };
        // Newton's method kept between a place inside and one outside
        let end = |inner: f64, outer: f64, guess: f64| -> f64 {
            let (mut inner, mut outer) = (inner, outer);
            let mut s = guess;
            for _ in 0..MOST_STEPS {
                let Some(here) = depth(s) else {
                    outer = s;
                    s = 0.5 * (inner + outer);
                    continue;
                };
                if here.penetration > 0.0 {
                    inner = s
                } else {
                    outer = s
                }
                let next = s - here.penetration / here.slope;
                let between = (next - inner) * (next - outer) < 0.0;
                let next = if between { next } else { 0.5 * (inner + outer) };
                if (next - s).abs() < if between { SETTLED } else { LEAST_BRACKET } {
                    return next;
                }
                s = next;
            }
            s
        };
        let (gauge, field) = (&self.stations[low], &self.stations[high]);
        let (from, to) = match (stations.iter().find(|s| inside(s)), stations.iter().rfind(|s| inside(s))) {
            (Some(a), Some(b)) => (a.end_towards(gauge), b.end_towards(field)),
            _ => (0.5 * (first + gauge.s), 0.5 * (last + field.s)),
        };
        Some([end(first, gauge.s, from), end(last, field.s, to)])
    }

    /// Lists the ends of the smooth parts of a contact.
    fn divide(&mut self, [from, to]: [f64; 2], stations: (usize, usize)) {
        self.panels.clear();
        self.panels.push(from);
        let [on_rail, on_wheel] = &self.joints;
        // the profiles turn against each other by so little that they run along each other in proportion
        let [first, last] = [from, to].map(|s| self.guess(s, stations));
        let opposite = |wheel_s: &f64| from + (wheel_s - first) / (last - first) * (to - from);
        let joints = on_rail.iter().copied().chain(on_wheel.iter().map(opposite));
        self.panels.extend(joints.filter(|s| *s > from && *s < to));
        self.panels.push(to);
        self.panels.sort_unstable_by(f64::total_cmp);
    }

    /// The contact in parts on which the curvature of neither profile jumps: the rule of integration is for smooth ones.
    fn contact(
        &mut self,
        place: &Turned,
        pose: &Pose,
        extent: [f64; 2],
        stations: (usize, usize),
        law: &impl StripLaw,
    ) -> Contact {
        self.divide(extent, stations);
        let (mut force, mut stiffness, mut energy) = (Vector3::zeros(), Matrix3::zeros(), 0.0);
        let (mut sum, mut rail_s, mut wheel_s, mut middle) = (0.0, 0.0, 0.0, Vector2::zeros());
        let parts = self.panels.windows(2).flat_map(|ends| {
            let (centre, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
            self.rule.iter().map(move |(at, weight)| (centre + half * at, half * weight))
        });
        for (s, width) in parts {
            let Some(here) = self.facing_at(place, s, self.guess(s, stations)) else { continue };
            let depth = here.penetration.max(0.0);
            let share = law.modulus(s) * width;
            let q = share * depth;
            let a = here.direction;
            let gradient = Vector3::new(a.x, a.y, here.point.coords.perp(&a));
            force -= gradient * q;
            if depth > 0.0 {
                stiffness += gradient * gradient.transpose() * share;
            }
            energy += 0.5 * q * depth;
            sum += q;
            rail_s += q * s;
            wheel_s += q * here.wheel_s;
            middle += here.point.coords * q;
        }
        let over = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        // from the wheel's frame to the world
        let turn = place.wheel;
        let whole = turn.matrix().fixed_resize::<3, 3>(0.0) + Matrix3::from_diagonal(&Vector3::z());
        let (force, stiffness) = (whole * force, whole * stiffness * whole.transpose());
        let normal_force = force.xy().norm();
        let normal = if normal_force > 0.0 { force.xy() / normal_force } else { Vector2::zeros() };
        let along = Vector3::new(normal.x, normal.y, 0.0);
        Contact {
            extent,
            force,
            energy,
            stiffness,
            normal_force,
            normal_stiffness: along.dot(&(stiffness * along)),
            point: self.origin + pose.wheel.xy() + turn * (middle * over),
            rail_s: rail_s * over,
            wheel_s: wheel_s * over,
        }
    }
}

/// Places and weights of Gauss's rule of `count` points on the interval from -1 to 1: the roots of Legendre's polynomial.
fn gauss(count: usize) -> Vec<(f64, f64)> {
    let order = count as f64;
    let root = |i: usize| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (order + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..10 {
            let (mut before, mut value) = (1.0, x);
            for n in 2..=count {
                let n = n as f64;
                (before, value) = (value, ((2.0 * n - 1.0) * x * value - (n - 1.0) * before) / n);
            }
            slope = order * (before - x * value) / (1.0 - x * x);
            x -= value / slope;
        }
        (-x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(root).collect()
}

impl Station {
    /// The place between this station, which is inside a contact, and the next one where the parabola ends that has the penetrations of both
    /// and the slope of this.
    fn end_towards(&self, next: &Self) -> f64 {
        let way = next.s - self.s;
        let (slope, fall) = (self.slope * way, next.depth - self.depth - self.slope * way);
        // 0 = depth + slope·t + fall·t²
        let root = (slope * slope - 4.0 * self.depth * fall).max(0.0).sqrt();
        let t = 2.0 * self.depth / (root - slope);
        self.s + way * if t > 0.0 && t < 1.0 { t } else { 0.5 }
    }
}

impl Facing {
    /// From the place of the rail in the wheel's frame with its normal and the tangent across it, and the `foot` on the wheel: its arc length, point and tangent.
    fn new(
        point: Point2<f64>,
        normal: Vector2<f64>,
        along: Vector2<f64>,
        (wheel_s, foot, tangent): (f64, Point2<f64>, Vector2<f64>),
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
            cosine,
            direction: outward / cosine,
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
