//! What a profile belongs to: rail or wheel.

/// What a profile belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProfileKind {
    /// A rail.
    Rail,
    /// A wheel.
    Wheel,
}

impl ProfileKind {
    /// Name in messages and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rail => "rail",
            Self::Wheel => "wheel",
        }
    }
}
