//! The templates of all pages and how they are filled.

use minijinja::value::Serde;
use serde_json::Value;

use super::tables;

/// The pages, and the parts that they share.
const TEMPLATES: [(&str, &str); 8] = [
    ("style.css", include_str!("pages/style.css")),
    ("inputs.html", include_str!("pages/inputs.html")),
    ("report.html", include_str!("pages/report.html")),
    ("table.html", include_str!("pages/table.html")),
    ("crosscheck.html", include_str!("pages/crosscheck.html")),
    ("crosscheck_summary.html", include_str!("pages/crosscheck_summary.html")),
    ("crosscheck_times.html", include_str!("pages/crosscheck_times.html")),
    ("crosscheck_versions.html", include_str!("pages/crosscheck_versions.html")),
];

/// A page from its template; a template that cannot be filled gives a page that says so.
pub(crate) fn render(template: &str, context: Value) -> String {
    filled(template, context)
        .unwrap_or_else(|cause| format!("<!doctype html><p>The page could not be written: {cause}</p>"))
}

fn filled(template: &str, context: Value) -> Result<String, minijinja::Error> {
    let mut environment = minijinja::Environment::new();
    environment.set_auto_escape_callback(|_| minijinja::AutoEscape::Html);
    environment.add_filter("number", tables::number);
    for (name, source) in TEMPLATES {
        environment.add_template(name, source)?;
    }
    environment.get_template(template)?.render(minijinja::Value::from(Serde(context)))
}
