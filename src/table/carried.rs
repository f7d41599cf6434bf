//! What a place on the bodies of others is worth: the band of that, and one place in a hundred on its own bodies.

use railspring_calibrate::law::Form;
use railspring_calibrate::pair::OffBodies;
use railspring_profiles::units::MILLIMETRE;
use serde::{Deserialize, Serialize};

use super::document::BodiesKey;
use super::shared::shares;
use crate::hash::key;
use crate::results::by_angle::record::{FixedLoadRecord, ShiftRecord};
use crate::results::springs::form::NormalLawRecord;
use crate::study::Study;

/// The bodies that measured surfaces were pressed on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BodiesRecord {
    /// Whose they are.
    pub of: BodiesKey,
    /// What bodies of others change; none of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub carried: Option<CarriedRecord>,
}

/// Surfaces on the bodies of others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CarriedRecord {
    /// How far the surfaces lie off the contact nodes, at most, mm.
    pub off_mm: f64,
    /// Half width of the band of the displacement by that, relative.
    pub displacement_rel_band: f64,
    /// Of the tangent, but near a load from which a further place carries.
    pub tangent_rel_band: f64,
    /// Of the tangent under the loads of the columns, kN and relative.
    #[serde(default)]
    pub tangent_rel_bands: Vec<(f64, f64)>,
    /// Of the horizontal stiffness.
    pub horizontal_rel_band: f64,
    /// What its own bodies change, in one place of a hundred.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub own: Option<OwnRecord>,
}

/// What the own bodies of a place change, the largest of its loads, relative, with the sign.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct OwnRecord {
    /// Of the displacement.
    pub displacement: f64,
    /// Of the tangent.
    pub tangent: f64,
    /// Of the horizontal stiffness.
    pub horizontal: f64,
}

/// Part of the places that are pressed on their own bodies as well.
const ONE_IN: u32 = 100;

/// Whether the case of a study is one of these, by the hash of what its springs depend on: its measured surfaces are pressed on bodies of standards, as its table
/// wants it, and on its own ones as well.
pub(super) fn is_checked(study: &Study, bodies: BodiesKey) -> bool {
    if !shares(study, bodies) {
        return false;
    }
    let key = key(&study.statics());
    u32::from_str_radix(&key[..8.min(key.len())], 16).is_ok_and(|number| number % ONE_IN == 0)
}

/// The study of such a case on its own bodies: its laws alone are compared.
pub(super) fn checking(study: &Study) -> Study {
    let mut study = study.clone();
    (study.calibration.error_band, study.target_error) = (false, None);
    study
}

/// Tangents grow by this power of the load at most while the same places carry it: by a third in Hertz's contact, less with bodies in series, and a little more on worn profiles.
const SMOOTH_GROWTH: f64 = 0.4;
/// By how much of itself the load changes from which a further place carries, for a displacement that changes by one part: the load goes with its power of 3/2 (Hertz), and both
/// places may move against each other.
const ONSET_BY_DISPLACEMENT: f64 = 3.0;

/// By how much a tangent under a load may change where the load from which a further place carries changes by a part `moved` of itself; 0 where no place begins to carry between
/// it and the loads beside it. The `tangents` under loads in ascending order.
///
/// The new place adds a stiffness that grows with the square root of the load beyond its onset, so that little there changes much.
fn by_onset(tangents: &[[f64; 2]], load: f64, moved: f64) -> f64 {
    let jump = |pair: &[[f64; 2]]| {
        let [[below, less], [above, more]] = [pair[0], pair[1]];
        let beside = [below, above].iter().any(|force| near(*force, load));
        let begins = more / less > (above / below).powf(SMOOTH_GROWTH);
        let reach = (moved * load / (above - below)).min(1.0);
        if beside && begins { (more / less - 1.0) * reach.sqrt() } else { 0.0 }
    };
    tangents.windows(2).map(jump).fold(0.0, f64::max)
}

/// Whether a load is one of the table's, which went through newtons.
pub(super) fn near(force_kn: f64, load_kn: f64) -> bool {
    (force_kn - load_kn).abs() <= 1e-9 * load_kn
}

impl CarriedRecord {
    /// Widens the bands at a place under loads near which a further place begins to carry, by its tangents against a reference.
    pub(super) fn widen_at(&mut self, place: &ShiftRecord, reference: &str) {
        let entry = place.laws.iter().find(|entry| entry.reference == reference);
        let tangents: &[[f64; 2]] =
            match entry.and_then(|entry| entry.form(Form::Table)).map(|form| &form.law) {
                Some(NormalLawRecord::Table(points)) => &points.table_kn_and_kn_per_m,
                _ => &[],
            };
        let moved = ONSET_BY_DISPLACEMENT * self.displacement_rel_band;
        let mut lateral: f64 = 0.0;
        for at in &place.loads {
            let onset = by_onset(tangents, at.force_kn, moved);
            self.tangent_rel_bands.push((at.force_kn, self.tangent_rel_band + onset));
            // the contact is a part of the lateral flexibility
            lateral = lateral.max(at.horizontal_contact_share().unwrap_or(0.0) * onset);
        }
        self.horizontal_rel_band += lateral;
    }

