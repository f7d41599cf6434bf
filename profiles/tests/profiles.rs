//! Profile curves against closed solutions, and the standard profiles against their definitions.

use std::f64::consts::PI;

use nalgebra::{Point2, Rotation2, Vector2};
use railspring_profiles::error::Error;
use railspring_profiles::profile::rails::{RAIL_NAMES, rail_outline, running_curve};
use railspring_profiles::profile::wheels::{Flange, wheel_profile, wheel_profile_with_flange};
use railspring_profiles::profile::{ProfileCurve, Segment};
use railspring_testing::facts_text as facts;

/// ROUNDOFF: some hundred operations on coordinates below 1 m.
const ROUNDOFF: f64 = 1e-13;
/// DISCRETISATION: the spline through samples of a standard; the quintic remainder h⁴κ³/384 of 0.2 mm steps on
/// R12 is 2e-12 m.
const DISCRETISATION: f64 = 1e-11;

/// Numbers between 0 and 1 that fill the interval evenly (additive golden-ratio sequence).
fn spread(n: usize) -> impl Iterator<Item = f64> {
    (1..=n).map(|i| (i as f64 * 0.618_033_988_749_894_9).fract())
}

/// Upper half of a circle from -y to +y, `n` points, unevenly spaced.
fn half_circle(centre: Point2<f64>, radius: f64, n: usize) -> Vec<Point2<f64>> {
    (0..n)
        .map(|i| {
            let t = i as f64 / (n - 1) as f64;
            let angle = PI * (t + 0.1 * (2.0 * PI * t).sin() / (2.0 * PI));
            centre + radius * Vector2::new(-angle.cos(), -angle.sin())
        })
        .collect()
}

/// Source: circle of 13 mm, sampled every half millimetre on average. Goal: point, normal, curvature, length,
/// closest point of the spline. Accuracy with h = 0.55 mm, hκ = 0.042: (hκ)² = 2e-3 in curvature; the remainders of
/// a cubic spline make that h(hκ)³/24 = 2e-9 m in place and (hκ)³/8 = 1e-5 in direction, both at the free ends.
#[test]
fn circle_is_reproduced() {
    const PLACE: f64 = 2e-9;
    const DIRECTION: f64 = 1e-5;
    const CURVATURE: f64 = 2e-3;
    let (centre, radius) = (Point2::new(0.02, 0.01), 13e-3);
    let curve = ProfileCurve::from_points(&half_circle(centre, radius, 82), &[]).unwrap();
    assert!((curve.length() - PI * radius).abs() < PLACE);
    for t in spread(400) {
        let s = t * curve.length();
        let outward = Vector2::new(-(s / radius).cos(), -(s / radius).sin());
        assert!((curve.point(s) - (centre + radius * outward)).norm() < PLACE);
        assert!((curve.upward_normal(s) - outward).norm() < DIRECTION);
        assert!((curve.curvature(s) * radius - 1.0).abs() < CURVATURE, "s = {s}");
        let probe = centre + (0.2 + 2.0 * t) * radius * outward;
        let (found, distance) = curve.closest(&probe);
        assert!((distance - (0.8 - 2.0 * t).abs() * radius).abs() < PLACE);
        // The foot moves by the error in direction, the more the nearer the probe is to the centre.
        assert!((found - s).abs() < radius * DIRECTION / 0.2, "{found} instead of {s}");
    }
}

