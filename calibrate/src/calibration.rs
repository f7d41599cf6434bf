//! Loads in, stiffness law out: the normal law `k(f) = a + b·(f/f0)^c` from the
//! tangent of the solid model, and the constant horizontal stiffness.

mod zone;
mod far_field;
mod grid;
mod fine;
mod nodal_motion;
mod pressed;
mod candidates;
mod regions;
mod refined;
mod patch;
mod rim;
mod press;

pub use far_field::{SolidBody, Solids};
pub use fine::{Displaced, FineContact};
pub use grid::{cell_for, too_coarse, touches_border, widths};
pub use patch::{Patch, PatchBand, PatchValues, PeakBand};
pub use pressed::{Bodies, ContactField, DOWNWARDS, Enforcement, Pressed, WheelOnRail};
pub use pressed::{carry_over, edge_reached};
pub use regions::{Region, regions};
pub use zone::{Change, Placed, Places, Zone, distance};

use crate::contact::{BodyCompliance, Compliance, HalfSpace, PointMode, Side, hub_response, total};
use crate::law::{FormFit, LawFit, Solid, fit_forms, fit_law};
use faer::Mat;
use nalgebra::{DVector, Matrix2, Vector3};
use railspring_profiles::error::{Error, InputError, NumericsError, Result, StopReason};
use railspring_profiles::field::InputField;
use railspring_profiles::monitor::Monitor;

/// What the displacement of the law is measured against.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Reference {
    /// The rail's foot is held; hub against foot, nothing subtracted.
    Foot,
    /// Hub against the rail's cross-section at the contact, moved as that of a beam ([`crate::superelement::SectionMotion`]): what
    /// stands in series with a rail beam, whatever the rail's length.
    #[default]
    Beam,
    /// The approach of the two surfaces where wheel and rail move as they do: the displacement of the hub less
    /// the deflection of the bodies beyond their half-spaces. The roll of rim and head is in it.
    Local,
    /// The approach of the two profiles on half-spaces, pressed without friction and without bodies: what half-space programs tabulate
    /// ([`Bodies::HalfSpaces`]).
    HalfSpaces,
}

impl Reference {
    /// Its name in files and figures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Foot => "foot",
            Self::Beam => "beam",
            Self::Local => "local",
            Self::HalfSpaces => "half-spaces",
        }
    }
}

/// One load of the calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadPoint {
    /// Load along the direction in which the wheel is pressed, N.
    pub force: f64,
    /// Displacement along that direction by the reference, m.
    pub displacement: f64,
    /// Tangent stiffness of the solid along that direction by the reference, N/m.
    pub solid_tangent: f64,
    /// Share of the tangent compliance, m/N: both half-spaces under the same change of pressure (and the penalty springs).
    pub local_compliance: f64,
    /// Share of the wheel beyond its half-space, m/N.
    pub wheel_compliance: f64,
    /// Share of the rail beyond its half-space, m/N: down to what the displacement is measured against.
    pub rail_compliance: f64,
    /// Share of surfaces that move past each other, m/N: what friction does on points that slide, and what the contact does that comes to lie
    /// elsewhere on the profiles. With the three other shares it is the tangent compliance of the hub.
    pub sliding_compliance: f64,
    /// Largest penetration over the displacement of the wheel centre (the published criterion asks for less than 1/1000).
    pub penalty_error: f64,
    /// Load-carrying contact points.
    pub active_points: usize,
}

/// The fitted normal law with its points.
#[derive(Debug, Clone)]
pub struct NormalCalibration {
    /// What the displacement is measured against.
    pub reference: Reference,
    /// The loads.
    pub points: Vec<LoadPoint>,
    /// The law.
    pub fit: LawFit,
}

impl NormalCalibration {
    /// Fits the law to the tangents of `points`.
    ///
    /// # Errors
    /// Those of [`fit_law`].
    pub fn new(reference: Reference, points: Vec<LoadPoint>) -> Result<Self> {
        let loads: Vec<f64> = points.iter().map(|p| p.force).collect();
        let tangents: Vec<f64> = points.iter().map(|p| p.solid_tangent).collect();
        let fit = fit_law(&loads, &tangents)?;
        Ok(Self { reference, points, fit })
    }

