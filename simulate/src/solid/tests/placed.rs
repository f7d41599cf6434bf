//! Bodies on soft springs: where they touch once the springs have moved and turned them.

use super::*;
use railspring_calibrate::analytic::hertz::point_contact;
use railspring_calibrate::contact::resultant;
use railspring_profiles::root::bisection;
use std::sync::Arc;

/// Radii of the rail's crown and of the wheel's hollow across the track, and of the wheel, m.
const RADII: [f64; 2] = [0.1, 0.2];
const ROLLING: f64 = 0.46;
/// How far the wheel stands to the side at first, m: the profiles then touch at 0.08 rad.
const ASIDE: f64 = 8e-3;
/// Velocity of the hub to the side and down, m/s, and duration, s.
const VELOCITY: [f64; 2] = [2.0, 1.2];
const DURATION: f64 = 1e-3;

/// Springs between a body and its support: compliances in y and z, m/N, and for a turn about a centre, rad/(N·m).
#[derive(Clone, Copy)]
struct Springs {
    compliance: [f64; 2],
    turning: f64,
    centre: Point2<f64>,
}

/// Of rail and wheel. Under 24 kN both turn by more than half a degree and move by two millimetres to the side.
const SPRINGS: [Springs; 2] = [
    Springs { compliance: [2e-8, 2e-8], turning: 3e-5, centre: Point2::new(0.0, 0.25) },
    Springs { compliance: [2e-8, 2e-8], turning: 1e-5, centre: Point2::new(0.0, -0.25) },
];

impl Springs {
    /// Turn (rad) and displacement (y, z; m) at the place `at` of a rigid body under a `force` (y, z; N) there.
    fn motion(&self, at: &Point2<f64>, force: &Vector2<f64>) -> (f64, Vector2<f64>) {
        let arm = at - self.centre;
        let angle = self.turning * arm.perp(force);
        let moved = Vector2::new(self.compliance[0] * force.x, self.compliance[1] * force.y);
        (angle, moved + angle * Vector2::new(-arm.y, arm.x))
    }

    /// Adds them to the compliance of a body whose contact nodes are at `nodes`.
    fn add_to(&self, body: &mut CondensedBody, nodes: &[Point2<f64>]) {
        // motions of a node under unit displacements and a unit turn
        let rows: Vec<[f64; 3]> = nodes
            .iter()
            .flat_map(|node| {
                let arm = node - self.centre;
                [[0.0; 3], [1.0, 0.0, -arm.y], [0.0, 1.0, arm.x]]
            })
            .collect();
        let springs = [self.compliance[0], self.compliance[1], self.turning];
        let compliance = Arc::make_mut(&mut body.compliance);
        for (c, column) in rows.iter().enumerate() {
            for (r, row) in rows.iter().enumerate() {
                compliance[(r, c)] += (0..3).map(|k| row[k] * springs[k] * column[k]).sum::<f64>();
            }
        }
    }
}

/// A point of a profile at an angle to its middle, and the normal out of the rail there.
fn on_circle(radius: f64, angle: f64) -> Point2<f64> {
    Point2::new(radius * angle.sin(), radius * (1.0 - angle.cos()))
}

fn normal(angle: f64) -> Vector2<f64> {
    Vector2::new(angle.sin(), -angle.cos())
}

/// Angles of the places of rail and wheel, to the middle of their profiles, and that of the normal where they touch, rad.
#[derive(Debug, Clone, Copy)]
struct Touch {
    places: [f64; 2],
    normal: f64,
}

/// Source: rigid bodies on springs. Where two circles that are turned by φ touch, the normal is at the same
/// angle a to the vertical on both, so that the places are at a - φ. The angle φ and the displacements are
/// those of the springs under the force along the normal, whose vertical part is `vertical` (N). Both places
/// are at the same y, but for the `approach` (m) along the normal. `hub` is the displacement of the wheel's
/// hub to the side, with its first place, m.
fn rigid_touch(vertical: f64, hub: f64, approach: f64) -> Touch {
    let side = |angle: f64, force: Vector2<f64>, body: usize| {
        let mut place = angle;
        let mut moved = Vector2::zeros();
        for _ in 0..60 {
            let turn;
            (turn, moved) = SPRINGS[body].motion(&on_circle(RADII[body], place), &force);
            place = angle - turn;
        }
        (place, on_circle(RADII[body], place).x + moved.x)
    };
    let both = |angle: f64| {
        let force = normal(angle) * (-vertical / angle.cos());
        [side(angle, force, 0), side(angle, -force, 1)]
    };
    // with the normal turned to the field side the wheel's place moves there faster than the rail's
    let aside = |angle: f64| {
        let [rail, wheel] = both(angle);
        wheel.1 + hub + approach * normal(angle).x - rail.1
    };
    let angle = bisection(-0.3, 0.3, |angle| !(aside(angle) < 0.0));
    Touch { places: both(angle).map(|(place, _)| place), normal: angle }
}

