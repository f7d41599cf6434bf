//! The tool's own answers to the questions that independent judges are asked.
//!
//! Judges know full integration, so the tool answers with full integration
//! too, next to the study's own element.

use std::time::Instant;

use nalgebra::Vector3;
use railspring_calibrate::calibration::{
    Enforcement, LoadPoint, Pressed, Reference, WheelOnRail, load_points, press_loads,
};
use railspring_calibrate::contact::{BetweenNodes, Side, Surface};
use railspring_calibrate::error::{InputError, Result};
use railspring_calibrate::mesh::HexMesh;
use railspring_calibrate::monitor::Monitor;
use railspring_calibrate::solid::{Formulation, Material, Supports, System};
use railspring_calibrate::superelement::Superelement;
use railspring_calibrate::units::KILONEWTON;

use super::{Geometry, Meshes, formulation};
use crate::study::{ReferenceKey, Study};

/// Loads at which judges are asked, kN; those above the study's largest load are left out.
const LOADS_KN: [f64; 8] = [5.0, 10.0, 20.0, 40.0, 60.0, 85.0, 120.0, 150.0];
/// Number of compliance columns a body that judges repeat.
const COLUMNS: usize = 6;

/// One body with a question and the tool's answer.
#[derive(Debug, Clone)]
pub struct AnsweredBody {
    /// Nodes that cannot move; of the wheel its bore.
    pub held: Vec<usize>,
    /// Given nodal forces, N.
    pub forces: Vec<Vector3<f64>>,
    /// Nodal displacements under them, m.
    pub displacement: Vec<Vector3<f64>>,
    /// Contact nodes (index in the contact grid) and directions of the unit forces.
    pub columns: Vec<(usize, usize)>,
    /// Displacement of all contact nodes (`3·node + direction`) under each unit force, m/N.
    pub compliance: Vec<Vec<f64>>,
}

/// The tool's load curves, frictionless and with friction, of hub against support.
#[derive(Debug, Clone)]
pub struct AnsweredCurve {
    /// The loads.
    pub points: Vec<LoadPoint>,
    /// Time of factorisation and all loads, s.
    pub seconds: f64,
}

/// Questions and the tool's answers.
#[derive(Debug, Clone)]
pub struct Answers {
    /// The rail.
    pub rail: AnsweredBody,
    /// The wheel.
    pub wheel: AnsweredBody,
    /// Material of both.
    pub material: Material,
    /// Loads, N.
    pub loads: Vec<f64>,
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Load curve with full integration and no friction.
    pub frictionless: AnsweredCurve,
    /// Load curve with full integration and the study's friction, if it has any.
    pub frictional: Option<AnsweredCurve>,
    /// Load curve of the study's own element, no friction.
    pub own_element: AnsweredCurve,
    /// The same with the surfaces that other programs see: flat facets between the nodes.
    pub faceted: AnsweredCurve,
    /// Name of the study's own element.
    pub own_element_name: &'static str,
}

/// Nodes of the rail that the study's reference holds.
pub fn rail_held<'a>(study: &Study, rail: &'a HexMesh) -> &'a [usize] {
    match study.calibration.reference {
        ReferenceKey::Beam => &rail.ends,
        ReferenceKey::Foot | ReferenceKey::Local => &rail.foot,
    }
}

/// Loads at which judges are asked, N.
pub fn judged_loads(study: &Study) -> Vec<f64> {
    let largest = study.calibration.loads.iter().copied().fold(0.0, f64::max);
    LOADS_KN.iter().map(|l| l * KILONEWTON).filter(|l| *l <= largest * (1.0 + 1e-9)).collect()
}

