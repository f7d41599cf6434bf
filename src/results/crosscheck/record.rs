//! `crosscheck.json`: the comparison of the tool with independent programs on the solid model.

use std::collections::BTreeMap;

use railspring_profiles::units::KILONEWTON;
use serde::{Deserialize, Serialize};

use crate::engine::seal::Sealed;

/// Quantity: displacement of the hub against the support.
pub const HUB_DISPLACEMENT: &str = "hub displacement";
/// Quantity: tangent stiffness of load over hub displacement.
pub const TANGENT_STIFFNESS: &str = "tangent stiffness";
/// Quantity: lateral force over lateral displacement of the hub against the support, all points of the contact that carry load sticking.
pub const HORIZONTAL_STIFFNESS: &str = "horizontal stiffness";
/// Quantity: mean lateral displacement of a body's contact under lateral forces of one in all, in the proportions of the contact's.
pub const LATERAL_FLEXIBILITY: &str = "lateral flexibility";

/// `crosscheck.json`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CrosscheckRecord {
    /// Name of the study.
    pub study: String,
    /// Whether all limits hold.
    pub holds: bool,
    /// Hash of the study.
    pub input_hash: String,
    /// Version of the tool.
    pub version: String,
    /// When it began.
    pub begun_utc: String,
    /// The computer.
    pub host: String,
    /// Where the reference's numbers come from.
    pub reference: Provenance,
    /// CalculiX with its version, if it ran.
    pub calculix: Option<String>,
    /// The questions to the reference solvers.
    pub questions: Vec<Question>,
    /// The exported meshes.
    pub meshes: Vec<ExchangedMesh>,
    /// The limits and where their values come from.
    pub limits: Vec<Limit>,
    /// The tool's own load curves.
    pub curves: Vec<ToolCurve>,
    /// Quantity by quantity.
    pub checks: Vec<Check>,
    /// Times.
    pub timings: Vec<Timing>,
    /// The forces over time, of a cross-check of a load case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub in_time: Option<ForcesInTime>,
    /// Hash of all that stands above.
    #[serde(default)]
    pub content_blake3: String,
}

impl Sealed for CrosscheckRecord {
    fn seal(&mut self) -> &mut String {
        &mut self.content_blake3
    }
}

/// Vertical and lateral force of a load case by both programs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ForcesInTime {
    /// Name of the load case.
    pub case: String,
    /// Times, ms.
    pub time_ms: Vec<f64>,
    /// Each program with the steps of the study and with steps twice as long.
    pub runs: Vec<RunInTime>,
}

/// The forces of one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunInTime {
    /// `railspring`, or name and version of the reference solver.
    pub program: String,
    /// Length of its steps, µs.
    pub step_us: f64,
    /// Vertical force of the wheel on the rail, kN.
    pub p_kn: Vec<f64>,
    /// Its lateral force, kN.
    pub q_kn: Vec<f64>,
}

impl CrosscheckRecord {
    /// The worst check of each quantity of each problem and reference solver, in order of appearance, and
    /// whether all checks of that quantity hold.
    pub fn worst(&self) -> Vec<(&Check, bool)> {
        // a difference that is not a number is the worst of all
        let size = |check: &Check| if check.difference.is_nan() { f64::INFINITY } else { check.difference };
        let mut found: Vec<(&Check, bool)> = Vec::new();
        for check in &self.checks {
            let same = |c: &Check| {
                c.problem == check.problem
                    && c.quantity == check.quantity
                    && c.reference_solver == check.reference_solver
            };
            match found.iter_mut().find(|(c, _)| same(c)) {
                Some((c, holds)) => {
                    *holds &= check.holds;
                    if size(check) > size(c) {
                        *c = check;
                    }
                }
                None => found.push((check, check.holds)),
            }
        }
        found
    }

    /// The limit behind a check, with its derivation.
    pub fn limit(&self, check: &Check) -> Option<&Limit> {
        self.limits.iter().find(|limit| limit.cause == check.cause && limit.value == check.limit)
    }
}

