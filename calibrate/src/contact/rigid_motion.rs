//! A rigid motion in the plane across the track.

use nalgebra::{Point2, UnitComplex, Vector2};

/// A small rigid motion in the plane across the track: a shift of its centre, and a turn about x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidMotion {
    /// The centre at rest, world (y, z), m.
    pub centre: Point2<f64>,
    /// Displacement of the centre (y, z), m.
    pub shift: Vector2<f64>,
    /// Angle from y towards z, rad.
    pub angle: f64,
    /// The point at rest about which the body turns, world (y, z), m: where the linear theory has the right displacement. Everywhere else
    /// that theory misses half the square of the angle times the distance from here.
    pub axis: Point2<f64>,
}

impl RigidMotion {
    /// A motion without a turn by (y, z), m.
    pub fn translation(shift: Vector2<f64>) -> Self {
        Self { centre: Point2::origin(), shift, angle: 0.0, axis: Point2::origin() }
    }

    /// The rigid motion nearest to the displacements (y, z; m) of points at rest (world y, z; m) with weights, by least squares:
    /// `(point, displacement, weight)`. Points that all lie in one place do not say how it turns; then there is no turn. `None`
    /// without a weight. The body turns about the centre of the points.
    pub fn fit(points: &[(Point2<f64>, Vector2<f64>, f64)]) -> Option<Self> {
        let sum: f64 = points.iter().map(|(_, _, weight)| weight).sum();
        if !(sum > 0.0 && sum.is_finite()) {
            return None;
        }
        let share = |weight: &f64| weight / sum;
        let centre =
            points.iter().map(|(point, _, weight)| point.coords * share(weight)).sum::<Vector2<f64>>();
        let centre = Point2::from(centre);
        let shift: Vector2<f64> = points.iter().map(|(_, moved, weight)| moved * share(weight)).sum();
        let (mut turned, mut inertia) = (0.0, 0.0);
        for (point, moved, weight) in points {
            let arm = point - centre;
            turned += weight * arm.perp(&(moved - shift));
            inertia += weight * arm.norm_squared();
        }
        let angle = if inertia > 0.0 { turned / inertia } else { 0.0 };
        Some(Self { centre, shift, angle, axis: centre })
    }

    /// The same displacements in the linear theory, of a body that turns about `axis`.
    pub fn about(self, axis: Point2<f64>) -> Self {
        Self { axis, ..self }
    }

    /// Displacement (y, z) of a point at rest in the linear theory of the bodies, m.
    pub fn displacement(&self, point: &Point2<f64>) -> Vector2<f64> {
        let arm = point - self.centre;
        self.shift + Vector2::new(-arm.y, arm.x) * self.angle
    }

    /// Where a point at rest is after the motion; unlike [`Self::displacement`] it keeps distances.
    pub fn place(&self, point: &Point2<f64>) -> Point2<f64> {
        self.axis + self.displacement(&self.axis) + self.turn() * (point - self.axis)
    }

