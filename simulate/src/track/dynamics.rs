//! The track in time: one linear part whose interface is the rail under a wheel.

use nalgebra::SMatrix;

use crate::time::newmark::{Motion, Newmark};
use crate::time::scenario::Kelvin;
use railspring_calibrate::beam::{ChainFactor, ElementBlocks};
use railspring_profiles::error::{NumericsError, Result, StopReason};

use super::state::{Rows, TrackState, add, dot, spread};
use super::structure::{
    Bridge, Carrier, Direction, LineBeam, Matrix4, Onto, Row4, Track, bed, deflection, matrices, moment,
    rotation,
};

/// A track prepared for runs. A node has deflection and rotation of the rail (`N` = 2), and those of the bridge after them (`N` = 4).
pub struct TrackDynamics<'a, const N: usize> {
    track: &'a Track,
    pitch: f64,
    rail: Elements,
    bed: Option<(Matrix4, Kelvin)>,
    bridge: Option<Elements>,
    layers: Vec<Placed<N>>,
    /// Degrees of freedom that do not move: node and number.
    pub(super) held: Vec<(usize, usize)>,
    /// What an acceleration of the ground acts on, kg.
    weights: Vec<[f64; N]>,
}

/// The elements of a beam, all the same.
struct Elements {
    beam: LineBeam,
    /// First and last node.
    nodes: [usize; 2],
    /// Number of the first degree of freedom at a node.
    first: usize,
    stiffness: Matrix4,
    mass: Matrix4,
}

/// Layers at their place.
struct Placed<const N: usize> {
    element: usize,
    /// What they carry, and what they stand on; zeros on the ground.
    above: Rows<N>,
    under: Rows<N>,
    upper: Kelvin,
    below: Option<(f64, Kelvin)>,
    /// Whether the mass goes up and down with the ground.
    vertical: bool,
}

/// What acts at the end of a step besides the wheel, and where the wheel is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackLoad {
    /// Place of the wheel, m from the rail's first end.
    pub x: f64,
    /// Acceleration of the ground downwards, m/s².
    pub ground: f64,
}

/// What is seen of a beam at a place.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Seen {
    /// Deflection downwards against the ground, m.
    pub deflection: f64,
    /// Bending moment, N·m, positive where the lower side is in tension.
    pub moment: f64,
    /// Acceleration downwards against the ground, m/s².
    pub acceleration: f64,
}

/// Gains of displacement and velocity of the acceleration at the end of a step.
pub(super) fn gains(scheme: &Newmark) -> [f64; 2] {
    [1.0 / scheme.acceleration, scheme.velocity / scheme.acceleration]
}

/// Replaces the equation of a fixed degree of freedom by its own displacement.
pub(super) fn hold<const N: usize>(elements: &mut [ElementBlocks<N>], node: usize, dof: usize) {
    if node > 0 {
        let [_, across, second] = &mut elements[node - 1];
        across.column_mut(dof).fill(0.0);
        second.row_mut(dof).fill(0.0);
        second.column_mut(dof).fill(0.0);
        second[(dof, dof)] = 1.0;
    }
    if let Some([first, across, _]) = elements.get_mut(node) {
        across.row_mut(dof).fill(0.0);
        first.row_mut(dof).fill(0.0);
        first.column_mut(dof).fill(0.0);
        first[(dof, dof)] = 1.0;
    }
}

/// Stiffness and damping with the gains of displacement and velocity.
pub(super) fn with(kelvin: &Kelvin, [of_u, of_v]: [f64; 2]) -> f64 {
    kelvin.stiffness * of_u + kelvin.damping * of_v
}

impl Elements {
    fn new(beam: LineBeam, nodes: [usize; 2], first: usize, pitch: f64) -> Self {
        let [stiffness, mass] = matrices(&beam.section, pitch);
        Self { beam, nodes, first, stiffness, mass }
    }