/// A question to the reference solvers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Question {
    /// Short name, as in the exchanged files.
    pub name: String,
    /// The reference solver.
    pub reference_solver: String,
    /// The question in words.
    pub text: String,
}

/// Size of an exported mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExchangedMesh {
    /// `rail` or `wheel`.
    pub body: String,
    /// What it is for.
    pub purpose: String,
    /// Number of corner nodes.
    pub nodes: usize,
    /// Number of hexahedra.
    pub elements: usize,
    /// Three for each corner node; those of elements of second order stand with the times.
    pub degrees_of_freedom: usize,
}

/// A limit, its cause and where its value comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// Where a difference up to the limit may come from.
    pub cause: Cause,
    /// Largest difference accepted, in the measure of the checks.
    pub value: f64,
    /// What it holds for.
    pub applies_to: String,
    /// How the value is derived, in one line.
    pub derivation: String,
}

/// A load curve of the tool.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ToolCurve {
    /// Formulation of the brick.
    pub element: String,
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Load by load.
    pub points: Vec<ToolPoint>,
    /// Horizontal stiffness by preload, kN/m over kN, of a curve with friction.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub horizontal: Vec<(f64, f64)>,
}

/// One load of such a curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ToolPoint {
    /// Load, kN.
    pub load_kn: f64,
    /// Displacement of the hub against the support, mm.
    pub hub_displacement_mm: f64,
    /// Tangent stiffness, kN/m.
    pub tangent_kn_per_m: f64,
}

/// `crosscheck/differences.json`: where on the bodies the nodal displacements of tool and reference differ.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Differences {
    /// Hash of the study.
    pub input_hash: String,
    /// When the cross-check began that they belong to.
    pub begun_utc: String,
    /// One section per body.
    pub sections: Vec<SectionDifference>,
    /// Hash of all that stands above.
    #[serde(default)]
    pub content_blake3: String,
}

impl Sealed for Differences {
    fn seal(&mut self) -> &mut String {
        &mut self.content_blake3
    }
}

/// Differences on the section of a body through the place of the largest one: across the rail, or
/// half a plane through the axle of the wheel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SectionDifference {
    /// `rail` or `wheel`.
    pub body: String,
    /// Largest displacement of the whole body, mm.
    pub largest_displacement_mm: f64,
    /// Largest difference of the whole body, mm.
    pub largest_difference_mm: f64,
    /// Where that is: x, y, z, mm.
    pub largest_at_mm: [f64; 3],
    /// The same place on the section, mm: y, and z of the rail or the radius of the wheel.
    pub largest_on_section_mm: [f64; 2],
    /// Of a wheel the angle about the axle from the load to the section, degrees, positive towards
    /// the front.
    pub turned_deg: Option<f64>,
    /// The elements as the section cuts them.
    pub cells: Vec<SectionCell>,
}

/// One element on a section.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SectionCell {
    /// Corners in order, mm: y, and z of the rail or the radius of the wheel.
    pub corners_mm: Vec<[f64; 2]>,
    /// Largest difference of the corners, mm.
    #[serde(deserialize_with = "null_as_nan")]
    pub difference_mm: f64,
}

/// Where a difference may come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub enum Cause {
    /// The same equations in another order.
    Roundoff,
    /// Ends of iterations.
    Solver,
    /// Other contact formulation, element or mesh.
    Discretisation,
    /// Other idealisation.
    Model,
}

/// One quantity of the tool compared with that of a reference solver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// The problem, for instance `contact without friction`.
    pub problem: String,
    /// The quantity, for instance `hub displacement`.
    pub quantity: String,
    /// Load, kN.
    pub load_kn: Option<f64>,
    /// Unit of both values.
    pub unit: String,
    /// The tool's value.
    #[serde(deserialize_with = "null_as_nan")]
    pub tool: f64,
    /// Name and version of the reference solver.
    pub reference_solver: String,
    /// The reference solver's value; not a number (`null`) if there is none.
    #[serde(deserialize_with = "null_as_nan")]
    pub reference_value: f64,
    /// Difference by the measure of the limit (relative, unless the quantity says otherwise).
    #[serde(deserialize_with = "null_as_nan")]
    pub difference: f64,
    /// Largest difference accepted.
    pub limit: f64,
    /// Where a difference up to the limit may come from.
    pub cause: Cause,
    /// Whether the limit holds; a difference that is not a number does not.
    pub holds: bool,
}

