//! Where an overlap begins and ends, and the rule of integration over it.

use super::{Dip, LEAST_STATION, MOST_STEPS, Overlap, Profiles, SETTLED, Span, Station, Turned, WAVE};
use railspring_profiles::profile::ProfileCurve;

/// A contact that is narrower than this does not count, m: with the curvature of a gauge corner its overlap is a picometre.
const NARROWEST: f64 = 1e-6;

/// The end of a contact that is narrower is bisected to this, m.
const LEAST_BRACKET: f64 = 1e-12;

/// Points of Gauss's rule on a smooth part of a contact. With strips whose stiffness bends every millimetre, the forces of the published load case 4.1 are off by 2e-4 of
/// their largest (RMS).
pub(super) const POINTS: usize = 12;

/// Two contacts are one where the penetration between them is so large, over the lesser of theirs.
const JOINED: f64 = 0.5;

/// The largest jump of a curvature within a smooth part, 1/m; the parts of S1002's throat have jumps of a twentieth of that.
const LARGEST_JUMP: f64 = 1.0;

/// Beside a joint the curvature is looked at so far from it, m.
const BESIDE: f64 = 1e-6;

impl Profiles<'_> {
    /// By how much a penetration beside a station, the highest around, can be larger than there, m: where its neighbours were seen, no more than along the tangents there if it bends
    /// at most once the other way.
    pub(super) fn above(&self, i: usize) -> f64 {
        let seen = |i: usize| self.stations.get(i).filter(|station| station.seen);
        let (Some(before), Some(here), Some(behind)) = (seen(i.wrapping_sub(1)), seen(i), seen(i + 1)) else {
            return self.between;
        };
        let way = here.s - before.s;
        let tangents = [
            here.slope.abs() * way,
            before.depth - here.depth + before.slope * way,
            behind.depth - here.depth - behind.slope * way,
        ];
        tangents.into_iter().fold(0.0, f64::max).min(self.between)
    }

    /// Where between a station and the next one the penetration goes down and up again: the arc length and the least penetration, m.
    pub(super) fn dip(&self, place: &Turned, station: usize) -> Option<(f64, f64)> {
        let (a, b) = (&self.stations[station], &self.stations[station + 1]);
        let (mut a, mut b) = ((a.s, a.slope), (b.s, b.slope));
        if a.1 >= 0.0 || b.1 <= 0.0 {
            return None;
        }
        // the false position of the slope, with half of the value at an end that stays (Illinois)
        let mut least = None;
        for _ in 0..MOST_STEPS {
            let s = (a.0 * b.1 - b.0 * a.1) / (b.1 - a.1);
            let here = self.facing_at(place, s, self.guess(s, (station, station + 1)))?;
            let last = least.replace((s, here.penetration));
            if last.is_some_and(|(last, _)| (s - last).abs() < SETTLED) {
                break;
            }
            if here.slope < 0.0 {
                (a, b.1) = ((s, here.slope), 0.5 * b.1);
            } else {
                (b, a.1) = ((s, here.slope), 0.5 * a.1);
            }
        }
        least
    }

    /// The arc lengths between which the bodies overlap; where they do not, by how much they miss each other, m.
    pub(super) fn extent(&self, place: &Turned, span: Span) -> Result<[f64; 2], f64> {
        let Span { stations: (low, high), ends: [gauge_end, field_end] } = span;
        let depth = |s: f64| self.facing_at(place, s, self.guess(s, (low, high)));
        let inside = |station: &Station| station.depth > 0.0 && (gauge_end..=field_end).contains(&station.s);
        let stations = &self.stations[low..=high];
        let (first, last) = match (stations.iter().position(inside), stations.iter().rposition(inside)) {
            (Some(first), Some(last)) => (stations[first].s, stations[last].s),
            _ => {
                let (mut a, mut b) = (gauge_end, field_end);
                loop {
                    let s = 0.5 * (a + b);
                    let here = depth(s).ok_or(0.0)?;
                    if here.penetration > 0.0 {
                        break (s, s);
                    }
                    if b - a < NARROWEST {
                        return Err(-here.penetration);
                    }
                    // deeper on the side to which the penetration grows
                    if here.slope > 0.0 { a = s } else { b = s }
                }
            }
        };
        // Newton's method kept between a place inside and one outside
        let end = |inner: f64, outer: f64, guess: f64| -> f64 {
            let (mut inner, mut outer) = (inner, outer);
            let between = (guess - inner) * (guess - outer) < 0.0;
            let mut s = if between { guess } else { 0.5 * (inner + outer) };
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
            _ => (first, last),
        };
        Ok([end(first, gauge_end, from), end(last, field_end, to)])
    }

    /// The rule of integration over an overlap, `each` with a place of the rail and its weight, m: in parts on which the curvature of neither profile jumps by much, as
    /// it is for smooth functions. Two contacts that have just joined are integrated as two, and the more as one, the less there is between them, so that forces do not jump.
    pub(in super::super) fn integrate(
        &mut self,
        overlap: &Overlap,
        mut each: impl FnMut(&mut Self, f64, f64),
    ) {
        let [from, to] = overlap.extent;
        self.inside.clear();
        self.inside.extend(self.dips.iter().filter(|dip| dip.s > from && dip.s < to && dip.share > 0.0));
        self.inside.sort_unstable_by(|a, b| b.share.total_cmp(&a.share));
        // that which begins nearest to the end of the contact is first
        for dips in (0..=self.inside.len()).rev() {
            let without = self.inside.get(dips).map_or(0.0, |dip| dip.share);
            let share = self.inside[..dips].last().map_or(1.0, |dip| dip.share) - without;
            if share <= 0.0 {
                continue;
            }
            self.divide(overlap, dips);
            for part in 1..self.panels.len() {
                let [from, to] = [self.panels[part - 1], self.panels[part]];
                let (centre, half) = (0.5 * (from + to), 0.5 * (to - from));
                for n in 0..self.rule.len() {
                    let (at, weight) = self.rule[n];
                    each(self, centre + half * at, share * half * weight);
                }
            }
        }
    }

    /// Lists the ends of the smooth parts of a contact, with the first of its dips.
    fn divide(&mut self, overlap: &Overlap, dips: usize) {
        let Overlap { extent: [from, to], stations } = *overlap;
        self.panels.clear();
        self.panels.push(from);
        let [on_rail, on_wheel] = &self.joints;
        // the profiles turn against each other by so little that they run along each other in proportion
        let [first, last] = [from, to].map(|s| self.guess(s, stations));
        let opposite = |wheel_s: &f64| from + (wheel_s - first) / (last - first) * (to - from);
        let joints = on_rail.iter().copied().chain(on_wheel.iter().map(opposite));
        self.panels.extend(joints.filter(|s| *s > from && *s < to));
        self.panels.extend(self.inside[..dips].iter().map(|dip| dip.s));
        self.panels.push(to);
        self.panels.sort_unstable_by(f64::total_cmp);
    }
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