    /// Adds `matrix`, of the first degree of freedom on, to an element.
    fn add_to<const N: usize>(&self, blocks: &mut ElementBlocks<N>, matrix: impl Fn(usize, usize) -> f64) {
        let at = |i: usize| (i / 2, self.first + i % 2);
        for i in 0..4 {
            for j in 0..4 {
                let ((node, row), (other, column)) = (at(i), at(j));
                match (node, other) {
                    (0, 0) => blocks[0][(row, column)] += matrix(i, j),
                    (0, 1) => blocks[1][(row, column)] += matrix(i, j),
                    (1, 1) => blocks[2][(row, column)] += matrix(i, j),
                    _ => {}
                }
            }
        }
    }

    /// Its four degrees of freedom.
    #[inline]
    fn of<const N: usize>(&self, nodes: &[[f64; N]], element: usize) -> Row4 {
        let (a, b) = (&nodes[element], &nodes[element + 1]);
        [a[self.first], a[self.first + 1], b[self.first], b[self.first + 1]]
    }
}

#[inline]
fn product(matrix: &Matrix4, vector: &Row4) -> Row4 {
    matrix.map(|row| row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2] + row[3] * vector[3])
}

impl<'a, const N: usize> TrackDynamics<'a, N> {
    /// Prepares a track; `N` is 4 for one with a bridge, else 2.
    pub fn new(track: &'a Track) -> Self {
        let pitch = track.length / track.elements as f64;
        let rail = Elements::new(track.rail, [0, track.elements], 0, pitch);
        let bridge = track
            .bridge
            .filter(|_| N == 4)
            .map(|Bridge { beam, nodes }| Elements::new(beam, nodes, 2, pitch));
        let bed = track.bed.map(|kelvin| (bed(&track.rail.section, pitch), kelvin));
        let number = |of: Carrier, direction: Direction| {
            usize::from(direction == Direction::Rotation) + if of == Carrier::Bridge { 2 } else { 0 }
        };
        let mut held: Vec<_> =
            track.held.iter().map(|held| (held.node, number(held.of, held.direction))).collect();
        if N == 4 {
            // beyond the bridge there is none
            let [from, to] = bridge.as_ref().map_or([1, 0], |bridge| bridge.nodes);
            let beyond = (0..=track.elements).filter(|node| !(from..=to).contains(node));
            held.extend(beyond.flat_map(|node| [(node, 2), (node, 3)]));
        }
        held.sort_unstable();
        held.dedup();
        let mut dynamics =
            Self { track, pitch, rail, bed, bridge, layers: Vec::new(), held, weights: Vec::new() };
        dynamics.layers = track
            .layers
            .iter()
            .map(|layers| {
                let (element, xi) = dynamics.place(layers.x);
                let row = |of: Carrier| dynamics.row(of, layers.direction, xi);
                Placed {
                    element,
                    above: row(layers.of),
                    under: if layers.onto == Onto::Bridge { row(Carrier::Bridge) } else { [[0.0; N]; 2] },
                    upper: layers.upper,
                    below: layers.below,
                    vertical: layers.direction == Direction::Vertical,
                }
            })
            .collect();
        dynamics.weights = dynamics.weights();
        dynamics
    }

    fn beams(&self) -> impl Iterator<Item = &Elements> {
        std::iter::once(&self.rail).chain(&self.bridge)
    }

    /// The element at `x` and where in it.
    pub(super) fn place(&self, x: f64) -> (usize, f64) {
        let along = x / self.pitch;
        // a place that is a node by its numbers may miss it by their rounding
        let along = if (along - along.round()).abs() < 1e-9 { along.round() } else { along };
        let element = (along.max(0.0) as usize).min(self.track.elements - 1);
        (element, (along - element as f64).clamp(0.0, 1.0))
    }

    pub(super) fn row(&self, of: Carrier, direction: Direction, xi: f64) -> Rows<N> {
        let beam = match of {
            Carrier::Rail => Some(&self.rail),
            Carrier::Bridge => self.bridge.as_ref(),
        };
        let Some(beam) = beam else { return [[0.0; N]; 2] };
        let functions = match direction {
            Direction::Vertical => deflection,
            Direction::Rotation => rotation,
        };
        spread(functions(&beam.beam.section, self.pitch, xi), beam.first)
    }

