//! The report from made-up results: complete, self-contained, well formed.

use railspring_simulate::time::history::History;

use super::*;
use crate::engine::seal::Sealed;
use crate::results::crosscheck::page::Crosscheck;
use crate::results::run::figures::ModelRun;
use crate::results::run::record::RunRecord;
use crate::results::samples;
use crate::results::springs::record::LoadEndRecord;
use crate::results::springs::record::StiffnessRecord;
use crate::results::verdict::input_bands::InputBands;
use crate::results::verdict::reasons::reason;
use crate::results::verdict::record::{
    ElementVerdict, ScenarioVerdict, VerdictOn, VerdictSubject, VerificationRecord,
};
use crate::rounding::significant;
use crate::study::{IntendedUseKeys, ReviewKeys};
use crate::verify::{self, Band, Carrying, ChangedLimit, Limits, NumericalUncertainty, Spread, compare};

fn build_sample() -> Report {
    let (record, sections) = (samples::crosscheck(), samples::sections());
    build_with(Crosscheck::Fresh(&record, &sections))
}

fn build_with(crosscheck: Crosscheck<'_>) -> Report {
    let (simple, solid, other) = (samples::history(0.001), samples::history(0.0), samples::history(0.004));
    let stiffness = samples::stiffness();
    let verdict = verdict(&simple, &solid);
    let (load_curve, profiles) = (samples::load_curve(), samples::profiles());
    let (inputs, measured) = (samples::inputs(), samples::measured());
    let laws = samples::by_angle();
    let patches = samples::patches();
    let intended_use = IntendedUseKeys { purpose: "Run-up in a curve.".into(), ..IntendedUseKeys::default() };
    let checks = samples::checks();
    build(&ReportData {
        name: "sample <study>",
        description: "Made-up numbers.",
        file: Some(("sample.toml".into(), "ef".repeat(32))),
        inputs: &inputs,
        intended_use: &intended_use,
        review: &ReviewKeys { reviewer: Some("A. Assessor".into()), ..ReviewKeys::default() },
        checks: &checks,
        stiffness: &stiffness,
        load_curve: &load_curve,
        patches: &patches,
        by_angle: Some(&laws),
        profiles: &profiles,
        surfaces: &[samples::surface()],
        bodies: &samples::bodies(),
        scenarios: vec![ScenarioRun {
            name: "sample",
            description: "Constant lateral force.",
            snapshots: &[0.0, 0.01, 0.2],
            elements: vec![drawn("condensed", &simple), drawn("published", &other)],
            solid: Some(drawn("solid", &solid)),
            band: Some(band(&solid)),
            uncertain: Some(&samples::uncertain_run()),
        }],
        ratio_window: 0.024,
        verdict: &verdict,
        programs: &["railspring 0.1.0 (commit 0123456789ab)".into()],
        measured: &measured,
        crosscheck,
    })
}

fn drawn<'a>(name: &'a str, history: &'a History) -> ModelRun<'a> {
    ModelRun { name, history, carrying: Carrying::EXACT }
}

/// The disturbed run of the solid, which is another one from 0.1 s on.
fn disturbed(solid: &History) -> (History, Spread) {
    let late = samples::history(0.002);
    let rows = |of: &History, rows: std::ops::Range<usize>| of.rows[rows].to_vec();
    let disturbed = History { rows: [rows(solid, 0..200), rows(&late, 200..551)].concat(), ..late };
    let spread = Spread::between(solid, &disturbed, "lateral force").unwrap();
    (disturbed, spread)
}

fn band(solid: &History) -> Band {
    let (disturbed, spread) = disturbed(solid);
    let run = verify::ModelRun { disturbed: Some((&disturbed, &spread)), ..verify::ModelRun::alone(solid) };
    Band::around(&run, &Limits::default()).unwrap()
}

