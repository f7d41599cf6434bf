//! What is kept of a factored body: small, owned, and able to travel.

use super::{Modes, SectionMotion, times};
use crate::error::Result;
use crate::mesh::{HexMesh, SurfaceGrid};
use crate::solid::{Formulation, Material, Supports, System};
use crate::superelement::{Factor, Superelement};
use blake3::Hasher;
use faer::Mat;
use nalgebra::Point3;

/// A body reduced to its contact nodes. It borrows nothing, so that it outlives mesh and factor, and it can be written
/// and read ([`CondensedBody::write`]).
#[derive(Debug, Clone, PartialEq)]
pub struct CondensedBody {
    /// Hash of what made it: [`body_key`].
    pub key: String,
    /// Compliance of the retained equations, m/N: contact nodes (`3·node + direction` in the order of the contact
    /// grid), then the free motions of a master node.
    pub compliance: Mat<f64>,
    /// The grid of the contact nodes on the profile; its node numbers are those of the mesh.
    pub grid: SurfaceGrid,
    /// Positions of the contact nodes in the order of the grid, m.
    pub nodes: Vec<Point3<f64>>,
    /// Equations of the body before it was condensed.
    pub equations: usize,
    /// Mass of its elements, kg.
    pub mass: f64,
    /// Of a rail that is a beam's solid: the motion of its section at the contact.
    pub section: Option<SectionMotion>,
    /// What it needs to move: [`Superelement::modes`]; statics do without.
    pub modes: Option<Modes>,
}

/// The inside of a body, which only fields need once it is condensed: it borrows the mesh and holds the factor.
pub struct Interior<'a> {
    /// The body.
    pub system: System<'a>,
    factor: Factor,
}

/// Hash of everything that a condensed body depends on: mesh, material, element and supports.
pub fn body_key(mesh: &HexMesh, material: &Material, element: Formulation, supports: &Supports) -> String {
    let mut hasher = Hasher::new();
    hasher.update(b"condensed body 1");
    let mut numbers = |values: &[f64]| {
        hasher.update(&(values.len() as u64).to_le_bytes());
        values.iter().for_each(|v| {
            hasher.update(&v.to_le_bytes());
        });
    };
    mesh.nodes.iter().for_each(|p| numbers(p.coords.as_slice()));
    numbers(&mesh.contact.along_profile);
    numbers(&mesh.contact.along_track);
    numbers(&[material.young, material.poisson, material.density]);
    let mut indices = |values: &[usize]| {
        hasher.update(&(values.len() as u64).to_le_bytes());
        values.iter().for_each(|v| {
            hasher.update(&(*v as u64).to_le_bytes());
        });
    };
    mesh.hexes.iter().for_each(|hex| indices(hex));
    indices(&mesh.contact.nodes);
    hasher.update(format!("{element:?} {supports:?}").as_bytes());
    hasher.finalize().to_hex().to_string()
}

impl<'a> Superelement<'a> {
    /// Separates what the contact needs from what only fields inside the body need. `key` is that of the body
    /// ([`body_key`]).
    pub fn split(self, key: String) -> (CondensedBody, Interior<'a>) {
        let Self { system, factor, compliance } = self;
        let mesh = system.mesh;
        let body = CondensedBody {
            key,
            compliance,
            grid: mesh.contact.clone(),
            nodes: mesh.contact.nodes.iter().map(|&n| mesh.nodes[n]).collect(),
            equations: system.numbering.equations,
            mass: system.nodal_mass().total(),
            section: None,
            modes: None,
        };
        (body, Interior { system, factor })
    }
}

impl<'a> Interior<'a> {
    /// Assembles and factors the stiffness of a body that was condensed before.
    ///
    /// # Errors
    /// As [`Superelement::new`].
    pub fn new(system: System<'a>) -> Result<Self> {
        let factor = Factor::new(&system.matrix(1.0, 0.0, &[])?, system.numbering.interior)?;
        Ok(Self { system, factor })
    }

    /// Displacements of all nodes (`3·node + direction`, m) under forces on the retained equations of `body` (N).
    pub fn displacement(&self, body: &CondensedBody, retained_forces: &[f64]) -> Vec<f64> {
        let retained = times(&body.compliance, retained_forces);
        super::interior_displacement(&self.system, &self.factor, &retained)
    }
}
