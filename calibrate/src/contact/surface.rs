//! The two contact surfaces as tensor grids on smooth curves.

use crate::mesh::SurfaceGrid;
use crate::profile::ProfileCurve;
use nalgebra::{Matrix2, Point2, Vector2};

/// How the profile curve sweeps out the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// Along the track; grid coordinate x, m.
    Extruded,
    /// About the axle; the curve's z = 0 lies at this radius, m; grid coordinate θ, rad.
    Revolved {
        /// Rolling radius at the curve's z = 0, m.
        radius: f64,
    },
}

/// A contact surface.
#[derive(Debug, Clone)]
pub struct Surface<'a> {
    /// Profile curve in the body's own frame, m.
    pub curve: &'a ProfileCurve,
    /// How the curve sweeps out the surface.
    pub shape: Shape,
    /// Grid of the nodes on it.
    pub grid: &'a SurfaceGrid,
    /// World coordinates (y, z) of the origin of the curve's frame, m.
    pub origin: Vector2<f64>,
}

/// Where a ray from the base surface meets the opposing one.
#[derive(Debug, Clone, Copy)]
pub struct Projection {
    /// Arc length on the opposing curve, m.
    pub along_profile: f64,
    /// Grid coordinate along the track (x or θ).
    pub along_track: f64,
    /// Distance along the ray, m; negative if the surfaces overlap.
    pub gap: f64,
}

impl Surface<'_> {
    /// Point of the curve in world coordinates (y, z).
    pub fn world(&self, s: f64) -> Point2<f64> {
        self.curve.point(s) + self.origin
    }

    /// Grid coordinate along the track of the point at arc length `s` and `x`.
    pub fn track_coordinate(&self, s: f64, x: f64) -> f64 {
        match self.shape {
            Shape::Extruded => x,
            Shape::Revolved { radius } => (x / (radius + self.curve.point(s).y)).asin(),
        }
    }

    /// x of the point at arc length `s` and grid coordinate `t` along the track.
    pub fn x(&self, s: f64, t: f64) -> f64 {
        match self.shape {
            Shape::Extruded => t,
            Shape::Revolved { radius } => (radius + self.curve.point(s).y) * t.sin(),
        }
    }

    /// A first guess for [`Self::project`]: the arc length nearest to a world point (y, z) at x = 0.
    pub fn nearest(&self, point: &Point2<f64>) -> f64 {
        self.curve.closest(&(point - self.origin)).0
    }

    /// Follows the ray from (x, `point`) along `normal` to this surface, starting the search at
    /// arc length `guess`; `None` if it misses.
    pub fn project(
        &self,
        point: &Point2<f64>,
        x: f64,
        normal: &Vector2<f64>,
        guess: f64,
    ) -> Option<Projection> {
        let start = point - self.origin;
        let radius = match self.shape {
            Shape::Extruded => 0.0,
            Shape::Revolved { radius } => radius,
        };
        // height below the axle (revolved) or below the frame's origin (extruded), and its slope
        let height = |g: f64| {
            let z = start.y + radius + g * normal.y;
            if radius > 0.0 {
                let rho = x.hypot(z);
                (rho, normal.y * z / rho, x.atan2(z))
            } else {
                (z, normal.y, x)
            }
        };
        let length = self.curve.length();
        let (mut s, mut g) = (guess.clamp(0.0, length), 0.0);
        for _ in 0..40 {
            let (rho, slope, along_track) = height(g);
            let (p, t) = self.curve.evaluate(s);
            let residual = Vector2::new(start.x + g * normal.x - p.x, rho - radius - p.y);
            if residual.norm() < 1e-14 {
                let inside = (-1e-12..=length + 1e-12).contains(&s);
                return inside.then_some(Projection {
                    along_profile: s.clamp(0.0, length),
                    along_track,
                    gap: g,
                });
            }
            let step = Matrix2::new(-t.x, normal.x, -t.y, slope).try_inverse()? * -residual;
            // rays that run almost along the surface make wild steps: keep to the neighbourhood
            let scale = (5e-3 / step.x.abs().max(step.y.abs())).min(1.0);
            let next = (s + scale * step.x).clamp(0.0, length);
            if (next - s).abs() < 1e-16 && (scale * step.y).abs() < 1e-16 {
                return (residual.norm() < 1e-11).then_some(Projection {
                    along_profile: s,
                    along_track,
                    gap: g,
                });
            }
            s = next;
            g += scale * step.y;
        }
        None
    }
}
