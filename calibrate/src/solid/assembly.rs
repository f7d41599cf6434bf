//! Assembly of stiffness and mass.

use super::brick::{self, Formulation, corners};
use super::columns::{Pattern, UpperMatrix};
use super::materials::Materials;
use super::numbering::{Numbering, Supports};
use crate::mesh::HexMesh;
use faer::sparse::{SparseColMat, Triplet};
use nalgebra::{Point3, SMatrix};
use railspring_profiles::error::{InputError, Result};
use rayon::prelude::*;

/// Elements whose matrices are held at the same time.
const AT_ONCE: usize = 4096;

/// A meshed body with its materials, supports and numbered equations.
pub struct System<'a> {
    /// The mesh.
    pub mesh: &'a HexMesh,
    /// Their materials.
    pub materials: Materials,
    /// The element.
    pub formulation: Formulation,
    /// Equation numbers.
    pub numbering: Numbering,
    /// Nodes without mass; empty if all have theirs.
    massless: Vec<bool>,
}

/// Mass between nodes, the same in each direction; rows by node.
pub struct NodalMass {
    starts: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

impl<'a> System<'a> {
    /// Numbers the equations of `mesh`.
    ///
    /// # Errors
    /// [`InputError`] if a material is impossible; a numerical error if the mesh cannot be ordered.
    pub fn new(
        mesh: &'a HexMesh,
        materials: impl Into<Materials>,
        formulation: Formulation,
        supports: &Supports,
    ) -> Result<Self> {
        Self::with_numbering(mesh, materials, formulation, Numbering::new(mesh, supports)?)
    }

    /// The body with the `numbering` that [`Numbering::new`] has for `mesh` and its supports.
    ///
    /// # Errors
    /// [`InputError`] if a material is impossible.
    pub fn with_numbering(
        mesh: &'a HexMesh,
        materials: impl Into<Materials>,
        formulation: Formulation,
        numbering: Numbering,
    ) -> Result<Self> {
        let materials = materials.into();
        materials.check(mesh)?;
        Ok(Self { mesh, materials, formulation, numbering, massless: Vec::new() })
    }

    /// Moves the mass of the contact nodes to the other nodes of their elements (H.B. Khenous, P. Laborde,
    /// Y. Renard, "Mass redistribution method for finite element contact problems in elastodynamics", Eur. J. Mech.
    /// A/Solids 27 (2008)): contact forces then follow the deformation alone, without a collision of nodes with every
    /// step. The mass of every element is kept; its centre moves inwards by half the first layer at most.
    #[must_use]
    pub fn with_massless_contact(mut self) -> Self {
        self.massless = self.contact_nodes();
        self
    }

    /// Which nodes are contact nodes.
    fn contact_nodes(&self) -> Vec<bool> {
        let mut marked = vec![false; self.mesh.nodes.len()];
        self.mesh.contact.nodes.iter().for_each(|&n| marked[n] = true);
        marked
    }

    /// Mass of an element between its nodes without those that are `massless`, kg.
    fn element_mass(&self, element: usize, massless: &[bool]) -> SMatrix<f64, 8, 8> {
        let hex = &self.mesh.hexes[element];
        let density = self.materials.of(self.mesh, element).density;
        let full = brick::mass(&corners(self.mesh, hex), density);
        let carries = hex.map(|n| !massless.get(n).copied().unwrap_or(false));
        if carries.iter().all(|c| *c) || carries.iter().all(|c| !*c) {
            return full;
        }
        let kept =
            SMatrix::<f64, 8, 8>::from_fn(|i, j| if carries[i] && carries[j] { full[(i, j)] } else { 0.0 });
        kept * (full.sum() / kept.sum())
    }

    /// Upper triangle of `stiffness_factor·stiffness + mass_factor·mass`, plus the given diagonal terms.
    ///
    /// # Errors
    /// [`InputError`] naming the first element that is inverted or flat.
    pub fn matrix(
        &self,
        stiffness_factor: f64,
        mass_factor: f64,
        diagonal: &[(usize, f64)],
    ) -> Result<SparseColMat<usize, f64>> {
        let mut matrix = UpperMatrix::new(Pattern::new(self.mesh, &self.numbering));
        for (chunk, hexes) in self.mesh.hexes.chunks(AT_ONCE).enumerate() {
            let first = chunk * AT_ONCE;
            let elements: Vec<Option<brick::Stiffness>> = (first..first + hexes.len())
                .into_par_iter()
                .map(|e| self.element(e, stiffness_factor, mass_factor))
                .collect();
            for (e, (hex, element)) in hexes.iter().zip(elements).enumerate() {
                let Some(element) = element else {
                    return Err(flat_element(first + e, &corners(self.mesh, hex)));
                };
                matrix.add(self.mesh, &self.numbering, hex, &element);
            }
        }
        diagonal.iter().for_each(|&(equation, value)| matrix.add_diagonal(equation, value));
        if self.numbering.degrees_of_freedom() < self.numbering.equations {
            matrix.part(&self.numbering);
        }
        Ok(matrix.finish())
    }

