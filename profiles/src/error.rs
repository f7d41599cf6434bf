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
    /// The input is valid, but the numerics did not converge.
    #[error(transparent)]
    Numerics(#[from] NumericsError),
    /// The user asked to stop.
    #[error("stopped by the user")]
    Interrupted,
}

impl Error {
    /// The error with the load or time step at which it came up; input errors know none.
    #[must_use]
    pub fn at_step(self, step: usize) -> Self {
        match self {
            Self::Numerics(e) => NumericsError { step: Some(step), ..e }.into(),
            other => other,
        }
    }
}

/// The outcome of a part whose failure does not end the whole, as an interruption does.
///
/// # Errors
/// An interruption.
pub fn unless_interrupted<T>(part: Result<T>) -> Result<Result<T>> {
    match part {
        Err(Error::Interrupted) => Err(Error::Interrupted),
        part => Ok(part),
    }
}

/// The same with the reason of a failure as a sentence.
///
/// # Errors
/// An interruption.
pub fn or_reason<T>(part: Result<T>) -> Result<std::result::Result<T, String>> {
    unless_interrupted(part).map(|part| part.map_err(|error| error.to_string()))
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

/// Most characters of a part of an error.
const LONGEST_PART: usize = 2000;
/// Most characters of a value in an error.
const LONGEST_VALUE: usize = 400;

impl InputError {
    /// Builds the error from its four parts, each [printable] and of a bounded length.
    pub fn new(
        key: impl Into<String>,
        value: impl ToString,
        expected: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self {
            key: printable(key.into(), LONGEST_PART),
            value: printable(value.to_string(), LONGEST_VALUE),
            expected: printable(expected.into(), LONGEST_PART),
            remedy: printable(remedy.into(), LONGEST_PART),
        }
    }

    /// The same as what comes of it.
    ///
    /// # Errors
    /// Always.
    pub fn refuse<T>(
        key: impl Into<String>,
        value: impl ToString,
        expected: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Result<T> {
        Err(Self::new(key, value, expected, remedy).into())
    }
}

/// An error on a line of a file.
pub(crate) fn on_line(
    file: &str,
    line: usize,
    value: impl ToString,
    expected: impl Into<String>,
    remedy: impl Into<String>,
) -> Error {
    InputError::new(format!("{file}:{line}"), value, expected, remedy).into()
}

/// Text that does a terminal no harm: control characters, and those that turn the direction of writing, are escaped;
/// beyond `most` characters it is cut off and its length is given.
///
/// ```
/// use railspring_profiles::error::printable;
/// assert_eq!(printable("1 \u{1b}[2J".into(), 80), "1 \\u{1b}[2J");
/// assert_eq!(printable("123456789".into(), 4), "1234… (9 characters)");
/// ```
pub fn printable(text: String, most: usize) -> String {
    let hidden = |c: char| {
        c.is_control()
            || matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
    };
    let escaped = if text.contains(hidden) {
        let mut escaped = String::new();
        for c in text.chars().take(most.saturating_add(1)) {
            if hidden(c) { escaped.extend(c.escape_default()) } else { escaped.push(c) }
        }
        Some(escaped)
    } else {
        None
    };
    let shown = escaped.as_deref().unwrap_or(&text);
    match shown.char_indices().nth(most) {
        Some((end, _)) => format!("{}… ({} characters)", &shown[..end], text.chars().count()),
        None => escaped.unwrap_or(text),
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
    /// Bodies whose compliance is not positive definite move against the load: their contact elements are coarse beside the patch and the curvature of
    /// the profiles.
    #[error("the bodies move against the load: their contact elements are too coarse for the patch")]
    Indefinite,
    /// The iterations that a run may take are used up.
    #[error(
        "the bound on the iterations of a run was reached; the load case is beyond what its time step can follow"
    )]
    WorkBound,
    /// The contact reached the edge of the candidate surface.
    #[error("the contact reached the edge of the candidate surface")]
    EdgeOfCandidates,
    /// The contact reached the end of the contact window along the track.
    #[error("the contact reached the end of the contact window along the track")]
    EndOfWindow,
    /// The fine grid of the contact does not hold the patch, however often its reach was widened.
    #[error("the fine grid of the contact does not hold the patch after all changes of its reach")]
    GridUnsettled,
    /// The contact is so steep that its normal force goes beyond the largest load by more than a quarter.
    #[error(
        "the normal force of the steep contact would be over 1.25 times the largest load; press along the normal (laws by contact angle), or give smaller loads"
    )]
    SteepContact,
    /// A reduced body has fewer modes than the forces of a run need.
    #[error("the forces still change with the number of modes of the bodies")]
    TooFewModes,
}

/// An iteration that did not converge.
#[derive(Debug, Clone, Error)]
#[error("{stage}{}: {reason} ({}residual {residual:.3e}, {active} active contact points)",
    step.map(|s| format!(", step {s}")).unwrap_or_default(),
    if *iteration > 0 { format!("iteration {iteration}, ") } else { String::new() })]
pub struct NumericsError {
    /// Stage of the pipeline, for instance `contact` or `moving solver`.
    pub stage: String,
    /// Load or time step, if there is one.
    pub step: Option<usize>,
    /// Iteration at which it stopped; 0 where none was made.
    pub iteration: usize,
    /// Residual at that iteration, in the stage's own measure.
    pub residual: f64,
    /// Number of contact points that carried load.
    pub active: usize,
    /// Why it stopped.
    pub reason: StopReason,
}

impl NumericsError {
    /// A stage that stopped without a step and before any iteration, with `active` contact points.
    pub fn new(stage: impl Into<String>, reason: StopReason, residual: f64, active: usize) -> Self {
        Self { stage: stage.into(), step: None, iteration: 0, residual, active, reason }
    }

    /// The same after so many iterations.
    #[must_use]
    pub fn after(self, iteration: usize) -> Self {
        Self { iteration, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: the text of a stop names its iteration where there was one, and none where nothing was iterated.
    #[test]
    fn a_stop_names_its_iteration_where_there_was_one() {
        let mut stop = NumericsError {
            stage: "contact".into(),
            step: Some(8),
            iteration: 3,
            residual: 0.25,
            active: 7,
            reason: StopReason::TooFewModes,
        };
        let said = stop.to_string();
        assert!(said.ends_with("(iteration 3, residual 2.500e-1, 7 active contact points)"), "{said}");
        stop.iteration = 0;
        let said = stop.to_string();
        assert!(said.starts_with("contact, step 8: the forces still change"), "{said}");
        assert!(said.ends_with("of the bodies (residual 2.500e-1, 7 active contact points)"), "{said}");
    }
}
