//! The element with the wheel's modes inside, for hosts that have the hub and the rail: motions of both in, forces on both out, at the end of steps that the element divides as its forces ask for.
//!
//! The host's hub has the mass [`Unit::hub_mass`], what of the wheel does not move in its modes. Between two steps the host's motions are cubics with their velocities.

use crate::contact::{ContactAt, Motions, StaticContact};
use crate::element::Element;
use crate::modal::{Modes, PreparedModes};
use crate::step::Side;
use crate::steps::{InnerSteps, StepControl, StepSequence};
use nalgebra::{Matrix3, Matrix6, Vector3};
use railspring_profiles::error::{Error, InputError, Result};
use std::sync::Arc;

pub use crate::modal::Motion;

/// The longest and the shortest steps, s, and the tolerance of their forces: those of the condensed element in a study with rows of 0.5 ms.
const LONGEST: f64 = 62.5e-6;
const SHORTEST: f64 = 3.9e-6;
const TOLERANCE: f64 = 0.01;

/// A force that a contact usually has, N: the tolerance is of this at least.
const USUAL: f64 = 60e3;

/// The longest step of a host, s.
pub const LONGEST_OF_HOST: f64 = 0.1;

/// A host's motions.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Host {
    /// The wheel's hub, at its centre.
    pub hub: Motion,
    /// The section of the rail, about its line of shear centres.
    pub section: Motion,
    /// Place of the wheel along the rail, m from its first end.
    pub place: f64,
}

/// Forces y, z (N) and torques about x (N·m).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct HostForces {
    /// Of the wheel on its hub.
    pub hub: Vector3<f64>,
    /// Of the wheel on the section of the rail: `Q` and `P` are its first two.
    pub section: Vector3<f64>,
}

/// The state between two steps but for the contact's.
#[derive(Debug, Clone)]
struct Between {
    host: Host,
    modes: Vec<[f64; 2]>,
    /// Force on the rim.
    rim: Vector3<f64>,
    sequence: Option<StepSequence>,
}

/// An element with its modes and its state.
#[derive(Debug, Clone)]
pub struct Unit {
    contact: StaticContact,
    modes: Modes,
    committed: Between,
    trial: Between,
    /// The host's step for which lengths are prepared, s, and these by their halvings.
    step: f64,
    lengths: Vec<PreparedModes>,
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
        let between = Between { host: Host::default(), modes: at, rim: Vector3::zeros(), sequence: None };
        Ok(Self {
            inner: contact.clone(),
            contact,
            modes,
            trial: between.clone(),
            committed: between,
            step: f64::NAN,
            lengths: Vec::new(),
            evaluated: false,
        })
    }

    /// The element.
    pub fn element(&self) -> &Arc<Element> {
        self.contact.element()
    }

    /// Mass of the host's hub about its centre: that of the whole wheel but for what moves in its modes; kg, kg·m, kg·m².
    pub fn hub_mass(&self) -> Matrix3<f64> {
        let wheel = &self.element().wheel;
        wheel.modes.iter().fold(wheel.mass, |mass, mode| mass - mode.coupling * mode.coupling.transpose())
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
        check(host)?;
        let wheel = &self.contact.element().wheel;
        let carried = wheel.carried_by_hub() * host.hub.displacement;
        let rim = match bent {
            true => Side { free: carried + self.modes.sag(), flexibility: wheel.rim_flexibility() },
            false => Side { free: carried, flexibility: wheel.rest },
        };
        self.contact.begin(rim, &motions(host, rim.free))?;
        let force = self.contact.on_rim();
        let Between { host: at, modes, rim, sequence } = &mut self.committed;
        match bent {
            true => self.modes.bent(&host.hub, &force, modes),
            false => self.modes.at_rest(&host.hub, modes),
        }
        (*at, *rim, *sequence, self.evaluated) = (*host, force, None, false);
        self.instant(host)
    }

    /// The forces at the end of a step of a `length` (s) from the end of the last one to a host's motions. The state stays as it is until [`Self::commit`].
    ///
    /// # Errors
    /// As [`StaticContact::evaluate`]; [`InputError`] for a length out of range.
    pub fn advance(&mut self, length: f64, end: &Host) -> Result<HostForces> {
        check(end)?;
        if !(length > 0.0 && length <= LONGEST_OF_HOST) {
            let expected = format!("a step of more than 0 and at most {LONGEST_OF_HOST} s");
            return InputError::refuse("step", length, expected, "take shorter steps");
        }
        self.evaluated = false;
        let steps = InnerSteps::Adaptive(control(length));
        if length != self.step {
            (self.step, self.committed.sequence) = (length, None);
            self.lengths.clear();
        }
        let Self { committed, trial, .. } = self;
        trial.modes.clone_from(&committed.modes);
        (trial.host, trial.rim) = (committed.host, committed.rim);
        let mut sequence = committed.sequence.clone().unwrap_or_else(|| {
            let mut sequence = StepSequence::new(steps, USUAL);
            sequence.begin(committed.rim.xy().as_slice(), &[]);
            sequence
        });
        let first = sequence.ticks();
        let most = steps.most();
        self.inner.restore(&self.contact);
        while sequence.ticks() < first + most {
            self.inner_step(&mut sequence, [length, (first) as f64], most, end)?;
        }
        self.trial.sequence = Some(sequence);
        self.trial.host = *end;
        self.evaluated = true;
        Ok(self.forces(end, &self.trial))
    }

    /// The next of the inner steps to the end of the host's, taken by the contact `inner` and the state `trial`.
    fn inner_step(
        &mut self,
        sequence: &mut StepSequence,
        [length, first]: [f64; 2],
        most: usize,
        end: &Host,
    ) -> Result<()> {
        loop {
            let level = sequence.level();
            while self.lengths.len() <= level {
                let [longest, _] = InnerSteps::Adaptive(control(length)).lengths(length);
                let step = longest * 0.5_f64.powi(self.lengths.len() as i32);
                self.lengths.push(self.modes.prepare(step));
            }
            let prepared = &self.lengths[level];
            let share = (sequence.end() as f64 - first) / most as f64;
            let (start, from) = (&self.committed.host, self.trial.host);
            let to = match share < 1.0 {
                true => Host {
                    hub: start.hub.towards(&end.hub, length, share),
                    section: start.section.towards(&end.section, length, share),
                    place: start.place + share * (end.place - start.place),
                },
                false => *end,
            };
            let hubs = [&from.hub, &to.hub];
            let free = self.modes.free(prepared, &self.trial.modes, hubs, &self.trial.rim);
            let flexibility = prepared.flexibility + self.element().wheel.rest;
            let at = motions(&to, free);
            let head = self.inner.section(&at);
            match self.inner.meet(Side { free, flexibility }, head, to.place) {
                Err(Error::Numerics(_)) if sequence.shorten() => continue,
                met => met?,
            }
            let force = self.inner.on_rim();
            if !sequence.accept(force.xy().as_slice(), &[], 0.0) {
                continue;
            }
            let trial = &mut self.trial;
            self.modes.finish(prepared, &mut trial.modes, hubs, [&trial.rim, &force]);
            (trial.host, trial.rim) = (to, force);
            self.inner.commit();
            return Ok(());
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
        let Between { host, modes, rim, sequence } = &other.committed;
        self.committed.modes.clone_from(modes);
        self.committed.sequence.clone_from(sequence);
        (self.committed.host, self.committed.rim) = (*host, *rim);
        if self.step != other.step {
            self.step = other.step;
            self.lengths.clone_from(&other.lengths);
        }
        self.evaluated = false;
    }

    /// The contacts as found last.
    pub fn contacts(&self) -> impl ExactSizeIterator<Item = ContactAt> + '_ {
        if self.evaluated { self.inner.contacts() } else { self.contact.contacts() }
    }

    fn forces(&self, host: &Host, at: &Between) -> HostForces {
        let hub = self.modes.on_hub(&host.hub, &at.modes, &at.rim);
        let of_contact = if self.evaluated { &self.inner } else { &self.contact };
        HostForces { hub, section: of_contact.at_rest().section }
    }
}

