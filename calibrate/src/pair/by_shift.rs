//! The law by contact angle: the bodies of a pair with the wheel in other places across the track.
//!
//! Neither body depends on where the wheel stands, so both are condensed once, and every further place is dense algebra. A wheel on
//! the flange is not pressed down with its hub held laterally but along the normal of the contact at the first touch, the hub held
//! across it; so the force of the law is that of the contact.

use super::bodies::{CondensedPair, ContactConditions, Laws};
use super::geometry::Pair;
use super::references::ByReference;
use crate::calibration::{
    DOWNWARDS, LoadPoint, NormalCalibration, Patch, PatchBand, PatchValues, Pressed, Reference, Region,
    Sticking, WheelOnRail, load_point, regions, sticking_flexibility, subtract_bodies,
};
use crate::law::LEAST_LOADS;
use nalgebra::{Matrix2, Point2, Unit, Vector2};
use railspring_profiles::error::{Error, InputError, Result};
use railspring_profiles::field::InputField;
use railspring_profiles::monitor::Monitor;
use railspring_profiles::placement::Touch;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Along what a wheel is pressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PressDirection {
    /// Vertically down, the hub held laterally: the law of the hub, whatever number of contacts carries the load.
    Vertical,
    /// Along the contact normal at the first touch, the hub held across it: the law of one contact, and of the pair where another one carries as well.
    #[default]
    Normal,
}

impl PressDirection {
    /// The direction at a first touch, world (y, z).
    pub fn at(self, pair: &Pair) -> Unit<Vector2<f64>> {
        match self {
            Self::Vertical => DOWNWARDS,
            Self::Normal => Unit::new_normalize(-pair.placed.curve.upward_normal(pair.touch.rail_s)),
        }
    }
}

/// How the laws by contact angle are made.
#[derive(Debug, Clone, Copy)]
pub struct AngleSettings<'a> {
    /// How wheel and rail meet.
    pub contact: ContactConditions,
    /// Along what the wheel is pressed.
    pub direction: PressDirection,
    /// Loads along that direction, N, ascending. They and the fixed loads within their range are put on in turn, and the laws are
    /// fitted to all of them.
    pub loads: &'a [f64],
    /// Loads at which displacement and stiffness are given, N, ascending: the constants of a law do not interpolate from shift to
    /// shift. Those beyond the range of `loads` are left out.
    pub fixed_loads: &'a [f64],
    /// Whether the stresses below the patches are sought: they take a third of the time of a patch, and error bands of patches come with them.
    pub stresses: bool,
}

/// The loads that are put on in turn, N, ascending: `loads`, and the `fixed` ones within their range.
pub fn loads_in_turn(loads: &[f64], fixed: &[f64]) -> Vec<f64> {
    let (Some(first), Some(last)) = (loads.first(), loads.last()) else { return Vec::new() };
    let within = fixed.iter().filter(|load| (first..=last).contains(load));
    let mut all: Vec<f64> = loads.iter().chain(within).copied().collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// What a wheel in one place of the track has come to.
#[derive(Debug, Clone)]
pub struct ShiftLaw {
    /// Lateral world position of the tape circle, m.
    pub tape_y: f64,
    /// Where the wheel first touches; none where it misses the rail.
    pub touch: Option<TouchPoint>,
    /// The law, or why there is none.
    pub law: Result<AngleLaw>,
}

/// A first touch, and the places on both profiles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TouchPoint {
    /// The first touch.
    pub touch: Touch,
    /// The touching point in the rail's profile frame, m.
    pub on_rail: Point2<f64>,
    /// The touching point in the wheel's profile frame, m.
    pub on_wheel: Point2<f64>,
    /// Direction in world (y, z) along which the wheel is pressed.
    pub along: Unit<Vector2<f64>>,
}

/// The laws of a contact at one angle. All forces, displacements and tangents are along the direction in which the wheel is pressed.
#[derive(Debug, Clone)]
pub struct AngleLaw {
    /// The laws with every reference.
    pub laws: Laws,
    /// The solid at the fixed loads.
    pub fixed: Vec<FixedLoad>,
    /// The smallest load, N, that two contacts with different normals share: from there on the laws are those of the pair, along the direction of
    /// the first touch; none where one contact carries every load.
    pub shared_from: Option<f64>,
    /// Why the laws end before the largest load, if they do.
    pub ended: Option<Error>,
}

impl AngleLaw {
    /// Whether one contact carries a load, N.
    pub fn is_of_one_contact(&self, force: f64) -> bool {
        self.shared_from.is_none_or(|shared| force < shared)
    }
}

