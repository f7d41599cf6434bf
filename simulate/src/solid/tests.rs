//! The stepping of the transient solid against closed solutions: bars that collide, energy, a falling mass.
//!
//! The wheel of the model is an elastic bar (its far end the bore, which moves with the master node), the rail
//! another bar or a thin plate as wall. Poisson's ratio is 0, so that the waves are those of one dimension:
//! K.F. Graff, Wave Motion in Elastic Solids (1975), section 2.4; speed `c = √(E/ρ)`.

mod beyond;
mod fine;
mod placed;
mod rods;
mod widening;

use super::run::Step;
use super::*;
use crate::time::function::TimeFunction;
use crate::time::scenario::Kelvin;
use crate::time::steps::StepControl;
use nalgebra::Point2;
use railspring_calibrate::analytic::drop::drop;
use railspring_calibrate::calibration::{ContactField, Enforcement};
use railspring_calibrate::contact::Surface;
use railspring_calibrate::law::StiffnessLaw;
use railspring_calibrate::mesh::{BlockOptions, HexMesh, mesh_block};
use railspring_calibrate::solid::{Formulation, Material};
use railspring_calibrate::superelement::{CondensedBody, Superelement};
use railspring_profiles::monitor::Silent;
use railspring_profiles::placement::PlacedRail;
use railspring_profiles::profile::ProfileCurve;

/// Edge of the square sections, m.
const WIDTH: f64 = 0.01;
const AREA: f64 = WIDTH * WIDTH;
/// Length of an elastic bar, m.
const LENGTH: f64 = 0.24;
/// Speed at the impact, m/s.
const SPEED: f64 = 1.0;

fn bar(length: f64, elements: usize) -> HexMesh {
    mesh_block(&BlockOptions::uniform([WIDTH, WIDTH, length], [1, 1, elements])).unwrap()
}

/// A block turned upside down, its contact surface below and its foot as bore above.
fn upside_down(mut mesh: HexMesh) -> HexMesh {
    for p in &mut mesh.nodes {
        *p = Point3::new(p.x, -p.y, -p.z);
    }
    let grid = &mut mesh.contact;
    let (rows, columns) = (grid.along_profile.len(), grid.along_track.len());
    let mirrored = |n: usize| grid.nodes[(rows - 1 - n / columns) * columns + n % columns];
    grid.nodes = (0..rows * columns).map(mirrored).collect();
    mesh.bore = std::mem::take(&mut mesh.foot);
    mesh
}

/// A plate so thin that it is rigid beside the bar: 1/2400 of its compliance. It is held at its foot.
fn wall() -> HexMesh {
    let mut mesh = bar(LENGTH / 2400.0, 1);
    mesh.ends = std::mem::take(&mut mesh.foot);
    mesh
}

fn steel(damping: f64) -> Material {
    Material { poisson: 0.0, damping, ..Material::STEEL }
}

fn wave_speed() -> f64 {
    (Material::STEEL.young / Material::STEEL.density).sqrt()
}

fn bar_mass() -> f64 {
    Material::STEEL.density * AREA * LENGTH
}

/// Force of a wave of the particle velocity `SPEED`: ρ·c·v·A, N.
fn wave_force() -> f64 {
    Material::STEEL.density * wave_speed() * SPEED * AREA
}

/// A bar alone, without forces.
fn quiet(steps: usize, time_step: f64) -> Scenario {
    Scenario::new(steps, time_step, 0.0)
}

/// One finished step as the tests see it.
#[derive(Debug, Clone, Copy)]
struct Record {
    /// Contact force, N.
    force: f64,
    /// Momentum of rail and wheel down, N·s.
    momentum: [f64; 2],
    /// Kinetic and strain energy of both bodies, of the suspended mass and its spring, J.
    energy: f64,
    /// Work of the contact forces on both bodies by the trapezoidal rule, J. In exact time it is 0.
    contact_work: f64,
    /// Work of gravity and of the vertical force less what the damper takes, J.
    outer_work: f64,
    /// Position of the hub, m.
    hub: f64,
    /// Drift of the balance in the history, J; nothing of bodies that have none, and of adapted steps.
    drift: Option<f64>,
}

