//! Slices of the CONTACT program: `.slcs` (a rail along the track) and `.slcw` (a wheel around its circumference).
//!
//! The file lists profiles at positions, each in a separate file, named from the folder of the list: offset and scale,
//! number of slices, three counters of features, method of interpolation, then position and file of each slice.
//! `%`, `!` and `"` start comments.

use std::path::{Path, PathBuf};

use super::finding::{Action, Finding, FindingKind};
use super::part::Part;
use super::text::{
    DecimalMark, LARGEST_FILE, before_comment, decode, error_on, fields, lines, number, shown,
};
use crate::error::{InputError, Result};
use crate::input;
use crate::profile::ProfileKind;

/// Most slices of a file.
const MOST_SLICES: usize = 100_000;
/// Slices that a message lists.
const LISTED: usize = 8;

/// What the slices belong to, by the ending of the file's name.
pub(super) fn kind(path: &Path) -> Option<ProfileKind> {
    let ending = path.extension()?.to_string_lossy().to_lowercase();
    match ending.as_str() {
        "slcs" => Some(ProfileKind::Rail),
        "slcw" => Some(ProfileKind::Wheel),
        _ => None,
    }
}

struct Slice {
    /// Along the rail, mm, or around the wheel, rad.
    position: f64,
    file: String,
    line: usize,
}

/// The file of one slice, its content, and what is said about the choice.
///
/// # Errors
/// A list that is not understood; no slice of that name or number, or none named where there are several; a file that
/// cannot be read.
pub(super) fn choose(
    path: &Path,
    content: &[u8],
    kind: ProfileKind,
    part: &Part,
) -> Result<(PathBuf, Vec<u8>, Finding)> {
    let name = path.display().to_string();
    let slices = parse(&name, &decode(&name, content)?)?;
    let unit = if kind == ProfileKind::Rail { "mm" } else { "rad" };
    let index = index(&name, &slices, unit, part)?;
    let slice = &slices[index];
    let file = beside(path, &slice.file);
    let content = input::read(&file, LARGEST_FILE).map_err(|cause| {
        let value = format!("\"{}\" ({cause})", shown(&slice.file));
        let remedy = "keep the folder of the slices beside the list";
        InputError::new(format!("{name}:{}:1", slice.line), value, "a readable profile file", remedy)
    })?;
    if self::kind(&file).is_some() {
        let expected = "the file of a single profile";
        return Err(error_on(&name, slice.line, &slice.file, expected, "name the slice itself"));
    }
    let steps_back = slices.windows(2).any(|pair| pair[0].position >= pair[1].position);
    let order = if steps_back { "; the positions do not increase" } else { "" };
    let text = format!(
        "slice {} of {} of {name}, {} at {} {unit}: the others, features and interpolation are not used{order}",
        index + 1,
        slices.len(),
        shown(&slice.file),
        slice.position,
    );
    let action = if steps_back { Action::Left } else { Action::Noted };
    Ok((file, content, Finding::new(FindingKind::PassedOver, action, text)))
}

/// A slice of a list.
#[derive(Debug, Clone, PartialEq)]
pub struct SliceFile {
    /// What it is a slice of.
    pub kind: ProfileKind,
    /// Where it is along a rail, mm, or around a wheel, rad.
    pub position: f64,
    /// Its file.
    pub path: PathBuf,
}

/// The slices that the list at `path` names; none where it is no list of slices, or not understood.
pub fn slice_files(path: &Path) -> Vec<SliceFile> {
    let Some(kind) = kind(path) else { return Vec::new() };
    let name = path.display().to_string();
    let listed = || parse(&name, &decode(&name, &input::read(path, LARGEST_FILE).ok()?).ok()?).ok();
    let file = |slice: &Slice| SliceFile { kind, position: slice.position, path: beside(path, &slice.file) };
    listed().unwrap_or_default().iter().map(file).collect()
}

/// The file of a slice, which is named from the folder of the list.
fn beside(path: &Path, file: &str) -> PathBuf {
    let folder = path.parent().unwrap_or(Path::new(""));
    let as_written = folder.join(file);
    // Lists from Windows have its separators.
    if as_written.exists() { as_written } else { folder.join(file.replace('\\', "/")) }
}