    /// Mass times the unit displacement of everything.
    fn weights(&self) -> Vec<[f64; N]> {
        let mut weights = vec![[0.0; N]; self.track.elements + 1];
        for beam in self.beams() {
            let of_element = product(&beam.mass, &[1.0, 0.0, 1.0, 0.0]);
            let rows = spread(of_element, beam.first);
            (beam.nodes[0]..beam.nodes[1]).for_each(|element| add(&rows, &mut weights, element, 1.0));
        }
        weights
    }

    /// `mass`·M with the masses of the layers, and stiffness and damping with the `gains` of displacement and velocity; the masses between layers
    /// are eliminated.
    pub(super) fn factor(&self, mass: f64, gains: [f64; 2]) -> Option<ChainFactor<N>> {
        let zero: ElementBlocks<N> = [SMatrix::zeros(); 3];
        let mut elements = vec![zero; self.track.elements];
        for beam in self.beams() {
            let LineBeam { damping, mass_damping, .. } = beam.beam;
            let of_mass = if mass > 0.0 { mass + mass_damping * gains[1] } else { 0.0 };
            let of_stiffness = gains[0] + damping * gains[1];
            for blocks in &mut elements[beam.nodes[0]..beam.nodes[1]] {
                beam.add_to(blocks, |i, j| of_mass * beam.mass[i][j] + of_stiffness * beam.stiffness[i][j]);
            }
        }
        if let Some((matrix, kelvin)) = &self.bed {
            let factor = with(kelvin, gains);
            elements.iter_mut().for_each(|blocks| self.rail.add_to(blocks, |i, j| factor * matrix[i][j]));
        }
        for placed in &self.layers {
            let [above, across, under] = placed.stiffness(mass, gains);
            let blocks = &mut elements[placed.element];
            let [a, b] = [&placed.above, &placed.under];
            for (block, (node, other)) in [(0, 0), (0, 1), (1, 1)].into_iter().enumerate() {
                for i in 0..N {
                    for j in 0..N {
                        blocks[block][(i, j)] += above * a[node][i] * a[other][j]
                            + across * (a[node][i] * b[other][j] + b[node][i] * a[other][j])
                            + under * b[node][i] * b[other][j];
                    }
                }
            }
        }
        for &(node, dof) in &self.held {
            hold(&mut elements, node, dof);
        }
        ChainFactor::of_elements(elements, [[false; N]; 2])
    }

    /// Adds what acts on the nodes in a motion without acceleration. Each mass between layers gets the force on it in the place of its acceleration.
    pub(super) fn add_forces(
        &self,
        motion: [&[[f64; N]]; 2],
        masses: &mut [Motion],
        ground: f64,
        forces: &mut [[f64; N]],
    ) {
        let [displacements, velocities] = motion;
        for beam in self.beams() {
            let LineBeam { damping, mass_damping, .. } = beam.beam;
            for element in beam.nodes[0]..beam.nodes[1] {
                let (u, v) = (beam.of(displacements, element), beam.of(velocities, element));
                let strained = std::array::from_fn(|i| u[i] + damping * v[i]);
                let mut force = product(&beam.stiffness, &strained);
                if mass_damping > 0.0 {
                    let slowed = product(&beam.mass, &v);
                    (0..4).for_each(|i| force[i] += mass_damping * slowed[i]);
                }
                let first = beam.first;
                forces[element][first] -= force[0];
                forces[element][first + 1] -= force[1];
                forces[element + 1][first] -= force[2];
                forces[element + 1][first + 1] -= force[3];
            }
        }
        if let Some((matrix, kelvin)) = &self.bed {
            for element in 0..self.track.elements {
                let (u, v) = (self.rail.of(displacements, element), self.rail.of(velocities, element));
                let strained = std::array::from_fn(|i| kelvin.stiffness * u[i] + kelvin.damping * v[i]);
                add(&spread(product(matrix, &strained), 0), forces, element, -1.0);
            }
        }
        for (placed, mass) in self.layers.iter().zip(masses) {
            let element = placed.element;
            let of = |row| [dot(row, displacements, element), dot(row, velocities, element)];
            let force = |kelvin: &Kelvin, [u, v]: [f64; 2], [below, slower]: [f64; 2]| {
                kelvin.stiffness * (u - below) + kelvin.damping * (v - slower)
            };
            let (above, under) = (of(&placed.above), of(&placed.under));
            let (on_above, on_under) = match &placed.below {
                None => {
                    let force = force(&placed.upper, above, under);
                    (force, force)
                }
                Some((own, layer)) => {
                    let between = [mass.u, mass.v];
                    let forces = (force(&placed.upper, above, between), force(layer, between, under));
                    mass.a = forces.0 - forces.1 - if placed.vertical { own * ground } else { 0.0 };
                    forces
                }
            };
            add(&placed.above, forces, element, -on_above);
            add(&placed.under, forces, element, on_under);
        }
        if ground != 0.0 {
            for (force, weight) in forces.iter_mut().zip(&self.weights) {
                (0..N).for_each(|i| force[i] -= ground * weight[i]);
            }
        }
    }