/// What the bodies of a run are.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Order {
    Full,
    /// With so many modes at most.
    Reduced(usize),
}

/// All modes that a body has: on the bars below they are fewer.
const ALL_MODES: Order = Order::Reduced(1000);

/// The rail's body, held at its ends, and the wheel's, held at its bore, as they are condensed.
fn condensed([rail, wheel]: [&HexMesh; 2], material: Material, modes: usize) -> [CondensedBody; 2] {
    let on_ends = Supports { held: rail.ends.clone(), ..Default::default() };
    let on_hub = Supports { followers: wheel.bore.clone(), ..Default::default() };
    [(rail, on_ends), (wheel, on_hub)].map(|(mesh, supports)| {
        let system = System::new(mesh, material, Formulation::IncompatibleModes, &supports).unwrap();
        let element = Superelement::new(system).unwrap();
        let modes = Some(element.modes(modes).unwrap());
        CondensedBody { modes, ..element.condensed("test".into()) }
    })
}

/// Makes a model of the order `order` with what `model` makes of its bodies.
fn of_order(
    order: Order,
    [rail, wheel]: [&HexMesh; 2],
    material: Material,
    run: &mut dyn FnMut(SolidBodies<'_>),
) {
    match order {
        Order::Full => {
            let materials = Materials::from(material);
            let materials = [&materials; 2];
            run(SolidBodies::Full { rail, wheel, materials, formulation: Formulation::IncompatibleModes });
        }
        Order::Reduced(modes) => {
            let [rail, wheel] = &condensed([rail, wheel], material, modes);
            run(SolidBodies::Reduced { rail, wheel, modes: ModeCount::Given(modes) });
        }
    }
}

/// Runs a wheel that starts with `SPEED` at the distance `gap` (m) from the rail.
fn collide(
    order: Order,
    [rail_mesh, wheel_mesh]: [&HexMesh; 2],
    material: Material,
    gap: f64,
    scenario: &Scenario,
) -> Vec<Record> {
    let straight = |half: f64| {
        let points: Vec<_> = (-4..=4).map(|i| Point2::new(half * f64::from(i) / 4.0, 0.0)).collect();
        ProfileCurve::from_points(&points, &[]).unwrap()
    };
    // the wheel's profile goes on beyond its mesh: the last nodes of the rail see it, whatever rounding moves them aside
    let (curve, wider) = (straight(0.5 * WIDTH), straight(0.6 * WIDTH));
    let placed_rail = PlacedRail { curve: curve.clone(), angle: 0.0, origin: Point2::origin() };
    let mut grid = wheel_mesh.contact.clone();
    grid.along_profile.iter_mut().for_each(|s| *s += 0.1 * WIDTH);
    let mut wheel_surface = Surface::extruded(&wider, &grid);
    wheel_surface.origin.y = -gap;
    let mut records = Vec::new();
    of_order(order, [rail_mesh, wheel_mesh], material, &mut |bodies| {
        let model = TransientModel {
            bodies,
            materials: [material; 2],
            placed_rail: &placed_rail,
            rail_axis: None,
            rail_surface: Surface::extruded(&curve, &rail_mesh.contact),
            wheel_surface: wheel_surface.clone(),
            enforcement: Enforcement::Exact,
            field: ContactField::Elements,
            path: None,
            axle: 0.0,
        };
        let mut ledger = Ledger::default();
        let mut enter = |step: &Step| {
            records.push(ledger.enter(scenario, step));
            Ok(None)
        };
        let run = model.run_from(&Vector2::new(0.0, SPEED), scenario, &Silent, &mut enter).unwrap();
        if records.len() == scenario.steps {
            let rows = &run.history.rows[1..];
            records.iter_mut().zip(rows).for_each(|(r, row)| r.drift = row.energy.map(|energy| energy.drift));
        }
    });
    records
}

/// Momentum, energy and work of a run, from the bodies and the forces on them.
#[derive(Default)]
struct Ledger {
    /// Contact forces and displacements of rail and wheel, one step before.
    contact: [(Vec<f64>, Vec<f64>); 2],
    contact_work: f64,
    /// Mass times displacement of the wheel, position of the suspended mass and of the hub, one step before.
    before: [f64; 3],
    outer_work: f64,
}

impl Ledger {
    fn enter(&mut self, scenario: &Scenario, step: &Step) -> Record {
        let momentum = step.sums.map(|body| body.momentum);
        let mut energy: f64 = step.sums.iter().map(|body| body.energy).sum();
        for ((moved, forces), before) in step.displacements.iter().zip(step.forces).zip(&mut self.contact) {
            for (i, u) in moved.iter().enumerate() {
                let (f0, u0) = (before.0.get(i).unwrap_or(&0.0), before.1.get(i).unwrap_or(&0.0));
                self.contact_work += 0.5 * (f0 + forces[i]) * (u - u0);
            }
            *before = (forces.clone(), moved.to_vec());
        }
        let (suspended, hub) = (&step.hub.suspended, step.hub.position().y);
        let (mass, spring) = (scenario.suspended_mass, scenario.vertical_suspension);
        energy += 0.5 * mass * suspended.v.powi(2) + 0.5 * spring.stiffness * (suspended.u - hub).powi(2);
        let moment = step.sums[1].moment;
        let [moment_before, z_before, hub_before] = self.before;
        let weight = scenario.vertical_force.at(0.0) + mass * scenario.gravity;
        let stroke = suspended.u - hub - (z_before - hub_before);
        self.outer_work += scenario.gravity * (moment - moment_before) + weight * (suspended.u - z_before)
            - spring.damping * stroke * stroke / step.length;
        self.before = [moment, suspended.u, hub];
        Record {
            force: -downwards(&step.forces[1]),
            momentum,
            energy,
            contact_work: self.contact_work,
            outer_work: self.outer_work,
            hub,
            drift: None,
        }
    }
}

/// Sum of the components in z.
fn downwards(nodal: &[f64]) -> f64 {
    nodal.iter().skip(2).step_by(3).sum()
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::NEG_INFINITY, f64::max)
}

