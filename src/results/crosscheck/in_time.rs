//! The solid model in time against a reference solver: a load case, solved again with other matrices, another
//! integration, another search of the contact and another solution of its conditions.
//!
//! * [`mod@input`]: the load case, and what of it the reference can repeat;
//! * [`mod@tool`]: the tool's own run, of bodies at full order;
//! * [`mod@compare`]: the forces of both, with limits and their causes;
//! * [`mod@stage`]: asking, and the record.

pub mod input;
pub mod tool;
mod question;
pub mod compare;
mod make;
pub mod stage;
