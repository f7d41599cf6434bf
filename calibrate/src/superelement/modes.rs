//! What a condensed body needs in time besides its static compliance: a few modes of its inside, held at its hub, and its
//! rigid motions.
//!
//! The modes span static solutions. The first ones are those under loads on the contact zone and under the
//! inertia of the hub's motions. Each further block is the body under the inertia of the solutions before
//! (block Lanczos on the factor of the stiffness). B. Nour-Omid, R.W. Clough, "Block Lanczos method for
//! dynamic analysis of structures", Earthquake Eng. Struct. Dyn. 13 (1985). The space of the first blocks has
//! the lowest natural modes, and replaces the others by their effect under loads on the contact zone. With n
//! blocks it has the first 2n terms of the flexibility there, as a series of the squared frequency. The first
//! term is the statics, the second the inertia of a quasi-static motion.
//!
//! Contact nodes have no mass. The residual static compliance `C - Φ·K⁻¹·Φᵀ` follows the contact forces at
//! once. C is the compliance, Φ has the rows of the modes, and K is their stiffness. The residual is positive
//! semi-definite for any modes. Sources: D.J. Rixen, "A dual Craig-Bampton method for dynamic
//! substructuring", J. Comput. Appl. Math. 168 (2004), for the free interface; C.D. Monjaraz-Tec, J. Gross,
//! M. Krack, "A massless boundary component mode synthesis method for elastodynamic contact problems",
//! Comput. Struct. 260 (2022), for the interface without mass.

use super::factor::{Factor, dot};
use super::factored::Superelement;
use crate::mesh::{HexMesh, SurfaceGrid};
use crate::solid::{MirrorHalf, NodalMass, Numbering, Symmetry, System, rigid_motion};
use faer::linalg::matmul::matmul;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Accum, Mat, MatRef, Par, unzip, zip};
use nalgebra::{DMatrix, Matrix6, Point3, Vector3};
use railspring_profiles::error::{InputError, Result};
use std::ops::Range;

/// Of as many modes of a body that is its own mirror image one is antisymmetric: of 3 to 8 the number with which 48 modes are nearest to full order.
/// Loads across the track and down on a patch that is its own mirror image do not move it so; but the far field of a fine grid takes the flexibility between neighbouring nodes from pairs of nodes farther apart
/// ([`crate::calibration`]), where both parts count. With symmetric modes alone P and Q of a bouncing wheel were 0.12 and 0.37 % off full order,
/// however many there were.
const ANTISYMMETRIC_OF: usize = 6;

/// A direction is spanned already if less than this share of it is left beside the others.
const SPANNED: f64 = 1e-5;

/// Modes of a body that is held at its hub or supports, each of mass 1 kg: displacements are in metres for a coordinate of 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Modes {
    /// Displacements of the contact nodes, `3·node + axis` in the order of the contact grid; a column for each mode.
    pub(super) contact: Mat<f64>,
    /// Stiffness between the modes, N/m; their mass is the unit matrix.
    pub(super) stiffness: DMatrix<f64>,
    /// Mass between the rigid motions of the body about [`Modes::master`] (row: translations x, y, z in kg, rotations in kg·m)
    /// and the modes.
    pub(super) coupling: DMatrix<f64>,
    /// Mass between the rigid motions; kg, kg·m, kg·m².
    pub(super) rigid: Matrix6<f64>,
    /// Point about which the body rotates, m: its master node, or the origin.
    pub(super) master: Point3<f64>,
}

