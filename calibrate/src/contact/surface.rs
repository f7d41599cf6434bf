//! The two contact surfaces as tensor grids on smooth curves.

use super::rigid_motion::RigidMotion;
use crate::mesh::SurfaceGrid;
use nalgebra::{Matrix2, Point2, UnitComplex, Vector2, Vector3};
use railspring_profiles::profile::ProfileCurve;

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
    /// Turn of the curve's frame about x, from y towards z; the axle of what is revolved turns with it.
    pub turn: UnitComplex<f64>,
    /// What lies between the nodes.
    pub between_nodes: BetweenNodes,
}

/// What a contact surface is between the nodes of its grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BetweenNodes {
    /// The smooth curve, swept.
    #[default]
    Smooth,
    /// Bilinear facets, as programs have them that know nothing but the mesh. Gaps grow by the depth at which the
    /// facets lie below the smooth surface; normals stay smooth, which changes a gap by a factor of `1 + h²/8R²`.
    Facets,
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

/// Bilinear weights of the four corners of a cell: grid offsets (along profile, along track) and value.
pub fn corners(u: f64, v: f64) -> [(usize, usize, f64); 4] {
    [(0, 0, (1.0 - u) * (1.0 - v)), (0, 1, (1.0 - u) * v), (1, 0, u * (1.0 - v)), (1, 1, u * v)]
}

/// Nodes of a grid with `columns` lines along the track within so many lines of those in `nodes`.
pub fn widened(nodes: &[bool], columns: usize, lines: usize) -> Vec<bool> {
    let rows = nodes.len() / columns;
    let mut wide = vec![false; nodes.len()];
    for node in (0..nodes.len()).filter(|&node| nodes[node]) {
        let (i, k) = (node / columns, node % columns);
        for a in i.saturating_sub(lines)..=(i + lines).min(rows - 1) {
            let line = &mut wide[a * columns..(a + 1) * columns];
            line[k.saturating_sub(lines)..=(k + lines).min(columns - 1)].fill(true);
        }
    }
    wide
}

impl<'a> Surface<'a> {
    /// The smooth surface of a rail or block at rest, its curve in world coordinates.
    pub fn extruded(curve: &'a ProfileCurve, grid: &'a SurfaceGrid) -> Self {
        Self {
            curve,
            shape: Shape::Extruded,
            grid,
            origin: Vector2::zeros(),
            turn: UnitComplex::identity(),
            between_nodes: BetweenNodes::Smooth,
        }
    }

    /// The smooth surface of a wheel with `radius` (m) at the curve's z = 0, the curve's frame at the world
    /// coordinates (y, z) of `origin`, m.
    pub fn revolved(
        curve: &'a ProfileCurve,
        grid: &'a SurfaceGrid,
        radius: f64,
        origin: Vector2<f64>,
    ) -> Self {
        Self { shape: Shape::Revolved { radius }, origin, ..Self::extruded(curve, grid) }
    }

    /// The surface moved by (y, z), m.
    #[must_use]
    pub fn moved(&self, by: &Vector2<f64>) -> Self {
        Self { origin: self.origin + by, ..self.clone() }
    }

    /// The surface after a rigid motion across the track.
    #[must_use]
    pub fn placed(&self, motion: &RigidMotion) -> Self {
        let origin = motion.place(&Point2::from(self.origin)).coords;
        Self { origin, turn: motion.turn() * self.turn, ..self.clone() }
    }

    /// Point of the curve in world coordinates (y, z).
    pub fn world(&self, s: f64) -> Point2<f64> {
        self.turn * self.curve.point(s) + self.origin
    }

    /// Normal out of a rail (or lower block) at the arc length `s`, world (y, z).
    pub fn normal(&self, s: f64) -> Vector2<f64> {
        self.turn * self.curve.upward_normal(s)
    }

