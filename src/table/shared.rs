//! Measured surfaces on condensed bodies of their nominal profiles: the bodies of a table are those of its standards, whatever the number of its files.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use railspring_calibrate::pair::{CondensedPair, wheel_between};
use railspring_profiles::error::Result;
use railspring_profiles::units::MILLIMETRE;

use super::document::BodiesKey;
use crate::results::bodies::coarser::{Coarser, CoarserBodies};
use crate::results::bodies::geometry::{Geometry, Surfaces, track};
use crate::results::bodies::zones::DEEPER;
use crate::study::Study;

/// What several cases have in common, made once for all of them.
pub(super) struct Common<T> {
    made: Mutex<BTreeMap<String, Arc<T>>>,
}

impl<T> Default for Common<T> {
    fn default() -> Self {
        Self { made: Mutex::default() }
    }
}

impl<T> Common<T> {
    /// What has a key, if it has been made.
    pub fn known(&self, key: &str) -> Option<Arc<T>> {
        self.made.lock().unwrap_or_else(PoisonError::into_inner).get(key).map(Arc::clone)
    }

    /// What has a key; `make` makes it where there is none yet. It is asked by one case at a time.
    pub fn get(&self, key: String, make: impl FnOnce() -> Result<T>) -> Result<Arc<T>> {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(one) = made.get(&key) {
            return Ok(Arc::clone(one));
        }
        let one = Arc::new(make()?);
        made.insert(key, Arc::clone(&one));
        Ok(one)
    }
}

/// Condensed bodies in their track; those of coarser meshes with the edge of the contact elements of the others, m.
pub(super) struct OnBodies {
    pub geometry: Geometry,
    pub bodies: CondensedPair,
    pub coarser: Option<(f64, CoarserBodies)>,
}

/// Whether the rail and the wheel of a study have measured surfaces that its table wants on the bodies of their standards.
pub(super) fn wanted_on_standards(study: &Study, bodies: BodiesKey) -> [bool; 2] {
    let (Study { rail, wheel, .. }, shared) = (study, bodies.shared());
    [shared.rail && rail.measured.is_some(), shared.wheel && wheel.measured.is_some()]
}

/// Whether one of them has, and the program meshes these bodies from standards.
pub(super) fn shares(study: &Study, bodies: BodiesKey) -> bool {
    let Study { rail, wheel, .. } = study;
    let drawn = rail.section.is_some() || wheel.section.is_some() || rail.body.is_some();
    wanted_on_standards(study, bodies).contains(&true) && !drawn && study.statics().meshes_are_ours()
}

/// Diameters of the nominal wheels that measured ones are pressed on are multiples of this, m.
///
/// What is left of that between two of them stands in docs/design/shared-bodies.md.
const DIAMETERS_APART: f64 = 0.02;
/// Diameters that are the same, m: rounding.
const SAME_DIAMETER: f64 = 1e-9;

/// Studies whose bodies carry the measured surfaces of a study that its table wants on the bodies of standards: one, or two with the diameters next to that of a wheel whose own was measured.
/// Where the study does not name its standards, these are missing. The contact zones go down as far as those of measured profiles.
pub(super) fn nominals(study: &Study, bodies: BodiesKey) -> Vec<Study> {
    let mut nominal = study.clone();
    let shared = bodies.shared();
    // measured rails have deeper zones themselves
    if shared.rail || study.rail.measured.is_none() {
        nominal.mesh.rail_zone.face_depth += DEEPER;
        nominal.rail.measured = None;
    }
    if shared.wheel {
        nominal.wheel.measured = None;
    }
    let diameters = match study.wheel.measured {
        Some(_) if shared.wheel && study.wheel.diameter_measured => {
            next_to(study.wheel.tape_diameter, study.wheel.new_diameter.unwrap_or(f64::INFINITY))
        }
        _ => vec![study.wheel.tape_diameter],
    };
    let with = |diameter: f64| {
        let mut study = nominal.clone();
        study.wheel = study.wheel.with_tape_diameter(diameter);
        study
    };
    diameters.into_iter().map(with).collect()
}

