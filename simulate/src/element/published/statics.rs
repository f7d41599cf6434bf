//! The wheel of the published element on its springs and contacts, as statics have it.

use nalgebra::{Matrix2, Vector2, Vector3};

use crate::time::scenario::Scenario;
use railspring_profiles::error::{NumericsError, Result, StopReason};

use super::element::to_plane;
use super::interface::Interface;
use super::model::{HubStatics, MovingModel};
use super::run::{EVALUATIONS_A_STEP, Run, unknowns};
use super::solve::{Mount, Solution, StepSystem, Surroundings};
use super::surface::{ContactSurface, Pose};

/// What a force may miss, relative.
const SOLVER: f64 = 1e-9;
/// The first way that a hub is pressed, m, and how much further each time.
const FIRST_WAY: f64 = 1e-6;
const GROWTH: f64 = 1.2;
/// The deepest that a hub is pressed, m.
const DEEPEST: f64 = 20e-3;

/// A state from which the wheel is pressed further.
struct Pressed {
    way: f64,
    pose: Pose,
    spring_force: f64,
    limits: Vec<f64>,
}

impl MovingModel {
    /// The wheel centre pressed along a `direction` (unit, y and z) from where the wheel just touches, held across it, with a coefficient of `friction` and the
    /// rail's section held, until the springs carry `force` (N) along it.
    ///
    /// # Errors
    /// [`NumericsError`] for a force that the contact does not reach, and where an equilibrium does not converge.
    pub fn pressed(&self, direction: Vector2<f64>, force: f64, friction: f64) -> Result<HubStatics> {
        let scenario = Scenario::new(1, 1.0, friction);
        self.check(&scenario)?;
        let run = Run::new(self, &scenario)?;
        let mut surface = run.surface();
        let direction = to_plane(direction);
        let carried = |at: &Solution| -at.spring_force.dot(&direction);
        let mut from =
            Pressed { way: 0.0, pose: Pose::zeros(), spring_force: 0.0, limits: vec![0.0; run.nodes.len()] };
        let mut high = FIRST_WAY;
        let mut at = run.pressed_to(&mut surface, direction * high, high, &from)?;
        while carried(&at) < force {
            surface.commit(&at.pose, &at.active);
            let limits = run.limits(&at);
            from = Pressed { way: high, pose: at.pose, spring_force: at.spring_force.y, limits };
            high *= GROWTH;
            if high > DEEPEST {
                return Err(unreached(force, &at));
            }
            at = run.pressed_to(&mut surface, direction * high, high, &from)?;
        }
        // friction goes on from the last state whose force is too small
        let (mut low, mut way) = (from.way, high);
        while high - low > SOLVER * high {
            way = 0.5 * (low + high);
            at = run.pressed_to(&mut surface, direction * way, way, &from)?;
            match carried(&at) < force {
                true => low = way,
                false => high = way,
            }
        }
        let (_, springs) = self.springs.forces(at.pose.fixed_rows::<2>(0) - at.centre, at.spring_force.y);
        // nodes that stick are as stiff along the profile as across it
        let contacts = 1.0 / (at.active.len() as f64 * self.penalty);
        // turning directions 1 and 2 to y and z changes no sign on the diagonal
        let flexibility = Matrix2::from_diagonal(&springs.map(|stiffness| 1.0 / stiffness + contacts));
        if !flexibility.iter().all(|value| value.is_finite()) {
            return Err(unreached(force, &at));
        }
        Ok(HubStatics { displacement: way, flexibility })
    }
}

impl Run<'_> {
    /// The equilibrium with the wheel centre at a displacement (directions 1 and 2), `way` (m) in all, from an earlier one.
    fn pressed_to(
        &self,
        surface: &mut ContactSurface,
        centre: Vector2<f64>,
        way: f64,
        from: &Pressed,
    ) -> Result<Solution> {
        self.evaluations_left.set(self.evaluations_left.get() + EVALUATIONS_A_STEP);
        let direction = centre / way;
        surface.list(&from.pose, 2.0 * (way - from.way));
        let system = StepSystem {
            springs: [&self.model.springs],
            law: &self.law,
            surroundings: Surroundings {
                rails: [Interface::held(Vector3::zeros())],
                body: Interface::held(Vector3::new(centre.x, centre.y, 0.0)),
            },
            mounts: [Mount::OWN],
            load: 0.0,
            start: unknowns(&from.pose, &(direction * from.way)),
            start_force: [from.spring_force],
            start_limits: [from.limits.clone()],
            evaluations_left: &self.evaluations_left,
        };
        let [solution] = system.solve(std::array::from_mut(surface))?.wheels;
        Ok(solution)
    }
}

