//! The comparison in Markdown.

use super::bodies::PressedOn;
use super::record::{Compared, Comparison, JUDGED, OnFlange, Parts, QUANTITIES};

/// How many hold, in a line.
pub fn counts(comparison: &Comparison, on: PressedOn) -> String {
    let [hold, all] = comparison.count(on);
    let judged = if JUDGED.contains(&on) { "" } else { " (not judged)" };
    format!("{}: {hold} of {all} hold from {} kN on{judged}", on.name(), comparison.from_kn)
}

fn percent(part: f64) -> String {
    format!("{:+.2}", 100.0 * part)
}

/// Tables of the largest differences, of their causes where they do not hold, and of the flange.
pub fn markdown(comparison: &Comparison) -> String {
    let limits: Vec<String> =
        QUANTITIES.iter().map(|(name, _, limit)| format!("{name} {:.0} %", 100.0 * limit)).collect();
    let mut text = format!(
        "# Contact against the tables of a half-space program\n\n\
         Largest differences from {} kN on, in per cent, with their loads in kN. Limits: {}. What does not hold is bold. \
         Half-spaces and stiff bodies are judged; flexible ones roll, which no half-space does.\n\n",
        comparison.from_kn,
        limits.join(", ")
    );
    PressedOn::ALL.iter().for_each(|on| text += &format!("- {}\n", counts(comparison, *on)));
    for on in PressedOn::ALL {
        text += &format!("\n## {}\n\n", capital(on.name()));
        text += &heading(&["place (mm)"], &QUANTITIES.map(|quantity| quantity.0));
        for place in comparison.places() {
            text += &format!("| {place} |");
            for (n, (_, _, limit)) in QUANTITIES.into_iter().enumerate() {
                let Some(row) = comparison.worst(&place, on, n) else { continue };
                let off = row.difference(on, n);
                let cell = format!("{} at {:.0}", percent(off), row.load_kn);
                text += &if off.abs() <= limit { format!(" {cell} |") } else { format!(" **{cell}** |") };
            }
            text += "\n";
        }
    }
    text += "\n## What does not hold, and why\n\n\
             The difference is the sum of its parts: the roll of rim and head (flexible against stiff bodies), bodies that end (stiff \
             bodies against half-spaces), the spacing of the grid (against half of it), and the rest between two half-space programs. Per cent.\n\n";
    text += &heading(
        &["pressed on", "place (mm)", "quantity", "load (kN)"],
        &["difference", "roll", "bodies", "grid", "rest"],
    );
    for on in PressedOn::ALL {
        for place in comparison.places() {
            for (n, (name, _, limit)) in QUANTITIES.into_iter().enumerate() {
                let worst = comparison.worst(&place, on, n);
                let Some(row) = worst.filter(|row| row.difference(on, n).abs() > limit) else { continue };
                text += &cause(row, on, n, name);
            }
        }
    }
    text += "\n## Flange\n\n\
             Steps in per cent at one normal force. Path: half-spaces pressed downwards, turned to the normal, against those pressed along it. \
             Conformity: stiff bodies against half-spaces, along the normal. Roll: flexible against stiff bodies, along the normal.\n\n";
    text += &heading(
        &["place (mm)", "angle (\u{b0})", "force (kN)", "tangent of half-spaces (kN/mm)"],
        &["tangent: path", "conformity", "roll", "approach: path", "conformity", "roll"],
    );
    comparison.flange.iter().for_each(|row| text += &on_flange(row));
    text
}

fn capital(name: &str) -> String {
    name[..1].to_uppercase() + &name[1..]
}

/// A heading of words, then of numbers.
fn heading(words: &[&str], numbers: &[&str]) -> String {
    let names: Vec<&str> = words.iter().chain(numbers).copied().collect();
    let lines = "---|".repeat(words.len()) + &"---:|".repeat(numbers.len());
    format!("| {} |\n|{lines}\n", names.join(" | "))
}

fn cause(row: &Compared, on: PressedOn, quantity: usize, name: &str) -> String {
    let Parts { roll, bodies, grid, rest } = row.parts(on, quantity);
    let numbers = [row.difference(on, quantity), roll, bodies, grid, rest].map(percent).join(" | ");
    format!("| {} | {} | {name} | {:.0} | {numbers} |\n", on.name(), row.place(), row.load_kn)
}

fn on_flange(row: &OnFlange) -> String {
    let [approach, tangent] = [0, 1].map(|quantity| row.steps(quantity).map(percent).join(" | "));
    format!(
        "| {}/{} {:+} | {:.1} | {:.0} | {:.0} | {tangent} | {approach} |\n",
        row.rail, row.wheel, row.shift_mm, row.angle_deg, row.normal_kn, row.half_spaces[1]
    )
}
