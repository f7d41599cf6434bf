//! The lumped element for other programs: as a model that runs a load case, a Python file and tables of the profiles with their strips beside it, and as the parts that a program of vehicle dynamics reads.

mod constants;
mod surfaces;
mod pair;
mod case;
mod model;
mod opensees;
mod exudyn;
mod stem;
mod gensys;
mod sid;
mod simpack;

pub(super) use case::{HIGHEST, LumpedCase};
pub(super) use exudyn::files as exudyn;
pub(super) use gensys::files as gensys;
pub(super) use opensees::files as opensees;
pub(super) use pair::LumpedPair;
pub(super) use simpack::files as simpack;
pub(super) use stem::files as stem;
pub use surfaces::LumpedContact;
