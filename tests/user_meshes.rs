//! Meshes that a user brings. The tool's own meshes, rewritten by another program, give the same numbers in
//! every format. A mesh of Gmsh comes close to the tool's own. Every command takes them. Files that cannot be
//! used are refused with the line of the study.
//!
//! Needs Python 3.11 or newer with `venv`, as `tests/reference.rs` does.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::environment::{cache, python};
use serde_json::Value;

const RAIL: &str = "name = \"x\"\n[rail]\nprofile = \"60E1\"\n";
const WHEEL: &str = "[wheel]\nprofile = \"S1002\"\n";
/// Coarse enough for seconds.
const COARSE: &str = "[mesh]\ncontact_element_mm = 6\ncontact_element_along_mm = 6\nwheel_section_element_mm = 40\nwheel_arc_element_mm = 300\n";
const LOADS: &str = "[calibration]\nload_min_kn = 10\nload_max_kn = 85\nload_count = 4\nhorizontal_preloads_kn = [60]\nfoot_held = true\nshifts_mm = []\n";

fn meshes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes")
}

/// A folder with studies and meshes.
struct Place {
    folder: railspring_testing::Place,
}

impl Place {
    fn new() -> Self {
        python();
        Self { folder: railspring_testing::Place::new(env!("CARGO_BIN_EXE_railspring"), cache()) }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path(name)
    }

    /// Runs a command on a study of this text.
    fn try_run(&self, arguments: &[&str], study: &str) -> Output {
        self.folder.run_study(arguments, study)
    }

    fn run(&self, arguments: &[&str], study: &str) {
        self.folder.finish_study(arguments, study);
    }

    /// The message with which a study is refused, in one line.
    fn refused(&self, command: &str, study: &str) -> String {
        let output = self.try_run(&[command, "-o", "refused"], study);
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert_eq!(text.trim_end().lines().count(), 1, "{text}");
        assert!(!self.path("refused").exists(), "nothing is left behind");
        text
    }

    /// Load curve and springs of a folder.
    fn numbers(&self, folder: &str) -> Vec<f64> {
        let record: Value =
            serde_json::from_slice(&std::fs::read(self.path(folder).join("stiffness.json")).unwrap())
                .unwrap();
        let mut found = vec![record["horizontal_kn_per_m"].as_f64().unwrap()];
        for reference in record["references"].as_array().unwrap() {
            for point in reference["points"].as_array().unwrap() {
                found.extend(["displacement_mm", "tangent_kn_per_m"].map(|key| point[key].as_f64().unwrap()));
            }
        }
        found.extend(record["mesh"].as_array().unwrap().iter().map(|mesh| mesh["mass_kg"].as_f64().unwrap()));
        found
    }

    /// Hub displacements with the foot held, mm.
    fn foot(&self, folder: &str) -> Vec<f64> {
        let record: Value =
            serde_json::from_slice(&std::fs::read(self.path(folder).join("stiffness.json")).unwrap())
                .unwrap();
        let all = record["references"].as_array().unwrap();
        let foot = all.iter().find(|r| r["reference"] == "foot").unwrap();
        foot["points"].as_array().unwrap().iter().map(|p| p["displacement_mm"].as_f64().unwrap()).collect()
    }
}

/// The keys of a mesh file.
fn keys(file: &str, contact: &str, held: &str) -> String {
    format!("mesh_file = {file:?}\ncontact_surface = {contact:?}\nheld_nodes = {held:?}\n")
}

fn has(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "{part:?} in {text}");
    }
}

