//! The springs of the simple model: the study's own, the published ones or those of a file, and in which respects they
//! may not suit the study.
//!
//! A law is one spring in series with a rail. The simple model's rail is a
//! beam, so the law has to be measured against that beam; a law of another
//! reference is refused unless the study says that it knows. So is a law of
//! another pair.

use std::path::Path;
use std::sync::Arc;

use railspring_calibrate::element::PairElement;
use railspring_calibrate::error::{InputError, Result};
use railspring_calibrate::history::{History, HistoryRow};
use railspring_calibrate::law::{StiffnessLaw, TableLaw};
use railspring_calibrate::section::body_of_revolution;
use railspring_calibrate::units::{KILONEWTON, KILONEWTON_PER_METRE};
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::output::{read_text, to_json};
use crate::records::{
    BY_ANGLE, BeamFactors, ElementRecord, LawConstants, PairRecord, Sealed, SpringsRecord, SpringsSource,
    StiffnessByAngleRecord, StiffnessRecord, with_unit,
};
use crate::results::hash;
use crate::stages::{self, Geometry, Springs};
use crate::study::{ContactElementKey, LawAcceptedKey, LawKey, ReferenceKey, Study};

/// Key that accepts what is refused otherwise.
const ACCEPTED: &str = "simulation.law_accepted";

/// A law as a person writes it: the constants and units of `stiffness.json`, and what is known about them.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenLaw {
    a_kn_per_m: Option<f64>,
    b_kn_per_m: Option<f64>,
    c: Option<f64>,
    f0_kn: Option<f64>,
    horizontal_kn_per_m: Option<f64>,
    wheel_mass_kg: Option<f64>,
    reference: Option<String>,
    range_kn: Option<[f64; 2]>,
}

/// What is taken of a `stiffness.json`; it has much more.
#[derive(Debug, Deserialize)]
struct CalibratedLaw {
    law: CalibratedConstants,
    horizontal_kn_per_m: Option<f64>,
    reference: Option<String>,
    pair: Option<PairRecord>,
}

#[derive(Debug, Deserialize)]
struct CalibratedConstants {
    a_kn_per_m: Option<f64>,
    b_kn_per_m: Option<f64>,
    c: Option<f64>,
    f0_kn: Option<f64>,
    range_kn: Option<[f64; 2]>,
}

/// Refuses a study whose own law does not suit its rail, before anything is computed; a study without load cases may
/// have any.
///
/// # Errors
/// [`InputError`] with key `calibration.reference`.
pub fn check_reference(study: &Study) -> Result<()> {
    if study.scenarios.is_empty() || study.simulation.law == LawKey::Published {
        return Ok(());
    }
    let reference = study.calibration.reference.name();
    accepted_reference(study, "calibration.reference", Some(reference)).map(drop)
}