/// Source: rigid bodies on springs that roll on each other without slip: both places have moved as far along their profiles since the first
/// touch, and the lateral force is what keeps them at the same y. Arguments as of [`rigid_touch`], but for the approach, which is along a
/// normal that hardly turns; `normal` is the direction of the force.
fn rolling_touch(vertical: f64, hub: f64) -> Touch {
    let first = -(ASIDE / (RADII[1] - RADII[0])).asin();
    let under = |lateral: f64| {
        let force = Vector2::new(lateral, vertical);
        let mut places = [first; 2];
        let mut aside = 0.0;
        for _ in 0..60 {
            let motion =
                |body: usize, force| SPRINGS[body].motion(&on_circle(RADII[body], places[body]), &force);
            let [rail, wheel] = [motion(0, force), motion(1, -force)];
            let y = |body: usize| on_circle(RADII[body], places[body]).x;
            aside = y(1) + wheel.1.x + hub - y(0) - rail.1.x;
            let angle = first + (RADII[1] * wheel.0 - RADII[0] * rail.0) / (RADII[1] - RADII[0]);
            places = [angle - rail.0, angle - wheel.0];
        }
        (places, aside)
    };
    // the more the wheel is held back, the less it is aside of the rail
    let lateral = bisection(-2e4, 2e4, |lateral| !(under(lateral).1 > 0.0));
    Touch { places: under(lateral).0, normal: (-lateral / vertical).atan() }
}

/// What a run has found at its end.
#[derive(Debug, Clone, Copy)]
struct Found {
    touch: Touch,
    vertical: f64,
    hub: f64,
    /// Sum of the forces on the nodes of both bodies, over the vertical force.
    unbalanced: f64,
}

impl Found {
    /// Places (rad) and the normal by the forces, beyond those of `other`; `sign` is -1 for a mirror image.
    fn beyond(&self, other: &Touch, sign: f64) -> [f64; 3] {
        let of = |touch: &Touch| [touch.places[0], touch.places[1], touch.normal];
        let (found, other) = (of(&self.touch), of(other));
        [0, 1, 2].map(|i| found[i] - sign * other[i])
    }
}

/// Blocks on springs, with lines of nodes a millimetre apart across the track.
struct Sprung {
    meshes: [HexMesh; 2],
    curves: [ProfileCurve; 2],
    bodies: [CondensedBody; 2],
}

impl Sprung {
    fn new() -> Self {
        let half = 0.03;
        let fine = (-18..=18).map(|n| f64::from(n) * CELL);
        let y = [-half, -0.024].into_iter().chain(fine).chain([0.024, half]).collect();
        let block = BlockOptions { y, ..BlockOptions::graded(half, HEIGHT, 0.012, 0.006, 3e-3, 1.5) };
        let mut rail = mesh_block(&block).unwrap();
        rail.ends = std::mem::take(&mut rail.foot);
        let top = *block.z.last().unwrap();
        // the height only gives the wheel its mass
        let z = block.z.iter().copied().chain([top + 400.0]).collect();
        let mut wheel = upside_down(mesh_block(&BlockOptions { z, ..block }).unwrap());
        wheel.bore = (0..wheel.nodes.len()).filter(|&n| wheel.nodes[n].z < -top + 1e-9).collect();
        wheel.contact.along_track.iter_mut().for_each(|x| *x /= ROLLING);
        let curves = RADII.map(|radius| {
            let angle = |n: i32| half / radius * f64::from(n) / 40.0;
            let points: Vec<_> = (-40..=40).map(|n| on_circle(radius, angle(n))).collect();
            ProfileCurve::from_points(&points, &[]).unwrap()
        });
        let mut bodies = condensed([&rail, &wheel], Material::STEEL, 16);
        let meshes = [rail, wheel];
        for body in 0..2 {
            let surface = Surface::extruded(&curves[body], &meshes[body].contact);
            let columns = surface.grid.along_track.len();
            let at = |node: usize| surface.world(surface.grid.along_profile[node / columns]);
            let nodes: Vec<_> = (0..surface.grid.nodes.len()).map(at).collect();
            SPRINGS[body].add_to(&mut bodies[body], &nodes);
        }
        Self { meshes, curves, bodies }
    }

    /// Where rail and wheel touch when the hub has gone down and aside in `steps`, to the side of `sign`.
    fn pressed_aside(&self, field: ContactField, friction: f64, sign: f64, steps: usize) -> Found {
        let between = RADII[1] - RADII[0];
        let touching = Vector2::new(sign * ASIDE, (between.powi(2) - ASIDE.powi(2)).sqrt() - between - 1e-6);
        let [rail, wheel] = &self.bodies;
        let placed_rail = PlacedRail { curve: self.curves[0].clone(), angle: 0.0, origin: Point2::origin() };
        let model = TransientModel {
            bodies: SolidBodies::Reduced { rail, wheel, modes: ModeCount::Given(16) },
            materials: [Material::STEEL; 2],
            placed_rail: &placed_rail,
            rail_axis: None,
            rail_surface: Surface::extruded(&self.curves[0], &self.meshes[0].contact),
            wheel_surface: Surface::revolved(&self.curves[1], &self.meshes[1].contact, ROLLING, touching),
            enforcement: Enforcement::Exact,
            field,
            path: None,
            axle: 0.0,
        };
        let velocity = Vector2::new(sign * VELOCITY[0], VELOCITY[1]);
        let scenario = Scenario::new(steps, DURATION / steps as f64, friction);
        let mut found = None;
        let mut see = |step: &Step| {
            found = Some(self.found(step, sign));
            Ok(None)
        };
        model.run_from(&velocity, &scenario, &Silent, &mut see).unwrap();
        found.unwrap()
    }

