use super::*;

/// Rounding of some hundred operations, relative.
const ROUNDOFF: f64 = 1e-13;
/// The inverse stops at a relative change of 1e-13; Newton's last step makes it better.
const SOLVER: f64 = 2e-13;

const LAWS: [StiffnessLaw; 5] = [
    StiffnessLaw::published(),
    StiffnessLaw { a: 0.0, b: 1.4e8, c: 1.0 / 3.0 },
    StiffnessLaw { a: 1e3, b: 3e8, c: 1.0 / 3.0 },
    StiffnessLaw { a: 5e8, b: 0.0, c: 0.5 },
    StiffnessLaw { a: 2e8, b: 3e8, c: 0.9 },
];

fn relative(value: f64, exact: f64) -> f64 {
    (value / exact - 1.0).abs()
}

fn loads() -> Vec<f64> {
    (0..20).map(|i| 1e3 * 150f64.powf(f64::from(i) / 19.0)).collect()
}

/// Source: published constants, integrated with Simpson's rule in f^(1/8) apart from this code.
/// Goal: displacement (mm) and tangent (kN/mm) at given loads. Accuracy: the printed digits.
#[test]
fn published_law_matches_table() {
    let law = StiffnessLaw::published();
    for (kilonewton, millimetre, stiffness) in [
        (10.0, 0.0237, 542.0),
        (50.0, 0.0825, 785.0),
        (85.0, 0.1242, 888.0),
        (100.0, 0.1408, 922.0),
        (150.0, 0.1924, 1014.0),
    ] {
        // Half a unit of the last printed digit.
        let (half_digit_mm, half_digit_stiffness) = (0.00005, 0.5);
        assert!((law.displacement(kilonewton * 1e3) * 1e3 - millimetre).abs() <= half_digit_mm);
        assert!((law.tangent(kilonewton * 1e3) * 1e-6 - stiffness).abs() <= half_digit_stiffness);
    }
}

/// Goal: c = 1/2 has the closed form δ = (2 f0/b)·(r − (a/b)·ln(1 + b·r/a)), r = √(f/f0).
#[test]
fn displacement_matches_closed_form() {
    for (a, b) in [(3e7, 2.94e8), (3e8, 1e8), (1e8, 1e8)] {
        let law = StiffnessLaw { a, b, c: 0.5 };
        for force in [100.0, 1e4, 1.5e5] {
            let root = (force / REFERENCE_FORCE).sqrt();
            let exact = 2.0 * REFERENCE_FORCE / b * (root - a / b * (1.0 + b * root / a).ln());
            assert!(relative(law.displacement(force), exact) < 10.0 * ROUNDOFF, "{a} {b} {force}");
        }
    }
}

#[test]
fn displacement_and_force_are_inverse() {
    for law in LAWS {
        for force in [1e-6, 1.0, 1e3, 8.5e4, 1e6] {
            assert!(relative(law.force(law.displacement(force)), force) < SOLVER, "{law:?} {force}");
            assert!(relative(law.force_from(law.displacement(force), 3.0 * force), force) < SOLVER);
        }
        assert_eq!(law.force(-1e-3), 0.0);
        assert_eq!(law.force(0.0), 0.0);
        assert_eq!(law.displacement(-1.0), 0.0);
    }
}

/// Goal: the tangent is the slope of the force. Central difference with h = 1e-4·δ:
/// discretisation h²·f'''/6 and rounding 1e-13/1e-4 both stay below 1e-7 relative.
#[test]
fn tangent_is_slope_of_force() {
    const DISCRETISATION: f64 = 1e-7;
    for law in LAWS {
        let d = law.displacement(5e4);
        let slope = (law.force(d * 1.0001) - law.force(d * 0.9999)) / (2e-4 * d);
        assert!(relative(slope, law.tangent(5e4)) < DISCRETISATION, "{law:?}");
    }
}

