//! The wheel pressed on the rail: static equilibrium under a wanted load.

use crate::contact::{
    BodyCompliance, ContactPoint, FreeDirection, PairingLimits, PenaltySprings, Problem, Side, Solution,
    Surface, gaps, nodal_forces, pair, resultant, solve, total,
};
use crate::error::{Error, InputError, NumericsError, Result, StopReason};
use crate::field::InputField;
use crate::superelement::times;
use faer::Mat;
use nalgebra::{Vector2, Vector3};

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
        points: &[ContactPoint],
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
    /// ([`crate::superelement::SectionMotion::relative`]).
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
    pub points: Vec<ContactPoint>,
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

/// Rigid gap within which points are candidates while nothing is known of the elastic displacements, m.
const FIRST_GAP: f64 = 0.15e-3;
/// Rigid gap within which points are paired at all, m: bodies that roll under the load close less of it.
const PAIRING_GAP: f64 = 0.5e-3;
/// Points farther apart than this under the forces of the last pairing are no candidates, m: what the forces
/// may still change, and the bulging beside a patch.
const CANDIDATE_MARGIN: f64 = 20e-6;
/// The hub is found when pairing it again moves it by less, m.
const HUB_TOLERANCE: f64 = 1e-10;
const PAIRING_LIMIT: usize = 40;
/// Smallest factor on the step of the hub where pairings make it oscillate, and largest where they creep.
const LEAST_SHARE: f64 = 1.0 / 16.0;
const LARGEST_SHARE: f64 = 2.0;
/// Intermediate loads tried, and the least step between them, of the whole.
const LOAD_LEVELS: usize = 12;
const LEAST_RISE: f64 = 1.0 / 32.0;

/// Why the points that carry load are not all there are: the patch of `forces` reaches the end of the contact
/// window along the track (of the grid with `columns` lines; the window of the wheel, equal in angle, may end within its
/// last cells), or the end of the contact zone on a profile.
pub(crate) fn edge_reached(points: &[ContactPoint], forces: &[f64], columns: usize) -> Option<StopReason> {
    let mut reached = None;
    for (point, _) in points.iter().zip(forces).filter(|(point, force)| point.at_edge && **force > 0.0) {
        let line = point.index.1;
        if line > 1 && line + 2 < columns {
            return Some(StopReason::EdgeOfCandidates);
        }
        reached = Some(StopReason::EndOfWindow);
    }
    reached
}

