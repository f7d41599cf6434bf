//! Means of the kernels over two hats.

use super::potentials::{Kernels, hat_potentials};
use nalgebra::Vector2;
use railspring_profiles::quadrature::{GAUSS_5, gauss_4_unit};
use std::sync::{Arc, Mutex, PoisonError};

/// Distance, in widths of the wider hat, from which points take the place of hats.
pub(super) const FAR: f64 = 5.0;

/// Distance, in widths of the wider hat, from which hats do not overlap and a rule on each of them will do: that of four
/// points on either slope.
const APART: f64 = 2.9;

/// The Gauss rule of three points with the hat on -1..1 as its weight: it has the hat's moments 1, 1/6 and 1/15. What
/// it misses of the sixth, 0.009, is below 0.02·(width/distance)⁶ of a mean, 2e-6 from [`FAR`] on.
const HAT_RULE: [(f64, f64); 3] = [
    (-0.632_455_532_033_675_9, 0.208_333_333_333_333_33),
    (0.0, 0.583_333_333_333_333_3),
    (0.632_455_532_033_675_9, 0.208_333_333_333_333_33),
];

/// Means of the kernels between the hat at `d` with the half widths `a` and that at the origin with `b`, 1/m.
pub(super) fn means(d: &Vector2<f64>, a: &Vector2<f64>, b: &Vector2<f64>) -> Kernels {
    let widest = a.sup(b);
    let mut sum = Kernels::default();
    let distance = d.x.abs().max(d.y.abs());
    let width = widest.x.max(widest.y);
    if distance > FAR * width {
        product(d, a, b, &HAT_RULE, &mut sum);
        return sum;
    }
    if distance > APART * width {
        product(d, a, b, &slopes(), &mut sum);
        return sum;
    }
    // Gauss points on the hat of `a`, between its own kinks and those of the potentials of the other hat
    let nodes = |half: f64, shift: f64, other: f64| -> Vec<(f64, f64)> {
        let mut cuts = vec![-half, 0.0, half];
        let inside = |cut: &f64| cut.abs() < half * (1.0 - 1e-6) && cut.abs() > 1e-6 * half;
        cuts.extend([-other, 0.0, other].map(|kink| kink - shift).iter().filter(|c| inside(c)));
        cuts.sort_by(f64::total_cmp);
        let panel = |ends: &[f64]| {
            let (middle, reach) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
            GAUSS_5.map(|(t, w)| {
                let at = middle + t * reach;
                (at, w * reach / half * (1.0 - at.abs() / half))
            })
        };
        cuts.windows(2).flat_map(panel).collect()
    };
    let along = nodes(a.y, d.y, b.y);
    for (s, ws) in nodes(a.x, d.x, b.x) {
        for &(x, wx) in &along {
            sum.add(ws * wx, &hat_potentials(d.x + s, d.y + x, b));
        }
    }
    sum
}

/// Adds the kernels by a `rule` for the hat on -1..1, on both hats and along both coordinates.
fn product<const N: usize>(
    d: &Vector2<f64>,
    a: &Vector2<f64>,
    b: &Vector2<f64>,
    rule: &[(f64, f64); N],
    sum: &mut Kernels,
) {
    // both hats along one coordinate at once
    let spread = |d: f64, a: f64, b: f64| -> Vec<(f64, f64)> {
        let pairs = rule.iter().flat_map(|&(u, wu)| rule.iter().map(move |&(v, wv)| (u, v, wu * wv)));
        pairs.map(|(u, v, weight)| (d + u * a - v * b, weight)).collect()
    };
    let along = spread(d.y, a.y, b.y);
    for (s, ws) in spread(d.x, a.x, b.x) {
        for &(x, wx) in &along {
            sum.add(ws * wx, &Kernels::at(s, x));
        }
    }
}

/// Four Gauss points on either slope of the hat on -1..1.
fn slopes() -> [(f64, f64); 8] {
    let rule = gauss_4_unit();
    std::array::from_fn(|n| {
        let ((at, weight), side) = (rule[n % 4], if n < 4 { -1.0 } else { 1.0 });
        (side * at, weight * (1.0 - at))
    })
}

