//! A measured profile on the section of its standard: what was measured and changed, what is transition and what is standard.

use nalgebra::Point2;
use railspring_profiles::units::MILLIMETRE;
use serde::Serialize;

use crate::report::panel::{Panel, stacked_with_notes};
use crate::report::plot::{BLUE, DARK, Dash, GREY, Marker, ORANGE, RED, Series};
use crate::rounding::with_minus_signs;

/// Where a part of a surface comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// The measurement, repaired and smoothed.
    Measured,
    /// The measurement, beyond what is taken of it.
    MeasuredUnused,
    /// The way from one to the other.
    Transition,
    /// The standard section.
    Standard,
    /// The standard section, where the measurement takes its place.
    StandardUnused,
}

impl Origin {
    /// All, in the order of legends, with their lines.
    const STYLES: [(Self, plotters::style::RGBColor, Dash, bool); 5] = [
        (Self::Standard, GREY, Dash::Solid, false),
        (Self::StandardUnused, GREY, Dash::Dotted, false),
        (Self::Measured, DARK, Dash::Solid, true),
        (Self::MeasuredUnused, DARK, Dash::Dotted, false),
        (Self::Transition, ORANGE, Dash::Dashed, true),
    ];

    /// Name in legends and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Measured => "measured",
            Self::MeasuredUnused => "measured, not used",
            Self::Transition => "transition",
            Self::Standard => "standard",
            Self::StandardUnused => "standard, not used",
        }
    }

    /// Whether it is a part of the surface that the body has.
    fn is_used(self) -> bool {
        matches!(self, Self::Measured | Self::Transition | Self::Standard)
    }
}

/// A stretch of a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Where it comes from.
    pub origin: Origin,
    /// Its points, m.
    pub points: Vec<Point2<f64>>,
    /// Its length, m.
    pub length: f64,
    /// Whether it belongs to the running surface.
    pub running: bool,
}

/// A point of the file against the standard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OffStandard {
    /// Where it lies, m.
    pub point: Point2<f64>,
    /// Where that is along the standard, from the start of its running surface, m.
    pub along: f64,
    /// Material missing against the standard, m.
    pub missing: f64,
}

/// A point that the repair or the smoothing left out or moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Changed {
    /// As it was read.
    pub read: OffStandard,
    /// Its distance from the surface, m.
    pub change: f64,
    /// Its line in the file.
    pub line: usize,
}

/// A measured profile on the section of its standard, in the frame of that: y to the field side, z down.
#[derive(Debug, Clone, PartialEq)]
pub struct OnStandard {
    /// `rail` or `wheel`.
    pub body: String,
    /// The file as it was named.
    pub file: String,
    /// Name of the standard, or the file of a section.
    pub standard: String,
    /// The surface in its order, and what of both is not used.
    pub parts: Vec<Part>,
    /// The points of the surface that were measured.
    pub measured: Vec<OffStandard>,
    /// Points of the transitions.
    pub transitions: Vec<Vec<OffStandard>>,
    /// Points that the placing took for surface that is not worn; none where the profile was not placed.
    pub kept: Vec<OffStandard>,
    /// Number of the points that were read.
    pub read: usize,
    /// Number of the points that are left after the repair.
    pub left: usize,
    /// Those that lie farther from the surface than [`CHANGED`].
    pub changed: Vec<Changed>,
}

/// Distance from the surface from which a point counts as changed, m: less is the scatter of instruments.
pub const CHANGED: f64 = 0.01 * MILLIMETRE;
/// What is seen beside the running surface, m.
const MARGIN: f64 = 8.0 * MILLIMETRE;

/// A row of the table of parts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct PartRow {
    origin: &'static str,
    from: String,
    to: String,
    length_mm: String,
}

impl OnStandard {
    /// The parts of the running surface in their order, and what of the measurement is not used.
    pub(crate) fn rows(&self) -> Vec<PartRow> {
        let place = |p: Option<&Point2<f64>>| match p {
            Some(p) => with_minus_signs(&format!("({:.3}, {:.3})", p.x / MILLIMETRE, p.y / MILLIMETRE)),
            None => String::new(),
        };
        let shown = |part: &&Part| part.running && part.origin != Origin::StandardUnused;
        let row = |part: &Part| PartRow {
            origin: part.origin.name(),
            from: place(part.points.first()),
            to: place(part.points.last()),
            length_mm: format!("{:.3}", part.length / MILLIMETRE),
        };
        self.parts.iter().filter(shown).map(row).collect()
    }

