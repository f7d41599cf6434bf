use nalgebra::{DMatrix, DVector, SMatrix};

use super::*;
use crate::time::linear_part::conformance::Trial;
use railspring_calibrate::beam::{BeamElement, BeamSection, End};

/// A section whose centroid lies beside its node line, so that all coordinates of the interface are coupled.
const SECTION: BeamSection = BeamSection {
    axial: 1.6e9,
    bending_y: 6e6,
    bending_z: 1e6,
    shear_y: 2e8,
    shear_z: 3e8,
    torsion: 4e5,
    mass: 60.0,
    rotary_y: 0.23,
    rotary_z: 0.04,
    polar: 0.3,
    centroid: [0.01, 0.04],
};

/// Angle of the section, rad.
const ANGLE: f64 = 0.025;

fn beam(length: f64, elements: usize, ends: [End; 2]) -> RailBeam {
    RailBeam::new(SECTION, length, elements, ANGLE, ends).unwrap()
}

fn at_rest(beam: &RailBeam) -> RailState {
    let mut state = RailState::default();
    state.resize(beam.elements() + 1);
    state
}

fn displacement(dynamics: &RailDynamics, x: f64, state: &RailState) -> Vec<f64> {
    let SectionRows { element, rows } = dynamics.section(x).section;
    let of = |row: &[Node; 2]| -> f64 {
        (0..2).map(|node| dot(&row[node], &state.displacements[element + node])).sum()
    };
    rows.iter().map(of).collect()
}

/// Displacements and rotations, their velocities and their accelerations.
fn numbers(state: &RailState) -> Vec<Vec<f64>> {
    let all = [&state.displacements, &state.velocities, &state.accelerations];
    let of = |values: &[Node], range: std::ops::Range<usize>| {
        values.iter().flat_map(|node| node[range.clone()].to_vec()).collect()
    };
    all.iter().flat_map(|values| [of(values, 0..2), of(values, 2..NODE)]).collect()
}

/// Goal: the rail obeys the rules of a linear part, with and without damping and dissipation, inside an element, at a node and over
/// its held ends, where nothing moves. Without both its energy (J) is the work of the forces. Accuracy: ROUNDOFF of
/// forces, which are differences of the displacements of neighbours, a thousand times smaller than these, over 40 steps.
#[test]
fn the_rail_is_a_linear_part() {
    const ROUNDOFF: f64 = 1e-12;
    let beam = beam(0.6, 8, [End::Fixed, End::Pinned]);
    for (damping, dissipation) in [(0.0, 0.0), (6e-6, 0.0), (0.0, 0.05), (6e-6, 0.05)] {
        let dynamics = RailDynamics::new(&beam, damping);
        let part = dynamics.over(&Newmark::new(1e-4, dissipation)).unwrap();
        for x in [0.0, 0.2, 0.225, 0.6] {
            let load = |torsion| RailLoad { x, torsion };
            let trial = Trial {
                part: &part,
                rest: at_rest(&beam),
                loads: [load(800.0), load(-300.0), load(500.0)],
                force: 5e3,
                displacement: &|state| displacement(&dynamics, x, state),
                numbers: &numbers,
            };
            let found = trial.deviations();
            assert!(found.largest() < ROUNDOFF, "{damping} {dissipation} {x}: {found:?}");
            let mut next = RailState::default();
            let step = part.predict(&trial.rest, &load(0.0), &mut next);
            let held = step.flexibility().norm_max() == 0.0;
            assert_eq!(held, x == 0.0 || x == 0.6);
            if damping == 0.0 && dissipation == 0.0 && !held {
                let energy = |state: &RailState| {
                    let found = dynamics.stored(state);
                    found.kinetic + found.elastic
                };
                let defect = trial.energy_defect(&load(0.0), &energy);
                assert!(defect < ROUNDOFF, "{x}: {defect:e}");
            }
        }
    }
}

/// The beam with the dense matrices of its elements, six unknowns a node in world axes.
struct Dense {
    length: f64,
    elements: usize,
    mass: DMatrix<f64>,
    stiffness: DMatrix<f64>,
    /// One in the diagonal of held unknowns, which have nothing else in their rows.
    held: DMatrix<f64>,
}

