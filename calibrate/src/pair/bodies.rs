//! The bodies reduced to their contact nodes, and pressed together.

use super::geometry::{Pair, PairMeshes};
use super::references::ByReference;
use super::solids::{Orders, PairBody, PairSolids};
use crate::calibration::{
    Bodies, ContactField, DOWNWARDS, Enforcement, HorizontalCalibration, NormalCalibration, Patch, Pressed,
    Reference, WheelOnRail, calibrate_horizontal, calibrate_normal, press_carried,
};
use crate::contact::{BeyondHalfSpace, HalfSpace, Side};
use crate::law::LEAST_LOADS;
use crate::mesh::SurfaceGrid;
use crate::solid::{Formulation, Material, Materials};
use crate::superelement::{CondensedBody, SectionMotion, is_mirrored};
use faer::Mat;
use railspring_profiles::error::{Error, InputError, Result, unless_interrupted};
use railspring_profiles::monitor::Monitor;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

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

/// What a contact needs of a condensed body ([`Pair::contact_body`]).
#[derive(Debug, Clone, Copy)]
pub struct ContactBody<'a> {
    /// Compliance of the contact nodes (`3·node + axis`), m/N.
    pub compliance: &'a Mat<f64>,
    /// Where they are.
    pub grid: &'a SurfaceGrid,
    /// The material there.
    pub material: Material,
    /// Whether the compliance is its own mirror image along the track.
    pub mirrored: bool,
    /// What the body is beyond its half-space; made of the surface that it is pressed with where it is not there.
    pub beyond: Option<&'a Arc<BeyondHalfSpace>>,
}

impl Pair {
    /// The wheel in place on the rail, pressed downwards.
    pub fn wheel_on_rail<'a>(
        &'a self,
        rail: ContactBody<'a>,
        wheel: ContactBody<'a>,
        ContactConditions { friction, enforcement, field }: ContactConditions,
    ) -> WheelOnRail<'a> {
        WheelOnRail {
            bodies: Bodies::Condensed {
                rail: rail.compliance,
                wheel: wheel.compliance,
                mirrored: rail.mirrored && wheel.mirrored,
            },
            rail_surface: self.rail_surface(rail.grid),
            wheel_surface: self.wheel_surface(wheel.grid),
            friction,
            enforcement,
            field,
            materials: [rail.material, wheel.material],
            along: DOWNWARDS,
            beyond: match (rail.beyond, wheel.beyond) {
                (Some(rail), Some(wheel)) => OnceLock::from([rail, wheel].map(Arc::clone)),
                _ => OnceLock::new(),
            },
        }
    }

    /// The same surfaces on half-spaces of the materials of rail and wheel, without friction, pressed downwards: what half-space programs
    /// compute. Of the meshes there are only the `grids` of the contact zones of rail and wheel, within which contact is sought.
    pub fn half_spaces_on_rail<'a>(
        &'a self,
        grids: [&'a SurfaceGrid; 2],
        materials: [Material; 2],
        field: ContactField,
    ) -> WheelOnRail<'a> {
        let [rail, wheel] = grids;
        WheelOnRail {
            bodies: Bodies::HalfSpaces,
            rail_surface: self.rail_surface(rail),
            wheel_surface: self.wheel_surface(wheel),
            friction: 0.0,
            enforcement: Enforcement::Exact,
            field,
            materials,
            along: DOWNWARDS,
            beyond: OnceLock::new(),
        }
    }
}

/// Both bodies condensed. It borrows nothing, and a clone shares its matrices.
#[derive(Clone)]
pub struct CondensedPair {
    /// The wheel against its hub.
    pub wheel: CondensedBody,
    /// The rail with its ends fixed.
    pub rail_on_ends: CondensedBody,
    /// The rail with its foot fixed, if laws against that are wanted.
    pub rail_on_foot: Option<CondensedBody>,
    /// The motion of that rail's section at the contact.
    pub section: SectionMotion,
    /// Compliance of the rail's contact nodes against that section, m/N.
    against_section: Arc<Mat<f64>>,
    /// Which of the bodies are their own mirror images along the track.
    mirrored: Mirrored,
    /// What they are beyond their half-spaces.
    beyond: Beyond,
}

