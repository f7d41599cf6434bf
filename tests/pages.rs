//! The pages in a real browser (`cargo long pages`): Chromium, puppeteer-core and axe-core in the versions of `testing/pages/package-lock.json`.
//!
//! Goal: reports of a study and of two measured profiles, cross-check, table, measured wheels and comparison scroll sideways on no screen of 390 px, every figure has a text, every link goes somewhere, and
//! axe-core finds no violation; px, no tolerance. A page with a fault of each kind is refused. Printed on A4, no page but the last of each is less than
//! half full.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::tables::hollow_wheels;
use railspring::engine::inputs::Inputs;
use railspring::engine::output::OutputFolder;
use railspring::pdf::Printer;

const COARSE: &str = include_str!("studies/coarse.toml");
/// Names of the browser.
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// What a printed page is filled at least, but the last.
const HALF: f64 = 0.5;

/// Two places of a pair.
const TABLE: &str = r#"
name = "places"
base = "base.toml"
shifts_mm = [0, 1]
stiffness_at_kn = [20, 60]
[[wheel]]
profile = "S1002"
[[rail]]
profile = "60E1"
"#;

#[test]
#[ignore = "needs Chromium, Node, pdftoppm, and the package indices of Node and Python once: `cargo long pages`"]
fn pages_pass_in_a_browser() {
    let folders: Vec<PathBuf> =
        std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()).collect();
    let browser = BROWSERS.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    let browser = browser.into_iter().find(|file| file.is_file());
    let browser =
        browser.unwrap_or_else(|| panic!("none of {BROWSERS:?} is installed: apt-get install chromium"));
    let place = tempfile::tempdir().unwrap();
    let path = |name: &str| place.path().join(name);
    let write = |name: &str, text: &str| std::fs::write(path(name), text).unwrap();
    let base =
        COARSE.replace("load_min_kn = 5\nload_max_kn = 85\nload_count = 5", "loads_kn = [5, 20, 40, 60, 85]");
    write("base.toml", &base);
    write("table.toml", TABLE);
    // the program by itself, as installed
    let railspring = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_railspring"));
        command.args(arguments).args(["--quiet", "--cache", "cache"]).current_dir(place.path());
        let output = command.output().unwrap();
        assert!(matches!(output.status.code(), Some(0 | 1)), "{}", said(&output));
    };
    railspring(&["crosscheck", "base.toml", "-o", "run", "--pdf"]);
    railspring(&["run", "base.toml", "-o", "run", "--pdf"]);
    write("worn.toml", &base.replace("S1002", "EN13715-1in40"));
    railspring(&["run", "worn.toml", "-o", "worn"]);
    railspring(&["table", "table.toml", "-o", "table"]);
    hollow_wheels(&path("measured-wheels"), 24);
    let of_fleet = "[[wheel]]\nfolder = \"measured-wheels\"\nstandard = \"S1002\"";
    write("fleet.toml", &TABLE.replace("[[wheel]]\nprofile = \"S1002\"", of_fleet));
    railspring(&["table", "fleet.toml", "-o", "fleet"]);
    // two measured profiles without a study
    let profiles = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/profiles");
    let [wheel, rail] =
        ["worn-s1002.whl", "worn-60e1.prr"].map(|file| profiles.join(file).display().to_string());
    railspring(&["fit", &wheel, &rail, "-o", "measured", "--pdf"]);
    let compare = Command::new(env!("CARGO_BIN_EXE_railspring"))
        .args(["compare", "run", "worn", "--pdf"])
        .current_dir(place.path())
        .output()
        .unwrap();
    assert!(compare.status.success(), "{}", said(&compare));
    for pdf in ["run/report.pdf", "run/crosscheck.pdf", "measured/report.pdf", "compare.pdf"] {
        let full = fullness(&path(pdf));
        println!("{pdf}: {full:.2?}");
        let (_, pages) = full.split_last().unwrap_or_else(|| panic!("{pdf} has no page"));
        assert!(pages.iter().all(|full| *full > HALF), "{pdf}: {full:.2?}");
    }

    // a page that is hardly begun is seen
    write("short.html", "<p>a</p><p style=\"break-before: page\">b</p>");
    Printer::find()
        .unwrap()
        .print(&OutputFolder::create(place.path(), &Inputs::none()).unwrap(), "short.html")
        .unwrap();
    let short = fullness(&path("short.pdf"));
    assert!(short.len() == 2 && short[0] < HALF, "{short:.2?}");

    let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("testing/pages");
    for name in ["check.mjs", "package.json", "package-lock.json"] {
        std::fs::copy(scripts.join(name), path(name)).unwrap();
    }
    let npm =
        Command::new("npm").arg("ci").current_dir(place.path()).output().expect("npm of Node is installed");
    assert!(npm.status.success(), "{}", said(&npm));
    let check = |pages: &[&str]| {
        let mut node = Command::new("node");
        node.arg("check.mjs").arg(&browser).args(pages).current_dir(place.path()).output().unwrap()
    };
    let pages = [
        "run/report.html",
        "run/crosscheck.html",
        "measured/report.html",
        "table/table.html",
        "fleet/table.html",
        "fleet/table_fleet.html",
        "compare.html",
    ];
    let output = check(&pages);
    assert!(output.status.success(), "{}", said(&output));

    let report = std::fs::read_to_string(path("run/report.html")).unwrap();
    let faults = [
        (" lang=\"en\"", "", "html-has-lang"),
        ("<h1>", "<h1 style=\"width:700px\">", " px wide on a screen of 390 px"),
        ("href=\"#meshes\"", "href=\"#nowhere\"", "nothing at #nowhere"),
        ("href=\"#meshes\"", "href=\"none.html\"", "no file none.html"),
        ("<svg role=\"img\" aria-label=", "<svg role=\"img\" data-label=", "1 figures without a text"),
    ];
    for (sound, broken, message) in faults {
        assert!(report.contains(sound), "{sound}");
        write("broken.html", &report.replacen(sound, broken, 1));
        let output = check(&["broken.html"]);
        assert!(
            output.status.code() == Some(1) && said(&output).contains(message),
            "{message}: {}",
            said(&output)
        );
    }
}

/// How far down each page of a PDF something is printed, over the height between its margins.
fn fullness(pdf: &Path) -> Vec<f64> {
    /// Top and bottom margin over the height of the page, of `@page` in the style sheet: 16 of 297 mm.
    const MARGIN: f64 = 16.0 / 297.0;
    let place = tempfile::tempdir().unwrap();
    let pages = place.path().join("page");
    let drawn = Command::new("pdftoppm").args(["-r", "30", "-gray"]).args([pdf, &pages]).output();
    let drawn = drawn.expect("pdftoppm is installed: apt-get install poppler-utils");
    assert!(drawn.status.success(), "{}", said(&drawn));
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(place.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let full = |file: &PathBuf| {
        // `P5`, width, height, largest grey, then a byte for each point
        let content = std::fs::read(file).unwrap();
        let head: Vec<&[u8]> = content.splitn(4, u8::is_ascii_whitespace).collect();
        let number = |at: usize| std::str::from_utf8(head[at]).unwrap().parse::<usize>().unwrap();
        let (width, height) = (number(1), number(2));
        let points = &content[content.len() - width * height..];
        let last = points.chunks(width).rposition(|row| row.iter().any(|grey| *grey < 200)).unwrap_or(0);
        (last as f64 / height as f64 - MARGIN) / (1.0 - 2.0 * MARGIN)
    };
    files.iter().map(full).collect()
}

fn said(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}
