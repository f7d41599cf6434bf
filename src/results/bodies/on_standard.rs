//! A measured profile on its standard, as the report and `profile place` draw it.

use nalgebra::Point2;
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::profile_file::{MeasuredProfile, Prepared, ProfileKind};
use railspring_profiles::profile_placement::{Placed, Reference, missing};
use railspring_profiles::section::{RailSection, WheelSection};
use railspring_profiles::units::MILLIMETRE;

use crate::results::bodies::surface_figure::{CHANGED, Changed, OffStandard, OnStandard, Origin, Part};

/// Distance of the points of a picture, m.
const STEP: f64 = 0.25 * MILLIMETRE;
/// Distance of the marks on what the placing kept, m.
const MARKS: f64 = 1.5 * MILLIMETRE;
/// Weight from which a point counts as kept.
const KEPT: f64 = 0.5;
/// Parts that are shorter are rounding, m.
const SHORT: f64 = 1e-9;

/// A measured surface joined to a standard section: the joined curve, and the arc lengths at which its parts meet.
#[derive(Clone, Copy)]
pub struct Seams<'a> {
    curve: &'a ProfileCurve,
    at: [f64; 4],
}

impl<'a> Seams<'a> {
    /// Those of a rail's section, if it has a measured head.
    pub fn of_rail(section: &'a RailSection) -> Option<Self> {
        section.seams.map(|at| Self { curve: &section.running, at })
    }

    /// Those of a wheel's section, if it has a measured profile.
    pub fn of_wheel(section: &'a WheelSection) -> Option<Self> {
        section.seams.map(|at| Self { curve: &section.running, at })
    }
}

/// A profile as it was read but in its place, and as it was prepared; `seams` are those of the section with it, if it could be joined,
/// and `placed` says what the placing kept.
pub fn on_standard(
    file: &str,
    reference: &Reference,
    (read, prepared): (&MeasuredProfile, &Prepared),
    seams: Option<Seams<'_>>,
    placed: Option<&Placed>,
) -> OnStandard {
    let off = |p: &Point2<f64>| {
        let (s, missing) = missing(reference, p);
        OffStandard { point: *p, along: along(reference, s), missing }
    };
    let parts = parts(reference, &prepared.curve, seams);
    let transition = |part: &&Part| part.origin == Origin::Transition;
    let transitions =
        parts.iter().filter(transition).map(|part| part.points.iter().map(off).collect()).collect();
    let mut measured: Vec<OffStandard> =
        apart(&prepared.points, |p| p.point).map(|p| off(&p.point)).collect();
    measured.sort_by(|a, b| a.along.total_cmp(&b.along));
    let kept = placed.map_or(&[][..], |placed| &placed.points);
    let kept: Vec<_> = kept.iter().filter(|p| p.kept > KEPT).copied().collect();
    let kept = apart_by(&kept, |p| p.point, MARKS)
        .map(|p| OffStandard { point: p.point, along: along(reference, p.s), missing: p.missing })
        .collect();
    let mut guess = None;
    let changed = read.points.iter().filter_map(|p| {
        let (s, change) = match guess {
            Some(near) => prepared.curve.closest_near(&p.point, near),
            None => prepared.curve.closest(&p.point),
        };
        guess = Some(s);
        (change > CHANGED).then(|| Changed { read: off(&p.point), change, line: p.line })
    });
    OnStandard {
        body: reference.kind.name().into(),
        file: file.into(),
        standard: reference.name.clone(),
        measured,
        transitions,
        kept,
        read: read.points.len(),
        left: prepared.points.len(),
        changed: changed.collect(),
        parts,
    }
}

/// Arc length on the outline of the standard from the start of its running surface. A rail's outline is closed: what lies before its
/// running surface is at its end.
fn along(reference: &Reference, s: f64) -> f64 {
    let whole = reference.curve.length();
    let rest = 0.5 * (reference.running[1] + whole);
    let before = reference.kind == ProfileKind::Rail && s > rest;
    s - reference.running[0] - if before { whole } else { 0.0 }
}

/// Points that lie apart from those before them, so that a picture of many points stays small.
fn apart<T>(points: &[T], at: impl Fn(&T) -> Point2<f64>) -> impl Iterator<Item = &T> {
    /// Least distance, m.
    const LEAST: f64 = 0.05 * MILLIMETRE;
    apart_by(points, at, LEAST)
}

fn apart_by<T>(points: &[T], at: impl Fn(&T) -> Point2<f64>, distance: f64) -> impl Iterator<Item = &T> {
    let mut last: Option<Point2<f64>> = None;
    points.iter().filter(move |p| {
        let far = last.is_none_or(|last| (at(p) - last).norm() >= distance);
        if far {
            last = Some(at(p));
        }
        far
    })
}

/// The parts of the surface in their order, then what is not used of both, and the rest of the outline.
fn parts(reference: &Reference, measured: &ProfileCurve, seams: Option<Seams<'_>>) -> Vec<Part> {
    let outline = &reference.curve;
    let mut parts = Vec::new();
    let mut add = |origin, curve: &ProfileCurve, from: f64, to: f64, running| {
        if to - from > SHORT {
            let inner = curve.sample_parameters(STEP).into_iter().filter(|s| *s > from && *s < to);
            let all = std::iter::once(from).chain(inner).chain(std::iter::once(to));
            parts.push(Part {
                origin,
                points: all.map(|s| curve.point(s)).collect(),
                length: to - from,
                running,
            });
        }
    };
    let [start, end] = reference.running;
    let (whole, last) = (outline.length(), measured.length());
    match seams {
        None => {
            add(Origin::Standard, outline, 0.0, whole, false);
            add(Origin::Measured, measured, 0.0, last, true);
        }
        Some(Seams { curve, at }) => {
            let length = curve.length();
            add(Origin::Standard, curve, 0.0, at[0], true);
            add(Origin::Transition, curve, at[0], at[1], true);
            add(Origin::Measured, curve, at[1], at[2], true);
            add(Origin::Transition, curve, at[2], at[3], true);
            add(Origin::Standard, curve, at[3], length, true);
            let taken = [at[1], at[2]].map(|s| measured.closest(&curve.point(s)).0);
            add(Origin::MeasuredUnused, measured, 0.0, taken[0], true);
            add(Origin::MeasuredUnused, measured, taken[1], last, true);
            // At an end of the running surface of a closed outline the nearest place may be that of the other end.
            let left = if at[0] > SHORT { outline.closest(&curve.point(at[0])).0 } else { start };
            let reached = if length - at[3] > SHORT { outline.closest(&curve.point(at[3])).0 } else { end };
            add(Origin::StandardUnused, outline, left, reached, true);
            add(Origin::Standard, outline, 0.0, start, false);
            add(Origin::Standard, outline, end, whole, false);
        }
    }
    parts
}
