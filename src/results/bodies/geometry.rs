//! The stages of a study as functions from values to values: each calls the
//! library for one stage and puts the answer into the records that the files,
//! the report and the later stages use. Files and clocks are in
//! [`crate::pipeline`].

pub use crate::results::bodies::coarser::{Coarser, CoarserBodies, FINER, coarser_bodies, coarser_options};
pub use crate::results::bodies::on_standard::{Seams, on_standard};
pub use crate::results::bodies::other_solids::{CoarserContact, coarser_contact};
pub use crate::results::bodies::sections::{Assumed, repairs};
pub use crate::results::bodies::solids::{MovingBodies, solids};
pub use crate::results::bodies::zones::{Reached, Within, check_loads, mesh_options, within_zones};
pub use crate::results::by_angle::make::{
    PlaceSettings, by_angle, loads_by_angle, place, shifts, tape_y, with_element,
};
pub use crate::results::crosscheck::answers::{
    AnsweredBody, AnsweredCurve, Answers, answers, faceted, rail_held,
};
pub use crate::results::run::make::{Springs, Tried, simulate, simulate_solid};
pub use crate::results::springs::assumed::{assumed, others_by_body};
pub use crate::results::springs::error_band::{check_target, error_band, finer_meshes};
pub use crate::results::springs::fields::{FIELDS, FieldFile, mesh_vtu};
pub use crate::results::springs::make::{
    Calibration, FoundSprings, PressedStudy, calibrate, check_friction, contact_conditions, law_so_far, press,
};

use super::{mesh_files, sections};
use std::path::Path;

use nalgebra::Point2;
use railspring_calibrate::beam::RailBeam;
use railspring_calibrate::calibration::{ContactField, Enforcement};
use railspring_calibrate::mesh::{HexMesh, MeshOptions, mesh_rail, mesh_wheel};
use railspring_calibrate::pair::{Orders, Pair};
use railspring_calibrate::solid::Formulation;
use railspring_profiles::error::{Error, InputError, Result};
use railspring_profiles::field::InputField;
use railspring_profiles::monitor::Monitor;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::profile_file::ProfileKind;
use railspring_profiles::section::{RailSection, WheelSection};
use railspring_profiles::units::MILLIMETRE;

use crate::engine::store::{Address, Kind};
use crate::results::bodies::outline_figure::{BodyOutline, ProfilePair};
use crate::results::bodies::record::ProfileRecord;
use crate::results::bodies::surface_figure::OnStandard;
use crate::study::{ElementKey, EnforcementKey, FieldKey, MeshFile, Study};

/// The two sections in place, and where they first touch.
pub struct Geometry {
    /// The pair of profiles in the track.
    pub pair: Pair,
    /// The rail as the beam of the moving solver.
    pub beam: RailBeam,
    /// The measured profiles among the two, and what was done to them.
    pub profiles: Vec<ProfileRecord>,
    /// The same on their standards, for pictures; not the sections of files.
    pub surfaces: Vec<OnStandard>,
    /// What is assumed of the bodies of measured profiles, of the rail and of the wheel.
    pub assumed: [Option<Assumed>; 2],
    /// The pair with surfaces without a quarter of their measured points each; none where nothing scatters.
    pub replicates: Vec<Pair>,
}

/// The meshes of both bodies.
#[derive(Clone)]
pub struct Meshes {
    /// The rail, in the world frame.
    pub rail: HexMesh,
    /// The wheel, in its body frame.
    pub wheel: HexMesh,
    /// Edge of the elements in the contact zone across the track, of the rail and of the wheel, m: what the study asks
    /// for, or the longest of a mesh from a file.
    pub contact_elements: [f64; 2],
    /// Sizes and contact zones of the tool's own meshes.
    pub(crate) options: MeshOptions,
    /// Orders of the equations on them.
    pub(crate) orders: Orders,
}

/// Address of the calibration of a study, with its fields for other programs.
pub fn calibration_address(study: &Study) -> Address {
    Address::of(Kind::Calibration, &(&study.keys.springs, study.output))
}

