//! Readers, checks and repair on mutated files: no panic, no hang, and errors that name file, line and column.
//!
//! A few hundred cases run by default, and 10,000 with `cargo long mutation`.

use std::time::{Duration, Instant};

use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use railspring_profiles::error::Error;
use railspring_profiles::profile_file::{
    MeasuredPoint, PrepareOptions, ProfileFormat, ProfileKind, ReadOptions, Smoothing, parse, prepare, write,
};
use railspring_profiles::section::{rail_section, wheel_section};

/// Longest time for one case; a case takes milliseconds.
const HANGS: Duration = Duration::from_secs(10);

/// The files that are mutated: the benchmark's where they are, and our own in every format.
fn seeds() -> Vec<(String, Vec<u8>)> {
    let mut seeds = Vec::new();
    for name in ["MBench_S1002_v3.prw", "MBench_UIC60_v3.prr", "MBench_UIC60_v3.ban"] {
        if let Some(file) = railspring_testing::facts(&format!("contact/{name}")) {
            seeds.push((name.to_owned(), std::fs::read(file).unwrap()));
        }
    }
    let rail = rail_section("60E1").unwrap().running;
    let wheel = wheel_section("S1002", 0.92).unwrap().running;
    for (curve, kind, simpack, miniprof) in
        [(rail, ProfileKind::Rail, "a.prr", "a.ban"), (wheel, ProfileKind::Wheel, "a.prw", "a.whl")]
    {
        let points: Vec<MeasuredPoint> = curve
            .sample(1e-3)
            .into_iter()
            .map(|point| MeasuredPoint { point, line: 0, weight: 1.0 })
            .collect();
        for (format, name) in [
            (ProfileFormat::Simpack, simpack),
            (ProfileFormat::MiniProf, miniprof),
            (ProfileFormat::Text, "a.txt"),
            (ProfileFormat::Csv, "a.csv"),
            (ProfileFormat::Dxf, "a.dxf"),
        ] {
            seeds.push((name.to_owned(), write(format, kind, &points, "seed").into_bytes()));
        }
    }
    seeds.push(("b.dxf".to_owned(), DRAWN.into()));
    seeds
}

/// A head of a line, arcs and a spline.
const DRAWN: &str = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n\
    0\nLINE\n8\n0\n10\n-35\n20\n-30\n11\n-35\n21\n-13\n0\nARC\n8\n0\n10\n-22\n20\n-13\n40\n13\n50\n90\n51\n180\n\
    0\nSPLINE\n8\n0\n71\n2\n40\n0\n40\n0\n40\n0\n40\n1\n40\n1\n40\n1\n10\n-22\n20\n0\n10\n0\n20\n1\n10\n22\n20\n0\n\
    0\nLWPOLYLINE\n8\n0\n90\n3\n70\n0\n10\n22\n20\n0\n42\n-0.41421356\n10\n35\n20\n-13\n10\n35\n20\n-30\n\
    0\nTEXT\n8\n0\n1\nhead\n0\nENDSEC\n0\nEOF\n";

/// One change of a file; places are parts of its length.
#[derive(Debug, Clone)]
enum Mutation {
    Byte(f64, u8),
    Insert(f64, String),
    Delete(f64, usize),
    Truncate(f64),
    RepeatLine(f64, usize),
    SwapLines(f64, f64),
    ReverseLines(f64, usize),
    /// Every occurrence of a text.
    Replace(&'static str, &'static str),
}

