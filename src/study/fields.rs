//! Which key of the study every field of the library comes from: the one table that turns the library's errors into
//! messages about the study.

use railspring_profiles::error::{Error, InputError};
use railspring_profiles::field::InputField;

use super::source::Source;

/// Stands in a key for the name of the scenario.
const ANY: &str = ".*.";

/// The keys that set a field. Where there are several, the first that the file gives is the one, else the last. A
/// field without keys is set by the program.
pub(super) const TABLE: &[(InputField, &[&str])] = &[
    (InputField::ProfilePart, &[]),
    (InputField::ProfileUnit, &[]),
    (InputField::ProfileKind, &[]),
    (InputField::RailName, &["rail.standard", "rail.profile"]),
    (InputField::RailHead, &["rail.profile_file"]),
    (InputField::RailBody, &["rail.body"]),
    (InputField::RailAligned, &["rail.profile_aligned"]),
    (InputField::RailProfilePart, &["rail.profile_part"]),
    (InputField::RailProfileUnit, &["rail.profile_unit"]),
    (InputField::RailLength, &["rail.length_m"]),
    (InputField::RailMesh, &["rail.mesh_file"]),
    (InputField::RailMeshUnit, &["rail.mesh_unit"]),
    (InputField::RailContactSurface, &["rail.contact_surface"]),
    (InputField::RailHeldNodes, &["rail.held_nodes"]),
    (InputField::RailMaterials, &["rail.materials"]),
    (InputField::WheelName, &["wheel.standard", "wheel.profile"]),
    (InputField::WheelProfile, &["wheel.profile_file"]),
    (InputField::WheelAligned, &["wheel.profile_aligned"]),
    (InputField::WheelProfilePart, &["wheel.profile_part"]),
    (InputField::WheelProfileUnit, &["wheel.profile_unit"]),
    (InputField::TapeCircle, &["wheel.tape_circle_mm"]),
    (InputField::TapeDiameter, &["wheel.tape_diameter_m"]),
    (InputField::FlangeHeight, &["wheel.flange_height_mm"]),
    (InputField::FlangeThickness, &["wheel.flange_thickness_mm"]),
    (InputField::BoreDiameter, &["wheel.bore_mm"]),
    (InputField::HubDiameter, &["wheel.hub_diameter_mm"]),
    (InputField::RimDepth, &["wheel.rim_depth_mm"]),
    (InputField::WebThickness, &["wheel.web_thickness_mm"]),
    (InputField::WebHubY, &["wheel.web_hub_y_mm"]),
    (InputField::WebRimY, &["wheel.web_rim_y_mm"]),
    (InputField::WheelMesh, &["wheel.mesh_file"]),
    (InputField::WheelMeshUnit, &["wheel.mesh_unit"]),
    (InputField::WheelContactSurface, &["wheel.contact_surface"]),
    (InputField::WheelHeldNodes, &["wheel.held_nodes"]),
    (InputField::WheelMaterials, &["wheel.materials"]),
    (InputField::Gauge, &["track.gauge_mm"]),
    (InputField::GaugeHeight, &["track.gauge_height_mm"]),
    (InputField::FlangeBack, &["track.flange_back_mm"]),
    (InputField::LateralShift, &["track.lateral_shift_mm"]),
    (InputField::Inclination, &["rail.inclination"]),
    (InputField::Young, &["material.young_gpa"]),
    (InputField::Poisson, &["material.poisson"]),
    (InputField::Density, &["material.density_kg_per_m3"]),
    (InputField::Damping, &["material.damping_ratio"]),
    (InputField::ContactElement, &["mesh.contact_element_mm"]),
    (InputField::ContactElementAlong, &["mesh.contact_element_along_mm"]),
    (InputField::WindowHalfLength, &["mesh.window_half_length_mm"]),
    (InputField::Growth, &["mesh.growth"]),
    (InputField::Layers, &["mesh.layers"]),
    (InputField::FirstLayer, &["mesh.first_layer_mm"]),
    (InputField::LayerGrowth, &[]),
    (InputField::SectionGrowth, &[]),
    (InputField::RailSectionElement, &["mesh.rail_section_element_mm"]),
    (InputField::WheelSectionElement, &["mesh.wheel_section_element_mm"]),
    (InputField::RailLengthElement, &["mesh.rail_length_element_mm"]),
    (InputField::WheelArcElement, &["mesh.wheel_arc_element_mm"]),
    (InputField::RailZoneFaceDepth, &[]),
    (InputField::RailZoneFieldY, &[]),
    (InputField::WheelZoneFaceDepth, &[]),
    (InputField::WheelZoneFieldY, &[]),
    (InputField::Enforcement, &["contact.enforcement"]),
    (InputField::Loads, &["calibration.loads_kn", "calibration.load_max_kn"]),
    (InputField::HorizontalPreloads, &["calibration.horizontal_preloads_kn"]),
    (InputField::BeamElements, &["simulation.rail_elements"]),
    (InputField::NodeSpacing, &["simulation.rail_node_spacing_mm"]),
    (InputField::Penalty, &["simulation.contact_penalty_kn_per_m"]),
    (InputField::Dissipation, &[]),
    (InputField::HorizontalStiffness, &["simulation.horizontal_kn_per_m"]),
    (InputField::TimeStep, &["scenario.*.time_step_s"]),
    (InputField::InnerSteps, &["simulation.inner_steps", "solid.inner_steps"]),
    (InputField::Steps, &["scenario.*.steps"]),
    (InputField::Friction, &["scenario.*.friction", "contact.friction"]),
    (InputField::Gravity, &["scenario.*.gravity_m_per_s2"]),
    (InputField::SuspendedMass, &["scenario.*.suspended_mass_t"]),
    (InputField::VerticalStiffness, &["scenario.*.vertical_suspension.stiffness_kn_per_m"]),
    (InputField::VerticalDamping, &["scenario.*.vertical_suspension.damping_kn_s_per_m"]),
    (InputField::LateralStiffness, &["scenario.*.lateral_suspension.stiffness_kn_per_m"]),
    (InputField::LateralDamping, &["scenario.*.lateral_suspension.damping_kn_s_per_m"]),
    (InputField::VerticalForce, &["scenario.*.vertical_force"]),
    (InputField::LateralForce, &["scenario.*.lateral_force"]),
    (InputField::RailTorsion, &["scenario.*.rail_torsion"]),
    (InputField::WheelMass, &["scenario.*.wheel_mass_t"]),
    (InputField::StartX, &["scenario.*.start_x_m"]),
    (InputField::Speed, &["scenario.*.speed_m_per_s"]),
    (InputField::SolidModel, &["scenario.*.solid"]),
];

