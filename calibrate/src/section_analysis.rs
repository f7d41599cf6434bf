//! Torsion and shear of a cross-section by two-dimensional finite elements on its own mesh.
//!
//! Three Laplace problems with given slopes at the boundary are solved on nine-node quadrilaterals: the warping
//! function of Saint-Venant's torsion, and the shear stress functions of a force in either direction. Shear centre
//! and warping constant follow from the warping function by Trefftz's definition: a twist about the shear centre does
//! no work on the bending moments. A shear coefficient is the one that gives the beam the strain energy of the
//! section's shear stresses; these are those of zero Poisson's ratio, the usual choice, which leaves the coefficient a
//! property of the shape (5/6 for a rectangle, 6/7 for a circle).

mod laplace;

use nalgebra::{Matrix2, Point2, Vector2};

use crate::mesh::{MeshOptions, SectionMesh, mesh_section, rail_outline};
use railspring_profiles::error::Result;
use railspring_profiles::section::RailSection;

use laplace::Laplace;

/// Shear stresses at one point of the quadrature over a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StressSample {
    /// The point (y, z), m.
    pub point: Point2<f64>,
    /// Its share of the area, m².
    pub area: f64,
    /// Shear stress (xy, xz), Pa, of three unit loads: a force along y and one along z through the shear
    /// centre, N, and a torque about x, N·m. Restrained warping carries the torque, as under a load halfway
    /// between two held ends, where the rate of twist is zero. Source: V.Z. Vlasov, Thin-Walled Elastic
    /// Beams, 1961.
    pub stress: [Vector2<f64>; 3],
}

/// Torsion and shear of a section; points in the frame of the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
struct SectionAnalysis {
    /// Area of the mesh, m².
    pub area: f64,
    /// Its centroid (y, z), m.
    pub centroid: Point2<f64>,
    /// Torsion constant of Saint-Venant, m⁴.
    pub torsion_constant: f64,
    /// Warping constant about the shear centre, m⁶.
    pub warping_constant: f64,
    /// Shear centre (y, z), m.
    pub shear_centre: Point2<f64>,
    /// Effective shear area over area for a force along y and along z.
    pub shear_coefficients: [f64; 2],
}

/// A rail as a beam, and its shear stresses.
#[derive(Debug, Clone, PartialEq)]
pub struct RailAnalysis {
    /// Stiffness and inertia.
    pub properties: SectionProperties,
    /// Shear stresses of the beam's forces; points and directions in the profile frame.
    pub stresses: Vec<StressSample>,
}

/// Properties of a rail as a beam; vertical bending turns about the lateral axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectionProperties {
    /// Area, m².
    pub area: f64,
    /// Height of the centroid above the foot, m.
    pub centroid_height: f64,
    /// Second moment of area for vertical bending, m⁴.
    pub ixx: f64,
    /// Second moment of area for lateral bending, m⁴.
    pub iyy: f64,
    /// Torsion constant of Saint-Venant, m⁴.
    pub torsion_constant: f64,
    /// Warping constant about the shear centre, m⁶.
    pub warping_constant: f64,
    /// Height of the shear centre above the foot, m.
    pub shear_centre_height: f64,
    /// Effective shear area over area, vertical shear.
    pub shear_coefficient_vertical: f64,
    /// Effective shear area over area, lateral shear.
    pub shear_coefficient_lateral: f64,
}

/// Largest element of the section's mesh, m. With nine-node elements the torsion constant of 60E1 changes by less
/// than 0.2 % when it is halved.
const ELEMENT: f64 = 6e-3;
/// Element at the running surface, m.
const SURFACE_ELEMENT: f64 = 4e-3;

/// Properties of a rail: area and second moments from its exact outline, torsion and shear from the analysis of its
/// mesh.
///
/// # Errors
/// A section that cannot be meshed.
///
/// ```
/// use railspring_profiles::section::rail_section;
/// use railspring_calibrate::section_analysis::rail_properties;
/// let rail = rail_properties(&rail_section("60E1")?)?;
/// assert!((rail.torsion_constant / 220.9e-8 - 1.0).abs() < 0.01);
/// # Ok::<(), railspring_profiles::error::Error>(())
/// ```
pub fn rail_properties(section: &RailSection) -> Result<SectionProperties> {
    rail_analysis(section).map(|analysis| analysis.properties)
}

