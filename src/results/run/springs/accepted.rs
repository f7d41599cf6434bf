//! In which respects a law may not suit the study that runs with it.
//!
//! A law is one spring in series with a rail. The simple model's rail is a beam, so the law has to be measured against that beam.
//! A law of another reference is refused unless the study says that it knows. So is a law of another pair.

use railspring_profiles::error::{InputError, Result};

use crate::results::run::input::SpringsInput;
use crate::study::{LawAcceptedKey, LawKey, ReferenceKey};

/// Key that accepts what is refused otherwise.
pub(super) const ACCEPTED: &str = "simulation.law_accepted";

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

/// What has to be said about the reference of a law, if the study accepts it.
pub(super) fn accepted_reference(
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
        Some("local" | "half-spaces") => {
            "the approach of the surfaces alone leaves out the deflection of wheel and rail head"
        }
        Some(other) => {
            return Err(InputError::new(
                key,
                format!("{other:?}"),
                "\"foot\", \"beam\", \"local\" or \"half-spaces\"",
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