#[test]
fn parameter_is_the_arc_length() {
    /// The limit that the type promises.
    const SPEED: f64 = 1e-6;
    let coarse = ProfileCurve::from_points(&half_circle(Point2::origin(), 12e-3, 20), &[]).unwrap();
    assert!(coarse.speed_error() < SPEED, "{}", coarse.speed_error());
    for &name in RAIL_NAMES.iter() {
        let curve = running_curve(&rail_outline(name).unwrap());
        assert!(curve.speed_error() < SPEED, "{}", curve.speed_error());
    }
    let wheel = wheel_profile("S1002").unwrap();
    assert!(wheel.speed_error() < SPEED, "{}", wheel.speed_error());
    // The length between two parameters, from fine chords (sagitta error below 1e-12).
    let (s0, s1, n) = (0.01, 0.09, 200_000);
    let at = |i: usize| wheel.point(s0 + (s1 - s0) * i as f64 / n as f64);
    let length: f64 = (0..n).map(|i| (at(i + 1) - at(i)).norm()).sum();
    assert!((length - (s1 - s0)).abs() < SPEED * (s1 - s0));
}

/// A roof with a 90° ridge that is declared as a kink: both flanks stay straight up to it.
#[test]
fn kinks_are_kept() {
    let points: Vec<_> =
        (-5..=5).map(|i| Point2::new(f64::from(i) * 1e-3, f64::from(i).abs() * 1e-3)).collect();
    let curve = ProfileCurve::from_points(&points, &[5]).unwrap();
    let ridge = 5e-3 * 2f64.sqrt();
    assert_eq!(curve.kinks().len(), 1);
    assert!((curve.kinks()[0] - ridge).abs() < ROUNDOFF);
    assert!((curve.tangent(ridge - 1e-6) - Vector2::new(1.0, -1.0).normalize()).norm() < 1e-9);
    assert!((curve.tangent(ridge + 1e-6) - Vector2::new(1.0, 1.0).normalize()).norm() < 1e-9);
    let (s, distance) = curve.closest(&Point2::new(0.0, -2e-3));
    assert!((s - ridge).abs() < ROUNDOFF && (distance - 2e-3).abs() < ROUNDOFF);
    assert!(curve.sample(0.4e-3).contains(&curve.point(curve.kinks()[0])));
    let smooth = ProfileCurve::from_points(&points, &[]).unwrap();
    assert!(smooth.kinks().is_empty() && smooth.tangent(smooth.s_at_y(0.0).unwrap()).y.abs() < 1e-9);
}

/// The closest point is the global one: against a scan of the whole curve, and the connection is perpendicular.
#[test]
fn closest_point_is_global() {
    let wheel = wheel_profile("S1002").unwrap();
    let scan: Vec<Point2<f64>> = wheel.sample(0.02e-3);
    for (u, v) in spread(300).zip(spread(600).skip(300)) {
        let probe = Point2::new(-0.09 + 0.17 * u, -0.03 + 0.08 * v);
        let (s, distance) = wheel.closest(&probe);
        let scanned = scan.iter().map(|p| (p - probe).norm()).fold(f64::INFINITY, f64::min);
        assert!(distance <= scanned && scanned - distance < 0.02e-3, "{distance} against {scanned}");
        if s > 0.0 && s < wheel.length() && distance > 1e-4 {
            // ROUNDOFF of the position divided by the distance, unless the foot is a joint of two zones.
            let (foot, tangent) = wheel.evaluate(s);
            let on_joint = wheel.breakpoints().iter().any(|b| (b - s).abs() < ROUNDOFF);
            assert!(on_joint || (probe - foot).dot(&tangent).abs() < 1e-12, "{probe}");
        }
    }
}

/// From a guess a few millimetres off, Newton steps end on the point that the search over the whole curve finds.
#[test]
fn closest_point_near_a_guess_is_the_same() {
    let wheel = wheel_profile("S1002").unwrap();
    for (t, u) in spread(500).zip(spread(1000).skip(500)) {
        let s = t * wheel.length();
        let probe = wheel.point(s) + 4e-3 * (u - 0.5) * wheel.upward_normal(s);
        let global = wheel.closest(&probe);
        let local = wheel.closest_near(&probe, s + 2e-3 * (u - 0.4));
        assert!((local.1 - global.1).abs() < ROUNDOFF, "{probe}: {local:?} against {global:?}");
        assert!((local.0 - global.0).abs() < 1e-12, "{probe}: {local:?} against {global:?}");
    }
}

