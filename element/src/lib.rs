#![doc = include_str!("../README.md")]

pub mod curve;
pub mod relief;
pub mod modulus;
pub mod overlap;
pub mod strips;
pub mod law;
pub mod wheel;
pub mod held_end;
pub mod head;
pub mod pair_element;
pub mod outline;
pub mod contacts;
pub mod step;
pub mod element;
pub mod file;
pub mod contact;
mod modal;
pub mod unit;
pub mod variables;

#[cfg(test)]
mod tests;
