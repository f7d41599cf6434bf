//! Meshes from files: read in Python, checked and brought into form by the library.

use std::path::Path;

use nalgebra::Point3;
use railspring_calibrate::mesh::{GivenMesh, HexMesh, MeshOptions, given_rail, given_wheel};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::field::InputField;
use railspring_profiles::monitor::Monitor;
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::units::MILLIMETRE;
use serde::Deserialize;

use crate::python::{Purpose, Python, cache_folder};
use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::record::{GroupRecord, NamedRecord};
use crate::study::{MeshFile, Statics};

/// Version of the reader's answer.
const FORMAT: u32 = 2;

/// The first line of the reader's answer.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Header {
    Read { format: u32, nodes: usize, hexes: usize, contact: usize, held: usize, groups: usize },
    Refused { error: Refusal },
}

/// What is wrong with a file.
#[derive(Debug, Deserialize)]
struct Refusal {
    key: String,
    value: String,
    expected: String,
    remedy: String,
}

/// Reads mesh files; the Python environment is made when the first one is there.
pub(crate) struct Files<'a> {
    interpreter: Option<&'a Path>,
    /// Most bytes that the reader may take.
    memory: Option<f64>,
    monitor: &'a dyn Monitor,
    python: Option<Python>,
}

impl<'a> Files<'a> {
    pub fn new(interpreter: Option<&'a Path>, memory: Option<f64>, monitor: &'a dyn Monitor) -> Self {
        Self { interpreter, memory, monitor, python: None }
    }

    /// The rail of a mesh file.
    pub fn rail(
        &mut self,
        file: &MeshFile,
        statics: Statics<'_>,
        geometry: &Geometry,
        options: &MeshOptions,
    ) -> Result<HexMesh> {
        let given = self.read("rail", file)?;
        let curve = &geometry.pair.placed.curve;
        let mesh = given_rail(given, curve, statics.rail.length, options)?;
        let (materials, pair) = (&statics.rail.materials, &geometry.pair);
        materials.check_layers(&mesh, &file.groups, InputField::RailMaterials)?;
        let samples = pair.shear_stresses.iter().map(|sample| pair.placed.to_world(&sample.point));
        materials.check_section(&mesh, samples, &statics.rail.material, &file.groups)?;
        check_touch("rail", &mesh, curve, geometry.pair.touch.rail_s)?;
        self.monitor.notice(&what_was_read("rail", &mesh, file));
        Ok(mesh)
    }

    /// The wheel of a mesh file.
    pub fn wheel(
        &mut self,
        file: &MeshFile,
        statics: Statics<'_>,
        geometry: &Geometry,
        options: &MeshOptions,
    ) -> Result<HexMesh> {
        let given = self.read("wheel", file)?;
        let curve = &geometry.pair.wheel.running;
        let mesh = given_wheel(given, curve, geometry.pair.wheel.radius, options)?;
        statics.wheel.materials.check_layers(&mesh, &file.groups, InputField::WheelMaterials)?;
        check_touch("wheel", &mesh, curve, geometry.pair.touch.wheel_s)?;
        self.monitor.notice(&what_was_read("wheel", &mesh, file));
        Ok(mesh)
    }

    fn read(&mut self, section: &str, file: &MeshFile) -> Result<GivenMesh> {
        let key = format!("{section}.mesh_file");
        self.monitor.progress(&format!("reading {key}"), 0, 1)?;
        let python = match self.python.take() {
            Some(python) => python,
            None => Python::prepare(self.interpreter, &cache_folder()?, Purpose::FirstOrder, self.monitor)?,
        };
        let python = self.python.insert(python);
        let answer = python.read_mesh(&key, file, self.memory, self.monitor)?;
        if !file.is_unchanged() {
            return Err(InputError::new(
                key,
                format!("{:?}", file.file),
                "a file that does not change while it is read",
                "run the command again when it is complete",
            )
            .into());
        }
        let given = given(section, file, &answer)?;
        self.monitor.progress(&format!("reading {key}"), 1, 1)?;
        Ok(given)
    }
}

