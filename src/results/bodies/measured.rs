//! The measured profiles of a study: read, placed on their standard, checked against it or laid by themselves, and prepared.

use nalgebra::Point2;
use railspring_profiles::error::{Error, InputError, Result};
use railspring_profiles::field::InputField;
use railspring_profiles::placement::lateral_extent;
use railspring_profiles::profile::rails::RAIL_NAMES;
use railspring_profiles::profile_file::{
    Action, Finding, FindingKind, MeasuredProfile, PrepareOptions, Prepared, ProfileKind, ReadOptions, parse,
    prepare,
};
use railspring_profiles::profile_placement::{
    Misfit, Motion, OwnFrame, PlaceOptions, Placed, Reference, Side, TURNED, UNSURE_ROLL, UNSURE_SHIFT,
    Unsure, WIDTH_DEPTH, find_place, in_words, moved_there, place_profile, resembled, sides_of_head,
};
use railspring_profiles::section::{RailSection, rail_section};
use railspring_profiles::units::MILLIMETRE;

use crate::study::MeasuredSurface;

/// Distance from the frame of the standard that no instrument's zero explains, m.
const MOVED: f64 = 1.0 * MILLIMETRE;
/// The same of a wheel's height, whose origin may be at the worn tread, m.
const TREAD_WORN: f64 = 5.0 * MILLIMETRE;
/// The wheel whose flange a profile gets that resembles none.
const ANY_WHEEL: &str = "S1002";
/// How much deeper the field side of a head is worn, on the average, from which it is evidently that of the gauge, m.
const SWAPPED: f64 = 0.3 * MILLIMETRE;

/// A measured surface in the frame of its body.
pub(crate) struct Surface {
    /// As it was read, in its place.
    pub in_place: MeasuredProfile,
    pub prepared: Prepared,
    /// How it was placed, if it was laid onto a standard.
    pub placed: Option<Placed>,
    /// How it was moved from its file, if it was.
    pub motion: Option<Motion>,
    /// By how much its place is unsure.
    pub unsure: Unsure,
}

/// The standard that a measured profile is taken to belong to.
pub(crate) struct Nominal {
    /// Its name.
    pub name: String,
    /// Whether the profile fits it; it is only the one that is most like it otherwise.
    pub fits: bool,
    /// Whether most of it does, so that its body is that of the standard.
    pub sure: bool,
    /// What is said of the choice.
    pub said: Finding,
}

/// Reads the profile of a study. `tape_circle` is the distance of a wheel's tape circle from its flange back, m.
///
/// # Errors
/// Those of the file, and a wheel whose flange is at the field side.
pub(crate) fn read(
    measured: &MeasuredSurface,
    kind: ProfileKind,
    tape_circle: Option<f64>,
) -> Result<MeasuredProfile> {
    let name = measured.path.display().to_string();
    let options = ReadOptions {
        kind: Some(kind),
        unit: measured.unit,
        mirror_y: measured.mirrored,
        part: measured.part.clone(),
        tape_circle,
        ..ReadOptions::default()
    };
    let mut profile = parse(&name, &measured.content.bytes(&measured.path)?, &options)?;
    profile.findings.splice(0..0, measured.findings.iter().cloned());
    if measured.aligned != Some(true) {
        turned_over(measured, &profile)?;
    }
    Ok(profile)
}

fn place_options(measured: &MeasuredSurface) -> PlaceOptions {
    PlaceOptions { side_known: measured.mirrored.is_some() }
}

