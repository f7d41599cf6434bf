//! The contact solver on small hard problems: every answer is checked against the conditions of Signorini and
//! Coulomb themselves, which do not depend on how it was found.

use faer::Mat;
use nalgebra::{Matrix2, Unit, Vector2, Vector3};
use railspring_calibrate::contact::{
    ComplianceOperator, ContactPoint, FreeDirection, HalfSpace, NearField, PointMode, Problem, Solution,
    flat_grid, gaps, hub_response, solve, total,
};
use railspring_calibrate::solid::Material;
use railspring_profiles::error::{Error, StopReason};

/// SOLVER: the iteration ends at 1e-10 of the largest force; a hundred times that for sums over points.
const SOLVER: f64 = 1e-8;

/// Largest violation of the conditions of contact, relative to the largest force or to its displacement. The
/// conditions are no tension, no overlap, no force across a gap and friction inside its cone. No point slips
/// inside the cone, and on the cone slip is against the force. The hub has the wanted forces.
fn violation(problem: &Problem, solution: &Solution) -> f64 {
    let n = problem.points.len();
    let f = &solution.forces;
    let size =
        f.iter().chain(problem.hub.iter().map(|h| &h.force)).fold(f64::MIN_POSITIVE, |m, f| m.max(f.abs()));
    let stiffness = |row: usize| 1.0 / problem.compliance.diagonal(row);
    let mut elastic = vec![0.0; f.len()];
    problem.compliance.add_product(f, &mut elastic);
    let mut worst = 0.0_f64;
    for row in 0..f.len() {
        let (j, d) = (row % n, row / n);
        let direction: Vector3<f64> = problem.points[j].direction(d);
        let hub: f64 = problem.hub.iter().zip(&solution.hub).map(|(h, u)| direction.dot(&h.along) * u).sum();
        let separation = problem.free[row] + elastic[row] + hub;
        worst = worst.max((separation - solution.separation[row]).abs() * stiffness(row));
    }
    for j in 0..n {
        let (p, gap) = (f[j], solution.separation[j] * stiffness(j));
        worst = worst.max(-p).max(-gap).max(p.min(gap));
        if f.len() == 3 * n {
            let tangential = Vector2::new(f[n + j], f[2 * n + j]);
            let slip = Vector2::new(solution.separation[n + j], solution.separation[2 * n + j])
                * stiffness(n + j).min(stiffness(2 * n + j));
            let inside = problem.friction * p - tangential.norm();
            worst = worst.max(-inside);
            if p > 0.0 {
                // slip with force to spare, and slip that is not straight against the force
                worst = worst.max(inside.min(slip.norm()));
                if tangential.norm() > 0.0 && problem.friction > 0.0 {
                    let along = tangential.normalize();
                    let across = (slip - along * slip.dot(&along)).norm();
                    // the force that turning the slip into its direction would take
                    let cone = problem.friction * p;
                    worst = worst.max(across * cone / (cone + slip.norm())).max(slip.dot(&along));
                }
            }
        }
    }
    for free in problem.hub {
        let weight = |row: usize| problem.points[row % n].direction(row / n).dot(&free.along);
        let carried: f64 = (0..f.len()).map(|row| weight(row) * f[row]).sum();
        worst = worst.max((carried - free.force).abs());
    }
    worst / size
}

fn along_y(force: f64) -> FreeDirection {
    FreeDirection { along: Vector3::y_axis(), force }
}

fn along_z(force: f64) -> FreeDirection {
    FreeDirection { along: Vector3::z_axis(), force }
}

