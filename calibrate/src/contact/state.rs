//! A contact problem, and the forces and the hub on the way to its solution.

use super::operator::ComplianceOperator;
use super::point::ContactPoint;
use faer::Mat;
use nalgebra::{Unit, Vector2, Vector3};

/// State of one contact point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointMode {
    /// No force.
    Open,
    /// Force inside the friction cone.
    Stick,
    /// Force on the friction cone.
    Slip,
}

/// A contact problem on condensed bodies.
pub struct Problem<'a> {
    /// The points (their directions are needed for the hub).
    pub points: &'a [ContactPoint],
    /// Compliance, `direction·points + point`; one direction without friction, else three, m/N.
    pub compliance: &'a dyn ComplianceOperator,
    /// Gap (and slip since the last state) of every row without contact forces, m.
    pub free: &'a [f64],
    /// Coulomb friction coefficient; ignored with one direction.
    pub friction: f64,
    /// The directions in which the hub is free. Empty when the compliance already contains the hub.
    pub hub: &'a [FreeDirection],
}

impl Problem<'_> {
    /// Whether products with the compliance of some points take much less time than its values.
    pub(super) fn has_products(&self) -> bool {
        self.compliance.among(&[]).is_some()
    }
}

/// A direction in which the wheel's hub is free to move, and what is wanted of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeDirection {
    /// The direction in world axes. Several need not be perpendicular, but none may follow from the others.
    pub along: Unit<Vector3<f64>>,
    /// Component along it of the contact force on the opposing body, N.
    pub force: f64,
}

/// Forces that satisfy the contact conditions.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Contact forces on the opposing body, `direction·points + point`, N; normal ones are not negative.
    pub forces: Vec<f64>,
    /// Gap and slip of every row, m.
    pub separation: Vec<f64>,
    /// State of every point.
    pub modes: Vec<PointMode>,
    /// Hub displacement by free direction, m: the hub has moved by the sum of these along their directions.
    pub hub: Vec<f64>,
    /// Newton iterations used.
    pub iterations: usize,
}

impl Solution {
    /// Number of points that carry load.
    pub fn active(&self) -> usize {
        self.modes.iter().filter(|m| **m != PointMode::Open).count()
    }
}

/// Forces and hub during the iteration, with the separation that belongs to them.
#[derive(Clone)]
pub(super) struct State<'a> {
    pub problem: &'a Problem<'a>,
    pub directions: usize,
    pub forces: Vec<f64>,
    pub hub: Vec<f64>,
    pub separation: Vec<f64>,
    /// Scales that turn metres into newtons, by row: the stiffness of the point alone, the same for both tangents.
    pub scale: Vec<f64>,
}

/// How far a state is from the conditions of contact.
pub(super) struct Residual {
    /// By row, N: force minus projected trial force.
    pub rows: Vec<f64>,
    /// By free direction of the hub, N: carried minus wanted force.
    pub hub: Vec<f64>,
    /// Largest of both over the largest force.
    pub relative: f64,
    /// What rounding of the separations alone leaves of it.
    pub roundoff: f64,
}

impl Residual {
    /// Sum of squares, N².
    pub fn squared(&self) -> f64 {
        self.rows.iter().chain(&self.hub).map(|r| r * r).sum()
    }
}

impl<'a> State<'a> {
    pub fn new(problem: &'a Problem, start: &[f64]) -> Self {
        let count = problem.points.len();
        let mut state = Self::with_separation(problem, start, vec![0.0; problem.free.len()]);
        state.update_separation();
        if !problem.hub.is_empty() && (0..count).all(|j| state.mode(j) == PointMode::Open) {
            state.touch_down();
            state.update_separation();
        }
        state
    }

