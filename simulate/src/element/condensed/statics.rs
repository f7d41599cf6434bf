//! The hub on its contact as statics have it.

use nalgebra::{Matrix3, Point2, Vector2, Vector3};

use railspring_element::overlap::Profiles;
use railspring_element::strips::ContactStrips;
use railspring_profiles::error::{NumericsError, Result, StopReason};

use super::model::CondensedModel;
use crate::element::published::HubStatics;
use railspring_element::contacts::Contacts;
use railspring_element::head::HeadAt;
use railspring_element::step::{Meeting, Side, Step, arm, transport};

/// What a force may be off where the hub is held, N.
const FORCE: f64 = 1e-4;
/// What a force may miss, relative.
const SOLVER: f64 = 1e-9;
/// The first way that a hub is pressed, m, and how much further each time.
const FIRST_WAY: f64 = 1e-6;
const GROWTH: f64 = 1.2;
/// The deepest that a hub is pressed, m.
const DEEPEST: f64 = 20e-3;

impl CondensedModel {
    /// The hub pressed along a `direction` (unit, y and z) from where the wheel just touches, with a coefficient of `friction` and the rail's
    /// section held, until the forces of the contacts along it are `force` (N).
    ///
    /// # Errors
    /// [`NumericsError`] for a force that the contact does not reach.
    pub fn pressed(&self, direction: Vector2<f64>, force: f64, friction: f64) -> Result<HubStatics> {
        self.pressed_on(self.element.head, direction, force, friction)
    }

    /// The same with the wheel at `x` (m from the rail's first end) and the rail held as it is in a run.
    ///
    /// # Errors
    /// As [`Self::pressed`].
    pub fn pressed_at(
        &self,
        x: f64,
        direction: Vector2<f64>,
        force: f64,
        friction: f64,
    ) -> Result<HubStatics> {
        let HeadAt { share, flexibility, .. } = self.head().at(x);
        let of_beam = self.support.beam().map_or_else(Matrix3::zeros, |beam| beam.section_flexibility(x));
        self.pressed_on(share * of_beam * share.transpose() + flexibility, direction, force, friction)
    }

    /// The hub pressed on a rail whose head has a flexibility `head`.
    fn pressed_on(
        &self,
        head: Matrix3<f64>,
        direction: Vector2<f64>,
        force: f64,
        friction: f64,
    ) -> Result<HubStatics> {
        let references = [self.tape.coords, self.support.reference(&self.rail).coords];
        let rim = self.element.wheel.rim_flexibility();
        let profiles = Profiles::new(&self.rail.curve, &self.wheel, self.tape, Point2::from(references[1]));
        let mut strips = ContactStrips::new(profiles, &self.element.strips);
        let law = &self.element.strips;
        let pressed = |strips: &mut ContactStrips, way: f64, from: &Meeting| -> Result<(Meeting, f64)> {
            let free = Vector3::new(direction.x * way, direction.y * way, 0.0);
            let step = Step {
                wheel: Side { free, flexibility: rim },
                rail: Side { free: Vector3::zeros(), flexibility: head },
                law,
                friction,
                beside: Vector3::zeros(),
                tolerance: FORCE,
                references,
            };
            let mut at = from.clone();
            step.solve(strips, from, &mut at)?;
            let carried = -at.contacts.all.force.xy().dot(&direction);
            Ok((at, carried))
        };
        let (mut low, mut before) = (0.0, Meeting::default());
        let mut high = FIRST_WAY;
        let (mut at, mut carried) = pressed(&mut strips, high, &before)?;
        while carried < force {
            // friction goes as the wheel comes down
            strips.commit(friction);
            (low, before) = (high, at);
            high *= GROWTH;
            if high > DEEPEST {
                return Err(unreached(force, &before.contacts));
            }
            (at, carried) = pressed(&mut strips, high, &before)?;
        }
        let mut way = high;
        while high - low > SOLVER * high {
            way = 0.5 * (low + high);
            (at, carried) = pressed(&mut strips, way, &before)?;
            match carried < force {
                true => low = way,
                false => high = way,
            }
        }
        // strips that serve at poses near by have the tangential stiffness of where they were found
        strips.find_anew();
        at.contacts.look(&mut strips, law, &at.pose, friction);
        let to_wheel = transport(&arm(&references, &at.pose));
        let both = rim + to_wheel * head * to_wheel.transpose();
        let sticking = strips.sticking();
        let stiffness = (Matrix3::identity() + sticking * both).lu().solve(&sticking);
        let hub = stiffness.map(|stiffness| stiffness.fixed_view::<2, 2>(0, 0).into_owned());
        let flexibility = hub.and_then(|hub| hub.try_inverse());
        let flexibility = flexibility.ok_or_else(|| unreached(force, &at.contacts))?;
        Ok(HubStatics { displacement: way, flexibility: (flexibility + flexibility.transpose()) * 0.5 })
    }
}

fn unreached(force: f64, contacts: &Contacts) -> railspring_profiles::error::Error {
    NumericsError::new(
        "hub pressed on the condensed element",
        StopReason::IterationLimit,
        force,
        contacts.list.len(),
    )
    .into()
}
