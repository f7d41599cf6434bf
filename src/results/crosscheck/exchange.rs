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
use crate::results::crosscheck::answers::{Answers, element_name, rail_held};
use crate::results::crosscheck::input::CrosscheckInput;
use crate::study::Statics;

/// Version of the layout of `exchange.json`.
const FORMAT: u32 = 3;
/// Step of the profile curves' points, m: a cubic spline through them is off by less than 1e-9 m
/// where radii of 80 and 300 mm meet, `Δκ·step²/16`.
const CURVE_STEP: f64 = 0.1e-3;
/// Element of the reference solver with twenty nodes.
pub const SECOND_ORDER: &str = "second order";
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
    /// Frictionless contact, and the horizontal stiffness, with elements of second order on another mesh.
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
    /// Element of the reference solver: as of [`element_name`], or [`SECOND_ORDER`].
    pub element: &'static str,
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
    /// Rail and wheel for elements of second order.
    pub second_order: Option<[Body; 2]>,
    /// Loads, N.
    pub loads: Vec<f64>,
    /// Loads under which the horizontal stiffness is asked for, N.
    pub preloads: Vec<f64>,
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// The problems to solve.
    pub cases: Vec<Case>,
    /// Hash of the study.
    pub input_hash: String,
    /// A load case in time, if one is asked for.
    pub in_time: Option<Value>,
}

/// Names of the bodies, in the order of the arrays.
pub const BODIES: [&str; 2] = ["rail", "wheel"];

impl Exchange {
    /// Collects the questions; `other` are the meshes for elements of second order.
    pub fn new(
        input: &CrosscheckInput<'_>,
        geometry: &Geometry,
        meshes: &Meshes,
        other: Option<&Meshes>,
        answers: &Answers,
        cases: &[Case],
    ) -> Self {
        let statics = input.statics();
        let body = |meshes: &Meshes, k: usize, element: &'static str| {
            let held = if k == 0 { rail_held(statics, &meshes.rail) } else { &meshes.wheel.bore };
            Body { element, ..Body::of(statics, geometry, meshes, k, held.to_vec()) }
        };
        let answered = |k: usize| {
            let body = body(meshes, k, answers.element);
            let answer = if k == 0 { &answers.rail } else { &answers.wheel };
            let columns =
                answer.columns.iter().map(|&(n, axis)| (body.mesh.contact.nodes[n], axis)).collect();
            Body { forces: answer.forces.clone(), columns, ..body }
        };
        Self {
            bodies: [0, 1].map(answered),
            second_order: other.map(|meshes| [0, 1].map(|k| body(meshes, k, SECOND_ORDER))),
            loads: answers.loads.clone(),
            preloads: answers.horizontal.iter().map(|point| point.preload).collect(),
            friction: answers.friction,
            cases: cases.to_vec(),
            input_hash: input.key(),
            in_time: None,
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
        let mut exchange = json!({
            "format": FORMAT,
            "input_hash": self.input_hash,
            "tool": concat!("railspring ", env!("CARGO_PKG_VERSION")),
            "bodies": set(&self.bodies, "")?,
            "contact": {
                "loads_n": self.loads,
                "preloads_n": self.preloads,
                "friction": self.friction,
                "cases": self.cases.iter().map(|c| c.name()).collect::<Vec<_>>(),
            },
        });
        if let Some(bodies) = &self.second_order {
            exchange["second_order"] = set(bodies, "second_order_")?;
        }
        if let Some(case) = &self.in_time {
            exchange["in_time"] = case.clone();
        }
        folder.write_json("exchange.json", &exchange)
    }
}

impl Body {
    /// The rail (0) or the wheel (1) of some meshes with its `held` nodes and the study's element, without forces.
    pub(super) fn of(
        statics: Statics<'_>,
        geometry: &Geometry,
        meshes: &Meshes,
        k: usize,
        held: Vec<usize>,
    ) -> Self {
        let pair = &geometry.pair;
        let (mesh, materials) = match k {
            0 => (&meshes.rail, &statics.rail.materials),
            _ => (&meshes.wheel, &statics.wheel.materials),
        };
        let (running, origin, radius) = match k {
            0 => (&pair.placed.curve, Point2::origin(), 0.0),
            _ => (&pair.wheel.running, Point2::from(pair.tape()), pair.wheel.radius),
        };
        Self {
            mesh: mesh.clone(),
            element: element_name(statics.element.formulation()),
            materials: materials.clone(),
            held,
            forces: vec![Vector3::zeros(); mesh.nodes.len()],
            columns: Vec::new(),
            curve: running.sample(CURVE_STEP),
            origin,
            radius,
        }
    }

    fn entry(&self, file: &str) -> Value {
        json!({
            "mesh": file,
            "element": self.element,
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
