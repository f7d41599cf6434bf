//! The examples of this package on coarse meshes, so that they run with every test.

use railspring_calibrate::prelude::*;
use std::path::Path;

#[expect(dead_code, reason = "what an example prints is not tested")]
#[path = "../examples/fit_pair.rs"]
mod fit_pair;
#[expect(dead_code, reason = "what an example prints is not tested")]
#[path = "../examples/law_by_angle.rs"]
mod law_by_angle;
#[expect(dead_code, reason = "what an example prints is not tested")]
#[path = "../examples/measured_pair.rs"]
mod measured_pair;

fn coarse() -> FitOptions {
    let FitOptions { mesh, .. } = FitOptions::default();
    let mesh = MeshOptions { contact_element: 6e-3, contact_element_along: 6e-3, ..mesh };
    FitOptions { mesh, ..FitOptions::default() }
}

/// Source: mesh, bodies, states and laws of the same pair, made step by step. Goal: one call makes the same
/// springs. Units N, m. Accuracy: to the bit.
#[test]
fn one_call_makes_the_springs_of_the_steps() {
    let options = coarse();
    let found = fit_pair::springs(&options).unwrap();
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.858).unwrap());
    let pair = Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap();
    let meshes = pair.mesh(0.555, &options.mesh).unwrap();
    let wanted = PairBody::of_pair(false);
    let bodies =
        meshes.condense(&pair, wanted, Material::STEEL, Formulation::IncompatibleModes, &Silent).unwrap();
    let contact =
        ContactConditions { friction: 0.5, enforcement: Enforcement::Exact, field: ContactField::Hybrid };
    let loads = [10e3, 25e3, 45e3, 65e3, 85e3, 120e3];
    let pressed = bodies.press(&pair, contact, &loads, &Silent).unwrap();
    assert!(found.ended.is_none() && pressed.ended().is_none());
    for reference in [Reference::Beam, Reference::Local] {
        assert_eq!(found.laws.get(reference).unwrap().points, pressed.fit(reference).unwrap().points);
    }
    assert!(found.laws.foot.is_none(), "the rail was not condensed on its foot");
    let horizontal = pressed.horizontal(Reference::Beam, &options.preloads, &Silent).unwrap();
    assert_eq!(found.horizontal.stiffness, horizontal.stiffness);
}

/// Goal: preloads that no load reaches are left out, and the largest load takes the place of the last of them.
/// Units N.
#[test]
fn preloads_stay_below_the_loads() {
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.858).unwrap());
    let pair = Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap();
    let preloads = |wanted: &[f64]| -> Vec<f64> {
        let options = FitOptions { preloads: wanted.to_vec(), ..coarse() };
        let found = pair.fit_with(&[5e3, 10e3, 20e3, 40e3], &options, &Silent).unwrap();
        found.horizontal.points.iter().map(|point| point.preload).collect()
    };
    assert_eq!(preloads(&[20e3, 50e3]), [20e3]);
    assert_eq!(preloads(&[50e3]), [40e3]);
}

/// Source: nominal S1002 on 60E1 at −3 and 0 mm touches on the tread, at 7 mm on the flange. Goal: every place
/// has a law, the angle grows towards the flange, and the approach of the surfaces alone is stiffer than the
/// hub against the rail's section. Units rad, N/m.
#[test]
fn every_place_has_a_law() {
    let places = law_by_angle::laws(&coarse()).unwrap();
    let angles: Vec<f64> = places.iter().map(|place| place.touch.unwrap().touch.contact_angle).collect();
    assert!(angles.is_sorted() && angles[1] < 0.1 && angles[2] > 0.5, "{angles:?}");
    for place in places {
        let laws = place.law.unwrap().laws;
        let [local, beam] = [&laws.local, &laws.beam].map(|of| of.fit.law.tangent(40e3));
        assert!(local > beam && beam > 0.0, "{local:e}, {beam:e}");
    }
}

/// Source: the same loads on nominal S1002 on 60E1. Goal: a measured pair of no standard is placed and fitted;
/// other profiles of steel of the same size change the tangent at 60 kN by less than half. Units N/m.
#[test]
fn a_measured_pair_is_fitted() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/profiles");
    let loads = [10e3, 25e3, 45e3, 65e3, 85e3];
    let measured = measured_pair::measured(&folder).unwrap();
    let found = measured.fit_with(&loads, &coarse(), &Silent).unwrap().laws.beam.fit.law.tangent(60e3);
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.92).unwrap());
    let nominal = Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap();
    let like = nominal.fit_with(&loads, &coarse(), &Silent).unwrap().laws.beam.fit.law.tangent(60e3);
    assert!((found / like - 1.0).abs() < 0.5, "{found:e}, nominal {like:e}");
}
