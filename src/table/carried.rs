//! What a place on the bodies of others is worth: the band of that, and one place in a hundred on its own bodies.

use railspring_profiles::units::MILLIMETRE;
use serde::{Deserialize, Serialize};

use super::document::BodiesKey;
use crate::results::by_angle::record::{FixedLoadRecord, ShiftRecord};

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
    /// Of the tangent.
    pub tangent_rel_band: f64,
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

/// Whether a case with a key (a hash) is one of these.
pub(super) fn is_checked(key: &str) -> bool {
    u32::from_str_radix(&key[..8.min(key.len())], 16).is_ok_and(|number| number % ONE_IN == 0)
}

impl BodiesRecord {
    /// Surfaces on their own bodies.
    pub const OWN: Self = Self { of: BodiesKey::Own, carried: None };

    /// Surfaces that lie off the contact nodes of the bodies of their standards by at most so much, m; the wheel may stand `between` two others.
    pub fn off(off: f64, between: bool) -> Self {
        let off_mm = off / MILLIMETRE;
        // docs/design/shared-bodies.md: what bodies of the worn profiles changed, by a millimetre of wear, by the diameter, and by the meshes alone
        let band =
            |by_mm: f64, by_diameter: f64| 1e-3 + by_mm * off_mm + if between { by_diameter } else { 0.0 };
        let carried = CarriedRecord {
            off_mm,
            displacement_rel_band: band(6e-3, 1.5e-3),
            tangent_rel_band: band(8e-3, 6e-3),
            horizontal_rel_band: band(5e-3, 5e-3),
            own: None,
        };
        Self { of: BodiesKey::Nominal, carried: Some(carried) }
    }
}

impl OwnRecord {
    /// Of a place on the bodies of others and on its `own`, with the reference in use.
    pub fn of(carried: &ShiftRecord, own: &ShiftRecord, reference: &str) -> Self {
        let mut found = Self::default();
        let farther = |largest: &mut f64, change: f64| {
            if change.abs() > largest.abs() {
                *largest = change;
            }
        };
        for at in &carried.loads {
            let same = |other: &&FixedLoadRecord| other.force_kn == at.force_kn;
            let Some(other) = own.loads.iter().find(same) else { continue };
            if let (Some(at), Some(other)) = (at.reference(reference), other.reference(reference)) {
                farther(&mut found.displacement, other.displacement_mm / at.displacement_mm - 1.0);
                farther(&mut found.tangent, other.tangent_kn_per_m / at.tangent_kn_per_m - 1.0);
            }
            farther(&mut found.horizontal, other.horizontal_kn_per_m / at.horizontal_kn_per_m - 1.0);
        }
        found
    }
}
