//! Fit of two power laws with a step between.
//!
//! Least squares of tangents and displacements, both relative at each load, by Levenberg and Marquardt (D.W. Marquardt, J. SIAM 11
//! (1963)) inside bounds, from several forces of the step. The tangents alone leave the law below the first load open; the displacement
//! there is what tells its exponent.

use nalgebra::{SMatrix, SVector};

use super::points::{Solid, check_solid};
use super::power::{LARGEST_EXPONENT, REFERENCE_FORCE};
use super::steps::{StepConstants, StepLaw};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::quadrature::GAUSS_12;

/// Fewer loads than that leave fewer than two values for each of the six constants and a remainder.
pub const LEAST_LOADS_OF_STEPS: usize = 8;

/// Number of constants.
const CONSTANTS: usize = 6;

/// The constants as they are searched: ln b, c, e, ln(1 + d), ln f1/f0, ln p.
type Place = SVector<f64, CONSTANTS>;

/// Squares, half the gradient of their sum, and the matrix of the normal equations.
struct Normal {
    squares: f64,
    gradient: Place,
    matrix: SMatrix<f64, CONSTANTS, CONSTANTS>,
}

/// Fits the law to the solid at its loads, eight at least.
///
/// # Errors
/// [`InputError`] for fewer points, values that are not positive and finite, and forces that do not ascend.
pub fn fit_steps(solid: &[Solid]) -> Result<StepLaw> {
    check_solid(solid)?;
    if solid.len() < LEAST_LOADS_OF_STEPS {
        return InputError::refuse(
            "law.points",
            solid.len(),
            format!("at least {LEAST_LOADS_OF_STEPS} points for the six constants"),
            "calibrate at more loads",
        );
    }
    let (first, last) = (logarithm(&solid[0]), logarithm(&solid[solid.len() - 1]));
    // a step narrower than the loads are apart is not seen
    let bounds = [
        Place::from([-60.0, 0.0, 0.0, 0.0, first, 0.5_f64.ln()]),
        Place::from([60.0, LARGEST_EXPONENT, LARGEST_EXPONENT, 2.0, last, 10.0_f64.ln()]),
    ];
    let starts = [0.2, 0.35, 0.5, 0.75].map(|part| {
        let step = first + part * (last - first);
        let middle = &solid[solid.partition_point(|at| logarithm(at) < step).min(solid.len() - 1)];
        let b = middle.tangent.ln() - 0.3 * logarithm(middle);
        Place::from([b, 0.3, 0.25, 0.1, step, 3.0_f64.ln()])
    });
    let found = starts.map(|start| search(solid, start, &bounds));
    // the first of equals
    let best = found.iter().fold(&found[0], |best, next| if next.1 < best.1 { next } else { best });
    StepLaw::new(constants(&best.0))
}

fn logarithm(at: &Solid) -> f64 {
    (at.force / REFERENCE_FORCE).ln()
}

fn constants(place: &Place) -> StepConstants {
    StepConstants {
        b: place[0].exp(),
        c: place[1],
        exponent_above: place[2],
        rise: place[3].exp_m1(),
        step_force: REFERENCE_FORCE * place[4].exp(),
        sharpness: place[5].exp(),
    }
}

/// The place that a search from `start` ends at, with its sum of squares.
fn search(solid: &[Solid], start: Place, bounds: &[Place; 2]) -> (Place, f64) {
    const STEPS: usize = 200;
    let within = |place: Place| place.sup(&bounds[0]).inf(&bounds[1]);
    let mut place = within(start);
    let mut normal = equations(solid, &place);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let Some(step) = step(&normal, &place, bounds, damping) else { break };
        let next = within(place + step);
        let there = equations(solid, &next);
        if !(there.squares < normal.squares) {
            damping *= 4.0;
            if damping > 1e12 {
                break;
            }
            continue;
        }
        let settled = normal.squares - there.squares <= 1e-12 * normal.squares;
        (place, normal) = (next, there);
        damping = (0.25 * damping).max(1e-12);
        if settled {
            break;
        }
    }
    (place, normal.squares)
}

