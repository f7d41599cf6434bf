//! The commands that take a study through its stages.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};
use railspring_profiles::error::{Error, InputError};
use railspring_profiles::monitor::Monitor;
use serde_json::json;

use super::element_files::ElementFiles;
use super::failure::Failure;
use super::pdf_args::PdfArgs;
use super::progress::Progress;
use super::results::Results;
use super::set_args::SetArgs;
use super::track;
use super::work_args::{WorkArgs, take_threads};
use crate::engine::inputs::Inputs;
use crate::engine::list::{NewFile, Results as Listed};
use crate::engine::output::OutputFolder;
use crate::engine::stage::check_outputs;
use crate::engine::store::Store;
use crate::hash::hash;
use crate::pdf::Printer;
use crate::python::Purpose;
use crate::results::bodies::estimate::{self, Work};
use crate::results::bodies::input::SolidsInput;
use crate::results::by_angle::record::BY_ANGLE;
use crate::results::crosscheck::deck::Format;
use crate::results::crosscheck::exchange::Case;
use crate::results::crosscheck::in_time::input::InTimeInput;
use crate::results::crosscheck::input::CrosscheckInput;
use crate::results::crosscheck::write_deck;
use crate::results::files::{RESULT_FILES, ResultFile};
use crate::results::names::{CROSSCHECK_PAGE, REPORT};
use crate::results::run::input::SpringsInput;
use crate::results::run::springs;
use crate::results::study_run::StudyRun;
use crate::study::Study;
use crate::track::is_track;

#[derive(Debug, Subcommand)]
pub(super) enum StudyCommand {
    /// Run the whole study: calibrate, simulate, verify, report; of a load case on a track (`kind = "track"`) the run alone
    Run(StudyArgs),
    /// Calibrate: the load curve, the normal law and the horizontal stiffness
    Calibrate(StudyArgs),
    /// Simulate the load cases with the simple model
    Simulate {
        #[command(flatten)]
        study: StudyArgs,
        /// Springs to simulate with, a stiffness.json or a law written by hand; left out, those of the output folder
        #[arg(long, value_name = "FILE")]
        law: Option<PathBuf>,
    },
    /// Run the solid model where its histories are missing, and compare the simple model with it
    Verify(StudyArgs),
    /// Write the meshes of wheel and rail
    Mesh(StudyArgs),
    /// Write the report again from the files of the output folder
    Report(StudyArgs),
    /// Compare the solid model with reference solvers: scikit-fem, and CalculiX on request
    Crosscheck {
        #[command(flatten)]
        study: StudyArgs,
        /// Compare with elements of second order, too: some minutes, and 19 GB of memory with the default mesh
        #[arg(long)]
        second_order: bool,
        /// Compare with another program, too, if it is installed
        #[arg(long = "with", value_name = "PROGRAM")]
        with: Option<OtherProgram>,
        /// Compare the first load case over time instead, on the study's mesh with contact between its elements: some minutes
        #[arg(long, conflicts_with_all = ["second_order", "with"])]
        in_time: bool,
        /// Write a copy of the record to this file, to be kept with the study
        #[arg(long, value_name = "FILE")]
        keep: Option<PathBuf>,
    },
    /// Write the solid problem as a deck for another program
    Deck {
        #[command(flatten)]
        study: StudyArgs,
        /// The program
        #[arg(long, value_name = "FORMAT")]
        format: Format,
    },
}

/// The study, and how it is done.
#[derive(Debug, Args)]
pub(super) struct StudyArgs {
    /// The study, a TOML file
    #[arg(value_name = "STUDY")]
    study: PathBuf,
    #[command(flatten)]
    set: SetArgs,
    #[command(flatten)]
    run: RunArgs,
}

/// How a study is done, and where its results go.
#[derive(Debug, Args)]
pub(super) struct RunArgs {
    /// Output folder; left out, out/<name of the study>
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub how: HowArgs,
}

/// How a study is done.
#[derive(Debug, Args)]
pub(super) struct HowArgs {
    #[command(flatten)]
    pub work: WorkArgs,
    /// Print what the command would need, and stop
    #[arg(long)]
    dry_run: bool,
    /// Make again what would be taken from the store, and replace it there
    #[arg(long)]
    fresh: bool,
    #[command(flatten)]
    pdf: PdfArgs,
}

