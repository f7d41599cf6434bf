//! The stiffness of a contact's strips along the rail, from the laws by contact angle of the solids.

use super::strips::{Pose, Profiles, StripLaw};
use crate::analytic::hertz::{contact_modulus, point_contact};
use crate::error::{InputError, Result};
use crate::pair::{Pair, ShiftLaw};
use crate::profile::ProfileCurve;
use crate::solid::Material;
use crate::superelement::carried;
use nalgebra::{Matrix3, Point2, Vector2, Vector3};

/// Places nearer to each other than this (arc length on the rail, m) are one.
const SAME_PLACE: f64 = 0.5e-3;

/// Rounds in which the places share out what the strips lack, and the share of it that each takes in one.
const ROUNDS: usize = 5;
const SHARE: f64 = 0.7;

/// Distance of the places of the table, m.
const SPACING: f64 = 1e-3;

/// Curvatures are means over so much of a profile on either side, m: about the width of a patch.
const SMOOTHED: f64 = 2e-3;

/// Largest relative radius across the track, m: flatter profiles touch over their whole breadth.
const FLATTEST: f64 = 3.0;

/// What is known of the contact at one place of the rail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StripPlace {
    /// Arc length on the rail, m.
    pub rail_s: f64,
    /// Stiffness of a strip: force per length and penetration, Pa.
    pub modulus: f64,
    /// Tangential stiffness of a contact over its normal one.
    pub tangential: f64,
}

/// Stiffness of strips by their place: in proportion between places that are equally far apart, constant beyond them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StripStiffness {
    /// The places, by ascending arc length.
    pub places: Vec<StripPlace>,
    /// Largest deviation of a force from that of the solids at the same approach, relative, over all places and loads.
    pub misfit: f64,
}

impl StripStiffness {
    /// The two places around one, and the share of the second.
    fn around(&self, rail_s: f64) -> (&StripPlace, &StripPlace, f64) {
        let last = self.places.len() - 1;
        let (first, end) = (self.places[0].rail_s, self.places[last].rail_s);
        let apart = (end - first) / last.max(1) as f64;
        let at = if apart > 0.0 { ((rail_s - first) / apart).clamp(0.0, last as f64) } else { 0.0 };
        let i = (at as usize).min(last.saturating_sub(1));
        (&self.places[i], &self.places[(i + 1).min(last)], at - i as f64)
    }

    /// The moduli of a table times the ratios at some places, with the tangential stiffness there.
    fn times(&self, knots: &[StripPlace]) -> Self {
        let place = |place: &StripPlace| {
            let (ratio, tangential) = between(knots, place.rail_s);
            StripPlace { modulus: place.modulus * ratio, tangential, ..*place }
        };
        Self { places: self.places.iter().map(place).collect(), misfit: 0.0 }
    }

    /// Tangential stiffness of a contact at a place over its normal one.
    pub fn tangential(&self, rail_s: f64) -> f64 {
        let (a, b, t) = self.around(rail_s);
        a.tangential + t * (b.tangential - a.tangential)
    }
}

impl StripLaw for StripStiffness {
    fn modulus(&self, rail_s: f64) -> f64 {
        let (a, b, t) = self.around(rail_s);
        a.modulus + t * (b.modulus - a.modulus)
    }
}

/// What the solids say of the contact with the wheel in one place, pressed along the contact normal with the hub held across it.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaceApproaches {
    /// Lateral world position of the tape circle, m.
    pub tape_y: f64,
    /// The loads, ascending.
    pub loads: Vec<PlaceLoad>,
    /// At some loads, m/N: compliance of the contact alone, and that of the hub across the normal with everything sticking.
    pub compliances: Vec<[f64; 2]>,
}

/// A load along the contact normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceLoad {
    /// Force, N.
    pub force: f64,
    /// Approach of the surfaces, m.
    pub approach: f64,
}

impl PlaceApproaches {
    /// Of a law by contact angle; none where there is no law.
    pub fn of(law: &ShiftLaw) -> Option<Self> {
        let angle = law.law.as_ref().ok()?;
        let points = angle.laws.local.points.iter();
        let loads =
            points.map(|point| PlaceLoad { force: point.force, approach: point.displacement }).collect();
        let fixed = angle.fixed.iter();
        let compliances = fixed.map(|at| [at.points.local.local_compliance, 1.0 / at.tangential_stiffness]);
        Some(Self { tape_y: law.tape_y, loads, compliances: compliances.collect() })
    }
}

/// A place with its approaches.
struct Pressed {
    pair: Pair,
    along: Vector2<f64>,
    loads: Vec<PlaceLoad>,
    tangential: f64,
}

