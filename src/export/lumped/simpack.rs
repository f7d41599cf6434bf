//! The pair for Simpack: the wheel as standard input data of a flexible body, the constants as its variables, and the bushing as statements of a model.
//!
//! Syntax as in the model files of Simpack 2021: comments behind `!`, a variable by `subvar.str`, a bushing by `force.type = 43` with its stiffness in the parameters 7 to 12 and its damping in 13 to 18.

use std::fmt::Write as _;

use super::constants::literal;
use super::pair::LumpedPair;
use super::sid;
use crate::export::spring::{ExportFile, commented};

/// First line of a file, without which Simpack does not read it.
const VERSION: &str = "!file.version=3.5! Removing this line will make the file unreadable\n";

/// Wheel, variables and bushing.
pub(in crate::export) fn files(pair: &LumpedPair<'_>) -> Vec<ExportFile> {
    let set = &pair.element.set;
    vec![
        ExportFile { name: "wheel.SID_FEM".into(), text: sid::wheel(set, pair.damping[1]) },
        ExportFile { name: "wheel_rail_simpack.subvar".into(), text: variables(pair) },
        ExportFile { name: "bushing_simpack.txt".into(), text: bushing(pair) },
    ]
}

/// All constants as variables.
fn variables(pair: &LumpedPair<'_>) -> String {
    let set = &pair.element.set;
    let mut text =
        VERSION.to_string() + &commented("!", &pair.heading("Simpack", &["SI units, angles in rad"]));
    let mut add = |name: &str, value: f64, meaning: &str| {
        let (name, value) = (format!("$_{name}"), format!("'{}'", literal(value)));
        let _ = writeln!(text, "subvar.str ({name:>40}{:18}) = {value:24}! {meaning}", "");
    };
    add("wheel_mass", set.hub.mass, "kg");
    add("wheel_Ixx", set.hub.inertia, "kg m^2, about the track's direction through the hub's centre");
    add("wheel_damping", pair.damping[1], "s, damping over stiffness");
    for (i, of) in set.oscillators.iter().enumerate() {
        for (name, value, meaning) in [
            ("f", of.frequency, "Hz, the hub held"),
            ("ry", of.lateral, "motion of the rim along y"),
            ("rphi", of.turn, "1/m, rotation of the rim"),
            ("cy", of.coupling[0], "kg, with the hub along y"),
            ("cz", of.coupling[1], "kg, with the hub along z"),
            ("cphi", of.turn_coupling, "kg m, with the hub's rotation"),
        ] {
            add(&format!("osc{}_{name}", i + 1), value, meaning);
        }
    }
    add("rim_offset", set.offset, "m, motion of the rim along z over its rotation");
    for (name, of) in [("bush", &set.bushing), ("bush_held", &set.on_section)] {
        add(&format!("{name}_ky"), of.lateral, "N/m, at the elastic centre");
        add(&format!("{name}_kz"), of.vertical, "N/m");
        add(&format!("{name}_kal"), of.turn, "N m/rad");
        add(&format!("{name}_height"), of.height, "m, of the elastic centre above the line of shear centres");
    }
    let centre = pair.surfaces.geometry.pair.node_line();
    add("shear_centre_z", centre.y, "m, line of shear centres below the highest point of the rail");
    text
}

/// The bushing, with the damping of the rail's material.
fn bushing(pair: &LumpedPair<'_>) -> String {
    let (of, beta) = (&pair.element.set.bushing, pair.damping[0]);
    let mut text = commented(
        "!",
        &pair.heading(
            "Simpack",
            &[
                "a bushing between the rail's section and its head, to be put into a model; bodies and names are to be replaced",
                "both markers are at the elastic centre, z down from the line of shear centres; the head moves in y, z and al alone",
            ],
        ),
    );
    for (marker, body) in [("$M_rail_section", "$B_rail"), ("$M_rail_head", "$B_head")] {
        statement(&mut text, "marker.type", "", marker, "1", "Type");
        statement(&mut text, "marker.parent", "", marker, body, "Body");
        statement(&mut text, "marker.pos", "3 ,", marker, &number(-of.height), "Position");
    }
    const FORCE: &str = "$F_railspring_bushing";
    statement(&mut text, "force.type", "", FORCE, "43", "Type");
    statement(&mut text, "force.from", "", FORCE, "$M_rail_section", "From Marker");
    statement(&mut text, "force.to", "", FORCE, "$M_rail_head", "To Marker");
    let stiffness = [0.0, of.lateral, of.vertical, of.turn, 0.0, 0.0];
    let directions = ["x", "y", "z", "al", "be", "ga"];
    for (first, times, [length, angle], what) in
        [(7, 1.0, ["N/m", "Nm/rad"], "stiffness"), (13, beta, ["Ns/m", "Nms/rad"], "damping")]
    {
        for (i, direction) in directions.iter().enumerate() {
            let (unit, kind) = if i < 3 { (length, "Transl.") } else { (angle, "Rotat.") };
            let index = format!("{} ,", first + i);
            let meaning = format!("[{unit}] {kind} {what} in {direction}");
            statement(&mut text, "force.par", &index, FORCE, &number(times * stiffness[i]), &meaning);
        }
    }
    text
}

fn statement(text: &mut String, key: &str, index: &str, name: &str, value: &str, meaning: &str) {
    let _ = writeln!(text, "{key:16}({index:>19} {name:30}) = {value:24}! {meaning}");
}

fn number(value: f64) -> String {
    sid::scientific(value, 17, 'E')
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: a statement has key, index, name, value and meaning as Simpack's own files have them.
    #[test]
    fn a_statement_has_its_parts() {
        let mut text = String::new();
        statement(&mut text, "force.par", "8 ,", "$F_b", &number(1.5e9), "[N/m] Transl. stiffness in y");
        let parts: Vec<&str> = text.split(['(', ')', '=', '!']).map(str::trim).collect();
        let name: Vec<&str> = parts[1].split_whitespace().collect();
        assert_eq!(
            (parts[0], name, parts[4]),
            ("force.par", vec!["8", ",", "$F_b"], "[N/m] Transl. stiffness in y")
        );
        assert_eq!(parts[3].parse(), Ok(1.5e9));
    }
}