    /// Laws of all forms for the points, the fitted one first.
    ///
    /// # Errors
    /// Those of [`fit_forms`].
    pub fn forms(&self) -> Result<Vec<FormFit>> {
        let solid =
            |p: &LoadPoint| Solid { force: p.force, tangent: p.solid_tangent, displacement: p.displacement };
        fit_forms(&self.points.iter().map(solid).collect::<Vec<_>>(), self.fit.law)
    }
}

/// Horizontal stiffness at one preload.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HorizontalPoint {
    /// Preload along the direction in which the wheel is pressed, N.
    pub preload: f64,
    /// Slope of lateral force against lateral hub displacement, all points sticking, the vertical load constant, N/m.
    pub stiffness: f64,
    /// Fraction of the load-carrying points that slip under the preload alone.
    pub slipping: f64,
}

/// The constant horizontal stiffness and how constant it is.
#[derive(Debug, Clone)]
pub struct HorizontalCalibration {
    /// The preloads.
    pub points: Vec<HorizontalPoint>,
    /// Mean stiffness, N/m.
    pub stiffness: f64,
    /// Largest deviation of a preload from the mean, relative.
    pub spread: f64,
    /// Why the points end before the largest wanted preload, if they do: the contact reaches the end of the contact zone.
    pub ended: Option<Error>,
}

/// Presses the wheel with every load in turn (ascending). `stage` names the work to `monitor`.
///
/// # Errors
/// [`InputError`] for loads that are not ascending or cannot be carried; numerical errors of contact.
pub fn press_loads(
    wheel_on_rail: &WheelOnRail,
    loads: &[f64],
    stage: &str,
    monitor: &dyn Monitor,
) -> Result<Vec<Pressed>> {
    let (states, ended) =
        press_each(|load, before| wheel_on_rail.press(load, before), loads, stage, monitor)?;
    ended.map_or(Ok(states), Err)
}

/// As [`press_loads`], for a few loads that may be far apart.
///
/// # Errors
/// Those of [`press_loads`].
pub fn press_loads_apart(
    wheel_on_rail: &WheelOnRail,
    loads: &[f64],
    stage: &str,
    monitor: &dyn Monitor,
) -> Result<Vec<Pressed>> {
    let press = |load, before: Option<&Pressed>| wheel_on_rail.press_from_afar(load, before);
    let (states, ended) = press_each(press, loads, stage, monitor)?;
    ended.map_or(Ok(states), Err)
}

/// Displacement and tangent under `loads` that may be far apart, put on in turn; no state is kept.
///
/// # Errors
/// Those of [`WheelOnRail::press`] and of [`load_points`], and an interruption.
pub fn points_apart(
    wheel_on_rail: &WheelOnRail,
    loads: &[f64],
    stage: &str,
    monitor: &dyn Monitor,
) -> Result<Vec<LoadPoint>> {
    let mut points = Vec::new();
    let mut before: Option<Pressed> = None;
    for (i, &load) in loads.iter().enumerate() {
        monitor.progress(stage, i, loads.len())?;
        let state = wheel_on_rail.press_from_afar(load, before.as_ref());
        let state = before.insert(state.map_err(|error| error.at_step(i + 1))?);
        points.push(load_point(wheel_on_rail, state)?);
    }
    Ok(points)
}

/// Of the largest load, what a normal force may be. Downwards on a flange, 150 kN are a normal force of 440 kN, which no one asks for.
pub const LARGEST_NORMAL: f64 = 1.25;

impl WheelOnRail<'_> {
    /// [`Self::press`] with one of the loads up to the `largest`, unless the normal force would be more than [`LARGEST_NORMAL`] of that.
    ///
    /// # Errors
    /// Those of [`Self::press`], and [`StopReason::SteepContact`].
    pub fn press_one_of(&self, load: f64, before: Option<&Pressed>, largest: f64) -> Result<Pressed> {
        too_steep(before, load, largest).map_or_else(|| self.press(load, before), Err)
    }

    /// The same, iterated from that of the `known` states whose load is nearest.
    fn press_one_near(
        &self,
        load: f64,
        before: Option<&Pressed>,
        known: &[Pressed],
        largest: f64,
    ) -> Result<Pressed> {
        let apart = |state: &Pressed| (load / state.load).ln().abs();
        let near = known.iter().chain(before).min_by(|a, b| apart(a).total_cmp(&apart(b)));
        too_steep(before, load, largest).map_or_else(|| self.press_from(load, before, near), Err)
    }
}