/// The springs that a study has calibrated, or the published law if it says so, with the condensed element of its laws by contact angle if
/// its simple model has that.
///
/// # Errors
/// As [`check_reference`]; and laws without an element.
pub fn own(
    study: &Study,
    stiffness: &StiffnessRecord,
    laws: Option<&StiffnessByAngleRecord>,
) -> Result<SpringsRecord> {
    let springs = own_springs(study, stiffness)?;
    if study.element() == ContactElementKey::Published {
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

fn own_springs(study: &Study, stiffness: &StiffnessRecord) -> Result<SpringsRecord> {
    let horizontal = study.simulation.horizontal.map(|k| k / KILONEWTON_PER_METRE);
    let common = SpringsRecord {
        source: SpringsSource::Calibrated,
        law: stiffness.law.constants,
        table_kn_and_kn_per_m: match study.simulation.law {
            LawKey::Table => stiffness.table(),
            LawKey::Calibrated | LawKey::Published => Vec::new(),
        },
        horizontal_kn_per_m: horizontal.or(stiffness.horizontal_kn_per_m).ok_or_else(|| {
            InputError::new(
                "simulation.horizontal_kn_per_m",
                "(missing)",
                "a horizontal stiffness, which the calibration did not find",
                format!(
                    "give it; {}",
                    stiffness.horizontal_missing.as_deref().unwrap_or("or calibrate again")
                ),
            )
        })?,
        wheel_mass_kg: stiffness.wheel_mass(),
        reference: Some(stiffness.reference.clone()),
        range_kn: Some(stiffness.law.range_kn),
        beam: stiffness.beam.factors,
        element_blake3: None,
        element_displacement: None,
        element: None,
        notes: Vec::new(),
    };
    if study.simulation.law == LawKey::Published {
        return Ok(SpringsRecord {
            source: SpringsSource::Published,
            law: StiffnessLaw::published().into(),
            reference: None,
            range_kn: None,
            notes: vec!["the law is the published one, of UIC 60 and SKS-700, and not of this pair".into()],
            ..common
        });
    }
    let note = accepted_reference(study, "calibration.reference", Some(&stiffness.reference))?;
    let table = &common.table_kn_and_kn_per_m;
    let by_table =
        (!table.is_empty()).then(|| format!("the law is the table of {} calibrated tangents", table.len()));
    Ok(SpringsRecord { notes: note.into_iter().chain(by_table).collect(), ..common })
}

/// The springs of a file: a `stiffness.json`, or a law written by hand.
///
/// # Errors
/// [`InputError`] whose key is the file, with the key in it that is wrong: missing or impossible constants, another pair
/// or another reference that the study does not accept.
pub fn from_file(study: &Study, geometry: &Geometry, path: &Path) -> Result<SpringsRecord> {
    let name = path.display().to_string();
    if study.simulation.law == LawKey::Published {
        return Err(InputError::new(
            "simulation.law",
            "\"published\"",
            "\"calibrated\" beside --law, which names another law",
            "remove simulation.law or the option --law",
        )
        .into());
    }
    let text = read_text(path, "calibrate")?;
    let form: serde_json::Value = parsed(&name, &text)?;
    let (law, pair) = if form.get("law").is_some() {
        let file: CalibratedLaw = parsed(&name, &text)?;
        let law = WrittenLaw {
            a_kn_per_m: file.law.a_kn_per_m,
            b_kn_per_m: file.law.b_kn_per_m,
            c: file.law.c,
            f0_kn: file.law.f0_kn,
            range_kn: file.law.range_kn,
            horizontal_kn_per_m: file.horizontal_kn_per_m,
            wheel_mass_kg: None,
            reference: file.reference,
        };
        (law, file.pair)
    } else {
        (parsed(&name, &text)?, None)
    };
    let laws = (study.element() == ContactElementKey::Condensed).then(|| laws_beside(study, path));
    let (laws, without_laws) = match laws {
        Some(Err(error)) if study.simulation.element.is_some() || broken_beside(path) => return Err(error),
        // a law by hand has none beside it, and runs as springs
        Some(Err(_)) => {
            let note = format!("beside {name} lies no {BY_ANGLE} of this pair: the published element runs");
            (None, Some(note))
        }
        Some(Ok(laws)) => (Some(laws), None),
        None => (None, None),
    };
    let calibration = serde_json::from_str::<StiffnessRecord>(&text).ok();
    let edited = |laws: &StiffnessByAngleRecord| {
        (!laws.is_as_written()).then(|| edited(&path.with_file_name(BY_ANGLE).display().to_string()))
    };
    let without_laws: Vec<String> = without_laws.into_iter().chain(laws.as_ref().and_then(edited)).collect();
    // The study's own calibration under another name is no other law.
    let own_address = stages::calibration_address(study);
    let is_own = |it: &&StiffnessRecord| it.input_hash == own_address.key() && it.is_as_written();
    if let Some(stiffness) = calibration.as_ref().filter(is_own) {
        let springs = match &laws {
            Some(laws) => own(study, stiffness, Some(laws))?,
            None => own_springs(study, stiffness)?,
        };
        return Ok(SpringsRecord {
            notes: springs.notes.into_iter().chain(without_laws).collect(),
            ..springs
        });
    }
    if study.simulation.law == LawKey::Table {
        return Err(InputError::new(
            "simulation.law",
            "\"table\"",
            "\"calibrated\" beside --law: a file of another calibration gives its constants",
            "remove simulation.law or the option --law",
        )
        .into());
    }
    let mut notes = Vec::new();
    notes.extend(accepted_reference(study, &format!("{name}: reference"), law.reference.as_deref())?);
    notes.extend(accepted_pair(study, &name, pair.as_ref())?);
    if law.range_kn.is_none() {
        notes.push(format!("{name} says no range_kn: whether the run leaves the law's range is unknown"));
    }
    let of_pair = calibration.filter(|_| pair.as_ref().is_some_and(|pair| pair.hash == study.keys.pair));
    notes.extend(match &of_pair {
        Some(calibration) => of_other_calibration(study, &name, calibration),
        None => vec![format!(
            "{name}: the rail beam is not corrected to the solid rail, as `calibrate` does for its own law"
        )],
    });
    notes.extend(without_laws);
    let record = SpringsRecord {
        source: SpringsSource::File { name: name.clone(), blake3: hash(text.as_bytes()) },
        law: LawConstants {
            a_kn_per_m: given(&name, "a_kn_per_m", law.a_kn_per_m)?,
            b_kn_per_m: given(&name, "b_kn_per_m", law.b_kn_per_m)?,
            c: given(&name, "c", law.c)?,
            f0_kn: given(&name, "f0_kn", law.f0_kn)?,
        },
        table_kn_and_kn_per_m: Vec::new(),
        horizontal_kn_per_m: match study.simulation.horizontal {
            Some(horizontal) => horizontal / KILONEWTON_PER_METRE,
            None => given(&name, "horizontal_kn_per_m", law.horizontal_kn_per_m)?,
        },
        wheel_mass_kg: match &of_pair {
            Some(calibration) => calibration.wheel_mass(),
            None => wheel_mass(study, geometry, &name, law.wheel_mass_kg)?,
        },
        reference: law.reference,
        range_kn: law.range_kn,
        beam: of_pair.map_or_else(BeamFactors::default, |calibration| calibration.beam.factors),
        element_blake3: None,
        element_displacement: None,
        element: None,
        notes,
    };
    check(&name, &record)?;
    Ok(match laws.and_then(|laws| laws.element) {
        Some(element) => with_element(record, element),
        None => record,
    })
}

/// What has to be known about the springs of another calibration of the study's pair, which come with the wheel and the beam that they were made with.
fn of_other_calibration(study: &Study, name: &str, calibration: &StiffnessRecord) -> Vec<String> {
    let StiffnessRecord { version, commit, beam, .. } = calibration;
    let mut notes = vec![match calibration.is_as_written() {
        true => format!(
            "{name} is a calibration with other settings or of another program (railspring {version}, {commit}): its law, its wheel \
             mass and its factors of the rail beam are used"
        ),
        false => edited(name),
    }];
    if (beam.length_m - study.rail.length).abs() > 1e-9 {
        notes.push(format!(
            "{name}: the factors of the rail beam are those of a rail of {} m, not of {} m",
            beam.length_m, study.rail.length
        ));
    }
    notes
}

/// That a file is not as the program wrote it.
fn edited(name: &str) -> String {
    format!("{name} was edited after it was written: its numbers are not those of a calibration")
}

/// The laws by contact angle beside a law file, of the study's own pair, for its condensed element.
fn laws_beside(study: &Study, path: &Path) -> Result<StiffnessByAngleRecord> {
    laws_of(study, &path.with_file_name(BY_ANGLE))
}

/// Whether laws by contact angle lie beside a law file that nothing can run with.
fn broken_beside(path: &Path) -> bool {
    let beside = path.with_file_name(BY_ANGLE);
    beside.exists() && read_laws(&beside).is_err()
}

/// The condensed element of a file with laws by contact angle of the study's own pair.
///
/// # Errors
/// [`InputError`] whose key is the file, if it cannot be read, is of another pair or has no element.
pub fn element_of(study: &Study, path: &Path) -> Result<PairElement> {
    let laws = laws_of(study, path)?;
    let element = laws.element.as_ref().ok_or_else(|| {
        InputError::new(
            path.display().to_string(),
            "no `element`",
            "laws by contact angle with a condensed element, which a study with load cases makes",
            laws.element_missing.as_deref().unwrap_or("calibrate such a study"),
        )
    })?;
    Ok(PairElement::from(element))
}

fn laws_of(study: &Study, path: &Path) -> Result<StiffnessByAngleRecord> {
    let laws = read_laws(path)?;
    accepted_pair(study, &path.display().to_string(), Some(&laws.pair))?;
    Ok(laws)
}

fn read_laws(path: &Path) -> Result<StiffnessByAngleRecord> {
    let name = path.display().to_string();
    let laws: StiffnessByAngleRecord =
        serde_json::from_str(&read_text(path, "calibrate")?).map_err(|cause| {
            let expected = "a stiffness_by_angle.json of `railspring calibrate`";
            InputError::new(
                &name,
                cause,
                expected,
                "calibrate again, or take simulation.element = \"published\"",
            )
        })?;
    if let Some(element) = &laws.element {
        element.check(&name)?;
    }
    Ok(laws)
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

fn parsed<T: DeserializeOwned>(name: &str, text: &str) -> Result<T> {
    serde_json::from_str(text).map_err(|cause| {
        InputError::new(
            name,
            cause,
            "a stiffness.json of `railspring calibrate`, or a law {\"a_kn_per_m\": …, \"b_kn_per_m\": …, \"c\": …, \
             \"f0_kn\": …, \"horizontal_kn_per_m\": …}",
            "correct the file; docs/laws.md describes it",
        )
        .into()
    })
}

fn given(name: &str, key: &str, value: Option<f64>) -> Result<f64> {
    value.ok_or_else(|| {
        InputError::new(format!("{name}: {key}"), "(missing)", "a number", "add the key to the file").into()
    })
}

/// Constants that are a law: k is positive and does not fall, and its displacement is finite.
fn check(name: &str, record: &SpringsRecord) -> Result<()> {
    let law = &record.law;
    let wrong = |key: &str, value: String, expected: &str| {
        InputError::new(format!("{name}: {key}"), value, expected, "correct the file")
    };
    let positive = |key: &str, value: f64| {
        if value > 0.0 { Ok(()) } else { Err(wrong(key, value.to_string(), "a number above 0")) }
    };
    for (key, value) in [("a_kn_per_m", law.a_kn_per_m), ("b_kn_per_m", law.b_kn_per_m)] {
        if !(value >= 0.0) {
            return Err(wrong(key, value.to_string(), "a number of at least 0").into());
        }
    }
    if !(0.0..1.0).contains(&law.c) {
        return Err(wrong("c", law.c.to_string(), "a number from 0 to below 1").into());
    }
    if law.a_kn_per_m + law.b_kn_per_m == 0.0 {
        return Err(wrong("b_kn_per_m", "0".into(), "a number above 0, because a_kn_per_m is 0").into());
    }
    positive("f0_kn", law.f0_kn)?;
    positive("horizontal_kn_per_m", record.horizontal_kn_per_m)?;
    positive("wheel_mass_kg", record.wheel_mass_kg)?;
    if let Some([low, high]) = record.range_kn
        && !(low >= 0.0 && high > low)
    {
        return Err(wrong("range_kn", format!("[{low}, {high}]"), "two ascending loads").into());
    }
    springs(record).map(drop)
}

/// Mass of the wheel: from the file, or of the study's wheel as a body of revolution.
fn wheel_mass(study: &Study, geometry: &Geometry, name: &str, written: Option<f64>) -> Result<f64> {
    let all_have_one = study.scenarios.values().all(|s| s.scenario.wheel_mass.is_some());
    match written {
        Some(mass) => Ok(mass),
        None if study.wheel.mesh.is_none() || all_have_one => {
            Ok(body_of_revolution(&geometry.pair.wheel, study.material.density).mass)
        }
        None => Err(InputError::new(
            format!("{name}: wheel_mass_kg"),
            "(missing)",
            "a number, because the wheel of the study is a mesh from a file",
            "add the key, or give every scenario a wheel_mass_t",
        )
        .into()),
    }
}

/// What has to be said about the reference of a law, if the study accepts it.
fn accepted_reference(study: &Study, key: &str, reference: Option<&str>) -> Result<Option<String>> {
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
    if study.simulation.law_accepted.contains(&LawAcceptedKey::AnotherReference) {
        return Ok(Some(format!("reference of the law {reference}, accepted by {ACCEPTED}: {fault}")));
    }
    let remedy = format!(
        "{fault}; use {:?}, or accept it with {ACCEPTED} = [\"another-reference\"]",
        ReferenceKey::Beam.name()
    );
    Err(InputError::new(key, reference, EXPECTED, remedy).into())
}

/// What has to be said about the pair of a law, if the study accepts it.
fn accepted_pair(study: &Study, name: &str, pair: Option<&PairRecord>) -> Result<Option<String>> {
    let Some(pair) = pair else {
        return Ok(Some(format!("{name} does not say for which pair its law is")));
    };
    if pair.hash == study.keys.pair {
        return Ok(None);
    }
    let own = study.pair();
    if study.simulation.law_accepted.contains(&LawAcceptedKey::AnotherPair) {
        return Ok(Some(format!("the law is of another pair, accepted by {ACCEPTED}: {}", pair.name)));
    }
    Err(InputError::new(
        format!("{name}: pair"),
        &pair.name,
        format!("the study's pair, {} ({})", own.name, "profiles, bodies, track and elastic material"),
        format!("calibrate this study, or accept it with {ACCEPTED} = [\"another-pair\"]"),
    )
    .into())
}

#[cfg(test)]
mod tests;
