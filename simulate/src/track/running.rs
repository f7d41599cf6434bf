//! What runs on the track: a force, a sprung wheel, or a wheelset with a mass above.

use nalgebra::{DMatrix, DVector};

use crate::time::newmark::{Motion, Newmark};
use crate::time::scenario::Kelvin;

/// A wheel, and a mass above it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SprungWheel {
    /// Mass of the wheel, kg.
    pub mass: f64,
    /// Mass above, kg; 0 for none.
    pub above: f64,
    /// Spring and damper between them.
    pub suspension: Kelvin,
}

/// Two wheels on an axle, and a mass above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wheelset {
    /// Mass of the wheelset, kg.
    pub mass: f64,
    /// Its moment of inertia about the track's axis, kg·m².
    pub inertia: f64,
    /// Mass above, kg; 0 for none.
    pub above: f64,
    /// Its moment of inertia about the track's axis, kg·m².
    pub above_inertia: f64,
    /// Spring and damper on each side.
    pub suspension: Kelvin,
    /// Half the distance of the contacts, m.
    pub half_track: f64,
    /// Half the distance of the suspensions, m.
    pub half_base: f64,
}

/// What runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Running {
    /// The vertical force itself, without a mass.
    Force,
    /// A wheel on one rail.
    Wheel(SprungWheel),
    /// Two wheels on a rail each.
    Wheelset(Wheelset),
}

impl Running {
    /// Number of wheels.
    pub fn wheels(&self) -> usize {
        if let Self::Wheelset(_) = self { 2 } else { 1 }
    }

    /// All its mass, kg.
    pub fn mass(&self) -> f64 {
        match self {
            Self::Force => 0.0,
            Self::Wheel(wheel) => wheel.mass + wheel.above,
            Self::Wheelset(set) => set.mass + set.above,
        }
    }

    /// Whether a mass above has no spring to rest on.
    pub fn hangs(&self) -> bool {
        match self {
            Self::Force => false,
            Self::Wheel(wheel) => wheel.above > 0.0 && wheel.suspension.stiffness <= 0.0,
            Self::Wheelset(set) => set.above > 0.0 && set.suspension.stiffness <= 0.0,
        }
    }
}

/// Its coordinates: displacement of the wheels down and, of a wheelset, roll (positive lowers the right wheel); then those of the mass above.
pub(super) struct Vehicle {
    mass: DVector<f64>,
    stiffness: DMatrix<f64>,
    damping: DMatrix<f64>,
    /// Displacement of each contact from the coordinates: right, then left.
    contacts: Vec<DVector<f64>>,
    /// Number of the coordinate on which the vertical force acts, and of the one with the roll moment.
    loaded: [Option<usize>; 2],
    /// Those in which weight and ground act.
    vertical: Vec<usize>,
    /// Displacement of the mass above.
    above: Option<usize>,
}

/// What acts besides the contacts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Loads {
    /// Force down on the mass above, or on the wheels without one, N.
    pub force: f64,
    /// Moment about the track on the same, positive presses on the right wheel, N·m.
    pub roll: f64,
    /// Acceleration of gravity less that of the ground, m/s².
    pub gravity: f64,
}

