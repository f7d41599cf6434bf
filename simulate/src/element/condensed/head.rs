//! The head of a rail between held ends.
//!
//! The head moves with the section of the beam under it and, beyond that, at once with the force on it. In
//! the middle of a long rail it has all of the section's motion and the flexibility of the condensed head.
//! Near a held end a beam without warping is too flexible. There the head has only a share of the beam's
//! motion, so that the beam is as flexible as a rail whose ends hinder it from warping ([`HeldRail`]). The
//! rest of such a rail's flexibility, and the head's flexibility at that distance, follow the force. So the
//! head on its rail is as flexible as the solid's everywhere, it stores no negative energy, and forces and
//! motions are conjugate.

use nalgebra::Vector3;

use railspring_calibrate::beam::{HeldRail, RailBeam};
use railspring_element::curve::Curve;
use railspring_element::head::{Head, HeadAt, entries, symmetric};
use railspring_element::held_end::{EndPlace, HeldEnd, in_world};
use railspring_element::wheel::positive;

/// Distance of the first places from the end and from each other, m, and what it grows by.
const SPACING: f64 = 2.5e-3;
const GROWTH: f64 = 0.06;

/// The head on a `beam` whose ends are those of a `rail`.
pub(super) fn between_held_ends(beam: &RailBeam, rail: &HeldRail, end: &HeldEnd) -> Head {
    let of_end = of_end(end);
    let (half, angle, torsion) = (0.5 * beam.length(), beam.angle(), beam.section().torsion);
    let mut distances = vec![0.0];
    let mut distance: f64 = SPACING;
    while distance < half - 0.5 * SPACING {
        distances.push(distance);
        distance += SPACING.max(GROWTH * distance);
    }
    distances.push(half);
    let at = |distance: f64| {
        // in the limit at the end
        let (held, bent) = (rail.flexibility(distance), beam.at_place(distance));
        let near = distance.max(distances[1]);
        let (held_near, bent_near) = (rail.flexibility(near), beam.at_place(near));
        let share = [0, 1, 2].map(|i| (held_near[i] / bent_near[i]).clamp(0.0, 1.0).sqrt());
        let beyond = [0, 1, 2].map(|i| (held[i] - share[i] * share[i] * bent[i]).max(0.0));
        let [yy, yz, yr, zz, zr, rr, y, z, turned] = of_end.at(distance);
        let flexibility = positive(in_world(angle, beyond) + symmetric([yy, yz, yr, zz, zr, rr]));
        // a torque at the middle turns a beam in proportion to the distance from its end
        let turned = turned + rail.twist(half, distance) - share[2] * distance / (2.0 * torsion);
        (distance, HeadAt { share: in_world(angle, share), flexibility, twist: Vector3::new(y, z, turned) })
    };
    let places: Vec<(f64, HeadAt)> = distances.iter().map(|&distance| at(distance)).collect();
    Head::by_distance(beam.length(), &places)
}

/// The head against a held rail by its distance from the end, where it does not move.
fn of_end(end: &HeldEnd) -> Curve<9> {
    let values = |EndPlace { distance, flexibility, twist }: &EndPlace| {
        let [yy, yz, yr, zz, zr, rr] = entries(flexibility);
        (*distance, [yy, yz, yr, zz, zr, rr, twist.x, twist.y, twist.z])
    };
    Curve::new(std::iter::once((0.0, [0.0; 9])).chain(end.places.iter().map(values)).collect())
}