/// Fits the strips of a pair to its laws by contact angle: at every place and load the force that belongs to the approach of the
/// surfaces. `rim` and `head` are the flexibilities of both sections, whose rotation under the load turns the profiles against each other.
///
/// # Errors
/// [`InputError`] if no place has a law.
pub fn fit_strips(
    pair: &Pair,
    material: &Material,
    laws: &[PlaceApproaches],
    [rim, head]: [&Matrix3<f64>; 2],
) -> Result<StripStiffness> {
    let mut pressed = Vec::new();
    for law in laws {
        let place = pair.with_wheel_at(law.tape_y)?;
        let along = -place.placed.curve.upward_normal(place.touch.rail_s);
        let across = Vector2::new(-along.y, along.x);
        // both sections, where the wheel touches
        let section = |direction: Vector2<f64>| {
            let of = |flexibility: &Matrix3<f64>, at: Point2<f64>| {
                let force = carried(&(place.touch.point - at)).tr_mul(&direction);
                force.dot(&(flexibility * force))
            };
            of(rim, Point2::from(place.tape())) + of(head, place.node_line())
        };
        let tangential = section(across);
        // what both sections leave of the hub's flexibility across the normal is the contact's
        let ratio = |&[local, across]: &[f64; 2]| local / (across - tangential);
        let ratios: Vec<f64> =
            law.compliances.iter().map(ratio).filter(|ratio| PLAUSIBLE.contains(ratio)).collect();
        let tangential = match ratios.len() {
            0 => MINDLIN,
            count => ratios.iter().sum::<f64>() / count as f64,
        };
        pressed.push(Pressed { pair: place, along, loads: law.loads.clone(), tangential });
    }
    pressed.retain(|place| !place.loads.is_empty());
    if pressed.is_empty() {
        return Err(InputError::new(
            "laws by contact angle",
            "no place with a law",
            "a law at one place of the rail at least",
            "put the wheel in other places, where it stands on one contact",
        )
        .into());
    }
    pressed.sort_by(|a, b| a.pair.touch.rail_s.total_cmp(&b.pair.touch.rail_s));
    let hertz = hertz_table(pair, material);
    let mut knots: Vec<StripPlace> = Vec::new();
    for place in &pressed {
        let rail_s = place.pair.touch.rail_s;
        if knots.last().is_some_and(|last| rail_s - last.rail_s < SAME_PLACE) {
            continue;
        }
        let modulus = ratio(place, &hertz, [rim, head]);
        knots.push(StripPlace { rail_s, modulus, tangential: place.tangential });
    }
    let bodies = [rim, head];
    let mut stiffness = hertz.times(&knots);
    // contacts are as wide as neighbouring places are apart, so that each has a part of its neighbours' stiffness
    for _ in 0..ROUNDS {
        let lacking: Vec<(f64, f64)> =
            pressed.iter().map(|place| (place.pair.touch.rail_s, ratio(place, &stiffness, bodies))).collect();
        for knot in &mut knots {
            let of_knot = lacking.iter().find(|(rail_s, _)| (rail_s - knot.rail_s).abs() < SAME_PLACE);
            knot.modulus *= of_knot.map_or(1.0, |(_, lacking)| lacking.powf(SHARE));
        }
        stiffness = hertz.times(&knots);
    }
    for place in &pressed {
        let mut profiles = place.profiles();
        for load in &place.loads {
            let force = place.force(&mut profiles, &place.pose(load, bodies), &stiffness);
            stiffness.misfit = stiffness.misfit.max((force / load.force - 1.0).abs());
        }
    }
    Ok(stiffness)
}

/// Ratio and tangential stiffness between places that are not equally far apart: the ratio's logarithm in proportion, constant beyond them.
fn between(knots: &[StripPlace], rail_s: f64) -> (f64, f64) {
    let last = knots.len() - 1;
    let upper = knots.partition_point(|knot| knot.rail_s < rail_s);
    let (a, b) = (&knots[upper.saturating_sub(1).min(last)], &knots[upper.min(last)]);
    let apart = b.rail_s - a.rail_s;
    let t = if apart > 0.0 { ((rail_s - a.rail_s) / apart).clamp(0.0, 1.0) } else { 0.0 };
    (a.modulus * (b.modulus / a.modulus).powf(t), a.tangential + t * (b.tangential - a.tangential))
}

/// The strips of Hertz's contact where both profiles have the same slope. A strip whose force per length is a modulus times its penetration
/// makes the force of that contact with (3/4)·K·√(κ/2), where F = K·δ^(3/2) is Hertz's and κ the relative curvature across the track.
fn hertz_table(pair: &Pair, material: &Material) -> StripStiffness {
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
    let Material { young, poisson, .. } = *material;
    let modulus = contact_modulus(young, poisson, young, poisson);
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
        let rolling = (pair.wheel.radius + wheel.point(wheel_s).y) / wanted.cos().abs().max(0.05);
        let unit = point_contact(1.0, rolling, 1.0 / across, modulus);
        let stiffness = unit.map_or(0.0, |unit| unit.approach.powf(-1.5));
        StripPlace { rail_s, modulus: 0.75 * stiffness * (0.5 * across).sqrt(), tangential: MINDLIN }
    };
    StripStiffness { places: (0..=count).map(place).collect(), misfit: 0.0 }
}

/// Tangential over normal stiffness of a circular contact of steel: R.D. Mindlin, "Compliance of elastic bodies in contact", J. Appl. Mech.
/// 16 (1949), 2(1-ν)/(2-ν).
const MINDLIN: f64 = 1.4 / 1.7;

