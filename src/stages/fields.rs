//! The solids as VTU files: meshes, displacements, stresses, contact patch.

use std::collections::HashMap;

use nalgebra::{Point3, Vector2, Vector3};
use railspring_calibrate::calibration::Pressed;
use railspring_calibrate::contact::{PointMode, Side, Surface};
use railspring_calibrate::error::Result;
use railspring_calibrate::mesh::{Cells, Field, HexMesh, vtu};
use railspring_calibrate::solid::{largest_shear, nodal_stress, von_mises};
use railspring_calibrate::superelement::{CondensedBody, Interior};

use super::{Geometry, Meshes};

/// A result file in VTU format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fields {
    /// The rail with displacement and stress.
    Rail,
    /// The wheel with displacement and stress, in the world frame.
    Wheel,
    /// The contact patch and its surroundings on the rail.
    Contact,
}

/// The solids under the largest load of the calibration.
pub struct PressedFields {
    rail: BodyFields,
    wheel: BodyFields,
    contact: ContactFields,
}

struct BodyFields {
    points: Vec<Point3<f64>>,
    hexes: Vec<[usize; 8]>,
    displacement: Vec<Vector3<f64>>,
    stress: Vec<[f64; 6]>,
}

struct ContactFields {
    points: Vec<Point3<f64>>,
    quads: Vec<[usize; 4]>,
    gap: Vec<f64>,
    pressure: Vec<f64>,
    /// What the wheel does to the rail along its surface, Pa.
    traction: Vec<Vector3<f64>>,
    /// Motion of the wheel's surface along the rail's since the load before, m.
    slip: Vec<Vector3<f64>>,
    /// 0 open, 1 sticking, 2 slipping.
    mode: Vec<f64>,
}

impl PressedFields {
    /// Displacements and stresses of both bodies; gap, pressure, traction and slip at the points of contact. `carried` (y, z; m) is what
    /// the wheel moves along with the rail's section, beside the hub's motion against it.
    pub(super) fn new(
        state: &Pressed,
        [rail, wheel]: [(&CondensedBody, &Interior); 2],
        carried: Vector2<f64>,
        geometry: &Geometry,
        meshes: &Meshes,
    ) -> Self {
        let hub = Vector3::new(0.0, state.hub.x + carried.x, state.hub.y + carried.y);
        let axle =
            Vector3::new(0.0, geometry.pair.tape_y, geometry.pair.touch.tape_z - geometry.pair.wheel.radius);
        Self {
            rail: BodyFields::new(&meshes.rail, rail, state, Side::Base, Vector3::zeros(), Vector3::zeros()),
            wheel: BodyFields::new(&meshes.wheel, wheel, state, Side::Opposing, axle, hub),
            contact: ContactFields::new(state, &geometry.pair.rail_surface(&meshes.rail.contact)),
        }
    }
}

impl BodyFields {
    fn new(
        mesh: &HexMesh,
        (body, interior): (&CondensedBody, &Interior),
        state: &Pressed,
        side: Side,
        origin: Vector3<f64>,
        rigid: Vector3<f64>,
    ) -> Self {
        let forces = state.body_forces(side, body.compliance.nrows());
        let displacement = interior.displacement(body, &forces);
        Self {
            points: mesh.nodes.iter().map(|p| p + origin).collect(),
            hexes: mesh.hexes.clone(),
            stress: nodal_stress(mesh, &interior.system.material, &displacement),
            displacement: displacement
                .chunks_exact(3)
                .map(|u| Vector3::new(u[0], u[1], u[2]) + rigid)
                .collect(),
        }
    }
}

impl ContactFields {
    fn new(state: &Pressed, rail: &Surface) -> Self {
        let (points, solution) = (&state.points, &state.solution);
        let n = points.len();
        let place: HashMap<(usize, usize), usize> =
            points.iter().enumerate().map(|(j, point)| (point.index, j)).collect();
        let along = |values: &[f64], j: usize| -> Vector3<f64> {
            (1..3).filter_map(|d| Some(points[j].direction(d) * *values.get(d * n + j)?)).sum()
        };
        let quad = |&(i, k): &(usize, usize)| -> Option<[usize; 4]> {
            let at = |a, b| place.get(&(i + a, k + b)).copied();
            Some([at(0, 0)?, at(0, 1)?, at(1, 1)?, at(1, 0)?])
        };
        Self {
            points: points
                .iter()
                .map(|point| {
                    let section = rail.world(point.position.x);
                    Point3::new(point.position.y, section.x, section.y)
                })
                .collect(),
            quads: points.iter().filter_map(|point| quad(&point.index)).collect(),
            gap: solution.separation[..n].to_vec(),
            pressure: points.iter().zip(&solution.forces).map(|(point, f)| f / point.area).collect(),
            traction: (0..n).map(|j| -along(&solution.forces, j) / points[j].area).collect(),
            slip: (0..n).map(|j| along(&solution.separation, j)).collect(),
            mode: solution
                .modes
                .iter()
                .map(|mode| match mode {
                    PointMode::Open => 0.0,
                    PointMode::Stick => 1.0,
                    PointMode::Slip => 2.0,
                })
                .collect(),
        }
    }
}

/// Text of one of the VTU files of the pressed solids.
///
/// # Errors
/// None that a finished calibration can cause.
pub fn fields_vtu(pressed: &PressedFields, fields: Fields) -> Result<String> {
    match fields {
        Fields::Rail => body_vtu(&pressed.rail),
        Fields::Wheel => body_vtu(&pressed.wheel),
        Fields::Contact => {
            let c = &pressed.contact;
            let data = [
                Field::Scalar("gap (m)", &c.gap),
                Field::Scalar("pressure (Pa)", &c.pressure),
                Field::Vector("traction on the rail (Pa)", &c.traction),
                Field::Vector("slip of the wheel (m)", &c.slip),
                Field::Scalar("0 open, 1 sticking, 2 slipping", &c.mode),
            ];
            vtu(&c.points, Cells::Quads(&c.quads), &data, &[])
        }
    }
}

fn body_vtu(body: &BodyFields) -> Result<String> {
    let [mises, shear] =
        [von_mises, largest_shear].map(|of| body.stress.iter().copied().map(of).collect::<Vec<_>>());
    let data = [
        Field::Vector("displacement (m)", &body.displacement),
        Field::SymmetricTensor("stress (Pa)", &body.stress),
        Field::Scalar("von Mises stress (Pa)", &mises),
        Field::Scalar("largest shear stress (Pa)", &shear),
    ];
    vtu(&body.points, Cells::Hexes(&body.hexes), &data, &[])
}

/// Text of the VTU file of a mesh without any load, in its own frame, with masks of its contact surface and of its
/// held nodes (a rail's foot, a wheel's bore): a mesh file that a study can name.
///
/// # Errors
/// None that a finished mesh can cause.
pub fn mesh_vtu(mesh: &HexMesh) -> Result<String> {
    let mask = |nodes: &[&[usize]]| {
        let mut mask = vec![0.0; mesh.nodes.len()];
        nodes.iter().copied().flatten().for_each(|&v| mask[v] = 1.0);
        mask
    };
    let (contact, held) = (mask(&[&mesh.contact.nodes]), mask(&[&mesh.foot, &mesh.bore]));
    let data = [Field::Scalar("contact", &contact), Field::Scalar("held", &held)];
    vtu(&mesh.nodes, Cells::Hexes(&mesh.hexes), &data, &[])
}