    /// World coordinates (y, z) of a node of the grid, m.
    pub fn node(&self, node: usize) -> Point2<f64> {
        let columns = self.grid.along_track.len();
        let swept =
            self.swept(self.grid.along_profile[node / columns], self.grid.along_track[node % columns]);
        let below = match self.shape {
            Shape::Extruded => 0.0,
            Shape::Revolved { radius } => radius,
        };
        self.turn * Point2::new(swept.y, swept.z - below) + self.origin
    }

    /// x of the point at arc length `s` and grid coordinate `t` along the track.
    pub fn x(&self, s: f64, t: f64) -> f64 {
        match self.shape {
            Shape::Extruded => t,
            Shape::Revolved { radius } => (radius + self.curve.point(s).y) * t.sin(),
        }
    }

    /// x of all lines of the grid along the track over what [`Self::lines_over`] is at an arc length.
    pub fn unit_lines(&self) -> Vec<f64> {
        let lines = self.grid.along_track.iter();
        match self.shape {
            Shape::Extruded => lines.copied().collect(),
            Shape::Revolved { .. } => lines.map(|t| t.sin()).collect(),
        }
    }

    /// What the [`Self::unit_lines`] are multiplied by at the arc length `s`: the radius there of what is revolved.
    pub fn lines_over(&self, s: f64) -> f64 {
        match self.shape {
            Shape::Extruded => 1.0,
            Shape::Revolved { radius } => radius + self.curve.point(s).y,
        }
    }

    /// Depth of the surface below the smooth one, m, at the local coordinates (0 to 1: along the profile, along the
    /// track) of the cell whose first node is `(i, k)`; 0 for a smooth surface.
    pub fn recession(&self, (i, k): (usize, usize), (u, v): (f64, f64)) -> f64 {
        if self.between_nodes == BetweenNodes::Smooth {
            return 0.0;
        }
        let (s, t) = (&self.grid.along_profile, &self.grid.along_track);
        let facet: Vector3<f64> =
            corners(u, v).map(|(a, b, weight)| self.swept(s[i + a], t[k + b]) * weight).iter().sum();
        let (s, t) = (s[i] + u * (s[i + 1] - s[i]), t[k] + v * (t[k + 1] - t[k]));
        self.outward_normal(s, t).dot(&(self.swept(s, t) - facet))
    }

    /// Point of the smooth surface; about the axle for a surface of revolution, else in the curve's frame.
    fn swept(&self, s: f64, t: f64) -> Vector3<f64> {
        let p = self.curve.point(s);
        match self.shape {
            Shape::Extruded => Vector3::new(t, p.x, p.y),
            Shape::Revolved { radius } => {
                Vector3::new((radius + p.y) * t.sin(), p.x, (radius + p.y) * t.cos())
            }
        }
    }

    /// Unit normal out of the body: up from what is extruded (a rail), away from the axle of what is revolved.
    fn outward_normal(&self, s: f64, t: f64) -> Vector3<f64> {
        let up = self.curve.upward_normal(s);
        match self.shape {
            Shape::Extruded => Vector3::new(0.0, up.x, up.y),
            Shape::Revolved { .. } => Vector3::new(-up.y * t.sin(), -up.x, -up.y * t.cos()),
        }
    }

    /// A first guess for [`Self::project`]: the arc length nearest to a world point (y, z) at x = 0.
    pub fn nearest(&self, point: &Point2<f64>) -> f64 {
        self.curve.closest(&self.turn.inverse_transform_point(&(point - self.origin))).0
    }

    /// As [`Self::nearest`] for a point near the surface, from a `guess` nearby.
    pub(super) fn nearest_from(&self, point: &Point2<f64>, guess: f64) -> f64 {
        self.curve.closest_near(&self.turn.inverse_transform_point(&(point - self.origin)), guess).0
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
        self.project_from(point, x, normal, (guess, 0.0))
    }

