//! The question as the exchange folder has it: meshes, surfaces, supports, and the load case.

use railspring_calibrate::solid::Materials;
use railspring_simulate::time::function::HarmonicForce;
use serde_json::{Value, json};

use super::input::InTimeInput;
use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::meshes::Meshes;
use crate::results::crosscheck::exchange::{Body, Exchange};

/// The question: both bodies as they are in time, the rail held at its ends.
pub(super) fn exchange(input: &InTimeInput<'_>, geometry: &Geometry, meshes: &Meshes) -> Exchange {
    let statics = input.statics();
    let bodies = [0, 1].map(|k| {
        let held = if k == 0 { &meshes.rail.ends } else { &meshes.wheel.bore };
        Body::of(statics, geometry, meshes, k, held.clone())
    });
    Exchange {
        bodies,
        second_order: None,
        loads: Vec::new(),
        preloads: Vec::new(),
        friction: input.case.friction,
        cases: Vec::new(),
        input_hash: input.key(),
        in_time: Some(load_case(input)),
    }
}

/// The load case in SI units.
fn load_case(input: &InTimeInput<'_>) -> Value {
    let (case, statics) = (input.case, input.statics());
    let densities =
        |materials: &Materials| -> Vec<f64> { materials.of_groups().iter().map(|m| m.density).collect() };
    json!({
        "steps": case.steps,
        "time_step_s": case.time_step,
        "inner_steps": [input.inner_steps, input.inner_steps / 2],
        "friction": case.friction,
        "gravity_m_per_s2": case.gravity,
        "vertical_force": force(&input.forces[0]),
        "lateral_force": force(&input.forces[1]),
        "suspended_mass_kg": case.suspended_mass,
        "suspension_stiffness_n_per_m": case.vertical_suspension.stiffness,
        "suspension_damping_n_s_per_m": case.vertical_suspension.damping,
        "densities_kg_per_m3": {
            "rail": densities(&statics.rail.materials),
            "wheel": densities(&statics.wheel.materials),
        },
        "damping_s": input.damping,
    })
}

fn force(force: &HarmonicForce) -> Value {
    json!({
        "mean_n": force.constant,
        "amplitude_n": force.amplitude,
        "frequency_hz": force.frequency,
        "phase_rad": force.phase,
    })
}
