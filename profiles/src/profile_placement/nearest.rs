//! Which standards a measurement resembles.

use std::fmt;

use nalgebra::Point2;
use rayon::prelude::*;

use super::own_frame::{TURNED, WIDTH_DEPTH, sides_of_head};
use super::placed::{PlaceOptions, Placed, PlacedPoint, place};
use super::reference::Reference;
use super::side::Side;
use crate::error::{Error, InputError, Result};
use crate::profile::polyline;
use crate::profile::rails::RAIL_NAMES;
use crate::profile::wheels::WHEEL_NAMES;
use crate::profile_file::{
    Action, ClosedSection, Finding, FindingKind, MeasuredProfile, ProfileKind, Sketch, repaired,
};
use crate::units::MILLIMETRE;

/// Scale on which the misfit is measured, m.
const SCALE: f64 = 0.1 * MILLIMETRE;

/// Misfit of what wear leaves alone up to which a standard is that of the measurement, m: the tolerances of rolled heads and turned treads are
/// some tenths of a millimetre.
const WITHIN: f64 = 0.2 * MILLIMETRE;
/// Share of the profile off a standard from which its sides are looked at.
const MOSTLY: f64 = 0.5;
/// A line within this of a straight one is a face, which lies on many standards and tells none, m.
const STRAIGHT: f64 = 1.0 * MILLIMETRE;
/// Standards that a message names.
const NAMED: usize = 3;
/// A section lies as it says.
const AS_IT_LIES: PlaceOptions = PlaceOptions { side_known: true };

/// How a standard fits a measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Misfit {
    /// Name of the standard.
    pub name: &'static str,
    /// Rail or wheel.
    pub kind: ProfileKind,
    /// Share of the profile, 0 to 1, that does not lie on the standard: worn or not explained at all.
    pub share: f64,
    /// Root mean square of the distances from the standard over what wear leaves alone, m. Of a rail this is the sides and corners of its head without those of the side
    /// that is farther off, underside, web and foot. Of a wheel it is the flange back up to its tip, field end of the tread, chamfer and field face. `None` where nothing
    /// of that was measured.
    pub rms: Option<f64>,
    /// The measurement placed on it.
    pub placed: Placed,
    /// Whether the head is its own mirror image, while on this standard one of its sides is worn: it is rather a narrower head.
    pub narrower: bool,
}

impl Misfit {
    /// Whether this may be the standard of the measurement: its shape and size, within 0.2 mm (RMS) where wear leaves the surface alone, and no narrower
    /// head.
    pub fn is_standard(&self) -> bool {
        let like = self.placed.fits() && self.placed.size.is_one() && !self.narrower;
        like && self.rms.is_some_and(|rms| rms <= WITHIN)
    }

    /// Whether the measurement lies on this standard as it stands in its file, or most of it does once it is turned. A small part of a head that is no standard's
    /// fits one by being turned: up to a quarter of it within 0.1 mm by 1.7 and 2.9 degrees.
    pub fn tells_the_roll(&self) -> bool {
        self.placed.motion.angle.abs() <= TURNED || self.tells_the_body()
    }

    /// Whether most of the measurement lies on this standard, so that what was not measured is that of the standard as well. Heads of other rails may lie on it in
    /// part.
    pub fn tells_the_body(&self) -> bool {
        self.share <= MOSTLY
    }

    /// Whether nothing tells this standard from a `better` one: both lie as near to what wear leaves alone, and as much of the profile.
    pub fn ties_with(&self, better: &Self) -> bool {
        const SAME: f64 = 0.05;
        self.is_standard() && self.rank() - better.rank() < SAME
    }

    /// What the standards are ordered by. Where wear leaves the surface alone, the right standard is as near as the scatter, so that a distance
    /// twice as large counts as much as 0.3 of the profile being worn: a worn side is no reason for another rail.
    fn rank(&self) -> f64 {
        /// Distances below this tell nothing, m: the rounding of files and the form of a surface.
        const FINE: f64 = 0.01 * MILLIMETRE;
        /// Distance of a measurement of which nothing lies on such parts, m.
        const NOTHING: f64 = 0.3 * MILLIMETRE;
        const TWICE: f64 = 0.3;
        self.share + TWICE * self.rms.unwrap_or(NOTHING).hypot(FINE).log2()
    }
}