/// A program that repeats the contact besides the Python reference.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum OtherProgram {
    /// CalculiX, run on the exported deck
    Calculix,
}

impl StudyCommand {
    /// Its name, and its arguments.
    pub fn parts(&self) -> (&'static str, &StudyArgs) {
        match self {
            Self::Run(study) => ("run", study),
            Self::Calibrate(study) => ("calibrate", study),
            Self::Simulate { study, .. } => ("simulate", study),
            Self::Verify(study) => ("verify", study),
            Self::Mesh(study) => ("mesh", study),
            Self::Report(study) => ("report", study),
            Self::Crosscheck { study, .. } => ("crosscheck", study),
            Self::Deck { study, .. } => ("deck", study),
        }
    }

    fn action(&self) -> Action<'_> {
        match self {
            Self::Run(_) => Action::Run,
            Self::Calibrate(_) => Action::Calibrate,
            Self::Simulate { law, .. } => Action::Simulate(law.as_deref()),
            Self::Verify(_) => Action::Verify,
            Self::Mesh(_) => Action::Mesh,
            Self::Report(_) => Action::Report,
            Self::Crosscheck { in_time: true, keep, .. } => {
                Action::CrosscheckInTime { keep: keep.as_deref() }
            }
            Self::Crosscheck { second_order, with, keep, .. } => Action::Crosscheck {
                second_order: *second_order,
                with_calculix: with.is_some(),
                keep: keep.as_deref(),
            },
            Self::Deck { format, .. } => Action::Deck(*format),
        }
    }
}

impl StudyArgs {
    /// What all commands that solve need to know.
    pub fn work(&self) -> &WorkArgs {
        &self.run.how.work
    }
}

/// What is done with a study.
#[derive(Debug, Clone, Copy)]
pub(super) enum Action<'a> {
    Run,
    Calibrate,
    Simulate(Option<&'a Path>),
    Verify,
    Mesh,
    Report,
    Crosscheck { second_order: bool, with_calculix: bool, keep: Option<&'a Path> },
    CrosscheckInTime { keep: Option<&'a Path> },
    Deck(Format),
    Element(&'a ElementFiles),
}

impl Action<'_> {
    /// Whether it takes results from the store and keeps them there.
    fn keeps(self) -> bool {
        !matches!(self, Self::Mesh | Self::Report | Self::Deck(_))
    }

    /// The page that it writes, if it does.
    fn page(self) -> Option<&'static str> {
        match self {
            Self::Run | Self::Report => Some(REPORT),
            Self::Crosscheck { .. } | Self::CrosscheckInTime { .. } => Some(CROSSCHECK_PAGE),
            _ => None,
        }
    }

    /// The files that it reads: the study with all that its keys name, and a law.
    fn inputs(self, study: &Study) -> Inputs {
        let law = match self {
            Self::Simulate(law) => law,
            _ => None,
        };
        let beside = law.map(|law| law.with_file_name(BY_ANGLE));
        Inputs::of(study.source.files().chain(law).chain(beside.as_deref()))
    }

    /// The files that it writes in the output folder.
    fn outputs(self) -> impl Iterator<Item = &'static ResultFile> {
        let command = match self {
            Self::Run => "run",
            Self::Calibrate | Self::Element(_) => "calibrate",
            Self::Simulate(_) => "simulate",
            Self::Verify => "verify",
            Self::Mesh => "mesh",
            Self::Report => "report",
            Self::Crosscheck { .. } | Self::CrosscheckInTime { .. } => "crosscheck",
            Self::Deck(_) => "deck",
        };
        RESULT_FILES.iter().filter(move |file| file.is_made_by(command))
    }

    /// Whether it begins without the results of an earlier command.
    fn begins(self, study: &Study) -> bool {
        match self {
            Self::Simulate(None) => springs::need_no_calibration(&SpringsInput::of(study)),
            Self::Verify | Self::Report => false,
            _ => true,
        }
    }
}

