//! Left and right wheel of an axle: which cases go together, and how the wheelset of both runs.

use std::collections::BTreeMap;

use railspring_profiles::rigid_contact::{RunningFunction, RunningPoint};
use railspring_profiles::units::MILLIMETRE;
use serde_json::Value;

use super::cases::{Case, Table};
use super::made::Made;
use super::surfaces::{AMPLITUDES_MM, running_shifts};

/// Equivalent conicity of an axle at the amplitudes of the columns; none where it does not swing about a shift in the range.
pub(super) type AxleConicity = [Option<f64>; AMPLITUDES_MM.len()];

/// Those of the axles whose two wheels were measured, by the numbers of the cases.
pub(super) fn conicities(table: &Table, made: &Made<'_>) -> BTreeMap<usize, AxleConicity> {
    // the first place of a case stands for all
    let mut radii: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for at in made.places() {
        let (place, wheel) = (at.place, at.measured().filter(|measured| measured.wheel.is_some()));
        if let (Some(measured), false) = (wheel, radii.contains_key(&place.case)) {
            let radius = 0.5 * table.cases[place.case].study.wheel.tape_diameter;
            let of_case = measured.rolling_radii_mm.iter().map(|below| radius + below * MILLIMETRE);
            radii.insert(place.case, of_case.collect());
        }
    }
    let mut axles: BTreeMap<Vec<String>, [Vec<usize>; 2]> = BTreeMap::new();
    for &number in radii.keys() {
        if let Some((axle, side)) = axle(&table.cases[number]) {
            axles.entry(axle).or_default()[side].push(number);
        }
    }
    let mut found = BTreeMap::new();
    for [left, right] in axles.values() {
        // several of a side and of a day cannot be told apart
        if let ([left], [right]) = (&left[..], &right[..]) {
            let conicity = conicity(&radii[left], &radii[right]);
            found.extend([(*left, conicity), (*right, conicity)]);
        }
    }
    found
}

/// What two wheels of an axle have in common (vehicle, axle, date, the rail and all that is varied), and the side of one: 0 left, 1 right.
fn axle(case: &Case) -> Option<(Vec<String>, usize)> {
    let [of_wheel, _] = &case.metadata;
    let text = |name: &str| of_wheel.get(name).map(text);
    let side = side(&text("side").or_else(|| text("wheel"))?)?;
    let mut common =
        vec![text("vehicle")?, text("axle")?, text("date").unwrap_or_default(), case.rail.clone()];
    common.push(case.study.wheel.tape_diameter.to_string());
    common.extend(case.varied.values().map(Value::to_string));
    Some((common, side))
}

fn text(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// 0 for left and 1 for right, by the first letter.
pub(super) fn side(text: &str) -> Option<usize> {
    match text.trim().to_lowercase().chars().next()? {
        'l' => Some(0),
        'r' => Some(1),
        _ => None,
    }
}

/// The conicity of a wheelset by the rolling radii of its two wheels, m, each at shifts towards its own rail.
fn conicity(left: &[f64], right: &[f64]) -> AxleConicity {
    let points = running_shifts().into_iter().zip(right.iter().zip(left.iter().rev()));
    let points = points.map(|(shift, (right, left))| RunningPoint { shift, difference: right - left });
    let running = RunningFunction::from_points(points.collect());
    AMPLITUDES_MM.map(|mm| running.as_ref().ok()?.equivalent_conicity(mm * MILLIMETRE))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: sides by their first letter, also in German.
    #[test]
    fn sides_of_an_axle() {
        assert_eq!(
            ["left", "R", " Links", "rechts", "2", ""].map(side),
            [Some(0), Some(1), Some(0), Some(1), None, None]
        );
    }

    /// Source: cones: a wheel of the slope γ rolls on r + γ·s at the shift s towards its rail, so that the axle has the mean of both slopes, about the shift
    /// where both radii are equal. Goal: that at every amplitude, whichever wheel is larger. Accuracy: ROUNDOFF.
    #[test]
    fn cones_of_two_slopes_have_their_mean() {
        const ROUNDOFF: f64 = 1e-9;
        let cone = |slope: f64, more: f64| -> Vec<f64> {
            running_shifts().into_iter().map(|shift| 0.46 + more + slope * shift).collect()
        };
        for more in [0.0, 0.1e-3, -0.1e-3] {
            for conicity in conicity(&cone(0.1, 0.0), &cone(0.3, more)) {
                assert!((conicity.unwrap() - 0.2).abs() < ROUNDOFF, "{more}: {conicity:?}");
            }
        }
    }
}
