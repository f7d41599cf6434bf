//! The model of Exudyn: mass points and oscillators, and the contact as a function of their coordinates.

use railspring_simulate::element::condensed::RailOscillator;
use railspring_simulate::element::condensed::parts::Oscillator;

use super::case::LumpedCase;
use super::constants::Constants;
use super::model::{model, write_bushing};
use crate::export::spring::ExportFile;

/// The text behind the constants.
const TEXT: &str = include_str!("exudyn.py");

/// Time steps in a row of the history, for rows of half a millisecond: the forces of load case 4.1 change by 0.1 % of their peaks (RMS) with half of them.
const STEPS: f64 = 16.0;
const ROW: f64 = 0.5e-3;

/// Constants and model, and the tables beside them.
pub(in crate::export) fn files(case: &LumpedCase<'_>) -> Vec<ExportFile> {
    let LumpedCase { scenario, set, damping: [of_rail, of_wheel], rail, .. } = case;
    let mut c = Constants::default();
    case.write_load_case(&mut c);
    c.count("STEPS", (STEPS * scenario.time_step / ROW).ceil().max(1.0) as usize, "time steps in a row");
    c.about("Wheel: a hub, and oscillators of 1 kg that it holds");
    c.numbers(
        "WHEEL_ORIGIN",
        case.wheel_origin,
        "m, origin (y, z) of the wheel's profile from the line of shear centres, where the wheel just touches",
    );
    c.number("HUB_MASS", set.hub.mass, "kg, of the whole wheel");
    let of = |value: fn(&Oscillator) -> f64| set.oscillators.iter().map(value);
    c.numbers("OSCILLATOR_FREQUENCY", of(|o| o.frequency), "Hz, with the hub held");
    c.numbers("RIM_LATERAL", of(|o| o.lateral), "r_y, motion of the rim along y");
    c.numbers("RIM_TURN", of(|o| o.turn), "1/m, r_phi, rotation of the rim");
    c.number("RIM_OFFSET", set.offset, "m, motion of the rim along z over its rotation");
    c.numbers("COUPLING_LATERAL", of(|o| o.coupling[0]), "kg, c, mass between oscillator and hub along y");
    c.numbers("COUPLING_VERTICAL", of(|o| o.coupling[1]), "kg, the same along z");
    c.number("WHEEL_DAMPING", *of_wheel, "s, beta, damping over stiffness");
    c.about("Rail: modes of its beam, of 1 kg, and the motion of the head with its section, about the line of shear centres");
    let of = |value: fn(&RailOscillator) -> f64| rail.oscillators.iter().map(value);
    c.numbers("RAIL_FREQUENCY", of(|o| o.frequency), "Hz");
    c.numbers("HEAD_LATERAL", of(|o| o.head.x), "d_y, motion along y");
    c.numbers("HEAD_VERTICAL", of(|o| o.head.y), "d_z, along z");
    c.numbers("HEAD_TURN", of(|o| o.head.z), "1/m, d_phi, rotation");
    c.number("RAIL_DAMPING", *of_rail, "s, beta, damping over stiffness");
    c.about("Bushing between section and head, with what the ends and the higher modes of the beam add");
    write_bushing(&mut c, &rail.bushing);
    model(case, "Exudyn", "wheel_rail_exudyn", &c, TEXT)
}
