//! The report: one self-contained page and its figures.
//!
//! Everything the page shows comes in through [`ReportData`]; nothing is
//! computed here but what a picture or a table needs.

pub mod plot;
mod legend;
pub mod panel;
pub(crate) mod tables;
pub(crate) mod html;
pub(crate) mod figures;
pub(crate) mod accessible;
mod reasons;
mod first_screen;
mod load_case;
mod by_angle;
mod statics;
mod positions;
mod patches;
mod patch_section;
pub mod measured;
pub mod bodies;
pub mod catalogue;
pub mod crosscheck;

use railspring_simulate::time::history::History;
use serde::Serialize;
use serde_json::{Value, json};

use crate::records::{
    LoadCurveRow, Measured, PatchesRecord, ResolvedKey, StiffnessByAngleRecord, StiffnessRecord,
    VerificationRecord,
};

use crate::verify::{Band, Carrying};

pub use figures::WIDTH;
pub use positions::ProfilePair;

/// A run of a model, as figures show it.
#[derive(Debug, Clone, Copy)]
pub struct ModelRun<'a> {
    /// What figures call it: `solid`, or the contact element of the simple model.
    pub name: &'a str,
    /// The run.
    pub history: &'a History,
    /// Where its averaged P carries Q/P.
    pub carrying: Carrying,
}

/// The runs of one scenario.
#[derive(Debug, Clone)]
pub struct ScenarioRun<'a> {
    /// Name of the scenario.
    pub name: &'a str,
    /// What happens in it.
    pub description: &'a str,
    /// Times of the pictures of the contact positions, s.
    pub snapshots: &'a [f64],
    /// The simple model's runs: with the study's contact element, then with the other one, if that ran.
    pub elements: Vec<ModelRun<'a>>,
    /// The solid model's run, if it ran.
    pub solid: Option<ModelRun<'a>>,
    /// What the solid's run is worth at each of its times, if that is known.
    pub band: Option<Band>,
}

/// Everything the report shows.
#[derive(Debug, Clone)]
pub struct ReportData<'a> {
    /// Name of the study.
    pub name: &'a str,
    /// What the study is about.
    pub description: &'a str,
    /// File of the study, without its folders, and the BLAKE3 hash of its text; none of both for a study without a file.
    pub file: Option<(String, String)>,
    /// The study's keys.
    pub inputs: &'a [ResolvedKey],
    /// The springs.
    pub stiffness: &'a StiffnessRecord,
    /// The load curve with the reference in use.
    pub load_curve: &'a [LoadCurveRow],
    /// The contact patches under some loads.
    pub patches: &'a PatchesRecord,
    /// The laws by contact angle, if there are any.
    pub by_angle: Option<&'a StiffnessByAngleRecord>,
    /// The two profiles.
    pub profiles: &'a ProfilePair,
    /// The measured profiles on their standards.
    pub surfaces: &'a [measured::OnStandard],
    /// The outlines of both bodies, rail first.
    pub bodies: &'a [bodies::BodyOutline; 2],
    /// The load cases.
    pub scenarios: Vec<ScenarioRun<'a>>,
    /// Time over which Q and P are averaged, s.
    pub ratio_window: f64,
    /// The verdict.
    pub verdict: &'a VerificationRecord,
    /// The programs that made the files which the report is from.
    pub programs: &'a [String],
    /// Time, memory, host.
    pub measured: &'a Measured,
    /// What independent programs say.
    pub crosscheck: crosscheck::Crosscheck<'a>,
}

/// The page and its figures.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// `report.html`, with the figures inside.
    pub html: String,
    /// The figures by name, as SVG.
    pub figures: Vec<(String, String)>,
}

/// A figure as the page shows it.
#[derive(Debug, Clone, Serialize)]
struct Figure {
    svg: String,
    caption: String,
    number: usize,
}

