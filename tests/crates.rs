//! What the crates bring along: a library has nothing of the program's, every licence is one of `deny.toml`, and the
//! packages hold what they need.
//!
//! Source: the manifests and `Cargo.lock` as cargo itself resolves them for this platform. Exact: names and files, no
//! tolerance.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// The crates that are published, each after what it depends on.
const PUBLISHED: [&str; 6] = [
    "railspring-profiles",
    "railspring-element",
    "railspring-c",
    "railspring-calibrate",
    "railspring-simulate",
    "railspring",
];

/// Of finite elements only: linear algebra of large systems, orderings, transforms, optimisation. The triangulations of `spade`
/// are not among them: parry needs them with its feature `std`.
const OF_FINITE_ELEMENTS: [&str; 4] = ["faer", "feral-metis", "rustfft", "argmin"];

/// Of the program only: arguments, figures, templates, TOML, progress bars, tables, signals.
const OF_THE_PROGRAM: [&str; 7] = ["clap", "plotters", "minijinja", "toml", "indicatif", "csv", "ctrlc"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Standard output of cargo in the project's folder, without network.
fn cargo(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO"))
        .args(arguments)
        .arg("--offline")
        .current_dir(root())
        .output()
        .expect("cargo that built this test");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// `cargo metadata` for the platform of this test.
fn metadata() -> Value {
    let version = Command::new("rustc").arg("-vV").current_dir(root()).output().expect("rustc");
    let version = String::from_utf8(version.stdout).unwrap();
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).expect("host of rustc");
    let text = cargo(&["metadata", "--format-version", "1", "--locked", "--filter-platform", host]);
    serde_json::from_str(&text).unwrap()
}

fn array<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().unwrap_or_else(|| panic!("no list {key}"))
}

fn text<'a>(value: &'a Value, key: &str) -> &'a str {
    value[key].as_str().unwrap_or_default()
}

/// Packages by their identifier.
fn packages(metadata: &Value) -> BTreeMap<&str, &Value> {
    array(metadata, "packages").iter().map(|package| (text(package, "id"), package)).collect()
}

fn package<'a>(metadata: &'a Value, name: &str) -> &'a Value {
    let named = |package: &&Value| text(package, "name") == name;
    array(metadata, "packages").iter().find(named).unwrap_or_else(|| panic!("no package {name}"))
}

/// Names of all that a package needs to be built and run, itself included; what its tests and benchmarks need is left
/// out.
fn needed<'a>(metadata: &'a Value, name: &str) -> BTreeSet<&'a str> {
    let packages = packages(metadata);
    let nodes: BTreeMap<&str, &Value> =
        array(&metadata["resolve"], "nodes").iter().map(|node| (text(node, "id"), node)).collect();
    let mut seen = BTreeSet::new();
    let mut open = vec![text(package(metadata, name), "id")];
    while let Some(id) = open.pop() {
        if seen.insert(id) {
            let needs =
                |dependency: &&Value| array(dependency, "dep_kinds").iter().any(|k| text(k, "kind") != "dev");
            open.extend(
                array(nodes[id], "deps").iter().filter(needs).map(|dependency| text(dependency, "pkg")),
            );
        }
    }
    seen.into_iter().map(|id| text(packages[id], "name")).collect()
}

/// Goal: a user of a library builds no argument parser, no plotting and no templates. That the walk sees them at all is
/// shown on the program, which has every one.
#[test]
fn a_library_needs_nothing_of_the_program() {
    let metadata = metadata();
    let program = needed(&metadata, "railspring");
    assert!(OF_THE_PROGRAM.iter().all(|name| program.contains(name)), "{program:?}");
    for library in &PUBLISHED[..5] {
        let needed = needed(&metadata, library);
        assert!(needed.contains("nalgebra") && needed.len() > 10, "{library}: {needed:?}");
        let found: Vec<_> = OF_THE_PROGRAM.iter().filter(|name| needed.contains(*name)).collect();
        assert!(found.is_empty(), "{library} needs {found:?}");
    }
    assert!(!needed(&metadata, "railspring-calibrate").contains("railspring-simulate"));
}

/// Goal: who reads profiles, or loads the contact element, builds no finite elements. That the walk sees them is shown on the crate that has them.
#[test]
fn profiles_need_no_finite_elements() {
    let metadata = metadata();
    let calibrate = needed(&metadata, "railspring-calibrate");
    assert!(OF_FINITE_ELEMENTS.iter().all(|name| calibrate.contains(name)), "{calibrate:?}");
    for name in ["railspring-profiles", "railspring-c"] {
        let needed = needed(&metadata, name);
        let found: Vec<_> = OF_FINITE_ELEMENTS.iter().filter(|name| needed.contains(*name)).collect();
        assert!(found.is_empty() && !needed.contains("railspring-calibrate"), "{name}: {found:?}");
    }
}

