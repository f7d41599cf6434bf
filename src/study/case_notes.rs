//! What has to be known of a load case before it runs: values of the publication in the place of keys that are not given, the end of the
//! rail, and loads beyond those of the calibration.

use railspring_profiles::units::KILONEWTON;
use railspring_simulate::time::scenario::Scenario;

use super::document::{LawKey, ScenarioKeys, StudyDocument, SuspensionKeys};
use super::source::Source;
use crate::rounding::significant;

/// What is said of the load case `name`; `loads` are those of the calibration, N.
pub(super) fn notes(
    (name, keys, scenario): (&str, &ScenarioKeys, &Scenario),
    document: &StudyDocument,
    source: &Source,
    loads: &[f64],
) -> Vec<String> {
    let key = |leaf: &str| format!("scenario.{name}.{leaf}");
    let published = published_suspension(&key, keys, source);
    let end = rail_end(&key, scenario, document.rail.length_m);
    let beyond = (document.simulation.law != LawKey::Published)
        .then(|| beyond_the_loads(&key, (keys, scenario), source, loads.last().copied()?))
        .flatten();
    published.into_iter().chain(end).chain(beyond).collect()
}

/// Says which parts of the suspension are the publication's, because the study gives none.
fn published_suspension(
    key: &dyn Fn(&str) -> String,
    keys: &ScenarioKeys,
    source: &Source,
) -> Option<String> {
    let missing = |leaf: &str| !source.gives(&key(leaf));
    let of = |leaf: &str, keys: &SuspensionKeys| {
        let (stiffness, damping) = (keys.stiffness_kn_per_m, keys.damping_kn_s_per_m);
        missing(leaf).then(|| format!("`{}` is {stiffness} kN/m and {damping} kN\u{b7}s/m", key(leaf)))
    };
    let mass = missing("suspended_mass_t")
        .then(|| format!("`{}` is {} t", key("suspended_mass_t"), keys.suspended_mass_t));
    // without a mass the spring and the damper transmit the force unchanged
    let vertical =
        of("vertical_suspension", &keys.vertical_suspension).filter(|_| keys.suspended_mass_t > 0.0);
    let lateral = of("lateral_suspension", &keys.lateral_suspension);
    let parts: Vec<String> = [mass, vertical, lateral].into_iter().flatten().collect();
    (!parts.is_empty()).then(|| {
        format!(
            "{}: not given, and taken from the publication (Ju, 2016); give the values of your vehicle, or `{} = 0` for a force on the wheel itself",
            parts.join(", "),
            key("suspended_mass_t")
        )
    })
}

/// Says when a wheel comes to the end of a rail of a `length` (m), if it does.
fn rail_end(key: &dyn Fn(&str) -> String, scenario: &Scenario, length: f64) -> Option<String> {
    let start = scenario.start_x.unwrap_or(0.5 * length);
    let duration = scenario.steps as f64 * scenario.time_step;
    let last = start + scenario.speed * duration;
    (scenario.speed > 0.0 && last > length * (1.0 + 1e-9)).then(|| {
        format!(
            "at {} of {} s the wheel is at the end of the rail (x = {length} m), and the run of the simple model ends; \
             to run on it needs `rail.length_m` = {} or more, or fewer `{}`, a lower `{}` or a smaller `{}`",
            significant((length - start) / scenario.speed, 4),
            significant(duration, 4),
            (last * 1e3).ceil() / 1e3,
            key("steps"),
            key("speed_m_per_s"),
            key("start_x_m")
        )
    })
}

/// Says that the forces are beyond the `largest` load of the calibration (N), if they are by themselves.
fn beyond_the_loads(
    key: &dyn Fn(&str) -> String,
    (keys, scenario): (&ScenarioKeys, &Scenario),
    source: &Source,
    largest: f64,
) -> Option<String> {
    /// Most that a study can calibrate, N.
    const MOST: f64 = 1e6;
    let weight = (scenario.suspended_mass + scenario.wheel_mass.unwrap_or(0.0)) * scenario.gravity;
    // a force that lifts the wheel loads no spring
    let down = (scenario.vertical_force.bounds()[1] + weight).max(0.0);
    let aside = scenario.lateral_force.largest();
    let load = down.hypot(aside);
    if load <= largest {
        return None;
    }
    let force = match aside > down {
        true => "lateral_force",
        false => "vertical_force",
    };
    let loads = match source.gives("calibration.loads_kn") {
        true => "calibration.loads_kn",
        false => "calibration.load_max_kn",
    };
    let remedy = match load <= MOST {
        true => format!("calibrate up to it (`{loads}`), or lower the force"),
        false => format!("lower the force (`{loads}` goes up to {} at most)", MOST / KILONEWTON),
    };
    let solid = match keys.solid {
        true => format!(
            "; the solid model takes long for so large a patch, and `{} = false` leaves it out",
            key("solid")
        ),
        false => String::new(),
    };
    Some(format!(
        "`{}`: forces and weights are {} kN together at most, and the springs are calibrated up to {} kN: {remedy}{solid}",
        key(force),
        significant(load / KILONEWTON, 4),
        significant(largest / KILONEWTON, 4)
    ))
}
