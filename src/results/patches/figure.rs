//! Figures of the contact patches: pressure and zones of stick and slip on the rail head, drawn to scale.

use contour::ContourBuilder;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use crate::report::legend::{Entry, draw_legend, legend_height};
use crate::report::number::{WIDTH, number};
use crate::report::plot::{
    Area, DARK, Drawn, LABEL_TEXT, LIGHT, ORANGE, TICK_TEXT, frame, label, nice_step, px, stroke, svg, tick,
};
use crate::results::bodies::touch::HertzRecord;
use crate::results::patches::record::{PatchRecord, PatchesRecord, PointState};

/// Left of the panels, px.
const LEFT: u32 = 58;
/// Right of the panels, px.
const RIGHT: u32 = 14;
/// Between panels, px.
const GAP: u32 = 14;
/// Height that panels have at most and at least, px.
const TALLEST: f64 = 250.0;
const SHORTEST: f64 = 70.0;
/// Line with the load above a column, px.
const TITLE: u32 = 22;
/// Ticks and label below a row, px.
const BELOW: u32 = 40;
/// The bar of the pressures, px.
const BAR: u32 = 52;
/// Bands of pressure, about.
const BANDS: f64 = 10.0;
/// Colours of the lowest and the highest band; the lightness falls from one to the other.
const PALEST: RGBColor = RGBColor(222, 232, 243);
const DARKEST: RGBColor = RGBColor(10, 26, 58);

/// What the pressure panels share: bands of the same pressure in all.
struct Bands {
    step: f64,
    count: usize,
}

impl Bands {
    fn of(record: &PatchesRecord) -> Self {
        let largest = record.patches.iter().map(PatchRecord::largest).fold(0.0, f64::max);
        let step = nice_step(largest / BANDS);
        Self { step, count: (largest / step).ceil().max(1.0) as usize }
    }

    fn color(&self, band: usize) -> RGBColor {
        let t = if self.count > 1 { band as f64 / (self.count - 1) as f64 } else { 1.0 };
        let mix = |a: u8, b: u8| (f64::from(a) + t * (f64::from(b) - f64::from(a))).round() as u8;
        RGBColor(mix(PALEST.0, DARKEST.0), mix(PALEST.1, DARKEST.1), mix(PALEST.2, DARKEST.2))
    }
}

/// The pressure at the points of a patch, with the other sign where the points are not in question; at points without load, the mean of
/// the loaded points beside them with the other sign. It is thus zero about half-way between the two.
struct PatchField<'a> {
    patch: &'a PatchRecord,
    values: Vec<f64>,
}

impl<'a> PatchField<'a> {
    /// The field whose positive part are the loaded points with a state `of` the given kind.
    fn new(patch: &'a PatchRecord, of: impl Fn(PointState) -> bool) -> Self {
        let (rows, columns) = (patch.across_mm.len(), patch.along_mm.len());
        let pressure = |i: usize, k: usize| patch.pressure_mpa[i][k].max(0.0);
        let beside = |i: usize, k: usize| {
            let near = |n: usize, end: usize| n.saturating_sub(1)..(n + 2).min(end);
            let loaded: Vec<f64> = near(i, rows)
                .flat_map(|a| near(k, columns).map(move |b| (a, b)))
                .map(|(a, b)| pressure(a, b))
                .filter(|v| *v > 0.0)
                .collect();
            if loaded.is_empty() { 1.0 } else { loaded.iter().sum::<f64>() / loaded.len() as f64 }
        };
        let value = |i: usize, k: usize| match pressure(i, k) {
            loaded if loaded > 0.0 && of(patch.state[i][k]) => loaded,
            loaded if loaded > 0.0 => -loaded,
            _ => -beside(i, k),
        };
        let points = (0..columns).flat_map(|k| (0..rows).map(move |i| (i, k)));
        Self { patch, values: points.map(|(i, k)| value(i, k)).collect() }
    }

    /// The pressure, MPa.
    fn pressure(patch: &'a PatchRecord) -> Self {
        Self::new(patch, |_| true)
    }

    /// The same where the points stick.
    fn sticking(patch: &'a PatchRecord) -> Self {
        Self::new(patch, |state| state == PointState::Stick)
    }

