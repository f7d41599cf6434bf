//! A reduced body beside the rules of a linear part and beside the body at full order.

use super::super::full::FullBody;
use super::*;
use crate::time::linear_part::conformance::Trial;
use crate::time::newmark::Newmark;
use nalgebra::Point3;
use railspring_calibrate::mesh::{BlockOptions, HexMesh, mesh_block};
use railspring_calibrate::solid::{Formulation, Material, Supports, System};
use railspring_calibrate::superelement::{CondensedBody, Superelement};

const MASTER: Point3<f64> = Point3::new(0.0, 0.0, 0.05);

fn block() -> HexMesh {
    mesh_block(&BlockOptions::uniform([0.02, 0.02, 0.04], [2, 2, 4])).unwrap()
}

/// The block with its foot held, or following a hub that is held.
fn condensed(mesh: &HexMesh, follows: bool, modes: usize) -> CondensedBody {
    let supports = match follows {
        false => Supports { held: mesh.foot.clone(), ..Default::default() },
        true => Supports { followers: mesh.foot.clone(), master: MASTER, ..Default::default() },
    };
    let system = System::new(mesh, Material::STEEL, Formulation::IncompatibleModes, &supports).unwrap();
    let element = Superelement::new(system).unwrap();
    let modes = Some(element.modes(modes).unwrap());
    CondensedBody { modes, ..element.condensed("block".into()) }
}

/// Free motions of a hub: none, those of a run without rotations, and all of a run with them.
const HUBS: [&[usize]; 3] = [&[], &[1, 2], &[1, 2, 3, 4, 5]];

/// Goal: a reduced body obeys the rules of a linear part: held, and following its hub; with and without modes, damping and
/// dissipation. Without the last two its energy (J) is the work of the forces. Accuracy: ROUNDOFF of sums of a hundred terms
/// in 40 steps, relative to what is left of them after the static flexibility of the modes is taken off, 100·40·1e-16·10.
#[test]
fn a_reduced_body_is_a_linear_part() {
    const ROUNDOFF: f64 = 4e-12;
    let mesh = block();
    for (hub, count) in [(HUBS[0], 12), (HUBS[1], 12), (HUBS[2], 12), (HUBS[1], 0)] {
        let condensed = condensed(&mesh, !hub.is_empty(), count);
        for (damping, dissipation) in [(0.0, 0.0), (1e-6, 0.0), (0.0, 0.05)] {
            let scheme = Newmark::new(2e-6, dissipation);
            let body = ReducedBody::new(
                &condensed,
                count,
                damping,
                &scheme,
                HubSprings { free: hub, vertical: 0.0, axle: 1e6 },
                None,
            )
            .unwrap();
            assert_eq!(body.modes(), count);
            let load = |y, z, gravity| BodyLoad { hub: [y, z], gravity, ..BodyLoad::default() };
            let trial = Trial {
                part: &body,
                rest: body.in_motion(&Vector2::zeros(), &Vector2::zeros()),
                loads: [load(300.0, -700.0, 5e4), load(100.0, 200.0, -9e4), load(400.0, -500.0, -4e4)],
                force: 1e3,
                displacement: &|state| {
                    let hub = state.coordinates[..hub.len()].iter().map(|m| m.u);
                    state.contact.iter().copied().chain(hub).collect()
                },
                numbers: &|state| {
                    let of = |motions: &[Motion], value: fn(&Motion) -> f64| -> Vec<f64> {
                        motions.iter().map(value).collect()
                    };
                    let ReducedState { coordinates, residual, contact, contact_step, forces, .. } = state;
                    let motions = [&coordinates[hub.len()..], residual].into_iter();
                    motions
                        .flat_map(|m| [of(m, |m| m.u), of(m, |m| m.v), of(m, |m| m.a)])
                        .chain(
                            coordinates[..hub.len()].iter().flat_map(|m| [vec![m.u], vec![m.v], vec![m.a]]),
                        )
                        .chain([contact.clone(), contact_step.clone(), forces.clone()])
                        .collect()
                },
            };
            let found = trial.deviations();
            assert!(found.largest() < ROUNDOFF, "{hub:?} {count} {damping} {dissipation}: {found:?}");
            if damping == 0.0 && dissipation == 0.0 {
                let energy = |state: &ReducedState| body.sums(state).energy;
                let defect = trial.energy_defect(&BodyLoad::default(), &energy);
                assert!(defect < ROUNDOFF, "{hub:?} {count}: {defect:e}");
            }
        }
    }
}

