//! Scatter of measured profiles: measured, and smoothed by as much as it takes. Crowns of two and three arcs and a hollow tread that are no standard's.

use std::f64::consts::TAU;

use nalgebra::{Point2, Vector2};
use railspring_profiles::profile_file::{
    Action, Finding, FindingKind, MeasuredPoint, MeasuredProfile, PrepareOptions, Prepared, ProfileFormat,
    ProfileKind, Smoothing, prepare, scatter,
};
use railspring_testing::Random;

/// One millimetre and one micrometre in metres.
const MM: f64 = 1e-3;
const UM: f64 = 1e-6;
/// E*/2 of steel on steel, MPa.
const HALF_MODULUS: f64 = 57.7e3;

/// A surface: its height over y, and the range of y in which it is taken, mm.
struct Shape {
    name: &'static str,
    height: fn(f64) -> f64,
    range: [f64; 2],
}

/// Arcs that go on tangentially from the top to both sides: radius and where each ends, mm.
fn crown(arcs: &[(f64, f64)], y: f64) -> f64 {
    let (mut from, mut height, mut angle) = (0.0, 0.0, 0.0_f64);
    for (i, &(radius, to)) in arcs.iter().enumerate() {
        let centre = [from - radius * angle.sin(), height + radius * angle.cos()];
        let at = |y: f64| centre[1] - (radius * radius - (y - centre[0]).powi(2)).sqrt();
        if y.abs() <= to || i + 1 == arcs.len() {
            return at(y.abs());
        }
        (from, height, angle) = (to, at(to), ((to - centre[0]) / radius).asin());
    }
    height
}

fn shapes() -> [Shape; 3] {
    let hollow = |y: f64| {
        let t = ((y - 8.0) / 30.0).clamp(-1.0, 1.0);
        0.03 * y - 1.6 * (1.0 - t * t).powi(2) + 0.02 * (y + 20.0).min(0.0).powi(2)
    };
    [
        Shape {
            name: "two arcs",
            height: |y| crown(&[(250.0, 12.0), (30.0, 36.0)], y),
            range: [-34.0, 34.0],
        },
        Shape {
            name: "three arcs",
            height: |y| crown(&[(280.0, 9.0), (70.0, 24.0), (14.0, 35.0)], y),
            range: [-33.0, 33.0],
        },
        Shape { name: "hollow", height: hollow, range: [-35.0, 45.0] },
    ]
}

/// Points of a line `step` (mm) apart along it, that scatter by `deviation` (µm); m.
fn measured(
    height: &dyn Fn(f64) -> f64,
    range: [f64; 2],
    step: f64,
    deviation: f64,
    seed: u64,
) -> Vec<Point2<f64>> {
    let fine = 1e-3;
    let mut random = Random::new(seed);
    let mut noise = || Vector2::new(random.normal(), random.normal()) * (deviation * UM);
    let (mut points, mut travelled, mut last) = (Vec::new(), 0.0, Point2::new(range[0], height(range[0])));
    for i in 0..=((range[1] - range[0]) / fine) as usize {
        let y = range[0] + fine * i as f64;
        let here = Point2::new(y, height(y));
        travelled += (here - last).norm();
        last = here;
        if travelled >= step * points.len() as f64 {
            points.push(here * MM + noise());
        }
    }
    points
}

fn prepared(points: &[Point2<f64>], smoothing: Smoothing) -> Prepared {
    let points = points.iter().enumerate();
    let profile = MeasuredProfile {
        name: "made".into(),
        format: ProfileFormat::Text,
        kind: ProfileKind::Rail,
        points: points.map(|(i, &point)| MeasuredPoint { point, line: i + 1, weight: 1.0 }).collect(),
        findings: Vec::new(),
        drawn: None,
        side_by_groove: false,
    };
    prepare(&profile, &PrepareOptions { smoothing }).unwrap()
}

