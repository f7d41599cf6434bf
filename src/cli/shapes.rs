//! The subcommands that show profiles: `list`, `show`, `plot`.

use std::path::Path;

use railspring_calibrate::error::{Error, InputError};
use railspring_calibrate::profile::ProfileCurve;
use railspring_calibrate::profile::rails::{RAIL_NAMES, STANDARD_RAILS};
use railspring_calibrate::profile::wheels::{STANDARD_WHEELS, WHEEL_NAMES, wheel_profile};
use railspring_calibrate::profile_file::{
    Action, MeasuredProfile, PrepareOptions, Prepared, ReadOptions, prepare, read,
};
use railspring_calibrate::section::rail_section;
use railspring_calibrate::section_analysis::rail_properties;
use railspring_calibrate::units::MILLIMETRE;

use super::findings::{Listed, marked};
use super::say;
use crate::report::panel::{Panel, stacked_with_notes};
use crate::report::plot::{BLUE, DARK, DARK_RED, Dash, GREY, Marker, ORANGE, RED, Series};

/// What a name means.
fn meaning(name: &str) -> &'static str {
    let rail = STANDARD_RAILS.iter().find(|rail| rail.name == name).map(|rail| rail.description);
    rail.or_else(|| STANDARD_WHEELS.iter().find(|wheel| wheel.name == name).map(|wheel| wheel.description))
        .unwrap_or("standard profile")
}

/// Prints the standards.
pub(super) fn list() -> Result<(), Error> {
    for name in RAIL_NAMES.iter().chain(&WHEEL_NAMES) {
        say(&format!("{name:14} {}", meaning(name)))?;
    }
    say("wheel bodies   straight-web, s-web: generic, with bore, hub and rim to be set in a study")
}

/// The running surface of a standard or of a file.
fn curve(profile: &str) -> Result<ProfileCurve, Error> {
    match standard(profile)? {
        Some(curve) => Ok(curve),
        None => Ok(measured(profile)?.1.curve),
    }
}

/// The running surface of a standard, if it is the name of one.
fn standard(profile: &str) -> Result<Option<ProfileCurve>, Error> {
    if RAIL_NAMES.contains(&profile) {
        return Ok(Some(rail_section(profile)?.running));
    }
    if WHEEL_NAMES.contains(&profile) {
        return wheel_profile(profile).map(Some);
    }
    Ok(None)
}

/// A file as it was read, and prepared.
fn measured(profile: &str) -> Result<(MeasuredProfile, Prepared), Error> {
    let path = Path::new(profile);
    if !path.exists() {
        let names: Vec<&str> = RAIL_NAMES.iter().chain(&WHEEL_NAMES).copied().collect();
        return Err(InputError::new(
            "profile",
            format!("{profile:?}"),
            format!("one of {}, or a profile file", names.join(", ")),
            "see `railspring profile list`, or check the path",
        )
        .into());
    }
    let measured = read(path, &ReadOptions::default())?;
    let prepared = prepare(&measured, &PrepareOptions { smoothing: None })?;
    Ok((measured, prepared))
}

/// Prints the numbers of a profile.
pub(super) fn show(profile: &str) -> Result<(), Error> {
    let running = curve(profile)?;
    let millimetres = |value: f64| value / MILLIMETRE;
    say(&format!(
        "{profile}: {}",
        if Path::new(profile).exists() { "profile file" } else { meaning(profile) }
    ))?;
    let (start, end) = (running.point(0.0), running.point(running.length()));
    say(&format!(
        "running surface    {:.3} mm long, from (y, z) = ({:.3}, {:.3}) to ({:.3}, {:.3}) mm; z down",
        millimetres(running.length()),
        millimetres(start.x),
        millimetres(start.y),
        millimetres(end.x),
        millimetres(end.y),
    ))?;
    for s in running.breakpoints() {
        let p = running.point(s);
        let before = running.curvature(s - 1e-9);
        let radius = |k: f64| if k.abs() < 1e-3 { "straight".into() } else { format!("R {:.2}", 1e3 / k) };
        let kink = if running.kinks().contains(&s) { ", kink" } else { "" };
        say(&format!(
            "joint              (y, z) = ({:.4}, {:.4}) mm, {} | {}{kink}",
            millimetres(p.x),
            millimetres(p.y),
            radius(before),
            radius(running.curvature(s)),
        ))?;
    }
    if RAIL_NAMES.contains(&profile) {
        let p = rail_properties(&rail_section(profile)?)?;
        let rows = [
            ("area", p.area * 1e4, "cm²"),
            ("centroid", p.centroid_height * 1e3, "mm above the foot"),
            ("Ixx", p.ixx * 1e8, "cm⁴, vertical bending"),
            ("Iyy", p.iyy * 1e8, "cm⁴, lateral bending"),
            ("J", p.torsion_constant * 1e8, "cm⁴, torsion"),
            ("warping constant", p.warping_constant * 1e12, "cm⁶"),
            ("shear centre", p.shear_centre_height * 1e3, "mm above the foot"),
            ("shear coefficient", p.shear_coefficient_vertical, "vertical"),
            ("shear coefficient", p.shear_coefficient_lateral, "lateral"),
        ];
        for (what, value, unit) in rows {
            say(&format!("{what:18} {value:.4} {unit}"))?;
        }
    }
    Ok(())
}

