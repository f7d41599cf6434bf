//! The files of a model.

use railspring_simulate::element::condensed::parts::Bushing;

use super::case::LumpedCase;
use super::constants::Constants;
use crate::export::spring::{ExportFile, commented};

/// Where the constants stand in the text of a model, and where the interpolation of the wheel's table does.
const CONSTANTS: &str = "# CONSTANTS\n";
const ON_WHEEL: &str = "    # ON_WHEEL\n";

/// The model of a program: its heading, the constants, and the text that runs them, which reads the tables from the file beside it.
pub(super) fn model(
    case: &LumpedCase<'_>,
    program: &str,
    stem: &str,
    constants: &Constants,
    text: &str,
) -> Vec<ExportFile> {
    let whole = text.replacen(CONSTANTS, constants.text(), 1);
    let whole = whole.replacen(ON_WHEEL, include_str!("on_wheel.py"), 1);
    let heading = commented("#", &case.heading(program));
    vec![
        ExportFile { name: format!("{stem}.py"), text: heading + &whole },
        ExportFile { name: format!("{stem}.json"), text: case.surfaces.json() },
    ]
}

/// The four constants of a bushing.
pub(super) fn write_bushing(c: &mut Constants, bushing: &Bushing) {
    c.number("BUSHING_LATERAL", bushing.lateral, "N/m, at its elastic centre");
    c.number("BUSHING_VERTICAL", bushing.vertical, "N/m");
    c.number("BUSHING_TURN", bushing.turn, "N m/rad");
    c.number("BUSHING_HEIGHT", bushing.height, "m, of its elastic centre above the line of shear centres");
}
