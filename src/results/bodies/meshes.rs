//! The meshes of both bodies.

use std::path::Path;

use railspring_calibrate::mesh::{HexMesh, MeshOptions, mesh_rail, mesh_wheel};
use railspring_calibrate::pair::Orders;
use railspring_profiles::error::Result;
use railspring_profiles::monitor::Monitor;

use super::geometry::Geometry;
use super::mesh_files;
use crate::study::{MeshFile, Statics};

/// Ratio of the elements of meshes to those of the next finer ones.
pub const FINER: f64 = std::f64::consts::SQRT_2;

/// The meshes of both bodies.
#[derive(Clone)]
pub struct Meshes {
    /// The rail, in the world frame.
    pub rail: HexMesh,
    /// The wheel, in its body frame.
    pub wheel: HexMesh,
    /// Edge of the elements in the contact zone across the track, of the rail and of the wheel, m: what the study asks
    /// for, or the longest of a mesh from a file.
    pub contact_elements: [f64; 2],
    /// Sizes and contact zones of the tool's own meshes.
    pub(crate) options: MeshOptions,
    /// Orders of the equations on them.
    pub(crate) orders: Orders,
}

/// Meshes of both bodies: the tool's own with `options`, or those of the study's mesh files, which `interpreter` reads
/// (`None`: the Python of the cache folder) within `memory`, bytes. Without mesh files no Python is needed.
///
/// # Errors
/// Settings that give an inverted or flat element; a missing Python, and mesh files that cannot be used.
pub fn meshes(
    statics: Statics<'_>,
    geometry: &Geometry,
    options: MeshOptions,
    (interpreter, memory): (Option<&Path>, Option<f64>),
    monitor: &dyn Monitor,
) -> Result<Meshes> {
    let mut files = mesh_files::Files::new(interpreter, memory, monitor);
    let rail =
        statics.rail.mesh.as_ref().map(|file| files.rail(file, statics, geometry, &options)).transpose()?;
    let wheel =
        statics.wheel.mesh.as_ref().map(|file| files.wheel(file, statics, geometry, &options)).transpose()?;
    Meshes::with_own(statics, geometry, rail, wheel, options)
}

/// The same with given sizes and zones.
///
/// # Errors
/// As [`meshes`].
pub fn remeshed_with(
    statics: Statics<'_>,
    geometry: &Geometry,
    meshes: &Meshes,
    options: MeshOptions,
) -> Result<Meshes> {
    let kept = |file: &Option<MeshFile>, mesh: &HexMesh| file.as_ref().map(|_| mesh.clone());
    let (rail, wheel) = (kept(&statics.rail.mesh, &meshes.rail), kept(&statics.wheel.mesh, &meshes.wheel));
    Meshes::with_own(statics, geometry, rail, wheel, options)
}

impl Meshes {
    /// The given meshes, and the tool's own where there is none.
    pub(crate) fn with_own(
        statics: Statics<'_>,
        geometry: &Geometry,
        rail: Option<HexMesh>,
        wheel: Option<HexMesh>,
        options: MeshOptions,
    ) -> Result<Self> {
        let edge = |given: &Option<HexMesh>| {
            given.as_ref().map_or(options.contact_element, |mesh| mesh.contact.longest_across())
        };
        let contact_elements = [edge(&rail), edge(&wheel)];
        let own_rail =
            || mesh_rail(&geometry.pair.rail, &geometry.pair.placed, statics.rail.length, &options);
        let own_wheel = || mesh_wheel(&geometry.pair.wheel, &options);
        let (rail, wheel) =
            rayon::join(|| rail.map_or_else(own_rail, Ok), || wheel.map_or_else(own_wheel, Ok));
        Ok(Self { rail: rail?, wheel: wheel?, contact_elements, options, orders: Orders::default() })
    }

    /// Sizes and contact zones of the tool's own meshes.
    pub fn options(&self) -> &MeshOptions {
        &self.options
    }

    /// Times that the study's sizes were refined for these meshes.
    pub fn refinements(&self, wanted: &MeshOptions) -> u32 {
        let times = (wanted.contact_element / self.options.contact_element).ln() / FINER.ln();
        times.round().max(0.0) as u32
    }

    /// The larger edge of the two, m.
    pub fn contact_element(&self) -> f64 {
        self.contact_elements[0].max(self.contact_elements[1])
    }
}
