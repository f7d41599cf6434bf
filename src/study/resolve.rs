//! From the keys of the file to values in SI units, with the checks that
//! concern several keys at once.

mod assessment;
mod bodies;
mod load_cases;
mod uncertainty;

use std::collections::BTreeMap;

use assessment::measured_curve;
use bodies::{rail, wheel};
use load_cases::{scenario, take_tables};
use railspring_calibrate::mesh::MeshOptions;
use railspring_profiles::error::InputError;
use railspring_profiles::units::{KILONEWTON, KILONEWTON_PER_METRE, MILLIMETRE};
use railspring_simulate::solid::RailPath;
use serde_json::Value;
use uncertainty::uncertainty;

use super::analysis::{CalibrationSettings, ContactSettings, SimulationSettings, StudyScenario};
use super::case_notes;
use super::check::{Finding, nearest};
use super::checked::Study;
use super::collect::Collector;
use super::document::{
    CalibrationKeys, ContactElementKey, ContactKeys, EnforcementKey, FieldKey, Inclination, LawKey, MeshKeys,
    ReferenceKey, SECTIONS, ScenarioKeys, SpacingKey, StudyDocument, TransientKey,
};
use super::pair::Track;
use super::record::{ResolvedKey, ResolvedKeys};
use super::source::{LocatedError, Source};

type Result<T> = std::result::Result<T, InputError>;

/// Checks the keys against each other and converts them to SI units; `findings` and `mistakes` are those of the check
/// against the schema.
///
/// # Errors
/// All mistakes, those of the schema first.
pub(super) fn resolve(
    document: StudyDocument,
    source: Source,
    findings: &[Finding],
    mistakes: Vec<LocatedError>,
) -> std::result::Result<Study, Vec<LocatedError>> {
    let mut collector = Collector::new(&source, findings, mistakes);
    collector.take(&["name"], check_name(&document.name));
    let solid = (&document.material, document.mesh.element);
    let rail = rail(&document.rail, solid, &source, &mut collector);
    let wheel = wheel(&document.wheel, solid, &source, &mut collector);
    let calibration = collector.take(&["calibration.*"], calibration(&document.calibration));
    collector.take(&["contact.*"], contact(&document.contact));
    let friction = document.contact.friction;
    let mut scenarios = BTreeMap::new();
    for (name, keys) in &document.scenario {
        let here = format!("scenario.{name}.*");
        for mistake in scenario_mistakes(name, keys, &document) {
            collector.add(&[&here, "rail.length_m"], mistake);
        }
        let mut resolved = scenario(keys, friction);
        take_tables((name, keys, &mut resolved), &source, &mut collector);
        let checked = resolved.scenario.check().map_err(|error| source.with_keys_of(name, error));
        collector.take(&[&here, "contact.friction"], checked);
        scenarios.insert(name.clone(), resolved);
    }
    collector.take(
        &["simulation.element", "simulation.law", "calibration.shifts_mm", "calibration.elements"],
        element(&document),
    );
    let main_scenario = collector.take(&["simulation.scenario"], main_scenario(&document, &source));
    collector
        .take(&["verification.published_stiffness", "calibration.*"], published_limit(&document, &source));
    let measured_curve = collector.take(
        &["validation.*", "calibration.*"],
        measured_curve(&document.validation, &source, calibration.as_ref()),
    );
    let mistakes = collector.into_mistakes();
    let (Some(rail), Some(wheel), Some(calibration), Some(main_scenario), Some(measured_curve), true) =
        (rail, wheel, calibration, main_scenario, measured_curve, mistakes.is_empty())
    else {
        return Err(mistakes);
    };
    let mesh = mesh_options(&document.mesh);
    let beyond_the_solid = off_the_path(&document, &source, &scenarios, &mesh, rail.mesh.is_some());
    if !beyond_the_solid.is_empty() {
        return Err(beyond_the_solid);
    }
    for (name, case) in &mut scenarios {
        let of = (name.as_str(), &document.scenario[name], &case.scenario);
        case.notes = case_notes::notes(of, &document, &source, &calibration.loads);
    }
    let resolved = resolved_keys(&document, &source);
    let measured = [rail.measured.is_some(), wheel.measured.is_some()];
    Ok(Study {
        name: document.name,
        description: document.description,
        intended_use: document.intended_use,
        rail,
        wheel,
        damping: document.material.damping(),
        track: Track {
            gauge: document.track.gauge_mm * MILLIMETRE,
            gauge_height: document.track.gauge_height_mm * MILLIMETRE,
            flange_back: document.track.flange_back_mm * MILLIMETRE,
            lateral_shift: document.track.lateral_shift_mm * MILLIMETRE,
        },
        mesh,
        element: document.mesh.element,
        target_error: document.mesh.target_error,
        contact: ContactSettings {
            field: document.contact.field,
            enforcement: document.contact.enforcement,
            penalty: document.contact.penalty_kn_per_m * KILONEWTON_PER_METRE,
            friction,
        },
        calibration,
        uncertainty: uncertainty(&document.uncertainty, measured),
        shifts: document
            .calibration
            .shifts_mm
            .map(|shifts| shifts.iter().map(|mm| mm * MILLIMETRE).collect()),
        elements: document.calibration.elements,
        simulation: SimulationSettings {
            element: document.simulation.element,
            law: document.simulation.law,
            horizontal: document.simulation.horizontal_kn_per_m.map(|k| k * KILONEWTON_PER_METRE),
            rail_elements: document.simulation.rail_elements,
            contact_penalty: document.simulation.contact_penalty_kn_per_m * KILONEWTON_PER_METRE,
            rail_node_spacing: document.simulation.rail_node_spacing_mm * MILLIMETRE,
            sliding_matrix: document.simulation.sliding_matrix,
            inner_steps: document.simulation.inner_steps,
            law_accepted: document.simulation.law_accepted,
        },
        solid: document.solid,
        scenarios,
        main_scenario,
        limits: document.verification,
        measured: measured_curve,
        review: document.review,
        output: document.output,
        resolved,
        source,
    })
}