impl Dense {
    fn new(length: f64, elements: usize, ends: [End; 2]) -> Self {
        let size = 6 * (elements + 1);
        let free = |i: usize| {
            let held = |end: End| match end {
                End::Fixed => true,
                End::Pinned => i % 6 < 4,
                End::Free => false,
            };
            !(i < 6 && held(ends[0]) || i >= size - 6 && held(ends[1]))
        };
        let element = BeamElement { section: &SECTION, length: length / elements as f64, angle: ANGLE };
        let assembled = |matrix: &SMatrix<f64, 12, 12>| {
            let mut sum = DMatrix::zeros(size, size);
            for first in (0..6 * elements).step_by(6) {
                let mut own = sum.fixed_view_mut::<12, 12>(first, first);
                own += matrix;
            }
            DMatrix::from_fn(size, size, |i, j| if free(i) && free(j) { sum[(i, j)] } else { 0.0 })
        };
        let held = DMatrix::from_fn(size, size, |i, j| if i == j && !free(i) { 1.0 } else { 0.0 });
        let (mass, stiffness) = (assembled(&element.mass()), assembled(&element.stiffness()));
        Self { length, elements, mass, stiffness, held }
    }

    /// Rows of directions 1, 2 and rotation 3 at `x`.
    fn rows(&self, x: f64) -> [DVector<f64>; 3] {
        let pitch = self.length / self.elements as f64;
        let first = ((x / pitch) as usize).min(self.elements - 1);
        let element = BeamElement { section: &SECTION, length: pitch, angle: ANGLE };
        let rows = element.section_motion(x / pitch - first as f64);
        [0, 1, 2].map(|i| {
            let mut row = DVector::zeros(self.mass.nrows());
            row.rows_mut(6 * first, 12).copy_from(&(rows[i] * [1.0, -1.0, -1.0][i]));
            row
        })
    }

    /// Displacement, velocity and acceleration under forces that act as `rows` at the end of a step of Newmark's scheme.
    fn step(
        &self,
        [u, v, a]: &[DVector<f64>; 3],
        scheme: &Newmark,
        damping: f64,
        forces: &DVector<f64>,
    ) -> [DVector<f64>; 3] {
        let each = |of: fn(&Newmark, &Motion) -> f64| {
            DVector::from_fn(u.len(), |i, _| of(scheme, &Motion { u: u[i], v: v[i], a: a[i] }))
        };
        let damping = &self.stiffness * damping;
        let matrix =
            &self.mass * scheme.acceleration + &damping * scheme.velocity + &self.stiffness + &self.held;
        let right = &self.mass * each(Newmark::inertia) + damping * each(Newmark::damping) + forces;
        let right = DVector::from_fn(u.len(), |i, _| if self.held[(i, i)] == 1.0 { 0.0 } else { right[i] });
        let end = matrix.cholesky().unwrap().solve(&right);
        let ends: Vec<Motion> =
            (0..u.len()).map(|i| scheme.advance(&Motion { u: u[i], v: v[i], a: a[i] }, end[i])).collect();
        let part = |of: fn(&Motion) -> f64| DVector::from_iterator(u.len(), ends.iter().map(of));
        [part(|m| m.u), part(|m| m.v), part(|m| m.a)]
    }
}

