//! A pair whose inputs are other ones than was taken.

use crate::pair::Pair;
use nalgebra::Vector2;
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::placement::TrackGeometry;
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::section::{RailSection, WheelSection};
use railspring_profiles::units::MILLIMETRE;
use std::f64::consts::TAU;

/// How far surfaces may be moved off the nodes of bodies that carry them, m. On the bodies of the unworn profiles, surfaces up to 3 mm off have
/// displacements within 1.6 %; half of that keeps it below what is asked here, a change of the displacement.
pub const FARTHEST: f64 = 1.5 * MILLIMETRE;
/// Largest distance of points of a running surface that has waves, m.
const STEP: f64 = 0.5 * MILLIMETRE;

/// By how much the inputs of a pair depart from what they are taken to be.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Departure {
    /// Wheel across the track, m.
    pub lateral: f64,
    /// Turn of the rail about its length, rad, from y towards z; its gauge face and its top stay where the track has them.
    pub rail_roll: f64,
    /// Turn of the wheel's profile about its tape circle, rad.
    pub wheel_roll: f64,
    /// Rolling radius at the tape circle, m.
    pub radius: f64,
    /// Waves of the rail's surface across it, m: of a cosine and of a sine.
    pub rail_waves: [f64; 2],
    /// The same of the wheel's surface.
    pub wheel_waves: [f64; 2],
    /// Length of these waves, m.
    pub wavelength: f64,
    /// Friction coefficient.
    pub friction: f64,
    /// Young's modulus of the rail, relative.
    pub rail_young: f64,
    /// The same of the wheel.
    pub wheel_young: f64,
    /// Poisson's ratio of both.
    pub poisson: f64,
}

impl Departure {
    /// The pair with these surfaces in these places; its bodies stay those of `pair`, which stands in `track`.
    ///
    /// # Errors
    /// [`InputError`] for surfaces that would lie farther than [`FARTHEST`] off their bodies, and those of [`Pair::with_surfaces`].
    pub fn pair(&self, pair: &Pair, track: &TrackGeometry) -> Result<Pair> {
        // surfaces on the bodies of others lie off them already, which has a band of its own
        let off = self.off_bodies(pair);
        if off > FARTHEST {
            return InputError::refuse(
                "departure",
                format!("surfaces up to {:.2} mm off their bodies", off / MILLIMETRE),
                format!("{:.1} mm at most", FARTHEST / MILLIMETRE),
                "give smaller uncertainties, or condense bodies of these surfaces",
            );
        }
        let rail = RailSection {
            running: waved(
                &pair.rail.running.transformed(self.rail_roll, Vector2::zeros()),
                self.rail_waves,
                self.wavelength,
            ),
            ..pair.rail.clone()
        };
        let wheel = WheelSection {
            running: waved(
                &pair.wheel.running.transformed(self.wheel_roll, Vector2::zeros()),
                self.wheel_waves,
                self.wavelength,
            ),
            radius: pair.wheel.radius + self.radius,
            ..pair.wheel.clone()
        };
        let off_bodies = pair.off_bodies.farther(off);
        Ok(Pair { off_bodies, ..pair.with_surfaces_at(rail, wheel, track, pair.tape_y + self.lateral)? })
    }

    /// How far the surfaces lie off the bodies, m: the ends of the running surfaces and the rail's shear centre turn most.
    fn off_bodies(&self, pair: &Pair) -> f64 {
        let reach = |curve: &ProfileCurve| {
            let ends = [curve.point(0.0), curve.point(curve.length())];
            ends.iter().map(|end| end.coords.norm()).fold(0.0, f64::max)
        };
        let waves = |[cosine, sine]: [f64; 2]| cosine.hypot(sine);
        let rail =
            self.rail_roll.abs() * pair.rail.height.max(reach(&pair.rail.running)) + waves(self.rail_waves);
        let wheel =
            self.wheel_roll.abs() * reach(&pair.wheel.running) + waves(self.wheel_waves) + self.radius.abs();
        rail.max(wheel)
    }
}

/// A curve with waves across it, of amplitudes of a cosine and a sine over the arc length (m) and of a length (m).
fn waved(curve: &ProfileCurve, [cosine, sine]: [f64; 2], wavelength: f64) -> ProfileCurve {
    if cosine == 0.0 && sine == 0.0 {
        return curve.clone();
    }
    let number = TAU / wavelength;
    curve.offset(STEP, |s| {
        let (up, along) = (number * s).sin_cos();
        [cosine * along + sine * up, number * (sine * along - cosine * up)]
    })
}
