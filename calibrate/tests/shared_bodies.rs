//! Measured surfaces on condensed bodies of their nominal profiles, against bodies that are meshed and condensed for them.

use nalgebra::Point2;
use railspring_calibrate::calibration::{ContactField, Enforcement, LoadPoint};
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::pair::{
    AngleLaw, AngleSettings, CondensedPair, ContactConditions, OffBodies, Pair, PairBody, PressDirection,
    law_by_shift, wheel_between,
};
use railspring_calibrate::solid::{Formulation, Material};
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::section::{
    RailSection, WheelBody, WheelSection, rail_section, rail_section_with_head, wheel_section,
    wheel_section_on, wheel_section_with_profile,
};

const LOADS: [f64; 4] = [20e3, 40e3, 70e3, 110e3];

fn condensed(pair: &Pair) -> CondensedPair {
    let options = MeshOptions {
        contact_element: 4e-3,
        contact_element_along: 4e-3,
        window_half_length: 16e-3,
        ..MeshOptions::default()
    };
    let bodies = PairBody::of_pair(false);
    let meshes = pair.mesh(0.555, &options).unwrap();
    meshes.condense(pair, bodies, Material::STEEL, Formulation::IncompatibleModes, &Silent).unwrap()
}

fn law(pair: &Pair, bodies: &CondensedPair, shift: f64) -> AngleLaw {
    let contact =
        ContactConditions { friction: 0.4, enforcement: Enforcement::Exact, field: ContactField::Hybrid };
    let settings = AngleSettings {
        contact,
        direction: PressDirection::Vertical,
        loads: &LOADS,
        fixed_loads: &[70e3],
        stresses: false,
    };
    let found = law_by_shift(pair, bodies, &settings, &[pair.tape_y + shift], &Silent).unwrap();
    found.into_iter().next().unwrap().law.unwrap()
}

/// A hill of height 1 over an interval from -1 to 1, smooth at its ends.
fn hill(t: f64) -> f64 {
    if t.abs() < 1.0 { (1.0 - t * t).powi(2) } else { 0.0 }
}

/// The curve between two arc lengths (m) with every point moved.
fn worn(
    curve: &ProfileCurve,
    [from, to]: [f64; 2],
    wear: impl Fn(Point2<f64>) -> Point2<f64>,
) -> ProfileCurve {
    const STEP: f64 = 0.25e-3;
    let count = ((to - from) / STEP) as usize;
    let points: Vec<Point2<f64>> =
        (0..=count).map(|i| wear(curve.point(from + (to - from) * i as f64 / count as f64))).collect();
    ProfileCurve::from_points(&points, &[]).unwrap()
}

/// A wheel with a hollow tread of a depth, m.
fn hollow(wheel: &WheelSection, depth: f64) -> WheelSection {
    let curve = &wheel.running;
    let range = [-60e-3, 58e-3].map(|y| curve.s_at_y(y).unwrap());
    let tread = worn(curve, range, |p| Point2::new(p.x, p.y - depth * hill((p.x - 8e-3) / 40e-3)));
    wheel_section_with_profile(wheel.clone(), &tread, &mut Vec::new()).unwrap()
}

/// A rail whose top is lower by a depth, m.
fn flat(rail: &RailSection, depth: f64) -> RailSection {
    let curve = &rail.running;
    let range = [0.5e-3, curve.length() - 0.5e-3];
    let head = worn(curve, range, |p| Point2::new(p.x, p.y + depth * hill(p.x / 34e-3)));
    rail_section_with_head(rail.clone(), &head, &mut Vec::new()).unwrap()
}

/// The S1002 of 920 mm on a 60E1, turned down to a diameter, m: what is missing is missing from its rim.
fn turned(diameter: f64) -> Pair {
    const NEW: f64 = 0.92;
    let usual = WheelBody::default();
    let body = WheelBody { rim_depth: usual.rim_depth - 0.5 * (NEW - diameter), ..usual };
    let running = wheel_section("S1002", diameter).unwrap().running;
    let wheel = wheel_section_on(running, "S1002", diameter, &body).unwrap();
    Pair::new(rail_section("60E1").unwrap(), wheel, &TrackGeometry::standard()).unwrap()
}

fn nominal() -> Pair {
    let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", 0.858).unwrap());
    Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap()
}