fn verdict(simple: &History, solid: &History) -> VerificationRecord {
    let (disturbed, spread) = disturbed(solid);
    let uncertainty =
        |spread| NumericalUncertainty { steps: Err("made up".into()), spread, discretisation: Vec::new() };
    let alone = verify::ModelRun::alone;
    let model = verify::ModelRun { disturbed: Some((&disturbed, &spread)), ..alone(solid) };
    let comparison = compare(&alone(simple), &model, &Limits::default()).unwrap();
    let published = samples::history(0.004);
    let element = |element: &str, comparison: &verify::Comparison| ElementVerdict {
        element: element.into(),
        run: None,
        missing: None,
        differences: Some(comparison.into()),
        lines: if element == "published" { comparison.lines.clone() } else { Vec::new() },
    };
    let of_published = compare(&alone(&published), &model, &Limits::default()).unwrap();
    let elements = vec![element("condensed", &comparison), element("published", &of_published)];
    let unknown = uncertainty(Err("made up".into()));
    let scenario = ScenarioVerdict {
        scenario: "sample".into(),
        simple: RunRecord::new(simple, None, unknown, vec!["P leaves the range".into()]),
        solid: Some(RunRecord::new(solid, None, uncertainty(Ok(spread.clone())), Vec::new())),
        lines: comparison.lines,
        not_applicable: comparison.not_applicable,
        compared: Some(comparison.compared),
        running: Some(verify::Both {
            simple: verify::RunningStatistics::of(simple, 0.0),
            solid: verify::RunningStatistics::of(solid, 30.0),
        }),
        elements,
        input_uncertainty: InputBands::of(
            &samples::uncertain_run(),
            simple,
            (None, None),
            &Limits::default(),
        ),
        input_uncertainty_missing: None,
    };
    VerificationRecord {
        requirements: Vec::new(),
        validation: None,
        study: "sample".into(),
        holds: scenario.lines.iter().all(|line| line.holds),
        decides: VerdictSubject::Element,
        verdicts: vec![VerdictOn {
            on: VerdictSubject::Element,
            hold: 17,
            hold_by_solid: 3,
            fail: 2,
            holds_for: vec!["static loads from 20 to 120 kN".into()],
            not_for: vec!["load case sample: Q/P 0.07 off (limit 0.05)".into()],
        }],
        changed_limits: vec![ChangedLimit { key: "law_max".into(), limit: 0.4, default: 0.15 }],
        calibration: Vec::new(),
        statics: Vec::new(),
        lumped_statics: Vec::new(),
        scenarios: vec![scenario],
        inputs: [("history.csv".to_string(), "ab".repeat(32))].into(),
        input_hash: "cd".repeat(32),
        version: "0.1.0".into(),
        commit: "commit 0123456789ab".into(),
    }
}

#[test]
fn the_page_is_complete_and_needs_nothing_else() {
    let report = build_sample();
    // For looking at the figures: a folder named in the environment receives them.
    if let Some(folder) = std::env::var_os("RAILSPRING_SAMPLE_REPORT") {
        let folder = std::path::Path::new(&folder);
        std::fs::create_dir_all(folder).unwrap();
        std::fs::write(folder.join("report.html"), &report.html).unwrap();
        for (name, svg) in &report.figures {
            std::fs::write(folder.join(format!("{name}.svg")), svg).unwrap();
        }
    }
    assert_eq!(report.html.matches("<figure id=").count(), report.figures.len());
    assert_eq!(report.figures.len(), 25);
    assert!(!report.html.contains("could not be written"), "{}", report.html);
    assert!(!report.html.contains("figure failed"));
    for outside in ["src=\"", "@import", "url("] {
        assert!(!report.html.contains(outside), "the page refers to something outside: {outside}");
    }
    // the only link that leaves the page is to the page beside it
    assert_eq!(outward(&report.html), ["crosscheck.html"]);
    assert_eq!(report.html.matches("href=\"crosscheck.html\"").count(), 1);
    assert!(report.html.contains("sample &lt;study&gt;"), "texts are escaped");
    for word in [
        "verification",
        "P, RMS difference over the solid",
        "uncertainty of the solid",
        "of the wheel on the rail. Band: the numerical uncertainty of the solid, the change at each instant with an input that is 0.1 % larger, up to 275 ms. Light band: between 2.5 and 97.5 % at each instant of 64 quasi-random samples with the condensed element, 1 without a run, whose inputs depart by their uncertainties. From 100 ms on the motion of the solid is not determined",
        "P: inputs by \u{b1}",
        "<td>largest P, kN</td><td class=\"n\">73.0</td><td class=\"n\">70.0</td><td class=\"n\">78.0</td><td>inclination of the rail 80 %</td>",
        "<td class=\"line\">0 to 99.5 ms</td>",
        "<td class=\"line\">100 to 275 ms</td>",
        "peak memory",
        "scaled Jacobian",
        // the measured surface: what was changed, and where its parts meet
        "400 points read, 399 left after the repair, 1 of those read more than 0.01 mm off the surface; the largest change is 0.310 mm",
        "<td>transition</td><td class=\"n\">(2.000, 1.000)</td><td class=\"n\">(10.000, 0.000)</td><td class=\"n\">8.062</td>",
    ] {
        assert!(report.html.contains(word), "{word}");
    }
}