impl Vehicle {
    pub fn new(running: &Running) -> Self {
        let joint = |stiffness: &mut DMatrix<f64>,
                     damping: &mut DMatrix<f64>,
                     from: usize,
                     to: usize,
                     kelvin: Kelvin| {
            for (matrix, value) in [(stiffness, kelvin.stiffness), (damping, kelvin.damping)] {
                for (i, j, sign) in [(from, from, 1.0), (to, to, 1.0), (from, to, -1.0), (to, from, -1.0)] {
                    matrix[(i, j)] += sign * value;
                }
            }
        };
        let times = |kelvin: Kelvin, factor: f64| Kelvin {
            stiffness: factor * kelvin.stiffness,
            damping: factor * kelvin.damping,
        };
        match *running {
            Running::Force => Self {
                mass: DVector::zeros(0),
                stiffness: DMatrix::zeros(0, 0),
                damping: DMatrix::zeros(0, 0),
                contacts: vec![DVector::zeros(0)],
                loaded: [None; 2],
                vertical: Vec::new(),
                above: None,
            },
            Running::Wheel(SprungWheel { mass, above, suspension }) => {
                let count = if above > 0.0 { 2 } else { 1 };
                let (mut k, mut c) = (DMatrix::zeros(count, count), DMatrix::zeros(count, count));
                if above > 0.0 {
                    joint(&mut k, &mut c, 0, 1, suspension);
                }
                Self {
                    mass: DVector::from_iterator(count, [mass, above].into_iter().take(count)),
                    stiffness: k,
                    damping: c,
                    contacts: vec![DVector::from_fn(count, |i, _| if i == 0 { 1.0 } else { 0.0 })],
                    loaded: [Some(count - 1), None],
                    vertical: (0..count).collect(),
                    above: (count == 2).then_some(1),
                }
            }
            Running::Wheelset(set) => {
                let count = if set.above > 0.0 { 4 } else { 2 };
                let (mut k, mut c) = (DMatrix::zeros(count, count), DMatrix::zeros(count, count));
                if set.above > 0.0 {
                    joint(&mut k, &mut c, 0, 2, times(set.suspension, 2.0));
                    joint(&mut k, &mut c, 1, 3, times(set.suspension, 2.0 * set.half_base.powi(2)));
                }
                let masses = [set.mass, set.inertia, set.above, set.above_inertia];
                let contact = |side: f64| {
                    DVector::from_fn(count, |i, _| {
                        [1.0, side * set.half_track].get(i).copied().unwrap_or(0.0)
                    })
                };
                Self {
                    mass: DVector::from_iterator(count, masses.into_iter().take(count)),
                    stiffness: k,
                    damping: c,
                    contacts: vec![contact(1.0), contact(-1.0)],
                    loaded: [Some(count - 2), Some(count - 1)],
                    vertical: (0..count).step_by(2).collect(),
                    above: (count == 4).then_some(2),
                }
            }
        }
    }

    pub fn coordinates(&self) -> usize {
        self.mass.len()
    }

    /// Displacement of a contact, m.
    pub fn contact(&self, wheel: usize, state: &[Motion]) -> f64 {
        self.contacts[wheel].iter().zip(state).map(|(row, motion)| row * motion.u).sum()
    }

