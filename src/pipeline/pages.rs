//! The report as a stage, and the page of the cross-check beside it.

use railspring_profiles::error::Result;

use super::runs::{Other, Run, Runs};
use super::stage::{Made, Stage};
use super::{
    BY_ANGLE, CROSSCHECK, CROSSCHECK_PAGE, DIFFERENCES, FIGURES, Pipeline, REPORT, REPORT_PDF, STIFFNESS,
};
use crate::records::crosscheck::{CrosscheckRecord, Differences, SectionDifference};
use crate::records::{StiffnessByAngleRecord, VerificationRecord};
use crate::report::crosscheck::{Crosscheck, PageData, page};
use crate::report::{self, ModelRun, ReportData, ScenarioRun};
use crate::results::{Entry, NewFile};
use crate::stages::{self, Calibration};
use crate::store::{Address, Artefact, Kind};
use crate::verify::Band;

/// The report on all results.
pub(super) struct Report<'a> {
    pub calibration: &'a Calibration,
    /// The laws by contact angle, if the study wants them.
    pub by_angle: Option<&'a StiffnessByAngleRecord>,
    pub runs: &'a [(String, Runs)],
    pub verdict: &'a VerificationRecord,
}

impl<'a> Stage for Report<'a> {
    type Value = ();

    fn name(&self) -> String {
        "report".into()
    }

    fn address(&self, at: &mut Pipeline<'_>) -> Result<Address> {
        let springs =
            [Some(&self.calibration.stiffness.input_hash), self.by_angle.map(|laws| &laws.input_hash)];
        let inputs = (&self.verdict.input_hash, springs, &at.study.description, &at.study.resolved);
        Ok(Address::of(Kind::Report, &inputs))
    }

    fn is_kept(&self) -> bool {
        false
    }

    fn make(&self, at: &mut Pipeline<'_>) -> Result<Made> {
        let geometry = at.geometry()?;
        let profiles = stages::profiles(&geometry);
        let scenarios = self
            .runs
            .iter()
            .map(|(name, runs)| {
                let scenario = &at.study.scenarios[name];
                let limits = &at.study.limits;
                let drawn = |name, run: &'a Run| ModelRun {
                    name,
                    history: &run.history,
                    carrying: run.model().carrying(limits.ratio_max),
                };
                let Other { element, run: other } = &runs.other;
                let own = drawn(element.other().name(), &runs.simple);
                let other = other.as_ref().ok().map(|run| drawn(element.name(), run));
                ScenarioRun {
                    name,
                    description: &scenario.description,
                    snapshots: &scenario.snapshots,
                    elements: [own].into_iter().chain(other).collect(),
                    solid: runs.solid.as_ref().map(|run| drawn("solid", run)),
                    band: runs.solid.as_ref().and_then(|run| Band::around(&run.model(), limits)),
                }
            })
            .collect();
        let crosscheck = at.own_crosscheck();
        let sections = crosscheck.as_ref().map_or_else(Vec::new, |record| at.differences(record));
        // The folder may have runs of other load cases.
        let inputs = [STIFFNESS, BY_ANGLE].into_iter().chain(self.verdict.inputs.keys().map(String::as_str));
        let entries: Vec<Entry> = inputs.filter_map(|name| at.results.entry(name)).collect();
        let keys: Vec<&String> = entries.iter().map(|entry| &entry.key).collect();
        let programs: Vec<String> = entries.iter().map(Entry::program).collect();
        let mut measured = at.measured.clone();
        measured.stages.retain(|stage| keys.contains(&&stage.key));
        let data = ReportData {
            name: &at.study.name,
            description: &at.study.description,
            file: at
                .study
                .source
                .path()
                .file_name()
                .map(|name| (name.to_string_lossy().into_owned(), at.study.source.hash().to_string())),
            inputs: &at.study.resolved,
            stiffness: &self.calibration.stiffness,
            load_curve: &self.calibration.load_curve,
            patches: &self.calibration.patches,
            by_angle: self.by_angle,
            profiles: &profiles,
            surfaces: &geometry.surfaces,
            bodies: &geometry.outlines(),
            scenarios,
            ratio_window: at.study.limits.ratio_window_s,
            verdict: self.verdict,
            programs: &programs,
            measured: &measured,
            crosscheck: match &crosscheck {
                Some(record) => Crosscheck::Fresh(record, &sections),
                None if at.folder.file(CROSSCHECK).exists() => Crosscheck::Stale,
                None => Crosscheck::Absent,
            },
        };
        let built = report::build(&data);
        let figures = built.figures.into_iter().map(|(name, svg)| (format!("{FIGURES}{name}.svg"), svg));
        let artefact = figures.fold(Artefact::default(), |all, (name, svg)| all.with(name, svg));
        Ok(Made::whole(artefact.with(REPORT, built.html)))
    }

    fn value(&self, _: &Artefact, _: &str, _: &mut Pipeline<'_>) -> Result<()> {
        Ok(())
    }

    fn files(&self, artefact: &Artefact, (): &(), key: &str, _: &Pipeline<'_>) -> Vec<NewFile> {
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

impl Pipeline<'_> {
    /// The report, and the page of this study's cross-check again, because it now has a report to point to.
    pub(super) fn report_stage(&mut self, report: &Report<'_>) -> Result<()> {
        self.get(report)?;
        let Some(record) = self.own_crosscheck() else { return Ok(()) };
        self.crosscheck_page(&record, &self.differences(&record), true)
    }

    /// The page of the folder's cross-check where there is no report.
    pub(super) fn crosscheck_alone(&self) -> Result<()> {
        let record = self.folder.read_json(CROSSCHECK, "crosscheck")?;
        self.crosscheck_page(&record, &self.differences(&record), false)
    }

    /// The cross-check of the folder if it is one of this study: `None` if it is of another study
    /// or has another layout.
    fn own_crosscheck(&self) -> Option<CrosscheckRecord> {
        let record: CrosscheckRecord = self.folder.read_json(CROSSCHECK, "crosscheck").ok()?;
        (record.input_hash == self.study.keys.crosscheck).then_some(record)
    }

    /// The sections of that very cross-check; none if they are not there.
    fn differences(&self, record: &CrosscheckRecord) -> Vec<SectionDifference> {
        self.folder
            .read_json::<Differences>(DIFFERENCES, "crosscheck")
            .ok()
            .filter(|d| d.input_hash == record.input_hash && d.begun_utc == record.begun_utc)
            .map_or_else(Vec::new, |d| d.sections)
    }

    fn crosscheck_page(
        &self,
        record: &CrosscheckRecord,
        sections: &[SectionDifference],
        report: bool,
    ) -> Result<()> {
        let data = PageData {
            description: &self.study.description,
            inputs: &self.study.resolved,
            record,
            sections,
            report,
        };
        self.folder.write(CROSSCHECK_PAGE, page(&data).as_bytes())
    }
}
