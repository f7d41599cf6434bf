//! Error bands of the laws of a pair: how far they change with the grid of the contact and with the meshes of the bodies.
//!
//! Twice as large elements change a law by what it is still away from its limit if the error is of first order in the size of the
//! elements, and by three times as much if it is of second order. The error of the bodies lies between (order 1.35 was seen, from their
//! corners and their elements of unlike shape), so that the change holds it. Half the spacing of the grid, whose error is of second order, changes
//! the law by three quarters of it. What the scatter of measured profiles leaves in the law is twice the standard uncertainty by the jackknife
//! ([`standard_uncertainty`]), with their surfaces without a quarter of the points on the same bodies. Where the bodies are meshes alone there is no finer grid, and the coarser mesh has the steps from
//! node to node in it as well.

use super::bodies::{CondensedPair, ContactConditions, Laws};
use super::by_shift::{AngleLaw, AngleSettings, ShiftLaw, loads_in_turn};
use super::geometry::Pair;
use super::references::ByReference;
use crate::calibration::{
    ContactField, DOWNWARDS, LoadPoint, Pressed, Reference, WheelOnRail, load_points, points_apart,
    press_loads_apart, subtract_bodies,
};
use nalgebra::{Unit, Vector2};
use railspring_profiles::error::{Result, unless_interrupted};
use railspring_profiles::monitor::Monitor;
use railspring_profiles::profile_file::{REPLICATES, standard_uncertainty};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The solid under some loads with every reference.
pub type SolidPoints = ByReference<Vec<LoadPoint>>;

/// Changes by reference and load.
pub type Changes = ByReference<Vec<Change>>;

/// Ratio of the elements of the coarser mesh to those of the mesh whose error it shows: with it an error of first order changes by
/// itself, and one of a higher order by more.
pub const COARSER: f64 = 2.0;

/// Loads of a calibration at which the grid is halved, at most: one takes as long as a dozen on the grid itself.
pub const LOADS_HALVED: usize = 8;

/// Loads of a calibration that coarser meshes carry, at most: the error of linear bodies goes along with the load.
pub const LOADS_COARSER: usize = 6;

/// Fixed loads of a law by contact angle at which the grid is halved, and as many that coarser meshes carry, at most.
pub const FIXED_LOADS_CHANGED: usize = 2;

/// Numbers of at most `most` of `count` loads, evenly from the first to the last.
pub fn spread(count: usize, most: usize) -> Vec<usize> {
    let most = count.min(most);
    (0..most).map(|n| n * (count - 1) / (most - 1).max(1)).collect()
}

/// Relative change of displacement and tangent at a load.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Change {
    /// Of the displacement.
    pub displacement: f64,
    /// Of the tangent stiffness.
    pub tangent: f64,
}

impl Change {
    /// Of two changes the larger displacement and the larger tangent, by their sizes.
    fn larger(self, other: Self) -> Self {
        let larger = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
        Self {
            displacement: larger(self.displacement, other.displacement),
            tangent: larger(self.tangent, other.tangent),
        }
    }

    /// As displacement and compliance of `point` change by what they differ between two computations.
    fn added(point: &LoadPoint, one: &LoadPoint, other: &LoadPoint) -> Self {
        let compliance = 1.0 / point.solid_tangent + 1.0 / other.solid_tangent - 1.0 / one.solid_tangent;
        Self {
            displacement: (other.displacement - one.displacement) / point.displacement,
            tangent: 1.0 / (compliance * point.solid_tangent) - 1.0,
        }
    }
}

/// Error band of a law at one load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandPoint {
    /// Load, N.
    pub force: f64,
    /// Change with the grid of the contact halved; none for a contact on the nodes of the meshes.
    pub grid: Option<Change>,
    /// Change with a coarser mesh of both bodies; none where there is none.
    pub mesh: Option<Change>,
    /// Twice the standard uncertainty by the scatter of measured profiles; none without any.
    pub scatter: Option<Change>,
}

impl BandPoint {
    /// Half the width of the band: the sizes of all changes together.
    pub fn band(&self) -> Change {
        let changes = [self.grid, self.mesh, self.scatter];
        let sum = |of: fn(Change) -> f64| changes.into_iter().flatten().map(|c| of(c).abs()).sum();
        Change { displacement: sum(|c| c.displacement), tangent: sum(|c| c.tangent) }
    }
}

/// Error band of a law, load by load.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorBand {
    /// The reference of the law.
    pub reference: Reference,
    /// The loads.
    pub points: Vec<BandPoint>,
}

