//! The contact element that springs run in.

use std::sync::Arc;

use crate::engine::output::to_json;
use crate::hash::hash;
use crate::results::by_angle::element::ElementRecord;
use crate::results::by_angle::record::StiffnessByAngleRecord;
use crate::results::run::record::SpringsRecord;
use crate::study::ContactElementKey;

/// Springs with the condensed element that the model runs with.
pub(super) fn with_element(springs: SpringsRecord, element: ElementRecord) -> SpringsRecord {
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
) -> Result<SpringsRecord, String> {
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
