//! The report as a stage, and the page of the cross-check beside it.

use railspring_profiles::error::Result;

use super::build;
use crate::engine::list::{Entry, NewFile, Results};
use crate::engine::output::OutputFolder;
use crate::engine::seal::Sealed;
use crate::engine::stage::{Engine, Stage, StageOutput};
use crate::engine::store::{Address, Artefact, Kind};
use crate::results::bodies::geometry;
use crate::results::bodies::in_work::Solids;
use crate::results::by_angle::record::{BY_ANGLE, StiffnessByAngleRecord};
use crate::results::crosscheck::page::{Crosscheck, PageData, page};
use crate::results::crosscheck::record::{CrosscheckRecord, Differences, SectionDifference};
use crate::results::names::{
    CROSSCHECK, CROSSCHECK_PAGE, DIFFERENCES, FIGURES, REPORT, REPORT_PDF, STIFFNESS,
};
use crate::results::page::data::ReportData;
use crate::results::page::input::PageInput;
use crate::results::run::figures::{ModelRun, ScenarioRun};
use crate::results::run::springs;
use crate::results::run::stage::{Other, Run, Runs};
use crate::results::self_test::SelfTest;
use crate::results::springs::make::Calibration;
use crate::results::verdict::record::VerificationRecord;
use crate::self_test::Check;
use crate::study::ContactElementKey;
use crate::verify::Band;

/// The report on all results.
pub(crate) struct Report<'s, 'a> {
    pub solids: &'s mut Solids<'a>,
    pub input: PageInput<'s>,
    pub calibration: &'s Calibration,
    /// The laws by contact angle, if the study wants them.
    pub by_angle: Option<&'s StiffnessByAngleRecord>,
    pub runs: &'s [(String, Runs)],
    pub verdict: &'s VerificationRecord,
    /// The program's own test; made by [`write_report`].
    pub checks: Vec<Check>,
}

impl<'s> Stage for Report<'s, '_> {
    type Value = ();

    fn name(&self) -> String {
        "report".into()
    }

    fn address(&mut self, _: &Engine<'_>) -> Result<Address> {
        let springs =
            [Some(&self.calibration.stiffness.input_hash), self.by_angle.map(|laws| &laws.input_hash)];
        Ok(Address::of(Kind::Report, &(&self.verdict.input_hash, springs, &self.input)))
    }

    fn is_kept(&self) -> bool {
        false
    }

    fn make(&mut self, engine: &mut Engine<'_>) -> Result<StageOutput> {
        let geometry = self.solids.geometry()?;
        let input = &self.input;
        let profiles = geometry::profiles(&geometry);
        let scenarios = self
            .runs
            .iter()
            .map(|(name, runs)| {
                let scenario = &input.cases[name];
                let limits = input.limits;
                let drawn = |name, run: &'s Run| ModelRun {
                    name,
                    history: &run.history,
                    carrying: run.model().carrying(limits.ratio_max),
                };
                let springs = runs.simple.record.springs.as_ref();
                let chosen = springs.map_or(ContactElementKey::Published, springs::element);
                let own = drawn(chosen.name(), &runs.simple);
                let other = |Other { element, run }: &'s Other| {
                    run.as_ref().ok().map(|run| drawn(element.name(), run))
                };
                ScenarioRun {
                    name,
                    description: &scenario.description,
                    snapshots: &scenario.snapshots,
                    elements: [own].into_iter().chain(runs.others.iter().filter_map(other)).collect(),
                    solid: runs.solid.as_ref().map(|run| drawn("solid", run)),
                    band: runs.solid.as_ref().and_then(|run| Band::around(&run.model(), limits)),
                    uncertain: runs.uncertain.as_ref().ok(),
                }
            })
            .collect();
        let crosscheck = own_crosscheck(input, engine.folder)?;
        let sections = crosscheck.as_ref().map(|record| differences(engine.folder, record));
        let sections = sections.transpose()?.unwrap_or_default();
        // The folder may have runs of other load cases.
        let inputs = [STIFFNESS, BY_ANGLE].into_iter().chain(self.verdict.inputs.keys().map(String::as_str));
        let entries: Vec<Entry> = inputs.filter_map(|name| engine.results.entry(name)).collect();
        let keys: Vec<&String> = entries.iter().map(|entry| &entry.key).collect();
        let programs: Vec<String> = entries.iter().map(Entry::program).collect();
        let mut measured = engine.measured.clone();
        measured.stages.retain(|stage| keys.contains(&&stage.key));
        let data = ReportData {
            name: input.name,
            description: input.description,
            file: input
                .source
                .path()
                .file_name()
                .map(|name| (name.to_string_lossy().into_owned(), input.source.hash().to_string())),
            inputs: &input.keys,
            intended_use: input.intended_use,
            review: input.review,
            checks: &self.checks,
            stiffness: &self.calibration.stiffness,
            load_curve: &self.calibration.load_curve,
            patches: &self.calibration.patches,
            by_angle: self.by_angle,
            profiles: &profiles,
            surfaces: &geometry.surfaces,
            bodies: &geometry.outlines(),
            scenarios,
            ratio_window: input.limits.ratio_window_s,
            verdict: self.verdict,
            programs: &programs,
            measured: &measured,
            crosscheck: match &crosscheck {
                Some(record) => Crosscheck::Fresh(record, &sections),
                None if engine.folder.file(CROSSCHECK).exists() => Crosscheck::Stale,
                None => Crosscheck::Absent,
            },
        };
        let built = build::build(&data);
        let figures = built.figures.into_iter().map(|(name, svg)| (format!("{FIGURES}{name}.svg"), svg));
        let artefact = figures.fold(Artefact::default(), |all, (name, svg)| all.with(name, svg));
        Ok(StageOutput::whole(artefact.with(REPORT, built.html)))
    }

    fn value(&mut self, _: &Artefact, _: &str) -> Result<()> {
        Ok(())
    }

    fn files(&self, artefact: &Artefact, (): &(), key: &str) -> Vec<NewFile> {
        let file = |(name, content): (&str, &[u8])| {
            // The page shows seconds and the host.
            NewFile { reproducible: name != REPORT, ..NewFile::new(name, content.to_vec(), key) }
        };
        artefact.parts().map(file).collect()
    }

    fn outdates(&self) -> &'static [&'static str] {
        &[REPORT_PDF]
    }

    fn is_measured(&self) -> bool {
        false
    }
}