/// Colours and dashes of the profiles of a figure.
const STYLES: [(plotters::style::RGBColor, Dash); 4] =
    [(DARK, Dash::Solid), (RED, Dash::Dashed), (BLUE, Dash::Dotted), (ORANGE, Dash::Solid)];

/// Draws profiles over each other, and their curvature below; the findings of files are marked where they are and
/// listed at the bottom.
pub(super) fn plot(profiles: &[String], output: &Path) -> Result<(), Error> {
    let (mut shapes, mut curvatures) = (Vec::new(), Vec::new());
    let (mut found, mut listed) = (Vec::new(), Listed::default());
    for (profile, (color, dash)) in profiles.iter().zip(STYLES.iter().cycle().copied()) {
        let (curve, marks) = match standard(profile)? {
            Some(curve) => (curve, Vec::new()),
            None => {
                let (measured, prepared) = measured(profile)?;
                let marks = marked(&measured, &prepared, &mut listed);
                (prepared.curve, marks)
            }
        };
        let parameters = curve.sample_parameters(0.1 * MILLIMETRE);
        let points = |f: &dyn Fn(f64) -> f64| -> Vec<(f64, f64)> {
            parameters.iter().map(|&s| (curve.point(s).x / MILLIMETRE, f(s))).collect()
        };
        shapes.push(Series::line(profile, points(&|s| -curve.point(s).y / MILLIMETRE), color, dash));
        curvatures.push(Series::line(profile, points(&|s| curve.curvature(s) * MILLIMETRE), color, dash));
        let kinks: Vec<(f64, f64)> = curve
            .kinks()
            .iter()
            .map(|&s| curve.point(s))
            .map(|p| (p.x / MILLIMETRE, -p.y / MILLIMETRE))
            .collect();
        if !kinks.is_empty() {
            shapes.push(Series::marks("kink", kinks, RED, Marker::Circle));
        }
        for mark in marks {
            let p = curve.point(mark.s);
            found.push((p.x / MILLIMETRE, -p.y / MILLIMETRE, mark));
        }
    }
    // Above the curvature, which would hide them where it is rough.
    let top = curvatures.iter().flat_map(|s| &s.points).fold(0.0, |top: f64, p| top.max(p.1));
    for (y, height, mark) in found {
        let (color, marker) = match mark.action {
            Action::Noted => (GREY, Marker::Disc),
            Action::Repaired => (BLUE, Marker::Square),
            Action::Left => (DARK_RED, Marker::Triangle),
        };
        let name = format!("finding, {}", mark.action.name());
        let series = |value: f64| {
            Series::marks(&name, vec![(y, value)], color, marker).labelled(vec![mark.numbers.clone()])
        };
        shapes.push(series(height));
        curvatures.push(series(1.1 * top));
    }
    let panel = |y_label: &str, series| Panel {
        x_label: "y to the field side (mm)".into(),
        y_label: y_label.into(),
        from_zero: false,
        series,
    };
    let panels = [panel("height \u{2212}z (mm)", shapes), panel("curvature (1/mm)", curvatures)];
    let figure = stacked_with_notes(760, 320, &panels, &listed.notes);
    write(output, &figure)?;
    say(&output.display().to_string())
}

/// Writes a file.
pub(super) fn write(path: &Path, text: &str) -> Result<(), Error> {
    std::fs::write(path, text).map_err(|cause| {
        InputError::new(
            "--output",
            path.display().to_string(),
            format!("a place that can be written to ({cause})"),
            "check the path and the permissions",
        )
        .into()
    })
}
