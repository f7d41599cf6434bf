//! Meshes of 8-node hexahedra of a rail, a wheel and a test block, graded
//! towards the contact zone.
//!
//! A plane section is meshed with quadrilaterals (`SectionMesh`) and swept:
//! the rail along the track, the wheel about its axle. Under the contact zone
//! lie structured layers that follow the running surface; below them the
//! elements grow towards the coarse sizes of [`MeshOptions`].
//!
//! ```text
//!   section (y right, z down)            sweep (x, or arc length at the tread)
//!      ooooooooooo  contact zone         |    |  | |||||||| |  |    |
//!     /-+-+-+-+-+-\ layers                  growth   window   growth
//!     \ /\_/\_/\_ /
//!      |         |  grows to the coarse size
//! ```
//!
//! The same input gives the same mesh to the last bit: every choice between
//! equals is settled by index order.

use serde::Serialize;
use std::collections::BTreeMap;

use nalgebra::{Point2, Point3};

use railspring_profiles::error::{InputError, Result};
use railspring_profiles::field::InputField;

mod faces;
mod quality;
mod sizing;
mod triangulation;
mod smoothing;
mod section_mesh;
mod sweep;
mod block;
mod bodies;
mod given_surface;
mod given;
mod vtu;

pub use block::{BlockOptions, mesh_block};
pub use bodies::{
    MeshSize, mesh_even_rail, mesh_rail, mesh_rail_between, mesh_rail_path, mesh_wheel,
    rail_grid_half_length, rail_outline, rail_size, wheel_outline, wheel_size,
};
pub use given::{GivenMesh, given_rail, given_wheel};
pub(crate) use quality::CORNERS;
pub use quality::{Quality, quality};
pub(crate) use section_mesh::{SectionMesh, SectionSizes, mesh_section};
pub use section_mesh::{SectionOutline, SurfacePoint};
pub use vtu::{Cells, Field, pvd, vtu};

/// Tensor grid of the surface nodes in which contact can take place.
///
/// Node `(i, k)`, at `along_profile[i]` and `along_track[k]`, is
/// `nodes[i * along_track.len() + k]`.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceGrid {
    /// Arc length on the running curve, increasing, m.
    pub along_profile: Vec<f64>,
    /// Position along the track, increasing: x in m for a rail or a block,
    /// the angle θ from straight down in rad for a wheel.
    pub along_track: Vec<f64>,
    /// Node of the mesh at every grid point.
    pub nodes: Vec<usize>,
}

impl SurfaceGrid {
    /// Node at grid point `(i, k)`: `i` along the profile, `k` along the track.
    #[must_use]
    pub fn node(&self, i: usize, k: usize) -> usize {
        self.nodes[i * self.along_track.len() + k]
    }

    /// Longest distance of neighbouring nodes along the profile, m.
    #[must_use]
    pub fn longest_across(&self) -> f64 {
        self.along_profile.windows(2).map(|s| s[1] - s[0]).fold(0.0, f64::max)
    }
}

/// A body of 8-node hexahedra.
#[derive(Debug, Clone, PartialEq)]
pub struct HexMesh {
    /// Coordinates of the nodes, m.
    pub nodes: Vec<Point3<f64>>,
    /// Nodes of every hexahedron in the order of VTK: the face 0-1-2-3 seen
    /// from inside runs counter-clockwise, 4-7 lie above it; the Jacobian is positive.
    pub hexes: Vec<[usize; 8]>,
    /// Group of every hexahedron, by its number among the materials of the body; empty where all are of one.
    pub groups: Vec<usize>,
    /// Nodes where contact can take place.
    pub contact: SurfaceGrid,
    /// Nodes of both end faces of a rail, or of the sides of a block; empty for a wheel.
    pub ends: Vec<usize>,
    /// Nodes on the bottom of a rail's foot or of a block; empty for a wheel.
    pub foot: Vec<usize>,
    /// Nodes on the bore of a wheel; empty for the other bodies.
    pub bore: Vec<usize>,
}