fn parse(name: &str, text: &str) -> Result<Vec<Slice>> {
    let rows =
        lines(text).map(|(n, line)| (n, without_comment(line))).filter(|(_, row)| !row.trim().is_empty());
    let end = lines(text).count();
    let mut rows = rows.peekable();
    let mut numbers = |what: &str, count: usize| -> Result<(usize, Vec<f64>)> {
        let Some((n, row)) = rows.next() else {
            return Err(error_on(name, end, "", what, "complete the list of slices"));
        };
        let values: Vec<f64> = fields(row, DecimalMark::Point)
            .iter()
            .map_while(|f| number(f.text, DecimalMark::Point))
            .collect();
        if values.len() < count {
            return Err(error_on(name, n, row.trim(), what, "correct the line"));
        }
        Ok((n, values))
    };
    let (_, scaling) = numbers("offset and scale of the positions, two numbers", 2)?;
    let (line, count) = numbers("the number of slices", 1)?;
    numbers("the numbers of features, kinks and accelerations", 3)?;
    numbers("the method of interpolation, 1 or 2", 1)?;
    if count[0].fract() != 0.0 || !(1.0..=MOST_SLICES as f64).contains(&count[0]) {
        let expected = format!("a number of slices from 1 to {MOST_SLICES}");
        return Err(error_on(name, line, &count[0].to_string(), expected, "correct the number"));
    }
    let mut slices = Vec::new();
    for (n, row) in rows.take(count[0] as usize) {
        let fields = fields(row, DecimalMark::Point);
        let position = fields.first().and_then(|field| number(field.text, DecimalMark::Point));
        let file = quoted(row).or(fields.get(1).map(|field| field.text)).filter(|file| !file.is_empty());
        let (Some(position), Some(file)) = (position, file) else {
            let expected = "position and 'file' of a slice";
            return Err(error_on(name, n, row.trim(), expected, "correct the line, or the number of slices"));
        };
        let position = scaling[1] * (scaling[0] + position);
        slices.push(Slice { position, file: file.to_owned(), line: n });
    }
    if slices.len() < count[0] as usize {
        let expected = format!("{} slices as line {line} says; there are {}", count[0], slices.len());
        return Err(error_on(name, end, "", expected, "complete the list, or correct the number"));
    }
    Ok(slices)
}

/// What stands in single quotes, or in double ones, which are no comment behind a position.
fn quoted(row: &str) -> Option<&str> {
    let open = row.find(['\'', '"'])?;
    let quote = row[open..].chars().next()?;
    row[open + 1..].split_once(quote).map(|(inside, _)| inside)
}

fn without_comment(line: &str) -> &str {
    // At the beginning of a line a double quote starts a comment.
    if line.trim_start().starts_with('"') { "" } else { before_comment(line).0 }
}

/// Index of the slice that is wanted.
fn index(name: &str, slices: &[Slice], unit: &str, part: &Part) -> Result<usize> {
    let describe =
        |i: usize| format!("{} \"{}\" at {} {unit}", i + 1, shown(&slices[i].file), slices[i].position);
    let shown_slices: Vec<String> = (0..slices.len().min(LISTED)).map(describe).collect();
    let mut list = shown_slices.join("; ");
    if slices.len() > LISTED {
        list += &format!("; \u{2026}; {}", describe(slices.len() - 1));
    }
    let field = &part.field;
    let Some(wanted) = part.name.map(str::trim) else {
        if slices.len() == 1 {
            return Ok(0);
        }
        let value = format!("{} slices", slices.len());
        let expected = format!("a single profile; the file has {list}");
        let remedy = format!("say which of them is the profile: give {field}, its name or number");
        return Err(error_on(name, slices[0].line, &value, expected, remedy));
    };
    let matching = |same: &dyn Fn(&str) -> bool| -> Vec<usize> {
        (0..slices.len()).filter(|&i| same(&slices[i].file)).collect()
    };
    let base = |file: &str| file.rsplit(['/', '\\']).next().unwrap_or_default().to_lowercase();
    let stem = |file: &str| base(file).rsplit_once('.').map_or(base(file), |(stem, _)| stem.to_owned());
    let lower = wanted.to_lowercase();
    let names: [&dyn Fn(&str) -> bool; 3] =
        [&|file| file == wanted, &|file| base(file) == lower, &|file| stem(file) == lower];
    let by_name = names.iter().map(|same| matching(*same)).find(|found| !found.is_empty());
    let by_number =
        || wanted.parse::<usize>().ok().filter(|n| (1..=slices.len()).contains(n)).map(|n| vec![n - 1]);
    match by_name.or_else(by_number).as_deref() {
        Some([index]) => Ok(*index),
        Some(several) => {
            let line = slices[several[1]].line;
            let expected = format!("a single slice; {} are called so", several.len());
            Err(error_on(name, line, wanted, expected, format!("give {field} as the number of the slice")))
        }
        None => {
            let expected = format!("the name or the number of a slice: {list}");
            Err(error_on(name, slices[0].line, wanted, expected, format!("correct {field}")))
        }
    }
}
