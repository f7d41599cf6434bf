//! The JSON schemas of the study file and of other documents.

use std::sync::OnceLock;

use super::document::StudyDocument;

/// The JSON schema of the study file.
pub fn schema() -> serde_json::Value {
    study_schema().clone()
}

pub(super) fn study_schema() -> &'static serde_json::Value {
    static SCHEMA: OnceLock<serde_json::Value> = OnceLock::new();
    SCHEMA.get_or_init(schema_of::<StudyDocument>)
}

/// The JSON schema of a document.
pub(crate) fn schema_of<T: schemars::JsonSchema>() -> serde_json::Value {
    serde_json::to_value(schemars::schema_for!(T)).expect("a schema is plain JSON")
}
