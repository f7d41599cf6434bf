//! The cross-section of a beam element.

use crate::analytic::beam::restrained_warping_factor;
use crate::section_analysis::SectionProperties;
use crate::solid::Material;
use railspring_profiles::error::{InputError, Result};

/// How the beam resists torsion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Torsion {
    /// St-Venant torsion alone: sections warp freely.
    SaintVenant,
    /// An effective torsion constant that gives the whole span, fixed against
    /// warping at both ends and twisted at midspan, Vlasov's exact rotation
    /// there. In a stub of half a metre this is about four times stiffer.
    #[default]
    RestrainedWarping,
}

/// Stiffness and inertia of a beam, in its own axes: x along the beam, y and z
/// the principal axes of the section.
///
/// Deflections and twist refer to the node line, which is the line of *shear centres*. A force through it
/// bends without twisting. A lateral force at the rail head twists the rail by its lever to the shear centre,
/// not to the centroid (34 mm higher). Axial displacement refers to the centroid. With this choice of
/// thin-walled beam theory the stiffness matrix is uncoupled. Only the mass, which acts at the centroid,
/// couples sway and twist.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamSection {
    /// E·A, N.
    pub axial: f64,
    /// E·I against deflection along y, N·m².
    pub bending_y: f64,
    /// E·I against deflection along z, N·m².
    pub bending_z: f64,
    /// κ·G·A against deflection along y, N; infinite without shear flexibility.
    pub shear_y: f64,
    /// κ·G·A against deflection along z, N; infinite without shear flexibility.
    pub shear_z: f64,
    /// G·J, N·m².
    pub torsion: f64,
    /// Mass a metre, kg/m.
    pub mass: f64,
    /// ρ·I about z (rotation with deflection along y), kg·m.
    pub rotary_y: f64,
    /// ρ·I about y (rotation with deflection along z), kg·m.
    pub rotary_z: f64,
    /// Polar inertia a metre about the centroid, kg·m.
    pub polar: f64,
    /// Centroid relative to the node line, (y, z), m.
    pub centroid: [f64; 2],
}

/// Factors on the stiffness of a rail beam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamCorrection {
    /// On the shear stiffness against deflection along the section's y.
    pub shear_y: f64,
    /// On the shear stiffness against deflection along the section's z.
    pub shear_z: f64,
    /// On the torsion stiffness.
    pub torsion: f64,
}

impl BeamCorrection {
    /// No correction.
    pub const NONE: Self = Self { shear_y: 1.0, shear_z: 1.0, torsion: 1.0 };
}

impl BeamSection {
    /// The same section with its stiffness corrected.
    #[must_use]
    pub fn corrected(&self, correction: &BeamCorrection) -> Self {
        Self {
            shear_y: self.shear_y * correction.shear_y,
            shear_z: self.shear_z * correction.shear_z,
            torsion: self.torsion * correction.torsion,
            ..*self
        }
    }

    /// The section of a rail of `span` metres fixed at both ends, in the profile frame (z down).
    ///
    /// # Errors
    /// [`InputError`] with key `section of the beam` or `material of the beam` when a property is not positive and finite.
    pub fn rail(
        properties: &SectionProperties,
        material: &Material,
        span: f64,
        torsion: Torsion,
    ) -> Result<Self> {
        let Material { young, density, .. } = *material;
        let shear = material.shear_modulus();
        positive("material of the beam", &[young, shear, density])?;
        let p = properties;
        positive(
            "section of the beam",
            &[
                p.area,
                p.ixx,
                p.iyy,
                p.torsion_constant,
                p.warping_constant,
                p.shear_coefficient_vertical,
                p.shear_coefficient_lateral,
                span,
            ],
        )?;
        let saint_venant = shear * p.torsion_constant;
        let factor = match torsion {
            Torsion::SaintVenant => 1.0,
            Torsion::RestrainedWarping => {
                restrained_warping_factor(span, saint_venant, young * p.warping_constant)
            }
        };
        Ok(Self {
            axial: young * p.area,
            bending_y: young * p.iyy,
            bending_z: young * p.ixx,
            shear_y: p.shear_coefficient_lateral * shear * p.area,
            shear_z: p.shear_coefficient_vertical * shear * p.area,
            torsion: saint_venant / factor,
            mass: density * p.area,
            rotary_y: density * p.iyy,
            rotary_z: density * p.ixx,
            polar: density * (p.ixx + p.iyy),
            centroid: [0.0, p.shear_centre_height - p.centroid_height],
        })
    }
}

fn positive(key: &str, values: &[f64]) -> Result<()> {
    if values.iter().all(|v| v.is_finite() && *v > 0.0) {
        return Ok(());
    }
    InputError::refuse(
        key,
        format!("{values:?}"),
        "positive, finite values",
        "check the units of the section and of the material",
    )
}