/// The report, and the page of this study's cross-check again, because it now has a report to point to.
///
/// # Errors
/// Those of the geometry, and files that cannot be written.
pub(crate) fn write_report(engine: &mut Engine<'_>, mut report: Report<'_, '_>) -> Result<()> {
    report.checks = engine.get(&mut SelfTest)?;
    let failed = report.checks.iter().filter(|check| !check.holds()).count();
    if failed > 0 {
        let all = report.checks.len();
        engine.monitor.notice(&format!(
            "self-test: {failed} of {all} checks fail on this machine; see `railspring self-test`"
        ));
    }
    engine.get(&mut report)?;
    let folder = engine.folder;
    let Some(record) = own_crosscheck(&report.input, folder)? else { return Ok(()) };
    crosscheck_page(&report.input, folder, &record, true)
}

/// The page of the folder's cross-check where there is no report.
///
/// # Errors
/// A cross-check that is not there or was edited, and a page that cannot be written.
pub(crate) fn crosscheck_alone(input: &PageInput<'_>, folder: &OutputFolder) -> Result<()> {
    let record: CrosscheckRecord = folder.read_json(CROSSCHECK, "crosscheck")?;
    record.check_as_written(&folder.file(CROSSCHECK), "crosscheck")?;
    crosscheck_page(input, folder, &record, false)
}

/// The cross-check of the folder if it is one of this study: `None` if it is of another study
/// or has another layout.
///
/// # Errors
/// One of this study that was edited.
fn own_crosscheck(input: &PageInput<'_>, folder: &OutputFolder) -> Result<Option<CrosscheckRecord>> {
    let Ok(record) = folder.read_json::<CrosscheckRecord>(CROSSCHECK, "crosscheck") else { return Ok(None) };
    if !input.crosschecks.contains(&record.input_hash) {
        return Ok(None);
    }
    record.check_as_written(&folder.file(CROSSCHECK), "crosscheck")?;
    Ok(Some(record))
}

/// The sections of that very cross-check; none if they are not there.
///
/// # Errors
/// Sections that were edited.
fn differences(folder: &OutputFolder, record: &CrosscheckRecord) -> Result<Vec<SectionDifference>> {
    let found = folder.read_json::<Differences>(DIFFERENCES, "crosscheck").ok();
    let same = |d: &Differences| d.input_hash == record.input_hash && d.begun_utc == record.begun_utc;
    let Some(own) = found.filter(same) else { return Ok(Vec::new()) };
    own.check_as_written(&folder.file(DIFFERENCES), "crosscheck")?;
    Ok(own.sections)
}

fn crosscheck_page(
    input: &PageInput<'_>,
    folder: &OutputFolder,
    record: &CrosscheckRecord,
    report: bool,
) -> Result<()> {
    let sections = differences(folder, record)?;
    let data =
        PageData { description: input.description, inputs: &input.keys, record, sections: &sections, report };
    let results = Results::new(folder);
    let key = results.entry(CROSSCHECK).map_or_else(|| record.input_hash.clone(), |entry| entry.key);
    // the page shows seconds and the host
    let file =
        NewFile { reproducible: false, ..NewFile::new(CROSSCHECK_PAGE, page(&data).into_bytes(), &key) };
    results.write(vec![file], &[])
}
