//! The subcommands that show profiles: `list`, `show`, `plot`.

use std::path::Path;

use nalgebra::Point2;
use railspring_calibrate::section_analysis::rail_properties;
use railspring_profiles::error::{Error, InputError};
use railspring_profiles::input;
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::profile::lines_and_arcs::LinesAndArcs;
use railspring_profiles::profile::rail_catalogue::CATALOGUE_RAILS;
use railspring_profiles::profile::rails::{RAIL_NAMES, STANDARD_RAILS};
use railspring_profiles::profile::wheels::{STANDARD_WHEELS, WHEEL_NAMES, wheel_profile};
use railspring_profiles::profile_file::{
    Action, LARGEST_FILE, MeasuredProfile, PrepareOptions, Prepared, ProfileKind, ReadOptions, Sketch,
    prepare, read, sketch_section,
};
use railspring_profiles::section::{rail_section, rail_section_of};
use railspring_profiles::units::MILLIMETRE;

use super::findings::{Listed, Mark, marked};
use super::output::{remark, say};
use crate::engine::inputs::Inputs;
use crate::engine::output::OutputFolder;
use crate::report::catalogue::{Shape, catalogue};
use crate::report::panel::{Panel, stacked_with_notes};
use crate::report::plot::{BLUE, DARK, DARK_RED, Dash, GREY, Marker, ORANGE, RED, Series};
use crate::study::nearest;

/// Density of the masses that are shown, kg/m³.
const STEEL: f64 = 7850.0;

/// What a name means.
fn meaning(name: &str) -> &'static str {
    let rail = STANDARD_RAILS.iter().find(|rail| rail.name == name).map(|rail| rail.description);
    rail.or_else(|| STANDARD_WHEELS.iter().find(|wheel| wheel.name == name).map(|wheel| wheel.description))
        .unwrap_or("standard profile")
}

/// Whether a description says that something of a standard is not sure.
fn is_unsure(description: &str) -> bool {
    ["weakly checked", "assumed", "not known"].iter().any(|words| description.contains(words))
}

/// Prints the standards, and draws them all to one scale.
pub(super) fn list(figure: Option<&Path>) -> Result<(), Error> {
    for name in RAIL_NAMES.iter().chain(&WHEEL_NAMES) {
        say(&format!("{name:14} {}", meaning(name)))?;
    }
    let rails: Vec<&str> = CATALOGUE_RAILS.iter().map(|rail| rail.name).collect();
    say(&format!(
        "rail bodies    {}: drawn from six dimensions, for `rail.body` in a study",
        rails.join(", ")
    ))?;
    say(
        "wheel bodies   straight-web, s-web, conical-web: generic, with bore, hub and rim to be set in a study",
    )?;
    match figure {
        Some(path) => write(path, &every_standard()?, &Inputs::none()),
        None => Ok(()),
    }
}

