//! The wheel pressed on the rail: static equilibrium under a wanted load.

use crate::contact::{
    BodyCompliance, ContactPoints, PairingLimits, PenaltySprings, Problem, Side, Solution, Surface, pair,
    solve, total,
};
use crate::error::{Error, InputError, NumericsError, Result, StopReason};
use crate::field::InputField;
use crate::superelement::{Superelement, times};
use faer::Mat;
use nalgebra::Vector2;

/// How the contact conditions are enforced.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Enforcement {
    /// No penetration at all.
    Exact,
    /// A spring at every contact node, N/m (published: 1e9).
    Penalty(f64),
}

impl Enforcement {
    /// Compliance at `points` of both bodies, given at their contact nodes, and of the penalty springs if there are any.
    pub(crate) fn compliance(
        self,
        rail: &Mat<f64>,
        wheel: &Mat<f64>,
        points: &ContactPoints,
        directions: usize,
    ) -> Mat<f64> {
        let rail = BodyCompliance { compliance: rail, side: Side::Base };
        let wheel = BodyCompliance { compliance: wheel, side: Side::Opposing };
        match self {
            Self::Exact => total(&[&rail, &wheel], points, directions),
            Self::Penalty(stiffness) => {
                total(&[&rail, &wheel, &PenaltySprings { stiffness }], points, directions)
            }
        }
    }
}

/// A wheel above a rail, both condensed.
pub struct WheelOnRail<'a> {
    /// Compliance of the rail's contact nodes (`3·node + axis`), m/N: against its supports, or against its own section
    /// ([`super::SectionMotion::relative`]).
    pub rail: &'a Mat<f64>,
    /// Compliance of the wheel's contact nodes against its hub, m/N.
    pub wheel: &'a Mat<f64>,
    /// Contact surface of the rail, at rest.
    pub rail_surface: Surface<'a>,
    /// Contact surface of the wheel; its origin is the just-touching position.
    pub wheel_surface: Surface<'a>,
    /// Coulomb friction coefficient; 0 leaves friction out.
    pub friction: f64,
    /// How the contact conditions are enforced.
    pub enforcement: Enforcement,
}

/// Equilibrium under one load.
pub struct Pressed {
    /// Vertical load, N.
    pub load: f64,
    /// Displacement of the wheel's hub from just touching (y, z), m.
    pub hub: Vector2<f64>,
    /// Contact points at the final position.
    pub points: ContactPoints,
    /// Their compliance.
    pub compliance: Mat<f64>,
    /// Gaps and slips without contact forces.
    pub free: Vec<f64>,
    /// Forces and modes.
    pub solution: Solution,
    /// Displacements of the contact nodes relative to the bodies' supports, m.
    rail_displacement: Vec<f64>,
    wheel_displacement: Vec<f64>,
}

/// Points farther apart than this after loading are no candidates, m: rounding of the pairing
/// plus the bulging beside a patch.
const CANDIDATE_MARGIN: f64 = 20e-6;
/// The hub is found when pairing it again moves it by less, m.
const HUB_TOLERANCE: f64 = 1e-10;
const PAIRING_LIMIT: usize = 25;

