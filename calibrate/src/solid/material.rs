//! The material of a solid: isotropic and linear elastic.

use nalgebra::SMatrix;
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::field::InputField;
use serde::Serialize;

/// Isotropic linear elastic material.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Material {
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Density, kg/m³.
    pub density: f64,
    /// Damping proportional to stiffness, s: the damping matrix is this times the stiffness matrix, and a mode
    /// of angular frequency ω has the damping ratio `damping·ω/2`. Statics do not see it.
    pub damping: f64,
}

impl Material {
    /// The same with a damping, s.
    #[must_use]
    pub fn damped(&self, damping: f64) -> Self {
        Self { damping, ..*self }
    }

    /// Rail and wheel steel: 210 GPa, 0.3, 7850 kg/m³, undamped.
    pub const STEEL: Self = Self { young: 210e9, poisson: 0.3, density: 7850.0, damping: 0.0 };

    /// Checks that the constants describe a stable, compressible material.
    ///
    /// # Errors
    /// [`InputError`] naming the constant that is out of range.
    pub fn check(&self) -> Result<()> {
        let refuse = |field: InputField, value: String, expected: &str| {
            InputError::refuse(field, value, expected, "correct the material constant")
        };
        if !(self.young > 0.0 && self.young.is_finite()) {
            return refuse(InputField::Young, format!("{} GPa", self.young * 1e-9), "a positive modulus");
        }
        if !(self.poisson > -1.0 && self.poisson < 0.5) {
            return refuse(InputField::Poisson, self.poisson.to_string(), "a ratio between -1 and 0.5");
        }
        if !(self.density > 0.0 && self.density.is_finite()) {
            return refuse(InputField::Density, format!("{} kg/m³", self.density), "a positive density");
        }
        if !(self.damping >= 0.0 && self.damping.is_finite()) {
            return refuse(InputField::Damping, self.damping.to_string(), "a damping that is not negative");
        }
        Ok(())
    }

    /// Shear modulus, Pa.
    pub fn shear_modulus(&self) -> f64 {
        self.young / (2.0 * (1.0 + self.poisson))
    }

    /// Contact modulus E* of a body of this material on one of the `other`, Pa.
    pub fn contact_modulus(&self, other: &Self) -> f64 {
        crate::analytic::hertz::contact_modulus(self.young, self.poisson, other.young, other.poisson)
    }

    /// Elasticity matrix, 6×6, Pa, for strains (xx, yy, zz, xy, yz, zx) with engineering shears.
    pub fn elasticity(&self) -> SMatrix<f64, 6, 6> {
        let shear = self.shear_modulus();
        let lame = self.young * self.poisson / ((1.0 + self.poisson) * (1.0 - 2.0 * self.poisson));
        let mut d = SMatrix::zeros();
        for i in 0..3 {
            for j in 0..3 {
                d[(i, j)] = lame;
            }
            d[(i, i)] = lame + 2.0 * shear;
            d[(i + 3, i + 3)] = shear;
        }
        d
    }
}
