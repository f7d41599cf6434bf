//! The wheel's cross-section: a standard profile on a generic straight-web body.

use std::f64::consts::TAU;

use nalgebra::{Point2, Vector2};

use super::FILLET_STEP;
use super::join::join;
use super::properties::boundary_integral;
use crate::error::{InputError, Result};
use crate::profile::wheels::wheel_profile;
use crate::profile::{EndlessLine, ProfileCurve, Segment, fillet, polyline};
use crate::profile_file::Finding;
use crate::units::MILLIMETRE;

/// Cross-section of a wheel in its profile frame: y from the tape circle to the field side, z down; a point
/// lies at the radius `radius` + z from the axle.
#[derive(Debug, Clone, PartialEq)]
pub struct WheelSection {
    /// Name of the running profile.
    pub name: String,
    /// From the flange back over the flange tip, the throat and the tread to the start of the chamfer.
    pub running: ProfileCurve,
    /// The rest of the closed outline as vertices, m: from the end of `running` over the chamfer, the rim's face
    /// and inner side, web, hub, bore, hub, web and rim to the flange back. The ends are those of `running`, bit
    /// for bit; vertices on arcs are at most 2 mm apart, straight parts have their ends only.
    pub body: Vec<Point2<f64>>,
    /// The lines and arcs of which `body` holds the vertices.
    pub body_outline: Vec<Segment>,
    /// Rolling radius at the tape circle, m.
    pub radius: f64,
    /// Radius of the bore, m.
    pub bore_radius: f64,
}

/// The generic body, mm: plausible values of engineering practice, no standard's drawing.
mod generic {
    /// Field face of the rim.
    pub const RIM_FACE: f64 = 65.0;
    /// Depth of the rim below the tread at the tape circle.
    pub const RIM_DEPTH: f64 = 65.0;
    pub const BORE_RADIUS: f64 = 96.0;
    pub const HUB_RADIUS: f64 = 135.0;
    /// Hub from the flange side to the field side.
    pub const HUB_Y: [f64; 2] = [-82.0, 88.0];
    /// Middle plane of the web.
    pub const WEB_Y: f64 = -2.5;
    /// Thickness of the web 10 mm inside the hub's surface and 10 mm inside the rim.
    pub const WEB_THICKNESS: [f64; 2] = [30.0, 24.0];
    pub const WEB_OVERLAP: f64 = 10.0;
    pub const FILLET: f64 = 30.0;
    /// Least length of the web between its fillets.
    pub const LEAST_WEB: f64 = 20.0;
}

/// The standard profile `name` on the generic straight-web body with the given diameter at the tape circle (m):
/// rim 135 mm wide and 65 mm deep, web 30 to 24 mm, hub 270 mm from -82 to 88 mm, bore 192 mm, fillets R30.
///
/// # Errors
/// [`InputError`] for an unknown profile or a diameter outside 0.56 to 1.5 m.
///
/// ```
/// let wheel = railspring_calibrate::section::wheel_section("S1002", 0.858)?;
/// assert_eq!((wheel.radius, wheel.bore_radius), (0.429, 0.096));
/// # Ok::<(), railspring_calibrate::error::Error>(())
/// ```
pub fn wheel_section(name: &str, tape_diameter: f64) -> Result<WheelSection> {
    use generic::*;
    let least = 2.0 * MILLIMETRE * (HUB_RADIUS + RIM_DEPTH + 2.0 * FILLET + LEAST_WEB);
    const GREATEST: f64 = 1.5;
    if !(least..=GREATEST).contains(&tape_diameter) {
        return Err(InputError::new(
            "wheel.tape_diameter_m",
            format!("{tape_diameter} m"),
            format!("{least:.2} to {GREATEST:.2} m"),
            "choose a diameter that leaves room for hub, web and rim; check its unit",
        )
        .into());
    }
    let running = wheel_profile(name)?;
    let radius = 0.5 * tape_diameter;
    let body_outline = generic_body(running.point(running.length()), running.point(0.0), radius / MILLIMETRE);
    let mut body = polyline(&body_outline, FILLET_STEP);
    let last = body.len() - 1;
    body[0] = running.point(running.length());
    body[last] = running.point(0.0);
    let bore_radius = BORE_RADIUS * MILLIMETRE;
    Ok(WheelSection { name: name.to_owned(), running, body, body_outline, radius, bore_radius })
}

