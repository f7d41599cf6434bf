//! Where the contact patches lie on the two profiles, seen along the track.

use nalgebra::{Point2, Vector2};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use railspring_profiles::units::MILLIMETRE;

use crate::report::legend::{Entry, draw_legend, legend_height};
use crate::report::number::{WIDTH, number};
use crate::report::plot::{
    Area, BLUE, DARK, Dash, Drawn, GREY, LIGHT, ORANGE, Series, label, nice_step, px, stroke, svg, tick,
};
use crate::results::bodies::outline_figure::ProfilePair;
use crate::results::bodies::profile_view::{WHEEL_FILL, Window, fine};
use crate::results::bodies::touch::HertzRecord;
use crate::results::patches::figure::loads;
use crate::results::patches::record::{PatchRecord, PatchesRecord};

/// Height of the pictures, px.
const PICTURE: u32 = 300;
/// Height of the largest pressure over the profile, px.
const PEAK: f64 = 90.0;
/// What is seen below and above the top of the rail in the left picture, mm.
const SEEN: (f64, f64) = (42.0, 26.0);
/// Distance of the marks of the loads below the surface in the left picture, px.
const MARK: f64 = 5.0;

/// Colour and line of a load; the largest is the darkest.
fn look(index: usize, count: usize) -> (RGBColor, Dash) {
    match count - 1 - index {
        0 => (DARK, Dash::Solid),
        1 => (BLUE, Dash::Dashed),
        _ => (ORANGE, Dash::Dotted),
    }
}

/// A line of points along the track: its place on the rail (world, m), and the largest pressure, MPa.
type Line = (Point2<f64>, f64);

/// The patch seen along the track, piece by piece.
fn pieces(profiles: &ProfilePair, patch: &PatchRecord) -> Vec<Vec<Line>> {
    let lines: Vec<Line> = patch
        .rail_y_mm
        .iter()
        .zip(&patch.rail_z_mm)
        .zip(&patch.pressure_mpa)
        .map(|((y, z), pressures)| {
            let place = profiles.rail_to_world(&(Point2::new(*y, *z) * MILLIMETRE));
            (place, pressures.iter().copied().fold(0.0, f64::max))
        })
        .collect();
    // lines of a patch with the unloaded line at either side
    let mut found: Vec<Vec<Line>> = Vec::new();
    for i in 0..lines.len() {
        let loaded = |n: usize| lines.get(n).is_some_and(|line| line.1 > 0.0);
        if !loaded(i) {
            continue;
        }
        if i == 0 || !loaded(i - 1) {
            found.push(lines[i.saturating_sub(1)..i].to_vec());
        }
        if let Some(piece) = found.last_mut() {
            piece.push(lines[i]);
            if !loaded(i + 1) {
                piece.extend(lines.get(i + 1));
            }
        }
    }
    found
}

/// A picture: which part of the world it shows, and how large.
struct View {
    corner: (u32, u32),
    size: (u32, u32),
    /// Pixels for a metre.
    scale: f64,
    window: Window,
}

impl View {
    /// Around the `middle` (world, m), with `scale` in pixels for a metre.
    fn around(corner: (u32, u32), size: (u32, u32), middle: Point2<f64>, scale: f64) -> Self {
        let half = Vector2::new(f64::from(size.0), f64::from(size.1)) * (0.5 / scale);
        Self { corner, size, scale, window: Window { low: middle - half, high: middle + half } }
    }

    fn pixel(&self, point: &Point2<f64>) -> (i32, i32) {
        let fine = f64::from(px(1));
        let at = (point - self.window.low) * self.scale;
        let pixel = |corner: u32, v: f64| (fine * (f64::from(corner) + v)).round() as i32;
        (pixel(self.corner.0, at.x), pixel(self.corner.1, at.y))
    }

    /// The two bodies.
    fn bodies(&self, root: &Area<'_>, rail: &[Point2<f64>], wheel: &[Point2<f64>]) -> Drawn {
        for (outline, color) in [(wheel, WHEEL_FILL), (rail, LIGHT)] {
            let filled: Vec<_> = self.window.polygon(outline).iter().map(|p| self.pixel(p)).collect();
            if filled.len() > 2 {
                root.draw(&Polygon::new(filled, color.filled()))?;
            }
        }
        for (outline, color) in [(rail, GREY), (wheel, DARK)] {
            for piece in self.window.pieces(outline) {
                let line: Vec<_> = piece.iter().map(|p| self.pixel(p)).collect();
                root.draw(&PathElement::new(line, stroke(color, 13)))?;
            }
        }
        Ok(())
    }

