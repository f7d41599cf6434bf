//! Section properties by Green's theorem over the exact outline.

use nalgebra::{Point2, Vector2};

use crate::profile::{ProfileCurve, Segment};

/// What follows from the outline of a rail alone; vertical bending turns about the lateral axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AreaProperties {
    /// Area, m².
    pub area: f64,
    /// Height of the centroid above the foot, m.
    pub centroid_height: f64,
    /// Second moment of area for vertical bending, m⁴.
    pub ixx: f64,
    /// Second moment of area for lateral bending, m⁴.
    pub iyy: f64,
}

/// Area, centroid and central second moments of a closed outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AreaMoments {
    /// m².
    pub area: f64,
    /// m.
    pub centroid: Point2<f64>,
    /// ∫ (z - zc)² dA, m⁴.
    pub zz: f64,
    /// ∫ (y - yc)² dA, m⁴.
    pub yy: f64,
}

/// ∮ f(p, dp/ds) ds over the closed outline of a curve followed by segments.
pub(super) fn boundary_integral<const N: usize>(
    running: &ProfileCurve,
    rest: &[Segment],
    f: impl Fn(&Point2<f64>, &Vector2<f64>) -> [f64; N],
) -> [f64; N] {
    let mut sum = running.integrate(&f);
    for segment in rest {
        for (total, v) in sum.iter_mut().zip(segment.integrate(&f)) {
            *total += v;
        }
    }
    sum
}

/// Moments of the area enclosed by `running` followed by `rest`, in either sense of rotation.
pub(super) fn area_moments(running: &ProfileCurve, rest: &[Segment]) -> AreaMoments {
    // ∫ y^m z^n dA = ∮ y^(m+1) z^n dz / (m+1), up to the sense of rotation, which the area's sign tells.
    let [a, y, z, yy, zz] = boundary_integral(running, rest, |p, t| {
        let (y, z) = (p.x, p.y);
        [y * t.y, y * y / 2.0 * t.y, y * z * t.y, y * y * y / 3.0 * t.y, y * z * z * t.y]
    });
    let centroid = Point2::new(y / a, z / a);
    let sense = a.signum();
    AreaMoments {
        area: a.abs(),
        centroid,
        zz: sense * (zz - a * centroid.y * centroid.y),
        yy: sense * (yy - a * centroid.x * centroid.x),
    }
}
