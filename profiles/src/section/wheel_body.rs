//! Generic bodies of wheels: rim, web and hub under a running profile.
//!
//! The dimensions are plausible values of engineering practice: no standard's drawing is public with numbers.

use nalgebra::{Matrix5, Point2, Vector2, Vector5};
use serde::Serialize;

use crate::error::{InputError, Result};
use crate::field::InputField;
use crate::profile::{EndlessLine, Segment, fillet};
use crate::root::bisection;
use crate::units::MILLIMETRE;

/// Course of the web between hub and rim.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub enum WebShape {
    /// Straight, its thickness falling from the hub to the rim.
    #[default]
    Straight,
    /// S-shaped: it leaves the hub towards the flange, bulges to the field side and meets the rim in its middle.
    S,
    /// Conical: straight from the hub to the rim, but not at the same place across the wheel; its thickness falls as that of the straight one.
    Conical {
        /// Middle of the web at the surface of the hub, m from the tape circle to the field side.
        hub: f64,
        /// The same at the inner side of the rim.
        rim: f64,
    },
}

/// Dimensions of a generic wheel body; the fillets between web, rim and hub are R30.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WheelBody {
    /// Course of the web.
    pub web: WebShape,
    /// Diameter of the bore, m.
    pub bore_diameter: f64,
    /// Diameter of the hub, m.
    pub hub_diameter: f64,
    /// Depth of the rim below the tread at the tape circle, m.
    pub rim_depth: f64,
    /// Thickness of the web where it is thinnest, m, the rest of it in proportion; `None` is 24 mm, of an S web 22 mm.
    pub web_thickness: Option<f64>,
    /// Field face of the rim, m from the tape circle; a profile that goes on further has its own.
    pub field_face: f64,
}

impl Default for WheelBody {
    /// Straight web 24 mm thick, bore 192 mm, hub 270 mm, rim 65 mm deep and 135 mm wide.
    fn default() -> Self {
        Self {
            web: WebShape::Straight,
            bore_diameter: 192.0 * MILLIMETRE,
            hub_diameter: 270.0 * MILLIMETRE,
            rim_depth: 65.0 * MILLIMETRE,
            web_thickness: None,
            field_face: 65.0 * MILLIMETRE,
        }
    }
}

/// Radius of the fillets between web, rim and hub, mm.
const FILLET: f64 = 30.0;
/// Least length of the web between its fillets, mm.
const LEAST_WEB: f64 = 20.0;
/// The web's thickness is given this far inside the hub's surface and inside the rim, mm.
const OVERLAP: f64 = 10.0;
/// Least wall of the hub, mm.
const LEAST_HUB_WALL: f64 = 10.0;
/// Longest piece of the polygon that approximates the side of an S web, mm.
const WEB_STEP: f64 = 2.0;

/// Straight or conical web: middle plane of the straight one, and thickness at hub and rim, mm.
mod straight {
    pub const MIDDLE: f64 = -2.5;
    pub const THICKNESS: [f64; 2] = [30.0, 24.0];
    /// Faces of the hub.
    pub const HUB: [f64; 2] = [-82.0, 88.0];
}

/// S web at five stations from the hub to the rim: fraction of the way, middle line and thickness in mm.
mod s_shaped {
    pub const FRACTION: [f64; 5] = [0.0, 68.0 / 283.0, 148.0 / 283.0, 223.0 / 283.0, 1.0];
    pub const MIDDLE: [f64; 5] = [-12.5, 10.0, 47.5, 22.0, 5.5];
    pub const THICKNESS: [f64; 5] = [30.0, 26.0, 22.0, 23.0, 26.0];
}

