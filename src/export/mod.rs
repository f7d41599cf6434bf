//! The springs in the forms that other programs read.
//!
//! [`files`] turns a `stiffness.json` into the files of one format. Each begins with a comment: what it was made from, the
//! law and its range, units, and what it leaves out. Straight lines between points keep to the law within a stated error,
//! and nothing is extrapolated silently.

mod spring;
mod points;
mod columns;
mod opensees;
mod power;
mod deck;
mod surfaces;
mod gensys;
mod contact;

use std::path::Path;

use clap::ValueEnum;
use railspring_calibrate::error::{InputError, Result};

use crate::crosscheck::deck::Format as DeckFormat;
use crate::output::read_json;
use crate::records::{BY_ANGLE, StiffnessByAngleRecord, StiffnessRecord};
use crate::study::Study;
pub use spring::ExportFile;
use spring::Spring;
use surfaces::Surfaces;

/// What springs are exported to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Columns of displacement and force, in m and N and in mm and kN, for Simpack, VI-Rail and others
    ForceDisplacement,
    /// A spring without tension for OpenSees, in Python and Tcl
    Opensees,
    /// Coefficient and power of the contact of STEM (UVEC)
    Stem,
    /// Coefficient and power of the contact of ROSE
    Rose,
    /// Profiles for KPF and stiffness over the contact angle for GENSYS; with --study
    Gensys,
    /// Profiles and cases for the half-space program CONTACT; with --study
    Contact,
    /// A nonlinear spring as a deck for CalculiX
    Calculix,
    /// A nonlinear spring as a deck for Abaqus
    Abaqus,
    /// A structure of the law and its points for MATLAB and Octave
    Matlab,
    /// The law, its points and those of the solid model as JSON
    Json,
}

/// The files of a format from the `stiffness.json` at `path`: the law against `reference`, that of the study unless one is
/// named; `study` is the study of these springs, which [`Format::Gensys`] and [`Format::Contact`] take their profiles from.
///
/// # Errors
/// [`InputError`] for a file that is no `stiffness.json`, a reference that it does not have, a study that is missing or of
/// another pair, and laws by contact angle that are missing or of another pair.
pub fn files(
    path: &Path,
    format: Format,
    reference: Option<&str>,
    study: Option<&Study>,
) -> Result<Vec<ExportFile>> {
    let record: StiffnessRecord = read_json(path, "calibrate")?;
    if let Some(study) = study.filter(|study| study.keys.pair != record.pair.hash) {
        return Err(InputError::new(
            "--study",
            study.pair().name,
            format!("a study of the springs' own pair, {}", record.pair.name),
            "name the study that they were calibrated with, or calibrate this one",
        )
        .into());
    }
    let spring = Spring::of(&path.display().to_string(), &record, reference)?;
    Ok(match format {
        Format::ForceDisplacement => columns::force_displacement(&spring),
        Format::Opensees => opensees::files(&spring),
        Format::Stem => vec![power::stem(&spring)],
        Format::Rose => vec![power::rose(&spring)],
        Format::Gensys => {
            let surfaces = Surfaces::of(study, "GENSYS")?;
            gensys::files(&spring, &surfaces, &laws_beside(path, &record)?)?
        }
        Format::Contact => contact::files(&spring, &Surfaces::of(study, "CONTACT")?)?,
        Format::Calculix => vec![deck::file(&spring, DeckFormat::Calculix)],
        Format::Abaqus => vec![deck::file(&spring, DeckFormat::Abaqus)],
        Format::Matlab => vec![columns::matlab(&spring)],
        Format::Json => vec![columns::as_json(&spring)],
    })
}

/// The laws by contact angle beside a `stiffness.json`, of the same pair.
fn laws_beside(path: &Path, record: &StiffnessRecord) -> Result<StiffnessByAngleRecord> {
    let beside = path.with_file_name(BY_ANGLE);
    let laws: StiffnessByAngleRecord = read_json(&beside, "calibrate")?;
    if laws.pair.hash == record.pair.hash {
        return Ok(laws);
    }
    Err(InputError::new(
        format!("{}: pair", beside.display()),
        laws.pair.name,
        format!("the pair of {}, {}", path.display(), record.pair.name),
        "calibrate again, so that both files are of one pair",
    )
    .into())
}
