//! How long wheels take to be pressed on rails, load by load and place by place, on bodies that are ready.
//!
//! The seconds are means over tables of standard and worn profiles. A place where a narrow contact shares the load with a wide one may
//! take ten times as long as the mean of its class.

use railspring_calibrate::pair::FIXED_LOADS_CHANGED;

use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::input::SolidsInput;
use crate::results::bodies::meshes::Meshes;
use crate::results::bodies::places;
use crate::study::{FieldKey, Statics};

use super::condensing::VALUE;

/// Gap up to which points are candidates before the first solution at a load, m.
const FIRST_GAP: f64 = 0.15e-3;
/// Gap up to which they are kept with the load, m.
const KEPT_GAP: f64 = 20e-6;
/// Displacement of the hub under load, m/N, the rail held at its ends.
const FLEXIBILITY: f64 = 1.5e-9;
/// Seconds of a load for every pair of candidates.
const SECONDS_PAIR: f64 = 3e-7;
/// Seconds of a load on a fine grid, with friction, where the wheel stands on its tread.
const SECONDS_FINE: f64 = 0.018;
/// Seconds of a load on a grid of half its spacing and on the grid itself, without friction, on the tread.
const SECONDS_HALVED: f64 = 0.05;
/// Contact angles from which on a load takes so many times as long as on the tread, rad: the throat and the flange. On both the wheel often
/// touches in two places at once.
const BEYOND_TREAD: [(f64, f64); 2] = [(0.2, 2.3), (0.8, 11.0)];
/// Seconds of contact in a time step.
pub(super) const SECONDS_STEP: f64 = 0.008;

/// Contact points under the largest load: candidates before the first solution at a load, and those that are kept.
#[derive(Clone, Copy)]
pub(super) struct Candidates {
    pub first: f64,
    pub kept: f64,
}

impl Candidates {
    pub fn of(input: &SolidsInput<'_>, geometry: &Geometry, meshes: &Meshes) -> Self {
        let largest = input.statics.calibration.loads.last().copied().unwrap_or(0.0);
        let lowered = FLEXIBILITY * largest;
        let at = |gap| geometry.pair.candidates([&meshes.rail, &meshes.wheel], lowered, gap) as f64;
        Self { first: at(FIRST_GAP), kept: at(KEPT_GAP) }
    }

    pub fn times(self, factor: f64) -> Self {
        Self { first: factor * self.first, kept: factor * self.kept }
    }

    /// Bytes of the matrix of so many points.
    pub fn dense(points: f64) -> f64 {
        VALUE * (3.0 * points).powi(2)
    }
}

/// Shares of the candidates by load: patches grow with the cube root of the load in each direction.
pub(super) fn shares(loads: &[f64]) -> Vec<f64> {
    let largest = loads.last().copied().unwrap_or(0.0);
    loads.iter().map(|load| (load / largest).powf(2.0 / 3.0)).collect()
}

/// Time of `loads`, the rail held in one way, s.
pub(super) fn pressing(input: &SolidsInput<'_>, loads: &[f64], candidates: Candidates) -> f64 {
    match input.statics.contact.field {
        FieldKey::Elements => {
            shares(loads).iter().map(|share| SECONDS_PAIR * (share * candidates.first).powi(2)).sum()
        }
        FieldKey::Hybrid => SECONDS_FINE * loads.len() as f64,
    }
}

/// Time of a load on the halved grid and on the grid itself, and of a load on other meshes, s.
pub(super) fn changed(input: &SolidsInput<'_>) -> (f64, f64) {
    match input.statics.contact.field {
        FieldKey::Hybrid => (SECONDS_HALVED, SECONDS_FINE),
        FieldKey::Elements => (0.0, SECONDS_STEP),
    }
}

/// In how many ways the rail is held: with its section, and with its foot where the study wants laws against that.
pub(super) fn ways_held(statics: Statics<'_>) -> f64 {
    if statics.calibration.foot_held { 2.0 } else { 1.0 }
}

/// Time of a wheel that stands on its tread under `loads` in turn, with error bands where they are wanted, on one thread, s.
pub(super) fn of_place(input: &SolidsInput<'_>, loads: &[f64], candidates: Candidates) -> f64 {
    let statics = input.statics;
    let law = ways_held(statics) * pressing(input, loads, candidates);
    if !statics.wants_error_band() {
        return law;
    }
    let (on_grids, _) = changed(input);
    // coarser bodies carry all loads, as the friction of each depends on those before it
    let on_coarser = if statics.meshes_are_ours() { law } else { 0.0 };
    law + FIXED_LOADS_CHANGED as f64 * on_grids + on_coarser
}

/// How many wheels on their treads take as long as the wheel of a study at some `shifts`, m.
pub(crate) fn as_on_tread(statics: Statics<'_>, geometry: &Geometry, shifts: &[f64]) -> f64 {
    let at = |shift: &f64| {
        let pair = geometry.pair.with_wheel_at(places::tape_y(statics, &geometry.pair, *shift));
        let angle = pair.map_or(0.0, |pair| pair.touch.contact_angle.abs());
        let beyond = BEYOND_TREAD.iter().rev().find(|(from, _)| angle > *from);
        beyond.map_or(1.0, |(_, times)| *times)
    };
    shifts.iter().map(at).sum()
}
