//! The transient solid model: Newmark average acceleration on both bodies, contact solved at every step.
//!
//! A wheel of reduced bodies may move along its rail ([`RailPath`]), or stand anywhere on it.
//!
//! The bodies are reduced or at full order ([`SolidBodies`]). A reduced body has the static compliance of its contact nodes and a few
//! modes, whose number an estimate chooses ([`Reduction`]). At full order the effective matrix `K + 4/Δt²·M` of each body is
//! factored once; a step eliminates the interior, solves the contact on the retained equations, and substitutes back.
//!
//! The contact nodes have no mass ([`System::with_massless_contact`]): a node with mass collides with every step, its
//! force alternates between zero and a multiple of the true one, and the work of these forces adds energy.

mod along;
mod path;
mod loads;
mod at_place;
mod body;
mod full;
mod reduced;
mod last_contact;
mod contact;
mod run;
mod beyond;
mod reduction;
#[cfg(test)]
mod tests;

pub use path::RailPath;
pub use reduction::{ModeCount, Reduction, START_MODES};

use crate::time::history::History;
use crate::time::newmark::Newmark;
use crate::time::scenario::Scenario;
use crate::time::steps::InnerSteps;
use crate::time::suspension::Suspension;
use beyond::Beyond;
use body::ElasticBody;
use full::FullBody;
use nalgebra::{Point2, Point3, Vector2};
use railspring_calibrate::calibration::{ContactField, Enforcement};
use railspring_calibrate::contact::Surface;
use railspring_calibrate::mesh::{HexMesh, SurfaceGrid};
use railspring_calibrate::pair::Pair;
use railspring_calibrate::solid::{Formulation, Material, Materials, Supports, System};
use railspring_calibrate::superelement::{CondensedBody, Modes};
use railspring_profiles::error::{Error, InputError, Result};
use railspring_profiles::field::InputField;
use railspring_profiles::monitor::Monitor;
use railspring_profiles::placement::PlacedRail;
use railspring_profiles::units::KILONEWTON;
use reduced::ReducedBody;
use run::{Observer, Run, ShorterSteps};

/// Everything the transient solid model is made of.
pub struct TransientModel<'a> {
    /// Rail and wheel.
    pub bodies: SolidBodies<'a>,
    /// Materials at the contact surfaces of rail and wheel, with the damping of both bodies, which is the same.
    pub materials: [Material; 2],
    /// The placed rail, for positions in its profile frame.
    pub placed_rail: &'a PlacedRail,
    /// The rail's shear centre, world (y, z), m: about it its section turns under the wheel. None: it turns where the contact is.
    pub rail_axis: Option<Point2<f64>>,
    /// Contact surface of the rail.
    pub rail_surface: Surface<'a>,
    /// Contact surface of the wheel, just touching.
    pub wheel_surface: Surface<'a>,
    /// How the contact conditions are enforced.
    pub enforcement: Enforcement,
    /// Where the contact lives.
    pub field: ContactField,
    /// The rail at all places of the wheel; none: the wheel stays in its middle. Of reduced bodies alone.
    pub path: Option<&'a RailPath>,
}

/// Rail and wheel of a transient model: the rail in the world frame with its ends held, the wheel in its body frame with its bore
/// following the master node at its centre.
#[derive(Clone, Copy)]
pub enum SolidBodies<'a> {
    /// All equations of the meshes, factored for the time step: what reduced bodies are compared with.
    Full {
        /// Mesh of the rail.
        rail: &'a HexMesh,
        /// Mesh of the wheel.
        wheel: &'a HexMesh,
        /// Materials of rail and wheel.
        materials: [&'a Materials; 2],
        /// Element of both.
        formulation: Formulation,
    },
    /// Condensed bodies with their modes ([`CondensedBody::modes`]).
    Reduced {
        /// The rail between its ends.
        rail: &'a CondensedBody,
        /// The wheel against its hub.
        wheel: &'a CondensedBody,
        /// How many of their modes are used.
        modes: ModeCount,
    },
}

