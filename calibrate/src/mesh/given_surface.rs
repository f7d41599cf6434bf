//! The contact surface of a mesh that was made elsewhere: from the nodes of a named group to the tensor grid on the
//! smooth running surface.

use std::f64::consts::PI;

use nalgebra::{Point2, Point3};

use super::hex_mesh::SurfaceGrid;
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::field::InputField;
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::units::MILLIMETRE;

/// Largest distance (m) of a contact node from the smooth running surface. The curve carries the gap and the mesh the
/// stiffness, so that facets and rounded coordinates do no harm; another profile or place is off by far more.
const ON_CURVE: f64 = 0.1e-3;
/// Nodes of one row or column of a swept grid agree within this distance, m: coordinates with few digits.
const SWEPT: f64 = 10e-6;
/// Share of the window (relative) that may be missing at its ends: rounding of the coordinates.
const WINDOW: f64 = 1e-3;

/// The smooth surface that the mesh's contact nodes have to lie on, in the frame of the mesh.
pub(super) struct Smooth<'a> {
    /// Contact surface of the rail or of the wheel.
    pub field: InputField,
    /// Running curve: of the rail in the world frame, of the wheel in its profile frame.
    pub curve: &'a ProfileCurve,
    /// Radius of the wheel at the curve's z = 0, m; `None` for a rail.
    pub radius: Option<f64>,
}

/// A contact node on the smooth surface.
struct Placed {
    node: usize,
    /// Point of the section, m.
    section: Point2<f64>,
    /// Arc length on the running curve, m.
    s: f64,
    /// Grid coordinate along the track: x in m or θ in rad.
    track: f64,
}

