//! Load cases on which the time of a step is measured: the published one, a bridge that other programs were timed on, a wheel that rolls along.

use crate::time::function::{HarmonicForce, TimeFunction};
use crate::time::scenario::{Kelvin, Scenario};
use railspring_calibrate::beam::{BeamSection, End, RailBeam};
use railspring_profiles::error::Result;

/// Acceleration of gravity of the load cases with weight, m/s².
pub const GRAVITY: f64 = 9.81;

/// Friction of all load cases.
const FRICTION: f64 = 0.5;

/// A beam on two supports without deflection by shear, stiff against tension and torsion: bending stiffness (N·m²), mass (kg/m), length (m), elements.
///
/// # Errors
/// Those of [`RailBeam::new`].
pub fn simply_supported(bending: f64, mass: f64, length: f64, elements: usize) -> Result<RailBeam> {
    let section = BeamSection {
        axial: 1e12,
        bending_y: bending,
        bending_z: bending,
        shear_y: f64::INFINITY,
        shear_z: f64::INFINITY,
        torsion: 1e12,
        mass,
        rotary_y: 0.0,
        rotary_z: 0.0,
        polar: mass,
        centroid: [0.0; 2],
    };
    RailBeam::new(section, length, elements, 0.0, [End::Pinned; 2])
}

/// The bridge of the program VBI-2D: E 35 GPa, I 1.3901 m⁴, 18358 kg/m, 25 m.
///
/// # Errors
/// As [`simply_supported`].
pub fn bridge(elements: usize) -> Result<RailBeam> {
    simply_supported(3.5e10 * 1.3901, 18_358.0, 25.0, elements)
}

/// A sprung wheel that crosses [`bridge`] at 300 km/h in 1200 steps of 0.25 ms.
pub fn crossing() -> Scenario {
    Scenario {
        gravity: GRAVITY,
        speed: 300.0 / 3.6,
        start_x: Some(0.0),
        suspended_mass: 5750.0,
        vertical_suspension: Kelvin { stiffness: 1.595e6, damping: 0.0 },
        ..Scenario::new(1200, 2.5e-4, FRICTION)
    }
}

/// A sprung wheel that rolls along at 5 m/s, 600 steps of 0.25 ms.
pub fn rolling() -> Scenario {
    Scenario {
        gravity: GRAVITY,
        speed: 5.0,
        suspended_mass: 6250.0,
        vertical_suspension: Kelvin { stiffness: 1.2e6, damping: 4e4 },
        ..Scenario::new(600, 2.5e-4, FRICTION)
    }
}

/// Section 4.1 of the publication: a constant lateral force, 550 steps of 0.5 ms.
pub fn constant_lateral_force() -> Scenario {
    let suspension = Kelvin { stiffness: 1.2e6, damping: 4e4 };
    Scenario {
        suspended_mass: 6250.0,
        vertical_suspension: suspension,
        vertical_force: HarmonicForce { constant: 10e3, amplitude: 61.25e3, frequency: 10.0, phase: 0.0 }
            .into(),
        lateral_suspension: suspension,
        lateral_force: TimeFunction::constant(20e3),
        ..Scenario::new(550, 5e-4, FRICTION)
    }
}
