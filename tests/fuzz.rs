//! Every reader of files on mutated bytes: it reads or refuses them, without a panic and in time, and takes nothing for what it is not.
//!
//! The files that cases begin with are in `tests/corpora`. The input of a fault is kept under a name `fault-…`, which is said; moved into the folder of its reader there it is
//! tried first from then on. Each reader is tried for some seconds. `cargo long fuzz` tries all of them for an hour, and a million profiles.
//!
//! Files that are known by the hash of their content alone have their tests where this can be made anew: contact elements in `railspring-element`, condensed bodies in
//! `railspring-calibrate`. Meshes from files are in `reference/tests/test_fuzz.py`, the reader's answers in `results::bodies::mesh_files`. Studies, laws and histories with
//! single mistakes are in `mutation`.

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::time::Duration;

use railspring::engine::columns;
use railspring::engine::seal::Sealed;
use railspring::engine::store::{Address, Artefact, Kind, Store};
use railspring::export::{Format, SpringsFile, Wanted, of_calibration, rows};
use railspring::hash::hash;
use railspring::results::springs::record::StiffnessRecord;
use railspring::study::Study;
use railspring::table::changes::since;
use railspring::table::earlier::Earlier;
use railspring::table::rows::Rows;
use railspring::table::{Table, TableRecord};
use railspring::track::TrackStudy;
use railspring_profiles::profile_file::{
    Action, FindingKind, PrepareOptions, Prepared, ProfileKind, ReadOptions, Smoothing, parse, prepare,
    sketch_section,
};
use railspring_testing::copy;
use railspring_testing::fuzz::{Corpus, Effort, Fate};
use tempfile::TempDir;

/// Time for each reader in the usual tests.
const SOME: Effort = Effort::Time(Duration::from_secs(10));
/// The readers below.
const READERS: [fn(Effort); 5] = [profiles, sections, documents, springs, entries];
/// Time for all of them in the long test.
const HOUR: Duration = Duration::from_secs(3600);

fn folder(kind: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpora").join(kind)
}

fn kind_of(name: &str) -> ProfileKind {
    if name.contains("wheel") { ProfileKind::Wheel } else { ProfileKind::Rail }
}

/// Profiles of all formats: Simpack, MiniProf, columns, CSV with decimal commas, drawings. A hole is found in what was read.
fn profiles(effort: Effort) {
    Corpus::of_folder(&folder("profiles")).fuzz("profiles", effort, |name, bytes| {
        let options = ReadOptions { kind: Some(kind_of(name)), ..ReadOptions::default() };
        let read = parse(name, bytes, &options).and_then(|profile| {
            let off = PrepareOptions { smoothing: Smoothing::Off };
            Ok((profile.drawn.is_some(), prepare(&profile, &off)?))
        });
        match read {
            Err(error) => Fate::Refused(error.to_string()),
            Ok((is_drawn, prepared)) => fate(is_drawn, &prepared),
        }
    });
}

/// A curve that is finite, and in which each step of more than 3 mm is a finding that is left. Lines and arcs have no holes; a row of a measurement in equal steps
/// across is none, however steep.
fn fate(is_drawn: bool, prepared: &Prepared) -> Fate {
    const LONGEST: f64 = 3.01e-3;
    const ONE_STEP: f64 = 1.6;
    let finite = prepared.points.iter().all(|p| p.point.iter().all(|v| v.is_finite()));
    if !finite || !prepared.curve.length().is_finite() {
        return Fate::Silent("a curve that is not finite".into());
    }
    let steps: Vec<_> = prepared.points.windows(2).map(|pair| pair[1].point - pair[0].point).collect();
    let mut across: Vec<f64> = steps.iter().map(|step| step.x.abs()).collect();
    across.sort_by(f64::total_cmp);
    let usual = across.get(across.len() / 2).copied().unwrap_or_default();
    let hole = steps.iter().find(|step| step.norm() > LONGEST && step.x.abs() > ONE_STEP * usual);
    let is_found = prepared.findings.iter().any(|f| f.kind == FindingKind::Gap && f.action == Action::Left);
    match hole {
        Some(hole) if !is_drawn && !is_found => Fate::Silent(format!("a hole of {} mm", 1e3 * hole.norm())),
        _ => Fate::Read,
    }
}

/// Closed sections of a rail and a wheel.
fn sections(effort: Effort) {
    Corpus::of_folder(&folder("sections"))
        .fuzz("sections", effort, |name, bytes| Fate::of(sketch_section(name, bytes, kind_of(name), None).1));
}

