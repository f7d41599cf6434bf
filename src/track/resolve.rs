//! From the keys of a track study to a load case in SI units.

use std::path::{Path, PathBuf};

use railspring_calibrate::law::{NormalLaw, StiffnessLaw};
use railspring_profiles::error::{Error, InputError};
use railspring_profiles::units::{KILONEWTON, KILONEWTON_PER_METRE, MILLIMETRE, TONNE};
use railspring_simulate::time::function::LEAST_STEPS_PER_PERIOD;
use railspring_simulate::time::scenario::Kelvin;
use railspring_simulate::track::{Carrier, Probe, Running, SprungWheel, Start, TrackCase, Wheels, Wheelset};
use serde_json::Value;
use toml::de::DeTable;

use super::beams::{kelvin, track};
use super::document::{
    ContactKeys, LawKey, OnKey, ProbeKeys, ProbeSideKey, RunKeys, RunningKey, StartKey, TrackDocument,
    WheelKeys,
};
use super::excitation::{Around, Found, functions, lateral_functions, unevenness, way};
use super::lateral;
use super::outcome::LoadCase;
use crate::engine::inputs::Inputs;
use crate::engine::output::read_json;
use crate::engine::seal::Sealed;
use crate::hash::hash;
use crate::results::springs::record::StiffnessRecord;
use crate::study::tables::FileRecord;
use crate::study::{LocatedError, Mistakes, Setting, Source, parsed, schema_of, text_of};

/// What messages call such a study.
const WHOLE: &str = "track study";

type Result<T> = std::result::Result<T, InputError>;

/// A checked track study.
#[derive(Debug, Clone)]
pub struct TrackStudy {
    /// Its keys.
    pub document: TrackDocument,
    /// The load case.
    pub case: LoadCase,
    /// The files that it reads.
    pub files: Vec<FileRecord>,
    /// What has to be known about the profiles in them.
    pub notes: Vec<String>,
    /// The law of a calibration, if it has one.
    pub law: Option<FittedLaw>,
    /// Where its keys stand.
    pub source: Source,
}

/// A law of a calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedLaw {
    /// Its file as the study names it.
    pub file: String,
    /// Smallest and largest force that it was fitted to, kN.
    pub range_kn: [f64; 2],
}

/// Whether a file is a track study, or wants to be one: it says its `kind`. A file that cannot be read is none.
pub fn is_track(path: &Path, settings: &[Setting]) -> bool {
    let Ok(text) = text_of(path, WHOLE) else { return false };
    let (table, _) = DeTable::parse_recoverable(&text);
    table.get_ref().contains_key("kind") || settings.iter().any(|setting| setting.key() == "kind")
}

impl TrackStudy {
    /// Reads and checks a study, with `settings` in the place of its keys.
    ///
    /// # Errors
    /// [`Mistakes`], each with its key and line.
    pub fn read(path: &Path, settings: &[Setting]) -> std::result::Result<Self, Mistakes> {
        Self::parse(path, &text_of(path, WHOLE)?, settings)
    }

    /// Checks the text of a study; files lie relative to `path`.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(path: &Path, text: &str, settings: &[Setting]) -> std::result::Result<Self, Mistakes> {
        let parsed = parsed::<TrackDocument>(path, text, settings, WHOLE, &schema_of::<TrackDocument>())?;
        if !parsed.mistakes.is_empty() {
            return Err(Mistakes::sorted(parsed.mistakes));
        }
        let (document, source) = (parsed.document, parsed.source);
        let folder = path.parent().map_or_else(PathBuf::new, Path::to_path_buf);
        let mut found = Found::default();
        let made = case(&document, &folder, &mut found);
        let Found { mistakes, files, notes } = found;
        match made {
            Some((case, law)) if mistakes.is_empty() => {
                Ok(Self { document, case, files, notes, law, source })
            }
            _ => {
                let located: Vec<LocatedError> =
                    mistakes.into_iter().map(|mistake| source.locate(mistake)).collect();
                Err(Mistakes::sorted(located))
            }
        }
    }

    /// The files that it reads, itself among them.
    pub fn inputs(&self) -> Inputs {
        let folder = self.source.path().parent().unwrap_or(Path::new(""));
        let files = self.files.iter().map(|file| folder.join(&file.file));
        Inputs::of(files.chain([self.source.path().to_path_buf()]))
    }

    /// Its keys with their values.
    pub fn keys(&self) -> Value {
        serde_json::to_value(&self.document).expect("a study is plain data")
    }

    /// An error of the run, with the key and line of the study if it concerns one.
    pub fn located(&self, error: Error) -> std::result::Result<LocatedError, Error> {
        match error {
            Error::Input(input) if input.key == "start" => {
                Ok(self.source.locate(InputError { key: "run.start".into(), ..input }))
            }
            other => Err(other),
        }
    }
}

