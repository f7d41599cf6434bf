//! Both rails of a track in all directions across it: bending in two planes, and torsion.
//!
//! The rails are alike and loaded at the same place, so that they have the same equations, and every number stands for both: the right one's, then the left one's.
//! Each is treated as a right one, lateral displacements towards its field side. In the axes of its section a rail bends vertically by itself; only sway and twist are
//! coupled, by the distance of the centroid from the node line and by supports at the foot. So there are two chains, of two and of three degrees of freedom a node.

use nalgebra::{Matrix3, Vector3};

use crate::time::newmark::Newmark;
use crate::time::scenario::Kelvin;
use railspring_calibrate::beam::{BeamElement, BeamSection, ElementBlocks, rotation_functions};
use railspring_profiles::error::{NumericsError, Result, StopReason};

use super::dynamics::gains;
use super::plane::{Both, Deforming, Plane, PlaneState, PlaneStep, PlaneSteps, Seat, dot, weights};
use super::state::Rows;
use super::structure::{Carrier, Direction, Layers, LineBeam, Onto, Track, bed, moment, rotation};

/// A coordinate of a rail across the track.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Across {
    /// Displacement towards the field side.
    Lateral,
    /// Rotation about the vertical.
    Turn,
    /// Rotation about the rail's axis; positive tilts the head to the field side.
    Twist,
}

/// A support across the track that gives way: a layer of springs and dampers, or two with a mass between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LayersAcross {
    /// Where, m from the rail's first end.
    pub x: f64,
    /// Which coordinate.
    pub direction: Across,
    /// How far below the node line it holds the rail, m; of a lateral one.
    pub below_line: f64,
    /// The upper layer; of a rotation in N·m/rad and N·m·s/rad.
    pub upper: Kelvin,
    /// The mass below, kg, and the layer under it.
    pub below: Option<(f64, Kelvin)>,
}

/// Two rails with all that carries them.
#[derive(Debug, Clone, PartialEq)]
pub struct TwoRails {
    /// One rail with what carries it vertically; no bridge.
    pub rail: Track,
    /// Angle of its section, rad, y to z.
    pub angle: f64,
    /// A bed across the track under the whole rail, a metre of it: N/m², N·s/m².
    pub bed: Option<Kelvin>,
    /// How far below the node line the bed holds it, m.
    pub bed_below_line: f64,
    /// A bed against twist, a metre of rail: N·m/rad/m.
    pub twist_bed: Option<Kelvin>,
    /// Nodes and coordinates that do not move.
    pub held: Vec<(usize, Across)>,
    /// What gives way.
    pub layers: Vec<LayersAcross>,
}

impl TwoRails {
    /// Whether something holds the rails at rest across the track: against sway, against rotation about the vertical and against twist.
    pub fn is_held(&self) -> bool {
        let soft = |bed: &Option<Kelvin>| bed.is_some_and(|bed| bed.stiffness > 0.0);
        let stiff = |layers: &&LayersAcross| {
            layers.upper.stiffness > 0.0 && layers.below.is_none_or(|(_, layer)| layer.stiffness > 0.0)
        };
        let pitch = self.rail.length / self.rail.elements as f64;
        let held = self.held.iter().map(|&(node, which)| (node as f64 * pitch, which));
        let giving = self.layers.iter().filter(stiff).map(|layers| (layers.x, layers.direction));
        let all: Vec<(f64, Across)> = held.chain(giving).collect();
        let of = |which: Across| all.iter().filter(move |(_, held)| *held == which).map(|(x, _)| *x);
        let first = of(Across::Lateral).next();
        let apart = |x: f64| first.is_some_and(|first| (x - first).abs() > 1e-9 * self.rail.length);
        let twisted = soft(&self.twist_bed) || of(Across::Twist).next().is_some();
        let turned = of(Across::Lateral).any(apart) || of(Across::Turn).next().is_some();
        twisted && (soft(&self.bed) || first.is_some() && turned)
    }
}

/// Motion of both rails against the ground.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RailsState {
    vertical: PlaneState<2>,
    across: PlaneState<3>,
}

/// Two rails prepared for runs.
pub(super) struct RailsDynamics<'a> {
    pub rails: &'a TwoRails,
    pitch: f64,
    vertical: Plane<2>,
    across: Plane<3>,
}

/// Moments about the axis of a rail at places.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Twisting {
    /// Place, m.
    pub x: f64,
    /// N·m, positive tilts the head to the field side.
    pub moment: Both,
}

