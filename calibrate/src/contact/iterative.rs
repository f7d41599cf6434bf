//! Newton steps by products with the compliance, for more rows than are worth a dense factor.
//!
//! Y. Saad, M.H. Schultz, "GMRES: a generalized minimal residual algorithm for solving nonsymmetric linear systems",
//! SIAM J. Sci. Stat. Comput. 7 (1986), preconditioned from the right. The directions of contact are weakly coupled
//! (normal and tangential ones not at all on half-spaces of one material), so the preconditioner has a dense factor for
//! each of them, at a twenty-seventh of the work of one for all.

use super::dense::{DenseFactor, SymmetricFactor};
use super::operator::ComplianceOperator;
use super::state::{PointMode, State};
use faer::Mat;
use nalgebra::{Vector2, Vector3};

/// Rows from which products are faster than a dense factor.
const ROWS: usize = 100;
/// Products at most, before a dense factor takes over.
const LIMIT: usize = 60;

/// The friction cone of a sliding point, linearised: `v = τ - scale·slip` is the trial force.
pub(super) struct Cone {
    /// Direction of the trial force.
    pub unit: Vector2<f64>,
    /// Friction at the present normal force, N.
    pub limit: f64,
    /// Friction over the length of the trial force.
    turn: f64,
    /// Coefficient of friction.
    pub friction: f64,
}

impl Cone {
    pub fn new(state: &State, j: usize) -> Self {
        let (_, v) = state.trial(j);
        let length = v.norm();
        let friction = state.problem.friction;
        let limit = friction * state.forces[j].max(0.0);
        Self {
            unit: if length > 0.0 { v / length } else { v },
            limit,
            turn: if limit > 0.0 { limit / length } else { 0.0 },
            friction,
        }
    }

    /// What a change of the trial force by (x, y) turns the friction by.
    pub fn across(&self, x: f64, y: f64) -> (f64, f64) {
        let along = self.unit.x * x + self.unit.y * y;
        (self.turn * (x - along * self.unit.x), self.turn * (y - along * self.unit.y))
    }
}

/// Linearised conditions of contact: of the load-carrying points, normal rows, then lateral ones, then those along the track,
/// and of the hub.
pub(super) struct Linearised<'a> {
    pub state: &'a State<'a>,
    pub modes: &'a [PointMode],
    /// Points that carry load.
    pub active: &'a [usize],
    /// Their rows.
    pub rows: &'a [usize],
    /// Free directions of the hub.
    pub along: &'a [Vector3<f64>],
    /// What the hub's displacement is multiplied by in its columns, m/N.
    pub hub_unit: f64,
}

impl Linearised<'_> {
    /// What hub motions by one along `directions` do to the rows, sliding points with their share of the slip only.
    pub fn motions(&self, directions: &[Vector3<f64>]) -> Vec<Vec<f64>> {
        let a = self.active.len();
        let motion = |along: &Vector3<f64>| {
            let of_row = |&row: &usize| self.state.scale[row] * self.state.hub_weight(row, along);
            let mut column: Vec<f64> = self.rows.iter().map(of_row).collect();
            for (local, cone) in self.sliding() {
                let (row1, row2) = (a + local, 2 * a + local);
                (column[row1], column[row2]) = cone.across(column[row1], column[row2]);
            }
            column
        };
        directions.iter().map(motion).collect()
    }

    /// Solutions for right-hand sides as long as rows and hub directions, to a residual of `tolerance` times these; `None` where this way is not worth it or does not
    /// lead there.
    pub fn solve(&self, sides: &[Vec<f64>], tolerance: f64) -> Option<Vec<Vec<f64>>> {
        if self.rows.len() < ROWS {
            return None;
        }
        let products = Products::new(self)?;
        let inverse = Inverse::new(&products);
        sides.iter().map(|side| gmres(side, tolerance, |x| products.of(x), |r| inverse.of(r))).collect()
    }

    /// The sliding points, by their place among the active ones.
    fn sliding(&self) -> impl Iterator<Item = (usize, Cone)> {
        let three = self.state.directions == 3;
        let points = self.active.iter().enumerate();
        points
            .filter(move |(_, j)| three && self.modes[**j] == PointMode::Slip)
            .map(|(local, &j)| (local, Cone::new(self.state, j)))
    }
}