/// The section of a measured running profile on the standard wheel `name`: the profile is joined to the standard's
/// with continuous tangents; chamfer, rim, web and hub are the generic body's. The profile's origin is the tape
/// circle, at which the wheel has the nominal diameter where its z is 0. What was done is added to `findings`.
///
/// # Errors
/// As [`wheel_section`], and [`InputError`] with the key `wheel.profile_file` for a profile whose ends do not lie
/// near the standard surface.
pub fn wheel_section_with_profile(
    name: &str,
    tape_diameter: f64,
    profile: &ProfileCurve,
    findings: &mut Vec<Finding>,
) -> Result<WheelSection> {
    let standard = wheel_section(name, tape_diameter)?;
    let running = join(&standard.running, profile, "wheel.profile_file", findings)?;
    let mut section = WheelSection { name: format!("measured profile on {name}"), running, ..standard };
    let last = section.body.len() - 1;
    section.body[0] = section.running.point(section.running.length());
    section.body[last] = section.running.point(0.0);
    Ok(section)
}

/// Outline from `tread_end` to `flange_start` (m) for the rolling radius `r0` in mm.
fn generic_body(tread_end: Point2<f64>, flange_start: Point2<f64>, r0: f64) -> Vec<Segment> {
    use generic::*;
    let (tread_end, flange_start) = (tread_end / MILLIMETRE, flange_start / MILLIMETRE);
    let [hub_back, hub_face] = HUB_Y;
    let (rim, hub, bore) = (-RIM_DEPTH, HUB_RADIUS - r0, BORE_RADIUS - r0);

    // Half the web's thickness grows linearly from the rim to the hub.
    let [z_hub, z_rim] = [hub - WEB_OVERLAP, rim + WEB_OVERLAP];
    let [half_hub, half_rim] = WEB_THICKNESS.map(|t| 0.5 * t);
    let towards_hub = |side: f64| {
        let at_rim = Point2::new(WEB_Y + side * half_rim, z_rim);
        let at_hub = Point2::new(WEB_Y + side * half_hub, z_hub);
        EndlessLine::new(at_rim, at_hub - at_rim)
    };
    let reverse = |line: &EndlessLine| EndlessLine::new(line.point, -line.direction);
    let inwards = Vector2::new(-1.0, 0.0);
    let rim_side = EndlessLine::new(Point2::new(0.0, rim), inwards);
    let hub_side = EndlessLine::new(Point2::new(0.0, hub), -inwards);
    let (field_web, back_web) = (towards_hub(1.0), reverse(&towards_hub(-1.0)));

    let hub_field = fillet(&field_web, &hub_side, FILLET);
    let hub_flange = fillet(&hub_side, &back_web, FILLET);
    let chamfer = RIM_FACE - tread_end.x;
    Outline::from(tread_end)
        .to(Point2::new(RIM_FACE, tread_end.y - chamfer))
        .to(Point2::new(RIM_FACE, rim))
        .round(fillet(&rim_side, &field_web, FILLET))
        .round(hub_field)
        .to(Point2::new(hub_face, hub))
        .to(Point2::new(hub_face, bore))
        .to(Point2::new(hub_back, bore))
        .to(Point2::new(hub_back, hub))
        .round(hub_flange)
        .round(fillet(&back_web, &rim_side, FILLET))
        .to(Point2::new(flange_start.x, rim))
        .to(flange_start)
        .segments
        .iter()
        .map(|s| s.scaled(MILLIMETRE))
        .collect()
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

    /// A straight line to the start of `arc`, and the arc.
    fn round(self, arc: Segment) -> Self {
        let mut outline = self.to(arc.start());
        outline.at = arc.end();
        outline.segments.push(arc);
        outline
    }
}

