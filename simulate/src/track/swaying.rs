//! A wheelset with a mass above that sways, bounces and rolls.
//!
//! Coordinates are displacements to the right and down, and the roll, positive where the right side goes down. Those of the axle are y, z and φ, those of the mass above Y, Z and Φ.
//! On each side a spring with a damper joins the axle at its height to the mass, vertically and laterally. The mass has its centre above.
//!
//! **Weight aside.** The springs turn with the axle. So the weight W of the mass above acts where the mass has gone: the axle gets the moment W·(Y − y − h·Φ), and the mass slides
//! to the lower side with W·φ. These are linear with the weight at rest, as is the moment W·h·(Φ − φ) with which the mass falls over. They take nothing from the balance of forces.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use crate::time::newmark::{Motion, Newmark};
use crate::time::scenario::Kelvin;

use super::dynamics::gains;

type Matrix6 = SMatrix<f64, 6, 6>;
type Vector6 = SVector<f64, 6>;

/// A wheelset with a mass above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SwayingWheelset {
    /// Mass of the wheelset, kg.
    pub mass: f64,
    /// Its moment of inertia about the track's axis, kg·m².
    pub inertia: f64,
    /// Mass above, kg; 0 for none.
    pub above: f64,
    /// Its moment of inertia about the axis of the track through its centre, kg·m².
    pub above_inertia: f64,
    /// How far its centre is above the axle, m.
    pub height: f64,
    /// Spring and damper on each side, vertically.
    pub vertical: Kelvin,
    /// The same laterally.
    pub lateral: Kelvin,
    /// Half the distance of the suspensions, m.
    pub half_base: f64,
}

/// What acts on a wheelset besides its contacts, on the mass above or, without one, on the axle.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct SwayLoads {
    /// To the right, N.
    pub lateral: f64,
    /// Down, N.
    pub vertical: f64,
    /// Positive presses on the right wheel, N·m.
    pub roll: f64,
    /// Acceleration of the ground to the right and down, m/s².
    pub ground: [f64; 2],
    /// Acceleration of gravity, m/s².
    pub gravity: f64,
}

/// Equations of a wheelset.
pub(super) struct Sway {
    set: SwayingWheelset,
    mass: Vector6,
    stiffness: Matrix6,
    damping: Matrix6,
}

/// Motion of a wheelset.
pub(super) type SwayState = [Motion; 6];

/// Force on the axle of the suspension of one side: to the right and down along the axle's own axes, N.
pub type SuspensionForce = [f64; 2];

impl SwayingWheelset {
    /// Its weight with the mass above, N.
    pub fn weight(&self, gravity: f64) -> f64 {
        (self.mass + self.above) * gravity
    }

    /// Lateral stroke of the suspension, and the vertical ones, right and left, from the coordinates.
    fn strokes(&self) -> [Vector6; 3] {
        let (d, h) = (self.half_base, self.height);
        [[-1.0, 0.0, 0.0, 1.0, 0.0, -h], [0.0, -1.0, -d, 0.0, 1.0, d], [0.0, -1.0, d, 0.0, 1.0, -d]]
            .map(Vector6::from)
    }
}

impl Sway {
    /// With the weight of the mass above under a `gravity`, m/s².
    pub fn new(set: &SwayingWheelset, gravity: f64) -> Self {
        let [across, right, left] = set.strokes();
        let of = |row: &Vector6, factor: f64| row * row.transpose() * factor;
        let sum = |vertical: f64, lateral: f64| {
            of(&across, 2.0 * lateral) + (of(&right, vertical) + of(&left, vertical))
        };
        let has = set.above > 0.0;
        let (mut stiffness, damping) = match has {
            true => (
                sum(set.vertical.stiffness, set.lateral.stiffness),
                sum(set.vertical.damping, set.lateral.damping),
            ),
            false => (Matrix6::zeros(), Matrix6::zeros()),
        };
        let (weight, h) = (set.above * gravity, set.height);
        for (i, j, value) in [(2, 3, -weight), (2, 0, weight), (2, 5, weight * h)] {
            stiffness[(i, j)] += value;
            stiffness[(j, i)] += value;
        }
        stiffness[(5, 5)] -= weight * h;
        // without a mass above its coordinates stay at rest
        let above = if has { [set.above, set.above, set.above_inertia] } else { [1.0; 3] };
        let mass = Vector6::from([set.mass, set.mass, set.inertia, above[0], above[1], above[2]]);
        Self { set: *set, mass, stiffness, damping }
    }

    fn forces(&self, loads: &SwayLoads) -> Vector6 {
        let SwayingWheelset { mass, above, .. } = self.set;
        let [right, down] = loads.ground;
        let fall = loads.gravity - down;
        let mut forces = Vector6::from([-mass * right, mass * fall, 0.0, 0.0, 0.0, 0.0]);
        let at = if above > 0.0 { 3 } else { 0 };
        if above > 0.0 {
            forces[3] -= above * right;
            forces[4] += above * fall;
        }
        for (i, value) in [loads.lateral, loads.vertical, loads.roll].into_iter().enumerate() {
            forces[at + i] += value;
        }
        forces
    }

    fn pushed(contacts: &Vector3<f64>) -> Vector6 {
        // direction 2 is up, and direction 3 raises the right side
        Vector6::from([contacts.x, -contacts.y, -contacts.z, 0.0, 0.0, 0.0])
    }

