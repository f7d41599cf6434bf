//! Measured surfaces on condensed bodies of their nominal profiles: the bodies of a table are those of its standards, whatever the number of its files.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use railspring_calibrate::pair::CondensedPair;
use railspring_profiles::error::Result;

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

/// Whether a study has measured surfaces on bodies of standards, and its table wants those of the standards.
pub(super) fn shares(study: &Study, bodies: BodiesKey) -> bool {
    let Study { rail, wheel, .. } = study;
    let measured = rail.measured.is_some() || wheel.measured.is_some();
    let drawn = rail.section.is_some() || wheel.section.is_some() || rail.body.is_some();
    bodies == BodiesKey::Nominal && measured && !drawn && study.statics().meshes_are_ours()
}

/// A study without its measured surfaces; where it does not name their standards, these are missing. Its contact zones go down as far as those of measured profiles.
pub(super) fn nominal(study: &Study) -> Study {
    let mut nominal = study.clone();
    nominal.mesh.rail_zone.face_depth += DEEPER;
    (nominal.rail.measured, nominal.wheel.measured) = (None, None);
    nominal
}

/// A case on the bodies of its nominal profiles.
pub(super) struct Sharing {
    /// The case with its standards in the place of its measured profiles.
    pub nominal: Study,
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
        let mut nominal = nominal(study);
        let bases = [surfaces.rail.assumed.as_ref(), surfaces.wheel.assumed.as_ref()];
        let [of_rail, of_wheel] = bases.map(|assumed| assumed.map(|assumed| assumed.base.clone()));
        if rail.measured.is_some() {
            nominal.rail.profile = of_rail;
        }
        if wheel.measured.is_some() {
            nominal.wheel.profile = of_wheel;
        }
        Ok(Some(Self { nominal, surfaces }))
    }

    /// The case on the bodies of its nominal profiles.
    ///
    /// # Errors
    /// Surfaces that these bodies do not carry.
    pub fn on(self, study: &Study, nominal: &OnBodies) -> Result<OnBodies> {
        let (statics, Surfaces { rail, wheel }) = (study.statics(), self.surfaces);
        let mut carried = None;
        let geometry = Geometry::of_surfaces(statics, rail, wheel, |rail, wheel, inclination| {
            let track = track(statics, inclination);
            let of_bodies = &nominal.geometry;
            let on =
                |bodies: &CondensedPair| of_bodies.pair.carry(bodies, rail.clone(), wheel.clone(), &track);
            let (pair, bodies) = on(&nominal.bodies)?;
            let coarser = match &nominal.coarser {
                Some((element, Ok(Coarser { contact_element, bodies }))) => {
                    Some((*element, Ok(Coarser::new(*contact_element, on(bodies)?.1))))
                }
                Some((element, Err(reason))) => Some((*element, Err(reason.clone()))),
                None => None,
            };
            carried = Some((bodies, coarser));
            Ok(of_bodies.with_surfaces(pair))
        })?;
        let (bodies, coarser) = carried.expect("the surfaces were laid on the bodies");
        Ok(OnBodies { geometry, bodies, coarser })
    }
}
