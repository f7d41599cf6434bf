//! The model of STEM: its beams with ribs that have the rail's mass, and the wheel as a vehicle that a user defines (UVEC).

use railspring_profiles::error::Result;

use super::case::{BeamAtWheel, LumpedCase};
use super::constants::Constants;
use super::model::{check_middle, program, tables, write_beam, write_bushing};
use crate::export::spring::ExportFile;

/// The texts behind the constants: of the rail, and of the wheel.
const RAIL: &str = include_str!("stem.py");
const WHEEL: &str = include_str!("uvec.py");

/// Rail, wheel and tables.
///
/// # Errors
/// [`InputError`](railspring_profiles::error::InputError) for a wheel beside the middle of the rail.
pub(in crate::export) fn files(case: &LumpedCase<'_>) -> Result<Vec<ExportFile>> {
    check_middle(case)?;
    let BeamAtWheel { beam, place, bushing } = &case.beam;
    let mut rail = Constants::default();
    case.write_history(&mut rail);
    write_beam(&mut rail, case);
    let mut wheel = Constants::default();
    case.write_load_case(&mut wheel);
    case.write_wheel(&mut wheel);
    wheel.about("Rail: what STEM's beam does not have");
    wheel.number("RAIL_ANGLE", beam.angle(), "rad, of the section's axes, from y to z");
    let (length, torsion) = (beam.length(), beam.section().torsion);
    wheel.number(
        "RAIL_TURN",
        torsion * length / (place * (length - place)),
        "N m/rad, torsion of the rail at the wheel, where STEM takes no moment",
    );
    wheel.about("Bushing between beam and head, at the place of the wheel on this rail");
    write_bushing(&mut wheel, bushing);
    Ok(vec![
        program(case, "STEM", "wheel_rail_stem", &rail, RAIL),
        program(case, "STEM", "wheel_uvec", &wheel, WHEEL),
        tables(case, "wheel_uvec"),
    ])
}
