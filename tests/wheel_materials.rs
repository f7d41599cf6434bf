//! Wheels of several materials as meshes: a ring of rubber between tyre and centre, and brake discs of cast iron on the web, from files to a report,
//! statics beside a calculation by hand, and what is wrong with groups and materials. What takes longer is left to `cargo long wheel_materials`.
//!
//! Needs Python 3.11 or newer with `venv`, as `tests/reference.rs` does.

mod bodies;
mod layered;

use std::f64::consts::PI;
use std::path::PathBuf;
use std::process::Output;

use crate::environment::{cache, python};
use layered::{DIAMETER, INSIDE, Layered, SIDES, resilient, with_discs};
use railspring_calibrate::mesh::{Cells, Field, MeshOptions, vtu};
use railspring_calibrate::pair::Pair;
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::section::{rail_section, wheel_section};
use serde_json::Value;

const COARSE: &str = "[mesh]\ncontact_element_mm = 6\ncontact_element_along_mm = 6\nwindow_half_length_mm = 12\nwheel_section_element_mm = 15\n\
                      wheel_arc_element_mm = 90\n";
const LOADS: &str = "[calibration]\nload_min_kn = 10\nload_max_kn = 85\nload_count = 4\nhorizontal_preloads_kn = [60]\nshifts_mm = []\nerror_band = false\n";
const RUBBER: &str = "young_gpa = 0.006\npoisson = 0.499\ndensity_kg_per_m3 = 1200\n";

/// A folder with the mesh of a wheel.
struct Place {
    folder: railspring_testing::Place,
}

impl Place {
    fn new(wheel: &Layered) -> Self {
        python();
        let place =
            Self { folder: railspring_testing::Place::new(env!("CARGO_BIN_EXE_railspring"), cache()) };
        wheel.write(&place.path("wheel.vtu"));
        place
    }

    /// A mesh of the rail, `rail.vtu`, with the groups `middle` and `ends`, from 0.2 m on.
    fn rail(&self) {
        let (rail, wheel) = (rail_section("60E1").unwrap(), wheel_section("S1002", DIAMETER).unwrap());
        let pair = Pair::new(rail, wheel, &TrackGeometry::standard()).unwrap();
        let options =
            MeshOptions { contact_element: 6e-3, contact_element_along: 6e-3, ..MeshOptions::default() };
        let mesh = pair.mesh(0.555, &options).unwrap().rail;
        let mask = |of: &[usize]| {
            let mut mask = vec![0.0; mesh.nodes.len()];
            of.iter().for_each(|&v| mask[v] = 1.0);
            mask
        };
        let (contact, foot) = (mask(&mesh.contact.nodes), mask(&mesh.foot));
        let points = [Field::Scalar("contact", &contact), Field::Scalar("held", &foot)];
        let at = |hex: &[usize; 8]| hex.iter().map(|&v| mesh.nodes[v].x).sum::<f64>() / 8.0;
        let ends: Vec<f64> = mesh.hexes.iter().map(|hex| f64::from(u8::from(at(hex).abs() > 0.2))).collect();
        let middle: Vec<f64> = ends.iter().map(|end| 1.0 - end).collect();
        let cells = [Field::Scalar("middle", &middle), Field::Scalar("ends", &ends)];
        let text = vtu(&mesh.nodes, Cells::Hexes(&mesh.hexes), &points, &cells).unwrap();
        std::fs::write(self.path("rail.vtu"), text).unwrap();
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path(name)
    }

    /// The study with the mesh and these sections of materials.
    fn study(&self, materials: &str) -> String {
        format!(
            "name = \"x\"\n[rail]\nprofile = \"60E1\"\n{COARSE}{LOADS}[wheel]\nprofile = \"S1002\"\ntape_diameter_m = {DIAMETER}\n\
             mesh_file = \"wheel.vtu\"\nmesh_unit = \"m\"\ncontact_surface = \"running surface\"\nheld_nodes = \"bore\"\n{materials}"
        )
    }

    fn run(&self, arguments: &[&str], study: &str) -> Output {
        self.folder.run_study(arguments, study)
    }

    fn done(&self, arguments: &[&str], study: &str) {
        self.folder.finish_study(arguments, study);
    }

    fn record(&self, folder: &str) -> Value {
        serde_json::from_slice(&std::fs::read(self.path(folder).join("stiffness.json")).unwrap()).unwrap()
    }
}

