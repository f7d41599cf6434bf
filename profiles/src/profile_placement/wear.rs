//! What is read off a placed profile.

use super::placed::Placed;
use super::reference::Reference;
use crate::profile::ProfileCurve;
use crate::units::MILLIMETRE;

/// Depth below the top of the new rail at which its side wear is read, m.
const SIDE_DEPTH: f64 = 14.0 * MILLIMETRE;
/// Height of the point of the flange face below the tread at the tape circle, m.
const FACE_DEPTH: f64 = 10.0 * MILLIMETRE;
/// Distance from the tip of the flange at which qR begins, m.
const FROM_TIP: f64 = 2.0 * MILLIMETRE;
/// Part of the tread over which its hollow is read: from the tape circle towards the throat and to the field side, m.
const TREAD: [f64; 2] = [-20.0 * MILLIMETRE, 58.0 * MILLIMETRE];
/// Step at which curves are read, m.
const STEP: f64 = 0.05 * MILLIMETRE;

/// Wear of a rail, m; `None` where the profile does not reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RailWear {
    /// Height that is missing on the axis.
    pub vertical: Option<f64>,
    /// Width that is missing at the gauge face, 14 mm below the top of the new rail.
    pub lateral: Option<f64>,
}

/// Measures of a wheel, m; `None` where the profile does not reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelWear {
    /// Height of the flange Sh: of its tip against the tread at the tape circle.
    pub flange_height: Option<f64>,
    /// Thickness of the flange Sd: from its back to its face 10 mm below the tread at the tape circle.
    pub flange_thickness: Option<f64>,
    /// qR: width of the face between that point and the one 2 mm above the tip.
    pub flange_slope: Option<f64>,
    /// Radius that is missing at the tape circle.
    pub tread: Option<f64>,
    /// Hollow of the tread: how much larger the radius is somewhere on its field side than nearer to the flange.
    pub hollow: Option<f64>,
}

/// Depth that a placed profile is missing across its standard, at most, m.
pub fn deepest_wear(placed: &Placed, reference: &Reference) -> f64 {
    let worn = placed.points.iter().filter(|p| reference.runs(p.s)).map(|p| p.missing);
    worn.fold(0.0, f64::max)
}

/// Wear of a rail from its placed curve (y to the field side) against its standard.
pub fn rail_wear(curve: &ProfileCurve, reference: &Reference) -> RailWear {
    // The gauge side: the first place from the top towards -y where the curve goes through the level.
    let gauge = |curve: &ProfileCurve| across(curve, SIDE_DEPTH, Way::ToLess);
    let difference = |new: Option<f64>, worn: Option<f64>| Some(worn? - new?);
    RailWear {
        vertical: difference(z_at(&reference.curve, 0.0), z_at(curve, 0.0)),
        lateral: difference(gauge(&reference.curve), gauge(curve)),
    }
}

/// Measures of a wheel from its placed curve.
pub fn wheel_wear(curve: &ProfileCurve, reference: &Reference) -> WheelWear {
    let tread = z_at(curve, 0.0);
    let back = reference.curve.point(reference.running[0]).x;
    let tip = curve
        .sample(STEP)
        .into_iter()
        .max_by(|a, b| a.y.total_cmp(&b.y))
        // A profile that ends on the flange may end before its tip.
        .filter(|tip| [0.0, curve.length()].iter().all(|&s| curve.point(s) != *tip));
    let face = |depth: f64| across(curve, depth, Way::FromTip);
    let flange_face = tread.and_then(|tread| face(tread + FACE_DEPTH));
    let near_tip = tip.and_then(|tip| face(tip.y - FROM_TIP));
    let hollow = (z_at(curve, TREAD[0]).is_some() && tread.is_some()).then(|| {
        let mut smallest = f64::INFINITY;
        let inside = curve.sample(STEP).into_iter().filter(|p| (TREAD[0]..=TREAD[1]).contains(&p.x));
        inside.fold(0.0_f64, |hollow, p| {
            smallest = smallest.min(p.y);
            hollow.max(p.y - smallest)
        })
    });
    WheelWear {
        flange_height: Some((tip, tread)).and_then(|(tip, tread)| Some(tip?.y - tread?)),
        flange_thickness: flange_face.map(|y| y - back),
        flange_slope: Some((flange_face, near_tip)).and_then(|(face, tip)| Some(face? - tip?)),
        tread: tread.and_then(|worn| Some(z_at(&reference.curve, 0.0)? - worn)),
        hollow,
    }
}

/// z where the curve crosses y.
fn z_at(curve: &ProfileCurve, y: f64) -> Option<f64> {
    curve.s_at_y(y).map(|s| curve.point(s).y)
}

/// Where a curve is looked for.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    /// From the top towards small y.
    ToLess,
    /// From the flange's tip towards large y.
    FromTip,
}

/// y at which the curve crosses the level `z`, the first from its top or from the flange's tip on.
fn across(curve: &ProfileCurve, z: f64, way: Way) -> Option<f64> {
    let points = curve.sample(STEP);
    let best = |a: &usize, b: &usize| points[*a].y.total_cmp(&points[*b].y);
    let crossing = |pair: &[nalgebra::Point2<f64>]| {
        let (a, b) = (pair[0], pair[1]);
        ((a.y - z) * (b.y - z) <= 0.0 && a.y != b.y).then(|| a.x + (z - a.y) / (b.y - a.y) * (b.x - a.x))
    };
    match way {
        Way::ToLess => {
            let top = (0..points.len()).min_by(best)?;
            points[..=top].windows(2).rev().find_map(crossing)
        }
        Way::FromTip => {
            let tip = (0..points.len()).max_by(best)?;
            points[tip..].windows(2).find_map(crossing)
        }
    }
}
