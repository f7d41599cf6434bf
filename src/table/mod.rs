//! Tables of springs: wheels on rails at many places, from one file.
//!
//! * [`TableDocument`]: the file; [`Table`]: its cases, each of which is a study;
//! * [`Places`]: the places of all cases, taken from the store or made, each kept there by itself;
//! * [`rows`]: what `table.csv` has of a place; [`changes`]: what is different from an earlier table;
//! * [`record()`]: `table.json`; [`page()`]: `table.html`.

pub mod document;
mod cases;
mod places;
pub mod rows;
pub mod changes;
mod record;
mod page;

pub use cases::{Case, Table};
pub use document::TableDocument;
pub use page::page;
pub use places::{Place, PlaceRecord, Places, Plan};
pub use record::{CaseRecord, FileRecord, PlaceEntry, TableRecord, record};
