//! The condensed bodies, each by itself: taken from the store by what it is made from, or condensed and kept there.

use railspring_calibrate::error::Result;
use railspring_calibrate::monitor::Monitor;
use railspring_calibrate::pair::{PairBody, PairSolids};
use railspring_calibrate::superelement::{CondensedBody, Interior};
use std::sync::Mutex;

use crate::stages::Bodies;
use crate::store::{Artefact, Found, Kind, Store};

/// Part of an artefact: the body's file.
const BODY: &str = "body.safetensors";

/// Where condensed bodies come from.
pub(super) struct BodySource<'a> {
    pub store: Option<&'a Store>,
    /// Whether all are condensed anew.
    pub fresh: bool,
    /// Name of the study, for lists.
    pub study: &'a str,
    pub monitor: &'a dyn Monitor,
}

impl BodySource<'_> {
    /// The bodies of `solids`.
    ///
    /// # Errors
    /// Those of condensing them, and an interruption.
    pub fn bodies<'m>(&self, solids: PairSolids<'m>) -> Result<Bodies<'m>> {
        // said in one order, whichever body is there first
        let notices: Mutex<[Vec<String>; 3]> = Mutex::default();
        let say = |body: PairBody, text: String| {
            let mut notices = notices.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            notices.iter_mut().zip(PairBody::ALL).filter(|(_, of)| *of == body).for_each(|(list, _)| {
                list.push(format!("{}: {text}", body.name()));
            });
        };
        let bodies =
            Bodies::new(solids, |body| self.body(&solids, body, &|text| say(body, text)), self.monitor)?;
        let notices = notices.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        notices.iter().flatten().for_each(|text| self.monitor.notice(text));
        Ok(bodies)
    }

    fn body<'m>(
        &self,
        solids: &PairSolids<'m>,
        body: PairBody,
        say: &dyn Fn(String),
    ) -> Result<(CondensedBody, Option<Interior<'m>>)> {
        let Some(store) = self.store else {
            return solids.condense(body).map(|(condensed, interior)| (condensed, Some(interior)));
        };
        let address = store.address(Kind::Body, &solids.key(body));
        if !self.fresh {
            let damaged = match store.take(&address) {
                Found::Whole(artefact) => {
                    match CondensedBody::read(artefact.part(BODY).unwrap_or_default()) {
                        Ok(condensed) => {
                            say("taken from the store".into());
                            return Ok((condensed, None));
                        }
                        Err(cause) => store.discard(&address, cause.to_string()),
                    }
                }
                found => found,
            };
            if let Found::Damaged(reason) = damaged {
                say(format!("the entry of the store is damaged ({reason}): made again"));
            }
        }
        let (condensed, interior) = solids.condense(body)?;
        let artefact = Artefact::default().with(BODY, condensed.write());
        // a store that cannot be written takes nothing from the result
        if let Err(cause) = store.put(&address, body.name(), self.study, &artefact) {
            say(format!("not kept in the store: {cause}"));
        }
        say("made".into());
        Ok((condensed, Some(interior)))
    }
}