impl Modes {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.contact.ncols()
    }

    /// Displacements of the contact nodes in a mode.
    pub fn contact(&self, mode: usize) -> &[f64] {
        self.contact.col_as_slice(mode)
    }

    /// Stiffness between the first `count` modes, N/m.
    pub fn stiffness(&self, count: usize) -> DMatrix<f64> {
        self.stiffness.view((0, 0), (count, count)).into_owned()
    }

    /// Mass between a rigid motion (0 to 5: translations, rotations) and a mode.
    pub fn coupling(&self, motion: usize, mode: usize) -> f64 {
        self.coupling[(motion, mode)]
    }

    /// Mass between two rigid motions.
    pub fn rigid_mass(&self, motion: usize, other: usize) -> f64 {
        self.rigid[(motion, other)]
    }

    /// Displacement of a point under a unit rigid motion, m.
    pub fn rigid_motion(&self, point: &Point3<f64>, motion: usize) -> Vector3<f64> {
        rigid_motion(&(point - self.master), motion)
    }

    /// How many of `count` modes of a body that is its own mirror image are symmetric and how many antisymmetric, in the order of
    /// [`Symmetry::BOTH`].
    pub fn of_halves(count: usize) -> [usize; 2] {
        let antisymmetric = count / ANTISYMMETRIC_OF;
        [count - antisymmetric, antisymmetric]
    }

    /// The modes of a body from those of its `half` in symmetric and in antisymmetric motions, in turn as in [`Modes::of_halves`], each of mass 1 kg.
    pub(super) fn joined(half: &MirrorHalf, parts: [Self; 2]) -> Self {
        // both halves have half of the mass
        let scale = std::f64::consts::FRAC_1_SQRT_2;
        let rows = 3 * half.contact().iter().flatten().max().map_or(0, |last| last + 1);
        // which part a mode is of, and its number there
        let mut order: Vec<(usize, usize)> = Vec::new();
        let counts = parts.each_ref().map(Self::count);
        let mut taken = [0, 0];
        while taken != counts {
            let wanted = usize::from((order.len() + 1).is_multiple_of(ANTISYMMETRIC_OF));
            let part = if taken[wanted] < counts[wanted] { wanted } else { 1 - wanted };
            order.push((part, taken[part]));
            taken[part] += 1;
        }
        let mut contact = Mat::zeros(rows, order.len());
        for (mode, &(part, number)) in order.iter().enumerate() {
            let symmetry = Symmetry::BOTH[part];
            let (from, to) = (parts[part].contact.col_as_slice(number), contact.col_as_slice_mut(mode));
            for (moved, &[at, image]) in from.chunks_exact(3).zip(half.contact()) {
                for d in 0..3 {
                    to[3 * image + d] = scale * symmetry.sign(d) * moved[d];
                    to[3 * at + d] = scale * moved[d];
                }
            }
        }
        // rotations about the track and motions in its cross-section are symmetric, the others antisymmetric
        let part_of = |motion: usize| usize::from(!matches!(motion, 1..=3));
        Self {
            contact,
            stiffness: DMatrix::from_fn(order.len(), order.len(), |i, j| {
                let ((one, i), (other, j)) = (order[i], order[j]);
                if one == other { parts[one].stiffness[(i, j)] } else { 0.0 }
            }),
            coupling: DMatrix::from_fn(6, order.len(), |motion, mode| {
                let (part, number) = order[mode];
                let moves = part_of(motion) == part;
                if moves { 2.0 * scale * parts[part].coupling[(motion, number)] } else { 0.0 }
            }),
            rigid: Matrix6::from_fn(|i, k| {
                if part_of(i) == part_of(k) { 2.0 * parts[0].rigid[(i, k)] } else { 0.0 }
            }),
            master: parts[0].master,
        }
    }
}