/// Sizes of what the study names in a mesh file.
pub(crate) fn named(mesh: &HexMesh, file: &MeshFile) -> NamedRecord {
    let grid = &mesh.contact;
    let elements = |group| (0..mesh.hexes.len()).filter(|&e| mesh.group(e) == group).count();
    NamedRecord {
        // a rail is held at its foot, a wheel at its bore
        held_nodes: mesh.foot.len() + mesh.bore.len(),
        contact_faces: (grid.along_profile.len() - 1) * (grid.along_track.len() - 1),
        groups: file
            .groups
            .iter()
            .enumerate()
            .map(|(group, name)| GroupRecord { name: name.clone(), elements: elements(group) })
            .collect(),
    }
}

/// What is said of a mesh file that was read.
fn what_was_read(section: &str, mesh: &HexMesh, file: &MeshFile) -> String {
    let NamedRecord { held_nodes, contact_faces, groups } = named(mesh, file);
    let mut text = format!(
        "{section}.mesh_file {:?}: {} nodes and {} hexahedra; {held_nodes} held nodes {:?}; {contact_faces} faces of {:?} within the window",
        file.file,
        mesh.nodes.len(),
        mesh.hexes.len(),
        file.held,
        file.contact
    );
    for group in groups {
        text += &format!("; {} hexahedra of {:?}", group.elements, group.name);
    }
    text
}

/// The mesh in the reader's answer.
fn given(section: &str, file: &MeshFile, answer: &[u8]) -> Result<GivenMesh> {
    let broken = || {
        InputError::new(
            format!("{section}.mesh_file"),
            format!("{:?} ({} bytes from the reader)", file.file, answer.len()),
            "the output of the mesh reader of this version of the program",
            "remove the folders reference-* in the cache folder and run the command again",
        )
    };
    let end = answer.iter().position(|&byte| byte == b'\n').ok_or_else(broken)?;
    let (format, counts) = match serde_json::from_slice(&answer[..end]).map_err(|_| broken())? {
        Header::Read { format, nodes, hexes, contact, held, groups } => {
            (format, [nodes, hexes, contact, held, groups])
        }
        Header::Refused { error } => {
            let key = format!("{section}.{}", error.key);
            return Err(InputError::new(key, error.value, error.expected, error.remedy).into());
        }
    };
    let (words, rest) = answer[end + 1..].as_chunks::<8>();
    let [nodes, hexes, contact, held, groups] = counts;
    let each = [(3, nodes), (8, hexes), (1, contact), (1, held), (1, groups)];
    let expected = each.iter().try_fold(0_usize, |sum, (words, of)| sum.checked_add(of.checked_mul(*words)?));
    if format != FORMAT || !rest.is_empty() || expected != Some(words.len()) {
        return Err(broken().into());
    }
    let (points, numbers) = words.split_at(3 * nodes);
    // a number that is no index is refused with the mesh
    let index = |word: &[u8; 8]| usize::try_from(i64::from_le_bytes(*word)).unwrap_or(usize::MAX);
    let (corners, numbers) = numbers.split_at(8 * hexes);
    let (contact, numbers) = numbers.split_at(contact);
    let (held, groups) = numbers.split_at(held);
    let coordinate = |word: &[u8; 8]| f64::from_le_bytes(*word) * file.unit;
    Ok(GivenMesh {
        nodes: points
            .as_chunks::<3>()
            .0
            .iter()
            .map(|[x, y, z]| Point3::new(coordinate(x), coordinate(y), coordinate(z)))
            .collect(),
        hexes: corners.as_chunks::<8>().0.iter().map(|hex| hex.each_ref().map(index)).collect(),
        contact: contact.iter().map(index).collect(),
        held: held.iter().map(index).collect(),
        groups: groups.iter().map(index).collect(),
        group_names: file.groups.clone(),
    })
}