impl<'a> TransientModel<'a> {
    /// The solid model of a pair at full order.
    pub fn of_pair(
        pair: &'a Pair,
        [rail, wheel]: [&'a HexMesh; 2],
        materials: [&'a Materials; 2],
        formulation: Formulation,
        contact: (Enforcement, ContactField),
    ) -> Self {
        let bodies = SolidBodies::Full { rail, wheel, materials, formulation };
        let surfaces = [materials[0].at_contact(rail), materials[1].at_contact(wheel)];
        Self::with(pair, bodies, [&rail.contact, &wheel.contact], surfaces, contact)
    }

    /// The solid model of a pair with reduced bodies: the rail between its ends and the wheel, both with modes and with a `damping`
    /// ([`Material::damping`]).
    pub fn reduced(
        pair: &'a Pair,
        [rail, wheel]: [&'a CondensedBody; 2],
        modes: ModeCount,
        damping: f64,
        contact: (Enforcement, ContactField),
    ) -> Self {
        let bodies = SolidBodies::Reduced { rail, wheel, modes };
        let surfaces = [rail, wheel].map(|body| Material { damping, ..body.surface });
        Self::with(pair, bodies, [&rail.grid, &wheel.grid], surfaces, contact)
    }

    /// The bodies of a pair with the grids of their contact surfaces.
    fn with(
        pair: &'a Pair,
        bodies: SolidBodies<'a>,
        [rail, wheel]: [&'a SurfaceGrid; 2],
        materials: [Material; 2],
        (enforcement, field): (Enforcement, ContactField),
    ) -> Self {
        Self {
            bodies,
            materials,
            placed_rail: &pair.placed,
            rail_axis: Some(pair.node_line()),
            rail_surface: pair.rail_surface(rail),
            wheel_surface: pair.wheel_surface(wheel),
            enforcement,
            field,
            path: None,
        }
    }

    /// The same with a wheel that moves along its rail, or stands anywhere on it, and a torsion of that ([`RailPath::is_wanted`]).
    pub fn along(self, path: &'a RailPath) -> Self {
        Self { path: Some(path), ..self }
    }
}

/// A finished transient run of the solid model.
pub struct TransientRun {
    /// The states.
    pub history: History,
    /// Mass of the meshed wheel, kg.
    pub wheel_mass: f64,
    /// Values stored in the factors of both bodies; none if they are reduced.
    pub factor_values: usize,
    /// Largest number of load-carrying contact points in a step.
    pub most_active: usize,
    /// Steps of the integration.
    pub steps: StepCounts,
    /// The same with steps of the integration that are twice as long, of bodies at full order the first time steps; none where there are no longer ones.
    pub longer: Option<OtherRun>,
    /// The other load case of [`TransientModel::run_beside`], if there is one.
    pub other: Option<OtherRun>,
    /// The modes of reduced bodies, and what they are worth.
    pub reduction: Option<Reduction>,
}

/// A run that another one is compared with, or why it could not be done.
pub type OtherRun = std::result::Result<History, String>;

/// Steps of the integration of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StepCounts {
    /// Those that the run is made of.
    pub taken: usize,
    /// All that were solved, with those that were taken again because they were too long.
    pub tried: usize,
}

impl TransientModel<'_> {
    /// Runs `scenario` from just touching and at rest.
    ///
    /// # Errors
    /// [`InputError`] for a scenario only the moving solver can run, for penalty springs on a fine grid, and for reduced bodies
    /// without modes; [`railspring_profiles::error::NumericsError`] with the step if the contact does not settle, and with
    /// [`railspring_profiles::error::StopReason::TooFewModes`] if all modes that the bodies have are not enough. A contact that reaches the end of
    /// the meshed contact zone, and one that begins beyond it, ends the history ([`crate::time::history::Ending::EndOfSurface`]).
    pub fn run(&self, scenario: &Scenario, monitor: &dyn Monitor) -> Result<TransientRun> {
        self.run_with(scenario, None, monitor)
    }

    /// The same, and on another thread, if there is one, a second load case with the same time steps and the same bodies
    /// ([`TransientRun::other`]); one that cannot be solved takes nothing from the run.
    ///
    /// # Errors
    /// As [`TransientModel::run`], and [`InputError`] for bodies at full order, of which every run has its own.
    pub fn run_beside(
        &self,
        scenario: &Scenario,
        other: &Scenario,
        monitor: &dyn Monitor,
    ) -> Result<TransientRun> {
        if let SolidBodies::Full { .. } = self.bodies {
            return Err(InputError::new(
                "a second load case",
                "bodies at full order",
                "reduced bodies, which several runs share",
                "run the two one after the other",
            )
            .into());
        }
        self.run_with(scenario, Some(other), monitor)
    }

    /// The first 60 ms of a load case, in which models are compared that take long.
    pub fn first_of(scenario: &Scenario) -> Scenario {
        reduction::first_of(scenario)
    }

    /// A load case with so many `modes` of each reduced body, and with nothing beside: what it changes by on other meshes or another grid says
    /// what these are worth.
    ///
    /// # Errors
    /// As [`TransientModel::run`], and [`InputError`] for bodies at full order.
    pub fn run_alone(&self, modes: usize, scenario: &Scenario, monitor: &dyn Monitor) -> Result<History> {
        self.check(scenario)?;
        if let SolidBodies::Full { .. } = self.bodies {
            let value = "bodies at full order";
            return Err(InputError::new("a run alone", value, "reduced bodies", "reduce them").into());
        }
        reduction::alone(self, modes, scenario, monitor)
    }

    /// Checks that the model can run a load case.
    fn check(&self, scenario: &Scenario) -> Result<()> {
        match (self.path, self.bodies) {
            (Some(path), SolidBodies::Reduced { .. }) => path.holds(scenario)?,
            _ => refuse_moving(scenario)?,
        }
        scenario.check()?;
        self.field.check(self.enforcement)
    }

    fn run_with(
        &self,
        scenario: &Scenario,
        other: Option<&Scenario>,
        monitor: &dyn Monitor,
    ) -> Result<TransientRun> {
        for scenario in [Some(scenario), other].into_iter().flatten() {
            self.check(scenario)?;
        }
        if let (SolidBodies::Full { .. }, InnerSteps::Adaptive(_)) = (self.bodies, scenario.inner_steps) {
            return Err(no_shorter_steps());
        }
        match self.bodies {
            SolidBodies::Full { .. } => {
                let from_rest = |scenario: &Scenario| {
                    let mut beyond = Beyond::new(self, scenario);
                    self.run_from(&Vector2::zeros(), scenario, monitor, &mut |step| Ok(beyond.reached(step)))
                };
                let run = from_rest(scenario)?;
                let longer = reduction::longer_steps(&reduction::first_of(scenario), |longer| {
                    Ok(from_rest(longer)?.history)
                })?;
                Ok(TransientRun { longer, ..run })
            }
            SolidBodies::Reduced { modes, .. } => reduction::run(self, modes, scenario, other, monitor),
        }
    }

    /// Runs `scenario` from just touching, the wheel with a velocity (y, z; m/s), and the suspended mass with that of the wheel;
    /// `observe` sees every finished step and ends the run where that has reached an end of the surfaces. Reduced bodies have all their modes.
    fn run_from(
        &self,
        velocity: &Vector2<f64>,
        scenario: &Scenario,
        monitor: &dyn Monitor,
        observe: &mut Observer,
    ) -> Result<TransientRun> {
        match self.bodies {
            SolidBodies::Full { .. } => {
                let bodies = self.full_bodies(scenario)?;
                let shorter = |_: &Newmark| Err(no_shorter_steps());
                self.run_bodies(&bodies, &shorter, velocity, scenario, monitor, observe)
            }
            SolidBodies::Reduced { .. } => {
                let with = |scheme: &Newmark| self.reduced_bodies(scenario, self.most_modes(), scheme);
                let bodies = with(&longest(scenario))?;
                self.run_bodies(&bodies, &with, velocity, scenario, monitor, observe)
            }
        }
    }

    fn run_bodies<B: ElasticBody>(
        &self,
        bodies: &[B; 2],
        shorter: &ShorterSteps<B>,
        velocity: &Vector2<f64>,
        scenario: &Scenario,
        monitor: &dyn Monitor,
        observe: &mut Observer,
    ) -> Result<TransientRun> {
        let mut run = Run::new(self, scenario, velocity, bodies.each_ref(), shorter);
        run.finish(("transient solid model", monitor), observe)?;
        Ok(run.ended())
    }

    fn full_bodies(&self, scenario: &Scenario) -> Result<[FullBody<'_>; 2]> {
        let SolidBodies::Full { rail, wheel, materials, formulation } = self.bodies else {
            unreachable!("bodies at full order");
        };
        let scheme = longest(scenario);
        let stiffness = Suspension::new(scenario, &scheme).stiffness();
        let on_ends = Supports { held: rail.ends.clone(), ..Default::default() };
        let mut master_free = [false; 6];
        hub_motions(scenario).iter().for_each(|&motion| master_free[motion] = true);
        let on_hub = Supports {
            held: Vec::new(),
            followers: wheel.bore.clone(),
            master: Point3::origin(),
            master_free,
        };
        let body = |mesh, materials: &Materials, supports, hub_stiffness| {
            let system = System::new(mesh, materials.clone(), formulation, supports)?;
            FullBody::new(system.with_massless_contact(), &scheme, hub_stiffness)
        };
        let [of_rail, of_wheel] = materials;
        let (rail, wheel) = rayon::join(
            || body(rail, of_rail, &on_ends, None),
            || body(wheel, of_wheel, &on_hub, Some(stiffness)),
        );
        Ok([rail?, wheel?])
    }

    /// Damping of both bodies, s.
    fn damping(&self) -> f64 {
        self.materials[0].damping
    }

    /// The number of modes that the body with more of them has.
    fn most_modes(&self) -> usize {
        let SolidBodies::Reduced { rail, wheel, .. } = self.bodies else { return 0 };
        let of_rail = self.path.map(RailPath::modes).or(rail.modes.as_ref());
        [of_rail, wheel.modes.as_ref()].into_iter().flatten().map(Modes::count).max().unwrap_or(0)
    }

    /// The reduced bodies with the first `count` of their modes, for steps of `scheme`.
    fn reduced_bodies(
        &self,
        scenario: &Scenario,
        count: usize,
        scheme: &Newmark,
    ) -> Result<[ReducedBody<'_>; 2]> {
        let SolidBodies::Reduced { rail, wheel, .. } = self.bodies else {
            unreachable!("reduced bodies");
        };
        let stiffness = Suspension::new(scenario, scheme).stiffness();
        Ok([
            ReducedBody::new(rail, count, self.damping(), scheme, (&[], 0.0), self.path)?,
            ReducedBody::new(wheel, count, self.damping(), scheme, (hub_motions(scenario), stiffness), None)?,
        ])
    }
}

/// The scheme of the longest steps of a run: average acceleration.
fn longest(scenario: &Scenario) -> Newmark {
    let longest = match scenario.inner_steps {
        InnerSteps::Equal(_) => scenario.shortest_step(),
        InnerSteps::Adaptive(_) => scenario.time_step,
    };
    Newmark::new(longest, 0.0)
}

/// Free motions of the hub (1 to 5: translations y, z, rotations). A wheel that moves along the rail rolls: it turns about its axle as the rail has it.
fn hub_motions(scenario: &Scenario) -> &'static [usize] {
    match scenario.rotations_held {
        true if scenario.speed != 0.0 => &[1, 2, 4],
        true => &[1, 2],
        false => &[1, 2, 3, 4, 5],
    }
}

/// At full order every length of step would need another factor.
fn no_shorter_steps() -> Error {
    InputError::new(
        InputField::InnerSteps,
        "steps of adapted length",
        "equal steps for bodies at full order, which are factored for one length",
        "give their number, or take reduced bodies",
    )
    .into()
}

fn refuse_moving(scenario: &Scenario) -> Result<()> {
    let refuse = |field: InputField, value: String| {
        let expected = "0 for a solid model without the path of its rail";
        let remedy = format!(
            "give it the path (`TransientModel::along`), or set `{}` = false and the simple model runs alone",
            InputField::SolidModel
        );
        Err(InputError::new(field, value, expected, remedy).into())
    };
    if scenario.speed != 0.0 {
        return refuse(InputField::Speed, format!("{} m/s", scenario.speed));
    }
    if let Some(torsion) = scenario.rail_torsion {
        return refuse(InputField::RailTorsion, format!("{} kN·m", torsion.amplitude / KILONEWTON));
    }
    Ok(())
}
