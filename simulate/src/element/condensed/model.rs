//! The condensed model: what it consists of.

use nalgebra::{Matrix3, Point2};

use crate::axle::axle_stiffness;
use crate::time::scenario::Scenario;
use crate::time::steps::{InnerSteps, StepControl};
use railspring_calibrate::beam::{End, HeldRail, RailBeam};
use railspring_calibrate::pair::Pair;
use railspring_calibrate::solid::Material;
use railspring_element::pair_element::PairElement;
use railspring_profiles::error::Result;
use railspring_profiles::placement::PlacedRail;
use railspring_profiles::profile::ProfileCurve;

use super::head::between_held_ends;
use crate::element::published::{InitialMotion, RailSupport};
use railspring_element::head::Head;

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
    /// The statics of the rail whose ends hold its sections; none of a rail that has no such ends.
    pub held: Option<HeldRail>,
    /// Stiffness of the axle against the wheel's rotation about x, N·m/rad, in scenarios that free the rotations.
    pub axle: f64,
    /// Damping of the wheel proportional to stiffness, s, as [`Material::damping`].
    pub damping: f64,
    /// Motion at t = 0.
    pub initial: InitialMotion,
}

impl CondensedModel {
    /// Steps of a run unless its scenario has others. In the published load cases P and Q are then off by 0.2 % of their peaks (RMS) at most (`cargo long own_steps`), a fifth of the error of the solid's steps.
    /// Eighths are the longest with which small forces, of which the tolerance says little, have the phase of the wheel's vibrations.
    pub const STEPS: InnerSteps = InnerSteps::Adaptive(StepControl { least: 8, most: 128, tolerance: 0.01 });

    /// The wheel of a calibrated pair on its rail as a beam; a beam with both ends fixed is the rail of the pair between held ends.
    /// `materials`: of rail and wheel; the axle has that of the wheel.
    pub fn of_pair(pair: &Pair, beam: RailBeam, [rail, wheel]: [&Material; 2], element: PairElement) -> Self {
        let end = element.held_end.as_ref().filter(|_| beam.ends() == [End::Fixed; 2]);
        let held = end.map(|end| HeldRail::new(&pair.properties, rail, beam.length(), end.inset));
        Self {
            held,
            rail: pair.placed.clone(),
            wheel: pair.wheel.running.clone(),
            tape: Point2::from(pair.tape()),
            support: RailSupport::Beam { beam, node_line: pair.node_line(), damping: rail.damping },
            element,
            axle: axle_stiffness(pair, wheel),
            damping: wheel.damping,
            initial: InitialMotion::default(),
        }
    }

    /// The head along the rail; a rail that does not move has none.
    pub(super) fn head(&self) -> Head {
        match (&self.support, &self.held, &self.element.held_end) {
            (RailSupport::Rigid, ..) => Head::same(Matrix3::zeros()),
            (RailSupport::Beam { beam, .. }, Some(rail), Some(end)) => between_held_ends(beam, rail, end),
            _ => Head::same(self.element.head_on_rail()),
        }
    }

    pub(super) fn check(&self, scenario: &Scenario) -> Result<()> {
        self.initial.check(scenario)?;
        self.support.check_start(scenario)
    }
}
