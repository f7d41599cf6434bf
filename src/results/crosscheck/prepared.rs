//! A study with the tool's answers and the questions, and its problem as a deck.

use railspring_profiles::error::Result;

use crate::engine::output::OutputFolder;
use crate::results::bodies::estimate::{self, Resources, Work};
use crate::results::bodies::geometry::{self, Geometry};
use crate::results::bodies::meshes::Meshes;
use crate::results::bodies::zones;
use crate::results::crosscheck::answers::{self, Answers};
use crate::results::crosscheck::deck::{Deck, Format};
use crate::results::crosscheck::exchange::{Case, Exchange};
use crate::results::crosscheck::input::CrosscheckInput;
use crate::results::crosscheck::solvers::purpose;
use crate::study::Statics;

/// Size of a contact element of second order over that of the study: six nodes of the default mesh carry the smallest load.
const CONTACT: f64 = 0.75;
/// The same of the elements of sections: they need fewer, as they bend.
const SECTION: f64 = 2.4;
/// The same of the length around the wheel: they have straight sides, so that the wheel is a polygon, of 0.6 % less area.
const AROUND: f64 = 4.0 / 3.0;

/// A study with the tool's answers and the questions.
pub struct Prepared {
    /// Geometry of the study.
    pub geometry: Geometry,
    /// The study's meshes.
    pub meshes: Meshes,
    /// The tool's answers.
    pub answers: Answers,
    /// The questions.
    pub exchange: Exchange,
}

/// Computes the tool's answers and collects the questions.
///
/// Elements of second order are on other meshes, finer at the contact and coarser elsewhere, with as many layers. A mesh from a file stays as it is.
///
/// # Errors
/// Those of meshing and calibration, and sizes that the machine cannot hold.
pub fn prepare(input: &CrosscheckInput<'_>, cases: &[Case], resources: &Resources<'_>) -> Result<Prepared> {
    let statics = input.statics();
    let geometry = geometry::geometry(statics)?;
    let (options, work) = (zones::mesh_options(statics, &geometry), Work::of_crosscheck(purpose(cases)));
    let (meshes, _) = estimate::meshes(&input.solids(), &geometry, options, &work, resources)?;
    let answers = answers::answers(statics, &geometry, &meshes, resources.monitor)?;
    let other = if cases.contains(&Case::SecondOrder) {
        let mut other = statics.mesh.clone();
        let (layers, first_layer) = other.layering();
        (other.layers, other.first_layer) = (Some(layers), Some(first_layer));
        other.contact_element *= CONTACT;
        other.contact_element_along *= CONTACT;
        other.rail_section_element *= SECTION;
        other.wheel_section_element *= SECTION;
        other.wheel_arc_element *= AROUND;
        Some(zones::remeshed(Statics { mesh: &other, ..statics }, &geometry, &meshes)?)
    } else {
        None
    };
    let exchange = Exchange::new(input, &geometry, &meshes, other.as_ref(), &answers, cases);
    Ok(Prepared { geometry, meshes, answers, exchange })
}

/// Writes a deck of the study's problem into `folder`: its own element and friction, a step for every
/// wanted load; the name of the file.
///
/// # Errors
/// Those of meshing and calibration, sizes that the machine cannot hold, and a folder that cannot be written.
pub fn write_deck(
    input: &CrosscheckInput<'_>,
    format: Format,
    folder: &OutputFolder,
    resources: &Resources<'_>,
) -> Result<String> {
    let statics = input.statics();
    let geometry = geometry::geometry(statics)?;
    let (options, work) =
        (zones::mesh_options(statics, &geometry), Work { calibrate: true, ..Work::default() });
    let (meshes, _) = estimate::meshes(&input.solids(), &geometry, options, &work, resources)?;
    let curve = answers::faceted(statics, &geometry, &meshes, resources.monitor)?;
    let lowerings: Vec<f64> = curve.points.iter().map(|p| p.displacement).collect();
    let deck = Deck {
        input,
        geometry: &geometry,
        meshes: &meshes,
        friction: statics.contact.friction,
        lowerings: &lowerings,
    };
    let name = match format {
        Format::Calculix => "calculix.inp",
        Format::Abaqus => "abaqus.inp",
    };
    folder.write(name, deck.text(format)?.as_bytes())?;
    Ok(name.into())
}