/// Tangential over normal stiffness that a contact can have: the integrals of Mindlin for ellipses stay well within.
const PLAUSIBLE: std::ops::RangeInclusive<f64> = 0.4..=1.5;

impl Pressed {
    fn profiles(&self) -> Profiles<'_> {
        let pair = &self.pair;
        Profiles::new(&pair.placed.curve, &pair.wheel.running, Point2::from(pair.tape()), pair.node_line())
    }

    /// Both sections turned under a load, the touching point moved together by the approach.
    fn pose(&self, load: &PlaceLoad, [rim, head]: [&Matrix3<f64>; 2]) -> Pose {
        let pair = &self.pair;
        let (to_wheel, to_rail) =
            (pair.touch.point - Point2::from(pair.tape()), pair.touch.point - pair.node_line());
        let force = self.along * load.force;
        let turn = |flexibility: &Matrix3<f64>, arm: &Vector2<f64>, force: Vector2<f64>| {
            let moved: Vector3<f64> = flexibility * (carried(arm).transpose() * force);
            moved.z
        };
        let (wheel, rail) = (turn(rim, &to_wheel, -force), turn(head, &to_rail, force));
        let about_touch = |turn: f64, arm: &Vector2<f64>| Vector3::new(arm.y * turn, -arm.x * turn, turn);
        let way = self.along * load.approach;
        Pose {
            wheel: about_touch(wheel, &to_wheel) + Vector3::new(way.x, way.y, 0.0),
            rail: about_touch(rail, &to_rail),
        }
    }

    fn force(&self, profiles: &mut Profiles, pose: &Pose, law: &impl StripLaw) -> f64 {
        let mut contacts = Vec::new();
        profiles.contacts(pose, law, &mut contacts);
        contacts.iter().map(|contact| -contact.force.xy().dot(&self.along)).sum()
    }
}

/// Stiffness of a place over that of a `table`: least squares of the approaches under its loads, which go with
/// the power -2/3 of the stiffness.
fn ratio(place: &Pressed, table: &StripStiffness, bodies: [&Matrix3<f64>; 2]) -> f64 {
    let mut profiles = place.profiles();
    let logarithms = place.loads.iter().map(|load| {
        let unit = place.force(&mut profiles, &place.pose(load, bodies), table);
        load.approach.powi(2) * (load.force / unit).ln()
    });
    let squares: f64 = place.loads.iter().map(|load| load.approach.powi(2)).sum();
    (logarithms.sum::<f64>() / squares).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::placement::TrackGeometry;
    use crate::section::{rail_section, wheel_section};

    /// Source: the strips of Hertz's contact times a factor. Goal: approaches that these strips make give them back: the factor at every place of the rail
    /// between those of the laws, and the tangential stiffness that the flexibility across the normal leaves. Accuracy: SOLVER, a force in
    /// proportion to the stiffness.
    #[test]
    fn strips_are_found_from_their_approaches() {
        const SOLVER: f64 = 1e-9;
        const FACTOR: f64 = 1.3;
        const TANGENTIAL: f64 = 0.75;
        let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.858).unwrap());
        let pair = Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap();
        let rigid = Matrix3::zeros();
        let mut strips = hertz_table(&pair, &Material::STEEL);
        strips.places.iter_mut().for_each(|place| place.modulus *= FACTOR);
        let laws: Vec<PlaceApproaches> = [-3e-3, 0.0, 4e-3, 6e-3]
            .map(|shift| {
                let tape_y = pair.tape_y + shift;
                let place = pair.with_wheel_at(tape_y).unwrap();
                let along = -place.placed.curve.upward_normal(place.touch.rail_s);
                let pressed = Pressed { pair: place, along, loads: Vec::new(), tangential: 1.0 };
                let mut profiles = pressed.profiles();
                let load = |way: f64| {
                    let pose = pressed.pose(&PlaceLoad { force: 0.0, approach: way }, [&rigid; 2]);
                    PlaceLoad { force: pressed.force(&mut profiles, &pose, &strips), approach: way }
                };
                let loads = [20e-6, 50e-6, 80e-6].map(load).to_vec();
                PlaceApproaches { tape_y, loads, compliances: vec![[1e-9, 1e-9 / TANGENTIAL]] }
            })
            .to_vec();
        let found = fit_strips(&pair, &Material::STEEL, &laws, [&rigid; 2]).unwrap();
        assert!(found.misfit < SOLVER, "{}", found.misfit);
        for (found, exact) in found.places.iter().zip(&strips.places) {
            assert!((found.modulus / exact.modulus - 1.0).abs() < SOLVER, "{found:?} {exact:?}");
            assert!((found.tangential / TANGENTIAL - 1.0).abs() < SOLVER, "{found:?}");
        }
        let none = fit_strips(&pair, &Material::STEEL, &[], [&rigid; 2]).unwrap_err().to_string();
        assert!(none.contains("no place with a law"), "{none}");
    }
}
