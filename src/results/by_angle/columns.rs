//! `stiffness_by_angle.csv`: a row for each shift, fixed load and reference; a shift without a law has one row with its reason.

use serde_json::Value;

use super::record::{
    AngleLawRecord, ContactRecord, FixedLoadRecord, FixedReferenceRecord, ShiftRecord, StiffnessByAngleRecord,
};
use crate::engine::columns::{Column, columns, csv, properties, schema};
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
    /// Error band of the solid there.
    fn band(&self) -> Option<&'a BandPointRecord> {
        self.shift.band(&self.law?.reference, self.load?.force_kn)
    }
}

/// The columns, in their order.
fn columns<'a>() -> Vec<Column<At<'a>>> {
    columns! { At<'a>:
        "shift_mm", "Lateral shift of the wheelset, mm, as `track.lateral_shift_mm`", |at| at.shift.shift_mm;
        "contact_angle_deg", "Contact angle at the first touch, degrees; none where the wheel misses the rail",
            |at| at.shift.angle();
        "rail_y_mm", "First touch on the rail, rail profile frame, lateral, mm", |at| Some(at.shift.touch?.rail_y_mm);
        "rail_z_mm", "The same, vertical, mm", |at| Some(at.shift.touch?.rail_z_mm);
        "wheel_y_mm", "First touch on the wheel, wheel profile frame, lateral, mm",
            |at| Some(at.shift.touch?.wheel_y_mm);
        "wheel_z_mm", "The same, vertical, mm", |at| Some(at.shift.touch?.wheel_z_mm);
        "reference", "What the displacement is measured against: `foot`, `beam` or `local`; empty where there is no law",
            |at| at.law.map_or("", |law| &law.reference);
        "force_kn", "Load along the contact normal, kN; none where no fixed load lies in the range of the law",
            |at| Some(at.load?.force_kn);
        "shared_from_kn", "Smallest load that two contacts with different normals share, kN; the law is that of the pair from there on",
            |at| at.shift.shared_from_kn;
        "second_force_kn", "Normal force of the contact that carries less, kN; none where one contact carries the load",
            |at| Some(second(at.load?)?.force_kn);
        "second_angle_deg", "Contact angle of that contact, degrees",
            |at| Some(second(at.load?)?.contact_angle_deg);
        "displacement_mm", "Displacement of the solid, mm", |at| Some(at.point?.displacement_mm);
        "tangent_kn_per_m", "Tangent stiffness of the solid, kN/m", |at| Some(at.point?.tangent_kn_per_m);
        "displacement_rel_error_band", "Half width of the error band of the displacement, relative",
            |at| at.band()?.displacement;
        "tangent_rel_error_band", "Half width of the error band of the tangent, relative", |at| at.band()?.tangent;
        "grid_displacement_rel_change", "Change of the displacement with a contact grid of half the spacing, relative",
            |at| at.band()?.grid_displacement;
        "grid_tangent_rel_change", "The same of the tangent", |at| at.band()?.grid_tangent;
        "mesh_displacement_rel_change", "Change of the displacement from the coarser meshes to these, relative",
            |at| at.band()?.mesh_displacement;
        "mesh_tangent_rel_change", "The same of the tangent", |at| at.band()?.mesh_tangent;
        "scatter_displacement_rel_uncertainty", "Uncertainty of the displacement by the scatter of measured profiles, relative",
            |at| at.band()?.scatter_displacement;
        "scatter_tangent_rel_uncertainty", "The same of the tangent", |at| at.band()?.scatter_tangent;
        "horizontal_kn_per_m", "Lateral stiffness of the sticking wheel against the rail's section, the vertical force constant, kN/m",
            |at| Some(at.load?.horizontal_kn_per_m);
        "tangential_kn_per_m", "The same across the contact normal, the force along it constant, kN/m",
            |at| Some(at.load?.tangential_kn_per_m);
        "lateral_contact_um_per_kn", "Part of the lateral compliance that lies in the contact itself, µm/kN",
            |at| at.load?.lateral_contact_um_per_kn;
        "contact_area_mm2", "Contact area, mm²", |at| Some(at.load?.contact_area_mm2);
        "max_pressure_mpa", "Largest pressure, MPa", |at| Some(at.load?.max_pressure_mpa);
        "semi_axis_along_mm", "Semi-axis of the patch along the track, mm", |at| Some(at.load?.semi_axis_along_mm);
        "semi_axis_across_mm", "Semi-axis of the patch across, mm", |at| Some(at.load?.semi_axis_across_mm);
        "max_von_mises_mpa", "Largest von Mises stress below the patch, MPa; none for a contact between elements",
            |at| at.load?.max_von_mises_mpa;
        "von_mises_depth_mm", "Its depth, mm", |at| at.load?.von_mises_depth_mm;
        "max_shear_mpa", "Largest shear stress below the patch, MPa; none for a contact between elements",
            |at| at.load?.max_shear_mpa;
        "shear_depth_mm", "Its depth, mm", |at| at.load?.shear_depth_mm;
        "contact_area_rel_error_band", "Half width of the error band of the contact area, relative: its change from cells twice as large; none for a contact between elements",
            |at| Some(at.load?.patch_error_band?.contact_area);
        "max_pressure_rel_error_band", "The same of the largest pressure", |at| Some(at.load?.patch_error_band?.max_pressure);
        "von_mises_rel_error_band", "The same of the largest von Mises stress",
            |at| Some(at.load?.patch_error_band?.von_mises);
        "von_mises_depth_rel_error_band", "The same of its depth", |at| Some(at.load?.patch_error_band?.von_mises_depth);
        "shear_rel_error_band", "The same of the largest shear stress", |at| Some(at.load?.patch_error_band?.shear);
        "shear_depth_rel_error_band", "The same of its depth", |at| Some(at.load?.patch_error_band?.shear_depth);
        "local_um_per_kn", "Part of the tangent compliance in the contact itself, µm/kN",
            |at| Some(at.point?.local_um_per_kn);
        "wheel_um_per_kn", "Part of the wheel body, µm/kN; none in `local`", |at| at.point?.wheel_um_per_kn;
        "rail_um_per_kn", "Part of the rail body, µm/kN; none in `local`", |at| at.point?.rail_um_per_kn;
        "sliding_um_per_kn", "Part of surfaces that move past each other, by friction or to other places on the profiles, µm/kN; none in `local`",
            |at| at.point?.sliding_um_per_kn;
        "law_a_kn_per_m", "Constant a of the law, kN/m", |at| Some(at.law?.law.constants.a_kn_per_m);
        "law_b_kn_per_m", "Constant b of the law, kN/m", |at| Some(at.law?.law.constants.b_kn_per_m);
        "law_c", "Exponent c of the law", |at| Some(at.law?.law.constants.c);
        "law_from_kn", "Smallest load of the fit, kN", |at| Some(at.law?.law.range_kn[0]);
        "law_to_kn", "Largest load of the fit, kN", |at| Some(at.law?.law.range_kn[1]);
        "law_max_rel_error", "Largest difference of the law from the tangents of the solid, relative",
            |at| Some(at.law?.law.max_rel_error);
        "published_secant_ratio", "Secant stiffness against the held foot from 20 to 120 kN over that of the published law",
            |at| at.shift.published_secant_ratio;
        "error_band_missing", "Why parts of the error band are missing",
            |at| at.shift.error_band.as_ref().map(|band| band.missing.join("; ")).unwrap_or_default();
        "reason", "Why there is no law, or why it ends before the largest load",
            |at| at.shift.reason.clone().unwrap_or_default();
    }
}

/// Of two contacts, the one that carries less.
fn second(load: &FixedLoadRecord) -> Option<ContactRecord> {
    let [a, b] = load.contacts[..] else { return None };
    Some(if a.force_kn < b.force_kn { a } else { b })
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
        &properties(&columns()),
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
