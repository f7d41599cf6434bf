//! Triangles between a fixed boundary, and quadrilaterals made of pairs of them.

use nalgebra::{Point2, Vector2};
use spade::{ConstrainedDelaunayTriangulation, Triangulation as _};

use super::sizing::SizeField;
use railspring_profiles::error::{InputError, Result};

/// Rounds of point relaxation.
const RELAXATIONS: usize = 40;
/// Distance of an inner point from the boundary, as part of the size there.
const CLEARANCE: f64 = 0.55;
/// A triangle is split while its circumradius exceeds this part of the size
/// (an equilateral triangle has 0.577).
const LARGEST_CIRCUMRADIUS: f64 = 0.78;
/// Smallest sine of a corner of a quadrilateral made of two triangles.
const SMALLEST_PAIR: f64 = 0.5;

/// Vertices and counter-clockwise triangles; the boundary's vertices come first.
#[derive(Debug, Clone)]
pub(super) struct Triangles {
    pub(super) points: Vec<Point2<f64>>,
    pub(super) triangles: Vec<[usize; 3]>,
}

/// Constrained Delaunay triangulation of the inside of a counter-clockwise polygon.
fn triangulate(points: &[Point2<f64>], boundary: usize) -> Result<Vec<[usize; 3]>> {
    let fail = |what: &str, p: Point2<f64>| {
        InputError::new(
            "section outline",
            format!("({:.4}, {:.4}) mm", p.x * 1e3, p.y * 1e3),
            "a simple closed outline",
            format!("repair the outline: {what}"),
        )
    };
    let mut cdt = ConstrainedDelaunayTriangulation::<spade::Point2<f64>>::new();
    let mut handles = Vec::with_capacity(points.len());
    for (k, p) in points.iter().enumerate() {
        let handle = cdt
            // a cylindrical tread has coordinates of 1e-60 m, which spade refuses
            .insert(spade::mitigate_underflow(spade::Point2::new(p.x, p.y)))
            .map_err(|error| fail(&format!("a vertex cannot be used ({error})"), *p))?;
        if handle.index() != k {
            return Err(fail("two vertices coincide", *p).into());
        }
        handles.push(handle);
    }
    for k in 0..boundary {
        let (a, b) = (handles[k], handles[(k + 1) % boundary]);
        if !cdt.can_add_constraint(a, b) {
            return Err(fail("it crosses itself", points[k]).into());
        }
        cdt.add_constraint(a, b);
    }
    let all: Vec<[usize; 3]> =
        cdt.inner_faces().map(|face| face.vertices().map(|v| v.fix().index())).collect();
    let mut triangles = inside_the_boundary(&all, boundary);
    for t in &mut triangles {
        let lowest = (0..3).min_by_key(|&i| t[i]).unwrap_or(0);
        t.rotate_left(lowest);
    }
    triangles.sort_unstable();
    Ok(triangles)
}

