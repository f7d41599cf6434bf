//! What all figures are drawn with: colours, lines, markers, texts, axis
//! ranges, and the SVG sheet.
//!
//! Every series differs in dash or marker and not only in colour, so that the
//! figures can be read in grey.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::rounding::with_minus_signs;

pub use plotters::style::RGBColor;

/// The backend works in whole pixels; figures are drawn this much larger and shown smaller.
const SCALE: u32 = 3;
/// Font of all texts.
const FONT: &str = "sans-serif";
/// Height of tick labels, px.
pub const TICK_TEXT: u32 = 11;
/// Height of axis and legend texts, px.
pub const LABEL_TEXT: u32 = 12;
/// Mean width of a letter over the height of the text.
pub const LETTER_WIDTH: f64 = 0.52;

/// Colours that keep their order of lightness in grey.
pub const DARK: RGBColor = RGBColor(16, 42, 84);
/// See [`DARK`].
pub const BLUE: RGBColor = RGBColor(31, 104, 170);
/// See [`DARK`].
pub const PALE_BLUE: RGBColor = RGBColor(135, 180, 220);
/// See [`DARK`].
pub const DARK_RED: RGBColor = RGBColor(120, 20, 10);
/// See [`DARK`].
pub const RED: RGBColor = RGBColor(186, 58, 32);
/// See [`DARK`].
pub const ORANGE: RGBColor = RGBColor(226, 140, 30);
/// See [`DARK`].
pub const GREY: RGBColor = RGBColor(110, 110, 110);
/// See [`DARK`].
pub const LIGHT: RGBColor = RGBColor(222, 226, 231);

/// Drawing area of the SVG backend.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Dash {
    /// Unbroken.
    Solid,
    /// Long dashes.
    Dashed,
    /// Dots.
    Dotted,
    /// No line.
    None,
}

/// How points are marked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Marker {
    /// Not at all.
    None,
    /// Filled circle.
    Disc,
    /// Open circle.
    Circle,
    /// Open square.
    Square,
    /// Open triangle.
    Triangle,
}

/// One curve of a panel. A point that is not finite interrupts the line.
#[derive(Debug, Clone)]
pub struct Series {
    /// Entry of the legend; empty for none.
    pub name: String,
    /// The points.
    pub points: Vec<(f64, f64)>,
    /// Colour.
    pub color: RGBColor,
    /// Line.
    pub dash: Dash,
    /// Markers.
    pub marker: Marker,
    /// Line of the legend's sample, where it is not the series' own: markers and the line fitted
    /// to them share an entry.
    pub sample: Option<Dash>,
    /// Width of the line, tenths of a pixel.
    pub width: u32,
    /// Texts beside the points, in their order; none for points beyond the last.
    pub labels: Vec<String>,
    /// Whether the points are the outline of an area, which is filled.
    pub filled: bool,
}

/// Usual width of a line, tenths of a pixel.
const LINE: u32 = 14;

impl Series {
    /// A line without markers.
    pub fn line(name: &str, points: Vec<(f64, f64)>, color: RGBColor, dash: Dash) -> Self {
        Self {
            name: name.into(),
            points,
            color,
            dash,
            marker: Marker::None,
            sample: None,
            width: LINE,
            labels: Vec::new(),
            filled: false,
        }
    }

    /// The area between a lower and an upper curve, (x, ends) in the order of x, one series for each part without a gap; the first is in the legend.
    pub fn band(name: &str, ends: &[(f64, [f64; 2])], color: RGBColor) -> Vec<Self> {
        let pieces = ends.split(|(x, ends)| !(x.is_finite() && ends.iter().all(|y| y.is_finite())));
        let outline = |piece: &[(f64, [f64; 2])]| -> Vec<(f64, f64)> {
            let side = |k: usize| piece.iter().map(move |(x, ends)| (*x, ends[k]));
            side(0).chain(side(1).rev()).collect()
        };
        let areas = pieces.filter(|piece| piece.len() > 1).enumerate().map(|(n, piece)| {
            let name = if n == 0 { name } else { "" };
            Self { filled: true, ..Self::line(name, outline(piece), color, Dash::None) }
        });
        areas.collect()
    }