    /// Upper triangle of the stiffness in the columns of the contact nodes; the other columns are empty.
    ///
    /// # Errors
    /// As [`Self::matrix`].
    pub fn stiffness_at_contact(&self) -> Result<SparseColMat<usize, f64>> {
        let Numbering { interior, contact, equations, .. } = self.numbering;
        let columns = interior..interior + contact;
        let mut entries = Vec::new();
        for e in self.mesh.at_contact() {
            let hex = &self.mesh.hexes[e];
            let Some(element) = self.element(e, 1.0, 0.0) else {
                return Err(flat_element(e, &corners(self.mesh, hex)));
            };
            let terms: [_; 24] = std::array::from_fn(|i| {
                let node = hex[i / 3];
                self.numbering.terms(node, &self.mesh.nodes[node], i % 3)
            });
            for (j, (of_column, count)) in terms.iter().enumerate() {
                for &(column, b) in of_column[..*count].iter().filter(|(column, _)| columns.contains(column))
                {
                    for (i, (of_row, count)) in terms.iter().enumerate() {
                        let rests = |e: usize| self.numbering.is_at_rest(e);
                        let meet =
                            |row: usize| row == column || row < column && !rests(row) && !rests(column);
                        let rows = of_row[..*count].iter().filter(|(row, _)| meet(*row));
                        entries
                            .extend(rows.map(|&(row, a)| Triplet::new(row, column, a * b * element[(i, j)])));
                    }
                }
            }
        }
        Ok(SparseColMat::try_new_from_triplets(equations, equations, &entries)
            .expect("equation numbers are below their count"))
    }

    /// The matrix of an element; none if it is inverted or flat.
    pub(super) fn element(
        &self,
        element: usize,
        stiffness_factor: f64,
        mass_factor: f64,
    ) -> Option<brick::Stiffness> {
        let nodes = corners(self.mesh, &self.mesh.hexes[element]);
        let material = self.materials.of(self.mesh, element);
        let mut k = brick::stiffness(&nodes, material, self.formulation)? * stiffness_factor;
        if mass_factor != 0.0 {
            let m = self.element_mass(element, &self.massless) * mass_factor;
            for i in 0..24 {
                for j in (i % 3..24).step_by(3) {
                    k[(i, j)] += m[(i / 3, j / 3)];
                }
            }
        }
        Some(k)
    }

    /// Mass of all nodes, held ones and followers included.
    pub fn nodal_mass(&self) -> NodalMass {
        self.mass_without(&self.massless)
    }

    /// The same as it is [`Self::with_massless_contact`].
    pub fn mass_off_contact(&self) -> NodalMass {
        self.mass_without(&self.contact_nodes())
    }

    fn mass_without(&self, massless: &[bool]) -> NodalMass {
        let mut rows = vec![Vec::with_capacity(64); self.mesh.nodes.len()];
        for (e, hex) in self.mesh.hexes.iter().enumerate() {
            let m = self.element_mass(e, massless);
            for i in 0..8 {
                rows[hex[i]].extend((0..8).map(|j| (hex[j] as u32, m[(i, j)])));
            }
        }
        let mut mass = NodalMass { starts: vec![0], columns: Vec::new(), values: Vec::new() };
        for row in &mut rows {
            // stable: equal columns keep the order of the elements, so sums repeat to the last bit
            row.sort_by_key(|&(column, _)| column);
            for &(column, value) in row.iter() {
                if mass.columns.len() > mass.starts[mass.starts.len() - 1]
                    && mass.columns.last() == Some(&column)
                {
                    *mass.values.last_mut().expect("a value for every column") += value;
                } else {
                    mass.columns.push(column);
                    mass.values.push(value);
                }
            }
            mass.starts.push(mass.columns.len());
        }
        mass
    }
}

impl NodalMass {
    /// Mass times a nodal vector (`3·node + direction`).
    pub fn times(&self, nodal: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; nodal.len()];
        for (n, out) in product.chunks_exact_mut(3).enumerate() {
            let mut sum = [0.0; 3];
            for entry in self.starts[n]..self.starts[n + 1] {
                let m = self.values[entry];
                let at = 3 * self.columns[entry] as usize;
                for d in 0..3 {
                    sum[d] += m * nodal[at + d];
                }
            }
            out.copy_from_slice(&sum);
        }
        product
    }

    /// The mass between a node and others, kg.
    pub(crate) fn row(&self, node: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let entries = self.starts[node]..self.starts[node + 1];
        self.columns[entries.clone()]
            .iter()
            .map(|&column| column as usize)
            .zip(self.values[entries].iter().copied())
    }

    /// Mass of the whole body, kg.
    pub fn total(&self) -> f64 {
        self.values.iter().sum()
    }
}

fn flat_element(element: usize, nodes: &[Point3<f64>; 8]) -> railspring_profiles::error::Error {
    let c = nodes.iter().fold(nalgebra::Vector3::zeros(), |sum, p| sum + p.coords) / 8.0;
    InputError::new(
        "hexahedron",
        format!("element {element} at ({:.4}, {:.4}, {:.4}) m", c.x, c.y, c.z),
        "a hexahedron with positive Jacobian",
        "refine the mesh there or correct the order of its nodes",
    )
    .into()
}
