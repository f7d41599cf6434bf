//! The sections `scenario.NAME` in SI units.

use std::path::Path;

use railspring_profiles::units::{KILONEWTON, TONNE};
use railspring_simulate::time::function::{HarmonicForce, TimeFunction};
use railspring_simulate::time::scenario::{Kelvin, Scenario};
use railspring_simulate::time::steps::InnerSteps;

use crate::study::analysis::StudyScenario;
use crate::study::collect::Collector;
use crate::study::document::{
    ForceKeys, HarmonicForceKeys, HarmonicMomentKeys, ScenarioKeys, SuspensionKeys, TableKeys, TorsionKeys,
    sine,
};
use crate::study::source::Source;
use crate::study::tables::{Shorter, Steps, Table};

/// A load case in SI units, without the tables of its forces.
pub(super) fn scenario(keys: &ScenarioKeys, friction: f64) -> StudyScenario {
    StudyScenario {
        description: keys.description.clone(),
        solid: keys.solid,
        ratio_limit: keys.ratio_limit,
        snapshots: keys.snapshots_s.clone(),
        notes: Vec::new(),
        tables: Vec::new(),
        scenario: Scenario {
            steps: keys.steps,
            time_step: keys.time_step_s,
            inner_steps: InnerSteps::Equal(1),
            friction: keys.friction.unwrap_or(friction),
            gravity: keys.gravity_m_per_s2,
            suspended_mass: keys.suspended_mass_t * TONNE,
            vertical_suspension: kelvin(&keys.vertical_suspension),
            vertical_force: force(&keys.vertical_force),
            lateral_suspension: kelvin(&keys.lateral_suspension),
            lateral_force: force(&keys.lateral_force),
            rail_torsion: keys.rail_torsion.as_ref().map(torsion),
            wheel_mass: keys.wheel_mass_t.map(|mass| mass * TONNE),
            start_x: keys.start_x_m,
            speed: keys.speed_m_per_s,
            rotations_held: keys.rotations_held,
        },
    }
}

fn kelvin(keys: &SuspensionKeys) -> Kelvin {
    Kelvin { stiffness: keys.stiffness_kn_per_m * KILONEWTON, damping: keys.damping_kn_s_per_m * KILONEWTON }
}

fn force(keys: &ForceKeys) -> TimeFunction {
    let ForceKeys { mean_kn, amplitude_kn, frequency_hz, phase_deg, harmonics, .. } = keys;
    let first = sine(*mean_kn, *amplitude_kn, *frequency_hz, *phase_deg);
    sum(first, harmonics.iter().map(HarmonicForceKeys::sine))
}

fn torsion(keys: &TorsionKeys) -> TimeFunction {
    let TorsionKeys { mean_kn_m, amplitude_kn_m, frequency_hz, phase_deg, harmonics, .. } = keys;
    let first = sine(*mean_kn_m, *amplitude_kn_m, *frequency_hz, *phase_deg);
    sum(first, harmonics.iter().map(HarmonicMomentKeys::sine))
}

fn sum(first: HarmonicForce, further: impl Iterator<Item = HarmonicForce>) -> TimeFunction {
    TimeFunction { harmonics: [first].into_iter().chain(further).collect(), table: Vec::new() }
}

/// Reads the tables of the forces of a load case into them; what is wrong with one is left to the collector.
pub(super) fn take_tables(
    (name, keys, case): (&str, &ScenarioKeys, &mut StudyScenario),
    source: &Source,
    collector: &mut Collector<'_>,
) {
    let folder = source.path().parent().unwrap_or(Path::new(""));
    let here = format!("scenario.{name}");
    let steps = Steps {
        duration: keys.steps as f64 * keys.time_step_s,
        step: keys.time_step_s,
        count: format!("{here}.steps"),
        shorter: Shorter::TimeStep(format!("{here}.time_step_s")),
    };
    let of_torsion = keys.rail_torsion.as_ref().and_then(|torsion| torsion.table.as_ref());
    let StudyScenario { scenario, tables, .. } = case;
    let Scenario { vertical_force, lateral_force, rail_torsion, .. } = scenario;
    let forces: [(&str, Option<&TableKeys>, Option<&mut TimeFunction>); 3] = [
        ("vertical_force", keys.vertical_force.table.as_ref(), Some(vertical_force)),
        ("lateral_force", keys.lateral_force.table.as_ref(), Some(lateral_force)),
        ("rail_torsion", of_torsion, rail_torsion.as_mut()),
    ];
    for (force, keys, function) in forces {
        let (Some(keys), Some(function)) = (keys, function) else { continue };
        let key = format!("{here}.{force}.table");
        match Table::over_time(folder, &key, keys, &steps) {
            Ok(table) => {
                function.table =
                    table.rows.into_iter().map(|(time, value)| (time, KILONEWTON * value)).collect();
                tables.push(table.file);
            }
            Err(mistakes) => {
                let reads = [format!("{key}.*"), format!("{here}.steps"), format!("{here}.time_step_s")];
                let reads = reads.each_ref().map(String::as_str);
                mistakes.into_iter().for_each(|mistake| collector.add(&reads, mistake));
            }
        }
    }
}
