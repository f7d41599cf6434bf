//! What the head of the rail lacks as a section that moves without distortion.
//!
//! Head and rim are sections of one shape to the element; those of the solids are not (`misfit` of [`super::parts::PairElement`]), and the hub on a contact at the gauge corner or on the flange is a few per cent too soft or too stiff.
//! The contact could take that up, but would then have a stiffness that is not a contact's: statics under the loads of the laws are right, and a wheel that slides from the corner onto the flange is not.
//! So the least change of the head's flexibility is sought with which the hubs of all places are as those of the solids; what is left is the contact's
//! ([`super::parts::PlaceApproaches::take_up`]).

use nalgebra::{DMatrix, DVector, Matrix2, Matrix3, Matrix3x2, Vector2, Vector3};
use railspring_calibrate::superelement::carried;

use super::parts::StickingHub;

/// A hub of the solids with that of the element.
pub(super) struct Hub<'a> {
    /// The solids'.
    pub solid: &'a StickingHub,
    /// Flexibility of the element's, m/N.
    pub found: Matrix2<f64>,
    /// Direction (y, z) in which it is pressed.
    pub along: Vector2<f64>,
    /// From the rail's node line to where the wheel touches, m.
    pub arm: Vector2<f64>,
}

/// A change of the head's flexibility by so much, m/N (of rotations, at a lever, m), costs as much as every hub off by a share.
const CHANGE: f64 = 1e-9;
const LEVER: f64 = 0.03;
const COSTS: f64 = 0.01;

/// A contact whose flexibility along its normal or across it is another by its secant costs as much as its hub off by this share.
const CONTACT: f64 = 0.3;

/// Rows and columns of a flexibility that may change.
pub(super) type HeadParts = &'static [(usize, usize)];