/// First and last step with contact.
fn contact_steps(records: &[Record]) -> (usize, usize) {
    let touches = |r: &Record| r.force > 0.0;
    (records.iter().position(touches).unwrap(), records.iter().rposition(touches).unwrap())
}

/// Largest deviation of the force from `exact` in the middle 60 % of the contact, relative.
fn off_plateau(records: &[Record], exact: f64) -> f64 {
    let (first, last) = contact_steps(records);
    let margin = (last - first) / 5;
    largest(records[first + margin..=last - margin].iter().map(|r| (r.force / exact - 1.0).abs()))
}

/// An elastic bar of `elements` that strikes the wall, or an equal bar at rest, with one step an element.
fn struck(order: Order, elements: usize, wall_stands: bool) -> (Vec<Record>, f64) {
    let dt = LENGTH / wave_speed() / elements as f64;
    let upper = upside_down(bar(LENGTH, elements));
    let lower =
        if wall_stands { wall() } else { HexMesh { foot: vec![], ends: vec![], ..bar(LENGTH, elements) } };
    (collide(order, [&lower, &upper], steel(0.0), 1e-6, &quiet(3 * elements + 20, dt)), dt)
}

/// ROUNDOFF and tolerance of the contact solver, relative: 1e-10 of the largest force in every step.
const SOLVER: f64 = 1e-9;
/// Elements of the bars below.
const ELEMENTS: usize = 48;
/// DISCRETISATION of the contact time, relative: a step to meet, a step to leave, and the mass of the first layer half
/// an element further in, on the way there and back; of 2·ELEMENTS steps.
const CONTACT_TIME: f64 = 3.0 / (2.0 * ELEMENTS as f64);
/// DISCRETISATION of the plateau: the wall yields 4e-4; short waves lag behind the front and do not reach the end.
const PLATEAU: f64 = 1e-3;

/// Half the thickness of a wave front after `elements` there and back, relative to the way: dispersion of third order
/// thickens a front with the cube root of the way. It is DISCRETISATION of what a bar brings back from an impact.
fn front(elements: usize) -> f64 {
    0.5 * (2.0 * elements as f64).powf(-2.0 / 3.0)
}

