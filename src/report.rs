//! Drawing alone: axes, panels, legends, pages from templates.

pub mod plot;
pub mod legend;
pub mod number;
pub mod panel;
pub mod bars;
pub mod html;
pub mod accessible;
pub mod collector;
pub mod catalogue;
