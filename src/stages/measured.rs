//! The measured profiles of a study: read, placed on their standard or checked against it, and prepared.

use railspring_calibrate::error::{Error, InputError, Result};
use railspring_calibrate::field::InputField;
use railspring_calibrate::profile_file::{
    Action, Finding, FindingKind, MeasuredProfile, PrepareOptions, Prepared, ProfileKind, ReadOptions, parse,
    prepare,
};
use railspring_calibrate::profile_placement::{
    PlaceOptions, Placed, Reference, Side, find_place, place_profile,
};
use railspring_calibrate::units::MILLIMETRE;

use crate::study::MeasuredSurface;

/// Half of the least inclination in use, 1:40, rad: profiles in the frame of their standard are turned by less.
const TURNED: f64 = 0.0125;
/// Distance from the frame of the standard that no instrument's zero explains, m.
const MOVED: f64 = 1.0 * MILLIMETRE;
/// The same of a wheel's height, whose origin may be at the worn tread, m.
const TREAD_WORN: f64 = 5.0 * MILLIMETRE;
/// How much deeper the field side of a head is worn, on the average, from which it is evidently that of the gauge, m.
const SWAPPED: f64 = 0.3 * MILLIMETRE;

/// A measured surface in the frame of its body.
pub(super) struct Surface {
    /// As it was read, in its place.
    pub in_place: MeasuredProfile,
    pub prepared: Prepared,
    /// How it was placed, if it was.
    pub placed: Option<Placed>,
}

/// Reads the profile of a study and prepares it. With `profile_aligned` it is placed on the standard; without, one that evidently
/// lies elsewhere is refused. `tape_circle` is the distance of a wheel's tape circle from its flange back, m.
pub(super) fn surface(
    measured: &MeasuredSurface,
    reference: &Reference,
    tape_circle: Option<f64>,
) -> Result<Surface> {
    let name = measured.path.display().to_string();
    let options = ReadOptions {
        kind: Some(reference.kind),
        unit: measured.unit,
        mirror_y: measured.mirrored,
        part: measured.part.clone(),
        tape_circle,
        ..ReadOptions::default()
    };
    let mut profile = parse(&name, &measured.content, &options)?;
    profile.findings.splice(0..0, measured.findings.iter().cloned());
    let options = PlaceOptions { side_known: measured.mirrored.is_some() };
    let (in_place, placed) = match measured.aligned {
        Some(true) => {
            let placed = place_profile(&profile, reference, options);
            let (moved, placed) = placed.map_err(|error| in_study(measured, reference.kind, error, None))?;
            (moved, Some(placed))
        }
        given => {
            turned_over(measured, &profile)?;
            let mut checked = profile.clone();
            // Lines and arcs are no measurement: they say where they lie.
            if profile.drawn.is_none() {
                let found = checked_place(measured, &profile, reference, options, given.is_some())?;
                checked.findings.extend(found);
            }
            (checked, None)
        }
    };
    let prepared = prepare(&in_place, &PrepareOptions { smoothing: measured.smoothing })?;
    Ok(Surface { in_place, prepared, placed })
}

/// The keys of a body: its file, and whether that is placed.
fn fields(kind: ProfileKind) -> (InputField, InputField) {
    match kind {
        ProfileKind::Rail => (InputField::RailHead, InputField::RailAligned),
        ProfileKind::Wheel => (InputField::WheelProfile, InputField::WheelAligned),
    }
}

/// Refuses a wheel whose flange is at the field side.
fn turned_over(measured: &MeasuredSurface, profile: &MeasuredProfile) -> Result<()> {
    let out = |f: &Finding| f.kind == FindingKind::Mirrored && f.action == Action::Left;
    if profile.kind == ProfileKind::Rail || !profile.findings.iter().any(out) {
        return Ok(());
    }
    let (expected, remedy) = match measured.mirrored {
        Some(true) => {
            ("a file in which y counts towards the track centre", "remove `wheel.profile_mirrored`")
        }
        _ => (
            "the profile of a right wheel, y to the field side",
            "set `wheel.profile_mirrored` = true, or `wheel_aligned` = true, which finds the side itself",
        ),
    };
    let value = format!("{:?}, a wheel with its flange at the field side", measured.file);
    Err(InputError::new(InputField::WheelProfile, value, expected, remedy).into())
}

