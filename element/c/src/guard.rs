//! Codes and messages; nothing unwinds into a foreign program.

use railspring_profiles::error::{Error, InputError, Result};
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What a function returns.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RailspringCode {
    /// Done.
    Done = 0,
    /// The input cannot be used: a pointer that is null, a motion that is no number or out of range, a file of another layout, a wheel that has left the profiles.
    Input = 2,
    /// The input can be used, but no balance of forces was found: try a shorter step.
    Numerics = 3,
    /// A defect of the library: free the object, and report the message.
    Defect = 4,
}

thread_local! {
    static MESSAGE: RefCell<CString> = RefCell::new(CString::default());
}

/// The version of the library, for instance "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn railspring_version() -> *const c_char {
    const VERSION: &CStr =
        match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
            Ok(version) => version,
            Err(_) => c"",
        };
    VERSION.as_ptr()
}

/// What was wrong in the last call of this thread that did not return RAILSPRING_CODE_DONE, in UTF-8; empty where there was none. It stays until the next such call of the thread.
#[unsafe(no_mangle)]
pub extern "C" fn railspring_message() -> *const c_char {
    MESSAGE.with_borrow(|message| message.as_ptr())
}

fn say(message: &str) {
    let message = CString::new(message.replace('\0', " ")).unwrap_or_default();
    MESSAGE.with_borrow_mut(|last| *last = message);
}

/// Does `work`; its code.
pub(crate) fn guarded(work: impl FnOnce() -> Result<()>) -> RailspringCode {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => RailspringCode::Done,
        Ok(Err(error)) => {
            say(&error.to_string());
            if matches!(error, Error::Numerics(_)) { RailspringCode::Numerics } else { RailspringCode::Input }
        }
        Err(cause) => {
            let text = cause.downcast_ref::<String>().map(String::as_str);
            say(text.or_else(|| cause.downcast_ref::<&str>().copied()).unwrap_or("a defect"));
            RailspringCode::Defect
        }
    }
}

fn null(name: &str) -> Error {
    InputError::new(name, "null", "a pointer", "create the object first, and give an address for each result")
        .into()
}

/// What a pointer points to.
///
/// # Safety
/// It is null, or points to a valid object that nobody changes meanwhile.
pub(crate) unsafe fn shared<'a, T>(pointer: *const T, name: &str) -> Result<&'a T> {
    // SAFETY: as the caller promises
    unsafe { pointer.as_ref() }.ok_or_else(|| null(name))
}

/// The same to change it.
///
/// # Safety
/// It is null, or points to a valid object that nobody else uses meanwhile.
pub(crate) unsafe fn exclusive<'a, T>(pointer: *mut T, name: &str) -> Result<&'a mut T> {
    // SAFETY: as the caller promises
    unsafe { pointer.as_mut() }.ok_or_else(|| null(name))
}

/// Writes a result.
///
/// # Safety
/// The pointer is null, or points to memory for it.
pub(crate) unsafe fn put<T>(pointer: *mut T, value: T, name: &str) -> Result<()> {
    if pointer.is_null() {
        return Err(null(name));
    }
    // SAFETY: as the caller promises
    unsafe { pointer.write(value) };
    Ok(())
}

/// Hands an object over to a foreign program.
///
/// # Safety
/// The pointer is null, or points to memory for its address.
pub(crate) unsafe fn hand_over<T>(pointer: *mut *mut T, value: T, name: &str) -> Result<()> {
    if pointer.is_null() {
        return Err(null(name));
    }
    // SAFETY: as the caller promises
    unsafe { pointer.write(Box::into_raw(Box::new(value))) };
    Ok(())
}

/// As many values as there are at an address; none are left out, and null takes none.
///
/// # Safety
/// The pointer is null, or points to memory for all of them.
pub(crate) unsafe fn put_all(pointer: *mut f64, values: impl IntoIterator<Item = f64>) {
    if pointer.is_null() {
        return;
    }
    for (i, value) in values.into_iter().enumerate() {
        // SAFETY: as the caller promises
        unsafe { pointer.add(i).write(value) };
    }
}

/// Frees an object.
///
/// # Safety
/// It is null, or was made by [`hand_over`] and is used by nobody any more.
pub(crate) unsafe fn free<T>(pointer: *mut T) {
    if !pointer.is_null() {
        // SAFETY: as the caller promises
        drop(unsafe { Box::from_raw(pointer) });
    }
}