/// Puts the keys of the study in the place of the library's fields, in the key and, where they are in backticks, in
/// expectation and remedy. `scenario` is the load case that the error belongs to.
pub(super) fn translate(error: InputError, source: &Source, scenario: Option<&str>) -> InputError {
    translated(error, &|key| source.gives(key), scenario)
}

/// The error with the keys of a study in the place of the library's fields; which of several keys for the same value the study gives is not known.
pub fn with_keys(error: InputError) -> InputError {
    translated(error, &|_| false, None)
}

fn translated(error: InputError, gives: &dyn Fn(&str) -> bool, scenario: Option<&str>) -> InputError {
    let key = |name: &str| -> Option<String> {
        let (_, keys) = TABLE.iter().find(|(field, _)| field.name() == name)?;
        let named = |key: &str| match (key.split_once(ANY), scenario) {
            (Some((section, leaf)), Some(scenario)) => Some(format!("{section}.{scenario}.{leaf}")),
            // Without a load case the key stays open: the error is translated again where the load case is known.
            (Some(_), None) => None,
            (None, _) => Some(key.to_string()),
        };
        let mut candidates = keys.iter().filter_map(|key| named(key));
        candidates.clone().find(|key| gives(key)).or_else(|| candidates.next_back())
    };
    let in_text = |text: &str| -> String {
        let parts = text.split('`').enumerate();
        let parts = parts.map(|(index, part)| match key(part).filter(|_| index % 2 == 1) {
            Some(key) => key,
            None => part.to_string(),
        });
        parts.collect::<Vec<_>>().join("`")
    };
    InputError {
        key: key(&error.key).unwrap_or(error.key),
        expected: in_text(&error.expected),
        remedy: in_text(&error.remedy),
        value: error.value,
    }
}

impl Source {
    /// The error with the keys of this study in the place of the library's fields.
    pub fn with_keys(&self, error: InputError) -> InputError {
        translate(error, self, None)
    }

    /// The error of a stage that ran the load case `scenario`, with the keys of that load case.
    pub fn in_scenario(&self, scenario: &str, error: Error) -> Error {
        match error {
            Error::Input(input) => translate(input, self, Some(scenario)).into(),
            other => other,
        }
    }
}

#[cfg(test)]
mod tests;
