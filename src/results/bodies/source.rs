//! The condensed bodies, each by itself: taken from the store by what it is made from, or condensed and kept there.

use std::sync::Mutex;

use railspring_calibrate::pair::{CondensedPair, PairBody, PairSolids, condense_all};
use railspring_calibrate::superelement::CondensedBody;
use railspring_profiles::error::Result;
use railspring_profiles::monitor::Monitor;

use crate::engine::store::{Address, Artefact, Kind, Store};
use crate::results::bodies::coarser::{self, CoarserBodies};
use crate::results::bodies::geometry::Geometry;
use crate::results::bodies::meshes::Meshes;
use crate::results::bodies::solids::{self, MovingBodies};
use crate::study::Statics;

/// Part of an artefact: the body's file.
const BODY: &str = "body.safetensors";

/// Where condensed bodies come from.
#[derive(Clone, Copy)]
pub(crate) struct BodySource<'a> {
    pub store: Option<&'a Store>,
    /// Whether the store keeps rail and wheel that are condensed; else they are only taken from it.
    pub keeps: [bool; 2],
    /// Whether all are condensed anew.
    pub fresh: bool,
    /// A pair whose rail serves again where it is the same one.
    pub beside: Option<&'a CondensedPair>,
    /// Whether the rail is pressed on its foot as well.
    pub foot_held: bool,
    /// Whether there is room for the factors of all of them at the same time.
    pub together: bool,
    /// Name of the study, for lists.
    pub study: &'a str,
    pub monitor: &'a dyn Monitor,
    /// Who hears what the store does not keep, and what is damaged there; none: `monitor`, in the order of the bodies.
    pub trouble: Option<&'a dyn Monitor>,
}

impl<'a> BodySource<'a> {
    /// The same, which says to another monitor how far it is.
    pub fn said_to<'b>(&self, monitor: &'b dyn Monitor) -> BodySource<'b>
    where
        'a: 'b,
    {
        BodySource { monitor, ..*self }
    }
}

/// Address of a body with a key ([`PairSolids::key`]) and no modes.
pub(crate) fn body_address(key: &str) -> Address {
    address(key, 0)
}

fn address(key: &str, modes: usize) -> Address {
    Address::of(Kind::Body, &(key, modes))
}

fn modes_of(body: PairBody, modes: usize) -> usize {
    if body.is_in_time() { modes } else { 0 }
}

/// The body of an artefact.
fn read(artefact: Artefact) -> Result<CondensedBody> {
    CondensedBody::read(artefact.part(BODY).unwrap_or_default())
}

