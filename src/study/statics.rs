//! What the statics of a pair are made from, in SI units: the input of its laws, whose hash is their key.

use railspring_calibrate::calibration::{ContactField, Enforcement};
use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::solid::{Formulation, Material};
use railspring_profiles::units::MILLIMETRE;
use serde::Serialize;
use serde_json::Value;

use super::analysis::{CalibrationSettings, ContactSettings, UncertaintySettings};
use super::document::{ElementKey, EnforcementKey, FieldKey};
use super::pair::{MeasuredSurface, Rail, Track, Wheel};
use super::record::PairRecord;
use crate::hash::key;
use crate::rounding::ratio;

/// Bodies, their places, their meshes, their contact and the loads on them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Statics<'a> {
    /// The rail.
    pub rail: &'a Rail,
    /// The wheel.
    pub wheel: &'a Wheel,
    /// Where the wheel is on the track.
    pub track: Track,
    /// The solid meshes.
    pub mesh: &'a MeshOptions,
    /// Wanted error band of the law in use, relative.
    pub target_error: Option<f64>,
    /// Whether the study gives the length of the contact window; one that it gives is not made longer, though it be as long as the usual one.
    pub window_given: bool,
    /// Formulation of the eight-node brick.
    pub element: ElementKey,
    /// Contact between the solids.
    pub contact: ContactSettings,
    /// Loads and reference of the law.
    pub calibration: &'a CalibrationSettings,
    /// Standard uncertainties of the inputs.
    pub uncertainty: &'a UncertaintySettings,
    /// Number of beam elements of the simple model's rail, whose deflection the calibration takes away.
    pub beam_elements: usize,
}

impl Statics<'_> {
    /// The same with inputs that are known exactly: what does not depend on their uncertainty stays when that changes.
    #[must_use]
    pub fn exact(self) -> Self {
        Self { uncertainty: &UncertaintySettings::NONE, ..self }
    }

    /// Materials of rail and wheel.
    pub fn materials(&self) -> [&Material; 2] {
        [&self.rail.material, &self.wheel.material]
    }

    /// Whether both meshes are the program's own.
    pub fn meshes_are_ours(&self) -> bool {
        self.rail.mesh.is_none() && self.wheel.mesh.is_none()
    }

    /// Whether the laws get their error bands, for themselves or for the meshes that a wanted one asks for.
    pub fn wants_error_band(&self) -> bool {
        self.calibration.error_band || self.target_error.is_some()
    }

    /// The pair of rail and wheel that a law belongs to.
    pub fn pair(&self) -> PairRecord {
        let surface = |name: Option<&str>, measured: &Option<MeasuredSurface>| {
            let parts = [measured.as_ref().map(|measured| measured.file.as_str()), name];
            parts.into_iter().flatten().collect::<Vec<_>>().join(" on ")
        };
        PairRecord {
            name: format!(
                "rail {} {}, wheel {} of {} m, shift {} mm",
                surface(self.rail.name(), &self.rail.measured),
                match self.rail.inclination {
                    0.0 => "upright".into(),
                    slope => format!("inclined {}", ratio(slope)),
                },
                surface(self.wheel.name(), &self.wheel.measured),
                self.wheel.tape_diameter,
                (self.track.lateral_shift / MILLIMETRE * 1e6).round() / 1e6
            ),
            hash: self.pair_key(),
        }
    }

    /// Key of the pair that a law belongs to: profiles, bodies, their places and the elastic materials. A law does not depend on masses, and the length of the
    /// rail is no part of the pair.
    pub fn pair_key(&self) -> String {
        let without = |mut body: Value, keys: &[&str]| {
            let body_keys = body.as_object_mut().expect("a body is an object");
            keys.iter().for_each(|key| drop(body_keys.remove(*key)));
            let materials = body["materials"].as_array_mut().into_iter().flatten();
            materials.filter_map(Value::as_object_mut).for_each(|material| drop(material.remove("density")));
            body
        };
        let rail = without(plain(&self.rail), &["length", "material"]);
        let wheel = without(plain(&self.wheel), &["material"]);
        let elastic = self.materials().map(|material| [material.young, material.poisson]);
        key(&("pair", rail, wheel, elastic, self.track))
    }
}

impl ElementKey {
    /// The formulation that it names.
    pub fn formulation(self) -> Formulation {
        match self {
            Self::IncompatibleModes => Formulation::IncompatibleModes,
            Self::FullIntegration => Formulation::FullIntegration,
        }
    }
}

impl ContactSettings {
    /// Where the contact lives, and how it is enforced.
    pub fn of_solids(&self) -> (Enforcement, ContactField) {
        let enforcement = match self.enforcement {
            EnforcementKey::Exact => Enforcement::Exact,
            EnforcementKey::Penalty => Enforcement::Penalty(self.penalty),
        };
        let field = match self.field {
            FieldKey::Hybrid => ContactField::Hybrid,
            FieldKey::Elements => ContactField::Elements,
        };
        (enforcement, field)
    }
}

/// A value as plain data.
fn plain(value: &impl Serialize) -> Value {
    serde_json::to_value(value).expect("settings are plain data")
}

/// The keys of the wheel, of the rail, and of the rest of what springs depend on: what a table names as the cause of a change.
pub fn parts(statics: &Statics<'_>) -> [String; 3] {
    let mut settings = plain(statics);
    for body in ["rail", "wheel"] {
        settings.as_object_mut().map(|settings| settings.remove(body));
    }
    [key(statics.wheel), key(statics.rail), key(&settings)]
}
