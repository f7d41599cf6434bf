//! The wheel centre A, the suspended mass, and the springs to the contact master B.

use faer::{Mat, MatRef};
use nalgebra::{Vector2, Vector3};

use crate::time::energy::PartEnergy;
use crate::time::linear_part::{LinearPart, LinearStep};
use crate::time::newmark::{Motion, Newmark};
use crate::time::scenario::Scenario;
use crate::time::suspension::{Suspension, SuspensionStep};
use railspring_calibrate::law::NormalLaw;

/// The springs k1, k2 and k3 between the wheel centre A and the contact master B.
#[derive(Debug, Clone, PartialEq)]
pub struct WheelSprings {
    /// k1 along direction 1 (lateral), N/m; constant.
    pub horizontal: f64,
    /// k2 along direction 2 (vertical): the law.
    pub normal: NormalLaw,
    /// k3 along direction 3 (longitudinal), N/m. The element has no longitudinal contact
    /// force, so that this spring stays unloaded while the wheel is led along the track.
    pub longitudinal: f64,
}

impl WheelSprings {
    /// Forces (N) of B on A for the displacement of B against A (m, directions 1 and 2), and the stiffness
    /// (N/m) of both directions. `guess` is an estimate of the vertical force.
    ///
    /// The law is defined for compression. In tension, which friction on a steep
    /// flange can cause for a moment, the vertical spring keeps the stiffness it has at zero force.
    pub(super) fn forces(&self, difference: Vector2<f64>, guess: f64) -> (Vector2<f64>, Vector2<f64>) {
        let least = self.least_stiffness();
        let (force, stiffness) = if difference.y > 0.0 {
            let force = self.normal.force_from(difference.y, guess);
            (force, self.normal.tangent(force).max(least))
        } else {
            (least * difference.y, least)
        };
        (Vector2::new(self.horizontal * difference.x, force), Vector2::new(self.horizontal, stiffness))
    }

    /// Energy of the springs with the displacement of B against A (m) and the vertical force (N) that belongs to it, J.
    pub(super) fn energy(&self, difference: Vector2<f64>, force: f64) -> f64 {
        let vertical = match difference.y > 0.0 {
            true => self.normal.energy(force),
            false => 0.5 * force * difference.y,
        };
        0.5 * self.horizontal * difference.x * difference.x + vertical
    }

    /// Stiffness at zero force; a thousandth of that at 1 kN for a law that starts from zero, like Hertz's.
    fn least_stiffness(&self) -> f64 {
        self.normal.tangent(0.0).max(1e-3 * self.normal.tangent(railspring_calibrate::law::REFERENCE_FORCE))
    }
}

/// Motion of the wheel centre (directions 1 and 2, and rotation 3) and of the suspended mass (direction 2).
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct WheelState {
    pub centre: [Motion; 2],
    pub roll: Motion,
    pub suspended: Motion,
}

/// What acts on the wheel besides springs and contact: forces on the centre (directions 1 and 2) and on the suspended
/// mass (direction 2), N.
#[derive(Debug, Clone, Copy)]
pub(super) struct WheelLoad {
    pub centre: Vector2<f64>,
    pub suspended: f64,
}

/// Mass and what acts on it.
pub(super) struct WheelDynamics<'a> {
    pub scenario: &'a Scenario,
    pub mass: f64,
    /// Moment of inertia about direction 3, kg·m²; `None` holds the rotation.
    pub roll_inertia: Option<f64>,
    /// Stiffness of the axle against the rotation, N·m/rad.
    pub axle: f64,
}

/// The wheel with its suspended mass over steps of one length. Its interface is the centre in directions 1, 2 and rotation 3.
pub(super) struct Wheel {
    mass: f64,
    roll_inertia: Option<f64>,
    scheme: Newmark,
    suspension: Suspension,
    flexibility: Mat<f64>,
}

/// A step of the wheel.
pub(super) struct WheelStep<'s> {
    wheel: &'s Wheel,
    state: &'s WheelState,
    next: &'s mut WheelState,
    free: [f64; 3],
    suspension: SuspensionStep,
}

