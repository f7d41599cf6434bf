//! Panels: curves over common axes, under each other, with one legend.

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::legend::{Entry, draw_legend, legend_height};
use super::plot::{
    Area, Dash, Drawn, GREY, LABEL_TEXT, LETTER_WIDTH, LIGHT, Marker, Series, TICK_TEXT, frame, label, mark,
    nice_range, nice_step, px, stroke, svg, tick,
};
use crate::rounding::with_minus_signs;

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

impl Panel {
    /// Curves over axes with these labels.
    pub fn new(x_label: &str, y_label: &str, series: Vec<Series>) -> Self {
        Self { x_label: x_label.into(), y_label: y_label.into(), from_zero: false, series }
    }

    /// The same with a vertical axis that shows zero.
    pub fn from_zero(x_label: &str, y_label: &str, series: Vec<Series>) -> Self {
        Self { from_zero: true, ..Self::new(x_label, y_label, series) }
    }
}

/// Draws panels under each other, with one legend for all above them.
pub fn stacked(width: u32, panel_height: u32, panels: &[Panel]) -> String {
    stacked_with_notes(width, panel_height, panels, &[])
}

/// As [`stacked`], with lines of text below the panels.
pub fn stacked_with_notes(width: u32, panel_height: u32, panels: &[Panel], notes: &[String]) -> String {
    drawn(width, panel_height, panels, notes, Scale::Linear)
}

/// As [`stacked_with_notes`] with logarithmic axes; the vertical axis of a panel that must show zero stays linear. Points that are
/// not positive have no place and interrupt the line.
pub fn stacked_logarithmic(width: u32, panel_height: u32, panels: &[Panel], notes: &[String]) -> String {
    let logarithm = |value: f64| if value > 0.0 { value.log10() } else { f64::NAN };
    let panels: Vec<Panel> = panels
        .iter()
        .map(|panel| {
            let mut panel = panel.clone();
            let linear = panel.from_zero;
            for point in panel.series.iter_mut().flat_map(|series| &mut series.points) {
                *point = (logarithm(point.0), if linear { point.1 } else { logarithm(point.1) });
            }
            panel
        })
        .collect();
    drawn(width, panel_height, &panels, notes, Scale::Logarithmic)
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
    drawn(width, panel_height, panels, notes, Scale::Names(names))
}

/// What the axes show.
#[derive(Clone, Copy)]
enum Scale<'a> {
    /// The points' own values.
    Linear,
    /// Names at 0, 1, 2 and so on along the horizontal axis.
    Names(&'a [[String; 2]]),
    /// Values whose common logarithms are those of the points.
    Logarithmic,
}

