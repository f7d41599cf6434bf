//! Rails placed in the track, and the first touch of a lowered wheel.

use nalgebra::{Point2, Vector2};
use railspring_profiles::error::Error;
use railspring_profiles::placement::{PlacedRail, TrackGeometry, place_rail, touch};
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::profile::wheels::wheel_profile;
use railspring_profiles::section::rail_section;

/// ROUNDOFF: some hundred operations on coordinates below 1 m.
const ROUNDOFF: f64 = 1e-12;

fn placed(rail: &str, track: &TrackGeometry) -> PlacedRail {
    place_rail(&rail_section(rail).unwrap(), track).unwrap()
}

/// Numbers between 0 and 1 that fill the interval evenly (additive golden-ratio sequence).
fn spread(n: usize) -> impl Iterator<Item = f64> {
    (1..=n).map(|i| (i as f64 * 0.618_033_988_749_894_9).fract())
}

/// Source: closed form on the R300 crown: its highest point lies 300 sin(atan i) from the rail's axis after the
/// rail has been turned by atan i about its top. Goal: inclination, height and gauge of the placed rail.
#[test]
fn rail_stands_in_the_track() {
    for slope in [1.0 / 40.0, 1.0 / 30.0, 0.0, -0.01] {
        let track = TrackGeometry { inclination: slope, ..TrackGeometry::standard() };
        let rail = placed("60E1", &track);
        let apex =
            rail.to_world(&Point2::new(0.3 * f64::atan(slope).sin(), 0.3 * (1.0 - f64::atan(slope).cos())));
        assert!(apex.y.abs() < ROUNDOFF, "the highest point lies at z = {}", apex.y);
        assert!((apex.x - rail.origin.x - 0.3 * slope.atan().sin()).abs() < ROUNDOFF);
        let gauge_s = rail.curve.s_at_y(0.5 * track.gauge).unwrap();
        assert!((rail.curve.point(gauge_s).y - track.gauge_height).abs() < ROUNDOFF);
        // The foot leans to the field side.
        assert!((rail.to_world(&Point2::new(0.0, 0.1)).x > rail.origin.x) == (slope > 0.0));
        for t in spread(50) {
            let p = Point2::new(0.1 * (t - 0.5), 0.17 * t);
            assert!((rail.to_profile(&rail.to_world(&p)) - p).norm() < ROUNDOFF);
            let s = t * rail.curve.length();
            let section = rail_section("60E1").unwrap();
            assert!((rail.to_world(&section.running.point(s)) - rail.curve.point(s)).norm() < ROUNDOFF);
        }
    }
    // Source: the benchmark's rail origin, its highest point, 760.5326 mm from the track centre. MODEL: the points
    // of its file have their apex 6 µm beside their origin.
    let rail = placed("UIC60", &TrackGeometry::standard());
    let apex = rail.to_world(&Point2::new(0.3 * f64::atan(0.025).sin(), 0.0));
    assert!((apex.x - 760.5326e-3).abs() < 6e-6, "{}", apex.x);
}

/// An arc from -70° to 70° about the vertical, in the direction of increasing y.
fn arc(centre: Point2<f64>, radius: f64, upwards: bool) -> ProfileCurve {
    let points: Vec<_> = (-700..=700)
        .map(|i| {
            let angle = (f64::from(i) * 0.1).to_radians();
            let sense = if upwards { -1.0 } else { 1.0 };
            centre + radius * Vector2::new(angle.sin(), sense * angle.cos())
        })
        .collect();
    ProfileCurve::from_points(&points, &[]).unwrap()
}

/// Source: two circles touch on the line of their centres, R1 + R2 apart. Goal: height, place and angle of the
/// touch, also far out on the flanks. Accuracy: DISCRETISATION of arcs sampled every 0.1°, (hκ)⁴/384 R = 1e-14 m
/// inside and some 1e-12 m near the ends, and the place is as good as the tangent, 1e-9.
#[test]
fn circle_on_circle() {
    const PLACE: f64 = 1e-9;
    let (r1, r2) = (0.3, 0.02);
    let rail =
        PlacedRail { curve: arc(Point2::new(0.7, r1), r1, true), angle: 0.0, origin: Point2::origin() };
    let wheel = arc(Point2::new(0.0, -r2), r2, false);
    for t in spread(60) {
        let offset = 0.55 * (r1 + r2) * (2.0 * t - 1.0);
        let found = touch(&rail, &wheel, 0.7 + offset).unwrap();
        let angle = (offset / (r1 + r2)).asin();
        // The wheel's origin is its lowest point, r2 below its centre.
        let expected = r1 - (r1 + r2) * angle.cos() + r2;
        assert!((found.tape_z - expected).abs() < PLACE, "offset {offset}: {} {expected}", found.tape_z);
        let point = Point2::new(0.7 + r1 * angle.sin(), r1 - r1 * angle.cos());
        assert!((found.point - point).norm() < PLACE);
        assert!((found.contact_angle + angle).abs() < PLACE / r2);
    }
}

