//! A body reduced to its contact nodes: factor once, then only dense algebra.
//!
//! The equations of the contact nodes and of the master node come last, so the
//! trailing block `L_rr` of the Cholesky factor is the factor of the Schur
//! complement, and `(L_rr·L_rrᵀ)⁻¹` is the exact compliance there. A body that is its own mirror
//! image across the track is condensed by halves ([`Parts`]).

mod dense;
mod products;
mod mirrored;
mod left;
mod elimination;
mod factor;
mod size;
mod section_motion;
mod step;
mod factored;
mod modes;
mod condensed;
mod condensed_file;
mod parts;

#[cfg(test)]
pub use condensed::Interior;
pub use condensed::{CondensedBody, body_key};
pub use dense::product_speed;
pub use factor::Factor;
pub use factored::Superelement;
pub use mirrored::{image_along, is_mirrored, sign_along};
pub use modes::Modes;
pub use parts::{Parts, Wanted};
pub use products::{add_columns, add_times, times};
pub use section_motion::{SectionLoads, SectionMotion, carried};
pub use size::FactorSize;
pub use step::Step;
