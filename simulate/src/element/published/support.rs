//! What carries the rail nodes: a beam, or rigid ground.

use std::cell::RefCell;
use std::rc::Rc;

use faer::MatRef;
use nalgebra::{Matrix3, Point2, Vector3};

use crate::time::energy::PartEnergy;
use crate::time::linear_part::{LinearPart, LinearStep};
use crate::time::newmark::{Motion, Newmark};
use crate::time::scenario::Scenario;
use railspring_calibrate::beam::{ChainFactor, Meeting, NODE, Node, RailBeam, SectionRows};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::field::InputField;
use railspring_profiles::placement::PlacedRail;

/// What carries the rail.
#[derive(Debug, Clone)]
#[expect(clippy::large_enum_variant, reason = "a model has one")]
pub enum RailSupport {
    /// The rail does not move.
    Rigid,
    /// The rail is a beam, whose node line passes the world point (y, z).
    Beam {
        /// The beam.
        beam: RailBeam,
        /// Where its node line (the shear centres) passes the plane of the profile, m.
        node_line: Point2<f64>,
        /// Damping proportional to stiffness, s, as [`railspring_calibrate::solid::Material::damping`].
        damping: f64,
    },
}

impl RailSupport {
    /// World point (y, z) about which a section of the rail moves: the beam's node line, or the origin of a rigid rail's profile.
    pub(crate) fn reference(&self, rail: &PlacedRail) -> Point2<f64> {
        match self {
            Self::Rigid => rail.origin,
            Self::Beam { node_line, .. } => *node_line,
        }
    }

    /// The beam, if the rail is one.
    pub(crate) fn beam(&self) -> Option<&RailBeam> {
        match self {
            Self::Rigid => None,
            Self::Beam { beam, .. } => Some(beam),
        }
    }

    /// The beam prepared for a run.
    pub(crate) fn dynamics(&self) -> Option<RailDynamics<'_>> {
        match self {
            Self::Rigid => None,
            Self::Beam { beam, damping, .. } => Some(RailDynamics::new(beam, *damping)),
        }
    }

    /// Whether the wheel starts on the rail.
    pub(crate) fn check_start(&self, scenario: &Scenario) -> Result<()> {
        let Some(beam) = self.beam() else { return Ok(()) };
        let from = scenario.start_x.unwrap_or(0.5 * beam.length());
        if !scenario.speed.is_finite() {
            let remedy = "correct the value";
            return InputError::refuse(InputField::Speed, scenario.speed, "a finite speed", remedy);
        }
        if (0.0..=beam.length()).contains(&from) {
            return Ok(());
        }
        InputError::refuse(
            InputField::StartX,
            format!("{from} m"),
            format!("a place on the rail, 0 to {} m", beam.length()),
            "start elsewhere, or take a longer rail",
        )
    }
}

/// Motion of the nodes of the rail, and the section under the wheel.
#[derive(Debug, Clone, Default)]
pub(crate) struct RailState {
    displacements: Vec<Node>,
    velocities: Vec<Node>,
    accelerations: Vec<Node>,
    under: WheelSection,
}

/// The section under the wheel with rows of its motion in directions 1, 2 and rotation 3: y, −z and −(rotation about x).
#[derive(Debug, Clone, Copy, Default)]
struct WheelSection {
    /// Where it is, m from the first end.
    x: f64,
    section: SectionRows,
}

impl WheelSection {
    /// Its motion with the displacements of the nodes.
    fn moved(&self, displacements: &[Node]) -> [f64; 3] {
        let SectionRows { element, rows } = &self.section;
        rows.map(|row| dot_both(&row, &[displacements[*element], displacements[element + 1]]))
    }
}

impl RailState {
    fn resize(&mut self, nodes: usize) {
        for values in [&mut self.displacements, &mut self.velocities, &mut self.accelerations] {
            values.resize(nodes, [0.0; NODE]);
        }
    }

    fn motion(&self, node: usize, i: usize) -> Motion {
        Motion { u: self.displacements[node][i], v: self.velocities[node][i], a: self.accelerations[node][i] }
    }
}

/// The rail prepared for a run.
pub(crate) struct RailDynamics<'a> {
    beam: &'a RailBeam,
    damping: f64,
    /// The middle, where a torsion acts.
    middle: SectionRows,
    /// What was prepared for the steps that were asked for.
    prepared: RefCell<Vec<Rc<Prepared>>>,
}

/// What steps of one length need.
struct Prepared {
    scheme: Newmark,
    /// The equations of the accelerations at the end of a step.
    factor: ChainFactor,
    /// The place of the last step.
    place: RefCell<Rc<Place>>,
}

/// What acts on the rail besides the contact, and where the contact is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RailLoad {
    /// Position of the wheel, m from the first end.
    pub x: f64,
    /// Torsion about x at the middle, N·m.
    pub torsion: f64,
}

/// The rail over steps of one length. Its interface is the section at the wheel in directions 1, 2 and rotation 3.
pub(crate) struct Rail<'a> {
    dynamics: &'a RailDynamics<'a>,
    prepared: Rc<Prepared>,
}