/// Studies of two profiles and of a track, tables, and what they name: a measured curve, heights along a rail, a list of pairs, a list of what is known of measurements.
fn documents(effort: Effort) {
    let place = tempfile::tempdir().unwrap();
    let corpus = folder("documents");
    let at = |name: &str| place.path().join(name);
    copy(&corpus, place.path());
    std::fs::create_dir(at("measured")).unwrap();
    std::fs::copy(folder("profiles").join("wheel.whl"), at("measured/worn.whl")).unwrap();
    let read = |name: &str| std::fs::read_to_string(corpus.join(name)).unwrap();
    let texts = ["study.toml", "track.toml", "lateral.toml", "table.toml"].map(|name| (name, read(name)));
    let parsed = |name: &str, text: &str| match name {
        "track.toml" | "lateral.toml" => Fate::of(TrackStudy::parse(&at(name), text, &[])),
        "table.toml" => Fate::of(Table::parse(&at(name), text)),
        _ => Fate::of(Study::parse(&at(name), text)),
    };
    Corpus::of_folder(&corpus).fuzz("documents", effort, |name, bytes| {
        let ends = |ending: &(&str, String)| name.ends_with(ending.0);
        let Some((document, _)) = texts.iter().find(|text| ends(text)) else {
            // a list is read by the document that names it, and is whole again afterwards
            let plain = LISTS.iter().find(|(list, _)| name.ends_with(list)).expect("a list of a document");
            let (_, text) = texts.iter().find(|(document, _)| *document == plain.1).unwrap();
            std::fs::write(at(plain.0), bytes).unwrap();
            let fate = parsed(plain.1, text);
            std::fs::copy(corpus.join(plain.0), at(plain.0)).unwrap();
            return fate;
        };
        match std::str::from_utf8(bytes) {
            Err(cause) => Fate::Refused(cause.to_string()),
            Ok(text) => parsed(document, text),
        }
    });
}

/// Lists, and the documents that name them.
const LISTS: [(&str, &str); 4] = [
    ("measured.csv", "study.toml"),
    ("heights.csv", "track.toml"),
    ("pairs.csv", "table.toml"),
    ("fleet.csv", "table.toml"),
];

/// Formats that need no study.
const FORMATS: [Format; 10] = [
    Format::ForceDisplacement,
    Format::Opensees,
    Format::Stem,
    Format::Rose,
    Format::Calculix,
    Format::Abaqus,
    Format::Matlab,
    Format::Modelica,
    Format::Json,
    Format::Gensys,
];

/// `stiffness.json`, `table.json` and the rows beside it. What differs from the written content is refused. A record that was changed and has the right hash all the same is
/// exported, rows are compared, or both are refused.
fn springs(effort: Effort) {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    let rows = std::fs::read(folder("springs").join("table.csv")).unwrap();
    let table = |rows: &[u8]| -> TableRecord<'static> {
        let text = std::fs::read(folder("springs").join("table.json")).unwrap();
        let mut table: TableRecord<'static> = serde_json::from_slice(&text).unwrap();
        table.written.insert("table.csv".into(), hash(rows));
        table.sealed()
    };
    let stiffness: StiffnessRecord =
        serde_json::from_slice(&std::fs::read(folder("springs").join("stiffness.json")).unwrap()).unwrap();
    let written = [
        ("stiffness.json".to_string(), serde_json::to_vec_pretty(&stiffness.sealed()).unwrap()),
        ("table.json".into(), serde_json::to_vec_pretty(&table(&rows)).unwrap()),
        ("table.csv".into(), rows.clone()),
    ];
    written.iter().for_each(|(name, bytes)| std::fs::write(at(name), bytes).unwrap());
    let contents =
        ["stiffness.json", "table.json"].map(|name| content(&SpringsFile::read(&at(name)).unwrap()));
    let whole = written[1].1.clone();
    let now = of_text(&rows);
    let number = Cell::new(0);
    Corpus::of(written.into()).fuzz("springs", effort, |name, bytes| {
        let path = at(name);
        std::fs::write(&path, bytes).unwrap();
        number.set(number.get() + 1);
        if name == "table.csv" {
            let read = Earlier::read(&path);
            if read.is_ok() && bytes != rows {
                return Fate::Silent("edited rows were taken as written".into());
            }
            std::fs::write(at("table.json"), serde_json::to_vec(&table(bytes)).unwrap()).unwrap();
            if let Ok(forged) = Earlier::read(&path) {
                let _ = since(&forged, &now);
            }
            std::fs::write(at("table.json"), &whole).unwrap();
            return Fate::of(read);
        }
        let format = FORMATS[number.get() % FORMATS.len()];
        let read = SpringsFile::read(&path);
        if read.as_ref().is_ok_and(|springs| !contents.contains(&content(springs))) {
            return Fate::Silent("an edited file was taken as written".into());
        }
        let forged = match name {
            "table.json" => serde_json::from_slice::<TableRecord<'static>>(bytes)
                .map(|table| SpringsFile::Table(Box::new(table))),
            _ => serde_json::from_slice(bytes).map(SpringsFile::Calibration),
        };
        if let Ok(forged) = forged {
            export(&path, &forged, format);
        }
        std::fs::write(at("table.json"), &whole).unwrap();
        Fate::of(read)
    });
}