/// Source: the tool's own meshes, calibrated as they are. Goal: written by `railspring mesh` and rewritten in mm by
/// meshio and by an own writer of Gmsh's format, they give the same displacements (mm), tangents (kN/m) and masses (kg).
/// Accuracy: rounding of the coordinates (1e-16) times the condition number of the meshes (1e6), with a margin.
#[test]
#[ignore = "a quarter of a minute: cargo long user_meshes"]
fn the_tools_own_meshes_in_other_formats_give_the_same_numbers() {
    if !railspring_testing::python() {
        return;
    }
    const ROUNDOFF: f64 = 1e-9;
    let place = Place::new();
    // the contact of the tool's own meshes may otherwise go on beyond the window
    let coarse = COARSE.replace("[mesh]\n", "[mesh]\nwindow_half_length_mm = 12\n");
    assert_ne!(coarse, COARSE);
    let own = format!("{RAIL}{WHEEL}{coarse}{LOADS}");
    place.run(&["mesh", "-o", "m"], &own);
    place.run(&["calibrate", "-o", "own"], &own);
    for body in ["rail", "wheel"] {
        let output = Command::new(python().interpreter())
            .arg(meshes().join("rewrite.py"))
            .args([place.path(&format!("m/{body}.vtu")), place.path("m")])
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let expected = place.numbers("own");
    let named = |body: &str, ending: &str| keys(&format!("m/{body}{ending}"), "running surface", "held");
    let metres = |body: &str| keys(&format!("m/{body}.vtu"), "contact", "held") + "mesh_unit = \"m\"\n";
    for (name, rail, wheel) in [
        ("vtu", metres("rail"), metres("wheel")),
        ("msh", named("rail", ".msh"), named("wheel", ".msh")),
        // an Abaqus name in capitals is the same name; the wheel from a file with the tool's own rail
        ("inp", keys("m/rail.inp", "Running Surface", "HELD"), named("wheel", "-mask.vtu")),
        ("wheel", String::new(), named("wheel", ".inp")),
    ] {
        place.run(&["calibrate", "-o", name], &format!("{RAIL}{rail}{WHEEL}{wheel}{coarse}{LOADS}"));
        let found = place.numbers(name);
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found / expected - 1.0).abs() < ROUNDOFF, "{name}: {found} against {expected}");
        }
    }
}

/// Source: the tool's own mesh with elements of 3 mm × 2.5 mm in the contact zone. Goal: a rail that Gmsh has meshed with
/// its own section, sizes (2.4 mm × 2.2 mm) and layers: hub displacement with the foot held, mm.
#[test]
#[ignore = "a quarter of a minute: cargo long user_meshes"]
fn a_rail_of_gmsh_comes_close_to_the_tools_own() {
    if !railspring_testing::python() {
        return;
    }
    /// A node more or less in a patch of five rows moves the local approach, half of the displacement under the smallest
    /// load, by 6 %.
    const DISCRETISATION: f64 = 0.03;
    /// From 60 kN on the patch has twice as many rows; measured 0.1 %.
    const DISCRETISATION_LARGE: f64 = 0.005;
    let place = Place::new();
    std::fs::copy(meshes().join("rail-60e1.msh"), place.path("rail.msh")).unwrap();
    let mesh = "[mesh]\ncontact_element_mm = 3\ncontact_element_along_mm = 2.5\n";
    place.run(&["calibrate", "-o", "own"], &format!("{RAIL}{WHEEL}{mesh}{LOADS}"));
    let rail = keys("rail.msh", "running surface", "foot");
    place.run(&["calibrate", "-o", "gmsh"], &format!("{RAIL}{rail}{WHEEL}{mesh}{LOADS}"));
    let (own, gmsh) = (place.foot("own"), place.foot("gmsh"));
    let differences: Vec<f64> = own.iter().zip(&gmsh).map(|(own, gmsh)| (gmsh / own - 1.0).abs()).collect();
    assert!(differences.iter().all(|d| *d > 0.0 && *d < DISCRETISATION), "{differences:?}");
    assert!(*differences.last().unwrap() < DISCRETISATION_LARGE, "{differences:?}");
}

