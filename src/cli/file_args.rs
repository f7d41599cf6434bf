//! The arguments that say what is known about a profile file.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use railspring_profiles::error::{Error, InputError};
use railspring_profiles::field::InputField;
use railspring_profiles::profile_file::{
    Finding, MeasuredPoint, MeasuredProfile, PrepareOptions, Prepared, ProfileKind, ReadOptions, Smoothing,
    prepare, read,
};
use railspring_profiles::units::MILLIMETRE;

use crate::engine::inputs::Inputs;

/// A profile file and what is known about it.
#[derive(Debug, Args)]
pub(super) struct FileArgs {
    /// Profile file: Simpack .prr .prw, MiniProf .ban .whl, text or CSV, lines and arcs, .dxf, slices of CONTACT .slcs .slcw
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Part of the file that is the profile, where it has several: name or number of a slice or of a block of points, layer of a drawing
    #[arg(long, value_name = "NAME")]
    part: Option<String>,
    /// Wheel or rail, where the file does not tell
    #[arg(long)]
    kind: Option<KindArg>,
    /// Unit of the file, where it does not tell
    #[arg(long)]
    unit: Option<UnitArg>,
    /// Whether y counts towards the track centre in the file, as in that of a left rail or wheel
    #[arg(long, value_name = "BOOL")]
    mirror_y: Option<bool>,
    /// Whether z counts upwards in the file (not for Simpack files, lines and arcs)
    #[arg(long, value_name = "BOOL")]
    mirror_z: Option<bool>,
    /// Distance of a wheel's tape circle from its flange back, mm, where the file counts from there; 70 unless given
    #[arg(long, value_name = "MM", value_parser = tape_circle)]
    tape_circle_mm: Option<f64>,
    /// Smooth: halve waves of this length, mm; 0 leaves the points where they are. Without it their scatter is measured, and smoothed as much as it takes
    #[arg(long, value_name = "MM")]
    smooth_mm: Option<f64>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum KindArg {
    Rail,
    Wheel,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum UnitArg {
    #[value(name = "um")]
    Micrometre,
    #[value(name = "mm")]
    Millimetre,
    #[value(name = "cm")]
    Centimetre,
    #[value(name = "m")]
    Metre,
    #[value(name = "in")]
    Inch,
}

/// A distance of the tape circle from the flange back, mm, within the range of the study's key.
fn tape_circle(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(mm) if (50.0..=100.0).contains(&mm) => Ok(mm),
        _ => Err("expected a distance of 50 to 100 mm".into()),
    }
}

/// The options that give fields of the library: the one table for the commands on a profile file.
const OPTIONS: [(InputField, &str); 7] = [
    (InputField::ProfilePart, "--part"),
    (InputField::RailProfilePart, "--part"),
    (InputField::WheelProfilePart, "--part"),
    (InputField::ProfileUnit, "--unit"),
    (InputField::RailProfileUnit, "--unit"),
    (InputField::WheelProfileUnit, "--unit"),
    (InputField::ProfileKind, "--kind"),
];

/// The error with the options of these commands in the place of the library's fields.
pub(super) fn with_options(error: InputError) -> InputError {
    let translated = |text: &str| {
        let named = |text: String, (field, option): &(InputField, &str)| {
            text.replace(&format!("`{field}`"), &format!("`{option}`"))
        };
        OPTIONS.iter().fold(text.to_owned(), named)
    };
    InputError { expected: translated(&error.expected), remedy: translated(&error.remedy), ..error }
}

impl FileArgs {
    pub fn options(&self) -> ReadOptions {
        ReadOptions {
            kind: self.kind.map(|kind| match kind {
                KindArg::Rail => ProfileKind::Rail,
                KindArg::Wheel => ProfileKind::Wheel,
            }),
            unit: self.unit.map(|unit| match unit {
                UnitArg::Micrometre => 1e-6,
                UnitArg::Millimetre => MILLIMETRE,
                UnitArg::Centimetre => 1e-2,
                UnitArg::Metre => 1.0,
                UnitArg::Inch => 25.4 * MILLIMETRE,
            }),
            mirror_y: self.mirror_y,
            mirror_z: self.mirror_z,
            part: self.part.clone(),
            tape_circle: self.tape_circle_mm.map(|mm| mm * MILLIMETRE),
        }
    }

    /// The files that are read: the profile, of a list of slices with all of them.
    pub fn inputs(&self) -> Inputs {
        Inputs::of([&self.file])
    }

    pub fn read(&self) -> Result<MeasuredProfile, Error> {
        read(&self.file, &self.options())
    }

    /// The points for a file: repaired, and smoothed only if that was asked for, as whoever reads the file measures their scatter.
    pub fn points(&self, profile: &MeasuredProfile) -> Result<(Vec<MeasuredPoint>, Vec<Finding>), Error> {
        let wavelength = self.smooth_mm.unwrap_or(0.0) * MILLIMETRE;
        let prepared = prepare(profile, &PrepareOptions { smoothing: Smoothing::of(Some(wavelength)) })?;
        Ok((prepared.points, prepared.findings))
    }

    pub fn prepare(&self, profile: &MeasuredProfile) -> Result<Prepared, Error> {
        prepare(
            profile,
            &PrepareOptions { smoothing: Smoothing::of(self.smooth_mm.map(|mm| mm * MILLIMETRE)) },
        )
    }
}
