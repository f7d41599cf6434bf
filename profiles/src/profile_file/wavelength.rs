//! How long the waves are that smoothing by the scatter halves.
//!
//! **What scatter does.** A wave of the wave number q and the amplitude A that a contact presses flat changes its pressure
//! by E*·q·A/2 (E* = 115 GPa of steel on steel). White scatter σ of points at the distance h has the density σ²·h/π over
//! q > 0. The smoothing spline that halves waves of the length λ = 2π/q₀ leaves 1/(1 + (q/q₀)⁴) of a wave. So the pressure is
//! off by the root mean square
//!
//! p = (E*/2)·√(σ²·h/π · ∫ q²/(1 + (q/q₀)⁴)² dq) = 0.2973·(E*/2)·σ·√h·q₀^1.5,
//!
//! where the integral is π√2/16·q₀³. For σ = 2 µm, h = 0.25 mm and λ = 3 mm that is 52 MPa, and 830 MPa without
//! smoothing ((E*/2)·σ·π/(√3·h)), where the pressure of a wheel on a rail is 1000 MPa.
//!
//! **What smoothing does.** An arc of the radius R moves by 1/(q₀⁴·R³): with λ = 6 mm and R = 13 mm by 0.4 µm. A curvature
//! that jumps by Δκ is spread over some λ/4, which changes the pressure beside the joint by
//!
//! p = (E*/2)·Δκ/q₀ · max over ξ of (1/π)·∫ x²/(1 + x⁴)·sin(ξx) dx = 0.187·(E*/2)·Δκ/q₀.
//!
//! **The choice.** The shorter one of two. With the first wave scatter leaves 40 MPa on each body, hence 57 MPa, and 85 at most places of
//! a patch, under both. With the second the squares of both pressures have their least sum where the crown of a rail goes
//! from 300 to 80 mm of radius, which is where q₀⁵ = ⅔·(0.187·Δκ)²/(0.2973²·σ²·h). For points 0.25 mm apart:
//!
//! | scatter σ | 0.2 µm | 0.5 µm | 1 µm | 2 µm | 5 µm | 10 µm |
//! |---|---|---|---|---|---|---|
//! | λ of the first, mm | 0.77 | 1.4 | 2.3 | 3.6 | 6.6 | 10.5 |
//! | λ of the second, mm | 1.4 | 1.9 | 2.6 | 3.4 | 4.9 | 6.4 |
//! | left by the scatter, MPa | 40 | 40 | 40 | 43 | 63 | 83 |
//! | by smoothing, at that joint, MPa | 12 | 22 | 35 | 53 | 77 | 101 |
//! | an arc of 13 mm moves by, µm | 0.0001 | 0.001 | 0.007 | 0.04 | 0.2 | 0.5 |
//!
//! Waves shorter than two points are none, and scatter below 0.1 µm (42 MPa at this distance without smoothing) is that of
//! drawn files. Points more than 1.5 mm apart do not tell scatter from shape.

use std::f64::consts::TAU;

use super::scatter::Scatter;
use crate::units::MILLIMETRE;

/// Part of the pressure over E*/2 by the scatter that is left, over √(σ²·h)·q₀^1.5: √(√2/16).
const BY_SCATTER: f64 = 0.2973;
/// The same by smoothing a jump of curvature, over Δκ/q₀.
const BY_SMOOTHING: f64 = 0.187;
/// Pressure that scatter may leave on one body, over E*/2: 40 MPa over 115.4 GPa/2.
const LEFT: f64 = 40e6 / 57.7e9;
/// The jump of curvature on the crown of a rail, 1/m.
const JUMP: f64 = 1.0 / 0.080 - 1.0 / 0.300;
/// Scatter below which a file is drawn, m.
const DRAWN: f64 = 1e-7;
/// Distance of the points (m) from which their differences tell scatter and shape no longer apart.
const COARSE: f64 = 1.5 * MILLIMETRE;

/// Wavelength (m) that smoothing by the scatter halves; `None` where nothing is to be smoothed.
pub(super) fn wavelength(scatter: &Scatter) -> Option<f64> {
    if scatter.deviation < DRAWN || scatter.step > COARSE {
        return None;
    }
    let enough = TAU / (LEFT / strength(scatter)).powf(2.0 / 3.0);
    let wavelength = enough.min(balanced(scatter, JUMP));
    (wavelength > 2.0 * scatter.step).then_some(wavelength)
}

/// Wavelength (m) with which the squares of the pressures by the scatter and by smoothing a `jump` of curvature (1/m) have their least sum.
pub(super) fn balanced(scatter: &Scatter, jump: f64) -> f64 {
    TAU / (2.0 / 3.0 * (BY_SMOOTHING * jump / strength(scatter)).powi(2)).powf(0.2)
}

/// Pressure by the scatter that is left, over E*/2·q₀^1.5.
fn strength(scatter: &Scatter) -> f64 {
    BY_SCATTER * scatter.density.sqrt()
}
