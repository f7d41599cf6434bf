//! A deck of the same solids, supports and contact for CalculiX or Abaqus.
//!
//! Units of the deck: mm, N, MPa. The hub is lowered to the tool's displacement
//! at every load, and its reaction is printed: with displacements given, the
//! first contact needs no artificial support. Surfaces of the deck are flat
//! facets, which leave a gap where the smooth curves touch; the wheel is moved
//! by that gap, so that the facets just touch.

use std::fmt::Write as _;

use nalgebra::{Point3, Vector3};
use railspring_calibrate::error::{InputError, Result};
use railspring_calibrate::mesh::{HexMesh, SurfaceGrid};
use railspring_calibrate::solid::Material;
use railspring_calibrate::units::{MEGAPASCAL, MILLIMETRE};

use crate::stages::{Geometry, Meshes, rail_held};
use crate::study::{ElementKey, Study};

/// Which program reads the deck.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// CalculiX CrunchiX 2.17 or newer.
    Calculix,
    /// Abaqus/Standard.
    Abaqus,
}

/// Contact stiffness of the deck, MPa/mm: 1000 MPa overlap by 0.2 µm, a thousandth of the hub's displacement.
const CONTACT_STIFFNESS: f64 = 5e6;
/// Stiffness of sticking as a share of the normal one.
const STICK_SHARE: f64 = 0.1;
/// Positions a facet, in each direction, at which clearances are taken.
const SAMPLES: usize = 8;

/// A deck with its load steps.
pub struct Deck<'a> {
    /// The study.
    pub study: &'a Study,
    /// Its geometry.
    pub geometry: &'a Geometry,
    /// Its meshes.
    pub meshes: &'a Meshes,
    /// Brick of the deck.
    pub element: ElementKey,
    /// Coulomb friction coefficient; 0 leaves friction out.
    pub friction: f64,
    /// Displacements of the hub from touching, m, one a step.
    pub lowerings: &'a [f64],
}

impl Deck<'_> {
    /// The text of the deck.
    ///
    /// # Errors
    /// [`InputError`] if a surface facet belongs to no hexahedron.
    pub fn text(&self, format: Format) -> Result<String> {
        let (rail, wheel) = (&self.meshes.rail, &self.meshes.wheel);
        let shift = facet_clearance(self.geometry, self.meshes);
        let axle = Vector3::new(
            0.0,
            self.geometry.tape_y,
            self.geometry.touch.tape_z - self.geometry.wheel.radius + shift,
        );
        let offset = rail.nodes.len();
        let hub = offset + wheel.nodes.len() + 1;
        let mut out = String::new();
        let _ = writeln!(
            out,
            "*HEADING\nrailspring {}: study {}, input {}",
            env!("CARGO_PKG_VERSION"),
            self.study.name,
            &self.study.input_hash[..12]
        );
        let _ = writeln!(out, "** Units: mm, N, MPa. x along the track, y to the field side, z down.");
        let _ = writeln!(
            out,
            "** Wheel lowered by {:.6e} mm beyond touching of the smooth surfaces: facets just touch.",
            shift / MILLIMETRE
        );
        let _ = writeln!(out, "*NODE, NSET=NALL");
        let moved = wheel.nodes.iter().map(|p| p + axle);
        for (n, p) in rail.nodes.iter().copied().chain(moved).chain([Point3::from(axle); 2]).enumerate() {
            let [x, y, z] = [p.x, p.y, p.z].map(|v| v / MILLIMETRE);
            let _ = writeln!(out, "{}, {x:.12e}, {y:.12e}, {z:.12e}", n + 1);
        }
        let kind = match self.element {
            ElementKey::IncompatibleModes => "C3D8I",
            ElementKey::FullIntegration => "C3D8",
        };
        for (name, mesh, nodes, elements) in
            [("RAIL", rail, 0, 0), ("WHEEL", wheel, offset, rail.hexes.len())]
        {
            let _ = writeln!(out, "*ELEMENT, TYPE={kind}, ELSET={name}");
            for (e, hex) in mesh.hexes.iter().enumerate() {
                let list: Vec<String> = hex.iter().map(|n| (n + nodes + 1).to_string()).collect();
                let _ = writeln!(out, "{}, {}", e + elements + 1, list.join(", "));
            }
        }
        set(&mut out, "HELD", rail_held(self.study, rail).iter().map(|n| n + 1));
        set(&mut out, "BORE", wheel.bore.iter().map(|n| n + offset + 1));
        let _ = writeln!(out, "*NSET, NSET=HUB\n{hub}");
        surface(&mut out, "SRAIL", rail, 0)?;
        surface(&mut out, "SWHEEL", wheel, rail.hexes.len())?;
        material(&mut out, &self.study.material);
        match format {
            Format::Calculix => {
                let _ = writeln!(out, "*RIGID BODY, NSET=BORE, REF NODE={hub}, ROT NODE={}", hub + 1);
            }
            Format::Abaqus => {
                let _ = writeln!(out, "*RIGID BODY, TIE NSET=BORE, REF NODE={hub}");
            }
        }
        self.contact(&mut out, format);
        let _ = writeln!(out, "*BOUNDARY\nHELD, 1, 3");
        match format {
            Format::Calculix => {
                let _ = writeln!(out, "{hub}, 1, 2\n{}, 1, 3", hub + 1);
            }
            Format::Abaqus => {
                let _ = writeln!(out, "{hub}, 1, 2\n{hub}, 4, 6");
            }
        }
        for lowering in self.lowerings {
            let _ = writeln!(out, "*STEP, INC=100\n*STATIC\n1., 1., 1e-3, 1.");
            let _ = writeln!(out, "*BOUNDARY\n{hub}, 3, 3, {:.12e}", lowering / MILLIMETRE);
            let _ = writeln!(out, "*NODE PRINT, NSET=HUB, FREQUENCY=1000\nU, RF\n*END STEP");
        }
        Ok(out)
    }

    fn contact(&self, out: &mut String, format: Format) {
        let _ = writeln!(out, "*SURFACE INTERACTION, NAME=CONTACT");
        match format {
            Format::Calculix => {
                let _ = writeln!(
                    out,
                    "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{CONTACT_STIFFNESS:e}, 1., 1e-3"
                );
            }
            Format::Abaqus => {
                let _ =
                    writeln!(out, "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{CONTACT_STIFFNESS:e}");
            }
        }
        if self.friction > 0.0 {
            match format {
                Format::Calculix => {
                    let _ =
                        writeln!(out, "*FRICTION\n{}, {:e}", self.friction, STICK_SHARE * CONTACT_STIFFNESS);
                }
                Format::Abaqus => {
                    let _ = writeln!(out, "*FRICTION\n{},", self.friction);
                }
            }
        }
        let _ = writeln!(out, "*CONTACT PAIR, INTERACTION=CONTACT, TYPE=SURFACE TO SURFACE\nSWHEEL, SRAIL");
    }
}