impl WheelOnRail<'_> {
    /// Directions a point: 1 without friction, else 3.
    pub fn directions(&self) -> usize {
        if self.friction > 0.0 { 3 } else { 1 }
    }

    /// Compliance of both bodies and the penalty springs at `points`.
    pub fn compliance(&self, points: &ContactPoints, directions: usize) -> Mat<f64> {
        self.enforcement.compliance(self.rail, self.wheel, points, directions)
    }

    /// Contact points with the hub displaced by `hub` from just touching.
    pub fn points_at(&self, hub: &Vector2<f64>, largest_gap: f64) -> ContactPoints {
        let mut wheel = self.wheel_surface.clone();
        wheel.origin += hub;
        pair(&self.rail_surface, &wheel, PairingLimits { largest_gap })
    }

    /// Presses the wheel with the vertical `load` (N, > 0), the hub held laterally; `before` is the state
    /// the load grew from, for friction and as a start.
    ///
    /// # Errors
    /// [`InputError`] for a load that is not positive or that the meshed contact zone cannot carry;
    /// [`NumericsError`] if the iteration does not settle.
    pub fn press(&self, load: f64, before: Option<&Pressed>) -> Result<Pressed> {
        if !(load > 0.0 && load.is_finite()) {
            return Err(refused_load(load, "a positive load").into());
        }
        let directions = self.directions();
        let mut hub =
            before.map_or(Vector2::zeros(), |b| Vector2::new(b.hub.x, b.hub.y * (load / b.load).powf(0.75)));
        let mut largest_gap = 0.15e-3;
        let mut moved = f64::NAN;
        let mut active = 0;
        let mut previous: Option<(ContactPoints, Solution)> = None;
        for _ in 0..PAIRING_LIMIT {
            let points = self.points_at(&hub, largest_gap);
            if points.is_empty() {
                return Err(refused_load(load, "a load under which wheel and rail touch").into());
            }
            let compliance = self.compliance(&points, directions);
            let mut free = points.gap.clone();
            free.resize(directions * points.len(), 0.0);
            if directions == 3 {
                self.add_slip_since(before, &points, &hub, &mut free);
            }
            let start = match (&previous, before) {
                (Some((p, s)), _) => carry_over(p, &s.forces, &points, directions),
                (None, Some(b)) => carry_over(&b.points, &b.solution.forces, &points, directions),
                (None, None) => vec![0.0; free.len()],
            };
            let wanted = [(2, -load)];
            let problem = Problem {
                points: &points,
                compliance: &compliance,
                free: &free,
                friction: self.friction,
                hub: &wanted,
            };
            let solution = solve(&problem, &start).map_err(|e| at_load(e, load))?;
            hub.y += solution.hub[0];
            moved = solution.hub[0].abs();
            active = solution.active();
            if moved < HUB_TOLERANCE {
                if (0..points.len()).any(|j| points.at_edge[j] && solution.forces[j] > 0.0) {
                    return Err(refused_load(
                        load,
                        "a load whose contact patch stays inside the meshed contact zone",
                    )
                    .into());
                }
                let of = |body: &Mat<f64>, side| {
                    times(body, &points.nodal_forces(side, &solution.forces, body.nrows()))
                };
                let rail_displacement = of(self.rail, Side::Base);
                let wheel_displacement = of(self.wheel, Side::Opposing);
                return Ok(Pressed {
                    load,
                    hub,
                    points,
                    compliance,
                    free,
                    solution,
                    rail_displacement,
                    wheel_displacement,
                });
            }
            // the approach lies mostly in the bodies: what overlaps rigidly now covers the patch
            largest_gap = CANDIDATE_MARGIN;
            previous = Some((points, solution));
        }
        Err(NumericsError {
            stage: format!("pairing of the contact surfaces at {:.3} kN", load * 1e-3),
            step: None,
            iteration: PAIRING_LIMIT,
            residual: moved,
            active,
            reason: StopReason::IterationLimit,
        }
        .into())
    }

    /// Adds the tangential motion with the hub at `hub` since the state `before`, or since just touching; the contact
    /// forces add theirs.
    fn add_slip_since(
        &self,
        before: Option<&Pressed>,
        points: &ContactPoints,
        hub: &Vector2<f64>,
        free: &mut [f64],
    ) {
        let n = points.len();
        let moved = hub - before.map_or(Vector2::zeros(), |b| b.hub);
        for row in n..3 * n {
            let (j, d) = (row % n, row / n);
            let direction = points.direction(j, d);
            free[row] += direction.y * moved.x + direction.z * moved.y;
            if let Some(before) = before {
                let elastic = |weights, u: &[f64]| -> f64 {
                    ContactPoints::row(weights, d).map(|(i, w)| w * u[i]).sum()
                };
                free[row] -= elastic(&points.opposing[j], &before.wheel_displacement);
                free[row] += elastic(&points.base[j], &before.rail_displacement);
            }
        }
    }
}

impl Pressed {
    /// The contact problem at this state, for linearisation.
    pub fn problem<'b>(&'b self, friction: f64) -> Problem<'b> {
        Problem { points: &self.points, compliance: &self.compliance, free: &self.free, friction, hub: &[] }
    }

    /// Forces on the retained equations of one body, N.
    pub fn body_forces(&self, side: Side, body: &Superelement) -> Vec<f64> {
        self.points.nodal_forces(side, &self.solution.forces, body.compliance.nrows())
    }
}

/// Forces of the points that both sets share, zero for the others.
pub(crate) fn carry_over(
    from: &ContactPoints,
    forces: &[f64],
    to: &ContactPoints,
    directions: usize,
) -> Vec<f64> {
    let mut start = vec![0.0; directions * to.len()];
    // both sets are sorted by grid index
    let mut i = 0;
    for (j, index) in to.index.iter().enumerate() {
        while i < from.len() && from.index[i] < *index {
            i += 1;
        }
        if i < from.len() && from.index[i] == *index {
            for d in 0..directions {
                start[d * to.len() + j] = forces[d * from.len() + i];
            }
        }
    }
    start
}

fn refused_load(load: f64, expected: &str) -> InputError {
    InputError::new(
        InputField::Loads,
        format!("{:.4} kN", load * 1e-3),
        expected,
        "choose a smaller load, or widen `window_half_length` and the fine zones",
    )
}

fn at_load(error: Error, load: f64) -> Error {
    match error {
        Error::Numerics(mut e) => {
            e.stage = format!("{} at {:.3} kN", e.stage, load * 1e-3);
            e.into()
        }
        other => other,
    }
}
