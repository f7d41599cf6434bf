//! The springs of a study without a law from a file: those that it has calibrated, or the published ones.

use railspring_calibrate::law::{Form, StiffnessLaw};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::section::body_of_revolution;
use railspring_profiles::units::KILONEWTON_PER_METRE;

use crate::results::bodies::geometry::Geometry;
use crate::results::by_angle::record::StiffnessByAngleRecord;
use crate::results::run::input::SpringsInput;
use crate::results::run::record::{SpringsRecord, SpringsSource};
use crate::results::run::springs::accepted::accepted_reference;
use crate::results::run::springs::contact_element::{of_laws, with_element};
use crate::results::springs::form::NormalLawRecord;
use crate::results::springs::record::{BeamFactors, StiffnessRecord};
use crate::study::{ContactElementKey, LawKey};

/// The springs that a study has calibrated, or the published law if it says so, with the condensed or the lumped element of its laws by contact angle if
/// its simple model has one.
///
/// # Errors
/// As [`check_reference`](super::check_reference); and laws without an element.
pub fn springs_of_study(
    input: &SpringsInput<'_>,
    stiffness: &StiffnessRecord,
    laws: Option<&StiffnessByAngleRecord>,
) -> Result<SpringsRecord> {
    let springs = own_springs(input, stiffness)?;
    let element = of_laws(laws, input.element).map_err(|reason| {
        let name = input.element.name();
        InputError::new(
            "simulation.element",
            format!("{name:?}"),
            format!("a {name} element: {reason}"),
            "calibrate again, or take element = \"published\"",
        )
    })?;
    Ok(match element {
        Some(element) => with_element(springs, element),
        None => springs,
    })
}

/// The published law with a horizontal stiffness (kN/m), a mass of the wheel (kg) and factors of the rail beam.
fn published(horizontal_kn_per_m: f64, wheel_mass_kg: f64, beam: BeamFactors) -> SpringsRecord {
    SpringsRecord {
        source: SpringsSource::Published,
        law: NormalLawRecord::Power(StiffnessLaw::published().into()),
        horizontal_kn_per_m,
        wheel_mass_kg,
        reference: None,
        range_kn: None,
        beam,
        contact_element: ContactElementKey::Published,
        element_blake3: None,
        element_displacement: None,
        element: None,
        notes: vec!["the law is the published one, of UIC 60 and SKS-700, and not of this pair".into()],
    }
}

/// Whether a study runs without a calibration: with the published law, which the published element has, and its own horizontal stiffness. A wheel that
/// is a mesh from a file has its mass from there, unless every load case gives one.
pub fn need_no_calibration(input: &SpringsInput<'_>) -> bool {
    let simulation = &input.simulation;
    !input.cases.is_empty()
        && simulation.law == LawKey::Published
        && simulation.horizontal.is_some()
        && wheel_is_known(input)
}

/// The springs of a study that [needs no calibration](need_no_calibration).
pub fn without_calibration(input: &SpringsInput<'_>, geometry: &Geometry) -> Option<SpringsRecord> {
    let horizontal = input.simulation.horizontal.filter(|_| need_no_calibration(input))?;
    let mass = revolved_mass(input, geometry);
    let mut springs = published(horizontal / KILONEWTON_PER_METRE, mass, BeamFactors::default());
    springs.notes.push(
        "nothing is calibrated: the rail beam is not corrected to the solid rail, and the wheel has the mass of a body of revolution"
            .into(),
    );
    Some(springs)
}

/// Whether the wheel's mass is known without its mesh, or never used.
pub(super) fn wheel_is_known(input: &SpringsInput<'_>) -> bool {
    input.statics.wheel.mesh.is_none() || input.cases.values().all(|case| case.scenario.wheel_mass.is_some())
}

/// Mass of the study's wheel as a body of revolution, kg.
pub(super) fn revolved_mass(input: &SpringsInput<'_>, geometry: &Geometry) -> f64 {
    body_of_revolution(&geometry.pair.wheel, input.statics.wheel.material.density).mass
}

/// The law of a form of a calibration against its reference in use.
///
/// # Errors
/// [`InputError`] with key `simulation.law` for a form that it does not have.
pub(super) fn law_of_form(stiffness: &StiffnessRecord, form: Form) -> Result<NormalLawRecord> {
    if let Some(found) = stiffness.form(form) {
        return Ok(found.law.clone());
    }
    Err(InputError::new(
        "simulation.law",
        format!("{:?}", form.name()),
        "a form that the calibration has; \"steps\" needs eight loads",
        "calibrate at more loads (calibration.load_count), or take \"table\"",
    )
    .into())
}

pub(super) fn own_springs(input: &SpringsInput<'_>, stiffness: &StiffnessRecord) -> Result<SpringsRecord> {
    let horizontal = input.simulation.horizontal.map(|k| k / KILONEWTON_PER_METRE);
    let horizontal_kn_per_m = horizontal.or(stiffness.horizontal_kn_per_m).ok_or_else(|| {
        InputError::new(
            "simulation.horizontal_kn_per_m",
            "(missing)",
            "a horizontal stiffness, which the calibration did not find",
            format!("give it; {}", stiffness.horizontal_missing.as_deref().unwrap_or("or calibrate again")),
        )
    })?;
    let Some(form) = input.simulation.law.form() else {
        return Ok(published(horizontal_kn_per_m, stiffness.wheel_mass(), stiffness.beam.factors));
    };
    let note = accepted_reference(input, "calibration.reference", Some(&stiffness.reference))?;
    let law = law_of_form(stiffness, form)?;
    let of_form =
        (form != Form::Power).then(|| format!("the law has the form `{}`: {}", form.name(), law.formula(4)));
    Ok(SpringsRecord {
        source: SpringsSource::Calibrated,
        law,
        horizontal_kn_per_m,
        wheel_mass_kg: stiffness.wheel_mass(),
        reference: Some(stiffness.reference.clone()),
        range_kn: Some(stiffness.law.range_kn),
        beam: stiffness.beam.factors,
        contact_element: ContactElementKey::Published,
        element_blake3: None,
        element_displacement: None,
        element: None,
        notes: note.into_iter().chain(of_form).collect(),
    })
}
