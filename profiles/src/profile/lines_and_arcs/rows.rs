//! The rows of a table of lines and arcs, and what its heading and comments say.

use nalgebra::{Point2, Vector2};

use crate::error::{InputError, Result, on_line};
use crate::profile::kind::ProfileKind;
use crate::profile::segment::Segment;
use crate::profile::table::rows;
use crate::units::MILLIMETRE;

/// Ends further apart than this do not meet, m: ten times the rounding of a drawing in 0.001 mm.
pub(super) const LARGEST_GAP: f64 = 0.01 * MILLIMETRE;
/// Largest part of a circle, degrees: up to here it is certain which way the arc goes round.
pub(super) const LARGEST_ARC: f64 = 170.0;
/// A shorter line or arc is none, m.
const SHORTEST: f64 = 1e-3 * MILLIMETRE;

pub(super) fn columns(heading: &str) -> Vec<String> {
    fields(heading, separator(heading)).map(|field| field.trim_matches('"').to_lowercase()).collect()
}

/// What separates the fields of a table, as its heading shows: semicolons, or commas where it has none.
fn separator(heading: &str) -> char {
    if heading.contains(';') { ';' } else { ',' }
}

fn fields(line: &str, separator: char) -> impl Iterator<Item = &str> {
    line.split(separator).map(str::trim)
}

/// What a caller knows better than the file.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Overrides {
    /// Length of the unit, m.
    pub unit: Option<f64>,
    /// Whether y grows the other way than the file says.
    pub mirrored: bool,
}

/// What comments and heading say.
pub(super) struct Settings {
    pub kind: ProfileKind,
    /// Senses of y and z in the file.
    sense: Vector2<f64>,
    pub symmetric: bool,
    /// Units per metre.
    per_metre: f64,
    /// Columns of the kind, the ends and the centre, in the order of [`COORDINATES`].
    columns: (usize, [usize; 6]),
    radius: Option<usize>,
    /// Line of the heading.
    heading: usize,
    separator: char,
}

const COORDINATES: [&str; 6] = ["y0", "z0", "y1", "z1", "yc", "zc"];

impl Settings {
    pub fn read(name: &str, text: &str, overrides: &Overrides) -> Result<Self> {
        let kind = choice(name, text, "profile", &["rail", "wheel"])?;
        let y = choice(name, text, "y", &["field", "track"])?;
        let z = choice(name, text, "z", &["down", "up"])?;
        let symmetric = if setting(text, "symmetric").is_some() {
            choice(name, text, "symmetric", &["no", "yes"])?
        } else {
            0
        };
        let sense = |choice: usize| if choice == 0 { 1.0 } else { -1.0 };
        let Some((heading, line)) = rows(text).next() else {
            return Err(on_line(
                name,
                1,
                "no rows",
                "a heading and rows of lines and arcs",
                "give the whole table",
            ));
        };
        let names = columns(line);
        let missing = |what: &str| {
            let expected =
                format!("the columns kind, {} with their unit, such as y0_mm", COORDINATES.join(", "));
            on_line(
                name,
                heading,
                format!("no column {what:?}"),
                &expected,
                "complete the heading of the table",
            )
        };
        let kind_column = names.iter().position(|n| n == "kind").ok_or_else(|| missing("kind"))?;
        let mut unit: Option<&str> = None;
        let mut found = [0; 6];
        for (column, wanted) in found.iter_mut().zip(COORDINATES) {
            let is_wanted = |n: &String| n.split_once('_').is_some_and(|(stem, _)| stem == wanted);
            *column = names.iter().position(is_wanted).ok_or_else(|| missing(wanted))?;
            let its_unit = names[*column].split_once('_').map_or("", |(_, unit)| unit);
            if *unit.get_or_insert(its_unit) != its_unit {
                let value = format!("{:?} beside \"{}\"", names[*column], unit.unwrap_or_default());
                return Err(on_line(
                    name,
                    heading,
                    value,
                    "one unit for all columns",
                    "write all lengths in it",
                ));
            }
        }
        let per_metre = match (overrides.unit, unit) {
            (Some(unit), _) => 1.0 / unit,
            (None, Some("mm")) => 1000.0,
            (None, Some("m")) => 1.0,
            (None, Some("in")) => 1.0 / (25.4 * MILLIMETRE),
            (None, other) => {
                let value = format!("the unit {:?}", other.unwrap_or_default());
                return Err(on_line(name, heading, value, "mm, m or in", "write y0_mm, z0_mm and so on"));
            }
        };
        Ok(Self {
            kind: if kind == 0 { ProfileKind::Rail } else { ProfileKind::Wheel },
            sense: Vector2::new(sense(y) * if overrides.mirrored { -1.0 } else { 1.0 }, sense(z)),
            symmetric: symmetric == 1,
            per_metre,
            columns: (kind_column, found),
            radius: names.iter().position(|n| n.starts_with("radius_")),
            heading,
            separator: separator(line),
        })
    }
}

/// The value of `# key: value`, with its line.
fn setting<'t>(text: &'t str, key: &str) -> Option<(usize, &'t str)> {
    text.lines().enumerate().find_map(|(index, line)| {
        let (found, value) = line.trim().strip_prefix('#')?.split_once(':')?;
        (found.trim() == key).then(|| (index + 1, value.trim()))
    })
}

