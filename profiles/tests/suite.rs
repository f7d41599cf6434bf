//! All tests of this package that are not unit tests, in one program: they are linked once, and no core waits for the last test of a file.

mod contact_parameters;
mod en15302;
mod first_touch;
mod joined;
mod profile_contents;
mod profile_dialects;
mod profile_drawings;
mod profile_mutation;
mod profile_placement;
mod profile_scatter;
mod profile_slices;
mod profiles;
mod rigid_contact;
mod sections;