/// Mass properties of the full wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RevolvedBody {
    /// Mass, kg.
    pub mass: f64,
    /// Lateral position of the centre of mass from the tape circle, m.
    pub centre_y: f64,
    /// Moment of inertia about the axle, kg·m².
    pub axle_inertia: f64,
    /// Moment of inertia about a diameter in the plane of the tape circle, kg·m².
    pub diameter_inertia: f64,
}

/// Mass properties of the section revolved about the axle with the material's `density` (kg/m³), by Pappus and
/// Green's theorem over the exact outline.
pub fn body_of_revolution(section: &WheelSection, density: f64) -> RevolvedBody {
    let r0 = section.radius;
    // Integrals over the section of ρ, ρ y, ρ³ and ρ y²; ρ depends on z alone, so each is a ∮ … dz.
    let [first, lateral, third, squared] =
        boundary_integral(&section.running, &section.body_outline, |p, t| {
            let (y, rho) = (p.x, r0 + p.y);
            [y * rho, y * y / 2.0 * rho, y * rho * rho * rho, y * y * y / 3.0 * rho].map(|v| v * t.y)
        });
    let factor = density * TAU * first.signum();
    RevolvedBody {
        mass: factor * first,
        centre_y: lateral / first,
        axle_inertia: factor * third,
        diameter_inertia: factor * (0.5 * third + squared),
    }
}

/// Mass (kg) of the section revolved about the axle with the material's `density` (kg/m³).
///
/// ```
/// use railspring_calibrate::section::{body_of_revolution_mass, wheel_section};
/// let mass = body_of_revolution_mass(&wheel_section("S1002", 0.860)?, 7850.0);
/// assert!((mass - 311.4).abs() < 0.1);
/// # Ok::<(), railspring_calibrate::error::Error>(())
/// ```
pub fn body_of_revolution_mass(section: &WheelSection, density: f64) -> f64 {
    body_of_revolution(section, density).mass
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Source: the same generic section as a polygon of 0.002 mm chord error, tread diameter 860 mm, 7850 kg/m³:
    /// 311.4 kg, centre of mass at y = -5.02 mm, axle inertia 37.652 kg·m².
    #[test]
    fn mass_properties_of_the_860_wheel() {
        let body = body_of_revolution(&wheel_section("S1002", 0.860).unwrap(), 7850.0);
        // MODEL: the source's rounding.
        assert!((body.mass - 311.4).abs() < 0.05, "{body:?}");
        assert!((body.centre_y + 5.02e-3).abs() < 0.005e-3, "{body:?}");
        assert!((body.axle_inertia - 37.652).abs() < 0.003, "{body:?}");
    }

    #[test]
    fn body_closes_the_outline() {
        for diameter in [0.6, 0.858, 1.25] {
            let wheel = wheel_section("S1002", diameter).unwrap();
            assert_eq!(wheel.body[0], wheel.running.point(wheel.running.length()));
            assert_eq!(wheel.body[wheel.body.len() - 1], wheel.running.point(0.0));
            let inner = wheel.body.iter().map(|p| wheel.radius + p.y).fold(f64::INFINITY, f64::min);
            assert!((inner - wheel.bore_radius).abs() < 1e-15);
            for pair in wheel.body_outline.windows(2) {
                assert!((pair[0].end() - pair[1].start()).norm() < 1e-15, "the outline is open at {pair:?}");
                let turn = pair[0].tangent(1.0).angle(&pair[1].tangent(0.0));
                let lines = pair.iter().all(|s| matches!(s, Segment::Line { .. }));
                assert!(lines || turn < 1e-7, "a fillet is not tangential at {pair:?}");
            }
        }
    }

    #[test]
    fn diameters_without_room_are_refused() {
        for diameter in [0.5, 858.0, f64::NAN, -0.858] {
            let message = wheel_section("S1002", diameter).unwrap_err().to_string();
            assert!(message.contains("wheel.tape_diameter_m"), "{message}");
        }
        assert!(wheel_section("S1003", 0.858).unwrap_err().to_string().contains("wheel.profile"));
    }
}