    /// As [`Self::new`], with the `separation` under the forces of the `start` and the hub at rest.
    pub fn with_separation(problem: &'a Problem, start: &[f64], separation: Vec<f64>) -> Self {
        let (rows, count) = (problem.free.len(), problem.points.len());
        assert_eq!(problem.compliance.rows(), rows);
        assert_eq!(start.len(), rows);
        assert_eq!(separation.len(), rows);
        let directions = rows.checked_div(count).unwrap_or(1);
        Self {
            problem,
            directions,
            forces: start.to_vec(),
            hub: vec![0.0; problem.hub.len()],
            separation,
            scale: scales(problem.compliance, count, directions),
        }
    }

    /// Where the start presses no point, moves the hub along its first free direction until the nearest one overlaps a little.
    fn touch_down(&mut self) {
        let count = self.problem.points.len();
        let FreeDirection { along, force } = self.problem.hub[0];
        let reach = (0..count)
            .filter_map(|j| {
                let slope = self.hub_weight(j, &along);
                (slope * force > 0.0).then(|| self.separation[j] / slope)
            })
            .min_by(|a, b| a.abs().total_cmp(&b.abs()));
        if let Some(reach) = reach {
            // the wheel moves against the contact force by the gap and the overlap of a light load
            let mean = self.scale.iter().sum::<f64>() / self.scale.len() as f64;
            let overlap = force.abs() / (mean * (count as f64).sqrt());
            self.hub[0] = -reach - overlap.min(2e-5) * force.signum();
        }
    }

    /// Component of the direction of `row` along that of the hub: what the row's separation changes by where the hub
    /// moves by one.
    pub fn hub_weight(&self, row: usize, along: &Vector3<f64>) -> f64 {
        let count = self.problem.points.len();
        self.problem.points[row % count].direction(row / count).dot(along)
    }

    /// What the hub moved by `hub` in its free directions does to the separation of a row.
    pub fn moved_by_hub(&self, row: usize, hub: &[f64]) -> f64 {
        let ways = self.problem.hub.iter().zip(hub);
        ways.map(|(free, way)| self.hub_weight(row, &free.along) * way).sum()
    }

    /// What the forces and the hub do to the separations, without the free ones.
    pub fn motion(&self, forces: &[f64], hub: &[f64]) -> Vec<f64> {
        let mut motion = vec![0.0; forces.len()];
        self.problem.compliance.add_product(forces, &mut motion);
        motion.iter_mut().enumerate().for_each(|(row, s)| *s += self.moved_by_hub(row, hub));
        motion
    }

    /// Change of the separations of `rows` by the forces of these rows and, in further columns, by hub motions along
    /// `directions`, as forces, and `spare` empty rows below.
    pub fn linearised(&self, rows: &[usize], directions: &[Vector3<f64>], spare: usize) -> Mat<f64> {
        let m = rows.len();
        let block = self.problem.compliance.block(rows);
        let mut matrix = Mat::zeros(m + spare, m + directions.len());
        for c in 0..m {
            let values = block.col_as_slice(c).iter().zip(rows);
            let column = matrix.col_as_slice_mut(c);
            column.iter_mut().zip(values).for_each(|(v, (b, &row))| *v = self.scale[row] * b);
        }
        for (h, along) in directions.iter().enumerate() {
            for (r, &row) in rows.iter().enumerate() {
                matrix[(r, m + h)] = self.scale[row] * self.hub_weight(row, along);
            }
        }
        matrix
    }

    pub fn update_separation(&mut self) {
        self.separation = self.motion(&self.forces, &self.hub);
        self.separation.iter_mut().zip(self.problem.free).for_each(|(s, f)| *s += f);
    }

    /// Component of the contact force along a direction of the hub, N.
    pub fn carried(&self, along: &Vector3<f64>) -> f64 {
        (0..self.forces.len()).map(|row| self.hub_weight(row, along) * self.forces[row]).sum()
    }

    /// Trial normal force of point `j`, N: what it carries if it is positive.
    fn pressure(&self, j: usize) -> f64 {
        self.forces[j] - self.scale[j] * self.separation[j]
    }

