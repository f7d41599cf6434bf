//! The element with the wheel's modes inside, for hosts that have the hub and the rail: motions of both in, forces on both out, at the end of steps that the element divides as its forces ask for.
//!
//! The host's hub has the mass [`Unit::hub_mass`], what of the wheel does not move in its modes. Between two steps the host's motions are cubics with their velocities.

use crate::contact::{ContactAt, Motions, StaticContact};
use crate::element::{Element, OTHER_RAIL};
use crate::modal::{Modes, PreparedModes};
use crate::step::Side;
use nalgebra::{DMatrix, Matrix3, Matrix6, Vector3};
use railspring_profiles::error::{Error, InputError, Result};
use std::sync::Arc;

pub use crate::modal::Motion;

/// The longest and the shortest steps, s, and the largest deviation of the force at the end of one from the straight line through its last two values, of the largest force: those of the condensed element in a study with rows of 0.5 ms.
const LONGEST: f64 = 62.5e-6;
const SHORTEST: f64 = 3.9e-6;
const TOLERANCE: f64 = 0.01;

/// Steps become longer only where the deviation stays below the tolerance by as much.
const MARGIN: f64 = 1.5;

/// A force that a contact usually has, N: the tolerance is of this at least.
const USUAL: f64 = 60e3;

/// A step that finds no balance is halved at most so many times.
const MOST_HALVINGS: usize = 6;

/// The longest step of a host, s.
pub const LONGEST_OF_HOST: f64 = 0.1;

/// A host's motions.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Host {
    /// The wheel's hub, at its centre.
    pub hub: Motion,
    /// The section of the rail, about its line of shear centres.
    pub section: Motion,
    /// Place of the wheel along the study's rail, m from its first end, or [`crate::element::OTHER_RAIL`].
    pub place: f64,
}

/// Forces y, z (N) and torques about x (N·m).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct HostForces {
    /// Of the wheel on its hub.
    pub hub: Vector3<f64>,
    /// Of the wheel on the section of the rail; near a held end less than on the head.
    pub section: Vector3<f64>,
    /// On the rim, about the origin of the wheel's profile: minus Q and P are its first two.
    pub rim: Vector3<f64>,
}

impl Host {
    /// The motions at a share of the way to others that are `length` s later.
    fn towards(&self, end: &Self, length: f64, share: f64) -> Self {
        Self {
            hub: self.hub.towards(&end.hub, length, share),
            section: self.section.towards(&end.section, length, share),
            place: match self.place == OTHER_RAIL || end.place == OTHER_RAIL {
                true => end.place,
                false => self.place + share * (end.place - self.place),
            },
        }
    }
}

/// The state between two steps but for the contact's.
#[derive(Debug, Clone)]
struct Between {
    host: Host,
    modes: Vec<[f64; 2]>,
    /// Force on the rim, and its change over the last inner step, N/s.
    rim: Vector3<f64>,
    rate: Vector3<f64>,
    /// The largest force so far, N, and the longest inner step that the next step of the host may have, s.
    largest: f64,
    inner: f64,
}

/// An element with its modes and its state.
#[derive(Debug, Clone)]
pub struct Unit {
    contact: StaticContact,
    modes: Modes,
    committed: Between,
    trial: Between,
    /// Lengths of inner steps that are prepared, s.
    lengths: Vec<(f64, PreparedModes)>,
    /// The last inner step, s.
    last: f64,
    /// The contact at the last one of the inner steps of a step that is under way, if it has several.
    inner: StaticContact,
    evaluated: bool,
}

impl Unit {
    /// An element that has taken up nothing yet, with a coefficient of friction and the acceleration of gravity that acts on the modes, m/s² (0 for none; the hub's weight is the host's).
    ///
    /// # Errors
    /// As [`StaticContact::new`]; [`InputError`] for a gravity that is none.
    pub fn new(element: Arc<Element>, friction: f64, gravity: f64) -> Result<Self> {
        if !(gravity.is_finite() && gravity.abs() <= 100.0) {
            return InputError::refuse(
                "gravity",
                gravity,
                "an acceleration in m/s²",
                "give 9.81, or 0 for none",
            );
        }
        let modes = Modes::new(&element.wheel, element.damping, gravity);
        let contact = StaticContact::new(element, friction)?;
        let mut at = Vec::new();
        modes.at_rest(&Motion::default(), &mut at);
        let between = Between {
            host: Host { place: OTHER_RAIL, ..Host::default() },
            modes: at,
            rim: Vector3::zeros(),
            rate: Vector3::zeros(),
            largest: USUAL,
            inner: SHORTEST,
        };
        Ok(Self {
            inner: contact.clone(),
            contact,
            modes,
            trial: between.clone(),
            committed: between,
            lengths: Vec::new(),
            last: f64::NAN,
            evaluated: false,
        })
    }

