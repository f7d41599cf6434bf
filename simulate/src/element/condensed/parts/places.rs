//! What the solids say of the contact, place by place.

use nalgebra::{Matrix2, Vector2, Vector3};
use railspring_calibrate::calibration::LoadPoint;
use railspring_calibrate::law::LEAST_LOADS;
use railspring_calibrate::pair::ShiftLaw;

/// What the solids say of the contact with the wheel in one place, pressed along the contact normal with the hub held across it.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaceApproaches {
    /// Lateral world position of the tape circle, m.
    pub tape_y: f64,
    /// World direction (y, z) along which the wheel is pressed.
    pub along: Vector2<f64>,
    /// The loads, ascending.
    pub loads: Vec<PlaceLoad>,
    /// Some loads, ascending, with the hub under them.
    pub sticking: Vec<StickingHub>,
}

/// A load along the contact normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceLoad {
    /// Force, N.
    pub force: f64,
    /// Approach of the surfaces, m.
    pub approach: f64,
}

/// The hub under a load with everything sticking.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StickingHub {
    /// The load.
    pub load: PlaceLoad,
    /// Displacements y and z of the solid's hub under small further forces, m/N.
    pub flexibility: Matrix2<f64>,
    /// Flexibility across the contact normal that the element is to have with the sections of its bodies, m/N.
    pub across: f64,
}

impl PlaceApproaches {
    /// Of a law by contact angle at the loads that one contact carries; none where there is no law, or those are fewer than a law has.
    pub fn of(law: &ShiftLaw) -> Option<Self> {
        let (angle, along) = (law.law.as_ref().ok()?, *law.touch.as_ref()?.along);
        let load = |point: &LoadPoint| PlaceLoad { force: point.force, approach: point.displacement };
        let of_one = |point: &&LoadPoint| angle.is_of_one_contact(point.force);
        let loads: Vec<PlaceLoad> = angle.laws.local.points.iter().filter(of_one).map(load).collect();
        if loads.len() < LEAST_LOADS {
            return None;
        }
        let fixed = angle.fixed.iter().filter(|at| of_one(&&at.points.local));
        let sticking = fixed.map(|at| StickingHub {
            load: load(&at.points.local),
            flexibility: at.flexibility,
            across: 1.0 / at.tangential_stiffness,
        });
        Some(Self { tape_y: law.tape_y, along, loads, sticking: sticking.collect() })
    }

    /// Takes up what an element is off whose hub has the flexibilities `found` under the loads of `sticking` (m/N; none where it does not carry one).
    ///
    /// Rim and head as sections do not have all of what the bodies give way, and their contacts are a little elsewhere under a load. What is missing along the normal, summed over the load,
    /// goes to the approaches; across the normal goes what then makes the hub's lateral, vertical and coupling flexibility differ the least, relative.
    pub fn take_up(&mut self, found: &[Option<Matrix2<f64>>]) {
        let across = Vector2::new(-self.along.y, self.along.x);
        let mut missing = Vec::new();
        for (hub, found) in self.sticking.iter_mut().zip(found) {
            let Some(found) = found else { continue };
            let off = hub.flexibility - found;
            let normal = self.along.dot(&(off * self.along));
            missing.push([hub.load.force, normal]);
            let scale = hub.flexibility.diagonal().map(|value| 1.0 / value.sqrt());
            let relative = |of: &Matrix2<f64>| {
                let of = Matrix2::from_diagonal(&scale) * of * Matrix2::from_diagonal(&scale);
                Vector3::new(of[(0, 0)], of[(0, 1)], of[(1, 1)])
            };
            let rest = relative(&(off - self.along * self.along.transpose() * normal));
            let direction = relative(&(across * across.transpose()));
            hub.across += direction.dot(&rest) / direction.norm_squared();
        }
        let loads = self.loads.iter_mut().chain(self.sticking.iter_mut().map(|hub| &mut hub.load));
        loads.for_each(|load| load.approach += summed(&missing, load.force));
    }
}

/// Integral up to a `force` of values at some forces, in proportion between them and constant beyond.
fn summed(values: &[[f64; 2]], force: f64) -> f64 {
    let (mut sum, mut from, mut last) = (0.0, 0.0, values.first().map_or(0.0, |first| first[1]));
    for &[at, value] in values {
        let to = at.min(force);
        if to <= from {
            break;
        }
        let end = last + (to - from) / (at - from) * (value - last);
        sum += 0.5 * (last + end) * (to - from);
        (from, last) = (to, end);
    }
    sum + last * (force - from).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ROUNDOFF: some products of numbers of a few digits.
    const ROUNDOFF: f64 = 1e-12;

    /// Source: integration by hand. Goal: a hub that is too stiff along the contact normal adds the
    /// difference to the approaches (m), in proportion to the load between 20 and 40 kN and constant beyond.
    /// Across the normal the difference is added to the flexibility across (m/N). A load that the element
    /// does not carry adds nothing. Accuracy: ROUNDOFF.
    #[test]
    fn what_is_missing_is_taken_up_along_and_across_the_normal() {
        let (along, across) = (Vector2::new(0.6, -0.8), Vector2::new(0.8, 0.6));
        let solid = Matrix2::new(13.0, 0.5, 0.5, 2.0) * 1e-9;
        let load = |force: f64| PlaceLoad { force, approach: 30e-6 };
        let hub = |force| StickingHub { load: load(force), flexibility: solid, across: 3e-9 };
        let mut place = PlaceApproaches {
            tape_y: 0.75,
            along,
            loads: [10e3, 30e3, 60e3].map(load).to_vec(),
            sticking: [20e3, 40e3, 50e3].map(hub).to_vec(),
        };
        let lacks = |normal: f64, tangential: f64| {
            Some(solid - along * along.transpose() * normal - across * across.transpose() * tangential)
        };
        place.take_up(&[lacks(0.1e-9, 0.2e-9), lacks(0.3e-9, -0.1e-9), None]);
        let wanted =
            [0.1e-9 * 10e3, 0.1e-9 * 20e3 + 0.15e-9 * 10e3, 0.1e-9 * 20e3 + 0.2e-9 * 20e3 + 0.3e-9 * 20e3];
        for (load, more) in place.loads.iter().zip(wanted) {
            assert!((load.approach - 30e-6 - more).abs() < ROUNDOFF * 30e-6, "{load:?} {more}");
        }
        for (hub, more) in place.sticking.iter().zip([0.2e-9, -0.1e-9, 0.0]) {
            assert!((hub.across - 3e-9 - more).abs() < ROUNDOFF * 3e-9, "{hub:?} {more}");
        }
        assert!(
            (place.sticking[2].load.approach - 30e-6 - (wanted[2] - 0.3e-9 * 10e3)).abs() < ROUNDOFF * 30e-6
        );
    }
}
