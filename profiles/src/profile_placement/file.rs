//! A profile from a file, put in its place, and what is said about it.

use nalgebra::Point2;

use super::nearest::{in_words, resembled};
use super::placed::{GREATEST_SHIFT, GREATEST_TURN, PlaceOptions, Placed, place};
use super::reference::Reference;
use super::side::Side;
use crate::error::{Error, InputError, Result};
use crate::profile_file::{Action, Finding, FindingKind, MeasuredProfile, ProfileKind, repaired};
use crate::units::MILLIMETRE;

/// Where a profile lies against the standard.
///
/// # Errors
/// [`InputError`] for a profile that cannot be repaired, for lines and arcs, and with the name of its file for one that does not have the shape of the
/// standard: another rail or wheel, or a rail's for a wheel.
pub fn find_place(profile: &MeasuredProfile, reference: &Reference, options: PlaceOptions) -> Result<Placed> {
    if profile.drawn.is_some() {
        let remedy = "lines and arcs say where they lie themselves: place measurements alone";
        return InputError::refuse(&profile.name, "lines and arcs", "a measurement", remedy);
    }
    // The curve is made in place: here its points are enough.
    let points: Vec<Point2<f64>> = repaired(profile, &mut Vec::new())?.iter().map(|p| p.point).collect();
    match place(&points, reference, options.of(profile))? {
        Some(placed) if placed.resembles() => Ok(placed),
        _ => Err(refused(profile, reference, options)),
    }
}

/// The profile in the frame of the standard, with findings that say how it was placed, and the place.
///
/// Findings about axes and origin that the reader left to be looked at are answered by the place and dropped.
///
/// # Errors
/// As [`find_place`], and for a profile of which wear leaves nothing alone.
pub fn place_profile(
    profile: &MeasuredProfile,
    reference: &Reference,
    options: PlaceOptions,
) -> Result<(MeasuredProfile, Placed)> {
    let placed = find_place(profile, reference, options)?;
    Ok((moved_there(profile, &placed, reference, options)?, placed))
}

/// The profile in a place that was found for it ([`find_place`]), as [`place_profile`] gives it.
///
/// # Errors
/// As [`place_profile`], but those of finding the place.
pub fn moved_there(
    profile: &MeasuredProfile,
    placed: &Placed,
    reference: &Reference,
    options: PlaceOptions,
) -> Result<MeasuredProfile> {
    if !placed.fits() {
        let expected = format!("a part that wear leaves alone: {}", unworn_parts(reference.kind));
        let remedy = "measure more of it, or give the profile in the frame of its standard";
        return InputError::refuse(&profile.name, "nothing but worn surface", expected, remedy);
    }
    let mut moved = profile.clone();
    moved.kind = reference.kind;
    moved.points.iter_mut().for_each(|p| p.point = placed.motion.apply(&p.point));
    let ends = [moved.points.first(), moved.points.last()].map(|p| p.map_or(0.0, |p| p.point.x));
    if ends[1] < ends[0] {
        moved.points.reverse();
    }
    let answered = [FindingKind::Mirrored, FindingKind::UpsideDown, FindingKind::Origin, FindingKind::Shape];
    moved.findings.retain(|f| f.action != Action::Left || !answered.contains(&f.kind));
    moved.findings.extend(findings(placed, reference, options.of(profile)));
    Ok(moved)
}

/// The message about a profile that does not fit, with the standards that do.
fn refused(profile: &MeasuredProfile, reference: &Reference, options: PlaceOptions) -> Error {
    let fitting = resembled(profile, None, options);
    let (kind, standard) = (reference.kind.name(), &reference.name);
    let (value, remedy) = match fitting.first() {
        Some(first) => {
            let value = format!("the shape of a {}", first.kind.name());
            let swapped =
                if first.kind == reference.kind { "" } else { "the file is that of the other body; " };
            (value, format!("{swapped}the nearest standards are {}", in_words(&fitting)))
        }
        None => (
            "the shape of no known standard".to_owned(),
            "check the file, its unit and that it is a whole profile; `railspring profile plot` shows it"
                .to_owned(),
        ),
    };
    let expected = format!("the {kind} {standard}, new or worn");
    InputError::new(&profile.name, value, expected, remedy).into()
}

