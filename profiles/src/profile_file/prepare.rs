//! From the points of a file to a curve: checks, repair, smoothing.

use nalgebra::Point2;
use serde::Serialize;

use super::check::{remove_duplicates, remove_spikes, repair_steps_back, restore_order, thin_by_means};
use super::corners::add_corners;
use super::finding::{Action, Finding, FindingKind};
use super::kinks::{find_kinks, report_gaps, report_range};
use super::local_wavelength::local_wavelengths;
use super::loops::cut_loops;
use super::measured::{MeasuredPoint, MeasuredProfile};
use super::replicates::replicates;
use super::scatter::scatter;
use super::smooth::smooth;
use super::text::error_on;
use super::wavelength::wavelength;
use crate::error::{Error, Result};
use crate::profile::ProfileCurve;
use crate::units::MILLIMETRE;

/// One micrometre in metres.
const MICROMETRE: f64 = 1e-6;
/// Least distance of the points that the curve runs through, m; closer ones tell nothing but their rounding.
const LEAST_STEP: f64 = 0.01 * MILLIMETRE;
/// Distance within which a point of lines and arcs is one of their joints, m.
const SAME_PLACE: f64 = 1e-9;

/// How a profile is prepared.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PrepareOptions {
    /// What is done about the scatter of the points.
    pub smoothing: Smoothing,
}

/// What is done about the scatter of a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub enum Smoothing {
    /// It is measured, and as much smoothed as it takes.
    #[default]
    ByScatter,
    /// A spline halves waves of this length, m.
    Halves(f64),
    /// The points stay where they are.
    Off,
}

impl Smoothing {
    /// Of the length of the waves that are halved as users give it, m: 0 leaves the points where they are, and without one the scatter decides.
    pub fn of(wavelength: Option<f64>) -> Self {
        match wavelength {
            None => Self::ByScatter,
            Some(0.0) => Self::Off,
            Some(wavelength) => Self::Halves(wavelength),
        }
    }
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
    /// The same without a quarter of the points each ([`REPLICATES`](super::REPLICATES)); none where no scatter was smoothed.
    pub replicates: Vec<ProfileCurve>,
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
        if let Smoothing::Halves(_) = options.smoothing {
            let text = "lines and arcs have no scatter: not smoothed";
            findings.push(Finding::new(FindingKind::Smoothed, Action::Noted, text));
        }
        report_range(profile.kind, &points, &mut findings);
        let curve = drawing.curve();
        let corners: Vec<Point2<f64>> = curve.kinks().iter().map(|&s| curve.point(s)).collect();
        let same = |p: &MeasuredPoint, corner: &Point2<f64>| (p.point - corner).norm() < SAME_PLACE;
        let kinks = (0..points.len()).filter(|&i| corners.iter().any(|c| same(&points[i], c))).collect();
        return Ok(Prepared { points, kinks, curve, replicates: Vec::new(), findings });
    }
    let mut points = repaired(profile, &mut findings)?;
    report_gaps(&points, &mut findings);
    let mut kinks = find_kinks(&points, &mut findings);
    report_range(profile.kind, &points, &mut findings);
    let replicates = smooth_points(&mut points, &mut kinks, options.smoothing, &mut findings)?;
    let places: Vec<Point2<f64>> = points.iter().map(|p| p.point).collect();
    let curve = ProfileCurve::from_points(&places, &kinks).map_err(|error| in_file(name, &points, error))?;
    Ok(Prepared { points, kinks, curve, replicates, findings })
}

/// Smooths the points, and says what was measured and done; corners in the scatter are added to `kinks`. Returns the smoothed curves without a quarter of the
/// points each.
fn smooth_points(
    points: &mut Vec<MeasuredPoint>,
    kinks: &mut Vec<usize>,
    smoothing: Smoothing,
    findings: &mut Vec<Finding>,
) -> Result<Vec<ProfileCurve>> {
    let measured = scatter(&pieces(points, kinks));
    let micrometres = |length: f64| format!("{:.3} \u{b5}m", length / MICROMETRE);
    let noise = |action, text: String| {
        Finding::new(FindingKind::Noise, action, text).with_value(measured.deviation / MICROMETRE, "\u{b5}m")
    };
    let advised = wavelength(&measured);
    let (longest, wavelengths) = match (smoothing, advised) {
        (Smoothing::Halves(wavelength), _) => (wavelength, vec![wavelength; points.len()]),
        (Smoothing::ByScatter, Some(wavelength)) => {
            add_corners(points, kinks, &measured, wavelength, findings);
            (wavelength, local_wavelengths(points, kinks, &measured, wavelength)?)
        }
        (Smoothing::Off, Some(advised)) => {
            let text = format!(
                "scatter of the points across the profile, not smoothed, as requested: curvatures and pressures are unsure; \
                 it takes a smoothing that halves waves of {:.2} mm",
                advised / MILLIMETRE
            );
            findings.push(noise(Action::Noted, text));
            return Ok(Vec::new());
        }
        (_, None) => return Ok(Vec::new()),
    };
    let without_quarters = replicates(points, kinks, measured.together, &wavelengths)?;
    let smoothed = smooth(points, kinks, &wavelengths)?;
    let (line, moved) = (smoothed.largest_line, smoothed.largest);
    findings.push(match smoothing {
        Smoothing::Halves(_) => {
            let text = format!(
                "largest deviation of a smoothing spline that halves waves of {} mm, RMS {}",
                longest / MILLIMETRE,
                micrometres(smoothed.rms)
            );
            Finding::new(FindingKind::Smoothed, Action::Repaired, text)
                .on_lines(line, line)
                .with_value(moved / MICROMETRE, "\u{b5}m")
        }
        _ => {
            let shortest = wavelengths.iter().copied().fold(longest, f64::min);
            let less = match shortest < longest {
                true => format!(", of {:.2} mm and more where the curvature jumps", shortest / MILLIMETRE),
                false => String::new(),
            };
            let text = format!(
                "scatter of the points across the profile: smoothed by a spline that halves waves of {:.2} mm{less}, which moves \
                 them by {} (RMS), line {line} by {}",
                longest / MILLIMETRE,
                micrometres(smoothed.rms),
                micrometres(moved)
            );
            noise(Action::Repaired, text)
        }
    });
    *points = smoothed.points;
    Ok(without_quarters)
}

/// The points between the corners; those without weight are left out where others have one.
fn pieces(points: &[MeasuredPoint], kinks: &[usize]) -> Vec<Vec<Point2<f64>>> {
    let weightless = points.iter().all(|p| p.weight <= 0.0);
    let mut start = 0;
    let ends = kinks.iter().copied().chain([points.len() - 1]);
    ends.map(|end| {
        let piece = &points[start..=end];
        start = end;
        piece.iter().filter(|p| weightless || p.weight > 0.0).map(|p| p.point).collect()
    })
    .collect()
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
    let value = if points.len() == 1 { "1 point".into() } else { format!("{} points", points.len()) };
    Err(error_on(name, line, &value, "at least 4 different points", "give the whole profile"))
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
        Some(p) => error_on(name, p.line, &input.value, &*input.expected, &*input.remedy),
        None => error_on(name, points[0].line, &input.value, &*input.expected, &*input.remedy),
    }
}
