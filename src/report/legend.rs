//! Legends: a strip above the plot, so that nothing covers the data.

use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::plot::{
    Area, Dash, Drawn, LABEL_TEXT, LETTER_WIDTH, Marker, Series, frame, label, mark, px, stroke,
};

/// Entry of a legend.
#[derive(Debug, Clone)]
pub struct Entry {
    pub(super) name: String,
    color: RGBColor,
    dash: Dash,
    marker: Marker,
    filled: bool,
    width: u32,
}

impl Entry {
    /// An entry with a filled patch.
    pub fn patch(name: &str, color: RGBColor) -> Self {
        Self { name: name.into(), color, dash: Dash::None, marker: Marker::None, filled: true, width: 0 }
    }

    /// An entry with a line or a marker.
    pub fn of(series: &Series) -> Self {
        Self {
            name: series.name.clone(),
            color: series.color,
            dash: series.sample.unwrap_or(series.dash),
            marker: series.marker,
            filled: series.filled,
            width: series.width + 2,
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
        let line = stroke(entry.color, entry.width);
        if entry.filled {
            let corners = [(left, y - px(5)), (right, y + px(5))];
            area.draw(&Rectangle::new(corners, entry.color.filled()))?;
            area.draw(&frame(corners, stroke(BLACK, 6)))?;
        }
        match entry.dash {
            Dash::None => {}
            Dash::Solid => area.draw(&PathElement::new([(left, y), (right, y)], line))?,
            Dash::Dashed => {
                area.draw(&DashedPathElement::new([(left, y), (right, y)], px(7), px(4), line))?
            }
            Dash::Dotted => {
                area.draw(&DashedPathElement::new([(left, y), (right, y)], px(2), px(3), line))?
            }
        }
        mark(area, entry.marker, entry.color, ((left + right) / 2, y))?;
        let style = label(LABEL_TEXT, HPos::Left, VPos::Center);
        area.draw(&Text::new(entry.name.clone(), (right + px(6), y), style))?;
    }
    Ok(())
}
