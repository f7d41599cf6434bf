//! Contact functions of a wheelset over its lateral shift, and the parameters that stand for them.
//!
//! EN 15302:2021 names the functions (rolling-radius difference, Δ tan γ, roll) and the parameters. Its text is not public; every definition
//! here is that of the publication it names.

use std::f64::consts::PI;

use super::conicity::{RunningFunction, RunningPoint};
use super::wheelset::{Roll, WheelOnRail, Wheelset, WheelsetContact, WheelsetPosition};
use crate::error::Result;
use crate::profile::ProfileCurve;
use crate::root::bisection;
use crate::units::MILLIMETRE;

/// Depth below the top of a rail at which the gauge is measured, m (EN 13848-1).
const GAUGE_DEPTH: f64 = 14.0 * MILLIMETRE;
/// Depth below the tape circle at which a flange's thickness is measured, m (EN 13715).
const FLANGE_DEPTH: f64 = 10.0 * MILLIMETRE;

/// What the contact of a wheelset is at one lateral shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FunctionPoint {
    /// Lateral shift, m, positive to the right.
    pub shift: f64,
    /// Tangent of the right wheel's contact angle less that of the left wheel's.
    pub tangent_difference: f64,
    /// Roll, rad, positive where the right wheel goes down.
    pub roll: f64,
}

/// Contact functions of a wheelset over its lateral shift, straight between their points.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactFunctions {
    running: RunningFunction,
    points: Vec<FunctionPoint>,
    half_distance: f64,
    radius: f64,
}

/// Parameters of a wheelset's contact. One has no value where the wheelset does not swing freely that far.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters<T = f64> {
    /// Equivalent conicity at each amplitude.
    pub conicity: Vec<Option<T>>,
    /// Contact-angle parameter at each amplitude.
    pub contact_angle: Vec<Option<T>>,
    /// Roll parameter at each amplitude.
    pub roll: Vec<Option<T>>,
    /// Nonlinearity parameter, 1/m.
    pub nonlinearity: Option<T>,
    /// Radius of the tightest curve that is rolled through without slip, m.
    pub curve_radius: Option<T>,
}

impl<T: Copy> Parameters<T> {
    /// All values in a row.
    pub fn values(&self) -> Vec<Option<T>> {
        let amplitudes = [&self.conicity[..], &self.contact_angle, &self.roll].concat();
        amplitudes.into_iter().chain([self.nonlinearity, self.curve_radius]).collect()
    }

    /// From [`Parameters::values`] for so many amplitudes.
    pub fn from_values(amplitudes: usize, values: &[Option<T>]) -> Self {
        let at = |i: usize| values.get(i).copied().flatten();
        let row = |row: usize| (0..amplitudes).map(|i| at(row * amplitudes + i)).collect();
        Self {
            conicity: row(0),
            contact_angle: row(1),
            roll: row(2),
            nonlinearity: at(3 * amplitudes),
            curve_radius: at(3 * amplitudes + 1),
        }
    }
}

impl ContactFunctions {
    /// Functions of `wheelset` without yaw at the shifts from `from` to `to` (m), `step` apart.
    ///
    /// # Errors
    /// As [`RunningFunction::of`].
    pub fn of(wheelset: &Wheelset, range: [f64; 2], step: f64, roll: Roll) -> Result<Self> {
        let contacts = RunningFunction::shifts(range, step)?
            .into_iter()
            .map(|shift| {
                let position = WheelsetPosition { lateral_shift: shift, yaw: 0.0, roll };
                Ok((shift, wheelset.contacts(&position, 0.0)?))
            })
            .collect::<Result<Vec<_>>>()?;
        Self::from_contacts(wheelset, &contacts)
    }

    /// From the contacts of `wheelset` at increasing lateral shifts, m.
    ///
    /// # Errors
    /// As [`RunningFunction::from_points`].
    pub fn from_contacts(wheelset: &Wheelset, contacts: &[(f64, WheelsetContact)]) -> Result<Self> {
        let running = contacts.iter().map(|(shift, both)| {
            let [right, left] = [&both.right, &both.left].map(|side| side.points[0].rolling_radius);
            RunningPoint { shift: *shift, difference: right - left }
        });
        let points = contacts.iter().map(|(shift, both)| {
            let [right, left] = [&both.right, &both.left].map(|side| side.points[0].contact_angle.tan());
            FunctionPoint { shift: *shift, tangent_difference: right - left, roll: both.roll }
        });
        Ok(Self {
            points: points.collect(),
            running: RunningFunction::from_points(running.collect())?,
            half_distance: wheelset.tape_y,
            radius: 0.5 * (wheelset.right.radius + wheelset.left.radius),
        })
    }

    /// Rolling-radius difference.
    pub fn running(&self) -> &RunningFunction {
        &self.running
    }

    /// The points of the other functions.
    pub fn points(&self) -> &[FunctionPoint] {
        &self.points
    }

    /// One of the other functions at a shift, straight between the points.
    fn value(&self, of: impl Fn(&FunctionPoint) -> f64, shift: f64) -> f64 {
        let i = self.points.partition_point(|p| p.shift <= shift).clamp(1, self.points.len() - 1);
        let (a, b) = (&self.points[i - 1], &self.points[i]);
        of(a) + (of(b) - of(a)) * (shift - a.shift) / (b.shift - a.shift)
    }

