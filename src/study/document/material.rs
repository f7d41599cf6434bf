//! The keys of materials: of both bodies, of one body, and of a group of a mesh.

use std::f64::consts::PI;

use railspring_calibrate::solid::Material;
use railspring_profiles::field::InputField;
use railspring_profiles::units::GIGAPASCAL;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The linear elastic material of both bodies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MaterialKeys {
    /// Young's modulus, GPa.
    #[schemars(range(min = 20.0, max = 1000.0), extend("x-field" = InputField::Young.name()))]
    pub young_gpa: f64,
    /// Poisson's ratio.
    #[schemars(range(min = 0.0, max = 0.49), extend("x-field" = InputField::Poisson.name()))]
    pub poisson: f64,
    /// Density, kg/m³.
    #[schemars(range(min = 100.0, max = 30000.0), extend("x-field" = InputField::Density.name()))]
    pub density_kg_per_m3: f64,
    /// Damping ratio of the steel, proportional to frequency, at `damping_frequency_hz`. The publication
    /// names none; but an undamped rail leaves the wheel at every step of its highest modes, and the motion
    /// then depends on the time step.
    #[schemars(range(min = 0.0, max = 1.0), extend("x-field" = InputField::Damping.name()))]
    pub damping_ratio: f64,
    /// Frequency at which the damping ratio holds, Hz.
    #[schemars(range(min = 1.0, max = 1e6))]
    pub damping_frequency_hz: f64,
}

impl Default for MaterialKeys {
    fn default() -> Self {
        Self {
            young_gpa: 210.0,
            poisson: 0.3,
            density_kg_per_m3: 7850.0,
            damping_ratio: 0.02,
            damping_frequency_hz: 1000.0,
        }
    }
}

impl MaterialKeys {
    /// The material in SI units, without its damping.
    pub fn material(&self) -> Material {
        Material {
            young: self.young_gpa * GIGAPASCAL,
            poisson: self.poisson,
            density: self.density_kg_per_m3,
            damping: 0.0,
        }
    }

    /// Its damping, s ([`Material::damping`]).
    pub fn damping(&self) -> f64 {
        self.damping_ratio / (PI * self.damping_frequency_hz)
    }
}

/// The linear elastic material of one body, where it is another than `[material]`; each key that is left out is that of `[material]`. The damping is that of `[material]` for both bodies: the contact between them has one.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BodyMaterialKeys {
    /// Young's modulus, GPa.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 20.0, max = 1000.0))]
    pub young_gpa: Option<f64>,
    /// Poisson's ratio.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 0.49))]
    pub poisson: Option<f64>,
    /// Density, kg/m³.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 100.0, max = 30000.0))]
    pub density_kg_per_m3: Option<f64>,
}

impl BodyMaterialKeys {
    /// Whether no key is given.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The material of the body, with that `of_both` where a key is left out.
    pub fn over(&self, of_both: &MaterialKeys) -> MaterialKeys {
        MaterialKeys {
            young_gpa: self.young_gpa.unwrap_or(of_both.young_gpa),
            poisson: self.poisson.unwrap_or(of_both.poisson),
            density_kg_per_m3: self.density_kg_per_m3.unwrap_or(of_both.density_kg_per_m3),
            ..of_both.clone()
        }
    }
}

/// The linear elastic material of a group of a mesh; without keys it is that of its body. The damping is that of `[material]` for all.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct GroupMaterialKeys {
    /// Young's modulus, GPa; rubber has some thousandths. The three keys go together.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-4, max = 1000.0))]
    pub young_gpa: Option<f64>,
    /// Poisson's ratio; above 0.49 with `mesh.element = "incompatible-modes"` only, for other elements lock there.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 0.4995))]
    pub poisson: Option<f64>,
    /// Density, kg/m³.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 100.0, max = 30000.0))]
    pub density_kg_per_m3: Option<f64>,
}
