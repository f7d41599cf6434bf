//! Where on a body the displacements differ, as a picture.

use std::collections::BTreeMap;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use crate::report::number::WIDTH;
use crate::report::plot::{
    DARK_RED, GREY, LABEL_TEXT, ORANGE, TICK_TEXT, frame, label, nice_range, nice_step, px, stroke, svg, tick,
};
use crate::results::crosscheck::page::scientific::power_of_ten;
use crate::results::crosscheck::record::SectionDifference;

/// Largest height of the body, px.
const BODY: f64 = 400.0;
/// Height of the strip with the colour bar, px.
const BAR: u32 = 52;
/// Room for the labels of the vertical axis, px.
const LEFT: u32 = 70;
/// Room below the body, px.
const BELOW: u32 = 44;
/// No difference.
const PALE: RGBColor = RGBColor(240, 243, 247);

/// Every element coloured by its difference; a bar with the scale above.
pub fn picture(section: &SectionDifference) -> String {
    let corners = || section.cells.iter().flat_map(|cell| &cell.corners_mm);
    let bounds = |axis: usize| {
        corners().map(|p| p[axis]).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)))
    };
    let ((y0, y1), (z0, z1)) = (bounds(0), bounds(1));
    let zoom = ((f64::from(WIDTH - LEFT) - 40.0) / (y1 - y0)).min(BODY / (z1 - z0));
    let (body_width, body_height) = ((y1 - y0) * zoom, (z1 - z0) * zoom);
    let left = f64::from(LEFT) + 0.5 * (f64::from(WIDTH - LEFT) - body_width);
    let top = f64::from(BAR) + 8.0;
    // the bar counts in the power of ten of the largest value shown
    let largest =
        section.cells.iter().map(|cell| cell.difference_mm).filter(|d| d.is_finite()).fold(0.0, f64::max);
    let power = if largest > 0.0 { largest.log10().floor() as i32 } else { 0 };
    let unit = 10f64.powi(power);
    let (_, high, step) = nice_range([0.0, largest / unit].into_iter(), true);
    svg(WIDTH, (top + body_height) as u32 + BELOW, |area| {
        let fine = |v: f64| (v * f64::from(px(1))).round() as i32;
        let at = |p: &[f64; 2]| (fine(left + (p[0] - y0) * zoom), fine(top + (p[1] - z0) * zoom));
        for cell in &section.cells {
            let shape: Vec<(i32, i32)> = cell.corners_mm.iter().map(at).collect();
            let color = shade(cell.difference_mm / unit / high);
            area.draw(&Polygon::new(shape.clone(), color.filled()))?;
            // without it the white sheet shines through between the elements
            area.draw(&PathElement::new(closed(shape), stroke(color, 5)))?;
        }
        for edge in outline(section) {
            area.draw(&PathElement::new(edge.map(|p| at(&p)), stroke(GREY, 8)))?;
        }
        for (low, end, axis) in [(y0, y1, 0), (z0, z1, 1)] {
            let step = nice_step((end - low) / if axis == 0 { 4.0 } else { 6.0 });
            for n in (low / step).ceil() as i64..=(end / step).floor() as i64 {
                let value = n as f64 * step;
                let (tick_at, text_at, style) = if axis == 0 {
                    let (x, y) = (at(&[value, z1]).0, fine(top + body_height + 4.0));
                    ([(x, y), (x, y + px(4))], (x, y + px(6)), label(TICK_TEXT, HPos::Center, VPos::Top))
                } else {
                    let (x, y) = (fine(left - 4.0), at(&[y0, value]).1);
                    ([(x - px(4), y), (x, y)], (x - px(6), y), label(TICK_TEXT, HPos::Right, VPos::Center))
                };
                area.draw(&PathElement::new(tick_at, stroke(BLACK, 8)))?;
                area.draw(&Text::new(tick(value, step), text_at, style))?;
            }
        }
        let base = fine(top + body_height + 24.0);
        let style = label(LABEL_TEXT, HPos::Center, VPos::Top);
        area.draw(&Text::new("y to the field side, mm", (fine(left + 0.5 * body_width), base), style))?;
        let style = label(LABEL_TEXT, HPos::Center, VPos::Top).transform(FontTransform::Rotate270);
        let side = (fine(left - 62.0), fine(top + 0.5 * body_height));
        let vertical = if section.turned_deg.is_some() { "radius, mm" } else { "z down, mm" };
        area.draw(&Text::new(vertical, side, style))?;

        let (from, to, y) = (px(300), px(660), (px(10), px(24)));
        let x_of = |value: f64| from + (f64::from(to - from) * value / high).round() as i32;
        const SHADES: u32 = 120;
        for n in 0..SHADES {
            // each to the end of the bar, so that no seams shine through
            let begin = x_of(high * f64::from(n) / f64::from(SHADES));
            let color = shade((f64::from(n) + 0.5) / f64::from(SHADES));
            area.draw(&Rectangle::new([(begin, y.0), (to, y.1)], color.filled()))?;
        }
        area.draw(&frame([(from, y.0), (to, y.1)], stroke(BLACK, 7)))?;
        for n in 0..=(high / step).round() as usize {
            let value = n as f64 * step;
            let x = x_of(value);
            area.draw(&PathElement::new([(x, y.1), (x, y.1 + px(4))], stroke(BLACK, 7)))?;
            let style = label(TICK_TEXT, HPos::Center, VPos::Top);
            area.draw(&Text::new(tick(value, step), (x, y.1 + px(6)), style))?;
        }
        let style = label(LABEL_TEXT, HPos::Right, VPos::Center);
        let text = format!("difference of displacement, {} mm", power_of_ten(power));
        area.draw(&Text::new(text, (from - px(12), (y.0 + y.1) / 2), style))?;

        let place = at(&section.largest_on_section_mm);
        area.draw(&Circle::new(place, px(7), stroke(WHITE, 32)))?;
        area.draw(&Circle::new(place, px(7), stroke(BLACK, 14)))?;
        Ok(())
    })
}

