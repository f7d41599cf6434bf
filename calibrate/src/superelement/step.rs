//! The steps in which a body is condensed.

/// What is done with a body, in turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// The matrix is assembled.
    Assembly,
    /// It is factored.
    Factorisation,
    /// The compliance of the retained equations is found.
    Condensation,
    /// The modes are found.
    Modes,
}