fn case(document: &TrackDocument, folder: &Path, found: &mut Found) -> Option<(LoadCase, Option<FittedLaw>)> {
    found.took(check_name(&document.name));
    let track = track(document).map_err(|mistakes| found.mistakes.extend(mistakes)).ok();
    let running = found.took(running(&document.wheel));
    let law = found.took(law(&document.contact, folder));
    let run = &document.run;
    let start = found.took(start(run));
    let wheels = if document.wheel.kind == RunningKey::Wheelset { 2 } else { 1 };
    let lateral = document.lateral.as_ref();
    let around = Around {
        folder,
        duration: run.steps as f64 * run.time_step_s,
        step: run.time_step_s / run.inner_steps as f64,
        wheels,
        lateral: lateral.is_some(),
    };
    let [force, roll, ground] = functions(&document.excitation, &around, found);
    let way = way(run, &around, found);
    // all of a wheelset across the track is mirrored at once, in the end
    let mirrored = document.wheel.mirrored && lateral.is_none();
    let roll = if mirrored { roll.scaled(-1.0) } else { roll };
    let rail_length = document.rail.length_m.filter(|_| !document.rail.rigid).unwrap_or(f64::INFINITY);
    let sideways = lateral_functions(&document.excitation, &around, rail_length, found);
    let parts = lateral.and_then(|keys| {
        let parts = lateral::parts(document, keys, folder, found);
        found.took(parts)
    });
    if let (None, Some(velocity)) = (lateral, run.lateral_velocity_m_per_s) {
        found.mistakes.push(InputError::new(
            "run.lateral_velocity_m_per_s",
            velocity,
            "a wheelset across the track, with a section `[lateral]`",
            "leave it out, or add `[lateral]`",
        ));
    }
    let mut probes: Vec<Probe> = document
        .probe
        .iter()
        .enumerate()
        .filter_map(|(index, keys)| found.took(probe(index, keys, document, wheels)))
        .collect();
    let (track, running, (law, files, fitted), start) = (track?, running?, law?, start?);
    found.files.extend(files);
    let length = track.as_ref().map_or(f64::INFINITY, |track| track.length);
    if !(0.0..=length).contains(&run.start_x_m) {
        found.mistakes.push(InputError::new(
            "run.start_x_m",
            run.start_x_m,
            format!("a place on the rail, 0 to {length} m"),
            "start elsewhere, or lengthen the rail",
        ));
    }
    // what a wheel carries at rest
    let at_start = force.at(0.0) + running.mass() * run.gravity_m_per_s2;
    let own = own_frequency(&running, &law, at_start / wheels as f64);
    found.took(check_step(own, &around));
    let mut uneven = unevenness(&document.excitation.irregularity, &around, &way, (length, own), found);
    let lateral_uneven = uneven.clone();
    if mirrored {
        uneven.reverse();
        probes.iter_mut().for_each(|probe| probe.rail = wheels - 1 - probe.rail);
    }
    let uneven = uneven.into_iter().map(|uneven| uneven.vertical).collect();
    let damping = document.contact.damping_kn_s_per_m * KILONEWTON;
    let case = TrackCase {
        track,
        running,
        wheels: Wheels { law, damping, unevenness: uneven },
        steps: run.steps,
        time_step: run.time_step_s,
        inner_steps: run.inner_steps,
        gravity: run.gravity_m_per_s2,
        force,
        roll,
        ground,
        way,
        start,
        probes,
    };
    if lateral.is_none() {
        return Some((LoadCase::InPlane(Box::new(case)), fitted));
    }
    let across = parts?.across(case, sideways, lateral_uneven, document);
    Some((LoadCase::Across(Box::new(across)), fitted))
}

