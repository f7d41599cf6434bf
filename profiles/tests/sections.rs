//! The wheel section against an independent polygon of the same generic body, and rails drawn from the dimensions of catalogues.

use nalgebra::Point2;
use railspring_profiles::profile::Segment;
use railspring_profiles::profile::rail_catalogue::{
    CATALOGUE_RAILS, RailDimensions, catalogue_rail, rail_of_dimensions,
};
use railspring_profiles::section::{rail_section_of, wheel_section};

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

/// Source: masses of suppliers' catalogues. Goal: the section drawn from six dimensions, kg/m of steel. Accuracy: MODEL, the
/// necks of the web are not given, nor are most depths of head and foot, of which a millimetre is worth a per cent.
#[test]
fn masses_of_the_catalogue() {
    const MODEL: f64 = 0.06;
    const STEEL: f64 = 7850.0;
    for rail in &CATALOGUE_RAILS {
        let dimensions = rail.dimensions();
        let section = rail_section_of(rail.name, rail_of_dimensions(&dimensions).unwrap());
        let mass = section.area.area * STEEL;
        assert!((section.height - dimensions.height).abs() < 1e-9, "{}", rail.name);
        let width = 2.0 * section.running.point(0.0).x.abs();
        assert!((width - dimensions.head).abs() < 4e-3, "{}: {width}", rail.name);
        if let Some(given) = rail.mass {
            let off = mass / given - 1.0;
            assert!(off.abs() < MODEL, "{}: {mass} for {given} kg/m", rail.name);
        }
    }
}

/// Goal: dimensions that no rail has, or no section, are refused with their name.
#[test]
fn dimensions_that_are_none() {
    let good = catalogue_rail("136RE").unwrap().dimensions();
    for (wrong, named) in [
        (RailDimensions { height: 1.857, ..good }, "height of 1857 mm"),
        (RailDimensions { web: 0.0, ..good }, "web of 0 mm"),
        (RailDimensions { foot_depth: Some(f64::NAN), ..good }, "foot_depth of NaN mm"),
        (RailDimensions { height: 0.09, ..good }, "height of 90 mm"),
    ] {
        let message = rail_of_dimensions(&wrong).unwrap_err().to_string();
        assert!(message.contains(named) && message.contains("rail_body"), "{message}");
    }
}