    /// A bar with a round length at the lower left.
    fn bar(&self, root: &Area<'_>) -> Drawn {
        let length = nice_step(f64::from(self.size.0) / self.scale / MILLIMETRE / 10.0);
        let (x, y) = (px(self.corner.0 + 8), px(self.corner.1 + self.size.1 - 8));
        let end = x + (f64::from(px(1)) * self.scale * length * MILLIMETRE) as i32;
        root.draw(&PathElement::new([(x, y), (end, y)], stroke(BLACK, 20)))?;
        let text = format!("{} mm", tick(length, length));
        root.draw(&Text::new(text, ((x + end) / 2, y - px(3)), label(11, HPos::Center, VPos::Bottom)))?;
        Ok(())
    }
}

/// Unit normal out of the rail at a point of a line that runs to the field side.
fn outward(line: &[Line], index: usize) -> Vector2<f64> {
    let (a, b) = (line[index.saturating_sub(1)].0, line[(index + 1).min(line.len() - 1)].0);
    let along = (b - a).try_normalize(0.0).unwrap_or_else(Vector2::x);
    Vector2::new(along.y, -along.x)
}

/// Left: rail head and wheel with the marks of the patches below the running surface. Right: enlarged, with the largest pressure of every
/// line along the track over the profile.
pub fn section(record: &PatchesRecord, profiles: &ProfilePair, hertz: Option<HertzRecord>) -> String {
    let count = record.patches.len();
    let name = |patch: &PatchRecord| format!("{} kN", number((patch.force_kn * 10.0).round() / 10.0));
    let mut entries = vec![
        Entry::of(&Series::line("rail", vec![], GREY, Dash::Solid)),
        Entry::of(&Series::line("wheel", vec![], DARK, Dash::Solid)),
    ];
    for (index, patch) in record.patches.iter().enumerate() {
        let (color, dash) = look(index, count);
        entries.push(Entry::of(&Series::line(&name(patch), vec![], color, dash).broad()));
    }
    let hertz =
        hertz.zip(record.patches.last()).map(|(hertz, patch)| (hertz.at(patch.force_kn), patch.force_kn));
    if let Some((_, force)) = hertz {
        let name = format!("Hertz, {} kN", number((force * 10.0).round() / 10.0));
        entries.push(Entry::of(&Series::line(&name, vec![], GREY, Dash::Dotted)));
    }
    let top = legend_height(WIDTH, &entries);
    let rail = fine(profiles.rail.iter().map(|p| profiles.rail_to_world(p)));
    let wheel = fine(profiles.wheel.iter().map(|p| profiles.wheel_origin + p.coords));
    let patches: Vec<_> = record.patches.iter().map(|patch| pieces(profiles, patch)).collect();
    let of_hertz = hertz.map_or(0.0, |(hertz, _)| hertz.max_pressure_mpa);
    let largest = record.patches.iter().map(PatchRecord::largest).fold(of_hertz, f64::max);
    svg(WIDTH, top + PICTURE + 8, |root| {
        draw_legend(root, WIDTH, &entries)?;
        let (whole, near) = (head_view(&rail, top), patch_view(&patches, profiles.touch, top));
        whole.bodies(root, &rail, &wheel)?;
        near.bodies(root, &rail, &wheel)?;
        for (index, piece) in patches.iter().enumerate().flat_map(|(n, p)| p.iter().map(move |p| (n, p))) {
            let (color, dash) = look(index, count);
            let depth = MARK * (index + 1) as f64 / whole.scale;
            let marked = (0..piece.len()).map(|i| whole.pixel(&(piece[i].0 - outward(piece, i) * depth)));
            root.draw(&PathElement::new(marked.collect::<Vec<_>>(), stroke(color, 30)))?;
            let height = if largest > 0.0 { PEAK / near.scale / largest } else { 0.0 };
            let line: Vec<_> = (0..piece.len())
                .map(|i| near.pixel(&(piece[i].0 + outward(piece, i) * (height * piece[i].1))))
                .collect();
            let style = stroke(color, 18);
            match dash {
                Dash::Dashed => root.draw(&DashedPathElement::new(line, px(7), px(4), style))?,
                Dash::Dotted => root.draw(&DashedPathElement::new(line, px(2), px(3), style))?,
                _ => root.draw(&PathElement::new(line, style))?,
            }
        }
        if let Some((hertz, _)) = hertz {
            let line: Vec<_> = over_touch(&rail, profiles.touch, hertz)
                .into_iter()
                .map(|(at, normal, pressure)| {
                    near.pixel(&(at + normal * (PEAK / near.scale * pressure / largest)))
                })
                .collect();
            root.draw(&DashedPathElement::new(line, px(2), px(3), stroke(GREY, 18)))?;
        }
        whole.bar(root)?;
        near.bar(root)?;
        pressure_bar(root, &near, largest)
    })
}

