//! Hertz contact of two smooth bodies.
//!
//! Source: K. L. Johnson, Contact Mechanics (1985), section 4.2. With k = b/a the
//! ratio of the semi-axes (b ≤ a), e² = 1 − k², the complete elliptic integrals K
//! and E, and D = (K − E)/e²:
//! B/A = (K − D)/(k²·D), √(AB) = p0/(E*·a)·√(D·(K − D)), δ = p0·b·K/E*.

use std::f64::consts::PI;

use railspring_profiles::error::{InputError, Result};
use railspring_profiles::root::bisection;

/// Contact modulus E* (N/m²) of two materials: `1/E* = (1 − ν1²)/E1 + (1 − ν2²)/E2`.
///
/// ```
/// use railspring_calibrate::analytic::hertz::contact_modulus;
/// let steel = contact_modulus(210e9, 0.3, 210e9, 0.3);
/// assert!((steel - 115.38e9).abs() < 0.01e9);
/// ```
pub fn contact_modulus(young_1: f64, poisson_1: f64, young_2: f64, poisson_2: f64) -> f64 {
    1.0 / ((1.0 - poisson_1 * poisson_1) / young_1 + (1.0 - poisson_2 * poisson_2) / young_2)
}

/// State of an elliptic Hertz contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HertzContact {
    /// Semi-axis of the contact patch in the plane of `radius_x`, m.
    pub semi_axis_x: f64,
    /// Semi-axis of the contact patch in the plane of `radius_y`, m.
    pub semi_axis_y: f64,
    /// Approach of two distant points, m.
    pub approach: f64,
    /// Largest pressure, N/m².
    pub max_pressure: f64,
    /// Tangent stiffness dF/dδ = (3/2)·F/δ, N/m.
    pub tangent_stiffness: f64,
}

/// Hertz contact under `force` (N) of two bodies whose relative curvatures are
/// `1/radius_x` and `1/radius_y` (m), with contact modulus `contact_modulus` (N/m²).
///
/// # Errors
/// [`InputError`] with key `hertz` unless all values are positive and finite.
pub fn point_contact(force: f64, radius_x: f64, radius_y: f64, contact_modulus: f64) -> Result<HertzContact> {
    let values = [force, radius_x, radius_y, contact_modulus];
    if values.iter().any(|v| !(v.is_finite() && *v > 0.0)) {
        return InputError::refuse(
            "hertz",
            format!("{values:?}"),
            "force, two relative radii and contact modulus, all positive and finite",
            "Hertz contact needs a load and two convex relative curvatures",
        );
    }
    let (large, small) = (radius_x.max(radius_y), radius_x.min(radius_y));
    let axes = axis_ratio(large / small);
    let integrals = Elliptic::new(axes);
    let shape = (integrals.d * integrals.k_minus_d()).sqrt();
    let curvature = 0.5 / (large * small).sqrt();
    let major = (3.0 * force * shape / (2.0 * PI * axes * contact_modulus * curvature)).cbrt();
    let max_pressure = 3.0 * force / (2.0 * PI * axes * major * major);
    let approach = max_pressure / contact_modulus * axes * major * integrals.k;
    let (semi_axis_x, semi_axis_y) =
        if radius_x >= radius_y { (major, axes * major) } else { (axes * major, major) };
    Ok(HertzContact {
        semi_axis_x,
        semi_axis_y,
        approach,
        max_pressure,
        tangent_stiffness: 1.5 * force / approach,
    })
}

/// Force (N) of a sphere of `radius` on a plane at `approach` (m): `(4/3)·E*·√R·δ^(3/2)`.
pub fn sphere_force(approach: f64, radius: f64, contact_modulus: f64) -> f64 {
    4.0 / 3.0 * contact_modulus * radius.sqrt() * approach.max(0.0).powf(1.5)
}

/// Approach (m) of a sphere of `radius` on a plane under `force` (N); the inverse of [`sphere_force`].
pub fn sphere_approach(force: f64, radius: f64, contact_modulus: f64) -> f64 {
    (0.75 * force.max(0.0) / (contact_modulus * radius.sqrt())).powf(2.0 / 3.0)
}

/// Ratio b/a of the semi-axes for a ratio of radii B/A ≥ 1, by bisection of its
/// logarithm: B/A falls from infinity to 1 as b/a rises to 1.
fn axis_ratio(curvature_ratio: f64) -> f64 {
    let rounder = |logarithm: f64| {
        let k = logarithm.exp();
        let integrals = Elliptic::new(k);
        !(integrals.k_minus_d() / (k * k * integrals.d) > curvature_ratio)
    };
    bisection(-700.0, 0.0, rounder).exp()
}

/// Complete elliptic integrals at complementary modulus k (e² = 1 − k²).
struct Elliptic {
    k: f64,
    d: f64,
}