    /// Markers without a line.
    pub fn marks(name: &str, points: Vec<(f64, f64)>, color: RGBColor, marker: Marker) -> Self {
        Self { marker, ..Self::line(name, points, color, Dash::None) }
    }

    /// Markers joined by a line.
    pub fn joined(name: &str, points: Vec<(f64, f64)>, color: RGBColor, dash: Dash, marker: Marker) -> Self {
        Self { dash, ..Self::marks(name, points, color, marker) }
    }

    /// The same with a broad line, for what other curves are laid over.
    pub fn broad(self) -> Self {
        Self { width: 32, ..self }
    }

    /// The same with a thin line, for what lies on an area that is little broader.
    pub fn thin(self) -> Self {
        Self { width: 7, ..self }
    }

    /// The same with a text beside each point.
    pub fn labelled(self, labels: Vec<String>) -> Self {
        Self { labels, ..self }
    }

    /// The same with a line in the legend.
    pub fn sampled(self, dash: Dash) -> Self {
        Self { sample: Some(dash), ..self }
    }
}

/// Result of drawing into memory.
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Runs a drawing on a white sheet and returns the SVG.
///
/// The backend writes to a string, which cannot fail; if the library refuses a shape all the
/// same, the figure says so instead of being empty.
pub fn svg(width: u32, height: u32, draw: impl FnOnce(&Area<'_>) -> Drawn) -> String {
    let mut text = String::new();
    let drawn = {
        let root = SVGBackend::with_string(&mut text, (width * SCALE, height * SCALE)).into_drawing_area();
        root.fill(&WHITE).map_err(Into::into).and_then(|()| draw(&root)).and_then(|()| Ok(root.present()?))
    };
    if let Err(cause) = drawn {
        return format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"40\"><text x=\"10\" y=\"25\">figure failed: {cause}</text></svg>"
        );
    }
    // Shown at its nominal size; the view box keeps the fine pixels.
    let large = format!("width=\"{}\" height=\"{}\" viewBox", width * SCALE, height * SCALE);
    text.replacen(&large, &format!("width=\"{width}\" height=\"{height}\" viewBox"), 1)
}

/// Nominal pixels to those of the backend.
pub fn px(length: u32) -> i32 {
    (length * SCALE) as i32
}

/// Text style of a nominal height.
pub fn text(height: u32, color: RGBColor) -> TextStyle<'static> {
    // The library takes the height of the whole line; 1.24 is its ratio to the letter size.
    (FONT, f64::from(height * SCALE) * 1.24).into_font().color(&color)
}

/// Text of labels, anchored as given.
pub fn label(height: u32, horizontal: HPos, vertical: VPos) -> TextStyle<'static> {
    text(height, BLACK).pos(Pos::new(horizontal, vertical))
}

/// Solid stroke of a nominal width in tenths of a pixel.
pub fn stroke(color: RGBColor, tenths: u32) -> ShapeStyle {
    color.stroke_width((tenths * SCALE).div_ceil(10))
}

/// Axis range around values that ends on ticks, and the distance of the ticks.
pub fn nice_range(values: impl Iterator<Item = f64>, from_zero: bool) -> (f64, f64, f64) {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for value in values.filter(|v| v.is_finite()) {
        low = low.min(value);
        high = high.max(value);
    }
    if low > high {
        (low, high) = (0.0, 1.0);
    }
    if from_zero {
        low = low.min(0.0);
        high = high.max(0.0);
    }
    if high - low <= (1e-12 * high.abs().max(low.abs())).max(f64::MIN_POSITIVE) {
        // A constant still needs an axis of some length.
        let half = if high.abs() < 1e-290 { 1.0 } else { 0.1 * high.abs() };
        (low, high) = (low - half, high + half);
    }
    let step = nice_step((high - low) / 7.0);
    let begin = (low / step + 1e-9).floor() * step;
    let end = (high / step - 1e-9).ceil() * step;
    (begin, end, step)
}