/// Goal: a whole study, its stages from the files alone, the decks and the cross-check, all with a rail of Gmsh.
#[test]
#[ignore = "a quarter of a minute: cargo long user_meshes"]
fn every_command_takes_a_mesh_file() {
    if !railspring_testing::python() {
        return;
    }
    let place = Place::new();
    std::fs::copy(meshes().join("rail-60e1.msh"), place.path("rail.msh")).unwrap();
    let scenario = "[scenario.push]\nsteps = 3\nvertical_force = { mean_kn = 40 }\nlateral_force = { mean_kn = 10 }\n\
                    snapshots_s = [0]\n";
    let study =
        format!("{RAIL}{}{WHEEL}{COARSE}{LOADS}{scenario}", keys("rail.msh", "running surface", "foot"));
    for command in ["run", "verify", "report", "mesh"] {
        place.run(&[command, "-o", "out"], &study);
    }
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(page.contains("rail, from rail.msh") && page.contains("running surface"));
    // what `mesh` has written of the user's rail is a mesh file again
    let again = std::fs::read_to_string(place.path("out/rail.vtu")).unwrap();
    assert!(again.contains("Name=\"contact\"") && again.contains("Name=\"held\""));
    for format in ["calculix", "abaqus"] {
        place.run(&["deck", "--format", format, "-o", "out"], &study);
        let deck = std::fs::read_to_string(place.path(&format!("out/{format}.inp"))).unwrap();
        assert!(deck.contains("*SURFACE"));
    }
    // few loads and no friction: the reference solver takes its time with contact
    let short = study.replace("load_max_kn = 85", "load_max_kn = 40") + "[contact]\nfriction = 0\n";
    place.run(&["crosscheck", "-o", "out"], &short);
    let record: Value =
        serde_json::from_slice(&std::fs::read(place.path("out/crosscheck.json")).unwrap()).unwrap();
    let failing = |problem: &str| -> (usize, Vec<&Value>) {
        let asked: Vec<&Value> = record["checks"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|check| check["problem"].as_str().unwrap().ends_with(problem))
            .collect();
        (asked.len(), asked.into_iter().filter(|check| check["holds"] != true).collect())
    };
    assert_eq!(failing("same mesh and element"), (16, vec![]));
    // where one or two nodes of the coarse wheel carry 5 kN the tangent is not settled; the displacement is
    let (asked, beyond) = failing("contact without friction");
    assert_eq!(asked, 16);
    assert!(
        beyond.iter().all(|check| check["quantity"] == "tangent stiffness" && check["load_kn"] == 5.0),
        "{beyond:?}"
    );
    let page = std::fs::read_to_string(place.path("out/crosscheck.html")).unwrap();
    assert_eq!(page.matches("<figure id=").count(), 5, "three curves and both sections");
}

#[test]
fn the_hash_follows_the_content_of_the_mesh_file() {
    if !railspring_testing::python() {
        return;
    }
    let place = Place::new();
    let hash = |content: &str, more: &str| {
        std::fs::write(place.path("a.msh"), content).unwrap();
        let text = format!("{RAIL}{}{more}{WHEEL}", keys("a.msh", "top", "foot"));
        let study = railspring::study::Study::parse(&place.path("x.toml"), &text).unwrap();
        railspring::hash::key(&study.statics())
    };
    let plain = hash("1", "");
    assert_eq!(plain, hash("1", ""));
    assert_ne!(plain, hash("2", ""));
    assert_ne!(plain, hash("1", "mesh_unit = \"m\"\n"));
}

#[test]
fn wrong_keys_are_refused_before_anything_is_read() {
    if !railspring_testing::python() {
        return;
    }
    let place = Place::new();
    let refused = |rail: &str| place.refused("mesh", &format!("{RAIL}{rail}{WHEEL}"));
    let alone = refused("contact_surface = \"top\"\n");
    has(&alone, &["study.toml:4: rail.contact_surface = \"top\": expected rail.mesh_file beside it"]);
    has(&refused("mesh_unit = \"m\"\n"), &["study.toml:4: rail.mesh_unit = \"m\": expected rail.mesh_file"]);
    std::fs::write(place.path("a.msh"), "a mesh that is not looked into").unwrap();
    let missing = refused("mesh_file = \"a.msh\"\nheld_nodes = \"foot\"\n");
    has(
        &missing,
        &["study.toml:2: rail.contact_surface = (missing)", "the running surface's name in the mesh file"],
    );
    let held = refused("mesh_file = \"a.msh\"\ncontact_surface = \"top\"\n");
    has(&held, &["study.toml:2: rail.held_nodes = (missing)", "nodes at the foot"]);
    std::fs::remove_file(place.path("a.msh")).unwrap();
    let absent = refused(&keys("a.msh", "top", "foot"));
    has(
        &absent,
        &["study.toml:4: rail.mesh_file = \"a.msh\": expected a readable file", "relative to the study"],
    );
    std::fs::write(place.path("a.msh"), "a mesh that is not looked into").unwrap();
    let unit = refused(&(keys("a.msh", "top", "foot") + "mesh_unit = \"cm\"\n"));
    has(&unit, &["study.toml:7: rail.mesh_unit = \"cm\": expected one of \"mm\", \"m\""]);
    // the solids know a rail along its length from its section
    let case = "[scenario.roll]\nsteps = 3\nspeed_m_per_s = 0.1\nvertical_force = {}\nlateral_force = {}\n";
    let study = |solid: &str| format!("{RAIL}{}{WHEEL}{case}{solid}", keys("a.msh", "top", "foot"));
    let moving = place.refused("mesh", &study(""));
    has(&moving, &["scenario.roll.solid = true (default): expected false", "leave `rail.mesh_file` out"]);
    let alone = place.refused("mesh", &study("solid = false\n"));
    assert!(!alone.contains("scenario.roll"), "{alone}");
}

