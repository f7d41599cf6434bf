//! The constants of the lumped element as a table: what each is, its value with its band, its unit and its formula.

use serde_json::{Value, json};

use crate::report::number::number;
use crate::results::by_angle::lumped::{
    BushingRecord, LumpedConstantsRecord, LumpedRecord, OscillatorRecord,
};
use crate::rounding::{rounded_to, with_minus_signs};

/// A change that is smaller, relative, is none of a constant: it happens to be near zero, and says nothing of the error.
const LEAST_BAND: f64 = 1e-3;

/// What the table shows: rows of constant, value, unit and formula, and whether they have bands or why not.
pub(crate) fn table(lumped: &LumpedRecord) -> Value {
    let band = lumped.error_band.as_ref();
    let bands = band.and_then(|band| band.constants.as_ref());
    json!({
        "rows": rows(lumped, bands),
        "has_band": bands.is_some(),
        "missing": band.and_then(|band| band.missing.as_deref()),
        "coarser_mm": band.and_then(|band| band.coarser_element_mm).map(number),
    })
}

/// The rows of the table, with the bands of the constants.
fn rows(lumped: &LumpedRecord, bands: Option<&LumpedConstantsRecord>) -> Vec<[String; 4]> {
    let mut rows = Vec::new();
    let mut row = |name: String, value: f64, band: Option<f64>, unit: &str, formula: &str| {
        rows.push([name, with_band(value, band), unit.into(), formula.into()]);
    };
    let hub = |value: f64, band: fn(&LumpedConstantsRecord) -> f64| (value, bands.map(band));
    let (mass, of_mass) = hub(lumped.hub.mass_kg, |of| of.hub.mass_kg);
    row("mass of the wheel m".into(), mass, of_mass, "kg", "at the hub");
    let (inertia, of_inertia) = hub(lumped.hub.inertia_kg_m2, |of| of.hub.inertia_kg_m2);
    row(
        "inertia".into(),
        inertia,
        of_inertia,
        "kg\u{b7}m\u{b2}",
        "about x through the hub's centre; counts where the hub turns",
    );
    for (i, of) in lumped.oscillators.iter().enumerate() {
        let band = |value: fn(&OscillatorRecord) -> f64| bands.map(|bands| value(&bands.oscillators[i]));
        let name = |what: &str| format!("oscillator {}: {what}", i + 1);
        row(
            name("frequency"),
            of.frequency_hz,
            band(|of| of.frequency_hz),
            "Hz",
            "\u{3c9}/2\u{3c0}, the hub held",
        );
        row(
            name("r_y"),
            of.rim_lateral,
            band(|of| of.rim_lateral),
            "",
            "motion of the rim along y per displacement",
        );
        row(
            name("r_\u{3c6}"),
            of.rim_turn_per_m,
            band(|of| of.rim_turn_per_m),
            "1/m",
            "rotation of the rim per displacement",
        );
        for (axis, along) in
            ["y", "z"].into_iter().enumerate().filter(|(axis, _)| of.coupling_kg[*axis] != 0.0)
        {
            let coupling = bands.map(|bands| bands.oscillators[i].coupling_kg[axis]);
            row(
                name(&format!("c_{along}")),
                of.coupling_kg[axis],
                coupling,
                "kg",
                "mass between oscillator and hub",
            );
        }
        row(
            name("c_\u{3c6}"),
            of.coupling_turn_kg_m,
            band(|of| of.coupling_turn_kg_m),
            "kg\u{b7}m",
            "the same with the hub's rotation; counts where the hub turns",
        );
    }
    let (offset, of_offset) = hub(lumped.rim_offset_mm, |of| of.rim_offset_mm);
    row(
        "offset o".into(),
        offset,
        of_offset,
        "mm",
        "\u{3a3}(r_z\u{b7}r_\u{3c6}/\u{3c9}\u{b2}) / \u{3a3}(r_\u{3c6}\u{b2}/\u{3c9}\u{b2})",
    );
    for (of, bands, which) in [
        (&lumped.bushing, bands.map(|bands| &bands.bushing), "bushing"),
        (
            &lumped.bushing_on_section,
            bands.map(|bands| &bands.bushing_on_section),
            "bushing on a held section",
        ),
    ] {
        let band = |value: fn(&BushingRecord) -> f64| bands.map(value);
        let name = |what: &str| format!("{which}: {what}");
        row(
            name("k_y"),
            of.lateral_kn_per_m,
            band(|of| of.lateral_kn_per_m),
            "kN/m",
            "1/(C_yy \u{2212} C_y\u{3c6}\u{b2}/C_\u{3c6}\u{3c6}), at the elastic centre",
        );
        row(name("k_z"), of.vertical_kn_per_m, band(|of| of.vertical_kn_per_m), "kN/m", "1/C_zz");
        row(
            name("k_\u{3c6}"),
            of.turn_knm_per_rad,
            band(|of| of.turn_knm_per_rad),
            "kN\u{b7}m/rad",
            "1/C_\u{3c6}\u{3c6}",
        );
        row(
            name("elastic centre"),
            of.height_mm,
            band(|of| of.height_mm),
            "mm",
            "\u{2212}C_y\u{3c6}/C_\u{3c6}\u{3c6}, above the line of shear centres",
        );
    }
    rows
}

/// A value with the digits that its band leaves.
fn with_band(value: f64, band: Option<f64>) -> String {
    let text = match band {
        Some(band) if band > LEAST_BAND * value.abs() => match rounded_to(value, band) {
            (value, Some(band)) => format!("{value} \u{b1} {band}"),
            (value, None) => value,
        },
        _ => number(value),
    };
    with_minus_signs(&text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::by_angle::lumped::LumpedBandRecord;
    use crate::results::samples;

    /// Goal: a table has a row for each constant (the sample's 2 oscillators have 5 each, with one coupling) in its unit, rounded as its band says; without a band it says why.
    #[test]
    fn every_constant_has_a_row_and_its_band() {
        let mut lumped = samples::lumped();
        let without = table(&lumped);
        assert_eq!(without["rows"].as_array().unwrap().len(), 2 + 2 * 5 + 1 + 2 * 4);
        assert_eq!((&without["has_band"], &without["rows"][2][1]), (&json!(false), &json!("188")));
        let mut constants = LumpedConstantsRecord {
            hub: lumped.hub,
            oscillators: lumped.oscillators.clone(),
            rim_offset_mm: 0.04,
            bushing: lumped.bushing,
            bushing_on_section: lumped.bushing_on_section,
        };
        constants.oscillators[0].frequency_hz = 4.64;
        constants.hub.mass_kg = 0.0;
        let band =
            LumpedBandRecord { coarser_element_mm: Some(4.0), missing: None, constants: Some(constants) };
        lumped.error_band = Some(band);
        let with = table(&lumped);
        assert_eq!(with["rows"][0], json!(["mass of the wheel m", "307.8", "kg", "at the hub"]));
        assert_eq!(with["rows"][2][1], "188.0 \u{b1} 4.6");
        assert_eq!(with["rows"][12][1], "2.000 \u{b1} 0.040");
        lumped.error_band = Some(LumpedBandRecord {
            coarser_element_mm: None,
            missing: Some("rail.msh is not meshed by the program".into()),
            constants: None,
        });
        assert_eq!(table(&lumped)["missing"], "rail.msh is not meshed by the program");
    }
}
