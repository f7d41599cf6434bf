//! Two chains alike side by side, such as both rails of a track in one plane.
//!
//! Every number stands for both, the right one's, then the left one's: the processor works on both at once, and the mirror image of a step has the same numbers exchanged.

use crate::time::newmark::{Motion, Newmark};
use crate::time::scenario::Kelvin;
use railspring_calibrate::beam::{ChainFactor, ElementBlocks, Entry, Meeting, product};

use super::dynamics::{gains, hold, with};
use super::state::Rows;

/// Numbers of both rails: the right one's, then the left one's.
pub(super) type Both = [f64; 2];

/// Motion of both rails in one plane.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct PlaneState<const N: usize> {
    pub displacements: Vec<[Both; N]>,
    pub velocities: Vec<[Both; N]>,
    pub accelerations: Vec<[Both; N]>,
    /// Displacement, velocity and acceleration of the masses between layers; at rest where there is none.
    pub masses: Vec<[Both; 3]>,
}

/// Where a support holds a chain, and how.
pub(super) struct Seat<const N: usize> {
    pub element: usize,
    pub row: Rows<N>,
    pub upper: Kelvin,
    pub below: Option<(f64, Kelvin)>,
    /// Whether the mass moves with the ground.
    pub weighs: bool,
}

/// What deforms an element, which is free of its motion as a rigid body: bending with constant and with linear moment, and twist.
#[derive(Debug, Clone, Copy)]
pub(super) struct Deforming {
    /// 2/length with the sign of the rotation that tilts the axis to positive deflections, 1/m.
    pub slope: f64,
    /// Stiffness, N·m.
    pub bending: f64,
    pub shearing: f64,
    pub twisting: f64,
}

impl Deforming {
    /// Forces with which the displacements of the nodes are resisted: deflection, rotation and, where there is a third coordinate, twist.
    #[inline]
    fn resisted<const N: usize>(&self, first: &[Both; N], second: &[Both; N]) -> [[Both; N]; 2] {
        let mut forces = [[Both::ZERO; N]; 2];
        for side in 0..2 {
            let (turn, other) = (first[1][side], second[1][side]);
            let bend = self.bending * (other - turn);
            let shear = self.shearing * (turn + other - self.slope * (second[0][side] - first[0][side]));
            let across = self.slope * shear;
            forces[0][0][side] = across;
            forces[1][0][side] = -across;
            forces[0][1][side] = shear - bend;
            forces[1][1][side] = shear + bend;
            if N > 2 {
                let twist = self.twisting * (second[2][side] - first[2][side]);
                forces[0][2][side] = -twist;
                forces[1][2][side] = twist;
            }
        }
        forces
    }
}

/// One plane of a rail.
pub(super) struct Plane<const N: usize> {
    pub elements: usize,
    pub stiffness: ElementBlocks<N>,
    pub mass: ElementBlocks<N>,
    pub deforming: Deforming,
    pub damping: f64,
    pub mass_damping: f64,
    pub beds: Vec<(ElementBlocks<N>, Kelvin)>,
    pub seats: Vec<Seat<N>>,
    pub held: Vec<(usize, usize)>,
    /// What an acceleration of the ground acts on, kg.
    pub weights: Vec<[f64; N]>,
}

#[inline]
pub(super) fn dot<const N: usize>(row: &Rows<N>, nodes: &[[Both; N]], element: usize) -> Both {
    let mut sum = Both::ZERO;
    for (row, node) in row.iter().zip(&nodes[element..element + 2]) {
        row.iter().zip(node).for_each(|(factor, value)| sum.add(*factor, value));
    }
    sum
}

#[inline]
fn spread<const N: usize>(row: &Rows<N>, nodes: &mut [[Both; N]], element: usize, force: &Both) {
    for (row, node) in row.iter().zip(&mut nodes[element..element + 2]) {
        row.iter().zip(node).for_each(|(factor, value)| value.add(*factor, force));
    }
}

#[inline]
fn times(both: Both, factor: f64) -> Both {
    both.map(|value| factor * value)
}

impl<const N: usize> Plane<N> {
    /// Coordinates that do not move, out of a row.
    fn free_rows(&self, row: &Rows<N>, element: usize) -> Rows<N> {
        let mut row = *row;
        for (node, dofs) in row.iter_mut().enumerate() {
            for (dof, value) in dofs.iter_mut().enumerate() {
                if self.held.binary_search(&(element + node, dof)).is_ok() {
                    *value = 0.0;
                }
            }
        }
        row
    }

