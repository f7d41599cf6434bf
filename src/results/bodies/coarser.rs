//! Bodies of coarser meshes beside those of a study.

use railspring_calibrate::mesh::MeshOptions;
use railspring_calibrate::pair::{COARSER, CondensedPair};
use railspring_profiles::error::{Result, or_reason};

use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::meshes::{Meshes, remeshed_with};
use crate::results::bodies::zones::extend_zones;
use crate::study::Statics;

/// The part of a band that coarser meshes are.
pub const COARSER_MESHES: &str = "coarser meshes";

/// Coarser sizes with contact zones that are longer by two of their elements, so that they hold what the others hold.
pub(crate) fn with_longer_zones(geometry: &Geometry, mut coarser: MeshOptions) -> MeshOptions {
    for half_length in [&mut coarser.window_half_length, &mut coarser.contact_half_length] {
        *half_length += 2.0 * coarser.contact_element_along;
    }
    let longer = 2.0 * coarser.contact_element;
    extend_zones(geometry, &mut coarser, longer);
    coarser
}

/// What `make` makes of coarser meshes in the place of `meshes`, or why there is nothing.
///
/// # Errors
/// An interruption.
pub(crate) fn on_coarser_meshes<T>(
    statics: Statics<'_>,
    geometry: &Geometry,
    meshes: &Meshes,
    options: MeshOptions,
    make: impl FnOnce(&Meshes) -> Result<T>,
) -> Result<std::result::Result<T, String>> {
    if let Some(file) = statics.rail.mesh.as_ref().or(statics.wheel.mesh.as_ref()) {
        return Ok(Err(format!("{} is not meshed by the program", file.file)));
    }
    or_reason(remeshed_with(statics, geometry, meshes, options).and_then(|coarser| make(&coarser)))
}

/// Sizes of the coarser meshes. Their contact zones are longer by two of their elements, so that they hold what the others hold.
pub fn coarser_options(geometry: &Geometry, options: &MeshOptions) -> MeshOptions {
    with_longer_zones(geometry, options.refined(1.0 / COARSER))
}

/// Bodies of coarser meshes.
pub struct Coarser {
    /// Larger edge of their contact elements, m.
    pub contact_element: f64,
    /// They themselves.
    pub bodies: CondensedPair,
}

impl Coarser {
    /// Bodies of meshes whose contact elements have a larger edge of so many metres.
    pub fn new(contact_element: f64, bodies: CondensedPair) -> Self {
        Self { contact_element, bodies }
    }
}

/// The bodies of coarser meshes, which `condense` has, or why there are none.
pub type CoarserBodies = std::result::Result<Coarser, String>;

/// The bodies of meshes that are coarser than `meshes`, if the study wants bands.
///
/// # Errors
/// An interruption.
pub fn coarser_bodies(
    statics: Statics<'_>,
    geometry: &Geometry,
    meshes: &Meshes,
    condense: impl FnOnce(&Meshes) -> Result<CondensedPair>,
) -> Result<CoarserBodies> {
    let options = coarser_options(geometry, meshes.options());
    on_coarser_meshes(statics, geometry, meshes, options, |coarse| {
        Ok(Coarser { contact_element: coarse.contact_element(), bodies: condense(coarse)? })
    })
}

/// The bodies, if there are any.
pub fn bodies_of(coarser: &CoarserBodies) -> Option<&CondensedPair> {
    coarser.as_ref().ok().map(|coarser| &coarser.bodies)
}
