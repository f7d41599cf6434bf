//! Sentences of texts in Markdown, and how a page begins.

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};

/// A sentence and where its paragraph begins.
#[derive(Debug, Clone, PartialEq)]
pub struct Sentence {
    /// Line of its paragraph, from 1.
    pub line: usize,
    /// Number of its words.
    pub words: usize,
    /// The sentence.
    pub text: String,
}

/// Words with a point that end no sentence.
const ABBREVIATIONS: [&str; 10] = ["e.g.", "i.e.", "cf.", "No.", "Fig.", "Eq.", "Sec.", "vs.", "al.", "pp."];
/// What may stand behind the point of a sentence.
const CLOSING: [char; 7] = [')', ']', '"', '\'', '”', '’', '*'];

/// The sentences of a text in Markdown, whose first line is the `first` one of its file.
pub(super) fn sentences(markdown: &str, first: usize) -> Vec<Sentence> {
    let mut found = Vec::new();
    for (at, text) in paragraphs(markdown) {
        let line = first + markdown[..at].matches('\n').count();
        for pieces in split(&text) {
            let words = pieces.iter().filter(|piece| piece.contains(char::is_alphanumeric)).count();
            if words > 0 {
                found.push(Sentence { line, words, text: pieces.join(" ") });
            }
        }
    }
    found
}

/// Paragraphs and list items with the place where each begins, without tables, headings, code blocks and pictures. Code in a line has no blanks.
fn paragraphs(markdown: &str) -> Vec<(usize, String)> {
    let (mut found, mut open, mut silent) = (Vec::new(), None::<(usize, String)>, 0_usize);
    for (event, range) in Parser::new_ext(markdown, Options::ENABLE_TABLES).into_offset_iter() {
        match event {
            Event::Start(tag) => {
                if !is_within_a_line(&tag.to_end()) {
                    found.extend(open.take());
                }
                silent += usize::from(is_silent(&tag.to_end()));
            }
            Event::End(tag) => {
                if !is_within_a_line(&tag) {
                    found.extend(open.take());
                }
                silent -= usize::from(is_silent(&tag));
            }
            _ if silent > 0 => {}
            Event::Text(text) => open.get_or_insert_with(|| (range.start, String::new())).1.push_str(&text),
            Event::Code(text) => {
                let (_, paragraph) = open.get_or_insert_with(|| (range.start, String::new()));
                paragraph.push('`');
                paragraph.push_str(&text.replace(char::is_whitespace, "_"));
                paragraph.push('`');
            }
            Event::SoftBreak | Event::HardBreak => {
                if let Some((_, paragraph)) = &mut open {
                    paragraph.push(' ');
                }
            }
            _ => {}
        }
    }
    found.extend(open);
    found
}

/// Whether a tag stands within the line of a paragraph, and begins none.
fn is_within_a_line(tag: &TagEnd) -> bool {
    matches!(tag, TagEnd::Emphasis | TagEnd::Strong | TagEnd::Strikethrough | TagEnd::Link | TagEnd::Image)
}

/// Whether no sentence is counted inside of a tag.
fn is_silent(tag: &TagEnd) -> bool {
    matches!(tag, TagEnd::Heading(_) | TagEnd::CodeBlock | TagEnd::Table | TagEnd::Image | TagEnd::HtmlBlock)
}

/// What stands between the blanks of each sentence of a paragraph. What has a letter or a digit is a word.
fn split(paragraph: &str) -> Vec<Vec<&str>> {
    let pieces: Vec<&str> = paragraph.split_whitespace().collect();
    let (mut found, mut open) = (Vec::new(), Vec::new());
    for (n, piece) in pieces.iter().enumerate() {
        open.push(*piece);
        if pieces.get(n + 1).is_none_or(|next| ends(piece, next)) {
            found.push(std::mem::take(&mut open));
        }
    }
    found
}