#[test]
fn files_that_cannot_be_used_are_refused() {
    if !railspring_testing::python() {
        return;
    }
    let place = Place::new();
    std::fs::copy(meshes().join("rail-60e1.msh"), place.path("rail.msh")).unwrap();
    let refused = |rail: &str| place.refused("calibrate", &format!("{RAIL}{rail}{WHEEL}{COARSE}"));
    let name = refused(&keys("rail.msh", "top", "foot"));
    has(
        &name,
        &["study.toml:5: rail.contact_surface = \"top\": expected a name that the mesh file has: \"foot\" ("],
    );
    has(&name, &["\"running surface\" (physical group)"]);
    let volume = refused(&keys("rail.msh", "running surface", "rail"));
    has(
        &volume,
        &["study.toml:6: rail.held_nodes = \"rail\" (4200 hexahedron)", "name the surface, not the volume"],
    );
    let unit = refused(&(keys("rail.msh", "running surface", "foot") + "mesh_unit = \"m\"\n"));
    has(&unit, &["study.toml:7: rail.mesh_unit = a rail of 555", "set `rail.mesh_unit` = \"mm\""]);
    let exchanged = refused(&keys("rail.msh", "foot", "running surface"));
    has(&exchanged, &["study.toml:5: rail.contact_surface = ", "lie off the running surface, the worst by"]);
    // the same mesh for a rail of another inclination and of another length
    let upright = refused(&(keys("rail.msh", "running surface", "foot") + "inclination = 0\n"));
    has(&upright, &["rail.contact_surface = ", "within 0.1 mm of the study's profile"]);
    let long = refused(&(keys("rail.msh", "running surface", "foot") + "length_m = 0.6\n"));
    has(&long, &["rail.mesh_file = a rail from x = -277.500 to 277.500 mm", "-300.000 to 300.000 mm"]);
    std::fs::write(place.path("broken.msh"), "$MeshFormat\n4.1 0 8\n").unwrap();
    let broken = refused(&keys("broken.msh", "running surface", "foot"));
    has(
        &broken,
        &["study.toml:4: rail.mesh_file = \"broken.msh\" (line 1: $MeshFormat", "expected $EndMeshFormat"],
    );
}