impl Cause {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Roundoff => "roundoff",
            Self::Solver => "solver",
            Self::Discretisation => "discretisation",
            Self::Model => "model",
        }
    }
}

impl Check {
    /// A check with its verdict.
    #[allow(clippy::too_many_arguments)]
    pub fn new(
        problem: &str,
        quantity: &str,
        load: Option<f64>,
        unit: &str,
        (tool, reference_value): (f64, f64),
        reference_solver: &str,
        difference: f64,
        (limit, cause): (f64, Cause),
    ) -> Self {
        Self {
            problem: problem.into(),
            quantity: quantity.into(),
            load_kn: load.map(|l| l / KILONEWTON),
            unit: unit.into(),
            tool,
            reference_solver: reference_solver.into(),
            reference_value,
            difference,
            limit,
            cause,
            holds: difference <= limit,
        }
    }
}

/// Where a result comes from.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// The reference package.
    pub package: String,
    /// BLAKE3 of its source files.
    #[serde(default)]
    pub package_hash: String,
    /// Version of Python.
    pub python: String,
    /// Name and version of what factors the stiffness matrices.
    pub solver: String,
    /// Versions of the packages that compute.
    pub packages: BTreeMap<String, String>,
    /// SHA-256 of the exchange's input files.
    pub input_sha256: String,
    /// When it ended.
    pub date_utc: String,
    /// How long it took, s.
    pub seconds: f64,
}

/// Time of one load curve, tool and reference solver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// The problem.
    pub problem: String,
    /// Name and version of the reference solver.
    pub reference_solver: String,
    /// Degrees of freedom of the reference solver's model.
    pub degrees_of_freedom: usize,
    /// Loads, or time steps of a load case.
    pub loads: usize,
    /// Time of the tool, s.
    pub tool_seconds: f64,
    /// Time of the reference solver, s.
    pub reference_seconds: f64,
}

/// JSON knows only finite numbers and writes `null` in the place of others.
fn null_as_nan<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::NAN))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(quantity: &str, load: f64, difference: f64) -> Check {
        Check::new(
            "p",
            quantity,
            Some(load),
            "mm",
            (1.0, 1.0 + difference),
            "j",
            difference,
            (0.1, Cause::Model),
        )
    }

    fn record(checks: Vec<Check>) -> CrosscheckRecord {
        CrosscheckRecord { checks, ..CrosscheckRecord::default() }
    }

    /// The largest difference represents its quantity, one that is not a number before all others,
    /// whatever its sign; one failing load makes the quantity fail.
    #[test]
    fn the_worst_load_of_each_quantity_is_found() {
        let checks =
            vec![check("a", 1e3, 0.05), check("a", 2e3, 0.2), check("a", 3e3, 0.01), check("b", 1e3, 0.02)];
        let mut own = record(checks);
        let seen = |r: &CrosscheckRecord| -> Vec<(String, Option<f64>, bool)> {
            r.worst().into_iter().map(|(c, holds)| (c.quantity.clone(), c.load_kn, holds)).collect()
        };
        assert_eq!(seen(&own), [("a".into(), Some(2.0), false), ("b".into(), Some(1.0), true)]);
        own.checks.push(check("a", 4e3, -f64::NAN));
        own.checks.push(check("a", 5e3, 0.3));
        assert_eq!(seen(&own)[0], ("a".into(), Some(4.0), false));
    }

    /// A reference solver without an answer: the file can be read again, and the check still fails.
    #[test]
    fn an_answer_that_is_no_number_survives_the_file() {
        let own = record(vec![check("a", 1e3, f64::NAN)]);
        let read: CrosscheckRecord = serde_json::from_str(&serde_json::to_string(&own).unwrap()).unwrap();
        let check = &read.checks[0];
        assert!(check.reference_value.is_nan() && check.difference.is_nan() && !check.holds, "{check:?}");
    }
}
