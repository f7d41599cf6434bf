//! The laws by contact angle, and the contact elements that are made from the solids.

pub mod element;
pub mod lumped;
pub mod input;
pub mod record;
pub mod columns;
pub mod make;
pub mod figure;
pub(crate) mod lumped_table;
pub mod statics_figure;
pub mod stage;
