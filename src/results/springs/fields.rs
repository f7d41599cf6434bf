//! The solids as VTU files: meshes, displacements, stresses, contact patch, and collections of them over the loads.

use std::collections::HashMap;

use nalgebra::{Matrix2, Point3, Vector3};
use railspring_calibrate::calibration::Pressed;
use railspring_calibrate::contact::{PointMode, Side, Surface};
use railspring_calibrate::mesh::{Cells, Field, HexMesh, pvd, vtu};
use railspring_calibrate::pair::{PairBody, PairSolids};
use railspring_calibrate::solid::{Materials, largest_shear, nodal_stress, von_mises};
use railspring_calibrate::superelement::CondensedBody;
use railspring_profiles::error::Result;
use railspring_profiles::units::KILONEWTON;

use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::meshes::Meshes;
use crate::results::patches::make::chosen;
use crate::study::{OutputKeys, SolidLoadsKey, VerticalKey};

/// The pressed states of a calibration and what is needed to look into the solids.
pub(crate) struct PressedSolids<'a> {
    /// The states under the loads, ascending.
    pub states: &'a [Pressed],
    /// The rail under the law, and the wheel.
    pub bodies: [(PairBody, &'a CondensedBody); 2],
    /// What they are made from.
    pub solids: PairSolids<'a>,
    /// What the wheel moves along with the rail's section (y, z; m) under a force on the wheel, beside the hub's motion against it.
    pub carried: Matrix2<f64>,
}

/// A file of fields: its name in the output folder, and its text.
pub type FieldFile = (String, String);

/// The folder of the fields under other loads than the largest.
pub const FIELDS: &str = "fields/";

/// The fields under the loads of the calibration: the contact under every load, rail and wheel under those of `output`, and a collection
/// of each over the loads, in kN. The files of the largest load stand beside the collections, the others in a folder.
///
/// # Errors
/// None that a finished calibration can cause.
pub(crate) fn field_files<'a>(
    pressed: &PressedSolids<'a>,
    geometry: &Geometry,
    meshes: &Meshes,
    output: &OutputKeys,
) -> Result<Vec<FieldFile>> {
    let states = pressed.states;
    let solid = match output.solid_loads {
        SolidLoadsKey::Largest => states.len().checked_sub(1).into_iter().collect(),
        SolidLoadsKey::Three => chosen(states.len()),
        SolidLoadsKey::All => (0..states.len()).collect(),
    };
    let surface = geometry.pair.rail_surface(&meshes.rail.contact);
    let axle =
        Vector3::new(0.0, geometry.pair.tape_y, geometry.pair.touch.tape_z - geometry.pair.wheel.radius);
    let [rail, wheel] = pressed.bodies;
    let [of_rail, of_wheel] = pressed.solids.materials;
    let rail_fields = |_: &Pressed, displacement| {
        let (origin, rigid) = (Vector3::zeros(), Vector3::zeros());
        BodyFields::new(&meshes.rail, of_rail, displacement, origin, rigid)
    };
    let wheel_fields = |state: &Pressed, displacement| {
        let moved = state.hub - pressed.carried * state.force_on_wheel().yz();
        let rigid = Vector3::new(0.0, moved.x, moved.y);
        BodyFields::new(&meshes.wheel, of_wheel, displacement, axle, rigid)
    };
    let of_body = |(body, condensed): (PairBody, &CondensedBody), side, fields: &BodyOf| {
        let rows = condensed.compliance.nrows();
        let forces: Vec<_> = solid.iter().map(|&load| states[load].body_forces(side, rows)).collect();
        // the inside of one body at a time
        let moved = pressed.solids.parts(body)?.displacements(condensed, &forces)?;
        let texts = solid.iter().zip(moved);
        texts.map(|(&load, moved)| fields(&states[load], moved).vtu(output.vertical)).collect()
    };
    let every: Vec<usize> = (0..states.len()).collect();
    let of_the_contact =
        || states.iter().map(|state| ContactFields::new(state, &surface).vtu(output.vertical)).collect();
    type Texts<'t> = &'t dyn Fn() -> Result<Vec<String>>;
    let of_each: [(Texts<'_>, _, _); 3] = [
        (&|| of_body(rail, Side::Base, &rail_fields), "rail", &solid),
        (&|| of_body(wheel, Side::Opposing, &wheel_fields), "wheel", &solid),
        (&of_the_contact, "contact", &every),
    ];
    let mut files = Vec::new();
    let digits = states.len().to_string().len().max(2);
    for (texts, stem, loads) in of_each {
        let name = |load: usize| match load + 1 == states.len() {
            true => format!("{stem}.vtu"),
            false => format!("{FIELDS}{stem}-{:0digits$}.vtu", load + 1),
        };
        let entries: Vec<(f64, String)> =
            loads.iter().map(|&load| (states[load].load / KILONEWTON, name(load))).collect();
        files.push((format!("{stem}.pvd"), pvd(&entries)));
        files.extend(loads.iter().map(|&load| name(load)).zip(texts()?));
    }
    Ok(files)
}

/// The fields of a body from a state and the displacements of its nodes.
type BodyOf<'b> = dyn Fn(&Pressed, Vec<f64>) -> BodyFields + 'b;

impl VerticalKey {
    /// A place or a vector in the axes of the files. Up is half a turn about the track, so that axes and cells stay right-handed.
    fn vector(self, v: Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Down => v,
            Self::Up => Vector3::new(v.x, -v.y, -v.z),
        }
    }

    /// A symmetric tensor in the axes of the files: xx, yy, zz, xy, yz, xz.
    fn tensor(self, [xx, yy, zz, xy, yz, xz]: [f64; 6]) -> [f64; 6] {
        match self {
            Self::Down => [xx, yy, zz, xy, yz, xz],
            Self::Up => [xx, yy, zz, -xy, yz, -xz],
        }
    }

    fn points(self, points: &[Point3<f64>]) -> Vec<Point3<f64>> {
        points.iter().map(|p| Point3::from(self.vector(p.coords))).collect()
    }

    fn vectors(self, vectors: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        vectors.iter().map(|v| self.vector(*v)).collect()
    }
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
    /// Points that are a corner of no quadrilateral.
    single: Vec<usize>,
    gap: Vec<f64>,
    pressure: Vec<f64>,
    /// What the wheel does to the rail along its surface, Pa.
    traction: Vec<Vector3<f64>>,
    /// Motion of the wheel's surface along the rail's since the load before, m.
    slip: Vec<Vector3<f64>>,
    /// 0 open, 1 sticking, 2 slipping.
    mode: Vec<f64>,
}

