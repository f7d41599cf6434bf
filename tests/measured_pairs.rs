//! Measured pairs of wheels and rails that the tool does not know, through the program at the first command.
//!
//! Source: surfaces drawn from the public dimensions of freight, passenger, metro and tram practice (`railspring_testing::measured`), worn, scattered, cut off,
//! canted and written in seven dialects; none of them is a standard of the tool. Goal: every pair has a law or is refused for one of the reasons that leave no
//! reading, and the law of the approach (`local`) is that of the true surfaces within its band.

use nalgebra::Point2;
use railspring_calibrate::calibration::{ContactField, Enforcement};
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::pair::{ContactConditions, Pair, PairBody};
use railspring_calibrate::solid::{Formulation, Material};
use railspring_profiles::error::Result;
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::profile::rail_catalogue::{RailDimensions, rail_of_dimensions};
use railspring_profiles::section::{
    WheelBody, rail_section_for_head, rail_section_of, wheel_section, wheel_section_for_profile,
};
use railspring_testing::Place;
use railspring_testing::measured::{MeasuredPair, measured_pair};
use railspring_testing::shapes::Point;

/// What refuses a pair that has no reading, or two.
const REFUSALS: [&str; 3] =
    ["the file is that of the other body", "rail.profile_mirrored", "misses the rail"];
/// Loads, kN.
const LOADS: [f64; 4] = [20.0, 40.0, 70.0, 100.0];

/// What the meshes of the two computations differ by, relative: both have elements of the same size, in other places (docs/verdict.md: statics of 1 %).
const MESHES: f64 = 0.01;

/// A place with the two files of a pair, and a study of them whose law is that of the approach, with its `bands` or without.
fn place(pair: &MeasuredPair, bands: bool) -> Place {
    let place = Place::new(env!("CARGO_BIN_EXE_railspring"), "store");
    for (name, text, _) in [&pair.wheel, &pair.rail] {
        place.write(name, text);
    }
    let study = format!(
        "name = \"m\"\n[rail]\nprofile_file = \"{}\"\n[wheel]\nprofile_file = \"{}\"\ntape_diameter_m = {}\n[calibration]\nloads_kn = {LOADS:?}\nhorizontal_preloads_kn = [60, 80]\nshifts_mm = []\nerror_band = {bands}\nreference = \"local\"\n",
        pair.rail.0,
        pair.wheel.0,
        pair.classes.0.diameter / 1000.0,
    );
    place.write("m.toml", &study);
    place
}

fn curve(points: &[Point]) -> ProfileCurve {
    let every: Vec<Point2<f64>> =
        points.iter().step_by(8).map(|p| Point2::new(1e-3 * p[0], 1e-3 * p[1])).collect();
    ProfileCurve::from_points(&every, &[]).unwrap()
}

/// Displacement of the approach (m) under the loads, of the true surfaces on bodies of their own class.
///
/// # Errors
/// Surfaces that cannot be joined to the bodies, and loads that they do not carry.
fn truth(pair: &MeasuredPair) -> Result<Vec<(f64, f64)>> {
    let (wheel, rail) = pair.classes;
    let [height, foot, web] = rail.body.map(|mm| 1e-3 * mm);
    let body =
        RailDimensions { height, foot, head: 1e-3 * rail.head, web, head_depth: None, foot_depth: None };
    let base = rail_section_of(rail.name, rail_of_dimensions(&body)?);
    let head = curve(&pair.rail.2).transformed(0.0, -nalgebra::Vector2::new(0.0, top(&pair.rail.2)));
    let section = rail_section_for_head(base, &head, &mut Vec::new())?;
    let like = wheel_section("S1002", 1e-3 * wheel.diameter)?;
    let wheel =
        wheel_section_for_profile(&like, &curve(&pair.wheel.2), &WheelBody::default(), &mut Vec::new())?;
    let cant = pair.measured[1].cant;
    let inclination = if cant > 0.0125 { cant } else { 1.0 / 40.0 };
    let track = TrackGeometry { inclination, ..TrackGeometry::standard() };
    let pair = Pair::new(section, wheel, &track)?;
    let mut options = MeshOptions::default();
    // small wheels touch at the field corner of some heads
    let touches = [
        (&mut options.rail_zone, &pair.rail.running, pair.touch.rail_s),
        (&mut options.wheel_zone, &pair.wheel.running, pair.touch.wheel_s),
    ];
    for (zone, running, s) in touches {
        let [touch, end] = [s, running.length()].map(|s| running.point(s).x);
        if touch > zone.field_y - 3e-3 {
            zone.field_y = (touch + 8e-3).min(end - 0.5e-3);
        }
    }
    let meshes = pair.mesh(0.555, &options)?;
    let material = Material { young: 210e9, poisson: 0.3, density: 7850.0, damping: 0.0 };
    let bodies = meshes.condense(
        &pair,
        PairBody::of_pair(false),
        material,
        Formulation::IncompatibleModes,
        &Silent,
    )?;
    let contact =
        ContactConditions { friction: 0.5, enforcement: Enforcement::Exact, field: ContactField::Hybrid };
    let loads = LOADS.map(|kn| 1e3 * kn);
    let pressed = bodies.press(&pair, contact, &loads, &Silent)?;
    let laws = pressed.laws()?;
    Ok(laws.local.points.iter().map(|p| (p.force, p.displacement)).collect())
}

fn top(points: &[Point]) -> f64 {
    1e-3 * points.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min)
}

/// Force (kN) and displacement (mm) of the rows of a load curve.
fn approach(table: &str) -> Vec<(f64, f64)> {
    let mut rows = table.lines();
    let heads: Vec<&str> = rows.next().unwrap_or_default().split(',').collect();
    let at = |name: &str| heads.iter().position(|head| *head == name).expect("a column of the load curve");
    let [force, displacement] = [at("force_kn"), at("displacement_mm")];
    rows.map(|row| {
        let fields: Vec<f64> = row.split(',').map(|field| field.parse().unwrap_or(f64::NAN)).collect();
        (fields[force], fields[displacement])
    })
    .collect()
}