impl Elliptic {
    /// Arithmetic-geometric mean; D is summed without the cancellation in (K − E)/e².
    fn new(complementary_modulus: f64) -> Self {
        let (mut a, mut b) = (1.0, complementary_modulus);
        let square = (1.0 - complementary_modulus) * (1.0 + complementary_modulus);
        // c_n²/e² with c_0 = e and c_(n+1) = c_n²/(4·a_(n+1)).
        let (mut c, mut power, mut sum) = (1.0, 0.5, 0.5);
        for _ in 0..12 {
            (a, b) = (0.5 * (a + b), (a * b).sqrt());
            c *= c * square / (16.0 * a * a);
            power *= 2.0;
            sum += power * c;
        }
        let k = PI / (2.0 * a);
        Self { k, d: k * sum }
    }

    fn k_minus_d(&self) -> f64 {
        self.k - self.d
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of the bisection and the cube roots, relative.
    const ROUNDOFF: f64 = 1e-12;

    fn relative(value: f64, exact: f64) -> f64 {
        (value / exact - 1.0).abs()
    }

    #[test]
    fn equal_radii_are_the_sphere() {
        let (force, radius, modulus) = (1e5, 0.43, 1.15e11);
        let contact = point_contact(force, radius, radius, modulus).unwrap();
        let axis = (0.75 * force * radius / modulus).cbrt();
        assert!(relative(contact.semi_axis_x, axis) < ROUNDOFF);
        assert!(relative(contact.semi_axis_y, axis) < ROUNDOFF);
        assert!(relative(contact.approach, axis * axis / radius) < ROUNDOFF);
        assert!(relative(contact.max_pressure, 1.5 * force / (PI * axis * axis)) < ROUNDOFF);
        assert!(relative(sphere_approach(force, radius, modulus), contact.approach) < ROUNDOFF);
        assert!(relative(sphere_force(contact.approach, radius, modulus), force) < ROUNDOFF);
    }

    /// Source: E and K of e = 1/2 (e² = 1/4), Abramowitz and Stegun, table 17.1.
    #[test]
    fn elliptic_integrals_match_tables() {
        let e2: f64 = 0.25;
        let integrals = Elliptic::new((1.0 - e2).sqrt());
        assert!(relative(integrals.k, 1.685_750_354_812_596) < ROUNDOFF);
        assert!(relative(integrals.k - e2 * integrals.d, 1.467_462_209_339_427_2) < ROUNDOFF);
        let circle = Elliptic::new(1.0);
        assert!(relative(circle.k, PI / 2.0) < ROUNDOFF && relative(circle.d, PI / 4.0) < ROUNDOFF);
    }

    #[test]
    fn exchanged_radii_exchange_axes() {
        let one = point_contact(1e5, 0.46, 0.08, 1.1e11).unwrap();
        let other = point_contact(1e5, 0.08, 0.46, 1.1e11).unwrap();
        assert_eq!((one.semi_axis_x, one.semi_axis_y), (other.semi_axis_y, other.semi_axis_x));
        assert_eq!(one.approach, other.approach);
        assert!(one.semi_axis_x > one.semi_axis_y);
    }

    /// Source: another program's analytic Hertz module (numbers printed to 9 digits).
    /// Goal: semi-axes (mm), approach (mm) and largest pressure (MPa) for wheel and rail radii.
    #[test]
    fn agrees_with_printed_cases() {
        // Ten printed digits of the columns, nine of the worst one.
        const PRINTED: f64 = 2e-8;
        let Some(text) = railspring_testing::facts_text("contact/hertz_check.csv") else { return };
        let mut lines = text.lines();
        let names: Vec<&str> = lines.next().unwrap().split(',').collect();
        let mut cases = 0;
        for line in lines.filter(|l| !l.trim().is_empty()) {
            let values: Vec<f64> = line.split(',').map(|v| v.trim().parse().unwrap()).collect();
            let get = |name: &str| values[names.iter().position(|n| *n == name).unwrap()];
            let modulus = get("G_MPa") * 1e6 / (1.0 - get("nu"));
            let contact =
                point_contact(get("fn_N"), get("Rx_mm") * 1e-3, get("Ry_mm") * 1e-3, modulus).unwrap();
            for (value, name, unit) in [
                (contact.semi_axis_x, "a_hertz_analytic_mm", 1e-3),
                (contact.semi_axis_y, "b_hertz_analytic_mm", 1e-3),
                (contact.approach, "pen_analytic_mm", 1e-3),
                (contact.max_pressure, "pmax_analytic_MPa", 1e6),
                (contact.tangent_stiffness, "kt_analytic_N_per_mm", 1e3),
            ] {
                assert!(relative(value, get(name) * unit) < PRINTED, "{name}: {value:e} in {line}");
            }
            cases += 1;
        }
        assert!(cases >= 10, "only {cases} cases read");
    }

    #[test]
    fn unusable_values_are_named() {
        for bad in [-1.0, 0.0, f64::NAN, f64::INFINITY] {
            assert!(point_contact(bad, 1.0, 1.0, 1.0).is_err());
            assert!(point_contact(1.0, 1.0, bad, 1.0).is_err());
        }
    }
}