/// Loads (N) and hub displacements against a reference (m).
fn displacements(record: &Value, reference: &str) -> Vec<[f64; 2]> {
    let all = record["references"].as_array().unwrap();
    let found = all.iter().find(|r| r["reference"] == reference).unwrap();
    let points = found["points"].as_array().unwrap();
    let value = |point: &Value, key: &str| point[key].as_f64().unwrap();
    points.iter().map(|p| [1e3 * value(p, "force_kn"), 1e-3 * value(p, "displacement_mm")]).collect()
}

/// Sections of the materials of the resilient wheel; without keys a group is of steel.
fn resilient_of(rubber: &str) -> String {
    format!("[wheel.materials.tyre]\n[wheel.materials.rubber]\n{rubber}[wheel.materials.centre]\n")
}

fn mass(record: &Value) -> f64 {
    let meshes = record["mesh"].as_array().unwrap();
    meshes.iter().find(|mesh| mesh["body"] == "wheel").unwrap()["mass_kg"].as_f64().unwrap()
}

/// Volume of a ring between two radii (m), m³.
fn ring(radii: [f64; 2], width: f64) -> f64 {
    PI * (radii[0].powi(2) - radii[1].powi(2)).abs() * width
}

fn has(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "{part:?} in {text}");
    }
}

/// Flexibility (m/N) of a wheel's tyre on a ring of rubber: a thin ring of steel without extension (S.P. Timoshenko, Vibration Problems in Engineering,
/// art. on rings) with radius R and bending stiffness EI on springs along the rubber's outer side, radial ones from a bonded strip in compression
/// (A.N. Gent and P.B. Lindley, 1959: 4G(1 + S²) with S half its width over its thickness, in series with the bulk modulus), and tangential ones from its shear;
/// the sum over the waves around, the first of which is the tyre as a rigid body.
fn by_hand(young: f64, poisson: f64, inner: f64) -> f64 {
    let (width, thickness) = (SIDES[1] - SIDES[0], INSIDE - inner);
    let (shear, bulk) = (young / (2.0 * (1.0 + poisson)), young / (3.0 * (1.0 - 2.0 * poisson)));
    let slender = 0.5 * width / thickness;
    let strip = 4.0 * shear * (1.0 + slender * slender);
    let normal = width / thickness / (1.0 / strip + 1.0 / bulk);
    let tangential = width / thickness * shear;
    // section of the tyre: its rectangle and the flange below
    let (height, flange) = (0.5 * DIAMETER - INSIDE, [0.032, 0.028]);
    let areas = [[width * height, 0.5 * height], [flange[0] * flange[1], height + 0.5 * flange[1]]];
    let area: f64 = areas.iter().map(|[area, _]| area).sum();
    let middle = areas.iter().map(|[area, at]| area * at).sum::<f64>() / area;
    let second: f64 = areas
        .iter()
        .zip([height, flange[1]])
        .map(|([area, at], high)| area * (high * high / 12.0 + (at - middle).powi(2)))
        .sum();
    let (radius, rubber) = (INSIDE + middle, 0.5 * (INSIDE + inner));
    (1..40)
        .map(|wave| f64::from(wave * wave))
        .map(|n2| {
            let ring = PI * 210e9 * second / radius.powi(3) * (n2 - 1.0).powi(2);
            1.0 / (ring + PI * rubber * (normal + tangential / n2))
        })
        .sum()
}

/// Source: a thin ring on springs ([`by_hand`]). Goal: hub displacement over load (m/N) of a wheel with a
/// ring of rubber of `young` (Pa) from the radius `inner` (m) on, less that of the same wheel of steel. Both
/// have the same approach of the surfaces, and masses (kg) that differ by their rings. Accuracy: MODEL, of a
/// ring without shear and springs without ends; `LOCAL`, as the bodies differ only in depth; FACETS of the
/// mesh, at most 12° each.
fn in_series(inner: f64, young: f64) {
    const MODEL: f64 = 0.1;
    const LOCAL: f64 = 2e-3;
    const FACETS: f64 = 8e-3;
    if !railspring_testing::python() {
        return;
    }
    let place = Place::new(&resilient(inner, 4));
    let rubber = format!("young_gpa = {}\npoisson = 0.499\ndensity_kg_per_m3 = 1200\n", young * 1e-9);
    place.done(&["calibrate", "-o", "soft"], &place.study(&resilient_of(&rubber)));
    place.done(&["calibrate", "-o", "steel"], &place.study(&resilient_of("")));
    let (soft, steel) = (place.record("soft"), place.record("steel"));
    let expected = by_hand(young, 0.499, inner);
    let beam = displacements(&soft, "beam").into_iter().zip(displacements(&steel, "beam"));
    for ([load, soft], [_, steel]) in beam {
        let ratio = (soft - steel) / load / expected;
        assert!((ratio - 1.0).abs() < MODEL, "{inner} m, {young} Pa, {load} N: {ratio}");
    }
    let local = displacements(&soft, "local").into_iter().zip(displacements(&steel, "local"));
    for ([_, soft], [_, steel]) in local {
        assert!((soft / steel - 1.0).abs() < LOCAL, "{soft} {steel}");
    }
    let lighter = (7850.0 - 1200.0) * ring([INSIDE, inner], SIDES[1] - SIDES[0]);
    let found = (mass(&steel) - mass(&soft)) / lighter;
    assert!((found - 1.0).abs() < FACETS, "{found} of {lighter} kg");
}