/// Goal: dE/dδ = F, and for Hertz E = (2/5)·F·δ.
#[test]
fn energy_is_integral_of_force() {
    const DISCRETISATION: f64 = 1e-7;
    for law in LAWS {
        let d = law.displacement(5e4);
        let slope = (law.energy(d * 1.0001) - law.energy(d * 0.9999)) / (2e-4 * d);
        assert!(relative(slope, 5e4) < DISCRETISATION, "{law:?}");
    }
    let hertz = StiffnessLaw::hertz(1.1538e11, 0.429);
    let d = hertz.displacement(5e4);
    assert!(relative(hertz.energy(d), 0.4 * 5e4 * d) < ROUNDOFF);
}

/// Source: Hertz, F = (4/3)·E*·√R·δ^(3/2).
#[test]
fn hertz_is_sphere_on_plane() {
    let (modulus, radius) = (1.1538e11, 0.429);
    let law = StiffnessLaw::hertz(modulus, radius);
    let d: f64 = 1e-4;
    assert!(relative(law.force(d), 4.0 / 3.0 * modulus * radius.sqrt() * d.powf(1.5)) < SOLVER);
}

#[test]
fn fit_recovers_hertz() {
    let hertz = StiffnessLaw::hertz(1.1538e11, 0.429);
    let stiffness: Vec<f64> = loads().iter().map(|&f| hertz.tangent(f)).collect();
    let fit = fit_law(&loads(), &stiffness).unwrap();
    // Brent stops at 1e-12·c; a and b are some ten times as sensitive as c.
    const SEARCH: f64 = 1e-9;
    assert!((fit.law.c - 1.0 / 3.0).abs() < SEARCH, "{fit:?}");
    assert!(fit.law.a < SEARCH * hertz.b, "{fit:?}");
    assert!(relative(fit.law.b, hertz.b) < SEARCH, "{fit:?}");
    assert!(fit.max_relative_error < SEARCH);
    assert_eq!(fit.range, (1e3, 150e3));
}

#[test]
fn fit_recovers_published_constants() {
    let law = StiffnessLaw::published();
    let stiffness: Vec<f64> = loads().iter().map(|&f| law.tangent(f)).collect();
    let fit = fit_law(&loads(), &stiffness).unwrap();
    const SEARCH: f64 = 1e-8;
    assert!(relative(fit.law.a, law.a) < 10.0 * SEARCH, "{fit:?}");
    assert!(relative(fit.law.b, law.b) < SEARCH, "{fit:?}");
    assert!(relative(fit.law.c, law.c) < SEARCH, "{fit:?}");
}

