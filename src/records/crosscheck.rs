//! `crosscheck.json`: what independent judges say about the solid model.

use std::collections::BTreeMap;

use railspring_calibrate::units::KILONEWTON;
use serde::{Deserialize, Serialize};

/// Quantity: displacement of the hub against the support.
pub const HUB_DISPLACEMENT: &str = "hub displacement";
/// Quantity: tangent stiffness of load over hub displacement.
pub const TANGENT_STIFFNESS: &str = "tangent stiffness";

/// `crosscheck.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    /// Quantity by quantity.
    pub checks: Vec<Check>,
    /// Times.
    pub timings: Vec<Timing>,
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

/// One quantity of the tool against one of a judge.
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
    pub tool: f64,
    /// Who judged.
    pub judge: String,
    /// The judge's value.
    pub judged: f64,
    /// Difference by the measure of the limit (relative, unless the quantity says otherwise).
    pub difference: f64,
    /// Largest difference accepted.
    pub limit: f64,
    /// Where a difference up to the limit may come from.
    pub cause: Cause,
    /// Whether the limit holds; a difference that is not a number does not.
    pub holds: bool,
}

impl Check {
    /// A check with its verdict.
    #[allow(clippy::too_many_arguments)]
    pub fn new(
        problem: &str,
        quantity: &str,
        load: Option<f64>,
        unit: &str,
        (tool, judged): (f64, f64),
        judge: &str,
        difference: f64,
        (limit, cause): (f64, Cause),
    ) -> Self {
        Self {
            problem: problem.into(),
            quantity: quantity.into(),
            load_kn: load.map(|l| l / KILONEWTON),
            unit: unit.into(),
            tool,
            judge: judge.into(),
            judged,
            difference,
            limit,
            cause,
            holds: difference <= limit,
        }
    }
}

/// Where a result comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// The reference package.
    pub package: String,
    /// Version of Python.
    pub python: String,
    /// Versions of the packages that compute.
    pub packages: BTreeMap<String, String>,
    /// SHA-256 of the exchange's input files.
    pub input_sha256: String,
    /// When it ended.
    pub date_utc: String,
    /// How long it took, s.
    pub seconds: f64,
}

/// Time of one load curve, tool and judge.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// The problem.
    pub problem: String,
    /// Who judged.
    pub judge: String,
    /// Degrees of freedom of the judge's model.
    pub degrees_of_freedom: usize,
    /// Loads.
    pub loads: usize,
    /// Time of the tool, s.
    pub tool_seconds: f64,
    /// Time of the judge, s.
    pub judge_seconds: f64,
}
