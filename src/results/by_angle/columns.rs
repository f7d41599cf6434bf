//! `stiffness_by_angle.csv`: a row for each shift, fixed load and reference; a shift without a law has one row with its reason.

use serde_json::Value;

use super::record::{
    AngleLawRecord, FixedLoadRecord, FixedReferenceRecord, ShiftRecord, StiffnessByAngleRecord,
};
use crate::engine::columns::{Cell, Column, Holds, csv, schema};
use crate::results::springs::band_record::BandPointRecord;

/// What a row is of.
#[derive(Clone, Copy)]
struct At<'a> {
    shift: &'a ShiftRecord,
    law: Option<&'a AngleLawRecord>,
    load: Option<&'a FixedLoadRecord>,
    point: Option<&'a FixedReferenceRecord>,
}

impl<'a> At<'a> {
    /// What the solid is worth there.
    fn band(&self) -> Option<&'a BandPointRecord> {
        self.shift.band(&self.law?.reference, self.load?.force_kn)
    }
}

/// The columns, in their order.
fn columns<'a>() -> Vec<Column<At<'a>>> {
    use Holds::{Number, NumberOrNone, Text};
    let column = |name, holds, text, value| Column { name, holds, text, value };
    vec![
        column(
            "shift_mm",
            Number,
            "Lateral shift of the wheelset, mm, as `track.lateral_shift_mm`",
            |at: &At<'a>| Cell::from(at.shift.shift_mm),
        ),
        column(
            "contact_angle_deg",
            NumberOrNone,
            "Contact angle at the first touch, degrees; none where the wheel misses the rail",
            |at: &At<'a>| Cell::from(at.shift.angle()),
        ),
        column(
            "rail_y_mm",
            NumberOrNone,
            "First touch on the rail, rail profile frame, lateral, mm",
            |at: &At<'a>| Cell::from(at.shift.touch.map(|touch| touch.rail_y_mm)),
        ),
        column("rail_z_mm", NumberOrNone, "The same, vertical, mm", |at: &At<'a>| {
            Cell::from(at.shift.touch.map(|touch| touch.rail_z_mm))
        }),
        column(
            "wheel_y_mm",
            NumberOrNone,
            "First touch on the wheel, wheel profile frame, lateral, mm",
            |at: &At<'a>| Cell::from(at.shift.touch.map(|touch| touch.wheel_y_mm)),
        ),
        column("wheel_z_mm", NumberOrNone, "The same, vertical, mm", |at: &At<'a>| {
            Cell::from(at.shift.touch.map(|touch| touch.wheel_z_mm))
        }),
        column(
            "reference",
            Text,
            "What the displacement is measured against: `foot`, `beam` or `local`; empty where there is no law",
            |at: &At<'a>| Cell::from(at.law.map_or("", |law| &law.reference)),
        ),
        column(
            "force_kn",
            NumberOrNone,
            "Load along the contact normal, kN; none where no fixed load lies in the range of the law",
            |at: &At<'a>| Cell::from(at.load.map(|load| load.force_kn)),
        ),
        column("displacement_mm", NumberOrNone, "Displacement of the solid, mm", |at: &At<'a>| {
            Cell::from(at.point.map(|point| point.displacement_mm))
        }),
        column("tangent_kn_per_m", NumberOrNone, "Tangent stiffness of the solid, kN/m", |at: &At<'a>| {
            Cell::from(at.point.map(|point| point.tangent_kn_per_m))
        }),
        column(
            "displacement_rel_error_band",
            NumberOrNone,
            "Half width of the error band of the displacement, relative",
            |at: &At<'a>| Cell::from(at.band().and_then(|band| band.displacement)),
        ),
        column(
            "tangent_rel_error_band",
            NumberOrNone,
            "Half width of the error band of the tangent, relative",
            |at: &At<'a>| Cell::from(at.band().and_then(|band| band.tangent)),
        ),
        column(
            "grid_displacement_rel_change",
            NumberOrNone,
            "Change of the displacement with a contact grid of half the spacing, relative",
            |at: &At<'a>| Cell::from(at.band().and_then(|band| band.grid_displacement)),
        ),
        column("grid_tangent_rel_change", NumberOrNone, "The same of the tangent", |at: &At<'a>| {
            Cell::from(at.band().and_then(|band| band.grid_tangent))
        }),
        column(
            "mesh_displacement_rel_change",
            NumberOrNone,
            "Change of the displacement from the coarser meshes to these, relative",
            |at: &At<'a>| Cell::from(at.band().and_then(|band| band.mesh_displacement)),
        ),
        column("mesh_tangent_rel_change", NumberOrNone, "The same of the tangent", |at: &At<'a>| {
            Cell::from(at.band().and_then(|band| band.mesh_tangent))
        }),
        column(
            "scatter_displacement_rel_uncertainty",
            NumberOrNone,
            "Uncertainty of the displacement by the scatter of measured profiles, relative",
            |at: &At<'a>| Cell::from(at.band().and_then(|band| band.scatter_displacement)),
        ),
        column("scatter_tangent_rel_uncertainty", NumberOrNone, "The same of the tangent", |at: &At<'a>| {
            Cell::from(at.band().and_then(|band| band.scatter_tangent))
        }),
        column(
            "horizontal_kn_per_m",
            NumberOrNone,
            "Lateral stiffness of the sticking wheel against the rail's section, the vertical force constant, kN/m",
            |at: &At<'a>| Cell::from(at.load.map(|load| load.horizontal_kn_per_m)),
        ),
        column(
            "tangential_kn_per_m",
            NumberOrNone,
            "The same across the contact normal, the force along it constant, kN/m",
            |at: &At<'a>| Cell::from(at.load.map(|load| load.tangential_kn_per_m)),
        ),
        column(
            "lateral_contact_um_per_kn",
            NumberOrNone,
            "Part of the lateral compliance that lies in the contact itself, µm/kN",
            |at: &At<'a>| Cell::from(at.load.and_then(|load| load.lateral_contact_um_per_kn)),
        ),
        column("contact_area_mm2", NumberOrNone, "Contact area, mm²", |at: &At<'a>| {
            Cell::from(at.load.map(|load| load.contact_area_mm2))
        }),
        column("max_pressure_mpa", NumberOrNone, "Largest pressure, MPa", |at: &At<'a>| {
            Cell::from(at.load.map(|load| load.max_pressure_mpa))
        }),
        column(
            "semi_axis_along_mm",
            NumberOrNone,
            "Semi-axis of the patch along the track, mm",
            |at: &At<'a>| Cell::from(at.load.map(|load| load.semi_axis_along_mm)),
        ),
        column("semi_axis_across_mm", NumberOrNone, "Semi-axis of the patch across, mm", |at: &At<'a>| {
            Cell::from(at.load.map(|load| load.semi_axis_across_mm))
        }),
        column(
            "max_von_mises_mpa",
            NumberOrNone,
            "Largest von Mises stress below the patch, MPa; none for a contact between elements",
            |at: &At<'a>| Cell::from(at.load.and_then(|load| load.max_von_mises_mpa)),
        ),
        column("von_mises_depth_mm", NumberOrNone, "Its depth, mm", |at: &At<'a>| {
            Cell::from(at.load.and_then(|load| load.von_mises_depth_mm))
        }),
        column(
            "max_shear_mpa",
            NumberOrNone,
            "Largest shear stress below the patch, MPa; none for a contact between elements",
            |at: &At<'a>| Cell::from(at.load.and_then(|load| load.max_shear_mpa)),
        ),
        column("shear_depth_mm", NumberOrNone, "Its depth, mm", |at: &At<'a>| {
            Cell::from(at.load.and_then(|load| load.shear_depth_mm))
        }),
        column(
            "local_um_per_kn",
            NumberOrNone,
            "Part of the tangent compliance in the contact itself, µm/kN",
            |at: &At<'a>| Cell::from(at.point.map(|point| point.local_um_per_kn)),
        ),
        column(
            "wheel_um_per_kn",
            NumberOrNone,
            "Part of the wheel body, µm/kN; none in `local`",
            |at: &At<'a>| Cell::from(at.point.and_then(|point| point.wheel_um_per_kn)),
        ),
        column(
            "rail_um_per_kn",
            NumberOrNone,
            "Part of the rail body, µm/kN; none in `local`",
            |at: &At<'a>| Cell::from(at.point.and_then(|point| point.rail_um_per_kn)),
        ),
        column(
            "sliding_um_per_kn",
            NumberOrNone,
            "Part of the friction of points that slide, µm/kN; none in `local`",
            |at: &At<'a>| Cell::from(at.point.and_then(|point| point.sliding_um_per_kn)),
        ),
        column("law_a_kn_per_m", NumberOrNone, "Constant a of the law, kN/m", |at: &At<'a>| {
            Cell::from(at.law.map(|law| law.law.constants.a_kn_per_m))
        }),
        column("law_b_kn_per_m", NumberOrNone, "Constant b of the law, kN/m", |at: &At<'a>| {
            Cell::from(at.law.map(|law| law.law.constants.b_kn_per_m))
        }),
        column("law_c", NumberOrNone, "Exponent c of the law", |at: &At<'a>| {
            Cell::from(at.law.map(|law| law.law.constants.c))
        }),
        column("law_from_kn", NumberOrNone, "Smallest load of the fit, kN", |at: &At<'a>| {
            Cell::from(at.law.map(|law| law.law.range_kn[0]))
        }),
        column("law_to_kn", NumberOrNone, "Largest load of the fit, kN", |at: &At<'a>| {
            Cell::from(at.law.map(|law| law.law.range_kn[1]))
        }),
        column(
            "law_max_rel_error",
            NumberOrNone,
            "Largest difference of the law from the tangents of the solid, relative",
            |at: &At<'a>| Cell::from(at.law.map(|law| law.law.max_rel_error)),
        ),
        column(
            "published_secant_ratio",
            NumberOrNone,
            "Secant stiffness against the held foot from 20 to 120 kN over that of the published law",
            |at: &At<'a>| Cell::from(at.shift.published_secant_ratio),
        ),
        column("error_band_missing", Text, "Why parts of the error band are missing", |at: &At<'a>| {
            Cell::from(at.shift.error_band.as_ref().map(|band| band.missing.join("; ")).unwrap_or_default())
        }),
        column(
            "reason",
            Text,
            "Why there is no law, or why it ends before the largest load",
            |at: &At<'a>| Cell::from(at.shift.reason.clone().unwrap_or_default()),
        ),
    ]
}

