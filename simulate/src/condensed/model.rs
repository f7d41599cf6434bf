//! The condensed model: what it consists of.

use nalgebra::Point2;

use railspring_calibrate::beam::RailBeam;
use railspring_calibrate::element::PairElement;
use railspring_calibrate::error::Result;
use railspring_calibrate::pair::Pair;
use railspring_calibrate::placement::PlacedRail;
use railspring_calibrate::profile::ProfileCurve;
use railspring_calibrate::scenario::Scenario;
use railspring_calibrate::solid::Material;

use crate::moving::{InitialMotion, RailSupport};

/// A condensed wheel on a rail, ready to run scenarios.
#[derive(Debug, Clone)]
pub struct CondensedModel {
    /// The rail in the world frame.
    pub rail: PlacedRail,
    /// Running surface of the wheel, profile frame.
    pub wheel: ProfileCurve,
    /// World position (y, z) of the wheel profile's origin, m, where the wheel just touches.
    pub tape: Point2<f64>,
    /// What carries the rail.
    pub support: RailSupport,
    /// Wheel, head and contact.
    pub element: PairElement,
    /// Stiffness of the axle against the wheel's rotation about x, N·m/rad, in scenarios that free the rotations.
    pub axle: f64,
    /// Damping of the wheel proportional to stiffness, s, as [`Material::damping`].
    pub damping: f64,
    /// Motion at t = 0.
    pub initial: InitialMotion,
}

impl CondensedModel {
    /// The wheel of a calibrated pair on its rail as a beam.
    pub fn of_pair(pair: &Pair, beam: RailBeam, material: &Material, element: PairElement) -> Self {
        Self {
            rail: pair.placed.clone(),
            wheel: pair.wheel.running.clone(),
            tape: Point2::from(pair.tape()),
            support: RailSupport::Beam { beam, node_line: pair.node_line(), damping: material.damping },
            element,
            axle: axle(pair, material),
            damping: material.damping,
            initial: InitialMotion::default(),
        }
    }

    pub(super) fn check(&self, scenario: &Scenario) -> Result<()> {
        self.initial.check(scenario)?;
        self.support.check_start(scenario)
    }
}

/// The axle as a beam between the two wheels, of the diameter of the hub's bore: a wheel turns it at its end while the other one stands,
/// 3EI/L.
fn axle(pair: &Pair, material: &Material) -> f64 {
    let diameter = 2.0 * pair.wheel.bore_radius;
    let inertia = std::f64::consts::PI * diameter.powi(4) / 64.0;
    3.0 * material.young * inertia / (2.0 * pair.tape_y)
}