    /// Slope, 1/m, of the straight function that has the first harmonic of `of` while the wheelset swings with the `amplitude` (m):
    /// 1/(π a) ∫ f(ȳ + a sin θ) sin θ dθ over a turn.
    fn harmonic_slope(&self, of: impl Fn(&FunctionPoint) -> f64, amplitude: f64) -> Option<f64> {
        /// Parts of half a turn.
        const PARTS: usize = 4000;
        let middle = self.running.middle(amplitude)?;
        let sum: f64 = (0..PARTS)
            .map(|i| {
                let sine = (((i as f64 + 0.5) / PARTS as f64 - 0.5) * PI).sin();
                self.value(&of, middle + amplitude * sine) * sine
            })
            .sum();
        Some(2.0 * sum / (PARTS as f64 * amplitude))
    }

    /// Contact-angle parameter ε at the `amplitude` (m): half the distance of the tape circles times the slope of
    /// (tan γ right − tan γ left)/2 over the shift, by harmonic linearisation about the middle of the oscillation.
    ///
    /// The linear wheelset has tan γ = tan γ₀ ± ε y/b (K. Knothe, S. Stichel, "Rail Vehicle Dynamics", Springer 2017; A.H. Wickens,
    /// "Fundamentals of Rail Vehicle Dynamics", 2003).
    pub fn contact_angle_parameter(&self, amplitude: f64) -> Option<f64> {
        let slope = self.harmonic_slope(|p| p.tangent_difference, amplitude)?;
        Some(0.5 * self.half_distance * slope)
    }

    /// Roll parameter σ at the `amplitude` (m): half the distance of the tape circles times the slope of the roll over the shift, positive
    /// where the wheel rises towards which the wheelset is shifted, by harmonic linearisation. The linear wheelset has the roll σ y/b (as above).
    pub fn roll_parameter(&self, amplitude: f64) -> Option<f64> {
        Some(-self.half_distance * self.harmonic_slope(|p| p.roll, amplitude)?)
    }

    /// Radius, m, of the tightest curve that the wheelset rolls through without slip before its flange touches: 2 b r₀/Δr_E.
    ///
    /// A wheelset rolls through a curve of the radius R without slip where its rolling-radius difference is 2 b r₀/R (Redtenbacher 1855; in Wickens,
    /// as above). Δr_E is the difference at the shift E where the flange `clearance` (m, left and right) is used up, in the direction in which it is
    /// less. `None` where no curve is, or the shifts do not reach that far.
    pub fn curve_radius(&self, [left, right]: [f64; 2]) -> Option<f64> {
        let [first, last] = [self.points[0].shift, self.points[self.points.len() - 1].shift];
        if !(left > 0.0 && right > 0.0 && first <= -left && right <= last) {
            return None;
        }
        let available = self.running.difference(right).min(-self.running.difference(-left));
        (available > 0.0).then(|| 2.0 * self.half_distance * self.radius / available)
    }

    /// Rolling radii coefficient in a curve of the `radius` (m): the rolling-radius difference at E over the one that rolling without slip
    /// needs, Δr_E R/(2 b r₀). From one on the wheelset can stand radially. E is as in [`ContactFunctions::curve_radius`].
    pub fn rolling_radii_coefficient(&self, clearance: [f64; 2], radius: f64) -> Option<f64> {
        Some(radius / self.curve_radius(clearance)?)
    }

    /// All parameters at these amplitudes (m), with the flange clearance (m, left and right) where it is known.
    pub fn parameters(&self, amplitudes: &[f64], clearance: Option<[f64; 2]>) -> Parameters {
        let at = |of: &dyn Fn(f64) -> Option<f64>| amplitudes.iter().map(|a| of(*a)).collect();
        Parameters {
            conicity: at(&|a| self.running.equivalent_conicity(a)),
            contact_angle: at(&|a| self.contact_angle_parameter(a)),
            roll: at(&|a| self.roll_parameter(a)),
            nonlinearity: self.running.nonlinearity(),
            curve_radius: clearance.and_then(|clearance| self.curve_radius(clearance)),
        }
    }
}

impl Wheelset {
    /// Shift, m, to the left and to the right that brings the flange face, 10 mm below the tape circle, to the gauge face, 14 mm below the top of
    /// the rail. Their sum is the gauge less the distance of the flange faces, TG − SR of EN 14363.
    ///
    /// `None` where a profile does not reach so deep.
    pub fn flange_clearance(&self) -> Option<[f64; 2]> {
        Some([self.left.flange_clearance(self.tape_y)?, self.right.flange_clearance(self.tape_y)?])
    }
}

impl WheelOnRail {
    /// As [`Wheelset::flange_clearance`], of this side.
    fn flange_clearance(&self, tape_y: f64) -> Option<f64> {
        let flange_face = crossing(&self.wheel, self.wheel.s_at_y(0.0)?, FLANGE_DEPTH)?;
        Some(gauge_face(&self.rail.curve)? - tape_y - flange_face)
    }
}

/// Lateral position of a rail's gauge face, m.
pub(super) fn gauge_face(rail: &ProfileCurve) -> Option<f64> {
    let height = |s: &&f64| rail.point(**s).y;
    let top = rail.knots().iter().min_by(|a, b| height(a).total_cmp(&height(b)))?;
    crossing(rail, *top, rail.point(*top).y + GAUGE_DEPTH)
}

/// Lateral position, m, at which a curve first reaches `depth` (z, m) on its way back from the arc length `from`.
fn crossing(curve: &ProfileCurve, from: f64, depth: f64) -> Option<f64> {
    let knots = curve.knots();
    let before = knots.partition_point(|&s| s < from);
    let reaching = (0..before).rev().find(|&i| curve.point(knots[i]).y >= depth)?;
    let above = if reaching + 1 < before { knots[reaching + 1] } else { from };
    let s = bisection(knots[reaching], above, |s| curve.point(s).y < depth);
    Some(curve.point(s).x)
}
