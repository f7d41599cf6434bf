//! The steps of a case on another machine: what it gets, what it does with it, and what it answers. A step needs nothing but its store.

use std::collections::BTreeMap;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use railspring_profiles::error::{InputError, Result, or_reason};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::cases::{Case, Table, text_of_keys};
use super::document::{BodiesKey, DirectionKey, Keys};
use super::making::{BodyOfCase, CaseWork, Prepared, Settings};
use super::shared::Common;
use crate::engine::store::Store;
use crate::hash::key;
use crate::results::bodies::estimate::Resources;
use crate::results::bodies::source::body_address;
use crate::study::Study;

/// A case that goes to another machine: its keys, with the files that they name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SentCase {
    table: String,
    direction: DirectionKey,
    bodies: BodiesKey,
    stiffness_at_kn: Vec<f64>,
    /// The keys of the study; files are named as in `files`.
    keys: Keys,
    /// Content of the files (base64).
    files: BTreeMap<String, String>,
    /// Hash of what springs depend on: the study must be the same there.
    springs: String,
}

/// A step of a case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Work {
    /// Hash of the program that asks for it.
    program: String,
    /// Whether places that the store has are made again.
    fresh: bool,
    step: Step,
    case: SentCase,
}

/// What is done.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
enum Step {
    /// Mesh the bodies, and say which they are.
    Prepare,
    /// Condense the body of an entry.
    Condense { entry: String },
    /// Press the pair, which was prepared, at shifts towards the rail, mm.
    Press { shifts_mm: Vec<f64>, prepared: Prepared },
}

/// What has come of a step.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Answer {
    /// Why the case cannot be made, wherever it is tried.
    refused: Option<String>,
    /// The bodies that it needs.
    bodies: Vec<NeededBody>,
    /// What it is pressed with, for its last step.
    prepared: Option<Prepared>,
    /// Files of the store that were made, or were there.
    entries: Vec<String>,
}

/// A body that a case needs.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct NeededBody {
    /// Its name in messages.
    name: String,
    /// Its file in the store.
    entry: String,
}

impl SentCase {
    /// Why a case stays on this machine: a mesh file, which another program reads, or a slice among several.
    pub fn obstacle(case: &Case) -> Option<&'static str> {
        let Study { rail, wheel, .. } = &case.study;
        if rail.mesh.is_some() || wheel.mesh.is_some() {
            return Some("mesh files are read on this machine");
        }
        let mut measured = [&rail.measured, &wheel.measured].into_iter().flatten();
        measured.any(|measured| measured.part.is_some()).then_some("slices are chosen on this machine")
    }

    /// A case of a table without an [`obstacle`](Self::obstacle).
    pub fn of(table: &Table, case: &Case) -> Self {
        let Settings { name, direction, bodies, stiffness_at_kn } = Settings::of(&table.document);
        let Study { rail, wheel, .. } = &case.study;
        let mut keys = case.keys();
        let mut files = BTreeMap::new();
        let mut send = |section: &str, leaf: &str, path: &Path, content: &[u8]| {
            let ending = path.extension().map(|ending| format!(".{}", ending.to_string_lossy()));
            let name = format!("{section}-{leaf}{}", ending.unwrap_or_default());
            files.insert(name.clone(), STANDARD.encode(content));
            keys[section][leaf] = name.into();
        };
        for (section, measured, own) in
            [("rail", &rail.measured, &rail.section), ("wheel", &wheel.measured, &wheel.section)]
        {
            if let Some(measured) = measured {
                // a file that has changed is refused there: its hash is another one
                let content = measured.content.bytes(&measured.path).unwrap_or_default();
                send(section, "profile_file", &measured.path, &content);
            }
            if let Some(own) = own {
                send(section, "section_file", &own.path, &own.content);
            }
        }
        let keys = toml::from_str(&text_of_keys(&keys)).expect("the keys of a case are keys");
        let (stiffness_at_kn, springs) = (stiffness_at_kn.to_vec(), key(&case.study.statics()));
        Self { table: name.into(), direction, bodies, stiffness_at_kn, keys, files, springs }
    }

    /// The study, with its files in `folder`.
    fn study(&self, folder: &Path) -> Result<Study> {
        let unusable = |value: String| {
            let expected = "a case as `railspring table` sends it";
            InputError::new("case", value, expected, "run the same program on all machines")
        };
        for (name, content) in &self.files {
            let content = STANDARD.decode(content).map_err(|cause| unusable(format!("{name}: {cause}")))?;
            // a name without a folder
            if Path::new(name).file_name() != Some(name.as_ref()) {
                return Err(unusable(format!("a file {name:?}")).into());
            }
            std::fs::write(folder.join(name), content)
                .map_err(|cause| unusable(format!("{name}: {cause}")))?;
        }
        let study = Study::parse(&folder.join("case.toml"), &text_of_keys(&self.keys))
            .map_err(|mistakes| unusable(mistakes.messages().join("; ")))?;
        if key(&study.statics()) != self.springs {
            return Err(unusable("another study than on the machine that sends it".into()).into());
        }
        Ok(study)
    }
}