impl WheelOnRail<'_> {
    /// Directions a point: 1 without friction, else 3.
    pub fn directions(&self) -> usize {
        if self.friction > 0.0 { 3 } else { 1 }
    }

    /// Compliance of both bodies and the penalty springs at `points`.
    pub fn compliance(&self, points: &[ContactPoint], directions: usize) -> Mat<f64> {
        self.enforcement.compliance(self.rail, self.wheel, points, directions)
    }

    /// Contact points with the hub displaced by `hub` from just touching.
    pub fn points_at(&self, hub: &Vector2<f64>, largest_gap: f64) -> Vec<ContactPoint> {
        let mut wheel = self.wheel_surface.clone();
        wheel.origin += hub;
        pair(&self.rail_surface, &wheel, PairingLimits { largest_gap })
    }

    /// Presses the wheel with the vertical `load` (N, > 0), the hub held laterally; `before` is the state
    /// the load grew from, for friction and as a start. Where the iteration does not settle from there, it
    /// gets starts from loads in between; slips count from `before` all the same.
    ///
    /// # Errors
    /// [`InputError`] for a load that is not positive; [`NumericsError`] if the contact reaches the end of the meshed
    /// contact zone ([`StopReason::EdgeOfCandidates`] on a profile, [`StopReason::EndOfWindow`] along the track),
    /// or if the iteration does not settle.
    pub fn press(&self, load: f64, before: Option<&Pressed>) -> Result<Pressed> {
        if !(load > 0.0 && load.is_finite()) {
            return Err(InputError::new(
                InputField::Loads,
                format!("{:.4} kN", load * 1e-3),
                "a positive load",
                "leave it out, or correct it",
            )
            .into());
        }
        let mut error = match self.settle(load, before, before) {
            Err(error) if unsettled(&error) => error,
            done => return done,
        };
        let floor = before.map_or(0.0, |b| b.load);
        let mut near: Option<Pressed> = None;
        let (mut reached, mut rise) = (0.0, 0.5);
        for _ in 0..LOAD_LEVELS {
            let part = f64::min(reached + rise, 1.0);
            let level = if part == 1.0 { load } else { floor + part * (load - floor) };
            match self.settle(level, before, near.as_ref().or(before)) {
                Ok(state) if part == 1.0 => return Ok(state),
                Ok(state) => {
                    near = Some(state);
                    reached = part;
                    rise *= 2.0;
                }
                Err(failed) if unsettled(&failed) => {
                    rise *= 0.5;
                    if rise < LEAST_RISE {
                        break;
                    }
                }
                Err(failed) => {
                    // at a smaller load the patch is inside its zone; what is wrong is reported for the wanted load
                    error = failed;
                    break;
                }
            }
        }
        Err(error)
    }

    /// Equilibrium under `load`, iterated from the state `near`; slips count from `before`.
    fn settle(&self, load: f64, before: Option<&Pressed>, near: Option<&Pressed>) -> Result<Pressed> {
        let failure = |iteration, residual, active, reason| {
            let stage = format!("contact of wheel and rail at {:.3} kN", load * 1e-3);
            Error::from(NumericsError { stage, step: None, iteration, residual, active, reason })
        };
        let directions = self.directions();
        let mut hub =
            near.map_or(Vector2::zeros(), |b| Vector2::new(b.hub.x, b.hub.y * (load / b.load).powf(0.75)));
        let (mut share, mut moved, mut active) = (1.0, 0.0_f64, 0);
        let mut previous: Option<Pressed> = None;
        for iteration in 0..PAIRING_LIMIT {
            let points = match &previous {
                // long elements on a sharp curve lie farther from the first touch
                None => [FIRST_GAP, PAIRING_GAP]
                    .map(|gap| self.points_at(&hub, gap))
                    .into_iter()
                    .find(|points| !points.is_empty())
                    .unwrap_or_default(),
                Some(last) => {
                    let mut points = self.points_at(&hub, PAIRING_GAP);
                    let keep: Vec<bool> =
                        last.gaps_at(&points).iter().map(|gap| *gap < CANDIDATE_MARGIN).collect();
                    // after a large displacement of the hub on a slope the last displacements say nothing of the new place
                    if keep.contains(&true) {
                        let mut keep = keep.into_iter();
                        points.retain(|_| keep.next().unwrap_or(false));
                    }
                    points
                }
            };
            if points.is_empty() {
                return Err(failure(iteration, f64::NAN, 0, StopReason::EdgeOfCandidates));
            }
            let compliance = self.compliance(&points, directions);
            let mut free = gaps(&points);
            free.resize(directions * points.len(), 0.0);
            if directions == 3 {
                self.add_slip_since(before, &points, &hub, &mut free);
            }
            let start = match previous.as_ref().or(near) {
                Some(p) => carry_over(&p.points, &p.solution.forces, &points, directions),
                None => vec![0.0; free.len()],
            };
            let wanted = [FreeDirection { along: Vector3::z_axis(), force: -load }];
            let problem = Problem {
                points: &points,
                compliance: &compliance,
                free: &free,
                friction: self.friction,
                hub: &wanted,
            };
            let solution = solve(&problem, &start).map_err(|e| at_load(e, load))?;
            let way = solution.hub[0];
            if moved != 0.0 && way != moved {
                // of the last two ways and the part of the first that was gone: where the next one would be zero
                share = (share * moved / (moved - way)).clamp(LEAST_SHARE, LARGEST_SHARE);
            }
            moved = way;
            hub.y += if way.abs() < HUB_TOLERANCE { way } else { share * way };
            active = solution.active();
            let of = |body: &Mat<f64>, side| {
                times(body, &nodal_forces(&points, side, &solution.forces, body.nrows()))
            };
            let (rail_displacement, wheel_displacement) =
                (of(self.rail, Side::Base), of(self.wheel, Side::Opposing));
            let state = Pressed {
                load,
                hub,
                points,
                compliance,
                free,
                solution,
                rail_displacement,
                wheel_displacement,
            };
            if moved.abs() < HUB_TOLERANCE && previous.is_some() {
                let columns = self.rail_surface.grid.along_track.len();
                return match edge_reached(&state.points, &state.solution.forces, columns) {
                    Some(reason) => Err(failure(iteration, 0.0, active, reason)),
                    None => Ok(state),
                };
            }
            previous = Some(state);
        }
        Err(failure(PAIRING_LIMIT, moved.abs(), active, StopReason::IterationLimit))
    }

    /// Adds the tangential motion with the hub at `hub` since the state `before`, or since just touching; the contact
    /// forces add theirs.
    fn add_slip_since(
        &self,
        before: Option<&Pressed>,
        points: &[ContactPoint],
        hub: &Vector2<f64>,
        free: &mut [f64],
    ) {
        let n = points.len();
        let moved = hub - before.map_or(Vector2::zeros(), |b| b.hub);
        for row in n..3 * n {
            let (j, d) = (row % n, row / n);
            let direction = points[j].direction(d);
            free[row] += direction.y * moved.x + direction.z * moved.y;
            if let Some(before) = before {
                free[row] -= points[j].displacement(Side::Opposing, d, &before.wheel_displacement);
                free[row] += points[j].displacement(Side::Base, d, &before.rail_displacement);
            }
        }
    }
}

