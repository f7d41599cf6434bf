//! The calibration as a stage.

use std::sync::Arc;

use railspring_calibrate::pair::CondensedPair;
use railspring_profiles::error::{Error, InputError, Result, StopReason};
use railspring_profiles::field::InputField;
use railspring_profiles::units::MILLIMETRE;
use serde_json::Value;

use crate::engine::list::NewFile;
use crate::engine::measure::Stopwatch;
use crate::engine::output::{to_csv, to_json};
use crate::engine::seal::Sealed;
use crate::engine::stage::{Engine, Stage, StageOutput};
use crate::engine::store::{Address, Artefact};
use crate::results::bodies::estimate::Work;
use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::in_work::{REACH, Solids};
use crate::results::bodies::input::SolidsInput;
use crate::results::bodies::meshes::Meshes;
use crate::results::bodies::solids;
use crate::results::bodies::source::BodySource;
use crate::results::bodies::zones::{self, ZoneLimit, ZonedResult};
use crate::results::names::{FIGURES, LOAD_CURVE, PATCHES, REPORT, REPORT_PDF, STIFFNESS, VERIFICATION};
use crate::results::patches::record::PatchesRecord;
use crate::results::springs::assumed_record::AssumedRecord;
use crate::results::springs::band_record::{ErrorBandRecord, HorizontalBandRecord};
use crate::results::springs::make::{self, Calibration, FittedSprings, PressedStudy};
use crate::results::springs::record::{LoadCurveRow, StiffnessRecord};
use crate::results::springs::{assumed, error_band, fields, uncertainty};
use crate::study::Statics;

/// The springs of the study, its load curve, patches and fields.
pub(crate) struct Calibrate<'s, 'a> {
    pub solids: &'s mut Solids<'a>,
    /// Whether the study gives the horizontal stiffness, so that it goes on without one that was found.
    pub has_horizontal: bool,
    /// Springs that were found before.
    pub found: Option<CalibratedPair>,
}

/// The springs of a study on the meshes that they end with, before their fields and mostly before their error bands: all that runs on the
/// solids need of a calibration.
pub(crate) struct CalibratedPair {
    meshes: Meshes,
    condensed: Arc<CondensedPair>,
    pressed: PressedStudy,
    /// Their bands, where these have said that the meshes are fine enough.
    band: Option<Band>,
    /// Whether larger contact zones were refused.
    refused: bool,
    /// The time of the calibration so far.
    watch: Option<Stopwatch>,
}

impl CalibratedPair {
    /// The meshes, and the bodies.
    pub fn bodies(&self) -> (&Meshes, &Arc<CondensedPair>) {
        (&self.meshes, &self.condensed)
    }

    /// Whether all loads are carried.
    pub fn is_whole(&self) -> bool {
        !self.refused && self.pressed.ended().is_none()
    }
}

/// The error bands of laws and horizontal stiffness.
type Band = (ErrorBandRecord, Option<HorizontalBandRecord>);

/// Bodies with the springs that they have.
type Pressed = (Arc<CondensedPair>, PressedStudy);

/// What goes when springs or fields change: also the fields under other loads.
const OF_THE_CALIBRATION: [&str; 5] = [VERIFICATION, REPORT, REPORT_PDF, FIGURES, fields::FIELDS];

/// Whether a part of the artefact is a file of fields.
fn is_field(name: &str) -> bool {
    [".vtu", ".pvd"].iter().any(|ending| name.ends_with(ending))
}

impl Stage for Calibrate<'_, '_> {
    type Value = Calibration;

    fn name(&self) -> String {
        "calibration".into()
    }

    fn address(&mut self, _: &Engine<'_>) -> Result<Address> {
        Ok(self.solids.input.calibration())
    }

