//! A result as it is compared.

use std::path::Path;

use railspring_profiles::error::{InputError, Result};
use railspring_simulate::time::history::History;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::engine::list::{Entry, RESULTS, Results};
use crate::engine::output::{OutputFolder, parse_json, read_text};
use crate::engine::seal::Sealed;
use crate::hash::hash;
use crate::results::by_angle::record::{BY_ANGLE, StiffnessByAngleRecord};
use crate::results::inputs::{INPUTS, InputsRecord};
use crate::results::names::{LOAD_CURVE, STIFFNESS, VERIFICATION};
use crate::results::run::history_csv;
use crate::results::run::record::{RUN_NOTE, RunRecord};
use crate::results::springs::record::{LoadCurveRow, StiffnessRecord};
use crate::results::springs::stage::load_curve;
use crate::results::verdict::record::VerificationRecord;
use crate::study::ResolvedKey;

/// Whose result it is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct About {
    /// Folder or file, as it was named.
    pub path: String,
    /// Name of the study.
    pub study: String,
    /// The pair in words.
    pub pair: String,
    /// Version of the program, and its commit where that is known.
    pub program: String,
    /// Range of the law, kN.
    pub range_kn: [f64; 2],
    /// The verdict in a sentence, if there is one.
    pub verdict: Option<String>,
    /// Hash of what its springs depend on.
    pub input_hash: String,
}

/// What a folder has of a study; what it does not have is left out.
#[derive(Debug, Clone)]
pub struct Side {
    /// Folder or file, as it was named.
    pub path: String,
    /// The springs.
    pub stiffness: StiffnessRecord,
    /// The load curve with the reference in use.
    pub load_curve: Vec<LoadCurveRow>,
    /// The laws by contact angle.
    pub by_angle: Option<StiffnessByAngleRecord>,
    /// The verdict.
    pub verdict: Option<VerificationRecord>,
    /// What it was made from.
    pub inputs: Option<InputsRecord>,
    /// Load cases on the simple model, by name.
    pub runs: Vec<(String, History)>,
}

impl Side {
    /// Reads an output folder; of a file the springs alone.
    ///
    /// # Errors
    /// [`InputError`] for a folder without springs, for a file of it that is not as it was written, and for one that cannot be read.
    pub fn read(path: &Path) -> Result<Self> {
        if path.is_file() {
            let text = read_text(path, "calibrate")?;
            let stiffness: StiffnessRecord = parse_json(path, &text, "calibrate")?;
            stiffness.check_as_written(path, "calibrate")?;
            return Ok(Self::of(path, stiffness));
        }
        let folder = OutputFolder::to_read(path)?;
        let files = Files { results: Results::new(&folder), folder: &folder };
        let stiffness = files.json(STIFFNESS)?.ok_or_else(|| {
            InputError::new(
                folder.file(STIFFNESS).display().to_string(),
                "(does not exist)",
                "an output folder with springs",
                "run `railspring calibrate`, `run` or `fit` into it first, or name another folder",
            )
        })?;
        let mut side = Self::of(path, stiffness);
        side.by_angle = files.json(BY_ANGLE)?;
        side.verdict = files.json(VERIFICATION)?;
        let inputs: Option<InputsRecord> = files.json(INPUTS)?;
        side.inputs = inputs.filter(|inputs| inputs.calibration == side.stiffness.input_hash);
        if let Some((text, _)) = files.text(LOAD_CURVE)? {
            side.load_curve = load_curve(&folder.file(LOAD_CURVE).display().to_string(), &text)?;
        }
        side.runs = side
            .scenarios()
            .map(|name| Ok((name.clone(), files.history(&name)?)))
            .collect::<Result<Vec<_>>>()?
            .into_iter()
            .filter_map(|(name, history)| Some((name, history?)))
            .collect();
        Ok(side)
    }

    /// A result of which only the springs are known.
    pub fn of(path: &Path, stiffness: StiffnessRecord) -> Self {
        Self {
            path: path.display().to_string(),
            stiffness,
            load_curve: Vec::new(),
            by_angle: None,
            verdict: None,
            inputs: None,
            runs: Vec::new(),
        }
    }

    /// Whose result it is.
    pub fn about(&self) -> About {
        let StiffnessRecord { study, pair, version, law, .. } = &self.stiffness;
        let commit = self.inputs.as_ref().map_or_else(String::new, |inputs| format!(", {}", inputs.commit));
        About {
            path: self.path.clone(),
            study: study.clone(),
            pair: pair.name.clone(),
            program: format!("railspring {version}{commit}"),
            range_kn: law.range_kn,
            verdict: self.verdict.as_ref().map(VerificationRecord::headline),
            input_hash: self.stiffness.input_hash.clone(),
        }
    }

    /// The keys of its study, if they are known.
    pub fn keys(&self) -> Option<&[ResolvedKey]> {
        self.inputs.as_ref().map(|inputs| &inputs.keys[..])
    }

    fn scenarios(&self) -> impl Iterator<Item = String> {
        let scenarios = self.verdict.iter().flat_map(|verdict| &verdict.scenarios);
        scenarios.map(|of| of.scenario.clone()).collect::<Vec<_>>().into_iter()
    }
}

/// The files of a folder, each as it was written.
struct Files<'a> {
    folder: &'a OutputFolder,
    results: Results<'a>,
}

impl Files<'_> {
    /// A file with what is listed about it; none where it is not there.
    fn text(&self, name: &str) -> Result<Option<(String, Entry)>> {
        let path = self.folder.file(name);
        if !path.exists() {
            return Ok(None);
        }
        let text = read_text(&path, "run")?;
        let refused = |value: &str| {
            InputError::new(
                path.display().to_string(),
                value,
                format!("a file as it was written, which {RESULTS} lists with its hash"),
                "make it again with `railspring run`, or name another folder",
            )
        };
        let entry = self.results.entry(name).ok_or_else(|| refused(&format!("not listed in {RESULTS}")))?;
        match entry.blake3.as_deref() == Some(&hash(text.as_bytes())) {
            true => Ok(Some((text, entry))),
            false => Err(refused("another content").into()),
        }
    }

    fn json<T: DeserializeOwned>(&self, name: &str) -> Result<Option<T>> {
        let text = self.text(name)?;
        text.map(|(text, _)| parse_json(&self.folder.file(name), &text, "run")).transpose()
    }

    /// The run of a load case on the simple model: that of the main one has no name.
    fn history(&self, scenario: &str) -> Result<Option<History>> {
        let named = format!("history-{scenario}.csv");
        let name = if self.folder.file(&named).exists() { named } else { "history.csv".into() };
        let Some((text, entry)) = self.text(&name)? else { return Ok(None) };
        let Some((size, ending)) =
            entry.note::<RunRecord>(RUN_NOTE).and_then(|run| Some((run.degrees_of_freedom, run.ending()?)))
        else {
            return Ok(None);
        };
        Ok(Some(history_csv::read(&self.folder.file(&name), &text, size, ending)?))
    }
}
