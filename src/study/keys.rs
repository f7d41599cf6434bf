//! Hashes of what the results of a study depend on, each of its own inputs.
//!
//! A result stays valid when something else in the study changes. Sections are
//! left out by name and everything else counts, so that a new section counts
//! until somebody says that it need not. The program's version counts in all;
//! it fixes the standard profiles. A file counts by its content.

use std::collections::BTreeMap;

use railspring_calibrate::mesh::MeshOptions;
use railspring_profiles::units::MILLIMETRE;
use serde::Serialize;
use serde_json::Value;

use super::document::{BodyMaterialKeys, Inclination, MaterialKeys, StudyDocument};
use super::{MeasuredSurface, MeshFile, Rail, SectionFile, Wheel};

/// The keys of a material that its statics do not see.
const OF_DAMPING: [&str; 2] = ["damping_ratio", "damping_frequency_hz"];

/// The hashes of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Keys {
    /// The whole study without its descriptions and limits, without the bodies in time, and without the field of its contact: that of a cross-check is the
    /// elements.
    pub crosscheck: String,
    /// What the load curve, the laws and the horizontal stiffness depend on. The shifts of the laws by contact angle are no part of it, nor are
    /// the damping, the files for other programs and the study's name, which result files only carry.
    pub springs: String,
    /// The pair that a law belongs to: profiles, bodies, their places and the elastic material; not the rail's length.
    pub pair: String,
    /// The wheel, the rail, and all else that springs depend on, each by itself: what a table names as the cause of a change.
    pub parts: [String; 3],
    /// What a run of the simple model depends on besides its springs, by scenario.
    simple: BTreeMap<String, String>,
    /// What a run of the solid model depends on, by scenario.
    solid: BTreeMap<String, String>,
}

impl Keys {
    /// `window_given`: whether the file gives the length of the contact window; one that it gives is not made longer, though it be as long
    /// as the usual one.
    pub(super) fn new(
        document: &StudyDocument,
        rail: &Rail,
        wheel: &Wheel,
        mesh: &MeshOptions,
        window_given: bool,
    ) -> Self {
        let mut numeric = document.clone();
        // A file counts by its content, wherever it lies.
        numeric.rail.section_file = rail.section.as_ref().map(SectionFile::fingerprint);
        numeric.wheel.section_file = wheel.section.as_ref().map(SectionFile::fingerprint);
        numeric.rail.profile_file = rail.measured.as_ref().map(MeasuredSurface::fingerprint);
        numeric.wheel.profile_file = wheel.measured.as_ref().map(MeasuredSurface::fingerprint);
        // Of a standard rail the inclination by default is the same as given.
        if rail.measured.is_none() {
            numeric.rail.inclination.get_or_insert_with(Inclination::usual);
        }
        // So does a slice, whose content that is.
        numeric.rail.profile_part = rail.measured.as_ref().and_then(|measured| measured.part.clone());
        numeric.wheel.profile_part = wheel.measured.as_ref().and_then(|measured| measured.part.clone());
        numeric.rail.mesh_file = rail.mesh.as_ref().map(MeshFile::fingerprint);
        numeric.wheel.mesh_file = wheel.mesh.as_ref().map(MeshFile::fingerprint);
        numeric.description.clear();
        let own = of_their_own(&numeric);
        one_form(&mut numeric);
        // Layers count as they are, given or following from the contact element; those under the default one by being left out.
        let (layers, first_layer) = mesh.layering();
        let usual = MeshOptions::default().layering();
        numeric.mesh.layers = Some(layers).filter(|layers| *layers != usual.0);
        numeric.mesh.first_layer_mm =
            Some(first_layer).filter(|first| *first != usual.1).map(|first| first / MILLIMETRE);
        numeric.calibration.shifts_mm = None;
        for keys in numeric.scenario.values_mut() {
            keys.description.clear();
            keys.snapshots_s.clear();
        }
        numeric.verification = Default::default();
        // No number depends on the fields for other programs.
        let mut whole = without(&serde_json::to_value(&numeric).expect("a study is plain data"), &["output"]);
        // The ends of a conical web are none of other wheels.
        if whole["wheel"]["body"] != "conical-web" {
            remove(&mut whole, "wheel", "web_hub_y_mm");
            remove(&mut whole, "wheel", "web_rim_y_mm");
        }

        // The deflection of the beam is part of the calibration, and the beam is that of the simulation.
        let calibrated = |sections: &Value| hash(&(sections, numeric.simulation.rail_elements, window_given));
        let mut springs = without(&whole, &["name", "scenario", "simulation", "solid", "verification"]);
        for key in OF_DAMPING {
            remove(&mut springs, "material", key);
        }
        // the reference solvers have the nodes of the meshes
        let mut crosscheck = without(&whole, &["solid"]);
        remove(&mut crosscheck, "contact", "field");
        remove(&mut crosscheck, "calibration", "error_band");
        remove(&mut crosscheck, "calibration", "foot_held");
        remove(&mut crosscheck, "simulation", "inner_steps");
        remove(&mut crosscheck, "simulation", "element");
        // a cross-check has no run and no limit of the verdict; the kept hashes have the defaults of their time in them
        crosscheck["verification"] = serde_json::json!({
            "vertical_rms": 0.15, "vertical_max": 0.75, "lateral_rms": 0.15, "lateral_max": 0.75,
            "ratio_rms": 0.15, "ratio_max": 0.50, "ratio_window_s": 0.024, "ratio_floor": 0.05,
            "separation_begin_s": 0.005, "separation_end_s": 0.005, "separations_unmatched": 0,
            "departure_s": 0.005, "separation_shortest_s": 0.002, "mode_fraction": 0.10,
            "law_max": 0.15, "law_displacement": 0.03, "beam_missing": 0.02,
            "horizontal_spread": 0.10, "published_stiffness": 1.0,
        });
        let parts = parts(&springs, &own, &document.material);
        let springs = calibrated(&springs);
        let mut pair = without(
            &whole,
            &[
                "name",
                "description",
                "mesh",
                "contact",
                "calibration",
                "simulation",
                "solid",
                "scenario",
                "verification",
            ],
        );
        for (section, key) in [
            ("rail", "length_m"),
            ("material", "density_kg_per_m3"),
            ("material", "damping_ratio"),
            ("material", "damping_frequency_hz"),
        ] {
            remove(&mut pair, section, key);
        }
        remove(&mut pair["wheel"], "material", "density_kg_per_m3");
        if pair["wheel"]["material"].as_object().is_some_and(serde_json::Map::is_empty) {
            remove(&mut pair, "wheel", "material");
        }
        for body in ["rail", "wheel"] {
            let groups = pair[body].get_mut("materials").and_then(Value::as_object_mut);
            groups.into_iter().flatten().for_each(|(_, group)| {
                group.as_object_mut().and_then(|group| group.remove("density_kg_per_m3"));
            });
        }

        // The springs carry what the simple model has of the meshes and of the calibration.
        let mut simple =
            without(&whole, &["name", "mesh", "calibration", "solid", "scenario", "verification"]);
        // Which scenario is the main one decides on names of files alone.
        remove(&mut simple, "simulation", "scenario");
        let solid = without(&whole, &["name", "calibration", "simulation", "scenario", "verification"]);
        // The sections that all scenarios share are hashed once.
        let (simple, solid) = (hash(&simple), hash(&(solid, window_given, numeric.calibration.error_band)));
        let each = |shared: &str| {
            let with = |keys: &super::document::ScenarioKeys| {
                let mut keys = keys.clone();
                // Whether the other model runs changes nothing.
                keys.solid = true;
                hash(&(shared, keys))
            };
            numeric.scenario.iter().map(|(name, keys)| (name.clone(), with(keys))).collect()
        };
        Self {
            crosscheck: hash(&crosscheck),
            springs,
            pair: hash(&pair),
            parts,
            simple: each(&simple),
            solid: each(&solid),
        }
    }

