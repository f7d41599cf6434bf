//! The stepping with contact on a fine grid: crowned blocks of 60 mm against statics, Hertz' impact, energy and momentum.

use super::*;
use crate::time::function::HarmonicForce;
use railspring_calibrate::analytic::hertz::point_contact;
use railspring_calibrate::calibration::{Bodies, DOWNWARDS, Pressed, WheelOnRail};
use railspring_calibrate::contact::{Side, resultant};
use railspring_profiles::quadrature::gauss_2_on;
use std::sync::OnceLock;

/// Radius of the rail's crown and of the wheel, m: together a sphere on a plane.
const RADIUS: f64 = 0.46;
const HALF_WIDTH: f64 = 0.03;
const HEIGHT: f64 = 0.03;

/// Few modes of blocks whose first ones swing at 20 kHz.
const FEW_MODES: Order = Order::Reduced(16);

/// A wheel's block with a straight profile above a rail's crowned one.
struct Crowned {
    rail: HexMesh,
    wheel: HexMesh,
    curves: [ProfileCurve; 2],
    /// Where the contact in time lives.
    field: ContactField,
}

impl Crowned {
    /// Blocks of half a width `half` (m); rigid above the wheel's is a body of the height `rigid` (m), which follows the master node.
    fn new(half: f64, rigid: f64) -> Self {
        let block = BlockOptions::graded(half, HEIGHT, 0.012, 0.006, 3e-3, 1.5);
        let mut rail = mesh_block(&block).unwrap();
        rail.ends = std::mem::take(&mut rail.foot);
        let top = *block.z.last().unwrap();
        let z = block.z.iter().copied().chain((rigid > 0.0).then_some(top + rigid)).collect();
        let mut wheel = upside_down(mesh_block(&BlockOptions { z, ..block }).unwrap());
        wheel.bore = (0..wheel.nodes.len()).filter(|&n| wheel.nodes[n].z < -top + 1e-9).collect();
        wheel.contact.along_track.iter_mut().for_each(|x| *x /= RADIUS);
        let arc = |n: i32| f64::from(n) / 40.0 * half;
        let crown: Vec<_> = (-40..=40)
            .map(|n| arc(n) / RADIUS)
            .map(|a| Point2::new(RADIUS * a.sin(), RADIUS * (1.0 - a.cos())))
            .collect();
        let straight: Vec<_> = (-40..=40).map(|n| Point2::new(arc(n), 0.0)).collect();
        let curves = [crown, straight].map(|points| ProfileCurve::from_points(&points, &[]).unwrap());
        Self { rail, wheel, curves, field: ContactField::Hybrid }
    }

    /// A rail's block that is not held.
    fn free(mut self) -> Self {
        self.rail.ends.clear();
        self
    }

    /// Surfaces of rail and wheel, the wheel higher by `gap` (m).
    fn surfaces(&self, gap: f64) -> [Surface<'_>; 2] {
        let origin = Vector2::new(0.0, -gap);
        [
            Surface::extruded(&self.curves[0], &self.rail.contact),
            Surface::revolved(&self.curves[1], &self.wheel.contact, RADIUS, origin),
        ]
    }

    fn records(
        &self,
        order: Order,
        material: Material,
        speed: f64,
        gap: f64,
        scenario: &Scenario,
    ) -> Vec<Record> {
        let mut ledger = Ledger::default();
        let mut records = Vec::new();
        self.observe(order, material, speed, gap, scenario, &mut |step| {
            records.push(ledger.enter(scenario, step))
        });
        records
    }

