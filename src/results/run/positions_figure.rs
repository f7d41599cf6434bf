//! Pictures of wheel and rail in their relative position, with the contacts.

use nalgebra::{Point2, Rotation2, Vector2};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use railspring_profiles::units::{KILONEWTON, MILLIMETRE};
use railspring_simulate::time::history::{ContactMode, History, HistoryRow};

use crate::report::legend::{Entry, draw_legend, legend_height};
use crate::report::number::{WIDTH, round};
use crate::report::plot::{
    Area, BLUE, DARK, Dash, Drawn, GREY, LIGHT, Marker, RED, Series, frame, label, mark, px, stroke, svg,
};
use crate::results::bodies::outline_figure::ProfilePair;
use crate::results::bodies::profile_view::{WHEEL_FILL, Window, fine};
use crate::results::run::figures::ModelRun;
use crate::rounding::with_minus_signs;

impl ProfilePair {
    pub(crate) fn rail_to_world(&self, point: &Point2<f64>) -> Point2<f64> {
        self.rail_origin + Rotation2::new(self.rail_angle) * point.coords
    }

    fn wheel_to_world(&self, point: &Point2<f64>, row: &HistoryRow) -> Point2<f64> {
        self.wheel_origin + point.coords + Vector2::new(row.wheel_y, row.wheel_z)
    }
}

/// Height of one picture, px.
const PICTURE: u32 = 282;
/// What is seen below the top of the rail, mm.
const DEPTH_MM: f64 = 46.0;
/// What is seen above the top of the rail, mm.
const ABOVE_MM: f64 = 30.0;

/// One picture for each time: the profiles where the simple model with an element has them, its contacts and those of the solid.
pub fn positions(
    profiles: &ProfilePair,
    times: &[f64],
    element: &ModelRun<'_>,
    solid: Option<&ModelRun<'_>>,
) -> String {
    let (simple, solid) = (element.history, solid.map(|solid| solid.history));
    let name = |text: &str| format!("contact, {text}");
    let mut entries = vec![
        Entry::of(&Series::line("rail", vec![], GREY, Dash::Solid)),
        Entry::of(&Series::line("wheel", vec![], DARK, Dash::Solid)),
        Entry::of(&Series::marks(&name(&format!("{} element", element.name)), vec![], RED, Marker::Disc)),
    ];
    if solid.is_some() {
        entries.push(Entry::of(&Series::marks(&name("solid model"), vec![], BLUE, Marker::Square)));
    }
    if nearest(simple, times.iter().copied().fold(f64::INFINITY, f64::min)).is_some_and(|row| row.time == 0.0)
    {
        entries.push(Entry::of(&Series::marks("first touch", vec![], BLACK, Marker::Circle)));
    }
    let top = legend_height(WIDTH, &entries);
    let columns = times.len().clamp(1, 3);
    let rows = times.len().div_ceil(columns);
    svg(WIDTH, top + PICTURE * rows as u32, |root| {
        let (legend, rest) = root.split_vertically(px(top));
        draw_legend(&legend, WIDTH, &entries)?;
        for (area, time) in rest.split_evenly((rows, columns)).iter().zip(times) {
            if let Some(row) = nearest(simple, *time) {
                picture(area, profiles, (element.name, row), solid.and_then(|solid| nearest(solid, *time)))?;
            }
        }
        Ok(())
    })
}

/// The row nearest to a time.
fn nearest(history: &History, time: f64) -> Option<&HistoryRow> {
    history.rows.iter().min_by(|a, b| (a.time - time).abs().total_cmp(&(b.time - time).abs()))
}

