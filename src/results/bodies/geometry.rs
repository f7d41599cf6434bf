//! The two sections of a study in the track, and where they first touch.

use nalgebra::Point2;
use railspring_calibrate::beam::RailBeam;
use railspring_calibrate::pair::Pair;
use railspring_profiles::error::{Error, InputError, Result};
use railspring_profiles::field::InputField;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::profile_file::{Action, Finding, FindingKind, ProfileKind};
use railspring_profiles::section::{RailSection, WheelSection};
use railspring_profiles::units::MILLIMETRE;

use super::sections::{self, Assumed, Sectioned, finding_record};
use crate::results::bodies::outline_figure::{BodyOutline, ProfilePair};
use crate::results::bodies::record::ProfileRecord;
use crate::results::bodies::surface_figure::OnStandard;
use crate::study::Statics;

/// How far (m) above the depth of the gauge a measurement may end, and the side still counts as measured.
const ON_THE_GAUGE: f64 = 0.1 * MILLIMETRE;

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
    /// The sections that measured profiles were laid on.
    pub bases: (Option<RailSection>, Option<WheelSection>),
    /// What is assumed of the bodies of measured profiles, of the rail and of the wheel.
    pub assumed: [Option<Assumed>; 2],
    /// The pair with surfaces without a quarter of their measured points each; none where nothing scatters.
    pub replicates: Vec<Pair>,
}

/// Sections, placement and first touch.
///
/// # Errors
/// Unknown profile names, and a wheel that misses the rail.
pub fn geometry(statics: Statics<'_>) -> Result<Geometry> {
    let Surfaces { rail, wheel } = Surfaces::read(statics)?;
    Geometry::of_surfaces(statics, rail, wheel, |rail, wheel, inclination| {
        Geometry::in_track(statics, rail, wheel, inclination)
    })
}

/// The two sections of a study, by themselves.
#[derive(Clone)]
pub(crate) struct Surfaces {
    pub rail: Sectioned<RailSection>,
    pub wheel: Sectioned<WheelSection>,
}

impl Surfaces {
    /// Reads, places and closes both.
    ///
    /// # Errors
    /// Those of the files, and unknown profile names.
    pub fn read(statics: Statics<'_>) -> Result<Self> {
        let (rail, wheel) = rayon::join(|| sections::rail(statics), || sections::wheel(statics));
        Ok(Self { rail: rail?, wheel: wheel? })
    }
}

impl Geometry {
    /// Two sections as `in_track` lays them with the rail inclined by a slope, and what is known of the surfaces.
    ///
    /// # Errors
    /// Those of `in_track`, and a wheel that misses the rail.
    pub(crate) fn of_surfaces(
        statics: Statics<'_>,
        rail: Sectioned<RailSection>,
        wheel: Sectioned<WheelSection>,
        in_track: impl FnOnce(RailSection, WheelSection, f64) -> Result<Self>,
    ) -> Result<Self> {
        // a head that its file has inclined is laid as it is there
        let turned = rail
            .assumed
            .as_ref()
            .and_then(|assumed| assumed.turned)
            .filter(|_| !statics.rail.inclination_given);
        let inclination = turned.map_or(statics.rail.inclination, f64::tan);
        let in_track = in_track(rail.section, wheel.section, inclination)?;
        let replicates = in_track.replicates(statics, &rail.replicates, &wheel.replicates, inclination)?;
        let mut profiles: Vec<ProfileRecord> = rail.records.into_iter().chain(wheel.records).collect();
        if let (Some(record), Some(finding)) = (
            profiles.iter_mut().find(|r| r.body == ProfileKind::Rail.name()),
            in_track.gauge_point_assumed(statics),
        ) {
            record.findings.push(finding_record(&finding));
        }
        let surfaces = rail.surface.into_iter().chain(wheel.surface).collect();
        let (bases, assumed) = ((rail.base, wheel.base), [rail.assumed, wheel.assumed]);
        Ok(Self { profiles, surfaces, bases, assumed, replicates, ..in_track })
    }

    /// Two sections in the track of a study, the rail inclined by a slope; nothing of them was measured.
    ///
    /// # Errors
    /// A wheel that misses the rail.
    pub(crate) fn in_track(
        statics: Statics<'_>,
        rail: RailSection,
        wheel: WheelSection,
        inclination: f64,
    ) -> Result<Self> {
        let track = track(statics, inclination);
        let pair = Pair::new(rail, wheel, &track).map_err(|error| match error {
            Error::Input(missed) if missed.key == InputField::LateralShift.name() => {
                let value = format!("{} mm, {}", statics.track.lateral_shift / MILLIMETRE, missed.value);
                InputError { value, ..missed }.into()
            }
            other => other,
        })?;
        let beam = pair.beam(&statics.rail.material, statics.rail.length, statics.beam_elements)?;
        let (profiles, surfaces, replicates) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Self { pair, beam, profiles, surfaces, bases: (None, None), assumed: [None, None], replicates })
    }

    /// A pair of other surfaces on the same bodies, of which nothing else is known.
    pub(crate) fn with_surfaces(&self, pair: Pair) -> Self {
        let (profiles, surfaces, replicates) = (Vec::new(), Vec::new(), Vec::new());
        let beam = self.beam.clone();
        Self { pair, beam, profiles, surfaces, bases: (None, None), assumed: [None, None], replicates }
    }

    /// That the gauge is taken below the last measured point of the rail, on the side of the body that it was joined to, and by
    /// how much a vertical side would move the rail.
    fn gauge_point_assumed(&self, statics: Statics<'_>) -> Option<Finding> {
        let [_, from, ..] = self.pair.rail.seams?;
        let end = self.pair.placed.curve.point(from);
        let height = statics.track.gauge_height;
        if end.y > height - ON_THE_GAUGE {
            return None;
        }
        let [measured, height, moved] =
            [end.y, height, 0.5 * statics.track.gauge - end.x].map(|length| length / MILLIMETRE);
        let text = format!(
            "measured down to {measured:.1} mm below the top at the gauge side; the gauge is taken {height} mm below it, on \
             the side of the body that the head is joined to, which places the rail: a vertical side from the last point on would \
             move it by {moved:.2} mm. Measure deeper, or set `track.gauge_height_mm` to a depth that was measured"
        );
        Some(Finding::new(FindingKind::Shape, Action::Noted, text))
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
        statics: Statics<'_>,
        rails: &[RailSection],
        wheels: &[WheelSection],
        inclination: f64,
    ) -> Result<Vec<Pair>> {
        let track = track(statics, inclination);
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
pub(crate) fn track(statics: Statics<'_>, inclination: f64) -> TrackGeometry {
    TrackGeometry {
        gauge: statics.track.gauge,
        gauge_height: statics.track.gauge_height,
        flange_back: statics.track.flange_back,
        inclination,
        lateral_shift: statics.track.lateral_shift,
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
