//! Parameters of rigid contact against closed solutions: a wheel and a rail of one arc each, and a cone on a crown.

use nalgebra::{Point2, Vector2};
use railspring_profiles::placement::{PlacedRail, TrackGeometry, place_rail};
use railspring_profiles::profile::wheels::wheel_profile;
use railspring_profiles::profile::{ProfileCurve, Segment};
use railspring_profiles::rigid_contact::{
    ContactFunctions, Parameters, ProfileUncertainty, Roll, WheelOnRail, Wheelset,
};
use railspring_profiles::section::rail_section;

/// Half the distance of the tape circles, m.
const TAPE: f64 = 0.75;
/// Rolling radius at the tape circle, m.
const RADIUS: f64 = 0.46;

/// An arc about a point below it, `half` (m) to either side.
fn crown(centre: Point2<f64>, radius: f64, half: f64) -> ProfileCurve {
    let end = |x: f64| centre + Vector2::new(x, -(radius * radius - x * x).sqrt());
    ProfileCurve::from_segments(&[Segment::arc(centre, end(-half), end(half))], 1e-3)
}

fn placed(curve: ProfileCurve) -> PlacedRail {
    PlacedRail { curve, angle: 0.0, origin: Point2::new(TAPE, 0.0) }
}

/// A hollow wheel of the radius `hollow` whose arc's centre is `beside` the rail's, which has a crown of 300 mm.
fn arcs(hollow: f64, beside: f64) -> Wheelset {
    let rail = placed(crown(Point2::new(TAPE, 0.3), 0.3, 0.03));
    let centre = Point2::new(beside, (hollow * hollow - beside * beside).sqrt());
    let wheel = crown(centre, hollow, 0.06);
    Wheelset::symmetric(WheelOnRail { rail, wheel, radius: RADIUS }, TAPE)
}

/// A wheel that is a cone of this slope, on the same crown.
fn cone(slope: f64) -> Wheelset {
    let rail = placed(crown(Point2::new(TAPE, 0.3), 0.3, 0.03));
    let line = Segment::line(Point2::new(-0.07, 0.07 * slope), Point2::new(0.065, -0.065 * slope));
    let wheel = ProfileCurve::from_segments(&[line], 1e-3);
    Wheelset::symmetric(WheelOnRail { rail, wheel, radius: RADIUS }, TAPE)
}

/// Source: two arcs touch on the line through their centres. With Δ = R_w − R_r apart and x aside, sin γ = x/Δ, and the
/// wheel rolls on r₀ + R_w (cos γ₀ − cos γ). Goal: Δ tan γ, rolling-radius difference, curve radius, without roll. Accuracy
/// (DISCRETISATION of the arcs' splines): 1e-7 and 1e-10 m; of the radius 1e-6.
#[test]
fn functions_of_two_arcs() {
    const DISCRETISATION: [f64; 3] = [1e-7, 1e-10, 1e-6];
    let (hollow, beside) = (0.5, 0.008);
    let wheelset = arcs(hollow, beside);
    let functions = ContactFunctions::of(&wheelset, [-5e-3, 5e-3], 0.1e-3, Roll::Fixed(0.0)).unwrap();
    let apart = hollow - 0.3;
    let sine = |x: f64| (x + beside) / apart;
    let cosine = |x: f64| (1.0 - sine(x).powi(2)).sqrt();
    let difference = |y: f64| hollow * (cosine(-y) - cosine(y));
    for (p, q) in functions.points().iter().zip(functions.running().points()) {
        let y = p.shift;
        let tangents = sine(y) / cosine(y) - sine(-y) / cosine(-y);
        assert!((p.tangent_difference - tangents).abs() < DISCRETISATION[0], "{y}: {p:?} {tangents}");
        assert!((q.difference - difference(y)).abs() < DISCRETISATION[1], "{y}: {q:?} {}", difference(y));
        assert_eq!(p.roll, 0.0);
    }
    // the less of both directions; beyond the shifts there is none
    let radius = functions.curve_radius([4e-3, 3e-3]).unwrap();
    let expected = 2.0 * TAPE * RADIUS / difference(3e-3);
    assert!((radius / expected - 1.0).abs() < DISCRETISATION[2], "{radius} {expected}");
    let coefficient = functions.rolling_radii_coefficient([4e-3, 3e-3], 600.0).unwrap();
    assert!((coefficient - 600.0 / radius).abs() < 1e-12);
    assert_eq!(functions.curve_radius([6e-3, 3e-3]), None);
    assert_eq!(functions.curve_radius([-1e-3, 3e-3]), None);
}

