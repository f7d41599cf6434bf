//! The wheel's cross-section: a running profile on a generic body, and what it weighs.

use std::f64::consts::TAU;

use nalgebra::Point2;

use super::join::{Joined, join};
use super::properties::boundary_integral;
use super::vertices::{FILLET_STEP, close, thinned};
use super::wheel_body::WheelBody;
use crate::error::{InputError, Result};
use crate::field::InputField;
use crate::profile::wheels::wheel_profile;
use crate::profile::{ProfileCurve, Segment, polyline};
use crate::profile_file::Finding;

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
    /// Of a measured surface the arc lengths of `running` (m) at which the standard surface ends, the measured one begins and ends, and the
    /// standard one goes on; between are the transitions.
    pub seams: Option<[f64; 4]>,
}

/// The standard profile `name` with its nominal flange on the generic straight-web body ([`WheelBody::default`])
/// with the given diameter at the tape circle (m).
///
/// # Errors
/// [`crate::error::InputError`] for an unknown profile or a diameter without room for the body.
///
/// ```
/// let wheel = railspring_profiles::section::wheel_section("S1002", 0.858)?;
/// assert_eq!((wheel.radius, wheel.bore_radius), (0.429, 0.096));
/// # Ok::<(), railspring_profiles::error::Error>(())
/// ```
pub fn wheel_section(name: &str, tape_diameter: f64) -> Result<WheelSection> {
    wheel_section_on(wheel_profile(name)?, name, tape_diameter, &WheelBody::default())
}

/// The running surface `running` (wheel profile frame, from the flange back to the start of the chamfer), called
/// `name`, on a body with the given diameter at the tape circle (m).
///
/// # Errors
/// [`crate::error::InputError`] for a diameter, bore, hub or rim that leaves no room for the web.
///
/// ```
/// use railspring_profiles::profile::wheels::wheel_profile;
/// use railspring_profiles::section::{WebShape, WheelBody, wheel_section_on};
/// let body = WheelBody { web: WebShape::S, bore_diameter: 0.185, hub_diameter: 0.265, ..WheelBody::default() };
/// let wheel = wheel_section_on(wheel_profile("S1002")?, "S1002", 0.920, &body)?;
/// assert_eq!(wheel.bore_radius, 0.0925);
/// # Ok::<(), railspring_profiles::error::Error>(())
/// ```
pub fn wheel_section_on(
    running: ProfileCurve,
    name: &str,
    tape_diameter: f64,
    form: &WheelBody,
) -> Result<WheelSection> {
    form.check(tape_diameter)?;
    let radius = 0.5 * tape_diameter;
    let body_outline = form.outline(running.point(running.length()), running.point(0.0), radius)?;
    let mut body = polyline(&body_outline, FILLET_STEP);
    close(&mut body, &running);
    let bore_radius = 0.5 * form.bore_diameter;
    Ok(WheelSection { name: name.to_owned(), running, body, body_outline, radius, bore_radius, seams: None })
}

/// The section of a running surface and the `rest` of its outline, which goes on from the end of `running` over rim, web, hub and bore back to its
/// start, with the given diameter at the tape circle (m). The bore is at the least z.
///
/// The vertices of the body are those of `rest` at least 1 mm apart; the integrals take all of `rest`.
///
/// # Errors
/// [`crate::error::InputError`] for a diameter with which the outline has no bore, or an unlikely one.
pub fn wheel_section_of(
    name: &str,
    running: ProfileCurve,
    rest: Vec<Segment>,
    tape_diameter: f64,
) -> Result<WheelSection> {
    /// Diameters of bores, m.
    const BORE: std::ops::RangeInclusive<f64> = 0.04..=0.4;
    let radius = 0.5 * tape_diameter;
    let bore_radius = radius + rest.iter().map(|s| s.end().y).fold(f64::INFINITY, f64::min);
    if !BORE.contains(&(2.0 * bore_radius)) {
        let value = format!("{tape_diameter} m, which makes the bore {:.3} mm wide", 2e3 * bore_radius);
        let remedy = "give the diameter of the wheel that is drawn";
        return InputError::refuse(InputField::TapeDiameter, value, "a bore of 40 to 400 mm", remedy);
    }
    let mut body = thinned(polyline(&rest, FILLET_STEP));
    close(&mut body, &running);
    Ok(WheelSection {
        name: name.to_owned(),
        running,
        body,
        body_outline: rest,
        radius,
        bore_radius,
        seams: None,
    })
}

