//! The transient solid model: Newmark average acceleration on both condensed
//! bodies, contact solved at every step.
//!
//! The effective matrix `K + 4/Δt²·M` of each body is constant and factored
//! once. A step eliminates the interior, solves the contact on the retained
//! equations, and substitutes back: one solution per body and step, at full order.
//!
//! The contact nodes have no mass ([`System::with_massless_contact`]): a node with mass collides with every step, its
//! force alternates between zero and a multiple of the true one, and the work of these forces adds energy.

mod body;
mod contact;
#[cfg(test)]
mod tests;

use crate::calibration::{ContactField, Enforcement};
use crate::contact::{ContactPoint, PointMode, Side, Solution, Surface, resultant};
use crate::error::{InputError, Result, StopReason};
use crate::field::InputField;
use crate::history::{ContactMode, ContactState, Ending, History, HistoryRow};
use crate::linear_part::{LinearPart, LinearStep};
use crate::mesh::HexMesh;
use crate::monitor::Monitor;
use crate::newmark::{Motion, Newmark};
use crate::pair::Pair;
use crate::placement::{PlacedRail, departure, lateral_extent};
use crate::scenario::Scenario;
use crate::solid::{Formulation, Material, Supports, System};
use crate::suspension::{Suspension, SuspensionStep};
use body::{Body, BodyLoad, BodyState, BodyStep};
use contact::{LastContact, StepContact, failure};
use nalgebra::{Point2, Point3, Vector2};

/// Everything the transient solid model is made of.
pub struct TransientModel<'a> {
    /// Rail mesh in the world frame; its ends are held.
    pub rail_mesh: &'a HexMesh,
    /// Wheel mesh in the body frame; its bore follows the master node at the wheel's centre.
    pub wheel_mesh: &'a HexMesh,
    /// Material of both.
    pub material: Material,
    /// Element of both.
    pub formulation: Formulation,
    /// The placed rail, for positions in its profile frame.
    pub placed_rail: &'a PlacedRail,
    /// Contact surface of the rail.
    pub rail_surface: Surface<'a>,
    /// Contact surface of the wheel, just touching.
    pub wheel_surface: Surface<'a>,
    /// How the contact conditions are enforced.
    pub enforcement: Enforcement,
    /// Where the contact lives.
    pub field: ContactField,
}

impl<'a> TransientModel<'a> {
    /// The solid model of a pair, its rail held at the ends.
    pub fn of_pair(
        pair: &'a Pair,
        [rail, wheel]: [&'a HexMesh; 2],
        material: Material,
        formulation: Formulation,
        (enforcement, field): (Enforcement, ContactField),
    ) -> Self {
        Self {
            rail_mesh: rail,
            wheel_mesh: wheel,
            material,
            formulation,
            placed_rail: &pair.placed,
            rail_surface: pair.rail_surface(&rail.contact),
            wheel_surface: pair.wheel_surface(&wheel.contact),
            enforcement,
            field,
        }
    }
}

/// A finished transient run of the solid model.
pub struct TransientRun {
    /// The states.
    pub history: History,
    /// Mass of the meshed wheel, kg.
    pub wheel_mass: f64,
    /// Values stored in the factors of both bodies.
    pub factor_values: usize,
    /// Largest number of load-carrying contact points in a step.
    pub most_active: usize,
}

impl TransientModel<'_> {
    /// Runs `scenario` from just touching and at rest.
    ///
    /// # Errors
    /// [`InputError`] for a scenario only the moving solver can run, and for penalty springs on a fine grid;
    /// [`crate::error::NumericsError`] with the step if
    /// the contact does not settle or leaves the meshed contact zone.
    pub fn run(&self, scenario: &Scenario, monitor: &dyn Monitor) -> Result<TransientRun> {
        refuse_moving(scenario)?;
        scenario.check()?;
        self.field.check(self.enforcement)?;
        self.run_from(&InitialVelocity::default(), scenario, monitor, &mut |step| {
            step.contact.refuse_edge(self.rail_surface.grid)
        })
    }