/// The linearised conditions as products.
struct Products<'a> {
    linearised: &'a Linearised<'a>,
    /// Compliance between the active points.
    compliance: Box<dyn ComplianceOperator + 'a>,
    /// Sliding points, by their place among the active ones.
    sliding: Vec<(usize, Cone)>,
    /// What turns metres into newtons, by row.
    scale: Vec<f64>,
    /// By hub direction and row, what the row's separation changes by where the hub moves by one.
    hub: Vec<Vec<f64>>,
}

impl<'a> Products<'a> {
    fn new(linearised: &'a Linearised<'a>) -> Option<Self> {
        let Linearised { state, active, rows, along, .. } = linearised;
        let weights = |along: &Vector3<f64>| rows.iter().map(|&row| state.hub_weight(row, along)).collect();
        Some(Self {
            linearised,
            compliance: state.problem.compliance.among(active)?,
            sliding: linearised.sliding().collect(),
            scale: rows.iter().map(|&row| state.scale[row]).collect(),
            hub: along.iter().map(weights).collect(),
        })
    }

    fn of(&self, x: &[f64]) -> Vec<f64> {
        let m = self.scale.len();
        let mut product = vec![0.0; x.len()];
        self.compliance.add_product(&x[..m], &mut product[..m]);
        for (weights, h) in self.hub.iter().zip(&x[m..]) {
            let way = self.linearised.hub_unit * h;
            product.iter_mut().zip(weights).for_each(|(p, weight)| *p += weight * way);
        }
        product.iter_mut().zip(&self.scale).for_each(|(p, scale)| *p *= scale);
        for h in 0..self.hub.len() {
            product[m + h] = self.hub_row(h, x);
        }
        let a = self.linearised.active.len();
        for (local, cone) in &self.sliding {
            let (row1, row2) = (a + local, 2 * a + local);
            let (s1, s2) = cone.across(product[row1] - x[row1], product[row2] - x[row2]);
            product[row1] = s1 + x[row1] - cone.friction * cone.unit.x * x[*local];
            product[row2] = s2 + x[row2] - cone.friction * cone.unit.y * x[*local];
        }
        product
    }

    fn hub_row(&self, h: usize, x: &[f64]) -> f64 {
        self.hub[h].iter().zip(x).map(|(weight, x)| weight * x).sum()
    }
}

/// An approximate inverse of the products: direction by direction, sliding points without what their friction turns.
struct Inverse<'a> {
    products: &'a Products<'a>,
    normal: SymmetricFactor,
    /// Places among the active points of those that stick.
    sticking: Vec<usize>,
    /// Of these, by tangential direction.
    tangential: Vec<SymmetricFactor>,
    /// Solutions for the hub's columns.
    hub: Vec<Vec<f64>>,
    /// The hub's rows of these.
    reduced: Option<DenseFactor>,
}

impl<'a> Inverse<'a> {
    fn new(products: &'a Products<'a>) -> Self {
        let Linearised { state, modes, active, along, hub_unit, .. } = products.linearised;
        let a = active.len();
        let factor = |places: &[usize], direction: usize| {
            let rows: Vec<usize> = places.iter().map(|local| direction * a + local).collect();
            SymmetricFactor::new(products.compliance.block(&rows))
        };
        let all: Vec<usize> = (0..a).collect();
        let sticks = |local: &usize| state.directions == 3 && modes[active[*local]] != PointMode::Slip;
        let sticking: Vec<usize> = all.iter().copied().filter(sticks).collect();
        let tangential =
            if sticking.is_empty() { Vec::new() } else { vec![factor(&sticking, 1), factor(&sticking, 2)] };
        let normal = factor(&all, 0);
        let mut inverse = Self { products, normal, sticking, tangential, hub: Vec::new(), reduced: None };
        for mut column in products.linearised.motions(along) {
            column.iter_mut().for_each(|value| *value *= hub_unit);
            inverse.hub.push(inverse.of(&column));
        }
        if !along.is_empty() {
            let k = along.len();
            let reduced = Mat::from_fn(k, k, |h, l| products.hub_row(h, &inverse.hub[l]));
            inverse.reduced = Some(DenseFactor::new(reduced));
        }
        inverse
    }

