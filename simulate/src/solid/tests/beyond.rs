//! A wheel that comes down where its body or the rail's is not meshed for contact: crowned blocks, whose crest lies beside the mesh.

use super::super::beyond::Beyond;
use super::super::last_contact::{LastContact, Settled};
use super::super::run::{HubMotion, Reached};
use super::*;
use crate::time::history::{Ending, SurfaceEnd};
use railspring_calibrate::calibration::Places;

/// Radii of the rail's crown and of the wheel, m.
const CROWN: f64 = 0.3;
const ROLLING: f64 = 0.46;
/// Half widths of the profiles and of the meshes, m.
const PROFILE: f64 = 0.05;
const MESH: f64 = 0.015;

/// The profiles of rail (crowned) and wheel (straight), and the blocks below and above them.
struct Blocks {
    curves: [ProfileCurve; 2],
    meshes: [HexMesh; 2],
    /// How far the wheel is above the crest, m.
    gap: f64,
}

impl Blocks {
    /// With the middle of the meshes of rail and wheel beside the crest by `aside` (m).
    fn new(aside: [f64; 2], gap: f64) -> Self {
        let block = BlockOptions::graded(MESH, 0.02, MESH, 0.005, 2.5e-3, 2.0);
        let mut meshes = [mesh_block(&block).unwrap(), upside_down(mesh_block(&block).unwrap())];
        let [rail, wheel] = &mut meshes;
        rail.ends = std::mem::take(&mut rail.foot);
        wheel.contact.along_track.iter_mut().for_each(|x| *x /= ROLLING);
        let arc = |n: i32| PROFILE * f64::from(n) / 100.0;
        let crown = |y: f64| CROWN - (CROWN * CROWN - y * y).sqrt();
        let points = |height: &dyn Fn(f64) -> f64| -> Vec<_> {
            (-100..=100).map(|n| Point2::new(arc(n), height(arc(n)))).collect()
        };
        let curves =
            [points(&crown), points(&|_| 0.0)].map(|points| ProfileCurve::from_points(&points, &[]).unwrap());
        for ((mesh, curve), aside) in meshes.iter_mut().zip(&curves).zip(aside) {
            let middle = curve.s_at_y(aside).unwrap();
            mesh.contact.along_profile.iter_mut().for_each(|s| *s += middle - MESH);
        }
        Self { curves, meshes, gap }
    }

