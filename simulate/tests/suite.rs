//! All tests of this package that are not unit tests, in one program: they are linked once, and no core waits for the last test of a file.

mod along_the_rail;
mod examples;
mod held_ends;
mod ends_of_rails;
mod rolling;
mod transient_ending;
mod transient_hybrid;