fn check_name(name: &str) -> Result<()> {
    let plain = name.chars().all(|c| c.is_alphanumeric() || "-_.".contains(c));
    if plain && !name.starts_with('.') {
        return Ok(());
    }
    Err(InputError::new(
        "name",
        format!("{name:?}"),
        "letters, digits, `-`, `_` and `.`, not starting with `.`",
        "the name becomes the name of the output folder; take a plain one",
    ))
}

/// What runs.
fn running(keys: &WheelKeys) -> Result<Running> {
    let missing = |leaf: &str, of: &str| {
        InputError::new(format!("wheel.{leaf}"), "(missing)", format!("a value for {of}"), "add this key")
    };
    let refused = |leaf: &str, of: &str| {
        let expected = format!("no such key for {of}");
        InputError::new(
            format!("wheel.{leaf}"),
            "given",
            expected,
            "leave it out, or take another `wheel.kind`",
        )
    };
    let above = keys.suspended_mass_t * TONNE;
    let suspension = match (&keys.suspension, above > 0.0) {
        (Some(keys), true) => kelvin(keys.stiffness_kn_per_m, keys.damping_kn_s_per_m),
        (None, true) => return Err(missing("suspension", "a suspended mass")),
        (Some(_), false) => {
            return Err(refused("suspension", "a wheel without a suspended mass (`wheel.suspended_mass_t`)"));
        }
        (None, false) => Kelvin { stiffness: 0.0, damping: 0.0 },
    };
    if above > 0.0 && suspension.stiffness + suspension.damping == 0.0 {
        return Err(InputError::new(
            "wheel.suspension.stiffness_kn_per_m",
            0,
            "a spring or a damper that carries the suspended mass",
            "give the suspension a stiffness",
        ));
    }
    let of_wheelset = [
        ("roll_inertia_t_m2", keys.roll_inertia_t_m2),
        ("suspended_roll_inertia_t_m2", keys.suspended_roll_inertia_t_m2),
    ];
    if keys.kind != RunningKey::Wheelset
        && let Some((leaf, _)) = of_wheelset.iter().find(|(_, value)| value.is_some())
    {
        return Err(refused(leaf, "a single wheel"));
    }
    let mass =
        || keys.mass_t.map(|mass| mass * TONNE).ok_or_else(|| missing("mass_t", "the mass of the wheel"));
    match keys.kind {
        RunningKey::Force => match (keys.mass_t, above > 0.0) {
            (None, false) => Ok(Running::Force),
            (Some(_), _) => Err(refused("mass_t", "a force without a mass")),
            (None, true) => Err(refused("suspended_mass_t", "a force without a mass")),
        },
        RunningKey::Wheel => Ok(Running::Wheel(SprungWheel { mass: mass()?, above, suspension })),
        RunningKey::Wheelset => {
            let [inertia, above_inertia] = of_wheelset.map(|(_, value)| value.map(|value| value * TONNE));
            let above_inertia = match (above > 0.0, above_inertia) {
                (true, None) => return Err(missing("suspended_roll_inertia_t_m2", "the suspended mass")),
                (false, Some(_)) => {
                    return Err(refused(
                        "suspended_roll_inertia_t_m2",
                        "a wheelset without a suspended mass",
                    ));
                }
                (_, inertia) => inertia.unwrap_or(0.0),
            };
            Ok(Running::Wheelset(Wheelset {
                mass: mass()?,
                inertia: inertia.ok_or_else(|| missing("roll_inertia_t_m2", "the roll of the wheelset"))?,
                above,
                above_inertia,
                suspension,
                half_track: 0.5 * keys.contact_distance_m,
                half_base: 0.5 * keys.suspension_distance_m,
            }))
        }
    }
}

