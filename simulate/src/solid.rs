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
mod model;
mod transient_run;
mod load_case;
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

pub use model::{ModeCount, SolidBodies, TransientModel};
pub use path::RailPath;
pub use reduction::START_MODES;
pub use transient_run::{OtherRun, Reduction, StepCounts, TransientRun};

use crate::time::history::History;
use crate::time::newmark::Newmark;
use crate::time::scenario::Scenario;
use crate::time::steps::InnerSteps;
use crate::time::suspension::Suspension;
use beyond::Beyond;
use body::ElasticBody;
use full::FullBody;
use load_case::{HubSprings, hub_motions, longest};
use nalgebra::{Point3, Vector2};
use railspring_calibrate::solid::{Materials, Supports, System};
use railspring_profiles::error::{Error, InputError, Result};
use railspring_profiles::field::InputField;
use railspring_profiles::monitor::Monitor;
use railspring_profiles::units::KILONEWTON;
use run::{Observer, Run, ShorterSteps};

impl TransientModel<'_> {
    /// Runs `scenario` from just touching and at rest.
    ///
    /// # Errors
    /// [`InputError`] for a scenario only the moving solver can run, for penalty springs on a fine grid, and
    /// for reduced bodies without modes. [`railspring_profiles::error::NumericsError`] with the step if the
    /// contact does not converge, and with [`railspring_profiles::error::StopReason::TooFewModes`] if all
    /// modes of the bodies are not enough. A contact that reaches the end of the meshed contact zone, and one
    /// that begins beyond it, ends the history ([`crate::time::history::Ending::EndOfSurface`]).
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
            return InputError::refuse(
                "a second load case",
                "bodies at full order",
                "reduced bodies, which several runs share",
                "run the two one after the other",
            );
        }
        self.run_with(scenario, Some(other), monitor)
    }

    /// The first 60 ms of a load case, in which models are compared that take long.
    pub fn first_of(scenario: &Scenario) -> Scenario {
        reduction::first_of(scenario)
    }

    /// A load case with so many `modes` of each reduced body, and with nothing beside: what it changes by on other meshes or another grid is
    /// the error of these.
    ///
    /// # Errors
    /// As [`TransientModel::run`], and [`InputError`] for bodies at full order.
    pub fn run_alone(&self, modes: usize, scenario: &Scenario, monitor: &dyn Monitor) -> Result<History> {
        self.check(scenario)?;
        if let SolidBodies::Full { .. } = self.bodies {
            let value = "bodies at full order";
            return InputError::refuse("a run alone", value, "reduced bodies", "reduce them");
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
        let vertical = Suspension::new(scenario, &scheme).stiffness();
        let hub = HubSprings { free: hub_motions(scenario), vertical, axle: self.axle };
        let on_ends = Supports { held: rail.ends.clone(), ..Default::default() };
        let mut master_free = [false; 6];
        hub_motions(scenario).iter().for_each(|&motion| master_free[motion] = true);
        let on_hub = Supports {
            held: Vec::new(),
            followers: wheel.bore.clone(),
            master: Point3::origin(),
            master_free,
        };
        let body = |mesh, materials: &Materials, supports, hub| {
            let system = System::new(mesh, materials.clone(), formulation, supports)?;
            FullBody::new(system.with_massless_contact(), &scheme, hub)
        };
        let [of_rail, of_wheel] = materials;
        let (rail, wheel) = rayon::join(
            || body(rail, of_rail, &on_ends, HubSprings::default()),
            || body(wheel, of_wheel, &on_hub, hub),
        );
        Ok([rail?, wheel?])
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
        InputError::refuse(field, value, expected, remedy)
    };
    if scenario.speed != 0.0 {
        return refuse(InputField::Speed, format!("{} m/s", scenario.speed));
    }
    if let Some(torsion) = &scenario.rail_torsion {
        return refuse(InputField::RailTorsion, format!("{} kN·m", torsion.largest() / KILONEWTON));
    }
    Ok(())
}
