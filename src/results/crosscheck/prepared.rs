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

/// Sizes of a mesh for elements of second order over those of the study's mesh.
struct Sizes {
    /// At the contact.
    contact: f64,
    /// Of sections and around the wheel.
    bodies: f64,
}

/// For the load curve: finer at the contact, and coarser where elements of second order need fewer, so that one factor of the wheel takes some 15 GB.
const CURVE: Sizes = Sizes { contact: 0.75, bodies: 2.0 };
/// For the horizontal stiffness, which is the bending of web and disc: its contact is as it is in the study, so that only the bodies differ.
const HORIZONTAL: Sizes = Sizes { contact: 1.0, bodies: 1.4 };

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
/// Elements of second order are on other meshes; a mesh from a file stays as it is.
///
/// # Errors
/// Those of meshing and calibration, and sizes that the machine cannot hold.
pub fn prepare(input: &CrosscheckInput<'_>, cases: &[Case], resources: &Resources<'_>) -> Result<Prepared> {
    let statics = input.statics();
    let geometry = geometry::geometry(statics)?;
    let (options, work) = (zones::mesh_options(statics, &geometry), Work::of_crosscheck(purpose(cases)));
    let (meshes, _) = estimate::meshes(&input.solids(), &geometry, options, &work, resources)?;
    let answers = answers::answers(statics, &geometry, &meshes, resources.monitor)?;
    let mut others = Vec::new();
    for (case, sizes) in [(Case::SecondOrder, CURVE), (Case::SecondOrderHorizontal, HORIZONTAL)] {
        // what does not stick has no horizontal stiffness
        let asked = case == Case::SecondOrder || !answers.horizontal.is_empty();
        if asked && cases.contains(&case) {
            let mut other = statics.mesh.clone();
            other.contact_element *= sizes.contact;
            other.contact_element_along *= sizes.contact;
            other.rail_section_element *= sizes.bodies;
            other.wheel_section_element *= sizes.bodies;
            other.wheel_arc_element *= sizes.bodies;
            others.push((case, zones::remeshed(Statics { mesh: &other, ..statics }, &geometry, &meshes)?));
        }
    }
    let exchange = Exchange::new(input, &geometry, &meshes, &others, &answers, cases);
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