/// What to measure of a body so that its place is determined.
fn unworn_parts(kind: ProfileKind) -> &'static str {
    match kind {
        ProfileKind::Rail => "the field side of the head, its underside, web or foot",
        ProfileKind::Wheel => "the back of the flange and the field end of the tread",
    }
}

/// What is said about a place.
fn findings(placed: &Placed, reference: &Reference, options: PlaceOptions) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut add = |kind, action, text: String, value| {
        findings.push(Finding { value: Some(value), ..Finding::new(kind, action, text) });
    };
    let (motion, spread) = (&placed.motion, &placed.spread);
    let uncertain = |value: f64, digits: usize, unit: &str| {
        if value.is_finite() { format!("{:.digits$} {unit}", 2.0 * value) } else { "any".into() }
    };
    let within = format!(
        "uncertain by {} laterally, {} vertically, {} of rotation (twice the standard uncertainty)",
        uncertain(spread.y / MILLIMETRE, 3, "mm"),
        uncertain(spread.z / MILLIMETRE, 3, "mm"),
        uncertain(spread.angle.to_degrees(), 3, "degrees"),
    );
    let moved = format!(
        "turned by {:.4} degrees and moved by ({:.4}, {:.4}) mm onto {}, of whose surface without wear {:.1} mm are kept; {within}",
        motion.angle.to_degrees(),
        motion.translation.x / MILLIMETRE,
        motion.translation.y / MILLIMETRE,
        reference.name,
        placed.kept_length / MILLIMETRE,
    );
    let rms = (placed.rms / (1e-3 * MILLIMETRE), "\u{b5}m RMS of what is kept");
    if placed.determined() {
        add(FindingKind::Aligned, Action::Repaired, moved, rms);
    } else {
        let more = unworn_parts(reference.kind);
        let limit = format!(
            "more than {} mm or {:.2} degrees: what wear leaves alone does not determine the place, measure more of {more}",
            GREATEST_SHIFT / MILLIMETRE,
            GREATEST_TURN.to_degrees(),
        );
        add(FindingKind::Aligned, Action::Left, format!("{moved}, {limit}"), rms);
    }
    match placed.side {
        Side::Outline if motion.mirrored => findings.push(Finding::new(
            FindingKind::Mirrored,
            Action::Repaired,
            match reference.kind {
                ProfileKind::Wheel => "the flange was at the field side: turned over",
                ProfileKind::Rail => "the outline fits turned over",
            },
        )),
        Side::Wear(difference) => {
            let value = (difference / MILLIMETRE, "mm");
            let (action, text) = match (motion.mirrored, options.side_known) {
                (true, _) => (
                    Action::Repaired,
                    "deeper wear of the side that was to the field: it is that of the gauge, turned over",
                ),
                (false, true) => (
                    Action::Noted,
                    "deeper wear of one side of the head; which one is the gauge's was given or seen",
                ),
                (false, false) => {
                    (Action::Noted, "deeper wear of the side to the track centre, as it is expected")
                }
            };
            findings.push(Finding::new(FindingKind::Mirrored, action, text).with_value(value.0, value.1));
        }
        Side::NotTold { .. } if !options.side_known => findings.push(Finding::new(
            FindingKind::Mirrored,
            Action::Noted,
            "wear does not tell left from right: y counts as in the file",
        )),
        _ => {}
    }
    if !placed.size.is_one() {
        let text = format!(
            "times the measured size, \u{b1} {:.4}, would fit better: check the unit, and whether {} is the standard",
            2.0 * placed.size.uncertainty,
            reference.name
        );
        let finding = Finding::new(FindingKind::Unit, Action::Left, text);
        findings.push(finding.with_value(placed.size.factor, ""));
    }
    findings
}