/// The standard that a profile belongs to, or the one whose body is most like its own.
///
/// # Errors
/// A profile that has the shape of the other body.
pub(crate) fn nominal(measured: &MeasuredSurface, profile: &MeasuredProfile) -> Result<Nominal> {
    let kind = profile.kind;
    let near = match profile.drawn {
        Some(_) => Vec::new(),
        None => resembled(profile, Some(kind), place_options(measured)),
    };
    let noted = |text: String| Finding::new(FindingKind::Shape, Action::Noted, text);
    let how = format!("`{}.standard` gives another", kind.name());
    if let Some(first) = near.first().filter(|first| first.is_standard() && first.tells_the_roll()) {
        let tied: Vec<&str> = near[1..].iter().filter(|m| m.ties_with(first)).map(|m| m.name).collect();
        let also = match tied.is_empty() {
            true => String::new(),
            false => format!("; {} would fit as well", tied.join(" and ")),
        };
        let text =
            format!("taken as measured on {}, the nearest of {}{also}; {how}", first.name, in_words(&near));
        return Ok(Nominal {
            name: first.name.into(),
            fits: true,
            sure: first.tells_the_body(),
            said: noted(text),
        });
    }
    of_its_kind(measured, profile)?;
    let like = match (near.first(), kind) {
        (Some(first), _) => first.name,
        (None, ProfileKind::Rail) => of_like_width(profile),
        (None, ProfileKind::Wheel) => ANY_WHEEL,
    };
    let off = match near.first() {
        Some(first) if first.is_standard() => {
            let angle = first.placed.motion.angle.to_degrees();
            format!(
                "too little of it would lie on {first}, turned by {angle:.1} degrees, to tell that it is that"
            )
        }
        Some(first) => format!("it fits no standard within its tolerance; the nearest is {first}"),
        None => "it resembles no standard".to_owned(),
    };
    let assumed = match kind {
        ProfileKind::Rail => format!(
            "web and foot are assumed to be those of {like}, moved to the measured head; `rail.body` or {how}"
        ),
        ProfileKind::Wheel => format!(
            "the rim, and a flange and a tread where the profile has none, are assumed to be like those of {like}; {how}"
        ),
    };
    Ok(Nominal { name: like.into(), fits: false, sure: false, said: noted(format!("{off}: {assumed}")) })
}

/// Refuses a profile that has the shape of the other body, or a size that none of its kind has.
fn of_its_kind(measured: &MeasuredSurface, profile: &MeasuredProfile) -> Result<()> {
    let kind = profile.kind;
    of_a_size(measured, profile)?;
    let other = |f: &Finding| f.kind == FindingKind::Shape && f.action == Action::Left;
    let other_kind = if kind == ProfileKind::Rail { ProfileKind::Wheel } else { ProfileKind::Rail };
    let of_other = || resembled(profile, Some(other_kind), place_options(measured));
    let shape = match profile.findings.iter().find(|f| other(f)) {
        Some(found) => found.text.clone(),
        None => match of_other().into_iter().find(Misfit::is_standard) {
            Some(standard) => format!("it has the shape of {standard}"),
            None => return Ok(()),
        },
    };
    let value = format!("{:?}, {shape}", measured.file);
    let expected = format!("the profile of a {}", kind.name());
    let remedy = "the file is that of the other body: give wheel and rail in their order";
    Err(InputError::new(fields(kind).0, value, expected, remedy).into())
}

/// Refuses a profile that is larger than any of its kind: its unit is another one.
fn of_a_size(measured: &MeasuredSurface, profile: &MeasuredProfile) -> Result<()> {
    /// Width of the widest heads and wheels, m.
    const WIDEST: [f64; 2] = [0.095, 0.175];
    let points: Vec<Point2<f64>> = profile.points.iter().map(|p| p.point).collect();
    let (width, widest) = match profile.kind {
        ProfileKind::Rail => match sides_of_head(&points, WIDTH_DEPTH) {
            [Some(gauge), Some(field)] => (field - gauge, WIDEST[0]),
            _ => return Ok(()),
        },
        ProfileKind::Wheel => {
            let [low, high] = lateral_extent(points.iter().copied());
            (high - low, WIDEST[1])
        }
    };
    if width <= widest {
        return Ok(());
    }
    let kind = profile.kind;
    let value =
        format!("{:?}, {:.1} mm wide, the shape of no known standard", measured.file, width / MILLIMETRE);
    let expected = format!("the profile of a {}, up to {:.0} mm wide", kind.name(), widest / MILLIMETRE);
    let remedy = format!("check its unit: `{}.profile_unit` gives another", kind.name());
    Err(InputError::new(fields(kind).0, value, expected, remedy).into())
}