/// The triangles to the left of the boundary edges and all that hang together
/// with them without crossing the boundary. (A geometric test would fail for the
/// flat triangles outside a straight piece of the boundary.)
fn inside_the_boundary(all: &[[usize; 3]], boundary: usize) -> Vec<[usize; 3]> {
    let directed = |t: &[usize; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
    let on_boundary = |(a, b): (usize, usize)| a < boundary && b == (a + 1) % boundary;
    let owner: std::collections::BTreeMap<(usize, usize), usize> =
        all.iter().enumerate().flat_map(|(k, t)| directed(t).map(|edge| (edge, k))).collect();
    let mut chosen = vec![false; all.len()];
    let mut open: Vec<usize> =
        (0..all.len()).filter(|&k| directed(&all[k]).into_iter().any(on_boundary)).collect();
    while let Some(k) = open.pop() {
        if std::mem::replace(&mut chosen[k], true) {
            continue;
        }
        for (a, b) in directed(&all[k]) {
            if !on_boundary((a, b)) && !on_boundary((b, a)) {
                open.extend(owner.get(&(b, a)));
            }
        }
    }
    all.iter().zip(chosen).filter(|(_, inside)| *inside).map(|(t, _)| *t).collect()
}

fn centroid(points: &[Point2<f64>], t: &[usize; 3]) -> Point2<f64> {
    Point2::from((points[t[0]].coords + points[t[1]].coords + points[t[2]].coords) / 3.0)
}

/// Whether a point lies inside a polygon (even-odd rule).
fn inside(polygon: &[Point2<f64>], p: &Point2<f64>) -> bool {
    let mut inside = false;
    for k in 0..polygon.len() {
        let (a, b) = (polygon[k], polygon[(k + 1) % polygon.len()]);
        if (a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x {
            inside = !inside;
        }
    }
    inside
}

/// Distance of a point from a closed polygon.
fn distance(polygon: &[Point2<f64>], p: &Point2<f64>) -> f64 {
    (0..polygon.len())
        .map(|k| {
            let a = polygon[k];
            let edge = polygon[(k + 1) % polygon.len()] - a;
            let u = ((p - a).dot(&edge) / edge.norm_squared()).clamp(0.0, 1.0);
            (p - a - u * edge).norm()
        })
        .fold(f64::INFINITY, f64::min)
}

/// Centre and radius of the circle through the corners of a triangle.
fn circumcircle(points: &[Point2<f64>], t: &[usize; 3]) -> (Point2<f64>, f64) {
    let (a, b, c) = (points[t[0]], points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]);
    let d = 2.0 * b.perp(&c);
    let centre = Vector2::new(
        c.y * b.norm_squared() - b.y * c.norm_squared(),
        b.x * c.norm_squared() - c.x * b.norm_squared(),
    ) / d;
    (a + centre, centre.norm())
}

/// Fills a counter-clockwise polygon with well-shaped triangles of the sizes of
/// `size`. No vertex is added on the boundary.
pub(super) fn fill(polygon: &[Point2<f64>], size: &SizeField) -> Result<Triangles> {
    let boundary = polygon.len();
    let mut points = polygon.to_vec();
    let mut triangles = triangulate(&points, boundary)?;
    let usable = |p: &Point2<f64>| inside(polygon, p) && distance(polygon, p) >= CLEARANCE * size.at(p);

    // Insert the centre of the triangle that is largest against its size, until none is too large.
    for _ in 0..MOST_POINTS {
        let mut worst: Option<(f64, Point2<f64>)> = None;
        for t in &triangles {
            let (centre, radius) = circumcircle(&points, t);
            for candidate in [centre, centroid(&points, t)] {
                let ratio = radius / (LARGEST_CIRCUMRADIUS * size.at(&candidate));
                if ratio > worst.map_or(1.0, |(largest, _)| largest) && usable(&candidate) {
                    worst = Some((ratio, candidate));
                    break;
                }
            }
        }
        let Some((_, candidate)) = worst else { break };
        points.push(candidate);
        triangles = triangulate(&points, boundary)?;
    }

    // Relax: every inner point moves to the centre of its star, triangles
    // weighted by how often the wanted size fits in (optimal Delaunay).
    for _ in 0..RELAXATIONS {
        let mut sum = vec![(Vector2::zeros(), 0.0); points.len()];
        for t in &triangles {
            let (centre, _) = circumcircle(&points, t);
            let middle = centroid(&points, t);
            let target = if inside(polygon, &centre) { centre } else { middle };
            let area = signed_area(&points[t[0]], &points[t[1]], &points[t[2]]);
            let weight = area / size.at(&middle).powi(4);
            for &v in t {
                sum[v].0 += weight * target.coords;
                sum[v].1 += weight;
            }
        }
        for v in boundary..points.len() {
            let wanted = Point2::from(sum[v].0 / sum[v].1);
            if usable(&wanted) {
                points[v] = wanted;
            }
        }
        triangles = triangulate(&points, boundary)?;
    }
    Ok(Triangles { points, triangles })
}

/// Bound on the inner points of a section; far more than a section needs.
const MOST_POINTS: usize = 20_000;

/// A cell of a mixed mesh: a triangle or a quadrilateral, counter-clockwise.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Cell {
    Triangle([usize; 3]),
    Quad([usize; 4]),
}