impl Superelement<'_> {
    /// At most `count` modes of the body, which must be held, its hub included; fewer where it has no more.
    ///
    /// # Errors
    /// [`InputError`] for a body whose hub is free.
    pub fn modes(&self, count: usize) -> Result<Modes> {
        let symmetry = Symmetry::Symmetric;
        self.modes_under(&contact_loads(self.system.mesh, symmetry), symmetry, count)
    }

    /// At most `count` modes of a rail on whose whole running surface loads travel, a load on a section of it among them, and the work of that load (forces on all nodes,
    /// `3·node + direction`) on each mode.
    ///
    /// # Errors
    /// As [`Self::modes`].
    pub fn modes_along(&self, on_section: &[f64], count: usize) -> Result<(Modes, Vec<f64>)> {
        let mesh = self.system.mesh;
        let travelling = Symmetry::BOTH.into_iter().flat_map(|symmetry| contact_loads(mesh, symmetry));
        let loads: Vec<Vec<f64>> = travelling.chain([on_section.to_vec()]).collect();
        self.modes_and_works(&loads, Symmetry::Symmetric, count, on_section)
    }

    /// The same from forces of a symmetry on all nodes (`3·node + direction`) on.
    pub(super) fn modes_under(&self, loads: &[Vec<f64>], symmetry: Symmetry, count: usize) -> Result<Modes> {
        self.modes_and_works(loads, symmetry, count, &[]).map(|(modes, _)| modes)
    }

    fn modes_and_works(
        &self,
        loads: &[Vec<f64>],
        symmetry: Symmetry,
        count: usize,
        on_section: &[f64],
    ) -> Result<(Modes, Vec<f64>)> {
        let System { mesh, numbering, .. } = &self.system;
        let Numbering { interior, contact, equations, .. } = *numbering;
        if equations > interior + contact {
            return InputError::refuse(
                "modes",
                "a body whose hub is free",
                "a body that is held",
                "condense the body with its hub held",
            );
        }
        let mass = self.system.mass_off_contact();
        let master = numbering.master().unwrap_or_else(Point3::origin);
        let moved: [Vec<f64>; 6] = std::array::from_fn(|motion| rigid(mesh, &master, motion));
        let impulses = moved.each_ref().map(|motion| mass.times(motion));
        let inertia = impulses.each_ref().map(|impulse| numbering.gather(mesh, impulse));
        let mut first: Vec<Vec<f64>> = loads.iter().map(|load| numbering.gather(mesh, load)).collect();
        if numbering.master().is_some() && symmetry == Symmetry::Symmetric {
            // of the hub's motions across the track and down
            first.extend([inertia[1].clone(), inertia[2].clone()]);
        }
        let inside = InteriorMass::new(mesh, numbering, &mass);
        let vectors = self.lanczos(&inside, &Surface::new(&self.system)?, first, count);
        let kept = vectors.ncols();
        let shapes = vectors.subrows(interior, contact).to_owned();
        let coupling =
            DMatrix::from_fn(6, kept, |motion, mode| dot(&inertia[motion], vectors.col_as_slice(mode)));
        let works = match on_section {
            [] => Vec::new(),
            forces => {
                let forces = numbering.gather(mesh, forces);
                (0..kept).map(|mode| dot(&forces, vectors.col_as_slice(mode))).collect()
            }
        };
        let roots = self.roots(vectors);
        let mut stiffness = Mat::zeros(kept, kept);
        matmul(stiffness.as_mut(), Accum::Replace, roots.transpose(), roots.as_ref(), 1.0, Par::Seq);
        let modes = Modes {
            contact: shapes,
            stiffness: DMatrix::from_fn(kept, kept, |i, j| stiffness[(i.min(j), i.max(j))]),
            coupling,
            rigid: Matrix6::from_fn(|i, k| {
                0.5 * (dot(&impulses[i], &moved[k]) + dot(&impulses[k], &moved[i]))
            }),
            master,
        };
        Ok((modes, works))
    }

    /// The products of [`Factor::root_times`], which take the place of the vectors.
    fn roots(&self, mut vectors: Mat<f64>) -> Mat<f64> {
        // what a pass over the factor takes is the time to read it
        const TOGETHER: usize = 32;
        for first in (0..vectors.ncols()).step_by(TOGETHER) {
            let mut some = vectors.subcols_mut(first, TOGETHER.min(vectors.ncols() - first));
            let products = self.factor.root_times(some.as_ref());
            some.copy_from(&products);
        }
        vectors
    }

    /// Block Lanczos from some loads (by equation) on: vectors that are orthonormal with the mass, by equation.
    fn lanczos(
        &self,
        mass: &InteriorMass,
        surface: &Surface,
        loads: Vec<Vec<f64>>,
        count: usize,
    ) -> Mat<f64> {
        let numbering = &self.system.numbering;
        let Numbering { interior, equations, .. } = *numbering;
        let mut vectors = Mat::zeros(equations, count);
        let mut found = 0;
        let mut block = Mat::from_fn(equations, loads.len().min(count), |row, n| loads[n][row]);
        drop(loads);
        while block.ncols() > 0 {
            self.factor.solve(block.as_mut());
            let mut impulses = mass.times(block.as_ref());
            let norm = |x: &[f64], impulse: &[f64]| dot(&x[..interior], impulse).max(0.0).sqrt();
            let whole: Vec<f64> =
                (0..block.ncols()).map(|n| norm(block.col_as_slice(n), impulses.col_as_slice(n))).collect();
            let known = vectors.subcols(0, found);
            // once more against rounding
            for _ in 0..2 {
                let mut shares = Mat::zeros(found, block.ncols());
                let inside = known.subrows(0, interior);
                matmul(shares.as_mut(), Accum::Replace, inside.transpose(), impulses.as_ref(), 1.0, Par::Seq);
                matmul(block.as_mut(), Accum::Add, known, shares.as_ref(), -1.0, Par::Seq);
                impulses = mass.times(block.as_ref());
            }
            let mut new = Vec::new();
            for n in 0..block.ncols() {
                for _ in 0..2 {
                    for &other in &new {
                        let share = dot(&block.col_as_slice(other)[..interior], impulses.col_as_slice(n));
                        subtract(&mut block, share, other, n);
                        subtract(&mut impulses, share, other, n);
                    }
                }
                let left = norm(block.col_as_slice(n), impulses.col_as_slice(n));
                // not so where it is no number
                if left > SPANNED * whole[n] {
                    for values in [block.col_as_slice_mut(n), impulses.col_as_slice_mut(n)] {
                        values.iter_mut().for_each(|v| *v /= left);
                    }
                    new.push(n);
                }
            }
            for &n in &new {
                surface.settle(block.col_as_slice_mut(n));
                vectors.col_as_slice_mut(found).copy_from_slice(block.col_as_slice(n));
                found += 1;
            }
            new.truncate(count - found);
            block = Mat::from_fn(equations, new.len(), |row, n| {
                if row < interior && !numbering.is_at_rest(row) { impulses[(row, new[n])] } else { 0.0 }
            });
        }
        vectors.resize_with(equations, found, |_, _| 0.0);
        vectors
    }
}