/// All of a section's: in the condensed element.
pub(super) const WHOLE: HeadParts = &[(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// Those of a bushing, whose springs along z and the others do not see each other.
pub(super) const OF_BUSHING: HeadParts = &[(0, 0), (0, 2), (1, 1), (2, 2)];

/// A part of the head's symmetric flexibility.
fn part((i, j): (usize, usize)) -> Matrix3<f64> {
    let per = |i: usize| if i == 2 { 1.0 / LEVER } else { 1.0 };
    let mut part = Matrix3::zeros();
    part[(i, j)] = CHANGE * per(i) * per(j);
    part[(j, i)] = part[(i, j)];
    part
}

/// The change of the head's flexibility with which the `hubs` are off the least. The flexibility has motions
/// y, z and rotation about the node line under forces and a torque there. The least squares are of the
/// lateral, coupling and vertical flexibility of the hubs, relative, and of the cost of the change. Each
/// contact has a part of the change. Only `parts` of it change.
pub(super) fn missing_in_head(hubs: &[Hub], parts: HeadParts) -> Matrix3<f64> {
    let count = parts.len();
    let (mut normal, mut right) = (DMatrix::zeros(count, count), DVector::zeros(count));
    for Hub { solid, found, along, arm } in hubs {
        let scale = Matrix2::from_diagonal(&solid.flexibility.diagonal().map(|value| 1.0 / value.sqrt()));
        let relative = |of: &Matrix2<f64>| {
            let of = scale * of * scale;
            Vector3::new(of[(0, 0)], of[(0, 1)], of[(1, 1)])
        };
        let secant = solid.load.approach / solid.load.force;
        let across = Vector2::new(-along.y, along.x);
        let of_contact = [along, &across].map(|way| relative(&(way * way.transpose() * secant)));
        let of_contact = Matrix3x2::from_columns(&of_contact);
        let costs = of_contact.tr_mul(&of_contact) + Matrix2::identity() * (CONTACT * CONTACT);
        // positive definite by what the contact costs
        let taken = costs.try_inverse().unwrap_or_else(Matrix2::zeros);
        let left = Matrix3::identity() - of_contact * taken * of_contact.transpose();
        let to_hub = carried(arm);
        let of_parts: Vec<Vector3<f64>> =
            parts.iter().map(|&at| relative(&(to_hub * part(at) * to_hub.transpose()))).collect();
        let of_parts = DMatrix::from_fn(3, count, |i, number| of_parts[number][i]);
        let weighted = of_parts.tr_mul(&left);
        right += &weighted * relative(&(solid.flexibility - found));
        normal += weighted * of_parts + DMatrix::identity(count, count) * (COSTS * COSTS);
    }
    // no hub, no change
    let found = normal.cholesky().map_or_else(|| DVector::zeros(count), |factor| factor.solve(&right));
    parts.iter().zip(found.iter()).map(|(&at, share)| part(at) * *share).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::condensed::parts::PlaceLoad;

    /// Hubs at places from the crown to the flange on a head that lacks a flexibility, with contacts that lack none.
    fn hubs<'a>(solids: &'a mut Vec<StickingHub>, lacking: &Matrix3<f64>) -> Vec<Hub<'a>> {
        let places =
            [(0.0, -0.09, 0.0), (-0.012, -0.0895, 4.0), (-0.027, -0.086, 30.0), (-0.035, -0.079, 70.0_f64)];
        let ways = places.map(|(y, z, angle)| {
            let (sin, cos) = angle.to_radians().sin_cos();
            (Vector2::new(y, z), Vector2::new(-sin, cos))
        });
        let element = Matrix2::new(14e-9, 0.5e-9, 0.5e-9, 1.6e-9);
        *solids = ways
            .iter()
            .map(|(arm, _)| StickingHub {
                load: PlaceLoad { force: 60e3, approach: 60e-6 },
                flexibility: element + carried(arm) * lacking * carried(arm).transpose(),
                across: 1e-9,
            })
            .collect();
        let both = solids.iter().zip(ways);
        both.map(|(solid, (arm, along))| Hub { solid, found: element, along, arm }).collect()
    }

    /// Source: hubs on a head that lacks a known flexibility. Goal: with what is found (m/N) the hubs are off by a tenth of what they were at most, relative, of a head that is too stiff or too soft; no hub, no change. The same
    /// of a bushing, whose change has no part between z and the others.
    /// Accuracy: LEFT, what the contacts take of it and the cost of a change leave: 0.09 and 0.01 squared against squares of parts of 0.07 to 0.6.
    #[test]
    fn a_head_takes_up_what_it_lacks() {
        const LEFT: f64 = 0.1;
        let lacking = Matrix3::new(0.3e-9, 0.05e-9, 3e-9, 0.05e-9, 0.02e-9, 0.5e-9, 3e-9, 0.5e-9, 50e-9);
        let without_vertical = |mut of: Matrix3<f64>| {
            [(0, 1), (1, 0), (1, 2), (2, 1)].into_iter().for_each(|at| of[at] = 0.0);
            of
        };
        let of_bushing = without_vertical(lacking);
        for (lacking, parts) in
            [(lacking, WHOLE), (-lacking, WHOLE), (of_bushing, OF_BUSHING), (-of_bushing, OF_BUSHING)]
        {
            let mut solids = Vec::new();
            let hubs = hubs(&mut solids, &lacking);
            let more = missing_in_head(&hubs, parts);
            assert!(parts != OF_BUSHING || more == without_vertical(more), "{more}");
            for Hub { solid, found, arm, .. } in &hubs {
                let scale =
                    Matrix2::from_diagonal(&solid.flexibility.diagonal().map(|value| 1.0 / value.sqrt()));
                let off = |head: &Matrix3<f64>| {
                    let with = found + carried(arm) * head * carried(arm).transpose();
                    (scale * (solid.flexibility - with) * scale).amax()
                };
                let (before, after) = (off(&Matrix3::zeros()), off(&more));
                println!("{parts:?} {arm:?}: {before:.5} {after:.5}");
                assert!(after < LEFT * before, "{before} {after}");
            }
        }
        assert_eq!(missing_in_head(&[], WHOLE), Matrix3::zeros());
    }
}