/// A place of the wheel, with what a step there needs of the rail.
#[derive(Debug, Clone)]
struct Place {
    under: WheelSection,
    meeting: Meeting,
    /// Rows of the section at the wheel, eliminated.
    rows: [[Node; 2]; 3],
    /// By columns.
    flexibility: [f64; 9],
}

/// A step of the rail.
pub(crate) struct RailStep<'s> {
    rail: &'s Rail<'s>,
    /// Displacements and velocities without acceleration at the end of the step; its accelerations are the right-hand side without
    /// contact, eliminated towards the wheel.
    next: &'s mut RailState,
    place: Rc<Place>,
    free: [f64; 3],
}

impl<'a> RailDynamics<'a> {
    pub fn new(beam: &'a RailBeam, damping: f64) -> Self {
        let middle = beam.section_rows(0.5 * beam.length());
        Self { beam, damping, middle, prepared: RefCell::default() }
    }

    /// The section under a wheel at `x`, m from the first end.
    fn section(&self, x: f64) -> WheelSection {
        let SectionRows { element, rows: [y, z, rx] } = self.beam.section_rows(x);
        let negative = |row: [Node; 2]| row.map(|node| node.map(|value| -value));
        WheelSection { x, section: SectionRows { element, rows: [y, negative(z), negative(rx)] } }
    }

    /// Adds the torsion (N·m) at the middle.
    fn add_torsion(&self, torsion: f64, forces: &mut [Node]) {
        let SectionRows { element, rows: [.., twist] } = &self.middle;
        for (force, row) in forces[*element..].iter_mut().zip(twist) {
            add(force, torsion, row);
        }
    }

    /// The rail at rest, with its acceleration under `load` and a contact force (directions 1, 2 and moment 3).
    ///
    /// # Errors
    /// A beam without inertia.
    pub fn start(&self, load: &RailLoad, contact: Vector3<f64>) -> Result<RailState> {
        let mut state = RailState::default();
        state.resize(self.beam.elements() + 1);
        state.under = self.section(load.x);
        let SectionRows { element, rows } = state.under.section;
        self.add_torsion(load.torsion, &mut state.accelerations);
        for (row, force) in rows.iter().zip(&contact) {
            (0..2).for_each(|node| add(&mut state.accelerations[element + node], *force, &row[node]));
        }
        let factor = self.beam.factor(1.0, 0.0)?;
        let meeting = factor.meeting(element);
        factor.forward(&meeting, &mut state.accelerations);
        factor.backward(&meeting, &mut state.accelerations);
        Ok(state)
    }

    /// Energies after a step of `step` s from `before` to `after` with the mean `torsion` (N·m) over it, and the works in it, J.
    pub fn energy(&self, before: &RailState, after: &RailState, torsion: f64, step: f64) -> PartEnergy {
        self.stored(after) + self.worked(before, after, torsion, step)
    }

    /// Energies of a state, J.
    pub fn stored(&self, state: &RailState) -> PartEnergy {
        PartEnergy {
            kinetic: self.beam.kinetic_energy(&state.velocities),
            elastic: self.beam.elastic_energy(|node| state.displacements[node]),
            ..PartEnergy::default()
        }
    }

    /// Works in a step of `step` s from `before` to `after`, J: of the mean `torsion` (N·m) over it, and what damping took.
    pub fn worked(&self, before: &RailState, after: &RailState, torsion: f64, step: f64) -> PartEnergy {
        let moved = |node: usize| {
            let (before, after) = (&before.displacements[node], &after.displacements[node]);
            std::array::from_fn(|i| after[i] - before[i])
        };
        let SectionRows { element, rows: [.., twist] } = &self.middle;
        let turned: f64 = (0..2).map(|node| dot(&twist[node], &moved(element + node))).sum();
        let damped = match self.damping > 0.0 {
            true => 2.0 * self.damping * self.beam.elastic_energy(moved) / step,
            false => 0.0,
        };
        PartEnergy { work: torsion * turned, damped, ..PartEnergy::default() }
    }

    /// Work of the forces that move the contact along the rail in a step from `before` to `after`, J. Forces
    /// have directions 1, 2 and moment 3, and are given at both ends of the step. The work is that on the
    /// nodes, less that on the surface under the wheel, which comes down as the wheel rolls down a slope. The
    /// surface has `shares` of the motion of its section.
    pub fn driven(
        &self,
        [before, after]: [&RailState; 2],
        shares: [Matrix3<f64>; 2],
        forces: [Vector3<f64>; 2],
    ) -> f64 {
        let under = [&before.under, &after.under];
        if under[0].x == under[1].x {
            return 0.0;
        }
        let moved = |side: usize, state: &RailState| {
            shares[side] * Vector3::from(under[side].moved(&state.displacements))
        };
        let (was, is) = (moved(0, before), moved(1, after));
        let work = |side: usize| {
            let of_nodes = moved(side, after) - moved(side, before);
            0.5 * forces[side].dot(&(of_nodes - (is - was)))
        };
        work(0) + work(1)
    }

