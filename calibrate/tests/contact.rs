//! Contact against closed solutions: patch test, Hertz, sticking and sliding.

use faer::Mat;
use nalgebra::{Point2, Point3, Vector2, Vector3};
use railspring_calibrate::analytic::hertz::point_contact;
use railspring_calibrate::contact::{
    BodyCompliance, Compliance, ContactPoint, FreeDirection, HalfSpace, NearField, PairingLimits,
    PenaltySprings, PointMode, Problem, Side, Solution, Surface, flat_grid, gaps, hub_response, pair, solve,
    total,
};
use railspring_calibrate::mesh::{BlockOptions, HexMesh, mesh_block};
use railspring_calibrate::solid::{Formulation, Material, Supports, System};
use railspring_calibrate::superelement::Superelement;
use railspring_profiles::profile::ProfileCurve;

/// Sparse factorisation and dense inversion of some thousand equations, relative.
const ROUNDOFF: f64 = 1e-8;
/// The issue of exact enforcement on non-matching meshes: pressure uniform to this, relative.
const PATCH: f64 = 1e-6;

/// A block turned upside down: its contact surface looks down (+z).
fn upside_down(mut mesh: HexMesh) -> HexMesh {
    for p in &mut mesh.nodes {
        *p = Point3::new(p.x, -p.y, -p.z);
    }
    let (rows, columns) = (mesh.contact.along_profile.len(), mesh.contact.along_track.len());
    let length = mesh.contact.along_profile[rows - 1];
    let nodes = mesh.contact.nodes.clone();
    for i in 0..rows {
        for k in 0..columns {
            mesh.contact.nodes[i * columns + k] = nodes[(rows - 1 - i) * columns + k];
        }
    }
    mesh.contact.along_profile.reverse();
    mesh.contact.along_profile.iter_mut().for_each(|s| *s = length - *s);
    mesh
}

/// The hub free vertically, the wheel pressing with `load`, N.
fn downwards(load: f64) -> FreeDirection {
    FreeDirection { along: Vector3::z_axis(), force: -load }
}

fn straight(width: f64) -> ProfileCurve {
    let points: Vec<_> = (0..=8).map(|i| Point2::new(width * (i as f64 / 8.0 - 0.5), 0.0)).collect();
    ProfileCurve::from_points(&points, &[]).unwrap()
}

fn condensed(mesh: &HexMesh, material: Material) -> Superelement<'_> {
    let supports = Supports { held: mesh.foot.clone(), ..Default::default() };
    let system = System::new(mesh, material, Formulation::IncompatibleModes, &supports).unwrap();
    Superelement::new(system).unwrap()
}

/// Two blocks of the same footprint with non-matching meshes, the upper one on a free hub.
struct Blocks {
    width: f64,
    heights: [f64; 2],
    lower: HexMesh,
    upper: HexMesh,
}

impl Blocks {
    fn new(lower: [usize; 3], upper: [usize; 3]) -> Self {
        let (width, heights) = (0.02, [0.015, 0.01]);
        let block = |height, divisions| {
            mesh_block(&BlockOptions::uniform([width, width, height], divisions)).unwrap()
        };
        Self { width, heights, lower: block(heights[0], lower), upper: upside_down(block(heights[1], upper)) }
    }

    /// Presses the blocks; `plant` changes the weights between pairing and solution.
    fn press(
        &self,
        load: f64,
        friction: f64,
        plant: impl Fn(&mut [ContactPoint]),
    ) -> (Vec<ContactPoint>, Solution) {
        // without lateral contraction a block on a held foot carries a uniform uniaxial stress exactly
        let material = Material { poisson: 0.0, ..Material::STEEL };
        let (lower, upper) = (condensed(&self.lower, material), condensed(&self.upper, material));
        let curve = straight(self.width);
        let surface = |grid| Surface::extruded(&curve, grid);
        let mut points = pair(
            &surface(&self.lower.contact),
            &surface(&self.upper.contact),
            PairingLimits { largest_gap: 1e-3 },
        );
        plant(&mut points);
        let directions = if friction > 0.0 { 3 } else { 1 };
        let compliance = total(
            &[
                &BodyCompliance { compliance: &lower.compliance, side: Side::Base },
                &BodyCompliance { compliance: &upper.compliance, side: Side::Opposing },
            ],
            &points,
            directions,
        );
        let mut free = gaps(&points);
        free.resize(directions * points.len(), 0.0);
        let problem = Problem {
            points: &points,
            compliance: &compliance,
            free: &free,
            friction,
            hub: &[downwards(load)],
        };
        let start = vec![0.0; free.len()];
        let solution = solve(&problem, &start).unwrap();
        (points, solution)
    }
}