/// Figure of all standards.
fn every_standard() -> Result<String, Error> {
    /// Rails and wheels in a row.
    const COLUMNS: [usize; 2] = [5, 4];
    let round = |value: f64| (100.0 * value).round() / 100.0;
    let in_mm = |p: &Point2<f64>| (p.x / MILLIMETRE, p.y / MILLIMETRE);
    let shape = |name: &str, note: String, points: Vec<(f64, f64)>| Shape {
        name: name.into(),
        note,
        marked: is_unsure(meaning(name)),
        points,
    };
    let rail = |name: &&str| -> Result<Shape, Error> {
        let section = rail_section(name)?;
        let mut outline = section.running.sample(0.5 * MILLIMETRE);
        outline.extend(&section.body[1..]);
        let note =
            format!("{:.2} kg/m, {} mm high", section.area.area * STEEL, round(section.height / MILLIMETRE));
        Ok(shape(name, note, outline.iter().map(in_mm).collect()))
    };
    let wheel = |name: &&str| -> Result<Shape, Error> {
        let points = wheel_profile(name)?.sample(0.5 * MILLIMETRE);
        let tip = points.iter().map(|p| p.y).fold(0.0, f64::max);
        let note = format!("flange {} mm high", round(tip / MILLIMETRE));
        Ok(shape(name, note, points.iter().map(in_mm).collect()))
    };
    let groups = [
        (COLUMNS[0], RAIL_NAMES.iter().map(rail).collect::<Result<Vec<_>, _>>()?),
        (COLUMNS[1], WHEEL_NAMES.iter().map(wheel).collect::<Result<Vec<_>, _>>()?),
    ];
    Ok(catalogue(920, &groups, "* something of it is not sure: see `railspring profile list`"))
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

/// That a text is neither one of the standards `names` nor a file; `key` says where it was given.
pub(super) fn unknown_profile(key: &str, profile: &str, names: &[&str]) -> InputError {
    let near = nearest(profile, names.iter().copied());
    let near = near.map(|name| format!("did you mean {name:?}? ")).unwrap_or_default();
    InputError::new(
        key,
        format!("{profile:?}"),
        format!("one of {}, or a profile file", names.join(", ")),
        format!("{near}see `railspring profile list`, or check the path"),
    )
}

/// A file as it was read, and prepared; what was found and repaired is said.
fn measured(profile: &str) -> Result<(MeasuredProfile, Prepared), Error> {
    let path = Path::new(profile);
    if !path.exists() {
        let names: Vec<&str> = RAIL_NAMES.iter().chain(&WHEEL_NAMES).copied().collect();
        return Err(unknown_profile("profile", profile, &names).into());
    }
    let measured = read(path, &ReadOptions::default())?;
    let prepared = prepare(&measured, &PrepareOptions::default())?;
    prepared.findings.iter().for_each(|finding| remark(&format!("{profile}: {finding}")));
    Ok((measured, prepared))
}

/// Prints the numbers of a profile.
pub(super) fn show(profile: &str) -> Result<(), Error> {
    let (running, section) = match standard(profile)? {
        Some(curve) if RAIL_NAMES.contains(&profile) => (curve, Some(rail_section(profile)?)),
        Some(curve) => (curve, None),
        None => {
            let (measured, prepared) = measured(profile)?;
            let outline = measured.drawn.as_ref().and_then(LinesAndArcs::rail_outline);
            if outline.is_some() {
                // what a section has to be, before its numbers are looked for
                let content = input::read(profile.as_ref(), LARGEST_FILE)
                    .map_err(|cause| InputError::new(profile, cause, "a readable file", "check the path"))?;
                sketch_section(profile, &content, ProfileKind::Rail, None).1?;
            }
            (prepared.curve, outline.map(|outline| rail_section_of(profile, outline)))
        }
    };
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
    if let Some(section) = section {
        let p = rail_properties(&section)?;
        let rows = [
            ("height", section.height * 1e3, "mm"),
            ("mass", p.area * STEEL, "kg/m, steel of 7850 kg/m³"),
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
    let inputs = Inputs::of(profiles);
    inputs.check(output)?;
    let mut listed = Listed::default();
    let mut curves = Vec::new();
    for profile in profiles {
        let (curve, marks) = match standard(profile)? {
            Some(curve) => (curve, Vec::new()),
            None => {
                let (measured, prepared) = measured(profile)?;
                let marks = marked(&measured, &prepared, &mut listed);
                (prepared.curve, marks)
            }
        };
        curves.push((profile.clone(), curve, marks));
    }
    write(output, &figure(curves, &listed), &inputs)?;
    say(&output.display().to_string())
}

/// Figure of a file with its findings.
pub(super) fn checked(measured: &MeasuredProfile, prepared: &Prepared) -> String {
    let mut listed = Listed::default();
    let marks = marked(measured, prepared, &mut listed);
    figure(vec![(measured.name.clone(), prepared.curve.clone(), marks)], &listed)
}

/// Figure of a line as its file draws it, with the places at which it is at fault.
pub(super) fn sketched(name: &str, sketch: &Sketch) -> String {
    /// Room between the line and the frame, of its extent: axes end with what they show.
    const CLEAR: f64 = 0.05;
    let at = |p: &Point2<f64>| (p.x / MILLIMETRE, p.y / MILLIMETRE);
    let line =
        |points: &Vec<Point2<f64>>| Series::line(name, points.iter().map(at).collect(), DARK, Dash::Solid);
    let mut series: Vec<Series> = sketch.strokes.iter().map(line).collect();
    let all = || sketch.strokes.iter().flatten().chain(sketch.faults.iter().map(|(place, _)| place));
    let first = all().next().copied().unwrap_or_default();
    let (low, high) = all().fold((first, first), |(a, b), p| (a.inf(p), b.sup(p)));
    let margin = CLEAR * (high - low);
    series.push(Series::line("", vec![at(&(low - margin)), at(&(high + margin))], DARK, Dash::None));
    let mut notes = Vec::new();
    for (n, (place, what)) in sketch.faults.iter().enumerate() {
        let (first, second) = at(place);
        notes.push(format!("[{}] {what}, at ({first:.3}, {second:.3}) mm {}", n + 1, sketch.axes));
        let mark = Series::marks("fault", vec![at(place)], DARK_RED, Marker::Triangle);
        series.push(mark.labelled(vec![(n + 1).to_string()]));
    }
    let label = |which: &str| format!("{which} coordinate (mm), {}", sketch.axes);
    let panel = Panel::new(&label("first"), &label("second"), series);
    stacked_with_notes(760, 560, &[panel], &notes)
}

/// Figure of curves, each with its name and the marks on it.
fn figure(curves: Vec<(String, ProfileCurve, Vec<Mark>)>, listed: &Listed) -> String {
    let (mut shapes, mut curvatures) = (Vec::new(), Vec::new());
    let mut found = Vec::new();
    for ((profile, curve, marks), (color, dash)) in curves.into_iter().zip(STYLES.iter().cycle().copied()) {
        let profile = profile.as_str();
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
    let panel = |y_label: &str, series| Panel::new("y to the field side (mm)", y_label, series);
    let panels = [panel("height \u{2212}z (mm)", shapes), panel("curvature (1/mm)", curvatures)];
    stacked_with_notes(760, 320, &panels, &listed.notes)
}

/// Writes a file, which is none of the `inputs`; one of that name is replaced only when the new one is complete.
pub(super) fn write(path: &Path, text: &str, inputs: &Inputs) -> Result<(), Error> {
    let (folder, name) = OutputFolder::of_file("output", path, inputs)?;
    folder.write(&name, text.as_bytes())
}