/// The ends of an edge, mm.
type Edge = [[f64; 2]; 2];

/// Edges that belong to one element alone: the outline of the body.
fn outline(section: &SectionDifference) -> Vec<Edge> {
    // the coordinates are on a grid, so that those of neighbours are equal
    let key = |p: &[f64; 2]| p.map(|v| (v * 1e3).round() as i64);
    let mut edges: BTreeMap<[[i64; 2]; 2], (usize, Edge)> = BTreeMap::new();
    for cell in &section.cells {
        let next = cell.corners_mm.iter().cycle().skip(1);
        for (a, b) in cell.corners_mm.iter().zip(next) {
            let mut ends = [key(a), key(b)];
            ends.sort_unstable();
            edges.entry(ends).or_insert((0, [*a, *b])).0 += 1;
        }
    }
    edges.into_values().filter(|(count, _)| *count == 1).map(|(_, edge)| edge).collect()
}

/// The first corner again at the end.
fn closed(mut shape: Vec<(i32, i32)>) -> Vec<(i32, i32)> {
    shape.extend(shape.first().copied());
    shape
}

/// Pale for none, over orange to dark red for the largest; the lightness falls all the way. What is
/// no number is black.
fn shade(share: f64) -> RGBColor {
    if share.is_nan() {
        return BLACK;
    }
    let t = 2.0 * share.clamp(0.0, 1.0);
    let (a, b, t) = if t < 1.0 { (PALE, ORANGE, t) } else { (ORANGE, DARK_RED, t - 1.0) };
    let mix = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * t).round() as u8;
    RGBColor(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::crosscheck::record::SectionCell;

    /// Two squares side by side: six edges, without the common one.
    #[test]
    fn the_outline_is_without_inner_edges() {
        let square = |y: f64| SectionCell {
            corners_mm: vec![[y, 0.0], [y + 1.0, 0.0], [y + 1.0, 1.0], [y, 1.0]],
            difference_mm: 0.0,
        };
        let section = SectionDifference {
            body: "rail".into(),
            largest_displacement_mm: 1.0,
            largest_difference_mm: 0.0,
            largest_at_mm: [0.0; 3],
            largest_on_section_mm: [0.0; 2],
            turned_deg: None,
            cells: vec![square(0.0), square(1.0)],
        };
        let edges = outline(&section);
        assert_eq!(edges.len(), 6);
        assert!(edges.iter().all(|[a, b]| !(a[0] == 1.0 && b[0] == 1.0)), "{edges:?}");
    }

    /// In grey (luma of ITU-R BT.601) a larger difference is darker.
    #[test]
    fn larger_differences_are_darker_in_grey() {
        let luma = |c: RGBColor| 0.299 * f64::from(c.0) + 0.587 * f64::from(c.1) + 0.114 * f64::from(c.2);
        let greys: Vec<f64> = (0..=20).map(|n| luma(shade(f64::from(n) / 20.0))).collect();
        assert!(greys.windows(2).all(|pair| pair[1] < pair[0] - 2.0), "{greys:?}");
    }
}
