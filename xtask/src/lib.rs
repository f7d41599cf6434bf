//! What a developer of railspring needs and a user does not, as `cargo xtask COMMAND`.
//!
//! [`main`] runs a command, [`command`] describes all of them, [`ignored_tests`] lists the long tests, and [`prose`] counts the words of sentences.

mod workspace;
mod scaling;
mod step_times;
mod fleet;
mod bench;
mod reference;
mod ignored;
mod long;
pub mod prose;
mod half_space;
mod same_bytes;
mod cli;

pub use cli::{command, main};
pub use ignored::{IgnoredTest, ignored_tests};
pub use workspace::{Workspace, workspace};