/// The nearest of 1, 2 or 5 times a power of ten that is not smaller; 1 where there is no distance to divide.
pub fn nice_step(raw: f64) -> f64 {
    if !(raw.is_finite() && raw >= f64::MIN_POSITIVE) {
        return 1.0;
    }
    let power = 10f64.powf(raw.log10().floor());
    let lead = raw / power;
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().find(|s| lead <= s * (1.0 + 1e-9)).unwrap_or(10.0);
    step * power
}

/// A tick's number with as many decimals as the distance of the ticks needs; with an exponent where it would be long.
pub fn tick(value: f64, step: f64) -> String {
    const LONG: f64 = 1e9;
    if !(value.abs() < LONG && step * LONG > 1.0) {
        return with_minus_signs(&format!("{value:.2e}"));
    }
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    let is_zero = text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.');
    if is_zero { "0".into() } else { with_minus_signs(&text) }
}

/// Outline of a rectangle. The library's own has no line width in this backend.
pub fn frame([a, b]: [(i32, i32); 2], style: ShapeStyle) -> PathElement<(i32, i32)> {
    PathElement::new([a, (b.0, a.1), b, (a.0, b.1), a], style)
}

/// Draws a marker at a pixel of the area.
pub fn mark(area: &Area<'_>, marker: Marker, color: RGBColor, (x, y): (i32, i32)) -> Drawn {
    let r = px(3);
    let thin = stroke(color, 12);
    let square = [(x - r, y - r), (x + r, y + r)];
    let corners = [(x, y - r - 2), (x + r + 1, y + r), (x - r - 1, y + r), (x, y - r - 2)];
    match marker {
        Marker::None => {}
        Marker::Disc => area.draw(&Circle::new((x, y), r, color.filled()))?,
        Marker::Circle => {
            area.draw(&Circle::new((x, y), r, WHITE.filled()))?;
            area.draw(&Circle::new((x, y), r, thin))?;
        }
        Marker::Square => {
            area.draw(&Rectangle::new(square, WHITE.filled()))?;
            area.draw(&frame(square, thin))?;
        }
        Marker::Triangle => {
            area.draw(&Polygon::new(corners, WHITE.filled()))?;
            area.draw(&PathElement::new(corners, thin))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_end_on_ticks_and_contain_the_data() {
        // ROUNDOFF: a few operations on numbers of the size of the range.
        const ROUNDOFF: f64 = 1e-9;
        for (low, high) in [(0.0, 1.0), (-3.7, 12.2), (1e-7, 3e-7), (5.0, 5.0), (0.0, 0.0), (-61.25, 123.0)] {
            let (begin, end, step) = nice_range([low, high].into_iter(), false);
            assert!(begin <= low + ROUNDOFF && end >= high - ROUNDOFF, "{low} {high}: {begin} {end}");
            assert!(((end - begin) / step).fract().min(1.0 - ((end - begin) / step).fract()) < 1e-6);
            assert!((end - begin) / step <= 9.5);
        }
    }

    /// Goal: ranges and ticks are finite for whatever is in a history.
    #[test]
    fn any_values_have_an_axis() {
        for values in [&[][..], &[0.0], &[f64::NAN], &[5e-324], &[1e300, -1e300], &[f64::INFINITY, 1.0]] {
            let (begin, end, step) = nice_range(values.iter().copied(), true);
            assert!(
                begin.is_finite() && end.is_finite() && end > begin && step > 0.0,
                "{values:?}: {begin} {end}"
            );
            assert!((end - begin) / step < 50.0 && tick(end, step).chars().count() < 14, "{values:?}");
        }
        for raw in [0.0, -1.0, f64::NAN, f64::INFINITY, 5e-324] {
            assert_eq!(nice_step(raw), 1.0);
        }
    }

    #[test]
    fn ticks_have_the_decimals_of_their_distance() {
        assert_eq!(tick(0.30000000000000004, 0.1), "0.3");
        assert_eq!(tick(-20.0, 5.0), "\u{2212}20");
        assert_eq!(tick(-1e-17, 0.05), "0");
        assert_eq!(tick(1200.0, 200.0), "1200");
    }
}