/// The law with the files that it is from, and what it was fitted to.
fn law(keys: &ContactKeys, folder: &Path) -> Result<(NormalLaw, Vec<FileRecord>, Option<FittedLaw>)> {
    let given = [
        ("stiffness_kn_per_m", keys.stiffness_kn_per_m.is_some(), LawKey::Linear),
        ("hertz_gn_per_m15", keys.hertz_gn_per_m15.is_some(), LawKey::Hertz),
        ("a_kn_per_m", keys.a_kn_per_m.is_some(), LawKey::Power),
        ("b_kn_per_m", keys.b_kn_per_m.is_some(), LawKey::Power),
        ("c", keys.c.is_some(), LawKey::Power),
        ("law_file", keys.law_file.is_some(), LawKey::File),
    ];
    for (leaf, given, of) in given {
        if given != (of == keys.law) {
            let (value, remedy) = match given {
                true => ("given", "leave it out, or take its `contact.law`"),
                false => ("(missing)", "add this key, or take another `contact.law`"),
            };
            let name = serde_json::to_value(of).unwrap_or_default();
            let expected = format!("a key of contact.law = {name} alone, which needs it");
            return Err(InputError::new(format!("contact.{leaf}"), value, expected, remedy));
        }
    }
    let plain = |law: Option<StiffnessLaw>| {
        let law = law.unwrap_or(StiffnessLaw::published());
        // constants within their ranges can still be no law: both zero
        StiffnessLaw::new(law.a, law.b, law.c).map_err(|_| {
            let (a, b) = (law.a / KILONEWTON_PER_METRE, law.b / KILONEWTON_PER_METRE);
            let expected = "constants of a law, not both zero";
            InputError::new(
                "contact.a_kn_per_m",
                format!("a = {a}, b = {b}"),
                expected,
                "correct the constants",
            )
        })
    };
    let law =
        match keys.law {
            LawKey::Published => Some(StiffnessLaw::published()),
            LawKey::Linear => {
                keys.stiffness_kn_per_m.map(|k| StiffnessLaw { a: k * KILONEWTON_PER_METRE, b: 0.0, c: 0.0 })
            }
            // F = C·δ^1.5 has the tangent 1.5·C^(2/3)·F^(1/3), with F in kN in the law
            LawKey::Hertz => keys.hertz_gn_per_m15.map(|c| StiffnessLaw {
                a: 0.0,
                b: 1.5 * (c * 1e9).powf(2.0 / 3.0) * KILONEWTON.cbrt(),
                c: 1.0 / 3.0,
            }),
            LawKey::Power => keys.a_kn_per_m.zip(keys.b_kn_per_m).zip(keys.c).map(|((a, b), c)| {
                StiffnessLaw { a: a * KILONEWTON_PER_METRE, b: b * KILONEWTON_PER_METRE, c }
            }),
            LawKey::File => {
                let name = keys.law_file.as_deref().unwrap_or_default();
                return of_file(name, &folder.join(name));
            }
        };
    Ok((plain(law)?.into(), Vec::new(), None))
}

/// The law of a calibration.
fn of_file(name: &str, path: &Path) -> Result<(NormalLaw, Vec<FileRecord>, Option<FittedLaw>)> {
    const KEY: &str = "contact.law_file";
    let refused =
        |expected: String, remedy: &str| InputError::new(KEY, format!("{name:?}"), expected, remedy);
    let record: StiffnessRecord = read_json(path, "calibrate").map_err(|error| {
        let expected = format!("a stiffness.json of `railspring calibrate` or `fit`: {error}");
        refused(expected, "give its path relative to the study")
    })?;
    if !record.is_as_written() {
        let expected = "a calibration as it was written; its numbers were edited since";
        return Err(refused(
            expected.into(),
            "calibrate again, or give the constants with contact.law = \"power\"",
        ));
    }
    if record.reference != "beam" {
        let expected = format!("a law against the rail's beam, not against {:?}", record.reference);
        return Err(refused(expected, "calibrate with `calibration.reference = \"beam\"`"));
    }
    let law = StiffnessLaw::try_from(record.law.constants)
        .map_err(|error| refused(format!("constants of a law: {error}"), "calibrate again"))?;
    let bytes = std::fs::read(path).unwrap_or_default();
    let file = FileRecord { key: KEY.into(), file: name.into(), blake3: hash(&bytes) };
    Ok((law.into(), vec![file], Some(FittedLaw { file: name.into(), range_kn: record.law.range_kn })))
}

