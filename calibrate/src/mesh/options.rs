//! Sizes of the elements of a mesh, and where its contact zone lies.

use super::section_mesh::SectionSizes;
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::field::InputField;
use serde::Serialize;

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
    /// Largest element of a rail's section; those over its web and on its fillets are smaller in proportion.
    pub rail_section_element: f64,
    /// Largest element of a wheel's section; those over its disc and on its fillets are smaller in proportion.
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
            rail_section_element: RAIL_SECTION_ELEMENT,
            wheel_section_element: WHEEL_SECTION_ELEMENT,
            growth: 1.6,
            rail_length_element: 20e-3,
            wheel_arc_element: 60e-3,
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

    /// Sizes of a rail's section.
    pub(crate) fn rail_sizes(&self) -> SectionSizes {
        self.sizes(self.rail_section_element, self.rail_section_element / RAIL_SECTION_ELEMENT, LARGEST_PARTS)
    }

    /// Sizes of a wheel's section: finer over its disc and on its fillets, whose bending is most of the lateral
    /// flexibility of a wheel.
    pub(crate) fn wheel_sizes(&self) -> SectionSizes {
        self.sizes(self.wheel_section_element, self.wheel_section_element / WHEEL_SECTION_ELEMENT, [0.2, 0.1])
    }

    /// The `parts` of thickness and radius go along with the elements, by `factor`, up to [`LARGEST_PARTS`].
    fn sizes(&self, largest: f64, factor: f64, parts: [f64; 2]) -> SectionSizes {
        let (layers, first_layer) = self.layering();
        SectionSizes {
            layers,
            first_layer,
            layer_growth: self.layer_growth,
            growth: self.section_growth,
            largest,
            of_thickness: (factor * parts[0]).min(LARGEST_PARTS[0]),
            of_radius: (factor * parts[1]).min(LARGEST_PARTS[1]),
        }
    }

    /// The same contact zone with bodies whose elements are smaller by `factor` (> 1 refines): the largest elements, and what
    /// elements grow by along the sweep. In the section they grow away from the zone as before.
    #[must_use]
    pub fn with_bodies_refined(&self, factor: f64) -> Self {
        Self {
            rail_section_element: self.rail_section_element / factor,
            wheel_section_element: self.wheel_section_element / factor,
            growth: self.growth.powf(1.0 / factor).min(LARGEST_RATIO),
            rail_length_element: self.rail_length_element / factor,
            wheel_arc_element: self.wheel_arc_element / factor,
            ..self.clone()
        }
    }

    /// Refuses values no mesh can be made with.
    pub(super) fn check(&self) -> Result<()> {
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
                return InputError::refuse(
                    field,
                    format!("{} mm", length * 1e3),
                    format!("{} mm or more", SMALLEST_ELEMENT * 1e3),
                    "check the size of the elements and its unit",
                );
            }
        }
        let (layers, first) = self.layering();
        let depth = layer_depth(first, self.layer_growth, layers);
        if depth.is_nan() || depth > LARGEST_LAYERED {
            return InputError::refuse(
                if self.layers.is_some() { InputField::Layers } else { InputField::FirstLayer },
                format!("{layers} layers, the first {} mm, together {:.3e} mm", first * 1e3, depth * 1e3),
                format!(
                    "layers of {} mm together at most: heads and rims have no more room",
                    LARGEST_LAYERED * 1e3
                ),
                format!(
                    "take fewer `{}`, a smaller `{}` or less `{}`",
                    InputField::Layers,
                    InputField::FirstLayer,
                    InputField::LayerGrowth
                ),
            );
        }
        let ratios = [
            (InputField::LayerGrowth, self.layer_growth, 1.0),
            (InputField::Growth, self.growth, 1.0),
            (InputField::SectionGrowth, self.section_growth, 0.05),
        ];
        for (field, ratio, least) in ratios {
            if !(ratio.is_finite() && ratio >= least && ratio <= LARGEST_RATIO) {
                return InputError::refuse(
                    field,
                    ratio,
                    format!("a number from {least} to {LARGEST_RATIO}"),
                    "elements grow away from the contact zone",
                );
            }
        }
        Ok(())
    }
}

/// Thickness of all layers, m.
fn layer_depth(first: f64, growth: f64, layers: usize) -> f64 {
    first * (0..layers).map(|i| growth.powi(i as i32)).sum::<f64>()
}

/// Usual largest element of a rail's section, m.
const RAIL_SECTION_ELEMENT: f64 = 12e-3;
/// Usual largest element of a wheel's section, m.
const WHEEL_SECTION_ELEMENT: f64 = 10e-3;
/// Largest parts of thickness and radius that an element may have: two elements over the thickness, and eight on a half
/// circle.
const LARGEST_PARTS: [f64; 2] = [0.575, 0.4];
/// Largest thickness of a first layer that follows from the contact element, m.
const LARGEST_FIRST_LAYER: f64 = 2e-3;
/// Least depth of layers whose number follows, m: two layers under elements of 2 mm are 4.5 mm.
const LEAST_DEPTH: f64 = 4e-3;
/// Largest depth of the layers, m: a head is 30 to 50 mm high, and a rim as thick where it is worn.
const LARGEST_LAYERED: f64 = 30e-3;
/// More layers do not follow: the smallest elements that are accepted need as many.
const MOST_LAYERS: usize = 80;
/// Largest growth accepted.
const LARGEST_RATIO: f64 = 4.0;
/// Smallest length (m) accepted as a size: below it the number of nodes goes beyond all bounds.
const SMALLEST_ELEMENT: f64 = 5e-5;

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

    /// Goal: bodies that are refined by two have edges half as long and, over the same distance, twice as many steps of the growth; contact
    /// zone, window, layers and the growth from the zone stay; by one, nothing changes. Accuracy: ROUNDOFF.
    #[test]
    fn refined_bodies_keep_the_contact_zone() {
        /// Rounding of floating-point arithmetic on lengths of order one.
        const ROUNDOFF: f64 = 1e-12;
        let given = MeshOptions::default();
        assert_eq!(given.with_bodies_refined(1.0), given);
        let fine = given.with_bodies_refined(2.0);
        assert!((fine.growth.powi(2) - given.growth).abs() < ROUNDOFF);
        for (fine, given) in [
            (fine.rail_section_element, given.rail_section_element),
            (fine.wheel_section_element, given.wheel_section_element),
            (fine.rail_length_element, given.rail_length_element),
            (fine.wheel_arc_element, given.wheel_arc_element),
        ] {
            assert!((2.0 * fine - given).abs() < ROUNDOFF);
        }
        assert_eq!(
            MeshOptions {
                growth: given.growth,
                rail_section_element: given.rail_section_element,
                wheel_section_element: given.wheel_section_element,
                rail_length_element: given.rail_length_element,
                wheel_arc_element: given.wheel_arc_element,
                ..fine
            },
            given
        );
    }
}