/// Means between the hats of a uniform grid, by their offset in grid lines. All kernels go with the inverse of a length, so that grids of one ratio
/// of spacings that differ by a power of two, as halved grids do, have one table.
#[derive(Debug, Clone)]
pub struct HatTable {
    /// Grid spacing along the profile and the track, m.
    pub cell: Vector2<f64>,
    /// Of the unit's values, a power of two.
    scale: f64,
    unit: Arc<UnitTable>,
}

/// The table of a grid whose spacing along the profile is between 1 and 2.
#[derive(Debug)]
struct UnitTable {
    cell: Vector2<f64>,
    /// Number of offsets along the profile and the track, from 0.
    reach: (usize, usize),
    means: Vec<Kernels>,
}

/// Tables that were made, at most so many.
static MADE: Mutex<Vec<Arc<UnitTable>>> = Mutex::new(Vec::new());
const KEPT: usize = 64;

/// The power of two by which a spacing (m) is between 1 and 2.
fn scale_of(cell: Vector2<f64>) -> f64 {
    2.0_f64.powi(-(cell.x.log2().floor() as i32))
}

impl HatTable {
    /// A table with that reach or more. Grids of one unit share it: their spacings are few, and a value does not depend on the reach.
    pub fn shared(cell: Vector2<f64>, reach: (usize, usize)) -> Self {
        let made = || MADE.lock().unwrap_or_else(PoisonError::into_inner);
        let scale = scale_of(cell);
        let unit_cell = scale * cell;
        let of = |unit| Self { cell, scale, unit };
        let known = made().iter().find(|table| table.cell == unit_cell).cloned();
        let table = match known {
            Some(known) if reach.0 <= known.reach.0 && reach.1 <= known.reach.1 => return of(known),
            Some(known) => Arc::new(known.extended(reach)),
            None => Arc::new(UnitTable::new(unit_cell, reach)),
        };
        let mut tables = made();
        tables.retain(|other| other.cell != unit_cell);
        if tables.len() == KEPT {
            tables.remove(0);
        }
        tables.push(table.clone());
        of(table)
    }

    #[cfg(test)]
    fn new(cell: Vector2<f64>, reach: (usize, usize)) -> Self {
        let scale = scale_of(cell);
        Self { cell, scale, unit: Arc::new(UnitTable::new(scale * cell, reach)) }
    }

    /// Number of offsets along the profile and the track, from 0.
    #[cfg(test)]
    fn reach(&self) -> (usize, usize) {
        self.unit.reach
    }

    /// Means at a signed offset within reach.
    pub fn at(&self, offset: (isize, isize)) -> Kernels {
        let Kernels { inverse, across, shear, gradient } = self.unit.at(offset);
        let scale = self.scale;
        Kernels {
            inverse: scale * inverse,
            across: scale * across,
            shear: scale * shear,
            gradient: gradient * scale,
        }
    }
}

impl UnitTable {
    fn new(cell: Vector2<f64>, reach: (usize, usize)) -> Self {
        Self { cell, reach: (0, 0), means: Vec::new() }.extended(reach)
    }

    /// The table with at least that reach.
    fn extended(&self, reach: (usize, usize)) -> Self {
        let Self { cell, reach: known, .. } = *self;
        let reach = (reach.0.max(known.0), reach.1.max(known.1));
        let at = |n: usize| {
            let (i, k) = (n / reach.1, n % reach.1);
            if i < known.0 && k < known.1 {
                return self.means[i * known.1 + k];
            }
            means(&Vector2::new(i as f64 * cell.x, k as f64 * cell.y), &cell, &cell)
        };
        Self { cell, reach, means: (0..reach.0 * reach.1).map(at).collect() }
    }