#[test]
fn transforms_keep_shape() {
    let rail = running_curve(&rail_outline("UIC60").unwrap());
    for (t, u) in spread(20).zip(spread(40).skip(20)) {
        let (angle, shift) = (2.0 * PI * (t - 0.5), Vector2::new(u - 0.5, t));
        let moved = rail.transformed(angle, shift);
        let back = moved.transformed(-angle, -(Rotation2::new(-angle) * shift));
        assert_eq!(moved.length(), rail.length());
        for w in spread(30) {
            let s = w * rail.length();
            let expected = Rotation2::new(angle) * rail.point(s) + shift;
            assert!((moved.point(s) - expected).norm() < ROUNDOFF);
            assert!((moved.tangent(s) - Rotation2::new(angle) * rail.tangent(s)).norm() < ROUNDOFF);
            assert!((moved.curvature(s) - rail.curvature(s)).abs() < 1e-9);
            assert!((back.point(s) - rail.point(s)).norm() < ROUNDOFF);
            let probe = Point2::new(0.05 * (w - 0.5), -0.01 * u);
            let distance = rail.closest(&probe).1;
            assert!((moved.closest(&(Rotation2::new(angle) * probe + shift)).1 - distance).abs() < ROUNDOFF);
        }
    }
}

#[test]
fn sampling_obeys_its_limits() {
    let rail = running_curve(&rail_outline("60E1").unwrap());
    let parameters = rail.sample_parameters(1e-3);
    assert!(parameters.windows(2).all(|w| w[1] > w[0] && w[1] - w[0] <= 1e-3 + ROUNDOFF));
    assert_eq!((parameters[0], parameters[parameters.len() - 1]), (0.0, rail.length()));
    assert!(rail.breakpoints().iter().all(|b| parameters.contains(b)));
    for pair in rail.sample_adaptive(20e-3, 1e-6).windows(2) {
        let (a, b) = (rail.point(pair[0]), rail.point(pair[1]));
        let sagitta = (rail.point(0.5 * (pair[0] + pair[1])) - nalgebra::center(&a, &b)).norm();
        assert!(sagitta < 1.01e-6 && pair[1] - pair[0] < 20e-3 + ROUNDOFF);
    }
}

#[test]
fn lateral_position_is_inverted_and_ends_run_on() {
    let wheel = wheel_profile("S1002").unwrap();
    for t in spread(200) {
        let y = -0.07 + 0.13 * t;
        assert!((wheel.point(wheel.s_at_y(y).unwrap()).x - y).abs() < ROUNDOFF);
    }
    assert_eq!(wheel.s_at_y(-0.0701), None);
    assert_eq!(wheel.s_at_y(f64::NAN), None);
    let end = wheel.length();
    let ahead = wheel.point(end) + 0.01 * wheel.tangent(end);
    assert!((wheel.point(end + 0.01) - ahead).norm() < 1e-9);
    assert_eq!(wheel.curvature(end + 0.01), 0.0);
    assert!(wheel.point(f64::NAN).x.is_nan());
}

#[test]
fn bad_points_are_refused_by_index() {
    let good: Vec<_> = (0..8).map(|i| Point2::new(f64::from(i) * 1e-3, 0.0)).collect();
    let with = |i: usize, p: Point2<f64>| {
        let mut points = good.clone();
        points[i] = p;
        points
    };
    let mut swapped = good.clone();
    swapped.swap(3, 4);
    let cases = [
        (good[..3].to_vec(), vec![], "profile", "3 points"),
        (with(2, Point2::new(f64::NAN, 0.0)), vec![], "profile.points[2]", "finite"),
        (with(5, Point2::new(5e-3, f64::INFINITY)), vec![], "profile.points[5]", "finite"),
        (with(4, good[3]), vec![], "profile.points[4]", "profile out of order"),
        (swapped, vec![], "profile.points[4]", "profile out of order"),
        (good.clone(), vec![0], "profile.kinks[0]", "inner point"),
        (good.clone(), vec![3, 3], "profile.kinks[1]", "increasing"),
        (good.clone(), vec![7], "profile.kinks[0]", "inner point"),
    ];
    for (points, kinks, key, text) in cases {
        let error = ProfileCurve::from_points(&points, &kinks).unwrap_err();
        let Error::Input(input) = &error else { panic!("{error} is no input error") };
        assert_eq!(input.key, key, "{error}");
        assert!(error.to_string().contains(text), "{error} does not say {text:?}");
    }
}

