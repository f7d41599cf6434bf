//! The Python environment of the tests that read mesh files, and the cache folder that it lies in.

use std::path::PathBuf;
use std::sync::{Mutex, OnceLock};

use railspring::python::{Purpose, Python};
use railspring_profiles::monitor::Silent;

/// The folder of the environment and of what tests keep between each other.
pub fn cache() -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
}

/// One environment for all tests, made by the first one.
pub fn python() -> &'static Python {
    static PYTHON: OnceLock<Python> = OnceLock::new();
    static MAKING: Mutex<()> = Mutex::new(());
    let _one = MAKING.lock().unwrap();
    PYTHON.get_or_init(|| {
        Python::prepare(None, &cache(), Purpose::FirstOrder, &Silent).unwrap_or_else(|e| panic!("{e}"))
    })
}
