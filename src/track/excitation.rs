//! Forces, ground motion and irregularities of a study, and where its wheels are.

use std::f64::consts::PI;
use std::path::Path;

use railspring_profiles::error::InputError;
use railspring_profiles::units::{KILONEWTON, MILLIMETRE};
use railspring_simulate::time::function::{HarmonicForce, LEAST_STEPS_PER_PERIOD, TimeFunction};
use railspring_simulate::track::{Irregularity, RailTorsion, Spectrum, UnevenRail, Way};

use super::document::{
    ExcitationKeys, ForceKeys, GroundKeys, HarmonicAccelerationKeys, IrregularityKey, IrregularityKeys,
    ProbeSideKey, RunKeys, SideKey, UnevenKey,
};
use crate::study::document::{HarmonicForceKeys, HarmonicMomentKeys, Interpolation, TableKeys};
use crate::study::tables::{FileRecord, Over, Shorter, Steps, Table};

/// Samples that a period of the wheel on its contact must have at least.
const LEAST_SAMPLES: f64 = 4.0;

/// What excitation depends on besides its keys.
pub(super) struct Around<'a> {
    /// Folder of the study.
    pub folder: &'a Path,
    /// How long the run takes, s.
    pub duration: f64,
    /// Length of a step of the integration, s.
    pub step: f64,
    /// Number of wheels.
    pub wheels: usize,
    /// Whether the wheelset moves across the track.
    pub lateral: bool,
}

impl Around<'_> {
    fn steps(&self) -> Steps {
        let shorter = Shorter::InnerSteps("run.inner_steps".into());
        Steps { duration: self.duration, step: self.step, count: "run.steps".into(), shorter }
    }
}

/// Mistakes and files, as they are found.
#[derive(Default)]
pub(super) struct Found {
    pub mistakes: Vec<InputError>,
    pub files: Vec<FileRecord>,
    /// What has to be known about the files.
    pub notes: Vec<String>,
}

impl Found {
    pub fn took<T>(&mut self, part: Result<T, InputError>) -> Option<T> {
        part.map_err(|mistake| self.mistakes.push(mistake)).ok()
    }

    /// The rows of a table over the time of the run, if they are right.
    fn over_time(&mut self, around: &Around<'_>, key: &str, keys: &TableKeys) -> Vec<(f64, f64)> {
        match Table::over_time(around.folder, key, keys, &around.steps()) {
            Ok(table) => {
                self.files.push(table.file);
                table.rows
            }
            Err(mistakes) => {
                self.mistakes.extend(mistakes);
                Vec::new()
            }
        }
    }
}

/// A value over time of the key `key`, its table in units of `unit`.
fn function(
    around: &Around<'_>,
    found: &mut Found,
    key: &str,
    mean: f64,
    sines: impl Iterator<Item = HarmonicForce>,
    table: (Option<&TableKeys>, f64),
) -> TimeFunction {
    let mut harmonics: Vec<HarmonicForce> = sines.collect();
    if mean != 0.0 {
        harmonics.push(HarmonicForce::constant(mean));
    }
    let (keys, unit) = table;
    let rows = keys.map(|keys| found.over_time(around, &format!("{key}.table"), keys)).unwrap_or_default();
    let function =
        TimeFunction { harmonics, table: rows.into_iter().map(|(t, value)| (t, unit * value)).collect() };
    if let Some(frequency) = function.unresolved(around.step) {
        let longest = 1.0 / (LEAST_STEPS_PER_PERIOD * frequency);
        found.mistakes.push(InputError::new(
            format!("{key}.harmonics"),
            format!("{frequency} Hz at steps of {} s", around.step),
            format!("a period of at least {LEAST_STEPS_PER_PERIOD} steps of the integration"),
            format!(
                "raise `run.inner_steps`, so that they are {longest:.3e} s or shorter, or lower the frequency"
            ),
        ));
    }
    function
}

/// What is there only with `[lateral]`: force to the right (N), acceleration of the ground to the right (m/s²), moments on the rails (N·m).
pub(super) struct LateralFunctions {
    pub force: TimeFunction,
    pub ground: TimeFunction,
    pub torsion: Vec<RailTorsion>,
}