/// Checks that the bodies first touch on the named surface.
fn check_touch(section: &str, mesh: &HexMesh, curve: &ProfileCurve, s: f64) -> Result<()> {
    let along = &mesh.contact.along_profile;
    let (first, last) = (along[0], along[along.len() - 1]);
    if first < s && s < last {
        return Ok(());
    }
    let shown = |s: f64| {
        let p = curve.point(s) / MILLIMETRE;
        format!("({:.3}, {:.3})", p.x, p.y)
    };
    Err(InputError::new(
        format!("{section}.contact_surface"),
        format!("a surface from (y, z) = {} to {} mm of the profile", shown(first), shown(last)),
        format!("a surface around the first touch at {} mm", shown(s)),
        "name a surface that goes further across the track",
    )
    .into())
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use railspring_calibrate::mesh::mesh_rail;
    use railspring_testing::fuzz::{Corpus, Effort, Fate};

    use super::*;
    use crate::results::bodies::geometry;
    use crate::study::Study;

    /// The answer of the reader for a mesh in metres.
    fn answer(mesh: &HexMesh) -> Vec<u8> {
        let (contact, held) = (&mesh.contact.nodes, &mesh.foot);
        let header = format!(
            "{{\"format\": {FORMAT}, \"nodes\": {}, \"hexes\": {}, \"contact\": {}, \"held\": {}, \"groups\": 0}}\n",
            mesh.nodes.len(),
            mesh.hexes.len(),
            contact.len(),
            held.len()
        );
        let places = mesh.nodes.iter().flat_map(|node| [node.x, node.y, node.z]).flat_map(f64::to_le_bytes);
        let nodes = mesh.hexes.iter().flatten().chain(contact).chain(held);
        let nodes = nodes.flat_map(|node| (*node as i64).to_le_bytes());
        header.into_bytes().into_iter().chain(places).chain(nodes).collect()
    }

    /// Source: a rail of a few hundred elements of the tool's own, as the reader answers. Goal: it is taken; with other bytes it is taken or refused, without a
    /// panic and in time.
    fn fuzzed(effort: Effort) {
        let text = "name = \"x\"\n[rail]\nprofile = \"60E1\"\nlength_m = 0.3\n[wheel]\nprofile = \"S1002\"\n";
        let study = Study::parse(Path::new("study.toml"), text).unwrap_or_else(|error| panic!("{error}"));
        let statics = study.statics();
        let geometry = geometry::geometry(statics).unwrap();
        let options = MeshOptions {
            contact_element: 8e-3,
            contact_element_along: 8e-3,
            rail_section_element: 20e-3,
            rail_length_element: 60e-3,
            ..MeshOptions::default()
        };
        let pair = &geometry.pair;
        let mesh = mesh_rail(&pair.rail, &pair.placed, statics.rail.length, &options).unwrap();
        let file = MeshFile {
            file: "rail.msh".into(),
            path: "rail.msh".into(),
            hash: String::new(),
            unit: 1.0,
            contact: "contact".into(),
            held: "held".into(),
            groups: Vec::new(),
        };
        Corpus::of(vec![("answer".into(), answer(&mesh))]).fuzz("meshes", effort, |_, bytes| {
            let read = given("rail", &file, bytes);
            Fate::of(
                read.and_then(|given| given_rail(given, &pair.placed.curve, statics.rail.length, &options)),
            )
        });
    }

    #[test]
    fn mutated_answers_are_read_or_refused() {
        fuzzed(Effort::Time(Duration::from_secs(5)));
    }

    /// Goal: no answer of the mesh reader makes a panic or a hang in ten minutes of mutated bytes.
    #[test]
    #[ignore = "ten minutes: cargo long fuzz"]
    fn ten_minutes_of_fuzzed_answers() {
        fuzzed(Effort::Time(Duration::from_secs(600)));
    }

    /// Goal: counts of the header whose sum is the right one by overflow alone are refused.
    #[test]
    fn counts_do_not_overflow() {
        let file = |answer: &[u8]| {
            let file = MeshFile {
                file: "rail.msh".into(),
                path: "rail.msh".into(),
                hash: String::new(),
                unit: 1.0,
                contact: String::new(),
                held: String::new(),
                groups: Vec::new(),
            };
            given("rail", &file, answer)
        };
        let header = |hexes: u64, held: u64| {
            format!(
                "{{\"format\": {FORMAT}, \"nodes\": 0, \"hexes\": {hexes}, \"contact\": 0, \"held\": {held}, \"groups\": 0}}\n"
            )
        };
        assert!(file(header(0, 0).as_bytes()).is_ok());
        // eight times this is 2^64
        assert!(file(header(1 << 61, 0).as_bytes()).is_err());
    }
}