/// Source: the drawing's own statement that all joints are tangential. Goal: the solved tangencies.
#[test]
fn rail_outlines_are_closed_and_tangential() {
    for &name in RAIL_NAMES.iter() {
        let outline = rail_outline(name).unwrap();
        let all: Vec<&Segment> = outline.running.iter().chain(&outline.rest).collect();
        for i in 0..all.len() {
            let next = all[(i + 1) % all.len()];
            assert!((all[i].end() - next.start()).norm() < ROUNDOFF, "{name}, joint {i}");
            assert!((all[i].tangent(1.0) - next.tangent(0.0)).norm() < 1e-11, "{name}, joint {i}");
            let mirror = |p: Point2<f64>| Point2::new(-p.x, p.y);
            assert!(all.iter().any(|s| (s.end() - mirror(all[i].start())).norm() < ROUNDOFF), "{name}, {i}");
        }
        let curve = running_curve(&outline);
        assert!(curve.kinks().is_empty());
        for segment in &outline.running {
            for t in spread(50) {
                assert!(curve.closest(&segment.point(t)).1 < DISCRETISATION, "{name}");
            }
        }
    }
}

/// Source: an independent construction of the same drawings, `geometry/rail_*_half_segments.csv` (mm, z up) and
/// `geometry/more-rails/rail_*_half_segments.csv` (mm, z down). Goal: every joint of the right half. Accuracy: the file's rounding,
/// 0.5e-6 mm in each coordinate, and for the UIC60 head that of its published joint (1e-5 mm in y, times the slope changes along
/// the chain). The head of 60N ends where its points end, on the straight side.
#[test]
fn rail_outlines_meet_the_independent_construction() {
    /// A rail's name and its file, the accuracy in m, the number of joints off the axis.
    type Compared = (&'static str, &'static str, f64, usize);
    const ONE: [Compared; 4] = [
        ("60E1", "rail_60E1", 1e-9, 19),
        ("UIC60", "rail_UIC60headvariant_on_60E1", 20e-9, 19),
        ("60E2", "rail_60E2", 1e-9, 20),
        ("54E1", "rail_54E1", 1e-9, 16),
    ];
    const OTHER: [Compared; 11] = [
        ("60N-on-60E1", "more-rails/rail_60N_HEADONLY", 1e-9, 5),
        ("56E1", "more-rails/rail_56E1", 1e-9, 15),
        ("55E1", "more-rails/rail_55E1", 1e-9, 15),
        ("54E2", "more-rails/rail_54E2", 1e-9, 16),
        ("54E3", "more-rails/rail_54E3", 1e-9, 15),
        ("50E5", "more-rails/rail_50E5", 1e-9, 16),
        ("49E1", "more-rails/rail_49E1", 1e-9, 17),
        ("41E1", "more-rails/rail_41E1", 1e-9, 16),
        ("40E1", "more-rails/rail_40E1", 1e-9, 16),
        ("33E1", "more-rails/rail_33E1", 1e-9, 16),
        ("30E1", "more-rails/rail_30E1", 1e-9, 12),
    ];
    assert_eq!(ONE.len() + OTHER.len(), RAIL_NAMES.len());
    // the column of the joint's y, and the sense of the one after it
    for (rails, column_y, down) in [(&ONE[..], 5, -1.0), (&OTHER[..], 4, 1.0)] {
        for &(name, file, model, joints) in rails {
            let Some(table) = facts(&format!("geometry/{file}_half_segments.csv")) else { return };
            let outline = rail_outline(name).unwrap();
            let all: Vec<Segment> = outline.running.iter().chain(&outline.rest).copied().collect();
            let rows = table.lines().filter(|l| l.starts_with(|c: char| c.is_ascii_digit()));
            let mut compared = 0;
            for row in rows {
                let column: Vec<&str> = row.split(',').collect();
                let value = |i: usize| 1e-3 * column[i].parse::<f64>().unwrap();
                let joint = Point2::new(value(column_y), down * value(column_y + 1));
                if joint.x == 0.0 {
                    continue;
                }
                let off = |ends: &dyn Fn(&Segment) -> Point2<f64>| {
                    all.iter().map(|s| (ends(s) - joint).norm()).fold(f64::INFINITY, f64::min)
                };
                let on_side = file.contains("HEADONLY") && column[0] == "5";
                let nearest = if on_side { off(&|s| s.closest(&joint)) } else { off(&Segment::end) };
                assert!(nearest < model, "{name}, row {}: {:e} m", column[0], nearest);
                compared += 1;
            }
            assert_eq!(compared, joints, "{name}");
        }
    }
}

