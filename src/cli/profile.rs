//! The subcommands on profiles.

use std::path::{Path, PathBuf};

use clap::Subcommand;
use railspring_profiles::error::{Error, InputError};
use railspring_profiles::input;
use railspring_profiles::profile_file::{
    Action, LARGEST_FILE, MeasuredProfile, Prepared, Sketch, format_of_ending, read_sketched, sketch_section,
    write,
};
use railspring_profiles::profile_placement::{say_nearest, with_nearest_to};
use railspring_profiles::units::MILLIMETRE;

use super::contact::{ContactArgs, contact};
use super::failure::Failure;
use super::file_args::{FileArgs, with_options};
use super::output::say;
use super::place::{PlaceArgs, place};
use super::shapes;
use crate::engine::inputs::Inputs;

/// What can be done with a profile.
#[derive(Debug, Subcommand)]
pub(super) enum ProfileCommand {
    /// Check a profile file: what is wrong with it, and what can be repaired
    ///
    /// Exit code 1 if something is left that could not be repaired.
    Check {
        #[command(flatten)]
        file: FileArgs,
        /// The file is the closed section of a body, as of `section_file` in a study
        #[arg(long)]
        section: bool,
        /// Figure to write: the profile with its findings, or a section or the line of a table or drawing with the places at which it is at fault
        #[arg(long, value_name = "SVG")]
        figure: Option<PathBuf>,
    },
    /// Write a profile file in another format, by its extension: .prr .prw .ban .whl .txt .dat .csv .dxf
    Convert {
        #[command(flatten)]
        file: FileArgs,
        /// File to write
        #[arg(value_name = "OUT")]
        out: PathBuf,
        /// Write the points as they were read, without repair
        #[arg(long, conflicts_with = "smooth_mm")]
        raw: bool,
    },
    /// Lay a measured profile onto its standard, tell how sure its place is, and read off what is worn
    ///
    /// Without a standard the nearest ones are listed. Exit code 1 if the place is not determined or something else is left to
    /// be looked at.
    Place(PlaceArgs),
    /// List the standard rails and wheels
    List {
        /// Figure of all of them to write
        #[arg(long, value_name = "SVG")]
        figure: Option<PathBuf>,
    },
    /// Print the numbers of a standard profile or of a profile file
    Show {
        /// Name of a standard, or a file
        #[arg(value_name = "PROFILE")]
        profile: String,
    },
    /// Draw profiles and their curvature
    Plot {
        /// Names of standards, or files
        #[arg(value_name = "PROFILE", required = true)]
        profiles: Vec<String>,
        /// Figure to write
        #[arg(short, long, value_name = "SVG", default_value = "profile.svg")]
        output: PathBuf,
    },
    /// Find the contact points over the lateral shift, the rolling-radius difference and the equivalent conicity
    Contact(ContactArgs),
}

/// Runs a subcommand; whether the profile is fit for use.
///
/// # Errors
/// Files that cannot be read, understood or written.
pub(super) fn run(command: &ProfileCommand) -> Result<bool, Failure> {
    match command {
        ProfileCommand::List { figure } => Ok(shapes::list(figure.as_deref()).map(|()| true)?),
        ProfileCommand::Show { profile } => Ok(shapes::show(profile).map(|()| true)?),
        ProfileCommand::Plot { profiles, output } => Ok(shapes::plot(profiles, output).map(|()| true)?),
        ProfileCommand::Contact(args) => contact(args).map(|()| true),
        ProfileCommand::Place(args) => place(args).map_err(by_options),
        ProfileCommand::Check { file, section: false, figure } => {
            check(file, figure.as_deref()).map_err(Failure::from).map_err(by_options)
        }
        ProfileCommand::Check { file, section: true, figure } => {
            section(file, figure.as_deref()).map_err(Failure::from).map_err(by_options)
        }
        ProfileCommand::Convert { file, out, raw } => {
            convert(file, out, *raw).map_err(Failure::from).map_err(by_options)
        }
    }
}

/// What is wrong with a profile file, by the options of these commands.
fn by_options(failure: Failure) -> Failure {
    match failure {
        Failure::Plain(Error::Input(error)) => Failure::Plain(with_options(error).into()),
        other => other,
    }
}