    /// The rail over steps of `scheme`.
    ///
    /// # Errors
    /// A beam whose equations have no solution.
    pub fn over(&self, scheme: &Newmark) -> Result<Rail<'_>> {
        let mut all = self.prepared.borrow_mut();
        let known = all.iter().find(|known| known.scheme == *scheme).cloned();
        let prepared = match known {
            Some(prepared) => prepared,
            None => {
                let stiffness = (1.0 + self.damping * scheme.velocity) / scheme.acceleration;
                let factor = self.beam.factor(1.0, stiffness)?;
                let place = RefCell::new(Rc::new(Place::new(self.section(0.0), &factor, scheme)));
                let prepared = Rc::new(Prepared { scheme: *scheme, factor, place });
                all.push(prepared.clone());
                prepared
            }
        };
        Ok(Rail { dynamics: self, prepared })
    }
}

impl Place {
    fn new(under: WheelSection, factor: &ChainFactor, scheme: &Newmark) -> Self {
        let SectionRows { element, rows } = &under.section;
        let meeting = factor.meeting(*element);
        let rows = rows.map(|row| meeting.eliminated(&row));
        let over = rows.map(|row| meeting.over(&row));
        let gain = 1.0 / scheme.acceleration;
        let flexibility = std::array::from_fn(|k| gain * dot_both(&rows[k % 3], &over[k / 3]));
        Self { under, meeting, rows, flexibility }
    }
}

impl Rail<'_> {
    /// The rail with the wheel at `x`, m from the first end.
    fn place(&self, x: f64) -> Rc<Place> {
        let Prepared { scheme, factor, place } = &*self.prepared;
        let mut last = place.borrow_mut();
        if last.under.x != x {
            let place = Place::new(self.dynamics.section(x), factor, scheme);
            match Rc::get_mut(&mut last) {
                Some(last) => *last = place,
                None => *last = Rc::new(place),
            }
        }
        last.clone()
    }
}

impl LinearPart for Rail<'_> {
    type State = RailState;
    type Load = RailLoad;
    type Step<'s>
        = RailStep<'s>
    where
        Self: 's;

    fn predict<'s>(&'s self, state: &'s RailState, load: &RailLoad, next: &'s mut RailState) -> RailStep<'s> {
        let (dynamics, Prepared { scheme, factor, .. }) = (self.dynamics, &*self.prepared);
        let nodes = state.displacements.len();
        next.resize(nodes);
        for node in 0..nodes {
            for i in 0..NODE {
                let [u, v] = scheme.predicted(&state.motion(node, i));
                (next.displacements[node][i], next.velocities[node][i]) = (u, v);
            }
        }
        let RailState { displacements, velocities, accelerations, .. } = &mut *next;
        accelerations.fill([0.0; NODE]);
        let strained = |node: usize| {
            let (u, v) = (&displacements[node], &velocities[node]);
            std::array::from_fn(|i| u[i] + dynamics.damping * v[i])
        };
        dynamics.beam.add_elastic_forces(strained, accelerations);
        dynamics.add_torsion(load.torsion, accelerations);

        let place = self.place(load.x);
        let Place { under, meeting, rows, .. } = &*place;
        factor.forward(meeting, accelerations);
        let element = meeting.element();
        let over = meeting.over(&[accelerations[element], accelerations[element + 1]]);
        let (predicted, gain) = (under.moved(displacements), 1.0 / scheme.acceleration);
        let free = [0, 1, 2].map(|i| predicted[i] + gain * dot_both(&rows[i], &over));
        next.under = *under;
        RailStep { rail: self, next, place, free }
    }
}

impl LinearStep for RailStep<'_> {
    fn free(&self) -> &[f64] {
        &self.free
    }

    fn flexibility(&self) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.place.flexibility, 3, 3)
    }

    fn finish(self, forces: &[f64]) {
        let Prepared { scheme, factor, .. } = &*self.rail.prepared;
        let RailState { displacements, velocities, accelerations, .. } = self.next;
        let Place { meeting, rows, .. } = &*self.place;
        let element = meeting.element();
        for (row, &force) in rows.iter().zip(forces) {
            (0..2).for_each(|node| add(&mut accelerations[element + node], force, &row[node]));
        }
        factor.backward(meeting, accelerations);
        let (of_u, of_v) = (1.0 / scheme.acceleration, scheme.velocity / scheme.acceleration);
        let motions = displacements.as_flattened_mut().iter_mut().zip(velocities.as_flattened_mut());
        for ((u, v), a) in motions.zip(accelerations.as_flattened()) {
            *u += of_u * a;
            *v += of_v * a;
        }
    }
}

fn dot(a: &Node, b: &Node) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn dot_both(a: &[Node; 2], b: &[Node; 2]) -> f64 {
    dot(&a[0], &b[0]) + dot(&a[1], &b[1])
}

fn add(to: &mut Node, factor: f64, row: &Node) {
    to.iter_mut().zip(row).for_each(|(to, row)| *to += factor * row);
}

#[cfg(test)]
mod crossing;
#[cfg(test)]
mod tests;
