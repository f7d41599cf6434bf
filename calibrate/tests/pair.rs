//! Condensed bodies outlive their meshes and travel as files.

use railspring_calibrate::calibration::{ContactField, Enforcement, Reference};
use railspring_calibrate::mesh::{MeshOptions, mesh_wheel};
use railspring_calibrate::pair::{CondensedPair, ContactConditions, Pair, PairBody};
use railspring_calibrate::solid::{Formulation, Material, Materials, Supports};
use railspring_calibrate::superelement::{CondensedBody, body_key};
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};
use std::path::Path;

fn coarse() -> MeshOptions {
    MeshOptions { contact_element: 6e-3, contact_element_along: 6e-3, ..MeshOptions::default() }
}

fn pair() -> Pair {
    Pair::new(
        rail_section("60E1").unwrap(),
        wheel_section("S1002", 0.858).unwrap(),
        &TrackGeometry::standard(),
    )
    .unwrap()
}

fn condensed(pair: &Pair) -> CondensedPair {
    let meshes = pair.mesh(0.3, &coarse()).unwrap();
    meshes
        .condense_in_time(pair, &PairBody::ALL, Material::STEEL, Formulation::FullIntegration, 6, &Silent)
        .unwrap()
}

/// Source: the bodies that were not written. Goal: bodies that were written and read are the same to the bit, and so are the
/// tangents (N/m) of the wheel pressed with them.
#[test]
fn a_body_is_the_same_after_its_file() {
    let pair = pair();
    let mut bodies = condensed(&pair);
    let contact =
        ContactConditions { friction: 0.3, enforcement: Enforcement::Exact, field: ContactField::Elements };
    let tangents = |bodies: &CondensedPair| -> Vec<f64> {
        let pressed = bodies.press(&pair, contact, &[20e3, 40e3, 60e3, 80e3], &Silent).unwrap();
        pressed.fit(Reference::Beam).unwrap().points.iter().map(|p| p.solid_tangent).collect()
    };
    let before = tangents(&bodies);
    let on_foot = bodies.rail_on_foot.as_mut().unwrap();
    let modes = [&bodies.wheel, on_foot, &bodies.rail_on_ends].map(|body| body.modes.is_some());
    assert_eq!(modes, [true, false, true], "those that move have modes");
    for body in [&mut bodies.wheel, on_foot, &mut bodies.rail_on_ends] {
        let file = body.write();
        assert_eq!(file, body.write(), "the same body gives the same bytes");
        let read = CondensedBody::read(&file).unwrap();
        assert_eq!(read, *body);
        *body = read;
    }
    assert_eq!(tangents(&bodies), before);
}

/// Goal: on the fine grid all three laws of a pair come from contact elements of 6 mm. The parts of the
/// compliance that the wheel and the contact have (m/N) do not depend on what holds the rail. The rail's part
/// is smaller against its section than against its foot. Accuracy: ROUNDOFF for the same state. MODEL: the
/// patch follows the roll of a rail that is held elsewhere, 2 %. MODEL_OF_FRICTION: a rail that yields
/// sideways takes lateral force off a wheel that is held sideways, 10 % of the wheel's part.
#[test]
fn the_fine_grid_serves_all_references() {
    const MODEL: f64 = 0.02;
    const MODEL_OF_FRICTION: f64 = 0.1;
    const ROUNDOFF: f64 = 1e-12;
    let pair = pair();
    let bodies = condensed(&pair);
    let contact =
        ContactConditions { friction: 0.3, enforcement: Enforcement::Exact, field: ContactField::Hybrid };
    let pressed = bodies.press(&pair, contact, &[20e3, 40e3, 60e3, 80e3], &Silent).unwrap();
    let [beam, foot, local] = [Reference::Beam, Reference::Foot, Reference::Local]
        .map(|reference| pressed.fit(reference).unwrap().points);
    for ((beam, foot), local) in beam.iter().zip(&foot).zip(&local) {
        for (a, b, limit) in [
            (beam.local_compliance, foot.local_compliance, MODEL),
            (beam.wheel_compliance, foot.wheel_compliance, MODEL_OF_FRICTION),
            (1.0 / local.solid_tangent, beam.local_compliance, ROUNDOFF),
        ] {
            assert!((a / b - 1.0).abs() < limit, "{} N: {a} {b}", foot.force);
        }
        assert!(beam.rail_compliance > 0.0 && beam.rail_compliance < foot.rail_compliance);
        assert!(local.displacement < beam.displacement && beam.displacement < foot.displacement);
    }
    let horizontal = pressed.horizontal(Reference::Beam, &[40e3], &Silent).unwrap();
    assert!(horizontal.stiffness > 1e7 && horizontal.stiffness < 1e9, "{}", horizontal.stiffness);
}

/// Goal: a file that was cut, extended or changed, or is of another kind, is refused in words; none gives a body.
#[test]
fn files_that_are_no_bodies_are_refused() {
    let body = condensed(&pair()).wheel;
    let file = body.write();
    let header = 8 + u64::from_le_bytes(file[..8].try_into().unwrap()) as usize;
    let mut endless = body.clone();
    std::sync::Arc::make_mut(&mut endless.compliance)[(0, 0)] = f64::INFINITY;
    let endless = endless.write();
    let mut of_no_mass = body.clone();
    of_no_mass.mass = f64::NAN;
    let of_no_mass = of_no_mass.write();
    let other = String::from_utf8_lossy(&file[8..header]).replace("body 5", "body 9").into_bytes();
    let other = [&file[..8], &other, &file[header..]].concat();
    let cases: [(&[u8], &str); 6] = [
        (&[], "condensed body"),
        (&file[..file.len() - 8], "condensed body"),
        (&[&file[..], &[0; 8]].concat(), "condensed body"),
        (&endless, "inf"),
        (&of_no_mass, "mass_kg = NaN"),
        (&other, "body 9"),
    ];
    for (bytes, part) in cases {
        let said = CondensedBody::read(bytes).map(|_| ()).unwrap_err().to_string();
        assert!(said.contains(part) && said.contains("condense the body again"), "{said}");
    }
}