/// Takes `share` times the column `other` from the column `n`.
fn subtract(columns: &mut Mat<f64>, share: f64, other: usize, n: usize) {
    let (before, after) = columns.as_mut().split_at_col_mut(n);
    zip!(after.col_mut(0), before.col(other)).for_each(|unzip!(v, o)| *v -= share * *o);
}

/// The mass between the nodes that are eliminated, in their order.
struct InteriorMass {
    starts: Vec<usize>,
    entries: Vec<(u32, f64)>,
}

impl InteriorMass {
    fn new(mesh: &HexMesh, numbering: &Numbering, mass: &NodalMass) -> Self {
        let inside = numbering.interior / 3;
        let place = |node: usize| numbering.place(node).filter(|place| *place < inside);
        let mut nodes = vec![0; inside];
        (0..mesh.nodes.len()).for_each(|node| {
            if let Some(place) = place(node) {
                nodes[place] = node;
            }
        });
        let (mut starts, mut entries) = (vec![0], Vec::new());
        for node in nodes {
            let row = mass.row(node).filter_map(|(other, value)| Some((place(other)? as u32, value)));
            entries.extend(row);
            starts.push(entries.len());
        }
        Self { starts, entries }
    }

    /// Mass times vectors by equation, in the equations of these nodes.
    fn times(&self, vectors: MatRef<'_, f64>) -> Mat<f64> {
        let mut products = Mat::zeros(3 * (self.starts.len() - 1), vectors.ncols());
        for first in (0..vectors.ncols()).step_by(AT_ONCE) {
            let some = first..vectors.ncols().min(first + AT_ONCE);
            match some.len() {
                AT_ONCE => self.put_products::<AT_ONCE>(vectors, some, &mut products),
                _ => some.for_each(|n| self.put_products::<1>(vectors, n..n + 1, &mut products)),
            }
        }
        products
    }

    /// Products of `N` vectors by their numbers; each value of the mass is read once for all of them.
    fn put_products<const N: usize>(
        &self,
        vectors: MatRef<'_, f64>,
        numbers: Range<usize>,
        products: &mut Mat<f64>,
    ) {
        let of: [&[f64]; N] = std::array::from_fn(|n| {
            vectors.col(numbers.start + n).try_as_col_major().expect("whole columns").as_slice()
        });
        for (row, ends) in self.starts.windows(2).enumerate() {
            let mut sums = [[0.0; 3]; N];
            for &(place, value) in &self.entries[ends[0]..ends[1]] {
                let at = 3 * place as usize;
                for n in 0..N {
                    (0..3).for_each(|d| sums[n][d] += value * of[n][at + d]);
                }
            }
            for n in 0..N {
                let to = products.col_as_slice_mut(numbers.start + n);
                to[3 * row..3 * row + 3].copy_from_slice(&sums[n]);
            }
        }
    }
}

/// Vectors at once in a product with the mass.
const AT_ONCE: usize = 4;

/// The contact nodes, which follow the others. They have no mass, so that nothing in the orthogonality of the modes holds them: left alone, the
/// rounding of their displacements grows from block to block. B. Nour-Omid, B.N. Parlett, T. Ericsson, P.S. Jensen, "How to implement
/// the spectral transformation", Math. Comp. 48 (1987).
struct Surface {
    /// Upper triangle of the stiffness, whole in the columns of the contact nodes.
    columns: SparseColMat<usize, f64>,
    /// Factor of the stiffness of the contact nodes with all others held.
    factor: Factor,
    interior: usize,
}

