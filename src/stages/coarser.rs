//! Bodies of coarser meshes beside those of a study.

use railspring_calibrate::mesh::MeshOptions;
use railspring_profiles::error::{Result, or_reason};

use super::zones::extend_zones;
use super::{Geometry, Meshes, remeshed_with};
use crate::study::Study;

/// Coarser sizes with contact zones that are longer by two of their elements, so that they hold what the others hold.
pub(super) fn with_longer_zones(geometry: &Geometry, mut coarser: MeshOptions) -> MeshOptions {
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
pub(super) fn on_coarser_meshes<T>(
    study: &Study,
    geometry: &Geometry,
    meshes: &Meshes,
    options: MeshOptions,
    make: impl FnOnce(&Meshes) -> Result<T>,
) -> Result<std::result::Result<T, String>> {
    if let Some(file) = study.rail.mesh.as_ref().or(study.wheel.mesh.as_ref()) {
        return Ok(Err(format!("{} is not meshed by the program", file.file)));
    }
    or_reason(remeshed_with(study, geometry, meshes, options).and_then(|coarser| make(&coarser)))
}
