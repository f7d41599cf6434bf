//! Load cases on a track against closed solutions.

mod across;
mod bridge;
mod crossing;
mod functions;
mod ground;
mod rails;
mod statics;
mod vertical;
mod wheelset;

use railspring_calibrate::beam::BeamSection;
use railspring_calibrate::law::StiffnessLaw;

use super::*;
use crate::time::function::TimeFunction;
use crate::time::scenario::Kelvin;

/// A section with a bending stiffness (N·m²) and a mass (kg/m), without shear and rotary inertia.
fn slender(bending: f64, mass: f64) -> BeamSection {
    BeamSection {
        axial: 1e12,
        bending_y: bending,
        bending_z: bending,
        shear_y: f64::INFINITY,
        shear_z: f64::INFINITY,
        torsion: 1e12,
        mass,
        rotary_y: 0.0,
        rotary_z: 0.0,
        polar: mass,
        centroid: [0.0; 2],
    }
}

fn beam(section: BeamSection) -> LineBeam {
    LineBeam { section, damping: 0.0, mass_damping: 0.0 }
}

/// Both ends of the rail held vertically.
fn on_two_supports(section: BeamSection, length: f64, elements: usize) -> Track {
    let held = [0, elements].map(|node| Held { of: Carrier::Rail, node, direction: Direction::Vertical });
    Track {
        length,
        elements,
        rail: beam(section),
        bridge: None,
        bed: None,
        held: held.into(),
        layers: Vec::new(),
    }
}

/// A rail of 60E1 by its numbers, on sleepers at every other node.
fn on_sleepers(elements: usize, pitch: f64) -> Track {
    let mut section = slender(6.38e6, 60.2);
    (section.shear_z, section.rotary_z) = (2.43e8, 0.2385);
    let sleeper = |node: usize| Layers {
        of: Carrier::Rail,
        x: node as f64 * pitch,
        direction: Direction::Vertical,
        upper: kelvin(1e8, 3e4),
        below: Some((150.0, kelvin(5e7, 5e4))),
        onto: Onto::Ground,
    };
    Track {
        length: elements as f64 * pitch,
        elements,
        rail: LineBeam { section, damping: 1e-6, mass_damping: 0.0 },
        bridge: None,
        bed: None,
        held: Vec::new(),
        layers: (0..=elements).step_by(2).map(sleeper).collect(),
    }
}

fn kelvin(stiffness: f64, damping: f64) -> Kelvin {
    Kelvin { stiffness, damping }
}

fn linear(stiffness: f64) -> Wheels {
    let law = StiffnessLaw { a: stiffness, b: 0.0, c: 0.0 };
    Wheels { law: law.into(), damping: 0.0, unevenness: vec![Unevenness::default()] }
}

/// A mass (kg) on its contact alone, at rest in balance with its weight at `x` (m).
fn case(track: Option<Track>, mass: f64, wheels: Wheels, way: Way, [steps, duration]: [f64; 2]) -> TrackCase {
    let wheel = SprungWheel { mass, above: 0.0, suspension: kelvin(0.0, 0.0) };
    TrackCase {
        track,
        running: Running::Wheel(wheel),
        wheels,
        steps: steps as usize,
        time_step: duration / steps,
        inner_steps: 1,
        gravity: 9.81,
        force: TimeFunction::default(),
        roll: TimeFunction::default(),
        ground: TimeFunction::default(),
        way,
        start: Start::Equilibrium,
        probes: Vec::new(),
    }
}

fn probe(of: Carrier, x: f64) -> Probe {
    Probe { name: "probe".into(), of, rail: 0, x }
}

fn run(case: &TrackCase) -> TrackRun {
    case.run(&railspring_profiles::monitor::Silent).unwrap()
}

/// The row with the largest deflection of a probe.
fn lowest(run: &TrackRun, probe: usize) -> &TrackRow {
    let of = |row: &TrackRow| row.probes[probe].deflection;
    run.rows.iter().max_by(|a, b| of(a).total_cmp(&of(b))).unwrap()
}