/// The standard rail whose head is as wide as the measured one, or narrower by wear; where the width was not measured, the usual one.
fn of_like_width(profile: &MeasuredProfile) -> &'static str {
    const USUAL: &str = "60E1";
    /// How much wider a measured head may be than its standard, m.
    const LIP: f64 = 1.0 * MILLIMETRE;
    let points: Vec<Point2<f64>> = profile.points.iter().map(|p| p.point).collect();
    let [Some(gauge), Some(field)] = sides_of_head(&points, WIDTH_DEPTH) else { return USUAL };
    let width = field - gauge;
    let off = |name: &str| {
        let own = rail_section(name).map_or(f64::INFINITY, |rail| head_width(&rail));
        if own + LIP < width { 2.0 * (width - own) } else { own - width }
    };
    let nearest = RAIL_NAMES.iter().copied().min_by(|a, b| off(a).abs().total_cmp(&off(b).abs()));
    nearest.filter(|name| off(name).abs() + LIP < off(USUAL).abs()).unwrap_or(USUAL)
}

/// Width of a head 14 mm below its top, m.
pub(crate) fn head_width(rail: &RailSection) -> f64 {
    match sides_of_head(&rail.running.sample(0.5 * MILLIMETRE), WIDTH_DEPTH) {
        [Some(gauge), Some(field)] => field - gauge,
        _ => 2.0 * rail.running.point(rail.running.length()).x,
    }
}

/// The profile of a study on a standard, prepared; `None` where it does not have that shape. It is placed there where the study wants that, or where it
/// evidently lies elsewhere.
///
/// # Errors
/// A profile of the other body, a head whose sides are swapped, and what cannot be prepared.
pub(crate) fn on_reference(
    measured: &MeasuredSurface,
    profile: &MeasuredProfile,
    reference: &Reference,
) -> Result<Option<Surface>> {
    let options = place_options(measured);
    let of_file = |error| in_study(measured, reference.kind, error);
    let (in_place, placed) = match measured.aligned {
        Some(true) => {
            let (moved, placed) = place_profile(profile, reference, options).map_err(of_file)?;
            (moved, Some(placed))
        }
        // Lines and arcs are no measurement: they say where they lie.
        _ if profile.drawn.is_some() => (profile.clone(), None),
        given => match checked_place(measured, profile, reference, options, given.is_some())? {
            Checked::AsItStands(found) => {
                let mut checked = profile.clone();
                checked.findings.extend(found);
                (checked, None)
            }
            Checked::Unlike => return Ok(None),
            Checked::Elsewhere(placed, text) => {
                let mut moved = moved_there(profile, &placed, reference, options).map_err(of_file)?;
                let text = format!(
                    "{text}: placed there; `{}.profile_aligned` = false takes it as it stands",
                    reference.kind.name()
                );
                moved.findings.push(Finding::new(FindingKind::Aligned, Action::Noted, text));
                (moved, Some(*placed))
            }
        },
    };
    let prepared = prepare(&in_place, &PrepareOptions { smoothing: measured.smoothing })?;
    let motion = placed.as_ref().map(|placed| placed.motion);
    let unsure = placed.as_ref().map_or_else(Unsure::default, |placed| {
        let twice = |uncertainty: f64, most: f64| (2.0 * uncertainty).min(most);
        let wheel = reference.kind == ProfileKind::Wheel;
        let (roll, shift) = (twice(placed.spread.angle, UNSURE_ROLL), twice(placed.spread.y, UNSURE_SHIFT));
        if wheel { Unsure { roll: 0.0, shift } } else { Unsure { roll, shift: 0.0 } }
    });
    Ok(Some(Surface { in_place, prepared, placed, motion, unsure }))
}