/// Why a load is not put on: after the state `before`, the normal force would be too large for loads up to the `largest`.
fn too_steep(before: Option<&Pressed>, load: f64, largest: f64) -> Option<Error> {
    let before = before?;
    let normal: f64 = before.solution.forces[..before.points.len()].iter().sum();
    let wanted = normal * load / before.load;
    let stage = || {
        let [load, wanted] = [load, wanted].map(|force| force * 1e-3);
        format!("contact of wheel and rail at {load:.3} kN, normal force {wanted:.1} kN")
    };
    let active = before.solution.active();
    (wanted > LARGEST_NORMAL * largest)
        .then(|| NumericsError::new(stage(), StopReason::SteepContact, 0.0, active).into())
}

/// Whether loads end before the one that stops so, and those before it are whole: at the end of the contact zone, where no fine grid holds the patch, and
/// where the normal force grows too large.
fn ends_the_loads(reason: StopReason) -> bool {
    use StopReason::{EdgeOfCandidates, EndOfWindow, GridUnsettled, SteepContact};
    matches!(reason, EdgeOfCandidates | EndOfWindow | GridUnsettled | SteepContact)
}

/// The same up to the first load whose contact reaches the end of the contact zone, that no fine grid holds, or whose normal force is too large
/// ([`WheelOnRail::press_one_of`]), and that error, if there is such a load.
///
/// # Errors
/// Those of [`press_loads`] for other reasons.
pub fn press_carried(
    wheel_on_rail: &WheelOnRail,
    loads: &[f64],
    stage: &str,
    monitor: &dyn Monitor,
) -> Result<(Vec<Pressed>, Option<Error>)> {
    let largest = loads.last().copied().unwrap_or(0.0);
    press_each(|load, before| wheel_on_rail.press_one_of(load, before, largest), loads, stage, monitor)
}

/// The same, each load by `press`.
fn press_each(
    press: impl Fn(f64, Option<&Pressed>) -> Result<Pressed>,
    loads: &[f64],
    stage: &str,
    monitor: &dyn Monitor,
) -> Result<(Vec<Pressed>, Option<Error>)> {
    if loads.windows(2).any(|w| !(w[1] > w[0])) {
        return InputError::refuse(
            InputField::Loads,
            format!("{:?}", loads.iter().map(|l| l * 1e-3).collect::<Vec<_>>()),
            "loads in ascending order",
            "sort them and remove doubles",
        );
    }
    let mut states: Vec<Pressed> = Vec::new();
    for (i, &load) in loads.iter().enumerate() {
        monitor.progress(stage, i, loads.len())?;
        match press(load, states.last()).map_err(|error| error.at_step(i + 1)) {
            Ok(state) => states.push(state),
            Err(Error::Numerics(end)) if ends_the_loads(end.reason) => {
                return Ok((states, Some(end.into())));
            }
            Err(error) => return Err(error),
        }
    }
    monitor.progress(stage, loads.len(), loads.len())?;
    Ok((states, None))
}

/// Displacement and tangent stiffness of the states of [`press_loads`]. With the reference `beam` the rail's
/// compliance must be that against its section; with `local` the compliance of the bodies beyond their half-spaces,
/// which the load hardly changes, is integrated over the loads.
///
/// # Errors
/// Numerical errors of the tangent.
pub fn load_points(
    wheel_on_rail: &WheelOnRail,
    states: &[Pressed],
    reference: Reference,
) -> Result<Vec<LoadPoint>> {
    let mut points: Vec<LoadPoint> =
        states.iter().map(|state| load_point(wheel_on_rail, state)).collect::<Result<_>>()?;
    if reference == Reference::Local {
        subtract_bodies(&mut points);
    }
    Ok(points)
}

/// Turns the displacements and tangents of the hub under ascending loads into those of the approach alone.
pub fn subtract_bodies(points: &mut [LoadPoint]) {
    let (mut force, mut compliance, mut way) = (0.0, None, 0.0);
    for point in points {
        let bodies = point.wheel_compliance + point.rail_compliance + point.sliding_compliance;
        way += 0.5 * (bodies + compliance.unwrap_or(bodies)) * (point.force - force);
        (force, compliance) = (point.force, Some(bodies));
        point.displacement -= way;
        point.solid_tangent = 1.0 / point.local_compliance;
    }
}

/// Fits the normal law with `reference` to the states of [`press_loads`], as [`load_points`].
///
/// # Errors
/// Numerical errors of tangent and fit.
pub fn calibrate_normal(
    wheel_on_rail: &WheelOnRail,
    states: &[Pressed],
    reference: Reference,
) -> Result<NormalCalibration> {
    NormalCalibration::new(reference, load_points(wheel_on_rail, states, reference)?)
}