/// Points (y, z), mm, of a table up to y = 60 mm; lines that begin with no number are its head.
fn running_points(table: &str) -> impl Iterator<Item = (f64, f64)> {
    let rows = table.lines().filter(|l| l.starts_with(|c: char| c == '-' || c.is_ascii_digit()));
    rows.map(|row| row.split_once(',').unwrap())
        .map(|(y, z)| (y.parse().unwrap(), z.parse().unwrap()))
        .filter(|(y, _): &(f64, f64)| *y <= 60.0)
}

/// Source: the published zone formulas evaluated elsewhere, `geometry/s1002_points.csv` (mm, 6 decimals), checked
/// there against the benchmark's wheel file to 1.6e-6 mm. Goal: the curve. Accuracy: the rounding, and half the
/// published steps (1.2e-4 and 3.7e-5 mm) near the joints that have them.
#[test]
fn s1002_meets_its_zone_formulas() {
    const ROUNDED: f64 = 0.8e-9;
    let Some(table) = facts("geometry/s1002_points.csv") else { return };
    let wheel = wheel_profile("S1002").unwrap();
    let mut compared = 0;
    for (y, z) in running_points(&table) {
        let near = |joint: f64| (y - joint).abs() < 2.0;
        let limit = if near(-35.0) {
            60e-9
        } else if near(-26.0) {
            20e-9
        } else {
            ROUNDED
        };
        let distance = wheel.closest(&Point2::new(1e-3 * y, 1e-3 * z)).1;
        assert!(distance < limit, "y = {y}: {distance:e} m");
        compared += 1;
    }
    assert!(compared > 600, "{compared}");
}

