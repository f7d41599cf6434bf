//! Fits the strips of a pair to its laws by contact angle.

use super::hertz::{hertz_table, winkler_table};
use super::places::{PlaceApproaches, PlaceLoad, StickingHub};
use super::sections::SectionFlexibility;
use nalgebra::{DMatrix, DVector, Point2, Vector2, Vector3};
use railspring_calibrate::pair::Pair;
use railspring_calibrate::superelement::carried;
use railspring_element::law::{StripPlace, StripStiffness};
use railspring_element::modulus::StripModulus;
use railspring_element::overlap::{Pose, Profiles};
use railspring_element::strips::{Contact, ContactStrips};
use railspring_profiles::error::{InputError, Result};

/// Distance of the places at which stiffness and hardening are sought, m.
const KNOTS: f64 = 3e-3;

/// A knot takes part in contacts that first touch so near, m.
const REACH: f64 = 15e-3;

/// A contact whose normal turns farther than this under a load has gone elsewhere, degrees: what the wheel has moved along the first normal says nothing of it.
const TURNED: f64 = 8.0;

/// Loads of a place that are looked at, at most.
const LOADS: usize = 8;

/// Gauss-Newton steps at most, and what the last one leads down, relative.
const ROUNDS: usize = 20;
const SETTLED: f64 = 1e-5;

/// Change of a logarithm and of a hardening for a derivative.
const SMALL: f64 = 1e-4;

/// Tikhonov weights: a hardening of this size, and such a change of the logarithm of the stiffness or of the
/// hardening from knot to knot, are penalised like a displacement error of 1 %. They decide where the laws do not.
const HARDENING_SCALE: f64 = 1.0;
const CHANGE_SCALE: f64 = 0.07;
/// What a change costs.
const CHANGE_COST: f64 = 1e-2 / CHANGE_SCALE;

/// Least and largest hardening.
const HARDENING: [f64; 2] = [-0.8, 4.0];

/// Tangential over normal stiffness that a contact can have: the integrals of Mindlin for ellipses stay well within.
const PLAUSIBLE: std::ops::RangeInclusive<f64> = 0.4..=1.5;

/// What strips are like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StripForm {
    /// Their loads take off penetrations, and they get stiffer with their own.
    Relieved,
    /// Those of a Winkler foundation: each has a force in proportion to its penetration, whatever the others have.
    Winkler,
}

/// Rim and head, between which the strips are.
#[derive(Clone, Copy)]
pub struct Sections<'a> {
    /// The rim, about the origin of the wheel's profile.
    pub rim: &'a SectionFlexibility,
    /// The head, about the rail's reference point.
    pub head: &'a SectionFlexibility,
}

impl Sections<'_> {
    /// Their flexibility in a direction where the wheel touches, m/N.
    fn along(&self, pair: &Pair, direction: Vector2<f64>) -> f64 {
        let of = |section: &SectionFlexibility, at: Point2<f64>| {
            let force = carried(&(pair.touch.point - at)).tr_mul(&direction);
            force.dot(&(section.flexibility * force))
        };
        of(self.rim, Point2::from(pair.tape())) + of(self.head, pair.node_line())
    }
}

/// A place with its approaches: those at which the contact is where the wheel first touched.
struct Pressed {
    pair: Pair,
    along: Vector2<f64>,
    loads: Vec<PlaceLoad>,
    sticking: Vec<StickingHub>,
}

/// What is sought at one place of the rail.
#[derive(Debug, Clone, Copy)]
struct Knot {
    /// Arc length, m.
    rail_s: f64,
    /// Logarithm of the stiffness over Hertz's.
    ratio: f64,
    hardening: f64,
    tangential: f64,
}

