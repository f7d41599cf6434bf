//! What a command has found, said at its end: lines for a reader, or one JSON object for a program.

use std::path::Path;

use railspring_profiles::error::Error;
use serde::Serialize;
use serde_json::Value;

use super::output::{Line, Tone, say, say_line};
use crate::results::bodies::estimate::Estimate;
use crate::results::commands::Found;
use crate::results::crosscheck::record::{Check, CrosscheckRecord};
use crate::results::run::record::RunRecord;
use crate::results::springs::assumed_record::AssumedRecord;
use crate::results::springs::record::{LawRecord, StiffnessRecord};
use crate::results::springs::uncertainty_record::InputUncertaintyRecord;
use crate::results::verdict::record::{VerdictOn, VerificationRecord};
use crate::rounding::{rounded_to, significant, with_unit};
use crate::verify::{self, ChangedLimit, NotApplicable};

/// Most limits that are listed of those that fail.
const WORST: usize = 3;

/// What a command has found; what it was not asked for is left out.
#[derive(Debug, Default, Serialize)]
pub(super) struct Results {
    /// Name of the command.
    command: &'static str,
    /// Version of the program.
    version: &'static str,
    /// Name of the study.
    #[serde(skip_serializing_if = "Option::is_none")]
    study: Option<String>,
    /// What it would take, of a dry run.
    #[serde(skip_serializing_if = "Option::is_none")]
    estimate: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    springs: Option<Springs>,
    /// Load cases on the simple model.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    runs: Vec<Run>,
    #[serde(skip_serializing_if = "Option::is_none")]
    crosscheck: Option<Crosscheck>,
    #[serde(skip_serializing_if = "Option::is_none")]
    verdict: Option<Verdict>,
    /// What only this command has.
    #[serde(skip_serializing_if = "Option::is_none")]
    more: Option<Value>,
    /// The same for a reader.
    #[serde(skip)]
    said: Vec<String>,
    /// The file to be opened first, or the folder of all files.
    #[serde(skip_serializing_if = "Option::is_none")]
    path: Option<String>,
    /// What is wrong, if the command could not be done.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    errors: Vec<String>,
    exit_code: u8,
}

/// The springs in use.
#[derive(Debug, Serialize)]
struct Springs {
    /// What the displacement of the law is measured against.
    reference: String,
    #[serde(flatten)]
    law: LawRecord,
    /// Errors of the published form, and which form holds best.
    #[serde(skip_serializing_if = "Option::is_none")]
    forms: Option<String>,
    horizontal_kn_per_m: Option<f64>,
    /// Smallest and largest preload of the horizontal stiffness.
    horizontal_range_kn: Option<[f64; 2]>,
    error_band: Option<Band>,
    /// What was assumed of measured profiles.
    #[serde(skip_serializing_if = "Option::is_none")]
    assumed: Option<AssumedRecord>,
    /// Uncertainty of the springs by inputs that are not known exactly.
    #[serde(skip_serializing_if = "Option::is_none")]
    input_uncertainty: Option<InputUncertaintyRecord>,
    /// Why loads of the study are left out, or why the horizontal stiffness or the error band is missing.
    missing: Vec<String>,
}

/// Uncertainty of springs: half the widths of their bands, relative.
#[derive(Debug, Serialize)]
struct Band {
    displacement: Option<f64>,
    tangent: Option<f64>,
    horizontal: Option<f64>,
}

/// A load case on the simple model.
#[derive(Debug, Serialize)]
struct Run {
    scenario: String,
    #[serde(flatten)]
    record: RunRecord,
}

/// The verdict with all its lines.
#[derive(Debug, Serialize)]
struct Verdict {
    holds: bool,
    /// How many limits there are.
    limits: usize,
    /// How many hold by themselves.
    hold: usize,
    /// How many hold by the uncertainty of the solid model alone.
    hold_by_solid: usize,
    /// How many fail.
    fail: usize,
    /// Both verdicts in words: the one that decides first.
    verdicts: Vec<VerdictOn>,
    /// Limits that are not the default ones.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    changed_limits: Vec<ChangedLimit>,
    /// The verdict in a sentence.
    headline: String,
    lines: Vec<About<verify::Line>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    not_applicable: Vec<About<NotApplicable>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    notes: Vec<VerdictNote>,
    /// What a reader sees of the lines that fail, the worst first.
    #[serde(skip)]
    worst: Vec<String>,
}