    /// Where the field is above a level: outlines and the holes in each, in mm across and along.
    fn above(&self, level: f64) -> Result<Vec<Outline>, Box<dyn std::error::Error>> {
        let (rows, columns) = (self.patch.across_mm.len(), self.patch.along_mm.len());
        if rows == 0 || columns == 0 {
            return Ok(Vec::new());
        }
        let found = ContourBuilder::new(rows, columns, true).contours(&self.values, &[level])?;
        // a value stands in the middle of its cell
        let place = |x: f64, y: f64| {
            (between(&self.patch.across_mm, x - 0.5), between(&self.patch.along_mm, y - 0.5))
        };
        let outlines = found.iter().flat_map(|contour| contour.geometry()).map(|polygon| Outline {
            outer: polygon.exterior().coords().map(|c| place(c.x, c.y)).collect(),
            holes: polygon
                .interiors()
                .iter()
                .map(|hole| hole.coords().map(|c| place(c.x, c.y)).collect())
                .collect(),
        });
        Ok(outlines.collect())
    }
}

/// A closed line with the holes in it, mm across and along.
struct Outline {
    outer: Vec<(f64, f64)>,
    holes: Vec<Vec<(f64, f64)>>,
}

/// The coordinate at a place between lines, which goes on beyond them.
fn between(lines: &[f64], place: f64) -> f64 {
    if lines.len() < 2 {
        return lines.first().map_or(0.0, |line| line + place);
    }
    let first = (place.floor().max(0.0) as usize).min(lines.len() - 2);
    lines[first] + (place - first as f64) * (lines[first + 1] - lines[first])
}

/// Panels of the same size and scale beside each other.
struct Layout {
    /// Width and height of a panel, px.
    panel: (u32, u32),
    /// Pixels for a millimetre in both directions.
    scale: f64,
    /// Coordinates of the lower left corner, mm.
    low: (f64, f64),
}

impl Layout {
    fn of(record: &PatchesRecord) -> Self {
        let range = |lines: fn(&PatchRecord) -> &Vec<f64>| {
            let ends = record.patches.iter().flat_map(|patch| lines(patch).iter().copied());
            let (low, high) =
                ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
            if low <= high { (low - 0.5, high + 0.5) } else { (-1.0, 1.0) }
        };
        let (across, along) = (range(|patch| &patch.across_mm), range(|patch| &patch.along_mm));
        let columns = record.patches.len().max(1) as u32;
        let width = (WIDTH - LEFT - RIGHT - (columns - 1) * GAP) / columns;
        let scale = (f64::from(width) / (across.1 - across.0)).min(TALLEST / (along.1 - along.0));
        let height = (scale * (along.1 - along.0)).clamp(SHORTEST, TALLEST).round() as u32;
        let middle = (0.5 * (across.0 + across.1), 0.5 * (along.0 + along.1));
        let low = (middle.0 - 0.5 * f64::from(width) / scale, middle.1 - 0.5 * f64::from(height) / scale);
        Self { panel: (width, height), scale, low }
    }

    /// Left end of a column, px.
    fn left(&self, column: usize) -> u32 {
        LEFT + column as u32 * (self.panel.0 + GAP)
    }

    /// Pixel of a place in the panel at a corner (px).
    fn pixel(&self, (left, top): (u32, u32), (across, along): (f64, f64)) -> (i32, i32) {
        let fine = f64::from(px(1));
        let x = f64::from(left) + self.scale * (across - self.low.0);
        let y = f64::from(top + self.panel.1) - self.scale * (along - self.low.1);
        ((fine * x).round() as i32, (fine * y).round() as i32)
    }

    /// Ticks of both directions, mm: first value, distance, number.
    fn ticks(&self, axis: usize) -> (f64, impl Iterator<Item = f64>) {
        let (low, length) = match axis {
            0 => (self.low.0, f64::from(self.panel.0) / self.scale),
            _ => (self.low.1, f64::from(self.panel.1) / self.scale),
        };
        let step = nice_step(length / 6.0);
        let (first, last) = ((low / step).ceil() as i64, ((low + length) / step).floor() as i64);
        (step, (first..=last).map(move |n| n as f64 * step))
    }
}