impl HexMesh {
    /// Group of a hexahedron.
    #[must_use]
    pub fn group(&self, element: usize) -> usize {
        self.groups.get(element).copied().unwrap_or(0)
    }

    /// The mesh whose groups share no node, and the node of this mesh that each of them is: what jumps from group to group,
    /// stresses for instance, has a value for each of them there.
    #[must_use]
    pub fn with_groups_apart(&self) -> (Self, Vec<usize>) {
        if self.groups.is_empty() {
            return (self.clone(), (0..self.nodes.len()).collect());
        }
        let mut known: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        let mut owner = vec![None; self.nodes.len()];
        let mut of: Vec<usize> = (0..self.nodes.len()).collect();
        let mut hexes = self.hexes.clone();
        for (e, hex) in hexes.iter_mut().enumerate() {
            let group = self.group(e);
            for v in hex {
                let node = *v;
                if *owner[node].get_or_insert(group) != group {
                    *v = *known.entry((group, node)).or_insert_with(|| {
                        of.push(node);
                        of.len() - 1
                    });
                }
            }
        }
        let nodes = of.iter().map(|&node| self.nodes[node]).collect();
        (Self { nodes, hexes, ..self.clone() }, of)
    }

    /// A hexahedron of a group that is the only one between two other groups, or between one and the nodes at the bore or the foot: it meets
    /// them at opposite faces.
    pub(crate) fn single_layer(&self, group: usize) -> Option<usize> {
        let mut rigid = vec![false; self.nodes.len()];
        self.bore.iter().chain(&self.foot).for_each(|&v| rigid[v] = true);
        faces::single_layer(&self.hexes, |e| self.group(e), &rigid, group)
    }

    /// Hexahedra with a corner on the contact surface.
    pub(crate) fn at_contact(&self) -> impl Iterator<Item = usize> + '_ {
        let mut marked = vec![false; self.nodes.len()];
        self.contact.nodes.iter().for_each(|&v| marked[v] = true);
        (0..self.hexes.len()).filter(move |&e| self.hexes[e].iter().any(|&v| marked[v]))
    }
}

/// Where the contact zone of a section begins and ends, in its profile frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ContactZone {
    /// Depth of the zone's end on the gauge face (rail: below the top) or on the
    /// flange face (wheel: below the tape circle's level), m.
    pub face_depth: f64,
    /// Lateral coordinate y of the zone's end towards the field side, m.
    pub field_y: f64,
}

/// Sizes of the elements. All lengths in m.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshOptions {
    /// Largest edge of an element in the contact zone across the track.
    pub contact_element: f64,
    /// Edge of an element of the contact window along the track. Patches are shorter along the track
    /// than across it on conformal profiles, so that finer elements pay off here.
    pub contact_element_along: f64,
    /// Half the length of the contact window along the track, within which the elements are equally long.
    pub window_half_length: f64,
    /// Half the length of the contact grid along the track; it is at least that of the window. What lies beyond the window has the growing
    /// elements there, up to the first line at that distance: enough for the bodies under a contact on a fine grid, too coarse for one
    /// between the nodes.
    pub contact_half_length: f64,
    /// Number of structured layers under the contact zone, even; none: as many as it takes down to 4 mm.
    pub layers: Option<usize>,
    /// Thickness of the first layer; none: that of the contact element, 2 mm at most.
    pub first_layer: Option<f64>,
    /// Ratio of the thicknesses of neighbouring layers.
    pub layer_growth: f64,
    /// Contact zone of a rail.
    pub rail_zone: ContactZone,
    /// Contact zone of a wheel.
    pub wheel_zone: ContactZone,
    /// Growth of the element size in the section per unit of distance from the
    /// contact zone; below about 0.1 the section fills with fine elements.
    pub section_growth: f64,
    /// Largest element of a rail's section.
    pub rail_section_element: f64,
    /// Largest element of a wheel's section.
    pub wheel_section_element: f64,
    /// Ratio of the lengths of neighbouring elements along the sweep, outside the window.
    pub growth: f64,
    /// Longest element along the rail.
    pub rail_length_element: f64,
    /// Longest element around the wheel, as arc length at the tape circle.
    pub wheel_arc_element: f64,
}

