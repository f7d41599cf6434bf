//! A deck of the same solids, supports and contact for CalculiX or Abaqus.
//!
//! Units of the deck: mm, N, MPa. The hub is lowered to the tool's displacement
//! at every load, and its reaction is printed: with displacements given, the
//! first contact needs no artificial support. Displacements count from the
//! position in which the smooth surfaces just touch; the flat facets of the deck
//! lie some micrometres below them, so that they touch later.
//!
//! Contact is hard: CalculiX enforces it by multipliers (mortar) on the rail's
//! surface, so that no penalty stiffness adds its own compliance.

use std::fmt::Write as _;

use nalgebra::{Point3, Vector3};
use railspring_calibrate::mesh::HexMesh;
use railspring_calibrate::solid::{Material, Materials};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::units::{MEGAPASCAL, MILLIMETRE};

use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::meshes::Meshes;
use crate::results::crosscheck::answers::rail_held;
use crate::results::crosscheck::input::CrosscheckInput;
use crate::study::{ElementKey, Statics};

/// Which program reads the deck.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// CalculiX CrunchiX 2.17 or newer.
    Calculix,
    /// Abaqus/Standard.
    Abaqus,
}

/// Slope of friction while sticking, MPa/mm: 100 MPa slip by 0.02 µm before they slide.
const STICK_SLOPE: f64 = 5e6;

/// A deck with its load steps.
pub struct Deck<'a> {
    /// The study.
    pub input: &'a CrosscheckInput<'a>,
    /// Its geometry.
    pub geometry: &'a Geometry,
    /// Its meshes.
    pub meshes: &'a Meshes,
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
        let (mut out, hub) = self.bodies(format);
        surface(&mut out, "SRAIL", &self.meshes.rail, 0)?;
        surface(&mut out, "SWHEEL", &self.meshes.wheel, self.meshes.rail.hexes.len())?;
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
            let _ = writeln!(out, "*STEP, INC=100\n*STATIC\n1., 1.");
            let _ = writeln!(out, "*BOUNDARY\n{hub}, 3, 3, {:.12e}", lowering / MILLIMETRE);
            let _ = writeln!(out, "*NODE PRINT, NSET=HUB, FREQUENCY=1000\nU, RF\n*END STEP");
        }
        Ok(out)
    }

    /// The text of a deck for CalculiX of both bodies apart, each under lateral forces (node of its mesh, N).
    /// It prints the displacement of the loaded nodes for the rail and then for the wheel. The number of a
    /// node is that of the body's mesh, the wheel's after the rail's.
    pub fn lateral_text(&self, forces: [&[(usize, f64)]; 2]) -> String {
        let (mut out, hub) = self.bodies(Format::Calculix);
        let _ = writeln!(out, "*BOUNDARY\nHELD, 1, 3\n{hub}, 1, 3\n{}, 1, 3", hub + 1);
        let _ = writeln!(out, "*STEP\n*STATIC\n*CLOAD");
        let offsets = [0, self.meshes.rail.nodes.len()];
        for (forces, offset) in forces.into_iter().zip(offsets) {
            for (node, force) in forces {
                let _ = writeln!(out, "{}, 2, {force:.12e}", node + offset + 1);
            }
        }
        let nodes = forces.into_iter().zip(offsets);
        set(
            &mut out,
            "NSET",
            "LOADED",
            nodes.flat_map(|(of, offset)| of.iter().map(move |(n, _)| n + offset + 1)),
        );
        let _ = writeln!(out, "*NODE PRINT, NSET=LOADED\nU\n*END STEP");
        out
    }

    /// Nodes, elements, sets and materials of both bodies, the bore bound to a hub, and the hub's number.
    fn bodies(&self, format: Format) -> (String, usize) {
        let (rail, wheel) = (&self.meshes.rail, &self.meshes.wheel);
        let tape = self.geometry.pair.tape();
        let axle = Vector3::new(0.0, tape.x, tape.y - self.geometry.pair.wheel.radius);
        let offset = rail.nodes.len();
        let hub = offset + wheel.nodes.len() + 1;
        let mut out = String::new();
        let _ = writeln!(
            out,
            "*HEADING\nrailspring {}: study {}, input {}",
            env!("CARGO_PKG_VERSION"),
            self.input.name(),
            &self.input.key()[..12]
        );
        let _ = writeln!(out, "** Units: mm, N, MPa. x along the track, y to the field side, z down.");
        let _ = writeln!(out, "** Displacements of the hub count from touching of the smooth surfaces.");
        let _ = writeln!(out, "*NODE, NSET=NALL");
        let moved = wheel.nodes.iter().map(|p| p + axle);
        for (n, p) in rail.nodes.iter().copied().chain(moved).chain([Point3::from(axle); 2]).enumerate() {
            let [x, y, z] = [p.x, p.y, p.z].map(|v| v / MILLIMETRE);
            let _ = writeln!(out, "{}, {x:.12e}, {y:.12e}, {z:.12e}", n + 1);
        }
        let kind = match self.input.statics().element {
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
        set(&mut out, "NSET", "HELD", rail_held(self.input.statics(), rail).iter().map(|n| n + 1));
        set(&mut out, "NSET", "BORE", wheel.bore.iter().map(|n| n + offset + 1));
        let _ = writeln!(out, "*NSET, NSET=HUB\n{hub}");
        let Statics { rail: of_rail, wheel: of_wheel, .. } = self.input.statics();
        for (name, mesh, file, of, elements) in [
            ("RAIL", rail, &of_rail.mesh, &of_rail.materials, 0),
            ("WHEEL", wheel, &of_wheel.mesh, &of_wheel.materials, rail.hexes.len()),
        ] {
            let groups = file.as_ref().map_or(&[][..], |file| &file.groups);
            materials(&mut out, name, (mesh, elements), of, groups);
        }
        match format {
            Format::Calculix => {
                let _ = writeln!(out, "*RIGID BODY, NSET=BORE, REF NODE={hub}, ROT NODE={}", hub + 1);
            }
            Format::Abaqus => {
                let _ = writeln!(out, "*RIGID BODY, TIE NSET=BORE, REF NODE={hub}");
            }
        }
        (out, hub)
    }

    fn contact(&self, out: &mut String, format: Format) {
        let (kind, friction) = match format {
            Format::Calculix => ("MORTAR", format!("{}, {STICK_SLOPE:e}", self.friction)),
            Format::Abaqus => ("SURFACE TO SURFACE", format!("{},", self.friction)),
        };
        let _ = writeln!(out, "*SURFACE INTERACTION, NAME=CONTACT");
        let _ = writeln!(out, "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD");
        if self.friction > 0.0 {
            let _ = writeln!(out, "*FRICTION\n{friction}");
        }
        let _ = writeln!(out, "*CONTACT PAIR, INTERACTION=CONTACT, TYPE={kind}\nSRAIL, SWHEEL");
    }
}