    /// Runs `scenario` from the distance `gap` (m) with a `speed` (m/s).
    fn observe(
        &self,
        order: Order,
        material: Material,
        speed: f64,
        gap: f64,
        scenario: &Scenario,
        see: &mut dyn FnMut(&Step),
    ) {
        let placed_rail = PlacedRail { curve: self.curves[0].clone(), angle: 0.0, origin: Point2::origin() };
        let [rail_surface, wheel_surface] = self.surfaces(gap);
        of_order(order, [&self.rail, &self.wheel], material, &mut |bodies| {
            let model = TransientModel {
                bodies,
                materials: [material; 2],
                placed_rail: &placed_rail,
                rail_axis: None,
                rail_surface: rail_surface.clone(),
                wheel_surface: wheel_surface.clone(),
                enforcement: Enforcement::Exact,
                field: self.field,
                path: None,
                axle: 0.0,
            };
            let mut all = |step: &Step| {
                see(step);
                Ok(None)
            };
            model.run_from(&Vector2::new(0.0, speed), scenario, &Silent, &mut all).unwrap();
        });
    }

    /// The static states under ascending loads (N), each grown from the one before.
    fn pressed(&self, friction: f64, loads: &[f64]) -> Vec<Pressed> {
        let condensed = |mesh: &HexMesh, supports: Supports| {
            let system =
                System::new(mesh, Material::STEEL, Formulation::IncompatibleModes, &supports).unwrap();
            Superelement::new(system).unwrap().compliance
        };
        let rail = condensed(&self.rail, Supports { held: self.rail.ends.clone(), ..Default::default() });
        let wheel =
            condensed(&self.wheel, Supports { followers: self.wheel.bore.clone(), ..Default::default() });
        let [rail_surface, wheel_surface] = self.surfaces(0.0);
        let static_model = WheelOnRail {
            along: DOWNWARDS,
            bodies: Bodies::Condensed { rail: &rail, wheel: &wheel, mirrored: false },
            rail_surface,
            wheel_surface,
            friction,
            enforcement: Enforcement::Exact,
            field: ContactField::Hybrid,
            materials: [Material::STEEL; 2],
            beyond: OnceLock::new(),
        };
        let mut states: Vec<Pressed> = Vec::new();
        for &load in loads {
            let state = static_model.press(load, states.last()).unwrap();
            states.push(state);
        }
        states
    }
}

/// Goal: under a load that grows in long steps the fine contact of a step is the static one of
/// [`WheelOnRail::press`] under the same contact force. It is so without and with friction, whose history
/// both have. Compared are displacement of the hub (m) and forces on the nodes (N). The blocks are so small
/// that both have the far field of all their nodes. Accuracy: MODEL, 1e-7: the inertia of the wheel's block,
/// which bends it and has 7e-5 of the mass, in an interpolated far field. SOLVER, 1e-10 of the largest force,
/// 6e-8 N, at each of 300 points, added at random, over the stiffness 4·m/Δt² of the hub alone, 9e-11 m of
/// 7e-5 m. The forces at the nodes follow to the same. PAIRING, (b/R)² of the approach: the statics pairs
/// where the hub is, at the rim of the patch with normals that lie b/R beside the vertical. Along these the
/// approach is taken as `1/cos` of it in the rigid gap and as `cos` in the rest.
#[test]
#[ignore = "a quarter of a minute: cargo long fine"]
fn a_slow_load_gives_the_static_state() {
    const MODEL: f64 = 1e-7;
    const SOLVER: f64 = 1e-6;
    let dt = 1.0;
    // a line of the fine grid runs along the crest, so that there is no lateral force on the hub, which is free in one model only
    // halved, the cells in time are those of the statics
    let blocks = Crowned { field: ContactField::HybridHalved, ..Crowned::new(24.0 * 0.65e-3, 400.0) };
    for (friction, order) in [(0.0, Order::Full), (0.3, Order::Full), (0.3, FEW_MODES)] {
        // no load at t = 0, then 240 and 293 kN: patches so long that both models have the largest cells, and not so long that one of them
        // has a far field of other nodes
        let (amplitude, phase) = (1.9624e6, 1.0123_f64);
        let scenario = Scenario {
            vertical_force: HarmonicForce {
                constant: -amplitude * phase.sin(),
                amplitude,
                frequency: 1.0 / (20.0 * dt),
                phase,
            }
            .into(),
            ..Scenario::new(2, dt, friction)
        };
        let mut steps: Vec<(f64, f64, Vec<f64>)> = Vec::new();
        blocks.observe(order, Material::STEEL, 0.0, 0.0, &scenario, &mut |step| {
            let force = -resultant(&step.contact.points, &step.contact.solution.forces).z;
            steps.push((force, step.hub.position().y, step.forces[0].clone()));
        });
        let loads: Vec<f64> = steps.iter().map(|step| step.0).collect();
        let states = blocks.pressed(friction, &loads);
        assert_eq!(states.len(), 2);
        for (state, (_, hub, forces)) in states.iter().zip(&steps) {
            let hertz =
                point_contact(state.load, RADIUS, RADIUS, Material::STEEL.contact_modulus(&Material::STEEL))
                    .unwrap();
            let tolerance = MODEL + SOLVER + (hertz.semi_axis_x / RADIUS).powi(2);
            let ratio = hub / state.hub.y - 1.0;
            assert!(ratio.abs() < tolerance, "{friction} {} N: {ratio:e} of {tolerance:e}", state.load);
            let expected = state.body_forces(Side::Base, forces.len());
            let most = expected.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
            let errors = forces.iter().zip(&expected).map(|(found, expected)| (found - expected).abs());
            let error = largest(errors) / most;
            assert!(error < tolerance, "{friction} {} N: {error:e} of {tolerance:e}", state.load);
        }
    }
}

