//! The upper triangle of a body's matrix in compressed columns, filled element by element.

use super::brick;
use super::numbering::Numbering;
use crate::mesh::HexMesh;
use faer::sparse::{SparseColMat, SymbolicSparseColMat};

/// Which nodes of a body share an element, by their places in the order of elimination; the three equations of a node have the
/// same neighbours.
pub struct Pattern {
    /// Where the rows of every place begin, and an end.
    pub starts: Vec<usize>,
    /// Places up to that of the column, ascending.
    pub rows: Vec<usize>,
    /// Equations of the free motions of the master node.
    masters: Vec<usize>,
    /// Places of the nodes that share an element with a follower of the master, ascending.
    beside_followers: Vec<usize>,
}

impl Pattern {
    /// The pattern of `mesh` with its `numbering`.
    pub fn new(mesh: &HexMesh, numbering: &Numbering) -> Self {
        let count = (numbering.interior + numbering.contact) / 3;
        let masters: Vec<usize> = (0..6).filter_map(|motion| numbering.master_equation(motion)).collect();
        let places = |hex: &[usize; 8]| hex.map(|node| numbering.place(node));
        // elements by place
        let mut ends = vec![0_usize; count + 1];
        for place in mesh.hexes.iter().flat_map(places).flatten() {
            ends[place + 1] += 1;
        }
        (0..count).for_each(|place| ends[place + 1] += ends[place]);
        let mut elements = vec![0_u32; ends[count]];
        let mut beside_followers = Vec::new();
        for (e, hex) in mesh.hexes.iter().enumerate() {
            for place in places(hex).into_iter().flatten() {
                elements[ends[place]] = e as u32;
                ends[place] += 1;
            }
            if !masters.is_empty() && hex.iter().any(|&node| numbering.follows(node)) {
                beside_followers.extend(places(hex).into_iter().flatten());
            }
        }
        beside_followers.sort_unstable();
        beside_followers.dedup();
        let (mut starts, mut rows) = (Vec::with_capacity(count + 1), Vec::new());
        starts.push(0);
        let mut column = Vec::new();
        let mut first = 0;
        for (place, &end) in ends[..count].iter().enumerate() {
            column.clear();
            for &e in &elements[first..end] {
                let above = places(&mesh.hexes[e as usize]).into_iter().flatten().filter(|&row| row <= place);
                column.extend(above);
            }
            column.sort_unstable();
            column.dedup();
            rows.extend_from_slice(&column);
            starts.push(rows.len());
            first = end;
        }
        Self { starts, rows, masters, beside_followers }
    }

    /// Number of places.
    pub fn places(&self) -> usize {
        self.starts.len() - 1
    }
}

/// The upper triangle of a matrix on its way.
pub(super) struct UpperMatrix {
    pattern: Pattern,
    /// Where the rows of every equation begin, and an end.
    starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
}

impl UpperMatrix {
    /// A matrix of zeros.
    pub fn new(pattern: Pattern) -> Self {
        let (mut starts, mut rows) = (vec![0], Vec::with_capacity(9 * pattern.rows.len()));
        for place in 0..pattern.places() {
            let above = &pattern.rows[pattern.starts[place]..pattern.starts[place + 1]];
            for direction in 0..3 {
                for &row in above {
                    let last = if row == place { direction } else { 2 };
                    rows.extend((0..=last).map(|d| 3 * row + d));
                }
                starts.push(rows.len());
            }
        }
        for (n, _) in pattern.masters.iter().enumerate() {
            rows.extend(pattern.beside_followers.iter().flat_map(|place| 3 * place..3 * place + 3));
            rows.extend_from_slice(&pattern.masters[..=n]);
            starts.push(rows.len());
        }
        let values = vec![0.0; rows.len()];
        Self { pattern, starts, rows, values }
    }

    /// Adds the matrix of an element.
    pub fn add(
        &mut self,
        mesh: &HexMesh,
        numbering: &Numbering,
        hex: &[usize; 8],
        element: &brick::Stiffness,
    ) {
        if !self.pattern.masters.is_empty() && hex.iter().any(|&node| numbering.follows(node)) {
            return self.add_followers(mesh, numbering, hex, element);
        }
        let places = hex.map(|node| numbering.place(node));
        for (j, column) in places.iter().enumerate() {
            let Some(column) = *column else { continue };
            let first = self.pattern.starts[column];
            let above = &self.pattern.rows[first..self.pattern.starts[column + 1]];
            for (i, row) in places.iter().enumerate() {
                let Some(row) = row.filter(|row| *row <= column) else { continue };
                let Ok(place) = above.binary_search(&row) else { unreachable!("nodes of one element") };
                for c in 0..3 {
                    let from = self.starts[3 * column + c] + 3 * place;
                    let last = if row == column { c } else { 2 };
                    for r in 0..=last {
                        self.values[from + r] += element[(3 * i + r, 3 * j + c)];
                    }
                }
            }
        }
    }

    /// Adds the matrix of an element of which nodes follow the master.
    fn add_followers(
        &mut self,
        mesh: &HexMesh,
        numbering: &Numbering,
        hex: &[usize; 8],
        element: &brick::Stiffness,
    ) {
        let terms: Vec<_> =
            (0..24).map(|i| numbering.terms(hex[i / 3], &mesh.nodes[hex[i / 3]], i % 3)).collect();
        for (j, (columns, column_count)) in terms.iter().enumerate() {
            for &(column, b) in &columns[..*column_count] {
                let first = self.starts[column];
                let above = &self.rows[first..self.starts[column + 1]];
                for (i, (rows, row_count)) in terms.iter().enumerate() {
                    for &(row, a) in rows[..*row_count].iter().filter(|(row, _)| *row <= column) {
                        let Ok(place) = above.binary_search(&row) else {
                            unreachable!("nodes of one element")
                        };
                        self.values[first + place] += a * b * element[(i, j)];
                    }
                }
            }
        }
    }

