//! Two results side by side: springs with their error bands and whether they differ beyond them, laws and stiffness over load and contact
//! angle, the verdicts, and what of the inputs differs. The two are called A and B, and a change is that from A to B.

mod side;
mod values;
mod solid;
mod rows;
mod comparison;
mod page;

pub use comparison::{Comparison, compare};
pub use page::page;
pub use rows::{Group, InputChange, LineChange};
pub use side::{About, Side};
pub use values::Compared;

#[cfg(test)]
mod tests;