    fn make(&mut self, engine: &mut Engine<'_>) -> Result<StageOutput> {
        let springs = match self.found.take() {
            Some(springs) => springs,
            None => found_springs(self.solids, engine)?,
        };
        let at = &mut *self.solids;
        let CalibratedPair { meshes, condensed, pressed, band, refused, watch } = springs;
        at.resources.monitor.notice(&make::law_so_far(at.input.statics, pressed.found()));
        engine.watch = watch.or(engine.watch.take());
        let (statics, geometry) = (at.input.statics, at.geometry()?);
        let fields = || make::calibrate((statics, at.input.output), &geometry, &meshes, &condensed, &pressed);
        let band = || match band {
            None if statics.wants_error_band() => {
                error_band(at, &geometry, &meshes, &condensed, &pressed).map(Some)
            }
            band => Ok(band),
        };
        let (fields, band) = if at.room.stages { rayon::join(fields, band) } else { (fields(), band()) };
        let ((mut calibration, fields), band) = (fields?, band?);
        if let Some((band, horizontal)) = band {
            calibration.stiffness.error_band = Some(band);
            if let Some(record) = &mut calibration.stiffness.horizontal {
                record.error_band = horizontal;
            }
        }
        calibration.stiffness.assumed = assumed(at, &geometry, (&meshes, &condensed), pressed.found())?;
        let monitor = at.resources.monitor;
        calibration.stiffness.input_uncertainty = uncertainty::uncertainty(
            statics,
            &geometry,
            &condensed,
            pressed.found(),
            &calibration.stiffness,
            monitor,
        )?;
        let Calibration { stiffness, load_curve, patches, horizontal_failure } = calibration;
        let reach = at.set_meshes(meshes);
        at.condensed = (at.input.wants_by_angle || at.input.modes > 0).then_some(condensed);
        let mut artefact = Artefact::default()
            .with(REACH, to_json(&reach))
            .with(STIFFNESS, to_json(&stiffness))
            .with(LOAD_CURVE, to_csv(&load_curve))
            .with(PATCHES, to_json(&patches));
        for (name, text) in fields {
            artefact = artefact.with(name, text);
        }
        let complete = horizontal_failure.is_none() && !refused;
        // what the calibration has finished is written; a study with a stiffness goes on with it
        let failure = horizontal_failure.filter(|_| !self.has_horizontal);
        Ok(StageOutput { complete, failure, ..StageOutput::whole(artefact) })
    }

    fn value(&mut self, artefact: &Artefact, key: &str) -> Result<Calibration> {
        let at = &mut *self.solids;
        let mut stiffness: StiffnessRecord = artefact.json(STIFFNESS)?;
        let (input, geometry) = (at.input, at.geometry()?);
        label(&mut stiffness, key, &input, &geometry);
        let stiffness = stiffness.sealed();
        let load_curve = load_curve(LOAD_CURVE, artefact.text(LOAD_CURVE)?)?;
        let mut patches: PatchesRecord = artefact.json(PATCHES)?;
        patches.study = at.input.name.into();
        patches.input_hash = key.into();
        at.go_on_with_reach(artefact)?;
        Ok(Calibration::kept(stiffness, load_curve, patches))
    }

    fn files(&self, artefact: &Artefact, value: &Calibration, key: &str) -> Vec<NewFile> {
        let part = |name| (name, artefact.part(name).unwrap_or_default().to_vec());
        let fields = artefact.parts().filter(|(name, _)| is_field(name));
        let fields = fields.map(|(name, content)| (name, content.to_vec()));
        let records =
            [(STIFFNESS, to_json(&value.stiffness)), part(LOAD_CURVE), (PATCHES, to_json(&value.patches))];
        let files = records.into_iter().chain(fields);
        files.map(|(name, content)| NewFile::new(name, content, key)).collect()
    }

    fn outdates(&self) -> &'static [&'static str] {
        &OF_THE_CALIBRATION
    }

    fn note(&self) -> Option<(&'static str, Value)> {
        self.solids.reach_note()
    }
}

/// Whether the calibration is to be made, as far as the store says.
pub(crate) fn calibrates(input: &SolidsInput<'_>, engine: &Engine<'_>) -> bool {
    engine.fresh || !engine.store.is_some_and(|store| store.has(&input.calibration()))
}

/// The springs of the study, on meshes with zones as long and elements as fine as they have to be.
///
/// # Errors
/// Those of the bodies and of pressing them.
pub(crate) fn found_springs(at: &mut Solids<'_>, engine: &mut Engine<'_>) -> Result<CalibratedPair> {
    let geometry = at.geometry()?;
    let mut meshes = at.meshes(engine, Solids::calibration_work)?;
    let (input, monitor, budget) = (at.input, at.resources.monitor, at.resources.budget);
    let (source, statics) = (at.body_source(), input.statics);
    let accept =
        |larger: &Meshes| budget.check(&input, &geometry, larger, &Work::of(&input, true, false)).map(|_| ());
    let press = |meshes: &Meshes| {
        let solids = solids::solids(statics, &geometry, meshes);
        let condensed = source.condensed(&solids, "", input.modes)?;
        let pressed = make::press(statics, &geometry, &condensed, monitor)?;
        Ok((Arc::new(condensed), pressed))
    };
    let reached = |(_, pressed): &Pressed| match pressed.ended() {
        Some(Error::Numerics(cause)) => ZoneLimit::by(cause),
        _ => None,
    };
    loop {
        let ZonedResult { result: (condensed, pressed), refused } =
            zones::within_zones(statics, &geometry, &mut meshes, monitor, accept, press, reached)
                .map_err(|error| load_error(statics, error))?;
        let mut band = None;
        if statics.wants_error_band() && statics.target_error.is_some() {
            let (band, _) = band.insert(error_band(at, &geometry, &meshes, &condensed, &pressed)?);
            if let Some(finer) = error_band::finer_meshes(statics, &geometry, &meshes, band, accept, monitor)?
            {
                meshes = finer;
                continue;
            }
        }
        let watch = engine.watch.take();
        return Ok(CalibratedPair { meshes, condensed, pressed, band, refused, watch });
    }
}