impl Pressed {
    /// The contact problem at this state, for linearisation.
    pub fn problem<'b>(&'b self, friction: f64) -> Problem<'b> {
        Problem { points: &self.points, compliance: &self.compliance, free: &self.free, friction, hub: &[] }
    }

    /// Gaps at `points`, m, with the elastic displacements of this state.
    fn gaps_at(&self, points: &[ContactPoint]) -> Vec<f64> {
        points
            .iter()
            .map(|point| {
                point.gap + point.displacement(Side::Opposing, 0, &self.wheel_displacement)
                    - point.displacement(Side::Base, 0, &self.rail_displacement)
            })
            .collect()
    }

    /// Resultant of the contact forces on the wheel in world axes, N.
    pub fn force_on_wheel(&self) -> Vector3<f64> {
        resultant(&self.points, &self.solution.forces)
    }

    /// Forces on the retained `equations` of one body, N.
    pub fn body_forces(&self, side: Side, equations: usize) -> Vec<f64> {
        nodal_forces(&self.points, side, &self.solution.forces, equations)
    }
}

/// Forces of the points that both sets share, zero for the others.
pub(crate) fn carry_over(
    from: &[ContactPoint],
    forces: &[f64],
    to: &[ContactPoint],
    directions: usize,
) -> Vec<f64> {
    let mut start = vec![0.0; directions * to.len()];
    // both sets are sorted by grid index
    let mut i = 0;
    for (j, point) in to.iter().enumerate() {
        while i < from.len() && from[i].index < point.index {
            i += 1;
        }
        if i < from.len() && from[i].index == point.index {
            for d in 0..directions {
                start[d * to.len() + j] = forces[d * from.len() + i];
            }
        }
    }
    start
}

/// Whether an iteration did not settle, which another start may cure.
fn unsettled(error: &Error) -> bool {
    use StopReason::{IterationLimit, NotFinite, Singular};
    matches!(error, Error::Numerics(e) if matches!(e.reason, IterationLimit | NotFinite | Singular))
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