    fn found(&self, step: &Step, sign: f64) -> Found {
        let (points, forces) = (&step.contact.points, &step.contact.solution.forces);
        let force = resultant(points, forces);
        let sum: f64 = forces[..points.len()].iter().sum();
        let mean =
            |value: &dyn Fn(usize) -> f64| (0..points.len()).map(|j| forces[j] * value(j)).sum::<f64>() / sum;
        let rail = (mean(&|j| points[j].position.x) - 0.5 * self.curves[0].length()) / RADII[0];
        let wheel = (mean(&|j| points[j].opposing_position.x) / RADII[1]).asin();
        let on = |axis: usize| -> f64 {
            step.forces.iter().flat_map(|nodal| nodal.iter().skip(axis).step_by(3)).sum()
        };
        Found {
            touch: Touch { places: [rail, wheel], normal: (force.y / -force.z).atan() },
            vertical: -force.z,
            hub: step.hub.position().x + sign * ASIDE,
            unbalanced: (on(1).hypot(on(2)) / force.z).abs(),
        }
    }
}

/// Spacing of the nodes across the track, m.
const CELL: f64 = 1e-3;
const HEIGHT: f64 = 0.03;

/// DISCRETISATION, rad: a hundredth of a cell on the rail, for a patch that is eight of them wide and lies anywhere on the grid.
const DISCRETISATION: f64 = 0.01 * CELL / RADII[0];

/// Source: [`rigid_touch`]. Goal: places on rail and wheel and the direction of the force (rad) of
/// frictionless blocks, on the nodes and on the fine grid. Their springs turn them and move them aside under
/// the load. A mirror image has mirrored places, and half the steps change nothing. Forces on both bodies are
/// in balance. Paired where the hub is, the bodies touched 23 mrad from there on the rail (2.3 mm) and 5 on
/// the wheel (1.1 mm), and the force was off by 17 mrad. Accuracy: DISCRETISATION, twice that between two
/// runs, and ROUNDOFF between nodes that are mirror images; MODEL, each block turns by itself as well, 150
/// N·m over E·I/h = 7.6e6 N·m.
#[test]
fn bodies_on_springs_touch_where_the_springs_take_them() {
    const MODEL: f64 = 2.0 * 2e-5;
    const ROUNDOFF: f64 = 1e-8;
    let blocks = Sprung::new();
    let radius = 1.0 / (1.0 / RADII[0] - 1.0 / RADII[1]);
    for (field, mirrored) in
        [(ContactField::Hybrid, 2.0 * DISCRETISATION), (ContactField::Elements, ROUNDOFF)]
    {
        let of = |sign, steps| blocks.pressed_aside(field, 0.0, sign, steps);
        let found = of(1.0, 5);
        let hertz =
            point_contact(found.vertical, ROLLING, radius, Material::STEEL.contact_modulus(&Material::STEEL))
                .unwrap();
        let exact = rigid_touch(found.vertical, found.hub, hertz.approach);
        let off = largest(found.beyond(&exact, 1.0).into_iter().map(f64::abs));
        assert!(off < DISCRETISATION + MODEL, "{field:?}: {found:?} {exact:?}");
        assert!(found.unbalanced < ROUNDOFF, "{field:?}: {found:?}");
        let mirror = largest(of(-1.0, 5).beyond(&found.touch, -1.0).into_iter().map(f64::abs));
        assert!(mirror < mirrored, "{field:?}: {mirror:e}");
        let halved = largest(of(1.0, 10).beyond(&found.touch, 1.0).into_iter().map(f64::abs));
        assert!(halved < 2.0 * DISCRETISATION, "{field:?}: {halved:e}");
    }
}

/// Source: [`rolling_touch`]. Goal: places and the direction of the force (rad) where friction holds the same
/// blocks together while the places wander over the profiles by a millimetre. Pairing anew makes no slip: a
/// micrometre of it changes the lateral force by 0.4 N. Accuracy: DISCRETISATION, and MODEL as without
/// friction.
#[test]
fn bodies_that_stick_roll_on_each_other() {
    const MODEL: f64 = 2.0 * 2e-5;
    let found = Sprung::new().pressed_aside(ContactField::Hybrid, 0.5, 1.0, 10);
    let exact = rolling_touch(found.vertical, found.hub);
    let off = found.beyond(&exact, 1.0);
    assert!(off.iter().all(|off| off.abs() < DISCRETISATION + MODEL), "{off:?}: {found:?} {exact:?}");
}