fn start(keys: &RunKeys) -> Result<Start> {
    let of_above = [
        ("height_mm", keys.height_mm),
        ("velocity_m_per_s", keys.velocity_m_per_s),
        ("lateral_velocity_m_per_s", keys.lateral_velocity_m_per_s),
    ];
    match keys.start {
        StartKey::Above => Ok(Start::Above {
            height: keys.height_mm.unwrap_or(0.0) * MILLIMETRE,
            velocity: keys.velocity_m_per_s.unwrap_or(0.0),
        }),
        StartKey::Equilibrium => match of_above.iter().find_map(|(leaf, value)| Some((leaf, (*value)?))) {
            None => Ok(Start::Equilibrium),
            Some((leaf, value)) => Err(InputError::new(
                format!("run.{leaf}"),
                value,
                "no such key for a start in equilibrium",
                "leave it out, or set `run.start = \"above\"`",
            )),
        },
    }
}

/// The frequency of a wheel on its contact, Hz, under the force (N) that it carries at rest; none where it has none.
fn own_frequency(running: &Running, law: &NormalLaw, carried: f64) -> Option<f64> {
    let mass = match running {
        Running::Force => return None,
        Running::Wheel(wheel) => wheel.mass,
        Running::Wheelset(set) => 0.5 * set.mass,
    };
    let stiffness = law.tangent(carried.max(0.0));
    (stiffness > 0.0).then(|| (stiffness / mass).sqrt() / std::f64::consts::TAU)
}

/// That steps resolve the wheel on its contact.
fn check_step(own: Option<f64>, around: &Around<'_>) -> Result<()> {
    let Some(own) = own.filter(|own| LEAST_STEPS_PER_PERIOD * own * around.step > 1.0 + 1e-9) else {
        return Ok(());
    };
    let times = (LEAST_STEPS_PER_PERIOD * own * around.step).ceil();
    Err(InputError::new(
        "run.inner_steps",
        format!("steps of {} s", around.step),
        format!("at least {LEAST_STEPS_PER_PERIOD} in a period of the wheel on its contact, {own:.1} Hz"),
        format!("set it {times:.0} times as high, or shorten `run.time_step_s`"),
    ))
}

fn probe(index: usize, keys: &ProbeKeys, document: &TrackDocument, wheels: usize) -> Result<Probe> {
    let key = |leaf: &str| format!("probe[{index}].{leaf}");
    if document.rail.rigid {
        let remedy = "leave it out, or give the rail a section";
        return Err(InputError::new(key("x_m"), keys.x_m, "a rail that moves", remedy));
    }
    let plain = keys.name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let before = document.probe[..index].iter().any(|other| other.name == keys.name);
    if !plain || before {
        let expected = "a name of letters, digits and `_` that no other probe has";
        return Err(InputError::new(
            key("name"),
            format!("{:?}", keys.name),
            expected,
            "choose another name",
        ));
    }
    let range = match (keys.on, &document.bridge) {
        (OnKey::Rail, _) => [0.0, document.rail.length_m.unwrap_or(f64::INFINITY)],
        (OnKey::Bridge, Some(bridge)) => [bridge.from_m, bridge.to_m],
        (OnKey::Bridge, None) => {
            return Err(InputError::new(key("on"), "\"bridge\"", "a study with a bridge", "take the rail"));
        }
    };
    if !(range[0]..=range[1]).contains(&keys.x_m) {
        let expected = format!("a place on it, {} to {} m", range[0], range[1]);
        return Err(InputError::new(key("x_m"), keys.x_m, expected, "correct the place"));
    }
    if keys.side == ProbeSideKey::Left && wheels == 1 {
        let expected = "the right rail, which a single wheel has";
        return Err(InputError::new(key("side"), "\"left\"", expected, "leave it out"));
    }
    Ok(Probe {
        name: keys.name.clone(),
        of: if keys.on == OnKey::Rail { Carrier::Rail } else { Carrier::Bridge },
        rail: usize::from(keys.side == ProbeSideKey::Left),
        x: keys.x_m,
    })
}
