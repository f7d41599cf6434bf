//! Several profiles in one table: pairs of columns side by side, as of the left and the right wheel, and sections one
//! after the other, told apart by the column that holds their place along the track.

use std::collections::BTreeMap;
use std::ops::Range;

use super::blocks::OTHERS;
use super::finding::{Action, Finding, FindingKind};
use super::part::Part;
use super::text::{error_on, unit_of};
use crate::error::Result;

/// A section has at least so many points.
const FEWEST: usize = 8;
/// Part of the width of the wider one that two sections of one cloud share.
const SHARED: f64 = 0.75;

/// Two columns, and what their names say besides y and z.
#[derive(Debug, PartialEq)]
pub(super) struct Pair {
    pub at: (usize, usize),
    pub label: String,
}

/// The axis that the name of a column holds among `axes`, and what else it says.
fn axis_and_label(head: &str, axes: [&str; 2]) -> Option<(usize, String)> {
    let words: Vec<&str> =
        head.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    let numbered = |word: &str, axis: &str| {
        word.strip_prefix(axis).filter(|rest| rest.chars().all(|c| c.is_ascii_digit())).map(str::to_owned)
    };
    let axis_of =
        |word: &&str| (0..2).find_map(|axis| numbered(word, axes[axis]).map(|number| (axis, number)));
    let at = words.iter().position(|word| axis_of(word).is_some())?;
    let (axis, number) = axis_of(&words[at])?;
    let others = words.iter().enumerate().filter(|(i, word)| *i != at && unit_of(word).is_none());
    let label = others.map(|(_, word)| *word).chain(Some(number.as_str()).filter(|n| !n.is_empty()));
    Some((axis, label.collect::<Vec<_>>().join(" ")))
}

/// The pairs of columns with these axes, in the order of their first columns; a name given twice keeps its first column.
pub(super) fn pairs(heads: &[String], axes: [&str; 2]) -> Vec<Pair> {
    let named: Vec<Option<(usize, String)>> = heads.iter().map(|head| axis_and_label(head, axes)).collect();
    let column = |axis: usize, label: &str| {
        named.iter().position(|named| named.as_ref().is_some_and(|(a, l)| *a == axis && l == label))
    };
    let mut pairs: Vec<Pair> = Vec::new();
    for (_, label) in named.iter().flatten() {
        if pairs.iter().all(|pair| pair.label != *label)
            && let Some(at) = column(0, label).zip(column(1, label))
        {
            pairs.push(Pair { at, label: label.clone() });
        }
    }
    pairs
}

/// The pair of columns that is the profile, where their names have several, such as `y_left, z_left, y_right, z_right`;
/// none where they have one. `axes` are the names of y and z.
///
/// # Errors
/// Several pairs, none of which `part` names.
pub(super) fn chosen_pair(
    name: &str,
    (heads, line): (&[String], usize),
    axes: (&str, &str),
    part: &Part,
) -> Result<Option<(Pair, Finding)>> {
    let mut pairs = pairs(heads, [axes.0, axes.1]);
    // Without a label of its own the first pair is the profile, and the others belong to it.
    if pairs.len() < 2 || pairs.iter().any(|pair| pair.label.is_empty()) {
        return Ok(None);
    }
    let is_other = |pair: &Pair| OTHERS.iter().any(|word| pair.label.contains(word));
    let others = pairs.iter().filter(|pair| is_other(pair)).count();
    let list = |pairs: &[Pair]| {
        let one = |(i, pair): (usize, &Pair)| {
            format!("{} \"{}\" (columns {} and {})", i + 1, pair.label, pair.at.0 + 1, pair.at.1 + 1)
        };
        pairs.iter().enumerate().map(one).collect::<Vec<_>>().join("; ")
    };
    let listed = list(&pairs);
    let chosen = match part.name {
        Some(wanted) => {
            let wanted = wanted.trim().to_lowercase();
            let number = wanted.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
            let labelled = pairs.iter().position(|pair| pair.label == wanted);
            labelled.or(number.filter(|number| *number < pairs.len()))
        }
        None if pairs.len() - others == 1 => pairs.iter().position(|pair| !is_other(pair)),
        None => None,
    };
    let Some(chosen) = chosen else {
        let value = part.name.map_or_else(|| format!("{} profiles", pairs.len()), str::to_owned);
        let expected = format!("a single profile; the columns hold {listed}");
        let remedy = format!("say which of them is the profile: give {}, its name or number", part.field);
        return Err(error_on(name, line, &value, expected, remedy));
    };
    let pair = pairs.swap_remove(chosen);
    let text = format!(
        "columns {} and {}, \"{}\", are y and z; the columns hold {listed}",
        pair.at.0 + 1,
        pair.at.1 + 1,
        pair.label
    );
    let finding = Finding::new(FindingKind::Columns, Action::Noted, text).on_lines(line, line);
    Ok(Some((pair, finding)))
}