/// Builds the page and its figures.
pub fn build(data: &ReportData<'_>) -> Report {
    let mut stiffness = data.stiffness.clone();
    figures::in_order(&mut stiffness.references);
    let mut collected = Collector::default();
    let mut springs = vec![
        collected.add("law", figures::law(&stiffness), tables::law_caption(&stiffness)),
        collected.add(
            "displacement",
            figures::displacement(&stiffness),
            "Load over displacement of the solid with each reference, of Hertz for the curvatures at the first touch, which is the contact alone and belongs to the reference local, and of the published law.".into(),
        ),
        collected.add(
            "compliance",
            figures::compliance(&stiffness.compliance_split),
            "Parts of the tangent compliance. Local contact, wheel body and rail body together are the law in use; all parts together are the solid between the hub and the support of the rail. A part is a difference of two compliances; one left of zero is negative and takes back what the parts beside it have too much, as where the beam bends more than the solid rail.".into(),
        ),
        collected.add(
            "patch",
            figures::patch(data.load_curve, stiffness.touch.hertz),
            "Semi-axes of the contact patch and largest pressure in the solid, and of Hertz for the curvatures at the first touch.".into(),
        ),
    ];
    springs.push(collected.add(
        "patch_fields",
        patches::fields(data.patches, stiffness.touch.hertz),
        patches::fields_caption(data.patches, stiffness.touch.hertz.is_some()),
    ));
    springs.push(collected.add(
        "patch_sections",
        patch_section::section(data.patches, data.profiles, stiffness.touch.hertz),
        patch_section::caption(data.patches, stiffness.touch.hertz.is_some()),
    ));
    if let Some(stresses) = figures::subsurface(data.load_curve, &data.patches.patches) {
        springs.push(collected.add("subsurface", stresses, patches::below_caption(data.patches)));
    }
    if let (Some(horizontal), Some(constant)) = (&stiffness.horizontal, stiffness.horizontal_kn_per_m) {
        springs.push(collected.add(
            "horizontal",
            figures::horizontal(horizontal, constant),
            figures::horizontal_caption(horizontal),
        ));
    }
    if let Some(laws) = data.by_angle {
        springs.push(collected.add("by_angle", by_angle::stiffness(laws), by_angle::caption(laws)));
        if let Some(figure) = statics::statics(laws) {
            springs.push(collected.add("statics", figure, statics::caption(laws)));
        }
    }
    let scenarios: Vec<Value> =
        data.scenarios.iter().map(|run| scenario(run, data, &mut collected)).collect();
    let chapter = crosscheck::chapter(&data.crosscheck, &mut collected);
    let assumed_bodies = stiffness.assumed.as_ref().map(|record| {
        let caption = bodies::caption(&record.sentence());
        collected.add("assumed-bodies", bodies::figure(figures::WIDTH, data.bodies), caption)
    });
    let surfaces: Vec<Value> = data.surfaces.iter().map(|of| surface(of, &mut collected)).collect();
    let html = html::render(
        "report.html",
        json!({
            "name": data.name,
            "description": data.description,
            "first": first_screen::first_screen(data),
            "file": data.file,
            "constants": stiffness.references.iter().map(|r| first_screen::constants(&r.law)).collect::<Vec<_>>(),
            "surfaces": surfaces,
            "inputs": tables::grouped(data.inputs),
            "stiffness": stiffness,
            "springs": springs,
            "horizontal": first_screen::horizontal(&stiffness),
            "shortened": stiffness.shortened(),
            "worth": tables::worth(&stiffness),
            "assumed": tables::assumed(&stiffness),
            "assumed_bodies": assumed_bodies,
            "worth_by_angle": data.by_angle.and_then(by_angle::worth),
            "scenarios": scenarios,
            "crosscheck": chapter,
            "lines": tables::lines(data.verdict),
            "not_applicable": data.verdict.not_applicable().collect::<Vec<_>>(),
            "notes": tables::notes(data.verdict),
            "verdict": data.verdict,
            "summary": data.verdict.summary(),
            "models": tables::models(data.verdict),
            "measured": data.measured,
        }),
    );
    Report { html, figures: collected.figures }
}

fn surface(of: &measured::OnStandard, collected: &mut Collector) -> Value {
    let drawn = measured::figure(figures::WIDTH, of, &[]);
    let figure = collected.add(&format!("measured-{}", of.body), drawn, measured::caption(of));
    json!({ "body": of.body, "figure": figure, "rows": of.rows() })
}

fn scenario(run: &ScenarioRun<'_>, data: &ReportData<'_>, collected: &mut Collector) -> Value {
    let judged = data.verdict.scenarios.iter().find(|s| s.scenario == run.name);
    let until = judged.and_then(|s| s.compared.as_ref()?.pointwise_until_s);
    let until = until.map_or_else(String::new, |time| {
        format!(
            " From {} ms on the motion of the solid is not determined, and statistics are compared.",
            tables::number(1e3 * time)
        )
    });
    let band = load_case::band_caption(run);
    let mut figures = Vec::new();
    let mut add = |kind: &str, svg: String, caption: String| {
        figures.push(collected.add(&format!("{kind}-{}", run.name), svg, caption));
    };
    add(
        "forces",
        load_case::forces(run),
        format!("Vertical and lateral force of the wheel on the rail.{band}{until}"),
    );
    add(
        "ratio",
        load_case::ratio(run, data.ratio_window),
        format!(
            "Derailment coefficient Q/P: Q and P averaged over a window of time before they are divided. Gaps: too little vertical force in the window for a ratio, beside what the forces are worth.{band}{until}"
        ),
    );
    add("wheel", load_case::wheel(run), "Displacement of the wheel centre.".into());
    add("modes", load_case::modes(run), "Contact modes on tread and flange.".into());
    for (n, element) in run.elements.iter().enumerate() {
        let kind = if n == 0 { "positions".into() } else { format!("positions_{}", element.name) };
        add(
            &kind,
            positions::positions(data.profiles, run.snapshots, element, run.solid.as_ref()),
            format!(
                "Contact positions on the two profiles, seen along the track, field side to the right. Wheel and rail as the simple model with the {} element has them; the rail's own deflection is not drawn.",
                element.name
            ),
        );
    }
    json!({
        "name": run.name,
        "description": run.description,
        "models": run.elements.iter().chain(&run.solid).map(|of| of.name).collect::<Vec<_>>(),
        "elements": judged.map(tables::elements),
        "missing": judged.map(tables::missing_elements),
        "figures": figures,
        "endings": tables::endings(run),
        "separations": tables::separations(run),
        "modes": tables::modes(run),
    })
}

/// Numbers the figures and keeps their files.
#[derive(Default)]
struct Collector {
    figures: Vec<(String, String)>,
}

impl Collector {
    fn add(&mut self, name: &str, svg: String, caption: String) -> Figure {
        let inline = accessible::inline(&svg, &caption);
        self.figures.push((name.to_string(), svg));
        Figure { svg: inline, caption, number: self.figures.len() }
    }
}

#[cfg(test)]
pub(crate) mod samples;
#[cfg(test)]
mod tests;
