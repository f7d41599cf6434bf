//! The springs of the simple model: the study's own, the published ones or those of a file, and in which respects they
//! may not suit the study.
//!
//! A law is one spring in series with a rail. The simple model's rail is a
//! beam, so the law has to be measured against that beam; a law of another
//! reference is refused unless the study says that it knows. So is a law of
//! another pair.

mod file;

use std::sync::Arc;

use railspring_calibrate::law::{StiffnessLaw, TableLaw};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::section::body_of_revolution;
use railspring_profiles::units::{KILONEWTON, KILONEWTON_PER_METRE};
use railspring_simulate::element::condensed::parts::PairElement;
use railspring_simulate::time::history::{History, HistoryRow};

use crate::engine::output::to_json;
use crate::hash::hash;
use crate::results::bodies::geometry::Geometry;
use crate::results::by_angle::element::ElementRecord;
use crate::results::by_angle::record::StiffnessByAngleRecord;
use crate::results::run::input::SpringsInput;
use crate::results::run::make::Springs;
use crate::results::run::record::{SpringsRecord, SpringsSource};
use crate::results::springs::record::{BeamFactors, StiffnessRecord};
use crate::rounding::with_unit;
use crate::study::{ContactElementKey, LawAcceptedKey, LawKey, ReferenceKey};

pub use self::file::{element_of, from_file};

/// Key that accepts what is refused otherwise.
const ACCEPTED: &str = "simulation.law_accepted";

/// Refuses a study whose own law does not suit its rail, before anything is computed; a study without load cases may
/// have any.
///
/// # Errors
/// [`InputError`] with key `calibration.reference`.
pub fn check_reference(input: &SpringsInput<'_>) -> Result<()> {
    if input.cases.is_empty() || input.simulation.law == LawKey::Published {
        return Ok(());
    }
    let reference = input.statics.calibration.reference.name();
    accepted_reference(input, "calibration.reference", Some(reference)).map(drop)
}

/// The springs that a study has calibrated, or the published law if it says so, with the condensed element of its laws by contact angle if
/// its simple model has that.
///
/// # Errors
/// As [`check_reference`]; and laws without an element.
pub fn own(
    input: &SpringsInput<'_>,
    stiffness: &StiffnessRecord,
    laws: Option<&StiffnessByAngleRecord>,
) -> Result<SpringsRecord> {
    let springs = own_springs(input, stiffness)?;
    if input.element == ContactElementKey::Published {
        return Ok(springs);
    }
    let element = laws.and_then(|laws| laws.element.clone()).ok_or_else(|| {
        let reason = laws.and_then(|laws| laws.element_missing.as_deref());
        InputError::new(
            "simulation.element",
            "\"condensed\"",
            format!("a condensed element: {}", reason.unwrap_or("there are no laws by contact angle")),
            "calibrate again, or take element = \"published\"",
        )
    })?;
    Ok(with_element(springs, element))
}

/// Springs with the condensed element that the model runs with.
fn with_element(springs: SpringsRecord, element: ElementRecord) -> SpringsRecord {
    let element_blake3 = Some(hash(&to_json(&element)));
    SpringsRecord {
        element_blake3,
        element_displacement: element.displacement,
        element: Some(Arc::new(element)),
        ..springs
    }
}

/// The contact element that springs run in.
pub fn element(springs: &SpringsRecord) -> ContactElementKey {
    match springs.element_blake3 {
        Some(_) => ContactElementKey::Condensed,
        None => ContactElementKey::Published,
    }
}

/// The springs of a run in the other contact element.
///
/// # Errors
/// Why that element cannot run, as a sentence.
pub fn in_other_element(
    springs: &SpringsRecord,
    laws: Option<&StiffnessByAngleRecord>,
) -> std::result::Result<SpringsRecord, String> {
    match element(springs) {
        ContactElementKey::Condensed => Ok(SpringsRecord {
            element_blake3: None,
            element_displacement: None,
            element: None,
            ..springs.clone()
        }),
        ContactElementKey::Published => {
            let element = laws.and_then(|laws| laws.element.clone()).ok_or_else(|| {
                let reason = laws.and_then(|laws| laws.element_missing.as_deref());
                format!(
                    "there is no condensed element: {}",
                    reason.unwrap_or("no laws by contact angle are at hand")
                )
            })?;
            Ok(with_element(springs.clone(), element))
        }
    }
}

/// The published law with a horizontal stiffness (kN/m), a mass of the wheel (kg) and factors of the rail beam.
fn published(horizontal_kn_per_m: f64, wheel_mass_kg: f64, beam: BeamFactors) -> SpringsRecord {
    SpringsRecord {
        source: SpringsSource::Published,
        law: StiffnessLaw::published().into(),
        table_kn_and_kn_per_m: Vec::new(),
        horizontal_kn_per_m,
        wheel_mass_kg,
        reference: None,
        range_kn: None,
        beam,
        element_blake3: None,
        element_displacement: None,
        element: None,
        notes: vec!["the law is the published one, of UIC 60 and SKS-700, and not of this pair".into()],
    }
}

/// Whether a study runs without a calibration: with the published law, which the published element has, and its own horizontal stiffness. A wheel that
/// is a mesh from a file has its mass from there, unless every load case gives one.
pub fn need_no_calibration(input: &SpringsInput<'_>) -> bool {
    let simulation = &input.simulation;
    !input.cases.is_empty()
        && simulation.law == LawKey::Published
        && simulation.horizontal.is_some()
        && wheel_is_known(input)
}

