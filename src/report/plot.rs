//! Charts as SVG: panels with axes, lines, markers and a legend above the
//! plot, so that nothing covers the data.
//!
//! Every series differs in dash or marker and not only in colour, so that the
//! figures can be read in grey.

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// The backend works in whole pixels; figures are drawn this much larger and shown smaller.
const SCALE: u32 = 3;
/// Font of all texts.
const FONT: &str = "sans-serif";
/// Height of tick labels, px.
const TICK_TEXT: u32 = 11;
/// Height of axis and legend texts, px.
const LABEL_TEXT: u32 = 12;
/// Mean width of a letter over the height of the text.
const LETTER_WIDTH: f64 = 0.52;

/// Colours that keep their order of lightness in grey.
pub const DARK: RGBColor = RGBColor(16, 42, 84);
/// See [`DARK`].
pub const BLUE: RGBColor = RGBColor(31, 104, 170);
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
/// A chart with two linear axes.
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

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
}

impl Series {
    /// A line without markers.
    pub fn line(name: &str, points: Vec<(f64, f64)>, color: RGBColor, dash: Dash) -> Self {
        Self { name: name.into(), points, color, dash, marker: Marker::None, sample: None }
    }

    /// Markers without a line.
    pub fn marks(name: &str, points: Vec<(f64, f64)>, color: RGBColor, marker: Marker) -> Self {
        Self { name: name.into(), points, color, dash: Dash::None, marker, sample: None }
    }

    /// Markers joined by a line.
    pub fn joined(name: &str, points: Vec<(f64, f64)>, color: RGBColor, dash: Dash, marker: Marker) -> Self {
        Self { name: name.into(), points, color, dash, marker, sample: None }
    }

    /// The same with a line in the legend.
    pub fn sampled(self, dash: Dash) -> Self {
        Self { sample: Some(dash), ..self }
    }
}

/// Curves over common axes.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Label of the horizontal axis, with its unit.
    pub x_label: String,
    /// Label of the vertical axis, with its unit.
    pub y_label: String,
    /// Whether the vertical axis must show zero.
    pub from_zero: bool,
    /// The curves, drawn in this order.
    pub series: Vec<Series>,
}

/// Draws panels under each other, with one legend for all above them.
pub fn stacked(width: u32, panel_height: u32, panels: &[Panel]) -> String {
    let entries = legend_of(panels);
    let legend = legend_height(width, &entries);
    let height = legend + panel_height * panels.len() as u32;
    svg(width, height, |root| {
        let (top, body) = root.split_vertically(px(legend));
        draw_legend(&top, width, &entries)?;
        let ranges: Vec<Ranges> = panels.iter().map(ranges).collect();
        let left = ranges.iter().map(|r| label_width(r.y)).max().unwrap_or(0);
        for (index, area) in body.split_evenly((panels.len(), 1)).iter().enumerate() {
            let panel = &panels[index];
            // A label that the next panel repeats is left to that.
            let repeated = panels.get(index + 1).is_some_and(|next| next.x_label == panel.x_label);
            let labels = (if repeated { "" } else { panel.x_label.as_str() }, panel.y_label.as_str());
            let mut chart = axes(area, &ranges[index], labels, left)?;
            for series in &panel.series {
                draw_series(area, &mut chart, series)?;
            }
        }
        Ok(())
    })
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

/// Text of labels, anchored as asked.
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
    if high - low <= 1e-12 * high.abs().max(low.abs()) {
        // A constant still needs an axis of some length.
        let half = if high == 0.0 { 1.0 } else { 0.1 * high.abs() };
        (low, high) = (low - half, high + half);
    }
    let step = nice_step((high - low) / 7.0);
    let begin = (low / step + 1e-9).floor() * step;
    let end = (high / step - 1e-9).ceil() * step;
    (begin, end, step)
}

/// The nearest of 1, 2 or 5 times a power of ten that is not smaller.
pub fn nice_step(raw: f64) -> f64 {
    let power = 10f64.powf(raw.log10().floor());
    let lead = raw / power;
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().find(|s| lead <= s * (1.0 + 1e-9)).unwrap_or(10.0);
    step * power
}

/// A tick's number with as many decimals as the distance of the ticks needs.
pub fn tick(value: f64, step: f64) -> String {
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    let is_zero = text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.');
    if is_zero { "0".into() } else { text.replace('-', "\u{2212}") }
}

