//! Supports and the numbering of the equations.

use crate::mesh::HexMesh;
use feral_metis::{CscPattern, metis_order};
use nalgebra::{Point3, Vector3};
use railspring_profiles::error::{NumericsError, Result, StopReason};

/// How a solid is held.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Supports {
    /// Nodes that cannot move.
    pub held: Vec<usize>,
    /// Nodes that follow the master node as on a rigid body.
    pub followers: Vec<usize>,
    /// Position of the master node, m.
    pub master: Point3<f64>,
    /// Which motions of the master node are unknowns: translations x, y, z, rotations about x, y, z.
    /// The others are zero.
    pub master_free: [bool; 6],
}

/// Marks a degree of freedom that is held.
const HELD: usize = usize::MAX;

/// One term of a nodal displacement: `coefficient` times the unknown `equation`.
pub type Term = (usize, f64);

/// Equation numbers in elimination order: interior nodes in a nested-dissection
/// order, then the contact nodes (three per node, in the order of the contact
/// grid), then the free motions of the master node.
#[derive(Debug, Clone)]
pub struct Numbering {
    first: Vec<usize>,
    follower: Vec<bool>,
    master: Point3<f64>,
    master_equation: [usize; 6],
    /// Which equations of nodes stay at zero; empty if all are free.
    at_rest: Vec<bool>,
    /// Number of equations that are eliminated.
    pub interior: usize,
    /// Number of equations of the contact nodes; they follow the interior ones.
    pub contact: usize,
    /// Number of all equations; those past the contact ones are the master's.
    pub equations: usize,
}

impl Numbering {
    /// Numbers the equations of `mesh` under `supports`.
    ///
    /// # Errors
    /// [`NumericsError`] if the mesh graph cannot be ordered.
    pub fn new(mesh: &HexMesh, supports: &Supports) -> Result<Self> {
        let count = mesh.nodes.len();
        let mut follower = vec![false; count];
        supports.followers.iter().for_each(|&n| follower[n] = true);
        let mut interior = vec![true; count];
        for &n in supports.held.iter().chain(&supports.followers).chain(&mesh.contact.nodes) {
            interior[n] = false;
        }
        let mut first = vec![HELD; count];
        let order = dissection_order(mesh, &interior)?;
        let mut next = 0;
        for &n in order.iter().chain(&mesh.contact.nodes) {
            first[n] = next;
            next += 3;
        }
        let interior = 3 * order.len();
        let contact = next - interior;
        let mut master_equation = [HELD; 6];
        if !supports.followers.is_empty() {
            for (equation, free) in master_equation.iter_mut().zip(supports.master_free) {
                if free {
                    *equation = next;
                    next += 1;
                }
            }
        }
        Ok(Self {
            first,
            follower,
            master: supports.master,
            master_equation,
            at_rest: Vec::new(),
            interior,
            contact,
            equations: next,
        })
    }

    /// The same with nodes that cannot move in a direction (0 to 2: x, y, z): these equations stay, by themselves, and their values are zero.
    #[must_use]
    pub fn with_at_rest(mut self, directions: &[(usize, usize)]) -> Self {
        self.at_rest = vec![false; self.equations];
        for &(node, direction) in directions {
            if let Some(place) = self.place(node) {
                self.at_rest[3 * place + direction] = true;
            }
        }
        self
    }

    /// Whether an equation stays at zero.
    pub fn is_at_rest(&self, equation: usize) -> bool {
        self.at_rest.get(equation).copied().unwrap_or(false)
    }

    /// Number of equations that do not stay at zero.
    pub fn degrees_of_freedom(&self) -> usize {
        self.equations - self.at_rest.iter().filter(|rests| **rests).count()
    }

    /// Equation of a free motion of the master node (0 to 5: translations x, y, z, rotations), if it is free.
    pub fn master_equation(&self, motion: usize) -> Option<usize> {
        Some(self.master_equation[motion]).filter(|&e| e != HELD)
    }

    /// Position of the master node, m; `None` where no node follows it.
    pub fn master(&self) -> Option<Point3<f64>> {
        self.follower.contains(&true).then_some(self.master)
    }

    /// Place of a node in the order of elimination; none for nodes that are held or follow the master.
    pub fn place(&self, node: usize) -> Option<usize> {
        (!self.follower[node] && self.first[node] != HELD).then(|| self.first[node] / 3)
    }

