//! Where rails and wheels are in the track: gauge, inclination, shift.

use crate::error::{InputError, Result};
use crate::field::InputField;
use crate::profile::ProfileCurve;
use crate::units::MILLIMETRE;

/// Where rails and wheels are in the track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackGeometry {
    /// Distance of the gauge faces, m.
    pub gauge: f64,
    /// Depth below the top of the inclined rail at which the gauge is measured, m.
    pub gauge_height: f64,
    /// Distance of the flange backs of a wheelset, m.
    pub flange_back: f64,
    /// Slope by which the rail leans towards the track centre, for instance 1/40.
    pub inclination: f64,
    /// Lateral shift of the wheelset, m, positive towards the field side of the right rail.
    pub lateral_shift: f64,
}

impl TrackGeometry {
    /// Standard gauge: 1435 mm measured 14 mm below the top, flange backs 1360 mm, inclination 1:40, no shift.
    pub fn standard() -> Self {
        Self {
            gauge: 1.435,
            gauge_height: 0.014,
            flange_back: 1.360,
            inclination: 1.0 / 40.0,
            lateral_shift: 0.0,
        }
    }

    /// Lateral position of the right wheel's tape circle, m: the `wheel` (profile frame) begins at the flange back.
    ///
    /// ```
    /// use railspring_profiles::placement::TrackGeometry;
    /// use railspring_profiles::profile::wheels::wheel_profile;
    /// let track = TrackGeometry::standard();
    /// assert!((track.tape_y(&wheel_profile("S1002")?) - 0.750).abs() < 1e-15);
    /// // 2 27/32 inches instead of 70 mm from the flange back
    /// assert!((track.tape_y(&wheel_profile("APTA120")?) - 0.752231).abs() < 1e-6);
    /// # Ok::<(), railspring_profiles::error::Error>(())
    /// ```
    pub fn tape_y(&self, wheel: &ProfileCurve) -> f64 {
        0.5 * self.flange_back - wheel.point(0.0).x + self.lateral_shift
    }

    /// Checks every value against what a track can have.
    ///
    /// # Errors
    /// [`InputError`] naming the field of the first value out of range.
    pub fn check(&self) -> Result<()> {
        let in_millimetres = [
            (InputField::Gauge, self.gauge, 300.0, 3000.0),
            (InputField::GaugeHeight, self.gauge_height, 1.0, 30.0),
            (InputField::FlangeBack, self.flange_back, 250.0, 3000.0),
            (InputField::LateralShift, self.lateral_shift, -100.0, 100.0),
        ];
        for (field, value, least, greatest) in in_millimetres {
            if !(least..=greatest).contains(&(value / MILLIMETRE)) {
                return InputError::refuse(
                    field,
                    format!("{} mm", value / MILLIMETRE),
                    format!("{least} to {greatest} mm"),
                    "check the value and its unit",
                );
            }
        }
        if !(-0.2..=0.2).contains(&self.inclination) {
            return InputError::refuse(
                InputField::Inclination,
                self.inclination,
                "a slope between -0.2 and 0.2",
                "give the slope, for instance 0.025 for 1:40",
            );
        }
        Ok(())
    }
}