/// How far the truth may be from the law: the band of its error, and what others in the place of the assumed bodies and places change.
fn band(stiffness: &serde_json::Value) -> [f64; 2] {
    let local = |of: &serde_json::Value| {
        let all = of["references"].as_array()?;
        all.iter().find(|reference| reference["reference"] == "local").cloned()
    };
    let half =
        local(&stiffness["error_band"]).and_then(|local| local["displacement"].as_f64()).unwrap_or(0.0);
    let assumed = local(&stiffness["assumed"]);
    let end =
        |at: usize| assumed.as_ref().and_then(|local| local["displacement"][at].as_f64()).unwrap_or(0.0);
    [end(0) - half, end(1) + half]
}

/// How a pair came out.
struct Outcome {
    name: String,
    /// The least and the greatest change from the law to the truth over the loads; none where one of the two has no law.
    off: Option<[f64; 2]>,
    /// What they may be.
    band: [f64; 2],
}

impl Outcome {
    fn is_inside(&self) -> bool {
        self.off.is_none_or(|[low, high]| low >= self.band[0] - MESHES && high <= self.band[1] + MESHES)
    }
}

/// How a pair comes out, or what is said where it should have a law and has none.
fn outcome(seed: u64, bands: bool) -> std::result::Result<Outcome, String> {
    let pair = measured_pair(seed);
    let place = place(&pair, bands);
    let output = place.run(&["calibrate", "m.toml", "-o", "o", "-q"]);
    let said = railspring_testing::message(&output);
    if !place.path("o/load_curve.csv").exists() {
        return match REFUSALS.iter().any(|part| said.contains(part)) {
            true => Ok(Outcome { name: format!("{}: refused", pair.name), off: None, band: [0.0; 2] }),
            false => Err(format!("{}: {said}", pair.name)),
        };
    }
    let stiffness = serde_json::from_str(&place.read("o/stiffness.json")).unwrap();
    let truth = truth(&pair).map_err(|error| println!("{}: no truth: {error}", pair.name)).ok();
    let changes = truth.map(|truth| {
        let off = approach(&place.read("o/load_curve.csv")).into_iter().filter_map(|(force, mm)| {
            let (_, metres) = truth.iter().find(|(own, _)| (own / (1e3 * force) - 1.0).abs() < 1e-6)?;
            Some(metres / (1e-3 * mm) - 1.0)
        });
        off.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], change| {
            [low.min(change), high.max(change)]
        })
    });
    let found = Outcome { name: pair.name, off: changes, band: band(&stiffness) };
    println!("{} {:.4?} in {:.4?} {}", found.is_inside(), found.off, found.band, found.name);
    Ok(found)
}

/// Some pairs of the corpus come to a law at the first command, or are refused for a reason that leaves no reading.
#[test]
#[ignore = "a minute: cargo long measured_pairs"]
fn measured_pairs_have_a_law() {
    for seed in [9, 11, 12] {
        outcome(seed, false).unwrap();
    }
}

/// Goal: where contact elements are coarse beside patch and curvature, here those of 12 mm under a worn gauge corner of 13 mm, the error band says that
/// their bodies move against the load, and the law stands. Seen before: the iteration on them had no end within minutes.
#[test]
#[ignore = "a minute: cargo long measured_pairs"]
fn bodies_too_coarse_for_a_band_are_said() {
    let pair = measured_pair(1);
    let place = place(&pair, true);
    let text = place.read("m.toml").replace("[wheel]", "standard = \"60E1\"\n[wheel]");
    place.write("m.toml", &(text + "[mesh]\ncontact_element_mm = 6\n"));
    let output = place.run(&["calibrate", "m.toml", "-o", "o"]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success() && said.contains("move against the load"), "{said}");
    assert!(approach(&place.read("o/load_curve.csv")).len() >= LOADS.len());
}

/// The pairs to be done: those of `RAILSPRING_PAIRS`, numbers with commas, or else all forty.
fn seeds() -> Vec<u64> {
    match std::env::var("RAILSPRING_PAIRS") {
        Ok(pairs) => pairs.split(',').map(|seed| seed.trim().parse().expect("numbers of pairs")).collect(),
        Err(_) => (0..40).collect(),
    }
}

/// Goal: each of the forty pairs has a law or is refused for a reason that leaves no reading, and the law of the true surfaces is within its band.
/// `RAILSPRING_PAIRS=0,5` does some of them.
#[test]
#[ignore = "forty minutes: cargo long measured_pairs"]
fn forty_measured_pairs() {
    let seeds = seeds();
    let outcomes: Vec<_> = seeds.iter().map(|&seed| outcome(seed, true)).collect();
    let without: Vec<&String> = outcomes.iter().filter_map(|o| o.as_ref().err()).collect();
    assert!(without.is_empty(), "{without:#?}");
    let compared: Vec<&Outcome> = outcomes.iter().flatten().filter(|o| o.off.is_some()).collect();
    let outside: Vec<&str> = compared.iter().filter(|o| !o.is_inside()).map(|o| o.name.as_str()).collect();
    println!("{} of {} compared, {} outside their band", compared.len(), seeds.len(), outside.len());
    assert!(outside.is_empty(), "{outside:#?}");
    // some are refused as left or right
    let with_law = outcomes.iter().flatten().filter(|o| !o.name.ends_with("refused")).count();
    assert!(compared.len() == with_law && 4 * with_law > 3 * seeds.len(), "{with_law} of {}", seeds.len());
}