/// Source: bodies that are meshed and condensed for the worn surfaces, which no hand has moved; the surfaces are those of no standard. Goal: displacement and
/// horizontal stiffness on the nominal bodies are theirs, and the tangent is, with the nominal surfaces to the last digits. Units m, N. Accuracy: OF_RAIL and OF_WHEEL for a millimetre off the
/// nodes, and GRID for meshes and grids, of displacement, tangent and horizontal stiffness (docs/design/shared-bodies.md).
#[test]
fn worn_surfaces_are_carried_by_nominal_bodies() {
    const OF_RAIL: [f64; 3] = [6.0, 8.0, 5.0];
    const OF_WHEEL: [f64; 3] = [1.5, 2.0, 2.0];
    const GRID: [f64; 3] = [1e-3, 13e-3, 3e-3];
    let (nominal, track) = (nominal(), TrackGeometry::standard());
    let bodies = condensed(&nominal);
    let (rail, wheel) = (&nominal.rail, &nominal.wheel);
    let (same, carried) = nominal.carry(&bodies, rail.clone(), wheel.clone(), &track).unwrap();
    let OffBodies { rail: of_rail, wheel: of_wheel } = same.off_bodies;
    assert!(of_rail.max(of_wheel) < 1e-9, "{of_rail} {of_wheel}");
    let displacements = |law: &AngleLaw| -> Vec<f64> {
        law.laws.beam.points.iter().map(|point| point.displacement).collect()
    };
    let (own, on_own) = (law(&nominal, &bodies, 0.0), law(&same, &carried, 0.0));
    for (a, b) in displacements(&own).iter().zip(displacements(&on_own)) {
        assert!((b / a - 1.0).abs() < 1e-9, "{a} {b}");
    }
    for (rail, wheel) in [(rail.clone(), hollow(wheel, 2e-3)), (flat(rail, 1.5e-3), wheel.clone())] {
        let (pair, carried) = nominal.carry(&bodies, rail.clone(), wheel.clone(), &track).unwrap();
        let own = Pair::new(rail, wheel, &track).unwrap();
        let own_bodies = condensed(&own);
        let OffBodies { rail: of_rail, wheel: of_wheel } = pair.off_bodies;
        assert!((1e-3..2.5e-3).contains(&of_rail.max(of_wheel)) && of_rail.min(of_wheel) < 1e-9);
        for shift in [-2e-3, 2e-3] {
            let (a, b) = (law(&own, &own_bodies, shift), law(&pair, &carried, shift));
            let allowed: [f64; 3] =
                std::array::from_fn(|n| GRID[n] + OF_RAIL[n] * of_rail + OF_WHEEL[n] * of_wheel);
            let change = |of: fn(&LoadPoint) -> f64| {
                let points = a.laws.beam.points.iter().zip(&b.laws.beam.points);
                points.map(|(a, b)| (of(b) / of(a) - 1.0).abs()).fold(0.0, f64::max)
            };
            let [a, b] = [&a, &b].map(|law| law.fixed[0].horizontal_stiffness);
            let found = [change(|p| p.displacement), change(|p| p.solid_tangent), (b / a - 1.0).abs()];
            assert!((0..3).all(|n| found[n] < allowed[n]), "{shift}: {found:?} of {allowed:?}");
            // the bodies are not those of the worn surfaces, so that something is left
            assert!(found[0] > 1e-6, "{found:?}");
        }
    }
}

/// Goal: surfaces that nominal bodies cannot stand for are refused, by how much: worn by 5 mm, on a rail that leans otherwise, and where the nodes of a body would pass
/// each other.
#[test]
fn what_bodies_do_not_carry_is_refused() {
    let (nominal, track) = (nominal(), TrackGeometry::standard());
    let bodies = condensed(&nominal);
    let carry = |rail: RailSection, wheel: WheelSection, track: &TrackGeometry| {
        nominal.carry(&bodies, rail, wheel, track).map(|_| ()).unwrap_err().to_string()
    };
    let (rail, wheel) = (&nominal.rail, &nominal.wheel);
    let far = carry(flat(rail, 5e-3), wheel.clone(), &track);
    assert!(far.contains("off the nodes") && far.contains("4 mm at most"), "{far}");
    let leaning = TrackGeometry { inclination: 1.0 / 20.0, ..track };
    let leans = carry(rail.clone(), wheel.clone(), &leaning);
    assert!(leans.contains("leans by 2.862°") && leans.contains("1.432°"), "{leans}");
}

/// Source: the wheel of a diameter itself, meshed and condensed. Goal: displacement, tangent and horizontal stiffness (m, N) on a wheel that stands between two others, 20 mm apart
/// and turned, with a hollow tread or without. Accuracy: BETWEEN, which docs/design/shared-bodies.md states; the smaller of the two is farther off in all of them. A diameter that is not between
/// them is refused, and so are wheels with other contact nodes.
#[test]
fn a_turned_wheel_stands_between_two_others() {
    const BETWEEN: [f64; 3] = [1.5e-3, 2e-3, 5e-3];
    let track = TrackGeometry::standard();
    let [smaller, own, larger] = [0.90, 0.91, 0.92].map(turned);
    let [of_smaller, on_own, of_larger] = [&smaller, &own, &larger].map(condensed);
    let pairs = [(&smaller, &of_smaller), (&larger, &of_larger)];
    let (pair, bodies) = wheel_between(pairs, 0.455).unwrap();
    let (rail, wheel) = (&own.rail, &own.wheel);
    for wheel in [wheel.clone(), hollow(wheel, 1e-3)] {
        let on = |(pair, bodies): (&Pair, &CondensedPair)| {
            let (pair, bodies) = pair.carry(bodies, rail.clone(), wheel.clone(), &track).unwrap();
            law(&pair, &bodies, 0.0)
        };
        let exact = on((&own, &on_own));
        let changes = |other: &AngleLaw| {
            let points = exact.laws.beam.points.iter().zip(&other.laws.beam.points);
            let change = |of: fn(&LoadPoint) -> f64| {
                points.clone().map(|(a, b)| (of(b) / of(a) - 1.0).abs()).fold(0.0, f64::max)
            };
            let [a, b] = [&exact, other].map(|law| law.fixed[0].horizontal_stiffness);
            [change(|p| p.displacement), change(|p| p.solid_tangent), (b / a - 1.0).abs()]
        };
        let (found, of_one) = (changes(&on((&pair, &bodies))), changes(&on((&smaller, &of_smaller))));
        for (i, between) in BETWEEN.into_iter().enumerate() {
            assert!(found[i] < between && found[i] < of_one[i], "{i}: {found:?} {of_one:?}");
        }
    }
    let beyond = wheel_between(pairs, 0.47).map(|_| ()).unwrap_err().to_string();
    assert!(beyond.contains("470.0 mm") && beyond.contains("from 450.0 to 460.0 mm"), "{beyond}");
}
