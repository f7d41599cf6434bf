//! An instance: the unit with what an importer has set.

use nalgebra::{DVector, Matrix3};
use railspring_element::element::Element;
use railspring_element::unit::{Host, HostForces, Unit};
use railspring_element::variables::{RESOURCE, Variable, token};
use railspring_profiles::error::{InputError, Result};
use std::path::Path;
use std::sync::Arc;

/// What a unit is instantiated for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    CoSimulation,
    ModelExchange,
}

/// What an importer can set and take back.
#[derive(Debug, Clone)]
pub(super) struct State {
    unit: Unit,
    host: Host,
    time: f64,
    friction: f64,
    gravity: f64,
    rest: [f64; 6],
    at_end: bool,
    bent: bool,
    modes: Vec<[f64; 2]>,
    forces: HostForces,
    /// Whether it has begun, and whether forces are those of the values that were set.
    begun: bool,
    fresh: bool,
}

/// An instance.
#[derive(Debug, Clone)]
pub(super) struct Instance {
    kind: Kind,
    pub state: State,
    /// What it began with.
    first: Box<State>,
}

fn unknown<T>(reference: u32) -> Result<T> {
    InputError::refuse(
        "valueReference",
        reference,
        "one of modelDescription.xml that can be used so",
        "take the description of this unit",
    )
}

impl Instance {
    /// From the folder of resources of a unit.
    pub fn new(kind: Kind, resources: &Path, wanted: &str) -> Result<Self> {
        let element = Arc::new(Element::open(&resources.join(RESOURCE))?);
        let own = token(&element);
        if own != wanted {
            return InputError::refuse(
                "instantiationToken",
                wanted,
                own,
                "take modelDescription.xml and resources of one unit",
            );
        }
        let (friction, host) = (
            element.friction,
            Host { place: element.rail_at_wheel.as_ref().map_or(0.0, |rail| rail.place), ..Host::default() },
        );
        let unit = Unit::new(element, friction, 0.0)?;
        let modes = unit.modal_state().to_vec();
        let state = State {
            unit,
            host,
            time: 0.0,
            friction,
            gravity: 0.0,
            rest: [0.0; 6],
            at_end: false,
            bent: false,
            modes,
            forces: HostForces::default(),
            begun: false,
            fresh: false,
        };
        Ok(Self { kind, first: Box::new(state.clone()), state })
    }

    /// As it began.
    pub fn reset(&mut self) {
        self.state.clone_from(&self.first);
    }

    fn modes(&self) -> usize {
        self.state.modes.len()
    }

    /// Begins at a time, s, with the parameters that were set.
    pub fn begin(&mut self, time: f64) {
        (self.state.time, self.state.begun, self.state.fresh) = (time, false, false);
    }

    /// Sees that the forces are those of what was set.
    pub fn update(&mut self) -> Result<()> {
        let kind = self.kind;
        let State { unit, host, friction, gravity, rest, bent, modes, forces, begun, fresh, .. } =
            &mut self.state;
        if *fresh {
            return Ok(());
        }
        if !*begun {
            let [yy, yz, yr, zz, zr, rr] = *rest;
            let element = unit.element().clone();
            *unit = Unit::new(element, *friction, *gravity)?;
            unit.set_section_rest(Matrix3::new(yy, yz, yr, yz, zz, zr, yr, zr, rr))?;
        }
        if kind == Kind::ModelExchange {
            unit.set_modal_state(modes)?;
            *forces = unit.instant(host)?;
        } else if !*begun {
            *forces = unit.start(host, *bent)?;
        }
        *fresh = true;
        Ok(())
    }

    /// Ends the initialisation.
    pub fn initialised(&mut self) -> Result<()> {
        self.update()?;
        self.state.begun = true;
        Ok(())
    }

    /// A step of co-simulation.
    pub fn step(&mut self, time: f64, length: f64) -> Result<()> {
        let State { unit, host, at_end, forces, time: now, .. } = &mut self.state;
        let end = match at_end {
            true => *host,
            false => {
                unit.set_host(host);
                Host { hub: host.hub.after(length), section: host.section.after(length), place: host.place }
            }
        };
        *forces = unit.advance(length, &end)?;
        unit.commit();
        (*now, self.state.fresh) = (time + length, true);
        Ok(())
    }

    /// Ends a step of an importer that integrates the modes.
    pub fn integrated(&mut self) -> Result<()> {
        self.update()?;
        let State { unit, host, .. } = &mut self.state;
        unit.commit_instant(host);
        Ok(())
    }

    pub fn set_time(&mut self, time: f64) {
        self.state.time = time;
    }

    pub fn state_count(&self) -> usize {
        2 * self.modes()
    }

