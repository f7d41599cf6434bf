//! Plain data of the interface.

use nalgebra::{Matrix3, Vector3};
use railspring_element::contact::{ContactAt, Forces, Motions};
use railspring_element::unit::{Host, HostForces, Motion};

/// The place of a wheel on a rail that is not the study's: its head is as far from any held end.
pub const RAILSPRING_OTHER_RAIL: f64 = -1.0;

/// Motions of rim and rail section at the end of a step, from where the wheel just touches: displacements y, z (m) and the rotation about x (rad).
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct RailspringMotions {
    /// The rim as hub and modes have it, about the origin of the wheel's profile.
    pub rim: [f64; 3],
    /// The section of the rail, about its line of shear centres.
    pub section: [f64; 3],
    /// Place of the wheel along the study's rail, m from its first end; RAILSPRING_OTHER_RAIL on a rail of the host's own.
    pub place: f64,
}

/// Forces y, z (N) and torques about x (N·m) at the points of the motions.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct RailspringForces {
    /// On the rim: minus Q and P are the first two.
    pub rim: [f64; 3],
    /// On the section of the rail. Near a held end of the study's rail less than on its head, which the end holds as well.
    pub section: [f64; 3],
    /// Derivatives of rim and section forces by rim and section motions, six rows; N/m, N, N·m. Minus a stiffness, to the first order: after a step of 2 µm 2 % off in half of the states, of the largest of a block, 7 % in one of a hundred.
    pub tangent: [f64; 36],
}

/// A host's motions: displacements y, z (m) and the rotation about x (rad) from where the wheel just touches, velocities in m/s and rad/s.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct RailspringHost {
    /// The wheel's hub at its centre.
    pub hub: [f64; 3],
    /// Its velocity.
    pub hub_velocity: [f64; 3],
    /// The section of the rail, about its line of shear centres.
    pub section: [f64; 3],
    /// Its velocity.
    pub section_velocity: [f64; 3],
    /// Place of the wheel along the study's rail, m from its first end; RAILSPRING_OTHER_RAIL on a rail of the host's own.
    pub place: f64,
}

/// Forces y, z (N) and torques about x (N·m) at the points of a host's motions.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct RailspringHostForces {
    /// Of the wheel on its hub.
    pub hub: [f64; 3],
    /// Of the wheel on the section of the rail. Near a held end of the study's rail less than on its head, which the end holds as well.
    pub section: [f64; 3],
    /// On the rim, about the origin of the wheel's profile: minus Q and P are the first two.
    pub rim: [f64; 3],
}

/// A contact.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct RailspringPlace {
    /// Where its normal force acts on the rail (y, z), profile frame, m.
    pub rail: [f64; 2],
    /// The same on the wheel.
    pub wheel: [f64; 2],
    /// Force along the normal, N.
    pub normal_force: f64,
    /// Friction force on the wheel a quarter of a turn from the normal one, N.
    pub tangential_force: f64,
    /// Width along the profile, m.
    pub width: f64,
    /// 1 where it slides, 0 where it sticks.
    pub slides: i32,
}

/// What an element is like.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct RailspringAbout {
    /// Modes of the wheel.
    pub wheel_modes: usize,
    /// Modes of the rail in the file; 0 where it has none.
    pub rail_modes: usize,
    /// Coefficient of friction of the study.
    pub friction: f64,
    /// Largest normal force of the loads that the element was fitted to, N.
    pub largest_force: f64,
    /// Length of a rail with held ends, m; NaN where the head is the same everywhere.
    pub rail_length: f64,
    /// Place of the wheel for which the rail's modes are, m; NaN where there are none.
    pub place: f64,
    /// Damping over stiffness of the wheel's and of the rail's modes, s.
    pub damping: [f64; 2],
    /// From the origin of the wheel's profile to the hub's centre (y, z), m.
    pub hub: [f64; 2],
    /// Place of the rail's profile in the track: its turn from y towards z (rad), and where its origin is (y, z from the middle of the track and the top of the rail, m).
    pub rail: [f64; 3],
    /// From the rail's line of shear centres to the origin of the wheel's profile where it just touches (y, z), m.
    pub origin: [f64; 2],
}

pub(crate) fn vector(of: &[f64; 3]) -> Vector3<f64> {
    Vector3::from(*of)
}

/// A matrix by rows.
pub(crate) fn by_rows(matrix: &Matrix3<f64>) -> [f64; 9] {
    std::array::from_fn(|i| matrix[(i / 3, i % 3)])
}

impl From<&RailspringMotions> for Motions {
    fn from(of: &RailspringMotions) -> Self {
        Self { rim: vector(&of.rim), section: vector(&of.section), place: of.place }
    }
}

impl From<Forces> for RailspringForces {
    fn from(of: Forces) -> Self {
        let tangent = std::array::from_fn(|i| of.tangent[(i / 6, i % 6)]);
        Self { rim: of.rim.into(), section: of.section.into(), tangent }
    }
}

impl From<&RailspringHost> for Host {
    fn from(of: &RailspringHost) -> Self {
        let motion = |at: &[f64; 3], velocity: &[f64; 3]| Motion {
            displacement: vector(at),
            velocity: vector(velocity),
        };
        Self {
            hub: motion(&of.hub, &of.hub_velocity),
            section: motion(&of.section, &of.section_velocity),
            place: of.place,
        }
    }
}

impl From<HostForces> for RailspringHostForces {
    fn from(of: HostForces) -> Self {
        Self { hub: of.hub.into(), section: of.section.into(), rim: of.rim.into() }
    }
}

impl From<ContactAt> for RailspringPlace {
    fn from(of: ContactAt) -> Self {
        Self {
            rail: of.rail.into(),
            wheel: of.wheel.into(),
            normal_force: of.normal_force,
            tangential_force: of.tangential_force,
            width: of.width,
            slides: i32::from(of.slides),
        }
    }
}
