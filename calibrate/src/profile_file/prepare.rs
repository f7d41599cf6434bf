//! From the points of a file to a curve: checks, repair, smoothing.

use nalgebra::Point2;

use super::check::{remove_duplicates, remove_spikes, repair_steps_back, restore_order, thin_by_means};
use super::finding::{Action, Finding, FindingKind};
use super::kinks::{find_kinks, report_gaps, report_range};
use super::loops::cut_loops;
use super::smooth::smooth;
use super::text::error_at;
use super::{MeasuredPoint, MeasuredProfile};
use crate::error::{Error, Result};
use crate::profile::ProfileCurve;
use crate::units::MILLIMETRE;

/// One micrometre in metres.
const MICROMETRE: f64 = 1e-6;
/// Least distance of the points that the curve runs through, m; closer ones tell nothing but their rounding.
const LEAST_STEP: f64 = 0.01 * MILLIMETRE;
/// Wavelength below which a departure counts as scatter, m.
const SCATTER_WAVELENGTH: f64 = 2.0 * MILLIMETRE;
/// Distance within which a point of lines and arcs is one of their joints, m.
const SAME_PLACE: f64 = 1e-9;
/// Scatter from which smoothing is advised, m.
const SCATTER: f64 = 2.0 * MICROMETRE;

/// How a profile is prepared.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PrepareOptions {
    /// Wavelength (m) that the smoothing spline halves; `None` leaves the points where they are.
    pub smoothing: Option<f64>,
}

/// A profile that has been checked and repaired.
#[derive(Debug, Clone, PartialEq)]
pub struct Prepared {
    /// The points that are left, in order, m.
    pub points: Vec<MeasuredPoint>,
    /// Indices of the points at which the profile has a real corner.
    pub kinks: Vec<usize>,
    /// The curve through them, with the corners.
    pub curve: ProfileCurve,
    /// All findings, the reader's first.
    pub findings: Vec<Finding>,
}

/// Checks and repairs a profile and makes its curve. That of lines and arcs is exact.
///
/// # Errors
/// [`crate::error::InputError`] with the line of the file for what cannot be repaired: points in no order, long
/// loops, too few points left.
pub fn prepare(profile: &MeasuredProfile, options: &PrepareOptions) -> Result<Prepared> {
    let name = &profile.name;
    let mut findings = profile.findings.clone();
    if let Some(drawing) = &profile.drawn {
        let points = profile.points.clone();
        if options.smoothing.is_some() {
            let text = "lines and arcs have no scatter: not smoothed";
            findings.push(Finding::new(FindingKind::Smoothed, Action::Noted, text));
        }
        report_range(profile.kind, &points, &mut findings);
        let curve = drawing.curve();
        let corners: Vec<Point2<f64>> = curve.kinks().iter().map(|&s| curve.point(s)).collect();
        let same = |p: &MeasuredPoint, corner: &Point2<f64>| (p.point - corner).norm() < SAME_PLACE;
        let kinks = (0..points.len()).filter(|&i| corners.iter().any(|c| same(&points[i], c))).collect();
        return Ok(Prepared { points, kinks, curve, findings });
    }
    let mut points = repaired(profile, &mut findings)?;
    report_gaps(&points, &mut findings);
    let kinks = find_kinks(&points, &mut findings);
    report_range(profile.kind, &points, &mut findings);
    match options.smoothing {
        Some(wavelength) => {
            let smoothed = smooth(&points, &kinks, wavelength)?;
            points = smoothed.points;
            let line = smoothed.largest_line;
            let text = format!(
                "largest deviation of a smoothing spline that halves waves of {} mm, RMS {:.3} \u{b5}m",
                wavelength / MILLIMETRE,
                smoothed.rms / MICROMETRE
            );
            findings.push(
                Finding::new(FindingKind::Smoothed, Action::Repaired, text)
                    .on_lines(line, line)
                    .with_value(smoothed.largest / MICROMETRE, "\u{b5}m"),
            );
        }
        None => {
            let scatter = smooth(&points, &kinks, SCATTER_WAVELENGTH)?.rms;
            if scatter > SCATTER {
                let text = "RMS of waves shorter than 2 mm: curvatures are unsure, smoothing is advised";
                findings.push(
                    Finding::new(FindingKind::Noise, Action::Left, text)
                        .with_value(scatter / MICROMETRE, "\u{b5}m"),
                );
            }
        }
    }
    let places: Vec<Point2<f64>> = points.iter().map(|p| p.point).collect();
    let curve = ProfileCurve::from_points(&places, &kinks).map_err(|error| in_file(name, &points, error))?;
    Ok(Prepared { points, kinks, curve, findings })
}

/// The points of a profile in order, without duplicates, spikes, steps back and loops; what was done is added to `findings`.
///
/// # Errors
/// As [`prepare`].
pub fn repaired(profile: &MeasuredProfile, findings: &mut Vec<Finding>) -> Result<Vec<MeasuredPoint>> {
    let name = &profile.name;
    let mut points = profile.points.clone();
    remove_duplicates(&mut points, findings);
    enough(name, &points)?;
    restore_order(name, &mut points, findings)?;
    remove_spikes(&mut points, findings);
    thin_by_means(&mut points, findings);
    repair_steps_back(&mut points, findings);
    remove_duplicates(&mut points, findings);
    enough(name, &points)?;
    cut_loops(name, &mut points, findings)?;
    thin_close(&mut points, findings);
    enough(name, &points)?;
    Ok(points)
}

fn enough(name: &str, points: &[MeasuredPoint]) -> Result<()> {
    if points.len() >= 4 {
        return Ok(());
    }
    let line = points.first().map_or(1, |p| p.line);
    let value = format!("{} points", points.len());
    Err(error_at(name, line, 1, &value, "at least 4 different points", "give the whole profile"))
}

/// Drops points nearer to their predecessor than the curve can use; the last point stays.
fn thin_close(points: &mut Vec<MeasuredPoint>, findings: &mut Vec<Finding>) {
    let before = points.len();
    let mut kept: Vec<MeasuredPoint> = Vec::with_capacity(before);
    for p in points.iter() {
        if kept.last().is_none_or(|last| (p.point - last.point).norm() >= LEAST_STEP) {
            kept.push(*p);
        }
    }
    if let (Some(end), Some(last)) = (points.last(), kept.last())
        && end != last
    {
        if kept.len() > 1 {
            kept.pop();
        }
        kept.push(*end);
    }
    *points = kept;
    if points.len() < before {
        let text = "closer than 0.01 mm to their predecessors: dropped";
        findings.push(
            Finding::new(FindingKind::Thinned, Action::Repaired, text)
                .with_value((before - points.len()) as f64, "points"),
        );
    }
}

/// Gives an error about a point the line from which it comes.
fn in_file(name: &str, points: &[MeasuredPoint], error: Error) -> Error {
    let Error::Input(input) = &error else { return error };
    let index = input
        .key
        .strip_prefix("profile.points[")
        .and_then(|rest| rest.strip_suffix(']'))
        .and_then(|index| index.parse::<usize>().ok());
    match index.and_then(|index| points.get(index)) {
        Some(p) => error_at(name, p.line, 1, &input.value, &*input.expected, &*input.remedy),
        None => error_at(name, points[0].line, 1, &input.value, &*input.expected, &*input.remedy),
    }
}
