//! Mesh of quadrilaterals of a plane section.
//!
//! 1. Structured layers follow the fine part of the outline, by offset along its normals.
//! 2. The rest is triangulated at twice the final size, triangles are joined to
//!    quadrilaterals where that is good, and every cell is divided at the
//!    middle of its edges (a quadrilateral into four, a triangle into three
//!    quadrilaterals). So every cell becomes quadrilateral, and the layers' nodes
//!    are met because the coarse boundary takes every second of them.
//! 3. Smoothing moves the inner nodes, and those of the rest of the outline along it.
//! 4. The nodes of the rest of the outline leave it so far that the mesh has the area of the section.

use nalgebra::{Point2, Vector2};

use super::sizing::{Polyline, SizeField, thickness};
use super::smoothing::{Freedom, smooth};
use super::triangulation::{Cell, fill, pair, signed_area, smallest_sine};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::field::InputField;
use railspring_profiles::units::MILLIMETRE;

/// Turning within this length (m) makes a corner of the outline.
const CORNER_WINDOW: f64 = 4e-3;
/// Distance (m) of the points at which the sizes along the outline are set.
const SIZE_STEP: f64 = 1e-3;
/// Least width of the layers' lower side, as part of that of the surface above it: on an edge that is rounded more tightly than the
/// layers are deep, they would fold.
const LEAST_LAYER_WIDTH: f64 = 0.2;

/// Smallest scaled Jacobian that a mesh may have: a corner of 11.5 or of 168.5 degrees.
const LEAST_JACOBIAN: f64 = 0.2;

/// How far a node of the outline may slide, as part of the distance to the next.
const SLIDE: f64 = 0.4;

/// A point of the fine part of an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Position, m.
    pub point: Point2<f64>,
    /// Unit normal into the material.
    pub inward: Vector2<f64>,
    /// Arc length on the running curve, m.
    pub s: f64,
}

/// Closed outline of a section, in either sense of rotation.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionOutline {
    /// Nodes of the fine part in the order of the running curve: an even number of elements.
    pub fine: Vec<SurfacePoint>,
    /// The rest, from the last of `fine` back to the first, both included; fine
    /// vertices (0.5 mm) on curved parts.
    pub rest: Vec<Point2<f64>>,
}

/// Sizes of the elements of a section, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectionSizes {
    /// Number of structured layers, even.
    pub layers: usize,
    /// Thickness of the first layer.
    pub first_layer: f64,
    /// Ratio of the thicknesses of neighbouring layers.
    pub layer_growth: f64,
    /// Growth of the size per unit of distance from the fine part.
    pub growth: f64,
    /// Largest element.
    pub largest: f64,
    /// Edge of an element as part of the thickness of the section there.
    pub of_thickness: f64,
    /// Edge of an element as part of the radius of curvature of the outline.
    pub of_radius: f64,
}

/// Mesh of quadrilaterals of a plane section.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionMesh {
    /// Coordinates of the nodes in the profile frame, m.
    pub nodes: Vec<Point2<f64>>,
    /// Nodes of every quadrilateral, counter-clockwise with y to the right and
    /// z up (so of positive area in y and z).
    pub quads: Vec<[usize; 4]>,
    /// Nodes of the fine part in the order of the running curve.
    pub contact: Vec<usize>,
    /// Their arc length on the running curve, m.
    pub contact_s: Vec<f64>,
    /// Nodes of the closed outline, once around counter-clockwise.
    pub boundary: Vec<usize>,
}

impl SectionMesh {
    /// Area of the section, m².
    #[cfg(test)]
    fn area(&self) -> f64 {
        self.quads
            .iter()
            .map(|&[a, b, c, d]| {
                signed_area(&self.nodes[a], &self.nodes[b], &self.nodes[c])
                    + signed_area(&self.nodes[a], &self.nodes[c], &self.nodes[d])
            })
            .sum()
    }

