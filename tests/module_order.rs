//! The modules stand in the order of the pipeline: a module uses only those
//! above it. `lib.rs` says the order; every `crate::` path is held against it.

use std::path::{Path, PathBuf};

/// Modules of a crate in the order of its `lib.rs`.
fn order(source: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(source.join("lib.rs")).unwrap();
    text.lines()
        .filter_map(|line| line.strip_prefix("pub mod ").or_else(|| line.strip_prefix("mod ")))
        .map(|rest| rest.trim_end_matches(';').to_string())
        .collect()
}

/// All Rust files of a module: `name.rs` and those below `name/`.
fn files(source: &Path, module: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let own = source.join(format!("{module}.rs"));
    if own.exists() {
        found.push(own);
    }
    let mut folders = vec![source.join(module)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten() {
            let path = entry.unwrap().path();
            match path.extension() {
                None if path.is_dir() => folders.push(path),
                Some(extension) if extension == "rs" => found.push(path),
                _ => {}
            }
        }
    }
    assert!(!found.is_empty(), "no file of module {module} in {}", source.display());
    found
}

/// Names after `crate::` in a line that is no comment.
fn used(line: &str) -> impl Iterator<Item = &str> {
    let code = line.split("//").next().unwrap_or_default();
    code.split("crate::")
        .skip(1)
        .map(|rest| rest.split(|c: char| !(c.is_alphanumeric() || c == '_')).next().unwrap_or_default())
}

fn breaches(source: &Path) -> Vec<String> {
    let order = order(source);
    assert!(order.len() > 3, "{order:?}");
    let mut found = Vec::new();
    for (rank, module) in order.iter().enumerate() {
        for file in files(source, module) {
            for (number, line) in std::fs::read_to_string(&file).unwrap().lines().enumerate() {
                for name in used(line) {
                    if order.iter().position(|other| other == name).is_some_and(|other| other > rank) {
                        found.push(format!("{}:{}: {module} uses {name}", file.display(), number + 1));
                    }
                }
            }
        }
    }
    found
}

#[test]
fn modules_use_only_those_above_them() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for source in ["calibrate/src", "src"] {
        let found = breaches(&root.join(source));
        assert!(found.is_empty(), "\n{}", found.join("\n"));
    }
}

#[test]
fn a_module_that_looks_down_is_found() {
    let root = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(root.path().join(name), text).unwrap();
    write("lib.rs", "pub mod a;\npub mod b;\npub mod c;\nmod d;\n");
    write("a.rs", "//! crate::b is only named here\n");
    write("b.rs", "use crate::a::X;\nuse crate::d;\n");
    write("c.rs", "use crate::b;\n");
    std::fs::create_dir(root.path().join("d")).unwrap();
    write("d/mod.rs", "use crate::a;\n");
    let found = breaches(root.path());
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].ends_with("b.rs:2: b uses d"), "{found:?}");
}
