//! The templates of all pages and how they are filled.

use minijinja::value::Serde;
use serde_json::Value;

use super::number;
use crate::rounding::{significant, with_minus_signs};

/// The pages, and the parts that they share.
const TEMPLATES: [(&str, &str); 11] = [
    ("style.css", include_str!("pages/style.css")),
    ("inputs.html", include_str!("pages/inputs.html")),
    ("report.html", include_str!("pages/report.html")),
    ("table.html", include_str!("pages/table.html")),
    ("table_fleet.html", include_str!("pages/table_fleet.html")),
    ("track.html", include_str!("pages/track.html")),
    ("compare.html", include_str!("pages/compare.html")),
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
    environment.add_filter("number", number::number);
    environment.add_filter("percent", percent);
    environment.add_filter("coded", coded);
    environment.add_filter("signed", |text: String| with_minus_signs(&text));
    for (name, source) in TEMPLATES {
        environment.add_template(name, source)?;
    }
    environment.get_template(template)?.render(minijinja::Value::from(Serde(context)))
}

/// A relative deviation in per cent with the two digits that mean something.
fn percent(value: f64) -> String {
    with_minus_signs(&format!("{} %", significant(1e2 * value + 0.0, 2)))
}

/// A text for a page, in which what stands between backticks is code.
fn coded(text: String) -> minijinja::Value {
    let escape = |part: &str| part.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let text = with_minus_signs(&text);
    let parts = text.split('`').enumerate().map(|(n, part)| match n % 2 {
        0 => escape(part),
        _ => format!("<code>{}</code>", escape(part)),
    });
    minijinja::Value::from_safe_string(parts.collect())
}

#[cfg(test)]
mod tests {
    use super::{coded, percent};

    /// Goal: a deviation has two digits and its sign.
    #[test]
    fn deviations_have_two_digits() {
        assert_eq!([percent(0.019_68), percent(-0.152), percent(0.0)], ["2.0 %", "\u{2212}15 %", "0 %"]);
    }

    /// Goal: names of files and keys are code, and nothing of a text becomes a tag.
    #[test]
    fn names_are_code() {
        let page = coded("a < -1, see `x.json` & `y<z -1`.".into()).to_string();
        assert_eq!(page, "a &lt; \u{2212}1, see <code>x.json</code> &amp; <code>y&lt;z -1</code>.");
    }
}
