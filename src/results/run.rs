//! The load cases on both models.

pub mod record;
pub mod input;
pub mod history_csv;
pub mod make;
pub mod springs;
pub mod uncertain_record;
pub mod departed;
pub mod uncertain;
pub mod figures;
pub mod positions_figure;
pub mod stage;
pub mod uncertain_stage;
pub mod solid_stage;
