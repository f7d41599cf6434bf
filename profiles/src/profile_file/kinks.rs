//! Gaps, real corners, and the range that a profile must cover.

use nalgebra::Vector2;

use super::check::{median, turn};
use super::finding::{Action, Finding, FindingKind, Findings};
use super::measured::MeasuredPoint;
use crate::profile::ProfileKind;
use crate::units::MILLIMETRE;

/// A gap is this many times the median step ...
const GAP_TO_STEP: f64 = 20.0;
/// ... and at least this long, m.
const SMALLEST_GAP: f64 = 0.5 * MILLIMETRE;
/// No step of a measurement is longer than this, m, ...
const LONGEST_STEP: f64 = 3.0 * MILLIMETRE;
/// ... or has an arc this far off its chord, m, however long the other steps are: 1.6 mm among equal steps on an arc of 13 mm, 2.3 mm among short ones.
const FARTHEST_ARC: f64 = 0.05 * MILLIMETRE;
/// A step of this length is one as well, m, ...
const LONG_GAP: f64 = 2.5 * MILLIMETRE;
/// ... and one whose chord may be this far off the line between its ends, m, ...
const HIDDEN: f64 = 0.1 * MILLIMETRE;
/// ... if they are this many times the median step.
const LONG_TO_STEP: f64 = 3.0;
/// A step on a straight line is no gap where it turns less than this from a neighbour, degrees, ...
const STRAIGHT: f64 = 1.0;
/// ... and is at most so many times as long as it; a step that is longer by more than this says nothing of its neighbours.
const AS_LONG: f64 = 3.0;
/// Steps of y are equal if all but a tenth at either end differ by less than this part of their median, ...
const EQUAL: f64 = 0.2;
/// ... and no row is missing where a step of y is at most so many times as long ...
const ONE_STEP: f64 = 1.5;
/// ... and the line no longer than the face of a flange or the side of a head is steep, m.
const LONGEST_ROW: f64 = 10.0 * MILLIMETRE;
/// Smallest length over which the direction beside a corner is taken, m.
const WINDOW: f64 = 1.0 * MILLIMETRE;
/// Points on either side of a corner that the direction is taken over at least.
const WINDOW_POINTS: usize = 3;
/// Smallest corner, degrees.
const SMALLEST_KINK: f64 = 1.0;
/// A corner turns by this many times the usual change of the turn from point to point.
const KINK_TO_SCATTER: f64 = 12.0;
/// Share of the turn within the window that is at the corner itself.
const CONCENTRATED: f64 = 0.7;

/// Reports long steps between neighbours, by their length alone, by what they may hide, and beside the other steps. Steps up to the absolute limit are none
/// along a straight line where those beside them are as long, and no step is one of y among equal ones, however steep.
pub(super) fn report_gaps(points: &[MeasuredPoint], findings: &mut Vec<Finding>) {
    let chords: Vec<Vector2<f64>> = points.windows(2).map(|w| w[1].point - w[0].point).collect();
    let median = median(chords.iter().map(|chord| chord.norm()).collect());
    let mut across: Vec<f64> = chords.iter().map(|chord| chord.x.abs()).collect();
    across.sort_unstable_by(f64::total_cmp);
    let (tenth, across_median) = (across.len() / 10, across[across.len() / 2]);
    let equal = across[across.len() - 1 - tenth] - across[tenth] < EQUAL * across_median;
    let mut gaps = Findings::new(findings, FindingKind::Gap);
    for (i, chord) in chords.iter().enumerate() {
        let length = chord.norm();
        let beside: Vec<&Vector2<f64>> =
            [i.checked_sub(1), Some(i + 1)].into_iter().filter_map(|k| chords.get(k?)).collect();
        // A step beside a hole turns by what the hole hides.
        let alike = beside.iter().filter(|other| other.norm() <= AS_LONG * length);
        let turned: f64 = alike.map(|other| turn(**other, *chord).abs().to_radians()).sum();
        // What an arc with the turn from the step before to the step after has between its ends and its chord.
        let hidden = length * turned.min(1.0) / 8.0;
        let long = length > LONG_TO_STEP * median && (length > LONG_GAP || hidden > HIDDEN);
        let straight = |other: &&Vector2<f64>| {
            turn(**other, *chord).abs() < STRAIGHT && length <= AS_LONG * other.norm()
        };
        let next_row = equal && chord.x.abs() <= ONE_STEP * across_median && length <= LONGEST_ROW;
        let beside_others =
            (long || length > SMALLEST_GAP.max(GAP_TO_STEP * median)) && !beside.iter().any(straight);
        if !next_row && (beside_others || length > LONGEST_STEP || hidden > FARTHEST_ARC) {
            let text = "no points in between: bridged by the spline";
            let lines = (points[i].line, points[i + 1].line);
            gaps.add(lines, (length / MILLIMETRE, "mm"), Action::Left, text);
        }
    }
}