/// Source: Graff, section 2.4. Goal: a bar that strikes a rigid wall presses with ρ·c·v·A (N) for the time 2·L/c (s) and
/// flies back with its speed (m/s). Accuracy: PLATEAU, CONTACT_TIME and the front.
#[test]
fn a_bar_rebounds_from_a_wall() {
    for order in [Order::Full, ALL_MODES] {
        let (records, dt) = struck(order, ELEMENTS, true);
        let (first, last) = contact_steps(&records);
        let time = (last - first + 1) as f64 * dt;
        assert!((time * wave_speed() / (2.0 * LENGTH) - 1.0).abs() < CONTACT_TIME, "{time} s");
        let off = off_plateau(&records, wave_force());
        assert!(off < PLATEAU, "force {off}");
        let rebound = records[records.len() - 1].momentum[1] / (bar_mass() * SPEED);
        assert!((rebound + 1.0).abs() < front(ELEMENTS), "{rebound}");
    }
}

/// Source: Graff, section 2.4. Goal: a bar that strikes an equal one at rest stops and transfers its speed (m/s); the force
/// is ρ·c·v·A/2 (N), the contact lasts 2·L/c (s); momentum (N·s) is kept to SOLVER in every step.
#[test]
fn equal_bars_exchange_their_velocities() {
    let (records, dt) = struck(Order::Full, ELEMENTS, false);
    let (first, last) = contact_steps(&records);
    let time = (last - first + 1) as f64 * dt;
    assert!((time * wave_speed() / (2.0 * LENGTH) - 1.0).abs() < CONTACT_TIME, "{time} s");
    let off = off_plateau(&records, 0.5 * wave_force());
    assert!(off < PLATEAU, "force {off}");
    let whole = bar_mass() * SPEED;
    let [lower, upper] = records[records.len() - 1].momentum.map(|m| m / whole);
    assert!((lower - 1.0).abs() < front(ELEMENTS) && upper.abs() < front(ELEMENTS), "{lower} {upper}");
    let drift = largest(records.iter().map(|r| ((r.momentum[0] + r.momentum[1]) / whole - 1.0).abs()));
    assert!(drift < SOLVER, "{drift:e}");
}

/// Source: the bodies at full order. Goal: force (N), momentum (N·s) and hub (m) of an impact with all modes that the loads on the
/// contact zone can excite are those of all equations, with and without damping. Accuracy: SOLVER in every step, of the forces and of the
/// momentum of the wave; ROUNDOFF of modes up to 200 kHz, which are orthogonal to 1e-12, carried over by 164 steps, 1e-9.
#[test]
fn all_modes_are_the_full_order() {
    const ROUNDOFF: f64 = 1e-9;
    let dt = LENGTH / wave_speed() / 48.0;
    let upper = upside_down(bar(LENGTH, 48));
    for damping in [0.0, 5e-7] {
        let run = |order| collide(order, [&wall(), &upper], steel(damping), 1e-6, &quiet(164, dt));
        let (full, reduced) = (run(Order::Full), run(ALL_MODES));
        assert!(full.iter().filter(|r| r.force > 0.0).count() > 90);
        for (full, reduced) in full.iter().zip(&reduced) {
            let difference = [
                (reduced.force - full.force) / wave_force(),
                (reduced.momentum[1] - full.momentum[1]) / (bar_mass() * SPEED),
                (reduced.hub - full.hub) / (SPEED * LENGTH / wave_speed()),
            ];
            let worst = largest(difference.into_iter().map(f64::abs));
            assert!(worst < SOLVER + ROUNDOFF, "{damping}: {difference:?}");
        }
    }
}

/// Goal: the speed of the rebound converges with mesh and step as the front does, by the power 2/3, and below its cap; the
/// Airy tail behind the front makes it slower at first. Measured: 0.52 from 12 to 96 elements.
#[test]
fn the_rebound_converges_as_the_front_does() {
    let error = |elements| {
        let (records, _) = struck(Order::Full, elements, true);
        1.0 + records[records.len() - 1].momentum[1] / (bar_mass() * SPEED)
    };
    let errors = [12, 24, 48, 96].map(error);
    let slope = (errors[0] / errors[3]).log2() / 3.0;
    assert!((0.4..0.8).contains(&slope), "{slope} {errors:?}");
    assert!(errors[3] < front(96), "{errors:?}");
}

