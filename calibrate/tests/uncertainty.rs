//! Pairs whose inputs depart from what they are taken to be, pressed on the bodies of the nominal pair.

use nalgebra::Point2;
use railspring_calibrate::calibration::{ContactField, Enforcement, Reference};
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::pair::{CondensedPair, ContactConditions, Pair, PairBody};
use railspring_calibrate::solid::{Formulation, Material};
use railspring_calibrate::uncertainty::{
    Answers, Asked, Departure, Distribution, Input, UncertainPair, propagate,
};
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::section::{RailSection, WheelSection, rail_section, wheel_section};
use railspring_profiles::units::MILLIMETRE;
use railspring_testing::Random;

const CONTACT: ContactConditions =
    ContactConditions { friction: 0.4, enforcement: Enforcement::Exact, field: ContactField::Hybrid };
/// Size of contact elements, m.
const FINE: f64 = 4e-3;
/// N.
const LOADS: [f64; 3] = [20e3, 60e3, 120e3];

fn pair(track: &TrackGeometry, diameter: f64) -> Pair {
    Pair::new(rail_section("54E1").unwrap(), wheel_section("S1002", diameter).unwrap(), track).unwrap()
}

/// Its bodies on contact elements of a size, m.
fn condensed(pair: &Pair, material: Material, size: f64) -> CondensedPair {
    let sizes = MeshOptions {
        contact_element: size,
        contact_element_along: size,
        // four elements to either side, which hold a patch of 90 kN
        window_half_length: f64::max(12e-3, 4.0 * size),
        ..MeshOptions::default()
    };
    let bodies = PairBody::of_pair(false);
    pair.mesh(0.555, &sizes)
        .unwrap()
        .condense(pair, bodies, material, Formulation::IncompatibleModes, &Silent)
        .unwrap()
}

fn asked(track: TrackGeometry, loads: &[f64]) -> Asked<'_> {
    Asked { track, contact: CONTACT, reference: Reference::Beam, loads, preload: 60e3 }
}

/// What a pair answers with its bodies in a track.
fn answers(pair: &Pair, bodies: &CondensedPair, asked: Asked<'_>, departure: &Departure) -> Answers {
    UncertainPair::new(pair, bodies, asked).unwrap().answers(departure, true).unwrap()
}

/// Source: linear elasticity. Bodies of a modulus (1+e) times as large have under the load F the displacement that they had under F/(1+e), a tangent (1+e) times as stiff, and
/// (1+e) times the horizontal stiffness. Goal: so it is with both moduli. Accuracy: SOLVER, the tolerance of hub and contact.
#[test]
fn moduli_scale_the_law() {
    const SOLVER: f64 = 2e-4;
    const MORE: f64 = 0.02;
    let pair = pair(&TrackGeometry::standard(), 0.858);
    let bodies = condensed(&pair, Material::STEEL, FINE);
    let less: Vec<f64> = LOADS.iter().map(|load| load / (1.0 + MORE)).collect();
    let track = TrackGeometry::standard();
    let as_before = answers(&pair, &bodies, asked(track, &less), &Departure::default());
    let departure = Departure { rail_young: MORE, wheel_young: MORE, ..Departure::default() };
    let stiffer = answers(&pair, &bodies, asked(track, &LOADS), &departure);
    for load in 0..LOADS.len() {
        let displacement = stiffer.displacement[load] / as_before.displacement[load];
        let tangent = stiffer.tangent[load] / as_before.tangent[load];
        let area = stiffer.area[load] / as_before.area[load];
        println!("{displacement:.6} {tangent:.6} {area:.6}");
        assert!((displacement - 1.0).abs() < SOLVER && (tangent / (1.0 + MORE) - 1.0).abs() < SOLVER);
        assert!((area - 1.0).abs() < SOLVER, "{area}");
    }
    // under another preload the flexibility of the contact is another one by a third of 2 %, of a tenth of the whole
    let [before, after] = [&as_before, &stiffer].map(|answers| answers.horizontal.unwrap());
    assert!((after / before / (1.0 + MORE) - 1.0).abs() < 1e-3, "{before} {after}");
}

/// Source: other bodies, meshed and condensed for the changed input. Goal: displacement, tangent and horizontal stiffness change on the bodies of the nominal pair as they do
/// on their own. Accuracy: MODEL of the change and of what is left of it: ROUGH, relative, what two meshes of the same size differ by.
#[test]
fn departures_are_those_of_other_bodies() {
    const MODEL: f64 = 0.1;
    const ROUGH: f64 = 2e-3;
    let track = TrackGeometry::standard();
    let nominal = pair(&track, 0.858);
    let bodies = condensed(&nominal, Material::STEEL, FINE);
    let before = answers(&nominal, &bodies, asked(track, &LOADS), &Departure::default());
    let roll = 0.2_f64.to_radians();
    let inclined = TrackGeometry { inclination: (track.inclination.atan() - roll).tan(), ..track };
    let softer = Material { poisson: 0.28, ..Material::STEEL };
    let cases = [
        (
            "inclination",
            inclined,
            0.858,
            Material::STEEL,
            Departure { rail_roll: roll, ..Departure::default() },
        ),
        (
            "diameter",
            track,
            0.856,
            Material::STEEL,
            Departure { radius: -MILLIMETRE, ..Departure::default() },
        ),
        ("Poisson", track, 0.858, softer, Departure { poisson: -0.02, ..Departure::default() }),
    ];
    for (name, track_of, diameter, material, departure) in cases {
        let other = pair(&track_of, diameter);
        let expected = answers(
            &other,
            &condensed(&other, material, FINE),
            asked(track_of, &LOADS),
            &Departure::default(),
        );
        let found = answers(&nominal, &bodies, asked(track, &LOADS), &departure);
        let compare = |what: &str, before: f64, expected: f64, found: f64| {
            let [expected, found] = [expected, found].map(|value| value / before - 1.0);
            println!("{name}, {what}: {expected:+.5} on its own bodies, {found:+.5}");
            assert!(
                (found - expected).abs() < MODEL * expected.abs() + ROUGH,
                "{name} {what}: {expected} {found}"
            );
        };
        for load in 0..LOADS.len() {
            let at = |of: fn(&Answers) -> &Vec<f64>| [&before, &expected, &found].map(|a| of(a)[load]);
            for (what, [before, expected, found]) in [
                ("displacement", at(|a| &a.displacement)),
                ("tangent", at(|a| &a.tangent)),
                ("area", at(|a| &a.area)),
            ] {
                compare(&format!("{what} {load}"), before, expected, found);
            }
        }
        // a smaller wheel has a shorter disc, and Poisson's ratio stiffens a disc, which the nominal body does not know
        if name == "inclination" {
            let [before, expected, found] = [&before, &expected, &found].map(|a| a.horizontal.unwrap());
            compare("horizontal", before, expected, found);
        }
    }
}