/// Indices of the points at which the profile has a real corner: a change of direction that is concentrated at one
/// point and stands out of the scatter of the measurement.
pub(super) fn find_kinks(points: &[MeasuredPoint], findings: &mut Vec<Finding>) -> Vec<usize> {
    let n = points.len();
    if n < 2 * WINDOW_POINTS + 1 {
        return Vec::new();
    }
    let chord = |i: usize| points[i + 1].point - points[i].point;
    let turns: Vec<f64> = (1..n - 1).map(|i| turn(chord(i - 1), chord(i))).collect();
    let changes = turns.windows(3).map(|t| (t[1] - 0.5 * (t[0] + t[2])).abs()).collect();
    let least = SMALLEST_KINK.max(KINK_TO_SCATTER * median(changes));
    let mut found = Vec::new();
    let mut kinks = Findings::new(findings, FindingKind::Kink);
    for i in WINDOW_POINTS..n - WINDOW_POINTS {
        let here = turns[i - 1];
        if here.abs() < CONCENTRATED * least {
            continue;
        }
        let across = turn(direction(points, i, -1), direction(points, i, 1));
        let neighbours = turns[i - 2].abs().max(turns[i].abs());
        let sharpest = here.abs() > 2.0 * neighbours;
        if across.abs() > least && here * across > 0.0 && here.abs() > CONCENTRATED * across.abs() && sharpest
        {
            found.push(i);
            let line = points[i].line;
            kinks.add((line, line), (across, "degrees"), Action::Noted, "a real corner: kept as one");
        }
    }
    found
}

/// Direction of travel beside the point `i`, over the window before (`side` -1) or after it (1).
fn direction(points: &[MeasuredPoint], i: usize, side: isize) -> Vector2<f64> {
    let here = points[i].point;
    let mut k = i;
    for count in 1.. {
        let Some(next) = k.checked_add_signed(side).filter(|&next| next < points.len()) else { break };
        k = next;
        if count >= WINDOW_POINTS && (points[k].point - here).norm() >= WINDOW {
            break;
        }
    }
    side as f64 * (points[k].point - here)
}

/// Depth below the top that a rail's gauge side has to reach, m: the gauge is measured 14 mm below.
const GAUGE_DEPTH: f64 = 16.0 * MILLIMETRE;
/// Distance from the crown's top that a rail has to reach on the field side, m.
const FIELD_REACH: f64 = 20.0 * MILLIMETRE;
/// Distance from the top at which the head of a rail is looked at, m, ...
const BESIDE_TOP: f64 = 8.0 * MILLIMETRE;
/// ... where it lies lower than the top by no more than this, m, as a circle of 40 mm does; heads have radii of 80 mm and more there.
const ROUNDEST: f64 = 0.8 * MILLIMETRE;
/// Where a wheel has to begin and to end, m from the tape circle.
const WHEEL_RANGE: (f64, f64) = (-0.040, 0.030);

/// Reports a profile that does not cover the range in which wheel and rail touch.
pub(super) fn report_range(kind: ProfileKind, points: &[MeasuredPoint], findings: &mut Vec<Finding>) {
    let (first, last) = (&points[0], &points[points.len() - 1]);
    let mut round = None;
    let mut short = Findings::new(findings, FindingKind::TooShort);
    match kind {
        ProfileKind::Rail => {
            let Some(top) = points.iter().min_by(|a, b| a.point.y.total_cmp(&b.point.y)) else { return };
            let depth = first.point.y - top.point.y;
            if depth < GAUGE_DEPTH {
                let text =
                    "depth reached on the gauge side: 16 mm are needed to find gauge and flange contact";
                short.add((first.line, first.line), (depth / MILLIMETRE, "mm"), Action::Left, text);
            }
            let lower = |side: f64| {
                let beyond = points.iter().filter(|p| side * (p.point.x - top.point.x) >= BESIDE_TOP);
                beyond.map(|p| p.point.y - top.point.y).fold(f64::INFINITY, f64::min)
            };
            let least = lower(-1.0).min(lower(1.0));
            if least.is_finite() && least > ROUNDEST {
                let text = "how far the head lies lower 8 mm beside its top: rounder than any rail, whose heads fall by 0.4 mm at most there";
                round = Some(
                    Finding::new(FindingKind::Shape, Action::Left, text).with_value(least / MILLIMETRE, "mm"),
                );
            }
            let reach = last.point.x - top.point.x;
            if reach < FIELD_REACH {
                let text = "distance reached from the top to the field side: 20 mm are needed";
                short.add((last.line, last.line), (reach / MILLIMETRE, "mm"), Action::Left, text);
            }
        }
        ProfileKind::Wheel => {
            if first.point.x > WHEEL_RANGE.0 {
                let text = "where the wheel begins: its flange face from y = -40 mm on is needed";
                short.add((first.line, first.line), (first.point.x / MILLIMETRE, "mm"), Action::Left, text);
            }
            if last.point.x < WHEEL_RANGE.1 {
                let text = "where the wheel ends: its tread up to y = 30 mm is needed";
                short.add((last.line, last.line), (last.point.x / MILLIMETRE, "mm"), Action::Left, text);
            }
        }
    }
    drop(short);
    findings.extend(round);
}