impl ErrorBand {
    /// The largest band of all loads, that of the displacement and that of the tangent each by itself.
    pub fn largest(&self) -> Change {
        self.points.iter().map(BandPoint::band).fold(Change::default(), |largest, band| Change {
            displacement: largest.displacement.max(band.displacement),
            tangent: largest.tangent.max(band.tangent),
        })
    }
}

/// The bands of the solid under its loads, reference by reference, from its changes with the grid, with the meshes and by the scatter.
pub fn error_bands(
    points: &SolidPoints,
    grid: Option<&Changes>,
    mesh: Option<&Changes>,
    scatter: Option<&Changes>,
) -> Vec<ErrorBand> {
    let band = |(reference, points): (Reference, &Vec<LoadPoint>)| {
        let at = |changes: Option<&Changes>, load: usize| changes?.get(reference)?.get(load).copied();
        let point = |(load, p): (usize, &LoadPoint)| BandPoint {
            force: p.force,
            grid: at(grid, load),
            mesh: at(mesh, load),
            scatter: at(scatter, load),
        };
        ErrorBand { reference, points: points.iter().enumerate().map(point).collect() }
    };
    points.iter().map(band).collect()
}

/// Changes of `points` by what displacement and compliance differ between two computations, `from` one `to` the other, of their loads
/// with the numbers `among`, with every reference that all have.
fn changes(points: &SolidPoints, among: &[usize], from: &SolidPoints, to: &SolidPoints) -> Changes {
    let with = |of: fn(&SolidPoints) -> Option<&Vec<LoadPoint>>| {
        Some(changes_between(of(points)?, among, of(from)?, of(to)?))
    };
    Changes {
        foot: with(|points| points.foot.as_ref()),
        beam: changes_between(&points.beam, among, &from.beam, &to.beam),
        local: changes_between(&points.local, among, &from.local, &to.local),
        half_spaces: with(|points| points.half_spaces.as_ref()),
    }
}

/// The same with one reference. At a load between two of those the larger relative change of the two counts, beyond the last one its own.
fn changes_between(
    points: &[LoadPoint],
    among: &[usize],
    from: &[LoadPoint],
    to: &[LoadPoint],
) -> Vec<Change> {
    let pressed: Vec<Change> = among
        .iter()
        .enumerate()
        .map(|(at, &load)| Change::added(&points[load], &from[at], &to[at]))
        .collect();
    let at_load = |load: usize| {
        let upper = among.partition_point(|&pressed| pressed < load);
        match (among.get(upper), upper.checked_sub(1)) {
            (Some(&at), Some(lower)) if at > load => pressed[lower].larger(pressed[upper]),
            (Some(_), _) => pressed[upper],
            (None, _) => pressed[upper - 1],
        }
    };
    (0..points.len()).map(at_load).collect()
}

/// The solid under loads, as its error band needs it.
#[derive(Clone)]
pub struct Solid<'a> {
    /// The sections in place.
    pub pair: &'a Pair,
    /// The bodies.
    pub bodies: &'a CondensedPair,
    /// How they meet.
    pub contact: ContactConditions,
    /// Along what the wheel is pressed, world (y, z).
    pub along: Unit<Vector2<f64>>,
    /// Displacement and tangent under the loads, which ascend; one load at least.
    pub points: SolidPoints,
    /// Loads that were put on in turn up to the last of `coarser`, N, ascending: coarser meshes carry all of them, so that friction has the history that it has
    /// in the points. Empty where these are many: then both meshes carry those of `coarser` alone.
    pub in_turn: Vec<f64>,
    /// Numbers of the loads at which the grid is halved, ascending.
    pub halved: Vec<usize>,
    /// Numbers of the loads that coarser meshes carry, ascending; the surfaces of the replicates too.
    pub coarser: Vec<usize>,
    /// The pair with surfaces from which a quarter of the measured points is left out each; [`REPLICATES`] or none.
    pub replicates: Vec<Pair>,
}

/// A wheel on a rail, and its states under loads.
type Placed<'a> = (WheelOnRail<'a>, Vec<Pressed>);

/// How far a solid changes; a part that has not come to an answer says why.
#[derive(Debug, Clone)]
pub struct Changed {
    /// With half the spacing of the grid; none for a contact on the nodes of the meshes, which has no grid.
    pub grid: Result<Option<Changes>>,
    /// With coarser meshes; none without them.
    pub mesh: Result<Option<Changes>>,
    /// Twice the standard uncertainty by the scatter of measured profiles; none without any.
    pub scatter: Result<Option<Changes>>,
}