    /// Smallest sine of a corner angle: the scaled Jacobian in the plane.
    #[must_use]
    pub fn min_scaled_jacobian(&self) -> f64 {
        self.quads.iter().map(|quad| smallest_sine(&self.nodes, quad)).fold(f64::INFINITY, f64::min)
    }
}

/// Meshes a section.
///
/// # Errors
/// When the outline crosses itself, its fine part has an odd number of elements
/// or the layers do not fit in the section; where an element is nearly flat.
pub fn mesh_section(outline: &SectionOutline, sizes: &SectionSizes) -> Result<SectionMesh> {
    let broken = |p: &Point2<f64>| !(p.x.is_finite() && p.y.is_finite());
    if let Some(p) = outline.fine.iter().map(|p| &p.point).chain(&outline.rest).find(|p| broken(p)) {
        return InputError::refuse(
            "section outline",
            format!("({}, {}) m", p.x, p.y),
            "finite coordinates",
            "repair the profile",
        );
    }
    let elements = outline.fine.len().saturating_sub(1);
    if elements < 2 || !elements.is_multiple_of(2) || outline.rest.len() < 3 {
        return InputError::refuse(
            "section outline",
            format!("{elements} elements in the fine part, {} points in the rest", outline.rest.len()),
            "an even number of elements and a rest that closes the outline",
            "choose the contact zone anew",
        );
    }
    if sizes.layers < 2 || !sizes.layers.is_multiple_of(2) {
        return InputError::refuse(
            InputField::Layers,
            sizes.layers,
            "an even number from 2 on",
            "take one layer more or less",
        );
    }
    let closed: Vec<Point2<f64>> = outline
        .fine
        .iter()
        .map(|p| p.point)
        .chain(outline.rest[1..outline.rest.len() - 1].iter().copied())
        .collect();
    let area: f64 = (1..closed.len() - 1).map(|k| signed_area(&closed[0], &closed[k], &closed[k + 1])).sum();
    if area < 0.0 {
        // Mesh the outline run through the other way, then restore the order of the running curve.
        let reversed = SectionOutline {
            fine: outline.fine.iter().rev().copied().collect(),
            rest: outline.rest.iter().rev().copied().collect(),
        };
        let mut mesh = mesh_section(&reversed, sizes)?;
        mesh.contact.reverse();
        mesh.contact_s.reverse();
        return Ok(mesh);
    }
    best_of(outline, sizes, &closed)
}

/// The mesh with the layers as thick as wanted, if that is good enough; else that of the first thinner layers which is, as they leave more room for
/// the elements below them.
///
/// # Errors
/// When none has a smallest scaled Jacobian above [`LEAST_JACOBIAN`], with the place in the best one; when no layers fit in the section.
fn best_of(outline: &SectionOutline, sizes: &SectionSizes, closed: &[Point2<f64>]) -> Result<SectionMesh> {
    /// Thickness of the layers, as part of the wanted one.
    const THINNER: [f64; 4] = [1.0, 0.7, 0.5, 0.35];
    let mut best: Option<(f64, SectionMesh)> = None;
    let mut unfit = None;
    for part in THINNER {
        let sizes = SectionSizes { first_layer: part * sizes.first_layer, ..*sizes };
        let mesh = match Builder::new(outline, &sizes, closed).build() {
            Ok(mesh) => mesh,
            Err(error) => {
                unfit = unfit.or(Some(error));
                continue;
            }
        };
        let worst = mesh.min_scaled_jacobian();
        if worst > LEAST_JACOBIAN {
            return Ok(mesh);
        }
        if best.as_ref().is_none_or(|(least, _)| worst > *least) {
            best = Some((worst, mesh));
        }
    }
    if let (None, Some(unfit)) = (&best, unfit) {
        return Err(unfit);
    }
    let place = best.and_then(|(worst, mesh)| {
        let quad = mesh.quads.iter().find(|quad| smallest_sine(&mesh.nodes, quad) <= worst)?;
        let middle = quad.iter().map(|&v| mesh.nodes[v].coords).sum::<Vector2<f64>>() / 4.0;
        let [y, z] = [middle.x, middle.y].map(|v| v / MILLIMETRE);
        Some(format!("an element of scaled Jacobian {worst:.3} at y = {y:.2}, z = {z:.2} mm of the profile"))
    });
    InputError::refuse(
        "section outline",
        place.unwrap_or_else(|| "no finite element".into()),
        format!("an outline that is filled with scaled Jacobians above {LEAST_JACOBIAN}"),
        "make the elements of the section smaller; look there for a step, a sharp corner or a narrow part of the outline",
    )
}