fn mutation() -> impl Strategy<Value = Mutation> {
    const TOKENS: [&str; 38] = [
        "nan",
        "inf",
        "1e999",
        "-1e308",
        "1e300",
        "1e-300",
        "0",
        "-",
        "+",
        ",",
        ";",
        "\"",
        "'",
        "!",
        "=",
        "\0",
        "\r",
        "\n\n",
        "\u{feff}",
        "1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18",
        "point.begin",
        "point.end",
        "spline.end",
        "units.len.f = 0",
        "units.len.f = -1e-300",
        "rotate = 1e300",
        "shift.y = 1e308",
        "ColumnDef=Y,*,X",
        "Alarm",
        "[Reference]",
        "nan nan",
        "%",
        "(",
        "mm",
        "[m]",
        "XYPoints=12",
        "units.ang = 'deg'",
        "header.end",
    ];
    const REPLACED: [(&str, &str); 12] = [
        ("\n", "\r\n"),
        ("\n", "\r"),
        (".", ","),
        ("\t", ";"),
        ("\t", ","),
        ("E", "D"),
        ("-", "\u{2212}"),
        ("0", ""),
        ("\n", "\n\n"),
        ("1.0", "1e9"),
        ("+", ""),
        ("begin", "end"),
    ];
    let place = || 0.0..1.0f64;
    prop_oneof![
        4 => (place(), any::<u8>()).prop_map(|(at, byte)| Mutation::Byte(at, byte)),
        4 => (place(), prop::sample::select(&TOKENS[..])).prop_map(|(at, t)| Mutation::Insert(at, format!(" {t} "))),
        3 => (place(), prop::sample::select(&TOKENS[..])).prop_map(|(at, t)| Mutation::Insert(at, format!("\n{t}\n"))),
        2 => (place(), -1e3..1e3f64, -1e3..1e3f64).prop_map(|(at, y, z)| Mutation::Insert(at, format!("\n{y} {z}\n"))),
        1 => (place(), "\\PC{0,40}").prop_map(|(at, text)| Mutation::Insert(at, text)),
        2 => (place(), 1..2000usize).prop_map(|(at, count)| Mutation::Delete(at, count)),
        1 => place().prop_map(Mutation::Truncate),
        2 => (place(), 1..200usize).prop_map(|(at, count)| Mutation::RepeatLine(at, count)),
        2 => (place(), place()).prop_map(|(a, b)| Mutation::SwapLines(a, b)),
        2 => (place(), 2..400usize).prop_map(|(at, count)| Mutation::ReverseLines(at, count)),
        1 => prop::sample::select(&REPLACED[..]).prop_map(|(from, to)| Mutation::Replace(from, to)),
    ]
}

fn mutated(mut bytes: Vec<u8>, mutations: &[Mutation]) -> Vec<u8> {
    for mutation in mutations {
        // Repeating long lines again and again would only test the limit on the size.
        const LARGE: usize = 4 << 20;
        let length = bytes.len();
        if length > LARGE {
            bytes.truncate(LARGE);
            break;
        }
        let at = |part: f64| ((part * length as f64) as usize).min(length);
        let lines =
            |bytes: &[u8]| bytes.split_inclusive(|b| *b == b'\n').map(<[u8]>::to_vec).collect::<Vec<_>>();
        match mutation {
            Mutation::Byte(part, byte) => {
                if let Some(place) = bytes.get_mut(at(*part)) {
                    *place = *byte;
                }
            }
            Mutation::Insert(part, text) => {
                bytes.splice(at(*part)..at(*part), text.bytes());
            }
            Mutation::Delete(part, count) => {
                bytes.drain(at(*part)..(at(*part) + count).min(length));
            }
            Mutation::Truncate(part) => bytes.truncate(at(*part)),
            Mutation::Replace(from, to) => {
                bytes = String::from_utf8_lossy(&bytes).replace(from, to).into_bytes();
            }
            Mutation::RepeatLine(part, count) => {
                let mut all = lines(&bytes);
                if let Some(index) = (!all.is_empty()).then(|| (part * all.len() as f64) as usize) {
                    let line = all[index].clone();
                    all.splice(index..index, std::iter::repeat_n(line, *count));
                }
                bytes = all.concat();
            }
            Mutation::SwapLines(a, b) => {
                let mut all = lines(&bytes);
                let n = all.len();
                if n > 0 {
                    all.swap((a * n as f64) as usize, (b * n as f64) as usize);
                }
                bytes = all.concat();
            }
            Mutation::ReverseLines(part, count) => {
                let mut all = lines(&bytes);
                let n = all.len();
                if n > 0 {
                    let first = (part * n as f64) as usize;
                    all[first..(first + count).min(n)].reverse();
                }
                bytes = all.concat();
            }
        }
    }
    bytes
}