/// Load cases whose wheel leaves the part of the rail that the solids know; values by themselves are right by then.
fn off_the_path(
    document: &StudyDocument,
    source: &Source,
    scenarios: &BTreeMap<String, StudyScenario>,
    mesh: &MeshOptions,
    rail_from_file: bool,
) -> Vec<LocatedError> {
    let mut collector = Collector::new(source, &[], Vec::new());
    let length = document.rail.length_m;
    // a fine grid reaches beyond a window that is not given
    let beyond = document.contact.field == FieldKey::Hybrid && !source.gives("mesh.window_half_length_mm");
    let contact_half_length = mesh.window_half_length * if beyond { 2.0 } else { 1.0 };
    let options = MeshOptions { contact_half_length, ..mesh.clone() };
    for (name, case) in scenarios {
        if case.solid && RailPath::is_wanted(&case.scenario, length) {
            let here = format!("scenario.{name}.*");
            if rail_from_file {
                let key = format!("scenario.{name}.solid");
                let expected = "false, because the solids know a rail along its length from its section, and a mesh from a file in its middle alone";
                let mistake = InputError::new(
                    key,
                    "true",
                    expected,
                    format!("set `scenario.{name}.solid` = false, or leave `rail.mesh_file` out"),
                );
                collector.add(&[&here, "rail.mesh_file"], mistake);
                continue;
            }
            let checked = RailPath::check(&case.scenario, length, RailPath::reach(length, &options));
            let checked = checked.map_err(|error| source.with_keys_of(name, error));
            collector.take(&[&here, "rail.length_m"], checked);
        }
    }
    collector.into_mistakes()
}

/// The published law is compared with that against the held foot.
fn published_limit(document: &StudyDocument, source: &Source) -> Result<()> {
    const LIMIT: &str = "verification.published_stiffness";
    let keys = &document.calibration;
    if keys.foot_held || keys.reference == ReferenceKey::Foot || !source.gives(LIMIT) {
        return Ok(());
    }
    Err(InputError::new(
        LIMIT,
        document.verification.published_stiffness,
        "a study with a law against the rail's held foot, which the published one is compared with",
        "set `calibration.foot_held = true`, or leave the limit out",
    ))
}

/// Penalty springs stand at the nodes of the meshes, where the fine grid has none.
fn contact(keys: &ContactKeys) -> Result<()> {
    if (keys.field, keys.enforcement) != (FieldKey::Hybrid, EnforcementKey::Penalty) {
        return Ok(());
    }
    Err(InputError::new(
        "contact.enforcement",
        "\"penalty\"",
        "\"exact\" with `contact.field` = \"hybrid\"",
        "penalty springs stand at the nodes of the meshes: take `contact.enforcement` = \"exact\", or `contact.field` = \"elements\"",
    ))
}

fn check_name(name: &str) -> Result<()> {
    let plain = name.chars().all(|c| c.is_alphanumeric() || "-_.".contains(c));
    if plain && !name.starts_with('.') {
        return Ok(());
    }
    Err(InputError::new(
        "name",
        format!("{name:?}"),
        "letters, digits, `-`, `_` and `.`, not starting with `.`",
        "the name becomes the name of the output folder; take a plain one",
    ))
}

