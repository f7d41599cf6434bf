//! The wheel section against an independent polygon of the same generic body.

use nalgebra::Point2;
use railspring_calibrate::profile::Segment;
use railspring_calibrate::section::wheel_section;

/// Distance from a segment, by its parameter.
fn distance(segment: &Segment, p: &Point2<f64>) -> f64 {
    let n = 2000;
    (0..n)
        .map(|i| {
            let (a, b) = (segment.point(i as f64 / n as f64), segment.point((i + 1) as f64 / n as f64));
            let along = ((p - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
            (p - (a + along * (b - a))).norm()
        })
        .fold(f64::INFINITY, f64::min)
}

/// Source: `geometry/wheel_generic_straight_860.csv` of the shared facts (y and radius in mm, 4 decimals). Goal:
/// every vertex of the closed polygon lies on our outline. Accuracy: the rounding on the profile and all straight
/// parts; on the fillets (MODEL) 31 µm, since the source makes them by widening and narrowing a polygon.
#[test]
fn polygon_of_the_860_wheel_lies_on_the_outline() {
    const ROUNDED: f64 = 0.1e-6;
    const MODEL: f64 = 31e-6;
    let Some(table) = railspring_testing::facts_text("geometry/wheel_generic_straight_860.csv") else {
        return;
    };
    let wheel = wheel_section("S1002", 0.860).unwrap();
    let (mut exact, mut compared) = (0, 0);
    for row in table.lines().filter(|l| l.starts_with(|c: char| c == '-' || c.is_ascii_digit())) {
        let (y, r) = row.split_once(',').unwrap();
        let (y, r): (f64, f64) = (y.parse().unwrap(), r.parse().unwrap());
        let vertex = Point2::new(1e-3 * y, 1e-3 * r - wheel.radius);
        let on_body = wheel.body_outline.iter().map(|s| distance(s, &vertex)).fold(f64::INFINITY, f64::min);
        let nearest = on_body.min(wheel.running.closest(&vertex).1);
        assert!(nearest < MODEL, "y {y} mm, radius {r} mm: {nearest:e} m");
        compared += 1;
        exact += usize::from(nearest < ROUNDED);
    }
    assert!(compared > 400 && exact > 280, "{exact} of {compared}");
}
