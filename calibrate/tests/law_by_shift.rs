//! The law by contact angle: S1002 on 60E1 in several places across the track, on coarse meshes.

use nalgebra::Vector2;
use railspring_calibrate::calibration::{ContactField, Enforcement, LoadPoint, Reference};
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::pair::{
    AngleLaw, AngleSettings, ByReference, CondensedPair, ContactConditions, Laws, Pair, PairBody,
    PressDirection, ShiftLaw, law_by_shift,
};
use railspring_calibrate::solid::{Formulation, Material};
use railspring_profiles::error::{Error, StopReason};
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};

const LOADS: [f64; 6] = [1e3, 5e3, 12e3, 25e3, 40e3, 60e3];
const FIXED: [f64; 3] = [20e3, 40e3, 80e3];

fn condensed(window_half_length: f64) -> (Pair, CondensedPair) {
    let options = MeshOptions {
        contact_element: 3e-3,
        contact_element_along: 2.5e-3,
        rail_section_element: 16e-3,
        wheel_section_element: 24e-3,
        growth: 2.0,
        window_half_length,
        ..MeshOptions::default()
    };
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.858).unwrap());
    let pair = Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap();
    let meshes = pair.mesh(0.4, &options).unwrap();
    let bodies = meshes
        .condense(&pair, &PairBody::ALL, Material::STEEL, Formulation::FullIntegration, &Silent)
        .unwrap();
    (pair, bodies)
}

fn settings(friction: f64, direction: PressDirection) -> AngleSettings<'static> {
    settings_in(ContactField::Elements, friction, direction)
}

fn settings_in(field: ContactField, friction: f64, direction: PressDirection) -> AngleSettings<'static> {
    let contact = ContactConditions { friction, enforcement: Enforcement::Exact, field };
    AngleSettings { contact, direction, loads: &LOADS, fixed_loads: &FIXED, stresses: false }
}

fn laws(pair: &Pair, bodies: &CondensedPair, settings: &AngleSettings, shifts: &[f64]) -> Vec<ShiftLaw> {
    let tape_ys: Vec<f64> = shifts.iter().map(|shift| pair.tape_y + shift).collect();
    let laws = law_by_shift(pair, bodies, settings, &tape_ys, &Silent).unwrap();
    assert_eq!(laws.len(), shifts.len());
    laws
}

fn law(entry: &ShiftLaw) -> &AngleLaw {
    entry.law.as_ref().unwrap_or_else(|reason| panic!("tape circle at {} m: {reason}", entry.tape_y))
}

/// Source: `CondensedPair::press` on the same bodies. Goal: where the wheel of the calibration stands,
/// pressed down, the laws by angle are those of a calibration with the loads and the fixed loads within their
/// range. One fixed load is a load as well. Fixed loads have the values of the calibration. Without the rail
/// on its foot the other laws are the same, and the law against the foot is refused. Loads beyond the range
/// are left out. A place has the same law alone and among others. Units N, m. Accuracy: to the bit; the parts
/// of the compliance make up the tangent to ROUNDOFF.
#[test]
fn the_place_of_the_calibration_has_its_laws() {
    const ROUNDOFF: f64 = 1e-9;
    let (pair, bodies) = condensed(12e-3);
    let settings = settings(0.3, PressDirection::Vertical);
    let in_turn = [&LOADS[..3], &[FIXED[0]], &LOADS[3..]].concat();
    let pressed = bodies.press(&pair, settings.contact, &in_turn, &Silent).unwrap();
    let entries = laws(&pair, &bodies, &settings, &[-4e-3, 0.0]);
    let entry = law(&entries[1]);
    assert!(entry.ended.is_none());
    assert_eq!(entry.laws.iter().count(), 3);
    for (reference, found) in entry.laws.iter() {
        let wanted = pressed.fit(reference).unwrap();
        assert_eq!(found.reference, reference);
        assert_eq!(found.points, wanted.points);
        assert_eq!(found.fit.law, wanted.fit.law);
    }
    let touch = entries[1].touch.unwrap();
    assert_eq!(touch.touch, pair.touch);
    assert_eq!(touch.along.into_inner(), Vector2::new(0.0, 1.0));
    assert_eq!(entry.fixed.iter().map(|f| f.points.beam.force).collect::<Vec<_>>(), FIXED[..2]);
    for (reference, calibration) in entry.laws.iter() {
        let fixed = [0, 1].map(|k| *entry.fixed[k].points.get(reference).unwrap());
        assert_eq!(fixed, [calibration.points[3], calibration.points[5]], "{:?}", calibration.reference);
        for p in &calibration.points {
            let parts = p.local_compliance
                + if calibration.reference == Reference::Local {
                    0.0
                } else {
                    p.wheel_compliance + p.rail_compliance + p.sliding_compliance
                };
            assert!((parts * p.solid_tangent - 1.0).abs() < ROUNDOFF, "{parts} {}", p.solid_tangent);
        }
    }
    // pressed down, across is lateral
    for fixed in &entry.fixed {
        assert!((fixed.tangential_stiffness / fixed.horizontal_stiffness - 1.0).abs() < ROUNDOFF);
    }
    let alone = laws(&pair, &bodies, &settings, &[-4e-3]);
    assert_eq!(law(&alone[0]).fixed, law(&entries[0]).fixed);
    assert_ne!(law(&alone[0]).fixed, entry.fixed);
    // without the rail on its foot
    let mut without = bodies;
    without.rail_on_foot = None;
    let found = laws(&pair, &without, &settings, &[0.0]);
    let found = law(&found[0]);
    assert!(found.laws.foot.is_none() && found.laws.beam.points == entry.laws.beam.points);
    for (found, entry) in found.fixed.iter().zip(&entry.fixed) {
        assert_eq!(found.points, ByReference { foot: None, ..entry.points });
    }
    let pressed = without.press(&pair, settings.contact, &in_turn, &Silent).unwrap();
    assert_eq!(pressed.fit(Reference::Local).unwrap().points, entry.laws.local.points);
    let refused = pressed.fit(Reference::Foot).map(|_| ()).unwrap_err().to_string();
    assert!(refused.contains("rail on its foot") && refused.contains("of_pair(true)"), "{refused}");
}