/// The linearised contact of `stage` has no answer.
fn singular(stage: &str, state: &Pressed) -> NumericsError {
    NumericsError::new(
        format!("{stage} at {:.3} kN", state.load * 1e-3),
        StopReason::Singular,
        0.0,
        state.solution.active(),
    )
}

/// The point of a load by the displacement of the hub.
pub fn load_point(wheel_on_rail: &WheelOnRail, state: &Pressed) -> Result<LoadPoint> {
    let answer = state.answer.as_ref().ok_or_else(|| singular("tangent", state))?;
    let tangent = answer.stiffness;
    // change of the contact forces for one newton of load
    let change: Vec<f64> = answer.forces.iter().map(|f| f / tangent).collect();
    let [near, wheel, rail] = split(wheel_on_rail, state, &change);
    let penalty = match wheel_on_rail.enforcement {
        Enforcement::Exact => 0.0,
        Enforcement::Penalty(stiffness) => change.iter().map(|f| f * f / stiffness).sum(),
    };
    let rim = wheel_on_rail.rim_compliance(state, answer);
    let local = near + penalty + rim;
    let forces = &state.solution.forces[..state.points.len()];
    let penetration = match wheel_on_rail.enforcement {
        Enforcement::Exact => 0.0,
        Enforcement::Penalty(stiffness) => forces.iter().map(|f| f / stiffness).fold(0.0, f64::max),
    };
    let displacement = state.hub.dot(&wheel_on_rail.along);
    Ok(LoadPoint {
        force: state.load,
        displacement,
        solid_tangent: 1.0 / (1.0 / tangent + rim),
        local_compliance: local,
        wheel_compliance: wheel,
        rail_compliance: rail,
        sliding_compliance: sliding(wheel_on_rail, state, &change, 1.0 / tangent),
        penalty_error: penetration / displacement,
        active_points: state.solution.active(),
    })
}

/// Compliance under a change of the contact forces in parts, m/N for a unit load: both half-spaces under its normal forces, then
/// wheel and rail beyond their half-spaces.
fn split(wheel_on_rail: &WheelOnRail, state: &Pressed, change: &[f64]) -> [f64; 3] {
    if let Some(fine) = state.fine() {
        return fine.split(change);
    }
    let directions = wheel_on_rail.directions();
    let share = |part: &dyn Compliance| quadratic(&total(&[part], &state.points, directions), change);
    let normal = &change[..state.points.len()];
    let half_space = |half: HalfSpace| quadratic(&total(&[&half], &state.points, 1), normal);
    let [rail_half, wheel_half] = wheel_on_rail.half_spaces().map(half_space);
    let Bodies::Condensed { rail, wheel, .. } = wheel_on_rail.bodies else {
        return [rail_half + wheel_half, 0.0, 0.0];
    };
    let wheel = share(&BodyCompliance { compliance: wheel, side: Side::Opposing });
    let rail = share(&BodyCompliance { compliance: rail, side: Side::Base });
    [rail_half + wheel_half, wheel - wheel_half, rail - rail_half]
}

/// Work on the surfaces that move past each other under a unit load, m/N. `change` is the change of the
/// contact forces, `hub` the motion of the hub (m/N) along the direction in which the wheel is pressed.
/// Friction does work on the points that slide, normal forces where the wheel comes to face the rail
/// elsewhere. No body stores this part of the work of the load: `δ = fᵀ·C·f - τᵀ·s`.
fn sliding(wheel_on_rail: &WheelOnRail, state: &Pressed, change: &[f64], hub: f64) -> f64 {
    let n = state.points.len();
    let slides = |j: &usize| wheel_on_rail.directions() > 1 && state.solution.modes[*j] == PointMode::Slip;
    // on the nodes of a mesh the gaps follow the normals of the rail
    let faces = |j: &usize| state.fine().is_some() && change[*j] != 0.0;
    if !(0..n).any(|j| slides(&j) || faces(&j)) {
        return 0.0;
    }
    let mut motion = vec![0.0; change.len()];
    state.problem(wheel_on_rail.friction).compliance.add_product(change, &mut motion);
    let along = wheel_on_rail.world_direction();
    let work = |d: usize, j: usize| {
        let row = d * n + j;
        -change[row] * (motion[row] + hub * state.points[j].direction(d).dot(&along))
    };
    let normal: f64 = (0..n).filter(faces).map(|j| work(0, j)).sum();
    let friction: f64 = (0..n).filter(slides).map(|j| work(1, j) + work(2, j)).sum();
    normal + friction
}