    /// The element.
    pub fn element(&self) -> &Arc<Element> {
        self.contact.element()
    }

    /// Mass of the host's hub about its centre: that of the whole wheel but for what moves in its modes; kg, kg·m, kg·m².
    pub fn hub_mass(&self) -> Matrix3<f64> {
        self.element().wheel.mass_beside_modes()
    }

    /// As [`StaticContact::set_section_rest`].
    ///
    /// # Errors
    /// As there.
    pub fn set_section_rest(&mut self, rest: Matrix3<f64>) -> Result<()> {
        self.contact.set_section_rest(rest)
    }

    /// Begins with the host at its motions, friction that has taken up nothing, and modes that do not swing: as the hub has them, or `bent` by weight and contact.
    ///
    /// # Errors
    /// As [`StaticContact::evaluate`].
    pub fn start(&mut self, host: &Host, bent: bool) -> Result<HostForces> {
        self.evaluated = false;
        check(host)?;
        let wheel = &self.contact.element().wheel;
        let carried = wheel.carried_by_hub() * host.hub.displacement;
        let rim = match bent {
            true => Side { free: carried + self.modes.sag(), flexibility: wheel.rim_flexibility() },
            false => Side { free: carried, flexibility: wheel.rest },
        };
        self.contact.begin(rim, &motions(host, rim.free))?;
        let force = self.contact.on_rim();
        let Between { host: at, modes, rim, rate, largest, inner } = &mut self.committed;
        match bent {
            true => self.modes.bent(&host.hub, &force, modes),
            false => self.modes.at_rest(&host.hub, modes),
        }
        (*at, *rim, *rate, self.evaluated) = (*host, force, Vector3::zeros(), false);
        (*largest, *inner) = (USUAL.max(force.xy().norm()), SHORTEST);
        self.instant(host)
    }

    /// The forces at the end of a step of a `length` (s) from the end of the last one to a host's motions. The state stays as it is until [`Self::commit`].
    ///
    /// # Errors
    /// As [`StaticContact::evaluate`]; [`InputError`] for a length out of range.
    pub fn advance(&mut self, length: f64, end: &Host) -> Result<HostForces> {
        (self.evaluated, self.last) = (false, f64::NAN);
        check(end)?;
        self.contact.check(&motions(end, end.hub.displacement))?;
        if !(length > 0.0 && length <= LONGEST_OF_HOST) {
            let expected = format!("a step of more than 0 and at most {LONGEST_OF_HOST} s");
            return InputError::refuse("step", length, expected, "take shorter steps");
        }
        self.evaluated = false;
        let Self { committed, trial, .. } = self;
        trial.modes.clone_from(&committed.modes);
        (trial.host, trial.rim, trial.rate) = (committed.host, committed.rim, committed.rate);
        (trial.largest, trial.inner) = (committed.largest, committed.inner);
        self.inner.restore(&self.contact);
        // how many there are depends on the end of the last step alone, so that forces go on with the motions
        let mut count = ((length / committed.inner).ceil().max(1.0) as usize).next_power_of_two();
        let start = committed.host;
        let (mut taken, mut halvings) = (0, 0);
        while taken < count {
            let share = (taken + 1) as f64 / count as f64;
            let to = if taken + 1 == count { *end } else { start.towards(end, length, share) };
            match self.inner_step(length / count as f64, &to) {
                Err(Error::Numerics(_)) if halvings < MOST_HALVINGS => {
                    (count, taken, halvings) = (2 * count, 2 * taken, halvings + 1);
                }
                stepped => {
                    stepped?;
                    taken += 1;
                }
            }
        }
        self.evaluated = true;
        Ok(self.forces(end, &self.trial))
    }