impl WheelDynamics<'_> {
    /// Weight and outer forces at `time`.
    pub fn load(&self, time: f64) -> WheelLoad {
        let s = self.scenario;
        WheelLoad {
            centre: Vector2::new(s.lateral_force.at(time), -self.mass * s.gravity),
            suspended: -s.vertical_force.at(time) - s.suspended_mass * s.gravity,
        }
    }

    /// Accelerations at t = 0 under forces (directions 1, 2 and moment 3) at the interface.
    pub fn start(&self, state: &mut WheelState, contact: Vector3<f64>) {
        let load = self.load(0.0);
        let (force, acceleration) =
            Suspension::start(self.scenario, &state.centre[1], &state.suspended, load.suspended);
        state.centre[0].a = (load.centre.x + contact.x) / self.mass;
        state.centre[1].a = (load.centre.y + contact.y + force) / self.mass;
        state.suspended.a = acceleration;
        state.roll.a =
            self.roll_inertia.map_or(0.0, |inertia| (contact.z - self.axle * state.roll.u) / inertia);
    }

    /// Energies of wheel and suspended mass after a step from `before` to `after` between two `times` (s), with the work of the outer
    /// forces, J.
    pub fn energy(&self, before: &WheelState, after: &WheelState, times: [f64; 2]) -> PartEnergy {
        let [first, last] = times.map(|time| self.load(time));
        let ways = [0, 1].map(|i| after.centre[i].u - before.centre[i].u);
        let work = 0.5 * (first.centre + last.centre).dot(&Vector2::from(ways));
        let kinetic = |mass: f64, m: &Motion| 0.5 * mass * m.v * m.v;
        let [lateral, vertical] = &after.centre;
        let roll = self.roll_inertia.map_or(0.0, |inertia| kinetic(inertia, &after.roll));
        let own = PartEnergy {
            kinetic: kinetic(self.mass, lateral) + kinetic(self.mass, vertical) + roll,
            elastic: self.roll_inertia.map_or(0.0, |_| 0.5 * self.axle * after.roll.u * after.roll.u),
            work,
            ..PartEnergy::default()
        };
        let suspension = Suspension::energy(
            self.scenario,
            [&before.centre[1], &before.suspended],
            [&after.centre[1], &after.suspended],
            0.5 * (first.suspended + last.suspended),
            times[1] - times[0],
        );
        own + suspension
    }

    /// The wheel over steps of `scheme`.
    pub fn over(&self, scheme: &Newmark) -> Wheel {
        let suspension = Suspension::new(self.scenario, scheme);
        let own = self.mass * scheme.acceleration;
        let mut flexibility = Mat::zeros(3, 3);
        flexibility[(0, 0)] = 1.0 / own;
        flexibility[(1, 1)] = 1.0 / (own + suspension.stiffness());
        flexibility[(2, 2)] =
            self.roll_inertia.map_or(0.0, |inertia| 1.0 / (inertia * scheme.acceleration + self.axle));
        Wheel { mass: self.mass, roll_inertia: self.roll_inertia, scheme: *scheme, suspension, flexibility }
    }
}

impl LinearPart for Wheel {
    type State = WheelState;
    type Load = WheelLoad;
    type Step<'s> = WheelStep<'s>;

    fn predict<'s>(
        &'s self,
        state: &'s WheelState,
        load: &WheelLoad,
        next: &'s mut WheelState,
    ) -> WheelStep<'s> {
        let (scheme, [lateral, vertical]) = (&self.scheme, &state.centre);
        let suspension = self.suspension.step(vertical, &state.suspended, load.suspended);
        let forces = [
            load.centre.x + self.mass * scheme.inertia(lateral),
            load.centre.y + self.mass * scheme.inertia(vertical) + suspension.damper + suspension.transmitted,
        ];
        let roll = match self.roll_inertia {
            Some(inertia) => self.flexibility[(2, 2)] * (inertia * scheme.inertia(&state.roll)),
            None => state.roll.u,
        };
        let [y, z] = [0, 1].map(|i| self.flexibility[(i, i)] * forces[i]);
        WheelStep { wheel: self, state, next, free: [y, z, roll], suspension }
    }
}