fn set(out: &mut String, name: &str, nodes: impl Iterator<Item = usize>) {
    let _ = writeln!(out, "*NSET, NSET={name}");
    let list: Vec<String> = nodes.map(|n| n.to_string()).collect();
    for line in list.chunks(12) {
        let _ = writeln!(out, "{},", line.join(", "));
    }
}

fn material(out: &mut String, material: &Material) {
    let _ = writeln!(
        out,
        "*MATERIAL, NAME=STEEL\n*ELASTIC\n{:.12e}, {}",
        material.young / MEGAPASCAL,
        material.poisson
    );
    // t/mm³, the density that goes with mm and N
    let _ = writeln!(out, "*DENSITY\n{:.12e}", material.density * 1e-12);
    let _ = writeln!(
        out,
        "*SOLID SECTION, ELSET=RAIL, MATERIAL=STEEL\n*SOLID SECTION, ELSET=WHEEL, MATERIAL=STEEL"
    );
}

/// Faces S1 to S6 of a brick by the positions of their nodes.
const FACES: [[usize; 4]; 6] =
    [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]];

/// The facets of the contact grid as faces of elements.
fn surface(out: &mut String, name: &str, mesh: &HexMesh, elements: usize) -> Result<()> {
    let _ = writeln!(out, "*SURFACE, NAME={name}, TYPE=ELEMENT");
    let mut on_surface = vec![false; mesh.nodes.len()];
    mesh.contact.nodes.iter().for_each(|&n| on_surface[n] = true);
    let mut found = 0;
    for (e, hex) in mesh.hexes.iter().enumerate() {
        for (f, face) in FACES.iter().enumerate() {
            if face.iter().all(|&k| on_surface[hex[k]]) {
                let _ = writeln!(out, "{}, S{}", e + elements + 1, f + 1);
                found += 1;
            }
        }
    }
    let expected = (mesh.contact.along_profile.len() - 1) * (mesh.contact.along_track.len() - 1);
    if found == expected {
        return Ok(());
    }
    Err(InputError::new(
        "mesh",
        format!("{found} faces of elements on the contact surface"),
        format!("{expected}, one for every cell of the contact grid"),
        "give a contact surface that the mesh's hexahedra cover",
    )
    .into())
}

/// Corners of a grid cell.
fn cell(grid: &SurfaceGrid, i: usize, k: usize) -> [usize; 4] {
    [grid.node(i, k), grid.node(i, k + 1), grid.node(i + 1, k), grid.node(i + 1, k + 1)]
}

/// Smallest vertical clearance between the facets of both bodies when the smooth surfaces just touch, m.
pub fn facet_clearance(geometry: &Geometry, meshes: &Meshes) -> f64 {
    let (rail, wheel) = (&meshes.rail, &meshes.wheel);
    let axle = Vector3::new(0.0, geometry.tape_y, geometry.touch.tape_z - geometry.wheel.radius);
    // the rail's facets do not change along the track: a polyline over y
    let line: Vec<Point3<f64>> =
        (0..rail.contact.along_profile.len()).map(|i| rail.nodes[rail.contact.node(i, 0)]).collect();
    let rail_height = |y: f64| -> Option<f64> {
        line.windows(2)
            .filter(|w| w[0].y <= y && y <= w[1].y && w[1].y > w[0].y)
            .map(|w| {
                let t = (y - w[0].y) / (w[1].y - w[0].y);
                w[0].z + t * (w[1].z - w[0].z)
            })
            .min_by(f64::total_cmp)
    };
    let grid = &wheel.contact;
    let mut clearance = f64::INFINITY;
    for i in 0..grid.along_profile.len() - 1 {
        for k in 0..grid.along_track.len() - 1 {
            let corners = cell(grid, i, k).map(|n| wheel.nodes[n] + axle);
            for a in 0..=SAMPLES {
                for b in 0..=SAMPLES {
                    let (u, v) = (a as f64 / SAMPLES as f64, b as f64 / SAMPLES as f64);
                    let weights = [(1.0 - u) * (1.0 - v), (1.0 - u) * v, u * (1.0 - v), u * v];
                    let p: Vector3<f64> = corners.iter().zip(weights).map(|(c, w)| c.coords * w).sum();
                    if let Some(z) = rail_height(p.y) {
                        clearance = clearance.min(z - p.z);
                    }
                }
            }
        }
    }
    if clearance.is_finite() { clearance } else { 0.0 }
}