    /// Whether a node follows the master node.
    pub fn follows(&self, node: usize) -> bool {
        self.follower[node]
    }

    /// The terms whose sum is the displacement of `node` at `position` in `direction`; at most three.
    pub fn terms(&self, node: usize, position: &Point3<f64>, direction: usize) -> ([Term; 3], usize) {
        let mut terms = [(0, 0.0); 3];
        let mut count = 0;
        if self.follower[node] {
            let arm = position - self.master;
            for (motion, &equation) in self.master_equation.iter().enumerate() {
                let coefficient = rigid_motion(&arm, motion)[direction];
                if equation != HELD && coefficient != 0.0 {
                    terms[count] = (equation, coefficient);
                    count += 1;
                }
            }
        } else if self.first[node] != HELD {
            terms[0] = (self.first[node] + direction, 1.0);
            count = 1;
        }
        (terms, count)
    }

    /// Displacements of all nodes, `3·node + direction`, from the solution of the equations.
    pub fn expand(&self, mesh: &HexMesh, solution: &[f64]) -> Vec<f64> {
        let mut nodal = vec![0.0; 3 * mesh.nodes.len()];
        for (n, position) in mesh.nodes.iter().enumerate() {
            for d in 0..3 {
                let (terms, count) = self.terms(n, position, d);
                let moving = terms[..count].iter().filter(|(e, _)| !self.is_at_rest(*e));
                nodal[3 * n + d] = moving.map(|&(e, c)| c * solution[e]).sum();
            }
        }
        nodal
    }

    /// Values of the equations when the whole body moves by `translation`; held nodes stay.
    pub fn translation(&self, translation: &Vector3<f64>) -> Vec<f64> {
        let mut values = vec![0.0; self.equations];
        for &first in self.first.iter().filter(|&&e| e != HELD) {
            values[first..first + 3].copy_from_slice(translation.as_slice());
        }
        for motion in 0..3 {
            if let Some(e) = self.master_equation(motion) {
                values[e] = translation[motion];
            }
        }
        values
    }

    /// Right-hand side of the equations from nodal forces, `3·node + direction`.
    pub fn gather(&self, mesh: &HexMesh, nodal: &[f64]) -> Vec<f64> {
        let mut rhs = vec![0.0; self.equations];
        for (n, position) in mesh.nodes.iter().enumerate() {
            for d in 0..3 {
                let (terms, count) = self.terms(n, position, d);
                for &(e, c) in terms[..count].iter().filter(|(e, _)| !self.is_at_rest(*e)) {
                    rhs[e] += c * nodal[3 * n + d];
                }
            }
        }
        rhs
    }
}

/// Displacement of a point at `arm` from the master under unit `motion` (0 to 5).
pub fn rigid_motion(arm: &Vector3<f64>, motion: usize) -> Vector3<f64> {
    let mut axis = Vector3::zeros();
    axis[motion % 3] = 1.0;
    if motion < 3 { axis } else { axis.cross(arm) }
}

/// Nested-dissection order of the interior nodes.
fn dissection_order(mesh: &HexMesh, interior: &[bool]) -> Result<Vec<usize>> {
    let nodes: Vec<usize> = (0..mesh.nodes.len()).filter(|&n| interior[n]).collect();
    let mut local = vec![usize::MAX; mesh.nodes.len()];
    nodes.iter().enumerate().for_each(|(i, &n)| local[n] = i);
    let mut neighbours = vec![Vec::new(); nodes.len()];
    for hex in &mesh.hexes {
        for &a in hex.iter().filter(|&&n| interior[n]) {
            neighbours[local[a]].extend(hex.iter().filter(|&&n| interior[n]).map(|&b| local[b] as i32));
        }
    }
    let mut starts = vec![0_i32];
    let mut indices = Vec::new();
    for row in &mut neighbours {
        row.sort_unstable();
        row.dedup();
        indices.append(row);
        starts.push(indices.len() as i32);
    }
    let failed = || NumericsError::new("ordering of the equations", StopReason::Singular, 0.0, 0);
    let pattern = CscPattern::new(nodes.len(), &starts, &indices).ok_or_else(failed)?;
    let order = metis_order(&pattern).map_err(|_| failed())?;
    Ok(order.iter().map(|&i| nodes[i as usize]).collect())
}