/// Answers all questions.
///
/// # Errors
/// Those of the calibration.
pub fn answers(
    study: &Study,
    geometry: &Geometry,
    meshes: &Meshes,
    monitor: &dyn Monitor,
) -> Result<Answers> {
    let held = rail_held(study, &meshes.rail).to_vec();
    let loads = judged_loads(study);
    if loads.is_empty() {
        let largest = study.calibration.loads.iter().copied().fold(0.0, f64::max);
        return Err(InputError::new(
            "calibration.load_max_kn",
            largest / KILONEWTON,
            format!("a load of at least {} kN, the smallest at which judges are asked", LOADS_KN[0]),
            "raise it, or the last of loads_kn",
        )
        .into());
    }
    let rail_supports = Supports { held: held.clone(), ..Supports::default() };
    let wheel_supports = Supports { followers: meshes.wheel.bore.clone(), ..Supports::default() };
    let condense = |element: Formulation| -> Result<(Superelement<'_>, Superelement<'_>)> {
        let one = |mesh, supports| Superelement::new(System::new(mesh, study.material, element, supports)?);
        let (wheel, rail) =
            rayon::join(|| one(&meshes.wheel, &wheel_supports), || one(&meshes.rail, &rail_supports));
        Ok((wheel?, rail?))
    };
    let curve =
        |(wheel, rail): (&Superelement, &Superelement), friction: f64, between_nodes: BetweenNodes| {
            let clock = Instant::now();
            let pair = WheelOnRail {
                rail,
                wheel,
                rail_surface: Surface { between_nodes, ..geometry.rail_surface(&meshes.rail) },
                wheel_surface: Surface { between_nodes, ..geometry.wheel_surface(&meshes.wheel) },
                friction,
                enforcement: Enforcement::Exact,
            };
            // hub against support: what the calibration calls the foot's reference, whatever is held
            let states = press_loads(&pair, &loads, "calibration, foot held", monitor)?;
            let points = load_points(&pair, &states, Reference::Foot, None, &study.material)?;
            let seconds = clock.elapsed().as_secs_f64();
            Result::Ok((AnsweredCurve { points, seconds }, states))
        };
    monitor.progress("superelements, full integration", 0, 1)?;
    let clock = Instant::now();
    let (wheel, rail) = condense(Formulation::FullIntegration)?;
    let factorisation = clock.elapsed().as_secs_f64();
    let (mut frictionless, smooth_states) = curve((&wheel, &rail), 0.0, BetweenNodes::Smooth)?;
    frictionless.seconds += factorisation;
    let (frictional, states) = if study.contact.friction > 0.0 {
        let (curve, states) = curve((&wheel, &rail), study.contact.friction, BetweenNodes::Smooth)?;
        (Some(curve), states)
    } else {
        (None, smooth_states)
    };
    let largest = states.last().expect("there are loads");
    let rail_answer = answer(&meshes.rail, &rail, largest, Side::Base, held);
    let wheel_answer = answer(&meshes.wheel, &wheel, largest, Side::Opposing, meshes.wheel.bore.clone());
    let own = formulation(study);
    let (own_element, faceted) = if own == Formulation::FullIntegration {
        let (mut faceted, _) = curve((&wheel, &rail), 0.0, BetweenNodes::Facets)?;
        faceted.seconds += factorisation;
        (frictionless.clone(), faceted)
    } else {
        monitor.progress("superelements, the study's element", 0, 1)?;
        let clock = Instant::now();
        let (wheel, rail) = condense(own)?;
        let factorisation = clock.elapsed().as_secs_f64();
        let own = |between_nodes| -> Result<AnsweredCurve> {
            let (mut own, _) = curve((&wheel, &rail), 0.0, between_nodes)?;
            own.seconds += factorisation;
            Ok(own)
        };
        (own(BetweenNodes::Smooth)?, own(BetweenNodes::Facets)?)
    };
    Ok(Answers {
        rail: rail_answer,
        wheel: wheel_answer,
        material: study.material,
        loads,
        friction: study.contact.friction,
        frictionless,
        frictional,
        own_element,
        faceted,
        own_element_name: match own {
            Formulation::IncompatibleModes => "incompatible modes",
            Formulation::FullIntegration => "full integration",
        },
    })
}

/// Displacements under the contact forces of a state, and compliance columns under its most loaded nodes.
fn answer(
    mesh: &HexMesh,
    element: &Superelement,
    state: &Pressed,
    side: Side,
    held: Vec<usize>,
) -> AnsweredBody {
    let contact_nodes = mesh.contact.nodes.len();
    let retained = state.body_forces(side, element);
    let mut forces = vec![Vector3::zeros(); mesh.nodes.len()];
    for (n, &node) in mesh.contact.nodes.iter().enumerate() {
        forces[node] = Vector3::new(retained[3 * n], retained[3 * n + 1], retained[3 * n + 2]);
    }
    let mut by_force: Vec<usize> = (0..contact_nodes).collect();
    by_force.sort_by(|&a, &b| {
        let size = |n: usize| forces[mesh.contact.nodes[n]].norm();
        size(b).total_cmp(&size(a)).then(a.cmp(&b))
    });
    // from the most loaded node to the corners of the grid, all directions in turn
    let columns: Vec<(usize, usize)> = (0..COLUMNS)
        .map(|k| (if k < 3 { by_force[0] } else { by_force[(contact_nodes - 1) * (k - 2) / 3] }, k % 3))
        .collect();
    let compliance = columns
        .iter()
        .map(|&(n, axis)| element.compliance.col_as_slice(3 * n + axis)[..3 * contact_nodes].to_vec())
        .collect();
    let displacement = element.displacement(&retained);
    AnsweredBody {
        held,
        forces,
        displacement: displacement.chunks_exact(3).map(|u| Vector3::new(u[0], u[1], u[2])).collect(),
        columns,
        compliance,
    }
}