/// Goal: the flange, pressed along its normal, has its laws for little and much friction, on the meshes' nodes and on the fine grid. The contact
/// lies on the flange of both profiles; against foot and section it is softer than its approach alone, and against the foot softer
/// than against the section. The parts of the compliance, friction of sliding points included, make up the tangent, and on the
/// fine grid every displacement is the integral of its tangents. Units N, m, rad. Accuracy: SOLVER, 1e-6 of the tangent;
/// DISCRETISATION, the law of five loads, integrated, is within 2.5 % of the largest displacement (a power law, and trapezia between
/// the loads).
#[test]
fn the_flange_has_its_law_whatever_the_friction() {
    const SOLVER: f64 = 1e-6;
    const DISCRETISATION: f64 = 0.025;
    let (pair, bodies) = condensed(18e-3);
    for (field, shifts) in
        [(ContactField::Elements, vec![6.5e-3, 7e-3, 8e-3]), (ContactField::Hybrid, vec![6.5e-3, 7.5e-3])]
    {
        for friction in [0.05, 0.6] {
            let settings = settings_in(field, friction, PressDirection::Normal);
            let settings = AngleSettings { loads: &[2e3, 6e3, 12e3, 20e3, 30e3], ..settings };
            for entry in laws(&pair, &bodies, &settings, &shifts) {
                let case = format!("{field:?}, friction {friction}, tape circle at {} m", entry.tape_y);
                let touch = entry.touch.unwrap();
                let angle = touch.touch.contact_angle;
                let found = law(&entry);
                assert!(found.ended.is_none(), "{case}: {:?}", found.ended);
                assert!(angle > 0.4 && touch.on_wheel.x < -0.02 && touch.on_rail.x < -0.02, "{touch:?}");
                assert!((touch.along.x.atan2(touch.along.y) - angle).abs() < 1e-12);
                let Laws { foot: Some(foot), beam, local, .. } = &found.laws else {
                    panic!("{case}: three laws")
                };
                for ((f, b), l) in foot.points.iter().zip(&beam.points).zip(&local.points) {
                    assert!(f.displacement > b.displacement && b.displacement > l.displacement, "{case}");
                    for p in [f, b] {
                        let parts = p.local_compliance
                            + p.wheel_compliance
                            + p.rail_compliance
                            + p.sliding_compliance;
                        let error = parts * p.solid_tangent - 1.0;
                        assert!(error.abs() < SOLVER, "{case}: {error:e}");
                    }
                }
                for (_, law) in found.laws.iter() {
                    let whole = law.points.last().unwrap().displacement;
                    let off =
                        |p: &LoadPoint| (law.fit.law.displacement(p.force) - p.displacement).abs() / whole;
                    let farthest = law.points.iter().max_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
                    let (force, deviation) = (farthest.force, off(farthest));
                    if field == ContactField::Hybrid {
                        assert!(
                            deviation < DISCRETISATION,
                            "{case}, {:?}: {deviation} at {force}",
                            law.reference
                        );
                    }
                }
                let [fixed] = &found.fixed[..] else { panic!("{case}: one fixed load is in the range") };
                assert!(fixed.horizontal_stiffness > 0.0 && fixed.tangential_stiffness > 0.0);
            }
        }
    }
}

