//! How far the contact zone of the meshes reaches: as far as the contact goes.
//!
//! The contact zone of the study, made larger where a run needs it. A contact window of the program's own
//! choice is as long as the Hertz patch of the largest load asks for. It is chosen before anything is meshed.
//! Where a run reaches the end of the zone, the zone is made larger, the bodies are meshed again, and the run
//! starts again.

use railspring_calibrate::analytic::hertz::point_contact;
use railspring_calibrate::calibration::LARGEST_NORMAL;
use railspring_calibrate::mesh::{ContactZone, MeshOptions, SectionOutline, rail_outline, wheel_outline};
use railspring_profiles::error::{Error, InputError, NumericsError, Result};
use railspring_profiles::field::InputField;
use railspring_profiles::monitor::Monitor;
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::units::{KILONEWTON, MILLIMETRE};
use railspring_simulate::time::history::{Ending, SurfaceEnd};

use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::meshes::{Meshes, remeshed_with};
use crate::study::{FieldKey, Statics};

/// Times that the zone is made larger, at most.
const EXTENSIONS: usize = 4;
/// Length that the first extension adds at each end of the zone on a profile, m: two elements of the default mesh. Each further one adds
/// twice as much, as a wheel that comes down from the air may be anywhere on the profiles.
const LONGER: f64 = 4e-3;
/// Distance that a zone keeps from the end of a profile and from the top of a flange, m.
const FROM_THE_END: f64 = 0.5e-3;

/// Length of a zone beyond the first touch, m: that of wide patches, and what the touch moves by under load.
const AROUND: f64 = 8e-3;
/// Distance of the first touch from the end of a zone from which it needs more, m: half the width of a usual patch.
const NEAR_THE_END: f64 = 3e-3;

/// Half length of the contact grid over that of the window.
const BEYOND: f64 = 2.0;

/// How much further zones go down the faces beside measured profiles, m.
pub(crate) const DEEPER: f64 = 6e-3;

/// The study's mesh sizes, with a zone that holds the Hertz patch of the largest load and goes on beyond the first touch; a worn flange is steeper and
/// touches deeper, so beside measured profiles the zones go on further down the two faces.
pub fn mesh_options(statics: Statics<'_>, geometry: &Geometry) -> MeshOptions {
    let mut options = statics.mesh.clone();
    if statics.rail.measured.is_some() || statics.wheel.measured.is_some() {
        options.rail_zone.face_depth += DEEPER;
    }
    // another shift than the usual one may be wrong, and is refused where it leads out of the zone
    if statics.meshes_are_ours() && statics.track.lateral_shift == 0.0 {
        let touches = [geometry.pair.touch.rail_s, geometry.pair.touch.wheel_s];
        for ((zone, curve), s) in zones(geometry, &mut options).into_iter().zip(touches) {
            let y = curve.point(s).x;
            if y > zone.field_y - NEAR_THE_END {
                zone.field_y = (y + AROUND).min(reach(curve).1).max(zone.field_y);
            }
        }
    }
    if let Some((_, _, patch)) = longest_patch(statics, geometry)
        && patch > contact_half_length(statics, geometry, options.window_half_length)
        && window_is_ours(statics)
    {
        let longer = window_for(statics, patch).min(longest_window(statics, geometry));
        options.window_half_length = longer.max(options.window_half_length);
    }
    options.contact_half_length = contact_half_length(statics, geometry, options.window_half_length);
    options
}

/// Half length of the contact grid of meshes with a window, m: a fine grid also carries a patch that goes on beyond the window, as that of
/// the flange, so that one pair of bodies serves everywhere on the profiles.
fn contact_half_length(statics: Statics<'_>, geometry: &Geometry, window: f64) -> f64 {
    match statics.contact.field {
        FieldKey::Hybrid if window_is_ours(statics) => {
            (BEYOND * window).min(longest_window(statics, geometry))
        }
        FieldKey::Hybrid | FieldKey::Elements => window,
    }
}