/// Against a brute-force scan of the vertical gap in 20 µm steps: nothing lies deeper, and the touch is a touch.
#[test]
fn touch_is_the_global_minimum() {
    // Sagitta of 20 µm on the sharpest curvature difference, 1/12 mm + 1/13 mm, times the 70° face's steepness.
    const SCAN: f64 = 0.1e-6;
    let wheel = wheel_profile("S1002").unwrap();
    for (name, slope) in [("UIC60", 1.0 / 40.0), ("60E1", 1.0 / 20.0), ("60E1", 0.0)] {
        let track = TrackGeometry { inclination: slope, ..TrackGeometry::standard() };
        let rail = placed(name, &track);
        for t in spread(30) {
            let tape_y = track.tape_y(&wheel) + 0.030 * (t - 0.6);
            let found = touch(&rail, &wheel, tape_y).unwrap();
            let on_wheel = wheel.point(found.wheel_s) + Vector2::new(tape_y, found.tape_z);
            assert!((on_wheel - found.point).norm() < ROUNDOFF, "the two points do not meet");
            assert!((rail.curve.point(found.rail_s) - found.point).norm() < ROUNDOFF);
            assert!(rail.curve.tangent(found.rail_s).perp(&wheel.tangent(found.wheel_s)).abs() < 1e-9);
            let mut least = f64::INFINITY;
            for i in 0..6000 {
                let y = 0.70 + 20e-6 * f64::from(i);
                if let (Some(r), Some(w)) = (rail.curve.s_at_y(y), wheel.s_at_y(y - tape_y)) {
                    least = least.min(rail.curve.point(r).y - wheel.point(w).y);
                }
            }
            assert!(
                found.tape_z <= least && least - found.tape_z < SCAN,
                "{name} {tape_y}: {least} {found:?}"
            );
        }
    }
}

/// Rows of the contact program's table of the first touch; `None`, with a note, where the shared facts are absent.
fn touch_table() -> Option<Vec<Vec<f64>>> {
    let table = railspring_testing::facts_text("contact/touch_point_right_wheel_no_yaw.csv")?;
    Some(table.lines().skip(1).map(|row| row.split(',').map(|v| v.parse().unwrap()).collect()).collect())
}

/// Source: CONTACT 25.2 (Vollebregt and Kalker) on the Manchester benchmark's profiles, table of the first touch
/// over the lateral shift in the shared facts (`contact/touch_point_right_wheel_no_yaw.csv`). Goal: profiles,
/// placement and touch together. Set-up: UIC60 at 1:40, S1002, gauge 1435 mm at 14 mm, flange backs 1360 mm, no
/// roll, no yaw. Units of the table: mm, rad; world frame as ours, its angle negative towards the flange.
/// Accuracy (MODEL: that program smooths its profiles): 0.02 mm in y, 0.5 µm in the wheel's height, 2e-4 rad.
#[test]
fn contact_program_finds_the_same_touch() {
    const LATERAL: f64 = 0.02e-3;
    const HEIGHT: f64 = 0.5e-6;
    const ANGLE: f64 = 2e-4;
    let Some(rows) = touch_table() else { return };
    let track = TrackGeometry::standard();
    let rail = placed("UIC60", &track);
    let wheel = wheel_profile("S1002").unwrap();
    let mut compared = 0;
    for column in rows {
        let (shift, tape_z, y, z, angle) =
            (1e-3 * column[0], 1e-3 * column[3], 1e-3 * column[4], 1e-3 * column[5], -column[11]);
        let found = touch(&rail, &wheel, track.tape_y(&wheel) + shift).unwrap();
        assert!((found.tape_z - tape_z).abs() < HEIGHT, "shift {shift}: {found:?}, tape at {tape_z}");
        assert!((found.point.x - y).abs() < LATERAL, "shift {shift}: {found:?}, y {y}");
        assert!((found.point.y - z).abs() < LATERAL, "shift {shift}: {found:?}, z {z}");
        assert!((found.contact_angle - angle).abs() < ANGLE, "shift {shift}: {found:?}, angle {angle}");
        compared += 1;
    }
    assert!(compared > 60, "{compared}");
}

