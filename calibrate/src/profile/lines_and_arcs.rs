//! Profiles and sections as tables of lines and arcs: those of the project, and a user's own standard.
//!
//! A table is CSV, because that is what the lines and arcs of drawings come as and what every spreadsheet writes, and because each row has
//! a line of the file that a message can name. Comments say what it is; the names of the columns have the unit (mm, m or in):
//!
//! ```text
//! # profile: rail          rail or wheel
//! # y: field               y grows to the field side, or to the track
//! # z: down                or up
//! # symmetric: yes         the half y >= 0, which begins on the axis (none: the whole)
//! kind,y0_mm,z0_mm,y1_mm,z1_mm,radius_mm,yc_mm,zc_mm
//! arc,0,0,10.228,0.174411,300,0,300
//! line,35.998885,14.111504,37.048583,35.105476,,,
//! ```
//!
//! Arcs go the shorter way round. The origin is that of the project: the top of the rail on its axis, the tape circle of the wheel.
//! A rail is its head, or the whole closed section; a wheel is its running surface from the flange back to the chamfer, or the closed section
//! on one side of its axle.

use nalgebra::{Point2, Vector2};

use super::ProfileKind;
use super::curve::ProfileCurve;
use super::rails::RailOutline;
use super::segment::{Segment, polyline};
use super::split::{Tape, split_rail, split_wheel};
use crate::error::{InputError, Result};
use crate::units::MILLIMETRE;

/// Ends further apart than this do not meet, m: ten times the rounding of a drawing in 0.001 mm.
const LARGEST_GAP: f64 = 0.01 * MILLIMETRE;
/// A shorter line or arc is none, m.
const SHORTEST: f64 = 1e-3 * MILLIMETRE;
/// Largest part of a circle, degrees: up to here it is certain which way the arc goes round.
const LARGEST_ARC: f64 = 170.0;
/// How far the crown of a rail or the tread at the tape circle may lie from z = 0, m.
const OFF_ORIGIN: f64 = 0.05 * MILLIMETRE;
/// Largest step of the samples of the curve, m.
const STEP: f64 = 0.1 * MILLIMETRE;

/// A profile of lines and arcs in the profile frame (y to the field side, z down), m.
#[derive(Debug, Clone, PartialEq)]
pub struct LinesAndArcs {
    /// Rail or wheel.
    pub kind: ProfileKind,
    /// The running surface, from the gauge side or the flange to the field side.
    pub running: Vec<Segment>,
    /// Line of the file of each segment of `running`; the two halves of a symmetric one share theirs.
    pub lines: Vec<usize>,
    /// The rest of a closed section, from the end of `running` back to its start; empty for a running surface alone.
    pub rest: Vec<Segment>,
    /// The joints at which a gap was closed or that have a corner, in the order of the outline.
    pub joints: Vec<Joint>,
}

/// Where two segments of a table meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// Lines of the file of the two segments.
    pub lines: (usize, usize),
    /// Where they meet, m.
    pub point: Point2<f64>,
    /// Distance of their ends, m; both were moved half of it.
    pub gap: f64,
    /// Angle between their directions, rad, positive from y towards z.
    pub turn: f64,
}

/// What a caller knows better than the file.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Overrides {
    /// Length of the unit, m.
    pub unit: Option<f64>,
    /// Whether y grows the other way than the file says.
    pub mirrored: bool,
}

impl LinesAndArcs {
    /// The running surface; joints are breakpoints, which have the directions of both segments.
    pub fn curve(&self) -> ProfileCurve {
        ProfileCurve::from_segments(&self.running, STEP)
    }

    /// The closed section of a rail, if it is one.
    pub fn rail_outline(&self) -> Option<RailOutline> {
        (self.kind == ProfileKind::Rail && !self.rest.is_empty())
            .then(|| RailOutline { running: self.running.clone(), rest: self.rest.clone() })
    }

