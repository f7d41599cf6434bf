//! The bodies reduced to their contact nodes, and pressed together.

use super::geometry::{Pair, PairMeshes};
use super::solids::{Orders, PairBody, PairSolids};
use crate::calibration::{
    ContactField, DOWNWARDS, Enforcement, HorizontalCalibration, NormalCalibration, Pressed, Reference,
    WheelOnRail, calibrate_horizontal, calibrate_normal, press_carried,
};
use crate::error::{Error, InputError, Result};
use crate::law::LEAST_LOADS;
use crate::mesh::SurfaceGrid;
use crate::monitor::Monitor;
use crate::solid::{Formulation, Material};
use crate::superelement::{CondensedBody, SectionMotion};
use faer::Mat;

/// How wheel and rail meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactConditions {
    /// Coulomb friction coefficient; 0 leaves friction out.
    pub friction: f64,
    /// How the contact conditions are enforced.
    pub enforcement: Enforcement,
    /// Where the contact lives.
    pub field: ContactField,
}

/// What a contact needs of a condensed body.
#[derive(Debug, Clone, Copy)]
pub struct ContactBody<'a> {
    /// Compliance of the contact nodes (`3·node + axis`), m/N.
    pub compliance: &'a Mat<f64>,
    /// Where they are.
    pub grid: &'a SurfaceGrid,
}

impl<'a> From<&'a CondensedBody> for ContactBody<'a> {
    fn from(body: &'a CondensedBody) -> Self {
        Self { compliance: &body.compliance, grid: &body.grid }
    }
}

impl Pair {
    /// The wheel in place on the rail, both of one material, pressed downwards.
    pub fn wheel_on_rail<'a>(
        &'a self,
        rail: impl Into<ContactBody<'a>>,
        wheel: impl Into<ContactBody<'a>>,
        material: Material,
        ContactConditions { friction, enforcement, field }: ContactConditions,
    ) -> WheelOnRail<'a> {
        let (rail, wheel) = (rail.into(), wheel.into());
        WheelOnRail {
            rail: rail.compliance,
            wheel: wheel.compliance,
            rail_surface: self.rail_surface(rail.grid),
            wheel_surface: self.wheel_surface(wheel.grid),
            friction,
            enforcement,
            field,
            materials: [material; 2],
            along: DOWNWARDS,
        }
    }
}

/// Both bodies condensed. It borrows nothing.
pub struct CondensedPair {
    /// The wheel against its hub.
    pub wheel: CondensedBody,
    /// The rail with its foot fixed.
    pub rail_on_foot: CondensedBody,
    /// The rail with its ends fixed.
    pub rail_on_ends: CondensedBody,
    /// The motion of that rail's section at the contact.
    pub section: SectionMotion,
    /// The material of both.
    pub material: Material,
    /// Compliance of the rail's contact nodes against that section, m/N.
    against_section: Mat<f64>,
}

impl PairMeshes {
    /// Factors and condenses both bodies, and lets the factors go.
    ///
    /// # Errors
    /// An inverted element, and a rail without an element at the contact.
    pub fn condense(
        &self,
        pair: &Pair,
        material: Material,
        element: Formulation,
        monitor: &dyn Monitor,
    ) -> Result<CondensedPair> {
        self.condense_in_time(pair, material, element, 0, monitor)
    }

    /// The same with at most `modes` modes of the bodies that move in runs in time.
    ///
    /// # Errors
    /// As [`Self::condense`].
    pub fn condense_in_time(
        &self,
        pair: &Pair,
        material: Material,
        element: Formulation,
        modes: usize,
        monitor: &dyn Monitor,
    ) -> Result<CondensedPair> {
        let (rail, wheel, orders) = (&self.rail, &self.wheel, &Orders::default());
        let solids = PairSolids { pair, rail, wheel, material, element, orders };
        let condense = |body| solids.condense_in_time(body, solids.key(body), modes);
        condense_all(monitor, condense).and_then(|bodies| CondensedPair::new(material, bodies))
    }
}

/// The bodies in the order of [`PairBody::ALL`], each as `get` has it, one after the other, so that there is one factor at a time; the wheel,
/// whose factor is the largest, comes first, while nothing else takes memory.
///
/// # Errors
/// Those of `get`, and an interruption.
pub fn condense_all<T>(monitor: &dyn Monitor, get: impl Fn(PairBody) -> Result<T>) -> Result<[T; 3]> {
    monitor.progress("superelements", 0, 3)?;
    let wheel = get(PairBody::Wheel)?;
    monitor.progress("superelements", 1, 3)?;
    let on_foot = get(PairBody::RailOnFoot)?;
    monitor.progress("superelements", 2, 3)?;
    let on_ends = get(PairBody::RailOnEnds)?;
    monitor.progress("superelements", 3, 3)?;
    Ok([wheel, on_foot, on_ends])
}

