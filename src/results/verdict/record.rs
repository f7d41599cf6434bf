//! `verification.json`: the verdict.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::results::run::record::RunRecord;
use crate::results::verdict::input_bands::InputBands;
use crate::results::verdict::validation::ValidationRecord;
use crate::rounding::with_unit;
use crate::study::ContactElementKey;
use crate::verify::{
    Both, ChangedLimit, Compared, Comparison, HeldBy, Line, NotApplicable, RunningStatistics,
};

/// Subject of the lines on what the intended use asks for.
pub(crate) const INTENDED_USE: &str = "intended use";

/// `verification.json`: the verdict.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VerificationRecord {
    /// Name of the study.
    pub study: String,
    /// Whether every line of the verdict that decides holds; the exit code says so.
    pub holds: bool,
    /// Which of the verdicts that is: on what the load cases ran with, or without load cases on the springs.
    #[serde(default)]
    pub decides: VerdictSubject,
    /// The verdicts in words: the condensed and the lumped element, if the study has them, and the springs.
    #[serde(default)]
    pub verdicts: Vec<VerdictOn>,
    /// Limits of the study that are not the default ones.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changed_limits: Vec<ChangedLimit>,
    /// Lines on what the intended use of the springs asks for; they belong to every verdict.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub requirements: Vec<Line>,
    /// The law beside a measured curve, if the study names one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub validation: Option<ValidationRecord>,
    /// Lines on the springs themselves.
    pub calibration: Vec<Line>,
    /// Lines on the condensed element under static loads.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub statics: Vec<Line>,
    /// The same on the lumped element.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lumped_statics: Vec<Line>,
    /// The load cases.
    pub scenarios: Vec<ScenarioVerdict>,
    /// The files that were compared, each with the BLAKE3 hash of its content.
    pub inputs: BTreeMap<String, String>,
    /// Hash of the inputs and the limits.
    pub input_hash: String,
    /// Version of the program that made this.
    pub version: String,
    /// The commit that this program was built from.
    #[serde(default)]
    pub commit: String,
}

/// What a verdict is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum VerdictSubject {
    /// The condensed contact element: its statics, and the load cases with it.
    Element,
    /// The lumped contact element that other programs can enter: its statics, and the load cases with it.
    Lumped,
    /// The springs that other programs take: the law, the horizontal stiffness, and the load cases with the published element.
    #[default]
    Springs,
}

impl VerdictSubject {
    /// All of them.
    pub(crate) const ALL: [Self; 3] = [Self::Element, Self::Lumped, Self::Springs];

    /// Its name in lists.
    pub fn name(self) -> &'static str {
        match self {
            Self::Element => "element",
            Self::Lumped => "lumped",
            Self::Springs => "springs",
        }
    }

    /// The contact element of its load cases.
    pub(crate) fn contact_element(self) -> ContactElementKey {
        match self {
            Self::Element => ContactElementKey::Condensed,
            Self::Lumped => ContactElementKey::Lumped,
            Self::Springs => ContactElementKey::Published,
        }
    }
}

/// A verdict in words, with its lines counted.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct VerdictOn {
    /// What it is on.
    pub on: VerdictSubject,
    /// Lines within their limits.
    pub hold: usize,
    /// Lines beyond their limits, by no more than the numerical uncertainty of the solid model.
    pub hold_by_solid: usize,
    /// Lines that fail.
    pub fail: usize,
    /// Loads and uses for which it holds.
    pub holds_for: Vec<String>,
    /// Those for which it does not, each with the reason.
    pub not_for: Vec<String>,
}

impl VerdictOn {
    /// The lines, counted.
    pub fn counts(&self) -> String {
        format!(
            "{} hold, {} hold only within the solid's numerical uncertainty, {} fail",
            self.hold, self.hold_by_solid, self.fail
        )
    }

    /// Loads and uses for which it holds and for which it does not.
    pub fn uses(&self) -> String {
        let listed = |what: &str, of: &[String]| match of.is_empty() {
            true => None,
            false => Some(format!("{what} {}", of.join(", "))),
        };
        let parts = [listed("for", &self.holds_for), listed("not for", &self.not_for)];
        parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
    }
}