/// What acts across the track on a rail of `length` (m).
pub(super) fn lateral_functions(
    keys: &ExcitationKeys,
    around: &Around<'_>,
    length: f64,
    found: &mut Found,
) -> LateralFunctions {
    let given = [
        ("lateral_force", keys.lateral_force.is_some()),
        ("lateral_ground_acceleration", keys.lateral_ground_acceleration.is_some()),
        ("rail_torsion", !keys.rail_torsion.is_empty()),
    ];
    for (key, _) in given.iter().filter(|(_, given)| *given && !around.lateral) {
        found.mistakes.push(InputError::new(
            format!("excitation.{key}"),
            "given",
            "a wheelset across the track, with a section `[lateral]`",
            "leave it out, or add `[lateral]`",
        ));
    }
    let force = keys.lateral_force.as_ref().map(|force| forced(force, "lateral_force", around, found));
    let ground = keys
        .lateral_ground_acceleration
        .as_ref()
        .map(|ground| shaken(ground, "lateral_ground_acceleration", around, found));
    let mut torsion = Vec::new();
    for (index, keys) in keys.rail_torsion.iter().enumerate() {
        let key = format!("excitation.rail_torsion[{index}]");
        if !(0.0..=length).contains(&keys.at_m) || length.is_infinite() {
            let expected = match length.is_finite() {
                true => format!("a place on the rail, 0 to {length} m"),
                false => "a rail that moves".into(),
            };
            let remedy = "correct the place, or the length of the rail";
            found.mistakes.push(InputError::new(format!("{key}.at_m"), keys.at_m, expected, remedy));
        }
        let sines = keys.harmonics.iter().map(HarmonicMomentKeys::sine);
        let table = (keys.table.as_ref(), KILONEWTON);
        let moment = function(around, found, &key, keys.mean_kn_m * KILONEWTON, sines, table);
        let rail = usize::from(keys.side == ProbeSideKey::Left);
        torsion.push(RailTorsion { rail, x: keys.at_m, moment });
    }
    LateralFunctions { force: force.unwrap_or_default(), ground: ground.unwrap_or_default(), torsion }
}

fn forced(force: &ForceKeys, key: &str, around: &Around<'_>, found: &mut Found) -> TimeFunction {
    let sines = force.harmonics.iter().map(HarmonicForceKeys::sine);
    let table = (force.table.as_ref(), KILONEWTON);
    function(around, found, &format!("excitation.{key}"), force.mean_kn * KILONEWTON, sines, table)
}

fn shaken(ground: &GroundKeys, key: &str, around: &Around<'_>, found: &mut Found) -> TimeFunction {
    let sines = ground.harmonics.iter().map(HarmonicAccelerationKeys::sine);
    function(around, found, &format!("excitation.{key}"), 0.0, sines, (ground.table.as_ref(), 1.0))
}

/// Vertical force (N), roll moment (N·m) and acceleration of the ground (m/s²).
pub(super) fn functions(keys: &ExcitationKeys, around: &Around<'_>, found: &mut Found) -> [TimeFunction; 3] {
    let force = keys.vertical_force.as_ref().map(|force| forced(force, "vertical_force", around, found));
    let moment = keys.roll_moment.as_ref().map(|moment| {
        let sines = moment.harmonics.iter().map(HarmonicMomentKeys::sine);
        let mean = moment.mean_kn_m * KILONEWTON;
        let table = (moment.table.as_ref(), KILONEWTON);
        function(around, found, "excitation.roll_moment", mean, sines, table)
    });
    if moment.is_some() && around.wheels == 1 {
        found.mistakes.push(InputError::new(
            "excitation.roll_moment",
            "given",
            "a wheelset (`wheel.kind = \"wheelset\"`), which can roll",
            "leave it out, or take a wheelset",
        ));
    }
    let ground =
        keys.ground_acceleration.as_ref().map(|ground| shaken(ground, "ground_acceleration", around, found));
    [force, moment, ground].map(Option::unwrap_or_default)
}

/// Where the wheels are.
pub(super) fn way(keys: &RunKeys, around: &Around<'_>, found: &mut Found) -> Way {
    let Some(table) = &keys.speed_table else {
        let (speed, gained) = (keys.speed_m_per_s, keys.acceleration_m_per_s2);
        if speed + gained * around.duration < 0.0 {
            found.mistakes.push(InputError::new(
                "run.acceleration_m_per_s2",
                gained,
                format!("a wheel that does not roll back: it stands after {} s", speed / -gained),
                "end the run there (`run.steps`), or give `run.speed_table`",
            ));
        }
        return Way::uniform(keys.start_x_m, speed, gained, around.duration);
    };
    let beside =
        [("speed_m_per_s", keys.speed_m_per_s), ("acceleration_m_per_s2", keys.acceleration_m_per_s2)];
    if let Some((name, value)) = beside.iter().find(|(_, value)| *value != 0.0) {
        found.mistakes.push(InputError::new(
            format!("run.{name}"),
            value,
            "no speed beside `run.speed_table`",
            "leave one of them out",
        ));
    }
    let mut rows = found.over_time(around, "run.speed_table", table);
    // the run begins at t = 0, wherever the table does
    let at_start = TimeFunction { harmonics: Vec::new(), table: rows.clone() }.at(0.0);
    rows.retain(|(time, _)| *time > 0.0);
    rows.insert(0, (0.0, at_start));
    Way::new(keys.start_x_m, &rows)
}

