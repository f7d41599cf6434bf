//! The steps of cases on another machine: what it gets, what it does with it, and what it answers. A step needs nothing but its store.

use std::collections::BTreeMap;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use railspring_profiles::error::{InputError, Result, or_reason};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::cases::{Case, Table, text_of_keys};
use super::document::{BodiesKey, DirectionKey, Keys};
use super::making::{BodyOfCase, CaseWork, Settings};
use super::shared::{Common, nominals, shares};
use crate::engine::store::Store;
use crate::hash::key;
use crate::results::bodies::estimate::Resources;
use crate::results::bodies::source::body_address;
use crate::study::Study;

/// Cases of a package at most.
const LARGEST_PACKAGE: usize = 100;
/// Packages that a table comes to at least, where it has as many cases.
const LEAST_PACKAGES: usize = 64;

/// Cases that go to another machine together: they are pressed on the same bodies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Package {
    table: String,
    direction: DirectionKey,
    bodies: BodiesKey,
    stiffness_at_kn: Vec<f64>,
    cases: Vec<SentCase>,
}

/// A case of a package: its keys, with the files that they name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SentCase {
    /// The keys of the study; files are named as in `files`.
    keys: Keys,
    /// Content of the files (base64).
    files: BTreeMap<String, String>,
    /// Whether the diameter of the wheel was measured with its profile.
    diameter_measured: bool,
    /// Hash of what springs depend on: the study must be the same there.
    springs: String,
}

/// A step of a package.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Work {
    /// Hash of the program that asks for it.
    program: String,
    /// Whether places that the store has are made again.
    fresh: bool,
    step: Step,
    package: Package,
}

/// What is done.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
enum Step {
    /// Say which bodies are needed, for which they are meshed.
    Prepare,
    /// Condense the body of an entry.
    Condense { entry: String },
    /// Press each case at its shifts towards the rail, mm.
    Press { shifts_mm: Vec<Vec<f64>> },
}

/// What has come of a step.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Answer {
    /// Why cases cannot be made, wherever they are tried, by their numbers in the package.
    refused: Vec<(usize, String)>,
    /// The bodies that they need.
    bodies: Vec<NeededBody>,
    /// Files of the store that were made, or were there.
    entries: Vec<String>,
}

/// A body that cases need.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct NeededBody {
    /// Its name in messages.
    name: String,
    /// Its file in the store.
    entry: String,
}

impl Package {
    /// Why a case stays on this machine: a mesh file, which another program reads, or a slice among several.
    pub fn obstacle(case: &Case) -> Option<&'static str> {
        let Study { rail, wheel, .. } = &case.study;
        if rail.mesh.is_some() || wheel.mesh.is_some() {
            return Some("mesh files are read on this machine");
        }
        let mut measured = [&rail.measured, &wheel.measured].into_iter().flatten();
        measured.any(|measured| measured.part.is_some()).then_some("slices are chosen on this machine")
    }

    /// Those of so many cases of a table that go together, by their numbers: measured profiles on the bodies of the same standards, in packages of at most
    /// 100; every other case by itself.
    pub fn groups(table: &Table, cases: &[usize]) -> Vec<Vec<usize>> {
        let bodies = table.document.bodies();
        let mut alike: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        let mut groups = Vec::new();
        for &number in cases {
            let study = &table.cases[number].study;
            if shares(study, bodies) {
                let keys: Vec<String> =
                    nominals(study, bodies).iter().map(|nominal| key(&nominal.statics())).collect();
                alike.entry(keys.concat()).or_default().push(number);
            } else {
                groups.push(vec![number]);
            }
        }
        // small ones where there are few, so that all workers have some
        let size = cases.len().div_ceil(LEAST_PACKAGES).clamp(1, LARGEST_PACKAGE);
        groups.extend(alike.values().flat_map(|numbers| numbers.chunks(size)).map(<[usize]>::to_vec));
        groups.sort();
        groups
    }

    /// Cases of a table, by their numbers, without an [`obstacle`](Self::obstacle).
    pub fn of(table: &Table, cases: &[usize]) -> Self {
        let Settings { name, direction, bodies, stiffness_at_kn } = Settings::of(&table.document);
        let cases = cases.iter().map(|number| SentCase::of(&table.cases[*number])).collect();
        Self { table: name.into(), direction, bodies, stiffness_at_kn: stiffness_at_kn.to_vec(), cases }
    }
}

impl SentCase {
    fn of(case: &Case) -> Self {
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
        let diameter_measured = wheel.diameter_measured;
        Self { keys, files, diameter_measured, springs: key(&case.study.statics()) }
    }