/// Goal: the key changes with mesh, material, element and supports, and with nothing else: the lateral shift of the wheel
/// leaves both bodies alone.
#[test]
fn a_body_knows_what_made_it() {
    let wheel = wheel_section("S1002", 0.858).unwrap();
    let mesh = mesh_wheel(&wheel, &coarse()).unwrap();
    let supports = Supports { followers: mesh.bore.clone(), ..Supports::default() };
    let (steel, full) = (Materials::from(Material::STEEL), Formulation::FullIntegration);
    let key = body_key(&mesh, &steel, full, &supports);
    assert_eq!(key.len(), 64);
    let mut moved = mesh.clone();
    moved.nodes[0].x += 1e-9;
    let softer = Materials::from(Material { young: 209e9, ..Material::STEEL });
    let others = [
        body_key(&moved, &steel, full, &supports),
        body_key(&mesh, &softer, full, &supports),
        body_key(&mesh, &steel, Formulation::IncompatibleModes, &supports),
        body_key(&mesh, &steel, full, &Supports::default()),
    ];
    assert!(others.iter().all(|other| *other != key), "{others:?}");

    let shifted = TrackGeometry { lateral_shift: 3e-3, ..TrackGeometry::standard() };
    let there = Pair::new(rail_section("60E1").unwrap(), wheel, &shifted).unwrap();
    let (here, there) = (condensed(&pair()), condensed(&there));
    assert_eq!(here.wheel.key, key);
    assert_eq!(here.wheel.key, there.wheel.key);
    let on_foot = [&here, &there].map(|bodies| &bodies.rail_on_foot.as_ref().unwrap().key);
    assert_eq!(on_foot[0], on_foot[1]);
    assert_ne!(on_foot[0], &here.rail_on_ends.key);
}

/// Goal: a body of another pair is refused by every way to press or move it. The error names its file, what
/// it is of, how far it is off and what this pair wants. Bodies are those of another wheel profile, another
/// diameter, another inclination, and another rail with the same head, whose shear centre lies elsewhere. A
/// lateral shift of the wheel changes no body: the same bodies pass then.
#[test]
fn bodies_of_another_pair_are_refused() {
    let track = TrackGeometry::standard();
    let of = |rail: &str, wheel: &str, diameter: f64, track: &TrackGeometry| {
        Pair::new(rail_section(rail).unwrap(), wheel_section(wheel, diameter).unwrap(), track).unwrap()
    };
    let own = pair();
    let mut bodies = condensed(&own);
    let place = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let path = place.join("wheel-s1002.safetensors");
    std::fs::write(&path, bodies.wheel.write()).unwrap();
    bodies.wheel = CondensedBody::open(&path).unwrap();
    assert_eq!(bodies.wheel.of, "wheel S1002 of 858.0 mm");
    let contact =
        ContactConditions { friction: 0.3, enforcement: Enforcement::Exact, field: ContactField::Elements };
    let pressed = |pair: &Pair| bodies.press(pair, contact, &[20e3, 40e3, 60e3, 80e3], &Silent).map(|_| ());
    let upright = TrackGeometry { inclination: 0.0, ..track };
    let cases = [
        (of("60E1", "EN13715-1in40", 0.858, &track), "wheel-s1002.safetensors (wheel S1002 of 858.0 mm)"),
        (of("60E1", "S1002", 0.86, &track), "mm off its running surface"),
        (of("60E1", "S1002", 0.858, &upright), "rail between its ends, 60E1 inclined by 1.43"),
        (of("54E1", "S1002", 0.858, &track), "54E1 inclined by 1.43"),
    ];
    for (pair, part) in &cases {
        let said = pressed(pair).unwrap_err().to_string();
        assert!(said.contains(part) && said.contains("a body of this pair"), "{said}");
    }
    let shifted = of("60E1", "S1002", 0.858, &TrackGeometry { lateral_shift: 2e-3, ..track });
    pressed(&shifted).unwrap();
    own.check_body(PairBody::RailOnFoot, bodies.rail_on_foot.as_ref().unwrap()).unwrap();
    let swapped = own.check_body(PairBody::Wheel, &bodies.rail_on_ends).unwrap_err().to_string();
    assert!(swapped.contains("rail between its ends") && swapped.starts_with("wheel"), "{swapped}");
    let mut other = bodies.rail_on_ends.clone();
    other.section.as_mut().unwrap().shear_centre.y += 2e-3;
    let said = own.check_body(PairBody::RailOnEnds, &other).unwrap_err().to_string();
    assert!(said.contains("its shear centre 2.00 mm off"), "{said}");
    let missing = CondensedBody::open(&place.join("none")).map(|_| ()).unwrap_err().to_string();
    assert!(missing.contains("none") && missing.contains("check the path"), "{missing}");
}