fn set(out: &mut String, kind: &str, name: &str, members: impl Iterator<Item = usize>) {
    let _ = writeln!(out, "*{kind}, {kind}={name}");
    let list: Vec<String> = members.map(|n| n.to_string()).collect();
    for line in list.chunks(12) {
        let _ = writeln!(out, "{},", line.join(", "));
    }
}

/// The materials of a body, which is an element set with its name: one each for its `groups`, as element sets with their numbers, or one for all.
fn materials(
    out: &mut String,
    body: &str,
    (mesh, elements): (&HexMesh, usize),
    materials: &Materials,
    groups: &[String],
) {
    for (number, material) in materials.of_groups().iter().enumerate() {
        let name = if groups.is_empty() { body.to_owned() } else { format!("{body}-{}", number + 1) };
        if let Some(group) = groups.get(number) {
            let _ = writeln!(out, "** {name}: {}", group.replace(char::is_control, " "));
            let members = (0..mesh.hexes.len()).filter(|&e| mesh.group(e) == number);
            set(out, "ELSET", &name, members.map(|e| e + elements + 1));
        }
        let Material { young, poisson, density, .. } = material;
        let _ = writeln!(out, "*MATERIAL, NAME={name}\n*ELASTIC\n{:.12e}, {poisson}", young / MEGAPASCAL);
        // t/mm³, the density that goes with mm and N
        let _ = writeln!(out, "*DENSITY\n{:.12e}", density * 1e-12);
        let _ = writeln!(out, "*SOLID SECTION, ELSET={name}, MATERIAL={name}");
    }
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