/// Source: the body at full order, whose step is solved with all equations. Goal: displacements of contact
/// nodes and hub (m) come to it with the modes. They are of 40 steps, six to a period of the block along its
/// axis, under forces on hub and contact. Without any modes the inertia of what is held is missing. With all
/// modes it is the same. Accuracy: MODES. A uniform load is not among the loads of the modes. With 8 and with
/// 24 of them it leaves a difference, in the open middle between the measured 4 % and 0.8 % and the next
/// power of ten. With all of them: ROUNDOFF, 40 steps of a matrix of the condition 1e5.
#[test]
fn modes_bring_a_body_to_full_order() {
    const MODES: [f64; 2] = [0.1, 0.02];
    const ROUNDOFF: f64 = 1e-10;
    let mesh = block();
    for hub in HUBS {
        let mut master_free = [false; 6];
        hub.iter().for_each(|&motion| master_free[motion] = true);
        let supports = match hub.is_empty() {
            true => Supports { held: mesh.foot.clone(), ..Default::default() },
            false => Supports { followers: mesh.foot.clone(), master: MASTER, master_free, held: Vec::new() },
        };
        let material = Material { damping: 1e-7, ..Material::STEEL };
        let system = System::new(&mesh, material, Formulation::IncompatibleModes, &supports).unwrap();
        let scheme = Newmark::new(4e-6, 0.0);
        let full = FullBody::new(
            system.with_massless_contact(),
            &scheme,
            HubSprings { free: hub, vertical: 1e7, axle: 1e6 },
        )
        .unwrap();
        let contact = 3 * mesh.contact.nodes.len();
        let forces: Vec<f64> = (0..contact + hub.len())
            .map(|i| if i < contact { [0.0, -40.0, 100.0][i % 3] } else { 0.0 })
            .collect();
        let load = BodyLoad { hub: [50.0, -300.0], gravity: 1e3, ..BodyLoad::default() };
        let errors = [0, 8, 24, 500].map(|count| {
            let condensed = condensed(&mesh, !hub.is_empty(), count);
            let reduced = ReducedBody::new(
                &condensed,
                count,
                material.damping,
                &scheme,
                HubSprings { free: hub, vertical: 1e7, axle: 1e6 },
                None,
            )
            .unwrap();
            let start = (Vector2::new(0.1, -0.2), Vector2::new(3.0, 50.0));
            let start = if hub.is_empty() { Default::default() } else { start };
            let (mut a, mut b) = (full.in_motion(&start.0, &start.1), reduced.in_motion(&start.0, &start.1));
            let mut worst: f64 = 0.0;
            for _ in 0..40 {
                (a, b) = (full.advance(&a, &load, &forces), reduced.advance(&b, &load, &forces));
                let (moved, expected) = (reduced.contact_displacement(&b), full.contact_displacement(&a));
                let most = expected.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
                let off = moved.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                worst = worst.max(off / most).max((reduced.hub(&b) - full.hub(&a)).norm() / most);
            }
            worst
        });
        assert!(errors[0] > 0.1, "{hub:?} {errors:?}");
        assert!(errors[1] < MODES[0] && errors[2] < MODES[1], "{hub:?} {errors:?}");
        assert!(errors[3] < ROUNDOFF, "{hub:?} {errors:?}");
    }
}

/// Goal: a body that was condensed for statics is refused in words.
#[test]
fn a_body_without_modes_is_refused() {
    let body = CondensedBody { modes: None, ..condensed(&block(), false, 1) };
    let scheme = Newmark::new(1e-6, 0.0);
    let refused =
        ReducedBody::new(&body, 8, 0.0, &scheme, HubSprings::default(), None).map(|_| ()).unwrap_err();
    assert!(refused.to_string().contains("no modes"), "{refused}");
}
