//! The command that writes springs for other programs.

use std::path::{Path, PathBuf};

use clap::Args;
use railspring_profiles::error::{Error, InputError};
use railspring_profiles::input;

use super::failure::Failure;
use super::output::{remark, say};
use super::set_args::SetArgs;
use crate::engine::inputs::Inputs;
use crate::engine::output::OutputFolder;
use crate::export::{
    Condition, ExportFile, ExportRow, Format, INDEX_BEGIN, LawForm, LumpedContact, SpringsFile, Wanted,
    index, of_calibration, rows,
};
use crate::results::by_angle::record::BY_ANGLE;
use crate::results::springs::record::StiffnessRecord;
use crate::study::Study;
use crate::table::{Table, TableRecord};

/// What has become of the rows of a table.
const INDEX: &str = "rows.csv";
/// Largest list of an earlier export, bytes.
const LARGEST_LIST: u64 = 1 << 30;

/// What is exported, and to where.
#[derive(Debug, Args)]
pub(super) struct ExportArgs {
    /// The springs: a stiffness.json of `railspring calibrate`, or a table.json of `railspring table`
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The program or form
    #[arg(long = "to", value_name = "FORMAT")]
    format: Format,
    /// Of a table, the rows with that value in a column that says which place a row is of, for instance wheel=S1002; may be given several times.
    /// Left out, all rows
    #[arg(long = "where", value_name = "COLUMN=VALUE", value_parser = condition)]
    conditions: Vec<Condition>,
    /// What the law's displacement is measured against: beam, local, foot or half-spaces; left out, as in the study
    #[arg(long, value_name = "REFERENCE")]
    reference: Option<String>,
    /// The form of the law; left out, `table`, but `power` for stem and rose
    #[arg(long, value_name = "FORM")]
    law: Option<LawForm>,
    /// The load case of the study for a model (lumped-...); left out, its only one
    #[arg(long, value_name = "NAME")]
    case: Option<String>,
    /// The contact of a model; left out, strips
    #[arg(long, value_name = "CONTACT")]
    contact: Option<LumpedContact>,
    /// The study of the springs, or the table of the rows, for formats with profiles
    #[arg(long, value_name = "STUDY")]
    study: Option<PathBuf>,
    #[command(flatten)]
    set: SetArgs,
    /// Folder to write to, or for a single file its name; left out, the working folder. Several rows go each into a folder there
    #[arg(short, long, value_name = "PATH")]
    output: Option<PathBuf>,
}

impl ExportArgs {
    fn wanted(&self) -> Wanted<'_> {
        let Self { format, law, contact, .. } = *self;
        Wanted { format, law, contact, reference: self.reference.as_deref(), case: self.case.as_deref() }
    }

    /// The files that are read: the springs with the laws beside them, and those of the study or the table.
    fn inputs<'p>(&self, of_source: impl Iterator<Item = &'p Path>) -> Inputs {
        let beside = self.file.with_file_name(BY_ANGLE);
        let own = [self.file.clone(), beside];
        Inputs::of(own.into_iter().chain(of_source.map(Path::to_path_buf)))
    }
}

fn condition(text: &str) -> Result<Condition, String> {
    Condition::parse(text).map_err(|error| format!("expected {}; {}", error.expected, error.remedy))
}

/// Writes the files and says where they are; whether all rows that were wanted have files.
///
/// # Errors
/// Those of the study and of the format; a folder that cannot be written.
pub(super) fn export(args: &ExportArgs) -> Result<bool, Failure> {
    let refused = |option: &str, expected: &str, remedy: &str| {
        Err(InputError::new(option, "given", expected, remedy).into())
    };
    args.wanted().check()?;
    let set = args.set.settings();
    match SpringsFile::read(&args.file)? {
        SpringsFile::Calibration(_) if !args.conditions.is_empty() => {
            refused("--where", "a table.json, whose rows are chosen", "leave it out, or name a table.json")
        }
        SpringsFile::Calibration(record) => {
            if let (None, Some(setting)) = (&args.study, set.first()) {
                return refused(
                    setting.option(),
                    "a study whose keys are set",
                    "name the study with --study",
                );
            }
            of_study(args, &record)
        }
        SpringsFile::Table(_) if !set.is_empty() => {
            refused(set[0].option(), "the keys as they are in the table", "leave it out")
        }
        SpringsFile::Table(table) => of_table(args, &table),
    }
}