/// Axes of a panel with their labels; `left` is the width of those of the vertical axis.
fn axes<'a, 'b>(
    area: &'a Area<'b>,
    Ranges { x, y }: &Ranges,
    (x_label, y_label): (&str, &str),
    left: u32,
) -> Result<Chart<'a, 'b>, Box<dyn std::error::Error>> {
    let (x, y) = (*x, *y);
    let mut chart = ChartBuilder::on(area)
        .margin_top(px(8))
        .margin_right(px(20))
        .margin_bottom(px(2))
        .set_label_area_size(LabelAreaPosition::Left, px(left))
        .set_label_area_size(LabelAreaPosition::Bottom, px(40))
        .build_cartesian_2d(x.0..x.1, y.0..y.1)?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .disable_y_mesh()
        .x_labels(0)
        .y_labels(0)
        .axis_style(stroke(BLACK, 8))
        .draw()?;
    let plot = chart.plotting_area();
    let (x_pixels, y_pixels) = plot.get_pixel_range();
    for value in ticks(x) {
        let (at, _) = plot.map_coordinate(&(value, y.0));
        area_line(area, (at, y_pixels.start), (at, y_pixels.end), stroke(LIGHT, 6))?;
        let style = label(TICK_TEXT, HPos::Center, VPos::Top);
        area_text(area, &tick(value, x.2), (at, y_pixels.end + px(5)), style)?;
    }
    for value in ticks(y) {
        let (_, at) = plot.map_coordinate(&(x.0, value));
        area_line(area, (x_pixels.start, at), (x_pixels.end, at), stroke(LIGHT, 6))?;
        let style = label(TICK_TEXT, HPos::Right, VPos::Center);
        area_text(area, &tick(value, y.2), (x_pixels.start - px(5), at), style)?;
    }
    if y.0 < 0.0 && y.1 > 0.0 {
        let (_, at) = plot.map_coordinate(&(x.0, 0.0));
        area_line(area, (x_pixels.start, at), (x_pixels.end, at), stroke(GREY, 8))?;
    }
    let origin = area.get_base_pixel();
    let corners = [(x_pixels.start, y_pixels.start), (x_pixels.end, y_pixels.end)];
    area.draw(&frame(corners.map(|(a, b)| (a - origin.0, b - origin.1)), stroke(BLACK, 8)))?;
    let middle = ((x_pixels.start + x_pixels.end) / 2, y_pixels.end + px(21));
    area_text(area, x_label, middle, label(LABEL_TEXT, HPos::Center, VPos::Top))?;
    let side = (origin.0 + px(4), (y_pixels.start + y_pixels.end) / 2);
    let upright = label(LABEL_TEXT, HPos::Center, VPos::Top).transform(FontTransform::Rotate270);
    area_text(area, y_label, side, upright)?;
    Ok(chart)
}

fn ticks(axis: (f64, f64, f64)) -> impl Iterator<Item = f64> {
    let (low, high, step) = axis;
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(move |n| n as f64 * step)
}

/// A line between absolute pixels.
fn area_line(area: &Area<'_>, a: (i32, i32), b: (i32, i32), style: ShapeStyle) -> Drawn {
    let origin = area.get_base_pixel();
    let shifted = [a, b].map(|(x, y)| (x - origin.0, y - origin.1));
    area.draw(&PathElement::new(shifted, style))?;
    Ok(())
}

/// A text at an absolute pixel.
fn area_text(area: &Area<'_>, text: &str, at: (i32, i32), style: TextStyle<'_>) -> Drawn {
    let origin = area.get_base_pixel();
    area.draw(&Text::new(text.to_string(), (at.0 - origin.0, at.1 - origin.1), style))?;
    Ok(())
}

/// Ranges of both axes: (low, high, distance of the ticks).
struct Ranges {
    x: (f64, f64, f64),
    y: (f64, f64, f64),
}

/// The vertical axis ends on ticks; the horizontal one ends with the data.
fn ranges(panel: &Panel) -> Ranges {
    let points = || panel.series.iter().flat_map(|s| &s.points).filter(|(x, y)| x.is_finite() && y.is_finite());
    let y = nice_range(points().map(|p| p.1), panel.from_zero);
    // Points without a value count too: all panels over one run then have the same axis.
    let places = || panel.series.iter().flat_map(|s| &s.points).map(|p| p.0).filter(|x| x.is_finite());
    let (mut low, mut high, mut step) = nice_range(places(), false);
    let ends = places().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    if ends.1 > ends.0 {
        (low, high) = ends;
        step = nice_step((high - low) / 8.0);
    }
    Ranges { x: (low, high, step), y }
}

/// Width that the labels of a vertical axis need, px.
fn label_width(y: (f64, f64, f64)) -> u32 {
    let widest = ticks(y).map(|v| tick(v, y.2).chars().count()).max().unwrap_or(1) as f64;
    (widest * f64::from(TICK_TEXT) * LETTER_WIDTH) as u32 + LABEL_TEXT + 18
}