    /// Adds to the forces what comes of those on the masses between layers (in the place of their accelerations) when these are eliminated.
    pub(super) fn pass_on(&self, mass: f64, gains: [f64; 2], masses: &[Motion], forces: &mut [[f64; N]]) {
        for (placed, motion) in self.layers.iter().zip(masses) {
            if let Some((own, layer)) = &placed.below {
                let [upper, lower] = [with(&placed.upper, gains), with(layer, gains)];
                let moved = motion.a / (own * mass + upper + lower);
                add(&placed.above, forces, placed.element, upper * moved);
                add(&placed.under, forces, placed.element, lower * moved);
            }
        }
    }

    /// What a mass between layers does with the `solution` of the nodes.
    pub(super) fn settle(&self, mass: f64, gains: [f64; 2], masses: &mut [Motion], solution: &[[f64; N]]) {
        for (placed, motion) in self.layers.iter().zip(masses) {
            if let Some((own, layer)) = &placed.below {
                let [upper, lower] = [with(&placed.upper, gains), with(layer, gains)];
                let pulled = upper * dot(&placed.above, solution, placed.element)
                    + lower * dot(&placed.under, solution, placed.element);
                let all = own * mass + upper + lower;
                motion.a = if all == 0.0 { 0.0 } else { (motion.a + pulled) / all };
            }
        }
    }

    pub(super) fn clear_held(&self, forces: &mut [[f64; N]]) {
        self.held.iter().for_each(|&(node, dof)| forces[node][dof] = 0.0);
    }

    fn rest(&self) -> TrackState<N> {
        let nodes = vec![[0.0; N]; self.track.elements + 1];
        TrackState {
            displacements: nodes.clone(),
            velocities: nodes.clone(),
            accelerations: nodes,
            masses: vec![Motion::default(); self.layers.len()],
        }
    }

    pub(super) fn failure(&self) -> NumericsError {
        NumericsError::new("track", StopReason::Singular, f64::NAN, N * (self.track.elements + 1))
    }

    /// The track at rest under a `force` (N) down at `x`; none if nothing holds it there.
    pub fn at_rest(&self, x: f64, force: f64) -> Option<TrackState<N>> {
        let mut state = self.rest();
        if force == 0.0 {
            return Some(state);
        }
        if !self.track.is_held() {
            return None;
        }
        let factor = self.factor(0.0, [1.0, 0.0])?;
        let (element, xi) = self.place(x);
        add(&self.row(Carrier::Rail, Direction::Vertical, xi), &mut state.displacements, element, force);
        self.clear_held(&mut state.displacements);
        let meeting = factor.meeting(element);
        factor.forward(&meeting, &mut state.displacements);
        factor.backward(&meeting, &mut state.displacements);
        let TrackState { displacements, masses, .. } = &mut state;
        self.settle(0.0, [1.0, 0.0], masses, displacements);
        masses.iter_mut().for_each(|mass| *mass = Motion { u: mass.a, ..Motion::default() });
        Some(state)
    }

