//! The verdict on the simple model and on the springs.

pub mod input_bands;
pub mod record;
pub mod input;
pub mod tables;
pub mod reasons;
pub mod law_lines;
pub mod judged;
pub mod stage;