/// Pressure in the upper row, zones of stick and slip in the lower, a column for each load; all to the same scale.
pub fn fields(record: &PatchesRecord, hertz: Option<HertzRecord>) -> String {
    let layout = Layout::of(record);
    let bands = Bands::of(record);
    let zones = [Entry::patch("sticking", DARK), Entry::patch("sliding", ORANGE)];
    let zone_legend = legend_height(WIDTH, &zones);
    let first = BAR + TITLE;
    let second = first + layout.panel.1 + 24 + zone_legend;
    svg(WIDTH, second + layout.panel.1 + BELOW, |root| {
        draw_bar(root, &bands)?;
        let (_, rest) = root.split_vertically(px(second - zone_legend));
        draw_legend(&rest, WIDTH, &zones)?;
        for (column, patch) in record.patches.iter().enumerate() {
            let left = layout.left(column);
            let text = format!(
                "{} kN: at most {} MPa",
                number((patch.force_kn * 10.0).round() / 10.0),
                number(patch.max_pressure_mpa.round())
            );
            let style = label(LABEL_TEXT, HPos::Center, VPos::Top);
            root.draw(&Text::new(text, (px(left + layout.panel.0 / 2), px(BAR + 3)), style))?;
            for (top, labels) in [(first, false), (second, true)] {
                draw_grid(root, &layout, (left, top), (column == 0, labels))?;
            }
            let field = PatchField::pressure(patch);
            for band in 0..bands.count {
                let under = if band == 0 { WHITE } else { bands.color(band - 1) };
                let above = field.above(band as f64 * bands.step)?;
                fill(root, &layout, (left, first), &above, (bands.color(band), under))?;
            }
            let outline = field.above(0.0)?;
            fill(root, &layout, (left, second), &outline, (ORANGE, WHITE))?;
            let sticking = PatchField::sticking(patch).above(0.0)?;
            fill(root, &layout, (left, second), &sticking, (DARK, ORANGE))?;
            for top in [first, second] {
                for line in outline.iter().flat_map(|o| o.holes.iter().chain([&o.outer])) {
                    let pixels: Vec<_> = line.iter().map(|at| layout.pixel((left, top), *at)).collect();
                    root.draw(&PathElement::new(pixels, stroke(BLACK, 10)))?;
                }
                if let Some(hertz) = hertz {
                    draw_ellipse(root, &layout, (left, top), hertz.at(patch.force_kn))?;
                }
                let corner = (px(left + layout.panel.0), px(top + layout.panel.1));
                root.draw(&frame([(px(left), px(top)), corner], stroke(BLACK, 8)))?;
            }
        }
        let style = label(LABEL_TEXT, HPos::Center, VPos::Top);
        let at = (px((LEFT + WIDTH - RIGHT) / 2), px(second + layout.panel.1 + 22));
        let text = "along the rail's profile from the first touch, mm (field side to the right)";
        root.draw(&Text::new(text, at, style))?;
        Ok(())
    })
}

/// Hertz's patch around the first touch: dashes of white over black, which are seen on every colour.
fn draw_ellipse(root: &Area<'_>, layout: &Layout, corner: (u32, u32), hertz: HertzRecord) -> Drawn {
    const POINTS: usize = 90;
    let point = |n: usize| {
        let (sin, cos) = (std::f64::consts::TAU * n as f64 / POINTS as f64).sin_cos();
        layout.pixel(corner, (hertz.semi_axis_across_mm * cos, hertz.semi_axis_along_mm * sin))
    };
    let line: Vec<_> = (0..=POINTS).map(point).collect();
    root.draw(&PathElement::new(line.clone(), stroke(WHITE, 22)))?;
    root.draw(&DashedPathElement::new(line, px(4), px(3), stroke(BLACK, 12)))?;
    Ok(())
}

/// Fills outlines with the first colour, and their holes with the second.
fn fill(
    root: &Area<'_>,
    layout: &Layout,
    corner: (u32, u32),
    outlines: &[Outline],
    (color, hole_color): (RGBColor, RGBColor),
) -> Drawn {
    let polygon = |line: &[(f64, f64)], color: RGBColor| {
        let pixels: Vec<_> = line.iter().map(|at| layout.pixel(corner, *at)).collect();
        Polygon::new(pixels, color.filled())
    };
    for outline in outlines {
        root.draw(&polygon(&outline.outer, color))?;
    }
    for hole in outlines.iter().flat_map(|outline| &outline.holes) {
        root.draw(&polygon(hole, hole_color))?;
    }
    Ok(())
}

