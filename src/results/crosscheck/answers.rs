//! The tool's own results for the questions to the reference solvers.
//!
//! The reference solvers use full integration, so the tool answers with full integration
//! too, next to the study's own element.

use std::time::Instant;

use nalgebra::Vector3;
use railspring_calibrate::calibration::{
    ContactField, Enforcement, LoadPoint, PatchValues, Pressed, Reference, load_points, press_loads,
};
use railspring_calibrate::contact::{BetweenNodes, Side};
use railspring_calibrate::mesh::HexMesh;
use railspring_calibrate::pair::{ContactConditions, PairBody, PairSolids};
use railspring_calibrate::solid::Formulation;
use railspring_calibrate::superelement::{CondensedBody, Parts};
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::monitor::Monitor;
use railspring_profiles::units::KILONEWTON;

use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::meshes::Meshes;
use crate::results::bodies::solids::{rail_in_use, solids};
use crate::study::{ReferenceKey, Statics};

/// Loads of the cross-validation, kN; those above the study's largest load are left out.
const LOADS_KN: [f64; 8] = [5.0, 10.0, 20.0, 40.0, 60.0, 85.0, 120.0, 150.0];
/// Number of compliance columns per body that the reference solvers repeat.
const COLUMNS: usize = 6;

/// One body with a question and the tool's answer.
#[derive(Debug, Clone)]
pub struct AnsweredBody {
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
    /// Their patches.
    pub patches: Vec<PatchValues>,
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
pub fn rail_held<'a>(statics: Statics<'_>, rail: &'a HexMesh) -> &'a [usize] {
    match statics.calibration.reference {
        ReferenceKey::Beam | ReferenceKey::Local => &rail.ends,
        ReferenceKey::Foot => &rail.foot,
    }
}

/// Loads of the cross-validation, N.
fn asked_loads(statics: Statics<'_>) -> Vec<f64> {
    let largest = statics.calibration.loads.iter().copied().fold(0.0, f64::max);
    LOADS_KN.iter().map(|l| l * KILONEWTON).filter(|l| *l <= largest * (1.0 + 1e-9)).collect()
}

/// Answers all questions.
///
/// # Errors
/// Those of the calibration, and loads that are all below the smallest load of the reference solvers.
pub fn answers(
    statics: Statics<'_>,
    geometry: &Geometry,
    meshes: &Meshes,
    monitor: &dyn Monitor,
) -> Result<Answers> {
    let asked = Asked::new(statics, geometry, meshes, monitor)?;
    let full = asked.condense(Formulation::FullIntegration)?;
    let (mut frictionless, smooth_states) = asked.curve(&full, 0.0, BetweenNodes::Smooth)?;
    frictionless.seconds += full.seconds;
    let (frictional, states) = if statics.contact.friction > 0.0 {
        let (curve, states) = asked.curve(&full, statics.contact.friction, BetweenNodes::Smooth)?;
        (Some(curve), states)
    } else {
        (None, smooth_states)
    };
    let largest = states.last().expect("there are loads");
    let rail =
        answer(&meshes.rail, (&full.rail, full.solids.parts(rail_in_use(statics))?), largest, Side::Base)?;
    let wheel =
        answer(&meshes.wheel, (&full.wheel, full.solids.parts(PairBody::Wheel)?), largest, Side::Opposing)?;
    let element = statics.element.formulation();
    let (own_element, faceted) = if element == Formulation::FullIntegration {
        (frictionless.clone(), asked.faceted(&full)?)
    } else {
        let own = asked.condense(element)?;
        let (mut smooth, _) = asked.curve(&own, 0.0, BetweenNodes::Smooth)?;
        smooth.seconds += own.seconds;
        (smooth, asked.faceted(&own)?)
    };
    Ok(Answers {
        rail,
        wheel,
        loads: asked.loads.clone(),
        friction: statics.contact.friction,
        frictionless,
        frictional,
        own_element,
        faceted,
        own_element_name: match element {
            Formulation::IncompatibleModes => "incompatible modes",
            Formulation::FullIntegration => "full integration",
        },
    })
}

/// The load curve between flat facets alone, [`Answers::faceted`].
///
/// # Errors
/// As [`answers`].
pub fn faceted(
    statics: Statics<'_>,
    geometry: &Geometry,
    meshes: &Meshes,
    monitor: &dyn Monitor,
) -> Result<AnsweredCurve> {
    let asked = Asked::new(statics, geometry, meshes, monitor)?;
    asked.faceted(&asked.condense(statics.element.formulation())?)
}

/// What the tool needs to answer.
struct Asked<'a> {
    statics: Statics<'a>,
    geometry: &'a Geometry,
    meshes: &'a Meshes,
    monitor: &'a dyn Monitor,
    loads: Vec<f64>,
}

