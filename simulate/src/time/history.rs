//! The history of a run, step by step; the same for the solid model and
//! the moving solver, so that they can be compared line by line.

use std::fmt;

use nalgebra::Point2;

use crate::time::energy::EnergyBalance;
use railspring_profiles::error::StopReason;
use railspring_profiles::placement::Departure;

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

/// Where the surfaces that a model has come to an end, with the wheel still on the rail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SurfaceEnd {
    /// The end of the contact zone of the solid model across the rail: of the rail's mesh or of the wheel's.
    ContactZone,
    /// The end of the contact window of the solid model along the track.
    ContactWindow,
    /// The end of the rail's profile in the simple model.
    RailProfile,
}

impl SurfaceEnd {
    const ALL: [Self; 3] = [Self::ContactZone, Self::ContactWindow, Self::RailProfile];

    /// The end that a contact has reached which stopped for this reason; `None` for other reasons.
    pub fn of(reason: StopReason) -> Option<Self> {
        match reason {
            StopReason::EdgeOfCandidates => Some(Self::ContactZone),
            StopReason::EndOfWindow => Some(Self::ContactWindow),
            _ => None,
        }
    }
}

/// How a run ended. A run that ends early is a result: the history holds all states before the end.
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
    /// The contact reached a place at which the model has no surface any more; the wheel is still on the rail.
    EndOfSurface {
        /// End of the first time step whose contact carries load there, or begins beyond it, s; the history ends a step before.
        time: f64,
        /// Which end it is.
        end: SurfaceEnd,
        /// The place in the rail's profile frame, m.
        rail: Point2<f64>,
    },
}

impl Ending {
    /// Name used in files: `completed`; of a departure `field-side`, `gauge-side` or `rail-end`; of an end of the surfaces
    /// `contact-zone-end`, `contact-window-end` or `rail-profile-end`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Completed => "completed",
            Self::Departed { departure: Departure::FieldSide, .. } => "field-side",
            Self::Departed { departure: Departure::GaugeSide, .. } => "gauge-side",
            Self::Departed { departure: Departure::RailEnd, .. } => "rail-end",
            Self::EndOfSurface { end: SurfaceEnd::ContactZone, .. } => "contact-zone-end",
            Self::EndOfSurface { end: SurfaceEnd::ContactWindow, .. } => "contact-window-end",
            Self::EndOfSurface { end: SurfaceEnd::RailProfile, .. } => "rail-profile-end",
        }
    }

    /// When the run ended, s; `None` for a completed run.
    pub fn time(self) -> Option<f64> {
        match self {
            Self::Completed => None,
            Self::Departed { time, .. } | Self::EndOfSurface { time, .. } => Some(time),
        }
    }

    /// Where the contact reached the end of the surfaces, profile frame of the rail, m; `None` for other endings.
    pub fn rail(self) -> Option<Point2<f64>> {
        match self {
            Self::EndOfSurface { rail, .. } => Some(rail),
            Self::Completed | Self::Departed { .. } => None,
        }
    }

    /// The ending with this [`name`](Self::name), [`time`](Self::time) and [place](Self::rail), if there is one.
    ///
    /// ```
    /// use railspring_simulate::time::history::Ending;
    /// use railspring_profiles::placement::Departure;
    /// let ending = Ending::Departed { time: 0.0435, departure: Departure::FieldSide };
    /// assert_eq!(Ending::from_parts(ending.name(), ending.time(), ending.rail()), Some(ending));
    /// assert_eq!(Ending::from_parts("completed", Some(0.0435), None), None);
    /// ```
    pub fn from_parts(name: &str, time: Option<f64>, rail: Option<Point2<f64>>) -> Option<Self> {
        let endings: Vec<Self> = match (time, rail) {
            (None, None) => vec![Self::Completed],
            (Some(time), None) => Departure::ALL.map(|departure| Self::Departed { time, departure }).into(),
            (Some(time), Some(rail)) => {
                SurfaceEnd::ALL.map(|end| Self::EndOfSurface { time, end, rail }).into()
            }
            (None, Some(_)) => Vec::new(),
        };
        endings.into_iter().find(|ending| ending.name() == name)
    }
}

impl fmt::Display for Ending {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        // Microseconds are finer than the steps of any load case that derails a wheel.
        let rounded = |time: f64| (time * 1e6).round() / 1e6;
        match *self {
            Self::Completed => f.write_str("ran to its end"),
            Self::Departed { time, departure } => {
                let time = rounded(time);
                match departure {
                    Departure::FieldSide => {
                        write!(
                            f,
                            "left the profile at {time} s (the flange over the rail, to the field side)"
                        )
                    }
                    Departure::GaugeSide => {
                        write!(f, "left the profile at {time} s (the tread off the head, into the track)")
                    }
                    Departure::RailEnd => write!(f, "came to the end of the rail at {time} s"),
                }
            }
            Self::EndOfSurface { time, end, rail } => {
                let what = match end {
                    SurfaceEnd::ContactZone => "contact zone of the meshes",
                    SurfaceEnd::ContactWindow => "contact window along the track",
                    SurfaceEnd::RailProfile => "rail's profile",
                };
                write!(
                    f,
                    "the contact reached the end of the {what} at {} s (y = {:.1} mm, z = {:.1} mm of the rail's profile), \
                     with the wheel still on the rail",
                    rounded(time),
                    rail.x * 1e3,
                    rail.y * 1e3
                )
            }
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

    /// Goal: every ending survives its name, time and place, no two share a name, and the sentence has the time in seconds and the place
    /// in millimetres.
    #[test]
    fn endings_have_names_and_sentences() {
        let time = 0.0435;
        let rail = Point2::new(-0.0358, 0.0142);
        let departed = Departure::ALL.map(|departure| Ending::Departed { time, departure });
        let at_the_end = SurfaceEnd::ALL.map(|end| Ending::EndOfSurface { time, end, rail });
        for ending in departed.into_iter().chain(at_the_end) {
            assert_eq!(Ending::from_parts(ending.name(), ending.time(), ending.rail()), Some(ending));
            assert!(ending.to_string().contains("at 0.0435 s"), "{ending}");
            assert_eq!(Ending::from_parts(ending.name(), None, None), None);
            assert_eq!(Ending::from_parts(ending.name(), None, Some(rail)), None);
            let other = if ending.rail().is_some() { None } else { Some(rail) };
            assert_eq!(Ending::from_parts(ending.name(), Some(time), other), None, "{ending}");
        }
        for ending in at_the_end {
            assert!(ending.to_string().contains("y = -35.8 mm, z = 14.2 mm"), "{ending}");
        }
        assert_eq!(Ending::from_parts("completed", None, None), Some(Ending::Completed));
        assert_eq!(Ending::from_parts("sideways", Some(1.0), None), None);
        // 87 steps of half a millisecond, with their rounding.
        let time = (0..87).map(|_| 0.0005).sum();
        let sentence = Ending::Departed { time, departure: Departure::GaugeSide }.to_string();
        assert!(sentence.starts_with("left the profile at 0.0435 s"), "{sentence}");
    }
}
