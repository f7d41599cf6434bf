//! Mutated laws of `simulate --law`: a `stiffness.json`, or a law written by hand. What is accepted has the constants of
//! the file, and they are a law.

use std::path::Path;

use railspring::engine::seal::Sealed;
use railspring::results::bodies::geometry::{Geometry, geometry};
use railspring::results::run::input::SpringsInput;
use railspring::results::run::record::SpringsRecord;
use railspring::results::run::springs;
use railspring::results::springs::form::NormalLawRecord;
use railspring::results::springs::record::StiffnessRecord;
use railspring::study::Study;
use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::Value;

use super::mutate::{Dice, mistakes};
use super::{Fate, tried};

const STUDY: &str = r#"
name = "law"
[rail]
profile = "60E1"
[wheel]
profile = "S1002"
[simulation]
law_accepted = ["another-pair"]
[scenario.push]
vertical_force = { mean_kn = 10 }
lateral_force = {}
"#;

const BY_HAND: &str = r#"{
  "a_kn_per_m": 30000,
  "b_kn_per_m": 294000.5,
  "c": 0.241,
  "f0_kn": 10,
  "horizontal_kn_per_m": 80e3,
  "wheel_mass_kg": 350,
  "reference": "beam",
  "range_kn": [5, 150]
}
"#;

/// A calibration as it was written, without the lists that the springs are not made of.
fn calibrated() -> String {
    let record: StiffnessRecord =
        serde_json::from_str(include_str!("../corpora/springs/stiffness.json")).unwrap();
    let record = StiffnessRecord {
        references: Vec::new(),
        error_band: None,
        compliance_split: Vec::new(),
        subsurface: Vec::new(),
        ..record
    };
    serde_json::to_string_pretty(&record).unwrap()
}

pub fn try_mutations(count: u64) {
    let study = Study::parse(Path::new("law.toml"), STUDY).unwrap();
    let geometry = geometry(study.statics()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("law.json");
    let calibrated = calibrated();
    for seed in [BY_HAND, &calibrated] {
        if let Fate::Refused(message) | Fate::Silent(message) = fate(&study, &geometry, &path, seed) {
            panic!("the law as it is: {message}");
        }
    }
    tried("laws", count, |dice: &mut Dice| {
        let seed = [BY_HAND, &calibrated][dice.below(2)];
        let (text, changes) = mistakes(seed, dice);
        (changes, fate(&study, &geometry, &path, &text))
    });
}

/// A calibration that was changed has the hash of what it says now: its hash alone would refuse it.
fn fate(study: &Study, geometry: &Geometry, path: &Path, text: &str) -> Fate {
    let sealed = serde_json::from_str(text).map(|record: StiffnessRecord| {
        serde_json::to_string(&record.sealed()).expect("records are plain data")
    });
    std::fs::write(path, sealed.as_deref().unwrap_or(text)).unwrap();
    match springs::from_file(&SpringsInput::of(study), geometry, path) {
        Err(error) => Fate::Refused(error.to_string()),
        Ok(record) => match misread(&record, text) {
            Some(what) => Fate::Silent(what),
            None => Fate::Read,
        },
    }
}

/// What a record has otherwise than the file.
fn misread(record: &SpringsRecord, text: &str) -> Option<String> {
    let file = match serde_json::from_str::<Strict>(text) {
        Ok(Strict(file)) => file,
        Err(cause) => return Some(format!("no JSON without doubled keys, {cause}")),
    };
    let constants = file.get("law").unwrap_or(&file);
    let NormalLawRecord::Power(law) = &record.law else { return Some("another form than the file's".into()) };
    let read = [
        (constants, "a_kn_per_m", law.a_kn_per_m),
        (constants, "b_kn_per_m", law.b_kn_per_m),
        (constants, "c", law.c),
        (constants, "f0_kn", law.f0_kn),
        (&file, "horizontal_kn_per_m", record.horizontal_kn_per_m),
    ];
    for (place, key, value) in read {
        if place.get(key).and_then(Value::as_f64) != Some(value) || !value.is_finite() {
            return Some(format!("{key} = {:?} was read as {value}", place.get(key)));
        }
    }
    let is_law = law.a_kn_per_m >= 0.0
        && law.b_kn_per_m >= 0.0
        && law.a_kn_per_m + law.b_kn_per_m > 0.0
        && (0.0..1.0).contains(&law.c)
        && law.f0_kn > 0.0
        && record.horizontal_kn_per_m > 0.0
        && record.wheel_mass_kg > 0.0;
    if !is_law {
        return Some(format!("no law: {record:?}"));
    }
    let si = springs::springs(record).ok()?;
    // the same tangent from the file's own constants and from what the simple model runs with, at 85 kN
    const ROUNDOFF: f64 = 1e-12;
    let force = 85.0;
    let tangent = law.a_kn_per_m + law.b_kn_per_m * (force / law.f0_kn).powf(law.c);
    let run = si.normal.tangent(force * 1e3) * 1e-3;
    ((run / tangent - 1.0).abs() > ROUNDOFF || !run.is_finite())
        .then(|| format!("k(85 kN) {run} for {tangent} kN/m"))
}

/// The keys that the springs are made of.
const READ: [&str; 12] = [
    "a_kn_per_m",
    "b_kn_per_m",
    "c",
    "f0_kn",
    "horizontal_kn_per_m",
    "wheel_mass_kg",
    "reference",
    "range_kn",
    "law",
    "pair",
    "hash",
    "name",
];

/// JSON in which no object has such a key twice; `Value` alone keeps the last of them.
struct Strict(Value);

impl<'de> Deserialize<'de> for Strict {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(StrictVisitor).map(Strict)
    }
}

struct StrictVisitor;

impl<'de> Visitor<'de> for StrictVisitor {
    type Value = Value;

    fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str("JSON")
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Value, A::Error> {
        let mut list = Vec::new();
        while let Some(Strict(item)) = items.next_element()? {
            list.push(item);
        }
        Ok(list.into())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut map = serde_json::Map::new();
        while let Some((key, Strict(value))) = entries.next_entry::<String, Strict>()? {
            if map.insert(key.clone(), value).is_some() && READ.contains(&key.as_str()) {
                return Err(A::Error::custom(format!("{key} stands twice")));
            }
        }
        Ok(map.into())
    }
}
