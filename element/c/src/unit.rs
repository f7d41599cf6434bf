//! Units: the element with the wheel's modes inside, for hosts that have hub and rail.

use crate::contact::list;
use crate::element::{RailspringElement, friction, same};
use crate::guard::{RailspringCode, exclusive, free, guarded, hand_over, put, shared};
use crate::types::{RailspringHost, RailspringHostForces, RailspringPlace};
use nalgebra::Matrix3;
use railspring_element::unit::Unit;

/// A unit with its state, for one thread at a time.
pub struct RailspringUnit(pub(crate) Unit);

/// A unit of an element on which friction has taken up nothing, where all motions are zero. A `coefficient` of friction that is not a number is that of the study;
/// `gravity` acts on the wheel's modes, m/s², the weight of the hub is the host's.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_unit_new(
    element: *const RailspringElement,
    coefficient: f64,
    gravity: f64,
    unit: *mut *mut RailspringUnit,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let element = &unsafe { shared(element, "element") }?.0;
        let made = Unit::new(element.clone(), friction(coefficient, element), gravity)?;
        // SAFETY: as the caller promises
        unsafe { hand_over(unit, RailspringUnit(made), "unit") }
    })
}

/// Frees a unit; null does nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_unit_free(unit: *mut RailspringUnit) {
    // SAFETY: as the caller promises
    unsafe { free(unit) }
}

/// A copy of a unit with its state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_unit_clone(
    unit: *const RailspringUnit,
    clone: *mut *mut RailspringUnit,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let unit = unsafe { shared(unit, "unit") }?.0.clone();
        // SAFETY: as the caller promises
        unsafe { hand_over(clone, RailspringUnit(unit), "clone") }
    })
}

/// Takes over the state at the end of the last step of `other`, a unit of the same RailspringElement, with its friction and the flexibility of its section.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_unit_restore(
    unit: *mut RailspringUnit,
    other: *const RailspringUnit,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let (unit, other) = unsafe { (exclusive(unit, "unit")?, shared(other, "other")?) };
        same(unit.0.element(), other.0.element())?;
        unit.0.restore(&other.0);
        Ok(())
    })
}

/// As railspring_contact_set_section_rest.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_unit_set_section_rest(
    unit: *mut RailspringUnit,
    rest: *const f64,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let (unit, rest) = unsafe { (exclusive(unit, "unit")?, shared(rest.cast::<[f64; 9]>(), "rest")?) };
        unit.0.set_section_rest(Matrix3::from_row_slice(rest))
    })
}

/// Begins, or begins again, with the host at its motions, friction that has taken up nothing, and modes that do not swing: as the hub has them, or, with `bent` other than 0, bent by weight and contact. The forces
/// there to `forces`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_unit_start(
    unit: *mut RailspringUnit,
    host: *const RailspringHost,
    bent: i32,
    forces: *mut RailspringHostForces,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let (unit, host) = unsafe { (exclusive(unit, "unit")?, shared(host, "host")?) };
        let found = unit.0.start(&host.into(), bent != 0)?;
        // SAFETY: as the caller promises
        unsafe { put(forces, found.into(), "forces") }
    })
}

/// The forces at the end of a step of a `length` (s, at most 0.1) from the end of the last one to a host's motions. They depend on these and on the end of the last step alone; the state stays until
/// railspring_unit_commit. Between both ends the motions are cubics with their velocities; the element divides the step as its forces ask for.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_unit_advance(
    unit: *mut RailspringUnit,
    length: f64,
    host: *const RailspringHost,
    forces: *mut RailspringHostForces,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let (unit, host) = unsafe { (exclusive(unit, "unit")?, shared(host, "host")?) };
        let found = unit.0.advance(length, &host.into())?;
        // SAFETY: as the caller promises
        unsafe { put(forces, found.into(), "forces") }
    })
}

/// Derivatives of the forces that railspring_unit_advance found last by the displacements of hub and section at the end of its step: 36 values, six rows (hub before section); N/m, N, N·m. They are those of the last inner step: a good guess for steps of up to 100 µs. Without such a step they are zero.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_unit_tangent(
    unit: *const RailspringUnit,
    tangent: *mut f64,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let all = unsafe { shared(unit, "unit") }?.0.tangent();
        let rows: [f64; 36] = std::array::from_fn(|i| all[(i / 6, i % 6)]);
        // SAFETY: as the caller promises
        unsafe { put(tangent.cast(), rows, "tangent") }
    })
}

/// Takes what railspring_unit_advance found last as the end of a step. Where nothing was found since the last one, or that failed, it changes nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_unit_commit(unit: *mut RailspringUnit) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        unsafe { exclusive(unit, "unit") }?.0.commit();
        Ok(())
    })
}

/// The contacts as found last: how many to `count`, and the first `capacity` of them to `places`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_unit_places(
    unit: *const RailspringUnit,
    places: *mut RailspringPlace,
    capacity: usize,
    count: *mut usize,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let unit = unsafe { shared(unit, "unit") }?;
        // SAFETY: as the caller promises
        unsafe { list(unit.0.contacts(), places, capacity, count) }
    })
}
