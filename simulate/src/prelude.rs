//! What a program needs to run load cases: `use railspring_simulate::prelude::*`.

pub use crate::element::condensed::{CondensedModel, ElementFit};
pub use crate::element::published::{InitialMotion, MovingModel, WheelSprings};
pub use crate::solid::{ModeCount, TransientModel};
pub use crate::time::function::{HarmonicForce, TimeFunction};
pub use crate::time::scenario::{Kelvin, Scenario};
pub use railspring_calibrate::prelude::*;
