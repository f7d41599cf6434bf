//! The figure of a sweep over sizes: time, memory and speed over the degrees of freedom.

use railspring::report::number::WIDTH;
use railspring::report::panel::{Panel, stacked_logarithmic};
use railspring::report::plot::{
    BLUE, DARK, DARK_RED, Dash, GREY, Marker, ORANGE, PALE_BLUE, RED, RGBColor, Series,
};

use super::record::{BOTH, ExponentRecord, ScalingRecord, ScalingSize};

/// Bytes of a mebibyte.
const MIB: f64 = 1024.0 * 1024.0;

/// Stages with how they are drawn: neighbours differ in marker and in dash.
const LOOKS: [(&str, RGBColor, Dash, Marker); 8] = [
    ("factorisation", DARK, Dash::Solid, Marker::Disc),
    ("modes", RED, Dash::Dashed, Marker::Square),
    ("assembly", BLUE, Dash::Solid, Marker::Triangle),
    ("ordering", ORANGE, Dash::Dotted, Marker::Circle),
    ("condensation", DARK_RED, Dash::Dotted, Marker::Disc),
    ("mesh", GREY, Dash::Dashed, Marker::Triangle),
    ("one load", BLUE, Dash::Dotted, Marker::Square),
    ("one step", PALE_BLUE, Dash::Solid, Marker::Circle),
];

/// Times of the stages, memory, and the factorisations' share of the dense product's speed.
pub fn figure(record: &ScalingRecord) -> String {
    let over = |of: &dyn Fn(&ScalingSize) -> Option<f64>| -> Vec<(f64, f64)> {
        let point = |size: &ScalingSize| (size.degrees_of_freedom as f64, of(size).unwrap_or(f64::NAN));
        record.sizes.iter().map(point).collect()
    };
    let times = LOOKS
        .iter()
        .map(|(stage, color, dash, marker)| {
            let points = over(&|size| size.seconds(stage));
            Series::joined(&named(record, stage, stage), points, *color, *dash, *marker)
        })
        .collect();
    let memory = vec![
        Series::joined(
            &named(record, "largest memory", "largest memory of the program"),
            over(&|size| size.memory.found_mib),
            DARK,
            Dash::Solid,
            Marker::Square,
        ),
        Series::joined(
            "largest memory, as predicted",
            over(&|size| Some(size.memory.predicted_mib)),
            GREY,
            Dash::Dotted,
            Marker::Circle,
        ),
        Series::joined(
            &named(record, "values in the factors", "both factors, 8 bytes a value"),
            over(&|size| Some(8.0 * size.factor_values() / MIB)),
            RED,
            Dash::Dashed,
            Marker::Triangle,
        ),
    ];
    let bodies = record.sizes.first().map_or(0, |size| size.bodies.len());
    let looks = [(BLUE, Dash::Dashed, Marker::Circle), (DARK, Dash::Solid, Marker::Disc)];
    let shares = (0..bodies)
        .zip(looks)
        .map(|(n, (color, dash, marker))| {
            let name = record.sizes.first().map_or("", |size| size.bodies[n].body.as_str());
            let points = over(&|size| size.bodies.get(n).map(|body| 100.0 * body.share_of_product));
            Series::joined(&format!("{name}, of the product's speed"), points, color, dash, marker)
        })
        .collect();
    let panel = |y_label: &str, from_zero, series| Panel {
        x_label: "degrees of freedom of rail and wheel".into(),
        y_label: y_label.into(),
        from_zero,
        series,
    };
    let panels = [
        panel("time (s)", false, times),
        panel("memory (MiB)", false, memory),
        panel("speed of the factorisation (%)", true, shares),
    ];
    stacked_logarithmic(WIDTH, 300, &panels, &notes(record))
}

/// A legend with the exponent of a quantity of both bodies.
fn named(record: &ScalingRecord, quantity: &str, text: &str) -> String {
    let of_both = |found: &&ExponentRecord| found.of == BOTH && found.quantity == quantity;
    match record.exponents.iter().find(of_both) {
        Some(found) => format!("{text}, exponent {}", exponent(found)),
        None => text.to_string(),
    }
}

/// An exponent with its standard error.
pub fn exponent(found: &ExponentRecord) -> String {
    match found.standard_error {
        Some(error) => format!("{:.2} \u{b1} {error:.2}", found.exponent),
        None => format!("{:.2}", found.exponent),
    }
}

/// What the figure does not show.
fn notes(record: &ScalingRecord) -> Vec<String> {
    let machine = &record.machine;
    let memory = machine.memory_gib.map_or_else(String::new, |gib| format!(", {gib} GiB"));
    let processor = machine.processor.as_deref().unwrap_or("unknown processor");
    let mut notes = vec![format!(
        "Study {}, bodies refined, contact zone as it is; {} modes of each body. {processor}, {} cores{memory}; {} threads.",
        record.study, record.modes, machine.cores, record.threads
    )];
    notes.extend(record.skipped.iter().map(|skipped| {
        format!(
            "{} degrees of freedom: left out, {:.1} of {:.1} GiB.",
            skipped.wanted, skipped.needed_gib, skipped.available_gib
        )
    }));
    notes
}