/// A vertex of the coarse boundary of the inner domain, with the edge that follows it.
struct CoarseVertex {
    node: usize,
    /// Node in the middle of the edge to the next vertex.
    middle: usize,
}

struct Builder<'a> {
    outline: &'a SectionOutline,
    sizes: &'a SectionSizes,
    closed: &'a [Point2<f64>],
    rest: Polyline,
    nodes: Vec<Point2<f64>>,
    freedom: Vec<Freedom>,
    quads: Vec<[usize; 4]>,
}

impl<'a> Builder<'a> {
    fn new(outline: &'a SectionOutline, sizes: &'a SectionSizes, closed: &'a [Point2<f64>]) -> Self {
        let rest = Polyline::new(&outline.rest);
        Self { outline, sizes, closed, rest, nodes: Vec::new(), freedom: Vec::new(), quads: Vec::new() }
    }

    fn add(&mut self, point: Point2<f64>, freedom: Freedom) -> usize {
        self.nodes.push(point);
        self.freedom.push(freedom);
        self.nodes.len() - 1
    }

    fn build(mut self) -> Result<SectionMesh> {
        let (columns, layers) = (self.outline.fine.len(), self.sizes.layers);
        let at = |column: usize, layer: usize| column * (layers + 1) + layer;
        self.layers();
        let size = self.size_field();

        // The inner domain, counter-clockwise: down the first column, along the
        // lowest layer, up the last column and back along the rest of the outline.
        let mut loop_nodes: Vec<usize> = (0..=layers).map(|j| at(0, j)).collect();
        loop_nodes.extend((1..columns).map(|i| at(i, layers)));
        loop_nodes.extend((0..layers).rev().map(|j| at(columns - 1, j)));
        let rest_start = loop_nodes.len() - 1;
        let rest = self.divide_rest(&size);
        loop_nodes.extend(rest);
        // Every second node of the loop is a coarse vertex, the others are middles.
        let coarse: Vec<CoarseVertex> =
            loop_nodes.chunks(2).map(|pair| CoarseVertex { node: pair[0], middle: pair[1] }).collect();

        self.inner(&coarse, &size)?;
        smooth(&mut self.nodes, &self.quads, &mut self.freedom, &self.rest);
        let rest: Vec<usize> = loop_nodes[rest_start..].iter().copied().chain([at(0, 0)]).collect();
        self.keep_area(&rest);

        let mut boundary: Vec<usize> = (0..columns).map(|i| at(i, 0)).collect();
        boundary.extend(&loop_nodes[rest_start + 1..]);
        Ok(SectionMesh {
            contact: (0..columns).map(|i| at(i, 0)).collect(),
            contact_s: self.outline.fine.iter().map(|p| p.s).collect(),
            nodes: self.nodes,
            quads: self.quads,
            boundary,
        })
    }

