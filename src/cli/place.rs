//! The subcommand `profile place`: a measured profile laid onto its standard.

use std::path::PathBuf;

use clap::Args;
use nalgebra::Point2;
use railspring_profiles::error::{Error, InputError};
use railspring_profiles::placement::{TrackGeometry, place_rail};
use railspring_profiles::profile_file::{
    Action, MeasuredProfile, Prepared, ProfileFormat, ProfileKind, ReadOptions, read, repaired,
    write as profile_text,
};
use railspring_profiles::profile_placement::{
    PlaceOptions, Placed, Reference, deepest_wear, in_words, nearest, place_profile, rail_wear, resembled,
    wheel_wear,
};
use railspring_profiles::rigid_contact::{Roll, RunningFunction, WheelOnRail, Wheelset};
use railspring_profiles::section::{
    rail_section, rail_section_with_head, wheel_section, wheel_section_with_profile,
};
use railspring_profiles::units::MILLIMETRE;

use super::failure::Failure;
use super::file_args::FileArgs;
use super::output::say;
use super::shapes::write;
use crate::results::bodies::on_standard::{Seams, on_standard};
use crate::results::bodies::surface_figure::figure;

/// Diameter of the wheel at the tape circle, m.
const TAPE_DIAMETER: f64 = 0.92;
/// The new pair against which a worn profile runs.
const NEW_RAIL: &str = "60E1";
const NEW_WHEEL: &str = "S1002";
/// Width of the figure, px.
const WIDTH: u32 = 860;
/// Amplitude of the equivalent conicity, m.
const AMPLITUDE: f64 = 3.0 * MILLIMETRE;

/// Which profile, on which standard.
#[derive(Debug, Args)]
pub(super) struct PlaceArgs {
    #[command(flatten)]
    file: FileArgs,
    /// Standard rail or wheel; left out, the nearest ones are listed and the profile is placed on the first
    #[arg(long, value_name = "NAME")]
    standard: Option<String>,
    /// Folder to write <FILE>-placed.csv and <FILE>-placed.svg to
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    output: PathBuf,
}

/// Runs the subcommand; whether the place is determined and nothing else is left to be looked at.
pub(super) fn place(args: &PlaceArgs) -> Result<bool, Failure> {
    let inputs = args.file.inputs();
    let file = |ending: &str| {
        let stem = args.file.file.file_stem().unwrap_or_default().to_string_lossy();
        args.output.join(format!("{stem}-placed.{ending}"))
    };
    ["csv", "svg"].iter().try_for_each(|ending| inputs.check(&file(ending)))?;
    let options = args.file.options();
    let place_options = PlaceOptions { side_known: options.mirror_y.is_some() };
    let (profile, reference) = match &args.standard {
        Some(name) => {
            let reference = Reference::standard(name)
                .map_err(|error| with_nearest(args, &options, place_options, error))?;
            let kind = options.kind.or(Some(reference.kind));
            (read(&args.file.file, &ReadOptions { kind, ..options })?, reference)
        }
        None => nearest_standard(args, &options, place_options)?,
    };
    let (moved, placed) = place_profile(&profile, &reference, place_options)?;
    let prepared = args.file.prepare(&moved)?;
    for finding in &prepared.findings {
        say(&finding.to_string())?;
    }
    for line in worn(&placed, &prepared, &reference)? {
        say(&line)?;
    }
    let source = args.file.file.file_name().unwrap_or_default().to_string_lossy();
    let (points, _) = args.file.points(&moved)?;
    let comment = format!("{source} placed on {}", reference.name);
    write(&file("csv"), &profile_text(ProfileFormat::Csv, moved.kind, &points, &comment), &inputs)?;
    write(&file("svg"), &picture(&source, &moved, &prepared, &placed, &reference)?, &inputs)?;
    say(&format!("{}\n{}", file("csv").display(), file("svg").display()))?;
    Ok(prepared.findings.iter().all(|finding| finding.action != Action::Left))
}

/// The message about an unknown standard, with the standards that the profile resembles.
fn with_nearest(args: &PlaceArgs, options: &ReadOptions, place_options: PlaceOptions, error: Error) -> Error {
    let Ok(profile) = read(&args.file.file, options) else { return error };
    let near = resembled(&profile, options.kind, place_options);
    match error {
        Error::Input(error) if !near.is_empty() => {
            let remedy = format!("{}; nearest to the profile are {}", error.remedy, in_words(&near));
            InputError { remedy, ..error }.into()
        }
        error => error,
    }
}

/// The profile, and the standard that fits it best; the nearest ones are listed.
fn nearest_standard(
    args: &PlaceArgs,
    options: &ReadOptions,
    place_options: PlaceOptions,
) -> Result<(MeasuredProfile, Reference), Failure> {
    /// Standards that are listed.
    const LISTED: usize = 5;
    // Nothing but the order of its points depends on what the reader takes the profile for.
    let profile = read(&args.file.file, options).or_else(|_| {
        read(&args.file.file, &ReadOptions { kind: Some(ProfileKind::Rail), ..options.clone() })
    })?;
    let points: Vec<Point2<f64>> = repaired(&profile, &mut Vec::new())?.iter().map(|p| p.point).collect();
    let found = nearest(&points, options.kind, place_options.of(&profile))?;
    say("standard       RMS off what wear leaves alone mm   worn or unlike %")?;
    for misfit in found.iter().take(LISTED) {
        let unlike = if misfit.placed.fits() { "" } else { "   another shape" };
        let rms = misfit.rms.map_or_else(|| "-".into(), |rms| format!("{:.4}", rms / MILLIMETRE));
        let size = misfit.placed.size;
        let size =
            if size.is_one() { String::new() } else { format!("   {:.4} times as large", size.factor) };
        say(&format!("{:14} {rms:>33} {:18.1}{unlike}{size}", misfit.name, 100.0 * misfit.share))?;
    }
    let Some(first) = found.first() else {
        let remedy =
            "give the standard that it belongs to with --standard, and see `railspring profile plot`";
        let error = InputError::new(&profile.name, "no known shape", "a rail or a wheel", remedy);
        return Err(error.into());
    };
    Ok((profile, Reference::standard(first.name)?))
}