    /// What was changed, in a sentence.
    pub fn changes(&self) -> String {
        let largest = self.changed.iter().max_by(|a, b| a.change.total_cmp(&b.change));
        let largest = match largest {
            Some(most) => format!(
                "; the largest change is {:.3} mm, at y = {:.3}, z = {:.3} mm (line {})",
                most.change / MILLIMETRE,
                most.read.point.x / MILLIMETRE,
                most.read.point.y / MILLIMETRE,
                most.line
            ),
            None => String::new(),
        };
        format!(
            "{} points read, {} left after the repair, {} of those read more than {} mm off the surface{largest}",
            self.read,
            self.left,
            self.changed.len(),
            CHANGED / MILLIMETRE
        )
    }

    /// Corners of what is seen: the running surface, measured and standard, with a margin, m.
    fn view(&self) -> [Point2<f64>; 2] {
        let seen = self.parts.iter().filter(|part| part.running);
        let none =
            [Point2::new(f64::INFINITY, f64::INFINITY), Point2::new(f64::NEG_INFINITY, f64::NEG_INFINITY)];
        let [low, high] = seen.flat_map(|part| &part.points).fold(none, |[low, high], p| {
            [low.coords.inf(&p.coords).into(), high.coords.sup(&p.coords).into()]
        });
        [low - nalgebra::Vector2::repeat(MARGIN), high + nalgebra::Vector2::repeat(MARGIN)]
    }
}

/// The section with the origin of each part, and the material missing against the standard along it; `notes` stand below.
pub fn figure(width: u32, surface: &OnStandard, notes: &[String]) -> String {
    let [low, high] = surface.view();
    let inside = |p: &Point2<f64>| (low.x..=high.x).contains(&p.x) && (low.y..=high.y).contains(&p.y);
    let gap = (f64::NAN, f64::NAN);
    let seen = |p: &Point2<f64>| {
        if inside(p) { (p.x / MILLIMETRE, -p.y / MILLIMETRE) } else { gap }
    };
    let over = |p: &OffStandard| (p.along / MILLIMETRE, p.missing / MILLIMETRE);
    // Axes end with what they show: the margin counts as well.
    let corners = [low, high].iter().map(seen).collect();
    let mut section = vec![Series::line("", corners, GREY, Dash::None)];
    for (origin, color, dash, broad) in Origin::STYLES {
        let mut points: Vec<(f64, f64)> = Vec::new();
        for part in surface.parts.iter().filter(|part| part.origin == origin) {
            points.extend(part.points.iter().map(seen));
            points.push(gap);
        }
        if points.iter().any(|p| p.0.is_finite()) {
            let line = Series::line(origin.name(), points, color, dash);
            section.push(if broad { line.broad() } else { line });
        }
    }
    let mut missing = vec![Series::line(
        Origin::Measured.name(),
        surface.measured.iter().map(over).collect(),
        DARK,
        Dash::Solid,
    )];
    for transition in &surface.transitions {
        let points = transition.iter().map(over).collect();
        missing.push(Series::line(Origin::Transition.name(), points, ORANGE, Dash::Dashed).broad());
    }
    let mut marks = |name: &str, points: &[&OffStandard], color, marker| {
        let shown: Vec<&&OffStandard> = points.iter().filter(|p| inside(&p.point)).collect();
        if !shown.is_empty() {
            let places = shown.iter().map(|p| seen(&p.point)).collect();
            section.push(Series::marks(name, places, color, marker));
            missing.push(Series::marks(name, shown.iter().map(|p| over(p)).collect(), color, marker));
        }
    };
    marks("kept by the placing", &surface.kept.iter().collect::<Vec<_>>(), BLUE, Marker::Circle);
    let changed: Vec<&OffStandard> = surface.changed.iter().map(|p| &p.read).collect();
    marks("changed", &changed, RED, Marker::Triangle);
    let panels = [
        Panel::new("y to the field side (mm)", "height \u{2212}z (mm)", section),
        Panel::from_zero(
            "along the standard from the start of its running surface (mm)",
            "material missing, normal to it (mm)",
            missing,
        ),
    ];
    stacked_with_notes(width, 330, &panels, notes)
}

/// Caption of the figure.
pub(crate) fn caption(surface: &OnStandard) -> String {
    let used: Vec<&str> = Origin::STYLES
        .iter()
        .map(|(origin, ..)| *origin)
        .filter(|origin| origin.is_used() && surface.parts.iter().any(|part| part.origin == *origin))
        .map(Origin::name)
        .collect();
    format!(
        "{} on {}, in the frame of the standard: the {} is made of {}. Below, the material that is missing against the standard. {}.",
        surface.file,
        surface.standard,
        surface.body,
        used.join(", "),
        surface.changes()
    )
}
