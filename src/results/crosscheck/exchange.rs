//! The exchange folder: questions for a reference solver, as JSON and VTU files.
//!
//! Only data cross over: coordinates, materials, supports, forces, points of
//! the profile curves. No matrix and no formulation does.

use nalgebra::{Point2, Vector3};
use railspring_calibrate::mesh::{Cells, Field, HexMesh, vtu};
use railspring_calibrate::solid::{Material, Materials};
use railspring_profiles::error::Result;
use serde_json::{Value, json};

use crate::engine::output::OutputFolder;
use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::meshes::Meshes;
use crate::results::crosscheck::answers::{Answers, rail_held};
use crate::results::crosscheck::input::CrosscheckInput;

/// Version of the layout of `exchange.json`.
const FORMAT: u32 = 2;
/// Step of the profile curves' points, m: a cubic spline through them is off by less than 1e-9 m
/// where radii of 80 and 300 mm meet, `Δκ·step²/16`.
const CURVE_STEP: f64 = 0.1e-3;
/// Name of the point data with the given forces.
const FORCE: &str = "force (N)";

/// The problems of a reference solver besides the elastic bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Case {
    /// Frictionless contact on the same mesh and element.
    SameMesh,
    /// The same with friction.
    SameMeshFriction,
    /// Frictionless contact on the same mesh and element, the contact forces carried by the nodes of the wheel
    /// instead of the rail's.
    OtherSurface,
    /// Frictionless contact with elements of second order on a finer mesh.
    SecondOrder,
}

impl Case {
    /// Its name in the files.
    pub fn name(self) -> &'static str {
        match self {
            Self::SameMesh => "same_mesh",
            Self::SameMeshFriction => "same_mesh_friction",
            Self::OtherSurface => "other_surface",
            Self::SecondOrder => "second_order",
        }
    }
}

/// One body as it is exported.
#[derive(Debug, Clone)]
pub struct Body {
    /// The mesh.
    pub mesh: HexMesh,
    /// Materials of the mesh's groups.
    pub materials: Materials,
    /// Held nodes.
    pub held: Vec<usize>,
    /// Given nodal forces, N.
    pub forces: Vec<Vector3<f64>>,
    /// Nodes and directions of the unit forces.
    pub columns: Vec<(usize, usize)>,
    /// Points of the smooth profile curve (y, z), m.
    pub curve: Vec<Point2<f64>>,
    /// World position (y, z) of the curve's frame, m.
    pub origin: Point2<f64>,
    /// Radius of the surface of revolution, m; 0 for an extruded one.
    pub radius: f64,
}

/// The whole input of a reference solver.
#[derive(Debug, Clone)]
pub struct Exchange {
    /// Rail and wheel.
    pub bodies: [Body; 2],
    /// Rail and wheel for elements of second order, if they are wanted.
    pub second_order: Option<[Body; 2]>,
    /// Loads, N.
    pub loads: Vec<f64>,
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// The problems to solve.
    pub cases: Vec<Case>,
    /// Hash of the study.
    pub input_hash: String,
}

/// Names of the bodies, in the order of the arrays.
pub const BODIES: [&str; 2] = ["rail", "wheel"];

impl Exchange {
    /// Collects the questions; `fine` are the meshes for elements of second order, if they are wanted.
    pub fn new(
        input: &CrosscheckInput<'_>,
        geometry: &Geometry,
        meshes: &Meshes,
        fine: Option<&Meshes>,
        answers: &Answers,
        cases: Vec<Case>,
    ) -> Self {
        let statics = input.statics();
        let body = |meshes: &Meshes, k: usize, answered: bool| {
            let (mesh, answer) =
                if k == 0 { (&meshes.rail, &answers.rail) } else { (&meshes.wheel, &answers.wheel) };
            let held = if k == 0 { rail_held(statics, mesh) } else { &mesh.bore };
            let (running, origin, radius) = if k == 0 {
                (&geometry.pair.placed.curve, Point2::origin(), 0.0)
            } else {
                (&geometry.pair.wheel.running, Point2::from(geometry.pair.tape()), geometry.pair.wheel.radius)
            };
            Body {
                mesh: mesh.clone(),
                materials: if k == 0 { &statics.rail.materials } else { &statics.wheel.materials }.clone(),
                held: held.to_vec(),
                forces: if answered {
                    answer.forces.clone()
                } else {
                    vec![Vector3::zeros(); mesh.nodes.len()]
                },
                columns: if answered {
                    answer.columns.iter().map(|&(n, axis)| (mesh.contact.nodes[n], axis)).collect()
                } else {
                    Vec::new()
                },
                curve: running.sample(CURVE_STEP),
                origin,
                radius,
            }
        };
        Self {
            bodies: [0, 1].map(|k| body(meshes, k, true)),
            second_order: fine.map(|fine| [0, 1].map(|k| body(fine, k, false))),
            loads: answers.loads.clone(),
            friction: answers.friction,
            cases,
            input_hash: input.key(),
        }
    }

    /// Writes `exchange.json` and the meshes.
    ///
    /// # Errors
    /// A folder that cannot be written.
    pub fn write(&self, folder: &OutputFolder) -> Result<()> {
        let set = |bodies: &[Body; 2], prefix: &str| -> Result<Value> {
            let mut entries = serde_json::Map::new();
            for (body, name) in bodies.iter().zip(BODIES) {
                let file = format!("{prefix}{name}.vtu");
                let text = vtu(
                    &body.mesh.nodes,
                    Cells::Hexes(&body.mesh.hexes),
                    &[Field::Vector(FORCE, &body.forces)],
                    &[],
                )?;
                folder.write(&file, text.as_bytes())?;
                entries.insert(name.into(), body.entry(&file));
            }
            Ok(entries.into())
        };
        let second_order = match &self.second_order {
            Some(bodies) => set(bodies, "fine_")?,
            None => Value::Null,
        };
        folder.write_json(
            "exchange.json",
            &json!({
                "format": FORMAT,
                "input_hash": self.input_hash,
                "tool": concat!("railspring ", env!("CARGO_PKG_VERSION")),
                "bodies": set(&self.bodies, "")?,
                "second_order": second_order,
                "contact": {
                    "loads_n": self.loads,
                    "friction": self.friction,
                    "cases": self.cases.iter().map(|c| c.name()).collect::<Vec<_>>(),
                },
            }),
        )
    }
}

impl Body {
    fn entry(&self, file: &str) -> Value {
        json!({
            "mesh": file,
            "materials": self.materials.of_groups().iter().map(constants).collect::<Vec<_>>(),
            "groups": self.mesh.groups,
            "held": self.held,
            "compliance_columns": self.columns,
            "surface": {
                "nodes": self.mesh.contact.nodes,
                "along_track": self.mesh.contact.along_track,
                "curve": self.curve.iter().map(|p| [p.x, p.y]).collect::<Vec<_>>(),
                "origin": [self.origin.x, self.origin.y],
                "radius": self.radius,
            },
        })
    }
}

fn constants(Material { young, poisson, .. }: &Material) -> Value {
    json!({ "young_pa": young, "poisson": poisson })
}
