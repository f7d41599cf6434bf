use super::super::{Form, SeriesLaw, StepConstants, StepLaw};
use super::*;

/// Rounding of some thousand operations, relative.
const ROUNDOFF: f64 = 1e-12;

/// Load (kN), displacement (mm) and tangent (kN/m) of the solid: an S1002 wheel of 858 mm on 60E1 at 1:40 without a shift, against the rail's section. Source:
/// `load_curve.csv` of `data/studies/uic60-s1002.toml`, calibrated with this program. The wheel begins to bear in a wider region at 4 to 6 kN.
const S1002_ON_60E1: [[f64; 3]; 24] = [
    [1.0, 0.00393016, 376124.3],
    [3.227506, 0.00871928, 548708.3],
    [6.180771, 0.01331908, 751429.0],
    [9.711498, 0.01766153, 852714.8],
    [13.737116, 0.02220092, 917288.2],
    [18.202889, 0.02692496, 976041.4],
    [23.069059, 0.0318076, 1017331.7],
    [28.305035, 0.03686629, 1055723.5],
    [33.886332, 0.04205561, 1090917.3],
    [39.792773, 0.04739442, 1126768.4],
    [46.007354, 0.05282902, 1158970.2],
    [52.515492, 0.05837194, 1190000.0],
    [59.304495, 0.06400906, 1213242.9],
    [66.363193, 0.06975168, 1244643.3],
    [73.681648, 0.07557723, 1266818.2],
    [81.250948, 0.08150886, 1288491.0],
    [89.06304, 0.08750366, 1313952.3],
    [97.1106, 0.09357878, 1334930.0],
    [105.386929, 0.09971595, 1357435.6],
    [113.885871, 0.1059308, 1378408.2],
    [122.601741, 0.11220998, 1398763.0],
    [131.529267, 0.11856586, 1411727.4],
    [140.663546, 0.12498278, 1432729.3],
    [150.0, 0.13144981, 1454196.2],
];

fn s1002() -> Vec<Solid> {
    let at = |[kilonewton, millimetre, stiffness]: [f64; 3]| Solid {
        force: 1e3 * kilonewton,
        tangent: 1e3 * stiffness,
        displacement: 1e-3 * millimetre,
    };
    S1002_ON_60E1.map(at).into()
}

fn solid_of(law: &NormalLaw) -> Vec<Solid> {
    let loads = (0..24).map(|i| 1e3 * 150f64.powf(f64::from(i) / 23.0));
    loads
        .map(|force| Solid { force, tangent: law.tangent(force), displacement: law.displacement(force) })
        .collect()
}

fn steps() -> StepConstants {
    StepConstants { b: 3.7e8, c: 0.32, step_force: 5e3, sharpness: 5.0, rise: 0.2, exponent_above: 0.2 }
}

fn laws() -> [NormalLaw; 5] {
    [
        SeriesLaw::new(4.6e8, 0.33, Some(3e9)).unwrap().into(),
        SeriesLaw::new(7e8, 0.0, None).unwrap().into(),
        StepLaw::new(steps()).unwrap().into(),
        StepLaw::new(StepConstants { sharpness: 0.7, rise: 0.0, exponent_above: 0.0, ..steps() })
            .unwrap()
            .into(),
        StepLaw::new(StepConstants { sharpness: 20.0, rise: 3.0, c: 0.9, ..steps() }).unwrap().into(),
    ]
}

fn largest(off: &[LawError]) -> [f64; 2] {
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |most: f64, off| most.max(off.abs()));
    [most(&mut off.iter().filter_map(|at| at.tangent)), most(&mut off.iter().map(|at| at.displacement))]
}

