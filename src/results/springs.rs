//! The springs of a study: laws, horizontal stiffness, their error bands, what was assumed, and what uncertain inputs make of them.

pub mod law;
pub mod form;
pub mod band_record;
pub mod assumed_record;
pub mod uncertainty_record;
pub mod record;
pub mod fields;
pub mod make;
pub mod error_band;
pub mod assumed;
pub mod uncertain_inputs;
pub mod uncertainty;
pub mod figures;
pub mod forms_figure;
pub mod uncertainty_figure;
pub mod stage;
