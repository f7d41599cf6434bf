//! What the models of several programs have in common.

use railspring_profiles::error::{InputError, Result};
use railspring_simulate::element::condensed::parts::Bushing;

use super::case::LumpedCase;
use super::constants::Constants;
use super::surfaces::LumpedContact;
use crate::export::spring::{ExportFile, commented};

/// Parts of the text of a model, by the line where each stands: what is between the profiles, and in that the interpolation of the wheel's table.
const STRIPS: (&str, &str) = ("# STRIPS\n", include_str!("strips.py"));
const POINTS: &str = include_str!("points.py");
const ON_WHEEL: (&str, &str) = ("    # ON_WHEEL\n", include_str!("on_wheel.py"));

/// Where the constants stand.
const CONSTANTS: &str = "# CONSTANTS\n";

/// What to do where a model with beams cannot be.
pub(super) const REMEDY: &str = "take --to lumped-exudyn, which has the rail by its modes at the wheel";

/// A Python file for a program: its heading, the constants, and the text that runs them.
pub(super) fn program(
    case: &LumpedCase<'_>,
    program: &str,
    stem: &str,
    constants: &Constants,
    text: &str,
) -> ExportFile {
    let whole = text.replacen(CONSTANTS, constants.text(), 1);
    let (points, class) = match case.contact {
        LumpedContact::Strips => ("", "Strips"),
        LumpedContact::Points => (POINTS, "Points"),
    };
    let between = format!("{}{points}\n\nCONTACT = {class}  # what lies between the profiles\n", STRIPS.1);
    let whole = whole.replacen(STRIPS.0, &between, 1).replacen(ON_WHEEL.0, ON_WHEEL.1, 1);
    ExportFile { name: format!("{stem}.py"), text: commented("#", &case.heading(program)) + &whole }
}

/// The tables of the profiles with their strips, for the Python file of that name.
pub(super) fn tables(case: &LumpedCase<'_>, stem: &str) -> ExportFile {
    ExportFile { name: format!("{stem}.json"), text: case.surfaces.json(case.contact) }
}

/// The four constants of a bushing.
pub(super) fn write_bushing(c: &mut Constants, bushing: &Bushing) {
    c.number("BUSHING_LATERAL", bushing.lateral, "N/m, at its elastic centre");
    c.number("BUSHING_VERTICAL", bushing.vertical, "N/m");
    c.number("BUSHING_TURN", bushing.turn, "N m/rad");
    c.number("BUSHING_HEIGHT", bushing.height, "m, of its elastic centre above the line of shear centres");
}

/// The constants of the rail's beam but the angle of its axes.
pub(super) fn write_beam(c: &mut Constants, case: &LumpedCase<'_>) {
    let LumpedCase { pair, beam, .. } = case;
    let beam = &beam.beam;
    c.about("Rail, with the corrections of shear and torsion to the solid rail");
    let (section, material) = (beam.section(), &pair.surfaces.study.rail.material);
    let shear = material.young / (2.0 * (1.0 + material.poisson));
    c.number("RAIL_LENGTH", beam.length(), "m");
    c.count("RAIL_ELEMENTS", beam.elements(), "an even number: the wheel is on the node in the middle");
    c.number("YOUNG", material.young, "Pa");
    c.number("SHEAR_MODULUS", shear, "Pa");
    c.number("DENSITY", material.density, "kg/m^3");
    c.number("AREA", section.mass / material.density, "m^2");
    c.number(
        "INERTIA_LATERAL",
        section.bending_y / material.young,
        "m^4, against bending along the section's y",
    );
    c.number(
        "INERTIA_VERTICAL",
        section.bending_z / material.young,
        "m^4, against bending along the section's z",
    );
    c.number("SHEAR_AREA_LATERAL", section.shear_y / shear, "m^2");
    c.number("SHEAR_AREA_VERTICAL", section.shear_z / shear, "m^2");
    c.number("TORSION_CONSTANT", section.torsion / shear, "m^4, with the warping that the ends hold");
    c.numbers("CENTROID", section.centroid, "m, from the shear centre along the section's y and z");
    c.number("RAIL_DAMPING", pair.damping[0], "s, in proportion to stiffness");
}

/// Whether the wheel is in the middle of the rail.
pub(super) fn check_middle(case: &LumpedCase<'_>) -> Result<()> {
    let place = case.beam.place;
    if (place / case.beam.beam.length() - 0.5).abs() > 1e-9 {
        let key = "scenario.start_x_m";
        return InputError::refuse(key, place, "the middle of the rail, where the beam has a node", REMEDY);
    }
    Ok(())
}