/// Fits the strips of a pair, of a form, to its laws by contact angle: at every place and load the force that belongs to the approach of the
/// surfaces and to what the sections lack. Their rotation under the load turns the profiles against each other. `modulus` is the
/// contact modulus of both bodies, Pa.
///
/// # Errors
/// [`InputError`] if no place has a law.
pub fn fit_strips(
    pair: &Pair,
    modulus: f64,
    laws: &[PlaceApproaches],
    sections: &Sections,
    form: StripForm,
) -> Result<StripStiffness> {
    let hertz = match form {
        StripForm::Relieved => hertz_table(pair, modulus),
        StripForm::Winkler => winkler_table(pair, modulus),
    };
    let mut pressed = Vec::new();
    for law in laws {
        let place = pair.with_wheel_at(law.tape_y)?;
        let mut place = Pressed { pair: place, along: law.along, loads: Vec::new(), sticking: Vec::new() };
        let stays = |load: &PlaceLoad| place.stays(&mut place.profiles(&hertz), sections, load, &hertz);
        let every = law.loads.len().div_ceil(LOADS).max(1);
        let loads = law.loads.iter().rev().step_by(every).filter(|load| stays(load)).copied().collect();
        let sticking = law.sticking.iter().filter(|hub| stays(&hub.load)).copied().collect();
        (place.loads, place.sticking) = (loads, sticking);
        if !place.loads.is_empty() {
            pressed.push(place);
        }
    }
    if pressed.is_empty() {
        return InputError::refuse(
            "laws by contact angle",
            "no place with a law",
            "a law at one place of the rail at least",
            "put the wheel in other places, where it stands on one contact",
        );
    }
    let touches = pressed.iter().map(|place| place.pair.touch.rail_s);
    let (first, last) =
        touches.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| (low.min(s), high.max(s)));
    let parts = ((last - first) / KNOTS).ceil();
    let knot = |i: usize| Knot {
        rail_s: first + (last - first) * i as f64 / parts.max(1.0),
        ratio: 0.0,
        hardening: 0.0,
        tangential: 1.0,
    };
    let knots = (0..=parts as usize).map(knot).collect();
    let mut fit = Fit { hertz, knots, sections: *sections, hardens: form == StripForm::Relieved };
    fit.normal(&pressed);
    fit.tangential(&pressed);
    let mut found = fit.table();
    for place in &pressed {
        let mut profiles = place.profiles(&fit.hertz);
        for load in &place.loads {
            let force = fit.force(place, &mut profiles, load, &found);
            found.misfit = found.misfit.max((force / load.force - 1.0).abs());
        }
    }
    Ok(found)
}

struct Fit<'a> {
    hertz: StripStiffness,
    knots: Vec<Knot>,
    sections: Sections<'a>,
    /// Whether strips may get stiffer with their penetration.
    hardens: bool,
}