/// The section of a measured running profile on a `standard` wheel: the profile is joined to the standard's with
/// continuous tangents; chamfer, rim, web and hub are the standard's. The profile's origin is the tape
/// circle, at which the wheel has the nominal diameter where its z is 0. What was done is added to `findings`.
///
/// # Errors
/// [`crate::error::InputError`] with the field `wheel_profile` for a profile whose ends do not lie
/// near the standard surface.
pub fn wheel_section_with_profile(
    standard: WheelSection,
    profile: &ProfileCurve,
    findings: &mut Vec<Finding>,
) -> Result<WheelSection> {
    let Joined { curve: running, seams } =
        join(&standard.running, profile, InputField::WheelProfile, findings)?;
    let mut body = standard.body;
    close(&mut body, &running);
    let name = format!("measured profile on {}", standard.name);
    Ok(WheelSection { name, running, body, seams: Some(seams), ..standard })
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
///
/// ```
/// use railspring_profiles::section::{body_of_revolution, wheel_section};
/// let mass = body_of_revolution(&wheel_section("S1002", 0.860)?, 7850.0).mass;
/// assert!((mass - 311.4).abs() < 0.1);
/// # Ok::<(), railspring_profiles::error::Error>(())
/// ```
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::section::WebShape;

    /// Source: generic sections with a tread of 920 mm as polygons: bore 185 mm, hub 265 mm, straight web (hub from
    /// -82 to 93 mm, here to 88 mm) 342.3 kg; S web 343.6 kg, centre of mass at y = 2.12 mm, 47.506 kg·m².
    /// MODEL: the source's web begins 0.5 mm nearer to the axle than ours, its thickness runs straight between the
    /// stations where ours bends (0.6 kg), and its fillets are made by widening and narrowing a polygon.
    #[test]
    fn mass_properties_of_the_920_wheels() {
        let body = |web| {
            let form = WheelBody { web, bore_diameter: 0.185, hub_diameter: 0.265, ..WheelBody::default() };
            let running = wheel_profile("S1002").unwrap();
            body_of_revolution(&wheel_section_on(running, "S1002", 0.920, &form).unwrap(), 7850.0)
        };
        let s_web = body(WebShape::S);
        assert!((s_web.mass / 343.6 - 1.0).abs() < 3e-3, "{s_web:?}");
        assert!((s_web.centre_y - 2.12e-3).abs() < 0.2e-3, "{s_web:?}");
        assert!((s_web.axle_inertia / 47.506 - 1.0).abs() < 3e-3, "{s_web:?}");
        // The shorter hub lacks a ring of 5 mm.
        let ring = 7850.0 * std::f64::consts::PI * (0.1325f64.powi(2) - 0.0925f64.powi(2)) * 0.005;
        assert!(((body(WebShape::Straight).mass + ring) / 342.3 - 1.0).abs() < 1e-3);
    }

    /// Source: Pappus. A conical web is the straight one sheared across the wheel, so that at every radius it is as thick, and between its fillets it has the same mass; its
    /// centre of mass moves by the mean of the shift over the mass. Goal: mass and centre of a wheel whose web leads from -20 mm at the hub to 20 mm at the rim, against the straight one
    /// plus the sheared trapezium from rim to hub. MODEL: the fillets lean with the web: each is the region between two tangents and their circle, whose area
    /// R² (tan(θ/2) - θ/2) is known for the angle θ that it turns by, with its centroid 0.223 R from the corner.
    #[test]
    fn a_conical_web_has_the_mass_of_its_cones() {
        const DENSITY: f64 = 7850.0;
        let body = |web| {
            let running = wheel_profile("S1002").unwrap();
            let form = WheelBody { web, ..WheelBody::default() };
            body_of_revolution(&wheel_section_on(running, "S1002", 0.92, &form).unwrap(), DENSITY)
        };
        let straight = body(WebShape::Straight);
        // The same key values as the straight web's give the straight web.
        let level = body(WebShape::Conical { hub: -2.5e-3, rim: -2.5e-3 });
        assert!(
            (level.mass - straight.mass).abs() < 1e-9 && (level.centre_y - straight.centre_y).abs() < 1e-12
        );
        let [hub_y, rim_y] = [-20e-3, 20e-3];
        let cone = body(WebShape::Conical { hub: hub_y, rim: rim_y });
        // Radii of hub and rim, m, and half the web's thickness there.
        let [hub, rim] = [0.135, 0.395];
        let [at_hub, at_rim] = [hub - 10e-3, rim + 10e-3];
        let half = |r: f64| 15e-3 + (12e-3 - 15e-3) * (r - at_hub) / (at_rim - at_hub);
        let slope = -3e-3 / (at_rim - at_hub);
        let lean = (rim_y - hub_y) / (rim - hub);
        // Mass of a fillet of 30 mm whose web side has the slope dy/dr, out of the web at the hub.
        let fillet = |corner: f64, turn: f64| {
            let area = 0.03f64.powi(2) * ((0.5 * turn).tan() - 0.5 * turn);
            DENSITY * TAU * corner * area
        };
        let all = |lean: f64| -> f64 {
            let quarter = std::f64::consts::FRAC_PI_2;
            let sides = [slope + lean, slope - lean];
            // At the hub a side that leans away from the web's middle turns the fillet less; at the rim it is the other way round.
            let hubs = sides.map(|side| fillet(hub + 6.7e-3, quarter + side.atan()));
            let rims = sides.map(|side| fillet(rim - 6.7e-3, quarter - side.atan()));
            hubs.iter().chain(&rims).sum()
        };
        let expected = straight.mass + all(lean) - all(0.0);
        // MODEL: the centroids of leaning fillets lie up to 3 mm elsewhere, 2 % of the radius at the hub, on 0.6 kg by which all fillets differ.
        const MODEL: f64 = 0.02;
        assert!((cone.mass - expected).abs() < MODEL, "{} and {expected}", cone.mass);
        // The trapezium moves across: the integral of density 2 pi r 2 half(r) times the shift of its middle.
        let steps = 10_000;
        let h = (rim - hub) / f64::from(steps);
        let moment: f64 = (0..steps)
            .map(|i| hub + (f64::from(i) + 0.5) * h)
            .map(|r| DENSITY * TAU * r * 2.0 * half(r) * (hub_y + lean * (r - hub) + 2.5e-3) * h)
            .sum();
        // MODEL: the fillets, of 2 kg at the hub and 6 at the rim, move with their ends of the web.
        let fillets = fillet(hub, 1.57) * 2.0 * (hub_y + 2.5e-3) + fillet(rim, 1.57) * 2.0 * (rim_y + 2.5e-3);
        let centre = (straight.mass * straight.centre_y + moment + fillets) / expected;
        assert!((cone.centre_y - centre).abs() < 0.3e-3, "{} and {centre}", cone.centre_y);
    }

    #[test]
    fn conical_webs_without_room_are_refused() {
        let message = |hub: f64, rim: f64| {
            let form = WheelBody { web: WebShape::Conical { hub, rim }, ..WheelBody::default() };
            let running = wheel_profile("S1002").unwrap();
            wheel_section_on(running, "S1002", 0.92, &form).unwrap_err().to_string()
        };
        assert!(message(-80e-3, 80e-3).contains("web_rim_y") && message(-80e-3, 80e-3).contains("degrees"));
        assert!(message(-60e-3, 30e-3).contains("web_hub_y"), "{}", message(-60e-3, 30e-3));
        assert!(message(0.0, 50e-3).contains("web_rim_y"), "{}", message(0.0, 50e-3));
        assert!(message(f64::NAN, 0.0).contains("web_rim_y"));
    }

    #[test]
    fn bodies_without_room_are_refused() {
        let key = |form: WheelBody| {
            let running = wheel_profile("S1002").unwrap();
            wheel_section_on(running, "S1002", 0.858, &form).unwrap_err().to_string()
        };
        let form = WheelBody::default();
        assert!(key(WheelBody { bore_diameter: 0.265, ..form }).contains("hub_diameter"));
        assert!(key(WheelBody { bore_diameter: 0.01, ..form }).contains("bore_diameter"));
        assert!(key(WheelBody { rim_depth: 0.02, ..form }).contains("rim_depth"));
        assert!(key(WheelBody { rim_depth: f64::NAN, ..form }).contains("rim_depth"));
        assert!(key(WheelBody { hub_diameter: 0.6, ..form }).contains("tape_diameter"));
    }

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
            assert!(message.contains("tape_diameter"), "{message}");
        }
        assert!(wheel_section("S1003", 0.858).unwrap_err().to_string().contains("wheel_name"));
    }
}