/// As [`rail_properties`], with the shear stresses.
///
/// # Errors
/// A section that cannot be meshed.
pub fn rail_analysis(section: &RailSection) -> Result<RailAnalysis> {
    let options = MeshOptions {
        contact_element: SURFACE_ELEMENT,
        first_layer: Some(SURFACE_ELEMENT),
        rail_section_element: ELEMENT,
        ..MeshOptions::default()
    };
    let mesh = mesh_section(&rail_outline(section, &options)?, &options.rail_sizes())?;
    let solved = Solved::new(&mesh, |p| nearest_on_outline(section, p))?;
    let found = &solved.analysis;
    let exact = &section.area;
    let properties = SectionProperties {
        area: exact.area,
        centroid_height: exact.centroid_height,
        ixx: exact.ixx,
        iyy: exact.iyy,
        torsion_constant: found.torsion_constant,
        warping_constant: found.warping_constant,
        shear_centre_height: section.height - found.shear_centre.y,
        shear_coefficient_vertical: found.shear_coefficients[1],
        shear_coefficient_lateral: found.shear_coefficients[0],
    };
    Ok(RailAnalysis { properties, stresses: solved.shear_stresses()? })
}

/// The point of the exact outline nearest to `p`.
fn nearest_on_outline(section: &RailSection, p: &Point2<f64>) -> Point2<f64> {
    let (s, distance) = section.running.closest(p);
    let on_running = section.running.point(s);
    section
        .body_outline
        .iter()
        .map(|segment| segment.closest(p))
        .fold((on_running, distance), |best, q| {
            let distance = (p - q).norm();
            if distance < best.1 { (q, distance) } else { best }
        })
        .0
}

/// Torsion and shear of a meshed section. `on_outline` moves a node of the meshed outline, or the middle of an edge of
/// it, onto the exact outline, so that curved outlines get curved elements.
///
/// # Errors
/// [`railspring_profiles::error::NumericsError`] for a mesh that falls into parts.
#[cfg(test)]
fn analyse(mesh: &SectionMesh, on_outline: impl Fn(&Point2<f64>) -> Point2<f64>) -> Result<SectionAnalysis> {
    Ok(Solved::new(mesh, on_outline)?.analysis)
}

/// A section with its warping function (about the centroid) and its two shear stress functions.
struct Solved {
    laplace: Laplace,
    functions: [Vec<f64>; 3],
    analysis: SectionAnalysis,
    /// Mean of the warping function, and its slopes along y and z: the rest is warping about the shear centre.
    plane: (f64, Vector2<f64>),
}

impl Solved {
    fn new(mesh: &SectionMesh, on_outline: impl Fn(&Point2<f64>) -> Point2<f64>) -> Result<Self> {
        let laplace = Laplace::new(mesh, on_outline);
        let [area, y, z] = laplace.integrate(|p| [1.0, p.x, p.y]);
        let centroid = Point2::new(y / area, z / area);
        let [yy, yz, zz] = laplace.integrate(|p| {
            let r = p - centroid;
            [r.x * r.x, r.x * r.y, r.y * r.y]
        });
        let inertia = Matrix2::new(yy, yz, yz, zz);
        let inverse = inertia.try_inverse().unwrap_or_else(Matrix2::zeros);

        // Warping: ∫ ∇v·∇ω = ∫ ∇v·(z, -y). Shear by a unit force along e: ∫ ∇v·∇φ = ∫ v (I⁻¹ e)·r.
        let functions = laplace.solve(None, |p, _| {
            let r = p - centroid;
            let bending = inverse * r;
            laplace::Source { flow: Vector2::new(r.y, -r.x), supply: [bending.x, bending.y] }
        })?;
        let [warping, shear_y, shear_z] = &functions;

        // A unit rate of twist stores the energy of rigid rotation less what warping releases.
        let torsion_constant = yy + zz - laplace.energy(warping);
        // Twist about (a, b) from the centroid warps by ω - b y + a z, free of work on the bending moments.
        let [mean, wy, wz, ww] = laplace.integrate_with(warping, |p, w| {
            let r = p - centroid;
            [w, w * r.x, w * r.y, w * w]
        });
        let moments = inverse * Vector2::new(wy, wz);
        let shear_centre = centroid + Vector2::new(-moments.y, moments.x);
        // What the shift removes from ∫ ω² by orthogonality, and the mean.
        let warping_constant = ww - mean * mean / area - moments.dot(&Vector2::new(wy, wz));
        let shear_coefficients = [shear_y, shear_z].map(|phi| 1.0 / (area * laplace.energy(phi)));
        let analysis = SectionAnalysis {
            area,
            centroid,
            torsion_constant,
            warping_constant,
            shear_centre,
            shear_coefficients,
        };
        let plane = (mean / area, moments);
        Ok(Self { laplace, functions, analysis, plane })
    }

