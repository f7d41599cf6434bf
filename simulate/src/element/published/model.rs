//! The moving solver: what a model consists of, and what a run gives.

use nalgebra::{Matrix2, Point2};

use crate::axle::axle_stiffness;
use crate::time::history::History;
use crate::time::scenario::Scenario;
use crate::time::steps::InnerSteps;
use railspring_calibrate::beam::RailBeam;
use railspring_calibrate::pair::Pair;
use railspring_calibrate::solid::Material;
use railspring_profiles::error::{InputError, Result};
use railspring_profiles::field::InputField;
use railspring_profiles::placement::{PlacedRail, Touch};
use railspring_profiles::profile::ProfileCurve;
use railspring_profiles::section::body_of_revolution;
use railspring_profiles::units::{KILONEWTON, KILONEWTON_PER_METRE, MILLIMETRE, TONNE};

use super::support::RailSupport;
use super::surface::SlidingMatrix;
use super::wheel::WheelSprings;

/// Motion of the wheel centre at t = 0 relative to the just-touching position at rest.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct InitialMotion {
    /// Displacement (y, z), m; a negative z lifts the wheel (drop height), a positive one presses it on.
    pub displacement: [f64; 2],
    /// Velocity (y, z), m/s.
    pub velocity: [f64; 2],
    /// Vertical force of the rail under which suspension and body of the wheel are deflected already, N: for a wheel that starts in balance all that it carries.
    pub carried: f64,
}

impl InitialMotion {
    /// How far the suspension of a wheel of a mass (kg) is compressed, m.
    pub(crate) fn stroke(&self, scenario: &Scenario, mass: f64) -> f64 {
        let stiffness = scenario.vertical_suspension.stiffness;
        let force = self.carried - mass * scenario.gravity;
        if self.carried > 0.0 && stiffness > 0.0 { force / stiffness } else { 0.0 }
    }

    /// Whether a run can start so and go on with the steps of a scenario.
    pub(crate) fn check(&self, scenario: &Scenario) -> Result<()> {
        let motion = [&self.displacement[..], &self.velocity, &[self.carried]].concat();
        if let Some(value) = motion.iter().find(|v| !v.is_finite()) {
            return InputError::refuse("initial motion", value, "finite values", "correct the value");
        }
        Ok(scenario.check()?)
    }
}

/// A wheel pressed on the rail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HubStatics {
    /// Displacement of the hub along the direction in which it is pressed, against the rail's section, m.
    pub displacement: f64,
    /// Displacements y and z of the hub against the rail's section under small further forces, everything sticking, m/N.
    pub flexibility: Matrix2<f64>,
}

/// A wheel on a rail, ready to run scenarios.
#[derive(Debug, Clone)]
pub struct MovingModel {
    /// The rail in the world frame.
    pub rail: PlacedRail,
    /// Running surface of the wheel, profile frame.
    pub wheel: ProfileCurve,
    /// Rolling radius at the tape circle, m: the wheel centre lies so far above the profile's origin.
    pub wheel_radius: f64,
    /// World position (y, z) of the wheel profile's origin, m, where the wheel just touches.
    pub tape: Point2<f64>,
    /// What carries the rail.
    pub support: RailSupport,
    /// Springs between wheel centre and contact.
    pub springs: WheelSprings,
    /// Mass of the wheel, kg, unless the scenario has one.
    pub wheel_mass: f64,
    /// Moments of inertia of the wheel about x, y and z, kg·m², for scenarios that free the
    /// rotations. The element loads only the one about x; pitch and yaw stay zero.
    pub wheel_inertia: [f64; 3],
    /// Stiffness of the axle against the wheel's rotation about x, N·m/rad, in the same scenarios.
    pub axle: f64,
    /// Penalty constant of each contact node, N/m.
    pub penalty: f64,
    /// Distance of the rail nodes along the profile, m.
    pub node_spacing: f64,
    /// Arc lengths of the wheel, m, between which friction is left out (the publication's region from a to b).
    pub frictionless: Option<(f64, f64)>,
    /// Iteration matrix of sliding contacts.
    pub sliding: SlidingMatrix,
    /// Numerical dissipation δ of Newmark's scheme (γ = 1/2 + δ); 0 is the published average acceleration.
    pub dissipation: f64,
    /// Motion at t = 0.
    pub initial: InitialMotion,
}

/// Counts and errors of a run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RunStatistics {
    /// Steps of the integration that were taken.
    pub steps: usize,
    /// Newton iterations of all of them.
    pub iterations: usize,
    /// Most iterations of one step.
    pub most_iterations: usize,
    /// Evaluations of the contact: those of the iterations, of line searches and of steps that were done again.
    pub evaluations: usize,
    /// Steps that the symmetric matrix of equation (4) did not end and that of equation (3) did.
    pub consistent_steps: usize,
    /// Time steps that had to be halved.
    pub halved_steps: usize,
    /// Largest ratio of the penetration to the deformation of the springs between wheel centre and contact in the same step,
    /// over the steps with at least a tenth of the largest contact force. The published criterion asks for less than 1/1000 of
    /// the deformation at the wheel centre; the rail's displacement is left out of it, because that passes through any
    /// value, the opposite of the springs' included, while the rail swings, and grows with the rail's length.
    pub penalty_error: f64,
}

/// Displacement of a rail section since t = 0, at its node line.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SectionMotion {
    /// Displacement (y, z), m.
    pub displacement: [f64; 2],
    /// Rotation about x, rad, from y towards z.
    pub rotation: f64,
}

