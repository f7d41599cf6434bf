//! What is kept of a factored body: small, owned, and able to travel.

use super::times;
use crate::error::{InputError, Result};
use crate::mesh::{HexMesh, SurfaceGrid};
use crate::solid::{Formulation, Material, Supports, System};
use crate::superelement::{Factor, Superelement};
use blake3::Hasher;
use faer::Mat;
use nalgebra::Point3;
use safetensors::tensor::{Dtype, SafeTensors, TensorView, serialize};
use std::collections::HashMap;

/// A body reduced to its contact nodes. It borrows nothing, so that it outlives mesh and factor, and it can be written
/// and read ([`CondensedBody::write`]).
#[derive(Debug, Clone, PartialEq)]
pub struct CondensedBody {
    /// Hash of what made it: [`body_key`].
    pub key: String,
    /// Compliance of the retained equations, m/N: contact nodes (`3·node + direction` in the order of the contact
    /// grid), then the free motions of a master node.
    pub compliance: Mat<f64>,
    /// The grid of the contact nodes on the profile; its node numbers are those of the mesh.
    pub grid: SurfaceGrid,
    /// Positions of the contact nodes in the order of the grid, m.
    pub nodes: Vec<Point3<f64>>,
    /// Equations of the body before it was condensed.
    pub equations: usize,
    /// Mass of its elements, kg.
    pub mass: f64,
}

/// The inside of a condensed body, which only fields need: it borrows the mesh and holds the factor.
pub struct Interior<'a> {
    /// The body.
    pub system: System<'a>,
    factor: Factor,
}

/// Hash of everything that a condensed body depends on: mesh, material, element and supports.
pub fn body_key(mesh: &HexMesh, material: &Material, element: Formulation, supports: &Supports) -> String {
    let mut hasher = Hasher::new();
    hasher.update(b"condensed body 1");
    let mut numbers = |values: &[f64]| {
        hasher.update(&(values.len() as u64).to_le_bytes());
        values.iter().for_each(|v| {
            hasher.update(&v.to_le_bytes());
        });
    };
    mesh.nodes.iter().for_each(|p| numbers(p.coords.as_slice()));
    numbers(&mesh.contact.along_profile);
    numbers(&mesh.contact.along_track);
    numbers(&[material.young, material.poisson, material.density]);
    let mut indices = |values: &[usize]| {
        hasher.update(&(values.len() as u64).to_le_bytes());
        values.iter().for_each(|v| {
            hasher.update(&(*v as u64).to_le_bytes());
        });
    };
    mesh.hexes.iter().for_each(|hex| indices(hex));
    indices(&mesh.contact.nodes);
    hasher.update(format!("{element:?} {supports:?}").as_bytes());
    hasher.finalize().to_hex().to_string()
}

impl<'a> Superelement<'a> {
    /// Separates what the contact needs from what only fields inside the body need. `key` is that of the body
    /// ([`body_key`]).
    pub fn split(self, key: String) -> (CondensedBody, Interior<'a>) {
        let Self { system, factor, compliance } = self;
        let mesh = system.mesh;
        let body = CondensedBody {
            key,
            compliance,
            grid: mesh.contact.clone(),
            nodes: mesh.contact.nodes.iter().map(|&n| mesh.nodes[n]).collect(),
            equations: system.numbering.equations,
            mass: system.nodal_mass().total(),
        };
        (body, Interior { system, factor })
    }
}

impl Interior<'_> {
    /// Displacements of all nodes (`3·node + direction`, m) under forces on the retained equations of `body` (N).
    pub fn displacement(&self, body: &CondensedBody, retained_forces: &[f64]) -> Vec<f64> {
        let retained = times(&body.compliance, retained_forces);
        super::interior_displacement(&self.system, &self.factor, &retained)
    }
}

/// Layout of the file.
const FORMAT: &str = "railspring condensed body 1";

