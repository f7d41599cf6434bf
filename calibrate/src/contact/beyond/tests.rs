use super::super::point::{ContactPoint, Side, flat_grid};
use super::super::{Compliance, NodalCompliance, at_points};
use super::*;

const LINES: usize = 8;
const COLUMNS: usize = 13;
const ALL: usize = LINES * COLUMNS;
/// Distance of the nodes, m.
const H: f64 = 1e-3;

/// A flat grid with so many metres along the track over its coordinate, and its nodes.
fn grid(over: f64) -> (SurfaceGrid, Vec<Point3<f64>>) {
    let along = |n: usize, of: usize| (n as f64 - (of / 2) as f64) * H;
    let grid = SurfaceGrid {
        along_profile: (0..LINES).map(|i| along(i, LINES)).collect(),
        along_track: (0..COLUMNS).map(|k| along(k, COLUMNS) / over).collect(),
        nodes: (0..ALL).collect(),
    };
    let x = |t: &f64| if over == 1.0 { *t } else { over * t.sin() };
    let line = |s: &f64| grid.along_track.iter().map(|t| Point3::new(x(t), *s, 0.0)).collect::<Vec<_>>();
    let nodes = grid.along_profile.iter().flat_map(line).collect();
    (grid, nodes)
}

/// Lines and columns between two nodes.
fn apart(a: usize, b: usize) -> [usize; 2] {
    [(a / COLUMNS).abs_diff(b / COLUMNS), (a % COLUMNS).abs_diff(b % COLUMNS)]
}

/// Source: functions that are linear in the places of both nodes, which means over hats and over distances along the track leave as they are. Goal: of such a compliance, m/N, an
/// error at each node by itself goes, where no half-space is in it; some of the nodes have what they have among all. Accuracy: ROUNDOFF of the largest value.
#[test]
fn errors_of_the_nodes_go() {
    const ROUNDOFF: f64 = 1e-13;
    let rigid = HalfSpace { shear_modulus: f64::INFINITY, poisson: 0.3, side: Side::Base };
    let (grid, places) = grid(1.0);
    let exact = |r: usize, c: usize| {
        let (a, b) = (places[r / 3] / H, places[c / 3] / H);
        match (r.is_multiple_of(3), c.is_multiple_of(3)) {
            (true, false) => -0.1 * (a.x - b.x),
            (false, true) => 0.1 * (a.x - b.x),
            _ => 1.0 + 0.01 * (a.y + b.y) + 0.02 * (a.x + b.x),
        }
    };
    let error = |r: usize, c: usize| if r == c { 0.7 } else { 0.0 };
    let compliance = Mat::from_fn(3 * ALL, 3 * ALL, |r, c| exact(r, c) + error(r, c));
    let body = BeyondHalfSpace::of_nodes(&grid, &places, false, rigid);
    let all: Vec<usize> = (0..ALL).collect();
    let found = body.between(&compliance.terms(), &all);
    // whose hats are whole, and which others stand for
    let inside = |node: &usize| {
        (1..LINES - 1).contains(&(node / COLUMNS)) && (3..COLUMNS - 3).contains(&(node % COLUMNS))
    };
    let some: Vec<usize> = all.into_iter().filter(|node| inside(node) && node % 5 != 2).collect();
    let of_some = body.between(&compliance.terms(), &some);
    for (r, c) in (0..3 * some.len()).flat_map(|r| (0..3 * some.len()).map(move |c| (r, c))) {
        let of_all = [r, c].map(|row| 3 * some[row / 3] + row % 3);
        for other in [found[(of_all[0], of_all[1])], exact(of_all[0], of_all[1])] {
            let off = of_some[(r, c)] - other;
            assert!(off.abs() < ROUNDOFF * 1.3, "{r} {c}: {off}");
        }
    }
}

/// Source: the half-space of the same points by itself. Goal: a rigid body is the negative of it, m/N, in the directions of the points, of a rail and of a wheel, between nodes that none
/// stand for. Accuracy over the largest value: ROUNDOFF, and RADII of a wheel's, an eighth of the square of 0.005.
#[test]
fn a_rigid_body_lacks_its_half_space() {
    const ROUNDOFF: f64 = 1e-13;
    const OF_RADII: f64 = 4e-6;
    let mut points: Vec<ContactPoint> = flat_grid((LINES, COLUMNS), H, |_, _| 0.0);
    for (node, point) in points.iter_mut().enumerate() {
        let weight = NodeWeight { node, normal: point.normal, scalar: 1.0 };
        (point.base, point.opposing) = (vec![weight], vec![weight]);
    }
    for (side, over) in [(Side::Base, 1.0), (Side::Opposing, 0.461)] {
        let half_space = HalfSpace { shear_modulus: 80e9, poisson: 0.28, side };
        let (grid, places) = grid(over);
        let body = BeyondHalfSpace::of_nodes(&grid, &places, side == Side::Opposing, half_space);
        let all: Vec<usize> = (0..ALL).collect();
        let between = body.between(&Mat::zeros(3 * ALL, 3 * ALL).terms(), &all);
        let found = at_points((&between, &all), &points, side, 3, None);
        let mut exact = Mat::zeros(3 * ALL, 3 * ALL);
        half_space.add_to(&points, &mut exact);
        let tolerance = if over == 1.0 { ROUNDOFF } else { OF_RADII } * exact.norm_max();
        // widths at the ends are half of the others here
        let inside = |node: usize| {
            (1..LINES - 1).contains(&(node / COLUMNS)) && (1..COLUMNS - 1).contains(&(node % COLUMNS))
        };
        for (r, c) in (0..3 * ALL).flat_map(|r| (0..3 * ALL).map(move |c| (r, c))) {
            let (a, b) = (r % ALL, c % ALL);
            let [lines, columns] = apart(a, b);
            if inside(a) && inside(b) && (lines > UNRESOLVED || columns > UNRESOLVED) {
                let sum = found[(r, c)] + exact[(r, c)];
                assert!(sum.abs() < tolerance, "{side:?} {r} {c}: {} {}", found[(r, c)], exact[(r, c)]);
            }
        }
    }
}