/// Value at `x` of the parabola through three points.
fn parabola(points: &[(f64, f64)], x: f64) -> f64 {
    (0..3)
        .map(|i| {
            let others = (0..3).filter(|&j| j != i);
            points[i].1 * others.map(|j| (x - points[j].0) / (points[i].0 - points[j].0)).product::<f64>()
        })
        .sum()
}

/// Source: the same table. The first touch jumps where the heights of two places of touch are equal; parabolas through
/// the table's heights on either side, 0.25 mm apart, meet there. Goal: our jumps lie at the same shifts within
/// 0.05 mm. Accuracy of the parabolas: some 0.01 mm.
#[test]
fn the_touch_jumps_where_the_contact_program_has_it() {
    const JUMP: f64 = 0.05e-3;
    let Some(rows) = touch_table() else { return };
    let rows: Vec<[f64; 3]> = rows.iter().map(|c| [1e-3 * c[0], 1e-3 * c[3], 1e-3 * c[4]]).collect();
    let track = TrackGeometry::standard();
    let rail = placed("UIC60", &track);
    let wheel = wheel_profile("S1002").unwrap();
    let bisect = |mut low: f64, mut high: f64, beyond: &dyn Fn(f64) -> bool| {
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            *if beyond(middle) { &mut high } else { &mut low } = middle;
        }
        low
    };
    let mut jumps = 0;
    for i in (3..rows.len() - 2).filter(|&i| (rows[i][2] - rows[i - 1][2]).abs() > 4e-3) {
        let heights = |range: std::ops::Range<usize>| -> Vec<(f64, f64)> {
            rows[range].iter().map(|r| (r[0], r[1])).collect()
        };
        let (before, after) = (heights(i - 3..i), heights(i..i + 3));
        let (low, high) = (rows[i - 1][0], rows[i][0]);
        // the wheel rests on the higher of the two places, which has the smaller z
        let theirs = bisect(low, high, &|x| parabola(&after, x) < parabola(&before, x));
        let middle = 0.5 * (rows[i - 1][2] + rows[i][2]);
        let ours =
            bisect(low, high, &|x| touch(&rail, &wheel, track.tape_y(&wheel) + x).unwrap().point.x < middle);
        println!("jump at {:.4} mm, table {:.4} mm", ours * 1e3, theirs * 1e3);
        assert!((ours - theirs).abs() < JUMP, "{ours} {theirs}");
        jumps += 1;
    }
    assert_eq!(jumps, 3);
}

fn key(result: Result<impl std::fmt::Debug, Error>) -> String {
    match result.unwrap_err() {
        Error::Input(input) => input.key,
        other => panic!("{other} is no input error"),
    }
}

#[test]
fn a_wheel_that_misses_is_refused() {
    let track = TrackGeometry::standard();
    let rail = placed("UIC60", &track);
    let wheel = wheel_profile("S1002").unwrap();
    // Beside the rail on both sides, on the tread's end, and nowhere.
    for shift in [0.3, -0.3, -0.085, f64::NAN] {
        assert_eq!(key(touch(&rail, &wheel, track.tape_y(&wheel) + shift)), "lateral_shift", "{shift}");
    }
}

#[test]
fn an_impossible_track_is_refused() {
    let standard = TrackGeometry::standard();
    let cases = [
        (TrackGeometry { gauge: 1435.0, ..standard }, "gauge"),
        (TrackGeometry { gauge_height: -0.014, ..standard }, "gauge_height"),
        (TrackGeometry { flange_back: f64::NAN, ..standard }, "flange_back"),
        (TrackGeometry { lateral_shift: 5.0, ..standard }, "lateral_shift"),
        (TrackGeometry { inclination: 40.0, ..standard }, "inclination"),
    ];
    for (track, expected) in cases {
        assert_eq!(key(place_rail(&rail_section("60E1").unwrap(), &track)), expected);
    }
    // A rail profile that ends above the gauge's depth.
    let mut shallow = rail_section("60E1").unwrap();
    shallow.running = arc(Point2::new(0.0, 0.01), 0.01, true);
    assert_eq!(key(place_rail(&shallow, &standard)), "gauge_height");
}