/// The springs of a study that [needs no calibration](need_no_calibration).
pub fn without_calibration(input: &SpringsInput<'_>, geometry: &Geometry) -> Option<SpringsRecord> {
    let horizontal = input.simulation.horizontal.filter(|_| need_no_calibration(input))?;
    let mass = revolved_mass(input, geometry);
    let mut springs = published(horizontal / KILONEWTON_PER_METRE, mass, BeamFactors::default());
    springs.notes.push(
        "nothing is calibrated: the rail beam is not corrected to the solid rail, and the wheel has the mass of a body of revolution"
            .into(),
    );
    Some(springs)
}

/// Whether the wheel's mass is known without its mesh, or never used.
fn wheel_is_known(input: &SpringsInput<'_>) -> bool {
    input.statics.wheel.mesh.is_none() || input.cases.values().all(|case| case.scenario.wheel_mass.is_some())
}

/// Mass of the study's wheel as a body of revolution, kg.
fn revolved_mass(input: &SpringsInput<'_>, geometry: &Geometry) -> f64 {
    body_of_revolution(&geometry.pair.wheel, input.statics.wheel.material.density).mass
}

fn own_springs(input: &SpringsInput<'_>, stiffness: &StiffnessRecord) -> Result<SpringsRecord> {
    let horizontal = input.simulation.horizontal.map(|k| k / KILONEWTON_PER_METRE);
    let horizontal_kn_per_m = horizontal.or(stiffness.horizontal_kn_per_m).ok_or_else(|| {
        InputError::new(
            "simulation.horizontal_kn_per_m",
            "(missing)",
            "a horizontal stiffness, which the calibration did not find",
            format!("give it; {}", stiffness.horizontal_missing.as_deref().unwrap_or("or calibrate again")),
        )
    })?;
    let table = match input.simulation.law {
        LawKey::Published => {
            return Ok(published(horizontal_kn_per_m, stiffness.wheel_mass(), stiffness.beam.factors));
        }
        LawKey::Table => stiffness.table(),
        LawKey::Calibrated => Vec::new(),
    };
    let note = accepted_reference(input, "calibration.reference", Some(&stiffness.reference))?;
    let by_table =
        (!table.is_empty()).then(|| format!("the law is the table of {} calibrated tangents", table.len()));
    Ok(SpringsRecord {
        source: SpringsSource::Calibrated,
        law: stiffness.law.constants,
        table_kn_and_kn_per_m: table,
        horizontal_kn_per_m,
        wheel_mass_kg: stiffness.wheel_mass(),
        reference: Some(stiffness.reference.clone()),
        range_kn: Some(stiffness.law.range_kn),
        beam: stiffness.beam.factors,
        element_blake3: None,
        element_displacement: None,
        element: None,
        notes: note.into_iter().chain(by_table).collect(),
    })
}

/// The springs in SI units.
///
/// # Errors
/// [`InputError`] with key `law` for constants that are no law.
pub fn springs(record: &SpringsRecord) -> Result<Springs> {
    let table = &record.table_kn_and_kn_per_m;
    let normal = if table.is_empty() {
        StiffnessLaw::try_from(record.law)?.into()
    } else {
        let (forces, tangents): (Vec<f64>, Vec<f64>) =
            table.iter().map(|[force, k]| (force * KILONEWTON, k * KILONEWTON_PER_METRE)).unzip();
        TableLaw::new(&forces, &tangents)?.into()
    };
    Ok(Springs {
        normal,
        horizontal: record.horizontal_kn_per_m * KILONEWTON_PER_METRE,
        wheel_mass: record.wheel_mass_kg,
        beam: record.beam.into(),
        element: record.element.as_deref().map(PairElement::from),
    })
}

/// Says by how much a run leaves the fitted range of its law, if it does. Steps without contact do not count.
pub fn range_note(springs: &SpringsRecord, history: &History) -> Option<String> {
    let [low, high] = springs.range_kn?;
    // the condensed element has the law at its contacts
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

/// What has to be said about the reference of a law, if the study accepts it.
fn accepted_reference(
    input: &SpringsInput<'_>,
    key: &str,
    reference: Option<&str>,
) -> Result<Option<String>> {
    const EXPECTED: &str = "\"beam\", because the rail of the simple model is a beam";
    let fault = match reference {
        None => return Ok(Some(format!("{key} is not given: taken as \"beam\""))),
        Some("beam") => return Ok(None),
        Some("foot") => {
            "against the rail's foot it has the rail's bending, which the beam adds a second time"
        }
        Some("local") => {
            "the approach of the surfaces alone leaves out the deflection of wheel and rail head"
        }
        Some(other) => {
            return Err(InputError::new(
                key,
                format!("{other:?}"),
                "\"foot\", \"beam\" or \"local\"",
                "correct the file",
            )
            .into());
        }
    };
    let reference = format!("{:?}", reference.unwrap_or_default());
    if input.simulation.law_accepted.contains(&LawAcceptedKey::AnotherReference) {
        return Ok(Some(format!("reference of the law {reference}, accepted by {ACCEPTED}: {fault}")));
    }
    let remedy = format!(
        "{fault}; use {:?}, or accept it with {ACCEPTED} = [\"another-reference\"]",
        ReferenceKey::Beam.name()
    );
    Err(InputError::new(key, reference, EXPECTED, remedy).into())
}

#[cfg(test)]
mod tests;
