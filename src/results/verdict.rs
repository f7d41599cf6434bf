//! The verdict on the simple model and on the springs.

pub mod validation;
pub mod validation_figure;
pub mod input_bands;
pub mod record;
pub mod input;
pub mod tables;
pub mod running_table;
pub mod reasons;
pub mod law_lines;
pub mod requirements;
pub mod judged;
pub mod stage;