/// Goal: 1/k is the slope of the displacement and f/k that of the energy, from far below the step to far above it, and the force at a
/// displacement is the one that makes it. Accuracy: DISCRETISATION, central differences of 1e-4 of the force, whose third
/// derivative times 1e-8 is of order 20²/6·1e-8 at the sharpest step; SOLVER, the stop of the inverse.
#[test]
fn the_integrals_belong_to_the_tangent() {
    const DISCRETISATION: f64 = 1e-6;
    const SOLVER: f64 = 1e-12;
    for law in laws() {
        for force in [1e-3, 200.0, 2e3, 4.6e3, 5.3e3, 9e3, 39e3, 149e3, 4e6] {
            let step = 1e-4 * force;
            let slope = |of: &dyn Fn(f64) -> f64| (of(force + step) - of(force - step)) / (2.0 * step);
            let k = law.tangent(force);
            let of_displacement = slope(&|f| law.displacement(f)) * k - 1.0;
            let of_energy = slope(&|f| law.energy(f)) * k / force - 1.0;
            assert!(of_displacement.abs() < DISCRETISATION, "{law:?} {force}: {of_displacement}");
            assert!(of_energy.abs() < DISCRETISATION, "{law:?} {force}: {of_energy}");
            for guess in [0.0, 0.01 * force, 30.0 * force] {
                let back = law.force_from(law.displacement(force), guess);
                assert!((back / force - 1.0).abs() < SOLVER, "{law:?} {force}: {back}");
            }
        }
        assert_eq!((law.displacement(-1.0), law.energy(-1.0), law.force_from(-1.0, 1.0)), (0.0, 0.0, 0.0));
        assert!(law.tangent(f64::NAN).is_nan() && law.displacement(f64::NAN).is_nan());
    }
}

/// Goal: without a rise and with one exponent the law with a step is a power, and so is one in series with no spring; in series with a spring both compliances
/// add up. Accuracy: ROUNDOFF.
#[test]
fn each_form_has_the_power_within() {
    let power = StiffnessLaw { a: 0.0, b: 3.7e8, c: 0.32 };
    let stepped = StepLaw::new(StepConstants { rise: 0.0, exponent_above: 0.32, ..steps() }).unwrap();
    let rigid = SeriesLaw::new(power.b, power.c, None).unwrap();
    let soft = SeriesLaw::new(power.b, power.c, Some(2e9)).unwrap();
    for force in [1.0, 900.0, 4.9e3, 77e3, 1e6] {
        let near = |value: f64, exact: f64| {
            assert!((value / exact - 1.0).abs() < ROUNDOFF, "{force}: {value} {exact}")
        };
        near(stepped.tangent(force), power.tangent(force));
        near(stepped.displacement(force), power.displacement(force));
        near(stepped.energy(force), power.energy(power.displacement(force)));
        near(rigid.displacement(force), power.displacement(force));
        near(soft.displacement(force), power.displacement(force) + force / 2e9);
        near(1.0 / soft.tangent(force), 1.0 / power.tangent(force) + 1.0 / 2e9);
    }
}

/// Goal: whatever its constants, the law with a step does not fall. Accuracy: ROUNDOFF.
#[test]
fn the_law_with_a_step_rises() {
    for (rise, sharpness, c, exponent_above) in
        [(0.0, 20.0, 0.9, 0.0), (5.0, 20.0, 0.0, 0.0), (0.5, 0.5, 0.3, 0.9), (1e-3, 3.0, 0.0, 0.9)]
    {
        let law = StepLaw::new(StepConstants { rise, sharpness, c, exponent_above, ..steps() }).unwrap();
        let tangents: Vec<f64> = (0..400).map(|i| law.tangent(10f64.powf(f64::from(i) / 50.0))).collect();
        assert!(tangents.windows(2).all(|w| w[1] >= w[0] * (1.0 - ROUNDOFF)), "{rise} {sharpness}");
    }
}

/// Goal: a solid that is a law of a form is met by the fit of that form. Accuracy: SETTLED, the search ends where the sum of squares no longer falls by
/// 1e-12 of itself, which leaves residuals of its square root times those before, and the quadrature of the fit leaves 1e-9 below the first load.
#[test]
fn a_law_is_found_again() {
    const SETTLED: f64 = 1e-6;
    for law in [&laws()[0], &laws()[2]] {
        let solid = solid_of(law);
        let power = fit_law_of(&solid);
        let form = if matches!(law, NormalLaw::Series(_)) { Form::Series } else { Form::Steps };
        let fits = fit_forms(&solid, power).unwrap();
        let found = fits.iter().find(|fit| fit.law.form() == form).unwrap();
        assert!(
            largest(&found.errors).iter().all(|off| *off < SETTLED),
            "{:?} {:?}",
            found.law,
            largest(&found.errors)
        );
    }
    let NormalLaw::Steps(found) =
        &fit_forms(&solid_of(&laws()[2]), fit_law_of(&solid_of(&laws()[2]))).unwrap()[2].law
    else {
        panic!("the third form has a step")
    };
    let off = |value: f64, exact: f64| (value / exact - 1.0).abs();
    let (StepConstants { step_force, rise, c, .. }, exact) = (found.constants(), steps());
    // the constants follow from residuals of SETTLED through the least eigenvalue of the normal equations, about 1e-3
    assert!(
        off(step_force, exact.step_force) < 1e-3 && off(rise, exact.rise) < 1e-3 && off(c, exact.c) < 1e-3
    );
}

