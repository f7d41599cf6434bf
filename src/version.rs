//! The version of the program, and the commit that it was built from.

/// The commit as `build.rs` found it: `commit 0123456789ab`, with `and changes` behind it where the sources were others, or that it is not known.
pub const COMMIT: &str = env!("RAILSPRING_COMMIT");

/// Version and commit, for instance `0.1.0 (commit 0123456789ab)`.
pub const FULL: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("RAILSPRING_COMMIT"), ")");
