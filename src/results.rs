//! The results of a study, each in a folder of its own: what it is made from, how, what its files hold, and its figures.

pub mod names;
pub mod bodies;
pub mod patches;
pub mod springs;
pub mod by_angle;
pub mod run;
pub mod verdict;
pub mod crosscheck;
pub mod self_test;
pub mod page;
pub mod inputs;
pub mod files;
pub mod study_run;
pub mod stored;
pub mod commands;
#[cfg(test)]
pub(crate) mod samples;
#[cfg(test)]
mod tests;
