//! One case in a hundred on its own bodies as well. Where there is room for it, they are made one after the other beside the places of the other cases, or else
//! before all others: the elimination of a wheel takes much memory.

use railspring_profiles::error::{Error, Result};
use rayon::prelude::*;

use super::carried::{checking, is_checked};
use super::making::{CaseWork, Ready};
use super::shared::wanted_on_standards;

impl CaseWork<'_> {
    /// Makes the places of the case on its own bodies, if it [is checked](is_checked), which are let go afterwards: at those of the shifts towards the rail (mm) at which the store does not
    /// have them yet, or at all if they are made `fresh`. A case without own bodies is reported, and stays without the comparison.
    ///
    /// # Errors
    /// An interruption.
    pub fn check(&self, shifts_mm: &[f64], fresh: bool) -> Result<()> {
        if !is_checked(self.study, self.settings.bodies) {
            return Ok(());
        }
        let study = checking(self.study);
        let lets_go = wanted_on_standards(self.study, self.settings.bodies);
        let case = CaseWork { study: &study, settings: self.settings.on_own(), lets_go, ..*self };
        let missing = case.missing(shifts_mm, fresh);
        if missing.is_empty() {
            return Ok(());
        }
        // its rail is mostly that of the others, which is in memory then
        let nominal = self.nominal();
        let case = CaseWork { beside: nominal.as_deref().map(Ready::bodies), ..case };
        match case.ready() {
            Ok(ready) => missing.par_iter().try_for_each(|shift| case.place(&ready, *shift).map(drop)),
            Err(Error::Interrupted) => Err(Error::Interrupted),
            Err(reason) => {
                let measured = [&self.study.wheel.measured, &self.study.rail.measured].into_iter().flatten();
                let files: Vec<String> = measured.map(|file| file.path.display().to_string()).collect();
                let text = format!("{}: not compared with own bodies: {reason}", files.join(" on "));
                self.said.notice(&text);
                Ok(())
            }
        }
    }
}