fn noise(findings: &[Finding]) -> Vec<(f64, Action)> {
    let noise = findings.iter().filter(|f| f.kind == FindingKind::Noise);
    noise.map(|f| (f.value.unwrap().0, f.action)).collect()
}

/// Root mean square (MPa) by which the pressure of a contact pressed flat is off between `range` (mm): E*·q·A/2 for each wave of the difference from the true height.
fn pressure_error(prepared: &Prepared, shape: &Shape, range: [f64; 2]) -> f64 {
    let (step, curve) = (0.05, &prepared.curve);
    let count = ((range[1] - range[0]) / step) as usize;
    let off: Vec<f64> = (0..count)
        .map(|i| {
            let y = range[0] + step * i as f64;
            curve.point(curve.s_at_y(y * MM).unwrap()).y / MM - (shape.height)(y)
        })
        .collect();
    let mean = off.iter().sum::<f64>() / count as f64;
    let phase = |k: usize, i: usize| TAU * (k * i) as f64 / count as f64;
    let squares: f64 = (1..count / 2)
        .map(|k| {
            let part = |of: fn(f64) -> f64| -> f64 {
                // Hann's window, for the ends of the range are no ends of the wave
                let window = |i: usize| 0.5 - 0.5 * phase(1, i).cos();
                off.iter().enumerate().map(|(i, off)| (off - mean) * window(i) * of(phase(k, i))).sum()
            };
            let amplitude = 2.0 / count as f64 * part(f64::cos).hypot(part(f64::sin));
            (TAU * k as f64 / (count as f64 * step) * amplitude).powi(2) / 2.0
        })
        .sum();
    // the window has 3/8 of the power
    HALF_MODULUS * (squares / 0.375).sqrt()
}

/// Source: the shapes themselves, exact and rounded to 0.1 µm. Goal: drawn files stay where they are at any distance of the points, and nothing is said of scatter.
#[test]
fn drawn_files_are_not_smoothed() {
    for shape in shapes() {
        for step in [0.1, 0.25, 0.5, 1.0] {
            let exact = measured(&shape.height, shape.range, step, 0.0, 1);
            let round = |x: f64| (x / (0.1 * UM)).round() * 0.1 * UM;
            let rounded: Vec<_> = exact.iter().map(|p| Point2::new(round(p.x), round(p.y))).collect();
            for points in [exact, rounded] {
                let found = prepared(&points, Smoothing::default());
                assert!(noise(&found.findings).is_empty(), "{} {step}: {:?}", shape.name, found.findings);
                assert!(found.points.iter().zip(&points).all(|(p, q)| p.point == *q));
            }
        }
    }
}

/// Source: white scatter of a known deviation, µm. Goal: what is measured, at all distances of the points. Rounding to 0.01 mm is scatter of 0.01/√12 mm. Means of four
/// neighbours have half the deviation and, as they are four times as dense as they scatter, more density than points that scatter so by themselves.
/// Accuracy: MODEL, a few dozen differences that are independent; the means of 0.5 mm are two of the largest.
#[test]
fn scatter_is_measured() {
    const MODEL: f64 = 0.3;
    let near = |found: f64, expected: f64, what: &str| {
        println!("{what}: {found:.3} instead of {expected:.3}");
        assert!((found / expected - 1.0).abs() < MODEL, "{what}: {found} instead of {expected}");
    };
    for shape in shapes() {
        for (step, deviation) in [(0.1, 0.5), (0.25, 0.5), (0.25, 2.0), (0.25, 10.0), (0.5, 2.0), (0.5, 5.0)]
        {
            let points = measured(&shape.height, shape.range, step, deviation, 3);
            let what = format!("{} {step} mm {deviation} µm", shape.name);
            near(scatter(&[points]).deviation / UM, deviation, &what);
        }
        let exact = measured(&shape.height, shape.range, 0.25, 0.0, 1);
        let round = |x: f64| (x / (10.0 * UM)).round() * 10.0 * UM;
        let rounded = exact.iter().map(|p| Point2::new(round(p.x), round(p.y))).collect();
        near(scatter(&[rounded]).deviation / UM, 10.0 / 12f64.sqrt(), shape.name);
        let close = measured(&shape.height, shape.range, 0.05, 4.0, 5);
        let means =
            close.windows(4).map(|w| Point2::from(w.iter().map(|p| p.coords).sum::<Vector2<f64>>() / 4.0));
        let found = scatter(&[means.collect()]);
        let white = (4.0 * UM).powi(2) * 0.05 * MM;
        near((found.density / white).sqrt(), 1.0, &format!("{} means", shape.name));
    }
}