/// Source: a wave into a bar with stiffness-proportional damping β: the impedance ρ·c·A·√(1 + β·s) gives the force
/// ρ·c·v·A from some β on until the front, spread to √(β·L/c), comes back. Goal: the force (N) is that for every
/// time step, from one to a sixteenth of the passage of an element. Accuracy: the spread front has 1 % left at the
/// end of the plateau.
#[test]
fn the_force_of_a_damped_bar_does_not_depend_on_the_step() {
    for order in [Order::Full, ALL_MODES] {
        const DISCRETISATION: f64 = 0.01;
        let elements = 24;
        let upper = upside_down(bar(LENGTH, elements));
        for division in [1, 4, 16] {
            let dt = LENGTH / wave_speed() / (elements * division) as f64;
            let records =
                collide(order, [&wall(), &upper], steel(5e-7), 1e-6, &quiet(3 * elements * division, dt));
            let off = off_plateau(&records, wave_force());
            assert!(off < DISCRETISATION, "1/{division}: {off}");
        }
    }
}

/// Source: the trapezoidal rule keeps energy but for the work of contact forces over a gap that opens or closes within
/// a step: at most F·v·Δt/2 for each end of a contact. Goal: energy (J) of both bodies, suspended mass and spring less
/// the work done on them is constant to SOLVER in every step of a bar that is pressed on and bounces; the work of the contact
/// forces stays below that bound.
#[test]
fn energy_is_kept_while_a_bar_bounces() {
    for order in [Order::Full, ALL_MODES, Order::Reduced(16)] {
        let elements = 24;
        let dt = LENGTH / wave_speed() / elements as f64;
        let upper = upside_down(bar(LENGTH, elements));
        let scenario = Scenario {
            gravity: 9.81,
            suspended_mass: 0.5,
            vertical_suspension: Kelvin { stiffness: 5e6, damping: 100.0 },
            vertical_force: TimeFunction::constant(2e3),
            ..quiet(1500, dt)
        };
        let records = collide(order, [&wall(), &upper], steel(0.0), 1e-6, &scenario);
        let start = 0.5 * (bar_mass() + scenario.suspended_mass) * SPEED * SPEED;
        let balance = |r: &Record| (r.energy - r.outer_work - r.contact_work) / start - 1.0;
        let worst = largest(records.iter().map(|r| balance(r).abs()));
        assert!(worst < SOLVER, "{worst:e}");
        let ends: Vec<_> = records.windows(2).filter(|w| (w[0].force > 0.0) != (w[1].force > 0.0)).collect();
        assert!(ends.len() >= 6, "it touches {} times", ends.len());
        let bound: f64 = ends.iter().map(|w| 0.5 * w[0].force.max(w[1].force) * 2.0 * SPEED * dt).sum();
        let work = largest(records.iter().map(|r| r.contact_work.abs()));
        assert!(work < bound, "{work} {bound}");
        // the balance of the history has no other drift than that work
        let off = |r: &Record| r.drift.map(|drift| (drift - r.contact_work).abs() / start);
        assert_eq!(off(&records[0]).is_some(), order != Order::Full);
        let off = largest(records.iter().filter_map(off).chain([0.0]));
        assert!(off < SOLVER, "{off:e}");
    }
}

/// Source: the balance itself, whose damping is that of modes and residual apart. Goal: a damped bar strikes
/// a wall. Its balance of energy (J) drifts only by the work of the contact forces over gaps that open or
/// close within a step. That is F·v·Δt/2 at each end with the speed of a free end, twice that of the wave. A
/// tenth of the energy is damped.
#[test]
fn what_a_damped_bar_loses_is_damping() {
    let elements = 24;
    let dt = LENGTH / wave_speed() / elements as f64;
    let upper = upside_down(bar(LENGTH, elements));
    let records = collide(ALL_MODES, [&wall(), &upper], steel(5e-7), 1e-6, &quiet(4 * elements, dt));
    let start = 0.5 * bar_mass() * SPEED * SPEED;
    let last = &records[records.len() - 1];
    assert_eq!(last.force, 0.0);
    let off = largest(records.iter().map(|r| (r.drift.unwrap() - r.contact_work).abs() / start));
    assert!(off < SOLVER, "{off:e}");
    let ends: Vec<_> = records.windows(2).filter(|w| (w[0].force > 0.0) != (w[1].force > 0.0)).collect();
    let bound: f64 = ends.iter().map(|w| 0.5 * w[0].force.max(w[1].force) * 2.0 * (2.0 * SPEED) * dt).sum();
    assert!(last.drift.unwrap().abs() < bound, "{:?} {bound}", last.drift);
    assert!(last.energy < 0.9 * start, "{} of {start}", last.energy);
}

