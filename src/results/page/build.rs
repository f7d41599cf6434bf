//! The report: one self-contained page and its figures.
//!
//! Everything the page shows comes in through [`ReportData`]; nothing is
//! computed here but what a picture or a table needs.

use serde_json::{Value, json};

use super::annex::annex;
use super::data::ReportData;
use super::first_screen;
use crate::report::collector::Collector;
use crate::report::{html, number};
use crate::results::bodies::outline_figure;
use crate::results::bodies::surface_figure::{self, OnStandard};
use crate::results::by_angle::{self, statics_figure};
use crate::results::crosscheck;
use crate::results::patches::{self, section_figure};
use crate::results::run::figures::ScenarioRun;
use crate::results::run::{figures as figures_of_run, positions_figure};
use crate::results::springs::{figures, forms_figure, uncertainty_figure};
use crate::results::verdict::running_table::running;
use crate::results::verdict::tables;

/// The page and its figures.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// `report.html`, with the figures inside.
    pub html: String,
    /// The figures by name, as SVG.
    pub figures: Vec<(String, String)>,
}

/// Builds the page and its figures.
pub fn build(data: &ReportData<'_>) -> Report {
    let mut stiffness = data.stiffness.clone();
    figures::in_order(&mut stiffness.references);
    let mut collected = Collector::default();
    let mut springs = vec![
        collected.add("law", figures::law(&stiffness), tables::law_caption(&stiffness)),
        collected.add("forms", forms_figure::errors(&stiffness), forms_figure::caption(&stiffness)),
        collected.add(
            "displacement",
            figures::displacement(&stiffness),
            "Load over displacement of the solid with each reference, of Hertz for the curvatures at the first touch, which is the contact alone and belongs to the reference local, and of the published law.".into(),
        ),
        collected.add(
            "compliance",
            figures::compliance(&stiffness.compliance_split),
            "Parts of the tangent compliance. Local contact, wheel body and rail body together are the law in use; all parts together are the solid between the hub and the support of the rail. A part is a difference of two compliances. A negative one balances an excess of its neighbours, for instance where the beam bends more than the solid rail.".into(),
        ),
        collected.add(
            "patch",
            figures::patch(data.load_curve, stiffness.touch.hertz),
            "Semi-axes of the contact patch and largest pressure in the solid, with its error band, and of Hertz for the curvatures at the first touch.".into(),
        ),
    ];
    springs.push(collected.add(
        "patch_fields",
        patches::figure::fields(data.patches, stiffness.touch.hertz),
        patches::figure::fields_caption(data.patches, stiffness.touch.hertz.is_some()),
    ));
    springs.push(collected.add(
        "patch_sections",
        section_figure::section(data.patches, data.profiles, stiffness.touch.hertz),
        section_figure::caption(data.patches, stiffness.touch.hertz.is_some()),
    ));
    if let Some(stresses) = figures::subsurface(data.load_curve, &data.patches.patches) {
        springs.push(collected.add("subsurface", stresses, patches::figure::below_caption(data.patches)));
    }
    if let (Some(horizontal), Some(constant)) = (&stiffness.horizontal, stiffness.horizontal_kn_per_m) {
        springs.push(collected.add(
            "horizontal",
            figures::horizontal(horizontal, constant),
            figures::horizontal_caption(horizontal),
        ));
    }
    if let (Some(uncertain), Some(band)) =
        (&stiffness.input_uncertainty, uncertainty_figure::band(&stiffness))
    {
        springs.push(collected.add("uncertainty", band, uncertainty_figure::band_caption(uncertain)));
        if let Some(figure) = uncertainty_figure::inputs(uncertain) {
            let caption = uncertainty_figure::inputs_caption(uncertain);
            springs.push(collected.add("uncertain_inputs", figure, caption));
        }
    }
    if let Some(laws) = data.by_angle {
        springs.push(collected.add(
            "by_angle",
            by_angle::figure::stiffness(laws),
            by_angle::figure::caption(laws),
        ));
        if let Some(figure) = statics_figure::statics(laws) {
            springs.push(collected.add("statics", figure, statics_figure::caption(laws)));
        }
    }
    let scenarios: Vec<Value> =
        data.scenarios.iter().map(|run| scenario(run, data, &mut collected)).collect();
    let chapter = crosscheck::page::chapter(&data.crosscheck, &mut collected);
    let annex = annex(data, &chapter, &mut collected);
    let assumed_bodies = stiffness.assumed.as_ref().map(|record| {
        let caption = outline_figure::caption(&record.sentence());
        collected.add("assumed-bodies", outline_figure::figure(number::WIDTH, data.bodies), caption)
    });
    let surfaces: Vec<Value> = data.surfaces.iter().map(|of| surface(of, &mut collected)).collect();
    let html = html::render(
        "report.html",
        json!({
            "name": data.name,
            "description": data.description,
            "first": first_screen::first_screen(data),
            "file": data.file,
            "roll": stiffness.roll(),
            "constants": stiffness.references.iter().map(|r| first_screen::constants(&r.law)).collect::<Vec<_>>(),
            "surfaces": surfaces,
            "inputs": tables::grouped(data.inputs),
            "stiffness": stiffness,
            "springs": springs,
            "forms": forms_figure::table(&stiffness),
            "horizontal": first_screen::horizontal(&stiffness),
            "shortened": stiffness.shortened(),
            "law_errors": tables::law_errors(&stiffness),
            "uncertainty": uncertainty_figure::table(&stiffness),
            "assumed": tables::assumed(&stiffness),
            "assumed_bodies": assumed_bodies,
            "law_errors_by_angle": data.by_angle.and_then(by_angle::figure::law_errors),
            "lumped": data.by_angle.and_then(|laws| laws.lumped.as_ref()).map(by_angle::lumped_table::table),
            "scenarios": scenarios,
            "crosscheck": chapter,
            "annex": annex,
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

fn surface(of: &OnStandard, collected: &mut Collector) -> Value {
    let drawn = surface_figure::figure(number::WIDTH, of, &[]);
    let figure = collected.add(&format!("measured-{}", of.body), drawn, surface_figure::caption(of));
    json!({ "body": of.body, "figure": figure, "rows": of.rows() })
}

fn scenario(run: &ScenarioRun<'_>, data: &ReportData<'_>, collected: &mut Collector) -> Value {
    let judged = data.verdict.scenarios.iter().find(|s| s.scenario == run.name);
    let until = judged.and_then(|s| s.compared.as_ref()?.pointwise_until_s);
    let until = until.map_or_else(String::new, |time| {
        format!(
            " From {} ms on the motion of the solid is not determined, and statistics are compared.",
            number::number(1e3 * time)
        )
    });
    let band = figures_of_run::band_caption(run) + &figures_of_run::inputs_caption(run);
    let mut figures = Vec::new();
    let mut add = |kind: &str, svg: String, caption: String| {
        figures.push(collected.add(&format!("{kind}-{}", run.name), svg, caption));
    };
    add(
        "forces",
        figures_of_run::forces(run),
        format!("Vertical and lateral force of the wheel on the rail.{band}{until}"),
    );
    add(
        "ratio",
        figures_of_run::ratio(run, data.ratio_window),
        format!(
            "Derailment coefficient Q/P: Q and P averaged over a window of time before they are divided. Gaps: too little vertical force in the window for a ratio, beside the uncertainty of the forces.{band}{until}"
        ),
    );
    add("wheel", figures_of_run::wheel(run), "Displacement of the wheel centre.".into());
    add("modes", figures_of_run::modes(run), "Contact modes on tread and flange.".into());
    for (n, element) in run.elements.iter().enumerate() {
        let kind = if n == 0 { "positions".into() } else { format!("positions_{}", element.name) };
        add(
            &kind,
            positions_figure::positions(data.profiles, run.snapshots, element, run.solid.as_ref()),
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
        "inputs": judged.map(tables::inputs),
        "figures": figures,
        "endings": tables::endings(run),
        "separations": tables::separations(run),
        "modes": tables::modes(run),
        "running": judged.and_then(running),
    })
}

#[cfg(test)]
mod tests;