    /// Half width of the band of the tangent under a load of the columns, kN.
    pub fn tangent_band(&self, load_kn: f64) -> f64 {
        let of_load = self.tangent_rel_bands.iter().find(|(force, _)| near(*force, load_kn));
        of_load.map_or(self.tangent_rel_band, |(_, band)| *band)
    }

    /// The largest of them.
    pub fn largest_tangent_band(&self) -> f64 {
        self.tangent_rel_bands.iter().map(|(_, band)| *band).fold(self.tangent_rel_band, f64::max)
    }
}

impl BodiesRecord {
    /// Surfaces on their own bodies.
    pub const OWN: Self = Self { of: BodiesKey::Own, carried: None };

    /// Surfaces on `bodies` of others, that lie so far off their contact nodes; the wheel may stand `between` two others.
    pub fn off(bodies: BodiesKey, OffBodies { rail, wheel }: OffBodies, between: bool) -> Self {
        let [rail_mm, wheel_mm] = [rail, wheel].map(|off| off / MILLIMETRE);
        // docs/design/shared-bodies.md: what bodies of the worn profiles changed, by a millimetre of wear of rail and wheel, by the diameter, and by meshes and grids alone
        let band = |by_grid: f64, [by_rail, by_wheel]: [f64; 2], by_diameter: f64| {
            by_grid + by_rail * rail_mm + by_wheel * wheel_mm + if between { by_diameter } else { 0.0 }
        };
        let carried = CarriedRecord {
            off_mm: rail_mm.max(wheel_mm),
            displacement_rel_band: band(1e-3, [6e-3, 1.5e-3], 1.5e-3),
            tangent_rel_band: band(15e-3, [8e-3, 2e-3], 6e-3),
            tangent_rel_bands: Vec::new(),
            // half of the grid's part is that of the wider grid
            horizontal_rel_band: band(6e-3, [5e-3, 2e-3], 5e-3),
            own: None,
        };
        Self { of: bodies, carried: Some(carried) }
    }
}

impl OwnRecord {
    /// Of a place on the bodies of others and on its `own`, with the reference in use; none where its own carry none of the loads.
    pub fn of(carried: &ShiftRecord, own: &ShiftRecord, reference: &str) -> Option<Self> {
        let (mut found, mut compared) = (Self::default(), false);
        let farther = |largest: &mut f64, change: f64| {
            if change.abs() > largest.abs() {
                *largest = change;
            }
        };
        for at in &carried.loads {
            let same = |other: &&FixedLoadRecord| other.force_kn == at.force_kn;
            let Some(other) = own.loads.iter().find(same) else { continue };
            compared = true;
            if let (Some(at), Some(other)) = (at.reference(reference), other.reference(reference)) {
                farther(&mut found.displacement, other.displacement_mm / at.displacement_mm - 1.0);
                farther(&mut found.tangent, other.tangent_kn_per_m / at.tangent_kn_per_m - 1.0);
            }
            farther(&mut found.horizontal, other.horizontal_kn_per_m / at.horizontal_kn_per_m - 1.0);
        }
        compared.then_some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: tangents of a synthetic worn wheel on the bodies of S1002, and on its own. Its second place carries from less than 20 kN on; there own bodies change the tangent by 5.2 %, under the
    /// other loads by 0.2 % at most. Goal: the band holds this change, is as wide as elsewhere where no place begins, and narrower for bodies that change less. Unit kN/m, relative.
    #[test]
    fn a_place_that_begins_to_carry_widens_the_band() {
        let tangents =
            [[10.0, 434e3], [20.0, 613e3], [40.0, 942e3], [60.0, 1076e3], [80.0, 1151e3], [100.0, 1222e3]];
        let of = |load, moved| by_onset(&tangents, load, moved);
        assert!((0.052..0.08).contains(&of(20.0, 0.012)), "{}", of(20.0, 0.012));
        assert!(of(20.0, 0.003) < 0.6 * of(20.0, 0.012));
        assert_eq!((of(80.0, 0.012), of(100.0, 0.012), of(50.0, 0.012)), (0.0, 0.0, 0.0));
        let hertz = [1.0, 2.0, 4.0, 8.0].map(|load: f64| [load, load.cbrt()]);
        assert_eq!(by_onset(&hertz, 2.0, 0.1), 0.0);
    }
}