/// Runs a command; whether all limits hold.
pub(super) fn run(command: &StudyCommand) -> Result<bool, Failure> {
    let (name, args) = command.parts();
    if is_track(&args.study, args.set.settings()) {
        return on_a_track(command);
    }
    let study = Study::read_with(&args.study, args.set.settings())?;
    let results = Results::of(name).of_study(&study.name);
    let (output, how) = (args.run.output.as_deref(), &args.run.how);
    done(command.action(), results, (output, how), &study, &[])
        .map_err(|error| Failure::of_stage(&study, error))
}

/// The same of a load case on a track, which has nothing to calibrate.
fn on_a_track(command: &StudyCommand) -> Result<bool, Failure> {
    let (name, args) = command.parts();
    if !matches!(command, StudyCommand::Run(_) | StudyCommand::Simulate { law: None, .. }) {
        return Err(track::refused(name, &args.study));
    }
    let HowArgs { work, dry_run, pdf, .. } = &args.run.how;
    let how =
        track::How { output: args.run.output.as_deref(), work, dry_run: *dry_run, printer: pdf.printer()? };
    track::run(name, &args.study, args.set.settings(), &how)
}

/// Writes a file of a kind into a folder and says its path.
type WriteFile<'w> = &'w dyn Fn(&Path) -> Result<String, Error>;