/// Both bodies condensed, and the time that took, s.
struct Condensed<'a> {
    solids: PairSolids<'a>,
    wheel: CondensedBody,
    rail: CondensedBody,
    seconds: f64,
}

impl<'a> Asked<'a> {
    fn new(
        statics: Statics<'a>,
        geometry: &'a Geometry,
        meshes: &'a Meshes,
        monitor: &'a dyn Monitor,
    ) -> Result<Self> {
        let loads = asked_loads(statics);
        if loads.is_empty() {
            let largest = statics.calibration.loads.iter().copied().fold(0.0, f64::max);
            return Err(InputError::new(
                "calibration.load_max_kn",
                largest / KILONEWTON,
                format!("a load of at least {} kN, the smallest of the cross-validation", LOADS_KN[0]),
                "raise it, or the last of loads_kn",
            )
            .into());
        }
        Ok(Self { statics, geometry, meshes, monitor, loads })
    }

    fn condense(&self, element: Formulation) -> Result<Condensed<'a>> {
        let stage = match element {
            Formulation::FullIntegration => "superelements, full integration",
            Formulation::IncompatibleModes => "superelements, incompatible modes",
        };
        self.monitor.progress(stage, 0, 1)?;
        let clock = Instant::now();
        let solids = PairSolids { element, ..solids(self.statics, self.geometry, self.meshes) };
        // one after the other, so that there is one factor at a time
        let condense = |body| solids.condense(body, solids.key(body));
        let (wheel, rail) = (condense(PairBody::Wheel)?, condense(rail_in_use(self.statics))?);
        Ok(Condensed { solids, wheel, rail, seconds: clock.elapsed().as_secs_f64() })
    }

    /// All loads; the curve has their time without the factorisation.
    fn curve(
        &self,
        bodies: &Condensed<'_>,
        friction: f64,
        between_nodes: BetweenNodes,
    ) -> Result<(AnsweredCurve, Vec<Pressed>)> {
        let clock = Instant::now();
        let contact =
            ContactConditions { friction, enforcement: Enforcement::Exact, field: ContactField::Elements };
        let own = &self.geometry.pair;
        let rail = own.contact_body(rail_in_use(self.statics), &bodies.rail)?;
        let wheel = own.contact_body(PairBody::Wheel, &bodies.wheel)?;
        let mut pair = own.wheel_on_rail(rail, wheel, contact);
        for surface in [&mut pair.rail_surface, &mut pair.wheel_surface] {
            surface.between_nodes = between_nodes;
        }
        // hub against support: what the calibration calls the foot's reference, whatever is held
        let states = press_loads(&pair, &self.loads, "calibration, foot held", self.monitor)?;
        let points = load_points(&pair, &states, Reference::Foot)?;
        let seconds = clock.elapsed().as_secs_f64();
        let patches = pair.patches(&states)?.iter().map(|patch| patch.values).collect();
        Ok((AnsweredCurve { points, patches, seconds }, states))
    }

    /// The frictionless curve between facets, with the time of the factorisation.
    fn faceted(&self, bodies: &Condensed<'_>) -> Result<AnsweredCurve> {
        let (mut curve, _) = self.curve(bodies, 0.0, BetweenNodes::Facets)?;
        curve.seconds += bodies.seconds;
        Ok(curve)
    }
}

/// Displacements under the contact forces of a state, and compliance columns under its most loaded nodes.
fn answer(
    mesh: &HexMesh,
    (body, parts): (&CondensedBody, Parts<'_>),
    state: &Pressed,
    side: Side,
) -> Result<AnsweredBody> {
    let contact_nodes = mesh.contact.nodes.len();
    let retained = state.body_forces(side, body.compliance.nrows());
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
        .map(|&(n, axis)| body.compliance.col_as_slice(3 * n + axis)[..3 * contact_nodes].to_vec())
        .collect();
    let displacement = parts.displacements(body, &[retained])?.remove(0);
    Ok(AnsweredBody {
        forces,
        displacement: displacement.chunks_exact(3).map(|u| Vector3::new(u[0], u[1], u[2])).collect(),
        columns,
        compliance,
    })
}
