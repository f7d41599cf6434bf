//! `railspring fit`: the springs of a pair without a study file; `railspring new`: the study file of a pair.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use railspring_profiles::error::InputError;

use super::failure::Failure;
use super::output::{remark, say};
use super::pair_args::{Given, Named, by_option, named};
use super::results::Results;
use super::set_args::SetArgs;
use super::staged::{Action, RunArgs, done};
use super::work_args::WorkArgs;
use crate::engine::inputs::Inputs;
use crate::engine::output::{OutputFolder, TEMPORARY, readable_by_all};
use crate::hash::key;
use crate::study::Study;

/// The study that a fit leaves in its folder.
const STUDY: &str = "study.toml";
/// Keys that a pair leaves open and that its springs depend on most.
const ASSUMED: [(&str, &str); 5] = [
    ("wheel", "tape_diameter_m"),
    ("rail", "inclination"),
    ("track", "gauge_mm"),
    ("track", "flange_back_mm"),
    ("contact", "friction"),
];

/// The pair of a fit.
#[derive(Debug, Args)]
pub(super) struct FitArgs {
    /// Wheel: name of a standard, or a profile file
    #[arg(value_name = "WHEEL")]
    wheel: String,
    /// Rail: name of a standard, or a profile file
    #[arg(value_name = "RAIL")]
    rail: String,
    #[command(flatten)]
    set: SetArgs,
    #[command(flatten)]
    run: RunArgs,
}

impl FitArgs {
    /// What all commands that solve need to know.
    pub fn work(&self) -> &WorkArgs {
        &self.run.how.work
    }
}

/// The study that is to be written.
#[derive(Debug, Args)]
pub(super) struct NewArgs {
    /// Name of the study, whose file is NAME.toml; a path with folders writes it there
    #[arg(value_name = "NAME")]
    name: PathBuf,
    /// Name of a standard wheel, or a profile file
    #[arg(long, value_name = "WHEEL", default_value = "S1002")]
    wheel: String,
    /// Name of a standard rail, or a profile file
    #[arg(long, value_name = "RAIL", default_value = "60E1")]
    rail: String,
    #[command(flatten)]
    set: SetArgs,
}

/// Fits the springs of a pair; whether all limits hold.
pub(super) fn fit(args: &FitArgs) -> Result<bool, Failure> {
    let settings = args.set.settings();
    let pair = [Given::wheel("WHEEL", &args.wheel), Given::rail("RAIL", &args.rail)];
    let Named { pair, study } = named(None, pair, settings)?;
    if !args.run.how.work.quiet {
        remark(&assumed(&study));
    }
    let text = |folder: &Path| Ok(pair.study(&folder.join(STUDY), false, settings));
    let results = Results::of("fit").of_study(&study.name);
    let how = (args.run.output.as_deref(), &args.run.how);
    done(Action::Run, results, how, &study, &[(STUDY, &text)])
        .map_err(|error| by_option(Failure::of_stage(&study, error), "--set"))
}

/// The keys that were not given and that springs depend on most.
fn assumed(study: &Study) -> String {
    let open = study.resolved.iter().filter(|key| {
        !key.given && ASSUMED.iter().any(|(section, name)| key.section == *section && key.key == *name)
    });
    let open: Vec<String> = open.map(|key| format!("{}.{} = {}", key.section, key.key, key.value)).collect();
    match open.is_empty() {
        true => "all of the pair is given".into(),
        false => format!("assumed: {}; --set gives others", open.join(", ")),
    }
}

/// Writes the study of a pair, with a load case; a file that is there stays.
pub(super) fn new(args: &NewArgs) -> Result<(), Failure> {
    let stem = match args.name.extension() {
        Some(ending) if ending == "toml" => args.name.with_extension(""),
        _ => args.name.clone(),
    };
    let name = stem.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let folder = stem.parent().unwrap_or(Path::new(""));
    let file = folder.join(format!("{name}.toml"));
    let pair = [Given::wheel("--wheel", &args.wheel), Given::rail("--rail", &args.rail)];
    let Named { pair, study } =
        named(Some(&name), pair, args.set.settings()).map_err(|failure| by_option(failure, "--set"))?;
    let text = pair.study(&file, true, args.set.settings());
    let here = Some(folder).filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = OutputFolder::create(here, &Inputs::none())?;
    // the file is read as `railspring run` will read it, from a folder that is there
    let written = Study::parse(&file, &text)?;
    debug_assert_eq!(key(&written.statics()), key(&study.statics()));
    written_new(&folder, &file, &text)?;
    if written.intended_use.purpose.trim().is_empty() {
        remark("say what the springs are for: intended_use.purpose, and how accurate they have to be");
    }
    Ok(say(&file.display().to_string())?)
}

/// Writes a file of a folder that is not there yet, at once.
fn written_new(folder: &OutputFolder, file: &Path, text: &str) -> Result<(), InputError> {
    let write = || -> std::io::Result<()> {
        let mut temporary = tempfile::Builder::new().prefix(TEMPORARY).tempfile_in(folder.path())?;
        temporary.write_all(text.as_bytes())?;
        readable_by_all(temporary.path())?;
        temporary.persist_noclobber(file).map(|_| ()).map_err(|cause| cause.error)
    };
    write().map_err(|cause| {
        let (expected, remedy) = match cause.kind() {
            ErrorKind::AlreadyExists => {
                ("a study that does not exist yet", "give another name; what is there stays as it is")
            }
            _ => ("a file that can be written", "make room or correct the permissions, or give another name"),
        };
        InputError::new(file.display().to_string(), cause, expected, remedy)
    })
}