impl Default for MeshOptions {
    fn default() -> Self {
        Self {
            contact_element: 2e-3,
            contact_element_along: 1.5e-3,
            window_half_length: 12e-3,
            contact_half_length: 0.0,
            layers: None,
            first_layer: None,
            layer_growth: 1.25,
            rail_zone: ContactZone { face_depth: 20e-3, field_y: 22e-3 },
            wheel_zone: ContactZone { face_depth: 21e-3, field_y: 32e-3 },
            section_growth: 0.3,
            rail_section_element: 12e-3,
            wheel_section_element: 20e-3,
            growth: 1.6,
            rail_length_element: 40e-3,
            wheel_arc_element: 120e-3,
        }
    }
}

impl MeshOptions {
    /// The same mesh with every element smaller by `factor` (> 1 refines), for
    /// convergence studies. The contact zones and the window keep their extent.
    #[must_use]
    pub fn refined(&self, factor: f64) -> Self {
        let (layers, first_layer, layer_growth) = if (self.layers, self.first_layer) == (None, None) {
            (None, None, self.layer_growth.powf(1.0 / factor).min(LARGEST_RATIO))
        } else {
            // an even number of layers of the same total thickness
            let (layers, first) = self.layering();
            let more = 2 * ((layers as f64 * factor / 2.0).round() as usize).max(1);
            let growth = self.layer_growth.powf(layers as f64 / more as f64);
            let depth = layer_depth(first, self.layer_growth, layers);
            (Some(more), Some(depth / layer_depth(1.0, growth, more)), growth)
        };
        Self {
            contact_element: self.contact_element / factor,
            contact_element_along: self.contact_element_along / factor,
            layers,
            first_layer,
            layer_growth,
            ..self.with_bodies_refined(factor)
        }
    }
}

impl MeshOptions {
    /// Structured layers under the contact zone: their number, and the thickness of the first, m. Where they are not given they
    /// follow from the contact element, so that the far field of the bodies converges with it: elements as high as wide, down to
    /// where a patch no longer bends the stresses much within an element.
    #[must_use]
    pub fn layering(&self) -> (usize, f64) {
        let first = self.first_layer.unwrap_or(self.contact_element.min(LARGEST_FIRST_LAYER));
        let deep = |layers: &usize| layer_depth(first, self.layer_growth, *layers) >= LEAST_DEPTH;
        let layers = self.layers.or_else(|| (2..=MOST_LAYERS).step_by(2).find(deep));
        (layers.unwrap_or(MOST_LAYERS), first)
    }

    /// Sizes of a section whose largest element is `largest`.
    #[must_use]
    pub(crate) fn sizes(&self, largest: f64) -> SectionSizes {
        let (layers, first_layer) = self.layering();
        SectionSizes {
            layers,
            first_layer,
            layer_growth: self.layer_growth,
            growth: self.section_growth,
            largest,
        }
    }

    /// Refuses values no mesh can be made with.
    fn check(&self) -> Result<()> {
        let lengths = [
            (InputField::ContactElement, self.contact_element),
            (InputField::ContactElementAlong, self.contact_element_along),
            (InputField::WindowHalfLength, self.window_half_length),
            (InputField::FirstLayer, self.layering().1),
            (InputField::RailSectionElement, self.rail_section_element),
            (InputField::WheelSectionElement, self.wheel_section_element),
            (InputField::RailLengthElement, self.rail_length_element),
            (InputField::WheelArcElement, self.wheel_arc_element),
        ];
        for (field, length) in lengths {
            if !(length.is_finite() && length >= SMALLEST_ELEMENT) {
                return Err(InputError::new(
                    field,
                    format!("{} mm", length * 1e3),
                    format!("{} mm or more", SMALLEST_ELEMENT * 1e3),
                    "check the size of the elements and its unit",
                )
                .into());
            }
        }
        let ratios = [
            (InputField::LayerGrowth, self.layer_growth, 1.0),
            (InputField::Growth, self.growth, 1.0),
            (InputField::SectionGrowth, self.section_growth, 0.05),
        ];
        for (field, ratio, least) in ratios {
            if !(ratio.is_finite() && ratio >= least && ratio <= LARGEST_RATIO) {
                return Err(InputError::new(
                    field,
                    ratio,
                    format!("a number from {least} to {LARGEST_RATIO}"),
                    "elements grow away from the contact zone",
                )
                .into());
            }
        }
        Ok(())
    }
}

