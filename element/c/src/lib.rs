#![doc = include_str!("../README.md")]
//!
//! # Safety
//! What holds for all functions: a pointer is one of this library's that has not been freed, or points to as much memory as its description says; null is refused. A contact or unit is
//! used by one thread at a time, an element by any number of them.

mod guard;
pub mod types;
pub mod element;
pub mod contact;
pub mod unit;
/// cbindgen:ignore
mod fmi;

pub use guard::{RailspringCode, railspring_message, railspring_version};