/// What the bodies of a pair are beyond their half-spaces.
#[derive(Clone)]
struct Beyond {
    wheel: Arc<BeyondHalfSpace>,
    /// The rail against its section.
    on_section: Arc<BeyondHalfSpace>,
    on_foot: Option<Arc<BeyondHalfSpace>>,
}

impl Beyond {
    fn of(body: &CondensedBody, side: Side) -> Arc<BeyondHalfSpace> {
        let half_space = HalfSpace::new(&body.surface, side);
        Arc::new(BeyondHalfSpace::of_nodes(&body.grid, &body.nodes, side == Side::Opposing, half_space))
    }
}

/// Which bodies of a pair are their own mirror images along the track.
#[derive(Clone, Copy)]
struct Mirrored {
    wheel: bool,
    /// The rail against its section.
    on_section: bool,
    on_foot: bool,
}

impl PairMeshes {
    /// Factors and condenses `bodies` of the pair ([`PairBody::of_pair`]), one after the other, and lets the factors go.
    ///
    /// # Errors
    /// An inverted element, a rail without an element at the contact, and those of [`CondensedPair::new`].
    pub fn condense(
        &self,
        pair: &Pair,
        bodies: &[PairBody],
        material: Material,
        element: Formulation,
        monitor: &dyn Monitor,
    ) -> Result<CondensedPair> {
        self.condense_in_time(pair, bodies, material, element, 0, monitor)
    }

    /// The same with at most `modes` modes of the bodies that move in runs in time.
    ///
    /// # Errors
    /// As [`Self::condense`].
    pub fn condense_in_time(
        &self,
        pair: &Pair,
        bodies: &[PairBody],
        material: Material,
        element: Formulation,
        modes: usize,
        monitor: &dyn Monitor,
    ) -> Result<CondensedPair> {
        let (rail, wheel, orders) = (&self.rail, &self.wheel, &Orders::default());
        let materials = &Materials::from(material);
        let solids = PairSolids { pair, rail, wheel, materials: [materials; 2], element, orders };
        let condense = |body| solids.condense_in_time(body, solids.key(body), modes);
        CondensedPair::new(condense_all(("superelements", monitor), bodies, false, condense)?)
    }
}

/// The `bodies`, each as `get` has it: at the same time if there is room for the factors `together`, or else one after the other. `stage`
/// names the work to `monitor`.
///
/// # Errors
/// Those of `get`, and an interruption.
pub fn condense_all<T: Send>(
    (stage, monitor): (&str, &dyn Monitor),
    bodies: &[PairBody],
    together: bool,
    get: impl Fn(PairBody) -> Result<T> + Sync,
) -> Result<Vec<(PairBody, T)>> {
    let done = AtomicUsize::new(0);
    let report = |done| monitor.progress(stage, done, bodies.len());
    report(0)?;
    let one = |&body: &PairBody| {
        let condensed = get(body)?;
        report(done.fetch_add(1, Ordering::Relaxed) + 1).map(|()| (body, condensed))
    };
    if together { bodies.par_iter().map(one).collect() } else { bodies.iter().map(one).collect() }
}

