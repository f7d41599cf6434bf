//! The springs of a file: a `stiffness.json`, or a law written by hand.

use std::path::Path;

use railspring_calibrate::law::Form;
use railspring_element::pair_element::PairElement;
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::units::KILONEWTON_PER_METRE;
use serde::de::DeserializeOwned;

use crate::engine::output::read_text;
use crate::engine::seal::Sealed;
use crate::hash::hash;
use crate::results::bodies::geometry::Geometry;
use crate::results::by_angle::record::{BY_ANGLE, StiffnessByAngleRecord};
use crate::results::run::input::SpringsInput;
use crate::results::run::record::{SpringsRecord, SpringsSource};
use crate::results::run::springs::accepted::{ACCEPTED, accepted_reference};
use crate::results::run::springs::contact_element::{of_laws, with_element};
use crate::results::run::springs::in_si::springs;
use crate::results::run::springs::of_study::{
    law_of_form, own_springs, revolved_mass, springs_of_study, wheel_is_known,
};
use crate::results::run::springs::plausible::implausible;
use crate::results::run::springs::written::{LARGEST_STIFFNESS, WrittenLaw, given};
use crate::results::springs::record::{BeamFactors, StiffnessRecord};
use crate::study::{ContactElementKey, LawAcceptedKey, LawKey, PairRecord};