impl Surface {
    fn new(system: &System) -> Result<Self> {
        let Numbering { interior, equations, .. } = system.numbering;
        let columns = system.stiffness_at_contact()?;
        let mut own = Vec::new();
        for column in interior..equations {
            let range = columns.col_ptr()[column]..columns.col_ptr()[column + 1];
            for (&row, &value) in columns.row_idx()[range.clone()].iter().zip(&columns.val()[range]) {
                if row >= interior {
                    own.push(Triplet::new(row - interior, column - interior, value));
                }
            }
        }
        let size = equations - interior;
        let own =
            SparseColMat::try_new_from_triplets(size, size, &own).expect("rows and columns within the block");
        Ok(Self { columns, factor: Factor::new(own.as_ref(), size)?, interior })
    }

    /// Puts the contact nodes where no force is on them.
    fn settle(&self, vector: &mut [f64]) {
        let (inside, contact) = vector.split_at_mut(self.interior);
        let mut forces = Mat::from_fn(contact.len(), 1, |n, _| {
            let column = self.interior + n;
            let range = self.columns.col_ptr()[column]..self.columns.col_ptr()[column + 1];
            let terms = self.columns.row_idx()[range.clone()].iter().zip(&self.columns.val()[range]);
            -terms
                .filter(|(row, _)| **row < self.interior)
                .map(|(row, value)| value * inside[*row])
                .sum::<f64>()
        });
        self.factor.solve(forces.as_mut());
        contact.copy_from_slice(forces.col_as_slice(0));
    }
}

/// Forces across the track and down on the contact zone. They grow from one end of its profile to the other
/// or back, and from both its ends along the track to the middle. Together they act anywhere across the zone,
/// with any moment. Forces along the track balance in a patch under a wheel that does not roll. Antisymmetric
/// ones grow along the track from one end to the opposite force at the other.
pub(super) fn contact_loads(mesh: &HexMesh, symmetry: Symmetry) -> Vec<Vec<f64>> {
    let SurfaceGrid { along_profile, along_track, nodes } = &mesh.contact;
    let columns = along_track.len();
    // from 0 to 1; a zone of a single line has no ends
    let place = |values: &[f64], at: usize| {
        let (first, last) = (values[0], values[values.len() - 1]);
        if last > first { (values[at] - first) / (last - first) } else { 0.5 }
    };
    let load = |towards_last: bool, axis: usize| {
        let mut forces = vec![0.0; 3 * mesh.nodes.len()];
        for (n, node) in nodes.iter().enumerate() {
            let (across, along) = (place(along_profile, n / columns), place(along_track, n % columns));
            let share = if towards_last { across } else { 1.0 - across };
            let from_middle = 2.0 * along - 1.0;
            forces[3 * node + axis] = share
                * match symmetry {
                    // a little is left at the ends, for a zone that has nothing between them
                    Symmetry::Symmetric => 1.01 - from_middle.abs(),
                    Symmetry::Antisymmetric => from_middle,
                };
        }
        forces
    };
    [(false, 1), (false, 2), (true, 1), (true, 2)].map(|(end, axis)| load(end, axis)).into()
}