fn unreached(force: f64, at: &Solution) -> railspring_profiles::error::Error {
    NumericsError::new(
        "wheel pressed on the published element",
        StopReason::IterationLimit,
        force,
        at.active.len(),
    )
    .into()
}

#[cfg(test)]
mod tests {
    use railspring_calibrate::law::StiffnessLaw;

    use super::super::run::tests::{arc, flat, profile, relative, rigid};
    use super::*;

    /// PENALTY: one contact node or more of 1e12 N/m beside springs of 1e9 N/m.
    const PENALTY: f64 = 1e-3;

    /// Source: the law and its tangent. Goal: a wheel pressed down by 60 kN has the law's displacement (m), its tangent and the horizontal stiffness (N/m); nothing
    /// couples them. Accuracy: PENALTY.
    #[test]
    fn a_wheel_pressed_down_has_its_springs() {
        let law = StiffnessLaw::published();
        let model = flat(law, 300.0);
        let at = model.pressed(Vector2::y(), 60e3, 0.5).unwrap();
        assert!(relative(at.displacement, law.displacement(60e3)) < PENALTY, "{at:?}");
        assert!(relative(1.0 / at.flexibility[(1, 1)], law.tangent(60e3)) < PENALTY, "{at:?}");
        assert!(relative(1.0 / at.flexibility[(0, 0)], model.springs.horizontal) < PENALTY, "{at:?}");
        assert_eq!((at.flexibility[(0, 1)], at.flexibility[(1, 0)]), (0.0, 0.0));
    }

    /// Source: statics of two springs on an inclined plane. Pressed along its normal n, the wheel slides down the plane where the springs would carry more along it than
    /// µ·N: F = N·(n - µ·t) with N = 50 kN, and the way along n is n·(F_y/k_h, δ(F_z)). With more friction it sticks, and both springs take n times the
    /// way. Goal: way (m) and vertical stiffness (N/m) on a plane of 30° and of -30°. Accuracy: PENALTY.
    #[test]
    fn on_a_plane_friction_shares_the_force_between_the_springs() {
        let (force, law) = (50e3, StiffnessLaw { a: 4e8, b: 0.0, c: 0.0 });
        for angle in [30.0_f64, -30.0].map(f64::to_radians) {
            let plane = move |y: f64| y * angle.tan();
            let wheel = profile(move |y| plane(y) + arc(0.3)(y), &[]);
            let mut model = rigid(profile(plane, &[]), wheel, 0.0, law, 300.0);
            model.springs.horizontal = 8e7;
            // into the rail, and along the plane to where the springs hold less
            let (normal, along) =
                (Vector2::new(-angle.sin(), angle.cos()), Vector2::new(angle.cos(), angle.sin()));
            let springs = Vector2::new(model.springs.horizontal, law.a);
            let stuck = springs.component_mul(&normal);
            let share = stuck.dot(&along) / stuck.dot(&normal);
            for friction in [0.0, 0.3, 2.0] {
                let share = share.clamp(-friction, friction);
                let forces = (normal + along * share) * force;
                let way = normal.dot(&forces.component_div(&springs));
                let at = model.pressed(normal, force, friction).unwrap();
                assert!(
                    relative(at.displacement, way) < PENALTY,
                    "{angle} {friction}: {} {way}",
                    at.displacement
                );
                assert!(relative(1.0 / at.flexibility[(1, 1)], law.a) < PENALTY, "{at:?}");
            }
            assert!(share.abs() > 0.3 && share.abs() < 2.0, "{share}");
        }
    }

    /// Goal: a force that no depth reaches, as beside the rail, is an error with its name.
    #[test]
    fn a_force_beyond_the_contact_is_an_error() {
        let model = flat(StiffnessLaw::published(), 300.0);
        let error = model.pressed(-Vector2::y(), 1e3, 0.5).unwrap_err();
        assert!(error.to_string().contains("wheel pressed on the published element"), "{error}");
    }
}