/// Goal: places without a law are entries with their reasons: a wheel that misses the rail, a contact that
/// reaches the end of the window, and one in two places. The laws beside them are as without them. A law ends
/// before the load that is not carried.
#[test]
fn what_has_no_law_says_why() {
    let (pair, bodies) = condensed(6e-3);
    let settings = settings(0.3, PressDirection::Normal);
    let shifts = [-90e-3, -4e-3, 7e-3];
    let entries = laws(&pair, &bodies, &settings, &shifts);
    assert!(entries[0].touch.is_none());
    let Err(Error::Input(missed)) = &entries[0].law else { panic!("the wheel misses the rail") };
    assert!(missed.key == "lateral_shift" && missed.expected.contains("touch"), "{missed}");
    assert_eq!(law(&laws(&pair, &bodies, &settings, &[-4e-3])[0]).fixed, law(&entries[1]).fixed);
    let reason = match &entries[2].law {
        Ok(law) => {
            let largest = law.laws.beam.points.last().unwrap().force;
            assert!(law.laws.iter().all(|(_, l)| l.points.len() == law.laws.beam.points.len()));
            assert!(largest < LOADS[5] && law.fixed.iter().all(|f| f.points.beam.force <= largest));
            law.ended.clone().unwrap()
        }
        Err(reason) => reason.clone(),
    };
    let Error::Numerics(reason) = reason else { panic!("{reason}") };
    assert_eq!(reason.reason, StopReason::EndOfWindow, "{reason}");
    assert!(reason.step.is_some() && reason.stage.contains("kN"), "{reason}");
}

/// Goal: a pair with two contacts has a law. In the middle S1002 touches 60E1 in two places of the tread that
/// are nearly parallel, 11 mm apart. At 5.5 mm tread and gauge corner share the load, with normals 11 degrees
/// apart. From there on the law is that of both contacts. The normal forces of both, with friction across
/// them, carry the load along the first touch. The tangent is still the slope of the displacement. Units N,
/// m, rad. Accuracy: SHARE, the friction of 0.3 at most that acts along the load where a normal is 11 degrees
/// off it. SLOPE, the chord between two loads beside the mean of their tangents, over a factor of 1.15 of the
/// load.
#[test]
fn a_law_goes_on_where_a_second_contact_begins() {
    const SHARE: f64 = 0.06;
    const SLOPE: f64 = 0.01;
    let (pair, bodies) = condensed(12e-3);
    let settings = settings_in(ContactField::Elements, 0.3, PressDirection::Normal);
    let settings = AngleSettings {
        loads: &[1e3, 3e3, 6e3, 10e3, 60e3, 69e3, 120e3],
        fixed_loads: &[6e3, 60e3],
        ..settings
    };
    let entries = laws(&pair, &bodies, &settings, &[0.0, 0.25e-3, 5.5e-3]);
    for entry in &entries[..2] {
        assert!(law(entry).ended.is_none() && law(entry).shared_from.is_none(), "{:?}", law(entry).ended);
    }
    let corner = law(&entries[2]);
    assert!(corner.ended.is_none() && corner.laws.beam.points.len() == 7, "{:?}", corner.ended);
    assert_eq!(corner.shared_from, Some(60e3));
    assert!(corner.is_of_one_contact(10e3) && !corner.is_of_one_contact(60e3));
    let [one, both] = &corner.fixed[..] else { panic!("two fixed loads") };
    assert_eq!((one.contacts.len(), both.contacts.len()), (1, 2));
    let apart = both.contacts[0].normal.angle(&both.contacts[1].normal);
    assert!((0.1..0.4).contains(&apart), "{apart}");
    let along = entries[2].touch.unwrap().along;
    let carried: f64 = both.contacts.iter().map(|contact| -contact.force * contact.normal.dot(&along)).sum();
    assert!((carried / 60e3 - 1.0).abs() < SHARE, "{carried}");
    let [.., a, b, _] = &corner.laws.beam.points[..] else { panic!("the loads") };
    let chord = (b.force - a.force) / (b.displacement - a.displacement);
    let mean = 2.0 / (1.0 / a.solid_tangent + 1.0 / b.solid_tangent);
    assert!((chord / mean - 1.0).abs() < SLOPE, "{chord} {mean}");
}

/// Goal: loads that cannot be used are refused by name before anything is pressed.
#[test]
fn wrong_loads_are_refused() {
    let (pair, bodies) = condensed(6e-3);
    let good = settings(0.3, PressDirection::Normal);
    let unordered: &[f64] = &[1e3, 3e3, 2e3, 4e3];
    let cases = [
        AngleSettings { loads: &[1e3, 2e3, 3e3], ..good },
        AngleSettings { loads: unordered, ..good },
        AngleSettings { loads: &[0.0, 1e3, 2e3, 3e3], ..good },
        AngleSettings { fixed_loads: &[f64::NAN], ..good },
        settings(0.0, PressDirection::Normal),
    ];
    for case in cases {
        let Err(Error::Input(refused)) = law_by_shift(&pair, &bodies, &case, &[pair.tape_y], &Silent) else {
            panic!("{case:?}")
        };
        assert!(["loads", "friction"].contains(&refused.key.as_str()), "{refused}");
    }
}
