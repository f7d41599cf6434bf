//! Load cases on a track in the vertical plane, from one file: a study of `kind = "track"`.
//!
//! * [`TrackStudy`]: the file as a load case of [`railspring_simulate::track`];
//! * [`made`]: its run as files of an output folder: history, record and page.
//!
//! No profiles and no solids take part: nothing is calibrated, and nothing verified.

pub mod document;
mod beams;
mod excitation;
mod profiles;
mod lateral;
mod columns;
mod lateral_columns;
mod outcome;
mod resolve;
mod record;
mod page;
mod make;

pub use columns::TrackColumn;
pub use make::{TrackOutput, made};
pub use outcome::{DerailmentRecord, LoadCase};
pub use record::{Extreme, Figures, TrackRecord, Verification};
pub use resolve::{TrackStudy, is_track};

#[cfg(test)]
mod tests;
