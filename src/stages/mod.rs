//! The stages of a study as functions from values to values: each calls the
//! library for one stage and puts the answer into the records that the files,
//! the report and the later stages use. Files and clocks are in
//! [`crate::pipeline`].

mod calibrate;
mod crosscheck;
mod fields;
mod mesh_files;
mod sections;
mod simulate;
mod zones;

pub use calibrate::{Calibration, calibrate};
pub use crosscheck::{AnsweredBody, AnsweredCurve, Answers, answers, faceted, rail_held};
pub use fields::{Fields, PressedFields, fields_vtu, mesh_vtu};
pub use sections::repairs;
pub use simulate::{Springs, simulate, simulate_solid};
pub use zones::{check_loads, mesh_options, within_zones};

use std::path::Path;

use nalgebra::{Point2, Vector2};
use railspring_calibrate::calibration::Enforcement;
use railspring_calibrate::contact::{PairingLimits, Surface, pair};
use railspring_calibrate::error::{Error, InputError, Result};
use railspring_calibrate::field::InputField;
use railspring_calibrate::mesh::{HexMesh, MeshOptions, mesh_rail, mesh_wheel};
use railspring_calibrate::monitor::Monitor;
use railspring_calibrate::placement::{PlacedRail, Touch, TrackGeometry, place_rail, touch};
use railspring_calibrate::section::{RailSection, WheelSection};
use railspring_calibrate::section_analysis::{RailAnalysis, SectionProperties, StressSample, rail_analysis};
use railspring_calibrate::solid::Formulation;
use railspring_calibrate::units::MILLIMETRE;

use crate::records::ProfileRecord;
use crate::report::ProfilePair;
use crate::study::{ElementKey, EnforcementKey, MeshFile, Study};
use railspring_calibrate::beam::{RailBeam, Torsion};

/// The two sections in place, and where they first touch.
pub struct Geometry {
    /// Section of the rail, in its profile frame.
    pub rail: RailSection,
    /// The rail as a beam.
    pub properties: SectionProperties,
    /// Shear stresses of the beam's forces on that section, in the profile frame.
    pub shear_stresses: Vec<StressSample>,
    /// Section of the wheel, in its profile frame.
    pub wheel: WheelSection,
    /// The rail in the track.
    pub placed: PlacedRail,
    /// Lateral world position of the tape circle, m.
    pub tape_y: f64,
    /// Where the lowered wheel first touches.
    pub touch: Touch,
    /// The rail as the beam of the moving solver.
    pub beam: RailBeam,
    /// The measured profiles among the two, and what was done to them.
    pub profiles: Vec<ProfileRecord>,
}

/// The meshes of both bodies.
pub struct Meshes {
    /// The rail, in the world frame.
    pub rail: HexMesh,
    /// The wheel, in its body frame.
    pub wheel: HexMesh,
    /// Edge of the elements in the contact zone across the track, of the rail and of the wheel, m: what the study asks
    /// for, or the longest of a mesh from a file.
    pub contact_elements: [f64; 2],
    /// Sizes and fine zones of the tool's own meshes.
    options: MeshOptions,
}

impl Geometry {
    /// World position (y, z) of the wheel profile's origin when it just touches, m.
    pub fn tape(&self) -> Vector2<f64> {
        Vector2::new(self.tape_y, self.touch.tape_z)
    }

    /// World position (y, z) at which the beam's node line, the line of shear centres, passes, m.
    pub fn node_line(&self) -> Point2<f64> {
        self.placed.to_world(&Point2::new(0.0, self.rail.height - self.properties.shear_centre_height))
    }

    /// Relative radii of curvature along the track and across at the first touch, m.
    pub fn relative_radii(&self) -> [f64; 2] {
        let rail = self.placed.curve.curvature(self.touch.rail_s);
        // The wheel's material lies above its curve, so a bulge of the wheel has negative curvature.
        let wheel = -self.wheel.running.curvature(self.touch.wheel_s);
        let rolling_radius = self.wheel.radius + self.wheel.running.point(self.touch.wheel_s).y;
        [rolling_radius / self.touch.contact_angle.cos(), 1.0 / (rail + wheel)]
    }

    /// Weights of the rail's contact nodes whose mean is the point of the first touch, at x = 0.
    fn touch_weights(&self, rail: &HexMesh) -> Vec<f64> {
        let grid = &rail.contact;
        // the two grid lines around a coordinate and their weights; the nearest line beside the grid
        let around = |lines: &[f64], at: f64| {
            let upper = lines.partition_point(|line| *line < at).clamp(1, lines.len() - 1);
            let t = ((at - lines[upper - 1]) / (lines[upper] - lines[upper - 1])).clamp(0.0, 1.0);
            [(upper - 1, 1.0 - t), (upper, t)]
        };
        let mut weights = vec![0.0; grid.nodes.len()];
        for (i, u) in around(&grid.along_profile, self.touch.rail_s) {
            for (k, v) in around(&grid.along_track, 0.0) {
                weights[i * grid.along_track.len() + k] += u * v;
            }
        }
        weights
    }

    /// Number of contact points whose gap is smaller than `largest_gap` (m) with the wheel lowered from first touch, m.
    pub fn candidates(&self, meshes: &Meshes, lowering: f64, largest_gap: f64) -> usize {
        let mut wheel = self.wheel_surface(&meshes.wheel);
        wheel.origin.y += lowering;
        pair(&self.rail_surface(&meshes.rail), &wheel, PairingLimits { largest_gap }).len()
    }

    fn rail_surface<'a>(&'a self, mesh: &'a HexMesh) -> Surface<'a> {
        Surface::extruded(&self.placed.curve, &mesh.contact)
    }