/// Checks that the wheel touches within the contact zone of the tool's own meshes, and that the Hertz patch of the
/// largest load stays within it; says where the zone is made longer for that patch.
///
/// Where the bodies conform there is no Hertz patch; the contact solver then finds out.
///
/// # Errors
/// [`InputError`] with the field of the shift, if the first touch lies elsewhere; with the field of the loads, if the
/// patch is longer than the window that the study gives, or than
/// any that wheel and rail have room for.
pub fn check_loads(statics: Statics<'_>, geometry: &Geometry, monitor: &dyn Monitor) -> Result<()> {
    check_touch(statics, geometry)?;
    let Some((field, load, patch)) = longest_patch(statics, geometry) else { return Ok(()) };
    let window = statics.mesh.window_half_length;
    if patch <= contact_half_length(statics, geometry, window) {
        return Ok(());
    }
    let most = if window_is_ours(statics) { longest_window(statics, geometry) } else { window };
    if window_for(statics, patch) <= most {
        monitor.notice(&format!(
            "contact window of \u{b1}{:.1} mm instead of \u{b1}{:.1} mm: the patch of {:.1} kN at {:.0}\u{b0} is about \u{b1}{:.1} mm long",
            window_for(statics, patch) / MILLIMETRE,
            window / MILLIMETRE,
            load / KILONEWTON,
            geometry.pair.touch.contact_angle.to_degrees(),
            patch / MILLIMETRE
        ));
        return Ok(());
    }
    Err(InputError::new(
        field,
        format!("{:.1} kN", load / KILONEWTON),
        format!(
            "loads whose contact patch fits the contact zone of \u{b1}{:.1} mm along the track; at a contact angle of {:.0}\u{b0} this one is about \u{b1}{:.1} mm long",
            most / MILLIMETRE,
            geometry.pair.touch.contact_angle.to_degrees(),
            patch / MILLIMETRE
        ),
        "lower the load, or enlarge `window_half_length`",
    )
    .into())
}

/// Checks that the first touch lies within the contact zones: elsewhere no contact is looked for.
fn check_touch(statics: Statics<'_>, geometry: &Geometry) -> Result<()> {
    let options = mesh_options(statics, geometry);
    let outside = |outline: &SectionOutline, running: &ProfileCurve, s: f64, body: &str| {
        let (first, last) = (outline.fine.first()?.s, outline.fine.last()?.s);
        if first < s && s < last {
            return None;
        }
        let y = |s: f64| running.point(s).x / MILLIMETRE;
        Some(InputError::new(
            InputField::LateralShift,
            format!(
                "{} mm, at which the {body} is touched at y = {:.1} mm of its profile",
                statics.track.lateral_shift / MILLIMETRE,
                y(s)
            ),
            format!(
                "a touch between y = {:.1} and {:.1} mm, in the contact zone of the mesh",
                y(first),
                y(last)
            ),
            "bring `lateral_shift` nearer to zero, or check `gauge` and `flange_back`",
        ))
    };
    let touch = &geometry.pair.touch;
    let (rail, wheel) = (&geometry.pair.rail, &geometry.pair.wheel);
    if statics.rail.mesh.is_none()
        && let Some(error) = outside(&rail_outline(rail, &options)?, &rail.running, touch.rail_s, "rail")
    {
        return Err(error.into());
    }
    if statics.wheel.mesh.is_none()
        && let Some(error) = outside(&wheel_outline(wheel, &options)?, &wheel.running, touch.wheel_s, "wheel")
    {
        return Err(error.into());
    }
    Ok(())
}

/// Whether the study leaves the length of the contact window, and the meshes, to the program.
fn window_is_ours(statics: Statics<'_>) -> bool {
    statics.meshes_are_ours() && !statics.window_given
}

/// Half length of a window that a patch of the half length `patch` does not fill: an element beyond it, and what
/// neighbouring curvatures may add; in whole steps, so that pairs whose patches are alike share their bodies. A fine grid holds it where the
/// contact grid does.
fn window_for(statics: Statics<'_>, patch: f64) -> f64 {
    const STEP: f64 = 4e-3;
    let beyond = match statics.contact.field {
        FieldKey::Hybrid if window_is_ours(statics) => BEYOND,
        FieldKey::Hybrid | FieldKey::Elements => 1.0,
    };
    ((1.15 * patch + statics.mesh.contact_element_along) / (beyond * STEP)).ceil() * STEP
}

