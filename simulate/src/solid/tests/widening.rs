//! A fine grid on meshes with smaller cells: a ring of its points around a patch takes many lines of the mesh.

use super::*;

/// Radius of the rail's crown, and that of the wheel, m.
const RADIUS: f64 = 0.01;
/// Half widths of the blocks across (on the arc) and along the track and their height, m. A line of the grid runs along the crest, as one does across
/// the blocks in the middle of their length.
const HALF: [f64; 2] = [1.3e-3, 4e-3];
const HEIGHT: f64 = 2e-3;
/// What the wheel comes down by in a step, from just touching, m, and the time, s.
const STROKE: f64 = 39e-6;
const STEP: f64 = 1e-5;

/// Force (N) of a heavy wheel at the end of a step in which it strikes a rail, on meshes with lines at `ahead` and as far behind (m).
fn struck(ahead: &[f64]) -> f64 {
    let behind = ahead.iter().rev().map(|x| -x);
    let x = behind.chain([0.0]).chain(ahead.iter().copied()).collect();
    let y = (-4..=4).map(|k| HALF[0] * f64::from(k) / 4.0).collect();
    let z: Vec<f64> = (0..=4).map(|k| HEIGHT * f64::from(k) / 4.0).collect();
    let block = BlockOptions { x, y, z: z.clone() };
    let mut rail = mesh_block(&block).unwrap();
    rail.ends = std::mem::take(&mut rail.foot);
    // the height only gives the wheel its mass
    let z = z.into_iter().chain([HEIGHT + 400.0]).collect();
    let mut wheel = upside_down(mesh_block(&BlockOptions { z, ..block }).unwrap());
    wheel.bore = (0..wheel.nodes.len()).filter(|&n| wheel.nodes[n].z < -HEIGHT + 1e-9).collect();
    wheel.contact.along_track.iter_mut().for_each(|x| *x /= RADIUS);
    let arc = |n: i32| HALF[0] * f64::from(n) / 40.0;
    let crown = (-40..=40)
        .map(|n| arc(n) / RADIUS)
        .map(|a| Point2::new(RADIUS * a.sin(), RADIUS * (1.0 - a.cos())))
        .collect();
    let straight = (-40..=40).map(|n| Point2::new(arc(n), 0.0)).collect();
    let curves = [crown, straight].map(|points: Vec<_>| ProfileCurve::from_points(&points, &[]).unwrap());
    let placed_rail = PlacedRail { curve: curves[0].clone(), angle: 0.0, origin: Point2::origin() };
    let mut force = 0.0;
    of_order(Order::Reduced(16), [&rail, &wheel], Material::STEEL, &mut |bodies| {
        let model = TransientModel {
            bodies,
            materials: [Material::STEEL; 2],
            placed_rail: &placed_rail,
            rail_axis: None,
            rail_surface: Surface::extruded(&curves[0], &rail.contact),
            wheel_surface: Surface::revolved(&curves[1], &wheel.contact, RADIUS, Vector2::zeros()),
            enforcement: Enforcement::Exact,
            field: ContactField::Hybrid,
            path: None,
            axle: 0.0,
        };
        let velocity = Vector2::new(0.0, STROKE / STEP);
        let run = model.run_from(&velocity, &quiet(1, STEP), &Silent, &mut |_| Ok(None)).unwrap();
        force = run.history.rows[1].vertical_force;
    });
    force
}

/// Goal: the contact force (N) of a wheel that strikes a crown, both of 10 mm radius, does not depend on
/// lines of the mesh around the rim of the overlap without contact forces. One mesh has lines every 0.005 mm
/// there, the other every 0.25 mm. That rim lies √(2·R·44 µm) = 0.94 mm ahead of the middle, and the patch
/// ends at 0.6 mm. The points of the grid there, at its smallest cells of 0.5 mm, have their neighbours at 1
/// mm. That is a line of the coarse mesh further and thirteen of the fine one. Widening by one line at a time
/// would end after six. Accuracy: DISCRETISATION of the bodies beyond their half-spaces, 2 %.
#[test]
fn a_grid_is_widened_over_many_lines_of_the_mesh() {
    const DISCRETISATION: f64 = 0.02;
    let far = [1.5e-3, 2e-3, 3e-3, HALF[1]];
    let rim = (0..=40).map(|k| 0.9e-3 + 0.005e-3 * f64::from(k));
    let fine = (1..=8).map(|k| 0.1e-3 * f64::from(k)).chain(rim);
    let coarse = (1..=5).map(|k| 0.25e-3 * f64::from(k));
    let fine = struck(&fine.chain(far).collect::<Vec<_>>());
    let coarse = struck(&coarse.chain(far).collect::<Vec<_>>());
    println!("{fine} {coarse}");
    assert!(coarse > 0.0 && (fine / coarse - 1.0).abs() < DISCRETISATION, "{fine} {coarse}");
}