impl Work {
    /// Does the step with the store.
    ///
    /// # Errors
    /// Another program than the one that asks, a temporary folder or a store that cannot be written, and an interruption: another machine
    /// may do it. What is wrong with the case is an answer.
    pub fn done(&self, store: &Store, resources: Resources<'_>) -> Result<Answer> {
        if self.program != store.program() {
            let expected = format!("the program that makes the table, {}", self.program);
            let remedy = "install the same build on all machines";
            return Err(InputError::new("program", store.program(), expected, remedy).into());
        }
        let folder = tempfile::tempdir().map_err(|cause| {
            let expected = "a temporary folder that can be written";
            InputError::new("temporary folder", cause, expected, "make room, or set TMPDIR to another one")
        })?;
        let study = self.case.study(folder.path())?;
        let SentCase { table, direction, bodies, stiffness_at_kn, .. } = &self.case;
        let settings = Settings { name: table, direction: *direction, bodies: *bodies, stiffness_at_kn };
        let (nominals, said) = (&Common::default(), resources.monitor);
        let case = CaseWork { study: &study, settings, store, nominals, resources, said };
        let answer = match &self.step {
            Step::Prepare => case.with_bodies(prepared),
            Step::Condense { entry } => case.with_bodies(|case| condensed(case, entry)),
            Step::Press { shifts_mm, prepared } => self.pressed(&case, shifts_mm, prepared),
        };
        let refused = |reason| Answer { refused: Some(reason), ..Answer::default() };
        let answer = or_reason(answer)?.unwrap_or_else(refused);
        // a result that the store does not keep goes nowhere
        let absent = |entry: &&String| !store.path().join(entry).is_file();
        if let Some(absent) = answer.entries.iter().find(absent) {
            let value = store.path().join(absent).display().to_string();
            let expected = "a store that keeps what is made";
            return Err(InputError::new(
                "--cache",
                value,
                expected,
                "make room there, or name another folder",
            )
            .into());
        }
        Ok(answer)
    }

    fn pressed(&self, case: &CaseWork<'_>, shifts: &[f64], prepared: &Prepared) -> Result<Answer> {
        let address = |shift: &f64| case.settings.address(case.study, *shift);
        let missing: Vec<f64> =
            shifts.iter().copied().filter(|shift| self.fresh || !case.has_place(*shift)).collect();
        if !missing.is_empty() {
            let ready = match case.ready_from(prepared)? {
                Some(ready) => ready,
                None => case.ready()?,
            };
            missing.par_iter().map(|shift| case.place(&ready, *shift).map(drop)).collect::<Result<()>>()?;
        }
        Ok(Answer {
            entries: shifts.iter().map(|shift| address(shift).file()).collect(),
            ..Answer::default()
        })
    }
}

fn prepared(case: &CaseWork<'_>) -> Result<Answer> {
    let prepared = case.prepared(&case.meshed()?);
    let needed = case.bodies(&prepared).into_iter().map(|(body, key)| {
        let of_coarser = if body.coarser { " of coarser elements" } else { "" };
        NeededBody { name: format!("{}{of_coarser}", body.body.name()), entry: body_address(&key).file() }
    });
    Ok(Answer { bodies: needed.collect(), prepared: Some(prepared), ..Answer::default() })
}

fn condensed(case: &CaseWork<'_>, entry: &str) -> Result<Answer> {
    let meshed = case.meshed()?;
    let is_wanted = |(_, key): &(BodyOfCase, String)| body_address(key).file() == entry;
    let Some((body, _)) = case.bodies(&case.prepared(&meshed)).into_iter().find(is_wanted) else {
        let expected = "the file of one of the bodies of the case";
        return Err(InputError::new("entry", entry, expected, "run the same program on all machines").into());
    };
    case.condense(&meshed, body)?;
    Ok(Answer { entries: vec![entry.to_owned()], ..Answer::default() })
}