/// The file.
pub fn rows(laws: &StiffnessByAngleRecord) -> Vec<u8> {
    let rows: Vec<At<'_>> = laws.shifts.iter().flat_map(rows_of_shift).collect();
    csv(&columns(), &rows)
}

/// The JSON schema of a row.
pub fn row_schema() -> Value {
    schema(
        "ByAngleRow",
        "One row of `stiffness_by_angle.csv`: a shift, a fixed load and a reference.",
        &columns(),
    )
}

fn rows_of_shift(shift: &ShiftRecord) -> Vec<At<'_>> {
    let bare = At { shift, law: None, load: None, point: None };
    if shift.laws.is_empty() {
        return vec![bare];
    }
    let mut rows = Vec::new();
    for law in &shift.laws {
        let of_law = At { law: Some(law), ..bare };
        let before = rows.len();
        for load in &shift.loads {
            let point = load.reference(&law.reference);
            rows.extend(point.map(|point| At { load: Some(load), point: Some(point), ..of_law }));
        }
        // a law that no fixed load lies in has its constants all the same
        if rows.len() == before {
            rows.push(of_law);
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::samples;

    /// Goal: a row for each load and reference, with the record's own numbers, and one with the reason of a shift without a law; every column has a meaning.
    /// Exact: numbers are written in full.
    #[test]
    fn rows_have_the_numbers_of_the_record() {
        let mut laws = samples::by_angle();
        let mut bare = laws.shifts.last().unwrap().clone();
        (bare.shift_mm, bare.reason) = (99.0, Some("no touch".into()));
        (bare.laws, bare.loads) = (Vec::new(), Vec::new());
        laws.shifts.push(bare);
        let file = rows(&laws);
        let mut reader = csv::Reader::from_reader(file.as_slice());
        let heads: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
        let at = |name: &str| heads.iter().position(|head| head == name).unwrap();
        let found: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        let shift = laws.shifts.iter().find(|shift| !shift.laws.is_empty()).unwrap();
        let of_first = found.iter().filter(|row| row[at("shift_mm")].parse() == Ok(shift.shift_mm));
        let law = &shift.laws[0];
        let load = shift.loads.iter().find(|load| load.reference(&law.reference).is_some()).unwrap();
        let row = of_first.clone().find(|row| {
            row[at("reference")] == law.reference && row[at("force_kn")].parse() == Ok(load.force_kn)
        });
        let row = row.expect("the row of the first load");
        assert_eq!(row[at("max_shear_mpa")].parse().ok(), load.max_shear_mpa);
        assert_eq!(
            row[at("tangent_kn_per_m")].parse(),
            Ok(load.reference(&law.reference).unwrap().tangent_kn_per_m)
        );
        let last = found.last().unwrap();
        assert!(&last[at("reason")] == "no touch" && last[at("force_kn")].is_empty(), "{last:?}");
        let schema = row_schema();
        for head in &heads {
            let text = schema["properties"][head]["description"].as_str().unwrap();
            assert!(!text.is_empty(), "{head}");
        }
    }
}
