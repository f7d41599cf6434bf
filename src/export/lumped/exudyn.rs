//! The model of Exudyn: mass points and oscillators, and the contact as a function of their coordinates.

use railspring_simulate::element::condensed::RailOscillator;

use super::case::LumpedCase;
use super::constants::Constants;
use super::model::{program, tables, write_bushing};
use crate::export::spring::ExportFile;

/// The text behind the constants.
const TEXT: &str = include_str!("exudyn.py");

/// Constants and model, and the tables beside them.
pub(in crate::export) fn files(case: &LumpedCase<'_>) -> Vec<ExportFile> {
    let LumpedCase { pair, rail, .. } = case;
    let mut c = Constants::default();
    case.write_history(&mut c);
    case.write_load_case(&mut c);
    case.write_wheel(&mut c);
    c.about("Rail: modes of its beam, of 1 kg, and the motion of the head with its section, about the line of shear centres");
    let of = |value: fn(&RailOscillator) -> f64| rail.oscillators.iter().map(value);
    c.numbers("RAIL_FREQUENCY", of(|o| o.frequency), "Hz");
    c.numbers("HEAD_LATERAL", of(|o| o.head.x), "d_y, motion along y");
    c.numbers("HEAD_VERTICAL", of(|o| o.head.y), "d_z, along z");
    c.numbers("HEAD_TURN", of(|o| o.head.z), "1/m, d_phi, rotation");
    c.number("RAIL_DAMPING", pair.damping[0], "s, beta, damping over stiffness");
    c.about("Bushing between section and head, with what the ends and the higher modes of the beam add");
    write_bushing(&mut c, &rail.bushing);
    let python = program(case, "Exudyn", "wheel_rail_exudyn", &c, TEXT);
    vec![python, tables(case, "wheel_rail_exudyn")]
}
