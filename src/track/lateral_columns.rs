//! The columns of `history.csv` of a wheelset across the track.

use railspring_profiles::units::{KILONEWTON, MILLIMETRE};
use railspring_simulate::track::{AcrossCase, AcrossRow, AcrossRun, RailSeen, WheelAcross};

use super::columns::TrackColumn;
use crate::verify::{RatioAlong, WINDOW, low_passed};

/// A milliradian, rad.
const MILLIRADIAN: f64 = 1e-3;

/// A number where there is one.
fn only(value: f64, there: bool) -> f64 {
    if there { value } else { f64::NAN }
}

/// All columns of a run.
pub(super) fn lateral_columns(case: &AcrossCase, run: &AcrossRun) -> Vec<TrackColumn> {
    let column = |name: &str, text: &str, value: &dyn Fn(&AcrossRow) -> f64| {
        TrackColumn::of(&run.rows, name, text, value)
    };
    let mut columns = vec![
        column("time_s", "Time, s", &|row| row.time),
        column("x_m", "Place of the wheels, m from the rail's first end", &|row| row.x),
        column("wheelset_y_mm", "Displacement of the wheelset, mm, positive to the right", &|row| {
            row.axle[0] / MILLIMETRE
        }),
        column("wheelset_z_mm", "Displacement of the wheelset, mm, positive down", &|row| {
            row.axle[1] / MILLIMETRE
        }),
        column("wheelset_roll_mrad", "Roll of the wheelset, mrad, positive lowers the right wheel", &|row| {
            row.axle[2] / MILLIRADIAN
        }),
    ];
    if case.wheelset.above > 0.0 {
        let above = |row: &AcrossRow, at: usize| row.above.map_or(f64::NAN, |above| above[at]);
        columns.extend([
            column(
                "suspended_y_mm",
                "Displacement of the suspended mass, mm, positive to the right",
                &|row| above(row, 0) / MILLIMETRE,
            ),
            column("suspended_z_mm", "Displacement of the suspended mass, mm, positive down", &|row| {
                above(row, 1) / MILLIMETRE
            }),
            column(
                "suspended_roll_mrad",
                "Roll of the suspended mass, mrad, positive lowers its right side",
                &|row| above(row, 2) / MILLIRADIAN,
            ),
            column(
                "suspended_lateral_acceleration_m_per_s2",
                "Acceleration of the suspended mass with that of the ground, m/s², positive to the right",
                &|row| row.above_acceleration[0],
            ),
            column(
                "suspended_acceleration_m_per_s2",
                "Acceleration of the suspended mass with that of the ground, m/s², positive down",
                &|row| row.above_acceleration[1],
            ),
        ]);
        for (wheel, side) in ["right", "left"].into_iter().enumerate() {
            columns.extend([
                column(
                    &format!("{side}_suspension_y_kn"),
                    "Lateral force of the suspension on the wheelset, kN, positive to the right along the axle",
                    &|row| row.suspension[wheel][0] / KILONEWTON,
                ),
                column(
                    &format!("{side}_suspension_z_kn"),
                    "Vertical force of the suspension on the wheelset, kN, positive down across the axle",
                    &|row| row.suspension[wheel][1] / KILONEWTON,
                ),
            ]);
        }
    }
    for (wheel, side) in ["right", "left"].into_iter().enumerate() {
        let mut of = |name: &str, text: &str, value: &dyn Fn(&WheelAcross) -> f64| {
            columns.push(column(&format!("{side}_{name}"), text, &|row| value(&row.wheels[wheel])));
        };
        let [p, q] = [|w: &WheelAcross| w.contact.vertical_force, |w: &WheelAcross| w.contact.lateral_force];
        of("p_kn", "Vertical force P of the wheel on the rail, kN, positive down", &|w| p(w) / KILONEWTON);
        of("q_kn", "Lateral force Q of the wheel on the rail, kN, positive to its field side", &|w| {
            q(w) / KILONEWTON
        });
        of("q_over_p", "Q/P; empty where P is not positive", &|w| only(q(w) / p(w), p(w) > 0.0));
        let first = run.rows.first().map_or(f64::NAN, |row| p(&row.wheels[wheel]));
        of("unloading", "Wheel unloading, the share of the P at the start that is lacking", &|w| {
            only(1.0 - p(w) / first, first > 0.0)
        });
        of("contacts", "Number of contacts", &|w| w.contact.contacts.len() as f64);
        of(
            "flange_tip_mm",
            "Height of the flange's tip above the rail's top, mm; negative while it guides",
            &|w| w.contact.tip_height / MILLIMETRE,
        );
        of("rail_y_mm", "Displacement of the rail under the wheel, mm, positive to its field side", &|w| {
            w.rail[0] / MILLIMETRE
        });
        of("rail_z_mm", "Displacement of the rail under the wheel, mm, positive down", &|w| {
            w.rail[1] / MILLIMETRE
        });
        of(
            "rail_twist_mrad",
            "Rotation of the rail under the wheel, mrad, positive tilts the head to its field side",
            &|w| w.rail[2] / MILLIRADIAN,
        );
        columns.push(TrackColumn {
            name: format!("{side}_q_over_p_2m"),
            text: "Q/P of forces below 20 Hz, mean over the last 2 m (EN 14363); empty before, and where P is not positive in them".into(),
            values: mean_ratios(run, wheel),
        });
    }
    for (index, probe) in case.probes.iter().enumerate() {
        let mut of = |name: &str, text: &str, value: &dyn Fn(&RailSeen) -> f64| {
            let name = format!("{}_{name}", probe.name);
            columns.push(column(&name, text, &|row| value(&row.probes[index])));
        };
        of("deflection_mm", "Deflection at the probe against the ground, mm, positive down", &|p| {
            p.displacement[1] / MILLIMETRE
        });
        of("lateral_mm", "Lateral displacement of the rail there, mm, positive to its field side", &|p| {
            p.displacement[0] / MILLIMETRE
        });
        of("twist_mrad", "Rotation there, mrad, positive tilts the head to its field side", &|p| {
            p.displacement[2] / MILLIRADIAN
        });
        of("moment_kn_m", "Bending moment there, kN·m, positive where the lower side is in tension", &|p| {
            p.moments[1] / KILONEWTON
        });
        of(
            "lateral_moment_kn_m",
            "Bending moment across the track there, kN·m, positive where the field side is in tension",
            &|p| p.moments[0] / KILONEWTON,
        );
        of("torsion_kn_m", "Torsion there, kN·m", &|p| p.torsion / KILONEWTON);
        of(
            "acceleration_m_per_s2",
            "Acceleration there with that of the ground, m/s², positive down",
            &|p| p.acceleration[1],
        );
        of(
            "lateral_acceleration_m_per_s2",
            "Lateral acceleration there with that of the ground, m/s², positive to its field side",
            &|p| p.acceleration[0],
        );
    }
    columns
}