impl CondensedPair {
    /// Puts condensed bodies together.
    ///
    /// # Errors
    /// [`InputError`] without wheel or rail between its ends, and for such a rail without the motion of its section.
    pub fn new(bodies: Vec<(PairBody, CondensedBody)>) -> Result<Self> {
        let missing = |body: PairBody, what: &str| {
            InputError::new(
                body.name(),
                what,
                "the wheel, and the rail between its ends with the motion of its section",
                "condense the bodies of `PairBody::of_pair` with `PairSolids::condense`",
            )
        };
        let (mut wheel, mut on_ends, mut rail_on_foot) = (None, None, None);
        for (body, condensed) in bodies {
            match body {
                PairBody::Wheel => wheel = Some(condensed),
                PairBody::RailOnEnds => on_ends = Some(condensed),
                PairBody::RailOnFoot => rail_on_foot = Some(condensed),
            }
        }
        let wheel = wheel.ok_or_else(|| missing(PairBody::Wheel, "no such body"))?;
        let rail_on_ends = on_ends.ok_or_else(|| missing(PairBody::RailOnEnds, "no such body"))?;
        let section = rail_on_ends
            .section
            .clone()
            .ok_or_else(|| missing(PairBody::RailOnEnds, "no motion of its section"))?;
        let against_section = Arc::new(section.relative(&rail_on_ends.compliance));
        let mirrored = Mirrored {
            wheel: is_mirrored(&wheel.compliance, &wheel.grid),
            on_section: is_mirrored(&against_section, &rail_on_ends.grid),
            on_foot: rail_on_foot.as_ref().is_some_and(|rail| is_mirrored(&rail.compliance, &rail.grid)),
        };
        let beyond = Beyond {
            wheel: Beyond::of(&wheel, Side::Opposing),
            on_section: Beyond::of(&rail_on_ends, Side::Base),
            on_foot: rail_on_foot.as_ref().map(|rail| Beyond::of(rail, Side::Base)),
        };
        Ok(Self { wheel, rail_on_ends, rail_on_foot, section, against_section, mirrored, beyond })
    }

    /// Another wheel on the same rail.
    #[must_use]
    pub fn with_wheel(&self, wheel: CondensedBody) -> Self {
        let is_mirrored = is_mirrored(&wheel.compliance, &wheel.grid);
        Self {
            mirrored: Mirrored { wheel: is_mirrored, ..self.mirrored },
            beyond: Beyond { wheel: Beyond::of(&wheel, Side::Opposing), ..self.beyond.clone() },
            wheel,
            ..self.clone()
        }
    }

    /// Other bodies in the place of these, which are their own mirror images as these are: the same matrices under other grids, or those between two wheels.
    pub(super) fn with_bodies(
        &self,
        wheel: CondensedBody,
        rail_on_ends: CondensedBody,
        rail_on_foot: Option<CondensedBody>,
    ) -> Self {
        let section = rail_on_ends.section.clone().unwrap_or_else(|| self.section.clone());
        let against_section = Arc::clone(&self.against_section);
        let (mirrored, beyond) = (self.mirrored, self.beyond.clone());
        Self { wheel, rail_on_ends, rail_on_foot, section, against_section, mirrored, beyond }
    }

    /// The same where the wheel, whose compliance is another one then, is partly that of another pair.
    pub(super) fn with_part_of(mut self, other: &Self) -> Self {
        self.mirrored.wheel &= other.mirrored.wheel;
        self.beyond.wheel = Beyond::of(&self.wheel, Side::Opposing);
        self
    }

    /// Compliance of the rail's contact nodes against its section, m/N.
    pub fn against_section(&self) -> &Mat<f64> {
        &self.against_section
    }

    /// The rail's body under the law of a reference.
    ///
    /// # Errors
    /// [`InputError`] for the foot's without that body.
    pub fn rail(&self, reference: Reference) -> Result<&CondensedBody> {
        match reference {
            Reference::Beam | Reference::Local | Reference::HalfSpaces => Ok(&self.rail_on_ends),
            Reference::Foot => self.rail_on_foot.as_ref().ok_or_else(|| no_foot().into()),
        }
    }