impl Smooth<'_> {
    /// Grid coordinate along the track: x in m or θ in rad.
    fn track(&self, p: &Point3<f64>) -> f64 {
        if self.radius.is_some() { p.x.atan2(p.z) } else { p.x }
    }

    /// Point of the section, in the frame of the curve.
    fn section(&self, p: &Point3<f64>) -> Point2<f64> {
        match self.radius {
            Some(radius) => Point2::new(p.y, p.x.hypot(p.z) - radius),
            None => Point2::new(p.y, p.z),
        }
    }

    /// A length of a unit of the coordinate along the track, m.
    fn lever(&self) -> f64 {
        self.radius.unwrap_or(1.0)
    }

    /// A position along the track, m: x, or the arc at the tape circle.
    fn shown(&self, track: f64) -> String {
        let what = if self.radius.is_some() { "arc at the tape circle" } else { "x" };
        format!("{what} = {:.3} mm", track * self.lever() / MILLIMETRE)
    }

    /// The grid on the faces of `outer` whose nodes all belong to `contact`, as far as the window of ±`half` (m) needs
    /// them.
    ///
    /// # Errors
    /// [`InputError`] with the field of the contact surface if the faces are no swept grid on the smooth surface, or do not
    /// cover the window.
    pub fn grid(
        &self,
        nodes: &[Point3<f64>],
        outer: &[[usize; 4]],
        contact: &[usize],
        half: f64,
    ) -> Result<SurfaceGrid> {
        let mut named = vec![false; nodes.len()];
        contact.iter().for_each(|&v| named[v] = true);
        let surface: Vec<&[usize; 4]> = outer.iter().filter(|face| face.iter().all(|&v| named[v])).collect();
        if surface.is_empty() {
            return InputError::refuse(
                self.field,
                format!(
                    "{} nodes, none of the mesh's outer faces has all its four among them",
                    contact.len()
                ),
                "the nodes of faces on the outside of the mesh",
                "name the running surface with all its nodes",
            );
        }
        // The whole surface may be named; only what the window needs has to be a grid.
        let window = half / self.lever();
        let reach = window * (1.0 - WINDOW);
        let faces: Vec<&[usize; 4]> = surface
            .iter()
            .copied()
            .filter(|face| {
                let track = face.map(|v| self.track(&nodes[v]));
                let (low, high) = extent(track.into_iter());
                // faces opposite the contact join both ends of the angle
                low < reach && high > -reach && (self.radius.is_none() || high - low < PI)
            })
            .collect();
        let mut used: Vec<usize> = faces.iter().flat_map(|face| face.iter().copied()).collect();
        used.sort_unstable();
        used.dedup();
        let placed = self.place(nodes, &used)?;
        let (first, last) = extent(placed.iter().map(|p| p.track));
        if !(first <= -reach && last >= reach) {
            let (first, last) = extent(surface.iter().flat_map(|face| face.map(|v| self.track(&nodes[v]))));
            return InputError::refuse(
                self.field,
                format!("faces from {} to {}", self.shown(first), self.shown(last)),
                format!(
                    "a surface on both sides of the contact, over the window of \u{b1}{:.3} mm",
                    half / MILLIMETRE
                ),
                "name a longer surface with its middle at the contact (x = 0, below the axle), or shorten \
                 `window_half_length`",
            );
        }
        self.tensor(nodes, &placed, faces.len())
    }

    /// The nodes on the smooth surface.
    fn place(&self, nodes: &[Point3<f64>], used: &[usize]) -> Result<Vec<Placed>> {
        let mut placed = Vec::with_capacity(used.len());
        let (mut worst, mut off, mut beyond) = (0.0, used.first().copied().unwrap_or_default(), 0_usize);
        for &node in used {
            let section = self.section(&nodes[node]);
            let (s, distance) = self.curve.closest(&section);
            beyond += usize::from(!(distance <= ON_CURVE));
            if !(distance <= worst) {
                (worst, off) = (distance, node);
            }
            placed.push(Placed { node, section, s, track: self.track(&nodes[node]) });
        }
        if worst <= ON_CURVE {
            return Ok(placed);
        }
        let p = nodes[off] / MILLIMETRE;
        let frame = match self.radius {
            Some(_) => {
                "the axes (y along the axle from the tape circle, z down, origin in the middle of the hub) and \
                        the tape diameter"
            }
            None => {
                "the place in the track (z = 0 on top of the inclined rail, y from the track centre), the \
                     inclination and the gauge"
            }
        };
        InputError::refuse(
            self.field,
            format!(
                "{beyond} of {} nodes lie off the running surface, the worst by {:.3} mm at ({:.3}, {:.3}, {:.3}) mm",
                used.len(),
                worst / MILLIMETRE,
                p.x,
                p.y,
                p.z
            ),
            format!("nodes within {} mm of the study's profile", ON_CURVE / MILLIMETRE),
            format!(
                "check the profile, the unit, {frame}; `railspring mesh` without `{}` writes a mesh in its place",
                if self.radius.is_some() { InputField::WheelMesh } else { InputField::RailMesh }
            ),
        )
    }

    /// The tensor grid of the placed nodes.
    fn tensor(&self, nodes: &[Point3<f64>], placed: &[Placed], faces: usize) -> Result<SurfaceGrid> {
        let rows = groups(placed, |p| p.s, SWEPT);
        let columns = groups(placed, |p| p.track, SWEPT / self.lever());
        let refuse = |what: String, at: usize| {
            let p = nodes[at] / MILLIMETRE;
            InputError::new(
                self.field,
                format!("{what} at ({:.3}, {:.3}, {:.3}) mm", p.x, p.y, p.z),
                "a swept grid: every row of nodes at one place of the profile, every column at one place along the \
                 track",
                "extrude the rail's section (revolve the wheel's) in layers under the contact, and name all faces of \
                 the running surface there",
            )
        };
        let expected = rows.values.len() * columns.values.len();
        let mut grid = vec![usize::MAX; expected];
        for (k, p) in placed.iter().enumerate() {
            let (row, column) = (rows.of[k], columns.of[k]);
            let middle = &placed[rows.middle[row]].section;
            if (p.section - middle).norm() > SWEPT {
                return Err(refuse(
                    "a row of nodes that does not stay at its place of the profile".into(),
                    p.node,
                )
                .into());
            }
            if (p.track - columns.values[column]).abs() * self.lever() > SWEPT {
                return Err(refuse(
                    "a column of nodes that does not stay at its place along the track".into(),
                    p.node,
                )
                .into());
            }
            let slot = &mut grid[row * columns.values.len() + column];
            if *slot != usize::MAX {
                return Err(refuse("two nodes of the same row and column".into(), p.node).into());
            }
            *slot = p.node;
        }
        if let Some(hole) = grid.iter().position(|&v| v == usize::MAX) {
            let row = hole / columns.values.len();
            let what = format!(
                "{} nodes in {} rows and {} columns; none at {} in the row of the node",
                placed.len(),
                rows.values.len(),
                columns.values.len(),
                self.shown(columns.values[hole % columns.values.len()])
            );
            return Err(refuse(what, placed[rows.middle[row]].node).into());
        }
        let cells = rows.values.len().saturating_sub(1) * columns.values.len().saturating_sub(1);
        if cells == 0 || faces != cells {
            let what = format!("{faces} outer faces on a grid with {cells} cells, whose first node is");
            return Err(refuse(what, grid[0]).into());
        }
        Ok(SurfaceGrid { along_profile: rows.values, along_track: columns.values, nodes: grid })
    }
}

/// Smallest and largest of some values.
fn extent(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// Values that fall into groups.
struct Groups {
    /// Group of every item.
    of: Vec<usize>,
    /// Item in the middle of every group.
    middle: Vec<usize>,
    /// Its value; increasing.
    values: Vec<f64>,
}

/// Groups of items whose values follow each other within `near`.
fn groups(items: &[Placed], value: impl Fn(&Placed) -> f64, near: f64) -> Groups {
    let mut order: Vec<usize> = (0..items.len()).collect();
    order.sort_by(|&a, &b| value(&items[a]).total_cmp(&value(&items[b])).then(a.cmp(&b)));
    let mut found = Groups { of: vec![0; items.len()], middle: Vec::new(), values: Vec::new() };
    for group in order.chunk_by(|&a, &b| value(&items[b]) - value(&items[a]) <= near) {
        let middle = group[group.len() / 2];
        group.iter().for_each(|&k| found.of[k] = found.middle.len());
        found.middle.push(middle);
        found.values.push(value(&items[middle]));
    }
    found
}
