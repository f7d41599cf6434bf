//! The motion of a track, and rows that give displacements from it.

use crate::time::newmark::Motion;

use super::structure::Row4;

/// A row that gives a displacement from both nodes of an element.
pub(super) type Rows<const N: usize> = [[f64; N]; 2];

/// Motion of a track against the ground.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TrackState<const N: usize> {
    pub(super) displacements: Vec<[f64; N]>,
    pub(super) velocities: Vec<[f64; N]>,
    pub(super) accelerations: Vec<[f64; N]>,
    /// The masses between layers; at rest where there is none.
    pub(super) masses: Vec<Motion>,
}

#[cfg(test)]
impl<const N: usize> TrackState<N> {
    /// All numbers of a state, those of a unit together.
    pub fn numbers(&self) -> Vec<Vec<f64>> {
        let of = |nodes: &[[f64; N]], of_mass: fn(&Motion) -> f64| {
            let every = |first: usize| nodes.as_flattened().iter().skip(first).step_by(2).copied();
            [every(0).chain(self.masses.iter().map(of_mass)).collect::<Vec<_>>(), every(1).collect()]
        };
        let all = [
            of(&self.displacements, |mass| mass.u),
            of(&self.velocities, |mass| mass.v),
            of(&self.accelerations, |mass| mass.a),
        ];
        all.into_iter().flatten().collect()
    }
}

pub(super) fn dot<const N: usize>(row: &Rows<N>, nodes: &[[f64; N]], element: usize) -> f64 {
    let one = |row: &[f64; N], node: &[f64; N]| (0..N).map(|i| row[i] * node[i]).sum::<f64>();
    one(&row[0], &nodes[element]) + one(&row[1], &nodes[element + 1])
}

pub(super) fn add<const N: usize>(row: &Rows<N>, nodes: &mut [[f64; N]], element: usize, force: f64) {
    for (node, row) in row.iter().enumerate() {
        (0..N).for_each(|i| nodes[element + node][i] += force * row[i]);
    }
}

/// A row of a beam whose degrees of freedom begin at `first`.
pub(super) fn spread<const N: usize>([a, b, c, d]: Row4, first: usize) -> Rows<N> {
    let mut rows = [[0.0; N]; 2];
    [rows[0][first], rows[0][first + 1], rows[1][first], rows[1][first + 1]] = [a, b, c, d];
    rows
}
