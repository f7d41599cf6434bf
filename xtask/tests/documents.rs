//! The documents: links, the book's list of pages, and commands that exist.
//!
//! Goal: no dead link among the project's own files, no page that the book leaves out, no command or option that railspring, `cargo xtask` or the
//! aliases of cargo do not have; exactly, no tolerance. The network is not asked.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use clap::Command;
use pulldown_cmark::{CodeBlockKind, Event, Options, Parser, Tag, TagEnd};

/// Folders that have documents, besides that of the project itself.
const FOLDERS: [&str; 3] = ["docs", "data", "python"];
/// A page whose history names commands that are gone.
const HISTORY: &str = "CHANGELOG.md";
/// Commands of cargo itself, and of its plugins, that the documents name.
const OF_CARGO: [&str; 9] = ["bench", "build", "clippy", "deny", "fmt", "install", "run", "test", "update"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// What a page has that others, or the program, depend on.
#[derive(Debug, Default, PartialEq)]
struct Page {
    /// Places in it.
    anchors: BTreeSet<String>,
    /// Links and pictures.
    links: Vec<String>,
    /// Lines of its blocks of commands.
    commands: Vec<String>,
    /// What stands in it as code, by lines.
    code: Vec<String>,
}

impl Page {
    fn of(text: &str) -> Self {
        let mut page = Self::default();
        let (mut heading, mut block) = (None::<String>, None::<String>);
        let (mut seen, mut is_shell) = (BTreeMap::new(), false);
        for event in Parser::new_ext(text, Options::ENABLE_TABLES) {
            if let Event::Code(text) = &event {
                page.code.push(text.to_string());
            }
            match event {
                Event::Start(Tag::Heading { .. }) => heading = Some(String::new()),
                Event::End(TagEnd::Heading(_)) => {
                    let slug = slug(&heading.take().unwrap_or_default());
                    // the second of the same name is numbered
                    let count = seen.entry(slug.clone()).or_insert(0);
                    page.anchors.insert(if *count == 0 { slug } else { format!("{slug}-{count}") });
                    *count += 1;
                }
                Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                    page.links.push(dest_url.to_string())
                }
                Event::Start(Tag::CodeBlock(kind)) => {
                    is_shell = matches!(kind, CodeBlockKind::Fenced(kind) if &*kind == "sh");
                    block = Some(String::new());
                }
                Event::End(TagEnd::CodeBlock) => {
                    let lines = block.take().unwrap_or_default().replace("\\\n", " ");
                    let lines = lines.lines().map(str::to_string);
                    page.code.extend(lines.clone());
                    page.commands.extend(lines.filter(|_| is_shell));
                }
                Event::Text(text) | Event::Code(text) => {
                    for open in [&mut heading, &mut block].into_iter().flatten() {
                        open.push_str(&text);
                    }
                }
                _ => {}
            }
        }
        page
    }
}

/// The anchor of a heading: small letters and digits, blanks as hyphens, as GitHub and mdBook have it.
fn slug(heading: &str) -> String {
    let kept = heading.trim().to_lowercase();
    kept.chars()
        .filter_map(|c| match c {
            ' ' => Some('-'),
            c if c.is_alphanumeric() || c == '-' || c == '_' => Some(c),
            _ => None,
        })
        .collect()
}

/// All documents with what is in them.
fn pages() -> BTreeMap<PathBuf, Page> {
    fn collect(folder: &Path, deep: bool, pages: &mut BTreeMap<PathBuf, Page>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() && deep {
                collect(&path, deep, pages);
            } else if path.extension().is_some_and(|ending| ending == "md") {
                let text = std::fs::read_to_string(&path).unwrap();
                pages.insert(path, Page::of(&text));
            }
        }
    }
    let mut pages = BTreeMap::new();
    collect(root(), false, &mut pages);
    FOLDERS.iter().for_each(|folder| collect(&root().join(folder), true, &mut pages));
    pages
}

/// Links that lead nowhere, as `page: link`.
fn dead(pages: &BTreeMap<PathBuf, Page>) -> Vec<String> {
    let mut dead = Vec::new();
    for (path, page) in pages {
        let outside = |link: &&String| link.starts_with("http") || link.starts_with("mailto:");
        for link in page.links.iter().filter(|link| !outside(link)) {
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = if file.is_empty() { path.clone() } else { path.parent().unwrap().join(file) };
            let lives = match target.canonicalize() {
                Err(_) => false,
                Ok(_) if anchor.is_empty() => true,
                Ok(target) => pages.iter().any(|(other, page)| {
                    other.canonicalize().is_ok_and(|other| other == target) && page.anchors.contains(anchor)
                }),
            };
            if !lives {
                dead.push(format!("{}: {link}", path.display()));
            }
        }
    }
    dead
}

#[test]
fn no_link_is_dead() {
    let pages = pages();
    assert!(pages.len() > 25 && pages.values().map(|page| page.links.len()).sum::<usize>() > 80);
    assert_eq!(dead(&pages), Vec::<String>::new());
}