/// The step of damped normal equations; a constant on its bound that would leave it stays.
fn step(normal: &Normal, place: &Place, bounds: &[Place; 2], damping: f64) -> Option<Place> {
    let mut matrix = normal.matrix;
    let mut right = -normal.gradient;
    for i in 0..CONSTANTS {
        let held =
            (place[i] <= bounds[0][i] && right[i] < 0.0) || (place[i] >= bounds[1][i] && right[i] > 0.0);
        // a constant without influence, as the sharpness of no step, stays as well
        if held || matrix[(i, i)] <= 0.0 {
            matrix.fill_row(i, 0.0);
            matrix.fill_column(i, 0.0);
            matrix[(i, i)] = 1.0;
            right[i] = 0.0;
        } else {
            matrix[(i, i)] *= 1.0 + damping;
        }
    }
    matrix.cholesky().map(|factor| factor.solve(&right))
}

/// The normal equations of all residuals at a place.
fn equations(solid: &[Solid], place: &Place) -> Normal {
    let of = constants(place);
    let mut normal = Normal { squares: 0.0, gradient: Place::zeros(), matrix: SMatrix::zeros() };
    let mut add = |residual: f64, slope: Place| {
        normal.squares += residual * residual;
        normal.gradient += slope * residual;
        normal.matrix += slope * slope.transpose();
    };
    // the integrand f/k over ln f with its slopes
    let integrand = |x: f64| {
        let (stiffness, slope) = logarithm_and_slope(&of, x);
        let value = REFERENCE_FORCE * (x - stiffness).exp();
        (value, slope * -value)
    };
    /// So far below the first load, in ln f, the law is taken as a power.
    const BELOW: f64 = 12.0;
    const PANEL: f64 = 0.5;
    let mut from = logarithm(&solid[0]) - BELOW;
    let exponent = slope_of_stiffness(&of, from);
    let (mut displacement, mut slope) = integrand(from);
    displacement /= 1.0 - exponent;
    slope /= 1.0 - exponent;
    for at in solid {
        let to = logarithm(at);
        let panels = ((to - from) / PANEL).ceil().max(1.0);
        let half = 0.5 * (to - from) / panels;
        for i in 0..panels as usize {
            for (t, weight) in GAUSS_12 {
                let (value, of_value) = integrand(from + half * (2.0 * i as f64 + 1.0 + t));
                displacement += half * weight * value;
                slope += of_value * (half * weight);
            }
        }
        from = to;
        let (stiffness, of_stiffness) = logarithm_and_slope(&of, to);
        let ratio = stiffness.exp() / at.tangent;
        add(ratio - 1.0, of_stiffness * ratio);
        add(displacement / at.displacement - 1.0, slope / at.displacement);
    }
    normal
}

/// ln k at ln(f/f0), and how it changes with each constant.
fn logarithm_and_slope(of: &StepConstants, x: f64) -> (f64, Place) {
    let local = of.local(x);
    let difference = of.exponent_above - of.c;
    let stepped = 1.0 + of.rise * local.part;
    // how the step's share changes with p·ln(f/f1)
    let change = of.rise * local.part * (1.0 - local.part) / stepped;
    let slope = Place::from([
        1.0,
        local.x - local.bend / of.sharpness,
        local.bend / of.sharpness,
        (1.0 + of.rise) * local.part / stepped,
        -difference * local.part - of.sharpness * change,
        (difference * (local.part * local.beyond - local.bend / of.sharpness))
            + of.sharpness * change * local.beyond,
    ]);
    (local.stiffness, slope)
}

/// d ln k / d ln f at ln(f/f0).
fn slope_of_stiffness(of: &StepConstants, x: f64) -> f64 {
    let local = of.local(x);
    let change = of.rise * local.part * (1.0 - local.part) / (1.0 + of.rise * local.part);
    of.c + (of.exponent_above - of.c) * local.part + of.sharpness * change
}