    /// Runs `scenario` from just touching with the given velocities; `observe` sees every finished step and can
    /// end the run.
    fn run_from(
        &self,
        initial: &InitialVelocity,
        scenario: &Scenario,
        monitor: &dyn Monitor,
        observe: &mut dyn FnMut(&Step) -> Result<()>,
    ) -> Result<TransientRun> {
        let dt = scenario.time_step;
        let scheme = Newmark::new(dt, 0.0);
        let suspension = Suspension::new(scenario, &scheme);
        let (rail, wheel) = rayon::join(
            || Body::new(self.rail_system()?, &scheme, None),
            || Body::new(self.wheel_system(scenario)?, &scheme, Some(suspension.stiffness())),
        );
        let (rail, wheel) = (rail?, wheel?);
        let wheel_mass = wheel.mass.total();
        let mut hub_motion = HubMotion::at_start(scenario, &initial.wheel, wheel_mass);
        let mut rail_state = rail.in_motion(&initial.rail, &Vector2::zeros());
        let mut wheel_state = wheel.in_motion(&hub_motion.velocity(), &hub_motion.acceleration());
        let step_contact = StepContact::new(self, scenario, &scheme);
        let mut contact = LastContact::default();
        let mut rows = vec![HistoryRow {
            time: 0.0,
            vertical_force: 0.0,
            lateral_force: 0.0,
            wheel_y: 0.0,
            wheel_z: 0.0,
            load_y: scenario.load_travel(0.0, 0.0),
            contacts: Vec::new(),
        }];
        let mut most_active = 0;
        let mut ending = Ending::Completed;
        let rail_extent = lateral_extent(self.placed_rail.curve.knot_points());
        let wheel_extent = self.wheel_extent();
        for step in 1..=scenario.steps {
            monitor.progress("transient solid model", step - 1, scenario.steps)?;
            let t = step as f64 * dt;
            let (hub, suspended) = hub_motion.forces(scenario, t, &suspension);
            let wheel_load = BodyLoad { hub, gravity: scenario.gravity };
            let (rail_step, wheel_step) = rayon::join(
                || rail.predict(&rail_state, &BodyLoad::default()),
                || wheel.predict(&wheel_state, &wheel_load),
            );
            let solved = step_contact
                .solve([&rail_step, &wheel_step], &hub_motion.predicted(dt), &contact)
                .map_err(|e| e.at_step(step))?;
            let (points, solution) = (&solved.points, &solved.solution);
            most_active = most_active.max(solution.active());
            let on = |side, step: &BodyStep| solved.nodal_forces(side, step.free().len());
            let forces = [on(Side::Base, &rail_step), on(Side::Opposing, &wheel_step)];
            (rail_state, wheel_state) =
                rayon::join(|| rail_step.finish(&forces[0]), || wheel_step.finish(&forces[1]));
            let hub = wheel.hub(&wheel_state);
            if !(hub.x.is_finite() && hub.y.is_finite()) {
                return Err(failure(f64::NAN, solution.active(), StopReason::NotFinite).at_step(step));
            }
            if let Some(departure) = departure(rail_extent, wheel_extent.map(|y| y + hub.x)) {
                ending = Ending::Departed { time: t, departure };
                break;
            }
            hub_motion.advance(&scheme, &hub, &suspension, &suspended);
            let force = resultant(points, &solution.forces);
            rows.push(HistoryRow {
                time: t,
                vertical_force: -force.z,
                lateral_force: -force.y,
                wheel_y: hub.x,
                wheel_z: hub.y,
                load_y: scenario.load_travel(t, hub.x),
                contacts: self.contacts(points, solution),
            });
            let finished = Step {
                bodies: [&rail, &wheel],
                states: [&rail_state, &wheel_state],
                contact: &solved,
                forces: &forces,
                hub: &hub_motion,
            };
            observe(&finished).map_err(|e| e.at_step(step))?;
            contact = solved;
        }
        monitor.progress("transient solid model", scenario.steps, scenario.steps)?;
        Ok(TransientRun {
            history: History { rows, degrees_of_freedom: rail.equations() + wheel.equations() + 1, ending },
            wheel_mass,
            factor_values: rail.factor_values() + wheel.factor_values(),
            most_active,
        })
    }

    /// Lateral positions of the ends of the wheel's running surface at t = 0, m.
    fn wheel_extent(&self) -> [f64; 2] {
        let surface = &self.wheel_surface;
        lateral_extent(surface.curve.knot_points()).map(|y| y + surface.origin.x)
    }

    fn rail_system(&self) -> Result<System<'_>> {
        let supports = Supports { held: self.rail_mesh.ends.clone(), ..Default::default() };
        Ok(System::new(self.rail_mesh, self.material, self.formulation, &supports)?.with_massless_contact())
    }

    fn wheel_system(&self, scenario: &Scenario) -> Result<System<'_>> {
        let turning = !scenario.rotations_held;
        let supports = Supports {
            held: Vec::new(),
            followers: self.wheel_mesh.bore.clone(),
            master: Point3::origin(),
            master_free: [false, true, true, turning, turning, turning],
        };
        Ok(System::new(self.wheel_mesh, self.material, self.formulation, &supports)?.with_massless_contact())
    }

    /// The patches that carry load: runs of load-carrying grid lines with at least two free lines between them.
    fn contacts(&self, points: &[ContactPoint], solution: &Solution) -> Vec<ContactState> {
        let n = points.len();
        let active: Vec<usize> = (0..n).filter(|&j| solution.forces[j] > 0.0).collect();
        let mut patches: Vec<Vec<usize>> = Vec::new();
        for &j in &active {
            match patches.last_mut() {
                Some(patch) if points[j].index.0 <= points[patch[patch.len() - 1]].index.0 + 2 => {
                    patch.push(j)
                }
                _ => patches.push(vec![j]),
            }
        }
        patches
            .iter()
            .map(|patch| {
                let force: f64 = patch.iter().map(|&j| solution.forces[j]).sum();
                let mean = |value: &dyn Fn(usize) -> f64| {
                    patch.iter().map(|&j| solution.forces[j] * value(j)).sum::<f64>() / force
                };
                let s = mean(&|j| points[j].position.x);
                let slipping = mean(&|j| f64::from(solution.modes[j] == PointMode::Slip));
                ContactState {
                    mode: if slipping > 0.5 { ContactMode::Slip } else { ContactMode::Stick },
                    rail: self.placed_rail.to_profile(&self.rail_surface.world(s)),
                    wheel: Point2::new(
                        mean(&|j| points[j].opposing_position.x),
                        mean(&|j| points[j].opposing_position.y),
                    ),
                    normal_force: force,
                    tangential_force: patch
                        .iter()
                        .map(|&j| solution.forces.get(n + j).copied().unwrap_or(0.0))
                        .sum(),
                }
            })
            .collect()
    }
}

