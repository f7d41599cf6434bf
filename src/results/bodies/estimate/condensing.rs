//! What a body takes that is condensed by itself.

use railspring_calibrate::superelement::{FactorSize, Modes, Parts};
use railspring_profiles::error::Result;

/// Bytes of a value.
pub(crate) const VALUE: f64 = 8.0;
/// Values of a factor for every equation to the power of 4/3, for a first look before there is a mesh. Measured: 20.
pub(super) const FILL: f64 = 20.0;
/// Bytes a node of a mesh, its hexahedra and the lists of its neighbours.
pub(crate) const NODE: f64 = 1.0e3;
/// Bytes of an entry of a sparse matrix: value and row, and its share of the pattern of the nodes.
pub(crate) const ENTRY: f64 = 17.0;
/// Work space and indices of the factorisation, beside the values; measured 1.08 to 1.12.
const FACTORISATION: f64 = 1.1;
/// Bytes of the mass of a node: itself and 26 neighbours, value and column.
pub(crate) const MASS: f64 = 27.0 * 12.0;
/// Vectors beside the modes: those that are solved at the same time, and their products.
const AT_ONCE: f64 = 24.0;

/// The size of the factor of a body, and the bytes that it takes at most on the way to its condensed form with so many modes. Its mesh and the order of its
/// equations are not among these.
///
/// # Errors
/// A mesh that cannot be ordered.
pub fn condensing(parts: &Parts<'_>, modes: usize) -> Result<(FactorSize, f64)> {
    let size = parts.size()?;
    Ok((size, largest(&size, modes as f64, modes > 0)))
}

/// Bytes of a factor of so many values, with the indices and the work space of its factorisation.
pub(crate) fn factor(values: usize) -> f64 {
    FACTORISATION * VALUE * values as f64
}

/// The largest of the stages of a body: factorisation, condensation, modes, and the compliance of the whole from those of its parts. `kept`: the
/// factor is.
pub(crate) fn largest(size: &FactorSize, modes: f64, kept: bool) -> f64 {
    let parts = size.parts as f64;
    let dense = VALUE * (size.retained as f64).powi(2);
    let of_part = dense / parts.powi(2);
    let equations = size.equations as f64 / parts;
    // those of the first part are more
    let modes = if size.parts > 1 { Modes::of_halves(modes as usize)[0] as f64 } else { modes };
    let vectors =
        if modes > 0.0 { (modes + AT_ONCE) * VALUE * equations + MASS * equations / 3.0 } else { 0.0 };
    // the compliances of the parts before
    let before = (parts - 1.0) * of_part;
    let matrix = ENTRY * size.entries as f64;
    let joined = if size.parts > 1 { dense + parts * of_part } else { 0.0 };
    let stages = if kept {
        // the upper triangle and the lower one, from which the factor is made
        let making = before + 2.0 * matrix + VALUE * size.beside as f64;
        [making, before + 2.0 * of_part, of_part + vectors].map(|beside| factor(size.values) + beside)
    } else {
        [before + matrix + factor(size.alone), before + 2.0 * of_part, 0.0]
    };
    stages.into_iter().fold(joined, f64::max)
}

/// Bytes of a reduced body in so many `runs` in time: its compliance, which they share, and the far field and the shapes of each.
pub fn stepping(size: &FactorSize, modes: usize, runs: usize) -> f64 {
    let (rows, modes, runs) = (size.retained as f64, modes as f64, runs as f64);
    VALUE * ((1.0 + runs) * rows * rows + 2.0 * runs * rows * modes)
}

/// Bytes of the contact of a step on a fine grid, besides its bodies: the factor of some 700 points that carry load in three directions. Measured: 35 MiB.
pub const CONTACT_OF_STEP: f64 = VALUE * 2100.0 * 2100.0;

/// Bytes that meshes with so many degrees of freedom and one of their factors take at least, before there is a mesh.
pub fn least_memory(degrees_of_freedom: usize) -> f64 {
    /// Share of the values of a first look that bodies have which are refined.
    const LESS: f64 = 0.5;
    let degrees_of_freedom = degrees_of_freedom as f64;
    NODE * degrees_of_freedom / 3.0 + LESS * VALUE * FILL * degrees_of_freedom.powf(4.0 / 3.0)
}