    /// Points on the running surface, m, with the lines of their segments: the ends of all segments, and steps of 0.1 mm on arcs.
    pub fn points(&self) -> Vec<(Point2<f64>, usize)> {
        let mut points = Vec::new();
        for (segment, line) in self.running.iter().zip(&self.lines) {
            points.extend(polyline(std::slice::from_ref(segment), STEP).into_iter().map(|p| (p, *line)));
            points.pop();
        }
        points.extend(self.running.last().map(Segment::end).zip(self.lines.last().copied()));
        points
    }
}

/// Whether a text is such a table, by the names of its columns.
pub fn recognises(text: &str) -> bool {
    rows(text).next().is_some_and(|(_, line)| {
        let names = columns(line);
        names.iter().any(|name| name == "kind") && names.iter().any(|name| name.starts_with("y0_"))
    })
}

/// Reads a table; `name` is that of the file, for messages.
///
/// # Errors
/// [`InputError`] with the line of the file for rows that cannot be understood, arcs whose ends do not lie on them, ends that do not
/// meet, and a profile that does not lie in its frame.
///
/// ```
/// use railspring_calibrate::profile::lines_and_arcs::{Overrides, parse};
/// let text = "# profile: rail\n# y: field\n# z: down\n# symmetric: yes\n\
///             kind,y0_mm,z0_mm,y1_mm,z1_mm,yc_mm,zc_mm\n\
///             arc,0,0,25,1.043479,0,300\nline,25,1.043479,35,14,,\n";
/// let head = parse("head.csv", text, &Overrides::default())?;
/// assert_eq!((head.running.len(), head.joints.len()), (3, 2));
/// assert!((head.curve().point(0.0).x + 0.035).abs() < 1e-12);
/// # Ok::<(), railspring_calibrate::error::Error>(())
/// ```
pub fn parse(name: &str, text: &str, overrides: &Overrides) -> Result<LinesAndArcs> {
    let settings = Settings::read(name, text, overrides)?;
    let mut pieces = read_pieces(name, text, &settings)?;
    check_joints(name, &pieces)?;
    if settings.symmetric {
        pieces = unfold(name, &pieces)?;
    }
    let closed = is_closed(&pieces);
    put_in_order(&mut pieces, settings.kind, closed);
    let (segments, joints) = join(&pieces, closed);
    let lines: Vec<usize> = pieces.iter().map(|piece| piece.line).collect();
    check_frame(name, settings.kind, &segments, &lines)?;
    let (running, rest) = match settings.kind {
        _ if !closed => (0..segments.len(), 0..0),
        ProfileKind::Rail => split_rail(name, &segments, lines[0])?,
        ProfileKind::Wheel => split_wheel(name, &segments, Tape::At(0.0), lines[0])?,
    };
    let ring = |range: std::ops::Range<usize>| range.map(|i| segments[i % segments.len()]).collect();
    Ok(LinesAndArcs {
        kind: settings.kind,
        lines: running.clone().map(|i| lines[i % lines.len()]).collect(),
        running: ring(running),
        rest: ring(rest),
        joints,
    })
}

fn at(name: &str, line: usize, value: impl ToString, expected: &str, remedy: &str) -> crate::error::Error {
    InputError::new(format!("{name}:{line}"), value, expected, remedy).into()
}

/// Lines that are neither empty nor comments, with their numbers.
fn rows(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
}

fn columns(line: &str) -> Vec<String> {
    fields(line).map(|field| field.trim_matches('"').to_lowercase()).collect()
}

/// Fields between semicolons, or commas where there is no semicolon.
fn fields(line: &str) -> impl Iterator<Item = &str> {
    line.split(if line.contains(';') { ';' } else { ',' }).map(str::trim)
}

/// What comments and heading say.
struct Settings {
    kind: ProfileKind,
    /// Senses of y and z in the file.
    sense: Vector2<f64>,
    symmetric: bool,
    /// Units per metre.
    per_metre: f64,
    /// Columns of the kind, the ends and the centre, in the order of [`COORDINATES`].
    columns: (usize, [usize; 6]),
    radius: Option<usize>,
    /// Line of the heading.
    heading: usize,
}