/// Half length of the longest window that leaves most of the rail, and of the wheel below its axle, to the coarser mesh.
fn longest_window(statics: Statics<'_>, geometry: &Geometry) -> f64 {
    (0.25 * statics.rail.length).min(0.25 * geometry.pair.wheel.radius)
}

/// The load with the longest Hertz patch along the track at the first touch: its field, the load (N) and the
/// semi-axis (m), of the study's materials: the groups of a mesh are not known before it is read. Pressed down on a slope, the contact carries the load over the cosine of the contact angle, and no more than
/// what loads end at.
fn longest_patch(statics: Statics<'_>, geometry: &Geometry) -> Option<(InputField, f64, f64)> {
    let [along, across] = geometry.pair.relative_radii();
    let largest = |loads: &[f64]| loads.iter().copied().fold(0.0, f64::max);
    let settings = &statics.calibration;
    let (field, load) = [
        (InputField::Loads, largest(&settings.loads)),
        (InputField::HorizontalPreloads, largest(&settings.horizontal_preloads)),
    ]
    .into_iter()
    .reduce(|a, b| if b.1 > a.1 { b } else { a })?;
    let normal = (load / geometry.pair.touch.contact_angle.cos()).min(LARGEST_NORMAL * load);
    let patch = point_contact(normal, along, across, contact_modulus(statics)).ok()?;
    Some((field, load, patch.semi_axis_x))
}

/// Contact modulus of the study's materials, Pa.
fn contact_modulus(statics: Statics<'_>) -> f64 {
    statics.rail.material.contact_modulus(&statics.wheel.material)
}

/// The end of a contact zone that a contact has reached.
pub struct ZoneLimit {
    end: SurfaceEnd,
    /// When or under which load, in words.
    cause: String,
}

impl ZoneLimit {
    /// The end that numerics have stopped at, if it is that.
    pub fn by(cause: &NumericsError) -> Option<Self> {
        Some(Self { end: SurfaceEnd::of(cause.reason)?, cause: cause.to_string() })
    }

    /// The end that a run has ended at, if it has.
    pub fn in_time(ending: Ending) -> Option<Self> {
        match ending {
            Ending::EndOfSurface { end, .. } => Some(Self { end, cause: ending.to_string() }),
            Ending::Completed | Ending::Departed { .. } => None,
        }
    }
}

/// What work within the contact zones has come to.
pub struct ZonedResult<T> {
    /// Its result.
    pub result: T,
    /// Whether there would be more of it, had larger meshes not been refused: then it does not follow from the study alone.
    pub refused: bool,
}

/// Runs `work` on the meshes. Where the contact reaches the end of the contact zone, makes the zone larger, meshes again,
/// says so, and runs `work` again; `meshes` are then the larger ones, which `accept` has seen before. `reached` is the end of the zone
/// that keeps a result from being whole; where no larger zone can be had, the result is what there is.
///
/// # Errors
/// Those of `work`, with a contact at the end of a zone that cannot be made larger where there is no result without it; those of
/// `accept`, unless there is a result.
pub fn within_zones<T>(
    statics: Statics<'_>,
    geometry: &Geometry,
    meshes: &mut Meshes,
    monitor: &dyn Monitor,
    accept: impl Fn(&Meshes) -> Result<()>,
    work: impl Fn(&Meshes) -> Result<T>,
    reached: impl Fn(&T) -> Option<ZoneLimit>,
) -> Result<ZonedResult<T>> {
    let whole = |result| ZonedResult { result, refused: false };
    for extension in 0..EXTENSIONS {
        let done = work(meshes);
        let at_the_end = match &done {
            Ok(result) => reached(result),
            Err(Error::Numerics(cause)) => ZoneLimit::by(cause),
            Err(_) => None,
        };
        let Some(ZoneLimit { end, cause }) = at_the_end else { return done.map(whole) };
        let Some(next) = enlarged(statics, geometry, meshes, (end, extension)) else {
            return done.map(whole);
        };
        match (accept(&next), done) {
            (Ok(()), _) => {}
            (Err(refusal @ Error::Input(_)), Ok(result)) => {
                monitor.notice(&format!("{cause}; a larger contact zone is refused: {refusal}"));
                return Ok(ZonedResult { result, refused: true });
            }
            (Err(refusal), _) => return Err(refusal),
        }
        monitor.notice(&format!(
            "{cause}; meshed again with a contact zone down to {:.1} mm on the rail's and {:.1} mm on the wheel's face and \u{b1}{:.1} mm along the track",
            next.options.rail_zone.face_depth / MILLIMETRE,
            next.options.wheel_zone.face_depth / MILLIMETRE,
            next.options.window_half_length / MILLIMETRE
        ));
        *meshes = next;
    }
    work(meshes).map(whole)
}

