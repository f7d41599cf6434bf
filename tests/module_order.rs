//! The modules stand in the order of the pipeline: a module uses only those above it, in a crate and inside a
//! module. The file that lists them says the order; every path that starts with `crate::` or `super::` is compared with it.
//! A parent stands last: what its modules need of it stands in a module of its own.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A module as the names that lead to it from its crate.
type Module = Vec<String>;

/// A crate's modules with their files, and the order of the modules inside each.
struct Tree {
    files: Vec<(Module, PathBuf)>,
    order: BTreeMap<Module, Vec<String>>,
}

impl Tree {
    fn read(source: &Path) -> Self {
        let mut tree = Self { files: Vec::new(), order: BTreeMap::new() };
        tree.add(Vec::new(), source.join("lib.rs"), source.to_path_buf());
        tree
    }

    /// Adds a module, its `file`, and the modules that it lists, which lie in `folder`.
    fn add(&mut self, module: Module, file: PathBuf, folder: PathBuf) {
        let text =
            code(&std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display())));
        let mut names = Vec::new();
        let mut test = false;
        for line in text.lines() {
            let listed = line
                .trim_start_matches("pub(crate) ")
                .trim_start_matches("pub(super) ")
                .trim_start_matches("pub ")
                .strip_prefix("mod ")
                .and_then(|rest| rest.trim().strip_suffix(';'));
            // what only tests need stands below everything
            if let Some(name) = listed.filter(|_| !test) {
                names.push(name.to_string());
            }
            test = line.starts_with("#[cfg(test)]");
        }
        for name in &names {
            let inner = [module.clone(), vec![name.clone()]].concat();
            let below = folder.join(name);
            self.add(inner, folder.join(format!("{name}.rs")), below);
        }
        self.order.insert(module.clone(), names);
        self.files.push((module, file));
    }

    /// Uses of a module by one that stands above it.
    fn breaches(&self) -> Vec<String> {
        let mut found = Vec::new();
        for (module, file) in &self.files {
            let text = code(&std::fs::read_to_string(file).unwrap());
            for used in paths(&text, module) {
                let shared = module.iter().zip(&used).take_while(|(a, b)| a == b).count();
                let (Some(user), Some(name)) = (module.get(shared), used.get(shared)) else { continue };
                let order = &self.order[&module[..shared]];
                let rank = |name: &String| order.iter().position(|other| other == name);
                if rank(name).is_some_and(|below| rank(user).is_some_and(|above| below > above)) {
                    found.push(format!("{}: {user} uses {name}", file.display()));
                }
            }
        }
        found
    }

    /// Uses of what the file of a module has by the modules inside it.
    fn looks_up(&self) -> Vec<String> {
        let mut found = Vec::new();
        for (module, file) in &self.files {
            let text = code(&std::fs::read_to_string(file).unwrap());
            for used in paths(&without_tests(&text), module) {
                let known =
                    (0..=used.len()).rev().find(|&n| self.order.contains_key(&used[..n])).unwrap_or(0);
                if known < module.len() && module.starts_with(&used[..known]) {
                    let name = used.get(known).map_or("all of it", String::as_str);
                    let parent = [vec!["crate".to_string()], used[..known].to_vec()].concat().join("::");
                    found.push(format!("{}: uses {name} of {parent}", file.display()));
                }
            }
        }
        found
    }
}

/// The text up to its tests, and without the lines before them that only tests need.
fn without_tests(text: &str) -> String {
    let mut kept = String::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if !["#[cfg(test)]", "#[cfg(all(test, unix))]"].contains(&line.trim()) {
            kept.push_str(line);
            kept.push('\n');
        } else if lines.next().is_some_and(|next| next.starts_with("mod ") && next.ends_with('{')) {
            break;
        }
    }
    kept
}

/// The text without comments.
fn code(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// Paths from the crate that a file of `module` names.
fn paths(text: &str, module: &Module) -> Vec<Module> {
    let mut found = Vec::new();
    let word = |c: char| c.is_alphanumeric() || c == '_';
    for (at, _) in text.match_indices("crate::").chain(text.match_indices("super::")) {
        // a visibility, as `pub(in crate::a)`, is no use
        if text[..at].ends_with(|c: char| word(c) || c == ':') || text[..at].ends_with("(in ") {
            continue;
        }
        let mut rest = &text[at..];
        let mut base = module.clone();
        if let Some(after) = rest.strip_prefix("crate::") {
            (base, rest) = (Vec::new(), after);
        }
        while let Some(after) = rest.strip_prefix("super::") {
            base.pop();
            rest = after;
        }
        for tail in tails(rest) {
            let names = tail.into_iter().filter(|name| name != "self");
            found.push(base.iter().cloned().chain(names).collect());
        }
    }
    found
}

/// What follows the start of a path: one path, or those of a group.
fn tails(rest: &str) -> Vec<Module> {
    let Some(group) = rest.strip_prefix('{') else {
        let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':')).unwrap_or(rest.len());
        let path = rest[..end].split("::").filter(|name| !name.is_empty());
        let mut names: Module = path.map(str::to_string).collect();
        let inner = rest[end..].starts_with('{').then(|| tails(&rest[end..]));
        return match inner {
            Some(inner) => inner.into_iter().map(|tail| [names.clone(), tail].concat()).collect(),
            None => vec![std::mem::take(&mut names)],
        };
    };
    let (mut depth, mut start, mut found) = (0, 0, Vec::new());
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            ',' | '}' if depth == 0 => {
                found.extend(tails(group[start..at].trim()));
                start = at + 1;
                if c == '}' {
                    break;
                }
            }
            _ => {}
        }
    }
    found
}

