//! Newton steps by products with the compliance, for more rows than are worth a dense factor.
//!
//! The directions of contact are weakly coupled (normal and tangential ones not at all on half-spaces of one material), so the approximate
//! inverse has a dense factor for each of them, at a twenty-seventh of the work of one for all. They serve for steps that follow, as long as
//! nearly the same points carry load. Many points have no factor, whose memory goes with their square, but the inverse of the half-spaces as on
//! an endless grid (E.A.H. Vollebregt, "A new solver for the elastic normal contact problem using conjugate gradients, deflation, and an
//! FFT-based preconditioner", J. Comput. Phys. 257 (2014)), with which it takes more products.

use super::dense::{DenseFactor, SymmetricFactor};
use super::gmres::{Wanted, gmres};
use super::operator::ComplianceOperator;
use super::state::{PointMode, State};
use faer::Mat;
use nalgebra::{Vector2, Vector3};

/// Rows from which products are faster than a dense factor.
const ROWS: usize = 100;
/// Products at most, before a dense factor takes over.
const LIMIT: usize = 60;
/// Points that have a dense factor at most: its square has 36 MB for each direction.
const FACTORED: usize = 3000;
/// Products at most with more points.
const LIMIT_WITHOUT: usize = 300;
/// A factor serves for rows of which at most one in so many is not its own, or is only its own.
const CHANGED: usize = 12;

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
        directions.iter().map(|along| self.motion(|row| self.state.hub_weight(row, along))).collect()
    }

    /// The same of one motion by the `rates` of all separations.
    pub fn motion(&self, rates: impl Fn(usize) -> f64) -> Vec<f64> {
        let a = self.active.len();
        let mut column: Vec<f64> = self.rows.iter().map(|&row| self.state.scale[row] * rates(row)).collect();
        for (local, cone) in self.sliding() {
            let (row1, row2) = (a + local, 2 * a + local);
            (column[row1], column[row2]) = cone.across(column[row1], column[row2]);
        }
        column
    }

    /// Solutions for right-hand sides as long as rows and hub directions, to a residual of `tolerance` times these; `None` where this way is not worth it or does not
    /// come at least to `enough` times these. The `factors` are of steps before, and are for those that follow.
    pub fn solve(
        &self,
        sides: &[Vec<f64>],
        tolerance: f64,
        enough: f64,
        factors: &mut Factors,
    ) -> Option<Vec<Vec<f64>>> {
        if self.rows.len() < ROWS {
            return None;
        }
        let products = Products::new(self)?;
        let most = if self.active.len() > factors.most { LIMIT_WITHOUT } else { LIMIT };
        let wanted = Wanted { tolerance, enough, products: most };
        let solutions = |factors: &mut Factors| -> Option<Vec<Vec<f64>>> {
            let inverse = Inverse::new(&products, factors);
            sides.iter().map(|side| gmres(side, wanted, |x| products.of(x), |r| inverse.of(r))).collect()
        };
        solutions(factors).or_else(|| {
            // new factors may do what those of steps before do not
            *factors = Factors { most: factors.most, ..Factors::default() };
            solutions(factors)
        })
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

/// Dense factors by direction, which serve while nearly the same points of a grid carry load: from step to step of an iteration, and from
/// one problem to the next that is little different.
pub struct Factors {
    /// Spacings of the grid, m.
    cell: Vector2<f64>,
    by_direction: [Option<Factored>; 3],
    /// Points at most that have factors.
    most: usize,
}

impl Default for Factors {
    fn default() -> Self {
        Self { cell: Vector2::zeros(), by_direction: [const { None }; 3], most: FACTORED }
    }
}

/// The factor of one direction's compliance between some points.
struct Factored {
    /// Their places on the grid, ascending.
    points: Vec<(usize, usize)>,
    factor: SymmetricFactor,
}

impl Factored {
    /// Whether the factor is nearly that of `points` (ascending).
    fn serves(&self, points: &[(usize, usize)]) -> bool {
        let own = points.iter().filter(|point| self.points.binary_search(point).is_ok()).count();
        CHANGED * (self.points.len() + points.len() - 2 * own) <= points.len()
    }
}

/// An approximate inverse of the products: direction by direction, sliding points without what their friction turns, and points that
/// a factor does not have each by itself.
struct Inverse<'a> {
    products: &'a Products<'a>,
    blocks: Vec<Block<'a>>,
    /// Solutions for the hub's columns.
    hub: Vec<Vec<f64>>,
    /// The hub's rows of these.
    reduced: Option<DenseFactor>,
}

