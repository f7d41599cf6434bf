//! What springs hang on that was assumed: bodies and places of measured profiles of which nothing is said.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::rounding::{significant, with_minus_signs};

/// Name of the reference that is the approach of the surfaces alone.
const LOCAL: &str = "local";

/// What was assumed of the bodies, and what others in their place do.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AssumedRecord {
    /// What was assumed, a sentence each.
    pub assumed: Vec<String>,
    /// The keys that say it otherwise.
    pub keys: Vec<String>,
    /// Other bodies or places, each pressed in the place of the assumed one.
    pub others: Vec<OtherRecord>,
    /// How far displacement and tangent may be from those of the springs, with every reference: the changes of the rail's bodies, of the wheel's and of
    /// the places, the largest of each added up.
    pub references: Vec<AssumedReference>,
    /// The horizontal stiffness may be between these two, kN/m; none where the springs have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub horizontal_kn_per_m: Option<[f64; 2]>,
    /// Others that came to no answer, and why.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub missing: Vec<String>,
}

impl AssumedRecord {
    /// What was assumed, in a sentence.
    pub fn sentence(&self) -> String {
        format!("assumed: {}", self.assumed.join("; "))
    }

    /// How far the springs may be off for that, in a sentence.
    pub fn range(&self, reference: &str) -> String {
        format!("other bodies and places: {}", self.ranges(reference))
    }

    /// The same without what it is about: with the law's reference, of the approach alone, and the horizontal stiffness.
    pub fn ranges(&self, reference: &str) -> String {
        let signed = |value: f64| {
            let sign = if value < 0.0 { "-" } else { "+" };
            with_minus_signs(&format!("{sign}{}", significant(1e2 * value.abs(), 2)))
        };
        let of = |reference: &str| {
            let of = self.of(reference)?;
            let [less, more] = of.displacement;
            let [softer, stiffer] = of.tangent;
            Some(format!(
                "{reference} displacement {} to {} %, tangent {} to {} %",
                signed(less),
                signed(more),
                signed(softer),
                signed(stiffer)
            ))
        };
        let references = [Some(reference), Some(LOCAL).filter(|local| *local != reference)];
        let mut parts: Vec<String> = references.into_iter().flatten().filter_map(of).collect();
        parts.extend(self.horizontal_kn_per_m.map(|[least, most]| {
            format!("k_h between {} and {} kN/m", significant(least, 2), significant(most, 2))
        }));
        if !self.missing.is_empty() {
            parts.push(format!("without {}, which have no result", self.missing.join(" and ")));
        }
        parts.join("; ")
    }

    /// The keys that say it otherwise, in a sentence.
    pub fn given_by(&self) -> String {
        format!("keys that give them: {}", self.keys.join(", "))
    }

    /// What may be of the springs with a reference.
    pub fn of(&self, reference: &str) -> Option<&AssumedReference> {
        self.references.iter().find(|of| of.reference == reference)
    }
}

/// A body or a place in the place of the assumed one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OtherRecord {
    /// `rail`, `wheel`, `roll` of the head or lateral `shift` of the wheel.
    pub part: String,
    /// What it is.
    pub name: String,
    /// Largest relative change of the displacement over the loads, with its sign, by reference.
    pub displacement: Vec<(String, f64)>,
    /// Largest relative change of the tangent over the loads, with its sign, by reference.
    pub tangent: Vec<(String, f64)>,
    /// Relative change of the horizontal stiffness.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub horizontal: Option<f64>,
}

/// How far springs with a reference may be from what they are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AssumedReference {
    /// What the displacement is measured against.
    pub reference: String,
    /// Relative change of the displacement: the least and the greatest.
    pub displacement: [f64; 2],
    /// Relative change of the tangent: the least and the greatest.
    pub tangent: [f64; 2],
}