const COORDINATES: [&str; 6] = ["y0", "z0", "y1", "z1", "yc", "zc"];

impl Settings {
    fn read(name: &str, text: &str, overrides: &Overrides) -> Result<Self> {
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
            return Err(at(
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
            at(name, heading, format!("no column {what:?}"), &expected, "complete the heading of the table")
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
                return Err(at(name, heading, value, "one unit for all columns", "write all lengths in it"));
            }
        }
        let per_metre = match (overrides.unit, unit) {
            (Some(unit), _) => 1.0 / unit,
            (None, Some("mm")) => 1000.0,
            (None, Some("m")) => 1.0,
            (None, Some("in")) => 1.0 / (25.4 * MILLIMETRE),
            (None, other) => {
                let value = format!("the unit {:?}", other.unwrap_or_default());
                return Err(at(name, heading, value, "mm, m or in", "write y0_mm, z0_mm and so on"));
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
        return Err(InputError::new(name, value, expected, "say it at the top of the file").into());
    };
    let word = value.split_whitespace().next().unwrap_or_default();
    words
        .iter()
        .position(|known| *known == word)
        .ok_or_else(|| at(name, line, format!("{value:?}"), &expected, "write one of the two words"))
}

/// A row of the table, m.
#[derive(Debug, Clone, Copy)]
struct Piece {
    line: usize,
    start: Point2<f64>,
    end: Point2<f64>,
    /// Centre and radius of an arc.
    arc: Option<(Point2<f64>, f64)>,
}

impl Piece {
    fn mirrored(&self) -> Self {
        let mirror = |p: Point2<f64>| Point2::new(-p.x, p.y);
        let arc = self.arc.map(|(centre, radius)| (mirror(centre), radius));
        Self { start: mirror(self.start), end: mirror(self.end), arc, ..*self }
    }

    fn reversed(&self) -> Self {
        Self { start: self.end, end: self.start, ..*self }
    }

    /// The segment from `start` to `end`, which lie near its own ends. An arc keeps its radius and the side of its centre.
    fn between(&self, start: Point2<f64>, end: Point2<f64>) -> Segment {
        let Some((centre, radius)) = self.arc else { return Segment::line(start, end) };
        let chord = end - start;
        let across = Vector2::new(-chord.y, chord.x).normalize();
        let middle = nalgebra::center(&start, &end);
        let rise = (radius * radius - 0.25 * chord.norm_squared()).max(0.0).sqrt();
        let side = across.dot(&(centre - middle)).signum();
        Segment::arc(middle + side * rise * across, start, end)
    }
}

fn read_pieces(name: &str, text: &str, settings: &Settings) -> Result<Vec<Piece>> {
    rows(text)
        .skip_while(|(line, _)| *line <= settings.heading)
        .map(|(line, row)| read_piece(name, line, row, settings))
        .collect::<Result<Vec<_>>>()
        .and_then(|pieces| match pieces.len() {
            0 => Err(at(name, settings.heading, "no rows", "rows of lines and arcs", "give the whole table")),
            _ => Ok(pieces),
        })
}

fn read_piece(name: &str, line: usize, row: &str, settings: &Settings) -> Result<Piece> {
    let fields: Vec<&str> = fields(row).collect();
    let number = |column: usize, what: &str| -> Result<f64> {
        let field = fields.get(column).copied().unwrap_or_default();
        // Only between semicolons a comma can stand before decimals.
        let value = field.replace(',', ".").parse::<f64>().ok().filter(|value| value.is_finite());
        let value = value.map(|value| value / settings.per_metre);
        // Larger than any rail or wheel.
        value.filter(|value| value.abs() < 100.0).ok_or_else(|| {
            at(
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
        return Err(at(name, line, value, "two different ends", "leave the row out"));
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
                return Err(at(name, line, value, expected, "correct its centre, radius or ends"));
            }
            let angle = (start - centre).angle(&(end - centre)).to_degrees();
            if angle > LARGEST_ARC {
                let value = format!("an arc of {angle:.1}°");
                return Err(at(name, line, value, "at most 170°", "divide the arc into two rows"));
            }
            Some((centre, radius))
        }
        _ => {
            return Err(at(name, line, format!("kind = {word:?}"), "line or arc", "correct the row"));
        }
    };
    Ok(Piece { line, start, end, arc })
}

/// The whole from the half y >= 0: what meets the axis at right angles becomes one piece with its mirror image.
fn unfold(name: &str, half: &[Piece]) -> Result<Vec<Piece>> {
    let (first, last) = (&half[0], &half[half.len() - 1]);
    if first.start.x.abs() > LARGEST_GAP {
        let value = format!("y = {:.4} mm", first.start.x / MILLIMETRE);
        let remedy = "begin on the axis, or leave `# symmetric: yes` out";
        return Err(at(name, first.line, value, "the half of a symmetric profile to begin at y = 0", remedy));
    }
    // Whether a piece goes on as its own mirror image at the axis; a merged arc must not be too long to tell its way.
    let level = |piece: &Piece, off_axis: Point2<f64>, on_axis: Point2<f64>| match piece.arc {
        None => (off_axis.y - on_axis.y).abs() < LARGEST_GAP,
        Some((centre, radius)) => {
            centre.x.abs() < LARGEST_GAP && off_axis.x.abs() < radius * (0.5 * LARGEST_ARC).to_radians().sin()
        }
    };
    let on_axis = |p: Point2<f64>| Point2::new(0.0, p.y);
    let (mut right, mut crown) = (half.to_vec(), None);
    if level(first, first.end, first.start) {
        crown = Some(Piece { start: Point2::new(-first.end.x, first.end.y), ..*first });
        right.remove(0);
    } else {
        right[0].start = on_axis(first.start);
    }
    let mut bottom = None;
    if last.end.x.abs() < LARGEST_GAP && half.len() > 1 {
        let at_end = right.len() - 1;
        if level(last, last.start, last.end) {
            bottom = Some(Piece { end: Point2::new(-last.start.x, last.start.y), ..*last });
            right.remove(at_end);
        } else {
            right[at_end].end = on_axis(last.end);
        }
    }
    let left = right.iter().rev().map(|piece| piece.mirrored().reversed());
    // A closed outline begins anywhere: the left half stands before the crown in both cases.
    let mut whole: Vec<Piece> = bottom.into_iter().chain(left).chain(crown).collect();
    whole.extend(right);
    Ok(whole)
}

fn is_closed(pieces: &[Piece]) -> bool {
    let (first, last) = (&pieces[0], &pieces[pieces.len() - 1]);
    pieces.len() > 2 && (last.end - first.start).norm() <= LARGEST_GAP
}

/// Refuses ends that do not meet.
fn check_joints(name: &str, pieces: &[Piece]) -> Result<()> {
    for pair in pieces.windows(2) {
        let gap = (pair[1].start - pair[0].end).norm();
        if gap > LARGEST_GAP {
            let place = |p: Point2<f64>| format!("({:.4}, {:.4})", p.x / MILLIMETRE, p.y / MILLIMETRE);
            let value = format!(
                "a gap of {:.4} mm: line {} ends at {}, line {} begins at {} mm (y to the field side, z down)",
                gap / MILLIMETRE,
                pair[0].line,
                place(pair[0].end),
                pair[1].line,
                place(pair[1].start)
            );
            let remedy =
                "put the rows in the order of the outline, each beginning where the one before it ends";
            return Err(at(name, pair[1].line, value, "ends that meet within 0.01 mm", remedy));
        }
    }
    Ok(())
}

/// Turns the order round where it runs from the field side; a closed outline runs along its running surface to the field side.
fn put_in_order(pieces: &mut Vec<Piece>, kind: ProfileKind, closed: bool) {
    let forward = if closed {
        // The body lies below a rail's running surface and above a wheel's.
        let turns = pieces.iter().map(|p| p.start.coords.perp(&p.end.coords)).sum::<f64>();
        (turns > 0.0) == (kind == ProfileKind::Rail)
    } else {
        pieces[0].start.x < pieces[pieces.len() - 1].end.x
    };
    if !forward {
        *pieces = pieces.iter().rev().map(Piece::reversed).collect();
    }
}

/// The segments with their ends moved together, and what there was at the joints.
fn join(pieces: &[Piece], closed: bool) -> (Vec<Segment>, Vec<Joint>) {
    let n = pieces.len();
    let met = |before: &Piece, after: &Piece| nalgebra::center(&before.end, &after.start);
    let end_of = |i: usize| match i + 1 {
        next if next < n => met(&pieces[i], &pieces[next]),
        _ if closed => met(&pieces[i], &pieces[0]),
        _ => pieces[i].end,
    };
    let start_of = |i: usize| match i {
        0 if closed => end_of(n - 1),
        0 => pieces[0].start,
        _ => end_of(i - 1),
    };
    let segments: Vec<Segment> = (0..n).map(|i| pieces[i].between(start_of(i), end_of(i))).collect();
    let joints = (0..if closed { n } else { n - 1 })
        .map(|i| {
            let (before, after) = (i, (i + 1) % n);
            let (into, out) = (segments[before].tangent(1.0), segments[after].tangent(0.0));
            Joint {
                lines: (pieces[before].line, pieces[after].line),
                point: end_of(i),
                gap: (pieces[after].start - pieces[before].end).norm(),
                turn: into.perp(&out).atan2(into.dot(&out)),
            }
        })
        .collect();
    (segments, joints)
}

/// Refuses a profile that does not lie in its frame.
fn check_frame(name: &str, kind: ProfileKind, segments: &[Segment], lines: &[usize]) -> Result<()> {
    let points = polyline(segments, STEP);
    let mm = |value: f64| format!("{:.4} mm", value / MILLIMETRE);
    let lowest_first = |a: &&Point2<f64>, b: &&Point2<f64>| a.y.total_cmp(&b.y);
    match kind {
        ProfileKind::Rail => {
            let top = points.iter().min_by(lowest_first).map_or(0.0, |p| p.y);
            if top.abs() > OFF_ORIGIN {
                let value = format!("the highest point at z = {}, z down", mm(top));
                let remedy = "move the origin to the top of the rail on its axis, or correct `# z:`";
                return Err(at(name, lines[0], value, "the top of the rail at z = 0", remedy));
            }
        }
        ProfileKind::Wheel => {
            let tip = points.iter().max_by(lowest_first).copied().unwrap_or_default();
            if tip.x > 0.0 || tip.y < 10.0 * MILLIMETRE {
                let value = format!("the lowest point at y = {}, z = {}, z down", mm(tip.x), mm(tip.y));
                let expected = "the tip of a flange, at negative y and more than 10 mm below the tape circle";
                return Err(at(name, lines[0], value, expected, "correct `# y:` or `# z:`"));
            }
            // Of a closed section the hub, and a web that is not straight, pass y = 0 above the tread.
            let crossings = points.windows(2).filter(|w| w[0].x <= 0.0 && w[1].x > 0.0).map(|w| {
                let part = -w[0].x / (w[1].x - w[0].x);
                w[0].y + part * (w[1].y - w[0].y)
            });
            let crossing = crossings.reduce(f64::max);
            if crossing.is_none_or(|z| z.abs() > OFF_ORIGIN) {
                let value =
                    crossing.map_or("no point at y = 0".into(), |z| format!("z = {} at y = 0", mm(z)));
                let remedy = "move the origin to the tape circle on the tread";
                return Err(at(name, lines[0], value, "a tread that passes through the origin", remedy));
            }
        }
    }
    Ok(())
}
