//! The forms that springs are written in, and the files of each.

use clap::ValueEnum;
use railspring_calibrate::law::Form;
use railspring_profiles::error::{InputError, Result};

use super::spring::{ExportFile, Spring};
use super::surfaces::Surfaces;
use super::{columns, contact, deck, gensys, opensees, power};
use crate::results::by_angle::record::ShiftRecord;
use crate::results::crosscheck::deck::Format as DeckFormat;
use crate::study::Study;

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
    /// A table of force over displacement for Modelica (`CombiTable1Ds`)
    Modelica,
    /// The law, its points and those of the solid model as JSON
    Json,
    /// The lumped element with a load case as a model of Exudyn; with --study
    LumpedExudyn,
    /// The lumped element with a load case as a model of OpenSees; with --study
    LumpedOpensees,
    /// The lumped element with a load case as a model of STEM, the wheel as its vehicle (UVEC); with --study
    LumpedStem,
    /// Wheel, bushing and constants of the lumped element for Simpack; with --study
    LumpedSimpack,
    /// Constants of the lumped element and modes of its wheel for GENSYS; with --study
    LumpedGensys,
}

/// The form of the law that is exported.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LawForm {
    /// a + b·(f/f0)^c, the published form
    Power,
    /// A power and a linear spring in series
    Series,
    /// Two powers with a step of the stiffness between
    Steps,
    /// The tangents of the solid model themselves
    Table,
}

impl From<LawForm> for Form {
    fn from(form: LawForm) -> Self {
        match form {
            LawForm::Power => Self::Power,
            LawForm::Series => Self::Series,
            LawForm::Steps => Self::Steps,
            LawForm::Table => Self::Table,
        }
    }
}

impl Format {
    /// Whether it is the lumped element, and not one law.
    pub fn is_lumped(self) -> bool {
        self.is_model() || matches!(self, Self::LumpedSimpack | Self::LumpedGensys)
    }

    /// Whether it is a model of the lumped element with a load case.
    pub fn is_model(self) -> bool {
        matches!(self, Self::LumpedExudyn | Self::LumpedOpensees | Self::LumpedStem)
    }

    /// Whether it is a model that can have points in the place of strips.
    pub fn has_points(self) -> bool {
        matches!(self, Self::LumpedExudyn | Self::LumpedStem)
    }

    /// Its name on the command line.
    fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().into())
    }

    /// The form of the law where none is named: a power for what takes nothing else, else the table, which has the solid model's own tangents.
    pub fn usual_form(self) -> Form {
        match self {
            Self::Stem | Self::Rose => Form::Power,
            _ => Form::Table,
        }
    }
}

/// The files of a format of one law; `by_angle` has the laws by contact angle. Those of the lumped element are not made from one law.
pub(super) fn files(
    spring: &Spring,
    format: Format,
    study: Option<&Study>,
    by_angle: impl FnOnce() -> Result<Vec<ShiftRecord>>,
) -> Result<Vec<ExportFile>> {
    Ok(match format {
        Format::ForceDisplacement => columns::force_displacement(spring),
        Format::Opensees => opensees::files(spring),
        Format::Stem => vec![power::stem(spring)],
        Format::Rose => vec![power::rose(spring)],
        Format::Gensys => {
            let surfaces = Surfaces::of(study, "GENSYS wants the profiles")?;
            gensys::files(spring, &surfaces, &by_angle()?)?
        }
        Format::Contact => contact::files(spring, &Surfaces::of(study, "CONTACT wants the profiles")?)?,
        Format::Calculix => vec![deck::file(spring, DeckFormat::Calculix)],
        Format::Abaqus => vec![deck::file(spring, DeckFormat::Abaqus)],
        Format::Matlab => vec![columns::matlab(spring)],
        Format::Modelica => vec![columns::modelica(spring)],
        Format::Json => vec![columns::as_json(spring)],
        Format::LumpedExudyn
        | Format::LumpedOpensees
        | Format::LumpedStem
        | Format::LumpedSimpack
        | Format::LumpedGensys => {
            return InputError::refuse(
                "--to",
                format.name(),
                "springs of a study with its laws by contact angle",
                "export from the stiffness.json of that study",
            );
        }
    })
}