/// Source: H. Hertz 1881 (K.L. Johnson, Contact Mechanics, 1985, section 11.4): a heavy body on a contact follows its static law;
/// energy gives the largest force, its quadrature the contact time. The blocks add a constant compliance, taken from the
/// static states under two loads, where it must be the same. Goal: force (N), contact time (s), rebound (m/s) of a mass of 11 t.
///
/// Accuracy: DISCRETISATION, the approach of the fine grid 0.3 %, of which half is in the force; two steps of 200 in the time, and the
/// energy that opening and closing within a step take, 1 %. MODEL, waves in the blocks, a period of 10 µs of a contact of ms, are nothing.
#[test]
fn a_heavy_body_follows_hertz() {
    const DISCRETISATION: f64 = 3e-3;
    const STEPS: usize = 200;
    let (rigid, speed) = (400.0, 0.02);
    let blocks = Crowned::new(HALF_WIDTH, rigid);
    let hertz = |force: f64| {
        point_contact(force, RADIUS, RADIUS, Material::STEEL.contact_modulus(&Material::STEEL))
            .unwrap()
            .approach
    };
    let loads = [30e3, 60e3];
    let compliances: Vec<f64> =
        blocks.pressed(0.0, &loads).iter().map(|s| (s.hub.y - hertz(s.load)) / s.load).collect();
    let (beyond, approach) = (compliances[1], hertz(60e3));
    let spread = (compliances[1] - compliances[0]).abs() * 60e3 / approach;
    assert!(spread < DISCRETISATION, "{compliances:?}");
    let mass = Material::STEEL.density * (2.0 * HALF_WIDTH).powi(2) * (rigid + HEIGHT);
    let energy = |force: f64| 0.4 * force * hertz(force) + 0.5 * beyond * force * force;
    let whole = 0.5 * mass * speed * speed;
    let peak = railspring_profiles::root::bisection(1e3, 1e6, |force| !(energy(force) < whole));
    // dδ = (dh/dF + C) dF with F = peak·(1 - s²), smooth at the turning point
    let time_at = |s: f64| {
        let force = peak * (1.0 - s * s);
        let slope = 2.0 / 3.0 * hertz(force) / force + beyond;
        4.0 * slope * peak * s / (2.0 * (whole - energy(force)) / mass).sqrt()
    };
    let parts = 400;
    let contact_time: f64 = (0..parts)
        .map(|n| gauss_2_on(f64::from(n) / f64::from(parts), f64::from(n + 1) / f64::from(parts)))
        .map(|(points, half)| half * points.into_iter().map(time_at).sum::<f64>())
        .sum();
    let dt = contact_time / STEPS as f64;
    for order in [Order::Full, FEW_MODES] {
        let records = blocks.records(order, Material::STEEL, speed, 0.0, &quiet(STEPS + 20, dt));
        let force = largest(records.iter().map(|r| r.force));
        let (first, last) = contact_steps(&records);
        let momentum = records[records.len() - 1].momentum[1] / (mass * speed);
        assert!((force / peak - 1.0).abs() < DISCRETISATION, "{force} {peak}");
        assert!((last - first + 1).abs_diff(STEPS) <= 2, "{first} {last}");
        assert!((momentum + 1.0).abs() < 0.01, "{momentum}");
    }
}