/// Goal: surfaces too far off their bodies are refused with how far they are and what to do.
#[test]
fn far_departures_are_refused() {
    let nominal = pair(&TrackGeometry::standard(), 0.858);
    let departure = Departure { rail_roll: 1.0_f64.to_radians(), ..Departure::default() };
    let message = departure.pair(&nominal, &TrackGeometry::standard()).unwrap_err().to_string();
    assert!(message.contains("off their bodies") && message.contains("1.5 mm"), "{message}");
}

/// Source: rails and wheels whose crown and tread are arcs of random radii, hence a known truth, pressed on bodies of their own. Each is measured as
/// instruments do, its rail turned by a random angle and its wheel placed across the track with a random error. Goal: the truth of displacement (m) and tangent (N/m) lies within the band of 95 % of what is found
/// for the measured pair in 90 to 98 of 100 cases. Accuracy: 800 values of 40 pairs that are measured five times; the numerics of both are the same.
#[test]
#[ignore = "some minutes: cargo long the_truth_lies_in_the_band"]
fn the_truth_lies_in_the_band() {
    const PAIRS: u64 = 40;
    const MEASUREMENTS: usize = 5;
    const ROLL: f64 = 0.05;
    const PLACE: f64 = 0.2 * MILLIMETRE;
    const LOADS: [f64; 2] = [30e3, 90e3];
    let track = TrackGeometry::standard();
    let of_roll = ROLL.to_radians();
    let inputs = [Input { distribution: Distribution::Normal, sampled: true }; 2];
    let (mut inside, mut all) = (0, 0);
    for seed in 0..PAIRS {
        let mut random = Random::new(seed);
        let truth = arcs(&mut random, &track);
        let bodies = condensed(&truth, Material::STEEL, 6e-3);
        let asked = asked(track, &LOADS);
        let values = |answers: Answers| [answers.displacement, answers.tangent].concat();
        let quick =
            |pair: &UncertainPair<'_>, departure: &Departure| pair.answers(departure, false).map(values);
        let of_truth = UncertainPair::new(&truth, &bodies, asked).unwrap();
        let known = quick(&of_truth, &Departure::default()).unwrap();
        for _ in 0..MEASUREMENTS {
            let error = Departure {
                rail_roll: of_roll * random.normal(),
                lateral: PLACE * random.normal(),
                ..Departure::default()
            };
            let measured = error.pair(&truth, &track).unwrap();
            let uncertain = UncertainPair::new(&measured, &bodies, asked).unwrap();
            let evaluate = |z: &[f64], _: bool| {
                let departure =
                    Departure { rail_roll: of_roll * z[0], lateral: PLACE * z[1], ..Departure::default() };
                quick(&uncertain, &departure)
            };
            let found = quick(&uncertain, &Departure::default()).unwrap();
            let propagated = propagate(&inputs, 48, evaluate, ("", &Silent)).unwrap();
            for (answer, (known, found)) in known.iter().zip(&found).enumerate() {
                let [low, high] = propagated.band(answer, &[]).percentiles.unwrap();
                all += 1;
                inside += usize::from((1.0 + low..=1.0 + high).contains(&(known / found)));
            }
        }
    }
    let share = inside as f64 / f64::from(all);
    println!("{inside} of {all}: {share:.3}");
    assert!((0.90..=0.98).contains(&share), "{share}");
}

/// A pair whose rail has a crown and whose wheel has a tread of random radii.
fn arcs(random: &mut Random, track: &TrackGeometry) -> Pair {
    let (crown, tread) = (random.between(0.15, 0.4), random.between(0.5, 1.5));
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("EN13715-1in40", 0.858).unwrap());
    // another curvature in the middle, which falls to both ends so that neither slope nor curvature jumps much
    let bent = |curve: &ProfileCurve, [from, to]: [f64; 2], curvature: f64| {
        let points: Vec<_> = curve
            .sample(0.5 * MILLIMETRE)
            .into_iter()
            .map(|p| {
                let inside = ((p.x - from) * (to - p.x)).max(0.0);
                let half = 0.5 * (to - from);
                let z = 0.25 * curvature * (inside / half).powi(2);
                Point2::new(p.x, p.y - z)
            })
            .collect();
        ProfileCurve::from_points(&points, &[]).unwrap()
    };
    let rail = RailSection { running: bent(&rail.running, [-0.025, 0.025], 1.0 / crown - 1.0 / 0.3), ..rail };
    let wheel = WheelSection { running: bent(&wheel.running, [-0.02, 0.03], 1.0 / tread), ..wheel };
    Pair::new(rail, wheel, track).unwrap()
}