/// The places between which the wheels are in the run, m, on a rail of `length`.
fn reached(way: &Way, around: &Around<'_>, length: f64) -> [f64; 2] {
    let places = (0..=1000).map(|i| way.x(around.duration * f64::from(i) / 1000.0).clamp(0.0, length));
    places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

/// All that is uneven under each wheel: heights, and places towards the field side. `length` (m) is that of the rail, `own` the frequency (Hz) of a wheel on its contact, if it has one.
pub(super) fn unevenness(
    keys: &[IrregularityKeys],
    around: &Around<'_>,
    way: &Way,
    (length, own): (f64, Option<f64>),
    found: &mut Found,
) -> Vec<UnevenRail> {
    let mut all = vec![UnevenRail::default(); around.wheels];
    for (index, one) in keys.iter().enumerate() {
        let key = format!("excitation.irregularity[{index}]");
        if let Some(mistake) = foreign(one, &key) {
            found.mistakes.push(mistake);
            continue;
        }
        if one.side == SideKey::Left && around.wheels == 1 {
            let expected = "the right wheel, which a single one is";
            found.mistakes.push(InputError::new(format!("{key}.side"), "\"left\"", expected, "leave it out"));
            continue;
        }
        let lateral = one.direction == UnevenKey::Lateral;
        let sampled = [IrregularityKey::Table, IrregularityKey::Spectrum].contains(&one.kind);
        if lateral && !(around.lateral && sampled) {
            let expected = match around.lateral {
                true => "a `table` or a `spectrum`, which can be lateral",
                false => "a wheelset across the track, with a section `[lateral]`",
            };
            let remedy = "leave it out, or take another kind of irregularity or study";
            found.mistakes.push(InputError::new(format!("{key}.direction"), "\"lateral\"", expected, remedy));
            continue;
        }
        let made = irregularity(one, &key, around, way, (length, own), found);
        let Some(made) = made else { continue };
        for (side, unevenness) in all.iter_mut().enumerate() {
            let here = match one.side {
                SideKey::Both => true,
                SideKey::Right => side == 0,
                SideKey::Left => side == 1,
            };
            if here && lateral {
                // the field side of the left rail is on the left
                unevenness.lateral.push(if side == 0 { made.clone() } else { made.clone().negated() });
            } else if here {
                let unevenness = &mut unevenness.vertical;
                let of = if one.kind == IrregularityKey::WheelFlat {
                    &mut unevenness.wheel
                } else {
                    &mut unevenness.rail
                };
                of.push(made.clone());
            }
        }
    }
    all
}

/// The keys of each kind: those that it needs, and those that it may have.
fn keys_of(kind: IrregularityKey) -> (&'static str, [&'static [&'static str]; 2]) {
    match kind {
        IrregularityKey::Table => ("table", [&["table"], &[]]),
        IrregularityKey::Spectrum => (
            "spectrum",
            [
                &["amplitude_m2_rad_per_m", "cutoff_rad_per_m", "waves_m"],
                &["rolloff_rad_per_m", "components", "seed"],
            ],
        ),
        IrregularityKey::DippedJoint => ("dipped-joint", [&["at_m", "depth_mm", "length_mm"], &[]]),
        IrregularityKey::WheelFlat => ("wheel-flat", [&["at_m", "depth_mm", "length_mm", "diameter_m"], &[]]),
    }
}

/// A key that the kind does not have, or lacks.
fn foreign(keys: &IrregularityKeys, key: &str) -> Option<InputError> {
    let given = [
        ("table", keys.table.is_some()),
        ("amplitude_m2_rad_per_m", keys.amplitude_m2_rad_per_m.is_some()),
        ("cutoff_rad_per_m", keys.cutoff_rad_per_m.is_some()),
        ("rolloff_rad_per_m", keys.rolloff_rad_per_m.is_some()),
        ("waves_m", keys.waves_m.is_some()),
        ("components", keys.components.is_some()),
        ("seed", keys.seed.is_some()),
        ("at_m", keys.at_m.is_some()),
        ("depth_mm", keys.depth_mm.is_some()),
        ("length_mm", keys.length_mm.is_some()),
        ("diameter_m", keys.diameter_m.is_some()),
    ];
    let (name, [needed, optional]) = keys_of(keys.kind);
    let listed = needed.iter().chain(optional).copied().collect::<Vec<_>>().join(", ");
    given.iter().find_map(|(leaf, given)| {
        let (needs, has) = (needed.contains(leaf), needed.contains(leaf) || optional.contains(leaf));
        let (value, remedy) = match (given, needs, has) {
            (true, _, false) => ("given", "leave it out, or take another kind"),
            (false, true, _) => ("(missing)", "add this key"),
            _ => return None,
        };
        Some(InputError::new(
            format!("{key}.{leaf}"),
            value,
            format!("the keys of kind = {name:?}: {listed}"),
            remedy,
        ))
    })
}

fn irregularity(
    keys: &IrregularityKeys,
    key: &str,
    around: &Around<'_>,
    way: &Way,
    (length, own): (f64, Option<f64>),
    found: &mut Found,
) -> Option<Irregularity> {
    let per_step = way.fastest() * around.step;
    // a wave that steps do not resolve, as a force that they do not
    let resolved = |found: &mut Found, leaf: &str, wave: f64, unit: (f64, &str)| {
        let shortest = LEAST_STEPS_PER_PERIOD * per_step;
        if wave < shortest * (1.0 - 1e-9) {
            found.mistakes.push(InputError::new(
                format!("{key}.{leaf}"),
                format!("{} {}", wave / unit.0, unit.1),
                format!(
                    "at least {LEAST_STEPS_PER_PERIOD} steps of the integration long, {:.4} {} at {} m/s",
                    shortest / unit.0,
                    unit.1,
                    way.fastest()
                ),
                format!("set `run.inner_steps` {:.0} times as high", (shortest / wave).ceil()),
            ));
        }
    };
    match keys.kind {
        IrregularityKey::Table => {
            let key = format!("{key}.table");
            let table = found.took(Table::read(around.folder, &key, keys.table.as_ref()?, Over::Place))?;
            let within = reached(way, around, length);
            let checks = [
                table.check_covers(within, "run.steps"),
                table.check_steps(per_step, &around.steps().shorter),
                sampled_for(&table, &key, way.fastest(), own),
            ];
            found.mistakes.extend(checks.into_iter().filter_map(Result::err));
            found.files.push(table.file);
            let rows: Vec<(f64, f64)> =
                table.rows.iter().map(|(x, height)| (*x, height * MILLIMETRE)).collect();
            Some(match keys.table.as_ref()?.between {
                Interpolation::Corners => Irregularity::Corners(rows),
                Interpolation::Samples => Irregularity::through(&rows),
            })
        }
        IrregularityKey::Spectrum => {
            let waves = keys.waves_m?;
            if waves[0] >= waves[1] {
                found.mistakes.push(InputError::new(
                    format!("{key}.waves_m"),
                    format!("{}, {}", waves[0], waves[1]),
                    "the shortest wave before the longest",
                    "exchange them",
                ));
                return None;
            }
            resolved(found, "waves_m", waves[0], (1.0, "m"));
            let spectrum = Spectrum {
                amplitude: keys.amplitude_m2_rad_per_m?,
                cutoff: keys.cutoff_rad_per_m?,
                rolloff: keys.rolloff_rad_per_m.unwrap_or(0.0),
                waves,
                components: keys.components.unwrap_or(1000),
                seed: keys.seed.unwrap_or(0),
            };
            Some(spectrum.waves())
        }
        IrregularityKey::DippedJoint => {
            let length = keys.length_mm? * MILLIMETRE;
            resolved(found, "length_mm", length, (MILLIMETRE, "mm"));
            Some(Irregularity::Dip {
                at: keys.at_m?,
                depth: keys.depth_mm? * MILLIMETRE,
                half_length: 0.5 * length,
            })
        }
        IrregularityKey::WheelFlat => {
            let length = keys.length_mm? * MILLIMETRE;
            let circumference = PI * keys.diameter_m?;
            resolved(found, "length_mm", length, (MILLIMETRE, "mm"));
            if length >= circumference {
                let expected =
                    format!("shorter than the circumference of {:.1} mm", circumference / MILLIMETRE);
                let key = format!("{key}.length_mm");
                found.mistakes.push(InputError::new(
                    key,
                    length / MILLIMETRE,
                    expected,
                    "correct the length",
                ));
            }
            Some(Irregularity::Flat {
                circumference,
                first: keys.at_m?,
                length,
                depth: keys.depth_mm? * MILLIMETRE,
            })
        }
    }
}

/// That samples are close enough for a wheel with the frequency `own` on its contact: between fewer the spline says what the wheel feels.
fn sampled_for(table: &Table, key: &str, speed: f64, own: Option<f64>) -> Result<(), InputError> {
    let Some(own) = own.filter(|_| table.is_sampled()) else { return Ok(()) };
    let widest = speed / (LEAST_SAMPLES * own);
    if speed == 0.0 || table.spacing <= widest * (1.0 + 1e-9) {
        return Ok(());
    }
    Err(InputError::new(
        format!("{key}.file"),
        format!("{}: samples {} m apart", table.file.file, table.spacing),
        format!(
            "at least {LEAST_SAMPLES} samples in a period of the wheel on its contact, {own:.0} Hz: {widest:.4} m apart at {speed} m/s"
        ),
        format!("sample closer, or set `{key}.between = \"corners\"` for straight lines between the rows"),
    ))
}