/// Displacements of all nodes in a rigid motion about `master`.
fn rigid(mesh: &HexMesh, master: &Point3<f64>, motion: usize) -> Vec<f64> {
    mesh.nodes.iter().flat_map(|p| <[f64; 3]>::from(rigid_motion(&(p - master), motion))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{BlockOptions, mesh_block};
    use crate::solid::{Formulation, Material, Supports};
    use nalgebra::SymmetricEigen;

    fn element<'a>(mesh: &'a HexMesh, material: Material, supports: &Supports) -> Superelement<'a> {
        let system = System::new(mesh, material, Formulation::IncompatibleModes, supports).unwrap();
        Superelement::new(system).unwrap()
    }

    /// Source: a bar that is held at one end (K.F. Graff, Wave Motion in Elastic Solids, 1975, sections 2.4 and 3.3): it swings along its
    /// axis at (2n-1)·c/4L, and across it at 3.516·√(EI/ρA)/(2π·L²) in two planes. Goal: these natural frequencies (Hz).
    /// Accuracy: DISCRETISATION, (kh)²/24 of linear elements of the length h at the wave number k with consistent mass, and half as much for the mass
    /// moved off the end; MODEL, shear and rotatory inertia of a bar of 24 widths, 1 %.
    #[test]
    fn a_bar_swings_at_its_natural_frequencies() {
        const MODEL: f64 = 0.01;
        let (length, width) = (0.24, 0.01);
        let mesh = mesh_block(&BlockOptions::uniform([width, width, length], [1, 1, 24])).unwrap();
        let material = Material { poisson: 0.0, ..Material::STEEL };
        let supports = Supports { held: mesh.foot.clone(), ..Default::default() };
        let modes = element(&mesh, material, &supports).modes(40).unwrap();
        let squares = SymmetricEigen::new(modes.stiffness(40)).eigenvalues;
        let mut found: Vec<f64> =
            squares.iter().map(|square| square.max(0.0).sqrt() / std::f64::consts::TAU).collect();
        found.sort_by(f64::total_cmp);
        let speed = (material.young / material.density).sqrt();
        let bending = 3.516 * speed * width / 12_f64.sqrt() / (std::f64::consts::TAU * length * length);
        assert!((found[0] / bending - 1.0).abs() < MODEL, "{} {bending}", found[0]);
        for n in [1.0, 3.0, 5.0] {
            let exact = n * speed / (4.0 * length);
            let off = found.iter().map(|f| (f / exact - 1.0).abs()).fold(f64::INFINITY, f64::min);
            let wave = n * std::f64::consts::FRAC_PI_2 / 24.0;
            let discretisation = wave * wave / 16.0;
            assert!(off < discretisation, "{exact} Hz: {off} {discretisation}");
        }
    }

    /// Source: the body's own matrices. Goal: the modes are orthonormal with the mass. That shows in the mass
    /// between them and the rigid motions, whose sum of squares stays below that of the body. Their stiffness
    /// is that of the shapes (J). The residual of the compliance, m/N, is positive semi-definite. The first
    /// modes are the same when there are more. Accuracy: ROUNDOFF.
    #[test]
    fn what_modes_leave_of_the_compliance_is_not_negative() {
        const ROUNDOFF: f64 = 1e-10;
        let mesh = mesh_block(&BlockOptions::uniform([0.02, 0.03, 0.04], [3, 2, 4])).unwrap();
        let supports = Supports { followers: mesh.foot.clone(), ..Default::default() };
        let element = element(&mesh, Material::STEEL, &supports);
        let (few, many) = (element.modes(7).unwrap(), element.modes(30).unwrap());
        assert_eq!((few.count(), many.count()), (7, 30));
        let off = (few.stiffness(7) - many.stiffness(7)).abs().max() / few.stiffness(7).max();
        assert!(off < ROUNDOFF, "{off:e}");
        for motion in 0..6 {
            let carried: f64 = (0..30).map(|mode| many.coupling(motion, mode).powi(2)).sum();
            assert!(carried < many.rigid_mass(motion, motion), "{motion}");
        }
        assert!((many.rigid_mass(2, 2) / (7850.0 * 0.02 * 0.03 * 0.04) - 1.0).abs() < ROUNDOFF);
        let n = element.compliance.nrows();
        let shapes = DMatrix::from_fn(n, 30, |row, mode| many.contact(mode)[row]);
        let compliance = DMatrix::from_fn(n, n, |i, j| element.compliance[(i, j)]);
        let of_modes = &shapes * many.stiffness(30).try_inverse().unwrap() * shapes.transpose();
        let values = SymmetricEigen::new(&compliance - of_modes).eigenvalues;
        assert!(
            values.min() > -ROUNDOFF * values.max() && values.max() > 0.0,
            "{} {}",
            values.min(),
            values.max()
        );
    }

    /// Goal: a body whose hub is free has no static solutions, and is refused.
    #[test]
    fn a_free_hub_is_refused() {
        let mesh = mesh_block(&BlockOptions::uniform([0.02; 3], [2; 3])).unwrap();
        let supports =
            Supports { followers: mesh.foot.clone(), master_free: [true; 6], ..Default::default() };
        let system = System::new(&mesh, Material::STEEL, Formulation::IncompatibleModes, &supports).unwrap();
        let element = Superelement::effective(system, 1.0, 1e6, &[]).unwrap();
        let refused = element.modes(4).unwrap_err().to_string();
        assert!(refused.contains("hub is free"), "{refused}");
    }
}
