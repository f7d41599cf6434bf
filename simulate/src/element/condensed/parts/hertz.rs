//! Strips that make Hertz's contact wherever two profiles can touch, and those of a Winkler foundation that do.

use railspring_calibrate::analytic::hertz::point_contact;
use railspring_calibrate::pair::Pair;
use railspring_element::law::{StripPlace, StripStiffness};
use railspring_element::modulus::StripModulus;
use railspring_element::relief::{Influence, ReliefPlaces};
use railspring_profiles::profile::ProfileCurve;

/// Distance of the places of the table, m.
const SPACING: f64 = 1e-3;

/// Curvatures are means over so much of a profile on either side, m: about the width of a patch.
const SMOOTHED: f64 = 2e-3;

/// Largest relative radius across the track, m: flatter profiles touch over their whole breadth.
const FLATTEST: f64 = 3.0;

/// Weights of the relief and tangential stiffnesses are evened out twice over so many places on either side: what changes along a contact turns its force.
const EVEN: usize = 4;

/// Of an approach at least so much presses strips.
const LEAST_PRESSED: f64 = 0.15;

/// Upper bound of the relief weight.
const HEAVIEST: f64 = 3.0;

/// Parts of half a contact in which its load is summed.
const PARTS: usize = 10;

/// Tangential over normal stiffness of a circular contact of steel: R.D. Mindlin, "Compliance of elastic bodies in contact", J. Appl. Mech.
/// 16 (1949), 2(1-ν)/(2-ν).
const MINDLIN: f64 = 1.4 / 1.7;

/// The strips of Hertz's contact where both profiles have the same slope, under [`Influence::TYPICAL`]. κ is
/// the relative curvature across the track. At the edge, Hertz's semi-axis b away, the profiles overlap by
/// the approach less `κb²/2`, which is the relief there. The force of the strips within is the load.
pub(super) fn hertz_table(pair: &Pair, modulus: f64) -> StripStiffness {
    let touches = touches(pair, modulus);
    let influence = Influence { flexibility: 1.0 / (std::f64::consts::PI * modulus) };
    let Some(places) = ReliefPlaces::new(&pair.placed.curve, influence) else {
        unreachable!("a half-space gives way")
    };
    let weights = even(&touches, |touch| touch.weight(&places));
    let stiffnesses = even(&touches, |touch| touch.spread_stiffness().ln());
    let place = |((touch, relief), spread): ((&Touch, f64), f64)| {
        let normal = touch.modulus(&places, relief);
        let tangential = MINDLIN * spread.exp();
        let modulus = StripModulus { normal, hardening: 0.0, tangential, relief };
        StripPlace { rail_s: touch.rail_s, modulus }
    };
    StripStiffness::new(touches.iter().zip(weights).zip(stiffnesses).map(place).collect(), influence, 0.0)
}

/// The strips of a Winkler foundation, which do not relieve each other, that carry [`Influence::TYPICAL`] under Hertz's approach: they touch as far as the profiles overlap, `√(2δ/κ)` to either side of
/// an approach δ, and their force is `4/3·c·δ` times that. All of a contact has Mindlin's share of its normal stiffness across the normal.
pub(super) fn winkler_table(pair: &Pair, modulus: f64) -> StripStiffness {
    let touches = touches(pair, modulus);
    let stiffnesses = even(&touches, |touch| touch.winkler_modulus().ln());
    let place = |(touch, stiffness): (&Touch, f64)| {
        let normal = stiffness.exp();
        let modulus = StripModulus { normal, hardening: 0.0, tangential: MINDLIN * normal, relief: 0.0 };
        StripPlace { rail_s: touch.rail_s, modulus }
    };
    StripStiffness::new(touches.iter().zip(stiffnesses).map(place).collect(), Influence::default(), 0.0)
}

/// Values of all touches, evened out twice over some places.
fn even(touches: &[Touch], value: impl Fn(&Touch) -> f64) -> Vec<f64> {
    let mut values: Vec<f64> = touches.iter().map(value).collect();
    let last = values.len() - 1;
    for _ in 0..2 {
        let around = |i: usize| &values[i.saturating_sub(EVEN)..=(i + EVEN).min(last)];
        values = (0..=last).map(|i| around(i).iter().sum::<f64>() / around(i).len() as f64).collect();
    }
    values
}