impl std::fmt::Display for VerdictOn {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{}: {}", self.on.name(), self.counts())?;
        let uses = self.uses();
        if uses.is_empty() { Ok(()) } else { write!(f, "; {uses}") }
    }
}

/// The verdict on one load case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ScenarioVerdict {
    /// Name of the scenario.
    pub scenario: String,
    /// The run of the simple model.
    pub simple: RunRecord,
    /// The run of the solid model, if it ran.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solid: Option<RunRecord>,
    /// The lines.
    pub lines: Vec<Line>,
    /// What could not be compared.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_applicable: Vec<NotApplicable>,
    /// The quantities that were compared, if both models ran.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compared: Option<Compared>,
    /// Statistics by EN 14363 of both models; none of a model that did not run, whose steps are unequal or longer than 5 ms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub running: Option<Both<Option<RunningStatistics>>>,
    /// The contact elements of the simple model, that of the study first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub elements: Vec<ElementVerdict>,
    /// What uncertain inputs change, beside the difference of the models.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub input_uncertainty: Option<InputBands>,
    /// Why that is not known, if so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub input_uncertainty_missing: Option<String>,
}

/// A contact element of the simple model on one load case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ElementVerdict {
    /// `condensed`, `lumped` or `published`.
    pub element: String,
    /// The run of an element that the study has not chosen; that of the chosen one is `simple`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub run: Option<RunRecord>,
    /// Why the element has no run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub missing: Option<String>,
    /// How far it is from the solid, if both ran.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub differences: Option<ElementDifferences>,
    /// The lines on an element that the study has not chosen; those of the chosen one are the load case's.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lines: Vec<Line>,
}

impl ElementVerdict {
    /// That of an element of which nothing is known.
    pub fn of(element: ContactElementKey) -> Self {
        let element = element.name().into();
        Self { element, run: None, missing: None, differences: None, lines: Vec::new() }
    }
}

/// Differences of an element from the solid model, as the lines of a verdict have them; as long as the motion of the solid is determined.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ElementDifferences {
    /// Vertical force, RMS over the solid's peak.
    pub vertical_rms: Option<f64>,
    /// Lateral force, RMS over the solid's peak.
    pub lateral_rms: Option<f64>,
    /// Averaged Q/P, RMS.
    pub ratio_rms: Option<f64>,
    /// Averaged Q/P, largest.
    pub ratio_max: Option<f64>,
    /// Separations that only one of the two has.
    pub separations_unmatched: Option<f64>,
    /// By how much separations of both begin at another time at most, s; none where there are none.
    pub separation_begin_s: Option<f64>,
    /// By how much they end at another time at most, s.
    pub separation_end_s: Option<f64>,
    /// Over what time forces were compared, s.
    pub over_s: Option<[f64; 2]>,
}

impl From<&Comparison> for ElementDifferences {
    fn from(comparison: &Comparison) -> Self {
        let line = |quantity: &str| comparison.lines.iter().find(|line| line.quantity == quantity);
        let value = |quantity: &str| line(quantity)?.value;
        Self {
            vertical_rms: value("vertical_rms"),
            lateral_rms: value("lateral_rms"),
            ratio_rms: value("ratio_rms"),
            ratio_max: value("ratio_max"),
            separations_unmatched: value("separations_unmatched"),
            separation_begin_s: value("separation_begin_s"),
            separation_end_s: value("separation_end_s"),
            over_s: line("vertical_rms").and_then(|line| line.over_s),
        }
    }
}

impl ScenarioVerdict {
    /// The lines on a contact element; none where it did not run.
    fn lines_of(&self, element: ContactElementKey) -> &[Line] {
        match self.elements.iter().position(|of| of.element == element.name()) {
            Some(0) => &self.lines,
            Some(n) => &self.elements[n].lines,
            None if self.elements.is_empty() => &self.lines,
            None => &[],
        }
    }
}

