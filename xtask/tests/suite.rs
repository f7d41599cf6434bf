//! All tests of this package that are not unit tests, in one program: they are linked once.

mod bench;
mod documents;
mod prose;
mod reference;