/// Goal: a missing file, a missing place in a page, and a missing place in another page are found; headings of the same name are numbered.
#[test]
fn a_dead_link_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).unwrap();
        (folder.path().join(name), Page::of(text))
    };
    let pages = BTreeMap::from([
        write(
            "a.md",
            "# A `b` c, d\n## A\n[x](#a-b-c-d) [y](b.md#two-1) [z](none.md) [u](#nowhere) [v](b.md#three) ![w](none.svg)\n",
        ),
        write("b.md", "# Two\n# Two\n[back](a.md) [out](https://example.org/none)\n"),
    ]);
    let found: Vec<String> =
        dead(&pages).iter().map(|fault| fault.rsplit(": ").next().unwrap().to_string()).collect();
    assert_eq!(found, ["none.md", "#nowhere", "b.md#three", "none.svg"]);
}

/// The pages of the book, in their order.
fn summary() -> Vec<String> {
    Page::of(&std::fs::read_to_string(root().join("docs/SUMMARY.md")).unwrap()).links
}

#[test]
fn the_book_has_every_page() {
    let listed = summary();
    let unique: BTreeSet<&String> = listed.iter().collect();
    assert_eq!(unique.len(), listed.len(), "a page stands twice");
    let pages = pages();
    let files = pages.keys().filter_map(|path| path.strip_prefix(root().join("docs")).ok());
    let files: BTreeSet<String> =
        files.map(|path| path.display().to_string()).filter(|name| name != "SUMMARY.md").collect();
    assert_eq!(files, listed.into_iter().collect());
}

/// Words of a line of a shell, up to what ends the command.
fn words(line: &str) -> Vec<&str> {
    let line = line.split(" #").next().unwrap_or_default();
    let line = line.split(['>', '|', ';', '&']).next().unwrap_or_default();
    line.split_whitespace().map(|word| word.trim_matches('"')).collect()
}

/// What is wrong with the words after a program: a name or an option that it does not have.
fn fault(words: &[&str], program: &Command) -> Option<String> {
    // what follows `--` is for another program
    let words = words.split(|word| *word == "--").next()?;
    let mut command = program;
    for word in words.iter().take_while(|word| !word.starts_with('-')) {
        // `profile show`, but `run STUDY`
        match command.find_subcommand(word) {
            Some(inner) => command = inner,
            None if command.has_subcommands() => return Some(format!("no command {word}")),
            None => break,
        }
    }
    let known = |option: &str| {
        command.get_arguments().any(|argument| match option.strip_prefix("--") {
            Some(long) => argument.get_long() == Some(long),
            None => argument.get_short().is_some_and(|short| option == format!("-{short}")),
        })
    };
    let options = words.iter().filter(|word| word.starts_with('-') && word.chars().any(char::is_alphabetic));
    let mut options = options.map(|word| word.split('=').next().unwrap_or(word));
    options
        .find(|option| !known(option))
        .map(|option| format!("no option {option} of {}", command.get_name()))
}

/// A program whose commands know the options for help, too.
fn built(mut program: Command) -> Command {
    program.build();
    program
}

/// Goal: every command of the documents, with its options, is one of the program; a wrong name and a wrong option are found.
#[test]
fn commands_of_the_documents_exist() {
    let program = built(railspring::cli::command());
    let of = |line: &str| match words(line).split_first() {
        Some((&"railspring", rest)) => Some(fault(rest, &program)),
        _ => None,
    };
    let mut checked = 0;
    let mut faults = Vec::new();
    for (path, page) in pages() {
        for fault in page.commands.iter().filter_map(|line| of(line)) {
            checked += 1;
            faults.extend(fault.map(|fault| format!("{}: {fault}", path.display())));
        }
    }
    assert_eq!(faults, Vec::<String>::new());
    assert!(checked > 25, "{checked}");
    let found = |line: &str| of(line).unwrap();
    assert_eq!(found("railspring fitt S1002 60E1").as_deref(), Some("no command fitt"));
    assert_eq!(found("railspring fit S1002 60E1 --sett a=1").as_deref(), Some("no option --sett of fit"));
    assert_eq!(
        found("railspring profile check x.prr --quiett").as_deref(),
        Some("no option --quiett of check")
    );
    assert!(found("railspring profile check x.prr --kind rail  # a comment").is_none());
    assert!(of("cargo test").is_none());
}

/// Names that `cargo long` takes a part of, as far as the sources say: modules with the functions in them.
fn long_tests() -> Vec<String> {
    let name = |test: &xtask::IgnoredTest| {
        let file = test.file.strip_prefix(&test.package).unwrap().with_extension("");
        let modules: Vec<_> = file.iter().skip(1).map(|part| part.to_string_lossy()).collect();
        format!("{}::{}", modules.join("::"), test.function)
    };
    xtask::ignored_tests(&xtask::workspace().unwrap()).unwrap().iter().map(name).collect()
}

