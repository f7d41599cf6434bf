//! The keys that put a mesh from a file in the place of the tool's own, and its materials.

use std::io::Read;
use std::path::Path;

use railspring_calibrate::solid::{Material, Materials};
use railspring_profiles::error::InputError;
use railspring_profiles::input;
use railspring_profiles::units::{GIGAPASCAL, MILLIMETRE};

use super::collect::Collector;
use super::document::{ElementKey, GroupMaterialKeys, MeshFileKeys, UnitKey};
use super::pair::MeshFile;
use super::source::MISSING;

/// Largest mesh file that is read, bytes.
const LARGEST: u64 = 16 << 30;
/// Largest Poisson's ratio of elements of full integration, which lock beyond: between rigid circles a bonded layer of rubber of four elements
/// is 0.3 % too stiff at 0.49, 5 % at 0.499 and 15 % at 0.4995 (`calibrate/tests/layered.rs`).
const LARGEST_POISSON: f64 = 0.49;

/// The keys of one body.
pub(super) struct BodyMesh<'a> {
    /// `rail` or `wheel`.
    pub section: &'static str,
    /// What the held nodes are, for messages.
    pub held_meaning: &'static str,
    pub keys: &'a MeshFileKeys,
}

impl BodyMesh<'_> {
    /// The mesh file, if there is one; `study` is the study's file.
    pub fn resolve(&self, study: &Path, collector: &mut Collector) -> Option<Option<MeshFile>> {
        let section = self.section;
        let key = |leaf: &str| format!("{section}.{leaf}");
        let Some(file) = self.keys.mesh_file.as_deref() else {
            let alone = [
                ("mesh_unit", self.keys.mesh_unit.map(|unit| format!("{:?}", unit.name()))),
                ("contact_surface", self.keys.contact_surface.as_deref().map(|name| format!("{name:?}"))),
                ("held_nodes", self.keys.held_nodes.as_deref().map(|name| format!("{name:?}"))),
            ];
            let groups =
                self.keys.materials.keys().map(|group| (format!("materials.{group}"), format!("{group:?}")));
            for (leaf, value) in groups {
                let mistake = InputError::new(
                    key(&leaf),
                    value,
                    format!("{section}.mesh_file beside it"),
                    "the key names a group of a mesh from a file: give the file, or remove the key",
                );
                collector.add(&[&key("mesh_file")], mistake);
            }
            for (leaf, value) in alone.into_iter().filter_map(|(leaf, value)| Some((leaf, value?))) {
                let mistake = InputError::new(
                    key(leaf),
                    value,
                    format!("{section}.mesh_file beside it"),
                    "the key belongs to a mesh from a file: give the file, or remove the key",
                );
                collector.add(&[&key("mesh_file")], mistake);
            }
            return Some(None);
        };
        let named = |name: Option<&str>, leaf: &str, meaning: &str| {
            name.map(str::to_owned).ok_or_else(|| {
                InputError::new(
                    key(leaf),
                    MISSING,
                    "a text in quotes",
                    format!("add this key to [{section}]: {meaning}"),
                )
            })
        };
        let contact = named(
            self.keys.contact_surface.as_deref(),
            "contact_surface",
            "the running surface's name in the mesh file",
        );
        let contact = collector.take(&[&key("contact_surface")], contact);
        let held = collector.take(
            &[&key("held_nodes")],
            named(self.keys.held_nodes.as_deref(), "held_nodes", self.held_meaning),
        );
        let path = study.parent().unwrap_or(Path::new("")).join(file);
        let hash = hash(&path).map_err(|cause| {
            InputError::new(
                key("mesh_file"),
                format!("{file:?}"),
                format!("a readable file; {}: {cause}", path.display()),
                "give its path relative to the study",
            )
        });
        let hash = collector.take(&[&key("mesh_file")], hash);
        let unit = self.keys.mesh_unit.map_or(MILLIMETRE, UnitKey::metres);
        Some(Some(MeshFile {
            file: file.to_owned(),
            path,
            hash: hash?,
            unit,
            contact: contact?,
            held: held?,
            groups: self.keys.materials.keys().cloned().collect(),
        }))
    }

    /// The materials of the body in the order of its groups; without any, that `of_body`.
    pub fn materials(
        &self,
        of_body: &Material,
        element: ElementKey,
        collector: &mut Collector,
    ) -> Option<Materials> {
        if self.keys.materials.is_empty() {
            return Some((*of_body).into());
        }
        let mut found = Vec::new();
        for (group, keys) in &self.keys.materials {
            let here = format!("{}.materials.{group}", self.section);
            let material = group_material(&here, keys, of_body, element);
            let own = format!("{}.material.*", self.section);
            let reads = [&format!("{here}.*"), &own, "material.*", "mesh.element"];
            found.extend(collector.take(&reads, material));
        }
        (found.len() == self.keys.materials.len()).then(|| found.into())
    }
}

/// The material of the group whose keys stand in the section `here`.
fn group_material(
    here: &str,
    keys: &GroupMaterialKeys,
    of_body: &Material,
    element: ElementKey,
) -> Result<Material, InputError> {
    let GroupMaterialKeys { young_gpa, poisson, density_kg_per_m3 } = keys;
    let (young, poisson, density) = match (young_gpa, poisson, density_kg_per_m3) {
        (None, None, None) => (of_body.young, of_body.poisson, of_body.density),
        (Some(young), Some(poisson), Some(density)) => (young * GIGAPASCAL, *poisson, *density),
        _ => {
            let all = [
                ("young_gpa", young_gpa.is_none()),
                ("poisson", poisson.is_none()),
                ("density_kg_per_m3", density_kg_per_m3.is_none()),
            ];
            let missing = all.into_iter().find_map(|(leaf, missing)| missing.then_some(leaf)).unwrap_or("");
            return Err(InputError::new(
                format!("{here}.{missing}"),
                MISSING,
                "a number",
                format!("add this key to [{here}], or leave the section empty for the material of the body"),
            ));
        }
    };
    if poisson > LARGEST_POISSON && element == ElementKey::FullIntegration {
        return Err(InputError::new(
            format!("{here}.poisson"),
            poisson,
            format!(
                "a ratio up to {LARGEST_POISSON} with mesh.element = \"full-integration\", whose elements lock beyond"
            ),
            "set mesh.element = \"incompatible-modes\", which takes up to 0.4995, or a smaller ratio",
        ));
    }
    Ok(Material { young, poisson, density, damping: of_body.damping })
}

impl MeshFile {
    /// Whether the file is still the one that the study was read with.
    pub fn is_unchanged(&self) -> bool {
        hash(&self.path).is_ok_and(|now| now == self.hash)
    }
}

/// Hash of a file's content; meshes can be large, so it is read piece by piece.
fn hash(path: &Path) -> std::io::Result<String> {
    let mut file = input::open(path, LARGEST)?;
    let mut hasher = blake3::Hasher::new();
    let mut piece = vec![0; 1 << 16];
    loop {
        match file.read(&mut piece)? {
            0 => return Ok(hasher.finalize().to_hex().to_string()),
            read => hasher.update(&piece[..read]),
        };
    }
}
