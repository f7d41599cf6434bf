//! The pages in a real browser (`cargo pages`): Chromium, puppeteer-core and axe-core in the versions of `testing/pages/package-lock.json`.
//!
//! Goal: report and table page scroll sideways on no screen of 390 px, every figure has a text, every link goes somewhere, and axe-core finds no
//! violation; px, no tolerance. A page with a fault of each kind is refused.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const COARSE: &str = include_str!("studies/coarse.toml");
/// Names of the browser.
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

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
#[ignore = "needs Chromium, Node and the package index once: `cargo pages`"]
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
    write(
        "base.toml",
        &COARSE
            .replace("load_min_kn = 5\nload_max_kn = 85\nload_count = 5", "loads_kn = [5, 20, 40, 60, 85]"),
    );
    write("table.toml", TABLE);
    // the program by itself, as installed
    let railspring = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_railspring"));
        command.args(arguments).args(["--quiet", "--cache", "cache"]).current_dir(place.path());
        let output = command.output().unwrap();
        assert!(matches!(output.status.code(), Some(0 | 1)), "{}", said(&output));
    };
    railspring(&["run", "base.toml", "-o", "run"]);
    railspring(&["table", "table.toml", "-o", "table"]);

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
    let output = check(&["run/report.html", "table/table.html"]);
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

fn said(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}