/// Where both profiles have the same slope.
struct SameSlope {
    rail_s: f64,
    wheel_s: f64,
    /// Relative curvature across the track, 1/m.
    across: f64,
    /// Angle of the slope, rad.
    angle: f64,
}

/// Places along the rail with the place of the wheel that has the same slope, [`SPACING`] apart.
fn same_slopes(pair: &Pair) -> Vec<SameSlope> {
    let (rail, wheel) = (&pair.placed.curve, &pair.wheel.running);
    let angle = |curve: &ProfileCurve, s: f64| {
        let tangent = curve.tangent(s.clamp(0.0, curve.length() * (1.0 - 1e-9)));
        tangent.y.atan2(tangent.x)
    };
    let curvature = |curve: &ProfileCurve, s: f64| {
        let (a, b) = ((s - SMOOTHED).max(0.0), (s + SMOOTHED).min(curve.length()));
        (angle(curve, b) - angle(curve, a)) / (b - a)
    };
    let count = (rail.length() / SPACING).ceil() as usize;
    let every = |i: usize| wheel.length() * i as f64 / (4 * count) as f64;
    // the flange's tip; what lies behind it is its back
    let depth = |s: f64| wheel.point(s).y;
    let tip = (0..=(4 * count)).map(every).max_by(|a, b| depth(*a).total_cmp(&depth(*b))).unwrap_or(0.0);
    let samples: Vec<(f64, f64)> =
        (0..=(4 * count)).map(every).filter(|s| *s >= tip).map(|s| (s, angle(wheel, s))).collect();
    let tape = pair.tape();
    let place = |i: usize| {
        let rail_s = rail.length() * i as f64 / count as f64;
        let wanted = angle(rail, rail_s);
        // of several places of the wheel with this slope, that which the wheel need move the least to touch with
        let aside = |s: f64| (wheel.point(s).x + tape.x - rail.point(rail_s).x).abs();
        let crossings = samples.windows(2).filter(|w| (w[0].1 - wanted) * (w[1].1 - wanted) <= 0.0);
        let nearest =
            crossings.map(|w| 0.5 * (w[0].0 + w[1].0)).min_by(|a, b| aside(*a).total_cmp(&aside(*b)));
        let wheel_s = nearest.unwrap_or_else(|| {
            let off = |w: &&(f64, f64)| (w.1 - wanted).abs();
            samples.iter().min_by(|a, b| off(a).total_cmp(&off(b))).map_or(0.0, |w| w.0)
        });
        let across = (curvature(rail, rail_s) - curvature(wheel, wheel_s)).max(1.0 / FLATTEST);
        SameSlope { rail_s, wheel_s, across, angle: wanted }
    };
    (0..=count).map(place).collect()
}

/// Places along the rail where both profiles have the same slope, under the usual load.
fn touches(pair: &Pair, modulus: f64) -> Vec<Touch> {
    let place = |SameSlope { rail_s, wheel_s, across, angle }: SameSlope| {
        let rolling = (pair.wheel.radius + pair.wheel.running.point(wheel_s).y) / angle.cos().abs().max(0.05);
        let under = point_contact(Influence::TYPICAL, rolling, 1.0 / across, modulus);
        let (approach, half) = under.map_or((0.0, 0.0), |under| (under.approach, under.semi_axis_y));
        Touch { rail_s, across, approach, half }
    };
    same_slopes(pair).into_iter().map(place).collect()
}

/// How flat the profiles of a pair lie on each other along the rail.
#[derive(Debug, Clone)]
pub struct Flatness {
    /// Relative curvatures across the track at places [`SPACING`] or less apart, 1/m.
    across: Vec<f64>,
    /// Places per metre.
    density: f64,
}

impl Flatness {
    /// Of a pair.
    pub fn of(pair: &Pair) -> Self {
        let places = same_slopes(pair);
        let density = (places.len() - 1) as f64 / pair.placed.curve.length();
        Self { across: places.iter().map(|place| place.across).collect(), density }
    }

    /// Force of a single point at an arc length (m) of the rail over the power 3/2 of its depth, N/m^(3/2): that of a Winkler foundation with this stiffness (Pa) there, `4/3·c·√(2/κ)`.
    pub fn point_stiffness(&self, rail_s: f64, stiffness: f64) -> f64 {
        let last = self.across.len() - 1;
        let at = (rail_s * self.density).clamp(0.0, last as f64);
        let (i, share) = (at as usize, at.fract());
        let next = self.across[(i + 1).min(last)];
        let across = self.across[i] + share * (next - self.across[i]);
        4.0 / 3.0 * stiffness * (2.0 / across).sqrt()
    }
}