    /// The turn about x.
    pub fn turn(&self) -> UnitComplex<f64> {
        UnitComplex::new(self.angle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{PairingLimits, Surface, pair};
    use crate::mesh::SurfaceGrid;
    use railspring_profiles::profile::ProfileCurve;

    /// No motion yet, of a body that turns about its centre.
    fn turned_about(centre: Point2<f64>) -> RigidMotion {
        RigidMotion { centre, axis: centre, ..RigidMotion::translation(Vector2::zeros()) }
    }

    /// Source: a rigid section on an axis that turns by θ (rad) with it; the linear theory has θ times the arm (m). Goal: of displacements of the linear theory
    /// at its head the section's own place is found, which lies lower by half the square of the angle times the height. Accuracy: ROUNDOFF.
    #[test]
    fn a_section_that_turns_about_its_axis_sinks() {
        const ROUNDOFF: f64 = 1e-15;
        let (axis, angle, shift) = (Point2::new(0.71, 0.12), 0.03, Vector2::new(2e-4, -1e-4));
        let head: Vec<_> =
            (0..7).map(|n| Point2::new(0.7 + 5e-3 * f64::from(n), 1e-4 * f64::from(n * n))).collect();
        let linear = |point: &Point2<f64>| {
            let arm = point - axis;
            shift + Vector2::new(-arm.y, arm.x) * angle
        };
        let points: Vec<_> = head.iter().map(|point| (*point, linear(point), 1.0)).collect();
        let fitted = RigidMotion::fit(&points).unwrap();
        let motion = fitted.about(axis);
        for point in &head {
            let exact = axis + shift + UnitComplex::new(angle) * (point - axis);
            assert!((motion.place(point) - exact).norm() < ROUNDOFF, "{motion:?}");
            let sinks = (motion.place(point) - fitted.place(point)).y;
            // to the angle to the fourth power, and where the points are not at the height of their centre
            assert!((sinks / (0.5 * angle * angle * axis.y) - 1.0).abs() < 0.03, "{sinks:e}");
            assert!((motion.displacement(point) - linear(point)).norm() < ROUNDOFF);
        }
    }

    /// Goal: the fit finds a rigid motion, m and rad, from displacements that are one, whatever the weights, and no turn where all points are in
    /// one place; a place keeps distances. Accuracy: ROUNDOFF.
    #[test]
    fn a_rigid_motion_is_found() {
        const ROUNDOFF: f64 = 1e-15;
        let motion = RigidMotion {
            shift: Vector2::new(1e-3, -2e-3),
            angle: 5e-3,
            ..turned_about(Point2::new(0.7, 0.01))
        };
        let points: Vec<_> = (0..9)
            .map(|n| {
                let point = Point2::new(0.7 + 1e-3 * f64::from(n), 1e-3 * f64::from(n * n));
                (point, motion.displacement(&point), 1.0 + f64::from(n % 4))
            })
            .collect();
        let found = RigidMotion::fit(&points).unwrap();
        assert!((found.angle - motion.angle).abs() < ROUNDOFF, "{found:?}");
        for (point, moved, _) in &points {
            assert!((found.displacement(point) - moved).norm() < ROUNDOFF, "{found:?}");
        }
        let (a, b) = (points[0].0, points[8].0);
        let apart = (motion.place(&a) - motion.place(&b)).norm();
        assert!((apart - (a - b).norm()).abs() < ROUNDOFF);
        let one = RigidMotion::fit(&[points[3]; 2]).unwrap();
        assert_eq!((one.shift, one.angle), (points[3].1, 0.0));
        assert!(RigidMotion::fit(&[(a, Vector2::zeros(), 0.0)]).is_none());
    }

    /// Goal: rail and wheel that move together as one body have the gaps (m) and areas (m²) that they had, and normals turned by the angle of the
    /// motion; the grid's nodes go with the surface. Accuracy: ROUNDOFF of coordinates of a metre and of the search along a
    /// ray, 1e-13 m.
    #[test]
    fn surfaces_that_move_together_stay_paired() {
        const ROUNDOFF: f64 = 1e-12;
        let arc = |radius: f64| {
            let point = |n: i32| f64::from(n) * 5e-4 / radius;
            let points: Vec<_> = (-40..=40)
                .map(point)
                .map(|a| Point2::new(radius * a.sin(), radius * (1.0 - a.cos())))
                .collect();
            ProfileCurve::from_points(&points, &[]).unwrap()
        };
        let (rail, wheel) = (arc(0.1), arc(0.3));
        let grid = |scale: f64| SurfaceGrid {
            along_profile: (0..=20).map(|i| f64::from(i) * 2e-3).collect(),
            along_track: (-5..=5).map(|k| f64::from(k) * 2e-3 * scale).collect(),
            nodes: (0..21 * 11).collect(),
        };
        let grids = [grid(1.0), grid(1.0 / 0.46)];
        let base = Surface::extruded(&rail, &grids[0]);
        let opposing = Surface::revolved(&wheel, &grids[1], 0.46, Vector2::new(3e-3, -0.2e-3));
        let motion = RigidMotion {
            shift: Vector2::new(2e-3, 1e-3),
            angle: 0.02,
            ..turned_about(Point2::new(0.02, 0.1))
        };
        let limits = PairingLimits { largest_gap: 2e-3 };
        let rest = pair(&base, &opposing, limits);
        let moved = pair(&base.placed(&motion), &opposing.placed(&motion), limits);
        assert!(rest.len() > 50 && rest.len() == moved.len(), "{} {}", rest.len(), moved.len());
        for (a, b) in rest.iter().zip(&moved) {
            assert!((a.gap - b.gap).abs() < ROUNDOFF && (a.area - b.area).abs() < ROUNDOFF, "{a:?} {b:?}");
            assert!((motion.turn() * a.normal - b.normal).norm() < ROUNDOFF);
        }
        for node in [0, 7, 115, 230] {
            for surface in [&base, &opposing] {
                let apart = surface.placed(&motion).node(node) - motion.place(&surface.node(node));
                assert!(apart.norm() < ROUNDOFF, "{node}");
            }
        }
    }
}
