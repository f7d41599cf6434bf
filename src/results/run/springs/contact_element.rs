//! The contact element that springs run in.

use std::sync::Arc;

use crate::engine::output::to_json;
use crate::hash::hash;
use crate::results::by_angle::record::StiffnessByAngleRecord;
use crate::results::run::record::{SolidElementRecord, SpringsRecord};
use crate::study::ContactElementKey;

/// Springs with the element of the solids that the model runs with.
pub(super) fn with_element(springs: SpringsRecord, element: SolidElementRecord) -> SpringsRecord {
    SpringsRecord {
        contact_element: element.key(),
        element_blake3: Some(hash(&to_json(&element))),
        element_displacement: element.displacement(),
        element: Some(Arc::new(element)),
        ..springs
    }
}

/// The contact element that springs run in.
pub fn element(springs: &SpringsRecord) -> ContactElementKey {
    match (springs.contact_element, &springs.element_blake3) {
        // what was written when there was one element of the solids
        (ContactElementKey::Published, Some(_)) => ContactElementKey::Condensed,
        (element, _) => element,
    }
}

/// An element of the solids from laws by contact angle; none for the published one.
///
/// # Errors
/// Why there is none, as a phrase.
pub(super) fn of_laws(
    laws: Option<&StiffnessByAngleRecord>,
    element: ContactElementKey,
) -> Result<Option<SolidElementRecord>, String> {
    let found = match element {
        ContactElementKey::Published => return Ok(None),
        ContactElementKey::Condensed => {
            laws.and_then(|laws| laws.element.clone()).map(SolidElementRecord::Condensed)
        }
        ContactElementKey::Lumped => {
            laws.and_then(|laws| laws.lumped.clone()).map(SolidElementRecord::Lumped)
        }
    };
    found.map(Some).ok_or_else(|| {
        let reason = laws.map(|laws| laws.element_missing.as_deref());
        match reason {
            Some(Some(reason)) => reason.into(),
            Some(None) => format!("the laws by contact angle have no {} element", element.name()),
            None => "there are no laws by contact angle".into(),
        }
    })
}

/// The springs of a run in another contact element.
///
/// # Errors
/// Why that element cannot run, as a sentence.
pub fn in_element(
    springs: &SpringsRecord,
    laws: Option<&StiffnessByAngleRecord>,
    element: ContactElementKey,
) -> Result<SpringsRecord, String> {
    let found = of_laws(laws, element)
        .map_err(|reason| format!("there is no {} element: {reason}", element.name()))?;
    let published = SpringsRecord {
        contact_element: ContactElementKey::Published,
        element_blake3: None,
        element_displacement: None,
        element: None,
        ..springs.clone()
    };
    Ok(match found {
        None => published,
        Some(found) => with_element(published, found),
    })
}
