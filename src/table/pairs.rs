//! Which wheels of a table stand on which rails.

use std::collections::BTreeMap;
use std::path::Path;

use railspring_profiles::error::InputError;

use super::bodies::{Bodies, Body, listed};
use super::document::TableDocument;
use super::files::List;
use crate::study::nearest;

/// Key of the list of pairs.
const PAIRS_FILE: &str = "pairs_file";

/// A wheel on a rail.
pub(super) type Pair<'a, 'b> = (&'a Body<'b>, &'a Body<'b>);

/// A pair as it is asked for: the key that does so, for messages, and the names of wheel and rail.
struct Asked {
    place: String,
    /// Of a row of a list, for messages: its line.
    line: Option<u64>,
    names: [String; 2],
}

/// The pairs of the table: those of its list or of its cases, or else every wheel on every rail.
pub(super) fn pairs<'a, 'b>(
    table: &Path,
    document: &TableDocument,
    bodies: &'a Bodies<'b>,
    mistaken: &mut dyn FnMut(InputError),
) -> Vec<Pair<'a, 'b>> {
    let Bodies { wheels, rails, .. } = bodies;
    let given = [
        document.pairs.map(|_| "pairs"),
        document.pairs_file.as_ref().map(|_| PAIRS_FILE),
        (!document.case.is_empty()).then_some("case"),
    ];
    let given: Vec<&str> = given.into_iter().flatten().collect();
    if let [first, second, ..] = given[..] {
        let expected = format!("either {first} or {second}");
        mistaken(InputError::new(second, "given", expected, "both say which pairs there are: remove one"));
        return Vec::new();
    }
    let asked = match &document.pairs_file {
        Some(file) => match of_list(table, file) {
            Ok(asked) => asked,
            Err(mistake) => {
                mistaken(mistake);
                return Vec::new();
            }
        },
        None if document.case.is_empty() => {
            return wheels.iter().flat_map(|wheel| rails.iter().map(move |rail| (wheel, rail))).collect();
        }
        None => {
            let of_case = |(index, case): (usize, &super::document::CaseKeys)| Asked {
                place: format!("case[{index}]"),
                line: None,
                names: [case.wheel.clone(), case.rail.clone()],
            };
            document.case.iter().enumerate().map(of_case).collect()
        }
    };
    let known = [Known::of("wheel", wheels), Known::of("rail", rails)];
    let mut pairs = Vec::new();
    let mut unknown = 0;
    for Asked { place, line, names } in &asked {
        let mut found = Vec::new();
        for (known, name) in known.iter().zip(names) {
            match known.bodies.get(name.as_str()) {
                Some(bodies) => found.push(bodies),
                None => {
                    mistaken(known.unknown(name, place, *line, unknown < SUGGESTED));
                    unknown += 1;
                }
            }
        }
        if let [wheels, rails] = found[..] {
            pairs.extend(wheels.iter().flat_map(|wheel| rails.iter().map(|rail| (*wheel, *rail))));
        }
    }
    pairs
}

/// Names for which a similar one is looked for: among thousands that takes a while.
const SUGGESTED: usize = 20;

/// The bodies of a list.
struct Known<'a, 'b> {
    /// `wheel` or `rail`.
    list: &'static str,
    /// By their names, which several have that differ in other keys.
    bodies: BTreeMap<&'a str, Vec<&'a Body<'b>>>,
    /// Their names, for messages.
    names: String,
}

impl<'a, 'b> Known<'a, 'b> {
    fn of(list: &'static str, all: &'a [Body<'b>]) -> Self {
        let mut bodies: BTreeMap<&str, Vec<&Body<'b>>> = BTreeMap::new();
        all.iter().for_each(|body| bodies.entry(body.name.as_str()).or_default().push(body));
        let mut names: Vec<String> = all.iter().map(|body| body.name.clone()).collect();
        names.dedup();
        Self { list, bodies, names: listed(&names) }
    }

    /// The mistake of a name that none of them has.
    fn unknown(&self, name: &str, place: &str, line: Option<u64>, suggest: bool) -> InputError {
        let Self { list, bodies, names } = self;
        let (key, on_line) = match line {
            None => (format!("{place}.{list}"), String::new()),
            Some(line) => (place.to_owned(), format!(" on line {line}")),
        };
        let remedy = match suggest.then(|| nearest(name, bodies.keys().copied())).flatten() {
            Some(near) => format!("correct the name: did you mean {near:?}?"),
            None => "correct the name".into(),
        };
        let expected = format!("the name of a {list} of the table{on_line}: {names}");
        InputError::new(key, format!("{name:?}"), expected, remedy)
    }
}

/// The pairs of a list in CSV with the columns `wheel` and `rail`.
fn of_list(table: &Path, file: &str) -> Result<Vec<Asked>, InputError> {
    let list = List::read(table, file, PAIRS_FILE)?;
    let columns = ["wheel", "rail"].map(|name| list.column(name));
    let refused =
        |expected: String, remedy: &str| InputError::new(PAIRS_FILE, format!("{file:?}"), expected, remedy);
    let [Some(wheel), Some(rail)] = columns else {
        let expected = format!("columns `wheel` and `rail`; it has {}", list.header.join(", "));
        return Err(refused(expected, "name the columns so"));
    };
    if list.rows.is_empty() {
        return Err(refused("at least one pair".into(), "add its pairs, or leave the key out"));
    }
    let asked = |(line, fields): &(u64, Vec<String>)| Asked {
        place: PAIRS_FILE.into(),
        line: Some(*line),
        names: [fields[wheel].clone(), fields[rail].clone()],
    };
    Ok(list.rows.iter().map(asked).collect())
}
