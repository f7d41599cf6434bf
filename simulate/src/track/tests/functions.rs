//! Functions of time and place.

use std::f64::consts::{PI, TAU};

use super::*;

const ROUNDOFF: f64 = 1e-12;

/// Source: integrals by hand. Goal: the way (m) of a speed that rises, stays and falls, before, between and beyond its times.
#[test]
fn a_way_is_the_integral_of_its_speeds() {
    let way = Way::new(2.0, &[(0.0, 0.0), (2.0, 10.0), (4.0, 10.0), (5.0, 0.0)]);
    for (time, x) in [
        (0.0, 2.0),
        (1.0, 4.5),
        (2.0, 12.0),
        (3.0, 22.0),
        (4.0, 32.0),
        (4.5, 35.75),
        (5.0, 37.0),
        (9.0, 37.0),
    ] {
        assert!((way.x(time) - x).abs() < ROUNDOFF * 40.0, "{time}: {}", way.x(time));
    }
    assert_eq!(way.fastest(), 10.0);
    assert!((Way::uniform(0.0, 25.0, 10.0, 2.0).x(1.5) - 48.75).abs() < ROUNDOFF * 50.0);
}

/// Source: a natural spline of a cubic without curvature at its ends is the cubic. Goal: heights (m) of x³ − 3x over −1.. with second derivatives that vanish at x = 0: samples from 0 to
/// 0 give zeros; a sine over whole half waves within the spline's error h⁴·5/384.
#[test]
fn a_spline_goes_through_its_samples() {
    let samples: Vec<(f64, f64)> =
        (0..=40).map(|i| f64::from(i) * 0.05).map(|x| (x, (PI * x).sin())).collect();
    let Irregularity::Samples(_) = Irregularity::through(&samples) else { panic!() };
    let spline = Irregularity::through(&samples);
    for i in 0..400 {
        let x = f64::from(i) * 0.005;
        let bound = 5.0 / 384.0 * (PI * 0.05_f64).powi(4) * 1.1;
        assert!((spline.height(x) - (PI * x).sin()).abs() < bound, "{x}");
    }
    assert_eq!((spline.height(-1.0), spline.height(0.5)), (0.0, 1.0));
}

/// Source: Parseval. Goal: the variance (m²) of the waves of a spectrum is its integral; the same seed gives the same bits, another others. ROUNDOFF; the variance is that over many waves, MODEL 2 %.
#[test]
fn waves_have_the_variance_of_their_spectrum() {
    let spectrum = Spectrum {
        amplitude: 4.032e-7,
        cutoff: 0.8246,
        rolloff: 0.0206,
        waves: [2.0, 50.0],
        components: 400,
        seed: 7,
    };
    let Irregularity::Waves(waves) = spectrum.waves() else { panic!() };
    let variance: f64 = waves.iter().map(|[_, a, _]| 0.5 * a * a).sum();
    let (from, to, count) = (TAU / 50.0, TAU / 2.0, 100_000);
    let width = (to - from) / f64::from(count);
    let integral: f64 =
        (0..count).map(|i| spectrum.density(from + (f64::from(i) + 0.5) * width) * width).sum();
    assert!((variance / integral - 1.0).abs() < 2e-3, "{variance:e} {integral:e}");
    let all = spectrum.waves();
    let count = 200_000;
    let seen: f64 =
        (0..count).map(|i| all.height(f64::from(i) * 0.1).powi(2)).sum::<f64>() / f64::from(count);
    assert!((seen / integral - 1.0).abs() < 0.02, "{seen:e} {integral:e}");
    assert_eq!(all, spectrum.waves());
    assert_ne!(all, Spectrum { seed: 8, ..spectrum }.waves());
}

/// Goal: depths (m) of a dipped joint and of a flat: at their middle, at their ends and round the wheel; the drop is what misses on the wheel less the height of the rail.
#[test]
fn dips_and_flats_have_their_depths() {
    let dip = Irregularity::Dip { at: 5.0, depth: 2e-3, half_length: 1.0 };
    assert_eq!([4.0, 4.5, 5.0, 5.5, 6.5].map(|x| dip.height(x)), [0.0, -0.5e-3, -2e-3, -0.5e-3, 0.0]);
    let flat = Irregularity::Flat { circumference: 3.0, first: 1.0, length: 0.06, depth: 1e-3 };
    let depths = [1.0, 4.0, 1.015, 3.985, 1.03, 2.5].map(|x| flat.height(x));
    for (found, expected) in depths.iter().zip([1e-3, 1e-3, 0.5e-3, 0.5e-3, 0.0, 0.0]) {
        assert!((found - expected).abs() < ROUNDOFF, "{found} {expected}");
    }
    let both = Unevenness { rail: vec![dip], wheel: vec![flat] };
    assert!((both.drop(4.0) - 1e-3).abs() < ROUNDOFF && (both.drop(5.0) - 2e-3).abs() < ROUNDOFF);
}