    /// Presses the wheel on the rail with every load (N, ascending) in turn, the rail's section at the contact fixed, and again with its
    /// foot fixed where there is that body. Where the contact of a load reaches the end of the contact zone, both end with the load
    /// before, as long as these are enough for a law.
    ///
    /// # Errors
    /// Bodies that are not of the `pair` ([`Pair::check_body`]), and those of [`press_loads`](crate::calibration::press_loads).
    pub fn press<'a>(
        &'a self,
        pair: &'a Pair,
        contact: ContactConditions,
        loads: &[f64],
        monitor: &dyn Monitor,
    ) -> Result<PressedPair<'a>> {
        let press = |reference, loads: &[f64], stage| -> Result<(Vec<Pressed>, Option<Error>)> {
            let placed = self.wheel_on_rail(pair, reference, contact)?;
            let (states, ended) = press_carried(&placed, loads, stage, monitor)?;
            match ended {
                Some(error) if states.len() < LEAST_LOADS => Err(error),
                ended => Ok((states, ended)),
            }
        };
        let foot_held = |loads: &[f64]| {
            let held = self.rail_on_foot.as_ref();
            held.map(|_| press(Reference::Foot, loads, "calibration, foot held")).transpose()
        };
        let (on_section, on_foot) =
            rayon::join(|| press(Reference::Beam, loads, "calibration, section held"), || foot_held(loads));
        let (mut on_section, mut ended) = on_section?;
        let on_foot = match on_foot {
            // under loads that the rail with its section held does not carry
            Err(_) if ended.is_some() => foot_held(&loads[..on_section.len()])?,
            pressed => pressed?,
        };
        let on_foot = on_foot.map(|(mut on_foot, earlier)| {
            if on_foot.len() < on_section.len() {
                ended = earlier;
            }
            let carried = on_foot.len().min(on_section.len());
            on_foot.truncate(carried);
            on_section.truncate(carried);
            on_foot
        });
        let on_half_spaces = self.press_half_spaces(pair, contact, &loads[..on_section.len()], monitor)?;
        let states = PairStates { on_foot, on_section, on_half_spaces, ended };
        Ok(self.pressed(pair, contact, Arc::new(states)))
    }

    /// The profiles on half-spaces under loads that the bodies carry, as far as they go.
    ///
    /// # Errors
    /// An interruption.
    fn press_half_spaces(
        &self,
        pair: &Pair,
        contact: ContactConditions,
        loads: &[f64],
        monitor: &dyn Monitor,
    ) -> Result<Vec<Pressed>> {
        let placed = self.wheel_on_rail(pair, Reference::HalfSpaces, contact)?;
        let pressed = press_carried(&placed, loads, "calibration, half-spaces", monitor);
        Ok(unless_interrupted(pressed)?.map_or_else(|_| Vec::new(), |(states, _)| states))
    }

    /// The pair in `states` that it was pressed into.
    pub fn pressed<'a>(
        &'a self,
        pair: &'a Pair,
        contact: ContactConditions,
        states: Arc<PairStates>,
    ) -> PressedPair<'a> {
        PressedPair { pair, bodies: self, contact, states }
    }

    /// The wheel in place on the rail, pressed downwards, with what the reference fixes of the rail.
    ///
    /// # Errors
    /// As [`Self::rail`], and bodies that are not of the `pair` ([`Pair::check_body`]).
    pub(crate) fn wheel_on_rail<'a>(
        &'a self,
        pair: &'a Pair,
        reference: Reference,
        contact: ContactConditions,
    ) -> Result<WheelOnRail<'a>> {
        if reference == Reference::HalfSpaces {
            let [rail, wheel] = [&self.rail_on_ends, &self.wheel];
            let materials = [rail.surface, wheel.surface];
            let field = match contact.field {
                ContactField::Elements => ContactField::Hybrid,
                fine => fine,
            };
            return Ok(pair.half_spaces_on_rail([&rail.grid, &wheel.grid], materials, field));
        }
        let [rail, wheel] = self.of_pair(pair, reference)?;
        Ok(pair.wheel_on_rail(rail, wheel, contact))
    }

    /// Rail and wheel as the contact of a `pair` sees them, with what the reference fixes of the rail.
    ///
    /// # Errors
    /// As [`Self::rail`], and bodies that are not of the `pair` ([`Pair::check_body`]).
    pub(crate) fn of_pair(&self, pair: &Pair, reference: Reference) -> Result<[ContactBody<'_>; 2]> {
        let body = self.rail(reference)?;
        let Mirrored { wheel, on_section, on_foot } = self.mirrored;
        let of = &self.beyond;
        let (held, compliance, mirrored, beyond) = match reference {
            Reference::Foot => (PairBody::RailOnFoot, &body.compliance, on_foot, of.on_foot.as_ref()),
            _ => (PairBody::RailOnEnds, &self.against_section, on_section, Some(&of.on_section)),
        };
        let rail = ContactBody { compliance, mirrored, beyond, ..pair.contact_body(held, body)? };
        let on_wheel = pair.contact_body(PairBody::Wheel, &self.wheel)?;
        Ok([rail, ContactBody { mirrored: wheel, beyond: Some(&of.wheel), ..on_wheel }])
    }
}