/// Q/P of a wheel below 20 Hz, averaged over the last 2 m at each row; no number before, and where P is not positive throughout them.
fn mean_ratios(run: &AcrossRun, wheel: usize) -> Vec<f64> {
    let rows = &run.rows;
    let none = || vec![f64::NAN; rows.len()];
    let times: Vec<f64> = rows.iter().map(|row| row.time).collect();
    let of = |value: fn(&WheelAcross) -> f64| {
        low_passed(&times, rows.iter().map(|row| value(&row.wheels[wheel])).collect())
    };
    let forces = of(|w| w.contact.vertical_force).zip(of(|w| w.contact.lateral_force));
    let Some((p, q)) = forces else { return none() };
    let x: Vec<f64> = rows.iter().map(|row| row.x).collect();
    over_last(&x, &p, &q)
}

/// Means of q/p over the last 2 m of the places `x`; no number where there is none.
fn over_last(x: &[f64], p: &[f64], q: &[f64]) -> Vec<f64> {
    let along = RatioAlong::new(x, p, q);
    let mean = |row: usize| along.mean(x[row] - WINDOW, WINDOW, row).unwrap_or(f64::NAN);
    (0..x.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::over_last;

    /// Source: integrals by hand. Goal: the mean of q/p = x/2 over the last 2 m, at unequal places, is (x − 1)/2; there is none in the first 2 m, nor while a row of the window has no positive P.
    /// ROUNDOFF of sums.
    #[test]
    fn ratios_are_averaged_over_the_last_two_metres() {
        const ROUNDOFF: f64 = 1e-12;
        let x: Vec<f64> = (0..=40).map(|i| 0.01 * f64::from(i * i)).collect();
        let p = vec![2.0; x.len()];
        let means = over_last(&x, &p, &x);
        for (x, mean) in x.iter().zip(&means) {
            match *x < 2.0 {
                true => assert!(mean.is_nan(), "{x} {mean}"),
                false => assert!((mean - 0.5 * (x - 1.0)).abs() < ROUNDOFF, "{x} {mean}"),
            }
        }
        let mut lifted = p.clone();
        lifted[20] = 0.0;
        let means = over_last(&x, &lifted, &x);
        let with = |x: f64| (2.0..=6.0 + 0.42).contains(&x) && x >= 4.0;
        for (x, mean) in x.iter().zip(&means) {
            assert_eq!(mean.is_nan(), *x < 2.0 || with(*x), "{x} {mean}");
        }
    }
}