/// The profile of a study of which no standard is known, prepared, in the frame of a body like its own: by its own shape, or as it stands where the study
/// says so.
///
/// # Errors
/// What cannot be prepared.
pub(crate) fn by_itself(
    measured: &MeasuredSurface,
    profile: &MeasuredProfile,
    frame: impl Fn(&MeasuredProfile) -> Result<OwnFrame>,
) -> Result<Surface> {
    let (in_place, motion, unsure) = match measured.aligned {
        Some(false) => (profile.clone(), None, Unsure::default()),
        _ if profile.drawn.is_some() => (profile.clone(), None, Unsure::default()),
        _ => {
            let OwnFrame { profile, motion, unsure } = frame(profile)?;
            (profile, Some(motion), unsure)
        }
    };
    let prepared = prepare(&in_place, &PrepareOptions { smoothing: measured.smoothing })?;
    Ok(Surface { in_place, prepared, placed: None, motion, unsure })
}

/// Where a profile lies that the study does not place.
enum Checked {
    /// In the frame of its standard, or meant so; with what is said about it.
    AsItStands(Option<Finding>),
    /// Evidently elsewhere: the place, and how that shows.
    Elsewhere(Box<Placed>, String),
    /// It does not have the shape of the standard.
    Unlike,
}

/// What is said of a profile whose shape is not that of its standard.
pub(crate) fn unlike(standard: &str) -> Finding {
    let text = format!("it does not have the shape of {standard}, whose body it is laid on by its own shape");
    // what that may cost is in the band of what was assumed
    Finding::new(FindingKind::Shape, Action::Noted, text)
}

/// The keys of a body: its file, and whether that is placed.
fn fields(kind: ProfileKind) -> (InputField, InputField) {
    match kind {
        ProfileKind::Rail => (InputField::RailProfile, InputField::RailAligned),
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

/// Where a profile lies against the standard that the study does not place. Refuses a head whose sides are swapped, unless the study says that it is meant
/// so.
fn checked_place(
    measured: &MeasuredSurface,
    profile: &MeasuredProfile,
    reference: &Reference,
    options: PlaceOptions,
    meant: bool,
) -> Result<Checked> {
    let head = fields(reference.kind).0;
    let noted = |kind, text: String| Ok(Checked::AsItStands(Some(Finding::new(kind, Action::Noted, text))));
    let placed = match find_place(profile, reference, options) {
        Ok(placed) => placed,
        Err(error) if meant => {
            return noted(FindingKind::Shape, format!("taken as it stands, as requested: {error}"));
        }
        Err(_) => {
            of_its_kind(measured, profile)?;
            return Ok(Checked::Unlike);
        }
    };
    if placed.motion.mirrored && reference.kind == ProfileKind::Wheel && !meant {
        return Ok(Checked::Elsewhere(Box::new(placed), "with its flange at the field side".into()));
    }
    let swapped = match placed.side {
        Side::Outline if placed.motion.mirrored => Some("its two sides are swapped".to_owned()),
        Side::Wear(deeper) if placed.motion.mirrored => {
            let text = format!(
                "the head is worn deeper at the field side than at the gauge, by {:.2} mm on the average",
                deeper / MILLIMETRE
            );
            if deeper < SWAPPED {
                let text = format!("{text}: if it is a left rail's, set rail.profile_mirrored = true");
                return Ok(Checked::AsItStands(Some(Finding::new(
                    FindingKind::Mirrored,
                    Action::Left,
                    text,
                ))));
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
        Some(text) => Ok(Checked::Elsewhere(Box::new(placed), text)),
        None => Ok(Checked::AsItStands(None)),
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

/// An error about the shape of a file, with the study's key.
fn in_study(measured: &MeasuredSurface, kind: ProfileKind, error: Error) -> Error {
    match error {
        Error::Input(error) => {
            let value = format!("{:?}, {}", measured.file, error.value);
            InputError::new(fields(kind).0, value, error.expected, error.remedy).into()
        }
        other => other,
    }
}
