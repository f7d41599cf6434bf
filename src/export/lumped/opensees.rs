//! The model of OpenSees: beams, rigid links, bushings, and the contact as forces of each time step.

use railspring_profiles::error::{InputError, Result};
use railspring_simulate::element::condensed::parts::Oscillator;

use super::case::{BeamAtWheel, LumpedCase};
use super::constants::Constants;
use super::model::{REMEDY, check_middle, program, tables, write_beam, write_bushing};
use crate::export::spring::ExportFile;

/// The text behind the constants. Contact elements of OpenSees 3.7.1 with friction (`zeroLengthContactNTS2D`, `SimpleContact2D`) lose it where a wheel slides over several segments.
const TEXT: &str = include_str!("opensees.py");

/// An oscillator turns the rim about a pole, which is no farther away than this, m.
const FARTHEST_POLE: f64 = 1e3;

/// Largest mass between two oscillators that is left out, over that of the hub: what one with a small coupling would feel of the one with the largest. With 0.035 the forces of a load case like 4.1 were 2 % of their
/// peaks off (RMS).
const MOST_BETWEEN: f64 = 0.01;

/// Largest share of the hub's mass in an oscillator that moves against the centre of mass of both.
const MOST_SHARE: f64 = 0.005;

/// Most elements of the beam by the numbers of its nodes.
const MOST_ELEMENTS: usize = 98;

/// Constants and model, and the tables beside them.
///
/// # Errors
/// [`InputError`] for a wheel beside the middle of the rail, and for oscillators that these hinges cannot be.
pub(in crate::export) fn files(case: &LumpedCase<'_>) -> Result<Vec<ExportFile>> {
    check(case)?;
    let BeamAtWheel { beam, bushing, .. } = &case.beam;
    let mut c = Constants::default();
    case.write_history(&mut c);
    case.write_load_case(&mut c);
    case.write_wheel(&mut c);
    write_beam(&mut c, case);
    c.number("RAIL_ANGLE", beam.angle(), "rad, of the section's axes, from y to z");
    c.about("Bushing between beam and head, at the place of the wheel on this rail");
    write_bushing(&mut c, bushing);
    let python = program(case, "OpenSees", "wheel_rail_opensees", &c, TEXT);
    Ok(vec![python, tables(case, "wheel_rail_opensees")])
}

fn check(case: &LumpedCase<'_>) -> Result<()> {
    check_middle(case)?;
    let beam = &case.beam.beam;
    if beam.elements() > MOST_ELEMENTS {
        let expected = format!("{MOST_ELEMENTS} elements at most");
        return InputError::refuse("simulation.rail_elements", beam.elements(), expected, REMEDY);
    }
    let oscillators = &case.pair.element.set.oscillators;
    if let Some(coupling) = too_large(oscillators, case.hub_mass()) {
        let expected = "one large coupling along y, and small ones beside it";
        return InputError::refuse("lumped.oscillators[].coupling_kg", coupling, expected, REMEDY);
    }
    match oscillators.iter().position(|of| of.lateral.abs() > FARTHEST_POLE * of.turn.abs()) {
        Some(i) => InputError::refuse(
            format!("lumped.oscillators[{i}].rim_turn_per_m"),
            oscillators[i].turn,
            "a rotation of the rim, which is a hinge in the model",
            REMEDY,
        ),
        None => Ok(()),
    }
}

/// A coupling (kg) beside the largest one along y that is too large to be left to the poles of the hinges.
fn too_large(oscillators: &[Oscillator], hub: f64) -> Option<f64> {
    let mut lateral: Vec<f64> = oscillators.iter().map(|of| of.coupling[0].abs()).collect();
    lateral.sort_by(f64::total_cmp);
    let largest = lateral.pop()?;
    let vertical = oscillators.iter().map(|of| of.coupling[1].abs());
    let beside = lateral.into_iter().rev().find(|of| of * largest > MOST_BETWEEN * hub);
    beside.or(vertical.into_iter().find(|of| of * of > MOST_SHARE * hub))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: wheels with one large coupling along y pass, as those of the standards have it, with a small one along z; a second one along y that moves the first, and a large one along z, are named.
    #[test]
    fn hinges_take_one_large_coupling() {
        let found = |couplings: &[[f64; 2]]| {
            let oscillators: Vec<Oscillator> = couplings
                .iter()
                .map(|&coupling| Oscillator {
                    frequency: 200.0,
                    lateral: 0.1,
                    turn: -0.3,
                    coupling,
                    turn_coupling: 0.0,
                })
                .collect();
            too_large(&oscillators, 309.0)
        };
        assert_eq!(found(&[[0.0, 0.3], [-15.6, 0.0], [0.0, 0.0]]), None);
        assert_eq!(found(&[[0.15, 0.0], [-15.6, 0.0]]), None);
        assert_eq!(found(&[[0.7, 0.0], [-15.6, 0.0]]), Some(0.7));
        assert_eq!(found(&[[0.0, 1.5], [-15.6, 0.0]]), Some(1.5));
        assert_eq!(found(&[]), None);
    }
}
