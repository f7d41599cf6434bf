//! How a command fails: what is said, and the exit code.

use railspring_profiles::error::{Error, InputError};

use crate::study::{LocatedError, Mistakes, Study};

/// A failure with the place where it stands.
#[derive(Debug)]
pub enum Failure {
    /// Mistakes of a study, each at its line.
    Study(Mistakes),
    /// An error of a stage that concerns a key of the study, at its line.
    Located(LocatedError),
    /// Any other error.
    Plain(Error),
}

impl Failure {
    /// What is said about it, and the exit code.
    pub fn messages(&self) -> (Vec<String>, u8) {
        match self {
            Self::Study(mistakes) => (mistakes.messages(), 2),
            Self::Located(error) => (vec![error.to_string()], 2),
            Self::Plain(error) => (vec![error.to_string()], exit_code(error)),
        }
    }

    /// An error of a stage, with the keys and the place of the study if it concerns one of them.
    pub fn of_stage(study: &Study, error: Error) -> Self {
        match error {
            Error::Input(input) => match study.source.with_keys(input) {
                input if study.owns(&input.key) => Self::Located(study.source.locate(input)),
                input => Self::Plain(input.into()),
            },
            other => Self::Plain(other),
        }
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Plain(error)
    }
}

impl From<InputError> for Failure {
    fn from(error: InputError) -> Self {
        Self::Plain(error.into())
    }
}

impl From<Mistakes> for Failure {
    fn from(mistakes: Mistakes) -> Self {
        Self::Study(mistakes)
    }
}

pub(super) fn exit_code(error: &Error) -> u8 {
    match error {
        Error::Input(_) => 2,
        Error::Numerics(_) => 3,
        Error::Interrupted => 130,
        // The error type may grow; an error of an unknown kind is no usable input.
        _ => 2,
    }
}