impl fmt::Display for Misfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let off = |rms: f64| format!("{:.3} mm off what wear leaves alone", rms / MILLIMETRE);
        let off = self.rms.map_or_else(|| "nothing measured that wear leaves alone".into(), off);
        let size = self.placed.size;
        let size = if size.is_one() { String::new() } else { format!(", {:.3} times as large", size.factor) };
        let share = 100.0 * self.share;
        let unlike = match self.placed.fits() {
            true => format!(", {share:.0} % worn or unlike"),
            false => format!(", another shape: {share:.0} % unlike"),
        };
        write!(f, "{} ({off}{size}{unlike})", self.name)
    }
}

/// The standards that a measured profile resembles, worn or not, the nearest first with their misfits; empty where it resembles none, or
/// cannot be repaired.
pub fn resembled(profile: &MeasuredProfile, kind: Option<ProfileKind>, options: PlaceOptions) -> Vec<Misfit> {
    let Ok(repaired) = repaired(profile, &mut Vec::new()) else { return Vec::new() };
    let points: Vec<Point2<f64>> = repaired.iter().map(|p| p.point).collect();
    let found = nearest(&points, kind, options.of(profile)).unwrap_or_default();
    found.into_iter().filter(|misfit| misfit.placed.fits()).take(NAMED).collect()
}

/// Says which standards are nearest to a section, with their misfits: of a rail over its outline, of a wheel over its running surface.
pub fn say_nearest(section: &mut ClosedSection) {
    /// Step of the points on the surface and on the body, m.
    const STEPS: [f64; 2] = [1.0 * MILLIMETRE, 4.0 * MILLIMETRE];
    let mut points = section.running.sample(STEPS[0]);
    if section.kind == ProfileKind::Rail {
        points.extend(polyline(&section.rest, STEPS[1]).into_iter().skip(1));
    }
    let found = nearest(&points, Some(section.kind), AS_IT_LIES).unwrap_or_default();
    let named = &found[..found.len().min(NAMED)];
    if named.is_empty() {
        return;
    }
    let text = if named[0].placed.fits() {
        format!("the nearest standards are {}", in_words(named))
    } else {
        format!("no standard has this shape; the nearest are {}", in_words(named))
    };
    section.findings.push(Finding::new(FindingKind::Shape, Action::Noted, text));
}

/// The message about a section that is refused because its line is open, with the standards that this line resembles, if it does: a running
/// surface alone belongs on one of them.
pub fn with_nearest_to(sketch: &Sketch, kind: ProfileKind, error: Error) -> Error {
    let found = sketch.open_line().and_then(|line| nearest(line, Some(kind), PlaceOptions::default()).ok());
    let mut fitting: Vec<Misfit> = found.unwrap_or_default();
    fitting.retain(|misfit| misfit.placed.fits());
    fitting.truncate(NAMED);
    match error {
        Error::Input(error) if !fitting.is_empty() => {
            let remedy = format!("{}; nearest to what is drawn are {}", error.remedy, in_words(&fitting));
            InputError { remedy, ..error }.into()
        }
        error => error,
    }
}