impl<'a> Solid<'a> {
    /// That of a calibration, pressed downwards with the loads of its `laws` in turn.
    pub fn of_calibration(
        pair: &'a Pair,
        bodies: &'a CondensedPair,
        contact: ContactConditions,
        laws: &Laws,
        replicates: &[Pair],
    ) -> Self {
        let mut points = laws.map(|law| law.points.clone());
        let count = points.beam.len();
        // nothing changes where the solids have no grid; where fewer loads were carried, the numbers of the loads are others
        let kept = |points: &Vec<LoadPoint>| contact.field.is_fine() && points.len() == count;
        points.half_spaces = points.half_spaces.filter(kept);
        let few = count <= LOADS_COARSER;
        let in_turn = points.beam.iter().filter(|_| few).map(|point| point.force).collect();
        Self {
            pair,
            bodies,
            contact,
            along: DOWNWARDS,
            points,
            in_turn,
            halved: spread(count, LOADS_HALVED),
            coarser: spread(count, LOADS_COARSER),
            replicates: replicates.to_vec(),
        }
    }

    /// That of a law by contact angle at its fixed loads, with the touch of `pair`; `loads` were put on in turn. On the coarser meshes the error of linear bodies goes
    /// along with the load. Half of the largest load is enough for the grid, whose spacing follows the patch up to a largest one, so
    /// that a larger patch has no fewer cells; a grid of half the spacing under it would take longer than the law.
    fn of_fixed_loads(
        pair: &'a Pair,
        bodies: &'a CondensedPair,
        contact: ContactConditions,
        along: Unit<Vector2<f64>>,
        law: &AngleLaw,
        mut loads: Vec<f64>,
        replicates: Vec<Pair>,
    ) -> Self {
        let at = |of: fn(&ByReference<LoadPoint>) -> Option<LoadPoint>| -> Vec<LoadPoint> {
            law.fixed.iter().filter_map(|fixed| of(&fixed.points)).collect()
        };
        let points = SolidPoints {
            foot: law.laws.foot.as_ref().map(|_| at(|points| points.foot)),
            beam: at(|points| Some(points.beam)),
            local: at(|points| Some(points.local)),
            half_spaces: None,
        };
        let largest = points.beam.last().map_or(0.0, |largest: &LoadPoint| largest.force);
        let smaller = points.beam.iter().filter(|point| point.force <= 0.5 * largest).count().max(1);
        let coarser = spread(points.beam.len(), FIXED_LOADS_CHANGED);
        let halved = spread(smaller, FIXED_LOADS_CHANGED);
        loads.retain(|load| *load <= largest);
        Self { pair, bodies, contact, along, points, in_turn: loads, halved, coarser, replicates }
    }

    /// How far it changes with the grid, and with the meshes of the `coarser` bodies.
    ///
    /// # Errors
    /// An interruption.
    pub fn changed(&self, coarser: Option<&CondensedPair>, monitor: &dyn Monitor) -> Result<Changed> {
        let (mesh, (grid, scatter)) = rayon::join(
            || coarser.map(|coarser| self.mesh_changes(coarser, monitor)).transpose(),
            || (self.grid_changes(monitor), self.scatter_changes(monitor)),
        );
        Ok(Changed {
            grid: unless_interrupted(grid)?,
            mesh: unless_interrupted(mesh)?,
            scatter: unless_interrupted(scatter)?,
        })
    }

    /// Changes to the halved grid; none for a contact on the nodes of the meshes.
    ///
    /// The grid concerns the normal contact, which is the same whatever holds the rail. So the wheel is pressed on both grids without
    /// friction and with the section held, and what displacement and compliance change by there, they change by in every law of the solids; on
    /// half-spaces alone it is pressed by itself.
    ///
    /// # Errors
    /// Those of [`press_loads`](crate::calibration::press_loads) and of the tangents.
    pub fn grid_changes(&self, monitor: &dyn Monitor) -> Result<Option<Changes>> {
        if !self.contact.field.is_fine() {
            return Ok(None);
        }
        let (solids, half_spaces) = rayon::join(
            || self.on_both_grids(Reference::Beam, monitor),
            || self.beside_solids(|| self.on_both_grids(Reference::HalfSpaces, monitor)),
        );
        let ([on_grid, on_halved], [half_spaces, half_spaces_halved]) =
            (solids?, half_spaces?.map_or([None, None], |both| both.map(Some)));
        let from = self.points_of(&on_grid, half_spaces.as_ref())?;
        let to = self.points_of(&on_halved, half_spaces_halved.as_ref())?;
        Ok(Some(changes(&self.points, &self.halved, &from, &to)))
    }