    /// The study, with its files in `folder`.
    fn study(&self, folder: &Path) -> Result<Study> {
        let unusable = |value: String| {
            let expected = "a case as `railspring table` sends it";
            InputError::new("case", value, expected, "run the same program on all machines")
        };
        std::fs::create_dir(folder).map_err(|cause| unusable(cause.to_string()))?;
        for (name, content) in &self.files {
            let content = STANDARD.decode(content).map_err(|cause| unusable(format!("{name}: {cause}")))?;
            // a name without a folder
            if Path::new(name).file_name() != Some(name.as_ref()) {
                return Err(unusable(format!("a file {name:?}")).into());
            }
            std::fs::write(folder.join(name), content)
                .map_err(|cause| unusable(format!("{name}: {cause}")))?;
        }
        let mut study = Study::parse(&folder.join("case.toml"), &text_of_keys(&self.keys))
            .map_err(|mistakes| unusable(mistakes.messages().join("; ")))?;
        if key(&study.statics()) != self.springs {
            return Err(unusable("another study than on the machine that sends it".into()).into());
        }
        study.wheel.diameter_measured = self.diameter_measured;
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
        let Package { table, direction, bodies, stiffness_at_kn, cases } = &self.package;
        let settings = Settings { name: table, direction: *direction, bodies: *bodies, stiffness_at_kn };
        let studies: Vec<Study> = cases
            .iter()
            .enumerate()
            .map(|(number, case)| case.study(&folder.path().join(number.to_string())))
            .collect::<Result<_>>()?;
        let (nominals, said) = (&Common::default(), resources.monitor);
        let cases: Vec<CaseWork<'_>> = studies
            .iter()
            .map(|study| CaseWork {
                study,
                settings,
                store,
                nominals,
                beside: None,
                lets_go: [false; 2],
                resources,
                said,
            })
            .collect();
        let answer = match &self.step {
            Step::Prepare => first_of(&cases, prepared)?,
            Step::Condense { entry } => {
                let answer = first_of(&cases, |case| condensed(case, entry))?;
                if answer.entries.is_empty() && answer.refused.len() < cases.len() {
                    let expected = "the file of one of the bodies of the cases";
                    let remedy = "run the same program on all machines";
                    return Err(InputError::new("entry", entry, expected, remedy).into());
                }
                answer
            }
            Step::Press { shifts_mm } => self.pressed(&cases, shifts_mm)?,
        };
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

    /// The cases of a package at their shifts, beside each other.
    fn pressed(&self, cases: &[CaseWork<'_>], shifts: &[Vec<f64>]) -> Result<Answer> {
        let missing: Vec<Vec<f64>> =
            cases.par_iter().zip(shifts).map(|(case, shifts)| case.missing(shifts, self.fresh)).collect();
        for (case, missing) in cases.iter().zip(&missing) {
            case.check(missing, self.fresh)?;
        }
        let press = |case: &CaseWork<'_>, shifts: &[f64], missing: &[f64]| -> Result<Vec<String>> {
            if !missing.is_empty() {
                let ready = case.ready()?;
                missing
                    .par_iter()
                    .map(|shift| case.place(&ready, *shift).map(drop))
                    .collect::<Result<()>>()?;
            }
            Ok(shifts.iter().map(|shift| case.settings.address(case.study, *shift).file()).collect())
        };
        let made: Vec<std::result::Result<Vec<String>, String>> = cases
            .par_iter()
            .zip(shifts)
            .zip(&missing)
            .map(|((case, shifts), missing)| or_reason(press(case, shifts, missing)))
            .collect::<Result<_>>()?;
        let mut answer = Answer::default();
        for (number, made) in made.into_iter().enumerate() {
            match made {
                Ok(entries) => answer.entries.extend(entries),
                Err(reason) => answer.refused.push((number, reason)),
            }
        }
        Ok(answer)
    }
}

/// What the first case of a package that can be made says for all; those before it are refused.
fn first_of(cases: &[CaseWork<'_>], of: impl Fn(&CaseWork<'_>) -> Result<Answer>) -> Result<Answer> {
    let mut refused = Vec::new();
    for (number, case) in cases.iter().enumerate() {
        match or_reason(case.with_bodies(&of))? {
            Ok(answers) => {
                let mut all = Answer { refused, ..Answer::default() };
                for answer in answers {
                    all.bodies.extend(answer.bodies);
                    all.entries.extend(answer.entries);
                }
                // wheels of two diameters stand on the same rail
                all.bodies.sort_by(|a, b| a.entry.cmp(&b.entry));
                all.bodies.dedup_by(|a, b| a.entry == b.entry);
                all.entries.sort();
                all.entries.dedup();
                return Ok(all);
            }
            Err(reason) => refused.push((number, reason)),
        }
    }
    Ok(Answer { refused, ..Answer::default() })
}

fn prepared(case: &CaseWork<'_>) -> Result<Answer> {
    let prepared = case.prepared()?;
    let needed = case.bodies(&prepared).into_iter().map(|(body, key)| {
        let of_coarser = if body.coarser { " of coarser elements" } else { "" };
        NeededBody { name: format!("{}{of_coarser}", body.body.name()), entry: body_address(&key).file() }
    });
    let entries = vec![case.address_of_bodies().file()];
    Ok(Answer { bodies: needed.collect(), entries, ..Answer::default() })
}

/// Condenses the body of an entry if it is one of the case.
fn condensed(case: &CaseWork<'_>, entry: &str) -> Result<Answer> {
    let meshed = case.meshed()?;
    let is_wanted = |(_, key): &(BodyOfCase, String)| body_address(key).file() == entry;
    let Some((body, _)) = case.bodies(&case.prepared_of(&meshed)).into_iter().find(is_wanted) else {
        return Ok(Answer::default());
    };
    case.condense(&meshed, body)?;
    Ok(Answer { entries: vec![entry.to_owned()], ..Answer::default() })
}