/// The solid under a fixed load.
#[derive(Debug, Clone, PartialEq)]
pub struct FixedLoad {
    /// Displacement and tangent with every reference.
    pub points: ByReference<LoadPoint>,
    /// Displacements y and z of the hub against the section under small further forces, all points sticking, m/N; world axes.
    pub flexibility: Matrix2<f64>,
    /// Slope of lateral force against lateral hub displacement (world y), all points sticking, the vertical force constant, N/m; against
    /// the section.
    pub horizontal_stiffness: f64,
    /// The same across the direction in which the wheel is pressed, N/m.
    pub tangential_stiffness: f64,
    /// Part of the lateral flexibility, `1 / horizontal_stiffness`, that lies in the contact, m/N.
    pub lateral_contact: f64,
    /// The patch, the rail's section held.
    pub patch: PatchValues,
    /// Error bands of its values; none for a contact between elements, and without stresses.
    pub patch_band: Option<PatchBand>,
    /// The contacts that carry the load: one, or two whose normals are apart. Their normal forces and their normals out of the rail, world (y, z).
    pub contacts: Vec<Region>,
}

/// The laws with the tape circle at every lateral world position `tape_ys` (m), on bodies that were condensed once. A place that has no law is
/// an entry with its reason. The places share the threads; the answer does not depend on how many there are.
///
/// # Errors
/// [`InputError`] for loads that are not positive and ascending, fewer than four, or no friction; an interruption.
pub fn law_by_shift(
    pair: &Pair,
    bodies: &CondensedPair,
    settings: &AngleSettings,
    tape_ys: &[f64],
    monitor: &dyn Monitor,
) -> Result<Vec<ShiftLaw>> {
    check(settings)?;
    let done = AtomicUsize::new(0);
    let report = |count: usize| monitor.progress("law by contact angle", count, tape_ys.len());
    report(0)?;
    tape_ys
        .par_iter()
        .map(|&tape_y| {
            let entry = shift_law(pair, bodies, settings, tape_y, &|| report(done.load(Ordering::Relaxed)))?;
            report(done.fetch_add(1, Ordering::Relaxed) + 1)?;
            Ok(entry)
        })
        .collect()
}

fn check(settings: &AngleSettings) -> Result<()> {
    let AngleSettings { loads, fixed_loads, contact, .. } = settings;
    let listed = |loads: &[f64]| format!("{:?} kN", loads.iter().map(|l| l * 1e-3).collect::<Vec<_>>());
    let ascending = |loads: &[f64]| {
        loads.iter().all(|l| *l > 0.0 && l.is_finite()) && loads.windows(2).all(|w| w[0] < w[1])
    };
    for (loads, least) in [(loads, 4), (fixed_loads, 0)] {
        if loads.len() < least || !ascending(loads) {
            return InputError::refuse(
                InputField::Loads,
                listed(loads),
                format!("at least {least} positive loads in ascending order"),
                "sort them, remove doubles, or add loads",
            );
        }
    }
    if !(contact.friction > 0.0) {
        return InputError::refuse(
            InputField::Friction,
            contact.friction,
            "a positive coefficient: the horizontal stiffness is that of a sticking wheel",
            "give the coefficient of the pair",
        );
    }
    Ok(())
}

/// The entry of one place; `going_on` is asked before every load.
///
/// # Errors
/// An interruption.
fn shift_law(
    pair: &Pair,
    bodies: &CondensedPair,
    settings: &AngleSettings,
    tape_y: f64,
    going_on: &dyn Fn() -> Result<()>,
) -> Result<ShiftLaw> {
    let pair = match pair.with_wheel_at(tape_y) {
        Ok(pair) => pair,
        Err(reason) => return Ok(ShiftLaw { tape_y, touch: None, law: Err(reason) }),
    };
    let along = settings.direction.at(&pair);
    let touch = TouchPoint {
        touch: pair.touch,
        on_rail: pair.rail.running.point(pair.touch.rail_s),
        on_wheel: pair.wheel.running.point(pair.touch.wheel_s),
        along,
    };
    let press = |reference| {
        let placed = WheelOnRail { along, ..bodies.wheel_on_rail(&pair, reference, settings.contact)? };
        Sequence::press(&placed, settings, reference, going_on)
    };
    let on_section = press(Reference::Beam)?;
    let on_foot = bodies.rail_on_foot.as_ref().map(|_| press(Reference::Foot)).transpose()?;
    Ok(ShiftLaw { tape_y, touch: Some(touch), law: angle_law(on_section, on_foot, along) })
}