/// Does it with a study and prints `results` with what was found; whether all limits hold. `files` are further files of the output folder: a function
/// of the folder for the text of each.
///
/// # Errors
/// Those of the stages, and a folder that cannot be used.
pub(super) fn done(
    action: Action<'_>,
    results: Results,
    (output, how): (Option<&Path>, &HowArgs),
    study: &Study,
    files: &[(&str, WriteFile<'_>)],
) -> Result<bool, Error> {
    let HowArgs { work, dry_run, fresh, pdf } = how;
    let path = output.map_or_else(|| PathBuf::from("out").join(&study.name), PathBuf::from);
    let printer = match (pdf.printer()?, action.page()) {
        (Some(_), None) => {
            let expected =
                "one of the commands `run`, `fit`, `report`, `crosscheck` and `compare`, which write a page";
            return Err(InputError::new("--pdf", "given", expected, "leave it out").into());
        }
        (printer, page) => printer.zip(page),
    };
    if *dry_run {
        return tried(action, results, work, study, &path)?.print(work.json, work.quiet).map(|()| true);
    }
    if *fresh && !action.keeps() {
        let expected =
            "one of the commands `run`, `calibrate`, `element`, `simulate`, `verify` and `crosscheck`";
        return Err(InputError::new("--fresh", "given", expected, "leave it out").into());
    }
    let inputs = action.inputs(study);
    let is_output = |name: &str| action.outputs().any(|file| file.matches(name));
    inputs.check_folder(&path, |name| is_output(name) || files.iter().any(|(own, _)| *own == name))?;
    if let Action::Element(wanted) = action {
        wanted.check(&inputs)?;
    }
    let folder = match action.begins(study) {
        true => OutputFolder::create(&path, &inputs)?,
        false => OutputFolder::open(&path, &inputs)?,
    };
    // of several files of a kind it is known later which there are
    check_outputs(&folder, |name| action.outputs().any(|file| file.is_single() && file.matches(name)))?;
    for (name, text) in files {
        Listed::new(&folder).check_not_edited(name, text(&path)?.as_bytes())?;
    }
    take_threads(work.threads)?;
    let _claim = folder.claim()?;
    let progress = Progress::new(work.quiet);
    let resources = work.resources(&progress);
    let store = if action.keeps() { open_store(work, &progress)? } else { None };
    let pipeline = StudyRun::new(study, &folder, resources).keeping(store.as_ref(), *fresh);
    let (results, holds) = match action {
        Action::Mesh => {
            let sizes = pipeline.mesh()?;
            let bodies = ["rail", "wheel"].into_iter().zip(sizes);
            let said = bodies.clone().map(|(body, size)| {
                format!(
                    "{body}: {} nodes, {} elements, {} contact nodes",
                    size.nodes, size.hexes, size.contact
                )
            });
            let more = bodies.clone().map(|(body, size)| {
                json!({ "body": body, "nodes": size.nodes, "elements": size.hexes, "contact_nodes": size.contact })
            });
            (results.with_more(said.collect(), more.collect()), true)
        }
        Action::Deck(format) => {
            write_deck(&CrosscheckInput::of(study), format, &folder, &resources)?;
            (results, true)
        }
        Action::Crosscheck { second_order, with_calculix, keep } => {
            const CASES: [Case; 4] =
                [Case::SameMesh, Case::SameMeshFriction, Case::OtherSurface, Case::SecondOrder];
            let cases = if second_order { &CASES[..] } else { &CASES[..3] };
            let record = pipeline.crosscheck(cases, with_calculix, keep)?;
            (results.with_crosscheck(&record), record.holds)
        }
        Action::CrosscheckInTime { keep } => {
            let record = pipeline.crosscheck_in_time(keep)?;
            (results.with_crosscheck(&record), record.holds)
        }
        Action::Element(wanted) => {
            let (found, laws) = pipeline.springs_with_elements()?;
            let (said, more) = wanted.write(study, &found, &laws, &inputs)?;
            (results.with(&found).with_more(said, more), found.holds())
        }
        Action::Run | Action::Calibrate | Action::Simulate(_) | Action::Verify | Action::Report => {
            let found = match action {
                Action::Run => pipeline.run()?,
                Action::Calibrate => pipeline.calibrate()?,
                Action::Simulate(law) => pipeline.simulate(law)?,
                Action::Verify => pipeline.verify()?,
                _ => pipeline.report()?,
            };
            // a report is written whatever it says
            (results.with(&found), matches!(action, Action::Report) || found.holds())
        }
    };
    for (name, text) in files {
        let content = text(&path)?.into_bytes();
        let key = hash(&content);
        Listed::new(&folder).write(vec![NewFile::new(*name, content, &key)], &[])?;
    }
    progress.finish();
    if let Some((printer, page)) = printer {
        Printer::remark().iter().for_each(|line| resources.monitor.notice(line));
        printer.print(&folder, page)?;
    }
    let first = match action {
        Action::Run | Action::Report => folder.file(REPORT),
        Action::Element(wanted) => wanted.file.clone(),
        _ => path,
    };
    results.at(&first).holding(holds).print(work.json, work.quiet)?;
    Ok(holds)
}

/// The store. One that was named must be there; without the default one everything is made, which is said.
fn open_store(args: &WorkArgs, progress: &Progress) -> Result<Option<Store>, Error> {
    match args.store() {
        Ok(store) => Ok(Some(store)),
        Err(error) if args.cache.is_some() || args.cache_key.is_some() => Err(error),
        Err(error) => {
            progress.notice(&format!("nothing is taken from the store or kept there: {error}"));
            Ok(None)
        }
    }
}

/// What a command would need.
fn tried(
    action: Action<'_>,
    results: Results,
    args: &WorkArgs,
    study: &Study,
    path: &Path,
) -> Result<Results, Error> {
    let input = SolidsInput::of(study);
    let work = match action {
        Action::Run => Work::of(&input, true, true),
        Action::Calibrate | Action::Deck(_) | Action::Element(_) => Work::of(&input, true, false),
        Action::Verify => Work::of(&input, false, true),
        Action::Mesh => Work::default(),
        Action::Crosscheck { second_order, .. } => Work::of_crosscheck(match second_order {
            true => Purpose::SecondOrder,
            false => Purpose::FirstOrder,
        }),
        Action::CrosscheckInTime { .. } => InTimeInput::of(study)?.work(),
        Action::Simulate(_) | Action::Report => {
            let steps: Vec<(&String, usize)> =
                study.scenarios.iter().map(|(name, case)| (name, case.scenario.steps)).collect();
            let said = match action {
                Action::Report => {
                    vec![format!("expected: the report from the results in {}", path.display())]
                }
                _ => steps
                    .iter()
                    .map(|(name, steps)| format!("expected: {name}: {steps} time steps"))
                    .collect(),
            };
            return Ok(results.with_more(said, json!({ "time_steps": steps })));
        }
    };
    let progress = Progress::new(args.quiet);
    let estimate = estimate::dry_run(&input, &work, &args.resources(&progress))?;
    progress.finish();
    Ok(results.with_estimate(&estimate))
}