impl WheelBody {
    /// Checks the dimensions against each other for a tape diameter in m.
    ///
    /// # Errors
    /// [`InputError`] naming the field that leaves too little room.
    pub(super) fn check(&self, tape_diameter: f64) -> Result<()> {
        let [bore, hub, rim] =
            [self.bore_diameter, self.hub_diameter, self.rim_depth].map(|v| v / MILLIMETRE);
        let out_of = |field: InputField, value: f64, least: f64, greatest: f64, remedy: &str| {
            let expected = format!("{least} to {greatest} mm");
            InputError::refuse(field, format!("{value} mm"), expected, remedy)
        };
        if !(40.0..=400.0).contains(&bore) {
            return out_of(InputField::BoreDiameter, bore, 40.0, 400.0, "check the diameter and its unit");
        }
        let least_hub = bore + 2.0 * LEAST_HUB_WALL;
        if !(least_hub..=800.0).contains(&hub) {
            return out_of(InputField::HubDiameter, hub, least_hub, 800.0, "leave a wall around the bore");
        }
        if !(30.0..=150.0).contains(&rim) {
            return out_of(InputField::RimDepth, rim, 30.0, 150.0, "check the depth and its unit");
        }
        if let Some(web) = self.web_thickness.map(|web| web / MILLIMETRE)
            && !(8.0..=60.0).contains(&web)
        {
            return out_of(InputField::WebThickness, web, 8.0, 60.0, "check the thickness and its unit");
        }
        const GREATEST: f64 = 1.5;
        let least = 2.0 * MILLIMETRE * (0.5 * hub + rim + 2.0 * FILLET + LEAST_WEB);
        if !(least..=GREATEST).contains(&tape_diameter) {
            return InputError::refuse(
                InputField::TapeDiameter,
                format!("{tape_diameter} m"),
                format!("{least:.2} to {GREATEST:.2} m"),
                "choose a diameter that leaves room for hub, web and rim; check its unit",
            );
        }
        Ok(())
    }

    /// Outline from `tread_end` over chamfer, web, hub and bore to `flange_start` (m, wheel profile frame) for the
    /// rolling radius `radius` (m).
    pub(super) fn outline(
        &self,
        tread_end: Point2<f64>,
        flange_start: Point2<f64>,
        radius: f64,
    ) -> Result<Vec<Segment>> {
        let (tread_end, flange_start) = (tread_end / MILLIMETRE, flange_start / MILLIMETRE);
        let r0 = radius / MILLIMETRE;
        let levels = Levels {
            rim: -self.rim_depth / MILLIMETRE,
            hub: 0.5 * self.hub_diameter / MILLIMETRE - r0,
            thicker: self.web_thickness.map_or(1.0, |least| least / self.web.least_thickness()),
        };
        let bore = 0.5 * self.bore_diameter / MILLIMETRE - r0;
        let ([field, back], [hub_back, hub_face]) = match self.web {
            WebShape::Straight => (straight_sides(&levels, [straight::MIDDLE; 2]), straight::HUB),
            WebShape::S => (s_sides(&levels), [-87.0, 88.0]),
            WebShape::Conical { hub, rim } => {
                let middle = [hub, rim].map(|y| y / MILLIMETRE);
                check_cone(&levels, middle)?;
                (straight_sides(&levels, middle), straight::HUB)
            }
        };
        let chamfer = (self.field_face / MILLIMETRE - tread_end.x).max(0.0);
        let rim_face = tread_end.x + chamfer;
        if let WebShape::Conical { hub, rim } = self.web {
            check_room(
                [field[1].end().x, back[0].start().x],
                [hub_back, hub_face],
                InputField::WebHubY,
                hub,
            )?;
            check_room(
                [field[0].start().x, back[1].end().x],
                [flange_start.x, rim_face],
                InputField::WebRimY,
                rim,
            )?;
        }
        let mut outline = Outline::from(tread_end);
        if chamfer > 0.0 {
            outline = outline.to(Point2::new(rim_face, tread_end.y - chamfer));
        }
        let outline = outline
            .to(Point2::new(rim_face, levels.rim))
            .along(&field)
            .to(Point2::new(hub_face, levels.hub))
            .to(Point2::new(hub_face, bore))
            .to(Point2::new(hub_back, bore))
            .to(Point2::new(hub_back, levels.hub))
            .along(&back)
            .to(Point2::new(flange_start.x, levels.rim))
            .to(flange_start)
            .segments
            .iter()
            .map(|s| s.scaled(MILLIMETRE))
            .collect();
        Ok(outline)
    }
}