    fn of(&self, residual: &[f64]) -> Vec<f64> {
        let Products { linearised, scale, sliding, .. } = self.products;
        let (a, m) = (linearised.active.len(), scale.len());
        let mut x = residual.to_vec();
        x[..a].iter_mut().zip(scale).for_each(|(x, scale)| *x /= scale);
        self.normal.solve(&mut x[..a]);
        let mut values = vec![0.0; self.sticking.len()];
        for (d, factor) in self.tangential.iter().enumerate() {
            let first = (d + 1) * a;
            let places = self.sticking.iter().map(|local| first + local);
            values.iter_mut().zip(places.clone()).for_each(|(v, row)| *v = residual[row] / scale[row]);
            factor.solve(&mut values);
            places.zip(&values).for_each(|(row, value)| x[row] = *value);
        }
        for (local, cone) in sliding {
            x[a + local] += cone.friction * cone.unit.x * x[*local];
            x[2 * a + local] += cone.friction * cone.unit.y * x[*local];
        }
        if let Some(reduced) = &self.reduced {
            let mut hub: Vec<f64> =
                (0..self.hub.len()).map(|h| self.products.hub_row(h, &x) - residual[m + h]).collect();
            reduced.solve(&mut hub);
            for (h, solution) in hub.iter().zip(&self.hub) {
                x.iter_mut().zip(solution).for_each(|(x, s)| *x -= h * s);
            }
            x[m..].copy_from_slice(&hub);
        }
        x
    }
}

/// Solution of `product(x) = side` to a residual of `tolerance` times `side`, with the approximate `inverse`; `None` where it does
/// not settle.
fn gmres(
    side: &[f64],
    tolerance: f64,
    product: impl Fn(&[f64]) -> Vec<f64>,
    inverse: impl Fn(&[f64]) -> Vec<f64>,
) -> Option<Vec<f64>> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let size = dot(side, side).sqrt();
    if size == 0.0 {
        return Some(vec![0.0; side.len()]);
    }
    let mut basis: Vec<Vec<f64>> = vec![side.iter().map(|v| v / size).collect()];
    let mut searched: Vec<Vec<f64>> = Vec::new();
    // columns of the triangle, rotations, and the rotated right-hand side
    let (mut triangle, mut rotations, mut rotated) =
        (Vec::<Vec<f64>>::new(), Vec::<(f64, f64)>::new(), vec![size]);
    for step in 0..LIMIT {
        let direction = inverse(&basis[step]);
        let mut next = product(&direction);
        searched.push(direction);
        let mut column = Vec::with_capacity(step + 2);
        for known in &basis {
            let part = dot(known, &next);
            next.iter_mut().zip(known).for_each(|(n, k)| *n -= part * k);
            column.push(part);
        }
        let rest = dot(&next, &next).sqrt();
        for (i, (c, s)) in rotations.iter().enumerate() {
            (column[i], column[i + 1]) =
                (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
        }
        let length = column[step].hypot(rest);
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        let (c, s) = (column[step] / length, rest / length);
        rotations.push((c, s));
        column[step] = length;
        triangle.push(column);
        rotated.push(-s * rotated[step]);
        rotated[step] *= c;
        if rotated[step + 1].abs() <= tolerance * size {
            let mut weights = rotated[..=step].to_vec();
            for i in (0..=step).rev() {
                weights[i] /= triangle[i][i];
                for k in 0..i {
                    weights[k] -= triangle[i][k] * weights[i];
                }
            }
            let mut x = vec![0.0; side.len()];
            for (direction, weight) in searched.iter().zip(weights) {
                x.iter_mut().zip(direction).for_each(|(x, d)| *x += weight * d);
            }
            return x.iter().all(|v| v.is_finite()).then_some(x);
        }
        basis.push(next.iter().map(|v| v / rest).collect());
    }
    None
}
