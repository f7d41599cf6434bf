//! The springs of the simple model: the study's own, the published ones or those of a file.
//! It is said in which respects they may not suit the study.

mod accepted;
mod contact_element;
mod of_study;
mod in_si;
mod written;
mod plausible;
mod file;

use railspring_profiles::units::KILONEWTON;
use railspring_simulate::time::history::{History, HistoryRow};

use crate::results::run::record::SpringsRecord;
use crate::rounding::with_unit;

pub use self::accepted::check_reference;
pub use self::contact_element::{element, in_element};
pub use self::file::{element_of, from_file};
pub use self::in_si::springs;
pub use self::of_study::{need_no_calibration, springs_of_study, without_calibration};

/// Says by how much a run leaves the fitted range of its law, if it does. Steps without contact do not count.
pub fn range_note(springs: &SpringsRecord, history: &History) -> Option<String> {
    let [low, high] = springs.range_kn?;
    // an element of the solids has the law at its contacts
    let (of, load): (&str, fn(&HistoryRow) -> f64) = match springs.element_blake3 {
        Some(_) => ("the largest normal force of a contact runs", |row| {
            row.contacts.iter().map(|contact| contact.normal_force).fold(0.0, f64::max)
        }),
        None => ("P runs", |row| row.vertical_force),
    };
    let touching = history.rows.iter().skip(1).filter(|row| !row.contacts.is_empty());
    let loads: Vec<f64> = touching.map(|row| load(row) / KILONEWTON).collect();
    let below = loads.iter().filter(|load| **load < low).count();
    let above = loads.iter().filter(|load| **load > high).count();
    if below + above == 0 {
        return None;
    }
    let smallest = loads.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = loads.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    Some(format!(
        "{of} from {} to {} and leaves the law's fitted range, {low} to {high} kN: of {} steps \
         with contact {below} lie below it and {above} above",
        with_unit(Some(smallest), "kN"),
        with_unit(Some(largest), "kN"),
        loads.len()
    ))
}

#[cfg(test)]
mod tests;
