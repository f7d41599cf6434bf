//! The contact between rim and rail section as statics: motions in, forces and their tangent out.
//!
//! What follows forces at once lies in series with the strips: the rest of the rim beyond the wheel's modes, the head of the rail and what a host's rail has beyond its own modes. So the host
//! moves the rim as hub and modes have it, and the section of its rail.
//!
//! A state is that at the end of the last step; what is evaluated depends on it and on the motions alone, not on what was evaluated since.

use crate::contacts::Contacts;
use crate::element::{Element, OTHER_RAIL};
use crate::head::{Head, HeadAt};
use crate::outline::Outline;
use crate::overlap::{Pose, Profiles};
use crate::step::{Meeting, Side, Step, arm, transport};
use crate::strips::ContactStrips;
use nalgebra::{Matrix3, Matrix6, Point2, Vector3};
use railspring_profiles::error::{InputError, Result};
use std::sync::Arc;

/// What a force may be off, N: a hundred-thousandth of a usual load.
const FORCE: f64 = 1.0;

/// The farthest that bodies are moved (m) or turned (rad): there no wheel is on its rail any more.
const FAR: f64 = 0.3;

/// The softest section of a host's rail, m/N.
const SOFTEST: f64 = 1e-4;

/// A contact under more than so many times the largest load that the element was fitted to is beyond all that its strips and steel stand for.
const OVERLOAD: f64 = 10.0;

/// A contact slides, as one of the solid does, where more than half of its normal force is on surfaces that slide. Under Hertz's pressures those are around an ellipse that sticks
/// (R.D. Mindlin, "Compliance of elastic bodies in contact", J. Appl. Mech. 16, 1949), of `c = √(1 - 2^(-2/3))` of the semi-axes where it carries half; of strips, those beyond `c` of the
/// half-width have this share of the force, `1 - (3c - c³)/2`.
pub const SLIDING: f64 = 0.2001;

/// Motions at the end of a step: displacements y, z (m) and the rotation about x (rad), from where the wheel just touches.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Motions {
    /// The rim as hub and modes have it, about the origin of the wheel's profile.
    pub rim: Vector3<f64>,
    /// The section of the host's rail, about its line of shear centres.
    pub section: Vector3<f64>,
    /// Place of the wheel along the study's rail, m from its first end, or [`OTHER_RAIL`].
    pub place: f64,
}

/// Forces y, z (N) and torques about x (N·m) at the points of the motions.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Forces {
    /// On the rim: minus Q and P are its first two.
    pub rim: Vector3<f64>,
    /// On the section of the rail. Near a held end, where the head has a share of the section's motion, the section has that share of the force and the end the rest.
    pub section: Vector3<f64>,
    /// Derivatives of both by the motions of both, rim before section; N/m, N, N·m. It is not symmetric where a contact slides. It leaves out what changes with the arm of a force and where strips begin to slide or touch.
    /// After a step of 2 µm it is 2 % off in half of the states, of the largest of its block, and 7 % in one of a hundred.
    pub tangent: Matrix6<f64>,
}

/// A contact, for hosts and their output.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ContactAt {
    /// Where its normal force acts on the rail (y, z), profile frame, m.
    pub rail: Point2<f64>,
    /// The same on the wheel, profile frame, m.
    pub wheel: Point2<f64>,
    /// Force along the normal, N.
    pub normal_force: f64,
    /// Friction force on the wheel a quarter of a turn from the normal one, N.
    pub tangential_force: f64,
    /// Whether it slides.
    pub slides: bool,
    /// Width along the profile, m.
    pub width: f64,
}

/// Strips with where they meet.
#[derive(Debug, Clone)]
struct State {
    strips: ContactStrips,
    meeting: Meeting,
}

/// The contact of an element with its state.
#[derive(Debug, Clone)]
pub struct StaticContact {
    element: Arc<Element>,
    friction: f64,
    /// What follows forces at once beyond the element's own: of the rim, and of the host's section.
    section_rest: Matrix3<f64>,
    /// At the end of the last step, and as evaluated since.
    committed: State,
    trial: State,
    /// The head where it was evaluated.
    head: HeadAt,
    /// Both running surfaces from their reference points: the wheel's and the rail's.
    outlines: Arc<[Outline; 2]>,
    /// Whether something was evaluated since the last step, so that it can be taken.
    evaluated: bool,
}

