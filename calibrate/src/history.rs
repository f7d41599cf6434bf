//! The history of a run, step by step; the same for the solid model and
//! the moving solver, so that they can be compared line by line.

use std::fmt;

use nalgebra::Point2;

use crate::energy::EnergyBalance;

/// State of one contact between wheel and rail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactMode {
    /// Sticking: the tangential force is below the friction limit.
    Stick,
    /// Sliding: the tangential force is at the friction limit.
    Slip,
    /// Not touching.
    Separated,
}

impl ContactMode {
    /// Name used in files: `stick`, `slip` or `separated`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stick => "stick",
            Self::Slip => "slip",
            Self::Separated => "separated",
        }
    }
}

/// One contact patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactState {
    /// Sticking or sliding.
    pub mode: ContactMode,
    /// Force-weighted position on the rail, profile frame of the rail (y to the field side, z down), m.
    pub rail: Point2<f64>,
    /// Force-weighted position on the wheel, profile frame of the wheel (y from the tape circle to the field side, z down), m.
    pub wheel: Point2<f64>,
    /// Normal force, N.
    pub normal_force: f64,
    /// Lateral tangential force, N.
    pub tangential_force: f64,
}

/// State at the end of one time step.
#[derive(Debug, Clone, PartialEq)]
pub struct HistoryRow {
    /// Time, s.
    pub time: f64,
    /// Vertical force of the wheel on the rail, N, positive down.
    pub vertical_force: f64,
    /// Lateral force of the wheel on the rail, N, positive towards the field side.
    pub lateral_force: f64,
    /// Lateral displacement of the wheel centre since t = 0, m, positive towards the field side.
    pub wheel_y: f64,
    /// Vertical displacement of the wheel centre since t = 0, m, positive down.
    pub wheel_z: f64,
    /// Lateral displacement since t = 0 of the point where the lateral force acts, m: that of the wheel centre and the
    /// lengthening of the lateral suspension, which starts unloaded.
    pub load_y: f64,
    /// The balance of energy, J; none of bodies at full order, whose energies cost as much as a step.
    pub energy: Option<EnergyBalance>,
    /// The contacts that carry load, ordered from the gauge side to the field side; empty while separated.
    pub contacts: Vec<ContactState>,
}

impl HistoryRow {
    /// `Separated` without contact, `Stick` if any contact sticks, else `Slip`.
    pub fn mode(&self) -> ContactMode {
        if self.contacts.is_empty() {
            ContactMode::Separated
        } else if self.contacts.iter().any(|c| c.mode == ContactMode::Stick) {
            ContactMode::Stick
        } else {
            ContactMode::Slip
        }
    }
}

/// Where the wheel went when it left the rail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Departure {
    /// Over the rail to the field side: the flange has climbed the gauge face, or jumped over the head.
    FieldSide,
    /// Into the track: the field-side end of the tread has slid off the head.
    GaugeSide,
    /// Past an end of the rail along the track.
    RailEnd,
}

impl Departure {
    const ALL: [Self; 3] = [Self::FieldSide, Self::GaugeSide, Self::RailEnd];
}

/// How a run ended. A departure is a result: the history holds all states before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ending {
    /// All time steps were done with the wheel on the rail.
    Completed,
    /// The wheel left the rail.
    Departed {
        /// End of the first time step that has the wheel off the rail, s; the history ends a step before.
        time: f64,
        /// Where it went.
        departure: Departure,
    },
}

impl Ending {
    /// Name used in files: `completed`, `field-side`, `gauge-side` or `rail-end`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Completed => "completed",
            Self::Departed { departure: Departure::FieldSide, .. } => "field-side",
            Self::Departed { departure: Departure::GaugeSide, .. } => "gauge-side",
            Self::Departed { departure: Departure::RailEnd, .. } => "rail-end",
        }
    }

    /// When the wheel left the rail, s; `None` for a completed run.
    pub fn time(self) -> Option<f64> {
        match self {
            Self::Completed => None,
            Self::Departed { time, .. } => Some(time),
        }
    }

    /// The ending with this [`name`](Self::name) and [`time`](Self::time), if there is one.
    ///
    /// ```
    /// use railspring_calibrate::history::{Departure, Ending};
    /// let ending = Ending::Departed { time: 0.0435, departure: Departure::FieldSide };
    /// assert_eq!(Ending::from_parts(ending.name(), ending.time()), Some(ending));
    /// assert_eq!(Ending::from_parts("completed", Some(0.0435)), None);
    /// ```
    pub fn from_parts(name: &str, time: Option<f64>) -> Option<Self> {
        let found = match time {
            None => Some(Self::Completed),
            Some(time) => Departure::ALL
                .into_iter()
                .map(|departure| Self::Departed { time, departure })
                .find(|ending| ending.name() == name),
        };
        found.filter(|ending| ending.name() == name)
    }
}

impl fmt::Display for Ending {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self::Departed { time, departure } = *self else {
            return f.write_str("ran to its end");
        };
        // Microseconds are finer than the steps of any load case that derails a wheel.
        let time = (time * 1e6).round() / 1e6;
        match departure {
            Departure::FieldSide => {
                write!(f, "left the profile at {time} s (the flange over the rail, to the field side)")
            }
            Departure::GaugeSide => {
                write!(f, "left the profile at {time} s (the tread off the head, into the track)")
            }
            Departure::RailEnd => write!(f, "left the rail's end at {time} s"),
        }
    }
}

/// A whole run. Row 0 is the initial state.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// States, one per time step, the initial one first.
    pub rows: Vec<HistoryRow>,
    /// Degrees of freedom of the model.
    pub degrees_of_freedom: usize,
    /// How the run ended.
    pub ending: Ending,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: every ending survives its name and time, no two share a name, and the sentence has the time in seconds.
    #[test]
    fn endings_have_names_and_sentences() {
        let departed = Departure::ALL.map(|departure| Ending::Departed { time: 0.0435, departure });
        for ending in departed {
            assert_eq!(Ending::from_parts(ending.name(), ending.time()), Some(ending));
            assert!(ending.to_string().contains("at 0.0435 s"), "{ending}");
            assert_eq!(Ending::from_parts(ending.name(), None), None);
        }
        assert_eq!(Ending::from_parts("completed", None), Some(Ending::Completed));
        assert_eq!(Ending::from_parts("sideways", Some(1.0)), None);
        // 87 steps of half a millisecond, with their rounding.
        let time = (0..87).map(|_| 0.0005).sum();
        let sentence = Ending::Departed { time, departure: Departure::GaugeSide }.to_string();
        assert!(sentence.starts_with("left the profile at 0.0435 s"), "{sentence}");
    }
}