/// Which of two words a setting has: its first word counts.
fn choice(name: &str, text: &str, key: &str, words: &[&str; 2]) -> Result<usize> {
    let expected = format!("`# {key}: {}` or `# {key}: {}`", words[0], words[1]);
    let Some((line, value)) = setting(text, key) else {
        let value = format!("no line `# {key}: ...`");
        return InputError::refuse(name, value, expected, "say it at the top of the file");
    };
    let word = value.split_whitespace().next().unwrap_or_default();
    words
        .iter()
        .position(|known| *known == word)
        .ok_or_else(|| on_line(name, line, format!("{value:?}"), &expected, "write one of the two words"))
}

/// A row of the table, m.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub line: usize,
    pub start: Point2<f64>,
    pub end: Point2<f64>,
    /// Centre and radius of an arc.
    pub arc: Option<(Point2<f64>, f64)>,
}

impl Piece {
    pub fn mirrored(&self) -> Self {
        let mirror = |p: Point2<f64>| Point2::new(-p.x, p.y);
        let arc = self.arc.map(|(centre, radius)| (mirror(centre), radius));
        Self { start: mirror(self.start), end: mirror(self.end), arc, ..*self }
    }

    pub fn reversed(&self) -> Self {
        Self { start: self.end, end: self.start, ..*self }
    }

    /// The segment from `start` to `end`, which lie near its own ends. An arc keeps its radius and the side of its centre.
    pub fn between(&self, start: Point2<f64>, end: Point2<f64>) -> Segment {
        let Some((centre, radius)) = self.arc else { return Segment::line(start, end) };
        let chord = end - start;
        let across = Vector2::new(-chord.y, chord.x).normalize();
        let middle = nalgebra::center(&start, &end);
        let rise = (radius * radius - 0.25 * chord.norm_squared()).max(0.0).sqrt();
        let side = across.dot(&(centre - middle)).signum();
        Segment::arc(middle + side * rise * across, start, end)
    }
}

pub(super) fn read_pieces(name: &str, text: &str, settings: &Settings) -> Result<Vec<Piece>> {
    rows(text)
        .skip_while(|(line, _)| *line <= settings.heading)
        .map(|(line, row)| read_piece(name, line, row, settings))
        .collect::<Result<Vec<_>>>()
        .and_then(|pieces| match pieces.len() {
            0 => Err(on_line(
                name,
                settings.heading,
                "no rows",
                "rows of lines and arcs",
                "give the whole table",
            )),
            _ => Ok(pieces),
        })
}

fn read_piece(name: &str, line: usize, row: &str, settings: &Settings) -> Result<Piece> {
    let fields: Vec<&str> = fields(row, settings.separator).collect();
    let number = |column: usize, what: &str| -> Result<f64> {
        let field = fields.get(column).copied().unwrap_or_default();
        // Only between semicolons a comma can stand before decimals.
        let value = field.replace(',', ".").parse::<f64>().ok().filter(|value| value.is_finite());
        let value = value.map(|value| value / settings.per_metre);
        // Larger than any rail or wheel.
        value.filter(|value| value.abs() < 100.0).ok_or_else(|| {
            on_line(
                name,
                line,
                format!("{what} = {field:?}"),
                "a length as a number",
                "correct or complete the row",
            )
        })
    };
    let (kind, [y0, z0, y1, z1, yc, zc]) = settings.columns;
    let point = |y: usize, z: usize, what: [&str; 2]| -> Result<Point2<f64>> {
        Ok(Point2::new(settings.sense.x * number(y, what[0])?, settings.sense.y * number(z, what[1])?))
    };
    let (start, end) = (point(y0, z0, ["y0", "z0"])?, point(y1, z1, ["y1", "z1"])?);
    if (end - start).norm() < SHORTEST {
        let value = format!("{:.2e} mm from start to end", (end - start).norm() / MILLIMETRE);
        return Err(on_line(name, line, value, "two different ends", "leave the row out"));
    }
    let word = fields.get(kind).map(|field| field.trim_matches('"').to_lowercase()).unwrap_or_default();
    let arc = match word.as_str() {
        "line" => None,
        "arc" => {
            let centre = point(yc, zc, ["yc", "zc"])?;
            let [first, last] = [start, end].map(|p| (p - centre).norm());
            let radius = match settings.radius.filter(|i| fields.get(*i).is_some_and(|f| !f.is_empty())) {
                Some(column) => number(column, "radius")?,
                None => 0.5 * (first + last),
            };
            let off = (first - radius).abs().max((last - radius).abs());
            if off > LARGEST_GAP || radius < SHORTEST {
                let value = format!(
                    "radius {:.4} mm, ends {:.4} and {:.4} mm from the centre",
                    radius / MILLIMETRE,
                    first / MILLIMETRE,
                    last / MILLIMETRE
                );
                let expected = "ends that lie on the arc within 0.01 mm";
                return Err(on_line(name, line, value, expected, "correct its centre, radius or ends"));
            }
            let angle = (start - centre).angle(&(end - centre)).to_degrees();
            if angle > LARGEST_ARC {
                let value = format!("an arc of {angle:.1}°");
                return Err(on_line(name, line, value, "at most 170°", "divide the arc into two rows"));
            }
            Some((centre, radius))
        }
        _ => {
            return Err(on_line(name, line, format!("kind = {word:?}"), "line or arc", "correct the row"));
        }
    };
    Ok(Piece { line, start, end, arc })
}