/// Where a profile that is taken as it stands lies against the standard. Refuses one that evidently lies elsewhere, unless the
/// study says that it is meant so.
fn checked_place(
    measured: &MeasuredSurface,
    profile: &MeasuredProfile,
    reference: &Reference,
    options: PlaceOptions,
    meant: bool,
) -> Result<Option<Finding>> {
    let (head, aligned) = fields(reference.kind);
    let noted = |kind, text: String| Ok(Some(Finding::new(kind, Action::Noted, text)));
    let as_meant = format!("if it is meant like that, say so with `{aligned}` = false");
    let placed = match find_place(profile, reference, options) {
        Ok(placed) => placed,
        Err(error) if meant => {
            return noted(FindingKind::Shape, format!("taken as it stands, as requested: {error}"));
        }
        Err(error) => return Err(in_study(measured, reference.kind, error, Some(&as_meant))),
    };
    let swapped = match placed.side {
        Side::Outline if placed.motion.mirrored => Some("its two sides are swapped".to_owned()),
        Side::Wear(deeper) if placed.motion.mirrored => {
            let text = format!(
                "the head is worn deeper at the field side than at the gauge, by {:.2} mm on the average",
                deeper / MILLIMETRE
            );
            if deeper < SWAPPED {
                let text = format!("{text}: if it is a left rail's, set rail.profile_mirrored = true");
                return Ok(Some(Finding::new(FindingKind::Mirrored, Action::Left, text)));
            }
            Some(text)
        }
        _ => None,
    };
    if let (Some(swapped), false) = (&swapped, meant) {
        let expected = "a right rail, y to the field side";
        let remedy = "if it is a left rail's, set `rail.profile_mirrored` = true, or false if it is worn like that; \
                      `rail_aligned` = true takes the side that is worn more for the gauge's";
        let value = format!("{:?}, {swapped}", measured.file);
        return Err(InputError::new(head, value, expected, remedy).into());
    }
    match misplaced(&placed, reference) {
        Some(text) if meant => {
            noted(FindingKind::Aligned, format!("{text}: taken as it stands, as requested"))
        }
        Some(text) => {
            let canted = match reference.kind {
                ProfileKind::Rail => "a head that is measured as it lies in the track, canted,",
                ProfileKind::Wheel => "a profile with another origin or rotation",
            };
            let frame = match reference.kind {
                ProfileKind::Rail => "origin at the unworn top, on the axis, not inclined",
                ProfileKind::Wheel => "origin at the tape circle, not turned",
            };
            Err(InputError::new(
                head,
                format!("{:?}, {text}", measured.file),
                format!("a profile in the frame of its standard: {frame}"),
                format!(
                    "{canted} needs `{aligned}` = true, which places it as `railspring profile place` does; {as_meant}"
                ),
            )
            .into())
        }
        None => Ok(None),
    }
}

/// What is evidently wrong with the place of a profile, beyond what is uncertain about it.
fn misplaced(placed: &Placed, reference: &Reference) -> Option<String> {
    let (motion, spread) = (&placed.motion, &placed.spread);
    let beyond = |value: f64, uncertainty: f64, limit: f64| value.abs() > limit + 2.0 * uncertainty;
    let depth = if reference.kind == ProfileKind::Rail { MOVED } else { TREAD_WORN };
    let turned = beyond(motion.angle, spread.angle, TURNED);
    let moved =
        beyond(motion.translation.x, spread.y, MOVED) || beyond(motion.translation.y, spread.z, depth);
    if !turned && !moved {
        return None;
    }
    let ratio = format!(", 1:{:.0},", 1.0 / motion.angle.tan().abs());
    Some(format!(
        "which lies off {}: it fits there turned by {:.3} degrees{} and moved by ({:.3}, {:.3}) mm",
        reference.name,
        motion.angle.to_degrees(),
        if turned { &ratio } else { "" },
        motion.translation.x / MILLIMETRE,
        motion.translation.y / MILLIMETRE,
    ))
}

/// An error about the shape of a file, with the study's key and what else may be done.
fn in_study(measured: &MeasuredSurface, kind: ProfileKind, error: Error, more: Option<&str>) -> Error {
    match error {
        Error::Input(error) => {
            let more = more.map_or(String::new(), |more| format!("; {more}"));
            let value = format!("{:?}, {}", measured.file, error.value);
            InputError::new(fields(kind).0, value, error.expected, format!("{}{more}", error.remedy)).into()
        }
        other => other,
    }
}
