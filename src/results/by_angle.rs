//! The laws by contact angle, and the condensed contact element.

pub mod element;
pub mod input;
pub mod record;
pub mod columns;
pub mod make;
pub mod figure;
pub mod statics_figure;
pub mod stage;