impl StaticContact {
    /// A contact that has taken up nothing yet, where all motions are zero; with a coefficient of friction.
    ///
    /// # Errors
    /// [`InputError`] for a friction that is none.
    pub fn new(element: Arc<Element>, friction: f64) -> Result<Self> {
        if !(friction.is_finite() && (0.0..=10.0).contains(&friction)) {
            return InputError::refuse(
                "friction",
                friction,
                "a coefficient from 0 to 10",
                "give a value of 0.1 to 0.6",
            );
        }
        let state = State::at_rest(&element);
        let head = element.head_at(OTHER_RAIL);
        let of_rail = element.rail.curve.knot_points().map(|p| p - element.node_line.coords);
        let outlines =
            [Outline::new(element.wheel_profile.knot_points().collect()), Outline::new(of_rail.collect())];
        Ok(Self {
            outlines: Arc::new(outlines),
            element,
            friction,
            section_rest: Matrix3::zeros(),
            trial: state.clone(),
            committed: state,
            head,
            evaluated: false,
        })
    }

    /// The element.
    pub fn element(&self) -> &Arc<Element> {
        &self.element
    }

    /// Coefficient of friction.
    pub fn friction(&self) -> f64 {
        self.friction
    }

    /// Gives the section of the host's rail a flexibility that its motions do not have, for instance that of the modes left out: symmetric, without negative energy.
    ///
    /// # Errors
    /// [`InputError`] for one that is not.
    pub fn set_section_rest(&mut self, rest: Matrix3<f64>) -> Result<()> {
        // rotations as displacements at a lever of the profile's size
        const LEVER: f64 = 0.03;
        let lever = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, LEVER));
        let scaled = lever * rest * lever;
        let scale = scaled.amax();
        let symmetric = (scaled - scaled.transpose()).amax() <= 1e-9 * scale;
        // as soft as a wheel on a spring of 10 kN/m
        let stores = scale <= SOFTEST && symmetric && scaled.symmetric_eigenvalues().min() >= -1e-9 * scale;
        if !stores {
            let (expected, remedy) = (
                "a symmetric flexibility without negative energy, of at most 1e-4 m/N",
                "give zeros for a rail that has all of it",
            );
            return InputError::refuse("section_rest", format!("{:?}", rest.as_slice()), expected, remedy);
        }
        self.section_rest = (rest + rest.transpose()) * 0.5;
        Ok(())
    }

    /// Begins with bodies at `motions` on which friction has taken up nothing.
    ///
    /// # Errors
    /// As [`Self::evaluate`].
    pub fn start(&mut self, motions: &Motions) -> Result<Forces> {
        let rim = Side { free: motions.rim, flexibility: self.element.wheel.rest };
        self.begin(rim, motions)?;
        Ok(self.forces(&self.element.wheel.rest))
    }

    /// The same with a rim that gives way otherwise. Where it fails the state stays as it was.
    pub(crate) fn begin(&mut self, rim: Side, motions: &Motions) -> Result<()> {
        self.evaluated = false;
        self.check(motions)?;
        let before = std::mem::replace(&mut self.committed, State::at_rest(&self.element));
        let friction = std::mem::replace(&mut self.friction, 0.0);
        let met = self.meet(rim, self.section(motions), motions.place);
        self.friction = friction;
        if met.is_err() {
            self.committed = before;
            return met;
        }
        // from here on there is friction, which has taken up nothing yet
        let Self { trial, element, .. } = self;
        trial.strips.begin_friction();
        trial.meeting.contacts.look(&mut trial.strips, &element.strips, &trial.meeting.pose, friction);
        self.commit();
        Ok(())
    }

    /// The forces at the end of a step to `motions`. The state stays as it is until [`Self::commit`].
    ///
    /// # Errors
    /// [`InputError`] for motions that are not finite, a place beyond the rail, and a contact at an end of a profile;
    /// [`railspring_profiles::error::NumericsError`] where no balance is found.
    pub fn evaluate(&mut self, motions: &Motions) -> Result<Forces> {
        self.evaluated = false;
        self.check(motions)?;
        let rest = self.element.wheel.rest;
        let rim = Side { free: motions.rim, flexibility: rest };
        self.meet(rim, self.section(motions), motions.place)?;
        Ok(self.forces(&rest))
    }

    /// Takes what was evaluated last as the end of a step. Without anything evaluated since the last step nothing changes.
    pub fn commit(&mut self) {
        if !std::mem::take(&mut self.evaluated) {
            return;
        }
        self.trial.strips.commit(self.friction);
        std::mem::swap(&mut self.committed, &mut self.trial);
    }

    /// Takes over the state of another contact of the same element at the end of its last step, in the memory that there is.
    pub fn restore(&mut self, other: &Self) {
        let Self { friction, section_rest, committed, head, .. } = other;
        self.committed.copy_from(committed);
        (self.friction, self.section_rest, self.head) = (*friction, *section_rest, *head);
        self.evaluated = false;
    }

    /// The contacts as evaluated last, or at the end of the last step if nothing was since, in the order of the rail's profile.
    pub fn contacts(&self) -> impl ExactSizeIterator<Item = ContactAt> + '_ {
        let element = &self.element;
        self.last().meeting.contacts.list.iter().map(|contact| ContactAt {
            rail: element.rail.to_profile(&element.rail.curve.point(contact.rail_s)),
            wheel: element.wheel_profile.point(contact.wheel_s),
            normal_force: contact.normal_force,
            tangential_force: contact.tangential_force(),
            slides: contact.sliding_share > SLIDING,
            width: contact.extent[1] - contact.extent[0],
        })
    }

    /// Force of the contacts on the rim as evaluated last.
    pub(crate) fn on_rim(&self) -> Vector3<f64> {
        self.last().meeting.contacts.all.force
    }

    fn last(&self) -> &State {
        if self.evaluated { &self.trial } else { &self.committed }
    }

    pub(crate) fn check(&self, motions: &Motions) -> Result<()> {
        let values = motions.rim.iter().chain(&motions.section).chain([&motions.place]);
        if let Some(value) = values.clone().find(|value| !value.is_finite()) {
            return InputError::refuse(
                "motion",
                value,
                "finite displacements (m) and rotations (rad)",
                "correct the host's motion",
            );
        }
        if let Some(value) = values.take(6).find(|value| value.abs() > FAR) {
            return InputError::refuse(
                "motion",
                value,
                "displacements (m) and rotations (rad) of a wheel that is on its rail",
                "give metres and radians",
            );
        }
        if let Head::ByDistance(length, _) = self.element.head
            && motions.place != OTHER_RAIL
            && !(0.0..=length).contains(&motions.place)
        {
            let expected =
                format!("a place from 0 to {length} m along the rail, or {OTHER_RAIL} for another rail");
            return InputError::refuse(
                "place",
                motions.place,
                expected,
                "end the run before the wheel leaves the rail",
            );
        }
        Ok(())
    }

    /// The head of the rail at `motions`, as a side of the contact.
    pub(crate) fn section(&self, motions: &Motions) -> Side {
        let HeadAt { share, flexibility, .. } = self.element.head_at(motions.place);
        let rest = share * self.section_rest * share.transpose();
        Side { free: share * motions.section, flexibility: flexibility + rest }
    }

    /// Balances a rim with the head; what is found is looked at through `forces` and `contacts`.
    pub(crate) fn meet(&mut self, rim: Side, head: Side, place: f64) -> Result<()> {
        let Self { element, committed, trial, .. } = self;
        trial.strips.copy_from(&committed.strips);
        let step = Step {
            wheel: rim,
            rail: head,
            law: &element.strips,
            friction: self.friction,
            beside: Vector3::zeros(),
            tolerance: FORCE,
            references: element.references(),
        };
        self.evaluated = false;
        step.solve(&mut trial.strips, &committed.meeting, &mut trial.meeting)?;
        let (rail, wheel) = (element.rail.curve.length(), element.wheel_profile.length());
        let at_end = trial.meeting.contacts.list.iter().find(|contact| {
            let on_rail = contact.extent[0] <= 0.0 || contact.extent[1] >= rail;
            on_rail || !(contact.wheel_s > 0.0 && contact.wheel_s < wheel)
        });
        if let Some(contact) = at_end {
            let at = element.rail.to_profile(&contact.point);
            let value = format!(
                "contact at y = {:.1} mm, z = {:.1} mm of the rail's profile",
                1e3 * at.x,
                1e3 * at.y
            );
            let remedy = "the wheel has left the profiles: end the run there";
            return InputError::refuse("motion", value, "contacts within both profiles", remedy);
        }
        let (normal, most) =
            (trial.meeting.contacts.all.force.xy().norm(), OVERLOAD * element.about.largest_force_n);
        if most > 0.0 && normal > most {
            let expected = format!(
                "at most {:.0} kN, ten times the largest load that the element was fitted to",
                1e-3 * most
            );
            let remedy = "see that motions are in m and rad and begin where the wheel just touches";
            return InputError::refuse("contact force", format!("{:.0} kN", 1e-3 * normal), expected, remedy);
        }
        let Pose { wheel, rail } = trial.meeting.pose;
        let [of_wheel, of_rail] = &*self.outlines;
        let places = [element.tape.x + wheel.x, element.node_line.x + rail.x];
        if !of_wheel.is_over(of_rail, [wheel.z, rail.z], places) {
            let value = format!("wheel at y = {:.1} mm", 1e3 * places[0]);
            let remedy = "the wheel has left the rail: end the run there";
            return InputError::refuse("motion", value, "a wheel over its rail", remedy);
        }
        self.head = element.head_at(place);
        self.evaluated = true;
        Ok(())
    }

    /// Forces and tangent as evaluated last, of a rim with a flexibility.
    fn forces(&self, rim: &Matrix3<f64>) -> Forces {
        let Meeting { pose, contacts: Contacts { all, .. }, .. } = &self.last().meeting;
        let to_wheel = transport(&arm(&self.element.references(), pose));
        let share = self.head.share;
        let carried = to_wheel * share;
        let section = -carried.tr_mul(&all.force);
        let head = self.head.flexibility + share * self.section_rest * share.transpose();
        let both = rim + to_wheel * head * to_wheel.transpose();
        let series = (Matrix3::identity() + all.stiffness * both).try_inverse();
        // positive definite but for sliding; without contact there is none
        let stiffness = series.unwrap_or_else(Matrix3::zeros) * all.stiffness;
        let across = stiffness * carried;
        let mut tangent = Matrix6::zeros();
        tangent.fixed_view_mut::<3, 3>(0, 0).copy_from(&-stiffness);
        tangent.fixed_view_mut::<3, 3>(0, 3).copy_from(&across);
        tangent.fixed_view_mut::<3, 3>(3, 0).copy_from(&(carried.transpose() * stiffness));
        tangent.fixed_view_mut::<3, 3>(3, 3).copy_from(&-(carried.transpose() * across));
        Forces { rim: all.force, section, tangent }
    }

    /// Forces on rim and section as evaluated last, with the tangent of a rim that gives way by its rest and `more`.
    pub(crate) fn of_rim(&self, more: &Matrix3<f64>) -> Forces {
        self.forces(&(self.element.wheel.rest + more))
    }
}

impl State {
    /// Of bodies that have not been looked at, where all motions are zero.
    fn at_rest(element: &Element) -> Self {
        let Element { rail, wheel_profile, tape, node_line, strips, .. } = element;
        let profiles = Profiles::new(&rail.curve, wheel_profile, *tape, *node_line);
        Self { strips: ContactStrips::new(profiles, strips), meeting: Meeting::default() }
    }

    fn copy_from(&mut self, other: &Self) {
        self.strips.copy_from(&other.strips);
        self.meeting.pose = other.meeting.pose;
        self.meeting.beside = other.meeting.beside;
        self.meeting.contacts.copy_from(&other.meeting.contacts);
    }
}