/// Goal: every command of cargo that the documents or the heads of long tests name is cargo's own, an alias, a command of `cargo xtask` or a part of the
/// name of a long test; what is none is found.
#[test]
fn commands_of_cargo_exist() {
    let config = std::fs::read_to_string(root().join(".cargo/config.toml")).unwrap();
    let config: toml::Table = config.parse().unwrap();
    let aliases: Vec<&str> = config["alias"].as_table().unwrap().keys().map(String::as_str).collect();
    let (developers, long) = (built(xtask::command()), long_tests());
    let of = |line: &str| match words(line).as_slice() {
        ["cargo", "xtask", rest @ ..] => fault(rest, &developers),
        ["cargo", "long", rest @ ..] => {
            // `PART` stands for any
            let name = rest.iter().find(|word| word.contains(char::is_lowercase) && !word.starts_with('-'));
            let unknown = name.filter(|name| long.iter().all(|test| !test.contains(**name)));
            unknown
                .map(|name| format!("no long test {name}"))
                .or_else(|| fault(&[&["long"][..], rest].concat(), &developers))
        }
        ["cargo", name, ..] => {
            let known = OF_CARGO.contains(name) || aliases.contains(name);
            (!known).then(|| format!("no command {name} of cargo"))
        }
        _ => None,
    };
    let mut faults = Vec::new();
    for (path, page) in pages().into_iter().filter(|(path, _)| !path.ends_with(HISTORY)) {
        let found = page.code.iter().filter_map(|line| of(line));
        faults.extend(found.map(|fault| format!("{}: {fault}", path.display())));
    }
    // this file has wrong ones
    let own = Path::new(file!()).file_name().unwrap();
    for test in xtask::ignored_tests(&xtask::workspace().unwrap())
        .unwrap()
        .iter()
        .filter(|test| !test.file.ends_with(own))
    {
        let text = std::fs::read_to_string(&test.file).unwrap();
        for (at, _) in text.match_indices("cargo long ") {
            let end = |c: char| c.is_whitespace() || "\"`,;:)".contains(c);
            let name = text[at + "cargo long ".len()..].split(end).next().unwrap_or_default();
            faults
                .extend(of(&format!("cargo long {name}")).map(|fault| format!("{}: {fault}", test.function)));
        }
    }
    assert_eq!(faults, Vec::<String>::new());
    assert!(long.len() > 20, "{long:?}");
    assert_eq!(of("cargo longg").as_deref(), Some("no command longg of cargo"));
    assert_eq!(of("cargo long no_such_test").as_deref(), Some("no long test no_such_test"));
    assert_eq!(of("cargo long --lists").as_deref(), Some("no option --lists of long"));
    assert_eq!(of("cargo xtask bench solids").as_deref(), Some("no command solids"));
    assert!(of("cargo xtask bench solid --to 1000000").is_none() && of("cargo long every_key").is_none());
}

/// Goal: the page on exports has a heading for every format of the program, and no other.
#[test]
fn every_export_is_explained() {
    let program = railspring::cli::command();
    let export = program.find_subcommand("export").unwrap();
    let to = export.get_arguments().find(|argument| argument.get_long() == Some("to")).unwrap();
    let formats: BTreeSet<String> =
        to.get_possible_values().iter().map(|format| format.get_name().to_string()).collect();
    assert!(!formats.is_empty());
    let page = std::fs::read_to_string(root().join("docs/use-an-export.md")).unwrap();
    let headings =
        page.lines().filter_map(|line| Some(line.strip_prefix("## `")?.trim_end_matches('`').to_string()));
    assert_eq!(headings.collect::<BTreeSet<_>>(), formats);
}

/// Goal: mdBook builds the book, with a page for every document, and every link of its pages goes to a file that is there.
#[test]
#[ignore = "needs mdBook: `cargo install mdbook`, then `cargo book`"]
fn the_book_is_built() {
    let built = std::process::Command::new("mdbook")
        .arg("build")
        .current_dir(root())
        .output()
        .expect("mdbook is installed: cargo install mdbook");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let book = root().join("book");
    let mut dead = Vec::new();
    for name in summary() {
        // of a folder's README mdBook makes its index
        let page = book.join(name.replace("README.md", "index.md").replace(".md", ".html"));
        let text = std::fs::read_to_string(&page).unwrap_or_else(|e| panic!("{}: {e}", page.display()));
        for part in text.split(" href=\"").chain(text.split(" src=\"")).skip(1) {
            let link = part.split('"').next().unwrap_or_default();
            let file = link.split('#').next().unwrap_or_default();
            let outside =
                file.is_empty() || link.contains("://") || link.starts_with('<') || link.starts_with("data:");
            if !outside && !part.starts_with('<') && !page.parent().unwrap().join(file).exists() {
                dead.push(format!("{name}: {link}"));
            }
        }
    }
    assert_eq!(dead, Vec::<String>::new());
    println!("{}", book.join("introduction.html").display());
}