    /// The next of the inner steps, of a `length` (s) to the motions `to`, taken by the contact `inner` and the state `trial`; sees how long the next ones may be.
    fn inner_step(&mut self, length: f64, to: &Host) -> Result<()> {
        let at = self.prepared(length);
        self.last = length;
        let Self { trial, modes, lengths, inner, .. } = self;
        let prepared = &lengths[at].1;
        let from = trial.host;
        let hubs = [&from.hub, &to.hub];
        let free = modes.free(prepared, &trial.modes, hubs, &trial.rim);
        let flexibility = prepared.flexibility + inner.element().wheel.rest;
        let head = inner.section(&motions(to, free));
        inner.meet(Side { free, flexibility }, head, to.place)?;
        let force = inner.on_rim();
        modes.finish(prepared, &mut trial.modes, hubs, [&trial.rim, &force]);
        inner.commit();
        trial.largest = trial.largest.max(force.xy().norm());
        let off = (force - trial.rim - trial.rate * length).xy().norm() / (TOLERANCE * trial.largest);
        // it falls with the square of the length
        trial.inner = if off > 1.0 {
            (length * 0.5_f64.powf((0.5 * off.log2()).ceil())).clamp(SHORTEST, LONGEST)
        } else if 4.0 * MARGIN * off < 1.0 {
            (2.0 * length).clamp(trial.inner.min(LONGEST), LONGEST)
        } else {
            trial.inner.min(length.max(SHORTEST))
        };
        (trial.rate, trial.rim, trial.host) = ((force - trial.rim) / length, force, *to);
        Ok(())
    }

    /// The number of a prepared length, s. A host with steps of many lengths has the oldest ones made again.
    fn prepared(&mut self, length: f64) -> usize {
        const ROOM: usize = 16;
        if let Some(at) = self.lengths.iter().position(|(of, _)| *of == length) {
            return at;
        }
        if self.lengths.len() == ROOM {
            self.lengths.remove(0);
        }
        self.lengths.push((length, self.modes.prepare(length)));
        self.lengths.len() - 1
    }

    /// Derivatives of the forces on hub and section that [`Self::advance`] found last by the displacements of both at the end of its step; N/m, N, N·m. They are those of its last inner step, which has
    /// all of the change where there is one, and not by the velocities: a good guess for steps of up to 100 µs. Without such a step it is zero.
    pub fn tangent(&self) -> Matrix6<f64> {
        let of_contact = if self.evaluated { &self.inner } else { &self.contact };
        match self.lengths.iter().find(|(length, _)| *length == self.last) {
            Some((_, prepared)) => {
                self.modes.tangent(prepared, &of_contact.of_rim(&prepared.flexibility).tangent)
            }
            None => Matrix6::zeros(),
        }
    }

    /// Takes what was found by [`Self::advance`] last as the end of a step. Without anything found since the last step nothing changes.
    pub fn commit(&mut self) {
        if std::mem::take(&mut self.evaluated) {
            std::mem::swap(&mut self.contact, &mut self.inner);
            std::mem::swap(&mut self.committed, &mut self.trial);
        }
    }

    /// Takes over the state of another unit of the same element at the end of its last step, in the memory that there is.
    pub fn restore(&mut self, other: &Self) {
        self.contact.restore(&other.contact);
        self.inner.restore(&other.contact);
        let Between { host, modes, rim, rate, largest, inner } = &other.committed;
        self.committed.modes.clone_from(modes);
        (self.committed.host, self.committed.rim, self.committed.rate) = (*host, *rim, *rate);
        (self.committed.largest, self.committed.inner) = (*largest, *inner);
        self.last = f64::NAN;
        self.evaluated = false;
    }

    /// The contacts as found last.
    pub fn contacts(&self) -> impl ExactSizeIterator<Item = ContactAt> + '_ {
        if self.evaluated { self.inner.contacts() } else { self.contact.contacts() }
    }

    fn forces(&self, host: &Host, at: &Between) -> HostForces {
        let hub = self.modes.on_hub(&host.hub, &at.modes, &at.rim);
        let of_contact = if self.evaluated { &self.inner } else { &self.contact };
        HostForces { hub, section: of_contact.of_rim(&Matrix3::zeros()).section, rim: at.rim }
    }
}

