//! How large the factor of a body will be, before anything is assembled.

use super::elimination::Fronts;
use crate::mesh::HexMesh;
use crate::solid::{Numbering, Pattern};
use faer::Side;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::{SupernodalThreshold, SymbolicSupernodalParams};
use railspring_profiles::error::{NumericsError, Result, StopReason};

/// Size of a body's matrix and of its factor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FactorSize {
    /// In how many parts the body is factored, one after the other: 2 of one that is its own mirror image.
    pub parts: usize,
    /// Equations.
    pub equations: usize,
    /// Equations that are retained: those of the contact nodes.
    pub retained: usize,
    /// Entries of the upper triangle of the matrix of a part.
    pub entries: usize,
    /// Values stored in the factor of a part.
    pub values: usize,
    /// The most values at a time of a part of which the compliance alone is wanted.
    pub alone: usize,
    /// The most beside those of the factor, where that is kept.
    pub beside: usize,
    /// Values stored in the factor of the equations of a part that are not retained.
    pub inside: usize,
    /// Multiplications of all factorisations.
    pub multiplications: f64,
}

impl FactorSize {
    /// Counts the factor of a body by the graph of its nodes: the three equations of a node have the same neighbours.
    /// The free motions of a master node, six at most, are left out.
    ///
    /// # Errors
    /// A mesh that cannot be ordered.
    pub fn of(mesh: &HexMesh, numbering: &Numbering) -> Result<Self> {
        let Pattern { starts, rows, .. } = Pattern::new(mesh, numbering);
        let count = starts.len() - 1;
        let pattern = SymbolicSparseColMatRef::new_checked(count, count, &starts, None, &rows);
        // supernodes of equations are merged up to 4, 16 and 48 columns; here a column is three equations
        let relax = [(1, 1.0), (5, 0.8), (16, 0.1), (usize::MAX, 0.05)];
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            supernodal_params: SymbolicSupernodalParams { relax: Some(&relax) },
            ..Default::default()
        };
        let failed = || NumericsError::new("size of the factor", StopReason::Singular, f64::NAN, 0);
        let symbolic = factorize_symbolic_cholesky(pattern, Side::Upper, SymmetricOrdering::Identity, params)
            .map_err(|_| failed())?;
        let SymbolicCholeskyRaw::Supernodal(nodes) = symbolic.raw() else {
            unreachable!("the supernodal form is forced")
        };
        let below = nodes.col_ptr_for_row_idx();
        let multiplications = (0..nodes.n_supernodes())
            .map(|s| {
                let columns = 3 * (nodes.supernode_end()[s] - nodes.supernode_begin()[s]);
                let height = columns + 3 * (below[s + 1] - below[s]);
                // column k updates the triangle of the rows below it
                (height - columns..height).map(|rest| 0.5 * (rest * rest) as f64).sum::<f64>()
            })
            .sum();
        let inside = numbering.interior / 3;
        let fronts = Fronts::new(&symbolic, inside);
        let values_inside = |s: usize| {
            let (begin, end) = (nodes.supernode_begin()[s], nodes.supernode_end()[s].min(inside));
            let rows = &nodes.row_idx()[below[s]..below[s + 1]];
            end.saturating_sub(begin)
                * (end.saturating_sub(begin) + rows.partition_point(|row| *row < inside))
        };
        Ok(Self {
            parts: 1,
            equations: 3 * count,
            retained: numbering.contact,
            // of the nine products of two nodes all, of those of a node with itself the upper six
            entries: 9 * rows.len() - 3 * count,
            values: 9 * symbolic.len_val(),
            alone: fronts.most_values(3, false),
            beside: fronts.most_values(3, true),
            inside: 9 * (0..nodes.n_supernodes()).map(values_inside).sum::<usize>(),
            multiplications,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{BlockOptions, mesh_block};
    use crate::solid::{Formulation, Material, Supports, System};
    use crate::superelement::{Interior, Superelement};

    /// Source: the factor itself. Goal: equations and entries exactly; stored values within what merging columns in
    /// threes instead of one by one changes; the same for the factor of the inside.
    #[test]
    fn the_size_is_that_of_the_factor() {
        const MERGING: f64 = 0.05;
        for divisions in [[6, 5, 4], [14, 10, 12]] {
            let mesh = mesh_block(&BlockOptions::uniform([0.05, 0.04, 0.03], divisions)).unwrap();
            let supports = Supports { held: mesh.foot.clone(), ..Default::default() };
            let solid =
                || System::new(&mesh, Material::STEEL, Formulation::IncompatibleModes, &supports).unwrap();
            let system = solid();
            let size = FactorSize::of(&mesh, &system.numbering).unwrap();
            let matrix = system.matrix(1.0, 0.0, &[]).unwrap();
            let inside = Interior::new(solid()).unwrap().stored_values() as f64;
            assert!((size.inside as f64 / inside - 1.0).abs() < MERGING, "{} {inside}", size.inside);
            assert_eq!((size.equations, size.entries), (matrix.ncols(), matrix.compute_nnz()));
            let element = Superelement::new(system).unwrap();
            assert_eq!(size.retained, element.compliance.nrows());
            let stored = element.factor.stored_values() as f64;
            assert!((size.values as f64 / stored - 1.0).abs() < MERGING, "{} {stored}", size.values);
            // as many as for a dense matrix at most, and at least those of the retained block
            let (all, retained) = (size.equations as f64, size.retained as f64);
            assert!(
                size.multiplications < all.powi(3) / 6.0 && size.multiplications > retained.powi(3) / 6.0
            );
        }
    }
}
