//! Columns, MATLAB and JSON: the law and its points for whoever reads them.

use std::fmt::Write as _;

use railspring_calibrate::law::{NormalLaw, REFERENCE_FORCE, StepConstants};
use railspring_profiles::units::{KILONEWTON, KILONEWTON_PER_METRE, MILLIMETRE};
use serde_json::{Value, json};

use super::points::Points;
use super::spring::{ExportFile, Spring, commented};
use crate::engine::output::to_json;

const COMPRESSION: &str = "displacement and force are positive in compression";

/// Force over displacement as two columns, once in m and N and once in mm and kN.
pub(super) fn force_displacement(spring: &Spring) -> Vec<ExportFile> {
    let points = Points::of(spring);
    let file = |name: &str, units: [&str; 2], scale: [f64; 2]| {
        let own = [
            points.sentence(spring.range[0]),
            format!("units: {} and {}; {COMPRESSION}", units[0], units[1]),
            "beyond the last point nothing is known: let the program stop there or say that it extrapolates"
                .into(),
        ];
        let mut text =
            commented("#", &spring.heading("Force over displacement of a wheel on a rail, columns", &own));
        let _ = writeln!(text, "displacement_{},force_{}", units[0], units[1].to_lowercase());
        for [displacement, force] in &points.points {
            let _ = writeln!(text, "{:.9e},{:.9e}", displacement / scale[0], force / scale[1]);
        }
        ExportFile { name: name.into(), text }
    };
    vec![
        file("force_displacement_si.csv", ["m", "N"], [1.0, 1.0]),
        file("force_displacement_kn_mm.csv", ["mm", "kN"], [MILLIMETRE, KILONEWTON]),
    ]
}

/// A function that returns the law and its points as a structure.
pub(super) fn matlab(spring: &Spring) -> ExportFile {
    let points = Points::of(spring);
    let own = [
        points.sentence(spring.range[0]),
        format!("units: N, m; {COMPRESSION}"),
        "force at a displacement x: interp1([-1; s.displacement_m], [0; s.force_n], x), NaN beyond the last point".into(),
    ];
    let mut text =
        commented("%", &spring.heading("Contact spring of a wheel on a rail, MATLAB and Octave", &own));
    let column = |column: usize| -> String {
        let values: Vec<String> =
            points.points.iter().map(|point| format!("{:.9e}", point[column])).collect();
        values.join("; ...\n        ")
    };
    let [low, high] = spring.range;
    let horizontal =
        spring.horizontal_kn_per_m.map_or("NaN".into(), |k| format!("{:.9e}", k * KILONEWTON_PER_METRE));
    text += "function s = wheel_rail_spring()\n";
    for (name, value) in constants(&spring.law) {
        let value = match value {
            Value::String(text) => format!("'{text}'"),
            Value::Array(values) => {
                format!("[{}]", values.iter().map(Value::to_string).collect::<Vec<_>>().join(" "))
            }
            Value::Null => "Inf".into(),
            value => value.to_string(),
        };
        let _ = writeln!(text, "    s.{name} = {value};");
    }
    let _ = write!(
        text,
        "    s.range_n = [{low} {high}];\n    s.horizontal_n_per_m = {horizontal};\n    \
         s.displacement_m = [{}];\n    s.force_n = [{}];\nend\n",
        column(0),
        column(1)
    );
    ExportFile { name: "wheel_rail_spring.m".into(), text }
}

/// Force over displacement as a table file of the Modelica Standard Library (`Modelica.Blocks.Tables.CombiTable1Ds`): `#1` in its first line, then an array with its
/// size. A row before the first touch leaves the spring without tension.
pub(super) fn modelica(spring: &Spring) -> ExportFile {
    let points = Points::of(spring);
    let own = [
        points.sentence(spring.range[0]),
        format!("units: m, N; {COMPRESSION}"),
        "take smoothness = LinearSegments and extrapolation = NoExtrapolation: beyond the last point nothing is known".into(),
    ];
    let mut text = String::from("#1\n");
    text += &commented("#", &spring.heading("Contact spring of a wheel on a rail, Modelica", &own));
    let _ = writeln!(text, "double spring({},2)", points.points.len() + 1);
    for [displacement, force] in [[-1.0, 0.0]].iter().chain(&points.points) {
        let _ = writeln!(text, "{displacement:.9e} {force:.9e}");
    }
    ExportFile { name: "wheel_rail_spring_modelica.txt".into(), text }
}

/// The same as JSON; its first value is the comment.
pub(super) fn as_json(spring: &Spring) -> ExportFile {
    let points = Points::of(spring);
    let own = [points.sentence(spring.range[0]), format!("units: N, m; {COMPRESSION}")];
    let column = |column: usize| -> Vec<f64> { points.points.iter().map(|point| point[column]).collect() };
    let solid = &spring.points;
    let [of, name] = &spring.source;
    let mut law: serde_json::Map<String, Value> =
        constants(&spring.law).into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
    law.insert("range_n".into(), json!(spring.range));
    let value = json!({
        "comment": spring.heading("Contact spring of a wheel on a rail, JSON", &own),
        "program": "railspring",
        "version": env!("CARGO_PKG_VERSION"),
        of: name,
        "pair": spring.pair,
        "reference": spring.reference,
        "direction": spring.direction,
        "law": law,
        "points": { "displacement_m": column(0), "force_n": column(1), "max_rel_error": points.error },
        "solid": {
            "force_n": solid.iter().map(|p| p.force_kn * KILONEWTON).collect::<Vec<_>>(),
            "displacement_m": solid.iter().map(|p| p.displacement_mm * MILLIMETRE).collect::<Vec<_>>(),
            "tangent_n_per_m": solid.iter().map(|p| p.tangent_kn_per_m * KILONEWTON_PER_METRE).collect::<Vec<_>>(),
        },
        "horizontal_n_per_m": spring.horizontal_kn_per_m.map(|k| k * KILONEWTON_PER_METRE),
    });
    let text = String::from_utf8(to_json(&value)).expect("JSON is UTF-8");
    ExportFile { name: "wheel_rail_spring.json".into(), text }
}

/// The form of a law and its constants in N and m, by name; the spring in series of one that has none is null.
fn constants(law: &NormalLaw) -> Vec<(&'static str, Value)> {
    let mut all = vec![("form", json!(law.form().name()))];
    all.extend(match law {
        NormalLaw::Power(law) => {
            vec![
                ("a_n_per_m", json!(law.a)),
                ("b_n_per_m", json!(law.b)),
                ("c", json!(law.c)),
                ("f0_n", json!(REFERENCE_FORCE)),
            ]
        }
        NormalLaw::Series(law) => vec![
            ("b_n_per_m", json!(law.b())),
            ("c", json!(law.c())),
            ("f0_n", json!(REFERENCE_FORCE)),
            ("s_n_per_m", json!(law.s())),
        ],
        NormalLaw::Steps(law) => {
            let StepConstants { b, c, step_force, sharpness, rise, exponent_above } = law.constants();
            vec![
                ("b_n_per_m", json!(b)),
                ("c", json!(c)),
                ("f0_n", json!(REFERENCE_FORCE)),
                ("f1_n", json!(step_force)),
                ("p", json!(sharpness)),
                ("d", json!(rise)),
                ("e", json!(exponent_above)),
            ]
        }
        NormalLaw::Table(law) => {
            let (forces, tangents): (Vec<f64>, Vec<f64>) = law.knots().unzip();
            vec![
                ("table_force_n", json!(forces)),
                ("table_tangent_n_per_m", json!(tangents)),
                ("exponent_below", json!(law.exponent_below())),
            ]
        }
    });
    all
}
