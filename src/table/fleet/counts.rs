//! How many places there are, which have no law, and why.

use std::collections::{BTreeMap, BTreeSet};

use super::bodies::Bodies;
use super::section::{Section, Table};
use crate::table::made::Status;

/// Reasons that are listed.
const REASONS: usize = 12;
/// Files that are named for a reason.
const NAMED: usize = 5;
/// Files without any law that are named.
const FAILED: usize = 60;

/// Places of a reason and of whom.
#[derive(Default)]
struct Of {
    places: usize,
    example: String,
    bodies: BTreeSet<String>,
}

/// The section.
pub fn section(bodies: &Bodies<'_>) -> Section {
    let kind = bodies.kind;
    let mut section = Section::new(
        &format!("{}-counts", kind.name()),
        &format!("What was computed of {} measured {}", bodies.bodies.len(), kind.several()),
    );
    let (Some(status), Some(reason)) = (bodies.rows.column("status"), bodies.rows.column("reason")) else {
        section.missing.push("The rows have no column `status` or none with a reason.".into());
        return section;
    };
    let rows = || bodies.bodies.iter().flat_map(|body| body.rows.iter().map(move |row| (body, *row)));
    let is = |row: usize, wanted: Status| bodies.rows.rows[row][status].text() == wanted.name();
    let count = |wanted: Status| rows().filter(|(_, row)| is(*row, wanted)).count();
    section.text.push(format!(
        "{} places: {} complete, {} with a law that ends early, {} without a law.",
        rows().count(),
        count(Status::Complete),
        count(Status::EndsEarly),
        count(Status::Failed)
    ));
    let mut reasons: BTreeMap<(String, &'static str), Of> = BTreeMap::new();
    for (body, row) in rows() {
        for status in [Status::EndsEarly, Status::Failed].into_iter().filter(|status| is(row, *status)) {
            let text = bodies.rows.rows[row][reason].text();
            let of = reasons.entry((without_numbers(&text), status.name())).or_default();
            if of.places == 0 {
                of.example = text;
            }
            of.places += 1;
            of.bodies.insert(body.name.clone());
        }
    }
    let mut reasons: Vec<_> = reasons.into_iter().collect();
    reasons.sort_by_key(|(_, of)| std::cmp::Reverse(of.places));
    if !reasons.is_empty() {
        let caption = format!(
            "The most frequent reasons, {} of {}. Reasons that differ in their numbers alone count as one, with the first as example.",
            reasons.len().min(REASONS),
            reasons.len()
        );
        let mut table =
            Table::new(caption, &["#places", &format!("#{}", kind.several()), "status", "reason", "files"]);
        table.rows.extend(reasons.iter().take(REASONS).map(|((_, status), of)| {
            let counts = [of.places, of.bodies.len()].map(|count| count.to_string());
            let [places, several] = counts;
            vec![places, several, (*status).into(), of.example.clone(), named(&of.bodies, NAMED)]
        }));
        section.table(table);
    }
    let failed: BTreeSet<String> = bodies
        .bodies
        .iter()
        .filter(|body| body.rows.iter().all(|row| is(*row, Status::Failed)))
        .map(|body| body.name.clone())
        .collect();
    if !failed.is_empty() {
        section.text.push(format!(
            "{} of {} {} have no law at any place: {}.",
            failed.len(),
            bodies.bodies.len(),
            kind.several(),
            named(&failed, FAILED)
        ));
    }
    section
}

/// The first names, and how many more there are.
pub fn named(names: &BTreeSet<String>, count: usize) -> String {
    let first: Vec<&str> = names.iter().take(count).map(String::as_str).collect();
    let more = names.len().saturating_sub(count);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{}{more}", first.join(", "))
}

/// A text with a sign in the place of each number.
fn without_numbers(text: &str) -> String {
    let mut plain = String::new();
    for letter in text.chars() {
        let is_of_number = letter.is_ascii_digit() || (letter == '.' && plain.ends_with('#'));
        match is_of_number {
            true if plain.ends_with('#') => {}
            true => plain.push('#'),
            false => plain.push(letter),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: reasons are the same whatever their numbers; names are cut with their count.
    #[test]
    fn reasons_and_names() {
        assert_eq!(without_numbers("at 12.5 kN, y = 3 mm"), without_numbers("at 7 kN, y = 40.25 mm"));
        assert_ne!(without_numbers("at 12 kN"), without_numbers("at 12 mm"));
        let names = ["a", "b", "c"].map(String::from).into();
        assert_eq!([named(&names, 2), named(&names, 3)], ["a, b and 1 more", "a, b, c"]);
    }
}