/// A unit whose modes the host integrates as states, for model exchange: `p` and `ṗ` of each mode as in [`crate::modal`].
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
        check(host)?;
        self.evaluated = false;
        let rim = self.modes.rim(&host.hub, &self.committed.modes);
        let forces = self.contact.evaluate(&motions(host, rim))?;
        self.committed.rim = forces.rim;
        let hub = self.modes.on_hub(&host.hub, &self.committed.modes, &forces.rim);
        Ok(HostForces { hub, section: forces.section })
    }

    /// Accelerations of the modes after [`Self::instant`] with the same host.
    pub fn accelerations(&self, host: &Host, into: &mut [f64]) {
        self.modes.accelerations(&host.hub, &self.committed.modes, &self.committed.rim, into);
    }

    /// Derivatives of the forces on hub and section, after [`Self::instant`] or at the end of the last step: by displacements of both, and of the force on the hub by its velocity.
    pub fn derivatives(&self) -> (Matrix6<f64>, Matrix3<f64>) {
        let of_contact = if self.evaluated { &self.inner } else { &self.contact };
        let tangent = of_contact.at_rest().tangent;
        let mut of_host = Matrix6::identity();
        of_host.fixed_view_mut::<3, 3>(0, 0).copy_from(&self.modes.of_hub);
        let mut tangent = of_host.transpose() * tangent * of_host;
        let [stiffness, damping] = self.modes.hub_stiffness();
        let mut of_hub = tangent.fixed_view_mut::<3, 3>(0, 0);
        of_hub += stiffness;
        (tangent, damping)
    }

    /// Takes the contact as [`Self::instant`] had it as the end of a step of friction, with the host there.
    pub fn commit_instant(&mut self, host: &Host) {
        self.contact.commit();
        (self.committed.host, self.committed.sequence) = (*host, None);
    }
}

/// Steps within one of a host's, of a length (s).
fn control(length: f64) -> StepControl {
    let parts = |longest: f64| ((length / longest).ceil().max(1.0) as usize).next_power_of_two();
    let least = parts(LONGEST);
    StepControl { least, most: parts(SHORTEST).max(least), tolerance: TOLERANCE }
}

fn motions(host: &Host, rim: Vector3<f64>) -> Motions {
    Motions { rim, section: host.section.displacement, place: host.place }
}

fn check(host: &Host) -> Result<()> {
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