/// A part of the verdict; its subject is `springs`, `element` or a load case.
#[derive(Debug, Serialize)]
struct About<T> {
    subject: String,
    #[serde(flatten)]
    part: T,
}

impl<T: Clone> About<T> {
    fn of((subject, part): (&str, &T)) -> Self {
        Self { subject: subject.into(), part: part.clone() }
    }
}

#[derive(Debug, Serialize)]
struct VerdictNote {
    subject: String,
    note: String,
}

/// The largest differences of a cross-check.
#[derive(Debug, Serialize)]
struct Crosscheck {
    holds: bool,
    /// The worst check of each quantity, and whether all checks of it hold.
    worst: Vec<(Check, bool)>,
}

impl Results {
    /// Nothing yet.
    pub fn of(command: &'static str) -> Self {
        Self { command, version: env!("CARGO_PKG_VERSION"), ..Self::default() }
    }

    /// The same of a study.
    pub fn of_study(self, name: &str) -> Self {
        Self { study: Some(name.into()), ..self }
    }

    /// With springs and verdict, and all that a command has found of a study besides.
    pub fn with(mut self, found: &Found) -> Self {
        self.springs = found.stiffness.as_ref().map(Springs::of);
        self.verdict = found.verdict.as_ref().map(Verdict::of);
        let run =
            |(name, record): &(String, RunRecord)| Run { scenario: name.clone(), record: record.clone() };
        self.runs = found.runs.iter().map(run).collect();
        self
    }

    /// With the largest differences of a cross-check.
    pub fn with_crosscheck(self, record: &CrosscheckRecord) -> Self {
        let worst = record.worst().into_iter().map(|(check, holds)| (check.clone(), holds)).collect();
        Self { crosscheck: Some(Crosscheck { holds: record.holds, worst }), ..self }
    }

    /// With what the study would take.
    pub fn with_estimate(self, estimate: &Estimate) -> Self {
        Self { estimate: Some(estimate.json()), said: vec![estimate.text()], ..self }
    }

    /// With what only this command has: `said` to a reader, `more` to a program.
    pub fn with_more(mut self, said: Vec<String>, more: Value) -> Self {
        self.said.extend(said);
        self.more = Some(more);
        self
    }

    /// With the place of its files.
    pub fn at(self, path: &Path) -> Self {
        Self { path: Some(path.display().to_string()), ..self }
    }

    /// With what is wrong.
    pub fn failed(self, errors: Vec<String>, exit_code: u8) -> Self {
        Self { errors, exit_code, ..self }
    }

    /// With whether all holds.
    pub fn holding(self, holds: bool) -> Self {
        Self { exit_code: u8::from(!holds), ..self }
    }

    /// Prints them: as JSON, or as lines unless it is to be quiet.
    ///
    /// # Errors
    /// Those of [`say`].
    pub fn print(&self, json: bool, quiet: bool) -> Result<(), Error> {
        if json {
            return say(&serde_json::to_string_pretty(self).expect("results are plain data"));
        }
        if quiet {
            return Ok(());
        }
        self.lines().iter().try_for_each(say_line)
    }

    /// The lines for a reader.
    fn lines(&self) -> Vec<Line> {
        let mut lines: Vec<Line> = self.said.iter().map(Line::plain).collect();
        lines.extend(self.runs.iter().flat_map(Run::lines));
        lines.extend(self.crosscheck.iter().flat_map(Crosscheck::lines));
        lines.extend(self.verdict.iter().flat_map(Verdict::remarks));
        lines.extend(self.springs.iter().flat_map(Springs::lines));
        lines.extend(self.verdict.iter().flat_map(Verdict::lines));
        lines.extend(self.springs.iter().flat_map(Springs::assumptions));
        lines.extend(self.path.iter().map(Line::plain));
        lines
    }
}