/// Goal: `deny.toml` is true without cargo-deny: every package that is built has a licence that it allows, and it allows
/// none that no package has.
#[test]
fn every_licence_is_an_allowed_one() {
    let deny: toml::Table = std::fs::read_to_string(root().join("deny.toml")).unwrap().parse().unwrap();
    let allowed: BTreeSet<&str> =
        deny["licenses"]["allow"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    let metadata = metadata();
    let packages = packages(&metadata);
    let mut used = BTreeSet::new();
    for node in array(&metadata["resolve"], "nodes") {
        let package = packages[text(node, "id")];
        let (name, licence) = (text(package, "name"), text(package, "license"));
        let expression = spdx::Expression::parse_mode(licence, spdx::ParseMode::LAX)
            .unwrap_or_else(|error| panic!("{name}: licence {licence:?}: {error}"));
        let is_allowed = |requirement: &spdx::LicenseReq| {
            let id = requirement.license.id().map_or("", |id| id.name);
            requirement.addition.is_none() && allowed.contains(id)
        };
        assert!(
            expression.evaluate(is_allowed),
            "{name}: licence {licence:?}; deny.toml allows {allowed:?}: replace the package, or allow the licence there"
        );
        for requirement in expression.requirements() {
            used.extend(requirement.req.license.id().map(|id| id.name));
        }
    }
    let unused: Vec<_> = allowed.difference(&used).collect();
    assert!(unused.is_empty(), "deny.toml allows {unused:?}, which no package has");
}

/// Goal: what a registry asks for is in the manifests, and a path dependency names the version that is there.
#[test]
fn manifests_are_complete() {
    let metadata = metadata();
    for name in PUBLISHED {
        let package = package(&metadata, name);
        for key in ["description", "license", "readme", "rust_version"] {
            assert!(!text(package, key).is_empty(), "{name}: no {key}");
        }
        let folder = Path::new(text(package, "manifest_path")).parent().unwrap();
        for file in [text(package, "readme"), "LICENSE-MIT", "LICENSE-APACHE"] {
            assert!(folder.join(file).is_file(), "{name}: no {file}");
        }
        let keywords = array(package, "keywords").len();
        assert!((1..=5).contains(&keywords), "{name}: {keywords} keywords, a registry takes five");
        assert!(!array(package, "categories").is_empty(), "{name}: no categories");
        for dependency in array(package, "dependencies") {
            let (on, kind) = (text(dependency, "name"), text(dependency, "kind"));
            if !text(dependency, "path").is_empty() && kind != "dev" {
                assert!(PUBLISHED.contains(&on), "{name} needs {on}, which is not published");
                let version = text(self::package(&metadata, on), "version");
                assert_eq!(text(dependency, "req"), format!("^{version}"), "{name} on {on}");
            }
        }
    }
}

/// Files that a package needs beyond its modules: those that `include_str!` names outside tests, and those to which its
/// README links.
fn referenced(folder: &Path, files: &BTreeSet<String>) -> BTreeSet<String> {
    let between = |text: &str, start: &str, end: char| -> Vec<String> {
        text.split(start).skip(1).filter_map(|rest| Some(rest.split_once(end)?.0.to_string())).collect()
    };
    let mut found = BTreeSet::new();
    let sources =
        files.iter().filter(|f| f.starts_with("src/") && f.ends_with(".rs") && !f.ends_with("tests.rs"));
    for source in sources {
        let text = std::fs::read_to_string(folder.join(source)).unwrap();
        let text = text.split("#[cfg(test)]").next().unwrap();
        let beside = Path::new(source).parent().unwrap();
        found.extend(between(text, "include_str!(\"", '"').iter().map(|path| joined(beside, path)));
    }
    let readme = std::fs::read_to_string(folder.join("README.md")).unwrap();
    let links = between(&readme, "](", ')');
    // a file, whatever the heading
    let files = links.iter().filter(|link| !link.contains(':')).filter_map(|link| link.split('#').next());
    found.extend(files.filter(|file| !file.is_empty()).map(|file| joined(Path::new(""), file)));
    found
}

/// `path` seen from the folder `from`, without `..`.
fn joined(from: &Path, path: &str) -> String {
    let mut joined = PathBuf::from(from);
    for part in path.split('/') {
        if part == ".." {
            joined.pop();
        } else {
            joined.push(part);
        }
    }
    joined.to_string_lossy().replace('\\', "/")
}

/// Goal: a package builds and its README has no dead links; the tests of the repository stay out of it.
#[test]
fn packages_hold_what_they_need() {
    let metadata = metadata();
    for name in PUBLISHED {
        let manifest = text(package(&metadata, name), "manifest_path");
        let listed = cargo(&["package", "--list", "--allow-dirty", "--manifest-path", manifest]);
        let files: BTreeSet<String> = listed.lines().map(|line| line.replace('\\', "/")).collect();
        let needed = referenced(Path::new(manifest).parent().unwrap(), &files);
        assert!(needed.contains("README.md") || name == "railspring", "{name}: {needed:?}");
        assert!(name != "railspring" || needed.contains("reference/requirements.lock"), "{needed:?}");
        let folder = |file: &String| files.iter().any(|f| f.starts_with(&format!("{file}/")));
        let missing: Vec<_> = needed.iter().filter(|file| !files.contains(*file) && !folder(file)).collect();
        assert!(missing.is_empty(), "{name}: not in the package: {missing:?}");
        let strays: Vec<_> =
            files.iter().filter(|f| f.starts_with("tests/") || f.starts_with(".ci/")).collect();
        assert!(strays.is_empty(), "{name}: {strays:?}");
        for licence in ["LICENSE-MIT", "LICENSE-APACHE", "Cargo.toml"] {
            assert!(files.contains(licence), "{name}: no {licence}");
        }
    }
}

/// Source: `use` lines of the Python module, which is no member of the workspace and is not built by the tests. Goal: its manifest
/// has every crate of the project that it uses.
#[test]
fn the_python_module_depends_on_what_it_uses() {
    let read = |file: &str| std::fs::read_to_string(root().join("python").join(file)).unwrap();
    let (source, manifest) = (read("src/lib.rs"), read("Cargo.toml"));
    let used: BTreeSet<&str> = source
        .lines()
        .filter_map(|line| line.strip_prefix("use railspring_"))
        .filter_map(|rest| rest.split("::").next())
        .collect();
    assert!(used.contains("calibrate"), "{used:?}");
    for name in used {
        assert!(
            manifest.contains(&format!("\nrailspring-{name} = ")),
            "python/Cargo.toml lacks railspring-{name}"
        );
    }
}
