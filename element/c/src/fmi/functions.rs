//! The functions of the standard that this unit has.

use super::instance::{Instance, Kind, State};
use railspring_profiles::error::{Error, InputError, Result};
use std::ffi::{CStr, CString, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// `fmi3Status`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(dead_code, reason = "the standard's")]
pub(super) enum Status {
    Ok = 0,
    Warning = 1,
    Discard = 2,
    Error = 3,
    Fatal = 4,
}

type LogMessage = Option<unsafe extern "C" fn(*mut c_void, Status, *const c_char, *const c_char)>;

/// An instance with how its importer wants to hear of errors.
pub(super) struct Logged {
    instance: Instance,
    environment: *mut c_void,
    log: LogMessage,
}

impl Logged {
    fn say(&self, status: Status, message: &str) {
        if let (Some(log), Ok(message)) = (self.log, CString::new(message.replace('\0', " "))) {
            // SAFETY: the importer's own function with its environment
            unsafe { log(self.environment, status, c"logStatusError".as_ptr(), message.as_ptr()) };
        }
    }
}

/// Does `work` with an instance.
///
/// # Safety
/// The pointer is null or an instance of this library.
unsafe fn with(instance: *mut Logged, work: impl FnOnce(&mut Instance) -> Result<()>) -> Status {
    // SAFETY: as the caller promises
    let Some(logged) = (unsafe { instance.as_mut() }) else { return Status::Error };
    let (status, message) = match catch_unwind(AssertUnwindSafe(|| work(&mut logged.instance))) {
        Ok(Ok(())) => return Status::Ok,
        Ok(Err(error @ Error::Numerics(_))) => (Status::Discard, error.to_string()),
        Ok(Err(error)) => (Status::Error, error.to_string()),
        Err(_) => (Status::Fatal, "a defect of the library".into()),
    };
    logged.say(status, &message);
    status
}

/// The values at an address; none where there are none.
///
/// # Safety
/// It is null, or there are so many.
unsafe fn values<'a, T>(at: *const T, count: usize) -> &'a [T] {
    // SAFETY: as the caller promises
    if at.is_null() || count == 0 { &[] } else { unsafe { std::slice::from_raw_parts(at, count) } }
}

/// The same to write them.
///
/// # Safety
/// As there.
unsafe fn room<'a, T>(at: *mut T, count: usize) -> &'a mut [T] {
    // SAFETY: as the caller promises
    if at.is_null() || count == 0 { &mut [] } else { unsafe { std::slice::from_raw_parts_mut(at, count) } }
}

/// Writes a value that the importer has room for.
///
/// # Safety
/// It is null, or there is room.
unsafe fn tell<T>(at: *mut T, value: T) {
    if !at.is_null() {
        // SAFETY: as the caller promises
        unsafe { at.write(value) };
    }
}

fn as_many(references: usize, values: usize) -> Result<()> {
    if references == values {
        return Ok(());
    }
    InputError::refuse(
        "nValues",
        values,
        format!("{references}, as many as references"),
        "give a value for each",
    )
}

unsafe fn instantiate(
    kind: Kind,
    token: *const c_char,
    resources: *const c_char,
    environment: *mut c_void,
    log: LogMessage,
) -> *mut Logged {
    let text = |at: *const c_char| match at.is_null() {
        true => "",
        // SAFETY: texts of the importer
        false => unsafe { CStr::from_ptr(at) }.to_str().unwrap_or_default(),
    };
    let made = catch_unwind(|| Instance::new(kind, Path::new(text(resources)), text(token)));
    match made {
        Ok(Ok(instance)) => Box::into_raw(Box::new(Logged { instance, environment, log })),
        failed => {
            let message = failed.map_or("a defect of the library".into(), |made| {
                made.map_or_else(|error| error.to_string(), |_| String::new())
            });
            if let (Some(log), Ok(message)) = (log, CString::new(message.replace('\0', " "))) {
                // SAFETY: the importer's own function with its environment
                unsafe { log(environment, Status::Error, c"logStatusError".as_ptr(), message.as_ptr()) };
            }
            std::ptr::null_mut()
        }
    }
}

#[unsafe(no_mangle)]
extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetDebugLogging(
    _: *mut Logged,
    _: bool,
    _: usize,
    _: *const *const c_char,
) -> Status {
    Status::Ok
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3InstantiateModelExchange(
    _name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    _logging: bool,
    environment: *mut c_void,
    log: LogMessage,
) -> *mut Logged {
    // SAFETY: as the importer promises
    unsafe { instantiate(Kind::ModelExchange, token, resources, environment, log) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _name: *const c_char,
    token: *const c_char,
    resources: *const c_char,
    _visible: bool,
    _logging: bool,
    _events: bool,
    _early: bool,
    _intermediate: *const u32,
    _count: usize,
    environment: *mut c_void,
    log: LogMessage,
    _update: *const c_void,
) -> *mut Logged {
    // SAFETY: as the importer promises
    unsafe { instantiate(Kind::CoSimulation, token, resources, environment, log) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3FreeInstance(instance: *mut Logged) {
    if !instance.is_null() {
        // SAFETY: an instance of this library that nobody uses any more
        drop(unsafe { Box::from_raw(instance) });
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3EnterInitializationMode(
    instance: *mut Logged,
    _tolerance_defined: bool,
    _tolerance: f64,
    start: f64,
    _stop_defined: bool,
    _stop: f64,
) -> Status {
    // SAFETY: as the importer promises
    unsafe {
        with(instance, |instance| {
            instance.begin(start);
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3ExitInitializationMode(instance: *mut Logged) -> Status {
    // SAFETY: as the importer promises
    unsafe { with(instance, Instance::initialised) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3EnterEventMode(_: *mut Logged) -> Status {
    Status::Ok
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3EnterStepMode(_: *mut Logged) -> Status {
    Status::Ok
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3EnterContinuousTimeMode(_: *mut Logged) -> Status {
    Status::Ok
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3Terminate(_: *mut Logged) -> Status {
    Status::Ok
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3Reset(instance: *mut Logged) -> Status {
    // SAFETY: as the importer promises
    unsafe {
        with(instance, |instance| {
            instance.reset();
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetFloat64(
    instance: *mut Logged,
    references: *const u32,
    count: usize,
    into: *mut f64,
    room_for: usize,
) -> Status {
    // SAFETY: as the importer promises
    let (references, into) = unsafe { (values(references, count), room(into, room_for)) };
    // SAFETY: as the importer promises
    unsafe {
        with(instance, |instance| {
            as_many(references.len(), into.len())?;
            for (reference, into) in references.iter().zip(into) {
                *into = instance.get(*reference)?;
            }
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetFloat64(
    instance: *mut Logged,
    references: *const u32,
    count: usize,
    given: *const f64,
    many: usize,
) -> Status {
    // SAFETY: as the importer promises
    let (references, given) = unsafe { (values(references, count), values(given, many)) };
    // SAFETY: as the importer promises
    unsafe {
        with(instance, |instance| {
            as_many(references.len(), given.len())?;
            references.iter().zip(given).try_for_each(|(reference, value)| instance.set(*reference, *value))
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetBoolean(
    instance: *mut Logged,
    references: *const u32,
    count: usize,
    into: *mut bool,
    room_for: usize,
) -> Status {
    // SAFETY: as the importer promises
    let (references, into) = unsafe { (values(references, count), room(into, room_for)) };
    // SAFETY: as the importer promises
    unsafe {
        with(instance, |instance| {
            as_many(references.len(), into.len())?;
            for (reference, into) in references.iter().zip(into) {
                *into = instance.get_flag(*reference)?;
            }
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetBoolean(
    instance: *mut Logged,
    references: *const u32,
    count: usize,
    given: *const bool,
    many: usize,
) -> Status {
    // SAFETY: as the importer promises
    let (references, given) = unsafe { (values(references, count), values(given, many)) };
    // SAFETY: as the importer promises
    unsafe {
        with(instance, |instance| {
            as_many(references.len(), given.len())?;
            let mut both = references.iter().zip(given);
            both.try_for_each(|(reference, value)| instance.set_flag(*reference, *value))
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetFMUState(instance: *mut Logged, state: *mut *mut State) -> Status {
    // SAFETY: as the importer promises
    unsafe {
        with(instance, |instance| {
            match state.as_mut() {
                Some(kept) if !kept.is_null() => (**kept).clone_from(&instance.state),
                _ => tell(state, Box::into_raw(Box::new(instance.state.clone()))),
            }
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetFMUState(instance: *mut Logged, state: *const State) -> Status {
    // SAFETY: as the importer promises
    unsafe {
        with(instance, |instance| match state.as_ref() {
            Some(state) => {
                instance.state.clone_from(state);
                Ok(())
            }
            None => InputError::refuse("FMUState", "null", "a state of fmi3GetFMUState", "keep one first"),
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3FreeFMUState(_: *mut Logged, state: *mut *mut State) -> Status {
    // SAFETY: as the importer promises
    unsafe {
        if let Some(kept) = state.as_mut().filter(|kept| !kept.is_null()) {
            drop(Box::from_raw(std::mem::replace(kept, std::ptr::null_mut())));
        }
    }
    Status::Ok
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetDirectionalDerivative(
    instance: *mut Logged,
    unknowns: *const u32,
    unknown_count: usize,
    knowns: *const u32,
    known_count: usize,
    seed: *const f64,
    seed_count: usize,
    into: *mut f64,
    room_for: usize,
) -> Status {
    // SAFETY: as the importer promises
    let (unknowns, knowns) = unsafe { (values(unknowns, unknown_count), values(knowns, known_count)) };
    // SAFETY: as the importer promises
    let (seed, into) = unsafe { (values(seed, seed_count), room(into, room_for)) };
    // SAFETY: as the importer promises
    unsafe {
        with(instance, |instance| {
            as_many(knowns.len(), seed.len())?;
            as_many(unknowns.len(), into.len())?;
            into.copy_from_slice(&instance.derivative(unknowns, knowns, seed)?);
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3UpdateDiscreteStates(
    _instance: *mut Logged,
    needs_update: *mut bool,
    terminate: *mut bool,
    nominals_changed: *mut bool,
    values_changed: *mut bool,
    next_event: *mut bool,
    _next_time: *mut f64,
) -> Status {
    for flag in [needs_update, terminate, nominals_changed, values_changed, next_event] {
        // SAFETY: as the importer promises
        unsafe { tell(flag, false) };
    }
    Status::Ok
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3CompletedIntegratorStep(
    instance: *mut Logged,
    _no_way_back: bool,
    event: *mut bool,
    terminate: *mut bool,
) -> Status {
    // SAFETY: as the importer promises
    unsafe {
        tell(event, false);
        tell(terminate, false);
        with(instance, Instance::integrated)
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetTime(instance: *mut Logged, time: f64) -> Status {
    // SAFETY: as the importer promises
    unsafe {
        with(instance, |instance| {
            instance.set_time(time);
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetContinuousStates(
    instance: *mut Logged,
    states: *const f64,
    count: usize,
) -> Status {
    // SAFETY: as the importer promises
    let states = unsafe { values(states, count) };
    // SAFETY: as the importer promises
    unsafe {
        with(instance, |instance| {
            as_many(instance.state_count(), states.len())?;
            instance.set_states(states);
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetContinuousStates(instance: *mut Logged, into: *mut f64, count: usize) -> Status {
    // SAFETY: as the importer promises
    let into = unsafe { room(into, count) };
    // SAFETY: as the importer promises
    unsafe {
        with(instance, |instance| {
            as_many(instance.state_count(), into.len())?;
            into.iter_mut().zip(instance.states()).for_each(|(into, state)| *into = state);
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetContinuousStateDerivatives(
    instance: *mut Logged,
    into: *mut f64,
    count: usize,
) -> Status {
    // SAFETY: as the importer promises
    let into = unsafe { room(into, count) };
    // SAFETY: as the importer promises
    unsafe {
        with(instance, |instance| {
            as_many(instance.state_count(), into.len())?;
            into.copy_from_slice(&instance.derivatives()?);
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetNominalsOfContinuousStates(
    instance: *mut Logged,
    into: *mut f64,
    count: usize,
) -> Status {
    // SAFETY: as the importer promises
    let into = unsafe { room(into, count) };
    // SAFETY: as the importer promises
    unsafe {
        with(instance, |instance| {
            as_many(instance.state_count(), into.len())?;
            into.fill(1.0);
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetNumberOfContinuousStates(instance: *mut Logged, count: *mut usize) -> Status {
    // SAFETY: as the importer promises
    unsafe {
        with(instance, |instance| {
            tell(count, instance.state_count());
            Ok(())
        })
    }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetNumberOfEventIndicators(_: *mut Logged, count: *mut usize) -> Status {
    // SAFETY: as the importer promises
    unsafe { tell(count, 0) };
    Status::Ok
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetEventIndicators(_: *mut Logged, _: *mut f64, count: usize) -> Status {
    if count == 0 { Status::Ok } else { Status::Error }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3DoStep(
    instance: *mut Logged,
    time: f64,
    length: f64,
    _no_way_back: bool,
    event: *mut bool,
    terminate: *mut bool,
    early: *mut bool,
    last: *mut f64,
) -> Status {
    // SAFETY: as the importer promises
    unsafe {
        for flag in [event, terminate, early] {
            tell(flag, false);
        }
        tell(last, time);
        with(instance, |instance| {
            instance.step(time, length)?;
            tell(last, time + length);
            Ok(())
        })
    }
}