fn spread(points: &[ContactPoint], solution: &Solution, pressure: f64) -> f64 {
    (0..points.len())
        .map(|j| (solution.forces[j] / points[j].area / pressure - 1.0).abs())
        .fold(0.0, f64::max)
}

/// Source: uniaxial stress. Goal: a uniform pressure crosses non-matching meshes exactly, the hub moves by
/// F·(h1 + h2)/(E·A). Units SI. Accuracy: PATCH for the pressure, ROUNDOFF for the displacement.
#[test]
fn patch_test_on_non_matching_meshes() {
    let blocks = Blocks::new([5, 4, 3], [7, 6, 2]);
    let (load, area) = (40e3, 0.02 * 0.02);
    for friction in [0.0, 0.5] {
        let (points, solution) = blocks.press(load, friction, |_| ());
        let worst = spread(&points, &solution, load / area);
        assert!(worst < PATCH, "friction {friction}: pressure differs by {worst:e}");
        let exact = load * (blocks.heights[0] + blocks.heights[1]) / (Material::STEEL.young * area);
        assert!((solution.hub[0] / exact - 1.0).abs() < ROUNDOFF, "{} {exact}", solution.hub[0]);
    }
}

/// An error planted in the weights of a pairing.
type Planted = fn(&mut [ContactPoint]);

/// Source: the patch test above. Goal: it can fail. In one case the largest weight of one point on either
/// surface is off by 1 %. In the other one gap is off by a millionth of the displacement. The pressure is
/// then not uniform, by more than a thousand times PATCH for a weight, and by more than PATCH for the gap.
#[test]
fn a_wrong_weight_fails_the_patch_test() {
    /// The weight is a quarter to a half of its point's; its 1 % comes back in the pressure around it.
    const SEEN: f64 = 1e3 * PATCH;
    macro_rules! one_percent_more {
        ($weights:expr) => {{
            let largest = $weights.iter_mut().max_by(|a, b| a.scalar.total_cmp(&b.scalar)).unwrap();
            largest.scalar *= 1.01;
            largest.normal *= 1.01;
        }};
    }
    let blocks = Blocks::new([5, 4, 3], [7, 6, 2]);
    let load = 40e3;
    let planted: [(Planted, f64); 3] = [
        (|points| one_percent_more!(points[3].base), SEEN),
        (|points| one_percent_more!(points[3].opposing), SEEN),
        (|points| points[3].gap += 1e-11, PATCH),
    ];
    for friction in [0.0, 0.5] {
        for (k, (plant, seen)) in planted.iter().enumerate() {
            let (points, solution) = blocks.press(load, friction, plant);
            let worst = spread(&points, &solution, load / 4e-4);
            assert!(worst > *seen && worst.is_finite(), "friction {friction}, error {k}: {worst:e}");
        }
    }
}

/// Two half-spaces with the gap x²/2Rx + s²/2Rs, pressed with a load on a uniform grid.
struct OnHalfSpaces {
    approach: f64,
    largest_pressure: f64,
    tangent: f64,
    /// Semi-axes along x and s: those of the ellipse of Hertz with the same second moments, m.
    semi_axes: [f64; 2],
}

/// Presses on cells of the lengths `cell` along x and s (m), `count` of them.
fn on_half_spaces(radii: [f64; 2], load: f64, cell: [f64; 2], count: [usize; 2]) -> OnHalfSpaces {
    let mut points = flat_grid((count[1], count[0]), 1.0, |_, _| 0.0);
    for point in &mut points {
        point.widths = Vector2::new(cell[1], cell[0]);
        point.position = Point2::new(point.position.x * cell[1], point.position.y * cell[0]);
        point.area = cell[0] * cell[1];
        let (s, x) = (point.position.x, point.position.y);
        // mean over the hats
        point.gap = (s * s + cell[1].powi(2) / 6.0) / (2.0 * radii[1])
            + (x * x + cell[0].powi(2) / 6.0) / (2.0 * radii[0]);
    }
    let compliance = NearField::new(&HalfSpace::both(&Material::STEEL), &points, 1);
    let free = gaps(&points);
    let problem = Problem {
        points: &points,
        compliance: &compliance,
        free: &free,
        friction: 0.0,
        hub: &[downwards(load)],
    };
    let solution = solve(&problem, &vec![0.0; points.len()]).unwrap();
    let forces = &solution.forces;
    let carried: f64 = forces.iter().sum();
    assert!((carried / load - 1.0).abs() < WANTED, "{carried} of {load}");
    let moment = |axis: usize| {
        let sum: f64 = forces
            .iter()
            .zip(&points)
            .map(|(f, p)| f * (p.position[axis].powi(2) + p.widths[axis].powi(2) / 6.0))
            .sum();
        (5.0 * sum / load).sqrt()
    };
    OnHalfSpaces {
        approach: solution.hub[0],
        largest_pressure: forces.iter().zip(&points).map(|(f, point)| f / point.area).fold(0.0, f64::max),
        tangent: hub_response(&problem, &solution, &[Vector3::z_axis()], false).unwrap().stiffness[(0, 0)],
        semi_axes: [moment(1), moment(0)],
    }
}

