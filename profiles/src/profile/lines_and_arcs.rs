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

mod rows;
mod joints;

use std::fmt::Write;

use nalgebra::Point2;

use self::joints::{STEP, check_joints, is_closed, join, put_in_order, unfold};
use self::rows::{Settings, columns, read_pieces};
use super::curve::ProfileCurve;
use super::kind::ProfileKind;
use super::rails::RailOutline;
use super::segment::{Segment, polyline};
use super::sketch::Sketch;
use super::split::{Tape, of_ring, split_rail, split_wheel};
use super::table::rows;
use crate::error::{Result, on_line};
use crate::units::MILLIMETRE;

pub use joints::Joint;
pub use rows::Overrides;

/// How far the crown of a rail or the tread at the tape circle may lie from z = 0, m.
const OFF_ORIGIN: f64 = 0.05 * MILLIMETRE;

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
        names.iter().any(|name| name == "kind")
            && names.iter().any(|name| name == "y0" || name.starts_with("y0_"))
    })
}

/// Reads a table; `name` is that of the file, for messages.
///
/// # Errors
/// [`crate::error::InputError`] with the line of the file for rows that cannot be understood, arcs whose ends do not lie on them, ends that do not
/// meet, and a profile that does not lie in its frame.
///
/// ```
/// use railspring_profiles::profile::lines_and_arcs::{Overrides, parse};
/// let text = "# profile: rail\n# y: field\n# z: down\n# symmetric: yes\n\
///             kind,y0_mm,z0_mm,y1_mm,z1_mm,yc_mm,zc_mm\n\
///             arc,0,0,25,1.043479,0,300\nline,25,1.043479,35,14,,\n";
/// let head = parse("head.csv", text, &Overrides::default())?;
/// assert_eq!((head.running.len(), head.joints.len()), (3, 2));
/// assert!((head.curve().point(0.0).x + 0.035).abs() < 1e-12);
/// # Ok::<(), railspring_profiles::error::Error>(())
/// ```
pub fn parse(name: &str, text: &str, overrides: &Overrides) -> Result<LinesAndArcs> {
    parse_drawn(name, text, overrides, &mut Sketch::default())
}

/// As [`parse`]; the line as it is drawn, and its steps, are put into `drawn`, those of a table that is refused as well.
pub(crate) fn parse_drawn(
    name: &str,
    text: &str,
    overrides: &Overrides,
    drawn: &mut Sketch,
) -> Result<LinesAndArcs> {
    let settings = Settings::read(name, text, overrides)?;
    let mut pieces = read_pieces(name, text, &settings)?;
    check_joints(name, &pieces, drawn)?;
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
    Ok(LinesAndArcs {
        kind: settings.kind,
        lines: of_ring(&lines, running.clone()),
        running: of_ring(&segments, running),
        rest: of_ring(&segments, rest),
        joints,
    })
}

/// A table of lines and arcs (m, y to the field side, z down), each beginning where the one before it ends, which [`parse`] reads; to the
/// nanometre.
///
/// ```
/// use nalgebra::Point2;
/// use railspring_profiles::profile::lines_and_arcs::{Overrides, parse, write};
/// use railspring_profiles::profile::{ProfileKind, Segment};
/// let top = Segment::arc(Point2::new(0.0, 0.3), Point2::new(-0.018, 0.3 - 0.29946), Point2::new(0.018, 0.3 - 0.29946));
/// let table = write(ProfileKind::Rail, &[top]);
/// assert_eq!(parse("crown.csv", &table, &Overrides::default())?.running.len(), 1);
/// # Ok::<(), railspring_profiles::error::Error>(())
/// ```
pub fn write(kind: ProfileKind, segments: &[Segment]) -> String {
    let mut text = format!(
        "# profile: {}\n# y: field\n# z: down\nkind,y0_mm,z0_mm,y1_mm,z1_mm,yc_mm,zc_mm\n",
        kind.name()
    );
    for segment in segments {
        let [a, b] = [segment.start(), segment.end()].map(|p| p / MILLIMETRE);
        // Writing to a string cannot fail.
        let _ = match *segment {
            Segment::Line { .. } => writeln!(text, "line,{:.6},{:.6},{:.6},{:.6},,", a.x, a.y, b.x, b.y),
            Segment::Arc { centre, .. } => {
                let c = centre / MILLIMETRE;
                writeln!(text, "arc,{:.6},{:.6},{:.6},{:.6},{:.6},{:.6}", a.x, a.y, b.x, b.y, c.x, c.y)
            }
        };
    }
    text
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
                return Err(on_line(name, lines[0], value, "the top of the rail at z = 0", remedy));
            }
        }
        ProfileKind::Wheel => {
            let tip = points.iter().max_by(lowest_first).copied().unwrap_or_default();
            if tip.x > 0.0 || tip.y < 10.0 * MILLIMETRE {
                let value = format!("the lowest point at y = {}, z = {}, z down", mm(tip.x), mm(tip.y));
                let expected = "the tip of a flange, at negative y and more than 10 mm below the tape circle";
                return Err(on_line(name, lines[0], value, expected, "correct `# y:` or `# z:`"));
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
                return Err(on_line(name, lines[0], value, "a tread that passes through the origin", remedy));
            }
        }
    }
    Ok(())
}