/// Grid and ticks of a panel; numbers at its left and below it where they are asked for.
fn draw_grid(
    root: &Area<'_>,
    layout: &Layout,
    (left, top): (u32, u32),
    (at_left, below): (bool, bool),
) -> Drawn {
    let (right, bottom) = (left + layout.panel.0, top + layout.panel.1);
    let (step, ticks) = layout.ticks(0);
    for value in ticks {
        let (x, _) = layout.pixel((left, top), (value, layout.low.1));
        root.draw(&PathElement::new([(x, px(top)), (x, px(bottom))], stroke(LIGHT, 6)))?;
        if below {
            let style = label(TICK_TEXT, HPos::Center, VPos::Top);
            root.draw(&Text::new(tick(value, step), (x, px(bottom + 5)), style))?;
        }
    }
    let (step, ticks) = layout.ticks(1);
    for value in ticks {
        let (_, y) = layout.pixel((left, top), (layout.low.0, value));
        root.draw(&PathElement::new([(px(left), y), (px(right), y)], stroke(LIGHT, 6)))?;
        if at_left {
            let style = label(TICK_TEXT, HPos::Right, VPos::Center);
            root.draw(&Text::new(tick(value, step), (px(left - 5), y), style))?;
        }
    }
    if at_left {
        let upright = label(LABEL_TEXT, HPos::Center, VPos::Top).transform(FontTransform::Rotate270);
        let at = (px(6), px(top) + px(layout.panel.1) / 2);
        root.draw(&Text::new("along the track, mm", at, upright))?;
    }
    Ok(())
}

/// The bar of the pressures above the panels.
fn draw_bar(root: &Area<'_>, bands: &Bands) -> Drawn {
    const NAME: u32 = 110;
    let width = (WIDTH - LEFT - NAME - RIGHT - 20) / bands.count as u32;
    let width = width.min(80);
    let (top, bottom) = (8, 24);
    let style = label(LABEL_TEXT, HPos::Left, VPos::Center);
    root.draw(&Text::new("pressure, MPa", (px(LEFT), px((top + bottom) / 2)), style))?;
    for band in 0..bands.count {
        let left = LEFT + NAME + band as u32 * width;
        let corners = [(px(left), px(top)), (px(left + width), px(bottom))];
        root.draw(&Rectangle::new(corners, bands.color(band).filled()))?;
        root.draw(&frame(corners, stroke(BLACK, 6)))?;
    }
    for n in 0..=bands.count {
        let x = px(LEFT + NAME + n as u32 * width);
        let style = label(TICK_TEXT, HPos::Center, VPos::Top);
        root.draw(&Text::new(tick(n as f64 * bands.step, bands.step), (x, px(bottom + 4)), style))?;
    }
    Ok(())
}

/// What the figure of the fields shows.
pub fn fields_caption(record: &PatchesRecord, hertz: bool) -> String {
    let grid = if record.field == "hybrid" {
        "on the fine grid of the contact"
    } else {
        "at the contact nodes of the rail's mesh, bilinear between them"
    };
    format!(
        "Contact patch on the rail under {}, its surface laid flat and seen from above, all panels to the same scale: pressure {grid}, and \
         where the surfaces stick and slide, friction {}. The outline runs half-way between points that carry load and points that do \
         not.{} The values are in `contact_patches.json`.",
        loads(record),
        number(record.friction),
        if hertz { " Dashed: the patch of Hertz for the curvatures at the first touch." } else { "" }
    )
}

/// Caption of the figure of the stresses below the patch.
pub fn below_caption(record: &PatchesRecord) -> String {
    format!(
        "Largest von Mises and shear stress below the contact patch and their depths, over the load; and both over the depth below the \
         place of the largest von Mises stress, under {}. The depth jumps where the place goes from one part of the patch to another. Elastic half-space of the rail's material under the pressure of the contact, the same in a wheel of that material; without \
         friction, bending, residual and thermal stresses.",
        loads(record)
    )
}