    /// Gives a state its accelerations under loads and forces of the contacts (directions 1, 2 and moment 3).
    pub fn accelerate(&self, state: &mut SwayState, loads: &SwayLoads, contacts: &Vector3<f64>) {
        let (u, v) = (Self::column(state, |m| m.u), Self::column(state, |m| m.v));
        let forces = self.forces(loads) - self.stiffness * u - self.damping * v + Self::pushed(contacts);
        for (i, motion) in state.iter_mut().enumerate() {
            motion.a = forces[i] / self.mass[i];
        }
    }

    fn column(state: &SwayState, of: impl Fn(&Motion) -> f64) -> Vector6 {
        Vector6::from_fn(|i, _| of(&state[i]))
    }

    /// Stiffness of the axle at rest with the mass above on it, and the force on it without contacts, in directions 1, 2 and 3 of the right side; none where nothing carries the mass.
    pub fn at_rest(&self, loads: &SwayLoads) -> Option<(Matrix3<f64>, Vector3<f64>)> {
        let forces = self.forces(loads);
        let own = self.stiffness.fixed_view::<3, 3>(0, 0).into_owned();
        let on_axle = forces.fixed_rows::<3>(0).into_owned();
        let up = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0));
        if self.set.above == 0.0 {
            return Some((up * own * up, up * on_axle));
        }
        let across = self.stiffness.fixed_view::<3, 3>(0, 3);
        let above = self.stiffness.fixed_view::<3, 3>(3, 3).into_owned().try_inverse()?;
        let taken = across * above;
        let stiffness = own - taken * across.transpose();
        let force = on_axle - taken * forces.fixed_rows::<3>(3);
        Some((up * stiffness * up, up * force))
    }

    /// The state at rest with the axle at a displacement (directions 1, 2 and 3); none where nothing carries the mass.
    pub fn with_axle(&self, loads: &SwayLoads, axle: &Vector3<f64>) -> Option<SwayState> {
        let own = Vector3::new(axle.x, -axle.y, -axle.z);
        let mut all = [own.x, own.y, own.z, 0.0, 0.0, 0.0];
        if self.set.above > 0.0 {
            let above = self.stiffness.fixed_view::<3, 3>(3, 3).into_owned().try_inverse()?;
            let forces = self.forces(loads);
            let carried = forces.fixed_rows::<3>(3) - self.stiffness.fixed_view::<3, 3>(3, 0) * own;
            all[3..].copy_from_slice((above * carried).as_slice());
        }
        Some(all.map(|u| Motion { u, ..Motion::default() }))
    }

    /// Forces of the suspensions on the axle, right and left.
    pub fn suspension(&self, state: &SwayState) -> [SuspensionForce; 2] {
        if self.set.above == 0.0 {
            return [[0.0; 2]; 2];
        }
        let (u, v) = (Self::column(state, |m| m.u), Self::column(state, |m| m.v));
        let of = |stroke: &Vector6, kelvin: &Kelvin| {
            kelvin.stiffness * stroke.dot(&u) + kelvin.damping * stroke.dot(&v)
        };
        let [across, right, left] = self.set.strokes();
        let lateral = of(&across, &self.set.lateral);
        [right, left].map(|stroke| [lateral, of(&stroke, &self.set.vertical)])
    }

    /// The wheelset over steps of a scheme.
    pub fn over(&self, scheme: Newmark) -> SwaySteps {
        let gains = gains(&scheme);
        let matrix = Matrix6::from_diagonal(&self.mass) + self.stiffness * gains[0] + self.damping * gains[1];
        // the masses outweigh what gravity takes in a short step
        let inverse = matrix.try_inverse().unwrap_or_else(|| Matrix6::repeat(f64::NAN));
        SwaySteps { scheme, gains, inverse }
    }
}

/// A wheelset over steps of one length.
pub(super) struct SwaySteps {
    scheme: Newmark,
    gains: [f64; 2],
    inverse: Matrix6,
}

impl SwaySteps {
    /// The state at the end of a step without forces of the contacts.
    pub fn free(&self, sway: &Sway, state: &SwayState, loads: &SwayLoads) -> SwayState {
        let predicted = state.map(|motion| self.scheme.predicted(&motion));
        let (u, v) = (Vector6::from_fn(|i, _| predicted[i][0]), Vector6::from_fn(|i, _| predicted[i][1]));
        let forces = sway.forces(loads) - sway.stiffness * u - sway.damping * v;
        let accelerations = self.inverse * forces;
        std::array::from_fn(|i| Motion {
            u: u[i] + self.gains[0] * accelerations[i],
            v: v[i] + self.gains[1] * accelerations[i],
            a: accelerations[i],
        })
    }

    /// The axle of a state in directions 1, 2 and 3.
    pub fn axle(state: &SwayState) -> Vector3<f64> {
        Vector3::new(state[0].u, -state[1].u, -state[2].u)
    }

    /// Displacements of the axle per force on it, directions 1, 2 and 3.
    pub fn flexibility(&self) -> Matrix3<f64> {
        let up = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0));
        let own = self.inverse.fixed_view::<3, 3>(0, 0) * self.gains[0];
        let own = up * own * up;
        0.5 * (own + own.transpose())
    }

    /// A state at the end of a step with the forces of the contacts (directions 1, 2 and moment 3).
    pub fn with_contacts(&self, free: &SwayState, contacts: &Vector3<f64>) -> SwayState {
        let gained = self.inverse * Sway::pushed(contacts);
        std::array::from_fn(|i| Motion {
            u: free[i].u + self.gains[0] * gained[i],
            v: free[i].v + self.gains[1] * gained[i],
            a: free[i].a + gained[i],
        })
    }
}
