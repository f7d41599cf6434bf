//! Sections and profiles beside each other, all to one scale.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::plot::{Area, DARK, DARK_RED, Drawn, LABEL_TEXT, LIGHT, TICK_TEXT, label, px, stroke, svg};

/// What stands in one cell.
#[derive(Debug, Clone)]
pub struct Shape {
    /// Its name.
    pub name: String,
    /// A line below the name.
    pub note: String,
    /// Whether the name is marked: what the reader should look up before it is used.
    pub marked: bool,
    /// Points in mm, y to the right and z down; a closed outline ends where it begins.
    pub points: Vec<(f64, f64)>,
}

/// Pixels per millimetre.
const SCALE: f64 = 1.0;
/// Space around the shapes of a row, px.
const MARGIN: u32 = 14;
/// Height of name and note, px.
const HEAD: u32 = 34;
/// Inside of a closed outline.
const FILL: RGBColor = RGBColor(238, 241, 246);

/// Draws groups of shapes, each group in rows of `columns` cells; the cells of a row are as high as its highest shape.
pub fn catalogue(width: u32, groups: &[(usize, Vec<Shape>)], note: &str) -> String {
    let rows: Vec<(usize, &[Shape])> = groups
        .iter()
        .flat_map(|(columns, shapes)| shapes.chunks((*columns).max(1)).map(|row| ((*columns).max(1), row)))
        .collect();
    let height_of = |row: &[Shape]| {
        let height =
            row.iter().map(|shape| extent(&shape.points, |p| p.1)).map(|[a, b]| b - a).fold(0.0, f64::max);
        HEAD + MARGIN + (SCALE * height).ceil() as u32
    };
    let total: u32 = rows.iter().map(|(_, row)| height_of(row)).sum();
    svg(width, total + 2 * MARGIN, |root| {
        let mut top = 0;
        for (columns, row) in &rows {
            let (_, rest) = root.split_vertically(px(top));
            let (cells, _) = rest.split_vertically(px(height_of(row)));
            for (index, shape) in row.iter().enumerate() {
                let cell = f64::from(width) / *columns as f64;
                let middle = cell * (index as f64 + 0.5);
                draw_shape(&cells, middle, shape)?;
            }
            top += height_of(row);
        }
        let (_, foot) = root.split_vertically(px(top));
        foot.draw(&Text::new(
            note.to_owned(),
            (px(MARGIN), px(MARGIN) / 2),
            label(TICK_TEXT, HPos::Left, VPos::Top),
        ))?;
        Ok(())
    })
}

/// Least and greatest of a coordinate.
fn extent(points: &[(f64, f64)], of: impl Fn(&(f64, f64)) -> f64) -> [f64; 2] {
    points.iter().map(of).fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)])
}

/// A shape below its name; `middle` in px from the left.
fn draw_shape(area: &Area<'_>, middle: f64, shape: &Shape) -> Drawn {
    let ([left, right], [top, _]) = (extent(&shape.points, |p| p.0), extent(&shape.points, |p| p.1));
    if !(left.is_finite() && top.is_finite()) {
        return Ok(());
    }
    let unit = f64::from(px(1));
    let centre = 0.5 * (left + right);
    let place = |y: f64, z: f64| {
        let (x, down) = (middle + SCALE * (y - centre), f64::from(HEAD) + SCALE * (z - top));
        ((unit * x).round() as i32, (unit * down).round() as i32)
    };
    let points: Vec<(i32, i32)> = shape.points.iter().map(|p| place(p.0, p.1)).collect();
    let closed = points.first() == points.last();
    if closed {
        area.draw(&Polygon::new(points.clone(), FILL.filled()))?;
    }
    // the axis of a section, the level of the tape circle of a profile
    let axis = if closed {
        let bottom = extent(&shape.points, |p| p.1)[1];
        [place(0.0, top), place(0.0, bottom)]
    } else {
        [place(left, 0.0), place(right, 0.0)]
    };
    area.draw(&PathElement::new(axis, stroke(LIGHT, 7)))?;
    area.draw(&PathElement::new(points, stroke(DARK, 12)))?;
    let at = |down: u32| ((unit * middle).round() as i32, px(down));
    let name = label(LABEL_TEXT, HPos::Center, VPos::Top);
    let name = if shape.marked { name.color(&DARK_RED) } else { name };
    let title = if shape.marked { format!("{} *", shape.name) } else { shape.name.clone() };
    area.draw(&Text::new(title, at(2), name))?;
    area.draw(&Text::new(shape.note.clone(), at(17), label(TICK_TEXT, HPos::Center, VPos::Top)))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: every shape is named once, marked ones with a star, at one scale: the sheet is as high as its rows.
    #[test]
    fn every_shape_is_drawn_to_one_scale() {
        let shape = |name: &str, height: f64, marked| Shape {
            name: name.into(),
            note: "a note".into(),
            marked,
            points: vec![(-10.0, 0.0), (10.0, 0.0), (10.0, height), (-10.0, 0.0)],
        };
        let groups = [
            (2, vec![shape("first", 100.0, false), shape("second", 50.0, true), shape("third", 30.0, false)]),
            (1, vec![shape("fourth", 20.0, false)]),
        ];
        let figure = catalogue(400, &groups, "what it shows");
        for name in ["first", "second *", "third", "fourth", "what it shows"] {
            assert_eq!(figure.matches(&format!("\n{name}\n")).count(), 1, "{name} in {figure}");
        }
        let height = 3 * (HEAD + MARGIN) + 100 + 30 + 20 + 2 * MARGIN;
        assert!(figure.contains(&format!("width=\"400\" height=\"{height}\"")), "{figure}");
        assert!(catalogue(400, &[(0, vec![])], "").contains("</svg>"));
    }
}