fn fit_law_of(solid: &[Solid]) -> StiffnessLaw {
    let (forces, tangents): (Vec<f64>, Vec<f64>) = solid.iter().map(|at| (at.force, at.tangent)).unzip();
    super::super::fit_law(&forces, &tangents).unwrap().law
}

/// Source: [`S1002_ON_60E1`]. Goal: at every load from 1 to 150 kN a law that is written in constants is within 1 % of tangent and displacement of the solid, the requirement;
/// the published form is 15 % and 22 % off, a power with a spring 7 and 5 %. A fit elsewhere (Nelder and Mead, apart from this code) found 0.67 and
/// 0.17 % for the step. Accuracy: a tenth of these.
#[test]
fn the_law_with_a_step_follows_s1002_on_60e1() {
    let solid = s1002();
    let fits = fit_forms(&solid, fit_law_of(&solid)).unwrap();
    let of = |form: Form| largest(&fits.iter().find(|fit| fit.law.form() == form).unwrap().errors);
    let near = |form: Form, expected: [f64; 2]| {
        let found = of(form);
        for n in 0..2 {
            assert!((found[n] / expected[n] - 1.0).abs() < 0.1, "{form:?}: {found:?}");
        }
    };
    near(Form::Power, [0.152, 0.216]);
    near(Form::Series, [0.071, 0.042]);
    near(Form::Steps, [0.0067, 0.0017]);
    let steps = of(Form::Steps);
    assert!(steps.iter().all(|off| *off < 0.01), "{steps:?}");
    // the table has the tangents themselves, and what lies between two loads of the step it does not know
    let table = of(Form::Table);
    assert!(table[1] < 0.02 && table[0] > 0.05, "{table:?}");
    let first = fits.last().unwrap().errors[0];
    assert!(
        first.displacement.abs() < ROUNDOFF && first.tangent.is_none(),
        "the table begins with the displacement of the solid: {first:?}"
    );
}

/// Goal: stiffness that falls with the force gets the best constant of every form but the table, and few loads no law with a step.
#[test]
fn stiffness_that_falls_is_a_constant() {
    let falling: Vec<Solid> = (1..=9)
        .map(|i| {
            let force = 2e4 * f64::from(i);
            Solid {
                force,
                tangent: 1e9 * (1.0 - 1e-6 * force),
                displacement: -1e-3 * (1.0 - 1e-6 * force).ln(),
            }
        })
        .collect();
    let fits = fit_forms(&falling, fit_law_of(&falling)).unwrap();
    let constant = |law: &NormalLaw| law.tangent(1e3) / law.tangent(180e3) - 1.0;
    for fit in fits.iter().filter(|fit| fit.law.form() != Form::Table) {
        assert!(constant(&fit.law).abs() < 1e-2, "{:?}", fit.law);
    }
    let few = fit_forms(&falling[..7], fit_law_of(&falling[..7])).unwrap();
    assert_eq!(
        few.iter().map(|fit| fit.law.form()).collect::<Vec<_>>(),
        [Form::Power, Form::Series, Form::Table]
    );
}

/// Goal: constants that are no law are refused, with the key and what a law has.
#[test]
fn what_is_no_law_is_refused() {
    for wrong in [
        StepConstants { b: 0.0, ..steps() },
        StepConstants { c: 1.0, ..steps() },
        StepConstants { exponent_above: -0.1, ..steps() },
        StepConstants { rise: -0.1, ..steps() },
        StepConstants { sharpness: 0.4, ..steps() },
        StepConstants { step_force: f64::NAN, ..steps() },
    ] {
        let said = StepLaw::new(wrong).unwrap_err().to_string();
        assert!(said.starts_with("law =") && said.contains("0.5 ≤ p ≤ 20"), "{said}");
    }
    for (b, c, s) in [(-1.0, 0.3, None), (1e8, 1.0, None), (1e8, 0.3, Some(0.0)), (1e8, 0.3, Some(f64::NAN))]
    {
        assert!(SeriesLaw::new(b, c, s).is_err(), "{b} {c} {s:?}");
    }
    let few = vec![Solid { force: 1.0, tangent: 1.0, displacement: 1.0 }; 3];
    assert!(fit_series(&few).is_err() && fit_steps(&few).is_err());
}