/// Source, goal and accuracy: [`in_series`].
#[test]
#[ignore = "a quarter of a minute: cargo long wheel_materials"]
fn a_ring_of_rubber_is_in_series_with_the_wheel_of_steel() {
    in_series(0.34, 6e6);
}

/// Goal: a ring of rubber half as thick, and one of a stiffer rubber, are in series with the wheel of steel; else as [`in_series`].
#[test]
#[ignore = "a minute: cargo long wheel_materials"]
fn other_rings_are_in_series_with_the_wheel_of_steel() {
    in_series(0.355, 6e6);
    in_series(0.34, 20e6);
}

/// Vertical force of the solid model in time, kN.
fn vertical(place: &Place, folder: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(place.path(folder).join("solid_history.csv")).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let column = lines.next().unwrap().split(',').position(|name| name == "p_kn").unwrap();
    lines.map(|line| line.split(',').nth(column).unwrap().parse().unwrap()).collect()
}

/// Goal: wheels of several materials run to a report on both models that names their materials. One has a
/// ring of rubber, the other brake discs of cast iron on its web. The discs count with their mass (kg; FACETS
/// of the mesh), and their smaller modulus gives way a little more. In time the vertical force (kN) of the
/// condensed bodies is that of all equations of the meshes. Accuracy: MODES, the share of an impact of the
/// modes that are left out.
#[test]
#[ignore = "a minute: cargo long wheel_materials"]
fn wheels_of_several_materials_run_to_a_report() {
    const FACETS: f64 = 8e-3;
    const MODES: f64 = 0.02;
    if !railspring_testing::python() {
        return;
    }
    let scenario = "[scenario.push]\nsteps = 24\nvertical_force = { mean_kn = 40 }\nlateral_force = { mean_kn = 10 }\nsnapshots_s = [0]\n";
    let place = Place::new(&resilient(0.34, 4));
    let in_time =
        |transient: &str| format!("{scenario}[solid]\ntransient = {transient:?}\ninner_steps = 8\n");
    place.done(&["run", "-o", "out"], &(place.study(&resilient_of(RUBBER)) + &in_time("reduced")));
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    has(&page, &["wheel, from wheel.vtu", "wheel.materials.rubber", "0.006", "0.499"]);
    // all equations of the meshes, with the groups of their elements, beside the modes of the condensed bodies
    place.done(&["run", "-o", "full"], &(place.study(&resilient_of(RUBBER)) + &in_time("full")));
    let [reduced, full] = ["out", "full"].map(|folder| vertical(&place, folder));
    let peak = full.iter().fold(0.0_f64, |peak, p| p.abs().max(peak));
    assert!(peak > 1.0 && reduced.len() == full.len(), "{full:?}");
    for (reduced, full) in reduced.iter().zip(&full) {
        assert!((reduced - full).abs() < MODES * peak, "{reduced} {full} kN");
    }

    let wheel = with_discs();
    let width: f64 = wheel
        .rows
        .windows(2)
        .filter(|row| (0.018..0.045).contains(&(0.5 * (row[0] + row[1])).abs()))
        .map(|row| row[1] - row[0])
        .sum();
    let place = Place::new(&wheel);
    let discs =
        |keys: &str| place.study(&format!("[wheel.materials.wheel]\n[wheel.materials.discs]\n{keys}"));
    place.done(&["calibrate", "-o", "steel"], &discs(""));
    let iron = "young_gpa = 110\npoisson = 0.26\ndensity_kg_per_m3 = 7200\n";
    place.done(&["run", "-o", "out"], &(discs(iron) + scenario));
    let (iron, steel) = (place.record("out"), place.record("steel"));
    let lighter = (7850.0 - 7200.0) * ring([0.295, 0.195], width);
    let found = (mass(&steel) - mass(&iron)) / lighter;
    assert!(width > 0.02 && (found - 1.0).abs() < FACETS, "{found} of {lighter} kg, {width} m");
    let beam = displacements(&iron, "beam").into_iter().zip(displacements(&steel, "beam"));
    for ([_, iron], [_, steel]) in beam {
        assert!((1e-5..1e-2).contains(&(iron / steel - 1.0)), "{iron} {steel}");
    }
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    has(&page, &["wheel, from wheel.vtu", "wheel.materials.discs", "110"]);
}

