//! The rail beam in series with the law, and the solid rail that it stands for.

use super::bodies::CondensedPair;
use super::geometry::Pair;
use crate::beam::{BeamCorrection, RailBeam};
use nalgebra::Matrix2;
use railspring_profiles::error::Result;

/// The rail beam corrected to the solid rail at midspan at the first touch; flexibilities (y, z) in m/N.
#[derive(Debug, Clone)]
pub struct SeriesBeam {
    /// Factors on the beam's shear and torsion stiffness.
    pub correction: BeamCorrection,
    /// What the solid rail's section carries.
    pub solid: Matrix2<f64>,
    /// The beam as it is.
    pub uncorrected: Matrix2<f64>,
    /// The beam with its correction.
    pub corrected: Matrix2<f64>,
}

impl SeriesBeam {
    /// The correction of `beam` for the solid rail of `bodies`.
    ///
    /// # Errors
    /// [`railspring_profiles::error::InputError`] for a rail too short to be a beam.
    pub fn new(pair: &Pair, bodies: &CondensedPair, beam: &RailBeam) -> Result<Self> {
        let section = &bodies.section;
        let solid = section.carried(&pair.touch_weights(&bodies.rail_on_ends.grid));
        let offset = pair.touch.point - pair.node_line();
        let correction = BeamCorrection::fit(beam, offset, &solid, &section.flexibility)?;
        Ok(Self {
            correction,
            solid,
            uncorrected: beam.static_flexibility(offset),
            corrected: beam.corrected(&correction)?.static_flexibility(offset),
        })
    }

    /// What the corrected beam misses of a flexibility that it stands in series with a spring of `stiffness` (N/m),
    /// over the whole, along the axis 0 (y) or 1 (z).
    pub fn missing(&self, axis: usize, stiffness: f64) -> f64 {
        let missing = self.solid - self.corrected;
        (missing[(axis, axis)] / (self.solid[(axis, axis)] + 1.0 / stiffness)).abs()
    }
}