/// Targets of the links of a page.
fn targets(page: &str) -> Vec<&str> {
    page.split("href=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

/// Targets outside of the page.
fn outward(page: &str) -> Vec<&str> {
    targets(page).into_iter().filter(|target| !target.starts_with('#')).collect()
}

/// Goal: every link within the page goes to one place, every figure has a text, and nothing that the keyboard must reach lacks a name.
#[test]
fn links_lead_somewhere_and_figures_have_a_text() {
    let page = build_sample().html;
    let within: Vec<&str> =
        targets(&page).into_iter().filter_map(|target| target.strip_prefix('#')).collect();
    assert!(within.len() > 8, "{within:?}");
    for target in within {
        assert_eq!(page.matches(&format!("id=\"{target}\"")).count(), 1, "{target}");
    }
    assert_eq!(page.matches("<svg ").count(), page.matches("<svg role=\"img\" aria-label=\"").count());
    assert_eq!(page.matches("tabindex=\"0\"").count(), page.matches("role=\"group\" aria-label=\"").count());
}

/// Goal: the first screen has the springs rounded to their errors, what they are valid for, the origin with its hash, and lines to sign; each limit
/// that fails has value, limit, reason and a link.
#[test]
fn the_first_screen_can_be_signed() {
    let page = build_sample().html;
    let first = page.split("<h2 id=\"springs\">").next().unwrap();
    for word in [
        "1 to 150 kN",
        "\u{b1} 2.4 %",
        "\u{b1} 5.0 %",
        "Not covered",
        "sample.toml, BLAKE3 <code>efef",
        "worn.prw, BLAKE3 <code>cdcd",
        "reviewer, date",
        "Why this limit: ",
        "railspring 0.1.0 (commit 0123456789ab)",
        "href=\"#limit-",
        "displacement against beam",
        // rounded to their standard errors, 12,000 and 9,000 kN/m and 0.0042
        "<td>20000 \u{b1} 12000 kN&#x2f;m</td>",
        "<td>390000 \u{b1} 9000 kN&#x2f;m</td>",
        "<td>0.2450 \u{b1} 0.0042</td>",
    ] {
        assert!(first.contains(word), "{word}: {first}");
    }
    let verdict = verdict(&samples::history(0.001), &samples::history(0.0));
    assert!(!verdict.failing().is_empty());
    let spelled =
        [("&#x27;", "'"), ("&#x2f;", "/"), ("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&amp;", "&")];
    let plain = spelled.iter().fold(first.to_string(), |text, (from, to)| text.replace(from, to));
    for (_, line) in verdict.failing() {
        let why = reason(&line.quantity).replace('`', "");
        assert!(plain.contains(&format!("Why this limit: {why}.")), "{}: {why}: {first}", line.quantity);
    }
}

/// Without a cross-check of this study the chapter says so, what to run, and points to no page.
#[test]
fn the_chapter_says_what_is_missing() {
    for (state, word) in [
        (Crosscheck::Absent, "no cross-validation of this study yet"),
        (Crosscheck::Stale, "of another study"),
    ] {
        let report = build_with(state);
        assert_eq!(report.figures.len(), 20);
        assert!(report.html.contains(word) && report.html.contains("railspring crosscheck"), "{word}");
        assert!(outward(&report.html).is_empty(), "{word}");
    }
}

#[test]
fn the_same_results_give_the_same_page() {
    assert_eq!(build_sample(), build_sample());
}

#[test]
fn figures_have_finite_coordinates_only() {
    for (name, svg) in build_sample().figures {
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{name}");
        assert!(svg.starts_with("<svg width=\"860\""), "{name}: {}", &svg[..60]);
    }
}

/// Goal: the first screen has the verdict in the box of a pass or of a failure, both verdicts with their counts and uses, limits that are not the default ones, the program, and what
/// has to be known.
#[test]
fn the_first_screen_says_the_verdict() {
    let page = build_sample().html;
    let first = page.split("<h2 id=\"springs\">").next().unwrap();
    assert!(first.contains("<span class=\"verdict failing\">"), "{first}");
    assert!(
        first.contains(" fail; worst: sample: ")
            && first.contains("17 hold, 3 hold only within the solid&#x27;s numerical uncertainty, 2 fail")
            && first.contains("verification.law_max = 0.4 (default 0.15)")
            && first.contains("P 0.07 off")
            && first.contains("railspring 0.1.0 (commit 0123456789ab)")
            && first.contains("<a href=\"#notes\">known about the runs</a>"),
        "{first}"
    );
    let (_, notes) = page.split_once("<h3 id=\"notes\">").unwrap();
    assert!(notes.split("</ul>").next().unwrap().contains("P leaves the range"), "{notes}");
    let same = samples::history(0.0);
    let verdict = verdict(&same, &same);
    let summary = verdict.summary();
    assert!(
        verdict.holds && summary.ends_with("0 hold only within the solid's numerical uncertainty, 0 fail"),
        "{summary}"
    );
}

/// Goal: histories of one row, and such that end early, are drawn without panic and with finite coordinates, s.
#[test]
fn short_histories_are_drawn() {
    let (full, uncertain) = (samples::history(0.0), samples::uncertain_run());
    for rows in [1, 2, 3] {
        let mut short = full.clone();
        short.rows.truncate(rows);
        for (simple, other, solid) in [
            (&short, Some(&full), Some(&full)),
            (&full, Some(&short), Some(&short)),
            (&full, None, Some(&full)),
            (&short, None, None),
        ] {
            let solid = solid.map(|solid| drawn("solid", solid));
            let elements: Vec<ModelRun<'_>> = [drawn("condensed", simple)]
                .into_iter()
                .chain(other.map(|other| drawn("published", other)))
                .collect();
            let run = ScenarioRun {
                name: "sample",
                description: "",
                snapshots: &[],
                elements,
                solid,
                band: solid.filter(|solid| solid.history.rows.len() > 3).map(|solid| band(solid.history)),
                uncertain: other.is_some().then_some(&uncertain),
            };
            let figures = [
                figures_of_run::forces(&run),
                figures_of_run::ratio(&run, 0.024),
                figures_of_run::wheel(&run),
                figures_of_run::modes(&run),
                positions_figure::positions(
                    &samples::profiles(),
                    &[0.0, 0.2],
                    &run.elements[0],
                    solid.as_ref(),
                ),
            ];
            for svg in figures {
                assert!(
                    !svg.contains("NaN") && !svg.contains("inf") && !svg.contains("figure failed"),
                    "{rows} rows"
                );
            }
        }
    }
}

/// Goal: laws and a horizontal stiffness that end before the largest load of the study have a sentence each with both loads, kN, the number of those
/// left out and the reason; springs with all loads have none. All that are left out are counted.
#[test]
fn laws_without_all_loads_say_so() {
    let whole = samples::stiffness();
    assert_eq!((whole.shortened(), whole.loads_left_out()), (Vec::new(), 0));
    let reason = "contact at 180.000 kN: the contact reached the end of the contact window along the track";
    let law_end = LoadEndRecord { loads_left_out: 2, largest_wanted_kn: 220.0, reason: reason.into() };
    let short = StiffnessRecord { law_end: Some(law_end.clone()), ..whole };
    let of_the_laws = format!("the laws end at 150 kN instead of 220 kN, without 2 of the loads: {reason}");
    assert_eq!((short.shortened(), short.loads_left_out()), (vec![of_the_laws.clone()], 2));
    let horizontal_end = LoadEndRecord { loads_left_out: 1, ..law_end };
    let short = StiffnessRecord { horizontal_end: Some(horizontal_end), ..short };
    let of_both = [
        of_the_laws,
        format!(
            "the horizontal stiffness ends at 120 kN instead of 220 kN, without 1 of the preloads: {reason}"
        ),
    ];
    assert_eq!((short.shortened(), short.loads_left_out()), (of_both.to_vec(), 3));
}

/// Goal: the page has the error band of the law in use as sentence, table and bars; without a band it has none of them.
#[test]
fn the_page_has_the_error_band_of_the_law() {
    let stiffness = samples::stiffness();
    let sentence = stiffness.law_errors().remove(0);
    assert_eq!(
        sentence,
        "error band of the law (beam): displacement \u{b1}2.40 %, tangent \u{b1}5.00 % from 1 to 150 kN"
    );
    let bare = StiffnessRecord { error_band: None, ..stiffness.clone() };
    assert!(tables::law_errors(&bare).is_none() && bare.law_errors().is_empty());
    let rows = |stiffness| serde_json::to_value(tables::law_errors(stiffness)).unwrap()["rows"].clone();
    let rows = rows(&stiffness);
    assert_eq!(rows.as_array().unwrap().len(), 24);
    let none = "\u{2013}";
    let first = ["1", "\u{2212}2.0", "0.4", none, "2.4", "4.0", "\u{2212}1.0", none, "5.0"];
    assert_eq!(rows[0], serde_json::json!(first));
    for figure in [figures::law, figures::displacement] {
        // a bar for every load of three references
        let lines = |svg: String| svg.matches("<polyline").count();
        assert_eq!(lines(figure(&stiffness)) - lines(figure(&bare)), 3 * 24);
    }
}

/// Goal: the page has the differences of both elements from the solid beside each other, those of the study's element first and as its lines have them; of an
/// element that did not run it has the reason, and no row.
#[test]
fn both_elements_stand_beside_the_solid() {
    let (simple, solid) = (samples::history(0.001), samples::history(0.0));
    let mut judged = verdict(&simple, &solid).scenarios.remove(0);
    let line = |quantity: &str| judged.lines.iter().find(|line| line.quantity == quantity).unwrap();
    let [own, other] = [0, 1].map(|n| judged.elements[n].differences.unwrap());
    for (value, quantity) in [
        (own.vertical_rms, "vertical_rms"),
        (own.lateral_rms, "lateral_rms"),
        (own.ratio_max, "ratio_max"),
        (own.separations_unmatched, "separations_unmatched"),
    ] {
        assert!(value.is_some() && value == line(quantity).value, "{quantity}");
    }
    assert_eq!(own.over_s, line("vertical_rms").over_s);
    // it lags four times as far behind
    assert!(other.vertical_rms > own.vertical_rms, "{other:?}");
    let rows = tables::elements(&judged);
    assert_eq!([&rows[0][0], &rows[1][0]], ["condensed (the study's)", "published"]);
    assert_eq!(rows[1][1], format!("{:.1} %", 1e2 * other.vertical_rms.unwrap()));
    assert!(build_sample().html.contains("<td>condensed (the study&#x27;s)</td>"));
    judged.elements[1] = ElementVerdict {
        run: None,
        missing: Some("step 7 does not converge".into()),
        differences: None,
        ..judged.elements[1].clone()
    };
    assert_eq!(tables::elements(&judged).len(), 1);
    assert_eq!(
        tables::missing_elements(&judged),
        ["The published element has no run: step 7 does not converge."]
    );
}

/// Goal: the first screen has a row for each form of the contact element that was compared, the published one first, with the differences of its load case.
#[test]
fn the_first_screen_says_what_each_form_loses() {
    let html = build_sample().html;
    let screen = html.split("<h3>Valid for</h3>").next().unwrap();
    let judged = verdict(&samples::history(0.001), &samples::history(0.0)).scenarios.remove(0);
    let mut after = 0;
    for name in ["published", "condensed"] {
        let of = judged.elements.iter().find(|of| of.element == name).unwrap().differences.unwrap();
        let p = significant(1e2 * of.vertical_rms.unwrap(), 2);
        let row = format!("<tr><td>sample</td><td>{name}</td><td class=\"n\">{p} %</td>");
        let at = screen.find(&row).unwrap_or_else(|| panic!("{row}"));
        assert!(at > after);
        after = at;
    }
    assert!(!screen.contains("<td>lumped</td>"));
}

/// Goal: a sealed record is as written after it was read from its file, in another layout too; with any number, text or hash changed it is not.
#[test]
fn an_edit_is_seen() {
    let record = samples::stiffness().sealed();
    let text = serde_json::to_string(&record).unwrap();
    let read = |text: &str| serde_json::from_str::<StiffnessRecord>(text).unwrap();
    assert!(read(&text).is_as_written() && !samples::stiffness().is_as_written());
    let b = record.law.constants.b_kn_per_m;
    let [from, to] = [b, b * (1.0 + 1e-15)].map(|b| format!("\"b_kn_per_m\":{b:?}"));
    assert!(text.contains(&from) && from != to);
    for (from, to) in [(&*from, &*to), ("\"beam\"", "\"foot\""), (&record.input_hash, &"0".repeat(64))] {
        assert!(!read(&text.replacen(from, to, 1)).is_as_written(), "{from}");
    }
}