impl LinearStep for WheelStep<'_> {
    fn free(&self) -> &[f64] {
        &self.free
    }

    fn flexibility(&self) -> MatRef<'_, f64> {
        self.wheel.flexibility.as_ref()
    }

    fn finish(self, forces: &[f64]) {
        let Wheel { scheme, suspension, flexibility, roll_inertia, .. } = self.wheel;
        let [y, z, roll] = [0, 1, 2].map(|i| self.free[i] + flexibility[(i, i)] * forces[i]);
        let state = self.state;
        *self.next = WheelState {
            centre: [scheme.advance(&state.centre[0], y), scheme.advance(&state.centre[1], z)],
            roll: if roll_inertia.is_some() { scheme.advance(&state.roll, roll) } else { state.roll },
            suspended: suspension.finish(&self.suspension, &state.suspended, z),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::linear_part::conformance::Trial;
    use crate::time::scenario::Kelvin;

    /// ROUNDOFF of an acceleration, relative: it is a difference of displacements, which in 40 steps grow to 2·40² times that
    /// of a step, 3200·1e-16.
    const ROUNDOFF: f64 = 1e-12;
    const MASS: f64 = 900.0;
    const INERTIA: f64 = 60.0;
    const AXLE: f64 = 2e6;

    fn scenario(suspended_mass: f64, damping: f64) -> Scenario {
        let vertical_suspension = Kelvin { stiffness: 1.2e6, damping };
        Scenario { suspended_mass, vertical_suspension, ..Scenario::new(1, 5e-4, 0.3) }
    }

    fn load(lateral: f64, vertical: f64, suspended: f64) -> WheelLoad {
        WheelLoad { centre: Vector2::new(lateral, vertical), suspended }
    }

    fn trial(part: &Wheel) -> Trial<'_, Wheel> {
        Trial {
            part,
            rest: WheelState::default(),
            loads: [load(20e3, -9e3, -61e3), load(-5e3, 2e3, -10e3), load(15e3, -7e3, -71e3)],
            force: 85e3,
            displacement: &|state| vec![state.centre[0].u, state.centre[1].u, state.roll.u],
            numbers: &|state| {
                [state.centre[0], state.centre[1], state.roll, state.suspended]
                    .iter()
                    .flat_map(|m| [vec![m.u], vec![m.v], vec![m.a]])
                    .collect()
            },
        }
    }

    /// Goal: the wheel obeys the rules of a linear part, with and without suspended mass, damper, dissipation and held rotation. Without
    /// damper and dissipation its energy (J) is the work of the forces. Accuracy: ROUNDOFF.
    #[test]
    fn the_wheel_is_a_linear_part() {
        for (suspended, damping) in [(6250.0, 0.0), (6250.0, 40e3), (0.0, 40e3)] {
            let scenario = scenario(suspended, damping);
            for (roll_inertia, dissipation) in [(Some(INERTIA), 0.0), (Some(INERTIA), 0.05), (None, 0.0)] {
                let dynamics = WheelDynamics { scenario: &scenario, mass: MASS, roll_inertia, axle: AXLE };
                let part = dynamics.over(&Newmark::new(scenario.time_step, dissipation));
                let found = trial(&part).deviations();
                assert!(found.largest() < ROUNDOFF, "{suspended} {damping} {roll_inertia:?}: {found:?}");
                assert_eq!(part.flexibility[(2, 2)] == 0.0, roll_inertia.is_none());
                if dissipation == 0.0 && (damping == 0.0 || suspended == 0.0) {
                    let energy = |state: &WheelState| {
                        let kinetic = |mass: f64, m: &Motion| 0.5 * mass * m.v * m.v;
                        let spring = suspended.min(1.0) * scenario.vertical_suspension.stiffness;
                        kinetic(MASS, &state.centre[0])
                            + kinetic(MASS, &state.centre[1])
                            + kinetic(INERTIA, &state.roll)
                            + roll_inertia.map_or(0.0, |_| 0.5 * AXLE * state.roll.u.powi(2))
                            + kinetic(suspended, &state.suspended)
                            + 0.5 * spring * (state.suspended.u - state.centre[1].u).powi(2)
                    };
                    let defect = trial(&part).energy_defect(&load(0.0, 0.0, 0.0), &energy);
                    assert!(defect < ROUNDOFF, "{suspended} {roll_inertia:?}: {defect:e}");
                }
            }
        }
    }
}