impl Fit<'_> {
    /// The strips of Hertz with what the knots say of them.
    fn table(&self) -> StripStiffness {
        let place = |place: &StripPlace| {
            let knot = between(&self.knots, place.rail_s);
            let normal = place.modulus.normal * knot.ratio.exp();
            let modulus = StripModulus {
                normal,
                hardening: knot.hardening,
                tangential: place.modulus.tangential * knot.tangential,
                relief: place.modulus.relief,
            };
            StripPlace { modulus, ..*place }
        };
        StripStiffness::new(self.hertz.places().iter().map(place).collect(), self.hertz.influence, 0.0)
    }

    /// Force of the strips under the approach that belongs to a load, N.
    fn force(
        &self,
        place: &Pressed,
        profiles: &mut ContactStrips,
        load: &PlaceLoad,
        strips: &StripStiffness,
    ) -> f64 {
        let contacts = place.contacts(profiles, &self.sections, load, strips);
        total(&contacts, |contact| -contact.force.xy().dot(&place.along))
    }

    /// Relative errors of the displacements of a place: the force goes with the power 3/2 of the approach. Small loads
    /// count less, as their displacements are small.
    fn residual(&self, place: &Pressed, strips: &StripStiffness) -> Vec<f64> {
        let mut profiles = place.profiles(&self.hertz);
        let deepest = place.loads.iter().map(|load| load.approach).fold(0.0, f64::max);
        let off = |load: &PlaceLoad| {
            let force = self.force(place, &mut profiles, load, strips).max(1e-3 * load.force);
            (load.approach / deepest).sqrt() * (force / load.force).ln() / 1.5
        };
        place.loads.iter().map(off).collect()
    }

    /// The residuals of the least squares: errors of the displacements, and the penalties.
    fn residuals(&self, pressed: &[Pressed]) -> Vec<Vec<f64>> {
        let strips = self.table();
        let mut all: Vec<Vec<f64>> = pressed.iter().map(|place| self.residual(place, &strips)).collect();
        let (changes, hardenings) = self.costs();
        all.extend([changes, hardenings]);
        all
    }

    /// What it costs that knots differ from their neighbours, and that they have a hardening.
    fn costs(&self) -> (Vec<f64>, Vec<f64>) {
        let change = |pair: &[Knot]| {
            [pair[1].ratio - pair[0].ratio, pair[1].hardening - pair[0].hardening].map(|by| CHANGE_COST * by)
        };
        let own = |knot: &Knot| 1e-2 / HARDENING_SCALE * knot.hardening;
        (self.knots.windows(2).flat_map(change).collect(), self.knots.iter().map(own).collect())
    }

    /// Least squares of the displacements by the stiffness at all places, and by the hardening if there may be one: Gauss's and Newton's steps, shortened until they lead down.
    fn normal(&mut self, pressed: &[Pressed]) {
        let count = self.knots.len();
        let unknowns = if self.hardens { 2 * count } else { count };
        let value = |knots: &mut [Knot], n: usize, by: f64| {
            let knot = &mut knots[n % count];
            *if n < count { &mut knot.ratio } else { &mut knot.hardening } += by;
        };
        let vector = |all: &[Vec<f64>]| {
            DVector::from_iterator(all.iter().map(Vec::len).sum(), all.iter().flatten().copied())
        };
        let mut all = self.residuals(pressed);
        for _ in 0..ROUNDS {
            let off = vector(&all);
            let mut slopes = DMatrix::zeros(off.len(), unknowns);
            for n in 0..unknowns {
                value(&mut self.knots, n, SMALL);
                let strips = self.table();
                let rail_s = self.knots[n % count].rail_s;
                let near = |place: &Pressed| (place.pair.touch.rail_s - rail_s).abs() < REACH;
                let mut moved = all.clone();
                let places = pressed.iter().zip(&mut moved).filter(|(place, _)| near(place));
                places.for_each(|(place, moved)| *moved = self.residual(place, &strips));
                let [costs, own] = [moved.len() - 2, moved.len() - 1];
                let exact = self.costs();
                (moved[costs], moved[own]) = (exact.0, exact.1);
                slopes.set_column(n, &((vector(&moved) - &off) / SMALL));
                value(&mut self.knots, n, -SMALL);
            }
            let normal = slopes.tr_mul(&slopes);
            let Some(step) = normal.cholesky().map(|c| c.solve(&slopes.tr_mul(&off))) else { return };
            let before = self.knots.clone();
            let mut share = 1.0;
            loop {
                for n in 0..unknowns {
                    value(&mut self.knots, n, -share * step[n]);
                }
                let [least, most] = HARDENING;
                self.knots.iter_mut().for_each(|knot| knot.hardening = knot.hardening.clamp(least, most));
                all = self.residuals(pressed);
                let down = 1.0 - vector(&all).norm() / off.norm();
                if down > 0.0 {
                    if down < SETTLED {
                        return;
                    }
                    break;
                }
                self.knots.clone_from(&before);
                share *= 0.5;
                if share < 1e-3 {
                    return;
                }
            }
        }
    }

    /// What both sections leave of the hub's flexibility across the normal is the contact's: least squares of it by the tangential stiffness at all places, which costs
    /// something to change from knot to knot.
    fn tangential(&mut self, pressed: &[Pressed]) {
        let count = self.knots.len();
        // the stiffness of a contact is linear in what the knots have: tables of one knot each
        let mut of_knot = |n: usize| {
            for (i, knot) in self.knots.iter_mut().enumerate() {
                knot.tangential = if i == n { 1.0 } else { 0.0 };
            }
            self.table()
        };
        let tables: Vec<StripStiffness> = (0..count).map(&mut of_knot).collect();
        let mut parts = Vec::new();
        for place in pressed {
            let mut profiles = place.profiles(&self.hertz);
            let direction = Vector2::new(-place.along.y, place.along.x);
            let of_sections = self.sections.along(&place.pair, direction);
            for StickingHub { load, across, .. } in &place.sticking {
                let flexibility = across - of_sections;
                if !PLAUSIBLE.contains(&(load.approach / flexibility / load.force / 1.5)) {
                    continue;
                }
                let of_table = |strips: &StripStiffness| {
                    let contacts = place.contacts(&mut profiles, &self.sections, load, strips);
                    // the strips miss the load by a few per cent, and the contact grows with its third root
                    let carried = total(&contacts, |contact| -contact.force.xy().dot(&place.along));
                    let whole = total(&contacts, |contact| contact.tangential_stiffness);
                    whole * (load.force / carried).cbrt() * flexibility
                };
                let part = DVector::from_iterator(count, tables.iter().map(of_table));
                if part.sum() > 0.0 {
                    parts.push(part);
                }
            }
        }
        let mut ratios = DVector::zeros(count);
        for _ in 0..ROUNDS {
            let (mut normal, mut right) = (DMatrix::zeros(count, count), DVector::zeros(count));
            let mut add = |slope: &DVector<f64>, off: f64| {
                normal += slope * slope.transpose();
                right -= slope * off;
            };
            for part in &parts {
                let stiffness = part.component_mul(&ratios.map(f64::exp));
                let sum = stiffness.sum();
                // logarithm of the flexibility over the wanted one
                add(&(stiffness / -sum), -sum.ln());
            }
            for n in 1..count {
                let mut slope = DVector::zeros(count);
                (slope[n], slope[n - 1]) = (CHANGE_COST, -CHANGE_COST);
                add(&slope, CHANGE_COST * (ratios[n] - ratios[n - 1]));
            }
            let Some(step) = normal.cholesky().map(|c| c.solve(&right)) else { break };
            ratios += &step;
            if step.amax() < SETTLED {
                break;
            }
        }
        for (knot, ratio) in self.knots.iter_mut().zip(&ratios) {
            knot.tangential = ratio.exp();
        }
    }
}