/// A mass that does not deform but for its contact layer falls on a bar that is held below: mass and stiffness.
struct HeavyFall {
    rail: HexMesh,
    wheel: HexMesh,
    mass: f64,
    law: StiffnessLaw,
}

impl HeavyFall {
    /// The wheel follows its master node, its contact nodes excepted. Its length only gives it its mass.
    fn new() -> Self {
        const LAYER: f64 = 1e-3;
        const HEIGHT: f64 = 400.0;
        let planes =
            BlockOptions { z: vec![0.0, LAYER, HEIGHT], ..BlockOptions::uniform([WIDTH; 3], [1; 3]) };
        let mut wheel = upside_down(mesh_block(&planes).unwrap());
        wheel.bore = (0..wheel.nodes.len()).filter(|n| !wheel.contact.nodes.contains(n)).collect();
        let mut rail = bar(LENGTH, 24);
        rail.ends = std::mem::take(&mut rail.foot);
        let a = Material::STEEL.young * AREA / (LENGTH + LAYER);
        let mass = Material::STEEL.density * AREA * HEIGHT;
        Self { rail, wheel, mass, law: StiffnessLaw { a, b: 0.0, c: 0.0 } }
    }

    fn run(&self, order: Order, gap: f64, steps: usize, dt: f64) -> Vec<Record> {
        collide(order, [&self.rail, &self.wheel], steel(0.0), gap, &quiet(steps, dt))
    }
}

/// Source: `analytic::drop`, energy and quadrature. Goal: displacement (m), force (N), contact time (s) and rebound (m/s) of
/// a mass on a bar of 1/1670 of its mass, which the closed solution leaves out. Accuracy: MODEL, a third of that
/// mass on displacement and rebound, and its waves, steps of 2·ρ·c·v·A, on the force; DISCRETISATION, the
/// steps in which the contact begins and ends.
#[test]
fn a_falling_mass_follows_the_closed_solution() {
    for order in [Order::Full, ALL_MODES, Order::Reduced(12)] {
        const STEPS: usize = 200;
        let fall = HeavyFall::new();
        let exact = drop(&fall.law, fall.mass, SPEED);
        let dt = exact.contact_time / STEPS as f64;
        let light = bar_mass() / fall.mass;
        let model = light / 3.0 + (std::f64::consts::PI / STEPS as f64).powi(2) / 8.0;
        for gap in [0.0, 1e-5] {
            let records = fall.run(order, gap, 260, dt);
            let (first, last) = contact_steps(&records);
            assert!((last - first + 1).abs_diff(STEPS) <= 2, "{first} {last}");
            let displacement = (largest(records.iter().map(|r| r.hub)) - gap) / exact.peak_displacement;
            assert!((displacement - 1.0).abs() < model, "{displacement}");
            let force = largest(records.iter().map(|r| r.force)) / exact.peak_force;
            assert!((force - 1.0).abs() < 2.0 * light.sqrt(), "{force}");
            let rebound = records[records.len() - 1].momentum[1] / (fall.mass * SPEED);
            assert!((rebound + 1.0).abs() < model, "{rebound}");
        }
    }
}