    /// The states in the order of their references.
    pub fn states(&self) -> impl Iterator<Item = f64> + '_ {
        self.state.modes.iter().flatten().copied()
    }

    pub fn set_states(&mut self, states: &[f64]) {
        for (mode, [p, v]) in self.state.modes.iter_mut().zip(states.as_chunks::<2>().0) {
            *mode = [*p, *v];
        }
        self.state.fresh = false;
    }

    /// The derivatives of the states, in their order.
    pub fn derivatives(&mut self) -> Result<Vec<f64>> {
        self.update()?;
        let State { unit, host, modes, .. } = &self.state;
        let mut accelerations = vec![0.0; modes.len()];
        unit.accelerations(host, &mut accelerations);
        Ok(modes.iter().zip(accelerations).flat_map(|([_, v], a)| [*v, a]).collect())
    }

    /// A number.
    pub fn get(&mut self, reference: u32) -> Result<f64> {
        let variable = Variable::of(reference, self.modes());
        if matches!(variable, Some(Variable::Force(_) | Variable::Contacts | Variable::Contact(..))) {
            self.update()?;
        }
        if let Some(Variable::Rate(_) | Variable::Acceleration(_)) = variable {
            let derivatives = self.derivatives()?;
            let first = Variable::Rate(0).reference();
            return Ok(derivatives[(reference - first) as usize]);
        }
        let State { unit, host, time, friction, gravity, rest, forces, modes, .. } = &self.state;
        let of_modes = if self.kind == Kind::CoSimulation { unit.modal_state() } else { &modes[..] };
        Ok(match variable {
            Some(Variable::Time) => *time,
            Some(Variable::Motion(i)) => *motion(&mut host.clone(), i),
            Some(Variable::Force(i)) => [forces.hub, forces.section, forces.rim][i / 3][i % 3],
            Some(Variable::Contacts) => unit.contacts().len() as f64,
            Some(Variable::Contact(contact, number)) => unit.contacts().nth(contact).map_or(0.0, |at| {
                [at.normal_force, at.tangential_force, at.rail.x, at.rail.y, f64::from(u8::from(at.slides))]
                    [number]
            }),
            Some(Variable::Friction) => *friction,
            Some(Variable::Gravity) => *gravity,
            Some(Variable::Rest(i)) => rest[i],
            Some(Variable::Displacement(i)) => of_modes[i][0],
            Some(Variable::Velocity(i)) => of_modes[i][1],
            _ => return unknown(reference),
        })
    }

    /// Sets a number.
    pub fn set(&mut self, reference: u32, value: f64) -> Result<()> {
        let state = &mut self.state;
        match Variable::of(reference, state.modes.len()) {
            Some(Variable::Motion(i)) => *motion(&mut state.host, i) = value,
            Some(Variable::Friction) if !state.begun => state.friction = value,
            Some(Variable::Gravity) if !state.begun => state.gravity = value,
            Some(Variable::Rest(i)) if !state.begun => state.rest[i] = value,
            Some(Variable::Displacement(i)) => state.modes[i][0] = value,
            Some(Variable::Velocity(i)) => state.modes[i][1] = value,
            _ => return unknown(reference),
        }
        // in co-simulation outputs are those at the end of the last step
        if self.kind == Kind::ModelExchange || !state.begun {
            state.fresh = false;
        }
        Ok(())
    }

    fn flag(&mut self, reference: u32) -> Result<&mut bool> {
        match Variable::of(reference, self.modes()) {
            Some(Variable::AtEnd) => Ok(&mut self.state.at_end),
            Some(Variable::Bent) => Ok(&mut self.state.bent),
            _ => unknown(reference),
        }
    }

    pub fn get_flag(&mut self, reference: u32) -> Result<bool> {
        self.flag(reference).map(|flag| *flag)
    }

    pub fn set_flag(&mut self, reference: u32, value: bool) -> Result<()> {
        *self.flag(reference)? = value;
        if !self.state.begun {
            self.state.fresh = false;
        }
        Ok(())
    }

    /// What unknowns change by with knowns along a seed.
    pub fn derivative(&mut self, unknowns: &[u32], knowns: &[u32], seed: &[f64]) -> Result<Vec<f64>> {
        self.update()?;
        let (jacobian, count) = (self.state.unit.jacobian(), self.modes());
        let mut way = DVector::zeros(jacobian.ncols());
        let mut rates = vec![0.0; count];
        for (known, share) in knowns.iter().zip(seed) {
            match Variable::of(*known, count) {
                // hub, its velocity, section; its velocity and the place change no force at once
                Some(Variable::Motion(i @ 0..9)) => way[i] += share,
                Some(Variable::Motion(_)) => {}
                Some(Variable::Displacement(i)) => way[9 + i] += share,
                Some(Variable::Velocity(i)) => {
                    way[9 + count + i] += share;
                    rates[i] += share;
                }
                _ => return unknown(*known),
            }
        }
        let changed = jacobian * way;
        let of = |unknown_: &u32| match Variable::of(*unknown_, count) {
            Some(Variable::Force(i @ 0..6)) => Ok(changed[i]),
            Some(Variable::Rate(i)) => Ok(rates[i]),
            Some(Variable::Acceleration(i)) => Ok(changed[6 + i]),
            _ => unknown(*unknown_),
        };
        unknowns.iter().map(of).collect()
    }
}

/// A number of a host's motion, in the order of the description.
fn motion(host: &mut Host, i: usize) -> &mut f64 {
    match i {
        0..3 => &mut host.hub.displacement[i],
        3..6 => &mut host.hub.velocity[i - 3],
        6..9 => &mut host.section.displacement[i - 6],
        9..12 => &mut host.section.velocity[i - 9],
        _ => &mut host.place,
    }
}
