//! What is kept of a factored body: small, owned, and able to travel.

use super::elimination::compliance;
use super::factor::Factor;
use super::factored::Superelement;
use super::modes::Modes;
use super::section_motion::SectionMotion;
use super::step::Step;
use crate::mesh::{HexMesh, SurfaceGrid};
use crate::solid::{Formulation, Material, Materials, Numbering, Supports, System};
use blake3::Hasher;
use faer::sparse::{SparseColMat, SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Mat, MatMut};
use nalgebra::Point3;
use railspring_profiles::error::Result;
use std::path::PathBuf;
use std::sync::Arc;

/// A body reduced to its contact nodes. It borrows nothing, so that it outlives mesh and factor, and it can be written
/// and read ([`CondensedBody::write`]).
#[derive(Debug, Clone, PartialEq)]
pub struct CondensedBody {
    /// Hash of what made it: [`body_key`].
    pub key: String,
    /// Compliance of the retained equations, m/N: contact nodes (`3·node + direction` in the order of the contact
    /// grid), then the free motions of a master node.
    pub compliance: Arc<Mat<f64>>,
    /// The grid of the contact nodes on the profile; its node numbers are those of the mesh.
    pub grid: SurfaceGrid,
    /// Positions of the contact nodes in the order of the grid, m.
    pub nodes: Vec<Point3<f64>>,
    /// Equations of the body before it was condensed.
    pub equations: usize,
    /// Mass of its elements, kg.
    pub mass: f64,
    /// Material at its contact surface, without its damping.
    pub surface: Material,
    /// Of a rail that is a beam's solid: the motion of its section at the contact.
    pub section: Option<SectionMotion>,
    /// What it needs to move: [`Superelement::modes`]; statics do without.
    pub modes: Option<Modes>,
    /// What it is a body of, for messages; empty of a body that is of no pair.
    pub of: String,
    /// The file that it was read from ([`CondensedBody::open`]).
    pub file: Option<PathBuf>,
}

/// The inside of a body, which only fields need once it is condensed: it borrows the mesh and holds the factor of the stiffness between
/// the nodes that were eliminated. That is half of the work and three quarters of the memory of the factor that condensed the body, so that
/// nobody keeps that one.
pub struct Interior<'a> {
    /// The body.
    system: System<'a>,
    /// Upper triangle of the stiffness.
    matrix: SparseColMat<usize, f64>,
    factor: Factor,
}

/// Hash of everything that a condensed body depends on: mesh, materials, element and supports.
pub fn body_key(mesh: &HexMesh, materials: &Materials, element: Formulation, supports: &Supports) -> String {
    let mut hasher = Hasher::new();
    hasher.update(b"condensed body 3");
    let mut numbers = |values: &[f64]| {
        hasher.update(&(values.len() as u64).to_le_bytes());
        values.iter().for_each(|v| {
            hasher.update(&v.to_le_bytes());
        });
    };
    mesh.nodes.iter().for_each(|p| numbers(p.coords.as_slice()));
    numbers(&mesh.contact.along_profile);
    numbers(&mesh.contact.along_track);
    for Material { young, poisson, density, .. } in materials.of_groups() {
        numbers(&[*young, *poisson, *density]);
    }
    let mut indices = |values: &[usize]| {
        hasher.update(&(values.len() as u64).to_le_bytes());
        values.iter().for_each(|v| {
            hasher.update(&(*v as u64).to_le_bytes());
        });
    };
    mesh.hexes.iter().for_each(|hex| indices(hex));
    indices(&mesh.groups);
    indices(&mesh.contact.nodes);
    hasher.update(format!("{element:?} {supports:?}").as_bytes());
    hasher.finalize().to_hex().to_string()
}

impl CondensedBody {
    /// The body of a system with its compliance; `key` is that of the body ([`body_key`]).
    fn of_system(system: &System<'_>, compliance: Mat<f64>, key: String) -> Self {
        let mesh = system.mesh;
        Self {
            key,
            compliance: Arc::new(compliance),
            grid: mesh.contact.clone(),
            nodes: mesh.contact.nodes.iter().map(|&n| mesh.nodes[n]).collect(),
            equations: system.numbering.equations,
            mass: system.nodal_mass().total(),
            surface: Material { damping: 0.0, ..system.materials.at_contact(mesh) },
            section: None,
            modes: None,
            of: String::new(),
            file: None,
        }
    }

    /// The body of a system of which its compliance alone is wanted; says which step `begins`. The inside is eliminated from `loads`,
    /// right-hand sides of all equations by column.
    ///
    /// # Errors
    /// As [`Superelement::new`].
    pub(super) fn without_factor(
        system: &System<'_>,
        key: String,
        loads: MatMut<'_, f64>,
        begins: &mut dyn FnMut(Step),
    ) -> Result<Self> {
        begins(Step::Assembly);
        let matrix = system.matrix(1.0, 0.0, &[])?;
        begins(Step::Factorisation);
        let compliance = compliance(matrix, system.numbering.interior, loads)?;
        Ok(Self::of_system(system, compliance, key))
    }
}

impl Superelement<'_> {
    /// What is kept of the body; the factor goes. `key` is that of the body ([`body_key`]).
    pub fn condensed(self, key: String) -> CondensedBody {
        let Self { system, factor, compliance } = self;
        drop(factor);
        CondensedBody::of_system(&system, compliance, key)
    }
}