    fn at(&self, (i, k): (isize, isize)) -> Kernels {
        let mut found = self.means[i.unsigned_abs() * self.reach.1 + k.unsigned_abs()];
        let (s, x) = (i.signum() as f64, k.signum() as f64);
        found.shear *= s * x;
        found.gradient.x *= s;
        found.gradient.y *= x;
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn differences(a: &Kernels, b: &Kernels) -> [f64; 5] {
        [
            a.inverse - b.inverse,
            a.across - b.across,
            a.shear - b.shear,
            a.gradient.x - b.gradient.x,
            a.gradient.y - b.gradient.y,
        ]
        .map(|d| d / a.inverse)
    }

    /// Source: reciprocity (a mean is the same either way, with the sign of its kernel), and the two ways to near and far
    /// hats where they meet. Accuracy over the mean of 1/r: MODEL of the far hats; with hats of different widths
    /// DISCRETISATION of five Gauss points a panel, beside kinks like x²·ln x.
    #[test]
    fn the_means_are_reciprocal_and_continuous() {
        const DISCRETISATION: f64 = 1e-4;
        const MODEL: f64 = 4e-6;
        let (a, b) = (Vector2::new(2e-3, 1.5e-3), Vector2::new(1.2e-3, 0.9e-3));
        for d in
            [Vector2::zeros(), Vector2::new(2e-3, 0.0), Vector2::new(5e-3, -3e-3), Vector2::new(-6e-3, 8e-3)]
        {
            let (one, mut other) = (means(&d, &a, &b), means(&-d, &b, &a));
            other.gradient = -other.gradient;
            for difference in differences(&one, &other) {
                assert!(difference.abs() < DISCRETISATION, "{d}: {one:?} {other:?}");
            }
        }
        for (border, x) in [FAR, APART].into_iter().flat_map(|w| [0.0, 3e-3, -4e-3].map(|x| (w * a.x, x))) {
            let at = |part: f64| means(&Vector2::new(border * part, x), &a, &a);
            let (near, far) = (at(1.0 - 1e-9), at(1.0 + 1e-9));
            for difference in differences(&near, &far) {
                assert!(difference.abs() < MODEL, "{border} {x}: {near:?} {far:?}");
            }
        }
    }

    /// Source: the means one by one. Goal: a table has them, with their signs, on all four sides. Exact.
    #[test]
    fn a_table_has_the_means() {
        let cell = Vector2::new(0.65e-3, 0.5e-3);
        let table = HatTable::new(cell, (9, 8));
        for (i, k) in [(0_i32, 0_i32), (2, -1), (-2, 1), (-8, -7), (8, 0), (0, -3)] {
            let d = Vector2::new(f64::from(i) * cell.x, f64::from(k) * cell.y);
            let found = table.at((i as isize, k as isize));
            for difference in differences(&found, &means(&d, &cell, &cell)) {
                assert!(difference.abs() < 1e-13, "{i} {k}: {found:?}");
            }
        }
    }

    /// Goal: a shared table reaches as far as it is asked to, whatever was asked before, and has the values of one that is made anew; so has one of a
    /// spacing twice as large or a quarter, from the same values. Exact.
    #[test]
    fn a_shared_table_is_as_a_new_one() {
        let cell = Vector2::new(0.77e-3, 0.31e-3);
        for reach in [(3, 5), (2, 2), (6, 2), (1, 9)] {
            let (shared, new) = (HatTable::shared(cell, reach), HatTable::new(cell, reach));
            assert!(shared.reach().0 >= reach.0 && shared.reach().1 >= reach.1);
            for i in 0..reach.0 as isize {
                for k in 0..reach.1 as isize {
                    assert_eq!(differences(&shared.at((i, k)), &new.at((i, k))), [0.0; 5]);
                }
            }
        }
        for cell in [2.0 * cell, 0.25 * cell] {
            let (other, new) = (HatTable::shared(cell, (3, 3)), HatTable::new(cell, (3, 3)));
            assert_eq!(other.cell, cell);
            assert_eq!(differences(&other.at((2, -1)), &new.at((2, -1))), [0.0; 5]);
        }
    }
}
