//! Where an overlap begins and ends, and the integration over it.

use super::facing::Turned;
use super::profiles::{Dip, MOST_STEPS, Overlap, Profiles, SETTLED, Span, Station};

/// A contact that is narrower than this does not count, m: with the curvature of a gauge corner its overlap is a picometre.
const NARROWEST: f64 = 1e-6;

/// The end of a contact that is narrower is bisected to this, m.
const LEAST_BRACKET: f64 = 1e-12;

/// Two contacts are one where the penetration between them is so large, over the lesser of theirs.
const JOINED: f64 = 0.5;

impl Profiles {
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
    pub(crate) fn integrate(&mut self, overlap: &Overlap, mut each: impl FnMut(&mut Self, f64, f64)) {
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
