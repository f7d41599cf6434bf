//! A normal law of any form, as a spring takes it.

use super::power::StiffnessLaw;
use super::series::SeriesLaw;
use super::steps::StepLaw;
use super::table::TableLaw;
use railspring_profiles::error::Result;
use serde::Deserialize;

/// How a law is written: the published form where nothing is said.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Form {
    /// `k = a + b·(f/f0)^c`, the published form ([`StiffnessLaw`]).
    #[default]
    Power,
    /// A power and a linear spring in series ([`SeriesLaw`]).
    Series,
    /// Two powers with a step between ([`StepLaw`]).
    Steps,
    /// The tangents themselves ([`TableLaw`]).
    Table,
}

impl Form {
    /// Its name in files and options.
    pub fn name(self) -> &'static str {
        match self {
            Self::Power => "power",
            Self::Series => "series",
            Self::Steps => "steps",
            Self::Table => "table",
        }
    }
}

/// Tangent stiffness against force.
#[derive(Debug, Clone, PartialEq)]
pub enum NormalLaw {
    /// `k(f) = a + b·(f/f0)^c`.
    Power(StiffnessLaw),
    /// A power and a linear spring in series.
    Series(SeriesLaw),
    /// Two powers with a step between.
    Steps(StepLaw),
    /// By knots.
    Table(TableLaw),
}

impl From<StiffnessLaw> for NormalLaw {
    fn from(law: StiffnessLaw) -> Self {
        Self::Power(law)
    }
}

impl From<SeriesLaw> for NormalLaw {
    fn from(law: SeriesLaw) -> Self {
        Self::Series(law)
    }
}

impl From<StepLaw> for NormalLaw {
    fn from(law: StepLaw) -> Self {
        Self::Steps(law)
    }
}

impl From<TableLaw> for NormalLaw {
    fn from(law: TableLaw) -> Self {
        Self::Table(law)
    }
}

impl NormalLaw {
    /// The form in which it is written.
    pub fn form(&self) -> Form {
        match self {
            Self::Power(_) => Form::Power,
            Self::Series(_) => Form::Series,
            Self::Steps(_) => Form::Steps,
            Self::Table(_) => Form::Table,
        }
    }

    /// Whether it is a law at all: the fields of a power law are open.
    ///
    /// # Errors
    /// Those of [`StiffnessLaw::new`].
    pub fn check(&self) -> Result<()> {
        match *self {
            Self::Power(StiffnessLaw { a, b, c }) => StiffnessLaw::new(a, b, c).map(drop),
            Self::Series(_) | Self::Steps(_) | Self::Table(_) => Ok(()),
        }
    }

    /// Tangent stiffness, N/m, at `force` (N); a force below zero counts as zero.
    pub fn tangent(&self, force: f64) -> f64 {
        match self {
            Self::Power(law) => law.tangent(force),
            Self::Series(law) => law.tangent(force),
            Self::Steps(law) => law.tangent(force),
            Self::Table(law) => law.tangent(force),
        }
    }

    /// Displacement, m, under `force` (N), `∫ df/k` from 0; 0 for a force below zero.
    pub fn displacement(&self, force: f64) -> f64 {
        match self {
            Self::Power(law) => law.displacement(force),
            Self::Series(law) => law.displacement(force),
            Self::Steps(law) => law.displacement(force),
            Self::Table(law) => law.displacement(force),
        }
    }

    /// Energy stored under `force` (N), `∫ f dδ` from 0, J; 0 for a force below zero.
    pub fn energy(&self, force: f64) -> f64 {
        match self {
            Self::Power(law) => law.energy(law.displacement(force)),
            Self::Series(law) => law.energy(force),
            Self::Steps(law) => law.energy(force),
            Self::Table(law) => law.energy(force),
        }
    }

    /// Force, N, at `displacement` (m), with a `guess` (N) of it that the search starts from, but for a table; 0 for a displacement of zero
    /// or below.
    pub fn force_from(&self, displacement: f64, guess: f64) -> f64 {
        match self {
            Self::Power(law) => law.force_from(displacement, guess),
            Self::Series(law) => law.force_from(displacement, guess),
            Self::Steps(law) => law.force_from(displacement, guess),
            Self::Table(law) => law.force(displacement),
        }
    }
}