/// Thickness of all layers, m.
fn layer_depth(first: f64, growth: f64, layers: usize) -> f64 {
    first * (0..layers).map(|i| growth.powi(i as i32)).sum::<f64>()
}

/// Largest thickness of a first layer that follows from the contact element, m.
const LARGEST_FIRST_LAYER: f64 = 2e-3;
/// Least depth of layers whose number follows, m: two layers under elements of 2 mm are 4.5 mm.
const LEAST_DEPTH: f64 = 4e-3;
/// More layers do not follow: the smallest elements that are accepted need as many.
const MOST_LAYERS: usize = 80;
/// Largest growth accepted.
const LARGEST_RATIO: f64 = 4.0;
/// Smallest length (m) accepted as a size: below it the number of nodes goes beyond all bounds.
const SMALLEST_ELEMENT: f64 = 5e-5;

/// Signed area of the triangle `a`, `b`, `c`: positive when counter-clockwise
/// with the first coordinate to the right and the second up.
fn signed_area(a: &Point2<f64>, b: &Point2<f64>, c: &Point2<f64>) -> f64 {
    0.5 * (b - a).perp(&(c - a))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: number of layers and thickness of the first, m, of some contact elements. Under 2 mm and more they are those that the
    /// kept comparisons were made with; what is given stays, and the other follows from it; a refined mesh has the layers of its
    /// own elements, or those given, divided, of the same depth. Accuracy: ROUNDOFF.
    #[test]
    fn the_layers_follow_from_the_contact_element() {
        const ROUNDOFF: f64 = 1e-15;
        let of = |contact_element: f64| MeshOptions { contact_element, ..MeshOptions::default() };
        for (element, layers, first) in
            [(6e-3, 2, 2e-3), (2e-3, 2, 2e-3), (1.4e-3, 4, 1.4e-3), (0.7e-3, 4, 0.7e-3), (0.5e-3, 6, 0.5e-3)]
        {
            assert_eq!(of(element).layering(), (layers, first), "{element} m");
        }
        assert_eq!(MeshOptions { layers: Some(6), ..of(1.4e-3) }.layering(), (6, 1.4e-3));
        assert_eq!(MeshOptions { first_layer: Some(1e-3), ..of(2e-3) }.layering(), (4, 1e-3));
        assert_eq!(of(2e-3).refined(2.0).layering(), (4, 1e-3));
        assert_eq!(of(2e-3).refined(0.5).layering(), (2, 2e-3));
        let given = MeshOptions { layers: Some(2), first_layer: Some(2e-3), ..of(2e-3) };
        let fine = given.refined(2.0);
        let depth = |options: &MeshOptions| {
            let (layers, first) = options.layering();
            layer_depth(first, options.layer_growth, layers)
        };
        // no element grows faster than is accepted
        assert!(given.refined(0.2).check().is_ok());
        assert_eq!(fine.layers, Some(4));
        assert!((depth(&fine) - depth(&given)).abs() < ROUNDOFF, "{fine:?}");
        // no size makes an endless list
        for element in [0.0, f64::NAN, f64::INFINITY, -1.0] {
            assert!(of(element).layering().0 <= MOST_LAYERS);
        }
    }
}
