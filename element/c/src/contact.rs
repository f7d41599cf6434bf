//! Contacts: motions of rim and rail section in, forces and tangent out; the host integrates the wheel's modes.

use crate::element::{RailspringElement, friction, same};
use crate::guard::{RailspringCode, exclusive, free, guarded, hand_over, put, shared};
use crate::types::{RailspringForces, RailspringMotions, RailspringPlace};
use nalgebra::Matrix3;
use railspring_element::contact::{ContactAt, StaticContact};
use railspring_profiles::error::Result;

/// A contact with its state, for one thread at a time.
pub struct RailspringContact(pub(crate) StaticContact);

/// A contact of an element on which friction has taken up nothing, where all motions are zero. A `coefficient` of friction that is not a number is that of the study.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_contact_new(
    element: *const RailspringElement,
    coefficient: f64,
    contact: *mut *mut RailspringContact,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let element = &unsafe { shared(element, "element") }?.0;
        let made = StaticContact::new(element.clone(), friction(coefficient, element))?;
        // SAFETY: as the caller promises
        unsafe { hand_over(contact, RailspringContact(made), "contact") }
    })
}

/// Frees a contact; null does nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_contact_free(contact: *mut RailspringContact) {
    // SAFETY: as the caller promises
    unsafe { free(contact) }
}

/// A copy of a contact with its state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_contact_clone(
    contact: *const RailspringContact,
    clone: *mut *mut RailspringContact,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let contact = unsafe { shared(contact, "contact") }?.0.clone();
        // SAFETY: as the caller promises
        unsafe { hand_over(clone, RailspringContact(contact), "clone") }
    })
}

/// Takes over the state at the end of the last step of `other`, a contact of the same RailspringElement, with its friction and the flexibility of its section.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_contact_restore(
    contact: *mut RailspringContact,
    other: *const RailspringContact,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let (contact, other) = unsafe { (exclusive(contact, "contact")?, shared(other, "other")?) };
        same(contact.0.element(), other.0.element())?;
        contact.0.restore(&other.0);
        Ok(())
    })
}

/// Gives the section of the host's rail a flexibility that its motions do not have, before railspring_contact_start: nine values by rows; m/N, rad/N, rad/(N·m).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_contact_set_section_rest(
    contact: *mut RailspringContact,
    rest: *const f64,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let (contact, rest) =
            unsafe { (exclusive(contact, "contact")?, shared(rest.cast::<[f64; 9]>(), "rest")?) };
        contact.0.set_section_rest(Matrix3::from_row_slice(rest))
    })
}

/// Begins, or begins again, with bodies at `motions` on which friction has taken up nothing; the forces there to `forces`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_contact_start(
    contact: *mut RailspringContact,
    motions: *const RailspringMotions,
    forces: *mut RailspringForces,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let (contact, motions) = unsafe { (exclusive(contact, "contact")?, shared(motions, "motions")?) };
        let found = contact.0.start(&motions.into())?;
        // SAFETY: as the caller promises
        unsafe { put(forces, found.into(), "forces") }
    })
}

/// The forces at the end of a step to `motions`. They depend on these and on the end of the last step alone; the state stays until railspring_contact_commit.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_contact_evaluate(
    contact: *mut RailspringContact,
    motions: *const RailspringMotions,
    forces: *mut RailspringForces,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let (contact, motions) = unsafe { (exclusive(contact, "contact")?, shared(motions, "motions")?) };
        let found = contact.0.evaluate(&motions.into())?;
        // SAFETY: as the caller promises
        unsafe { put(forces, found.into(), "forces") }
    })
}

/// Takes what was evaluated last as the end of a step. Where nothing was evaluated since the last one, or that failed, it changes nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_contact_commit(contact: *mut RailspringContact) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        unsafe { exclusive(contact, "contact") }?.0.commit();
        Ok(())
    })
}

/// The contacts as evaluated last: how many to `count`, and the first `capacity` of them to `places`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_contact_places(
    contact: *const RailspringContact,
    places: *mut RailspringPlace,
    capacity: usize,
    count: *mut usize,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let contact = unsafe { shared(contact, "contact") }?;
        // SAFETY: as the caller promises
        unsafe { list(contact.0.contacts(), places, capacity, count) }
    })
}

/// Writes contacts.
///
/// # Safety
/// There is room for `capacity` of them, and for their number.
pub(crate) unsafe fn list(
    contacts: impl ExactSizeIterator<Item = ContactAt>,
    places: *mut RailspringPlace,
    capacity: usize,
    count: *mut usize,
) -> Result<()> {
    let all = contacts.len();
    for (i, contact) in contacts.take(capacity).enumerate() {
        // SAFETY: as the caller promises
        unsafe { put(places.wrapping_add(i), contact.into(), "places") }?;
    }
    // SAFETY: as the caller promises
    unsafe { put(count, all, "count") }
}