/// Goal: two points of a rim that is ten times more flexible sideways than downwards, pressed with 1 kN at the friction
/// 0.05: the points stick. A Newton iteration in full steps makes both alternate between slipping one way and
/// the other, the hub free. Units SI; the numbers are those of a coarse wheel on a coarse rail. Accuracy: SOLVER.
#[test]
fn points_between_two_directions_of_slip_stick() {
    let mut points = flat_grid((2, 1), 3e-3, |_, _| 0.0);
    for (point, y) in points.iter_mut().zip([-0.029_961, -0.020_142_f64]) {
        point.normal = Vector2::new(y, -(1.0 - y * y).sqrt());
    }
    let (local, common) = ([2.243e-9, 3.211e-8, 2.920e-9], [1.451e-9, 3.1285e-8, 1.973e-9]);
    let mut compliance = Mat::from_fn(6, 6, |r, c| match (r / 2 == c / 2, r == c) {
        (true, true) => local[r / 2],
        (true, false) => common[r / 2],
        _ => 0.0,
    });
    // what presses the rim down also moves it sideways
    for (r, c, coupling) in [(0, 2, -2.4e-11), (0, 3, -3.7e-11), (1, 2, -1.16e-10), (1, 3, -1.29e-10)] {
        compliance[(r, c)] = coupling;
        compliance[(c, r)] = coupling;
    }
    // gaps and slips with the hub where full steps make it oscillate, and forces that belong to it
    let lowered = 4.2775e-6;
    let mut free = vec![2.3834e-6, 2.4853e-6, 0.0, 0.0, 0.0, 0.0];
    for row in 0..6 {
        free[row] += lowered * points[row % 2].direction(row / 2).z;
    }
    let start = [559.0, 440.0, 27.95, 22.0, 0.0, 0.0];
    let hub = [along_z(-1e3)];
    let problem =
        Problem { points: &points, compliance: &compliance, free: &free, friction: 0.05, hub: &hub };
    let solution = solve(&problem, &start).unwrap();
    assert!(violation(&problem, &solution) < SOLVER, "{:e}", violation(&problem, &solution));
    assert_eq!(solution.modes, [PointMode::Stick; 2]);
}

/// Two half-spaces of steel in all three directions.
fn half_spaces(points: &[ContactPoint]) -> Mat<f64> {
    let [lower, upper] = HalfSpace::both(&Material::STEEL);
    total(&[&lower, &upper], points, 3)
}

/// The motion of the hub and the stuck area of one step of [`drawn`].
struct Drawn {
    /// Over the motion at which all slides.
    motion: f64,
    /// Radius of the circle with the area of the points that stick, over that of the patch.
    stick: f64,
}

/// Draws a sphere on two half-spaces, pressed by P, along `axis` with the parts `steps` of µP in turn; `cells` of the
/// grid to the radius of the patch.
fn drawn(poisson: f64, axis: Unit<Vector3<f64>>, cells: f64, steps: &[f64]) -> Vec<Drawn> {
    let (radius, load, friction) = (0.3_f64, 85e3, 0.5);
    let material = Material { poisson, ..Material::STEEL };
    let patch = (0.75 * load * radius / material.contact_modulus(&material)).cbrt();
    let h = patch / cells;
    let count = 2 * (1.2 * cells) as usize + 1;
    let points = flat_grid((count, count), h, |s, x| (s * s + x * x + h * h / 3.0) / (2.0 * radius));
    let n = points.len();
    let compliance = NearField::new(&HalfSpace::both(&material), &points, 3);
    // stiffness of the stuck patch (R.D. Mindlin 1949), of both bodies in series
    let sticking = 4.0 * patch * material.shear_modulus() / (2.0 - poisson);
    let full = 1.5 * friction * load / sticking;
    let mut free = gaps(&points);
    free.resize(3 * n, 0.0);
    let mut forces = vec![0.0; 3 * n];
    let mut moved = 0.0;
    let mut found = Vec::new();
    for part in steps {
        let across = FreeDirection { along: axis, force: part * friction * load };
        let hub = [along_z(-load), across];
        let problem = Problem { points: &points, compliance: &compliance, free: &free, friction, hub: &hub };
        let solution = solve(&problem, &forces).unwrap();
        let sum: f64 = solution.forces[..n].iter().sum();
        assert!((sum / load - 1.0).abs() < SOLVER);
        // the hub moves against the force that it is to feel
        moved -= solution.hub[1];
        let stuck = solution.modes.iter().filter(|mode| **mode == PointMode::Stick).count() as f64;
        let stick = (stuck * h * h / std::f64::consts::PI).sqrt() / patch;
        found.push(Drawn { motion: moved / full, stick });
        forces = solution.forces;
        // the slip of the next step starts from the elastic displacement of this one
        let mut elastic = vec![0.0; 3 * n];
        compliance.add_product(&forces, &mut elastic);
        (n..3 * n).for_each(|row| free[row] = -elastic[row]);
    }
    found
}