/// Whether a key is the file's name with line and column.
fn names_a_place(key: &str, name: &str) -> bool {
    let place = key.strip_prefix(name).and_then(|rest| rest.strip_prefix(':'));
    place.and_then(|place| place.split_once(':')).is_some_and(|(line, column)| {
        line.parse::<usize>().is_ok_and(|n| n > 0) && column.parse::<usize>().is_ok_and(|n| n > 0)
    })
}

/// Reads and prepares; says what is wrong with an error.
fn survives(name: &str, bytes: &[u8]) -> Result<(), String> {
    let begin = Instant::now();
    let outcome = parse(name, bytes, &ReadOptions::default()).and_then(|profile| {
        // Memory is bounded by the file: a point takes at least four bytes of it, but on an arc or spline of a drawing.
        let curves = if profile.format == ProfileFormat::Dxf { 8 * bytes.len() + 20_000 } else { 0 };
        assert!(4 * profile.points.len() <= bytes.len() + 4 + curves);
        prepare(&profile, &PrepareOptions { smoothing: Smoothing::Halves(2e-3) })?;
        prepare(&profile, &PrepareOptions::default())
    });
    if begin.elapsed() > HANGS {
        return Err(format!("took {:?}", begin.elapsed()));
    }
    match outcome {
        Ok(prepared) => {
            let finite = prepared.points.iter().all(|p| p.point.iter().all(|v| v.is_finite()));
            let read = finite && prepared.curve.length().is_finite();
            if read { Ok(()) } else { Err("the curve is not finite".into()) }
        }
        Err(Error::Input(input)) => {
            let asks = input.key == name && input.remedy.contains("wheel or a rail");
            let placed = asks || names_a_place(&input.key, name);
            if placed { Ok(()) } else { Err(format!("no place in: {input}")) }
        }
        Err(other) => Err(format!("not an input error: {other}")),
    }
}

/// Cases of a round; each round has its own seed.
const CASES: u32 = 300;

fn try_rounds(rounds: u64) {
    let seeds = seeds();
    let cases = (0..seeds.len(), prop::collection::vec(mutation(), 1..12));
    let begin = Instant::now();
    for round in 0..rounds {
        // A runner counts its cases over all its runs, so each round has its own.
        let config = Config { cases: CASES, failure_persistence: None, ..Config::default() };
        let seed: Vec<u8> = round.to_le_bytes().repeat(4);
        let mut runner = TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &seed));
        let outcome = runner.run(&cases, |(seed, mutations)| {
            let (name, bytes) = &seeds[seed];
            let bytes = mutated(bytes.clone(), &mutations);
            survives(name, &bytes).map_err(|why| TestCaseError::fail(format!("{name}: {why}")))
        });
        if let Err(failure) = outcome {
            panic!("{failure}");
        }
    }
    println!("{} cases in {:.0} s", rounds * u64::from(CASES), begin.elapsed().as_secs_f64());
}

#[test]
fn mutated_files_are_read_or_refused() {
    try_rounds(1);
}

/// Goal: 10,000 profile files with mistakes are read or refused: no panic, no hang, no silent answer.
#[test]
#[ignore = "minutes: cargo long mutation"]
fn ten_thousand_mutated_files_are_read_or_refused() {
    try_rounds(10_000_u64.div_ceil(CASES.into()));
}

/// The files as they are have to be read, or the mutations would test nothing.
#[test]
fn unmutated_files_are_read() {
    for (name, bytes) in seeds() {
        let profile = parse(&name, &bytes, &ReadOptions::default()).unwrap();
        prepare(&profile, &PrepareOptions::default()).unwrap();
    }
}

/// Files that are all noise.
#[test]
fn random_bytes_are_refused() {
    for seed in 0..200u64 {
        let mut state = seed;
        let bytes: Vec<u8> = (0..4000)
            .map(|_| {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                // Half of the files consist of digits and separators alone.
                let byte = (state >> 56) as u8;
                if seed % 2 == 0 { byte } else { b"0123456789.-+eE,; \n\n\t "[usize::from(byte) % 22] }
            })
            .collect();
        for name in ["x.prr", "x.ban", "x.csv", "x"] {
            survives(name, &bytes).unwrap();
        }
    }
}