/// Source: momentum and energy. Goal: a block strikes an equal one at rest, both free, or one that is held,
/// at either order. Momentum (N·s) is kept to SOLVER, with a held block that of the wheel against the impulse
/// of the force. The energy (J) of the bodies is the work of the nodal forces to SOLVER. Between free bodies
/// that work is back when they part, as the near field between them stores energy and takes none. Three
/// errors remain. One is F·v·Δt/2 at both ends, with the force of the first and last step. The trapezoidal
/// rule on Hertz' law leaves (Δt/T)² of the energy. The grid changes with the patch: DISCRETISATION, 0.1 % of
/// the approach on some ten cells across it, of the energy of Hertz' contact under the largest force.
#[test]
fn a_fine_contact_keeps_momentum_and_energy() {
    const SOLVER: f64 = 1e-9;
    const DISCRETISATION: f64 = 1e-3;
    let mass = Material::STEEL.density * (2.0 * HALF_WIDTH).powi(2) * HEIGHT;
    let (dt, whole, start) = (1e-6, mass * SPEED, 0.5 * mass * SPEED * SPEED);
    let free = Crowned::new(HALF_WIDTH, 0.0).free();
    let held = Crowned::new(HALF_WIDTH, 0.0);
    for (blocks, order) in [(&free, Order::Full), (&held, Order::Full), (&held, FEW_MODES)] {
        let records = blocks.records(order, Material::STEEL, SPEED, 1e-6, &quiet(150, dt));
        let (first, last) = contact_steps(&records);
        let is_free = blocks.rail.ends.is_empty();
        let mut impulse = 0.0;
        let drift = largest(records.iter().enumerate().map(|(n, r)| {
            let before = if n > 0 { records[n - 1].force } else { 0.0 };
            impulse += 0.5 * (before + r.force) * dt;
            let lost = if is_free { r.momentum[0] } else { impulse };
            ((r.momentum[1] + lost) / whole - 1.0).abs()
        }));
        assert!(drift < SOLVER, "{order:?} {drift:e}");
        let balance = largest(records.iter().map(|r| ((r.energy - r.contact_work) / start - 1.0).abs()));
        assert!(balance < SOLVER, "{order:?} {balance:e}");
        let stored = -records.iter().map(|r| r.contact_work).fold(0.0, f64::min);
        assert!(last + 5 < records.len() && stored > 0.02 * start, "{order:?} {first} {last} {stored}");
        let left = records[records.len() - 1].contact_work.abs();
        let steps = (last - first + 1) as f64;
        let ends = (records[first].force + records[last].force) * SPEED * dt;
        let peak = largest(records.iter().map(|r| r.force));
        let hertz =
            point_contact(peak, RADIUS, RADIUS, Material::STEEL.contact_modulus(&Material::STEEL)).unwrap();
        let of_grids = DISCRETISATION * 0.4 * peak * hertz.approach;
        assert!(left < ends + start / (steps * steps) + of_grids, "{order:?} {left} of {start}");
    }
}