    /// `mass`·M, and stiffness and damping with the `gains` of displacement and velocity; the masses between layers are eliminated.
    pub fn factor(&self, mass: f64, gains: [f64; 2]) -> Option<ChainFactor<N>> {
        let of_mass = if mass > 0.0 { mass + self.mass_damping * gains[1] } else { 0.0 };
        let of_stiffness = gains[0] + self.damping * gains[1];
        let mut one: ElementBlocks<N> =
            std::array::from_fn(|i| self.mass[i] * of_mass + self.stiffness[i] * of_stiffness);
        for (matrix, kelvin) in &self.beds {
            (0..3).for_each(|i| one[i] += matrix[i] * with(kelvin, gains));
        }
        let mut elements = vec![one; self.elements];
        for seat in &self.seats {
            let stiffness = seat.stiffness(mass, gains);
            for (block, (node, other)) in [(0, 0), (0, 1), (1, 1)].into_iter().enumerate() {
                for i in 0..N {
                    for j in 0..N {
                        elements[seat.element][block][(i, j)] +=
                            stiffness * seat.row[node][i] * seat.row[other][j];
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
    fn add_forces(&self, state: &mut PlaneState<N>, ground: &Both) {
        let PlaneState { displacements, velocities, accelerations, masses } = state;
        let strained = |node: usize| -> [Both; N] {
            let (u, v) = (&displacements[node], &velocities[node]);
            std::array::from_fn(|i| [0, 1].map(|side| u[i][side] + self.damping * v[i][side]))
        };
        let mut here = strained(0);
        for element in 0..self.elements {
            let there = strained(element + 1);
            let [on_first, on_second] = self.deforming.resisted(&here, &there);
            for i in 0..N {
                accelerations[element][i].subtract(&on_first[i]);
                accelerations[element + 1][i].subtract(&on_second[i]);
            }
            here = there;
        }
        if self.mass_damping > 0.0 {
            let slowing = Kelvin { stiffness: 0.0, damping: self.mass_damping };
            self.resist(&self.mass, &slowing, displacements, velocities, accelerations);
        }
        for (matrix, kelvin) in &self.beds {
            self.resist(matrix, kelvin, displacements, velocities, accelerations);
        }
        for (seat, mass) in self.seats.iter().zip(masses) {
            let (u, v) =
                (dot(&seat.row, displacements, seat.element), dot(&seat.row, velocities, seat.element));
            let force = |kelvin: &Kelvin, u: Both, v: Both| {
                [0, 1].map(|side| kelvin.stiffness * u[side] + kelvin.damping * v[side])
            };
            let on_rail = match &seat.below {
                None => force(&seat.upper, u, v),
                Some((own, layer)) => {
                    let [below, slower, resulting] = mass;
                    let apart = [0, 1].map(|side| u[side] - below[side]);
                    let faster = [0, 1].map(|side| v[side] - slower[side]);
                    let above = force(&seat.upper, apart, faster);
                    let under = force(layer, *below, *slower);
                    let weight = if seat.weighs { *own } else { 0.0 };
                    *resulting = [0, 1].map(|side| above[side] - under[side] - weight * ground[side]);
                    above
                }
            };
            spread(&seat.row, accelerations, seat.element, &times(on_rail, -1.0));
        }
        if *ground != Both::ZERO {
            for (force, weight) in accelerations.iter_mut().zip(&self.weights) {
                (0..N).for_each(|i| force[i].add(-weight[i], ground));
            }
        }
    }

    fn resist(
        &self,
        matrix: &ElementBlocks<N>,
        kelvin: &Kelvin,
        displacements: &[[Both; N]],
        velocities: &[[Both; N]],
        forces: &mut [[Both; N]],
    ) {
        let strained = |node: usize| -> [Both; N] {
            let (u, v) = (&displacements[node], &velocities[node]);
            std::array::from_fn(|i| {
                [0, 1].map(|side| kelvin.stiffness * u[i][side] + kelvin.damping * v[i][side])
            })
        };
        let [first, across, second] = matrix;
        let back = across.transpose();
        for element in 0..self.elements {
            let (here, there) = (strained(element), strained(element + 1));
            let (a, b): ([Both; N], [Both; N]) = (product(first, &here), product(across, &there));
            let (c, d): ([Both; N], [Both; N]) = (product(&back, &here), product(second, &there));
            for i in 0..N {
                forces[element][i].add(-1.0, &a[i]);
                forces[element][i].add(-1.0, &b[i]);
                forces[element + 1][i].add(-1.0, &c[i]);
                forces[element + 1][i].add(-1.0, &d[i]);
            }
        }
    }

    /// Adds to the forces what comes of those on the masses between layers when these are eliminated.
    fn pass_on(&self, mass: f64, gains: [f64; 2], masses: &[[Both; 3]], forces: &mut [[Both; N]]) {
        for (seat, motion) in self.seats.iter().zip(masses) {
            if let Some((own, layer)) = &seat.below {
                let [upper, lower] = [with(&seat.upper, gains), with(layer, gains)];
                let share = upper / (own * mass + upper + lower);
                spread(&seat.row, forces, seat.element, &times(motion[2], share));
            }
        }
    }

    /// What a mass between layers does with the `solution` of the nodes.
    fn settle(&self, mass: f64, gains: [f64; 2], masses: &mut [[Both; 3]], solution: &[[Both; N]]) {
        for (seat, motion) in self.seats.iter().zip(masses) {
            if let Some((own, layer)) = &seat.below {
                let [upper, lower] = [with(&seat.upper, gains), with(layer, gains)];
                let all = own * mass + upper + lower;
                let moved = dot(&seat.row, solution, seat.element);
                motion[2] = [0, 1].map(|side| match all == 0.0 {
                    true => 0.0,
                    false => (motion[2][side] + upper * moved[side]) / all,
                });
            }
        }
    }

    fn clear_held(&self, forces: &mut [[Both; N]]) {
        self.held.iter().for_each(|&(node, dof)| forces[node][dof] = Both::ZERO);
    }

    pub fn rest(&self) -> PlaneState<N> {
        let nodes = vec![[Both::ZERO; N]; self.elements + 1];
        PlaneState {
            displacements: nodes.clone(),
            velocities: nodes.clone(),
            accelerations: nodes,
            masses: vec![[Both::ZERO; 3]; self.seats.len()],
        }
    }

    /// Displacements under forces along `rows` of an element; none if nothing holds the plane.
    pub fn at_rest<const I: usize>(
        &self,
        (element, rows): (usize, [Rows<N>; I]),
        forces: [Both; I],
        twisting: &[(usize, Rows<N>, Both)],
    ) -> Option<PlaneState<N>> {
        const STATIC: [f64; 2] = [1.0, 0.0];
        let mut state = self.rest();
        let factor = self.factor(0.0, STATIC)?;
        for (row, force) in rows.iter().zip(&forces) {
            spread(row, &mut state.displacements, element, force);
        }
        for (element, row, moment) in twisting {
            spread(row, &mut state.displacements, *element, moment);
        }
        self.clear_held(&mut state.displacements);
        let meeting = factor.meeting(element);
        factor.forward(&meeting, &mut state.displacements);
        factor.backward(&meeting, &mut state.displacements);
        let PlaneState { displacements, masses, .. } = &mut state;
        self.settle(0.0, STATIC, masses, displacements);
        masses.iter_mut().for_each(|mass| *mass = [mass[2], Both::ZERO, Both::ZERO]);
        Some(state)
    }

    /// Gives a state its accelerations under the ground's and `forces` along `rows` of an element.
    pub fn accelerate<const I: usize>(
        &self,
        state: &mut PlaneState<N>,
        ground: &Both,
        (element, rows): (usize, [Rows<N>; I]),
        forces: [Both; I],
        twisting: &[(usize, Rows<N>, Both)],
    ) -> Option<()> {
        let factor = self.factor(1.0, [0.0; 2])?;
        state.accelerations.iter_mut().for_each(|node| *node = [Both::ZERO; N]);
        self.add_forces(state, ground);
        for (row, force) in rows.iter().zip(&forces) {
            spread(row, &mut state.accelerations, element, force);
        }
        for (element, row, moment) in twisting {
            spread(row, &mut state.accelerations, *element, moment);
        }
        let PlaneState { accelerations, masses, .. } = state;
        self.clear_held(accelerations);
        let meeting = factor.meeting(element);
        factor.forward(&meeting, accelerations);
        factor.backward(&meeting, accelerations);
        self.settle(1.0, [0.0; 2], masses, accelerations);
        Some(())
    }
}

impl<const N: usize> Seat<N> {
    fn stiffness(&self, mass: f64, gains: [f64; 2]) -> f64 {
        let upper = with(&self.upper, gains);
        let Some((own, layer)) = &self.below else { return upper };
        let all = own * mass + upper + with(layer, gains);
        if all == 0.0 { 0.0 } else { upper - upper * upper / all }
    }
}

/// A plane over steps of one length.
pub(super) struct PlaneSteps<const N: usize> {
    pub scheme: Newmark,
    pub factor: ChainFactor<N>,
}

/// A step of a plane with `I` coordinates at the wheel.
pub(super) struct PlaneStep<const N: usize, const I: usize> {
    pub meeting: Meeting<N>,
    rows: [Rows<N>; I],
    pub free: [Both; I],
    pub flexibility: [[f64; I]; I],
}

impl<const N: usize> PlaneSteps<N> {
    pub fn predict<const I: usize>(
        &self,
        plane: &Plane<N>,
        state: &PlaneState<N>,
        next: &mut PlaneState<N>,
        ground: &Both,
        (element, rows): (usize, [Rows<N>; I]),
        twisting: &[(usize, Rows<N>, Both)],
    ) -> PlaneStep<N, I> {
        let gains = gains(&self.scheme);
        next.displacements.resize(state.displacements.len(), [Both::ZERO; N]);
        next.velocities.resize(state.velocities.len(), [Both::ZERO; N]);
        next.accelerations.resize(state.accelerations.len(), [Both::ZERO; N]);
        next.masses.resize(state.masses.len(), [Both::ZERO; 3]);
        let moved = next.displacements.as_flattened_mut().iter_mut().zip(next.velocities.as_flattened_mut());
        let before = state.displacements.as_flattened().iter().zip(state.velocities.as_flattened());
        for (((u, v), (u0, v0)), a0) in moved.zip(before).zip(state.accelerations.as_flattened()) {
            for side in 0..2 {
                let motion = Motion { u: u0[side], v: v0[side], a: a0[side] };
                [u[side], v[side]] = self.scheme.predicted(&motion);
            }
        }
        for (mass, [u, v, a]) in next.masses.iter_mut().zip(&state.masses) {
            let [right, left] =
                [0, 1].map(|side| self.scheme.predicted(&Motion { u: u[side], v: v[side], a: a[side] }));
            *mass = [[right[0], left[0]], [right[1], left[1]], Both::ZERO];
        }
        next.accelerations.fill([Both::ZERO; N]);
        plane.add_forces(next, ground);
        for (element, row, moment) in twisting {
            spread(row, &mut next.accelerations, *element, moment);
        }
        plane.pass_on(1.0, gains, &next.masses, &mut next.accelerations);
        plane.clear_held(&mut next.accelerations);
        let meeting = self.factor.meeting(element);
        self.factor.forward(&meeting, &mut next.accelerations);
        let rows = rows.map(|row| plane.free_rows(&row, element));
        let eliminated = rows.map(|row| meeting.eliminated(&row));
        let over = meeting.over(&[next.accelerations[element], next.accelerations[element + 1]]);
        let free = std::array::from_fn(|i| {
            let mut sum = dot(&rows[i], &next.displacements, element);
            let gained = dot(&eliminated[i], &over, 0);
            sum.add(gains[0], &gained);
            sum
        });
        let scaled = eliminated.map(|row| meeting.over(&row));
        let flexibility = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let one =
                    |node: usize| (0..N).map(|k| eliminated[i][node][k] * scaled[j][node][k]).sum::<f64>();
                gains[0] * (one(0) + one(1))
            })
        });
        PlaneStep { meeting, rows: eliminated, free, flexibility }
    }

    pub fn finish<const I: usize>(
        &self,
        plane: &Plane<N>,
        step: &PlaneStep<N, I>,
        next: &mut PlaneState<N>,
        forces: [Both; I],
    ) {
        let gains = gains(&self.scheme);
        let PlaneState { displacements, velocities, accelerations, masses } = next;
        for (row, force) in step.rows.iter().zip(&forces) {
            spread(row, accelerations, step.meeting.element(), force);
        }
        self.factor.backward(&step.meeting, accelerations);
        plane.settle(1.0, gains, masses, accelerations);
        let moved = displacements.as_flattened_mut().iter_mut().zip(velocities.as_flattened_mut());
        for ((u, v), a) in moved.zip(accelerations.as_flattened()) {
            u.add(gains[0], a);
            v.add(gains[1], a);
        }
        for [u, v, a] in masses {
            u.add(gains[0], a);
            v.add(gains[1], a);
        }
    }
}

/// Mass times the `unit` displacement of every node.
pub(super) fn weights<const N: usize>(plane: &Plane<N>, unit: [f64; N]) -> Vec<[f64; N]> {
    let [first, across, second] = &plane.mass;
    let mut all = vec![[0.0; N]; plane.elements + 1];
    for element in 0..plane.elements {
        let on = [
            (product(first, &unit), product(across, &unit)),
            (product(&across.transpose(), &unit), product(second, &unit)),
        ];
        for (node, (a, b)) in on.iter().enumerate() {
            (0..N).for_each(|i| all[element + node][i] += a[i] + b[i]);
        }
    }
    all
}