/// The result of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct MovingRun {
    /// States, one per time step, the initial one first.
    pub history: History,
    /// Motion of the rail at the wheel, one for each row of the history.
    pub rail: Vec<SectionMotion>,
    /// Counts and errors.
    pub statistics: RunStatistics,
}

impl MovingModel {
    /// Steps of a run unless its scenario has others. In the published load case 4.1, P is then off by four thousandths of its peak (RMS).
    pub const STEPS: InnerSteps = InnerSteps::Equal(16);

    /// Default penalty, N/m: with the published law and scenarios the penetration stays below the published 1/1000.
    pub const DEFAULT_PENALTY: f64 = 1e12;
    /// Default distance of the rail nodes, m.
    pub const DEFAULT_NODE_SPACING: f64 = 0.25e-3;

    /// A wheel that just touches the rail at `touch`, its tape circle at the world position `tape_y` (m).
    #[expect(clippy::too_many_arguments, reason = "the parts of the model, all of different types")]
    pub fn new(
        rail: PlacedRail,
        wheel: ProfileCurve,
        wheel_radius: f64,
        tape_y: f64,
        touch: &Touch,
        support: RailSupport,
        springs: WheelSprings,
        wheel_mass: f64,
    ) -> Self {
        Self {
            rail,
            wheel,
            wheel_radius,
            tape: Point2::new(tape_y, touch.tape_z),
            support,
            springs,
            wheel_mass,
            // A thin ring at the tape circle; studies that free the rotations give better values.
            wheel_inertia: [0.5, 1.0, 0.5].map(|share| share * wheel_mass * wheel_radius.powi(2)),
            axle: 0.0,
            penalty: Self::DEFAULT_PENALTY,
            node_spacing: Self::DEFAULT_NODE_SPACING,
            frictionless: None,
            sliding: SlidingMatrix::default(),
            dissipation: 0.0,
            initial: InitialMotion::default(),
        }
    }

    /// The wheel of a calibrated pair on its rail as a beam, of the materials of `rail` and `wheel`; the wheel's inertia is that of a
    /// solid body of `wheel_mass` (kg).
    pub fn of_pair(
        pair: &Pair,
        beam: RailBeam,
        [of_rail, of_wheel]: [&Material; 2],
        springs: WheelSprings,
        wheel_mass: f64,
    ) -> Self {
        let support = RailSupport::Beam { beam, node_line: pair.node_line(), damping: of_rail.damping };
        let (rail, wheel) = (pair.placed.clone(), pair.wheel.running.clone());
        let radius = pair.wheel.radius;
        let mut model =
            Self::new(rail, wheel, radius, pair.tape_y, &pair.touch, support, springs, wheel_mass);
        let body = body_of_revolution(&pair.wheel, of_wheel.density);
        let scale = wheel_mass / body.mass;
        model.wheel_inertia =
            [body.diameter_inertia, body.axle_inertia, body.diameter_inertia].map(|i| i * scale);
        model.axle = axle_stiffness(pair, of_wheel);
        model
    }

    /// Whether the model can run a scenario.
    pub(super) fn check(&self, scenario: &Scenario) -> Result<()> {
        if let InnerSteps::Adaptive(_) = scenario.inner_steps {
            let remedy = "give their number: a step costs little";
            let expected = "equal steps for the published element";
            return Err(
                InputError::new(InputField::InnerSteps, "steps of adapted length", expected, remedy).into()
            );
        }
        let mass = scenario.wheel_mass.unwrap_or(self.wheel_mass);
        let per_metre = (KILONEWTON_PER_METRE, " kN/m");
        let suspension = scenario.vertical_suspension;
        // with the unit in which a value is said, and its size
        let positive = [
            (InputField::Penalty, self.penalty, per_metre),
            (InputField::NodeSpacing, self.node_spacing, (MILLIMETRE, " mm")),
            (InputField::HorizontalStiffness, self.springs.horizontal, per_metre),
            (InputField::TapeDiameter, 2.0 * self.wheel_radius, (1.0, " m")),
            (InputField::WheelMass, mass, (TONNE, " t")),
            (InputField::TimeStep, scenario.time_step, (1.0, " s")),
        ];
        let not_negative = [
            (InputField::Friction, scenario.friction, (1.0, "")),
            (InputField::SuspendedMass, scenario.suspended_mass, (TONNE, " t")),
            (InputField::VerticalStiffness, suspension.stiffness, per_metre),
            (InputField::VerticalDamping, suspension.damping, (KILONEWTON, " kN·s/m")),
            (InputField::Dissipation, self.dissipation, (1.0, "")),
        ];
        for (entries, least, expected) in
            [(&positive[..], f64::MIN_POSITIVE, "a positive value"), (&not_negative[..], 0.0, "zero or more")]
        {
            if let Some((field, value, (unit, name))) =
                entries.iter().find(|(_, v, _)| !(v.is_finite() && *v >= least))
            {
                let value = format!("{}{name}", value / unit);
                return InputError::refuse(*field, value, expected, "correct the value");
            }
        }
        if self.rail.curve.length() / self.node_spacing > 1e5 {
            let remedy = "0.25 mm is fine enough";
            return InputError::refuse(
                InputField::NodeSpacing,
                format!("{} mm", self.node_spacing / MILLIMETRE),
                "a larger distance",
                remedy,
            );
        }
        self.initial.check(scenario)?;
        self.springs.normal.check()?;
        self.support.check_start(scenario)
    }
}