    fn wheel_surface<'a>(&'a self, mesh: &'a HexMesh) -> Surface<'a> {
        Surface::revolved(&self.wheel.running, &mesh.contact, self.wheel.radius, self.tape())
    }
}

/// Sections, placement and first touch.
///
/// # Errors
/// Unknown profile names, and a wheel that misses the rail.
pub fn geometry(study: &Study) -> Result<Geometry> {
    let (rail, rail_profile) = sections::rail(study)?;
    let (wheel, wheel_profile) = sections::wheel(study)?;
    let track = TrackGeometry {
        gauge: study.track.gauge,
        gauge_height: study.track.gauge_height,
        flange_back: study.track.flange_back,
        inclination: study.rail.inclination,
        lateral_shift: study.track.lateral_shift,
    };
    let placed = place_rail(&rail, &track)?;
    let touch = touch(&placed, &wheel.running, track.tape_y()).map_err(|error| match error {
        Error::Input(missed) if missed.key == InputField::LateralShift.name() => {
            let value = format!("{} mm, {}", study.track.lateral_shift / MILLIMETRE, missed.value);
            InputError { value, ..missed }.into()
        }
        other => other,
    })?;
    let RailAnalysis { properties, stresses: shear_stresses } = rail_analysis(&rail)?;
    let beam = RailBeam::rail(
        &properties,
        &study.material,
        study.rail.length,
        study.simulation.rail_elements,
        placed.angle,
        Torsion::RestrainedWarping,
    )?;
    let profiles = rail_profile.into_iter().chain(wheel_profile).collect();
    Ok(Geometry {
        rail,
        properties,
        shear_stresses,
        wheel,
        placed,
        tape_y: track.tape_y(),
        touch,
        beam,
        profiles,
    })
}

/// Meshes of both bodies: the tool's own, or those of the study's mesh files, which `interpreter` reads (`None`: the
/// Python of the cache folder). Without mesh files no Python is needed.
///
/// # Errors
/// Settings that give an inverted or flat element; a missing Python, and mesh files that cannot be used.
pub fn meshes(
    study: &Study,
    geometry: &Geometry,
    interpreter: Option<&Path>,
    monitor: &dyn Monitor,
) -> Result<Meshes> {
    let options = mesh_options(study, geometry);
    let mut files = mesh_files::Files::new(interpreter, monitor);
    let rail =
        study.rail.mesh.as_ref().map(|file| files.rail(file, study, geometry, &options)).transpose()?;
    let wheel = study.wheel.mesh.as_ref().map(|file| files.wheel(file, geometry, &options)).transpose()?;
    Meshes::with_own(study, geometry, rail, wheel, options)
}

/// The tool's own meshes again with the sizes of `study`; those from files stay as they are in `meshes`.
///
/// # Errors
/// Settings that give an inverted or flat element.
pub fn remeshed(study: &Study, geometry: &Geometry, meshes: &Meshes) -> Result<Meshes> {
    remeshed_with(study, geometry, meshes, mesh_options(study, geometry))
}

fn remeshed_with(
    study: &Study,
    geometry: &Geometry,
    meshes: &Meshes,
    options: MeshOptions,
) -> Result<Meshes> {
    let kept = |file: &Option<MeshFile>, mesh: &HexMesh| file.as_ref().map(|_| mesh.clone());
    let (rail, wheel) = (kept(&study.rail.mesh, &meshes.rail), kept(&study.wheel.mesh, &meshes.wheel));
    Meshes::with_own(study, geometry, rail, wheel, options)
}

impl Meshes {
    /// The given meshes, and the tool's own where there is none.
    fn with_own(
        study: &Study,
        geometry: &Geometry,
        rail: Option<HexMesh>,
        wheel: Option<HexMesh>,
        options: MeshOptions,
    ) -> Result<Self> {
        let edge = |given: &Option<HexMesh>| {
            given.as_ref().map_or(study.mesh.contact_element, |mesh| mesh.contact.longest_across())
        };
        let contact_elements = [edge(&rail), edge(&wheel)];
        let own_rail = || mesh_rail(&geometry.rail, &geometry.placed, study.rail.length, &options);
        let own_wheel = || mesh_wheel(&geometry.wheel, &options);
        Ok(Self {
            rail: rail.map_or_else(own_rail, Ok)?,
            wheel: wheel.map_or_else(own_wheel, Ok)?,
            contact_elements,
            options,
        })
    }

    /// The larger edge of the two, m.
    pub fn contact_element(&self) -> f64 {
        self.contact_elements[0].max(self.contact_elements[1])
    }
}

fn formulation(study: &Study) -> Formulation {
    match study.element {
        ElementKey::IncompatibleModes => Formulation::IncompatibleModes,
        ElementKey::FullIntegration => Formulation::FullIntegration,
    }
}

fn enforcement(study: &Study) -> Enforcement {
    match study.contact.enforcement {
        EnforcementKey::Exact => Enforcement::Exact,
        EnforcementKey::Penalty => Enforcement::Penalty(study.contact.penalty),
    }
}

/// The two profiles in place, for the report's pictures.
pub fn profiles(geometry: &Geometry) -> ProfilePair {
    const STEP: f64 = 0.25e-3;
    let outline = |running: Vec<Point2<f64>>, body: &[Point2<f64>]| -> Vec<Point2<f64>> {
        running.into_iter().chain(body.iter().skip(1).copied()).collect()
    };
    ProfilePair {
        rail: outline(geometry.rail.running.sample(STEP), &geometry.rail.body),
        rail_angle: geometry.placed.angle,
        rail_origin: geometry.placed.origin,
        wheel: outline(geometry.wheel.running.sample(STEP), &geometry.wheel.body),
        wheel_origin: Point2::from(geometry.tape()),
        touch: geometry.touch.point,
    }
}
