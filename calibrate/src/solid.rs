//! Linear elastic solids of eight-node bricks.
//!
//! [`Materials`] and their `Formulation` give the elements, [`Supports`] says which nodes
//! are held or follow the master node, and [`System`] numbers the equations
//! and assembles them.

mod material;
mod brick;
mod locate;
mod materials;
mod numbering;
mod mirror;
mod columns;
mod assembly;
mod stress;

pub use assembly::{NodalMass, System};
pub use brick::Formulation;
pub use columns::Pattern;
pub use locate::Cut;
pub use material::Material;
pub use materials::Materials;
pub use mirror::{MirrorHalf, Symmetry};
pub use numbering::{Numbering, Supports, rigid_motion};
pub use stress::{largest_shear, nodal_stress, von_mises};