fn of_study(args: &ExportArgs, record: &StiffnessRecord) -> Result<bool, Failure> {
    let set = args.set.settings();
    let study = args.study.as_deref().map(|study| Study::read_with(study, set)).transpose()?;
    let files = of_calibration(&args.file, record, args.wanted(), study.as_ref())?;
    let inputs = args.inputs(study.iter().flat_map(|study| study.source.files()));
    Ok(write(&files, args.output.as_deref(), &inputs).map(|()| true)?)
}

fn of_table(args: &ExportArgs, table: &TableRecord<'static>) -> Result<bool, Failure> {
    let file = args.file.display().to_string();
    let rows = rows(&file, table, &args.conditions)?;
    let source = args.study.as_deref().map(Table::read).transpose()?;
    let inputs = args.inputs(source.iter().flat_map(|source| source.files.iter().map(PathBuf::as_path)));
    let files =
        |row: &ExportRow<'_>| row.files(args.format, args.reference.as_deref(), args.law, source.as_ref());
    if let [row] = &rows[..] {
        return Ok(write(&files(row)?, args.output.as_deref(), &inputs).map(|()| true)?);
    }
    let Some(output) = &args.output else {
        let expected = format!("a folder for {} rows", rows.len());
        let remedy = "name a folder, or choose one row with --where";
        return Err(InputError::new("-o", "(missing)", expected, remedy).into());
    };
    let (mut folder, mut first, mut entries) = (None, None, Vec::new());
    for row in rows {
        let made = match files(&row) {
            Ok(files) => {
                let folder = match &folder {
                    Some(folder) => folder,
                    None => folder.insert(opened(output, &inputs)?),
                };
                for file in &files {
                    folder.write(&format!("{}/{}", row.folder(), file.name), file.text.as_bytes())?;
                }
                Ok(files.into_iter().map(|file| file.name).collect())
            }
            Err(error) => {
                let reason = error.to_string();
                first.get_or_insert(error);
                Err(reason)
            }
        };
        entries.push((row, made));
    }
    let folder = match (folder, first) {
        (Some(folder), _) => folder,
        // all rows lack the same
        (None, first) => return Err(first.expect("a row that has no files has a reason").into()),
    };
    folder.write(INDEX, &index(&entries))?;
    say(&folder.file(INDEX).display().to_string())?;
    let without = entries.iter().filter(|(_, made)| made.is_err()).count();
    if without > 0 {
        remark(&format!("{without} of {} rows have no files; {INDEX} says why", entries.len()));
    }
    Ok(without == 0)
}

/// The folder of several rows, without the list of an earlier export: the list is written last, of what is there then. A file of that name
/// which is no such list stays, and the export is refused.
fn opened(output: &Path, inputs: &Inputs) -> Result<OutputFolder, Error> {
    let folder = OutputFolder::create(output, inputs)?;
    let list = folder.file(INDEX);
    if list.exists()
        && !input::read(&list, LARGEST_LIST).is_ok_and(|text| text.starts_with(INDEX_BEGIN.as_bytes()))
    {
        let expected = "no file of this name, or the list of an earlier export, which is replaced";
        return Err(InputError::new(
            list.display().to_string(),
            "another file",
            expected,
            "name another folder with -o, or move the file",
        )
        .into());
    }
    folder.remove(INDEX)?;
    Ok(folder)
}

fn write(files: &[ExportFile], output: Option<&Path>, inputs: &Inputs) -> Result<(), Error> {
    let output = output.unwrap_or(Path::new("."));
    let named = match (files, output.file_name()) {
        ([_], Some(name)) if !output.is_dir() && output.extension().is_some() => name.to_str(),
        _ => None,
    };
    let folder = match named {
        Some(_) => output.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new(".")),
        None => output,
    };
    if named.is_none()
        && !folder.is_dir()
        && files.iter().any(|f| Path::new(&f.name).extension() == output.extension())
    {
        let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
        let expected = format!("a folder: there are {} files, {}", files.len(), names.join(", "));
        return Err(InputError::new("-o", output.display(), expected, "name a folder").into());
    }
    let folder = OutputFolder::create(folder, inputs)?;
    for file in files {
        let name = named.unwrap_or(&file.name);
        folder.write(name, file.text.as_bytes())?;
        say(&folder.file(name).display().to_string())?;
    }
    Ok(())
}
