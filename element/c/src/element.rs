//! Elements: read from files, shared by contacts and units.

use crate::guard::{RailspringCode, free, guarded, hand_over, put, put_all, shared};
use crate::types::{RailspringAbout, by_rows};
use railspring_element::element::Element;
use railspring_element::wheel::RimMode;
use railspring_profiles::error::{InputError, Result};
use std::ffi::{CStr, c_char};
use std::path::Path;
use std::sync::Arc;

/// An element: what is read from a file. It does not change, and any number of threads may use it.
pub struct RailspringElement(pub(crate) Arc<Element>);

/// Opens the element file at `path` (UTF-8, ends with 0) and puts the element to `element`. Free it with railspring_element_free; contacts and units keep what they need.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_element_open(
    path: *const c_char,
    element: *mut *mut RailspringElement,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let path = unsafe { CStr::from_ptr(shared(path, "path")?) };
        let path = path.to_str().map_err(|_| {
            InputError::new("path", path.to_string_lossy(), "a path in UTF-8", "rename the file")
        })?;
        let read = Element::open(Path::new(path))?;
        // SAFETY: as the caller promises
        unsafe { hand_over(element, RailspringElement(Arc::new(read)), "element") }
    })
}

/// The same from `length` bytes of an element file at `bytes`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_element_read(
    bytes: *const u8,
    length: usize,
    element: *mut *mut RailspringElement,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let bytes = unsafe { std::slice::from_raw_parts(shared(bytes, "bytes")?, length) };
        let read = Element::read(bytes)?;
        // SAFETY: as the caller promises
        unsafe { hand_over(element, RailspringElement(Arc::new(read)), "element") }
    })
}

/// Frees an element; null does nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_element_free(element: *mut RailspringElement) {
    // SAFETY: as the caller promises
    unsafe { free(element) }
}

/// What an element is like.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_element_about(
    element: *const RailspringElement,
    about: *mut RailspringAbout,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let element = &unsafe { shared(element, "element") }?.0;
        let rail = element.rail_at_wheel.as_ref();
        let found = RailspringAbout {
            wheel_modes: element.wheel.modes.len(),
            rail_modes: rail.map_or(0, |rail| rail.modes.len()),
            friction: element.friction,
            largest_force: element.about.largest_force_n,
            rail_length: element.head.length().unwrap_or(f64::NAN),
            place: rail.map_or(f64::NAN, |rail| rail.place),
            damping: [element.damping, rail.map_or(0.0, |rail| rail.damping)],
            hub: element.wheel.hub,
            rail: [element.rail.angle, element.rail.origin.x, element.rail.origin.y],
            origin: (element.tape - element.node_line).into(),
        };
        // SAFETY: as the caller promises
        unsafe { put(about, found, "about") }
    })
}

/// The wheel as a superelement of n = 3 + wheel_modes coordinates, for hosts that integrate its modes: hub y, z (m) and rotation about x (rad), then the modes' amplitudes.
/// `mass`, `damping` and `stiffness` have n·n values by rows, `rim` 3·n: the rim's motion under the coordinates. Null where one is not wanted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_element_superelement(
    element: *const RailspringElement,
    mass: *mut f64,
    damping: *mut f64,
    stiffness: *mut f64,
    rim: *mut f64,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let wheel = unsafe { shared(element, "element") }?.0.superelement();
        for (matrix, to) in
            [(wheel.mass, mass), (wheel.damping, damping), (wheel.stiffness, stiffness), (wheel.rim, rim)]
        {
            // by columns of the transpose
            // SAFETY: as the caller promises
            unsafe { put_all(to, matrix.transpose().iter().copied()) };
        }
        Ok(())
    })
}

/// Mass of a host's hub whose wheel's modes are in a unit: nine values by rows, about its centre; kg, kg·m, kg·m².
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_element_hub_mass(
    element: *const RailspringElement,
    mass: *mut f64,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let element = &unsafe { shared(element, "element") }?.0;
        // SAFETY: as the caller promises
        unsafe { put(mass.cast(), by_rows(&element.wheel.mass_beside_modes()), "mass") }
    })
}

/// The rail of the study as a wheel in one place feels it, by rail_modes modes of mass 1 kg. Squares of their angular frequencies (1/s²); motions of the section (y, z, rotation about x; three values
/// each). Then nine values by rows of the section's flexibility beyond them. Null where one is not wanted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_element_rail(
    element: *const RailspringElement,
    squares: *mut f64,
    sections: *mut f64,
    rest: *mut f64,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let element = &unsafe { shared(element, "element") }?.0;
        let Some(rail) = &element.rail_at_wheel else {
            return InputError::refuse(
                "element",
                "no rail",
                "a file with the rail by its modes",
                "take the host's own rail, or write the element of a study whose rail is a beam",
            );
        };
        // SAFETY: as the caller promises
        unsafe {
            put_all(squares, rail.modes.iter().map(|mode| mode.square));
            put_all(
                sections,
                rail.modes.iter().flat_map(|mode| [mode.section.x, mode.section.y, mode.section.z]),
            );
            put_all(rest, by_rows(&rail.rest));
        }
        Ok(())
    })
}

/// The wheel's modes with the hub held, of mass 1 kg each: squares of their angular frequencies (1/s²), motions of the rim and masses between the mode and the hub's motions (three values each). Null where one
/// is not wanted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn railspring_element_wheel_modes(
    element: *const RailspringElement,
    squares: *mut f64,
    rims: *mut f64,
    couplings: *mut f64,
) -> RailspringCode {
    guarded(|| {
        // SAFETY: as the caller promises
        let modes = &unsafe { shared(element, "element") }?.0.wheel.modes;
        let three = |of: fn(&RimMode) -> [f64; 3]| modes.iter().flat_map(of);
        // SAFETY: as the caller promises
        unsafe {
            put_all(squares, modes.iter().map(|mode| mode.square));
            put_all(rims, three(|mode| mode.rim.into()));
            put_all(couplings, three(|mode| mode.coupling.into()));
        }
        Ok(())
    })
}

/// Friction that was given, or that of the element where it is not a number.
pub(crate) fn friction(given: f64, element: &Element) -> f64 {
    if given.is_nan() { element.friction } else { given }
}

/// Whether two objects are of one element.
pub(crate) fn same(one: &Arc<Element>, other: &Arc<Element>) -> Result<()> {
    if Arc::ptr_eq(one, other) {
        return Ok(());
    }
    InputError::refuse(
        "other",
        "an object of another element",
        "one of the same element",
        "take a clone of the object",
    )
}
