//! The bodies of a study: sections in the track, meshes, condensed bodies, and what they cost.

pub mod touch;
pub mod record;
pub mod reach;
pub mod surface_figure;
pub mod outline_figure;
pub mod profile_view;
pub mod on_standard;
pub mod measured;
pub mod sections;
pub mod input;
pub mod geometry;
pub mod mesh_files;
pub mod meshes;
pub mod zones;
pub mod solids;
pub mod coarser;
pub mod other_solids;
pub mod places;
pub mod others;
pub mod source;
pub mod estimate;
pub mod in_work;