fn picture(
    area: &Area<'_>,
    profiles: &ProfilePair,
    (element, row): (&str, &HistoryRow),
    solid: Option<&HistoryRow>,
) -> Drawn {
    let (width, height) = area.dim_in_pixel();
    let (title, bottom) = (px(40), px(58));
    let rail = fine(profiles.rail.iter().map(|p| profiles.rail_to_world(p)));
    let wheel = fine(profiles.wheel.iter().map(|p| profiles.wheel_to_world(p, row)));
    let visible = |p: &&Point2<f64>| p.y < DEPTH_MM * MILLIMETRE;
    let ends = |points: &[Point2<f64>]| {
        let at = points.iter().filter(visible).map(|p| p.x);
        (at.clone().fold(f64::INFINITY, f64::min), at.fold(f64::NEG_INFINITY, f64::max))
    };
    let (low, high) = ends(&rail);
    // The flange fits beside the head; what of the tread reaches beyond the field side is cut off.
    let (low, high) = (low - 0.044, high + 0.012);
    let scale = (f64::from(width as i32 - px(18)) / (high - low))
        .min(f64::from(height as i32 - title - bottom) / ((DEPTH_MM + ABOVE_MM) * MILLIMETRE));
    let middle = 0.5 * (low + high);
    let to_pixel = |p: &Point2<f64>| {
        (
            (0.5 * f64::from(width) + scale * (p.x - middle)).round() as i32,
            title + (scale * (p.y + ABOVE_MM * MILLIMETRE)).round() as i32,
        )
    };
    let window = Window {
        low: Point2::new(low, -ABOVE_MM * MILLIMETRE),
        high: Point2::new(high, DEPTH_MM * MILLIMETRE),
    };
    for (outline, color) in [(&wheel, WHEEL_FILL), (&rail, LIGHT)] {
        let filled: Vec<(i32, i32)> = window.polygon(outline).iter().map(to_pixel).collect();
        if filled.len() > 2 {
            area.draw(&Polygon::new(filled, color.filled()))?;
        }
    }
    for (outline, color) in [(&rail, GREY), (&wheel, DARK)] {
        for piece in window.pieces(outline) {
            area.draw(&PathElement::new(piece.iter().map(to_pixel).collect::<Vec<_>>(), stroke(color, 13)))?;
        }
    }
    let centre = |y: i32, text: String, size: u32| -> Drawn {
        area.draw(&Text::new(text, (width as i32 / 2, y), label(size, HPos::Center, VPos::Top)))?;
        Ok(())
    };
    centre(px(4), format!("t = {} s", round_time(row.time)), 13)?;
    centre(px(21), format!("wheel {} mm to the field side", signed(row.wheel_y / MILLIMETRE)), 11)?;
    for (contact, mark) in solid
        .iter()
        .flat_map(|row| &row.contacts)
        .map(|contact| (contact, (BLUE, true)))
        .chain(row.contacts.iter().map(|contact| (contact, (RED, false))))
    {
        let (x, y) = to_pixel(&profiles.rail_to_world(&contact.rail));
        let (color, square) = mark;
        let r = px(if square { 5 } else { 3 });
        if square {
            area.draw(&frame([(x - r, y - r), (x + r, y + r)], stroke(color, 16)))?;
        } else {
            area.draw(&Circle::new((x, y), r, color.filled()))?;
        }
    }
    let unloaded = |row: &HistoryRow| row.contacts.is_empty() && row.time == 0.0;
    if unloaded(row) {
        mark(area, Marker::Circle, BLACK, to_pixel(&profiles.touch))?;
    }
    let below = height as i32 - bottom + px(8);
    centre(below, format!("{element}: {}", in_words(row)), 11)?;
    if let Some(solid) = solid {
        centre(below + px(16), format!("solid: {}", in_words(solid)), 11)?;
    }
    let length = (scale * 10.0 * MILLIMETRE) as i32;
    let (x, y) = (px(14), height as i32 - bottom - px(4));
    area.draw(&PathElement::new([(x, y), (x + length, y)], stroke(BLACK, 20)))?;
    let style = label(10, HPos::Center, VPos::Bottom);
    area.draw(&Text::new("10 mm", (x + length / 2, y - px(3)), style))?;
    Ok(())
}

/// The contacts of a row in words.
fn in_words(row: &HistoryRow) -> String {
    if row.contacts.is_empty() {
        return if row.time == 0.0 { "just touching, no load yet".into() } else { "separated".into() };
    }
    let one = |contact: &railspring_simulate::time::history::ContactState| {
        let mode = if contact.mode == ContactMode::Stick { "sticks" } else { "slides" };
        format!("{mode}, {:.1} kN", contact.normal_force / KILONEWTON)
    };
    row.contacts.iter().map(one).collect::<Vec<_>>().join("; ")
}

fn round_time(time: f64) -> String {
    format!("{}", (time * 1e6).round() / 1e6)
}

fn signed(value: f64) -> String {
    let text = round((value * 100.0).round() / 100.0);
    if value > 0.005 { format!("+{text}") } else { with_minus_signs(&text) }
}
