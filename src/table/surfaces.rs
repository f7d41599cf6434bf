//! What a measured surface of a table is, beside the springs that it makes: its wear, its deviation from its standard, and the running of a wheelset on it.

use railspring_calibrate::pair::Pair;
use railspring_profiles::error::Result;
use railspring_profiles::placement::TouchSearch;
use railspring_profiles::profile_placement::{RailWear, Reference, WheelWear, rail_wear, wheel_wear};
use railspring_profiles::rigid_contact::{RunningFunction, RunningPoint};
use railspring_profiles::units::MILLIMETRE;
use serde::{Deserialize, Serialize};

use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::places::tape_y;
use crate::results::bodies::surface_figure::OnStandard;
use crate::study::Statics;

/// Amplitudes of the equivalent conicity, mm.
pub(super) const AMPLITUDES_MM: [f64; 5] = [1.0, 2.0, 3.0, 4.0, 5.0];
/// Largest shift of the running function, and the step between its points, m.
const RANGE: f64 = 8.0 * MILLIMETRE;
const STEPS: i32 = 32;
/// Distance of the points of a deviation along the profile, m.
const APART: f64 = 2.5 * MILLIMETRE;
/// Lateral range of these points on a wheel and on a rail, m: what every measurement has.
const WHEEL_RANGE: [f64; 2] = [-35.0 * MILLIMETRE, 55.0 * MILLIMETRE];
const RAIL_RANGE: [f64; 2] = [-30.0 * MILLIMETRE, 30.0 * MILLIMETRE];
/// How near to such a point the profile must have been measured, m.
const NEAR: f64 = 2.0 * MILLIMETRE;

/// The measured surfaces of a pair, and how a wheelset of two such wheels runs on two such rails.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeasuredRecord {
    /// The wheel, if it was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wheel: Option<WheelRecord>,
    /// The rail, if it was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rail: Option<RailRecord>,
    /// Equivalent conicity (EN 15302) at the amplitudes 1 to 5 mm, the axle level; none where the wheelset does not swing so far.
    pub conicity: Vec<Option<f64>>,
    /// Where the wheel rolls on the rail as it shifts towards it, at 65 shifts up to 8 mm either way: its radius less that of the tape circle, mm; empty where it misses the rail in the
    /// range.
    pub rolling_radii_mm: Vec<f64>,
}

/// A measured wheel; lengths in mm, none where the profile does not reach.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WheelRecord {
    /// The standard, or the file of a section, that it was laid on.
    pub standard: String,
    /// What its lateral place may be off by, either way, mm; 0 where its file says the place.
    pub lateral_uncertainty_mm: f64,
    /// Sh.
    pub flange_height_mm: Option<f64>,
    /// Sd.
    pub flange_thickness_mm: Option<f64>,
    /// qR.
    pub flange_slope_mm: Option<f64>,
    /// Radius that is missing at the tape circle.
    pub tread_wear_mm: Option<f64>,
    /// Hollow of the tread.
    pub hollow_mm: Option<f64>,
    /// Its deviation from its standard.
    pub deviation: DeviationRecord,
}

/// A measured rail, likewise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RailRecord {
    /// The standard, or the file of a section, that it was laid on.
    pub standard: String,
    /// What its roll may be off by, either way, degrees; 0 where its file says the roll.
    pub roll_uncertainty_deg: f64,
    /// Height that is missing on the axis.
    pub vertical_wear_mm: Option<f64>,
    /// Width that is missing at the gauge face, 14 mm below the top of the new rail.
    pub lateral_wear_mm: Option<f64>,
    /// Its deviation from its standard.
    pub deviation: DeviationRecord,
}

/// A surface against its standard, at places of the standard that are the same for all of its files.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct DeviationRecord {
    /// Lateral places in the frame of the standard, mm.
    pub y_mm: Vec<f64>,
    /// Material that is missing there, µm; none where nothing was measured.
    pub missing_um: Vec<Option<f64>>,
}