/// Whether a sentence ends between two words: a point that is none of an abbreviation or of an initial, and then no small letter.
fn ends(word: &str, next: &str) -> bool {
    let word = word.trim_end_matches(CLOSING).trim_start_matches(['(', '[', '"', '\'']);
    let is_initial = word.strip_suffix('.').is_some_and(|letter| {
        let mut letters = letter.chars();
        letters.next().is_some_and(char::is_uppercase) && letters.next().is_none()
    });
    word.ends_with(['.', '!', '?'])
        && !ABBREVIATIONS.contains(&word)
        && !is_initial
        && !next.starts_with(char::is_lowercase)
}

/// What is wrong with the beginning of a page: its heading is a question, and a paragraph follows, which answers it.
pub(super) fn opening(markdown: &str) -> Option<String> {
    let mut heading = None::<String>;
    let mut is_open = false;
    for event in Parser::new_ext(markdown, Options::ENABLE_TABLES) {
        match event {
            Event::Start(Tag::Heading { .. }) if heading.is_none() => {
                (heading, is_open) = (Some(String::new()), true);
            }
            Event::End(TagEnd::Heading(_)) if is_open => {
                is_open = false;
                let title = heading.as_deref().unwrap_or_default();
                if !title.ends_with('?') {
                    return Some(format!("its title is no question: {title}"));
                }
            }
            Event::Text(text) | Event::Code(text) if is_open => {
                heading.get_or_insert_default().push_str(&text);
            }
            _ if is_open => {}
            Event::Start(Tag::Paragraph) if heading.is_some() => return None,
            _ => return Some("no paragraph under its title answers the question".into()),
        }
    }
    Some("no paragraph under a title".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(markdown: &str) -> Vec<(usize, usize)> {
        sentences(markdown, 1).iter().map(|sentence| (sentence.line, sentence.words)).collect()
    }

    /// Goal: sentences are counted as a reader would, with their lines; what is no sentence is left out. Exactly.
    #[test]
    fn sentences_are_counted() {
        assert_eq!(counts("One two. Three\nfour five!\n\nSix?\n"), [(1, 2), (1, 3), (4, 1)]);
        // numbers, abbreviations, initials, file names and small letters after a point end no sentence
        assert_eq!(
            counts("At 0.5 kN, e.g. K. Popp et al. found `a.toml`. that way (twice). So."),
            [(1, 13), (1, 1)]
        );
        // code and links count their words, marks none
        assert_eq!(counts("**Bold** `k(f) = a + b` and [two words](http://e.org/a.B) – so."), [(1, 6)]);
        // a unit ends a sentence, and is no word
        assert_eq!(counts("By 2 to 3 %. At most 4 %."), [(1, 4), (1, 3)]);
        assert_eq!(counts("# A heading. It is.\n\n```sh\nls a. B\n```\n\n![a picture](x.svg)\n"), []);
        assert_eq!(counts("| a b. C | d |\n|---|---|\n| e. F | g |\n\nText here.\n"), [(5, 2)]);
        // items are texts of their own, with or without a point, and so is what stands in them
        assert_eq!(
            counts("- one two\n- three. Four\n  - five\n\n1. six\n\n   seven eight\n"),
            [(1, 2), (2, 1), (2, 1), (3, 1), (5, 1), (7, 2)]
        );
        assert_eq!(
            sentences("\nA `b c` *d*.", 10),
            [Sentence { line: 11, words: 3, text: "A `b_c` d.".into() }]
        );
    }

    /// Goal: a page begins with a question and a paragraph; what does not is told apart.
    #[test]
    fn a_page_begins_with_its_question() {
        assert_eq!(opening("# What is `k_h`?\n\nA stiffness.\n"), None);
        assert_eq!(opening("# Stiffness\n\nText.\n").as_deref(), Some("its title is no question: Stiffness"));
        for wrong in ["# What?\n\n```sh\nls\n```\n", "# What?\n\n- item\n", "# What?\n\n## Inner\n"] {
            assert_eq!(opening(wrong).as_deref(), Some("no paragraph under its title answers the question"));
        }
        assert!(opening("Text.\n").is_some() && opening("").is_some() && opening("# What?\n").is_some());
    }
}