/// Source: the dense matrices of the elements with six unknowns a node, solved by Cholesky in every step.
/// Goal: displacements of the section under the wheel (m, rad) and the four energies (J) of the rail while
/// the wheel moves along and forces and a torsion act. Chains have one to twenty elements, ends that are held
/// in all ways, damping and dissipation. Accuracy: ROUNDOFF of the dense solution, whose matrix has a
/// condition of up to 1e6; rotations are of the order of 0.01 rad.
#[test]
fn the_rail_moves_as_its_dense_matrices_say() {
    const ROUNDOFF: f64 = 1e-10;
    let (length, dt) = (0.6, 2e-4);
    let cases = [
        (1, [End::Fixed, End::Free], 0.0, 0.0),
        (3, [End::Pinned, End::Fixed], 6e-6, 0.05),
        (8, [End::Free, End::Fixed], 6e-6, 0.0),
        (20, [End::Fixed, End::Fixed], 0.0, 0.05),
        (20, [End::Pinned, End::Pinned], 6e-6, 0.0),
    ];
    for (elements, ends, damping, dissipation) in cases {
        let (dense, beam) = (Dense::new(length, elements, ends), beam(length, elements, ends));
        let dynamics = RailDynamics::new(&beam, damping);
        let scheme = Newmark::new(dt, dissipation);
        let part = dynamics.over(&scheme).unwrap();
        let first = RailLoad { x: 0.05, torsion: 700.0 };
        let contact = Vector3::new(2e3, -50e3, 30.0);
        let forces_at = |load: &RailLoad, contact: &Vector3<f64>| {
            let [a, b, c] = dense.rows(load.x);
            let [.., twist] = dense.rows(0.5 * length);
            a * contact.x + b * contact.y + c * contact.z - twist * load.torsion
        };
        // at rest, with the accelerations of the first forces
        let start = forces_at(&first, &contact);
        let free = DVector::from_fn(start.len(), |i, _| start[i] * (1.0 - dense.held[(i, i)]));
        let still = DVector::zeros(start.len());
        let mass = (&dense.mass + &dense.held).cholesky().unwrap();
        let mut expected = [still.clone(), still, mass.solve(&free)];
        let mut state = dynamics.start(&first, contact).unwrap();
        let (mut off, mut size) = ([0.0_f64; 6], [0.0_f64; 6]);
        for step in 1..=60 {
            let phase = f64::from(step);
            let load = RailLoad { x: 0.05 + 0.008 * phase, torsion: 700.0 * (0.3 * phase).cos() };
            let contact = Vector3::new(2e3 * phase.sin(), -50e3 + 10e3 * (0.7 * phase).sin(), 30.0);
            let next = part.advance(&state, &load, contact.as_slice());
            let found = dynamics.energy(&state, &next, load.torsion, dt);
            let moved = dense.step(&expected, &scheme, damping, &forces_at(&load, &contact));
            let way = &moved[0] - &expected[0];
            let energies = [
                0.5 * moved[1].dot(&(&dense.mass * &moved[1])),
                0.5 * moved[0].dot(&(&dense.stiffness * &moved[0])),
                -load.torsion * dense.rows(0.5 * length)[2].dot(&way),
                damping * way.dot(&(&dense.stiffness * &way)) / dt,
            ];
            let places = displacement(&dynamics, load.x, &next);
            let rows = dense.rows(load.x);
            let pairs = (0..2)
                .map(|i| (places[i], rows[i].dot(&moved[0])))
                .chain([found.kinetic, found.elastic, found.work, found.damped].into_iter().zip(energies));
            for (i, (found, expected)) in pairs.enumerate() {
                off[i] = off[i].max((found - expected).abs());
                size[i] = size[i].max(expected.abs());
            }
            let turned = (places[2] - rows[2].dot(&moved[0])).abs();
            assert!(turned < ROUNDOFF * 0.01, "{elements} {ends:?} rotation {turned:e}");
            (state, expected) = (next, moved);
        }
        for i in 0..6 {
            assert!(off[i] <= ROUNDOFF * size[i], "{elements} {ends:?} {i}: {off:?} of {size:?}");
        }
        assert!(size[0] > 1e-6 && size[1] > 1e-5 && size[3] > 0.1, "{size:?}");
    }
}

/// Goal: a step of the rail, with its energies and with the factor of a length of step that was there before, allocates nothing, when two states take turns.
#[test]
fn a_step_of_the_rail_allocates_nothing() {
    let beam = beam(12.0, 200, [End::Fixed; 2]);
    let dynamics = RailDynamics::new(&beam, 6e-6);
    let schemes = [2.5e-4, 1.25e-4].map(|step| Newmark::new(step, 0.0));
    let (mut state, mut next) = (at_rest(&beam), at_rest(&beam));
    let mut steps = |count: u32| {
        for number in 0..count {
            let part = dynamics.over(&schemes[number as usize % 2]).unwrap();
            let load = RailLoad { x: 0.05 * f64::from(number), torsion: 50.0 };
            let step = part.predict(&state, &load, &mut next);
            let flexible = step.flexibility()[(1, 1)] > 0.0;
            step.finish(&[1e3, -50e3, 20.0]);
            let energy = dynamics.energy(&state, &next, load.torsion, 2.5e-4);
            assert!(energy.elastic > 0.0 && flexible == (number > 0));
            std::mem::swap(&mut state, &mut next);
        }
    };
    steps(2);
    let counted = allocation_counter::measure(|| steps(100));
    assert_eq!((counted.count_total, counted.bytes_total), (0, 0));
    assert!(allocation_counter::measure(|| drop(std::hint::black_box(vec![1.0; 100]))).count_total == 1);
}
