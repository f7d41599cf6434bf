//! What people look for in a table of many measured profiles: `table_fleet.html`, `table_typical.toml` and `table.parquet`.
//!
//! * [`parquet()`]: the rows for programs that read columns;
//! * [`Shape`]: how far a measured profile is from its standard; [`page()`]: the page, with the profiles that stand for all;
//! * [`earlier()`]: the rows of an earlier table.

mod about;
mod robust;
mod shape;
mod medoids;
mod kind;
mod quantity;
mod bodies;
mod section;
mod counts;
mod spreads;
mod trends;
mod outliers;
mod typical;
mod axles;
mod campaign;
mod parquet;
mod pages;

pub use about::About;
pub use campaign::earlier;
pub use pages::{Pages, page};
pub use parquet::parquet;
pub use shape::Shape;