/// The laws of the loads that every way of holding the rail has carried.
fn angle_law(
    mut on_section: Sequence,
    mut on_foot: Option<Sequence>,
    along: Unit<Vector2<f64>>,
) -> Result<AngleLaw> {
    // of two reasons, that of the smaller load
    let mut ended = on_section.ended.take();
    let mut carried = on_section.points.len();
    if let Some(on_foot) = on_foot.as_mut().filter(|on_foot| on_foot.points.len() <= carried) {
        ended = on_foot.ended.take().or(ended);
        carried = on_foot.points.len();
    }
    if let Some(reason) = ended.as_ref().filter(|_| carried < LEAST_LOADS) {
        return Err(reason.clone());
    }
    on_section.points.truncate(carried);
    let mut local = on_section.points.clone();
    subtract_bodies(&mut local);
    let on_foot = on_foot.map(|sequence| {
        let mut points = sequence.points;
        points.truncate(carried);
        points
    });
    let points = ByReference { foot: on_foot, beam: on_section.points, local, half_spaces: None };
    let across = Vector2::new(along.y, -along.x);
    let fixed = on_section.fixed.iter().filter(|fixed| fixed.load < carried);
    let fixed = fixed.map(
        |Fixed { load, sticking: Sticking { flexibility, lateral_contact }, patch, patch_band, contacts }| {
            FixedLoad {
                points: points.map(|points| points[*load]),
                flexibility: *flexibility,
                horizontal_stiffness: 1.0 / flexibility[(0, 0)],
                lateral_contact: *lateral_contact,
                tangential_stiffness: 1.0 / across.dot(&(flexibility * across)),
                patch: *patch,
                patch_band: *patch_band,
                contacts: contacts.clone(),
            }
        },
    );
    let fixed = fixed.collect();
    let laws = Laws {
        foot: points.foot.map(|points| NormalCalibration::new(Reference::Foot, points)).transpose()?,
        beam: NormalCalibration::new(Reference::Beam, points.beam)?,
        local: NormalCalibration::new(Reference::Local, points.local)?,
        half_spaces: None,
    };
    let shared_from =
        on_section.shared_from.filter(|shared| laws.beam.points.iter().any(|p| p.force >= *shared));
    Ok(AngleLaw { laws, fixed, shared_from, ended })
}

/// What the loads in turn have come to, the rail held in one way.
struct Sequence {
    points: Vec<LoadPoint>,
    /// With the section held alone.
    fixed: Vec<Fixed>,
    /// The smallest load that two contacts share, N.
    shared_from: Option<f64>,
    /// Why it ended before the largest load.
    ended: Option<Error>,
}

/// What a fixed load has come to beside its point.
struct Fixed {
    /// Its number among all loads.
    load: usize,
    sticking: Sticking,
    patch: PatchValues,
    patch_band: Option<PatchBand>,
    contacts: Vec<Region>,
}

impl Sequence {
    /// Presses with every load in turn, the rail held as for a `reference`, until one is not carried.
    ///
    /// # Errors
    /// An interruption.
    fn press(
        wheel_on_rail: &WheelOnRail,
        settings: &AngleSettings,
        reference: Reference,
        going_on: &dyn Fn() -> Result<()>,
    ) -> Result<Self> {
        let mut sequence = Self { points: Vec::new(), fixed: Vec::new(), shared_from: None, ended: None };
        let mut before: Option<Pressed> = None;
        let loads = loads_in_turn(settings.loads, settings.fixed_loads);
        let largest = loads.last().copied().unwrap_or(0.0);
        for (i, load) in loads.into_iter().enumerate() {
            going_on()?;
            let pressed = wheel_on_rail.press_one_of(load, before.as_ref(), largest).and_then(|state| {
                let point = load_point(wheel_on_rail, &state)?;
                let contacts = contacts(&state);
                if contacts.len() > 1 {
                    sequence.shared_from.get_or_insert(load);
                }
                if reference == Reference::Beam && settings.fixed_loads.contains(&load) {
                    let sticking = sticking_flexibility(wheel_on_rail, &state)?;
                    let patch = if settings.stresses {
                        wheel_on_rail.patch(&state)
                    } else {
                        wheel_on_rail.patch_without_stresses(&state)
                    };
                    let Patch { values: patch, band: patch_band, .. } = patch?;
                    sequence.fixed.push(Fixed { load: i, sticking, patch, patch_band, contacts });
                }
                sequence.points.push(point);
                Ok(state)
            });
            match pressed {
                Ok(state) => before = Some(state),
                Err(Error::Interrupted) => return Err(Error::Interrupted),
                Err(error) => {
                    sequence.ended = Some(error.at_step(i + 1));
                    break;
                }
            }
        }
        Ok(sequence)
    }
}

/// Of the normal force, what a second region must carry to count.
const SECOND_REGION: f64 = 0.01;
/// Angle between the normals of two regions from which on they are two contacts, rad: below, the force along one of them is that along
/// the other to half a percent, as where a worn tread touches in two places of nearly the same slope.
const APART: f64 = 0.1;

/// The contacts of a state in the order of its regions: those whose normals are apart, each with the regions whose normals are near its own. A contact that carries less than
/// [`SECOND_REGION`] of all normal forces does not count.
fn contacts(state: &Pressed) -> Vec<Region> {
    let mut contacts: Vec<Region> = Vec::new();
    for region in regions(state) {
        let near = |other: &&mut Region| region.normal.perp(&other.normal).abs() <= APART.sin();
        match contacts.iter_mut().find(near) {
            Some(other) => {
                let sum = other.normal * other.force + region.normal * region.force;
                (other.force, other.normal) = (other.force + region.force, sum.normalize());
            }
            None => contacts.push(region),
        }
    }
    let whole: f64 = contacts.iter().map(|contact| contact.force).sum();
    contacts.retain(|contact| contact.force >= SECOND_REGION * whole);
    contacts
}
