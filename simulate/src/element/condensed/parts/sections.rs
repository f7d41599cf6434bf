//! A surface near the contact as a section that moves without distortion.
//!
//! Beyond its half-space a body moves its running surface hardly otherwise than as a rigid section: two displacements
//! and a rotation about the track. A flexibility of three by three then says how the contact's place moves under its force,
//! wherever on the profile it is.

use faer::Mat;
use nalgebra::{DMatrix, DVector, Matrix2, Matrix2x3, Matrix3, Point2, Point3, Rotation2, Vector2, Vector3};
use railspring_calibrate::contact::{HalfSpace, displacement_far_from};
use railspring_calibrate::mesh::SurfaceGrid;
use railspring_calibrate::superelement::carried;
use railspring_profiles::error::{InputError, Result};

/// Distance along the track of force and displacement at most, m, where the grid is that long: patches on a flange are, and what a body gives way nearer than that is the contact's.
const APART: f64 = 24e-3;

/// Lines of the grid between them at least: an element mesh does not resolve a half-space that is nearer.
const LINES_APART: usize = 4;

/// Forces and displacements this far apart along the profile are those of one contact or of two that stand side by side, m.
const TOGETHER: f64 = 15e-3;

/// The surface of a condensed body where it can touch.
#[derive(Clone, Copy)]
pub struct RunningSurface<'a> {
    /// Compliance of the contact nodes (`3·node + axis`), m/N.
    pub compliance: &'a Mat<f64>,
    /// The grid of the contact nodes.
    pub grid: &'a SurfaceGrid,
    /// Where they are, m.
    pub nodes: &'a [Point3<f64>],
    /// Its half-space.
    pub half_space: HalfSpace,
}

/// The flexibility of a surface as that of a section.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionFlexibility {
    /// Displacements y and z (m) and rotation about x (rad) under forces (N) and a torque (N·m), about the given point.
    pub flexibility: Matrix3<f64>,
    /// What of the displacements (RMS, over their own) the section does not have.
    pub misfit: f64,
}

