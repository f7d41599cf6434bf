//! What every command needs to know that solves.

use std::path::PathBuf;

use clap::Args;
use railspring_profiles::error::{Error, InputError};

use super::progress::Progress;
use crate::engine::store::{self, Store, StoreKey};
use crate::results::bodies::estimate::{Budget, Resources};

/// What every command needs to know that solves.
#[derive(Debug, Args)]
pub(super) struct WorkArgs {
    /// Print errors only
    #[arg(short, long)]
    pub(super) quiet: bool,
    /// Print the results as one JSON object
    #[arg(long)]
    pub(super) json: bool,
    /// Number of threads; left out, one for each core. The results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
    /// Python with scikit-fem, meshio and scipy, for mesh files and the cross-check; left out, a virtual environment in
    /// the cache folder
    #[arg(long, value_name = "PATH")]
    python: Option<PathBuf>,
    /// Refuse what is expected to need more memory, GiB; left out, what the machine has available
    #[arg(long, value_name = "GIB", value_parser = positive)]
    pub(super) memory_limit: Option<f64>,
    /// Folder of the store, in which results are kept and found again; left out, one in the user's cache folder
    #[arg(long, value_name = "DIR")]
    pub(super) cache: Option<PathBuf>,
    /// File with the key of a store that several people share: only entries are taken from it that were signed with the key, and those that are kept are signed
    #[arg(long, value_name = "FILE")]
    pub(super) cache_key: Option<PathBuf>,
}

impl WorkArgs {
    pub(super) fn resources<'a>(&'a self, progress: &'a Progress) -> Resources<'a> {
        let budget = Budget::new(self.memory_limit);
        Resources { budget, interpreter: self.python.as_deref(), monitor: progress }
    }

    /// The store, with its key.
    ///
    /// # Errors
    /// Those of [`store::default_folder`], [`StoreKey::read`] and [`Store::open`].
    pub(super) fn store(&self) -> Result<Store, Error> {
        let key = self.cache_key.as_deref().map(StoreKey::read).transpose()?;
        let folder = self.cache.clone().map_or_else(store::default_folder, Ok)?;
        Ok(Store::open(&folder)?.signed_with(key))
    }
}

/// A positive number, as an option takes it.
///
/// # Errors
/// What is expected, for a text that is none.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("expected a positive number".into()),
    }
}

/// Takes as many threads as are wanted, those of the machine by default.
///
/// # Errors
/// [`InputError`] for more threads than the system grants, or if they were taken before.
pub fn take_threads(threads: Option<u16>) -> Result<(), Error> {
    let Some(threads) = threads else { return Ok(()) };
    rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global().map_err(|cause| {
        InputError::new("--threads", cause, "a number of threads that the system grants", "take fewer").into()
    })
}
