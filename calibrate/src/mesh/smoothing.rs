//! Smoothing of a section mesh by optimisation.
//!
//! Every node that may move is moved to where the elements around it are
//! nearest to squares, as measured by `(|a|² + |b|²) / (2 a×b)` at each corner
//! with the edges `a` and `b` (one for a square corner, infinite for a flat
//! one). A move is taken only when it lowers the sum of the fourth powers and
//! does not leave the worst corner around worse than both it was and a sine of
//! 0.7; so the worst element never gets worse.

use nalgebra::{Point2, Vector2};

use super::sizing::Polyline;

/// Largest number of passes over all nodes.
const PASSES: usize = 60;
/// Sine of a corner angle above which a corner may get worse in favour of others.
const GOOD_ENOUGH: f64 = 0.7;
/// First step of the search, as part of the shortest edge at the node, and the last.
const FIRST_STEP: f64 = 0.2;
const LAST_STEP: f64 = 0.005;

/// How a node may move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Freedom {
    /// Not at all.
    Fixed,
    /// Not at all: it is a corner of the outline.
    Corner {
        /// Arc length at which it is.
        at: f64,
    },
    /// Along the outline: arc length there, now, least and most.
    Slides {
        /// Arc length at which the node is.
        at: f64,
        /// Range of arc lengths it keeps to, so that the spacing stays near the wanted one.
        range: (f64, f64),
    },
    /// Anywhere.
    Free,
}

/// Moves the nodes of a quadrilateral mesh to better places.
pub(super) fn smooth(
    nodes: &mut [Point2<f64>],
    quads: &[[usize; 4]],
    freedom: &mut [Freedom],
    outline: &Polyline,
) {
    let mut around: Vec<Vec<usize>> = vec![Vec::new(); nodes.len()];
    for (e, quad) in quads.iter().enumerate() {
        for &v in quad {
            around[v].push(e);
        }
    }
    // a node whose search found nothing finds nothing again until one around it moves
    let mut settled = vec![false; nodes.len()];
    for _ in 0..PASSES {
        let mut any_moved = false;
        for v in 0..nodes.len() {
            if settled[v] {
                continue;
            }
            let moved = match freedom[v] {
                Freedom::Fixed | Freedom::Corner { .. } => false,
                Freedom::Free => {
                    const DIAGONAL: f64 = std::f64::consts::FRAC_1_SQRT_2;
                    let directions = [
                        Vector2::new(1.0, 0.0),
                        Vector2::new(0.0, 1.0),
                        Vector2::new(-1.0, 0.0),
                        Vector2::new(0.0, -1.0),
                        Vector2::new(DIAGONAL, DIAGONAL),
                        Vector2::new(-DIAGONAL, DIAGONAL),
                        Vector2::new(-DIAGONAL, -DIAGONAL),
                        Vector2::new(DIAGONAL, -DIAGONAL),
                    ];
                    search(
                        nodes,
                        quads,
                        &around[v],
                        v,
                        &mut Vector2::zeros(),
                        &directions,
                        |start, offset| start + offset,
                    )
                }
                Freedom::Slides { at, range } => {
                    let directions = [Vector2::new(1.0, 0.0), Vector2::new(-1.0, 0.0)];
                    let mut offset = Vector2::zeros();
                    let moved = search(nodes, quads, &around[v], v, &mut offset, &directions, |_, offset| {
                        outline.point((at + offset.x).clamp(range.0, range.1))
                    });
                    freedom[v] = Freedom::Slides { at: (at + offset.x).clamp(range.0, range.1), range };
                    moved
                }
            };
            settled[v] = true;
            if moved {
                around[v].iter().flat_map(|&e| quads[e]).for_each(|w| settled[w] = false);
            }
            any_moved |= moved;
        }
        if !any_moved {
            break;
        }
    }
}