/// Source: the linear wheelset on arcs (A.H. Wickens; K. Knothe, S. Stichel). The contact angle in the middle is γ₀ and the
/// contacts are 2 b apart. The roll is γ₀ y/(b − r₀ γ₀), the arcs' centres move by (b + R_w γ₀) y/(b − r₀ γ₀) against each other. The conicity is
/// R_w γ₀ (b + R_r γ₀)/((R_w − R_r)(b − r₀ γ₀)). Goal: all three parameters at 1 mm, with roll; without it the centres move by y. Accuracy (MODEL): squares
/// of the angle, 0.03² at the turning points, of which three come together.
#[test]
fn parameters_of_the_linear_wheelset() {
    const MODEL: f64 = 3.0 * 0.03 * 0.03;
    let (r, hollow, crown, angle) = (RADIUS, 0.5, 0.3, 0.025);
    let apart = hollow - crown;
    let wheelset = arcs(hollow, angle * apart);
    let near = |found: Option<f64>, expected: f64| {
        let found = found.unwrap();
        assert!((found / expected - 1.0).abs() < MODEL, "{found} {expected}");
    };
    let range = [-4e-3, 4e-3];
    let level = ContactFunctions::of(&wheelset, range, 0.1e-3, Roll::Fixed(0.0)).unwrap();
    let found = level.parameters(&[1e-3, 5e-3], None);
    near(found.contact_angle[0], TAPE / apart);
    near(found.conicity[0], hollow * angle / apart);
    assert_eq!((found.roll[0], found.curve_radius), (Some(0.0), None));
    // the wave does not fit into the shifts
    assert_eq!([found.contact_angle[1], found.conicity[1], found.roll[1]], [None; 3]);
    assert_eq!(Parameters::from_values(2, &found.values()), found);
    let coupled = ContactFunctions::of(&wheelset, range, 0.1e-3, Roll::Coupled).unwrap();
    let b = TAPE - crown * angle;
    let lever = b - r * angle;
    near(coupled.roll_parameter(1e-3), TAPE * angle / lever);
    near(coupled.contact_angle_parameter(1e-3), TAPE * (b + hollow * angle) / (apart * lever));
    let conicity = hollow * angle * (b + crown * angle) / (apart * lever);
    near(coupled.running().equivalent_conicity(1e-3), conicity);
}

/// Source: EN 13715. S1002 is 32.5 mm thick 10 mm below the tape circle, on the arc of 13 mm about (−26.210665, 16.446) mm. Goal: the
/// flange clearance on 1435 mm, flange backs 1360 mm apart. Accuracy (DISCRETISATION of the arc's spline): 1e-9 m.
#[test]
fn flange_clearance_of_s1002() {
    const DISCRETISATION: f64 = 1e-9;
    let track = TrackGeometry::standard();
    let wheel = wheel_profile("S1002").unwrap();
    let tape_y = track.tape_y(&wheel);
    let rail = place_rail(&rail_section("60E1").unwrap(), &track).unwrap();
    let mut wheelset = Wheelset::symmetric(WheelOnRail { rail, wheel, radius: RADIUS }, tape_y);
    let face = -26.210665e-3 - (13e-3f64.powi(2) - 6.446e-3f64.powi(2)).sqrt();
    let [left, right] = wheelset.flange_clearance().unwrap();
    assert_eq!(left, right);
    assert!((right - (0.7175 - 0.75 - face)).abs() < DISCRETISATION, "{right}");
    assert!((right - 5e-3).abs() < 1e-6, "{right}");
    // a crown alone has no gauge face
    wheelset.left.rail = placed(crown(Point2::new(TAPE, 0.3), 0.3, 0.03));
    assert_eq!(wheelset.flange_clearance(), None);
}