impl VerificationRecord {
    /// The lines of the verdict that decides, with their subjects: `intended use`, `springs`, `element` or `lumped`, then the scenarios.
    pub fn lines(&self) -> impl Iterator<Item = (&str, &Line)> {
        self.lines_on(self.decides)
    }

    /// The lines of a verdict with their subjects.
    pub fn lines_on(&self, on: VerdictSubject) -> impl Iterator<Item = (&str, &Line)> {
        let statics = match on {
            VerdictSubject::Element => &self.statics,
            VerdictSubject::Lumped => &self.lumped_statics,
            VerdictSubject::Springs => &self.calibration,
        };
        let scenarios = self.scenarios.iter().flat_map(move |s| {
            let lines = s.lines_of(on.contact_element());
            lines.iter().map(|line| (s.scenario.as_str(), line))
        });
        let requirements = self.requirements.iter().map(|line| (INTENDED_USE, line));
        requirements.chain(statics.iter().map(move |line| (on.name(), line))).chain(scenarios)
    }

    /// What could not be compared, with the scenarios.
    pub fn not_applicable(&self) -> impl Iterator<Item = (&str, &NotApplicable)> {
        self.scenarios.iter().flat_map(|s| s.not_applicable.iter().map(|item| (s.scenario.as_str(), item)))
    }

    /// What has to be known about the runs, with the scenarios.
    pub fn notes(&self) -> impl Iterator<Item = (&str, String)> {
        self.scenarios.iter().flat_map(|s| {
            let springs = s.simple.springs.iter().flat_map(|springs| &springs.notes);
            let solid = s.solid.iter().flat_map(|run| &run.notes);
            let inputs = s.input_uncertainty.iter().map(InputBands::note);
            let runs = springs.chain(&s.simple.notes).chain(solid).cloned();
            runs.chain(inputs).map(|note| (s.scenario.as_str(), note))
        })
    }

    /// The lines that fail with their subjects, the worst first; equals in their order, so that the list is the same every time.
    pub fn failing(&self) -> Vec<(&str, &Line)> {
        let mut failing: Vec<_> = self.lines().filter(|(_, line)| !line.holds).collect();
        failing.sort_by(|a, b| b.1.excess().total_cmp(&a.1.excess()));
        failing
    }

    /// Lines of a verdict that hold within their limits, that hold by the solid's uncertainty, and that fail.
    pub fn counts(&self, on: VerdictSubject) -> [usize; 3] {
        let mut counts = [0; 3];
        for (_, line) in self.lines_on(on) {
            counts[match line.held_by {
                Some(HeldBy::Limit) => 0,
                Some(HeldBy::SolidUncertainty) => 1,
                None => 2,
            }] += 1;
        }
        counts
    }

    /// How many lines of the verdict that decides hold by their limits, hold by the solid's uncertainty, and fail; and over how many load cases both
    /// models were compared.
    pub fn headline(&self) -> String {
        let compared = self.scenarios.iter().filter(|s| s.compared.is_some()).count();
        let scope = match compared {
            0 => "; no load case was compared with the solid model".into(),
            1 => String::new(),
            n => format!("; {n} load cases compared with the solid model"),
        };
        let [hold, hold_by_solid, fail] = self.counts(self.decides);
        let name = self.decides.name();
        format!(
            "{name}: {hold} hold, {hold_by_solid} hold only within the solid's numerical uncertainty, {fail} fail{scope}"
        )
    }

    /// The verdict in a sentence: how many limits fail, and which one most.
    pub fn summary(&self) -> String {
        let headline = self.headline();
        match self.failing().first() {
            None => headline,
            Some((subject, line)) => format!(
                "{headline}; worst: {subject}: {} {} (limit {}{})",
                line.meaning,
                with_unit(line.value, &line.unit),
                with_unit(Some(line.limit), &line.unit),
                line.solid_uncertainty.filter(|uncertainty| *uncertainty > line.limit).map_or_else(
                    String::new,
                    |uncertainty| {
                        format!(
                            ", uncertainty of the solid model {}",
                            with_unit(Some(uncertainty), &line.unit)
                        )
                    }
                )
            ),
        }
    }
}