/// Velocities (y, z) of the whole bodies at t = 0, m/s; the suspended mass has that of the wheel.
#[derive(Debug, Clone, Copy, Default)]
struct InitialVelocity {
    rail: Vector2<f64>,
    wheel: Vector2<f64>,
}

/// What an observer sees of a finished step.
#[cfg_attr(not(test), expect(dead_code, reason = "the energy balance of the tests is made from it"))]
struct Step<'s, 'a> {
    /// Rail and wheel.
    bodies: [&'s Body<'a>; 2],
    states: [&'s BodyState; 2],
    contact: &'s LastContact,
    /// Contact forces on the retained equations of each body, N.
    forces: &'s [Vec<f64>; 2],
    hub: &'s HubMotion,
}

/// Motion of the hub and of the suspended mass, positive down and to the field side.
struct HubMotion {
    /// Of the hub along y and z.
    hub: [Motion; 2],
    /// Of the suspended mass along z.
    suspended: Motion,
}

impl HubMotion {
    /// With the accelerations of the rigid bodies under the forces of t = 0.
    fn at_start(scenario: &Scenario, velocity: &Vector2<f64>, wheel_mass: f64) -> Self {
        let mut hub = [velocity.x, velocity.y].map(|v| Motion { v, ..Motion::default() });
        let mut suspended = hub[1];
        let (force, acceleration) = Suspension::start(scenario, &hub[1], &suspended, load(scenario, 0.0));
        hub[0].a = scenario.lateral_force.at(0.0) / wheel_mass;
        hub[1].a = scenario.gravity + force / wheel_mass;
        suspended.a = acceleration;
        Self { hub, suspended }
    }

    fn position(&self) -> Vector2<f64> {
        Vector2::new(self.hub[0].u, self.hub[1].u)
    }

    fn velocity(&self) -> Vector2<f64> {
        Vector2::new(self.hub[0].v, self.hub[1].v)
    }

    fn acceleration(&self) -> Vector2<f64> {
        Vector2::new(self.hub[0].a, self.hub[1].a)
    }

    /// Position at the end of a step of constant acceleration.
    fn predicted(&self, dt: f64) -> Vector2<f64> {
        self.position() + self.velocity() * dt + self.acceleration() * (0.5 * dt * dt)
    }

    /// Forces (y, z) on the hub at time `t` with the suspended mass condensed, and the step of the suspension.
    fn forces(&self, scenario: &Scenario, t: f64, suspension: &Suspension) -> ([f64; 2], SuspensionStep) {
        let step = suspension.step(&self.hub[1], &self.suspended, load(scenario, t));
        ([scenario.lateral_force.at(t), step.transmitted + step.damper], step)
    }

    fn advance(
        &mut self,
        scheme: &Newmark,
        hub: &Vector2<f64>,
        suspension: &Suspension,
        step: &SuspensionStep,
    ) {
        self.hub = [0, 1].map(|i| scheme.advance(&self.hub[i], hub[i]));
        self.suspended = suspension.finish(step, &self.suspended, hub.y);
    }
}

/// Vertical load on the suspended mass at time `t`, its weight included, N.
fn load(scenario: &Scenario, t: f64) -> f64 {
    scenario.vertical_force.at(t) + scenario.suspended_mass * scenario.gravity
}

fn refuse_moving(scenario: &Scenario) -> Result<()> {
    let refuse = |field: InputField, value: String| {
        Err(InputError::new(
            field,
            value,
            "0 for the solid model",
            "run this scenario with the moving solver alone",
        )
        .into())
    };
    if scenario.speed != 0.0 {
        return refuse(InputField::Speed, format!("{} m/s", scenario.speed));
    }
    if let Some(torsion) = scenario.rail_torsion {
        return refuse(InputField::RailTorsion, format!("{} N·m", torsion.amplitude));
    }
    Ok(())
}
