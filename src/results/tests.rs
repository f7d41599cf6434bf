//! Tests of several results together.

mod inputs;
mod worn;
mod zones;