/// Refuses a conical web that is steeper than such wheels are, or without a straight part between its fillets.
fn check_cone(levels: &Levels, [hub, rim]: [f64; 2]) -> Result<()> {
    /// Greatest inclination against the plane of the wheel, degrees.
    const STEEPEST: f64 = 30.0;
    let wanted = format!("finite, and no more than {STEEPEST} degrees between hub and rim");
    let refuse = |value: String| {
        let remedy = "move `web_hub_y` and `web_rim_y` towards each other";
        InputError::refuse(InputField::WebRimY, value, wanted.clone(), remedy)
    };
    let angle = ((rim - hub) / (levels.rim - levels.hub)).atan();
    if !angle.is_finite() || angle.to_degrees().abs() > STEEPEST {
        return refuse(format!("{rim} mm, {:.1} degrees from {hub} mm at the hub", angle.to_degrees()));
    }
    // A fillet reaches its radius times 1 + sin of the inclination across the web's end.
    let room = levels.rim - levels.hub - 2.0 * FILLET * (1.0 + angle.sin().abs());
    if room < 0.0 {
        return refuse(format!("{rim} mm, with fillets that overlap by {:.1} mm", -room));
    }
    Ok(())
}

/// Refuses a web whose fillets do not end on the hub or on the rim between `low` and `high`.
fn check_room(ends: [f64; 2], [low, high]: [f64; 2], field: InputField, value: f64) -> Result<()> {
    let [least, greatest] = if ends[0] < ends[1] { ends } else { [ends[1], ends[0]] };
    if least >= low && greatest <= high {
        return Ok(());
    }
    InputError::refuse(
        field,
        format!("{} mm", value / MILLIMETRE),
        format!(
            "a web whose fillets end between {low} and {high} mm, not at {least:.1} and {greatest:.1} mm"
        ),
        "move the web to the middle",
    )
}

/// z of the inner side of the rim and of the hub's surface, mm, and how many times the web is as thick as that of its form.
struct Levels {
    rim: f64,
    hub: f64,
    thicker: f64,
}

impl WebShape {
    /// Least thickness of the web of this form, m.
    pub fn least_thickness(self) -> f64 {
        let of = match self {
            Self::Straight | Self::Conical { .. } => &straight::THICKNESS[..],
            Self::S => &s_shaped::THICKNESS[..],
        };
        of.iter().fold(f64::INFINITY, |least, t| least.min(*t)) * MILLIMETRE
    }
}

/// Field side (from rim to hub) and back (from hub to rim) of the straight or conical web with their fillets; `middle` is the place of its middle at the hub's surface
/// and at the rim's inner side, mm.
fn straight_sides(levels: &Levels, [hub_y, rim_y]: [f64; 2]) -> [Vec<Segment>; 2] {
    // Half the web's thickness grows linearly from the rim to the hub.
    let [z_hub, z_rim] = [levels.hub - OVERLAP, levels.rim + OVERLAP];
    let [half_hub, half_rim] = straight::THICKNESS.map(|t| 0.5 * levels.thicker * t);
    let middle = |z: f64| hub_y + (rim_y - hub_y) * (z - levels.hub) / (levels.rim - levels.hub);
    let towards_hub = |side: f64| {
        let at_rim = Point2::new(middle(z_rim) + side * half_rim, z_rim);
        let at_hub = Point2::new(middle(z_hub) + side * half_hub, z_hub);
        EndlessLine::new(at_rim, at_hub - at_rim)
    };
    let reverse = |line: &EndlessLine| EndlessLine::new(line.point, -line.direction);
    let inwards = Vector2::new(-1.0, 0.0);
    let rim = EndlessLine::new(Point2::new(0.0, levels.rim), inwards);
    let hub = EndlessLine::new(Point2::new(0.0, levels.hub), -inwards);
    let (field, back) = (towards_hub(1.0), reverse(&towards_hub(-1.0)));
    [
        vec![fillet(&rim, &field, FILLET), fillet(&field, &hub, FILLET)],
        vec![fillet(&hub, &back, FILLET), fillet(&back, &rim, FILLET)],
    ]
}

