//! What a run leaves behind, step by step; the same for the solid model and
//! the moving solver, so that they can be compared line by line.

use nalgebra::Point2;

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

/// A whole run. Row 0 is the initial state.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// States, one a time step, the initial one first.
    pub rows: Vec<HistoryRow>,
    /// Degrees of freedom of the model.
    pub degrees_of_freedom: usize,
}