impl CondensedBody {
    /// The body as a file in the safetensors format, which other languages read, too: tensors `compliance`
    /// (column by column), `nodes`, `along_profile`, `along_track` and `node_numbers`, and the rest as metadata.
    ///
    /// # Panics
    /// Never: the shapes are those of the data.
    pub fn write(&self) -> Vec<u8> {
        let size = self.compliance.nrows();
        let compliance: Vec<f64> =
            (0..size).flat_map(|column| self.compliance.col_as_slice(column).iter().copied()).collect();
        let nodes: Vec<f64> = self.nodes.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
        let reals = [
            ("compliance", compliance, vec![size, size]),
            ("nodes", nodes, vec![self.nodes.len(), 3]),
            ("along_profile", self.grid.along_profile.clone(), vec![self.grid.along_profile.len()]),
            ("along_track", self.grid.along_track.clone(), vec![self.grid.along_track.len()]),
        ]
        .map(|(name, values, shape)| {
            (name, Dtype::F64, shape, values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>())
        });
        let numbers = self.grid.nodes.iter().flat_map(|&n| (n as u64).to_le_bytes()).collect();
        let numbers = ("node_numbers", Dtype::U64, vec![self.grid.nodes.len()], numbers);
        let tensors = reals.iter().chain([&numbers]).map(|(name, kind, shape, bytes)| {
            (*name, TensorView::new(*kind, shape.clone(), bytes).expect("as many bytes as the shape says"))
        });
        let metadata: HashMap<String, String> = [
            ("format", FORMAT.to_string()),
            ("key", self.key.clone()),
            ("equations", self.equations.to_string()),
            ("mass_kg", format!("{:e}", self.mass)),
        ]
        .map(|(name, value)| (name.to_string(), value))
        .into();
        // one line of metadata, in the order of its names, so that the same body gives the same bytes
        let whole =
            serde_json::to_string(&metadata.into_iter().collect::<std::collections::BTreeMap<_, _>>());
        let line = HashMap::from([("railspring".to_string(), whole.expect("strings are plain JSON"))]);
        serialize(tensors, Some(line)).expect("names and shapes are plain")
    }

    /// Reads what [`CondensedBody::write`] wrote.
    ///
    /// # Errors
    /// [`InputError`] for bytes of another layout, a matrix that is not square or does not suit its grid, and values that
    /// are not finite.
    pub fn read(bytes: &[u8]) -> Result<Self> {
        Self::parsed(bytes).map_err(|found| {
            InputError::new(
                "condensed body",
                found,
                "a file as `CondensedBody::write` writes it",
                "condense the body again",
            )
            .into()
        })
    }

    fn parsed(bytes: &[u8]) -> std::result::Result<Self, String> {
        let (_, header) = SafeTensors::read_metadata(bytes).map_err(|cause| cause.to_string())?;
        let line = header.metadata().as_ref().and_then(|lines| lines.get("railspring"));
        let line = line.ok_or("no metadata of a condensed body")?;
        let metadata: HashMap<String, String> =
            serde_json::from_str(line).map_err(|cause| cause.to_string())?;
        let entry = |name: &str| metadata.get(name).ok_or_else(|| format!("no {name}"));
        if entry("format")? != FORMAT {
            return Err(format!("the layout `{}`", entry("format")?));
        }
        let tensors = SafeTensors::deserialize(bytes).map_err(|cause| cause.to_string())?;
        let values = |name: &str, kind: Dtype| -> std::result::Result<(Vec<usize>, Vec<[u8; 8]>), String> {
            let tensor = tensors.tensor(name).map_err(|cause| cause.to_string())?;
            if tensor.dtype() != kind {
                return Err(format!("{name} of {:?}", tensor.dtype()));
            }
            let (values, _) = tensor.data().as_chunks::<8>();
            Ok((tensor.shape().to_vec(), values.to_vec()))
        };
        let reals = |name: &str| -> std::result::Result<(Vec<usize>, Vec<f64>), String> {
            let (shape, values) = values(name, Dtype::F64)?;
            let values: Vec<f64> = values.into_iter().map(f64::from_le_bytes).collect();
            match values.iter().find(|v| !v.is_finite()) {
                Some(value) => Err(format!("{name} with the value {value}")),
                None => Ok((shape, values)),
            }
        };
        let (shape, compliance) = reals("compliance")?;
        let (_, nodes) = reals("nodes")?;
        let (along_profile, along_track) = (reals("along_profile")?.1, reals("along_track")?.1);
        let (_, numbers) = values("node_numbers", Dtype::U64)?;
        let numbers: Vec<usize> = numbers.into_iter().map(|n| u64::from_le_bytes(n) as usize).collect();
        let count = along_profile.len() * along_track.len();
        let square = shape.len() == 2 && shape[0] == shape[1] && shape[0] >= 3 * count;
        if !square || nodes.len() != 3 * count || numbers.len() != count {
            return Err(format!("a compliance of shape {shape:?} for {count} contact nodes"));
        }
        let size = shape[0];
        let number =
            |name: &str| entry(name).and_then(|text| text.parse().map_err(|_| format!("{name} = {text}")));
        Ok(Self {
            key: entry("key")?.clone(),
            compliance: Mat::from_fn(size, size, |row, column| compliance[column * size + row]),
            grid: SurfaceGrid { along_profile, along_track, nodes: numbers },
            nodes: nodes.chunks_exact(3).map(|p| Point3::new(p[0], p[1], p[2])).collect(),
            equations: entry("equations")?.parse().map_err(|_| "equations that are no number".to_string())?,
            mass: number("mass_kg")?,
        })
    }
}
