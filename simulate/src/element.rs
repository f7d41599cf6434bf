//! The simple model: a wheel on a rail of beams with one of two contact elements.

pub mod published;
pub mod condensed;
