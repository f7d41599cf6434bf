//! The contact patch on the rail under some loads of the calibration, for the report's figures.

use std::collections::BTreeMap;

use railspring_calibrate::calibration::{Patch, Pressed};
use railspring_calibrate::contact::{ContactPoint, Hat, PointMode, Subsurface, stress_below};
use railspring_calibrate::pair::Pair;
use railspring_calibrate::solid::{largest_shear, von_mises};
use railspring_profiles::units::{KILONEWTON, MEGAPASCAL, MILLIMETRE};

use crate::results::patches::record::{BelowRecord, PatchRecord, PointState};

/// Which of ascending states are drawn: the smallest, the middle and the largest load.
pub(crate) fn chosen(count: usize) -> Vec<usize> {
    let mut chosen = vec![0, count / 2, count.saturating_sub(1)];
    chosen.dedup();
    chosen.retain(|&index| index < count);
    chosen
}

/// The patch of a state as the grid of its load, one line beyond the points that carry, with what was measured of it; `poisson` is the ratio of the body below.
pub(crate) fn patch_record(pair: &Pair, state: &Pressed, measured: &Patch, poisson: f64) -> PatchRecord {
    let (points, solution) = (&state.points, &state.solution);
    let carries = |j: &usize| solution.modes[*j] != PointMode::Open;
    // lines of the grid with their coordinates: those of the load and their neighbours, as far away as the width of a point where
    // the surfaces are not paired there; numbers grow by one, so that a line may come before the first
    let lines = |index: fn((usize, usize)) -> usize, axis: usize| -> BTreeMap<usize, f64> {
        let at = |point: &ContactPoint| (index(point.index) + 1, point.position[axis]);
        let mut lines: BTreeMap<usize, f64> = BTreeMap::new();
        for point in (0..points.len()).filter(carries).map(|j| &points[j]) {
            let (line, place) = at(point);
            let width = point.widths[axis];
            for (line, place) in [(line - 1, place - width), (line, place), (line + 1, place + width)] {
                lines.entry(line).or_insert(place);
            }
        }
        for (line, place) in points.iter().map(at) {
            lines.entry(line).and_modify(|known| *known = place);
        }
        lines
    };
    let (across, along) = (lines(|index| index.0, 0), lines(|index| index.1, 1));
    let rows: BTreeMap<usize, usize> = across.keys().enumerate().map(|(row, line)| (*line, row)).collect();
    let columns: BTreeMap<usize, usize> = along.keys().enumerate().map(|(k, line)| (*line, k)).collect();
    let mut pressure_mpa = vec![vec![0.0; columns.len()]; rows.len()];
    let mut state_of = vec![vec![PointState::Open; columns.len()]; rows.len()];
    for (j, point) in points.iter().enumerate() {
        let (Some(&row), Some(&column)) = (rows.get(&(point.index.0 + 1)), columns.get(&(point.index.1 + 1)))
        else {
            continue;
        };
        pressure_mpa[row][column] = solution.forces[j] / point.area / MEGAPASCAL;
        state_of[row][column] = match solution.modes[j] {
            PointMode::Open => PointState::Open,
            PointMode::Stick => PointState::Stick,
            PointMode::Slip => PointState::Slip,
        };
    }
    let rail = &pair.rail.running;
    PatchRecord {
        force_kn: state.load / KILONEWTON,
        // the arc length of a rail grows to the field side
        across_mm: across.values().map(|s| (s - pair.touch.rail_s) / MILLIMETRE).collect(),
        rail_y_mm: across.values().map(|s| rail.point(*s).x / MILLIMETRE).collect(),
        rail_z_mm: across.values().map(|s| rail.point(*s).y / MILLIMETRE).collect(),
        along_mm: along.values().map(|x| x / MILLIMETRE).collect(),
        pressure_mpa,
        state: state_of,
        max_pressure_mpa: measured.values.max_pressure / MEGAPASCAL,
        below: measured.values.below.map(|largest| below_record(pair, &measured.hats, poisson, &largest)),
    }
}

/// Depths of the stresses below a patch: so many, down to this many times the depth of the largest von Mises stress.
const DEPTHS: u32 = 60;
const DEEPEST: f64 = 5.0;

/// The stresses of a patch below the place where `largest` has its von Mises stress.
fn below_record(pair: &Pair, hats: &[Hat], poisson: f64, largest: &Subsurface) -> BelowRecord {
    let place = largest.mises.place;
    let deepest = DEEPEST * largest.mises.depth;
    let shallowest = deepest / f64::from(DEPTHS);
    let depths: Vec<f64> = (0..DEPTHS)
        .map(|n| shallowest + (deepest - shallowest) * f64::from(n) / f64::from(DEPTHS - 1))
        .collect();
    let stresses: Vec<_> = depths.iter().map(|depth| stress_below(hats, poisson, &place, *depth)).collect();
    BelowRecord {
        across_mm: (place.x - pair.touch.rail_s) / MILLIMETRE,
        along_mm: place.y / MILLIMETRE,
        depth_mm: depths.iter().map(|depth| depth / MILLIMETRE).collect(),
        von_mises_mpa: stresses.iter().map(|s| von_mises(*s) / MEGAPASCAL).collect(),
        shear_mpa: stresses.iter().map(|s| largest_shear(*s) / MEGAPASCAL).collect(),
    }
}
