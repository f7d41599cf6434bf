//! The documents: links, the book's list of pages, commands that exist, and reference pages that are those of the program.
//!
//! Goal: no dead link among the project's own files, no page that the book leaves out, no command or option that the program does not have; exactly, no
//! tolerance. The network is not asked.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use pulldown_cmark::{CodeBlockKind, Event, Options, Parser, Tag, TagEnd};

/// Folders that have documents, besides that of the project itself.
const FOLDERS: [&str; 3] = ["docs", "data", "python"];
/// Pages that the program writes.
const REFERENCE: [&str; 3] = ["reference-commands.md", "reference-files.md", "reference-keys.md"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
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
}

impl Page {
    fn of(text: &str) -> Self {
        let mut page = Self::default();
        let (mut heading, mut block) = (None::<String>, None::<String>);
        let mut seen = BTreeMap::new();
        for event in Parser::new_ext(text, Options::ENABLE_TABLES) {
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
                Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(kind))) if &*kind == "sh" => {
                    block = Some(String::new())
                }
                Event::End(TagEnd::CodeBlock) => {
                    let lines = block.take().unwrap_or_default().replace("\\\n", " ");
                    page.commands.extend(lines.lines().map(str::to_string));
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

fn railspring(arguments: &[&str]) -> std::process::Output {
    Command::new(env!("CARGO_BIN_EXE_railspring")).args(arguments).output().unwrap()
}

/// Goal: the reference pages are those that the program writes. To renew them: `cargo renew-reference`.
#[test]
fn the_reference_is_that_of_the_program() {
    let place = tempfile::tempdir().unwrap();
    let output = railspring(&["reference", "-o", place.path().to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let written = std::fs::read_dir(place.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert_eq!(written.collect::<BTreeSet<_>>(), REFERENCE.map(String::from).into());
    for name in REFERENCE {
        let [made, kept] = [place.path().join(name), root().join("docs").join(name)]
            .map(|path| std::fs::read_to_string(path).unwrap());
        let different = made.lines().zip(kept.lines()).find(|(made, kept)| made != kept);
        assert!(made == kept, "docs/{name} is out of date, do `cargo renew-reference`: {different:?}");
    }
    let keys = std::fs::read_to_string(root().join("docs/reference-keys.md")).unwrap();
    for part in ["| `contact.friction` | Coulomb friction", "a number from 0 to 2", "`[scenario.NAME]`"] {
        assert!(keys.contains(part), "{part}");
    }
}

/// Words of a line of a shell after `railspring`, up to what ends the command; none for another program.
fn words(line: &str) -> Option<Vec<String>> {
    let line = line.split(" #").next().unwrap_or_default().trim();
    let line = line.split(['>', '|', ';', '&']).next().unwrap_or_default();
    let mut words = line.split_whitespace().map(|word| word.trim_matches('"').to_string());
    (words.next()? == "railspring").then(|| words.collect())
}

/// What is wrong with a command: a name or an option that the program does not have.
fn fault(words: &[String], help: &mut dyn FnMut(&[String]) -> Option<String>) -> Option<String> {
    let names: Vec<String> =
        words.iter().take_while(|word| !word.starts_with('-')).take(2).cloned().collect();
    // `profile show`, but `run STUDY`
    let command =
        (0..=names.len()).rev().map(|n| &names[..n]).find_map(|command| Some((command, help(command)?)));
    let (command, help) = command?;
    if command.is_empty() && !names.is_empty() {
        return Some(format!("no command {}", names[0]));
    }
    let known = |option: &str| {
        help.split(|c: char| c.is_whitespace() || c == ',' || c == '=' || c == '[').any(|word| word == option)
    };
    let options = words.iter().filter(|word| word.starts_with('-') && word.chars().any(char::is_alphabetic));
    let mut options = options.map(|word| word.split('=').next().unwrap_or(word));
    options.find(|option| !known(option)).map(|option| format!("no option {option} of {}", command.join(" ")))
}

/// Goal: every command of the documents, with its options, is one of the program; a wrong name and a wrong option are found.
#[test]
fn commands_of_the_documents_exist() {
    let mut helps: BTreeMap<Vec<String>, Option<String>> = BTreeMap::new();
    let mut help = |command: &[String]| -> Option<String> {
        let known = helps.entry(command.to_vec()).or_insert_with(|| {
            // a second word that is no command is an argument, with which the help is that of the first
            let arguments: Vec<&str> = command.iter().map(String::as_str).chain(["--help"]).collect();
            let output = railspring(&arguments);
            let text = String::from_utf8(output.stdout).unwrap();
            let usage = format!("Usage: railspring {}", command.join(" "));
            let usage = text.lines().find(|line| line.starts_with(usage.trim()))?;
            let next = usage.trim_start_matches("Usage: railspring").split_whitespace();
            let own = next.zip(command).filter(|(a, b)| *a == b.as_str()).count() == command.len();
            (output.status.success() && own).then_some(text)
        });
        known.clone()
    };
    let mut checked = 0;
    let mut faults = Vec::new();
    for (path, page) in pages() {
        for words in page.commands.iter().filter_map(|line| words(line)) {
            checked += 1;
            faults.extend(fault(&words, &mut help).map(|fault| format!("{}: {fault}", path.display())));
        }
    }
    assert_eq!(faults, Vec::<String>::new());
    assert!(checked > 25, "{checked}");
    let of =
        |line: &str, help: &mut dyn FnMut(&[String]) -> Option<String>| fault(&words(line).unwrap(), help);
    assert_eq!(of("railspring fitt S1002 60E1", &mut help).as_deref(), Some("no command fitt"));
    assert_eq!(
        of("railspring fit S1002 60E1 --sett a=1", &mut help).as_deref(),
        Some("no option --sett of fit")
    );
    assert_eq!(
        of("railspring profile check x.prr --quiett", &mut help).as_deref(),
        Some("no option --quiett of profile check")
    );
    assert!(
        of("railspring profile check x.prr --kind rail  # a comment", &mut help).is_none()
            && words("cargo test").is_none()
    );
}

/// Goal: the page on exports has a heading for every format of the program, and no other.
#[test]
fn every_export_is_explained() {
    let help = String::from_utf8(railspring(&["export", "-h"]).stdout).unwrap();
    let (_, formats) = help.split_once("[possible values: ").unwrap();
    let formats: BTreeSet<String> =
        formats.split(']').next().unwrap().split(", ").map(|f| f.trim().to_string()).collect();
    let page = std::fs::read_to_string(root().join("docs/use-an-export.md")).unwrap();
    let headings =
        page.lines().filter_map(|line| Some(line.strip_prefix("## `")?.trim_end_matches('`').to_string()));
    assert_eq!(headings.collect::<BTreeSet<_>>(), formats);
}

/// Goal: mdBook builds the book, with a page for every document, and every link of its pages goes to a file that is there.
#[test]
#[ignore = "needs mdBook: `cargo install mdbook`, then `cargo book`"]
fn the_book_is_built() {
    let built = Command::new("mdbook")
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
