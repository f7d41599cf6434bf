//! CalculiX and Abaqus: a nonlinear spring between two nodes, as a deck that runs.
//!
//! `SPRINGA` acts along the line between its nodes. Both programs keep the force beyond the last point as it is.

use std::fmt::Write as _;

use railspring_profiles::units::{KILONEWTON, MILLIMETRE};

use super::points::Points;
use super::spring::{ExportFile, Spring, commented};
use crate::results::crosscheck::deck::Format;

/// The deck: the spring, and steps that lower the wheel to its displacements under some loads.
pub(super) fn file(spring: &Spring, format: Format) -> ExportFile {
    let points = Points::of(spring);
    let loads = spring.shown_loads();
    let shown: Vec<String> = loads.iter().map(|load| (load / KILONEWTON).to_string()).collect();
    let (program, name, blank) = match format {
        Format::Calculix => ("CalculiX", "wheel_rail_spring_calculix.inp", ""),
        // the line for the direction, which a SPRINGA does not have
        Format::Abaqus => ("Abaqus", "wheel_rail_spring_abaqus.inp", "\n"),
    };
    let own = [
        points.sentence(spring.range[0]),
        "units: N, mm; force and displacement of the spring are negative in compression".into(),
        "no tension: the last two points; beyond the first one the force stays as it is, which is no law"
            .into(),
        format!("steps: the wheel is lowered to its displacements under {} kN", shown.join(", ")),
    ];
    let mut text =
        commented("**", &spring.heading(&format!("Contact spring of a wheel on a rail, {program}"), &own));
    let _ = write!(
        text,
        "*HEADING\nwheel on rail\n*NODE, NSET=RAIL\n1, 0., 0., 0.\n*NODE, NSET=WHEEL\n2, 0., 0., 1000.\n\
         *ELEMENT, TYPE=SPRINGA, ELSET=CONTACT\n1, 1, 2\n*SPRING, ELSET=CONTACT, NONLINEAR\n{blank}"
    );
    for [displacement, force] in points.compression_negative() {
        let _ = writeln!(text, "{force:.9e}, {:.9e}", displacement / MILLIMETRE);
    }
    let _ = writeln!(text, "*BOUNDARY\n1, 1, 3\n2, 1, 2");
    for load in loads {
        let _ = write!(
            text,
            "*STEP, INC=100\n*STATIC\n1., 1.\n*BOUNDARY\n2, 3, 3, {:.9e}\n*NODE PRINT, NSET=WHEEL, FREQUENCY=1000\nU, RF\n\
             *END STEP\n",
            -spring.law.displacement(load) / MILLIMETRE
        );
    }
    ExportFile { name: name.into(), text }
}
