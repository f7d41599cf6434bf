//! What can go wrong, with the values that say where and why.

use thiserror::Error;

/// Result of every fallible stage of the pipeline.
pub type Result<T> = std::result::Result<T, Error>;

/// An error of the pipeline.
#[derive(Debug, Clone, Error)]
#[non_exhaustive]
pub enum Error {
    /// The input cannot be used.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The input is fine, but the numerics did not reach an answer.
    #[error(transparent)]
    Numerics(#[from] NumericsError),
    /// The user asked to stop.
    #[error("stopped by the user")]
    Interrupted,
}

/// Input that cannot be used: where it stands, what it was, what was expected and how to correct it.
#[derive(Debug, Clone, Error)]
#[error("{key} = {value}: expected {expected}; {remedy}")]
pub struct InputError {
    /// The library's [`InputField`](crate::field::InputField), or what else the value belongs to; a program puts the
    /// key of its file in the place of a field.
    pub key: String,
    /// The offending value, with its unit.
    pub value: String,
    /// What would have been accepted.
    pub expected: String,
    /// How to correct it; fields are in backticks.
    pub remedy: String,
}

impl InputError {
    /// Builds the error from its four parts.
    pub fn new(
        key: impl Into<String>,
        value: impl ToString,
        expected: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self { key: key.into(), value: value.to_string(), expected: expected.into(), remedy: remedy.into() }
    }
}

/// Why an iteration stopped without an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum StopReason {
    /// The allowed number of iterations was used up.
    #[error("the iteration limit was reached")]
    IterationLimit,
    /// A matrix that must be positive definite or regular is not.
    #[error("the matrix is singular or not positive definite")]
    Singular,
    /// A value became infinite or not a number.
    #[error("a value is not finite")]
    NotFinite,
    /// The iterations that a run may take are used up.
    #[error(
        "the bound on the iterations of a run was reached; the load case is beyond what its time step can follow"
    )]
    WorkBound,
    /// The contact reached the edge of the candidate surface.
    #[error("the contact reached the edge of the candidate surface")]
    EdgeOfCandidates,
}

/// An iteration that did not reach an answer.
#[derive(Debug, Clone, Error)]
#[error("{stage}{}: {reason} (iteration {iteration}, residual {residual:.3e}, {active} active contact points)",
    step.map(|s| format!(", step {s}")).unwrap_or_default())]
pub struct NumericsError {
    /// Stage of the pipeline, for instance `contact` or `moving solver`.
    pub stage: String,
    /// Load or time step, if there is one.
    pub step: Option<usize>,
    /// Iteration at which it stopped.
    pub iteration: usize,
    /// Residual at that iteration, in the stage's own measure.
    pub residual: f64,
    /// Number of contact points that carried load.
    pub active: usize,
    /// Why it stopped.
    pub reason: StopReason,
}