/// The values of a column that tells sections apart, in the order of the rows. None if most rows have a different value, if all have the
/// same one, or if its sections lie beside each other, as the halves of a scan do.
pub(super) fn stations(rows: &[Vec<f64>], station: usize, across: usize) -> Option<Vec<f64>> {
    let of = |row: &Vec<f64>| Some((*row.get(station)?, *row.get(across)?));
    let sound = rows.iter().filter_map(of).filter(|(s, y)| !s.is_nan() && !y.is_nan());
    let most = rows.len() / FEWEST;
    let mut index: BTreeMap<u64, usize> = BTreeMap::new();
    // Each value with its number of points and their least and greatest y.
    let mut found: Vec<(f64, usize, Range<f64>)> = Vec::new();
    for (s, y) in sound {
        // So that zero has one sign.
        let s = s + 0.0;
        let at = *index.entry(s.to_bits()).or_insert(found.len());
        if at == found.len() {
            if at == most {
                return None;
            }
            found.push((s, 0, y..y));
        }
        let (_, count, range) = &mut found[at];
        *count += 1;
        *range = range.start.min(y)..range.end.max(y);
    }
    let width = |range: &Range<f64>| range.end - range.start;
    let mut ranges: Vec<&Range<f64>> =
        found.iter().filter(|(_, count, _)| *count >= FEWEST).map(|(_, _, range)| range).collect();
    ranges.sort_unstable_by(|a, b| a.start.total_cmp(&b.start));
    let again = ranges.windows(2).any(|pair| {
        let shared = pair[0].end.min(pair[1].end) - pair[1].start;
        shared > 0.0 && shared >= SHARED * width(pair[0]).max(width(pair[1]))
    });
    again.then(|| found.into_iter().map(|(value, _, _)| value).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: columns are paired by what their names say besides the axis and the unit.
    #[test]
    fn names_of_columns_make_pairs() {
        let heads = |text: &str| -> Vec<String> { text.split(',').map(str::to_owned).collect() };
        let labels = |text: &str, axes| -> Vec<String> {
            pairs(&heads(text), axes).into_iter().map(|pair| pair.label).collect()
        };
        assert_eq!(labels("y_left,z_left,y_right,z_right", ["y", "z"]), ["left", "right"]);
        assert_eq!(
            labels("left y [mm],left z [mm],right y [mm],right z [mm]", ["y", "z"]),
            ["left", "right"]
        );
        assert_eq!(labels("x1,y1,x2,y2", ["x", "y"]), ["1", "2"]);
        assert_eq!(labels("n,y_mm,z_mm", ["y", "z"]), [""]);
        assert_eq!(labels("y_left,z_right", ["y", "z"]), [] as [&str; 0]);
    }

    /// Goal: sections lie on each other; numbers of points, halves of a scan and one place for all are none.
    #[test]
    fn sections_share_their_width() {
        let rows = |station: &dyn Fn(usize) -> f64, across: &dyn Fn(usize) -> f64| -> Vec<Vec<f64>> {
            (0..60).map(|i| vec![station(i), across(i)]).collect()
        };
        let three = |i: usize| (i / 20) as f64 * 500.0;
        let found = |rows: Vec<Vec<f64>>| stations(&rows, 0, 1);
        assert_eq!(found(rows(&three, &|i| (i % 20) as f64)), Some(vec![0.0, 500.0, 1000.0]));
        assert_eq!(found(rows(&|i| (i % 3) as f64, &|i| (i / 3) as f64)), Some(vec![0.0, 1.0, 2.0]));
        assert_eq!(found(rows(&three, &|i| i as f64)), None);
        assert_eq!(found(rows(&|_| 7.0, &|i| i as f64)), None);
        assert_eq!(found(rows(&|i| i as f64, &|i| i as f64)), None);
    }
}