    /// The structured layers: node `j` of column `i` is `i * (layers + 1) + j`.
    fn layers(&mut self) {
        let mut depths: Vec<f64> = std::iter::once(0.0)
            .chain((0..self.sizes.layers).scan((0.0, self.sizes.first_layer), |(depth, step), _| {
                *depth += *step;
                *step *= self.sizes.layer_growth;
                Some(*depth)
            }))
            .collect();
        let (wanted, deepest) = (depths[depths.len() - 1], deepest_layers(&self.outline.fine));
        if wanted > deepest {
            depths.iter_mut().for_each(|depth| *depth *= deepest / wanted);
        }
        for surface in &self.outline.fine {
            for depth in &depths {
                self.nodes.push(surface.point + *depth * surface.inward);
                self.freedom.push(Freedom::Fixed);
            }
        }
        let stride = depths.len();
        for i in 0..self.outline.fine.len() - 1 {
            for j in 0..stride - 1 {
                let first = i * stride + j;
                self.quads.push([first, first + stride, first + stride + 1, first + 1]);
            }
        }
    }

    /// Sizes of the coarse mesh, so twice those of the elements.
    fn size_field(&self) -> SizeField {
        let mut field = SizeField::new(2.0 * self.sizes.growth, 2.0 * self.sizes.largest);
        // From the layers: the edges of their lower side and of their ends.
        let stride = self.sizes.layers + 1;
        let columns = self.outline.fine.len();
        for i in (0..columns - 2).step_by(2) {
            let (a, b) = (self.nodes[i * stride + stride - 1], self.nodes[(i + 2) * stride + stride - 1]);
            field.add(nalgebra::center(&a, &b), (b - a).norm());
        }
        for column in [0, columns - 1] {
            for j in (0..stride - 2).step_by(2) {
                let (a, b) = (self.nodes[column * stride + j], self.nodes[column * stride + j + 2]);
                field.add(nalgebra::center(&a, &b), (b - a).norm());
            }
        }
        // From the rest of the outline: thickness and curvature.
        let corners = self.rest.corners(CORNER_WINDOW);
        let near_corner = |t: f64| {
            t < CORNER_WINDOW
                || t > self.rest.length() - CORNER_WINDOW
                || corners.iter().any(|c| (t - c).abs() < 1.5 * CORNER_WINDOW)
        };
        let steps = (self.rest.length() / SIZE_STEP).ceil() as usize;
        for k in 0..steps {
            let t = (k as f64 + 0.5) * self.rest.length() / steps as f64;
            if near_corner(t) {
                continue;
            }
            let direction = self.rest.direction(t);
            let inward = Vector2::new(-direction.y, direction.x);
            let point = self.rest.point(t);
            let across = 2.0 * self.sizes.of_thickness * thickness(self.closed, &point, &inward);
            let turn = self.rest.turning(t - CORNER_WINDOW, t + CORNER_WINDOW).abs();
            let radius = 2.0 * CORNER_WINDOW / turn.max(1e-6);
            field.add(point, across.min(2.0 * self.sizes.of_radius * radius).max(CORNER_WINDOW));
        }
        field
    }

    /// Nodes of the rest of the outline, twice as many as coarse edges: middles
    /// and vertices in turn, without the end points. Corners become vertices.
    fn divide_rest(&mut self, size: &SizeField) -> Vec<usize> {
        let mut knots = vec![0.0];
        for corner in self.rest.corners(CORNER_WINDOW) {
            if corner > CORNER_WINDOW && corner < self.rest.length() - CORNER_WINDOW {
                knots.push(corner);
            }
        }
        knots.push(self.rest.length());
        let mut loop_nodes = Vec::new();
        for (piece, ends) in knots.windows(2).enumerate() {
            let positions = self.rest.divide(ends[0], ends[1], size);
            for (k, t) in positions.iter().enumerate().skip(1) {
                let last = k == positions.len() - 1;
                if last && piece == knots.len() - 2 {
                    break; // the first node of the layers
                }
                let freedom = if last {
                    Freedom::Corner { at: *t }
                } else {
                    let range = (t - SLIDE * (t - positions[k - 1]), t + SLIDE * (positions[k + 1] - t));
                    Freedom::Slides { at: *t, range }
                };
                let point = self.rest.point(*t);
                loop_nodes.push(self.add(point, freedom));
            }
        }
        loop_nodes
    }