/// Meshes with a larger zone, where the contact has `reached` the end of that of `meshes` after so many extensions; `None` where no larger
/// zone can be had.
fn enlarged(
    statics: Statics<'_>,
    geometry: &Geometry,
    meshes: &Meshes,
    reached: (SurfaceEnd, usize),
) -> Option<Meshes> {
    let options = larger(statics, geometry, &meshes.options, reached)?;
    // a zone that the sections have no room for leaves the contact where it ended
    remeshed_with(statics, geometry, meshes, options).ok()
}

/// Options of a mesh with a larger zone; `None` if there is none.
fn larger(
    statics: Statics<'_>,
    geometry: &Geometry,
    options: &MeshOptions,
    (end, extensions): (SurfaceEnd, usize),
) -> Option<MeshOptions> {
    let mut next = options.clone();
    match end {
        SurfaceEnd::ContactWindow if window_is_ours(statics) => {
            let longer = 1.5 * next.window_half_length;
            next.window_half_length =
                longer.min(longest_window(statics, geometry)).max(next.window_half_length);
            next.contact_half_length = contact_half_length(statics, geometry, next.window_half_length);
        }
        SurfaceEnd::ContactZone if statics.meshes_are_ours() => {
            extend_zones(geometry, &mut next, LONGER * f64::from(1 << extensions));
        }
        SurfaceEnd::ContactWindow | SurfaceEnd::ContactZone | SurfaceEnd::RailProfile => return None,
    }
    (next != *options).then_some(next)
}

/// Makes the zones on the profiles longer at both ends by a length (m), as far as the profiles go.
pub(crate) fn extend_zones(geometry: &Geometry, options: &mut MeshOptions, by: f64) {
    for (zone, curve) in zones(geometry, options) {
        let (depth, field) = reach(curve);
        zone.face_depth = (zone.face_depth + by).min(depth).max(zone.face_depth);
        zone.field_y = (zone.field_y + by).min(field).max(zone.field_y);
    }
}

/// The contact zones of rail and wheel, each with its running surface.
fn zones<'a>(
    geometry: &'a Geometry,
    options: &'a mut MeshOptions,
) -> [(&'a mut ContactZone, &'a ProfileCurve); 2] {
    [
        (&mut options.rail_zone, &geometry.pair.rail.running),
        (&mut options.wheel_zone, &geometry.pair.wheel.running),
    ]
}

/// How deep the face of a profile goes, down to the top of a flange, and how far the profile goes to the field side, m.
fn reach(curve: &ProfileCurve) -> (f64, f64) {
    let face = curve.sample(FROM_THE_END).into_iter().filter(|p| p.x < 0.0);
    let depth = face.map(|p| p.y).fold(0.0, f64::max);
    (depth - FROM_THE_END, curve.point(curve.length()).x - FROM_THE_END)
}

/// The tool's own meshes again with the sizes of `study`; those from files stay as they are in `meshes`.
///
/// # Errors
/// Settings that give an inverted or flat element.
pub fn remeshed(statics: Statics<'_>, geometry: &Geometry, meshes: &Meshes) -> Result<Meshes> {
    remeshed_with(statics, geometry, meshes, mesh_options(statics, geometry))
}