/// Source: `analytic::drop`, energy and quadrature. Goal: displacement (m), force (N) and rebound (m/s) of
/// the mass with adapted steps in time steps of a third of the contact. Equal steps miss the rebound by more
/// than twice the accuracy. The contact begins and ends within one time step, and there are two steps in the
/// air. Accuracy: MODEL as above; DISCRETISATION, an eighth of the tolerance at both ends of the contact.
#[test]
fn a_falling_mass_needs_short_steps_at_its_contact_alone() {
    const TOLERANCE: f64 = 0.02;
    let fall = HeavyFall::new();
    let exact = drop(&fall.law, fall.mass, SPEED);
    let dt = exact.contact_time / 3.0;
    // 2.3 time steps of flight, the contact, and flight again
    let gap = 2.3 * dt * SPEED;
    let run = |inner_steps| {
        let scenario = Scenario { inner_steps, ..quiet(12, dt) };
        collide(Order::Reduced(12), [&fall.rail, &fall.wheel], steel(0.0), gap, &scenario)
    };
    let records = run(InnerSteps::Adaptive(StepControl { least: 1, most: 128, tolerance: TOLERANCE }));
    let light = bar_mass() / fall.mass;
    let model = light / 3.0 + TOLERANCE / 4.0;
    let displacement = (largest(records.iter().map(|r| r.hub)) - gap) / exact.peak_displacement;
    assert!((displacement - 1.0).abs() < model, "{displacement}");
    let force = largest(records.iter().map(|r| r.force)) / exact.peak_force;
    assert!((force - 1.0).abs() < 2.0 * light.sqrt() + model, "{force}");
    let rebound = |records: &[Record]| records[records.len() - 1].momentum[1] / (fall.mass * SPEED);
    assert!((rebound(&records) + 1.0).abs() < model, "{}", rebound(&records));
    // two time steps in the air, and what it takes to meet the bar at the finest; afterwards the undamped bar rings
    let (first, _) = contact_steps(&records);
    assert!(first < 2 + 128 / 2, "{first} steps in the air");
    let equal = rebound(&run(InnerSteps::Equal(1)));
    println!("{displacement} {force} {} in {} steps, equal {equal}", rebound(&records), records.len());
    assert!((equal + 1.0).abs() > 2.0 * model, "{equal}");
}

/// Source: phase error (ω·Δt)²/12 of average acceleration. Goal: the path (m) of the falling mass converges with the second
/// power of the time step, against a run with steps 16 times as fine as the finest, and the error is that phase error
/// over half a period, π·(ω·Δt)²/12 of the largest displacement. Accuracy: MODEL, the mass of the bar, and terms of
/// fourth order, 1 % of the error.
#[test]
fn a_falling_mass_converges_with_the_square_of_the_step() {
    for order in [Order::Full, ALL_MODES] {
        const MODEL: f64 = 0.01;
        let fall = HeavyFall::new();
        let exact = drop(&fall.law, fall.mass, SPEED);
        let finest = 1600;
        let path = |steps: usize| fall.run(order, 0.0, steps, exact.contact_time / steps as f64);
        let reference = path(finest);
        let errors = [25, 50, 100].map(|steps| {
            let ratio = finest / steps;
            let gaps =
                path(steps).into_iter().enumerate().map(|(i, r)| r.hub - reference[(i + 1) * ratio - 1].hub);
            largest(gaps.map(f64::abs)) / exact.peak_displacement
        });
        let slope = (errors[0] / errors[2]).log2() / 2.0;
        assert!((1.8..2.2).contains(&slope), "{slope} {errors:?}");
        let phase = std::f64::consts::PI.powi(3) / (12.0 * 100.0 * 100.0);
        assert!((errors[2] / phase - 1.0).abs() < MODEL, "{errors:?} {phase}");
    }
}

/// Source: momentum. Goal: a vertical force (N) on a suspension without mass reaches the wheel, with and without spring
/// and damper: momentum (N·s) of a free bar grows by force times time. Accuracy: SOLVER.
#[test]
fn a_force_on_a_suspension_without_mass_reaches_the_wheel() {
    for order in [Order::Full, Order::Reduced(4)] {
        let upper = upside_down(bar(LENGTH, 4));
        for (stiffness, damping) in [(0.0, 0.0), (1e6, 0.0), (1e6, 1e3), (0.0, 1e3)] {
            let force = 2e3;
            let scenario = Scenario {
                vertical_suspension: Kelvin { stiffness, damping },
                vertical_force: TimeFunction::constant(force),
                ..quiet(40, 1e-6)
            };
            let records = collide(order, [&wall(), &upper], steel(0.0), 0.1, &scenario);
            let exact = bar_mass() * SPEED + force * 40e-6;
            let momentum = records[39].momentum[1];
            assert!((momentum / exact - 1.0).abs() < SOLVER, "{stiffness} {damping}: {momentum} {exact}");
        }
    }
}