/// Source: the derivation in `profile_file/wavelength.rs`: what scatter and smoothing leave of an error of the pressure, MPa, for points 0.25 mm apart. Goal: the
/// curve is as near to the true surface as that, and 1.5 times nearer than without smoothing at least.
/// Accuracy: MODEL, the root mean square over 22 mm has some ten independent waves, 2·√(1/20) of the value; the joint with an arc of 30 mm has 2.4 times the jump of the derivation.
#[test]
fn pressures_are_near_the_true_ones() {
    const MODEL: f64 = 1.45;
    for (shape, range) in shapes().iter().zip([[-11.0, 11.0], [0.0, 22.0], [-10.0, 30.0]]) {
        for (deviation, left, joint) in
            [(0.5, 40.0, 22.0), (2.0, 43.0, 53.0), (5.0, 63.0, 77.0), (10.0, 83.0, 101.0_f64)]
        {
            for seed in 1..4 {
                let points = measured(&shape.height, shape.range, 0.25, deviation, seed);
                let error = |smoothing| pressure_error(&prepared(&points, smoothing), shape, range);
                let [with, without] = [Smoothing::default(), Smoothing::Off].map(error);
                println!("{} {deviation} µm: {with:.0} MPa, {without:.0} MPa without smoothing", shape.name);
                let allowed = MODEL * f64::hypot(left, joint);
                assert!(
                    with < allowed && without > 1.5 * with,
                    "{} {deviation}: {with} {without}",
                    shape.name
                );
            }
        }
    }
}

/// Goal: corners of 5, 20 and 45 degrees stay corners in a scatter of 0.5 and 2 µm, where they are within a step, mm; the joints of arcs are none.
/// Accuracy: no point moves by more than twelve times the scatter and a quarter of a step times the turn, as the corner lies between two points; smoothed over, 20° would move
/// by 40 µm.
#[test]
fn real_corners_stay_in_the_scatter() {
    for deviation in [0.5, 2.0] {
        for shape in shapes() {
            let points = measured(&shape.height, shape.range, 0.25, deviation, 9);
            assert!(prepared(&points, Smoothing::default()).kinks.is_empty(), "{} {deviation}", shape.name);
        }
        for degrees in [5.0_f64, 20.0, 45.0] {
            let slope = degrees.to_radians().tan();
            let height = move |y: f64| y * y / 500.0 + slope * (y - 10.13).max(0.0);
            for seed in 1..5 {
                let points = measured(&height, [-20.0, 25.0], 0.25, deviation, seed);
                let found = prepared(&points, Smoothing::default());
                let places: Vec<f64> = found.kinks.iter().map(|&i| found.points[i].point.x / MM).collect();
                let near = places.len() == 1 && (places[0] - 10.13).abs() < 0.3;
                assert!(near, "{degrees}° {deviation} µm: {places:?}");
                let allowed = 12.0 * deviation * UM + 0.25 * MM * degrees.to_radians() / 4.0;
                let moved =
                    found.points.iter().zip(&points).map(|(p, q)| (p.point - q).norm()).fold(0.0, f64::max);
                assert!(moved < allowed, "{degrees}° {deviation} µm: {moved}");
            }
        }
    }
}