    /// As [`Self::project`], starting the search at an arc length and a gap (m).
    pub(super) fn project_from(
        &self,
        point: &Point2<f64>,
        x: f64,
        normal: &Vector2<f64>,
        (guess, gap): (f64, f64),
    ) -> Option<Projection> {
        let start = self.turn.inverse_transform_point(&(point - self.origin));
        let normal = self.turn.inverse_transform_vector(normal);
        let radius = match self.shape {
            Shape::Extruded => 0.0,
            Shape::Revolved { radius } => radius,
        };
        // height below the axle (revolved) or below the frame's origin (extruded), and its slope
        let below = |g: f64| start.y + radius + g * normal.y;
        let height = |g: f64| {
            let z = below(g);
            if radius > 0.0 {
                let rho = (x * x + z * z).sqrt();
                (rho, normal.y * z / rho)
            } else {
                (z, normal.y)
            }
        };
        let along_track = |g: f64| if radius > 0.0 { x.atan2(below(g)) } else { x };
        let length = self.curve.length();
        let (mut s, mut g) = (guess.clamp(0.0, length), gap);
        for _ in 0..40 {
            let (rho, slope) = height(g);
            let (p, t) = self.curve.evaluate(s);
            let residual = Vector2::new(start.x + g * normal.x - p.x, rho - radius - p.y);
            if residual.norm() < 1e-14 {
                let inside = (-1e-12..=length + 1e-12).contains(&s);
                return inside.then_some(Projection {
                    along_profile: s.clamp(0.0, length),
                    along_track: along_track(g),
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
                    along_track: along_track(g),
                    gap: g,
                });
            }
            s = next;
            g += scale * step.y;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ROUNDOFF of radii of half a metre in a recession of a micrometre, and the spline through the points.
    const ROUNDOFF: f64 = 1e-11;
    const HALF: [f64; 3] = [-1e-3, 0.0, 1e-3];

    /// Source: the rise of a circular arc over its chord, r·(1 − cos α). Goal: facets of a crowned rail
    /// and of a crowned wheel lie below their smooth surfaces by the rise across and along the track, m,
    /// and not at all at the nodes or where the surface is taken as smooth. Accuracy: rounding.
    #[test]
    fn facets_lie_below_the_smooth_surface() {
        const CROWN: f64 = 0.3;
        const WHEEL: f64 = 0.429;
        // crowned towards the other body: up (−z) for the rail, down for the wheel
        let arc = |sign: f64| -> ProfileCurve {
            let points: Vec<Point2<f64>> = (-100..=100)
                .map(|k| f64::from(k) * 2e-4 / CROWN)
                .map(|a| Point2::new(CROWN * a.sin(), sign * CROWN * (1.0 - a.cos())))
                .collect();
            ProfileCurve::from_points(&points, &[]).unwrap()
        };
        let (rail, wheel) = (arc(1.0), arc(-1.0));
        let grid = |curve: &ProfileCurve, angle: f64| SurfaceGrid {
            along_profile: HALF.map(|s| 0.5 * curve.length() + s).to_vec(),
            along_track: HALF.map(|x| x * angle).to_vec(),
            nodes: (0..9).collect(),
        };
        let grids = [grid(&rail, 1.0), grid(&wheel, 1.0 / WHEEL)];
        let faceted = |surface| Surface { between_nodes: BetweenNodes::Facets, ..surface };
        let smooth = Surface::extruded(&rail, &grids[0]);
        let on_rail = faceted(smooth.clone());
        let on_wheel = faceted(Surface::revolved(&wheel, &grids[1], WHEEL, Vector2::zeros()));
        let rise = |radius: f64| radius * (1.0 - (0.5 * 1e-3 / radius).cos());
        for (surface, expected) in [(on_rail, rise(CROWN)), (on_wheel, rise(CROWN) + rise(WHEEL))] {
            let middle = surface.recession((0, 1), (0.5, 0.5));
            assert!((middle - expected).abs() < ROUNDOFF, "{middle} {expected}");
            for node in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)] {
                assert!(surface.recession((0, 1), node).abs() < ROUNDOFF);
            }
        }
        assert_eq!(smooth.recession((0, 1), (0.5, 0.5)), 0.0);
    }
}