/// Goal: the reported standard errors are the scatter of fits to points with 1 % noise.
/// 300 fits know their own scatter to 1/√600 = 4 %; the limit is four times that.
#[test]
fn standard_errors_match_scatter_of_fits() {
    const SAMPLING: f64 = 0.16;
    let law = StiffnessLaw { a: 2e8, b: 2e8, c: 0.3 };
    let mut noise = Noise(12345);
    let fits: Vec<LawFit> = (0..300)
        .map(|_| {
            let stiffness: Vec<f64> =
                loads().iter().map(|&f| law.tangent(f) * (1.0 + 1e-3 * noise.normal())).collect();
            fit_law(&loads(), &stiffness).unwrap()
        })
        .collect();
    let parameters: Vec<[f64; 3]> = fits.iter().map(|f| [f.law.a, f.law.b, f.law.c]).collect();
    for j in 0..3 {
        let n = fits.len() as f64;
        let mean = parameters.iter().map(|p| p[j]).sum::<f64>() / n;
        let scatter = (parameters.iter().map(|p| (p[j] - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
        let reported = (fits.iter().map(|f| f.standard_error[j].powi(2)).sum::<f64>() / n).sqrt();
        assert!(relative(reported, scatter) < SAMPLING, "parameter {j}: {reported:e} against {scatter:e}");
    }
}

#[test]
fn points_without_constant_part_are_refitted_on_the_bound() {
    // A law with a < 0 cannot be reached: a stays on its bound, and its error is 0.
    let stiffness: Vec<f64> = loads().iter().map(|&f| 3e8 * (f / REFERENCE_FORCE).powf(0.3) - 5e7).collect();
    let fit = fit_law(&loads(), &stiffness).unwrap();
    assert_eq!((fit.law.a, fit.at_bound), (0.0, [true, false, false]));
    assert_eq!(fit.standard_error[0], 0.0);
    assert!(fit.standard_error[1] > 0.0 && fit.standard_error[2] > 0.0);
}

/// Goal: stiffness that grows with almost the force itself lies beyond the largest exponent; that is said, and the
/// errors of the others are finite.
#[test]
fn an_exponent_on_its_bound_is_said() {
    let stiffness: Vec<f64> = loads().iter().map(|&f| 1e8 + 3e8 * (f / REFERENCE_FORCE).powf(1.3)).collect();
    let fit = fit_law(&loads(), &stiffness).unwrap();
    assert!(fit.at_bound[2] && fit.standard_error[2] == 0.0, "{fit:?}");
    assert!(fit.standard_error.iter().all(|e| e.is_finite()));
    let inside =
        fit_law(&loads(), &loads().iter().map(|&f| 1e8 + 3e8 * (f / 1e3).sqrt()).collect::<Vec<_>>());
    assert_eq!(inside.unwrap().at_bound, [false; 3]);
}

/// Goal: falling stiffness gets the constant with the smallest relative error (N/m), said to be on the bounds of b and c,
/// and its errors say how bad it is.
#[test]
fn falling_stiffness_is_a_constant_on_its_bounds() {
    let stiffness = [1.2e9, 1.1e9, 1.0e9, 0.9e9];
    let fit = fit_law(&[1e4, 2e4, 3e4, 4e4], &stiffness).unwrap();
    assert_eq!((fit.law.b, fit.law.c, fit.at_bound), (0.0, 0.0, [false, true, true]));
    assert!(fit.standard_error[0] > 0.0 && fit.standard_error[1..] == [0.0, 0.0], "{fit:?}");
    let cost = |a: f64| stiffness.iter().map(|k| (a / k - 1.0).powi(2)).sum::<f64>();
    assert!(cost(fit.law.a) < cost(fit.law.a * 1.001) && cost(fit.law.a) < cost(fit.law.a * 0.999));
    assert!(fit.max_relative_error > 0.1, "{fit:?}");
    assert!((fit.law.displacement(4e4) * fit.law.a / 4e4 - 1.0).abs() < 1e-12);
}

#[test]
fn fit_names_unusable_points() {
    let message = |forces: &[f64], stiffness: &[f64]| fit_law(forces, stiffness).unwrap_err().to_string();
    assert!(message(&[1.0, 2.0, 3.0], &[1.0, 2.0, 3.0]).contains("at least 4 points"));
    assert!(message(&[1.0, 2.0], &[1.0]).contains("2 forces, 1 stiffnesses"));
    assert!(message(&[1.0, -2.0, 3.0, 4.0], &[1.0; 4]).contains("law.points[1].force = -2"));
    assert!(message(&[1.0, 2.0, 3.0, 4.0], &[1.0, 1.0, f64::NAN, 1.0]).contains("law.points[2].stiffness"));
    assert!(StiffnessLaw::new(-1.0, 1.0, 0.3).is_err());
    assert!(StiffnessLaw::new(1.0, 1.0, 1.0).is_err());
    assert!(StiffnessLaw::new(f64::NAN, 1.0, 0.3).is_err());
    assert!(StiffnessLaw::new(3e7, 2.94e8, 0.24).is_ok());
}

/// Deterministic normal numbers: a linear congruential generator (Knuth's constants) and the sum of twelve.
struct Noise(u64);

impl Noise {
    fn normal(&mut self) -> f64 {
        (0..12)
            .map(|_| {
                self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                (self.0 >> 11) as f64 / (1u64 << 53) as f64
            })
            .sum::<f64>()
            - 6.0
    }
}