/// What acts on both rails at the end of a step besides the wheels.
#[derive(Debug, Clone, Copy)]
pub(super) struct RailsLoad<'l> {
    /// Place of the wheels, m.
    pub x: f64,
    /// Acceleration of the ground to the right and downwards, m/s².
    pub ground: [f64; 2],
    pub twisting: &'l [Twisting],
}

/// What is seen of a rail at a place, in the axes of its side.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RailSeen {
    /// Displacement of the node line to the field side and down, m, and rotation (positive tilts the head to the field side), rad.
    pub displacement: [f64; 3],
    /// Acceleration to the field side and down against the ground, m/s².
    pub acceleration: [f64; 2],
    /// Bending moments in the plane across the track and in the vertical one, N·m; of the latter positive where the lower side is in tension.
    pub moments: [f64; 2],
    /// Torsion, N·m.
    pub torsion: f64,
}

/// Degrees of freedom of a plane among the twelve of an element.
const VERTICAL: [usize; 2] = [2, 4];
const ACROSS: [usize; 3] = [1, 5, 3];

fn blocks<const N: usize>(matrix: impl Fn(usize, usize) -> f64, dofs: [usize; N]) -> ElementBlocks<N> {
    [(0, 0), (0, 6), (6, 6)]
        .map(|(row, column)| nalgebra::SMatrix::from_fn(|i, j| matrix(row + dofs[i], column + dofs[j])))
}

/// A row that gives a displacement of an element from its twelve degrees of freedom.
fn row_of<const N: usize>(row: impl Fn(usize) -> f64, dofs: [usize; N]) -> Rows<N> {
    [0, 6].map(|from| dofs.map(|dof| row(from + dof)))
}

/// Two rails over steps of one length.
pub(super) struct RailsSteps {
    vertical: PlaneSteps<2>,
    across: PlaneSteps<3>,
}

/// A step of two rails; displacements and forces have the directions of each rail's side: field side, up, and the rotation from the first to the second.
pub(super) struct RailsStep {
    vertical: PlaneStep<2, 1>,
    across: PlaneStep<3, 2>,
    /// Displacements at the wheels without their forces.
    pub free: [Vector3<f64>; 2],
    /// Displacements per force, of either rail.
    pub flexibility: Matrix3<f64>,
}

impl<'a> RailsDynamics<'a> {
    pub fn new(rails: &'a TwoRails) -> Self {
        let Track { length, elements, rail, .. } = &rails.rail;
        let pitch = length / *elements as f64;
        let LineBeam { section, damping, mass_damping } = rail;
        let element = BeamElement { section, length: pitch, angle: 0.0 };
        let (stiffness, mass) = (element.stiffness(), element.mass());
        let [shear_y, shear_z] = element.shear_parameters();
        let deforming = |slope: f64, bending: f64, shear: f64, torsion: f64| Deforming {
            slope,
            bending: bending / pitch,
            shearing: 3.0 * bending / (pitch * (1.0 + shear)),
            twisting: torsion / pitch,
        };
        let place = |x: f64| place(x, pitch, *elements);
        let of_bed: Vec<(ElementBlocks<2>, Kelvin)> = rails
            .rail
            .bed
            .map(|kelvin| {
                let matrix = bed(section, pitch);
                let of = |a: usize, b: usize| nalgebra::SMatrix::from_fn(|i, j| matrix[2 * a + i][2 * b + j]);
                ([of(0, 0), of(0, 1), of(1, 1)], kelvin)
            })
            .into_iter()
            .collect();
        let mut dynamics = Self {
            rails,
            pitch,
            vertical: Plane {
                elements: *elements,
                stiffness: blocks(|i, j| stiffness[(i, j)], VERTICAL),
                mass: blocks(|i, j| mass[(i, j)], VERTICAL),
                // a positive rotation about y tilts the axis to negative z
                deforming: deforming(-2.0 / pitch, section.bending_z, shear_z, 0.0),
                damping: *damping,
                mass_damping: *mass_damping,
                beds: of_bed,
                seats: Vec::new(),
                held: Vec::new(),
                weights: Vec::new(),
            },
            across: Plane {
                elements: *elements,
                stiffness: blocks(|i, j| stiffness[(i, j)], ACROSS),
                mass: blocks(|i, j| mass[(i, j)], ACROSS),
                deforming: deforming(2.0 / pitch, section.bending_y, shear_y, section.torsion),
                damping: *damping,
                mass_damping: *mass_damping,
                beds: Vec::new(),
                seats: Vec::new(),
                held: Vec::new(),
                weights: Vec::new(),
            },
        };
        for layers in rails.rail.layers.iter().filter(|layers| layers.of == Carrier::Rail) {
            let Layers { x, direction, upper, below, onto, .. } = *layers;
            debug_assert!(onto == Onto::Ground);
            let (element, xi) = place(x);
            let row = match direction {
                Direction::Vertical => dynamics.vertical_row(xi),
                Direction::Rotation => {
                    let row = rotation(section, pitch, xi);
                    [[row[0], row[1]], [row[2], row[3]]]
                }
            };
            let weighs = direction == Direction::Vertical;
            dynamics.vertical.seats.push(Seat { element, row, upper, below, weighs });
        }
        for layers in &rails.layers {
            let LayersAcross { x, direction, below_line, upper, below } = *layers;
            let (element, xi) = place(x);
            let [lateral, twist] = dynamics.across_rows(xi);
            let row = match direction {
                Across::Lateral => std::array::from_fn(|node| {
                    std::array::from_fn(|i| lateral[node][i] - below_line * twist[node][i])
                }),
                Across::Turn => {
                    let turn = dynamics.turn_row(xi);
                    row_of(|i| turn[i], ACROSS)
                }
                Across::Twist => twist,
            };
            let weighs = direction == Across::Lateral;
            dynamics.across.seats.push(Seat { element, row, upper, below, weighs });
        }
        let below_line = rails.bed_below_line;
        if let Some(kelvin) = rails.bed {
            let row = |xi: f64| {
                let [lateral, twist] = dynamics.across_rows(xi);
                std::array::from_fn(|node| {
                    std::array::from_fn(|i| lateral[node][i] - below_line * twist[node][i])
                })
            };
            let matrix = distributed(row, pitch);
            dynamics.across.beds.push((matrix, kelvin));
        }
        if let Some(kelvin) = rails.twist_bed {
            let matrix = distributed(|xi| dynamics.across_rows(xi)[1], pitch);
            dynamics.across.beds.push((matrix, kelvin));
        }
        dynamics.vertical.held = rails
            .rail
            .held
            .iter()
            .map(|held| (held.node, usize::from(held.direction == Direction::Rotation)))
            .collect();
        dynamics.across.held = rails.held.iter().map(|&(node, which)| (node, which as usize)).collect();
        for held in [&mut dynamics.vertical.held, &mut dynamics.across.held] {
            held.sort_unstable();
            held.dedup();
        }
        // the unit displacement
        dynamics.vertical.weights = weights(&dynamics.vertical, [1.0, 0.0]);
        dynamics.across.weights = weights(&dynamics.across, [1.0, 0.0, 0.0]);
        dynamics
    }

