//! Strips on the rail and the wheel's running surface, as tables.

use clap::ValueEnum;
use nalgebra::{Point2, Vector2};
use railspring_calibrate::pair::Pair;
use railspring_element::law::StripStiffness;
use railspring_element::modulus::StripLaw;
use railspring_profiles::profile::ProfileCurve;
use railspring_simulate::element::condensed::parts::Flatness;
use serde_json::{Value, json};

/// Width of a strip and distance of the points on the wheel, m: with a quarter of both the forces of load case 4.1 change by 0.02 % of their peaks.
const STRIP: f64 = 0.2e-3;
const ON_WHEEL: f64 = 0.2e-3;

/// What lies between the profiles of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum LumpedContact {
    /// The strips of the lumped element
    #[default]
    Strips,
    /// Single rigid points, for what a program without strips comes to
    Points,
}

/// Both running surfaces.
pub(in crate::export) struct LumpedSurfaces {
    strips: Vec<Strip>,
    width: f64,
    wheel: Vec<Placed>,
    spacing: f64,
}

/// A place on a running surface and the angle of the surface there, rad, from y to z.
#[derive(Clone, Copy)]
struct Placed {
    point: Vector2<f64>,
    angle: f64,
}

struct Strip {
    at: Placed,
    normal: f64,
    tangential: f64,
    /// Force of a point there over the power 3/2 of its depth, N/m^1.5.
    point: f64,
}

impl LumpedSurfaces {
    /// The strips of a pair about the line of the rail's shear centres, and its wheel about the origin of its profile.
    pub fn of(pair: &Pair, stiffness: &StripStiffness) -> Self {
        let (rail, wheel) = (&pair.placed.curve, &pair.wheel.running);
        let flatness = Flatness::of(pair);
        let count = (rail.length() / STRIP).ceil();
        let width = rail.length() / count;
        let strip = |i: usize| {
            let s = (i as f64 + 0.5) * width;
            let modulus = stiffness.modulus(s);
            Strip {
                at: placed(rail, s, pair.node_line()),
                normal: modulus.normal,
                tangential: modulus.tangential,
                point: flatness.point_stiffness(s, modulus.normal),
            }
        };
        let points = (wheel.length() / ON_WHEEL).ceil();
        let spacing = wheel.length() / points;
        // y ascends along the table
        let ascends = wheel.point(0.0).x < wheel.point(wheel.length()).x;
        let on_wheel = |i: usize| {
            let s = spacing * i as f64;
            placed(wheel, if ascends { s } else { wheel.length() - s }, Point2::origin())
        };
        Self {
            strips: (0..count as usize).map(strip).collect(),
            width,
            wheel: (0..=points as usize).map(on_wheel).collect(),
            spacing,
        }
    }

    /// The tables for a contact: lengths in m, angles in rad, stiffness in Pa, that of points in N/m^1.5.
    pub fn json(&self, contact: LumpedContact) -> String {
        let column = |values: &mut dyn Iterator<Item = f64>, digits: usize| -> Value {
            values.map(|value| rounded(value, digits)).collect()
        };
        let strips = |value: fn(&Strip) -> f64, digits| column(&mut self.strips.iter().map(value), digits);
        let wheel = |value: fn(&Placed) -> f64, digits| column(&mut self.wheel.iter().map(value), digits);
        let mut tables = json!({
            "strip_width_m": self.width,
            "strip_y_m": strips(|strip| strip.at.point.x, 10),
            "strip_z_m": strips(|strip| strip.at.point.y, 10),
            "strip_angle_rad": strips(|strip| strip.at.angle, 9),
            "strip_normal_pa": strips(|strip| strip.normal, 0),
            "strip_tangential_pa": strips(|strip| strip.tangential, 0),
            "wheel_spacing_m": self.spacing,
            "wheel_y_m": wheel(|at| at.point.x, 10),
            "wheel_z_m": wheel(|at| at.point.y, 10),
            "wheel_angle_rad": wheel(|at| at.angle, 9),
        });
        if contact == LumpedContact::Points {
            tables["point_n_per_m1_5"] = strips(|strip| strip.point, 0);
        }
        format!("{tables}\n")
    }
}

/// A place on a curve about an origin; the angle is that of the tangent along which y ascends where the surface is level.
fn placed(curve: &ProfileCurve, s: f64, origin: Point2<f64>) -> Placed {
    let up = curve.upward_normal(s);
    Placed { point: curve.point(s) - origin, angle: up.x.atan2(-up.y) }
}

fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.digits$}").parse().unwrap_or(value)
}
