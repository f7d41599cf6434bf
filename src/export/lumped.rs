//! The lumped element under a load case, as a model of another program: a Python file that builds and runs it, and tables of the profiles with their strips beside it.

mod constants;
mod surfaces;
mod case;
mod model;
mod opensees;
mod exudyn;

pub(super) use case::LumpedCase;
pub(super) use exudyn::files as exudyn;
pub(super) use opensees::files as opensees;