impl RunningSurface<'_> {
    /// Whether the grid has the lines along the track that a flexibility beyond the half-space takes.
    ///
    /// # Errors
    /// [`InputError`] with the name of the body.
    pub fn check(&self, body: &str) -> Result<()> {
        let (middle, columns) = (self.middle(), self.grid.along_track.len());
        if middle >= LINES_APART / 2 && middle + LINES_APART / 2 < columns {
            return Ok(());
        }
        InputError::refuse(
            body,
            format!("{columns} lines of contact nodes along the track, number {} in the middle", middle + 1),
            format!("{} on either side of the middle at least", LINES_APART / 2),
            "give the mesh more lines along the track, or run the published element",
        )
    }

    fn middle(&self) -> usize {
        let lines = &self.grid.along_track;
        (0..lines.len()).min_by(|&a, &b| lines[a].abs().total_cmp(&lines[b].abs())).unwrap_or(0)
    }

    /// The lines along the track of force and displacement, on either side of the middle.
    fn apart(&self) -> (usize, usize) {
        let (middle, lines) = (self.middle(), &self.grid.along_track);
        let most = middle.min(lines.len() - 1 - middle);
        let within = |k: &usize| lines[middle + k] - lines[middle - k] <= APART * (1.0 + 1e-9);
        let half = (0..=most).rev().find(within).unwrap_or(0).max(LINES_APART / 2);
        (middle - half, middle + half)
    }

    fn place(&self, line: usize, column: usize) -> Point3<f64> {
        self.nodes[line * self.grid.along_track.len() + column]
    }

    /// Positions (y, z) of the nodes at the middle of the track, along the profile, m.
    pub fn profile(&self) -> Vec<Point2<f64>> {
        let middle = self.middle();
        let lines = 0..self.grid.along_profile.len();
        lines.map(|line| self.place(line, middle)).map(|p| Point2::new(p.y, p.z)).collect()
    }

    /// Numbers of these nodes in the grid.
    pub fn profile_nodes(&self) -> Vec<usize> {
        let (middle, columns) = (self.middle(), self.grid.along_track.len());
        (0..self.grid.along_profile.len()).map(|line| line * columns + middle).collect()
    }

    /// Displacement (y, z) on one line of the profile under forces (y, z) on another, less the half-space where they are in one
    /// contact, m/N.
    fn beyond_half_space(&self, to: usize, from: usize) -> Matrix2<f64> {
        let columns = self.grid.along_track.len();
        let (low, high) = self.apart();
        let between = |a: usize, b: usize| {
            let (row, column) = (3 * (to * columns + a) + 1, 3 * (from * columns + b) + 1);
            Matrix2::from_fn(|i, j| self.compliance[(row + i, column + j)])
        };
        // the part that is even in the distance along the track
        let whole = (between(low, high) + between(high, low)) * 0.5;
        let (s, r) = (self.grid.along_profile[to], self.grid.along_profile[from]);
        let x = self.place(to, low).x - self.place(from, high).x;
        let offset = Vector2::new(s - r, x);
        let near = Matrix2::from_columns(&[0, 1].map(|direction| {
            let force = Vector3::from_fn(|d, _| if d == direction { 1.0 } else { 0.0 });
            displacement_far_from(&[self.half_space], &offset, &force).xy()
        }));
        whole - self.frame(to) * near * self.frame(from).transpose()
    }

    /// Normal out of a rail and the tangent at a line of the profile, world axes.
    fn frame(&self, line: usize) -> Matrix2<f64> {
        let (middle, last) = (self.middle(), self.grid.along_profile.len() - 1);
        let (a, b) = (self.place(line.saturating_sub(1), middle), self.place((line + 1).min(last), middle));
        let along = Vector2::new(b.y - a.y, b.z - a.z).normalize();
        let normal = Rotation2::new(-std::f64::consts::FRAC_PI_2) * along;
        Matrix2::from_columns(&[normal, Vector2::new(-normal.y, normal.x)])
    }

    /// The flexibility as a section about a point (y, z; m), from forces on all lines of the profile.
    pub fn section(&self, about: Point2<f64>) -> SectionFlexibility {
        const UNKNOWNS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
        let arms: Vec<Matrix2x3<f64>> = self.profile().iter().map(|p| carried(&(p - about))).collect();
        let (mut normal, mut right) = (DMatrix::zeros(6, 6), DVector::zeros(6));
        let mut all = Vec::new();
        for (to, arm) in arms.iter().enumerate() {
            for (from, other) in arms.iter().enumerate() {
                let along = &self.grid.along_profile;
                if (along[to] - along[from]).abs() > TOGETHER {
                    continue;
                }
                let found = self.beyond_half_space(to, from);
                let scale = 1.0 / found.norm();
                for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let row = DVector::from_iterator(
                        6,
                        UNKNOWNS.iter().map(|&(k, l)| {
                            let both = arm[(i, k)] * other[(j, l)];
                            scale * if k == l { both } else { both + arm[(i, l)] * other[(j, k)] }
                        }),
                    );
                    let value = scale * found[(i, j)];
                    normal += &row * row.transpose();
                    right += &row * value;
                    all.push((row, value));
                }
            }
        }
        // metres and radians are made comparable
        let scale =
            DVector::from_iterator(6, (0..6).map(|i| 1.0 / normal[(i, i)].max(f64::MIN_POSITIVE).sqrt()));
        let scaled = DMatrix::from_fn(6, 6, |i, j| scale[i] * normal[(i, j)] * scale[j]);
        let solved = scaled.cholesky().map(|c| c.solve(&right.component_mul(&scale)).component_mul(&scale));
        let values = solved.unwrap_or_else(|| DVector::zeros(6));
        let mut flexibility = Matrix3::zeros();
        for (value, &(k, l)) in values.iter().zip(&UNKNOWNS) {
            flexibility[(k, l)] = *value;
            flexibility[(l, k)] = *value;
        }
        let (mut missed, mut size) = (0.0, 0.0);
        for (row, value) in &all {
            missed += (row.dot(&values) - value).powi(2);
            size += value * value;
        }
        SectionFlexibility { flexibility, misfit: (missed / size).sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use railspring_calibrate::contact::Side;
    use railspring_calibrate::solid::Material;

    /// Goal: a surface that is a half-space on a section that moves without distortion has the flexibility of that section (displacements in m/N, rotation
    /// in rad/N and rad/(N·m)) and no misfit, about any point; a grid with too few lines is refused. Accuracy: ROUNDOFF; nodes up to 8 mm
    /// aside tell forces from torques about a point 100 mm away by (100/8)² parts, and least squares square that, twice for both sides: 1e-16·2e8.
    #[test]
    fn a_section_on_a_half_space_is_found() {
        const ROUNDOFF: f64 = 1e-7;
        let (lines, columns, spacing) = (9, 7, 2e-3);
        let along = |count: usize| -> Vec<f64> {
            (0..count).map(|i| (i as f64 - 0.5 * (count - 1) as f64) * spacing).collect()
        };
        let grid = SurfaceGrid {
            along_profile: along(lines),
            along_track: along(columns),
            nodes: (0..lines * columns).collect(),
        };
        let nodes: Vec<Point3<f64>> = (0..lines * columns)
            .map(|n| Point3::new(grid.along_track[n % columns], grid.along_profile[n / columns], 0.0))
            .collect();
        let section = Matrix3::new(9e-9, -1e-10, -4e-8, -1e-10, 2e-10, 5e-10, -4e-8, 5e-10, 3e-7);
        let about = Point2::new(3e-3, -0.1);
        let half_space = HalfSpace::new(&Material::STEEL, Side::Base);
        let mut compliance = Mat::zeros(3 * nodes.len(), 3 * nodes.len());
        for (i, a) in nodes.iter().enumerate() {
            for (j, b) in nodes.iter().enumerate() {
                let arm = |p: &Point3<f64>| carried(&Vector2::new(p.y - about.x, p.z - about.y));
                let mut both = arm(a) * section * arm(b).transpose();
                let offset = Vector2::new(a.y - b.y, a.x - b.x);
                if i != j {
                    // the normal out of the surface is -z, the tangent y
                    for (from, force) in [(0, Vector3::y()), (1, -Vector3::x())] {
                        let moved = displacement_far_from(&[half_space], &offset, &force);
                        both[(0, from)] += moved.y;
                        both[(1, from)] -= moved.x;
                    }
                }
                for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    compliance[(3 * i + 1 + row, 3 * j + 1 + column)] = both[(row, column)];
                }
            }
        }
        let surface = RunningSurface { compliance: &compliance, grid: &grid, nodes: &nodes, half_space };
        surface.check("block").unwrap();
        let found = surface.section(about);
        assert!(found.misfit < ROUNDOFF, "{}", found.misfit);
        let off = (found.flexibility - section).component_div(&section).amax();
        assert!(off < ROUNDOFF, "{off}: {:e}", found.flexibility);
        let narrow = SurfaceGrid { along_track: along(3), ..grid.clone() };
        let refused = RunningSurface { grid: &narrow, ..surface }.check("block").unwrap_err().to_string();
        assert!(refused.contains("block") && refused.contains("3 lines"), "{refused}");
    }
}