    /// Motion of the mass above.
    pub fn above<'s>(&self, state: &'s [Motion]) -> Option<&'s Motion> {
        self.above.map(|at| &state[at])
    }

    fn forces(&self, loads: &Loads) -> DVector<f64> {
        let mut forces = DVector::zeros(self.coordinates());
        for (at, value) in self.loaded.iter().zip([loads.force, loads.roll]) {
            if let Some(at) = at {
                forces[*at] += value;
            }
        }
        self.vertical.iter().for_each(|&at| forces[at] += self.mass[at] * loads.gravity);
        forces
    }

    /// Forces of the contacts at rest, N, negative where a wheel would have to be pulled down.
    pub fn carried(&self, running: &Running, loads: &Loads) -> Vec<f64> {
        let sum = loads.force + running.mass() * loads.gravity;
        match running {
            Running::Wheelset(set) => {
                let apart = loads.roll / set.half_track;
                vec![0.5 * (sum + apart), 0.5 * (sum - apart)]
            }
            _ => vec![sum],
        }
    }

    /// At rest with the contacts at displacements (m).
    pub fn at_rest(&self, running: &Running, loads: &Loads, contacts: &[f64]) -> Vec<Motion> {
        let still = |u: f64| Motion { u, ..Motion::default() };
        match running {
            Running::Force => Vec::new(),
            Running::Wheel(wheel) => {
                let stroke = (loads.force + wheel.above * loads.gravity) / wheel.suspension.stiffness;
                [contacts[0], contacts[0] + stroke].map(still)[..self.coordinates()].to_vec()
            }
            Running::Wheelset(set) => {
                let [right, left] = [contacts[0], contacts[1]];
                let (down, roll) = (0.5 * (right + left), 0.5 * (right - left) / set.half_track);
                let two = 2.0 * set.suspension.stiffness;
                let stroke = (loads.force + set.above * loads.gravity) / two;
                let turn = loads.roll / (two * set.half_base.powi(2));
                [down, roll, down + stroke, roll + turn].map(still)[..self.coordinates()].to_vec()
            }
        }
    }

    /// Gives a state its accelerations under loads and forces of the contacts (N).
    pub fn accelerate(&self, state: &mut [Motion], loads: &Loads, contacts: &[f64]) {
        let (u, v) = (self.column(state, |m| m.u), self.column(state, |m| m.v));
        let mut forces = self.forces(loads) - &self.stiffness * u - &self.damping * v;
        for (row, force) in self.contacts.iter().zip(contacts) {
            forces -= row * *force;
        }
        for (motion, (force, mass)) in state.iter_mut().zip(forces.iter().zip(&self.mass)) {
            motion.a = force / mass;
        }
    }

    fn column(&self, state: &[Motion], of: impl Fn(&Motion) -> f64) -> DVector<f64> {
        DVector::from_iterator(self.coordinates(), state.iter().map(of))
    }

    /// The vehicle over steps of a scheme.
    pub fn over(&self, scheme: Newmark) -> VehicleSteps<'_> {
        let gains = [1.0 / scheme.acceleration, scheme.velocity / scheme.acceleration];
        let matrix =
            DMatrix::from_diagonal(&self.mass) + &self.stiffness * gains[0] + &self.damping * gains[1];
        // masses are positive, and a matrix of springs and dampers takes nothing away
        let inverse = matrix
            .try_inverse()
            .unwrap_or_else(|| DMatrix::from_element(self.coordinates(), self.coordinates(), f64::NAN));
        let count = self.contacts.len();
        let flexibility = DMatrix::from_fn(count, count, |i, j| {
            gains[0] * self.contacts[i].dot(&(&inverse * &self.contacts[j]))
        });
        VehicleSteps { vehicle: self, scheme, gains, inverse, flexibility }
    }
}

/// A vehicle over steps of one length.
pub(super) struct VehicleSteps<'v> {
    vehicle: &'v Vehicle,
    scheme: Newmark,
    gains: [f64; 2],
    inverse: DMatrix<f64>,
    /// Displacements of the contacts per force up there, m/N.
    pub flexibility: DMatrix<f64>,
}

impl VehicleSteps<'_> {
    /// The state at the end of a step without forces of the contacts: its accelerations stand for the right-hand side's solution.
    pub fn free(&self, state: &[Motion], loads: &Loads) -> Vec<Motion> {
        let vehicle = self.vehicle;
        let predicted: Vec<[f64; 2]> = state.iter().map(|motion| self.scheme.predicted(motion)).collect();
        let column = |i: usize| DVector::from_iterator(predicted.len(), predicted.iter().map(|p| p[i]));
        let (u, v) = (column(0), column(1));
        let forces = vehicle.forces(loads) - &vehicle.stiffness * &u - &vehicle.damping * &v;
        let accelerations = &self.inverse * forces;
        self.moved(&u, &v, &accelerations)
    }

    /// The same with forces (N) of the contacts.
    pub fn with_contacts(&self, free: &[Motion], contacts: &[f64]) -> Vec<Motion> {
        let mut pushed = DVector::zeros(free.len());
        for (row, force) in self.vehicle.contacts.iter().zip(contacts) {
            pushed -= row * *force;
        }
        let gained = &self.inverse * pushed;
        let moved = |(motion, a): (&Motion, &f64)| Motion {
            u: motion.u + self.gains[0] * a,
            v: motion.v + self.gains[1] * a,
            a: motion.a + a,
        };
        free.iter().zip(&gained).map(moved).collect()
    }

    fn moved(&self, u: &DVector<f64>, v: &DVector<f64>, a: &DVector<f64>) -> Vec<Motion> {
        let of =
            |i: usize| Motion { u: u[i] + self.gains[0] * a[i], v: v[i] + self.gains[1] * a[i], a: a[i] };
        (0..u.len()).map(of).collect()
    }
}
