//! The section `uncertainty`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// By how much the inputs of the springs may be off, each as its standard uncertainty (JCGM 100), half of what holds in 95 of 100 cases. With
/// `calibration.error_band = false` there are no bands, of inputs neither.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct UncertaintyKeys {
    /// Quasi-random samples of all inputs together, which see what is not linear; 0 leaves the changes to first order. A sample takes some hundredths of a second.
    /// The first 128 go through each load case on the simple model, too: a tenth of a second each of processor time for half a thousand time steps.
    #[schemars(range(min = 0, max = 65536))]
    pub samples: usize,
    /// Place of the wheel across the track, mm; normal. None by default: a study says where it stands.
    #[schemars(range(min = 0.0, max = 20.0))]
    pub lateral_mm: f64,
    /// Track gauge, mm; normal. By default that of recording cars, ±1 mm in 95 of 100 cases (EN 13848-1).
    #[schemars(range(min = 0.0, max = 20.0))]
    pub gauge_mm: f64,
    /// Distance of the flange backs, mm; normal. By default ±0.5 mm in 95 of 100 cases, a division of the gauges in use.
    #[schemars(range(min = 0.0, max = 20.0))]
    pub flange_back_mm: f64,
    /// Inclination of the rail in the track, degrees; normal. By default ±0.2 degrees in 95 of 100 cases, 1:35 to 1:47 in place of 1:40.
    #[schemars(range(min = 0.0, max = 0.5))]
    pub inclination_deg: f64,
    /// Turn of a measured rail profile, degrees; normal. Left out, 0.1 for a measured profile, ±0.2 degrees in 95 of 100 cases.
    #[schemars(range(min = 0.0, max = 0.5))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rail_roll_deg: Option<f64>,
    /// The same of a measured wheel profile.
    #[schemars(range(min = 0.0, max = 0.5))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wheel_roll_deg: Option<f64>,
    /// Form of a measured rail profile, µm, in waves of `form_wavelength_mm`; normal. Left out, 7.5 for a measured profile, ±15 µm in 95 of 100 cases, as instruments with
    /// a stylus are given. The scatter from point to point is measured from the file itself and is not in it.
    #[schemars(range(min = 0.0, max = 100.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rail_form_um: Option<f64>,
    /// The same of a measured wheel profile.
    #[schemars(range(min = 0.0, max = 100.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wheel_form_um: Option<f64>,
    /// Length of the waves in which the form of a measurement is off, mm: a surface curves the more the shorter they are. Shorter ones are smoothed
    /// or measured as scatter.
    #[schemars(range(min = 5.0, max = 500.0))]
    pub form_wavelength_mm: f64,
    /// Diameter of the wheel at its tape circle, mm; normal. By default ±0.5 mm in 95 of 100 cases, a division of the gauges in use.
    #[schemars(range(min = 0.0, max = 2.0))]
    pub tape_diameter_mm: f64,
    /// Friction coefficient; rectangular. By default a half width of 0.15, that of dry rails between 0.3 and 0.6, over √3.
    #[schemars(range(min = 0.0, max = 0.3))]
    pub friction: f64,
    /// Young's modulus of each body, per cent; rectangular. By default a half width of 2 %, as steels of rails and wheels are given from 205 to 213 GPa, over √3.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub young_percent: f64,
    /// Poisson's ratio of both bodies; rectangular. By default a half width of 0.015, as steels are given from 0.27 to 0.30, over √3.
    #[schemars(range(min = 0.0, max = 0.05))]
    pub poisson: f64,
}

impl Default for UncertaintyKeys {
    fn default() -> Self {
        Self {
            samples: 128,
            lateral_mm: 0.0,
            gauge_mm: 0.5,
            flange_back_mm: 0.25,
            inclination_deg: 0.1,
            rail_roll_deg: None,
            wheel_roll_deg: None,
            rail_form_um: None,
            wheel_form_um: None,
            form_wavelength_mm: 30.0,
            tape_diameter_mm: 0.25,
            friction: 0.087,
            young_percent: 1.2,
            poisson: 0.0087,
        }
    }
}