    /// What is `pressed` on half-spaces, where there is a law on them.
    fn beside_solids<T>(&self, pressed: impl Fn() -> Result<T>) -> Result<Option<T>> {
        self.points.half_spaces.as_ref().map(|_| pressed()).transpose()
    }

    /// The `halved` loads without friction, on the grid and on one of half its spacing.
    fn on_both_grids(&self, reference: Reference, monitor: &dyn Monitor) -> Result<[Placed<'_>; 2]> {
        let (loads, stage) = (self.forces(&self.halved), "error of the grid");
        let on = |field| {
            let contact = ContactConditions { field, friction: 0.0, ..self.contact };
            self.placed(self.pair, self.bodies, reference, contact)
        };
        let (on_grid, on_halved) = (on(self.contact.field)?, on(ContactField::HybridHalved)?);
        let states = press_loads_apart(&on_grid, &loads, stage, monitor)?;
        let mut halved = Vec::new();
        for (i, state) in states.iter().enumerate() {
            monitor.progress(stage, i, loads.len())?;
            // without friction there is no history: the same load on the wider grid is the nearest start
            halved.push(on_halved.press(state.load, Some(state)).map_err(|error| error.at_step(i + 1))?);
        }
        monitor.progress(stage, loads.len(), loads.len())?;
        Ok([(on_grid, states), (on_halved, halved)])
    }

    /// Changes to `coarser` meshes, with friction, which has the same history of loads on both.
    ///
    /// # Errors
    /// Those of [`press_loads`](crate::calibration::press_loads) and of the tangents; coarser bodies without the rail on its foot, where there is a law against that.
    pub fn mesh_changes(&self, coarser: &CondensedPair, monitor: &dyn Monitor) -> Result<Changes> {
        let (among, wanted) = (&self.coarser, self.forces(&self.coarser));
        let loads = if self.in_turn.is_empty() { &wanted } else { &self.in_turn };
        let of_these = |points: &Vec<LoadPoint>| -> Vec<LoadPoint> {
            points.iter().filter(|point| wanted.contains(&point.force)).copied().collect()
        };
        let on = |bodies: &CondensedPair| -> Result<SolidPoints> {
            let pressed = |reference| {
                points_apart(
                    &self.placed(self.pair, bodies, reference, self.contact)?,
                    loads,
                    "error of the meshes",
                    monitor,
                )
            };
            let (beam, foot) = rayon::join(
                || pressed(Reference::Beam),
                || self.points.foot.as_ref().map(|_| pressed(Reference::Foot)).transpose(),
            );
            let (beam, foot) = (beam?, foot?);
            let mut local = beam.clone();
            subtract_bodies(&mut local);
            Ok(SolidPoints { foot, beam, local, half_spaces: None }.map(of_these))
        };
        if !self.in_turn.is_empty() {
            return Ok(changes(&self.points, among, &self.points.map(of_these), &on(coarser)?));
        }
        let (from, to) = rayon::join(|| on(self.bodies), || on(coarser));
        Ok(changes(&self.points, among, &from?, &to?))
    }

    /// Twice the standard uncertainty by the scatter of measured profiles, from their replicates, pressed without friction and with the section held; none
    /// without replicates.
    ///
    /// # Errors
    /// Those of [`press_loads`](crate::calibration::press_loads) and of the tangents.
    pub fn scatter_changes(&self, monitor: &dyn Monitor) -> Result<Option<Changes>> {
        let Ok(replicates) = <&[Pair; REPLICATES]>::try_from(self.replicates.as_slice()) else {
            return Ok(None);
        };
        let loads = self.forces(&self.coarser);
        let contact = ContactConditions { friction: 0.0, ..self.contact };
        let points = |pair: &Pair| -> Result<SolidPoints> {
            let pressed = |reference| {
                let placed = self.placed(pair, self.bodies, reference, contact)?;
                let states = press_loads_apart(&placed, &loads, "error by scatter", monitor)?;
                Ok((placed, states))
            };
            let half_spaces = self.beside_solids(|| pressed(Reference::HalfSpaces))?;
            self.points_of(&pressed(Reference::Beam)?, half_spaces.as_ref())
        };
        let from = points(self.pair)?;
        let of: Vec<Changes> = replicates
            .iter()
            .map(|pair| Ok(changes(&self.points, &self.coarser, &from, &points(pair)?)))
            .collect::<Result<_>>()?;
        let uncertainty = |reference: Reference| {
            let of: Vec<&Vec<Change>> = of.iter().filter_map(|changes| changes.get(reference)).collect();
            let at = |load: usize, part: fn(&Change) -> f64| {
                2.0 * standard_uncertainty(std::array::from_fn(|i| part(&of[i][load])))
            };
            (of.len() == REPLICATES).then(|| {
                (0..of[0].len())
                    .map(|load| Change {
                        displacement: at(load, |c| c.displacement),
                        tangent: at(load, |c| c.tangent),
                    })
                    .collect::<Vec<_>>()
            })
        };
        let [beam, local] = [Reference::Beam, Reference::Local].map(|r| uncertainty(r).unwrap_or_default());
        let [foot, half_spaces] = [Reference::Foot, Reference::HalfSpaces].map(uncertainty);
        Ok(Some(Changes { foot, beam, local, half_spaces }))
    }

