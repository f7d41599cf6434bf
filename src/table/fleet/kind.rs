//! Wheels or rails: what their columns are called.

use crate::engine::columns::Cell;

/// Which bodies a fleet is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Measured wheels.
    Wheel,
    /// Measured rails.
    Rail,
}

impl Kind {
    /// Its name in columns.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wheel => "wheel",
            Self::Rail => "rail",
        }
    }

    /// The same of several.
    pub fn several(self) -> &'static str {
        match self {
            Self::Wheel => "wheels",
            Self::Rail => "rails",
        }
    }

    /// The column of what several bodies belong to, and what messages call it.
    pub fn group(self) -> [&'static str; 2] {
        match self {
            Self::Wheel => ["wheel_vehicle", "vehicle"],
            Self::Rail => ["rail_line", "line"],
        }
    }
}

/// A number, also one that was read as a text.
pub fn number(cell: &Cell) -> Option<f64> {
    match cell {
        Cell::Number(number) => *number,
        Cell::Text(text) => text.trim().parse().ok().filter(|number: &f64| number.is_finite()),
    }
}