/// The same of the S web, whose sides are polygons.
fn s_sides(levels: &Levels) -> [Vec<Segment>; 2] {
    let middle = Clamped::through(&s_shaped::FRACTION, &s_shaped::MIDDLE);
    let thickness = Clamped::through(&s_shaped::FRACTION, &s_shaped::THICKNESS.map(|t| levels.thicker * t));
    let (z_hub, z_rim) = (levels.hub - OVERLAP, levels.rim + OVERLAP);
    let span = z_rim - z_hub;
    // Point of a side at a fraction of the way from hub to rim, and the unit normal out of the web.
    let edge = |side: f64, t: f64| {
        let (y, slope) = middle.at(t);
        let normal = side * Vector2::new(1.0, -slope / span).normalize();
        (Point2::new(y, z_hub + t * span) + 0.5 * thickness.at(t).0 * normal, normal)
    };
    [1.0, -1.0].map(|side| {
        // Where the centre of the fillet, its radius off the web's side, has its radius' distance from the level.
        let touching = |z: f64, [low, high]: [f64; 2]| {
            let above = |t: f64| {
                let (point, normal) = edge(side, t);
                point.y + FILLET * normal.y > z
            };
            let falling = above(low);
            bisection(low, high, |t| above(t) != falling)
        };
        let at_hub = touching(levels.hub + FILLET, [0.0, 0.5]);
        let at_rim = touching(levels.rim - FILLET, [0.5, 1.0]);
        let parts = (span.abs() / WEB_STEP).ceil() as usize;
        let points: Vec<Point2<f64>> =
            (0..=parts).map(|i| edge(side, at_hub + (at_rim - at_hub) * i as f64 / parts as f64).0).collect();
        let corner = |t: f64, level: f64| {
            let (point, normal) = edge(side, t);
            let centre = point + FILLET * normal;
            Segment::arc(centre, Point2::new(centre.x, level), point)
        };
        let mut from_hub = vec![corner(at_hub, levels.hub)];
        from_hub.extend(points.windows(2).map(|p| Segment::line(p[0], p[1])));
        from_hub.push(corner(at_rim, levels.rim).reversed());
        if side > 0.0 { from_hub.iter().rev().map(Segment::reversed).collect() } else { from_hub }
    })
}

/// A cubic spline through five stations that begins and ends level.
struct Clamped {
    x: [f64; 5],
    value: [f64; 5],
    slope: [f64; 5],
}

impl Clamped {
    fn through(x: &[f64; 5], value: &[f64; 5]) -> Self {
        let mut matrix = Matrix5::identity();
        let mut right = Vector5::zeros();
        for i in 1..4 {
            let [before, after] = [x[i] - x[i - 1], x[i + 1] - x[i]];
            // Equal second derivatives on both sides of the station.
            matrix[(i, i - 1)] = 1.0 / before;
            matrix[(i, i)] = 2.0 / before + 2.0 / after;
            matrix[(i, i + 1)] = 1.0 / after;
            right[i] = 3.0 * (value[i] - value[i - 1]) / (before * before)
                + 3.0 * (value[i + 1] - value[i]) / (after * after);
        }
        let slope = matrix.lu().solve(&right).expect("the matrix is diagonally dominant");
        Self { x: *x, value: *value, slope: slope.into() }
    }

    /// Value and slope at `x`.
    fn at(&self, x: f64) -> (f64, f64) {
        let i = self.x[1..4].partition_point(|&station| station <= x);
        let h = self.x[i + 1] - self.x[i];
        let t = (x - self.x[i]) / h;
        let ([a, b], [p, q]) =
            ([self.value[i], self.value[i + 1]], [h * self.slope[i], h * self.slope[i + 1]]);
        let value = a + t * (p + t * (3.0 * (b - a) - 2.0 * p - q + t * (2.0 * (a - b) + p + q)));
        let slope = p + t * (2.0 * (3.0 * (b - a) - 2.0 * p - q) + 3.0 * t * (2.0 * (a - b) + p + q));
        (value, slope / h)
    }
}

/// An outline drawn from point to point.
struct Outline {
    at: Point2<f64>,
    segments: Vec<Segment>,
}

impl Outline {
    fn from(start: Point2<f64>) -> Self {
        Self { at: start, segments: Vec::new() }
    }

    /// A straight line to `end`.
    fn to(mut self, end: Point2<f64>) -> Self {
        self.segments.push(Segment::line(self.at, end));
        self.at = end;
        self
    }

    /// The `segments`, with straight lines to each that does not begin where the one before it ends.
    fn along(mut self, segments: &[Segment]) -> Self {
        // ROUNDOFF: coordinates of up to a metre, in mm.
        const ROUNDOFF: f64 = 1e-9;
        for segment in segments {
            if (segment.start() - self.at).norm() > ROUNDOFF {
                self = self.to(segment.start());
            }
            self.at = segment.end();
            self.segments.push(*segment);
        }
        self
    }
}