/// The diameters of nominal wheels that a diameter lies between, or the one that it is, m; none is larger than the `largest`.
fn next_to(diameter: f64, largest: f64) -> Vec<f64> {
    let number = diameter / DIAMETERS_APART;
    let nominal = |number: f64| (number * DIAMETERS_APART / MILLIMETRE).round() * MILLIMETRE;
    let around = [nominal(number.floor()), nominal(number.ceil()).min(largest)];
    match around.iter().any(|nominal| (nominal - diameter).abs() < SAME_DIAMETER) {
        true => vec![diameter],
        false => around.to_vec(),
    }
}

/// A case on the bodies of its nominal profiles.
pub(super) struct Sharing {
    /// The case with its standards in the place of its measured profiles: one, or two with the diameters next to that of its wheel.
    pub nominals: Vec<Study>,
    /// Its own surfaces.
    pub surfaces: Surfaces,
}

impl Sharing {
    /// That of a study, if it has measured surfaces on bodies of standards and its table wants that.
    ///
    /// # Errors
    /// Those of its files.
    pub fn of(study: &Study, bodies: BodiesKey) -> Result<Option<Self>> {
        let Study { rail, wheel, .. } = study;
        if !shares(study, bodies) {
            return Ok(None);
        }
        let surfaces = Surfaces::read(study.statics())?;
        let mut nominals = nominals(study, bodies);
        let bases = [surfaces.rail.assumed.as_ref(), surfaces.wheel.assumed.as_ref()];
        let [of_rail, of_wheel] = bases.map(|assumed| assumed.map(|assumed| assumed.base.clone()));
        for nominal in &mut nominals {
            if rail.measured.is_some() && nominal.rail.measured.is_none() {
                nominal.rail.profile.clone_from(&of_rail);
            }
            if wheel.measured.is_some() && nominal.wheel.measured.is_none() {
                nominal.wheel.profile.clone_from(&of_wheel);
            }
        }
        Ok(Some(Self { nominals, surfaces }))
    }

    /// The case on the bodies of its nominal profiles, those of its [`nominals`](Self::nominals).
    ///
    /// # Errors
    /// Surfaces that these bodies do not carry.
    pub fn on(self, study: &Study, nominals: &[&OnBodies]) -> Result<OnBodies> {
        let (statics, Surfaces { rail, wheel }) = (study.statics(), self.surfaces);
        let radius = 0.5 * study.wheel.tape_diameter;
        let [first, others @ ..] = nominals else { unreachable!("a case has nominal profiles") };
        let mut carried = None;
        let geometry = Geometry::of_surfaces(statics, rail, wheel, |rail, wheel, inclination| {
            let track = track(statics, inclination);
            let on = |bodies: &CondensedPair, of_other: Option<&CondensedPair>| {
                let pair = &first.geometry.pair;
                let (rail, wheel) = (rail.clone(), wheel.clone());
                match others.first().zip(of_other) {
                    None => pair.carry(bodies, rail, wheel, &track),
                    Some((other, of_other)) => {
                        let pairs = [(pair, bodies), (&other.geometry.pair, of_other)];
                        let (pair, bodies) = wheel_between(pairs, radius)?;
                        pair.carry(&bodies, rail, wheel, &track)
                    }
                }
            };
            let (pair, bodies) = on(&first.bodies, others.first().map(|other| &other.bodies))?;
            let of_other = others.first().and_then(|other| other.coarser.as_ref());
            let of_other = of_other.and_then(|(_, coarser)| coarser.as_ref().ok());
            let coarser = match &first.coarser {
                Some((element, Ok(Coarser { contact_element, bodies }))) => {
                    let (_, bodies) = on(bodies, of_other.map(|other| &other.bodies))?;
                    Some((*element, Ok(Coarser::new(*contact_element, bodies))))
                }
                Some((element, Err(reason))) => Some((*element, Err(reason.clone()))),
                None => None,
            };
            carried = Some((bodies, coarser));
            Ok(first.geometry.with_surfaces(pair))
        })?;
        let (bodies, coarser) = carried.expect("the surfaces were laid on the bodies");
        Ok(OnBodies { geometry, bodies, coarser })
    }
}