fn quadratic(matrix: &Mat<f64>, vector: &[f64]) -> f64 {
    let product = crate::superelement::times(matrix, vector);
    product.iter().zip(vector).map(|(p, v)| p * v).sum()
}

/// How the hub gives way under small further forces, all load-carrying points sticking.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sticking {
    /// Flexibility of the hub in world (y, z), m/N.
    pub flexibility: Matrix2<f64>,
    /// Part of the lateral one, `flexibility[(0, 0)]`, that lies in the contact: both half-spaces under the contact forces that a
    /// lateral force on the hub makes, m/N.
    pub lateral_contact: f64,
}

/// Flexibility of the hub, and the contact's share of the lateral one.
///
/// # Errors
/// [`NumericsError`] where no point carries load, or none sticks.
pub fn sticking_flexibility(wheel_on_rail: &WheelOnRail, state: &Pressed) -> Result<Sticking> {
    let problem = state.problem(wheel_on_rail.friction);
    let missing = || singular("horizontal stiffness", state);
    let response = hub_response(&problem, &state.solution, &[Vector3::y_axis(), Vector3::z_axis()], true)
        .ok_or_else(missing)?;
    let inverse = response.stiffness.clone().try_inverse().ok_or_else(missing)?;
    let flexibility = Matrix2::from_fn(|row, column| inverse[(row, column)]);
    let forces: Vec<f64> = (0..response.forces.nrows())
        .map(|row| (0..2).map(|axis| response.forces[(row, axis)] * flexibility[(axis, 0)]).sum())
        .collect();
    Ok(Sticking { flexibility, lateral_contact: half_spaces(wheel_on_rail, state, &forces) })
}

/// Compliance of both half-spaces under contact forces in all directions, m/N for those of a unit load.
fn half_spaces(wheel_on_rail: &WheelOnRail, state: &Pressed, forces: &[f64]) -> f64 {
    if let Some(fine) = state.fine() {
        return fine.half_spaces(forces);
    }
    let directions = wheel_on_rail.directions();
    let of = |half: &HalfSpace| quadratic(&total(&[half], &state.points, directions), forces);
    wheel_on_rail.half_spaces().iter().map(of).sum()
}

/// Horizontal stiffness at every preload, all points sticking, and its mean, against what the rail's compliance
/// is measured against. Where the contact of a preload (N, ascending) reaches the end of the contact zone, the points end with the preload
/// before, if there is one. States of the same wheel and rail that are `known` give starts.
///
/// # Errors
/// Errors of [`WheelOnRail::press`].
pub fn calibrate_horizontal(
    wheel_on_rail: &WheelOnRail,
    preloads: &[f64],
    known: &[Pressed],
    monitor: &dyn Monitor,
) -> Result<HorizontalCalibration> {
    let mut points = Vec::new();
    let mut before: Option<Pressed> = None;
    let mut ended = None;
    let largest = preloads.last().copied().unwrap_or(0.0);
    for (i, &preload) in preloads.iter().enumerate() {
        monitor.progress("horizontal stiffness", i, preloads.len())?;
        let state = match wheel_on_rail.press_one_near(preload, before.as_ref(), known, largest) {
            Err(Error::Numerics(end)) if before.is_some() && ends_the_loads(end.reason) => {
                ended = Some(end.into());
                break;
            }
            state => state?,
        };
        let Sticking { flexibility, .. } = sticking_flexibility(wheel_on_rail, &state)?;
        let modes = &state.solution.modes;
        points.push(HorizontalPoint {
            preload,
            stiffness: 1.0 / flexibility[(0, 0)],
            slipping: modes.iter().filter(|m| **m == PointMode::Slip).count() as f64
                / state.solution.active() as f64,
        });
        before = Some(state);
    }
    monitor.progress("horizontal stiffness", preloads.len(), preloads.len())?;
    let mean = DVector::from_iterator(points.len(), points.iter().map(|p| p.stiffness)).mean();
    let spread = points.iter().map(|p| (p.stiffness / mean - 1.0).abs()).fold(0.0, f64::max);
    Ok(HorizontalCalibration { points, stiffness: mean, spread, ended })
}
