//! The sections of a pair whose bodies are assumed, in the track: what was measured and what was not.

use nalgebra::Point2;
use railspring_profiles::units::MILLIMETRE;

use crate::report::panel::{Panel, stacked};
use crate::report::plot::{DARK, Dash, GREY, Series, nice_range};

/// The two profiles as polylines, and where they stand.
#[derive(Debug, Clone, PartialEq)]
pub struct ProfilePair {
    /// Outline of the rail, profile frame of the rail (y to the field side, z down), m.
    pub rail: Vec<Point2<f64>>,
    /// Angle of the rail's profile frame in the world, rad.
    pub rail_angle: f64,
    /// Origin of the rail's profile frame in the world, m.
    pub rail_origin: Point2<f64>,
    /// Running profile of the wheel with the outer part of its body, profile frame of the wheel, m.
    pub wheel: Vec<Point2<f64>>,
    /// Origin of the wheel's profile frame (the tape point) in the world at t = 0, m.
    pub wheel_origin: Point2<f64>,
    /// Where the lowered wheel first touches the rail, world, m.
    pub touch: Point2<f64>,
}

/// The outline of a body in the world frame: y to the field side, z down, m.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyOutline {
    /// `rail` or `wheel`.
    pub body: &'static str,
    /// The closed outline.
    pub outline: Vec<Point2<f64>>,
    /// The part of it that was measured; empty where nothing was.
    pub measured: Vec<Point2<f64>>,
}

/// Width and height of the drawing area over those of the panel: what the labels leave.
const AREA: [f64; 2] = [0.914, 0.942];

/// The two outlines with equal scales along both axes.
pub(crate) fn figure(width: u32, bodies: &[BodyOutline; 2]) -> String {
    let place = |p: &Point2<f64>| (p.x / MILLIMETRE, -p.y / MILLIMETRE);
    let all: Vec<(f64, f64)> = bodies.iter().flat_map(|body| &body.outline).map(place).collect();
    let range = |of: fn(&(f64, f64)) -> f64| {
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        all.iter().map(of).fold(ends, |(low, high), value| (low.min(value), high.max(value)))
    };
    let ((left, right), (low, high)) = (range(|p| p.0), range(|p| p.1));
    // the vertical axis ends on ticks, the horizontal one where it is told to
    let (low, high, _) = nice_range([low, high].into_iter(), false);
    let (middle, half) = (0.5 * (left + right), 0.5 * (high - low) * AREA[0] / AREA[1]);
    let corners = vec![(middle - half, low), (middle + half, high)];
    let gap = (f64::NAN, f64::NAN);
    let lines = |of: fn(&BodyOutline) -> &Vec<Point2<f64>>| -> Vec<(f64, f64)> {
        bodies.iter().flat_map(|body| of(body).iter().map(place).chain([gap])).collect()
    };
    let series = vec![
        Series::line("", corners, GREY, Dash::None),
        Series::line("assumed", lines(|body| &body.outline), GREY, Dash::Dashed),
        Series::line("measured", lines(|body| &body.measured), DARK, Dash::Solid).broad(),
    ];
    let panel = Panel::new("y from the track centre (mm)", "height \u{2212}z (mm)", series);
    stacked(width, width, &[panel])
}

/// Caption of the figure; `assumed` says what was assumed.
pub(crate) fn caption(assumed: &str) -> String {
    format!(
        "Wheel and rail in the track, where the wheel first touches: what was measured, and what was {assumed}."
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::samples;

    /// Goal: both outlines and the measured part are drawn and named, and a millimetre is as long one way as the other. Accuracy: LABELS, which
    /// take up to 40 of 760 px more or less than the figure reckons with.
    #[test]
    fn scales_are_equal() {
        const LABELS: f64 = 0.05;
        let svg = figure(760, &samples::bodies());
        assert!(svg.contains("assumed") && svg.contains("measured"), "{svg}");
        // the longest line is the wheel's: a square
        let lines =
            svg.split("<polyline").filter_map(|part| part.split("points=\"").nth(1)?.split('"').next());
        let sizes = lines.map(|points| {
            let all: Vec<[f64; 2]> = points
                .split_whitespace()
                .filter_map(|p| p.split_once(','))
                .filter_map(|(x, y)| Some([x.parse().ok()?, y.parse().ok()?]))
                .collect();
            let extent = |i: usize| {
                let values = all.iter().map(|p| p[i]);
                values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
            };
            [extent(0), extent(1)]
        });
        let largest = sizes.filter(|[x, y]| *x > 10.0 && *y > 10.0).max_by(|a, b| a[0].total_cmp(&b[0]));
        let [x, y] = largest.unwrap();
        assert!((x / y - 1.0).abs() < LABELS, "{x} {y}");
    }
}