/// The rows of a file.
fn of_text(text: &[u8]) -> Rows {
    let mut reader = csv::Reader::from_reader(text);
    let columns = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let cells = |row: csv::StringRecord| row.iter().map(|cell| columns::Cell::Text(cell.into())).collect();
    let rows = reader.records().map(|row| cells(row.unwrap())).collect();
    Rows { columns, rows, metadata: 0..0 }
}

/// The values of a record, whatever layout its file has.
fn content(springs: &SpringsFile) -> serde_json::Value {
    match springs {
        SpringsFile::Calibration(record) => serde_json::to_value(record),
        SpringsFile::Table(table) => serde_json::to_value(table),
    }
    .unwrap()
}

/// Exports springs; whatever is in them, that ends.
fn export(path: &Path, springs: &SpringsFile, format: Format) {
    match springs {
        SpringsFile::Calibration(record) => {
            let wanted = Wanted { format, reference: None, law: None, case: None, contact: None };
            let _ = of_calibration(path, record, wanted, None);
        }
        SpringsFile::Table(table) => {
            for row in rows("table.json", table, &[]).into_iter().flatten() {
                let _ = row.files(format, None, None, None);
            }
        }
    }
}

/// An entry of the store: it is taken as it was kept or not at all, and lists go on.
fn entries(effort: Effort) {
    let place: TempDir = tempfile::tempdir().unwrap();
    let store = Store::open(place.path()).unwrap();
    let address = Address::of(Kind::Place, &"fuzz");
    let parts = [("place.json", vec![b'1'; 300]), ("other", (0..=255).collect::<Vec<u8>>())];
    let artefact =
        parts.iter().fold(Artefact::default(), |all, (name, content)| all.with(*name, content.clone()));
    store.keep(&address, "a place", "fuzz", &artefact, &|why| panic!("{why}"));
    let file = place.path().join(address.file());
    let whole = std::fs::read(&file).unwrap();
    Corpus::of(vec![("entry".into(), whole)]).fuzz("entries", effort, |_, bytes| {
        std::fs::write(&file, bytes).unwrap();
        assert!(store.list().len() <= 1);
        let reason = Cell::new(String::new());
        let taken = store.take_as(&address, Ok, &|why| reason.set(why));
        match taken {
            Some(taken) => {
                let is_whole = parts.iter().all(|(name, content)| taken.part(name) == Some(content));
                let is_all = taken.parts().count() == parts.len();
                if is_whole && is_all { Fate::Read } else { Fate::Silent("another artefact".into()) }
            }
            None => Fate::Refused(reason.take()),
        }
    });
}

#[test]
fn mutated_profiles_are_read_or_refused() {
    profiles(SOME);
}

#[test]
fn mutated_sections_are_read_or_refused() {
    sections(SOME);
}

#[test]
fn mutated_documents_are_read_or_refused() {
    documents(SOME);
}

#[test]
fn mutated_springs_are_refused() {
    springs(SOME);
}

#[test]
fn mutated_entries_are_refused() {
    entries(SOME);
}

/// Goal: no reader panics, hangs or takes a file for what it is not in an hour of mutated files.
#[test]
#[ignore = "an hour: cargo long fuzz"]
fn an_hour_of_mutated_files() {
    READERS.iter().for_each(|reader| reader(Effort::Time(HOUR / READERS.len() as u32)));
}

/// Goal: a million mutated profiles are read or refused: no panic, no hang, no hole that is not found.
#[test]
#[ignore = "an hour: cargo long fuzz"]
fn a_million_mutated_profiles() {
    profiles(Effort::Cases(1_000_000));
}
