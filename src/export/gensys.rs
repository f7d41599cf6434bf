//! GENSYS: profiles for KPF, and the stiffness over the contact angle as the two vectors of a memory field.
//!
//! KPF reads two columns in mm, y towards the track centre, z down, from the field side on; a wheel's origin is on the running
//! circle, a rail's beside it at the height of its top. The springs between wheel and rail, `knwr` and `knfr`, are
//! perpendicular to the contact and take their stiffness from a memory field over the contact angle.

use std::fmt::Write as _;

use nalgebra::Point2;
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::units::{KILONEWTON_PER_METRE, MILLIMETRE};

use super::spring::{ExportFile, Spring, commented};
use super::surfaces::Surfaces;
use crate::results::by_angle::record::ShiftRecord;
use crate::table::document::DirectionKey;

/// Extent of a wheel's profile in KPF, mm.
const WHEEL: [f64; 2] = [-60.0, 69.0];

/// Angles closer than this are one of the field, degrees: its vector has to ascend.
const SAME_ANGLE: f64 = 0.01;

/// Both profiles, and a field for every load that the laws by contact angle have.
///
/// # Errors
/// [`InputError`] where no shift has the reference.
pub(super) fn files(
    spring: &Spring,
    surfaces: &Surfaces<'_>,
    laws: &[ShiftRecord],
) -> Result<Vec<ExportFile>> {
    let track = &surfaces.study.track;
    let circle = surfaces.geometry.pair.tape_y - track.lateral_shift;
    let wheel =
        profile(spring, "wheel", "y = 0, z = 0 on the running circle", &ascending(&surfaces.wheel(), WHEEL));
    let of_rail = format!(
        "inclined as in the track; z = 0 at its top, y = 0 {:.4} mm from the gauge face, at the wheel's running circle",
        (circle - 0.5 * track.gauge) / MILLIMETRE
    );
    let rail = profile(
        spring,
        "rail",
        &of_rail,
        &ascending(&surfaces.rail(circle), [f64::NEG_INFINITY, f64::INFINITY]),
    );
    let mut loads: Vec<f64> =
        laws.iter().flat_map(|shift| shift.loads.iter().map(|load| load.force_kn)).collect();
    loads.sort_by(f64::total_cmp);
    loads.dedup();
    let mut files = vec![wheel, rail];
    for load in loads {
        files.extend(field(spring, laws, load));
    }
    if files.len() == 2 {
        return Err(InputError::new(
            "laws by contact angle",
            format!("no load with a stiffness against {:?} at two angles", spring.reference),
            "laws by contact angle with fixed loads in their range",
            "give more shifts (calibration.shifts_mm of a study, shifts_mm of a table), or name another --reference",
        )
        .into());
    }
    Ok(files)
}

/// The part of a surface on which y ascends towards the track centre, within an extent in mm.
fn ascending(surface: &[Point2<f64>], [from, to]: [f64; 2]) -> Vec<[f64; 2]> {
    let mut rows: Vec<[f64; 2]> = Vec::new();
    let turned = surface.iter().rev().map(|p| [0.0 - p.x / MILLIMETRE, p.y / MILLIMETRE]);
    for row in turned.filter(|row| (from..=to).contains(&row[0])) {
        // where a side overhangs, what is nearer to the top is what a wheel can touch
        match rows.last() {
            Some(last) if row[0] <= last[0] => {
                if row[1] < last[1] {
                    while rows.last().is_some_and(|last| row[0] <= last[0]) {
                        rows.pop();
                    }
                    rows.push(row);
                }
            }
            _ => rows.push(row),
        }
    }
    rows
}

fn profile(spring: &Spring, body: &str, origin: &str, rows: &[[f64; 2]]) -> ExportFile {
    let own = [
        format!("columns: y and z, mm; y towards the track centre, z down; {origin}"),
        Surfaces::sentence(),
        "where a side is vertical or overhangs, y would not ascend: that part is left out".into(),
    ];
    let mut text = commented("#", &spring.heading(&format!("Profile of the {body} for KPF of GENSYS"), &own));
    for [y, z] in rows {
        let _ = writeln!(text, "{y:.6} {z:.6}");
    }
    ExportFile { name: format!("profile.{body}"), text }
}

/// The tangent stiffness over the contact angle under a load, if two angles have it.
fn field(spring: &Spring, laws: &[ShiftRecord], load_kn: f64) -> Option<ExportFile> {
    let reference = &spring.reference;
    let mut rows: Vec<[f64; 4]> = laws
        .iter()
        .filter_map(|shift| {
            let load = shift.loads.iter().find(|load| load.force_kn == load_kn)?;
            let point = load.references.iter().find(|point| &point.reference == reference)?;
            let shared = if load.contacts.len() > 1 { 1.0 } else { 0.0 };
            Some([shift.angle()?, point.tangent_kn_per_m * KILONEWTON_PER_METRE, shift.shift_mm, shared])
        })
        .collect();
    rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
    rows.dedup_by(|next, kept| next[0] - kept[0] < SAME_ANGLE);
    let ([least, ..], [largest, ..]) = (rows.first()?, rows.last()?);
    if rows.len() < 2 {
        return None;
    }
    let own = [
        match spring.direction {
            DirectionKey::Vertical => "the law above is vertical and of the study's own shift; the field is along the normal at each shift",
            DirectionKey::Normal => "the law above is of one shift; the field is along the normal at each shift of the pair",
        }
        .into(),
        "a memory field, for knwr (tread) and knfr (flange) alike, as each is taken at its own contact angle".into(),
        "columns: X, contact angle, rad; Y, stiffness along the contact normal, N/m; behind #, lateral shift of the wheelset, mm"
            .into(),
        "where two contacts share the load the stiffness is that of the pair, along the normal of the first touch".into(),
        format!(
            "the stiffness is the tangent of the solid model under {load_kn} kN along the contact normal: a linear spring for loads \
             about that one"
        ),
        format!("angles from {least:.3} to {largest:.3} degrees; beyond them nothing is known"),
        "the manual's func cr_mem takes an X- and a Y-vector; the order of its arguments was not tried in GENSYS".into(),
        "where the track has no vertical freedom in GENSYS, its flexibility has to be added to this one".into(),
    ];
    let what = format!("Contact stiffness over the contact angle under {load_kn} kN for GENSYS");
    let mut text = commented("#", &spring.heading(&what, &own));
    for [angle, stiffness, shift, shared] in &rows {
        let pair = if *shared > 0.0 { ", two contacts" } else { "" };
        let _ = writeln!(text, "{:.9} {stiffness:.6e}  # {shift}{pair}", angle.to_radians());
    }
    Some(ExportFile { name: format!("stiffness_over_angle_{load_kn}kn.dat"), text })
}