/// What is read off the placed profile.
fn worn(placed: &Placed, prepared: &Prepared, reference: &Reference) -> Result<Vec<String>, Error> {
    let line = |what: &str, value: Option<f64>| match value {
        Some(value) => format!("{what:64} {:8.3} mm", value / MILLIMETRE),
        None => format!("{what:64}        - not measured"),
    };
    let mut lines = match reference.kind {
        ProfileKind::Rail => {
            let wear = rail_wear(&prepared.curve, reference);
            vec![
                line("vertical wear on the axis", wear.vertical),
                line("lateral wear of the gauge face 14 mm below the new top", wear.lateral),
                line("deepest wear across the surface", Some(deepest_wear(placed, reference))),
            ]
        }
        ProfileKind::Wheel => {
            let wear = wheel_wear(&prepared.curve, reference);
            vec![
                line("flange height Sh, tip against the tape circle", wear.flange_height),
                line("flange thickness Sd, 10 mm below the tape circle", wear.flange_thickness),
                line("qR, from there to 2 mm above the tip", wear.flange_slope),
                line("radius missing at the tape circle", wear.tread),
                line("hollow of the tread", wear.hollow),
                line("deepest wear across the surface", Some(deepest_wear(placed, reference))),
            ]
        }
    };
    let against = if reference.kind == ProfileKind::Rail { NEW_WHEEL } else { NEW_RAIL };
    let what = format!("equivalent conicity at 3 mm against {against}, rails 1:40");
    let both = rayon::join(|| conicity(Some(prepared), reference), || conicity(None, reference));
    lines.push(match both {
        (Ok(Some(worn)), Ok(Some(new))) => format!("{what:64} {worn:8.4}    (new {new:.4})"),
        (Ok(Some(worn)), _) => format!("{what:64} {worn:8.4}"),
        (Ok(None), _) => format!("{what:64}        - the wheelset does not swing freely so far"),
        (Err(Error::Input(error)), _) => format!("{what:64}        - {} = {}", error.key, error.value),
        (Err(other), _) => return Err(other),
    });
    Ok(lines)
}

/// Equivalent conicity of two equal sides, one body new and the other as prepared or its standard.
fn conicity(prepared: Option<&Prepared>, reference: &Reference) -> Result<Option<f64>, Error> {
    const RANGE: f64 = 8.0 * MILLIMETRE;
    const STEP: f64 = 0.1 * MILLIMETRE;
    let mut ignored = Vec::new();
    let own = reference.name.as_str();
    let (rail, wheel) = match reference.kind {
        ProfileKind::Rail => (own, NEW_WHEEL),
        ProfileKind::Wheel => (NEW_RAIL, own),
    };
    let (rail, wheel) = (rail_section(rail)?, wheel_section(wheel, TAPE_DIAMETER)?);
    let (rail, wheel) = match (prepared, reference.kind) {
        (None, _) => (rail, wheel),
        (Some(head), ProfileKind::Rail) => (rail_section_with_head(rail, &head.curve, &mut ignored)?, wheel),
        (Some(profile), ProfileKind::Wheel) => {
            (rail, wheel_section_with_profile(wheel, &profile.curve, &mut ignored)?)
        }
    };
    let track = TrackGeometry::standard();
    let tape_y = track.tape_y(&wheel.running);
    let side =
        WheelOnRail { rail: place_rail(&rail, &track)?, wheel: wheel.running, radius: 0.5 * TAPE_DIAMETER };
    let wheelset = Wheelset::symmetric(side, tape_y);
    let function = RunningFunction::of(&wheelset, [-RANGE, RANGE], STEP, Roll::Coupled)?;
    Ok(function.equivalent_conicity(AMPLITUDE))
}

/// The profile on its standard: joined to that as a study does it, where that is possible.
fn picture(
    file: &str,
    read: &MeasuredProfile,
    prepared: &Prepared,
    placed: &Placed,
    reference: &Reference,
) -> Result<String, Error> {
    let mut ignored = Vec::new();
    let both = (read, prepared);
    let on = |seams| on_standard(file, reference, both, seams, Some(placed));
    let surface = match reference.kind {
        ProfileKind::Rail => {
            let section =
                rail_section_with_head(rail_section(&reference.name)?, &prepared.curve, &mut ignored);
            on(section.as_ref().ok().and_then(Seams::of_rail))
        }
        ProfileKind::Wheel => {
            let standard = wheel_section(&reference.name, TAPE_DIAMETER)?;
            let section = wheel_section_with_profile(standard, &prepared.curve, &mut ignored);
            on(section.as_ref().ok().and_then(Seams::of_wheel))
        }
    };
    let findings = prepared.findings.iter().map(ToString::to_string);
    let notes: Vec<String> = std::iter::once(surface.changes()).chain(findings).collect();
    Ok(figure(WIDTH, &surface, &notes))
}