/// A unit whose modes the host integrates as states, for model exchange: of each mode of 1 kg the amplitude with the hub held and its coupling times the motion of the hub, and the velocity of that.
impl Unit {
    /// Number of modes.
    pub fn modes(&self) -> usize {
        self.modes.count()
    }

    /// Displacement and velocity of each mode at the end of the last step.
    pub fn modal_state(&self) -> &[[f64; 2]] {
        &self.committed.modes
    }

    /// Sets them; as many as there are.
    ///
    /// # Errors
    /// [`InputError`] for another number of them, or values that are not finite.
    pub fn set_modal_state(&mut self, state: &[[f64; 2]]) -> Result<()> {
        if state.len() != self.modes.count() || !state.iter().flatten().all(|value| value.is_finite()) {
            let expected = format!("finite displacements and velocities of {} modes", self.modes.count());
            return InputError::refuse(
                "modal state",
                format!("{} modes", state.len()),
                expected,
                "set all of them",
            );
        }
        self.committed.modes.clone_from_slice(state);
        Ok(())
    }

    /// The forces with the host at its motions and the modes as they are, at once. [`Self::commit_instant`] takes them as the end of a step of friction.
    ///
    /// # Errors
    /// As [`StaticContact::evaluate`].
    pub fn instant(&mut self, host: &Host) -> Result<HostForces> {
        (self.evaluated, self.last) = (false, f64::NAN);
        check(host)?;
        self.contact.check(&motions(host, host.hub.displacement))?;
        let rim = self.modes.rim(&host.hub, &self.committed.modes);
        let forces = self.contact.evaluate(&motions(host, rim))?;
        self.committed.rim = forces.rim;
        let hub = self.modes.on_hub(&host.hub, &self.committed.modes, &forces.rim);
        Ok(HostForces { hub, section: forces.section, rim: forces.rim })
    }

    /// Accelerations of the modes after [`Self::instant`] with the same host.
    pub fn accelerations(&self, host: &Host, into: &mut [f64]) {
        self.modes.accelerations(&host.hub, &self.committed.modes, &self.committed.rim, into);
    }

    /// Derivatives after [`Self::instant`], or at the end of the last step: rows are the forces on hub and section and the modes' accelerations; columns the hub's displacements and velocities, the section's
    /// displacements, and the modes' displacements and velocities.
    pub fn jacobian(&self) -> DMatrix<f64> {
        let of_contact = if self.evaluated { &self.inner } else { &self.contact };
        self.modes.jacobian(&of_contact.of_rim(&Matrix3::zeros()).tangent)
    }

    /// Has the host where it turned out to be at the end of the last step.
    pub fn set_host(&mut self, host: &Host) {
        self.committed.host = *host;
    }

    /// Takes the contact as [`Self::instant`] had it as the end of a step of friction, with the host there.
    pub fn commit_instant(&mut self, host: &Host) {
        self.contact.commit();
        self.committed.host = *host;
    }
}

fn motions(host: &Host, rim: Vector3<f64>) -> Motions {
    Motions { rim, section: host.section.displacement, place: host.place }
}

/// The fastest motion, m/s and rad/s: a wheel that falls from 500 m.
const FASTEST: f64 = 100.0;

fn check(host: &Host) -> Result<()> {
    let fast = host.hub.velocity.iter().chain(&host.section.velocity).find(|v| v.abs() > FASTEST);
    if let Some(value) = fast {
        let expected = format!("velocities of at most {FASTEST} m/s and rad/s");
        return InputError::refuse("motion", value, expected, "give m/s and rad/s");
    }
    let velocities = host.hub.velocity.iter().chain(&host.section.velocity);
    match velocities
        .chain(&host.hub.displacement)
        .chain(&host.section.displacement)
        .chain([&host.place])
        .find(|v| !v.is_finite())
    {
        Some(value) => InputError::refuse(
            "motion",
            value,
            "finite displacements (m), rotations (rad), velocities and place (m)",
            "correct the host's motion",
        ),
        None => Ok(()),
    }
}