impl MeasuredRecord {
    /// That of the pair of a study; none where neither was measured.
    pub fn of(statics: Statics<'_>, geometry: &Geometry) -> Option<Self> {
        let [of_rail, of_wheel] = &geometry.assumed;
        let (rail_base, wheel_base) = &geometry.bases;
        let on = |body: &str| geometry.surfaces.iter().find(|surface| surface.body == body);
        let wheel =
            of_wheel.as_ref().zip(on("wheel")).zip(wheel_base.as_ref()).map(|((assumed, surface), base)| {
                let reference = Reference::wheel(base);
                let WheelWear { flange_height, flange_thickness, flange_slope, tread, hollow } =
                    wheel_wear(&assumed.curve, &reference);
                WheelRecord {
                    standard: assumed.base.clone(),
                    lateral_uncertainty_mm: assumed.unsure.shift / MILLIMETRE,
                    flange_height_mm: in_mm(flange_height),
                    flange_thickness_mm: in_mm(flange_thickness),
                    flange_slope_mm: in_mm(flange_slope),
                    tread_wear_mm: in_mm(tread),
                    hollow_mm: in_mm(hollow),
                    deviation: deviation(&reference, surface, WHEEL_RANGE),
                }
            });
        let rail =
            of_rail.as_ref().zip(on("rail")).zip(rail_base.as_ref()).map(|((assumed, surface), base)| {
                let reference = Reference::rail(base);
                let RailWear { vertical, lateral } = rail_wear(&assumed.curve, &reference);
                RailRecord {
                    standard: assumed.base.clone(),
                    roll_uncertainty_deg: assumed.unsure.roll.to_degrees(),
                    vertical_wear_mm: in_mm(vertical),
                    lateral_wear_mm: in_mm(lateral),
                    deviation: deviation(&reference, surface, RAIL_RANGE),
                }
            });
        if wheel.is_none() && rail.is_none() {
            return None;
        }
        let radii = rolling_radii(statics, &geometry.pair);
        let running = radii.as_ref().map_err(Clone::clone).and_then(|radii| running(radii));
        let conicity = |mm: &f64| running.as_ref().ok()?.equivalent_conicity(mm * MILLIMETRE);
        let conicity = AMPLITUDES_MM.iter().map(conicity).collect();
        let rolling_radii_mm = radii.unwrap_or_default().into_iter().map(nanometre).collect();
        Some(Self { wheel, rail, conicity, rolling_radii_mm })
    }
}

/// In mm, to the nanometre.
fn nanometre(length: f64) -> f64 {
    (1e6 * length / MILLIMETRE).round() * 1e-6
}

fn in_mm(length: Option<f64>) -> Option<f64> {
    length.map(nanometre)
}

/// The shifts of the running function, m.
pub(super) fn running_shifts() -> Vec<f64> {
    (-STEPS..=STEPS).map(|step| RANGE * f64::from(step) / f64::from(STEPS)).collect()
}

/// Where the wheel rolls at these shifts towards its rail: its radius less that of the tape circle, m.
fn rolling_radii(statics: Statics<'_>, pair: &Pair) -> Result<Vec<f64>> {
    let touches = TouchSearch::new(&pair.placed, &pair.wheel.running);
    let radius = |shift: f64| -> Result<f64> {
        let at = touches.at(tape_y(statics, pair, shift))?;
        Ok(pair.wheel.running.point(at.wheel_s).y)
    };
    running_shifts().into_iter().map(radius).collect()
}

/// Rolling-radius difference of a wheelset of equal sides, its axle level.
fn running(radii: &[f64]) -> Result<RunningFunction> {
    let points = running_shifts().into_iter().zip(radii.iter().zip(radii.iter().rev()));
    let points = points.map(|(shift, (right, left))| RunningPoint { shift, difference: right - left });
    RunningFunction::from_points(points.collect())
}

/// The points of a surface beside places along its standard, between the two nearest.
fn deviation(reference: &Reference, surface: &OnStandard, [least, most]: [f64; 2]) -> DeviationRecord {
    let [from, to] = reference.running;
    let parts = ((to - from) / APART).floor() as usize;
    let measured = &surface.measured;
    let mut record = DeviationRecord::default();
    for part in 1..parts {
        let along = part as f64 * APART;
        let point = reference.curve.point(from + along);
        if !(least..=most).contains(&point.x) {
            continue;
        }
        record.y_mm.push((1e3 * point.x / MILLIMETRE).round() * 1e-3);
        let after = measured.partition_point(|p| p.along < along);
        let around =
            after.checked_sub(1).and_then(|before| Some((measured.get(before)?, measured.get(after)?)));
        let missing =
            around.filter(|(before, after)| along - before.along < NEAR && after.along - along < NEAR);
        record.missing_um.push(missing.map(|(before, after)| {
            let part = (along - before.along) / (after.along - before.along).max(f64::MIN_POSITIVE);
            (1e6 * (before.missing + part * (after.missing - before.missing))).round()
        }));
    }
    record
}
