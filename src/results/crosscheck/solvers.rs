//! The reference solvers of a cross-check: what has to be installed for its questions, and in which versions it is.

use railspring_profiles::error::Result;

use crate::python::{self, Purpose, Python};
use crate::results::bodies::estimate::Resources;
use crate::results::crosscheck::calculix;
use crate::results::crosscheck::exchange::Case;

/// The reference solvers, found and able to run.
pub struct Solvers {
    pub(crate) python: Python,
    /// Program and name of CalculiX, if it is to run, too.
    pub(super) calculix: Option<(&'static str, String)>,
}

impl Solvers {
    /// Finds the programs for some questions, with or without CalculiX.
    ///
    /// # Errors
    /// [`railspring_profiles::error::InputError`] that says which program is missing and how to get it.
    pub fn find(cases: &[Case], calculix: bool, resources: &Resources<'_>) -> Result<Self> {
        let calculix = calculix.then(calculix::version).transpose()?;
        let cache = python::cache_folder()?;
        let python = Python::prepare(resources.interpreter, &cache, purpose(cases), resources.monitor)?;
        Ok(Self { python, calculix })
    }

    /// What an answer of theirs depends on besides the questions: the versions of all programs.
    pub fn versions(&self) -> (String, &str, Option<&str>) {
        (
            python::package_hash(),
            self.python.versions(),
            self.calculix.as_ref().map(|(_, name)| name.as_str()),
        )
    }
}

/// What the environment of Python is made for.
pub(super) fn purpose(cases: &[Case]) -> Purpose {
    if cases.contains(&Case::SecondOrder) { Purpose::SecondOrder } else { Purpose::FirstOrder }
}