impl Springs {
    fn of(stiffness: &StiffnessRecord) -> Self {
        let horizontal = stiffness.horizontal.as_ref();
        let ends = horizontal.and_then(|h| Some((h.points.first()?, h.points.last()?)));
        let missing =
            stiffness.horizontal_missing.iter().map(|why| format!("no horizontal stiffness: {why}"));
        let unsure = stiffness.findings_left().into_iter().map(|left| format!("unresolved finding: {left}"));
        // the bands name them already
        let left = unsure.filter(|_| stiffness.error_band.is_none());
        let unbanded = stiffness.error_band.iter().flat_map(|band| &band.missing);
        let unbanded = unbanded.map(|part| format!("no error band: {part}"));
        let band = stiffness.error_band.as_ref().map(|band| band.of(&stiffness.reference));
        Self {
            reference: stiffness.reference.clone(),
            law: stiffness.law,
            forms: stiffness.forms_in_a_line(),
            horizontal_kn_per_m: stiffness.horizontal_kn_per_m,
            horizontal_range_kn: ends.map(|(first, last)| [first.preload_kn, last.preload_kn]),
            error_band: band.map(|band| Band {
                displacement: band.and_then(|band| band.displacement),
                tangent: band.and_then(|band| band.tangent),
                horizontal: horizontal.and_then(|h| h.error_band.as_ref()?.band),
            }),
            assumed: stiffness.assumed.clone(),
            input_uncertainty: stiffness.input_uncertainty.clone(),
            missing: stiffness.shortened().into_iter().chain(missing).chain(unbanded).chain(left).collect(),
        }
    }

    fn lines(&self) -> Vec<Line> {
        let LawRecord { constants, at_bound, range_kn: [least, most], .. } = self.law;
        let law = self.law;
        let constant = |name: &str, value: f64, error: f64, bound: bool, unit: &str| {
            let text = match (bound, rounded_to(value, error)) {
                (true, _) => format!("{}{unit}, at its bound", significant(value, 6)),
                (false, (value, Some(error))) => format!("{value} \u{b1} {error}{unit}"),
                (false, (value, None)) => format!("{value}{unit}"),
            };
            Line::plain(format!("  {name:<4} {text}"))
        };
        let percent = |value: f64| significant(1e2 * value, 2);
        let mut lines = vec![
            heading(
                "law",
                format!(
                    "k(f) = a + b\u{b7}(f/f0)^c from {least} to {most} kN, displacement against {}",
                    self.reference
                ),
            ),
            constant("a", constants.a_kn_per_m, law.a_standard_error_kn_per_m, at_bound.a, " kN/m"),
            constant("b", constants.b_kn_per_m, law.b_standard_error_kn_per_m, at_bound.b, " kN/m"),
            constant("c", constants.c, law.c_standard_error, at_bound.c, ""),
            Line::plain(format!("  f0   {} kN", constants.f0_kn)),
            Line::plain(format!(
                "  error against the tangents of the solid: {} % (RMS), {} % at most",
                percent(law.rms_rel_error),
                percent(law.max_rel_error)
            )),
        ];
        lines.extend(self.forms.iter().map(|forms| heading("forms", forms.clone())));
        let range = self.horizontal_range_kn.map_or_else(String::new, |[least, most]| {
            format!(", mean under sticking from {least} to {most} kN")
        });
        lines.extend(self.horizontal_kn_per_m.map(|stiffness| {
            heading("horizontal stiffness", format!("k_h = {} kN/m{range}", significant(stiffness, 4)))
        }));
        lines.push(heading("error band", self.band()));
        let uncertain = self.input_uncertainty.iter().flat_map(InputUncertaintyRecord::sentences);
        lines.extend(uncertain.map(Line::plain));
        let missing = |text: &String| Line::of(Tone::Bad, "missing:").then(Tone::Plain, format!(" {text}"));
        lines.extend(self.missing.iter().map(missing));
        lines
    }

    /// What was assumed, how far the springs may be off for it, and the keys that say it otherwise.
    fn assumptions(&self) -> Vec<Line> {
        let of = |assumed: &AssumedRecord| {
            [assumed.sentence(), assumed.range(&self.reference), assumed.given_by()]
        };
        self.assumed.iter().flat_map(of).map(Line::plain).collect()
    }

    fn band(&self) -> String {
        let Some(band) = &self.error_band else { return "not asked for (calibration.error_band)".into() };
        let part = |what: &str, value: Option<f64>| match value {
            Some(value) => format!("{what} \u{b1}{} %", significant(1e2 * value, 2)),
            None => format!("{what} unknown"),
        };
        let horizontal = self.horizontal_kn_per_m.map(|_| part(", horizontal stiffness", band.horizontal));
        format!(
            "{}, {}{}",
            part("displacement", band.displacement),
            part("tangent", band.tangent),
            horizontal.unwrap_or_default()
        )
    }
}

impl Run {
    fn lines(&self) -> Vec<Line> {
        let Self { scenario, record } = self;
        let ending = record.ending().map_or_else(|| record.ending.clone(), |ending| ending.to_string());
        let notes = record.springs.iter().flat_map(|springs| &springs.notes).chain(&record.notes);
        let notes = notes.map(|note| Line::plain(format!("note   {scenario}: {note}")));
        notes.chain([Line::of(Tone::Heading, scenario).then(Tone::Plain, format!(": {ending}"))]).collect()
    }
}