    fn place(&self, x: f64) -> (usize, f64) {
        place(x, self.pitch, self.rails.rail.elements)
    }

    fn beam(&self) -> BeamElement<'_> {
        BeamElement { section: &self.rails.rail.rail.section, length: self.pitch, angle: 0.0 }
    }

    fn vertical_row(&self, xi: f64) -> Rows<2> {
        let [_, down, _] = self.beam().section_motion(xi);
        row_of(|i| down[i], VERTICAL)
    }

    /// Lateral displacement and twist.
    fn across_rows(&self, xi: f64) -> [Rows<3>; 2] {
        let [lateral, _, twist] = self.beam().section_motion(xi);
        [row_of(|i| lateral[i], ACROSS), row_of(|i| twist[i], ACROSS)]
    }

    /// Rotation about the vertical.
    fn turn_row(&self, xi: f64) -> [f64; 12] {
        let parameter = self.beam().shear_parameters()[0];
        let [a, b, c, d] = rotation_functions(xi, self.pitch, parameter);
        let mut row = [0.0; 12];
        [row[1], row[5], row[7], row[11]] = [a, b, c, d];
        row
    }

    fn twisting(&self, all: &[Twisting]) -> Vec<(usize, Rows<3>, Both)> {
        let of = |one: &Twisting| {
            let (element, xi) = self.place(one.x);
            (element, self.across_rows(xi)[1], one.moment)
        };
        all.iter().map(of).collect()
    }

    /// Ground accelerations in the axes of the sections: across, and down.
    fn ground(&self, [right, down]: [f64; 2]) -> [Both; 2] {
        let (sin, cos) = self.rails.angle.sin_cos();
        let across = [right, -right].map(|field| cos * field + sin * down);
        let vertical = [right, -right].map(|field| cos * down - sin * field);
        [across, vertical]
    }

    /// Displacement across and down and twist of the sections at the wheels, in the directions of a side.
    fn to_side(&self, across: f64, down: f64, twist: f64) -> Vector3<f64> {
        let (sin, cos) = self.rails.angle.sin_cos();
        Vector3::new(cos * across - sin * down, -(sin * across + cos * down), -twist)
    }

    /// Forces in the directions of a side, in the axes of the section: across, down, and moment.
    fn to_section(&self, forces: &Vector3<f64>) -> [f64; 3] {
        let (sin, cos) = self.rails.angle.sin_cos();
        let (field, down) = (forces.x, -forces.y);
        [cos * field + sin * down, cos * down - sin * field, -forces.z]
    }

    fn sections(&self, forces: &[Vector3<f64>; 2]) -> ([Both; 2], [Both; 1]) {
        let [right, left] = forces.each_ref().map(|forces| self.to_section(forces));
        ([[right[0], left[0]], [right[2], left[2]]], [[right[1], left[1]]])
    }

    pub fn failure(&self) -> NumericsError {
        NumericsError::new("two rails", StopReason::Singular, f64::NAN, self.unknowns())
    }

    /// Unknowns of both rails.
    pub fn unknowns(&self) -> usize {
        fn masses<const N: usize>(plane: &Plane<N>) -> usize {
            plane.seats.iter().filter(|seat| seat.below.is_some()).count()
        }
        let (vertical, across) = (&self.vertical, &self.across);
        let nodes = 5 * (vertical.elements + 1) - vertical.held.len() - across.held.len();
        2 * (nodes + masses(vertical) + masses(across))
    }

    /// Flexibility of the rails at rest at `x` (m) in the directions of a side; none if nothing holds them.
    pub fn flexibility(&self, x: f64) -> Option<Matrix3<f64>> {
        let mut columns = [Vector3::zeros(); 3];
        for (i, column) in columns.iter_mut().enumerate() {
            let mut force = Vector3::zeros();
            force[i] = 1.0;
            let state = self.at_rest(x, &[force; 2], &[])?;
            *column = self.at_wheels(&state, x)[0];
        }
        let flexibility = Matrix3::from_columns(&columns);
        Some(0.5 * (flexibility + flexibility.transpose()))
    }

    /// The rails at rest under forces of the wheels at `x` and moments.
    pub fn at_rest(&self, x: f64, forces: &[Vector3<f64>; 2], twisting: &[Twisting]) -> Option<RailsState> {
        if !(self.rails.rail.is_held() && self.rails.is_held()) {
            return None;
        }
        let (element, xi) = self.place(x);
        let (across, down) = self.sections(forces);
        let twisting = self.twisting(twisting);
        let state = RailsState {
            vertical: self.vertical.at_rest((element, [self.vertical_row(xi)]), down, &[])?,
            across: self.across.at_rest((element, self.across_rows(xi)), across, &twisting)?,
        };
        Some(state)
    }

    /// The rails at rest without a load.
    pub fn unloaded(&self) -> RailsState {
        RailsState { vertical: self.vertical.rest(), across: self.across.rest() }
    }

    /// Gives a state its accelerations.
    ///
    /// # Errors
    /// Rails without inertia.
    pub fn accelerate(
        &self,
        state: &mut RailsState,
        load: &RailsLoad,
        forces: &[Vector3<f64>; 2],
    ) -> Result<()> {
        let (element, xi) = self.place(load.x);
        let (across, down) = self.sections(forces);
        let [ground_across, ground_down] = self.ground(load.ground);
        let twisting = self.twisting(load.twisting);
        let rows = (element, [self.vertical_row(xi)]);
        self.vertical
            .accelerate(&mut state.vertical, &ground_down, rows, down, &[])
            .ok_or_else(|| self.failure())?;
        let rows = (element, self.across_rows(xi));
        self.across
            .accelerate(&mut state.across, &ground_across, rows, across, &twisting)
            .ok_or_else(|| self.failure())?;
        Ok(())
    }

    /// Displacements of the sections at `x`, in the directions of their sides.
    pub fn at_wheels(&self, state: &RailsState, x: f64) -> [Vector3<f64>; 2] {
        let (element, xi) = self.place(x);
        let down = dot(&self.vertical_row(xi), &state.vertical.displacements, element);
        let [lateral, twist] =
            self.across_rows(xi).map(|row| dot(&row, &state.across.displacements, element));
        [0, 1].map(|side| self.to_side(lateral[side], down[side], twist[side]))
    }

    /// What is seen of the rail of a side at a place.
    pub fn seen(&self, state: &RailsState, side: usize, x: f64) -> RailSeen {
        let (element, xi) = self.place(x);
        let rows = (self.vertical_row(xi), self.across_rows(xi));
        let of = |vertical: &[[Both; 2]], across: &[[Both; 3]]| {
            let down = dot(&rows.0, vertical, element)[side];
            let [lateral, twist] = rows.1.map(|row| dot(&row, across, element)[side]);
            self.to_side(lateral, down, twist)
        };
        let moved = of(&state.vertical.displacements, &state.across.displacements);
        let sped = of(&state.vertical.accelerations, &state.across.accelerations);
        let section = &self.rails.rail.rail.section;
        let [a, b, c, d] = moment(section, self.pitch, xi);
        let vertical = dot(&[[a, b], [c, d]], &state.vertical.displacements, element)[side];
        // the curvature of the deflection across, from the same functions
        let sideways = BeamSection { bending_z: section.bending_y, shear_z: section.shear_y, ..*section };
        let [a, b, c, d] = moment(&sideways, self.pitch, xi);
        let lateral = dot(&[[a, -b, 0.0], [c, -d, 0.0]], &state.across.displacements, element)[side];
        let twisted = |node: usize| state.across.displacements[node][2][side];
        RailSeen {
            displacement: [moved.x, -moved.y, -moved.z],
            acceleration: [sped.x, -sped.y],
            moments: [lateral, vertical],
            torsion: section.torsion * (twisted(element + 1) - twisted(element)) / self.pitch,
        }
    }

    /// The rails over steps of `scheme`.
    ///
    /// # Errors
    /// Equations without a solution.
    pub fn over(&self, scheme: Newmark) -> Result<RailsSteps> {
        let gains = gains(&scheme);
        let vertical = self.vertical.factor(1.0, gains).ok_or_else(|| self.failure())?;
        let across = self.across.factor(1.0, gains).ok_or_else(|| self.failure())?;
        Ok(RailsSteps {
            vertical: PlaneSteps { scheme, factor: vertical },
            across: PlaneSteps { scheme, factor: across },
        })
    }

    /// The step from `state` to `next` without forces of the wheels.
    pub fn predict(
        &self,
        steps: &RailsSteps,
        state: &RailsState,
        load: &RailsLoad,
        next: &mut RailsState,
    ) -> RailsStep {
        let (element, xi) = self.place(load.x);
        let [ground_across, ground_down] = self.ground(load.ground);
        let twisting = self.twisting(load.twisting);
        let rows = (element, [self.vertical_row(xi)]);
        let vertical = steps.vertical.predict(
            &self.vertical,
            &state.vertical,
            &mut next.vertical,
            &ground_down,
            rows,
            &[],
        );
        let rows = (element, self.across_rows(xi));
        let across = steps.across.predict(
            &self.across,
            &state.across,
            &mut next.across,
            &ground_across,
            rows,
            &twisting,
        );
        let free = [0, 1]
            .map(|side| self.to_side(across.free[0][side], vertical.free[0][side], across.free[1][side]));
        let [[yy, yr], [_, rr]] = across.flexibility;
        let own = Matrix3::new(yy, 0.0, yr, 0.0, vertical.flexibility[0][0], 0.0, yr, 0.0, rr);
        let (sin, cos) = self.rails.angle.sin_cos();
        let turn = Matrix3::new(cos, -sin, 0.0, -sin, -cos, 0.0, 0.0, 0.0, -1.0);
        let flexibility = turn * own * turn.transpose();
        RailsStep { vertical, across, free, flexibility }
    }

    /// Completes a step with the forces of the wheels.
    pub fn finish(
        &self,
        steps: &RailsSteps,
        step: &RailsStep,
        next: &mut RailsState,
        forces: &[Vector3<f64>; 2],
    ) {
        let (across, down) = self.sections(forces);
        steps.vertical.finish(&self.vertical, &step.vertical, &mut next.vertical, down);
        steps.across.finish(&self.across, &step.across, &mut next.across, across);
    }
}

/// The element at `x` and where in it.
fn place(x: f64, pitch: f64, elements: usize) -> (usize, f64) {
    let along = x / pitch;
    // a place that is a node by its numbers may miss it by their rounding
    let along = if (along - along.round()).abs() < 1e-9 { along.round() } else { along };
    let element = (along.max(0.0) as usize).min(elements - 1);
    (element, (along - element as f64).clamp(0.0, 1.0))
}

/// A unit stiffness a metre against the displacement of `row`, in the nodes of an element.
fn distributed(row: impl Fn(f64) -> Rows<3>, length: f64) -> ElementBlocks<3> {
    let mut sum: ElementBlocks<3> = [nalgebra::SMatrix::zeros(); 3];
    for (xi, weight) in railspring_profiles::quadrature::gauss_4_unit() {
        let row = row(xi);
        for (block, (node, other)) in [(0, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            sum[block] += nalgebra::SMatrix::from_fn(|i, j| weight * length * row[node][i] * row[other][j]);
        }
    }
    sum
}
