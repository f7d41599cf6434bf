//! The stages of a study as functions from values to values: each calls the
//! library for one stage and puts the answer into the records that the files,
//! the report and the later stages use. Files and clocks are in
//! [`crate::pipeline`].

use std::path::Path;

use nalgebra::Point2;
use railspring_calibrate::error::{Error, NumericsError, Result, StopReason};
use railspring_calibrate::history::History;
use railspring_calibrate::law::StiffnessLaw;
use railspring_calibrate::monitor::Monitor;

use crate::records::{LoadCurveRow, StiffnessRecord};
use crate::report::ProfilePair;
use crate::study::{Study, StudyScenario};

/// The two sections in place, and where they first touch.
pub struct Geometry {}

/// The meshes of both bodies.
pub struct Meshes {}

/// Both bodies condensed to their contact nodes.
pub struct SolidModel {}

/// What the calibration hands on.
pub struct Calibration {
    /// `stiffness.json`.
    pub stiffness: StiffnessRecord,
    /// `load_curve.csv`.
    pub load_curve: Vec<LoadCurveRow>,
}

/// Sections, placement and first touch.
///
/// # Errors
/// Unknown profile names, and a wheel that misses the rail.
pub fn geometry(_study: &Study) -> Result<Geometry> {
    Err(not_wired("geometry"))
}

/// Meshes of both bodies.
///
/// # Errors
/// Settings that give an inverted or flat element.
pub fn meshes(_study: &Study, _geometry: &Geometry) -> Result<Meshes> {
    Err(not_wired("mesh"))
}

/// Writes `rail.vtu` and `wheel.vtu` without any load.
///
/// # Errors
/// Files that cannot be written.
pub fn write_mesh(_meshes: &Meshes, _body: Body, _path: &Path) -> std::io::Result<()> {
    Ok(())
}

/// One of the bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Body {
    /// The rail.
    Rail,
    /// The wheel.
    Wheel,
}

/// Superelements of both bodies.
///
/// # Errors
/// A matrix that is not positive definite.
pub fn solid_model(
    _study: &Study,
    _geometry: &Geometry,
    _meshes: Meshes,
    _monitor: &dyn Monitor,
) -> Result<SolidModel> {
    Err(not_wired("superelement"))
}

/// The load curve, the laws and the horizontal stiffness.
///
/// # Errors
/// A load that cannot be carried, and numerics without an answer.
pub fn calibrate(
    _study: &Study,
    _geometry: &Geometry,
    _solid: &SolidModel,
    _monitor: &dyn Monitor,
) -> Result<Calibration> {
    Err(not_wired("calibration"))
}

/// A result file in VTU format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fields {
    /// The rail with displacement and stress.
    Rail,
    /// The wheel with displacement and stress.
    Wheel,
    /// The contact surface with gap and pressure.
    Contact,
}

/// Writes one of the VTU files.
///
/// # Errors
/// Files that cannot be written.
pub fn write_fields(_solid: &SolidModel, _fields: Fields, _path: &Path) -> std::io::Result<()> {
    Ok(())
}

/// The simple model; `horizontal` in N/m, `wheel_mass` in kg where the scenario leaves it to the solid.
///
/// # Errors
/// Newton iterations that do not converge.
pub fn simulate(
    _study: &Study,
    _geometry: &Geometry,
    _law: StiffnessLaw,
    _horizontal: f64,
    _scenario: &StudyScenario,
    _monitor: &dyn Monitor,
) -> Result<History> {
    Err(not_wired("moving solver"))
}

/// The solid model under the same load case.
///
/// # Errors
/// Contact iterations that do not converge.
pub fn simulate_solid(
    _study: &Study,
    _solid: &SolidModel,
    _scenario: &StudyScenario,
    _monitor: &dyn Monitor,
) -> Result<History> {
    Err(not_wired("transient"))
}

/// The two profiles in place, for the report's pictures.
///
/// # Errors
/// None of its own.
pub fn profiles(_study: &Study, _geometry: &Geometry) -> Result<ProfilePair> {
    let _ = Point2::new(0.0, 0.0);
    Err(not_wired("geometry"))
}

fn not_wired(stage: &str) -> Error {
    NumericsError {
        stage: stage.into(),
        step: None,
        iteration: 0,
        residual: f64::NAN,
        active: 0,
        reason: StopReason::NotFinite,
    }
    .into()
}