/// Source: Cattaneo and Mindlin (K.L. Johnson, Contact Mechanics, 1985, sections 7.2 and 7.4). A sphere under
/// the normal force P and the tangential force Q moves tangentially by δ·(1 − (1 − Q/μP)^⅔). On the way back
/// from Q₁ it moves by δ₁ − 2·δ·(1 − (1 − (Q₁ − Q)/2μP)^⅔), with δ = 3μP/2 over the stiffness of sticking.
/// The stuck circle has the radius (1 − Q/μP)^⅓ of the patch, and (1 − (Q₁ − Q)/2μP)^⅓ on the way back. Goal:
/// loading, unloading and reversal, laterally and along the track, with ten cells to the radius. Accuracy
/// over δ: DISCRETISATION 0.5 %, and one cell of the stick radius. The source lets all slip be along the
/// force, which is exact for ν = 0 and holds within 0.1 % for steel.
#[test]
fn cattaneo_and_mindlin_forwards_and_back_with_the_hub_free() {
    const DISCRETISATION: f64 = 0.005;
    const LARGEST: f64 = 0.9;
    const CELLS: f64 = 10.0;
    let steps = [0.3, 0.6, LARGEST, 0.5, 0.0, -0.5, -0.85];
    let slipped = |part: f64| 1.0 - (1.0 - part).powf(2.0 / 3.0);
    for (poisson, axis) in [(0.0, Vector3::y_axis()), (0.0, Vector3::x_axis()), (0.3, Vector3::y_axis())] {
        let mut back = false;
        for (part, found) in steps.iter().zip(drawn(poisson, axis, CELLS, &steps)) {
            let half = 0.5 * (LARGEST - part);
            let (exact, stick) = if back {
                (slipped(LARGEST) - 2.0 * slipped(half), (1.0 - half).cbrt())
            } else {
                (slipped(*part), (1.0 - part).cbrt())
            };
            println!(
                "ν {poisson} Q/µP {part}: {:.4} of full, exact {exact:.4}; stick radius {:.3}, exact {stick:.3}",
                found.motion, found.stick
            );
            assert!((found.motion - exact).abs() < DISCRETISATION, "{part}: {} {exact}", found.motion);
            assert!((found.stick - stick).abs() < 1.0 / CELLS, "{part}: {} {stick}", found.stick);
            back |= *part == LARGEST;
        }
    }
}

/// Source: the laws of contact do not depend on the axes. A sphere on half-spaces is pressed along the normal
/// and drawn across it, with the hub free in both directions. Goal: it answers the same when surface and
/// forces are turned together by 40°. Compared are forces (over the largest), hub motions (over the largest)
/// and the tangent stiffness along these directions. Along y and z the tangent is the same tensor in other
/// axes. Accuracy: SOLVER.
#[test]
fn a_load_may_have_any_direction() {
    let (radius, load, friction) = (0.3, 50e3, 0.3);
    let answer = |angle: f64| {
        let (sin, cos) = angle.sin_cos();
        let mut points = flat_grid((9, 9), 1e-3, |s, x| (s * s + x * x) / (2.0 * radius));
        points.iter_mut().for_each(|point| point.normal = Vector2::new(-sin, -cos));
        let compliance = half_spaces(&points);
        let mut free = gaps(&points);
        free.resize(3 * points.len(), 0.0);
        let directions = [Vector3::new(0.0, sin, cos), Vector3::new(0.0, cos, -sin)].map(Unit::new_normalize);
        let hub = [
            FreeDirection { along: directions[0], force: -load },
            FreeDirection { along: directions[1], force: 0.5 * friction * load },
        ];
        let problem = Problem { points: &points, compliance: &compliance, free: &free, friction, hub: &hub };
        let solution = solve(&problem, &vec![0.0; free.len()]).unwrap();
        assert!(violation(&problem, &solution) < SOLVER, "{:e}", violation(&problem, &solution));
        let stiffness = |directions: &[Unit<Vector3<f64>>]| -> Matrix2<f64> {
            let response = hub_response(&problem, &solution, directions, false).unwrap();
            response.stiffness.fixed_view::<2, 2>(0, 0).into()
        };
        let (turned, world) = (stiffness(&directions), stiffness(&[Vector3::z_axis(), Vector3::y_axis()]));
        (solution, turned, world)
    };
    let angle = 40_f64.to_radians();
    let (level, local, _) = answer(0.0);
    let (turned, turned_local, turned_world) = answer(angle);
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    for (a, b) in [(&level.forces, &turned.forces), (&level.hub, &turned.hub)] {
        let difference: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        assert!(largest(&difference) < SOLVER * largest(a), "{:e} {:e}", largest(&difference), largest(a));
    }
    assert!((local - turned_local).norm() < SOLVER * local.norm(), "{local} {turned_local}");
    // z and y by the turned directions
    let (sin, cos) = angle.sin_cos();
    let turn = Matrix2::new(cos, sin, -sin, cos);
    let expected = turn.transpose() * local * turn;
    assert!((turned_world - expected).norm() < SOLVER * local.norm(), "{turned_world} {expected}");
}

/// Numbers in 0..1 that are the same in every run (D.E. Knuth, The Art of Computer Programming 2, section 3.3.4).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