/// Hertz's largest pressure of every line along the track over the rail's profile: places, normals out of the rail, and pressures, MPa.
fn over_touch(
    rail: &[Point2<f64>],
    touch: Point2<f64>,
    hertz: HertzRecord,
) -> Vec<(Point2<f64>, Vector2<f64>, f64)> {
    let half = hertz.semi_axis_across_mm * MILLIMETRE;
    let near = rail.windows(2).min_by(|a, b| {
        let away = |w: &[Point2<f64>]| (nalgebra::center(&w[0], &w[1]) - touch).norm();
        away(a).total_cmp(&away(b))
    });
    let Some(along) = near.and_then(|w| (w[1] - w[0]).try_normalize(0.0)) else { return Vec::new() };
    // to the field side, as the lines of a patch
    let along = if along.x < 0.0 { -along } else { along };
    let normal = Vector2::new(along.y, -along.x);
    const POINTS: i32 = 40;
    let point = |n: i32| {
        let share = f64::from(n) / f64::from(POINTS);
        // in the tangent plane, as Hertz has it
        (
            touch + along * (half * share),
            normal,
            hertz.max_pressure_mpa * (1.0 - share * share).max(0.0).sqrt(),
        )
    };
    (-POINTS..=POINTS).map(point).collect()
}

/// The rail head with the flange beside it.
fn head_view(rail: &[Point2<f64>], top: u32) -> View {
    let size = (400, PICTURE);
    let seen = rail.iter().filter(|p| p.y < SEEN.0 * MILLIMETRE).map(|p| p.x);
    let (low, high) = seen.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    // the flange beside the head
    let (low, high) = (low - 0.044, high + 0.012);
    let tall = (SEEN.0 + SEEN.1) * MILLIMETRE;
    let scale = (f64::from(size.0) / (high - low)).min(f64::from(size.1) / tall);
    let middle = Point2::new(0.5 * (low + high), 0.5 * (SEEN.0 - SEEN.1) * MILLIMETRE);
    View::around((6, top), size, middle, scale)
}

/// The patches with room for the pressures over them.
fn patch_view(patches: &[Vec<Vec<Line>>], touch: Point2<f64>, top: u32) -> View {
    let size = (430, PICTURE);
    let places = || patches.iter().flatten().flatten().map(|(place, _)| *place).chain([touch]);
    let low = places().fold(touch, |a, b| Point2::new(a.x.min(b.x), a.y.min(b.y)));
    let high = places().fold(touch, |a, b| Point2::new(a.x.max(b.x), a.y.max(b.y)));
    let extent = (high - low).add_scalar(2.0 * MILLIMETRE);
    let room = 2.0 * PEAK;
    let scale = ((f64::from(size.0) - room * extent.y / extent.norm()) / extent.x)
        .min((f64::from(size.1) - room) / extent.y)
        .max(1.0);
    // the pressures stand on one side
    let normal =
        patches.iter().flatten().max_by_key(|piece| piece.len()).map(|piece| outward(piece, piece.len() / 2));
    let middle = nalgebra::center(&low, &high) + normal.unwrap_or_else(Vector2::zeros) * (0.7 * PEAK / scale);
    View::around((WIDTH - 6 - size.0, top), size, middle, scale)
}

/// How high a round pressure stands over the profile.
fn pressure_bar(root: &Area<'_>, view: &View, largest: f64) -> Drawn {
    if largest <= 0.0 {
        return Ok(());
    }
    let pressure = nice_step(largest / 4.0);
    let height = (f64::from(px(1)) * PEAK * pressure / largest) as i32;
    let (x, y) = (px(view.corner.0 + view.size.0 - 80), px(view.corner.1 + view.size.1 - 12));
    root.draw(&PathElement::new([(x, y), (x, y - height)], stroke(BLACK, 20)))?;
    let style = label(11, HPos::Left, VPos::Center);
    root.draw(&Text::new(format!("{} MPa", number(pressure)), (x + px(6), y - height / 2), style))?;
    Ok(())
}

/// What the figure shows.
pub fn caption(record: &PatchesRecord, hertz: bool) -> String {
    format!(
        "Where the contact patch lies under {}, seen along the track, field side to the right, wheel and rail in the place of the first \
         touch. Left: the extent of the patch, marked below the running surface, the smallest load nearest to it. Right: enlarged to \
         scale, with the largest pressure of every line along the track drawn across the profile{}.",
        loads(record),
        if hertz {
            "; that of Hertz for the curvatures at the first touch and the largest load stands in the tangent plane there"
        } else {
            ""
        }
    )
}
