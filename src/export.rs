//! The springs in the forms that other programs read.
//!
//! [`of_calibration`] turns a `stiffness.json` into the files of one format, [`ExportRow::files`] a row of a `table.json`. Each begins with a
//! comment: what it was made from, the law and its range, units, and what it leaves out. Straight lines between points keep to the law
//! within a stated error, and nothing is extrapolated silently.

mod spring;
mod points;
mod columns;
mod opensees;
mod power;
mod deck;
mod surfaces;
mod gensys;
mod contact;
mod lumped;
mod format;
mod element;
mod unit;
mod table_rows;

use std::path::Path;

use format::files;
use lumped::{LumpedCase, LumpedPair};
use railspring_calibrate::law::Form;
use railspring_profiles::error::{InputError, Result};
use serde::Deserialize;
use serde::de::{DeserializeOwned, IgnoredAny};
use spring::Spring;

use crate::engine::output::{parse_json, read_text};
use crate::engine::seal::Sealed;
use crate::results::by_angle::record::{BY_ANGLE, StiffnessByAngleRecord};
use crate::results::springs::record::StiffnessRecord;
use crate::study::Study;
use crate::table::TableRecord;

pub use element::element;
pub use format::{Format, LawForm};
pub use lumped::LumpedContact;
pub use spring::ExportFile;
pub use table_rows::{Condition, ExportRow, INDEX_BEGIN, index, rows};
pub use unit::{c_files, functional_mock_up_unit};

/// What springs are read from.
#[derive(Debug)]
pub enum SpringsFile {
    /// A `stiffness.json`.
    Calibration(Box<StiffnessRecord>),
    /// A `table.json`.
    Table(Box<TableRecord<'static>>),
}

impl SpringsFile {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// [`InputError`] for a file that is neither of them, or is not as it was written.
    pub fn read(path: &Path) -> Result<Self> {
        /// What a table has and a calibration does not.
        #[derive(Deserialize)]
        struct Which {
            #[serde(default)]
            cases: Option<IgnoredAny>,
        }
        let text = read_text(path, "calibrate` or `railspring table")?;
        let table = serde_json::from_str::<Which>(&text).is_ok_and(|which| which.cases.is_some());
        Ok(match table {
            true => Self::Table(Box::new(as_written(path, &text, "table")?)),
            false => Self::Calibration(Box::new(as_written(path, &text, "calibrate")?)),
        })
    }
}

/// A record of a file that is as it was written.
fn as_written<T: Sealed + DeserializeOwned>(path: &Path, text: &str, made_by: &str) -> Result<T> {
    let record: T = parse_json(path, text, made_by)?;
    record.check_as_written(path, made_by)?;
    Ok(record)
}

/// What is wanted of springs.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'a> {
    /// The program or form.
    pub format: Format,
    /// What the law's displacement is measured against: that of the study unless one is named.
    pub reference: Option<&'a str>,
    /// The form of the law: that of the format unless one is named.
    pub law: Option<LawForm>,
    /// The load case of a model.
    pub case: Option<&'a str>,
    /// The contact of a model: strips unless it is named.
    pub contact: Option<LumpedContact>,
}

impl Wanted<'_> {
    /// Whether all that was named is for the format.
    ///
    /// # Errors
    /// [`InputError`] with the option.
    pub fn check(&self) -> Result<()> {
        let refuse = |option: &str, value: String, expected: &str| {
            InputError::refuse(option, value, expected, "leave it out, or name another format with --to")
        };
        if self.format.is_lumped() {
            if let Some(reference) = self.reference {
                return refuse("--reference", format!("{reference:?}"), "a format with one law");
            }
            if let Some(law) = self.law {
                return refuse("--law", Form::from(law).name().into(), "a format with one law");
            }
        }
        if let (Some(LumpedContact::Points), false) = (self.contact, self.format.has_points()) {
            return refuse(
                "--contact",
                "points".into(),
                "a model that can have them: lumped-exudyn or lumped-stem",
            );
        }
        if let (Some(case), false) = (self.case, self.format.is_model()) {
            return refuse(
                "--case",
                format!("{case:?}"),
                "a model that runs: lumped-exudyn, lumped-opensees or lumped-stem",
            );
        }
        Ok(())
    }
}

/// The files of a format from the `stiffness.json` at `path`; `study` is the study of these springs, which [`Format::Gensys`], [`Format::Contact`] and models take their profiles from.
///
/// # Errors
/// [`InputError`] for a reference that the file does not have, a study that is missing or of another pair, laws by contact angle that
/// are missing or of another pair, and a load case that a model cannot have.
pub fn of_calibration(
    path: &Path,
    record: &StiffnessRecord,
    wanted: Wanted<'_>,
    study: Option<&Study>,
) -> Result<Vec<ExportFile>> {
    if let Some(study) = study.filter(|study| study.statics().pair_key() != record.pair.hash) {
        return Err(InputError::new(
            "--study",
            study.statics().pair().name,
            format!("a study of the springs' own pair, {}", record.pair.name),
            "name the study that they were calibrated with, or calibrate this one",
        )
        .into());
    }
    if wanted.format.is_lumped() {
        let what = if wanted.format.is_model() {
            "a model wants its load case"
        } else {
            "the wheel wants its place"
        };
        let pair = LumpedPair::of(study, what, record, &laws_beside(path, record)?)?;
        return match wanted.format {
            Format::LumpedSimpack => Ok(lumped::simpack(&pair)),
            Format::LumpedGensys => lumped::gensys(&pair),
            format => {
                let case = LumpedCase::of(pair, wanted.case, wanted.contact.unwrap_or_default(), record)?;
                match format {
                    Format::LumpedOpensees => lumped::opensees(&case),
                    Format::LumpedStem => lumped::stem(&case),
                    _ => Ok(lumped::exudyn(&case)),
                }
            }
        };
    }
    let form = wanted.law.map_or(wanted.format.usual_form(), Form::from);
    let spring = Spring::of_calibration(&path.display().to_string(), record, wanted.reference, form)?;
    files(&spring, wanted.format, study, || Ok(laws_beside(path, record)?.shifts))
}

/// The laws by contact angle beside a `stiffness.json`, of the same pair.
fn laws_beside(path: &Path, record: &StiffnessRecord) -> Result<StiffnessByAngleRecord> {
    let beside = path.with_file_name(BY_ANGLE);
    let laws: StiffnessByAngleRecord = as_written(&beside, &read_text(&beside, "calibrate")?, "calibrate")?;
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
