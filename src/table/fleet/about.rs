//! What is known of a table beside its rows.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Map, Value};

use crate::table::rows::Rows;

/// What the rows do not say of their table.
#[derive(Debug, Clone, Default)]
pub struct About<'a> {
    /// Its name.
    pub name: &'a str,
    /// What it is about.
    pub description: &'a str,
    /// Names of the measured wheels.
    pub wheels: BTreeSet<String>,
    /// Names of the measured rails.
    pub rails: BTreeSet<String>,
    /// Keys of a study's `[wheel]` that make a measured wheel, by its name; files as a table beside the page would name them.
    pub keys: BTreeMap<String, Map<String, Value>>,
    /// All other keys of the table but name, description, wheels and cases, likewise.
    pub table: Map<String, Value>,
    /// The rows of an earlier table of the fleet.
    pub earlier: Option<&'a Rows>,
}