    /// The shear stresses of unit beam forces. Those of the torque balance the bending of the flanges: ∫ ∇v·∇ψ =
    /// -∫ v ω/I_ω with the warping function ω about the shear centre.
    fn shear_stresses(&self) -> Result<Vec<StressSample>> {
        let SectionAnalysis { centroid, warping_constant, .. } = self.analysis;
        let [warping, shear_y, shear_z] = &self.functions;
        let (mean, slope) = self.plane;
        let [_, balance, _] = self.laplace.solve(Some(warping), |p, about_centroid| {
            let about_shear_centre = about_centroid - mean - slope.dot(&(p - centroid));
            laplace::Source { flow: Vector2::zeros(), supply: [-about_shear_centre / warping_constant, 0.0] }
        })?;
        let functions = [shear_y, shear_z, &balance];
        Ok(self.laplace.samples(functions, |point, area, stress| StressSample { point, area, stress }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// DISCRETISATION: nine-node elements of 1/8 of the section's size; the error falls with the fourth power.
    const DISCRETISATION: f64 = 2e-4;

    fn mesh(n: usize, map: impl Fn(f64, f64) -> Point2<f64>) -> SectionMesh {
        let at = |i: usize, k: usize| {
            let [u, v] = [i, k].map(|j| 2.0 * j as f64 / n as f64 - 1.0);
            map(u, v)
        };
        let nodes = (0..=n).flat_map(|i| (0..=n).map(move |k| (i, k))).map(|(i, k)| at(i, k)).collect();
        let quads = (0..n)
            .flat_map(|i| (0..n).map(move |k| (i, k)))
            .map(|(i, k)| {
                let node = |i: usize, k: usize| i * (n + 1) + k;
                [node(i, k), node(i + 1, k), node(i + 1, k + 1), node(i, k + 1)]
            })
            .collect();
        let boundary = (0..4 * n)
            .map(|b| match (b / n, b % n) {
                (0, k) => k * (n + 1),
                (1, k) => n * (n + 1) + k,
                (2, k) => (n - k) * (n + 1) + n,
                (_, k) => n - k,
            })
            .collect();
        SectionMesh { nodes, quads, contact: vec![], contact_s: vec![], boundary }
    }

    /// Source: closed form: J = π R⁴/2, no warping, shear coefficient 6/7 for zero Poisson's ratio. Goal: curved
    /// elements on a circle; without them the polygon of 64 sides lacks 0.32 % of J.
    #[test]
    fn circle() {
        const R: f64 = 0.03;
        let offset = Vector2::new(0.2, -0.1);
        let disc = mesh(16, |u, v| {
            // The square's shells become circles.
            let shell = u.abs().max(v.abs());
            let direction = if shell > 0.0 { concentric(u, v) } else { Vector2::zeros() };
            Point2::from(offset + R * shell * direction)
        });
        let onto = |p: &Point2<f64>| Point2::from(offset + R * (p.coords - offset).normalize());
        let found = analyse(&disc, onto).unwrap();
        let polygon = analyse(&disc, |p| *p).unwrap();
        assert!(polygon.torsion_constant < 0.998 * found.torsion_constant);
        let exact = 0.5 * std::f64::consts::PI * R.powi(4);
        assert!((found.torsion_constant / exact - 1.0).abs() < DISCRETISATION, "{found:?}");
        assert!(
            (found.centroid.coords - offset).norm() < 1e-12
                && (found.shear_centre.coords - offset).norm() < 1e-12
        );
        assert!(found.warping_constant.abs() < 1e-5 * R.powi(6), "{found:?}");
        for kappa in found.shear_coefficients {
            assert!((kappa / (6.0 / 7.0) - 1.0).abs() < DISCRETISATION, "{found:?}");
        }
    }

    /// Direction on the circle of a point of the square's boundary: equal steps on a side are equal angles.
    fn concentric(u: f64, v: f64) -> Vector2<f64> {
        let quarter = std::f64::consts::FRAC_PI_4;
        let angle = if u.abs() >= v.abs() {
            quarter * v / u + if u < 0.0 { 4.0 * quarter } else { 0.0 }
        } else {
            2.0 * quarter - quarter * u / v + if v < 0.0 { 4.0 * quarter } else { 0.0 }
        };
        Vector2::new(angle.cos(), angle.sin())
    }

    /// Source: Saint-Venant's series for a rectangle 2a by 2b with a = 2b: J = 16 a b³ (1/3 - 0.21 (b/a)
    /// (1 - (b/a)⁴/12)) to 0.2 %, exactly 0.228682 (2a)(2b)³; shear coefficient 5/6 both ways.
    #[test]
    fn rectangle() {
        let (a, b) = (0.04, 0.02);
        let found = analyse(&mesh(12, |u, v| Point2::new(a * u + 0.3, b * v)), |p| *p).unwrap();
        assert!(
            (found.torsion_constant / (0.228_682 * 2.0 * a * (2.0 * b).powi(3)) - 1.0).abs() < DISCRETISATION
        );
        assert!((found.shear_centre - Point2::new(0.3, 0.0)).norm() < 1e-12);
        for kappa in found.shear_coefficients {
            assert!((kappa / (5.0 / 6.0) - 1.0).abs() < DISCRETISATION, "{found:?}");
        }
        // A square mapped askew has the same properties as the square.
        let askew = |u: f64, v: f64| Point2::new(b * (u + 0.2 * (1.0 - u * u) * v), b * v);
        let [straight, skewed] = [mesh(12, |u, v| Point2::new(b * u, b * v)), mesh(12, askew)]
            .map(|m| analyse(&m, |p| *p).unwrap());
        assert!((straight.torsion_constant / (0.140_577 * (2.0 * b).powi(4)) - 1.0).abs() < DISCRETISATION);
        assert!((skewed.torsion_constant / straight.torsion_constant - 1.0).abs() < DISCRETISATION);
    }

    /// Source: thin-walled beam theory of a channel with web h, flanges b (middle lines) and thickness t: shear centre
    /// 3b²/(h + 6b) beyond the web, warping constant t b³ h²/12 · (3b + 2h)/(6b + h), J = Σ l t³/3. MODEL: walls of
    /// 1/20 of the width; corners count twice or not at all.
    #[test]
    fn channel() {
        const MODEL: f64 = 0.03;
        let (h, b, t) = (0.1, 0.1, 0.005);
        // A strip bent twice: u runs along the three walls, v across.
        let n = 60;
        let per_wall = n / 3;
        let mut channel = mesh(n, Point2::new);
        for (index, p) in channel.nodes.iter_mut().enumerate() {
            let (i, v) = (index / (n + 1), p.y);
            let offset = 0.5 * t * v;
            let along = |k: usize| k as f64 / per_wall as f64;
            // Mitred at the corners.
            *p = match i / per_wall {
                0 => Point2::new(b - (b - offset) * along(i), 0.5 * h - offset),
                1 => Point2::new(offset, (0.5 * h - offset) * (1.0 - 2.0 * along(i - per_wall))),
                _ => Point2::new(offset + (b - offset) * along(i - 2 * per_wall), offset - 0.5 * h),
            };
        }
        let found = analyse(&channel, |p| *p).unwrap();
        let beyond = 3.0 * b * b / (h + 6.0 * b);
        assert!((found.shear_centre.x / -beyond - 1.0).abs() < MODEL, "{found:?}");
        assert!(found.shear_centre.y.abs() < 1e-9);
        let warping = t * b.powi(3) * h * h / 12.0 * (3.0 * b + 2.0 * h) / (6.0 * b + h);
        assert!((found.warping_constant / warping - 1.0).abs() < MODEL, "{found:?} {warping:e}");
        assert!((found.torsion_constant / ((h + 2.0 * b) * t.powi(3) / 3.0) - 1.0).abs() < MODEL);
    }
}