impl Dip {
    /// By the least penetration in it over the largest beside it.
    pub(super) fn share(least: f64) -> f64 {
        let t = (least / JOINED).clamp(0.0, 1.0);
        1.0 - t * t * (3.0 - 2.0 * t)
    }
}

/// Arc lengths at which the curvature of a profile jumps by so much that the rule is divided there, m.
pub(super) fn joints(curve: &ProfileCurve) -> Vec<f64> {
    let jumps = |s: &f64| {
        let [before, behind] = [-BESIDE, BESIDE].map(|by| curve.curvature(s + by));
        (behind - before).abs() > LARGEST_JUMP
    };
    curve.breakpoints().into_iter().filter(jumps).collect()
}

/// How a profile bends.
pub(super) struct Bends {
    /// Its sharpest curvature either way, 1/m.
    pub sharpest: f64,
    /// Its shortest wave, m: twice the way from a curvature to one that differs from it by a wave's, the other way round from before; infinite without waves.
    pub shortest_wave: f64,
}

impl Bends {
    pub fn of(curve: &ProfileCurve) -> Self {
        let mut bends = Self { sharpest: 0.0, shortest_wave: f64::INFINITY };
        // the last crest or trough, and what may become the next one
        let mut turned: Option<f64> = None;
        let [mut low, mut high] = [(f64::INFINITY, 0.0), (f64::NEG_INFINITY, 0.0)];
        let mut rises: Option<bool> = None;
        for s in curve.sample_parameters(0.5 * LEAST_STATION) {
            let here = (curve.curvature(s), s);
            bends.sharpest = bends.sharpest.max(here.0.abs());
            (low, high) =
                (if here.0 < low.0 { here } else { low }, if here.0 > high.0 { here } else { high });
            let [falls, climbs] = [high.0 - here.0 > WAVE, here.0 - low.0 > WAVE];
            let turn = match rises {
                Some(true) | None if falls => Some((high.1, false)),
                Some(false) | None if climbs => Some((low.1, true)),
                _ => None,
            };
            let Some((at, up)) = turn else { continue };
            // the end of a profile is no crest
            if let Some(last) = turned.filter(|last| *last > 0.0) {
                bends.shortest_wave = bends.shortest_wave.min(2.0 * (at - last));
            }
            (turned, rises) = (Some(at), Some(up));
            (low, high) = (here, here);
        }
        bends
    }
}

/// Places and weights of Gauss's rule of `count` points on the interval from -1 to 1: the roots of Legendre's polynomial.
pub(super) fn gauss(count: usize) -> Vec<(f64, f64)> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;
    use railspring_profiles::section::{rail_section, wheel_section};

    /// Goal: the length of a profile's waves (m), and none of standards, of waves so flat that stations a millimetre apart see them, or of a single bend. Accuracy: the places at which the curvature is looked at,
    /// half of [`LEAST_STATION`] apart, at both ends of half a wave.
    #[test]
    fn waves_have_their_length() {
        for (length, height, waves) in [(0.9e-3, 8e-6, true), (2.5e-3, 40e-6, true), (2.5e-3, 8e-6, false)] {
            let wave = |y: f64| height * (std::f64::consts::TAU * y / length).cos();
            let points: Vec<Point2<f64>> =
                (-200..=200).map(|i| 0.1e-3 * f64::from(i)).map(|y| Point2::new(y, wave(y))).collect();
            let found = Bends::of(&ProfileCurve::from_points(&points, &[]).unwrap()).shortest_wave;
            assert_eq!(found.is_finite(), waves, "{length} {height}: {found}");
            assert!(!waves || (found - length).abs() < 2.0 * LEAST_STATION, "{length}: {found}");
        }
        let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.92).unwrap());
        for standard in [&rail.running, &wheel.running] {
            assert!(Bends::of(standard).shortest_wave.is_infinite());
        }
    }
}