    /// Key of a run of the simple model with some springs.
    pub fn simple(&self, scenario: &str, springs: &impl Serialize) -> String {
        hash(&("simple", self.simple.get(scenario), springs))
    }

    /// Key of a run of the solid model.
    pub fn solid(&self, scenario: &str) -> String {
        hash(&("solid", self.solid.get(scenario)))
    }
}

/// What the wheel and the rail have of their own of the keys of their materials.
fn of_their_own(document: &StudyDocument) -> [BodyMaterialKeys; 2] {
    let both = &document.material;
    [&document.wheel.material, &document.rail.material]
        .map(|own| BodyMaterialKeys::between(both, &own.over(both)))
}

/// Gives a study whose bodies have the same materials as those of another one the same keys: `[material]` is that of the rail, and
/// the wheel has what differs. Which of the tables gives a value changes no result.
fn one_form(document: &mut StudyDocument) {
    let [rail, wheel] =
        [&document.rail.material, &document.wheel.material].map(|own| own.over(&document.material));
    document.rail.material = BodyMaterialKeys::default();
    document.wheel.material = BodyMaterialKeys::between(&rail, &wheel);
    document.material = rail;
}

/// The wheel, the rail and the rest of what `springs` depend on, each body with what is its `own` of its material and the rest with that `of_both`:
/// a change is that of the section in which it was made.
fn parts(springs: &Value, own: &[BodyMaterialKeys; 2], of_both: &MaterialKeys) -> [String; 3] {
    let body = |name: &str, own: &BodyMaterialKeys| {
        let mut body = without(&springs[name], &["material"]);
        if !own.is_empty() {
            body["material"] = serde_json::json!(own);
        }
        hash(&body)
    };
    let mut settings = without(springs, &["wheel", "rail"]);
    settings["material"] = without(&serde_json::json!(of_both), &OF_DAMPING);
    let [wheel, rail] = own;
    [body("wheel", wheel), body("rail", rail), hash(&settings)]
}

/// An object without some of its keys.
fn without(object: &Value, keys: &[&str]) -> Value {
    let mut rest = object.clone();
    if let Some(rest) = rest.as_object_mut() {
        rest.retain(|key, _| !keys.contains(&key.as_str()));
    }
    rest
}

fn remove(object: &mut Value, section: &str, key: &str) {
    if let Some(section) = object.get_mut(section).and_then(Value::as_object_mut) {
        section.remove(key);
    }
}

/// Hash of a value and of the program's version. Keys of objects are sorted, so that the text is canonical.
fn hash(value: &impl Serialize) -> String {
    let canonical = serde_json::to_value(value).expect("a study is plain data").to_string();
    let mut hasher = blake3::Hasher::new();
    hasher.update(env!("CARGO_PKG_VERSION").as_bytes());
    hasher.update(b"\n");
    hasher.update(canonical.as_bytes());
    hasher.finalize().to_hex().to_string()
}