fn total(contacts: &[Contact], value: impl Fn(&Contact) -> f64) -> f64 {
    contacts.iter().map(value).sum()
}

/// A knot between those that are not equally far apart: in proportion, constant beyond them.
fn between(knots: &[Knot], rail_s: f64) -> Knot {
    let last = knots.len() - 1;
    let upper = knots.partition_point(|knot| knot.rail_s < rail_s);
    let (a, b) = (&knots[upper.saturating_sub(1).min(last)], &knots[upper.min(last)]);
    let apart = b.rail_s - a.rail_s;
    let t = if apart > 0.0 { ((rail_s - a.rail_s) / apart).clamp(0.0, 1.0) } else { 0.0 };
    let at = |a: f64, b: f64| a + t * (b - a);
    Knot {
        rail_s,
        ratio: at(a.ratio, b.ratio),
        hardening: at(a.hardening, b.hardening),
        tangential: at(a.tangential, b.tangential),
    }
}

impl Pressed {
    fn profiles(&self, strips: &StripStiffness) -> ContactStrips {
        let pair = &self.pair;
        let profiles = Profiles::new(
            &pair.placed.curve,
            &pair.wheel.running,
            Point2::from(pair.tape()),
            pair.node_line(),
        );
        ContactStrips::new(profiles, strips)
    }

    /// Both sections turned under a load, the touching point moved together by the approach.
    fn pose(&self, sections: &Sections, load: &PlaceLoad) -> Pose {
        let pair = &self.pair;
        let (to_wheel, to_rail) =
            (pair.touch.point - Point2::from(pair.tape()), pair.touch.point - pair.node_line());
        let force = self.along * load.force;
        let turn = |section: &SectionFlexibility, arm: &Vector2<f64>, force: Vector2<f64>| {
            let moved: Vector3<f64> = section.flexibility * (carried(arm).transpose() * force);
            moved.z
        };
        let (wheel, rail) = (turn(sections.rim, &to_wheel, -force), turn(sections.head, &to_rail, force));
        let about_touch = |turn: f64, arm: &Vector2<f64>| Vector3::new(arm.y * turn, -arm.x * turn, turn);
        let way = self.along * load.approach;
        Pose {
            wheel: about_touch(wheel, &to_wheel) + Vector3::new(way.x, way.y, 0.0),
            rail: about_touch(rail, &to_rail),
        }
    }

    /// Whether the contact under a load is where the wheel first touched.
    fn stays(
        &self,
        profiles: &mut ContactStrips,
        sections: &Sections,
        load: &PlaceLoad,
        strips: &StripStiffness,
    ) -> bool {
        let contacts = self.contacts(profiles, sections, load, strips);
        let force: Vector2<f64> = -contacts.iter().map(|contact| contact.force.xy()).sum::<Vector2<f64>>();
        force.angle(&self.along) < TURNED.to_radians()
    }

    /// The contacts under the approach that belongs to a load, without friction.
    fn contacts(
        &self,
        profiles: &mut ContactStrips,
        sections: &Sections,
        load: &PlaceLoad,
        strips: &StripStiffness,
    ) -> Vec<Contact> {
        let mut contacts = Vec::new();
        profiles.settled(&self.pose(sections, load), strips, &mut contacts);
        contacts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Matrix3};
    use railspring_calibrate::solid::Material;
    use railspring_profiles::placement::TrackGeometry;
    use railspring_profiles::section::{rail_section, wheel_section};