/// Checks the closed section of a body; a figure is written of one that is at fault as well.
fn section(file: &FileArgs, figure: Option<&Path>) -> Result<bool, Error> {
    let name = file.file.display().to_string();
    let kind = file
        .options()
        .kind
        .ok_or_else(|| InputError::new("--kind", "(missing)", "rail or wheel", "say whose section it is"))?;
    let inputs = checked_inputs(file, figure)?;
    let content = input::read(&file.file, LARGEST_FILE)
        .map_err(|cause| InputError::new(&name, cause, "a readable file of a section", "check the path"))?;
    let (sketch, section) = sketch_section(&name, &content, kind, file.options().tape_circle);
    draw(&name, &sketch, figure, &inputs)?;
    let mut section = section.map_err(|error| with_nearest_to(&sketch, kind, error))?;
    say_nearest(&mut section);
    let count = section.count;
    say(&format!(
        "{name}: {}, closed section of a {}, {count} points or segments",
        section.format,
        kind.name()
    ))?;
    section.findings.iter().try_for_each(|finding| say(&finding.to_string()))?;
    Ok(section.findings.iter().all(|finding| finding.action != Action::Left))
}

/// Writes the figure of a line as it is drawn, if it is wanted and there is one.
fn draw(name: &str, sketch: &Sketch, figure: Option<&Path>, inputs: &Inputs) -> Result<(), Error> {
    match figure.filter(|_| !sketch.strokes.is_empty()) {
        Some(figure) => {
            shapes::write(figure, &shapes::sketched(name, sketch), inputs)?;
            say(&figure.display().to_string())
        }
        None => Ok(()),
    }
}

/// The files that are read, none of which is the file that is to be written.
fn checked_inputs(file: &FileArgs, output: Option<&Path>) -> Result<Inputs, Error> {
    let inputs = file.inputs();
    output.map_or(Ok(()), |output| inputs.check(output))?;
    Ok(inputs)
}

fn check(file: &FileArgs, figure: Option<&Path>) -> Result<bool, Error> {
    let inputs = checked_inputs(file, figure)?;
    let (sketch, profile) = read_sketched(&file.file, &file.options());
    if profile.is_err() {
        draw(&file.file.display().to_string(), &sketch, figure, &inputs)?;
    }
    let profile = profile?;
    let prepared = file.prepare(&profile)?;
    if let Some(figure) = figure {
        shapes::write(figure, &shapes::checked(&profile, &prepared), &inputs)?;
    }
    say_profile(&profile, &prepared)?;
    for finding in &prepared.findings {
        say(&finding.to_string())?;
    }
    let left = prepared.findings.iter().filter(|finding| finding.action == Action::Left).count();
    if left > 0 {
        say(&format!("{left} findings are unresolved"))?;
    }
    Ok(left == 0)
}

fn say_profile(profile: &MeasuredProfile, prepared: &Prepared) -> Result<(), Error> {
    let (first, last) = (prepared.curve.point(0.0), prepared.curve.point(prepared.curve.length()));
    let place = |p: nalgebra::Point2<f64>| format!("({:.3}, {:.3})", p.x / MILLIMETRE, p.y / MILLIMETRE);
    say(&format!(
        "{}: {}, {}, {} points ({} in the curve), from (y, z) = {} mm to {} mm, {:.3} mm along the profile",
        profile.name,
        profile.format,
        profile.kind.name(),
        profile.points.len(),
        prepared.points.len(),
        place(first),
        place(last),
        prepared.curve.length() / MILLIMETRE,
    ))
}

fn convert(file: &FileArgs, out: &Path, raw: bool) -> Result<bool, Error> {
    let inputs = checked_inputs(file, Some(out))?;
    let (format, kind) = format_of_ending(out)?;
    let profile = file.read()?;
    if let Some(kind) = kind.filter(|kind| *kind != profile.kind) {
        return Err(InputError::new(
            out.display().to_string(),
            format!("the extension of a {}", kind.name()),
            format!("the extension of a {}", profile.kind.name()),
            "choose another extension, or say with --kind what the profile is",
        )
        .into());
    }
    let (points, findings) =
        if raw { (profile.points.clone(), profile.findings.clone()) } else { file.points(&profile)? };
    let source = file.file.file_name().unwrap_or_default().to_string_lossy();
    let text = write(format, profile.kind, &points, &format!("converted from {source}"));
    shapes::write(out, &text, &inputs)?;
    findings.iter().try_for_each(|finding| say(&finding.to_string()))?;
    Ok(findings.iter().all(|finding| finding.action != Action::Left))
}