/// Compass search for the best place of one node; `place` turns an offset into a position.
fn search(
    nodes: &mut [Point2<f64>],
    quads: &[[usize; 4]],
    around: &[usize],
    v: usize,
    offset: &mut Vector2<f64>,
    directions: &[Vector2<f64>],
    place: impl Fn(&Point2<f64>, &Vector2<f64>) -> Point2<f64>,
) -> bool {
    let start = nodes[v];
    let scale = shortest_edge(nodes, quads, around, v);
    let Some((mut best, mut worst_corner)) = measure(nodes, quads, around, f64::INFINITY) else {
        return false;
    };
    let mut step = FIRST_STEP;
    let mut moved = false;
    while step >= LAST_STEP {
        let mut improved = false;
        for direction in directions {
            let trial = *offset + step * scale * direction;
            let previous = nodes[v];
            nodes[v] = place(&start, &trial);
            let better = measure(nodes, quads, around, best * (1.0 - LEAST_GAIN));
            let tolerable = |corner: f64| worst_corner <= 0.0 || corner >= worst_corner.min(GOOD_ENOUGH);
            match better.filter(|(_, corner)| tolerable(*corner)) {
                Some((value, corner)) => {
                    *offset = trial;
                    best = value;
                    worst_corner = corner;
                    improved = true;
                    moved = true;
                }
                None => nodes[v] = previous,
            }
        }
        if !improved {
            step *= 0.5;
        }
    }
    moved
}

/// Relative decrease of the measure that is worth a move.
const LEAST_GAIN: f64 = 1e-4;

fn shortest_edge(nodes: &[Point2<f64>], quads: &[[usize; 4]], around: &[usize], v: usize) -> f64 {
    let mut shortest = f64::INFINITY;
    for &e in around {
        for i in 0..4 {
            let (a, b) = (quads[e][i], quads[e][(i + 1) % 4]);
            if a == v || b == v {
                shortest = shortest.min((nodes[a] - nodes[b]).norm());
            }
        }
    }
    shortest
}

/// The measure to be lowered, summed over the elements around, and the sine of the worst corner; none where the sum, which only grows, is not `below` a value.
fn measure(nodes: &[Point2<f64>], quads: &[[usize; 4]], around: &[usize], below: f64) -> Option<(f64, f64)> {
    let mut sum = 0.0;
    let mut worst = f64::INFINITY;
    for &e in around {
        let quad = &quads[e];
        for i in 0..4 {
            let corner = nodes[quad[i]];
            let a = nodes[quad[(i + 1) % 4]] - corner;
            let b = nodes[quad[(i + 3) % 4]] - corner;
            let squares = a.norm_squared() + b.norm_squared();
            let sine = a.perp(&b) / (a.norm() * b.norm());
            worst = worst.min(sine);
            // Far from degenerate the measure itself; below, a straight
            // continuation that still tells which way is better.
            let flatness = 2.0 * a.perp(&b) / squares;
            let shape = if flatness > FLAT { 1.0 / flatness } else { (2.0 - flatness / FLAT) / FLAT };
            sum += shape.powi(4);
        }
        if sum >= below {
            return None;
        }
    }
    (sum < below).then_some((sum, worst))
}

/// Below this value of `2 a×b / (|a|² + |b|²)` a corner counts as flat.
const FLAT: f64 = 0.05;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_displaced_middle_node_returns() {
        let mut nodes: Vec<Point2<f64>> =
            (0..9).map(|i| Point2::new(f64::from(i % 3), f64::from(i / 3))).collect();
        nodes[4] = Point2::new(1.6, 0.7);
        let quads = [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]];
        let mut freedom = vec![Freedom::Fixed; 9];
        freedom[4] = Freedom::Free;
        smooth(&mut nodes, &quads, &mut freedom, &Polyline::new(&[]));
        // SOLVER: the last step of the search is 0.005 of an edge of about one.
        assert!((nodes[4] - Point2::new(1.0, 1.0)).norm() < 0.02, "{}", nodes[4]);
    }

    #[test]
    fn a_node_pushed_out_of_its_elements_is_brought_back() {
        let mut nodes: Vec<Point2<f64>> =
            (0..9).map(|i| Point2::new(f64::from(i % 3), f64::from(i / 3))).collect();
        nodes[4] = Point2::new(2.3, 1.2);
        let quads = [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]];
        let mut freedom = vec![Freedom::Fixed; 9];
        freedom[4] = Freedom::Free;
        smooth(&mut nodes, &quads, &mut freedom, &Polyline::new(&[]));
        let (_, worst) = measure(&nodes, &quads, &[0, 1, 2, 3], f64::INFINITY).unwrap();
        assert!(worst > 0.9, "{worst}");
    }
}