    /// Friction bound and trial tangential force of point `j`.
    pub fn trial(&self, j: usize) -> (f64, Vector2<f64>) {
        let n = self.problem.points.len();
        let trial = |d: usize| {
            let row = d * n + j;
            self.forces[row] - self.scale[row] * self.separation[row]
        };
        (self.problem.friction * self.pressure(j).max(0.0), Vector2::new(trial(1), trial(2)))
    }

    pub fn mode(&self, j: usize) -> PointMode {
        if self.pressure(j) <= 0.0 {
            PointMode::Open
        } else if self.directions == 1 {
            PointMode::Stick
        } else if self.problem.friction == 0.0 {
            PointMode::Slip
        } else {
            let (bound, trial) = self.trial(j);
            if trial.norm() <= bound { PointMode::Stick } else { PointMode::Slip }
        }
    }

    pub fn modes(&self) -> Vec<PointMode> {
        (0..self.problem.points.len()).map(|j| self.mode(j)).collect()
    }

    pub fn residual(&self) -> Residual {
        let n = self.problem.points.len();
        let mut projected = vec![0.0; self.forces.len()];
        for j in 0..n {
            projected[j] = self.pressure(j).max(0.0);
            if self.directions == 3 {
                let (bound, trial) = self.trial(j);
                let length = trial.norm();
                let shrink = if length > bound { bound / length } else { 1.0 };
                projected[n + j] = shrink * trial.x;
                projected[2 * n + j] = shrink * trial.y;
            }
        }
        let rows: Vec<f64> = self.forces.iter().zip(&projected).map(|(f, p)| f - p).collect();
        let hub: Vec<f64> =
            self.problem.hub.iter().map(|free| self.carried(&free.along) - free.force).collect();
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let wanted = self.problem.hub.iter().fold(0.0_f64, |m, h| m.max(h.force.abs()));
        let size = largest(&self.forces).max(largest(&projected)).max(wanted);
        let over = |value: f64| if value == 0.0 { 0.0 } else { value / size };
        // the separation is a sum of free gap, elastic displacement and hub motion, all of the free gap's size
        let lengths = largest(self.problem.free) + largest(&self.hub);
        let roundoff = over(ROUNDOFF * largest(&self.scale) * lengths);
        let relative = over(largest(&rows).max(largest(&hub)));
        // `max` passes over what is not a number, which is no small residual
        let finite = rows.iter().chain(&hub).all(|r| r.is_finite());
        Residual { relative: if finite { relative } else { f64::INFINITY }, roundoff, rows, hub }
    }

    /// The answer, once the residual is small: what a point carries that is open or pulls is below the tolerance.
    pub fn solution(&self, iterations: usize) -> Solution {
        let n = self.problem.points.len();
        let modes = self.modes();
        let mut forces = self.forces.clone();
        for j in 0..n {
            forces[j] = forces[j].max(0.0);
            if modes[j] == PointMode::Open {
                (0..self.directions).for_each(|d| forces[d * n + j] = 0.0);
            }
        }
        Solution { forces, separation: self.separation.clone(), modes, hub: self.hub.clone(), iterations }
    }
}

/// Rounding of a sum of separations, in units of its largest term.
const ROUNDOFF: f64 = 16.0 * f64::EPSILON;

/// Stiffness of every point alone, N/m.
fn scales(compliance: &dyn ComplianceOperator, count: usize, directions: usize) -> Vec<f64> {
    let diagonal: Vec<f64> = (0..compliance.rows()).map(|row| compliance.diagonal(row)).collect();
    let mean = diagonal.iter().sum::<f64>() / diagonal.len().max(1) as f64;
    let stiffness = |c: f64| 1.0 / if c > 0.0 { c } else { mean.max(f64::MIN_POSITIVE) };
    let mut scale: Vec<f64> = diagonal.iter().map(|c| stiffness(*c)).collect();
    if directions == 3 {
        for j in 0..count {
            let (a, b) = (count + j, 2 * count + j);
            scale[a] = stiffness(0.5 * (diagonal[a] + diagonal[b]));
            scale[b] = scale[a];
        }
    }
    scale
}