    /// The loads with some numbers, N.
    fn forces(&self, numbers: &[usize]) -> Vec<f64> {
        numbers.iter().map(|&load| self.points.beam[load].force).collect()
    }

    /// Displacement and tangent of states without friction and with the section held: against the foot they change as against the section.
    fn points_of(
        &self,
        (placed, states): &Placed<'_>,
        half_spaces: Option<&Placed<'_>>,
    ) -> Result<SolidPoints> {
        let beam = load_points(placed, states, Reference::Beam)?;
        let local = load_points(placed, states, Reference::Local)?;
        let foot = self.points.foot.as_ref().map(|_| beam.clone());
        let of = |(placed, states): &Placed<'_>| load_points(placed, states, Reference::HalfSpaces);
        let half_spaces = half_spaces.map(of).transpose()?;
        Ok(SolidPoints { foot, beam, local, half_spaces })
    }

    fn placed<'b>(
        &self,
        pair: &'b Pair,
        bodies: &'b CondensedPair,
        reference: Reference,
        contact: ContactConditions,
    ) -> Result<WheelOnRail<'b>> {
        Ok(WheelOnRail { along: self.along, ..bodies.wheel_on_rail(pair, reference, contact)? })
    }
}

/// How far the solid of each of the `laws` by contact angle changes at its fixed loads, on the bodies of the laws and on `coarser` ones, with
/// its points; none for one without a fixed load. `replicates` as in [`Solid`]. As for a calibration, but at fewer of the loads. The places share the threads; the
/// answer does not depend on how many there are.
///
/// # Errors
/// An interruption.
pub fn changed_by_shift(
    pair: &Pair,
    bodies: &CondensedPair,
    coarser: Option<&CondensedPair>,
    replicates: &[Pair],
    settings: &AngleSettings,
    laws: &[ShiftLaw],
    monitor: &dyn Monitor,
) -> Result<Vec<Option<(SolidPoints, Changed)>>> {
    let done = AtomicUsize::new(0);
    let report = |count: usize| monitor.progress("error bands by contact angle", count, laws.len());
    report(0)?;
    let going_on = GoingOn(&|| report(done.load(Ordering::Relaxed)));
    laws.par_iter()
        .map(|entry| {
            let changed = match (&entry.law, &entry.touch) {
                (Ok(law), Some(touch)) if !law.fixed.is_empty() => {
                    let by = entry.tape_y - pair.tape_y;
                    let beside = |own: &Pair| own.with_wheel_at(own.tape_y + by);
                    // micrometres beside a place that touches; one that does not tells nothing of the scatter
                    let replicates = replicates.iter().map(beside).collect::<Result<_>>().unwrap_or_default();
                    let pair = pair.with_wheel_at(entry.tape_y)?;
                    let loads = loads_in_turn(settings.loads, settings.fixed_loads);
                    let contact = settings.contact;
                    let solid =
                        Solid::of_fixed_loads(&pair, bodies, contact, touch.along, law, loads, replicates);
                    let changed = solid.changed(coarser, &going_on)?;
                    Some((solid.points, changed))
                }
                _ => None,
            };
            report(done.fetch_add(1, Ordering::Relaxed) + 1)?;
            Ok(changed)
        })
        .collect()
}

/// Asks before every load whether to go on, and says nothing.
struct GoingOn<'a>(&'a (dyn Fn() -> Result<()> + Sync));

impl Monitor for GoingOn<'_> {
    fn progress(&self, _: &str, _: usize, _: usize) -> Result<()> {
        (self.0)()
    }
}

#[cfg(test)]
mod tests;