/// What was assumed of the bodies, with others in their place.
fn assumed(
    at: &Solids<'_>,
    geometry: &Geometry,
    own: (&Meshes, &CondensedPair),
    found: &FittedSprings,
) -> Result<Option<AssumedRecord>> {
    let (statics, monitor) = (at.input.statics, at.resources.monitor);
    let condense = |geometry: &Geometry, meshes: &Meshes| {
        let source = BodySource { foot_held: false, ..at.body_source() };
        source.condensed(&solids::solids(statics, geometry, meshes), " of another pair", 0)
    };
    assumed::assumed(statics, geometry, own, found, condense, monitor)
}

/// The error bands. The bodies of coarser meshes that they need are condensed here, not beside the others: the law comes first.
fn error_band(
    at: &Solids<'_>,
    geometry: &Geometry,
    meshes: &Meshes,
    bodies: &CondensedPair,
    pressed: &PressedStudy,
) -> Result<Band> {
    let coarser = at.coarser(geometry, meshes)?;
    let monitor = at.resources.monitor;
    error_band::error_band(at.input.statics, geometry, meshes, bodies, pressed.found(), &coarser, monitor)
}

/// The rows of a load curve; `path` is only named in messages.
pub fn load_curve(path: &str, text: &str) -> Result<Vec<LoadCurveRow>> {
    let rows = csv::Reader::from_reader(text.as_bytes()).deserialize().collect::<std::result::Result<_, _>>();
    rows.map_err(|cause| {
        InputError::new(
            path,
            cause,
            "a load curve as `railspring calibrate` writes it",
            "write it again with that command",
        )
        .into()
    })
}

/// Puts in what a calibration carries of the study that asks for it and does not depend on, names of the study and of files, and the key of
/// its address.
fn label(stiffness: &mut StiffnessRecord, key: &str, input: &SolidsInput<'_>, geometry: &Geometry) {
    let statics = input.statics;
    stiffness.study = input.name.into();
    stiffness.input_hash = key.into();
    stiffness.pair = statics.pair();
    stiffness.profiles.clone_from(&geometry.profiles);
    for (mesh, file) in stiffness.mesh.iter_mut().zip([&statics.rail.mesh, &statics.wheel.mesh]) {
        mesh.file = file.as_ref().map(|file| file.file.clone());
    }
}

/// The error of a contact that ends at the end of a contact zone which cannot be made larger. The load is so
/// small that there is no law. The loads are then too large for the study. On a profile, under the smallest
/// load, the two profiles have no room for a contact.
fn load_error(statics: Statics<'_>, error: Error) -> Error {
    let Error::Numerics(cause) = &error else { return error };
    let given = statics.rail.mesh.is_some() || statics.wheel.mesh.is_some();
    let load = cause.step.map_or_else(|| "the loads".into(), |step| format!("load number {step}"));
    match cause.reason {
        StopReason::EdgeOfCandidates if cause.step.is_none_or(|step| step == 1) => InputError::new(
            InputField::LateralShift,
            format!("{} mm", statics.track.lateral_shift / MILLIMETRE),
            "a place at which the contact of the smallest load lies inside both running surfaces",
            if given {
                "move the wheel, or enlarge the contact surfaces of the mesh files"
            } else {
                "move the wheel, or check gauge and flange back distance"
            },
        )
        .into(),
        StopReason::EdgeOfCandidates | StopReason::EndOfWindow => InputError::new(
            InputField::Loads,
            load,
            "loads whose contact patch stays within the contact zone of the mesh",
            if given {
                "lower the load, or enlarge `window_half_length` and the contact surfaces of the mesh files"
            } else {
                "lower the load, or enlarge `window_half_length`"
            },
        )
        .into(),
        _ => error,
    }
}
