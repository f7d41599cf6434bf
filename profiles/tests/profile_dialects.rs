//! What instruments and programs write: the same profile in every dialect is read to the same points, what is no point
//! is listed, and what is not certain is refused.
//!
//! The dialects are those in which MiniProf, Simpack and column files are met: the tests write them from their
//! description, as no file of an instrument is free to be copied.

use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use railspring_profiles::error::Error;
use railspring_profiles::profile_file::{
    Action, FindingKind, MeasuredProfile, PrepareOptions, ProfileFormat, ProfileKind, ReadOptions, parse,
    prepare,
};

fn read(name: &str, text: &str) -> MeasuredProfile {
    parse(name, text.as_bytes(), &ReadOptions::default()).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn refused(name: &str, text: &str) -> String {
    match parse(name, text.as_bytes(), &ReadOptions::default()) {
        Err(Error::Input(input)) => {
            assert!(input.key.starts_with(&format!("{name}:")), "{input}");
            input.to_string()
        }
        Err(error) => panic!("{error}"),
        Ok(profile) => panic!("read {} points: {:?}", profile.points.len(), profile.findings),
    }
}

/// A head of 71 mm as texts of y and z in mm: y to the field side, z down.
fn head() -> Vec<(String, String)> {
    let height = |y: f64| {
        let corner = (y.abs() - 23.0).max(0.0);
        y * y / 600.0 + 1.5 * (13.0 - (169.0 - corner * corner).max(0.0).sqrt())
    };
    let y = (0..=142).map(|i| -35.5 + 0.5 * f64::from(i));
    y.map(|y| (format!("{y:.4}"), format!("{:.4}", height(y)))).collect()
}

fn minus(text: &str) -> String {
    text.strip_prefix('-').map_or(format!("-{text}"), str::to_owned)
}

/// Rows of the head as MiniProf has it: X to the track centre, Y up.
fn ban(row: impl Fn(&str, &str) -> String) -> String {
    head().iter().map(|(y, z)| row(&minus(y), &minus(z))).collect()
}

fn rows() -> String {
    ban(|x, y| format!("{x}\t{y}\n"))
}

/// Whether a profile is the head, to the last bit.
fn is_head(profile: &MeasuredProfile) {
    let expected: Vec<[f64; 2]> = head()
        .iter()
        .map(|(y, z)| [y.parse::<f64>().unwrap() / 1000.0, z.parse::<f64>().unwrap() / 1000.0])
        .collect();
    let found: Vec<[f64; 2]> = profile.points.iter().map(|p| [p.point.x, p.point.y]).collect();
    assert_eq!(profile.kind, ProfileKind::Rail);
    assert_eq!(found.len(), expected.len(), "{:?}", profile.findings);
    for (a, b) in found.iter().zip(&expected) {
        assert_eq!(a, b, "{:?}", profile.findings);
    }
    prepare(profile, &PrepareOptions::default()).unwrap();
}

/// The findings of a kind as text.
fn said(profile: &MeasuredProfile, kind: FindingKind) -> String {
    let of_kind = profile.findings.iter().filter(|finding| finding.kind == kind);
    of_kind.map(|finding| format!("{finding}\n")).collect()
}

fn passed_over(profile: &MeasuredProfile, texts: &[&str]) {
    let said = said(profile, FindingKind::PassedOver);
    for text in texts {
        assert!(said.contains(text), "{text:?} is not in: {said}");
    }
}

#[test]
fn miniprof_header_lines_without_equals_sign_are_listed() {
    let profile =
        read("a.ban", &format!("MPTypeNo=299\nMiniProf Rail of the depot\n12 May, 3 runs\n\n{}", rows()));
    is_head(&profile);
    passed_over(&profile, &["lines 2 to 3", "MiniProf Rail of the depot", "12 May, 3 runs"]);
    // The columns are understood without it, too: else the points would be others.
    for header in ["ColumnDef: Y,X", "Column Def Y,X", "\"ColumnDef\";Y;X", "Y;X", "Y [mm]\tX [mm]"] {
        is_head(&read("a.ban", &format!("MPTypeNo=299\n{header}\n\n{}", ban(|x, y| format!("{y};{x}\n")))));
    }
}

#[test]
fn miniprof_numbers_in_quotes_and_units_in_brackets() {
    is_head(&read("a.ban", &format!("XYPoints=143\n\n{}", ban(|x, y| format!("\"{x}\",\"{y}\"\n")))));
    is_head(&read("a.ban", &format!("XYPoints=143\n\n{}", ban(|x, y| format!("'{x}' '{y}' \" note 1 2\n")))));
    let comma = |text: &str| text.replace('.', ",");
    is_head(&read("a.ban", &ban(|x, y| format!("\"{}\",\"{}\"\n", comma(x), comma(y)))));
    is_head(&read(
        "a.ban",
        &format!("Gauge [mm]=1435\nXOffset (mm)=0\n\n{}", ban(|x, y| format!("{x} [mm] {y} [mm]\n"))),
    ));
    is_head(&read("a.ban", &format!("ColumnDef=X [mm],Y [mm]\n\n{}", ban(|x, y| format!("{x}mm;{y}mm\n")))));
    // A unit that is not that of the format is obeyed: metres by moving the mark by three digits.
    let metres = |text: &str| format!("{text}E-3");
    for (header, unit) in [("ColumnDef=X [m],Y [m]", ""), ("ColumnDef=X,Y", " [m]")] {
        let rows = ban(|x, y| format!("{}{unit};{}{unit}\n", metres(x), metres(y)));
        let profile = read("a.ban", &format!("{header}\n\n{rows}"));
        assert_eq!(profile.points.len(), 143);
        // ROUNDOFF: a number in metres and one in millimetres over a thousand, below 0.04 m.
        let expected = -35.5e-3;
        assert!((profile.points[0].point.x - expected).abs() < 1e-17, "{}", profile.points[0].point);
    }
}

#[test]
fn miniprof_empty_lines_and_words_after_the_numbers() {
    let mut n = 0;
    let mut row = |x: &str, y: &str| {
        n += 1;
        let word = if n == 7 { "1.0 invalid" } else { "ok" };
        format!("{x} {y} {word}\n{}", if n % 10 == 0 { "\n  \n" } else { "" })
    };
    let rows: String = head().iter().map(|(y, z)| row(&minus(y), &minus(z))).collect();
    let profile = read("a.ban", &format!("\n\nXYPoints=143\n\n\n{rows}\n\n"));
    is_head(&profile);
    passed_over(
        &profile,
        &["\"ok\" after the numbers of 142 rows", "line 12", "\"invalid\" after the numbers of a row"],
    );
    assert!(profile.findings.iter().any(|f| f.action == Action::Left && f.text.contains("invalid")));
    // Words beside numbers with decimal commas have their own full stops.
    let rows = ban(|x, y| format!("{} {} o.k. 1.Lauf\n", x.replace('.', ","), y.replace('.', ",")));
    is_head(&read("a.ban", &rows));
}

#[test]
fn miniprof_header_after_the_points_or_twice() {
    let header = "Filename=a\nXYPoints=143\nMPTypeNo=299\nColumnDef=Y,X,*\n";
    let rows = ban(|x, y| format!("{y} {x} 7\n"));
    is_head(&read("a.ban", &format!("{rows}\n{header}")));
    is_head(&read("a.ban", &format!("{header}\n{header}\n{rows}")));
    is_head(&read("a.ban", &format!("{header}\n{rows}\n{header}")));
    // Again in the middle, as at the end of a page.
    let lines: Vec<&str> = rows.split_inclusive('\n').collect();
    let (first, second) = lines.split_at(60);
    is_head(&read("a.ban", &format!("{header}\n{}\n{header}\n{}", first.concat(), second.concat())));
    // The same points twice count once.
    let profile = read("a.ban", &format!("{header}\n{rows}\n{header}\n{rows}"));
    is_head(&profile);
    passed_over(&profile, &["143 points: the same points again"]);
}

#[test]
fn miniprof_blocks_beside_the_measured_points() {
    let reference = ban(|x, y| format!("{x} {}\n", y.parse::<f64>().unwrap() + 0.3));
    let alarm = "-30 -6\n0 -3\n30 -6\n";
    for text in [
        format!("XYPoints=143\n\n{}\nAlarm\n{alarm}\nReference profile:\n{reference}", rows()),
        format!("[Alarm]\nCount=3\n{alarm}\n[Reference]\n{reference}\n[XYPoints]\n{}", rows()),
        format!("AlarmPoints=3\n{alarm}\nXYPoints=143\n{}\nRefProfile=60E1\n{reference}", rows()),
    ] {
        let profile = read("a.ban", &text);
        is_head(&profile);
        passed_over(&profile, &["3 points of \"Alarm", "143 points of \"Ref", "not the measured profile"]);
    }
    // A header line with that word makes no other profile of the only one.
    is_head(&read("a.ban", &format!("XYPoints=143\nAlarm=none\n\n{}", rows())));
    // Two profiles of which neither says what it is, and the user's answer.
    let other = ban(|x, y| format!("{x} {}\n", y.parse::<f64>().unwrap() - 0.3));
    let both = format!("MPTypeNo=299\n\n{other}\n{}", rows());
    let message = refused("a.ban", &both);
    assert!(message.contains("2 profiles") && message.contains("147 to 289, 143 points"), "{message}");
    let options = ReadOptions { part: Some("2".into()), ..ReadOptions::default() };
    is_head(&parse("a.ban", both.as_bytes(), &options).unwrap());
    let named = format!("[Left]\n{other}\n[Right]\n{}", rows());
    let options = ReadOptions { part: Some("right".into()), ..ReadOptions::default() };
    is_head(&parse("a.ban", named.as_bytes(), &options).unwrap());
    let options = ReadOptions { part: Some("middle".into()), ..ReadOptions::default() };
    let message = parse("a.ban", named.as_bytes(), &options).unwrap_err().to_string();
    assert!(message.contains("1 \"Left\"") && message.contains("2 \"Right\""), "{message}");
    // What XYPoints counts is the profile.
    let short: String = other.lines().take(100).map(|line| format!("{line}\n")).collect();
    is_head(&read("a.ban", &format!("XYPoints=143\n\n{short}\n{}", rows())));
}

#[test]
fn miniprof_column_orders() {
    for (definition, row) in [
        ("N,Y,A,X", &(|x: &str, y: &str| format!("1,{y},0.1,{x}\n")) as &dyn Fn(&str, &str) -> String),
        ("K;X;C;Y;A", &|x, y| format!("0;{x};NaN;{y};-\n")),
        ("A Y X", &|x, y| format!("0.5 {y} {x}\n")),
        ("Point,X,Y", &|x, y| format!("P1,{x},{y}\n")),
        ("\"X\",\"Y\",*", &|x, y| format!("{x},{y},end\n")),
    ] {
        is_head(&read("a.ban", &format!("ColumnDef={definition}\n\n{}", ban(row))));
    }
    let message = refused("a.ban", &format!("ColumnDef=X,Z\n\n{}", rows()));
    assert!(message.starts_with("a.ban:1:11") && message.contains("columns X and Y"), "{message}");
}

#[test]
fn encodings_and_line_ends() {
    let text = format!("Gerät=Prüfstand 5\nLänge [µm]=3\nXYPoints=143\n\n{}", rows().replace('-', "–"));
    let utf16 = |order: fn(u16) -> [u8; 2], mark: bool| -> Vec<u8> {
        let mark = mark.then_some(0xfeff);
        mark.into_iter().chain(text.encode_utf16()).flat_map(order).collect()
    };
    let windows = text.chars().map(|c| if c == '–' { 0x96 } else { u32::from(c) as u8 }).collect();
    let with_mark = [b"\xef\xbb\xbf", text.as_bytes()].concat();
    for (name, bytes) in [
        ("UTF-8", text.clone().into_bytes()),
        ("UTF-8 with a mark", with_mark),
        ("UTF-16, little end first", utf16(u16::to_le_bytes, true)),
        ("UTF-16, big end first", utf16(u16::to_be_bytes, true)),
        ("Windows-1252", windows),
        ("CRLF", text.replace('\n', "\r\n").into_bytes()),
        ("CR", text.replace('\n', "\r").into_bytes()),
    ] {
        let profile = parse("a.ban", &bytes, &ReadOptions::default());
        is_head(&profile.unwrap_or_else(|error| panic!("{name}: {error}")));
    }
    let plain: Vec<u8> =
        format!("XYPoints=143\n\n{}", rows()).encode_utf16().flat_map(u16::to_le_bytes).collect();
    is_head(&parse("a.ban", &plain, &ReadOptions::default()).unwrap());
}

#[test]
fn rows_without_values_are_listed_and_half_a_row_is_refused() {
    let profile = read("a.ban", &format!("XYPoints=145\n\n{}NaN NaN\n--- ---\n", rows()));
    is_head(&profile);
    passed_over(&profile, &["2 rows without values"]);
    let message = refused("a.ban", &format!("XYPoints=145\n\n{}36.0 NaN\n", rows()));
    assert!(message.starts_with("a.ban:146:6"), "{message}");
    // Two numbers in a sentence are no point.
    let profile = read("a.ban", &format!("XYPoints=143\n60 40 kg per metre\n{}", rows()));
    is_head(&profile);
    passed_over(&profile, &["line 2", "no point"]);
}

/// A Simpack file with these lines around the head's points.
fn simpack(before: &str, after: &str) -> String {
    let rows: String = head().iter().map(|(y, z)| format!("{y} {z}\n")).collect();
    format!("{before}{rows}{after}")
}

#[test]
fn simpack_comments_and_missing_blocks() {
    let full = "% made by hand\nheader.begin ! begins\n version = 1 % one\n type = 0\nheader.end\nspline.begin\n\
                comment = '100 % of it ! all'\nunits.len.f = 1000\nsome words\npoint.begin % y z\n";
    let profile = read("a.prr", &simpack(full, "% between\n! and\npoint.end\nspline.end\n"));
    is_head(&profile);
    passed_over(&profile, &["some words"]);
    for (name, before, after) in [
        ("a.prr", "point.begin\n", "point.end\n"),
        ("a.prr", "spline.begin\nunits.len.f = 1000\n", "spline.end\n"),
        ("a.prr", "type = 0\nunits.len.f = 1000\n", ""),
        ("a.prr", "header.begin\ntype = 0\nspline.begin\nunits.len = 'mm'\npoint.begin\n", "spline.end\n"),
        ("a.prr", "", "point.end\nspline.end\n"),
        ("a", "header.begin\ntype = 0\nheader.end\npoint.begin\n", ""),
    ] {
        let profile = read(name, &simpack(before, after));
        is_head(&profile);
        assert_eq!(profile.format, ProfileFormat::Simpack, "{before}");
    }
    let unended = read("a.prr", &simpack("header.begin\ntype = 0\nspline.begin\npoint.begin\n", ""));
    let header = said(&unended, FindingKind::Header);
    assert!(
        header.contains("the block header is not ended") && header.contains("the block point"),
        "{header}"
    );
}

#[test]
fn simpack_processing_is_obeyed_and_said() {
    let header = "header.begin\ntype = 0\nheader.end\nspline.begin\napprox.smooth = 1e-6\nshift.y = 0,5\n\
                  shift.z = -0.25\nrotate = 180\nunits.ang = 'deg'\nmirror.y = 1\nmirror.z = 1\ninversion = 1\n\
                  units.len = 'mm'\npoint.begin\n";
    // Turned by 180 degrees and mirrored twice, the head is itself again, shifted.
    let rows: String = head().iter().map(|(y, z)| format!("{y} {z} 0.5 measured\n")).collect();
    let profile = read("a.prr", &format!("{header}{rows}point.end\nspline.end\n"));
    for (p, (y, z)) in profile.points.iter().zip(head()) {
        let expected = [(y.parse::<f64>().unwrap() + 0.5) / 1e3, (z.parse::<f64>().unwrap() - 0.25) / 1e3];
        // ROUNDOFF: the sine of 180 degrees on 0.04 m.
        assert!((p.point.x - expected[0]).abs() < 1e-16 && (p.point.y - expected[1]).abs() < 1e-16);
        assert_eq!(p.weight, 0.5);
    }
    let header = said(&profile, FindingKind::Header);
    for text in [
        "line 6: header (noted): shift.y",
        "shift.z",
        "rotate",
        "mirror.y",
        "mirror.z",
        "inversion",
        "approx.smooth = 0.000001",
        "143 points with weights other than 1",
    ] {
        assert!(header.contains(text), "{text} is not in: {header}");
    }
    passed_over(&profile, &["\"measured\" after the numbers of 143 rows"]);
}

#[test]
fn columns_with_any_comment_sign_and_headings() {
    let rows: String = head().iter().map(|(y, z)| format!("{y} {z}\n")).collect();
    for sign in ["#", "%", "!", "*", "//", "\"", ";", "'", "$", "--", "REM ", "c ", "|", "@", "&", ">"] {
        let text = format!("{sign} a rail\n{rows}{sign} 1.0 2.0\n{sign} end\n");
        is_head(&read("a.txt", &text));
    }
    for (name, heading, row) in [
        (
            "a.csv",
            "Lateral [mm];Vertical [mm];Flag",
            &(|y: &str, z: &str| format!("{y};{z};a\n")) as &dyn Fn(&str, &str) -> String,
        ),
        ("a.csv", "\"n\",\"y_mm\",\"z_mm\"", &|y, z| format!("7,{y},{z}\n")),
        ("a.txt", "# s y z", &|y, z| format!("12.5 {y} {z}\n")),
        ("a.txt", "Name\tz/mm\ty/mm", &|y, z| format!("P1\t{z}\t{y}\n")),
        ("a.csv", "x,y,z", &|y, z| format!("{y},100,{z}\n")),
        ("a.csv", "x;z;remark", &|y, z| format!("{};{};ok\n", y.replace('.', ","), z.replace('.', ","))),
    ] {
        let rows: String = head().iter().map(|(y, z)| row(y, z)).collect();
        is_head(&read(name, &format!("{heading}\n{rows}")));
    }
    let text = format!("measured on Monday\nby hand\n{rows}Mean 3.5\n");
    let profile = read("a.txt", &text);
    is_head(&profile);
    passed_over(&profile, &["lines 1 to 2", "measured on Monday", "Mean 3.5"]);
}

/// Lines of words, some with numbers, at any place: the points stay the same, or the file is refused.
#[test]
fn lines_of_words_change_no_point() {
    const LINES: [&str; 14] = [
        "12 May 2026",
        "Radius 300 mm",
        "60 40 kg per metre",
        "54.3 12.0 is the reference of the gauge",
        "R 300, R 80",
        "=====",
        "-----",
        "Page 2 of 3",
        "10:35:02 run 7",
        "UIC 60 rail",
        "7) a note",
        "nan nan",
        "Operator: N. N.",
        "143 points in 2 columns",
    ];
    let rows = |sign: fn(&str) -> String| -> Vec<String> {
        head().iter().map(|(y, z)| format!("{} {}", sign(y), sign(z))).collect()
    };
    let same: fn(&str) -> String = str::to_owned;
    let simpack = "header.begin\ntype = 0\nheader.end\nspline.begin\nunits.len.f = 1000\npoint.begin\n";
    let mut read = 0;
    for (name, header, rows) in [
        ("a.ban", "MPTypeNo=299\nXYPoints=143\n\n", rows(minus)),
        ("a.ban", "ColumnDef=X,Y\n", rows(minus)),
        ("a.prr", simpack, rows(same)),
        ("a.txt", "", rows(same)),
        ("a.txt", "y z\n", rows(same)),
    ] {
        for line in LINES {
            for at in [0, 1, 70, 142, 143] {
                let mut text = rows.clone();
                text.insert(at, line.to_owned());
                let text = format!("{header}{}\n", text.join("\n"));
                if let Ok(profile) = parse(name, text.as_bytes(), &ReadOptions::default()) {
                    is_head(&profile);
                    let listed = profile.findings.iter().filter(|f| f.kind == FindingKind::PassedOver);
                    assert!(listed.count() > 0 || at == 0, "{line}: {:?}", profile.findings);
                    read += 1;
                }
            }
        }
    }
    println!("{read} of {} read, the others refused", 5 * 5 * LINES.len());
    assert!(read > 250, "{read}");
}

/// A number of rows before them, with or without that of the columns, is no point.
#[test]
fn a_count_before_the_rows_is_no_point() {
    let rows: String = head().iter().map(|(y, z)| format!("{y} {z}\n")).collect();
    for count in ["143", "143 2", "2 143", "143 points", "\n143 2\n"] {
        let profile = read("a.txt", &format!("{count}\n{rows}"));
        is_head(&profile);
        passed_over(&profile, &["line"]);
    }
}

/// How a profile is written.
#[derive(Debug, Clone)]
struct Dialect {
    format: usize,
    comma: bool,
    separator: usize,
    quoted: bool,
    words: bool,
    empty_lines: bool,
    swapped: bool,
    header_after: bool,
    sign: usize,
    encoding: usize,
    crlf: bool,
}

fn dialect() -> impl Strategy<Value = Dialect> {
    let flags = || (any::<bool>(), any::<bool>(), any::<bool>(), any::<bool>(), any::<bool>());
    (0..3usize, 0..4usize, 0..4usize, 0..4usize, flags(), any::<bool>(), any::<bool>()).prop_map(
        |(
            format,
            separator,
            sign,
            encoding,
            (comma, quoted, words, empty_lines, swapped),
            header_after,
            crlf,
        )| Dialect {
            // A comma cannot mark decimals and separate fields, but between quotes.
            comma: comma && (separator != 3 || quoted),
            quoted,
            words,
            empty_lines,
            swapped,
            header_after,
            format,
            separator,
            sign,
            encoding,
            crlf,
        },
    )
}

impl Dialect {
    fn write(&self) -> (&'static str, Vec<u8>) {
        let separator = ["\t", "  ", " ; ", ","][self.separator];
        let sign = ["!", "%", "!", "%"][self.sign];
        let mut rows = String::new();
        for (i, (y, z)) in head().iter().enumerate() {
            let (y, z) = if self.format == 0 { (minus(y), minus(z)) } else { (y.clone(), z.clone()) };
            let write = |text: &str| {
                let text = if self.comma { text.replace('.', ",") } else { text.to_owned() };
                if self.quoted { format!("\"{text}\"") } else { text }
            };
            let swapped = self.swapped && self.format != 1;
            let (a, b) = if swapped { (write(&z), write(&y)) } else { (write(&y), write(&z)) };
            let word = if self.words { format!("{separator}good") } else { String::new() };
            rows += &format!("{a}{separator}{b}{word}\n");
            if self.empty_lines && i % 11 == 3 {
                rows += "\n";
            }
            if i % 17 == 5 {
                rows += &format!("{sign} 1.0 2.0 a remark\n");
            }
        }
        let [first, second] = if self.swapped { ["Y", "X"] } else { ["X", "Y"] };
        let (name, header, end) = match self.format {
            0 => (
                "a.ban",
                format!("Rail in Gl. 3\nMPTypeNo=299\nColumnDef={first},{second}\nXYPoints=143\n\n"),
                "",
            ),
            1 => (
                "a.prr",
                "header.begin\ntype=0\nheader.end\nspline.begin\nunits.len.f=1000\npoint.begin\n".into(),
                "point.end\n",
            ),
            _ if self.swapped => ("a.txt", format!("{sign} rail\nz [mm]{separator}y [mm]\n"), ""),
            _ => ("a.txt", format!("{sign} rail\ny [mm]{separator}z [mm]\n"), ""),
        };
        let after = self.header_after && self.format == 0;
        let text = if after { format!("{rows}\n{header}") } else { format!("{header}{rows}{end}") };
        let text = if self.crlf { text.replace('\n', "\r\n") } else { text };
        let bytes = match self.encoding {
            0 => text.into_bytes(),
            1 => [b"\xef\xbb\xbf", text.as_bytes()].concat(),
            2 => [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect(),
            _ => [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(u16::to_be_bytes).collect(),
        };
        (name, bytes)
    }
}

/// The same profile in every dialect is read to the same points.
#[test]
fn every_dialect_gives_the_same_points() {
    let config = Config { cases: 400, failure_persistence: None, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let outcome = runner.run(&dialect(), |dialect| {
        let (name, bytes) = dialect.write();
        let profile = parse(name, &bytes, &ReadOptions::default())
            .map_err(|error| TestCaseError::fail(error.to_string()))?;
        is_head(&profile);
        Ok(())
    });
    if let Err(failure) = outcome {
        panic!("{failure}");
    }
}