    /// Gives a state the accelerations of its displacements and velocities under a load and the `force` (N) of the wheel.
    ///
    /// # Errors
    /// A track without inertia.
    pub fn accelerate(&self, state: &mut TrackState<N>, load: &TrackLoad, force: f64) -> Result<()> {
        let factor = self.factor(1.0, [0.0; 2]).ok_or_else(|| self.failure())?;
        let TrackState { displacements, velocities, accelerations, masses } = state;
        accelerations.iter_mut().for_each(|node| *node = [0.0; N]);
        self.add_forces([displacements, velocities], masses, load.ground, accelerations);
        let (element, xi) = self.place(load.x);
        add(&self.row(Carrier::Rail, Direction::Vertical, xi), accelerations, element, force);
        self.clear_held(accelerations);
        let meeting = factor.meeting(element);
        factor.forward(&meeting, accelerations);
        factor.backward(&meeting, accelerations);
        self.settle(1.0, [0.0; 2], masses, accelerations);
        Ok(())
    }

    /// Deflection (m) of the rail at `x` (m).
    pub fn deflection(&self, state: &TrackState<N>, x: f64) -> f64 {
        let (element, xi) = self.place(x);
        dot(&self.row(Carrier::Rail, Direction::Vertical, xi), &state.displacements, element)
    }

    /// What a beam does at `at` (m), with a `force` (N) of the wheel at `x` (m) on the rail. In the element of the wheel its moment is that of a beam clamped at the
    /// nodes with it, besides.
    pub fn seen(&self, state: &TrackState<N>, of: Carrier, at: f64, (x, force): (f64, f64)) -> Seen {
        let (element, xi) = self.place(at);
        let row = self.row(of, Direction::Vertical, xi);
        let beam = match of {
            Carrier::Rail => Some(&self.rail),
            Carrier::Bridge => self.bridge.as_ref(),
        };
        let Some(beam) = beam else { return Seen::default() };
        let section = &beam.beam.section;
        let bending: Rows<N> = spread(moment(section, self.pitch, xi), beam.first);
        let (loaded, under) = self.place(x);
        let clamped = if of == Carrier::Rail && loaded == element {
            let [share, turning, ..] = deflection(section, self.pitch, under);
            // the row of a rotation has the opposite sign of the slope's
            let beyond = (xi - under).max(0.0) * self.pitch;
            force * (turning + share * xi * self.pitch - beyond)
        } else {
            0.0
        };
        Seen {
            deflection: dot(&row, &state.displacements, element),
            moment: dot(&bending, &state.displacements, element) + clamped,
            acceleration: dot(&row, &state.accelerations, element),
        }
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        let masses = self.layers.iter().filter(|placed| placed.below.is_some()).count();
        N * (self.track.elements + 1) - self.held.len() + masses
    }

    /// Whether all numbers of a state are finite.
    pub fn is_finite(&self, state: &TrackState<N>) -> bool {
        // an acceleration that is none makes the others such in the next step
        state.accelerations.as_flattened().iter().all(|value| value.is_finite())
            && state.displacements.as_flattened().iter().all(|value| value.is_finite())
    }
}

impl<const N: usize> Placed<N> {
    /// Against accelerations above, above and under, and under.
    fn stiffness(&self, mass: f64, gains: [f64; 2]) -> [f64; 3] {
        let upper = with(&self.upper, gains);
        match &self.below {
            None => [upper, -upper, upper],
            Some((own, layer)) => {
                let lower = with(layer, gains);
                let all = own * mass + upper + lower;
                if all == 0.0 {
                    // dampers alone hold nothing that rests
                    return [0.0; 3];
                }
                [upper - upper * upper / all, -upper * lower / all, lower - lower * lower / all]
            }
        }
    }
}