/// Goal: the middle of a grid whose cells grow towards its ends has the values that it has in the whole grid, m/N: nodes in the middle alone are asked for by themselves.
#[test]
fn the_middle_is_that_of_the_whole() {
    let (mut grid, mut places) = grid(1.0);
    for k in [0, 1, COLUMNS - 2, COLUMNS - 1] {
        grid.along_track[k] *= 1.2;
        places.iter_mut().skip(k).step_by(COLUMNS).for_each(|place| place.x *= 1.2);
    }
    let half_space = HalfSpace { shear_modulus: 80e9, poisson: 0.28, side: Side::Base };
    let body = BeyondHalfSpace::of_nodes(&grid, &places, false, half_space);
    assert_eq!(body.blocks[0].wanted, 2..COLUMNS - 2);
    let wave = |n: usize| 1e-9 * (1.7 * n as f64 + 0.3).sin();
    let compliance = Mat::from_fn(3 * ALL, 3 * ALL, |r, c| wave(r + c) + wave(r * c));
    let middle: Vec<usize> = (0..ALL).filter(|node| (2..COLUMNS - 2).contains(&(node % COLUMNS))).collect();
    let all: Vec<usize> = (0..ALL).collect();
    let (of_middle, of_all) =
        (body.between(&compliance.terms(), &middle), body.between(&compliance.terms(), &all));
    for (r, c) in (0..3 * middle.len()).flat_map(|r| (0..3 * middle.len()).map(move |c| (r, c))) {
        let [row, column] = [r, c].map(|row| 3 * middle[row / 3] + row % 3);
        assert_eq!(of_middle[(r, c)], of_all[(row, column)], "{r} {c}");
    }
}

/// A compliance that is a sum.
struct Sum {
    matrix: Mat<f64>,
    factors: [Mat<f64>; 2],
}

impl NodalCompliance for Sum {
    fn coordinates(&self) -> usize {
        self.matrix.nrows()
    }

    fn terms(&self) -> Terms<'_> {
        let [a, b] = &self.factors;
        Terms { matrix: &self.matrix, factor: 0.8, product: Some([a, b]) }
    }
}

/// Source: the matrix 0.8·C + A·Bᵀ (m/N) by its values, against a half-space that is softer by the factor. Goal: a compliance that is such a sum has the same values; forces on
/// points reach the nodes in whose means these values are. Accuracy over the largest value: ROUNDOFF.
#[test]
fn a_sum_is_its_terms() {
    const ROUNDOFF: f64 = 1e-12;
    let (grid, places) = grid(1.0);
    let wave = |n: usize| 1e-9 * (1.7 * n as f64 + 0.3).sin();
    let shapes = Mat::from_fn(3 * ALL, 5, |r, c| 1e9 * wave(3 * r + 7 * c));
    let between = Mat::<f64>::from_fn(5, 5, |r, c| wave(r + c + r * c));
    let half = &shapes * &between;
    let matrix = Mat::from_fn(3 * ALL, 3 * ALL, |r, c| wave(r + c) + wave(r * c));
    let whole = &matrix * Scale(0.8) + &half * shapes.transpose();
    let sum = Sum { matrix, factors: [half, shapes] };
    let half_space = HalfSpace { shear_modulus: 80e9, poisson: 0.28, side: Side::Base };
    let softer = HalfSpace { shear_modulus: 80e9 / 0.8, ..half_space };
    let body = BeyondHalfSpace::of_nodes(&grid, &places, false, half_space);
    let is_end = |node: &usize| {
        [0, LINES - 1].contains(&(node / COLUMNS)) || [0, COLUMNS - 1].contains(&(node % COLUMNS))
    };
    let some: Vec<usize> = (0..ALL).filter(|node| !is_end(node) && node % 7 < 4).collect();
    let found = body.between(&sum.terms(), &some);
    let exact = body.with(softer).between(&whole.terms(), &some);
    assert!((&found - &exact).norm_max() < ROUNDOFF * exact.norm_max());
    let rigid = body.with(HalfSpace { shear_modulus: f64::INFINITY, ..half_space });
    let alone = rigid.between(&whole.terms(), &some);
    let reached = |place: usize| {
        let weight = NodeWeight { node: some[place], normal: Vector2::y(), scalar: 1.0 };
        rigid.spread(&[weight])
    };
    for (a, b) in (0..some.len()).flat_map(|a| (0..some.len()).map(move |b| (a, b))) {
        let [lines, columns] = apart(some[a], some[b]);
        if lines > UNRESOLVED || columns > UNRESOLVED {
            let of = |to: &NodeWeight, from: &NodeWeight| {
                to.normal.y * from.normal.y * whole[(3 * to.node + 2, 3 * from.node + 2)]
            };
            let (to, from) = (reached(a), reached(b));
            let exact: f64 = to.iter().flat_map(|to| from.iter().map(move |from| of(to, from))).sum();
            let off = (alone[(3 * a + 2, 3 * b + 2)] - exact).abs();
            assert!(off < ROUNDOFF * alone.norm_max(), "{a} {b}: {off:e}");
        }
    }
}