/// A law against the foot is asked of a pair whose rail was not condensed on it.
fn no_foot() -> InputError {
    InputError::new(
        PairBody::RailOnFoot.name(),
        "no such body",
        "a pair condensed with its rail on the foot",
        "condense all bodies of `PairBody::of_pair(true)`",
    )
}

/// The laws of a pair.
pub type Laws = ByReference<NormalCalibration>;

/// The states of a pair under its loads. They borrow nothing.
pub struct PairStates {
    on_foot: Option<Vec<Pressed>>,
    on_section: Vec<Pressed>,
    on_half_spaces: Vec<Pressed>,
    ended: Option<Error>,
}

/// A pair in its states under its loads.
pub struct PressedPair<'a> {
    pair: &'a Pair,
    bodies: &'a CondensedPair,
    contact: ContactConditions,
    states: Arc<PairStates>,
}

impl PressedPair<'_> {
    /// The states by themselves ([`CondensedPair::pressed`]).
    pub fn into_states(self) -> Arc<PairStates> {
        self.states
    }

    /// The states under the loads, with what the reference fixes of the rail.
    ///
    /// # Errors
    /// As [`CondensedPair::rail`].
    pub fn states(&self, reference: Reference) -> Result<&[Pressed]> {
        match reference {
            Reference::Beam | Reference::Local => Ok(&self.states.on_section),
            Reference::Foot => self.states.on_foot.as_deref().ok_or_else(|| no_foot().into()),
            Reference::HalfSpaces => Ok(&self.states.on_half_spaces),
        }
    }

    /// The patches of these states.
    ///
    /// # Errors
    /// As [`Self::states`] and [`WheelOnRail::patch`](crate::calibration::WheelOnRail::patch).
    pub fn patches(&self, reference: Reference) -> Result<Vec<Patch>> {
        self.wheel_on_rail(reference)?.patches(self.states(reference)?)
    }

    /// Why there are states only up to the load before the largest wanted ones, if so.
    pub fn ended(&self) -> Option<&Error> {
        self.states.ended.as_ref()
    }

    /// Fits the normal law of a reference.
    ///
    /// # Errors
    /// Numerical errors of tangent and fit, and as [`CondensedPair::rail`].
    pub fn fit(&self, reference: Reference) -> Result<NormalCalibration> {
        calibrate_normal(&self.wheel_on_rail(reference)?, self.states(reference)?, reference)
    }

    /// The laws with every reference that there is.
    ///
    /// # Errors
    /// Those of [`Self::fit`].
    pub fn laws(&self) -> Result<Laws> {
        let foot = self.states.on_foot.as_ref().map(|_| self.fit(Reference::Foot)).transpose()?;
        let enough = self.states.on_half_spaces.len() >= LEAST_LOADS;
        let half_spaces = enough.then(|| self.fit(Reference::HalfSpaces)).transpose()?;
        Ok(Laws { foot, beam: self.fit(Reference::Beam)?, local: self.fit(Reference::Local)?, half_spaces })
    }

    /// The horizontal stiffness of a sticking wheel under the preloads (N, ascending).
    ///
    /// # Errors
    /// Those of [`calibrate_horizontal`], and as [`CondensedPair::rail`].
    pub fn horizontal(
        &self,
        reference: Reference,
        preloads: &[f64],
        monitor: &dyn Monitor,
    ) -> Result<HorizontalCalibration> {
        calibrate_horizontal(&self.wheel_on_rail(reference)?, preloads, self.states(reference)?, monitor)
    }

    fn wheel_on_rail(&self, reference: Reference) -> Result<WheelOnRail<'_>> {
        self.bodies.wheel_on_rail(self.pair, reference, self.contact)
    }
}
