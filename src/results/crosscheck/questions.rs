//! The questions to the reference solvers, in words, and the meshes that they get.

use railspring_calibrate::mesh::HexMesh;
use railspring_profiles::units::{KILONEWTON, KILONEWTON_PER_METRE, MILLIMETRE};

use crate::results::crosscheck::answers::{AnsweredCurve, Answers};
use crate::results::crosscheck::exchange::{BODIES, Body, Case, Exchange};
use crate::results::crosscheck::record::{ExchangedMesh, Question, ToolCurve, ToolPoint};

/// The questions to the reference, and to CalculiX if it runs; `reference` and `calculix` are their names.
pub fn questions(
    cases: &[Case],
    answers: &Answers,
    reference: &str,
    calculix: Option<&str>,
) -> Vec<Question> {
    let question = |name: &str, reference_solver: &str, text: String| Question {
        name: name.into(),
        reference_solver: reference_solver.into(),
        text,
    };
    let mut asked = vec![question(
        "elastic",
        reference,
        format!(
            "Rail and wheel each alone, on the tool's mesh with its element ({}): the displacement of every node under \
             given nodal forces (those of the contact at the largest load), the displacement of the contact nodes \
             under single unit forces along and across the track and down, the sign of the smallest Jacobian \
             determinant.",
            answers.element
        ),
    )];
    let curve = "hub displacement, tangent stiffness and contact area under each load";
    for case in cases {
        let text = match case {
            Case::SameMesh => format!(
                "Wheel on rail without friction, same mesh and element, own contact formulation: {curve}."
            ),
            Case::SameMeshFriction if answers.frictional.is_none() => continue,
            Case::SameMeshFriction => {
                format!(
                    "The same with Coulomb friction {}: {curve}, and the horizontal stiffness under each preload.",
                    answers.friction
                )
            }
            Case::OtherSurface => format!(
                "The same without friction, the contact forces carried by the wheel's nodes instead of the rail's: \
                 {curve}."
            ),
            Case::SecondOrder => format!(
                "Wheel on rail without friction, elements of second order on a mesh that is finer at the contact and \
                 coarser elsewhere, against the tool's {} on the study's mesh: hub displacement and tangent stiffness under each load{}.",
                answers.element,
                match answers.horizontal.is_empty() {
                    true => String::new(),
                    false => format!(", and with friction {} the horizontal stiffness", answers.friction),
                }
            ),
        };
        asked.push(question(case.name(), reference, text));
    }
    asked.extend(calculix.map(|name| {
        question(
            "calculix",
            name,
            format!(
                "Wheel on rail without friction, the study's mesh and its element ({}), the program's own contact \
                 between the flat facets of the meshes, to which the tool's answer refers too: the reaction of the hub \
                 at given displacements, from which the displacement under each load. Each body alone: its mean lateral \
                 displacement under lateral forces in the proportions of the contact's.",
                answers.element
            ),
        )
    }));
    asked
}

fn size(body: &str, mesh: &HexMesh, purpose: &str) -> ExchangedMesh {
    ExchangedMesh {
        body: body.into(),
        purpose: purpose.into(),
        nodes: mesh.nodes.len(),
        elements: mesh.hexes.len(),
        degrees_of_freedom: 3 * mesh.nodes.len(),
    }
}

/// Sizes of the exported meshes that are the tool's own.
pub fn same_mesh(exchange: &Exchange) -> Vec<ExchangedMesh> {
    BODIES.iter().zip(&exchange.bodies).map(|(name, body)| size(name, &body.mesh, "same mesh")).collect()
}

/// Sizes of the exported meshes.
pub fn meshes(exchange: &Exchange) -> Vec<ExchangedMesh> {
    let mut sizes = same_mesh(exchange);
    if let Some(bodies) = &exchange.second_order {
        let of = |(name, body): (&&str, &Body)| size(name, &body.mesh, "for elements of second order");
        sizes.extend(BODIES.iter().zip(bodies).map(of));
    }
    sizes
}

/// The tool's load curves as the record keeps them.
pub fn tool_curves(answers: &Answers) -> Vec<ToolCurve> {
    let kept = |element: &str, friction: f64, curve: &AnsweredCurve| ToolCurve {
        element: element.into(),
        friction,
        horizontal: Vec::new(),
        points: curve
            .points
            .iter()
            .map(|p| ToolPoint {
                load_kn: p.force / KILONEWTON,
                hub_displacement_mm: p.displacement / MILLIMETRE,
                tangent_kn_per_m: p.solid_tangent / KILONEWTON_PER_METRE,
            })
            .collect(),
    };
    let mut curves = vec![kept(answers.element, 0.0, &answers.frictionless)];
    curves.extend(answers.frictional.iter().map(|curve| {
        ToolCurve {
            horizontal: answers
                .horizontal
                .iter()
                .map(|p| (p.preload / KILONEWTON, p.stiffness / KILONEWTON_PER_METRE))
                .collect(),
            ..kept(answers.element, answers.friction, curve)
        }
    }));
    curves.push(kept(&format!("{}, flat facets", answers.element), 0.0, &answers.faceted));
    curves
}
