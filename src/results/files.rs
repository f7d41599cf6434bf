//! The files of an output folder: what they hold and what is in them, for the reference.

use schemars::{JsonSchema, schema_for};
use serde_json::Value;

use crate::engine::list::RESULTS;
use crate::engine::measured::Measured;
use crate::engine::stage::MEASURED;
use crate::results::by_angle::columns::row_schema;
use crate::results::by_angle::record::{BY_ANGLE, StiffnessByAngleRecord};
use crate::results::inputs::{INPUTS, InputsRecord};
use crate::results::names::{
    BY_ANGLE_ROWS, CROSSCHECK, CROSSCHECK_PAGE, DIFFERENCES, LOAD_CURVE, PATCHES, REPORT, REPORT_PDF,
    STIFFNESS, VERIFICATION,
};
use crate::results::patches::record::PatchesRecord;
use crate::results::run::{history_csv, uncertain_record};
use crate::results::springs::record::{LoadCurveRow, StiffnessRecord};
use crate::results::verdict::record::VerificationRecord;

/// A file of an output folder, or several of a kind.
#[derive(Debug, Clone, Copy)]
pub struct ResultFile {
    /// Its name; `*` stands for the name of a load case, a figure or a number.
    pub name: &'static str,
    /// The commands that write it.
    pub made_by: &'static str,
    /// What it holds.
    pub content: &'static str,
    /// What is in it, as a JSON schema of the whole or of a row; none where that is said elsewhere.
    pub schema: Option<fn() -> Value>,
}

fn of<T: JsonSchema>() -> Value {
    schema_for!(T).to_value()
}

const fn file(name: &'static str, made_by: &'static str, content: &'static str) -> ResultFile {
    ResultFile { name, made_by, content, schema: None }
}

impl ResultFile {
    const fn with(self, schema: fn() -> Value) -> Self {
        Self { schema: Some(schema), ..self }
    }

    /// Whether a command writes it.
    pub fn is_made_by(&self, command: &str) -> bool {
        let commands = self.made_by.split(" with ").next().unwrap_or_default();
        commands == "all" || commands.split(", ").any(|name| name == command)
    }

    /// Whether it is one file, with this name.
    pub fn is_single(&self) -> bool {
        !self.name.contains('*')
    }

    /// Whether a file of an output folder is one of this kind.
    pub fn matches(&self, name: &str) -> bool {
        match self.name.split_once('*') {
            None => name == self.name,
            Some((begin, end)) => {
                name.len() >= begin.len() + end.len() && name.starts_with(begin) && name.ends_with(end)
            }
        }
    }
}

/// All files, in the order in which they are of use.
pub const RESULT_FILES: [ResultFile; 31] = [
    file(REPORT, "run, fit, report", "the whole result on one page: what may be used, springs, verdict, figures, inputs"),
    file(REPORT_PDF, "run, fit, report with --pdf", "the same page on A4"),
    file("study.toml", "fit", "the study of the pair, to go on from"),
    file(STIFFNESS, "run, fit, calibrate", "the springs with their error bands, their reference, the split of the compliance, meshes, profiles and the first touch")
        .with(of::<StiffnessRecord>),
    file(LOAD_CURVE, "run, fit, calibrate", "a row for each load, with the reference in use").with(of::<LoadCurveRow>),
    file(BY_ANGLE, "run, fit, calibrate", "laws and stiffness along the contact normal with the wheel on tread, gauge corner and flange, and the condensed and the lumped contact element")
        .with(of::<StiffnessByAngleRecord>),
    file(BY_ANGLE_ROWS, "run, fit, calibrate", "the same at fixed loads, a row for each shift, load and reference").with(row_schema),
    file(PATCHES, "run, fit, calibrate", "pressure, stick and slip of the contact points on the rail under the smallest, a middle and the largest load")
        .with(of::<PatchesRecord>),
    file("history.csv", "run, simulate", "the main load case on the simple model, a row for each time step: forces, places, contacts, balance of energy")
        .with(history_csv::row_schema),
    file("history-*.csv", "run, simulate", "the same of a load case by its name"),
    file("history_disturbed*.csv", "run, simulate", "the same with an input that is 0.1 % larger: how far the model is determined"),
    file("history_published*.csv", "run, simulate", "the same with the published contact element beside the study's one, and disturbed"),
    file("history_condensed*.csv", "run, simulate", "the same with the condensed contact element beside the study's one, and disturbed"),
    file("history_lumped*.csv", "run, simulate", "the same with the lumped contact element beside the study's one, and disturbed"),
    file("history_uncertain*.csv", "run, simulate, verify", "what uncertain inputs change in a load case on the simple model, a row for each time step: quantiles of P, Q and averaged Q/P over the samples")
        .with(uncertain_record::row_schema),
    file("solid_history*.csv", "run, verify", "load cases on the solid model, and disturbed"),
    file(VERIFICATION, "run, fit, verify", "the verdict: differences of the two models with their limits, and the numerical uncertainty of each model")
        .with(of::<VerificationRecord>),
    file("figures/*.svg", "run, fit, report", "the figures of the report"),
    file("contact.vtu", "run, fit, calibrate", "gap, pressure and traction of the contact under the largest load"),
    file("contact.pvd", "run, fit, calibrate", "the contact over the loads, for ParaView"),
    file("rail.vtu", "run, fit, calibrate, mesh", "the solid rail: displacement and stress under the largest load, or the mesh alone"),
    file("rail.pvd", "run, fit, calibrate", "the rail over the loads, for ParaView"),
    file("wheel.vtu", "run, fit, calibrate, mesh", "the solid wheel: displacement and stress under the largest load, or the mesh alone"),
    file("wheel.pvd", "run, fit, calibrate", "the wheel over the loads, for ParaView"),
    file("fields/*.vtu", "run, fit, calibrate", "what the .pvd files collect"),
    file(INPUTS, "run, fit, calibrate, simulate, verify", "the keys of the study, its defaults included, and the program: what `compare` names as inputs that differ")
        .with(of::<InputsRecord>),
    file(RESULTS, "all", "what each file was made from, and the hash of its content"),
    file(MEASURED, "all", "seconds and memory of the stages, date and host: what differs from run to run").with(of::<Measured>),
    file(CROSSCHECK, "crosscheck", "the comparison with reference solvers: questions, answers, limits, versions"),
    file(CROSSCHECK_PAGE, "crosscheck", "the same as a page"),
    file(DIFFERENCES, "crosscheck", "where on the bodies tool and reference differ"),
];
