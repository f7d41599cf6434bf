//! How results are had and kept: stages, the store, output folders with their lists, measures.
//!
//! Nothing here knows a result: its folder of [`crate::results`] has what it is made from, how, and which files it becomes.

pub mod inputs;
pub mod output;
pub mod columns;
pub mod list;
pub mod store;
pub mod measured;
pub mod measure;
pub mod seal;
pub mod stage;