/// The springs of a file: a `stiffness.json`, or a law written by hand.
///
/// # Errors
/// [`InputError`] whose key is the file, with the key in it that is wrong: missing or impossible constants, a calibration that was edited, another
/// pair or another reference that the study does not accept.
pub fn from_file(input: &SpringsInput<'_>, geometry: &Geometry, path: &Path) -> Result<SpringsRecord> {
    let name = path.display().to_string();
    if input.simulation.law == LawKey::Published {
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
    let calibration = form.get("law").map(|_| calibration(path, &name, &text)).transpose()?;
    let law: WrittenLaw = match &calibration {
        Some(calibration) => WrittenLaw::of(calibration),
        None => parsed(&name, &text)?,
    };
    let pair = calibration.as_ref().map(|calibration| calibration.pair.clone());
    let laws = (input.element != ContactElementKey::Published).then(|| laws_beside(input, path));
    let (laws, without_laws) = match laws {
        Some(Err(error)) if input.simulation.element.is_some() || broken_beside(path) => return Err(error),
        // a law by hand has none beside it, and runs as springs
        Some(Err(_)) => {
            let note = format!("beside {name} lies no {BY_ANGLE} of this pair: the published element runs");
            (None, Some(note))
        }
        Some(Ok(laws)) => (Some(laws), None),
        None => (None, None),
    };
    // The study's own calibration under another name is no other law.
    let own_address = input.calibration();
    let is_own = |it: &&StiffnessRecord| it.input_hash == own_address.key();
    if let Some(stiffness) = calibration.as_ref().filter(is_own) {
        let springs = match &laws {
            Some(laws) => springs_of_study(input, stiffness, Some(laws))?,
            None => own_springs(input, stiffness)?,
        };
        return Ok(SpringsRecord {
            notes: springs.notes.into_iter().chain(without_laws).collect(),
            ..springs
        });
    }
    let form = input.simulation.law.form().filter(|form| *form != Form::Power);
    let normal = match (form, &calibration) {
        (None, _) => law.law(&name)?,
        (Some(form), Some(calibration)) => law_of_form(calibration, form)?,
        (Some(form), None) => {
            return Err(InputError::new(
                "simulation.law",
                format!("{:?}", form.name()),
                "\"calibrated\" beside a law that is written by hand: the file says its form",
                "remove simulation.law or the option --law",
            )
            .into());
        }
    };
    let mut notes = Vec::new();
    notes.extend(accepted_reference(input, &format!("{name}: reference"), law.reference.as_deref())?);
    notes.extend(accepted_pair(input, &name, pair.as_ref())?);
    if law.range_kn.is_none() {
        notes.push(format!("{name} says no range_kn: whether the run leaves the law's range is unknown"));
    }
    let of_pair =
        calibration.as_ref().filter(|calibration| calibration.pair.hash == input.statics.pair_key());
    notes.extend(match of_pair {
        Some(calibration) => of_other_calibration(input, &name, calibration),
        None => vec![format!(
            "{name}: the rail beam is not corrected to the solid rail, as `calibrate` does for its own law"
        )],
    });
    notes.extend(without_laws);
    let record = SpringsRecord {
        source: SpringsSource::File { name: name.clone(), blake3: hash(text.as_bytes()) },
        law: normal,
        horizontal_kn_per_m: match input.simulation.horizontal {
            Some(horizontal) => horizontal / KILONEWTON_PER_METRE,
            None => given(&name, "horizontal_kn_per_m", law.horizontal_kn_per_m)?,
        },
        wheel_mass_kg: match of_pair {
            Some(calibration) => calibration.wheel_mass(),
            None => wheel_mass(input, geometry, &name, law.wheel_mass_kg)?,
        },
        reference: law.reference,
        range_kn: law.range_kn,
        beam: of_pair.map_or_else(BeamFactors::default, |calibration| calibration.beam.factors),
        contact_element: ContactElementKey::Published,
        element_blake3: None,
        element_displacement: None,
        element: None,
        notes,
    };
    check(&name, &record)?;
    let mut record = record;
    record.notes.extend(implausible(&name, &record, calibration.as_ref())?);
    let element = laws.and_then(|laws| of_laws(Some(&laws), input.element).ok().flatten());
    Ok(match element {
        Some(element) => with_element(record, element),
        None => record,
    })
}

/// What has to be known about the springs of another calibration of the study's pair, which come with the wheel and the beam that they were made with.
fn of_other_calibration(input: &SpringsInput<'_>, name: &str, calibration: &StiffnessRecord) -> Vec<String> {
    let StiffnessRecord { version, commit, beam, .. } = calibration;
    let mut notes = vec![format!(
        "{name} is a calibration with other settings or of another program (railspring {version}, {commit}): its law, its wheel \
         mass and its factors of the rail beam are used"
    )];
    if (beam.length_m - input.statics.rail.length).abs() > 1e-9 {
        notes.push(format!(
            "{name}: the factors of the rail beam are those of a rail of {} m, not of {} m",
            beam.length_m, input.statics.rail.length
        ));
    }
    notes
}

/// A calibration as it was written.
fn calibration(path: &Path, name: &str, text: &str) -> Result<StiffnessRecord> {
    let calibration: StiffnessRecord = parsed(name, text)?;
    calibration.check_as_written(path, "calibrate")?;
    Ok(calibration)
}

/// The laws by contact angle beside a law file, of the study's own pair, for its condensed or lumped element.
fn laws_beside(input: &SpringsInput<'_>, path: &Path) -> Result<StiffnessByAngleRecord> {
    laws_of(input, &path.with_file_name(BY_ANGLE))
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
pub fn element_of(input: &SpringsInput<'_>, path: &Path) -> Result<PairElement> {
    let laws = laws_of(input, path)?;
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

fn laws_of(input: &SpringsInput<'_>, path: &Path) -> Result<StiffnessByAngleRecord> {
    let laws = read_laws(path)?;
    accepted_pair(input, &path.display().to_string(), Some(&laws.pair))?;
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
    if let Some(lumped) = &laws.lumped {
        lumped.check(&name)?;
    }
    // last, because the checks above name the key that was edited
    laws.check_as_written(path, "calibrate")?;
    Ok(laws)
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

/// Mass of a wheel that a run can have, kg.
const LEAST_MASS: f64 = 1e-3;
const LARGEST_MASS: f64 = 1e6;

/// Springs that can be run with.
fn check(name: &str, record: &SpringsRecord) -> Result<()> {
    let wrong = |key: &str, value: String, expected: &str| {
        InputError::new(format!("{name}: {key}"), value, expected, "correct the file")
    };
    let within = |key: &str, value: f64, [least, most]: [f64; 2]| match value > least && value <= most {
        true => Ok(()),
        false => Err(wrong(key, value.to_string(), &format!("a number above {least} and up to {most:e}"))),
    };
    within("horizontal_kn_per_m", record.horizontal_kn_per_m, [0.0, LARGEST_STIFFNESS])?;
    within("wheel_mass_kg", record.wheel_mass_kg, [LEAST_MASS, LARGEST_MASS])?;
    if let Some([low, high]) = record.range_kn
        && !(low >= 0.0 && high > low)
    {
        return Err(wrong("range_kn", format!("[{low}, {high}]"), "two ascending loads").into());
    }
    springs(record).map(drop)
}

/// Mass of the wheel: from the file, or of the study's wheel as a body of revolution.
fn wheel_mass(
    input: &SpringsInput<'_>,
    geometry: &Geometry,
    name: &str,
    written: Option<f64>,
) -> Result<f64> {
    match written {
        Some(mass) => Ok(mass),
        None if wheel_is_known(input) => Ok(revolved_mass(input, geometry)),
        None => Err(InputError::new(
            format!("{name}: wheel_mass_kg"),
            "(missing)",
            "a number, because the wheel of the study is a mesh from a file",
            "add the key, or give every scenario a wheel_mass_t",
        )
        .into()),
    }
}

/// What has to be said about the pair of a law, if the study accepts it.
fn accepted_pair(input: &SpringsInput<'_>, name: &str, pair: Option<&PairRecord>) -> Result<Option<String>> {
    let Some(pair) = pair else {
        return Ok(Some(format!("{name} does not say for which pair its law is")));
    };
    if pair.hash == input.statics.pair_key() {
        return Ok(None);
    }
    let own = input.statics.pair();
    if input.simulation.law_accepted.contains(&LawAcceptedKey::AnotherPair) {
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