    fn with_model(&self, run: &mut dyn FnMut(&TransientModel<'_>)) {
        let placed_rail = PlacedRail { curve: self.curves[0].clone(), angle: 0.0, origin: Point2::origin() };
        let [rail, wheel] = self.meshes.each_ref();
        let origin = Vector2::new(0.0, -self.gap);
        of_order(Order::Full, [rail, wheel], steel(0.0), &mut |bodies| {
            run(&TransientModel {
                bodies,
                materials: [steel(0.0); 2],
                placed_rail: &placed_rail,
                rail_axis: None,
                rail_surface: Surface::extruded(&self.curves[0], &rail.contact),
                wheel_surface: Surface::revolved(&self.curves[1], &wheel.contact, ROLLING, origin),
                enforcement: Enforcement::Exact,
                field: ContactField::Hybrid,
                path: None,
                axle: 0.0,
            });
        });
    }

    /// How a wheel's fall of `steps` steps of `dt` (s) ends, and whether it has touched before.
    fn fall(&self, steps: usize, dt: f64) -> (Ending, bool) {
        let mut found = None;
        self.with_model(&mut |model| {
            let scenario = quiet(steps, dt);
            let mut beyond = Beyond::new(model, &scenario);
            let run = model
                .run_from(&Vector2::new(0.0, SPEED), &scenario, &Silent, &mut |step| Ok(beyond.reached(step)))
                .unwrap();
            found = Some((run.history.ending, run.history.rows.iter().any(|row| !row.contacts.is_empty())));
        });
        found.unwrap()
    }
}

/// Goal: a wheel falls from 50 µm with 1 m/s on a crest. Where the crest lies beside the mesh of the rail,
/// beside that of the wheel or beside both, the run ends in the step of 20 µs in which it comes down, 60 µs
/// after the start. The ending has the place of the crest on the rail, m. Where both meshes hold the crest it
/// touches, and the run goes on. Accuracy of the place: half the distance of the places at which the gap is
/// looked at.
#[test]
fn a_wheel_that_comes_down_beside_the_mesh_ends_its_run() {
    const SPACING: f64 = 0.5e-3;
    let (dt, gap) = (20e-6, 50e-6);
    for aside in [[0.02, 0.0], [0.0, -0.02], [0.03, 0.02], [-0.02, -0.02]] {
        let (ending, touched) = Blocks::new(aside, gap).fall(10, dt);
        let Ending::EndOfSurface { time, end, rail } = ending else { panic!("{aside:?}: {ending:?}") };
        assert!(end == SurfaceEnd::ContactZone && !touched, "{aside:?}: {ending:?}");
        assert!((time - 3.0 * dt).abs() < 1e-12, "{aside:?}: {time}");
        assert!(rail.x.abs() <= 0.5 * SPACING, "{aside:?}: {rail}");
    }
    let (ending, touched) = Blocks::new([5e-3, -5e-3], gap).fall(10, dt);
    assert!(ending == Ending::Completed && touched, "{ending:?}");
}

/// Source: a circle over a plane, turned by θ about its lowest point: its least gap lies R·θ before or behind that, R·θ²/2 deeper. Goal: a wheel that is
/// turned about y touches beyond the window along the track where that place lies there, and from the depth (m) on at which it does;
/// turned less it touches within, where the contact is found. What is held does not turn. Accuracy: ROUNDOFF of the search on profiles, 1e-9 m; the
/// crown between the places that are looked at is a parabola to 1e-9 m.
#[test]
fn a_turned_wheel_comes_down_beyond_the_window() {
    const ROUNDOFF: f64 = 2e-9;
    let blocks = Blocks::new([0.0; 2], 50e-6);
    blocks.with_model(&mut |model| {
        let at = |angle: f64, depth: f64, rotations_held: bool| -> Option<Reached> {
            let scenario = Scenario { rotations_held, ..quiet(1, 1e-5) };
            let hub = HubMotion::at_start(&scenario, &Vector2::zeros(), 1.0);
            let places = Places::of_hub(&hub.position());
            let settled = Settled::new(&places, &places, &hub.position(), 1e-5, None);
            let contact = LastContact { settled: Some(settled), ..LastContact::default() };
            let wheel = &model.wheel_surface;
            let columns = wheel.grid.along_track.len();
            let moved: Vec<f64> = (0..wheel.grid.nodes.len())
                .flat_map(|node| {
                    let x = wheel
                        .x(wheel.grid.along_profile[node / columns], wheel.grid.along_track[node % columns]);
                    [0.0, 0.0, depth - angle * x]
                })
                .collect();
            let still = vec![0.0; 3 * model.rail_surface.grid.nodes.len()];
            Beyond::new(model, &scenario).reached(&Step {
                displacements: [&still, &moved],
                contact: &contact,
                forces: &[Vec::new(), Vec::new()],
                hub: &hub,
                length: 1e-5,
                sums: [super::super::body::Sums { momentum: 0.0, moment: 0.0, energy: 0.0 }; 2],
            })
        };
        // the window ends 15 mm from its middle
        for (ahead, beyond) in [(0.016, true), (-0.016, true), (0.014, false), (-0.014, false)] {
            let angle = ahead / ROLLING;
            let touch = blocks.gap - 0.5 * ROLLING * angle * angle;
            let deep = at(angle, touch + ROUNDOFF, false);
            assert_eq!(
                deep.map(|reached| reached.end),
                beyond.then_some(SurfaceEnd::ContactWindow),
                "{ahead}"
            );
            assert!(at(angle, touch - ROUNDOFF, false).is_none(), "{ahead}");
            assert!(at(angle, touch + ROUNDOFF, true).is_none(), "{ahead}");
        }
    });
}
