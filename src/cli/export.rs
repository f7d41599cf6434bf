//! The command that writes springs for other programs.

use std::path::{Path, PathBuf};

use clap::Args;
use railspring_calibrate::error::{Error, InputError};

use super::set_args::SetArgs;
use super::{Failure, say};
use crate::export::{ExportFile, Format, files};
use crate::output::OutputFolder;
use crate::study::Study;

/// What is exported, and to where.
#[derive(Debug, Args)]
pub(super) struct ExportArgs {
    /// The springs, a stiffness.json of `railspring calibrate`
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The program or form
    #[arg(long = "to", value_name = "FORMAT")]
    format: Format,
    /// What the law's displacement is measured against: beam, local or foot; left out, as in the study
    #[arg(long, value_name = "REFERENCE")]
    reference: Option<String>,
    /// The study of the springs, for formats with profiles
    #[arg(long, value_name = "STUDY")]
    study: Option<PathBuf>,
    #[command(flatten)]
    set: SetArgs,
    /// Folder to write to, or for a single file its name
    #[arg(short, long, value_name = "PATH", default_value = ".")]
    output: PathBuf,
}

/// Writes the files and says where they are.
///
/// # Errors
/// Those of the study and of [`files`]; a folder that cannot be written.
pub(super) fn export(args: &ExportArgs) -> Result<(), Failure> {
    let set = args.set.settings();
    let study = args.study.as_deref().map(|study| Study::read_with(study, set)).transpose()?;
    if let (None, Some(setting)) = (&study, set.first()) {
        let expected = "a study whose keys are set";
        return Err(
            InputError::new(setting.option(), "given", expected, "name the study with --study").into()
        );
    }
    let files = files(&args.file, args.format, args.reference.as_deref(), study.as_ref())?;
    Ok(write(&files, &args.output)?)
}

fn write(files: &[ExportFile], output: &Path) -> Result<(), Error> {
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
    let folder = OutputFolder::create(folder)?;
    for file in files {
        let name = named.unwrap_or(&file.name);
        folder.write(name, file.text.as_bytes())?;
        say(&folder.file(name).display().to_string())?;
    }
    Ok(())
}
