//! The questions to the reference solvers, in words, and the meshes that they get.

use railspring_calibrate::mesh::HexMesh;
use railspring_profiles::units::{KILONEWTON, KILONEWTON_PER_METRE, MILLIMETRE};

use crate::results::crosscheck::answers::{AnsweredCurve, Answers};
use crate::results::crosscheck::exchange::{BODIES, Case, Exchange};
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
        "Rail and wheel each alone, on the tool's mesh with fully integrated first-order bricks: the displacement of \
         every node under given nodal forces (those of the contact at the largest load), the displacement of the \
         contact nodes under single unit forces, the sign of the smallest Jacobian determinant."
            .into(),
    )];
    let curve = "hub displacement, tangent stiffness and contact area under each load";
    for case in cases {
        let text = match case {
            Case::SameMesh => format!(
                "Wheel on rail without friction, same mesh and element, own contact formulation: {curve}."
            ),
            Case::SameMeshFriction if answers.frictional.is_none() => continue,
            Case::SameMeshFriction => {
                format!("The same with Coulomb friction {}: {curve}.", answers.friction)
            }
            Case::OtherSurface => format!(
                "The same without friction, the contact forces carried by the wheel's nodes instead of the rail's: \
                 {curve}."
            ),
            Case::SecondOrder => format!(
                "Wheel on rail without friction, elements of second order on a finer mesh, against the tool's {} on \
                 the study's mesh: hub displacement and tangent stiffness under each load.",
                answers.own_element_name
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
                 at given displacements, from which the displacement under each load.",
                answers.own_element_name
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
        let fine = BODIES.iter().zip(bodies);
        sizes.extend(fine.map(|(name, body)| size(name, &body.mesh, "for elements of second order")));
    }
    sizes
}

/// The tool's load curves as the record keeps them.
pub fn tool_curves(answers: &Answers) -> Vec<ToolCurve> {
    let kept = |element: &str, friction: f64, curve: &AnsweredCurve| ToolCurve {
        element: element.into(),
        friction,
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
    let mut curves = vec![kept("full integration", 0.0, &answers.frictionless)];
    curves.extend(answers.frictional.iter().map(|c| kept("full integration", answers.friction, c)));
    if answers.own_element_name != curves[0].element {
        curves.push(kept(answers.own_element_name, 0.0, &answers.own_element));
    }
    curves.push(kept(&format!("{}, flat facets", answers.own_element_name), 0.0, &answers.faceted));
    curves
}
