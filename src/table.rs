//! Tables of springs: wheels on rails at many places, from one file.
//!
//! * [`TableDocument`]: the file; [`Table`]: its cases, each of which is a study;
//! * [`Places`]: the places of all cases, taken from the store or made, each kept there by itself;
//! * [`Package`], [`Work`]: cases that go to another machine together, and a step of them;
//! * [`rows`]: what `table.csv` has of a place; [`changes`]: what is different from an earlier table;
//! * [`record()`]: `table.json`; [`page()`]: `table.html`; [`fleet`]: what there is to see in many measured profiles.

pub mod document;
mod files;
mod folder;
mod dates;
mod metadata;
mod pattern;
mod sources;
mod bodies;
mod pairs;
mod cases;
mod shared;
mod surfaces;
mod carried;
mod making;
mod checks;
mod turns;
mod made;
mod places;
mod work;
mod axle;
pub mod rows;
mod record;
pub mod earlier;
pub mod changes;
mod page;
pub mod fleet;
mod measured;

pub use carried::{BodiesRecord, CarriedRecord, OwnRecord};
pub use cases::{Case, Table};
pub use document::TableDocument;
pub use made::{Made, MadePlace, Place, Status};
pub use making::PlaceRecord;
pub use measured::{about, shapes};
pub use metadata::Metadata;
pub use page::page;
pub use places::{Places, Plan};
pub use record::{CaseRecord, FileRecord, PlaceEntry, TableRecord, record};
pub use surfaces::{DeviationRecord, MeasuredRecord, RailRecord, WheelRecord};
pub use work::{Answer, Package, Work};
