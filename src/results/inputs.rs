//! `inputs.json`: the keys of the study that the results of a folder were made from.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::study::ResolvedKey;

/// Name of the file.
pub const INPUTS: &str = "inputs.json";

/// `inputs.json`: what the study says, its defaults included, so that results can be compared without their study files.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InputsRecord {
    /// Name of the study.
    pub study: String,
    /// What it is about.
    pub description: String,
    /// Its keys, those that are not given as well.
    pub keys: Vec<ResolvedKey>,
    /// Hash of what the calibration depends on, the program included, as in `stiffness.json`.
    pub calibration: String,
    /// Version of the program that made the results.
    pub version: String,
    /// The commit that the program was built from.
    pub commit: String,
}