/// Goal: each of 600 problems has a solution that satisfies the conditions. They have one to twelve points on
/// faces of any slope between -70° and 70°. Their compliances are full and positive definite and couple all
/// directions. Friction is from 0.05 to 0.6, and slips point anywhere. The hub is held in a third of them,
/// free downwards in a third, and free in both directions in a third, under a force inside the friction cone
/// of the face. Accuracy: SOLVER.
#[test]
fn hard_problems_of_few_points_end_with_their_conditions_satisfied() {
    let mut numbers = Numbers(7);
    for case in 0..600 {
        let n = 1 + case % 12;
        let mut points = flat_grid((n, 1), 1e-3, |_, _| 0.0);
        let friction = numbers.between(0.05, 0.6);
        let slope = numbers.between(-1.2, 1.2);
        for point in &mut points {
            let angle: f64 = slope + numbers.between(-0.4, 0.4) * friction;
            point.normal = Vector2::new(-angle.sin(), -angle.cos());
        }
        // A·Aᵀ couples everything; the diagonal is the point alone
        let a = Mat::<f64>::from_fn(3 * n, 3 * n, |_, _| numbers.between(-1.0, 1.0));
        let compliance = Mat::from_fn(3 * n, 3 * n, |r, c| {
            let coupled: f64 = (0..3 * n).map(|k| a[(r, k)] * a[(c, k)]).sum();
            1e-9 * (0.5 * coupled / n as f64 + if r == c { 0.5 } else { 0.0 })
        });
        let mut free: Vec<f64> = (0..3 * n).map(|_| numbers.between(-2e-5, 2e-5)).collect();
        free[..n].iter_mut().for_each(|gap| *gap *= 0.5);
        let load = numbers.between(1e3, 5e4);
        let direction = slope + numbers.between(-0.4, 0.4) * friction;
        let inside_the_cone = [along_z(-load * direction.cos()), along_y(-load * direction.sin())];
        let hubs: [&[FreeDirection]; 3] = [&[], &[along_z(-load)], &inside_the_cone];
        let hub = hubs[case % 3];
        let problem = Problem { points: &points, compliance: &compliance, free: &free, friction, hub };
        match solve(&problem, &vec![0.0; 3 * n]) {
            Ok(solution) => {
                let worst = violation(&problem, &solution);
                assert!(worst < SOLVER, "case {case}: {worst:e}, hub {hub:?}");
            }
            Err(error) => panic!("case {case}, {n} points, friction {friction}, hub {hub:?}: {error}"),
        }
    }
}

/// Goal: points that a start presses but that the free gaps keep apart lose their force; no points at all are no
/// problem either.
#[test]
fn a_start_that_nothing_presses_any_more_ends_open() {
    let points = flat_grid((3, 2), 1e-3, |_, _| 1e-5);
    for directions in [1, 3] {
        let compliance = half_spaces(&points);
        let rows = directions * points.len();
        let compliance = Mat::from_fn(rows, rows, |r, c| compliance[(r, c)]);
        let mut free = gaps(&points);
        free.resize(rows, 1e-6);
        let problem =
            Problem { points: &points, compliance: &compliance, free: &free, friction: 0.3, hub: &[] };
        let solution = solve(&problem, &vec![100.0; rows]).unwrap();
        assert_eq!(solution.modes, vec![PointMode::Open; points.len()]);
        assert_eq!(solution.forces, vec![0.0; rows]);
    }
    let none = Vec::new();
    let empty = Mat::zeros(0, 0);
    let problem = Problem { points: &none, compliance: &empty, free: &[], friction: 0.3, hub: &[] };
    assert_eq!(solve(&problem, &[]).unwrap().active(), 0);
}

/// Goal: a wheel that is pulled off cannot be carried by any point: an error with its reason, in bounded time.
#[test]
fn a_pull_that_nothing_carries_ends_with_a_reason() {
    let points = flat_grid((4, 4), 1e-3, |_, _| 1e-6);
    let compliance = half_spaces(&points);
    let mut free = gaps(&points);
    free.resize(3 * points.len(), 0.0);
    let hub = [along_z(1e3)];
    let problem = Problem { points: &points, compliance: &compliance, free: &free, friction: 0.3, hub: &hub };
    let Err(Error::Numerics(error)) = solve(&problem, &vec![0.0; free.len()]) else {
        panic!("a pull was carried");
    };
    assert!(matches!(error.reason, StopReason::Singular | StopReason::IterationLimit), "{error}");
    assert_eq!(error.active, 0, "{error}");
}