/// The zones join with continuous tangents, and the features of the drawing are where they should be.
#[test]
fn s1002_is_smooth_and_has_its_features() {
    let wheel = wheel_profile("S1002").unwrap();
    assert_eq!(wheel.breakpoints().len(), 7);
    for s in wheel.breakpoints() {
        let (before, after) = (wheel.evaluate(s - 1e-12), wheel.evaluate(s));
        assert!((before.0 - after.0).norm() < 2e-12);
        assert!(before.1.angle(&after.1) < 1e-7, "{}", wheel.point(s));
    }
    // The published steps are taken up without a ripple: around the joints D|C and C|B the curvature (77 and 20 1/m)
    // changes by less than 0.2 1/m in 0.05 mm; a step of 0.1 µm between two samples would change it by 70.
    const RIPPLE: f64 = 0.2;
    for joint in [-35e-3, -26e-3] {
        let s = wheel.s_at_y(joint).unwrap();
        let curvature: Vec<f64> =
            (-20..20).map(|i| wheel.curvature(s + 0.05e-3 * (f64::from(i) + 0.5))).collect();
        assert!(curvature.windows(2).all(|k| (k[1] - k[0]).abs() < RIPPLE), "{joint}: {curvature:?}");
    }
    // DISCRETISATION and the ten digits of the published constants.
    const PLACE: f64 = 1e-10;
    assert!((wheel.point(0.0) - Point2::new(-70e-3, 9.519_259e-3)).norm() < 1e-9);
    let tip = wheel.sample(1e-5).iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
    assert!((tip - 28e-3).abs() < 2e-9, "flange height {tip}");
    assert!((wheel.point(wheel.length()) - Point2::new(60e-3, -2.635_676_38e-3)).norm() < PLACE);
    // Flange thickness 32.5 mm at 10 mm below the tape circle: the face lies at y = -70 + 32.5.
    let face = wheel.point(wheel.s_at_y(-37.5e-3).unwrap());
    assert!((face.y - 10e-3).abs() < 1e-6, "{face}");
    // The face is inclined by 70°.
    let angle =
        -wheel.tangent(wheel.s_at_y(-39e-3).unwrap()).y.atan2(wheel.tangent(wheel.s_at_y(-39e-3).unwrap()).x);
    assert!((angle.to_degrees() - 70.0).abs() < 1e-4, "{angle}");
    assert!(wheel_profile("s1002").unwrap_err().to_string().contains("wheel_name"));
}

/// Source: the construction points of EN 13715:2020 for h = 28, 30, 32 (`geometry/en13715_flange_points.csv`, mm).
/// Goal: the solved tangencies. Accuracy (MODEL): the source's points are tangent to 0.003 mm, at h = 32 to 0.007 mm.
#[test]
fn flanges_pass_the_published_construction_points() {
    let Some(table) = facts("geometry/en13715_flange_points.csv") else { return };
    let mut compared = 0;
    for row in table.lines().filter(|l| l.starts_with(|c: char| c.is_ascii_digit())) {
        let column: Vec<&str> = row.split(',').collect();
        // Centres do not lie on the profile.
        if !["H2", "H1", "G1", "F1", "E1", "D1"].contains(&column[1]) {
            continue;
        }
        let value = |i: usize| 1e-3 * column[i].parse::<f64>().unwrap();
        let model = if column[0] == "32" { 7e-6 } else { 3e-6 };
        for thickness in [32.5e-3, 30e-3, 33e-3] {
            let wheel =
                wheel_profile_with_flange("EN13715-1in40", &Flange { height: value(0), thickness }).unwrap();
            let shifted = !column[1].starts_with('H');
            let y = value(2) + if shifted { thickness - 32.5e-3 } else { 0.0 };
            let off = wheel.closest(&Point2::new(y, value(3))).1;
            assert!(off < model, "h {} e {thickness} {}: {off:e} m", column[0], column[1]);
            compared += 1;
        }
    }
    assert_eq!(compared, 3 * 6 * 3);
}

/// Source: the 1/40 profile from the standard's rounded joints, `geometry/en13715_1in40_points.csv` (mm). Accuracy
/// (MODEL): its joints are rounded to 0.001 mm and jump by up to 0.0015 mm.
#[test]
fn cone_1_in_40_meets_the_published_points() {
    const MODEL: f64 = 2e-6;
    let Some(table) = facts("geometry/en13715_1in40_points.csv") else { return };
    let wheel = wheel_profile("EN13715-1in40").unwrap();
    let mut compared = 0;
    for (y, z) in running_points(&table) {
        let off = wheel.closest(&Point2::new(1e-3 * y, 1e-3 * z)).1;
        assert!(off < MODEL, "y = {y}: {off:e} m");
        compared += 1;
    }
    assert!(compared > 600, "{compared}");
    // The kink to the outer slope is the standard's.
    assert_eq!(wheel.kinks().len(), 1);
    assert!((wheel.point(wheel.kinks()[0]) - Point2::new(35e-3, -0.875e-3)).norm() < ROUNDOFF);
}

