//! The materials of a body, by the groups of its mesh.

use super::locate::Cut;
use super::material::Material;
use crate::mesh::HexMesh;
use nalgebra::{Point2, Vector3};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::field::InputField;
use railspring_profiles::units::MILLIMETRE;
use serde::Serialize;

/// Largest Poisson's ratio of a layer of one element between two other materials. Between rigid circles such
/// a layer is 0.5 % too stiff at 0.49, 2.4 % at 0.495, 26 % at 0.499 and 57 % at 0.4995. A layer of two
/// elements is 0.8, 1.5, 6 and 11 % too stiff, one of four 0.2, 0.4, 1.5 and 2.5 % (`tests/layered.rs`).
const SINGLE_LAYER: f64 = 0.49;

/// The materials of a body: one for every group of its mesh ([`HexMesh::groups`]), all with the same damping.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Materials {
    of_group: Vec<Material>,
}

impl From<Material> for Materials {
    fn from(material: Material) -> Self {
        Self { of_group: vec![material] }
    }
}

impl From<Vec<Material>> for Materials {
    fn from(of_group: Vec<Material>) -> Self {
        Self { of_group }
    }
}

impl Materials {
    /// Checks each of them, that every group of `mesh` has one, and that the damping is the same: bodies in time move in their
    /// modes, which damping in proportion to the stiffness of the whole body does not couple.
    ///
    /// # Errors
    /// [`InputError`] naming a constant that is out of range, a group without a material, or a second damping.
    pub fn check(&self, mesh: &HexMesh) -> Result<()> {
        self.of_group.iter().try_for_each(Material::check)?;
        let groups = mesh.groups.iter().max().map_or(1, |last| last + 1);
        if groups > self.of_group.len() {
            return InputError::refuse(
                "materials of a body",
                format!("{} for {groups} groups", self.of_group.len()),
                "a material for every group of the mesh",
                "give one for each",
            );
        }
        if let Some(other) = self.of_group.iter().find(|material| material.damping != self.damping()) {
            return InputError::refuse(
                "materials of a body",
                format!("dampings of {} and {} s", self.damping(), other.damping),
                "one damping for the whole body",
                "give all materials of a body the same damping",
            );
        }
        Ok(())
    }

    /// Checks that nearly incompressible groups have two elements between others, or between those and held nodes: one alone locks. `names` are those of
    /// the groups, `field` is that of the error.
    ///
    /// # Errors
    /// [`InputError`] with the place of an element by itself.
    pub fn check_layers(&self, mesh: &HexMesh, names: &[String], field: InputField) -> Result<()> {
        let nearly = self.of_group.iter().enumerate().filter(|(_, material)| material.poisson > SINGLE_LAYER);
        for (group, Material { poisson, .. }) in nearly {
            let Some(element) = mesh.single_layer(group) else { continue };
            return InputError::refuse(
                field,
                format!(
                    "one element of {:?} between others or held nodes around {}, with a Poisson's ratio of {poisson}",
                    names.get(group).map_or("", String::as_str),
                    place(mesh, element)
                ),
                format!(
                    "two elements through a layer whose Poisson's ratio is above {SINGLE_LAYER}, better four"
                ),
                "a single element locks there and is 57 % too stiff at 0.4995: mesh the layer more finely",
            );
        }
        Ok(())
    }

    /// Checks that the elements at `points` (y, z; m) of the plane x = 0 have the `material` of the beam of a rail.
    ///
    /// # Errors
    /// [`InputError`] with the place of one that has another.
    pub fn check_section(
        &self,
        mesh: &HexMesh,
        points: impl Iterator<Item = Point2<f64>>,
        material: &Material,
        names: &[String],
    ) -> Result<()> {
        let cut = Cut::new(mesh, 0.0);
        let mut elements = points.filter_map(|point| cut.element(point.x, point.y));
        let Some(other) = elements.find(|&e| self.of(mesh, e) != material) else { return Ok(()) };
        let name = names.get(mesh.group(other)).map_or("", String::as_str);
        InputError::refuse(
            InputField::RailMaterials,
            format!("{name:?} in the section of the rail, around {}", place(mesh, other)),
            "the material of the rail in the whole section: stiffness and shear stresses of the rail's beam are those of one material",
            "leave the section of that group empty, or take the elements of the rail into a group without another material",
        )
    }

    /// One for each group.
    pub fn of_groups(&self) -> &[Material] {
        &self.of_group
    }

    /// The material of an element.
    pub fn of(&self, mesh: &HexMesh, element: usize) -> &Material {
        &self.of_group[mesh.group(element)]
    }

    /// The same with a damping of the whole body, s ([`Material::damping`]).
    #[must_use]
    pub fn damped(&self, damping: f64) -> Self {
        Self { of_group: self.of_group.iter().map(|material| material.damped(damping)).collect() }
    }

    /// Damping of the whole body, s ([`Material::damping`]).
    pub fn damping(&self) -> f64 {
        self.of_group.first().map_or(0.0, |material| material.damping)
    }

    /// The material at the contact surface, which is that of all elements there ([`given_wheel`](crate::mesh::given_wheel)).
    pub fn at_contact(&self, mesh: &HexMesh) -> Material {
        *self.of(mesh, mesh.at_contact().next().unwrap_or(0))
    }
}

/// The middle of an element, mm.
fn place(mesh: &HexMesh, element: usize) -> String {
    let middle =
        mesh.hexes[element].iter().map(|&v| mesh.nodes[v].coords).sum::<Vector3<f64>>() / (8.0 * MILLIMETRE);
    format!("({:.3}, {:.3}, {:.3}) mm", middle.x, middle.y, middle.z)
}