impl CondensedPair {
    /// Puts condensed bodies together, in the order of [`PairBody::ALL`].
    ///
    /// # Errors
    /// [`InputError`] for a rail on its ends without the motion of its section.
    pub fn new(material: Material, bodies: [CondensedBody; 3]) -> Result<Self> {
        let [wheel, rail_on_foot, rail_on_ends] = bodies;
        let section = rail_on_ends.section.clone().ok_or_else(|| {
            InputError::new(
                "rail between its ends",
                "no motion of its section",
                "a body condensed as the solid of a rail beam",
                "condense it again with `PairSolids::condense`",
            )
        })?;
        let against_section = section.relative(&rail_on_ends.compliance);
        Ok(Self { wheel, rail_on_foot, rail_on_ends, section, material, against_section })
    }

    /// The rail's body under the law of a reference.
    pub fn rail(&self, reference: Reference) -> &CondensedBody {
        match reference {
            Reference::Beam => &self.rail_on_ends,
            Reference::Foot | Reference::Local => &self.rail_on_foot,
        }
    }

    /// Presses the wheel on the rail with every load (N, ascending) in turn, the rail's foot fixed, and again with its
    /// section at the contact fixed. Where the contact of a load reaches the end of the contact zone, both end with the load before, as
    /// long as these are enough for a law.
    ///
    /// # Errors
    /// Those of [`press_loads`](crate::calibration::press_loads).
    pub fn press<'a>(
        &'a self,
        pair: &'a Pair,
        contact: ContactConditions,
        loads: &[f64],
        monitor: &dyn Monitor,
    ) -> Result<PressedPair<'a>> {
        let press = |reference, loads: &[f64], stage| -> Result<(Vec<Pressed>, Option<Error>)> {
            let (states, ended) =
                press_carried(&self.wheel_on_rail(pair, reference, contact), loads, stage, monitor)?;
            match ended {
                Some(error) if states.len() < LEAST_LOADS => Err(error),
                ended => Ok((states, ended)),
            }
        };
        let section_held = |loads: &[f64]| press(Reference::Beam, loads, "calibration, section held");
        let (on_foot, on_section) =
            rayon::join(|| press(Reference::Foot, loads, "calibration, foot held"), || section_held(loads));
        let (mut on_foot, mut ended) = on_foot?;
        let (mut on_section, earlier) = match on_section {
            // under loads that the rail on its foot does not carry
            Err(_) if ended.is_some() => section_held(&loads[..on_foot.len()])?,
            pressed => pressed?,
        };
        if on_section.len() < on_foot.len() {
            ended = earlier;
        }
        let carried = on_foot.len().min(on_section.len());
        on_foot.truncate(carried);
        on_section.truncate(carried);
        Ok(PressedPair { pair, bodies: self, contact, on_foot, on_section, ended })
    }

    /// The wheel in place on the rail, pressed downwards, with what the reference fixes of the rail.
    pub(super) fn wheel_on_rail<'a>(
        &'a self,
        pair: &'a Pair,
        reference: Reference,
        contact: ContactConditions,
    ) -> WheelOnRail<'a> {
        let body = self.rail(reference);
        let compliance = if reference == Reference::Beam { &self.against_section } else { &body.compliance };
        let rail = ContactBody { compliance, grid: &body.grid };
        pair.wheel_on_rail(rail, &self.wheel, self.material, contact)
    }
}

/// The states of a pair under its loads.
pub struct PressedPair<'a> {
    pair: &'a Pair,
    bodies: &'a CondensedPair,
    contact: ContactConditions,
    on_foot: Vec<Pressed>,
    on_section: Vec<Pressed>,
    ended: Option<Error>,
}

impl PressedPair<'_> {
    /// The states under the loads, with what the reference fixes of the rail.
    pub fn states(&self, reference: Reference) -> &[Pressed] {
        match reference {
            Reference::Beam => &self.on_section,
            Reference::Foot | Reference::Local => &self.on_foot,
        }
    }

    /// Why there are states only up to the load before the largest wanted ones, if so.
    pub fn ended(&self) -> Option<&Error> {
        self.ended.as_ref()
    }

    /// Fits the normal law of a reference.
    ///
    /// # Errors
    /// Numerical errors of tangent and fit.
    pub fn fit(&self, reference: Reference) -> Result<NormalCalibration> {
        calibrate_normal(&self.wheel_on_rail(reference), self.states(reference), reference)
    }

    /// The horizontal stiffness of a sticking wheel under the preloads (N, ascending).
    ///
    /// # Errors
    /// Those of [`calibrate_horizontal`].
    pub fn horizontal(
        &self,
        reference: Reference,
        preloads: &[f64],
        monitor: &dyn Monitor,
    ) -> Result<HorizontalCalibration> {
        calibrate_horizontal(&self.wheel_on_rail(reference), preloads, monitor)
    }

    fn wheel_on_rail(&self, reference: Reference) -> WheelOnRail<'_> {
        self.bodies.wheel_on_rail(self.pair, reference, self.contact)
    }
}