/// Draws one curve.
fn draw_series(area: &Area<'_>, chart: &mut Chart<'_, '_>, series: &Series) -> Drawn {
    let style = stroke(series.color, 14);
    let pieces = series.points.split(|(x, y)| !x.is_finite() || !y.is_finite()).filter(|piece| !piece.is_empty());
    for piece in pieces {
        let points = piece.iter().copied().collect::<Vec<_>>();
        match series.dash {
            Dash::None => {}
            Dash::Solid => {
                chart.draw_series(LineSeries::new(points, style))?;
            }
            Dash::Dashed => {
                chart.draw_series(DashedLineSeries::new(points, px(7), px(4), style))?;
            }
            Dash::Dotted => {
                chart.draw_series(DashedLineSeries::new(points, px(2), px(3), style))?;
            }
        }
    }
    if series.marker != Marker::None {
        let origin = area.get_base_pixel();
        for at in series.points.iter().filter(|(x, y)| x.is_finite() && y.is_finite()) {
            let (x, y) = chart.plotting_area().map_coordinate(at);
            mark(area, series.marker, series.color, (x - origin.0, y - origin.1))?;
        }
    }
    Ok(())
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

/// Entry of a legend.
#[derive(Debug, Clone)]
pub struct Entry {
    name: String,
    color: RGBColor,
    dash: Dash,
    marker: Marker,
    filled: bool,
}

impl Entry {
    /// An entry with a filled patch.
    pub fn patch(name: &str, color: RGBColor) -> Self {
        Self { name: name.into(), color, dash: Dash::None, marker: Marker::None, filled: true }
    }

    /// An entry with a line or a marker.
    pub fn of(series: &Series) -> Self {
        Self {
            name: series.name.clone(),
            color: series.color,
            dash: series.sample.unwrap_or(series.dash),
            marker: series.marker,
            filled: false,
        }
    }

    /// Nominal width with the gap to the next entry.
    fn width(&self) -> u32 {
        SAMPLE + 6 + (self.name.chars().count() as f64 * f64::from(LABEL_TEXT) * LETTER_WIDTH) as u32 + 22
    }
}

/// Length of the sample line of a legend, px.
const SAMPLE: u32 = 28;
/// Height of a row of a legend, px.
const LEGEND_ROW: u32 = 20;
/// Left end of a legend, px.
const LEGEND_LEFT: u32 = 60;

fn legend_of(panels: &[Panel]) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for series in panels.iter().flat_map(|panel| &panel.series) {
        if !series.name.is_empty() && !entries.iter().any(|entry| entry.name == series.name) {
            entries.push(Entry::of(series));
        }
    }
    entries
}

/// Nominal left end and row of every entry.
fn legend_layout(width: u32, entries: &[Entry]) -> Vec<(u32, u32)> {
    let (mut x, mut row) = (LEGEND_LEFT, 0);
    entries
        .iter()
        .map(|entry| {
            if x > LEGEND_LEFT && x + entry.width() > width {
                x = LEGEND_LEFT;
                row += 1;
            }
            let place = (x, row);
            x += entry.width();
            place
        })
        .collect()
}

/// Nominal height of a legend.
pub fn legend_height(width: u32, entries: &[Entry]) -> u32 {
    match legend_layout(width, entries).last() {
        Some((_, row)) => (row + 1) * LEGEND_ROW + 6,
        None => 0,
    }
}

/// Draws a legend into the area above the panels.
pub fn draw_legend(area: &Area<'_>, width: u32, entries: &[Entry]) -> Drawn {
    for (entry, (x, row)) in entries.iter().zip(legend_layout(width, entries)) {
        let y = px(row * LEGEND_ROW + 14);
        let (left, right) = (px(x), px(x + SAMPLE));
        let line = stroke(entry.color, 16);
        if entry.filled {
            let corners = [(left, y - px(5)), (right, y + px(5))];
            area.draw(&Rectangle::new(corners, entry.color.filled()))?;
            area.draw(&frame(corners, stroke(BLACK, 6)))?;
        }
        match entry.dash {
            Dash::None => {}
            Dash::Solid => area.draw(&PathElement::new([(left, y), (right, y)], line))?,
            Dash::Dashed => {
                area.draw(&DashedPathElement::new([(left, y), (right, y)].into_iter(), px(7), px(4), line))?
            }
            Dash::Dotted => {
                area.draw(&DashedPathElement::new([(left, y), (right, y)].into_iter(), px(2), px(3), line))?
            }
        }
        mark(area, entry.marker, entry.color, ((left + right) / 2, y))?;
        let style = label(LABEL_TEXT, HPos::Left, VPos::Center);
        area.draw(&Text::new(entry.name.clone(), (right + px(6), y), style))?;
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

    #[test]
    fn ticks_have_the_decimals_of_their_distance() {
        assert_eq!(tick(0.30000000000000004, 0.1), "0.3");
        assert_eq!(tick(-20.0, 5.0), "\u{2212}20");
        assert_eq!(tick(-1e-17, 0.05), "0");
        assert_eq!(tick(1200.0, 200.0), "1200");
    }
}
