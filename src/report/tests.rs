//! The report from made-up results: complete, self-contained, well formed.

use super::crosscheck::Crosscheck;
use super::samples;
use super::*;
use crate::records::{RunRecord, ScenarioVerdict};
use crate::verify::{Carrying, Limits, ModelRun, Spread, Worth, compare};

fn build_sample() -> Report {
    let (record, sections) = (samples::crosscheck(), samples::sections());
    build_with(Crosscheck::Fresh(&record, &sections))
}

fn build_with(crosscheck: Crosscheck<'_>) -> Report {
    let (simple, solid) = (samples::history(0.001), samples::history(0.0));
    let stiffness = samples::stiffness();
    let verdict = verdict(&simple, &solid);
    let (load_curve, profiles) = (samples::load_curve(), samples::profiles());
    let (inputs, measured) = (samples::inputs(), samples::measured());
    let laws = samples::by_angle();
    let patches = samples::patches();
    build(&ReportData {
        name: "sample <study>",
        description: "Made-up numbers.",
        inputs: &inputs,
        stiffness: &stiffness,
        load_curve: &load_curve,
        patches: &patches,
        by_angle: Some(&laws),
        profiles: &profiles,
        scenarios: vec![ScenarioRun {
            name: "sample",
            description: "Constant lateral force.",
            snapshots: &[0.0, 0.01, 0.2],
            simple: &simple,
            solid: Some(&solid),
            carrying: [Carrying::EXACT; 2],
        }],
        ratio_window: 0.024,
        verdict: &verdict,
        measured: &measured,
        crosscheck,
    })
}

fn verdict(simple: &History, solid: &History) -> VerificationRecord {
    // undetermined from 0.1 s on, where the disturbed run of the solid is another one
    let late = samples::history(0.002);
    let rows = |of: &History, rows: std::ops::Range<usize>| of.rows[rows].to_vec();
    let disturbed = History { rows: [rows(solid, 0..200), rows(&late, 200..551)].concat(), ..late };
    let spread = Spread::between(solid, &disturbed, "lateral force").unwrap();
    let worth = |spread| Worth { steps: Err("made up".into()), spread };
    let model = ModelRun { disturbed: Some((&disturbed, &spread)), ..ModelRun::alone(solid) };
    let comparison = compare(&ModelRun::alone(simple), &model, &Limits::default()).unwrap();
    let unknown = worth(Err("made up".into()));
    let scenario = ScenarioVerdict {
        scenario: "sample".into(),
        simple: RunRecord::new(simple, None, unknown, vec!["P leaves the range".into()]),
        solid: Some(RunRecord::new(solid, None, worth(Ok(spread.clone())), Vec::new())),
        lines: comparison.lines,
        not_applicable: comparison.not_applicable,
        compared: Some(comparison.compared),
    };
    VerificationRecord {
        study: "sample".into(),
        holds: scenario.lines.iter().all(|line| line.holds),
        calibration: Vec::new(),
        scenarios: vec![scenario],
        inputs: [("history.csv".to_string(), "ab".repeat(32))].into(),
        input_hash: "cd".repeat(32),
        version: "0.1.0".into(),
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
    assert_eq!(report.html.matches("<figure>").count(), report.figures.len());
    assert_eq!(report.figures.len(), 19);
    assert!(!report.html.contains("could not be written"), "{}", report.html);
    assert!(!report.html.contains("figure failed"));
    for outside in ["src=\"", "@import", "url("] {
        assert!(!report.html.contains(outside), "the page refers to something outside: {outside}");
    }
    // the only link is to the page beside it
    assert_eq!(report.html.matches("href=\"").count(), 1);
    assert_eq!(report.html.matches("href=\"crosscheck.html\"").count(), 1);
    assert!(report.html.contains("sample &lt;study&gt;"), "texts are escaped");
    for word in [
        "verification",
        "P, RMS difference over the solid",
        "solid model itself",
        "of both models. From 100 ms on the motion of the solid is not determined",
        "<td>0 to 99.5 ms</td>",
        "<td>100 to 275 ms</td>",
        "peak memory",
        "scaled Jacobian",
    ] {
        assert!(report.html.contains(word), "{word}");
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
        assert_eq!(report.figures.len(), 14);
        assert!(report.html.contains(word) && report.html.contains("railspring crosscheck"), "{word}");
        assert!(!report.html.contains("href=\""), "{word}");
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

/// Goal: the first screen has the verdict in the box of a pass or of a failure, and what has to be known.
#[test]
fn the_first_screen_says_the_verdict() {
    let page = build_sample().html;
    let first = page.split("<h2>Springs</h2>").next().unwrap();
    assert!(first.contains("<span class=\"verdict failing\">"), "{first}");
    assert!(
        first.contains(" lines fail; worst: sample: ") && first.contains("P leaves the range"),
        "{first}"
    );
    let same = samples::history(0.0);
    let verdict = verdict(&same, &same);
    assert!(verdict.holds && verdict.summary().starts_with("all "), "{}", verdict.summary());
}

/// Goal: histories of one row, and such that end early, are drawn without panic and with finite coordinates, s.
#[test]
fn short_histories_are_drawn() {
    let full = samples::history(0.0);
    for rows in [1, 2, 3] {
        let mut short = full.clone();
        short.rows.truncate(rows);
        for (simple, solid) in [(&short, Some(&full)), (&full, Some(&short)), (&short, None)] {
            let figures = [
                figures::forces(simple, solid),
                figures::ratio(simple, solid, 0.024, &[Carrying::EXACT; 2]),
                figures::wheel(simple, solid),
                figures::modes(simple, solid),
                positions::positions(&samples::profiles(), &[0.0, 0.2], simple, solid),
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
    let law_end =
        crate::records::LoadEndRecord { loads_left_out: 2, largest_wanted_kn: 220.0, reason: reason.into() };
    let short = crate::records::StiffnessRecord { law_end: Some(law_end.clone()), ..whole };
    let of_the_laws = format!("the laws end at 150 kN instead of 220 kN, without 2 of the loads: {reason}");
    assert_eq!((short.shortened(), short.loads_left_out()), (vec![of_the_laws.clone()], 2));
    let horizontal_end = crate::records::LoadEndRecord { loads_left_out: 1, ..law_end };
    let short = crate::records::StiffnessRecord { horizontal_end: Some(horizontal_end), ..short };
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
fn the_page_says_what_the_law_is_worth() {
    let stiffness = samples::stiffness();
    let sentence = stiffness.worth().remove(0);
    assert_eq!(
        sentence,
        "error band of the law (beam): displacement \u{b1}2.40 %, tangent \u{b1}5.00 % from 1 to 150 kN"
    );
    let bare = crate::records::StiffnessRecord { error_band: None, ..stiffness.clone() };
    assert!(tables::worth(&bare).is_none() && bare.worth().is_empty());
    let rows = |stiffness| serde_json::to_value(tables::worth(stiffness)).unwrap()["rows"].clone();
    let rows = rows(&stiffness);
    assert_eq!(rows.as_array().unwrap().len(), 24);
    assert_eq!(rows[0], serde_json::json!(["1", "-2.00", "0.40", "2.40", "4.00", "-1.00", "5.00"]));
    for figure in [figures::law, figures::displacement] {
        // a bar for every load of three references
        let lines = |svg: String| svg.matches("<polyline").count();
        assert_eq!(lines(figure(&stiffness)) - lines(figure(&bare)), 3 * 24);
    }
}
