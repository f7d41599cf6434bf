//! The tool's own results for the questions to the reference solvers, with the study's element.

use std::time::Instant;

use nalgebra::Vector3;
use railspring_calibrate::calibration::{
    ContactField, Enforcement, HorizontalPoint, LoadPoint, PatchValues, Pressed, Reference, WheelOnRail,
    calibrate_horizontal, load_points, press_loads,
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
    /// Lateral forces on nodes of the mesh, N: in the proportions of the contact forces at the largest load, and one in all.
    pub lateral: Vec<(usize, f64)>,
    /// Their mean lateral displacement, weighted by them, m/N.
    pub lateral_flexibility: f64,
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
    /// Load curve without friction.
    pub frictionless: AnsweredCurve,
    /// Load curve with the study's friction, if it has any.
    pub frictional: Option<AnsweredCurve>,
    /// Horizontal stiffness with that friction under the preloads up to the largest load; nothing without friction.
    pub horizontal: Vec<HorizontalPoint>,
    /// Load curve without friction between the surfaces that other programs see: flat facets between the nodes.
    pub faceted: AnsweredCurve,
    /// Name of the element.
    pub element: &'static str,
}

/// Name of an element, in the exchanged files and in words.
pub fn element_name(element: Formulation) -> &'static str {
    match element {
        Formulation::IncompatibleModes => "incompatible modes",
        Formulation::FullIntegration => "full integration",
    }
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
    let bodies = asked.condense()?;
    let (mut frictionless, smooth_states) = asked.curve(&bodies, 0.0, BetweenNodes::Smooth)?;
    frictionless.seconds += bodies.seconds;
    let friction = statics.contact.friction;
    let (frictional, horizontal, states) = if friction > 0.0 {
        let (curve, states) = asked.curve(&bodies, friction, BetweenNodes::Smooth)?;
        (Some(curve), asked.horizontal(&bodies)?, states)
    } else {
        (None, Vec::new(), smooth_states)
    };
    let largest = states.last().expect("there are loads");
    let rail = (&bodies.rail, bodies.solids.parts(rail_in_use(statics))?);
    let wheel = (&bodies.wheel, bodies.solids.parts(PairBody::Wheel)?);
    Ok(Answers {
        rail: answer(&meshes.rail, rail, largest, Side::Base)?,
        wheel: answer(&meshes.wheel, wheel, largest, Side::Opposing)?,
        loads: asked.loads.clone(),
        friction,
        frictionless,
        frictional,
        horizontal,
        faceted: asked.faceted(&bodies)?,
        element: element_name(statics.element.formulation()),
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
    asked.faceted(&asked.condense()?)
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

    fn condense(&self) -> Result<Condensed<'a>> {
        self.monitor.progress("superelements", 0, 1)?;
        let clock = Instant::now();
        let solids = solids(self.statics, self.geometry, self.meshes);
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
        let mut pair = self.pair(bodies, friction)?;
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

    /// The wheel on the rail, on the elements of the meshes.
    fn pair<'b>(&self, bodies: &'b Condensed<'_>, friction: f64) -> Result<WheelOnRail<'b>>
    where
        'a: 'b,
    {
        let contact =
            ContactConditions { friction, enforcement: Enforcement::Exact, field: ContactField::Elements };
        let own = &self.geometry.pair;
        let rail = own.contact_body(rail_in_use(self.statics), &bodies.rail)?;
        let wheel = own.contact_body(PairBody::Wheel, &bodies.wheel)?;
        Ok(own.wheel_on_rail(rail, wheel, contact))
    }

    /// The horizontal stiffness of hub against support under the study's preloads, up to the largest load: candidates for contact reach as far.
    fn horizontal(&self, bodies: &Condensed<'_>) -> Result<Vec<HorizontalPoint>> {
        let pair = self.pair(bodies, self.statics.contact.friction)?;
        let largest = self.loads.last().map_or(0.0, |load| load * (1.0 + 1e-9));
        let preloads = &self.statics.calibration.horizontal_preloads;
        let carried: Vec<f64> = preloads.iter().copied().filter(|preload| *preload <= largest).collect();
        let found = calibrate_horizontal(&pair, &carried, &[], self.monitor)?;
        found.ended.map_or(Ok(found.points), Err)
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
    let carried: f64 = forces.iter().map(Vector3::norm).sum();
    let shares: Vec<f64> = mesh.contact.nodes.iter().map(|&node| forces[node].norm() / carried).collect();
    let lateral_flexibility = (0..contact_nodes)
        .flat_map(|j| (0..contact_nodes).map(move |i| (i, j)))
        .map(|(i, j)| shares[i] * shares[j] * body.compliance[(3 * i + 1, 3 * j + 1)])
        .sum();
    let loaded = mesh.contact.nodes.iter().copied().zip(shares).filter(|(_, share)| *share > 0.0);
    Ok(AnsweredBody {
        lateral: loaded.collect(),
        lateral_flexibility,
        forces,
        displacement: displacement.chunks_exact(3).map(|u| Vector3::new(u[0], u[1], u[2])).collect(),
        columns,
        compliance,
    })
}