/// Sections, placement and first touch.
///
/// # Errors
/// Unknown profile names, and a wheel that misses the rail.
pub fn geometry(study: &Study) -> Result<Geometry> {
    let (rail, wheel) = rayon::join(|| sections::rail(study), || sections::wheel(study));
    let (rail, wheel) = (rail?, wheel?);
    // a head that its file has inclined is laid as it is there
    let turned =
        rail.assumed.as_ref().and_then(|assumed| assumed.turned).filter(|_| !study.rail.inclination_given);
    let inclination = turned.map_or(study.rail.inclination, f64::tan);
    let in_track = Geometry::in_track(study, rail.section, wheel.section, inclination)?;
    let replicates = in_track.replicates(study, &rail.replicates, &wheel.replicates, inclination)?;
    let profiles = rail.records.into_iter().chain(wheel.records).collect();
    let surfaces = rail.surface.into_iter().chain(wheel.surface).collect();
    let assumed = [rail.assumed, wheel.assumed];
    Ok(Geometry { profiles, surfaces, assumed, replicates, ..in_track })
}

impl Geometry {
    /// Two sections in the track of a study, the rail inclined by a slope; nothing of them was measured.
    ///
    /// # Errors
    /// A wheel that misses the rail.
    pub(crate) fn in_track(
        study: &Study,
        rail: RailSection,
        wheel: WheelSection,
        inclination: f64,
    ) -> Result<Self> {
        let track = track(study, inclination);
        let pair = Pair::new(rail, wheel, &track).map_err(|error| match error {
            Error::Input(missed) if missed.key == InputField::LateralShift.name() => {
                let value = format!("{} mm, {}", study.track.lateral_shift / MILLIMETRE, missed.value);
                InputError { value, ..missed }.into()
            }
            other => other,
        })?;
        let beam = pair.beam(&study.rail.material, study.rail.length, study.simulation.rail_elements)?;
        let (profiles, surfaces, replicates) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Self { pair, beam, profiles, surfaces, assumed: [None, None], replicates })
    }

    /// The outlines of rail and wheel in the track, the wheel where it first touches, with what of them was measured.
    pub fn outlines(&self) -> [BodyOutline; 2] {
        /// Distance of the points on the running surfaces, m.
        const STEP: f64 = 1.0 * MILLIMETRE;
        let Pair { rail, wheel, placed, .. } = &self.pair;
        let tape = self.pair.tape();
        let outline = |running: &ProfileCurve, body: &[Point2<f64>]| -> Vec<Point2<f64>> {
            running.sample(STEP).into_iter().chain(body.iter().skip(1).copied()).collect()
        };
        let measured = |running: &ProfileCurve, seams: Option<[f64; 4]>, was: bool| -> Vec<Point2<f64>> {
            let [_, from, to, _] = seams.unwrap_or([0.0, 0.0, running.length(), running.length()]);
            let inside = |s: &f64| was && (from..=to).contains(s);
            running.sample_parameters(STEP).into_iter().filter(inside).map(|s| running.point(s)).collect()
        };
        let was = |body: &str| self.surfaces.iter().any(|surface| surface.body == body);
        let of_rail = [
            outline(&rail.running, &rail.body),
            measured(&rail.running, rail.seams, was(ProfileKind::Rail.name())),
        ];
        let of_wheel = [
            outline(&wheel.running, &wheel.body),
            measured(&wheel.running, wheel.seams, was(ProfileKind::Wheel.name())),
        ];
        let [outline, measured] = of_rail.map(|points| points.iter().map(|p| placed.to_world(p)).collect());
        let on_rail = BodyOutline { body: ProfileKind::Rail.name(), outline, measured };
        let [outline, measured] = of_wheel.map(|points| points.iter().map(|p| p + tape).collect());
        [on_rail, BodyOutline { body: ProfileKind::Wheel.name(), outline, measured }]
    }

    /// The pair with the surfaces of rails and wheels without a quarter of their measured points each, in the same track; none where neither has any.
    fn replicates(
        &self,
        study: &Study,
        rails: &[RailSection],
        wheels: &[WheelSection],
        inclination: f64,
    ) -> Result<Vec<Pair>> {
        let track = track(study, inclination);
        let count = rails.len().max(wheels.len());
        let of = |i: usize| {
            let rail = rails.get(i).unwrap_or(&self.pair.rail).clone();
            let wheel = wheels.get(i).unwrap_or(&self.pair.wheel).clone();
            self.pair.with_surfaces(rail, wheel, &track)
        };
        (0..count).map(of).collect()
    }
}

