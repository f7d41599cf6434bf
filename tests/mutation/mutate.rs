//! Mistakes of hands, editors and disks in a text.

use railspring_testing::Random;

/// Random numbers of a seed.
pub struct Dice(Random);

impl Dice {
    pub fn new(seed: u64) -> Self {
        Self(Random::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)))
    }

    /// A number below `count`, which is not 0.
    pub fn below(&mut self, count: usize) -> usize {
        self.0.below(count as u64) as usize
    }

    pub fn one_of<'t>(&mut self, list: &[&'t str]) -> &'t str {
        list[self.below(list.len())]
    }
}

/// What a number may become.
const VALUES: [&str; 34] = [
    "nan",
    "NaN",
    "inf",
    "-inf",
    "+inf",
    "1e999",
    "-1e999",
    "1e308",
    "1e-320",
    "-0",
    "0",
    "-1",
    "0.0",
    "1e-9",
    "1e9",
    "12abc",
    "0x10",
    "1_0",
    "1__0",
    "1,5",
    ".5",
    "5.",
    "+5",
    "1e",
    "--1",
    "true",
    "\"5\"",
    "[1]",
    "[]",
    "{}",
    "null",
    "",
    "007",
    "9223372036854775808",
];
/// What a word may become.
const WORDS: [&str; 14] = [
    "",
    " ",
    "beam",
    "foot",
    "local",
    "S1002",
    "60E1",
    "exact",
    "penalty",
    "published",
    "stick",
    "separated",
    "\u{1b}[31m",
    "../x",
];
/// What may stand anywhere.
const PIECES: [&str; 18] = [
    "=",
    "[",
    "]",
    "{",
    "}",
    "\"",
    "'",
    ",",
    "#",
    "\n",
    "\r\n",
    "\0",
    "\u{feff}",
    "\u{2212}",
    ".",
    "nan",
    "\u{1b}[2J",
    "_mm",
];

/// Some mistakes, and what they are.
pub fn mistakes(text: &str, dice: &mut Dice) -> (String, String) {
    let mut text = text.to_string();
    let mut changes = Vec::new();
    for _ in 0..=dice.below(3) {
        let change;
        (text, change) = mistake(&text, dice);
        changes.push(change);
    }
    (text, changes.join("; "))
}

fn mistake(text: &str, dice: &mut Dice) -> (String, String) {
    match dice.below(12) {
        0..=3 => in_place(text, numbers(text), dice, |old, dice| match dice.below(4) {
            0 => format!("-{old}"),
            1 => format!("{old}{}", dice.one_of(&["0", "000", "e3", ".5", " 1", "x"])),
            _ => dice.one_of(&VALUES).to_string(),
        }),
        4 => in_place(text, words(text), dice, |old, dice| match dice.below(3) {
            0 => old.to_uppercase(),
            1 => format!("{old}{}", dice.one_of(&["x", "_m", " "])),
            _ => dice.one_of(&WORDS).to_string(),
        }),
        5 => with_lines(text, dice, "a line left out", |lines, at, _| drop(lines.remove(at))),
        6 => with_lines(text, dice, "a line twice", |lines, at, other| {
            let line = lines[at].clone();
            lines.insert(other, line);
        }),
        7 => with_lines(text, dice, "two lines swapped", |lines, at, other| lines.swap(at, other)),
        8 => {
            let at = boundary(text, dice);
            (text[..at].to_string(), format!("cut off at byte {at}"))
        }
        9 => {
            let (a, b) = (boundary(text, dice), boundary(text, dice));
            let (a, b) = (a.min(b), a.max(b).min(a.min(b) + 60));
            let b = (b..=text.len()).find(|b| text.is_char_boundary(*b)).unwrap_or(text.len());
            (format!("{}{}", &text[..a], &text[b..]), format!("bytes {a} to {b} left out"))
        }
        10 => {
            let (at, piece) = (boundary(text, dice), dice.one_of(&PIECES));
            (format!("{}{piece}{}", &text[..at], &text[at..]), format!("{piece:?} put in at byte {at}"))
        }
        _ => {
            let (from, to) =
                [("\n", "\r\n"), ("\n", "\r"), (".", ","), ("mm", "m"), ("kn", "n"), (" ", "\t"), ("1", "l")]
                    [dice.below(7)];
            (text.replace(from, to), format!("every {from:?} made {to:?}"))
        }
    }
}

fn boundary(text: &str, dice: &mut Dice) -> usize {
    let at = dice.below(text.len() + 1);
    (at..=text.len()).find(|at| text.is_char_boundary(*at)).unwrap_or(text.len())
}

/// Ranges of runs of the characters that `belongs` says, the first of which `begins`.
fn runs(text: &str, begins: fn(char) -> bool, belongs: fn(char) -> bool) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < text.len() {
        let rest = &text[at..];
        let first = rest.chars().next().unwrap_or(' ');
        if begins(first) {
            let end = rest.find(|c| !belongs(c)).map_or(text.len(), |n| at + n);
            found.push((at, end));
            at = end;
        } else {
            // A digit inside a word is none of a number.
            let word = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
            at += word.max(first.len_utf8());
        }
    }
    found
}

fn numbers(text: &str) -> Vec<(usize, usize)> {
    runs(
        text,
        |c| c.is_ascii_digit() || c == '-',
        |c| c.is_ascii_digit() || matches!(c, '.' | 'e' | '-' | '+'),
    )
}

fn words(text: &str) -> Vec<(usize, usize)> {
    runs(text, char::is_alphabetic, |c| c.is_alphanumeric() || c == '_')
}

fn in_place(
    text: &str,
    places: Vec<(usize, usize)>,
    dice: &mut Dice,
    new: impl Fn(&str, &mut Dice) -> String,
) -> (String, String) {
    if places.is_empty() {
        return (text.to_string(), "nothing".into());
    }
    let (from, to) = places[dice.below(places.len())];
    let new = new(&text[from..to], dice);
    let line = 1 + text[..from].matches('\n').count();
    (
        format!("{}{new}{}", &text[..from], &text[to..]),
        format!("line {line}: {:?} made {new:?}", &text[from..to]),
    )
}

fn with_lines(
    text: &str,
    dice: &mut Dice,
    what: &str,
    change: impl Fn(&mut Vec<String>, usize, usize),
) -> (String, String) {
    let mut lines: Vec<String> = text.split_inclusive('\n').map(Into::into).collect();
    if lines.is_empty() {
        return (text.to_string(), "nothing".into());
    }
    let (at, other) = (dice.below(lines.len()), dice.below(lines.len()));
    change(&mut lines, at, other);
    (lines.concat(), format!("{what} (lines {}, {})", at + 1, other + 1))
}