    /// Contact modulus of steel on steel, Pa.
    fn steel() -> f64 {
        Material::STEEL.contact_modulus(&Material::STEEL)
    }

    /// Source: the strips of Hertz's contact, or of a Winkler foundation that is as stiff, times a factor.
    /// Goal: approaches that these strips make give the strips back. These are the normal stiffness at every
    /// place of the rail between those of the laws, no hardening, and the tangential stiffness that the
    /// flexibility across the normal leaves. Approaches of strips with a hardening are met as well, except by
    /// a foundation, which has none. Accuracy: SOLVER, least squares without a rest. With a hardening, which
    /// has a cost, forces are met within a hundredth.
    #[test]
    fn strips_are_found_from_their_approaches() {
        const SOLVER: f64 = 1e-6;
        const HARDENED: f64 = 1e-2;
        const FACTOR: f64 = 1.3;
        const TANGENTIAL: f64 = 0.5;
        let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.858).unwrap());
        let pair = Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap();
        let rigid = SectionFlexibility { flexibility: Matrix3::zeros(), misfit: 0.0 };
        let sections = Sections { rim: &rigid, head: &rigid };
        for (form, hardening) in [
            (StripForm::Relieved, 0.0),
            (StripForm::Relieved, 0.4),
            (StripForm::Winkler, 0.0),
            (StripForm::Winkler, 0.4),
        ] {
            let hertz = match form {
                StripForm::Relieved => hertz_table(&pair, steel()),
                StripForm::Winkler => winkler_table(&pair, steel()),
            };
            let mut places = hertz.places().to_vec();
            for StripPlace { modulus, .. } in &mut places {
                modulus.normal *= FACTOR;
                modulus.hardening = hardening;
                modulus.tangential *= TANGENTIAL;
            }
            let strips = StripStiffness::new(places, hertz.influence, 0.0);
            let laws: Vec<PlaceApproaches> = [-3e-3, 0.0, 4e-3, 6e-3]
                .map(|shift| {
                    let tape_y = pair.tape_y + shift;
                    let place = pair.with_wheel_at(tape_y).unwrap();
                    let along = -place.placed.curve.upward_normal(place.touch.rail_s);
                    let pressed = Pressed { pair: place, along, loads: Vec::new(), sticking: Vec::new() };
                    let mut profiles = pressed.profiles(&strips);
                    let under = |way: f64| {
                        let load = PlaceLoad { force: 0.0, approach: way };
                        let contacts = pressed.contacts(&mut profiles, &sections, &load, &strips);
                        let force = total(&contacts, |contact| -contact.force.xy().dot(&along));
                        let flexibility = 1.0 / total(&contacts, |contact| contact.tangential_stiffness);
                        StickingHub {
                            load: PlaceLoad { force, approach: way },
                            flexibility: Matrix2::identity() * flexibility,
                            across: flexibility,
                        }
                    };
                    let sticking = [10e-6, 25e-6, 50e-6, 80e-6].map(under).to_vec();
                    let loads = sticking.iter().map(|hub| hub.load).collect();
                    PlaceApproaches { tape_y, along, loads, sticking }
                })
                .to_vec();
            let found = fit_strips(&pair, steel(), &laws, &sections, form).unwrap();
            println!("{form:?} {hardening} {}", found.misfit);
            if hardening > 0.0 {
                let is_met = found.misfit < HARDENED;
                assert_eq!(is_met, form == StripForm::Relieved, "{}", found.misfit);
                let hardened = found.places().iter().any(|place| place.modulus.hardening != 0.0);
                assert_eq!(hardened, form == StripForm::Relieved);
                continue;
            }
            assert!(found.misfit < SOLVER, "{}", found.misfit);
            for (found, exact) in found.places().iter().zip(strips.places()) {
                let (found, exact) = (found.modulus, exact.modulus);
                assert!((found.normal / exact.normal - 1.0).abs() < SOLVER, "{found:?} {exact:?}");
                assert!(found.hardening.abs() < SOLVER, "{found:?}");
                assert!((found.tangential / exact.tangential - 1.0).abs() < SOLVER, "{found:?} {exact:?}");
            }
        }
        let none = fit_strips(&pair, steel(), &[], &sections, StripForm::Relieved).unwrap_err().to_string();
        assert!(none.contains("no place with a law"), "{none}");
    }
}