/// Source: the mesh of Gmsh, of which 399 nodes are held. Goal: decks give the same mesh with the same held
/// nodes, faces and elements, which the program prints. One has its nodes and its held nodes in two cards,
/// another a part that is moved into place. A node that is missing is refused with its line.
#[test]
fn sets_of_a_deck_are_read_whole() {
    if !railspring_testing::python() {
        return;
    }
    let place = Place::new();
    std::fs::copy(meshes().join("rail-60e1.msh"), place.path("rail.msh")).unwrap();
    let output = Command::new(python().interpreter())
        .arg(meshes().join("decks.py"))
        .args([place.path("rail.msh"), place.path("")])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let study = |file: &str| {
        let materials = "[rail.materials.rail]\n";
        format!("{RAIL}{}{materials}{WHEEL}{COARSE}", keys(file, "running surface", "foot"))
    };
    let read = |file: &str| {
        std::fs::write(place.path("study.toml"), study(file)).unwrap();
        // what was read is said where a command is not quiet
        let output = place.folder.run(&["mesh", "study.toml", "-o", "out", "--cache", "store"]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{said}");
        has(&said, &["5460 nodes and 4200 hexahedra; 399 held nodes \"foot\"; "]);
        has(&said, &[" faces of \"running surface\" within the window; 4200 hexahedra of \"rail\""]);
        let faces = said.split("\"foot\"; ").nth(1).unwrap().split(" faces").next().unwrap();
        assert!(faces.parse::<usize>().unwrap() > 0, "{said}");
        (faces.to_owned(), std::fs::read(place.path("out/rail.vtu")).unwrap())
    };
    let gmsh = read("rail.msh");
    assert!(gmsh == read("cards.inp"), "the same mesh to the last bit");
    // moved there and back its coordinates are rounded
    assert_eq!(gmsh.0, read("part.inp").0);
    let missing = place.refused("mesh", &study("missing.inp"));
    has(
        &missing,
        &["rail.mesh_file = \"missing.inp\" (line ", ": node 999999 in *NSET, which the deck does not have"],
    );
}

/// Goal: without mesh files no Python is needed; with one a missing Python is reported, exit code 2.
#[test]
fn python_is_needed_for_mesh_files_only() {
    if !railspring_testing::python() {
        return;
    }
    let place = Place::new();
    std::fs::copy(meshes().join("rail-60e1.msh"), place.path("rail.msh")).unwrap();
    let none = ["mesh", "--python", "/no/such/python", "-o", "out"];
    place.run(&none, &format!("{RAIL}{WHEEL}{COARSE}"));
    assert!(place.path("out/rail.vtu").exists());
    let study = format!("{RAIL}{}{WHEEL}{COARSE}", keys("rail.msh", "running surface", "foot"));
    let output = place.try_run(&none, &study);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    has(&said, &["--python = /no/such/python", "install Python 3.11", "studies with a mesh_file"]);
}

/// Source: modules named like those that the reader imports, in the working folder, beside the study and on
/// PYTHONPATH, and settings of a user's own Python. Goal: none of them is run and the mesh is read, also with a cache
/// folder and an interpreter that are named relative to the working folder.
#[cfg(unix)]
#[test]
fn python_of_the_working_folder_stays_out() {
    if !railspring_testing::python() {
        return;
    }
    let place = Place::new();
    std::fs::copy(meshes().join("rail-60e1.msh"), place.path("rail.msh")).unwrap();
    let study = format!("{RAIL}{}{WHEEL}{COARSE}", keys("rail.msh", "running surface", "foot"));
    std::fs::write(place.path("study.toml"), study).unwrap();
    let planted = format!("open({:?}, 'w')\nraise SystemExit(3)\n", place.path("PLANTED"));
    for name in ["meshio", "numpy", "json", "sitecustomize", "usercustomize", "railspring_reference"] {
        std::fs::write(place.path(&format!("{name}.py")), &planted).unwrap();
    }
    std::os::unix::fs::symlink(cache(), place.path("cache")).unwrap();
    let interpreter = Path::new("cache").join(python().interpreter().strip_prefix(cache()).unwrap());
    for more in [vec![], vec!["--python", interpreter.to_str().unwrap()]] {
        let output = assert_cmd::Command::cargo_bin("railspring")
            .unwrap()
            .current_dir(place.folder.root())
            .args(["mesh", "study.toml", "-o", "out", "--quiet"])
            .args(&more)
            .env("RAILSPRING_CACHE", "cache")
            .env("PYTHONPATH", place.folder.root())
            .env("PYTHONHOME", place.folder.root())
            .env("PYTHONSTARTUP", place.path("numpy.py"))
            .output()
            .unwrap();
        assert!(output.status.success(), "{more:?}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(!place.path("PLANTED").exists(), "{more:?}: a planted module was run");
        std::fs::remove_dir_all(place.path("out")).unwrap();
    }
}