impl<'a> Interior<'a> {
    /// Assembles the stiffness of a body that is condensed, and factors it between the nodes that were eliminated.
    ///
    /// # Errors
    /// As [`Superelement::new`].
    pub fn new(system: System<'a>) -> Result<Self> {
        let matrix = system.matrix(1.0, 0.0, &[])?;
        let inside = system.numbering.interior;
        let (starts, rows) = (&matrix.col_ptr()[..=inside], matrix.row_idx());
        let end = starts[inside];
        let pattern = SymbolicSparseColMatRef::new_checked(inside, inside, starts, None, &rows[..end]);
        let factor = Factor::new(SparseColMatRef::new(pattern, &matrix.val()[..end]), inside)?;
        Ok(Self { system, matrix, factor })
    }

    /// Number of values stored in the factor.
    #[cfg(test)]
    pub fn stored_values(&self) -> usize {
        self.factor.stored_values()
    }

    /// Displacements of all nodes (`3·node + direction`, m) where the retained equations move by `retained` (m).
    pub fn moved(&self, retained: &[f64]) -> Vec<f64> {
        let Numbering { interior, equations, .. } = self.system.numbering;
        let mut x = vec![0.0; interior];
        for (column, moved) in (interior..equations).zip(retained) {
            let entries = self.matrix.col_ptr()[column]..self.matrix.col_ptr()[column + 1];
            let terms = self.matrix.row_idx()[entries.clone()].iter().zip(&self.matrix.val()[entries]);
            terms.filter(|(row, _)| **row < interior).for_each(|(row, value)| x[*row] -= value * moved);
        }
        self.factor.forward_interior(&mut x);
        self.factor.backward_interior(&mut x);
        x.extend(retained);
        self.system.numbering.expand(self.system.mesh, &x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{BlockOptions, mesh_block};
    use crate::superelement::{Parts, Wanted, times};

    fn block(divisions: [usize; 3]) -> HexMesh {
        mesh_block(&BlockOptions::uniform([0.05, 0.04, 0.03], divisions)).unwrap()
    }

    fn system<'a>(mesh: &'a HexMesh, supports: &Supports) -> System<'a> {
        System::new(mesh, Material::STEEL, Formulation::IncompatibleModes, supports).unwrap()
    }

    /// Source: the solution for the same forces with the factor that condensed the body. Goal: displacements of all nodes, m, of a block that is
    /// held, and of one that hangs on a master node which is free to turn, under forces on every retained equation (N, N·m). Accuracy over the
    /// largest: ROUNDOFF, 1e-16 times a condition number of 1e6.
    #[test]
    fn the_inside_moves_as_with_the_whole_factor() {
        const ROUNDOFF: f64 = 1e-10;
        let mesh = block([6, 5, 4]);
        let held = Supports { held: mesh.foot.clone(), ..Supports::default() };
        let hanging = Supports {
            held: mesh.foot[..6].to_vec(),
            followers: mesh.foot[6..].to_vec(),
            master: Point3::new(0.01, 0.02, 0.05),
            master_free: [false, true, false, true, true, false],
        };
        for supports in [held, hanging] {
            let element = Superelement::new(system(&mesh, &supports)).unwrap();
            let numbering = element.system.numbering.clone();
            let forces: Vec<f64> =
                (numbering.interior..numbering.equations).map(|e| (1.7 * e as f64).sin()).collect();
            let mut exact = vec![0.0; numbering.equations];
            exact[numbering.interior..].copy_from_slice(&times(&element.compliance, &forces));
            element.factor.backward_interior(&mut exact);
            let exact = numbering.expand(&mesh, &exact);
            let body = element.condensed("block".into());
            let parts = Parts::Whole(Box::new(system(&mesh, &supports)));
            let found = parts.displacements(&body, std::slice::from_ref(&forces)).unwrap().remove(0);
            let largest = exact.iter().fold(0.0_f64, |largest, u| largest.max(u.abs()));
            let off = exact.iter().zip(&found).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(largest > 0.0 && off < ROUNDOFF * largest, "{off:e} of {largest:e}");
        }
    }

    /// Goal: the condensed body with its modes, that without them, which is made by fronts, and the displacements of its inside are the same to the byte
    /// with 1, 2 and 4 threads.
    #[test]
    fn threads_change_no_byte() {
        let mesh = block([16, 12, 14]);
        let supports = Supports { held: mesh.foot.clone(), ..Supports::default() };
        let made = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let element = Superelement::new(system(&mesh, &supports)).unwrap();
                let modes = Some(element.modes(20).unwrap());
                let body = CondensedBody { modes, ..element.condensed("block".into()) };
                let forces: Vec<f64> = (0..body.compliance.nrows()).map(|e| (1.7 * e as f64).sin()).collect();
                let parts = Parts::Whole(Box::new(system(&mesh, &supports)));
                let moved = parts.displacements(&body, &[forces]).unwrap();
                let parts = Parts::Whole(Box::new(system(&mesh, &supports)));
                let wanted = Wanted { key: "block".into(), modes: 0, section: None };
                let by_fronts = parts.condensed(wanted, &mut |_, _, _| ()).unwrap();
                (body.write(), by_fronts.write(), moved)
            })
        };
        let one = made(1);
        for threads in [2, 4] {
            assert!(made(threads) == one, "{threads} threads");
        }
    }
}