impl BodySource<'_> {
    /// The bodies of `solids` that the calibration presses, those that move with `modes` modes; `which` goes with their names in messages.
    ///
    /// # Errors
    /// Those of condensing them, and an interruption.
    pub fn condensed(&self, solids: &PairSolids<'_>, which: &str, modes: usize) -> Result<CondensedPair> {
        self.pair(solids, which, |_| modes)
    }

    /// The same with as many modes of each body as it has.
    fn pair(
        &self,
        solids: &PairSolids<'_>,
        which: &str,
        modes: impl Fn(PairBody) -> usize + Sync,
    ) -> Result<CondensedPair> {
        self.with_notices(which, |say| {
            let get = |body| self.body(solids, body, modes(body), &|text| say(body, text));
            let rail_is_still = modes(PairBody::RailOnEnds) == 0;
            if let Some(pair) = self.beside.filter(|pair| rail_is_still && self.has_rail(pair, solids)) {
                return get(PairBody::Wheel).map(|wheel| pair.with_wheel(wheel));
            }
            let said = (&*format!("superelements{which}"), self.monitor);
            let bodies = condense_all(said, PairBody::of_pair(self.foot_held), self.together, get)?;
            CondensedPair::new(bodies)
        })
    }

    /// Whether a pair has the rail of `solids`, held in the same ways.
    fn has_rail(&self, pair: &CondensedPair, solids: &PairSolids<'_>) -> bool {
        let on_foot = self.foot_held.then(|| solids.key(PairBody::RailOnFoot));
        pair.rail_on_ends.key == solids.key(PairBody::RailOnEnds)
            && pair.rail_on_foot.as_ref().map(|rail| &rail.key) == on_foot.as_ref()
    }

    /// The bodies of coarser meshes, which error bands are from, the wheel with `modes` modes.
    ///
    /// # Errors
    /// Those of coarser meshes, and as [`Self::condensed`].
    pub fn coarser(
        &self,
        statics: Statics<'_>,
        geometry: &Geometry,
        meshes: &Meshes,
        modes: usize,
    ) -> Result<CoarserBodies> {
        coarser::coarser_bodies(statics, geometry, meshes, |coarser| {
            let modes = |body| if body == PairBody::Wheel { modes } else { 0 };
            self.pair(&solids::solids(statics, geometry, coarser), " of coarser elements", modes)
        })
    }

    /// The bodies of `solids` that move in runs in time, with `modes` modes; `which` goes with their names in messages.
    ///
    /// # Errors
    /// As [`Self::condensed`].
    pub fn moving(&self, solids: &PairSolids<'_>, which: &str, modes: usize) -> Result<MovingBodies> {
        let [(_, wheel), (_, rail)] = self.with_notices(which, |say| {
            let get = |body| self.body(solids, body, modes, &|text| say(body, text));
            let bodies = [PairBody::Wheel, PairBody::RailOnEnds];
            let said = (&*format!("superelements{which}"), self.monitor);
            let bodies = condense_all(said, &bodies, self.together, get)?;
            Ok(<[_; 2]>::try_from(bodies).expect("two bodies"))
        })?;
        Ok(MovingBodies::Own(Box::new([rail, wheel])))
    }

    /// One body of `solids` by itself, with `modes` modes if it moves: in the store afterwards, if that can be written.
    ///
    /// # Errors
    /// As [`Self::condensed`].
    pub fn one(&self, solids: &PairSolids<'_>, body: PairBody, modes: usize) -> Result<()> {
        self.body(solids, body, modes, &|text| self.monitor.notice(&text)).map(drop)
    }

    /// The bodies of a pair with these keys ([`PairSolids::key`]), if the store has all of them.
    ///
    /// # Errors
    /// Bodies that are no pair.
    pub fn known(&self, keys: &[(PairBody, String)]) -> Result<Option<CondensedPair>> {
        let Some(store) = self.store else { return Ok(None) };
        let trouble = |text: String| self.trouble.unwrap_or(self.monitor).notice(&text);
        let of = |(body, key): &(PairBody, String)| {
            let condensed = store.take_as(&body_address(key), read, &trouble)?;
            Some((*body, condensed))
        };
        let bodies: Option<Vec<_>> = keys.iter().map(of).collect();
        bodies.map(CondensedPair::new).transpose()
    }

    /// What `make` makes; what it says of the bodies is said afterwards, in one order, whichever body is there first.
    fn with_notices<T>(
        &self,
        which: &str,
        make: impl FnOnce(&(dyn Fn(PairBody, String) + Sync)) -> Result<T>,
    ) -> Result<T> {
        let notices: Mutex<[Vec<String>; 3]> = Mutex::default();
        let say = |body: PairBody, text: String| {
            let mut notices = notices.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            notices.iter_mut().zip(PairBody::ALL).filter(|(_, of)| *of == body).for_each(|(list, _)| {
                list.push(format!("{}{which}: {text}", body.name()));
            });
        };
        let made = make(&say)?;
        let notices = notices.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        notices.iter().flatten().for_each(|text| self.monitor.notice(text));
        Ok(made)
    }

    fn body(
        &self,
        solids: &PairSolids<'_>,
        body: PairBody,
        modes: usize,
        say: &dyn Fn(String),
    ) -> Result<CondensedBody> {
        let key = solids.key(body);
        let modes = modes_of(body, modes);
        let mesh = if body == PairBody::Wheel { solids.wheel } else { solids.rail };
        // the nodes tell a body from that of coarser elements, which may be condensed beside it
        let stage = format!("{} of {} nodes: factors and modes", body.name(), mesh.nodes.len());
        let condense = |key| {
            let mut all = 1;
            let condensed = solids.condense_in_steps(body, key, modes, &mut |_, done, of| {
                all = of;
                // an interruption is noticed when the body is done
                let _ = self.monitor.progress(&stage, done, of);
            })?;
            self.monitor.progress(&stage, all, all)?;
            Ok(condensed)
        };
        let Some(store) = self.store else {
            return condense(key);
        };
        let address = address(&key, modes);
        let trouble = |text: String| match self.trouble {
            Some(monitor) => monitor.notice(&format!("{}: {text}", body.name())),
            None => say(text),
        };
        if let Some(condensed) = (!self.fresh).then(|| store.take_as(&address, read, &trouble)).flatten() {
            say("taken from the store".into());
            return Ok(condensed);
        }
        let condensed = condense(key)?;
        if !self.keeps[usize::from(body == PairBody::Wheel)] {
            return Ok(condensed);
        }
        let artefact = Artefact::default().with(BODY, condensed.write());
        store.keep(&address, body.name(), self.study, &artefact, &trouble);
        say("made".into());
        Ok(condensed)
    }
}