    /// Moves the nodes of the `rest` of the outline, both ends included, off it, so far that their polygon has the area of the outline. With
    /// its nodes on the outline a polygon is too thick at a fillet and too thin at a rounding, and a disc bends at its
    /// fillets. Corners and the contact zone stay.
    fn keep_area(&mut self, rest: &[usize]) {
        let at = |node: usize| match self.freedom[node] {
            Freedom::Slides { at, .. } | Freedom::Corner { at } => Some(at),
            Freedom::Fixed | Freedom::Free => None,
        };
        let shift = |[before, here, after]: [usize; 3]| {
            let Freedom::Slides { at: middle, .. } = self.freedom[here] else { return None };
            let (from, to) = (at(before).unwrap_or(0.0), at(after).unwrap_or(self.rest.length()));
            let missing = self.rest.area_to_chord(from, middle) + self.rest.area_to_chord(middle, to);
            let [p, q, r] = [before, here, after].map(|node| self.nodes[node]);
            let outward = Vector2::new(r.y - p.y, p.x - r.x).normalize();
            Some((here, missing / ((q - p).norm() + (r - q).norm()) * outward))
        };
        let shifts: Vec<_> = rest.windows(3).filter_map(|w| shift([w[0], w[1], w[2]])).collect();
        for (node, shift) in shifts {
            self.nodes[node] += shift;
        }
    }

    /// Fills the inner domain.
    fn inner(&mut self, coarse: &[CoarseVertex], size: &SizeField) -> Result<()> {
        let polygon: Vec<Point2<f64>> = coarse.iter().map(|v| self.nodes[v.node]).collect();
        let triangles = fill(&polygon, size)?;
        let cells = pair(&triangles);

        let mut vertex: Vec<usize> = coarse.iter().map(|v| v.node).collect();
        for p in &triangles.points[polygon.len()..] {
            let node = self.add(*p, Freedom::Free);
            vertex.push(node);
        }
        let mut middles: std::collections::BTreeMap<(usize, usize), usize> =
            std::collections::BTreeMap::new();
        for (k, v) in coarse.iter().enumerate() {
            let next = (k + 1) % coarse.len();
            middles.insert((k.min(next), k.max(next)), v.middle);
        }
        for cell in &cells {
            let corners: &[usize] = match cell {
                Cell::Triangle(t) => t,
                Cell::Quad(q) => q,
            };
            let n = corners.len();
            let sum: Vector2<f64> = corners.iter().map(|&c| triangles.points[c].coords).sum();
            let centre = self.add(Point2::from(sum / n as f64), Freedom::Free);
            let mut middle = Vec::with_capacity(n);
            for i in 0..n {
                let (a, b) = (corners[i], corners[(i + 1) % n]);
                let key = (a.min(b), a.max(b));
                let node = match middles.get(&key) {
                    Some(&node) => node,
                    None => {
                        let node = self
                            .add(nalgebra::center(&triangles.points[a], &triangles.points[b]), Freedom::Free);
                        middles.insert(key, node);
                        node
                    }
                };
                middle.push(node);
            }
            for i in 0..n {
                self.quads.push([vertex[corners[i]], middle[i], centre, middle[(i + n - 1) % n]]);
            }
        }
        Ok(())
    }
}

/// Depth (m) down to which layers along the normals keep [`LEAST_LAYER_WIDTH`].
fn deepest_layers(fine: &[SurfacePoint]) -> f64 {
    fine.windows(2)
        .map(|pair| {
            let edge = pair[1].point - pair[0].point;
            let narrowing = -(pair[1].inward - pair[0].inward).dot(&edge) / edge.norm_squared();
            if narrowing > 0.0 { (1.0 - LEAST_LAYER_WIDTH) / narrowing } else { f64::INFINITY }
        })
        .fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests;
