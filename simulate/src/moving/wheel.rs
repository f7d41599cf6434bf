//! The wheel centre A, the suspended mass, and the springs to the contact master B.

use nalgebra::Vector2;

use railspring_calibrate::law::StiffnessLaw;
use railspring_calibrate::newmark::{Motion, Newmark};
use railspring_calibrate::scenario::Scenario;
use railspring_calibrate::suspension::{Suspension, SuspensionStep};

/// The springs k1, k2 and k3 between the wheel centre A and the contact master B.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelSprings {
    /// k1 along direction 1 (lateral), N/m; constant.
    pub horizontal: f64,
    /// k2 along direction 2 (vertical): the law.
    pub normal: StiffnessLaw,
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

/// Mass and what acts on it.
pub(super) struct WheelDynamics<'a> {
    pub scenario: &'a Scenario,
    pub mass: f64,
    /// Moment of inertia about direction 3, kg·m²; `None` holds the rotation.
    pub roll_inertia: Option<f64>,
}

/// The wheel centre over one step, with the suspended mass eliminated: stiffness against displacement and the
/// displacement without contact, for directions 1, 2 and rotation 3.
pub(super) struct WheelStep {
    pub stiffness: [f64; 2],
    pub free: [f64; 2],
    /// `None` while the rotation is held.
    pub roll: Option<(f64, f64)>,
    /// For the state of the suspended mass at the end.
    suspension: (Suspension, SuspensionStep),
}

impl WheelDynamics<'_> {
    /// Forces (N, directions 1 and 2) on the wheel and (direction 2) on the suspended mass at `time`.
    fn loads(&self, time: f64) -> (Vector2<f64>, f64) {
        let s = self.scenario;
        let wheel = Vector2::new(s.lateral_force.at(time), -self.mass * s.gravity);
        (wheel, -s.vertical_force.at(time) - s.suspended_mass * s.gravity)
    }

    /// Accelerations at t = 0 under the contact's force and moment on the wheel.
    pub fn start(&self, state: &mut WheelState, contact: Vector2<f64>, moment: f64) {
        let (wheel, load) = self.loads(0.0);
        let (force, acceleration) =
            Suspension::start(self.scenario, &state.centre[1], &state.suspended, load);
        state.centre[0].a = (wheel.x + contact.x) / self.mass;
        state.centre[1].a = (wheel.y + contact.y + force) / self.mass;
        state.suspended.a = acceleration;
        state.roll.a = self.roll_inertia.map_or(0.0, |inertia| moment / inertia);
    }

    /// Sets up one step that ends at `time`.
    pub fn step(&self, scheme: &Newmark, state: &WheelState, time: f64) -> WheelStep {
        let (wheel, load) = self.loads(time);
        let suspension = Suspension::new(self.scenario, scheme);
        let suspended = suspension.step(&state.centre[1], &state.suspended, load);
        let own = self.mass * scheme.acceleration;
        let stiffness = own + suspension.stiffness();
        let lateral = wheel.x + self.mass * scheme.inertia(&state.centre[0]);
        let vertical =
            wheel.y + self.mass * scheme.inertia(&state.centre[1]) + suspended.damper + suspended.transmitted;
        WheelStep {
            stiffness: [own, stiffness],
            free: [lateral / own, vertical / stiffness],
            roll: self.roll_inertia.map(|inertia| {
                let own = inertia * scheme.acceleration;
                (own, inertia * scheme.inertia(&state.roll) / own)
            }),
            suspension: (suspension, suspended),
        }
    }
}

impl WheelStep {
    /// State at the end of the step from the displacements of the centre and its rotation.
    pub fn finish(&self, scheme: &Newmark, state: &WheelState, centre: [f64; 2], roll: f64) -> WheelState {
        let (suspension, step) = &self.suspension;
        WheelState {
            centre: [0, 1].map(|i| scheme.advance(&state.centre[i], centre[i])),
            roll: if self.roll.is_some() { scheme.advance(&state.roll, roll) } else { state.roll },
            suspended: suspension.finish(step, &state.suspended, centre[1]),
        }
    }
}