/// SOLVER: the load that a solution carries, relative.
const WANTED: f64 = 1e-8;

/// Source: Hertz (K.L. Johnson, Contact Mechanics, 1985, chapter 4). Goal: ellipses 1:1, about 3:1 and about 10:1, lying
/// along x and along s, on half-spaces with twelve cells to each semi-axis, as many as the default fine grid has at 80 kN. Units SI. Accuracy, DISCRETISATION of the
/// bilinear pressure: approach 0.3 %, largest pressure 0.5 %, tangent 1 %, semi-axes half a cell; with half the
/// cells to an axis the approach is farther off.
#[test]
fn hertz_ellipses_on_half_spaces() {
    let load = 85e3;
    let mut worst = [[0.0_f64; 2]; 2];
    for (radii, ratio) in [([0.3, 0.3], 1.0), ([0.46, 0.08], 3.2), ([0.08, 0.46], 3.2), ([2.2, 0.06], 10.0)] {
        let exact =
            point_contact(load, radii[0], radii[1], Material::STEEL.contact_modulus(&Material::STEEL))
                .unwrap();
        let axes = [exact.semi_axis_x, exact.semi_axis_y];
        let longer = axes[0].max(axes[1]) / axes[0].min(axes[1]);
        assert!((longer / ratio - 1.0).abs() < 0.05, "{radii:?}: {longer}");
        for (level, cells) in [6.0, 12.0].into_iter().enumerate() {
            let cell = axes.map(|a| a / cells);
            let found = on_half_spaces(radii, load, cell, [2 * (1.3 * cells) as usize + 1; 2]);
            let approach = found.approach / exact.approach - 1.0;
            let pressure = found.largest_pressure / exact.max_pressure - 1.0;
            println!(
                "{longer:.1}:1, {cells} cells: approach {:.3} %, pressure {:.3} %, tangent {:.3} %, axes {:.3} {:.3} cells",
                100.0 * approach,
                100.0 * pressure,
                100.0 * (found.tangent / exact.tangent_stiffness - 1.0),
                (found.semi_axes[0] - axes[0]) / cell[0],
                (found.semi_axes[1] - axes[1]) / cell[1],
            );
            worst[level][0] = worst[level][0].max(approach.abs());
            worst[level][1] = worst[level][1].max(pressure.abs());
            if level == 1 {
                assert!(approach.abs() < 0.003 && pressure.abs() < 0.005, "{radii:?}");
                assert!((found.tangent / exact.tangent_stiffness - 1.0).abs() < 0.01, "{radii:?}");
                for axis in 0..2 {
                    assert!((found.semi_axes[axis] - axes[axis]).abs() < 0.5 * cell[axis], "{radii:?}");
                }
            }
        }
    }
    assert!(worst[1][0] < worst[0][0], "approach does not converge: {worst:?}");
}

/// Errors of two condensed blocks in contact against Hertz: approach and largest pressure, relative.
///
/// The blocks are not half-spaces, but beyond the patch they are linear, so that δ/F = δ_Hertz/F + C: the
/// difference of δ/F between two loads is free of C. It is compared with that of Hertz, over the approach
/// itself at the smaller load.
fn block_hertz(element: f64, radius_x: f64, radius_s: f64) -> (f64, f64) {
    let mesh = mesh_block(&BlockOptions::graded(0.06, 0.06, 0.012, 0.006, element, 1.6)).unwrap();
    let upper_mesh = upside_down(mesh.clone());
    let material = Material::STEEL;
    let (lower, upper) = (condensed(&mesh, material), condensed(&upper_mesh, material));
    let curve = straight(0.12);
    let surface = |grid| Surface::extruded(&curve, grid);
    let mut points =
        pair(&surface(&mesh.contact), &surface(&upper_mesh.contact), PairingLimits { largest_gap: 1e-3 });
    points.retain(|point| (point.position.x - 0.06).abs() < 0.0125 && point.position.y.abs() < 0.0125);
    for point in &mut points {
        let (s, x) = (point.position.x - 0.06, point.position.y);
        point.gap = s * s / (2.0 * radius_s) + x * x / (2.0 * radius_x);
    }
    let compliance = total(
        &[
            &BodyCompliance { compliance: &lower.compliance, side: Side::Base },
            &BodyCompliance { compliance: &upper.compliance, side: Side::Opposing },
        ],
        &points,
        1,
    );
    let press = |load: f64| {
        let (hub, free) = ([downwards(load)], gaps(&points));
        let problem =
            Problem { points: &points, compliance: &compliance, free: &free, friction: 0.0, hub: &hub };
        solve(&problem, &vec![0.0; points.len()]).unwrap()
    };
    let (small, large) = (50e3, 150e3);
    let (a, b) = (press(small), press(large));
    let hertz =
        |load: f64| point_contact(load, radius_x, radius_s, material.contact_modulus(&material)).unwrap();
    let measured = a.hub[0] / small - b.hub[0] / large;
    let exact = hertz(small).approach / small - hertz(large).approach / large;
    let largest = b.forces.iter().zip(&points).map(|(f, point)| f / point.area).fold(0.0, f64::max);
    ((measured - exact) * small / hertz(small).approach, largest / hertz(large).max_pressure - 1.0)
}

