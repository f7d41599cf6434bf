//! What a contact element is: profiles, strips, wheel and head of a pair, with its errors.

use crate::head::{Head, HeadAt};
use crate::law::StripStiffness;
use crate::wheel::ElasticWheel;
use nalgebra::{DMatrix, Matrix3, Point2, Vector2, Vector3};
use railspring_profiles::placement::PlacedRail;
use railspring_profiles::profile::ProfileCurve;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The place of a wheel on a rail that is not the study's: its head is as far from any held end.
pub const OTHER_RAIL: f64 = -1.0;

/// The contact element of a wheel on a rail. It never changes; instances share it ([`crate::contact::StaticContact`], [`crate::unit::Unit`]).
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// What it is of, and its errors.
    pub about: About,
    /// The rail in the track.
    pub rail: PlacedRail,
    /// Running surface of the wheel, profile frame.
    pub wheel_profile: ProfileCurve,
    /// World position (y, z) of the origin of the wheel's profile where all motions are zero, m: there the wheel just touches.
    pub tape: Point2<f64>,
    /// World position (y, z) of the rail's line of shear centres, m: motions of the rail's section are those of this point, its forces act there.
    pub node_line: Point2<f64>,
    /// The wheel about the origin of its profile.
    pub wheel: ElasticWheel,
    /// Damping of the wheel's modes over their stiffness, s.
    pub damping: f64,
    /// The head along the study's rail.
    pub head: Head,
    /// Flexibility of the head against its section, about the line of shear centres, for rails that are not the study's.
    pub head_on_section: Matrix3<f64>,
    /// The contact.
    pub strips: StripStiffness,
    /// Coefficient of friction of the study.
    pub friction: f64,
    /// The study's rail as a wheel in one place feels it, for hosts that have no beams; none of a rail that does not move.
    pub rail_at_wheel: Option<RailModes>,
}

/// What an element is of, and its errors.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct About {
    /// The study.
    pub study: String,
    /// The pair of profiles.
    pub pair: String,
    /// `condensed` or `lumped`.
    pub element: String,
    /// The program with version and commit.
    pub program: String,
    /// Hashes of what it was made from, by name.
    pub inputs: BTreeMap<String, String>,
    /// Largest normal force of the loads that it was fitted to, N; beyond it the law goes on as it is.
    pub largest_force_n: f64,
    /// Largest deviation of a contact force from that of the solids at the same approach, relative.
    pub strips_max_rel_error: f64,
    /// Largest deviation of the hub's displacement from that of the solids, relative to that under the largest load; none where it is not known.
    pub hub_max_rel_error: Option<f64>,
}

/// A rail by its natural modes, as a wheel in one place feels it.
#[derive(Debug, Clone, PartialEq)]
pub struct RailModes {
    /// The place, m from the rail's first end.
    pub place: f64,
    /// Damping over stiffness, s.
    pub damping: f64,
    /// Modes of mass 1 kg, by ascending frequency.
    pub modes: Vec<RailMode>,
    /// Motion of the section beyond the modes, which follows forces at once: y, z (m), rotation about x (rad) under forces (N) and a torque (N·m).
    pub rest: Matrix3<f64>,
}

/// A mode of a rail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RailMode {
    /// Square of the angular frequency, 1/s².
    pub square: f64,
    /// Motion of the section at the wheel: y, z (1) and rotation about x (1/m).
    pub section: Vector3<f64>,
}

/// The wheel as a superelement whose modes the host integrates: coordinates are the hub's displacements y, z and rotation about x (its centre), then the modes' amplitudes with the hub held.
/// `mass·ẍ + damping·ẋ + stiffness·x = loads + rimᵀ·force`, with the force of the contact on the rim.
#[derive(Debug, Clone, PartialEq)]
pub struct WheelSuperelement {
    /// kg, kg·m, kg·m²; positive definite.
    pub mass: DMatrix<f64>,
    /// N·s/m and so on.
    pub damping: DMatrix<f64>,
    /// N/m and so on; of the hub's motions none.
    pub stiffness: DMatrix<f64>,
    /// Motion of the rim under the coordinates, three rows.
    pub rim: DMatrix<f64>,
}

impl Element {
    /// World positions of the reference points of wheel and rail at rest, m.
    pub fn references(&self) -> [Vector2<f64>; 2] {
        [self.tape.coords, self.node_line.coords]
    }

    /// The head of the study's rail at a place, m from its first end, or that of another rail.
    pub fn head_at(&self, place: f64) -> HeadAt {
        if place == OTHER_RAIL { HeadAt::on_section(self.head_on_section) } else { self.head.at(place) }
    }

    /// The wheel as a superelement.
    pub fn superelement(&self) -> WheelSuperelement {
        let (wheel, of_hub) = (&self.wheel, self.wheel.carried_by_hub());
        let modes = &wheel.modes;
        let size = 3 + modes.len();
        let mass = DMatrix::from_fn(size, size, |i, j| match (i < 3, j < 3) {
            (true, true) => wheel.mass[(i, j)],
            (true, false) => modes[j - 3].coupling[i],
            (false, true) => modes[i - 3].coupling[j],
            (false, false) => f64::from(u8::from(i == j)),
        });
        let square = |i: usize, j: usize| if i == j && i >= 3 { modes[i - 3].square } else { 0.0 };
        let stiffness = DMatrix::from_fn(size, size, square);
        let rim = DMatrix::from_fn(3, size, |i, j| if j < 3 { of_hub[(i, j)] } else { modes[j - 3].rim[i] });
        WheelSuperelement { mass, damping: &stiffness * self.damping, stiffness, rim }
    }
}