fn drawn(width: u32, panel_height: u32, panels: &[Panel], notes: &[String], scale: Scale<'_>) -> String {
    let entries = legend_of(panels);
    let legend = legend_height(width, &entries);
    let notes: Vec<String> = notes.iter().flat_map(|note| broken(&with_minus_signs(note), width)).collect();
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
        let ranges: Vec<Ranges> = panels.iter().map(|panel| ranges(panel, scale)).collect();
        let left = ranges.iter().map(|ranges| label_width(&ranges.y)).max().unwrap_or(0);
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

/// Axes of a panel with their labels; `left` is the width of those of the vertical axis.
fn axes<'a, 'b>(
    area: &'a Area<'b>,
    Ranges { x, y }: &Ranges,
    (x_label, y_label): (&str, &str),
    left: u32,
) -> Result<Chart<'a, 'b>, Box<dyn std::error::Error>> {
    let lines = x.ticks.iter().map(|tick| tick.text.len()).max().unwrap_or(1).max(1) as u32;
    let second = SECOND_LINE * (lines - 1);
    let mut chart = ChartBuilder::on(area)
        .margin_top(px(8))
        .margin_right(px(20))
        .margin_bottom(px(2))
        .set_label_area_size(LabelAreaPosition::Left, px(left))
        .set_label_area_size(LabelAreaPosition::Bottom, px(40 + second))
        .build_cartesian_2d(x.low..x.high, y.low..y.high)?;
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
    for Tick { at, text } in &x.ticks {
        let (at, _) = plot.map_coordinate(&(*at, y.low));
        area_line(area, (at, y_pixels.start), (at, y_pixels.end), stroke(LIGHT, 6))?;
        for (line, text) in text.iter().enumerate() {
            let down = px(5 + SECOND_LINE * line as u32);
            let style = label(TICK_TEXT, HPos::Center, VPos::Top);
            area_text(area, text, (at, y_pixels.end + down), style)?;
        }
    }
    for Tick { at, text } in &y.ticks {
        let (_, at) = plot.map_coordinate(&(x.low, *at));
        area_line(area, (x_pixels.start, at), (x_pixels.end, at), stroke(LIGHT, 6))?;
        let style = label(TICK_TEXT, HPos::Right, VPos::Center);
        area_text(area, &text.concat(), (x_pixels.start - px(5), at), style)?;
    }
    if y.shows_zero {
        let (_, at) = plot.map_coordinate(&(x.low, 0.0));
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

/// A place on an axis with its label, in lines.
struct Tick {
    at: f64,
    text: Vec<String>,
}

/// An axis from `low` to `high`.
struct Axis {
    low: f64,
    high: f64,
    ticks: Vec<Tick>,
    /// Whether it crosses the other axis at a value of 0.
    shows_zero: bool,
}

impl Axis {
    /// A linear axis with ticks at the multiples of `step`.
    fn linear((low, high, step): (f64, f64, f64)) -> Self {
        let first = (low / step - 1e-9).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        let at = |n: i64| n as f64 * step;
        let ticks = (first..=last).map(|n| Tick { at: at(n), text: vec![tick(at(n), step)] }).collect();
        Self { low, high, ticks, shows_zero: low < 0.0 && high > 0.0 }
    }

    /// An axis with names at 0, 1, 2 and so on, from half-way before the first to half-way beyond the last.
    fn named(names: &[[String; 2]]) -> Self {
        let named = names.iter().enumerate().filter(|(_, name)| *name != &["", ""]);
        let ticks = named.map(|(n, name)| Tick { at: n as f64, text: name.to_vec() }).collect();
        Self { low: -0.5, high: names.len().max(1) as f64 - 0.5, ticks, shows_zero: false }
    }

    /// A logarithmic axis around common logarithms, with ticks at round values; `whole`: it ends on ticks.
    fn logarithmic(logarithms: impl Iterator<Item = f64>, whole: bool) -> Self {
        /// More decades than these have ticks at the powers of ten alone, fewer than these have more between them.
        const DECADES: [f64; 2] = [4.0, 1.3];
        /// Decades beside a single value.
        const BESIDE: f64 = 0.2;
        let ends = logarithms.filter(|value| value.is_finite());
        let (mut low, mut high) =
            ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        if high - low < BESIDE {
            (low, high) = (low - BESIDE, high + BESIDE);
        }
        let leads: &[f64] = match high - low {
            many if many > DECADES[0] => &[1.0],
            few if few < DECADES[1] => &[1.0, 1.5, 2.0, 3.0, 5.0, 7.0],
            _ => &[1.0, 2.0, 5.0],
        };
        let (first, last) = (low.floor() as i32 - 1, high.ceil() as i32 + 1);
        let places = || (first..=last).flat_map(|power| leads.iter().map(move |lead| (*lead, power)));
        let at = |(lead, power): (f64, i32)| lead.log10() + f64::from(power);
        if whole {
            low = places().map(at).filter(|at| *at <= low + 1e-9).fold(low - 1.0, f64::max);
            high = places().map(at).filter(|at| *at >= high - 1e-9).fold(high + 1.0, f64::min);
        }
        let within = places().filter(|place| (low - 1e-9..=high + 1e-9).contains(&at(*place)));
        let ticks = within
            .map(|(lead, power)| {
                let unit = 10f64.powi(power);
                let step = if lead.fract() == 0.0 { unit } else { 0.1 * unit };
                Tick { at: at((lead, power)), text: vec![tick(lead * unit, step)] }
            })
            .collect();
        Self { low, high, ticks, shows_zero: false }
    }
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

/// Both axes.
struct Ranges {
    x: Axis,
    y: Axis,
}

/// The vertical axis ends on ticks; the horizontal one ends with the data, or half-way beyond the first and the last of the names.
fn ranges(panel: &Panel, scale: Scale<'_>) -> Ranges {
    let points =
        || panel.series.iter().flat_map(|s| &s.points).filter(|(x, y)| x.is_finite() && y.is_finite());
    // Points without a value count too: all panels over one run then have the same axis.
    let places = || panel.series.iter().flat_map(|s| &s.points).map(|p| p.0).filter(|x| x.is_finite());
    let linear = || Axis::linear(nice_range(points().map(|p| p.1), panel.from_zero));
    match scale {
        Scale::Names(names) => Ranges { x: Axis::named(names), y: linear() },
        Scale::Logarithmic => {
            let y = if panel.from_zero { linear() } else { Axis::logarithmic(points().map(|p| p.1), true) };
            Ranges { x: Axis::logarithmic(places(), false), y }
        }
        Scale::Linear => {
            let (mut low, mut high, mut step) = nice_range(places(), false);
            let ends = places().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
            if ends.1 > ends.0 {
                (low, high) = ends;
                step = nice_step((high - low) / 8.0);
            }
            Ranges { x: Axis::linear((low, high, step)), y: linear() }
        }
    }
}

/// Width that the labels of a vertical axis need, px.
fn label_width(y: &Axis) -> u32 {
    let letters = y.ticks.iter().map(|tick| tick.text.iter().map(|text| text.chars().count()).sum());
    let widest = letters.max().unwrap_or(1_usize) as f64;
    (widest * f64::from(TICK_TEXT) * LETTER_WIDTH) as u32 + LABEL_TEXT + 18
}

/// Draws one curve.
fn draw_series(area: &Area<'_>, chart: &mut Chart<'_, '_>, series: &Series) -> Drawn {
    let style = stroke(series.color, series.width);
    if series.filled {
        chart.draw_series([Polygon::new(series.points.clone(), series.color.filled())])?;
        return Ok(());
    }
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

    /// Goal: ticks of a logarithmic axis at 1, 2 and 5 times powers of ten, and more on a short one, with the values themselves as labels; one that must end on
    /// them does. A single value and none at all have an axis. Accuracy: ROUNDOFF.
    #[test]
    fn logarithmic_axes_have_ticks_at_round_values() {
        const ROUNDOFF: f64 = 1e-12;
        let axis = |values: &[f64], whole| Axis::logarithmic(values.iter().map(|v| v.log10()), whole);
        let labels = |axis: &Axis| axis.ticks.iter().map(|tick| tick.text.concat()).collect::<Vec<_>>();
        let across = axis(&[6e4, 1.1e6], false);
        assert_eq!(
            labels(&across),
            ["70000", "100000", "150000", "200000", "300000", "500000", "700000", "1000000"]
        );
        assert!((across.low - 6e4_f64.log10()).abs() < ROUNDOFF);
        let up = axis(&[0.03, 7.0], true);
        assert_eq!(labels(&up), ["0.02", "0.05", "0.1", "0.2", "0.5", "1", "2", "5", "10"]);
        assert!((up.low - 0.02_f64.log10()).abs() < ROUNDOFF && (up.high - 1.0).abs() < ROUNDOFF);
        assert_eq!(labels(&axis(&[0.1, 1e5], true)).len(), 7);
        for few in [&[3.0][..], &[]] {
            let axis = axis(few, true);
            assert!(axis.low < axis.high && axis.ticks.len() >= 2 && !axis.shows_zero);
        }
    }

    /// Goal: a point that is not positive is left out of a logarithmic figure and does not spoil its axes.
    #[test]
    fn logarithmic_figures_leave_out_what_has_no_logarithm() {
        let points = vec![(1e4, 0.1), (1e5, 0.0), (1e6, 10.0)];
        let series = vec![Series::line("time", points, GREY, Dash::Solid)];
        let panel = Panel::new("x", "t (s)", series);
        let figure = stacked_logarithmic(400, 200, &[panel], &[]);
        assert!(figure.contains("1000000") && !figure.contains("NaN") && !figure.contains("inf"));
    }
}