/// Source: Hertz. Goal: condensed finite elements give the approach of sphere and crossed cylinders within 3 % and
/// the largest pressure within 5 % with 2 mm contact elements (the smaller semi-axis is three and a half elements),
/// and both come nearer with smaller elements. Both blocks are 120 mm wide and 60 mm high. Units SI.
#[test]
fn hertz_on_finite_element_blocks() {
    for (radius_x, radius_s) in [(1.0, 1.0), (1.0, 0.7)] {
        let coarse = block_hertz(0.004, radius_x, radius_s);
        let standard = block_hertz(0.002, radius_x, radius_s);
        println!(
            "radii {radius_x} {radius_s}: errors of approach and pressure {coarse:?} (4 mm), {standard:?} (2 mm)"
        );
        assert!(standard.0.abs() < 0.03, "approach off by {}", standard.0);
        assert!(standard.1.abs() < 0.05, "largest pressure off by {}", standard.1);
        assert!(standard.0.abs() < 0.7 * coarse.0.abs(), "approach: {coarse:?} {standard:?}");
    }
}

/// Rows of a block of `n` points, each on its own spring of compliance `c` in all directions.
fn springs(points: &[ContactPoint], c: f64) -> Mat<f64> {
    let mut matrix = Mat::zeros(3 * points.len(), 3 * points.len());
    PenaltySprings { stiffness: 1.0 / c }.add_to(points, &mut matrix);
    matrix
}

/// Source: Coulomb's law on a block that is shifted on tangential springs. Goal: it sticks with force = shift/c
/// up to μ·P, slides with μ·P against the shift beyond it, and carries nothing when lifted. Accuracy: rounding.
#[test]
fn sticking_sliding_and_separation() {
    let (c, mu, press) = (1e-9, 0.5, 1e-5);
    let points = flat_grid((1, 1), 2e-3, |_, _| 0.0);
    let compliance = springs(&points, c);
    let run = |gap: f64, slip: [f64; 2]| {
        let free = [gap, slip[0], slip[1]];
        let problem =
            Problem { points: &points, compliance: &compliance, free: &free, friction: mu, hub: &[] };
        solve(&problem, &[0.0; 3]).unwrap()
    };
    let normal = press / c;
    let stick = run(-press, [3e-6, 0.0]);
    assert_eq!(stick.modes, [PointMode::Stick]);
    assert!((stick.forces[1] + 3e-6 / c).abs() < ROUNDOFF * normal);
    let slide = run(-press, [6e-6, 8e-6]);
    assert_eq!(slide.modes, [PointMode::Slip]);
    assert!((slide.forces[0] - normal).abs() < ROUNDOFF * normal);
    assert!((slide.forces[1] + mu * normal * 0.6).abs() < ROUNDOFF * normal, "{:?}", slide.forces);
    assert!((slide.forces[2] + mu * normal * 0.8).abs() < ROUNDOFF * normal, "{:?}", slide.forces);
    let open = run(1e-6, [1e-5, 0.0]);
    assert_eq!(open.modes, [PointMode::Open]);
    assert_eq!(open.forces, [0.0; 3]);
}

/// Goal: the hub's tangent stiffness by algebra equals a central difference of two solved loads.
/// Accuracy: the difference's second-order error for a load step of one part in a thousand.
#[test]
fn tangent_by_algebra_is_the_slope_of_the_load_curve() {
    const DIFFERENCE: f64 = 2e-2;
    let (load, step) = (85e3, 85.0);
    let pressed = |load| on_half_spaces([0.4, 0.3], load, [0.6e-3; 2], [31; 2]);
    let tangent = pressed(load).tangent;
    let low = pressed(load - step).approach;
    let high = pressed(load + step).approach;
    let slope = 2.0 * step / (high - low);
    assert!((tangent / slope - 1.0).abs() < DIFFERENCE, "{tangent} {slope}");
}