impl BodyFields {
    /// From the displacements of all nodes of a mesh (`3·node + direction`, m), whose nodes are moved to `origin` and by `rigid` besides, m; every group of
    /// the mesh with its own nodes.
    fn new(
        mesh: &HexMesh,
        materials: &Materials,
        displacement: Vec<f64>,
        origin: Vector3<f64>,
        rigid: Vector3<f64>,
    ) -> Self {
        let (mesh, of) = mesh.with_groups_apart();
        let displacement: Vec<f64> =
            of.iter().flat_map(|&n| displacement[3 * n..3 * n + 3].to_vec()).collect();
        Self {
            points: mesh.nodes.iter().map(|p| p + origin).collect(),
            stress: nodal_stress(&mesh, materials, &displacement),
            hexes: mesh.hexes,
            displacement: displacement
                .chunks_exact(3)
                .map(|u| Vector3::new(u[0], u[1], u[2]) + rigid)
                .collect(),
        }
    }

    fn vtu(&self, vertical: VerticalKey) -> Result<String> {
        let [mises, shear] =
            [von_mises, largest_shear].map(|of| self.stress.iter().copied().map(of).collect::<Vec<_>>());
        let stress: Vec<[f64; 6]> = self.stress.iter().map(|stress| vertical.tensor(*stress)).collect();
        let data = [
            Field::Vector("displacement (m)", &vertical.vectors(&self.displacement)),
            Field::SymmetricTensor("stress (Pa)", &stress),
            Field::Scalar("von Mises stress (Pa)", &mises),
            Field::Scalar("largest shear stress (Pa)", &shear),
        ];
        vtu(&vertical.points(&self.points), Cells::Hexes(&self.hexes), &data, &[])
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
        let quads: Vec<[usize; 4]> = points.iter().filter_map(|point| quad(&point.index)).collect();
        let mut in_quad = vec![false; n];
        quads.iter().flatten().for_each(|&j| in_quad[j] = true);
        Self {
            points: points
                .iter()
                .map(|point| {
                    let section = rail.world(point.position.x);
                    Point3::new(point.position.y, section.x, section.y)
                })
                .collect(),
            quads,
            single: (0..n).filter(|&j| !in_quad[j]).collect(),
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

    fn vtu(&self, vertical: VerticalKey) -> Result<String> {
        let data = [
            Field::Scalar("gap (m)", &self.gap),
            Field::Scalar("pressure (Pa)", &self.pressure),
            Field::Vector("traction on the rail (Pa)", &vertical.vectors(&self.traction)),
            Field::Vector("slip of the wheel (m)", &vertical.vectors(&self.slip)),
            Field::Scalar("0 open, 1 sticking, 2 slipping", &self.mode),
        ];
        vtu(
            &vertical.points(&self.points),
            Cells::Surface { quads: &self.quads, points: &self.single },
            &data,
            &[],
        )
    }
}

/// Text of the VTU file of a mesh without any load, in its own frame: a mesh file that a study can name. It
/// has masks of the contact surface and of the held nodes (a rail's foot, a wheel's bore), and of the
/// `groups` with materials.
///
/// # Errors
/// None that a finished mesh can cause.
pub fn mesh_vtu(mesh: &HexMesh, groups: &[String]) -> Result<String> {
    let mask = |nodes: &[&[usize]]| {
        let mut mask = vec![0.0; mesh.nodes.len()];
        nodes.iter().copied().flatten().for_each(|&v| mask[v] = 1.0);
        mask
    };
    let (contact, held) = (mask(&[&mesh.contact.nodes]), mask(&[&mesh.foot, &mesh.bore]));
    let data = [Field::Scalar("contact", &contact), Field::Scalar("held", &held)];
    let masks: Vec<Vec<f64>> = (0..groups.len())
        .map(|group| (0..mesh.hexes.len()).map(|e| f64::from(u8::from(mesh.group(e) == group))).collect())
        .collect();
    let cells: Vec<_> = groups.iter().zip(&masks).map(|(name, mask)| Field::Scalar(name, mask)).collect();
    vtu(&mesh.nodes, Cells::Hexes(&mesh.hexes), &data, &cells)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;

    /// Source: a stress times a normal is a traction, whatever the axes. Goal: place, normal, stress and traction, each turned by itself, still
    /// belong together, and axes that are turned stay right-handed. Exact but for ROUNDOFF of sums.
    #[test]
    fn what_is_turned_belongs_together() {
        const ROUNDOFF: f64 = 1e-15;
        let matrix = |[xx, yy, zz, xy, yz, xz]: [f64; 6]| Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let stress = [1.0, -2.0, 3.0, 0.4, -0.5, 0.6];
        let normal = Vector3::new(0.1, 0.7, -0.3);
        for vertical in [VerticalKey::Down, VerticalKey::Up] {
            let traction = matrix(vertical.tensor(stress)) * vertical.vector(normal);
            let expected = vertical.vector(matrix(stress) * normal);
            assert!((traction - expected).norm() < ROUNDOFF, "{vertical:?}: {traction} {expected}");
            let axes = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| vertical.vector(axis));
            assert_eq!(axes[0].cross(&axes[1]), axes[2], "{vertical:?}");
        }
        assert_eq!(VerticalKey::Up.vector(Vector3::z()), -Vector3::z());
        assert_eq!(VerticalKey::Up.vector(Vector3::x()), Vector3::x());
    }
}