/// Source: without a disturbance a profile is itself. Goal: the equivalent conicity of S1002 on 60E1, 1:40, from 0.5 to 6 mm. Accuracy
/// (DISCRETISATION): the points of disturbed profiles are further apart; below 1e-5.
#[test]
fn no_uncertainty_changes_nothing() {
    const DISCRETISATION: f64 = 1e-5;
    let track = TrackGeometry::standard();
    let wheel = wheel_profile("S1002").unwrap();
    let tape_y = track.tape_y(&wheel);
    let rail = place_rail(&rail_section("60E1").unwrap(), &track).unwrap();
    let wheelset = Wheelset::symmetric(WheelOnRail { rail, wheel, radius: RADIUS }, tape_y);
    let none = ProfileUncertainty { form: 0.0, correlation: 0.01, roll: 0.0 };
    let of = |wheelset: &Wheelset| {
        let functions = ContactFunctions::of(wheelset, [-6.5e-3, 6.5e-3], 0.1e-3, Roll::Fixed(0.0)).unwrap();
        [0.5e-3, 3e-3, 6e-3].map(|a| functions.running().equivalent_conicity(a).unwrap())
    };
    let (found, expected) = (of(&none.disturbed(&wheelset, 0)), of(&wheelset));
    let off = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < DISCRETISATION, "{found:?} {expected:?}");
}

/// Source: first order by hand on a cone. A roll δ of the wheel's profile makes its slope δ larger, on both sides where they are one pair, on each by itself
/// where they are two. A form error of a long correlation length ℓ makes it e′ larger, whose standard deviation is u/ℓ. A crown under a cone may turn and
/// bend without effect. Goal: standard uncertainty of the equivalent conicity at 3 mm, without roll of the axle. Accuracy (MODEL): four standard deviations
/// of what 200 samples tell of it, 4/√400.
#[test]
fn uncertainty_of_a_cone() {
    const SAMPLES: usize = 200;
    const MODEL: f64 = 0.2;
    let wheelset = cone(0.05);
    let of = |wheelset: &Wheelset| {
        let functions = ContactFunctions::of(wheelset, [-6e-3, 6e-3], 1.5e-3, Roll::Fixed(0.0))?;
        Ok(vec![functions.running().equivalent_conicity(3e-3), functions.running().equivalent_conicity(7e-3)])
    };
    let roll = ProfileUncertainty { form: 0.0, correlation: 0.01, roll: 1e-3 };
    let form = ProfileUncertainty { form: 15e-6, correlation: 0.1, roll: 0.0 };
    let mut two = wheelset.clone();
    two.left.radius += 1e-9;
    for (uncertainty, wheelset, expected) in [
        (roll, &wheelset, 1e-3 * (1.0 + 0.05 * 0.05)),
        (roll, &two, 1e-3 / 2f64.sqrt()),
        (form, &wheelset, 15e-6 / 0.1),
        (form, &two, 15e-6 / 0.1 / 2f64.sqrt()),
    ] {
        let found = uncertainty.propagate(wheelset, SAMPLES, of).unwrap();
        let three = found[0].unwrap();
        println!("{uncertainty:?}: {three:?}, expected {expected}");
        assert!((three.standard / expected - 1.0).abs() < MODEL, "{three:?} {expected}");
        assert!((three.mean - 0.05).abs() < 4.0 * expected / (SAMPLES as f64).sqrt(), "{three:?}");
        // what is missing on the wheelsets has no spread
        assert_eq!(found[1], None);
    }
    // the same samples every time
    let again = || roll.propagate(&wheelset, 5, of).unwrap();
    assert_eq!(again(), again());
}