/// The track of a study, the rail inclined by a slope.
fn track(study: &Study, inclination: f64) -> TrackGeometry {
    TrackGeometry {
        gauge: study.track.gauge,
        gauge_height: study.track.gauge_height,
        flange_back: study.track.flange_back,
        inclination,
        lateral_shift: study.track.lateral_shift,
    }
}

/// Meshes of both bodies: the tool's own with `options`, or those of the study's mesh files, which `interpreter` reads
/// (`None`: the Python of the cache folder). Without mesh files no Python is needed.
///
/// # Errors
/// Settings that give an inverted or flat element; a missing Python, and mesh files that cannot be used.
pub fn meshes(
    study: &Study,
    geometry: &Geometry,
    options: MeshOptions,
    interpreter: Option<&Path>,
    monitor: &dyn Monitor,
) -> Result<Meshes> {
    let mut files = mesh_files::Files::new(interpreter, monitor);
    let rail =
        study.rail.mesh.as_ref().map(|file| files.rail(file, study, geometry, &options)).transpose()?;
    let wheel =
        study.wheel.mesh.as_ref().map(|file| files.wheel(file, study, geometry, &options)).transpose()?;
    Meshes::with_own(study, geometry, rail, wheel, options)
}

/// The tool's own meshes again with the sizes of `study`; those from files stay as they are in `meshes`.
///
/// # Errors
/// Settings that give an inverted or flat element.
pub fn remeshed(study: &Study, geometry: &Geometry, meshes: &Meshes) -> Result<Meshes> {
    remeshed_with(study, geometry, meshes, mesh_options(study, geometry))
}

/// The same with given sizes and zones.
///
/// # Errors
/// As [`remeshed`].
pub fn remeshed_with(
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
    pub(crate) fn with_own(
        study: &Study,
        geometry: &Geometry,
        rail: Option<HexMesh>,
        wheel: Option<HexMesh>,
        options: MeshOptions,
    ) -> Result<Self> {
        let edge = |given: &Option<HexMesh>| {
            given.as_ref().map_or(options.contact_element, |mesh| mesh.contact.longest_across())
        };
        let contact_elements = [edge(&rail), edge(&wheel)];
        let own_rail = || mesh_rail(&geometry.pair.rail, &geometry.pair.placed, study.rail.length, &options);
        let own_wheel = || mesh_wheel(&geometry.pair.wheel, &options);
        let (rail, wheel) =
            rayon::join(|| rail.map_or_else(own_rail, Ok), || wheel.map_or_else(own_wheel, Ok));
        Ok(Self { rail: rail?, wheel: wheel?, contact_elements, options, orders: Orders::default() })
    }

    /// Sizes and contact zones of the tool's own meshes.
    pub fn options(&self) -> &MeshOptions {
        &self.options
    }

    /// Times that the study's sizes were refined for these meshes.
    pub fn refinements(&self, study: &Study) -> u32 {
        let times = (study.mesh.contact_element / self.options.contact_element).ln() / FINER.ln();
        times.round().max(0.0) as u32
    }

    /// The larger edge of the two, m.
    pub fn contact_element(&self) -> f64 {
        self.contact_elements[0].max(self.contact_elements[1])
    }
}

pub(crate) fn formulation(study: &Study) -> Formulation {
    match study.element {
        ElementKey::IncompatibleModes => Formulation::IncompatibleModes,
        ElementKey::FullIntegration => Formulation::FullIntegration,
    }
}

pub(crate) fn contact_field(study: &Study) -> ContactField {
    match study.contact.field {
        FieldKey::Hybrid => ContactField::Hybrid,
        FieldKey::Elements => ContactField::Elements,
    }
}

pub(crate) fn enforcement(study: &Study) -> Enforcement {
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
        rail: outline(geometry.pair.rail.running.sample(STEP), &geometry.pair.rail.body),
        rail_angle: geometry.pair.placed.angle,
        rail_origin: geometry.pair.placed.origin,
        wheel: outline(geometry.pair.wheel.running.sample(STEP), &geometry.pair.wheel.body),
        wheel_origin: Point2::from(geometry.pair.tape()),
        touch: geometry.pair.touch.point,
    }
}
