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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::study::Study;

    /// Goal: of a worn head that is cut off 20 mm to the field side of its top, with one spike, the picture says what was measured, changed
    /// and joined. The parts meet, bit for bit; the spike of 1 mm is the largest change. DISCRETISATION: the crown is inclined by less than
    /// 0.07 there, and the spike stands upright, so that its distance is less by 0.3 % at most, and by the scatter of 2 micrometres.
    #[test]
    fn a_short_head_with_a_spike() {
        const DISCRETISATION: f64 = 0.01e-3;
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut study = Study::read(&root.join("data/studies/worn.toml")).unwrap();
        let measured = study.rail.measured.as_mut().unwrap();
        let text = String::from_utf8(measured.content.to_vec()).unwrap();
        let row = |line: &str| -> Option<(f64, f64)> {
            let (y, z) = line.trim().split_once(char::is_whitespace)?;
            Some((y.parse().ok()?, z.trim().parse().ok()?))
        };
        let at = text.lines().position(|line| row(line).is_some_and(|(y, _)| y >= 5.0)).unwrap();
        let lines = text.lines().enumerate().filter_map(|(n, line)| match row(line) {
            Some((y, _)) if y > 20.0 => None,
            Some((y, z)) if n == at => Some(format!("{y} {}", z - 1.0)),
            _ => Some(line.to_owned()),
        });
        measured.content = Arc::from(lines.collect::<Vec<_>>().join("\n").into_bytes());
        let geometry = crate::results::bodies::geometry::geometry(&study).unwrap();
        let head = &geometry.surfaces[0];
        assert_eq!(
            (head.body.as_str(), head.standard.as_str(), geometry.surfaces.len()),
            ("rail", "60E1", 2)
        );
        let largest = head.changed.iter().max_by(|a, b| a.change.total_cmp(&b.change)).unwrap();
        assert_eq!(largest.line, at + 1);
        assert!((largest.change - 1e-3).abs() < DISCRETISATION, "{largest:?}");
        assert!((largest.read.point.x - 5e-3).abs() < 0.5e-3);
        let surface: Vec<&Part> = head
            .parts
            .iter()
            .filter(|part| part.running)
            .take_while(|part| part.origin != Origin::MeasuredUnused && part.origin != Origin::StandardUnused)
            .collect();
        for pair in surface.windows(2) {
            assert_eq!(pair[0].points.last(), pair[1].points.first());
        }
        let origins: Vec<Origin> = surface.iter().map(|part| part.origin).collect();
        let ends = [Origin::Measured, Origin::Transition, Origin::Standard];
        assert_eq!(origins[origins.len() - 3..], ends, "{origins:?}");
        let end = surface[surface.len() - 3].points.last().unwrap();
        assert!((end.x - 20e-3).abs() < 0.5e-3, "{end}");
        let whole: f64 = surface.iter().map(|part| part.length).sum();
        assert!((whole - geometry.pair.rail.running.length()).abs() < 1e-12);
        // The transition ends on the standard.
        let last = head.transitions.last().unwrap().last().unwrap();
        assert!(last.missing.abs() < 1e-9, "{last:?}");
    }
}
