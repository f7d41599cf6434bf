//! Tests of several results together.

mod worn;
mod zones;
