//! The loads that are put on: those of the tables, and those on the flange.

use std::sync::atomic::{AtomicUsize, Ordering};

use railspring_calibrate::calibration::{LoadPoint, PatchValues, WheelOnRail, load_points, press_loads};
use railspring_calibrate::pair::PressDirection;
use railspring_profiles::error::Result;
use railspring_profiles::monitor::{Monitor, Silent};
use rayon::prelude::*;

use super::bodies::{Pairs, PressedOn};
use super::facts::{Case, Values};
use super::record::{Compared, OnFlange};

/// The first load and the largest ratio of two loads, N: the bodies' share of the approach is integrated over the loads.
const FIRST_LOAD: f64 = 0.5e3;
const RATIO: f64 = 1.3;
/// Shifts at which the flange of S1002 touches UIC60 and 54E1, mm, and normal forces there, N.
const FLANGE_SHIFTS: [f64; 4] = [6.5, 7.0, 7.5, 8.0];
const NORMAL_FORCES: [f64; 6] = [20e3, 40e3, 60e3, 80e3, 100e3, 120e3];

/// How many places were begun.
struct Count {
    stage: &'static str,
    begun: AtomicUsize,
    all: usize,
}

impl Count {
    fn of(stage: &'static str, all: usize) -> Self {
        Self { stage, begun: AtomicUsize::new(0), all }
    }

    /// One more begins.
    ///
    /// # Errors
    /// An interruption.
    fn add(&self, monitor: &dyn Monitor) -> Result<()> {
        monitor.progress(self.stage, self.begun.fetch_add(1, Ordering::Relaxed), self.all)
    }
}

/// The loads with others between them, ascending.
fn filled(loads: &[f64]) -> Vec<f64> {
    let mut filled = Vec::new();
    let mut last = FIRST_LOAD / RATIO;
    for &load in loads {
        let steps = ((load / last).ln() / RATIO.ln()).ceil().max(1.0) as i32;
        let between = (1..steps).map(|step| last * (load / last).powf(f64::from(step) / f64::from(steps)));
        filled.extend(between.chain([load]));
        last = load;
    }
    filled
}

/// The values at every one of the `loads` (N), in the units of the tables.
fn found(placed: &WheelOnRail, on: PressedOn, loads: &[f64]) -> Result<Vec<Values>> {
    let all = filled(loads);
    let states = press_loads(placed, &all, "half-space comparison", &Silent)?;
    let points = load_points(placed, &states, on.reference())?;
    let wanted = states.iter().zip(&points).filter(|(state, _)| loads.contains(&state.load));
    wanted.map(|(state, point)| Ok(values(point, &placed.patch(state)?.values))).collect()
}

fn values(point: &LoadPoint, patch: &PatchValues) -> Values {
    [point.displacement * 1e3, point.solid_tangent * 1e-6, patch.area * 1e6, patch.max_pressure * 1e-6]
}

/// A row for every load of the cases of a pair, in their order.
///
/// # Errors
/// A load that is not carried, an interruption.
pub fn against_tables(pairs: &Pairs, cases: &[&Case], monitor: &dyn Monitor) -> Result<Vec<Compared>> {
    let count = Count::of("places", cases.len());
    let of_case = |case: &&Case| -> Result<Vec<Compared>> {
        let loads: Vec<f64> = case.loads.iter().map(|(load, _)| load * 1e3).collect();
        let press = |on: PressedOn| found(&pairs.at(case.shift_mm, on)?.wheel_on_rail()?, on, &loads);
        count.add(monitor)?;
        let pressed = PressedOn::ALL.into_iter().map(press).collect::<Result<Vec<_>>>()?;
        let row = |(n, (load_kn, tables)): (usize, &(f64, Values))| Compared {
            rail: case.rail.clone(),
            wheel: case.wheel.clone(),
            shift_mm: case.shift_mm,
            load_kn: *load_kn,
            tables: *tables,
            found: PressedOn::ALL.map(|on| pressed[on.index()][n]),
        };
        Ok(case.loads.iter().enumerate().map(row).collect())
    };
    let rows = cases.par_iter().map(of_case).collect::<Result<Vec<_>>>()?;
    Ok(rows.into_iter().flatten().collect())
}

/// The flange, by the normal force: half-spaces along the normal and downwards, stiff and flexible bodies along the normal.
///
/// # Errors
/// As [`against_tables`].
pub fn on_the_flange(pairs: &Pairs, monitor: &dyn Monitor) -> Result<Vec<OnFlange>> {
    let count = Count::of("flange", FLANGE_SHIFTS.len());
    let at_shift = |&shift_mm: &f64| -> Result<Vec<OnFlange>> {
        count.add(monitor)?;
        let mut angle = 0.0;
        let mut press = |on: PressedOn, direction: PressDirection| -> Result<Vec<Values>> {
            let place = pairs.at(shift_mm, on)?;
            let normal = PressDirection::Normal.at(&place.pair);
            let along = direction.at(&place.pair);
            angle = place.pair.touch.contact_angle;
            let share = normal.dot(&along);
            let loads = NORMAL_FORCES.map(|force| force * share);
            let placed = WheelOnRail { along, ..place.wheel_on_rail()? };
            let found = found(&placed, on, &loads)?;
            // a hub that moves by w along a direction closes the gap by w times its share along the normal
            let turned = |[approach, tangent, area, pressure]: Values| {
                [approach * share, tangent / (share * share), area, pressure]
            };
            Ok(found.into_iter().map(turned).collect())
        };
        let half_spaces = press(PressedOn::HalfSpaces, PressDirection::Normal)?;
        let downwards = press(PressedOn::HalfSpaces, PressDirection::Vertical)?;
        let stiff = press(PressedOn::Stiff, PressDirection::Normal)?;
        let flexible = press(PressedOn::Flexible, PressDirection::Normal)?;
        let row = |n: usize| OnFlange {
            rail: pairs.rail.clone(),
            wheel: pairs.wheel.clone(),
            shift_mm,
            angle_deg: angle.to_degrees(),
            normal_kn: NORMAL_FORCES[n] * 1e-3,
            half_spaces: half_spaces[n],
            downwards: downwards[n],
            stiff: stiff[n],
            flexible: flexible[n],
        };
        Ok((0..NORMAL_FORCES.len()).map(row).collect())
    };
    let rows = FLANGE_SHIFTS.par_iter().map(at_shift).collect::<Result<Vec<_>>>()?;
    Ok(rows.into_iter().flatten().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: no load is more than the ratio away from the one before, the first within it of the least, and all given ones are there. Accuracy:
    /// ROUNDOFF of powers.
    #[test]
    fn loads_are_filled() {
        const ROUNDOFF: f64 = 1e-12;
        let given = [5e3, 5.2e3, 160e3];
        let all = filled(&given);
        assert!(all[0] <= FIRST_LOAD * (1.0 + ROUNDOFF));
        assert!(all.windows(2).all(|w| w[1] > w[0] && w[1] / w[0] <= RATIO * (1.0 + ROUNDOFF)));
        assert!(given.iter().all(|load| all.contains(load)));
    }
}
