//! A normal law of either kind, as a spring takes it.

use super::{StiffnessLaw, TableLaw};
use crate::error::Result;

/// Tangent stiffness against force: the power law or a table.
#[derive(Debug, Clone, PartialEq)]
pub enum NormalLaw {
    /// `k(f) = a + b·(f/f0)^c`.
    Power(StiffnessLaw),
    /// By knots.
    Table(TableLaw),
}

impl From<StiffnessLaw> for NormalLaw {
    fn from(law: StiffnessLaw) -> Self {
        Self::Power(law)
    }
}

impl From<TableLaw> for NormalLaw {
    fn from(law: TableLaw) -> Self {
        Self::Table(law)
    }
}

impl NormalLaw {
    /// Whether it is a law at all: the fields of a power law are open.
    ///
    /// # Errors
    /// Those of [`StiffnessLaw::new`].
    pub fn check(&self) -> Result<()> {
        match *self {
            Self::Power(StiffnessLaw { a, b, c }) => StiffnessLaw::new(a, b, c).map(drop),
            Self::Table(_) => Ok(()),
        }
    }

    /// Tangent stiffness, N/m, at `force` (N); a force below zero counts as zero.
    pub fn tangent(&self, force: f64) -> f64 {
        match self {
            Self::Power(law) => law.tangent(force),
            Self::Table(law) => law.tangent(force),
        }
    }

    /// Displacement, m, under `force` (N), `∫ df/k` from 0; 0 for a force below zero.
    pub fn displacement(&self, force: f64) -> f64 {
        match self {
            Self::Power(law) => law.displacement(force),
            Self::Table(law) => law.displacement(force),
        }
    }

    /// Force, N, at `displacement` (m), with a `guess` (N) of it that a power law starts from; 0 for a displacement of zero
    /// or below.
    pub fn force_from(&self, displacement: f64, guess: f64) -> f64 {
        match self {
            Self::Power(law) => law.force_from(displacement, guess),
            Self::Table(law) => law.force(displacement),
        }
    }
}
