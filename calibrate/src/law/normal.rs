//! A normal law of either kind, as a spring takes it.

use super::power::StiffnessLaw;
use super::table::TableLaw;
use railspring_profiles::error::Result;
use railspring_profiles::quadrature::gauss_2_on;

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

    /// Energy stored under `force` (N), `∫ f dδ` from 0, J; 0 for a force below zero.
    pub fn energy(&self, force: f64) -> f64 {
        match self {
            Self::Power(law) => law.energy(law.displacement(force)),
            Self::Table(law) if force > 0.0 => {
                // the displacement is smooth between knots, and panels are many
                const PANELS: usize = 64;
                let panel = |n: usize| {
                    let end = |n: usize| force * n as f64 / PANELS as f64;
                    let (points, half) = gauss_2_on(end(n), end(n + 1));
                    half * points.into_iter().map(|f| law.displacement(f)).sum::<f64>()
                };
                force * law.displacement(force) - (0..PANELS).map(panel).sum::<f64>()
            }
            Self::Table(_) => 0.0,
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