/// The other heights of S1002 keep its tread, bit for bit up to the arc length, and have the requested height; the
/// nominal flange solved for agrees with the published one to its digits.
#[test]
fn s1002_has_the_heights_of_the_standard() {
    let nominal = wheel_profile("S1002").unwrap();
    for height in [28e-3, 30e-3, 32e-3] {
        let wheel = wheel_profile_with_flange("S1002", &Flange { height, ..Flange::default() }).unwrap();
        let tip = wheel.sample(1e-5).iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
        assert!((tip - height).abs() < 5e-9, "{height}: {tip}");
        assert!(wheel.kinks().is_empty());
        for y in [-36e-3, -20e-3, 0.0, 40e-3] {
            let [a, b] = [&nominal, &wheel].map(|w| w.point(w.s_at_y(y).unwrap()));
            assert!((a - b).norm() < DISCRETISATION, "{height} {y}");
        }
    }
    let solved = wheel_profile("EN13715-1in40").unwrap();
    for s in spread(300).map(|t| t * nominal.s_at_y(-38.4e-3).unwrap()) {
        // MODEL: the published centres and joints have six to nine decimals of a mm.
        assert!(solved.closest(&nominal.point(s)).1 < 1e-9, "{s}");
    }
    let refused = |name: &str, height: f64, thickness: f64| {
        wheel_profile_with_flange(name, &Flange { height, thickness }).unwrap_err().to_string()
    };
    assert!(refused("S1002", 28e-3, 33e-3).contains("flange_thickness"));
    assert!(refused("S1002", 28e-3, 28e-3).contains("flange_thickness"));
    assert!(refused("S1002", 28e-3, f64::NAN).contains("flange_thickness"));
    assert!(refused("EN13715-1in40", 28e-3, 27e-3).contains("flange_thickness"));
    assert!(refused("EN13715-1in40", 29e-3, f64::NAN).contains("flange_thickness"));
    assert!(refused("EN13715-1in40", 29e-3, 30e-3).contains("flange_height"));
}

/// Source: EN 13715:2020, table C.1, D1 to T1, which moves with the flange (values rounded to 0.001 mm). Goal: S1002 with a
/// flange of 30 mm has them 2.5 mm nearer to the flange back, a straight line from T1 to the tape circle, the unchanged
/// tread beyond, and the thickness at 10 mm below the tape circle. Accuracy: the table's rounding.
#[test]
fn a_thin_flange_moves_the_throat_of_s1002() {
    const ROUNDING: f64 = 0.6e-6;
    let thin = wheel_profile_with_flange("S1002", &Flange { height: 28e-3, thickness: 30e-3 }).unwrap();
    let nominal = wheel_profile("S1002").unwrap();
    let z = |curve: &ProfileCurve, y: f64| curve.point(curve.s_at_y(y).unwrap()).y;
    for (y, expected) in [(-35.0, 6.867), (-30.0, 3.922), (-26.0, 2.741), (-0.5, 0.017)] {
        let found = z(&thin, (y - 2.5) * 1e-3);
        assert!((found - expected * 1e-3).abs() < ROUNDING, "{y}: {found} {expected}");
    }
    assert!((z(&thin, -1.5e-3) - 0.5 * 0.017e-3).abs() < ROUNDING);
    assert!((z(&thin, 20e-3) - z(&nominal, 20e-3)).abs() < 1e-12);
    assert!(thin.closest(&Point2::new(-40e-3, 10e-3)).1 < 1e-6);
}