/// The loads in words.
pub(crate) fn loads(record: &PatchesRecord) -> String {
    let loads: Vec<String> =
        record.patches.iter().map(|p| number((p.force_kn * 10.0).round() / 10.0)).collect();
    match loads.split_last() {
        Some((last, first)) if !first.is_empty() => format!("{} and {last} kN", first.join(", ")),
        Some((last, _)) => format!("{last} kN"),
        None => "no load".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::samples;

    /// An ellipse of Hertz with the semi-axes a across and b along, mm, on a grid with unequal lines, largest pressure 1000 MPa; it
    /// sticks within half of both.
    pub fn ellipse(a: f64, b: f64) -> PatchRecord {
        let lines = |semi: f64| -> Vec<f64> {
            let n = 24;
            (0..=n)
                .map(|i| 1.2 * semi * (2.0 * f64::from(i) / f64::from(n) - 1.0))
                .map(|v| v + 0.02 * v * v / semi)
                .collect()
        };
        let (across_mm, along_mm) = (lines(a), lines(b));
        let radius = |s: &f64, x: &f64| (s / a).hypot(x / b);
        let each = |value: &dyn Fn(f64) -> f64| -> Vec<Vec<f64>> {
            across_mm.iter().map(|s| along_mm.iter().map(|x| value(radius(s, x))).collect()).collect()
        };
        let pressure_mpa = each(&|r| 1000.0 * (1.0 - r * r).max(0.0).sqrt());
        let state = across_mm
            .iter()
            .map(|s| {
                let of = |x: &f64| match radius(s, x) {
                    r if r < 0.5 => PointState::Stick,
                    r if r < 1.0 => PointState::Slip,
                    _ => PointState::Open,
                };
                along_mm.iter().map(of).collect()
            })
            .collect();
        let (rail_y_mm, rail_z_mm) = (across_mm.clone(), vec![0.0; across_mm.len()]);
        let force_kn = 50.0;
        PatchRecord {
            force_kn,
            across_mm,
            rail_y_mm,
            rail_z_mm,
            along_mm,
            pressure_mpa,
            state,
            max_pressure_mpa: 1000.0,
            below: None,
        }
    }

    fn area(line: &[(f64, f64)]) -> f64 {
        let pairs = line.iter().zip(line.iter().cycle().skip(1));
        0.5 * pairs.map(|(a, b)| a.0 * b.1 - b.0 * a.1).sum::<f64>().abs()
    }

    /// Source: an ellipse; pressure `p0·√(1 - r²)` is above p on the ellipse smaller by √(1 - (p/p0)²). Goal: area within the outline, within
    /// the line of half the pressure and of the zone that sticks, mm², on a grid with unequal lines in millimetres. Accuracy:
    /// DISCRETISATION, an outline half-way between points of twenty to a diameter is a twentieth of the area off at most; a line of
    /// pressure is interpolated, a hundredth.
    #[test]
    fn outlines_have_the_area_of_the_ellipse() {
        const OUTLINE: f64 = 0.05;
        const INTERPOLATED: f64 = 0.015;
        let patch = ellipse(3.0, 7.0);
        let whole = std::f64::consts::PI * 3.0 * 7.0;
        let field = PatchField::pressure(&patch);
        let sticking = PatchField::sticking(&patch);
        for (outlines, share, limit) in [
            (field.above(0.0).unwrap(), 1.0, OUTLINE),
            (field.above(500.0).unwrap(), 0.75, INTERPOLATED),
            (sticking.above(0.0).unwrap(), 0.25, 2.0 * OUTLINE),
        ] {
            assert_eq!(outlines.len(), 1);
            assert!(outlines[0].holes.is_empty());
            let ratio = area(&outlines[0].outer) / (share * whole);
            assert!((ratio - 1.0).abs() < limit, "{share}: {ratio}");
            let ends = |axis: fn(&(f64, f64)) -> f64| {
                let values = outlines[0].outer.iter().map(axis);
                values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)))
            };
            let (across, along) = (ends(|p| p.0), ends(|p| p.1));
            let diameter = 2.0 * share.sqrt();
            assert!(((across.1 - across.0) / (diameter * 3.0) - 1.0).abs() < 2.0 * OUTLINE, "{across:?}");
            assert!(((along.1 - along.0) / (diameter * 7.0) - 1.0).abs() < 2.0 * OUTLINE, "{along:?}");
        }
    }

    /// Goal: a millimetre has the same number of pixels across and along, in every panel.
    #[test]
    fn panels_are_drawn_to_scale() {
        let patches = vec![ellipse(0.5, 0.7), ellipse(2.0, 5.0), ellipse(3.0, 7.0)];
        let record = PatchesRecord { patches, ..samples::patches() };
        let layout = Layout::of(&record);
        for corner in [(layout.left(0), 30), (layout.left(2), 200)] {
            let [origin, across, along] =
                [(0.0, 0.0), (3.0, 0.0), (0.0, 3.0)].map(|at| layout.pixel(corner, at));
            assert!(
                ((across.0 - origin.0) - (origin.1 - along.1)).abs() <= 1,
                "{origin:?} {across:?} {along:?}"
            );
            let (right, top) = (corner.0 + layout.panel.0, corner.1);
            let far = layout.pixel(corner, (3.0, 7.0));
            assert!(far.0 < px(right) && far.1 > px(top), "the largest patch lies inside its panel");
        }
    }

    #[test]
    fn a_place_between_lines_goes_on_beyond_them() {
        let lines = [1.0, 2.0, 4.0];
        for (place, value) in [(0.0, 1.0), (0.5, 1.5), (1.5, 3.0), (2.0, 4.0), (-0.5, 0.5), (2.5, 5.0)] {
            assert_eq!(between(&lines, place), value, "{place}");
        }
        assert_eq!(between(&[3.0], 0.5), 3.5);
    }
}