/// Goal: the decks have a set and a material for each group, and the mesh that the tool writes has a mask for each.
#[test]
fn decks_and_meshes_have_the_groups() {
    if !railspring_testing::python() {
        return;
    }
    let wheel = resilient(0.34, 2);
    let place = Place::new(&wheel);
    let study = place.study(&resilient_of(RUBBER));
    for format in ["calculix", "abaqus"] {
        place.done(&["deck", "--format", format, "-o", "out"], &study);
        let deck = std::fs::read_to_string(place.path(&format!("out/{format}.inp"))).unwrap();
        has(
            &deck,
            &[
                "** WHEEL-2: rubber\n*ELSET, ELSET=WHEEL-2\n",
                "*SOLID SECTION, ELSET=WHEEL-2, MATERIAL=WHEEL-2",
            ],
        );
        has(&deck, &["*MATERIAL, NAME=WHEEL-2\n*ELASTIC\n6.000000000000e0, 0.499\n*DENSITY\n1.2"]);
        has(&deck, &["*MATERIAL, NAME=RAIL\n*ELASTIC\n2.100000000000e5, 0.3\n"]);
        let members = |name: &str| -> Vec<usize> {
            let (_, after) = deck.split_once(&format!("*ELSET, ELSET={name}\n")).unwrap();
            let lines = after.lines().take_while(|line| !line.starts_with('*'));
            lines.flat_map(|line| line.split(',').filter_map(|n| n.trim().parse().ok())).collect()
        };
        let mut all: Vec<usize> =
            ["WHEEL-1", "WHEEL-2", "WHEEL-3"].iter().flat_map(|set| members(set)).collect();
        all.sort_unstable();
        let (first, count) = (all[0], all.len());
        assert_eq!(all, (first..first + count).collect::<Vec<_>>(), "every element once");
    }
    place.done(&["mesh", "-o", "m"], &study);
    let mesh = std::fs::read_to_string(place.path("m/wheel.vtu")).unwrap();
    has(&mesh, &["Name=\"tyre\"", "Name=\"rubber\"", "Name=\"centre\""]);
}

