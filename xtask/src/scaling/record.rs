//! `scaling.json` and `scaling.csv`: time and memory of the solid model over its degrees of freedom.

use railspring::engine::measured::MachineRecord;
use railspring::engine::output::to_csv;
use serde::{Deserialize, Serialize};

/// What both bodies share, in tables.
pub const BOTH: &str = "both bodies";

/// `scaling.json`: all sizes that are finished, and what grows with which power.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScalingRecord {
    /// Name of the study.
    pub study: String,
    /// When the sweep began, UTC.
    pub begun_utc: String,
    /// What it ran on.
    pub machine: MachineRecord,
    /// Number of threads.
    pub threads: usize,
    /// Modes of each body.
    pub modes: usize,
    /// The sizes, ascending.
    pub sizes: Vec<ScalingSize>,
    /// Sizes that the memory does not hold.
    pub skipped: Vec<SkippedSize>,
    /// Powers of the degrees of freedom.
    pub exponents: Vec<ExponentRecord>,
}

/// One size of the bodies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScalingSize {
    /// Degrees of freedom that were asked for.
    pub wanted: usize,
    /// Equations of rail and wheel together.
    pub degrees_of_freedom: usize,
    /// By what the elements of the bodies are smaller than those of the study.
    pub refined: f64,
    /// Speed of the dense product at that time, 10⁹ operations a second on one thread.
    pub product_gflops: f64,
    /// The rail between its ends, and the wheel.
    pub bodies: Vec<ScalingBody>,
    /// What both bodies share: the mesh, a load, a step.
    pub stages: Vec<ScalingStage>,
    /// Largest resident memory of the program, MiB: expected before the bodies were assembled, and found.
    pub memory: PredictedRecord,
    /// Why a stage has no measure.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

/// A number as it was predicted and as it was found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PredictedRecord {
    /// Before, MiB.
    pub predicted_mib: f64,
    /// Afterwards, MiB; none where the system does not say.
    pub found_mib: Option<f64>,
}

/// One body of a size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScalingBody {
    /// Its name.
    pub body: String,
    /// Nodes of its mesh.
    pub nodes: usize,
    /// Equations.
    pub degrees_of_freedom: usize,
    /// Equations that are retained.
    pub retained: usize,
    /// Values in its factor.
    pub factor_values: usize,
    /// Multiplications of its factorisation.
    pub multiplications: f64,
    /// Speed of the factorisation over that of the dense product.
    pub share_of_product: f64,
    /// Its stages in their order.
    pub stages: Vec<ScalingStage>,
}

/// Time and memory of a stage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScalingStage {
    /// Name: `mesh`, `ordering`, `assembly`, `factorisation`, `condensation`, `modes`, `one load` or `one step`.
    pub stage: String,
    /// Wall clock, s.
    pub seconds: f64,
    /// Largest resident memory of the program during the stage, MiB; none where the system does not say.
    pub peak_memory_mib: Option<f64>,
}

/// A size that was left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SkippedSize {
    /// Degrees of freedom that were asked for.
    pub wanted: usize,
    /// Memory that it would take, GiB.
    pub needed_gib: f64,
    /// Memory that there is, GiB.
    pub available_gib: f64,
}

/// A power of the degrees of freedom, fitted by least squares in logarithms.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExponentRecord {
    /// What grows.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
    /// Whose degrees of freedom: `both bodies` or the name of one.
    pub of: String,
    /// The exponent.
    pub exponent: f64,
    /// Its standard error; none for two sizes.
    pub standard_error: Option<f64>,
    /// The fitted value at 100,000 degrees of freedom.
    pub at_100k: f64,
    /// Number of sizes.
    pub sizes: usize,
}

impl SkippedSize {
    /// A larger size that is left out as well: factors grow with the power 4/3 of the degrees of freedom.
    #[must_use]
    pub fn grown(&self, wanted: usize) -> Self {
        let ratio = wanted as f64 / self.wanted as f64;
        Self { wanted, needed_gib: self.needed_gib * ratio.powf(4.0 / 3.0), ..self.clone() }
    }
}

impl ScalingSize {
    /// Seconds of a stage, of both bodies together where each has it.
    pub fn seconds(&self, stage: &str) -> Option<f64> {
        let found: Vec<f64> = self.stages_named(stage).map(|stage| stage.seconds).collect();
        (!found.is_empty()).then(|| found.iter().sum())
    }

    /// Values in the factors of both bodies.
    pub fn factor_values(&self) -> f64 {
        self.bodies.iter().map(|body| body.factor_values as f64).sum()
    }

    /// Multiplications of both factorisations.
    pub fn multiplications(&self) -> f64 {
        self.bodies.iter().map(|body| body.multiplications).sum()
    }

    fn stages_named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a ScalingStage> {
        let of_bodies = self.bodies.iter().flat_map(|body| &body.stages);
        of_bodies.chain(&self.stages).filter(move |stage| stage.stage == name)
    }
}

/// A row of `scaling.csv`.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Row<'a> {
    degrees_of_freedom: usize,
    body: &'a str,
    body_degrees_of_freedom: usize,
    stage: &'a str,
    seconds: f64,
    peak_memory_mib: Option<f64>,
}

impl ScalingRecord {
    /// A row for each stage of each body and size.
    pub fn csv(&self) -> Vec<u8> {
        let mut rows = Vec::new();
        for size in &self.sizes {
            let of_bodies =
                size.bodies.iter().map(|body| (body.body.as_str(), body.degrees_of_freedom, &body.stages));
            for (body, of, stages) in of_bodies.chain([(BOTH, size.degrees_of_freedom, &size.stages)]) {
                rows.extend(stages.iter().map(|stage| Row {
                    degrees_of_freedom: size.degrees_of_freedom,
                    body,
                    body_degrees_of_freedom: of,
                    stage: &stage.stage,
                    seconds: stage.seconds,
                    peak_memory_mib: stage.peak_memory_mib,
                }));
            }
        }
        to_csv(&rows)
    }
}