/// One direction of an approximate inverse, with rows of the products.
enum Block<'a> {
    /// A factor, and the rows that its own are among those of the products.
    Factored(&'a SymmetricFactor, Vec<Option<usize>>),
    /// The half-spaces on the grid in a direction, and the rows that count.
    OnGrid(&'a dyn ComplianceOperator, usize, Vec<usize>),
}

impl Block<'_> {
    /// Enters what it makes of a `residual`, whose rows are divided by `scale`, of so many points in each direction.
    fn enter(&self, residual: &[f64], scale: &[f64], points: usize, x: &mut [f64]) {
        match self {
            Self::Factored(factor, rows) => {
                let mut values: Vec<f64> =
                    rows.iter().map(|row| row.map_or(0.0, |row| residual[row] / scale[row])).collect();
                factor.solve(&mut values);
                let known = rows.iter().zip(values).filter_map(|(row, value)| Some(((*row)?, value)));
                known.for_each(|(row, value)| x[row] = value);
            }
            Self::OnGrid(compliance, direction, rows) => {
                let mut values = vec![0.0; points];
                rows.iter().for_each(|row| values[row - direction * points] = residual[*row] / scale[*row]);
                let Some(forces) = compliance.nearly_inverse(*direction, &values) else { return };
                rows.iter().for_each(|row| x[*row] = forces[row - direction * points]);
            }
        }
    }
}

