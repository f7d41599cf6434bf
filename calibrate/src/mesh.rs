//! Meshes of 8-node hexahedra of a rail, a wheel and a test block, graded
//! towards the contact zone.
//!
//! A plane section is meshed with quadrilaterals (`SectionMesh`) and swept:
//! the rail along the track, the wheel about its axle. Under the contact zone
//! lie structured layers that follow the running surface; below them the
//! elements grow towards the coarse sizes of [`MeshOptions`].
//!
//! ```text
//!   section (y right, z down)            sweep (x, or arc length at the tread)
//!      ooooooooooo  contact zone         |    |  | |||||||| |  |    |
//!     /-+-+-+-+-+-\ layers                  growth   window   growth
//!     \ /\_/\_/\_ /
//!      |         |  grows to the coarse size
//! ```
//!
//! The same input gives the same mesh to the last bit: every choice between
//! equals is settled by index order.

mod faces;
mod hex_mesh;
mod quality;
mod sizing;
mod triangulation;
mod smoothing;
mod section_mesh;
mod options;
mod sweep;
mod block;
mod bodies;
mod given_surface;
mod given;
mod vtu;

pub use block::{BlockOptions, mesh_block};
pub use bodies::{
    MeshSize, least_rail_size, least_wheel_size, mesh_even_rail, mesh_rail, mesh_rail_between,
    mesh_rail_path, mesh_wheel, rail_grid_half_length, rail_outline, rail_size, wheel_outline, wheel_size,
};
pub use given::{GivenMesh, given_rail, given_wheel};
pub use hex_mesh::{HexMesh, SurfaceGrid};
pub use options::{ContactZone, MeshOptions};
pub(crate) use quality::CORNERS;
pub use quality::{Quality, quality};
pub(crate) use section_mesh::{SectionMesh, mesh_section};
pub use section_mesh::{SectionOutline, SurfacePoint};
pub use vtu::{Cells, Field, pvd, vtu};
