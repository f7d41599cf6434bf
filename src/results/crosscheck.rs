//! Cross-validation: independent programs repeat what the tool computed.
//!
//! * [`exchange`]: the questions, as files without the tool's formulations;
//! * [`deck`] and [`calculix`]: the same problem as a deck for CalculiX or Abaqus, and running it;
//! * [`mod@compare`]: answers against answers, with limits and their causes;
//! * [`questions`]: the questions in words and numbers;
//! * [`in_time`]: a load case in time, solved again;
//! * [`mod@sections`]: where on the bodies the answers differ.

pub mod record;
pub mod input;
pub mod answers;
pub mod calculix;
pub mod exchange;
pub mod compare;
pub mod deck;
pub mod questions;
pub mod sections;
mod solvers;
mod prepared;
mod make;
pub mod stage;
pub mod in_time;
pub mod page;

pub use make::crosscheck;
pub use prepared::{Prepared, prepare, write_deck};
pub use solvers::Solvers;