impl<'a> Inverse<'a> {
    fn new(products: &'a Products<'a>, factors: &'a mut Factors) -> Self {
        let Linearised { state, modes, active, along, hub_unit, .. } = products.linearised;
        let a = active.len();
        let sticking: Vec<usize> = active.iter().copied().filter(|j| modes[*j] != PointMode::Slip).collect();
        let directions = if sticking.is_empty() { 1 } else { state.directions };
        let cell = state.problem.points[active[0]].widths;
        if factors.cell != cell {
            *factors = Factors { cell, most: factors.most, ..Factors::default() };
        }
        let place = |j: &usize| state.problem.points[*j].index;
        let (active, sticking): (Vec<_>, Vec<_>) =
            (active.iter().map(place).collect(), sticking.iter().map(place).collect());
        let most = factors.most;
        let mut blocks = Vec::new();
        for (direction, known) in factors.by_direction.iter_mut().enumerate().take(directions) {
            let points = if direction == 0 { &active } else { &sticking };
            let row = |point: &(usize, usize)| {
                points.binary_search(point).ok()?;
                active.binary_search(point).ok().map(|local| direction * a + local)
            };
            if points.len() > most {
                let rows = points.iter().filter_map(row).collect();
                blocks.push(Block::OnGrid(&*products.compliance, direction, rows));
                continue;
            }
            if !known.as_ref().is_some_and(|known| known.serves(points)) {
                let rows: Vec<usize> = points.iter().filter_map(row).collect();
                let factor = SymmetricFactor::new(|| products.compliance.block(&rows));
                *known = Some(Factored { points: points.clone(), factor });
            }
            let Some(Factored { points, factor }) = known else { continue };
            blocks.push(Block::Factored(factor, points.iter().map(row).collect()));
        }
        let mut inverse = Self { products, blocks, hub: Vec::new(), reduced: None };
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
        self.blocks.iter().for_each(|block| block.enter(residual, scale, a, &mut x));
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

#[cfg(test)]
mod tests {
    use super::super::state::Problem;
    use super::super::{HalfSpace, NearField, flat_grid, gaps};
    use super::*;
    use crate::solid::Material;

    /// Goal: factors of other points than those that carry load now lead to the solution of new ones, N; they are kept where one row
    /// in twelve differs, made anew where more do, and where they lead nowhere; without factors the solution is the same. Some points slide, and the materials couple the directions.
    /// Accuracy over the largest: SOLVER.
    #[test]
    fn factors_of_other_points_lead_to_the_same_solution() {
        /// Residual of the solutions over their right-hand side, and what rows of unlike size make of it.
        const SOLVER: f64 = 1e-12;
        const SOLUTION: f64 = 1e-9;
        let points = flat_grid((15, 15), 0.5e-3, |s, x| 0.5 * (s * s + x * x) / 0.3);
        let n = points.len();
        let [wheel, rail] = HalfSpace::both(&Material::STEEL);
        let rail = HalfSpace { poisson: 0.2, ..rail };
        let compliance = NearField::new(&[wheel, rail], &points, 3);
        let free: Vec<f64> =
            gaps(&points).into_iter().chain((n..3 * n).map(|r| 1e-6 * (r % 7) as f64)).collect();
        let problem =
            Problem { points: &points, compliance: &compliance, free: &free, friction: 0.3, hub: &[] };
        let mut forces = vec![0.0; 3 * n];
        (0..n).for_each(|j| forces[j] = 100.0 + (j % 3) as f64);
        let mut state = State::new(&problem, &forces);
        state.update_separation();
        let solve = |radius: f64, factors: &mut Factors| {
            let place = |j: usize| points[j].position.coords.norm();
            let modes: Vec<PointMode> = (0..n)
                .map(|j| match place(j) {
                    at if at > radius => PointMode::Open,
                    at if at > 0.8 * radius => PointMode::Slip,
                    _ => PointMode::Stick,
                })
                .collect();
            let active: Vec<usize> = (0..n).filter(|&j| modes[j] != PointMode::Open).collect();
            let rows: Vec<usize> = (0..3).flat_map(|d| active.iter().map(move |j| d * n + j)).collect();
            let side: Vec<f64> = rows.iter().map(|row| 1.0 + (row % 5) as f64).collect();
            let linearised = Linearised {
                state: &state,
                modes: &modes,
                active: &active,
                rows: &rows,
                along: &[],
                hub_unit: 0.0,
            };
            linearised.solve(&[side], SOLVER, SOLVER, factors).unwrap().remove(0)
        };
        let size = |factors: &Factors| factors.by_direction[0].as_ref().map(|known| known.points.len());
        // without factors, by the inverse on an endless grid
        let mut without = Factors { most: 0, ..Factors::default() };
        let (found, exact) = (solve(3.0e-3, &mut without), solve(3.0e-3, &mut Factors::default()));
        let largest = exact.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        assert!(size(&without).is_none());
        assert!(found.iter().zip(&exact).all(|(a, b)| (a - b).abs() < SOLUTION * largest));
        let mut factors = Factors::default();
        solve(3.0e-3, &mut factors);
        let first = size(&factors);
        for (radius, kept) in [(3.0e-3, true), (3.05e-3, true), (2.5e-3, false)] {
            let before = size(&factors);
            let found = solve(radius, &mut factors);
            assert_eq!(size(&factors) == before, kept, "{radius}: {before:?} {:?}", size(&factors));
            let exact = solve(radius, &mut Factors::default());
            let largest = exact.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            for (a, b) in found.iter().zip(&exact) {
                assert!((a - b).abs() < SOLUTION * largest, "{radius}: {a} {b}");
            }
        }
        // a factor of another matrix leads nowhere within the products that are left
        let mut wrong = Factors::default();
        solve(3.0e-3, &mut wrong);
        assert_eq!(size(&wrong), first);
        let matrix = Mat::from_fn(first.unwrap(), first.unwrap(), |r, c| {
            if r == c { 1.0 + 1e6 * (r % 9) as f64 } else { 0.0 }
        });
        wrong.by_direction[0].as_mut().unwrap().factor = SymmetricFactor::new(|| matrix.clone());
        let mut new = Factors::default();
        let (found, exact) = (solve(3.0e-3, &mut wrong), solve(3.0e-3, &mut new));
        let applied = |factors: &Factors| {
            let mut values = vec![1.0; first.unwrap()];
            factors.by_direction[0].as_ref().unwrap().factor.solve(&mut values);
            values
        };
        assert_eq!(applied(&wrong), applied(&new));
        let largest = exact.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        assert!(found.iter().zip(&exact).all(|(a, b)| (a - b).abs() < SOLUTION * largest));
    }
}