/// The same in words for messages: names with misfits, joined by commas.
pub fn in_words(misfits: &[Misfit]) -> String {
    misfits.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// The standards by their misfit, the nearest first ([`Misfit`]); of one kind if `kind` is given; none for a straight line, which lies on the faces of many.
///
/// # Errors
/// As [`place`].
pub fn nearest(
    points: &[Point2<f64>],
    kind: Option<ProfileKind>,
    options: PlaceOptions,
) -> Result<Vec<Misfit>> {
    if is_straight(points) {
        return Ok(Vec::new());
    }
    let rails = RAIL_NAMES.iter().map(|&name| (name, ProfileKind::Rail));
    let wheels = WHEEL_NAMES.iter().map(|&name| (name, ProfileKind::Wheel));
    let standards: Vec<_> = rails.chain(wheels).filter(|(_, k)| kind.is_none_or(|kind| kind == *k)).collect();
    let mut found = standards
        .into_par_iter()
        .map(|(name, kind)| {
            let reference = Reference::standard(name)?;
            let placed = place(points, &reference, options)?;
            Ok(placed.map(|placed| {
                let share = misfit(&reference, &placed);
                let rms = off_unworn(&reference, &placed);
                let narrower = share > MOSTLY && is_narrower(&placed);
                Misfit { name, kind, share, rms, placed, narrower }
            }))
        })
        .collect::<Result<Vec<Option<_>>>>()?
        .into_iter()
        .flatten()
        .collect::<Vec<_>>();
    found.sort_by(|a, b| a.rank().total_cmp(&b.rank()));
    Ok(found)
}

/// Whether points lie on a straight line.
fn is_straight(points: &[Point2<f64>]) -> bool {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return true };
    let chord = last - first;
    // A closed outline ends where it begins.
    chord.norm() > STRAIGHT
        && points.iter().all(|p| chord.perp(&(p - first)).abs() <= STRAIGHT * chord.norm())
}

/// Root mean square of the distances over what wear leaves alone, m.
fn off_unworn(reference: &Reference, placed: &Placed) -> Option<f64> {
    let of = |belongs: &dyn Fn(&PlacedPoint) -> bool| {
        let squares = placed.points.iter().filter(|p| reference.keeps(p.s) && belongs(p));
        squares.fold((0.0, 0), |(sum, count), p| (sum + p.missing.powi(2), count + 1))
    };
    let side = |p: &PlacedPoint| reference.kind == ProfileKind::Rail && reference.runs(p.s);
    let mean = |(sum, count): (f64, usize)| if count > 0 { sum / count as f64 } else { f64::INFINITY };
    let (body, gauge, field) =
        (of(&|p| !side(p)), of(&|p| side(p) && p.point.x < 0.0), of(&|p| side(p) && p.point.x >= 0.0));
    let better = if mean(gauge) < mean(field) { gauge } else { field };
    let (sum, count) = (body.0 + better.0, body.1 + better.1);
    (count > 0).then(|| mean((sum, count)).sqrt())
}

/// Whether a head that has one side worn on a standard is its own mirror image: wear does not make one side what the other was made like.
fn is_narrower(placed: &Placed) -> bool {
    /// Wear of a side that is looked at, m, on the average; and how much of it two like sides differ by.
    const WORN: f64 = 0.3 * MILLIMETRE;
    const LIKE: f64 = 0.25;
    /// Depths below the top at which the halves are compared, m, against those 14 mm below it.
    const DEPTHS: [f64; 5] = [6.0, 7.5, 9.0, 10.5, 12.0];
    let Side::Wear(worn) = placed.side else { return false };
    let points: Vec<Point2<f64>> = placed.points.iter().map(|p| p.point).collect();
    let halves = |depth: f64| match sides_of_head(&points, depth) {
        [Some(gauge), Some(field)] => Some([gauge, field]),
        _ => None,
    };
    let Some([gauge, field]) = halves(WIDTH_DEPTH) else { return false };
    let middle = 0.5 * (gauge + field);
    let unlike = DEPTHS
        .iter()
        .map(|depth| halves(depth * MILLIMETRE).map_or(f64::INFINITY, |[g, f]| (f + g - 2.0 * middle).abs()));
    worn > WORN && unlike.fold(0.0, f64::max) < LIKE * worn
}

/// Share of the points off the standard; a little off counts a little, material beyond the standard four times.
fn misfit(reference: &Reference, placed: &Placed) -> f64 {
    let off = |missing: f64, runs: bool| {
        let factor = if runs && missing < 0.0 { 4.0 } else { 1.0 };
        let square = factor * (missing / SCALE).powi(2);
        square / (1.0 + square)
    };
    let sum: f64 = placed.points.iter().map(|p| off(p.missing, reference.runs(p.s))).sum();
    sum / placed.points.len() as f64
}