/// Goal: the independent solver agrees with the tool on the same mesh and materials; the mesh that the tool writes gives the same springs to the last bit;
/// CONTACT has the constants at the running surface, and Hertz's contact those of both bodies.
#[test]
#[ignore = "a minute: cargo long wheel_materials"]
fn the_groups_reach_other_programs() {
    if !railspring_testing::python() {
        return;
    }
    let place = Place::new(&resilient(0.34, 2));
    let study = place.study(&resilient_of(RUBBER));
    place.done(&["calibrate", "-o", "own"], &study);
    place.done(&["mesh", "-o", "m"], &study);
    let again = study
        .replace("wheel.vtu", "m/wheel.vtu")
        .replace("\"running surface\"", "\"contact\"")
        .replace("\"bore\"", "\"held\"");
    place.done(&["calibrate", "-o", "again"], &again);
    let (own, again) = (place.record("own"), place.record("again"));
    assert_eq!(displacements(&own, "beam"), displacements(&again, "beam"));
    let surface = own["mesh"].as_array().unwrap().iter().find(|mesh| mesh["body"] == "wheel").unwrap();
    assert_eq!((&surface["surface_young_gpa"], &surface["surface_poisson"]), (&210.0.into(), &0.3.into()));

    // CONTACT gets the constants at both surfaces
    let other = study.replace(
        "[wheel.materials.tyre]\n",
        "[wheel.materials.tyre]\nyoung_gpa = 190\npoisson = 0.25\ndensity_kg_per_m3 = 7850\n",
    );
    place.done(&["calibrate", "-o", "other"], &other);
    let output = assert_cmd::Command::cargo_bin("railspring")
        .unwrap()
        .current_dir(place.folder.root())
        .args(["export", "other/stiffness.json", "--to", "contact", "--study", "study.toml", "-o", "contact"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let case = std::fs::read_to_string(place.path("contact/contact.inp")).unwrap();
    has(&case, &["0.3 0.25 80769.231 76000.000   POISS"]);
    let hertz = |record: &Value| record["touch"]["hertz_kn_per_m"].as_f64().unwrap();
    let modulus = |young: f64, poisson: f64| (1.0 - poisson * poisson) / young;
    let softer = 2.0 * modulus(210.0, 0.3) / (modulus(210.0, 0.3) + modulus(190.0, 0.25));
    let found = hertz(&place.record("other")) / hertz(&own);
    assert!(
        (found - softer.powf(2.0 / 3.0)).abs() < 1e-6,
        "{found}: Hertz goes with the modulus to two thirds"
    );

    let short = study.replace("load_max_kn = 85", "load_max_kn = 40") + "[contact]\nfriction = 0\n";
    place.done(&["crosscheck", "-o", "out"], &short);
    let record: Value =
        serde_json::from_slice(&std::fs::read(place.path("out/crosscheck.json")).unwrap()).unwrap();
    let checks = record["checks"].as_array().unwrap();
    let same: Vec<&Value> = checks
        .iter()
        .filter(|check| check["problem"].as_str().unwrap().ends_with("same mesh and element"))
        .collect();
    let failing: Vec<_> = same.iter().filter(|check| check["holds"] != true).collect();
    assert!(same.len() > 10 && failing.is_empty(), "{failing:?}");
    let wheels: Vec<_> =
        same.iter().filter(|check| check["problem"].as_str().unwrap().contains("wheel")).collect();
    assert!(!wheels.is_empty());
}

/// Goal: what is wrong with groups and materials is refused with the line of the study, the name or the place, and the remedy.
#[test]
fn wrong_groups_and_materials_are_refused() {
    if !railspring_testing::python() {
        return;
    }
    let place = Place::new(&resilient(0.34, 1));
    let refused = |study: &str, parts: &[&str]| {
        let output = place.run(&["calibrate", "-o", "refused"], study);
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(!place.path("refused").exists(), "nothing is left behind");
        has(&text, parts);
    };
    let of = |materials: &str| place.study(materials);
    refused(
        &of(&resilient_of(RUBBER)),
        &[
            "study.toml:2",
            "wheel.materials = one element of \"rubber\" between others or held nodes around (",
            "two elements through a layer",
        ],
    );
    let soft = "young_gpa = 0.006\npoisson = 0.48\ndensity_kg_per_m3 = 1200\n";
    refused(
        &of(&resilient_of(soft).replace("materials.rubber", "materials.gum")),
        &[
            "wheel.materials.gum = \"gum\": expected a name that the mesh file has: \"centre\" (cell mask), \"rubber\" (cell mask), \"tyre\"",
        ],
    );
    refused(
        &of(&resilient_of(soft).replace("[wheel.materials.centre]\n", "")),
        &[
            "wheel.materials = ",
            " hexahedra in none of the groups named, the first around (",
            "without keys has the material of its body",
        ],
    );
    refused(
        &of(&resilient_of("young_gpa = 0.006\n")),
        &["wheel.materials.rubber.poisson = (missing)", "add this key to [wheel.materials.rubber]"],
    );
    let incompressible = "young_gpa = 0.006\npoisson = 0.4999\ndensity_kg_per_m3 = 1200\n";
    refused(&of(&resilient_of(incompressible)), &["wheel.materials.rubber.poisson = 0.4999", "0 to 0.4995"]);
    refused(
        &of(&resilient_of(RUBBER)).replace("[mesh]\n", "[mesh]\nelement = \"full-integration\"\n"),
        &[
            "wheel.materials.rubber.poisson = 0.499",
            "a ratio up to 0.49 with mesh.element = \"full-integration\", whose elements lock",
        ],
    );
    let own = of(&resilient_of(soft));
    let without: String = own
        .lines()
        .filter(|l| !l.contains("mesh_") && !l.contains("_surface") && !l.contains("held"))
        .map(|l| format!("{l}\n"))
        .collect();
    refused(&without, &["wheel.materials.centre = \"centre\": expected wheel.mesh_file beside it"]);
    // the section of a rail has the material of its beam, the plates at its ends have others
    place.rail();
    let rail = |group: &str| {
        const FILE: &str = "profile = \"60E1\"\nmesh_file = \"rail.vtu\"\nmesh_unit = \"m\"\ncontact_surface = \"contact\"\nheld_nodes = \"held\"\n";
        const OTHER: &str = "young_gpa = 205\npoisson = 0.29\ndensity_kg_per_m3 = 7800\n";
        let keys = |name: &str| if name == group { OTHER } else { "" };
        let sections = ["middle", "ends"].map(|name| format!("[rail.materials.{name}]\n{}", keys(name)));
        own.replace("profile = \"60E1\"\n", FILE) + &sections.concat()
    };
    refused(
        &rail("middle"),
        &[
            "rail.materials = \"middle\" in the section of the rail, around (",
            "the material of the rail in the whole section",
        ],
    );
    place.done(&["mesh", "-o", "ends"], &rail("ends"));
}
