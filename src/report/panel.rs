//! Panels: curves over common axes, under each other, with one legend.

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::legend::{Entry, draw_legend, legend_height};
use super::plot::{
    Area, Dash, Drawn, GREY, LABEL_TEXT, LETTER_WIDTH, LIGHT, Marker, Series, TICK_TEXT, frame, label, mark,
    nice_range, nice_step, px, stroke, svg, tick,
};

/// A chart with two linear axes.
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

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
    stacked_with_notes(width, panel_height, panels, &[])
}

/// As [`stacked`], with lines of text below the panels.
pub fn stacked_with_notes(width: u32, panel_height: u32, panels: &[Panel], notes: &[String]) -> String {
    drawn(width, panel_height, panels, notes, None)
}

/// As [`stacked_with_notes`], for points at 0, 1, 2 and so on that have names in place of numbers, each of two lines; those with empty ones
/// have no grid line.
pub fn stacked_over_names(
    width: u32,
    panel_height: u32,
    panels: &[Panel],
    notes: &[String],
    names: &[[String; 2]],
) -> String {
    drawn(width, panel_height, panels, notes, Some(names))
}

fn drawn(
    width: u32,
    panel_height: u32,
    panels: &[Panel],
    notes: &[String],
    names: Option<&[[String; 2]]>,
) -> String {
    let entries = legend_of(panels);
    let legend = legend_height(width, &entries);
    let notes: Vec<String> = notes.iter().flat_map(|note| broken(note, width)).collect();
    let drawn = legend + panel_height * panels.len() as u32;
    let below = if notes.is_empty() { 0 } else { NOTE_LINE * (notes.len() as u32 + 1) };
    svg(width, drawn + below, |root| {
        let (root, foot) = root.split_vertically(px(drawn));
        for (index, line) in notes.iter().enumerate() {
            let at = (px(NOTE_MARGIN), px(NOTE_LINE * index as u32 + NOTE_LINE / 2));
            foot.draw(&Text::new(line.clone(), at, label(TICK_TEXT, HPos::Left, VPos::Top)))?;
        }
        let (top, body) = root.split_vertically(px(legend));
        draw_legend(&top, width, &entries)?;
        let ranges: Vec<Ranges> = panels.iter().map(|panel| ranges(panel, names)).collect();
        let left = ranges.iter().map(|r| label_width(r.y)).max().unwrap_or(0);
        for (index, area) in body.split_evenly((panels.len(), 1)).iter().enumerate() {
            let panel = &panels[index];
            // A label that the next panel repeats is left to that.
            let repeated = panels.get(index + 1).is_some_and(|next| next.x_label == panel.x_label);
            let labels = (if repeated { "" } else { panel.x_label.as_str() }, panel.y_label.as_str());
            let mut chart = axes(area, &ranges[index], labels, left, names)?;
            for series in &panel.series {
                draw_series(area, &mut chart, series)?;
            }
        }
        Ok(())
    })
}

/// Distance of the lines of the notes, px.
const NOTE_LINE: u32 = 16;
/// Margin beside the notes, px.
const NOTE_MARGIN: u32 = 14;

/// A note in lines that fit the width; those after the first are indented.
fn broken(note: &str, width: u32) -> Vec<String> {
    let room = (f64::from(width - 2 * NOTE_MARGIN) / (f64::from(TICK_TEXT) * LETTER_WIDTH)) as usize;
    let mut lines = vec![String::new()];
    for word in note.split(' ') {
        let last = lines.len() - 1;
        if lines[last].chars().count() + 1 + word.chars().count() > room && !lines[last].trim().is_empty() {
            // Plain blanks at the start of a text are dropped by browsers.
            lines.push(format!("\u{2003}\u{2003}{word}"));
        } else {
            if !lines[last].is_empty() {
                lines[last].push(' ');
            }
            lines[last].push_str(word);
        }
    }
    lines
}

fn legend_of(panels: &[Panel]) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for series in panels.iter().flat_map(|panel| &panel.series) {
        if !series.name.is_empty() && !entries.iter().any(|entry| entry.name == series.name) {
            entries.push(Entry::of(series));
        }
    }
    entries
}

/// Height of a second line of ticks, px.
const SECOND_LINE: u32 = 15;

/// Axes of a panel with their labels; `left` is the width of those of the vertical axis, `names` stand in place of the numbers of the
/// horizontal one.
fn axes<'a, 'b>(
    area: &'a Area<'b>,
    Ranges { x, y }: &Ranges,
    (x_label, y_label): (&str, &str),
    left: u32,
    names: Option<&[[String; 2]]>,
) -> Result<Chart<'a, 'b>, Box<dyn std::error::Error>> {
    let (x, y) = (*x, *y);
    let second = if names.is_some() { SECOND_LINE } else { 0 };
    let mut chart = ChartBuilder::on(area)
        .margin_top(px(8))
        .margin_right(px(20))
        .margin_bottom(px(2))
        .set_label_area_size(LabelAreaPosition::Left, px(left))
        .set_label_area_size(LabelAreaPosition::Bottom, px(40 + second))
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
    let named = |value: f64| names.and_then(|names| names.get(value.round() as usize));
    for value in ticks(x).filter(|value| named(*value).is_none_or(|name| name != &["", ""])) {
        let (at, _) = plot.map_coordinate(&(value, y.0));
        area_line(area, (at, y_pixels.start), (at, y_pixels.end), stroke(LIGHT, 6))?;
        let style = label(TICK_TEXT, HPos::Center, VPos::Top);
        if names.is_none() {
            area_text(area, &tick(value, x.2), (at, y_pixels.end + px(5)), style.clone())?;
        }
        for (line, text) in named(value).into_iter().flatten().enumerate() {
            let down = px(5 + SECOND_LINE * line as u32);
            area_text(area, text, (at, y_pixels.end + down), style.clone())?;
        }
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
    let middle = ((x_pixels.start + x_pixels.end) / 2, y_pixels.end + px(21 + second));
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

/// The vertical axis ends on ticks; the horizontal one ends with the data, or half-way beyond the first and the last of the names.
fn ranges(panel: &Panel, names: Option<&[[String; 2]]>) -> Ranges {
    let points =
        || panel.series.iter().flat_map(|s| &s.points).filter(|(x, y)| x.is_finite() && y.is_finite());
    let y = nice_range(points().map(|p| p.1), panel.from_zero);
    if let Some(names) = names {
        return Ranges { x: (-0.5, names.len().max(1) as f64 - 0.5, 1.0), y };
    }
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
    let style = stroke(series.color, series.width);
    let pieces =
        series.points.split(|(x, y)| !x.is_finite() || !y.is_finite()).filter(|piece| !piece.is_empty());
    for piece in pieces {
        let points = piece.to_vec();
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
    for (at, text) in series.points.iter().zip(&series.labels) {
        let (x, y) = chart.plotting_area().map_coordinate(at);
        let style = label(LABEL_TEXT, HPos::Left, VPos::Bottom);
        area_text(area, text, (x + px(4), y - px(3)), style)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_are_broken_between_words() {
        let note = "line 12: spike of a length that nobody would have expected in a profile";
        let lines = broken(note, 200);
        assert!(lines.len() > 2, "{lines:?}");
        assert!(lines.iter().all(|line| line.chars().count() <= 32), "{lines:?}");
        let words: Vec<&str> = lines.iter().flat_map(|line| line.split_whitespace()).collect();
        assert_eq!(words.join(" "), note);
    }
}