impl Verdict {
    fn of(record: &VerificationRecord) -> Self {
        let lines: Vec<_> = record.lines().map(About::of).collect();
        let [hold, hold_by_solid, fail] = record.counts(record.decides);
        let note = |(subject, note): (&str, String)| VerdictNote { subject: subject.into(), note };
        Self {
            holds: record.holds,
            limits: lines.len(),
            hold,
            hold_by_solid,
            fail,
            verdicts: record.verdicts.clone(),
            changed_limits: record.changed_limits.clone(),
            headline: record.headline(),
            lines,
            not_applicable: record.not_applicable().map(About::of).collect(),
            notes: record.notes().map(note).collect(),
            worst: record.failing().iter().map(|(subject, line)| failure(subject, line)).collect(),
        }
    }

    /// What could not be compared and what has to be known.
    fn remarks(&self) -> Vec<Line> {
        let gaps = self.not_applicable.iter().map(|About { subject, part: gap }| {
            Line::plain(format!("n/a    {subject}: {}: {}", gap.meaning, gap.reason))
        });
        let note =
            |VerdictNote { subject, note }: &VerdictNote| Line::plain(format!("note   {subject}: {note}"));
        gaps.chain(self.notes.iter().map(note)).collect()
    }

    fn lines(&self) -> Vec<Line> {
        let tone = if self.holds { Tone::Good } else { Tone::Bad };
        let mut lines = vec![
            Line::of(Tone::Heading, "verdict:").then(Tone::Plain, " ").then(tone, self.headline.clone()),
        ];
        let fails =
            |text: &String| Line::plain("  ").then(Tone::Bad, "FAILS").then(Tone::Plain, format!("  {text}"));
        lines.extend(self.worst.iter().take(WORST).map(fails));
        if let more @ 1.. = self.worst.len().saturating_sub(WORST) {
            lines.push(Line::plain(format!("  and {more} more: see the report, or --json")));
        }
        // the counts of the one that decides stand in the headline
        lines.extend(self.verdicts.iter().enumerate().map(|(n, of)| match n {
            0 => Line::plain(format!("  {}", of.uses())),
            _ => heading(of.on.name(), format!("{}; {}", of.counts(), of.uses())),
        }));
        lines.extend(self.changed_limits.iter().map(|limit| {
            let tone = if limit.is_looser() { Tone::Bad } else { Tone::Plain };
            Line::of(Tone::Heading, "limit of the study:")
                .then(Tone::Plain, " ")
                .then(tone, limit.to_string())
        }));
        lines
    }
}

/// A line of a group with its name.
fn heading(name: &str, text: String) -> Line {
    Line::of(Tone::Heading, format!("{name}:")).then(Tone::Plain, format!(" {text}"))
}

/// A line of the verdict that fails, in words.
fn failure(subject: &str, line: &verify::Line) -> String {
    let (value, limit) = (with_unit(line.value, &line.unit), with_unit(Some(line.limit), &line.unit));
    let uncertainty = [("solid", line.solid_uncertainty), ("simple", line.simple_uncertainty)];
    let uncertainty = uncertainty.into_iter().filter_map(|(model, uncertainty)| {
        Some(format!(", uncertainty of the {model} model {}", with_unit(Some(uncertainty?), &line.unit)))
    });
    let uncertainty: String = uncertainty.collect();
    let over = line.over().map_or_else(String::new, |over| format!("; {over}"));
    let note = line.note.as_ref().map_or_else(String::new, |note| format!("; {note}"));
    format!("{subject}: {} {value} (limit {limit}{uncertainty}){over}{note}", line.meaning)
}

impl Crosscheck {
    fn lines(&self) -> Vec<Line> {
        let line = |(check, holds): &(Check, bool)| {
            let (tone, word) = if *holds { (Tone::Good, "holds") } else { (Tone::Bad, "FAILS") };
            let load = check.load_kn.map_or_else(String::new, |load| format!(" at {load} kN"));
            Line::of(tone, word).then(
                Tone::Plain,
                format!(
                    "  {}: {}: {:.2e}{load} (limit {:.0e})",
                    check.problem, check.quantity, check.difference, check.limit
                ),
            )
        };
        self.worst.iter().map(line).collect()
    }
}