    /// Adds to a value on the diagonal, the last of its column.
    pub fn add_diagonal(&mut self, equation: usize, value: f64) {
        self.values[self.starts[equation + 1] - 1] += value;
    }

    /// Leaves of the equations that stay at zero their diagonal alone.
    pub fn part(&mut self, numbering: &Numbering) {
        for column in 0..self.starts.len() - 1 {
            let alone = numbering.is_at_rest(column);
            for entry in self.starts[column]..self.starts[column + 1] {
                let row = self.rows[entry];
                if row != column && (alone || numbering.is_at_rest(row)) {
                    self.values[entry] = 0.0;
                }
            }
        }
    }

    /// The matrix.
    pub fn finish(self) -> SparseColMat<usize, f64> {
        let n = self.starts.len() - 1;
        drop(self.pattern);
        SparseColMat::new(SymbolicSparseColMat::new_checked(n, n, self.starts, None, self.rows), self.values)
    }
}

#[cfg(test)]
mod tests {
    use crate::mesh::{BlockOptions, mesh_block};
    use crate::solid::{Formulation, Material, Supports, System};
    use nalgebra::{DMatrix, Point3, Vector3};

    /// Source: the energy of displacements of all nodes by `expand`, element by element, in dense algebra. Goal: the matrix of a block of
    /// which nodes are held, follow a master that is free in all, some or no motions, and carry further terms on the diagonal, N/m;
    /// every entry of its pattern is above the diagonal and there once. Accuracy over the largest: ROUNDOFF.
    #[test]
    fn the_columns_have_the_sum_of_all_elements() {
        const ROUNDOFF: f64 = 1e-13;
        let mesh = mesh_block(&BlockOptions::uniform([0.05, 0.04, 0.03], [3, 4, 3])).unwrap();
        let end = |x: f64| -> Vec<usize> {
            (0..mesh.nodes.len())
                .filter(|n| (mesh.nodes[*n].x - x).abs() < 1e-9 && !mesh.contact.nodes.contains(n))
                .collect()
        };
        let furthest = mesh.nodes.iter().map(|p| p.x).fold(0.0, f64::max);
        let motions = [true, true, false, true, false, true];
        for (followers, master_free) in [
            (Vec::new(), [false; 6]),
            (end(furthest), [false; 6]),
            (end(furthest), motions),
            (end(furthest), [true; 6]),
        ] {
            let supports = Supports {
                held: mesh.foot.iter().copied().filter(|n| !followers.contains(n)).collect(),
                followers,
                master: Point3::new(0.1, 0.01, -0.02),
                master_free,
            };
            let system =
                System::new(&mesh, Material::STEEL, Formulation::IncompatibleModes, &supports).unwrap();
            let n = system.numbering.equations;
            let diagonal = [(2, 3e9), (n - 1, 7e9)];
            let matrix = system.matrix(2.0, 5e9, &diagonal).unwrap();
            let mut spread = DMatrix::<f64>::zeros(3 * mesh.nodes.len(), n);
            for equation in 0..n {
                let mut unit = vec![0.0; n];
                unit[equation] = 1.0;
                spread.column_mut(equation).copy_from_slice(&system.numbering.expand(&mesh, &unit));
            }
            let mut all = DMatrix::<f64>::zeros(spread.nrows(), spread.nrows());
            for (e, hex) in mesh.hexes.iter().enumerate() {
                let k = system.element(e, 2.0, 5e9).unwrap();
                for i in 0..24 {
                    for j in 0..24 {
                        all[(3 * hex[i / 3] + i % 3, 3 * hex[j / 3] + j % 3)] += k[(i, j)];
                    }
                }
            }
            let mut exact = spread.transpose() * all * &spread;
            diagonal.iter().for_each(|&(e, value)| exact[(e, e)] += value);
            let mut found = DMatrix::<f64>::zeros(n, n);
            for entry in matrix.triplet_iter() {
                assert!(entry.row <= entry.col);
                assert_eq!(found[(entry.row, entry.col)], 0.0);
                found[(entry.row, entry.col)] = *entry.val;
            }
            let largest = exact.amax();
            for column in 0..n {
                for row in 0..=column {
                    let difference = found[(row, column)] - exact[(row, column)];
                    assert!(difference.abs() < ROUNDOFF * largest, "{row} {column}: {difference}");
                }
            }
        }
        // a body that moves as a whole has no energy
        let system =
            System::new(&mesh, Material::STEEL, Formulation::IncompatibleModes, &Supports::default())
                .unwrap();
        let matrix = system.matrix(1.0, 0.0, &[]).unwrap();
        let moved = system.numbering.translation(&Vector3::new(1.0, -2.0, 0.5));
        let energy: f64 = matrix
            .triplet_iter()
            .map(|e| if e.row == e.col { 1.0 } else { 2.0 } * e.val * moved[e.row] * moved[e.col])
            .sum();
        let size: f64 = matrix.triplet_iter().map(|e| e.val.abs()).sum();
        assert!(energy.abs() < ROUNDOFF * size, "{energy} of {size}");
    }
}