/// A place of the rail under the usual load.
struct Touch {
    rail_s: f64,
    /// Relative curvature across the track, 1/m.
    across: f64,
    approach: f64,
    /// Semi-axis of the patch across the track, m.
    half: f64,
}

impl Touch {
    /// Relief of weight 1 at a distance from the middle, near the load and elsewhere, m: Hertz's pressures, summed along the track, are a parabola.
    fn relief(&self, places: &ReliefPlaces) -> impl Fn(f64) -> [f64; 2] {
        let part = |n: usize| {
            let at = (n as f64 + 0.5) / PARTS as f64 - 1.0;
            let force = 0.75 * Influence::TYPICAL * (1.0 - at * at) / PARTS as f64;
            (self.rail_s + at * self.half, force)
        };
        let [near, elsewhere] = places.made_by(&(0..2 * PARTS).map(part).collect::<Vec<_>>());
        // of both sides
        move |at: f64| {
            [&near, &elsewhere].map(|relief| {
                let side = |side: f64| places.at(relief, self.rail_s + side * at).0;
                0.5 * (side(-1.0) + side(1.0))
            })
        }
    }

    /// The weight with which the strips at the edge of Hertz's patch just touch.
    fn weight(&self, places: &ReliefPlaces) -> f64 {
        let at_edge = self.relief(places)(self.half);
        let wanted = (self.approach - 0.5 * self.across * self.half * self.half).max(0.0);
        let [mut low, mut high] = [0.0, HEAVIEST];
        while high - low > 1e-12 {
            let middle = 0.5 * (low + high);
            if weighted(middle, at_edge) < wanted { low = middle } else { high = middle }
        }
        low
    }

    /// Stiffness of the whole contact under the usual load over its width, Pa: the force goes with the power 3/2 of the approach.
    fn spread_stiffness(&self) -> f64 {
        1.5 * Influence::TYPICAL / self.approach / (2.0 * self.half)
    }

    /// Stiffness of strips without relief that makes their force the load, Pa.
    fn winkler_modulus(&self) -> f64 {
        let half = (2.0 * self.approach / self.across).sqrt();
        0.75 * Influence::TYPICAL / (self.approach * half)
    }

    /// Stiffness of the strips that makes their force the load, Pa.
    fn modulus(&self, places: &ReliefPlaces, weight: f64) -> f64 {
        let relief = self.relief(places);
        let least = LEAST_PRESSED * self.approach;
        let middle = weighted(weight, relief(0.0)).min(self.approach - least);
        let step = self.half / PARTS as f64;
        let mut sum = 0.0;
        // until they do not touch any more
        for n in 0.. {
            let at = (n as f64 + 0.5) * step;
            let of_relief = weighted(weight, relief(at)).min(middle);
            let depth = self.approach - 0.5 * self.across * at * at - of_relief;
            if depth <= 0.0 {
                break;
            }
            sum += 2.0 * depth * step;
        }
        Influence::TYPICAL / sum
    }
}

/// A relief by a weight, which loads have as well.
fn weighted(weight: f64, [near, elsewhere]: [f64; 2]) -> f64 {
    weight.powf(5.0 / 3.0) * near + weight * weight * elsewhere
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: strips of a foundation under a parabola, summed. Goal: a point has their force (N) at the same depth (m), between two places and beyond the last, too. Accuracy: SUMMED, a midpoint rule over 2000 strips.
    #[test]
    fn a_point_has_the_force_of_its_strips() {
        const SUMMED: f64 = 1e-5;
        let flatness = Flatness { across: vec![2.0, 2.0, 4.0], density: 1e3 };
        let (stiffness, depth) = (110e9, 60e-6_f64);
        for (rail_s, across) in [(0.5e-3, 2.0), (1.5e-3, 3.0), (7e-3, 4.0)] {
            let half = (2.0 * depth / across).sqrt();
            let width = half / 1000.0;
            let strip = |i: i32| {
                let at = (f64::from(i) + 0.5) * width;
                stiffness * (depth - 0.5 * across * at * at) * width
            };
            let exact: f64 = (-1000..1000).map(strip).sum();
            let found = flatness.point_stiffness(rail_s, stiffness) * depth.powf(1.5);
            assert!((found / exact - 1.0).abs() < SUMMED, "{rail_s}: {found} {exact}");
        }
    }
}