fn calibration(keys: &CalibrationKeys) -> Result<CalibrationSettings> {
    let loads: Vec<f64> = match &keys.loads_kn {
        Some(list) => list.clone(),
        None => {
            if keys.load_max_kn <= keys.load_min_kn {
                return Err(InputError::new(
                    "calibration.load_max_kn",
                    keys.load_max_kn,
                    format!("more than calibration.load_min_kn = {}", keys.load_min_kn),
                    "give an ascending range",
                ));
            }
            spaced(keys.load_min_kn, keys.load_max_kn, keys.load_count, keys.load_spacing)
        }
    };
    check_ascending("calibration.loads_kn", &loads, "loads")?;
    check_ascending("calibration.shifts_mm", keys.shifts_mm.as_deref().unwrap_or_default(), "shifts")?;
    let preloads = &keys.horizontal_preloads_kn;
    check_ascending("calibration.horizontal_preloads_kn", preloads, "preloads")?;
    let fixed = &keys.stiffness_at_kn;
    check_ascending("calibration.stiffness_at_kn", fixed, "loads")?;
    Ok(CalibrationSettings {
        loads: loads.iter().map(|load| load * KILONEWTON).collect(),
        reference: keys.reference,
        foot_held: keys.foot_held || keys.reference == ReferenceKey::Foot,
        error_band: keys.error_band,
        horizontal_preloads: preloads.iter().map(|load| load * KILONEWTON).collect(),
        fixed_loads: fixed.iter().map(|load| load * KILONEWTON).collect(),
    })
}

/// Refuses a list of `what` under a key that does not ascend.
fn check_ascending(key: &str, list: &[f64], what: &str) -> Result<()> {
    match list.windows(2).find(|pair| pair[1] <= pair[0]) {
        Some(pair) => Err(InputError::new(
            key,
            format!("{}, {}", pair[0], pair[1]),
            format!("ascending {what} without repetition"),
            "sort the list",
        )),
        None => Ok(()),
    }
}

/// `count` values from `low` to `high`, both ends exact.
fn spaced(low: f64, high: f64, count: usize, spacing: SpacingKey) -> Vec<f64> {
    (0..count)
        .map(|index| {
            let t = index as f64 / (count - 1) as f64;
            match (index, spacing) {
                (0, _) => low,
                (last, _) if last == count - 1 => high,
                (_, SpacingKey::Linear) => low + t * (high - low),
                (_, SpacingKey::Approach) => {
                    let approach = |load: f64| load.powf(2.0 / 3.0);
                    (approach(low) + t * (approach(high) - approach(low))).powf(1.5)
                }
                (_, SpacingKey::Geometric) => low * (high / low).powf(t),
            }
        })
        .collect()
}

/// What is wrong with a load case.
fn scenario_mistakes(name: &str, keys: &ScenarioKeys, document: &StudyDocument) -> Vec<InputError> {
    let rail_length = document.rail.length_m;
    let mut mistakes = Vec::new();
    let key = |leaf: &str| format!("scenario.{name}.{leaf}");
    if name.is_empty() || !name.chars().all(|c| c.is_alphanumeric() || "-_".contains(c)) {
        mistakes.push(InputError::new(
            key("").trim_end_matches('.'),
            format!("{name:?}"),
            "a scenario name of letters, digits, `-` and `_`",
            "the name becomes part of file names; take a plain one",
        ));
    }
    let moving = keys.solid && RailPath::is_wanted(&scenario(keys, 0.0).scenario, rail_length);
    if moving && document.solid.transient == TransientKey::Full {
        mistakes.push(InputError::new(
            key("solid"),
            "true",
            "false, because bodies at full order (`solid.transient = \"full\"`) have a contact in the middle of an untwisted rail alone",
            format!("set `{}` = false, or take reduced bodies (`solid.transient`)", key("solid")),
        ));
    }
    let start = keys.start_x_m.unwrap_or(0.5 * rail_length);
    if start > rail_length {
        mistakes.push(InputError::new(
            key("start_x_m"),
            start,
            format!("a place on the rail, 0 to {rail_length} m"),
            "start elsewhere, or lengthen the rail",
        ));
    }
    mistakes
}

/// Some names, of a long list the first and their number.
fn listed(names: &[&str]) -> String {
    const MOST: usize = 12;
    match names.len() {
        0 => "there is none".into(),
        1..=MOST => names.join(", "),
        count => format!("{}, … {count} in all", names[..MOST].join(", ")),
    }
}