/// Joins pairs of triangles to quadrilaterals: the best pairs first, then
/// chains that free two more triangles; what finds no good partner stays.
pub(super) fn pair(mesh: &Triangles) -> Vec<Cell> {
    let n = mesh.triangles.len();
    // Candidates: (quality, triangle, triangle, quadrilateral), by shared edge.
    let mut edges: std::collections::BTreeMap<(usize, usize), Vec<usize>> = std::collections::BTreeMap::new();
    for (k, t) in mesh.triangles.iter().enumerate() {
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            edges.entry((a.min(b), a.max(b))).or_default().push(k);
        }
    }
    let mut candidates: Vec<(f64, usize, usize, [usize; 4])> = Vec::new();
    for (&(a, b), sides) in &edges {
        let &[s, t] = sides.as_slice() else { continue };
        let third = |k: usize| mesh.triangles[k].iter().copied().find(|&v| v != a && v != b).unwrap_or(a);
        let (p, q) = (third(s), third(t));
        let mut quad = [p, a, q, b];
        if signed_area(&mesh.points[p], &mesh.points[a], &mesh.points[q]) < 0.0 {
            quad = [p, b, q, a];
        }
        let quality = smallest_sine(&mesh.points, &quad);
        if quality >= SMALLEST_PAIR {
            candidates.push((quality, s, t, quad));
        }
    }
    candidates.sort_by(|x, y| y.0.total_cmp(&x.0).then((x.1, x.2).cmp(&(y.1, y.2))));

    let mut partner: Vec<Option<usize>> = vec![None; n]; // candidate of each triangle
    for (c, &(_, s, t, _)) in candidates.iter().enumerate() {
        if partner[s].is_none() && partner[t].is_none() {
            partner[s] = Some(c);
            partner[t] = Some(c);
        }
    }
    while let Some((old, first, second)) = longer_chain(&candidates, &partner) {
        let (_, s, t, _) = candidates[old];
        partner[s] = None;
        partner[t] = None;
        for c in [first, second] {
            let (_, s, t, _) = candidates[c];
            partner[s] = Some(c);
            partner[t] = Some(c);
        }
    }

    let mut cells = Vec::new();
    for k in 0..n {
        match partner[k] {
            None => cells.push(Cell::Triangle(mesh.triangles[k])),
            Some(c) if candidates[c].1 == k => cells.push(Cell::Quad(candidates[c].3)),
            Some(_) => {}
        }
    }
    cells
}

/// A pair that can give way to two: single - (pair) - single becomes two pairs.
/// Returns the candidates: the pair to part and the two to join.
fn longer_chain(
    candidates: &[(f64, usize, usize, [usize; 4])],
    partner: &[Option<usize>],
) -> Option<(usize, usize, usize)> {
    let mut best: Option<(f64, (usize, usize, usize))> = None;
    for (old, &(_, s, t, _)) in candidates.iter().enumerate() {
        if partner[s] != Some(old) {
            continue;
        }
        // The best free neighbour on either side; candidates are sorted by quality.
        let free = |k: usize, not: Option<usize>| {
            candidates.iter().position(|&(_, a, b, _)| {
                (a == k && partner[b].is_none() && Some(b) != not)
                    || (b == k && partner[a].is_none() && Some(a) != not)
            })
        };
        let Some(first) = free(s, None) else { continue };
        let (_, a, b, _) = candidates[first];
        let Some(second) = free(t, Some(if a == s { b } else { a })) else { continue };
        let quality = candidates[first].0.min(candidates[second].0);
        if best.is_none_or(|(q, _)| quality > q) {
            best = Some((quality, (old, first, second)));
        }
    }
    best.map(|(_, chain)| chain)
}

/// Smallest sine of the corner angles of a quadrilateral; negative when not convex.
pub(super) fn smallest_sine(points: &[Point2<f64>], quad: &[usize; 4]) -> f64 {
    (0..4)
        .map(|i| {
            let corner = points[quad[i]];
            let next = points[quad[(i + 1) % 4]] - corner;
            let previous = points[quad[(i + 3) % 4]] - corner;
            next.perp(&previous) / (next.norm() * previous.norm())
        })
        .fold(f64::INFINITY, f64::min)
}

/// Signed area of the triangle `a`, `b`, `c`: positive when counter-clockwise
/// with the first coordinate to the right and the second up.
pub(super) fn signed_area(a: &Point2<f64>, b: &Point2<f64>, c: &Point2<f64>) -> f64 {
    0.5 * (b - a).perp(&(c - a))
}
