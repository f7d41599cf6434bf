//! The separate page from made-up results, and its numbers as text.

use super::*;
use crate::results::samples;

fn sample_page(report: bool) -> String {
    let (record, sections, inputs) = (samples::crosscheck(), samples::sections(), samples::inputs());
    let data = PageData {
        description: "Made-up <numbers>.",
        inputs: &inputs,
        record: &record,
        sections: &sections,
        report,
    };
    page(&data)
}

#[test]
fn the_page_is_complete_and_needs_nothing_else() {
    let html = sample_page(true);
    if let Some(folder) = std::env::var_os("RAILSPRING_SAMPLE_REPORT") {
        let folder = std::path::Path::new(&folder);
        std::fs::create_dir_all(folder).unwrap();
        std::fs::write(folder.join("crosscheck.html"), &html).unwrap();
    }
    assert!(!html.contains("could not be written") && !html.contains("figure failed"), "{html}");
    assert_eq!(html.matches("<figure id=").count(), 5);
    for outside in ["src=\"", "@import", "url("] {
        assert!(!html.contains(outside), "the page refers to something outside: {outside}");
    }
    assert_eq!(html.matches("href=\"").count(), 1);
    assert_eq!(html.matches("href=\"report.html\"").count(), 1);
    assert!(!sample_page(false).contains("href=\""), "no report to point to");
    assert!(!html.contains("NaN"), "a missing answer is reported in words");
    let record = samples::crosscheck();
    let rows = html.split("<h2>Every check</h2>").nth(1).unwrap();
    assert_eq!(rows.matches(">holds<").count() + rows.matches(">fails<").count(), record.checks.len());
    assert_eq!(rows.matches(">fails<").count(), record.checks.iter().filter(|c| !c.holds).count());
    for word in [
        "Made-up &lt;numbers&gt;.",
        "CalculiX 2.20",
        "Python 3.11.2",
        "scikit-fem 11",
        &record.input_hash,
        &record.reference.package_hash,
        "rounding times condition number",
        "Hub displacement?",
        "gauge_mm",
    ] {
        assert!(html.contains(word), "{word}");
    }
}

/// Goal: a load case in time has its forces and differences in place of the load curves, with the names of both programs, and its limits.
#[test]
fn a_load_case_in_time_has_its_figures() {
    let (record, inputs) = (samples::crosscheck_in_time(), samples::inputs());
    let html =
        page(&PageData { description: "", inputs: &inputs, record: &record, sections: &[], report: false });
    if let Some(folder) = std::env::var_os("RAILSPRING_SAMPLE_REPORT") {
        let folder = std::path::Path::new(&folder);
        std::fs::create_dir_all(folder).unwrap();
        std::fs::write(folder.join("crosscheck-in-time.html"), &html).unwrap();
    }
    assert!(!html.contains("figure failed") && !html.contains("NaN"), "{html}");
    assert_eq!(html.matches("<figure id=").count(), 2);
    for word in [
        "Load case constant: vertical (P) and lateral force (Q)",
        "P, RMS difference over its peak",
        "Q, RMS change over its peak with steps of the reference twice as long",
        "schemes of second order",
        "reference less tool",
        "steps twice as long",
    ] {
        assert!(html.contains(word), "{word}");
    }
}

#[test]
fn differences_and_values_are_readable() {
    let differences = [
        (0.0, "0"),
        (0.0385, "0.0385"),
        (1e-9, "1\u{b7}10⁻⁹"),
        (7.73e-14, "7.7\u{b7}10⁻¹⁴"),
        (5e-3, "0.005"),
        (f64::NAN, "none"),
    ];
    for (number, expected) in differences {
        assert_eq!(scientific(number), expected, "{number}");
    }
    for (number, expected) in [(0.123456789, "0.123457"), (1234567.8, "1234568"), (-1.0, "\u{2212}1.00000")] {
        assert_eq!(value(number), expected, "{number}");
    }
}