/// An element that is made from the solids has the laws by contact angle, and no other springs.
fn element(document: &StudyDocument) -> Result<()> {
    let (simulation, calibration) = (&document.simulation, &document.calibration);
    let no_laws = calibration.shifts_mm.as_ref().is_some_and(Vec::is_empty);
    if calibration.elements == Some(true) && no_laws {
        return Err(InputError::new(
            "calibration.elements",
            "true",
            "laws by contact angle, which calibration.shifts_mm = [] leaves out",
            "remove calibration.shifts_mm, or calibration.elements",
        ));
    }
    let Some(element) = simulation.element.filter(|element| *element != ContactElementKey::Published) else {
        return Ok(());
    };
    let refuse = |because: &str, remedy: &str| {
        Err(InputError::new("simulation.element", format!("{:?}", element.name()), because, remedy))
    };
    if calibration.elements == Some(false) {
        return refuse(
            "an element that calibration.elements = false leaves out",
            "remove calibration.elements, or take element = \"published\"",
        );
    }
    if no_laws {
        return refuse(
            "laws by contact angle, which calibration.shifts_mm = [] leaves out",
            "remove calibration.shifts_mm, or take element = \"published\"",
        );
    }
    if simulation.law == LawKey::Published {
        return refuse(
            "\"published\" beside simulation.law = \"published\"",
            "remove simulation.law, or take element = \"published\"",
        );
    }
    Ok(())
}

fn main_scenario(document: &StudyDocument, source: &Source) -> Result<Option<String>> {
    let names: Vec<&str> = document.scenario.keys().map(String::as_str).collect();
    match &document.simulation.scenario {
        // One that has a mistake itself is not in the document.
        Some(name) if document.scenario.contains_key(name) || source.gives(&format!("scenario.{name}")) => {
            Ok(Some(name.clone()))
        }
        Some(name) => Err(InputError::new(
            "simulation.scenario",
            format!("{name:?}"),
            format!("one of the study's scenarios ({})", listed(&names)),
            match nearest(name, names.iter().copied()) {
                Some(near) => {
                    format!("name a scenario of this file (did you mean `{near}`?), or leave the key out")
                }
                None => "name a scenario of this file, or leave the key out".into(),
            },
        )),
        None => {
            let solid = document.scenario.iter().find(|(_, keys)| keys.solid).map(|(name, _)| name.clone());
            Ok(solid.or_else(|| names.first().map(ToString::to_string)))
        }
    }
}

/// Sizes of the elements.
fn mesh_options(mesh: &MeshKeys) -> MeshOptions {
    MeshOptions {
        contact_element: mesh.contact_element_mm * MILLIMETRE,
        contact_element_along: mesh.contact_element_along_mm * MILLIMETRE,
        window_half_length: mesh.window_half_length_mm * MILLIMETRE,
        layers: mesh.layers,
        first_layer: mesh.first_layer_mm.map(|first| first * MILLIMETRE),
        growth: mesh.growth,
        rail_section_element: mesh.rail_section_element_mm * MILLIMETRE,
        wheel_section_element: mesh.wheel_section_element_mm * MILLIMETRE,
        rail_length_element: mesh.rail_length_element_mm * MILLIMETRE,
        wheel_arc_element: mesh.wheel_arc_element_mm * MILLIMETRE,
        ..MeshOptions::default()
    }
}

/// All keys with their values, flattened: the sections in their order, the keys of each by name.
fn resolved_keys(document: &StudyDocument, source: &Source) -> ResolvedKeys {
    let mut document = document.clone();
    document.rail.inclination.get_or_insert_with(Inclination::usual);
    let value = serde_json::to_value(document).expect("a study is plain data");
    let mut keys = Vec::new();
    for section in SECTIONS {
        if let Some(value) = value.get(section) {
            flatten(section, value, source, &mut keys);
        }
    }
    keys.into()
}

fn flatten(section: &str, value: &Value, source: &Source, keys: &mut Vec<ResolvedKey>) {
    for (key, value) in value.as_object().into_iter().flatten() {
        let full = format!("{section}.{key}");
        match value {
            Value::Object(_) => flatten(&full, value, source, keys),
            // The report shows the descriptions as text.
            _ if key == "description" => {}
            _ => keys.push(ResolvedKey {
                section: section.to_string(),
                key: key.clone(),
                value: plain(value),
                given: source.gives(&full),
            }),
        }
    }
}

/// A value as a person would write it.
fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(items) => items.iter().map(plain).collect::<Vec<_>>().join(", "),
        Value::Number(number) if number.is_f64() => {
            let value = number.as_f64().unwrap_or_default();
            if value.abs() >= 1e6 { format!("{value:e}") } else { value.to_string() }
        }
        other => other.to_string(),
    }
}
