//! How a long stage says how far it is, and learns that it should stop.

use crate::error::Result;

/// Receives progress. Returning [`crate::error::Error::Interrupted`] ends the stage.
pub trait Monitor: Sync {
    /// `done` of `total` pieces of `stage` are finished.
    ///
    /// # Errors
    /// [`crate::error::Error::Interrupted`] when the user asked to stop.
    fn progress(&self, stage: &str, done: usize, total: usize) -> Result<()>;

    /// Something that the user should know although the stage goes on.
    fn notice(&self, _text: &str) {}
}

/// Says nothing and never stops.
pub struct Silent;

impl Monitor for Silent {
    fn progress(&self, _stage: &str, _done: usize, _total: usize) -> Result<()> {
        Ok(())
    }
}