#[test]
fn modules_use_only_those_above_them() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for source in
        ["profiles/src", "element/src", "element/c/src", "calibrate/src", "simulate/src", "src", "xtask/src"]
    {
        let tree = Tree::read(&root.join(source));
        assert!(!tree.order[&Vec::new()].is_empty(), "{source}");
        let found = tree.breaches();
        assert!(found.is_empty(), "\n{}", found.join("\n"));
    }
}

#[test]
fn a_parent_stands_last() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for source in
        ["profiles/src", "element/src", "element/c/src", "calibrate/src", "simulate/src", "src", "xtask/src"]
    {
        let found = Tree::read(&root.join(source)).looks_up();
        assert!(found.is_empty(), "\n{}", found.join("\n"));
    }
}

/// Goal: every file of tests is a module of its package's one test program; another would not be compiled.
#[test]
fn every_file_of_tests_is_run() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for tests in ["tests", "profiles/tests", "calibrate/tests", "simulate/tests", "xtask/tests"]
        .map(|folder| root.join(folder))
    {
        let suite = std::fs::read_to_string(tests.join("suite.rs")).unwrap();
        for entry in std::fs::read_dir(&tests).unwrap() {
            let path = entry.unwrap().path();
            let is_module = path.extension().is_some_and(|kind| kind == "rs");
            let name = path.file_stem().unwrap().to_str().unwrap();
            let line = format!("mod {name};");
            let listed = name == "suite" || suite.lines().any(|other| other == line);
            assert!(!is_module || listed, "{}: add `{line}` to suite.rs", path.display());
        }
    }
}

#[test]
fn a_module_that_looks_down_is_found() {
    let root = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let file = root.path().join(name);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(file, text).unwrap();
    };
    write("lib.rs", "pub mod a;\npub mod b;\npub mod c;\nmod d;\nmod e;\n#[cfg(test)]\nmod samples;\n");
    write("a.rs", "//! crate::b is only named here\n");
    write("b.rs", "use crate::a::X;\nuse crate::{a::Y, d::{Z}};\n#[cfg(test)]\nuse crate::samples;\n");
    write("c.rs", "use crate::b;\npub mod first;\npub mod second;\n");
    write("c/first.rs", "use super::{first::X,\n second::{Y, Z}};\n");
    write("c/second.rs", "use super::first;\nuse super::super::b;\nuse crate::c::first;\n");
    write("d.rs", "use crate::a;\nmod only;\n");
    write("d/only.rs", "use super::only;\n#[cfg(all(test, unix))]\nmod tests {\n use super::super::*;\n}\n");
    write("e.rs", "mod part;\nmod user;\nmod deep;\npub use part::Part;\npub struct Whole;\n");
    write(
        "e/part.rs",
        "pub(in crate::e) struct Part;\n#[cfg(test)]\nmod tests {\n use crate::e::Whole;\n}\n",
    );
    write("e/user.rs", "use super::Whole;\nuse super::part::Part;\nuse super::{part, Part};\n");
    write("e/deep.rs", "mod low;\n");
    write(
        "e/deep/low.rs",
        "use super::super::{self, part};\nuse crate::top;\nuse crate::{a, e::part, e::Part};\n",
    );
    let mut found = Tree::read(root.path()).breaches();
    found.dedup();
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found.iter().any(|breach| breach.ends_with("b.rs: b uses d")), "{found:?}");
    assert!(found.iter().any(|breach| breach.ends_with("first.rs: first uses second")), "{found:?}");
    let found = Tree::read(root.path()).looks_up();
    let ends = [
        "deep/low.rs: uses all of it of crate::e",
        "deep/low.rs: uses top of crate",
        "deep/low.rs: uses Part of crate::e",
        "user.rs: uses Whole of crate::e",
        "user.rs: uses Part of crate::e",
    ];
    assert_eq!(found.len(), ends.len(), "{found:?}");
    for end in ends {
        assert!(found.iter().any(|breach| breach.ends_with(end)), "{end}: {found:?}");
    }
}
