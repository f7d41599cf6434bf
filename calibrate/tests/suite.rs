//! All tests of this package that are not unit tests, in one program: they are linked once, and no core waits for the last test of a file.

mod conical;
mod contact;
mod contact_solver;
mod error_band;
mod examples;
mod half_spaces;
mod hybrid;
mod layered;
mod law_by_shift;
mod lines_and_arcs;
mod mesh_depth;
mod off_centre;
mod pair;
mod patch;
mod press;
mod press_direction;
mod profile_files;
mod section_analysis;
mod section_motion;
mod shared_bodies;
mod solids;
mod standards;
mod two_materials;
mod uncertainty;
